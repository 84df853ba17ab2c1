//! A structure seen through the ports where friction acts: its response there as a sum over its own modes.
//!
//! ```text
//! R Q_0(lambda)^-1 B = sum_k (U_k lambda + V_k) / ((lambda - p_k)(lambda - conj p_k))
//! ```
//!
//! with the eigenvalues p_k of the structure, one of each conjugate pair, and real m x m matrices U_k and V_k: the motion of
//! mode k in the ports read by R under forces in the ports of B. A semisimple multiple eigenvalue has one summand for all its
//! vectors, `X (Y^T Q_0' X)^-1 Y^T` (Lancaster, Lambda-Matrices and Vibrating Systems, 1966, chapter 4).

use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::NoSecular;
use crate::{CeaError, EigenSolver, QrSolver, Workspace, right_vectors};

/// Largest relative distance between eigenvalues that count as one multiple eigenvalue; chosen, above the spread of a semisimple
/// multiple eigenvalue by rounding.
const MULTIPLE_SEPARATION: f64 = 1e-7;
/// A mode is uncontrollable where the largest force on it, `B^T y` relative to B, times what is read of it, the larger of `R x`
/// relative to R and `B^T x` relative to B, is less than this: to first order feedback moves its eigenvalue by
/// `y^T B (p R + lambda v B^T) x`. Chosen: below the error of the sums, [`LARGEST_ERROR`], and far above rounding, which makes
/// 1e-15 of nothing.
const UNCONTROLLABLE_PRODUCT: f64 = 1e-12;
/// Largest relative difference between the sums over modes and a factorisation of Q; chosen: with a larger one, a structure is left to spectra.
const LARGEST_ERROR: f64 = 1e-11;

/// Feedback forces on a structure: `Q(lambda) = Q_0(lambda) + B (p R + lambda v(lambda) B^T)`, with p and v(lambda) of a [`Gain`](super::Gain).
#[derive(Debug, Clone, PartialEq)]
pub struct Feedback {
    /// Directions B of the forces and of the velocities that the forces depend on, n x m.
    pub force: DMatrix<f64>,
    /// Displacements R that the forces depend on, m x n.
    pub reading: DMatrix<f64>,
}

/// The response of a structure at the ports of a [`Feedback`]. All its eigenvalues are in units of [`Resolvent::unit`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Resolvent {
    /// The unit, rad/s: the geometric mean of |lambda| over the modes of the structure.
    pub unit: f64,
    /// The p_k with Im > 0 of modes that feedback moves, multiple eigenvalues repeated.
    pub poles: Vec<Complex<f64>>,
    /// Eigenvalues with Im > 0 of uncontrollable modes: they do not move the ports, so no feedback moves their eigenvalues.
    pub uncontrollable: Vec<Complex<f64>>,
    /// Number m of ports.
    pub ports: usize,
    /// U_k and V_k of `R Q_0^-1 B`: the entries of the m x m matrix by rows, and for each entry its U_k and V_k at all poles.
    pub reading: Vec<[f64; 2]>,
    /// U_k and V_k of `unit B^T Q_0^-1 B`: in the same order, for the upper triangle of the m x m matrix by rows.
    pub mobility: Vec<[f64; 2]>,
    /// The modes, whose `shape drive^T / (lambda - pole)` and conjugates add up to `Q_0^-1 B`.
    modes: Vec<DrivenMode>,
}

/// A mode of the structure and its response to the forces.
#[derive(Debug, Clone, PartialEq)]
struct DrivenMode {
    pole: Complex<f64>,
    /// Length n.
    shape: DVector<Complex<f64>>,
    /// Amplitude of the mode per unit of each force, length m.
    drive: DVector<Complex<f64>>,
}

/// The norm of what a matrix reads of `shapes`, relative to its own.
fn motion(reading: &DMatrix<Complex<f64>>, shapes: &DMatrix<Complex<f64>>) -> f64 {
    let norm = reading.norm();
    if norm > 0.0 { (reading * shapes).norm() / norm } else { 0.0 }
}

