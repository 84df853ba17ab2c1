//! The secular equation against spectra of the whole system.

#![allow(clippy::unwrap_used)]

use std::cell::Cell;

use cea::{CeaError, EigenSolver, Feedback, Gain, Growing, Pilots, QrSolver, Secular, Spectrum, Workspace};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};

/// Pilots of a structure.
const PILOTS: usize = 16;
/// Part of the unit that rounding may move Re lambda by, in either solver: nearer to the axis no verdict is wrong.
const AXIS: f64 = 1e-9;
/// Eigenvalues this near to the axis may be left open.
const NEAR_AXIS: f64 = 2e-6;

/// A structure with feedback.
#[derive(Debug, Clone)]
struct Brake {
    structure: SecondOrder,
    feedback: Feedback,
}

/// A chain between two walls, masses and springs near 1, with dashpots and damping in proportion to the mass.
fn brake(damping: impl Strategy<Value = f64>, dashpots: f64) -> impl Strategy<Value = Brake> {
    let parts = |n: usize, places: usize| {
        let links = || prop::collection::vec(0.5..2.0, n + 1);
        (links(), links(), links(), prop::collection::vec(-1.0..1.0, 2 * n * places), Just((n, places)))
    };
    let sizes = (4..9usize, 1..4usize).prop_flat_map(move |(n, places)| parts(n, places));
    (sizes, damping).prop_map(move |((masses, springs, links, feedback, (n, places)), damping)| {
        let tridiagonal = |link: &[f64]| {
            DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => link[i] + link[i + 1],
                1 => -link[i.max(j)],
                _ => 0.0,
            })
        };
        let m = DMatrix::from_diagonal(&DVector::from_column_slice(&masses[..n]));
        let c = damping * &m + dashpots * tridiagonal(&links);
        let (force, reading) = feedback.split_at(n * places);
        let feedback = Feedback {
            force: DMatrix::from_column_slice(n, places, force),
            reading: DMatrix::from_column_slice(places, n, reading),
        };
        Brake { structure: SecondOrder::new(m, c, tridiagonal(&springs)).unwrap(), feedback }
    })
}

impl Brake {
    fn whole(&self, gain: &Gain) -> SecondOrder {
        let (Feedback { force, reading }, mut system) = (&self.feedback, self.structure.clone());
        system.k += gain.position * force * reading;
        system.c += gain.velocity * force * force.transpose();
        if gain.lag != 0.0 {
            let decay = DVector::from_element(force.ncols(), gain.decay);
            system.internal = Internal { decay, drive: -gain.lag * force.transpose(), force: force.clone() };
        }
        system
    }

    fn spectrum(&self, gain: &Gain) -> Spectrum {
        QrSolver.eigenvalues(&self.whole(gain), &mut Workspace::default()).unwrap()
    }

    /// The modes by QR, ascending in frequency; not what rounding makes of equal internal states.
    fn modes(&self, gain: &Gain) -> Vec<Complex<f64>> {
        self.spectrum(gain).oscillatory().filter(|l| l.im > 1e-4 * l.norm()).collect()
    }

    fn growth(&self, gain: &Gain) -> f64 {
        self.spectrum(gain).eigenvalues.iter().map(|l| l.re).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The first position gain of either sign, up to 10, at which something grows by more than `growth`.
    fn critical(&self, growth: f64) -> Option<f64> {
        let at = |position: f64| Gain { position, ..Gain::default() };
        let grows = |position: f64| self.growth(&at(position)) > growth;
        let upper = (1..1000).map(|i| 0.01 * f64::from(i)).flat_map(|p| [p, -p]).find(|&p| grows(p))?;
        Some(bisect(upper - 0.01 * upper.signum(), upper, grows))
    }

    fn secular(&self) -> Secular {
        Secular::new(&self.structure, &self.feedback, &mut Workspace::default()).unwrap().unwrap()
    }

    fn pilots(&self, secular: &Secular, gains: &[Gain]) -> Pilots {
        let states: Vec<_> = gains.iter().map(|gain| (*gain, self.spectrum(gain))).collect();
        secular.pilots(&states, &mut Workspace::default())
    }
}

fn growing(secular: &Secular, pilots: &Pilots, gains: &[Gain]) -> Vec<Option<Growing>> {
    let gains: Vec<(Gain, &[f64])> = gains.iter().map(|&gain| (gain, &[][..])).collect();
    secular.growing(pilots, &gains, &mut Workspace::default())
}

/// The last number towards `lower` at which it holds, to rounding.
fn bisect(mut lower: f64, mut upper: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (lower + upper);
        *(if holds(middle) { &mut upper } else { &mut lower }) = middle;
    }
    upper
}

