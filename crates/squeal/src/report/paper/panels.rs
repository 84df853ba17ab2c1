//! Claims C1 to C3: how the number of unstable modes compares between panels.

use super::super::claims::Claim;
use super::super::results::Results;
use super::scenes::{UNCONSTRAINED, law_name, number_in_contact, speed_name};
use crate::study::ComparisonKind;

/// C1: more oscillators in contact, more unstable modes.
pub(super) fn contact_number(results: &Results<'_>) -> Claim {
    let steps =
        results.differences(ComparisonKind::Contact).filter(|(more, _, _)| more.key.constraints == UNCONSTRAINED);
    Claim::new("C1", "instabilities grow with the number of oscillators in contact", "9 > 8 > 7 > 6").all_positive(
        steps.map(|(more, fewer, d)| {
            let (n, m) = (number_in_contact(results, more), number_in_contact(results, fewer));
            (format!("{} {n}-{m} {}", law_name(results, more), speed_name(results, more)), d)
        }),
    )
}

/// C2: more unstable modes under the other laws than under Amontons-Coulomb.
pub(super) fn laws(results: &Results<'_>) -> Claim {
    let pairs = results
        .differences(ComparisonKind::Law)
        .filter(|(more, _, _)| more.key.constraints == UNCONSTRAINED && more.key.speed == Some(0));
    let statement = "velocity-dependent and LuGre friction have more unstable modes than Amontons-Coulomb";
    Claim::new("C2", statement, "more, low speed").all_positive(pairs.map(|(more, _, d)| {
        (format!("{} {} in contact", law_name(results, more), number_in_contact(results, more)), d)
    }))
}

/// C3: fewer unstable modes at higher speed.
pub(super) fn speeds(results: &Results<'_>) -> Claim {
    let pairs = results.differences(ComparisonKind::Speed).filter(|(slow, _, _)| {
        slow.key.constraints == UNCONSTRAINED && Some(slow.key.law) != results.plan().labels.baseline_law
    });
    Claim::new("C3", "higher sliding speed, fewer instabilities", "fewer").all_positive(pairs.map(|(slow, _, d)| {
        (format!("{} {} in contact", law_name(results, slow), number_in_contact(results, slow)), d)
    }))
}
