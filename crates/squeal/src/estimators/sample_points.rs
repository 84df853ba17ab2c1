//! What is known at a sample point, one state of friction: eigenvalues near the axis with their derivatives, and names.

use cea::{BatchSolver, EigenSolver, Mode, Modes, Workspace, right_vectors_of_all};
use friction::Tangent;
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use osc_model::{Linearise, Sliding};
use tracking::{Path, PathEnd, PathStart, identify_all};

use super::EstimatorError;
use crate::study::{NearAxis, Sample, Scratch, Study};

/// Decay rate, as a part of |lambda|, beyond which an eigenvalue is not looked at; chosen.
const LARGEST_DECAY: f64 = 0.025;

/// An eigenvalue near the axis, as a function of mu and of the complex slope H.
#[derive(Debug, Clone)]
pub(super) struct SampledMode {
    /// rad/s.
    pub lambda: Complex<f64>,
    /// H(lambda) there, s/m.
    pub slope: Complex<f64>,
    /// d lambda / d mu at constant H.
    pub by_mu: Complex<f64>,
    /// d lambda / d H at constant mu.
    pub by_slope: Complex<f64>,
    /// What an unstable mode may be called.
    pub names: Vec<u16>,
}

impl SampledMode {
    fn new(mode: NearAxis, tangent: &Tangent, load: f64) -> Self {
        let NearAxis { lambda, by_mu, by_slope, names } = mode;
        Self { lambda, slope: tangent.complex_slope(lambda), by_mu, by_slope: by_slope * load, names }
    }
}

/// Systems of a scene with the same friction in every contact.
pub(super) struct SamplePoints<'a> {
    study: &'a Study<'a>,
    scene: usize,
    sliding: Sliding,
    /// dK / d mu and dC / d slope.
    by_mu: Sparse,
    by_slope: Sparse,
    work: Workspace,
    scratch: Scratch,
}

impl<'a> SamplePoints<'a> {
    /// # Errors
    /// What the model refuses.
    pub fn new(study: &'a Study<'a>, scene: usize) -> Result<Self, EstimatorError> {
        let plan = study.plan();
        let sliding = plan.sliding(&plan.scenes[scene], &Sample::median(&plan.case))?;
        let mut points = Self {
            study,
            scene,
            sliding,
            by_mu: Sparse::default(),
            by_slope: Sparse::default(),
            work: Workspace::default(),
            scratch: Scratch::default(),
        };
        let at = |mu: f64, slope: f64| points.system(&Tangent { mu, slope, internal: None });
        let (system, one, steeper) = (at(0.0, 0.0)?, at(1.0, 0.0)?, at(0.0, 1.0)?);
        points.by_mu = Sparse::new(&(one.k - &system.k));
        points.by_slope = Sparse::new(&(steeper.c - &system.c));
        Ok(points)
    }

    fn state(&self, tangent: &Tangent) -> Sliding {
        let mut state = self.sliding.clone();
        state.contacts.iter_mut().for_each(|contact| contact.tangent = *tangent);
        state
    }

    fn system(&self, tangent: &Tangent) -> Result<SecondOrder, EstimatorError> {
        let plan = self.study.plan();
        Ok(plan.lattice(&plan.scenes[self.scene]).linearised(&self.state(tangent)).map_err(crate::Error::from)?)
    }

