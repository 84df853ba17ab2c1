//! Which modes of a brake will squeal, how sure are we, and what stops them.

pub mod case;
mod error;
pub mod figures;
pub mod output;
pub mod study;

pub use error::Error;
