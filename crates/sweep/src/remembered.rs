//! Spectra that are asked for again: the places at which modes are counted are also the places at which branches begin.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use cea::{CeaError, EigenSolver, Spectrum, Workspace};
use linsys::SecondOrder;

/// Most spectra that are kept; chosen: as many as a piece of a sweep and its neighbour have.
const MOST: usize = 32;

/// Solver that keeps its last spectra with their systems.
pub(super) struct Remembered<'a> {
    inner: &'a dyn EigenSolver,
    known: Mutex<VecDeque<(SecondOrder, Spectrum)>>,
    solved: AtomicU64,
}

impl<'a> Remembered<'a> {
    pub fn new(inner: &'a dyn EigenSolver) -> Self {
        Self { inner, known: Mutex::default(), solved: AtomicU64::new(0) }
    }

    /// Number of spectra solved.
    pub fn solved(&self) -> u64 {
        self.solved.load(Ordering::Relaxed)
    }
}

impl EigenSolver for Remembered<'_> {
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
        // What another thread kept before it panicked is right all the same.
        let locked = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, spectrum)) = locked().iter().find(|(of, _)| of == system) {
            return Ok(spectrum.clone());
        }
        let spectrum = self.inner.eigenvalues(system, work)?;
        self.solved.fetch_add(1, Ordering::Relaxed);
        let mut known = locked();
        known.push_back((system.clone(), spectrum.clone()));
        if known.len() > MOST {
            known.pop_front();
        }
        Ok(spectrum)
    }
}
