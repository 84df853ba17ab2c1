//! Errors of the tasks.

/// Errors of the tasks.
#[derive(Debug, thiserror::Error)]
pub enum TaskError {
    /// An error of a reference, an estimator or a problem.
    #[error(transparent)]
    Validation(#[from] validation::ValidationError),
    /// An error of the study.
    #[error(transparent)]
    Study(#[from] squeal::Error),
    /// An option, or standard output.
    #[error(transparent)]
    Program(#[from] squeal_cli::Error),
    /// An error of a case file or its brake.
    #[error(transparent)]
    Brake(#[from] brakes::Error),
    /// An error of a picture or a page.
    #[error(transparent)]
    Report(#[from] report::Error),
    /// An error of the paper's claims or figures.
    #[error(transparent)]
    Reproduction(#[from] reproduction::Error),
    /// A file that cannot be written.
    #[error(transparent)]
    Output(#[from] squeal::output::OutputError),
    /// An error of the samples of a study.
    #[error(transparent)]
    Samples(#[from] squeal::study::Error),
    /// An error of the Monte Carlo run.
    #[error(transparent)]
    MonteCarlo(#[from] squeal::montecarlo::MonteCarloError),
    /// An error of an eigenvalue analysis.
    #[error(transparent)]
    Cea(#[from] cea::CeaError),
    /// The Python process stopped answering.
    #[error("python3 stopped answering: {0}")]
    Python(std::io::Error),
    /// A process could not be started, or a file of the task not be read.
    #[error("a process or a file of the task: {0}")]
    Start(std::io::Error),
    /// Two commits that could not be compared.
    #[error("{0}")]
    Same(String),
    /// Faults of what goes out with a release.
    #[error("{0}")]
    Release(String),
    /// Two commits of which commands differ.
    #[error("{0} of the commands differ")]
    Differ(usize),
    /// The folder of the study's results could not be removed.
    #[error("{}: cannot be removed: {source}", path.display())]
    Remove {
        /// The folder.
        path: std::path::PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
}
