//! What is asked of a brake: a study in a folder, whole or in parts; one analysis, sweeps, influence, screens, the plain function.

use std::path::PathBuf;
use std::sync::Arc;

use ::cea::{self as analysis, BatchSolver, CeaError, CountedSpectrum, EigenSolver, QrSolver, Workspace};
use brakes::case::parameter_of;
use brakes::{AnyBrake, CaseBrake, Purpose};
use linsys::SecondOrder;
use montecarlo::MonteCarloError;
use num_complex::Complex;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use output::Table;
use pyo3::prelude::*;
use rayon::prelude::*;
use serde_json::json;
use squeal::cycles::{CycleOptions, Start, branches, cycles};
use squeal::influence::{influence as of_inputs, influence_table};
use squeal::parts::{Shard, completed, consistent, run_part};
use squeal::rare::{Options, design_points_table, rare as rare_squeal, rare_table};
use squeal::screen::{ChangeKind, Confirmation, Criterion, Joined, ScreenOptions, Sizes, confirm, rank};
use squeal::study::{Cost, Study, UncertainBrake};
use squeal::sweep::{Found, Over, stability_map, sweep as over_one};
use squeal::{RunOptions, RunProgress, workers};
use squeal_cli::bar::Stages;
use squeal_cli::{CaseArgs, CeaArgs, Error, MachineArgs, MemoryArgs, RunArgs, SceneArgs};

use crate::away::{Ends, Watch, away};
use crate::brake::{Brake, Source};
use crate::errors::argument;

/// Number of samples that a thread evaluates together; chosen.
const TOGETHER: usize = 64;
/// Name in the progress of a step while a brake is prepared.
const PREPARED: &str = "steps of preparation";
/// Name in the progress of a step while samples are evaluated.
const EVALUATED: &str = "evaluations";

/// Name, columns, rows.
type AsTable = (String, Vec<String>, Vec<Vec<String>>);

fn tables(of: Vec<Table>) -> Vec<AsTable> {
    of.into_iter().map(|Table { name, columns, rows }| (name, columns, rows)).collect()
}

/// A text of a study, and the complaint about results that are written and may be wrong.
type Ran = (String, Option<String>);

fn ran(done: Result<(), Error>, out: Vec<u8>) -> Result<Ran, Error> {
    let text = String::from_utf8_lossy(&out).into_owned();
    match done {
        Ok(()) => Ok((text, None)),
        Err(error @ (Error::MostFailed { .. } | Error::NotTheWholeBrake { .. })) => Ok((text, Some(error.to_string()))),
        Err(error) => Err(error),
    }
}

/// `kept`: whether what was drawn, and whether every mode, stays in tables.
fn run_args(out: PathBuf, kept: [bool; 2], threads: Option<usize>, until_half_width: Option<f64>) -> RunArgs {
    let [keep_samples, every_mode] = kept;
    RunArgs {
        case: CaseArgs::default(),
        out,
        samples: None,
        seed: None,
        half_width: None,
        until_half_width,
        keep_samples,
        cycles: None,
        every_mode,
        parquet: false,
        shard: None,
        from: 0,
        json: false,
        machine: MachineArgs { threads, ..MachineArgs::default() },
    }
}

