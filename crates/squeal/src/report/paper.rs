//! The claims of the 3 x 3 oscillator paper, each checked against a study of its case.

use linsys::SecondOrder;
use num_complex::Complex;

use super::claims::{Claim, Holds};
use super::results::{Estimate, Results};
use crate::Error;
use crate::brakes::LatticeBrake;
use crate::case::Paper;
use crate::study::{ComparisonKind, Labels, Panel, Reference, Scene};

/// Places of the paper's constraint sets in its case: none, the corners, the corners and two more.
pub(super) const FREE: usize = 0;
pub(super) const CORNERS: usize = 1;
pub(super) const SIX: usize = 2;

/// The scorecard of a study of the paper's case; empty for a case without a `[paper]` table.
///
/// # Errors
/// Those of statistics without data.
pub fn claims(results: &Results<'_>, brake: &LatticeBrake) -> Result<Vec<Claim>, Error> {
    let Some(paper) = &brake.case.paper else { return Ok(Vec::new()) };
    let robust = most_robust(results, FREE)?;
    let mode = robust.first().map(|(name, _)| *name);
    Ok(vec![
        contact_number(results),
        laws(results),
        speeds(results),
        robust_mode(results, paper, &robust),
        robust_shape(results, paper, mode),
        robust_work(results, paper, mode)?,
        corners_reduce(results)?,
        after_corners(results, paper)?,
        none_at_six(results)?,
        after_six(results, paper)?,
        natural_frequencies(results, paper),
        counted(results, paper),
    ])
}

/// Modes under a constraint set by the smallest median occurrence over all panels, largest first.
pub(super) fn most_robust(results: &Results<'_>, constraints: usize) -> Result<Vec<(u16, Estimate)>, Error> {
    let panels: Vec<_> = results.panels().iter().filter(|p| p.key.constraints == constraints).collect();
    let of_panel: Vec<_> = panels.iter().map(|panel| results.occurrences(panel)).collect();
    let mut names: Vec<u16> = of_panel.iter().flat_map(|modes| modes.keys().copied()).collect();
    names.sort_unstable();
    names.dedup();
    let mut robust = Vec::new();
    for name in names {
        let mut least = Estimate { value: f64::INFINITY, lower: f64::INFINITY, upper: f64::INFINITY };
        for modes in &of_panel {
            let median = match modes.get(&name) {
                Some(occurrences) => results.median(occurrences)?,
                None => Estimate { value: 0.0, lower: 0.0, upper: 0.0 },
            };
            if median.value < least.value {
                least = median;
            }
        }
        robust.push((name, least));
    }
    robust.sort_by(|a, b| b.1.value.total_cmp(&a.1.value));
    Ok(robust)
}

/// A mode's name with its place among all 2 n eigenvalues, as the paper may count.
pub(super) fn title(results: &Results<'_>, name: u16) -> String {
    let (first, second) = cea::pair_numbers(usize::from(results.rank_of(name)));
    match results.labels {
        Labels::Tracked => format!("tracked mode {name} ({first}/{second} of all eigenvalues)"),
        Labels::Rank => format!("rank {name} ({first}/{second} of all eigenvalues)"),
        Labels::Pair => format!("mode {name}"),
    }
}

/// The mode that bears the paper's number, which counts all 2 n eigenvalues.
pub(super) fn paper_mode(results: &Results<'_>, paper: &Paper) -> u16 {
    if results.labels == Labels::Pair { paper.mode } else { paper.mode.div_ceil(2) }
}

fn number_in_contact(results: &Results<'_>, panel: &Panel) -> usize {
    results.plan().labels.panels[panel.key.panel].in_contact
}

fn contact_number(results: &Results<'_>) -> Claim {
    let steps = results.differences(ComparisonKind::Contact).filter(|(more, _, _)| more.key.constraints == FREE);
    Claim::new("C1", "instabilities grow with the number of oscillators in contact", "9 > 8 > 7 > 6").all_positive(
        steps.map(|(more, fewer, d)| {
            let (n, m) = (number_in_contact(results, more), number_in_contact(results, fewer));
            (format!("{} {n}-{m} {}", law_name(results, more), speed_name(results, more)), d)
        }),
    )
}

