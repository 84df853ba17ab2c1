//! LU by fronts of a matrix with a symmetric pattern: the elimination of a group of rows adds to the dense matrix of the group that
//! comes next.
//!
//! Pivots are sought within a group only, so the elimination order of a symmetric matrix serves, which fills much less than an order that leaves room
//! for any pivot. Where the pivots of a group are too small the factors are useless, which a solution shows.

use std::collections::BTreeMap;
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
use linsys::reciprocal;
use num_complex::Complex;

use super::blocks::PAR;
use super::branches::{Group, Part, PartGroup, parts};
use super::in_threads::in_threads;
use super::pencil::Pencil;
use crate::ordering;

/// Most rows of groups that are joined, with the largest fraction of zeros among their entries: fewer than the library's, because factors
/// are read a hundred times as often as they are computed.
const JOINED: &[(usize, f64)] = &[(4, 0.5), (16, 0.1)];

/// The elimination order of a pattern and its groups.
pub(super) struct Elimination {
    /// Row at each position of the order, and position of each row.
    order: Vec<usize>,
    place: Vec<usize>,
    groups: Vec<Group>,
    /// Parts of the groups that do not change each other, and last the part that all of them change.
    parts: Vec<Part>,
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
        let groups: Vec<Group> = (0..groups.n_supernodes()).map(group).collect();
        let (order, place) = symbolic.perm()?.arrays();
        let parts = parts(&groups);
        Some(Self { order: order.to_vec(), place: place.to_vec(), groups, parts })
    }

    pub(super) fn order(&self) -> &[usize] {
        &self.order
    }

    pub(super) fn parts(&self) -> &[Part] {
        &self.parts
    }
}

/// The factors of a matrix, part by part.
pub(super) type Factors = Vec<PartFactors>;

/// The factors of a part of a matrix whose groups are eliminated one after the other: of each, `P A11 = T D U11`, `L21 = A21 U11^-1 D^-1` and
/// `U12 = T^-1 P A12`, with ones on the diagonals of T and U11.
pub(super) struct PartFactors {
    pub(super) groups: Vec<Eliminated>,
    /// T without its diagonal and L21 of all groups, by rows.
    pub(super) lower: Vec<Complex<f64>>,
    /// U11 without its diagonal and `D^-1 U12` of all groups, by columns: the same for the transposed matrix.
    pub(super) upper: Vec<Complex<f64>>,
}

/// Group that was eliminated, and where it stands in both factors. Its rows are counted as those of its part.
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

/// Entries of a factor of a group.
fn size(group: &Group) -> usize {
    triangle(group.width()) + group.width() * group.below.len()
}

/// Entries of k rows below a diagonal.
fn triangle(k: usize) -> usize {
    k * k.saturating_sub(1) / 2
}

/// Changes that eliminated groups make to groups that come later, by these: each with the group that makes it.
type Changes = BTreeMap<usize, Vec<(usize, Mat<Complex<f64>>)>>;

/// The factors of a matrix given on the pattern of `pencil`, the same with any number of threads. A pivot of zero leaves entries that are not finite.
/// `None` where they do not fit into memory.
pub(super) fn factorised(
    elimination: &Elimination,
    pencil: &Pencil,
    values: &[Complex<f64>],
    threads: usize,
) -> Option<Factors> {
    let (last, branches) = elimination.parts.split_last()?;
    let branch = |part: &Part| part_factorised(elimination, part, (pencil, values), Changes::new());
    let (mut factors, mut waiting) = (Factors::with_capacity(elimination.parts.len()), Changes::new());
    for made in in_threads(threads, branches.iter().collect(), branch) {
        let (part, changes) = made?;
        factors.push(part);
        changes.into_iter().for_each(|(group, more)| waiting.entry(group).or_default().extend(more));
    }
    factors.push(part_factorised(elimination, last, (pencil, values), waiting)?.0);
    Some(factors)
}

/// The factors of a part, and the changes that it makes to others; `waiting` are changes that others make to it.
fn part_factorised(
    Elimination { order, place, groups, .. }: &Elimination,
    part: &Part,
    (pencil, values): (&Pencil, &[Complex<f64>]),
    mut waiting: Changes,
) -> Option<(PartFactors, Changes)> {
    let ((starts, rows), mirror) = (pencil.pattern(), pencil.mirror());
    let mut local = vec![0; order.len()];
    let mut factors =
        PartFactors { groups: Vec::with_capacity(part.groups.len()), lower: Vec::new(), upper: Vec::new() };
    let size: usize = part.groups.iter().map(|of_part| size(&groups[of_part.group])).sum();
    factors.lower.try_reserve_exact(size).ok()?;
    factors.upper.try_reserve_exact(size).ok()?;
    // One for all fronts: memory that the system gives anew has to be cleared by it.
    let mut entries = Vec::new();
    for of_part in &part.groups {
        let (s, group) = (of_part.group, &groups[of_part.group]);
        let (from, to) = (group.from, group.to);
        let height = group.width() + group.below.len();
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
        let mut changes = waiting.remove(&s).unwrap_or_default();
        // In one order, whatever the parts are.
        changes.sort_by_key(|(child, _)| *child);
        for (child, change) in changes {
            let below = &groups[child].below;
            for (j, &column) in below.iter().enumerate() {
                let mut target = front.rb_mut().col_mut(local[column]);
                below.iter().zip(change.col_as_slice(j)).for_each(|(&row, value)| target[local[row]] += value);
            }
        }
        let change = eliminate(front, of_part, &mut factors);
        if let Some(next) = group.next {
            waiting.entry(next).or_default().push((s, change));
        }
    }
    Some((factors, waiting))
}

/// Appends the factors of a group: what its elimination leaves of the rows below.
fn eliminate(mut front: MatMut<'_, Complex<f64>>, group: &PartGroup, factors: &mut PartFactors) -> Mat<Complex<f64>> {
    let count = group.below.len();
    let width = front.ncols() - count;
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
    let inverses: Vec<_> = (0..width).map(|i| reciprocal(diagonal[(i, i)])).collect();
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
