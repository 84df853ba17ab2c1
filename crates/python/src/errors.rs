//! Exceptions: the one line of the program, and what it names as attributes.

use brakes::case::CaseError;
use cea::CeaError;
use cea::certified::CertifiedError;
use formats::FormatsError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use squeal::montecarlo::MonteCarloError;
use squeal::sweep;
use squeal_cli::Error;

/// Class of an exception in `squeal._errors`, and the attributes that it gets.
type Kind = (&'static str, Vec<(&'static str, String)>);

/// The exception for an argument with a value that is not allowed.
pub(crate) fn argument(py: Python<'_>, argument: &str, value: &str, allowed: &str) -> PyErr {
    let attributes = vec![("argument", argument.into()), ("value", value.into()), ("allowed", allowed.into())];
    exception(py, &format!("{argument} = {value}; allowed: {allowed}"), ("ArgumentError", attributes))
}

/// The exception for an array that is refused in one line, what is allowed at its end.
pub(crate) fn array(py: Python<'_>, argument: &str, line: &str) -> PyErr {
    let allowed = line.split_once("; allowed: ").map(|(_, allowed)| ("allowed", allowed.to_owned()));
    let attributes = [("argument", argument.to_owned())].into_iter().chain(allowed).collect();
    exception(py, line, ("ArgumentError", attributes))
}

/// The exception for an error of the library.
pub(crate) fn raised(py: Python<'_>, error: &Error) -> PyErr {
    match error {
        Error::Option { option, value, allowed } => {
            let name = option.trim_start_matches('-').replace('-', "_");
            // A word of the language is no name of an argument.
            argument(py, if name == "from" { "from_" } else { &name }, value, allowed)
        }
        Error::Study(squeal::Error::Argument { argument: name, value, allowed }) => argument(py, name, value, allowed),
        Error::Study(squeal::Error::Question(question)) => match &**question {
            squeal::questions::Error::Rare(rare::Error::Option { name, value, allowed }) => {
                argument(py, name, value, allowed)
            }
            _ => exception(py, &error.to_string(), kind(error)),
        },
        Error::TooLarge(source) => exception(py, &source.to_string(), ("TooLargeError", Vec::new())),
        other => exception(py, &other.to_string(), kind(other)),
    }
}

/// The exception for work that has panicked.
pub(crate) fn panicked(py: Python<'_>, fault: &str) -> PyErr {
    exception(py, &format!("a fault of squeal itself: {fault}"), ("SquealError", Vec::new()))
}

