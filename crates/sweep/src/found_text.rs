//! A sweep in words, for people.

use output::significant;

use super::found_openings::{lines_text, opening_text};
use super::words::{count, hertz};
use super::{
    BoundaryCurve, CELLS, CurveEnd, Evaluations, Found, GrowingBeside, Marginal, Miscount, StabilityMap, Sweep,
    SweepOnset, SweptParameter,
};

impl Found {
    /// Results in words, for people.
    pub fn text(&self) -> String {
        match self {
            Self::Branches(sweep) => branch_text(sweep),
            Self::Map(map) => map_text(map),
        }
    }
}

impl Sweep {
    /// Least distance of two changes that are surely both found, in words.
    fn certain(&self) -> String {
        let but = if self.unresolved.is_empty() { "" } else { " but in the ranges that are open" };
        let distance = self.parameter.step_in_words(self.steps);
        let whose = self.loss_steps.map_or_else(String::new, |steps| {
            format!(
                ", of the system that has dashpots in the place of loss factors; with loss factors unstable modes were counted at {} places",
                steps + 1
            )
        });
        format!("changes farther apart than {distance} are all found{but}{whose}")
    }
}

/// Largest distance of an onset of the full model from the onset of its reduction; `None` where the brake is not reduced, or no onset of the full model is
/// known.
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
    for range in &sweep.marginal {
        let (Marginal { from, to, .. }, modes) = (range, range.in_words());
        let [on, what] = match sweep.threshold.is_axis() {
            true => ["axis", ": marginal, neither growing nor decaying"],
            false => ["threshold", ""],
        };
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
                "WARNING: at {name} = {} the spectrum has {modes}, where the onsets up to there say {by_onsets}: some change is not listed, or none is there",
                significant(at, 9)
            )
        };
        let grows_beside = |&GrowingBeside { from, to, modes, omega }: &GrowingBeside| {
            let (grow, they_do) = if modes == 1 { ("grows", "it does") } else { ("grow", "they do") };
            let modes = count(modes, "mode", "modes");
            let [least, largest] = omega.map(|omega| output::hertz(hertz(omega)));
            format!(
                "{modes} {grow} NEXT to the band, where {they_do} not count: {least} to {largest} Hz, at {name} = {} to {}",
                significant(from, 4),
                significant(to, 4)
            )
        };
        let beside = self.growing_beside.iter().flatten().map(grows_beside);
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
    if map.narrow_share() > 0.0 {
        text += &format!(
            "{:.2} % of the map are in regions narrower than some cells of 1/{CELLS} of the ranges, which are not listed and no spectrum checks\n",
            100.0 * map.narrow_share()
        );
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
