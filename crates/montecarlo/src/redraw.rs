//! Truncated distributions.

use rand_distr::Distribution;

use crate::error::MonteCarloError;
use crate::stream::StreamRng;

/// Draws until the value is at least `bound`, at most 1,000 times: a value of the distribution truncated from below.
///
/// # Errors
/// No draw reached the bound. With 1 % of the probability above the bound this happens once in 23,000 samples.
///
/// ```
/// use montecarlo::{redraw_until_at_least, stream};
/// let friction = rand_distr::Normal::new(0.5, 0.1)?;
/// assert!(redraw_until_at_least(&friction, 0.02, &mut stream(1, 0))? >= 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn redraw_until_at_least(
    distribution: &impl Distribution<f64>,
    bound: f64,
    rng: &mut StreamRng,
) -> Result<f64, MonteCarloError> {
    /// Most draws for one value; chosen: with fewer, a bound that is rarely reached fails more often; with more, one that is never reached takes longer.
    const MOST_ATTEMPTS: u32 = 1_000;
    for _ in 0..MOST_ATTEMPTS {
        let value = distribution.sample(rng);
        if value >= bound {
            return Ok(value);
        }
    }
    Err(MonteCarloError::Redraw { bound, attempts: MOST_ATTEMPTS })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::stream;
    use rand_distr::Normal;

    #[test]
    fn the_lower_half_of_a_normal_distribution_is_cut_off() {
        // Half-normal: mean sqrt(2 / pi), standard deviation sqrt(1 - 2 / pi).
        let normal = Normal::new(0.0, 1.0).unwrap();
        let mut rng = stream(3, 0);
        let n = 20_000;
        let values: Vec<f64> = (0..n).map(|_| redraw_until_at_least(&normal, 0.0, &mut rng).unwrap()).collect();
        assert!(values.iter().all(|&value| value >= 0.0));
        let mean = values.iter().sum::<f64>() / f64::from(n);
        let expected = std::f64::consts::FRAC_2_PI.sqrt();
        let standard_error = ((1.0 - std::f64::consts::FRAC_2_PI) / f64::from(n)).sqrt();
        assert!((mean - expected).abs() < 4.0 * standard_error, "{mean}");
    }

    #[test]
    fn an_unreachable_or_nan_bound_ends_in_an_error() {
        let normal = Normal::new(0.0, 1.0).unwrap();
        for bound in [50.0, f64::NAN] {
            let refused = redraw_until_at_least(&normal, bound, &mut stream(3, 0));
            assert!(matches!(refused, Err(MonteCarloError::Redraw { attempts: 1_000, .. })));
        }
    }
}
