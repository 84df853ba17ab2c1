//! A sparse LU of Q(sigma), on one thread, whose every solution is checked in the true matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::PartialPivLuParams;
use faer::sparse::FaerError;
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
/// Most steps of iterative refinement; where the second does not help none does.
const REFINEMENTS: usize = 4;

/// The elimination order of a pattern, which serves every shift.
pub(crate) struct Symbolic(SymbolicLu<usize>);

impl Symbolic {
    pub(crate) fn new(pencil: &Pencil) -> Result<Self, SparseError> {
        let (starts, rows) = pencil.pattern();
        let n = pencil.order();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, starts, None, rows);
        factorize_symbolic_lu(pattern, LuSymbolicParams::default()).map(Self).map_err(|e| memory(e, n))
    }

    /// LU of Q(sigma).
    pub(crate) fn factor<'a>(&'a self, pencil: &'a Pencil, sigma: Complex<f64>) -> Result<Factor<'a>, SparseError> {
        let values = pencil.values(&pencil.weights(sigma));
        let (starts, rows) = pencil.pattern();
        let n = pencil.order();
        let matrix = SparseColMatRef::new(SymbolicSparseColMatRef::new_checked(n, n, starts, None, rows), &values[..]);
        let params: Spec<PartialPivLuParams, Complex<f64>> = Spec::default();
        let request = self.0.factorize_numeric_lu_scratch::<Complex<f64>>(PAR, params);
        let mut buffer = MemBuffer::try_new(request).map_err(|_| memory(FaerError::OutOfMemory, n))?;
        let mut numeric = NumericLu::new();
        match self.0.factorize_numeric_lu(&mut numeric, matrix, PAR, MemStack::new(&mut buffer), params) {
            Ok(_) => {}
            Err(LuError::SymbolicSingular { .. }) => return Err(SparseError::Singular { shift: sigma }),
            Err(LuError::Generic(error)) => return Err(memory(error, n)),
        }
        let size = pencil.size(sigma);
        Ok(Factor { pencil, symbolic: &self.0, numeric, values, sigma, size })
    }
}

fn memory(_: FaerError, order: usize) -> SparseError {
    SparseError::Memory { order }
}

/// Q(sigma), factored.
pub(crate) struct Factor<'a> {
    pencil: &'a Pencil,
    symbolic: &'a SymbolicLu<usize>,
    numeric: NumericLu<usize, Complex<f64>>,
    values: Vec<Complex<f64>>,
    sigma: Complex<f64>,
    size: f64,
}

impl Factor<'_> {
    pub(crate) fn shift(&self) -> Complex<f64> {
        self.sigma
    }

    pub(crate) fn pencil(&self) -> &Pencil {
        self.pencil
    }

    /// `Q(sigma)^-1 b`, or `Q(sigma)^-T b`, of a block b.
    ///
    /// # Errors
    /// A solution whose backward error stays above 1e-12.
    pub(crate) fn solve(&self, side: Side, b: &Mat<Complex<f64>>) -> Result<Mat<Complex<f64>>, SparseError> {
        let mut x = b.clone();
        self.substitute(side, &mut x);
        let mut best = f64::INFINITY;
        for _ in 0..=REFINEMENTS {
            let mut residual = Mat::zeros(b.nrows(), b.ncols());
            self.pencil.accumulate(&self.values, side, x.as_ref(), &mut residual);
            residual = b - residual;
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

/// The 2-norm.
pub(crate) fn length(x: &[Complex<f64>]) -> f64 {
    x.iter().map(Complex::norm_sqr).sum::<f64>().sqrt()
}
