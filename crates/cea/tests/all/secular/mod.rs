//! The secular equation against spectra of the whole system.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

mod chains;
mod critical;
mod kinds;
mod modes;

use std::cell::Cell;

use cea::{CeaError, Feedback, Gain, Growing, LeftOpen, Secular, Workspace};
use chains::{ANCHORS, Brake, brake, gains, growing, runner};
use num_complex::Complex;
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// Largest error of Re lambda by rounding in either solver, in units: nearer to the axis no verdict is checked.
const AXIS: f64 = 1e-9;
/// Largest distance from the axis at which a mode may be left open, in units.
const NEAR_AXIS: f64 = 2e-6;

/// Checks the modes found against those by QR.
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

#[test]
fn growing_modes_are_those_of_the_whole_spectrum() {
    // Numbers of gains: with growing modes; without; left open with no mode near the axis; with a mode near the axis or real.
    let (grow, damp, open, special) = (Cell::new(0), Cell::new(0), Cell::new(0), Cell::new(0));
    let add = |count: &Cell<u32>| count.set(count.get() + 1);
    let unit = || (-1.0..1.0, -1.0..1.0, 0.0..1.0).prop_map(|(a, b, c)| [a, b, c]);
    let cases = (brake(0.001..0.05, 0.01), prop::collection::vec(unit(), 2 * ANCHORS), any::<bool>());
    let check = |(brake, units, has_lag): (Brake, Vec<[f64; 3]>, bool)| {
        let critical = brake.critical(0.0);
        prop_assume!(critical.is_some());
        let gains = gains(&brake, critical.unwrap(), &units, has_lag);
        let (known, gains) = gains.split_at(ANCHORS);
        let secular = brake.secular();
        let anchors = brake.anchors(&secular, known);
        for (gain, found) in gains.iter().zip(growing(&secular, &anchors, gains)) {
            let modes = brake.modes(gain);
            let is_special = modes.len() != brake.structure.order() || modes.iter().any(|l| l.re.abs() < NEAR_AXIS);
            match found {
                Ok(found) => {
                    check(&found, &modes)?;
                    add(if found.frequencies().next().is_some() { &grow } else { &damp });
                }
                Err(_) => add(if is_special { &special } else { &open }),
            }
        }
        Ok(())
    };
    runner(256).run(&cases, check).unwrap();
    let [grow, damp, open, special] = [grow, damp, open, special].map(|count| count.get());
    println!("{grow} grow, {damp} damp, {open} open, {special} special");
    assert!(grow > 1000 && damp > 1000 && 20 * open < grow + damp);
}

fn bits(found: &[Result<Growing, LeftOpen>]) -> Vec<Result<Vec<[u64; 3]>, LeftOpen>> {
    let mode = |(l, radius): (&Complex<f64>, &f64)| [l.re.to_bits(), l.im.to_bits(), radius.to_bits()];
    let of = |found: &Growing| found.modes.iter().zip(&found.radii).map(mode).collect();
    found.iter().map(|found| found.as_ref().map(of).map_err(|open| *open)).collect()
}

#[test]
fn what_is_found_depends_on_no_other_gain() {
    let unit = (-1.0..1.0, -1.0..1.0, 0.0..1.0).prop_map(|(a, b, c)| [a, b, c]);
    let order = Just((0..ANCHORS + 1).collect::<Vec<_>>()).prop_shuffle();
    let units = prop::collection::vec(unit, 2 * ANCHORS);
    let check = |(brake, units, order, count): (Brake, Vec<[f64; 3]>, Vec<usize>, usize)| {
        let critical = brake.critical(0.0).unwrap_or(0.5);
        let mut known = gains(&brake, critical, &units, true);
        let mut asked = known.split_off(ANCHORS);
        let secular = brake.secular();
        let anchors = brake.anchors(&secular, &known);
        // A gain without internal states, and one with NaN that must not affect the others.
        asked[3] = Gain { mu: 0.8 * critical, ..Gain::default() };
        asked.push(Gain { mu: f64::NAN, ..Gain::default() });
        let alone: Vec<_> = asked.iter().flat_map(|gain| growing(&secular, &anchors, &[*gain])).collect();
        prop_assert!(alone[ANCHORS].is_err() && alone.iter().flatten().count() > 0);
        let some: Vec<Gain> = order[..count].iter().map(|&at| asked[at]).collect();
        let expected: Vec<_> = order[..count].iter().map(|&at| alone[at].clone()).collect();
        prop_assert_eq!(bits(&growing(&secular, &anchors, &some)), bits(&expected));
        Ok(())
    };
    runner(32).run(&(brake(0.001..0.05, 0.01), units, order, 1..ANCHORS + 2), check).unwrap();
}

