//! Results of a sweep, for people and for machines.

use cea::{Threshold, frequency_hz};
use output::{Table, significant};
use serde_json::{Value, json};

use super::found_openings::{change_table, lines_text, opening_table, opening_text};
use super::words::{count, hertz};
use super::{
    BoundaryCurve, ChangeOf, Coalescence, CurveEnd, Evaluations, GrowingBeside, Marginal, Miscount, StabilityMap,
    Sweep, SweepOnset, SweptParameter,
};

/// A sweep over one parameter or two.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// Sweep over one parameter.
    Branches(Box<Sweep>),
    /// Stability map over two parameters.
    Map(Box<StabilityMap>),
}

/// Words for what a mode does at an onset.
pub fn event(starts: bool, threshold: &Threshold) -> &'static str {
    match (starts, threshold.is_axis()) {
        (true, true) => "starts to grow",
        (false, true) => "stops growing",
        (true, false) => "becomes unstable",
        (false, false) => "becomes stable",
    }
}

impl SweepOnset {
    /// Words for what happens where the parameter grows, as tables have them.
    pub fn direction(&self) -> &'static str {
        match (self.of, self.starts) {
            (ChangeOf::Exchange, true) => "flutter-to-divergence",
            (ChangeOf::Exchange, false) => "divergence-to-flutter",
            (ChangeOf::Band, true) => "enters-band",
            (ChangeOf::Band, false) => "leaves-band",
            (_, true) => "starts",
            (_, false) => "stops",
        }
    }

    /// Words for what happens at the onset.
    pub fn event(&self, threshold: &Threshold) -> &'static str {
        match (self.of, self.starts, threshold.is_axis()) {
            (ChangeOf::Exchange, true, _) => "flutter becomes divergence",
            (ChangeOf::Exchange, false, _) => "divergence becomes flutter",
            (ChangeOf::Band, true, true) => "enters the band, growing",
            (ChangeOf::Band, false, true) => "leaves the band, still growing",
            (ChangeOf::Band, true, false) => "enters the band, unstable",
            (ChangeOf::Band, false, false) => "leaves the band, still unstable",
            (ChangeOf::Divergence, true, true) => "starts to diverge",
            (ChangeOf::Divergence, false, true) => "stops diverging",
            _ => event(self.starts, threshold),
        }
    }
}

impl Sweep {
    /// Least distance of two changes that are surely both found, in words.
    fn certain(&self) -> String {
        let SweptParameter { name, from, to, is_logarithmic, .. } = &self.parameter;
        let steps = self.steps as f64;
        if *is_logarithmic {
            format!(
                "changes farther apart than a factor of {:.6} of {name} are all found",
                (to / from).powf(1.0 / steps)
            )
        } else {
            format!("changes farther apart than {:.3e} of {name} are all found", (to - from) / steps)
        }
    }
}

impl Found {
    /// Numbers of spectra, vectors and eigenvalues computed.
    pub fn evaluations(&self) -> Evaluations {
        match self {
            Self::Branches(sweep) => sweep.evaluations,
            Self::Map(map) => map.evaluations,
        }
    }

    /// Number of spectra of a grid of equal steps that is as fine: as the shortest step of a branch, or as the cells of the map.
    pub fn fine_grid(&self) -> u64 {
        match self {
            Self::Branches(sweep) => sweep.fine_grid,
            Self::Map(map) => map.fine_grid,
        }
    }

    /// The swept parameters.
    pub fn parameters(&self) -> &[SweptParameter] {
        match self {
            Self::Branches(sweep) => std::slice::from_ref(&sweep.parameter),
            Self::Map(map) => &map.parameters,
        }
    }

    /// Tables of the results: `branches`, `onsets` and `coalescences` of one parameter, `boundary` and `regions` of two.
    pub fn tables(&self) -> Vec<Table> {
        match self {
            Self::Branches(sweep) => branch_tables(sweep),
            Self::Map(map) => map_tables(map),
        }
    }

