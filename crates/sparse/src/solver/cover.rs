//! All eigenvalues of a rectangle: discs until they cover it.

use faer::Mat;
use nalgebra::DVector;
use num_complex::Complex;

use super::disc::Problem;
use super::pencil::Pencil;
use super::products::Side;
use super::reach::{least_reach, reach};
use super::types::{Counters, Disc, Eigenpair, Found, Options, Progress, Rectangle};
use crate::{SparseError, SparseSecondOrder};

/// Distance of the same eigenvalue found twice, relative.
const FOUND_TWICE: f64 = 1e-9;
/// Part of a unit vector outside the span of others below which it is none of its own.
const INDEPENDENT: f64 = 1e-4;
/// A strip narrower than this part of its target is not worth its disc; the target is cut in two instead.
const THINNEST: f64 = 0.1;
/// Shifts after which the size of a rectangle is estimated, and by how many times it has to be too large then; chosen, because
/// eigenvalues are not spread evenly.
const ESTIMATED: usize = 10;
const ESTIMATE_MARGIN: f64 = 4.0;
/// Part of |lambda| below which an imaginary part is rounding where the vector is real.
const REAL: f64 = 1e-6;

/// All eigenvalues in `rectangle`, its border included, with their vectors.
///
/// Where M is positive definite nothing is searched beyond the largest |lambda| and |Re lambda| that the norms of the matrices allow
/// ([`Found::reach`]). Discs around shifts cover the rest. In each, all eigenvalues are known as far as a block Krylov space of the shifted and
/// inverted problem shows: it holds every eigenvector that its starting block is not orthogonal to, and multiple eigenvalues up to
/// the size of a block. Every pair returned has a backward error of at most `options.tolerance`.
///
/// # Errors
/// A rectangle that is none, Q singular at all shifts tried, a factorisation that does not fit into memory, solutions that
/// refinement does not make accurate, a pair that does not converge, more shifts or eigenvalues than allowed.
pub fn eigenpairs_in(
    system: &SparseSecondOrder,
    rectangle: &Rectangle,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<Found, SparseError> {
    rectangle.check()?;
    let problem = Problem::new(system)?;
    let mut search = Search {
        problem: &problem,
        options,
        counters: Counters::default(),
        tried: 0,
        discs: Vec::new(),
        pairs: Vec::new(),
    };
    let upper = upper_part(rectangle);
    let reach = if rectangle.reach() > least_reach(system) { reach(system)? } else { None };
    if let Some(part) = reach.map_or(Some(upper), |reach| reach.within(&upper)) {
        if reach.is_some_and(|reach| reach.is_within(&upper)) {
            search.check_whole(2 * system.order() + system.states.len())?;
        }
        search.cover(part, progress)?;
    }
    let Search { counters, discs, pairs, .. } = search;
    let mut pairs = both_halves(&problem.pencil, without_duplicates(pairs), rectangle);
    pairs.sort_by(|a, b| cea::by_frequency(&a.lambda, &b.lambda));
    Ok(Found { pairs, discs, reach, counters })
}

/// What has to be searched with Im lambda >= 0, since eigenvalues of real matrices are real or come in conjugate pairs.
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

struct Search<'a> {
    problem: &'a Problem,
    options: &'a Options,
    counters: Counters,
    /// Shifts at which was searched, also those whose disc was too small to be of use.
    tried: usize,
    discs: Vec<Disc>,
    /// With the number of the disc that found them.
    pairs: Vec<(usize, Eigenpair)>,
}

