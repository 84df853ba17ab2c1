//! Identity: the line that tells one study from another.
//!
//! ```text
//! "two pads" version=2 terms:1f0c88a1b2c3 parameters:77d0... threshold=0,0 scenes:5b1e... draws:90aa... seed=7 format=8
//! ```
//!
//! A part that is long stands there as a digest after a colon, one that is short as itself after an equals sign, so that a refusal can say
//! which part differs. The values behind a digest are written out field by field: it changes when a value does, and never with the name of
//! a field or the layout of a type.

mod of_study;

pub use of_study::{channel, naming, of_study};

use montecarlo::Distribution;
use sha2::{Digest, Sha256};

use crate::hexadecimal;

/// Version of the line. It changes when a part is added or written in another way, so that older lines are refused by name.
const VERSION: u32 = 2;
/// Hexadecimal digits of a digest; chosen: 48 bits, so that no two studies of one user share them by chance, and a line can be read.
const DIGITS: usize = 12;

/// The line that tells a study from others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    line: String,
}

impl Identity {
    /// The identity that has a name only.
    pub fn named(name: &str) -> Self {
        Self { line: format!("{} version={VERSION}", quoted(name)) }
    }

    /// The identity read back from its line; of any other text an identity that has the text as a part.
    pub fn read(name: &str, text: &str) -> Self {
        match Parts::of(text) {
            Some(Parts { version, .. }) if version == VERSION.to_string() => Self { line: text.to_owned() },
            _ => Self::named(name).part("identity", |to| to.text(text)),
        }
    }

    /// The identity with one more part, which is long: its digest.
    pub fn part(self, key: &str, write: impl FnOnce(&mut Written)) -> Self {
        let mut written = Written(Sha256::new());
        write(&mut written);
        let digest = hexadecimal(&written.0.finalize());
        Self { line: format!("{} {key}:{}", self.line, &digest[..DIGITS]) }
    }

    /// The identity with one more part, which is short and has no spaces: itself.
    pub fn given(self, key: &str, value: impl std::fmt::Display) -> Self {
        Self { line: format!("{} {key}={value}", self.line) }
    }

    /// The line.
    pub fn into_line(self) -> String {
        self.line
    }
}

/// Class of processors and libraries on which the results of a study are the same bytes.
#[must_use]
pub fn rounding_class() -> String {
    #[cfg(target_arch = "x86_64")]
    let products = if is_x86_feature_detected!("fma") { "AVX2 FMA" } else { "without FMA" };
    #[cfg(not(target_arch = "x86_64"))]
    let products = "baseline";
    let library = if cfg!(target_env = "gnu") { "glibc" } else { "another C library" };
    format!("{} {products}, {} {library}", std::env::consts::ARCH, std::env::consts::OS)
}

/// A name in quotes, in one line.
fn quoted(name: &str) -> String {
    let escaped = name.chars().flat_map(|c| match c {
        '"' | '\\' => vec!['\\', c],
        c if c.is_control() => c.escape_default().collect(),
        c => vec![c],
    });
    format!("\"{}\"", escaped.collect::<String>())
}

/// Digest of a part, which takes the values that the part is made of, one after the other.
pub struct Written(Sha256);

impl Written {
    /// A whole number: a count, an index, which of several choices.
    pub fn count(&mut self, count: usize) {
        self.0.update((count as u64).to_le_bytes());
    }

    /// A number to its last bit; both zeros are one.
    pub fn number(&mut self, number: f64) {
        self.0.update((number + 0.0).to_bits().to_le_bytes());
    }

    /// A number to nine digits: smaller differences come from another library of functions.
    pub fn rounded(&mut self, number: f64) {
        self.text(&format!("{:.8e}", number + 0.0));
    }

    /// A text.
    pub fn text(&mut self, text: &str) {
        self.count(text.len());
        self.0.update(text.as_bytes());
    }

    /// Several values, with their number before them.
    pub fn list<T>(
        &mut self,
        values: impl IntoIterator<Item = T, IntoIter: ExactSizeIterator>,
        each: impl Fn(&mut Self, T),
    ) {
        let values = values.into_iter();
        self.count(values.len());
        values.for_each(|value| each(self, value));
    }

    /// A distribution: its kind and its parameters.
    pub fn distribution(&mut self, of: &Distribution) {
        let (kind, values) = of.written_out();
        self.text(kind);
        self.list(values, |to, value| to.option(value, Self::number));
    }

    /// A value that may be missing.
    pub fn option<T>(&mut self, value: Option<T>, each: impl Fn(&mut Self, T)) {
        self.list(value, each);
    }
}

/// The parts of a line.
struct Parts<'a> {
    /// Name of the study, with its quotes.
    name: &'a str,
    version: &'a str,
    /// Key, whether the value is a digest, value, of each part.
    parts: Vec<(&'a str, bool, &'a str)>,
}

