//! Estimates against closed forms and quadrature, and systems that must be refused.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use rare::{Error, Estimate, LimitState, Mode, Options, estimate, tail};

/// Function of the point: margins, one for each mode.
type Margins = fn(&[f64]) -> Vec<f64>;

/// Margins as functions, with gradients by differences.
struct System {
    dimensions: usize,
    margins: Margins,
}

impl LimitState for System {
    type Error = Error;

    fn dimensions(&self) -> usize {
        self.dimensions
    }

    fn modes(&self, u: &[f64]) -> Result<Vec<Mode>, Error> {
        let mode = |(place, margin): (usize, f64)| Mode { margin, growth: margin, omega: place as f64 };
        Ok((self.margins)(u).into_iter().enumerate().map(mode).collect())
    }

    fn gradient(&self, u: &[f64], mode: &Mode) -> Result<Vec<f64>, Error> {
        let at = |input: usize, by: f64| {
            let mut u = u.to_vec();
            u[input] += by;
            (self.margins)(&u)[mode.omega as usize]
        };
        Ok((0..u.len()).map(|input| (at(input, 1e-4) - at(input, -1e-4)) / 2e-4).collect())
    }
}

/// Hoffmann's oscillator: mu above `(1 + 2 c^2) / k3` flutters, with log-normal c and normal mu.
const MEDIAN_C: f64 = 0.3;
const SIGMA: f64 = 0.4;
const K3: f64 = 4.0 / 3.0;
const MU: f64 = 0.5;

fn critical(z: f64) -> f64 {
    (1.0 + 2.0 * (MEDIAN_C * (SIGMA * z).exp()).powi(2)) / K3
}

