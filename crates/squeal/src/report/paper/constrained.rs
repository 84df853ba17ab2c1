//! Claims C7 to C10: what is left of the instabilities with oscillators held.

use super::super::claims::{Claim, Holds};
use super::super::results::{Estimate, Results};
use super::modes::{title, work_dominance};
use super::scenes::{CORNERS_HELD, SIX_HELD, law_name, number_in_contact, speed_name};
use crate::Error;
use crate::case::Paper;
use crate::study::{ComparisonKind, ModeLabel, Panel};

/// The largest occurrence of any mode in one arrangement of a panel.
fn largest_occurrence(results: &Results<'_>, panel: &Panel) -> f64 {
    let occurrences = results.occurrences(panel);
    occurrences.values().flatten().map(|occurrence| occurrence.estimate().value).fold(0.0, f64::max)
}

/// C7: fewer unstable modes with the corners held in x.
pub(super) fn corners_reduce(results: &Results<'_>) -> Claim {
    let pairs: Vec<_> = results
        .differences(ComparisonKind::Constraints)
        .filter(|(_, after, _)| after.key.constraints == CORNERS_HELD)
        .collect();
    let mut worst = Vec::new();
    for (before, after, _) in &pairs {
        let (was, is) = (largest_occurrence(results, before), largest_occurrence(results, after));
        if is > was {
            worst.push(format!("{}: {was:.3} before, {is:.3} after", results.describe(before)));
        }
    }
    let claim = Claim::new("C7", "holding the corners in x reduces the occurrence of instability", "fewer");
    let mut claim = claim.all_positive(pairs.into_iter().map(|(before, _, d)| (results.describe(before), d)));
    claim.detail += &match worst.len() {
        0 => "; the largest occurrence of a mode grows in no panel".to_owned(),
        _ => format!("; the largest occurrence of a mode grows in {} panels: {}", worst.len(), worst.join(", ")),
    };
    claim
}

/// C8: with the corners held one mode is left, and which oscillators do its work.
pub(super) fn after_corners(results: &Results<'_>, paper: &Paper) -> Result<Claim, Error> {
    let statement = "after it one mode has a high probability, and oscillators 4 and 6 dominate its net work";
    let claim = Claim::new("C8", statement, format!("median {} with nine in contact", paper.after_corners_occurrence));
    let all = results.plan().labels.panels.iter().map(|panel| panel.in_contact).max().unwrap_or(0);
    let panels = results.panels().iter().filter(|p| p.key.constraints == CORNERS_HELD);
    let panels: Vec<_> = panels.filter(|p| number_in_contact(results, p) == all).collect();
    let mut modes: std::collections::BTreeMap<ModeLabel, Vec<(String, Estimate)>> = Default::default();
    for panel in &panels {
        for (name, occurrences) in results.occurrences(panel) {
            let entry =
                (format!("{} {}", law_name(results, panel), speed_name(results, panel)), results.median(&occurrences)?);
            modes.entry(name).or_default().push(entry);
        }
    }
    let mean = |list: &[(String, Estimate)]| list.iter().map(|(_, e)| e.value).sum::<f64>() / panels.len() as f64;
    let mut order: Vec<_> = modes.iter().collect();
    order.sort_by(|a, b| mean(b.1).total_cmp(&mean(a.1)));
    let Some((&name, list)) = order.first().map(|(name, list)| (*name, *list)) else {
        return Ok(claim.undetermined("no mode is unstable"));
    };
    let high: Vec<String> = order
        .iter()
        .filter(|(_, list)| mean(list) > 0.5)
        .map(|(n, list)| format!("{n} at {:.3}", mean(list)))
        .collect();
    let margins = work_dominance(results, CORNERS_HELD, name, &paper.after_corners_dominant)?;
    let dominates = !margins.is_empty() && margins.iter().all(|(_, margin)| *margin > 0.0);
    let value = mean(list);
    let average = |of: fn(&Estimate) -> f64| list.iter().map(|(_, e)| of(e)).sum::<f64>() / panels.len() as f64;
    let estimate = Estimate { value, lower: average(|e| e.lower), upper: average(|e| e.upper) };
    let by_law: Vec<String> = list.iter().map(|(law, e)| format!("{law} {:.3}", e.value)).collect();
    let detail = format!(
        "occurrence of {}, mean over laws and speeds; {}; modes above 0.5: {}; 4 and 6 dominate its net work: {}",
        title(results, name),
        by_law.join("; "),
        high.join(", "),
        if dominates { "yes" } else { "no" }
    );
    let holds = if high.len() == 1 && dominates { Holds::Yes } else { Holds::No };
    Ok(claim.ours(estimate, holds, detail))
}

/// C9: with six constraints and six in contact nothing is unstable.
pub(super) fn none_at_six(results: &Results<'_>) -> Result<Claim, Error> {
    let claim = Claim::new("C9", "six constraints, six in contact: no instability for any law or speed", "0");
    let panels =
        results.panels().iter().filter(|p| p.key.constraints == SIX_HELD && number_in_contact(results, p) == 6);
    let (mut worst, mut hits, mut solved) = (None::<Estimate>, 0, 0);
    for &scene in panels.flat_map(|panel| &panel.scenes) {
        let tally = &results.summary.tally.scenes[scene];
        let upper = montecarlo::wilson(tally.any_unstable, tally.solved, montecarlo::Confidence::P95)?;
        let value = if tally.solved == 0 { 0.0 } else { tally.any_unstable as f64 / tally.solved as f64 };
        let estimate = Estimate { value, lower: upper.lower, upper: upper.upper };
        if worst.is_none_or(|w| estimate.upper > w.upper) {
            worst = Some(estimate);
        }
        (hits, solved) = (hits + tally.any_unstable, solved + tally.solved);
    }
    let Some(worst) = worst else { return Ok(claim.undetermined("the case has no such panel")) };
    let detail = format!(
        "largest part of the samples with any instability in one arrangement; {hits} of {solved} in all, one \
         arrangement of each symmetry class"
    );
    Ok(claim.ours(worst, if hits == 0 { Holds::Yes } else { Holds::No }, detail))
}

/// C10: with six constraints and more in contact the occurrences stay below a bound.
pub(super) fn after_six(results: &Results<'_>, paper: &Paper) -> Result<Claim, Error> {
    let statement = "six constraints, more in contact: the largest median occurrence stays below the bound";
    let said = format!("{} (LuGre), bound {}", paper.after_six_occurrence, paper.after_six_bound);
    let claim = Claim::new("C10", statement, said);
    let mut worst: Option<(String, Estimate)> = None;
    let panels = results.panels().iter().filter(|p| p.key.constraints == SIX_HELD && number_in_contact(results, p) > 6);
    for panel in panels {
        for (name, occurrences) in results.occurrences(panel) {
            let median = results.median(&occurrences)?;
            if worst.as_ref().is_none_or(|(_, w)| median.value > w.value) {
                worst = Some((format!("{}, {}", title(results, name), results.describe(panel)), median));
            }
        }
    }
    let Some((what, median)) = worst else {
        let none = Estimate { value: 0.0, lower: 0.0, upper: 0.0 };
        return Ok(claim.ours(none, Holds::Yes, "no mode is ever unstable".into()));
    };
    let holds = if median.upper < paper.after_six_bound {
        Holds::Yes
    } else if median.lower > paper.after_six_bound {
        Holds::No
    } else {
        Holds::NotDetermined
    };
    Ok(claim.ours(median, holds, what))
}
