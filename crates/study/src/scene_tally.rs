//! Counts of the samples of one scene.

use std::collections::{BTreeMap, BTreeSet};

use montecarlo::{LabelTally, Merge as _, Proportion, QuantileSketch};
use serde::{Deserialize, Serialize};

use super::third_octave::{InThirdOctave, ThirdOctave};
use super::{ModeLabel, Outcome};

/// Counts of one scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SceneTally {
    /// Samples solved, including samples that a certificate covers.
    pub solved: u64,
    /// Samples that a certificate covers: stable up to rounding, without a spectrum.
    pub certified: u64,
    /// Samples with any unstable mode or divergence.
    pub any_unstable: u64,
    /// Samples in which nothing surely is unstable and a verdict is open.
    pub perhaps_unstable: u64,
    /// Unstable modes in all samples.
    pub unstable_modes: u64,
    /// Number of the unstable modes that have not one sure name: they pass near a coalescence, or began to oscillate on the path.
    pub ambiguous_modes: u64,
    /// Real eigenvalues surely beyond the threshold.
    pub divergent: u64,
    /// Samples with a real eigenvalue surely beyond the threshold.
    pub diverging: u64,
    /// Samples in which no real eigenvalue surely is beyond the threshold, and the verdict on one is open.
    pub perhaps_diverging: u64,
    /// Verdicts that the error bound leaves open.
    pub undecided: u64,
    /// Eigenvalues on the imaginary axis to within rounding of the matrices.
    pub marginal: u64,
    /// Unstable modes of a reduced brake whose residual in the full model is known.
    pub residuals: u64,
    /// Unstable modes whose residual in the full model is above the one that was asked for.
    pub residuals_above: u64,
    /// Largest relative residual of an unstable mode in the full model.
    pub largest_residual: f64,
    /// Samples in which any mode of a third octave is unstable, or may be.
    pub third_octaves: BTreeMap<ThirdOctave, InThirdOctave>,
    /// Samples in which a tracked mode is unstable, by name; ambiguous where an unstable mode may be this one or another, or has
    /// no name and may be any, or where the verdict on this mode is open.
    pub tracked: LabelTally<ModeLabel>,
    /// Samples in which the mode of a frequency rank is unstable; ambiguous where the verdict on it is open.
    pub ranked: LabelTally<ModeLabel>,
    /// Net work of each body in one period per `phi^H M phi`, 1/s^2, by name of the mode, over the samples in which it is
    /// unstable and known by name; one sketch for each body of the scene's brake.
    pub net_work: BTreeMap<ModeLabel, Vec<QuantileSketch>>,
    /// Net work as in `net_work`, apart for each family of forces, in the order of `AffineSystem::families`: for each family one sketch for each body.
    pub family_work: BTreeMap<ModeLabel, Vec<Vec<QuantileSketch>>>,
}

impl SceneTally {
    /// Samples in which anything is unstable, samples with open verdicts as ambiguous.
    pub fn any(&self) -> Proportion {
        Proportion::of_counts(self.any_unstable, self.perhaps_unstable, self.solved)
    }

    /// Samples with divergence.
    pub fn divergence(&self) -> Proportion {
        Proportion::of_counts(self.diverging, self.perhaps_diverging, self.solved)
    }

    /// Samples with an unstable mode that has no name as a tracked mode.
    pub fn unnamed(&self) -> Proportion {
        self.tracked.unlabelled()
    }

    pub(crate) fn record(&mut self, outcome: &Outcome) {
        self.solved += 1;
        self.certified += u64::from(outcome.is_certified);
        self.any_unstable += u64::from(outcome.is_unstable());
        self.perhaps_unstable += u64::from(outcome.may_be_unstable());
        self.unstable_modes += outcome.unstable.len() as u64;
        self.divergent += u64::from(outcome.divergent);
        self.diverging += u64::from(outcome.divergent > 0);
        self.perhaps_diverging += u64::from(outcome.divergent == 0 && outcome.undecided_real > 0);
        self.undecided += u64::from(outcome.undecided);
        self.record_third_octaves(outcome);
        self.marginal += u64::from(outcome.marginal);
        for mode in &outcome.unstable {
            if let Some(residual) = mode.residual {
                self.residuals += 1;
                self.residuals_above += u64::from(residual.is_above);
                self.largest_residual = self.largest_residual.max(residual.value);
            }
            if mode.names.len() != 1 {
                self.ambiguous_modes += 1;
            }
            if let (&[name], Some(work)) = (mode.names.as_slice(), &mode.work) {
                record_work(self.net_work.entry(name).or_default(), &work.net());
                let families = self.family_work.entry(name).or_default();
                families.resize_with(families.len().max(work.families.len()), Vec::new);
                families.iter_mut().zip(&work.families).for_each(|(bodies, work)| record_work(bodies, &work.bodies));
            }
        }
        let unstable: Vec<_> = outcome.unstable.iter().map(|mode| [mode.rank]).collect();
        self.ranked.record_with_open(&unstable, &outcome.open.iter().map(|mode| [mode.rank]).collect::<Vec<_>>());
        let [unstable, open] = outcome.candidate_names();
        self.tracked.record_with_open(&unstable, &open);
    }

