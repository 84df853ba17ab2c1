//! `squeal cea`: one deterministic complex eigenvalue analysis of a case.

use std::io::Write;
use std::path::PathBuf;

use cea::{EigenSolver, Mode, Modes, QrSolver, Verdict, Workspace, damping_ratio, frequency_hz, pair_numbers, verdict};
use linsys::SecondOrder;
use osc_model::{BrakeModel, ContactArrangement, Linearise, PreparedLattice};
use serde_json::{Value, json};
use work::{Family, ModeWork, family_work};

use crate::Error;
use crate::case::{Case, Law};
use crate::study::{Plan, Sample, sliding};

/// One complex eigenvalue analysis at median parameters: a table of modes.
#[derive(Debug, clap::Args)]
pub struct CeaArgs {
    /// The case file (TOML)
    pub case: PathBuf,
    /// Friction law [default: the case's first]
    #[arg(long, value_name = "LAW")]
    pub law: Option<String>,
    /// Oscillators in contact, from 1, as in 1,2,5 [default: the case's first arrangement]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub contact: Option<Vec<usize>>,
    /// Constraint set by name [default: the case's first]
    #[arg(long, value_name = "NAME")]
    pub constraints: Option<String>,
    /// Sliding speed, m/s [default: the median of the case's first range]
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    pub speed: Option<f64>,
    /// Add mode shapes and the work of friction and damping per body
    #[arg(long)]
    pub modes: bool,
    /// JSON for machines: eigenvalues in rad/s
    #[arg(long)]
    pub json: bool,
}

/// One mode of the table.
struct Row {
    lambda: num_complex::Complex<f64>,
    rank: usize,
    verdict: Verdict,
    shape: Option<(Vec<num_complex::Complex<f64>>, ModeWork)>,
}

impl CeaArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// What is wrong with the case or an option.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let plan = Plan::new(Case::read(&self.case)?)?;
        let (law, lattice, speed) = self.scene(&plan)?;
        let at = sliding(&plan.case, &lattice, law, speed, &Sample::median(&plan.case), |_| 1.0)?;
        let system = lattice.linearised(&at)?;
        let mut work = Workspace::default();
        let spectrum = QrSolver.eigenvalues(&system, &mut work)?;
        let modes = Modes::classify(&system, &spectrum, &mut work)?;

        let mut friction = SecondOrder::zeros(system.order(), 0);
        lattice.linearise_friction(&at, &mut friction)?;
        let damping = lattice.structural().damping_alone();
        let families = [Family { name: "friction", system: &friction }, Family { name: "damping", system: &damping }];
        let mut rows = Vec::new();
        for (index, &lambda) in modes.oscillatory.iter().enumerate() {
            let shape = if self.modes {
                let mode = Mode::at(&system, &[lambda], &mut work)?.swap_remove(0);
                let energy = family_work(&lattice.structural().m, &families, lambda, &mode.shape, lattice.bodies())?;
                Some((lattice.dof_map().expand(&mode.shape).iter().copied().collect(), energy))
            } else {
                None
            };
            let verdict = verdict(&system, lambda, spectrum.scale, &mut work)?;
            rows.push(Row { lambda, rank: modes.rank(index), verdict, shape });
        }
        let text = if self.json {
            let scene = json!({
                "law": law.name(),
                "contact": lattice.arrangement().in_contact().iter().map(|i| i + 1).collect::<Vec<_>>(),
                "speed": speed,
            });
            json_text(&scene, &rows, &modes)
        } else {
            let contacts = lattice.arrangement();
            format!(
                "{law} friction at {speed:.4} m/s, in contact: {contacts}; median parameters\n\n{}",
                table(&rows, &modes)
            )
        };
        out.write_all(text.as_bytes()).map_err(|source| Error::Write { path: "standard output".into(), source })
    }

    fn scene(&self, plan: &Plan) -> Result<(Law, PreparedLattice, f64), Error> {
        let case = &plan.case;
        let refused = |option, value: &str, allowed: String| Error::Option { option, value: value.into(), allowed };
        let law = match &self.law {
            None => case.laws[0],
            Some(name) => *Law::ALL
                .iter()
                .find(|law| law.name() == name)
                .ok_or_else(|| refused("--law", name, Law::ALL.map(Law::name).join(", ")))?,
        };
        let constraints = match &self.constraints {
            None => 0,
            Some(name) => case.constraints.iter().position(|set| set.name == *name).ok_or_else(|| {
                let names: Vec<_> = case.constraints.iter().map(|set| set.name.as_str()).collect();
                refused("--constraints", name, names.join(", "))
            })?,
        };
        let arrangement = match &self.contact {
            None => case.panels[0].1[0].clone(),
            Some(numbers) => {
                let oscillators = case.lattice.grid.oscillators();
                ContactArrangement::from_numbers(oscillators, numbers).map_err(|_| {
                    let list: Vec<String> = numbers.iter().map(usize::to_string).collect();
                    refused("--contact", &list.join(","), format!("oscillators 1 to {oscillators}, each once"))
                })?
            }
        };
        let speed = self.speed.unwrap_or(case.speeds[0].quantile(0.5));
        if !(speed.is_finite() && speed > 0.0) {
            return Err(refused("--speed", &speed.to_string(), "a speed in m/s, > 0".into()));
        }
        Ok((law, plan.models[constraints].prepare(&arrangement)?, speed))
    }
}

