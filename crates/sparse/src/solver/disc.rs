//! Disc: all eigenvalues near one shift, by a right and a left Krylov space with one factorisation.

use faer::Mat;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::blocks::{another_block, starting_block};
use super::errors::{blocks_until, errors};
use super::factor::{Factor, Symbolic};
use super::groups::groups;
use super::krylov::Krylov;
use super::left::left_vectors;
use super::pencil::Pencil;
use super::products::Side;
use super::ritz::Ritz;
use super::types::{Counters, Disc, Known, Options, Rectangle};
use crate::{SparseError, SparseSecondOrder};

/// Largest relative residual of a Ritz value outside the rectangle whose place is known; chosen: larger than [`NEARLY`], as the place of an eigenvalue outside
/// need be known to fewer digits. Less makes spaces larger, more trusts a disc up to an eigenvalue whose place is not yet known.
const SEEN: f64 = 1e-6;
/// Largest relative residual of a Ritz value inside the rectangle whose place is known; chosen: smaller than [`SEEN`], as the place of an eigenvalue inside
/// has to be known to more digits.
const NEARLY: f64 = 1e-8;
/// Largest backward error of a wanted right Ritz vector that is good enough: some rounding errors.
const ENOUGH: f64 = 16.0 * f64::EPSILON;
/// Largest relative residual of a Ritz value whose vector is good enough though its backward error does not become so small; chosen: with less, spaces grow
/// though no backward error becomes smaller; with more, vectors have fewer digits.
const CONVERGED: f64 = 1e-13;
/// Radius of a disc, as a fraction of the distance at which the first eigenvalue is expected that is not yet known; chosen: with less, discs are smaller; with
/// more, that eigenvalue may be inside, as its place is not known.
const TRUSTED: f64 = 0.95;
/// Number of columns before the first look at the Ritz values; chosen: fewer have hardly any that is known, more may be too many where few are wanted.
const FIRST_LOOK: usize = 40;
/// Number of columns before the radius of a disc grows about evenly with them; chosen.
const HIDDEN: usize = 20;
/// Growth of the basis after a look, as a fraction of the columns that are missing if the radius grows evenly beyond [`HIDDEN`]; chosen: with less, there are
/// more looks; with more, columns that are not needed.
const OF_MISSING: f64 = 0.75;
/// Number of columns of the block by which the first block is checked; chosen: the fewest that show a multiple eigenvalue which the first block holds once.
/// More take more solutions at every disc.
const CHECKED_BY: usize = 2;
/// Number of steps that both blocks then make together; chosen likewise.
const CHECK_STEPS: usize = 3;
/// Factor by which a space may have more columns than [`Options::columns`], and a block more than [`Options::block`] or [`WIDEST`], whichever is more: for
/// the second block that checks the first, and where blocks come back full; chosen.
const GROWN: usize = 4;
/// Number of columns that a narrower block is taken to have in [`GROWN`]; chosen.
const WIDEST: usize = 16;
/// Number of shifts that are tried, the first one included, where Q(shift) is singular; chosen: a shift hits an eigenvalue by chance alone, so that more
/// than one further is needed only where Q is singular everywhere, which is refused.
const ATTEMPTS: usize = 4;

/// A system that is ready to be solved with at many lambda: its matrices, and the elimination order of their pattern.
pub struct Problem {
    pub(crate) pencil: Pencil,
    pub(crate) symbolic: Symbolic,
}

/// A Ritz value with its vectors.
pub(crate) struct Candidate {
    pub(crate) lambda: Complex<f64>,
    /// phi, not normalised.
    pub(crate) right: Vec<Complex<f64>>,
    /// The conjugate of psi; `None` where the left Krylov space does not show it accurately enough.
    pub(crate) left: Option<Vec<Complex<f64>>>,
}

impl Problem {
    /// Finds the elimination order.
    ///
    /// # Errors
    /// An elimination order that does not fit into memory.
    pub fn new(system: &SparseSecondOrder) -> Result<Self, SparseError> {
        let pencil = Pencil::new(system);
        let symbolic = Symbolic::new(&pencil)?;
        Ok(Self { pencil, symbolic })
    }

