//! Claims C7 to C10: what is left of the instabilities with oscillators held.

use brakes::case::Paper;
use squeal::results::{ArrangementOccurrence, Estimate, Results};
use squeal::study::{ComparisonKind, ModeLabel, Panel};

use super::Subject;
use super::limits::{Judgement, Limits, above, all, below, largest, least, mean};
use super::modes::{
    brake_oscillators, medians, number_of_occurrences, numbered, title_in, unstable_modes, work_dominance,
};
use super::panels::{all_positive, differences};
use super::scenes::{CORNERS_HELD, SIX_HELD, full_contact, law_name, number_in_contact, speed_name};
use crate::Error;
use crate::claims::{Claim, Holds};

/// An occurrence that counts as none: a box plot from 0 to 100 % does not show it, and 1,000 draws without a hit in each of
/// 135 scenes bound all occurrences by 0.9 %. Chosen, before any reading was judged by it.
const NO_INSTABILITY: f64 = 0.01;

/// The largest occurrence of any mode in one arrangement of a panel.
fn largest_occurrence(results: &Results, panel: &Panel) -> f64 {
    let occurrences = results.occurrences(panel);
    occurrences.values().flatten().map(|occurrence| occurrence.estimate().value).fold(0.0, f64::max)
}

/// C7: fewer unstable modes with the corners held in x.
pub(super) fn corners_reduce(results: &Results, judgement: Judgement) -> Claim {
    let is_meant = |_: &Panel, after: &Panel| after.key.constraints == CORNERS_HELD;
    let pairs = differences(results, judgement, ComparisonKind::Constraints, is_meant);
    let mut worst = Vec::new();
    for (before, after, _) in &pairs {
        let (was, is) = (largest_occurrence(results, before), largest_occurrence(results, after));
        if is > was {
            worst.push(format!("{}: {was:.3} before, {is:.3} after", results.describe(before)));
        }
    }
    let claim = Claim::new("C7", "holding the corners in x reduces the occurrence of instability", "fewer");
    let mut claim = all_positive(claim, &pairs, |before, _| results.describe(before));
    claim.detail += &match worst.len() {
        0 => "; the largest occurrence of a mode grows in no panel".to_owned(),
        _ => format!("; the largest occurrence of a mode grows in {} panels: {}", worst.len(), worst.join(", ")),
    };
    claim
}

/// C8: with the corners held one mode is left, and which oscillators do its work.
pub(super) fn after_corners(
    results: &Results,
    paper: &Paper,
    judgement: Judgement,
    subject: Subject,
) -> Result<Claim, Error> {
    let statement = "after it one mode has a high probability, and oscillators 4 and 6 dominate its net work";
    let claim = Claim::new(
        "C8",
        statement,
        format!("mode {}, median {} with nine in contact", paper.after_corners_mode, paper.after_corners_occurrence),
    );
    let most = results.plan().labels.panels.iter().map(|panel| panel.in_contact).max().unwrap_or(0);
    let is_meant = |p: &&Panel| p.key.constraints == CORNERS_HELD && number_in_contact(results, p) == most;
    let panels: Vec<_> = results.panels().iter().filter(is_meant).collect();
    let modes = unstable_modes(results, &panels);
    let scenes = full_contact(results, CORNERS_HELD).count();
    let oscillators = brake_oscillators(results, CORNERS_HELD);
    let limits = judgement.of(number_of_occurrences(modes.len(), &panels) + scenes * oscillators);

    let medians = medians(results, &modes, &panels, &limits)?;
    let mut order: Vec<(ModeLabel, Estimate)> =
        medians.iter().map(|(&mode, of_panels)| (mode, mean(of_panels))).collect();
    order.sort_by(|a, b| b.1.value.total_cmp(&a.1.value));
    let at = match subject {
        Subject::Found => 0,
        Subject::Numbered(counting) => {
            let theirs = numbered(results, CORNERS_HELD, paper.after_corners_mode, counting);
            order.iter().position(|(name, _)| *name == theirs).unwrap_or(order.len())
        }
    };
    if at >= order.len() {
        return Ok(claim.none("no such mode is unstable"));
    }
    let (name, ours) = order.remove(at);
    let margins = work_dominance(results, CORNERS_HELD, name, &paper.after_corners_dominant, &limits)?;
    let dominates = match margins.is_empty() {
        true => Holds::NotDetermined,
        false => above(least(margins.iter().map(|(_, margin)| *margin)), 0.0),
    };
    let others_are_low = below(largest(order.iter().map(|(_, e)| *e)), 0.5);
    order.insert(at, (name, ours));
    let any_is_high = above(largest(order.iter().map(|(_, e)| *e)), 0.5);
    let holds = match any_is_high {
        Holds::No => Holds::No,
        _ => all([above(ours, 0.5), others_are_low, dominates]),
    };

    let high: Vec<String> = order
        .iter()
        .filter(|(_, e)| e.value > 0.5)
        .map(|(n, e)| format!("{} at {:.3}", results.mode_label(CORNERS_HELD, *n), e.value))
        .collect();
    let of_panel = |(panel, e): (&&Panel, &Estimate)| {
        format!("{} {} {:.3}", law_name(results, panel), speed_name(results, panel), e.value)
    };
    let by_law: Vec<String> = panels.iter().zip(&medians[&name]).map(of_panel).collect();
    let detail = format!(
        "occurrence of {}, mean over laws and speeds; {}; modes above 0.5: {}; 4 and 6 dominate its net work: {}",
        title_in(results, CORNERS_HELD, name),
        by_law.join("; "),
        high.join(", "),
        dominates.sign()
    );
    Ok(claim.ours(ours, holds, detail).about(results.rank_of(CORNERS_HELD, name)))
}

