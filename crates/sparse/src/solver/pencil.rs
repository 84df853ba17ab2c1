//! M, C and K on one sparsity pattern, and what the solver multiplies with them.

use faer::{Mat, MatRef};
use nalgebra::DVector;
use num_complex::Complex;

use crate::{SparseSecondOrder, State};

/// Q(lambda) and its parts on the union of the patterns of M, C, K and the internal states, by compressed columns.
#[derive(Debug, Clone)]
pub(crate) struct Pencil {
    order: usize,
    column_starts: Vec<usize>,
    rows: Vec<usize>,
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

/// Whether a matrix acts as it is or transposed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// As it is: right vectors.
    Right,
    /// Transposed: conjugates of left vectors.
    Left,
}

impl Pencil {
    pub(crate) fn new(system: &SparseSecondOrder) -> Self {
        let order = system.order();
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); order];
        for matrix in [&system.m, &system.c, &system.k] {
            matrix.triplet_iter().for_each(|(row, column, _)| columns[column].push(row));
        }
        for state in &system.states {
            for &(column, _) in &state.drive {
                columns[column].extend(state.force.iter().map(|&(row, _)| row));
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
        Self { order, column_starts, rows, mass, damping, stiffness, coupling, states, norms }
    }

    pub(crate) fn order(&self) -> usize {
        self.order
    }

    pub(crate) fn states(&self) -> &[State] {
        &self.states
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
        let mut product = DVector::zeros(self.order);
        for (column, &x) in x.iter().enumerate() {
            for at in self.column_starts[column]..self.column_starts[column + 1] {
                let value = weights.mass * self.mass[at]
                    + weights.damping * self.damping[at]
                    + weights.stiffness * self.stiffness[at];
                product[self.rows[at]] += value * x;
            }
        }
        for (state, &weight) in self.states.iter().zip(&weights.states) {
            let driven: Complex<f64> = state.drive.iter().map(|&(dof, e)| x[dof] * e).sum();
            state.force.iter().for_each(|&(dof, f)| product[dof] += weight * driven * f);
        }
        product
    }

    /// The entries of M.
    pub(crate) fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// `|lambda|^2 |M| + |lambda| |C| + |K|` and the terms of the internal states, as [`cea::backward_error`] has it.
    pub(crate) fn size(&self, lambda: Complex<f64>) -> f64 {
        let l = lambda.norm();
        let state =
            |(state, norm): (&State, &f64)| (lambda / (lambda + state.decay)).norm().min(1.0 / f64::EPSILON) * norm;
        let states: f64 = self.states.iter().zip(&self.norms.states).map(state).sum();
        (l * self.norms.mass + self.norms.damping) * l + self.norms.stiffness + states
    }

    /// `out += A x`, or `A^T x`, for entries on the pattern; rows of x and out are those of the transposed arguments, so that
    /// the entries of one row of a block stand together.
    pub(crate) fn accumulate<T>(
        &self,
        values: &[T],
        side: Side,
        x: MatRef<'_, Complex<f64>>,
        out: &mut Mat<Complex<f64>>,
    ) where
        T: Copy,
        Complex<f64>: std::ops::Mul<T, Output = Complex<f64>>,
    {
        let rows = transposed(x);
        let mut sum = transposed(out.as_ref());
        for column in 0..self.order {
            for at in self.column_starts[column]..self.column_starts[column + 1] {
                let (from, to) = match side {
                    Side::Right => (column, self.rows[at]),
                    Side::Left => (self.rows[at], column),
                };
                let value = values[at];
                let target = sum.col_as_slice_mut(to);
                target.iter_mut().zip(rows.col_as_slice(from)).for_each(|(t, &x)| *t += x * value);
            }
        }
        *out = transposed(sum.as_ref());
    }
}

/// The transposed block.
fn transposed(block: MatRef<'_, Complex<f64>>) -> Mat<Complex<f64>> {
    Mat::from_fn(block.ncols(), block.nrows(), |i, j| block[(j, i)])
}

/// The 2-norm without overflow of the squares.
fn norm(values: &[f64]) -> f64 {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if largest == 0.0 { 0.0 } else { largest * values.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt() }
}

fn length(side: &[(usize, f64)]) -> f64 {
    norm(&side.iter().map(|&(_, value)| value).collect::<Vec<_>>())
}
