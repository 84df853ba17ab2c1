//! Modes of a brake whose whole spectrum is computed: the table of them, and JSON.

use cea::{
    EigenSolver, Mode, Modes, QrSolver, Threshold, Verdict, Workspace, damping_ratio, frequency_hz, pair_numbers,
    verdicts_beyond,
};
use linsys::OperatingPoint;
use num_complex::Complex;
use osc_model::Brake;
use output::hertz;
use serde_json::{Value, json};
use squeal::study::{check_range, mode_work};
use squeal::why::Why;
use work::ModeWork;

use super::shapes::{ShapeAndWork, add_shape, pairs_of_numbers};
use super::words::{diverging_in_words, growth_at_frequency, in_paragraph, verdict_in_words};
use crate::Error;
use crate::eig::announce;
use crate::reasons::is_of;

/// Mode of the table that the command prints.
pub(super) struct Row {
    pub lambda: Complex<f64>,
    pub rank: usize,
    /// Verdict in words.
    verdict: &'static str,
    /// Shape over all degrees of freedom, with the work on each body; `None` where shapes are not wanted.
    shape: Option<ShapeAndWork>,
}

/// A real eigenvalue of the structure, or one of an internal state that grows, which may oscillate.
pub(super) struct RealRow {
    pub lambda: Complex<f64>,
    /// Verdict in words.
    verdict: &'static str,
}

/// Modes of a brake at an operating point: the oscillating ones ascending in frequency, with shapes and work where `wants_shapes` says so,
/// then the real and growing internal ones.
pub(super) fn analyse(
    brake: &Brake,
    at: &OperatingPoint,
    threshold: &Threshold,
    wants_shapes: bool,
) -> Result<(Vec<Row>, Vec<RealRow>, Modes), Error> {
    let system = brake.system.assemble(at)?;
    announce(system.order());
    let mut work = Workspace::default();
    let spectrum = QrSolver.eigenvalues(&system, &mut work)?;
    check_range(&system, &spectrum)?;
    let modes = Modes::classify(&system, &spectrum, &mut work)?;
    let real: Vec<Complex<f64>> = modes.real.iter().map(|&re| Complex::from(re)).collect();
    let internal: Vec<Complex<f64>> = modes.internal.iter().copied().filter(|l| l.re > 0.0 && l.im >= 0.0).collect();
    let all = [&modes.oscillatory[..], &real, &internal].concat();
    let mut verdicts = verdicts_beyond(threshold, &system, &all, &spectrum, &mut work)?;
    let of_internal = verdicts.split_off(modes.oscillatory.len() + real.len());
    let of_real = verdicts.split_off(modes.oscillatory.len());
    let word = |(&lambda, verdict): (&Complex<f64>, Verdict)| RealRow {
        lambda,
        verdict: verdict_in_words(verdict, lambda, threshold),
    };
    let internal = internal.iter().zip(of_internal).filter(|(_, verdict)| *verdict == Verdict::Unstable);
    let real = real.iter().zip(of_real).chain(internal).map(word).collect();
    let mut rows = Vec::with_capacity(modes.oscillatory.len());
    for ((index, &lambda), verdict) in modes.oscillatory.iter().enumerate().zip(verdicts) {
        let shape = if wants_shapes {
            let mode = Mode::at(&system, &[lambda], &mut work)?.swap_remove(0);
            let energy = mode_work(brake, at, &mode)?;
            Some((brake.dofs.expand(&mode.shape).iter().copied().collect(), energy))
        } else {
            None
        };
        let verdict = verdict_in_words(verdict, lambda, threshold);
        rows.push(Row { lambda, rank: modes.rank(index), verdict, shape });
    }
    Ok((rows, real, modes))
}