    /// Problem with so many threads for factors and solutions, of large systems that fall into parts. No result depends on the number.
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.symbolic.threads = threads;
        self
    }

    /// Solution `Q(lambda)^-1 F`, n x m, for a real n x m block F.
    ///
    /// # Errors
    /// Q singular there, a solution that refinement does not make accurate, a factorisation that does not fit into memory.
    pub fn solve(&self, lambda: Complex<f64>, forces: &DMatrix<f64>) -> Result<DMatrix<Complex<f64>>, SparseError> {
        let right = Mat::from_fn(forces.nrows(), forces.ncols(), |i, j| Complex::from(forces[(i, j)]));
        let solution = Factor::new(&self.symbolic, &self.pencil, lambda)?.solve(Side::Right, &right)?;
        Ok(DMatrix::from_fn(solution.nrows(), solution.ncols(), |i, j| solution[(i, j)]))
    }

    /// The backward and the relative forward error of a solution with Q(lambda), infinite where Q(lambda) is singular.
    ///
    /// # Errors
    /// A factorisation that does not fit into memory.
    pub(crate) fn solution_errors(&self, lambda: Complex<f64>) -> Result<(f64, f64), SparseError> {
        let known = starting_block(self.pencil.order(), 1);
        match Factor::new(&self.symbolic, &self.pencil, lambda) {
            Ok(factor) => factor.errors(&known),
            Err(SparseError::Singular { .. }) => Ok((f64::INFINITY, f64::INFINITY)),
            Err(other) => Err(other),
        }
    }

    /// The eigenvalues of `target` near its centre: those in the disc, which need not cover the target; and all Ritz values, those outside the disc with
    /// the bound 0.
    pub(super) fn near_centre(
        &self,
        target: &Rectangle,
        options: &Options,
        counters: &mut Counters,
    ) -> Result<(Disc, Vec<Candidate>, Vec<Known>), SparseError> {
        let factor = self.factor_near(target, counters)?;
        let sigma = factor.shift();
        let needed = target.half_diagonal() + (sigma - target.centre()).norm();
        let scale = sigma.norm().max(needed);
        let mut capacity = options.columns.max(2 * options.block);
        let (most, widest) = (GROWN * capacity, GROWN * options.block.max(WIDEST));
        let (mut width, mut is_checked) = (options.block, false);
        let start = starting_block(self.extended_order(), width);
        let mut krylov = Krylov::new(&factor, Side::Right, scale, &start, most, widest)?;
        let mut next = FIRST_LOOK;
        let (ritz, radius, wanted, right) = loop {
            krylov.step()?;
            let is_last = krylov.is_complete() || krylov.dimension() + krylov.pending() > capacity;
            if krylov.dimension() < next && !is_last {
                continue;
            }
            let ritz = Ritz::of(&krylov, sigma)?;
            let (mut radius, mut error) = (known_within(&ritz, sigma, target), 0.0);
            if is_last || radius >= needed {
                let mut inside = self.wanted(&ritz, sigma, radius, target);
                let judged = if is_last { inside.clone() } else { ritz.worst(&inside) };
                let errors = errors(&krylov, &ritz, &judged);
                for (&j, own) in judged.iter().zip(errors) {
                    if !(own <= ENOUGH || ritz.residuals[j] <= CONVERGED) {
                        radius = radius.min(TRUSTED * (ritz.lambdas[j] - sigma).norm());
                        error = own.max(error);
                    }
                }
                if is_last || radius >= needed {
                    // A block that comes back full may have left copies of a multiple eigenvalue; one that does not is checked by another.
                    let copies = self.largest_group(&ritz, sigma, radius, target);
                    let more = if copies >= width {
                        width
                    } else if is_checked {
                        0
                    } else {
                        CHECKED_BY
                    };
                    let columns = krylov.dimension() + krylov.pending();
                    let fits = width + more <= widest && columns + (CHECK_STEPS + 2) * (width + more) <= most;
                    if more > 0 && fits {
                        krylov.widen(&another_block(self.extended_order(), more, width))?;
                        (width, is_checked) = (width + more, true);
                        let wider = krylov.pending();
                        if wider > 0 {
                            capacity = capacity.max(krylov.dimension() + (CHECK_STEPS + 1) * wider);
                            next = krylov.dimension() + CHECK_STEPS * wider;
                            continue;
                        }
                    } else if copies >= width {
                        return Err(SparseError::Multiplicity { shift: sigma, copies });
                    }
                    inside.retain(|&j| (ritz.lambdas[j] - sigma).norm() < radius);
                    let right = krylov.displacements(&ritz.vectors_of(&inside));
                    break (ritz, radius, inside, right);
                }
            }
            let columns = krylov.dimension();
            let missing = if error > 0.0 {
                blocks_until(ENOUGH, error) * width
            } else {
                (OF_MISSING * (needed / radius - 1.0) * (columns - HIDDEN.min(columns)) as f64) as usize
            };
            next = columns + missing.clamp(width, columns.max(width));
        };
        counters.solves += krylov.dimension() + width;
        let known = ritz.lambdas.iter().filter(|&lambda| (lambda - sigma).norm() < radius).count();
        let disc = Disc { centre: sigma, radius, eigenvalues: known, columns: krylov.dimension() };
        let options =
            Options { block: options.block.max(self.largest_group(&ritz, sigma, radius, target) + 1), ..*options };
        drop(krylov);
        let lambdas: Vec<_> = wanted.iter().map(|&j| ritz.lambdas[j]).collect();
        let left = if lambdas.is_empty() {
            Vec::new()
        } else if self.pencil.is_symmetric() {
            (0..lambdas.len()).map(|j| Some(right.col_as_slice(j).to_vec())).collect()
        } else {
            left_vectors(&factor, scale, &lambdas, &right, disc.columns, &options, counters)?
        };
        let candidate = |((lambda, left), j)| Candidate { lambda, right: right.col_as_slice(j).to_vec(), left };
        let seen_at = |(&lambda, &residual): (&Complex<f64>, &f64)| {
            let distance = (lambda - sigma).norm();
            Known { lambda, bound: if distance < radius { residual * distance } else { 0.0 } }
        };
        let seen = ritz.lambdas.iter().zip(&ritz.residuals).map(seen_at).filter(|known| known.lambda.is_finite());
        Ok((disc, lambdas.into_iter().zip(left).zip(0..).map(candidate).collect(), seen.collect()))
    }

    /// n + n + s.
    fn extended_order(&self) -> usize {
        2 * self.pencil.order() + self.pencil.states().len()
    }

    /// The Ritz values in the disc that are in the target or next to it: groups that its border cuts are wanted whole.
    fn wanted(&self, ritz: &Ritz, sigma: Complex<f64>, radius: f64, target: &Rectangle) -> Vec<usize> {
        let margin = self.margin(target);
        let is_wanted = |lambda: Complex<f64>| (lambda - sigma).norm() < radius && target.contains(lambda, margin);
        (0..ritz.lambdas.len()).filter(|&j| is_wanted(ritz.lambdas[j])).collect()
    }

    /// Width of the margin around a rectangle, rad/s: eigenvalues in it are found with those inside.
    pub(crate) fn margin(&self, target: &Rectangle) -> f64 {
        (1e-6 * target.half_diagonal()).max(4.0 * self.pencil.blur(Complex::from(target.reach())))
    }

    /// The most wanted Ritz values of the disc that rounding does not tell apart.
    fn largest_group(&self, ritz: &Ritz, sigma: Complex<f64>, radius: f64, target: &Rectangle) -> usize {
        let wanted: Vec<_> = self.wanted(ritz, sigma, radius, target).into_iter().map(|j| ritz.lambdas[j]).collect();
        groups(&wanted, |lambda| self.pencil.blur(lambda)).iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Q at the centre of the target, or beside it where an eigenvalue sits there.
    fn factor_near(&self, target: &Rectangle, counters: &mut Counters) -> Result<Factor<'_>, SparseError> {
        let step = Complex::new(0.01, 0.007) * target.half_diagonal();
        let known = starting_block(self.pencil.order(), 1);
        for attempt in 0..ATTEMPTS {
            let sigma = target.centre() + step * attempt as f64;
            counters.factorisations += 1;
            match Factor::new(&self.symbolic, &self.pencil, sigma) {
                Ok(factor) if factor.is_regular(&known)? => return Ok(factor),
                Ok(_) => {}
                Err(SparseError::Singular { .. }) => {}
                Err(other) => return Err(other),
            }
        }
        Err(SparseError::Singular { shift: target.centre() })
    }
}

/// Radius about the shift within which all eigenvalues are known; infinite where all are. A Ritz value that is not known, which in the target takes a smaller residual,
/// may be a mean of a crowd of eigenvalues: its residual is their deviation from it, in `1 / (lambda - sigma)`, and the nearest of them are nearer to the shift by that.
fn known_within(ritz: &Ritz, sigma: Complex<f64>, target: &Rectangle) -> f64 {
    let is_known =
        |lambda: Complex<f64>, residual: f64| residual <= if target.contains(lambda, 0.0) { NEARLY } else { SEEN };
    let all = ritz.lambdas.iter().zip(&ritz.residuals);
    let reach = |(lambda, residual): (&Complex<f64>, &f64)| TRUSTED * (lambda - sigma).norm() / (1.0 + residual);
    all.filter(|&(&lambda, &residual)| !is_known(lambda, residual)).map(reach).fold(f64::INFINITY, f64::min)
}
