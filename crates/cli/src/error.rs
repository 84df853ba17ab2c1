//! Errors of the program, each one line for its user.

use std::path::PathBuf;

/// Error between a command line and its results.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A study, or what is asked of it.
    #[error(transparent)]
    Study(squeal::Error),
    /// A study that would take more memory than there is.
    #[error("{0}: --memory where there is more")]
    TooLarge(squeal::study::Error),
    /// A case file, or the brake that it makes.
    #[error(transparent)]
    Brake(brakes::Error),
    /// Variants that cannot be compared with their case.
    #[error("{}: {source}", path.display())]
    Variants {
        /// The file with the variants.
        path: PathBuf,
        /// Cause.
        source: Box<squeal::questions::Error>,
    },
    /// An eigenvalue analysis.
    #[error(transparent)]
    Cea(#[from] cea::CeaError),
    /// A system or an operating point.
    #[error(transparent)]
    System(#[from] linsys::LinsysError),
    /// A model of sparse matrices.
    #[error(transparent)]
    Sparse(#[from] sparse::SparseError),
    /// The reduction of a large brake.
    #[error(transparent)]
    Reduction(#[from] reduction::ReductionError),
    /// The lattice.
    #[error(transparent)]
    Model(#[from] osc_model::OscModelError),
    /// Work in a mode.
    #[error(transparent)]
    Work(#[from] work::WorkError),
    /// A figure.
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
    /// A picture or a page.
    #[error(transparent)]
    Report(#[from] report::Error),
    /// A file that cannot be written.
    #[error(transparent)]
    Output(#[from] output::OutputError),
    /// An option of the command line that does not fit the case.
    #[error("{option} = {value}; allowed: {allowed}")]
    Option {
        /// The option.
        option: &'static str,
        /// Value that was given.
        value: String,
        /// Values that are allowed, in words.
        allowed: String,
    },
    /// Standard output that cannot be written.
    #[error("standard output: cannot be written: {0}")]
    StandardOutput(std::io::Error),
    /// More than half of the evaluations of a study failed.
    #[error(
        "{}: {failed} of {evaluations} evaluations failed, so that its results are of the others; allowed: at most half; \
         failures.csv says why, first: {first}",
        path.display()
    )]
    MostFailed {
        /// The folder with the results.
        path: PathBuf,
        /// Number of evaluations that failed.
        failed: u64,
        /// Number of evaluations in all.
        evaluations: u64,
        /// Message of the first evaluation that failed.
        first: String,
    },
    /// A reduced brake that is not the whole one.
    #[error(
        "{}: the reduced brake does not have the modes of the whole one, as is said first; allowed: none missing, none more, no other verdict",
        path.display()
    )]
    NotTheWholeBrake {
        /// The folder with the results, or the case.
        path: PathBuf,
    },
    /// A file that cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Reason why it cannot be read.
        source: std::io::Error,
    },
    /// A mode that does not fit the mesh.
    #[error("mode on the mesh: {0}")]
    OnMesh(#[from] formats::FormatsError),
    /// A file that does not hold a matrix.
    #[error("{}: {source}", path.display())]
    Matrix {
        /// The file.
        path: PathBuf,
        /// The line and what is wrong there.
        source: Box<formats::FormatsError>,
    },
    /// A matrix of more degrees of freedom than are allowed.
    #[error("{}: the {name} matrix is {rows} x {columns}; allowed: at most {most} degrees of freedom{beyond}", path.display())]
    MatrixTooLarge {
        /// The file.
        path: PathBuf,
        /// mass, damping or stiffness.
        name: &'static str,
        /// Number of its rows.
        rows: usize,
        /// Number of its columns.
        columns: usize,
        /// The most rows that are allowed.
        most: usize,
        /// Words to end the message with: what else is possible, beginning with a comma, or nothing.
        beyond: &'static str,
    },
    /// A matrix that does not fit the others.
    #[error("{}: the {name} matrix is {rows} x {columns}; allowed: {order} x {order}, {reason}", path.display())]
    MatrixShape {
        /// The file.
        path: PathBuf,
        /// mass, damping or stiffness.
        name: &'static str,
        /// Number of its rows.
        rows: usize,
        /// Number of its columns.
        columns: usize,
        /// Order, number of rows and of columns, that is expected.
        order: usize,
        /// Reason why that order is expected.
        reason: &'static str,
    },
}

impl From<squeal::Error> for Error {
    /// Arguments of the library are options here.
    fn from(error: squeal::Error) -> Self {
        match error {
            squeal::Error::Argument { argument: "over", value, allowed } => {
                Self::Option { option: "--over", value, allowed }
            }
            squeal::Error::Argument { argument: "shard", value, allowed } => {
                Self::Option { option: "--shard", value, allowed }
            }
            squeal::Error::Argument { argument: "total", value, allowed } => {
                Self::Option { option: "--total", value, allowed }
            }
            squeal::Error::Argument { argument: "stick", value, allowed } => {
                Self::Option { option: "--stick", value, allowed }
            }
            squeal::Error::Argument { argument: "from", value, allowed } => {
                Self::Option { option: "--from", value, allowed }
            }
            squeal::Error::Question(error) => (*error).into(),
            squeal::Error::Study(error) => error.into(),
            other => Self::Study(other),
        }
    }
}

impl From<squeal::questions::Error> for Error {
    fn from(error: squeal::questions::Error) -> Self {
        use squeal::cycle::Error::Setting;
        match error {
            squeal::questions::Error::Cycle(Setting { field: "harmonics", value, allowed }) => {
                Self::Option { option: "--harmonics", value: value.to_string(), allowed }
            }
            squeal::questions::Error::Cycle(Setting { field: "samples of a period", value, allowed }) => {
                Self::Option { option: "--time-samples", value: value.to_string(), allowed }
            }
            other => match squeal::Error::from(other) {
                question @ squeal::Error::Question(_) => Self::Study(question),
                other => other.into(),
            },
        }
    }
}

impl From<squeal::montecarlo::MonteCarloError> for Error {
    fn from(error: squeal::montecarlo::MonteCarloError) -> Self {
        squeal::Error::from(error).into()
    }
}

impl From<squeal::study::Error> for Error {
    fn from(error: squeal::study::Error) -> Self {
        match error {
            squeal::study::Error::TooLarge { .. } => Self::TooLarge(error),
            other => Self::Study(other.into()),
        }
    }
}

impl From<squeal::sweep::Error> for Error {
    fn from(error: squeal::sweep::Error) -> Self {
        squeal::Error::from(error).into()
    }
}

impl From<brakes::Error> for Error {
    fn from(error: brakes::Error) -> Self {
        match error {
            brakes::Error::Sweep(error) => error.into(),
            brakes::Error::Study(error) => error.into(),
            other => Self::Brake(other),
        }
    }
}

impl From<brakes::case::CaseError> for Error {
    fn from(error: brakes::case::CaseError) -> Self {
        Self::Brake(error.into())
    }
}
