//! `squeal explain`: what a line means with which something was refused, and what a field of a case is.

use std::cmp::Reverse;
use std::fmt::Write as _;
use std::io::Write;

use crate::Error;

/// Every line with which something is refused, as `cargo xtask refusals` makes the page; `docs/refusals.md` has the same text.
const PAGE: &str = include_str!("refusals.md");
/// Every field of a case file: the text of `docs/case-files.md`, copied by the same command.
const FIELDS: &str = include_str!("case-files.md");

/// Fewest letters that a line must have in common with a message, beside what differs each time; chosen.
const LEAST_LETTERS: usize = 3;
/// Letters that a sign between the parts of a line weighs as much as; chosen, so that `brake.toml: x = 0; allowed: 1 to 9` is of a field and its
/// value before it is of any message that ends so.
const LETTERS_OF_A_SIGN: usize = 4;
/// Words of lines on the command line itself, which the parser of options prints.
const OF_COMMAND_LINE: [&str; 5] = [
    "unexpected argument",
    "unrecognized subcommand",
    "required arguments were not provided",
    "invalid value",
    "cannot be used with",
];

/// Explain a line with which something was refused, or a field of a case: what is wrong, and what each part of the line says.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: squeal explain \"error: brake.toml: cannot be read: No such file or directory\"; squeal explain reduction.residual"
)]
pub struct ExplainArgs {
    /// The line as it was printed, in quotation marks, words of it, or a field as TABLE.KEY
    #[arg(required = true, value_name = "LINE")]
    line: Vec<String>,
}

impl ExplainArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A line that is not among those of the page, and no field.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let line = self.line.join(" ");
        let text = explained(&line).ok_or_else(|| {
            let allowed =
                "a line on standard error, or words of one, or a field; docs/refusals.md and docs/case-files.md have all";
            Error::Option { option: "LINE", value: line, allowed: allowed.into() }
        })?;
        out.write_all(text.as_bytes()).map_err(Error::StandardOutput)
    }
}

/// Explanation of a line, or of a field; `None` of what is neither.
fn explained(line: &str) -> Option<String> {
    let line = line.trim().trim_start_matches("error: ");
    let fields = fields(line);
    if !fields.is_empty() {
        return Some(fields);
    }
    if OF_COMMAND_LINE.iter().any(|words| line.contains(words)) {
        return Some("An option, argument or command that the program does not take so: squeal COMMAND --help has all of them, with an example.\n".into());
    }
    let (own, others) = matching(line);
    let text = match own {
        Some((refusal, parts)) => in_parts(&refusal, &parts),
        None => others.iter().map(listed).collect(),
    };
    (!text.is_empty()).then_some(text)
}

