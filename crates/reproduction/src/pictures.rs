//! The figures of the paper, from a study of its case.

use std::path::Path;

use brakes::LatticeBrake;
use brakes::case::Paper;
use figures::{
    BodyInMode, LawMode, ModeWorkFigure, ModelDiagram, NetWork, OccurrenceMark, mode_and_work, model_diagram,
    occurrence_boxes,
};
use num_complex::Complex;
use osc_model::Lean;
use rayon::prelude::*;
use report::{occurrence, set_heading};
use squeal::results::Results;
use squeal::study::{ModeLabel, Scene};

use crate::Error;
use crate::{CORNERS_HELD, Judgement, SIX_HELD, UNCONSTRAINED, most_robust, paper_modes, shape, title};

/// Draws the paper's Figures 2 and 4 to 9 from a study of its case: `fig02`, `fig04` to `fig09`; Figure 7 for
/// the most robust mode, and as `fig07-paper-number` and `fig07-paper-number-down` for those that bear the paper's number from the lowest
/// frequency and from the highest, if they ever are unstable.
///
/// # Errors
/// Those of the figures.
pub fn draw_paper(results: &Results, brake: &LatticeBrake, dir: &Path) -> Result<(), Error> {
    let case = &brake.case;
    let grid = case.lattice.grid;
    let diagram = ModelDiagram {
        title: case.header.name.clone(),
        rows: grid.rows(),
        columns: grid.columns(),
        in_contact: vec![true; grid.oscillators()],
        theta_degrees: case.lattice.theta.to_degrees(),
        phi_degrees: case.lattice.phi.to_degrees(),
        leans_with_sliding: case.lattice.lean == Lean::Along,
    };
    let mut figures = vec![(model_diagram(&diagram)?, "fig02")];
    let laws: Vec<usize> = (0..case.laws.len()).collect();
    for (&law, stem) in laws.iter().zip(["fig04", "fig05", "fig06"]) {
        let heading = format!("{} friction; {}", case.laws[law].title(), set_heading(results, UNCONSTRAINED));
        figures.push((occurrence_boxes(&occurrence(results, UNCONSTRAINED, &[law], heading, Vec::new()))?, stem));
    }
    for (constraints, stem) in [(CORNERS_HELD, "fig08"), (SIX_HELD, "fig09")] {
        if let Some(set) = case.constraints.get(constraints) {
            let held: Vec<String> = set.fixed.iter().map(ToString::to_string).collect();
            let heading = format!("{}; held: {}", set_heading(results, constraints), held.join(", "));
            let heading = heading[..1].to_uppercase() + &heading[1..];
            let marks = case.paper.as_ref().map_or(Vec::new(), |paper| marks(results, constraints, paper));
            figures.push((occurrence_boxes(&occurrence(results, constraints, &laws, heading, marks))?, stem));
        }
    }
    let robust = most_robust(results, UNCONSTRAINED, Judgement::ByValues)?.first().map(|&(name, _)| name);
    let theirs = case.paper.as_ref().map(|paper| paper_modes(results, paper));
    let [up, down] = [0, 1].map(|end| theirs.map(|modes| modes[end]));
    let counted = |from: &str| {
        case.paper.as_ref().map_or_else(String::new, |p| format!(": the paper's {} from the {from}", p.mode))
    };
    for (name, stem, number) in [
        (robust, "fig07", String::new()),
        (up, "fig07-paper-number", counted("lowest frequency")),
        (down, "fig07-paper-number-down", counted("highest frequency")),
    ] {
        if let Some(figure) = name.and_then(|name| mode_work(results, brake, UNCONSTRAINED, name).transpose()) {
            let figure = figure?;
            let title = figure.title.clone() + &number;
            figures.push((mode_and_work(&ModeWorkFigure { title, ..figure })?, stem));
        }
    }
    figures.into_par_iter().try_for_each(|(figure, stem)| Ok(figure.save(dir, stem)?))
}

/// Marks of what the paper prints of the occurrences under a set of constraints, in the panels of which it says so.
fn marks(results: &Results, constraints: usize, paper: &Paper) -> Vec<OccurrenceMark> {
    let labels = &results.plan().labels;
    let most = labels.panels.iter().map(|panel| panel.in_contact).max().unwrap_or(0);
    let panels = |law: Option<&str>, of_number: &dyn Fn(usize) -> bool| -> Vec<[usize; 2]> {
        let laws = (0..labels.laws.len()).filter(|&at| law.is_none_or(|law| labels.laws[at].name == law));
        let numbers: Vec<usize> =
            (0..labels.panels.len()).filter(|&at| of_number(labels.panels[at].in_contact)).collect();
        laws.flat_map(|law| numbers.iter().map(move |&number| [law, number])).collect()
    };
    let mark = |part: f64, text: &str, panels| {
        // From a rounded decimal to another: 34.8 and not 34.800000000000004.
        let percent = (1e4 * part).round() / 100.0;
        OccurrenceMark { percent, text: format!("paper: {percent} %, {text}"), panels }
    };
    match constraints {
        CORNERS_HELD => {
            let text = format!("median with {most} in contact");
            vec![mark(paper.after_corners_occurrence, &text, panels(None, &|number| number == most))]
        }
        SIX_HELD => vec![
            mark(paper.after_six_occurrence, "largest median, LuGre", panels(Some("lugre"), &|_| true)),
            mark(paper.after_six_bound, "bound of all medians", panels(None, &|_| true)),
        ],
        _ => Vec::new(),
    }
}

