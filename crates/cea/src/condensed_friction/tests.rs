//! Sums over modes of structures with multiple eigenvalues, and the enclosure of known zeros.

use std::cell::Cell;

use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector, dmatrix};
use num_complex::Complex;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};

use super::enclosure::{Approximations, InternalCluster, LARGEST_TOTAL_SHARE, Wanted, enclosure};
use super::response::{Point, characteristic};
use super::*;
use crate::{EigenSolver, QrSolver};

/// Pseudo-random numbers in [-1, 1).
pub(crate) fn noise(rows: usize, columns: usize, seed: u64) -> DMatrix<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    DMatrix::from_fn(rows, columns, |_, _| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    })
}

/// A chain between two walls, all its masses, springs and dashpots different.
pub(crate) fn chain(n: usize, seed: u64) -> SecondOrder {
    let part = |kind: u64| noise(n + 1, 1, 3 * seed + kind).map(|x| 1.0 + 0.5 * x);
    let tridiagonal = |link: DMatrix<f64>| {
        DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => link[i] + link[i + 1],
            1 => -link[i.max(j)],
            _ => 0.0,
        })
    };
    let m = DMatrix::from_diagonal(&part(0).column(0).rows(0, n).into_owned());
    SecondOrder::new(m, 50.0 * tridiagonal(part(1)), 1e7 * tridiagonal(part(2))).unwrap()
}

/// Pseudo-random feedback with this number of ports.
pub(crate) fn feedback(n: usize, ports: usize, seed: u64) -> Feedback {
    Feedback { force: noise(n, ports, seed + 100), reading: 1e6 * noise(ports, n, seed + 200) }
}

pub(crate) fn resolvent(structure: &SecondOrder, feedback: &Feedback) -> Result<Resolvent, NoSecular> {
    Resolvent::new(structure, feedback, &mut Workspace::default()).unwrap()
}

/// The feedback of a gain, in units, at an eigenvalue.
pub(crate) fn point(gain: &Gain, sigma: Complex<f64>) -> Point {
    gain.at(sigma)
}

/// The system with feedback, for reference determinants and spectra.
pub(crate) fn whole(structure: &SecondOrder, feedback: &Feedback, gain: &Gain) -> SecondOrder {
    let Feedback { force, reading } = feedback;
    let mut system = structure.clone();
    system.k += gain.mu * force * reading;
    system.c += gain.slope * force * force.transpose();
    if gain.lag != 0.0 {
        let decay = DVector::from_element(force.ncols(), gain.decay);
        system.internal = Internal { decay, drive: -gain.lag * force.transpose(), force: force.clone() };
    }
    system.check().unwrap();
    system
}

/// The largest relative difference between the characteristic polynomial and determinants of the whole system, at points near
/// its eigenvalues.
pub(crate) fn error(structure: &SecondOrder, feedback: &Feedback, gain: &Gain) -> f64 {
    let resolvent = resolvent(structure, feedback).unwrap();
    let whole = whole(structure, feedback, gain);
    let sigmas: Vec<Complex<f64>> =
        noise(23, 2, 7).row_iter().map(|row| Complex::new(0.3 * row[0], 1.0 + row[1])).collect();
    let points: Vec<_> = sigmas.iter().map(|&sigma| gain.in_units(resolvent.unit).at(sigma)).collect();
    let mut found = Vec::new();
    characteristic(&resolvent, &points, &mut Workspace::default(), &mut found);
    let size = structure.m.determinant() * resolvent.unit.powi(2 * structure.order() as i32);
    let error = |(sigma, found): (&Complex<f64>, Complex<f64>)| {
        let expected = whole.dynamic_stiffness(sigma * resolvent.unit).determinant() / size;
        // Eigenvalues that no feedback moves are not zeros of the polynomial.
        let uncontrollable = resolvent
            .uncontrollable
            .iter()
            .map(|uncontrollable| (sigma - uncontrollable) * (sigma - uncontrollable.conj()));
        (found * uncontrollable.product::<Complex<f64>>() - expected).norm() / expected.norm()
    };
    sigmas.iter().zip(found).map(error).fold(0.0, f64::max)
}

pub(crate) const GAIN: Gain = Gain { mu: 0.7, slope: -40.0, lag: 3e5, decay: 4e3 };

/// Two equal, uncoupled chains.
fn twins() -> SecondOrder {
    let one = chain(3, 1);
    let twice = |a: &DMatrix<f64>| DMatrix::from_fn(6, 6, |i, j| if i / 3 == j / 3 { a[(i % 3, j % 3)] } else { 0.0 });
    SecondOrder::new(twice(&one.m), twice(&one.c), twice(&one.k)).unwrap()
}

