//! Modes of the whole brake, and how far the modes of a reduced brake are from them.

use cea::{ROUNDED_DATA, frequency_hz, grows_too_fast};
use linsys::OperatingPoint;
use num_complex::Complex;
use reduction::{compared, largest_residual};
use sparse::{Eigenpair, Rectangle, SparseSecondOrder, eigenpairs_in};
use study::{BandMode, ModeResidual, Scene};

use super::FiniteElementBrake;
use super::points::{all_patches, naming_point, of_brake};
use super::reduced_set::{Part, ReducedSet};
use super::set_basis::HeldOut;
use super::together::search_options;
use super::training::{AT_BORDER, Closed, rectangle};
use crate::Error;
use crate::case::FiniteElementCase;

/// Least upper border of Re lambda of the search in the whole brake, as a multiple of the growth of the fastest mode of the reduced one; chosen: with less, a
/// mode that grows faster in the whole brake may be missed; with more, the search takes longer.
const BEYOND: f64 = 1.5;
/// Factor by which the band is widened at both ends to look for growing modes beside it; chosen: with more, the search takes longer.
const BESIDE: f64 = 1.05;
/// Largest |Re lambda|, as a fraction of |lambda|, of a mode whose verdict an error may change; chosen: with less, errors that may change a verdict are not
/// looked at; with more, errors that change none ask for more training.
const NEXT_TO_AXIS: f64 = 0.02;

/// Modes of a whole brake in the rectangle of a case, which is extended to the right beyond the largest growth among the modes `reduced` of the reduced
/// brake, and those that are next to the band, where so many searches are under way `together`.
pub(super) fn modes_beside(
    case: &FiniteElementCase,
    system: &SparseSecondOrder,
    reduced: &[Complex<f64>],
    together: usize,
) -> Result<Vec<Complex<f64>>, Error> {
    Ok(lambdas(pairs_in(system, with_beside(rectangle(case)), reduced, together)?))
}

/// A rectangle with what is next to it in frequency.
fn with_beside(rectangle: Rectangle) -> Rectangle {
    let [low, high] = rectangle.im;
    Rectangle { im: [low / BESIDE, high * BESIDE], ..rectangle }
}

fn lambdas(pairs: Vec<Eigenpair>) -> Vec<Complex<f64>> {
    pairs.into_iter().map(|pair| pair.lambda).collect()
}

/// Largest growth rate of modes, 1/s; 0 where none grows.
fn fastest(modes: &[Complex<f64>]) -> f64 {
    modes.iter().map(|lambda| lambda.re).fold(0.0, f64::max)
}

/// All modes in a rectangle, and to the right of it up to what a reduced brake has there at least, but those that grow faster than they oscillate.
fn pairs_in(
    system: &SparseSecondOrder,
    mut rectangle: Rectangle,
    reduced: &[Complex<f64>],
    together: usize,
) -> Result<Vec<Eigenpair>, Error> {
    rectangle.re[1] = rectangle.re[1].max(BEYOND * fastest(reduced));
    let mut found = eigenpairs_in(system, &rectangle, &search_options(together), &mut |_| {})?.pairs;
    found.retain(|pair| !grows_too_fast(pair.lambda));
    Ok(found)
}