impl Resolvent {
    /// The response as a sum over modes; or the reason why it is no such sum: overdamped modes, internal states, a structure that is
    /// not symmetric in the ports, or modes whose sum differs from the response.
    ///
    /// # Errors
    /// Errors of the eigenvalues and vectors; [`CeaError::Channels`] for a feedback of another order than the structure.
    pub fn new(
        structure: &SecondOrder,
        feedback: &Feedback,
        work: &mut Workspace,
    ) -> Result<Result<Self, NoSecular>, CeaError> {
        let (n, m) = (structure.order(), feedback.force.ncols());
        if feedback.force.nrows() != n || feedback.reading.shape() != (m, n) {
            return Err(CeaError::Channels { order: n, states: structure.states() });
        }
        if structure.states() > 0 {
            return Ok(Err(NoSecular::InternalStates { states: structure.states() }));
        }
        let lambdas: Vec<Complex<f64>> = QrSolver.eigenvalues(structure, work)?.oscillatory().collect();
        if lambdas.len() != n {
            return Ok(Err(NoSecular::Overdamped { oscillating: lambdas.len(), order: n }));
        }
        let unit = (lambdas.iter().map(|l| l.norm().ln()).sum::<f64>() / n as f64).exp();
        let right = right_vectors(structure, &lambdas, work)?;
        let left = right_vectors(&structure.transposed(), &lambdas, work)?;
        let [force, reading] = [&feedback.force, &feedback.reading].map(|matrix| matrix.map(Complex::from));
        let (mut uncontrollable, mut modes, mut controllable) =
            (Vec::new(), Vec::with_capacity(n), Vec::with_capacity(n));
        let mut first = 0;
        while first < n {
            let is_member =
                |l: &&Complex<f64>| (*l - lambdas[first]).norm() <= MULTIPLE_SEPARATION * lambdas[first].norm();
            let group = first..first + lambdas[first..].iter().take_while(is_member).count();
            let pole = lambdas[group.clone()].iter().sum::<Complex<f64>>() / group.len() as f64;
            let [x, y] = [&right, &left].map(|vectors| DMatrix::from_columns(&vectors[group.clone()]));
            let slope = y.transpose() * structure.dynamic_stiffness_derivative(pole) * &x;
            let Some(acted) = slope.lu().solve(&(y.transpose() * &force)) else {
                return Ok(Err(NoSecular::Defective { lambda: pole }));
            };
            for (shape, drive) in x.column_iter().zip(acted.row_iter()) {
                modes.push(DrivenMode { pole: pole / unit, shape: shape.into_owned(), drive: drive.transpose() });
            }
            // The SVD of a matrix without columns is undefined.
            let driven = if m == 0 { DVector::zeros(0) } else { (force.transpose() * &y).singular_values() };
            let read = motion(&reading, &x).max(motion(&force.transpose(), &x));
            let is_moved = |driven: &&f64| **driven * read > UNCONTROLLABLE_PRODUCT * force.norm();
            let reached = driven.iter().filter(is_moved).count();
            uncontrollable.extend(std::iter::repeat_n(pole / unit, group.len() - reached));
            let residue = &x * acted;
            controllable.extend((0..reached).map(|copy| (pole / unit, (copy == 0).then(|| residue.clone()))));
            first = group.end;
        }
        let mut resolvent = Self {
            unit,
            poles: controllable.iter().map(|(pole, _)| *pole).collect(),
            uncontrollable,
            ports: m,
            reading: vec![[0.0; 2]; m * m * controllable.len()],
            mobility: vec![[0.0; 2]; m * (m + 1) / 2 * controllable.len()],
            modes,
        };
        for (at, (_, residue)) in controllable.iter().enumerate() {
            if let Some(residue) = residue {
                resolvent.enter(at, &(&reading * residue), &(force.transpose() * residue));
            }
        }
        Ok(match resolvent.differs_at(structure, feedback) {
            Some(sigma) => Err(NoSecular::ResponseDiffers { lambda: sigma * unit }),
            None => Ok(resolvent),
        })
    }

