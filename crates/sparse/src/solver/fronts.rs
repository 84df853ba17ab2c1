//! LU by fronts of a matrix with a symmetric pattern: the elimination of a group of rows adds to the dense matrix of the group that
//! comes next.
//!
//! Pivots are sought within a group only, so the elimination order of a symmetric matrix serves, which fills much less than an order that leaves room
//! for any pivot. Where the pivots of a group are too small the factors are useless, which a solution shows.

use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place};
use faer::prelude::ReborrowMut;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SymbolicSupernodalParams;
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::{Accum, Mat, MatMut, Spec};
use num_complex::Complex;

use super::blocks::PAR;
use super::pencil::Pencil;
use crate::ordering;

/// Most rows of groups that are joined, with the largest fraction of zeros among their entries: fewer than the library's, because factors
/// are read a hundred times as often as they are computed.
const JOINED: &[(usize, f64)] = &[(4, 0.5), (16, 0.1)];

/// Rows that are eliminated together, and the rows that they change.
struct Group {
    from: usize,
    to: usize,
    /// Rows that they change, ascending, all after `to`.
    below: Vec<usize>,
    /// The group that comes next: of the first row below.
    next: Option<usize>,
}

impl Group {
    /// Entries of a factor.
    fn size(&self) -> usize {
        let width = self.to - self.from;
        triangle(width) + width * self.below.len()
    }
}

/// The elimination order of a pattern and its groups.
pub(super) struct Elimination {
    /// Row at each position of the order, and position of each row.
    order: Vec<usize>,
    place: Vec<usize>,
    groups: Vec<Group>,
}

impl Elimination {
    /// The elimination order for the pattern of a pencil; `None` where it does not fit into memory.
    pub(super) fn new(pencil: &Pencil) -> Option<Self> {
        let n = pencil.order();
        let (starts, rows) = pencil.pattern();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, starts, None, rows);
        let symbolic = ordering::symbolic(pattern, SymbolicSupernodalParams { relax: Some(JOINED) })?;
        let SymbolicCholeskyRaw::Supernodal(groups) = symbolic.raw() else { return None };
        let mut group_of = vec![0; n];
        let borders = groups.supernode_begin().iter().zip(groups.supernode_end());
        borders.enumerate().for_each(|(s, (&from, &to))| group_of[from..to].fill(s));
        let group = |s: usize| {
            let (from, to) = (groups.supernode_begin()[s], groups.supernode_end()[s]);
            let below = groups.supernode(s).pattern().to_vec();
            let next = below.first().map(|&row| group_of[row]);
            Group { from, to, below, next }
        };
        let groups = (0..groups.n_supernodes()).map(group).collect();
        let (order, place) = symbolic.perm()?.arrays();
        Some(Self { order: order.to_vec(), place: place.to_vec(), groups })
    }

    pub(super) fn order(&self) -> &[usize] {
        &self.order
    }
}

/// The factors of a matrix whose groups are eliminated one after the other: of each, `P A11 = T D U11`, `L21 = A21 U11^-1 D^-1` and
/// `U12 = T^-1 P A12`, with ones on the diagonals of T and U11.
pub(super) struct Factors {
    pub(super) groups: Vec<Eliminated>,
    /// T without its diagonal and L21 of all groups, by rows.
    pub(super) lower: Vec<Complex<f64>>,
    /// U11 without its diagonal and `D^-1 U12` of all groups, by columns: the same for the transposed matrix.
    pub(super) upper: Vec<Complex<f64>>,
}

/// Group that was eliminated, and where it stands in both factors.
pub(super) struct Eliminated {
    pub(super) from: usize,
    /// Row of A11 at each row of `P A11`.
    pub(super) pivots: Vec<usize>,
    /// `D^-1`.
    pub(super) inverses: Vec<Complex<f64>>,
    pub(super) below: Vec<usize>,
    at: usize,
}

impl Eliminated {
    pub(super) fn width(&self) -> usize {
        self.pivots.len()
    }

    /// Range in which row k of T stands, or column k of U11: k entries.
    #[inline(always)]
    pub(super) fn own_row(&self, k: usize) -> Range<usize> {
        let from = self.at + triangle(k);
        from..from + k
    }

    /// Range in which row i of L21 stands, or column i of U12.
    #[inline(always)]
    pub(super) fn row_below(&self, i: usize) -> Range<usize> {
        let from = self.at + triangle(self.width()) + i * self.width();
        from..from + self.width()
    }
}

