//! Divergence of a finite element brake: what grows faster than it oscillates, whatever the band of the case. It is found in the whole brake.
//!
//! Far beyond the band, single pairs of nodes, which have little mass, grow where the curve of friction falls more steeply than their damping holds, or where they
//! feed each other. A basis of modes of the band does not have that. Eigenvalues that do not grow lie on the imaginary axis or left of it, and most that grow are next to
//! it, so that few are nearer to the middle of a rectangle to the right of the axis than the axis is. So one factorisation and a small Krylov space about the middle
//! show that the rectangle is empty, and rectangles 2.2 times as large each reach any growth in a few steps. Loss factors have no part in it: a complex
//! stiffness is that of a steady vibration, which a motion that grows faster than it oscillates is not.

use std::f64::consts::TAU;
use std::iter::repeat_n;

use cea::{ROUNDED_DATA, Spectrum, Threshold, Verdict, grows_too_fast, real_count};
use linsys::OperatingPoint;
use num_complex::Complex;
use sparse::{Eigenpair, Options, Rectangle, SparseSecondOrder, eigenpairs_in};
use study::{ModeSource, Scene};

use super::together::search_options;
use super::training::rectangle;
use super::{Diverging, FiniteElementBrake};
use crate::Error;
use crate::case::FiniteElementCase;

/// Smallest real eigenvalue that is looked for as divergence, as a fraction of the lowest frequency of the band in rad/s; chosen: above the zeros of rigid
/// motions.
const SLOWEST: f64 = 1e-3;
/// Size of a rectangle beyond the band, as a multiple of the size of the rectangle before. Measured with the disc and pad of 14,985 degrees of freedom: one small Krylov space
/// shows that nothing is nearer to the middle than 0.85 times the distance to the imaginary axis, where the eigenvalues crowd; with 2.2 the corners are at 0.78 times it.
const LARGER: f64 = 2.2;
/// Number of rectangles beyond the band: growth of up to 2,656 times 2 pi times its highest frequency is found. Chosen: growth of cases/disc-pad reaches 170 times 2 pi
/// times it.
const BEYOND: i32 = 10;

/// Smallest growth that is looked for as divergence of a case, 1/s.
fn slowest_divergence(case: &FiniteElementCase) -> f64 {
    SLOWEST * rectangle(case).im[0]
}

/// Eigenvalues of a whole brake in a rectangle that surely are beyond a threshold and grow faster than they oscillate, 1/s, Im >= 0, by ascending growth.
/// `None` where the search does not come to an end, or nothing surely grows and rounding leaves open whether something does; beside one that surely grows
/// the open ones are left out.
fn fast_in(
    system: &SparseSecondOrder,
    right: &Rectangle,
    (threshold, options): (&Threshold, &Options),
) -> Option<Vec<Complex<f64>>> {
    let found = eigenpairs_in(system, right, options, &mut |_| {}).ok()?;
    let is_fast = |pair: &Eigenpair| real_count(pair.lambda) > 0 || grows_too_fast(pair.lambda);
    let fast: Vec<Eigenpair> = found.pairs.into_iter().filter(is_fast).collect();
    let verdict = |pair: &Eigenpair| threshold.verdict(pair.lambda, ROUNDED_DATA * pair.bound);
    let grows = |pair: &&Eigenpair| verdict(pair) == Verdict::Unstable;
    let of = |pair: &Eigenpair| match real_count(pair.lambda) {
        0 => repeat_n(pair.lambda, 1),
        count => repeat_n(pair.lambda.re.into(), count),
    };
    let mut growing: Vec<Complex<f64>> = fast.iter().filter(grows).flat_map(of).collect();
    growing.sort_by(|a, b| a.re.total_cmp(&b.re));
    let is_open = |pair: &Eigenpair| matches!(verdict(pair), Verdict::Undecided { .. });
    (!growing.is_empty() || !fast.iter().any(is_open)).then_some(growing)
}

/// True if something in a whole brake grows faster than it oscillates and than `growth`, 1/s, and surely is beyond a threshold. `None` where it is not found, and
/// a search does not tell.
fn diverges_beyond(system: &SparseSecondOrder, growth: f64, judged: (&Threshold, &Options)) -> Option<bool> {
    let mut is_open = false;
    for step in 0..BEYOND {
        let [from, to] = [step, step + 1].map(|step| growth * LARGER.powi(step));
        match fast_in(system, &Rectangle { re: [from, to], im: [0.0, to] }, judged) {
            Some(growing) if !growing.is_empty() => return Some(true),
            Some(_) => {}
            None => is_open = true,
        }
    }
    (!is_open).then_some(false)
}

