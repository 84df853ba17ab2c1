//! Samples by the quantile functions of the friction parameters.

use super::{FrictionDraw, LatticeSample};
use crate::case::{LatticeCase, Law};
use crate::estimators::quantile;

/// The sample at a point of the unit cube; the parameters that matter most take the first, best distributed dimensions.
pub(super) fn sample(case: &LatticeCase, law: Law, uniform: &dyn Fn(u32) -> f64) -> LatticeSample {
    let from = &case.friction;
    let mut draw: FrictionDraw = *LatticeSample::median(case).contact(0);
    if law == Law::AmontonsCoulomb {
        draw.mu = quantile(from.mu, uniform(0));
        return LatticeSample::shared(draw, uniform(1));
    }
    draw.mu_k = quantile(from.mu_k, uniform(0));
    draw.mu_s = quantile(from.mu_s, uniform(2)).max(draw.mu_k);
    draw.lateral_mu = quantile(from.mu, uniform(3));
    if law == Law::VelocityDependent {
        draw.alpha = quantile(from.alpha, uniform(4));
    } else {
        draw.v_s = quantile(from.v_s, uniform(5));
        draw.sigma0 = quantile(from.sigma0, uniform(6));
        draw.sigma1 = quantile(from.sigma1, uniform(7));
        draw.sigma2 = quantile(from.sigma2, uniform(8));
    }
    LatticeSample::shared(draw, uniform(1))
}
