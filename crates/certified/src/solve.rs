//! Eigenvalues, all of them, by the route that the matrices allow.

use std::cell::LazyCell;
use std::fmt;

use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::dd::Dd;
use super::factors;
use super::lu::LEAST_PIVOT;
use super::pencil::{Pencil, companion, depths_of_quadratic};
use super::real::Real;
use super::scaled::Scaled;
use super::standard;
use super::structure::Structure;
use super::vectors::Factor;
use crate::{CertifiedError, Counters, francis, sort};

/// Largest condition number of the scaled mass matrix for the standard form. It multiplies the backward error, and the
/// Newton step of [`certify`](super::certify::certify) wins two digits back.
const LARGEST_MASS_CONDITION: f64 = 100.0;
/// Largest ratio of damping to stiffness and mass, in the scaled problem, that double precision is used for.
const LARGEST_OVERDAMPING: f64 = 1e5;
/// Least relative pivot of the deflated matrices that double precision is used for: QZ loses the digits of eigenvalues
/// that are this much slower or faster than the scale, while their condition numbers may be small.
const LEAST_PIVOT_IN_DOUBLE: f64 = 1e-6;
/// QR steps allowed per eigenvalue before QZ takes over; a healthy matrix takes 2 to 4.
const QR_STEPS_BEFORE_QZ: usize = 60;

/// Route by which the eigenvalues were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Route {
    /// QR iteration on `[-M^-1 C, -M^-1 K; I, 0]`, scaled: M is well conditioned.
    Standard,
    /// QZ iteration on the scaled companion pencil: M is ill conditioned, nothing is singular.
    Qz,
    /// QZ iteration after the infinite and zero eigenvalues were deflated.
    DeflatedQz,
    /// QR iteration in double-double arithmetic on two matrices, one for the slow eigenvalues and one for the fast ones: the
    /// damping of some or all directions spreads them over more than a double's digits.
    ExtendedFactors,
    /// QR iteration in double-double arithmetic after one matrix was inverted, deflated where needed: what is left is nearly
    /// singular, or strong damping is not split into slow and fast. Some five times slower.
    ExtendedStandard,
    /// QZ iteration in double-double arithmetic, where no matrix can be inverted without losing digits. Fifteen to thirty
    /// times slower.
    ExtendedQz,
    /// Every eigenvalue is exactly infinite or zero; nothing was left to iterate on.
    Deflation,
}

impl fmt::Display for Route {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Standard => "standard",
            Self::Qz => "qz",
            Self::DeflatedQz => "deflated-qz",
            Self::ExtendedFactors => "extended-factors",
            Self::ExtendedStandard => "extended-standard",
            Self::ExtendedQz => "extended-qz",
            Self::Deflation => "deflation",
        })
    }
}

/// The spectrum of a general quadratic eigenproblem.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralSpectrum {
    /// The finite eigenvalues, rad/s, in the order of [`sort`]; complex ones in exact conjugate pairs, exact zeros
    /// among them.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Number of exact zeros among the eigenvalues.
    pub zeros: usize,
    /// Number of infinite eigenvalues: with the finite ones they make 2 n.
    pub infinite: usize,
    /// gamma, rad/s, the unit in which the problem was solved (Fan, Lin, Van Dooren).
    pub scale: f64,
    /// Route by which they were found.
    pub route: Route,
}

/// Magnitudes of the largest entry of a matrix for which sums of its entries, scaled, are normal doubles with a margin of 1e7.
const LARGEST_ENTRIES: std::ops::RangeInclusive<f64> = 1e-300..=1e300;

/// Spectrum of `lambda^2 M + lambda C + K`, all of its eigenvalues, with internal states if the system has some.
///
/// # Errors
/// A malformed system; [`CertifiedError::Units`] where entries leave the range of a double; [`CertifiedError::SingularPencil`] where every lambda is
/// an eigenvalue; no convergence.
pub fn solve(system: &SecondOrder, counters: &mut Counters) -> Result<GeneralSpectrum, CertifiedError> {
    system.check()?;
    for (matrix, entries) in [("mass", &system.m), ("damping", &system.c), ("stiffness", &system.k)] {
        let largest = entries.amax();
        if largest > 0.0 && !LARGEST_ENTRIES.contains(&largest) {
            return Err(CertifiedError::Units { matrix, largest });
        }
    }
    let extended = extend(system);
    let spectrum = solve_quadratic(&extended, counters)?;
    // Each internal state came in as a massless degree of freedom and brought one infinite eigenvalue of its own.
    Ok(GeneralSpectrum { infinite: spectrum.infinite - system.states(), ..spectrum })
}

