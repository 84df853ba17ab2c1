//! Degrees of freedom by name.

use formats::Dof;
use study::Moves;

use super::schema::Dofs;
use crate::CaseError;
use crate::check::Check;

/// Most names that a message lists; chosen, so that the message stays short.
const MOST_NAMES_LISTED: usize = 12;

/// The names of all degrees of freedom, in the order of rows and columns.
pub(super) struct DofNames<'a> {
    check: &'a Check<'a>,
    names: Vec<String>,
    moves: Vec<Moves>,
}

/// Kind of the motion of a row that a file names: directions 1 to 3 are displacements, 4 to 6 rotations.
fn moves_of(dof: &Dof) -> Moves {
    match dof.direction {
        1..=3 => Moves::Along,
        4..=6 => Moves::Turns,
        _ => Moves::Unknown,
    }
}

impl<'a> DofNames<'a> {
    /// The given names, one for each row, or the names in the files, as `1042.z`, or "1" to "n".
    pub fn new(
        check: &'a Check<'a>,
        given: Option<Vec<String>>,
        rows: Option<Vec<Dof>>,
        order: usize,
    ) -> Result<Self, CaseError> {
        if let (Some(given), Some(rows)) = (&given, &rows) {
            let found = format!("a list of {}", given.len());
            let first = rows.first().map_or_else(String::new, |row| format!(", as {row}"));
            let allowed = format!("none: the files of the matrices name their rows themselves{first}");
            return Err(check.value("brake.dofs", found, &allowed));
        }
        if let Some(rows) = rows {
            // Of a list that numbers its rows the numbers are the names.
            let name = |dof: &Dof| if dof.direction == 0 { dof.node.to_string() } else { dof.to_string() };
            return Ok(Self {
                check,
                names: rows.iter().map(name).collect(),
                moves: rows.iter().map(moves_of).collect(),
            });
        }
        let names = given.unwrap_or_else(|| (1..=order).map(|number| number.to_string()).collect());
        if names.len() != order {
            let allowed = format!("{order}, one for each row of the matrices");
            return Err(check.value("brake.dofs", format!("a list of {}", names.len()), &allowed));
        }
        check.no_repeats("brake.dofs", names.iter().cloned())?;
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if let Some(name) = names.iter().find(|name| name.is_empty() || !name.chars().all(is_plain)) {
            return Err(check.value("brake.dofs", format!("{name:?}"), "letters, digits and _"));
        }
        let moves = vec![Moves::Unknown; order];
        Ok(Self { check, names, moves })
    }

    /// Kinds of the motions of all degrees of freedom: unknown where the case names them, and no file.
    pub fn moves(&self) -> &[Moves] {
        &self.moves
    }

    /// Names of all degrees of freedom, in the order of rows and columns.
    pub fn into_names(self) -> Vec<String> {
        self.names
    }

    /// Number of degrees of freedom.
    pub fn order(&self) -> usize {
        self.names.len()
    }

    /// The name of a degree of freedom by its index; empty out of range.
    pub fn name(&self, dof: usize) -> &str {
        self.names.get(dof).map_or("", String::as_str)
    }

    /// The index of the degree of freedom with a name.
    pub fn index(&self, field: &str, name: &str) -> Result<usize, CaseError> {
        self.position(name).ok_or_else(|| self.unknown(field, name, ""))
    }

    /// The indices of names and of ranges "first-last", which follow the order of rows, in the order in which they are listed. A repeated one is refused.
    pub fn indices(&self, field: &str, dofs: &Dofs) -> Result<Vec<usize>, CaseError> {
        let items = match dofs {
            Dofs::One(item) => std::slice::from_ref(item),
            Dofs::List(items) => items.as_slice(),
        };
        let mut all = Vec::new();
        for item in items {
            let single = self.position(item.trim()).map(|dof| (dof, dof));
            // Numbers of nodes may be negative, so that any dash may be the one between two names.
            let range = || {
                let named = |(at, dash): (usize, &str)| {
                    Some((self.position(item[..at].trim())?, self.position(item[at + dash.len()..].trim())?))
                };
                item.match_indices('-').find_map(named)
            };
            match single.or_else(range) {
                Some((first, last)) if first <= last => all.extend(first..=last),
                None if !item.contains('-') => return Err(self.unknown(field, item, "")),
                _ => return Err(self.unknown(field, item, ", a range \"first-last\" in their order")),
            }
        }
        let mut seen = vec![false; self.order()];
        for &dof in &all {
            if std::mem::replace(&mut seen[dof], true) {
                return Err(self.check.value(field, format!("{:?}", self.name(dof)), "each once"));
            }
        }
        Ok(all)
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    fn unknown(&self, field: &str, found: &str, also: &str) -> CaseError {
        let listed = self.names[..self.order().min(MOST_NAMES_LISTED)].join(", ");
        let more = if self.order() > MOST_NAMES_LISTED {
            format!(", ..., {}", self.name(self.order() - 1))
        } else {
            String::new()
        };
        self.check.value(field, format!("{found:?}"), &format!("the degrees of freedom {listed}{more}{also}"))
    }
}
