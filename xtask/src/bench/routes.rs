//! The routes written in Rust: those of this project, and library baselines behind features.

use validation::SolverRoute;

/// The routes of this project, nalgebra, and LAPACK and faer where they are built in.
pub fn routes() -> Vec<SolverRoute> {
    let baselines: &[SolverRoute] = &[
        #[cfg(feature = "lapack")]
        SolverRoute { name: DGEEV_ROUTE_NAME, solve: baselines::dgeev },
        #[cfg(feature = "faer")]
        SolverRoute { name: "faer, scaled", solve: baselines::faer },
    ];
    validation::routes().into_iter().chain(baselines.iter().copied()).collect()
}

/// Name of the route with which the others are compared.
pub const DGEEV_ROUTE_NAME: &str = "LAPACK dgeev, scaled";

#[cfg(any(feature = "lapack", feature = "faer"))]
mod baselines {
    use squeal::linsys::SecondOrder;
    use validation::Spectra;

    /// OpenBLAS's dgeev without vectors on the scaled standard form.
    #[cfg(feature = "lapack")]
    pub fn dgeev(systems: &[SecondOrder]) -> Spectra {
        use cea::{EigenSolver, LapackSolver, Workspace};
        let mut work = Workspace::default();
        systems.iter().map(|system| Some(LapackSolver.eigenvalues(system, &mut work).ok()?.eigenvalues)).collect()
    }

    /// faer's eigenvalues without vectors of the scaled standard form; built without rayon, it runs on this thread.
    #[cfg(feature = "faer")]
    pub fn faer(systems: &[SecondOrder]) -> Spectra {
        let one = |system: &SecondOrder| {
            let form = cea::StandardForm::new(system).ok()?;
            let order = form.state.nrows();
            let state = faer::MatRef::from_column_major_slice(form.state.as_slice(), order, order);
            Some(state.eigenvalues().ok()?.into_iter().map(|sigma| sigma * form.gamma).collect())
        };
        systems.iter().map(one).collect()
    }
}
