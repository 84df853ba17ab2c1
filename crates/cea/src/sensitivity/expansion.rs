//! Second derivatives of an eigenvalue, and how far the first ones hold.

use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector, Dyn, LU};
use num_complex::Complex;

use super::{Eigentriple, Perturbation};
use crate::{CeaError, Workspace};

/// Largest second order, as a fraction of the first, with which the first is said to hold; chosen: with less, it is said to hold for smaller changes only; with
/// more, also where its error is larger.
const TOLERATED: f64 = 0.1;

/// Derivatives of an eigenvalue by a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rates {
    /// Derivative `d lambda / d p`, rad/s per unit of p: its real part is the derivative of the growth rate, its imaginary part of the angular frequency.
    pub first: Complex<f64>,
    /// Second derivative `d^2 lambda / d p^2`, rad/s per unit of p squared.
    pub second: Complex<f64>,
}

impl Rates {
    /// The largest change of p over which the first order of the eigenvalue holds, as far as the second can tell: there the second order is a tenth of the
    /// first. Infinite where the second derivative is 0.
    #[must_use]
    pub fn holds_to(&self) -> f64 {
        reach(self.first.norm(), self.second.norm())
    }

    /// The largest change of p over which the first order of the growth holds likewise, and never beyond [`Rates::holds_to`]: 0 where the growth has
    /// no first order.
    #[must_use]
    pub fn growth_holds_to(&self) -> f64 {
        reach(self.first.re, self.second.re).min(self.holds_to())
    }

    /// The largest change of p over which the first order of the angular frequency holds likewise, and never beyond [`Rates::holds_to`].
    #[must_use]
    pub fn frequency_holds_to(&self) -> f64 {
        reach(self.first.im, self.second.im).min(self.holds_to())
    }
}

fn reach(first: f64, second: f64) -> f64 {
    if second == 0.0 { f64::INFINITY } else { 2.0 * TOLERATED * (first / second).abs() }
}

/// An eigenvalue prepared for second derivatives by any number of parameters: one factorisation, and one solution for each.
///
/// With `Q x = 0` differentiated twice and multiplied by y^H,
///
/// ```text
/// lambda_pp = -y^H (Q_pp + 2 lambda_p Q_p' + lambda_p^2 Q'') x / s - 2 y^H (Q_p + lambda_p Q') x_p / s,   s = y^H Q' x
/// Q x_p = -(Q_p + lambda_p Q') x,   x^H x_p = 0
/// ```
///
/// where the singular Q is bordered by `Q' x` and x (Andrew, Chu and Lancaster, SIAM J. Matrix Anal. Appl. 14, 1993).
#[derive(Debug, Clone)]
pub struct Expansion<'a> {
    triple: &'a Eigentriple,
    bordered: LU<Complex<f64>, Dyn, Dyn>,
    /// `Q' x`.
    slope_on_right: DVector<Complex<f64>>,
    /// `Q'^H y`.
    slope_on_left: DVector<Complex<f64>>,
    /// `y^H Q'' x`.
    bend: Complex<f64>,
}

impl<'a> Expansion<'a> {
    /// Prepares an eigenvalue of `system`.
    ///
    /// # Errors
    /// [`CeaError::Defective`] where no second derivative exists.
    pub fn new(system: &SecondOrder, triple: &'a Eigentriple, work: &mut Workspace) -> Result<Self, CeaError> {
        let (n, lambda) = (system.order(), triple.lambda);
        let q = system.dynamic_stiffness(lambda);
        let slope = system.dynamic_stiffness_derivative(lambda);
        let (slope_on_right, slope_on_left) = (&slope * &triple.right, slope.ad_mul(&triple.left));
        // The border is scaled to the size of the terms of Q, so that the pivots lose no digits; Q itself may vanish at lambda, as it does with
        // one degree of freedom. The unknown of the border is 0 and needs no scale.
        let size = triple.size;
        let mut bordered = DMatrix::zeros(n + 1, n + 1);
        bordered.view_mut((0, 0), (n, n)).copy_from(&q);
        let column = slope_on_right.scale(size / slope_on_right.norm());
        bordered.view_mut((0, n), (n, 1)).copy_from(&column);
        bordered.view_mut((n, 0), (1, n)).copy_from(&triple.right.adjoint().scale(size));
        work.counters.factorisations += 1;
        let bordered = bordered.lu();
        if !bordered.is_invertible() {
            return Err(CeaError::Defective { lambda });
        }
        let bend = triple.left.dotc(&(system.dynamic_stiffness_second_derivative(lambda) * &triple.right));
        Ok(Self { triple, bordered, slope_on_right, slope_on_left, bend })
    }

    /// First and second derivative by a parameter.
    ///
    /// # Errors
    /// [`CeaError::Defective`] where they are no numbers.
    pub fn rates(&self, by: &Perturbation) -> Result<Rates, CeaError> {
        let Eigentriple { lambda, slope, .. } = *self.triple;
        let first = by.rate(self.triple);
        let right = -(&by.on_right + &self.slope_on_right * first);
        let n = right.len();
        let defective = || CeaError::Defective { lambda };
        let change = self.bordered.solve(&right.push(Complex::default())).ok_or_else(defective)?.remove_row(n);
        let direct = by.by_itself + 2.0 * first * by.by_lambda + first * first * self.bend;
        let through_shape = by.on_left.dotc(&change) + first * self.slope_on_left.dotc(&change);
        let rates = Rates { first, second: -(direct + 2.0 * through_shape) / slope };
        match rates.second.is_finite() {
            true => Ok(rates),
            false => Err(defective()),
        }
    }
}