impl FiniteElementBrake {
    /// Modes of the whole brake in a scene at an operating point of it, where the case wants them, by ascending frequency; shapes are over its free rows. With them the
    /// frequencies, Hz, of others that surely grow next to the band.
    ///
    /// # Errors
    /// A point that the brake refuses, what [`eigenpairs_in`] refuses.
    pub fn whole_modes(&self, scene: &Scene, at: &OperatingPoint) -> Result<(Vec<BandMode>, Vec<f64>), Error> {
        let (part, wanted) = (self.part(scene), rectangle(&self.case));
        let system = self.sets[part.set].system.assemble(at)?;
        let pairs = pairs_in(&system, with_beside(wanted), &part.reduced.modes(at)?.lambdas, 1)?;
        let is_wanted = |pair: &Eigenpair| wanted.contains_to_the_right(pair.lambda, 0.0);
        let (mut pairs, beside): (Vec<_>, Vec<_>) = pairs.into_iter().partition(is_wanted);
        pairs.sort_by(|a, b| a.lambda.im.total_cmp(&b.lambda.im));
        let on_axis = self.on_axis(scene, at, &pairs.iter().map(|pair| pair.lambda).collect::<Vec<_>>());
        let mode = |(pair, is_on_axis): (Eigenpair, bool)| BandMode {
            lambda: pair.lambda,
            shape: pair.right,
            bound: ROUNDED_DATA * pair.bound,
            is_on_axis,
            residual: Some(ModeResidual { value: pair.backward_error, is_above: false }),
        };
        let grows = |pair: &&Eigenpair| self.plan.threshold.margin(pair.lambda) > ROUNDED_DATA * pair.bound;
        let mut beside: Vec<f64> = beside.iter().filter(grows).map(|pair| frequency_hz(pair.lambda)).collect();
        beside.retain(|hz| !(wanted.im[0]..=wanted.im[1]).contains(&(std::f64::consts::TAU * hz)));
        beside.sort_by(f64::total_cmp);
        Ok((pairs.into_iter().zip(on_axis).map(mode).collect(), beside))
    }
}

/// The modes of the whole brake in the rectangle of a case, as by [`modes_beside`], at the naming point of the configuration with the patches `closed` in contact.
pub(super) fn modes_at_medians(
    case: &FiniteElementCase,
    set: &ReducedSet,
    closed: &[usize],
    reduced: &[Complex<f64>],
) -> Result<Vec<Complex<f64>>, Error> {
    let wanted = rectangle(case);
    if closed == all_patches(case) && BEYOND * fastest(reduced) <= wanted.re[1] {
        return Ok(set.at_medians.iter().copied().filter(|&lambda| wanted.contains(lambda, 0.0)).collect());
    }
    let at = of_brake(case, closed, &naming_point(case, closed)?);
    Ok(lambdas(pairs_in(&set.system.assemble(&at)?, wanted, reduced, set.together.count())?))
}

/// True of an eigenvalue so near the imaginary axis that an error may change its verdict.
pub(super) fn is_next_to_axis(lambda: Complex<f64>) -> bool {
    lambda.re.abs() <= NEXT_TO_AXIS * lambda.norm()
}

/// The largest distance of modes next to the imaginary axis, on the bases of the parts, from the modes of the whole brake at draws that are held out; 1 where
/// either brake has such a mode that the other does not have. With it the largest residual of these modes on the bases of the parts.
pub(super) fn held_out<'a>(
    case: &FiniteElementCase,
    drawn: &[HeldOut],
    part: impl Fn(&Closed) -> Option<&'a Part>,
) -> Result<(f64, f64), Error> {
    let rectangle = rectangle(case);
    let is_next_to = |lambda: &&Complex<f64>| {
        is_next_to_axis(**lambda) && rectangle.contains_to_the_right(**lambda, -AT_BORDER * lambda.norm())
    };
    let next_to = |of: &[Complex<f64>]| of.iter().filter(is_next_to).copied().collect::<Vec<_>>();
    let (mut largest, mut residual) = (0.0_f64, 0.0_f64);
    for HeldOut { drawn, modes: whole } in drawn {
        let Some(part) = part(&drawn.closed) else { return Ok((1.0, residual)) };
        let found = part.reduced.modes(&drawn.at)?;
        let of_these = found.lambdas.iter().zip(&found.residuals).filter(|(lambda, _)| is_next_to(lambda));
        residual = largest_residual(of_these.map(|(_, &own)| own).chain([residual]));
        let reduced = found.lambdas;
        let [of_whole, of_reduced] =
            [(whole, &reduced), (&reduced, whole)].map(|(of, others)| compared(&next_to(of), others));
        let has_others = !(of_whole.missed.is_empty() && of_reduced.missed.is_empty());
        largest = largest.max(if has_others { 1.0 } else { of_whole.distance });
    }
    Ok((largest, residual))
}
