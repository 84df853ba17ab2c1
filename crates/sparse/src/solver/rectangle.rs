//! Eigenvalues of a rectangle, all of them: discs until they cover it.

use num_complex::Complex;

use super::certified::certified_in;
use super::counted::counted;
use super::disc::Problem;
use super::on_axis::settle_undamped;
use super::polish::Polished;
use super::reach::{least_reach, reach};
use super::scaling::Scaled;
use super::settle::settled;
use super::types::{Count, Counters, Covered, Disc, Found, Options, Progress, Rectangle};
use crate::{SparseError, SparseSecondOrder};

/// Half diagonal of the smallest rectangle that is searched, in units of the margin around what a disc covers; chosen: a smaller one would be mostly margin.
const LEAST_SIZE: f64 = 8.0;
/// A strip narrower than this fraction of the shorter side of its target is not worth its disc; the target is cut in two instead. Chosen: with less long
/// targets are covered by many thin strips, with more they are cut where a strip would do.
const THINNEST: f64 = 0.1;
/// Number of shifts after which the size of a rectangle is estimated; chosen: with fewer, the estimate is poorer; with more, a rectangle that is too large is
/// refused later.
const ESTIMATED: usize = 10;
/// Factor by which a rectangle that is refused by this estimate is too large; chosen, because eigenvalues are not spread evenly.
const ESTIMATE_MARGIN: f64 = 4.0;
/// Factor by which the blocks of a second search are wider, where the count contradicts the first; chosen: most of these lists lack copies of an eigenvalue
/// that has more of them than a block has columns.
const WIDER: usize = 4;