pub(super) fn table(rows: &[Row], real: &[RealRow], modes: &Modes, brake: &Brake) -> String {
    let diverging = real.iter().filter(|row| row.verdict == "diverges").map(|row| row.lambda);
    let mut text = in_paragraph(diverging_in_words(&diverging.collect::<Vec<_>>()));
    text += &format!(
        "{:>4}  {:>7}  {:>12}  {:>14}  {:>14}  {:>10}\n",
        "rank", "of 2n", "Hz", "growth 1/s", "damping ratio", "verdict"
    );
    for row in rows {
        let (first, second) = pair_numbers(row.rank);
        text += &format!(
            "{:>4}  {:>7}  {:>12}  {:>14.4}  {:>14.6}  {:>10}\n",
            row.rank,
            format!("{first}/{second}"),
            hertz(frequency_hz(row.lambda)),
            row.lambda.re,
            damping_ratio(row.lambda),
            row.verdict
        );
        if let Some((shape, energy)) = &row.shape {
            text += &bodies(shape, energy, brake);
        }
    }
    if !real.is_empty() {
        let list: Vec<String> = real
            .iter()
            .filter(|row| row.lambda.im == 0.0)
            .map(|RealRow { lambda, verdict }| match *verdict {
                "stable" => format!("{:.4}", lambda.re),
                word => format!("{:.4} {word}", lambda.re),
            })
            .collect();
        if !list.is_empty() {
            text += &format!("\noverdamped or divergent (real eigenvalues, 1/s): {}\n", list.join(", "));
        }
        for RealRow { lambda, verdict } in real.iter().filter(|row| row.lambda.im > 0.0) {
            text += &format!("\npair of internal states: {} {verdict}\n", growth_at_frequency(*lambda));
        }
    }
    if !modes.internal.is_empty() {
        let number = modes.internal.len();
        let eigenvalues = if number == 1 { "eigenvalue" } else { "eigenvalues" };
        text += &format!("\n{number} {eigenvalues} of internal states (bristles, what relaxes), no modes\n");
    }
    text += "\ndamping ratio: -Re / |lambda|, negative where a mode grows; rank counts overdamped modes first, of equal frequencies the damped one\n";
    if rows.iter().any(|row| row.shape.is_some()) {
        text += "under a mode: its shape by body over its largest entry, whichever unit each has; then the work of each family of forces in a \
                 period, over the largest net work of a body: it feeds where it is positive\n";
    }
    text
}

/// Shape and work of a mode, a line for each body. A shape with three components for each body is shown in full, others
/// by the largest amplitude in the body.
fn bodies(shape: &[Complex<f64>], energy: &ModeWork, brake: &Brake) -> String {
    let is_spatial = shape.len() == 3 * brake.bodies.len();
    let heading = if is_spatial { "shape x, y, z" } else { "largest amplitude" };
    let heads: String = energy.families.iter().map(|family| format!("  {:>12}", family.name)).collect();
    let mut text = format!("{:>10}  {heading:>33}{heads}\n", "");
    let largest = shape.iter().map(|u| u.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let scale = energy.net().iter().map(|w| w.abs()).fold(f64::MIN_POSITIVE, f64::max);
    for (at, body) in brake.bodies.iter().enumerate() {
        let amplitudes = if is_spatial {
            let parts = shape[3 * at..3 * at + 3].iter();
            parts.map(|u| format!("{:+.2}{:+.2}i", u.re / largest, u.im / largest)).collect::<Vec<_>>().join(" ")
        } else {
            let own = body.dofs.iter().map(|&dof| shape[brake.dofs.free()[dof]].norm());
            format!("{:.4}", own.fold(0.0, f64::max) / largest)
        };
        let works = energy.families.iter().map(|family| format!("  {:>+12.4}", family.bodies[at] / scale));
        text += &format!("{:>10}  {amplitudes:>33}{}\n", body.name, works.collect::<String>());
    }
    text
}

pub(super) fn json_text(scene: &Value, rows: &[Row], real: &[RealRow], modes: &Modes, whys: &[Why]) -> String {
    let list: Vec<Value> = rows
        .iter()
        .map(|row| {
            let (first, second) = pair_numbers(row.rank);
            let mut mode = json!({
                "re": row.lambda.re,
                "im": row.lambda.im,
                "frequency_hz": frequency_hz(row.lambda),
                "damping_ratio": damping_ratio(row.lambda),
                "rank": row.rank,
                "pair": [first, second],
                "verdict": row.verdict,
            });
            if let Some(why) = whys.iter().find(|why| is_of(row.lambda, why)) {
                mode["why"] = json!(why);
            }
            if let Some((shape, energy)) = &row.shape {
                add_shape(&mut mode, shape, energy);
            }
            mode
        })
        .collect();
    let (real, growing): (Vec<&RealRow>, Vec<_>) = real.iter().partition(|row| row.lambda.im == 0.0);
    let verdicts: Vec<&str> = real.iter().map(|row| row.verdict).collect();
    let real: Vec<f64> = real.iter().map(|row| row.lambda.re).collect();
    let internal = pairs_of_numbers(&modes.internal);
    let mut all =
        json!({ "scene": scene, "modes": list, "real": real, "real_verdicts": verdicts, "internal": internal });
    if !growing.is_empty() {
        let growing: Vec<Complex<f64>> = growing.iter().map(|row| row.lambda).collect();
        all["internal_growing"] = json!(pairs_of_numbers(&growing));
    }
    format!("{all:#}\n")
}
