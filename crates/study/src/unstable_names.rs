//! Instabilities of one outcome, and the names that they may have.

use std::collections::BTreeMap;

use montecarlo::{Trial, occurring_labels};

use super::{ModeLabel, Outcome};

/// Names of unstable modes, from the candidate names of each; the value says whether the name is sure. A mode without a name may be any
/// of `all`, and is listed as unnamed.
pub(crate) fn unstable_names(candidates: &[impl AsRef<[ModeLabel]>], all: &[ModeLabel]) -> BTreeMap<ModeLabel, bool> {
    let known = occurring_labels(candidates).into_iter().map(|(name, trial)| (name, trial == Trial::Yes));
    let mut names: BTreeMap<ModeLabel, bool> = known.collect();
    if candidates.iter().any(|names| names.as_ref().is_empty()) {
        for &name in all {
            names.entry(name).or_insert(false);
        }
        names.insert(ModeLabel::UNNAMED, true);
    }
    names
}

impl Outcome {
    /// True if anything surely is unstable.
    #[must_use]
    pub fn is_unstable(&self) -> bool {
        self.instabilities() > 0
    }

    /// True if nothing surely is unstable, and a verdict is open.
    #[must_use]
    pub fn may_be_unstable(&self) -> bool {
        !self.is_unstable() && self.undecided > 0
    }

    /// Number of unstable modes and divergences.
    #[must_use]
    pub fn instabilities(&self) -> u32 {
        self.unstable.len() as u32 + self.divergent
    }

    /// Names of all that is unstable, or may be, each with whether it is sure; divergence is listed as [`ModeLabel::DIVERGENCE`].
    pub(crate) fn unstable_names(&self, all: &[ModeLabel]) -> BTreeMap<ModeLabel, bool> {
        let [unstable, open] = self.candidate_names();
        let mut names = unstable_names(&unstable, all);
        for (name, _) in unstable_names(&open, all) {
            names.entry(name).or_insert(false);
        }
        if self.divergent > 0 || self.undecided_real > 0 {
            names.insert(ModeLabel::DIVERGENCE, self.divergent > 0);
        }
        names
    }

    /// Names that each unstable mode may have, and names that each mode whose verdict is open may have.
    pub(crate) fn candidate_names(&self) -> [Vec<&[ModeLabel]>; 2] {
        let unstable = self.unstable.iter().map(|mode| mode.names.as_slice()).collect();
        [unstable, self.open.iter().map(|mode| mode.names.as_slice()).collect()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(numbers: &[u16]) -> Vec<ModeLabel> {
        numbers.iter().copied().map(ModeLabel::new).collect()
    }

    #[test]
    fn names_of_a_mode_without_one_are_open() {
        let names = |modes: &[&[u16]]| {
            let candidates: Vec<Vec<ModeLabel>> = modes.iter().map(|names| labels(names)).collect();
            let found = unstable_names(&candidates, &labels(&[1, 2, 3]));
            found.into_iter().map(|(name, is_sure)| (name.to_string(), is_sure)).collect::<Vec<_>>()
        };
        let expected = |names: &[(&str, bool)]| -> Vec<(String, bool)> {
            names.iter().map(|(name, is_sure)| ((*name).to_owned(), *is_sure)).collect()
        };
        let one_unnamed = [("1", false), ("2", true), ("3", false), ("unnamed", true)];
        assert_eq!(names(&[&[2], &[]]), expected(&one_unnamed));
        let all_unnamed = [("1", false), ("2", false), ("3", false), ("unnamed", true)];
        assert_eq!(names(&[&[], &[], &[]]), expected(&all_unnamed));
        assert_eq!(names(&[&[2], &[1, 3]]), expected(&one_unnamed[..3]));
        assert!(names(&[]).is_empty());
    }
}