    /// Results as JSON, for machines: all but the points of branches.
    pub fn json(&self) -> Value {
        let counts = json!({ "evaluations": self.evaluations(), "fine_grid": self.fine_grid() });
        let mut all = match self {
            Self::Branches(sweep) => json!({
                "parameter": sweep.parameter,
                "unstable_at_start": sweep.unstable_at_start,
                "diverging_at_start": sweep.diverging_at_start,
                "unstable_at_end": sweep.unstable_at_end,
                "miscounts": sweep.miscounts,
                "divergence_looked_for": sweep.counts_divergence,
                "growing_beside": sweep.growing_beside,
                "marginal": sweep.marginal,
                "steps_counted": sweep.steps,
                "onsets": sweep.onsets,
                "unresolved": sweep.unresolved,
                "coalescences": sweep.coalescences,
                "branches": sweep.branches.iter().map(|branch| json!({
                    "mode": branch.mode,
                    "from": branch.points.first().map(|point| point.0),
                    "to": branch.points.last().map(|point| point.0),
                })).collect::<Vec<_>>(),
            }),
            Self::Map(map) => json!({
                "parameters": map.parameters,
                "boundary": map.curves,
                "regions": map.regions.iter().map(|region| json!({
                    "unstable": region.unstable,
                    "share": region.share,
                    "at": [map.parameters[0].at(region.at[0]), map.parameters[1].at(region.at[1])],
                })).collect::<Vec<_>>(),
                "grid": map.grid,
                "divergence_looked_for": map.counts_divergence,
                "unresolved": map.unresolved,
                "checks": map.checks,
            }),
        };
        if let Self::Branches(sweep) = self
            && let Some(steps) = sweep.opening_steps
        {
            all["openings"] = json!(sweep.openings);
            all["opening_steps"] = json!(steps);
        }
        if let Self::Map(map) = self
            && let Some(distance) = map.from_whole
        {
            all["from_whole"] = json!(distance);
        }
        if let Self::Map(map) = self
            && let Some(lines) = &map.lines
        {
            all["lines"] = json!(lines);
        }
        all["counts"] = counts;
        all
    }

    /// Results in words, for people.
    pub fn text(&self) -> String {
        match self {
            Self::Branches(sweep) => branch_text(sweep),
            Self::Map(map) => map_text(map),
        }
    }
}

fn branch_tables(sweep: &Sweep) -> Vec<Table> {
    let name = sweep.parameter.name.as_str();
    let points = sweep.branches.iter().enumerate().flat_map(|(index, branch)| {
        branch.points.iter().map(move |(at, point)| {
            let (lambda, rate) = (point.lambda, point.rate);
            let numbers = [*at, frequency_hz(lambda), lambda.re, hertz(rate.im), rate.re];
            let mut row = vec![(index + 1).to_string(), branch.mode.clone()];
            row.extend(numbers.map(|number| number.to_string()));
            row
        })
    });
    let header = ["branch", "mode", name, "frequency_hz", "growth", "frequency_rate", "growth_rate"];
    let branches = Table::new("branches", header, points);
    let is_of_reduced = sweep.onsets.iter().any(|onset| onset.moved.is_some() || onset.is_reduced);
    let has_jumps = sweep.onsets.iter().any(|onset| onset.jump.is_some());
    let onset = |onset: &SweepOnset| {
        let SweepOnset { at, error, omega, ref mode, moved, .. } = *onset;
        let mode = mode.clone();
        let mut row = vec![at.to_string(), error.to_string(), onset.direction().into(), mode, hertz(omega).to_string()];
        row.extend([onset.growth.to_string(), onset.unstable.to_string()]);
        if has_jumps {
            row.push(onset.jump.map_or(String::new(), |[_, beyond]| beyond.to_string()));
        }
        if is_of_reduced {
            row.push(moved.map_or(String::new(), |moved| moved.to_string()));
            row.push(if onset.is_reduced { "reduced" } else { "whole" }.into());
        }
        row
    };
    let mut header = vec![name, "error", "direction", "mode", "frequency_hz", "growth", "unstable"];
    header.extend(["growth_beyond"].into_iter().filter(|_| has_jumps));
    header.extend(["from_reduced", "brake"].into_iter().filter(|_| is_of_reduced));
    let onsets = Table::new("onsets", header, sweep.onsets.iter().map(onset));
    let coalescence = |found: &Coalescence| {
        let numbers = [found.at, found.distance, found.error, hertz(found.omega), found.growth];
        found.modes.iter().cloned().chain(numbers.map(|number| number.to_string())).collect()
    };
    let header = ["mode", "other_mode", name, "distance", "error", "frequency_hz", "growth"];
    let mut tables =
        vec![branches, onsets, Table::new("coalescences", header, sweep.coalescences.iter().map(coalescence))];
    tables.extend(sweep.opening_steps.map(|_| opening_table(sweep)));
    tables
}

fn map_tables(map: &StabilityMap) -> Vec<Table> {
    let [x, y] = map.parameters.each_ref().map(|parameter| parameter.name.as_str());
    let points = map.curves.iter().enumerate().flat_map(|(index, curve)| {
        curve.points.iter().map(move |point| {
            let numbers = [point.at[0], point.at[1], hertz(point.omega)].map(|number| number.to_string());
            [(index + 1).to_string(), curve.mode.clone()].into_iter().chain(numbers).collect()
        })
    });
    let boundary = Table::new("boundary", ["curve", "mode", x, y, "frequency_hz"], points);
    let regions = map.regions.iter().map(|region| {
        let at = [0, 1].map(|i| map.parameters[i].at(region.at[i]).to_string());
        [region.unstable.to_string(), region.share.to_string()].into_iter().chain(at).collect()
    });
    let mut tables = vec![boundary, Table::new("regions", ["unstable", "share", x, y], regions)];
    tables.extend(map.lines.as_ref().map(|lines| change_table([x, y], lines)));
    tables
}

