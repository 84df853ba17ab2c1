//! Dense matrices for orthogonal reductions, in double or double-double precision.
//!
//! A column holds the high parts of its entries and, in double-double, their low parts after them, so that a vector
//! register takes several entries of one part at once.

use std::marker::PhantomData;
use std::ops::Range;

use nalgebra::DMatrix;
use pulp::Arch;

use super::columns::{AddProduct, ReflectManyRows, SolveTriangle};
use super::kernels::{ReflectColumns, ReflectRows, RotateColumns, RotateRows, Rows};
use super::lane::{Lane, Reflection, Rotation};
use super::scaled::power_of_two;
use crate::lu::real_product;

/// A matrix of entries `T`, column by column.
#[derive(Debug, Clone)]
pub(crate) struct Planar<T> {
    rows: usize,
    columns: usize,
    /// `T::PLANES * rows` numbers for each column.
    data: Vec<f64>,
    arch: Arch,
    entry: PhantomData<T>,
}

impl<T: Lane> From<&DMatrix<f64>> for Planar<T> {
    fn from(a: &DMatrix<f64>) -> Self {
        Self::from_fn(a.nrows(), a.ncols(), |i, j| T::from(a[(i, j)]))
    }
}

impl<T: Lane> Planar<T> {
    pub(crate) fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> T) -> Self {
        let data = vec![0.0; T::PLANES * rows * columns];
        let mut out = Self { rows, columns, data, arch: Arch::new(), entry: PhantomData };
        for j in 0..columns {
            for i in 0..rows {
                out.set(i, j, entry(i, j));
            }
        }
        out
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    pub(crate) fn get(&self, i: usize, j: usize) -> T {
        T::assembled(&self.data[T::PLANES * j * self.rows + i..], self.rows)
    }

    pub(crate) fn set(&mut self, i: usize, j: usize, value: T) {
        value.disassembled(&mut self.data[T::PLANES * j * self.rows + i..], self.rows);
    }

    /// The entries of a column to the precision of a double.
    pub(crate) fn rounded(&self, j: usize) -> &[f64] {
        let start = T::PLANES * j * self.rows;
        &self.data[start..start + self.rows]
    }

    pub(crate) fn transpose(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self.get(j, i))
    }

    /// The block of these rows and columns.
    pub(crate) fn block(&self, rows: Range<usize>, columns: Range<usize>) -> Self {
        Self::from_fn(rows.len(), columns.len(), |i, j| self.get(rows.start + i, columns.start + j))
    }

    /// Frobenius norm, in double precision.
    pub(crate) fn norm(&self) -> f64 {
        let in_units = |unit: f64| {
            let of_column = |j: usize| self.rounded(j).iter().map(|x| (x * unit).powi(2)).sum::<f64>();
            (0..self.columns).map(of_column).sum::<f64>().sqrt() / unit
        };
        let norm = in_units(1.0);
        if norm.is_nan() || (1e-140..1e140).contains(&norm) {
            return norm;
        }
        // Squares that are beyond the range of a double.
        let all = (0..self.columns).flat_map(|j| self.rounded(j));
        let largest = all.fold(0.0, |largest: f64, x| largest.max(x.abs()));
        if largest == 0.0 { 0.0 } else { in_units(power_of_two(1.0 / largest)) }
    }

    /// Columns `column` and `column + 1`, x and y, become `c x - s y` and `c y + s x` in these rows.
    pub(crate) fn rotate_columns(&mut self, column: usize, rows: Range<usize>, by: Rotation<T>) {
        let (size, plane) = (T::PLANES * self.rows, self.rows);
        let (x, y) = self.data[column * size..(column + 2) * size].split_at_mut(size);
        self.arch.dispatch(RotateColumns { columns: [x, y], plane, rows, by });
    }

    /// Columns `column` to `column + 2` reflected in these rows.
    pub(crate) fn reflect_columns(&mut self, column: usize, rows: Range<usize>, by: Reflection<T>) {
        let (arch, plane, columns) = (self.arch, self.rows, self.three(column));
        arch.dispatch(ReflectColumns { columns, plane, rows, by });
    }

    /// Columns `column + 2`, `column + 1` and `column`, in this order, reflected in these rows.
    pub(crate) fn reflect_columns_backwards(&mut self, column: usize, rows: Range<usize>, by: Reflection<T>) {
        let (arch, plane, [x, y, z]) = (self.arch, self.rows, self.three(column));
        arch.dispatch(ReflectColumns { columns: [z, y, x], plane, rows, by });
    }

    fn three(&mut self, column: usize) -> [&mut [f64]; 3] {
        let size = T::PLANES * self.rows;
        let (x, rest) = self.data[column * size..(column + 3) * size].split_at_mut(size);
        let (y, z) = rest.split_at_mut(size);
        [x, y, z]
    }

    /// Rows `bottom - 1` and `bottom`, x and y, become `c x + s y` and `c y - s x` in these columns, then by the next
    /// rotation rows `bottom - 2` and `bottom - 1`, and so on upwards.
    pub(crate) fn rotate_rows_upwards(&mut self, bottom: usize, columns: Range<usize>, by: &[Rotation<T>]) {
        let matrix = Rows { data: &mut self.data, plane: self.rows, columns };
        self.arch.dispatch(RotateRows { matrix, bottom, by });
    }

    /// Rows `top` to `top + 2` reflected in these columns, then by the next reflection rows `top + 1` to `top + 3`, and
    /// so on downwards.
    pub(crate) fn reflect_rows_downwards(&mut self, top: usize, columns: Range<usize>, by: &[Reflection<T>]) {
        let matrix = Rows { data: &mut self.data, plane: self.rows, columns };
        self.arch.dispatch(ReflectRows { matrix, top, by });
    }

    /// The rows from `row` on, as many as `reflector` is long, reflected in the columns from `column` on.
    pub(crate) fn reflect_many_rows(&mut self, row: usize, column: usize, reflector: &Reflector<T>) {
        let (arch, plane) = (self.arch, self.rows);
        let columns = self.columns_from_mut(column);
        arch.dispatch(ReflectManyRows { columns, plane, row, w: &reflector.w, beta: reflector.beta });
    }

    /// [`reflect_many_rows`](Self::reflect_many_rows) in one column alone.
    pub(crate) fn reflect_column(&mut self, row: usize, column: usize, reflector: &Reflector<T>) {
        let (arch, plane) = (self.arch, self.rows);
        let columns = &mut self.columns_from_mut(column)[..T::PLANES * plane];
        arch.dispatch(ReflectManyRows { columns, plane, row, w: &reflector.w, beta: reflector.beta });
    }

    /// `self^-1 other` of an upper triangular matrix.
    pub(crate) fn solve_triangle(&self, other: &mut Self) {
        let diagonal: Vec<T> = (0..self.rows).map(|i| self.get(i, i)).collect();
        let columns = &mut other.data[..];
        self.arch.dispatch(SolveTriangle { columns, r: &self.data, plane: self.rows, diagonal: &diagonal });
    }

    /// `self += a b`.
    pub(crate) fn add_product(&mut self, a: &Self, b: &Self) {
        let (arch, plane) = (self.arch, self.rows);
        arch.dispatch(AddProduct::<T> { columns: &mut self.data, a: &a.data, plane, b: &b.data, entry: PhantomData });
    }

    /// The columns from `column` on, one after the other.
    pub(crate) fn columns_from(&self, column: usize) -> &[f64] {
        &self.data[column * T::PLANES * self.rows..]
    }

    pub(crate) fn columns_from_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.data[column * T::PLANES * self.rows..]
    }

    /// The reflector that clears column `j` below row `row`; none of a column that is zero below it.
    pub(crate) fn reflector(&self, row: usize, j: usize) -> Option<Reflector<T>> {
        Reflector::of(&(row..self.rows).map(|i| self.get(i, j)).collect::<Vec<_>>())
    }
}

