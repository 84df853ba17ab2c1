//! Numbers, names of parameters, constants and functions in an expression.

use super::grammar::{Fault, Pass, shown, starts_name};
use super::operators::FUNCTIONS;

/// True if a name can be the name of a parameter: a letter or `_`, then letters, digits and `_`, all ASCII, and neither a
/// function nor a constant.
pub fn is_parameter_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(starts_name)
        && characters.all(continues_name)
        && !is_function(name)
        && constant(name).is_none()
}

fn continues_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|(function, _)| *function == name)
}

fn constant(name: &str) -> Option<f64> {
    (name == "pi").then_some(std::f64::consts::PI)
}

impl Pass<'_> {
    /// Reads a number: digits with at most one point and an exponent, not followed by a letter.
    pub(super) fn number(&mut self) -> Result<f64, Fault> {
        self.level().begun = true;
        let start = self.at;
        let mut complete = self.skip_digits();
        if self.characters.get(self.at) == Some(&'.') {
            self.at += 1;
            complete |= self.skip_digits();
        }
        if complete && matches!(self.characters.get(self.at), Some('e' | 'E')) {
            self.at += 1;
            if matches!(self.characters.get(self.at), Some('+' | '-')) {
                self.at += 1;
            }
            complete = self.skip_digits();
        }
        let joined = self.characters.get(self.at).is_some_and(|c| continues_name(*c) || *c == '.');
        let text: String = self.characters[start..self.at].iter().collect();
        let fault = |found| Fault {
            column: start + 1,
            found,
            allowed: "numbers as 2, 0.5 or 1e-3, with * before a name".into(),
        };
        match text.parse::<f64>() {
            Ok(0.0) if complete && !joined && is_not_zero(&text) => {
                Err(fault(format!("{} is too small", shown(&text))))
            }
            Ok(value) if complete && !joined && value.is_finite() => Ok(value),
            Ok(_) if complete && !joined => Err(fault(format!("{} is too large", shown(&text)))),
            _ => {
                let rest = self.characters[self.at..].iter().take_while(|c| continues_name(**c) || **c == '.');
                Err(fault(format!("{:?} is no number", shown(&(text + &rest.collect::<String>())))))
            }
        }
    }

    /// Skips digits; returns whether there were any.
    fn skip_digits(&mut self) -> bool {
        let from = self.at;
        while self.characters.get(self.at).is_some_and(char::is_ascii_digit) {
            self.at += 1;
        }
        self.at > from
    }

    /// Reads a parameter or constant (`true`), or a function or table with its opening parenthesis (`false`).
    pub(super) fn name(&mut self) -> Result<bool, Fault> {
        self.level().begun = true;
        let start = self.at;
        while self.characters.get(self.at).is_some_and(|c| continues_name(*c)) {
            self.at += 1;
        }
        let name: String = self.characters[start..self.at].iter().collect();
        if is_function(&name) {
            self.out += &name;
            return self.argument("function", &name).map(|()| false);
        }
        if let Some(table) = self.tables.iter().position(|table| table.name() == name) {
            self.argument("table", &name)?;
            let begins = self.out.len();
            self.level().call = Some((table, begins));
            return Ok(false);
        }
        if let Some(value) = constant(&name) {
            self.out += &value.to_string();
        } else if self.parameters.contains(&name) {
            self.out += &format!("{{{name}}}");
        } else {
            return Err(Fault {
                column: start + 1,
                found: format!("unknown name {:?}", shown(&name)),
                allowed: format!("{}; {}{}", self.known_parameters(), known_functions(), self.known_tables()),
            });
        }
        Ok(true)
    }

    /// Reads the opening parenthesis after the name of a function or table.
    fn argument(&mut self, kind: &str, name: &str) -> Result<(), Fault> {
        self.skip_spaces();
        match self.characters.get(self.at) {
            Some('(') => self.open(),
            _ => Err(Fault {
                column: self.at + 1,
                found: format!("the {kind} {name} without an argument"),
                allowed: format!("parentheses, as in {name}(w)"),
            }),
        }
    }

    fn known_tables(&self) -> String {
        let names: Vec<&str> = self.tables.iter().map(|table| table.name()).collect();
        if names.is_empty() { String::new() } else { format!("; the tables {}", names.join(", ")) }
    }

    fn known_parameters(&self) -> String {
        /// Most parameters that a message lists; chosen, so that the message stays short.
        const MOST_PARAMETERS_LISTED: usize = 12;
        match self.parameters {
            [] => "no parameter is declared".into(),
            all if all.len() > MOST_PARAMETERS_LISTED => {
                format!("the parameters {}, ...", all[..MOST_PARAMETERS_LISTED].join(", "))
            }
            all => format!("the parameters {}", all.join(", ")),
        }
    }
}

fn known_functions() -> String {
    let names: Vec<&str> = FUNCTIONS.iter().map(|(name, _)| *name).collect();
    format!("the functions {}; pi", names.join(" "))
}

/// True if a number as text, exponent or not, has a digit other than 0 before its exponent.
fn is_not_zero(text: &str) -> bool {
    text.split(['e', 'E']).next().is_some_and(|digits| digits.contains(|c: char| c.is_ascii_digit() && c != '0'))
}
