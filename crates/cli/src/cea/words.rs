//! Words on verdicts, and on what diverges.

use brakes::Diverging;
use cea::{Threshold, Verdict, frequency_hz};
use num_complex::Complex;
use output::hertz;

/// A verdict for people: what grows and does not count is not stable but below the threshold, and what grows without oscillation diverges.
pub(super) fn verdict_in_words(verdict: Verdict, lambda: Complex<f64>, threshold: &Threshold) -> &'static str {
    match verdict {
        Verdict::Unstable if lambda.im == 0.0 => "diverges",
        Verdict::Unstable => "unstable",
        Verdict::Stable if lambda.re > 0.0 && !threshold.is_axis() => "below threshold",
        Verdict::Stable => "stable",
        Verdict::Marginal { .. } => "marginal",
        Verdict::Undecided { .. } => "undecided",
    }
}

/// Lines on what diverges, of lambda with Im >= 0: real eigenvalues, and pairs that grow faster than they oscillate.
pub(super) fn diverging_in_words(diverging: &[Complex<f64>]) -> Vec<String> {
    let (real, pairs): (Vec<Complex<f64>>, Vec<_>) = diverging.iter().partition(|lambda| lambda.im == 0.0);
    let fastest = |of: &[Complex<f64>]| of.iter().copied().max_by(|a, b| a.re.total_cmp(&b.re));
    let real = fastest(&real).map(|Complex { re, .. }| {
        let many = match real.len() {
            1 => "1 real eigenvalue diverges, by".to_owned(),
            count => format!("{count} real eigenvalues diverge, by up to"),
        };
        format!("UNSTABLE without oscillation: {many} {re:.4} 1/s")
    });
    let pairs = fastest(&pairs).map(|lambda| {
        let many = match pairs.len() {
            1 => "a pair grows faster than it oscillates".to_owned(),
            count => format!("{count} pairs grow faster than they oscillate, the fastest"),
        };
        format!("UNSTABLE: {many}: {}", growth_at_frequency(lambda))
    });
    real.into_iter().chain(pairs).collect()
}

/// First lines on a finite element brake that diverges; `highest` is the highest frequency of its band, Hz.
pub(super) fn divergence_in_words(found: &Diverging, highest: f64) -> String {
    let mut lines = found.whole.as_ref().map_or_else(
        || {
            vec![format!(
                "whether anything of the whole brake diverges by less than 2 pi {} Hz could not be told",
                hertz(highest)
            )]
        },
        |whole| diverging_in_words(whole),
    );
    if found.beyond {
        lines.push(format!(
            "UNSTABLE: something diverges by more than 2 pi {} Hz, how fast is not known",
            hertz(highest)
        ));
    }
    in_paragraph(lines)
}

pub(super) fn in_paragraph(lines: Vec<String>) -> String {
    if lines.is_empty() { String::new() } else { lines.join("\n") + "\n\n" }
}

pub(super) fn growth_at_frequency(lambda: Complex<f64>) -> String {
    format!("{:.4} 1/s at {} Hz", lambda.re, hertz(frequency_hz(lambda)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_diverges_is_said_in_its_number_and_with_its_frequency() {
        let (real, pair) = (Complex::new(12.5, 0.0), Complex::new(17031.0, std::f64::consts::TAU * 342.0));
        let words = |of: &[Complex<f64>]| diverging_in_words(of).join("; ");
        assert_eq!(words(&[]), "");
        assert_eq!(words(&[real]), "UNSTABLE without oscillation: 1 real eigenvalue diverges, by 12.5000 1/s");
        assert_eq!(
            words(&[real, 2.0 * real]),
            "UNSTABLE without oscillation: 2 real eigenvalues diverge, by up to 25.0000 1/s"
        );
        assert_eq!(
            words(&[real, pair]),
            "UNSTABLE without oscillation: 1 real eigenvalue diverges, by 12.5000 1/s; \
             UNSTABLE: a pair grows faster than it oscillates: 17031.0000 1/s at 342.000 Hz"
        );
        assert!(words(&[pair, pair]).starts_with("UNSTABLE: 2 pairs grow faster than they oscillate, the fastest: "));
        let said = |whole: Option<Vec<Complex<f64>>>, beyond| divergence_in_words(&Diverging { whole, beyond }, 5540.0);
        assert_eq!(said(Some(Vec::new()), false), "");
        // No growth is said of what the reduced brake alone tells.
        let beyond = "UNSTABLE: something diverges by more than 2 pi 5540.000 Hz, how fast is not known\n\n";
        assert_eq!(said(Some(Vec::new()), true), beyond);
        assert_eq!(said(Some(vec![real]), true), words(&[real]) + "\n" + beyond);
        assert!(
            said(None, false)
                .starts_with("whether anything of the whole brake diverges by less than 2 pi 5540.000 Hz could not")
        );
    }
}
