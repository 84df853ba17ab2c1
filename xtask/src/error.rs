//! What can stop a task.

/// Errors of the tasks.
#[derive(Debug, thiserror::Error)]
pub enum TaskError {
    /// A reference or an estimator, or a problem that cannot be made.
    #[error(transparent)]
    Validation(#[from] validation::ValidationError),
    /// The study, or a file that cannot be written.
    #[error(transparent)]
    Study(#[from] squeal::Error),
    /// The Monte Carlo run of the study.
    #[error(transparent)]
    MonteCarlo(#[from] squeal::montecarlo::MonteCarloError),
    /// An eigenvalue analysis.
    #[error(transparent)]
    Cea(#[from] cea::CeaError),
    /// A Python process that stopped answering.
    #[error("python3 stopped answering: {0}")]
    Python(std::io::Error),
    /// This program, with other features or one thread of OpenBLAS.
    #[error("the task cannot be started again: {0}")]
    Start(std::io::Error),
    /// The paper's case as tables.
    #[error("cases/paper.toml: {0}")]
    Toml(String),
    /// The folder of the study's results.
    #[error("{}: cannot be removed: {source}", path.display())]
    Remove {
        /// The folder.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
}
