//! Points away from the lines, which must not contradict them.
//!
//! A direction is drawn on the sphere, and a length: half of them uniformly, from 0 to where hardly any probability is left, half of them as the
//! normal distribution has them beyond the nearest design point. A point weighs what its density is in the normal distribution over that with
//! which it was drawn. A failure that lies before all tangent planes is followed to its own design
//! point: one that is known explains it.

use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rayon::prelude::*;

use crate::limit_state::{AT_ONCE, Asked, Counted, LimitState};
use crate::normal::length_density;
use crate::search::{DesignPoint, design_point};
use crate::vector::{norm, scaled, unit};

/// Distance before the tangent plane of a design point up to which a failure counts as one of this design point; chosen: surfaces bend.
const BEFORE: f64 = 0.5;
/// Most failures that are followed to a design point, the weightiest first; chosen: each costs a search.
const MOST_FOLLOWED: usize = 4;

/// Number of steps of the table from which lengths are drawn; chosen: what a point weighs does not depend on them.
const STEPS: usize = 512;

/// Distribution of the lengths of points.
struct Lengths {
    /// Number of inputs.
    d: usize,
    /// Distance of the nearest design point.
    nearest: f64,
    /// Largest length that is drawn.
    longest: f64,
    /// Sums of the densities at the steps beyond the nearest design point.
    sums: Vec<f64>,
}

impl Lengths {
    fn new(d: usize, nearest: f64, longest: f64) -> Self {
        let step = (longest - nearest) / STEPS as f64;
        let density = |at: usize| length_density(d, nearest + (at as f64 + 0.5) * step);
        let sums = (0..STEPS).scan(0.0, |sum, at| {
            *sum += density(at);
            Some(*sum)
        });
        Self { d, nearest, longest, sums: sums.collect() }
    }

    /// The length for three numbers that are uniform from 0 to 1.
    fn length(&self, [which, part, inside]: [f64; 3]) -> f64 {
        if which < 0.5 {
            return self.longest * part;
        }
        let place = self.sums.partition_point(|sum| *sum < part * self.sums[STEPS - 1]).min(STEPS - 1);
        self.nearest + (place as f64 + inside) * (self.longest - self.nearest) / STEPS as f64
    }

    /// Weight of a point of this length: the density of the length in the normal distribution over that with which it was drawn.
    fn weight(&self, length: f64) -> f64 {
        let step = (self.longest - self.nearest) / STEPS as f64;
        let place = ((length - self.nearest) / step).floor();
        let beyond = if (0.0..STEPS as f64).contains(&place) {
            let place = place as usize;
            let below = if place > 0 { self.sums[place - 1] } else { 0.0 };
            (self.sums[place] - below) / (self.sums[STEPS - 1] * step)
        } else {
            0.0
        };
        length_density(self.d, length) / (0.5 / self.longest + 0.5 * beyond)
    }
}

/// Answer of the points elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Elsewhere {
    /// Number of points that fail.
    pub hits: usize,
    /// Mean of the weights of those that fail, and its standard error.
    pub mean: f64,
    pub error: f64,
    /// Design points of failures that those that are known do not explain.
    pub unexplained: Vec<DesignPoint>,
}

/// Evaluates `points` points, and follows failures among them that no `known` design point explains; `known` are the nearest first. `reach` is the distance
/// along a direction of failure, in standard deviations, beyond which hardly any of its probability lies.
///
/// # Errors
/// Those of the limit state.
pub(crate) fn elsewhere<L: LimitState>(
    of: &Counted<'_, L>,
    known: &[DesignPoint],
    reach: f64,
    (points, seed): (usize, u64),
) -> Result<Elsewhere, L::Error> {
    let d = of.dimensions();
    // Of the inputs across a direction of failure the sum of squares is about d - 1.
    let longest = reach.hypot(if d > 1 { ((d - 1) as f64).sqrt() + 3.0 } else { 0.0 });
    let lengths = Lengths::new(d, known.first().map_or(0.0, |nearest| nearest.beta), longest);
    let draw = |index: usize| {
        let mut rng = montecarlo::stream(seed, index as u64);
        let length = lengths.length(std::array::from_fn(|_| StandardUniform.sample(&mut rng)));
        let direction = unit((0..d).map(|_| StandardNormal.sample(&mut rng)).collect())?;
        Some((scaled(length, &direction), lengths.weight(length)))
    };
    let drawn: Vec<(Vec<f64>, f64)> = (0..points).filter_map(draw).collect();
    let failing = |drawn: &[(Vec<f64>, f64)]| -> Result<Vec<(Vec<f64>, f64)>, L::Error> {
        let points: Vec<Vec<f64>> = drawn.iter().map(|(u, _)| u.clone()).collect();
        let worst = of.worst_of_all(&points)?;
        Ok(drawn.iter().zip(worst).filter(|(_, mode)| mode.margin > 0.0).map(|(hit, _)| hit.clone()).collect())
    };
    let found = drawn.par_chunks(AT_ONCE).map(failing).collect::<Result<Vec<_>, L::Error>>()?;
    let mut hits: Vec<(Vec<f64>, f64)> = found.into_iter().flatten().collect();
    let count = points.max(1) as f64;
    let mean = hits.iter().map(|hit| hit.1).sum::<f64>() / count;
    let square = hits.iter().map(|hit| hit.1 * hit.1).sum::<f64>() / count;
    let error = ((square - mean * mean).max(0.0) / count).sqrt();
    hits.sort_by(|a, b| b.1.total_cmp(&a.1));
    let before = |u: &[f64]| known.iter().all(|point| point.beyond(u) < -BEFORE);
    let mut unexplained: Vec<DesignPoint> = Vec::new();
    for (u, _) in hits.iter().filter(|hit| before(&hit.0)).take(MOST_FOLLOWED) {
        let found = match design_point(of, u)? {
            Some(found) => found,
            // Failure without an onset before it: itself.
            None => match unit(u.clone()) {
                Some(direction) => {
                    let mode = of.worst(u)?;
                    DesignPoint { point: u.clone(), direction, beta: norm(u), slope: 0.0, mode, is_settled: false }
                }
                None => continue,
            },
        };
        if !known.iter().chain(&unexplained).any(|other| other.is_same(&found)) {
            unexplained.push(found);
        }
    }
    unexplained.sort_by(|a, b| a.beta.total_cmp(&b.beta));
    Ok(Elsewhere { hits: hits.len(), mean, error, unexplained })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_lengths_give_the_probability_beyond_a_length() {
        for (d, exact) in [(1, 2.0 * crate::tail(4.5)), (2, (-0.5 * 4.5f64.powi(2)).exp()), (72, 1.0)] {
            let lengths = Lengths::new(d, 4.2, if d == 72 { 13.0 } else { 9.0 });
            let count = 100_000;
            let mean = (0..count).map(|index| {
                let mut rng = montecarlo::stream(1, index);
                let length = lengths.length(std::array::from_fn(|_| StandardUniform.sample(&mut rng)));
                if length > 4.5 { lengths.weight(length) } else { 0.0 }
            });
            let mean = mean.sum::<f64>() / count as f64;
            assert!((mean / exact - 1.0).abs() < 0.02, "{d} {mean:e} {exact:e}");
        }
    }
}
