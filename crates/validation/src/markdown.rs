//! The report in Markdown.

use std::fmt::Write as _;

use crate::estimator_comparison::Estimators;
use crate::judge::{GENERAL, STANDARD};
use crate::problem::{Judgement, RouteOutcome};
use crate::report::AccuracyReport;
use crate::route_comparison::RouteAccuracy;
use crate::tolerance_table;

impl AccuracyReport {
    /// The report in Markdown.
    pub fn markdown(&self) -> String {
        let mut text = String::from("# Accuracy\n\nEverything here was measured in one run, on one thread.\n");
        text += "\n## Solver routes\n\nErrors are relative, against eigenvalues refined in double-double.\n\n";
        text += "| route | systems | n | states | \u{b5}s | not solved | largest error |\n\
                 | --- | --- | --- | --- | --- | --- | --- |\n";
        for row in &self.routes {
            let RouteAccuracy { route, systems, n, states, us, count, failed, max_error, .. } = row;
            let _ = writeln!(
                text,
                "| {route} | {systems} | {n} | {states} | {us:.0} | {failed} of {count} | {max_error:.1e} |"
            );
        }
        self.estimators_markdown(&mut text);
        text += &tolerance_table::markdown(&self.time_to_tolerance);
        text += "\n## Stress cases of the lattice\n\nEigenvalues of the structure with Im lambda >= 0. ";
        text += "Forward errors are in units of condition number times machine epsilon.\n";
        text += "Bare sign: eigenvalues that a test of Re lambda > 0 puts on the wrong side.\n\n";
        certified_table(&mut text, &self.lattice);
        text += "\n## NLEVP and BrakeSqueal problems\n\n";
        certified_table(&mut text, &self.nlevp);
        text += "\n## Side by side with libraries\n\n";
        text += "What a script does: all eigenvalues of the textbook matrices `[0 I 0; -M^-1 K, -M^-1 C, M^-1 F; 0 E -a]` \
                 (nalgebra, dgeev) or `[0 I 0; -K -C F; 0 E -a] - lambda diag(I, M, I)` (dggev) in the units given, without \
                 scaling beforehand, and the sign of Re lambda as the verdict. Each cell: forward error / backward error / \
                 decided signs that are wrong; `-` where a route does not run.\n\n";
        if !cfg!(feature = "lapack") {
            text += "This build has no LAPACK: its columns need the system's OpenBLAS (`libopenblas-dev` on Debian) and \
                     `cargo xtask accuracy --features lapack`.\n\n";
        }
        side_by_side(&mut text, &self.lattice);
        text += "\n";
        side_by_side(&mut text, &self.nlevp);
        text
    }

    fn estimators_markdown(&self, text: &mut String) {
        let Estimators { scenes, occurrences, reference_bound, samples_to_tolerance, rows } = &self.estimators;
        let _ = writeln!(
            text,
            "\n## Estimators of an occurrence\n\nShared Coulomb friction, {scenes} scenes; {} occurrences away from \
             coalescence, {} near: a branch point lies nearer to the median than the onset, where no expansion converges. Reference: the exact integral, error at most {reference_bound:.1e}. \
             Plain Monte Carlo needs {samples_to_tolerance:.0} samples for 0.1 percentage points (95 %) of the \
             worst of them.\n",
            occurrences[0], occurrences[1]
        );
        *text += "| estimator | samples | spectra | s per scene | largest error, away | near |\n";
        *text += "| --- | --- | --- | --- | --- | --- |\n";
        for row in rows {
            let _ = writeln!(
                text,
                "| {} | {} | {:.0} | {:.2e} | {:.1e} | {:.1e} |",
                row.estimator, row.samples, row.spectra, row.seconds, row.max_error_away, row.max_error_near
            );
        }
        let time = |estimator: &str| rows.iter().rev().find(|row| row.estimator == estimator);
        if let (Some(plain), Some(exact)) = (time("Monte Carlo"), time("exact integral")) {
            let plain = plain.seconds / plain.samples as f64 * samples_to_tolerance;
            let _ = writeln!(
                text,
                "\nTo 0.1 percentage points, by BatchSolver: {plain:.0} s of plain Monte Carlo a scene, extrapolated from its \
                 time per sample, against {:.2e} s of the exact integral: {:.0} times.",
                exact.seconds,
                plain / exact.seconds
            );
        }
    }
}

/// The rows of this project's routes, whose verdicts use error bounds.
fn certified_table(text: &mut String, results: &[RouteOutcome]) {
    *text += "| case | route | judged | forward | backward | wrong signs | false instabilities | marginal | undecided | bare sign |\n";
    *text += "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for result in results.iter().filter(|result| [STANDARD, GENERAL].contains(&result.route())) {
        table_row(text, result);
    }
}

/// A table with a row for each case and a column for each route.
fn side_by_side(text: &mut String, results: &[RouteOutcome]) {
    let mut routes: Vec<&str> = Vec::new();
    for result in results {
        if !routes.contains(&result.route()) {
            routes.push(result.route());
        }
    }
    let _ = writeln!(text, "| case | {} |\n| --- |{}", routes.join(" | "), " --- |".repeat(routes.len()));
    for of_case in results.chunk_by(|a, b| a.case() == b.case()) {
        let cell = |route: &&str| match of_case.iter().find(|result| result.route() == *route) {
            Some(RouteOutcome::Judged(j)) => {
                let Judgement {
                    max_error_in_condition_epsilon: forward,
                    max_backward_error: backward,
                    wrong_signs,
                    ..
                } = j;
                format!("{forward:.1e} / {backward:.0e} / {wrong_signs}")
            }
            _ => "-".to_owned(),
        };
        let cells: Vec<String> = routes.iter().map(cell).collect();
        let _ = writeln!(text, "| {} | {} |", of_case[0].case(), cells.join(" | "));
    }
}

fn table_row(text: &mut String, result: &RouteOutcome) {
    let _ = match result {
        RouteOutcome::Refused { case, route, reason } => {
            writeln!(text, "| {case} | {route} | refused: {reason} | | | | | | | |")
        }
        RouteOutcome::Judged(Judgement {
            case,
            route,
            modes,
            max_error_in_condition_epsilon: forward,
            max_backward_error: backward,
            wrong_signs,
            false_instabilities,
            marginal,
            undecided,
            wrong_by_bare_sign: bare,
            ..
        }) => writeln!(
            text,
            "| {case} | {route} | {modes} | {forward:.2} | {backward:.1e} | {wrong_signs} | {false_instabilities} | \
             {marginal} | {undecided} | {bare} |"
        ),
    };
}
