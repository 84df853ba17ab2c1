//! A distribution given by some of its quantiles.

/// The value at `at` on the broken line through the points (`from[i]`, `to[i]`), both ascending: between two points in
/// proportion, beyond the first and the last as there. NaN without points.
///
/// With probabilities as `from` and values as `to` it is the quantile function of the table, the other way round its
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
