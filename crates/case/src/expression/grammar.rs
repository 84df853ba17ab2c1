//! The check of an expression before `exmex` parses it, and its translation to the form that `exmex` gets.
//!
//! The check is one pass with a list of the open parentheses and no recursion, so that no text overflows the stack. An
//! expression that passes is translated to a form that `exmex` reads in one way only:
//!
//! - names of parameters are put in braces, which tell them from functions;
//! - numbers are written without exponents, which `exmex` does not read;
//! - a leading minus becomes `0 -`, as `exmex` is given no unary minus (`operators.rs`), and a negative number gets parentheses;
//! - a call of a table, `modulus(T)`, becomes a variable, and its argument an expression of its own.

use std::sync::Arc;

use super::{ExpressionError, TableFunction};

/// Most characters of an expression; chosen: several times the length of a usual coefficient, and short enough that parsing
/// and evaluating take milliseconds.
pub(super) const LONGEST_EXPRESSION: usize = 1000;
/// Most parentheses open at one place, without those that a negative number gets; chosen, because `exmex` recurses once for each.
pub(super) const DEEPEST_NESTING: usize = 32;
/// Words for what is allowed where an operand is expected.
const OPERAND: &str = "a number, a parameter, a function or \"(\"";
/// Words for what is allowed after an operand.
const AFTER_OPERAND: &str = "+ - * / ^ or \")\"";

/// The state of the pass since an opening parenthesis or the start of the text.
#[derive(Default)]
pub(super) struct Level {
    /// Column of the parenthesis.
    column: usize,
    /// True once any operand or sign has been read.
    pub(super) begun: bool,
    /// True if the last operator was `^`; a second one would have two readings.
    power: bool,
    /// True if the last operand is a number with a minus sign; a power of it, as in `2*-3^2`, would have two readings.
    negative: bool,
    /// Index of the table that is called with what is in the parentheses, and the byte of the translated text at which that begins.
    pub(super) call: Option<(usize, usize)>,
}

/// An expression in the form that `exmex` gets.
pub(super) struct Checked {
    pub(super) text: String,
    /// Calls of tables, inner ones first.
    pub(super) calls: Vec<CheckedCall>,
}

/// A call of a table.
pub(super) struct CheckedCall {
    /// Index of the table.
    pub(super) table: usize,
    /// The argument, in the form that `exmex` gets.
    pub(super) argument: String,
}

/// Name of the variable that stands for a call, by its index; no parameter can have it.
pub(super) fn name_of_call(call: usize) -> String {
    format!("#{call}")
}

/// Pass through the characters of an expression.
pub(super) struct Pass<'a> {
    pub(super) characters: Vec<char>,
    /// Index of the next character.
    pub(super) at: usize,
    pub(super) parameters: &'a [String],
    pub(super) tables: &'a [Arc<TableFunction>],
    levels: Vec<Level>,
    /// Text that is translated so far.
    pub(super) out: String,
    calls: Vec<CheckedCall>,
}

/// The expression in the form that `exmex` gets.
///
/// # Errors
/// The first thing in it that is not allowed, with its column.
pub(super) fn checked(
    text: &str,
    parameters: &[String],
    tables: &[Arc<TableFunction>],
) -> Result<Checked, ExpressionError> {
    let length = text.chars().take(LONGEST_EXPRESSION + 1).count();
    if length > LONGEST_EXPRESSION {
        return Err(ExpressionError::TooLong { text: shown(text) });
    }
    let mut pass = Pass {
        characters: text.chars().collect(),
        at: 0,
        parameters,
        tables,
        levels: vec![Level::default()],
        out: String::new(),
        calls: Vec::new(),
    };
    pass.run().map_err(|fault| ExpressionError::Syntax {
        text: shown(text),
        column: fault.column,
        found: fault.found,
        allowed: fault.allowed,
    })?;
    Ok(Checked { text: pass.out, calls: pass.calls })
}

/// The text for a message, shortened where it is long.
pub(super) fn shown(text: &str) -> String {
    /// Most characters of an expression that a message shows; chosen.
    const LONGEST_SHOWN: usize = 80;
    let clean = |c: char| if c.is_control() { ' ' } else { c };
    let start: String = text.chars().take(LONGEST_SHOWN).map(clean).collect();
    if text.chars().nth(LONGEST_SHOWN).is_some() { start + "..." } else { start }
}

/// True if a character can begin a name.
pub(super) fn starts_name(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '_'
}

/// A fault of an expression.
pub(super) struct Fault {
    /// Column, from 1, in characters.
    pub(super) column: usize,
    pub(super) found: String,
    pub(super) allowed: String,
}

