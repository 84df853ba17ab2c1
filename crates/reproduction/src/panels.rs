//! Claims C1 to C3, and the first half of C7: how the number of unstable modes compares between panels.

use montecarlo::Confidence;
use squeal::results::{Estimate, Results};
use squeal::study::{ComparisonKind, Panel};

use super::limits::{Judgement, above, all, least};
use super::scenes::{UNCONSTRAINED, law_name, number_in_contact, speed_name};
use crate::claims::Claim;

/// Two panels, more unstable modes expected in the first, with the difference of their means; `None` without a sample that
/// was solved in all arrangements.
pub(super) type Difference<'a> = (&'a Panel, &'a Panel, Option<Estimate>);

/// The comparisons of one kind that a claim is about, with limits that hold together.
pub(super) fn differences<'a>(
    results: &'a Results,
    judgement: Judgement,
    kind: ComparisonKind,
    is_meant: impl Fn(&Panel, &Panel) -> bool,
) -> Vec<Difference<'a>> {
    let meant = |confidence| results.differences(kind, confidence).filter(|(more, fewer, _)| is_meant(more, fewer));
    let limits = judgement.of(meant(Confidence::P95).count());
    let Some(confidence) = limits.confidence() else {
        let exact = |e: Estimate| Estimate { lower: e.value, upper: e.value, ..e };
        return meant(Confidence::P95).map(|(more, fewer, d)| (more, fewer, d.map(exact))).collect();
    };
    meant(confidence).collect()
}

/// A claim that several differences are all positive: `ours` is the smallest of them.
pub(super) fn all_positive(claim: Claim, of: &[Difference<'_>], name: impl Fn(&Panel, &Panel) -> String) -> Claim {
    let named = |&(more, fewer, d): &Difference<'_>| Some((name(more, fewer), d?));
    let Some(named) = of.iter().map(named).collect::<Option<Vec<_>>>() else {
        return claim.undetermined("no sample was solved in all arrangements");
    };
    if named.is_empty() {
        return claim.undetermined("the case has nothing to compare");
    }
    let holds = all(named.iter().map(|(_, d)| above(*d, 0.0)));
    let list: Vec<String> = named.iter().map(|(name, d)| format!("{name} {:+.3}", d.value)).collect();
    let detail = format!("smallest difference of the means; {}", list.join("; "));
    claim.ours(least(named.iter().map(|(_, d)| *d)), holds, detail)
}

/// C1: more oscillators in contact, more unstable modes.
pub(super) fn contact_number(results: &Results, judgement: Judgement) -> Claim {
    let claim = Claim::new("C1", "instabilities grow with the number of oscillators in contact", "9 > 8 > 7 > 6");
    let is_free = |more: &Panel, _: &Panel| more.key.constraints == UNCONSTRAINED;
    let steps = differences(results, judgement, ComparisonKind::Contact, is_free);
    all_positive(claim, &steps, |more, fewer| {
        let (n, m) = (number_in_contact(results, more), number_in_contact(results, fewer));
        format!("{} {n}-{m} {}", law_name(results, more), speed_name(results, more))
    })
}

/// C2: more unstable modes under the other laws than under Amontons-Coulomb.
pub(super) fn laws(results: &Results, judgement: Judgement) -> Claim {
    let statement = "velocity-dependent and LuGre friction have more unstable modes than Amontons-Coulomb";
    let claim = Claim::new("C2", statement, "more, low speed");
    let is_meant = |more: &Panel, _: &Panel| more.key.constraints == UNCONSTRAINED && more.key.speed == Some(0);
    let pairs = differences(results, judgement, ComparisonKind::Law, is_meant);
    all_positive(claim, &pairs, |more, _| of_law_and_number(results, more))
}

/// C3: fewer unstable modes at higher speed.
pub(super) fn speeds(results: &Results, judgement: Judgement) -> Claim {
    let is_meant = |slow: &Panel, _: &Panel| {
        slow.key.constraints == UNCONSTRAINED && Some(slow.key.law) != results.plan().labels.baseline_law
    };
    let pairs = differences(results, judgement, ComparisonKind::Speed, is_meant);
    let claim = Claim::new("C3", "higher sliding speed, fewer instabilities", "fewer");
    all_positive(claim, &pairs, |slow, _| of_law_and_number(results, slow))
}

fn of_law_and_number(results: &Results, panel: &Panel) -> String {
    format!("{} {} in contact", law_name(results, panel), number_in_contact(results, panel))
}