fn exception(py: Python<'_>, text: &str, (class, attributes): Kind) -> PyErr {
    let made = || {
        let fields = PyDict::new(py);
        for (name, value) in &attributes {
            fields.set_item(name, value)?;
        }
        py.import("squeal._errors")?.getattr(class)?.call((text,), Some(&fields))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

fn kind(error: &Error) -> Kind {
    let path = |path: &std::path::Path| vec![("path", path.display().to_string())];
    match error {
        Error::Study(error) => of_study(error),
        Error::Brake(error) => of_brake(error),
        Error::Cea(error) => of_cea(error),
        Error::System(_) | Error::Sparse(_) | Error::Reduction(_) => ("SolveError", Vec::new()),
        Error::Read { path: file, source } => (missing_or(source, "MissingFileError", "FileError"), path(file)),
        Error::Matrix { path: file, source } => match &**source {
            FormatsError::Open(source) => (missing_or(source, "MissingFileError", "FileError"), path(file)),
            _ => ("FileError", path(file)),
        },
        Error::Output(output::OutputError::Write { path: file, .. }) => ("FolderError", path(file)),
        _ => ("SquealError", Vec::new()),
    }
}

/// The class of a fault of reading: one of its own for what is not there.
fn missing_or(source: &std::io::Error, missing: &'static str, other: &'static str) -> &'static str {
    if source.kind() == std::io::ErrorKind::NotFound { missing } else { other }
}

fn of_brake(error: &brakes::Error) -> Kind {
    match error {
        brakes::Error::Case(error) => of_case(error),
        brakes::Error::Study(error) => of_inner(error),
        brakes::Error::Sweep(error) => of_sweep(error),
        brakes::Error::Sparse(_) | brakes::Error::Reduction(_) => ("SolveError", Vec::new()),
        _ => ("SquealError", Vec::new()),
    }
}

fn of_study(error: &squeal::Error) -> Kind {
    use squeal::Error as Of;
    match error {
        Of::Study(error) => of_inner(error),
        Of::Question(error) => match &**error {
            squeal::questions::Error::Sweep(error) => of_sweep(error),
            _ => ("SquealError", Vec::new()),
        },
        Of::PartsMissing { .. } => ("FolderError", Vec::new()),
        Of::OtherStudy { path, .. }
        | Of::PartIncomplete { path, .. }
        | Of::PartDiffers { path, .. }
        | Of::InUse { path, .. }
        | Of::FolderLost { path }
        | Of::EstimatesDamaged { path, .. }
        | Of::Output(output::OutputError::Write { path, .. })
        | Of::Read { path, .. } => ("FolderError", vec![("path", path.display().to_string())]),
        _ => ("SquealError", Vec::new()),
    }
}

fn of_sweep(error: &sweep::Error) -> Kind {
    match error {
        sweep::Error::Study(error) => of_inner(error),
        sweep::Error::At { source, .. } => of_sweep(source),
        _ => ("SquealError", Vec::new()),
    }
}

fn of_inner(error: &squeal::study::Error) -> Kind {
    use squeal::study::Error as Of;
    match error {
        Of::Cea(error) => of_cea(error),
        Of::Brake(error) => match (error.downcast_ref(), error.downcast_ref()) {
            (Some(error), _) => of_brake(error),
            (None, Some(error)) => of_case(error),
            (None, None) => ("SquealError", Vec::new()),
        },
        Of::Median { source, .. } | Of::Scene { source, .. } => of_inner(source),
        Of::TooLarge { .. } => ("TooLargeError", Vec::new()),
        Of::MonteCarlo(error) => of_run(error),
        Of::System(_) | Of::Tracking(_) | Of::WholeEigenvalue(_) => ("SolveError", Vec::new()),
        _ => ("SquealError", Vec::new()),
    }
}

fn of_run(error: &MonteCarloError) -> Kind {
    use MonteCarloError as Of;
    match error {
        Of::CheckpointIo { path, .. }
        | Of::CheckpointDamaged { path, .. }
        | Of::CheckpointMismatch { path, .. }
        | Of::CheckpointLonger { path, .. } => ("FolderError", vec![("path", path.display().to_string())]),
        Of::PartsMissing { .. } | Of::PartsOverlap { .. } => ("FolderError", Vec::new()),
        _ => ("SquealError", Vec::new()),
    }
}

fn of_cea(error: &CeaError) -> Kind {
    match error {
        CeaError::Certified(CertifiedError::SingularPencil { .. }) => ("SingularPencilError", Vec::new()),
        _ => ("SolveError", Vec::new()),
    }
}

fn of_case(error: &CaseError) -> Kind {
    let mut attributes = Vec::new();
    match error {
        CaseError::Choice { what, value, allowed } => {
            return (
                "ArgumentError",
                vec![("argument", (*what).into()), ("value", value.clone()), ("allowed", allowed.clone())],
            );
        }
        CaseError::Value { path, field, value, allowed } => {
            attributes.extend([("path", path.display().to_string()), ("field", field.clone())]);
            attributes.extend([("value", value.clone()), ("allowed", allowed.clone())]);
        }
        CaseError::Read { path, source } => {
            let path = vec![("path", path.display().to_string())];
            return (missing_or(source, "MissingCaseError", "CaseError"), path);
        }
        CaseError::Syntax { path, .. } | CaseError::Lattice { path, .. } => {
            attributes.push(("path", path.display().to_string()));
        }
        CaseError::Contact { path, field, .. }
        | CaseError::Expression { path, field, .. }
        | CaseError::MatrixRead { path, field, .. }
        | CaseError::Matrix { path, field, .. }
        | CaseError::System { path, field, .. }
        | CaseError::Sparse { path, field, .. } => {
            attributes.extend([("path", path.display().to_string()), ("field", field.clone())]);
        }
        _ => {}
    }
    ("CaseError", attributes)
}