/// Equal masses in a ring: all eigenvalues but two are double, up to rounding.
fn ring() -> SecondOrder {
    let k = DMatrix::from_fn(6, 6, |i, j| match (i + 6 - j) % 6 {
        0 => 2.7e7,
        1 | 5 => -1e7,
        _ => 0.0,
    });
    SecondOrder::new(DMatrix::identity(6, 6), 1e-5 * &k, k).unwrap()
}

#[test]
fn double_modes_have_one_summand() {
    for structure in [twins(), ring()] {
        for ports in [1, 2, 3] {
            let feedback = feedback(6, ports, 5);
            // One force drives one mode of each double eigenvalue; the other is uncontrollable.
            let Resolvent { poles, uncontrollable, .. } = resolvent(&structure, &feedback).unwrap();
            let doubles = poles.windows(2).filter(|pair| pair[0] == pair[1]).count();
            let unseen = poles.iter().filter(|pole| uncontrollable.contains(pole)).count();
            assert!(
                poles.len() + uncontrollable.len() == 6 && if ports == 1 { unseen >= 2 } else { doubles >= 2 },
                "{poles:?}"
            );
            let error = error(&structure, &feedback, &GAIN);
            assert!(error < 1e-10, "{ports} ports: {error:e}");
        }
    }
}

#[test]
fn a_mode_is_uncontrollable_by_what_moves_it_and_what_is_read_of_it() {
    let diagonal = |entries: [f64; 4]| DMatrix::from_diagonal(&DVector::from_column_slice(&entries));
    let structure = SecondOrder::new(
        DMatrix::identity(4, 4),
        1e-5 * diagonal([1e7, 2e7, 3e7, 4e7]),
        diagonal([1e7, 2e7, 3e7, 4e7]),
    );
    // Pushed a little and read in full: feedback moves it by the first power. Pushed and read a little: by the square.
    // Read and not pushed: not at all.
    let feedback = Feedback {
        force: DMatrix::from_column_slice(4, 1, &[1.0, 3e-9, 3e-9, 0.0]),
        reading: DMatrix::from_row_slice(1, 4, &[1e7, 1e7, 0.0, 1e7]),
    };
    let Resolvent { poles, uncontrollable, unit, .. } = resolvent(&structure.unwrap(), &feedback).unwrap();
    let squares =
        |of: &[Complex<f64>]| of.iter().map(|pole| (1e-7 * (pole * unit).norm_sqr()).round()).collect::<Vec<_>>();
    assert_eq!((squares(&poles), squares(&uncontrollable)), (vec![1.0, 2.0], vec![3.0, 4.0]));
}

#[test]
fn structures_without_such_a_sum_say_why() {
    let plain = chain(4, 1);
    let feedback = feedback(4, 2, 1);
    let reason = |structure: &SecondOrder| resolvent(structure, &feedback).err();
    assert_eq!(reason(&plain), None);

    let mut overdamped = plain.clone();
    overdamped.c[(1, 1)] = 1e5;
    assert_eq!(reason(&overdamped), Some(NoSecular::Overdamped { oscillating: 3, order: 4 }));

    let mut gyroscopic = plain.clone();
    (gyroscopic.c[(0, 1)], gyroscopic.c[(1, 0)]) = (1e3, -1e3);
    assert!(matches!(reason(&gyroscopic), Some(NoSecular::ResponseDiffers { .. })));

    let mut follower = plain.clone();
    follower.k[(0, 1)] += 1e6;
    assert!(matches!(reason(&follower), Some(NoSecular::ResponseDiffers { .. })));

    let mut internal = plain;
    internal.internal = Internal { decay: DVector::from_element(1, 1e4), ..Internal::zeros(4, 1) };
    assert_eq!(reason(&internal), Some(NoSecular::InternalStates { states: 1 }));

    // A defective pair: critical flutter of two masses.
    let k = dmatrix![10.0, 1.0; -1.0, 12.0];
    let defective = SecondOrder::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), k).unwrap();
    let feedback = Feedback { force: dmatrix![1.0; 0.3], reading: dmatrix![0.2, 1.0] };
    let refused = resolvent(&defective, &feedback);
    assert!(matches!(refused, Err(NoSecular::Defective { .. } | NoSecular::ResponseDiffers { .. })), "{refused:?}");

    let many = Feedback { force: DMatrix::identity(4, 5), reading: DMatrix::identity(5, 4) };
    let refused = Secular::new(&chain(4, 1), &many, &mut Workspace::default()).unwrap();
    assert_eq!(refused.unwrap_err(), NoSecular::ManyPorts { ports: 5, order: 4, most: 5 });
}

