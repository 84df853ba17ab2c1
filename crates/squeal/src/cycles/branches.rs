//! Cycles over a parameter, from each onset that a sweep finds.

use cea::{QrSolver, Workspace, right_vector};
use cycle::{Balance, ContactSystem, Cycle, Measures, NearMode, Reach, measure};
use montecarlo::Progress;
use num_complex::Complex;
use study::{Study, UncertainBrake};

use super::{CycleOptions, TOLERANCE, checked, contacts_of};
use crate::Error;
use crate::sweep::{ChangeOf, Over, SweptParameter, sweep};

/// Longest step along a branch, in amplitudes of the first kink; chosen: some 20 points between an onset and the end of a range.
const LONGEST_STEP: f64 = 0.3;

/// Most points of a branch; chosen.
const MOST_POINTS: usize = 200;

/// The branch of cycles that starts at an onset.
#[derive(Debug, Clone)]
pub struct Branch {
    /// Name of the mode that begins to grow at the onset.
    pub mode: String,
    /// Value of the parameter at the onset.
    pub onset: f64,
    /// Frequency at the onset, Hz.
    pub onset_hz: f64,
    /// The parameter of the branch.
    pub parameter: SweptParameter,
    /// The cycles, along the branch.
    pub cycles: Vec<BranchCycle>,
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

/// Branches of cycles of a scene over one parameter, from each onset of an oscillating mode in its range.
///
/// # Errors
/// As [`cycles`](super::cycles()) and [`sweep`]; a range without an onset.
pub fn branches<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &Over,
    options: &CycleOptions,
    progress: &dyn Progress,
) -> Result<Vec<Branch>, Error> {
    let brake = study.brake();
    let (contacts, balance, plan) = (contacts_of(brake)?, checked(options)?, brake.plan());
    let key = &plan.scenes[scene];
    let found = sweep(study, scene, over, &QrSolver, progress)?;
    let parameter = found.parameter.clone();
    let of_cea = |at: f64| match brake.parametrised() {
        Some(parametrised) => Ok(parametrised.system_with(key, &[(parameter.place, at)])?),
        None => Err(Error::NotGiven { capability: "parametrised", needed_by: "cycles over a parameter" }),
    };
    let system_at = |at: f64| -> Result<ContactSystem, Error> {
        Ok(contacts.contact_system(key, &[(parameter.place, at)], options.stick)?)
    };
    let bodies: Vec<_> = plan.brake(key).bodies.iter().map(|body| (body.name.clone(), body.dofs.clone())).collect();
    let onsets = found.onsets.iter().filter(|onset| onset.of == ChangeOf::Flutter);
    let mut branches = Vec::new();
    for onset in onsets {
        let of_cea = of_cea(onset.at)?;
        let system = system_at(onset.at)?;
        system.check_tangent(&of_cea, onset.omega)?;
        let lambda = Complex::new(onset.growth, onset.omega);
        let shape = right_vector(&of_cea, lambda, &mut Workspace::default()).map_err(study::Error::from)?;
        let mode: NearMode<'_> = (onset.omega, shape.as_slice());
        let reach = Reach { range: [over.from, over.to], longest_step: LONGEST_STEP, most_points: MOST_POINTS };
        let points = balance.branch_from_onset(&system_at, mode, onset.at, &reach)?;
        let cycle = |point: &cycle::BranchPoint| -> Result<BranchCycle, Error> {
            let at = point.cycle.parameter;
            Ok(BranchCycle {
                at,
                balanced_hz: point.cycle.omega / std::f64::consts::TAU,
                amplitude: point.amplitude,
                is_fold: point.is_fold,
                in_time: in_time(&balance, &system_at(at)?, &point.cycle, mode),
            })
        };
        branches.push(Branch {
            mode: onset.mode.clone(),
            onset: onset.at,
            onset_hz: onset.omega / std::f64::consts::TAU,
            parameter: parameter.clone(),
            cycles: points.iter().map(cycle).collect::<Result<_, Error>>()?,
            bodies: bodies.clone(),
        });
    }
    if branches.is_empty() {
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
