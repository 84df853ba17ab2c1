//! `squeal cea`: one deterministic complex eigenvalue analysis of a case.

use std::io::Write;

use brakes::case::{ChosenSpeed, FiniteElementCase};
use brakes::{BESIDE, CaseBrake, Diverging, FiniteElementBrake, Purpose};
use cea::{
    EigenSolver, Mode, Modes, QrSolver, Spectrum, Threshold, Verdict, Workspace, damping_ratio, frequency_hz,
    pair_numbers, verdicts_beyond,
};
use linsys::OperatingPoint;
use nalgebra::DVectorView;
use num_complex::Complex;
use osc_model::Brake;
use output::hertz;
use reduction::ReducedModes;
use serde_json::{Value, json};
use squeal::study::{ModeSource, Scene, UncertainBrake, check_range, mode_work};
use squeal::why::Why;
use work::ModeWork;

use super::eig::announce;
use super::options::MemoryArgs;
use super::reasons::{Whys, first_scene, is_of, reasons, whys};
use super::scene::{SceneArgs, counts_from};
use super::sized;
use crate::Error;
use crate::case_file::CaseArgs;

/// One complex eigenvalue analysis at median parameters: a table of modes.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: squeal cea brake.toml --set mu=0.6 --why")]
pub struct CeaArgs {
    /// The case
    #[command(flatten)]
    pub case: CaseArgs,
    /// The scene
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Add mode shapes and the work of friction and damping per body
    #[arg(long)]
    pub modes: bool,
    /// Say why unstable modes grow: what changes them, who feeds them, of which modes of the structure they are made
    #[arg(long)]
    pub why: bool,
    /// JSON for machines: eigenvalues in rad/s
    #[arg(long)]
    pub json: bool,
    /// Memory that may be taken
    #[command(flatten)]
    pub memory: MemoryArgs,
}

/// The shape of a mode over all degrees of freedom, and its work.
type ShapeAndWork = (Vec<Complex<f64>>, ModeWork);

/// Mode of the table that the command prints.
struct Row {
    lambda: Complex<f64>,
    rank: usize,
    /// Verdict in words.
    verdict: &'static str,
    /// Shape over all degrees of freedom, with the work on each body; `None` where shapes are not wanted.
    shape: Option<ShapeAndWork>,
}

/// A real eigenvalue of the structure, or one of an internal state that grows, which may oscillate.
struct RealRow {
    lambda: Complex<f64>,
    /// Verdict in words.
    verdict: &'static str,
}