/// A real polynomial with n pairs of zeros and some real zeros far left, and guesses of all zeros.
#[derive(Debug, Clone)]
struct Known {
    zeros: Vec<Complex<f64>>,
    real: Vec<f64>,
    decay: f64,
    approximations: Approximations,
    /// A frequency that the discs of damped modes must exclude.
    apart_from: f64,
}

/// A guess of an internal state, its correction, and the number of guesses it stands for.
type OfState = (Complex<f64>, Complex<f64>, f64);

impl Known {
    fn gain(&self) -> Gain {
        let decay = if self.approximations.internal.is_none() { 0.0 } else { self.decay };
        Gain { lag: decay, decay, ..Gain::default() }
    }

    /// The polynomial divided by the factor of the internal states, as [`characteristic`] gives it.
    fn value(&self, z: Complex<f64>) -> Complex<f64> {
        let modes: Complex<f64> = self.zeros.iter().map(|zero| (z - zero) * (z - zero.conj())).product();
        modes * self.real.iter().map(|re| (z - re) / (z + self.decay)).product::<Complex<f64>>()
    }

    /// The corrections of the modes, and those of internal states.
    fn corrections(&self) -> (Vec<Complex<f64>>, Vec<OfState>) {
        let (Self { approximations, .. }, gain, m) = (self, self.gain(), self.real.len());
        let of_mode = |(i, &z): (usize, &Complex<f64>)| {
            self.value(z) / approximations.others(i, z) * approximations.internal_factor(z, &gain, m)
        };
        let modes = approximations.sigmas.iter().enumerate().map(of_mode).collect();
        let of_state = |(z, count): (Complex<f64>, f64)| {
            (z, approximations.internal_correction(z, self.value(z), &gain, m), count)
        };
        (modes, approximations.internal.into_iter().flat_map(|internal| internal.guesses(m)).map(of_state).collect())
    }
}

fn known() -> impl Strategy<Value = Known> {
    let zero = (-0.3..0.1f64, 0.2..2.0f64, -1.0..1.0f64, -1.0..1.0f64);
    let zeros = prop::collection::vec(zero, 2..9);
    (zeros, prop::collection::vec(-0.1..0.1f64, 0..4), 3.0..6.0f64, -8.0..-0.5f64, 0.2..2.0f64).prop_map(
        |(zeros, real, decay, error, apart_from)| {
            let error = 10f64.powf(error);
            let guess = |&(re, im, x, y): &(f64, f64, f64, f64)| Complex::new(re + error * x, im + error * y);
            // Feedback without ports has no internal states.
            let has_states = !real.is_empty() || decay > 4.5;
            let internal = has_states.then_some(InternalCluster { middle: -decay, radius: 0.1 * decay });
            let approximations = Approximations { sigmas: zeros.iter().map(guess).collect(), internal };
            let zeros = zeros.into_iter().map(|(re, im, ..)| Complex::new(re, im)).collect();
            let real = real.into_iter().map(|part| decay * (part - 1.0)).collect();
            Known { zeros, real, decay, approximations, apart_from }
        },
    )
}

proptest! {
    #[test]
    fn a_polynomial_is_what_its_corrections_say(known in known(), x in -1.0..1.0, y in -1.0..1.0) {
        // p(z) / prod (z - z_i) = 1 + sum w_i / (z - z_i), far from all guesses.
        let z = Complex::new(4.0 + x, 3.0 * y);
        let (modes, states) = known.corrections();
        let mut sum = Complex::from(1.0);
        for (w, guess) in modes.iter().zip(&known.approximations.sigmas) {
            sum += w / (z - guess) + w.conj() / (z - guess.conj());
        }
        for (guess, w, count) in states {
            sum += w / (z - guess) + if count == 2.0 { w.conj() / (z - guess.conj()) } else { Complex::default() };
        }
        let factor = known.approximations.internal_factor(z, &known.gain(), known.real.len());
        let expected = known.value(z) / known.approximations.others(usize::MAX, z) * factor;
        // Guesses close to each other have large corrections that cancel.
        let largest = modes.iter().map(|w| w.norm()).fold(1.0, f64::max);
        prop_assert!((sum - expected).norm() < 1e-10 * largest, "{sum} {expected}");
    }
}

/// Checks that the discs contain all zeros, and a disc that meets no other contains one.
fn check_discs(known: &Known, radii: &[f64]) -> Result<(), TestCaseError> {
    let (zeros, guesses) = (&known.zeros, &known.approximations.sigmas);
    let is_in = |zero: &Complex<f64>, i: usize| (zero - guesses[i]).norm() <= radii[i] * (1.0 + 1e-9) + 1e-13;
    for zero in zeros {
        prop_assert!((0..radii.len()).any(|i| is_in(zero, i)), "{zero} is in no disc");
    }
    for i in 0..radii.len() {
        let meets = |j: usize| j != i && (guesses[i] - guesses[j]).norm() < radii[i] + radii[j];
        let held = zeros.iter().filter(|zero| is_in(zero, i)).count();
        let is_alone = !(0..radii.len()).any(meets);
        prop_assert!(!is_alone || held == 1, "the disc of {} holds {held}", guesses[i]);
        if guesses[i].re > 0.0 {
            prop_assert!(is_alone && radii[i] <= guesses[i].re);
        } else {
            prop_assert!(radii[i] <= -guesses[i].re && radii[i] <= (guesses[i].im - known.apart_from).abs());
        }
    }
    Ok(())
}