    /// Enters the residues of the pole with index `at`.
    fn enter(&mut self, at: usize, reading: &DMatrix<Complex<f64>>, mobility: &DMatrix<Complex<f64>>) {
        let (n, m, unit, pole) = (self.poles.len(), self.ports, self.unit, self.poles[at]);
        // r / (l - p) + conj = (2 Re r l - 2 Re(r conj p)) / ((l - p)(l - conj p)).
        let real = |residue: Complex<f64>| [2.0 * residue.re, -2.0 * (residue * pole.conj()).re];
        let mut upper = 0;
        for i in 0..m {
            for j in 0..m {
                self.reading[(i * m + j) * n + at] = real(reading[(i, j)] / unit);
                if j >= i {
                    self.mobility[upper * n + at] = real(0.5 * (mobility[(i, j)] + mobility[(j, i)]));
                    upper += 1;
                }
            }
        }
    }

    /// The first of three points at which the sums differ from a factorisation of Q; `None` where they agree at all three.
    fn differs_at(&self, structure: &SecondOrder, feedback: &Feedback) -> Option<Complex<f64>> {
        let [force, reading] = [&feedback.force, &feedback.reading].map(|matrix| matrix.map(Complex::from));
        let is_right = |sigma: Complex<f64>| {
            let Some(response) = structure.dynamic_stiffness(sigma * self.unit).lu().solve(&force) else {
                return false;
            };
            let [by_modes, mobility] = self.at(sigma);
            let is_near = |a: DMatrix<Complex<f64>>, b: DMatrix<Complex<f64>>| {
                (&a - b).norm() <= LARGEST_ERROR * a.norm() || a.norm() < 1e-60
            };
            is_near(&reading * &response, by_modes)
                && is_near(force.transpose() * response * Complex::from(self.unit), mobility)
        };
        let places = [Complex::new(0.3, 0.0), Complex::new(0.1, 0.7), Complex::new(0.05, 1.4)];
        places.into_iter().find(|&sigma| !is_right(sigma))
    }

    /// `Q_0^-1 B w` at `sigma`, up to a factor.
    pub fn response(&self, sigma: Complex<f64>, w: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let mut response = DVector::zeros(self.modes.len());
        for DrivenMode { pole, shape, drive } in &self.modes {
            let [mut plain, mut conjugate] = [Complex::<f64>::default(); 2];
            for (d, w) in drive.iter().zip(w) {
                plain += d * w;
                conjugate += d.conj() * w;
            }
            let [plain, conjugate] = [plain / (sigma - pole), conjugate / (sigma - pole.conj())];
            // x a + conj(x) b = (a + b) re x + i (a - b) im x.
            let (re, im) = (plain + conjugate, plain - conjugate);
            for (entry, x) in response.iter_mut().zip(shape) {
                *entry += Complex::new(re.re * x.re - im.im * x.im, re.im * x.re + im.re * x.im);
            }
        }
        response
    }

    /// `R Q_0^-1 B` and `unit B^T Q_0^-1 B` at `sigma`, m x m.
    pub fn at(&self, sigma: Complex<f64>) -> [DMatrix<Complex<f64>>; 2] {
        let (n, m) = (self.poles.len(), self.ports);
        let sum = |entry: &[[f64; 2]]| -> Complex<f64> {
            let term = |(&[u, v], p): (&[f64; 2], &Complex<f64>)| (sigma * u + v) / ((sigma - p) * (sigma - p.conj()));
            entry.iter().zip(&self.poles).map(term).sum()
        };
        let upper = |i: usize, j: usize| i * m - i * (i + 1) / 2 + j;
        [
            DMatrix::from_fn(m, m, |i, j| sum(&self.reading[(i * m + j) * n..][..n])),
            DMatrix::from_fn(m, m, |i, j| sum(&self.mobility[upper(i.min(j), i.max(j)) * n..][..n])),
        ]
    }
}
