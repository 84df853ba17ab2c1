//! The whole certified spectrum, by dense matrices.

use brakes::case::input::LARGEST_MATRIX;
use cea::CeaError;
use cea::certified::{Certified, CertifiedEigenvalue, ClusterKind, Counters, GeneralSpectrum, certify, solve};
use linsys::SecondOrder;
use montecarlo::Progress;
use nalgebra::DMatrix;
use output::{bytes_in_words, in_words};

use super::EigArgs;
use super::matrices::{Matrices, Sizes};
use super::text::{finite_json, heading, list, number, row, rows_json, taken, taken_json, vector_rows, vectors_json};
use crate::Error;
use crate::bar::Bar;
use crate::terminal::note;

/// Most degrees of freedom; chosen, so that the longest problem takes less than an hour.
const LARGEST_ORDER: usize = 1000;
/// Processor time, s per n^3 of n degrees of freedom. Measured on an AMD EPYC (Zen 4) with random full matrices: 0.55 s for n = 200.
const SECONDS: f64 = 1e-7;
/// Processor time, s per n^3, where QZ in double-double arithmetic is needed. Measured likewise: 0.45 s for n = 120 where the damping is 1e12 times the stiffness.
const SECONDS_EXTENDED: f64 = 3e-7;
/// Memory, bytes per n^2 of n degrees of freedom. Measured with the same: 13 MB for n = 200.
const BYTES: f64 = 200.0;
/// Longest processor time, s, of a problem that is not announced; chosen.
const ANNOUNCED: f64 = 1.0;

/// The spectrum as text.
///
/// # Errors
/// A file that is no matrix, shapes that differ, a singular pencil, no convergence.
pub(super) fn spectrum(args: &EigArgs) -> Result<String, Error> {
    let beyond = ", or with --box those eigenvalues of more that are in a rectangle";
    let matrices = Matrices::read(args, Sizes { bytes: LARGEST_MATRIX, order: LARGEST_ORDER, beyond })?;
    let order = matrices.order();
    let c = matrices.damping.as_ref().map_or_else(|| DMatrix::zeros(order, order), |c| c.to_dense());
    let system = SecondOrder::new(matrices.mass.to_dense(), c, matrices.stiffness.to_dense())
        .map_err(|e| Error::Cea(e.into()))?;
    let mut counters = Counters::default();
    let progress = Bar::of("steps (eigenvalues, bounds)");
    let seconds = announce(order);
    if seconds > ANNOUNCED {
        progress.begin(2, 0);
    }
    let spectrum = solve(&system, &mut counters).map_err(CeaError::from)?;
    progress.advance(1);
    let certified = certify(&system, &spectrum, &mut counters).map_err(CeaError::from)?;
    progress.end();
    Ok(if args.json {
        json(&spectrum, &certified, args.vectors, &matrices)
    } else {
        table(&spectrum, &certified, args.vectors) + &taken(&matrices.files, &matrices.held)
    })
}

/// Processor time, s, that a problem of `order` degrees of freedom takes, roughly. If it is long, a note says it beforehand, with the memory.
pub(crate) fn announce(order: usize) -> f64 {
    let n = order as f64;
    let seconds = SECONDS * n.powi(3);
    if seconds > ANNOUNCED {
        let (time, most) = (in_words(seconds), in_words(SECONDS_EXTENDED * n.powi(3)));
        let memory = bytes_in_words(BYTES * n * n);
        note(&format!(
            "{order} degrees of freedom: roughly {time}, {most} where a double has too few digits; {memory}"
        ));
    }
    seconds
}

fn kind(kind: ClusterKind) -> &'static str {
    match kind {
        ClusterKind::Semisimple => "semisimple",
        ClusterKind::Defective => "defective",
        ClusterKind::NearlyDefective => "nearly-defective",
    }
}

fn json(spectrum: &GeneralSpectrum, certified: &Certified, vectors: bool, matrices: &Matrices) -> String {
    // A constraint or a massless joint grows nothing: infinite eigenvalues are no threat to stability.
    let infinite = "    {\"kind\": \"infinite\", \"re\": null, \"im\": null, \"frequency_hz\": null, \
                    \"damping_ratio\": null, \"backward_error\": 0, \"condition\": null, \"bound\": null, \
                    \"verdict\": \"stable\"}";
    let finite = |e: &CertifiedEigenvalue| {
        let shapes = if vectors { vectors_json(&e.right, &e.left) } else { String::new() };
        format!("    {{{}{shapes}}}", finite_json(e.lambda, [e.backward_error, e.condition, e.bound], e.verdict))
    };
    let eigenvalues = certified.eigenvalues.iter().map(finite);
    let eigenvalues: Vec<_> = eigenvalues.chain((0..spectrum.infinite).map(|_| infinite.to_owned())).collect();
    let clusters = list(&certified.clusters, |c| {
        format!(
            "\n    {{\"kind\": \"{}\", \"members\": [{}], \"mean_re\": {}, \"mean_im\": {}, \"spread\": {}}}",
            kind(c.kind),
            list(&c.members, usize::to_string),
            number(c.mean.re),
            number(c.mean.im),
            number(c.spread)
        )
    });
    format!(
        "{{\n  \"route\": \"{}\",\n{}{}  \"eigenvalues\": [\n{}\n  ],\n  \"clusters\": [{clusters}]\n}}\n",
        spectrum.route,
        taken_json(&matrices.files, &matrices.held),
        if vectors { rows_json(matrices.labels()) } else { String::new() },
        eigenvalues.join(",\n")
    )
}

fn table(spectrum: &GeneralSpectrum, certified: &Certified, vectors: bool) -> String {
    let mut text = heading();
    for (i, e) in certified.eigenvalues.iter().enumerate() {
        text += &row(i + 1, e.lambda, e.backward_error, e.condition, &e.verdict.to_string());
        if vectors {
            text += &vector_rows(&e.right, &e.left);
        }
    }
    let count = |name| certified.eigenvalues.iter().filter(|e| e.verdict.to_string() == name).count();
    text += &format!(
        "\n{} finite eigenvalues ({} exactly zero): {} unstable, {} stable, {} marginal, {} undecided; {} infinite; \
         route {}\n",
        certified.eigenvalues.len(),
        spectrum.zeros,
        count("unstable"),
        count("stable"),
        count("marginal"),
        count("undecided"),
        spectrum.infinite,
        spectrum.route
    );
    for c in &certified.clusters {
        let members = list(&c.members, |i| (i + 1).to_string());
        let mean = format!("{:.9e}{:+.9e}i", c.mean.re, c.mean.im);
        text += &format!("{} group: no. {members}; mean {mean}, spread {:.1e}\n", kind(c.kind), c.spread);
    }
    text += "damping = -Re lambda / |lambda|; bounds and verdicts: docs/error-bounds.md\n";
    text
}
