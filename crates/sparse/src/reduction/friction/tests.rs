//! Against the matrices: a chain of masses with friction in three places.

use cea::{EigenSolver, QrSolver, Workspace};
use linsys::{Channel, ChannelGain, Lag, OperatingPoint};
use nalgebra::DMatrix;
use nalgebra_sparse::{CooMatrix, CscMatrix};
use num_complex::Complex;

use super::FrictionModes;
use crate::reduction::{Options, Reduced};
use crate::{Rectangle, SparseAffineSystem, SparseSecondOrder, SparseTerm};

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

fn modes(reduced: &Reduced) -> FrictionModes {
    let points: Vec<OperatingPoint> = (100..112).map(point).collect();
    FrictionModes::new(reduced, &points, &[0, 1, 2]).unwrap().unwrap()
}

#[test]
fn growing_modes_are_those_of_whole_spectra() {
    let (reduced, mut followed, mut grown) = (reduced(), 0, 0);
    let modes = modes(&reduced);
    let mut search = modes.search();
    for at in 0..99 {
        let point = point(at);
        let assembled = reduced.system().assemble(&point).unwrap();
        let all = QrSolver.eigenvalues(&assembled, &mut Workspace::default()).unwrap().eigenvalues;
        let expected: Vec<_> = all.into_iter().filter(|l| rectangle().contains(*l, 0.0) && l.re >= 0.0).collect();
        let found = search.modes(&reduced, &point, 0.0, &|lambda| lambda.re >= 0.0).unwrap();
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
        followed += usize::from(search.memory.corrections > 0);
    }
    assert!(grown > 50 && followed > 90, "{grown} {followed}");
}

#[test]
fn eigenvalues_on_a_path_are_those_of_the_straight_line_between_the_systems() {
    let reduced = reduced();
    let (modes, system) = (modes(&reduced), reduced.system());
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
fn points_that_differ_in_more_than_friction_have_no_path() {
    let reduced = reduced();
    let (modes, here) = (modes(&reduced), point(1));
    let mut other = here.clone();
    other.coefficients[0] = 3.0;
    assert!(modes.path(&here, &other).is_none());
    assert!(FrictionModes::new(&reduced, &[here, other], &[0, 1, 2]).unwrap().is_none());
}
