//! The references of a plan: of its origins, of its configurations from the origins, and of its scenes from the configurations.

use std::collections::BTreeMap;

use cea::{EigenSolver, Mode, Modes, ranks_together};
use linsys::{OperatingPoint, SecondOrder, real_times_complex};
use montecarlo::Progress;
use nalgebra::DMatrix;
use num_complex::Complex;
use osc_model::Sector;
use rayon::prelude::*;
use tracking::{Path, PathEnd, follow};

use super::{Reference, SectoredReference, Way, bounded_workspace, path_start};
use crate::Error;
use crate::{Configuration, ModeIdentity, ModeLabel, ModeSource, Origin, Plan, Scene};

/// The references of the origins and of the scenes of a plan, each in their order.
pub(crate) struct References {
    pub origins: Vec<Reference>,
    pub scenes: Vec<SectoredReference>,
}

/// The references of `plan`; `points` are the operating points of its scenes at median parameters. A brake that finds its modes itself is the `source` of
/// coordinates in which modes are followed. Shapes of the origins are kept if they are to name modes `by_likeness`. Progress advances by one for each
/// configuration and each scene.
///
/// # Errors
/// Those of the model and of the solver; [`Error::Scene`] names the scene.
pub(crate) fn references(
    plan: &Plan,
    points: &[OperatingPoint],
    source: Option<&dyn ModeSource>,
    by_likeness: bool,
    solver: &dyn EigenSolver,
    progress: &dyn Progress,
) -> Result<References, Error> {
    let origin = |origin: &Origin| {
        let named = of_origin(origin, plan, solver)?;
        Ok(if by_likeness { named.naming_by_likeness() } else { named })
    };
    let origins = plan.origins.iter().map(origin).collect::<Result<Vec<_>, Error>>()?;
    let of_configuration = |(place, configuration): (usize, &Configuration)| {
        progress.go_on()?;
        let origin = &origins[configuration.origin];
        let bridged = match source {
            Some(source) => across(source, place, origin, plan, solver),
            None => Ok(None),
        };
        let found = match bridged {
            Ok(None) => of_configuration(configuration, origin, plan, solver),
            Ok(Some(found)) => Ok(found),
            Err(error) => Err(error),
        };
        progress.advance(1);
        found.map_err(|source| Error::Scene {
            scene: format!("contact {}", configuration.contacts),
            source: source.into(),
        })
    };
    let configurations = plan
        .configurations
        .par_iter()
        .enumerate()
        .map(of_configuration)
        .collect::<Result<Vec<SectoredReference>, Error>>()?;
    let of_scene = |(scene, at): (&Scene, &OperatingPoint)| {
        progress.go_on()?;
        let found = of_scene((scene, at), &configurations[scene.configuration], (plan, source), solver);
        progress.advance(1);
        found.map_err(|source| Error::Scene { scene: plan.describe(scene), source: source.into() })
    };
    let scenes = plan.scenes.par_iter().zip(points).map(of_scene).collect::<Result<_, Error>>()?;
    Ok(References { origins, scenes })
}

/// Numbers of the modes of an origin, from their eigenvalues and frequency ranks: these ranks, or with a band those among the modes that the brake surely
/// has in it, and all others, which are followed as they may come in, after these.
fn numbered(modes: &[(Complex<f64>, usize)], plan: &Plan) -> BTreeMap<usize, ModeLabel> {
    let is_known = |lambda| plan.is_studied(lambda) && plan.least_growth.is_none_or(|least| lambda.re >= least);
    let mut order: Vec<(bool, usize)> = modes.iter().map(|&(lambda, rank)| (!is_known(lambda), rank)).collect();
    order.sort_unstable();
    let number = |(place, (_, rank))| (rank, if plan.band.is_some() { place + 1 } else { rank });
    order.into_iter().enumerate().map(number).map(|(rank, number)| (rank, ModeLabel::of_rank(number))).collect()
}

