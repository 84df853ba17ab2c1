//! The systems with one complex slope of friction, and where their modes cross the axis.

use std::collections::BTreeMap;

use cea::{BatchSolver, Mode, Modes, Spectrum, Way, Workspace, identify};
use friction::Tangent;
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use osc_model::Linearise;

use super::AccuracyError;
use super::surface::Crossing;
use crate::study::{Sample, Study};

/// Steps of Newton's method.
const MOST_STEPS: usize = 12;
/// Change of a coefficient, or of the part of a step, that no occurrence feels.
const SETTLED: f64 = 1e-7;

/// The systems of a row: `K = K_0 + mu K_1`, all else fixed.
pub(super) struct Row {
    pub tangent: Tangent,
    system: SecondOrder,
    constant: DMatrix<f64>,
    linear: DMatrix<Complex<f64>>,
    /// C_1.
    unit_slope: DMatrix<Complex<f64>>,
}

impl Row {
    /// Holds the complex slope of `sample` in a scene.
    pub fn new(study: &Study<'_>, scene: usize, sample: &Sample) -> Result<Self, AccuracyError> {
        let (plan, scene) = (study.plan(), &study.plan().scenes[scene]);
        let mut sliding = plan.sliding(scene, sample)?;
        let Some(tangent) = sliding.contacts.first().map(|contact| contact.tangent) else {
            return Err(AccuracyError::NotOneParameter { needed: "a contact", found: "none".into() });
        };
        let mut at = |mu: f64, more: f64| {
            for contact in &mut sliding.contacts {
                contact.tangent.mu = mu;
                contact.tangent.slope = tangent.slope + more;
            }
            plan.lattice(scene).linearised(&sliding).map_err(crate::Error::from)
        };
        let (system, one, steeper) = (at(0.0, 0.0)?, at(1.0, 0.0)?, at(0.0, 1.0)?);
        let constant = system.k.clone();
        let linear = (one.k - &system.k).map(Complex::from);
        let unit_slope = (steeper.c - &system.c).map(Complex::from);
        Ok(Self { tangent, system, constant, linear, unit_slope })
    }

    /// The system at `mu`.
    pub fn at(&mut self, mu: f64) -> &SecondOrder {
        self.system.k.zip_zip_apply(&self.constant, &self.linear, |k, constant, linear| *k = constant + mu * linear.re);
        &self.system
    }

    /// Where the mode that is `lambda` at one mu crosses the axis on its way to `other` at another.
    pub fn along_mu(
        &mut self,
        (start, lambda): (f64, Complex<f64>),
        (end, other): (f64, Complex<f64>),
    ) -> Option<Crossing> {
        let mut step = |row: &mut Self, part: f64, axis: Complex<f64>, vectors: &mut Vectors| {
            row.at(start + part * (end - start));
            let change = &row.linear * Complex::from(end - start);
            row.newton(row.system.dynamic_stiffness(axis), &change, axis, vectors)
        };
        let (part, mut crossing) = self.crossing(lambda, other, &mut step)?;
        crossing.mu = start + part * (end - start);
        crossing.slope = self.tangent.complex_slope(crossing.axis);
        Some(crossing)
    }

    /// Where, at the mu of the last [`Row::at`], the mode `lambda` crosses the axis on its way to `other`, the slope going
    /// from this row's to that of `to`; and the part of that way.
    pub fn along_slope(&mut self, to: &Tangent, lambda: Complex<f64>, other: Complex<f64>) -> Option<(f64, Crossing)> {
        let way = |row: &Self, axis| to.complex_slope(axis) - row.tangent.complex_slope(axis);
        let mut step = |row: &mut Self, part: f64, axis: Complex<f64>, vectors: &mut Vectors| {
            let change = &row.unit_slope * (axis * way(row, axis));
            row.newton(row.system.dynamic_stiffness(axis) + &change * Complex::from(part), &change, axis, vectors)
        };
        let (part, mut crossing) = self.crossing(lambda, other, &mut step)?;
        crossing.slope = self.tangent.complex_slope(crossing.axis) + way(self, crossing.axis) * part;
        Some((part, crossing))
    }

    /// Newton's method for the part of a way, 0 to 1, and the frequency at which `Q(i omega)` is singular.
    fn crossing(&mut self, lambda: Complex<f64>, other: Complex<f64>, step: &mut Step<'_>) -> Option<(f64, Crossing)> {
        let mut part = (lambda.re / (lambda.re - other.re)).clamp(0.0, 1.0);
        let mut axis = Complex::new(0.0, lambda.im + part * (other.im - lambda.im));
        let mut vectors = Vectors::new(self.system.order());
        for _ in 0..MOST_STEPS {
            let Motion { off, rate } = step(self, part, axis, &mut vectors)?;
            let change = -off.re / rate.re;
            if change.abs() <= SETTLED {
                let is_inside = (-SETTLED..=1.0 + SETTLED).contains(&part);
                let [by_mu, by_slope] = self.derivatives(axis, &vectors);
                let crossing = Crossing { mu: 0.0, axis, slope: Complex::default(), by_mu: by_mu.re, by_slope };
                return is_inside.then_some((part, crossing));
            }
            axis.im += off.im + rate.im * change;
            part += change;
        }
        None
    }

