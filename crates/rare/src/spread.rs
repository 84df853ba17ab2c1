//! Spread of lines across the direction of a design point.
//!
//! Where the onset bends around the medians the probability on a line grows with its distance from the design point, and lines that are normal
//! across see too little of it: their mean is too low, and does not show it. With the curvature c of the onset at a distance beta the
//! probability on a line at v across is about `exp(h c v^2 / 2)` times the probability on the line of the design point, h = phi(beta) / tail(beta), so that
//! what lines should see has the variance `1 / (1 - h c)` (Breitung 1984 has its integral). Half of the lines are drawn with this variance, the others with
//! the variance 1, so that no line weighs more than twice what it did (defensive mixture, Hesterberg 1995).
//!
//! The curvature is a symmetric matrix, of which directions of the gradient beside the design point give products with vectors: its largest
//! eigenvalues are found by Lanczos' method from a random direction.

use nalgebra::DMatrix;
use rand_distr::{Distribution, StandardNormal};

use crate::limit_state::Asked;
use crate::normal::{density, tail};
use crate::search::{DesignPoint, onset_near};
use crate::vector::{along, dot, norm, scaled};
use crate::window::Window;

/// Most directions that are looked at; chosen: an onset bends strongly in few.
const MOST_DIRECTIONS: usize = 8;
/// Largest curvature that counts as flat, per standard deviation; chosen: with less, lines are also widened where the onset hardly bends; with more, a bend is
/// left as it is.
const FLAT: f64 = 1e-3;
/// Distance from the tangent plane up to which the onset is looked for; chosen: one that is farther away bends by more than is made use of.
const FARTHEST: f64 = 2.0;
/// Largest `h c`, which makes a standard deviation of 2; chosen: farther out the curvature is another.
const LARGEST: f64 = 0.75;

/// Directions across in which half of the lines are drawn with a larger standard deviation.
#[derive(Debug, Clone, Default)]
pub(crate) struct Spread {
    /// Unit vectors at right angles, each with its standard deviation, > 1.
    wide: Vec<(Vec<f64>, f64)>,
}

impl Spread {
    /// The spread at a design point.
    ///
    /// # Errors
    /// Those of the limit state.
    pub fn at<A: Asked>(
        of: &A,
        (point, window): (&DesignPoint, Option<Window>),
        rng: &mut montecarlo::StreamRng,
    ) -> Result<Self, A::Error> {
        let normal = &point.direction;
        let mut directions: Vec<Vec<f64>> = Vec::new();
        let mut products: Vec<Vec<f64>> = Vec::new();
        let mut next: Vec<f64> = (0..of.dimensions()).map(|_| StandardNormal.sample(rng)).collect();
        while directions.len() < MOST_DIRECTIONS {
            // Twice, as rounding of the first time is left.
            for _ in 0..2 {
                for known in std::iter::once(normal).chain(&directions) {
                    next = along(&next, -dot(&next, known), known);
                }
            }
            if norm(&next) <= FLAT {
                break;
            }
            let direction = scaled(1.0 / norm(&next), &next);
            let Some(product) = bent(of, (point, window), &direction)? else { break };
            next.clone_from(&product);
            directions.push(direction);
            products.push(product);
        }
        if directions.is_empty() {
            return Ok(Self::default());
        }
        let projected = DMatrix::from_fn(directions.len(), directions.len(), |i, j| dot(&directions[i], &products[j]));
        let eigen = (0.5 * (&projected + projected.transpose())).symmetric_eigen();
        let hazard = density(point.beta) / tail(point.beta);
        let deviation = |curvature: &f64| (1.0 - (hazard * curvature).min(LARGEST)).powf(-0.5);
        let principal = |j: usize| {
            let zero = vec![0.0; of.dimensions()];
            directions
                .iter()
                .zip(eigen.eigenvectors.column(j).iter())
                .fold(zero, |sum, (own, part)| along(&sum, *part, own))
        };
        let wide = eigen.eigenvalues.iter().enumerate().filter(|(_, curvature)| **curvature > FLAT);
        Ok(Self { wide: wide.map(|(j, curvature)| (principal(j), deviation(curvature))).collect() })
    }

    /// The point across, drawn from the normal distribution and widened if `is_wide`, half of the time; and its density there over that with which it was
    /// drawn.
    pub fn drawn(&self, mut across: Vec<f64>, is_wide: bool) -> (Vec<f64>, f64) {
        if is_wide {
            for (direction, deviation) in &self.wide {
                across = along(&across, (deviation - 1.0) * dot(direction, &across), direction);
            }
        }
        let log = |(direction, deviation): &(Vec<f64>, f64)| {
            0.5 * (1.0 - deviation.powi(-2)) * dot(direction, &across).powi(2) - deviation.ln()
        };
        let wide_over_normal = self.wide.iter().map(log).sum::<f64>().exp();
        (across, 2.0 / (1.0 + wide_over_normal))
    }
}

