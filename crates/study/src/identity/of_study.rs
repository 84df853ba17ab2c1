//! The identity of a study: all on which its counts depend, so that a folder of another study is not continued.

use linsys::{Channel, ChannelGain, Lag, OperatingPoint, SecondOrder, Term};
use montecarlo::stream;
use nalgebra::DMatrix;
use osc_model::Brake;

use super::{Identity, Written};
use crate::{Configuration, ModeIdentity, ModeNaming, Origin, Plan, Scene, UncertainBrake};

/// Number of draws whose operating points are written, in every scene. For a brake of a user's own type they stand for its distributions, and a change that
/// moves none of them is not seen. Another number would make every folder one of another study.
const DRAWS: u64 = 8;

/// The identity of the study of a brake, without the number of samples and what a command adds.
///
/// A brake with a case file has the parts of its case; one of a user's own type has its equations, naming points and errors of reduction. Both have modes
/// (labels, rule, band, least growth), scenes, threshold, seed, and the operating points of the medians and of the first draws in every scene, which change
/// with distributions, laws and whatever else turns a draw into numbers. What a [`ModeSource`](crate::ModeSource) of a user's own finds is not among them.
pub fn of_study<B: UncertainBrake>(brake: &B) -> Identity {
    let plan = brake.plan();
    let mut identity = Identity::read(&plan.name, &plan.identity);
    if plan.source_file.is_none() {
        let errors: Vec<f64> = plan.scenes.iter().map(|scene| brake.error_of_reduction(scene)).collect();
        identity =
            identity.part("equations", |to| equations(to, plan)).part("errors", |to| to.list(errors, Written::rounded));
    }
    let (growth, ratio) = (plan.threshold.growth_above(), plan.threshold.damping_ratio_below());
    identity
        .part("modes", |to| modes(to, plan))
        .part("scenes", |to| to.list(&plan.scenes, scene))
        .given("growth_above", growth)
        .given("damping_ratio_below", ratio)
        .part("draws", |to| draws(to, brake))
        .given("seed", plan.seed)
}

fn equations(to: &mut Written, Plan { configurations, origins, .. }: &Plan) {
    // What the contacts are called is for reports alone.
    to.list(configurations, |to, Configuration { brake, naming_point, origin, contacts: _ }| {
        of_brake(to, brake);
        point(to, naming_point);
        to.count(*origin);
    });
    to.list(origins, |to, Origin { brake, naming_point }| {
        of_brake(to, brake);
        point(to, naming_point);
    });
}

fn of_brake(to: &mut Written, Brake { system, dofs, bodies, sectors }: &Brake) {
    to.list(system.terms(), |to, term| {
        let Term { name, family, .. } = term;
        to.text(name);
        to.text(family);
        // A term has no internal states.
        let SecondOrder { m, c, k, internal: _ } = term.matrices();
        [m, c, k].into_iter().for_each(|of| matrix(to, of));
    });
    to.list(system.channels(), channel);
    to.count(dofs.total());
    to.list(dofs.free(), |to, &dof| to.count(dof));
    to.list(bodies, |to, body| {
        to.text(&body.name);
        to.list(&body.dofs, |to, &dof| to.count(dof));
    });
    // Which division it is follows from the matrices, and whether it is used changes no eigenvalue.
    to.count(sectors.iter().count());
}

fn matrix(to: &mut Written, of: &DMatrix<f64>) {
    to.count(of.nrows());
    to.list(of.as_slice(), |to, &entry| to.number(entry));
}

/// Writes out a channel of friction, or of what relaxes.
pub fn channel(to: &mut Written, Channel { name, family, force, reading, is_contact }: &Channel) {
    to.text(name);
    to.text(family);
    for entries in [force, reading] {
        to.list(entries, |to, &(dof, value)| {
            to.count(dof);
            to.number(value);
        });
    }
    // Only of what relaxes, so that folders of other studies, which were made before there was any, are still theirs.
    if !is_contact {
        to.count(0);
    }
}

fn modes(to: &mut Written, plan: &Plan) {
    naming(to, plan.mode_labels, plan.mode_identity);
    to.option(plan.band, |to, band| band.iter().for_each(|&edge| to.number(edge)));
    // Only where there is one, so that folders of other studies are still theirs; nothing may be written after it, as it has no length before it.
    plan.least_growth.into_iter().for_each(|least| to.number(least));
}

/// Writes out how modes are named.
pub fn naming(to: &mut Written, labels: ModeNaming, identity: ModeIdentity) {
    to.count(match labels {
        ModeNaming::Tracked => 0,
        ModeNaming::Rank => 1,
        ModeNaming::Pair => 2,
        ModeNaming::RankDown => 3,
        ModeNaming::PairDown => 4,
    });
    to.count(match identity {
        ModeIdentity::Continuation => 0,
        ModeIdentity::Mac => 1,
    });
}

fn scene(to: &mut Written, Scene { key, members, configuration, wants_work }: &Scene) {
    to.count(key.constraints);
    to.count(key.law);
    to.option(key.speed, Written::count);
    to.count(key.panel);
    to.list(members, |to, &member| to.count(member));
    to.count(*configuration);
    to.count(usize::from(*wants_work));
}

/// The operating points of the medians and of [`DRAWS`] draws in every scene; of one that cannot be drawn that it cannot.
fn draws<B: UncertainBrake>(to: &mut Written, brake: &B) {
    let plan = brake.plan();
    let drawn = (0..DRAWS).map(|index| brake.draw(&mut stream(plan.seed, index)).ok());
    for sample in std::iter::once(Some(brake.median())).chain(drawn) {
        to.option(sample, |to, sample| {
            to.list(&plan.scenes, |to, scene| {
                to.option(brake.operating_point(scene, &sample).ok(), |to, at| point(to, &at));
            });
        });
    }
}

/// Writes out an operating point, which functions of the platform may have made of draws or medians.
fn point(to: &mut Written, OperatingPoint { coefficients, channels }: &OperatingPoint) {
    to.list(coefficients, |to, &coefficient| to.rounded(coefficient));
    to.list(channels, |to, &ChannelGain { mu, slope, lag }| {
        to.rounded(mu);
        to.rounded(slope);
        to.option(lag, |to, Lag { decay, drive, force }| [decay, drive, force].into_iter().for_each(|x| to.rounded(x)));
    });
}
