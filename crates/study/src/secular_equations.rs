//! The search of the growing modes of a scene without spectra: the secular equations of its configuration, started at anchors.

use cea::{Anchors, CeaError, EigenSolver, Feedback, Gain, Growing, Secular, Spectrum, Workspace};
use linsys::{ChannelGain, OperatingPoint};
use montecarlo::{Progress, stream};
use osc_model::Sector;
use rayon::prelude::*;

use super::reference::bounded_workspace;
use super::sector_modes::{SectorEquation, SectorSolver, SecularAnswer};
use super::{Certificate, Configuration, Scene, UncertainBrake};
use crate::Error;

/// Number of anchors of a scene, states whose spectra are computed beforehand. Chosen: more anchors start nearer to a sample,
/// and each costs one spectrum per scene.
pub const ANCHORS_PER_SCENE: usize = 16;
/// Draws among which that many anchors are looked for; a draw whose stability is certified needs none. Chosen: four draws for
/// each anchor.
const MOST_DRAWS_FOR_ANCHORS: u64 = 64;

/// The secular equation of each sector of a configuration; `None` where spectra are computed instead, see [`Secular::new`].
#[derive(Debug)]
pub(super) struct SecularEquations {
    /// The coefficient of each term; the equations hold for this structure alone.
    coefficients: Vec<f64>,
    /// Equation of each sector.
    pub sectors: Vec<Option<Secular>>,
}

impl SecularEquations {
    /// No equation in any sector: for a brake that finds its modes itself.
    pub fn none(configuration: &Configuration) -> Self {
        let sectors = configuration.brake.sectors.iter().map(|_| None).collect();
        Self { coefficients: configuration.naming_point.coefficients.clone(), sectors }
    }

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
            Ok(Secular::new(&sector.reduced(&structure)?, &Feedback { force, reading }, &mut work)?.ok())
        };
        let sectors = brake.sectors.iter().map(&mut of_sector).collect::<Result<_, Error>>()?;
        Ok(Self { coefficients, sectors })
    }

    /// The gain of an operating point; `None` where its channels differ, where it has none, and where its terms have other coefficients.
    pub fn gain(&self, at: &OperatingPoint) -> Option<Gain> {
        if at.coefficients == self.coefficients { common_gain(&at.channels) } else { None }
    }
}

/// The equations of each configuration of a plan.
///
/// # Errors
/// Those of the model and of the solver.
pub(super) fn equations(
    configurations: &[Configuration],
    progress: &dyn Progress,
) -> Result<Vec<SecularEquations>, Error> {
    let of_configuration = |configuration| {
        progress.go_on()?;
        SecularEquations::new(configuration)
    };
    configurations.par_iter().map(of_configuration).collect()
}

/// The anchors of each sector of each scene. Progress advances by one for each scene.
///
/// # Errors
/// Those of the model and of the solver.
pub(super) fn anchors<B: UncertainBrake>(
    brake: &B,
    equations: &[SecularEquations],
    certificates: &[Certificate],
    solver: &dyn EigenSolver,
    progress: &dyn Progress,
) -> Result<Vec<Vec<Option<Anchors>>>, Error> {
    let of_scene = |scene: &Scene| {
        let (equations, certificate) = (&equations[scene.configuration], &certificates[scene.configuration]);
        progress.go_on()?;
        let found = anchors_of_scene(brake, scene, equations, certificate, solver);
        progress.advance(1);
        found
    };
    brake.plan().scenes.par_iter().map(of_scene).collect()
}