impl Search<'_> {
    fn cover(&mut self, whole: Rectangle, progress: &mut dyn FnMut(Progress)) -> Result<(), SparseError> {
        let area = |r: &Rectangle| (r.re[1] - r.re[0]) * (r.im[1] - r.im[0]);
        let (mut left, mut covered) = (vec![whole], 0.0);
        while let Some(target) = left.pop() {
            self.check_size(covered / area(&whole))?;
            self.tried += 1;
            let (disc, candidates) = self.problem.near_centre(&target, self.options, &mut self.counters)?;
            let (done, rest) = split(&target, &disc);
            left.extend(rest);
            let Some(done) = done else { continue };
            let margin = 1e-7 * whole.reach();
            let here = candidates.into_iter().filter(|c| done.contains(c.lambda, margin)).collect();
            let tolerances = [self.options.tolerance, self.options.left_tolerance];
            let pairs = self.problem.polish(here, tolerances, &mut self.counters)?;
            let number = self.discs.len();
            self.pairs.extend(pairs.into_iter().map(|pair| (number, pair)));
            self.discs.push(disc);
            covered += area(&done);
            progress(Progress { covered: covered / area(&whole), found: self.pairs.len(), shifts: self.discs.len() });
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
        let (shifts, found, most_shifts) = (self.tried, self.pairs.len(), self.options.shifts);
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

/// The part of a target that a disc covers, all of it or a strip across the longer side, and what is left.
fn split(target: &Rectangle, disc: &Disc) -> (Option<Rectangle>, Vec<Rectangle>) {
    let offset = (disc.centre - target.centre()).norm();
    let radius = disc.radius - offset;
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

/// Pairs that two discs found are kept once.
fn without_duplicates(found: Vec<(usize, Eigenpair)>) -> Vec<Eigenpair> {
    let mut kept: Vec<(usize, Eigenpair)> = Vec::with_capacity(found.len());
    for (disc, pair) in found {
        let near = |other: &(usize, Eigenpair)| {
            let reach = (FOUND_TWICE * pair.lambda.norm()).max(pair.bound()).max(other.1.bound());
            other.0 != disc && (other.1.lambda - pair.lambda).norm() <= reach
        };
        let mut outside = pair.right.clone();
        let mut basis: Vec<DVector<Complex<f64>>> = Vec::new();
        for (_, other) in kept.iter().filter(|other| near(other)) {
            let mut direction = other.right.clone();
            basis.iter().for_each(|b| direction -= b * b.dotc(&direction));
            if direction.norm() > INDEPENDENT {
                let direction = direction.normalize();
                outside -= &direction * direction.dotc(&outside);
                basis.push(direction);
            }
        }
        if outside.norm() > INDEPENDENT {
            kept.push((disc, pair));
        }
    }
    kept.into_iter().map(|(_, pair)| pair).collect()
}

/// The pairs of the upper half plane and their conjugates, those of the rectangle.
fn both_halves(pencil: &Pencil, upper: Vec<Eigenpair>, rectangle: &Rectangle) -> Vec<Eigenpair> {
    let mut all = Vec::with_capacity(upper.len());
    for pair in upper {
        if is_real(&pair) {
            let real = |v: &DVector<Complex<f64>>| v.map(|z| Complex::from(z.re));
            let (lambda, right, left) = (Complex::from(pair.lambda.re), real(&pair.right), real(&pair.left));
            let (right, left) = (right.normalize(), left.normalize());
            let parts = pencil.parts(Side::Right, &Mat::from_fn(right.len(), 1, |i, _| right[i]));
            let backward_error = parts[0].sum(&pencil.weights(lambda)).norm() / pencil.size(lambda);
            all.push(Eigenpair { lambda, right, left, backward_error, ..pair });
        } else if pair.lambda.im >= 0.0 {
            let (right, left) = (pair.right.conjugate(), pair.left.conjugate());
            all.push(Eigenpair { lambda: pair.lambda.conj(), right, left, ..pair.clone() });
            all.push(pair);
        }
    }
    let mut inside = Vec::with_capacity(all.len());
    for mut pair in all {
        let bound = if pair.bound().is_finite() { pair.bound() } else { 0.0 };
        pair.on_border = rectangle.border_distance(pair.lambda) <= bound;
        if rectangle.contains(pair.lambda, bound) {
            inside.push(pair);
        }
    }
    inside
}

/// A vector that is its own conjugate belongs to a real eigenvalue; the phase is fixed, the largest entry real.
fn is_real(pair: &Eigenpair) -> bool {
    let imaginary = pair.right.iter().map(|z| z.im * z.im).sum::<f64>().sqrt();
    pair.lambda.im.abs() <= REAL * pair.lambda.norm() && imaginary <= REAL
}
