//! Tables of motions and branches.

use cea::Threshold;
use cycle::{Cycle, Measures, Motion};
use output::Table;

use super::{Branch, Branches, Cycles, MotionOfMode};
use sweep::{ChangeOf, Sweep, SweptParameter, event};

/// Column of the power that the outer faces radiate at radiation efficiency 1.
const RADIATED: &str = "radiated_power_at_efficiency_1_w";

/// Column of the part of the outer area that counts as at rest in it.
const WITHOUT_ROWS: &str = "outer_area_without_rows";

/// Hz of an eigenvalue.
fn hz(omega: f64) -> f64 {
    omega / std::f64::consts::TAU
}

impl Cycles {
    /// The motions, one a row: `cycles`.
    #[must_use]
    pub fn table(&self) -> Table {
        let mut columns: Vec<String> = [
            "from_mode",
            "cea_hz",
            "growth_per_s",
            "kind",
            "cycle_hz",
            "balance_hz",
            "largest_multiplier",
            "residual",
            "kinetic_energy_j",
            "power_imbalance",
            "loudness_m_per_s",
        ]
        .map(str::to_owned)
        .to_vec();
        columns.extend(self.outer_without_rows.iter().flat_map(|_| [RADIATED, WITHOUT_ROWS].map(str::to_owned)));
        for (name, _) in &self.bodies {
            columns.push(format!("rms_velocity_m_per_s {name}"));
            columns.extend(self.has_peaks.then(|| format!("peak_m {name}")));
        }
        for name in &self.contacts {
            columns.extend([format!("open {name}"), format!("stuck {name}")]);
        }
        columns.extend(self.families.iter().map(|family| format!("power_w {family}")));
        let rows = self.motions.iter().map(|of| {
            let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
            let (cycle, measures) = (cycle_of(&of.motion), of.measures.as_ref());
            let mut row = vec![
                of.start.clone(),
                hz(of.lambda.im).to_string(),
                of.lambda.re.to_string(),
                kind(&of.motion).into(),
                number(cycle.map(Cycle::frequency_hz)),
                number(of.balanced_hz),
                number(cycle.map(Cycle::largest_multiplier)),
                number(cycle.map(|cycle| cycle.residual)),
                number(measures.map(|measures| measures.kinetic_energy)),
                number(measures.map(Measures::imbalance)),
                number(of.loudness),
            ];
            let radiated = number(of.radiated_power.as_ref().map(|all| all.iter().sum()));
            row.extend(self.outer_without_rows.iter().flat_map(|part| [radiated.clone(), part.to_string()]));
            for (_, dofs) in &self.bodies {
                row.push(number(measures.map(|measures| measures.rms_of(dofs))));
                row.extend(self.has_peaks.then(|| number(measures.map(|measures| measures.peak_of(dofs)))));
            }
            for contact in 0..self.contacts.len() {
                row.push(number(measures.map(|measures| measures.contacts[contact].open)));
                row.push(number(measures.map(|measures| measures.contacts[contact].stuck)));
            }
            let powers = |at: usize| number(measures.map(|measures| measures.powers[at].1));
            row.extend((0..self.families.len()).map(powers));
            row
        });
        Table::new("cycles", columns, rows)
    }

    /// Normal force, sliding velocity and state of each contact over the period of each cycle: `cycle_contacts`.
    #[must_use]
    pub fn contacts_table(&self) -> Table {
        let columns = ["from_mode", "contact", "part_of_period", "normal_force_n", "sliding_velocity_m_per_s", "state"];
        let rows = self.motions.iter().flat_map(|of| {
            of.history.iter().enumerate().flat_map(move |(step, contacts)| {
                let part = step as f64 / of.history.len() as f64;
                self.contacts.iter().zip(contacts).map(move |(name, moment)| {
                    vec![
                        of.start.clone(),
                        name.clone(),
                        part.to_string(),
                        moment.normal_force.to_string(),
                        moment.sliding_velocity.to_string(),
                        moment.state.name().to_owned(),
                    ]
                })
            })
        });
        Table::new("cycle_contacts", columns, rows)
    }