/// Curvature of the onset at a design point times a direction across, from the direction of the gradient on the onset one deviation beside the point: its
/// components across over its component in the direction of the point. It is positive where the onset bends towards the medians. `None` where there is no
/// onset, or no gradient.
fn bent<A: Asked>(
    of: &A,
    (point, window): (&DesignPoint, Option<Window>),
    direction: &[f64],
) -> Result<Option<Vec<f64>>, A::Error> {
    let normal = &point.direction;
    let base = along(direction, dot(&point.point, normal), normal);
    let beside = |t: f64| along(&base, t, normal);
    let found = match window {
        Some(window) => match window.at(of, [&point.point, normal], [direction, normal])? {
            Some(seen) => {
                let onset = seen.onset(&mut |t| Ok::<f64, A::Error>(of.worst(&along(direction, t, normal))?.margin))?;
                onset.map(|t| along(direction, t, normal))
            }
            None => None,
        },
        None => onset_near(of, &beside, 0.0, [-FARTHEST, FARTHEST])?.map(beside),
    };
    let Some(onset) = found else { return Ok(None) };
    let steepest = of.steepest(&onset, &of.worst(&onset)?)?;
    let turned = steepest.map(|(there, _)| (dot(&there, normal), there)).filter(|(part, _)| *part > 0.0);
    Ok(turned.map(|(part, there)| along(&scaled(1.0 / part, &there), -1.0, normal)))
}

#[cfg(test)]
mod tests {
    use rand_distr::StandardUniform;

    use super::*;
    use crate::limit_state::{Counted, LimitState};
    use crate::{Error, Mode};

    /// Onset `u_0 = 4.5 - sum_i curvatures_i u_i^2 / 2`, in turned coordinates.
    struct Paraboloid {
        curvatures: Vec<f64>,
    }

    /// Householder's reflection along (1, 2, ..., d), its own inverse.
    fn turned(u: &[f64]) -> Vec<f64> {
        let axis: Vec<f64> = (1..=u.len()).map(|i| i as f64).collect();
        along(u, -2.0 * dot(u, &axis) / dot(&axis, &axis), &axis)
    }

    impl LimitState for Paraboloid {
        type Error = Error;

        fn dimensions(&self) -> usize {
            self.curvatures.len() + 1
        }

        fn modes(&self, u: &[f64]) -> Result<Vec<Mode>, Error> {
            let u = turned(u);
            let bends: f64 = self.curvatures.iter().zip(&u[1..]).map(|(c, v)| 0.5 * c * v * v).sum();
            Ok(vec![Mode { margin: u[0] + bends - 4.5, growth: 0.0, omega: 0.0 }])
        }

        fn gradient(&self, u: &[f64], _: &Mode) -> Result<Vec<f64>, Error> {
            let u = turned(u);
            let across = self.curvatures.iter().zip(&u[1..]).map(|(c, v)| c * v);
            Ok(turned(&std::iter::once(1.0).chain(across).collect::<Vec<_>>()))
        }
    }

    fn spread(curvatures: Vec<f64>) -> Spread {
        let of = Paraboloid { curvatures };
        let direction = turned(&std::iter::once(1.0).chain(vec![0.0; of.curvatures.len()]).collect::<Vec<_>>());
        let mode = Mode { margin: 0.0, growth: 0.0, omega: 0.0 };
        let point =
            DesignPoint { point: scaled(4.5, &direction), direction, beta: 4.5, slope: 1.0, mode, is_settled: true };
        Spread::at(&Counted::new(&of), (&point, None), &mut montecarlo::stream(1, 0)).unwrap_or_default()
    }

    #[test]
    fn the_spread_is_that_of_the_curvature() {
        let hazard = density(4.5) / tail(4.5);
        for curvatures in
            [vec![0.1], vec![0.1, 0.02, -0.3], vec![0.0; 5], vec![-0.1; 4], [vec![0.12, 0.05], vec![0.0; 60]].concat()]
        {
            let mut expected: Vec<f64> =
                curvatures.iter().filter(|c| **c > FLAT).map(|c| (1.0 - hazard * c).powf(-0.5)).collect();
            let mut found: Vec<f64> = spread(curvatures.clone()).wide.iter().map(|(_, deviation)| *deviation).collect();
            expected.sort_by(f64::total_cmp);
            found.sort_by(f64::total_cmp);
            assert_eq!(found.len(), expected.len(), "{curvatures:?} {found:?}");
            assert!(found.iter().zip(&expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-2), "{found:?} {expected:?}");
        }
    }

    #[test]
    fn widened_points_with_their_ratios_are_normal() {
        let spread = Spread { wide: vec![(vec![0.6, 0.8, 0.0], 1.7), (vec![0.0, 0.0, 1.0], 1.2)] };
        let count = 200_000;
        let (mut mass, mut squares) = (0.0, [0.0; 3]);
        for index in 0..count {
            let mut rng = montecarlo::stream(3, index);
            let across = (0..3).map(|_| StandardNormal.sample(&mut rng)).collect();
            let part: f64 = StandardUniform.sample(&mut rng);
            let (across, ratio) = spread.drawn(across, part < 0.5);
            assert!(ratio <= 2.0);
            mass += ratio / count as f64;
            squares.iter_mut().zip(&across).for_each(|(sum, x)| *sum += ratio * x * x / count as f64);
        }
        assert!(
            (mass - 1.0).abs() < 0.01 && squares.iter().all(|square| (square - 1.0).abs() < 0.02),
            "{mass} {squares:?}"
        );
    }
}
