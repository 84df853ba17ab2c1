//! Arrangements of contacts: which of the oscillators of a lattice, or of the patches of a mesh, are in contact.

use std::fmt;

use crate::OscModelError;

/// The oscillators of a lattice that are in contact, and the number of all of them. A finite element brake has patches in the place of oscillators.
///
/// Indices run from 0; [`fmt::Display`] prints numbers from 1.
///
/// ```
/// use osc_model::ContactArrangement;
///
/// let arrangement = ContactArrangement::new(9, &[8, 0, 4])?;
/// assert_eq!(arrangement.in_contact(), [0, 4, 8]);
/// assert_eq!(arrangement.to_string(), "1 5 9");
/// assert_eq!(ContactArrangement::all(9, 6)?.len(), 84);
/// # Ok::<(), osc_model::OscModelError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContactArrangement {
    in_contact: Vec<usize>,
    oscillators: usize,
}

impl ContactArrangement {
    /// The arrangement with the oscillators `in_contact`, by index from 0 and in any order, out of `oscillators`.
    ///
    /// # Errors
    /// An oscillator that does not exist or is named twice.
    pub fn new(oscillators: usize, in_contact: &[usize]) -> Result<Self, OscModelError> {
        let mut in_contact = in_contact.to_vec();
        in_contact.sort_unstable();
        if let Some(&last) = in_contact.last()
            && last >= oscillators
        {
            return Err(OscModelError::UnknownOscillator { number: last.saturating_add(1), oscillators });
        }
        if let Some(pair) = in_contact.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(OscModelError::RepeatedOscillator { number: pair[0] + 1 });
        }
        Ok(Self { in_contact, oscillators })
    }

    /// An arrangement as [`ContactArrangement::new`] makes it, with oscillators numbered from 1.
    ///
    /// # Errors
    /// A number that is 0, above `oscillators` or named twice.
    pub fn from_numbers(oscillators: usize, numbers: &[usize]) -> Result<Self, OscModelError> {
        let from_zero =
            |&number: &usize| number.checked_sub(1).ok_or(OscModelError::UnknownOscillator { number, oscillators });
        Self::new(oscillators, &numbers.iter().map(from_zero).collect::<Result<Vec<_>, _>>()?)
    }

    /// The arrangement with every oscillator in contact.
    pub fn full(oscillators: usize) -> Self {
        Self { in_contact: (0..oscillators).collect(), oscillators }
    }

    /// All arrangements with `in_contact` of `oscillators` in contact, in lexicographic order: C(oscillators, in_contact), the binomial coefficient.
    ///
    /// # Errors
    /// More contacts than oscillators.
    pub fn all(oscillators: usize, in_contact: usize) -> Result<Vec<Self>, OscModelError> {
        if in_contact > oscillators {
            return Err(OscModelError::TooManyInContact { in_contact, oscillators });
        }
        let mut chosen: Vec<usize> = (0..in_contact).collect();
        let mut all = Vec::new();
        loop {
            all.push(Self { in_contact: chosen.clone(), oscillators });
            // The last index that can be increased; the indices after it become the next ones.
            let Some(place) = (0..in_contact).rev().find(|&i| chosen[i] < oscillators - in_contact + i) else {
                return Ok(all);
            };
            let next = chosen[place] + 1;
            for (offset, slot) in chosen[place..].iter_mut().enumerate() {
                *slot = next + offset;
            }
        }
    }

    /// The oscillators in contact, ascending, from 0.
    pub fn in_contact(&self) -> &[usize] {
        &self.in_contact
    }

    /// Number of oscillators of the lattice, in contact or not.
    pub fn oscillators(&self) -> usize {
        self.oscillators
    }

    /// True if an oscillator, by index from 0, is in contact.
    pub fn contains(&self, oscillator: usize) -> bool {
        self.in_contact.binary_search(&oscillator).is_ok()
    }
}

impl fmt::Display for ContactArrangement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, oscillator) in self.in_contact.iter().enumerate() {
            let space = if place == 0 { "" } else { " " };
            write!(f, "{space}{}", oscillator + 1)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn all_arrangements_are_there_once() {
        for (k, count) in [(9, 1), (8, 9), (7, 36), (6, 84), (0, 1)] {
            let all = ContactArrangement::all(9, k).unwrap();
            assert_eq!(all.len(), count);
            assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), count);
            for arrangement in &all {
                assert_eq!(&ContactArrangement::new(9, arrangement.in_contact()).unwrap(), arrangement);
                assert_eq!(arrangement.in_contact().len(), k);
            }
        }
    }

    #[test]
    fn refuses_what_is_not_an_arrangement() {
        let message = |numbers: &[usize]| ContactArrangement::from_numbers(9, numbers).unwrap_err().to_string();
        assert_eq!(message(&[1, 10]), "oscillator 10 is not there; allowed: 1 to 9");
        assert_eq!(message(&[0]), "oscillator 0 is not there; allowed: 1 to 9");
        assert_eq!(message(&[3, 1, 3]), "oscillator 3 is named twice in the contact arrangement; allowed: each once");
        let error = ContactArrangement::all(9, 10).unwrap_err().to_string();
        assert_eq!(error, "10 oscillators in contact; allowed: 0 to 9");
    }
}
