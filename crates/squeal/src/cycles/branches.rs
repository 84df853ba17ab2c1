//! Cycles over a parameter, from each onset that a sweep finds.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use cea::{QrSolver, Workspace, right_vector};
use cycle::{Balance, BranchEnd, ContactSystem, Cycle, Measures, NearMode, Reach, measure};
use montecarlo::Progress;
use num_complex::Complex;
use study::{Study, UncertainBrake};

use super::{CycleOptions, TOLERANCE, checked, contacts_of, in_si, stopped};
use crate::Error;
use crate::sweep::{ChangeOf, Over, SweepOnset, SweptParameter, sweep};

/// Longest step along a branch, in amplitudes of the first kink; chosen: some 20 points between an onset and the end of a range.
const LONGEST_STEP: f64 = 0.3;

/// Most points of a branch; chosen.
const MOST_POINTS: usize = 200;

/// Branches of cycles over a parameter, and what may be missing among them.
#[derive(Debug, Clone)]
pub struct Branches {
    /// The parameter.
    pub parameter: SweptParameter,
    /// The branches, by their onsets.
    pub branches: Vec<Branch>,
    /// Number of modes that oscillate and grow at the begin of the range already: their branches start outside.
    pub growing_at_start: usize,
    /// Ranges of the parameter in which a mode comes so near its threshold that it may have an onset or not.
    pub unresolved: Vec<(f64, f64)>,
}

/// The branch of cycles that starts at an onset.
#[derive(Debug, Clone)]
pub struct Branch {
    /// Name of the mode that begins to grow at the onset.
    pub mode: String,
    /// Value of the parameter at the onset.
    pub onset: f64,
    /// Frequency at the onset, Hz.
    pub onset_hz: f64,
    /// The cycles, along the branch.
    pub cycles: Vec<BranchCycle>,
    /// Why it ends.
    pub end: BranchEnd,
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
}

/// Branches of cycles of a scene over one parameter, from each onset of an oscillating mode in its range. The progress of the sweep counts its
/// parts, that of the cycles two for each branch: its balance, and its motions in time.
///
/// # Errors
/// As [`cycles`](super::cycles()) and [`sweep`](fn@sweep); a range without an onset.
pub fn branches<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &Over,
    options: &CycleOptions,
    [of_sweep, progress]: [&dyn Progress; 2],
) -> Result<Branches, Error> {
    let brake = study.brake();
    let (contacts, balance, plan) = (contacts_of(brake)?, checked(options)?, brake.plan());
    let key = &plan.scenes[scene];
    let found = sweep(study, scene, over, &QrSolver, of_sweep)?;
    let parameter = found.parameter;
    let of_cea = |at: f64| match brake.parametrised() {
        Some(parametrised) => Ok(parametrised.system_with(key, &[(parameter.place, at)])?),
        None => Err(Error::NotGiven { capability: "parametrised", needed_by: "cycles over a parameter" }),
    };
    let bodies: Vec<_> = plan.brake(key).bodies.iter().map(|body| (body.name.clone(), body.dofs.clone())).collect();
    // A mode that jumps over the threshold at an opening has no motion of small amplitude there.
    let onsets: Vec<_> =
        found.onsets.iter().filter(|onset| onset.of == ChangeOf::Flutter && onset.jump.is_none()).collect();
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
        let (points, end) = balance.branch_from_onset(&system_at, mode, onset.at, &reach)?;
        let cycle = |point: &cycle::BranchPoint| -> Result<BranchCycle, Error> {
            let at = point.cycle.parameter;
            Ok(BranchCycle {
                at,
                balanced_hz: point.cycle.omega / std::f64::consts::TAU,
                amplitude: point.amplitude,
                is_fold: point.is_fold,
                in_time: in_time(&balance, &system_at(at)?, &point.cycle, mode)
                    .map(|(cycle, measures)| (cycle, in_si(measures, plan.units))),
            })
        };
        progress.advance(1);
        let cycles = points.iter().map(cycle).collect::<Result<_, Error>>()?;
        progress.advance(1);
        Ok(Branch {
            mode: onset.mode.clone(),
            onset: onset.at,
            onset_hz: onset.omega / std::f64::consts::TAU,
            cycles,
            end,
            bodies: bodies.clone(),
        })
    };
    // Each is followed in harmonic balance, and then its points in time.
    progress.begin(2 * onsets.len() as u64, 0);
    let branches = stopped::when_cancelled(progress, |stop| {
        onsets.into_iter().map(|onset| branch(onset, &stop)).collect::<Result<Vec<_>, _>>()
    });
    progress.end();
    let branches = branches?;
    let growing_at_start = found.unstable_at_start - found.diverging_at_start;
    if branches.is_empty() && (growing_at_start > 0 || !found.unresolved.is_empty()) {
        let near = |(from, to): &(f64, f64)| format!("; from {from} to {to} one may be, or not");
        let unresolved: String = found.unresolved.iter().map(near).collect();
        let allowed = format!(
            "a range with an onset in it; modes that grow at its begin already: {growing_at_start}{unresolved}"
        );
        return Err(Error::Argument { argument: "over", value: over.to_string(), allowed });
    }
    if branches.is_empty() {
        return Err(Error::NeverSqueals { scene: format!("{} over {over}", plan.describe(key)) });
    }
    Ok(Branches { parameter, branches, growing_at_start, unresolved: found.unresolved })
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
