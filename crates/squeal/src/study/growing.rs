//! What finds the growing modes of a scene without spectra: the secular equations of its configuration, and anchors.

use cea::{Anchors, CeaError, EigenSolver, Feedback, Gain, Secular, Spectrum, Workspace};
use linsys::{ChannelGain, OperatingPoint};
use montecarlo::stream;
use osc_model::Sector;
use rayon::prelude::*;

use super::part::{Equation, Known, Solver};
use super::{Certificate, Configuration, Scene, UncertainBrake};
use crate::Error;

/// Anchors of a scene.
pub const ANCHORS: usize = 16;
/// Draws in which so many are looked for that no certificate covers.
const DRAWS: u64 = 64;

/// The secular equation of each sector of a configuration; `None` where spectra are the better way.
#[derive(Debug)]
pub(super) struct Equations {
    /// The coefficients of the terms, of the structure that the equations are of.
    coefficients: Vec<f64>,
    /// One for each sector.
    pub sectors: Vec<Option<Secular>>,
}

impl Equations {
    /// The equations of a configuration, for operating points with the coefficients of its naming point.
    ///
    /// # Errors
    /// Those of the model and of the solver.
    fn new(configuration: &Configuration) -> Result<Self, Error> {
        let Configuration { brake, naming_point, .. } = configuration;
        let coefficients = naming_point.coefficients.clone();
        let structure = brake.system.structure(&coefficients)?;
        let mut work = Workspace::default();
        let mut of_sector = |sector: &Sector| {
            let [force, reading] = sector.channels(&brake.system);
            Ok(Secular::new(&sector.reduced(&structure)?, &Feedback { force, reading }, &mut work)?)
        };
        let sectors = brake.sectors.iter().map(&mut of_sector).collect::<Result<_, Error>>()?;
        Ok(Self { coefficients, sectors })
    }

    /// An operating point as these equations see it; `None` where channels are not alike or the structure is another one.
    pub fn gain(&self, at: &OperatingPoint) -> Option<Gain> {
        if at.coefficients == self.coefficients { common_gain(&at.channels) } else { None }
    }
}

/// The equations of each configuration of a plan.
///
/// # Errors
/// Those of the model and of the solver.
pub(super) fn equations(configurations: &[Configuration]) -> Result<Vec<Equations>, Error> {
    configurations.par_iter().map(Equations::new).collect()
}

/// The anchors of each sector of each scene.
///
/// # Errors
/// Those of the model and of the solver.
pub(super) fn anchors<B: UncertainBrake>(
    brake: &B,
    equations: &[Equations],
    certificates: &[Certificate],
    solver: &dyn EigenSolver,
) -> Result<Vec<Vec<Option<Anchors>>>, Error> {
    let plan = brake.plan();
    let of_scene = |scene: &Scene| {
        let (of_scene, equations) = (plan.brake(scene), &equations[scene.configuration]);
        let certificate = &certificates[scene.configuration];
        let point = |index| brake.operating_point(scene, &brake.draw(&mut stream(plan.seed, index)).ok()?).ok();
        let points = (0..DRAWS).filter_map(point).filter(|at| !certificate.covers(at));
        let points: Vec<(OperatingPoint, Gain)> =
            points.filter_map(|at| equations.gain(&at).map(|gain| (at, gain))).take(ANCHORS).collect();
        let wholes = points.iter().map(|(at, _)| of_scene.system.assemble(at)).collect::<Result<Vec<_>, _>>()?;
        let mut work = Workspace::default();
        let of_sector = |(sector, equation): (&Sector, &Option<Secular>)| {
            let Some(equation) = equation else { return Ok(None) };
            let systems = wholes.iter().map(|whole| sector.reduced(whole)).collect::<Result<Vec<_>, _>>()?;
            let mut spectra: Vec<Result<Spectrum, CeaError>> = Vec::new();
            solver.eigenvalues_of_all(&systems, &mut work, &mut spectra);
            let known = points.iter().zip(spectra).filter_map(|((_, gain), spectrum)| Some((*gain, spectrum.ok()?)));
            Ok(Some(equation.anchors(&known.collect::<Vec<_>>(), &mut work)))
        };
        of_scene.sectors.iter().zip(&equations.sectors).map(of_sector).collect()
    };
    plan.scenes.par_iter().map(of_scene).collect()
}

/// Friction that is alike in all channels as one gain; `None` where it is not, and where there is no channel.
pub fn common_gain(channels: &[ChannelGain]) -> Option<Gain> {
    let (first, others) = channels.split_first()?;
    if others.iter().any(|other| other != first) {
        return None;
    }
    let (lag, decay) = first.lag.map_or((0.0, 0.0), |lag| (lag.force * lag.drive, lag.decay));
    Some(Gain { mu: first.mu, velocity: first.slope, lag, decay })
}

/// The modes that grow at each operating point, sector by sector; `None` in all sectors of a point that is left to spectra.
///
/// The bounds of other modes leave their order open only among themselves.
pub(super) fn growing(
    equations: &Equations,
    sectors: &[Solver<'_>],
    points: &[OperatingPoint],
    work: &mut Workspace,
) -> Vec<Vec<Known>> {
    let Some(gains) = points.iter().map(|at| equations.gain(at)).collect::<Option<Vec<Gain>>>() else {
        return vec![vec![None; points.len()]; sectors.len()];
    };
    let all: Vec<(Gain, &[f64])> = gains.iter().map(|&gain| (gain, &[][..])).collect();
    let mut found: Vec<Vec<Known>> = sectors.iter().map(|sector| search(sector, &all, work)).collect();
    let growing = |at: usize| -> Vec<f64> {
        found.iter().filter_map(|of_sector| of_sector[at].as_ref()).flat_map(|(_, found)| found.frequencies()).collect()
    };
    let frequencies: Vec<Vec<f64>> = (0..points.len()).map(growing).collect();
    for (sector, found) in sectors.iter().zip(&mut found) {
        let is_open =
            |&at: &usize| found[at].as_ref().is_some_and(|(_, found)| found.leaves_order_open(&frequencies[at]));
        let open: Vec<usize> = (0..points.len()).filter(is_open).collect();
        let again: Vec<(Gain, &[f64])> = open.iter().map(|&at| (gains[at], &frequencies[at][..])).collect();
        for (at, again) in open.into_iter().zip(search(sector, &again, work)) {
            found[at] = again;
        }
    }
    for at in 0..points.len() {
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
