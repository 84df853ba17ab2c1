//! `squeal explain`: what a line means with which something was refused.

use std::cmp::Reverse;
use std::io::Write;

use crate::Error;

/// Every line with which something is refused, as `cargo xtask refusals` makes the page; `docs/refusals.md` has the same text.
const PAGE: &str = include_str!("refusals.md");

/// Fewest letters that a line must have in common with a message, beside what differs each time; chosen.
const LEAST_LETTERS: usize = 3;
/// Letters that a sign between the parts of a line weighs as much as; chosen, so that `brake.toml: x = 0; allowed: 1 to 9` is of a field and its
/// value before it is of any message that ends so.
const LETTERS_OF_A_SIGN: usize = 4;

/// Explain a line with which something was refused: what is wrong, and what each part of the line says.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal explain \"error: brake.toml: cannot be read: No such file or directory\"")]
pub struct ExplainArgs {
    /// The line as it was printed, in quotation marks, or words of it
    #[arg(required = true, value_name = "LINE")]
    line: Vec<String>,
}

impl ExplainArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A line that is not among those of the page.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let line = self.line.join(" ");
        let found = matching(&line);
        if found.is_empty() {
            let allowed =
                "a line on standard error, or words of one; docs/refusals.md has all, --help what a command takes";
            return Err(Error::Option { option: "LINE", value: line, allowed: allowed.into() });
        }
        for refusal in found {
            writeln!(out, "{}\n", refusal.message).map_err(Error::StandardOutput)?;
            for line in refusal.about.lines() {
                let line = if line.is_empty() { String::new() } else { format!("  {}", line.replace('`', "")) };
                writeln!(out, "{line}").map_err(Error::StandardOutput)?;
            }
            writeln!(out).map_err(Error::StandardOutput)?;
        }
        writeln!(out, "{{words}} differ each time; docs/case-files.md has every field of a case")
            .map_err(Error::StandardOutput)
    }
}

/// Message of an error, and what is said of it.
struct Refusal {
    /// Message with `{words}` for what differs each time.
    message: &'static str,
    /// Fault, and meaning of the words.
    about: String,
}

impl Refusal {
    /// Parts that every line of this message has, in their order.
    fn fixed(&self) -> impl Iterator<Item = &'static str> {
        self.message.split('{').enumerate().map(|(at, part)| match part.split_once('}') {
            Some((_, after)) if at > 0 => after,
            _ => part,
        })
    }

    /// Letters that a line has in common with this message, a sign counted as [`LETTERS_OF_A_SIGN`] letters; `None` where it is not of this message.
    fn in_common(&self, line: &str) -> Option<usize> {
        let mut rest = line;
        for fixed in self.fixed() {
            (_, rest) = rest.split_once(fixed)?;
        }
        let count = |is: fn(&char) -> bool| self.fixed().flat_map(str::chars).filter(is).count();
        let letters = count(|letter| letter.is_alphanumeric());
        let signs = count(|sign| !sign.is_alphanumeric() && !sign.is_whitespace());
        (letters >= LEAST_LETTERS).then_some(letters + LETTERS_OF_A_SIGN * signs)
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
        let about = about.split("\n## ").next().unwrap_or_default().trim();
        match all.iter_mut().find(|known| known.message == message) {
            // Crates that say the same of different things.
            Some(known) if known.about != about => known.about += &format!("\n\n{about}"),
            Some(_) => {}
            None => all.push(Refusal { message, about: about.to_owned() }),
        }
    }
    all
}

/// Messages that a line has most in common with; of words that are no line the messages that have them all.
fn matching(line: &str) -> Vec<Refusal> {
    let line = line.trim().trim_start_matches("error: ");
    let mut found: Vec<_> =
        refusals().into_iter().filter_map(|refusal| Some((refusal.in_common(line)?, refusal))).collect();
    found.sort_by_key(|(in_common, _)| Reverse(*in_common));
    if let Some(&(best, _)) = found.first() {
        return found.into_iter().filter(|(in_common, _)| *in_common == best).map(|(_, refusal)| refusal).collect();
    }
    let words: Vec<String> = line.to_lowercase().split_whitespace().map(str::to_owned).collect();
    refusals().into_iter().filter(|refusal| refusal.has_words(&words)).collect()
}

#[cfg(test)]
mod tests {
    use super::{LEAST_LETTERS, matching, refusals};

    #[test]
    fn every_message_is_found_by_a_line_of_it() {
        let all = refusals();
        assert!(all.len() > 200);
        for refusal in &all {
            assert!(!refusal.about.is_empty(), "{}", refusal.message);
            let fixed: Vec<&str> = refusal.fixed().collect();
            if fixed.concat().chars().filter(|letter| letter.is_alphanumeric()).count() >= LEAST_LETTERS {
                let found = matching(&format!("error: {}", fixed.join("7")));
                assert!(found.iter().any(|found| found.message == refusal.message), "{}", refusal.message);
            }
        }
    }

    #[test]
    fn a_printed_line_has_its_own_message_first_and_words_have_those_with_them() {
        for (line, message) in [
            ("error: brake.toml: study.samples = 0; allowed: >= 1", "{path}: {field} = {value}; allowed: {allowed}"),
            (
                "error: no.toml: cannot be read: No such file or directory (os error 2)",
                "{path}: cannot be read: {source}",
            ),
        ] {
            let found: Vec<&str> = matching(line).iter().map(|refusal| refusal.message).collect();
            assert_eq!(found, [message]);
        }
        assert!(
            matching("Degrees freedom").iter().any(|found| found.message == "the system has no degrees of freedom")
        );
        assert!(matching("nothing that is said anywhere").is_empty());
    }
}
