//! Discs around the near modes of a sample: how many eigenvalues there are in each union of discs is known.
//!
//! The discs are Gershgorin's ([`gershgorin_radius`]) of `V^-1 A V` with each column at the frequency of its own mode,
//!
//! ```text
//! V^-1 (A(lambda_j) - lambda_j) v_j = moved_j e_j + what is left,
//! ```
//!
//! where nothing is left if v_j is the vector of the mode. The vectors begin with those of known gains, around which A is a polynomial
//! ([`Expansion`]). Those of discs that reach to where modes are wanted are corrected by the first order, `v_j += sum_i v_i X_ij` with
//! `X_ij = E_ij / (D_j - D_i)` of a diagonal D and the rest E, which squares what is left; where two modes couple more strongly than that,
//! by the vectors of the pair that they make. Where the number of such a mode is too far from that of another column for the polynomial, A itself
//! multiplies the vector.

use cea::certified::enclosures::{gershgorin_radius, unions};
use linsys::ChannelGain;
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::coupling::{self, Coupled, Scratch, pull};
use super::expansion::{Expansion, Factors, TERMS};
use super::ports::Ports;
use super::table::Table;
use super::vectors::{Vectors, first_order};
use crate::rows::Rows;
use cea::certified::lanes::{Ops, Precision, cast};

/// Most corrections of vectors; chosen.
const MOST_STEPS: usize = 6;
/// What a column may be wrong by at least, relative to |lambda|; chosen: far above what single precision loses.
pub(super) const LEAST: f64 = 1e-4;
/// What the radii are multiplied by where it is asked whether two discs meet; chosen: what a column may be wrong by is no bound.
const APART: f64 = 2.0;

/// What is known of A around some gains: a polynomial, and A itself in the coordinates of the vectors there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around<'a> {
    pub expansion: &'a Expansion,
    pub own: &'a Coupled<f32>,
    pub table: &'a Table<f32>,
}

/// The discs of one sample, and working memory for those of the next.
#[derive(Debug)]
pub(super) struct Discs {
    pub centers: Vec<Complex<f64>>,
    /// rad/s.
    radii: Vec<f64>,
    /// What each radius is made of, rad/s: what is left, and what that may be wrong by.
    left: Vec<f64>,
    missed: Vec<f64>,
    /// lambda_j, where the columns are evaluated, rad/s.
    lambdas: Vec<Complex<f64>>,
    /// `(A(lambda_j) - lambda_j) v_j` as row j, and what it may be wrong by, rad/s.
    rest: Rows<f32>,
    wrong: Vec<f64>,
    /// V^-1 times these as rows, then the columns of V^-1 of modes with other vectors than the known ones.
    turned: Rows<f32>,
    pub vectors: Vectors,
    /// The numbers at which columns are evaluated, and p there, as rows.
    at: Rows<f32>,
    ones: Rows<f32>,
    factors: Factors,
    scratch: Scratch<f32>,
}

impl Discs {
    pub fn new(ports: &Ports) -> Self {
        let p = ports.near();
        Self {
            centers: vec![Complex::default(); p],
            radii: vec![0.0; p],
            left: vec![0.0; p],
            missed: vec![0.0; p],
            lambdas: vec![Complex::default(); p],
            rest: Rows::zeros(p, p),
            wrong: vec![0.0; p],
            turned: Rows::zeros(2 * p, p),
            vectors: Vectors::new(p),
            at: Rows::zeros(2, p),
            ones: Rows::from_fn(1, p, |_, _| Complex::from(1.0)),
            factors: Factors::new(p),
            scratch: Scratch::new(ports),
        }
    }

