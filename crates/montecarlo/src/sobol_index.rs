//! Sobol' indices: which part of the variance of an output each input explains.
//!
//! Of an output Y with inputs X_1 .. X_p
//!
//! ```text
//! S_i = Var E[Y | X_i] / Var Y                      first order: what would go if X_i alone were known
//! T_i = 1 - Var E[Y | all but X_i] / Var Y          total: what would be left if all but X_i were known
//! ```
//!
//! (Sobol', Math. Modelling Comput. Exp. 1, 1993; Homma and Saltelli, Reliab. Eng. Syst. Saf. 52, 1996). With independent inputs the
//! S_i sum to 1 at most, and `T_i - S_i` is what X_i does together with others. With inputs that depend on each other S_i still is what it
//! says, but the sum means nothing: correlated inputs explain the same part twice.

use crate::confidence::{Confidence, Interval};
use crate::few_terms::FewTerms;

/// Fewest samples of which an index and its error are computed; chosen: with 200 samples of the functions of `tests/all/sobol_indices.rs`
/// intervals of 95 % still cover in 92 % of the cases and more.
const FEWEST_SAMPLES: usize = 100;

/// An index, with the standard error that follows from the samples.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct SobolIndex {
    /// The estimate; chance may bring it below 0 or above 1.
    pub value: f64,
    /// Standard error of the estimate.
    pub standard_error: f64,
    /// The samples, or rows of a design, behind it.
    pub samples: u64,
    /// The few terms that it is a sum of, where these are too few for a standard error.
    pub few: Option<FewTerms>,
}

impl SobolIndex {
    /// The estimate as a fraction of the variance: cut to what an index can be, 0 to 1.
    #[must_use]
    pub fn part(&self) -> f64 {
        self.value.clamp(0.0, 1.0)
    }

    /// The interval by Student's t, or, where the index is a sum of few terms, the interval of their Poisson counts if that is wider; cut to
    /// what an index can be: 0 to 1.
    #[must_use]
    pub fn interval(&self, confidence: Confidence) -> Interval {
        let error = confidence.t(self.samples - 1) * self.standard_error;
        let (mut lower, mut upper) = (self.value - error, self.value + error);
        if let Some(few) = self.few {
            let of_counts = few.interval(confidence);
            (lower, upper) = (lower.min(of_counts.lower), upper.max(of_counts.upper));
        }
        Interval { lower: lower.clamp(0.0, 1.0), upper: upper.clamp(0.0, 1.0) }
    }
}

/// The first-order index of an input from samples of the input `x` and the output `y`, which need no design.
///
/// With the samples in the order of their x, cyclically,
///
/// ```text
/// S = (mean of y_k y_{k+1} - mean(y)^2) / (mean of y_k^2 - mean(y)^2)
/// ```
///
/// (Gamboa, Gremaud, Klein and Lagnoux, Bernoulli 28, 2022, after Chatterjee, J. Am. Stat. Assoc. 116, 2021): two neighbours have nearly
/// the same x and otherwise nothing in common. Samples of equal x stay in their own order, which is one of chance.
///
/// The standard error is by the central limit theorem. S is unchanged where a number is added to all y; with the mean of y at 0 let
/// `w_k = y_k y_{k+1} - S y_k^2`, whose mean is 0 and whose mean over the variance of y is the error of S, to first order. At given x the w_k are independent
/// but for next neighbours, about a mean g(x) that neighbours share; g(x) itself varies with the x that were drawn. With c_j the mean of
/// `w_k w_{k+j}`: c_0 is the variance of g and of w about g, c_1 the variance of g and the covariance of next neighbours, c_2 the variance of g. So
///
/// ```text
/// n Var S = (c_0 + 2 c_1 - 2 c_2) / Var(y)^2
/// ```
///
/// where `c_1 - c_2` is taken to be 0 if it comes out below: with few samples its own error would make intervals too narrow.
///
/// That needs many pairs of neighbours of which neither is zero. An output that is zero in most samples has as few as none, in whichever
/// case the standard error is nearly 0; then the interval follows from the number of such pairs, see [`FewTerms`]. Of an indicator that is 1 in most
/// samples 1 - y is taken, which has the same index.
///
/// The bootstrap does not apply: a sample that is drawn twice is its own neighbour (Lin and Han, Biometrika 111, 2024).
///
/// `None` for fewer than 100 samples, lists of unequal length, or an output that is constant.
///
/// ```
/// use montecarlo::{Confidence, first_order_by_ranks, rand::RngExt, stream};
///
/// // y = 2 u + v with u and v uniform: u explains 4 / 5 of the variance.
/// let mut rng = stream(1, 0);
/// let inputs: Vec<[f64; 2]> = (0..2_000).map(|_| [rng.random(), rng.random()]).collect();
/// let (u, y): (Vec<f64>, Vec<f64>) = inputs.iter().map(|[u, v]| (*u, 2.0 * u + v)).unzip();
/// let index = first_order_by_ranks(&u, &y).unwrap();
/// let interval = index.interval(Confidence::P95);
/// assert!(interval.contains(0.8) && interval.upper - interval.lower < 0.1);
/// ```
#[must_use]
pub fn first_order_by_ranks(x: &[f64], y: &[f64]) -> Option<SobolIndex> {
    let n = y.len();
    if n < FEWEST_SAMPLES || x.len() != n {
        return None;
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| x[a].total_cmp(&x[b]));
    let (given, mean) = (y, mean(y.iter().copied()));
    let y: Vec<f64> = order.iter().map(|&at| y[at] - mean).collect();
    let after = |k: usize, j: usize| (k + j) % n;
    let variance = y.iter().map(|y| y * y).sum::<f64>() / n as f64;
    if !has_variance(variance, mean) {
        return None;
    }
    let value = (0..n).map(|k| y[k] * y[after(k, 1)]).sum::<f64>() / n as f64 / variance;
    let w: Vec<f64> = (0..n).map(|k| y[k] * y[after(k, 1)] - value * y[k] * y[k]).collect();
    let c = |j: usize| (0..n).map(|k| w[k] * w[after(k, j)]).sum::<f64>() / n as f64;
    let of_all = c(0) + 2.0 * (c(1) - c(2)).max(0.0);
    let standard_error = (of_all / n as f64).sqrt() / variance;
    Some(SobolIndex { value, standard_error, samples: n as u64, few: few_neighbours(&order, given, variance) })
}

