//! `accuracy.{json,md,csv,svg,png}`: everything measured in one run.

use std::fmt::Write as _;
use std::path::Path;

use cea::{BatchSolver, QrSolver};
use serde::Serialize;
use squeal::case::{Case, Law};
use squeal::estimators::{OneParameterFamily, exact, support};
use squeal::figures::{LogLogFigure, LogLogPanel, LogLogSeries, loglog};
use squeal::output::{make_folder, write};
use squeal::study::{Plan, Sample, Scene, Study};

use crate::ValidationError;
use crate::coalescence::exceptional_point;
use crate::compare::{Estimators, RouteRow, compare_estimators, compare_routes};
use crate::hard::judge_folder;
use crate::tenth::{self, TenthRow, time_to_a_tenth};
use crate::worst::{GENERAL, HardCase, HardResult, Judged, STANDARD, approach, extremes, onset};

/// How much is measured.
#[derive(Debug, Clone)]
pub struct Effort {
    /// Every how many-th class of arrangements is a scene of the estimators.
    pub every: usize,
    /// Sizes of plain Monte Carlo.
    pub plain: Vec<u64>,
    /// Sizes of each scrambling of quasi-Monte Carlo.
    pub quasi: Vec<u32>,
    /// Scramblings.
    pub scramblings: u32,
    /// Systems of a route away from coalescence.
    pub systems: u64,
    /// Every how many-th class of arrangements is brought to a tenth of a percentage point under every law.
    pub every_tenth: usize,
}

impl Effort {
    /// A minute.
    pub fn quick() -> Self {
        Self { every: 15, plain: vec![100, 1_000], quasi: vec![16, 64], scramblings: 8, systems: 32, every_tenth: 45 }
    }

    /// Some minutes.
    pub fn full() -> Self {
        Self {
            every: 3,
            plain: vec![100, 1_000, 10_000],
            quasi: vec![16, 64, 256],
            scramblings: 8,
            systems: 256,
            every_tenth: 1,
        }
    }
}

/// All that was measured.
#[derive(Debug, Clone, Serialize)]
pub struct AccuracyReport {
    /// Time per system against largest relative error.
    pub routes: Vec<RouteRow>,
    /// Time per scene against error of the occurrences.
    pub estimators: Estimators,
    /// Time to a tenth of a percentage point, by law and speed range.
    pub tenth: Vec<TenthRow>,
    /// The lattice at its worst.
    pub lattice: Vec<HardResult>,
    /// Hard problems from files.
    pub hard: Vec<HardResult>,
}

/// Distances in mu from an exceptional point, below and above.
const DISTANCES: [f64; 10] = [-1e-4, -1e-6, -1e-8, -1e-10, 1e-10, 1e-9, 1e-8, 1e-6, 1e-4, 1e-3];

/// Measures everything on the lattice of `case`, and on the problems in `hard`.
///
/// # Errors
/// A case without Coulomb friction shared by all contacts; what the solvers and the files say.
pub fn accuracy(case: &Case, hard: &Path, effort: &Effort) -> Result<AccuracyReport, ValidationError> {
    let with_laws = |laws: Vec<Law>| {
        let mut case = case.clone();
        case.laws = laws;
        Plan::new(case).map_err(ValidationError::from)
    };
    let plan = with_laws(vec![Law::AmontonsCoulomb])?;
    let both = with_laws(vec![Law::AmontonsCoulomb, Law::LuGre])?;
    let scene_of = |law: Law| both.scenes.iter().find(|s| s.key.law == law).ok_or(ValidationError::NoScene { law });
    let (coulomb, lugre) = (scene_of(Law::AmontonsCoulomb)?, scene_of(Law::LuGre)?);

    let (from, to) = support(case.friction.mu);
    let mut undamped = OneParameterFamily::new(&plan, &plan.scenes[0], &QrSolver)?;
    let mut system = |mu: f64| {
        let mut system = undamped.system(mu).clone();
        system.c.fill(0.0);
        Ok(system)
    };
    let point = exceptional_point(&mut system, from, to)?;
    let near = approach(&mut system, &point, &DISTANCES)?;

    let study = Study::new(&plan, &BatchSolver)?;
    let mut family = OneParameterFamily::new(&plan, &plan.scenes[0], &QrSolver)?;
    let first = exact(&plan, &study.references()[0], &mut family)?;
    let mut worst = Vec::new();
    for crossing in &first.onsets.onsets {
        worst.extend(onset(&plan, &plan.scenes[0], crossing)?);
    }
    worst.extend(approach(&mut system, &point, &DISTANCES)?);
    worst.extend(extremes(&both, coulomb, lugre)?);

    let groups = vec![
        ("Amontons-Coulomb, draws".to_owned(), false, drawn(&both, coulomb, effort.systems)?),
        ("LuGre, draws".to_owned(), false, drawn(&both, lugre, effort.systems)?),
        ("no damping, 1e-3 to 1e-10 from an exceptional point".to_owned(), true, near),
    ];
    let scenes: Vec<usize> = (0..plan.scenes.len()).step_by(effort.every).collect();
    let mut lattice = Vec::new();
    for case in &worst {
        lattice.extend(case.judge());
    }
    Ok(AccuracyReport {
        routes: compare_routes(&groups),
        estimators: compare_estimators(&study, &scenes, &effort.plain, &effort.quasi, effort.scramblings)?,
        tenth: time_to_a_tenth(case, effort.every_tenth)?,
        lattice,
        hard: judge_folder(hard)?,
    })
}

