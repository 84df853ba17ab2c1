//! Classes of arrangements that differ only in the labels of the oscillators.
//!
//! Reversing the order of the rows, of the columns, or of both *as labels*, without any change of sign, does not change a
//! lattice of equal springs and equal contacts. Arrangements that such a relabelling maps onto each other have the same
//! eigenvalues, so that one arrangement represents them all.

use nalgebra::DMatrix;

use super::assembly::assemble;
use super::{ContactArrangement, Grid, LatticeModel};
use crate::OscModelError;

/// A relabelling of the oscillators; the four form Klein's group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reversal {
    /// Every oscillator keeps its label.
    None,
    /// The first row becomes the last.
    Rows,
    /// The first column becomes the last.
    Columns,
    /// Rows and columns are both reversed.
    Both,
}

impl Reversal {
    /// The four reversals, the identity first.
    pub const ALL: [Self; 4] = [Self::None, Self::Rows, Self::Columns, Self::Both];

    /// The label, from 0, that oscillator `i < grid.oscillators()` takes. Applied twice it gives `i` again.
    pub fn oscillator(self, grid: Grid, i: usize) -> usize {
        let (row, column) = (i / grid.columns(), i % grid.columns());
        let row = if matches!(self, Self::Rows | Self::Both) { grid.rows() - 1 - row } else { row };
        let column = if matches!(self, Self::Columns | Self::Both) { grid.columns() - 1 - column } else { column };
        row * grid.columns() + column
    }

    /// The index, from 0, that degree of freedom `i` of the unconstrained lattice takes; the plate keeps its own.
    pub fn dof(self, grid: Grid, i: usize) -> usize {
        if i >= 3 * grid.oscillators() { i } else { 3 * self.oscillator(grid, i / 3) + i % 3 }
    }
}

/// Arrangements with equal eigenvalues.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SymmetryClass {
    /// Index, in the list of arrangements, of the one that represents the class: its first.
    pub representative: usize,
    /// Every arrangement of the class, the representative first.
    pub members: Vec<Member>,
}

/// An arrangement of a [`SymmetryClass`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Member {
    /// Index in the list of arrangements.
    pub arrangement: usize,
    /// The reversal that maps the representative onto this member: oscillator `reversal.oscillator(i)` of this member moves as
    /// oscillator i of the representative.
    pub reversal: Reversal,
}

impl LatticeModel {
    /// The relabellings that leave this lattice unchanged: its matrices with every oscillator in contact, to the last
    /// bit, and its set of constraints.
    pub fn symmetries(&self) -> Vec<Reversal> {
        let p = self.parameters();
        let structure = assemble(p, &ContactArrangement::full(p.grid.oscillators()));
        let keeps = |reversal: Reversal| {
            let to = |i: usize| reversal.dof(p.grid, i);
            let same =
                |a: &DMatrix<f64>| (0..a.nrows()).all(|i| (0..a.ncols()).all(|j| a[(i, j)] == a[(to(i), to(j))]));
            let dofs = self.dof_map();
            same(&structure.m)
                && same(&structure.c)
                && same(&structure.k)
                && dofs.free().iter().all(|&i| dofs.position(to(i)).is_some())
        };
        Reversal::ALL.into_iter().filter(|&reversal| keeps(reversal)).collect()
    }

    /// Sorts arrangements into classes of equal eigenvalues, in the order of their first members, by these [`symmetries`](Self::symmetries).
    ///
    /// The eigenvalues of a class are equal where all contacts of a state of sliding are equal: one draw of the friction
    /// parameters for all contacts, and a preload with the symmetry. With a draw for each contact a relabelling also moves the
    /// draws; then the distributions of the eigenvalues are equal, not the eigenvalues of single samples, if the draws are as likely the other way round.
    ///
    /// # Errors
    /// An arrangement of a lattice of another size.
    pub fn symmetry_classes(
        &self,
        symmetries: &[Reversal],
        arrangements: &[ContactArrangement],
    ) -> Result<Vec<SymmetryClass>, OscModelError> {
        arrangements.iter().try_for_each(|arrangement| self.check_size(arrangement))?;
        let mut classes: Vec<SymmetryClass> = Vec::new();
        for (place, arrangement) in arrangements.iter().enumerate() {
            let joined = classes.iter_mut().find_map(|class| {
                let representative = &arrangements[class.representative];
                let carries = |reversal: &Reversal| self.carries(*reversal, representative, arrangement);
                symmetries.iter().copied().find(carries).map(|reversal| (class, reversal))
            });
            match joined {
                Some((class, reversal)) => class.members.push(Member { arrangement: place, reversal }),
                None => classes.push(SymmetryClass {
                    representative: place,
                    members: vec![Member { arrangement: place, reversal: Reversal::None }],
                }),
            }
        }
        Ok(classes)
    }

    /// True if a reversal makes of each arrangement of a list one that is in the list too.
    #[must_use]
    pub fn keeps_all(&self, reversal: Reversal, arrangements: &[ContactArrangement]) -> bool {
        let is_in = |from: &ContactArrangement| arrangements.iter().any(|to| self.carries(reversal, from, to));
        arrangements.iter().all(is_in)
    }

    /// True if a reversal maps one arrangement onto another.
    pub(crate) fn carries(&self, reversal: Reversal, from: &ContactArrangement, to: &ContactArrangement) -> bool {
        let grid = self.parameters().grid;
        from.in_contact().len() == to.in_contact().len()
            && from.in_contact().iter().all(|&i| to.contains(reversal.oscillator(grid, i)))
    }
}
