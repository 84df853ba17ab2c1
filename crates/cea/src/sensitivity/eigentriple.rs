//! An eigenvalue with both of its vectors.

use linsys::{SecondOrder, form_of_sizes};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::dense::size;
use crate::{CeaError, Workspace, left_vector, right_vector};

/// Bound of the rounding error of one evaluation of `Q(lambda) x`, in units of epsilon times the norms of its terms; chosen.
const ROUNDINGS: f64 = 8.0;
/// Largest part of a derivative that may be rounding; chosen: three digits are left.
const LARGEST_BLUR: f64 = 1e-3;
/// Largest relative change of an eigenvalue that [`Eigentriple::of_neighbour`] ends with at once; chosen: some roundings.
const SETTLED: f64 = 1e-14;
/// Largest relative change that it ends with if the change does not fall any more, as it then is of rounding errors; chosen.
const ROUNDING: f64 = 1e-9;
/// Most iterations; chosen: convergence is cubic, and a guess that needs more is near another mode.
const MOST_ITERATIONS: usize = 8;

/// An eigenvalue lambda with its right vector x and left vector y: `Q(lambda) x = 0`, `y^H Q(lambda) = 0`.
///
/// ```
/// use cea::{Eigentriple, Workspace};
/// use linsys::SecondOrder;
/// use nalgebra::dmatrix;
/// use num_complex::Complex;
///
/// // 2 kg on a spring of 50 N/m and a dashpot of 4 Ns/m: lambda = -1 + i sqrt(24).
/// let system = SecondOrder::new(dmatrix![2.0], dmatrix![4.0], dmatrix![50.0])?;
/// let triple = Eigentriple::new(&system, Complex::new(-1.0, 24_f64.sqrt()), &mut Workspace::default())?;
/// // Another Ns/m damps by 1 / (2 m) = 0.25 1/s more.
/// let dashpot = SecondOrder::new(dmatrix![0.0], dmatrix![1.0], dmatrix![0.0])?;
/// let rate = triple.rate(&dashpot.dynamic_stiffness(triple.lambda));
/// assert!((rate.re + 0.25).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Eigentriple {
    /// Eigenvalue lambda, rad/s.
    pub lambda: Complex<f64>,
    /// Right eigenvector x, length n, unit 2-norm.
    pub right: DVector<Complex<f64>>,
    /// Left eigenvector y, length n, unit 2-norm.
    pub left: DVector<Complex<f64>>,
    /// Slope `y^H Q'(lambda) x`: 0 where lambda is defective.
    pub slope: Complex<f64>,
    /// `|lambda|^2 |M| + |lambda| |C| + |K|` and the terms of internal states.
    pub(super) size: f64,
}

impl Eigentriple {
    /// The vectors of an eigenvalue that is known; two factorisations of `Q(lambda)`.
    ///
    /// # Errors
    /// [`CertifiedError::NoEigenvector`](crate::CertifiedError::NoEigenvector) where `lambda` is not an eigenvalue to working precision.
    pub fn new(system: &SecondOrder, lambda: Complex<f64>, work: &mut Workspace) -> Result<Self, CeaError> {
        Ok(Self::of_vectors(system, lambda, right_vector(system, lambda, work)?, left_vector(system, lambda, work)?))
    }

    /// The eigentriple of an eigenvalue and vectors that are known, length n, unit 2-norm; none of it is checked.
    #[must_use]
    pub fn of_vectors(
        system: &SecondOrder,
        lambda: Complex<f64>,
        right: DVector<Complex<f64>>,
        left: DVector<Complex<f64>>,
    ) -> Self {
        let slope = left.dotc(&(system.dynamic_stiffness_derivative(lambda) * &right));
        Self { lambda, right, left, slope, size: size(system, lambda) }
    }

    /// The eigentriple of another system next to `guess`, rad/s, with vectors like these, by two-sided Rayleigh iteration (Ostrowski 1959,
    /// for `Q(lambda)`: Schreiber 2008); `None` where that does not converge.
    #[must_use]
    pub fn of_neighbour(&self, system: &SecondOrder, guess: Complex<f64>) -> Option<Self> {
        let (mut lambda, mut vectors) = (guess, [self.right.clone(), self.left.clone()]);
        let mut last = f64::INFINITY;
        for iteration in 0..MOST_ITERATIONS {
            let [right, left] = &vectors;
            let (q, slope) = matrices(system, lambda);
            let step = left.dotc(&(&q * right)) / left.dotc(&(&slope * right));
            lambda -= step;
            let change = step.norm() / lambda.norm();
            // With the vectors of the other system the first step says nothing: it may be zero though lambda is no eigenvalue.
            if iteration > 0 && (change <= SETTLED || (change <= ROUNDING && change >= last)) {
                let [right, left] = vectors;
                return Some(Self::of_vectors(system, lambda, right, left));
            }
            last = change;
            // At an eigenvalue that is exact there is nothing to solve: a little beside it the vectors are the same.
            vectors =
                iterated(system, lambda, &vectors).or_else(|| iterated(system, lambda * (1.0 + ROUNDING), &vectors))?;
        }
        None
    }

    /// Rate `d lambda / d p = -y^H Q_p x / y^H Q' x` for a given `Q_p = d Q / d p` at lambda, n x n.
    ///
    /// Not finite where lambda is defective; [`Eigentriple::separation`] tells whether it can be believed.
    #[must_use]
    pub fn rate(&self, derivative: &DMatrix<Complex<f64>>) -> Complex<f64> {
        self.rate_over(derivative, 1.0)
    }

