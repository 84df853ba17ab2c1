//! The answer in words, and as tables.

use ::rare::Probability;
use output::Table;
use study::{ModeLabel, Plan, Scene, SceneLabels};

use super::{LikelySqueal, ModeProbability, Rare};

/// Most inputs of a likely brake that are named in words, and most brakes; chosen: a line, and a screen.
const MOST_NAMED: [usize; 2] = [6, 5];

impl Rare {
    /// The answer in words.
    #[must_use]
    pub fn text(&self, plan: &Plan) -> String {
        let beyond = if plan.threshold.is_axis() { String::new() } else { format!(", with {}", plan.threshold) };
        let mut text = self.doubts.iter().map(|doubt| format!("WARNING: {doubt}\n\n")).collect::<String>();
        if let Some(bound) = &self.bound {
            let ranges: Vec<String> = bound.stable.iter().map(|[from, to]| format!("{from:.5} to {to:.5}")).collect();
            let name = self.inputs.first().map_or("", |input| &input.name);
            text += &format!(
                "certified: nothing grows for {name} from {}, so that the probability of squeal is at most {:.3e}\n",
                ranges.join(" and from "),
                bound.probability
            );
        }
        if self.design_points.is_empty() {
            let upper = self.probability.upper;
            let looked = match &self.inputs[..] {
                [only] => format!("none in a scan of {} up to 8 standard deviations", only.name),
                _ => "none in any direction up to 7 standard deviations".into(),
            };
            text += &format!(
                "no squeal was found{beyond}: {looked}, and none in {} samples; probability at most {upper:.2e} (95 %)\n",
                self.plain
            );
            return text;
        }
        text += &format!("probability of squeal{beyond}: {}\n", in_words(&self.probability));
        if !self.is_reached {
            text += &format!(
                "  NOT as sure as was asked for: the standard error is {:.0} %; more spectra make it smaller (--budget)\n",
                100.0 * self.probability.standard_error / self.probability.value
            );
        }
        for mode in &self.modes {
            let open = match mode.open {
                0.0 => String::new(),
                open => format!("; another {open:.1e} may be it, as its name is open"),
            };
            text += &format!("  {}: {}{open}\n", of_label(mode.mode), in_words(&mode.probability));
        }
        let is_lower = |mode: &ModeProbability| {
            let Probability { value, standard_error, lower, .. } = mode.probability;
            lower < value - 4.0 * standard_error && lower < 0.95 * value
        };
        if self.modes.iter().any(is_lower) {
            text += "  the lower end of a mode is that of a count of the lines that have seen it, however sure the mean of these is\n";
        }
        if let Some(step) = self.scanned {
            text += &format!(
                "  by a scan of {}: what squeals in a range wider than {step:.1e} deviations is found; {:.1e} of the upper end is not proven\n",
                self.inputs.first().map_or("", |input| &input.name),
                self.unproven
            );
        } else {
            text += &format!(
                "  by {} lines; of {} points elsewhere {} squeal, and none that was followed contradicts what is known; {:.1e} of the upper end is not proven\n",
                self.lines, self.elsewhere[0], self.elsewhere[1], self.unproven
            );
        }
        if self.widened > 1.0 {
            text += &format!(
                "  the brake is reduced: its onsets at the likeliest squealing brakes differ from those of the full model, by which intervals are \
                 {:.1} % wider\n",
                100.0 * (self.widened - 1.0)
            );
        }
        if self.is_not_compared {
            text += "  the brake is reduced, and was NOT compared with the full model at its likeliest squeal: an input is none of its parameters\n";
        }
        for (rank, point) in self.design_points.iter().enumerate().take(MOST_NAMED[1]) {
            text += &self.of_point(rank, point);
        }
        if self.design_points.len() > MOST_NAMED[1] {
            text += &format!("and {} less likely ones\n", self.design_points.len() - MOST_NAMED[1]);
        }
        text
    }

    fn of_point(&self, rank: usize, point: &LikelySqueal) -> String {
        let which =
            if rank == 0 { "likeliest squealing brake".into() } else { format!("likely squealing brake {}", rank + 1) };
        let mut order: Vec<usize> = (0..self.inputs.len()).collect();
        order.sort_by(|&a, &b| point.deviations[b].abs().total_cmp(&point.deviations[a].abs()));
        let named = |&at: &usize| {
            let input = &self.inputs[at];
            let unit = if input.unit == "1" { "" } else { &input.unit };
            format!(
                "  {} = {:.5} {unit}{}(median {:.5}; {:+.2} deviations, {:.0} % of the variance there)\n",
                input.name,
                point.values[at],
                if unit.is_empty() { "" } else { " " },
                self.medians[at],
                point.deviations[at],
                100.0 * point.parts[at]
            )
        };
        let inputs: String = order.iter().take(MOST_NAMED[0]).map(named).collect();
        let open = if point.is_settled { "" } else { "; there may be a nearer one beside it" };
        let others = match order.len().saturating_sub(MOST_NAMED[0]) {
            0 => String::new(),
            others => format!("  and {others} others nearer to their medians\n"),
        };
        format!(
            "{which}: {} at {:.1} Hz, {:.3} deviations from the medians, {:.2e} to first order{open}\n{inputs}{others}",
            of_point_modes(&point.modes),
            point.omega / std::f64::consts::TAU,
            point.beta,
            point.first_order
        )
    }
}

