//! The motion after the onset: what each unstable mode of a scene grows into, and cycles over a parameter.
//!
//! Any [`UncertainBrake`] that gives its [`SlidingContacts`] can be asked. Every run begins with a check that the
//! equations of motion have the system of the complex eigenvalue analysis as their tangent.

mod branches;
mod drawn;
mod growing;
mod of_draws;
mod of_draws_tables;
mod sound;
mod starts;
mod stopped;
mod tables;

pub use branches::{Branch, BranchCycle, Branches, branches};
pub use drawn::{DrawnFate, MeasuredMotion};
pub(crate) use drawn::{Following, displacements, loudest, motions};
use growing::{GrowingMode, growing_modes};
pub(crate) use growing::{grows_in_band, growth_outside};
pub(crate) use of_draws::drawn_contacts_of;
pub use of_draws::{CyclesOfDraws, DrawOfScene, DrawnMotion, SceneDraws, check_contacts_of_draws};
pub(crate) use stopped::{UntilStopped, when_cancelled};

use std::fmt::Display;
use std::path::Path;

use cycle::{
    Balance, ContactMoment, ContactSystem, Cycle, Harmonics, Measures, Motion, Settings, follow_telling, harmonics,
    history, measure, states,
};
use montecarlo::Progress;
use num_complex::Complex;
use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};
use sound::Sound;
use study::{Scene, SlidingContacts, UncertainBrake, Units};

use crate::Error;
use crate::kept::{Kept, Question};

/// Options of the motion of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleOptions {
    /// Starts of motions.
    pub from: Start,
    /// Harmonics of the balance, 1 or more.
    pub harmonics: usize,
    /// Equal steps of a period at which a balance evaluates the contacts: 2 H + 1 or more.
    pub samples: usize,
    /// Part of the steady speed of a contact below which a balance smooths its friction, and below which one with a bristle is said to stick; above 0, below 1.
    pub stick: f64,
}

impl Default for CycleOptions {
    fn default() -> Self {
        Self { from: Start::UnstableModes, harmonics: 9, samples: 512, stick: 0.01 }
    }
}

/// Start of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// From each unstable mode, just beyond the amplitude at which the first contact opens or sticks.
    UnstableModes,
    /// From the mode of this rank, as the complex eigenvalue analysis counts it.
    Mode(usize),
    /// From noise, four streams of the seed of the study: several motions may be stable.
    Noise,
}

/// Motions that the unstable modes of a scene grow into.
#[derive(Debug, Clone)]
pub struct Cycles {
    /// Deviation of the tangent from the system of the complex eigenvalue analysis, relative.
    pub tangent_deviation: f64,
    /// Harmonics of the balance.
    pub harmonics: usize,
    /// The motions, by their starts.
    pub motions: Vec<MotionOfMode>,
    /// Growth rates of real eigenvalues that diverge, ascending, 1/s: what deviates along them grows without oscillation, whatever the modes do.
    pub diverging: Vec<f64>,
    /// Part of the area of the outer faces, 0 to 1, that counts as at rest though nothing is known to hold it: its nodes have no rows; `None` of a brake
    /// without faces.
    pub outer_without_rows: Option<f64>,
    /// Names of the bodies, with their degrees of freedom.
    pub(crate) bodies: Vec<(String, Vec<usize>)>,
    /// False of a reduced brake, whose coordinates have no largest displacement.
    pub(crate) has_peaks: bool,
    /// Degrees of freedom that are no rotations: their velocities together are the loudness.
    pub displacements: Vec<usize>,
    /// Names of the contacts.
    pub contacts: Vec<String>,
    /// Names of the families of forces.
    pub(crate) families: Vec<String>,
}

/// The motion that starts at a mode.
#[derive(Debug, Clone)]
pub struct MotionOfMode {
    /// Start: the rank of a mode or `noise` with a number.
    pub start: String,
    /// Eigenvalue of the mode, 1/s; of noise, that of the mode that grows fastest.
    pub lambda: Complex<f64>,
    /// Fate of the motion.
    pub motion: Motion,
    /// Measures of the cycle; `None` where the motion is none.
    pub measures: Option<Measures>,
    /// Loudness of the cycle, m/s.
    pub loudness: Option<f64>,
    /// Contacts at 128 equal steps over the period, N and m/s; none where the motion is no cycle.
    pub history: Vec<Vec<ContactMoment>>,
    /// Harmonics of the cycle, m and m/s.
    pub harmonics: Option<Harmonics>,
    /// Power that the outer faces radiate in each harmonic at radiation efficiency 1, W; `None` of a brake without faces.
    pub radiated_power: Option<Vec<f64>>,
    /// Frequency of the harmonic balance, Hz; `None` where it does not converge, is of another motion than the cycle, or there is no cycle.
    pub balanced_hz: Option<f64>,
}

/// Equal steps of a period at which a cycle is taken for its harmonics, 256 at most; chosen.
const STEPS: usize = 1024;

