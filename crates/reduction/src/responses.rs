//! A basis for whatever happens in the contacts: for every friction in them, and for every arrangement of open and closed ones.
//!
//! Friction acts through the columns b_i of the channels and reads the r_i; a contact that opens takes a spring along its reading with
//! it. In all such changes of a system Q_0 at once
//!
//! ```text
//! Q_0(lambda) x = [b_1 .. b_m, r_1 .. r_m] c        for some c,
//! ```
//!
//! so that a mode is a combination of the *responses* `Q_0(lambda)^-1 b_i` and `Q_0(lambda)^-1 r_i`. These are analytic in lambda but for the
//! poles of Q_0, and a basis of those at a few frequencies holds those between them (rational interpolation: Antoulas, Approximation of
//! Large-Scale Dynamical Systems, SIAM 2005, chapter 11). What no channel touches, a coefficient of the structure for example, is not
//! covered.

use linsys::{ChannelGain, OperatingPoint};
use nalgebra::DMatrix;
use num_complex::Complex;
use sparse::product::times;
use sparse::{Problem, SparseAffineSystem, SparseSecondOrder};

use super::basis::{ROUNDING, directions, fewest};
use super::norms::{Norms, NormsAt};
use super::split;
use crate::ReductionError;

/// Frequencies of the first basis, equally spaced; chosen: a brake with two bodies needs no more.
const FIRST_FREQUENCIES: usize = 5;
/// Largest number of times that a frequency is added between each two; chosen: 65 frequencies.
const MOST_REFINEMENTS: usize = 4;

/// Goal of a basis of responses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponseGoal {
    /// Lowest and highest frequency, rad/s.
    pub frequencies: [f64; 2],
    /// Largest residual of a response at frequencies between those of the basis, relative as that of a mode.
    pub tolerance: f64,
    /// Most columns.
    pub most_columns: usize,
}

/// A basis of responses.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseBasis {
    /// V, n x k, orthonormal.
    pub basis: DMatrix<f64>,
    /// The frequencies whose responses it is made of, rad/s.
    pub frequencies: Vec<f64>,
    /// The largest residual of a response at the frequencies between them.
    pub residual: f64,
}

/// The fewest principal directions of the responses of a system without friction to forces along all b_i and r_i, with which the
/// responses at frequencies between have the residual asked for. Frequencies are added until they have, or until `most_columns` are
/// reached: [`ResponseBasis::residual`] tells. The system has the coefficients of each of the points, whose friction is left out.
///
/// # Errors
/// A system without channels, no point or one of another system, a frequency at which Q is singular.
pub fn response_basis(
    system: &SparseAffineSystem,
    points: &[OperatingPoint],
    goal: &ResponseGoal,
) -> Result<ResponseBasis, ReductionError> {
    for (option, count) in [("the number of contacts", system.channels().len()), ("the number of points", points.len())]
    {
        if count == 0 {
            return Err(ReductionError::Option { option, value: 0.0, allowed: "1 or more" });
        }
    }
    let (norms, forces) = (Norms::new(system), forces(system));
    let solver = |point: &OperatingPoint| {
        let quiet = OperatingPoint { channels: vec![ChannelGain::default(); point.channels.len()], ..point.clone() };
        let full = system.assemble(&quiet)?;
        Ok(Responses { problem: Problem::new(&full)?, norms: norms.at(&quiet), full, forces: &forces })
    };
    let solvers = points.iter().map(solver).collect::<Result<Vec<_>, ReductionError>>()?;
    let at = |omega: &f64| solvers.iter().map(|solver| solver.at(*omega)).collect::<Result<Vec<_>, _>>();
    let [from, to] = goal.frequencies;
    let between = |count: usize| (0..count).map(move |at| from + (to - from) * at as f64 / (count - 1) as f64);
    let mut frequencies: Vec<f64> = between(FIRST_FREQUENCIES).collect();
    let mut known = frequencies.iter().map(at).collect::<Result<Vec<_>, _>>()?;
    let empty = DMatrix::zeros(system.order(), 0);
    let mut refinements = 0;
    loop {
        let middles: Vec<f64> = frequencies.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let checks = middles.iter().map(at).collect::<Result<Vec<_>, _>>()?;
        let found = directions(&empty, side_by_side(known.iter().flatten()), ROUNDING)?;
        let error = |basis: &DMatrix<f64>| {
            checks
                .iter()
                .flat_map(|check| solvers.iter().zip(check))
                .map(|(solver, check)| solver.error(check, basis))
                .fold(0.0, f64::max)
        };
        let most = goal.most_columns.min(found.ncols());
        let residual = error(&found.columns(0, most).into_owned());
        if residual <= goal.tolerance || most < found.ncols() || refinements == MOST_REFINEMENTS {
            let basis = fewest(&empty, &found, most, goal.tolerance, error);
            return Ok(ResponseBasis { residual: error(&basis), basis, frequencies });
        }
        refinements += 1;
        let mut together: Vec<(f64, Vec<Response>)> =
            frequencies.into_iter().zip(known).chain(middles.into_iter().zip(checks)).collect();
        together.sort_by(|a, b| a.0.total_cmp(&b.0));
        (frequencies, known) = together.into_iter().unzip();
    }
}

