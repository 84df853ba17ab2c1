//! Loss factors of a reduced brake. Above the real axis its stiffness is `K + i H` with them, which no real system has; where one is needed, dashpots stand
//! for H that have its loss in every mode of the brake at one point ([`cea::RealModes::equivalent_dashpots`]).
//!
//! The modes with these dashpots are the first guess of the modes with H, to which inverse iteration on both sides leads:
//!
//! ```text
//! T(lambda) = Q(lambda) - lambda sum_t theta_t D_t + i sum_t theta_t eta_t K_t
//! ```
//!
//! with the dashpots D_t of a term t, which are in C. Where a guess does not lead to a mode of its own all eigenvalues of T are found.

use cea::{RealModes, Workspace};
use linsys::{AffineSystem, OperatingPoint, SecondOrder, Term};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use sparse::SparseAffineSystem;

use super::inverse_iteration::{Nonlinear, Pair, have_merged};
use super::residual::{largest_residual, reduced_residual};
use super::{dense, split};
use crate::ReductionError;

/// Factor from the largest distance of a mode with dashpots from that with H, at the points where it was measured, to the distance that is assumed; chosen.
const MORE_DISTANCE: f64 = 10.0;
/// Largest change of an eigenvalue by the last iteration, relative to |lambda|; chosen: what is left is of the order of its square.
const SETTLED: f64 = 1e-9;
/// Farthest that a guess leads, relative to |lambda|; chosen: modes that grow fast, whose verdict is not in question, move by a hundredth.
const FARTHEST: f64 = 0.05;
/// Largest |Re lambda|, as a part of |lambda|, of a mode whose verdict dashpots may change; chosen: what is damped or grows by more has dashpots that lose
/// otherwise, and the same verdict.
const NEXT_TO_AXIS: f64 = 0.03;
/// Most inverse iterations of one mode; chosen: a guess has two digits or more, and next to other modes the first steps gain little.
const MOST_ITERATIONS: usize = 10;

/// Loss factors of the terms of a reduced brake, with the dashpots that stand for them.
#[derive(Debug, Clone)]
pub struct Losses {
    terms: Vec<LossyTerm>,
    /// Distance, relative to |lambda|, that is assumed of a mode next to the axis with dashpots from that with H: ten times the largest that was measured.
    error: f64,
}

/// A term with a loss factor.
#[derive(Debug, Clone)]
struct LossyTerm {
    /// Index of the term.
    term: usize,
    /// Loss factor eta.
    factor: f64,
    /// Dashpots D at a coefficient of one, k x k.
    dashpots: DMatrix<f64>,
}

/// Both sums at an operating point: the dashpots `sum theta D` that are in C, and H, k x k.
pub(super) struct LossesAt {
    dashpots: DMatrix<f64>,
    structural: DMatrix<f64>,
}

impl Losses {
    /// The losses of a system in its projection `reduced`, term by term, with dashpots made from the real modes at a point; `None` where no term has a loss
    /// factor.
    ///
    /// # Errors
    /// A point of another system, a structure that has no real modes there.
    pub fn new(
        system: &SparseAffineSystem,
        reduced: &AffineSystem,
        at: &OperatingPoint,
    ) -> Result<Option<Self>, ReductionError> {
        if !system.is_structurally_damped() {
            return Ok(None);
        }
        let SecondOrder { m, k, .. } = reduced.structure(&at.coefficients)?;
        let modes = RealModes::new(&m, &k).map_err(|source| ReductionError::NoDashpots { source })?;
        let lossy = system.terms().iter().zip(reduced.terms()).enumerate().filter(|(_, (term, _))| term.loss > 0.0);
        let terms = lossy.map(|(at, (term, own))| LossyTerm {
            term: at,
            factor: term.loss,
            dashpots: modes.equivalent_dashpots(&own.matrices().k) * term.loss,
        });
        Ok(Some(Self { terms: terms.collect(), error: 0.0 }))
    }

    /// The reduced brake with the dashpots.
    ///
    /// # Errors
    /// Another brake.
    pub fn with_dashpots(&self, reduced: &AffineSystem) -> Result<AffineSystem, ReductionError> {
        self.with_times(1.0, reduced)
    }

