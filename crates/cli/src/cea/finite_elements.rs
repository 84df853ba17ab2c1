//! Modes of a finite element brake: of the whole one, and where shapes or reasons are asked for of a reduced one with their residuals in the whole one.

use brakes::case::FiniteElementCase;
use brakes::{CaseBrake, FiniteElementBrake, Purpose};
use cea::{EigenSolver, Mode, QrSolver, Workspace, damping_ratio, frequency_hz};
use linsys::OperatingPoint;
use nalgebra::DVectorView;
use num_complex::Complex;
use output::hertz;
use reduction::ReducedModes;
use serde_json::{Value, json};
use squeal::study::{Scene, UncertainBrake, mode_work};
use work::ModeWork;

use super::CeaArgs;
use super::shapes::{ShapeAndWork, add_shape, pairs_of_numbers};
use super::words::{divergence_in_words, verdict_in_words};
use crate::Error;
use crate::reasons::{Whys, is_of, place_of, reasons, whys};

impl CeaArgs {
    /// The modes of a finite element brake at median parameters, each with its residual in the whole one.
    pub(super) fn finite_elements(&self, brake: &FiniteElementBrake, heading: &str) -> Result<String, Error> {
        let scene = &brake.plan.scenes[0];
        let (at, reduced) = (brake.operating_point(scene, &brake.median())?, &brake.part(scene).reduced);
        let full = brake.full_point(scene, &at);
        let modes = reduced.modes(&full)?;
        let (whole, beside) = brake.whole_modes(scene, &full)?;
        let judged = if self.purpose() == Purpose::Point { whole } else { brake.judged(scene, &full, &modes)? };
        let rows = judged.iter().map(|mode| (&mode.lambda, mode.residual.map_or(0.0, |residual| residual.value)));
        let threshold = &brake.plan.threshold;
        let verdict =
            |place: usize| verdict_in_words(judged[place].verdict(threshold), judged[place].lambda, threshold);
        let whys = if self.why { whys(brake, scene, Some(&modes.lambdas))? } else { Whys::default() };
        let shapes = if self.modes { on_rows(brake, scene, &at, &modes)? } else { Vec::new() };
        let spectrum = QrSolver.eigenvalues(&reduced.system().assemble(&full)?, &mut Workspace::default())?;
        let diverging = brake.diverging(scene, &full, &spectrum, 1)?;
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
                        "verdict": verdict(place),
                    });
                    if let Some(why) = whys.of_modes.iter().find(|why| is_of(whys.counterparts[place], why)) {
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
            let verdict = verdict(place);
            let rank = place + 1;
            text +=
                &format!("{rank:>4}  {hz:>12}  {:>14.4}  {ratio:>14.6}  {residual:>9.1e}  {verdict:>9}\n", lambda.re);
            if let Some((shape, energy)) = shapes.get(place) {
                text += &largest_and_work(shape, energy, &brake.case);
            }
        }
        let [_, fastest] = brake.case.reduction.growth;
        for lambda in judged.iter().map(|mode| mode.lambda).filter(|lambda| lambda.re > fastest) {
            let hz = hertz(frequency_hz(lambda));
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
                let rank = place_of(whys.counterparts.iter().copied(), &whys.of_modes, why);
                rank.map_or_else(String::new, |place| format!(" {}", place + 1))
            }))
    }
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

/// Line on a mode of a finite element brake: the degree of freedom at which it is largest, and the work of each family over the work of the
/// family with the largest work.
fn largest_and_work(shape: &[Complex<f64>], energy: &ModeWork, case: &FiniteElementCase) -> String {
    let largest = (0..shape.len()).max_by(|&a, &b| shape[a].norm().total_cmp(&shape[b].norm())).unwrap_or(0);
    let of = |family: &work::FamilyWork| (family.name.clone(), family.bodies.iter().sum::<f64>());
    let works: Vec<(String, f64)> = energy.families.iter().map(of).collect();
    let scale = works.iter().map(|(_, work)| work.abs()).fold(f64::MIN_POSITIVE, f64::max);
    let works: Vec<String> = works.iter().map(|(name, work)| format!("{name} {:+.4}", work / scale)).collect();
    format!("{:>14}largest at {}; work of {}\n", "", case.dof_name(largest), works.join(", "))
}