/// `I - beta w w^T`, which takes the vector that it was made of to a multiple of the first unit vector; w ends with the last
/// entry of that vector that is not zero.
#[derive(Debug)]
pub(crate) struct Reflector<T> {
    /// Vector w in planes, as a column of [`Planar`].
    w: Vec<f64>,
    beta: T,
}

impl<T: Lane> Reflector<T> {
    /// The length of w.
    pub(crate) fn len(&self) -> usize {
        self.w.len() / T::PLANES
    }

    pub(crate) fn at(&self, i: usize) -> T {
        T::assembled(&self.w[i..], self.len())
    }

    /// w, in planes.
    pub(crate) fn planes(&self) -> &[f64] {
        &self.w
    }

    pub(crate) fn beta(&self) -> T {
        self.beta
    }

    fn of(x: &[T]) -> Option<Self> {
        let largest = x.iter().fold(0.0, |m: f64, v| m.max(v.value().abs()));
        let length = x.iter().rposition(|v| v.value() != 0.0).map_or(0, |last| last + 1);
        if largest.is_nan() || length < 2 {
            return None;
        }
        let x = &x[..length];
        let scale = T::from(1.0) / T::from(largest);
        let mut w: Vec<T> = x.iter().map(|&v| v * scale).collect();
        let square = w.iter().fold(T::default(), |s, &v| s + v * v);
        let norm = square.root();
        let first = w.first().copied().unwrap_or_default();
        let head = if first.value() < 0.0 { first - norm } else { first + norm };
        // |w|^2 with the new head, without another pass.
        let length = square - first * first + head * head;
        if let Some(w) = w.first_mut() {
            *w = head;
        }
        let planes = Planar::from_fn(w.len(), 1, |i, _| w[i]);
        Some(Self { w: planes.data, beta: T::from(2.0) / length })
    }
}

