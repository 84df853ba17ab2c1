//! A bound of the probability of squeal that rests on no sample: where the certificate of the scene holds, nothing grows.

use study::{Certificate, DrawnInputs, Scene, UncertainBrake};

/// Values of the parameter at which it is asked whether they are certified, between the ends of its distribution; chosen.
const VALUES: usize = 256;
/// Halvings of the step from a certified value to one that is not; chosen: to the last digits that matter.
const HALVINGS: usize = 40;

/// Certified bound of the probability of squeal.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct CertifiedBound {
    /// Ranges of the parameter in which every system is certified to be stable.
    pub stable: Vec<[f64; 2]>,
    /// Probability of all other values, above which that of squeal is not.
    pub probability: f64,
}

/// The bound of a scene that depends on one parameter; `None` where it depends on more, or nothing is certified.
///
/// The certificate is a union of ellipses of friction, so that the range between two certified values that are neighbours lies in one of them:
/// friction of one parameter is a straight line.
pub(super) fn certified<B: UncertainBrake>(
    brake: &B,
    scene: &Scene,
    drawn: &dyn DrawnInputs<B::Sample>,
    certificate: &Certificate,
) -> Option<CertifiedBound> {
    let single = drawn.single_parameter(scene)?;
    let (from, to) = single.distribution.support();
    let is_stable =
        |value: f64| brake.operating_point(scene, &single.sample(value)).is_ok_and(|point| certificate.covers(&point));
    let values: Vec<f64> = (0..=VALUES).map(|i| from + (to - from) * i as f64 / VALUES as f64).collect();
    let edge = |mut inside: f64, mut outside: f64| {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if is_stable(middle) { inside = middle } else { outside = middle }
        }
        inside
    };
    let mut stable: Vec<[f64; 2]> = Vec::new();
    let mut is_open = false;
    for (place, &value) in values.iter().enumerate() {
        let is_inside = is_stable(value);
        match (is_open, is_inside, stable.last_mut()) {
            (false, true, _) => stable.push([if place > 0 { edge(value, values[place - 1]) } else { value }, value]),
            (true, true, Some(last)) => last[1] = value,
            (true, false, Some(last)) => last[1] = edge(values[place - 1], value),
            _ => {}
        }
        is_open = is_inside;
    }
    // Below the smallest value that matters nothing is asked: that is left out, as it is at most 1e-12.
    let inside = |[from, to]: &[f64; 2]| single.distribution.cumulative(*to) - single.distribution.cumulative(*from);
    let certified: f64 = stable.iter().map(inside).sum();
    (!stable.is_empty()).then(|| CertifiedBound { probability: (1.0 - certified).clamp(0.0, 1.0), stable })
}
