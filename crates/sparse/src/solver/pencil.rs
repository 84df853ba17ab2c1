//! M, C, K and H on one sparsity pattern, and what the solver multiplies with them.

use std::sync::OnceLock;

use faer::Mat;
use nalgebra_sparse::CscMatrix;
use num_complex::Complex;

use super::lanes::compute;
use super::products::{PartProducts, Parts, Product, Rows, Side, SumOfProducts, Weights};
use crate::{SparseSecondOrder, State};

/// Q(lambda) and its parts on the union of the patterns of M, C, K, H, the internal states and their transposes, by compressed
/// columns.
#[derive(Debug, Clone)]
pub(crate) struct Pencil {
    order: usize,
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    /// Index of the transposed entry of each one: the pattern is symmetric.
    mirror: Vec<usize>,
    /// The rows of all entries, and of the entries that M or C has.
    all: Rows,
    inertial: Rows,
    mass: Vec<f64>,
    damping: Vec<f64>,
    stiffness: Vec<f64>,
    /// Structural damping H; empty for a system without it.
    structural: Vec<f64>,
    /// The values by rows, of each side that is asked for.
    sides: [OnceLock<Values>; 2],
    /// Indices in the pattern of the entries `f_k e_l` of each state, k outermost.
    coupling: Vec<Vec<usize>>,
    states: Vec<State>,
    norms: Norms,
}

/// The values in the order in which products read them: of M and C at the entries that either has, of K and H at all entries.
#[derive(Debug, Clone)]
struct Values {
    mass: Vec<f64>,
    damping: Vec<f64>,
    stiffness: Vec<f64>,
    structural: Vec<f64>,
}

/// Frobenius norms of M, C and `K + i H`, and of each state `|f_i| |e_i|`.
#[derive(Debug, Clone)]
struct Norms {
    mass: f64,
    damping: f64,
    stiffness: f64,
    states: Vec<f64>,
}

/// Least blur of an eigenvalue, relative to |lambda|: eigenvalues that are farther apart than their blur are told apart. Chosen, with the effect of [`APART`].
const TOLD_APART: f64 = 1e-7;
/// Blur of an eigenvalue with one vector, in roots of a rounding error times the scale of the problem; chosen: with less, copies of one eigenvalue may count as
/// neighbours; with more, neighbours count as one group.
const APART: f64 = 4.0;

/// Vectors in columns.
type Block = Mat<Complex<f64>>;

/// Degrees of freedom with coefficients.
type Coefficients = [(usize, f64)];

impl State {
    /// Coefficients that drive the state, and coefficients by which it acts, of the system or of the transposed system.
    pub(super) fn sides(&self, side: Side) -> (&Coefficients, &Coefficients) {
        match side {
            Side::Right => (&self.drive, &self.force),
            Side::Left => (&self.force, &self.drive),
        }
    }
}

impl Pencil {
    pub(crate) fn new(system: &SparseSecondOrder) -> Self {
        let order = system.order();
        let (column_starts, rows) = symmetric_pattern(system);
        let place = |row: usize, column: usize| {
            let (from, to) = (column_starts[column], column_starts[column + 1]);
            from + rows[from..to].partition_point(|&other| other < row)
        };
        // Entries of a row come in the order of the columns, as entries of the column with the same number come in the order of the rows.
        let mut next = column_starts.clone();
        let mirrored = |&row: &usize| {
            next[row] += 1;
            next[row] - 1
        };
        let mirror: Vec<usize> = rows.iter().map(mirrored).collect();
        let spread = |matrix: &CscMatrix<f64>| {
            let mut values = vec![0.0; rows.len()];
            for (column, &start) in matrix.col_iter().zip(&column_starts) {
                let mut at = start;
                for (&row, value) in column.row_indices().iter().zip(column.values()) {
                    at += rows[at..].iter().take_while(|&&other| other < row).count();
                    values[at] += value;
                }
            }
            values
        };
        let (mass, damping, stiffness) = (spread(&system.m), spread(&system.c), spread(&system.k));
        let structural = system.h.as_ref().map_or_else(Vec::new, spread);
        let places = |state: &State| {
            let force = state.force.iter();
            force
                .flat_map(|&(row, _)| state.drive.iter().map(move |&(column, _)| (row, column)))
                .map(|(r, c)| place(r, c))
                .collect()
        };
        let coupling = system.states.iter().map(places).collect();
        let norms = Norms {
            mass: norm(&mass),
            damping: norm(&damping),
            stiffness: norm(&stiffness).hypot(norm(&structural)),
            states: system.states.iter().map(|s| length(&s.drive) * length(&s.force)).collect(),
        };
        let states = system.states.clone();
        let is_inertial = |at: usize| mass[at] != 0.0 || damping[at] != 0.0;
        let all = Rows::new(&column_starts, &rows, |_| true);
        let inertial = Rows::new(&column_starts, &rows, |at| is_inertial(at) || is_inertial(mirror[at]));
        Self {
            order,
            column_starts,
            rows,
            mirror,
            all,
            inertial,
            mass,
            damping,
            stiffness,
            structural,
            sides: Default::default(),
            coupling,
            states,
            norms,
        }
    }

