//! Losses of modes away from the medians, where the dashpots of loss factors stay as they are at the medians.

use cea::RealModes;
use linsys::{SecondOrder, Term};
use nalgebra::{DMatrix, DVectorView};

use crate::check::{Check, field};
use crate::parameter::{Parameter, elsewhere};
use crate::{CaseError, Expression};

/// Largest square of the frequency of a motion that no stiffness resists, as a fraction of the largest of all; the same number as in
/// [`RealModes::equivalent_dashpots`], by which such motions have no dashpots.
const STILL: f64 = 1e-12;

/// Coefficients of all terms at the medians of the parameters, and away from them.
pub(super) struct Places {
    pub at_medians: Vec<f64>,
    /// Coefficients at the 5 and 95 % quantiles of each parameter alone, with the place in words, where all have a value.
    elsewhere: Vec<(String, Vec<f64>)>,
}

impl Places {
    /// The coefficients of these terms.
    ///
    /// # Errors
    /// An expression without a value at the medians.
    pub fn new(
        check: &Check<'_>,
        parameters: &[Parameter],
        terms: &[Term],
        coefficients: &[Expression],
    ) -> Result<Self, CaseError> {
        let medians: Vec<f64> = parameters.iter().map(|parameter| parameter.distribution.median()).collect();
        let value = |term: &Term, own: &Expression, values: &[f64]| {
            own.value(values).map_err(check.expression(&field("terms", &term.name, "coefficient")))
        };
        let at = |values: &[f64]| {
            terms.iter().zip(coefficients).map(|(term, own)| value(term, own, values)).collect::<Result<Vec<_>, _>>()
        };
        let at_medians = at(&medians)?;
        // An expression may have no value there.
        let with_coefficients = |(place, values): (String, Vec<f64>)| Some((place, at(&values).ok()?));
        let elsewhere =
            elsewhere(&parameters.iter().collect::<Vec<_>>()).into_iter().filter_map(with_coefficients).collect();
        Ok(Self { at_medians, elsewhere })
    }

    /// Words on how far what modes lose on the free rows is off where it is most: by `dashpots` on these, which stand for the loss factors of terms at a
    /// coefficient of one, in the place of the complex stiffness. Nothing where there is no other place.
    pub fn elsewhere_in_words(
        &self,
        (terms, losses): (&[Term], &[Option<f64>]),
        dashpots: &[Option<DMatrix<f64>>],
        free: &[usize],
    ) -> String {
        let order = terms.first().map_or(0, Term::order);
        let mut worst: Option<(f64, &str)> = None;
        for (place, theta) in &self.elsewhere {
            let lossy: Vec<f64> = theta.iter().zip(losses).map(|(theta, loss)| theta * loss.unwrap_or(0.0)).collect();
            let [m, k] = [sum(order, |of| &of.m, terms, theta), sum(order, |of| &of.k, terms, theta)];
            let lossy = sum(order, |of| &of.k, terms, &lossy);
            let [m, k, lossy] = [m, k, lossy].map(|a| on(free, &a));
            let off = off_by_first_order([&m, &k], &damping(free.len(), dashpots, theta), &lossy);
            worst = worst.into_iter().chain(off.map(|off| (off, place.as_str()))).max_by(|a, b| a.0.total_cmp(&b.0));
        }
        worst.map_or_else(String::new, |(off, place)| {
            format!(
                "; draws, sweeps and screens keep these dashpots: at the 5 and 95 % quantiles of each parameter alone, what a mode loses is off by up to {off:.1e} \
                 of itself ({place})"
            )
        })
    }
}

/// Largest relative difference, over the real modes of M and K, between the loss by dashpots and the loss by the imaginary stiffness, to first order; modes
/// that lose less than a millionth of what the most lossy mode loses are left out. `None` without real modes.
fn off_by_first_order([m, k]: [&DMatrix<f64>; 2], damping: &DMatrix<f64>, lossy: &DMatrix<f64>) -> Option<f64> {
    let modes = RealModes::new(m, k).ok()?;
    let pairs: Vec<[f64; 2]> = with_stiffness(&modes)
        .map(|(shape, square)| [shape.dot(&(damping * shape)), shape.dot(&(lossy * shape)) / square.sqrt()])
        .collect();
    let largest = pairs.iter().fold(0.0, |largest: f64, [_, exact]| largest.max(*exact));
    let losing = pairs.into_iter().filter(|[_, exact]| *exact > 1e-6 * largest);
    losing.map(|[dashpots, exact]| (dashpots / exact - 1.0).abs()).reduce(f64::max)
}

/// Shapes and squares omega^2 of the modes that stiffness brings back: neither rigid motions nor those that fall away.
pub(super) fn with_stiffness(modes: &RealModes) -> impl Iterator<Item = (DVectorView<'_, f64>, f64)> {
    let largest = modes.omega_squared.iter().fold(0.0_f64, |largest, square| largest.max(square.abs()));
    let all = modes.shapes.column_iter().zip(modes.omega_squared.iter().copied());
    all.filter(move |(_, square)| *square > STILL * largest)
}

/// Sum of the dashpots of terms, of this order, at these coefficients.
pub(super) fn damping(order: usize, dashpots: &[Option<DMatrix<f64>>], theta: &[f64]) -> DMatrix<f64> {
    let own = dashpots.iter().zip(theta).filter_map(|(dashpot, theta)| Some(dashpot.as_ref()? * *theta));
    own.fold(DMatrix::zeros(order, order), |sum, own| sum + own)
}

/// Sum of one matrix of each term, times factors; of no terms one of this order that is zero.
pub(super) fn sum(
    order: usize,
    of: fn(&SecondOrder) -> &DMatrix<f64>,
    terms: &[Term],
    factors: &[f64],
) -> DMatrix<f64> {
    let zero = DMatrix::zeros(order, order);
    terms.iter().zip(factors).fold(zero, |sum, (term, theta)| sum + of(term.matrices()) * *theta)
}

/// The rows of a matrix that are free, and the columns.
pub(super) fn on(free: &[usize], a: &DMatrix<f64>) -> DMatrix<f64> {
    a.select_rows(free).select_columns(free)
}
