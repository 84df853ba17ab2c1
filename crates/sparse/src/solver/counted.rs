//! Second count of what a search lists: around each of its discs, and around what it lists more than once.

use num_complex::Complex;

use super::argument::{Around, Counting};
use super::disc::Problem;
use super::groups::groups;
use super::types::{Count, Covered, Disc, Eigenpair, Known, Rectangle};
use crate::SparseError;

/// Number of circles about a disc that may be counted along, from the smallest around what it covers outwards; chosen.
const CIRCLES: usize = 9;
/// Radius of the largest of these circles, as a multiple of the radius of the disc; chosen: the radius of the disc is 0.95 of the distance of what may be
/// unknown.
const BEYOND: f64 = 1.02;
/// Radius of the largest of these circles, as a multiple of the radius of the circle around what the disc covers, where this is less than by [`BEYOND`];
/// chosen.
const WIDEST: f64 = 1.5;
/// Largest distance of eigenvalues that are counted together as copies of one, in blurs, the distance to which rounding moves one apart; chosen: with less, a
/// circle about copies comes so near to them that rounding turns the phase; with more, neighbours are in it, too.
const CLUSTER: f64 = 100.0;
/// Radii of the circles about copies of one eigenvalue, as fractions of the distance of the nearest other eigenvalue; chosen: half the distance is as far from
/// the other as from the copies, and smaller circles are tried where the phase jumps on it.
const FRACTIONS: [f64; 4] = [0.5, 0.3, 0.1, 0.03];
/// Largest distance from the centre of a disc, in its radii, of Ritz values that are divided out though they are not in the list; chosen: what is
/// known outside of a circle only makes the phase along it smoother.
const NEAR: f64 = 3.0;

/// Counts the pairs again, in a circle about each disc. Known are the pairs of the list wherever they were searched, in both half planes, and outside of the
/// rectangle the Ritz values of the disc.
///
/// # Errors
/// [`SparseError::CountsDiffer`].
pub(super) fn counted(
    problem: &Problem,
    upper: &Rectangle,
    pairs: &[Eigenpair],
    discs: &[Disc],
    covered: &[Covered],
    block: usize,
) -> Result<Count, SparseError> {
    let margin = covered.iter().map(|covered| covered.margin).fold(f64::INFINITY, f64::min);
    let is_listed = |lambda: Complex<f64>| upper.contains(Complex::new(lambda.re, lambda.im.abs()), margin);
    let blur = |lambda| problem.pencil.blur(lambda);
    let own = |pair: &Eigenpair| {
        let bound = if pair.bound.is_finite() { pair.bound } else { blur(pair.lambda) };
        Known { lambda: pair.lambda, bound }
    };
    let listed: Vec<_> = pairs.iter().map(own).collect();
    let mut counting = Counting::new(problem, 1.0, false);
    let mut all_beside = Vec::new();
    for (disc, Covered { part, seen, .. }) in discs.iter().zip(covered) {
        let is_beside =
            |seen: &&Known| !is_listed(seen.lambda) && (seen.lambda - disc.centre).norm() < NEAR * disc.radius;
        let beside: Vec<_> = seen.iter().filter(is_beside).copied().collect();
        // A block may not show all copies of what is not asked for.
        let places: Vec<_> = beside.iter().map(|known| known.lambda).collect();
        let is_crowded = groups(&places, blur).iter().any(|group| group.len() >= block);
        let known: Vec<_> = listed.iter().chain(&beside).copied().collect();
        all_beside.extend(beside);
        let [x, y] = [(part.re, disc.centre.re), (part.im, disc.centre.im)]
            .map(|(side, c)| (side[0] - c).abs().max((side[1] - c).abs()));
        let (least, most) = (x.hypot(y) + margin, (BEYOND * disc.radius).min(WIDEST * x.hypot(y)));
        let radii: Vec<_> = (0..CIRCLES).map(|i| least + (most - least) * i as f64 / (CIRCLES - 1) as f64).collect();
        counting.add(&Around { centre: disc.centre, radii: &radii, known: &known, is_all: !is_crowded })?;
    }
    count_copies(problem, &listed, &all_beside, discs, &mut counting)?;
    Ok(counting.done())
}

/// Counts the copies of each eigenvalue that is listed more than once again, along a circle that holds no other: one more of them in the place
/// of another eigenvalue leaves the count of a whole disc as it is.
///
/// # Errors
/// [`SparseError::CountsDiffer`].
fn count_copies(
    problem: &Problem,
    listed: &[Known],
    beside: &[Known],
    discs: &[Disc],
    counting: &mut Counting<'_>,
) -> Result<(), SparseError> {
    let places: Vec<_> = listed.iter().chain(beside).map(|known| known.lambda).collect();
    for group in groups(&places, |lambda| CLUSTER * problem.pencil.blur(lambda)) {
        let centre = group.iter().map(|&i| places[i]).sum::<Complex<f64>>() / group.len() as f64;
        // Of one that is not asked for a block may not show all copies; conjugates have as many.
        let is_whole = group.iter().all(|&i| i < listed.len());
        if group.len() == 1 || centre.im < 0.0 || !is_whole {
            continue;
        }
        let distance = |i: usize| (places[i] - centre).norm();
        let spread = group.iter().map(|&i| distance(i)).fold(CLUSTER * problem.pencil.blur(centre), f64::max);
        let known_around = discs.iter().map(|disc| disc.radius - (disc.centre - centre).norm()).fold(0.0, f64::max);
        let nearest = (0..places.len()).map(distance).filter(|&apart| apart > spread).fold(known_around, f64::min);
        let radii = FRACTIONS.map(|fraction| (fraction * nearest).max(1.1 * spread));
        // Where no circle is clear of rounding, the count of the disc stands as it is.
        if radii[0] > radii[1] {
            counting.agrees(&Around { centre, radii: &radii, known: listed, is_all: true })?;
        }
    }
    Ok(())
}