/// C9: with six constraints and six in contact nothing is unstable.
pub(super) fn none_at_six(results: &Results, judgement: Judgement) -> Claim {
    let claim = Claim::new("C9", "six constraints, six in contact: no instability for any law or speed", "0");
    let is_meant = |p: &&Panel| p.key.constraints == SIX_HELD && number_in_contact(results, p) == 6;
    let scenes: Vec<usize> = results.panels().iter().filter(is_meant).flat_map(|panel| panel.scenes.clone()).collect();
    if scenes.is_empty() {
        return claim.undetermined("the case has no such panel");
    }
    let limits = judgement.of(scenes.len());
    let tallies = || scenes.iter().map(|&scene| &results.summary.tally.scenes[scene]);
    let occurrence = |tally: &squeal::study::SceneTally| {
        // A verdict that is open may be an instability.
        let possible = (tally.any_unstable + tally.undecided).min(tally.solved);
        limits.occurrence(tally.any_unstable, possible, tally.solved)
    };
    let worst = largest(tallies().map(occurrence));
    let (hits, solved) = tallies().fold((0, 0), |(hits, all), t| (hits + t.any_unstable, all + t.solved));
    let detail = format!(
        "largest part of the draws with any instability in one arrangement; must stay below {NO_INSTABILITY}; in all \
         {hits} of {solved} CEAs, one arrangement of each symmetry class, which rest on the same {} draws",
        results.summary.samples
    );
    claim.ours(worst, below(worst, NO_INSTABILITY), detail)
}

/// C10: with six constraints and more in contact one mode is unstable under all laws, but never often.
pub(super) fn after_six(
    results: &Results,
    paper: &Paper,
    judgement: Judgement,
    subject: Subject,
) -> Result<Claim, Error> {
    let statement = "six constraints, more in contact: one mode is unstable for all laws, and the largest median \
                     occurrence stays below the bound";
    let said = format!(
        "mode {}, {} (LuGre), bound {}",
        paper.after_six_mode, paper.after_six_occurrence, paper.after_six_bound
    );
    let claim = Claim::new("C10", statement, said);
    let is_meant = |p: &&Panel| p.key.constraints == SIX_HELD && number_in_contact(results, p) > 6;
    let panels: Vec<_> = results.panels().iter().filter(is_meant).collect();
    let modes = unstable_modes(results, &panels);
    let limits = judgement.of(number_of_occurrences(modes.len(), &panels));

    let medians = medians(results, &modes, &panels, &limits)?;
    let all_medians = medians.iter().flat_map(|(&mode, list)| panels.iter().zip(list).map(move |(p, e)| (mode, p, *e)));
    let Some((of, panel, highest)) = all_medians.clone().max_by(|a, b| a.2.value.total_cmp(&b.2.value)) else {
        return Ok(claim.none("no mode is ever unstable"));
    };
    let median = largest(all_medians.map(|(_, _, e)| e));
    let is_meant = |mode: ModeLabel| match subject {
        Subject::Found => true,
        Subject::Numbered(counting) => mode == numbered(results, SIX_HELD, paper.after_six_mode, counting),
    };
    let meant = modes.iter().copied().filter(|&mode| is_meant(mode));
    let everywhere: Vec<(ModeLabel, Estimate)> =
        meant.map(|mode| (mode, unstable_everywhere(results, &panels, mode, &limits))).collect();
    if everywhere.is_empty() {
        return Ok(claim.none("no such mode is ever unstable"));
    }
    let of_best = everywhere.iter().max_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let &(best, _) = of_best.unwrap_or(&(of, highest));
    let reached = largest(everywhere.iter().map(|(_, e)| *e));

    let is_everywhere = above(reached, NO_INSTABILITY);
    let holds = all([is_everywhere, below(median, paper.after_six_bound)]);
    let detail = format!(
        "{}; the largest median: {:.3} ({:.3} to {:.3}), {}, {}; unstable under every law with 7, 8 and 9 in contact, by \
         the largest occurrence of one mode in any arrangement and speed range: {:.3} ({:.3} to {:.3}), {}, must exceed \
         {NO_INSTABILITY}",
        if is_everywhere == Holds::Yes { "the largest median decides" } else { "whether a mode is unstable decides" },
        median.value,
        median.lower,
        median.upper,
        title_in(results, SIX_HELD, of),
        results.describe(panel),
        reached.value,
        reached.lower,
        reached.upper,
        title_in(results, SIX_HELD, best),
    );
    let (ours, mode) = match (is_everywhere, subject) {
        (Holds::Yes, Subject::Found) => (median, of),
        (Holds::Yes, Subject::Numbered(_)) => (median, best),
        _ => (reached, best),
    };
    Ok(claim.ours(ours, holds, detail).about(results.rank_of(SIX_HELD, mode)))
}

/// The least, over the laws and the numbers in contact, of the largest occurrence of a mode in any arrangement and speed range.
fn unstable_everywhere(results: &Results, panels: &[&Panel], mode: ModeLabel, limits: &Limits) -> Estimate {
    let mut groups: std::collections::BTreeMap<(usize, usize), Vec<ArrangementOccurrence>> = Default::default();
    for panel in panels {
        let group = groups.entry((panel.key.law, panel.key.panel)).or_default();
        group.extend(results.occurrences_of(panel, mode));
    }
    least(groups.values().map(|occurrences| limits.largest(occurrences)))
}
