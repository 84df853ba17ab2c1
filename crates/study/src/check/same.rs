//! The comparison of two operating points, or of two systems, but for rounding.

use linsys::{AffineSystem, ChannelGain, OperatingPoint, SecondOrder};

/// A number by its name, found and expected, where these differ.
pub(super) struct Difference {
    pub what: String,
    pub found: f64,
    pub expected: f64,
}

/// Numbers of an operating point by name: coefficients of terms, and gains of channels.
pub(super) fn numbers(system: &AffineSystem, at: &OperatingPoint) -> Vec<(String, f64)> {
    let terms = system.terms().iter().zip(&at.coefficients);
    let mut numbers: Vec<_> =
        terms.map(|(term, &coefficient)| (format!("the coefficient of {:?}", term.name), coefficient)).collect();
    for (channel, &ChannelGain { mu, slope, lag }) in system.channels().iter().zip(&at.channels) {
        let of = |what: &str| format!("the {what} of {:?}", channel.name);
        numbers.extend([(of("mu"), mu), (of("slope"), slope)]);
        let lag = lag.map_or([f64::NAN; 3], |lag| [lag.decay, lag.drive, lag.force]);
        numbers.extend(["lag's decay", "lag's drive", "lag's force"].map(of).into_iter().zip(lag));
    }
    numbers
}

/// Largest rounding error of a difference that is zero.
const NOTHING: f64 = 1e-16;

/// The first number of two operating points that differs by more than the fraction `part` of the larger absolute value.
pub(super) fn points_differ(
    system: &AffineSystem,
    found: &OperatingPoint,
    expected: &OperatingPoint,
    part: f64,
) -> Option<Difference> {
    let (found, expected) = (numbers(system, found), numbers(system, expected));
    let differs = |(what, found): (String, f64), (_, expected): (String, f64)| {
        // NaN stands for a lag that is not there.
        let is_same = found == expected
            || (found.is_nan() && expected.is_nan())
            || (found - expected).abs() <= part * found.abs().max(expected.abs()) + NOTHING;
        (!is_same).then_some(Difference { what, found, expected })
    };
    found.into_iter().zip(expected).find_map(|(found, expected)| differs(found, expected))
}

/// Rounding of an entry, as a fraction of the largest one of its matrix; chosen: some hundred times machine epsilon, for sums of many
/// terms.
const ROUNDING: f64 = 1e-13;
/// Rounding of an entry, as a fraction of itself; chosen: for differences that lose digits. A brake that is wrong differs by far more.
const OF_ENTRY: f64 = 1e-9;

/// The first entry of two systems that differs by more than rounding.
pub(super) fn systems_differ(found: &SecondOrder, expected: &SecondOrder) -> Option<Difference> {
    if (found.order(), found.states()) != (expected.order(), expected.states()) {
        let (found, expected) =
            ((found.order() + found.states()) as f64, (expected.order() + expected.states()) as f64);
        return Some(Difference { what: "the number of degrees of freedom and states".into(), found, expected });
    }
    let matrices = [("M", &found.m, &expected.m), ("C", &found.c, &expected.c), ("K", &found.k, &expected.k)];
    let states = [
        ("E", &found.internal.drive, &expected.internal.drive),
        ("F", &found.internal.force, &expected.internal.force),
    ];
    for (name, a, b) in matrices.into_iter().chain(states) {
        let rounding = ROUNDING * b.amax().max(a.amax());
        for row in 0..a.nrows() {
            for column in 0..a.ncols() {
                let (found, expected) = (a[(row, column)], b[(row, column)]);
                // Also where one is no number.
                let is_same = (found - expected).abs() <= rounding + OF_ENTRY * found.abs().max(expected.abs());
                if !is_same {
                    let what = format!("{name} in row {}, column {}", row + 1, column + 1);
                    return Some(Difference { what, found, expected });
                }
            }
        }
    }
    let mut decays = found.internal.decay.iter().zip(&expected.internal.decay);
    let is_same = |a: f64, b: f64| (a - b).abs() <= OF_ENTRY * b.abs();
    let (&found, &expected) = decays.find(|(a, b)| !is_same(**a, **b))?;
    Some(Difference { what: "a decay rate".into(), found, expected })
}
