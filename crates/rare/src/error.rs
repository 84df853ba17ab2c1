//! Errors of this crate, each one line for its user.

use std::f64::consts::TAU;

/// Error of an estimate.
#[non_exhaustive]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// An option that is not allowed.
    #[error("{name} = {value}; allowed: {allowed}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Value given.
        value: String,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// A system that fails where all inputs have their medians.
    #[error(
        "a mode of {:.6} Hz is unstable with all inputs at their medians, with a growth of {growth:.4} 1/s: that is not rare; allowed: \
         medians at which nothing is unstable; plain samples say how often anything is",
        omega / TAU
    )]
    NotRare {
        /// Angular frequency of the mode, rad/s.
        omega: f64,
        /// Growth of the mode, 1/s.
        growth: f64,
    },
    /// A region of failure that the design points do not explain and that is found by looking elsewhere.
    #[error(
        "looking elsewhere found failure that no design point explains: {beta:.3} deviations from the medians, of probability {missed:.1e} to first \
         order, where the lines say {found:.1e} in all; allowed: more starting directions, so that it becomes a design point"
    )]
    Missed {
        /// Distance of the nearest point of the region that was found, in standard deviations.
        beta: f64,
        /// Point of the region, in standard deviations.
        point: Vec<f64>,
        /// Probability of the region to first order.
        missed: f64,
        /// Probability by line sampling.
        found: f64,
    },
    /// A margin that is no number.
    #[error("the margin of a mode of {:.6} Hz is no number; allowed: numbers, and infinities", omega / TAU)]
    NoMargin {
        /// Angular frequency of the mode, rad/s.
        omega: f64,
    },
    /// Failure so narrow that no line meets it.
    #[error(
        "none of {lines} lines meets the failure that was found {beta:.3} deviations from the medians: it is narrower than lines can tell; allowed: \
         failure that fills the space beyond its onset"
    )]
    NoLine {
        /// Number of lines.
        lines: usize,
        /// Distance of the nearest design point, in standard deviations.
        beta: f64,
    },
    /// Two estimates that disagree.
    #[error(
        "{hits} failures among points elsewhere say {elsewhere:.2e} +- {elsewhere_error:.1e} and the lines {lines:.2e} +- {lines_error:.1e}, \
         more than three standard errors apart; allowed: estimates that agree; more starting directions may find what is missing"
    )]
    Disagree {
        /// Number of points elsewhere that fail.
        hits: usize,
        /// Probability by points elsewhere.
        elsewhere: f64,
        /// Standard error of that.
        elsewhere_error: f64,
        /// Probability by lines.
        lines: f64,
        /// Standard error of that.
        lines_error: f64,
    },
}
