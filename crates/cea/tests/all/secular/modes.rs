//! Shapes, derivatives and slowly decaying modes against QR and factorisations.

use std::cell::Cell;

use cea::{Gain, Mode, Workspace, backward_error};
use linsys::SecondOrder;
use num_complex::Complex;
use proptest::prelude::*;

use super::NEAR_AXIS;
use super::chains::{ANCHORS, Brake, brake, gains, runner};

/// Chains, each with gains about its first instability, with and without internal states.
fn cases() -> impl Strategy<Value = (Brake, Vec<[f64; 3]>, bool)> {
    let unit = (-1.0..1.0, -1.0..1.0, 0.0..1.0).prop_map(|(a, b, c)| [a, b, c]);
    (brake(0.001..0.05, 0.01), prop::collection::vec(unit, 2 * ANCHORS), any::<bool>())
}

/// The distance of the nearest other eigenvalue.
fn nearest(lambda: Complex<f64>, others: &[Complex<f64>]) -> f64 {
    others.iter().map(|other| (other - lambda).norm()).filter(|&d| d > 0.0).fold(f64::INFINITY, f64::min)
}

#[test]
fn shapes_are_those_of_the_whole_system() {
    let (growing, others, open) = (Cell::new(0), Cell::new(0), Cell::new(0));
    let (worst_mac, worst_error) = (Cell::new(0.0_f64), Cell::new(0.0_f64));
    let check = |(brake, units, has_lag): (Brake, Vec<[f64; 3]>, bool)| {
        let critical = brake.critical(0.0);
        prop_assume!(critical.is_some());
        let gains = gains(&brake, critical.unwrap(), &units, has_lag);
        let (secular, mut work) = (brake.secular(), Workspace::default());
        let states: Vec<(SecondOrder, Vec<Complex<f64>>)> =
            gains.iter().map(|gain| (brake.whole(gain), brake.modes(gain))).collect();
        // All gains in one call: their growing modes, and all their modes.
        let grow: Vec<Vec<Complex<f64>>> =
            states.iter().map(|(_, modes)| modes.iter().copied().filter(|mode| mode.re > 0.0).collect()).collect();
        let few = states.iter().zip(&gains).zip(&grow).map(|(((system, _), gain), grow)| (system, (*gain, &grow[..])));
        let all = states.iter().zip(&gains).map(|((system, modes), gain)| (system, (*gain, &modes[..])));
        let asked: Vec<_> = few.chain(all).collect();
        let found = secular.modes(&asked.iter().map(|(_, asked)| *asked).collect::<Vec<_>>(), &mut work);
        prop_assert_eq!(found.len(), asked.len());
        let shapes: usize = found.iter().flatten().map(Vec::len).sum();
        prop_assert_eq!((work.counters.eigenvectors, work.counters.factorisations), (shapes as u64, 0));
        for ((system, (gain, lambdas)), found) in asked.into_iter().zip(found) {
            let Some(found) = found else {
                open.set(open.get() + 1);
                continue;
            };
            prop_assert_eq!(found.len(), lambdas.len());
            let expected = Mode::at(system, lambdas, &mut work).unwrap();
            for ((found, expected), &lambda) in found.iter().zip(&expected).zip(lambdas) {
                prop_assert_eq!(found.lambda, lambda);
                let mac = found.shape.dotc(&(system.m.map(Complex::from) * &expected.shape)).norm_sqr();
                let apart = 1.0 - mac;
                let error = backward_error(system, lambda, &found.shape);
                worst_mac.set(worst_mac.get().max(apart));
                worst_error.set(worst_error.get().max(error));
                prop_assert!(apart.abs() < 1e-8 && error < 1e-8, "{lambda}: MAC 1 - {apart:e}, {error:e}, {gain:?}");
                prop_assert!((cea::mass_norm_squared(&system.m, &found.shape) - 1.0).abs() < 1e-12);
                let count = if lambda.re > 0.0 { &growing } else { &others };
                count.set(count.get() + 1);
            }
        }
        Ok(())
    };
    runner(96).run(&cases(), check).unwrap();
    let [growing, others, open] = [growing, others, open].map(|count| count.get());
    println!("{growing} grow, {others} damp, {open} states open; {:e}, {:e}", worst_mac.get(), worst_error.get());
    assert!(growing > 1000 && others > 1000 && 20 * open < growing);
}

#[test]
fn eigenvalues_that_are_nearly_one_have_no_shapes_of_their_own() {
    let seen = Cell::new(0);
    let check = |(brake, units, has_lag): (Brake, Vec<[f64; 3]>, bool)| {
        let gain = gains(&brake, 0.5, &units[..1], has_lag)[0];
        let modes = brake.modes(&gain);
        let is_alone = modes.iter().all(|&mode| nearest(mode, &modes) > 1e-2 * mode.norm());
        prop_assume!(modes.len() == brake.structure.order() && is_alone);
        let (secular, mut work) = (brake.secular(), Workspace::default());
        for &lambda in &modes {
            let next = [1e-7, 1e-10, 0.0].map(|apart| lambda * (1.0 + apart));
            let pairs = next.map(|next| [lambda, next]);
            // Results do not depend on the other gains of a call.
            let asked = [&modes[..], &pairs[0], &[lambda], &pairs[1], &pairs[2], &modes[..]];
            let found = secular.modes(&asked.map(|lambdas| (gain, lambdas)), &mut work);
            let is_some: Vec<bool> = found.iter().map(Option::is_some).collect();
            prop_assert_eq!(is_some, [true, false, true, false, false, true]);
            prop_assert_eq!(&found[0], &found[5]);
            // A number that is no eigenvalue has no shape.
            let aside = [lambda * 1.001];
            prop_assert_eq!(secular.modes(&[(gain, &aside[..])], &mut work), [None]);
            seen.set(seen.get() + 1);
        }
        Ok(())
    };
    runner(64).run(&cases(), check).unwrap();
    assert!(seen.get() > 100, "{}", seen.get());
}

