//! The report in Markdown.

use std::fmt::Write;

use super::machine::Machine;
use super::problems::Problem;
use super::rounds::RouteTime;
use super::study::StudyTimes;

/// The machine and the problems.
pub fn heading(machine: &Machine, problems: &[Problem], rounds: usize) -> String {
    let Machine { processor, cores, lanes, peak_gflops } = machine;
    let mut text = format!(
        "{processor}, {cores} cores, {lanes} doubles in a register, at most {peak_gflops:.1} Gflop/s on one thread\n\n\
         One thread, rounds of all routes: {rounds}. us: processor time of one problem, median and quartiles. ratio: time\n\
         over that of dgeev, median over the rounds. error: largest relative error of an eigenvalue.\n\n"
    );
    for problem in problems {
        let Problem { description, systems, references, .. } = problem;
        let _ = writeln!(
            text,
            "- n = {}: {description}; {} draws, {} of them with reference eigenvalues",
            size(problem.n, problem.states),
            systems.len(),
            references.len()
        );
    }
    text
}

/// n, and the number of internal states where there are some.
fn size(n: usize, states: usize) -> String {
    if states == 0 { n.to_string() } else { format!("{n} + {states}") }
}

/// The table of routes and sizes.
pub fn routes(rows: &[RouteTime]) -> String {
    let mut lines = vec![["n", "route", "us", "quartiles", "ratio", "dgeev / route", "error"].map(String::from)];
    for (at, row) in rows.iter().enumerate() {
        let own = size(row.n, row.states);
        let is_first = at == 0 || size(rows[at - 1].n, rows[at - 1].states) != own;
        let [low, high] = row.us_quartiles;
        let or_empty = Option::<String>::unwrap_or_default;
        let error = row.max_error.map(|error| format!("{error:.1e}"));
        let failed = (row.failed > 0).then(|| format!("{} of {} failed", row.failed, row.problems));
        lines.push([
            if is_first { own } else { String::new() },
            row.route.clone(),
            figures(row.us),
            format!("{} to {}", figures(low), figures(high)),
            or_empty(row.ratio_to_dgeev.map(|ratio| format!("{ratio:.3}"))),
            or_empty(row.ratio_to_dgeev.map(|ratio| format!("{:.2}", 1.0 / ratio))),
            error.into_iter().chain(failed).collect::<Vec<_>>().join(", "),
        ]);
    }
    aligned(&lines, 2)
}

/// The table of stages, and the whole run.
pub fn study(study: &StudyTimes) -> String {
    let mut lines = vec![["stage", "us per sample", "share"].map(String::from)];
    for row in &study.stages {
        lines.push([row.stage.to_owned(), format!("{:.2}", row.us), format!("{:.1} %", 100.0 * row.share)]);
    }
    let StudyTimes { ceas, solved, certified, samples, seconds, processor_seconds, parts, threads, .. } = study;
    let peak = study.peak_mb.map(|peak| format!(", peak memory {peak:.0} MB")).unwrap_or_default();
    format!(
        "{}\nThe whole study, {samples} samples, {ceas} CEAs ({solved} solved, {certified} of them by a certificate): \
         {seconds:.1} s on {threads} threads{peak}\n\
         ({:.1} s reference modes, {:.1} s samples, {:.1} s tables and figures; {processor_seconds:.1} s of processor time)\n",
        aligned(&lines, 1),
        parts.references,
        parts.samples,
        parts.report
    )
}

/// A number with three significant figures, or with all digits before the point.
fn figures(x: f64) -> String {
    let decimals = if x < 10.0 { 2 } else { usize::from(x < 100.0) };
    format!("{x:.decimals$}")
}

/// A Markdown table with aligned columns: the first `left` columns flush left, the others flush right.
fn aligned<const N: usize>(lines: &[[String; N]], left: usize) -> String {
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0).max(3);
    let mut text = String::new();
    for (at, line) in lines.iter().enumerate() {
        for (column, cell) in line.iter().enumerate() {
            let width = width(column);
            let _ = if column < left { write!(text, "| {cell:<width$} ") } else { write!(text, "| {cell:>width$} ") };
        }
        text += "|\n";
        if at == 0 {
            for column in 0..N {
                let dashes = "-".repeat(width(column) - 1);
                let _ = if column < left { write!(text, "| {dashes}- ") } else { write!(text, "| {dashes}: ") };
            }
            text += "|\n";
        }
    }
    text
}
