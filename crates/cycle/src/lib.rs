//! The motion after the onset of squeal: contacts that open, slide and stick, and the limit cycles that they make.
//!
//! ```text
//! M u'' + C u' + K u + sum_i [ c_i (N_i - N0_i - k_i c_i^T u) - b_i (mu_i N_i - mu0_i N0_i) ] = 0
//! N_i = max(0, N0_i + k_i c_i^T u),   w_i = v_i - b_i^T u',   mu_i = mu(w_i, z_i)
//! ```
//!
//! | to | see |
//! | --- | --- |
//! | write the equations | [`ContactSystem`], [`SlidingContact`], [`ContactFriction`]; [`ContactSystem::check_tangent`] holds them against the linear analysis |
//! | know what a motion becomes | [`follow`]: power series of time from kink to kink, then [`shoot`] to a [`Cycle`] with its Floquet multipliers, or measures of what does not repeat itself |
//! | measure a cycle | [`measure`]: amplitudes, shares open and stuck, power by family; [`history`]: N(t) and slip; [`harmonics`]: its Fourier series |
//! | follow cycles over a parameter | [`Balance`]: harmonic balance on the contacts, [`Balance::branch_from_onset`] |

mod contact;
mod continuation;
mod error;
mod factor;
mod friction;
mod harmonic_balance;
mod harmonics;
mod kinks;
mod measure;
mod moments;
mod motion;
mod path;
mod powers;
mod series;
mod shooting;
mod sides;
mod size;
mod stick;
mod system;
mod tangent;
mod variation;

pub use contact::SlidingContact;
pub use continuation::{BranchEnd, BranchPoint, NearMode, Reach, SystemAt};
pub use error::Error;
pub use friction::{Bristled, ContactFriction, Smoothed};
pub use harmonic_balance::{Balance, BalancedCycle};
pub use harmonics::{Harmonics, harmonics};
pub use measure::{ContactMoment, ContactState, Measures, Shares, history, measure, states};
pub use motion::{Motion, Settings, follow, follow_telling, state_after};
pub use shooting::{Cycle, shoot};
pub use system::{ContactSystem, Part};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
