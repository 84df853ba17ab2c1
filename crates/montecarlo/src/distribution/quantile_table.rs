//! Linear interpolation in a table of quantiles.

/// The value at `at` by linear interpolation between the points (`from[i]`, `to[i]`), both ascending; constant before the first
/// and after the last point. NaN without points.
///
/// With probabilities as `from` and values as `to` this is the quantile function of the table; with the two exchanged, its
/// distribution function.
pub(super) fn interpolate(from: &[f64], to: &[f64], at: f64) -> f64 {
    let above = from.partition_point(|&x| x <= at);
    match (above, from.get(above), to.get(above)) {
        (0, _, _) => to.first().copied().unwrap_or(f64::NAN),
        (_, Some(&x1), Some(&y1)) => {
            let (x0, y0) = (from[above - 1], to[above - 1]);
            y0 + (y1 - y0) * ((at - x0) / (x1 - x0))
        }
        (_, _, _) => to.last().copied().unwrap_or(f64::NAN),
    }
}