    /// Harmonics of the velocity of each cycle, together and by body: `cycle_spectrum`.
    #[must_use]
    pub fn spectrum_table(&self) -> Table {
        let mut columns =
            ["from_mode", "harmonic", "frequency_hz", "loudness_m_per_s", "part_above"].map(str::to_owned).to_vec();
        columns.extend(self.outer_without_rows.map(|_| RADIATED.to_owned()));
        columns.extend(self.bodies.iter().map(|(name, _)| format!("rms_velocity_m_per_s {name}")));
        let mut rows = Vec::new();
        for of in &self.motions {
            let (Some(harmonics), Some(loudness)) = (&of.harmonics, of.loudness) else { continue };
            let mut part_above = 1.0;
            for harmonic in 1..=harmonics.velocity.len() {
                let rms = harmonics.rms_of(harmonic, &self.displacements);
                part_above -= (rms / loudness).powi(2);
                let head = [harmonic.to_string(), harmonics.frequency_hz(harmonic).to_string(), rms.to_string()];
                // Rotations alone have no loudness of which this were a part.
                let part_above = if loudness > 0.0 { part_above.to_string() } else { String::new() };
                let of_bodies = self.bodies.iter().map(|(_, dofs)| harmonics.rms_of(harmonic, dofs));
                let radiated = of.radiated_power.as_ref().map(|all| all[harmonic - 1]);
                let numbers = radiated.into_iter().chain(of_bodies).map(|number| number.to_string());
                let head = [of.start.clone()].into_iter().chain(head).chain([part_above]);
                rows.push(head.chain(numbers).collect::<Vec<_>>());
            }
        }
        Table::new("cycle_spectrum", columns, rows)
    }

    /// The motions in words, a line each with the loudest body.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = self.divergence_in_words().map_or(String::new(), |words| format!("WARNING: {words}\n\n"));
        text += &format!(
            "{:>7}  {:>12}  {:>11}  {:>12}  {:>12}  {:>10}  {:>6}  {:>6}  {:>8}  kind, loudest body\n",
            "from", "CEA Hz", "growth 1/s", "cycle Hz", "balance Hz", "multiplier", "open", "stuck", "rms m/s"
        );
        for of in &self.motions {
            let blank = String::new;
            let (cycle, measures) = (cycle_of(&of.motion), of.measures.as_ref());
            let hertz = |value: Option<f64>| value.map_or_else(blank, output::hertz);
            let share = |value: fn(&cycle::Shares) -> f64| {
                let greatest = |measures: &Measures| measures.contacts.iter().map(value).fold(0.0, f64::max);
                measures.map_or_else(blank, |measures| format!("{:.3}", greatest(measures)))
            };
            let loudest = measures.and_then(|measures| {
                let bodies = self.bodies.iter().map(|(name, dofs)| (name, measures.rms_of(dofs)));
                bodies.max_by(|a, b| a.1.total_cmp(&b.1))
            });
            text += &format!(
                "{:>7}  {:>12}  {:>11.4}  {:>12}  {:>12}  {:>10}  {:>6}  {:>6}  {:>8}  {}{}\n",
                of.start,
                output::hertz(hz(of.lambda.im)),
                of.lambda.re,
                hertz(cycle.map(Cycle::frequency_hz)),
                hertz(of.balanced_hz),
                cycle.map_or_else(blank, |cycle| format!("{:.4}", cycle.largest_multiplier())),
                share(|shares| shares.open),
                share(|shares| shares.stuck),
                loudest.map_or_else(blank, |(_, rms)| format!("{rms:.4}")),
                kind(&of.motion),
                loudest.map_or_else(blank, |(name, _)| format!(", {name}")),
            );
        }
        let imbalance =
            self.motions.iter().filter_map(|of| of.measures.as_ref()).map(Measures::imbalance).fold(0.0, f64::max);
        let is_empty = |of: &MotionOfMode| of.balanced_hz.is_none() && cycle_of(&of.motion).is_some();
        let empty = if self.motions.iter().any(is_empty) {
            "balance Hz: empty where the harmonic balance of a cycle is not found, or is of another motion; more --harmonics may find it\n"
        } else {
            ""
        };
        text + &format!(
            "\n{empty}open, stuck: largest share of the period of a contact; multiplier: what a small deviation becomes in a period\n\
             the motion's tangent deviates from the complex eigenvalue analysis by {:.1e}; powers sum to zero within {imbalance:.1e}\n",
            self.tangent_deviation
        ) + &self.at_rest()
    }

    /// Sentence on the divergence of the brake beside its modes; `None` where it does not diverge.
    #[must_use]
    pub fn divergence_in_words(&self) -> Option<String> {
        let fastest = output::significant(*self.diverging.last()?, 6);
        let eigenvalues = match self.diverging.len() {
            1 => format!("a real eigenvalue grows by {fastest} 1/s"),
            count => format!("{count} real eigenvalues grow, by up to {fastest} 1/s"),
        };
        Some(format!(
            "the brake DIVERGES too, without oscillation: {eigenvalues}. A motion that starts in a mode alone may not show it, and any deviation along it \
             leaves what is said of the motion here"
        ))
    }

    /// A line on the outer faces that count as at rest for want of rows, where there are any.
    fn at_rest(&self) -> String {
        match self.outer_without_rows {
            Some(part) if part > 0.0 => format!(
                "radiated power: {:.2} % of the outer area counts as at rest, as it has no rows in the matrices and nothing is said to hold it\n",
                100.0 * part
            ),
            _ => String::new(),
        }
    }
}

