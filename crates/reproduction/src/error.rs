//! Errors of a reproduction, each one line for its user.

/// Errors between the study of a paper and its claims.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An error of the study.
    #[error(transparent)]
    Study(#[from] squeal::Error),
    /// An error of the samples of a study.
    #[error(transparent)]
    Samples(#[from] squeal::study::Error),
    /// An error of a quantile.
    #[error(transparent)]
    MonteCarlo(#[from] montecarlo::MonteCarloError),
    /// An error of a system.
    #[error(transparent)]
    System(#[from] linsys::LinsysError),
    /// An error of the lattice.
    #[error(transparent)]
    Model(#[from] osc_model::OscModelError),
    /// An error of the case.
    #[error(transparent)]
    Case(#[from] brakes::case::CaseError),
    /// An error of the brake of a case.
    #[error(transparent)]
    Brake(#[from] brakes::Error),
    /// A fault of the paper's case as tables.
    #[error("cases/paper.toml: {0}")]
    Toml(String),
    /// A file that cannot be written.
    #[error(transparent)]
    Output(#[from] output::OutputError),
    /// An error of writing to standard output.
    #[error(transparent)]
    Program(Box<squeal_cli::Error>),
    /// An error of a picture or a page.
    #[error(transparent)]
    Report(#[from] report::Error),
    /// An error of a figure.
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
}

impl From<squeal_cli::Error> for Error {
    fn from(error: squeal_cli::Error) -> Self {
        Self::Program(Box::new(error))
    }
}
