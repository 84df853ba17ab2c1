//! The vectors of modes in the coordinates of known ones, V: those of few modes differ from these.

use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::pair::moved;
use crate::elimination::Elimination;
use crate::rows::Rows;

/// Product of two couplings, as a part of the square of half of what is between two modes, from which on these are corrected as a pair;
/// chosen.
const STRONG: f32 = 0.02;
/// Least determinant of the vectors of a pair, each with a largest entry of 1; chosen: of less the modes coalesce nearly, and stay together.
const LEAST_DETERMINANT: f32 = 0.05;
/// V, of which all columns are those of the identity matrix but for some.
#[derive(Debug)]
pub(super) struct Vectors {
    /// The modes of those, and their vectors as rows.
    pub corrected: Vec<usize>,
    pub rows: Rows<f32>,
    before: Rows<f32>,
    change: Rows<f32>,
    /// The entries of these vectors for these modes, and their factors.
    square: Rows<f32>,
    elimination: Elimination<f32>,
    sides: Rows<f32>,
}

impl Vectors {
    /// The identity matrix of p modes.
    pub fn new(p: usize) -> Self {
        Self {
            corrected: Vec::new(),
            rows: Rows::zeros(p, p),
            before: Rows::zeros(p, p),
            change: Rows::zeros(1, p),
            square: Rows::zeros(p, p),
            elimination: Elimination::default(),
            sides: Rows::zeros(p, 2 * p),
        }
    }

    /// The vector of a mode.
    pub fn of(&self, mode: usize) -> Vec<Complex<f32>> {
        let order = self.rows.rows();
        match self.corrected.iter().position(|&corrected| corrected == mode) {
            None => (0..order).map(|i| Complex::from(if i == mode { 1.0 } else { 0.0 })).collect(),
            Some(at) => (0..order).map(|i| self.rows.at(at, i)).collect(),
        }
    }

    /// Corrects the vectors of some modes, and of those that were corrected before: to the vector of a mode, the first, `part` of that of
    /// another is added.
    pub fn correct(&mut self, modes: &[usize], part: impl Fn(usize, usize) -> Complex<f32>) {
        let Self { corrected, rows, before, change, .. } = self;
        let order = before.rows();
        for &mode in modes {
            if !corrected.contains(&mode) {
                let unit = |i: usize| Complex::from(if i == mode { 1.0 } else { 0.0 });
                (0..order).for_each(|i| rows.set(corrected.len(), i, unit(i)));
                corrected.push(mode);
            }
        }
        before.clone_from(rows);
        for (at, &mode) in corrected.iter().enumerate() {
            for other in 0..order {
                change.set(0, other, if other == mode { Complex::default() } else { part(mode, other) });
            }
            Arch::new().dispatch(Change { at, corrected, before, change, out: rows });
        }
    }

    /// V^-1 times rows, one for each mode, and then the columns of V^-1 of the corrected modes, as rows.
    pub fn turn(&mut self, of: &Rows<f32>, out: &mut Rows<f32>) {
        let Self { corrected, rows, square, elimination, sides, .. } = self;
        let (order, count) = (of.rows(), corrected.len());
        out.take_rows(of);
        // A row of right sides for each of those modes: of the rows, and of the identity matrix.
        for (at, &row) in corrected.iter().enumerate() {
            (0..count).for_each(|of| square.set(at, of, rows.at(of, row)));
            (0..order).for_each(|mode| sides.set(at, mode, of.at(mode, row)));
            (0..count).for_each(|of| sides.set(at, order + of, Complex::from(if of == at { 1.0 } else { 0.0 })));
        }
        Arch::new().dispatch(Turn { square, elimination, sides, count, vectors: rows, out, rows: order + count });
        for (at, &row) in corrected.iter().enumerate() {
            (0..order + count).for_each(|mode| out.set(mode, row, sides.at(at, mode)));
        }
    }
}

/// The part of another mode's vector that a vector takes, given what is between their diagonal entries, the entry that couples the other one
/// to it and the one that couples it to the other.
pub(super) fn first_order(gap: Complex<f32>, to_other: Complex<f32>, to_own: Complex<f32>) -> Complex<f32> {
    let (half, product) = (gap * 0.5, to_other * to_own);
    if product.norm_sqr() > (STRONG * half.norm_sqr()).powi(2) {
        // The vectors of the two: (1, back) and (own, 1).
        let apart = gap + moved(half, product);
        let [own, back] = [to_other / apart, -to_own / apart];
        if (Complex::from(1.0) - own * back).norm() >= LEAST_DETERMINANT {
            return own;
        }
    }
    // Never more than a half.
    to_other * gap.conj() / (gap.norm_sqr() + to_other.norm_sqr()).max(f32::MIN_POSITIVE)
}

/// Solves with the corrected modes' own entries, and takes the vectors times what that gives from all rows.
struct Turn<'a> {
    square: &'a mut Rows<f32>,
    elimination: &'a mut Elimination<f32>,
    sides: &'a mut Rows<f32>,
    count: usize,
    vectors: &'a Rows<f32>,
    out: &'a mut Rows<f32>,
    rows: usize,
}

impl WithSimd for Turn<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { square, elimination, sides, count, vectors, out, rows } = self;
        elimination.factor(simd, square, count);
        elimination.solve_rows(simd, square, sides);
        for mode in 0..rows {
            out.add_rows_from(simd, mode, vectors, count, |at| -sides.at(at, mode));
        }
    }
}

/// Adds a change to a vector: of other vectors, and of the known ones.
struct Change<'a> {
    at: usize,
    corrected: &'a [usize],
    before: &'a Rows<f32>,
    change: &'a mut Rows<f32>,
    out: &'a mut Rows<f32>,
}

impl WithSimd for Change<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { at, corrected, before, change, out } = self;
        out.add_rows_from(simd, at, before, corrected.len(), |of| change.at(0, corrected[of]));
        corrected.iter().for_each(|&mode| change.set(0, mode, Complex::default()));
        out.add_row(simd, at, Complex::from(1.0), change, 0);
    }
}
