//! Reasons why the modes of a study's scenes grow at its medians: `sensitivities.csv`, and the largest ones in words.

use std::time::{Duration, Instant};

use cea::{Workspace, frequency_hz};
use montecarlo::Progress;
use output::{Table, hertz, significant};
use rayon::prelude::*;
use study::{ModeLabel, Plan, Scene, SceneLabels, SetLinks, Study, UncertainBrake, set_links};

use crate::Error;
use questions::why::{Explainer, Influence, InfluenceKind, Why};

/// Most parameters that a sentence names, and most of those that are 0; chosen.
const MOST_IN_A_SENTENCE: usize = 3;
/// Relative distance within which an unstable eigenvalue takes the names of a reference mode; chosen: both are solved to rounding, which two modes that meet
/// magnify.
const SAME_MODE: f64 = 1e-6;

/// The unstable modes of a scene at its medians, with the candidates for the name of each: none of a mode that has no name in the study.
pub struct SceneReasons {
    /// Index of the scene in the plan.
    pub scene: usize,
    /// Modes, ascending in frequency; or the reason why there is no answer, in which case the study goes on without.
    pub modes: Result<Vec<(Vec<ModeLabel>, Why)>, String>,
}

/// Reasons why modes grow in each scene with [`wants_work`](study::Scene::wants_work), of a lattice those with all contacts closed; and, computed beside them on
/// the same threads, the links of modes between sets of constraints. Progress counts the links as one scene.
///
/// A progress that is cancelled leaves scenes without an answer: whoever cancels it has to end before they are written.
///
/// # Errors
/// Errors of following modes from one set of constraints to another.
pub fn reasons_and_links<B: UncertainBrake>(
    study: &Study<'_, B>,
    progress: &dyn Progress,
) -> Result<(Vec<SceneReasons>, Vec<SetLinks>), Error> {
    let scenes = scenes_with_work(study.plan());
    let is_linked = study.plan().labels.constraints.len() > 1;
    progress.begin(scenes.len() as u64 + u64::from(is_linked), 0);
    let answered = |&scene: &usize| {
        let modes = progress
            .go_on()
            .map_err(Error::from)
            .and_then(|()| unstable_modes(study, scene))
            .map_err(|error| error.to_string());
        progress.advance(1);
        SceneReasons { scene, modes }
    };
    let linked = || {
        let links = set_links(study.plan(), study.origin_references(), &cea::QrSolver);
        progress.advance(u64::from(is_linked));
        links
    };
    let (links, reasons) = rayon::join(linked, || scenes.par_iter().map(answered).collect());
    progress.end();
    Ok((reasons, links?))
}

/// Indices of the scenes whose net work is wanted.
fn scenes_with_work(plan: &Plan) -> Vec<usize> {
    (0..plan.scenes.len()).filter(|&at| plan.scenes[at].wants_work).collect()
}

/// Time, roughly, that [`reasons_and_links`] takes for reasons on `threads` threads: one mode of the first scene is timed, and that time is multiplied by the number
/// of modes that grow at the medians.
pub fn time_for_reasons<B: UncertainBrake>(study: &Study<'_, B>, threads: usize) -> Duration {
    let scenes = scenes_with_work(study.plan());
    let Some(&first) = scenes.first() else { return Duration::ZERO };
    let (mut work, start) = (Workspace::default(), Instant::now());
    let explainer = Explainer::new(study.brake(), &study.plan().scenes[first], &mut work);
    let Ok((explainer, modes)) = explainer.and_then(|e| e.asked_for(&mut work).map(|modes| (e, modes))) else {
        return Duration::ZERO;
    };
    let (by_scene, start) = (start.elapsed(), Instant::now());
    // A mode that has no answer takes as long.
    let _ = explainer.why(&modes[..modes.len().min(1)], &mut work);
    let by_mode = start.elapsed();
    let plan = study.plan();
    let is_asked = |mode: &&cea::Mode| plan.threshold.margin(mode.lambda) > 0.0 && plan.is_studied(mode.lambda);
    let growing = |scene: &usize| study.references()[*scene].modes.iter().filter(is_asked).count();
    let all = by_scene.mul_f64(scenes.len() as f64) + by_mode.mul_f64(scenes.iter().map(growing).sum::<usize>() as f64);
    all.div_f64(threads.min(scenes.len()).max(1) as f64)
}

/// The unstable modes of a scene, with the candidates for the name of each.
fn unstable_modes<B: UncertainBrake>(study: &Study<'_, B>, scene: usize) -> Result<Vec<(Vec<ModeLabel>, Why)>, Error> {
    let mut work = Workspace::default();
    let explainer = Explainer::new(study.brake(), &study.plan().scenes[scene], &mut work)?;
    let (reference, unstable) = (&study.references()[scene], explainer.unstable(&mut work)?);
    let names = unstable.iter().map(|lambda| {
        let is_same = |at: &usize| (reference.modes[*at].lambda - lambda).norm() <= SAME_MODE * lambda.norm();
        reference.names_of((0..reference.modes.len()).filter(is_same))
    });
    Ok(names.zip(explainer.why(&unstable, &mut work)?).collect())
}

