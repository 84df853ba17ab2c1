//! The modes that cross the threshold, with their shapes.

use cea::{EigenSolver, Workspace, right_vector};
use montecarlo::Progress;
use nalgebra::DVector;
use num_complex::Complex;
use study::{Study, UncertainBrake};

use super::family::Family;
use super::parameter::Over;
use super::{BoundaryCurve, Found, SweepOnset};
use crate::Error;

/// A mode where it crosses the threshold: of the axis, where it neither grows nor decays.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryMode {
    /// Candidates for the name of the mode; "divergence".
    pub mode: String,
    /// Values of the swept parameters.
    pub at: Vec<f64>,
    /// Words for what the mode does there, of one parameter.
    pub does: Option<&'static str>,
    /// Eigenvalue, rad/s, of the brake as it is swept: of a reduced one next to the threshold.
    pub lambda: Complex<f64>,
    /// Right eigenvector over the free degrees of freedom of the scene, of unit norm.
    pub shape: DVector<Complex<f64>>,
}

/// The mode of each onset, or of each boundary curve at its middle point; a spectrum for each.
///
/// # Errors
/// Those of the brake and of the solver.
pub fn boundary_modes<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &[Over],
    solver: &dyn EigenSolver,
    found: &Found,
    progress: &dyn Progress,
) -> Result<Vec<BoundaryMode>, Error> {
    let family = Family::new(study, scene, over, solver, progress)?;
    let (threshold, mut work) = (study.plan().threshold, Workspace::default());
    let mut mode = |mode: &str,
                    at: Vec<f64>,
                    there: Complex<f64>,
                    does: Option<&'static str>|
     -> Result<BoundaryMode, Error> {
        let system = family.system(&at)?;
        let eigenvalues = family.solver.eigenvalues(&system, &mut work)?.eigenvalues;
        let distance = |lambda: &Complex<f64>| (lambda - there).norm();
        let nearest = eigenvalues.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let lambda = nearest.unwrap_or(there);
        progress.advance(1);
        Ok(BoundaryMode { mode: mode.to_owned(), at, does, lambda, shape: right_vector(&system, lambda, &mut work)? })
    };
    progress.begin(
        match found {
            Found::Branches(sweep) => sweep.onsets.len(),
            Found::Map(map) => map.curves.len(),
        } as u64,
        0,
    );
    let modes = match found {
        Found::Branches(sweep) => {
            let of_onset = |onset: &SweepOnset| {
                let there = Complex::new(onset.growth, onset.omega);
                mode(&onset.mode, vec![onset.at], there, Some(onset.event(&threshold)))
            };
            sweep.onsets.iter().map(of_onset).collect()
        }
        Found::Map(map) => {
            let of_curve = |BoundaryCurve { mode: name, points, .. }: &BoundaryCurve| {
                let middle = points.get(points.len() / 2)?;
                Some(mode(name, middle.at.to_vec(), Complex::new(middle.growth, middle.omega), None))
            };
            map.curves.iter().filter_map(of_curve).collect()
        }
    };
    progress.end();
    modes
}
