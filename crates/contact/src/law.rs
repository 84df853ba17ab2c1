//! Equilibrium under a law between pressure and overlap, such as `p = c g^m`.

use nalgebra::{DMatrix, DVector};

use crate::equilibrium::{Balance, Equilibrium};
use crate::uniqueness::Uniqueness;
use crate::{Condensed, ContactError, Stiffness};

/// Most steps of Newton's method; chosen: what needs more is refused.
const STEPS: usize = 100;
/// Most halvings of one step; chosen: if nothing gets better after these, what is left is rounding, or is refused.
const HALVINGS: usize = 30;
/// Largest residual at the end, relative to the largest gap; chosen: with less, rounding may not reach it; with more, gaps have fewer digits.
const ENOUGH: f64 = 1e-13;

impl Condensed {
    /// The equilibrium of points of these areas under a law. It begins with the equilibrium of springs of the stiffness that the points were condensed
    /// with, which changes the way and not the result, and goes on by Newton's method.
    ///
    /// # Errors
    /// As [`Condensed::equilibrium`]; numbers of the law that are not allowed, not an area of each point, no convergence.
    pub fn equilibrium_of_law(
        &self,
        balance: &Balance,
        law: &Stiffness,
        areas: &[f64],
    ) -> Result<Equilibrium, ContactError> {
        law.check()?;
        let (found, expected) = (areas.len(), self.points());
        if found != expected {
            return Err(ContactError::Count { what: "areas", found, expected });
        }
        let start = self.equilibrium(balance)?;
        let whole: f64 = areas.iter().sum();
        let pressed = |gaps: &DVector<f64>| {
            let both = gaps.iter().zip(areas).map(|(gap, area)| law.force(*area, whole, -gap));
            let (forces, slopes): (Vec<f64>, Vec<f64>) = both.unzip();
            let slopes = gaps.iter().zip(slopes).map(|(gap, slope)| if *gap < 0.0 { slope } else { 0.0 }).collect();
            (DVector::from_vec(forces), DVector::from_vec(slopes))
        };
        let n = self.points();
        let given = DVector::from_column_slice(&balance.gaps);
        let along = DMatrix::from_fn(n, n, |i, j| self.friction[(i, j)] * balance.mu[j]);
        let spring = &self.normal * DMatrix::from_diagonal(&self.stiffness);
        let still = &given - &spring * &given + &self.loads * DVector::from_column_slice(&balance.loads);
        let with_friction = &self.normal + &along;
        let missing = |gaps: &DVector<f64>| {
            let (forces, slopes) = pressed(gaps);
            (gaps - &still - &spring * gaps - &with_friction * forces, slopes)
        };
        let mut gaps = DVector::from_vec(start.gaps);
        let (mut residual, mut slopes) = missing(&gaps);
        let mut steps = 0;
        loop {
            let size = ENOUGH * gaps.amax().max(given.amax());
            if residual.amax() <= size {
                break;
            }
            let not_found = ContactError::NotFound { steps, residual: residual.amax() / gaps.amax() };
            if steps == STEPS {
                return Err(not_found);
            }
            steps += 1;
            let jacobian = DMatrix::identity(n, n) - &spring + &with_friction * DMatrix::from_diagonal(&slopes);
            let Some(change) = jacobian.lu().solve(&-&residual) else { return Err(not_found) };
            let mut length = 1.0;
            let mut halvings = 0;
            let next = loop {
                let next = &gaps + &change * length;
                let (of_next, slopes) = missing(&next);
                if of_next.norm() < residual.norm() * (1.0 - 1e-4 * length) {
                    break Some((next, of_next, slopes));
                }
                length *= 0.5;
                halvings += 1;
                if halvings == HALVINGS {
                    break None;
                }
            };
            match next {
                Some(next) => (gaps, residual, slopes) = next,
                // Rounding: nothing gets better, and little is missing.
                None if residual.amax() <= 1e3 * size => break,
                None => return Err(not_found),
            }
        }
        // Without friction the forces are the ones of the least energy, which is convex.
        let is_frictionless = balance.mu.iter().all(|mu| *mu == 0.0);
        let uniqueness = if is_frictionless { Uniqueness::Definite } else { Uniqueness::NotDecided };
        let forces = pressed(&gaps).0.as_slice().to_vec();
        Ok(Equilibrium { forces, gaps: gaps.as_slice().to_vec(), uniqueness })
    }
}
