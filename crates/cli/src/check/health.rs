//! Check whether the model of a case is sound: its matrices, what makes them singular, and how well it is solved with.

use std::f64::consts::TAU;

use brakes::case::{FiniteElementCase, FixedDofs};
use brakes::frictionless;
use nalgebra::Complex;
use nalgebra_sparse::CscMatrix;
use output::hertz;
use sparse::SparseSecondOrder;
use sparse::health::{MatrixHealth, Signs, SolutionErrors, solution_errors};
use squeal::study::{Origin, Plan};

use super::Lines;
use crate::Error;

/// Largest asymmetry that is nothing but the rounding of an export; chosen.
const ROUNDING: f64 = 1e-12;
/// Largest relative error of a known solution with which a model is not called singular at a point; chosen.
const SINGULAR: f64 = 1e-3;
/// Most rows that are listed of a null vector; chosen: the largest tell where it is, and a line holds them.
const ROWS_LISTED: usize = 5;
/// Largest part of a null vector in a row, squared, that is not listed; chosen.
const LEAST_MOVED: f64 = 1e-6;
/// Points in the rectangle of growth and frequency at which the model is solved with, as fractions of its sides; chosen to be irregular.
const POINTS: [[f64; 2]; 5] = [[0.21, 0.08], [0.67, 0.31], [0.43, 0.52], [0.88, 0.74], [0.13, 0.93]];

/// The lines of a check on the model of a finite element case with a set of constraints.
///
/// # Errors
/// An operating point that cannot be computed, a factorisation that does not fit into memory.
pub(super) fn of_finite_elements(case: &FiniteElementCase, set: &FixedDofs) -> Result<Lines, Error> {
    let (dofs, system) = frictionless(case, &set.fixed)?;
    let model = Model {
        set: &set.name,
        name: &|row| case.dof_name(dofs.free()[row]),
        mass: moved_mass(case, dofs.free(), &system.m),
        rectangle: [case.reduction.growth, case.reduction.frequencies.map(|hz| TAU * hz)],
        region: "of the band".into(),
        system: &system,
    };
    model.lines()
}

/// The lines of a check on the models of a plan, each without the friction of its channels.
///
/// # Errors
/// As [`of_finite_elements`].
pub(super) fn of_plan(plan: &Plan) -> Result<Lines, Error> {
    let mut lines = Lines::default();
    for (set, Origin { brake, naming_point }) in plan.labels.constraints.iter().zip(&plan.origins) {
        let dense = brake.system.structure(&naming_point.coefficients)?;
        // The frequency at which mass and stiffness weigh the same.
        let scale = (dense.k.norm() / dense.m.norm()).sqrt();
        if !(scale.is_finite() && scale > 0.0) {
            continue;
        }
        let [m, c, k] = [&dense.m, &dense.c, &dense.k].map(CscMatrix::from);
        let system = SparseSecondOrder::new(m, c, k)?;
        let model = Model {
            set,
            name: &|row| plan.labels.dof(brake.dofs.free()[row]),
            mass: None,
            rectangle: [[-0.1 * scale, 0.1 * scale], [0.0, 2.0 * scale]],
            region: format!("up to {} Hz", hertz(2.0 * scale / TAU)),
            system: &system,
        };
        lines.extend(model.lines()?);
    }
    Ok(lines)
}

/// A model with a set of constraints.
struct Model<'a> {
    set: &'a str,
    /// The name of a row.
    name: &'a dyn Fn(usize) -> String,
    /// Mass that a translation moves, in words, where it is known.
    mass: Option<String>,
    /// Borders of Re lambda and Im lambda, rad/s, of the rectangle in which it is solved with.
    rectangle: [[f64; 2]; 2],
    /// Name of that rectangle in the lines of the check.
    region: String,
    system: &'a SparseSecondOrder,
}

impl Model<'_> {
    fn lines(&self) -> Result<Lines, Error> {
        let Self { set, name: name_of, mass, rectangle: [re, im], region, system } = self;
        let name = |row: &usize| name_of(*row);
        let mut lines = Lines::default();
        for (letter, matrix) in [("M", &system.m), ("C", &system.c), ("K", &system.k)] {
            let health = MatrixHealth::of(matrix)?;
            lines.add(&format!("{letter} {set}"), what_it_is(&health, matrix.nrows()));
            let rows = health.empty_rows.iter().map(name);
            if letter == "M" {
                mass.iter().for_each(|mass| lines.add("", mass));
            }
            // Damping may act on a few rows alone.
            if letter != "C" && !health.empty_rows.is_empty() {
                lines.add("", format!("WARNING: empty rows: {}", first(rows, health.empty_rows.len())));
            }
            let null = health.signs.map_or(0, |signs| signs.null);
            if letter != "C" && null > 0 {
                lines.add("", format!("WARNING: singular, by {}", null_rows(&health, null, name)));
            }
        }
        let within = |[from, to]: [f64; 2], part: f64| from + part * (to - from);
        let points = POINTS.map(|[x, y]| Complex::new(within(*re, x), within(*im, y)));
        lines.extend(solutions(&solution_errors(system, &points)?, region));
        Ok(lines)
    }
}

