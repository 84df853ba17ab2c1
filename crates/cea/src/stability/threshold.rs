//! Thresholds beyond which a growing motion counts, on its growth rate and its damping ratio, beside the bare sign.

use num_complex::Complex;

use crate::Verdict;

/// The part of the half plane `Re lambda > 0` in which a motion counts: that to the right of `Re lambda = growth`, and that within
/// the angle about the positive real axis in which the damping ratio `-Re lambda / |lambda|` is below a number.
///
/// Both parts are convex, and so is what they have in common: an eigenvalue that is known to within a bound smaller than its
/// [`margin`](Self::margin) is on the side that the margin says.
///
/// ```
/// use cea::{Threshold, Verdict};
/// use num_complex::Complex;
///
/// // Damping ratio below -0.001.
/// let threshold = Threshold::new(0.0, -0.001).unwrap();
/// let grows = |re: f64| threshold.verdict(Complex::new(re, 1e4), 1e-3);
/// assert_eq!(grows(9.99), Verdict::Stable);
/// assert_eq!(grows(10.01), Verdict::Unstable);
/// assert!(matches!(grows(10.0), Verdict::Undecided { .. }));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Threshold {
    /// Growth rate above which a motion counts, 1/s, >= 0.
    growth: f64,
    /// Damping ratio below which it counts, <= 0.
    ratio: f64,
}

impl Default for Threshold {
    fn default() -> Self {
        Self::AXIS
    }
}

impl Threshold {
    /// The imaginary axis: every motion that grows counts.
    pub const AXIS: Self = Self { growth: 0.0, ratio: 0.0 };

    /// Motions that grow at more than `growth_above`, 1/s, and whose damping ratio is below `damping_ratio_below`. `None` unless
    /// the first is finite and >= 0, and the second in -1 < ratio <= 0: certificates and secular equations know of growing motions alone.
    #[must_use]
    pub fn new(growth_above: f64, damping_ratio_below: f64) -> Option<Self> {
        let is_allowed =
            (0.0..f64::INFINITY).contains(&growth_above) && damping_ratio_below > -1.0 && damping_ratio_below <= 0.0;
        // Without the sign of a zero, which a text would show.
        is_allowed.then_some(Self { growth: growth_above + 0.0, ratio: damping_ratio_below + 0.0 })
    }

    /// True if this is the bare sign of Re lambda.
    #[must_use]
    pub fn is_axis(&self) -> bool {
        *self == Self::AXIS
    }

    /// Growth rate above which a motion counts, 1/s.
    #[must_use]
    pub fn growth_above(&self) -> f64 {
        self.growth
    }

    /// Damping ratio below which a motion counts.
    #[must_use]
    pub fn damping_ratio_below(&self) -> f64 {
        self.ratio
    }

    /// The inward unit normal of the boundary that counts for an eigenvalue with Im >= 0, and the distance from it.
    fn boundary(&self, lambda: Complex<f64>) -> (Complex<f64>, f64) {
        // Re lambda > c |lambda| is an angle whose upper ray has the direction (c, s).
        let (c, s) = (-self.ratio, (1.0 - self.ratio * self.ratio).sqrt());
        let (of_growth, of_ratio) = (lambda.re - self.growth, lambda.re * s - lambda.im.abs() * c);
        if of_ratio <= of_growth { (Complex::new(s, -c), of_ratio) } else { (Complex::from(1.0), of_growth) }
    }

    /// Margin: the distance of an eigenvalue beyond the threshold, rad/s; below zero where it is not beyond, and then no more than its distance. For
    /// the axis it is Re lambda.
    #[must_use]
    pub fn margin(&self, lambda: Complex<f64>) -> f64 {
        self.boundary(lambda).1
    }

    /// Rate at which the margin of an eigenvalue with Im >= 0 changes where the eigenvalue changes at `rate`.
    #[must_use]
    pub fn margin_rate(&self, lambda: Complex<f64>, rate: Complex<f64>) -> f64 {
        let (normal, _) = self.boundary(lambda);
        normal.re * rate.re + normal.im * rate.im
    }

    /// The point of the boundary that is nearest to an eigenvalue with Im >= 0, rad/s. Of one that is not beyond the threshold it is
    /// the point of the straight line that it is farthest behind, which is on the boundary unless a corner is nearer.
    #[must_use]
    pub fn nearest(&self, lambda: Complex<f64>) -> Complex<f64> {
        let (normal, distance) = self.boundary(lambda);
        lambda - normal * distance
    }