#[test]
fn bounds_keep_from_the_frequencies_that_are_asked_for() {
    let (kept, open) = (Cell::new(0), Cell::new(0));
    let check = |(brake, mu, mode, offset): (Brake, f64, usize, f64)| {
        let gain = Gain { mu, ..Gain::default() };
        let secular = brake.secular();
        let known: Vec<Gain> = [0.0, 0.3, 0.6].map(|mu| Gain { mu, ..gain }).into();
        let anchors = brake.anchors(&secular, &known);
        let Ok(free) = growing(&secular, &anchors, &[gain]).remove(0) else { return Ok(()) };
        let mode = mode % free.modes.len();
        prop_assume!(free.modes[mode].re < 0.0 && free.radii[mode] > 1e-6);
        let frequency = [free.modes[mode].im + offset * free.radii[mode]];
        prop_assert!(free.leaves_order_open(&frequency));
        let work = &mut Workspace::default();
        match secular.growing(&anchors, &[(gain, &frequency[..])], work).remove(0) {
            Ok(found) => {
                prop_assert!(!found.leaves_order_open(&frequency));
                check(&found, &brake.modes(&gain))?;
                kept.set(kept.get() + 1);
            }
            Err(_) => open.set(open.get() + 1),
        }
        // The bound of a mode cannot exclude the mode's own frequency.
        let modes = brake.modes(&gain);
        let own = secular.growing(&anchors, &[(gain, &[modes[mode].im])], work).remove(0);
        prop_assert!(matches!(own, Err(LeftOpen::NotSeparated | LeftOpen::RoundsExhausted { .. })), "{own:?}");
        Ok(())
    };
    let cases = (brake(0.001..0.05, 0.01), 0.0..0.8, 0..8usize, -0.9..0.9);
    runner(128).run(&cases, check).unwrap();
    println!("{} kept, {} open", kept.get(), open.get());
    assert!(kept.get() > 50 && kept.get() > 20 * open.get());
}

#[test]
fn without_anchors_nothing_is_found_and_feedback_must_fit() {
    let cases = brake(0.001..0.05, 0.01);
    let check = |brake: Brake| {
        let secular = brake.secular();
        let gain = Gain { mu: 0.1, ..Gain::default() };
        let none = brake.anchors(&secular, &[]);
        prop_assert_eq!(growing(&secular, &none, &[gain, gain]), [Err(LeftOpen::NoAnchor), Err(LeftOpen::NoAnchor)]);
        // A gain with an overdamped mode is no anchor.
        let overdamped = Gain { slope: 1e4, ..gain };
        let none = brake.anchors(&secular, &[overdamped]);
        prop_assert_eq!(growing(&secular, &none, &[gain]), [Err(LeftOpen::NoAnchor)]);
        prop_assert!(growing(&secular, &brake.anchors(&secular, &[gain]), &[]).is_empty());

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

#[test]
fn guesses_from_anchors_leave_little_to_correct() {
    let (modes, values) = (Cell::new(0), Cell::new(0));
    let check = |brake: Brake| {
        let (secular, size) = (brake.secular(), brake.feedback.force.norm_squared());
        let critical = brake.critical(0.0).unwrap_or(1.0);
        let gain = |mu: f64, slope: f64| Gain { mu: mu * critical, slope: slope * 0.05 / size, ..Gain::default() };
        let anchors = brake.anchors(&secular, &[gain(0.2, 0.2), gain(0.5, 0.8)]);
        let mut work = Workspace::default();
        for gain in [gain(0.1, 0.0), gain(0.35, 0.5), gain(0.6, 1.0)] {
            let found = secular.growing(&anchors, &[(gain, &[])], &mut work).remove(0);
            prop_assert!(found.ok().is_none_or(|found| found.frequencies().next().is_none()));
            modes.set(modes.get() + brake.structure.order());
        }
        values.set(values.get() + work.counters.secular_values);
        Ok(())
    };
    runner(64).run(&brake(0.01..0.05, 0.01), check).unwrap();
    let part = values.get() as f64 / modes.get() as f64;
    println!("{part} values for each mode");
    assert!(part < 1.1);
}
