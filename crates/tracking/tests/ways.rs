//! Ways along lines of gains against the same ways through whole systems.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

#[allow(dead_code)] // The chains that the tests of the secular equation use, of which these need few.
#[path = "../../cea/tests/secular/brake.rs"]
mod brake;

use std::cell::Cell;
use std::ops::Range;

use brake::{Brake, brake, runner};
use cea::{Counters, Feedback, Gain, Line, Mode, QrSolver, Secular, Workspace};
use linsys::SecondOrder;
use nalgebra::DMatrix;
use proptest::prelude::*;
use tracking::{Links, Start, Way, follow, identify};

/// One end of a way: a gain, its system and the system's modes.
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

/// The links of a way and what they cost, as a line of gains or without one.
fn linked(ends: &[End; 2], line: Option<&Secular>, near: bool) -> (Links, Counters) {
    let [from, to] = ends;
    let line = line.map(|secular| Start::Line(Line { secular, from: from.gain, to: to.gain }));
    let start = line.unwrap_or(Start::System(&from.system));
    let way = Way { from: (start, &from.modes), to: (&to.system, &to.modes) };
    let mut work = Workspace::default();
    let links = if near { identify } else { follow }(&QrSolver, way, &mut work).unwrap();
    (links, work.counters)
}

/// What was compared.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    ways: usize,
    modes: usize,
    /// Modes that change places with others by frequency.
    crossed: usize,
    /// Modes that had to be followed.
    followed: u64,
    /// Ways on which some mode was left to spectra.
    walked: usize,
    /// Ways linked otherwise than without a line: only where one of the two was left to spectra, which leave more names open
    /// next to coalescences than pairs do.
    differ: usize,
}

/// Compares ways with and without a line.
fn compare(cases: impl Strategy<Value = (Brake, [Gain; 2])>, near: bool) -> Count {
    let count = Cell::new(Count::default());
    let check = |(brake, gains): (Brake, [Gain; 2])| {
        let secular = brake.secular();
        let ends = gains.map(|gain| End::new(&brake, gain));
        prop_assume!(ends.iter().all(|end| end.modes.len() == brake.structure.order()));
        let (by_line, of_line) = linked(&ends, Some(&secular), near);
        let (by_system, of_system) = linked(&ends, None, near);
        prop_assert_eq!(of_line.continuations, of_system.continuations);
        prop_assert_eq!(of_line.secular_values > 0, of_line.continuations > 0);
        prop_assert_eq!(of_system.secular_values, 0);
        // Tracing costs factorisations without a line only.
        prop_assert_eq!(of_system.factorisations > 0, of_system.continuations > 0);
        let [is_walked, other] = [of_line, of_system].map(|counters| counters.eigenvalue_solves > 0);
        if !is_walked {
            prop_assert_eq!((of_line.factorisations, of_line.eigenvectors), (0, 0));
            prop_assert!(other || by_line == by_system, "{by_line:?} {by_system:?}");
        }
        let Count { ways, modes, crossed, followed, walked, differ } = count.get();
        count.set(Count {
            ways: ways + 1,
            modes: modes + by_line.len(),
            crossed: crossed + by_line.iter().enumerate().filter(|(i, to)| to.iter().all(|to| to != i)).count(),
            followed: followed + of_line.continuations,
            walked: walked + usize::from(is_walked),
            differ: differ + usize::from(by_line != by_system),
        });
        Ok(())
    };
    runner(256).run(&cases, check).unwrap();
    println!("{near}: {:?}", count.get());
    count.get()
}

/// A chain with the gains at the ends of a way of it: parts of this position, slopes and decay rates that go with them.
fn way(brake: Brake, parts: [f64; 2], position: f64, has_lag: bool) -> (Brake, [Gain; 2]) {
    let size = brake.feedback.force.norm_squared();
    let gains = parts.map(|part| {
        let gain = Gain { position: part * position, ..Gain::default() };
        match has_lag {
            true => Gain { lag: 0.1 * part / size, decay: 4.0 + part, ..gain },
            false => Gain { velocity: 0.02 * part / size, ..gain },
        }
    });
    (brake, gains)
}

/// Parts of a position at both ends of a way, in either order.
fn parts(small: Range<f64>, large: Range<f64>) -> impl Strategy<Value = [f64; 2]> {
    (small, large, any::<bool>()).prop_map(|(a, b, is_back)| if is_back { [b, a] } else { [a, b] })
}

/// Springs in the places of friction: frequencies veer, and pass each other where damping keeps modes apart.
fn veering() -> impl Strategy<Value = (Brake, [Gain; 2])> {
    (brake(0.001..0.05, 0.01), parts(0.0..0.3, 1.0..3.0), any::<bool>()).prop_map(|(mut brake, parts, has_lag)| {
        brake.feedback.reading = brake.feedback.force.transpose();
        way(brake, parts, 1.0, has_lag)
    })
}

/// Two chains that nothing couples, springs in the places of friction in one: its frequencies cross those of the other.
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
        way(Brake { structure, feedback }, parts, 1.0, has_lag)
    })
}

/// Friction up to the first instability and beyond.
fn coalescing() -> impl Strategy<Value = (Brake, [Gain; 2])> {
    (brake(0.001..0.05, 0.01), parts(0.0..0.5, 0.5..1.5), any::<bool>()).prop_map(|(brake, parts, has_lag)| {
        let critical = brake.critical(0.0).unwrap_or(1.0);
        way(brake, parts, critical, has_lag)
    })
}

#[test]
fn lines_link_modes_as_systems_do() {
    let [veering, coalescing] =
        [[true, false].map(|near| compare(veering(), near)), [true, false].map(|near| compare(coalescing(), near))];
    let crossing = compare(crossing(), true);
    for count in [veering, coalescing].into_iter().flatten().chain([crossing]) {
        assert!(count.ways > 200 && count.followed > 100 && count.crossed > 20, "{count:?}");
        assert!(10 * count.walked < count.ways && 50 * count.differ < count.ways, "{count:?}");
    }
    for [_, far] in [veering, coalescing] {
        assert_eq!(far.followed, far.modes as u64);
    }
}
