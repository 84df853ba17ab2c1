//! Eigenvalues of a rectangle, all of them: discs until they cover it.

use num_complex::Complex;

use super::argument::{Around, Counting};
use super::certified::certified_in;
use super::disc::Problem;
use super::groups::groups;
use super::polish::Polished;
use super::reach::{least_reach, reach};
use super::scaling::Scaled;
use super::settle::settled;
use super::types::{Count, Counters, Disc, Eigenpair, Found, Known, Options, Progress, Rectangle};
use crate::{SparseError, SparseSecondOrder};

/// Half diagonal of the smallest rectangle that is searched, in units of the margin around what a disc covers; chosen.
const LEAST_SIZE: f64 = 8.0;
/// A strip narrower than this part of its target is not worth its disc; the target is cut in two instead.
const THINNEST: f64 = 0.1;
/// Shifts after which the size of a rectangle is estimated, and by how many times it has to be too large then; chosen, because
/// eigenvalues are not spread evenly.
const ESTIMATED: usize = 10;
const ESTIMATE_MARGIN: f64 = 4.0;
/// Factor by which the blocks of a second search are wider, where the count contradicts the first; chosen.
const WIDER: usize = 4;

/// Circles about a disc that may be counted along, from around what it covers to so many times its radius, which is 0.95 of where
/// something unknown may be; chosen.
const CIRCLES: usize = 9;
const BEYOND: f64 = 1.02;
const WIDEST: f64 = 1.5;
/// Radii up to which Ritz values that are none of the list are divided out; chosen.
const NEAR: f64 = 3.0;

