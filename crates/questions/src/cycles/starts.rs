//! Where motions start.

use cycle::ContactSystem;
use rand::RngExt as _;

use super::GrowingMode;

/// Part of the amplitude of the first kink at which a motion from a mode starts; chosen, so that it need not grow there first.
const BEYOND_THE_KINK: f64 = 1.1;

/// Part of the scales of a motion that noise has; chosen.
const NOISE: f64 = 1.0;

/// Part of the size of a start in a mode that the noise beside it has; chosen, so that it takes some ten periods to matter.
const BESIDE: f64 = 0.03;

/// Streams of noise from which motions start; chosen.
pub(super) const STREAMS: u64 = 4;

/// A state in a mode, just beyond the amplitude from which on a contact opens or sticks; of the size of the scales where none does.
pub(super) fn in_mode(system: &ContactSystem, mode: &GrowingMode) -> Vec<f64> {
    let kink = system.first_kink(mode.lambda.im, &mode.shape);
    let largest = mode.shape.iter().map(|phi| phi.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let amplitude = if kink.is_finite() { kink } else { system.scales(mode.lambda.im)[0] / largest };
    system.state_of_mode(mode.lambda, &mode.shape, BEYOND_THE_KINK * amplitude)
}

/// A state as [`in_mode`], with noise beside it, the same for all: a motion that starts in a mode alone stays in the symmetric part of the brake to which
/// that belongs until rounding takes it out, after some hundred periods, and no brake is so symmetric.
pub(super) fn beside_mode(system: &ContactSystem, mode: &GrowingMode) -> Vec<f64> {
    let mut x = in_mode(system, mode);
    let scales = system.scales(mode.lambda.im);
    let size = x.iter().zip(&scales).map(|(x, scale)| (x / scale).abs()).fold(0.0, f64::max);
    x.iter_mut().zip(noise(system, mode, 0, 0)).for_each(|(x, noise)| *x += BESIDE * size * noise);
    x
}

/// A state of noise.
pub(super) fn noise(system: &ContactSystem, mode: &GrowingMode, seed: u64, stream: u64) -> Vec<f64> {
    let mut rng = montecarlo::stream(seed, stream);
    let scales = system.scales(mode.lambda.im);
    scales.into_iter().map(|scale| NOISE * scale * rng.random_range(-1.0..1.0)).collect()
}
