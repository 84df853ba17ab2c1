//! Eigenvalues of one system beside those of another.

use num_complex::Complex;

/// Largest distance, relative to |lambda|, of two eigenvalues of the same mode; chosen: with less, a mode that a reduction has with an
/// error counts as missing; with more, a missing one is taken for its neighbour.
const SAME_MODE: f64 = 1e-3;

/// Eigenvalues of one system and their counterparts in another.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The largest distance of an eigenvalue from its counterpart, relative to its size.
    pub distance: f64,
    /// Eigenvalues without a counterpart within a thousandth of their size.
    pub missed: Vec<Complex<f64>>,
    /// Eigenvalues of the other system that are no counterpart.
    pub left: Vec<Complex<f64>>,
    /// Pairs of counterparts.
    pub pairs: Vec<[Complex<f64>; 2]>,
}

/// Counterparts of the eigenvalues `of` among `others`: of all pairs within a thousandth the nearest first, each eigenvalue in one pair at most. So two modes next
/// to a coalescence have the counterparts that they have in any order.
#[must_use]
pub fn compared(of: &[Complex<f64>], others: &[Complex<f64>]) -> Compared {
    let distance = |i: usize, j: usize| (others[j] - of[i]).norm() / of[i].norm();
    let all = (0..of.len()).flat_map(|i| (0..others.len()).map(move |j| (i, j)));
    let mut near: Vec<(f64, usize, usize)> =
        all.map(|(i, j)| (distance(i, j), i, j)).filter(|(distance, ..)| *distance <= SAME_MODE).collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut counterpart, mut is_free) = (vec![None; of.len()], vec![true; others.len()]);
    let mut largest = 0.0_f64;
    for (distance, i, j) in near {
        if counterpart[i].is_none() && is_free[j] {
            (counterpart[i], is_free[j]) = (Some(j), false);
            largest = largest.max(distance);
        }
    }
    let with = || of.iter().zip(&counterpart);
    Compared {
        distance: largest,
        missed: with().filter(|(_, to)| to.is_none()).map(|(lambda, _)| *lambda).collect(),
        left: others.iter().zip(is_free).filter(|(_, is_free)| *is_free).map(|(lambda, _)| *lambda).collect(),
        pairs: with().filter_map(|(lambda, to)| to.map(|to| [*lambda, others[to]])).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first of two modes next to a coalescence does not take the counterpart of the second.
    #[test]
    fn counterparts_do_not_depend_on_the_order() {
        let on_axis = |values: &[f64]| values.iter().map(|&im| Complex::new(0.0, im)).collect::<Vec<_>>();
        let of_reduced = on_axis(&[0.9995, 1.0004, 3.0]);
        for of in [[1.0, 1.0006, 2.0], [1.0006, 2.0, 1.0]] {
            let found = compared(&on_axis(&of), &of_reduced);
            assert_eq!((found.missed, found.left), (on_axis(&[2.0]), on_axis(&[3.0])));
            assert_eq!(found.pairs.len(), 2);
            assert!((found.distance - 5e-4).abs() < 1e-9, "{}", found.distance);
        }
    }
}
