//! Linear complementarity problems: `w = q + M z` with `w >= 0`, `z >= 0`, `w^T z = 0`.

use nalgebra::{DMatrix, DVector};

use crate::ContactError;
use crate::sliding::value;

/// Largest entry of a tableau that is nothing but rounding; chosen: problems here are scaled to about 1.
const PIVOT: f64 = 1e-11;
/// Tolerance of z and of w below zero, as a fraction of the largest; chosen, above rounding of the last solution.
const NEGATIVE: f64 = 1e-10;
/// Largest solution of a regular matrix, as a multiple of what matrix and right-hand side ask for; chosen: a million times what
/// gaps of contacts are.
const SINGULAR: f64 = 1e10;
/// Most steps of a search for each unknown; chosen, far more than were ever needed.
const STEPS: usize = 50;
/// Largest difference of two solutions that are one, relative to the largest |q|; chosen: with less, rounding of one solution makes two of it; with more, two
/// that are near each other are one.
const ALIKE: f64 = 1e-8;

/// Most unknowns of which all 2^n sets of zeros are looked at; chosen: 2 million eliminations of a row.
pub const MOST_ENUMERATED: usize = 14;

/// Solution of a complementarity problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Complementary {
    /// Vector z, the first of each pair of which one is 0.
    pub z: DVector<f64>,
    /// Vector w = q + M z, the second of each pair of which one is 0.
    pub w: DVector<f64>,
}

/// Reason why no solution was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unsolved {
    /// The path of Lemke's method ends in a ray: where M has a semi-definite symmetric part there is no solution, else it may have missed one.
    Ray,
    /// The path lost so many digits that it did not end, or that what it ends with is no solution.
    Steps,
}

/// Most changes of the set of zeros before another method is tried; chosen: it takes less than ten where it ends at all.
const CHANGES: usize = 40;

/// Solves a problem by changing the set of zeros until it is right: a z that comes out below 0 becomes 0, a w that does so its z free (the primal-dual
/// active set method). `None` where that does not end, or comes to equations that are singular; for the matrices of contacts it ends nearly always. What it
/// finds is a solution whatever the matrix.
#[must_use]
pub fn active_set(q: &DVector<f64>, m: &DMatrix<f64>) -> Option<Complementary> {
    let mut opened: Vec<bool> = q.iter().map(|&q| q < 0.0).collect();
    for _ in 0..CHANGES {
        let (z, w) = with_zeros(q, m, &opened)?;
        // Each is compared with the largest of its own kind, as one of each pair is 0.
        let (of_z, of_w) = tolerances(q, &z, &w);
        let next: Vec<bool> = (0..q.len()).map(|at| if opened[at] { z[at] > -of_z } else { w[at] < -of_w }).collect();
        if next == opened {
            return solved(q, m, &opened);
        }
        opened = next;
    }
    None
}

/// Solves a problem by Lemke's method. The set of zeros that its path ends with is solved anew, so that rounding on the way does not matter.
///
/// # Errors
/// No solution at the end of the path.
///
/// ```
/// use contact::complementarity::lemke;
/// use contact::nalgebra::{dmatrix, dvector};
/// let found = lemke(&dvector![-1.0, 2.0], &dmatrix![2.0, 1.0; 1.0, 2.0]).ok();
/// assert!(found.is_some_and(|found| (found.z - dvector![0.5, 0.0]).amax() < 1e-15));
/// ```
pub fn lemke(q: &DVector<f64>, m: &DMatrix<f64>) -> Result<Complementary, Unsolved> {
    match lemke_by(Ties::LargestPivot, q, m) {
        Err(Unsolved::Steps) => lemke_by(Ties::Lexicographic, q, m),
        ended => ended,
    }
}

/// Choice among variables that reach zero together.
#[derive(Clone, Copy, PartialEq)]
enum Ties {
    /// Variable with the largest pivot: the fewest digits are lost, but the path may come back to where it was.
    LargestPivot,
    /// Variable whose row of the inverse of the basis, over its pivot, is the least in lexicographic order: no basis comes twice (Cottle, Pang and Stone, The Linear
    /// Complementarity Problem, 4.9), so that the path ends, also of the degenerate problems of contacts that are alike.
    Lexicographic,
}

