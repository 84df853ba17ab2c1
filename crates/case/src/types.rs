//! A checked case, in the types of the model.

use friction::BristleDamping;
use montecarlo::Distribution;
use osc_model::{ContactArrangement, Dof, Lateral, LatticeParameters, Preload};
use serde::Deserialize;
use study::{ModeIdentity, ModeLabel, ModeNaming};

use super::{Alternative, CaseHeader, Correlation, Draws, Law};

/// A checked study of a lattice.
#[derive(Debug, Clone)]
pub struct LatticeCase {
    /// Header of the case: its file, and what it says of its study.
    pub header: CaseHeader,
    /// Friction laws, in the order of the file.
    pub laws: Vec<Law>,
    /// The lattice.
    pub lattice: LatticeParameters,
    /// The readings: choices where the published description leaves the model open.
    pub readings: LatticeReadings,
    /// Arrangements by number in contact, in the order of the file.
    pub panels: Vec<(usize, Vec<ContactArrangement>)>,
    /// Sets of constraints, in the order of the file; at least one.
    pub constraints: Vec<ConstraintSet>,
    /// Ranges of sliding speed; at least one.
    pub speeds: Vec<SpeedRange>,
    /// Distributions of the friction parameters.
    pub friction: FrictionDistributions,
    /// Correlation of the friction parameters; `None` where they are independent.
    pub correlation: Option<Correlation>,
    /// Other readings for comparison.
    pub alternatives: Vec<Alternative>,
    /// Printed values of a publication, for comparison.
    pub paper: Option<Paper>,
}

/// The readings of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticeReadings {
    /// Friction in y.
    pub lateral: Lateral,
    /// Draws of the friction parameters: one for all contacts or one for each.
    pub draws: Draws,
    /// Naming of the modes.
    pub labels: ModeNaming,
    /// Identity by which a tracked mode is known again.
    pub identity: ModeIdentity,
    /// The force that presses the oscillators on the plate.
    pub preload: Preload,
    /// LuGre's sigma1 as a function of speed; `None` sets sigma1 to 0.
    pub bristle_damping: Option<BristleDamping>,
}

/// A set of constraints.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstraintSet {
    /// Name of the set.
    pub name: String,
    /// The constrained degrees of freedom.
    pub fixed: Vec<Dof>,
}

/// A range of sliding speeds, from which speeds are drawn log-uniformly.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedRange {
    /// Name of the range.
    pub name: String,
    /// Lowest speed, m/s, > 0.
    pub from: f64,
    /// Highest speed, m/s.
    pub to: f64,
}

impl SpeedRange {
    /// The quantile at probability `u` of the log-uniform distribution, m/s.
    pub fn quantile(&self, u: f64) -> f64 {
        self.from * (self.to / self.from).powf(u)
    }
}

/// Distributions of the friction parameters of all laws.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionDistributions {
    /// Coefficient of Amontons-Coulomb, and of every law across the sliding direction.
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

impl FrictionDistributions {
    /// Names of the parameters that are drawn for a contact, in this order: the parameters of all laws, with the coefficient across the sliding, which the
    /// laws other than Amontons-Coulomb draw from the distribution of mu.
    pub const DRAWN: [&str; 9] = ["mu", "lateral_mu", "mu_s", "mu_k", "alpha", "v_s", "sigma0", "sigma1", "sigma2"];
    /// Units of [`Self::DRAWN`].
    pub const UNITS: [&str; 9] = ["1", "1", "1", "1", "s/m", "m/s", "1/m", "s/m", "s/m"];

    /// The distributions of [`Self::DRAWN`].
    pub fn of_draw(&self) -> [&Distribution; Self::DRAWN.len()] {
        let Self { mu, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2 } = self;
        [mu, mu, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2]
    }
}

/// Printed values that a study is compared with.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Paper {
    /// The publication.
    pub source: String,
    /// The mode that the publication finds most robustly unstable, in its numbering.
    pub mode: ModeLabel,
    /// Lowest and highest natural frequency of the oscillators, Hz.
    pub natural_frequencies_oscillators: [f64; 2],
    /// Lowest and highest natural frequency of the plate, Hz.
    pub natural_frequencies_plate: [f64; 2],
    /// Relative tolerance of the natural frequencies.
    pub frequency_tolerance: f64,
    /// Oscillators that dominate that mode, from 1.
    pub corners: Vec<usize>,
    /// Oscillators that dominate the unstable mode with the second constraint set, from 1.
    pub after_corners_dominant: Vec<usize>,
    /// The mode that is left with the second constraint set, in its own numbering.
    pub after_corners_mode: ModeLabel,
    /// Median occurrence of this mode with every oscillator in contact.
    pub after_corners_occurrence: f64,
    /// The mode that is left with the third constraint set, in its own numbering.
    pub after_six_mode: ModeLabel,
    /// Largest median occurrence with the third constraint set.
    pub after_six_occurrence: f64,
    /// The bound of that occurrence in the conclusions.
    pub after_six_bound: f64,
    /// Number of arrangements with six oscillators in contact.
    pub arrangements_of_six: usize,
    /// Number of complex eigenvalue analyses per arrangement.
    pub analyses_per_arrangement: u64,
}

impl LatticeCase {
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
