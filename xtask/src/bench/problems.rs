//! The problems of the bench: lattices of the paper's kind in several sizes, with drawn friction, and refined eigenvalues.

use brakes::Error;
use brakes::case::{LatticeCase, Law};
use cea::{EigenSolver, QrSolver, Workspace};
use num_complex::Complex;
use validation::{ValidationError, refine_all};

use brakes::{LatticeSample, sliding};
use squeal::linsys::SecondOrder;
use squeal::montecarlo::stream;
use squeal::osc_model::{ContactArrangement, Dof, Grid, LatticeModel, LatticeParameters};
use squeal::study::ANCHORS_PER_SCENE;

use super::secular::SecularRoute;

/// Size of problem: a lattice with every oscillator in contact. It has 3 (rows x columns) + 3 degrees of freedom, less those held.
pub struct Size {
    rows: usize,
    columns: usize,
    /// Constrained degrees of freedom, by which n gets the value wanted.
    held: &'static [&'static str],
    law: Law,
    /// Number of draws solved in one round; chosen: whole batches, and enough of them to be timed.
    draws: u64,
    /// Number of draws whose eigenvalues are refined.
    refined: usize,
}

const fn coulomb(rows: usize, columns: usize, held: &'static [&'static str], draws: u64, refined: usize) -> Size {
    Size { rows, columns, held, law: Law::AmontonsCoulomb, draws, refined }
}

/// n = 10, 30, 30 with nine bristles, 60 and 100.
pub const SIZES: [Size; 5] = [
    coulomb(1, 3, &["x1", "x3"], 256, 16),
    coulomb(3, 3, &[], 64, 16),
    Size { law: Law::LuGre, ..coulomb(3, 3, &[], 32, 16) },
    coulomb(4, 5, &["x1", "x5", "x16"], 16, 4),
    coulomb(3, 11, &["x1", "x11"], 8, 2),
];

/// Draws of one size.
pub struct Problem {
    /// Description of the lattice and the law.
    pub description: String,
    /// Degrees of freedom.
    pub n: usize,
    /// Internal states.
    pub states: usize,
    /// Systems, one per draw.
    pub systems: Vec<SecondOrder>,
    /// Eigenvalues of the first systems, all of each, refined in double-double, rad/s.
    pub references: Vec<Vec<Complex<f64>>>,
    /// Route by the secular equation for the same draws; `None` where it cannot be taken.
    pub growing: Option<SecularRoute>,
}

impl Problem {
    /// The draws of one size; with `few`, one batch of eight draws and one reference.
    ///
    /// # Errors
    /// Those of the model and of the refinement.
    pub fn new(case: &LatticeCase, size: &Size, few: bool) -> Result<Self, ValidationError> {
        let Size { rows, columns, held, law, .. } = *size;
        let (draws, refined) = if few { (8, 1) } else { (size.draws, size.refined) };
        let grid = Grid::new(rows, columns).map_err(Error::from)?;
        let fixed = held.iter().map(|name| name.parse::<Dof>()).collect::<Result<Vec<_>, _>>().map_err(Error::from)?;
        let model = LatticeModel::new(resized(&case.lattice, grid), case.readings.lateral, &fixed);
        let full = ContactArrangement::full(grid.oscillators());
        let lattice = model.and_then(|model| model.prepare(&full)).map_err(Error::from)?;
        let state = |i: u64| {
            let sample = LatticeSample::draw(case, &mut stream(case.header.seed, i)).map_err(Error::from)?;
            let speed = case.speeds[0].quantile(sample.speed_quantile);
            sliding(case, &lattice, law, speed, &sample)
        };
        let states = (0..draws).map(state).collect::<Result<Vec<_>, Error>>()?;
        let anchors = (draws..).take(ANCHORS_PER_SCENE).map(state).collect::<Result<Vec<_>, Error>>()?;
        let systems = states.iter().map(|state| lattice.linearised(state)).collect::<Result<Vec<_>, _>>();
        let systems = systems.map_err(Error::from)?;
        let references = systems.iter().take(refined).map(reference).collect::<Result<_, _>>()?;
        let held = if held.is_empty() { String::new() } else { format!(" with {} held", held.join(" ")) };
        Ok(Self {
            description: format!("{rows} x {columns} oscillators{held}, {}", law.title()),
            n: systems[0].order(),
            states: systems[0].states(),
            systems,
            references,
            growing: SecularRoute::new(&lattice, &anchors, &states)?,
        })
    }
}

/// Eigenvalues of a system, all of them, refined in double-double, rad/s.
fn reference(system: &SecondOrder) -> Result<Vec<Complex<f64>>, ValidationError> {
    let mut found = QrSolver.eigenvalues(system, &mut Workspace::default())?.eigenvalues;
    let mut exact = Vec::new();
    // Where the static coefficient equals the kinetic one, no velocity drives the bristles, and their eigenvalues are not compared.
    if system.states() > 0 && system.internal.drive.amax() == 0.0 {
        found.retain(|lambda| lambda.im != 0.0);
        exact.extend(system.internal.decay.iter().map(|&decay| Complex::from(-decay)));
    }
    Ok(refine_all(system, &found)?.into_iter().map(|refined| refined.lambda).chain(exact).collect())
}

/// A lattice with the rows and columns of `grid`, made of the same springs, dashpots and masses.
fn resized(lattice: &LatticeParameters, grid: Grid) -> LatticeParameters {
    // A chain begins at a wall; its second spring is an inner one.
    let x = |list: &[f64]| grid.x_chains(list[0], list[1]);
    let y = |list: &[f64]| grid.y_chains(list[0], list[1]);
    let each = |list: &[f64]| vec![list[0]; grid.oscillators()];
    LatticeParameters {
        grid,
        x_stiffness: x(&lattice.x_stiffness),
        y_stiffness: y(&lattice.y_stiffness),
        x_damping: x(&lattice.x_damping),
        y_damping: y(&lattice.y_damping),
        z_damping: each(&lattice.z_damping),
        inclined_stiffness: each(&lattice.inclined_stiffness),
        contact_stiffness: each(&lattice.contact_stiffness),
        oscillator_mass: each(&lattice.oscillator_mass),
        ..*lattice
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sizes_are_those_promised_and_the_paper_s_own_lattice_comes_out_unchanged() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let case = LatticeCase::read(&root.join("cases/paper.toml")).unwrap();
        assert_eq!(resized(&case.lattice, case.lattice.grid), case.lattice);
        let problems: Vec<_> = SIZES.iter().map(|size| Problem::new(&case, size, false).unwrap()).collect();
        let sizes: Vec<_> = problems.iter().map(|p| (p.n, p.states)).collect();
        assert_eq!(sizes, [(10, 0), (30, 0), (30, 9), (60, 0), (100, 0)]);
        for problem in &problems {
            assert!(problem.references.iter().all(|r| r.len() == 2 * problem.n + problem.states));
            assert!(problem.systems.iter().all(|s| s.k != s.k.transpose()), "friction makes K unsymmetric");
            // The trace is a reference that depends on no iteration.
            for (system, reference) in problem.systems.iter().zip(&problem.references) {
                let sum: Complex<f64> = reference.iter().sum();
                let damping: f64 = (0..problem.n).map(|i| system.c[(i, i)] / system.m[(i, i)]).sum();
                let trace = -damping - system.internal.decay.sum();
                assert!((sum - trace).norm() < 1e-13 * trace.abs(), "{sum} {trace}");
            }
        }
    }
}