/// Largest distance of the onsets of the full model from those of its reduction; `None` where the brake is not reduced, or has none.
fn largest_move(sweep: &Sweep) -> Option<f64> {
    sweep.onsets.iter().filter_map(|onset| onset.moved.map(f64::abs)).reduce(f64::max)
}

fn branch_text(sweep: &Sweep) -> String {
    let SweptParameter { name, from, .. } = &sweep.parameter;
    let mut text = format!("{} unstable at {name} = {from}", count(sweep.unstable_at_start, "mode", "modes"));
    if sweep.diverging_at_start > 0 {
        let above = match sweep.threshold.growth_above() {
            0.0 => "zero".to_owned(),
            growth => format!("{growth} 1/s"),
        };
        let diverging = count(sweep.diverging_at_start, "diverges", "diverge");
        text += &format!(", of which {diverging}: real eigenvalues above {above}");
    }
    text += "\n";
    text += &in_doubt(sweep);
    text += not_looked_for(sweep.counts_divergence);
    for Marginal { from, to, modes } in &sweep.marginal {
        let (modes, on) =
            (count(*modes, "mode", "modes"), if sweep.threshold.is_axis() { "axis" } else { "threshold" });
        let what = if sweep.threshold.is_axis() { ": marginal, neither growing nor decaying" } else { "" };
        text += &format!("{modes} on the {on} at {name} = {from} to {to}{what}\n");
    }
    let width = widest(sweep.onsets.iter().map(|onset| &onset.mode));
    if !sweep.onsets.is_empty() {
        text += &format!("\n{name:>22}  {:>8}  {:>width$}  {:>12}  {:>8}\n", "error", "mode", "Hz", "unstable");
    }
    for onset in &sweep.onsets {
        let (hz, does) = (output::hertz(hertz(onset.omega)), onset.event(&sweep.threshold));
        let whose = if onset.is_reduced { ", of the REDUCED brake: that of the whole one was not found" } else { "" };
        let jumps = onset.jump.map_or(String::new(), |[before, beyond]| {
            format!(", by a jump at an opening, growth from {before:.4} to {beyond:.4} 1/s")
        });
        let SweepOnset { at, error, mode, unstable, .. } = onset;
        text += &format!("{at:>22}  {error:>8.1e}  {mode:>width$}  {hz:>12}  {unstable:>8}  {does}{jumps}{whose}\n");
    }
    if let Some(moved) = largest_move(sweep) {
        let solved = count(sweep.evaluations.whole as usize, "eigenvalue", "eigenvalues");
        let are_all = !sweep.onsets.iter().any(|onset| onset.is_reduced);
        let onsets = if are_all { "onsets are" } else { "the other onsets are" };
        text += &format!(
            "{onsets} those of the whole brake, by {solved} of it: the reduced brake has them within {moved:.1e}\n"
        );
    }
    text += &opening_text(sweep);
    for (from, to) in &sweep.unresolved {
        let line = if sweep.threshold.is_axis() { "axis" } else { "threshold" };
        text += &format!("{name} = {from} to {to}: a mode comes so near the {line} that it may cross it or not\n");
    }
    if !sweep.coalescences.is_empty() {
        let (off, error) = ("off by", "error");
        text += &format!("\n{name:>22}  {error:>8}  {off:>8}  {:>14}  {:>12}  {:>12}\n", "modes", "Hz", "growth 1/s");
    }
    for found in &sweep.coalescences {
        let (modes, hz) = (found.modes.join(" and "), output::hertz(hertz(found.omega)));
        let what = if found.distance <= found.error.max(f64::EPSILON) { "coalesce" } else { "nearly coalesce" };
        text += &format!(
            "{:>22}  {:>8.1e}  {:>8.1e}  {modes:>14}  {hz:>12}  {:>12.4}  {what}\n",
            significant(found.at, 7),
            found.error,
            found.distance,
            found.growth
        );
    }
    let Evaluations { spectra, eigenvectors, .. } = sweep.evaluations;
    text + &format!(
        "\n{}\n{} with {} solved\n",
        sweep.certain(),
        count(spectra as usize, "spectrum", "spectra"),
        count(eigenvectors as usize, "vector", "vectors"),
    )
}

/// Words for what a sweep does not count, or counts wrong.
fn in_doubt(sweep: &Sweep) -> String {
    sweep.doubts().into_iter().map(|doubt| doubt + "\n").collect()
}