/// Eigenpairs in `rectangle`, its border included, all of them.
///
/// A system of up to `options.certified` degrees of freedom is solved whole by `cea::certified`, and the list counted again by the
/// argument principle. Of larger ones discs around shifts cover the rectangle, and where M is positive definite nothing beyond the
/// largest |lambda| and |Re lambda| that the norms of the matrices allow ([`Found::reach`]). In each disc, all eigenvalues are known as far as
/// a block Krylov space of the shifted and inverted problem shows: it holds every eigenvector that its starting block is not orthogonal to, and
/// a second block checks the first. A block that comes back full of copies of one eigenvalue is widened. Up to `options.counted`
/// degrees of freedom the list is counted again by the argument principle.
///
/// # Errors
/// A rectangle that is none, Q singular at all shifts tried, a factorisation that does not fit into memory, solutions that
/// refinement does not make accurate, two counts that contradict each other, an eigenvalue that occurs too often, more shifts or
/// eigenvalues than allowed.
pub fn eigenpairs_in(
    system: &SparseSecondOrder,
    rectangle: &Rectangle,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<Found, SparseError> {
    rectangle.check()?;
    if system.order() <= options.certified
        && let Some(found) = certified_in(system, rectangle)?
    {
        return Ok(found);
    }
    match scaled_search(system, rectangle, options, progress) {
        // Most lists that are contradicted lack copies of an eigenvalue that has more of them than a block holds.
        Err(SparseError::CountsDiffer { .. }) => {
            scaled_search(system, rectangle, &Options { block: WIDER * options.block, ..*options }, progress)
        }
        found => found,
    }
}

/// A search in the units in which the matrices are even.
fn scaled_search(
    system: &SparseSecondOrder,
    rectangle: &Rectangle,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<Found, SparseError> {
    let scaled = Scaled::new(system);
    if !scaled.is_uneven() {
        return search(system, rectangle, options, progress);
    }
    search(&scaled.system, &rectangle.times(1.0 / scaled.gamma), options, progress)
        .map(|found| scaled.in_given_units(found, system))
        .map_err(|error| error.times(scaled.gamma))
}

fn search(
    system: &SparseSecondOrder,
    rectangle: &Rectangle,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<Found, SparseError> {
    let problem = Problem::new(system)?;
    let mut search = Search {
        problem: &problem,
        options,
        counters: Counters::default(),
        tried: 0,
        discs: Vec::new(),
        covered: Vec::new(),
        found: Vec::new(),
    };
    let upper = wide_enough(&problem, upper_part(rectangle));
    let reach = if rectangle.reach() > least_reach(system) { reach(system)? } else { None };
    if let Some(part) = reach.map_or(Some(upper), |reach| reach.within(&upper, problem.pencil.blur(Complex::default())))
    {
        if reach.is_some_and(|reach| reach.is_within(&upper)) {
            search.check_whole(2 * system.order() + system.states.len())?;
        }
        search.cover(part, progress)?;
    }
    let Search { mut counters, discs, covered, found, .. } = search;
    let mut pairs = settled(&problem, found, &mut counters)?;
    let count = if system.order() <= options.counted {
        counted(&problem, &upper, &pairs, &discs, &covered, options.block)?
    } else {
        Count::SecondBlock
    };
    pairs.retain_mut(|pair| {
        let reach = if pair.bound.is_finite() { pair.bound } else { problem.pencil.blur(pair.lambda) };
        pair.on_border = rectangle.border_distance(pair.lambda) <= reach;
        rectangle.contains(pair.lambda, reach)
    });
    pairs.sort_by(|a, b| cea::by_frequency(&a.lambda, &b.lambda));
    Ok(Found { pairs, discs, reach, is_certified: false, count, counters })
}

/// Counts the pairs again, in a circle about each disc: those of the list wherever they were searched, in both half planes, and beyond
/// the Ritz values of the disc.
///
/// # Errors
/// [`SparseError::CountsDiffer`].
fn counted(
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
    for (disc, Covered { part, seen, .. }) in discs.iter().zip(covered) {
        let is_beside =
            |seen: &&Known| !is_listed(seen.lambda) && (seen.lambda - disc.centre).norm() < NEAR * disc.radius;
        let beside: Vec<_> = seen.iter().filter(is_beside).copied().collect();
        // A block may not show all copies of what is not asked for.
        let places: Vec<_> = beside.iter().map(|known| known.lambda).collect();
        let is_crowded = groups(&places, blur).iter().any(|group| group.len() >= block);
        let known: Vec<_> = listed.iter().chain(&beside).copied().collect();
        let [x, y] = [(part.re, disc.centre.re), (part.im, disc.centre.im)]
            .map(|(side, c)| (side[0] - c).abs().max((side[1] - c).abs()));
        let (least, most) = (x.hypot(y) + margin, (BEYOND * disc.radius).min(WIDEST * x.hypot(y)));
        let radii: Vec<_> = (0..CIRCLES).map(|i| least + (most - least) * i as f64 / (CIRCLES - 1) as f64).collect();
        counting.add(&Around { centre: disc.centre, radii: &radii, known: &known, is_all: !is_crowded })?;
    }
    Ok(counting.done())
}

/// Part of a rectangle that has to be searched with Im lambda >= 0, since eigenvalues of real matrices are real or come in conjugate pairs.
fn upper_part(rectangle: &Rectangle) -> Rectangle {
    let [from, to] = rectangle.im;
    let im = if from >= 0.0 {
        [from, to]
    } else if to <= 0.0 {
        [-to, -from]
    } else {
        [0.0, to.max(-from)]
    };
    Rectangle { re: rectangle.re, im }
}

/// The rectangle, widened where it is smaller than what rounding does not tell apart: eigenvalues of no smaller one can be searched for, and which of
/// them the rectangle holds their bounds say.
fn wide_enough(problem: &Problem, upper: Rectangle) -> Rectangle {
    let least = LEAST_SIZE * problem.margin(&upper);
    if upper.half_diagonal() < least { upper.widened(least) } else { upper }
}

/// Part of the rectangle that a disc covers, and how far around it pairs are listed.
struct Covered {
    part: Rectangle,
    margin: f64,
    /// Ritz values of the disc, all of them.
    seen: Vec<Known>,
}

struct Search<'a> {
    problem: &'a Problem,
    options: &'a Options,
    counters: Counters,
    /// Shifts at which was searched, also those whose disc was too small to be of use.
    tried: usize,
    discs: Vec<Disc>,
    /// Parts that the discs cover, one of each disc.
    covered: Vec<Covered>,
    /// Pairs that were found, each with the number of the disc that found it.
    found: Vec<(usize, Polished)>,
}

impl Search<'_> {
    fn cover(&mut self, whole: Rectangle, progress: &mut dyn FnMut(Progress)) -> Result<(), SparseError> {
        let area = |r: &Rectangle| (r.re[1] - r.re[0]) * (r.im[1] - r.im[0]);
        let (mut left, mut covered) = (vec![whole], 0.0);
        while let Some(target) = left.pop() {
            self.check_size(covered / area(&whole))?;
            self.tried += 1;
            let (disc, candidates, seen) = self.problem.near_centre(&target, self.options, &mut self.counters)?;
            let margin = self.problem.margin(&target);
            let (done, rest) = split(&target, &disc, margin);
            left.extend(rest);
            let Some(done) = done else { continue };
            let here = candidates.into_iter().filter(|c| done.contains(c.lambda, margin)).collect();
            let tolerances = [self.options.tolerance, self.options.left_tolerance];
            let polished = self.problem.polished(here, tolerances, &mut self.counters)?;
            let number = self.discs.len();
            self.found.extend(polished.into_iter().map(|polished| (number, polished)));
            self.discs.push(disc);
            self.covered.push(Covered { part: done, margin, seen });
            covered += area(&done);
            progress(Progress { covered: covered / area(&whole), found: self.found.len(), shifts: self.discs.len() });
        }
        Ok(())
    }
}

impl Search<'_> {
    /// Pairs whose vectors are no larger than allowed: right and left, and those of the conjugate.
    fn most_pairs(&self) -> usize {
        self.options.bytes / (4 * size_of::<Complex<f64>>() * self.problem.pencil.order())
    }

    /// Refuses a rectangle around the whole spectrum, whose size is known before anything is searched; half of it is.
    fn check_whole(&self, eigenvalues: usize) -> Result<(), SparseError> {
        match self.most_pairs() {
            most if eigenvalues / 2 > most => Err(SparseError::WholeSpectrum { eigenvalues, most: 2 * most }),
            _ => Ok(()),
        }
    }

    /// Refuses a rectangle that needs more shifts or holds more eigenvalues than allowed, or will by what is known of it.
    fn check_size(&self, covered: f64) -> Result<(), SparseError> {
        let (shifts, found, most_shifts) = (self.tried, self.found.len(), self.options.shifts);
        let most_pairs = self.most_pairs();
        let margin = if shifts < ESTIMATED { f64::INFINITY } else { ESTIMATE_MARGIN };
        let will_exceed = |so_far: usize, most: usize| so_far as f64 > margin * covered * most as f64;
        let is_too_large = shifts >= most_shifts
            || found > most_pairs
            || will_exceed(shifts, most_shifts)
            || will_exceed(found, most_pairs);
        if is_too_large {
            return Err(SparseError::RectangleTooLarge { shifts, found, covered, most_shifts, most_pairs });
        }
        Ok(())
    }
}

/// The part of a target that a disc covers with a margin around it, all of it or a strip across the longer side, and what is left.
fn split(target: &Rectangle, disc: &Disc, margin: f64) -> (Option<Rectangle>, Vec<Rectangle>) {
    let offset = (disc.centre - target.centre()).norm();
    let radius = disc.radius - offset - 2.0 * margin;
    if radius >= target.half_diagonal() {
        return (Some(*target), Vec::new());
    }
    let (width, height) = (target.re[1] - target.re[0], target.im[1] - target.im[0]);
    let is_tall = height >= width;
    let (across, along) = if is_tall { (width, height) } else { (height, width) };
    let half = (radius * radius - 0.25 * across * across).max(0.0).sqrt();
    let with =
        |side: [f64; 2]| if is_tall { Rectangle { im: side, ..*target } } else { Rectangle { re: side, ..*target } };
    let [from, to] = if is_tall { target.im } else { target.re };
    let middle = from + 0.5 * along;
    if radius <= 0.0 || half < 0.5 * THINNEST * across.min(along) {
        return (None, vec![with([middle, to]), with([from, middle])]);
    }
    let (low, high) = (middle - half, middle + half);
    (Some(with([low, high])), vec![with([high, to]), with([from, low])])
}
