//! Moments of a piece of motion, 0 to 1, at which it is looked at: for kinks, for the remainder of friction, and for integrals.

use std::sync::LazyLock;

/// Number of moments at which kinks are looked for; chosen.
pub(crate) const MOMENTS: usize = 16;

/// Number of values that a remainder is fitted to, at every second moment, and so of its powers of time; chosen.
pub(crate) const FITTED: usize = MOMENTS / 2;

/// Leading coefficient of the Chebyshev polynomial on 0 to 1 of as many powers as are fitted.
pub(crate) const LEADING: f64 = (1_u32 << (2 * FITTED - 1)) as f64;

/// Moments of the largest rule by which a piece is integrated; chosen: exact for squares of series of 15 powers.
const MOST_INTEGRATED: usize = 16;

/// Moments from the first after 0 to 1: extrema of a Chebyshev polynomial.
static ALL: LazyLock<[f64; MOMENTS]> = LazyLock::new(|| {
    std::array::from_fn(|at| 0.5 - 0.5 * (std::f64::consts::PI * (at + 1) as f64 / MOMENTS as f64).cos())
});

/// Powers, from the first on, of the polynomials that are 1 at one of the fitted moments and 0 at the others and at the begin.
static POWERS: LazyLock<[[f64; FITTED]; FITTED]> = LazyLock::new(|| {
    let at = |fitted: usize| moment(2 * fitted + 1);
    std::array::from_fn(|of| {
        let mut powers = [0.0; FITTED];
        powers[0] = 1.0 / at(of);
        for other in (0..FITTED).filter(|other| *other != of) {
            let width = at(of) - at(other);
            for power in (0..FITTED).rev() {
                let before = if power > 0 { powers[power - 1] } else { 0.0 };
                powers[power] = (before - at(other) * powers[power]) / width;
            }
        }
        powers
    })
});

/// Gauss and Legendre's rules on 0 to 1 by their number of moments from 1 on, each with moments and weights.
static RULES: LazyLock<Vec<Vec<(f64, f64)>>> = LazyLock::new(|| {
    let rule = |moments: usize| {
        let n = moments as f64;
        let of_root = |at: usize| {
            // Newton's method on Legendre's polynomial.
            let (mut x, mut slope) = ((std::f64::consts::PI * (at as f64 + 0.75) / (n + 0.5)).cos(), 1.0);
            for _ in 0..20 {
                let (mut before, mut value) = (1.0, x);
                for degree in 2..=moments {
                    let k = degree as f64;
                    (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
                }
                slope = n * (x * value - before) / (x * x - 1.0);
                x -= value / slope;
            }
            (0.5 - 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
        };
        (0..moments).map(of_root).collect()
    };
    (1..=MOST_INTEGRATED).map(rule).collect()
});

/// The moment of a number from 0; the last is 1.
pub(crate) fn moment(at: usize) -> f64 {
    ALL[at]
}

/// Moments and weights of a rule that integrates squares of a series whose powers fall away up to a degree.
pub(crate) fn rule(degree: usize) -> &'static [(f64, f64)] {
    &RULES[(degree / 2 + 3).min(MOST_INTEGRATED) - 1]
}

/// Powers, from the first on, of the polynomial with given values at every second moment and 0 at the begin.
pub(crate) fn fit(values: &[f64; FITTED]) -> [f64; FITTED] {
    let mut powers = [0.0; FITTED];
    for (value, of) in values.iter().zip(&*POWERS) {
        powers.iter_mut().zip(of).for_each(|(power, of)| *power += value * of);
    }
    powers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_gives_back_a_polynomial_and_a_rule_its_integral() {
        let polynomial = |t: f64| (1..=FITTED).map(|k| (k as f64 - 3.5) * t.powi(k as i32)).sum::<f64>();
        let values = std::array::from_fn(|at| polynomial(moment(2 * at + 1)));
        for (at, power) in fit(&values).into_iter().enumerate() {
            assert!((power - (at as f64 - 2.5)).abs() < 1e-8, "{at}: {power}");
        }
        let integral = |power: i32| rule(30).iter().map(|(t, weight)| weight * t.powi(power)).sum::<f64>();
        for power in [0, 1, 7, 31] {
            assert!((integral(power) * f64::from(power + 1) - 1.0).abs() < 1e-14, "{power}");
        }
        assert!((integral(32) * 33.0 - 1.0).abs() > 0.0);
    }
}
