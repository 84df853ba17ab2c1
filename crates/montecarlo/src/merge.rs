//! Statistics of parts of a run that add up to the statistic of the whole.

/// A statistic of samples that can be merged with the statistic of the samples that follow.
pub trait Merge {
    /// Adds the statistic of later samples.
    ///
    /// The operation must be associative: `(a + b) + c` equals `a + (b + c)` to the last bit. Sums of integers are associative,
    /// sums of floating-point numbers are not; use an [`IntegerMean`](crate::IntegerMean) or a
    /// [`QuantileSketch`](crate::QuantileSketch) instead of these.
    fn merge(&mut self, later: Self);
}

/// Merges element by element; an element that one of the two lacks counts as empty there.
impl<M: Merge> Merge for Vec<M> {
    fn merge(&mut self, later: Self) {
        let mut later = later.into_iter();
        self.iter_mut().zip(&mut later).for_each(|(mine, more)| mine.merge(more));
        self.extend(later);
    }
}