impl Sweep {
    /// Sentences on what the onsets leave out: where spectra contradict them, and modes that grow next to the band that is studied.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        let name = &self.parameter.name;
        let miscount = |&Miscount { at, by_spectrum, by_onsets }: &Miscount| {
            let modes = count(by_spectrum, "unstable mode", "unstable modes");
            format!(
                "WARNING: at {name} = {at} the spectrum has {modes}, where the onsets up to there say {by_onsets}: some change is not listed, or none is there"
            )
        };
        let beside = |&GrowingBeside { from, to, modes, omega }: &GrowingBeside| {
            let (grow, they_do) = if modes == 1 { ("grows", "it does") } else { ("grow", "they do") };
            let modes = count(modes, "mode", "modes");
            let [least, largest] = omega.map(|omega| output::hertz(hertz(omega)));
            format!(
                "{modes} {grow} NEXT to the band, where {they_do} not count: {least} to {largest} Hz, at {name} = {} to {}",
                significant(from, 4),
                significant(to, 4)
            )
        };
        let beside = self.growing_beside.iter().flatten().map(beside);
        self.miscounts.iter().map(miscount).chain(beside).collect()
    }
}

/// Words that stand first where divergence was not looked for.
pub fn not_looked_for(counts_divergence: bool) -> &'static str {
    match counts_divergence {
        true => "",
        false => {
            "divergence was NOT looked for: a reduced brake has the modes of its band alone; squeal run and squeal cea look for it in the whole one\n"
        }
    }
}

/// Width of a column of names, in characters.
fn widest<'a>(names: impl Iterator<Item = &'a String>) -> usize {
    names.map(|name| name.chars().count()).fold(8, usize::max)
}

fn map_text(map: &StabilityMap) -> String {
    let [x, y] = map.parameters.each_ref().map(|parameter| parameter.name.as_str());
    let width = widest(map.curves.iter().map(|curve| &curve.mode));
    let mut text = not_looked_for(map.counts_divergence).to_owned();
    text += &lines_text(map);
    if map.lines.is_none() {
        text += &format!("{:>width$}  {:>6}  {:>22}  boundary\n", "mode", "points", "Hz");
    }
    for BoundaryCurve { mode, ends, points } in &map.curves {
        let of = |value: fn(&super::BoundaryPoint) -> f64, pick: fn(f64, f64) -> f64, start: f64| {
            points.iter().map(value).fold(start, pick)
        };
        let hz =
            [of(|point| hertz(point.omega), f64::min, f64::INFINITY), of(|point| hertz(point.omega), f64::max, 0.0)];
        let [x_from, x_to] = [of(|p| p.at[0], f64::min, f64::INFINITY), of(|p| p.at[0], f64::max, f64::NEG_INFINITY)];
        let [y_from, y_to] = [of(|p| p.at[1], f64::min, f64::INFINITY), of(|p| p.at[1], f64::max, f64::NEG_INFINITY)];
        let [x_from, x_to, y_from, y_to] = [x_from, x_to, y_from, y_to].map(|end| significant(end, 6));
        let how = match ends {
            [CurveEnd::Closed, _] => ", closed",
            [CurveEnd::Edge, CurveEnd::Edge] => "",
            _ => ", cannot be followed farther",
        };
        text += &format!(
            "{mode:>width$}  {:>6}  {:>22}  {x} = {x_from} to {x_to}, {y} = {y_from} to {y_to}{how}\n",
            points.len(),
            format!("{} to {}", output::hertz(hz[0]), output::hertz(hz[1])),
        );
    }
    text += "\nunstable     share  regions\n";
    for (unstable, (share, regions)) in map.shares() {
        text += &format!("{unstable:>8}  {:>6.2} %  {regions:>7}\n", 100.0 * share);
    }
    text += &map.share_in_words().map_or_else(String::new, |words| words + "\n");
    text += "\n";
    if let Some(distance) = map.from_whole {
        let points = count(map.evaluations.whole as usize, "point", "points");
        text += &format!("the boundary of the whole brake is within {distance:.1e} of the ranges, at {points} of it\n");
    }
    if map.unresolved > 0 {
        text += &format!("{} on lines of the grid left open\n", count(map.unresolved, "step", "steps"));
    }
    if map.lines.is_some() {
        let spectra = map.evaluations.spectra;
        return text
            + &format!(
                "{spectra} spectra solved; spectra at {} places count as many unstable modes as the lines\n",
                map.checks
            );
    }
    let Evaluations { spectra, eigenvectors, continued, .. } = map.evaluations;
    text + &format!(
        "{spectra} spectra with {eigenvectors} vectors solved, {continued} eigenvalues continued; one spectrum in each cell of the \
         figure takes {}\nspectra at {} places count as many unstable modes as the curves; closed curves that meet none of the lines at each \
         {} of the ranges and hold none of these places are not found\n",
        map.fine_grid,
        map.checks,
        format_args!("1/{}", map.grid),
    )
}