/// Entries of k rows below a diagonal.
fn triangle(k: usize) -> usize {
    k * k.saturating_sub(1) / 2
}

/// The factors of a matrix given on the pattern of `pencil`. A pivot of zero leaves entries that are not finite. `None` where they do
/// not fit into memory.
pub(super) fn factorised(elimination: &Elimination, pencil: &Pencil, values: &[Complex<f64>]) -> Option<Factors> {
    let Elimination { order, place, groups } = elimination;
    let ((starts, rows), mirror) = (pencil.pattern(), pencil.mirror());
    let mut local = vec![0; order.len()];
    let mut waiting: Vec<Vec<(usize, Mat<Complex<f64>>)>> = groups.iter().map(|_| Vec::new()).collect();
    let mut factors = Factors { groups: Vec::with_capacity(groups.len()), lower: Vec::new(), upper: Vec::new() };
    let size: usize = groups.iter().map(Group::size).sum();
    factors.lower.try_reserve_exact(size).ok()?;
    factors.upper.try_reserve_exact(size).ok()?;
    // One for all fronts: memory that the system gives anew has to be cleared by it.
    let mut entries = Vec::new();
    for (s, group) in groups.iter().enumerate() {
        let (from, to) = (group.from, group.to);
        let height = to - from + group.below.len();
        (from..to).chain(group.below.iter().copied()).enumerate().for_each(|(at, row)| local[row] = at);
        entries.clear();
        entries.try_reserve_exact(height * height).ok()?;
        entries.resize(height * height, Complex::default());
        let mut front = MatMut::from_column_major_slice_mut(&mut entries, height, height);
        for (j, &column) in (from..).zip(&order[from..to]) {
            for at in starts[column]..starts[column + 1] {
                let i = place[rows[at]];
                if i >= from {
                    front[(local[i], j - from)] += values[at];
                }
                if i >= to {
                    front[(j - from, local[i])] += values[mirror[at]];
                }
            }
        }
        for (child, change) in std::mem::take(&mut waiting[s]) {
            let below = &groups[child].below;
            for (j, &column) in below.iter().enumerate() {
                let mut target = front.rb_mut().col_mut(local[column]);
                below.iter().zip(change.col_as_slice(j)).for_each(|(&row, value)| target[local[row]] += value);
            }
        }
        let change = eliminate(front, group, &mut factors);
        if let Some(next) = group.next {
            waiting[next].push((s, change));
        }
    }
    Some(factors)
}

/// Appends the factors of a group: what its elimination leaves of the rows below.
fn eliminate(mut front: MatMut<'_, Complex<f64>>, group: &Group, factors: &mut Factors) -> Mat<Complex<f64>> {
    let (width, count) = (group.to - group.from, group.below.len());
    let (mut pivots, mut inverse) = (vec![0; width], vec![0; width]);
    let mut buffer = MemBuffer::new(lu_in_place_scratch::<usize, Complex<f64>>(width, width, PAR, Spec::default()));
    let block = front.rb_mut().submatrix_mut(0, 0, width, width);
    lu_in_place(block, &mut pivots, &mut inverse, PAR, MemStack::new(&mut buffer), Spec::default());
    let front = front.as_ref();
    let diagonal = front.submatrix(0, 0, width, width);
    let mut upper = Mat::from_fn(width, count, |i, j| front[(pivots[i], width + j)]);
    solve_unit_lower_triangular_in_place(diagonal, upper.as_mut(), PAR);
    let mut lower = front.submatrix(width, 0, count, width).transpose().to_owned();
    solve_lower_triangular_in_place(diagonal.transpose(), lower.as_mut(), PAR);
    let mut change = front.submatrix(width, width, count, count).to_owned();
    let minus = Complex::from(-1.0);
    matmul(change.as_mut(), Accum::Add, lower.transpose(), upper.as_ref(), minus, PAR);
    let inverses: Vec<_> = (0..width).map(|i| diagonal[(i, i)].inv()).collect();
    let at = factors.lower.len();
    for k in 0..width {
        factors.lower.extend((0..k).map(|j| diagonal[(k, j)]));
        factors.upper.extend((0..k).map(|j| diagonal[(j, k)] * inverses[j]));
    }
    for j in 0..count {
        factors.lower.extend_from_slice(lower.col_as_slice(j));
        factors.upper.extend(upper.col_as_slice(j).iter().zip(&inverses).map(|(value, inverse)| value * inverse));
    }
    factors.groups.push(Eliminated { from: group.from, pivots, inverses, below: group.below.clone(), at });
    change
}