/// Lemke's method with a choice among ties.
fn lemke_by(ties: Ties, q: &DVector<f64>, m: &DMatrix<f64>) -> Result<Complementary, Unsolved> {
    let n = q.len();
    let scale = q.amax();
    if q.iter().all(|&q| q >= 0.0) {
        return Ok(Complementary { z: DVector::zeros(n), w: q.clone() });
    }
    // Columns: w, z, the covering variable, the right-hand side of `w - M z - e z0 = q`.
    let (cover, right) = (2 * n, 2 * n + 1);
    let mut tableau = DMatrix::zeros(n, 2 * n + 2);
    for row in 0..n {
        tableau[(row, row)] = 1.0;
        (0..n).for_each(|column| tableau[(row, n + column)] = -m[(row, column)]);
        tableau[(row, cover)] = -1.0;
        tableau[(row, right)] = q[row] / scale;
    }
    let mut basis: Vec<usize> = (0..n).collect();
    let least = tableau.column(right).min();
    let mut lowest = (0..n).filter(|&row| tableau[(row, right)] == least);
    // Of equal ones the last has the least row of the inverse, which is the identity here.
    let first = if ties == Ties::Lexicographic { lowest.next_back() } else { lowest.next() };
    let (mut row, mut entering) = (first.unwrap_or_default(), cover);
    for _ in 0..STEPS * (n + 2) {
        eliminate(&mut tableau, row, entering);
        let leaving = std::mem::replace(&mut basis[row], entering);
        if leaving == cover {
            let opened: Vec<bool> = (0..n).map(|at| basis.contains(&(n + at))).collect();
            return solved(q, m, &opened).ok_or(Unsolved::Steps);
        }
        entering = if leaving < n { leaving + n } else { leaving - n };
        row = leaving_row(&tableau, entering, &basis, (cover, ties)).ok_or(Unsolved::Ray)?;
    }
    Err(Unsolved::Steps)
}

/// The row whose variable reaches zero first; of several the covering variable, else one by the rule for ties.
fn leaving_row(
    tableau: &DMatrix<f64>,
    entering: usize,
    basis: &[usize],
    (cover, ties): (usize, Ties),
) -> Option<usize> {
    let right = tableau.ncols() - 1;
    let rows = (0..tableau.nrows()).filter(|&row| tableau[(row, entering)] > PIVOT);
    let ratio = |row: usize| tableau[(row, right)].max(0.0) / tableau[(row, entering)];
    let least = rows.clone().map(ratio).fold(f64::INFINITY, f64::min);
    let first = rows.filter(|&row| ratio(row) <= least + PIVOT * (1.0 + least));
    if ties == Ties::Lexicographic {
        let mut tied: Vec<usize> = first.collect();
        if let Some(&row) = tied.iter().find(|&&row| basis[row] == cover) {
            return Some(row);
        }
        // The columns of w are the inverse of the basis.
        for column in 0..tableau.nrows() {
            let part = |row: &usize| tableau[(*row, column)] / tableau[(*row, entering)];
            let least = tied.iter().map(part).fold(f64::INFINITY, f64::min);
            tied.retain(|row| part(row) <= least + NEGATIVE * (1.0 + least.abs()));
        }
        return tied.first().copied();
    }
    first.max_by(|&a, &b| {
        let rank = |row: usize| (basis[row] == cover, tableau[(row, entering)]);
        rank(a).0.cmp(&rank(b).0).then(rank(a).1.total_cmp(&rank(b).1))
    })
}

fn eliminate(tableau: &mut DMatrix<f64>, row: usize, column: usize) {
    let pivot = tableau[(row, column)];
    tableau.row_mut(row).iter_mut().for_each(|entry| *entry /= pivot);
    let line = tableau.row(row).clone_owned();
    let factors = tableau.column(column).clone_owned();
    for (at, &entry) in line.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
        let mut own = tableau.column_mut(at);
        (0..factors.len()).filter(|&other| other != row).for_each(|other| own[other] -= factors[other] * entry);
    }
}

/// Vectors z and w with z free and w = 0 where `opened` is true, and z = 0 elsewhere; `None` where the equations are singular.
fn with_zeros(q: &DVector<f64>, m: &DMatrix<f64>, opened: &[bool]) -> Option<(DVector<f64>, DVector<f64>)> {
    let places: Vec<usize> = (0..q.len()).filter(|&at| opened[at]).collect();
    let mut z = DVector::zeros(q.len());
    let mut w = q.clone();
    if !places.is_empty() {
        let columns = m.select_columns(&places);
        let found = columns.select_rows(&places).lu().solve(&-q.select_rows(&places))?;
        let is_bounded = found.amax() * m.amax() < SINGULAR * q.amax();
        if !is_bounded {
            return None;
        }
        places.iter().zip(found.iter()).for_each(|(&at, &value)| z[at] = value);
        w += columns * found;
    }
    places.iter().for_each(|&at| w[at] = 0.0);
    Some((z, w))
}

/// Tolerances of z and of w: how far below zero each may be to count as zero, absolute.
fn tolerances(q: &DVector<f64>, z: &DVector<f64>, w: &DVector<f64>) -> (f64, f64) {
    (NEGATIVE * z.amax(), NEGATIVE * (q.amax() + w.amax()))
}

/// The solution with z free where `opened` is true; `None` where z or w then comes out below 0.
fn solved(q: &DVector<f64>, m: &DMatrix<f64>, opened: &[bool]) -> Option<Complementary> {
    let (z, w) = with_zeros(q, m, opened)?;
    let (of_z, of_w) = tolerances(q, &z, &w);
    let is_one = z.iter().all(|&z| z.is_finite() && z >= -of_z) && w.iter().all(|&w| w.is_finite() && w >= -of_w);
    is_one.then(|| Complementary { z: z.map(|z| z.max(0.0)), w: w.map(|w| w.max(0.0)) })
}