impl CeaArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// Faults of the case or of an option.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let case = self.scene.only(self.case.read()?, ChosenSpeed::Median)?;
        let text = self.analysis(&sized::brake(case, Purpose::Analysis, self.memory.into(), &self.case.prepared)?)?;
        out.write_all(text.as_bytes()).map_err(Error::StandardOutput)
    }

    /// The analysis of the first scene of a brake, which need not be one of a case file, at its medians.
    ///
    /// # Errors
    /// As [`CeaArgs::run`].
    pub fn analysis<B: CaseBrake>(&self, brake: &B) -> Result<String, Error> {
        let (plan, heading) = (brake.plan(), brake.medians_in_words() + &counts_from(&brake.plan().threshold));
        if let Some(brake) = brake.finite_elements() {
            return self.finite_elements(brake, &heading);
        }
        let scene = &plan.scenes[0];
        let at = brake.operating_point(scene, &brake.median())?;
        let whys = if self.why { first_scene(brake)? } else { Whys::default() };
        let (rows, real, modes) = analyse(plan.brake(scene), &at, &plan.threshold, self.modes)?;
        Ok(match self.json {
            true => json_text(&brake.scene_json(), &rows, &real, &modes, &whys.of_modes),
            false => {
                let name = |why: &Why| {
                    let row = rows.iter().find(|row| is_of(row.lambda, why));
                    row.map_or(String::new(), |row| format!(" {}", row.rank))
                };
                format!("{heading}\n\n{}{}", table(&rows, &real, &modes, plan.brake(scene)), reasons(&whys, name))
            }
        })
    }

    /// The modes of a reduced finite element brake at median parameters, each with its residual in the whole one.
    fn finite_elements(&self, brake: &FiniteElementBrake, heading: &str) -> Result<String, Error> {
        let scene = &brake.plan.scenes[0];
        let (at, reduced) = (brake.operating_point(scene, &brake.median())?, &brake.part(scene).reduced);
        let full = brake.full_point(scene, &at);
        let modes = reduced.modes(&full)?;
        let rows = modes.lambdas.iter().zip(&modes.residuals);
        let threshold = &brake.plan.threshold;
        let verdict = |lambda: Complex<f64>| {
            let found = threshold.verdict(lambda, brake.relative_error(scene) * lambda.norm());
            verdict_in_words(found, lambda, threshold)
        };
        let whys = if self.why { whys(brake, scene, Some(&modes.lambdas))? } else { Whys::default() };
        let shapes = if self.modes { on_rows(brake, scene, &at, &modes)? } else { Vec::new() };
        let spectrum = QrSolver.eigenvalues(&reduced.system().assemble(&full)?, &mut Workspace::default())?;
        let beside = growing_beside(brake, scene, &spectrum);
        let diverging = brake.diverging(scene, &full, &spectrum)?;
        if self.json {
            let list: Vec<Value> = rows
                .enumerate()
                .map(|(place, (lambda, residual))| {
                    let mut mode = json!({
                        "re": lambda.re,
                        "im": lambda.im,
                        "frequency_hz": frequency_hz(*lambda),
                        "damping_ratio": damping_ratio(*lambda),
                        "residual": residual,
                        "verdict": verdict(*lambda),
                    });
                    if let Some(why) = whys.of_modes.iter().find(|why| is_of(*lambda, why)) {
                        mode["why"] = json!(why);
                    }
                    if let Some((shape, energy)) = shapes.get(place) {
                        add_shape(&mut mode, shape, energy);
                    }
                    mode
                })
                .collect();
            let whole = diverging.whole.as_ref().map(|whole| pairs_of_numbers(whole));
            let mut all = json!({
                "scene": brake.scene_json(),
                "modes": list,
                "diverging": whole,
                "diverging_beyond": diverging.beyond,
            });
            if self.modes {
                all["dofs"] = (0..brake.case.dofs.len()).map(|row| brake.case.dof_name(row)).collect();
            }
            if !beside.is_empty() {
                all["growing_beside_hz"] = json!(beside);
            }
            return Ok(format!("{all:#}\n"));
        }
        let mut text = format!(
            "{heading}

{}{:>4}  {:>12}  {:>14}  {:>14}  {:>9}  {:>9}
",
            divergence_in_words(&diverging, brake.case.reduction.frequencies[1]),
            "rank",
            "Hz",
            "growth 1/s",
            "damping ratio",
            "residual",
            "verdict"
        );
        for (place, (lambda, residual)) in rows.enumerate() {
            let (hz, ratio) = (hertz(frequency_hz(*lambda)), damping_ratio(*lambda));
            let verdict = verdict(*lambda);
            let rank = place + 1;
            text +=
                &format!("{rank:>4}  {hz:>12}  {:>14.4}  {ratio:>14.6}  {residual:>9.1e}  {verdict:>9}\n", lambda.re);
            if let Some((shape, energy)) = shapes.get(place) {
                text += &largest_and_work(shape, energy, &brake.case);
            }
        }
        let [_, fastest] = brake.case.reduction.growth;
        for lambda in modes.lambdas.iter().filter(|lambda| lambda.re > fastest) {
            let hz = hertz(frequency_hz(*lambda));
            text += &format!(
                "\n{hz} Hz grows faster than reduction.growth = {fastest}: its residual says what it is worth\n"
            );
        }
        for &hz in &beside {
            let hz = hertz(hz);
            text += &format!("\n{hz} Hz grows too, next to the band, and is not listed: widen reduction.frequencies\n");
        }
        Ok(text
            + "\nrank: by frequency, of the modes listed here; a study numbers its modes so, at the medians with all patches in contact; damping ratio: -Re / |lambda|, negative where a mode grows; residual: of the mode in \
               the unreduced brake\n"
            + &reasons(&whys, |why| {
                let rank = modes.lambdas.iter().position(|lambda| is_of(*lambda, why));
                rank.map_or_else(String::new, |place| format!(" {}", place + 1))
            }))
    }
}

/// The frequencies, Hz, of modes of the spectrum of a reduced system in a scene that surely grow, next to the band of its brake.
fn growing_beside(brake: &FiniteElementBrake, scene: &Scene, reduced: &Spectrum) -> Vec<f64> {
    let [low, high] = brake.case.reduction.frequencies;
    let is_beside = |hz: f64| (low / BESIDE..low).contains(&hz) || hz > high && hz <= high * BESIDE;
    let error = brake.relative_error(scene);
    let grows = |lambda: &Complex<f64>| brake.plan.threshold.margin(*lambda) > error * lambda.norm();
    let growing = reduced.eigenvalues.iter().copied().filter(grows);
    let mut beside: Vec<f64> = growing.map(frequency_hz).filter(|&hz| is_beside(hz)).collect();
    beside.sort_by(f64::total_cmp);
    beside
}