fn law_name<'a>(results: &'a Results<'_>, panel: &Panel) -> &'a str {
    &results.plan().labels.laws[panel.key.law].name
}

fn speed_name<'a>(results: &'a Results<'_>, panel: &Panel) -> &'a str {
    panel.key.speed.map_or("all speeds", |range| &results.plan().labels.speeds[range].name)
}

fn laws(results: &Results<'_>) -> Claim {
    let pairs = results
        .differences(ComparisonKind::Law)
        .filter(|(more, _, _)| more.key.constraints == FREE && more.key.speed == Some(0));
    let statement = "velocity-dependent and LuGre friction have more unstable modes than Amontons-Coulomb";
    Claim::new("C2", statement, "more, low speed").all_positive(pairs.map(|(more, _, d)| {
        (format!("{} {} in contact", law_name(results, more), number_in_contact(results, more)), d)
    }))
}

fn speeds(results: &Results<'_>) -> Claim {
    let pairs = results.differences(ComparisonKind::Speed).filter(|(slow, _, _)| {
        slow.key.constraints == FREE && Some(slow.key.law) != results.plan().labels.baseline_law
    });
    Claim::new("C3", "higher sliding speed, fewer instabilities", "fewer").all_positive(pairs.map(|(slow, _, d)| {
        (format!("{} {} in contact", law_name(results, slow), number_in_contact(results, slow)), d)
    }))
}

fn robust_mode(results: &Results<'_>, paper: &Paper, robust: &[(u16, Estimate)]) -> Claim {
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

/// Scenes without constraints and with every oscillator in contact, with the reference mode of a tracked name.
fn full_contact<'a>(
    results: &'a Results<'_>,
    constraints: usize,
) -> impl Iterator<Item = (usize, &'a Scene, &'a Reference)> {
    let scenes = results.plan().scenes.iter().zip(results.references()).enumerate();
    scenes
        .filter(move |(_, (scene, _))| scene.wants_work && scene.key.constraints == constraints)
        .map(|(at, (scene, reference))| (at, scene, reference))
}

/// Amplitudes of a mode shape, over all degrees of freedom of the lattice.
pub(super) fn shape(
    results: &Results<'_>,
    scene: &Scene,
    reference: &Reference,
    name: u16,
) -> Option<Vec<Complex<f64>>> {
    let at = match results.labels {
        Labels::Tracked => reference.names.iter().position(|names| *names == [name])?,
        Labels::Rank | Labels::Pair => usize::from(results.rank_of(name)).checked_sub(1)?,
    };
    let mode = reference.modes.get(at)?;
    Some(results.plan().brake(scene).dofs.expand(&mode.shape).iter().copied().collect())
}

/// The name of the law of a scene.
fn law_of(results: &Results<'_>, scene: &Scene) -> String {
    results.plan().labels.laws[scene.key.law].name.clone()
}

/// Smallest of some amplitudes over the largest of the others.
fn dominance(values: &[f64], dominant: impl Fn(usize) -> bool) -> f64 {
    let least = (0..values.len()).filter(|&i| dominant(i)).map(|i| values[i]).fold(f64::INFINITY, f64::min);
    let rest = (0..values.len()).filter(|&i| !dominant(i)).map(|i| values[i]).fold(f64::NEG_INFINITY, f64::max);
    least / rest
}

