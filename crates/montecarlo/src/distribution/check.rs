//! Parameters that a distribution may have.

use std::path::Path;

use super::Distribution;
use super::bounded_normal::BoundedNormal;
use crate::error::DistributionFault;

/// Least fraction of a distribution that its bounds must keep. Chosen, 1 %: a smaller one is probably a mistake in the input, and costs the inverse
/// distribution function more than two digits.
const SMALLEST_SHARE: f64 = 0.01;

/// Probabilities of the quantiles that must be numbers: a draw beyond the first and the last is not to be expected.
const TRIED: [f64; 3] = [1e-12, 0.5, 1.0 - 1e-12];

type Checked = Result<(), DistributionFault>;

fn fault(key: &'static str, value: impl ToString, allowed: impl Into<String>) -> Checked {
    Err(DistributionFault { key, value: value.to_string(), allowed: allowed.into() })
}

fn positive(key: &'static str, value: f64) -> Checked {
    if value > 0.0 && value.is_finite() { Ok(()) } else { fault(key, value, "a number > 0") }
}

fn finite(key: &'static str, value: f64) -> Checked {
    if value.is_finite() { Ok(()) } else { fault(key, value, "a finite number") }
}

fn not_below_from(from: f64, to: f64) -> Checked {
    if to < from { fault("to", to, format!("at least from = {from}")) } else { Ok(()) }
}

impl Distribution {
    /// Checks that the parameters make a distribution that can be drawn from.
    ///
    /// # Errors
    /// The first parameter that is not allowed.
    pub fn check(&self) -> Result<(), DistributionFault> {
        self.check_fields()?;
        self.check_quantiles()
    }

    /// An error where quantiles are infinite, or 0 of a distribution whose values are all above that: with numbers that are too large or too small.
    fn check_quantiles(&self) -> Checked {
        let allowed = "a number with which quantiles are neither 0 nor infinite";
        let is_finite = TRIED.iter().all(|&u| self.quantile(u).is_finite());
        let is_positive = |of: &Self| of.quantile(TRIED[0]) > 0.0;
        match *self {
            Self::Weibull { shape, scale, .. }
                if !(is_finite && is_positive(&Self::Weibull { shape, scale, from: 0.0 })) =>
            {
                fault("shape", shape, allowed)
            }
            Self::LogNormal { sigma, .. } if !(is_finite && is_positive(self)) => fault("sigma", sigma, allowed),
            Self::LogUniform { from, to } if !(to / from).is_finite() => fault("to", to, allowed),
            Self::Normal { deviation, .. } if !is_finite => fault("deviation", deviation, allowed),
            Self::Uniform { to, .. } | Self::Triangular { to, .. } if !is_finite => fault("to", to, allowed),
            Self::Quantiles { ref values, .. } | Self::Empirical { ref values, .. } if !is_finite => {
                fault("values", format!("{values:?}"), "numbers whose differences are finite")
            }
            _ => Ok(()),
        }
    }

