//! Cycles over a parameter, from each onset that a sweep finds.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use cea::{EigenSolver as _, QrSolver, Workspace, right_vector};
use cycle::{
    Balance, BranchEnd, BranchPoint, ContactSystem, Cycle, Harmonics, Measures, NearMode, Reach, measure, states,
};
use montecarlo::Progress;
use num_complex::Complex;
use rayon::prelude::*;
use study::{Study, UncertainBrake};

use super::{
    CycleOptions, STEPS, TOLERANCE, checked, contacts_of, displacements, grows_in_band, harmonics_in_si, in_si,
    open_kept, when_cancelled,
};
use crate::Error;
use crate::kept::Question;
use sweep::{ChangeOf, Over, Sweep, SweepOnset, sweep};

/// Longest step along a branch, in amplitudes of the first kink; chosen: some 20 points between an onset and the end of a range.
const LONGEST_STEP: f64 = 0.3;

/// Most points of a branch; chosen.
const MOST_POINTS: usize = 200;

/// Branches of cycles over a parameter, and what may be missing among them.
#[derive(Debug, Clone)]
pub struct Branches {
    /// The sweep that found the onsets, with the modes over the parameter.
    pub sweep: Sweep,
    /// The branches, by their onsets.
    pub branches: Vec<Branch>,
}

impl Branches {
    /// Number of modes that oscillate and grow at the begin of the range already: their branches start outside.
    #[must_use]
    pub fn growing_at_start(&self) -> usize {
        self.sweep.unstable_at_start - self.sweep.diverging_at_start
    }
}

/// The branch of cycles that starts at an onset.
#[derive(Debug, Clone)]
pub struct Branch {
    /// Name of the mode that begins or ceases to grow at the onset.
    pub mode: String,
    /// Value of the parameter at the onset.
    pub onset: f64,
    /// Frequency at the onset, Hz.
    pub onset_hz: f64,
    /// True if the mode grows where the parameter is larger than at the onset, false if it does where that is smaller.
    pub starts: bool,
    /// The cycles, along the branch.
    pub cycles: Vec<BranchCycle>,
    /// Why it ends.
    pub end: BranchEnd,
    /// The last of the cycles whose motion in time is stable, and the last of those whose motion is known, by their places among them, with their
    /// harmonics, m and m/s; one where they are the same.
    pub last: Vec<(usize, Harmonics)>,
    /// Bodies, with their degrees of freedom.
    pub(crate) bodies: Vec<(String, Vec<usize>)>,
}

/// A cycle of a branch.
#[derive(Debug, Clone)]
pub struct BranchCycle {
    /// Value of the parameter.
    pub at: f64,
    /// Frequency of the harmonic balance, Hz.
    pub balanced_hz: f64,
    /// Amplitude of the first harmonic, in that at which the first contact opens or sticks in the mode.
    pub amplitude: f64,
    /// True if the parameter turns between the cycle before and this one.
    pub is_fold: bool,
    /// The motion in time with its multipliers, and its measures; `None` where shooting from the balance does not find it.
    pub in_time: Option<(Cycle, Measures)>,
    /// Loudness of the motion in time, m/s.
    pub loudness: Option<f64>,
}

