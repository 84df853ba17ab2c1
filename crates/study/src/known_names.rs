//! The names of modes at known points of a scene, each followed once to the reference: samples near by take theirs from these.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use super::{KnownMode, ModeLabel};

/// The names of a mode; `None` where it cannot be followed.
type Names = Option<Vec<ModeLabel>>;

/// Names found so far, by known point and mode. Every thread that finds one finds the same.
#[derive(Debug, Default)]
pub(super) struct KnownNames {
    found: Mutex<HashMap<(usize, usize), Names>>,
}

impl KnownNames {
    /// The names of a mode; `find` finds them where they are not known yet.
    ///
    /// # Errors
    /// Those of finding them.
    pub fn of<E>(&self, known: &KnownMode, find: impl FnOnce() -> Result<Names, E>) -> Result<Names, E> {
        let key = (known.point, known.mode);
        let at_hand = self.found.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        if let Some(names) = at_hand {
            return Ok(names);
        }
        // Others may find names meanwhile, the same ones too.
        let names = find()?;
        self.found.lock().unwrap_or_else(PoisonError::into_inner).insert(key, names.clone());
        Ok(names)
    }
}