/// Equal steps of a period in a table of what contacts do, an eighth of these; chosen: ten of a ninth harmonic.
const HISTORY: usize = STEPS / 8;

/// Name of the computation that needs the contacts of a brake.
pub const MOTION: &str = "the motion after the onset";

/// Allowed error of a piece of a motion, relative; chosen: cycles are known to some 1e-9.
pub(crate) const TOLERANCE: f64 = 1e-10;

/// The contacts of a brake beyond their tangents.
///
/// # Errors
/// [`Error::NotGiven`].
pub(crate) fn contacts_of<B: UncertainBrake>(brake: &B) -> Result<&dyn SlidingContacts, Error> {
    brake.sliding_contacts().ok_or(Error::NotGiven { capability: "sliding_contacts", needed_by: MOTION })
}

/// Digest of the contacts of a scene at its medians, with loads, speeds, springs and laws, which the identity of a study does not have.
///
/// # Errors
/// As [`cycles`].
pub fn contacts_digest<B: UncertainBrake>(brake: &B, scene: &Scene, options: &CycleOptions) -> Result<String, Error> {
    checked(options)?;
    let system = contacts_of(brake)?.contact_system(scene, &[], options.stick)?;
    Ok(digest(&format!("{:?}", system.contacts()), brake.plan().units))
}

/// The answers that a file has for a question about the contacts of a scene.
///
/// # Errors
/// As [`contacts_digest`]; a file that cannot be read or written.
fn open_kept<B: UncertainBrake>(
    kept: Option<&Path>,
    brake: &B,
    scene: &Scene,
    options: &CycleOptions,
    over: impl Display,
) -> Result<Kept, Error> {
    let contacts = contacts_digest(brake, scene, options)?;
    Kept::open(kept, brake, format!("motions over {over} with {options:?}, contacts {contacts}, {scene:?}"))
}

/// Refuses options that no scene could take, and gives the balance.
pub(crate) fn checked(options: &CycleOptions) -> Result<Balance, Error> {
    if !(options.stick > 0.0 && options.stick < 1.0) {
        let allowed =
            "above 0 and below 1: the part of the sliding speed below which the friction of the balance is smoothed"
                .into();
        return Err(Error::Argument { argument: "stick", value: options.stick.to_string(), allowed });
    }
    Ok(Balance::new(options.harmonics, options.samples)?)
}

/// The motions after the onset in a scene at its medians. What becomes of each is kept in the file `kept`, and taken from there where an earlier call has come so far: the
/// results are the same. A file of another brake, scene, question, program or kind of processor is begun anew. Progress counts periods of the modes that are followed, up to those after which a
/// motion is not periodic; what ends earlier has them all.
///
/// # Errors
/// A brake that does not give its contacts, options that are not allowed, a tangent that is not that of the analysis, a scene without an
/// unstable mode, a mode that is not unstable; work that is cancelled; a file that cannot be read or written.
pub fn cycles<B: UncertainBrake>(
    brake: &B,
    scene: &Scene,
    options: &CycleOptions,
    kept: Option<&Path>,
    progress: &dyn Progress,
) -> Result<Cycles, Error> {
    let (contacts, balance, plan) = (contacts_of(brake)?, checked(options)?, brake.plan());
    let system = contacts.contact_system(scene, &[], options.stick)?;
    let of_cea = brake.system(scene, &brake.median())?;
    let (modes, diverging) = growing_modes(brake, scene)?;
    let Some(fastest) = modes.iter().max_by(|a, b| a.lambda.re.total_cmp(&b.lambda.re)) else {
        return Err(Error::NeverSqueals { scene: plan.describe(scene) });
    };
    let tangent_deviation = system.check_tangent(&of_cea, fastest.lambda.im)?;
    let in_mode = |mode| (GrowingMode::rank_in_words(mode), mode, starts::in_mode(&system, mode));
    let starts: Vec<(String, &GrowingMode, Vec<f64>)> = match options.from {
        Start::UnstableModes => modes.iter().map(in_mode).collect(),
        Start::Mode(rank) => match modes.iter().find(|mode| mode.rank == rank) {
            Some(mode) => vec![in_mode(mode)],
            None => {
                let ranks: Vec<String> = modes.iter().map(GrowingMode::rank_in_words).collect();
                let allowed = format!("noise, or the rank of an unstable mode: {}", ranks.join(", "));
                return Err(Error::Argument { argument: "from", value: rank.to_string(), allowed });
            }
        },
        Start::Noise => (0..starts::STREAMS)
            .map(|stream| {
                (format!("noise {}", stream + 1), fastest, starts::noise(&system, fastest, plan.seed, stream))
            })
            .collect(),
    };
    let settings = Settings { tolerance: TOLERANCE, ..Settings::default() };
    let kept = open_kept(kept, brake, scene, options, "medians")?;
    let of_scene = plan.brake(scene);
    let displacements = displacements(plan, of_scene);
    let of_plan = (plan.units, &displacements[..]);
    progress.begin(starts.len() as u64 * settings.most_periods as u64, 0);
    let found = when_cancelled(progress, |stop| {
        let (system, sound) = (system.clone().until(stop), Sound::of(brake, scene, progress)?);
        let motion = |start| motion_of(&system, &balance, &settings, start, of_plan, sound.as_ref(), (progress, &kept));
        Ok((starts.into_par_iter().map(motion).collect::<Result<Vec<_>, Error>>()?, sound))
    });
    progress.end();
    let (motions, sound) = found?;
    Ok(Cycles {
        tangent_deviation,
        harmonics: options.harmonics,
        motions,
        diverging,
        outer_without_rows: sound.as_ref().map(Sound::without_rows),
        bodies: of_scene.bodies.iter().map(|body| (body.name.clone(), body.dofs.clone())).collect(),
        has_peaks: plan.band.is_none(),
        displacements,
        contacts: system.contacts().iter().map(|contact| contact.name.clone()).collect(),
        families: system.families(),
    })
}

