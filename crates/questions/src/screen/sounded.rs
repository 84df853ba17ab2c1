//! The study of sets of changes, with the loudness of each sample where that is asked for.

use std::sync::Arc;

use cea::{EigenSolver as _, QrSolver, Workspace};
use montecarlo::{Experiment, StreamRng};
use num_complex::Complex;
use study::{Outcome, Scratch, Study, UncertainBrake};

use super::modified::Modified;
use crate::Error;
use crate::cycles::{UntilStopped, drawn_contacts_of, grows_in_band, loudest, motions};

/// A study of a changed brake whose outcomes have the loudness of the loudest motion, m/s: 0 where nothing is unstable, infinite where a motion cannot be
/// followed; `None` where it is not asked for.
pub(super) struct Sounded<'s, 'a, B: UncertainBrake> {
    /// The study.
    pub study: &'s Study<'s, Modified<'a, B>>,
    /// Settings by which motions are followed, where loudness is asked for.
    pub following: Option<UntilStopped>,
}

impl<B: UncertainBrake> Sounded<'_, '_, B> {
    fn loudness(&self, scene: usize, sample: &B::Sample, outcome: &Outcome, (following, stop): &UntilStopped) -> f64 {
        if outcome.divergent > 0 {
            return f64::INFINITY;
        }
        if outcome.unstable.is_empty() {
            return 0.0;
        }
        let found = || -> Result<f64, Error> {
            let (brake, plan) = (self.study.brake(), self.study.plan());
            let of_scene = &plan.scenes[scene];
            let system = drawn_contacts_of(brake)?.contact_system_of(of_scene, sample, following.stick);
            let system = system.map(|system| system.until(Arc::clone(stop))).map_err(Error::from);
            let of_cea = brake.system(of_scene, sample)?;
            if plan.band.is_some() {
                let spectrum = QrSolver.eigenvalues(&of_cea, &mut Workspace::default()).map_err(study::Error::from)?;
                grows_in_band(plan, of_scene, brake.error_of_reduction(of_scene), &spectrum.eigenvalues)?;
            }
            let lambdas: Vec<Complex<f64>> = outcome.unstable.iter().map(|mode| mode.lambda).collect();
            let of_brake = (plan, plan.brake(of_scene));
            Ok(loudest(&motions(system, &of_cea, &lambdas, of_brake, following)?))
        };
        found().unwrap_or(f64::INFINITY)
    }
}

impl<B: UncertainBrake> Experiment for Sounded<'_, '_, B> {
    type Sample = B::Sample;
    type Outcome = (Outcome, Option<f64>);
    type Error = study::Error;
    type Scratch = Scratch;

    fn scenes(&self) -> usize {
        self.study.scenes()
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<B::Sample, study::Error> {
        self.study.draw(rng)
    }

    fn evaluate(&self, scene: usize, sample: &B::Sample, scratch: &mut Scratch) -> Result<Self::Outcome, study::Error> {
        let outcome = self.study.evaluate(scene, sample, scratch)?;
        let loudness = self.following.as_ref().map(|following| self.loudness(scene, sample, &outcome, following));
        Ok((outcome, loudness))
    }

    fn evaluate_block(
        &self,
        scene: usize,
        samples: &[&B::Sample],
        scratch: &mut Scratch,
        out: &mut Vec<Result<Self::Outcome, study::Error>>,
    ) {
        let mut outcomes = Vec::with_capacity(samples.len());
        self.study.evaluate_block(scene, samples, scratch, &mut outcomes);
        let heard = |(sample, outcome): (&&B::Sample, Result<Outcome, study::Error>)| {
            let outcome = outcome?;
            let loudness = self.following.as_ref().map(|following| self.loudness(scene, sample, &outcome, following));
            Ok((outcome, loudness))
        };
        out.extend(samples.iter().zip(outcomes).map(heard));
    }
}