/// Solutions w and z, all of them, from the 2^n sets of zeros; solutions that differ in z alone count as one. Sets whose equations are singular are
/// passed over.
///
/// # Errors
/// [`ContactError::Value`] for more than [`MOST_ENUMERATED`] unknowns.
pub fn all_solutions(q: &DVector<f64>, m: &DMatrix<f64>) -> Result<Vec<Complementary>, ContactError> {
    if q.len() > MOST_ENUMERATED {
        return Err(value("the number of unknowns", q.len() as f64, "at most 14, whose sets are all looked at"));
    }
    let mut found: Vec<Complementary> = Vec::new();
    for set in 0_u64..1 << q.len() {
        let opened: Vec<bool> = (0..q.len()).map(|at| set >> at & 1 == 1).collect();
        if let Some(next) = solved(q, m, &opened) {
            let is_known = |known: &Complementary| (&known.w - &next.w).amax() <= ALIKE * q.amax();
            if !found.iter().any(is_known) {
                found.push(next);
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};
    use proptest::prelude::*;

    #[test]
    fn a_ray_is_told_from_a_solution() {
        assert_eq!(lemke(&dvector![-1.0], &dmatrix![0.0]), Err(Unsolved::Ray));
        assert_eq!(lemke(&dvector![-1.0, -2.0], &dmatrix![1.0, -1.0; -1.0, 1.0]), Err(Unsolved::Ray));
        // No P-matrix: two solutions, of which the path finds one.
        let (q, m) = (dvector![1.0, -1.0], dmatrix![1.0, -2.0; -2.0, 1.0]);
        assert_eq!(all_solutions(&q, &m).unwrap().len(), 0);
        let (q, m) = (dvector![1.0, 1.0], dmatrix![1.0, -2.0; -2.0, 1.0]);
        assert_eq!(all_solutions(&q, &m).unwrap().len(), 2);
        assert!(lemke(&q, &m).is_ok());
    }

    #[test]
    fn more_sets_than_can_be_looked_at_are_refused() {
        for n in [MOST_ENUMERATED, MOST_ENUMERATED + 1, 63, 64, 65, 200] {
            let found = all_solutions(&DVector::repeat(n, 1.0), &DMatrix::identity(n, n));
            match n <= MOST_ENUMERATED {
                true => assert_eq!(found.unwrap().len(), 1),
                false => assert!(matches!(found, Err(ContactError::Value { value, .. }) if value == n as f64), "{n}"),
            }
        }
    }

    /// Whole numbers with many ties, as of contacts that are alike: the path ends in a solution or in a ray, never nowhere, where the largest pivot alone
    /// goes round and round.
    #[test]
    fn degenerate_problems_come_to_an_end() {
        let mut seed = 1_u64;
        let mut random = |most: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize % most
        };
        let (mut went_round, mut solved) = (0, 0);
        for round in 0..3000 {
            let n = 4 + random(9);
            let of = 1 + random(n);
            let mut whole = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| random(3) as f64 - 1.0);
            let (a, b, q) = (whole(n, of), whole(of, n), whole(n, 1).column(0).into_owned());
            // Of every third problem the matrix has a semi-definite symmetric part.
            let m = if round % 3 == 0 { &a * a.transpose() } else { a * b };
            went_round += usize::from(lemke_by(Ties::LargestPivot, &q, &m) == Err(Unsolved::Steps));
            match lemke(&q, &m) {
                Ok(found) => {
                    solved += 1;
                    let scale = 1.0 + found.z.amax() * m.amax();
                    assert!((&found.w - &q - &m * &found.z).amax() < 1e-9 * scale, "{q} {m}");
                    assert!(found.z.component_mul(&found.w).amax() < 1e-9 * scale, "{q} {m}");
                }
                Err(ended) => assert_eq!(ended, Unsolved::Ray, "{q} {m}"),
            }
        }
        assert!(went_round > 5 && solved > 300, "{went_round} {solved}");
    }

    proptest! {
        /// Positive definite matrices have one solution, which is the only one among all sets.
        #[test]
        fn lemke_is_enumeration(a in prop::collection::vec(-1.0..1.0_f64, 49), q in prop::collection::vec(-1.0..1.0_f64, 7)) {
            let a = DMatrix::from_vec(7, 7, a);
            let skew = (&a - a.transpose()) * 2.0;
            let m = &a * a.transpose() + DMatrix::identity(7, 7) * 0.05 + skew;
            let q = DVector::from_vec(q);
            let found = lemke(&q, &m).unwrap();
            if let Some(other) = active_set(&q, &m) {
                prop_assert!((other.w - &found.w).amax() < 1e-9);
            }
            let all = all_solutions(&q, &m).unwrap();
            prop_assert_eq!(all.len(), 1);
            prop_assert!((&found.w - &all[0].w).amax() < 1e-9);
            prop_assert!((&found.w - &q - &m * &found.z).amax() < 1e-9 * (1.0 + found.z.amax()));
            prop_assert!(found.z.component_mul(&found.w).amax() < 1e-12);
        }
    }
}
