//! Tables and text of the motions of draws.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;

use montecarlo::{Confidence, Interval, clopper_pearson, quantile, rank_correlation};
use output::Table;
use study::{ModeLabel, Plan, SceneLabels};

use crate::Error;

use super::{CyclesOfDraws, DrawnFate, DrawnMotion, SceneDraws};

/// Scenes that are printed; more are in the tables. Chosen: a screen of lines.
const MOST_PRINTED: usize = 6;

/// Motions whose loudness differs by this part of the loudest are equally loud; chosen.
const EQUALLY_LOUD: f64 = 0.01;

/// Kinds of motions, in the order of tables.
const KINDS: [&str; 6] = ["cycle", "not periodic", "not settled", "rest", "unbounded", "not followed"];

/// Numbers of some motions of a scene.
struct Counted {
    /// Number of each kind.
    kinds: [u64; KINDS.len()],
    /// Share of cycles, with its 95 % interval.
    cycles: (f64, Interval),
    /// Loudness at 50, 5 and 95 % of those that have one, m/s, and their number.
    loudness: Option<[f64; 3]>,
    measured: usize,
    /// Median frequency of CEA and of the cycles, Hz.
    cea_hz: f64,
    cycle_hz: Option<f64>,
    /// Rank correlation of growth and loudness.
    order: Option<f64>,
}

/// Sorted numbers.
fn sorted(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    numbers
}

/// A proportion with its exact 95 % interval.
fn share(hits: u64, trials: u64) -> (f64, Interval) {
    let interval = clopper_pearson(hits, trials, Confidence::P95).unwrap_or(Interval { lower: 0.0, upper: 1.0 });
    (if trials == 0 { 0.0 } else { hits as f64 / trials as f64 }, interval)
}

/// Motions that are followed, with their fates.
fn fates(motions: &[DrawnMotion]) -> impl Iterator<Item = (&DrawnMotion, &DrawnFate)> {
    motions.iter().filter_map(|motion| Some((motion, motion.fate.as_ref()?)))
}

impl Counted {
    fn new(motions: &[(&DrawnMotion, &DrawnFate)]) -> Self {
        let mut kinds = [0; KINDS.len()];
        for (_, fate) in motions {
            KINDS.iter().zip(&mut kinds).for_each(|(kind, count)| *count += u64::from(*kind == fate.kind()));
        }
        let pairs: Vec<(f64, f64)> =
            motions.iter().filter_map(|(motion, fate)| Some((motion.growth, fate.loudness()?))).collect();
        let loudness = sorted(pairs.iter().map(|pair| pair.1));
        let at = |p: f64| quantile(&loudness, p).ok();
        let cea_hz = sorted(motions.iter().map(|(motion, _)| motion.omega / TAU));
        let cycle_hz = sorted(motions.iter().filter_map(|(_, fate)| cycle_hz(fate)));
        Self {
            kinds,
            cycles: share(kinds[0], motions.len() as u64),
            loudness: at(0.5).zip(at(0.05)).zip(at(0.95)).map(|((median, low), high)| [median, low, high]),
            measured: loudness.len(),
            cea_hz: quantile(&cea_hz, 0.5).unwrap_or(f64::NAN),
            cycle_hz: quantile(&cycle_hz, 0.5).ok(),
            order: rank_correlation(&pairs),
        }
    }

    /// Cells of a row: the kinds, the share of cycles, loudness, frequencies, order.
    fn cells(&self) -> Vec<String> {
        let mut cells: Vec<String> = self.kinds.iter().map(ToString::to_string).collect();
        let (value, Interval { lower, upper }) = self.cycles;
        cells.extend([value, lower, upper].map(|number| number.to_string()));
        let loudness = self.loudness.map(|loudness| loudness.map(Some)).unwrap_or_default();
        cells.extend([self.measured.to_string()].into_iter().chain(loudness.map(text)));
        cells.extend([self.cea_hz.to_string(), text(self.cycle_hz), text(self.order)]);
        cells
    }

    const COLUMNS: [&str; 16] = [
        "cycle",
        "not_periodic",
        "not_settled",
        "rest",
        "unbounded",
        "not_followed",
        "cycle_share",
        "cycle_share_lower",
        "cycle_share_upper",
        "measured",
        "loudness_median_m_per_s",
        "loudness_5_m_per_s",
        "loudness_95_m_per_s",
        "cea_hz_median",
        "cycle_hz_median",
        "rank_correlation",
    ];

