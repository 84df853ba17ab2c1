//! Sample points of a surrogate: at one state of friction, the eigenvalues near the axis, their derivatives and their names.

use cea::{BatchSolver, EigenSolver, Mode, Modes, Workspace, right_and_left_vectors_of_all};
use linsys::{ChannelGain, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use tracking::{Path, PathEnd, PathStart};

use super::EstimatorError;
use super::friction_points::LeadingFriction;
use crate::{ModeLabel, NearAxis, Scratch, Study, UncertainBrake};

/// Largest decay rate, as a fraction of |lambda|, of an eigenvalue that counts as near the axis; chosen.
const LARGEST_DECAY: f64 = 0.025;

/// An eigenvalue near the axis, as a function of mu and of the complex slope s.
#[derive(Debug, Clone)]
pub(super) struct SampledMode {
    /// The eigenvalue, rad/s.
    pub lambda: Complex<f64>,
    /// Complex slope s(lambda), Ns/m.
    pub slope: Complex<f64>,
    /// Derivative d lambda / d mu at constant s, rad/s.
    pub by_mu: Complex<f64>,
    /// Derivative d lambda / d s at constant mu, rad/s per Ns/m.
    pub by_slope: Complex<f64>,
    /// The names that an unstable mode may have; empty for a stable one.
    pub names: Vec<ModeLabel>,
}

impl SampledMode {
    fn new(mode: NearAxis, gain: &ChannelGain) -> Self {
        let NearAxis { lambda, by_mu, by_slope, names } = mode;
        Self { lambda, slope: gain.complex_slope(lambda), by_mu, by_slope, names }
    }
}

/// Systems of a scene with the same friction in every contact.
pub(super) struct SamplePoints<'a, B: UncertainBrake> {
    study: &'a Study<'a, B>,
    scene: usize,
    friction: LeadingFriction<'a, B>,
    /// Change of K by mu, dK / d mu.
    by_mu: Sparse,
    /// Change of C by the slope, dC / d slope.
    by_slope: Sparse,
    work: Workspace,
    scratch: Scratch,
}

impl<'a, B: UncertainBrake> SamplePoints<'a, B> {
    /// # Errors
    /// Those of the model.
    pub fn new(study: &'a Study<'a, B>, scene: usize) -> Result<Self, EstimatorError> {
        let mut points = Self {
            study,
            scene,
            friction: LeadingFriction::new(study.brake(), &study.plan().scenes[scene])?,
            by_mu: Sparse::default(),
            by_slope: Sparse::default(),
            work: Workspace::default(),
            scratch: Scratch::default(),
        };
        let at = |mu: f64, slope: f64| points.system(&ChannelGain { mu, slope, lag: None });
        let (system, one, steeper) = (at(0.0, 0.0)?, at(1.0, 0.0)?, at(0.0, 1.0)?);
        points.by_mu = Sparse::new(&(one.k - &system.k));
        points.by_slope = Sparse::new(&(steeper.c - &system.c));
        Ok(points)
    }

    fn system(&self, gain: &ChannelGain) -> Result<SecondOrder, EstimatorError> {
        let plan = self.study.plan();
        let brake = plan.brake(&plan.scenes[self.scene]);
        Ok(brake.system.assemble(&self.friction.point(gain)).map_err(crate::Error::from)?)
    }