fn robust_shape(results: &Results<'_>, paper: &Paper, mode: Option<u16>) -> Claim {
    let claim = Claim::new("C5", "in its shape the four corners in x dominate", "each corner above the rest");
    let Some(name) = mode else { return claim.undetermined("no mode is ever unstable") };
    let theirs = paper_mode(results, paper);
    let is_corner_x = |dof: usize| dof.is_multiple_of(3) && paper.corners.contains(&(dof / 3 + 1));
    let ratios = |name: u16| -> Option<Vec<(String, f64)>> {
        let ratio = |(_, scene, reference): (usize, &Scene, &Reference)| {
            let shape = shape(results, scene, reference, name)?;
            let amplitudes: Vec<f64> = shape.iter().map(|u| u.norm()).collect();
            Some((law_of(results, scene), dominance(&amplitudes, is_corner_x)))
        };
        full_contact(results, FREE).map(ratio).collect()
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

/// Median net work of each oscillator under a mode in one scene; `None` where the mode is never unstable.
pub(super) fn median_work(results: &Results<'_>, scene: usize, name: u16) -> Result<Option<Vec<f64>>, Error> {
    let tracked = results.tracked_name(scene, name);
    let Some(sketches) = tracked.and_then(|name| results.summary.tally.scenes[scene].net_work.get(&name)) else {
        return Ok(None);
    };
    Ok(Some(sketches.iter().map(|sketch| sketch.median()).collect::<Result<_, _>>()?))
}

fn work_dominance(
    results: &Results<'_>,
    constraints: usize,
    name: u16,
    dominant: &[usize],
) -> Result<Vec<(String, f64)>, Error> {
    let mut margins = Vec::new();
    for (at, scene, _) in full_contact(results, constraints) {
        if let Some(work) = median_work(results, at, name)? {
            // The plate comes last.
            let oscillators = work.len() - 1;
            let work = &work[..oscillators];
            let largest = work.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
            let is_dominant = |i: &usize| dominant.contains(&(i + 1));
            let least = (0..oscillators).filter(is_dominant).map(|i| work[i]).fold(f64::INFINITY, f64::min);
            let others = (0..oscillators).filter(|i| !is_dominant(i));
            let rest = others.map(|i| work[i]).fold(f64::NEG_INFINITY, f64::max);
            margins.push((law_of(results, scene), (least - rest) / largest));
        }
    }
    Ok(margins)
}

fn robust_work(results: &Results<'_>, paper: &Paper, mode: Option<u16>) -> Result<Claim, Error> {
    let claim = Claim::new("C6", "in its net work the four corners contribute most, whatever the law", "corners above");
    let Some(name) = mode else { return Ok(claim.undetermined("no mode is ever unstable")) };
    let margins = work_dominance(results, FREE, name, &paper.corners)?;
    if margins.is_empty() {
        return Ok(claim.undetermined("the mode is never unstable with every oscillator in contact"));
    }
    let least = |margins: &[(String, f64)]| margins.iter().map(|(_, margin)| *margin).fold(f64::INFINITY, f64::min);
    let theirs = paper_mode(results, paper);
    let of_theirs = work_dominance(results, FREE, theirs, &paper.corners)?;
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

/// The mode with the largest occurrence in one arrangement of a panel.
fn largest(results: &Results<'_>, panel: &Panel) -> Result<f64, Error> {
    let mut largest = 0.0_f64;
    for occurrence in results.occurrences(panel).values().flatten() {
        largest = largest.max(occurrence.estimate().value);
    }
    Ok(largest)
}

fn corners_reduce(results: &Results<'_>) -> Result<Claim, Error> {
    let pairs: Vec<_> = results
        .differences(ComparisonKind::Constraints)
        .filter(|(_, after, _)| after.key.constraints == CORNERS)
        .collect();
    let mut worst = Vec::new();
    for (before, after, _) in &pairs {
        let (was, is) = (largest(results, before)?, largest(results, after)?);
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
    Ok(claim)
}

fn after_corners(results: &Results<'_>, paper: &Paper) -> Result<Claim, Error> {
    let statement = "after it one mode has a high probability, and oscillators 4 and 6 dominate its net work";
    let claim = Claim::new("C8", statement, format!("median {} with nine in contact", paper.after_corners_occurrence));
    let all = results.plan().labels.panels.iter().map(|panel| panel.in_contact).max().unwrap_or(0);
    let panels = results.panels().iter().filter(|p| p.key.constraints == CORNERS);
    let panels: Vec<_> = panels.filter(|p| number_in_contact(results, p) == all).collect();
    let mut modes: std::collections::BTreeMap<u16, Vec<(String, Estimate)>> = Default::default();
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
    let margins = work_dominance(results, CORNERS, name, &paper.after_corners_dominant)?;
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

fn none_at_six(results: &Results<'_>) -> Result<Claim, Error> {
    let claim = Claim::new("C9", "six constraints, six in contact: no instability for any law or speed", "0");
    let panels = results.panels().iter().filter(|p| p.key.constraints == SIX && number_in_contact(results, p) == 6);
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

fn after_six(results: &Results<'_>, paper: &Paper) -> Result<Claim, Error> {
    let statement = "six constraints, more in contact: the largest median occurrence stays below the bound";
    let said = format!("{} (LuGre), bound {}", paper.after_six_occurrence, paper.after_six_bound);
    let claim = Claim::new("C10", statement, said);
    let mut worst: Option<(String, Estimate)> = None;
    let panels = results.panels().iter().filter(|p| p.key.constraints == SIX && number_in_contact(results, p) > 6);
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

/// Undamped frequencies in Hz without friction, every oscillator in contact: those of the oscillators and of the plate,
/// by where most of the kinetic energy is.
fn undamped(results: &Results<'_>) -> Option<(Vec<f64>, Vec<f64>)> {
    let (_, scene, _) = full_contact(results, FREE).next()?;
    let brake = results.plan().brake(scene);
    let SecondOrder { m, k, .. } = brake.system.terms()[0].matrices();
    let root = m.map_diagonal(|mass| 1.0 / mass.sqrt());
    let symmetric = nalgebra::DMatrix::from_fn(k.nrows(), k.ncols(), |i, j| k[(i, j)] * root[i] * root[j]);
    let modes = symmetric.symmetric_eigen();
    let plate = &brake.bodies.last()?.dofs;
    let (mut of_oscillators, mut of_plate) = (Vec::new(), Vec::new());
    for (value, shape) in modes.eigenvalues.iter().zip(modes.eigenvectors.column_iter()) {
        let share: f64 = plate.iter().map(|&dof| shape[dof] * shape[dof]).sum();
        let frequency = value.max(0.0).sqrt() / std::f64::consts::TAU;
        if share > 0.5 { of_plate.push(frequency) } else { of_oscillators.push(frequency) }
    }
    of_oscillators.sort_by(f64::total_cmp);
    of_plate.sort_by(f64::total_cmp);
    Some((of_oscillators, of_plate))
}

fn natural_frequencies(results: &Results<'_>, paper: &Paper) -> Claim {
    let ([a, b], [c, d]) = (paper.natural_frequencies_oscillators, paper.natural_frequencies_plate);
    let statement = "lowest and highest natural frequencies of the oscillators and of the plate";
    let claim = Claim::new("C11", statement, format!("{a} / {b} Hz and {c} / {d} Hz"));
    let Some((oscillators, plate)) = undamped(results) else { return claim.undetermined("no full contact") };
    let (Some(p), Some(q), Some(r), Some(s)) = (oscillators.first(), oscillators.last(), plate.first(), plate.last())
    else {
        return claim.undetermined("no modes of one of them");
    };
    let pairs = [(p, a), (q, b), (r, c), (s, d)];
    let worst = pairs.iter().map(|(ours, paper)| (*ours / paper - 1.0).abs()).fold(0.0, f64::max);
    let detail = format!(
        "largest relative difference; ours {p:.0} / {q:.0} Hz and {r:.0} / {s:.0} Hz, undamped and without friction, \
         from the stiffnesses and masses of the case"
    );
    claim.exactly(worst, worst <= paper.frequency_tolerance, detail)
}

fn counted(results: &Results<'_>, paper: &Paper) -> Claim {
    let said =
        format!("{} arrangements of six, {} CEAs each", paper.arrangements_of_six, paper.analyses_per_arrangement);
    let panels = &results.plan().labels.panels;
    let six = panels.iter().find(|panel| panel.in_contact == 6).map_or(0, |panel| panel.arrangements.len());
    let samples = results.summary.samples;
    let holds = six == paper.arrangements_of_six && samples == paper.analyses_per_arrangement;
    let detail = format!("arrangements with six in contact; {samples} samples of each in every law and speed range");
    Claim::new("C12", "84 arrangements with six in contact, 1,000 CEAs each", said).exactly(six as f64, holds, detail)
}
