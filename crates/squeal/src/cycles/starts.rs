//! Where motions start.

use cycle::ContactSystem;
use rand::RngExt as _;

use super::GrowingMode;

/// Part of the amplitude of the first kink at which a motion from a mode starts; chosen, so that it need not grow there first.
pub(super) const BEYOND_THE_KINK: f64 = 1.1;

/// Part of the scales of a motion that noise has; chosen.
const NOISE: f64 = 0.1;

/// Amplitude of a mode from which on a contact opens or sticks; that of the scales where none does.
pub(super) fn first_kink(system: &ContactSystem, mode: &GrowingMode) -> f64 {
    let kink = system.first_kink(mode.lambda.im, &mode.shape);
    let largest = mode.shape.iter().map(|phi| phi.norm()).fold(f64::MIN_POSITIVE, f64::max);
    if kink.is_finite() { kink } else { system.scales(mode.lambda.im)[0] / largest }
}

/// A state of noise, from a stream of a seed.
pub(super) fn noise(system: &ContactSystem, mode: &GrowingMode, seed: u64) -> Vec<f64> {
    let mut rng = montecarlo::stream(seed, 0);
    let scales = system.scales(mode.lambda.im);
    scales.into_iter().map(|scale| NOISE * scale * rng.random_range(-1.0..1.0)).collect()
}