    /// The modes near the axis under each of `tangents`.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn solve(&mut self, tangents: &[Tangent]) -> Result<Vec<Vec<SampledMode>>, EstimatorError> {
        let states: Vec<Sliding> = tangents.iter().map(|tangent| self.state(tangent)).collect();
        let found = self.study.near_axis(self.scene, &states, LARGEST_DECAY, &mut self.scratch)?;
        let left: Vec<Tangent> =
            tangents.iter().zip(&found).filter(|(_, found)| found.is_none()).map(|(tangent, _)| *tangent).collect();
        let mut by_spectra = self.by_spectra(&left)?.into_iter();
        let load = self.sliding.contacts.first().map_or(0.0, |contact| contact.normal_load);
        let near = |(found, tangent): (Option<Vec<NearAxis>>, &Tangent)| match found {
            None => by_spectra.next().unwrap_or_default(),
            Some(found) => found.into_iter().map(|mode| SampledMode::new(mode, tangent, load)).collect(),
        };
        Ok(found.into_iter().zip(tangents).map(near).collect())
    }

    /// [`SamplePoints::solve`] without secular equations.
    fn by_spectra(&mut self, tangents: &[Tangent]) -> Result<Vec<Vec<SampledMode>>, EstimatorError> {
        let systems = tangents.iter().map(|tangent| self.system(tangent)).collect::<Result<Vec<_>, _>>()?;
        let mut spectra = Vec::with_capacity(systems.len());
        BatchSolver.eigenvalues_of_all(&systems, &mut self.work, &mut spectra);
        let mut lambdas = Vec::with_capacity(systems.len());
        for (system, spectrum) in systems.iter().zip(spectra) {
            let mut near = Modes::classify(system, &spectrum?, &mut self.work)?.oscillatory;
            near.retain(|lambda| lambda.re > -LARGEST_DECAY * lambda.norm());
            lambdas.push(near);
        }
        let transposed: Vec<SecondOrder> = systems.iter().map(SecondOrder::transposed).collect();
        let pairs: Vec<(&SecondOrder, &[Complex<f64>])> =
            systems.iter().zip(lambdas.iter().map(Vec::as_slice)).collect();
        let right = Mode::of_all(&pairs, &mut self.work);
        let pairs: Vec<(&SecondOrder, &[Complex<f64>])> =
            transposed.iter().zip(lambdas.iter().map(Vec::as_slice)).collect();
        let left = right_vectors_of_all(&pairs, &mut self.work);
        let mut right = right.into_iter().collect::<Result<Vec<_>, _>>()?;
        let left = left.into_iter().collect::<Result<Vec<_>, _>>()?;

        let mut found: Vec<Vec<SampledMode>> = Vec::with_capacity(systems.len());
        for (((system, tangent), modes), left) in systems.iter().zip(tangents).zip(&right).zip(&left) {
            found.push(modes.iter().zip(left).map(|(mode, left)| self.mode(system, tangent, mode, left)).collect());
        }
        right.iter_mut().for_each(|modes| modes.retain(|mode| mode.lambda.re > 0.0));
        let reference = &self.study.references()[self.scene];
        let end = PathEnd { system: &reference.system, modes: &reference.modes };
        let paths: Vec<Path<'_>> = systems
            .iter()
            .zip(&right)
            .map(|(system, modes)| Path { start: PathStart::System(system), start_modes: modes, end })
            .collect();
        let links = identify_all(&BatchSolver, &paths, &mut self.work);
        for (modes, links) in found.iter_mut().zip(links) {
            for (mode, link) in modes.iter_mut().filter(|mode| mode.lambda.re > 0.0).zip(links?) {
                mode.names = reference.names_of(link);
            }
        }
        Ok(found)
    }

    fn mode(&self, system: &SecondOrder, tangent: &Tangent, mode: &Mode, left: &DVector<Complex<f64>>) -> SampledMode {
        let (lambda, right) = (mode.lambda, &mode.shape);
        let unit_slope = self.by_slope.between(left, right);
        // Q' at constant H: without what H itself changes with lambda.
        let by_lambda = left.dot(&(system.dynamic_stiffness_derivative(lambda) * right));
        let change = tangent
            .internal
            .map_or(Complex::default(), |state| -state.force * state.drive / (lambda + state.decay).powi(2));
        let by_lambda = by_lambda - lambda * change * unit_slope;
        SampledMode {
            lambda,
            slope: tangent.complex_slope(lambda),
            by_mu: -self.by_mu.between(left, right) / by_lambda,
            by_slope: -lambda * unit_slope / by_lambda,
            names: Vec::new(),
        }
    }
}

/// The entries of a matrix that are not zero.
#[derive(Default)]
struct Sparse(Vec<(usize, usize, f64)>);

impl Sparse {
    fn new(matrix: &DMatrix<f64>) -> Self {
        let entries = (0..matrix.ncols()).flat_map(|j| (0..matrix.nrows()).map(move |i| (i, j)));
        Self(entries.map(|(i, j)| (i, j, matrix[(i, j)])).filter(|entry| entry.2 != 0.0).collect())
    }

    /// `left^T A right`.
    fn between(&self, left: &DVector<Complex<f64>>, right: &DVector<Complex<f64>>) -> Complex<f64> {
        self.0.iter().map(|&(i, j, a)| left[i] * right[j] * a).sum()
    }
}