/// Largest fraction of the samples in which a rare output is not zero; chosen: pairs of neighbours are then few where they are independent, and the mean of
/// y is small beside its deviation.
const RARE: f64 = 0.1;

/// The pairs of neighbours of which neither is zero, of a rare output y; `order` is the order of the samples by x, `variance` the variance of y.
fn few_neighbours(order: &[usize], y: &[f64], variance: f64) -> Option<FewTerms> {
    let n = y.len() as f64;
    let zeros = y.iter().filter(|y| **y == 0.0).count() as f64;
    let is_indicator = y.iter().all(|y| *y == 0.0 || *y == 1.0);
    let complement: Vec<f64>;
    let y = match is_indicator && zeros <= RARE * n {
        true => {
            complement = y.iter().map(|y| 1.0 - y).collect();
            &complement
        }
        false if n - zeros <= RARE * n && y.iter().all(|y| *y >= 0.0) => y,
        false => return None,
    };
    let neighbours = order.iter().zip(order.iter().cycle().skip(1));
    let terms = neighbours.map(|(&a, &b)| y[a] * y[b] / (n * variance));
    let nonzero = || y.iter().filter(|y| **y > 0.0);
    let typical = nonzero().map(|y| y * y).sum::<f64>() / nonzero().count().max(1) as f64 / (n * variance);
    FewTerms::of(terms, typical, mean(y.iter().copied()).powi(2) / variance)
}

/// The rows of a design for total indices: the output at points A and B of independent draws of all inputs, and at the points
/// of A with one input, the same in all rows, from B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PickFreeze<'a> {
    /// The output at A.
    pub a: &'a [f64],
    /// The output at B.
    pub b: &'a [f64],
    /// The output at A with the input from B.
    pub mixed: &'a [f64],
}