    /// Rate of lambda, as by [`Eigentriple::rate`], for the difference of Q(lambda), n x n, of two systems whose parameters are `distance` apart.
    #[must_use]
    pub fn rate_over(&self, difference: &DMatrix<Complex<f64>>, distance: f64) -> Complex<f64> {
        -self.left.dotc(&(difference * &self.right)) / (self.slope * distance)
    }

    /// The eigenvalue after one Newton step with these vectors, the generalised Rayleigh quotient, rad/s.
    #[must_use]
    pub fn refined(&self, system: &SecondOrder) -> Complex<f64> {
        let residual = self.left.dotc(&(system.dynamic_stiffness(self.lambda) * &self.right));
        self.lambda - residual / self.slope
    }

    /// Bound of the error of lambda by rounding, rad/s, to first order: eight roundings of the size of the terms of Q, over
    /// `|y^H Q' x|`.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        ROUNDINGS * f64::EPSILON * self.size / self.slope.norm()
    }

    /// Bound of the error of lambda by a rounding of each entry of the matrices, rad/s, to first order: as [`Eigentriple::rounding`] with
    /// `|y|^T (|lambda|^2 |M| + |lambda| |C| + |K|) |x|` in place of the norms, which no scaling of rows and columns changes.
    #[must_use]
    pub fn rounding_of_entries(&self, system: &SecondOrder) -> f64 {
        let of = |matrix| form_of_sizes(matrix, &self.left, &self.right);
        let (abs, internal) = (self.lambda.norm(), &system.internal);
        let of_state = |state: usize| {
            let driven: f64 =
                internal.drive.row(state).iter().zip(&self.right).map(|(entry, x)| entry.abs() * x.norm()).sum();
            let forced: f64 =
                internal.force.column(state).iter().zip(&self.left).map(|(entry, y)| entry.abs() * y.norm()).sum();
            driven * forced * abs / (self.lambda + internal.decay[state]).norm()
        };
        let of_states: f64 = (0..system.states()).map(of_state).sum();
        let size = (of(&system.m) * abs + of(&system.c)) * abs + of(&system.k) + of_states;
        ROUNDINGS * f64::EPSILON * size / self.slope.norm()
    }

    /// The relative condition number, `(|lambda|^2 |M| + |lambda| |C| + |K|) / (|lambda| |y^H Q' x|)` with unit vectors and Frobenius
    /// norms (Tisseur, Linear Algebra Appl. 309, 2000): the relative change of lambda over the relative change of the matrices.
    #[must_use]
    pub fn condition(&self) -> f64 {
        self.size / (self.lambda.norm() * self.slope.norm())
    }

    /// Cosine `|x^H z|` of the right vectors of two eigentriples: 1 where they are parallel.
    #[must_use]
    pub fn likeness(&self, other: &Self) -> f64 {
        self.right.dotc(&other.right).norm()
    }

    /// Distance from the other eigenvalues; `spectrum` has to contain all of the system, this one included.
    #[must_use]
    pub fn separation(&self, spectrum: &[Complex<f64>]) -> Separation {
        let distance = |other: &Complex<f64>| (other - self.lambda).norm();
        // The nearest one is the eigenvalue itself.
        let (mut itself, mut nearest) = (f64::INFINITY, f64::INFINITY);
        for distance in spectrum.iter().map(distance) {
            if distance < itself {
                (itself, nearest) = (distance, itself);
            } else {
                nearest = nearest.min(distance);
            }
        }
        let blur = self.rounding() / nearest;
        // Two infinities make no number, and no derivative either.
        Separation { nearest, blur: if blur.is_nan() { f64::INFINITY } else { blur } }
    }
}

/// Q and its derivative at lambda.
fn matrices(system: &SecondOrder, lambda: Complex<f64>) -> (DMatrix<Complex<f64>>, DMatrix<Complex<f64>>) {
    (system.dynamic_stiffness(lambda), system.dynamic_stiffness_derivative(lambda))
}

/// The right and the left vector after one step of inverse iteration at lambda; `None` where Q is singular.
fn iterated(
    system: &SecondOrder,
    lambda: Complex<f64>,
    [right, left]: &[DVector<Complex<f64>>; 2],
) -> Option<[DVector<Complex<f64>>; 2]> {
    let (q, slope) = matrices(system, lambda);
    let left = unit(q.adjoint().lu().solve(&slope.ad_mul(left))?)?;
    Some([unit(q.lu().solve(&(&slope * right))?)?, left])
}

fn unit(vector: DVector<Complex<f64>>) -> Option<DVector<Complex<f64>>> {
    let norm = vector.norm();
    (norm.is_finite() && norm > 0.0).then(|| vector.unscale(norm))
}

/// Separation: the distance of an eigenvalue from the next one, and what that leaves of its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Distance of the next eigenvalue, rad/s; infinite where there is no other eigenvalue.
    pub nearest: f64,
    /// The part of a derivative that may be rounding: the error that the eigenvalue may have by rounding, over that distance.
    pub blur: f64,
}

impl Separation {
    /// True if the eigenvalue is simple as far as can be told, so that its derivatives exist and keep three digits or more. Two
    /// eigenvalues that are nearer coalesce, or are equal by a symmetry.
    #[must_use]
    pub fn is_simple(&self) -> bool {
        self.blur <= LARGEST_BLUR
    }
}
