//! Errors of friction laws, and the ranges of their parameters.

use std::fmt;

/// The range that a parameter must lie in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Allowed {
    /// Finite and > 0.
    Positive,
    /// Finite and >= 0.
    NonNegative,
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Positive => "finite and > 0",
            Self::NonNegative => "finite and >= 0",
        })
    }
}

/// Errors of this crate.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrictionError {
    /// A parameter, or the sliding speed, is outside its range.
    #[error("{name} = {value}; allowed: {allowed}")]
    OutOfRange {
        /// The name of the parameter's field.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The allowed range.
        allowed: Allowed,
    },
    /// The static coefficient is below the kinetic one.
    #[error("mu_s = {mu_s}; allowed: >= mu_k = {mu_k}")]
    StaticBelowKinetic {
        /// The static coefficient given.
        mu_s: f64,
        /// The kinetic coefficient given.
        mu_k: f64,
    },
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), FrictionError> {
    in_range(name, value, value > 0.0, Allowed::Positive)
}

pub(crate) fn non_negative(name: &'static str, value: f64) -> Result<(), FrictionError> {
    in_range(name, value, value >= 0.0, Allowed::NonNegative)
}

pub(crate) fn static_not_below_kinetic(mu_s: f64, mu_k: f64) -> Result<(), FrictionError> {
    if mu_s < mu_k { Err(FrictionError::StaticBelowKinetic { mu_s, mu_k }) } else { Ok(()) }
}

fn in_range(name: &'static str, value: f64, inside: bool, allowed: Allowed) -> Result<(), FrictionError> {
    if inside && value.is_finite() { Ok(()) } else { Err(FrictionError::OutOfRange { name, value, allowed }) }
}
