//! A scene of a study as a limit state: modes and gradients at standard normal numbers.

use std::cell::RefCell;
use std::collections::BTreeSet;

use ::rare::{LimitState, Mode, tail};
use cea::{CeaError, CertifiedError, CountedSpectrum, EigenSolver, Eigentriple, Spectrum, Workspace, grows_too_fast};
use linsys::SecondOrder;
use montecarlo::Progress;
use num_complex::Complex;
use rayon::prelude::*;
use study::{DrawnInputs, Plan, Scene, Study, UncertainBrake};

use crate::Error;
use crate::kept::{Kept, Question};

/// Half of the difference in standard deviations from which the change of a system with an input is taken; chosen: its square is far below what
/// a gradient must be right to, and quantiles at 7 deviations keep enough digits. Eigenvalues are never differenced.
const DIFFERENCE: f64 = 1e-3;

/// Part of the size of an eigenvalue by which its margin must be below the largest to be no candidate for that, whose bounds are not asked for; chosen, far above the
/// error of an eigenvalue that is any good.
const FAR: f64 = 1e-3;

/// A scene whose inputs are functions of independent standard normal numbers, one of each coordinate of the brake's quantile functions.
pub(super) struct SceneState<'a, B: UncertainBrake> {
    pub study: &'a Study<'a, B>,
    pub scene: &'a Scene,
    pub drawn: &'a dyn DrawnInputs<B::Sample>,
    /// The coordinates that a sample depends on, ascending.
    pub coordinates: Vec<u32>,
    pub solver: &'a dyn EigenSolver,
    pub progress: &'a dyn Progress,
    /// What is known of points already.
    pub kept: &'a Kept,
    /// Ranges of the only coordinate, in standard deviations, in which nothing grows for certain.
    pub proven: Vec<[f64; 2]>,
}

impl<'a, B: UncertainBrake> SceneState<'a, B> {
    pub fn new(
        study: &'a Study<'a, B>,
        scene: &'a Scene,
        drawn: &'a dyn DrawnInputs<B::Sample>,
        solver: &'a dyn EigenSolver,
        (progress, kept): (&'a dyn Progress, &'a Kept),
    ) -> Self {
        let asked = RefCell::new(BTreeSet::new());
        drawn.quantile_sample(scene, &|coordinate| {
            asked.borrow_mut().insert(coordinate);
            0.5
        });
        // Of what is asked, what is drawn: constants and what does not matter in the scene are no dimension.
        let inputs = drawn.inputs(scene);
        let is_drawn = |coordinate: &u32| inputs.iter().any(|input| input.coordinate == *coordinate);
        let coordinates = asked.into_inner().into_iter().filter(is_drawn).collect();
        Self { study, scene, drawn, coordinates, solver, progress, kept, proven: Vec::new() }
    }

    /// The sample at a point.
    pub fn sample(&self, u: &[f64]) -> B::Sample {
        let uniform = |coordinate: u32| match self.coordinates.binary_search(&coordinate) {
            // Quantiles at 0 and at 1 may be infinite.
            Ok(place) => tail(-u[place]).clamp(f64::MIN_POSITIVE, 1.0 - 0.5 * f64::EPSILON),
            Err(_) => 0.5,
        };
        self.drawn.quantile_sample(self.scene, &uniform)
    }

    fn system(&self, u: &[f64]) -> Result<SecondOrder, Error> {
        Ok(self.study.brake().system(self.scene, &self.sample(u))?)
    }

    /// The mode of the largest margin among the modes of a spectrum that are studied.
    fn judged(plan: &Plan, counted: CountedSpectrum) -> Option<Mode> {
        let mode = |lambda: Complex<f64>, is_on: bool| {
            let margin = plan.threshold.margin(lambda);
            // What is on the threshold to within rounding does not fail.
            Mode { margin: if is_on { -margin.abs() } else { margin }, growth: lambda.re, omega: lambda.im }
        };
        let CountedSpectrum { flutter, divergence, marginal, below, .. } = counted;
        let sided = flutter.into_iter().chain(divergence.into_iter().map(Complex::from)).chain(below);
        let sided = sided.map(|lambda| mode(lambda, false));
        Mode::worst(sided.chain(marginal.into_iter().map(|lambda| mode(lambda, true))))
    }