fn table(rows: &[Row], modes: &Modes) -> String {
    let mut text = format!(
        "{:>4}  {:>7}  {:>12}  {:>14}  {:>14}  {:>10}\n",
        "rank", "of 2n", "Hz", "growth 1/s", "damping ratio", "verdict"
    );
    for row in rows {
        let (first, second) = pair_numbers(row.rank);
        text += &format!(
            "{:>4}  {:>7}  {:>12.3}  {:>14.4}  {:>14.6}  {:>10}\n",
            row.rank,
            format!("{first}/{second}"),
            frequency_hz(row.lambda),
            row.lambda.re,
            damping_ratio(row.lambda),
            row.verdict.to_string()
        );
        if let Some((shape, energy)) = &row.shape {
            text += &bodies(shape, energy);
        }
    }
    if !modes.real.is_empty() {
        let list: Vec<String> = modes.real.iter().map(|re| format!("{re:.4}")).collect();
        text += &format!("\noverdamped or divergent (real eigenvalues, 1/s): {}\n", list.join(", "));
    }
    if !modes.internal.is_empty() {
        text += &format!("\n{} bristle eigenvalues, which are no modes\n", modes.internal.len());
    }
    text + "\ndamping ratio: -Re / |lambda|, negative is unstable; rank counts overdamped modes first\n"
}

fn bodies(shape: &[num_complex::Complex<f64>], energy: &ModeWork) -> String {
    let heads: String = energy.families.iter().map(|family| format!("  {:>12}", family.name)).collect();
    let mut text = format!("{:>10}  {:>33}{heads}\n", "", "shape x, y, z");
    let largest = shape.iter().map(|u| u.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let net = energy.net();
    let scale = net.iter().map(|w| w.abs()).fold(f64::MIN_POSITIVE, f64::max);
    for (body, u) in shape.chunks(3).enumerate() {
        let name = if body + 1 == net.len() { "plate".into() } else { (body + 1).to_string() };
        let parts: Vec<String> = u.iter().map(|u| format!("{:+.2}{:+.2}i", u.re / largest, u.im / largest)).collect();
        let works = energy.families.iter().map(|family| format!("  {:>+12.4}", family.bodies[body] / scale));
        text += &format!("{name:>10}  {:>33}{}\n", parts.join(" "), works.collect::<String>());
    }
    text
}

fn json_text(scene: &Value, rows: &[Row], modes: &Modes) -> String {
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
                "verdict": row.verdict.to_string(),
            });
            if let Some((shape, energy)) = &row.shape {
                mode["shape"] = shape.iter().map(|u| json!([u.re, u.im])).collect();
                for family in &energy.families {
                    mode[format!("{}_work", family.name)] = json!(family.bodies);
                }
                mode["net_work"] = json!(energy.net());
            }
            mode
        })
        .collect();
    let internal: Vec<Value> = modes.internal.iter().map(|l| json!([l.re, l.im])).collect();
    let all = json!({ "scene": scene, "modes": list, "real": modes.real, "internal": internal });
    format!("{all:#}\n")
}
