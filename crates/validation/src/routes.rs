//! Solver routes: methods that compute all eigenvalues of a system.

use cea::{BatchSolver, EigenSolver, QrSolver, StandardForm, Workspace, certified};
use linsys::SecondOrder;
use nalgebra::{DMatrix, Schur};
use num_complex::Complex;

/// Most steps of nalgebra's QR iteration for one matrix; chosen: by default the iteration has no limit.
const MOST_NALGEBRA_STEPS: usize = 100_000;

/// Eigenvalues of each system, all of them; `None` where the route fails.
pub type Spectra = Vec<Option<Vec<Complex<f64>>>>;

/// A method for all eigenvalues.
#[derive(Clone, Copy)]
pub struct SolverRoute {
    /// Name in reports.
    pub name: &'static str,
    /// The eigenvalues of systems of one shape.
    pub solve: fn(&[SecondOrder]) -> Spectra,
}

/// The routes of this project, and the routes of nalgebra for comparison.
pub fn routes() -> Vec<SolverRoute> {
    vec![
        SolverRoute { name: "QrSolver", solve: |systems| by(&QrSolver, systems) },
        SolverRoute { name: "BatchSolver, SIMD", solve: |systems| by(&BatchSolver, systems) },
        SolverRoute { name: "general: QR or QZ", solve: |systems| systems.iter().map(by_general).collect() },
        SolverRoute { name: "nalgebra Schur, scaled", solve: |systems| systems.iter().map(by_schur_scaled).collect() },
        SolverRoute { name: "nalgebra Schur, raw", solve: |systems| systems.iter().map(by_schur_raw).collect() },
    ]
}

fn by(solver: &dyn EigenSolver, systems: &[SecondOrder]) -> Spectra {
    let mut found = Vec::new();
    solver.eigenvalues_of_all(systems, &mut Workspace::default(), &mut found);
    found.into_iter().map(|spectrum| spectrum.ok().map(|s| s.eigenvalues)).collect()
}

fn by_general(system: &SecondOrder) -> Option<Vec<Complex<f64>>> {
    certified::solve(system, &mut certified::Counters::default()).ok().map(|s| s.eigenvalues)
}

fn by_schur_scaled(system: &SecondOrder) -> Option<Vec<Complex<f64>>> {
    let form = StandardForm::new(system).ok()?;
    Some(by_schur(form.state)?.into_iter().map(|sigma| sigma * form.gamma).collect())
}

fn by_schur_raw(system: &SecondOrder) -> Option<Vec<Complex<f64>>> {
    by_schur(raw_state(system)?)
}

/// The state matrix of textbooks, `[0 I 0; -M^-1 K, -M^-1 C, M^-1 F; 0 E -a]`; `None` where M is singular.
pub(crate) fn raw_state(system: &SecondOrder) -> Option<DMatrix<f64>> {
    let n = system.order();
    let (mut state, _) = raw_pencil(system);
    let rows = system.m.clone().lu().solve(&state.rows(n, n))?;
    state.rows_mut(n, n).copy_from(&rows);
    Some(state)
}

/// A and B of the pencil A - lambda B of textbooks, `[0 I 0; -K -C F; 0 E -a]` and `diag(I, M, I)`.
pub(crate) fn raw_pencil(system: &SecondOrder) -> (DMatrix<f64>, DMatrix<f64>) {
    let (n, s) = (system.order(), system.states());
    let (mut a, mut b) = (DMatrix::zeros(2 * n + s, 2 * n + s), DMatrix::identity(2 * n + s, 2 * n + s));
    a.view_mut((0, n), (n, n)).fill_with_identity();
    a.view_mut((n, 0), (n, n)).copy_from(&-&system.k);
    a.view_mut((n, n), (n, n)).copy_from(&-&system.c);
    a.view_mut((n, 2 * n), (n, s)).copy_from(&system.internal.force);
    a.view_mut((2 * n, n), (s, n)).copy_from(&system.internal.drive);
    a.view_mut((2 * n, 2 * n), (s, s)).set_diagonal(&-&system.internal.decay);
    b.view_mut((n, n), (n, n)).copy_from(&system.m);
    (a, b)
}

pub(crate) fn by_schur(state: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let schur = Schur::try_new(state, f64::EPSILON, MOST_NALGEBRA_STEPS)?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}

/// Index in `found` that each of `wanted` is paired with. The nearest pairs are made first, and no index is used
/// twice.
pub(crate) fn nearest_pairs(wanted: &[Complex<f64>], found: &[Complex<f64>]) -> Vec<Option<usize>> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, w) in wanted.iter().enumerate() {
        pairs.extend(found.iter().enumerate().map(|(j, f)| ((f - w).norm(), i, j)));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut place, mut taken) = (vec![None; wanted.len()], vec![false; found.len()]);
    for (_, i, j) in pairs {
        if place[i].is_none() && !taken[j] {
            place[i] = Some(j);
            taken[j] = true;
        }
    }
    place
}

/// The relative error of each of `wanted` in the eigenvalues `found` by a route; infinite where none is left to be paired with.
pub fn relative_errors(wanted: &[Complex<f64>], found: &[Complex<f64>]) -> Vec<f64> {
    let places = nearest_pairs(wanted, found).into_iter().zip(wanted);
    places.map(|(at, w)| at.map_or(f64::INFINITY, |at| (found[at] - w).norm() / w.norm())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use linsys::Internal;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn every_route_solves_a_small_system_with_a_state() {
        let internal = Internal { decay: dvector![3.0], drive: dmatrix![2.0, 0.0], force: dmatrix![-5.0; 1.0] };
        let (m, c, k) = (dmatrix![1.5, 0.1; 0.1, 2.0], dmatrix![0.2, 0.0; 0.3, 0.1], dmatrix![7.0, -1.0; 2.0, 9.0]);
        let system = SecondOrder::with_internal(m, c, k, internal).unwrap();
        let all = routes();
        let first = (all[0].solve)(std::slice::from_ref(&system)).remove(0).unwrap();
        assert_eq!(first.len(), 5);
        for route in &all[1..] {
            let other = (route.solve)(std::slice::from_ref(&system)).remove(0).unwrap();
            assert!(relative_errors(&first, &other).iter().all(|&e| e < 1e-13), "{}", route.name);
        }
    }

    #[test]
    fn errors_pair_the_nearest_first_and_none_twice() {
        let c = |x: f64| Complex::from(x);
        assert_eq!(relative_errors(&[c(1.0), c(2.0)], &[c(2.0), c(1.5)]), [0.5, 0.0]);
        assert_eq!(relative_errors(&[c(1.0), c(2.0)], &[c(2.5)])[0], f64::INFINITY);
    }
}