    pub(crate) fn order(&self) -> usize {
        self.order
    }

    pub(crate) fn states(&self) -> &[State] {
        &self.states
    }

    /// True if there is structural damping: Q is that above the real axis then, and no real matrix on it.
    pub(crate) fn is_structurally_damped(&self) -> bool {
        !self.structural.is_empty()
    }

    /// True if M, C, K and H are symmetric to the last bit, and there are no states: then conjugates of left vectors are right ones.
    pub(crate) fn is_symmetric(&self) -> bool {
        let is_symmetric = |values: &[f64]| values.iter().zip(&self.mirror).all(|(value, &at)| *value == values[at]);
        let all = [&self.mass, &self.damping, &self.stiffness, &self.structural];
        self.states.is_empty() && all.into_iter().all(|values| is_symmetric(values))
    }

    /// Starts of the columns and rows of the entries, ascending in each column.
    pub(crate) fn pattern(&self) -> (&[usize], &[usize]) {
        (&self.column_starts, &self.rows)
    }

    /// Index of the transposed entry of each one.
    pub(crate) fn mirror(&self) -> &[usize] {
        &self.mirror
    }

    /// Q(lambda).
    pub(crate) fn weights(&self, lambda: Complex<f64>) -> Weights {
        let states = self.states.iter().map(|s| -lambda / (lambda + s.decay)).collect();
        Weights { mass: lambda * lambda, damping: lambda, stiffness: Complex::from(1.0), states }
    }

    /// Q'(lambda).
    pub(crate) fn slope_weights(&self, lambda: Complex<f64>) -> Weights {
        let states = self.states.iter().map(|s| -s.decay / ((lambda + s.decay) * (lambda + s.decay))).collect();
        Weights { mass: 2.0 * lambda, damping: Complex::from(1.0), stiffness: Complex::default(), states }
    }

    /// The entries of a sum of the parts, on the pattern.
    pub(crate) fn values(&self, weights: &Weights) -> Vec<Complex<f64>> {
        let parts = self.mass.iter().zip(&self.damping).zip(&self.stiffness);
        let mut values: Vec<_> =
            parts.map(|((&m, &c), &k)| weights.mass * m + weights.damping * c + weights.stiffness * k).collect();
        let structural = weights.stiffness * Complex::I;
        values.iter_mut().zip(&self.structural).for_each(|(value, &h)| *value += structural * h);
        for ((state, places), &weight) in self.states.iter().zip(&self.coupling).zip(&weights.states) {
            let products = state.force.iter().flat_map(|&(_, f)| state.drive.iter().map(move |&(_, e)| f * e));
            places.iter().zip(products).for_each(|(&place, product)| values[place] += weight * product);
        }
        values
    }