    /// Makes discs under a gain of all ports so small that it is clear of each whether something in it is wanted: the modes of each union of
    /// discs in which something may be. `None` where it does not become clear.
    pub fn wanted(
        &mut self,
        around: Around<'_>,
        gain: &ChannelGain,
        is_wanted: &dyn Fn(Complex<f64>, f64) -> bool,
    ) -> Option<Vec<Vec<usize>>> {
        let Around { expansion, .. } = around;
        self.vectors.corrected.clear();
        self.lambdas.copy_from_slice(&expansion.lambdas);
        self.move_all(expansion, gain);
        self.evaluate_all(expansion, gain);
        for step in 0..=MOST_STEPS {
            if !self.wrong.iter().all(|wrong| wrong.is_finite()) {
                return None;
            }
            self.vectors.turn(&self.rest, &mut self.turned);
            self.measure(expansion);
            let open = self.open(step > 0, is_wanted);
            if open.is_empty() && (step > 0 || self.open(true, is_wanted).is_empty()) {
                return self.unions(is_wanted);
            }
            if step < MOST_STEPS {
                let Self { vectors, turned, centers, .. } = self;
                vectors.correct(&open, |mode, other| {
                    let gap: Complex<f32> = cast(centers[mode] - centers[other]);
                    first_order(gap, turned.at(mode, other), turned.at(other, mode))
                });
                for at in 0..self.vectors.corrected.len() {
                    let mode = self.vectors.corrected[at];
                    self.lambdas[mode] = self.centers[mode];
                    self.evaluate(around, gain, at);
                }
            }
        }
        None
    }

    /// Whether a number is in one of some discs.
    pub fn hold(&self, union: &[usize], lambda: Complex<f64>) -> bool {
        union.iter().any(|&i| (lambda - self.centers[i]).norm() <= self.radii[i])
    }

    /// Moves each number to the diagonal entry of A at the one that is known.
    fn move_all(&mut self, expansion: &Expansion, gain: &ChannelGain) {
        self.set_numbers(gain);
        let Self { lambdas, at, ones, factors, .. } = self;
        expansion.factors(gain.mu, at, ones.row(0), factors);
        let order = lambdas.len();
        for (mode, lambda) in lambdas.iter_mut().enumerate() {
            let term = |k: usize| factors.values.at(0, k * order + mode) * expansion.terms.at(k * order + mode, mode);
            *lambda += cast::<f32, f64>((0..TERMS).map(term).sum());
        }
    }

    fn set_numbers(&mut self, gain: &ChannelGain) {
        for (mode, &lambda) in self.lambdas.iter().enumerate() {
            self.at.set(0, mode, cast(lambda));
            self.at.set(1, mode, cast(pull(gain, lambda).1));
        }
    }

    /// `(A(lambda_j) - lambda_j) e_j` of all modes.
    fn evaluate_all(&mut self, expansion: &Expansion, gain: &ChannelGain) {
        self.set_numbers(gain);
        let Self { lambdas, rest, wrong, at, ones, factors, .. } = self;
        Arch::new().dispatch(OwnColumns { expansion, mu: gain.mu, at, ones, factors, out: rest });
        for (mode, (lambda, known)) in lambdas.iter().zip(&expansion.lambdas).enumerate() {
            rest.set(mode, mode, rest.at(mode, mode) + cast::<f64, f32>(known - lambda));
            wrong[mode] = f64::from(factors.missed[mode]) + LEAST * size(*lambda);
        }
    }

    /// `(A(lambda_j) - lambda_j) v_j` of a mode whose vector is corrected.
    fn evaluate(&mut self, Around { expansion, own, table }: Around<'_>, gain: &ChannelGain, place: usize) {
        let Self { lambdas, rest, wrong, vectors, at, factors, scratch, .. } = self;
        let (order, mode) = (lambdas.len(), vectors.corrected[place]);
        let lambda = lambdas[mode];
        let pull = cast(pull(gain, lambda).1);
        for column in 0..order {
            at.set(0, column, cast(lambda));
            at.set(1, column, pull);
            rest.set(
                mode,
                column,
                vectors.rows.at(place, column) * cast::<f64, f32>(expansion.lambdas[column] - lambda),
            );
        }
        Arch::new().dispatch(OneColumn {
            expansion,
            mu: gain.mu,
            at,
            vector: vectors.rows.row(place),
            factors,
            mode,
            out: rest,
        });
        let mut missed = factors.missed.iter().sum::<f32>();
        if !missed.is_finite() {
            // Too far from the number of another column for the polynomial.
            let vector = vectors.of(mode);
            let image = coupling::times(own, table, lambda, gain, &vector, scratch);
            for (i, (image, v)) in image.into_iter().zip(vector).enumerate() {
                rest.set(mode, i, image - cast::<f64, f32>(lambda) * v);
            }
            missed = 0.0;
        }
        wrong[mode] = f64::from(missed) + LEAST * size(lambda);
    }