    /// The motions in words.
    fn in_words(&self) -> String {
        let (_, Interval { lower, upper }) = self.cycles;
        let all: u64 = self.kinds.iter().sum();
        let mut words = format!("a cycle in {} of {all} (95 %: {lower:.2} to {upper:.2})", self.kinds[0]);
        words += &self.cycle_hz.map_or(String::new(), |hz| format!(" at {} Hz", output::hertz(hz)));
        for (kind, count) in KINDS.iter().zip(self.kinds).skip(1).filter(|(_, count)| *count > 0) {
            words += &format!(", {kind} in {count}");
        }
        if let Some([median, low, high]) = self.loudness {
            words += &format!("; loudness {median:.4} ({low:.4} to {high:.4})");
        }
        words + &order_in_words(self.order, self.measured)
    }
}

fn order_in_words(order: Option<f64>, of: usize) -> String {
    order.map_or(String::new(), |order| format!("; growth and loudness: rank correlation {order:.2} of {of}"))
}

fn cycle_hz(fate: &DrawnFate) -> Option<f64> {
    match fate {
        DrawnFate::Cycle { hz, .. } => Some(*hz),
        _ => None,
    }
}

fn text(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// Agreement of the order of modes by growth with that of their motions by loudness, draw by draw.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Order {
    /// Number of draws with several unstable modes whose motions all have a loudness.
    several: u64,
    /// Number of these in which all are equally loud.
    equally_loud: u64,
    /// Number of the others in which the motion from the mode that grows fastest is the loudest.
    fastest_is_loudest: u64,
}

impl SceneDraws {
    fn order(&self) -> Order {
        let mut order = Order::default();
        for draw in self.draws.iter().filter(|draw| draw.motions.len() > 1) {
            let found: Option<Vec<(f64, f64)>> =
                draw.motions.iter().map(|motion| Some((motion.growth, motion.fate.as_ref()?.loudness()?))).collect();
            let Some(found) = found else { continue };
            order.several += 1;
            let loudest = found.iter().map(|pair| pair.1).fold(0.0, f64::max);
            let is_loud = |loudness: f64| loudness >= (1.0 - EQUALLY_LOUD) * loudest;
            let fastest = found.iter().max_by(|a, b| a.0.total_cmp(&b.0));
            if found.iter().all(|pair| is_loud(pair.1)) {
                order.equally_loud += 1;
            } else if fastest.is_some_and(|pair| is_loud(pair.1)) {
                order.fastest_is_loudest += 1;
            }
        }
        order
    }

    /// Growth of the fastest mode and loudness of the loudest motion of each draw all of whose motions have one.
    fn of_draws(&self) -> Vec<(f64, f64)> {
        let pair = |draw: &super::DrawOfScene| {
            let growth = draw.motions.iter().map(|motion| motion.growth).fold(0.0, f64::max);
            let loudness = draw.motions.iter().map(|motion| motion.fate.as_ref()?.loudness());
            Some((growth, loudness.collect::<Option<Vec<f64>>>()?.into_iter().fold(0.0, f64::max)))
        };
        self.draws.iter().filter_map(pair).collect()
    }

    /// The motions by the names of their modes.
    fn by_mode(&self) -> BTreeMap<String, Vec<(&DrawnMotion, &DrawnFate)>> {
        let mut modes: BTreeMap<String, Vec<(&DrawnMotion, &DrawnFate)>> = BTreeMap::new();
        for (motion, fate) in self.draws.iter().flat_map(|draw| fates(&draw.motions)) {
            modes.entry(ModeLabel::candidates(&motion.names)).or_default().push((motion, fate));
        }
        modes
    }
}

/// Each of some names once, in their order.
fn once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = Vec::new();
    for name in names {
        if !seen.contains(&name) {
            seen.push(name);
        }
    }
    seen
}

/// The columns that say which scene.
fn scene_header() -> Vec<String> {
    SceneLabels::SCENE_COLUMNS.iter().map(ToString::to_string).collect()
}

