//! Parameters that depend on each other: a Gaussian copula.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::distribution::{Distribution, MOST_PROBABLE};

/// A Gaussian copula: the normal scores `z_i = Phi^-1(F_i(x_i))` of the parameters x_i have a correlation matrix R, and each parameter
/// keeps its own distribution F_i (Nelsen, An Introduction to Copulas, 2006, section 2.3).
///
/// Independent draws become correlated ones by `z -> L z` with the Cholesky factor `R = L L^T`: a parameter that R correlates with none
/// before it keeps its draw to the last bit, and a small correlation changes it by little. The rank correlation of two parameters
/// is `6 / pi asin(R_ij / 2)` (Kruskal, J. Am. Stat. Assoc. 53, 1958).
#[derive(Debug, Clone, PartialEq)]
pub struct GaussianCopula {
    /// The rows of L up to the diagonal.
    factor: Vec<Vec<f64>>,
}

impl GaussianCopula {
    /// The copula with a correlation matrix, given by its rows, of which the part up to the diagonal is read; its diagonal is 1. `None`
    /// where it is not positive definite.
    #[must_use]
    pub fn new(correlation: &[Vec<f64>]) -> Option<Self> {
        let mut factor: Vec<Vec<f64>> = Vec::with_capacity(correlation.len());
        for (i, given) in correlation.iter().enumerate() {
            let mut row: Vec<f64> = Vec::with_capacity(i + 1);
            for j in 0..i {
                let before: f64 = row.iter().zip(&factor[j]).map(|(a, b)| a * b).sum();
                row.push((given[j] - before) / factor[j][j]);
            }
            let left = 1.0 - row.iter().map(|l| l * l).sum::<f64>();
            if left.is_nan() || left <= LEAST_PIVOT {
                return None;
            }
            row.push(left.sqrt());
            factor.push(row);
        }
        Some(Self { factor })
    }

    /// The rows of L, each up to the diagonal.
    #[must_use]
    pub fn factor(&self) -> &[Vec<f64>] {
        &self.factor
    }

    /// True if no parameter is correlated with another.
    #[must_use]
    pub fn is_independent(&self) -> bool {
        self.factor.iter().all(|row| is_alone(row))
    }

    /// Makes independent draws of parameters with these distributions correlated ones. All lists have as many entries as the matrix rows.
    pub fn apply(&self, distributions: &[&Distribution], values: &mut [f64]) {
        let normal = Normal::standard();
        let score = |(distribution, value): (&&Distribution, &f64)| {
            normal.inverse_cdf(distribution.cumulative(*value).clamp(f64::MIN_POSITIVE, MOST_PROBABLE))
        };
        let scores: Vec<f64> = distributions.iter().zip(&*values).map(score).collect();
        for ((row, distribution), value) in self.factor.iter().zip(distributions).zip(values) {
            if !is_alone(row) {
                let z: f64 = row.iter().zip(&scores).map(|(l, z)| l * z).sum();
                *value = distribution.quantile_of_score(z);
            }
        }
    }
}

/// Least square of a diagonal entry of L, the variance that is left of a parameter when the parameters before it are known; chosen, above the rounding of
/// the factorisation.
const LEAST_PIVOT: f64 = 1e-12;

/// True for a row of L of a parameter that is correlated with none before it.
fn is_alone(row: &[f64]) -> bool {
    row.iter().rev().skip(1).all(|l| *l == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::stream;

    fn distributions() -> [Distribution; 3] {
        [
            Distribution::Normal { mean: 0.5, deviation: 0.1, at_least: 0.02, at_most: None },
            Distribution::LogNormal { median: 2.0, sigma: 0.3, at_least: None, at_most: None },
            Distribution::Uniform { from: -1.0, to: 3.0 },
        ]
    }

    fn draws(copula: &GaussianCopula, count: u64) -> Vec<[f64; 3]> {
        let all = distributions();
        let of = |index: u64| {
            let mut rng = stream(9, index);
            let mut values = all.each_ref().map(|distribution| distribution.draw(&mut rng).unwrap());
            copula.apply(&all.each_ref(), &mut values);
            values
        };
        (0..count).map(of).collect()
    }

    fn identity() -> Vec<Vec<f64>> {
        vec![vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]]
    }

    #[test]
    fn what_is_not_correlated_keeps_its_draw_to_the_last_bit() {
        let none = GaussianCopula::new(&identity()).unwrap();
        assert!(none.is_independent());
        let mut matrix = identity();
        matrix[2][0] = 0.7;
        let some = GaussianCopula::new(&matrix).unwrap();
        assert!(!some.is_independent());
        for (plain, correlated) in draws(&none, 50).iter().zip(draws(&some, 50)) {
            assert_eq!(plain[..2], correlated[..2]);
            assert_ne!(plain[2], correlated[2]);
        }
    }

    #[test]
    fn marginals_stay_and_ranks_correlate_as_the_closed_form_says() {
        let rho = 0.6;
        let mut matrix = identity();
        matrix[1][0] = rho;
        matrix[2][1] = -0.5;
        let (count, all) = (20_000, distributions());
        let found = draws(&GaussianCopula::new(&matrix).unwrap(), count);
        let uniform: Vec<[f64; 3]> =
            found.iter().map(|values| std::array::from_fn(|i| all[i].cumulative(values[i]))).collect();
        let error = 4.0 / (count as f64).sqrt();
        for i in 0..3 {
            // Of a uniform number: mean 1/2, and a quarter of it below 1/4.
            let mean = uniform.iter().map(|u| u[i]).sum::<f64>() / count as f64;
            let low = uniform.iter().filter(|u| u[i] < 0.25).count() as f64 / count as f64;
            assert!((mean - 0.5).abs() < error && (low - 0.25).abs() < error, "{i}: {mean} {low}");
        }
        let of_ranks =
            |i: usize, j: usize| 12.0 * uniform.iter().map(|u| (u[i] - 0.5) * (u[j] - 0.5)).sum::<f64>() / count as f64;
        let expected = |rho: f64| 6.0 / std::f64::consts::PI * (rho / 2.0).asin();
        for (i, j, rho) in [(0, 1, rho), (1, 2, -0.5), (0, 2, 0.0)] {
            assert!((of_ranks(i, j) - expected(rho)).abs() < 2.0 * error, "{i} {j}: {}", of_ranks(i, j));
        }
    }

    #[test]
    fn matrices_that_are_not_positive_definite_are_none() {
        let with = |a: f64, b: f64, c: f64| GaussianCopula::new(&[vec![1.0], vec![a, 1.0], vec![b, c, 1.0]]);
        assert!(with(0.9, 0.9, 0.9).is_some());
        for (a, b, c) in [(0.9, 0.9, -0.9), (1.0, 0.0, 0.0), (0.0, 1.5, 0.0), (f64::NAN, 0.0, 0.0)] {
            assert_eq!(with(a, b, c), None, "{a} {b} {c}");
        }
    }
}
