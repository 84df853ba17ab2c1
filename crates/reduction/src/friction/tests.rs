//! Against the matrices: a chain of masses with friction in three places.

use cea::{EigenSolver, QrSolver, Workspace};
use linsys::{Channel, ChannelGain, Lag, OperatingPoint};
use nalgebra::DMatrix;
use nalgebra_sparse::{CooMatrix, CscMatrix};
use num_complex::Complex;
use sparse::{Rectangle, SparseAffineSystem, SparseSecondOrder, SparseTerm};

use super::FrictionModes;
use super::anchor::{Anchor, spread};
use super::coupling::{self, Gains, Scratch, pull};
use super::discs::{Around, Discs};
use super::expansion::{Factors, TERMS};
use super::own::Own;
use crate::rows::Rows;
use crate::{Options, Reduced, Route};
use cea::certified::lanes::cast;

const ORDER: usize = 14;

/// Two terms, so that they are summed, and no direction outside of the basis, so that residuals are those of the matrices.
fn reduced() -> Reduced {
    let spring = |i: usize| 3.0 + (i * i % 7) as f64;
    let k = DMatrix::from_fn(ORDER, ORDER, |i, j| match i.abs_diff(j) {
        0 => spring(i) + spring(i + 1),
        1 => -spring(i.max(j)),
        _ => 0.0,
    });
    let m = DMatrix::from_fn(ORDER, ORDER, |i, j| if i == j { 1.0 + (i % 3) as f64 * 0.2 } else { 0.0 });
    let zero = DMatrix::zeros(ORDER, ORDER);
    let channel = |at: usize| {
        Channel::new(format!("{at}"), "friction", vec![(at, 1.0), (at + 1, -0.7)], vec![(at + 2, 2.0), (at, -0.5)])
    };
    let term = |name: &str, matrices: [&DMatrix<f64>; 3]| {
        let [m, c, k] = matrices.map(|matrix| CscMatrix::from(&CooMatrix::from(matrix)));
        let matrices = SparseSecondOrder::new(m, c, k).unwrap();
        SparseTerm { name: name.into(), family: name.into(), matrices }
    };
    let terms = vec![term("structure", [&m, &zero, &k]), term("damping", [&zero, &(&k * 0.002 + &m * 0.005), &zero])];
    let system = SparseAffineSystem::new(terms, vec![channel(1), channel(5), channel(10)]).unwrap();
    let options = Options { residual_floor: 0.0, ..Options::default() };
    Reduced::new(&system, DMatrix::identity(ORDER, ORDER), rectangle(), &[point(100)], &options).unwrap()
}

fn rectangle() -> Rectangle {
    Rectangle { re: [-0.4, 2.0], im: [0.6, 3.5] }
}

/// Gains of sample `at`: without a state, with one, or with different ones in each channel.
fn point(at: usize) -> OperatingPoint {
    let part = |seed: usize| (at * 37 + seed * 11) as f64 % 17.0 / 17.0;
    let lag = |seed: usize| Lag { decay: 2.0 + 3.0 * part(seed), drive: 0.3 + part(seed + 1), force: -0.4 };
    let gain = |seed: usize| ChannelGain {
        mu: 0.2 + 1.2 * part(seed),
        slope: 0.05 * part(seed + 2) - 0.08,
        lag: (!at.is_multiple_of(3)).then(|| lag(if at % 3 == 1 { 0 } else { seed })),
    };
    OperatingPoint { coefficients: vec![1.0, 2.0], channels: (0..3).map(gain).collect() }
}

/// The same gains in all channels.
fn shared_point(at: usize) -> OperatingPoint {
    let mut point = point(at);
    let gain = ChannelGain { mu: 0.3 * point.channels[0].mu, ..point.channels[0] };
    point.channels.fill(gain);
    point
}

