//! Errors of sweeps, each one line for its user.

/// Error of a sweep over parameters.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An error of the study.
    #[error(transparent)]
    Study(#[from] study::Error),
    /// A spectrum contradicts the boundary of a stability map, however many lines it is looked for on.
    #[error(
        "at {at} a spectrum has {found} unstable modes, and the curves of the map leave {expected}: a curve is missing; allowed: ranges in \
         which the boundary is found, or a sweep over one parameter"
    )]
    MapContradicted {
        /// Values of the parameters, in words.
        at: String,
        /// Number of unstable modes by the spectrum.
        found: usize,
        /// Number of unstable modes by the curves.
        expected: usize,
    },
    /// An error at some values of the parameters.
    #[error("{study}: {at}: {}", without_file(source, study))]
    At {
        /// Path of the case file, or name of the study.
        study: String,
        /// Parameters with the values, or the range, at which the sweep failed.
        at: String,
        /// Cause.
        source: Box<Error>,
    },
    /// A capability that a sweep needs, and the type of the brake does not give.
    #[error("{needed_by} needs {capability} of the brake, which its type does not give")]
    NotGiven {
        /// The method of [`UncertainBrake`](study::UncertainBrake) that is `None`.
        capability: &'static str,
        /// Computation that needs the capability.
        needed_by: &'static str,
    },
    /// An argument that does not fit the brake.
    #[error("{argument} = {value}; allowed: {allowed}")]
    Argument {
        /// Name of the argument.
        argument: &'static str,
        /// Value given.
        value: String,
        /// Values allowed, in words.
        allowed: String,
    },
}

impl Error {
    /// True if this is the end of work that was [cancelled](montecarlo::Progress::is_cancelled), and no fault.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        matches!(self, Self::Study(error) if error.is_cancelled())
    }

    /// The error with the place in a sweep where it happened; the end of cancelled work as it is.
    pub(crate) fn in_sweep(self, plan: &study::Plan, at: impl FnOnce() -> String) -> Self {
        if self.is_cancelled() { self } else { Self::At { study: plan.source(), at: at(), source: Box::new(self) } }
    }
}

/// The words of an error without the file that it begins with, which is named before them already.
fn without_file(source: &Error, study: &str) -> String {
    let words = source.to_string();
    let rest = words.strip_prefix(study).and_then(|rest| rest.strip_prefix(": "));
    rest.map_or_else(|| words.clone(), str::to_owned)
}

study::from_errors!(
    Error:
    linsys::LinsysError,
    osc_model::OscModelError,
    cea::CeaError,
    tracking::TrackingError,
    montecarlo::MonteCarloError
);
