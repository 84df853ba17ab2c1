//! The standard normal distribution with all its digits in both tails.

use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::erf::erfc;
use statrs::function::gamma::ln_gamma;

/// Nodes on [-1, 1] and weights of Gauss' rule of eight points, the positive half.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// Probability above `t`.
///
/// ```
/// assert!((rare::tail(4.753_424_308_822_899) / 1e-6 - 1.0).abs() < 1e-9);
/// ```
#[must_use]
pub fn tail(t: f64) -> f64 {
    0.5 * erfc(t * std::f64::consts::FRAC_1_SQRT_2)
}

/// The number above which the probability is `p`, 0 < p < 1: the inverse of [`tail`].
///
/// ```
/// assert!((rare::tail_point(1e-9) - 5.997_807_015).abs() < 1e-8);
/// ```
#[must_use]
pub fn tail_point(p: f64) -> f64 {
    -Normal::standard().inverse_cdf(p)
}

/// Interval of a line, a < b, either of which may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    pub from: f64,
    pub to: f64,
}

impl Interval {
    /// The tails at the ends, and the sign that the line was turned by so that they are small.
    fn turned(&self) -> (f64, f64, f64) {
        if self.from + self.to >= 0.0 {
            (tail(self.from), tail(self.to), 1.0)
        } else {
            (tail(-self.to), tail(-self.from), -1.0)
        }
    }

    pub fn probability(&self) -> f64 {
        let (from, to, _) = self.turned();
        from - to
    }

    /// The point of the interval below which the fraction `part` of its probability lies; above which it lies if the line was turned.
    pub fn point(&self, part: f64) -> f64 {
        let (from, to, sign) = self.turned();
        sign * tail_point((from - part * (from - to)).max(f64::MIN_POSITIVE))
    }

    /// The integral of `weight` times the density.
    pub fn integral(&self, weight: impl Fn(f64) -> f64) -> f64 {
        // A weight changes over one deviation, near that end of the interval at which most of its probability lies. The rule is applied to parts of the
        // interval, outwards from there, the later ones with a tenth of the probability of the one before.
        let probability = self.probability();
        let (mut sum, mut below) = (0.0, 0.0);
        for upto in [0.5, 0.9, 0.99, 0.999, 1.0] {
            let (middle, half) = (0.5 * (upto + below), 0.5 * (upto - below));
            for (node, gauss) in GAUSS {
                for part in [middle - half * node, middle + half * node] {
                    sum += half * gauss * weight(self.point(part));
                }
            }
            below = upto;
        }
        sum * probability
    }
}

/// Density of the standard normal distribution.
pub fn density(t: f64) -> f64 {
    (-0.5 * t * t).exp() / (2.0 * std::f64::consts::PI).sqrt()
}

/// Density of the length of a vector of d independent standard normal numbers.
pub fn length_density(d: usize, r: f64) -> f64 {
    let half = 0.5 * d as f64;
    ((1.0 - half) * std::f64::consts::LN_2 + (d as f64 - 1.0) * r.ln() - 0.5 * r * r - ln_gamma(half)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_has_its_probability_on_either_side_and_its_points_inside() {
        for (from, to) in [(4.0, 5.0), (-5.0, -4.0), (-1.0, 3.0), (5.0, f64::INFINITY), (f64::NEG_INFINITY, -5.0)] {
            let interval = Interval { from, to };
            let mass = interval.integral(|_| 1.0);
            assert!((mass / interval.probability() - 1.0).abs() < 1e-12, "{from} {to} {mass}");
            for part in [0.001, 0.5, 0.999] {
                let point = interval.point(part);
                assert!(point > from && point < to, "{from} {to} {point}");
            }
            // E[e^(b t)] over the interval is e^(b^2 / 2) times the probability of the interval moved by b.
            let moved = Interval { from: from - 3.0, to: to - 3.0 }.probability() * 4.5f64.exp();
            let found = interval.integral(|t| (3.0 * t).exp());
            assert!((found / moved - 1.0).abs() < 2e-2, "{from} {to} {found} {moved}");
        }
        let both = Interval { from: f64::NEG_INFINITY, to: 1.0 }.probability() + tail(1.0);
        assert!((both - 1.0).abs() < 1e-15, "{both}");
    }

    #[test]
    fn lengths_have_a_density() {
        for d in [1, 2, 5, 72] {
            let sum: f64 = (0..20_000).map(|i| length_density(d, 0.001 * (f64::from(i) + 0.5)) * 0.001).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{d} {sum}");
        }
    }
}
