//! Eigenvalues of many systems at once, one per lane of the vector registers.
//!
//! The QR algorithm takes the same operations for all systems of one shape: Householder's reduction to Hessenberg form, then
//! Francis' double-shift sweeps, eigenvalues only. One register holds entry (i, j) of 8 matrices (AVX-512), 4 (AVX2) or 2
//! (NEON); a machine without vector units takes one matrix at a time. Each lane has its own deflations and shifts. A lane
//! that is finished, or has no row in the current step, reflects by the identity.
//!
//! **Bits.** The spectrum of a system does not depend on its lane, the other systems, or the number of systems or threads, to
//! the last bit: no operation mixes lanes, and the identity changes no number. It does not depend on the machine either if that
//! has fused multiply-add (x86-64 with AVX2 since 2013, every aarch64). Older machines round a product and a sum separately, and
//! their results differ in the last digits.

mod diagonal;
mod hessenberg;
mod iterate;
mod layout;
mod pack;
mod reflector;
mod shifts;
mod sweep;
#[cfg(test)]
mod tests;

use linsys::SecondOrder;
use pulp::{Arch, Simd, WithSimd, bytemuck};

use super::qr::QrSolver;
use super::solver::EigenSolver;
use crate::{CeaError, Spectrum, Workspace, sort};
use certified::lanes::{Ops, narrow, registers, wide_part};
use layout::Layout;
use pack::FrequencyScale;

/// Solver of all eigenvalues of many systems at once, for studies.
///
/// The accuracy is that of [`QrSolver`]: normwise backward stable on the same scaled [`StandardForm`](crate::StandardForm).
/// A system that does not converge, is malformed, cannot be scaled, or has dashpots or internal states a hundred times faster
/// than its vibrations is solved by `QrSolver`, or gets its error.
///
/// ```
/// use cea::{BatchSolver, EigenSolver, Workspace};
/// use linsys::SecondOrder;
/// use nalgebra::dmatrix;
///
/// // Two masses coupled by friction: flutter sets in where mu reaches 1 / 3.
/// let systems: Vec<SecondOrder> = (0..10)
///     .map(|i| 0.1 * f64::from(i))
///     .map(|mu| {
///         let (m, c) = (dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![0.0, 0.0; 0.0, 0.0]);
///         SecondOrder::new(m, c, dmatrix![10.0, 3.0 * mu; -3.0 * mu, 12.0])
///     })
///     .collect::<Result<_, _>>()?;
/// let mut spectra = Vec::new();
/// BatchSolver.eigenvalues_of_all(&systems, &mut Workspace::default(), &mut spectra);
/// let unstable = spectra.iter().flatten().filter(|s| s.oscillatory().any(|l| l.re > 1e-9)).count();
/// assert_eq!(unstable, 6);
/// # Ok::<(), linsys::LinsysError>(())
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct BatchSolver;

impl EigenSolver for BatchSolver {
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
        let mut spectra = Vec::with_capacity(1);
        self.eigenvalues_of_all(std::slice::from_ref(system), work, &mut spectra);
        let handed_back = || hand_back(system, work);
        spectra.pop().unwrap_or_else(handed_back)
    }

    fn eigenvalues_of_all(
        &self,
        systems: &[SecondOrder],
        work: &mut Workspace,
        out: &mut Vec<Result<Spectrum, CeaError>>,
    ) {
        solve_on(Arch::new(), systems, work, out);
    }
}

/// [`BatchSolver`] on a given instruction set.
fn solve_on(arch: Arch, systems: &[SecondOrder], work: &mut Workspace, out: &mut Vec<Result<Spectrum, CeaError>>) {
    out.clear();
    let mut found = Vec::with_capacity(systems.len());
    for group in systems.chunk_by(|a, b| pack::shape(a) == pack::shape(b)) {
        let Some(shape) = group.first().and_then(pack::shape) else {
            found.extend(group.iter().map(|_| None));
            continue;
        };
        let (wide, few) = group.split_at(wide_part(group.len()));
        let scratch = &mut work.scratch;
        if !wide.is_empty() {
            arch.dispatch(EigenvaluesInLanes { systems: wide, shape, scratch, found: &mut found });
        }
        if !few.is_empty() {
            narrow(arch, EigenvaluesInLanes { systems: few, shape, scratch, found: &mut found });
        }
    }
    for (system, spectrum) in systems.iter().zip(found) {
        out.push(match spectrum {
            Some(spectrum) => {
                work.counters.eigenvalue_solves += 1;
                Ok(spectrum)
            }
            None => hand_back(system, work),
        });
    }
}

/// Solves a system that the batch could not solve.
fn hand_back(system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
    system.check()?;
    QrSolver.eigenvalues(system, work)
}

/// Solves systems of one shape (n, s), as many at a time as there are lanes; `None` for a system that is handed back.
struct EigenvaluesInLanes<'a> {
    systems: &'a [SecondOrder],
    shape: (usize, usize),
    scratch: &'a mut Vec<f64>,
    found: &'a mut Vec<Option<Spectrum>>,
}

impl WithSimd for EigenvaluesInLanes<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let o = Ops::new(simd);
        let lanes = S::F64_LANES;
        let layout = Layout::new(2 * self.shape.0 + self.shape.1);
        let registers = registers::<S>(self.scratch, layout.len() + hessenberg::scratch_len(layout));
        let (a, vectors) = registers.split_at_mut(layout.len());
        for samples in self.systems.chunks(lanes) {
            let mut scale = pack::pack(o, a, layout, samples, self.shape, vectors);
            hessenberg::reduce(o, &mut *a, layout, vectors);
            let failed = iterate::iterate(o, a, layout);
            read_off::<S>(a, layout, &mut scale, &failed[..samples.len()], self.found);
        }
    }
}

/// Appends the spectrum of each system from its quasi-triangular matrix; `None` for a system that is handed back.
fn read_off<S: Simd>(
    a: &[S::f64s],
    layout: Layout,
    scale: &mut FrequencyScale<S::f64s>,
    failed: &[bool],
    found: &mut Vec<Option<Spectrum>>,
) {
    let entries: &[f64] = bytemuck::cast_slice(a);
    let gammas: &[f64] = bytemuck::cast_slice(std::slice::from_ref(&scale.gamma));
    let sizes: &[f64] = bytemuck::cast_slice(std::slice::from_ref(&scale.size));
    for (lane, &failed) in failed.iter().enumerate() {
        let (gamma, size) = (gammas[lane], sizes[lane]);
        if failed || !size.is_finite() {
            found.push(None);
            continue;
        }
        let at = |i, j| entries[layout.at(i, j) * S::F64_LANES + lane];
        let mut eigenvalues = diagonal::eigenvalues(layout.order, at);
        eigenvalues.iter_mut().for_each(|sigma| *sigma *= gamma);
        sort(&mut eigenvalues);
        found.push(Some(Spectrum { eigenvalues, scale: size }));
    }
}
