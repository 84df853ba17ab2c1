//! Which eigenvalue at one mu continues which at another.
//!
//! From both ends of a step the tangents are drawn to its middle. Those of one analytic branch meet there up to the third
//! order of the step and differ in direction by its first; those of different branches do not, also where the
//! eigenvalues cross. A link is clear where its tangents meet far better than those of any rival; a step without a clear
//! link is halved.

use std::collections::BTreeSet;

use num_complex::Complex;

use super::{EstimatorError, OneParameterFamily};

/// Largest cost of a clear link, as a part of that of its best rival; chosen.
const CLEAR_LINK_COST: f64 = 0.25;
/// Shortest step in mu: what is still open there stays open; chosen.
pub(super) const SMALLEST_STEP: f64 = 1e-10;

/// How an eigenvalue continues over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// Index at the other end.
    pub to: usize,
    /// By how much the tangents miss each other, rad/s.
    pub miss: f64,
    /// Whether no other link comes near.
    pub is_clear: bool,
}

impl OneParameterFamily<'_> {
    /// The best link of the mode `index` at `a` to a mode at `b`.
    ///
    /// # Errors
    /// Those of [`OneParameterFamily::lambdas`].
    pub fn link(&mut self, a: f64, index: usize, b: f64) -> Result<Link, EstimatorError> {
        let from = self.point(a, index)?;
        let (best, second) = self.two_best(from, a, b)?;
        let back = self.point(b, best.0)?;
        let (_, rival) = self.two_best(back, b, a)?;
        let is_clear = best.1 <= CLEAR_LINK_COST * second.min(rival) && self.two_best(back, b, a)?.0.0 == index;
        Ok(Link { to: best.0, miss: best.1, is_clear })
    }

    /// The mode at `b` that costs least as a continuation of `from`, its cost and that of the second best.
    fn two_best(
        &mut self,
        from: (Complex<f64>, Complex<f64>),
        a: f64,
        b: f64,
    ) -> Result<((usize, f64), f64), EstimatorError> {
        let h = b - a;
        let reach = from.0 + from.1 * (0.5 * h);
        // Only modes near the tangent can win; the others are spared their derivatives.
        let mut near: Vec<(usize, f64)> =
            self.spectrum(b)?.lambdas.iter().enumerate().map(|(j, l)| (j, (l - reach).norm())).collect();
        near.sort_by(|x, y| x.1.total_cmp(&y.1));
        let (mut best, mut second) = ((usize::MAX, f64::INFINITY), f64::INFINITY);
        for &(j, _) in near.iter().take(4) {
            let cost = miss(from, self.point(b, j)?, h);
            if cost < best.1 {
                second = best.1;
                best = (j, cost);
            } else {
                second = second.min(cost);
            }
        }
        Ok((best, second))
    }

    /// The modes at `b` that the mode `index` at `a` may have become: one, unless a coalescence lies too near the way.
    pub(super) fn follow(&mut self, a: f64, index: usize, b: f64) -> Result<BTreeSet<usize>, EstimatorError> {
        let mut way = self.between(a.min(b), a.max(b));
        if a > b {
            way.reverse();
        }
        let mut now = BTreeSet::from([index]);
        for step in way.windows(2) {
            let mut next = BTreeSet::new();
            for &index in &now {
                next.extend(self.step(step[0], index, step[1])?);
            }
            now = next;
        }
        Ok(now)
    }

    fn step(&mut self, a: f64, index: usize, b: f64) -> Result<BTreeSet<usize>, EstimatorError> {
        let link = self.link(a, index, b)?;
        if link.is_clear {
            return Ok(BTreeSet::from([link.to]));
        }
        if (b - a).abs() <= SMALLEST_STEP {
            let from = self.point(a, index)?;
            let mut open = BTreeSet::from([link.to]);
            for j in 0..self.spectrum(b)?.lambdas.len() {
                let far = (self.spectrum(b)?.lambdas[j] - from.0).norm()
                    > link.miss / CLEAR_LINK_COST + from.1.norm() * (b - a).abs();
                if !far && miss(from, self.point(b, j)?, b - a) <= link.miss / CLEAR_LINK_COST {
                    open.insert(j);
                }
            }
            return Ok(open);
        }
        let middle = 0.5 * (a + b);
        self.spectrum(middle)?;
        self.follow(a, index, b)
    }
}

/// By how much the tangents at both ends of a step of length `h` miss each other, in place and in direction.
fn miss(from: (Complex<f64>, Complex<f64>), to: (Complex<f64>, Complex<f64>), h: f64) -> f64 {
    let gap = from.0 + from.1 * (0.5 * h) - (to.0 - to.1 * (0.5 * h));
    gap.norm() + 0.25 * (to.1 - from.1).norm() * h.abs()
}
