//! The five numbers of a box plot.

use statrs::statistics::{Data, OrderStatistics};

/// Box, whiskers and what lies beyond them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tukey {
    pub lower: f64,
    pub median: f64,
    pub upper: f64,
    /// The furthest values within 1.5 interquartile ranges of the box.
    pub whiskers: (f64, f64),
    /// Values beyond the whiskers.
    pub outliers: Vec<f64>,
}

impl Tukey {
    /// Tukey's box of at least one value; quartiles are Hyndman and Fan's median-unbiased ones.
    pub fn of(values: &[f64]) -> Self {
        let mut data = Data::new(values.to_vec());
        let (lower, median, upper) = (data.lower_quartile(), data.median(), data.upper_quartile());
        let reach = 1.5 * (upper - lower);
        let within = |v: &f64| (lower - reach..=upper + reach).contains(v);
        let whiskers = values.iter().filter(|v| within(v)).fold((lower, upper), |(a, b), &v| (a.min(v), b.max(v)));
        Self { lower, median, upper, whiskers, outliers: values.iter().copied().filter(|v| !within(v)).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::Tukey;

    #[test]
    fn the_quartiles_of_a_textbook_sample_and_its_outlier() {
        // R: quantile(c(1:7, 100), c(.25, .5, .75), type = 8) gives 2.416667 4.5 6.583333.
        let t = Tukey::of(&[7.0, 1.0, 3.0, 2.0, 5.0, 4.0, 6.0, 100.0]);
        for (ours, expected) in [(t.lower, 29.0 / 12.0), (t.median, 4.5), (t.upper, 79.0 / 12.0)] {
            assert!((ours - expected).abs() < 1e-12, "{ours} is not {expected}");
        }
        assert_eq!((t.whiskers, t.outliers), ((1.0, 7.0), vec![100.0]));
    }

    #[test]
    fn one_value_is_its_own_box() {
        let t = Tukey::of(&[42.0]);
        assert_eq!(t, Tukey { lower: 42.0, median: 42.0, upper: 42.0, whiskers: (42.0, 42.0), outliers: vec![] });
    }
}