/// Measures in m, J and W, of a system in some units.
pub(crate) fn in_si(mut measures: Measures, units: Units) -> Measures {
    let Measures { rms_velocity, peak, kinetic_energy, powers, contacts: _ } = &mut measures;
    let numbers = rms_velocity.iter_mut().chain(peak).chain([kinetic_energy]);
    numbers.chain(powers.iter_mut().map(|(_, power)| power)).for_each(|number| *number *= units.length());
    measures
}

/// Harmonics of a cycle in m and m/s, from its states in some units: as many as hold the loudness, by its degrees of freedom and `measures` in SI; of a
/// cycle of rotations alone, which has none, all velocities.
pub(super) fn harmonics_in_si(
    cycle: &Cycle,
    states: &[Vec<f64>],
    measures: &Measures,
    (units, displacements): (Units, &[usize]),
) -> Harmonics {
    let all: Vec<usize> = (0..measures.rms_velocity.len()).collect();
    let held = if measures.rms_of(displacements) > 0.0 { displacements } else { &all };
    let mut found = harmonics(cycle, all.len(), states, (held, measures.rms_of(held) / units.length()));
    found.mean.iter_mut().for_each(|mean| *mean *= units.length());
    found.velocity.iter_mut().flatten().for_each(|velocity| *velocity *= units.length());
    found
}

/// Digest of some contacts with the units in which they are.
pub(crate) fn digest(contacts: &str, units: Units) -> String {
    let units = if units == Units::Si { "" } else { units.name() };
    study::fingerprint(&format!("{contacts}{units}"))
}

/// Follows the motion from a state, and measures what it becomes.
fn motion_of(
    system: &ContactSystem,
    balance: &Balance,
    settings: &Settings,
    (name, mode, start): (String, &GrowingMode, Vec<f64>),
    (units, displacements): (Units, &[usize]),
    sound: Option<&Sound>,
    (progress, kept): (&dyn Progress, &Kept),
) -> Result<MotionOfMode, Error> {
    let (omega, shape) = (mode.lambda.im, &mode.shape[..]);
    let mut periods = 0;
    // The last period is over when all is known of the motion.
    let mut tell = || {
        if periods + 1 < settings.most_periods as u64 {
            periods += 1;
            progress.advance(1);
        }
    };
    let asked = [&start[..], &[omega]].concat();
    let motion = kept.answer(Question::Motion, &asked, || {
        let motion = follow_telling(system, start, omega, shape, settings, &mut tell)?;
        // A step that was stopped may look as if it had failed by itself.
        progress.go_on()?;
        Ok(motion)
    })?;
    let cycle: Option<&Cycle> = match &motion {
        Motion::Cycle(cycle) => Some(cycle),
        _ => None,
    };
    let measures = cycle.map(|cycle| measure(system, cycle, TOLERANCE)).transpose()?;
    let measures = measures.map(|measures| in_si(measures, units));
    let states = cycle.map(|cycle| states(system, cycle, STEPS, TOLERANCE)).transpose()?.unwrap_or_default();
    let mut history = history(system, states.iter().step_by(STEPS / HISTORY));
    history.iter_mut().flatten().for_each(|moment| moment.sliding_velocity *= units.length());
    let of_cycle = cycle.zip(measures.as_ref());
    let harmonics = of_cycle.map(|(cycle, measures)| harmonics_in_si(cycle, &states, measures, (units, displacements)));
    let balanced = cycle.and_then(|cycle| balance.near(system, cycle, TOLERANCE).ok());
    let balanced_hz = balanced.map(|balanced| balanced.omega / std::f64::consts::TAU);
    progress.advance(settings.most_periods as u64 - periods);
    Ok(MotionOfMode {
        start: name,
        lambda: mode.lambda,
        motion,
        loudness: measures.as_ref().map(|measures| measures.rms_of(displacements)),
        measures,
        history,
        radiated_power: sound
            .zip(harmonics.as_ref())
            .map(|(sound, harmonics)| harmonics.velocity.iter().map(|velocity| sound.power(velocity)).collect()),
        harmonics,
        balanced_hz,
    })
}