/// Eigenpairs in `rectangle`, its border included, all of them.
///
/// A system of up to `options.certified` degrees of freedom, without structural damping, is solved whole by `cea::certified`, and the list counted again by
/// the argument principle. Of larger ones discs around shifts cover the rectangle, and where M is positive definite nothing beyond the largest |lambda| and
/// |Re lambda| that the norms of the matrices allow ([`Found::reach`]). In each disc, all eigenvalues are known as far as a block Krylov space of the
/// shifted and inverted problem shows: it holds every eigenvector that its starting block is not orthogonal to, and a second block checks the first. A
/// block that comes back full of copies of one eigenvalue is widened. Up to `options.counted` degrees of freedom, without structural damping, the list is
/// counted again by the argument principle. Without damping an eigenvalue that no other is near is on the imaginary axis, and marginal.
///
/// # Errors
/// A rectangle that is empty, reversed or not finite, or not above the real axis where there is structural damping; Q singular at all shifts tried; a
/// factorisation that does not fit into memory; solutions that refinement does not make accurate; two counts that contradict each other; an eigenvalue that
/// occurs too often; a group of eigenvalues that is not found again in the space of its vectors; more shifts or eigenvalues than allowed.
pub fn eigenpairs_in(
    system: &SparseSecondOrder,
    rectangle: &Rectangle,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<Found, SparseError> {
    rectangle.check()?;
    if system.h.is_some() && rectangle.im[0] <= 0.0 {
        return Err(SparseError::StructuralDamping { from: rectangle.im[0] });
    }
    if system.order() <= options.certified
        && system.h.is_none()
        && let Some(found) = certified_in(system, rectangle)?
    {
        return Ok(found);
    }
    let found = match scaled_search(system, rectangle, options, progress) {
        // Most lists that are contradicted lack copies of an eigenvalue that has more of them than a block holds.
        Err(SparseError::CountsDiffer { .. }) => {
            scaled_search(system, rectangle, &Options { block: WIDER * options.block, ..*options }, progress)
        }
        found => found,
    };
    let mut found = found?;
    settle_undamped(system, rectangle, &mut found.pairs);
    Ok(found)
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
    let problem = Problem::new(system)?.with_threads(options.threads);
    let mut search = Search::new(&problem, options);
    let most = 2 * system.order() + system.states.len();
    let upper = wide_enough(&problem, upper_part(rectangle));
    // Structural damping is in no bound.
    let is_bounded = system.h.is_none() && rectangle.reach() > least_reach(system);
    let reach = if is_bounded { reach(system)? } else { None };
    if let Some(part) = reach.map_or(Some(upper), |reach| reach.within(&upper, problem.pencil.blur(Complex::default())))
    {
        if reach.is_some_and(|reach| reach.is_within(&upper)) {
            search.check_whole(most)?;
        }
        search.cover(part, progress)?;
    }
    let Search { mut counters, discs, covered, found, .. } = search;
    let mut pairs = settled(&problem, found, &mut counters)?;
    if pairs.len() > most {
        let (centre, radius) = (Complex::default(), upper.reach());
        return Err(SparseError::CountsDiffer { listed: pairs.len(), counted: most, centre, radius });
    }
    let count = if system.order() <= options.counted && system.h.is_none() {
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

/// The rectangle with Im lambda >= 0 that has to be searched for a given one, since eigenvalues of real matrices are real or come in conjugate pairs.
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

/// The rectangle, widened where it is smaller than what rounding does not tell apart: a smaller one cannot be searched, and the bounds of what is found say
/// which eigenvalues are in the one given.
fn wide_enough(problem: &Problem, upper: Rectangle) -> Rectangle {
    let least = LEAST_SIZE * problem.margin(&upper);
    if upper.half_diagonal() < least { upper.widened(least) } else { upper }
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

impl<'a> Search<'a> {
    fn new(problem: &'a Problem, options: &'a Options) -> Self {
        let (counters, discs, covered, found) = (Counters::default(), Vec::new(), Vec::new(), Vec::new());
        Self { problem, options, counters, tried: 0, discs, covered, found }
    }
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
            progress(Progress {
                covered: (covered / area(&whole)).min(1.0),
                found: self.found.len(),
                shifts: self.discs.len(),
            });
        }
        Ok(())
    }
}

impl Search<'_> {
    /// Number of pairs whose vectors take the memory allowed: the right and the left vector of each pair and of its conjugate.
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use nalgebra_sparse::CscMatrix;

    use super::*;
    use crate::unpatterned::unpatterned;

    /// Three equal oscillators and seven others, mixed by a reflection.
    fn with_copies(seed: usize) -> SparseSecondOrder {
        let n = 10;
        let value = |i: usize| unpatterned((1 + i + 100 * seed) as f64);
        let v = DVector::from_fn(n, |i, _| value(i) - 0.5).normalize();
        let mixed = |diagonal: DVector<f64>| {
            let reflection = DMatrix::identity(n, n) - &v * v.transpose() * 2.0;
            CscMatrix::from(&(&reflection * DMatrix::from_diagonal(&diagonal) * &reflection))
        };
        let of = |i: usize| if i < 3 { 0 } else { i };
        let c = DVector::from_fn(n, |i, _| 0.02 + 0.1 * value(20 + of(i)));
        let k = DVector::from_fn(n, |i, _| 1.0 + 0.7 * of(i) as f64 + 0.3 * value(40 + of(i)));
        SparseSecondOrder::new(mixed(DVector::from_element(n, 1.0)), mixed(c), mixed(k)).unwrap()
    }

    #[test]
    fn a_copy_in_the_place_of_another_eigenvalue_is_seen() {
        for seed in 0..20 {
            let problem = Problem::new(&with_copies(seed)).unwrap();
            let upper = Rectangle { re: [-1.0, 1.0], im: [0.0, 4.0] };
            let options = Options::default();
            let mut search = Search::new(&problem, &options);
            search.cover(upper, &mut |_| ()).unwrap();
            let Search { mut counters, discs, covered, found, .. } = search;
            let mut pairs = settled(&problem, found, &mut counters).unwrap();
            let count = |pairs: &[_]| counted(&problem, &upper, pairs, &discs, &covered, options.block);
            assert_eq!(pairs.len(), 20, "{seed}");
            assert!(matches!(count(&pairs), Ok(Count::Argument { .. })), "{seed}");
            pairs.sort_by(|a, b| cea::by_frequency(&a.lambda, &b.lambda));
            for sign in [1.0, -1.0] {
                let mut half: Vec<_> = pairs.iter_mut().filter(|pair| pair.lambda.im * sign > 0.0).collect();
                let copied = half[0].lambda;
                half[3 + seed % 7].lambda = copied;
            }
            assert!(matches!(count(&pairs), Err(SparseError::CountsDiffer { .. })), "{seed}");
        }
    }
}
