//! Groups of numbers that belong together because rounding does not tell them apart.

use cea::certified::enclosures::unions;
use num_complex::Complex;

/// Positions of the members of each group, ascending: neighbours are no farther from each other than the `reach` of the one with the lower imaginary part.
pub(super) fn groups(lambdas: &[Complex<f64>], reach: impl Fn(Complex<f64>) -> f64) -> Vec<Vec<usize>> {
    let reaches: Vec<f64> = lambdas.iter().map(|&lambda| reach(lambda)).collect();
    let meet = |a: usize, b: usize| {
        let lower = if (lambdas[a].im, a) < (lambdas[b].im, b) { a } else { b };
        let apart = lambdas[a] - lambdas[b];
        // Mostly without the root: no part is greater than the whole.
        apart.im.abs() <= reaches[lower] && apart.norm() <= reaches[lower]
    };
    let mut groups = unions(lambdas.len(), |_| true, meet);
    groups.iter_mut().for_each(|members| members.sort_unstable());
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_of_neighbours_are_groups() {
        let lambdas = [(0.0, 1.0), (5.0, 1.0), (0.9, 1.0), (1.8, 1.1), (5.0, 3.0), (5.0, 1.9)];
        let found = groups(&lambdas.map(|(re, im)| Complex::new(re, im)), |_| 1.0);
        assert_eq!(found, [vec![0, 2, 3], vec![1, 5], vec![4]]);
    }
}