/// 2 pi times the highest frequency of the band, rad/s.
fn highest(case: &FiniteElementCase) -> f64 {
    TAU * case.reduction.frequencies[1]
}

impl FiniteElementBrake {
    /// Divergence in a scene, at an operating point of the brake: eigenvalues of the whole brake whose growth is above the threshold and above 2 pi times a thousandth
    /// of the lowest frequency of the band (below it are the zeros of a body that is free to move), by at most 2 pi times the highest; and whether there are any that grow
    /// faster. They are not told where a search does not tell, and where the whole brake has none and the `reduced` one there has. So many searches are under way
    /// `together`.
    ///
    /// # Errors
    /// A point that the brake refuses.
    pub fn diverging(
        &self,
        scene: &Scene,
        at: &OperatingPoint,
        reduced: &Spectrum,
        together: usize,
    ) -> Result<Diverging, Error> {
        let system = self.sets[self.part(scene).set].system.assemble(at)?.without_structural_damping();
        let (threshold, options) = (&self.plan.threshold, &search_options(together));
        let from = threshold.growth_above().max(slowest_divergence(&self.case));
        let end = from + highest(&self.case);
        let whole = fast_in(&system, &Rectangle { re: [from, end], im: [0.0, end] }, (threshold, options));
        let beyond = diverges_beyond(&system, end, (threshold, options));
        let error = self.relative_error(scene);
        let is_listed = |lambda: &Complex<f64>| {
            lambda.im >= 0.0
                && grows_too_fast(*lambda)
                && (from..=end).contains(&lambda.re)
                && threshold.margin(*lambda) > error * lambda.norm()
        };
        let reduced_has_any = reduced.eigenvalues.iter().any(is_listed);
        // One that grows faster in the whole brake may be the one that the reduced brake has.
        let is_told = |whole: &Vec<Complex<f64>>| {
            !whole.is_empty() || beyond == Some(true) || !reduced_has_any && beyond == Some(false)
        };
        Ok(Diverging { whole: whole.filter(is_told), beyond: beyond == Some(true) })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cea::{EigenSolver as _, QrSolver, Workspace};
    use linsys::SecondOrder;
    use montecarlo::stream;
    use nalgebra::DMatrix;
    use rand::RngExt as _;
    use sparse::nalgebra_sparse::CscMatrix;

    use super::*;

    /// A chain of masses with frequencies up to 500 rad/s. Two neighbours somewhere in it push themselves off their places and feed each other.
    fn chain(seed: u64, masses: usize) -> [DMatrix<f64>; 3] {
        let mut rng = stream(57, seed);
        let mut k = DMatrix::zeros(masses, masses);
        for at in 0..masses {
            k[(at, at)] += 10_f64.powf(rng.random_range(-1.0..5.0));
            let (next, spring) = ((at + 1) % masses, rng.random_range(0.0..1e3));
            for (row, column, sign) in [(at, at, 1.0), (next, next, 1.0), (at, next, -1.0), (next, at, -1.0)] {
                k[(row, column)] += sign * spring;
            }
        }
        let (at, size) = (rng.random_range(0..masses - 1), 10_f64.powf(rng.random_range(-0.5..6.0)));
        let fed = size * rng.random_range(-1.0..1.0);
        k[(at, at)] -= size;
        k[(at + 1, at + 1)] -= size;
        k[(at, at + 1)] += fed;
        k[(at + 1, at)] -= fed;
        let m = DMatrix::from_fn(masses, masses, |i, j| if i == j { rng.random_range(0.5..2.0) } else { 0.0 });
        [&m * 1e-2, k, m]
    }

    #[test]
    fn what_grows_far_beyond_the_band_is_found_wherever_it_is() {
        let [mut diverging, mut quiet] = [0; 2];
        for seed in 0..30 {
            let [c, k, m] = chain(seed, 160);
            let whole = SecondOrder::new(m.clone(), c.clone(), k.clone()).unwrap();
            let all = QrSolver.eigenvalues(&whole, &mut Workspace::default()).unwrap().eigenvalues;
            let expected = all.iter().any(|lambda| lambda.im >= 0.0 && lambda.re > lambda.im && lambda.re >= 1.0);
            let [m, c, k] = [m, c, k].map(|matrix| CscMatrix::from(&matrix));
            let system = SparseSecondOrder::new(m, c, k).unwrap();
            assert_eq!(
                diverges_beyond(&system, 1.0, (&Threshold::AXIS, &Options::default())),
                Some(expected),
                "{seed}"
            );
            diverging += usize::from(expected);
            quiet += usize::from(!expected);
        }
        assert!(diverging >= 8 && quiet >= 3, "{diverging} {quiet}");
    }
}