/// A line taken to pieces: the fault, what each part of it is, and what its field is.
fn in_parts(refusal: &Refusal, parts: &[(&'static str, &str)]) -> String {
    let mut text = format!("{}\n\n", refusal.faults.join(" Or: "));
    let width = parts.iter().map(|(_, found)| found.chars().count()).max().unwrap_or(0).min(40);
    for (name, found) in parts.iter().filter(|(_, found)| !found.is_empty()) {
        let meaning = refusal.meanings.iter().find(|(of, _)| of == name);
        let meaning = meaning.map_or_else(|| name.replace('_', " "), |(_, meaning)| meaning.replace('`', ""));
        let _ = writeln!(text, "  {found:<width$}  {meaning}");
    }
    let field = parts.iter().find(|(name, _)| *name == "field").map_or_else(String::new, |(_, field)| fields(field));
    if field.is_empty() { text } else { text + "\n" + &field }
}

/// A message with its parts, where words of it are all that is known.
fn listed(refusal: &Refusal) -> String {
    let mut text = format!("{}\n  {}\n", refusal.message, refusal.faults.join(" Or: "));
    for (name, meaning) in &refusal.meanings {
        let _ = writeln!(text, "  {{{name}}}: {}", meaning.replace('`', ""));
    }
    text + "\n"
}

/// Message of an error, and what is said of it.
struct Refusal {
    /// Message with `{words}` for what differs each time.
    message: &'static str,
    /// Fault, in a sentence; several where crates say the same of different things.
    faults: Vec<&'static str>,
    /// Meaning of each of the words.
    meanings: Vec<(&'static str, &'static str)>,
}

impl Refusal {
    /// Parts that every line of this message has, in their order, each with the word for what stands before it.
    fn fixed(&self) -> impl Iterator<Item = (Option<&'static str>, &'static str)> {
        self.message.split('{').enumerate().map(|(at, part)| match part.split_once('}') {
            Some((word, after)) if at > 0 => (Some(word), after),
            _ => (None, part),
        })
    }

    /// Words of this message with what stands for them in a line, and the letters that both have in common, a sign counted as [`LETTERS_OF_A_SIGN`]
    /// letters; `None` where the line is not of this message.
    fn parts<'l>(&self, line: &'l str) -> Option<(usize, Vec<(&'static str, &'l str)>)> {
        let (mut rest, mut parts) = (line, Vec::new());
        let mut fixed = self.fixed().peekable();
        while let Some((word, fixed_part)) = fixed.next() {
            let is_rest = fixed_part.is_empty() && fixed.peek().is_none();
            let (found, after) = if is_rest { (rest, "") } else { rest.split_once(fixed_part)? };
            parts.extend(word.map(|word| (word, found.trim())));
            rest = after;
        }
        let count = |is: fn(&char) -> bool| self.fixed().flat_map(|(_, fixed)| fixed.chars()).filter(is).count();
        let letters = count(|letter| letter.is_alphanumeric());
        let signs = count(|sign| !sign.is_alphanumeric() && !sign.is_whitespace());
        (letters >= LEAST_LETTERS).then_some((letters + LETTERS_OF_A_SIGN * signs, parts))
    }

    /// True if every word is in the message.
    fn has_words(&self, words: &[String]) -> bool {
        let message = self.message.to_lowercase();
        words.iter().all(|word| message.contains(word))
    }
}

/// The messages of the page, each once.
fn refusals() -> Vec<Refusal> {
    let mut all: Vec<Refusal> = Vec::new();
    for entry in PAGE.split("\n**`").skip(1) {
        let Some((message, about)) = entry.split_once("**\n") else { continue };
        let message = message.trim_matches(['`', ' ']);
        let mut lines = about.split("\n## ").next().unwrap_or_default().trim().lines().filter(|line| !line.is_empty());
        let fault = lines.next().unwrap_or_default();
        let meanings = lines.filter_map(|line| line.strip_prefix("- `{")?.split_once("}`: "));
        match all.iter_mut().find(|known| known.message == message) {
            Some(known) if known.faults.contains(&fault) => {}
            Some(known) => known.faults.push(fault),
            None => all.push(Refusal { message, faults: vec![fault], meanings: meanings.collect() }),
        }
    }
    all
}

/// A message of which a line is, with what stands for its words.
type OwnMessage<'l> = (Refusal, Vec<(&'static str, &'l str)>);

/// The message that a line has most in common with, and its parts; of words that are no line the messages that have them all.
fn matching(line: &str) -> (Option<OwnMessage<'_>>, Vec<Refusal>) {
    let of_line = |refusal: Refusal| refusal.parts(line).map(|(in_common, parts)| (in_common, (refusal, parts)));
    // The first of several that have as much.
    let own = refusals().into_iter().filter_map(of_line).min_by_key(|(in_common, _)| Reverse(*in_common));
    if let Some((_, own)) = own {
        return (Some(own), Vec::new());
    }
    let words: Vec<String> = line.to_lowercase().split_whitespace().map(str::to_owned).collect();
    (None, refusals().into_iter().filter(|refusal| refusal.has_words(&words)).collect())
}

/// Cells of a row of a table, which may be empty: between its bars, but for those in code.
fn cells(row: &str) -> Vec<&str> {
    let mut is_code = false;
    let is_bar = |letter: char| {
        is_code ^= letter == '`';
        letter == '|' && !is_code
    };
    row.trim_matches('|').split(is_bar).map(str::trim).collect()
}

/// Rows of the page on case files for a field, such as `study.samples` or `terms "lining".loss_factor`; empty for text that is no field.
fn fields(field: &str) -> String {
    let is_name = |c: char| c.is_alphanumeric() || "._-\" []@".contains(c);
    let Some((path, key)) = field.rsplit_once('.').filter(|_| field.chars().all(is_name)) else { return String::new() };
    let table = path.split(['.', ' ', '[']).next().unwrap_or_default();
    let (mut heading, mut columns, mut text) = ("", Vec::new(), String::new());
    for line in FIELDS.lines() {
        if line.starts_with('#') {
            (heading, columns) = (line.trim_start_matches('#').trim(), Vec::new());
        } else if !line.starts_with('|') {
            columns = Vec::new();
        } else if columns.is_empty() {
            columns = cells(line);
        } else {
            let row = cells(line);
            let first = row[0];
            let is_of_table = heading.contains(&format!("[{table}"))
                || first.contains(&format!("[{table}]"))
                || first.contains(&format!("`{table}.{key}"));
            let names_key = [format!("`{key}`"), format!("`{key} ="), format!(".{key}`")];
            if is_of_table && names_key.iter().any(|name| first.contains(name)) {
                let _ = writeln!(text, "{} (docs/case-files.md, {})", first.replace('`', ""), heading.replace('`', ""));
                for (column, cell) in columns.iter().zip(&row).skip(1).filter(|(_, cell)| !cell.is_empty()) {
                    let column = if column.is_empty() { String::new() } else { format!("{column}: ") };
                    let _ = writeln!(text, "  {column}{}", cell.replace('`', ""));
                }
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{LEAST_LETTERS, explained, fields, matching, refusals};

    #[test]
    fn every_message_is_found_by_a_line_of_it() {
        let all = refusals();
        assert!(all.len() > 200);
        for refusal in &all {
            assert!(refusal.faults.iter().all(|fault| !fault.is_empty()), "{}", refusal.message);
            let fixed: Vec<&str> = refusal.fixed().map(|(_, fixed)| fixed).collect();
            if fixed.concat().chars().filter(|letter| letter.is_alphanumeric()).count() >= LEAST_LETTERS {
                let line = fixed.join("7");
                let (own, _) = matching(&line);
                // Or one that has as much in common with it.
                let found = own.and_then(|(own, _)| Some(own.parts(&line)?.0)).unwrap();
                assert!(found >= refusal.parts(&line).unwrap().0, "{}", refusal.message);
            }
        }
    }

    /// Cells have the headings of their columns, though cells before them are empty.
    #[test]
    fn a_field_has_the_columns_of_its_table() {
        let text = fields("contacts \"belt\".mu");
        assert!(text.contains("  allowed: mu, slope or lag required\n  meaning: coefficient of friction"), "{text}");
        assert!(!text.contains("unit:"), "{text}");
        assert!(fields("reduction.residual").contains("|lambda|^2 |M| + |lambda| |C| + |K|. Bases"));
    }

    #[test]
    fn a_printed_line_is_taken_to_pieces() {
        let line = "error: brake.toml: study.samples = 0; allowed: >= 1";
        let text = explained(line).unwrap();
        for part in ["brake.toml", "study.samples", "the values allowed", "draws of the friction parameters"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let text = explained("error: no.toml: cannot be read: No such file or directory (os error 2)").unwrap();
        assert!(text.contains("no.toml") && text.lines().count() < 8, "{text}");
        assert!(explained("error: unexpected argument '--foo' found").unwrap().contains("--help"));
        assert!(explained("nothing that is said anywhere").is_none());
        let words = explained("Degrees freedom").unwrap();
        assert!(words.contains("the system has no degrees of freedom"), "{words}");
    }

    #[test]
    fn a_field_is_explained_by_the_page_on_case_files() {
        for (field, words) in [
            ("study.samples", "integer"),
            ("reduction.residual", "1e-8"),
            ("terms \"lining\".loss_factor", "eta"),
            ("contact.stiffness", "a spring along the normal"),
            ("friction.mu", "coefficient"),
            ("measured.share", "counts as squeal"),
        ] {
            assert!(fields(field).contains(words), "{field}: {}", fields(field));
        }
        assert!(fields("no.field").is_empty() && fields("in a sentence.").is_empty());
    }
}
