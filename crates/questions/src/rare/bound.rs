//! A bound of the probability of squeal that rests on no sample: where the certificate of the scene holds, nothing grows.

use linsys::OperatingPoint;
use study::{Certificate, DrawnInputs, Scene, UncertainBrake};

/// Steps between the ends of the distribution of the parameter, each of which is certified as a whole or in parts from its ends; chosen.
const VALUES: usize = 256;
/// Halvings of a step that is not certified as a whole; chosen: to the last digits that matter.
const HALVINGS: usize = 40;
/// Places within a step at which friction has to be what a straight line between its ends says, as parts of the step; chosen: no fractions that a
/// period of the step has in common.
const PLACES: [f64; 3] = [0.236_068, 0.5, 0.618_034];
/// Largest distance from that line, relative; chosen: rounding.
const STRAIGHT: f64 = 1e-12;

/// Standard deviations by which a certified range is shortened at its ends; chosen: above the rounding of quantiles at the deviations that are looked at.
const SHORTENED: f64 = 1e-6;

/// Certified bound of the probability of squeal.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct CertifiedBound {
    /// Ranges of the parameter in which every system is certified to be stable.
    pub stable: Vec<[f64; 2]>,
    /// Probability of all other values, which the probability of squeal does not exceed.
    pub probability: f64,
}

impl CertifiedBound {
    /// The ranges as standard deviations of the coordinate whose quantiles the parameter's values are, a little shortened for rounding.
    pub(super) fn deviations(&self, cumulative: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
        let deviation = |value: f64| match cumulative(value) {
            p if p <= 0.0 => f64::NEG_INFINITY,
            p if p >= 1.0 => f64::INFINITY,
            p => -::rare::tail_point(p),
        };
        let ranges = self.stable.iter().map(|&[from, to]| [deviation(from) + SHORTENED, deviation(to) - SHORTENED]);
        ranges.filter(|[from, to]| from < to).collect()
    }
}

/// The bound of a scene that depends on one parameter; `None` where it depends on more, or nothing is certified.
///
/// Steps are certified as a whole, not at their ends: both ends lie in one ellipse of the certificate, and what is between them on a straight line does
/// too. That friction follows the parameter on a straight line is known of a coefficient of friction that is the parameter itself, and asked at some places
/// of each step where it is an expression.
pub(super) fn certified<B: UncertainBrake>(
    brake: &B,
    scene: &Scene,
    drawn: &dyn DrawnInputs<B::Sample>,
    certificate: &Certificate,
) -> Option<CertifiedBound> {
    let single = drawn.single_parameter(scene)?;
    let (from, to) = single.distribution.support();
    let point = |value: f64| brake.operating_point(scene, &single.sample(value)).ok();
    let is_stable = |value: f64| point(value).is_some_and(|at| certificate.covers(&at));
    let is_stable_between = |a: f64, b: f64| {
        let Some((first, last)) = point(a).zip(point(b)) else { return false };
        let is_on_line = |part: f64| point(a + part * (b - a)).is_some_and(|at| is_between([&first, &last], part, &at));
        certificate.covers_line([&first, &last]) && PLACES.into_iter().all(is_on_line)
    };
    // How far towards the other end of its step a certified value reaches.
    let reach = |value: f64, other: f64| {
        if is_stable_between(value, other) {
            return other;
        }
        let (mut inside, mut outside) = (value, other);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if is_stable_between(value, middle) { inside = middle } else { outside = middle }
        }
        inside
    };
    let values: Vec<f64> = (0..=VALUES).map(|i| from + (to - from) * i as f64 / VALUES as f64).collect();
    let mut stable: Vec<[f64; 2]> = Vec::new();
    for step in values.windows(2) {
        let upwards = is_stable(step[0]).then(|| [step[0], reach(step[0], step[1])]);
        let downwards = is_stable(step[1]).then(|| [reach(step[1], step[0]), step[1]]);
        for [start, end] in upwards.into_iter().chain(downwards) {
            match stable.last_mut() {
                Some(last) if start <= last[1] => last[1] = last[1].max(end),
                _ => stable.push([start, end]),
            }
        }
    }
    // Below the smallest value that matters nothing is asked: that is left out, as it is at most 1e-12.
    stable.retain(|[start, end]| start < end);
    let inside = |[from, to]: &[f64; 2]| single.distribution.cumulative(*to) - single.distribution.cumulative(*from);
    let certified: f64 = stable.iter().map(inside).sum();
    (!stable.is_empty()).then(|| CertifiedBound { probability: (1.0 - certified).clamp(0.0, 1.0), stable })
}

/// True if an operating point is, to rounding, that part of the straight line between two.
fn is_between([first, last]: [&OperatingPoint; 2], part: f64, at: &OperatingPoint) -> bool {
    let is_on = |a: f64, b: f64, x: f64| (a + part * (b - a) - x).abs() <= STRAIGHT * (a.abs() + b.abs());
    let ends = first.channels.iter().zip(&last.channels);
    at.coefficients == first.coefficients
        && at.channels.len() == first.channels.len()
        && ends
            .zip(&at.channels)
            .all(|((a, b), x)| is_on(a.mu, b.mu, x.mu) && is_on(a.slope, b.slope, x.slope) && x.lag == a.lag)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use brakes::MatricesBrake;
    use brakes::case::MatricesCase;
    use cea::BatchSolver;
    use study::Study;

    use super::*;

    /// The certified bound of Hoffmann's oscillator, which flutters from `mu = 0.885`, with mu an expression of x, uniform from 0 to 1.
    fn bound(mu: &str) -> Option<CertifiedBound> {
        let text = format!(
            "[study]\nname = \"Hoffmann\"\nsamples = 100\nseed = 1\n[brake]\nkind = \"matrices\"\ndofs = [\"x\", \"y\"]\n\
             [parameters.x]\ndistribution = \"uniform\"\nfrom = 0.0\nto = 1.0\n\
             [[terms]]\nname = \"all\"\nmass = [[1.0, 0.0], [0.0, 1.0]]\ndamping = [[0.3, 0.0], [0.0, 0.3]]\n\
             stiffness = [[2.0, 1.0], [1.0, 2.0]]\n\
             [[contacts]]\nname = \"belt\"\nforce = {{ x = -1.0 }}\nreading = {{ y = 1.3333333333333333 }}\nmu = \"{mu}\"\n"
        );
        let brake = MatricesBrake::new(MatricesCase::parse(Path::new("hoffmann.toml"), text).unwrap()).unwrap();
        let study = Study::new(&brake, &BatchSolver).unwrap();
        let scene = &study.plan().scenes[0];
        certified(&brake, scene, brake.drawn_inputs().unwrap(), &study.certificates()[scene.configuration])
    }

    #[test]
    fn ranges_are_certified_as_a_whole() {
        let straight = bound("0.2 + x").unwrap();
        let &[[from, to]] = straight.stable.as_slice() else { panic!("{straight:?}") };
        assert!(from == 0.0 && to > 0.2 && to < 0.685, "{straight:?}");
        assert!((straight.probability - (1.0 - to)).abs() < 1e-12, "{straight:?}");
        // As low at each of the 257 values, and beyond the onset between all of them.
        for mu in ["0.2 + abs(sin(804.247719318987 * x))", "0.2 + sin(804.247719318987 * x)^2"] {
            let found = bound(mu);
            assert!(found.as_ref().is_none_or(|bound| bound.probability > 0.99), "{mu}: {found:?}");
        }
    }
}
