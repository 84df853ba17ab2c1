//! M, C and K on one sparsity pattern, and what the solver multiplies with them.

use faer::{Mat, MatRef};
use nalgebra::DVector;
use num_complex::Complex;
use pulp::{Arch, NullaryFnOnce};

use crate::{SparseSecondOrder, State};

/// Q(lambda) and its parts on the union of the patterns of M, C, K, the internal states and their transposes, by compressed
/// columns.
#[derive(Debug, Clone)]
pub(crate) struct Pencil {
    order: usize,
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    /// Where the transposed entry stands: the pattern is symmetric.
    mirror: Vec<usize>,
    mass: Vec<f64>,
    damping: Vec<f64>,
    stiffness: Vec<f64>,
    /// Where the entry `f_k e_l` of each state, k outermost, stands in the pattern.
    coupling: Vec<Vec<usize>>,
    states: Vec<State>,
    norms: Norms,
}

/// Frobenius norms of M, C and K, and of each state `|f_i| |e_i|`.
#[derive(Debug, Clone)]
struct Norms {
    mass: f64,
    damping: f64,
    stiffness: f64,
    states: Vec<f64>,
}

/// Factors of M, C and K in a sum, and of each `f_i e_i^T`.
#[derive(Debug, Clone)]
pub(crate) struct Weights {
    pub(crate) mass: Complex<f64>,
    pub(crate) damping: Complex<f64>,
    pub(crate) stiffness: Complex<f64>,
    pub(crate) states: Vec<Complex<f64>>,
}

/// Vectors in columns.
type Block<'a> = MatRef<'a, Complex<f64>>;

/// Whether a matrix acts as it is or transposed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// As it is: right vectors.
    Right,
    /// Transposed: conjugates of left vectors.
    Left,
}

/// Degrees of freedom with coefficients.
type Coefficients = [(usize, f64)];

