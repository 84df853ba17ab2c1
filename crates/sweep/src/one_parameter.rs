//! A sweep over one parameter: branches with names, onsets, coalescences.

use cea::EigenSolver;
use montecarlo::Progress;
use rayon::prelude::*;
use study::{Study, UncertainBrake};

use super::counting_solver::CountingSolver;
use super::family::{Family, Part};
use super::openings::{OPENING_STEPS, openings};
use super::parameter::Over;
use super::part_sweep::{Entry, STEPS_OF_PART, of_part};
use super::pieces::piecewise;
use super::results::{Miscount, Sweep};
use crate::Error;

/// Number of equal steps of the range at whose ends the unstable modes of a brake with loss factors are counted; chosen: as many as for the largest brakes.
const LOSS_STEPS: usize = 64;

/// Sweeps one parameter of a scene of a study. Only modes that oscillate have branches: one that becomes overdamped, or diverges, ends.
///
/// # Errors
/// A parameter or range that the scene does not have, a value that the brake refuses, and errors of `tracking::root_locus`.
pub fn sweep<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &Over,
    solver: &dyn EigenSolver,
    progress: &dyn Progress,
) -> Result<Sweep, Error> {
    let family = Family::new(study, scene, std::slice::from_ref(over), solver, progress)?;
    let parameter = family.parameters[0].clone();
    let in_words = |source: Error| source.in_sweep(study.plan(), || format!("sweep over {over}"));
    let median = parameter.part(parameter.median);
    let opened = match family.contact_points()[..] {
        [] => Vec::new(),
        _ => {
            let (closed, value) = (|at: f64| family.closed_points(&[parameter.at(at)]), |at: f64| parameter.at(at));
            openings(&closed, &value, [median.min(0.0), median.max(1.0)]).map_err(in_words)?
        }
    };
    let (mut sweep, parts) = if opened.is_empty() {
        let parts = family.parts()?;
        progress.begin(parts.len() as u64 * STEPS_OF_PART, 0);
        let swept = |part: &Part<'_, B>| Ok(of_part(part, &parameter, &Entry::Medians)?.sweep);
        let found = parts.par_iter().map(swept).collect::<Result<Vec<_>, Error>>();
        progress.end();
        let empty = Sweep::empty(parameter, study.plan().threshold);
        (found.map_err(in_words)?.into_iter().fold(empty, Sweep::joined), parts.len())
    } else {
        let counting = CountingSolver::new(solver);
        let family = family.with_solver(&counting);
        let mut sweep = piecewise(&family, &opened).map_err(in_words)?;
        sweep.evaluations.spectra = counting.asked();
        (sweep, 1)
    };
    sweep.opening_steps = (!family.contact_points().is_empty()).then_some(OPENING_STEPS);
    sweep.onsets.sort_by(|a, b| a.at.total_cmp(&b.at));
    sweep.ambiguities.sort_by(|a, b| a.from.total_cmp(&b.from));
    sweep.coalescences.sort_by(|a, b| a.at.total_cmp(&b.at));
    sweep.unresolved.sort_by(|a, b| a.0.total_cmp(&b.0));
    sweep.marginal.sort_by(|a, b| a.from.total_cmp(&b.from));
    let with_losses = |step: usize| {
        let at = step as f64 / LOSS_STEPS as f64;
        let counted = family.unstable_with_losses(at).map_err(in_words).transpose()?;
        Some(counted.map(|count| (sweep.parameter.at(at), count)))
    };
    let counts = (0..=LOSS_STEPS).into_par_iter().filter_map(with_losses).collect::<Result<Vec<_>, Error>>()?;
    match counts.is_empty() {
        true => sweep.compare(sweep.parameter.to, sweep.unstable_at_end),
        false => sweep.compare_with_losses(&counts),
    }
    let mut unstable = sweep.unstable_at_start as i64;
    for onset in &mut sweep.onsets {
        let here = |miscount: &&Miscount| miscount.at <= onset.at;
        let missed = sweep.miscounts.iter().filter(here).map(|it| it.by_spectrum as i64 - it.by_onsets).sum::<i64>();
        unstable += onset.by();
        onset.unstable = (unstable + missed).max(0) as usize;
    }
    sweep.fine_grid = ((1.0 / sweep.shortest_step).ceil() as u64 + 1) * parts as u64;
    Ok(sweep)
}
