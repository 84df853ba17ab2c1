//! The motion after the onset of squeal: contacts that open, slide and stick, and the limit cycles that they make.
//!
//! ```text
//! M u'' + C u' + K u + sum_i [ c_i (N_i - N0_i - k_i c_i^T u) - b_i (mu_i N_i - mu0_i N0_i) ] = 0
//! N_i = max(0, N0_i + k_i c_i^T u),   w_i = v_i - b_i^T u',   mu_i = mu(w_i, z_i),   z_i' = f(w_i, z_i)
//! ```
//!
//! with
//!
//! - u, the displacement from steady sliding, m: u = 0 is steady sliding;
//! - K, the stiffness with the springs of the contacts that are closed in steady sliding, and without friction; so `k_i c_i^T u` is taken off in the bracket;
//! - c_i, the approach of contact i (`c_i^T u > 0` presses it), k_i its spring, N/m, N_i its normal force, N, and N0_i that in steady sliding;
//! - b_i, the direction in which friction drags the structure, v_i the speed of steady sliding and w_i the sliding velocity, m/s;
//! - mu_i, the coefficient of friction, mu0_i that in steady sliding, and z_i the bristle of a law that has one (LuGre).
//!
//! Of a contact that is open in steady sliding N0_i is `-k_i` times its gap, K has no spring of it, and the bracket is `c_i N_i - b_i mu_i N_i`.
//!
//! | to | see | in |
//! | --- | --- | --- |
//! | write the equations | [`ContactSystem`] of [`Part`]s; [`SlidingContact`], with its [`ContactFriction`]: [`Smoothed`] laws of the speed alone, [`Bristled`] ones | `system`; `contact`, `friction` |
//! | be sure of them | [`ContactSystem::check_tangent`] refuses a system whose linearisation is not that of the complex eigenvalue analysis | `tangent` |
//! | know what a motion becomes, a [`Motion`] | [`follow`] integrates by Taylor series, restarted at each kink (a contact opens, sticks, turns), without smoothing; [`follow_telling`] also reports each period, [`state_after`] gives the state at a time. Of a motion that does not repeat itself [`follow`] returns measures of stretches ([`Motion::NotPeriodic`]) | `motion` |
//! | make a motion that repeats itself exact | [`shoot`] gives the [`Cycle`] and its Floquet multipliers | `shooting`; small deviations from a motion `variation` |
//! | measure a cycle | [`measure`]: rms velocity and peak of each degree of freedom, share of the period in which each contact is open or stuck, mean power of each family of forces | `measure`, powers of a moment `powers` |
//! | see it in time | [`states`] over the period, and of such states [`history`]: a [`ContactMoment`] of each contact, with its normal force and sliding velocity | `measure` |
//! | hear it | [`harmonics`]: its Fourier series, [`Harmonics`] | `harmonics` |
//! | follow cycles over a parameter | [`Balance`]: harmonic balance on the contacts, its friction smoothed, a cycle as a [`BalancedCycle`]; [`Balance::branch_from_onset`] within a [`Reach`] | `harmonic_balance`; `continuation` |
//!
//! Motion in time is in pieces: `path` makes one as a power series, whose terms and zeros are in `series`; `terms` are those of friction; `kinks` finds where it ends; `sides` says on which side of
//! each kink it is and what changes beyond; `stick` has the friction of contacts that stick; `moments` are the instants of a piece at which forces are looked at, and
//! integrals made. `size` compares states, `factor` solves large linear systems.

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
mod terms;
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
