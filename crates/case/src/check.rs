//! Errors that name the file, and the checks that are common to all kinds of case files.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use formats::{Limits, Matrix, Options, Wanted, read_one};
use osc_model::OscModelError;
use output::moves_others;
use serde::Deserialize;
use study::Units;

use super::CaseError;
use crate::ExpressionError;

/// The allowed half widths of occurrences; chosen: for smaller ones a control variate takes millions of samples per scene, with
/// larger ones an interval has no information.
pub const HALF_WIDTHS: &str = "0.00001 to 0.25";

/// True if a half width lies in [`HALF_WIDTHS`].
pub fn is_half_width(half_width: f64) -> bool {
    (1e-5..=0.25).contains(&half_width)
}

/// The table `[accuracy]` of a case file of any kind.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Accuracy {
    half_width: f64,
}

/// Largest coefficient of friction of which nothing is said; chosen: twice what brake linings have and above rubber on a dry road, far below any percentage.
const LARGEST_FRICTION: f64 = 2.0;

/// A matrix of a term, and how it was taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TakenMatrix {
    /// The field, as `table "name".key`.
    pub field: String,
    /// The file, as the case names it; `None` where its rows are in the case.
    pub file: Option<PathBuf>,
    /// The matrix in it.
    pub name: String,
    /// Way in which its entries were taken, in words.
    pub taken: String,
}

impl TakenMatrix {
    /// Lines on how each matrix was taken, by its file or field; matrices that were taken alike share a line.
    #[must_use]
    pub fn in_words(matrices: &[Self]) -> Vec<String> {
        let mut alike: Vec<(&str, Vec<String>)> = Vec::new();
        for Self { field, file, taken, .. } in matrices {
            let name = file.as_ref().map_or_else(|| field.clone(), |file| file.display().to_string());
            match alike.iter_mut().find(|(words, _)| words == taken) {
                Some((_, names)) if names.contains(&name) => {}
                Some((_, names)) => names.push(name),
                None => alike.push((taken, vec![name])),
            }
        }
        alike.into_iter().map(|(words, names)| format!("{}: {words}", names.join(", "))).collect()
    }
}

/// Most characters of a name; chosen: a table with longer ones cannot be read, nor a file have it.
const LONGEST_NAME: usize = 60;

/// Characters that names and lines must not have, in words.
const UNSEEN: &str = "control characters, marks of direction and separators of lines";

/// True if a character must not stand in a name: it is not seen, and moves what is.
fn is_unseen(c: char) -> bool {
    c.is_control() || moves_others(c)
}

/// The first characters of a text.
fn beginning(text: &str, characters: usize) -> String {
    text.chars().take(characters).collect()
}

/// Maker of errors that name the file, and collector of sentences that its user should know.
pub(super) struct Check<'a> {
    pub path: &'a Path,
    /// Units of the numbers of the case.
    pub units: Units,
    notes: RefCell<Vec<String>>,
}

impl<'a> Check<'a> {
    pub fn new(path: &'a Path) -> Self {
        Self { path, units: Units::default(), notes: RefCell::default() }
    }
}

