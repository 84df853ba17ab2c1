//! A sparse LU of Q(sigma), on one thread, whose every solution is checked in the true matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Par, Spec};
use num_complex::Complex;

use super::pencil::{Pencil, Side};
use crate::SparseError;

/// One thread: the bits of a factorisation depend on their number, and this library has none without it.
pub(crate) const PAR: Par = Par::Seq;
/// Backward error of a solution, |Q x - b| / (|Q| |x| + |b|), up to which it is not refined: some rounding errors.
const GOOD: f64 = 1e-15;
/// Backward error above which a solution is refused; chosen, far below what an eigenpair is asked for.
const REFUSED: f64 = 1e-12;
/// Relative error of a known solution above which Q(sigma) is singular to rounding; chosen.
const REGULAR: f64 = 1e-3;
/// Most steps of iterative refinement; where the second does not help none does.
const REFINEMENTS: usize = 4;

/// The elimination order of a pattern, which serves every shift: column approximate minimum degree, measured to be nearly four
/// times faster here than minimum degree of the symmetric pattern, because rows are pivoted by size.
pub(crate) struct Symbolic(SymbolicLu<usize>);

impl Symbolic {
    pub(crate) fn new(pencil: &Pencil) -> Result<Self, SparseError> {
        let failed = |_| SparseError::Memory { order: pencil.order() };
        factorize_symbolic_lu(pattern(pencil), LuSymbolicParams::default()).map(Self).map_err(failed)
    }
}

/// The pattern as the library takes it.
fn pattern(pencil: &Pencil) -> SymbolicSparseColMatRef<'_, usize> {
    let (starts, rows) = pencil.pattern();
    SymbolicSparseColMatRef::new_checked(pencil.order(), pencil.order(), starts, None, rows)
}

/// Q(sigma), factored.
pub(crate) struct Factor<'a> {
    pencil: &'a Pencil,
    symbolic: &'a SymbolicLu<usize>,
    numeric: NumericLu<usize, Complex<f64>>,
    /// Q(sigma), and transposed, as products read it.
    right: Vec<Complex<f64>>,
    left: Vec<Complex<f64>>,
    sigma: Complex<f64>,
    size: f64,
}

impl<'a> Factor<'a> {
    /// LU of Q(sigma).
    ///
    /// # Errors
    /// [`SparseError::Singular`] where a pivot is zero for every value of the entries, [`SparseError::Memory`].
    pub(crate) fn new(symbolic: &'a Symbolic, pencil: &'a Pencil, sigma: Complex<f64>) -> Result<Self, SparseError> {
        let memory = || SparseError::Memory { order: pencil.order() };
        let Symbolic(symbolic) = symbolic;
        let left = pencil.values(&pencil.weights(sigma));
        let matrix = SparseColMatRef::new(pattern(pencil), &left[..]);
        let request = symbolic.factorize_numeric_lu_scratch::<Complex<f64>>(PAR, Spec::default());
        let mut buffer = MemBuffer::try_new(request).map_err(|_| memory())?;
        let mut numeric = NumericLu::new();
        symbolic.factorize_numeric_lu(&mut numeric, matrix, PAR, MemStack::new(&mut buffer), Spec::default()).map_err(
            |error| match error {
                LuError::SymbolicSingular { .. } => SparseError::Singular { shift: sigma },
                LuError::Generic(_) => memory(),
            },
        )?;
        let right = pencil.by_rows(&left, Side::Right);
        Ok(Self { pencil, symbolic, numeric, right, left, sigma, size: pencil.size(sigma) })
    }

    pub(crate) fn shift(&self) -> Complex<f64> {
        self.sigma
    }

    pub(crate) fn pencil(&self) -> &Pencil {
        self.pencil
    }

