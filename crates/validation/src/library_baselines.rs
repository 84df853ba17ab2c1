//! Baselines: eigenvalues of the textbook matrices by libraries, as a user would compute them in a script.
//!
//! The matrices are not scaled, the eigenvalues are not refined, and the sign of Re lambda is the verdict. LAPACK's `dgeev`
//! balances its matrix, `dggev` and nalgebra's Schur form do not.

use cea::Verdict;
use linsys::SecondOrder;
use num_complex::Complex;

use crate::problem::{ReferenceProblem, RouteOutcome};
#[cfg(feature = "lapack")]
use crate::routes::raw_pencil;
use crate::routes::{by_schur, raw_state};

/// A function of a library for all eigenvalues.
struct Library {
    name: &'static str,
    solve: fn(&SecondOrder) -> Option<Vec<Complex<f64>>>,
}

/// The libraries that are compiled in: LAPACK with the feature `lapack` only.
const LIBRARIES: &[Library] = &[
    Library { name: "nalgebra Schur", solve: |system| by_schur(raw_state(system)?) },
    #[cfg(feature = "lapack")]
    Library { name: "LAPACK dgeev", solve: |system| cea::dgeev(raw_state(system)?) },
    #[cfg(feature = "lapack")]
    Library {
        name: "LAPACK dggev",
        solve: |system| {
            let (a, b) = raw_pencil(system);
            cea::dggev(a, b)
        },
    },
];

/// Outcome of each library on this problem.
pub(crate) fn judge_libraries(problem: &ReferenceProblem) -> Vec<RouteOutcome> {
    let judge = |library: &Library| match (library.solve)(&problem.system) {
        Some(lambdas) => {
            let finite = lambdas.into_iter().filter(|l| l.re.is_finite() && l.im.is_finite());
            let found: Vec<_> = finite.map(|l| (l, Verdict::of(l, 0.0))).collect();
            RouteOutcome::Judged(problem.compare(library.name, &found))
        }
        None => {
            let reason = "M is singular, or no convergence".to_owned();
            RouteOutcome::Refused { case: problem.name.clone(), route: library.name, reason }
        }
    };
    LIBRARIES.iter().map(judge).collect()
}
