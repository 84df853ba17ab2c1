//! A finite element brake on its bases: with each set of constraints, and in the arrangements that are studied together.

use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex};

use linsys::{AffineSystem, DofMap};
use nalgebra::DMatrix;
use num_complex::Complex;
use reduction::{Combinations, Compared, Losses, Reduced, RouteCounts, Within, compared};
use sparse::SparseAffineSystem;

use super::points;
use super::set_basis::{HeldOut, SetBasis};
use super::together::Together;
use super::training::{AT_BORDER, rectangle};
use crate::Error;
use crate::case::FiniteElementCase;

/// The brake with one set of constraints.
#[derive(Debug)]
pub struct ReducedSet {
    /// Map of the free rows of the matrices.
    pub dofs: DofMap,
    /// The system over the free rows.
    pub system: SparseAffineSystem,
    /// Basis V, n x k: it holds the brake in all arrangements.
    pub basis: Arc<DMatrix<f64>>,
    /// Number of its first columns that have all modes of any draw, roughly.
    pub(super) leading: usize,
    /// Eigenvalues of the whole brake at the medians with all patches closed, in the rectangle and around it, rad/s.
    pub(super) at_medians: Vec<Complex<f64>>,
    /// True if at the medians the brake on the basis has modes that the whole one does not have.
    has_others: bool,
    /// Number of complete solutions that are made together, and how many of single eigenvalues may begin now.
    pub(super) together: Arc<Together>,
    /// Combinations of residuals on smaller bases within it.
    combinations: Combinations,
    /// The brake on it, with dashpots in the place of loss factors.
    pub reduced: AffineSystem,
    /// Loss factors; `None` where no term has one.
    losses: Option<Losses>,
    /// The modes of the whole brake in the rectangle, at the medians with all patches closed.
    pub modes: Vec<Complex<f64>>,
    /// Comparison of these modes with the modes of the reduced brake.
    pub compared: Compared,
    /// Draws of which the basis was not made.
    pub(super) drawn: Vec<HeldOut>,
    /// Largest distance, relative to |lambda|, from the whole brake to the reduced brake, of a mode that may grow or not, at these draws; 1 where at one of the
    /// draws, or at the medians, the two do not have the same modes, and 0 without draws.
    pub held_out: f64,
    /// The largest such distance at full checks, of the modes next to the axis that the two have in common; 0 without full checks. It counts three times among
    /// the errors assumed of samples (`mode_source.rs`).
    pub checked: f64,
    /// Largest residual of the modes that [`held_out`](Self::held_out) compares: an error that was measured is known of modes with such residuals, and not
    /// of others.
    pub held_out_residual: f64,
}

/// The brake with one set of constraints in some arrangements, on a basis of its own.
#[derive(Debug)]
pub struct Part {
    /// The set of constraints.
    pub set: usize,
    /// Basis within the basis of the set, what it took, and whether it has the error that was asked for.
    pub within: Within,
    /// Largest distance, relative to |lambda|, of its modes with dashpots from its modes with loss factors, where it was measured; 0 without loss factors.
    pub distance_of_losses: f64,
    /// Modes in the rectangle at the medians, rad/s.
    pub first: Vec<Complex<f64>>,
    /// The brake, with residuals in the whole one.
    pub reduced: Reduced,
    /// Number of samples that each route found.
    pub routes: Mutex<RouteCounts>,
    /// Number of samples in which the whole brake was asked about modes whose verdict is open.
    pub settled: AtomicU64,
}

impl ReducedSet {
    /// The brake over the rows that are left free, on a basis for all arrangements, of which nothing is compared yet.
    pub(super) fn new(
        case: &FiniteElementCase,
        fixed: &[usize],
        together: Arc<Together>,
        basis: impl FnOnce(&SparseAffineSystem) -> Result<SetBasis, Error>,
    ) -> Result<Self, Error> {
        let dofs = DofMap::new(case.dofs.len(), fixed)?;
        let system = case.system.on(&dofs)?;
        let SetBasis { basis, leading, at_medians, has_others, held_out: drawn } = basis(&system)?;
        let projected = system.project(&basis)?;
        let losses = Losses::new(&system, &projected, &points::at_medians(case)?)?;
        let reduced = match &losses {
            Some(losses) => losses.with_dashpots(&projected)?,
            None => projected,
        };
        let combinations = Combinations::new(&system, &basis);
        let compared = compared(&[], &[]);
        Ok(Self {
            dofs,
            system,
            basis: Arc::new(basis),
            leading,
            at_medians,
            has_others,
            together,
            combinations,
            reduced,
            losses,
            modes: Vec::new(),
            compared,
            drawn,
            held_out: 0.0,
            checked: 0.0,
            held_out_residual: 0.0,
        })
    }

    /// Number of modes of the reduced brake at the medians, surely where they are wanted, that the whole brake does not have.
    #[must_use]
    pub fn invented(&self, case: &FiniteElementCase) -> usize {
        surely_wanted(case, &self.compared.left)
    }

    /// True if the reduced brake and the whole one do not have the same modes at the medians.
    pub(super) fn has_others(&self, case: &FiniteElementCase) -> bool {
        self.has_others || self.invented(case) + surely_wanted(case, &self.compared.missed) > 0
    }

    /// The brake on a smaller basis W within the basis of the set.
    pub(super) fn reduced_within(&self, columns: &DMatrix<f64>, case: &FiniteElementCase) -> Result<Reduced, Error> {
        let of_set = (&self.basis, &self.reduced, &self.combinations);
        Ok(Reduced::within(of_set, self.losses.as_ref(), columns, rectangle(case), case.reduction.residual)?)
    }
}

/// Number of modes that are wanted wherever the error of a reduction puts them.
fn surely_wanted(case: &FiniteElementCase, modes: &[Complex<f64>]) -> usize {
    let wanted = rectangle(case);
    modes.iter().filter(|lambda| wanted.contains_to_the_right(**lambda, -AT_BORDER * lambda.norm())).count()
}