/// Writes `sensitivities.csv`.
pub(super) fn sensitivities(plan: &Plan, reasons: &[SceneReasons]) -> Table {
    let own = [
        "frequency_hz",
        "growth_rate",
        "kind",
        "parameter",
        "unit",
        "value",
        "d_growth",
        "d_frequency_hz",
        "growth_per_percent",
        "frequency_hz_per_percent",
        "growth_holds_to",
        "frequency_holds_to",
    ];
    let mut rows = Vec::new();
    for SceneReasons { scene, modes } in reasons {
        let Scene { key, members, .. } = &plan.scenes[*scene];
        let key = |mode: &str| {
            // The mode is the last of these columns.
            let mut columns = plan.labels.mode_columns(*key, members[0], ModeLabel::new(0));
            columns.pop();
            columns.push(mode.to_owned());
            columns
        };
        // A scene without an answer, a mode without derivatives and a parameter that could not be varied have one row each.
        let without = |mode: &str, why: Option<&Why>, kind: &str, reason: &str| {
            let numbers = why
                .map_or(["".into(), "".into()], |why| [frequency_hz(why.lambda), why.lambda.re].map(|x| x.to_string()));
            let filled = numbers.into_iter().chain([kind.to_owned(), reason.to_owned()]);
            key(mode).into_iter().chain(filled).chain(vec![String::new(); own.len() - 4]).collect::<Vec<String>>()
        };
        let modes = match modes {
            Ok(modes) => modes,
            Err(reason) => {
                rows.push(without("", None, "failed", reason));
                continue;
            }
        };
        for (names, why) in modes {
            let mode = ModeLabel::candidates(names);
            if !why.is_simple {
                rows.push(without(&mode, Some(why), "none", "equal to another eigenvalue within rounding"));
            }
            rows.extend(why.not_varied.iter().map(|name| without(&mode, Some(why), "not varied", name)));
            for influence in &why.influences {
                let Influence { kind, name, unit, value, growth, frequency_hz: frequency, .. } = influence;
                let text = [kind.to_string(), name.clone(), unit.clone()];
                let numbers = [
                    Some(*value),
                    Some(*growth),
                    Some(*frequency),
                    influence.growth_per_percent,
                    influence.frequency_hz_per_percent,
                    Some(influence.growth_holds_to),
                    Some(influence.frequency_holds_to),
                ];
                let of_mode = [frequency_hz(why.lambda), why.lambda.re].map(|x| x.to_string());
                let cells = of_mode
                    .into_iter()
                    .chain(text)
                    .chain(numbers.map(|x| x.map_or_else(String::new, |x| x.to_string())));
                rows.push(key(&mode).into_iter().chain(cells).collect());
            }
        }
    }
    Table::new("sensitivities", [&SceneLabels::MODE_COLUMNS[..], &own].concat(), rows)
}

/// Lines on the scenes, one each: its fastest growing mode, and which parameters change that growth by most.
pub(super) fn reasons_in_words(plan: &Plan, reasons: &[SceneReasons]) -> String {
    let mut text = String::from(
        "\n## Why\n\nWhat changes the growth of the fastest growing mode of a scene at its medians by most, as a parameter grows by 1 %; \
         sensitivities.csv has all:\n\n",
    );
    for SceneReasons { scene, modes } in reasons {
        let described = plan.describe(&plan.scenes[*scene]);
        let fastest = match modes {
            Ok(modes) => modes.iter().max_by(|a, b| a.1.lambda.re.total_cmp(&b.1.lambda.re)),
            Err(reason) => {
                text += &format!("- {described}: no answer, {reason}\n");
                continue;
            }
        };
        let Some((names, why)) = fastest else {
            text += &format!("- {described}: no oscillating mode surely grows at its medians\n");
            continue;
        };
        let changing = |influence: &&Influence| influence.kind == InfluenceKind::Parameter && influence.growth != 0.0;
        let (mut by_percent, mut by_unit) = (Vec::new(), Vec::new());
        for influence in why.influences.iter().filter(changing) {
            let name = &influence.name;
            match influence.growth_per_percent {
                Some(change) => {
                    let caution = if influence.holds_for_a_percent() { "" } else { " (for less than 1 %)" };
                    by_percent.push(format!("{name} by {} 1/s{caution}", signed(change)));
                }
                None => by_unit.push(format!(
                    "{name}, which is 0, by {} {}",
                    signed(influence.growth),
                    influence.per_unit()
                )),
            }
        }
        let most = |of: Vec<String>| of.into_iter().take(MOST_IN_A_SENTENCE);
        let mut listed: Vec<String> = most(by_percent).chain(most(by_unit)).collect();
        if listed.is_empty() && why.not_varied.is_empty() {
            let nothing =
                if why.names_parameters { "no named parameter changes it" } else { "the brake names no parameters" };
            listed.push(nothing.to_owned());
        }
        if !why.not_varied.is_empty() {
            listed.push(format!("not varied, at an end of what is allowed: {}", why.not_varied.join(", ")));
        }
        let change = match why.is_simple {
            true => listed.join(", "),
            false => "it has no derivatives, equal to another eigenvalue within rounding".to_owned(),
        };
        let (hz, growth) = (hertz(frequency_hz(why.lambda)), why.lambda.re);
        let mode = match &names[..] {
            [] => "a mode without a name".to_owned(),
            _ => format!("mode {}", ModeLabel::candidates(names)),
        };
        text += &format!("- {described}: {mode} at {hz} Hz, growth {} 1/s: {change}\n", significant(growth, 4));
    }
    text
}

/// A number with three digits and its sign.
fn signed(change: f64) -> String {
    format!("{}{}", if change > 0.0 { "+" } else { "" }, significant(change, 3))
}