/// `P = int phi(z) Phi(-(mu_c(c(z)) - m) / s) dz` by the rule of trapezia, which is exact to rounding for such integrands.
fn by_quadrature(deviation: f64) -> f64 {
    let step = 1e-3;
    let term = |i: i32| {
        let z = step * f64::from(i);
        (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt() * tail((critical(z) - MU) / deviation)
    };
    (-9_000..=9_000).map(term).sum::<f64>() * step
}

/// Deviations of mu for which the probability is about 1e-2, 1e-5 and 1e-9.
const DEVIATIONS: [f64; 3] = [0.16, 0.076, 0.0490];

fn hoffmann(deviation: usize) -> Margins {
    [
        |u: &[f64]| vec![(MU + DEVIATIONS[0] * u[0]) - critical(u[1])],
        |u: &[f64]| vec![(MU + DEVIATIONS[1] * u[0]) - critical(u[1])],
        |u: &[f64]| vec![(MU + DEVIATIONS[2] * u[0]) - critical(u[1])],
    ][deviation]
}

fn two_in_series(u: &[f64]) -> Vec<f64> {
    let of = |mu: f64, c: f64| MU + DEVIATIONS[1] * mu - critical(c);
    vec![of(u[0], u[1]), of(u[2], u[3])]
}

fn found(dimensions: usize, margins: Margins, options: Options) -> Result<Estimate, Error> {
    estimate(&System { dimensions, margins }, &options)
}

/// A system whose margins are in another unit.
struct InUnit {
    system: System,
    unit: f64,
}

impl LimitState for InUnit {
    type Error = Error;

    fn dimensions(&self) -> usize {
        self.system.dimensions()
    }

    fn modes(&self, u: &[f64]) -> Result<Vec<Mode>, Error> {
        Ok(self.system.modes(u)?.into_iter().map(|mode| Mode { margin: self.unit * mode.margin, ..mode }).collect())
    }

    fn gradient(&self, u: &[f64], mode: &Mode) -> Result<Vec<f64>, Error> {
        Ok(self.system.gradient(u, mode)?.into_iter().map(|rate| self.unit * rate).collect())
    }
}

#[test]
fn a_margin_may_have_any_unit() {
    let systems: [(usize, Margins); 3] = [(2, hoffmann(1)), (4, two_in_series), (1, |u| vec![u[0] - 4.5])];
    for (dimensions, margins) in systems {
        let in_unit =
            |unit: f64| estimate(&InUnit { system: System { dimensions, margins }, unit }, &Options::default());
        let expected = in_unit(1.0).unwrap();
        for power in [-1000, -700, -530, -500, -100, 100, 500, 700, 1000] {
            let found = in_unit(2_f64.powi(power)).unwrap_or_else(|error| panic!("{dimensions}, 2^{power}: {error}"));
            let relative = found.probability.value / expected.probability.value - 1.0;
            assert!(relative.abs() < 1e-9, "{dimensions}, 2^{power}: {relative}");
            assert_eq!(found.design_points.len(), expected.design_points.len(), "{dimensions}, 2^{power}");
            for (point, other) in found.design_points.iter().zip(&expected.design_points) {
                assert!((point.beta - other.beta).abs() < 1e-9 && point.is_settled == other.is_settled, "2^{power}");
            }
        }
    }
}

/// Share of `seeds` whose interval contains `exact`, and the mean of the estimates relative to it.
fn coverage(dimensions: usize, margins: Margins, exact: f64, seeds: u64) -> (f64, f64) {
    let (mut covered, mut answers, mut sum) = (0, 0, 0.0);
    for seed in 0..seeds {
        // One in some hundred answers is an error by chance: three standard errors.
        let Ok(found) = found(dimensions, margins, Options { seed, ..Options::default() }) else { continue };
        let probability = found.probability;
        covered += u64::from((probability.lower..=probability.upper).contains(&exact));
        (answers, sum) = (answers + 1, sum + probability.value / exact);
    }
    assert!(answers as f64 > 0.98 * seeds as f64, "{answers} of {seeds}");
    (covered as f64 / answers as f64, sum / answers as f64)
}

#[test]
fn hoffmanns_oscillator_has_the_probability_of_the_quadrature() {
    for (place, rough) in [(0, 1e-2), (1, 1e-5), (2, 1e-9)] {
        let exact = by_quadrature(DEVIATIONS[place]);
        assert!((exact / rough).ln().abs() < 1.0, "{exact:e}");
        let options = Options { relative: 0.02, budget: 40_000, ..Options::default() };
        let found = found(2, hoffmann(place), options).unwrap();
        let Estimate { probability, design_points, is_reached, evaluations, lines, .. } = found;
        println!("{exact:.4e} {probability:?} {evaluations} {lines} {design_points:?}");
        assert!(is_reached && (probability.value / exact - 1.0).abs() < 0.06, "{exact:e} {probability:?}");
        assert!(probability.lower <= exact && exact <= probability.upper, "{exact:e} {probability:?}");
        // To first order, which is too large: the surface bends away.
        assert!((tail(design_points[0].beta) / exact).ln().abs() < 0.7, "{design_points:?}");
    }
}

#[test]
fn two_in_series_fail_where_either_does() {
    let each = by_quadrature(DEVIATIONS[1]);
    let exact = 1.0 - (1.0 - each) * (1.0 - each);
    let found = found(4, two_in_series, Options { relative: 0.03, budget: 40_000, ..Options::default() }).unwrap();
    println!("{exact:e} {:?} {}", found.probability, found.evaluations);
    assert_eq!(found.design_points.len(), 2, "{:?}", found.design_points);
    assert!(found.probability.lower <= exact && exact <= found.probability.upper, "{:?} {exact:e}", found.probability);
    // By witnesses either has half of it.
    let of_first = |witness: &&rare::Witness| two_in_series(&witness.point)[0] > 0.0;
    let first: f64 = found.witnesses.iter().filter(of_first).map(|it| it.weight / it.lines as f64).sum();
    assert!((first / each - 1.0).abs() < 0.15, "{first:e} {each:e}");
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    let exact = by_quadrature(DEVIATIONS[1]);
    let (covered, mean) = coverage(2, hoffmann(1), exact, 300);
    println!("{covered} {mean}");
    assert!(covered > 0.92 && (mean - 1.0).abs() < 0.02, "{covered} {mean}");
}

#[test]
#[ignore = "some seconds"]
fn intervals_of_a_thousand_repetitions_hold_the_truth_as_often_as_they_say() {
    for (place, deviation) in DEVIATIONS.into_iter().enumerate() {
        let (covered, mean) = coverage(2, hoffmann(place), by_quadrature(deviation), 1_000);
        println!("{place}: {covered} {mean}");
        assert!(covered > 0.93 && (mean - 1.0).abs() < 0.01, "{place} {covered} {mean}");
    }
    let each = by_quadrature(DEVIATIONS[1]);
    let (covered, mean) = coverage(4, two_in_series, 1.0 - (1.0 - each) * (1.0 - each), 1_000);
    println!("series: {covered} {mean}");
    assert!(covered > 0.93 && (mean - 1.0).abs() < 0.01, "{covered} {mean}");
}

/// Probability of `|u| > critical(v)` for v with the normal distribution, by the rule of trapezia.
fn beyond(critical: impl Fn(f64) -> f64, both_sides: bool) -> f64 {
    let step = 1e-3;
    let term = |i: i32| {
        let v = step * f64::from(i);
        let sides = if both_sides { 2.0 } else { 1.0 };
        (-0.5 * v * v).exp() / (2.0 * std::f64::consts::PI).sqrt() * (sides * tail(critical(v))).min(1.0)
    };
    (-12_000..=12_000).map(term).sum::<f64>() * step
}

/// Onsets that bend around the medians, where most of the probability is away from the design points: systems, exact, name.
fn bent() -> Vec<(usize, Margins, f64, &'static str)> {
    vec![
        (
            2,
            |u| vec![u[0] * u[0] + 0.5 * u[1] * u[1] - 20.0],
            beyond(|v| (20.0 - 0.5 * v * v).max(0.0).sqrt(), true),
            "ellipse",
        ),
        (2, |u| vec![u[0] + 0.08 * u[1] * u[1] - 4.5], beyond(|v| 4.5 - 0.08 * v * v, false), "parabola"),
        (2, |u| vec![u[0] + 0.3 * u[1] * u[1] - 4.5], beyond(|v| 4.5 - 0.3 * v * v, false), "steep parabola"),
        (2, |u| vec![u[0] * u[0] + u[1] * u[1] - 20.0], (-10.0f64).exp(), "circle"),
        (4, |u| vec![u.iter().map(|u| u * u).sum::<f64>() - 30.0], 16.0 * (-15.0f64).exp(), "sphere"),
    ]
}

#[test]
#[ignore = "some seconds"]
fn intervals_hold_the_truth_where_the_onset_bends_around_the_medians() {
    for (dimensions, margins, exact, name) in bent() {
        let answers =
            (0..200).filter_map(|seed| found(dimensions, margins, Options { seed, ..Options::default() }).ok());
        let answers: Vec<_> = answers.map(|found| found.probability).collect();
        let share = |of: &dyn Fn(&rare::Probability) -> bool| {
            answers.iter().filter(|answer| of(answer)).count() as f64 / answers.len() as f64
        };
        let (low, high) = (share(&|it| it.upper < exact), share(&|it| it.lower > exact));
        println!("{name}, {exact:e}: {} answers, {low} too low, {high} too high", answers.len());
        assert!(answers.len() > 60 && low + high < 0.13, "{name} {low} {high}");
    }
}

#[test]
fn a_million_to_one_takes_less_than_two_thousand_evaluations() {
    for seed in 1..=20 {
        let curved: Margins = |u| vec![u[0] - 4.6 - 0.05 * (u[1] * u[1] + u[2] * u[2]) + 0.1 * u[3]];
        let found = found(6, curved, Options { seed, budget: 2_000, ..Options::default() }).unwrap();
        assert!(found.is_reached && found.evaluations <= 2_000, "{seed} {} {:?}", found.evaluations, found.probability);
        assert!((3e-7..3e-6).contains(&found.probability.value), "{:?}", found.probability);
    }
}

#[test]
fn failure_in_many_inputs_and_on_two_sides_is_found() {
    let sum: Margins = |u| vec![u.iter().sum::<f64>() / (u.len() as f64).sqrt() - 4.5];
    let found_sum = found(72, sum, Options { budget: 20_000, ..Options::default() }).unwrap();
    assert!((found_sum.probability.value / tail(4.5) - 1.0).abs() < 1e-3, "{:?}", found_sum.probability);
    let sides: Margins = |u| vec![u[0].abs() - 4.5 + 0.2 * u[1]];
    let found = found(2, sides, Options::default()).unwrap();
    let exact = 2.0 * tail(4.5 / 1.04f64.sqrt());
    assert_eq!(found.design_points.len(), 2);
    assert!(found.probability.lower <= exact && exact <= found.probability.upper, "{exact:e} {:?}", found.probability);
}

/// A half space, and an island beside it that is as probable.
fn with_island(u: &[f64]) -> Vec<f64> {
    let island = 0.6 - ((u[0] + 1.5).powi(2) + (u[1] - 4.0).powi(2)).sqrt();
    vec![u[0] - 4.5, if island > -0.5 { island } else { -0.5 }]
}

#[test]
fn an_island_that_no_design_point_explains_is_an_error() {
    // Without random directions the search meets the half space alone, and no line the island; the points elsewhere do.
    let blind = Options { directions: 0, budget: 4_000, ..Options::default() };
    for seed in 0..20 {
        let error = found(2, with_island, Options { seed, ..blind }).unwrap_err();
        assert!(matches!(error, Error::Missed { beta, .. } if (3.5..3.9).contains(&beta)), "{seed} {error}");
    }
    // With them it is a design point, and the answer has both.
    let found = found(2, with_island, Options { directions: 100, relative: 0.05, budget: 20_000, seed: 1 }).unwrap();
    assert!(found.design_points.len() == 2, "{:?}", found.design_points);
    let grid = (-400..400).flat_map(|i| (-400..400).map(move |j| [0.002 * f64::from(i), 0.002 * f64::from(j)]));
    let density = |u: [f64; 2]| (-0.5 * (u[0] * u[0] + u[1] * u[1])).exp() / (2.0 * std::f64::consts::PI);
    let inside = grid.filter(|d| d[0].hypot(d[1]) < 0.6).map(|d| density([d[0] - 1.5, d[1] + 4.0]) * 0.002 * 0.002);
    let exact = tail(4.5) + inside.sum::<f64>();
    assert!(found.probability.lower <= exact && exact <= found.probability.upper, "{exact:e} {:?}", found.probability);
}

#[test]
fn failure_that_no_line_meets_is_an_error() {
    // A needle along the first input, which the search finds because it begins with the inputs.
    let needle: Margins = |u| vec![(u[0] - 4.5).min(0.3 - 100.0 * u[1].hypot(u[2]))];
    let error = found(3, needle, Options::default()).unwrap_err();
    assert!(matches!(error, Error::NoLine { beta, .. } if (beta - 4.5).abs() < 0.01), "{error}");
}

#[test]
fn what_never_fails_has_a_bound_and_what_always_does_is_refused() {
    let never: Margins = |u| vec![-20.0 + u[0] * 0.1];
    let found_never = found(3, never, Options::default()).unwrap();
    let rare::Probability { value, lower, upper, .. } = found_never.probability;
    assert!(value == 0.0 && lower == 0.0 && (upper - 0.00299).abs() < 1e-4, "{upper}");
    let always: Margins = |u| vec![1.0 + 0.1 * u[0]];
    assert!(matches!(found(2, always, Options::default()), Err(Error::NotRare { .. })));
    let broken: Margins = |u| vec![(u[0] - 4.0).sqrt()];
    assert!(matches!(found(2, broken, Options::default()), Err(Error::NoMargin { .. })));
    for (options, said) in [
        (Options { relative: 0.0, ..Options::default() }, "relative = 0"),
        (Options { relative: -1.0, ..Options::default() }, "relative = -1"),
        (Options { relative: f64::NAN, ..Options::default() }, "relative = NaN"),
        (Options { budget: 0, ..Options::default() }, "budget = 0"),
        (Options { budget: u64::MAX, ..Options::default() }, "budget = 18446744073709551615"),
    ] {
        let error = found(3, never, options).unwrap_err().to_string();
        assert!(error.starts_with(said) && !error.contains('\n'), "{error}");
    }
}

/// A window of a width at 4 deviations in a slanting direction, bent by `bend` across, with a margin that is flat outside.
fn window(u: &[f64], width: f64, bend: f64) -> Vec<f64> {
    let (along, across) = ((3.0 * u[0] + 4.0 * u[1]) / 5.0, (4.0 * u[0] - 3.0 * u[1]) / 5.0);
    let depth = along - 4.0 - bend * across * across;
    let inside = depth.min(width - depth);
    vec![if inside > 0.0 { inside.sqrt() } else { -1e-3 }]
}

/// Failure that begins and ends again within less than a step, of which the margin outside says nothing: where the search meets it, it is in the probability.
#[test]
fn windows_that_are_narrower_than_a_step_are_in_the_probability() {
    let systems: [(Margins, f64, f64); 8] = [
        (|u| window(u, 0.5, 0.0), 0.5, 0.0),
        (|u| window(u, 0.06, 0.0), 0.06, 0.0),
        (|u| window(u, 0.01, 0.0), 0.01, 0.0),
        (|u| window(u, 0.5, 0.15), 0.5, 0.15),
        (|u| window(u, 0.06, 0.15), 0.06, 0.15),
        (|u| window(u, 0.02, 0.15), 0.02, 0.15),
        (|u| window(u, 0.06, -0.05), 0.06, -0.05),
        (|u| window(u, 0.2, 0.4), 0.2, 0.4),
    ];
    let (mut number, mut held, mut sum) = (0, 0, 0.0);
    for (margins, width, bend) in systems {
        let from = |v: f64| 4.0 + bend * v * v;
        let exact = beyond(from, false) - beyond(|v| from(v) + width, false);
        for (dimensions, seed) in [2, 5].into_iter().flat_map(|dimensions| (1..=20).map(move |seed| (dimensions, seed)))
        {
            // What the search does not meet is refused where points elsewhere do.
            let Ok(found) = found(dimensions, margins, Options { seed, budget: 4_000, ..Options::default() }) else {
                continue;
            };
            let probability = found.probability;
            if probability.value == 0.0 {
                assert!(probability.upper > exact, "{width} {bend} {dimensions} {seed} {probability:?}");
                continue;
            }
            println!("{width} {bend} {dimensions} {seed}: {} {}", probability.value / exact, found.evaluations);
            let is_held = (probability.lower..=probability.upper).contains(&exact);
            (number, held, sum) = (number + 1, held + u32::from(is_held), sum + probability.value / exact);
        }
    }
    println!("{held} of {number}, mean {}", sum / f64::from(number));
    assert!(number > 120 && f64::from(held) > 0.93 * f64::from(number), "{held} of {number}");
    assert!((sum / f64::from(number) - 1.0).abs() < 0.03, "{}", sum / f64::from(number));
}

/// Two windows next to each other, one of which alone the steps of a line may meet: both are in the probability on each line.
#[test]
fn two_windows_next_to_each_other_are_both_in_the_probability() {
    let pairs: Margins = |u| {
        let depth = |from: f64, to: f64| (u[0] - from).min(to - u[0]);
        let inside = depth(3.400, 3.489).max(depth(3.893, 4.390));
        vec![if inside > 0.0 { inside.sqrt() } else { -1e-3 }]
    };
    let exact = tail(3.400) - tail(3.489) + tail(3.893) - tail(4.390);
    let (mut number, mut held, mut sum) = (0, 0, 0.0);
    for seed in 1..=40 {
        // A window that the search does not meet is an error where points elsewhere do, and no line of its own where none does.
        let Ok(found) = found(2, pairs, Options { seed, ..Options::default() }) else { continue };
        if found.design_points.len() == 2 {
            let rare::Probability { value, lower, upper, .. } = found.probability;
            println!("{seed} {} {lower:e} {upper:e} {}", value / exact, found.evaluations);
            (number, held, sum) = (number + 1, held + u32::from((lower..=upper).contains(&exact)), sum + value / exact);
        }
    }
    let mean = sum / f64::from(number);
    assert!(number >= 10 && f64::from(held) > 0.9 * f64::from(number), "{held} of {number}, mean {mean}");
    assert!((mean - 1.0).abs() < 0.02, "{mean}");
}
