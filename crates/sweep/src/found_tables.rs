//! Tables and JSON of a sweep, for machines.

use cea::frequency_hz;
use output::Table;
use serde_json::{Value, json};

use super::found_openings::{change_table, opening_table};
use super::words::hertz;
use super::{Coalescence, Found, StabilityMap, Sweep, SweepOnset};

impl Found {
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
                "narrow_share": map.narrow_share(),
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