impl State {
    /// What drives the state and where it acts, of the system or the transposed one.
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
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); order];
        for matrix in [&system.m, &system.c, &system.k] {
            for (row, column, _) in matrix.triplet_iter() {
                columns[column].push(row);
                columns[row].push(column);
            }
        }
        for state in &system.states {
            for &(column, _) in &state.drive {
                for &(row, _) in &state.force {
                    columns[column].push(row);
                    columns[row].push(column);
                }
            }
        }
        let (mut column_starts, mut rows) = (vec![0], Vec::new());
        for mut column in columns {
            column.sort_unstable();
            column.dedup();
            rows.extend(column);
            column_starts.push(rows.len());
        }
        let place = |row: usize, column: usize| {
            let (from, to) = (column_starts[column], column_starts[column + 1]);
            from + rows[from..to].partition_point(|&other| other < row)
        };
        let mirrored = |column: usize| {
            rows[column_starts[column]..column_starts[column + 1]].iter().map(move |&row| place(column, row))
        };
        let mirror = (0..order).flat_map(mirrored).collect();
        let spread = |matrix: &nalgebra_sparse::CscMatrix<f64>| {
            let mut values = vec![0.0; rows.len()];
            matrix.triplet_iter().for_each(|(row, column, &value)| values[place(row, column)] += value);
            values
        };
        let (mass, damping, stiffness) = (spread(&system.m), spread(&system.c), spread(&system.k));
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
            stiffness: norm(&stiffness),
            states: system.states.iter().map(|s| length(&s.drive) * length(&s.force)).collect(),
        };
        let states = system.states.clone();
        Self { order, column_starts, rows, mirror, mass, damping, stiffness, coupling, states, norms }
    }

    pub(crate) fn order(&self) -> usize {
        self.order
    }

    pub(crate) fn states(&self) -> &[State] {
        &self.states
    }

    /// Whether M, C and K are symmetric to the last bit, and there are no states: then conjugates of left vectors are right ones.
    pub(crate) fn is_symmetric(&self) -> bool {
        let is_symmetric = |values: &[f64]| values.iter().zip(&self.mirror).all(|(value, &at)| *value == values[at]);
        self.states.is_empty() && [&self.mass, &self.damping, &self.stiffness].into_iter().all(|m| is_symmetric(m))
    }

    /// Starts of the columns and rows of the entries, ascending in each column.
    pub(crate) fn pattern(&self) -> (&[usize], &[usize]) {
        (&self.column_starts, &self.rows)
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
        for ((state, places), &weight) in self.states.iter().zip(&self.coupling).zip(&weights.states) {
            let products = state.force.iter().flat_map(|&(_, f)| state.drive.iter().map(move |&(_, e)| f * e));
            places.iter().zip(products).for_each(|(&place, product)| values[place] += weight * product);
        }
        values
    }

    /// A sum of the parts times a vector.
    pub(crate) fn times(&self, weights: &Weights, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        self.product(weights, Side::Right, x)
    }

    /// The transposed sum times a vector.
    pub(crate) fn times_transposed(&self, weights: &Weights, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        self.product(weights, Side::Left, x)
    }

    fn product(&self, weights: &Weights, side: Side, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let mut product = DVector::zeros(self.order);
        for column in 0..self.order {
            for at in self.column_starts[column]..self.column_starts[column + 1] {
                let value = weights.mass * self.mass[at]
                    + weights.damping * self.damping[at]
                    + weights.stiffness * self.stiffness[at];
                match side {
                    Side::Right => product[self.rows[at]] += value * x[column],
                    Side::Left => product[column] += value * x[self.rows[at]],
                }
            }
        }
        for (state, &weight) in self.states.iter().zip(&weights.states) {
            let (drive, force) = state.sides(side);
            let driven: Complex<f64> = drive.iter().map(|&(dof, e)| x[dof] * e).sum();
            force.iter().for_each(|&(dof, f)| product[dof] += weight * driven * f);
        }
        product
    }

    /// `|lambda|^2 |M| + |lambda| |C| + |K|` and the terms of the internal states, as [`cea::backward_error`] has it.
    pub(crate) fn size(&self, lambda: Complex<f64>) -> f64 {
        let l = lambda.norm();
        let state =
            |(state, norm): (&State, &f64)| (lambda / (lambda + state.decay)).norm().min(1.0 / f64::EPSILON) * norm;
        let states: f64 = self.states.iter().zip(&self.norms.states).map(state).sum();
        (l * self.norms.mass + self.norms.damping) * l + self.norms.stiffness + states
    }

    /// Values on the pattern in the order in which [`gathered`](Self::gathered) reads them on a side.
    pub(crate) fn by_rows<T: Copy>(&self, values: &[T], side: Side) -> Vec<T> {
        match side {
            Side::Right => self.mirror.iter().map(|&at| values[at]).collect(),
            Side::Left => values.to_vec(),
        }
    }

    /// `sum_k A_k x_k`, or `sum_k A_k^T x_k`, of blocks x_k, for values [`by_rows`](Self::by_rows) of that side.
    pub(crate) fn gathered<const TERMS: usize>(
        &self,
        terms: [(&[Complex<f64>], Block<'_>); TERMS],
    ) -> Mat<Complex<f64>> {
        let columns = terms.first().map_or(0, |(_, x)| x.ncols());
        let mut out = Mat::zeros(self.order, columns);
        let mut sums = vec![Lanes::default(); self.order];
        for from in (0..columns).step_by(LANES) {
            let count = LANES.min(columns - from);
            let rows = terms.map(|(_, x)| interleaved(x.subcols(from, count)));
            let terms: [_; TERMS] = std::array::from_fn(|k| (terms[k].0, &rows[k][..]));
            Arch::new().dispatch(Product { starts: &self.column_starts, columns: &self.rows, terms, sums: &mut sums });
            for j in 0..count {
                let target = &mut out.col_as_slice_mut(from + j)[..];
                target.iter_mut().zip(&sums).for_each(|(t, s)| *t = Complex::new(s.re[j], s.im[j]));
            }
        }
        out
    }
}

/// Columns of a block that are multiplied together.
const LANES: usize = 4;

/// One row of at most [`LANES`] columns, filled up with zeros.
#[derive(Debug, Clone, Copy, Default)]
struct Lanes {
    re: [f64; LANES],
    im: [f64; LANES],
}

fn interleaved(block: Block<'_>) -> Vec<Lanes> {
    let mut rows = vec![Lanes::default(); block.nrows()];
    for j in 0..block.ncols() {
        rows.iter_mut().zip(block.col(j).iter()).for_each(|(row, x)| (row.re[j], row.im[j]) = (x.re, x.im));
    }
    rows
}

/// The products of all rows, a function that is compiled for each kind of processor.
struct Product<'a, const TERMS: usize> {
    starts: &'a [usize],
    columns: &'a [usize],
    terms: [(&'a [Complex<f64>], &'a [Lanes]); TERMS],
    sums: &'a mut [Lanes],
}

impl<const TERMS: usize> NullaryFnOnce for Product<'_, TERMS> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (row, target) in self.sums.iter_mut().enumerate() {
            let entries = self.starts[row]..self.starts[row + 1];
            let mut sum = Lanes::default();
            for (values, x) in self.terms {
                for (value, &column) in values[entries.clone()].iter().zip(&self.columns[entries.clone()]) {
                    let x = &x[column];
                    for lane in 0..LANES {
                        sum.re[lane] += value.re * x.re[lane] - value.im * x.im[lane];
                        sum.im[lane] += value.re * x.im[lane] + value.im * x.re[lane];
                    }
                }
            }
            *target = sum;
        }
    }
}

/// The 2-norm without overflow of the squares.
fn norm(values: &[f64]) -> f64 {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if largest == 0.0 { 0.0 } else { largest * values.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt() }
}

fn length(side: &[(usize, f64)]) -> f64 {
    norm(&side.iter().map(|&(_, value)| value).collect::<Vec<_>>())
}