/// A mode with every oscillator in contact, under each law at its first speed range.
fn mode_work(
    results: &Results,
    brake: &LatticeBrake,
    constraints: usize,
    name: ModeLabel,
) -> Result<Option<ModeWorkFigure>, Error> {
    let grid = brake.case.lattice.grid;
    let mut columns = Vec::new();
    for (law, of_law) in brake.case.laws.iter().enumerate() {
        let is_it = |scene: &Scene| {
            let key = scene.key;
            key.constraints == constraints && key.law == law && key.speed.unwrap_or(0) == 0 && scene.wants_work
        };
        let Some(at) = results.plan().scenes.iter().position(is_it) else { continue };
        let (scene, reference) = (&results.plan().scenes[at], &results.references()[at]);
        let Some(shape) = shape(results, scene, reference, name) else { continue };
        let lambda = reference.modes.iter().zip(&reference.names).find(|(_, names)| **names == [name]);
        let mut caption = match scene.key.speed {
            None => "at any speed".to_owned(),
            Some(range) => {
                let range = &brake.case.speeds[range];
                format!("at {}\u{a0}m/s, the median of {} speed", three_digits(range.quantile(0.5)), range.name)
            }
        };
        if let Some((mode, _)) = lambda {
            let (frequency, growth) = (cea::frequency_hz(mode.lambda), mode.lambda.re);
            caption += &format!("\n{frequency:.1}\u{a0}Hz, growth {growth:+.0}\u{a0}1/s");
        }
        let bodies = bodies(results, at, name, &shape)?;
        columns.push(LawMode { law: of_law.title().into(), caption, bodies });
    }
    // A mode that is never unstable has no work to show.
    let has_work = |column: &LawMode| column.bodies.iter().any(|body| body.work.quartiles.is_some());
    if !columns.iter().any(has_work) {
        return Ok(None);
    }
    let heading = title(results, name);
    let note = brake.case.paper.as_ref().map_or(String::new(), |paper| dominant_note(&columns, paper));
    Ok(Some(ModeWorkFigure { title: heading, note, rows: grid.rows(), columns: grid.columns(), laws: columns }))
}

/// Note on the oscillators that have most net work under all laws, beside those that the paper names.
fn dominant_note(laws: &[LawMode], paper: &Paper) -> String {
    let leads = |law: &LawMode, i: usize| {
        // The plate comes last; it is no oscillator.
        let oscillators = &law.bodies[..law.bodies.len() - 1];
        let most = oscillators.iter().map(|body| body.work.median).fold(f64::MIN, f64::max);
        oscillators.get(i).is_some_and(|body| body.work.median >= LEADING_PART * most)
    };
    let count = laws.first().map_or(0, |law| law.bodies.len());
    let leading: Vec<usize> = (0..count).filter(|&i| laws.iter().all(|law| leads(law, i))).map(|i| i + 1).collect();
    let list = |numbers: &[usize]| numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    let theirs = list(&paper.corners);
    match (leading == paper.corners, leading.is_empty()) {
        (true, _) => format!("Oscillators {theirs} have most net work under every law, as in the paper."),
        (_, true) => {
            format!("No oscillators have most net work under every law; in the paper the corners {theirs} have.")
        }
        _ => format!(
            "Oscillators {} have most net work under every law; this contradicts the paper, in which the corners {theirs} have.",
            list(&leading)
        ),
    }
}

/// Least part of the largest median net work with which an oscillator counts as one of those that lead; chosen.
const LEADING_PART: f64 = 0.9;

/// A speed with three significant digits.
fn three_digits(value: f64) -> String {
    let decimals = (2.0 - value.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

fn bodies(results: &Results, at: usize, name: ModeLabel, shape: &[Complex<f64>]) -> Result<Vec<BodyInMode>, Error> {
    let map = &results.plan().brake(&results.plan().scenes[at]).dofs;
    let tracked = results.tracked_name(at, name);
    let sketches = tracked.and_then(|name| results.summary.tally.scenes[at].net_work.get(&name));
    let mut work = vec![NetWork::default(); shape.len() / 3];
    if let Some(sketches) = sketches {
        let medians = sketches.iter().map(|s| s.median()).collect::<Result<Vec<f64>, _>>()?;
        let largest = medians.iter().fold(f64::MIN_POSITIVE, |m, &w| m.max(w.abs()));
        for ((entry, sketch), median) in work.iter_mut().zip(sketches).zip(medians) {
            let quartiles = [sketch.quantile(0.25)? / largest, sketch.quantile(0.75)? / largest];
            *entry = NetWork { median: median / largest, quartiles: Some(quartiles) };
        }
    }
    let body = |(i, work): (usize, NetWork)| BodyInMode {
        displacement: [shape[3 * i], shape[3 * i + 1], shape[3 * i + 2]],
        constrained: [0, 1, 2].map(|axis| map.position(3 * i + axis).is_none()),
        work,
    };
    Ok(work.into_iter().enumerate().map(body).collect())
}
