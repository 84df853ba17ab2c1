//! Rows, columns and time in units of the system's own.
//!
//! `Q~(sigma) = L Q(lambda) R` with `lambda = gamma sigma`, L and R diagonal: gamma makes the norms of mass and stiffness equal, L and R
//! bring the largest entry of each row and column of `gamma^2 |M| + gamma |C| + |K|` near one, as `cea::certified` does for dense
//! matrices. Every factor is a power of two, so that nothing is rounded.

use cea::Verdict;
use nalgebra::DVector;
use nalgebra_sparse::CscMatrix;
use num_complex::Complex;

use super::pencil::Pencil;
use super::polish::pair_of;
use super::types::{Circle, Count, Disc, Eigenpair, Found, Reach};
use crate::{SparseSecondOrder, State};

/// Number of rounds of choosing gamma and equilibrating in turn; the number of `cea::certified`.
const ROUNDS: usize = 5;
/// Most sweeps of Ruiz's iteration in each round; the number of `cea::certified`.
const SWEEPS: usize = 8;
/// Largest difference from 1 of the largest entry of any row or column with which no further sweep is made; chosen: factors are rounded to powers of two
/// anyway.
const EVEN: f64 = 0.02;
/// Largest ratio of two factors of rows, or of two of columns, with which a system is searched as it is; with a larger one the scaled system is. Chosen: a
/// million between two entries of a diagonal.
const UNEVEN: f64 = 1e3;

/// A system in units of its own.
pub(super) struct Scaled {
    pub(super) system: SparseSecondOrder,
    /// lambda = gamma sigma, rad/s.
    pub(super) gamma: f64,
    /// psi = L times a left vector of the scaled system, entry by entry.
    pub(super) left: Vec<f64>,
    /// phi = R times a right vector of it.
    pub(super) right: Vec<f64>,
}

impl Scaled {
    pub(super) fn new(system: &SparseSecondOrder) -> Self {
        let n = system.order();
        let (mut left, mut right) = (vec![1.0; n], vec![1.0; n]);
        let mut gamma = time_scale(system, &left, &right);
        for _ in 0..ROUNDS {
            equilibrate(system, gamma, &mut left, &mut right);
            gamma = time_scale(system, &left, &right);
        }
        let gamma = power_of_two(gamma);
        left.iter_mut().chain(&mut right).for_each(|factor| *factor = power_of_two(*factor));
        let scaled = |a: &CscMatrix<f64>, time: f64| {
            let mut a = a.clone();
            a.triplet_iter_mut().for_each(|(row, column, value)| *value *= left[row] * right[column] * time);
            a
        };
        let side = |side: &[(usize, f64)], factors: &[f64]| -> Vec<(usize, f64)> {
            side.iter().map(|&(dof, value)| (dof, value * factors[dof])).collect()
        };
        let state = |state: &State| State {
            decay: state.decay / gamma,
            drive: side(&state.drive, &right),
            force: side(&state.force, &left),
        };
        let states = system.states.iter().map(state).collect();
        let (m, c, k) = (scaled(&system.m, gamma * gamma), scaled(&system.c, gamma), scaled(&system.k, 1.0));
        let h = system.h.as_ref().map(|h| scaled(h, 1.0));
        Self { system: SparseSecondOrder { m, c, k, h, states }, gamma, left, right }
    }

    /// True if rows or columns are so different that a search needs the scaling. A system that needs none is searched as it is, so that its results keep
    /// their bits.
    pub(super) fn is_uneven(&self) -> bool {
        let is_uneven = |factors: &[f64]| {
            let (least, most) =
                factors.iter().fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), &f| (a.min(f), b.max(f)));
            most > UNEVEN * least
        };
        is_uneven(&self.left) || is_uneven(&self.right)
    }

    /// Results of the scaled system in the units of the one given.
    pub(super) fn in_given_units(&self, found: Found, given: &SparseSecondOrder) -> Found {
        let (pencil, gamma) = (Pencil::new(given), self.gamma);
        let pair = |pair: Eigenpair| {
            let lambda = pair.lambda * gamma;
            let turned = |vector: &DVector<Complex<f64>>, factors: &[f64]| {
                DVector::from_iterator(factors.len(), vector.iter().zip(factors).map(|(z, factor)| z * factor))
            };
            let (right, left) = (turned(&pair.right, &self.right), turned(&pair.left, &self.left));
            let own = pair_of(&pencil, lambda, &right, &left.conjugate());
            let verdict = match pair.verdict {
                Verdict::Marginal { tolerance } => Verdict::Marginal { tolerance: tolerance * gamma },
                Verdict::Undecided { bound } => Verdict::Undecided { bound: bound * gamma },
                decided => decided,
            };
            let bound = pair.bound * gamma;
            Eigenpair { bound, verdict, on_border: pair.on_border, ..own }
        };
        let disc = |disc: Disc| Disc { centre: disc.centre * gamma, radius: disc.radius * gamma, ..disc };
        let circle = |circle: Circle| Circle { centre: circle.centre * gamma, radius: circle.radius * gamma, ..circle };
        let count = match found.count {
            Count::Argument { circles, points } => {
                Count::Argument { circles: circles.into_iter().map(circle).collect(), points }
            }
            other => other,
        };
        let reach = |reach: Reach| Reach { modulus: reach.modulus * gamma, real: reach.real * gamma };
        Found {
            pairs: found.pairs.into_iter().map(pair).collect(),
            discs: found.discs.into_iter().map(disc).collect(),
            reach: found.reach.map(reach),
            count,
            ..found
        }
    }
}