/// Internal states as massless degrees of freedom: `z' + a z - E u' = 0` below `M u'' + C u' + K u - F z = 0`.
pub(super) fn extend(system: &SecondOrder) -> SecondOrder {
    let (n, s) = (system.order(), system.states());
    if s == 0 {
        return system.clone();
    }
    let mut out = SecondOrder::zeros(n + s, 0);
    for (big, small) in [(&mut out.m, &system.m), (&mut out.c, &system.c), (&mut out.k, &system.k)] {
        big.view_mut((0, 0), (n, n)).copy_from(small);
    }
    out.c.view_mut((n, 0), (s, n)).copy_from(&-&system.internal.drive);
    out.c.view_mut((n, n), (s, s)).fill_with_identity();
    out.k.view_mut((0, n), (n, s)).copy_from(&-&system.internal.force);
    out.k.view_mut((n, n), (s, s)).set_diagonal(&system.internal.decay);
    out
}

fn solve_quadratic(system: &SecondOrder, counters: &mut Counters) -> Result<GeneralSpectrum, CertifiedError> {
    let n = system.order();
    let structure = Structure::of(system)?;
    let (infinite, zeros) = (structure.infinite.iter().sum(), structure.zero.iter().sum());
    let scaled = Scaled::new(system);
    counters.eigenvalue_solves += 1;
    let (route, sigmas) = if infinite + zeros == 2 * n {
        (Route::Deflation, Vec::new())
    } else if is_singular_to_rounding(&scaled) {
        return Err(CertifiedError::SingularPencil { exactly: false });
    } else {
        by_iteration(&scaled, &structure)?
    };
    // None of these is zero: what was rounded off is replaced by what rounding leaves of it.
    if sigmas.iter().any(|sigma| !scaled.norms.size(sigma.norm()).is_finite()) {
        return Err(scaled.range());
    }
    let nonzero = |sigma: Complex<f64>| if sigma == Complex::default() { f64::EPSILON.powi(2).into() } else { sigma };
    let mut eigenvalues: Vec<_> = sigmas.into_iter().map(|sigma| nonzero(sigma) * scaled.gamma).collect();
    if eigenvalues.iter().any(|l| !(l.re.is_finite() && l.im.is_finite())) {
        return Err(scaled.range());
    }
    eigenvalues.resize(eigenvalues.len() + zeros, Complex::default());
    sort(&mut eigenvalues);
    Ok(GeneralSpectrum { eigenvalues, zeros, infinite, scale: scaled.gamma, route })
}

