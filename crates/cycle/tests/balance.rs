//! Harmonic balance against integration, and branches over a parameter.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

mod common;

use std::f64::consts::TAU;
use std::sync::Arc;

use common::{Curve, coulomb, hoffmann, hoffmann_mode, mass_on_belt, part};
use cycle::{Balance, BranchEnd, ContactSystem, Error, Motion, Reach, Settings, SlidingContact, follow};
use nalgebra::{DMatrix, dmatrix};
use num_complex::Complex;

const TIGHT: f64 = 1e-12;

#[test]
fn the_balance_tends_to_the_integrated_cycle_as_harmonics_grow() {
    let system = hoffmann(1.1, 1.0);
    let (lambda, shape) = hoffmann_mode(1.1);
    let start = system.state_of_mode(lambda, &shape, 1.1 * system.grazing(&shape));
    let settings = Settings { tolerance: TIGHT, ..Settings::default() };
    let Motion::Cycle(cycle) = follow(&system, start, lambda.im, &shape, &settings).unwrap() else { panic!() };
    for (harmonics, allowed) in [(1, 1e-3), (3, 1e-5), (9, 1e-6), (25, 2e-7)] {
        let balance = Balance::new(harmonics, 4096).unwrap();
        let found = balance.near(&system, &cycle, TIGHT).unwrap();
        let error = (found.omega * cycle.period / TAU - 1.0).abs();
        assert!(error < allowed, "{harmonics}: {error}");
        let refined = balance.refined(&system, &found, (lambda.im, &shape), TIGHT).unwrap();
        assert!((refined.period / cycle.period - 1.0).abs() < 1e-10, "{harmonics}: {}", refined.period);
    }
}

/// Cycles of two degrees of freedom on a contact that sticks for a quarter of the period, at many coefficients of friction: with few harmonics
/// some balances go to another solution, slower by up to a fifth or faster. What is given is of the cycle, and with many harmonics it is given.
#[test]
fn a_balance_of_another_motion_than_its_cycle_is_none() {
    let zero = || DMatrix::zeros(2, 2);
    let (m, k) = (
        dmatrix![1.51439774571036, 0.304222258469737; 0.304222258469737, 1.36568940030648],
        dmatrix![3.2475109409429, 1.0274664211555; 1.0274664211555, 2.30430771032185],
    );
    let c = dmatrix![0.0400470981379808, 0.0117955755039036; 0.0117955755039036, 0.0298715241047509];
    let (load, speed, stiffness) = (0.742394473126316, 1.07403023045649, 2.27931354605682);
    let normal = [1.78598543597694 / stiffness, 1.4161660438368 / stiffness];
    // Counts of cycles, of balances of few harmonics that are given, and of those of many.
    let mut counts = [0; 3];
    for mu in (0..30).map(|at| 0.5 + f64::from(at) * 0.005) {
        let springs = part("springs", m.clone(), zero(), k.clone());
        let contact = SlidingContact {
            name: "belt".into(),
            family: "friction".into(),
            sliding: vec![(0, 0.621), (1, -0.784)],
            normal: vec![(0, normal[0]), (1, normal[1])],
            stiffness,
            load,
            speed,
            friction: coulomb(mu, 0.01 * speed),
        };
        let system =
            ContactSystem::new(vec![springs, part("dashpots", zero(), c.clone(), zero())], vec![contact]).unwrap();
        let (omega, shape) = (1.22, [Complex::new(-0.621, 0.3), Complex::new(0.784, 0.0)]);
        let start = system.state_of_mode(Complex::new(0.0, omega), &shape, 1.1 * system.grazing(&shape));
        let Motion::Cycle(cycle) = follow(&system, start, omega, &shape, &Settings::default()).unwrap() else {
            continue;
        };
        counts[0] += 1;
        for (place, harmonics) in [(1, 3), (1, 5), (1, 7), (1, 9), (2, 25)] {
            let Ok(found) = Balance::new(harmonics, 512).unwrap().near(&system, &cycle, 1e-10) else { continue };
            counts[place] += 1;
            let error = (found.omega * cycle.period / TAU - 1.0).abs();
            assert!(error < 0.05, "{mu} {harmonics}: {error}");
        }
    }
    assert!(counts[0] >= 28 && counts[1] > 0 && counts[2] + 2 >= counts[0], "{counts:?}");
}

