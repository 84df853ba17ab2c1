//! A solver that counts the spectra that it is asked for: what is printed of them is the same with any number of threads.

use std::sync::atomic::{AtomicU64, Ordering};

use cea::{CeaError, EigenSolver, Spectrum, Workspace};
use linsys::SecondOrder;

/// Solver that asks another one and counts.
pub(super) struct CountingSolver<'a> {
    inner: &'a dyn EigenSolver,
    asked: AtomicU64,
}

impl<'a> CountingSolver<'a> {
    pub fn new(inner: &'a dyn EigenSolver) -> Self {
        Self { inner, asked: AtomicU64::new(0) }
    }

    /// Number of spectra that were asked for.
    pub fn asked(&self) -> u64 {
        self.asked.load(Ordering::Relaxed)
    }
}

impl EigenSolver for CountingSolver<'_> {
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
        self.asked.fetch_add(1, Ordering::Relaxed);
        self.inner.eigenvalues(system, work)
    }

    fn eigenvalues_of_all(
        &self,
        systems: &[SecondOrder],
        work: &mut Workspace,
        spectra: &mut Vec<Result<Spectrum, CeaError>>,
    ) {
        self.asked.fetch_add(systems.len() as u64, Ordering::Relaxed);
        self.inner.eigenvalues_of_all(systems, work, spectra);
    }
}
