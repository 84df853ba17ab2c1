//! The figures of the motion after the onset: contacts over the period, harmonics, branches over a parameter.

use figures::{
    ContactDoes, ContactPoint, ContactsOfCycle, CycleBranch, CycleBranchesFigure, CycleContactsFigure, CyclePoint,
    CycleSpectrumFigure, Figure, SpectrumOfCycle, cycle_branches_figure, cycle_contacts_figure, cycle_spectrum_figure,
};
use output::hertz;
use squeal::cycle::ContactState;
use squeal::cycles::{Branch, BranchCycle, Branches, Cycles, MotionOfMode};

use super::sweep::locus;
use crate::Error;

/// Contacts that have lines, at most; chosen: by colour and dash nine are told apart.
const MOST_CONTACTS: usize = 9;

/// Cycles that have panels, at most; chosen: more are larger than a page.
const MOST_CYCLES: usize = 5;

/// The figures of the cycles of a scene with the names of their files, `cycle_contacts` and `cycle_spectrum`; none where no motion is a cycle, of a brake
/// without contacts not the first, of cycles of rotations alone not the second. `title` and `note` stand above and below.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn cycle_figures(cycles: &Cycles, title: &str, note: &str) -> Result<Vec<(&'static str, Figure)>, Error> {
    let all: Vec<&MotionOfMode> = cycles.motions.iter().filter(|of| of.harmonics.is_some()).collect();
    let (heard, turning): (Vec<_>, Vec<_>) =
        all.iter().copied().partition(|of: &&MotionOfMode| of.loudness.is_some_and(|loudness| loudness > 0.0));
    let more = |number: usize, what: &str| match number {
        0 => String::new(),
        number => format!("; {number} more {what}"),
    };
    let drawn = &all[..all.len().min(MOST_CYCLES)];
    let chosen = chosen(cycles, drawn);
    let contacts = CycleContactsFigure {
        title: format!("{title}: contacts over the period"),
        contacts: chosen.iter().map(|&contact| cycles.contacts[contact].clone()).collect(),
        cycles: drawn.iter().map(|of| contacts_of(of, &chosen)).collect(),
        note: [
            note,
            &more(cycles.contacts.len() - chosen.len(), "contacts in cycle_contacts.csv"),
            &more(all.len() - drawn.len(), "cycles in cycle_contacts.csv"),
        ]
        .concat(),
    };
    let with_spectrum = &heard[..heard.len().min(MOST_CYCLES)];
    let spectrum = CycleSpectrumFigure {
        title: format!("{title}: harmonics of the velocity"),
        cycles: with_spectrum.iter().map(|of| spectrum_of(of, &cycles.displacements)).collect(),
        note: [
            note,
            &more(heard.len() - with_spectrum.len(), "cycles in cycle_spectrum.csv"),
            &more(turning.len(), "of rotations alone, without loudness, in cycle_spectrum.csv"),
        ]
        .concat(),
    };
    let mut figures = Vec::new();
    if !drawn.is_empty() && !chosen.is_empty() {
        figures.push(("cycle_contacts", cycle_contacts_figure(&contacts)?));
    }
    if !with_spectrum.is_empty() {
        figures.push(("cycle_spectrum", cycle_spectrum_figure(&spectrum)?));
    }
    Ok(figures)
}

/// The contacts that have lines, in their order: those that are open and stuck for longest, of others those whose normal force varies most.
fn chosen(cycles: &Cycles, drawn: &[&MotionOfMode]) -> Vec<usize> {
    let weight = |contact: usize| {
        let moments = || drawn.iter().flat_map(|of| of.history.iter().map(|moments| moments[contact]));
        let kinks = moments().filter(|moment| moment.state != ContactState::Sliding).count();
        let force = |start: f64, of: fn(f64, f64) -> f64| moments().map(|moment| moment.normal_force).fold(start, of);
        (kinks, force(f64::NEG_INFINITY, f64::max) - force(f64::INFINITY, f64::min))
    };
    let mut all: Vec<(usize, (usize, f64))> = (0..cycles.contacts.len()).map(|at| (at, weight(at))).collect();
    all.sort_by(|(_, a), (_, b)| b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)));
    let mut chosen: Vec<usize> = all.into_iter().take(MOST_CONTACTS).map(|(at, _)| at).collect();
    chosen.sort_unstable();
    chosen
}

/// Heading of a cycle.
fn heading(of: &MotionOfMode) -> String {
    let hz = of.harmonics.as_ref().map_or(0.0, |harmonics| harmonics.frequency_hz(1));
    let loudness = of.loudness.unwrap_or_default();
    format!("From {}: a cycle at {} Hz, loudness {loudness:.4} m/s", of.start_in_words(), hertz(hz))
}

fn contacts_of(of: &MotionOfMode, chosen: &[usize]) -> ContactsOfCycle {
    let point = |moments: &Vec<squeal::cycle::ContactMoment>, contact: usize| ContactPoint {
        normal_force: moments[contact].normal_force,
        sliding_velocity: moments[contact].sliding_velocity,
        does: match moments[contact].state {
            ContactState::Sliding => ContactDoes::Slides,
            ContactState::Stuck => ContactDoes::Sticks,
            ContactState::Open => ContactDoes::Open,
        },
    };
    let points = |&contact: &usize| of.history.iter().map(|moments| point(moments, contact)).collect();
    ContactsOfCycle { name: heading(of), contacts: chosen.iter().map(points).collect() }
}

fn spectrum_of(of: &MotionOfMode, displacements: &[usize]) -> SpectrumOfCycle {
    let harmonics = of.harmonics.iter().flat_map(|all| {
        (1..=all.velocity.len()).map(move |order| [all.frequency_hz(order), all.rms_of(order, displacements)])
    });
    SpectrumOfCycle { name: heading(of), mode_hz: of.lambda.im / std::f64::consts::TAU, harmonics: harmonics.collect() }
}

/// The figure of branches of cycles over a parameter, beside the modes; `title` and `note` stand above and below.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn branches_figure(branches: &Branches, title: &str, note: &str) -> Result<Figure, Error> {
    let modes = locus(&branches.sweep, "", "");
    let point = |of: &BranchCycle| {
        let in_time = of.in_time.as_ref().zip(of.loudness);
        CyclePoint {
            at: of.at,
            hz: in_time.as_ref().map_or(of.balanced_hz, |((cycle, _), _)| cycle.frequency_hz()),
            in_time: in_time.map(|((cycle, _), loudness)| (loudness, cycle.is_stable())),
            is_fold: of.is_fold,
        }
    };
    let branch = |of: &Branch| CycleBranch {
        mode: of.mode.clone(),
        onset: [of.onset, of.onset_hz],
        points: of.cycles.iter().map(point).collect(),
    };
    Ok(cycle_branches_figure(&CycleBranchesFigure {
        title: title.into(),
        parameter: modes.parameter,
        range: modes.range,
        is_logarithmic: modes.is_logarithmic,
        branches: branches.branches.iter().map(branch).collect(),
        modes: modes.branches,
        note: note.into(),
    })?)
}