/// Modes of a brake at an operating point: the oscillating ones ascending in frequency, with shapes and work where `wants_shapes` says so,
/// then the real and growing internal ones.
fn analyse(
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

/// A verdict for people: what grows and does not count is not stable but below the threshold, and what grows without oscillation diverges.
fn verdict_in_words(verdict: Verdict, lambda: Complex<f64>, threshold: &Threshold) -> &'static str {
    match verdict {
        Verdict::Unstable if lambda.im == 0.0 => "diverges",
        Verdict::Unstable => "unstable",
        Verdict::Stable if lambda.re > 0.0 && !threshold.is_axis() => "below threshold",
        Verdict::Stable => "stable",
        Verdict::Marginal { .. } => "marginal",
        Verdict::Undecided { .. } => "undecided",
    }
}

fn table(rows: &[Row], real: &[RealRow], modes: &Modes, brake: &Brake) -> String {
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
        text += &format!("\n{} bristle eigenvalues, which are no modes\n", modes.internal.len());
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

/// Lines on what diverges, of lambda with Im >= 0: real eigenvalues, and pairs that grow faster than they oscillate.
fn diverging_in_words(diverging: &[Complex<f64>]) -> Vec<String> {
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
fn divergence_in_words(found: &Diverging, highest: f64) -> String {
    let mut lines = found.whole.as_ref().map_or_else(
        || {
            vec![format!(
                "whether anything of the whole brake diverges below 2 pi {} Hz could not be told",
                hertz(highest)
            )]
        },
        |whole| diverging_in_words(whole),
    );
    if found.beyond {
        lines.push(format!("UNSTABLE: something beyond 2 pi {} Hz diverges, how fast is not known", hertz(highest)));
    }
    in_paragraph(lines)
}

fn in_paragraph(lines: Vec<String>) -> String {
    if lines.is_empty() { String::new() } else { lines.join("\n") + "\n\n" }
}

fn growth_at_frequency(lambda: Complex<f64>) -> String {
    format!("{:.4} 1/s at {} Hz", lambda.re, hertz(frequency_hz(lambda)))
}

fn pairs_of_numbers(lambdas: &[Complex<f64>]) -> Vec<[f64; 2]> {
    lambdas.iter().map(|lambda| [lambda.re, lambda.im]).collect()
}

/// The shapes of the modes of a reduced brake over the rows of the matrices of its case, 0 where held, and their work: the shapes have
/// phi^H M phi = 1, in the whole brake as in the reduced one.
fn on_rows(
    brake: &FiniteElementBrake,
    scene: &Scene,
    at: &OperatingPoint,
    modes: &ReducedModes,
) -> Result<Vec<ShapeAndWork>, Error> {
    let (part, of) = (brake.part(scene), brake.plan.brake(scene));
    let mass = of.system.assemble(at)?.m;
    let dofs = &brake.sets[part.set].dofs;
    let on_rows = |(&lambda, shape): (&Complex<f64>, DVectorView<'_, Complex<f64>>)| {
        let mode = Mode::normalised(&mass, lambda, shape.into_owned());
        let work = mode_work(of, at, &mode)?;
        Ok((dofs.expand(&part.reduced.lift(&mode.shape)).iter().copied().collect(), work))
    };
    modes.lambdas.iter().zip(modes.shapes.column_iter()).map(on_rows).collect()
}

/// Line on a mode of a finite element brake: the degree of freedom at which it is largest, and the work of each family over that of the
/// family with the largest.
fn largest_and_work(shape: &[Complex<f64>], energy: &ModeWork, case: &FiniteElementCase) -> String {
    let largest = (0..shape.len()).max_by(|&a, &b| shape[a].norm().total_cmp(&shape[b].norm())).unwrap_or(0);
    let of = |family: &work::FamilyWork| (family.name.clone(), family.bodies.iter().sum::<f64>());
    let works: Vec<(String, f64)> = energy.families.iter().map(of).collect();
    let scale = works.iter().map(|(_, work)| work.abs()).fold(f64::MIN_POSITIVE, f64::max);
    let works: Vec<String> = works.iter().map(|(name, work)| format!("{name} {:+.4}", work / scale)).collect();
    format!("{:>14}largest at {}; work of {}\n", "", case.dof_name(largest), works.join(", "))
}

/// Adds shape and work to a mode.
fn add_shape(mode: &mut Value, shape: &[Complex<f64>], energy: &ModeWork) {
    mode["shape"] = shape.iter().map(|u| json!([u.re, u.im])).collect();
    for family in &energy.families {
        mode[format!("{}_work", family.name)] = json!(family.bodies);
    }
    mode["net_work"] = json!(energy.net());
}

fn json_text(scene: &Value, rows: &[Row], real: &[RealRow], modes: &Modes, whys: &[Why]) -> String {
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
        let beyond = "UNSTABLE: something beyond 2 pi 5540.000 Hz diverges, how fast is not known\n\n";
        assert_eq!(said(Some(Vec::new()), true), beyond);
        assert_eq!(said(Some(vec![real]), true), words(&[real]) + "\n" + beyond);
        assert!(
            said(None, false)
                .starts_with("whether anything of the whole brake diverges below 2 pi 5540.000 Hz could not")
        );
    }
}