impl<'a> Parts<'a> {
    /// The parts of a line; `None` of a text that is no line of an identity with a version.
    fn of(line: &'a str) -> Option<Self> {
        let mut is_escaped = false;
        let end = line.char_indices().skip(1).find(|&(_, c)| {
            let ends = c == '"' && !is_escaped;
            is_escaped = c == '\\' && !is_escaped;
            ends
        });
        let (name, rest) = line.starts_with('"').then_some(end)?.map(|(at, _)| line.split_at(at + 1))?;
        let part = |part: &'a str| {
            let at = part.find([':', '='])?;
            Some((&part[..at], part.as_bytes()[at] == b':', &part[at + 1..]))
        };
        let parts: Vec<_> = rest.split_whitespace().map(part).collect::<Option<_>>()?;
        match parts[..] {
            [("version", false, version), ..] => Some(Self { name, version, parts: parts[1..].to_vec() }),
            _ => None,
        }
    }
}

/// Part of a study that keeps its samples.
const KEPT: (&str, &str) = ("samples", "kept");

/// Difference of a folder that holds the study `found` from the study `wanted`, for a message that begins with "holds".
pub fn difference(found: &str, wanted: &str) -> String {
    let (Some(wanted), true) = (Parts::of(wanted), found.starts_with('"')) else { return found.to_owned() };
    let older = || format!("{found}, a study of another version of this program, which this version cannot continue");
    let Some(found_parts) = Parts::of(found).filter(|found| found.version == wanted.version) else { return older() };
    let Parts { name, parts, .. } = found_parts;
    if name != wanted.name {
        return format!("the study {name}, not {}", wanted.name);
    }
    let in_found = |key: &str| parts.iter().find(|part| part.0 == key);
    let in_wanted = |key: &str| wanted.parts.iter().find(|part| part.0 == key);
    if let (Some((_, _, samples)), None) = (in_found("part"), in_wanted("part")) {
        return format!("the samples {samples} of the study {name}, a part for squeal merge");
    }
    let mut differing = Vec::new();
    let seed = |parts: &[(&str, bool, &str)]| parts.iter().find(|part| part.0 == "seed").map(|part| part.2.to_owned());
    let is_other_seed = seed(&parts) != seed(&wanted.parts);
    // The draws of another seed are others, which says nothing of the distribution.
    for &(key, is_digest, value) in wanted.parts.iter().filter(|part| !(is_other_seed && part.0 == "draws")) {
        match in_found(key) {
            Some(&(_, _, other)) if other == value => {}
            Some(_) if is_digest => differing.push(format!("other {key}")),
            Some(&(_, _, other)) if key == "format" => {
                differing.push(format!(
                    "counts of format {other}, which this version of the program ({value}) cannot continue"
                ));
            }
            Some(&(_, _, other)) => differing.push(format!("{key} {other}, not {key} {value}")),
            None if (key, value) == KEPT => {
                differing.push("no samples kept (this run keeps them: without --keep-samples it is that study)".into())
            }
            None => differing.push(format!("no {key}")),
        }
    }
    let beside = parts.iter().filter(|part| in_wanted(part.0).is_none());
    differing.extend(beside.map(|&(key, is_digest, value)| match (key, value) {
        KEPT => "samples kept (with --keep-samples it is that study)".to_owned(),
        _ if is_digest => key.to_owned(),
        _ => format!("{key} {value}"),
    }));
    format!("the study {name} with {}", differing.join(" and "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(name: &str, number: f64, seed: u64) -> String {
        Identity::named(name).part("terms", |to| to.number(number)).given("seed", seed).into_line()
    }

    #[test]
    fn a_line_is_frozen() {
        let written = Identity::named("a \"b\"\n").part("all", |to| {
            to.count(3);
            to.number(-0.0);
            to.rounded(1.0 / 3.0);
            to.text("beam");
            to.list([1.5, 2.5], Written::number);
            to.option(None, Written::number);
        });
        // What stands here is in the folders of users.
        assert_eq!(written.clone().into_line(), "\"a \\\"b\\\"\\n\" version=2 all:a397ab018901");
        assert_eq!(Identity::read("x", &written.clone().into_line()), written);
    }

    #[test]
    fn a_difference_is_said_by_its_part() {
        let own = line("a b", 1.0, 7);
        for (found, said) in [
            (line("c", 1.0, 7), "the study \"c\", not \"a b\""),
            (line("a b", 2.0, 7), "the study \"a b\" with other terms"),
            (line("a b", 2.0, 8), "the study \"a b\" with other terms and seed 8, not seed 7"),
            (
                format!("{own} samples=kept"),
                "the study \"a b\" with samples kept (with --keep-samples it is that study)",
            ),
            ("other files".into(), "other files"),
            (
                "\"a b\" 0123456789abcdef seed 7 format 6".into(),
                "\"a b\" 0123456789abcdef seed 7 format 6, a study of another version of this program, which this version cannot \
                 continue",
            ),
        ] {
            assert_eq!(difference(&found, &own), said);
        }
        assert_eq!(
            difference(&own, &format!("{own} samples=kept")),
            "the study \"a b\" with no samples kept (this run keeps them: without --keep-samples it is that study)"
        );
    }

    #[test]
    fn neighbouring_values_do_not_run_into_each_other() {
        let of = |a: &str, b: &str| {
            Identity::named("").part("p", |to| [a, b].map(|text| to.text(text)).iter().for_each(drop))
        };
        assert_ne!(of("ab", "c"), of("a", "bc"));
        let of = |lists: [&[f64]; 2]| {
            Identity::named("").part("p", |to| lists.iter().for_each(|list| to.list(*list, |to, &x| to.number(x))))
        };
        assert_ne!(of([&[1.0], &[]]), of([&[], &[1.0]]));
    }
}
