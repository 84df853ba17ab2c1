//! Numbers as results of sweeps print them.

use cea::frequency_hz;
use num_complex::Complex;

/// The frequency, Hz, of an angular frequency, rad/s.
pub(super) fn hertz(omega: f64) -> f64 {
    frequency_hz(Complex::new(0.0, omega))
}

/// Words for a number of things.
pub(super) fn count(number: usize, one: &str, more: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {more}") }
}
