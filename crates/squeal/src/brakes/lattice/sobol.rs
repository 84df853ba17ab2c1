//! Samples by the quantile functions of the friction parameters.

use super::{FrictionDraw, LatticeSample};
use crate::case::{LatticeCase, Law};

/// The sample at a point of the unit cube. The most influential parameters have the first dimensions, in which a Sobol sequence is
/// distributed best.
pub(super) fn sample(case: &LatticeCase, law: Law, uniform: &dyn Fn(u32) -> f64) -> LatticeSample {
    let from = &case.friction;
    let mut draw: FrictionDraw = *LatticeSample::median(case).contact(0);
    if law == Law::AmontonsCoulomb {
        draw.mu = from.mu.quantile(uniform(0));
        return LatticeSample::shared(draw, uniform(1));
    }
    draw.mu_k = from.mu_k.quantile(uniform(0));
    draw.mu_s = from.mu_s.quantile(uniform(2)).max(draw.mu_k);
    draw.lateral_mu = from.mu.quantile(uniform(3));
    if law == Law::VelocityDependent {
        draw.alpha = from.alpha.quantile(uniform(4));
    } else {
        draw.v_s = from.v_s.quantile(uniform(5));
        draw.sigma0 = from.sigma0.quantile(uniform(6));
        draw.sigma1 = from.sigma1.quantile(uniform(7));
        draw.sigma2 = from.sigma2.quantile(uniform(8));
    }
    LatticeSample::shared(draw, uniform(1))
}
