//! Errors of a reproduction, each one line for its user.

/// Errors between the study of a paper and its claims.
#[non_exhaustive]
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The study.
    #[error(transparent)]
    Study(#[from] squeal::Error),
    /// The samples of a study.
    #[error(transparent)]
    Samples(#[from] squeal::study::Error),
    /// A quantile.
    #[error(transparent)]
    MonteCarlo(#[from] montecarlo::MonteCarloError),
    /// A system.
    #[error(transparent)]
    System(#[from] linsys::LinsysError),
    /// The lattice.
    #[error(transparent)]
    Model(#[from] osc_model::OscModelError),
    /// The case.
    #[error(transparent)]
    Case(#[from] brakes::case::CaseError),
    /// The brake of a case.
    #[error(transparent)]
    Brake(#[from] brakes::Error),
    /// The paper's case as tables.
    #[error("cases/paper.toml: {0}")]
    Toml(String),
    /// A file that cannot be written.
    #[error(transparent)]
    Output(#[from] output::OutputError),
    /// Standard output.
    #[error(transparent)]
    Program(Box<squeal_cli::Error>),
    /// A picture or a page.
    #[error(transparent)]
    Report(#[from] report::Error),
    /// A figure.
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
}

impl From<squeal_cli::Error> for Error {
    fn from(error: squeal_cli::Error) -> Self {
        Self::Program(Box::new(error))
    }
}