/// The modes of an origin, each with its number as its name.
fn of_origin(origin: &Origin, plan: &Plan, solver: &dyn EigenSolver) -> Result<Reference, Error> {
    let (brake, mut work) = (&origin.brake, bounded_workspace(origin.brake.system.order()));
    let system = brake.system.assemble(&origin.naming_point)?;
    let of_sector = |sector: &Sector| {
        let system = sector.reduced(&system)?;
        let spectrum = solver.eigenvalues(&system, &mut work)?;
        Ok((Modes::classify(&system, &spectrum, &mut work)?, system))
    };
    let (found, systems): (Vec<Modes>, Vec<_>) =
        brake.sectors.iter().map(of_sector).collect::<Result<Vec<_>, Error>>()?.into_iter().unzip();
    let ranked = found.iter().zip(ranks_together(&found.iter().collect::<Vec<_>>()));
    let ranked = ranked.map(|(all, ranks)| all.oscillatory.iter().copied().zip(ranks));
    let followed: Vec<Vec<_>> =
        ranked.map(|part| part.filter(|(lambda, _)| plan.is_followed(*lambda)).collect()).collect();
    let numbers = numbered(&followed.concat(), plan);
    let mut parts = Vec::with_capacity(found.len());
    for (modes, system) in followed.into_iter().zip(systems) {
        let (lambdas, names): (Vec<_>, Vec<_>) =
            modes.iter().map(|(lambda, rank)| (*lambda, vec![numbers[rank]])).unzip();
        let mut part = Reference { names, ..Reference::of_modes(system, &lambdas, &mut work)? };
        part.open_equal_modes();
        parts.push(part);
    }
    Ok(Reference::joined(system, &brake.sectors, &parts))
}

fn of_configuration(
    configuration: &Configuration,
    origin: &Reference,
    plan: &Plan,
    solver: &dyn EigenSolver,
) -> Result<SectoredReference, Error> {
    let Configuration { brake, naming_point, .. } = configuration;
    let system = brake.system.assemble(naming_point)?;
    let from = brake.sectors.iter().map(|sector| origin.within(sector)).collect::<Result<Vec<_>, _>>()?;
    if system == origin.system {
        return Ok(SectoredReference { whole: origin.clone(), sectors: from });
    }
    // On the straight path from one system to the other the stiffness and the load of the contacts that open fade out
    // together.
    SectoredReference::linked(&from, solver, &brake.sectors, system, (Way::Far, None), plan)
}

/// The modes of a configuration, by its index in the plan, named by the modes of an origin with other degrees of freedom, in coordinates that
/// both have in common; `None` where both have the same degrees of freedom.
fn across(
    source: &dyn ModeSource,
    place: usize,
    origin: &Reference,
    plan: &Plan,
    solver: &dyn EigenSolver,
) -> Result<Option<SectoredReference>, Error> {
    let Configuration { brake, naming_point, .. } = &plan.configurations[place];
    let system = brake.system.assemble(naming_point)?;
    if system == origin.system {
        return Ok(None);
    }
    let mut work = bounded_workspace(system.order());
    let mut next = Reference::unnamed(solver, system, plan, &mut work)?;
    let Some(bridge) = source.bridge(place, [&origin.modes, &next.modes])? else { return Ok(None) };
    let lifted = |modes: &[Mode], onto: &DMatrix<f64>, system: &SecondOrder| -> Vec<Mode> {
        modes
            .iter()
            .map(|mode| Mode::normalised(&system.m, mode.lambda, real_times_complex(onto, &mode.shape)))
            .collect()
    };
    next.shapes = origin.shapes.as_ref().map(|shapes| shapes.in_coordinates(&bridge.between));
    if plan.mode_identity == ModeIdentity::Mac {
        next.names = next.names_by_likeness(&next.modes).unwrap_or_default();
    } else {
        let start_modes = lifted(&origin.modes, &bridge.origin, &bridge.start);
        let end_modes = lifted(&next.modes, &bridge.configuration, &bridge.end);
        let start = path_start(&bridge.start, bridge.path.as_deref());
        let end = PathEnd { system: &bridge.end, modes: &end_modes };
        let path = Path { start, start_modes: &start_modes, end };
        next.name(&origin.names, follow(solver, path, &mut work)?);
    }
    Ok(Some(SectoredReference { whole: next.clone(), sectors: vec![next] }))
}

fn of_scene(
    (scene, at): (&Scene, &OperatingPoint),
    configuration: &SectoredReference,
    (plan, source): (&Plan, Option<&dyn ModeSource>),
    solver: &dyn EigenSolver,
) -> Result<SectoredReference, Error> {
    let brake = plan.brake(scene);
    let system = brake.system.assemble(at)?;
    if system == configuration.whole.system {
        return Ok(configuration.clone());
    }
    let naming_point = &plan.configurations[scene.configuration].naming_point;
    let coarse = match source {
        Some(source) => source.coarse(scene, [naming_point, at])?,
        None => None,
    };
    SectoredReference::linked(&configuration.sectors, solver, &brake.sectors, system, (Way::Near, coarse), plan)
}