    /// Enters the third octaves in which a mode is unstable, or may be.
    fn record_third_octaves(&mut self, outcome: &Outcome) {
        let of = |omegas: &mut dyn Iterator<Item = f64>| -> BTreeSet<ThirdOctave> {
            omegas.filter(|omega| *omega > 0.0).map(ThirdOctave::of_omega).collect()
        };
        let unstable = of(&mut outcome.unstable.iter().map(|mode| mode.lambda.im));
        let perhaps = of(&mut outcome.open.iter().map(|mode| mode.omega));
        for &octave in &unstable {
            self.third_octaves.entry(octave).or_default().unstable += 1;
        }
        for &octave in perhaps.difference(&unstable) {
            self.third_octaves.entry(octave).or_default().perhaps += 1;
        }
    }

    /// Samples in which any mode of a third octave is unstable, samples with open verdicts there as ambiguous.
    pub fn in_third_octave(&self, octave: ThirdOctave) -> Proportion {
        let InThirdOctave { unstable, perhaps } = self.third_octaves.get(&octave).copied().unwrap_or_default();
        Proportion::of_counts(unstable, perhaps, self.solved)
    }

    pub(crate) fn merge(&mut self, later: Self) {
        for (octave, InThirdOctave { unstable, perhaps }) in later.third_octaves {
            let own = self.third_octaves.entry(octave).or_default();
            (own.unstable, own.perhaps) = (own.unstable + unstable, own.perhaps + perhaps);
        }
        self.solved += later.solved;
        self.certified += later.certified;
        self.any_unstable += later.any_unstable;
        self.perhaps_unstable += later.perhaps_unstable;
        self.unstable_modes += later.unstable_modes;
        self.ambiguous_modes += later.ambiguous_modes;
        self.divergent += later.divergent;
        self.diverging += later.diverging;
        self.perhaps_diverging += later.perhaps_diverging;
        self.undecided += later.undecided;
        self.marginal += later.marginal;
        self.residuals += later.residuals;
        self.residuals_above += later.residuals_above;
        self.largest_residual = self.largest_residual.max(later.largest_residual);
        self.tracked.merge(later.tracked);
        self.ranked.merge(later.ranked);
        for (name, bodies) in later.net_work {
            self.net_work.entry(name).or_default().merge(bodies);
        }
        for (name, families) in later.family_work {
            self.family_work.entry(name).or_default().merge(families);
        }
    }
}

/// Enters the work on each body.
fn record_work(bodies: &mut Vec<QuantileSketch>, work: &[f64]) {
    bodies.resize_with(bodies.len().max(work.len()), QuantileSketch::default);
    bodies.iter_mut().zip(work).for_each(|(sketch, &value)| sketch.record(value));
}

#[cfg(test)]
mod tests {
    use montecarlo::Confidence;
    use num_complex::Complex;

    use super::*;
    use crate::{OpenMode, UnstableMode};

    fn labels(numbers: &[u16]) -> Vec<ModeLabel> {
        numbers.iter().copied().map(ModeLabel::new).collect()
    }

    fn unstable(names: &[&[u16]]) -> Vec<UnstableMode> {
        let mode = |(names, rank): (&&[u16], u16)| UnstableMode {
            rank: ModeLabel::new(rank),
            lambda: Complex::new(1.0, 100.0),
            names: labels(names),
            names_by_likeness: None,
            work: None,
            residual: None,
        };
        names.iter().zip(1..).map(mode).collect()
    }

    #[test]
    fn an_unstable_mode_without_a_name_is_in_the_upper_limit_of_every_mode_that_it_could_be() {
        let mut tally = SceneTally::default();
        for modes in [unstable(&[&[1], &[]]), unstable(&[&[1], &[2, 3]])] {
            (0..100).for_each(|_| tally.record(&Outcome { unstable: modes.clone(), ..Outcome::default() }));
        }
        let counts = |name: u16| {
            let proportion = tally.tracked.proportion(&ModeLabel::new(name));
            (proportion.hits(), proportion.ambiguous())
        };
        assert_eq!([1, 2, 3, 4].map(counts), [(200, 0), (0, 200), (0, 200), (0, 100)]);
        assert_eq!(tally.ambiguous_modes, 200);
        // A mode that was never seen by name may be unstable half of the time.
        let never = tally.tracked.interval(&ModeLabel::new(4), Confidence::P95);
        assert!(never.lower == 0.0 && never.upper > 0.5, "{never:?}");
        assert_eq!(tally.ranked.proportion(&ModeLabel::new(2)).ambiguous(), 0);
    }

    #[test]
    fn a_mode_whose_verdict_is_open_is_in_its_own_upper_limit_and_in_that_of_no_other() {
        let open = |names: &[u16]| OpenMode {
            rank: ModeLabel::new(7),
            omega: 100.0,
            names: labels(names),
            names_by_likeness: None,
        };
        let mut tally = SceneTally::default();
        let outcome = |of: &[u16]| Outcome {
            unstable: unstable(&[&[1]]),
            open: vec![open(of)],
            undecided: 1,
            ..Outcome::default()
        };
        (0..100).for_each(|_| tally.record(&outcome(&[2])));
        let counts = |tally: &SceneTally, name: u16| {
            let proportion = tally.tracked.proportion(&ModeLabel::new(name));
            (proportion.hits(), proportion.ambiguous())
        };
        assert_eq!([1, 2, 3].map(|name| counts(&tally, name)), [(100, 0), (0, 100), (0, 0)]);
        assert_eq!(tally.ranked.proportion(&ModeLabel::new(7)).ambiguous(), 100);
        // One that has no name may be any, and is unnamed perhaps.
        (0..50).for_each(|_| tally.record(&outcome(&[])));
        assert_eq!([1, 2, 3].map(|name| counts(&tally, name)), [(150, 0), (0, 150), (0, 50)]);
        assert_eq!((tally.unnamed().hits(), tally.unnamed().ambiguous()), (0, 50));
    }
}