    /// The mode of the largest margin at each point.
    fn solved(&self, points: &[&[f64]]) -> Result<Vec<Option<Mode>>, Error> {
        let mut work = Workspace::default();
        let systems = points.iter().map(|u| self.system(u)).collect::<Result<Vec<_>, _>>()?;
        let mut spectra = Vec::with_capacity(systems.len());
        self.solver.eigenvalues_of_all(&systems, &mut work, &mut spectra);
        // A reduced brake shows no divergence, of a real eigenvalue or of a pair that grows faster than it oscillates.
        let (plan, has_divergence) = (self.study.plan(), self.study.brake().mode_source().is_none());
        let is_divergence = |lambda: Complex<f64>| lambda.im == 0.0 || grows_too_fast(lambda);
        let is_studied = |lambda: Complex<f64>| plan.is_studied(lambda) && (has_divergence || !is_divergence(lambda));
        let of_system = |work: &mut Workspace, (system, spectrum): (&SecondOrder, Result<Spectrum, CeaError>)| {
            let spectrum = spectrum?;
            let studied =
                || spectrum.eigenvalues.iter().copied().filter(|lambda| lambda.im >= 0.0 && is_studied(*lambda));
            let most = studied().map(|lambda| plan.threshold.margin(lambda)).fold(f64::NEG_INFINITY, f64::max);
            let is_near = |lambda: Complex<f64>| plan.threshold.margin(lambda) >= most - FAR * lambda.norm();
            let mut judged = |is_asked: &dyn Fn(Complex<f64>) -> bool| {
                let counted = CountedSpectrum::of_some(&plan.threshold, system, &spectrum, is_asked, work)?;
                match counted.blunt.first() {
                    Some(lambda) => Err(Error::Blunt { omega: lambda.im }),
                    None => Ok(Self::judged(plan, counted)),
                }
            };
            // The largest margin is that of one of these, unless none of them is sided.
            let near = judged(&|lambda| is_studied(lambda) && is_near(lambda))?;
            match near {
                Some(mode)
                    if studied().all(|lambda| is_near(lambda) || plan.threshold.margin(lambda) <= mode.margin) =>
                {
                    Ok(near)
                }
                _ => judged(&is_studied),
            }
        };
        let modes = systems.par_iter().zip(spectra).map_init(Workspace::default, of_system).collect();
        self.progress.advance(points.len() as u64);
        modes
    }

    /// The gradient of the margin of a mode with this eigenvalue.
    fn rates(&self, u: &[f64], lambda: Complex<f64>) -> Result<Vec<f64>, Error> {
        let triple = match Eigentriple::new(&self.system(u)?, lambda, &mut Workspace::default()) {
            // Of an eigenvalue that has no vector to working precision there is no direction to go.
            Err(CeaError::Certified(CertifiedError::NoEigenvector { .. })) => return Ok(vec![0.0; u.len()]),
            triple => triple?,
        };
        let rate = |place: usize| {
            let at = |by: f64| {
                let mut u = u.to_vec();
                u[place] += by;
                Ok::<_, Error>(self.system(&u)?.dynamic_stiffness(lambda))
            };
            let change = at(DIFFERENCE)? - at(-DIFFERENCE)?;
            let rate = triple.rate_over(&change, 2.0 * DIFFERENCE);
            Ok(self.study.plan().threshold.margin_rate(lambda, rate))
        };
        (0..u.len()).map(rate).collect()
    }
}

impl<B: UncertainBrake> LimitState for SceneState<'_, B> {
    type Error = Error;

    fn dimensions(&self) -> usize {
        self.coordinates.len()
    }

    fn modes(&self, u: &[f64]) -> Result<Vec<Mode>, Error> {
        Ok(self.modes_of_all(&[u.to_vec()])?.pop().unwrap_or_default())
    }

    fn modes_of_all(&self, points: &[Vec<f64>]) -> Result<Vec<Vec<Mode>>, Error> {
        self.progress.go_on()?;
        let points: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
        let worst = self.kept.answers(Question::Worst, &points, |open| self.solved(open))?;
        Ok(worst.into_iter().map(|worst| worst.into_iter().collect()).collect())
    }

    fn proven(&self) -> Vec<[f64; 2]> {
        self.proven.clone()
    }

    fn gradient(&self, u: &[f64], mode: &Mode) -> Result<Vec<f64>, Error> {
        let asked = [u, &[mode.growth, mode.omega]].concat();
        self.kept.answer(Question::Gradient, &asked, || self.rates(u, Complex::new(mode.growth, mode.omega)))
    }
}