/// Runs the study of a brake in a folder; the half widths are that of the estimates, and that to which it is sampled, `kept` is as in [`run_args`] with
/// the number of unstable draws of each scene that are followed into their motion.
#[pyfunction]
pub(crate) fn run(
    py: Python<'_>,
    brake: &Brake,
    out: PathBuf,
    half_widths: [Option<f64>; 2],
    kept: (bool, bool, Option<u64>),
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Ran> {
    let ([half_width, until_half_width], (keep_samples, every_mode, cycles)) = (half_widths, kept);
    let source = brake.source.clone();
    away(py, Ends::Itself, progress.as_ref(), move |watch| {
        let half_width = half_width.or(source.half_width());
        if cycles.is_some() {
            source.has_motion()?;
        }
        let brake = source.brake(Purpose::Study, threads, watch)?;
        let (args, mut text) =
            (RunArgs { cycles, ..run_args(out, [keep_samples, every_mode], threads, until_half_width) }, Vec::new());
        ran(args.study(&brake, half_width, None, &**watch, &mut text), text)
    })
}

/// Samples one part of the study of a brake: number, of how many, first sample. The range of samples and what was evaluated.
#[pyfunction]
pub(crate) fn shard(
    py: Python<'_>,
    brake: &Brake,
    part: (u64, u64, u64),
    out: PathBuf,
    keep_samples: bool,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(u64, u64, u64, u64)> {
    let source = brake.source.clone();
    away(py, Ends::Itself, progress.as_ref(), move |watch| {
        let brake = source.brake(Purpose::Study, threads, watch)?;
        let (preparation, evaluation) = (watch.stage(PREPARED), watch.stage(EVALUATED));
        let told = RunProgress { preparation: &*preparation, evaluation: &*evaluation, reasons: &() };
        let options = RunOptions::default().with_threads(threads).with_progress(told).keeping_samples(keep_samples);
        let (number, of, from) = part;
        let done = run_part(&brake, Shard { number, of, from }, &out, options)?;
        Ok((done.from, done.to, done.evaluations, done.failures))
    })
}

/// Puts parts of the study of a brake together in a folder, mixed ones or not, with every mode or not.
#[pyfunction]
pub(crate) fn merge(
    py: Python<'_>,
    brake: &Brake,
    parts: (Vec<PathBuf>, bool, bool),
    out: PathBuf,
    half_width: Option<f64>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Ran> {
    let (parts, is_mixed, every_mode) = parts;
    let source = brake.source.clone();
    away(py, Ends::Itself, progress.as_ref(), move |watch| {
        let known = parts.iter().map(|part| completed(part)).collect::<Result<Vec<_>, _>>()?;
        consistent(&parts, &known, is_mixed)?;
        // The study has the seed of its parts, and as many samples as the longest of them is a part of.
        let samples = known.iter().map(|part| part.of).max();
        let source = source.with_run(samples, known.first().map(|part| part.seed))?;
        let half_width = half_width.or(source.half_width());
        let brake = source.brake(Purpose::Study, threads, watch)?;
        let is_kept = known.iter().any(|part| part.identity.contains(" samples=kept"));
        let args = run_args(out, [is_kept, every_mode], threads, None);
        let mut text = Vec::new();
        ran(args.study(&brake, half_width, Some((&parts, is_mixed)), &**watch, &mut text), text)
    })
}

/// Seconds of preparation, samples and report of a study, roughly, and bytes.
#[pyfunction]
pub(crate) fn estimate(py: Python<'_>, brake: &Brake) -> PyResult<(f64, f64, f64, f64)> {
    let source = brake.source.clone();
    away(py, Ends::Itself, None, move |watch| {
        let brake = source.brake(Purpose::Analysis, None, watch)?;
        let (preparation, evaluation) = (watch.stage(PREPARED), watch.stage(EVALUATED));
        let time = squeal::expected_time(&brake, &*preparation, &*evaluation)?;
        let [preparation, samples, report] = [time.preparation, time.samples, time.report].map(|of| of.as_secs_f64());
        Ok((preparation, samples, report, Cost::of(brake.plan()).bytes))
    })
}

/// One analysis of the first scene at the medians, with shapes as JSON, or what the program prints.
#[pyfunction]
pub(crate) fn cea(py: Python<'_>, brake: &Brake, why: bool, json: bool) -> PyResult<String> {
    let source = brake.source.clone();
    away(py, Ends::LeftBehind, None, move |watch| {
        let (scene, memory) = (SceneArgs::default(), MemoryArgs::default());
        let args = CeaArgs { case: CaseArgs::default(), scene, modes: json, why, json, memory };
        args.analysis(&source.brake(args.purpose(), None, watch)?)
    })
}

/// A sweep over one parameter or two, of the first scene: tables, JSON, text.
#[pyfunction]
pub(crate) fn sweep(
    py: Python<'_>,
    brake: &Brake,
    over: Vec<(String, f64, f64)>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Vec<AsTable>, String, String)> {
    let over: Vec<Over> =
        over.into_iter().map(|(name, from, to)| Over { name: parameter_of(&name).into(), from, to }).collect();
    if !(1..=2).contains(&over.len()) {
        return Err(argument(py, "sweep", &format!("{} parameters", over.len()), "one or two"));
    }
    let source = brake.source.clone();
    away(py, Ends::Itself, progress.as_ref(), move |watch| {
        let brake = source.brake(Purpose::Sweep(&over), threads, watch)?;
        let found = workers(threads)?.install(|| -> Result<Found, Error> {
            let study = Study::with_progress(&brake, &QrSolver, &*watch.stage(PREPARED))?;
            Ok(match &over[..] {
                [a, b] => {
                    let both = [a.clone(), b.clone()];
                    Found::Map(stability_map(&study, 0, &both, &QrSolver, &*watch.stage("lines"))?.into())
                }
                one => Found::Branches(
                    over_one(&study, 0, &one[0], &QrSolver, &*watch.stage("steps of the sweep"))?.into(),
                ),
            })
        })?;
        Ok((tables(found.tables()), found.json().to_string(), found.text()))
    })
}

/// Influence of the inputs in the first scene, with total indices of so many rows: the table, draws, failures, evaluations, text.
#[pyfunction]
pub(crate) fn influence(
    py: Python<'_>,
    brake: &Brake,
    draws: u64,
    total: Option<u64>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(AsTable, u64, u64, String)> {
    let source = brake.source.clone();
    away(py, Ends::Itself, progress.as_ref(), move |watch| {
        let brake = source.brake(Purpose::Study, threads, watch)?;
        let plan = brake.plan();
        let found = workers(threads)?.install(|| {
            let study = Study::with_progress(&brake, &BatchSolver, &*watch.stage(PREPARED))?;
            of_inputs(&study, 0, draws, total, &*watch.stage(EVALUATED))
        })?;
        let Table { name, columns, rows } = influence_table(plan, [(&plan.scenes[0], &found)]);
        Ok(((name, columns, rows), found.failures, found.evaluations, found.text(plan)))
    })
}

/// Starts of a motion: from noise, or the rank of a mode; of neither each unstable mode. Harmonics, steps of a period and what counts as sticking.
type Motion = (bool, Option<usize>, usize, usize, f64);

/// The motion after the onset in the first scene, at the medians or over a parameter: tables, text.
#[pyfunction]
pub(crate) fn cycle(
    py: Python<'_>,
    brake: &Brake,
    over: Option<(String, f64, f64)>,
    motion: Motion,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Vec<AsTable>, String)> {
    let (is_noise, rank, harmonics, samples, stick) = motion;
    let from = match rank {
        _ if is_noise => Start::Noise,
        Some(rank) => Start::Mode(rank),
        None => Start::UnstableModes,
    };
    let options = CycleOptions { from, harmonics, samples, stick };
    let over = over.map(|(name, from, to)| Over { name: parameter_of(&name).into(), from, to });
    let source = brake.source.clone();
    away(py, Ends::Itself, progress.as_ref(), move |watch| {
        source.has_motion()?;
        let purpose = over.as_ref().map_or(Purpose::Analysis, |over| Purpose::Sweep(std::slice::from_ref(over)));
        let brake = source.brake(purpose, threads, watch)?;
        let scene = &brake.plan().scenes[0];
        workers(threads)?.install(|| match &over {
            None => {
                let told = watch.stage("periods of the modes at most");
                let found = cycles(&brake, scene, &options, None, &*told)?;
                let of = vec![found.table(), found.contacts_table(), found.spectrum_table()];
                Ok((tables(of), found.text()))
            }
            Some(over) => {
                let study = Study::with_progress(&brake, &QrSolver, &*watch.stage(PREPARED))?;
                let (swept, followed) = (watch.stage("steps of the sweep"), watch.stage("steps of the branches"));
                let found = branches(&study, 0, over, &options, None, [&*swept, &*followed])?;
                Ok((tables(vec![found.table()]), found.text()))
            }
        })
    })
}

/// The probability of squeal in the first scene, by a relative standard error, a number of spectra and of directions: tables, JSON, text.
#[pyfunction]
pub(crate) fn rare(
    py: Python<'_>,
    brake: &Brake,
    asked: (f64, u64, usize),
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Vec<AsTable>, String, String)> {
    let (relative, budget, directions) = asked;
    let source = brake.source.clone();
    away(py, Ends::Itself, progress.as_ref(), move |watch| {
        let brake = source.brake(Purpose::Analysis, threads, watch)?;
        let plan = brake.plan();
        let options = Options { relative, budget, directions, seed: plan.seed };
        let found = workers(threads)?.install(|| -> Result<_, Error> {
            let study = Study::with_progress(&brake, &BatchSolver, &*watch.stage(PREPARED))?;
            Ok(rare_squeal(&study, 0, &options, &BatchSolver, None, &*watch.stage("spectra"))?)
        })?;
        let scene = &plan.scenes[0];
        let of = vec![rare_table(plan, [(scene, &found)]), design_points_table(plan, [(scene, &found)])];
        let document = json!({
            "scene": plan.describe(scene),
            "warnings": found.doubts,
            "seed": plan.seed,
            "probability": found.probability,
            "certified": found.bound,
            "lines": found.lines,
            "elsewhere": found.elsewhere,
            "spectra": found.spectra,
            "is_reached": found.is_reached,
        });
        Ok((tables(of), document.to_string(), found.text(plan)))
    })
}

/// A screen of changes: kinds, places at most, mass, spring and dashpot added and factor of parts, draws of the prediction, single changes to confirm, criterion.
type Screening = (Option<Vec<String>>, usize, [Option<f64>; 4], u64, usize, String);

/// A screen of a set of constraints of a brake, and of variants of it by their names: tables, JSON, text.
#[pyfunction]
pub(crate) fn screen(
    py: Python<'_>,
    brake: &Brake,
    variants: Vec<(String, PyRef<'_, Brake>)>,
    screening: Screening,
    set: usize,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Vec<AsTable>, String, String)> {
    let (kinds, up_to, [mass, spring, dashpot, factor], draws, confirmed, criterion) = screening;
    let mut options = ScreenOptions::default();
    options.sizes = Sizes { mass, spring, dashpot, factor };
    options.variants = variants.len();
    (options.up_to, options.draws, options.confirmed, options.constraints) = (up_to, draws, confirmed, set);
    if let Some(kinds) = kinds {
        let kind = |name: &String| {
            let known = ChangeKind::ALL.into_iter().find(|kind| kind.name() == name);
            let allowed = ChangeKind::ALL.map(ChangeKind::name).join(", ");
            known.ok_or_else(|| argument(py, "kinds", &format!("{name:?}"), &allowed))
        };
        options.kinds = kinds.iter().map(kind).collect::<PyResult<_>>()?;
    }
    let known = Criterion::ALL.into_iter().find(|known| known.name() == criterion);
    let allowed = Criterion::ALL.map(Criterion::name).join(", ");
    options.criterion = known.ok_or_else(|| argument(py, "criterion", &format!("{criterion:?}"), &allowed))?;
    let source = brake.source.clone();
    let variants: Vec<_> = variants.into_iter().map(|(name, variant)| (name, variant.source.clone())).collect();
    away(py, Ends::Itself, progress.as_ref(), move |watch| {
        let brake = source.brake(Purpose::Screen, threads, watch)?;
        let made = |(name, source): (String, Source)| Ok((name, source.brake(Purpose::Screen, threads, watch)?));
        let variants = variants.into_iter().map(made).collect::<Result<Vec<_>, Error>>()?;
        let named: Vec<(&str, &AnyBrake)> = variants.iter().map(|(name, variant)| (name.as_str(), variant)).collect();
        let screen = match named.is_empty() {
            true => screened(&brake, &options, threads, watch)?,
            false => screened(&Joined::new(&brake, &named, options.constraints)?, &options, threads, watch)?,
        };
        Ok((tables(screen.tables()), screen.json().to_string(), screen.text()))
    })
}

/// A brake, screened: ranked and confirmed.
fn screened<B: UncertainBrake>(
    brake: &B,
    options: &ScreenOptions,
    threads: Option<usize>,
    watch: &Arc<Watch>,
) -> Result<squeal::screen::Screen, Error> {
    let ranking = workers(threads)?.install(|| rank(brake, options, &*watch.stage("combinations of changes")))?;
    let (preparation, evaluation) = (watch.stage(PREPARED), watch.stage(EVALUATED));
    let how = Confirmation::new(brake.plan().samples).with_threads(threads).with_progress(&*preparation, &*evaluation);
    Ok(confirm(brake, ranking, options, &how)?)
}

/// A point of the plain function, evaluated.
#[derive(Clone)]
struct Evaluated {
    /// The eigenvalue of largest real part.
    rightmost: Complex<f64>,
    unstable: i64,
    /// Eigenvalues of which it is open whether they grow, and those on the threshold.
    open: i64,
}

/// Of all points: largest growth rates, frequencies of these eigenvalues, numbers of unstable and open ones; which failed, and why.
type Columns = (Vec<f64>, Vec<f64>, Vec<i64>, Vec<i64>, Vec<(usize, String)>);

/// The same as Python has it.
type OfPoints<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Vec<(usize, String)>,
);

/// The plain function: what the first scene is at given values of named parameters, a row for each point.
#[pyfunction]
pub(crate) fn evaluate<'py>(
    py: Python<'py>,
    brake: &Brake,
    names: Vec<String>,
    values: PyReadonlyArray2<'py, f64>,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<OfPoints<'py>> {
    let rows: Vec<f64> = values.as_array().iter().copied().collect();
    let source = brake.source.clone();
    let (growth, hertz, unstable, open, failed) = away(py, Ends::Itself, progress.as_ref(), move |watch| {
        Ok(in_columns(&points(source, &names, &rows, threads, watch)?))
    })?;
    Ok((growth.into_pyarray(py), hertz.into_pyarray(py), unstable.into_pyarray(py), open.into_pyarray(py), failed))
}

fn in_columns(found: &[Result<Evaluated, String>]) -> Columns {
    let failed = found.iter().enumerate().filter_map(|(at, of)| Some((at, of.as_ref().err()?.clone()))).collect();
    let number = |of: &dyn Fn(&Evaluated) -> f64| -> Vec<f64> {
        found.iter().map(|found| found.as_ref().map_or(f64::NAN, of)).collect()
    };
    let count = |of: &dyn Fn(&Evaluated) -> i64| -> Vec<i64> {
        found.iter().map(|found| found.as_ref().map_or(-1, of)).collect()
    };
    let hertz = |of: &Evaluated| analysis::frequency_hz(of.rightmost);
    (number(&|of| of.rightmost.re), number(&hertz), count(&|of| of.unstable), count(&|of| of.open), failed)
}

fn points(
    source: Source,
    names: &[String],
    rows: &[f64],
    threads: Option<usize>,
    watch: &Arc<Watch>,
) -> Result<Vec<Result<Evaluated, String>>, Error> {
    let brake: AnyBrake = source.brake(Purpose::Analysis, threads, watch)?;
    let allowed = |argument, value: String, allowed: String| squeal::Error::Argument { argument, value, allowed };
    let (Some(of), None) = (brake.parametrised(), brake.finite_elements()) else {
        let possible = "a lattice, or a brake given by its matrices".to_owned();
        return Err(allowed("brake", "one of finite elements".to_owned(), possible).into());
    };
    let (plan, scene) = (brake.plan(), &brake.plan().scenes[0]);
    let known: Vec<String> = of.parameters(scene).into_iter().map(|parameter| parameter.name).collect();
    let place = |name: &String| {
        let refused = || allowed("points", format!("a column {name:?}"), known.join(", "));
        known.iter().position(|of| of == name).ok_or_else(refused)
    };
    let places = names.iter().map(place).collect::<Result<Vec<_>, _>>()?;
    let told = watch.stage(EVALUATED);
    let width = names.len().max(1);
    told.begin((rows.len() / width) as u64, 0);
    let of_system = |system: &SecondOrder, spectrum, work: &mut Workspace| -> Result<Evaluated, CeaError> {
        let spectrum: analysis::Spectrum = spectrum?;
        let counted = CountedSpectrum::new(&plan.threshold, system, &spectrum, work)?;
        let upper = spectrum.eigenvalues.iter().filter(|lambda| lambda.im >= 0.0);
        let rightmost = upper.max_by(|a, b| a.re.total_cmp(&b.re)).copied().unwrap_or_default();
        let open = (counted.marginal.len() + counted.open) as i64;
        Ok(Evaluated { rightmost, unstable: counted.unstable() as i64, open })
    };
    let of_some = |rows: &[f64]| {
        // What is not evaluated is not looked at: the work ends below.
        if told.is_cancelled() {
            return Vec::new();
        }
        let mut work = Workspace::default();
        let values = |row: &[f64]| places.iter().copied().zip(row.iter().copied()).collect();
        let systems = of.systems_with(scene, &rows.chunks_exact(width).map(values).collect::<Vec<_>>());
        let sound: Vec<SecondOrder> = systems.iter().filter_map(|system| system.as_ref().ok().cloned()).collect();
        let mut spectra = Vec::with_capacity(sound.len());
        BatchSolver.eigenvalues_of_all(&sound, &mut work, &mut spectra);
        let mut spectra = spectra.into_iter();
        told.advance(systems.len() as u64);
        let found = systems.iter().map(|system| {
            let system = system.as_ref().map_err(ToString::to_string)?;
            let spectrum = spectra.next().unwrap_or(Err(CeaError::SpectraCount { found: 0, expected: 1 }));
            of_system(system, spectrum, &mut work).map_err(|error| error.to_string())
        });
        found.collect::<Vec<Result<Evaluated, String>>>()
    };
    let found: Vec<_> =
        workers(threads)?.install(|| rows.par_chunks(TOGETHER * width).flat_map_iter(of_some).collect());
    told.go_on().map_err(|error: MonteCarloError| Error::from(squeal::Error::from(error)))?;
    Ok(found)
}