/// Gains about the first instability of a structure: unit numbers for position, velocity and decay.
fn gains(brake: &Brake, critical: f64, units: &[[f64; 3]], has_lag: bool) -> Vec<Gain> {
    let size = brake.feedback.force.norm_squared();
    let gain = |&[position, velocity, decay]: &[f64; 3]| {
        let (slope, decay) = (0.02 * velocity / size, 3.0 * 10f64.powf(decay));
        let gain = Gain { position: critical * (1.0 + 0.5 * position), ..Gain::default() };
        if has_lag { Gain { lag: slope * decay, decay, ..gain } } else { Gain { velocity: slope, ..gain } }
    };
    units.iter().map(gain).collect()
}

/// What was found is what QR says.
fn check(found: &Growing, modes: &[Complex<f64>]) -> Result<(), TestCaseError> {
    prop_assert_eq!((found.modes.len(), found.radii.len()), (modes.len(), modes.len()));
    for (rank, (&mode, &radius)) in found.modes.iter().zip(&found.radii).enumerate() {
        let other = |i: usize| (found.modes[i] - mode).norm() < radius + found.radii[i];
        let held = modes.iter().filter(|&&l| (l - mode).norm() <= radius + 1e-9 * l.norm()).count();
        prop_assert!(held > 0, "{mode} +- {radius:e}: {modes:?}");
        if mode.re > 0.0 {
            prop_assert!(radius == 0.0 && (modes[rank] - mode).norm() < 1e-9 * mode.norm(), "{mode}: {modes:?}");
        } else if !(0..modes.len()).any(|i| i != rank && other(i)) {
            prop_assert_eq!(held, 1);
            prop_assert!(radius > 0.0 && mode.re + radius < 0.0);
        }
    }
    let grow = |modes: &[Complex<f64>], than: f64| modes.iter().filter(|mode| mode.re > than).count();
    prop_assert!((grow(modes, AXIS)..=grow(modes, -AXIS)).contains(&grow(&found.modes, 0.0)), "{modes:?}");
    prop_assert_eq!(found.frequencies().count(), grow(&found.modes, 0.0));
    Ok(())
}

fn runner(cases: u32) -> TestRunner {
    let config = Config { failure_persistence: None, ..Config::with_cases(cases) };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}

#[test]
fn growing_modes_are_those_of_the_whole_spectrum() {
    // Gains with growing modes, without, left open though nothing is near the axis, and with something near it or real.
    let (grow, damp, open, special) = (Cell::new(0), Cell::new(0), Cell::new(0), Cell::new(0));
    let add = |count: &Cell<u32>| count.set(count.get() + 1);
    let unit = || (-1.0..1.0, -1.0..1.0, 0.0..1.0).prop_map(|(a, b, c)| [a, b, c]);
    let cases = (brake(0.001..0.05, 0.01), prop::collection::vec(unit(), 2 * PILOTS), any::<bool>());
    let check = |(brake, units, has_lag): (Brake, Vec<[f64; 3]>, bool)| {
        let critical = brake.critical(0.0);
        prop_assume!(critical.is_some());
        let gains = gains(&brake, critical.unwrap(), &units, has_lag);
        let (known, gains) = gains.split_at(PILOTS);
        let secular = brake.secular();
        let pilots = brake.pilots(&secular, known);
        for (gain, found) in gains.iter().zip(growing(&secular, &pilots, gains)) {
            let modes = brake.modes(gain);
            let is_special = modes.len() != brake.structure.order() || modes.iter().any(|l| l.re.abs() < NEAR_AXIS);
            match found {
                Some(found) => {
                    check(&found, &modes)?;
                    add(if found.frequencies().next().is_some() { &grow } else { &damp });
                }
                None => add(if is_special { &special } else { &open }),
            }
        }
        Ok(())
    };
    runner(256).run(&cases, check).unwrap();
    let [grow, damp, open, special] = [grow, damp, open, special].map(|count| count.get());
    println!("{grow} grow, {damp} damp, {open} open, {special} special");
    assert!(grow > 1000 && damp > 1000 && 20 * open < grow + damp);
}

/// What is said of gains next to `at`, at which something changes; `grows` by the side. Those that are left open, and not.
fn check_about(
    pilots: (&Secular, &Pilots),
    at: Gain,
    by: impl Fn(Gain, f64) -> Gain,
    grow: [usize; 2],
) -> Result<[u32; 2], TestCaseError> {
    let mut counts = [0; 2];
    for exponent in 3..=10 {
        for (side, grow) in [-1.0, 1.0].into_iter().zip(grow) {
            let gain = by(at, side * 10f64.powi(-exponent));
            let found = growing(pilots.0, pilots.1, &[gain]).remove(0);
            let number = found.as_ref().map(|found| found.frequencies().count());
            prop_assert!(number.is_none_or(|number| number == grow), "1e-{exponent} to {side}: {number:?}");
            counts[usize::from(found.is_some())] += 1;
        }
    }
    Ok(counts)
}