fn drawn(plan: &Plan, scene: &Scene, count: u64) -> Result<Vec<HardCase>, ValidationError> {
    let system = |i: u64| {
        let sample =
            Sample::draw(&plan.case, &mut montecarlo::stream(plan.case.seed, i)).map_err(squeal::Error::from)?;
        let mut system = linsys::SecondOrder::zeros(1, 0);
        plan.linearise(scene, &sample, &mut system)?;
        HardCase::new(format!("draw {i}"), system)
    };
    (0..count).map(system).collect()
}

impl AccuracyReport {
    /// Writes the report and its figures into `folder`.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self, folder: &Path) -> Result<(), squeal::Error> {
        make_folder(folder)?;
        let path = folder.join("accuracy.json");
        let json = serde_json::to_vec_pretty(self)
            .map_err(|error| squeal::Error::Write { path: path.clone(), source: error.into() })?;
        write(&path, &json)?;
        write(&folder.join("accuracy.md"), self.markdown().as_bytes())?;
        loglog(&self.routes_figure())?.save(folder, "accuracy")?;
        Ok(loglog(&self.estimators_figure())?.save(folder, "accuracy-estimators")?)
    }

    fn routes_figure(&self) -> LogLogFigure {
        let panel = |near: bool, title: &str| {
            let mut series: Vec<LogLogSeries> = Vec::new();
            for row in self.routes.iter().filter(|row| row.near_coalescence == near && row.max_error.is_finite()) {
                let point = [row.us, row.max_error];
                match series.iter_mut().find(|s| s.name == row.route) {
                    Some(one) => one.points.push(point),
                    None => series.push(LogLogSeries { name: row.route.into(), points: vec![point], joined: false }),
                }
            }
            LogLogPanel { title: title.into(), series }
        };
        LogLogFigure {
            title: "Solver routes".into(),
            x_label: "Time per system, \u{b5}s".into(),
            y_label: "Largest relative error of an eigenvalue".into(),
            panels: vec![panel(false, "Away from coalescence"), panel(true, "Near coalescence")],
        }
    }

    fn estimators_figure(&self) -> LogLogFigure {
        let panel = |near: bool, title: &str| {
            let mut series: Vec<LogLogSeries> = Vec::new();
            for row in &self.estimators.rows {
                let point = [row.seconds, if near { row.max_error_near } else { row.max_error_away }];
                match series.iter_mut().find(|s| s.name == row.estimator) {
                    Some(one) => one.points.push(point),
                    None => series.push(LogLogSeries { name: row.estimator.into(), points: vec![point], joined: true }),
                }
            }
            LogLogPanel { title: title.into(), series }
        };
        LogLogFigure {
            title: "Estimators of an occurrence".into(),
            x_label: "Time per scene, s".into(),
            y_label: "Largest error of an occurrence".into(),
            panels: vec![panel(false, "No coalescence before the onset"), panel(true, "Past a coalescence")],
        }
    }

    /// The report for people.
    pub fn markdown(&self) -> String {
        let mut text = String::from("# Accuracy\n\nEverything here was measured in one run, on one thread.\n");
        text += "\n## Solver routes\n\nErrors are relative, against eigenvalues refined in double-double.\n\n";
        text += "| route | systems | n | states | \u{b5}s | not solved | largest error |\n\
                 | --- | --- | --- | --- | --- | --- | --- |\n";
        for row in &self.routes {
            let RouteRow { route, systems, n, states, us, count, failed, max_error, .. } = row;
            let _ = writeln!(
                text,
                "| {route} | {systems} | {n} | {states} | {us:.0} | {failed} of {count} | {max_error:.1e} |"
            );
        }
        self.estimators_markdown(&mut text);
        text += &tenth::markdown(&self.tenth);
        text += "\n## The lattice at its worst\n\nEigenvalues of the structure with Im lambda >= 0. ";
        text += "Forward errors are in units of condition number times machine epsilon.\n";
        text += "Bare sign: eigenvalues that a test of Re lambda > 0 puts on the wrong side.\n\n";
        certified_table(&mut text, &self.lattice);
        text += "\n## Hard problems\n\n";
        certified_table(&mut text, &self.hard);
        text += "\n## Side by side with libraries\n\n";
        text += "What a script does: all eigenvalues of the textbook matrices `[0 I 0; -M^-1 K, -M^-1 C, M^-1 F; 0 E -a]` \
                 (nalgebra, dgeev) or `[0 I 0; -K -C F; 0 E -a] - lambda diag(I, M, I)` (dggev) in the units given, without \
                 scaling beforehand, and the sign of Re lambda as the verdict. Each cell: forward error / backward error / \
                 decided signs that are wrong; `-` where a route does not run.\n\n";
        if !cfg!(feature = "lapack") {
            text += "This build has no LAPACK: its columns need the system's OpenBLAS (`libopenblas-dev` on Debian) and \
                     `cargo xtask accuracy --features lapack`.\n\n";
        }
        side_by_side(&mut text, &self.lattice);
        text += "\n";
        side_by_side(&mut text, &self.hard);
        text
    }

    fn estimators_markdown(&self, text: &mut String) {
        let Estimators { scenes, occurrences, reference_bound, samples_to_a_tenth_of_a_point, rows } = &self.estimators;
        let _ = writeln!(
            text,
            "\n## Estimators of an occurrence\n\nShared Coulomb friction, {scenes} scenes; {} occurrences away from \
             coalescence, {} near: a branch point lies nearer to the median than the onset, where no expansion converges. Reference: the exact integral, error at most {reference_bound:.1e}. \
             Plain Monte Carlo needs {samples_to_a_tenth_of_a_point:.0} samples for 0.1 percentage points (95 %) of the \
             worst of them.\n",
            occurrences[0], occurrences[1]
        );
        *text += "| estimator | samples | spectra | s per scene | largest error, away | near |\n";
        *text += "| --- | --- | --- | --- | --- | --- |\n";
        for row in rows {
            let _ = writeln!(
                text,
                "| {} | {} | {:.0} | {:.2e} | {:.1e} | {:.1e} |",
                row.estimator, row.samples, row.spectra, row.seconds, row.max_error_away, row.max_error_near
            );
        }
        let time = |estimator: &str| rows.iter().rev().find(|row| row.estimator == estimator);
        if let (Some(plain), Some(exact)) = (time("Monte Carlo"), time("exact integral")) {
            let plain = plain.seconds / plain.samples as f64 * samples_to_a_tenth_of_a_point;
            let _ = writeln!(
                text,
                "\nTo 0.1 percentage points, by BatchSolver: {plain:.0} s of plain Monte Carlo a scene, extrapolated from its \
                 time per sample, against {:.2e} s of the exact integral: {:.0} times.",
                exact.seconds,
                plain / exact.seconds
            );
        }
    }
}