fn modes(reduced: &Reduced, point: fn(usize) -> OperatingPoint) -> FrictionModes {
    let points: Vec<OperatingPoint> = (100..112).map(point).collect();
    FrictionModes::new(reduced, &points, &[0, 1, 2]).unwrap().unwrap()
}

#[test]
fn growing_modes_are_those_of_whole_spectra() {
    let grown = [point, shared_point].map(compared_with_whole_spectra);
    assert!(grown[0] > 50 && grown[1] > 20, "{grown:?}");
}

/// How many growing modes there were.
fn compared_with_whole_spectra(of: fn(usize) -> OperatingPoint) -> usize {
    let (reduced, mut followed, mut grown) = (reduced(), 0, 0);
    let modes = modes(&reduced, of);
    let points: Vec<OperatingPoint> = (0..99).map(of).collect();
    let all_found = modes.search().modes(&reduced, &points, 0.0, &|lambda| lambda.re >= 0.0);
    for ((at, point), found) in points.iter().enumerate().zip(all_found) {
        let assembled = reduced.system().assemble(point).unwrap();
        let all = QrSolver.eigenvalues(&assembled, &mut Workspace::default()).unwrap().eigenvalues;
        let expected: Vec<_> = all.into_iter().filter(|l| rectangle().contains(*l, 0.0) && l.re >= 0.0).collect();
        let (found, amplitudes) = found.unwrap();
        assert_eq!(amplitudes.len(), found.lambdas.len());
        assert_eq!(found.lambdas.len(), expected.len(), "{at}: {:?} {expected:?}", found.lambdas);
        for (at, lambda) in found.lambdas.iter().enumerate() {
            assert!(expected.iter().any(|l| (l - lambda).norm() < 1e-9), "{at}: {lambda} {expected:?}");
            let residual = cea::backward_error(&assembled, *lambda, &found.shapes.column(at).into_owned());
            assert!(
                (residual - found.residuals[at]).abs() < 1e-12 && residual < 1e-10,
                "{at} {residual} {}",
                found.residuals[at]
            );
            grown += 1;
        }
        followed +=
            usize::from(matches!(found.route, Route::Discs { corrections: 1.. } | Route::Guesses { corrections: 1.. }));
    }
    assert!(followed > 40, "{followed}");
    grown
}

#[test]
fn a_is_its_polynomial_around_known_gains_up_to_what_that_says() {
    let modes = modes(&reduced(), shared_point);
    let (p, mut checked) = (modes.ports.near(), 0);
    let (mut scratch, mut a) = (Scratch::new(&modes.ports), Rows::zeros(p, p));
    let (mut at, ones) = (Rows::zeros(2, p), Rows::from_fn(1, p, |_, _| Complex::from(1.0)));
    for (anchor, expansion) in modes.anchors.iter().filter_map(|anchor| Some((anchor, anchor.expansion.as_ref()?))) {
        let vectors = DMatrix::from_fn(p, p, |row, mode| cast::<f32, f64>(anchor.vectors.at(mode, row)));
        let inverse = vectors.clone().try_inverse().unwrap();
        for (mu, slope) in [(0.0, 0.0), (0.04, 0.0), (-0.02, 0.01), (0.1, -0.02)] {
            let known = expansion.gain;
            let gain = ChannelGain { mu: known.mu + mu, slope: known.slope + slope, ..known };
            for (mode, known) in expansion.lambdas.iter().enumerate() {
                let lambda = known * Complex::new(1.001, 0.002);
                coupling::at(&modes.own, &modes.ports.fine, lambda, Gains::of(&[gain; 3]), &mut scratch, &mut a);
                let exact = &inverse * DMatrix::from_fn(p, p, |i, j| a.at(i, j)) * vectors.column(mode);
                (0..p).for_each(|i| at.set(0, i, cast(lambda)));
                (0..p).for_each(|i| at.set(1, i, cast(pull(&gain, lambda).1)));
                let mut factors = Factors::new(p);
                expansion.factors(gain.mu, &at, ones.row(0), &mut factors);
                let mut apart = exact;
                apart[mode] -= known;
                for k in 0..TERMS {
                    let (row, factor) = (k * p + mode, factors.values.at(0, k * p + mode));
                    (0..p).for_each(|i| apart[i] -= cast::<f32, f64>(factor * expansion.terms.at(row, i)));
                }
                let sum: f64 = apart.iter().map(|entry| entry.norm()).sum();
                assert!(
                    sum <= f64::from(factors.missed[mode]) + 1e-5 * known.norm(),
                    "{mode} {mu} {slope}: {sum} {factors:?}"
                );
                checked += usize::from(factors.missed[mode].is_finite());
            }
        }
    }
    assert!(checked > 100, "{checked}");
}