#[test]
fn discs_hold_all_zeros_though_values_err_by_a_fifth() {
    let (enclosed, open) = (Cell::new(0), Cell::new(0));
    let check = |(known, errors): (Known, Vec<f64>)| {
        let (corrections, states) = known.corrections();
        let states: Vec<_> = states.iter().map(|(z, w, count)| (*z, count * w.norm())).collect();
        let seen: Vec<_> =
            corrections.iter().zip(errors).map(|(w, angle)| w * (1.0 - Complex::from_polar(0.2, angle))).collect();
        let found = enclosure(Wanted::Growing, &known.approximations.sigmas, &seen, &states, &[known.apart_from]);
        for ((w, radius), share) in corrections.iter().zip(&found.radii).zip(&found.shares) {
            prop_assert!(!w.is_finite() || 2.0 * w.norm() / radius <= *share, "{w} {radius} {share}");
        }
        if found.total >= 1.0 || found.total.is_nan() {
            open.set(open.get() + 1);
            return Ok(());
        }
        check_discs(&known, &found.radii)?;
        let grows = |zeros: &[Complex<f64>]| zeros.iter().filter(|zero| zero.re > 0.0).count();
        prop_assert_eq!(grows(&known.approximations.sigmas), grows(&known.zeros));
        if found.total <= LARGEST_TOTAL_SHARE {
            let smallest: Vec<f64> = found.smallest().collect();
            prop_assert!(smallest.iter().zip(&found.radii).all(|(small, large)| *small <= large * (1.0 + 1e-12)));
            check_discs(&known, &smallest)?;
            enclosed.set(enclosed.get() + 1);
        }
        Ok(())
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let config = Config { failure_persistence: None, ..Config::with_cases(4000) };
    let errors = prop::collection::vec(0.0..std::f64::consts::TAU, 8);
    TestRunner::new_with_rng(config, rng).run(&(known(), errors), check).unwrap();
    println!("{} enclosed, {} open", enclosed.get(), open.get());
    assert!(enclosed.get() > 2000 && open.get() > 500);
}

#[test]
fn the_system_of_a_gain_has_its_feedback() {
    let (structure, feedback, mut work) = (chain(6, 1), feedback(6, 3, 1), Workspace::default());
    let secular = Secular::new(&structure, &feedback, &mut work).unwrap().unwrap();
    for gain in [GAIN, Gain { lag: 0.0, ..GAIN }] {
        assert_eq!(secular.system(&gain), whole(&structure, &feedback, &gain));
        let lambda = Complex::new(-30.0, 2500.0);
        let acting = feedback.reading.map(Complex::from) * Complex::from(gain.mu)
            + feedback.force.transpose().map(Complex::from) * (lambda * gain.complex_slope(lambda));
        let expected = structure.dynamic_stiffness(lambda) + feedback.force.map(Complex::from) * acting;
        let found = secular.system(&gain).dynamic_stiffness(lambda);
        assert!((&found - &expected).norm() < 1e-14 * expected.norm());
    }
}

#[test]
fn internal_states_driven_otherwise_than_those_of_the_anchors_are_enclosed() {
    let (structure, feedback, mut work) = (chain(12, 1), feedback(12, 6, 1), Workspace::default());
    let secular = Secular::new(&structure, &feedback, &mut work).unwrap().unwrap();
    let spectrum = |gain: Gain| QrSolver.eigenvalues(&whole(&structure, &feedback, &gain), &mut Workspace::default());
    let anchors = secular.anchors(&[(GAIN, spectrum(GAIN).unwrap())], &mut work);
    for part in [0.0, 1e-30, 0.2, 1.0, 3.0, 5.0] {
        let gain = Gain { lag: part * GAIN.lag, ..GAIN };
        let found = secular.growing(&anchors, &[(gain, &[])], &mut work).remove(0);
        let found = found.unwrap_or_else(|open| panic!("{open} at {part} times the drive"));
        let expected = spectrum(gain).unwrap().oscillatory().filter(|lambda| lambda.re > 0.0).count();
        assert_eq!(found.frequencies().count(), expected, "{part}");
    }
}