#[test]
fn next_to_critical_gains_no_verdict_is_wrong() {
    let counts = [const { Cell::new([0; 2]) }; 4];
    let add = |of: usize, more: [u32; 2]| {
        let [open, found] = counts[of].get();
        counts[of].set([open + more[0], found + more[1]]);
    };
    let units = prop::collection::vec((-1.0..1.0, -1.0..1.0).prop_map(|(a, b)| [a, b, 0.0]), PILOTS);
    let check = |(brake, units): (Brake, Vec<[f64; 3]>)| {
        // Damping in proportion to the mass moves all eigenvalues to the left and leaves pairs where they coalesce. Dashpots
        // that differ give the two of a pair frequencies of their own.
        let (mut undamped, mut uneven) = (brake.clone(), brake.clone());
        undamped.structure.c.fill(0.0);
        uneven.structure.c.row_iter_mut().enumerate().for_each(|(i, mut row)| row[i] *= [0.5, 1.5][i % 2]);
        let critical = [undamped.critical(1e-6), uneven.critical(0.0)];
        prop_assume!(critical.iter().all(Option::is_some));
        let [coalescence, threshold] = critical.map(Option::unwrap);
        let position = |position: f64| Gain { position, ..Gain::default() };
        // Flutter of one pair, not divergence, and no other threshold next to it.
        let beyond = uneven.modes(&position(threshold * 1.002));
        prop_assume!(beyond.len() == brake.structure.order());
        prop_assume!(beyond.iter().filter(|mode| mode.re > 0.0).count() == 1);
        prop_assume!(threshold / coalescence > 1.003);

        let nudge = |gain: Gain, part: f64| Gain { position: gain.position * (1.0 + part), ..gain };
        let secular = brake.secular();
        let pilots = brake.pilots(&secular, &gains(&brake, threshold, &units, false));
        add(0, check_about((&secular, &pilots), position(coalescence), nudge, [0, 0])?);

        let (secular, known) = (uneven.secular(), gains(&uneven, threshold, &units, false));
        let pilots = uneven.pilots(&secular, &known);
        add(1, check_about((&secular, &pilots), position(threshold), nudge, [0, 1])?);
        prop_assert_eq!(growing(&secular, &pilots, &[position(threshold)]), [None]);

        // None is surely damped.
        let (secular, known) = (undamped.secular(), gains(&undamped, threshold, &units, false));
        let pilots = undamped.pilots(&secular, &known);
        let counts = check_about((&secular, &pilots), position(coalescence), nudge, [0, 1])?;
        prop_assert_eq!(counts[1], 0);
        add(2, counts);

        // A dashpot of negative damping in the places of friction.
        let velocity = |velocity: f64| Gain { velocity, ..Gain::default() };
        let grows = |v: f64| brake.growth(&velocity(v)) > 0.0;
        let upper = (1..).map(|i| -1e-3 * f64::from(i)).find(|&v| grows(v)).unwrap();
        let critical = bisect(upper + 1e-3, upper, grows);
        let secular = brake.secular();
        let pilots = brake.pilots(&secular, &[0.5, 0.9, 1.1].map(|part| velocity(part * critical)));
        let nudge = |gain: Gain, part: f64| Gain { velocity: gain.velocity * (1.0 + part), ..gain };
        add(3, check_about((&secular, &pilots), velocity(critical), nudge, [0, 1])?);
        prop_assert_eq!(growing(&secular, &pilots, &[velocity(critical)]), [None]);
        Ok(())
    };
    runner(64).run(&(brake(0.03..0.1, 0.0), units), check).unwrap();
    let counts = counts.map(|count| count.get());
    println!("[open, found] next to coalescences, thresholds, undamped, velocities: {counts:?}");
    let [coalescences, thresholds, _, velocities] = counts;
    assert!(coalescences[1] > 10 * coalescences[0] && thresholds[1] > 100 && velocities[1] > 100);
}

