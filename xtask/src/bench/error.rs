//! What can stop the bench.

/// Errors of the bench.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// A problem that cannot be made or refined.
    #[error(transparent)]
    Accuracy(#[from] squeal::accuracy::AccuracyError),
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
    /// The bench itself, with other features or one thread of OpenBLAS.
    #[error("the bench cannot be started again: {0}")]
    Start(std::io::Error),
    /// The folder of the study's results.
    #[error("{}: cannot be removed: {source}", path.display())]
    Remove {
        /// The folder.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
}
