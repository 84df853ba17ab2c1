//! The motions of the draws of a study: of the first unstable draws of each scene, from each of their unstable modes.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use cea::{EigenSolver as _, QrSolver, Workspace};
use montecarlo::{Experiment as _, Progress, Sealed, Summary, stream};
use num_complex::Complex;
use output::{OutputError, write};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use study::identity::of_study;
use study::{DrawnContacts, ModeLabel, Scratch, Study, StudyTally, UncertainBrake};

use super::drawn::{DrawnFate, Following, motions};
use super::{MOTION, digest, grows_in_band, when_cancelled};
use crate::Error;

/// Name of the file in which motions are kept, so that a run that was stopped goes on.
const STATE: &str = "cycles_of_draws.json";
/// Format of the file; the version changes when motions of an older program can no longer be taken.
const FORMAT: Sealed = Sealed { kind: "squeal-cycles-of-draws", version: 5 };
/// Number of samples that are evaluated together in the search for unstable ones; chosen.
const BLOCK: u64 = 16;
/// Number of draws that are followed between two looks whether to write, for each thread; chosen.
const DRAWS_PER_THREAD: usize = 4;
/// Time between two writes of the state; chosen, as that of estimates.
const SAVE_EVERY: Duration = Duration::from_secs(5);

/// Motions of draws of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CyclesOfDraws {
    /// Identity of the study with its contacts, one line.
    identity: String,
    /// Number of unstable draws of each scene that are followed, at most.
    pub most_draws: u64,
    /// Draws of each scene.
    pub scenes: Vec<SceneDraws>,
}

/// Draws of a scene that are followed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SceneDraws {
    /// The first of its draws with an unstable mode, ascending.
    pub draws: Vec<DrawOfScene>,
    /// Names of the contacts.
    pub contacts: Vec<String>,
}

/// A draw with the motions from its unstable modes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DrawOfScene {
    /// Index of the sample.
    pub sample: u64,
    /// Unstable modes with their motions, ascending in frequency.
    pub motions: Vec<DrawnMotion>,
}

/// An unstable mode of a draw, and the motion that it grows into.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DrawnMotion {
    /// Names that the mode may have.
    pub names: Vec<ModeLabel>,
    /// Growth rate, 1/s.
    pub growth: f64,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Fate of the motion; `None` of one that is still to be followed.
    pub fate: Option<DrawnFate>,
}

/// The contacts of the samples of a brake.
pub(crate) fn drawn_contacts_of<B: UncertainBrake>(brake: &B) -> Result<&dyn DrawnContacts<B::Sample>, Error> {
    brake.drawn_contacts().ok_or(Error::NotGiven { capability: "drawn_contacts", needed_by: MOTION })
}

/// Checks that the contacts of a brake are known at the medians in all scenes, before anything is sampled; gives the names of those of each
/// scene and a digest of all.
///
/// # Errors
/// A brake that does not give its contacts; one whose load, speed, spring or law is not known.
pub fn check_contacts_of_draws<B: UncertainBrake>(brake: &B, stick: f64) -> Result<(Vec<Vec<String>>, String), Error> {
    let (contacts, median) = (drawn_contacts_of(brake)?, brake.median());
    let (mut names, mut all) = (Vec::new(), String::new());
    for scene in &brake.plan().scenes {
        let system = contacts.contact_system_of(scene, &median, stick)?;
        names.push(system.contacts().iter().map(|contact| contact.name.clone()).collect());
        all += &format!("{:?}\n", system.contacts());
    }
    Ok((names, digest(&all, brake.plan().units)))
}

impl CyclesOfDraws {
    /// Follows the motions of the first `most_draws` samples of each scene in which a mode surely is unstable, from each such mode, and writes
    /// `cycles_of_draws`, `cycles_by_mode` and `cycles_by_scene` in `dir`. The state is kept in the folder `kept_in`: motions that it holds are not
    /// followed again. A draw that only diverges has no motion to be followed and is not among them.
    ///
    /// # Errors
    /// As [`check_contacts_of_draws`]; a folder that cannot be written; work that is cancelled.
    pub fn run<B: UncertainBrake>(
        study: &Study<'_, B>,
        summary: &Summary<StudyTally>,
        (most_draws, stick): (u64, f64),
        kept_in: &Path,
        dir: &Path,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let following = Following::of_study(stick);
        let (contacts, digest) = check_contacts_of_draws(study.brake(), stick)?;
        let asked = format!("{most_draws} of {} samples, {following:?}, contacts {digest}", summary.samples);
        let identity = of_study(study.brake()).given("cycles", asked).into_line();
        let mut found = match Self::kept(&identity, kept_in) {
            Some(kept) => kept,
            None => {
                let scenes = (0..contacts.len()).into_par_iter();
                let scenes = scenes.map(|scene| first_unstable(study, summary, scene, most_draws, progress));
                let draws = scenes.collect::<Result<Vec<_>, Error>>()?;
                let scenes = draws.into_iter().zip(contacts).map(|(draws, contacts)| SceneDraws { draws, contacts });
                Self { identity, most_draws, scenes: scenes.collect() }
            }
        };
        found.follow(study, &following, kept_in, progress)?;
        for table in found.tables(study.plan()) {
            table.write(dir)?;
        }
        Ok(found)
    }

    /// A sentence for the summary of the study: which motions were followed, and below which part of its speed a LuGre contact was said to stick.
    #[must_use]
    pub fn note(&self, stick: f64) -> String {
        format!(
            "the motion from each unstable mode of the first {} unstable samples of each scene was followed, LuGre contacts said to stick below \
             {stick} of their speed",
            self.most_draws
        )
    }

