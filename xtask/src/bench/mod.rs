//! `cargo xtask bench`: the time of every route to eigenvalues, and of the study by stages and as a whole.

mod ablation;
mod machine;
mod problems;
mod python;
mod rounds;
mod routes;
mod secular;
mod stages;
mod study;
mod table;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use brakes::LatticeBrake;
use brakes::case::LatticeCase;
use serde::Serialize;
use squeal::output::{make_folder, write};
use squeal_cli::override_run;
use squeal_cli::terminal::{note, say};

use crate::again::run_again;
use crate::error::TaskError;
use machine::Machine;
use problems::{Problem, SIZES};
use python::Python;
use rounds::{RouteTime, measure};
use study::StudyTimes;

/// Time: eigenvalue routes against library baselines, the stages of the study, the whole of it
///
/// numpy and scipy take part where python3 has them, faer and LAPACK's dgeev with --features lapack,faer. dgeev is the
/// system's OpenBLAS (libopenblas-dev).
#[derive(Debug, clap::Args)]
pub struct BenchArgs {
    /// Build with these features first: lapack, faer or both, with a comma between them
    #[arg(long, value_name = "LIST")]
    features: Option<String>,
    /// Write everything to FILE, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Samples per arrangement, law and speed range of the study [default: the case's, 1000]
    #[arg(long, value_name = "N")]
    samples: Option<u64>,
    /// A single round, and the study of cases/two-by-two.toml, to check that everything works
    #[arg(long)]
    quick: bool,
    /// What each accelerator gains instead: the studies of shipped cases, or of some, with it and without
    #[arg(long, value_name = "CASE,...", num_args = 0.., value_delimiter = ',', conflicts_with_all = ["features", "json", "samples", "quick"])]
    ablation: Option<Vec<String>>,
}

impl BenchArgs {
    /// The task and its options, without `--features`.
    fn words(&self) -> Vec<OsString> {
        let mut words = vec!["bench".into()];
        words.extend(self.quick.then(|| "--quick".into()));
        words.extend(self.samples.map(|samples| format!("--samples={samples}").into()));
        words.extend(self.json.iter().flat_map(|path| ["--json".into(), path.into()]));
        words
    }
}

/// The results of all measurements.
#[derive(Debug, Serialize)]
struct BenchReport {
    machine: Machine,
    routes: Vec<RouteTime>,
    study: StudyTimes,
}

/// Runs the task.
pub fn run(args: &BenchArgs) -> Result<(), TaskError> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    if let Some(cases) = &args.ablation {
        return ablation::run(&root, cases);
    }
    run_again(args.features.as_deref(), &args.words())?;
    let read = |name: &str| LatticeCase::read(&root.join("cases").join(name)).map_err(brakes::Error::from);
    let case = read("paper.toml")?;
    let mut studied = if args.quick { read("two-by-two.toml")? } else { case.clone() };
    override_run(&mut studied.header, args.samples, None, None)?;
    let rounds = if args.quick { 1 } else { 25 };
    // A folder that cannot be made is an error before the measurements of several minutes.
    if let Some(folder) = args.json.as_deref().and_then(Path::parent) {
        make_folder(folder)?;
    }

    let machine = Machine::this();
    let problems = SIZES.iter().map(|size| Problem::new(&case, size, args.quick)).collect::<Result<Vec<_>, _>>()?;
    say(&(table::heading(&machine, &problems, rounds) + "\n"))?;
    let mut rows = Vec::new();
    let mut has_python = true;
    for problem in &problems {
        note(&format!("n = {}, {} internal states", problem.n, problem.states));
        let mut python = if has_python { start_python(problem) } else { None };
        has_python = python.is_some();
        rows.extend(measure(problem, python.as_mut(), rounds)?);
    }
    say(&(table::routes(&rows) + "\n"))?;

    let brake = LatticeBrake::new(studied)?;
    let study = StudyTimes::measure(&brake, &root.join("target/bench"))?;
    say(&table::study(&study))?;
    if let Some(path) = &args.json {
        let report = BenchReport { machine, routes: rows, study };
        write(path, report.json().as_bytes())?;
    }
    Ok(())
}

impl BenchReport {
    fn json(&self) -> String {
        // The report has numbers and strings only, whose serialisation cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

/// Python with the matrices of a problem; where it cannot be started, prints the reason in one line.
fn start_python(problem: &Problem) -> Option<Python> {
    match Python::start(problem) {
        Ok(python) => Some(python),
        Err(error) => {
            note(&format!("Without numpy and scipy: {error}"));
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn the_options_but_features_are_told_again() {
        let args = BenchArgs {
            features: Some("faer".into()),
            json: Some("a b.json".into()),
            samples: Some(5),
            quick: true,
            ablation: None,
        };
        assert_eq!(args.words(), ["bench", "--quick", "--samples=5", "--json", "a b.json"]);
    }

    #[test]
    fn the_json_has_the_promised_fields_and_the_table_every_route() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let case = LatticeCase::read(&root.join("cases/paper.toml")).unwrap();
        let problem = Problem::new(&case, &SIZES[0], true).unwrap();
        let routes = measure(&problem, None, 1).unwrap();
        let mut small = LatticeCase::read(&root.join("cases/two-by-two.toml")).unwrap();
        small.header.samples = 8;
        let folder = tempfile::tempdir().unwrap();
        let study = StudyTimes::measure(&LatticeBrake::new(small).unwrap(), &folder.path().join("study")).unwrap();
        let table = table::routes(&routes);
        let report = BenchReport { machine: Machine::this(), routes, study };

        let json: Value = serde_json::from_str(&report.json()).unwrap();
        let rows = json["routes"].as_array().unwrap();
        assert!(rows.len() >= 5);
        for (row, line) in rows.iter().zip(table.lines().skip(2)) {
            assert!(line.contains(row["route"].as_str().unwrap()), "{line}");
            assert!(row["n"] == 10 && row["states"] == 0 && row["us"].as_f64().unwrap() > 0.0, "{row}");
            let limit = if row["route"].as_str().unwrap().contains("raw") { 1e-6 } else { 1e-12 };
            // Where no mode of the draws with known eigenvalues grows, the route of growing modes has no error.
            let is_growing = row["route"] == secular::SECULAR_ROUTE_NAME;
            assert!(row["max_error"].as_f64().map_or(is_growing, |error| error < limit), "{row}");
            assert_eq!(row["ratio_to_dgeev"].is_null(), !cfg!(feature = "lapack"), "{row}");
        }
        let study = &json["study"];
        assert_eq!(study["ceas"], 160);
        assert!(study["seconds"].as_f64().unwrap() > 0.0 && study["threads"].as_u64().unwrap() >= 1);
        assert_eq!(study["peak_mb"].is_null(), !cfg!(target_os = "linux"));
        let shares: f64 = study["stages"].as_array().unwrap().iter().map(|s| s["share"].as_f64().unwrap()).sum();
        assert!((shares - 1.0).abs() < 1e-12, "{shares}");
    }

    #[test]
    fn python_agrees_where_it_is_there() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let case = LatticeCase::read(&root.join("cases/paper.toml")).unwrap();
        let problem = Problem::new(&case, &SIZES[0], true).unwrap();
        let Some(mut python) = start_python(&problem) else { return };
        let routes = python.routes.clone();
        let rows = measure(&problem, Some(&mut python), 1).unwrap();
        for route in &routes {
            let row = rows.iter().find(|row| row.route == *route).unwrap();
            assert!(row.max_error.unwrap() < 1e-12 && row.us > 0.0, "{row:?}");
        }
    }
}
