//! Paths evaluated by the secular equation against the same paths evaluated by matrices.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

#[allow(dead_code)] // Shared with the tests of the secular equation; not all of it is used here.
#[path = "../../cea/tests/all/secular/chains.rs"]
mod chains;

use std::cell::Cell;
use std::ops::Range;

use cea::{Counters, Feedback, Gain, GainPath, Mode, QrSolver, Secular, Workspace};
use chains::{Brake, brake, runner};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use proptest::prelude::*;
use tracking::{Links, Path, PathEnd, PathStart, follow, identify};

/// One end of a path: a gain, its system and the system's modes.
struct End {
    gain: Gain,
    system: SecondOrder,
    modes: Vec<Mode>,
}

impl End {
    fn new(brake: &Brake, gain: Gain) -> Self {
        let (system, lambdas) = (brake.whole(&gain), brake.modes(&gain));
        let modes = Mode::at(&system, &lambdas, &mut Workspace::default()).unwrap();
        Self { gain, system, modes }
    }
}

/// The links of a path and their cost, by the secular equation where `secular` is given and by matrices otherwise.
fn linked(ends: &[End; 2], secular: Option<&Secular>, near: bool) -> (Links, Counters) {
    let [from, to] = ends;
    let gains = secular.map(|secular| PathStart::Gain(GainPath { secular, from: from.gain, to: to.gain }));
    let start = gains.unwrap_or(PathStart::System(&from.system));
    let end = PathEnd { system: &to.system, modes: &to.modes };
    let path = Path { start, start_modes: &from.modes, end };
    let mut work = Workspace::default();
    let links = if near { identify } else { follow }(&QrSolver, path, &mut work).unwrap();
    (links, work.counters)
}

/// Numbers of compared paths and modes.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    paths: usize,
    modes: usize,
    /// Modes whose rank by frequency changes.
    crossed: usize,
    /// Modes that had to be followed.
    followed: u64,
    /// Paths on which some mode was left to subdivision.
    subdivided: usize,
    /// Paths whose links by the two evaluations differ: only where one of them needed subdivision, which leaves more modes open
    /// next to coalescences than pair continuation does.
    differ: usize,
}

/// Links paths by the secular equation and by matrices, and compares.
fn compare(cases: impl Strategy<Value = (Brake, [Gain; 2])>, near: bool) -> Count {
    let count = Cell::new(Count::default());
    let check = |(brake, gains): (Brake, [Gain; 2])| {
        let secular = brake.secular();
        let ends = gains.map(|gain| End::new(&brake, gain));
        prop_assume!(ends.iter().all(|end| end.modes.len() == brake.structure.order()));
        let (by_gains, of_gains) = linked(&ends, Some(&secular), near);
        let (by_system, of_system) = linked(&ends, None, near);
        prop_assert_eq!(of_gains.continuations, of_system.continuations);
        prop_assert_eq!(of_gains.secular_values > 0, of_gains.continuations > 0);
        prop_assert_eq!(of_system.secular_values, 0);
        // Only continuation by matrices costs factorisations.
        prop_assert_eq!(of_system.factorisations > 0, of_system.continuations > 0);
        let [is_subdivided, other] = [of_gains, of_system].map(|counters| counters.eigenvalue_solves > 0);
        if !is_subdivided {
            prop_assert_eq!((of_gains.factorisations, of_gains.eigenvectors), (0, 0));
            prop_assert!(other || by_gains == by_system, "{by_gains:?} {by_system:?}");
        }
        let Count { paths, modes, crossed, followed, subdivided, differ } = count.get();
        count.set(Count {
            paths: paths + 1,
            modes: modes + by_gains.len(),
            crossed: crossed + by_gains.iter().enumerate().filter(|(i, to)| to.iter().all(|to| to != i)).count(),
            followed: followed + of_gains.continuations,
            subdivided: subdivided + usize::from(is_subdivided),
            differ: differ + usize::from(by_gains != by_system),
        });
        Ok(())
    };
    runner(256).run(&cases, check).unwrap();
    println!("{near}: {:?}", count.get());
    count.get()
}