impl CyclesOfDraws {
    /// The motions of draws as tables: `cycles_of_draws`, one motion a row, `cycles_by_mode` and `cycles_by_scene`.
    #[must_use]
    pub fn tables(&self, plan: &Plan) -> Vec<Table> {
        vec![self.motions(plan), self.modes(plan), self.orders(plan)]
    }

    fn motions(&self, plan: &Plan) -> Table {
        let scenes = || plan.scenes.iter().zip(&self.scenes);
        let bodies = once(scenes().flat_map(|(scene, _)| &plan.brake(scene).bodies).map(|body| &*body.name));
        let contacts = once(scenes().flat_map(|(_, of)| &of.contacts).map(String::as_str));
        let own = [
            "sample",
            "mode",
            "growth_per_s",
            "cea_hz",
            "kind",
            "reason",
            "cycle_hz",
            "largest_multiplier",
            "loudness_m_per_s",
            "loudness_spread",
            "periods",
        ];
        let mut header = scene_header();
        header.extend(own.map(str::to_owned));
        // The coordinates of a reduced brake have no largest displacement.
        let has_peaks = plan.band.is_none();
        for name in &bodies {
            header.push(format!("rms_velocity_m_per_s {name}"));
            header.extend(has_peaks.then(|| format!("peak_m {name}")));
        }
        header.extend(contacts.iter().flat_map(|name| [format!("open {name}"), format!("stuck {name}")]));
        let mut rows = Vec::new();
        for (scene, of) in plan.scenes.iter().zip(&self.scenes) {
            let own_bodies: Vec<&str> = plan.brake(scene).bodies.iter().map(|body| &*body.name).collect();
            for draw in &of.draws {
                for (motion, fate) in fates(&draw.motions) {
                    let mut row = plan.labels.scene_columns(scene);
                    let (reason, multiplier, [spread, periods]) = match fate {
                        DrawnFate::NotFollowed(reason) => (reason.as_str(), None, [None; 2]),
                        DrawnFate::Cycle { largest_multiplier, .. } => ("", Some(*largest_multiplier), [None; 2]),
                        DrawnFate::NotPeriodic { spread, periods, .. } => ("", None, [*spread, *periods].map(Some)),
                        DrawnFate::Rest | DrawnFate::Unbounded => ("", None, [None; 2]),
                    };
                    row.extend([
                        draw.sample.to_string(),
                        ModeLabel::candidates(&motion.names),
                        motion.growth.to_string(),
                    ]);
                    row.extend([(motion.omega / TAU).to_string(), fate.kind().to_owned(), reason.to_owned()]);
                    row.extend([cycle_hz(fate), multiplier, fate.loudness(), spread, periods].map(text));
                    let measured = fate.measured();
                    let pair =
                        |found: Option<(f64, f64)>| [found.map(|pair| pair.0), found.map(|pair| pair.1)].map(text);
                    for name in &bodies {
                        let at = own_bodies.iter().position(|own| own == name);
                        let [rms, peak] = pair(measured.zip(at).map(|(measured, at)| measured.bodies[at]));
                        row.push(rms);
                        row.extend(has_peaks.then_some(peak));
                    }
                    for name in &contacts {
                        let at = of.contacts.iter().position(|own| own == name);
                        row.extend(pair(measured.zip(at).map(|(measured, at)| measured.contacts[at])));
                    }
                    rows.push(row);
                }
            }
        }
        Table::new("cycles_of_draws", header, rows)
    }

    fn modes(&self, plan: &Plan) -> Table {
        let mut header = scene_header();
        header.extend(["mode", "draws"].map(str::to_owned));
        header.extend(Counted::COLUMNS.map(str::to_owned));
        let rows = plan.scenes.iter().zip(&self.scenes).flat_map(|(scene, of)| {
            of.by_mode().into_iter().map(|(mode, motions)| {
                let mut row = plan.labels.scene_columns(scene);
                row.extend([mode, motions.len().to_string()]);
                row.extend(Counted::new(&motions).cells());
                row
            })
        });
        Table::new("cycles_by_mode", header, rows.collect::<Vec<_>>())
    }