fn of_label(label: ModeLabel) -> String {
    if label.is_mode() { format!("mode {label}") } else { label.to_string() }
}

/// The names of the modes that grow, as in a table.
fn joined(modes: &[Vec<ModeLabel>]) -> String {
    modes.iter().map(|names| ModeLabel::candidates(names)).collect::<Vec<_>>().join(";")
}

fn of_point_modes(modes: &[Vec<ModeLabel>]) -> String {
    match modes {
        [] => "a mode".into(),
        modes => format!("mode {}", joined(modes)),
    }
}

/// "1.85e-6 (1.65e-6 to 2.08e-6 with 95 % confidence; standard error 5.9 %)".
fn in_words(probability: &Probability) -> String {
    let Probability { value, standard_error, lower, upper } = probability;
    if *value == 0.0 {
        return format!("in no sample surely; {upper:.2e} at most with 95 % confidence");
    }
    let relative = 100.0 * standard_error / value;
    format!("{value:.3e} ({lower:.2e} to {upper:.2e} with 95 % confidence; standard error {relative:.1} %)")
}

/// The table `rare` of the scenes `of_scenes`: for each a row for squeal of any mode, and a row for each mode.
pub fn rare_table<'a>(plan: &Plan, of_scenes: impl IntoIterator<Item = (&'a Scene, &'a Rare)>) -> Table {
    let own =
        ["probability", "lower", "upper", "standard_error", "open", "unproven", "certified_bound", "lines", "spectra"];
    let rows = of_scenes.into_iter().flat_map(|(scene, rare)| {
        let columns = plan.labels.scene_columns(scene);
        let row = |mode: String, probability: &Probability, open: f64| {
            let Probability { value, lower, upper, standard_error } = probability;
            let mut row = columns.clone();
            row.push(mode);
            row.extend([value, lower, upper, standard_error, &open, &rare.unproven].map(|number| number.to_string()));
            row.push(rare.bound.as_ref().map_or_else(String::new, |bound| bound.probability.to_string()));
            row.extend([rare.lines.to_string(), rare.spectra.to_string()]);
            row
        };
        let any = row("any".into(), &rare.probability, 0.0);
        let each = rare.modes.iter().map(|mode| row(mode.mode.to_string(), &mode.probability, mode.open));
        [any].into_iter().chain(each).collect::<Vec<_>>()
    });
    Table::new("rare", [&SceneLabels::MODE_COLUMNS[..], &own].concat(), rows)
}

/// The table `design_points` of the scenes `of_scenes`: a row for each likely squealing brake and each of its inputs.
pub fn design_points_table<'a>(plan: &Plan, of_scenes: impl IntoIterator<Item = (&'a Scene, &'a Rare)>) -> Table {
    let own = [
        "brake",
        "mode",
        "frequency",
        "beta",
        "first_order",
        "settled",
        "input",
        "unit",
        "value",
        "squealing",
        "median",
        "deviations",
        "part",
    ];
    let rows = of_scenes.into_iter().flat_map(|(scene, rare)| {
        let columns = plan.labels.scene_columns(scene);
        let of_point = move |(rank, point): (usize, &LikelySqueal)| {
            let of_input = |at: usize| {
                let input = &rare.inputs[at];
                let mut row = columns.clone();
                row.extend([(rank + 1).to_string(), joined(&point.modes)]);
                let numbers = [point.omega / std::f64::consts::TAU, point.beta, point.first_order];
                row.extend(numbers.map(|number| number.to_string()));
                row.push(point.is_settled.to_string());
                row.extend([input.name.clone(), input.unit.clone()]);
                let numbers =
                    [point.values[at], point.squealing[at], rare.medians[at], point.deviations[at], point.parts[at]];
                row.extend(numbers.map(|number| number.to_string()));
                row
            };
            (0..rare.inputs.len()).map(of_input).collect::<Vec<_>>()
        };
        rare.design_points.iter().enumerate().flat_map(of_point).collect::<Vec<_>>()
    });
    Table::new("design_points", [SceneLabels::SCENE_COLUMNS, &own].concat(), rows)
}
