//! Keyword lines of a deck: their names, parameters and what they do to nodes, elements and sets.

use crate::problem::Problem;
use crate::shortened::cut;

/// The keywords of Abaqus and CalculiX that change no node, element or set, one a line: materials, sections, constraints, steps, output.
const HARMLESS: &str = include_str!("harmless.txt");

/// Keywords that are read.
const READ: [&str; 7] = ["NODE", "ELEMENT", "NSET", "ELSET", "SYSTEM", "INCLUDE", "SURFACE"];

/// Refused keywords, which change nodes, elements, sets or the directions of degrees of freedom: what is allowed instead, and the names.
const REFUSED: [(&str, &[&str]); 5] = [
    (
        "one flat deck, as CalculiX or Abaqus (NO PARTS INPUT FILE) writes it: numbers of nodes in parts are not those of the matrices",
        &["PART", "ENDPART", "INSTANCE", "ENDINSTANCE", "ASSEMBLY", "ENDASSEMBLY"],
    ),
    (
        "nodes, elements and sets written out by *NODE, *ELEMENT, *NSET and *ELSET: what this keyword makes is not read",
        &[
            "NGEN",
            "NFILL",
            "NCOPY",
            "NMAP",
            "ELGEN",
            "ELCOPY",
            "SYMMETRICMODELGENERATION",
            "SYMMETRICRESULTSTRANSFER",
            "REFINEMESH",
            "INITIALMESH",
            "USEREFINEDMESH",
            "IMPORT",
            "IMPORTELSET",
            "IMPORTNSET",
        ],
    ),
    (
        "no *TRANSFORM: contact and holders are in global x, y and z; export without it, or leave it out of this file where the rows of the \
         matrices are global all the same, as those of CalculiX are",
        &["TRANSFORM"],
    ),
    ("nodes at the places that *NODE gives: this keyword moves them", &["ADJUST", "IMPERFECTION"]),
    ("a deck that has its nodes itself, without READ", &["RESTART"]),
];

/// A keyword line, with the lines that continue it.
#[derive(Debug)]
pub(super) struct Keyword {
    /// The name in capitals without blanks and the star.
    pub name: String,
    /// Parameters: the name, written like the name of the keyword, and the value as it is written.
    options: Vec<(String, String)>,
    line: String,
}

impl Keyword {
    pub fn new(line: &str) -> Self {
        let mut parts = split(line).into_iter();
        let plain = |text: &str| text.split_whitespace().collect::<String>().to_ascii_uppercase();
        let name = plain(parts.next().unwrap_or_default().trim_start_matches('*'));
        let options = parts.filter(|part| !part.trim().is_empty()).map(|part| {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            (plain(key), value.trim().to_owned())
        });
        Self { name, options: options.collect(), line: line.to_owned() }
    }

    /// The value of a parameter, empty where the parameter has no value.
    pub fn option(&self, key: &str) -> Option<&str> {
        self.options.iter().find(|(own, _)| own == key).map(|(_, value)| value.as_str())
    }

    /// The names of all parameters.
    pub fn options(&self) -> impl Iterator<Item = &str> {
        self.options.iter().map(|(key, _)| key.as_str())
    }

    /// The name of a set that a parameter gives.
    pub fn set(&self, key: &str) -> Result<Option<String>, Problem> {
        self.option(key).map(set_name).transpose()
    }

    /// An error where the line has another parameter than these, which could change what its data mean.
    pub fn has_only(&self, known: &[&str], allowed: &'static str) -> Result<(), Problem> {
        match self.options.iter().all(|(key, _)| known.contains(&key.as_str())) {
            true => Ok(()),
            false => Err(self.refused(allowed)),
        }
    }

    /// The error of a keyword line that is not read.
    pub fn refused(&self, allowed: &'static str) -> Problem {
        Problem::Keyword { what: "keyword", found: cut(&self.line), allowed }
    }

    /// An error where the keyword, which is not read, changes the model or may do so; within a step only a known keyword is taken to do so.
    pub fn check_harmless(&self, is_in_step: bool) -> Result<(), Problem> {
        let name = self.name.as_str();
        if name == "RESTART" && self.option("READ").is_none() {
            return Ok(());
        }
        let refused = || REFUSED.iter().flat_map(|(allowed, names)| names.iter().map(move |name| (*name, *allowed)));
        if let Some((_, allowed)) = refused().find(|(refused, _)| *refused == name) {
            return Err(self.refused(allowed));
        }
        let harmless = || HARMLESS.lines().map(|line| line.bytes().filter(|byte| *byte != b' '));
        if harmless().any(|known| known.eq(name.bytes())) {
            return Ok(());
        }
        // The programs take abbreviations.
        let is_begin_of = |known: &str| known.starts_with(name);
        if READ.into_iter().chain(refused().map(|(name, _)| name)).any(is_begin_of) {
            return Err(self.refused("keywords written out in full"));
        }
        let is_short = harmless().any(|known| known.take(name.len()).eq(name.bytes()));
        match is_in_step || is_short {
            true => Ok(()),
            false => Err(self.refused(
                "keywords of Abaqus and CalculiX: this one is not known here and may change nodes; leave it out where it does not",
            )),
        }
    }
}

/// The fields of a line between commas, but for commas within double quotes.
pub(super) fn split(line: &str) -> Vec<&str> {
    let mut is_quoted = false;
    line.split(|c| {
        is_quoted ^= c == '"';
        c == ',' && !is_quoted
    })
    .collect()
}

/// The name of a set: in capitals without blanks, or as it is written between double quotes.
pub(super) fn set_name(text: &str) -> Result<String, Problem> {
    let quoted = text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
    let name = quoted.map_or_else(|| text.split_whitespace().collect::<String>().to_ascii_uppercase(), str::to_owned);
    if name.is_empty() || name.contains(['<', '"']) || name.parse::<i64>().is_ok() {
        let allowed = "a name that is no number, not empty and without < of a *PARAMETER";
        return Err(Problem::field("name of a set", format!("{text:?}"), allowed));
    }
    Ok(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_keywords_are_disjoint_and_plain() {
        let plain = |line: &str| line.replace(' ', "");
        let mut all: Vec<String> = HARMLESS.lines().map(plain).collect();
        all.extend(REFUSED.iter().flat_map(|(_, names)| names.iter().map(|name| (*name).to_owned())));
        all.extend(READ.map(str::to_owned));
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count);
        assert!(all.iter().all(|name| name.bytes().all(|byte| byte.is_ascii_uppercase() || b"-123".contains(&byte))));
    }

    #[test]
    fn a_line_is_split_into_name_and_parameters() {
        let keyword = Keyword::new("* Node , nset = \"My, Set\",SYSTEM=c,, unsorted");
        assert_eq!(
            (keyword.name.as_str(), keyword.option("SYSTEM"), keyword.option("UNSORTED")),
            ("NODE", Some("c"), Some(""))
        );
        assert_eq!(keyword.set("NSET").unwrap().unwrap(), "My, Set");
        assert_eq!(set_name("my set").unwrap(), "MYSET");
        for bad in ["", "12", "<x>", "\"\"", "a\"b"] {
            assert!(set_name(bad).is_err(), "{bad}");
        }
    }
}