    /// Eigenvalues with loss factors, rad/s, above the real axis, at a point: all of them, by a whole spectrum. `reduced` is the brake that has the
    /// dashpots ([`Losses::with_dashpots`]); H takes their place.
    ///
    /// # Errors
    /// A point of another system, a mass matrix that is singular.
    pub fn eigenvalues(
        &self,
        reduced: &AffineSystem,
        point: &OperatingPoint,
    ) -> Result<Vec<Complex<f64>>, ReductionError> {
        let all = self.at(reduced, point).spectrum(&reduced.assemble(point)?)?;
        Ok(all.into_iter().map(|(lambda, _)| lambda).filter(|lambda| lambda.im > 0.0).collect())
    }

    /// `reduced`, a brake that has the dashpots, without them.
    pub(super) fn without_dashpots(&self, reduced: &AffineSystem) -> Result<AffineSystem, ReductionError> {
        self.with_times(-1.0, reduced)
    }

    fn with_times(&self, factor: f64, reduced: &AffineSystem) -> Result<AffineSystem, ReductionError> {
        let mut terms = reduced.terms().to_vec();
        for LossyTerm { term, dashpots, .. } in &self.terms {
            let own = &terms[*term];
            let mut matrices = own.matrices().clone();
            matrices.c += dashpots * factor;
            terms[*term] = Term::new(own.name.clone(), own.family.clone(), matrices)?;
        }
        Ok(AffineSystem::new(terms, reduced.channels().to_vec())?)
    }

    /// The losses on a smaller basis W, k x w.
    pub(super) fn projected(&self, columns: &DMatrix<f64>) -> Self {
        let onto = columns.transpose();
        let term = |own: &LossyTerm| LossyTerm {
            dashpots: dense::product(&onto, &dense::product(&own.dashpots, columns)),
            ..*own
        };
        Self { terms: self.terms.iter().map(term).collect(), ..*self }
    }

    /// Coefficients of the terms times their loss factors.
    pub(super) fn factors(&self, coefficients: &[f64]) -> Vec<f64> {
        let mut factors = vec![0.0; coefficients.len()];
        self.terms.iter().for_each(|own| factors[own.term] = coefficients[own.term] * own.factor);
        factors
    }

    /// The losses of a brake at a point that belongs to it.
    pub(super) fn at(&self, reduced: &AffineSystem, point: &OperatingPoint) -> LossesAt {
        let zero = || DMatrix::zeros(reduced.order(), reduced.order());
        let (mut dashpots, mut structural) = (zero(), zero());
        for own in &self.terms {
            let theta = point.coefficients[own.term];
            dashpots += &own.dashpots * theta;
            structural += &reduced.terms()[own.term].matrices().k * (theta * own.factor);
        }
        LossesAt { dashpots, structural }
    }

    /// Distance, relative to |lambda|, that is assumed of a mode next to the axis with dashpots from that with H.
    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// The same losses, with the largest distance, relative to |lambda|, that was measured.
    pub(super) fn measured(self, distance: f64) -> Self {
        Self { error: MORE_DISTANCE * distance, ..self }
    }

    /// The largest distance of a mode with the dashpots from the same mode with H, relative to |lambda| and to first order, among the eigenvalues `lambdas`
    /// that are next to the imaginary axis: `|y^T (i H - lambda D) x / (lambda y^T Q'(lambda) x)|`, with vectors x of the brake and y of the transposed brake;
    /// 0 where no eigenvalue is next to the axis.
    pub(super) fn distance(
        &self,
        (reduced, point, system): (&AffineSystem, &OperatingPoint, &SecondOrder),
        lambdas: &[Complex<f64>],
    ) -> Result<f64, ReductionError> {
        let at = self.at(reduced, point);
        let is_next_to_axis = |lambda: &Complex<f64>| lambda.re.abs() <= NEXT_TO_AXIS * lambda.norm();
        let lambdas: Vec<Complex<f64>> = lambdas.iter().copied().filter(is_next_to_axis).collect();
        let mut work = Workspace::default();
        let right = cea::right_vectors(system, &lambdas, &mut work)?;
        let left = cea::right_vectors(&system.transposed(), &lambdas, &mut work)?;
        let mut largest = 0.0;
        for ((&lambda, x), y) in lambdas.iter().zip(&right).zip(&left) {
            let lost = linsys::real_times_complex(&at.structural, x) * Complex::I
                - linsys::real_times_complex(&at.dashpots, x) * lambda;
            let own = (y.dot(&lost) / (lambda * y.dot(&system.derivative_times(lambda, x)))).norm();
            largest = largest_residual([largest, own]);
        }
        Ok(largest)
    }
}