impl Check<'_> {
    /// The error for a value that is not allowed.
    pub fn value(&self, field: &str, value: impl ToString, allowed: &str) -> CaseError {
        CaseError::Value {
            path: self.path.to_owned(),
            field: field.to_owned(),
            value: value.to_string(),
            allowed: allowed.to_owned(),
        }
    }

    /// The error for a refusal of the lattice, with the table that it refuses.
    pub fn lattice(&self, table: &str) -> impl Fn(OscModelError) -> CaseError {
        let (path, table) = (self.path.to_owned(), table.to_owned());
        move |source| {
            let path = path.clone();
            match source {
                OscModelError::Value { field, value, allowed } => CaseError::Value {
                    path,
                    field: format!("{table}.{field}"),
                    value: value.to_string(),
                    allowed: allowed.to_string(),
                },
                OscModelError::Length { field, found, expected, rows, columns } => CaseError::Value {
                    path,
                    field: format!("{table}.{field}"),
                    value: format!("a list of {found}"),
                    allowed: format!("a list of {expected}, for a lattice of {rows} x {columns}"),
                },
                source => CaseError::Lattice { path, table: table.clone(), source },
            }
        }
    }

    /// An error unless all names differ.
    pub fn no_repeats(&self, field: &str, names: impl Iterator<Item = String>) -> Result<(), CaseError> {
        let mut seen = std::collections::BTreeSet::new();
        for name in names {
            if !seen.insert(name.clone()) {
                return Err(self.value(field, name, "each once"));
            }
        }
        Ok(())
    }

    /// An error unless a name can be used in a table and in the name of a file.
    pub fn plain_name(&self, field: &str, name: &str) -> Result<(), CaseError> {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if !(1..=LONGEST_NAME).contains(&name.chars().count()) || !name.chars().all(is_plain) {
            let allowed = format!("1 to {LONGEST_NAME} letters, digits, - and _");
            return Err(self.value(field, format!("{:?}", beginning(name, LONGEST_NAME)), &allowed));
        }
        Ok(())
    }

    /// An error unless a text fits into headings and legends: short, and without characters that are not seen.
    pub fn line(&self, field: &str, text: &str) -> Result<(), CaseError> {
        /// Most characters; chosen: two lines of a figure.
        const LONGEST_LINE: usize = 200;
        if text.chars().count() > LONGEST_LINE || text.chars().any(is_unseen) {
            let allowed = format!("at most {LONGEST_LINE} characters without {UNSEEN}");
            return Err(self.value(field, format!("{:?}", beginning(text, LONGEST_NAME)), &allowed));
        }
        Ok(())
    }

    /// The half width that a case asks for; `None` where it asks for no half width.
    pub fn half_width(&self, accuracy: Option<Accuracy>) -> Result<Option<f64>, CaseError> {
        let given = accuracy.map(|accuracy| accuracy.half_width);
        match given.filter(|half_width| !is_half_width(*half_width)) {
            None => Ok(given),
            Some(half_width) => Err(self.value("accuracy.half_width", half_width, HALF_WIDTHS)),
        }
    }

    /// The error for the matrices of a table that make no system.
    pub fn system(&self, field: &str) -> impl Fn(linsys::LinsysError) -> CaseError + use<> {
        let (path, field) = (self.path.to_owned(), field.to_owned());
        move |source| CaseError::System { path: path.clone(), field: field.clone(), source: Box::new(source) }
    }

    /// The error for sparse matrices that make no system.
    pub fn sparse(&self, field: &str) -> impl Fn(sparse::SparseError) -> CaseError + use<> {
        let (path, field) = (self.path.to_owned(), field.to_owned());
        move |source| CaseError::Sparse { path: path.clone(), field: field.clone(), source: Box::new(source) }
    }

    /// The error for faces, bodies or loads that make no contact.
    pub fn contact<E: Into<contact::ContactError>>(&self, field: &str) -> impl Fn(E) -> CaseError + use<E> {
        let (path, field) = (self.path.to_owned(), field.to_owned());
        move |source| CaseError::Contact { path: path.clone(), field: field.clone(), source: Box::new(source.into()) }
    }

    /// The error for an expression without a value.
    pub fn expression(&self, field: &str) -> impl Fn(ExpressionError) -> CaseError + use<> {
        let (path, field) = (self.path.to_owned(), field.to_owned());
        move |source| CaseError::Expression { path: path.clone(), field: field.clone(), source: Box::new(source) }
    }

    /// Collects a sentence.
    pub fn note(&self, text: String) {
        self.notes.borrow_mut().push(format!("{}: {text}", self.path.display()));
    }

    /// Collects a sentence on a median coefficient of friction that no material has.
    pub fn note_large_friction(&self, field: &str, median: f64) {
        if median > LARGEST_FRICTION {
            self.note(format!(
                "{field} = {median}: a coefficient of friction is rarely above {LARGEST_FRICTION}; a percentage?"
            ));
        }
    }

    /// The sentences that were collected.
    pub fn notes(&self) -> Vec<String> {
        self.notes.take()
    }

    /// The matrix that is meant in `FILE` or `FILE:NAME`, a path from the folder of the case file.
    pub fn read_matrix(
        &self,
        field: &str,
        file: &Path,
        wanted: &Wanted<'_>,
        limits: Limits,
    ) -> Result<(Matrix, TakenMatrix), CaseError> {
        let path = self.path.parent().unwrap_or(Path::new("")).join(file);
        let options = Options { limits, ..Options::default() };
        let matrix = read_one(&path, wanted, options).map_err(|source| self.matrix(field, file, source))?;
        for doubt in matrix.doubts() {
            self.note(format!("{field} = {:?}: {doubt}", file.display()));
        }
        let (name, taken) = (matrix.name().to_owned(), matrix.taken());
        Ok((matrix, TakenMatrix { field: field.to_owned(), file: Some(file.to_owned()), name, taken }))
    }

    /// The error for a file that gives no matrix or mesh.
    pub fn matrix(&self, field: &str, file: &Path, source: formats::FormatsError) -> CaseError {
        let (path, field) = (self.path.to_owned(), field.to_owned());
        CaseError::Matrix { path, field, file: file.to_owned(), source: Box::new(source) }
    }

    /// The number, if it is neither infinite nor NaN.
    pub fn finite(&self, field: &str, value: f64) -> Result<f64, CaseError> {
        if value.is_finite() { Ok(value) } else { Err(self.value(field, value, "a finite number")) }
    }

    /// The loss factor, if it is finite and not negative.
    pub fn loss_factor(&self, field: &str, value: f64) -> Result<f64, CaseError> {
        if value.is_finite() && value >= 0.0 {
            Ok(value)
        } else {
            Err(self.value(field, value, "a finite number >= 0"))
        }
    }

    /// An error unless names of tables differ and can be used in messages and column heads.
    pub fn names<'n>(&self, field: &str, names: impl Iterator<Item = &'n String> + Clone) -> Result<(), CaseError> {
        let allowed = format!("1 to {LONGEST_NAME} characters without {UNSEEN}");
        for name in names.clone() {
            if name.is_empty() || name.chars().count() > LONGEST_NAME || name.chars().any(is_unseen) {
                return Err(self.value(field, format!("{:?}", beginning(name, LONGEST_NAME)), &allowed));
            }
        }
        self.no_repeats(field, names.cloned())
    }

    /// An error unless the names of force families are allowed as names by [`Check::names`]; but tables may share a name.
    pub fn names_of_families<'n>(
        &self,
        table: &str,
        given: impl Iterator<Item = (&'n String, &'n Option<String>)>,
    ) -> Result<(), CaseError> {
        for (name, family) in given {
            self.names(&field(table, name, "family"), family.iter())?;
        }
        Ok(())
    }
}