/// The central difference of the eigenvalue nearest to this one over a step of the gain.
fn difference(brake: &Brake, lambda: Complex<f64>, step: f64, by: impl Fn(f64) -> Gain) -> Complex<f64> {
    let at = |step: f64| {
        let distance = |l: &Complex<f64>| (l - lambda).norm();
        brake.modes(&by(step)).into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
    };
    (at(step) - at(-step)) / (2.0 * step)
}

#[test]
fn rates_are_the_limits_of_differences() {
    let (plain, lagging, worst) = (Cell::new(0), Cell::new(0), Cell::new(0.0_f64));
    let check = |(brake, units, has_lag): (Brake, Vec<[f64; 3]>, bool)| {
        let critical = brake.critical(0.0);
        prop_assume!(critical.is_some());
        let secular = brake.secular();
        for gain in gains(&brake, critical.unwrap(), &units[..4], has_lag) {
            let modes = brake.modes(&gain);
            let asked: Vec<_> = modes.iter().map(|&lambda| (gain, lambda)).collect();
            let rates = secular.rates(&asked, &mut Workspace::default());
            prop_assert_eq!(rates.len(), modes.len());
            for (&lambda, found) in modes.iter().zip(rates) {
                // Next to another eigenvalue a difference is no approximation of the derivative.
                if nearest(lambda, &modes) < 0.1 * lambda.norm() {
                    continue;
                }
                let steps =
                    [critical.unwrap().abs(), 1.0 / brake.feedback.force.norm_squared()].map(|size| 1e-4 * size);
                let by = [
                    difference(&brake, lambda, steps[0], |p| Gain { mu: gain.mu + p, ..gain }),
                    difference(&brake, lambda, steps[1], |v| Gain { slope: gain.slope + v, ..gain }),
                ];
                // The slope depends on the eigenvalue: d lambda = rate (d v + slope' d lambda).
                let slope = -gain.lag / (lambda + gain.decay).powi(2);
                for (found, by_step) in found.iter().zip(by.map(|rate| rate / (1.0 + by[1] * slope))) {
                    let error = (found - by_step).norm() / (by_step.norm() + 1e-3);
                    worst.set(worst.get().max(error));
                    prop_assert!(error < 1e-5, "{lambda}: {found} {by_step}, {gain:?}");
                }
                let count = if has_lag { &lagging } else { &plain };
                count.set(count.get() + 1);
            }
        }
        Ok(())
    };
    runner(64).run(&cases(), check).unwrap();
    println!("{} plain, {} with lag, {:e}", plain.get(), lagging.get(), worst.get());
    assert!(plain.get() > 300 && lagging.get() > 300);
}

#[test]
fn modes_near_the_axis_are_all_that_are_there() {
    let (near, far, open, special) = (Cell::new(0), Cell::new(0), Cell::new(0), Cell::new(0));
    let add = |count: &Cell<usize>, more: usize| count.set(count.get() + more);
    let check = |((brake, units, has_lag), part): ((Brake, Vec<[f64; 3]>, bool), f64)| {
        let critical = brake.critical(0.0);
        prop_assume!(critical.is_some());
        let gains = gains(&brake, critical.unwrap(), &units, has_lag);
        let (known, gains) = gains.split_at(ANCHORS);
        let secular = brake.secular();
        let anchors = brake.anchors(&secular, known);
        let found = secular.near_axis(&anchors, gains, part, &mut Workspace::default());
        prop_assert_eq!(found.len(), gains.len());
        for (gain, found) in gains.iter().zip(found) {
            let modes = brake.modes(gain);
            let Ok(found) = found else {
                let is_special = modes.len() != brake.structure.order() || modes.iter().any(|l| l.re.abs() < NEAR_AXIS);
                add(if is_special { &special } else { &open }, 1);
                continue;
            };
            let (expected, others): (Vec<_>, Vec<_>) = modes.iter().partition(|mode| mode.re > -part * mode.norm());
            let is_it = |(a, b): (&Complex<f64>, &Complex<f64>)| (a - b).norm() < 1e-9 * b.norm();
            let are_all = found.len() == expected.len() && found.iter().zip(&expected).all(is_it);
            prop_assert!(are_all, "{found:?} of {modes:?}, {part}");
            add(&near, expected.len());
            add(&far, others.len());
        }
        Ok(())
    };
    runner(256).run(&(cases(), 0.002..0.05), check).unwrap();
    let [near, far, open, special] = [near, far, open, special].map(|count| count.get());
    println!("{near} near, {far} not, {open} states open, {special} special");
    assert!(near > 1000 && far > 1000 && 100 * open < near);
}