#[test]
fn a_sample_is_the_same_to_the_last_bit_alone_and_among_others() {
    let (reduced, mut found) = (reduced(), 0);
    for of in [point, shared_point] {
        let modes = modes(&reduced, of);
        let points: Vec<OperatingPoint> = (0..40).map(of).collect();
        let search = |points: &[OperatingPoint]| {
            let each = modes.search().modes(&reduced, points, 0.0, &|lambda| lambda.re >= 0.0);
            each.into_iter().map(|found| found.unwrap().0).collect::<Vec<_>>()
        };
        for (point, together) in points.iter().zip(search(&points)) {
            let alone = search(std::slice::from_ref(point)).remove(0);
            found += alone.lambdas.len();
            assert_eq!((alone.lambdas, alone.residuals), (together.lambdas, together.residuals));
            assert_eq!(alone.shapes, together.shapes);
        }
    }
    assert!(found > 20, "{found}");
}

#[test]
fn unions_of_discs_hold_as_many_eigenvalues_as_they_have_discs() {
    let reduced = reduced();
    let modes = modes(&reduced, shared_point);
    let (mut discs, mut clear) = (Discs::new(&modes.ports), 0);
    for at in 0..99 {
        let point = shared_point(at);
        let assembled = reduced.system().assemble(&point).unwrap();
        let all = QrSolver.eigenvalues(&assembled, &mut Workspace::default()).unwrap().eigenvalues;
        for anchor in &modes.anchors {
            let Anchor { expansion: Some(expansion), own, .. } = anchor else { continue };
            let around = Around { expansion, own, table: &modes.coarse.table };
            let is_wanted = |lambda: Complex<f64>, beyond: f64| rectangle().contains(lambda, beyond);
            let Some(unions) = discs.wanted(around, &point.channels[0], &is_wanted) else { continue };
            let within = |union: &Vec<usize>| all.iter().filter(|lambda| discs.hold(union, **lambda)).count();
            assert!(unions.iter().all(|union| within(union) == union.len()), "{at} {unions:?}");
            let is_held = |lambda: &Complex<f64>| unions.iter().any(|union| discs.hold(union, *lambda));
            assert!(all.iter().filter(|lambda| rectangle().contains(**lambda, 0.0)).all(is_held), "{at}");
            clear += 1;
        }
    }
    assert!(clear > 100, "{clear}");
}

#[test]
fn known_gains_are_spread_over_all_that_there_are() {
    let modes = modes(&reduced(), shared_point);
    let gains = |mu: f64| vec![ChannelGain { mu, ..ChannelGain::default() }; 3];
    let all: Vec<_> = [0.5, 0.51, 0.95, 0.52, 0.1, 0.49].map(gains).into();
    let chosen = spread(&modes.ports, all, 3);
    assert_eq!(chosen, [0.5, 0.95, 0.1].map(gains));
}

