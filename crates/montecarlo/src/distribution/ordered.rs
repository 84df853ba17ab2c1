//! Quantiles of measured values in order.

/// The quantile at probability `u` of ascending values: linear between neighbours, value i of n at (i - 1) / (n - 1). NaN without values.
pub(super) fn quantile(values: &[f64], u: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return f64::NAN };
    let at = u * last as f64;
    let below = (at.floor() as usize).min(last.saturating_sub(1));
    let above = (below + 1).min(last);
    values[below] + (at - below as f64) * (values[above] - values[below])
}

/// The probability up to `x`, which inverts [`quantile`]; at a value that occurs several times, the probability of the last of them.
pub(super) fn cumulative(values: &[f64], x: f64) -> f64 {
    let above = values.partition_point(|value| *value <= x);
    match (above, values.get(above), values.len()) {
        (0, _, _) => 0.0,
        (_, None, _) => 1.0,
        (_, Some(next), count) => {
            let below = values[above - 1];
            ((above - 1) as f64 + (x - below) / (next - below)) / (count - 1) as f64
        }
    }
}