/// Shapes that the contacts' forces make at one frequency.
struct Response {
    /// i omega, rad/s.
    lambda: Complex<f64>,
    /// `Q_0(lambda)^-1 f` of each force, of unit length, split.
    shapes: DMatrix<f64>,
}

/// The system without friction, ready to be solved.
struct Responses<'a> {
    problem: Problem,
    full: SparseSecondOrder,
    norms: NormsAt,
    /// b_i and r_i as columns.
    forces: &'a DMatrix<f64>,
}

impl Responses<'_> {
    fn at(&self, omega: f64) -> Result<Response, ReductionError> {
        let lambda = Complex::new(0.0, omega);
        let found = self.problem.solve(lambda, self.forces)?;
        let mut shapes = split::from_columns(&found);
        let count = found.ncols();
        for at in 0..count {
            let size = split::norm_squared(&shapes, at).sqrt();
            if size > 0.0 {
                shapes.column_mut(at).unscale_mut(size);
                shapes.column_mut(count + at).unscale_mut(size);
            }
        }
        Ok(Response { lambda, shapes })
    }

    /// The largest `|Q_0 (x - V V^T x)| / (|lambda|^2 |M| + |lambda| |C| + |K|)` of the responses x.
    fn error(&self, of: &Response, basis: &DMatrix<f64>) -> f64 {
        let missing = &of.shapes - basis * (basis.transpose() * &of.shapes);
        let [m, c, k] = [&self.full.m, &self.full.c, &self.full.k].map(|matrix| times(matrix, &missing));
        let count = split::count(&missing);
        let residual = |at: usize| {
            let [m, c, k] = [&m, &c, &k].map(|product| split::vector(product, at));
            (m * (of.lambda * of.lambda) + c * of.lambda + k).norm()
        };
        (0..count).map(residual).fold(0.0, f64::max) / self.norms.size(of.lambda)
    }
}

/// The columns b_i and r_i of all channels; one across the sliding reads nothing.
fn forces(system: &SparseAffineSystem) -> DMatrix<f64> {
    let sides = system.channels().iter().flat_map(|channel| [&channel.force, &channel.reading]);
    let sides: Vec<_> = sides.filter(|side| !side.is_empty()).collect();
    let mut forces = DMatrix::zeros(system.order(), sides.len());
    for (column, side) in sides.into_iter().enumerate() {
        side.iter().for_each(|&(row, value)| forces[(row, column)] += value);
    }
    forces
}

fn side_by_side<'a>(responses: impl Iterator<Item = &'a Response>) -> DMatrix<f64> {
    let columns: Vec<_> = responses.flat_map(|response| response.shapes.column_iter()).collect();
    if columns.is_empty() { DMatrix::zeros(0, 0) } else { DMatrix::from_columns(&columns) }
}
