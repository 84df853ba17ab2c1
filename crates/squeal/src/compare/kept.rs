//! Samples that a study has kept, of one scene, read from its table.

use std::collections::BTreeMap;

use montecarlo::{Proportion, Trial, occurring_labels};

/// Question about a sample.
#[derive(Debug, Clone, Copy)]
pub(super) enum Question<'a> {
    /// Is anything unstable?
    Anything,
    /// Is the mode with this name unstable?
    Mode(&'a str),
}

/// The samples of a scene by their indices. One that is missing, because its draw failed, tells nothing.
#[derive(Debug, Default)]
pub(super) struct Kept(BTreeMap<u64, Option<Unstable>>);

/// Modes that are unstable in a sample.
#[derive(Debug)]
struct Unstable {
    /// Modes that are unstable, or may be.
    modes: BTreeMap<String, Trial>,
    /// A mode without a name is, or may be.
    has_unnamed: bool,
    /// Nothing surely is, and a verdict is open.
    is_open: bool,
}

impl Kept {
    /// Enters a sample by its cells `growth`, `unstable` and `may_be`, and whether nothing surely is unstable and a verdict is open.
    pub fn enter(&mut self, index: u64, [growth, unstable, may_be]: [&str; 3], is_open: bool) {
        let names = |names: &str| -> Vec<String> {
            if names == "?" { Vec::new() } else { names.split('|').map(str::to_owned).collect() }
        };
        let candidates: Vec<Vec<String>> =
            unstable.split(';').filter_map(|mode| Some(names(mode.rsplit_once(':')?.0))).collect();
        let open: Vec<Vec<String>> = may_be.split_terminator(';').map(names).collect();
        let mut modes = occurring_labels(&candidates);
        for name in open.iter().flatten() {
            modes.entry(name.clone()).or_insert(Trial::Ambiguous);
        }
        let is_unnamed = |of: &[Vec<String>]| of.iter().any(Vec::is_empty);
        let has_unnamed = is_unnamed(&candidates) || is_unnamed(&open);
        if has_unnamed {
            modes.insert("unnamed".into(), if is_unnamed(&candidates) { Trial::Yes } else { Trial::Ambiguous });
        }
        // A sample without growth rates is one whose evaluation failed.
        self.0.insert(index, (!growth.is_empty()).then_some(Unstable { modes, has_unnamed, is_open }));
    }

    /// The answer of a sample.
    pub fn trial(&self, index: u64, question: Question<'_>) -> Trial {
        let Some(Unstable { modes, has_unnamed, is_open }) = self.0.get(&index).and_then(Option::as_ref) else {
            return Trial::Ambiguous;
        };
        match question {
            Question::Anything if *is_open => Trial::Ambiguous,
            Question::Anything if modes.is_empty() => Trial::No,
            Question::Anything => Trial::Yes,
            Question::Mode(name) => {
                let otherwise = if *has_unnamed { Trial::Ambiguous } else { Trial::No };
                modes.get(name).copied().unwrap_or(otherwise)
            }
        }
    }

    /// Proportion of the first `samples` samples in which a mode is unstable.
    pub fn proportion(&self, samples: u64, name: &str) -> Proportion {
        let mut found = Proportion::default();
        (0..samples).for_each(|index| found.record(self.trial(index, Question::Mode(name))));
        found
    }
}