/// Branches of cycles of a scene over one parameter, from each onset of an oscillating mode in its range. The progress of the sweep counts its
/// parts, that of the cycles two for each branch: its balance, and its motions in time. These are kept in the file `kept`, as [`cycles`](super::cycles()) does it.
///
/// # Errors
/// As [`cycles`](super::cycles()) and [`sweep`](fn@sweep); a range without an onset; a reduced brake that grows outside its band at an onset or at a point of a
/// branch.
pub fn branches<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &Over,
    options: &CycleOptions,
    kept: Option<&Path>,
    [of_sweep, progress]: [&dyn Progress; 2],
) -> Result<Branches, Error> {
    let brake = study.brake();
    let (contacts, balance, plan) = (contacts_of(brake)?, checked(options)?, brake.plan());
    let key = &plan.scenes[scene];
    let kept = open_kept(kept, brake, key, options, over)?;
    let found = sweep(study, scene, over, &QrSolver, of_sweep)?;
    let parameter = &found.parameter;
    let of_cea = |at: f64| match brake.parametrised() {
        Some(parametrised) => Ok(parametrised.system_with(key, &[(parameter.place, at)])?),
        None => Err(Error::NotGiven { capability: "parametrised", needed_by: "cycles over a parameter" }),
    };
    let displacements = displacements(plan, plan.brake(key));
    let bodies: Vec<_> = plan.brake(key).bodies.iter().map(|body| (body.name.clone(), body.dofs.clone())).collect();
    // A mode that jumps over the threshold at an opening has no motion of small amplitude there.
    let onsets: Vec<_> =
        found.onsets.iter().filter(|onset| onset.of == ChangeOf::Flutter && onset.jump.is_none()).collect();
    // A motion in time has all of the spectrum of a reduced brake.
    let check_band = |at: f64| -> Result<(), Error> {
        if brake.mode_source().is_none() {
            return Ok(());
        }
        let spectrum = QrSolver.eigenvalues(&of_cea(at)?, &mut Workspace::default()).map_err(study::Error::from)?;
        let with_value = |error| match error {
            Error::GrowsOutside { scene, hz, growth } => {
                Error::GrowsOutside { scene: format!("{scene}, {} = {at}", parameter.name), hz, growth }
            }
            other => other,
        };
        grows_in_band(plan, key, brake.error_of_reduction(key), &spectrum.eigenvalues).map_err(with_value)
    };
    onsets.iter().try_for_each(|onset| check_band(onset.at))?;
    let branch = |onset: &SweepOnset, stop: &Arc<AtomicBool>| -> Result<Branch, Error> {
        let system_at = |at: f64| -> Result<ContactSystem, Error> {
            Ok(contacts.contact_system(key, &[(parameter.place, at)], options.stick)?.until(Arc::clone(stop)))
        };
        let of_cea = of_cea(onset.at)?;
        let system = system_at(onset.at)?;
        system.check_tangent(&of_cea, onset.omega)?;
        let lambda = Complex::new(onset.growth, onset.omega);
        let shape = right_vector(&of_cea, lambda, &mut Workspace::default()).map_err(study::Error::from)?;
        let mode: NearMode<'_> = (onset.omega, shape.as_slice());
        let reach = Reach { range: [over.from, over.to], longest_step: LONGEST_STEP, most_points: MOST_POINTS };
        let (points, end) = kept.answer(Question::Balances, &[onset.at, onset.growth, onset.omega], || {
            let found: (Vec<BranchPoint>, BranchEnd) = balance.branch_from_onset(&system_at, mode, onset.at, &reach)?;
            // What was stopped may look as if it had failed by itself.
            progress.go_on()?;
            Ok(found)
        })?;
        let cycle = |point: &BranchPoint| -> Result<BranchCycle, Error> {
            let at = point.cycle.parameter;
            check_band(at)?;
            let asked = [point.cycle.series.as_slice(), &[point.cycle.omega, at]].concat();
            let in_time = kept.answer(Question::InTime, &asked, || {
                let found = in_time(&balance, &system_at(at)?, &point.cycle, mode);
                progress.go_on()?;
                Ok(found.map(|(cycle, measures)| (cycle, in_si(measures, plan.units))))
            })?;
            Ok(BranchCycle {
                at,
                balanced_hz: point.cycle.omega / std::f64::consts::TAU,
                amplitude: point.amplitude,
                is_fold: point.is_fold,
                loudness: in_time.as_ref().map(|(_, measures)| measures.rms_of(&displacements)),
                in_time,
            })
        };
        progress.advance(1);
        let cycles = points.par_iter().map(cycle).collect::<Result<Vec<_>, Error>>()?;
        let is_stable = |of: &BranchCycle| of.in_time.as_ref().is_some_and(|(cycle, _)| cycle.is_stable());
        let is_known = |of: &BranchCycle| of.in_time.is_some();
        let mut last: Vec<usize> =
            [cycles.iter().rposition(is_stable), cycles.iter().rposition(is_known)].into_iter().flatten().collect();
        last.dedup();
        let harmonics = |place: usize| -> Result<Option<(usize, Harmonics)>, Error> {
            let BranchCycle { at, in_time: Some((cycle, measures)), .. } = &cycles[place] else { return Ok(None) };
            let of_plan = (plan.units, &displacements[..]);
            let states = states(&system_at(*at)?, cycle, STEPS, TOLERANCE)?;
            Ok(Some((place, harmonics_in_si(cycle, &states, measures, of_plan))))
        };
        let last = last.into_iter().filter_map(|place| harmonics(place).transpose()).collect::<Result<_, _>>()?;
        progress.advance(1);
        Ok(Branch {
            mode: onset.mode.clone(),
            onset: onset.at,
            onset_hz: onset.omega / std::f64::consts::TAU,
            starts: onset.starts,
            cycles,
            end,
            last,
            bodies: bodies.clone(),
        })
    };
    // Each is followed in harmonic balance, and then its points in time.
    progress.begin(2 * onsets.len() as u64, 0);
    let branches = when_cancelled(progress, |stop| {
        onsets.into_par_iter().map(|onset| branch(onset, &stop)).collect::<Result<Vec<_>, _>>()
    });
    progress.end();
    let branches = branches?;
    let branches = Branches { sweep: found, branches };
    let (growing_at_start, unresolved) = (branches.growing_at_start(), &branches.sweep.unresolved);
    let jumps = branches.sweep.onsets.iter().filter(|onset| onset.jump.is_some()).count();
    if branches.branches.is_empty() && (growing_at_start > 0 || jumps > 0 || !unresolved.is_empty()) {
        let near = |(from, to): &(f64, f64)| format!("; from {from} to {to} one may be, or not");
        let unresolved: String = unresolved.iter().map(near).collect();
        let jumps = if jumps > 0 {
            format!("; onsets at which growth jumps as a contact opens: {jumps}")
        } else {
            String::new()
        };
        let allowed = format!(
            "a range with an onset in it; modes that grow at its begin already: {growing_at_start}{jumps}{unresolved}"
        );
        return Err(Error::Argument { argument: "over", value: over.to_string(), allowed });
    }
    if branches.branches.is_empty() {
        return Err(Error::NeverSqueals { scene: format!("{} over {over}", plan.describe(key)) });
    }
    Ok(branches)
}

/// The motion in time that a balanced cycle stands for, where shooting finds it.
fn in_time(
    balance: &Balance,
    system: &ContactSystem,
    point: &cycle::BalancedCycle,
    mode: NearMode<'_>,
) -> Option<(Cycle, Measures)> {
    let cycle = balance.refined(system, point, mode, TOLERANCE).ok()?;
    let measures = measure(system, &cycle, TOLERANCE).ok()?;
    Some((cycle, measures))
}