#[test]
fn eigenvalues_on_a_path_are_those_of_the_straight_line_between_the_systems() {
    let reduced = reduced();
    let (modes, system) = (modes(&reduced, point), reduced.system());
    for (from, to) in [(0, 3), (1, 4), (2, 5), (0, 5), (4, 2)] {
        let (from, to) = (point(from), point(to));
        let path = modes.path(&from, &to).unwrap();
        let ends = [&from, &to].map(|at| system.assemble(at).unwrap());
        let stiffness = |t: f64, lambda: Complex<f64>| {
            ends[0].dynamic_stiffness(lambda) * Complex::from(1.0 - t)
                + ends[1].dynamic_stiffness(lambda) * Complex::from(t)
        };
        let start = QrSolver.eigenvalues(&ends[0], &mut Workspace::default()).unwrap().eigenvalues;
        for mode in start.into_iter().filter(|lambda| rectangle().contains(*lambda, 0.0)) {
            let mut guess = mode;
            for step in 0..=20 {
                let t = f64::from(step) / 20.0;
                let here = path.next_to(t, guess).unwrap();
                let q = stiffness(t, here.lambda);
                assert!((&q * &here.shape).norm() < 1e-6 * q.norm() * here.shape.norm(), "{t} {}", here.lambda);
                let step = 1e-2;
                if t < 1.0 {
                    let later = path.next_to(t + step, here.lambda + here.rate * step).unwrap();
                    let rate = (later.lambda - here.lambda) / step;
                    let mean = (here.rate + later.rate) * 0.5;
                    assert!((rate - mean).norm() < 1e-2 * rate.norm() + 1e-3, "{t} {rate} {mean}");
                }
                guess = here.lambda + here.rate / 20.0;
            }
        }
    }
}

#[test]
fn eigenvalues_next_to_a_number_are_those_of_spectra() {
    let reduced = reduced();
    let (modes, system) = (modes(&reduced, point), reduced.system());
    for (from, to) in [(0, 3), (1, 4), (2, 5)] {
        let path = modes.path(&point(from), &point(to)).unwrap();
        for (t, end) in [(0.0, from), (1.0, to)] {
            let end = system.assemble(&point(end)).unwrap();
            let spectrum = QrSolver.eigenvalues(&end, &mut Workspace::default()).unwrap().eigenvalues;
            for number in [1.0, 2.0, 2.7].map(|im| Complex::new(0.01, im)) {
                let mut expected = spectrum.clone();
                expected.sort_by(|a, b| (a - number).norm().total_cmp(&(b - number).norm()));
                let found = path.nearest(t, &[number], 3).unwrap();
                assert_eq!(found.len(), 3);
                for (lambda, shape) in &found {
                    assert!(expected[..3].iter().any(|expected| (expected - lambda).norm() < 1e-7), "{lambda}");
                    let q = end.dynamic_stiffness(*lambda);
                    assert!((&q * shape).norm() < 1e-7 * q.norm() * shape.norm(), "{lambda}");
                }
                // Where the first of them is divided out, the way leads to another one.
                let gains = &point(if t == 0.0 { from } else { to }).channels;
                let mut a = Own::new(&modes.ports, &modes.own, Gains::of(gains));
                let mut vector = vec![Complex::from(1.0); modes.ports.near()];
                let other = a.other_than(&[found[0].0], found[1].0 * 1.001, &mut vector).unwrap();
                assert!(spectrum.iter().any(|expected| (expected - other).norm() < 1e-7), "{other}");
                assert!((other - found[0].0).norm() > 1e-3);
            }
            // The modes beyond the band are not known.
            assert!(path.nearest(t, &[Complex::new(0.0, modes.ports.end)], 3).is_none());
        }
    }
}

#[test]
fn points_that_differ_in_more_than_friction_have_no_path() {
    let reduced = reduced();
    let (modes, here) = (modes(&reduced, point), point(1));
    let mut other = here.clone();
    other.coefficients[0] = 3.0;
    assert!(modes.path(&here, &other).is_none());
    assert!(FrictionModes::new(&reduced, &[here, other], &[0, 1, 2]).unwrap().is_none());
}