/// The power of two next to x, within the range that keeps products finite.
fn power_of_two(x: f64) -> f64 {
    if x > 0.0 && x.is_finite() { x.log2().round().clamp(-500.0, 500.0).exp2() } else { 1.0 }
}

/// sqrt(|K| / |M|), or what the damping says where one of them vanishes.
fn time_scale(system: &SparseSecondOrder, left: &[f64], right: &[f64]) -> f64 {
    let norm = |a: &CscMatrix<f64>| {
        let entry = |(row, column, value): (usize, usize, &f64)| (value * left[row] * right[column]).abs();
        let largest = a.triplet_iter().map(entry).fold(0.0, f64::max);
        let squares: f64 = a.triplet_iter().map(|at| (entry(at) / largest).powi(2)).sum();
        if largest > 0.0 { largest * squares.sqrt() } else { 0.0 }
    };
    let (m, c, k) = (norm(&system.m), norm(&system.c), norm(&system.k));
    match (m > 0.0, c > 0.0, k > 0.0) {
        (true, _, true) => (k / m).sqrt(),
        (true, true, false) => c / m,
        (false, true, true) => k / c,
        _ => 1.0,
    }
}

fn equilibrate(system: &SparseSecondOrder, gamma: f64, left: &mut [f64], right: &mut [f64]) {
    let matrices = [(&system.m, gamma * gamma), (&system.c, gamma), (&system.k, 1.0)];
    for _ in 0..SWEEPS {
        let (mut rows, mut columns) = (vec![0.0_f64; left.len()], vec![0.0_f64; right.len()]);
        let mut see = |row: usize, column: usize, value: f64| {
            let size = (left[row] * value * right[column]).abs();
            rows[row] = rows[row].max(size);
            columns[column] = columns[column].max(size);
        };
        for (matrix, factor) in matrices.into_iter().chain(system.h.as_ref().map(|h| (h, 1.0))) {
            matrix.triplet_iter().for_each(|(row, column, value)| see(row, column, value * factor));
        }
        for state in &system.states {
            for &(row, f) in &state.force {
                state.drive.iter().for_each(|&(column, e)| see(row, column, f * e));
            }
        }
        let sides = [(&mut *left, rows), (&mut *right, columns)];
        let mut is_even = true;
        for (factors, largest) in sides {
            for (factor, size) in factors.iter_mut().zip(largest).filter(|(_, size)| *size > 0.0) {
                *factor /= size.sqrt();
                is_even &= (size - 1.0).abs() <= EVEN;
            }
        }
        if is_even {
            break;
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    #[test]
    fn units_do_not_matter_and_nothing_is_rounded() {
        let matrix = |values: [f64; 4]| DMatrix::from_row_slice(2, 2, &values);
        let (m, c, k) = (matrix([2.0, 0.1, 0.1, 3.0]), matrix([0.3, 0.1, 0.0, 0.2]), matrix([4e6, -3e6, 3e6, 7e6]));
        let units = DMatrix::from_diagonal(&vec![2f64.powi(-40), 2f64.powi(25)].into());
        let system = |f: &dyn Fn(&DMatrix<f64>) -> DMatrix<f64>| {
            let [m, c, k] = [&m, &c, &k].map(|a| CscMatrix::from(&f(a)));
            SparseSecondOrder::new(m, c, k).unwrap()
        };
        let (si, other) = (Scaled::new(&system(&DMatrix::clone)), Scaled::new(&system(&|a| &units * a * &units)));
        assert_eq!((&si.system, si.gamma), (&other.system, other.gamma));
        let back = |row: usize, column: usize| {
            let k = DMatrix::from(&si.system.k);
            k[(row, column)] / si.left[row] / si.right[column]
        };
        assert!((0..4).all(|at| back(at / 2, at % 2) == k[(at / 2, at % 2)]));
    }
}