/// The anchors of each sector of one scene: the first draws with a common gain that the certificate does not cover.
fn anchors_of_scene<B: UncertainBrake>(
    brake: &B,
    scene: &Scene,
    equations: &SecularEquations,
    certificate: &Certificate,
    solver: &dyn EigenSolver,
) -> Result<Vec<Option<Anchors>>, Error> {
    if equations.sectors.iter().all(Option::is_none) {
        return Ok(vec![None; equations.sectors.len()]);
    }
    let (plan, model) = (brake.plan(), brake.plan().brake(scene));
    let (mut systems, mut gains) = (Vec::new(), Vec::new());
    for index in 0..MOST_DRAWS_FOR_ANCHORS {
        let point = brake.draw(&mut stream(plan.seed, index)).and_then(|sample| brake.operating_point(scene, &sample));
        let Some(point) = point.ok().filter(|at| !certificate.covers(at)) else { continue };
        if let Some(gain) = equations.gain(&point) {
            systems.push(model.system.assemble(&point)?);
            gains.push(gain);
        }
        if gains.len() == ANCHORS_PER_SCENE {
            break;
        }
    }
    let mut work = bounded_workspace(model.system.order());
    let mut of_sectors = Vec::with_capacity(equations.sectors.len());
    for (sector, equation) in model.sectors.iter().zip(&equations.sectors) {
        let Some(equation) = equation else {
            of_sectors.push(None);
            continue;
        };
        let reduced = systems.iter().map(|system| sector.reduced(system)).collect::<Result<Vec<_>, _>>()?;
        let mut spectra: Vec<Result<Spectrum, CeaError>> = Vec::new();
        solver.eigenvalues_of_all(&reduced, &mut work, &mut spectra);
        let known: Vec<(Gain, Spectrum)> =
            gains.iter().zip(spectra).filter_map(|(gain, spectrum)| Some((*gain, spectrum.ok()?))).collect();
        of_sectors.push(Some(equation.anchors(&known, &mut work)));
    }
    Ok(of_sectors)
}

/// The friction that all channels have in common, as one gain; `None` where they differ, and where there is no channel.
pub fn common_gain(channels: &[ChannelGain]) -> Option<Gain> {
    let (first, others) = channels.split_first()?;
    if others.iter().any(|other| other != first) {
        return None;
    }
    let (lag, decay) = first.lag.map_or((0.0, 0.0), |lag| (lag.force * lag.drive, lag.decay));
    Some(Gain { mu: first.mu, slope: first.slope, lag, decay })
}

/// The growing modes at each operating point, by sector; `None` in all sectors of a point that needs spectra. All points do where one of them has no gain
/// ([`SecularEquations::gain`]).
///
/// A growing mode has a rank only if the frequencies of all other modes, of any sector, are bounded away from its own. Where
/// the bounds of a sector do not say so, the sector is searched once more with the frequencies to keep off.
pub(super) fn growing_modes(
    equations: &SecularEquations,
    sectors: &[SectorSolver<'_>],
    points: &[OperatingPoint],
    work: &mut Workspace,
) -> Vec<Vec<SecularAnswer>> {
    let Some(gains) = points.iter().map(|at| equations.gain(at)).collect::<Option<Vec<Gain>>>() else {
        return vec![vec![None; points.len()]; sectors.len()];
    };
    let all: Vec<(Gain, &[f64])> = gains.iter().map(|&gain| (gain, &[][..])).collect();
    let mut found: Vec<Vec<SecularAnswer>> = sectors.iter().map(|sector| search_sector(sector, &all, work)).collect();
    let growing = |at: usize| -> Vec<f64> {
        found.iter().filter_map(|of_sector| of_sector[at].as_ref()).flat_map(|(_, found)| found.frequencies()).collect()
    };
    let frequencies: Vec<Vec<f64>> = (0..points.len()).map(growing).collect();
    for (sector, found) in sectors.iter().zip(&mut found) {
        let is_open =
            |&at: &usize| found[at].as_ref().is_some_and(|(_, found)| found.leaves_order_open(&frequencies[at]));
        let open: Vec<usize> = (0..points.len()).filter(is_open).collect();
        let again: Vec<(Gain, &[f64])> = open.iter().map(|&at| (gains[at], &frequencies[at][..])).collect();
        for (at, again) in open.into_iter().zip(search_sector(sector, &again, work)) {
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

/// The growing modes of a sector at each of `gains`, which come with frequencies that the bounds of other modes must keep off. A growing mode
/// so near the threshold of the plan that rounding leaves its side open leaves the answer open: a spectrum brings a bound.
fn search_sector(sector: &SectorSolver<'_>, gains: &[(Gain, &[f64])], work: &mut Workspace) -> Vec<SecularAnswer> {
    let Some(SectorEquation { secular, anchors, .. }) = sector.equation else { return vec![None; gains.len()] };
    let found = secular.growing(anchors, gains, work);
    let is_clear = |found: &Growing| {
        let mut growing = found.modes.iter().filter(|mode| mode.re > 0.0);
        growing.all(|&mode| sector.plan.threshold.margin(mode).abs() > secular.least_distance())
    };
    gains.iter().zip(found).map(|(&(gain, _), found)| Some((gain, found.ok().filter(is_clear)?))).collect()
}
