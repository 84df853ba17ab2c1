//! The trait of the solvers that compute all eigenvalues of a system.

use linsys::SecondOrder;
use num_complex::Complex;

use crate::{CeaError, Spectrum, Workspace, by_frequency};

/// Finds all eigenvalues of a second-order system.
///
/// Eigenvectors are computed separately, by [`right_vector`](crate::right_vector) and [`left_vector`](crate::left_vector).
pub trait EigenSolver: Sync {
    /// Spectrum of a system: all 2 n + s eigenvalues.
    ///
    /// # Errors
    /// A system that the solver does not support (one with a singular mass matrix, for example), or no convergence.
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError>;

    /// The eigenvalues of several systems of one shape; `out` is cleared and filled in their order.
    ///
    /// The result for a system does not depend on its neighbours, to the last bit.
    fn eigenvalues_of_all(
        &self,
        systems: &[SecondOrder],
        work: &mut Workspace,
        out: &mut Vec<Result<Spectrum, CeaError>>,
    ) {
        out.clear();
        for system in systems {
            let spectrum = self.eigenvalues(system, work);
            out.push(spectrum);
        }
    }
}

/// A solver whose spectra are checked: all 2 n + s eigenvalues, sorted by [`sort`](crate::sort), complex ones in exact conjugate pairs.
/// An eigenvalue that a solver left out would else count as stable.
#[derive(Clone, Copy)]
pub struct WholeSpectra<'a>(pub &'a dyn EigenSolver);

impl EigenSolver for WholeSpectra<'_> {
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
        whole(system, self.0.eigenvalues(system, work)?)
    }

    fn eigenvalues_of_all(
        &self,
        systems: &[SecondOrder],
        work: &mut Workspace,
        out: &mut Vec<Result<Spectrum, CeaError>>,
    ) {
        self.0.eigenvalues_of_all(systems, work, out);
        let (found, expected) = (out.len(), systems.len());
        if found != expected {
            out.clear();
            out.extend(systems.iter().map(|_| Err(CeaError::SpectraCount { found, expected })));
        }
        let all = std::mem::take(out).into_iter().zip(systems);
        out.extend(all.map(|(spectrum, system)| whole(system, spectrum?)));
    }
}

fn whole(system: &SecondOrder, spectrum: Spectrum) -> Result<Spectrum, CeaError> {
    let (found, expected) = (spectrum.eigenvalues.len(), 2 * system.order() + system.states());
    if found != expected {
        return Err(CeaError::SpectrumLength { found, expected });
    }
    // Equal ones stand together, those below the axis first: each list by itself, in the same order.
    let all = || spectrum.eigenvalues.iter();
    let mut below = all().filter(|lambda| lambda.im < 0.0);
    let above = all().filter(|lambda| lambda.im > 0.0).find(|lambda| below.next().map(Complex::conj) != Some(**lambda));
    let unpaired = above.or_else(|| below.next());
    let is_sorted = |pair: &[Complex<f64>]| by_frequency(&pair[0], &pair[1]).is_le();
    let unsorted = spectrum.eigenvalues.windows(2).find(|pair| !is_sorted(pair)).map(|pair| &pair[1]);
    let infinite = spectrum.eigenvalues.iter().find(|lambda| !lambda.is_finite());
    match infinite.or(unpaired).or(unsorted) {
        Some(&lambda) => Err(CeaError::SpectrumOrder { lambda }),
        None => Ok(spectrum),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BatchSolver, QrSolver};
    use nalgebra::{DMatrix, dmatrix};

    /// Spoils a spectrum.
    struct Spoiled(fn(&mut Vec<Complex<f64>>));

    impl EigenSolver for Spoiled {
        fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
            let mut spectrum = QrSolver.eigenvalues(system, work)?;
            (self.0)(&mut spectrum.eigenvalues);
            Ok(spectrum)
        }
    }

    #[test]
    fn what_is_no_whole_spectrum_is_an_error() {
        let damped = dmatrix![0.1, 0.0; 0.0, 9.0];
        let system = SecondOrder::new(DMatrix::identity(2, 2), damped, dmatrix![4.0, 1.0; 1.0, 9.0]).unwrap();
        let mut work = Workspace::default();
        for solver in [&QrSolver as &dyn EigenSolver, &BatchSolver] {
            let spectrum = solver.eigenvalues(&system, &mut work).unwrap();
            assert_eq!(WholeSpectra(solver).eigenvalues(&system, &mut work).unwrap(), spectrum);
        }
        let spoiled: [fn(&mut Vec<Complex<f64>>); 7] = [
            Vec::clear,
            |all| all.truncate(all.len() - 1),
            |all| all.truncate(2),
            |all| all.push(all[0]),
            |all| all.reverse(),
            |all| all[3].re = f64::NAN,
            |all| all[3].re += 1e-9,
        ];
        for spoil in spoiled {
            let solver = Spoiled(spoil);
            assert!(WholeSpectra(&solver).eigenvalues(&system, &mut work).is_err());
            let mut out = Vec::new();
            WholeSpectra(&solver).eigenvalues_of_all(&[system.clone(), system.clone()], &mut work, &mut out);
            assert!(out.len() == 2 && out.iter().all(Result::is_err));
        }
    }
}