/// A chain, and the gains at the two ends of a path: each has `part * mu`, and a slope or lag in proportion to the part.
fn path(brake: Brake, parts: [f64; 2], mu: f64, has_lag: bool) -> (Brake, [Gain; 2]) {
    let size = brake.feedback.force.norm_squared();
    let gains = parts.map(|part| {
        let gain = Gain { mu: part * mu, ..Gain::default() };
        match has_lag {
            true => Gain { lag: 0.1 * part / size, decay: 4.0 + part, ..gain },
            false => Gain { slope: 0.02 * part / size, ..gain },
        }
    });
    (brake, gains)
}

/// A small and a large part of mu for the two ends of a path, in either order.
fn parts(small: Range<f64>, large: Range<f64>) -> impl Strategy<Value = [f64; 2]> {
    (small, large, any::<bool>()).prop_map(|(a, b, is_back)| if is_back { [b, a] } else { [a, b] })
}

/// Springs in place of friction: frequencies veer, or cross where damping keeps the eigenvalues apart.
fn veering() -> impl Strategy<Value = (Brake, [Gain; 2])> {
    (brake(0.001..0.05, 0.01), parts(0.0..0.3, 1.0..3.0), any::<bool>()).prop_map(|(mut brake, parts, has_lag)| {
        brake.feedback.reading = brake.feedback.force.transpose();
        path(brake, parts, 1.0, has_lag)
    })
}

/// Two uncoupled chains, with springs in place of friction in one: its frequencies cross those of the other.
fn crossing() -> impl Strategy<Value = (Brake, [Gain; 2])> {
    let both = (brake(0.001..0.05, 0.01), brake(0.001..0.05, 0.01));
    (both, parts(0.0..0.3, 1.0..3.0), any::<bool>()).prop_map(|((one, other), parts, has_lag)| {
        let [first, all] = [one.structure.order(), one.structure.order() + other.structure.order()];
        let both = |a: &DMatrix<f64>, b: &DMatrix<f64>| {
            let mut both = a.clone().resize(all, all, 0.0);
            both.view_mut((first, first), b.shape()).copy_from(b);
            both
        };
        let [a, b] = [&one.structure, &other.structure];
        let structure = SecondOrder::new(both(&a.m, &b.m), both(&a.c, &b.c), both(&a.k, &b.k)).unwrap();
        let force = one.feedback.force.resize_vertically(all, 0.0);
        let feedback = Feedback { reading: force.transpose(), force };
        path(Brake { structure, feedback }, parts, 1.0, has_lag)
    })
}

/// Friction between 0 and 1.5 times the mu of the first instability.
fn coalescing() -> impl Strategy<Value = (Brake, [Gain; 2])> {
    (brake(0.001..0.05, 0.01), parts(0.0..0.5, 0.5..1.5), any::<bool>()).prop_map(|(brake, parts, has_lag)| {
        let critical = brake.critical(0.0).unwrap_or(1.0);
        path(brake, parts, critical, has_lag)
    })
}

#[test]
fn the_secular_equation_links_modes_as_matrices_do() {
    let [veering, coalescing] =
        [[true, false].map(|near| compare(veering(), near)), [true, false].map(|near| compare(coalescing(), near))];
    let crossing = compare(crossing(), true);
    for count in [veering, coalescing].into_iter().flatten().chain([crossing]) {
        assert!(count.paths > 200 && count.followed > 100 && count.crossed > 20, "{count:?}");
        assert!(10 * count.subdivided < count.paths && 50 * count.differ < count.paths, "{count:?}");
    }
    for [_, far] in [veering, coalescing] {
        assert_eq!(far.followed, far.modes as u64);
    }
}