    fn orders(&self, plan: &Plan) -> Table {
        let mut header = scene_header();
        let own = [
            "draws",
            "motions",
            "several_modes",
            "equally_loud",
            "fastest_is_loudest",
            "fastest_is_loudest_lower",
            "fastest_is_loudest_upper",
            "measured_draws",
            "rank_correlation",
        ];
        header.extend(own.map(str::to_owned));
        let rows = plan.scenes.iter().zip(&self.scenes).filter(|(_, of)| !of.draws.is_empty()).map(|(scene, of)| {
            let (Order { several, equally_loud, fastest_is_loudest }, pairs) = (of.order(), of.of_draws());
            let (_, Interval { lower, upper }) = share(fastest_is_loudest, several - equally_loud);
            let mut row = plan.labels.scene_columns(scene);
            row.extend([
                of.draws.len().to_string(),
                of.draws.iter().map(|draw| draw.motions.len()).sum::<usize>().to_string(),
            ]);
            row.extend([several, equally_loud, fastest_is_loudest].map(|count| count.to_string()));
            row.extend([lower.to_string(), upper.to_string(), pairs.len().to_string(), text(rank_correlation(&pairs))]);
            row
        });
        Table::new("cycles_by_scene", header, rows.collect::<Vec<_>>())
    }

    /// Words above the motions.
    pub const HEADING: &str = "The motions that unstable modes grow into";

    /// Adds the motions in words to `summary.md` in a folder.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn add_to_summary(&self, plan: &Plan, dir: &Path) -> Result<(), Error> {
        let path = dir.join("summary.md");
        let summary = std::fs::read_to_string(&path).map_err(|source| Error::Read { path: path.clone(), source })?;
        let motions = format!("{summary}\n## {}\n\n```text\n{}```\n", Self::HEADING, self.text(plan));
        Ok(output::write(&path, motions.as_bytes())?)
    }

    /// The motions in words: of the first scenes with unstable draws by mode, with the order by loudness beside that by growth.
    #[must_use]
    pub fn text(&self, plan: &Plan) -> String {
        let squealing: Vec<_> = plan.scenes.iter().zip(&self.scenes).filter(|(_, of)| !of.draws.is_empty()).collect();
        let mut text = format!(
            "Motions from each unstable mode of the first {} unstable samples of each scene; loudness: rms velocity of all displacements together, \
             m/s, median (5 to 95 % of the draws):\n",
            self.most_draws
        );
        if squealing.is_empty() {
            return text + "  no sample has an unstable mode\n";
        }
        for (scene, of) in squealing.iter().take(MOST_PRINTED) {
            text += &format!("{}:\n", plan.describe(scene));
            for (mode, motions) in of.by_mode() {
                let found = Counted::new(&motions);
                text += &format!("  mode {mode}, {} Hz: {}\n", output::hertz(found.cea_hz), found.in_words());
            }
            let (Order { several, equally_loud, fastest_is_loudest }, pairs) = (of.order(), of.of_draws());
            if several > 0 {
                let (others, equal) = (several - equally_loud, equally_loud);
                let (_, Interval { lower, upper }) = share(fastest_is_loudest, others);
                text += &format!(
                    "  of {several} draws with several unstable modes {equal} have motions equally loud within 1 %; in {fastest_is_loudest} of the other \
                     {others} (95 %: {lower:.2} to {upper:.2}) the fastest mode makes the loudest motion\n"
                );
                text += &rank_correlation(&pairs).map_or(String::new(), |order| {
                    format!(
                        "  growth of the fastest mode and loudness of the loudest motion of a draw: rank correlation {order:.2} of {}\n",
                        pairs.len()
                    )
                });
            }
        }
        if squealing.len() > MOST_PRINTED {
            text += &format!(
                "{} more scenes with unstable samples in cycles_by_mode.csv and cycles_by_scene.csv\n",
                squealing.len() - MOST_PRINTED
            );
        }
        let mut kinds = [0; KINDS.len()];
        for (_, fate) in self.scenes.iter().flat_map(|of| &of.draws).flat_map(|draw| fates(&draw.motions)) {
            KINDS.iter().zip(&mut kinds).for_each(|(kind, count)| *count += u64::from(*kind == fate.kind()));
        }
        let kinds: Vec<String> = KINDS.iter().zip(kinds).map(|(kind, count)| format!("{kind} {count}")).collect();
        text + &format!("all motions: {}\n", kinds.join(", "))
    }
}