impl PickFreeze<'_> {
    /// The total index of the input: `mean((f(A) - f(mixed))^2) / 2 Var` (Jansen, Comput. Phys. Commun. 117, 1999), with the variance over A
    /// and B. Inputs have to be independent. `None` as [`first_order_by_ranks`].
    #[must_use]
    pub fn total(&self) -> Option<SobolIndex> {
        let index = self.ratio(|a, _, mixed| 0.5 * (a - mixed) * (a - mixed))?;
        // Its terms are zero where the input makes no difference, which in few rows it may.
        let n = self.a.len() as f64;
        let both = || self.a.iter().chain(self.b).copied();
        let mean = mean(both());
        let by = n * both().map(|y| (y - mean).powi(2)).sum::<f64>() / (2.0 * n);
        let terms = self.a.iter().zip(self.mixed).map(|(a, mixed)| 0.5 * (a - mixed).powi(2) / by);
        let nonzero = || both().filter(|y| *y != 0.0);
        let typical = 0.5 * nonzero().map(|y| y * y).sum::<f64>() / nonzero().count().max(1) as f64 / by;
        Some(SobolIndex { few: FewTerms::of(terms, typical, 0.0), ..index })
    }

    /// The first-order index of the input: `mean(f(B) (f(mixed) - f(A))) / Var` (Saltelli et al., Comput. Phys. Commun. 181, 2010), with f
    /// about its mean over A and B. `None` as [`first_order_by_ranks`].
    #[must_use]
    pub fn first_order(&self) -> Option<SobolIndex> {
        self.ratio(|a, b, mixed| b * (mixed - a))
    }

    /// The mean of a term of each row over the variance, with the standard error of a ratio of two means to first order.
    fn ratio(&self, term: impl Fn(f64, f64, f64) -> f64) -> Option<SobolIndex> {
        let Self { a, b, mixed } = *self;
        let n = a.len();
        if n < FEWEST_SAMPLES || b.len() != n || mixed.len() != n {
            return None;
        }
        let mean = mean(a.iter().chain(b).copied());
        let rows = || a.iter().zip(b).zip(mixed).map(|((a, b), mixed)| [a - mean, b - mean, mixed - mean]);
        let of_variance = |[a, b, _]: [f64; 3]| 0.5 * (a * a + b * b);
        let variance = rows().map(of_variance).sum::<f64>() / n as f64;
        if !has_variance(variance, mean) {
            return None;
        }
        let term_of = |[a, b, mixed]: [f64; 3]| term(a, b, mixed);
        let value = rows().map(term_of).sum::<f64>() / n as f64 / variance;
        let left = rows().map(|row| (term_of(row) - value * of_variance(row)).powi(2)).sum::<f64>();
        let standard_error = (left / (n - 1) as f64 / n as f64).sqrt() / variance;
        Some(SobolIndex { value, standard_error, samples: n as u64, few: None })
    }
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count();
    values.sum::<f64>() / count as f64
}

/// True for a variance above what rounding of the mean that was subtracted makes; chosen, far above the rounding of a million values.
fn has_variance(variance: f64, mean: f64) -> bool {
    variance > (1e-12 * mean).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;

    use crate::stream::stream;

    #[test]
    fn neighbours_by_hand() {
        // In the order of x: 1, 2, 4, 3 and their repetition 25 times; mean 2.5, differences -1.5, -0.5, 1.5, 0.5.
        let x: Vec<f64> = (0..100).map(f64::from).collect();
        let y: Vec<f64> = [1.0, 2.0, 4.0, 3.0].repeat(25);
        let found = first_order_by_ranks(&x, &y).unwrap();
        // (0.75 - 0.75 + 0.75 - 0.75) / 4 over (2.25 + 0.25 + 2.25 + 0.25) / 4.
        assert!(found.value.abs() < 1e-15, "{found:?}");
        // Another order of the samples is the same; another output by a number, too.
        let reversed: Vec<f64> = y.iter().rev().map(|y| y + 1e3).collect();
        let x_reversed: Vec<f64> = x.iter().rev().copied().collect();
        let again = first_order_by_ranks(&x_reversed, &reversed).unwrap();
        assert!((again.value - found.value).abs() < 1e-9 && (again.standard_error - found.standard_error).abs() < 1e-9);
    }

    #[test]
    fn an_output_without_variance_and_too_few_samples_have_no_index() {
        let x: Vec<f64> = (0..140).map(f64::from).collect();
        assert_eq!(first_order_by_ranks(&x, &vec![0.1; 140]), None);
        assert_eq!(first_order_by_ranks(&x[..99], &x[..99]), None);
        assert_eq!(first_order_by_ranks(&x[..130], &x), None);
        let (same, other) = (vec![2.0; 140], x.clone());
        assert_eq!(PickFreeze { a: &same, b: &same, mixed: &same }.total(), None);
        assert_eq!(PickFreeze { a: &x, b: &other, mixed: &x[..139] }.total(), None);
    }

    #[test]
    fn an_input_that_does_nothing_has_a_total_index_of_exactly_zero() {
        let mut rng = stream(5, 0);
        let [a, b]: [Vec<f64>; 2] = std::array::from_fn(|_| (0..150).map(|_| rng.random()).collect());
        let found = PickFreeze { a: &a, b: &b, mixed: &a }.total().unwrap();
        assert_eq!((found.value, found.standard_error), (0.0, 0.0));
        // One that does everything: mixed is b.
        let all = PickFreeze { a: &a, b: &b, mixed: &b }.total().unwrap();
        assert!(all.interval(Confidence::P95).contains(1.0));
    }
}
