//! Third octaves, by which frequencies are told apart where squeal is measured.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

/// Nominal middles of the ten third octaves of a decade (IEC 61260-1).
const NOMINAL: [f64; 10] = [1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0];

/// Third octave, by its number n, 0 of the one about 1 Hz: its middle is 10^(n/10) Hz, its edges 10^(n/10 -+ 1/20) (IEC 61260-1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ThirdOctave(i32);

impl ThirdOctave {
    /// The third octave of a frequency above zero, Hz.
    #[must_use]
    pub fn of_hertz(hz: f64) -> Self {
        Self((10.0 * hz.log10()).round() as i32)
    }

    /// The third octave of an angular frequency above zero, rad/s.
    #[must_use]
    pub fn of_omega(omega: f64) -> Self {
        Self::of_hertz(omega / TAU)
    }

    /// The third octave that is `count` below it.
    #[must_use]
    pub fn below(self, count: u16) -> Self {
        Self(self.0 - i32::from(count))
    }

    /// All third octaves from this one up to `last`, with it; none where that is below.
    pub fn up_to(self, last: Self) -> impl Iterator<Item = Self> {
        (self.0..=last.0).map(Self)
    }

    /// The nominal middle, Hz.
    #[must_use]
    pub fn middle(self) -> f64 {
        NOMINAL[self.0.rem_euclid(10) as usize] * 10_f64.powi(self.0.div_euclid(10))
    }

    /// The lower and the upper edge, Hz.
    #[must_use]
    pub fn edges(self) -> [f64; 2] {
        [-0.5, 0.5].map(|side| 10_f64.powf((f64::from(self.0) + side) / 10.0))
    }
}

/// Samples in which a mode of a third octave is unstable, whichever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct InThirdOctave {
    /// Samples in which a mode surely is.
    pub unstable: u64,
    /// Samples in which none surely is, and the verdict on one is open.
    pub perhaps: u64,
}

#[cfg(test)]
mod tests {
    use super::ThirdOctave;

    #[test]
    fn frequencies_lie_in_the_third_octaves_of_the_norm() {
        for (hz, nominal) in [
            (1000.0, 1000.0),
            (1122.0, 1000.0),
            (1123.0, 1250.0),
            (2602.7, 2500.0),
            (5534.7, 5000.0),
            (5650.0, 6300.0),
            (12_000.0, 12_500.0),
            (0.2255, 0.25),
            (891.0, 800.0),
            (892.0, 1000.0),
        ] {
            let found = ThirdOctave::of_hertz(hz);
            assert!((found.middle() / nominal - 1.0_f64).abs() < 1e-12, "{hz}: {}", found.middle());
            let [from, to] = found.edges();
            assert!(from <= hz && hz <= to, "{hz}: {from} to {to}");
        }
    }
}
