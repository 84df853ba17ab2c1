//! Claims C4 to C6: the most robustly unstable mode, its shape and its net work.

use brakes::case::Paper;
use squeal::results::{Estimate, Results};
use squeal::study::{ModeLabel, Reference, Scene};

use super::Subject;
use super::limits::{Judgement, above, agreed, all, below, largest, least};
use super::modes::{brake_oscillators, numbered, of_paper_modes, shape, title, work_dominance};
use super::scenes::{UNCONSTRAINED, full_contact, law_of};
use crate::Error;
use crate::claims::{Claim, Holds};

/// Words where the mode of a claim is not among the unstable ones.
const NEVER: &str = "no such mode is ever unstable";

/// Modes with the smallest median occurrence of each over all panels, largest value first.
type Robust<'a> = &'a [(ModeLabel, Estimate)];

/// The modes that the claims may be about: of those that the study finds the most robust one and all whose limits reach its own;
/// otherwise the one with the paper's number, if it ever is unstable.
fn candidates(results: &Results, paper: &Paper, robust: Robust<'_>, subject: Subject) -> Vec<ModeLabel> {
    if let Subject::Numbered(counting) = subject {
        let theirs = numbered(results, UNCONSTRAINED, paper.mode, counting);
        return robust.iter().map(|(name, _)| *name).filter(|name| *name == theirs).collect();
    }
    let Some((_, first)) = robust.first() else { return Vec::new() };
    let others = robust[1..].iter().filter(|(_, other)| other.upper > first.lower);
    std::iter::once(&robust[0]).chain(others).map(|(name, _)| *name).collect()
}

/// C4: one mode is unstable most often in every panel.
pub(super) fn robust_mode(
    results: &Results,
    paper: &Paper,
    robust: Robust<'_>,
    subject: Subject,
) -> Result<Claim, Error> {
    let statement = "one mode is consistently the most robustly unstable, whatever the contacts, law and speed";
    let claim = Claim::new("C4", statement, format!("mode {}", paper.mode));
    let Some(&name) = candidates(results, paper, robust, subject).first() else { return Ok(claim.none(NEVER)) };
    let (of_it, others): (Vec<_>, Vec<_>) = robust.iter().copied().partition(|(other, _)| *other == name);
    let Some(&(_, first)) = of_it.first() else { return Ok(claim.none(NEVER)) };
    let second = largest(others.iter().map(|(_, e)| *e));
    let runner_up =
        others.first().map_or("none".into(), |&(name, e)| format!("{} at {:.3}", title(results, name), e.value));
    // Consistently high: in more than half of the samples in every panel, and more so than any other mode.
    let any_is_high = above(largest(robust.iter().map(|(_, e)| *e)), 0.5);
    let is_apart = match below(second, first.lower) {
        Holds::Yes => Holds::Yes,
        _ => Holds::NotDetermined,
    };
    // A mode that is picked by its number may surely be less robust than another.
    let is_apart = if above(second, first.upper) == Holds::Yes { Holds::No } else { is_apart };
    let holds = if any_is_high == Holds::No { Holds::No } else { all([above(first, 0.5), is_apart]) };
    let of_theirs = of_paper_modes(results, paper, |mode| {
        let found = robust.iter().find(|(name, _)| *name == mode);
        Ok(found.map_or("0".into(), |(_, e)| format!("{:.3}", e.value)))
    })?;
    let detail = format!(
        "smallest median occurrence over all panels of {}; runner-up {runner_up}; must exceed 0.5 and the runner-up; \
         {of_theirs}",
        title(results, name),
    );
    Ok(claim.ours(first, holds, detail).about(results.rank_of(UNCONSTRAINED, name)))
}

/// Ratio of the smallest amplitude at the indices that are `dominant` to the largest of the others.
fn dominance(values: &[f64], dominant: impl Fn(usize) -> bool) -> f64 {
    let least = (0..values.len()).filter(|&i| dominant(i)).map(|i| values[i]).fold(f64::INFINITY, f64::min);
    let rest = (0..values.len()).filter(|&i| !dominant(i)).map(|i| values[i]).fold(f64::NEG_INFINITY, f64::max);
    least / rest
}

