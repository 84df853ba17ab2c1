//! Health of a large model: what its matrices are, which rows make them singular, and whether Q can be solved with.
//!
//! A model whose stiffness or mass is singular by a mistake (a node that nothing holds, a rotation without inertia) still has
//! eigenvalues, some of which are rounding. A solver does not say so by itself.

mod solutions;

use nalgebra::DMatrix;
use nalgebra_sparse::CscMatrix;

use crate::SparseError;
use crate::symmetric::{Factor, largest_entry, nearest_to_zero, norm, scaled_part, shifted};
pub use solutions::{SolutionErrors, solution_errors};

/// Largest magnitude of an eigenvalue that counts as zero, as a fraction of the norm |S|, the largest sum of the absolute values of a row; chosen: an
/// export with 14 digits moves a zero by some 1e-14.
pub const NULL: f64 = 1e-13;
/// Most null vectors that are looked at; their number is known from the signs. Chosen: a brake whose two bodies are
/// free has twelve.
const MOST_VECTORS: usize = 12;
/// Number of vectors beyond those wanted, for inverse iteration; chosen: with more, it converges faster and each step costs more.
const MORE_VECTORS: usize = 2;
/// Factor on [`NULL`] for an eigenvalue found by inverse iteration; chosen, for the rounding of products.
const FOUND: f64 = 10.0;

/// Numbers of eigenvalues by their sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Signs {
    /// Number of eigenvalues below `-NULL |S|`.
    pub negative: usize,
    /// Number of eigenvalues within `NULL |S|` of zero, without the zeros of empty rows.
    pub null: usize,
    /// Number of eigenvalues above `NULL |S|`.
    pub positive: usize,
}

/// Health of a square sparse matrix.
///
/// Signs, rank and singular rows belong to its symmetric part, scaled to `S_ij = A_ij / sqrt(d_i d_j)` with the absolute values d of the diagonal, raised
/// where they are nearly zero, so that metres and radians weigh alike, on the rows that are not empty.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixHealth {
    /// Entries that are not zero.
    pub entries: usize,
    /// The largest `|A_ij - A_ji|` as a fraction of the largest `|A_ij|`: 0 for a symmetric matrix, 2 for an antisymmetric one.
    pub asymmetry: f64,
    /// Rows, from 0, ascending, that have only zeros, as have the columns of the same number.
    pub empty_rows: Vec<usize>,
    /// Signs of the eigenvalues of S; `None` where its factorisation, which has pivots only within blocks, is unsound: of saddle
    /// points, such as those of multipliers.
    pub signs: Option<Signs>,
    /// The eigenvalue of S nearest to zero as inverse iteration has it after a few steps, as a fraction of the norm: of a definite S at least the true one; of an indefinite S it
    /// may be far from any. 0 where `signs` is `None` or all rows are empty.
    pub smallest: f64,
    /// Null vectors found: as many as `null`, or 12 of more. Fewer where inverse iteration did not find what the signs say.
    pub null_vectors: usize,
    /// Rows, from 0, that are not empty, each with the sum of the squares of its entries in the null vectors found, which are orthonormal; the largest sum
    /// first. Empty where there are no null vectors.
    pub null_rows: Vec<(usize, f64)>,
}

impl MatrixHealth {
    /// The health of a square matrix.
    ///
    /// # Errors
    /// A factorisation that does not fit into memory, a decomposition that fails.
    pub fn of(a: &CscMatrix<f64>) -> Result<Self, SparseError> {
        let largest = largest_entry(a);
        let difference = largest_entry(&(a - a.transpose()));
        let (rows, scaled) = scaled_part(a);
        let mut health = Self {
            entries: a.values().iter().filter(|value| **value != 0.0).count(),
            asymmetry: if largest > 0.0 { difference / largest } else { 0.0 },
            empty_rows: (0..a.nrows()).filter(|row| rows.binary_search(row).is_err()).collect(),
            signs: Some(Signs::default()),
            smallest: 0.0,
            null_vectors: 0,
            null_rows: Vec::new(),
        };
        if rows.is_empty() {
            return Ok(health);
        }
        let norm = norm(&scaled);
        let above = Factor::new(&shifted(&scaled, NULL * norm))?;
        let below = Factor::new(&shifted(&scaled, -NULL * norm))?;
        health.signs = above.negative().zip(below.negative()).map(|(negative, not_positive)| Signs {
            negative,
            null: not_positive.saturating_sub(negative),
            positive: rows.len() - not_positive,
        });
        let Some(signs) = health.signs else { return Ok(health) };
        let wanted = signs.null.min(MOST_VECTORS);
        let (values, vectors) = nearest_to_zero(&scaled, &below, (wanted + MORE_VECTORS).min(rows.len()))?;
        health.smallest = values.first().map_or(0.0, |value| value / norm);
        health.null_vectors = values.iter().take(wanted).filter(|value| value.abs() <= FOUND * NULL * norm).count();
        health.null_rows = moved_rows(&rows, &vectors, health.null_vectors);
        Ok(health)
    }

