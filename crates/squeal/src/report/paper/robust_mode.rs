//! Claims C4 to C6: the most robustly unstable mode, its shape and its net work.

use super::super::claims::{Claim, Holds};
use super::super::results::{Estimate, Results};
use super::modes::{paper_mode, shape, title, work_dominance};
use super::scenes::{UNCONSTRAINED, full_contact, law_of};
use crate::Error;
use crate::case::Paper;
use crate::study::{ModeLabel, Reference, Scene};

/// C4: one mode is unstable most often in every panel.
pub(super) fn robust_mode(results: &Results<'_>, paper: &Paper, robust: &[(ModeLabel, Estimate)]) -> Claim {
    let statement = "one mode is consistently the most robustly unstable, whatever the contacts, law and speed";
    let claim = Claim::new("C4", statement, format!("mode {}", paper.mode));
    let Some(&(name, first)) = robust.first() else { return claim.undetermined("no mode is ever unstable") };
    let second = robust.get(1).map_or(Estimate { value: 0.0, lower: 0.0, upper: 0.0 }, |&(_, e)| e);
    let runner_up =
        robust.get(1).map_or("none".into(), |&(name, e)| format!("{} at {:.3}", title(results, name), e.value));
    // Consistently high: in more than half of the samples in every panel, and more so than any other mode.
    let holds = if first.lower > 0.5 && first.lower > second.upper {
        Holds::Yes
    } else if first.upper < 0.5 {
        Holds::No
    } else {
        Holds::NotDetermined
    };
    let theirs = paper_mode(results, paper);
    let of_theirs = robust.iter().find(|(name, _)| *name == theirs).map_or(0.0, |(_, e)| e.value);
    let detail = format!(
        "smallest median occurrence over all panels of {}; runner-up {runner_up}; must exceed 0.5 and the runner-up; \
         the paper's number, {}, has {of_theirs:.3}",
        title(results, name),
        title(results, theirs)
    );
    claim.ours(first, holds, detail)
}

/// Smallest of some amplitudes over the largest of the others.
fn dominance(values: &[f64], dominant: impl Fn(usize) -> bool) -> f64 {
    let least = (0..values.len()).filter(|&i| dominant(i)).map(|i| values[i]).fold(f64::INFINITY, f64::min);
    let rest = (0..values.len()).filter(|&i| !dominant(i)).map(|i| values[i]).fold(f64::NEG_INFINITY, f64::max);
    least / rest
}

/// C5: the corners dominate its shape.
pub(super) fn robust_shape(results: &Results<'_>, paper: &Paper, mode: Option<ModeLabel>) -> Claim {
    let claim = Claim::new("C5", "in its shape the four corners in x dominate", "each corner above the rest");
    let Some(name) = mode else { return claim.undetermined("no mode is ever unstable") };
    let theirs = paper_mode(results, paper);
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
    let Some(ours) = ratios(name) else {
        return claim.undetermined("the mode has no sure name at median parameters");
    };
    let of_theirs = ratios(theirs).map_or("no sure name".into(), |ratios| format!("{:.3}", least(&ratios)));
    let list: Vec<String> = ours.iter().map(|(law, ratio)| format!("{law} {ratio:.3}")).collect();
    let least = least(&ours);
    let detail = format!(
        "{}: smallest corner amplitude in x over the largest other component, every oscillator in contact, median \
         parameters, least over laws and speeds; {}; {} has {of_theirs}",
        title(results, name),
        list.join("; "),
        title(results, theirs)
    );
    claim.exactly(least, least > 1.0, detail)
}

/// C6: the corners dominate its net work.
pub(super) fn robust_work(results: &Results<'_>, paper: &Paper, mode: Option<ModeLabel>) -> Result<Claim, Error> {
    let claim = Claim::new("C6", "in its net work the four corners contribute most, whatever the law", "corners above");
    let Some(name) = mode else { return Ok(claim.undetermined("no mode is ever unstable")) };
    let margins = work_dominance(results, UNCONSTRAINED, name, &paper.corners)?;
    if margins.is_empty() {
        return Ok(claim.undetermined("the mode is never unstable with every oscillator in contact"));
    }
    let least = |margins: &[(String, f64)]| margins.iter().map(|(_, margin)| *margin).fold(f64::INFINITY, f64::min);
    let theirs = paper_mode(results, paper);
    let of_theirs = work_dominance(results, UNCONSTRAINED, theirs, &paper.corners)?;
    let of_theirs = if of_theirs.is_empty() { "none".into() } else { format!("{:+.3}", least(&of_theirs)) };
    let list: Vec<String> = margins.iter().map(|(law, margin)| format!("{law} {margin:+.3}")).collect();
    let least = least(&margins);
    let detail = format!(
        "{}: smallest median net work of a corner less the largest of another oscillator, in units of the largest, \
         least over laws and speeds; {}; {} has {of_theirs}",
        title(results, name),
        list.join("; "),
        title(results, theirs)
    );
    Ok(claim.exactly(least, least > 0.0, detail))
}