/// `a` made upper triangular from the left, `others` along with it.
pub(crate) fn triangularise<T: Lane, const N: usize>(a: &mut Planar<T>, mut others: [&mut Planar<T>; N]) {
    for k in 0..a.columns().min(a.rows().saturating_sub(1)) {
        if let Some(reflector) = a.reflector(k, k) {
            a.reflect_many_rows(k, k, &reflector);
            others.iter_mut().for_each(|other| other.reflect_many_rows(k, 0, &reflector));
        }
    }
}

/// Reflects `a` from the left so that its rows after the first `rank` vanish if that is its rank, `other` along with
/// it; the largest column that is left takes its turn. Returns what each turn found, descending but for rounding.
pub(crate) fn reveal_rank<T: Lane>(a: &mut Planar<T>, other: &mut Planar<T>, rank: usize) -> Vec<f64> {
    let mut left: Vec<usize> = (0..a.columns()).collect();
    let mut sizes = Vec::with_capacity(rank);
    for k in 0..rank.min(a.rows()) {
        let size = |j: usize| real_product(&a.rounded(j)[k..], &a.rounded(j)[k..]);
        let Some((at, square)) = left.iter().map(|&j| size(j)).enumerate().max_by(|x, y| x.1.total_cmp(&y.1)) else {
            break;
        };
        sizes.push(square.sqrt());
        let column = left.swap_remove(at);
        if let Some(reflector) = a.reflector(k, column) {
            a.reflect_many_rows(k, 0, &reflector);
            // Zero but for rounding, and then passed over by the reflections to come.
            (k + 1..a.rows()).for_each(|i| a.set(i, column, T::default()));
            other.reflect_many_rows(k, 0, &reflector);
        }
    }
    sizes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dd::Dd;
    use nalgebra::dmatrix;

    #[test]
    fn a_matrix_of_rank_one_keeps_one_row() {
        let original = dmatrix![1.0, 2.0, 3.0; 2.0, 4.0, 6.0; -1.0, -2.0, -3.0];
        let (mut a, mut turned) = (Planar::<f64>::from(&original), Planar::from(&DMatrix::identity(3, 3)));
        let sizes = reveal_rank(&mut a, &mut turned, 3);
        let plain = |p: &Planar<f64>| DMatrix::from_fn(3, 3, |i, j| p.get(i, j));
        let (a, turned) = (plain(&a), plain(&turned));
        assert!((sizes[0] - 54f64.sqrt()).abs() < 1e-14 && sizes[1] < 1e-14);
        assert!(a.rows(1, 2).norm() < 1e-14);
        assert!((turned * original - a).norm() < 1e-14);
    }

    #[test]
    fn double_double_triangularises_to_thirty_digits() {
        let hilbert = Planar::from_fn(5, 5, |i, j| Dd::from(1.0) / Dd::from((i + j + 1) as f64));
        let (mut r, mut q) = (hilbert.clone(), Planar::from(&DMatrix::identity(5, 5)));
        triangularise(&mut r, [&mut q]);
        for i in 0..5 {
            for j in 0..5 {
                let product = (0..5).fold(Dd::default(), |s, k| s + q.get(i, k) * hilbert.get(k, j));
                assert!((product - r.get(i, j)).value().abs() < 1e-30);
                assert!(i <= j || r.get(i, j).value().abs() < 1e-30);
            }
        }
    }
}