fn what_it_is(health: &MatrixHealth, order: usize) -> String {
    let symmetry = match health.asymmetry {
        0.0 => "symmetric".to_owned(),
        2.0 => "antisymmetric".to_owned(),
        small if small <= ROUNDING => format!("symmetric to {small:.0e} of its largest entry"),
        large => format!("unsymmetric by {large:.1e} of its largest entry"),
    };
    if health.entries == 0 {
        return "zero".to_owned();
    }
    let of = if health.asymmetry <= ROUNDING { "" } else { "symmetric part " };
    let signs = match health.signs {
        None => {
            return format!("{} entries, {symmetry}; signs unknown: a saddle point, as of multipliers", health.entries);
        }
        Some(Signs { negative: 0, positive, .. }) if positive == order => "positive definite".to_owned(),
        Some(Signs { negative: 0, positive, .. }) => format!("positive semidefinite, rank {positive} of {order}"),
        Some(Signs { negative, positive, .. }) => {
            format!("indefinite: {negative} negative, {positive} positive eigenvalues of {order}")
        }
    };
    format!("{} entries, {symmetry}, {of}{signs}; nearest to zero {:.1e} of its norm", health.entries, health.smallest)
}

/// Mass that a translation of all free rows in x, y or z moves, in words, of matrices with names of their rows.
fn moved_mass(case: &FiniteElementCase, free: &[usize], mass: &CscMatrix<f64>) -> Option<String> {
    let direction = |row: usize| case.dofs[free[row]].direction;
    let mut sums = [0.0; 3];
    for (row, _, value) in mass.triplet_iter().filter(|(row, column, _)| direction(*row) == direction(*column)) {
        if let Some(sum) = (direction(row) as usize).checked_sub(1).and_then(|axis| sums.get_mut(axis)) {
            *sum += value;
        }
    }
    if sums == [0.0; 3] {
        return None;
    }
    let [x, y, z] = sums;
    Some(format!("moved by a translation in x, y and z: {x:.4}, {y:.4} and {z:.4} {}", case.header.units.of("kg")))
}

/// Names in a line, the first of many.
fn first(names: impl Iterator<Item = String>, count: usize) -> String {
    let listed = names.take(ROWS_LISTED).collect::<Vec<_>>().join(", ");
    if count > ROWS_LISTED { format!("{listed} and {} more", count - ROWS_LISTED) } else { listed }
}

fn null_rows(health: &MatrixHealth, null: usize, name: impl Fn(&usize) -> String) -> String {
    if health.null_vectors == 0 {
        return format!("{} eigenvalues that are zero, whose vectors were not found", null);
    }
    let moved: Vec<_> = health.null_rows.iter().filter(|(_, part)| *part > LEAST_MOVED).collect();
    let squares: f64 = moved.iter().map(|(_, part)| part * part).sum();
    let spread = (health.null_vectors as f64).powi(2) / squares;
    let listed = first(moved.iter().map(|(row, _)| name(row)), moved.len());
    let found = if health.null_vectors < null { format!(", {} looked at", health.null_vectors) } else { String::new() };
    format!(
        "{} independent motions that it does not resist{found}, spread over some {spread:.0} rows, most of all {listed}",
        null
    )
}

fn solutions(errors: &[SolutionErrors], region: &str) -> Lines {
    let largest = |of: fn(&SolutionErrors) -> f64| {
        errors.iter().map(of).fold(0.0, |largest: f64, e| if e <= largest { largest } else { e })
    };
    let (backward, forward) = (largest(|e| e.backward), largest(|e| e.forward));
    let found = format!(
        "at {} points {region}: backward error up to {backward:.1e}, a known solution to {forward:.1e}",
        errors.len()
    );
    let mut lines = Lines::default();
    lines.add("solutions", found);
    if forward <= SINGULAR {
        return lines;
    }
    let at = errors.iter().max_by(|a, b| a.forward.total_cmp(&b.forward)).map_or(f64::NAN, |e| e.lambda.im / TAU);
    lines.add("", format!("WARNING: lambda^2 M + lambda C + K is singular to rounding near {at:.0} Hz"));
    lines
}
