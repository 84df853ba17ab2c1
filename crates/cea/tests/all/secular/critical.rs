//! The secular equation at gains where modes coalesce or begin to grow.

use std::cell::Cell;

use cea::{Anchors, Gain, Secular};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

use super::chains::{ANCHORS, Brake, bisect, brake, gains, growing, runner};

/// The results at gains next to `at`, below which `grow[0]` modes grow and above which `grow[1]` do: the numbers of gains left
/// open, without and with growing modes.
fn check_about(
    anchors: (&Secular, &Anchors),
    at: Gain,
    by: impl Fn(Gain, f64) -> Gain,
    grow: [usize; 2],
) -> Result<[u32; 3], TestCaseError> {
    let mut counts = [0; 3];
    for exponent in 3..=10 {
        for (side, grow) in [-1.0, 1.0].into_iter().zip(grow) {
            let gain = by(at, side * 10f64.powi(-exponent));
            let found = growing(anchors.0, anchors.1, &[gain]).remove(0);
            let number = found.as_ref().ok().map(|found| found.frequencies().count());
            prop_assert!(number.is_none_or(|number| number == grow), "1e-{exponent} to {side}: {number:?}");
            // Frequencies are about 1.
            let mut modes = found.iter().flat_map(|found| &found.modes);
            prop_assert!(modes.all(|mode| mode.re.abs() > 5e-7));
            counts[number.map_or(0, |number| if number > 0 { 2 } else { 1 })] += 1;
        }
    }
    Ok(counts)
}

#[test]
fn next_to_critical_gains_no_verdict_is_wrong() {
    let counts = [const { Cell::new([0; 3]) }; 4];
    let add = |of: usize, more: [u32; 3]| {
        let sum = counts[of].get();
        counts[of].set([0, 1, 2].map(|i| sum[i] + more[i]));
    };
    let units = prop::collection::vec((-1.0..1.0, -1.0..1.0).prop_map(|(a, b)| [a, b, 0.0]), ANCHORS);
    let check = |(brake, units): (Brake, Vec<[f64; 3]>)| {
        // Damping in proportion to the mass moves all eigenvalues to the left and leaves pairs where they coalesce. Dashpots
        // that differ give the two of a pair frequencies of their own.
        let (mut undamped, mut uneven) = (brake.clone(), brake.clone());
        undamped.structure.c.fill(0.0);
        uneven.structure.c.row_iter_mut().enumerate().for_each(|(i, mut row)| row[i] *= [0.5, 1.5][i % 2]);
        let critical = [undamped.critical(1e-6), uneven.critical(0.0)];
        prop_assume!(critical.iter().all(Option::is_some));
        let [coalescence, threshold] = critical.map(Option::unwrap);
        let proportional = |mu: f64| Gain { mu, ..Gain::default() };
        // The threshold is the flutter of one pair, not divergence, and no other threshold is near.
        let beyond = uneven.modes(&proportional(threshold * 1.002));
        prop_assume!(beyond.len() == brake.structure.order());
        prop_assume!(beyond.iter().filter(|mode| mode.re > 0.0).count() == 1);
        prop_assume!(threshold / coalescence > 1.003);

        let nudge = |gain: Gain, part: f64| Gain { mu: gain.mu * (1.0 + part), ..gain };
        let secular = brake.secular();
        let anchors = brake.anchors(&secular, &gains(&brake, threshold, &units, false));
        add(0, check_about((&secular, &anchors), proportional(coalescence), nudge, [0, 0])?);

        let (secular, known) = (uneven.secular(), gains(&uneven, threshold, &units, false));
        let anchors = uneven.anchors(&secular, &known);
        add(1, check_about((&secular, &anchors), proportional(threshold), nudge, [0, 1])?);
        prop_assert!(growing(&secular, &anchors, &[proportional(threshold)])[0].is_err());

        // No gain here has only damped modes for certain.
        let (secular, known) = (undamped.secular(), gains(&undamped, threshold, &units, false));
        let anchors = undamped.anchors(&secular, &known);
        let counts = check_about((&secular, &anchors), proportional(coalescence), nudge, [0, 1])?;
        prop_assert_eq!(counts[1] + counts[2], 0);
        add(2, counts);

        // A dashpot of negative damping in the ports of friction.
        let sloped = |slope: f64| Gain { slope, ..Gain::default() };
        let grows = |v: f64| brake.growth(&sloped(v)) > 0.0;
        let upper = (1..).map(|i| -1e-3 * f64::from(i)).find(|&v| grows(v)).unwrap();
        let critical = bisect(upper + 1e-3, upper, grows);
        let secular = brake.secular();
        let anchors = brake.anchors(&secular, &[0.5, 0.9, 1.1].map(|part| sloped(part * critical)));
        let nudge = |gain: Gain, part: f64| Gain { slope: gain.slope * (1.0 + part), ..gain };
        add(3, check_about((&secular, &anchors), sloped(critical), nudge, [0, 1])?);
        prop_assert!(growing(&secular, &anchors, &[sloped(critical)])[0].is_err());
        Ok(())
    };
    runner(64).run(&(brake(0.03..0.1, 0.0), units), check).unwrap();
    let counts = counts.map(|count| count.get());
    println!("[open, damp, grow] next to coalescences, thresholds, undamped, velocities: {counts:?}");
    let [coalescences, thresholds, _, velocities] = counts;
    assert!(coalescences[1] > 10 * coalescences[0]);
    assert!(thresholds[1] > 100 && thresholds[2] > 100 && velocities[1] > 100 && velocities[2] > 100);
}