impl LossesAt {
    /// Adds `(i H - lambda_j D) y_j` to split columns, y split.
    pub fn add_images(&self, out: &mut DMatrix<f64>, lambdas: &[Complex<f64>], y: &DMatrix<f64>) {
        split::add_times_i(out, &dense::product(&self.structural, y));
        let zero = DMatrix::zeros(out.nrows(), out.ncols());
        *out -= split::combined([&zero, &dense::product(&self.dashpots, y)], zero.clone(), lambdas);
    }

    /// T(lambda) of a system with dashpots.
    fn dynamic_stiffness(&self, system: &SecondOrder, lambda: Complex<f64>) -> DMatrix<Complex<f64>> {
        let mut q = system.dynamic_stiffness(lambda);
        q.zip_zip_apply(&self.structural, &self.dashpots, |q, h, d| *q += Complex::new(0.0, h) - lambda * d);
        q
    }

    /// The modes with H that `guesses`, modes of a system with dashpots, lead to; `None` where one of them does not settle, or settles far away, or two end at
    /// the same.
    pub fn led_from_guesses(&self, system: &SecondOrder, guesses: &[Pair]) -> Option<Vec<Pair>> {
        let problem = Nonlinear {
            matrix: |lambda| self.dynamic_stiffness(system, lambda),
            image: |lambda, x: &DVector<Complex<f64>>| {
                let x = split::from_columns(&DMatrix::from_columns(std::slice::from_ref(x)));
                let mut image = reduced_residual(system, &[lambda], &x);
                self.add_images(&mut image, &[lambda], &x);
                split::vector(&image, 0)
            },
            slope: |lambda, x: &DVector<Complex<f64>>| {
                system.derivative_times(lambda, x) - linsys::real_times_complex(&self.dashpots, x)
            },
        };
        let led_from = |guess: &Pair| {
            problem
                .led_from(guess.clone(), (FARTHEST, MOST_ITERATIONS), |lambda, _, step| step <= SETTLED * lambda.norm())
        };
        let found = guesses.iter().map(led_from).collect::<Option<Vec<Pair>>>()?;
        (!have_merged(&found)).then_some(found)
    }

    /// All eigenvalues of T, of a system with dashpots, with shapes: with both signs of Im lambda, though only eigenvalues above the real axis are meant.
    ///
    /// # Errors
    /// A mass matrix that is singular.
    pub fn spectrum(&self, system: &SecondOrder) -> Result<Vec<Pair>, ReductionError> {
        let (n, s) = (system.order(), system.states());
        let c = &system.c - &self.dashpots;
        let inverse = dense::solve_real(&system.m, &DMatrix::identity(n, n))?;
        // In units of the highest frequencies, so that rounding of their squares is not in all entries.
        let unit = (&inverse * &system.k).amax().sqrt();
        let stiffness = (&inverse * &system.k).zip_map(&(&inverse * &self.structural), Complex::new);
        let complex = |a: DMatrix<f64>| a.map(Complex::from);
        let mut companion = DMatrix::zeros(2 * n + s, 2 * n + s);
        companion.view_mut((0, n), (n, n)).fill_with_identity();
        companion.view_mut((n, 0), (n, n)).copy_from(&(stiffness / Complex::from(-unit * unit)));
        companion.view_mut((n, n), (n, n)).copy_from(&complex(&inverse * c / -unit));
        companion.view_mut((n, 2 * n), (n, s)).copy_from(&complex(&inverse * &system.internal.force / (unit * unit)));
        companion.view_mut((2 * n, n), (s, n)).copy_from(&complex(system.internal.drive.clone()));
        system
            .internal
            .decay
            .iter()
            .enumerate()
            .for_each(|(at, decay)| companion[(2 * n + at, 2 * n + at)] = Complex::from(-decay / unit));
        let (lambdas, vectors) = dense::eigen_complex(&companion)?;
        let pair = |(lambda, vector): (&Complex<f64>, nalgebra::DVectorView<'_, Complex<f64>>)| {
            (lambda * unit, vector.rows(0, n).normalize())
        };
        Ok(lambdas.iter().zip(vectors.column_iter()).map(pair).collect())
    }
}