    /// Follows all motions that are still to be followed.
    fn follow<B: UncertainBrake>(
        &mut self,
        study: &Study<'_, B>,
        following: &Following,
        kept_in: &Path,
        progress: &dyn Progress,
    ) -> Result<(), Error> {
        let draws =
            self.scenes.iter().enumerate().flat_map(|(scene, of)| (0..of.draws.len()).map(move |draw| (scene, draw)));
        let all: Vec<(usize, usize)> = draws.collect();
        let is_open = |&&(scene, draw): &&(usize, usize)| {
            self.scenes[scene].draws[draw].motions.iter().any(|motion| motion.fate.is_none())
        };
        let open: Vec<(usize, usize)> = all.iter().filter(is_open).copied().collect();
        progress.begin(all.len() as u64, (all.len() - open.len()) as u64);
        let mut saved = Instant::now();
        let mut followed = 0;
        let found = when_cancelled(progress, |stop| {
            for chunk in open.chunks(DRAWS_PER_THREAD * rayon::current_num_threads()) {
                let fates = chunk.par_iter().map(|&(scene, draw)| {
                    let of_draw = &self.scenes[scene].draws[draw];
                    let found = of_one_draw(study, scene, of_draw, following, &stop);
                    progress.advance(1);
                    found
                });
                let fates = fates.collect::<Result<Vec<_>, Error>>()?;
                for (&(scene, draw), fates) in chunk.iter().zip(fates) {
                    let motions = &mut self.scenes[scene].draws[draw].motions;
                    motions.iter_mut().zip(fates).for_each(|(motion, fate)| motion.fate = Some(fate));
                }
                followed += chunk.len();
                if followed == open.len() || saved.elapsed() >= SAVE_EVERY {
                    self.keep(kept_in)?;
                    saved = Instant::now();
                }
            }
            Ok(())
        });
        progress.end();
        found
    }

    /// Keeps the state in a folder.
    fn keep(&self, kept_in: &Path) -> Result<(), Error> {
        let path = kept_in.join(STATE);
        let failed = |error: serde_json::Error| OutputError::Write { path: path.clone(), source: error.into() };
        let body = serde_json::to_vec(self).map_err(failed)?;
        Ok(write(&path, &[FORMAT.header(&body).as_bytes(), &body].concat())?)
    }

    /// Motions that a folder holds, if they are of the same study and question; those of a file that is not whole are followed again.
    fn kept(identity: &str, kept_in: &Path) -> Option<Self> {
        let bytes = std::fs::read(kept_in.join(STATE)).ok()?;
        let kept: Self = serde_json::from_slice(FORMAT.open(&bytes).ok()?).ok()?;
        (kept.identity == identity).then_some(kept)
    }
}

/// The first samples of a scene with an unstable mode, their motions still to be followed.
fn first_unstable<B: UncertainBrake>(
    study: &Study<'_, B>,
    summary: &Summary<StudyTally>,
    scene: usize,
    most_draws: u64,
    progress: &dyn Progress,
) -> Result<Vec<DrawOfScene>, Error> {
    let (seed, samples) = (study.plan().seed, summary.samples);
    let mut left = summary.tally.scenes[scene].any_unstable;
    let mut draws = Vec::new();
    for block in 0..samples.div_ceil(BLOCK) {
        if left == 0 {
            break;
        }
        progress.go_on()?;
        let indices = block * BLOCK..samples.min((block + 1) * BLOCK);
        let drawn: Vec<(u64, B::Sample)> =
            indices.filter_map(|index| Some((index, study.draw(&mut stream(seed, index)).ok()?))).collect();
        let of_block: Vec<&B::Sample> = drawn.iter().map(|(_, sample)| sample).collect();
        let mut outcomes = Vec::with_capacity(of_block.len());
        study.evaluate_block(scene, &of_block, &mut Scratch::default(), &mut outcomes);
        for (&(sample, _), outcome) in drawn.iter().zip(outcomes) {
            // Samples that failed are counted by the study.
            let Ok(outcome) = outcome else { continue };
            left -= u64::from(outcome.is_unstable()).min(left);
            let motions = outcome.unstable.into_iter().map(|mode| DrawnMotion {
                names: mode.names,
                growth: mode.lambda.re,
                omega: mode.lambda.im,
                fate: None,
            });
            let motions: Vec<DrawnMotion> = motions.collect();
            if !motions.is_empty() {
                draws.push(DrawOfScene { sample, motions });
            }
            if draws.len() as u64 == most_draws {
                return Ok(draws);
            }
        }
    }
    Ok(draws)
}

/// The fates of all motions of a draw.
fn of_one_draw<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    of_draw: &DrawOfScene,
    following: &Following,
    stop: &Arc<AtomicBool>,
) -> Result<Vec<DrawnFate>, Error> {
    let (brake, plan) = (study.brake(), study.plan());
    let of_scene = &plan.scenes[scene];
    let sample = brake.draw(&mut stream(plan.seed, of_draw.sample))?;
    let of_cea = brake.system(of_scene, &sample)?;
    let system = drawn_contacts_of(brake)?.contact_system_of(of_scene, &sample, following.stick);
    let mut system = system.map(|system| system.until(Arc::clone(stop))).map_err(Error::from);
    if brake.mode_source().is_some() {
        let spectrum = QrSolver.eigenvalues(&of_cea, &mut Workspace::default()).map_err(study::Error::from)?;
        let in_band = grows_in_band(plan, of_scene, brake.error_of_reduction(of_scene), &spectrum.eigenvalues);
        system = system.and_then(|system| in_band.map(|()| system));
    }
    let lambdas: Vec<Complex<f64>> =
        of_draw.motions.iter().map(|motion| Complex::new(motion.growth, motion.omega)).collect();
    motions(system, &of_cea, &lambdas, (plan, plan.brake(of_scene)), following)
}
