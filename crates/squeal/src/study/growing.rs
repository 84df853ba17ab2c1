//! What finds the growing modes of a scene without spectra: the secular equations of its lattice, and anchors.

use cea::{Anchors, CeaError, EigenSolver, Feedback, Gain, Secular, Spectrum, Workspace};
use montecarlo::stream;
use osc_model::{ContactPoint, Linearise, PreparedLattice, Sectors, Sliding};
use rayon::prelude::*;

use super::part::{Equation, Known, Solver};
use super::{Certificate, Plan, Sample, Scene};
use crate::Error;

/// Anchors of a scene.
pub const ANCHORS: usize = 16;
/// Draws in which so many are looked for that no certificate covers.
const DRAWS: u64 = 64;

/// The secular equation of each sector of a lattice; `None` where spectra are the better way.
pub(super) type Equations = Vec<Option<Secular>>;

/// The equations of each lattice of a plan.
///
/// # Errors
/// Those of the model and of the solver.
pub(super) fn equations(plan: &Plan) -> Result<Vec<Equations>, Error> {
    let of_lattice = |((_, lattice), sectors): (&(usize, PreparedLattice), &Sectors)| -> Result<Equations, Error> {
        let Some(channels) = lattice.friction_channels() else { return Ok(vec![None; sectors.iter().len()]) };
        let mut work = Workspace::default();
        let mut of_sector = |sector: &osc_model::Sector| {
            let structure = sector.reduced(lattice.structural())?;
            let channels = sector.channels(&channels);
            let feedback = Feedback { force: channels.force, reading: channels.coupling };
            Ok(Secular::new(&structure, &feedback, &mut work)?)
        };
        sectors.iter().map(&mut of_sector).collect()
    };
    plan.lattices.par_iter().zip(&plan.sectors).map(of_lattice).collect()
}

/// The anchors of each sector of each scene of a plan.
///
/// # Errors
/// Those of the model and of the solver.
pub(super) fn anchors(
    plan: &Plan,
    equations: &[Equations],
    certificates: &[Certificate],
    solver: &dyn EigenSolver,
) -> Result<Vec<Vec<Option<Anchors>>>, Error> {
    let of_scene = |scene: &Scene| {
        let (lattice, sectors) = (plan.lattice(scene), &plan.sectors[scene.lattice]);
        let certificate = &certificates[scene.lattice];
        let state =
            |index| plan.sliding(scene, &Sample::draw(&plan.case, &mut stream(plan.case.seed, index)).ok()?).ok();
        let states = (0..DRAWS).filter_map(state).filter(|state| !certificate.covers(state));
        let states: Vec<(Sliding, Gain)> =
            states.filter_map(|state| gain(&state).map(|gain| (state, gain))).take(ANCHORS).collect();
        let wholes = states.iter().map(|(state, _)| lattice.linearised(state)).collect::<Result<Vec<_>, _>>()?;
        let mut work = Workspace::default();
        let of_sector = |(sector, equation): (&osc_model::Sector, &Option<Secular>)| {
            let Some(equation) = equation else { return Ok(None) };
            let systems = wholes.iter().map(|whole| sector.reduced(whole)).collect::<Result<Vec<_>, _>>()?;
            let mut spectra: Vec<Result<Spectrum, CeaError>> = Vec::new();
            solver.eigenvalues_of_all(&systems, &mut work, &mut spectra);
            let known = states.iter().zip(spectra).filter_map(|((_, gain), spectrum)| Some((*gain, spectrum.ok()?)));
            Ok(Some(equation.anchors(&known.collect::<Vec<_>>(), &mut work)))
        };
        sectors.iter().zip(&equations[scene.lattice]).map(of_sector).collect()
    };
    plan.scenes.par_iter().map(of_scene).collect()
}

/// Friction as the secular equation sees it; `None` where the contacts are not alike.
pub fn gain(state: &Sliding) -> Option<Gain> {
    let (first, others) = state.contacts.split_first()?;
    let is_like = |other: &ContactPoint| other == first;
    if first.stiffness_factor != 1.0 || !others.iter().all(is_like) {
        return None;
    }
    let (load, tangent) = (first.normal_load, first.tangent);
    let lag = tangent.internal.map_or(0.0, |state| load * state.force * state.drive);
    let decay = tangent.internal.map_or(0.0, |state| state.decay);
    Some(Gain { mu: tangent.mu, velocity: load * tangent.slope, lag, decay })
}

/// The modes of each state that grow, sector by sector; `None` in all sectors of a state that is left to spectra.
///
/// The bounds of other modes leave their order open only among themselves.
pub(super) fn growing(sectors: &[Solver<'_>], states: &[Sliding], work: &mut Workspace) -> Vec<Vec<Known>> {
    let Some(gains) = states.iter().map(gain).collect::<Option<Vec<Gain>>>() else {
        return vec![vec![None; states.len()]; sectors.len()];
    };
    let all: Vec<(Gain, &[f64])> = gains.iter().map(|&gain| (gain, &[][..])).collect();
    let mut found: Vec<Vec<Known>> = sectors.iter().map(|sector| search(sector, &all, work)).collect();
    let growing = |at: usize| -> Vec<f64> {
        found.iter().filter_map(|of_sector| of_sector[at].as_ref()).flat_map(|(_, found)| found.frequencies()).collect()
    };
    let frequencies: Vec<Vec<f64>> = (0..states.len()).map(growing).collect();
    for (sector, found) in sectors.iter().zip(&mut found) {
        let is_open =
            |&at: &usize| found[at].as_ref().is_some_and(|(_, found)| found.leaves_order_open(&frequencies[at]));
        let open: Vec<usize> = (0..states.len()).filter(is_open).collect();
        let again: Vec<(Gain, &[f64])> = open.iter().map(|&at| (gains[at], &frequencies[at][..])).collect();
        for (at, again) in open.into_iter().zip(search(sector, &again, work)) {
            found[at] = again;
        }
    }
    for at in 0..states.len() {
        if found.iter().any(|of_sector| of_sector[at].is_none()) {
            found.iter_mut().for_each(|of_sector| of_sector[at] = None);
        }
    }
    found
}

fn search(sector: &Solver<'_>, gains: &[(Gain, &[f64])], work: &mut Workspace) -> Vec<Known> {
    let Some(Equation { secular, anchors, .. }) = sector.equation else { return vec![None; gains.len()] };
    let found = secular.growing(anchors, gains, work);
    gains.iter().zip(found).map(|(&(gain, _), found)| Some((gain, found?))).collect()
}
