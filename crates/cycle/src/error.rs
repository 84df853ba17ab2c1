//! Errors of the motion after the onset, each one line for its user.

/// Error of this crate.
#[non_exhaustive]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number of a contact that is not allowed.
    #[error("contact {contact:?}: {field} = {value}; allowed: {allowed}")]
    Contact {
        /// Name of the contact.
        contact: String,
        /// Name of the number.
        field: &'static str,
        /// The value given.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// A structure that cannot move in time, or not in these harmonics: no contact, a mass matrix that is not symmetric and positive definite, internal states of its own, a resonance without
    /// damping.
    #[error("{0}")]
    Structure(&'static str),
    /// A number of an analysis that is not allowed.
    #[error("{field} = {value}; allowed: {allowed}")]
    Setting {
        /// Name of the number.
        field: &'static str,
        /// The value given.
        value: f64,
        /// Allowed values, in words.
        allowed: String,
    },
    /// Equations of motion whose tangent in steady sliding is not the system of the complex eigenvalue analysis.
    #[error(
        "the motion's tangent in steady sliding deviates from the complex eigenvalue analysis by {deviation:.1e} of its norm; allowed: {allowed:.0e}"
    )]
    Tangent {
        /// Largest deviation of `Q(i w)` at half, once and twice the frequency w that was given, relative to `|M| w^2 + |C| w + |K|`.
        deviation: f64,
        /// Largest deviation that is allowed.
        allowed: f64,
    },
    /// A motion with numbers that are not finite, or so fast that the steps of time vanish.
    #[error("the motion cannot be followed beyond {time} s: {reason}")]
    Motion {
        /// Time since the start, s.
        time: f64,
        /// Reason, in words.
        reason: &'static str,
    },
    /// An equation of a periodic motion that has no solution near its guess.
    #[error("{method} does not converge{}", left(*residual))]
    NoConvergence {
        /// Name of the method.
        method: &'static str,
        /// Relative residual at its end, or its relative distance from the guess; no number where nothing is measured.
        residual: f64,
    },
    /// Work that was stopped by [`ContactSystem::until`](crate::ContactSystem::until).
    #[error("stopped")]
    Stopped,
    /// A system of `linsys`.
    #[error(transparent)]
    System(#[from] linsys::LinsysError),
}

/// Words on a residual that is left, after the name of a method.
fn left(residual: f64) -> String {
    if residual.is_nan() { String::new() } else { format!("; {residual:.1e} is left") }
}
