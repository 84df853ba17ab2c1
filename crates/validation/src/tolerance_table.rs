//! The time to tolerance as a table.

use std::fmt::Write as _;

use crate::time_to_tolerance::TimeToTolerance;

/// The table in Markdown.
pub(crate) fn markdown(rows: &[TimeToTolerance]) -> String {
    let mut text = String::from(
        "\n## Every occurrence to 0.1 percentage points\n\nUnconstrained scenes; 95 % for each occurrence. Amontons-Coulomb by \
         the exact integral, the others by response surfaces with control variate. Evaluations are all systems solved for a \
         scene, of the control variate as means: sample points of the surrogate + pilot samples + clear + uncertain samples. Fewer: \
         samples of plain Monte Carlo for the worst occurrence of each scene, over evaluations. Cheaper: dgeev's time on a \
         sample, measured next to it, eigenvalues alone, over the time of an evaluation with all that belongs to it",
    );
    if rows.iter().any(|row| row.plain_seconds.is_none()) {
        text += " (not measured: feature `lapack`)";
    }
    text += ".\n\n| scenes | number | occurrences | reached | largest half width | largest open | s per scene | evaluations | \
             of these | largest | plain samples | fewer | smallest | dgeev \u{b5}s | cheaper | smallest |\n\
             | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for row in rows {
        let TimeToTolerance { scenes_of, scenes, occurrences, reached, largest_half_width, largest_open, .. } = row;
        let TimeToTolerance { most_evaluations, least_fewer, .. } = row;
        let per_scene = |sum: f64| sum / *scenes as f64;
        let _ = writeln!(
            text,
            "| {scenes_of} | {scenes} | {occurrences} | {reached} | {largest_half_width:.1e} | {largest_open:.1e} | {:.2} | \
             {:.0} | {} | {most_evaluations} | {:.0} | {:.0} | {least_fewer:.0} | {} | {} | {} |",
            per_scene(row.seconds),
            per_scene(row.evaluations as f64),
            kinds(row),
            per_scene(row.plain_samples),
            row.fewer(),
            row.dgeev_us.map_or("-".into(), |us| format!("{us:.0}")),
            factor(row.cheaper()),
            factor(row.least_cheaper),
        );
    }
    text + &together(rows)
}

/// The mean numbers of evaluations of each kind per scene.
fn kinds(row: &TimeToTolerance) -> String {
    let Some(kinds) = row.kinds else { return "spectra".into() };
    let all = [kinds.sample_points, kinds.pilots, kinds.clear, kinds.uncertain];
    all.map(|sum| format!("{:.0}", sum as f64 / row.scenes as f64)).join(" + ")
}

fn factor(value: Option<f64>) -> String {
    value.map_or("-".into(), |value| format!("{value:.2}"))
}

/// Sums over all scenes in one sentence.
fn together(rows: &[TimeToTolerance]) -> String {
    let occurrences: usize = rows.iter().map(|row| row.occurrences).sum();
    let evaluations: u64 = rows.iter().map(|row| row.evaluations).sum();
    let (seconds, plain) = rows.iter().fold((0.0, 0.0), |sums, row| (sums.0 + row.seconds, sums.1 + row.plain_samples));
    let fewer = plain / evaluations as f64;
    let mut text = format!(
        "\nTogether {occurrences} occurrences in {seconds:.0} s by {evaluations} evaluations, {fewer:.0} times fewer"
    );
    if let Some(plain_seconds) = rows.iter().map(|row| row.plain_seconds).sum::<Option<f64>>() {
        let cheaper = plain_seconds / plain / (seconds / evaluations as f64);
        text += &format!(" and each {cheaper:.1} times as cheap");
    }
    text + ".\n"
}