    /// The parts times each vector of a block, or the transposed parts.
    pub(crate) fn parts(&self, side: Side, x: &Block) -> Vec<Parts<'_>> {
        let mut products = [(); 3].map(|()| Mat::zeros(self.order, x.ncols()));
        let Values { mass, damping, stiffness, structural } = self.side(side);
        let [m, c, k] = &mut products;
        compute(PartProducts { rows: &self.inertial, values: [mass, damping], x, products: [m, c] });
        if self.is_structurally_damped() {
            let mut h = Mat::zeros(self.order, x.ncols());
            compute(PartProducts { rows: &self.all, values: [stiffness, structural], x, products: [k, &mut h] });
            *k += h * faer::Scale(Complex::I);
        } else {
            compute(PartProducts { rows: &self.all, values: [stiffness], x, products: [k] });
        }
        let parts = |j: usize| {
            let driven = |state: &State| state.sides(side).0.iter().map(|&(dof, e)| x[(dof, j)] * e).sum();
            let products = products.each_ref().map(|product| product.col_as_slice(j).to_vec());
            Parts { products, driven: self.states.iter().map(driven).collect(), states: &self.states, side }
        };
        (0..x.ncols()).map(parts).collect()
    }

    /// `|lambda|^2 |M| + |lambda| |C| + |K|` and the terms of the internal states, as [`cea::backward_error`] has it.
    pub(crate) fn size(&self, lambda: Complex<f64>) -> f64 {
        let l = lambda.norm();
        let state =
            |(state, norm): (&State, &f64)| (lambda / (lambda + state.decay)).norm().min(1.0 / f64::EPSILON) * norm;
        let states: f64 = self.states.iter().zip(&self.norms.states).map(state).sum();
        (l * self.norms.mass + self.norms.damping) * l + self.norms.stiffness + states
    }

    /// gamma, rad/s, at which |M|, or |C|, weighs as much as |K|.
    fn natural(&self) -> f64 {
        let Norms { mass, damping, stiffness, .. } = self.norms;
        match (mass > 0.0, damping > 0.0, stiffness > 0.0) {
            (true, _, true) => (stiffness / mass).sqrt(),
            (true, true, false) => damping / mass,
            (false, true, true) => stiffness / damping,
            _ => 1.0,
        }
    }

    /// Distance to which rounding may move two eigenvalues apart that are one, rad/s: as the root of a rounding error where they have one vector.
    pub(crate) fn blur(&self, lambda: Complex<f64>) -> f64 {
        let size = self.size(Complex::from(lambda.norm().max(self.natural())));
        let scales = [(size / self.norms.mass).sqrt(), size / self.norms.damping];
        let scale = scales.into_iter().filter(|scale| scale.is_finite()).fold(f64::INFINITY, f64::min);
        let scale = if scale.is_finite() { scale } else { 0.0 };
        (APART * f64::EPSILON.sqrt() * scale).max(TOLD_APART * lambda.norm())
    }

    /// Size to which a residual at lambda is compared: [`size`](Self::size) there, or for an eigenvalue that rounding does not tell from zero the size at
    /// gamma ([`natural`](Self::natural)). There K may vanish, and with it all that the computed eigenvalue could be compared with.
    pub(crate) fn measure(&self, lambda: Complex<f64>) -> f64 {
        let is_zero = lambda.norm() <= self.blur(lambda);
        self.size(if is_zero { Complex::from(self.natural()) } else { lambda })
    }

    fn side(&self, side: Side) -> &Values {
        self.sides[side as usize].get_or_init(|| {
            let [mass, damping] = [&self.mass, &self.damping].map(|values| self.read(&self.inertial, values, side));
            let structural = match self.is_structurally_damped() {
                true => self.read(&self.all, &self.structural, side),
                false => Vec::new(),
            };
            Values { mass, damping, stiffness: self.read(&self.all, &self.stiffness, side), structural }
        })
    }

    /// Values on the pattern in the order in which products read them.
    fn read<T: Copy>(&self, rows: &Rows, values: &[T], side: Side) -> Vec<T> {
        match side {
            Side::Right => rows.places.iter().map(|&at| values[self.mirror[at]]).collect(),
            Side::Left => rows.places.iter().map(|&at| values[at]).collect(),
        }
    }

    /// Values on the pattern in the order in which [`times`](Self::times) reads them on a side.
    pub(crate) fn by_rows(&self, values: &[Complex<f64>], side: Side) -> Vec<Complex<f64>> {
        self.read(&self.all, values, side)
    }

    /// `A x`, or `A^T x`, for the values [`by_rows`](Self::by_rows) of that side.
    pub(crate) fn times(&self, values: &[Complex<f64>], x: &Block) -> Block {
        let mut product = Mat::zeros(self.order, x.ncols());
        compute(Product { rows: &self.all, values, x, product: &mut product });
        product
    }

    /// `M x + C y`, or `M^T x + C^T y`.
    pub(crate) fn inertial_sum(&self, side: Side, x: &Block, y: &Block) -> Block {
        let Values { mass, damping, .. } = self.side(side);
        let mut sum = Mat::zeros(self.order, x.ncols());
        compute(SumOfProducts { rows: &self.inertial, terms: [(mass, x), (damping, y)], sum: &mut sum });
        sum
    }
}

