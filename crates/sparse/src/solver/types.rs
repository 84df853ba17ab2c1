//! Questions to the solver, and its answers.

use cea::Verdict;
use nalgebra::DVector;
use num_complex::Complex;

use crate::SparseError;

/// A rectangle of the plane of lambda, rad/s, its border included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Least and largest Re lambda.
    pub re: [f64; 2],
    /// Least and largest Im lambda.
    pub im: [f64; 2],
}

impl Rectangle {
    /// Checks that the borders are finite and in order.
    ///
    /// # Errors
    /// [`SparseError::Rectangle`].
    pub fn check(&self) -> Result<(), SparseError> {
        for (part, [from, to]) in [("Re lambda", self.re), ("Im lambda", self.im)] {
            if !(from.is_finite() && to.is_finite() && from < to) {
                return Err(SparseError::Rectangle { part, from, to });
            }
        }
        Ok(())
    }

    /// True if lambda is inside or within `margin`, rad/s, of the border.
    #[must_use]
    #[inline]
    pub fn contains(&self, lambda: Complex<f64>, margin: f64) -> bool {
        let within = |x: f64, [from, to]: [f64; 2]| x >= from - margin && x <= to + margin;
        within(lambda.re, self.re) && within(lambda.im, self.im)
    }

    /// True if lambda is in the rectangle extended to Re lambda = infinity, or within `margin`, rad/s, of its border.
    #[must_use]
    #[inline]
    pub fn contains_to_the_right(&self, lambda: Complex<f64>, margin: f64) -> bool {
        Self { re: [self.re[0], f64::INFINITY], im: self.im }.contains(lambda, margin)
    }

    /// Distance of lambda from the border, inside or outside.
    #[must_use]
    pub fn border_distance(&self, lambda: Complex<f64>) -> f64 {
        let nearest = |x: f64, [from, to]: [f64; 2]| (x - from).abs().min((x - to).abs());
        let beyond = |x: f64, [from, to]: [f64; 2]| (from - x).max(x - to).max(0.0);
        let outside = beyond(lambda.re, self.re).hypot(beyond(lambda.im, self.im));
        if outside > 0.0 { outside } else { nearest(lambda.re, self.re).min(nearest(lambda.im, self.im)) }
    }

    /// The rectangle in another unit.
    pub(super) fn times(&self, factor: f64) -> Self {
        Self { re: self.re.map(|x| x * factor), im: self.im.map(|x| x * factor) }
    }

    /// The rectangle with each border moved outwards; a lower border with Im lambda >= 0 is not moved below the real axis.
    pub(super) fn widened(&self, by: f64) -> Self {
        let least = if self.im[0] >= 0.0 { 0.0 } else { f64::NEG_INFINITY };
        Self { re: [self.re[0] - by, self.re[1] + by], im: [(self.im[0] - by).max(least), self.im[1] + by] }
    }

    pub(super) fn centre(&self) -> Complex<f64> {
        let middle = |[from, to]: [f64; 2]| from + 0.5 * (to - from);
        Complex::new(middle(self.re), middle(self.im))
    }

    /// Distance of the centre from a corner.
    pub(super) fn half_diagonal(&self) -> f64 {
        0.5 * (self.re[1] - self.re[0]).hypot(self.im[1] - self.im[0])
    }

    /// The largest |lambda|.
    pub(super) fn reach(&self) -> f64 {
        let largest = |[from, to]: [f64; 2]| from.abs().max(to.abs());
        largest(self.re).hypot(largest(self.im))
    }
}

/// Settings that a user need not touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Backward error below which an eigenpair is not improved further. A search lists a pair that stays above it too, with [`Eigenpair::backward_error`].
    pub tolerance: f64,
    /// Backward error below which a left vector is not improved further. An eigenvalue has an error of the order of the product of both, and a condition number needs few digits.
    pub left_tolerance: f64,
    /// Right-hand sides that are solved together, and so the largest multiplicity that a Krylov space surely shows.
    pub block: usize,
    /// Most columns of a Krylov basis at one shift, at which its disc ends; a check by a second block, and wider blocks for copies of an eigenvalue, may
    /// make it up to four times as large. Memory is two doubles for each degree of freedom and column.
    pub columns: usize,
    /// Most shifts; a rectangle that needs more is refused, as soon as the first ones show it.
    pub shifts: usize,
    /// Most bytes of the vectors found; a rectangle that holds more is refused likewise.
    pub bytes: usize,
    /// Most degrees of freedom of a system whose whole spectrum is certified, by dense matrices, and what is in the rectangle taken from it: nothing is
    /// then searched. 0, the default, for a search in any case; with structural damping there is always a search.
    pub certified: usize,
    /// Most degrees of freedom of a system whose list from a search is counted again by the argument principle, for the price of some ten factorisations a
    /// disc. 0, the default, for a second block of vectors alone, which is also all with structural damping.
    pub counted: usize,
    /// Threads for factors and solutions ([`Problem::with_threads`](crate::Problem::with_threads)); what is found does not depend on them.
    pub threads: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: 1e-11,
            left_tolerance: 1e-9,
            block: 4,
            columns: 220,
            shifts: 2000,
            bytes: 2_000_000_000,
            certified: 0,
            counted: 0,
            threads: 1,
        }
    }
}