impl Pass<'_> {
    fn run(&mut self) -> Result<(), Fault> {
        loop {
            self.up_to_operand()?;
            if !self.after_operand()? {
                return Ok(());
            }
        }
    }

    /// Reads the next number or name, with all parentheses and functions that open before it.
    fn up_to_operand(&mut self) -> Result<(), Fault> {
        loop {
            let c = self.next_character(OPERAND)?;
            if c == '(' {
                self.open()?;
            } else if c == '-' {
                if self.minus()? {
                    return Ok(());
                }
            } else if c.is_ascii_digit() || c == '.' {
                let value = self.number()?;
                self.out += &value.to_string();
                return Ok(());
            } else if starts_name(c) {
                if self.name()? {
                    return Ok(());
                }
            } else {
                return Err(self.unexpected(OPERAND));
            }
        }
    }

    /// Reads a minus where an operand is expected, and the number after it where it is the sign of one; returns whether it is.
    fn minus(&mut self) -> Result<bool, Fault> {
        let column = self.at + 1;
        self.at += 1;
        let level = self.level();
        if !std::mem::replace(&mut level.begun, true) {
            self.out += "0-";
            return Ok(false);
        }
        self.skip_spaces();
        match self.characters.get(self.at) {
            Some(c) if c.is_ascii_digit() || *c == '.' => {
                let value = self.number()?;
                self.level().negative = true;
                self.out += &format!("(0-{value})");
                Ok(true)
            }
            _ => Err(Fault {
                column,
                found: "a second sign".into(),
                allowed: "a minus after an operator only before a number, else in parentheses, as in 2*(-w)".into(),
            }),
        }
    }

    /// Reads closing parentheses and the next operator; `false` at the end of the text.
    fn after_operand(&mut self) -> Result<bool, Fault> {
        loop {
            self.skip_spaces();
            let Some(&c) = self.characters.get(self.at) else {
                return match self.levels.len() {
                    1 => Ok(false),
                    _ => Err(Fault {
                        column: self.level().column,
                        found: "\"(\" is never closed".into(),
                        allowed: "one \")\" for each \"(\"".into(),
                    }),
                };
            };
            match c {
                ')' => {
                    if self.levels.len() == 1 {
                        return Err(Fault {
                            column: self.at + 1,
                            found: "\")\" closes nothing".into(),
                            allowed: "one \"(\" for each \")\"".into(),
                        });
                    }
                    let call = self.levels.pop().and_then(|level| level.call);
                    self.at += 1;
                    match call {
                        Some((table, begins)) => self.end_call(table, begins),
                        None => self.out.push(')'),
                    }
                }
                '+' | '-' | '*' | '/' | '^' => {
                    self.check_power(c)?;
                    let level = self.level();
                    level.power = c == '^';
                    level.negative = false;
                    self.at += 1;
                    self.out.push(c);
                    return Ok(true);
                }
                _ => return Err(self.unexpected(AFTER_OPERAND)),
            }
        }
    }

    /// A fault for a power with two readings.
    fn check_power(&mut self, operator: char) -> Result<(), Fault> {
        let column = self.at + 1;
        let level = self.level();
        let allowed = match (operator, level.power, level.negative) {
            ('^', true, _) => "parentheses that say which power is taken first, as in (a^b)^c",
            ('^', _, true) => "parentheses that say what is negative, as in (-2)^w or -(2^w)",
            _ => return Ok(()),
        };
        Err(Fault { column, found: "a power with two readings".into(), allowed: allowed.into() })
    }

    /// Reads an opening parenthesis.
    pub(super) fn open(&mut self) -> Result<(), Fault> {
        if self.levels.len() > DEEPEST_NESTING {
            return Err(Fault {
                column: self.at + 1,
                found: format!("more than {DEEPEST_NESTING} parentheses open"),
                allowed: format!("{DEEPEST_NESTING} at most"),
            });
        }
        self.level().begun = true;
        self.at += 1;
        self.levels.push(Level { column: self.at, ..Level::default() });
        self.out.push('(');
        Ok(())
    }

    /// Puts a variable in the place of a call of a table, whose argument begins at a place of the translated text.
    fn end_call(&mut self, table: usize, begins: usize) {
        let argument = self.out.split_off(begins);
        // The parenthesis before it.
        self.out.pop();
        self.out += &format!("{{{}}}", name_of_call(self.calls.len()));
        self.calls.push(CheckedCall { table, argument });
    }

    fn next_character(&mut self, allowed: &str) -> Result<char, Fault> {
        self.skip_spaces();
        match self.characters.get(self.at) {
            Some(&c) => Ok(c),
            None => Err(self.unexpected(allowed)),
        }
    }

    fn unexpected(&self, allowed: &str) -> Fault {
        let found = match self.characters.get(self.at) {
            Some(c) => format!("unexpected {:?}", c.to_string()),
            None if self.characters.iter().all(|c| c.is_whitespace()) => "nothing".into(),
            None => "unexpected end".into(),
        };
        Fault { column: self.at + 1, found, allowed: allowed.into() }
    }

    pub(super) fn skip_spaces(&mut self) {
        while self.characters.get(self.at).is_some_and(|c| c.is_ascii_whitespace()) {
            self.at += 1;
        }
    }

    /// The innermost level; the outermost one always exists.
    pub(super) fn level(&mut self) -> &mut Level {
        if self.levels.is_empty() {
            self.levels.push(Level::default());
        }
        let last = self.levels.len() - 1;
        &mut self.levels[last]
    }
}