/// The routes of ours, whose verdicts rest on bounds.
fn certified_table(text: &mut String, results: &[HardResult]) {
    *text += "| case | route | judged | forward | backward | wrong signs | false instabilities | marginal | undecided | bare sign |\n";
    *text += "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for result in results.iter().filter(|result| [STANDARD, GENERAL].contains(&result.route())) {
        table_row(text, result);
    }
}

/// A row for each case, a column for each route.
fn side_by_side(text: &mut String, results: &[HardResult]) {
    let mut routes: Vec<&str> = Vec::new();
    for result in results {
        if !routes.contains(&result.route()) {
            routes.push(result.route());
        }
    }
    let _ = writeln!(text, "| case | {} |\n| --- |{}", routes.join(" | "), " --- |".repeat(routes.len()));
    for of_case in results.chunk_by(|a, b| a.case() == b.case()) {
        let cell = |route: &&str| match of_case.iter().find(|result| result.route() == *route) {
            Some(HardResult::Judged(j)) => {
                let Judged {
                    max_error_in_condition_epsilon: forward, max_backward_error: backward, wrong_signs, ..
                } = j;
                format!("{forward:.1e} / {backward:.0e} / {wrong_signs}")
            }
            _ => "-".to_owned(),
        };
        let cells: Vec<String> = routes.iter().map(cell).collect();
        let _ = writeln!(text, "| {} | {} |", of_case[0].case(), cells.join(" | "));
    }
}

fn table_row(text: &mut String, result: &HardResult) {
    let _ = match result {
        HardResult::Refused { case, route, reason } => {
            writeln!(text, "| {case} | {route} | refused: {reason} | | | | | | | |")
        }
        HardResult::Judged(Judged {
            case,
            route,
            modes,
            max_error_in_condition_epsilon: forward,
            max_backward_error: backward,
            wrong_signs,
            false_instabilities,
            marginal,
            undecided,
            wrong_by_bare_sign: bare,
            ..
        }) => writeln!(
            text,
            "| {case} | {route} | {modes} | {forward:.2} | {backward:.1e} | {wrong_signs} | {false_instabilities} | \
             {marginal} | {undecided} | {bare} |"
        ),
    };
}