/// An eigenvalue with its vectors and what is known about its error.
#[derive(Debug, Clone, PartialEq)]
pub struct Eigenpair {
    /// The eigenvalue, rad/s.
    pub lambda: Complex<f64>,
    /// Right eigenvector phi, length n, unit 2-norm: `Q(lambda) phi = 0`.
    pub right: DVector<Complex<f64>>,
    /// Left eigenvector psi, length n, unit 2-norm: `psi^H Q(lambda) = 0`, to a backward error of [`Options::left_tolerance`].
    pub left: DVector<Complex<f64>>,
    /// Backward error `|Q(lambda) phi| / ((|lambda|^2 |M| + |lambda| |C| + |K|) |phi|)`, Frobenius norms, as [`cea::backward_error`]; with structural
    /// damping |K| is the norm of `K + i H`.
    pub backward_error: f64,
    /// Condition number `(|lambda|^2 |M| + |lambda| |C| + |K|) / (|lambda| |psi^H Q'(lambda) phi|)`, as [`cea::certified::CertifiedEigenvalue::condition`].
    /// Infinite for lambda = 0 and where `psi^H Q'(lambda) phi` is 0, as for a defective eigenvalue.
    pub condition: f64,
    /// Error bound, rad/s: how far the eigenvalue may be from the exact eigenvalue of these matrices or of any matrices that round to them; by
    /// `cea::certified` where the spectrum is certified ([`Options::certified`]), else to first order. Infinite where nothing is known.
    pub bound: f64,
    /// Verdict: whether the motion grows, as far as the bound tells.
    pub verdict: Verdict,
    /// True if the border of the rectangle is within the bound, so that the eigenvalue may be outside.
    pub on_border: bool,
}

/// A disc around a shift in which all eigenvalues are known, as far as its Krylov space shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// The shift, rad/s.
    pub centre: Complex<f64>,
    /// Radius, rad/s: no eigenvalue that has not converged is nearer; a safety factor is in it.
    pub radius: f64,
    /// Eigenvalues in it.
    pub eigenvalues: usize,
    /// Columns of its Krylov basis.
    pub columns: usize,
}

/// Results of a search: all eigenpairs of a rectangle, and why they are all.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The eigenpairs, by frequency as [`cea::by_frequency`] orders them.
    pub pairs: Vec<Eigenpair>,
    /// Discs whose union covers the rectangle as far as `reach` goes; of a rectangle below the real axis they cover its mirror image, and of one on both
    /// sides of it the larger half: the matrices are real. None where `is_certified`.
    pub discs: Vec<Disc>,
    /// Reach of the eigenvalues, where the rectangle is larger and M positive definite: what is beyond has no discs.
    pub reach: Option<Reach>,
    /// True if the pairs are of the whole certified spectrum ([`Options::certified`]), and not of a search.
    pub is_certified: bool,
    /// Second count of the pairs, without regard to how they were found.
    pub count: Count,
    /// The work done.
    pub counters: Counters,
}

/// A second count of the eigenvalues, which agrees with the list; where it does not there is an error in place of a list.
#[derive(Debug, Clone, PartialEq)]
pub enum Count {
    /// The argument principle: how often det Q turns about zero along circles that together contain all that was searched.
    Argument {
        /// The circles.
        circles: Vec<Circle>,
        /// Points of all circles: a factorisation each.
        points: usize,
    },
    /// A second block of vectors at every shift, which found nothing that the first had not.
    SecondBlock,
    /// No count: Q is singular to rounding next to a circle, wherever it was moved, or has no factors whose determinant can be told.
    Unclear,
}

/// A circle along which det Q was evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Centre of the circle, rad/s.
    pub centre: Complex<f64>,
    /// Radius of the circle, rad/s.
    pub radius: f64,
    /// Eigenvalues inside.
    pub eigenvalues: usize,
}

/// Reach of the eigenvalues of a system: how far any can be from zero and from the imaginary axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// The largest |lambda|, rad/s.
    pub modulus: f64,
    /// The largest |Re lambda|, rad/s, at most the modulus.
    pub real: f64,
}

/// Counters of what was computed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Sparse factorisations.
    pub factorisations: usize,
    /// Right-hand sides solved, refinement not counted.
    pub solves: usize,
}

/// Progress of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Fraction of the rectangle that is covered, 0 to 1.
    pub covered: f64,
    /// Eigenvalues found.
    pub found: usize,
    /// Shifts used.
    pub shifts: usize,
}

/// An eigenvalue that is known, and how far it may be off, rad/s: 0 for a Ritz value outside of its disc, of which nothing is known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub(super) lambda: Complex<f64>,
    pub(super) bound: f64,
}

/// Part of the rectangle that a disc covers, and how far around it pairs are listed, rad/s.
pub(super) struct Covered {
    pub(super) part: Rectangle,
    pub(super) margin: f64,
    /// Ritz values of the disc, all of them.
    pub(super) seen: Vec<Known>,
}