impl MotionOfMode {
    /// Start in words: `mode 2` or `noise 1`.
    #[must_use]
    pub fn start_in_words(&self) -> String {
        if self.start.starts_with("noise") { self.start.clone() } else { format!("mode {}", self.start) }
    }
}

fn cycle_of(motion: &Motion) -> Option<&Cycle> {
    match motion {
        Motion::Cycle(cycle) => Some(cycle),
        _ => None,
    }
}

/// Fate of a motion, in words.
fn kind(motion: &Motion) -> &'static str {
    match motion {
        Motion::Cycle(_) => "cycle",
        Motion::Rest => "rest",
        Motion::Unbounded => "unbounded",
        Motion::NotPeriodic { may_settle: true, .. } => "not settled",
        Motion::NotPeriodic { .. } => "not periodic",
    }
}

impl Branches {
    /// The cycles of all branches, one a row: `cycle_branches`.
    #[must_use]
    pub fn table(&self) -> Table {
        let columns = [
            "mode",
            "onset",
            "onset_hz",
            &self.sweep.parameter.name,
            "balance_hz",
            "cycle_hz",
            "amplitude",
            "fold",
            "stable",
            "largest_multiplier",
            "open",
            "stuck",
            "loudest_body",
            "rms_velocity_m_per_s",
            "loudness_m_per_s",
            "branch_end",
        ];
        let rows = self.branches.iter().flat_map(|branch| branch.cycles.iter().map(|cycle| branch.row(cycle)));
        Table::new("cycle_branches", columns, rows)
    }

    /// The branches in words.
    #[must_use]
    pub fn text(&self) -> String {
        let SweptParameter { name, from, .. } = &self.sweep.parameter;
        let threshold = &self.sweep.threshold;
        let mut text: String = self.branches.iter().map(|branch| branch.text(name, threshold)).collect();
        text += "amplitude: of the first harmonic, in that at which the first contact opens or sticks\n";
        if self.branches.iter().flat_map(|branch| &branch.cycles).any(|cycle| cycle.is_fold) {
            text += "fold: the balance turned since the line above; its sliding is smoothed, and motions in time may turn elsewhere: where their multiplier is 1\n";
        }
        if self.growing_at_start() > 0 {
            let modes = self.growing_at_start();
            text += &format!("modes that grow at {name} = {from} already, whose cycles are not followed: {modes}\n");
        }
        text += &self.divergence_in_words().map_or(String::new(), |words| format!("WARNING: {words}\n"));
        for (from, to) in &self.sweep.unresolved {
            text += &format!(
                "{name} = {from} to {to}: a mode comes so near its threshold that it may have an onset or not\n"
            );
        }
        text
    }
}