    /// Whether a solution known beforehand is found again. A small residual says nothing of it where Q(sigma) is singular.
    ///
    /// # Errors
    /// As [`solve`](Self::solve), but for a solution that is not accurate.
    pub(crate) fn is_regular(&self, known: &Mat<Complex<f64>>) -> Result<bool, SparseError> {
        self.errors(known).map(|(_, forward)| forward <= REGULAR)
    }

    /// The backward and the relative forward error of the solution for `Q(sigma) x`, for a block x that is known. The latter is
    /// infinite where refinement does not make the former small.
    ///
    /// # Errors
    /// As [`solve`](Self::solve), but for a solution that is not accurate.
    pub(crate) fn errors(&self, known: &Mat<Complex<f64>>) -> Result<(f64, f64), SparseError> {
        let b = self.pencil.gathered([(&self.right, known.as_ref())]);
        match self.solve(Side::Right, &b) {
            Ok(x) => {
                let residual = &b - self.pencil.gathered([(&self.right, x.as_ref())]);
                let forward = length((&x - known).col_as_slice(0)) / length(known.col_as_slice(0));
                Ok((self.backward_error(&b, &x, &residual), forward))
            }
            Err(SparseError::Solve { residual, .. }) => Ok((residual, f64::INFINITY)),
            Err(other) => Err(other),
        }
    }

    /// `Q(sigma)^-1 b`, or `Q(sigma)^-T b`, of a block b.
    ///
    /// # Errors
    /// A solution whose backward error stays above 1e-12.
    pub(crate) fn solve(&self, side: Side, b: &Mat<Complex<f64>>) -> Result<Mat<Complex<f64>>, SparseError> {
        let values = match side {
            Side::Right => &self.right,
            Side::Left => &self.left,
        };
        let mut x = b.clone();
        self.substitute(side, &mut x);
        let mut best = f64::INFINITY;
        for _ in 0..=REFINEMENTS {
            let mut residual = b - self.pencil.gathered([(values, x.as_ref())]);
            let error = self.backward_error(b, &x, &residual);
            // A NaN is no small error.
            if error <= GOOD || (error <= REFUSED && error > 0.5 * best) {
                return Ok(x);
            }
            if !error.is_finite() {
                break;
            }
            best = best.min(error);
            self.substitute(side, &mut residual);
            x += residual;
        }
        if best <= REFUSED { Ok(x) } else { Err(SparseError::Solve { shift: self.sigma, residual: best }) }
    }

    /// The largest of the columns.
    fn backward_error(&self, b: &Mat<Complex<f64>>, x: &Mat<Complex<f64>>, residual: &Mat<Complex<f64>>) -> f64 {
        let error = |j: usize| {
            let [r, x, b] = [residual, x, b].map(|m| length(m.col_as_slice(j)));
            if r == 0.0 { 0.0 } else { r / (self.size * x + b) }
        };
        (0..b.ncols()).map(error).fold(0.0, |largest: f64, e| if e <= largest { largest } else { e })
    }

    fn substitute(&self, side: Side, x: &mut Mat<Complex<f64>>) {
        let lu = LuRef::new_unchecked(self.symbolic, &self.numeric);
        let request = self.symbolic.solve_in_place_scratch::<Complex<f64>>(x.ncols(), PAR);
        let mut buffer = MemBuffer::new(request);
        let stack = MemStack::new(&mut buffer);
        match side {
            Side::Right => lu.solve_in_place_with_conj(Conj::No, x.as_mut(), PAR, stack),
            Side::Left => lu.solve_transpose_in_place_with_conj(Conj::No, x.as_mut(), PAR, stack),
        }
    }
}

/// The 2-norm, summed in eight parts, which a processor adds at once.
pub(crate) fn length(x: &[Complex<f64>]) -> f64 {
    let (blocks, rest) = x.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for block in blocks {
        sums.iter_mut().zip(block).for_each(|(sum, z)| *sum += z.norm_sqr());
    }
    (sums.iter().sum::<f64>() + rest.iter().map(Complex::norm_sqr).sum::<f64>()).sqrt()
}