/// The name of a field of a named table in messages.
pub(super) fn field(table: &str, name: &str, key: &str) -> String {
    format!("{table} {name:?}.{key}")
}

/// Replacements in messages of the parser: a word of Rust or its own, and the word for a user of case files; made in this order.
const PARSER_WORDS: [(&str, &str); 20] = [
    ("expected usize", "expected a whole number >= 0"),
    ("expected u64", "expected a whole number >= 0"),
    ("expected u16", "expected a whole number >= 0"),
    ("expected f64", "expected a number"),
    (
        "expected internally tagged enum Distribution",
        "expected a table, as { distribution = \"constant\", value = 1.0 }",
    ),
    ("expected a sequence", "expected a list"),
    ("expected an array of length", "expected a list of"),
    ("wanted string or table", "expected a name in quotes, or { name = number }"),
    ("wanted exactly 1 element, more than 1 element", "expected one entry, found more"),
    ("invalid length", "a list of"),
    ("invalid type: map", "a table"),
    ("invalid type: ", ""),
    ("invalid value: ", ""),
    ("floating point", "the number"),
    ("integer", "the number"),
    ("boolean", "the truth value"),
    ("string \"", "the text \""),
    ("sequence", "a list"),
    ("unknown variant", "unknown name"),
    (" as i128", ""),
];