#[test]
fn a_branch_stands_upright_at_its_onset_until_the_contact_opens() {
    let onset = (1.0 + 2.0 * 0.05 * 0.05) / (4.0 / 3.0);
    let (lambda, shape) = hoffmann_mode(onset);
    assert!(lambda.re.abs() < 1e-12);
    let reach = Reach { range: [0.7, 1.1], longest_step: 0.2, most_points: 200 };
    let at = |mu: f64| Ok::<_, Error>(hoffmann(mu, 1.0));
    let (points, end) =
        Balance::new(9, 512).unwrap().branch_from_onset(&at, (lambda.im, &shape), onset, &reach).unwrap();
    let below: Vec<_> = points.iter().filter(|point| point.amplitude < 0.999).collect();
    assert!(below.len() > 2);
    for point in below {
        assert!((point.cycle.parameter - onset).abs() < 1e-9, "{}", point.cycle.parameter);
        assert!((point.cycle.omega / lambda.im - 1.0).abs() < 1e-9);
    }
    // It goes on forwards, and upright it turns nowhere, whatever rounding makes of its tangent.
    assert!(points.iter().all(|point| !point.is_fold));
    assert_eq!(end, BranchEnd::Range);
    let last = points.last().unwrap();
    assert!((last.cycle.parameter - 1.1).abs() < 1e-12);
    assert!((TAU / last.cycle.omega - 4.670813590).abs() < 1e-4, "{}", TAU / last.cycle.omega);
}

#[test]
fn a_branch_goes_back_from_its_onset_to_a_fold_and_forth() {
    // y'' + y = p y' + y'^3 - y'^5: in one harmonic p = 5/8 A^4 - 3/4 A^2 at the velocity A, which turns at A^2 = 0.6, and no other frequency than 1. Friction gives y' more,
    // which a dashpot takes.
    const SPEED: f64 = 0.4;
    let curve = Curve(|w| {
        let v = SPEED - w;
        (1.0 + v + v.powi(3) - v.powi(5), 5.0 * v.powi(4) - 3.0 * v * v - 1.0)
    });
    let curve = Arc::new(curve);
    let at = |p: f64| Ok::<_, Error>(mass_on_belt(SPEED, 1.0 - p, Arc::clone(&curve) as _));
    let reach = Reach { range: [-0.3, 0.2], longest_step: 0.2, most_points: 200 };
    let one = [Complex::new(1.0, 0.0)];
    let (points, end) = Balance::new(1, 64).unwrap().branch_from_onset(&at, (1.0, &one), 0.0, &reach).unwrap();
    assert_eq!(end, BranchEnd::Range);
    let square = |amplitude: f64| (SPEED * amplitude).powi(2);
    for point in &points {
        let a2 = square(point.amplitude);
        let p = 0.625 * a2 * a2 - 0.75 * a2;
        assert!((point.cycle.parameter - p).abs() < 1e-8 && (point.cycle.omega - 1.0).abs() < 1e-9, "{point:?}");
    }
    let folds: Vec<usize> = (0..points.len()).filter(|at| points[*at].is_fold).collect();
    let [fold] = folds[..] else { panic!("{folds:?}") };
    assert!(square(points[fold - 1].amplitude) < 0.6 && square(points[fold].amplitude) > 0.6, "{points:?}");
}

#[test]
fn a_parameter_that_moves_the_load_too_has_the_same_branch() {
    // Motions are proportional to the load: measured in that of the first kink they do not change.
    let onset = (1.0 + 2.0 * 0.05 * 0.05) / (4.0 / 3.0);
    let (lambda, shape) = hoffmann_mode(onset);
    let reach = Reach { range: [0.7, 1.1], longest_step: 0.2, most_points: 200 };
    let branch = |load: fn(f64) -> f64| {
        let at = |mu: f64| Ok::<_, Error>(hoffmann(mu, load(mu)));
        Balance::new(9, 512).unwrap().branch_from_onset(&at, (lambda.im, &shape), onset, &reach).unwrap()
    };
    let ((one, end), (other, _)) = (branch(|_| 1.0), branch(|mu| (5.0 * mu).exp()));
    assert_eq!((one.len(), end), (other.len(), BranchEnd::Range));
    assert!((one[0].amplitude - 0.5).abs() < 1e-9, "{}", one[0].amplitude);
    for (one, other) in one.iter().zip(&other) {
        let differences = [
            one.amplitude - other.amplitude,
            one.cycle.parameter - other.cycle.parameter,
            one.cycle.omega - other.cycle.omega,
        ];
        assert!(differences.iter().all(|difference| difference.abs() < 1e-6), "{differences:?}");
    }
}

/// Hoffmann's oscillator whose coefficient is a table of a parameter, which has no value beyond its ends.
fn by_table<'a>(points: &'a [(f64, f64)]) -> impl Fn(f64) -> Result<cycle::ContactSystem, Error> + 'a {
    |at| {
        let piece = points.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&at));
        let Some(&[(a, low), (b, high)]) = piece.map(|pair| <&[_; 2]>::try_from(pair).unwrap()) else {
            return Err(Error::Setting { field: "argument", value: at, allowed: "within the table".into() });
        };
        Ok(hoffmann(low + (at - a) / (b - a) * (high - low), 1.0))
    }
}

