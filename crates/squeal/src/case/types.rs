//! A case in the terms of the model.

use std::path::PathBuf;

use friction::BristleDamping;
use montecarlo::Distribution;
use osc_model::{ContactArrangement, Dof, Lateral, LatticeParameters, Preload};
use serde::Deserialize;

use super::{Alternative, Draws, Law};
use crate::study::{ModeLabel, ModeNaming};

/// A study, checked.
#[derive(Debug, Clone)]
pub struct LatticeCase {
    /// Where it was read from.
    pub path: PathBuf,
    /// The text that it was read from.
    pub text: String,
    /// What it calls itself.
    pub name: String,
    /// Friction laws, in the order of the file.
    pub laws: Vec<Law>,
    /// Samples per scene, >= 1.
    pub samples: u64,
    /// Seed of the random streams.
    pub seed: u64,
    /// Half width to which every occurrence is estimated as well, if asked for.
    pub half_width: Option<f64>,
    /// The lattice.
    pub lattice: LatticeParameters,
    /// How the model's open questions are read.
    pub readings: LatticeReadings,
    /// Arrangements by number in contact, in the order of the file.
    pub panels: Vec<(usize, Vec<ContactArrangement>)>,
    /// Sets of constraints, in the order of the file; at least one.
    pub constraints: Vec<ConstraintSet>,
    /// Ranges of sliding speed; at least one.
    pub speeds: Vec<SpeedRange>,
    /// Distributions of the friction parameters.
    pub friction: FrictionDistributions,
    /// Other readings to be tried.
    pub alternatives: Vec<Alternative>,
    /// What a publication prints, to compare with.
    pub paper: Option<Paper>,
}

/// The readings of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticeReadings {
    /// Friction in y.
    pub lateral: Lateral,
    /// One draw for all contacts or one each.
    pub draws: Draws,
    /// How modes are named.
    pub labels: ModeNaming,
    /// What presses the oscillators on the plate.
    pub preload: Preload,
    /// LuGre's sigma1 over speed; `None` sets it to 0.
    pub bristle_damping: Option<BristleDamping>,
}

/// Degrees of freedom held together, by name.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstraintSet {
    /// Its name.
    pub name: String,
    /// What is held.
    pub fixed: Vec<Dof>,
}

/// A range of sliding speed, drawn from log-uniformly.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedRange {
    /// Its name.
    pub name: String,
    /// Lowest, m/s, > 0.
    pub from: f64,
    /// Highest, m/s.
    pub to: f64,
}

impl SpeedRange {
    /// The speed below which the part `u` of the range lies, log-uniformly; the median for `u = 0.5`.
    pub fn quantile(&self, u: f64) -> f64 {
        self.from * (self.to / self.from).powf(u)
    }
}

/// Distributions of the friction parameters of all laws.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionDistributions {
    /// Amontons-Coulomb's coefficient, and that across the sliding of every law.
    pub mu: Distribution,
    /// Static coefficient.
    pub mu_s: Distribution,
    /// Kinetic coefficient.
    pub mu_k: Distribution,
    /// Decay over speed of the velocity-dependent law, s/m.
    pub alpha: Distribution,
    /// Stribeck speed, m/s.
    pub v_s: Distribution,
    /// Bristle stiffness, 1/m.
    pub sigma0: Distribution,
    /// Bristle damping, s/m.
    pub sigma1: Distribution,
    /// Viscous coefficient, s/m.
    pub sigma2: Distribution,
}

/// Printed values that a study is compared with.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Paper {
    /// Which publication.
    pub source: String,
    /// The mode it finds most robustly unstable, in its own numbering.
    pub mode: ModeLabel,
    /// Lowest and highest natural frequency of the oscillators, Hz.
    pub natural_frequencies_oscillators: [f64; 2],
    /// Lowest and highest natural frequency of the plate, Hz.
    pub natural_frequencies_plate: [f64; 2],
    /// Relative tolerance of the natural frequencies.
    pub frequency_tolerance: f64,
    /// Oscillators that dominate that mode, from 1.
    pub corners: Vec<usize>,
    /// Oscillators that dominate what is left with the second constraint set, from 1.
    pub after_corners_dominant: Vec<usize>,
    /// Median occurrence of that with every oscillator in contact.
    pub after_corners_occurrence: f64,
    /// Largest median occurrence with the third constraint set.
    pub after_six_occurrence: f64,
    /// The bound on it that the conclusions state.
    pub after_six_bound: f64,
    /// Arrangements with six in contact.
    pub arrangements_of_six: usize,
    /// CEAs per arrangement.
    pub analyses_per_arrangement: u64,
}

impl LatticeCase {
    /// What tells this study from others, whatever its seed and number of samples: its name and a hash of all that is
    /// computed from.
    pub fn identity(&self) -> String {
        let Self { laws, lattice, readings, panels, constraints, speeds, friction, .. } = self;
        let content = format!("{laws:?} {lattice:?} {readings:?} {panels:?} {constraints:?} {speeds:?} {friction:?}");
        format!("\"{}\" {}", self.name, &crate::fingerprint(&content)[..16])
    }

    /// The case under another reading.
    pub fn with(&self, alternative: &Alternative) -> Self {
        let mut case = self.clone();
        let readings = &mut case.readings;
        match *alternative {
            Alternative::OscillatorMass(mass) => case.lattice.oscillator_mass.fill(mass),
            Alternative::Lateral(lateral) => readings.lateral = lateral,
            Alternative::Draws(draws) => readings.draws = draws,
            Alternative::ModeNaming(labels) => readings.labels = labels,
            Alternative::Preload(preload) => readings.preload = preload,
            Alternative::BristleDamping(damping) => readings.bristle_damping = damping,
            Alternative::InPlaceOfLuGre(other) => {
                for law in case.laws.iter_mut().filter(|law| **law == Law::LuGre) {
                    *law = other;
                }
            }
        }
        case
    }
}
