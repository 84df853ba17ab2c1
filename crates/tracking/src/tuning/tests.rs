//! What each number does at half and at double: printed by `cargo test -p brake-squeal-tracking tuning -- --ignored --nocapture`.

use std::cell::Cell;

use cea::Workspace;
use linsys::SecondOrder;
use nalgebra::DMatrix;

use super::{CHOSEN, Tuning};
use crate::continuation::tests::{by_small_steps, end_of};
use crate::test_modes::modes;
use crate::{Path, PathEnd, PathStart};

thread_local! {
    static USED: Cell<Tuning> = const { Cell::new(CHOSEN) };
}

pub(crate) fn tuning() -> Tuning {
    USED.get()
}

/// A chain of five masses with couplings without symmetry, of 2 `seed` and of 2 `seed` + 1.
fn ends(seed: usize) -> [SecondOrder; 2] {
    let part = |at: usize| (at as f64 * 0.618_033_988_75 + 0.1 * (at * at) as f64).fract();
    [0, 1].map(|end| {
        let number = |at: usize| part(97 * (2 * seed + end) + at);
        let springs: Vec<f64> = (0..6).map(|at| 0.5 + 1.5 * number(at)).collect();
        let k = DMatrix::from_fn(5, 5, |i, j| match i.abs_diff(j) {
            0 => springs[i] + springs[i + 1] + i as f64,
            1 => -springs[i.max(j)],
            _ => 0.0,
        });
        let coupling = DMatrix::from_fn(5, 5, |i, j| 0.8 * (number(10 + 5 * i + j) - 0.5));
        SecondOrder::new(DMatrix::identity(5, 5), &k * (0.01 + 0.05 * number(50)), k + coupling).unwrap()
    })
}

/// Number of modes that reach the end of their path, number of these that do not end where small steps do, and factorisations for each mode.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Effect {
    reached: usize,
    wrong: usize,
    factorisations: f64,
}

#[test]
#[ignore = "a minute: what the chosen numbers do, for the table of Tuning"]
fn at_half_and_at_double() {
    let all: Vec<_> = (0..200).map(ends).filter(|ends| ends.iter().all(|end| modes(end).len() == 5)).collect();
    let starts: Vec<_> = all.iter().map(|[from, _]| modes(from)).collect();
    let paths: Vec<Path<'_>> = all
        .iter()
        .zip(&starts)
        .map(|([from, to], start)| {
            let end = PathEnd { system: to, modes: &[] };
            Path { start: PathStart::System(from), start_modes: start, end }
        })
        .collect();
    let expected: Vec<_> = paths.iter().map(|path| by_small_steps(*path)).collect();
    let effect = |used: Tuning| {
        USED.set(used);
        let (mut effect, mut work) = (Effect { reached: 0, wrong: 0, factorisations: 0.0 }, Workspace::default());
        for ((path, start), expected) in paths.iter().zip(&starts).zip(&expected) {
            for (mode, (end, margin)) in start.iter().zip(expected) {
                let Some(found) = end_of(*path, mode, &mut work) else { continue };
                effect.reached += 1;
                effect.wrong += usize::from(*margin > 30.0 && (found - end).norm() > 1e-4 * end.norm());
            }
        }
        effect.factorisations = work.counters.factorisations as f64 / effect.reached as f64;
        effect
    };
    let total: usize = starts.iter().map(Vec::len).sum();
    let chosen = effect(CHOSEN);
    println!("{total} modes, chosen: {chosen:?}");
    type Change = fn(&mut Tuning, f64);
    let numbers: [(&str, Change); 12] = [
        ("first_step", |t, by| t.first_step *= by),
        ("shortest_step", |t, by| t.shortest_step *= by),
        ("most_attempts", |t, by| t.most_attempts = (t.most_attempts as f64 * by) as usize),
        ("least_mac (its distance from 1)", |t, by| t.least_mac = 1.0 - (1.0 - t.least_mac) * by),
        ("converged", |t, by| t.converged *= by),
        ("most_corrections", |t, by| t.most_corrections = (t.most_corrections as f64 * by) as usize),
        ("largest_error_ratio", |t, by| t.largest_error_ratio *= by),
        ("ratio_safety (its distance from 1)", |t, by| t.ratio_safety = 1.0 + (t.ratio_safety - 1.0) * by),
        ("growth (its distance from 1)", |t, by| t.growth = 1.0 + (t.growth - 1.0) * by),
        ("reduction", |t, by| t.reduction = (t.reduction * by).min(0.95)),
        ("least_reduction", |t, by| t.least_reduction *= by),
        ("negligible_error", |t, by| t.negligible_error *= by),
    ];
    for (name, change) in numbers {
        for by in [0.5, 2.0] {
            let mut used = CHOSEN;
            change(&mut used, by);
            println!("{name} x {by}: {:?}", effect(used));
        }
    }
    assert_eq!(chosen.wrong, 0);
    assert!(chosen.reached > total / 2, "{chosen:?}");
}
