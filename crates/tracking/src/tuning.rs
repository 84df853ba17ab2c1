//! The chosen numbers of single-mode continuation, in one place.

/// Chosen numbers of [`continuation`](crate::continuation), [`corrector`](crate::corrector) and [`step_control`](crate::step_control).
///
/// None has a unit. Measured on 1,000 modes of chains of five masses without symmetry, each to another chain, by matrices
/// (`cargo test -p brake-squeal-tracking at_half -- --ignored --nocapture`): how many are lost, which costs spectra, and the factorisations of each that
/// reaches its end; no mode ends as another one but where it says so. As chosen: 2 lost, 13.1.
///
/// | | at half | at double |
/// | --- | --- | --- |
/// | first_step | 2 lost, 13.7 | 2 lost, 12.6, **4 wrong** |
/// | shortest_step | 0 lost, 13.2 | 4 lost, 13.0 |
/// | most_attempts | 2 lost, 13.1 | 2 lost, 13.1 |
/// | least_mac, its distance from 1 | 2 lost, 13.9 | 2 lost, 13.0 |
/// | converged | 2 lost, 13.7 | 3 lost, 12.5 |
/// | most_corrections | 6 lost, 13.2 | 2 lost, 13.1 |
/// | largest_error_ratio | 6 lost, 17.0 | 0 lost, 10.8 |
/// | ratio_safety, its distance from 1 | 0 lost, 13.1 | 5 lost, 12.9 |
/// | growth, its distance from 1 | 2 lost, 13.3 | 2 lost, 13.8 |
/// | reduction, 0.95 at most | 6 lost, 12.8 | 2 lost, 13.1 |
/// | least_reduction | 3 lost, 13.0 | 0 lost, 13.1 |
/// | negligible_error | 2 lost, 13.2 | 2 lost, 13.0 |
///
/// So `first_step` is the one number on which a name depends there. `narrow_gap` and `least_step` count where all happens in a small part of the path
/// (`cargo test -p brake-squeal-brakes --test all opening_paths::`); `largest_error_ratio` is on the safe side at the price of a quarter of the time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tuning {
    /// The first step, as a fraction of the path: most continued modes allow long steps.
    pub first_step: f64,
    /// Shortest step, as a fraction of the path, next to another mode: a mode that needs a shorter one is next to a coalescence.
    pub shortest_step: f64,
    /// Largest relative distance of the two eigenvalues next to a coalescence. Where no other eigenvalue is nearer the path is fast, as where a stiff contact
    /// opens, and steps become shorter still: a name that shapes give over such a place is a wrong one.
    pub narrow_gap: f64,
    /// Shortest step, as a fraction of the path, anywhere.
    pub least_step: f64,
    /// Most attempts at a step, taken or refused: far more than any path needs that is followed to its end.
    pub most_attempts: usize,
    /// Least MAC of the shapes before and after a step.
    pub least_mac: f64,
    /// Largest relative correction of an eigenvalue that has converged: the error left is of the order of its square, 2.5e-9.
    pub converged: f64,
    /// Most corrections of one guess: a guess that needs more is near another mode.
    pub most_corrections: usize,
    /// Largest ratio of the error of the trapezoidal rule to the error of the tangent in a step that is taken: such a step is 1.2 times the
    /// distance to the next branch point.
    pub largest_error_ratio: f64,
    /// The next step is chosen for a ratio of the largest divided by this, so that most steps are taken at the first attempt.
    pub ratio_safety: f64,
    /// Largest factor between a step that was taken and the next; the least is `reduction`.
    pub growth: f64,
    /// Largest factor between a step that was refused and the next.
    pub reduction: f64,
    /// Least factor between a step that was refused and the next.
    pub least_reduction: f64,
    /// Least error of the tangent in the ratio, relative to the eigenvalue: above the errors that the corrector leaves, whose ratio has no
    /// meaning. Within it an eigenvalue is the one that was known.
    pub negligible_error: f64,
}

/// The numbers that are used.
pub(crate) const CHOSEN: Tuning = Tuning {
    first_step: 0.2,
    shortest_step: 1.0 / 512.0,
    narrow_gap: 1e-3,
    least_step: 1.0 / 1_048_576.0,
    most_attempts: 256,
    least_mac: 0.8,
    converged: 5e-5,
    most_corrections: 4,
    largest_error_ratio: 0.3,
    ratio_safety: 1.5,
    growth: 2.0,
    reduction: 0.6,
    least_reduction: 0.25,
    negligible_error: 1e-5,
};

/// [`CHOSEN`]; other numbers in the test that says what these do.
#[cfg(not(test))]
pub(crate) fn tuning() -> Tuning {
    CHOSEN
}

#[cfg(test)]
pub(crate) use tests::tuning;

#[cfg(test)]
mod tests;