/// C5: the corners dominate its shape.
pub(super) fn robust_shape(
    results: &Results,
    paper: &Paper,
    robust: Robust<'_>,
    subject: Subject,
) -> Result<Claim, Error> {
    let claim = Claim::new("C5", "in its shape the four corners in x dominate", "each corner above the rest");
    let is_corner_x = |dof: usize| dof.is_multiple_of(3) && paper.corners.contains(&(dof / 3 + 1));
    let ratios = |name: ModeLabel| -> Option<Vec<(String, f64)>> {
        let ratio = |(_, scene, reference): (usize, &Scene, &Reference)| {
            let shape = shape(results, scene, reference, name)?;
            let amplitudes: Vec<f64> = shape.iter().map(|u| u.norm()).collect();
            Some((law_of(results, scene), dominance(&amplitudes, is_corner_x)))
        };
        full_contact(results, UNCONSTRAINED).map(ratio).collect()
    };
    let least = |ratios: &[(String, f64)]| ratios.iter().map(|(_, ratio)| *ratio).fold(f64::INFINITY, f64::min);
    let candidates = candidates(results, paper, robust, subject);
    let Some(&name) = candidates.first() else { return Ok(claim.none(NEVER)) };
    let Some(ours) = ratios(name) else {
        return Ok(claim.undetermined("the mode has no sure name at median parameters"));
    };
    let verdict =
        |&name: &ModeLabel| ratios(name).map_or(Holds::NotDetermined, |ratios| Holds::from(least(&ratios) > 1.0));
    let holds = agreed(&candidates.iter().map(verdict).collect::<Vec<_>>());
    let of_theirs = of_paper_modes(results, paper, |mode| {
        Ok(ratios(mode).map_or("no sure name".into(), |ratios| format!("{:.3}", least(&ratios))))
    })?;
    let list: Vec<String> = ours.iter().map(|(law, ratio)| format!("{law} {ratio:.3}")).collect();
    let value = least(&ours);
    let detail = format!(
        "{}: smallest corner amplitude in x over the largest other component, every oscillator in contact, median \
         parameters, least over laws and speeds; {}; {of_theirs}{}",
        title(results, name),
        list.join("; "),
        others(results, &candidates)
    );
    Ok(claim.exactly(value, holds, detail).about(results.rank_of(UNCONSTRAINED, name)))
}

/// C6: the corners dominate its net work.
pub(super) fn robust_work(
    results: &Results,
    paper: &Paper,
    robust: Robust<'_>,
    judgement: Judgement,
    subject: Subject,
) -> Result<Claim, Error> {
    let claim = Claim::new("C6", "in its net work the four corners contribute most, whatever the law", "corners above");
    let candidates = candidates(results, paper, robust, subject);
    let Some(&name) = candidates.first() else { return Ok(claim.none(NEVER)) };
    let scenes = full_contact(results, UNCONSTRAINED).count();
    let oscillators = brake_oscillators(results, UNCONSTRAINED);
    let limits = judgement.of(candidates.len() * scenes * oscillators);
    let margins_of = |name: ModeLabel| work_dominance(results, UNCONSTRAINED, name, &paper.corners, &limits);
    let of_each = candidates.iter().map(|&name| margins_of(name)).collect::<Result<Vec<_>, Error>>()?;
    let Some(ours) = of_each.first().filter(|margins| !margins.is_empty()) else {
        return Ok(claim.undetermined("the mode is never unstable with every oscillator in contact"));
    };
    let smallest = |margins: &[(String, Estimate)]| least(margins.iter().map(|(_, margin)| *margin));
    let verdict = |margins: &Vec<(String, Estimate)>| match margins.is_empty() {
        true => Holds::NotDetermined,
        false => above(smallest(margins), 0.0),
    };
    let holds = agreed(&of_each.iter().map(verdict).collect::<Vec<_>>());
    let of_theirs = of_paper_modes(results, paper, |mode| {
        let margins = margins_of(mode)?;
        Ok(if margins.is_empty() { "none".into() } else { format!("{:+.3}", smallest(&margins).value) })
    })?;
    let list: Vec<String> = ours.iter().map(|(law, margin)| format!("{law} {:+.3}", margin.value)).collect();
    let detail = format!(
        "{}: smallest median net work of a corner less the largest of another oscillator, in units of the largest, \
         least over laws and speeds; {}; {of_theirs}{}",
        title(results, name),
        list.join("; "),
        others(results, &candidates)
    );
    Ok(claim.ours(smallest(ours), holds, detail).about(results.rank_of(UNCONSTRAINED, name)))
}

/// The candidates but the first, in words.
fn others(results: &Results, candidates: &[ModeLabel]) -> String {
    let names: Vec<String> = candidates[1..].iter().map(|&name| title(results, name)).collect();
    if names.is_empty() { String::new() } else { format!("; the most robust may as well be {}", names.join(", ")) }
}