/// The union of the patterns of M, C, K, H, the internal states and their transposes: starts of the columns, and rows, ascending.
fn symmetric_pattern<'a>(system: &'a SparseSecondOrder) -> (Vec<usize>, Vec<usize>) {
    let order = system.order();
    let (mut starts, mut rows) = (vec![0], Vec::with_capacity(system.k.nnz()));
    let mut of_states = vec![Vec::new(); if system.states.is_empty() { 0 } else { order }];
    for state in &system.states {
        for &(column, _) in &state.drive {
            of_states[column].extend(state.force.iter().map(|&(row, _)| row));
        }
    }
    let mut column = Vec::new();
    for j in 0..order {
        let rows_of = |matrix: &'a CscMatrix<f64>| {
            let offsets = matrix.col_offsets();
            &matrix.row_indices()[offsets[j]..offsets[j + 1]]
        };
        let [m, c, k] = [&system.m, &system.c, &system.k].map(rows_of);
        let h = system.h.as_ref().map_or(&[][..], rows_of);
        let all = [m, c, k, h, of_states.get(j).map_or(&[][..], Vec::as_slice)];
        add_union(&mut rows, &all, &mut column);
        starts.push(rows.len());
    }
    // The transposed pattern: counts of the rows, then each entry in its place.
    let mut transposed_starts = vec![0; order + 1];
    rows.iter().for_each(|&row| transposed_starts[row + 1] += 1);
    (0..order).for_each(|j| transposed_starts[j + 1] += transposed_starts[j]);
    let (mut next, mut transposed) = (transposed_starts.clone(), vec![0; rows.len()]);
    for j in 0..order {
        for &row in &rows[starts[j]..starts[j + 1]] {
            transposed[next[row]] = j;
            next[row] += 1;
        }
    }
    let (mut both_starts, mut both) = (vec![0], Vec::with_capacity(rows.len()));
    for j in 0..order {
        let own = &rows[starts[j]..starts[j + 1]];
        add_union(&mut both, &[own, &transposed[transposed_starts[j]..transposed_starts[j + 1]]], &mut column);
        both_starts.push(both.len());
    }
    (both_starts, both)
}

/// Appends the union of lists, ascending; most are equal.
fn add_union(all: &mut Vec<usize>, lists: &[&[usize]], union: &mut Vec<usize>) {
    union.clear();
    for (at, list) in lists.iter().enumerate() {
        if !lists[..at].contains(list) {
            union.extend_from_slice(list);
        }
    }
    // Of a few ascending runs.
    union.sort();
    union.dedup();
    all.extend_from_slice(union);
}

/// The 2-norm without overflow of the squares.
fn norm(values: &[f64]) -> f64 {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if largest == 0.0 { 0.0 } else { largest * values.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt() }
}

fn length(side: &[(usize, f64)]) -> f64 {
    norm(&side.iter().map(|&(_, value)| value).collect::<Vec<_>>())
}