/// The eigenvalues that are neither zero nor infinite: the cheapest route that suits the matrices, and where its
/// iteration fails the next.
fn by_iteration(scaled: &Scaled, structure: &Structure) -> Result<(Route, Vec<Complex<f64>>), CertifiedError> {
    // The eigenvalues are spread over tau^2, and digits are lost to as much.
    let spread = scaled.overdamping().powi(2);
    // Q is of the size of 1 / tau at the slowest: what rounding leaves of a pivot there has to be a pivot still.
    if scaled.overdamping() > f64::EPSILON / LEAST_PIVOT {
        return Err(scaled.range());
    }
    let found = |sigmas: &[Complex<f64>]| sigmas.iter().all(|s| s.re.is_finite() && s.im.is_finite());
    let singular = !structure.infinite.is_empty() || !structure.zero.is_empty();
    let strongly_damped = scaled.overdamping() > LARGEST_OVERDAMPING;
    if !singular
        && !strongly_damped
        && let Some(state) = standard_form(scaled)
        && let Some(sigmas) = francis::eigenvalues(state, QR_STEPS_BEFORE_QZ)
        && found(&sigmas)
    {
        return Ok((Route::Standard, sigmas));
    }
    let factors = || factors::eigenvalues(scaled, structure).filter(|sigmas| found(sigmas));
    if strongly_damped && let Some(sigmas) = factors() {
        return Ok((Route::ExtendedFactors, sigmas));
    }
    let companion = companion(scaled);
    // Most problems never ask for it, and its deflation in double-double costs more than QZ in double.
    let extended = LazyCell::new(|| {
        Pencil::<Dd>::new(&companion).without_infinite(&structure.infinite).without_zero(&structure.zero)
    });
    let standard = |reversed| match singular {
        true => extended.standard_eigenvalues(reversed),
        false => standard::of_quadratic(scaled, reversed),
    };
    if strongly_damped
        && spread * Dd::EPSILON <= standard::LARGEST_ERROR
        && let Some(sigmas) = standard(false)
        && found(&sigmas)
    {
        return Ok((Route::ExtendedStandard, sigmas));
    }
    let pencil = Pencil::<f64>::new(&companion).without_infinite(&structure.infinite).without_zero(&structure.zero);
    let depths = LazyCell::new(|| pencil.depths());
    let (of_stiffness, of_mass) = if singular { *depths } else { depths_of_quadratic(scaled) };
    let reversed = of_stiffness > of_mass;
    if !strongly_damped {
        // B has the pivots of M.
        if of_mass > LEAST_PIVOT_IN_DOUBLE
            && depths.0.min(depths.1) > LEAST_PIVOT_IN_DOUBLE
            && let Ok(sigmas) = pencil.clone().eigenvalues(depths.0 > depths.1)
            && found(&sigmas)
        {
            return Ok((if singular { Route::DeflatedQz } else { Route::Qz }, sigmas));
        }
        if !singular && let Some(sigmas) = factors() {
            return Ok((Route::ExtendedFactors, sigmas));
        }
        if let Some(sigmas) = standard(reversed)
            && found(&sigmas)
        {
            return Ok((Route::ExtendedStandard, sigmas));
        }
    }
    let sigmas = (*extended).clone().eigenvalues(reversed)?;
    if found(&sigmas) { Ok((Route::ExtendedQz, sigmas)) } else { Err(scaled.range()) }
}

/// `[-M^-1 C, -M^-1 K / d; d I, 0]` (see [`Pencil`]), or nothing where M is ill conditioned.
fn standard_form(s: &Scaled) -> Option<DMatrix<f64>> {
    let n = s.order();
    let inverse = s.m.clone().try_inverse()?;
    // sqrt(n) for each Frobenius norm.
    let condition = s.norms.m * inverse.norm() / n as f64;
    if condition.is_nan() || condition > LARGEST_MASS_CONDITION {
        return None;
    }
    let lu = s.m.clone().lu();
    let (mut state, _) = companion(s);
    let upper = lu.solve(&state.rows(0, n))?;
    state.rows_mut(0, n).copy_from(&upper);
    Some(state)
}