/// The branch over a parameter of which the coefficient is a function has the amplitudes of the branch over the coefficient itself: over kinks of the
/// function, also where it turns, up to the ends of its range, and down again to steady sliding.
#[test]
fn a_branch_goes_over_the_kinks_of_a_table_to_its_ends() {
    let onset = (1.0 + 2.0 * 0.05 * 0.05) / (4.0 / 3.0);
    let (lambda, shape) = hoffmann_mode(onset);
    let mode = (lambda.im, &shape[..]);
    let balance = Balance::new(5, 128).unwrap();
    let reach = |from: f64, to: f64, longest_step: f64| Reach { range: [from, to], longest_step, most_points: 900 };
    let straight = |mu: f64| Ok::<_, Error>(hoffmann(mu, 1.0));
    let (of_mu, _) = balance.branch_from_onset(&straight, mode, onset, &reach(0.7, 1.3, 0.04)).unwrap();
    // Between points of the branch over mu, by linear interpolation.
    let omega_at = |mu: f64| {
        let pair = of_mu.windows(2).rfind(|pair| (pair[0].cycle.parameter..=pair[1].cycle.parameter).contains(&mu));
        let [a, b] = [0, 1].map(|at| &pair.unwrap()[at].cycle);
        a.omega + (mu - a.parameter) / (b.parameter - a.parameter) * (b.omega - a.omega)
    };
    let tables: [(&[(f64, f64)], BranchEnd); 6] = [
        (&[(0.0, 0.7), (0.5, 0.9), (1.0, 1.1)], BranchEnd::Range),
        (&[(0.0, 0.7), (0.5, 0.9), (1.0, 1.3)], BranchEnd::Range),
        (&[(0.0, 0.7), (0.5, 1.0), (1.0, 0.9)], BranchEnd::Range),
        (&[(0.0, 0.7), (0.3, 0.8), (0.5, 0.85), (0.7, 1.0), (0.9, 0.95), (1.0, 1.1)], BranchEnd::Range),
        (&[(0.0, 0.7), (0.4, 1.0), (0.5, 1.0), (0.51, 1.1), (1.0, 0.8)], BranchEnd::Range),
        (&[(0.0, 0.7), (0.5, 0.95), (1.0, 0.7)], BranchEnd::Sliding),
    ];
    for (table, expected) in tables {
        let at = by_table(table);
        let first = table[0].1;
        let start = table[1].0 * (onset - first) / (table[1].1 - first);
        let (points, end) = balance.branch_from_onset(&at, mode, start, &reach(0.0, 1.0, 0.2)).unwrap();
        assert_eq!(end, expected, "{table:?}: {:?}", points.last().map(|point| point.cycle.parameter));
        if end == BranchEnd::Range {
            assert!((points.last().unwrap().cycle.parameter - 1.0).abs() < 1e-9, "{table:?}");
        }
        for point in points.iter().filter(|point| point.amplitude > 1.01) {
            let mu =
                table.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&point.cycle.parameter)).map(|pair| {
                    pair[0].1 + (point.cycle.parameter - pair[0].0) / (pair[1].0 - pair[0].0) * (pair[1].1 - pair[0].1)
                });
            let error = (point.cycle.omega / omega_at(mu.unwrap()) - 1.0).abs();
            assert!(error < 5e-4, "{table:?}: {} {error}", point.cycle.parameter);
        }
    }
}

#[test]
fn a_branch_that_is_cut_says_why() {
    let onset = (1.0 + 2.0 * 0.05 * 0.05) / (4.0 / 3.0);
    let (lambda, shape) = hoffmann_mode(onset);
    let branch = |most_points, known_to: f64| {
        let reach = Reach { range: [0.7, 1.1], longest_step: 0.2, most_points };
        let at = |mu: f64| match mu < known_to {
            true => Ok(hoffmann(mu, 1.0)),
            false => Err(Error::Structure("no such brake")),
        };
        Balance::new(9, 512).unwrap().branch_from_onset(&at, (lambda.im, &shape), onset, &reach).unwrap()
    };
    let (points, end) = branch(5, 2.0);
    assert_eq!((points.len(), end), (5, BranchEnd::MostPoints));
    assert_eq!(branch(200, 0.9).1, BranchEnd::Lost("no such brake".into()));
}

#[test]
fn more_harmonics_than_samples_and_too_many_of_either_are_refused() {
    let error = Balance::new(9, 18).unwrap_err().to_string();
    assert_eq!(
        error,
        "samples of a period = 18; allowed: 19 or more, two for each of 9 harmonics and one for the mean"
    );
    for (harmonics, samples) in [(0, 18), (usize::MAX, 18), (101, 4096), (9, 1_000_000_000_000)] {
        assert!(Balance::new(harmonics, samples).is_err());
    }
}