    fn check_fields(&self) -> Checked {
        match self {
            Self::Constant { value } => finite("value", *value),
            &Self::Normal { mean, deviation, at_least, at_most } => {
                finite("mean", mean)?;
                positive("deviation", deviation)?;
                if at_least != f64::NEG_INFINITY {
                    finite("at_least", at_least)?;
                }
                match at_most {
                    None if at_least > mean => fault("at_least", at_least, format!("at most the mean, {mean}")),
                    None => Ok(()),
                    Some(at_most) => {
                        finite("at_most", at_most)?;
                        check_bounds(
                            BoundedNormal::normal(mean, deviation, at_least, Some(at_most)),
                            Some(at_least),
                            Some(at_most),
                        )
                    }
                }
            }
            &Self::LogNormal { median, sigma, at_least, at_most } => {
                positive("median", median)?;
                positive("sigma", sigma)?;
                at_least.map_or(Ok(()), |bound| positive("at_least", bound))?;
                at_most.map_or(Ok(()), |bound| positive("at_most", bound))?;
                check_bounds(BoundedNormal::log_normal(median, sigma, at_least, at_most), at_least, at_most)
            }
            &Self::Uniform { from, to } => {
                finite("from", from)?;
                finite("to", to)?;
                not_below_from(from, to)
            }
            &Self::LogUniform { from, to } => {
                positive("from", from)?;
                positive("to", to)?;
                not_below_from(from, to)
            }
            Self::Quantiles { probabilities, values } => check_table(probabilities, values),
            &Self::Triangular { from, mode, to } => {
                [("from", from), ("mode", mode), ("to", to)]
                    .into_iter()
                    .try_for_each(|(key, value)| finite(key, value))?;
                match (from < to, (from..=to).contains(&mode)) {
                    (false, _) => fault("to", to, format!("more than from = {from}")),
                    (true, false) => fault("mode", mode, format!("from = {from} to to = {to}")),
                    (true, true) => Ok(()),
                }
            }
            &Self::Weibull { shape, scale, from } => {
                positive("shape", shape)?;
                positive("scale", scale)?;
                finite("from", from)
            }
            Self::Discrete { values, weights } => {
                if values.len() < 2 {
                    return fault("values", format!("a list of {}", values.len()), "two numbers or more");
                }
                ascending("values", values)?;
                if !weights.is_empty() && weights.len() != values.len() {
                    let allowed = format!("one for each of the {} values", values.len());
                    return fault("weights", format!("a list of {}", weights.len()), allowed);
                }
                weights.iter().try_for_each(|&weight| positive("weights", weight))
            }
            Self::Empirical { values, file, .. } => {
                if let (Some(file), []) = (file, &values[..]) {
                    return fault("file", file.display().to_string(), "a file that has been read: its values");
                }
                values.iter().try_for_each(|&value| finite("values", value))?;
                match (values.windows(2).find(|pair| pair[0] > pair[1]), values.first() < values.last()) {
                    (Some(pair), _) => {
                        fault("values", format!("[.., {}, {}, ..]", pair[0], pair[1]), "numbers that ascend")
                    }
                    (None, false) => {
                        fault("values", format!("a list of {}", values.len()), "two different numbers or more")
                    }
                    (None, true) => Ok(()),
                }
            }
        }
    }

    /// The distribution with the measured values of its file, which `read` is asked for by the path of the file and the name of the column. Measured values are
    /// put in ascending order, whether they come from a file or not.
    ///
    /// # Errors
    /// Errors of `read`.
    pub fn with_file<E>(self, read: impl FnOnce(&Path, Option<&str>) -> Result<Vec<f64>, E>) -> Result<Self, E> {
        match self {
            Self::Empirical { mut values, file, column } => {
                if let (Some(file), []) = (&file, &values[..]) {
                    values = read(file, column.as_deref())?;
                }
                values.sort_by(f64::total_cmp);
                Ok(Self::Empirical { values, file, column })
            }
            other => Ok(other),
        }
    }
}

/// An error where the bounds keep too little of a distribution; it names the bound that cuts off more.
fn check_bounds(bounded: BoundedNormal, at_least: Option<f64>, at_most: Option<f64>) -> Checked {
    if let (Some(at_least), Some(at_most)) = (at_least, at_most)
        && at_most <= at_least
    {
        return fault("at_most", at_most, format!("more than at_least = {at_least}"));
    }
    let share = bounded.share();
    if share >= SMALLEST_SHARE {
        return Ok(());
    }
    let allowed = format!(
        "bounds that keep {} % of the distribution or more, not {:.1e} %",
        100.0 * SMALLEST_SHARE,
        100.0 * share
    );
    let [below, above] = bounded.cut_off();
    match (at_least, at_most) {
        (Some(at_least), None) => fault("at_least", at_least, allowed),
        (Some(at_least), Some(_)) if below > above => fault("at_least", at_least, allowed),
        (_, at_most) => fault("at_most", at_most.unwrap_or(f64::INFINITY), allowed),
    }
}

fn check_table(probabilities: &[f64], values: &[f64]) -> Checked {
    if values.len() != probabilities.len() {
        let allowed = format!("one for each of the {} probabilities", probabilities.len());
        return fault("values", format!("a list of {}", values.len()), allowed);
    }
    let (Some(&first), Some(&last), 2..) = (probabilities.first(), probabilities.last(), values.len()) else {
        return fault("probabilities", format!("a list of {}", probabilities.len()), "two numbers or more");
    };
    ascending("probabilities", probabilities)?;
    ascending("values", values)?;
    if first != 0.0 {
        return fault("probabilities", format!("[{first}, ..]"), "0 as the first");
    }
    if last != 1.0 {
        return fault("probabilities", format!("[.., {last}]"), "1 as the last");
    }
    Ok(())
}

fn ascending(key: &'static str, list: &[f64]) -> Checked {
    list.iter().try_for_each(|&number| finite(key, number))?;
    match list.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => fault(key, format!("[.., {}, {}, ..]", pair[0], pair[1]), "numbers that ascend, each once"),
        None => Ok(()),
    }
}