/// Q(sigma) has no more than rounding errors for a smallest singular value at points that have nothing in common.
fn is_singular_to_rounding(s: &Scaled) -> bool {
    [(0.11, 2.1), (1.07, 0.7), (9.3, 1.3)].into_iter().all(|(radius, angle)| {
        let sigma = Complex::from_polar(radius, angle);
        Factor::new(s, sigma).smallest() <= f64::EPSILON * s.norms.size(radius)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    fn spectrum(m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> Result<GeneralSpectrum, CertifiedError> {
        solve(&SecondOrder::new(m, c, k).unwrap(), &mut Counters::default())
    }

    fn scalar(m: f64, c: f64, k: f64) -> Result<GeneralSpectrum, CertifiedError> {
        spectrum(dmatrix![m], dmatrix![c], dmatrix![k])
    }

    #[test]
    fn units_change_nothing_until_they_are_refused() {
        for exponent in (-300..300).step_by(25) {
            let unit: f64 = format!("1e{exponent}").parse().unwrap();
            for (m, k) in [(1.0, unit), (unit, 1.0)] {
                // Two masses on three springs: omega^2 = k / m and 3 k / m.
                let (mass, stiffness) = (dmatrix![m, 0.0; 0.0, m], dmatrix![2.0 * k, -k; -k, 2.0 * k]);
                let found = spectrum(mass, DMatrix::zeros(2, 2), stiffness).unwrap();
                assert_eq!(found.eigenvalues.len(), 4);
                for lambda in found.eigenvalues {
                    let ratio = lambda.norm() / (k.sqrt() / m.sqrt());
                    assert!((ratio - 1.0).abs().min((ratio - 3f64.sqrt()).abs()) < 1e-14, "{m:e} {k:e} {lambda}");
                }
            }
        }
        for entry in [1e301, 1e308, 1e-301, 5e-324] {
            for (m, c, k) in [(entry, 1.0, 1.0), (1.0, entry, 1.0), (1.0, 1.0, entry)] {
                assert_eq!(scalar(m, c, k).map_err(|error| matches!(error, CertifiedError::Units { .. })), Err(true));
            }
        }
    }

    /// One mass, and two that dashpots couple with the dampings c and 3 c, from damping of a thousand times the others to all that an entry may be: right to rounding,
    /// with vectors, or refused for the size of the eigenvalues.
    #[test]
    fn damping_of_any_strength_is_right_or_refused_for_its_size() {
        let (mut right, mut refused) = (0, 0);
        for exponent in 5..300 {
            let c: f64 = format!("1e{exponent}").parse().unwrap();
            for (m, k) in [(1.0, 1.0), (1e-3, 1.0), (1.0, 1e4)] {
                let coupled = dmatrix![2.0 * c, c; c, 2.0 * c];
                for (size, damping, strengths) in [(1, dmatrix![c], vec![c]), (2, coupled, vec![c, 3.0 * c])] {
                    let unit = DMatrix::identity(size, size);
                    let system = SecondOrder::new(&unit * m, damping, &unit * k).unwrap();
                    let found = match solve(&system, &mut Counters::default()) {
                        Ok(found) => found,
                        Err(error) => {
                            assert!(matches!(error, CertifiedError::Range { .. }), "{c:e} {m} {k}: {error}");
                            assert!(c > 1e130, "{c:e} {m} {k}");
                            refused += 1;
                            continue;
                        }
                    };
                    right += 1;
                    for c in strengths {
                        let share = 0.5 + 0.5 * (1.0 - 4.0 * (m / c) * (k / c)).sqrt();
                        for expected in [-(c / m) * share, -(k / c) / share] {
                            let off = found.eigenvalues.iter().map(|lambda| (lambda / expected - 1.0).norm());
                            assert!(off.fold(f64::INFINITY, f64::min) < 1e-13, "{c:e} {m} {k} {expected}: {found:?}");
                        }
                    }
                    let certified = crate::certify(&system, &found, &mut Counters::default());
                    let all = certified.unwrap().eigenvalues;
                    assert!(all.iter().all(|of| of.verdict == crate::Verdict::Stable), "{c:e} {m} {k} {all:?}");
                }
            }
        }
        assert!(right > 700 && refused > 900, "{right} {refused}");
    }

    #[test]
    fn every_scalar_problem_has_its_school_answer() {
        let oscillator = scalar(2.0, 0.0, 8.0).unwrap();
        assert_eq!(oscillator.eigenvalues, [Complex::new(0.0, -2.0), Complex::new(0.0, 2.0)]);
        assert_eq!(oscillator.route, Route::Standard);
        let relaxation = scalar(0.0, 2.0, 8.0).unwrap();
        assert_eq!((relaxation.eigenvalues.len(), relaxation.infinite), (1, 1));
        assert!((relaxation.eigenvalues[0] + 4.0).norm() < 1e-15);
        let free = scalar(3.0, 6.0, 0.0).unwrap();
        assert_eq!((free.eigenvalues[1], free.zeros), (Complex::default(), 1));
        assert!((free.eigenvalues[0] + 2.0).norm() < 1e-15);
        let body = scalar(3.0, 0.0, 0.0).unwrap();
        assert_eq!((body.zeros, body.infinite, body.route), (2, 0, Route::Deflation));
        let spring = scalar(0.0, 0.0, 1e-300).unwrap();
        assert_eq!((spring.eigenvalues.len(), spring.infinite), (0, 2));
        assert_eq!(scalar(0.0, 0.0, 0.0), Err(CertifiedError::SingularPencil { exactly: true }));
    }

    #[test]
    fn a_pencil_that_is_singular_but_for_rounding_is_refused_too() {
        // The second row is 0.1 times the first, rounded: det Q does not vanish exactly, and has no digits.
        let row = |a: f64, b: f64| dmatrix![a, b; 0.1 * a, 0.1 * b];
        let refused = spectrum(row(1.1, 0.7), row(0.3, 0.9), row(2.3, -1.7));
        assert_eq!(refused, Err(CertifiedError::SingularPencil { exactly: false }));
    }

    #[test]
    fn strong_damping_keeps_the_digits_of_slow_and_fast_eigenvalues() {
        // lambda^2 + 1e9 lambda + 1 = 0.
        for damping in [1e9, 1e12] {
            let found = scalar(1.0, damping, 1.0).unwrap();
            assert_eq!(found.route, Route::ExtendedFactors);
            assert!((found.eigenvalues[0].re / -damping - 1.0).abs() < 1e-15);
            assert!((found.eigenvalues[1].re * -damping - 1.0).abs() < 1e-15);
        }
        // Two of them, coupled: C is a rotated diag(1, 3), K a rotated diag(1, 2), so C^-1 K has trace 5/3.
        let (c, k) = (dmatrix![2.0, 1.0; 1.0, 2.0] * 1e10, dmatrix![1.5, 0.5; 0.5, 1.5]);
        let found = spectrum(DMatrix::identity(2, 2), c, k).unwrap();
        let slow: f64 = found.eigenvalues.iter().map(|l| l.re).filter(|re| re.abs() < 1.0).sum();
        assert!((slow * -1e10 - 5.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn a_mass_that_is_singular_but_for_rounding_keeps_its_finite_eigenvalues() {
        // Two masses on one rigid link, 0.1 each: det M is a rounding error, and one pair is all but infinite.
        let m = dmatrix![0.1, 0.1; 0.1, 0.1 * (1.0 + f64::EPSILON)];
        let found = spectrum(m, DMatrix::zeros(2, 2), dmatrix![3.0, 0.0; 0.0, 1.0]).unwrap();
        assert_eq!((found.route, found.infinite), (Route::ExtendedStandard, 0));
        // Serial springs: 1 / lambda^2 = -(0.1 / 3 + 0.1 / 1).
        let expected = (1.0 / (0.1 / 3.0 + 0.1_f64)).sqrt();
        assert!((found.eigenvalues[1].im - expected).abs() < 1e-14);
        assert!(found.eigenvalues[3].norm() > 1e7);
    }

    fn square(n: usize) -> impl Strategy<Value = DMatrix<f64>> {
        prop::collection::vec(-1.0..1.0f64, n * n).prop_map(move |v| DMatrix::from_vec(n, n, v))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The eigenvalues of the reversed problem are the reciprocals, zero and infinite ones change places.
        #[test]
        fn reversal_inverts_the_spectrum(m in square(4), c in square(4), k in square(4), rank in 1..4usize) {
            let mut m = m;
            m.rows_mut(rank, 4 - rank).fill(0.0);
            let forward = spectrum(m.clone(), c.clone(), k.clone()).unwrap();
            let backward = spectrum(k, c, m).unwrap();
            prop_assert_eq!((forward.infinite, forward.zeros), (4 - rank, 0));
            prop_assert_eq!((backward.infinite, backward.zeros), (0, 4 - rank));
            let nonzero: Vec<_> = backward.eigenvalues.iter().filter(|l| l.norm() > 0.0).collect();
            for l in forward.eigenvalues {
                let nearest = nonzero.iter().map(|b| (**b * l - 1.0).norm()).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest < 1e-6, "{} has no reciprocal, nearest {}", l, nearest);
            }
        }

        /// Vieta: the sum of the eigenvalues is -tr(M^-1 C), their product det K / det M, by either route.
        #[test]
        fn sum_and_product_are_trace_and_determinant(m in square(3), c in square(3), k in square(3)) {
            prop_assume!(m.determinant().abs() > 1e-2 && k.determinant().abs() > 1e-2);
            let found = spectrum(m.clone(), c.clone(), k.clone()).unwrap();
            let inverse = m.clone().try_inverse().unwrap();
            let sum: Complex<f64> = found.eigenvalues.iter().sum();
            let product: Complex<f64> = found.eigenvalues.iter().product();
            let size: f64 = found.eigenvalues.iter().map(|l| l.norm()).sum();
            prop_assert!((sum + (inverse * c).trace()).norm() <= 1e-9 * size);
            let expected = k.determinant() / m.determinant();
            prop_assert!((product - expected).norm() <= 1e-9 * expected.abs() * (1.0 + size));
        }
    }
}