    /// The eigenvalue of frequency `omega` >= 0, rad/s, that is this far beyond the threshold: on it where that is zero.
    #[must_use]
    pub fn at_margin(&self, margin: f64, omega: f64) -> Complex<f64> {
        let (c, s) = (-self.ratio, (1.0 - self.ratio * self.ratio).sqrt());
        Complex::new((margin + self.growth).max((margin + omega * c) / s), omega)
    }

    /// Verdict on an eigenvalue that is known to within `bound`, rad/s, whether it is beyond the threshold: [`Verdict::Unstable`] where it surely
    /// is, [`Verdict::Stable`] where it surely is not.
    pub fn verdict(&self, lambda: Complex<f64>, bound: f64) -> Verdict {
        Verdict::of(Complex::from(self.margin(lambda)), bound)
    }
}

/// Threshold in words, as in "a damping ratio below -0.001".
impl std::fmt::Display for Threshold {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.growth > 0.0, self.ratio < 0.0) {
            (false, false) => f.write_str("a growth rate above 0"),
            (true, false) => write!(f, "a growth rate above {} 1/s", self.growth),
            (false, true) => write!(f, "a damping ratio below {}", self.ratio),
            (true, true) => {
                write!(f, "a growth rate above {} 1/s and a damping ratio below {}", self.growth, self.ratio)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_axis_is_the_bare_sign_to_the_last_bit() {
        for lambda in
            [Complex::new(3.7, 1234.5), Complex::new(-1e-300, 1e4), Complex::new(0.0, 7.0), Complex::new(2.0, 0.0)]
        {
            assert_eq!(Threshold::AXIS.margin(lambda).to_bits(), lambda.re.to_bits());
            assert_eq!(Threshold::AXIS.nearest(lambda), Complex::new(0.0, lambda.im));
            assert_eq!(Threshold::AXIS.at_margin(lambda.re, lambda.im), lambda);
            assert_eq!(Threshold::AXIS.verdict(lambda, 1e-3), Verdict::of(lambda, 1e-3));
        }
    }

    #[test]
    fn thresholds_on_the_stable_side_and_no_numbers_are_refused() {
        for (growth, ratio) in
            [(-1.0, 0.0), (0.0, 0.01), (0.0, -1.0), (f64::NAN, 0.0), (0.0, f64::NAN), (f64::INFINITY, 0.0)]
        {
            assert_eq!(Threshold::new(growth, ratio), None, "{growth} {ratio}");
        }
        assert!(Threshold::new(-0.0, -0.0).is_some_and(|threshold| threshold.is_axis()));
    }

    proptest! {
        /// The definition, without geometry: both conditions on the numbers, anywhere within the bound.
        #[test]
        fn the_margin_is_the_definition_for_every_eigenvalue_within_the_bound(
            re in -50.0..50.0f64, im in 0.0..2e3f64, growth in 0.0..20.0f64, ratio in -0.9..0.0f64,
            angle in 0.0..std::f64::consts::TAU, part in 0.0..0.999f64,
        ) {
            let threshold = Threshold::new(growth, ratio).unwrap();
            let lambda = Complex::new(re, im);
            let counts = |l: Complex<f64>| l.re > growth && -l.re / l.norm() < ratio;
            let margin = threshold.margin(lambda);
            prop_assert_eq!(margin > 0.0, counts(lambda));
            // Nothing nearer than the margin is on the other side.
            let other = lambda + Complex::from_polar(part * margin.abs(), angle);
            prop_assert_eq!(counts(other), margin > 0.0);
            // The nearest point is on the boundary, as far away as the margin says.
            let nearest = threshold.nearest(lambda);
            prop_assert!(((nearest - lambda).norm() - margin.abs()).abs() <= 1e-9 * (1.0 + margin.abs()));
            if margin > 0.0 {
                prop_assert!(threshold.margin(nearest).abs() <= 1e-9 * lambda.norm().max(1.0));
            }
            let same = threshold.at_margin(margin, im);
            prop_assert!(same.im == im && (same.re - re).abs() <= 1e-12 * (1.0 + lambda.norm()));
            let rate = Complex::from_polar(1.0, angle);
            let by_difference = (threshold.margin(lambda + rate * 1e-5) - margin) / 1e-5;
            let near_edge = (threshold.margin(lambda) - (re - growth)).abs() < 1e-3 && ratio != 0.0;
            prop_assume!(im > 1.0 && !near_edge);
            prop_assert!((threshold.margin_rate(lambda, rate) - by_difference).abs() < 1e-4);
        }
    }
}