fn bits(found: &[Option<Growing>]) -> Vec<Option<Vec<[u64; 3]>>> {
    let mode = |(l, radius): (&Complex<f64>, &f64)| [l.re.to_bits(), l.im.to_bits(), radius.to_bits()];
    let of = |found: &Growing| found.modes.iter().zip(&found.radii).map(mode).collect();
    found.iter().map(|found| found.as_ref().map(of)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn what_is_found_depends_on_no_other_gain(
        brake in brake(0.001..0.05, 0.01),
        units in prop::collection::vec((-1.0..1.0, -1.0..1.0, 0.0..1.0).prop_map(|(a, b, c)| [a, b, c]), 2 * PILOTS),
        order in Just((0..PILOTS + 1).collect::<Vec<_>>()).prop_shuffle(),
        count in 1..PILOTS + 2,
    ) {
        let (known, mut asked) = (gains(&brake, 0.5, &units[..PILOTS], true), gains(&brake, 0.5, &units, true));
        let secular = brake.secular();
        let pilots = brake.pilots(&secular, &known);
        asked.drain(..PILOTS);
        // Without internal states, and one that spoils whatever it meets.
        asked[3] = Gain { position: 0.4, ..Gain::default() };
        asked.push(Gain { position: f64::NAN, ..Gain::default() });
        let alone: Vec<_> = asked.iter().flat_map(|gain| growing(&secular, &pilots, &[*gain])).collect();
        prop_assert!(alone[PILOTS].is_none());
        let some: Vec<Gain> = order[..count].iter().map(|&at| asked[at]).collect();
        let expected: Vec<_> = order[..count].iter().map(|&at| alone[at].clone()).collect();
        prop_assert_eq!(bits(&growing(&secular, &pilots, &some)), bits(&expected));
    }
}

#[test]
fn bounds_keep_from_the_frequencies_that_are_asked_for() {
    let (kept, open) = (Cell::new(0), Cell::new(0));
    let check = |(brake, position, mode, offset): (Brake, f64, usize, f64)| {
        let gain = Gain { position, ..Gain::default() };
        let secular = brake.secular();
        let known: Vec<Gain> = [0.0, 0.3, 0.6].map(|position| Gain { position, ..gain }).into();
        let pilots = brake.pilots(&secular, &known);
        let Some(free) = growing(&secular, &pilots, &[gain]).remove(0) else { return Ok(()) };
        let mode = mode % free.modes.len();
        prop_assume!(free.modes[mode].re < 0.0 && free.radii[mode] > 1e-6);
        let frequency = [free.modes[mode].im + offset * free.radii[mode]];
        prop_assert!(free.blurs(&frequency));
        let work = &mut Workspace::default();
        match secular.growing(&pilots, &[(gain, &frequency[..])], work).remove(0) {
            Some(found) => {
                prop_assert!(!found.blurs(&frequency));
                check(&found, &brake.modes(&gain))?;
                kept.set(kept.get() + 1);
            }
            None => open.set(open.get() + 1),
        }
        // A mode is not kept from its own frequency.
        let modes = brake.modes(&gain);
        let own = secular.growing(&pilots, &[(gain, &[modes[mode].im])], work).remove(0);
        prop_assert!(own.is_none());
        Ok(())
    };
    let cases = (brake(0.001..0.05, 0.01), 0.0..0.8, 0..8usize, -0.9..0.9);
    runner(128).run(&cases, check).unwrap();
    println!("{} kept, {} open", kept.get(), open.get());
    assert!(kept.get() > 50 && kept.get() > 20 * open.get());
}

#[test]
fn without_pilots_nothing_is_found_and_feedback_must_fit() {
    let cases = brake(0.001..0.05, 0.01);
    let check = |brake: Brake| {
        let secular = brake.secular();
        let gain = Gain { position: 0.1, ..Gain::default() };
        let none = brake.pilots(&secular, &[]);
        prop_assert_eq!(growing(&secular, &none, &[gain, gain]), [None, None]);
        // An overdamped state is no pilot.
        let overdamped = Gain { velocity: 1e4, ..gain };
        let none = brake.pilots(&secular, &[overdamped]);
        prop_assert_eq!(growing(&secular, &none, &[gain]), [None]);
        prop_assert!(growing(&secular, &brake.pilots(&secular, &[gain]), &[]).is_empty());

        let order = brake.structure.order();
        let Feedback { force, reading } = &brake.feedback;
        let misfits = [
            Feedback { force: force.clone().insert_row(0, 1.0), reading: reading.clone() },
            Feedback { force: force.clone(), reading: reading.clone().insert_column(0, 1.0) },
            Feedback { force: force.clone().insert_column(0, 1.0), reading: reading.clone() },
        ];
        for misfit in misfits {
            let refused = Secular::new(&brake.structure, &misfit, &mut Workspace::default());
            prop_assert_eq!(refused, Err(CeaError::Channels { order, states: 0 }));
        }
        Ok(())
    };
    runner(8).run(&cases, check).unwrap();
}