impl Branches {
    /// Sentence on the divergence of the brake in the range of the parameter, beside its modes; `None` where it does not diverge.
    #[must_use]
    pub fn divergence_in_words(&self) -> Option<String> {
        let Sweep { parameter: SweptParameter { name, from, .. }, onsets, diverging_at_start, .. } = &self.sweep;
        let at_start = (*diverging_at_start > 0).then(|| format!("at {name} = {from} already"));
        let changes = onsets.iter().filter(|onset| matches!(onset.of, ChangeOf::Divergence | ChangeOf::Exchange));
        let words = changes.map(|onset| format!("it {} at {}", onset.event(&self.sweep.threshold), onset.at));
        let all: Vec<String> = at_start.into_iter().chain(words).collect();
        (!all.is_empty()).then(|| {
            format!(
                "the brake DIVERGES too, without oscillation, and cycles do not show it: {}. Where it diverges any deviation along it leaves the cycle",
                all.join(", ")
            )
        })
    }
}

impl Branch {
    fn row(&self, of: &super::BranchCycle) -> Vec<String> {
        let mut row = vec![
            self.mode.clone(),
            self.onset.to_string(),
            self.onset_hz.to_string(),
            of.at.to_string(),
            of.balanced_hz.to_string(),
        ];
        let Some((cycle, measures)) = &of.in_time else {
            row.extend([String::new(), of.amplitude.to_string(), yes(of.is_fold)]);
            row.extend(vec![String::new(); 7]);
            row.push(self.end.to_string());
            return row;
        };
        let greatest = |share: fn(&cycle::Shares) -> f64| measures.contacts.iter().map(share).fold(0.0, f64::max);
        let bodies = self.bodies.iter().map(|(name, dofs)| (name.clone(), measures.rms_of(dofs)));
        let (loudest, rms) = bodies.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        row.extend([
            cycle.frequency_hz().to_string(),
            of.amplitude.to_string(),
            yes(of.is_fold),
            yes(cycle.is_stable()),
            cycle.largest_multiplier().to_string(),
            greatest(|shares| shares.open).to_string(),
            greatest(|shares| shares.stuck).to_string(),
            loudest,
            rms.to_string(),
            of.loudness.map_or(String::new(), |loudness| loudness.to_string()),
            self.end.to_string(),
        ]);
        row
    }

    fn text(&self, name: &str, threshold: &Threshold) -> String {
        let mut text = format!(
            "mode {}, onset at {name} = {:.6}, {} Hz, where it {}\n{:>12}  {:>12}  {:>12}  {:>10}  {:>10}  {:>6}  {:>6}  {:>8}\n",
            self.mode,
            self.onset,
            output::hertz(self.onset_hz),
            event(self.starts, threshold),
            name,
            "balance Hz",
            "cycle Hz",
            "amplitude",
            "multiplier",
            "open",
            "stuck",
            "rms m/s"
        );
        for of in &self.cycles {
            let head = format!("{:>12.6}  {:>12}", of.at, output::hertz(of.balanced_hz));
            let fold = if of.is_fold { "  fold" } else { "" };
            text += &match &of.in_time {
                None => format!(
                    "{head}  {:>12}  {:>10.4}  no motion in time found from the balance{fold}\n",
                    "", of.amplitude
                ),
                Some((cycle, measures)) => {
                    let greatest =
                        |share: fn(&cycle::Shares) -> f64| measures.contacts.iter().map(share).fold(0.0, f64::max);
                    let rms = self.bodies.iter().map(|(_, dofs)| measures.rms_of(dofs)).fold(0.0, f64::max);
                    format!(
                        "{head}  {:>12}  {:>10.4}  {:>10.4}  {:>6.3}  {:>6.3}  {rms:>8.4}{}{fold}\n",
                        output::hertz(cycle.frequency_hz()),
                        of.amplitude,
                        cycle.largest_multiplier(),
                        greatest(|shares| shares.open),
                        greatest(|shares| shares.stuck),
                        if cycle.is_stable() { "" } else { "  unstable" },
                    )
                }
            };
        }
        text + &format!("end: {}\n\n", self.end)
    }
}

fn yes(is: bool) -> String {
    if is { "yes" } else { "no" }.into()
}