/// Error of the parser on the text of a case file, in words for its user, with the line.
pub(super) fn syntax(path: &Path, text: &str, error: &toml::de::Error) -> CaseError {
    let at = error.span().map_or(0, |span| span.start.min(text.len()));
    let line = text[..at].matches('\n').count() + 1;
    let source = text.lines().nth(line - 1).unwrap_or_default();
    let source: String = source.split(" #").next().unwrap_or_default().trim().chars().take(80).collect();
    let message = error.message();
    // Of a whole number that does not fit into 64 bits the parser says only that it expected something else.
    if let Some((_, rest)) = message.split_once("integer `").filter(|_| message.contains("128")) {
        let number: String = rest.chars().take_while(|&c| c != '`').collect();
        let message = format!(
            "{source}: the whole number {number} is too large; allowed: -9223372036854775808 to 9223372036854775807, or a number with a point"
        );
        return CaseError::Syntax { path: path.to_owned(), line, message };
    }
    let in_words = |message: String, (rust, word): &(&str, &str)| message.replace(rust, word);
    let message = PARSER_WORDS.iter().fold(error.message().replace('\n', " "), in_words);
    let message = without_struct_name(message);
    let message = other_brackets(&source, &message).unwrap_or(message);
    let message = if source.is_empty() { message } else { format!("{source}: {message}") };
    CaseError::Syntax { path: path.to_owned(), line, message }
}

/// The message for a table that stands in the brackets of a list of tables, or the other way round: the parser reads the one into the other and complains of
/// what it finds inside.
fn other_brackets(source: &str, message: &str) -> Option<String> {
    /// Tables that are there once.
    const SINGLE: [&str; 15] = [
        "study",
        "accuracy",
        "squeal",
        "measured",
        "correlation",
        "lattice",
        "lattice.plate",
        "readings",
        "friction",
        "alternatives",
        "paper",
        "brake",
        "units",
        "reduction",
        "all_contacts",
    ];
    let name = source.trim_start_matches('[').trim_end_matches(']');
    let is_list = source.starts_with("[[");
    if is_list && SINGLE.contains(&name) {
        return Some(format!("a list of tables; allowed: one table, [{name}]"));
    }
    let is_one = source.starts_with('[') && !is_list && message.ends_with("expected a list");
    is_one.then(|| format!("one table; allowed: a list of tables, each with the heading [[{name}]]"))
}

/// The message with "a table" in place of the name of the Rust struct that the parser reads the table into.
fn without_struct_name(message: String) -> String {
    const EXPECTED: &str = "expected struct ";
    let Some(start) = message.find(EXPECTED) else { return message };
    let rest = message[start + EXPECTED.len()..].trim_start_matches(|c: char| c.is_ascii_alphanumeric());
    format!("{}expected a table{rest}", &message[..start])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CaseFile;

    #[test]
    fn a_table_in_the_brackets_of_a_list_is_told_so_and_the_other_way_round() {
        let case = include_str!("../../../cases/two-by-two.toml");
        let refused = |given: &str, instead: &str| {
            let text = case.replacen(&format!("\n{given}\n"), &format!("\n{instead}\n"), 1);
            assert_ne!(text, case, "{given}");
            CaseFile::parse(Path::new("case.toml"), text).map(|_| ()).unwrap_err().to_string()
        };
        for name in ["study", "lattice", "lattice.plate", "readings", "friction"] {
            let said = refused(&format!("[{name}]"), &format!("[[{name}]]"));
            assert!(said.ends_with(&format!("[[{name}]]: a list of tables; allowed: one table, [{name}]")), "{said}");
        }
        let said = refused("[[speeds]]", "[speeds]");
        assert!(
            said.ends_with("[speeds]: one table; allowed: a list of tables, each with the heading [[speeds]]"),
            "{said}"
        );
    }
}