    /// The number of eigenvalues of the symmetric part that are not zero; `None` where the signs are not known.
    #[must_use]
    pub fn rank(&self) -> Option<usize> {
        self.signs.map(|signs| signs.negative + signs.positive)
    }
}

/// The rows with the sums of the squares of their entries in the first `count` vectors, the largest sum first.
fn moved_rows(rows: &[usize], vectors: &DMatrix<f64>, count: usize) -> Vec<(usize, f64)> {
    if count == 0 {
        return Vec::new();
    }
    let first = vectors.columns(0, count);
    let mut moved: Vec<(usize, f64)> =
        rows.iter().zip(first.row_iter()).map(|(&row, v)| (row, v.norm_squared())).collect();
    moved.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::of_entries::of_entries;

    /// Springs of stiffness 1e8 between neighbours of a chain of n masses.
    fn chain(n: usize) -> Vec<(usize, usize, f64)> {
        let spring = |i: usize| [(i, i, 1e8), (i + 1, i + 1, 1e8), (i, i + 1, -1e8), (i + 1, i, -1e8)];
        (0..n - 1).flat_map(spring).collect()
    }

    #[test]
    fn a_free_chain_has_one_null_vector_that_moves_all_rows_alike() {
        let health = MatrixHealth::of(&of_entries(50, &chain(50))).unwrap();
        assert_eq!((health.signs, health.rank()), (signs(0, 1, 49), Some(49)));
        assert_eq!((health.asymmetry, health.empty_rows.len(), health.null_vectors), (0.0, 0, 1));
        // Scaled to a unit diagonal the two ends move by 1 where the rest moves by the square root of 2.
        let (largest, smallest) = (health.null_rows[0].1, health.null_rows[49].1);
        assert!((largest / smallest - 2.0).abs() < 1e-6 && largest < 0.03, "{largest} {smallest}");
    }

    #[test]
    fn a_loose_part_is_named_by_its_rows_whatever_its_units() {
        // A chain that is held, and two rotations in small units with a spring between them alone.
        let mut entries = chain(20);
        entries.push((0, 0, 1e8));
        entries.extend([(20, 20, 1e-3), (20, 21, -1e-3), (21, 20, -1e-3), (21, 21, 1e-3)]);
        let health = MatrixHealth::of(&of_entries(23, &entries)).unwrap();
        assert_eq!(health.signs, signs(0, 1, 21));
        assert_eq!(health.empty_rows, [22]);
        let mut rows: Vec<usize> = health.null_rows.iter().take(2).map(|&(row, _)| row).collect();
        rows.sort_unstable();
        assert_eq!(rows, [20, 21]);
        assert!((health.null_rows[0].1 - 0.5).abs() < 1e-9 && health.null_rows[2].1 < 1e-9);
    }

    #[test]
    fn signs_asymmetry_and_the_smallest_eigenvalue_are_said() {
        let entries = [(0, 0, 4.0), (1, 1, -2.0), (2, 2, 1.0), (0, 1, 1.0), (1, 0, -1.0), (0, 2, 1.8), (2, 0, 1.8)];
        let health = MatrixHealth::of(&of_entries(3, &entries)).unwrap();
        assert_eq!((health.signs, health.asymmetry), (signs(1, 0, 2), 0.5));
        // Scaled: 1 and 0.9 beside it, eigenvalues 0.1 and 1.9, and -1; the norm is 1.9.
        assert!((health.smallest - 0.1 / 1.9).abs() < 1e-6, "{}", health.smallest);
        assert!(health.null_rows.is_empty());

        let zero = MatrixHealth::of(&of_entries(2, &[])).unwrap();
        assert_eq!((zero.entries, zero.rank(), zero.empty_rows), (0, Some(0), vec![0, 1]));
    }

    #[test]
    fn a_multiplier_has_its_sign_or_none() {
        // Its diagonal is zero, and its matrix is indefinite without being singular.
        let entries = [(0, 0, 1.0), (1, 1, 1.0), (0, 2, 1.0), (2, 0, 1.0)];
        let health = MatrixHealth::of(&of_entries(3, &entries)).unwrap();
        assert!(health.signs.is_none() || health.signs == signs(1, 0, 2), "{health:?}");
    }

    fn signs(negative: usize, null: usize, positive: usize) -> Option<Signs> {
        Some(Signs { negative, null, positive })
    }
}