    /// The modes near the axis under each of `gains`.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn solve(&mut self, gains: &[ChannelGain]) -> Result<Vec<Vec<SampledMode>>, EstimatorError> {
        let points: Vec<OperatingPoint> = gains.iter().map(|gain| self.friction.point(gain)).collect();
        let found = self.study.near_axis(self.scene, &points, LARGEST_DECAY, &mut self.scratch)?;
        let left: Vec<ChannelGain> =
            gains.iter().zip(&found).filter(|(_, found)| found.is_none()).map(|(gain, _)| *gain).collect();
        let mut by_spectra = self.by_spectra(&left)?.into_iter();
        let near = |(found, gain): (Option<Vec<NearAxis>>, &ChannelGain)| match found {
            None => by_spectra.next().unwrap_or_default(),
            Some(found) => found.into_iter().map(|mode| SampledMode::new(mode, gain)).collect(),
        };
        Ok(found.into_iter().zip(gains).map(near).collect())
    }

    /// The modes near the axis as by [`SamplePoints::solve`], without secular equations.
    fn by_spectra(&mut self, gains: &[ChannelGain]) -> Result<Vec<Vec<SampledMode>>, EstimatorError> {
        let systems = gains.iter().map(|gain| self.system(gain)).collect::<Result<Vec<_>, _>>()?;
        let mut spectra = Vec::with_capacity(systems.len());
        BatchSolver.eigenvalues_of_all(&systems, &mut self.work, &mut spectra);
        let mut lambdas = Vec::with_capacity(systems.len());
        for (system, spectrum) in systems.iter().zip(spectra) {
            let mut near = Modes::classify(system, &spectrum?, &mut self.work)?.oscillatory;
            near.retain(|lambda| lambda.re > -LARGEST_DECAY * lambda.norm());
            lambdas.push(near);
        }
        let pairs: Vec<(&SecondOrder, &[Complex<f64>])> =
            systems.iter().zip(lambdas.iter().map(Vec::as_slice)).collect();
        let (mut right, mut left) = (Vec::with_capacity(systems.len()), Vec::with_capacity(systems.len()));
        for ((system, lambdas), both) in pairs.iter().zip(right_and_left_vectors_of_all(&pairs, &mut self.work)) {
            let [shapes, of_left] = both?;
            let shapes = lambdas.iter().zip(shapes);
            right.push(shapes.map(|(&at, shape)| Mode::normalised(&system.m, at, shape)).collect::<Vec<_>>());
            left.push(of_left.into_iter().map(|left| left.conjugate()).collect::<Vec<_>>());
        }

        let mut found: Vec<Vec<SampledMode>> = Vec::with_capacity(systems.len());
        for (((system, gain), modes), left) in systems.iter().zip(gains).zip(&right).zip(&left) {
            found.push(modes.iter().zip(left).map(|(mode, left)| self.mode(system, gain, mode, left)).collect());
        }
        let grows = |mode: &Mode| self.study.plan().threshold.margin(mode.lambda) > 0.0;
        right.iter_mut().for_each(|modes| modes.retain(grows));
        let reference = &self.study.references()[self.scene];
        let end = PathEnd { system: &reference.system, modes: &reference.modes };
        let paths: Vec<Path<'_>> = systems
            .iter()
            .zip(&right)
            .map(|(system, modes)| Path { start: PathStart::System(system), start_modes: modes, end })
            .collect();
        let names = reference.names_of_all(&BatchSolver, &paths, self.study.plan().mode_identity, &mut self.work);
        for (modes, names) in found.iter_mut().zip(names) {
            let grows = |mode: &&mut SampledMode| self.study.plan().threshold.margin(mode.lambda) > 0.0;
            for (mode, names) in modes.iter_mut().filter(grows).zip(names?) {
                mode.names = names;
            }
        }
        Ok(found)
    }

    fn mode(&self, system: &SecondOrder, gain: &ChannelGain, mode: &Mode, left: &DVector<Complex<f64>>) -> SampledMode {
        let (lambda, right) = (mode.lambda, &mode.shape);
        let unit_slope = self.by_slope.between(left, right);
        // Q' at constant s: without the derivative of s by lambda.
        let by_lambda = left.dot(&(system.dynamic_stiffness_derivative(lambda) * right));
        let change = gain.lag.map_or(Complex::default(), |lag| -lag.force * lag.drive / (lambda + lag.decay).powi(2));
        let by_lambda = by_lambda - lambda * change * unit_slope;
        SampledMode {
            lambda,
            slope: gain.complex_slope(lambda),
            by_mu: -self.by_mu.between(left, right) / by_lambda,
            by_slope: -lambda * unit_slope / by_lambda,
            names: Vec::new(),
        }
    }
}

/// The nonzero entries of a matrix.
#[derive(Default)]
struct Sparse(Vec<(usize, usize, f64)>);

impl Sparse {
    fn new(matrix: &DMatrix<f64>) -> Self {
        let entries = (0..matrix.ncols()).flat_map(|j| (0..matrix.nrows()).map(move |i| (i, j)));
        Self(entries.map(|(i, j)| (i, j, matrix[(i, j)])).filter(|entry| entry.2 != 0.0).collect())
    }

    /// The product `left^T A right`.
    fn between(&self, left: &DVector<Complex<f64>>, right: &DVector<Complex<f64>>) -> Complex<f64> {
        self.0.iter().map(|&(i, j, a)| left[i] * right[j] * a).sum()
    }
}
