//! The motion after the onset of squeal: contacts that open, slide and stick, and the limit cycles that they make.
mod contact;
mod continuation;
mod dopri;
mod error;
mod friction;
mod harmonic_balance;
mod measure;
mod motion;
mod shooting;
mod system;

pub use contact::SlidingContact;
pub use continuation::{BranchPoint, NearMode, Reach, SystemAt};
pub use error::Error;
pub use friction::{Bristled, ContactFriction, Smoothed};
pub use harmonic_balance::{Balance, BalancedCycle};
pub use measure::{Measures, Shares, history, measure};
pub use motion::{Motion, Settings, follow, state_after};
pub use shooting::{Cycle, shoot};
pub use system::{ContactSystem, Part};