    /// Sets centers and radii.
    fn measure(&mut self, expansion: &Expansion) {
        let sum = |row: usize| f64::from(Arch::new().dispatch(RowSize { matrix: &self.turned, row }));
        let order = self.centers.len();
        let amplified = (order..order + self.vectors.corrected.len()).map(sum).fold(1.0, f64::max);
        for mode in 0..order {
            let moved = self.turned.at(mode, mode);
            let moved_by = f64::from(moved.norm_sqr().sqrt());
            let drift = f64::from(expansion.drift[mode].1);
            // The column is that of lambda_j and not that of the eigenvalue.
            self.left[mode] = gershgorin_radius(sum(mode), moved_by, drift);
            self.missed[mode] = amplified * self.wrong[mode] / (1.0 - drift);
            self.centers[mode] = self.lambdas[mode] + cast::<f32, f64>(moved);
            self.radii[mode] = self.left[mode] + self.missed[mode];
        }
    }

    /// The modes whose discs are to become smaller: those that reach to what is wanted or meet one that does, as far as there is more left
    /// than that may be wrong by.
    fn open(&self, with_near: bool, is_wanted: &dyn Fn(Complex<f64>, f64) -> bool) -> Vec<usize> {
        let order = self.centers.len();
        let wanted: Vec<usize> = (0..order).filter(|&i| is_wanted(self.centers[i], self.radii[i])).collect();
        let is_near = |&i: &usize| wanted.iter().any(|&j| i == j || with_near && self.meet(i, j));
        (0..order).filter(|&i| self.left[i] > self.missed[i]).filter(is_near).collect()
    }

    /// The modes of each union of discs that reaches to what is wanted; `None` where a disc is no disc.
    fn unions(&self, is_wanted: &dyn Fn(Complex<f64>, f64) -> bool) -> Option<Vec<Vec<usize>>> {
        let order = self.centers.len();
        if !self.centers.iter().zip(&self.radii).all(|(center, radius)| center.is_finite() && radius.is_finite()) {
            return None;
        }
        let is_asked = |i: usize| is_wanted(self.centers[i], self.radii[i]);
        Some(unions(order, is_asked, |a, b| self.meet(a, b)))
    }

    fn meet(&self, a: usize, b: usize) -> bool {
        (self.centers[a] - self.centers[b]).norm_sqr() <= (APART * (self.radii[a] + self.radii[b])).powi(2)
    }
}

fn size(lambda: Complex<f64>) -> f64 {
    lambda.norm_sqr().sqrt()
}

/// The columns of A, each at a number of its own, as rows.
struct OwnColumns<'a> {
    expansion: &'a Expansion,
    mu: f64,
    at: &'a Rows<f32>,
    ones: &'a Rows<f32>,
    factors: &'a mut Factors,
    out: &'a mut Rows<f32>,
}

impl WithSimd for OwnColumns<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { expansion, mu, at, ones, factors, out } = self;
        expansion.factors(mu, at, ones.row(0), factors);
        out.clear();
        let order = expansion.lambdas.len();
        for mode in 0..order {
            for k in 0..TERMS {
                let row = k * order + mode;
                out.add_row(simd, mode, factors.values.at(0, row), &expansion.terms, row);
            }
        }
    }
}

/// Adds A times a vector to a row.
struct OneColumn<'a> {
    expansion: &'a Expansion,
    mu: f64,
    at: &'a Rows<f32>,
    vector: [&'a [f32]; 2],
    factors: &'a mut Factors,
    mode: usize,
    out: &'a mut Rows<f32>,
}

impl WithSimd for OneColumn<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { expansion, mu, at, vector, factors, mode, out } = self;
        expansion.factors(mu, at, vector, factors);
        let values = &factors.values;
        out.add_rows_from(simd, mode, &expansion.terms, TERMS * expansion.lambdas.len(), |row| values.at(0, row));
    }
}

/// The sum over the sizes of the entries of a row.
struct RowSize<'a> {
    matrix: &'a Rows<f32>,
    row: usize,
}

impl WithSimd for RowSize<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let [re, im] = self.matrix.row(self.row).map(f32::registers::<S>);
        let o = Ops::<S, f32>::of(simd);
        let mut sum = o.splat(0.0);
        for (re, im) in re.iter().zip(im) {
            sum = o.add(sum, o.sqrt(o.fma(*re, *re, o.mul(*im, *im))));
        }
        o.sum(sum)
    }
}