    /// How far the eigenvalue is from `axis`, and how fast it moves along the way, whose change of Q is `change`.
    fn newton(
        &self,
        q: DMatrix<Complex<f64>>,
        change: &DMatrix<Complex<f64>>,
        axis: Complex<f64>,
        vectors: &mut Vectors,
    ) -> Option<Motion> {
        vectors.iterate(&q)?;
        let derivative = vectors.between(&self.system.dynamic_stiffness_derivative(axis));
        Some(Motion { off: -vectors.between(&q) / derivative, rate: -vectors.between(change) / derivative })
    }

    /// lambda_mu and lambda_H.
    fn derivatives(&self, axis: Complex<f64>, vectors: &Vectors) -> [Complex<f64>; 2] {
        let derivative = vectors.between(&self.system.dynamic_stiffness_derivative(axis));
        [-vectors.between(&self.linear) / derivative, -axis * vectors.between(&self.unit_slope) / derivative]
    }
}

/// A step of Newton's method at a part of a way and a point of the axis.
type Step<'a> = dyn FnMut(&mut Row, f64, Complex<f64>, &mut Vectors) -> Option<Motion> + 'a;

/// How far an eigenvalue is from a point of the axis, and how fast it moves along a way.
struct Motion {
    off: Complex<f64>,
    rate: Complex<f64>,
}

/// Left and right vector of a nearly singular matrix, improved by inverse iteration as the matrix changes.
struct Vectors {
    left: DVector<Complex<f64>>,
    right: DVector<Complex<f64>>,
    is_new: bool,
}

impl Vectors {
    fn new(n: usize) -> Self {
        // A start that no symmetry makes orthogonal to the vector.
        let right = DVector::from_fn(n, |i, _| Complex::from_polar(1.0, 2.4 * ((i + 1) * (i + 2)) as f64));
        Self { left: right.clone(), right, is_new: true }
    }

    fn iterate(&mut self, q: &DMatrix<Complex<f64>>) -> Option<()> {
        let (factor, mirrored) = (q.clone().lu(), q.adjoint().lu());
        for _ in 0..if self.is_new { 3 } else { 1 } {
            if !(factor.solve_mut(&mut self.right) && mirrored.solve_mut(&mut self.left)) {
                return None;
            }
            self.right.unscale_mut(self.right.norm());
            self.left.unscale_mut(self.left.norm());
        }
        self.is_new = false;
        Some(())
    }

    /// `psi^H A phi`.
    fn between(&self, matrix: &DMatrix<Complex<f64>>) -> Complex<f64> {
        self.left.dotc(&(matrix * &self.right))
    }
}

/// A spectrum with the names of its unstable modes, those with an open name under each that they may have.
pub(super) struct Column {
    oscillatory: Vec<Complex<f64>>,
    pub unstable: BTreeMap<u16, Complex<f64>>,
}

impl Column {
    pub fn new(
        study: &Study<'_>,
        scene: usize,
        system: &SecondOrder,
        spectrum: &Spectrum,
        work: &mut Workspace,
    ) -> Result<Self, AccuracyError> {
        let oscillatory = Modes::classify(system, spectrum, work)?.oscillatory;
        let lambdas: Vec<Complex<f64>> = oscillatory.iter().copied().filter(|lambda| lambda.re > 0.0).collect();
        let found = Mode::at(system, &lambdas, work)?;
        let reference = &study.references()[scene];
        let way = Way { from: (system, &found), to: (&reference.system, &reference.modes) };
        let links = identify(&BatchSolver, way, work)?;
        let mut unstable = BTreeMap::new();
        for (lambda, link) in lambdas.into_iter().zip(links) {
            for name in link.into_iter().flat_map(|to| reference.names[to].iter().copied()) {
                unstable.entry(name).or_insert(lambda);
            }
        }
        Ok(Self { oscillatory, unstable })
    }

    /// The decaying mode next to `lambda`.
    pub fn nearest(&self, lambda: Complex<f64>) -> Complex<f64> {
        let decaying = self.oscillatory.iter().copied().filter(|other| other.re <= 0.0);
        decaying.min_by(|a, b| (a - lambda).norm().total_cmp(&(b - lambda).norm())).unwrap_or(-lambda.conj())
    }
}
