//! Influence in words, and as a table.

use montecarlo::SobolIndex;
use output::{Table, printable, significant};
use study::{Plan, Scene, SceneLabels};

use super::{Influence, OutputInfluence, OutputKind};

/// Fraction of the variance: inputs that do not surely explain more are counted together in words; chosen.
const LEAST_IN_WORDS: f64 = 0.01;
/// Most of these inputs that are named; chosen: a line.
const MOST_NAMED: usize = 8;

impl Influence {
    /// The answer in words, output by output.
    #[must_use]
    pub fn text(&self, plan: &Plan) -> String {
        let reason =
            self.first_failure.as_ref().map_or(String::new(), |reason| format!("; the first: {}", printable(reason)));
        let mut text = self.doubts.iter().map(|doubt| format!("WARNING: {doubt}\n\n")).collect::<String>();
        if self.failures > 0 {
            text += &format!(
                "{} of {} draws FAILED and are left out of what follows; they may be unstable{reason}\n",
                self.failures, self.draws
            );
        }
        if self.undecided > 0 {
            text += &format!("{} of {} draws are UNDECIDED and count as stable\n", self.undecided, self.draws);
        }
        // Of a mode that is hardly ever unstable there is nothing to say; of the scene that is said.
        let (said, rare): (Vec<_>, Vec<_>) =
            self.outputs.iter().partition(|output| output.output.mode.is_none() || !output.inputs.is_empty());
        text.extend(said.into_iter().map(|output| self.of_output(output, plan)));
        let mut modes: Vec<String> = rare.iter().filter_map(|output| Some(output.output.mode?.to_string())).collect();
        modes.dedup();
        if !modes.is_empty() {
            let needed = OutputInfluence::FEWEST_UNLIKE;
            text += &format!(
                "Of modes {} too few draws differ from the others: fewer than the {needed} that are needed.\n",
                modes.join(", ")
            );
        }
        let correlated: Vec<&str> =
            self.inputs.iter().filter(|input| input.is_correlated).map(|input| input.name.as_str()).collect();
        if !correlated.is_empty() {
            text += &format!(
                "{} are correlated: what one explains may be explained by another as well, and the parts do not add up.\n",
                correlated.join(", ")
            );
        }
        if self.open > 0 {
            text +=
                &format!("In {} draws an unstable mode has a name that is open: it counts for no mode.\n", self.open);
        }
        text
    }

    fn of_output(&self, output: &OutputInfluence, plan: &Plan) -> String {
        let whose = match output.output.mode {
            None => "any mode".to_owned(),
            Some(mode) if mode.is_mode() => format!("mode {mode}"),
            Some(label) => label.to_string(),
        };
        let solved = self.draws - self.failures;
        let share = 100.0 * output.nonzero as f64 / solved.max(1) as f64;
        let beyond = match plan.threshold.is_axis() {
            true => String::new(),
            false => format!(" with {}", plan.threshold),
        };
        let heading = match output.output.kind {
            OutputKind::Growth => format!(
                "growth of {whose}, 0 where stable: mean {} 1/s, deviation {} 1/s; unstable{beyond} in {share:.1} % of the draws\n",
                significant(output.mean, 4),
                significant(output.deviation, 4)
            ),
            OutputKind::Instability => match output.output.mode {
                None => "whether any mode is unstable\n".to_owned(),
                Some(mode) if mode.is_mode() => format!("whether {whose} is unstable\n"),
                Some(_) => format!("whether there is {whose}\n"),
            },
        };
        if output.inputs.is_empty() {
            let (found, needed) = (output.unlike, OutputInfluence::FEWEST_UNLIKE);
            return heading
                + &format!(
                    "  too few draws differ from the others to say what makes it vary: {found}; needed: {needed}\n"
                );
        }
        let mut text = heading;
        let (mut others, mut sum) = (Vec::new(), 0.0);
        for (at, input) in output.ranked() {
            let interval = input.first_order.interval(Self::CONFIDENCE);
            let total = input.total.map(|total| format!("; in all, with others, {}", in_words(&total)));
            let matters = interval.lower > LEAST_IN_WORDS
                || input.total.is_some_and(|total| total.interval(Self::CONFIDENCE).lower > LEAST_IN_WORDS);
            if matters {
                sum += input.first_order.part();
                let name = &self.inputs[at].name;
                let explained = in_words(&input.first_order);
                text += &format!("  {name} explains {explained} of the variance{}\n", total.unwrap_or_default());
            } else {
                others.push(self.inputs[at].name.as_str());
            }
        }
        if !others.is_empty() {
            let which = match others.len() {
                1..=MOST_NAMED => others.join(", "),
                count => format!("{count} others"),
            };
            let each = if others.len() > 1 { " each" } else { "" };
            text += &format!("  {which}: not surely more than 1 %{each}\n");
        }
        if let Some(rows) = output.unlike_in_design.filter(|rows| *rows < OutputInfluence::FEWEST_UNLIKE) {
            let needed = OutputInfluence::FEWEST_UNLIKE;
            text += &format!(
                "  too few rows of the design differ from the others for total indices: {rows}; needed: {needed}\n"
            );
        }
        // Of what does not surely matter the sum would be one of noise.
        if self.inputs.iter().all(|input| !input.is_correlated) && others.len() < output.inputs.len() {
            text += &format!(
                "  each alone, these explain about {:.0} %; the rest is what inputs do together{}\n",
                (100.0 * sum).min(100.0),
                if others.is_empty() { "" } else { ", and the others" }
            );
        }
        text
    }

    /// A row of the table `influence` for each output, input and kind of index.
    fn rows(&self, plan: &Plan, scene: &Scene) -> Vec<Vec<String>> {
        let mut rows = Vec::new();
        for output in &self.outputs {
            for (input, found) in self.inputs.iter().zip(&output.inputs) {
                let indices = [Some(("first-order", found.first_order)), found.total.map(|total| ("total", total))];
                for (kind, index) in indices.into_iter().flatten() {
                    let interval = index.interval(Self::CONFIDENCE);
                    let mut row = plan.labels.scene_columns(scene);
                    row.push(output.output.mode.map_or("any".into(), |mode| mode.to_string()));
                    row.extend([output.output.kind.name(), &input.name, &input.unit, kind].map(str::to_owned));
                    let numbers = [index.part(), interval.lower, interval.upper, index.standard_error];
                    row.extend(numbers.map(|number| number.to_string()));
                    row.push(index.samples.to_string());
                    rows.push(row);
                }
            }
        }
        rows
    }
}

/// The table `influence` of scenes: a row for each output, input and kind of index.
pub fn influence_table<'a>(plan: &Plan, of_scenes: impl IntoIterator<Item = (&'a Scene, &'a Influence)>) -> Table {
    let own = ["output", "input", "unit", "index", "value", "lower", "upper", "standard_error", "samples"];
    let header = [&SceneLabels::MODE_COLUMNS[..], &own].concat();
    Table::new("influence", header, of_scenes.into_iter().flat_map(|(scene, influence)| influence.rows(plan, scene)))
}

/// "83 % (80 to 86 %)".
fn in_words(index: &SobolIndex) -> String {
    let interval = index.interval(Influence::CONFIDENCE);
    let percent = |part: f64| (100.0 * part).round();
    format!("{} % ({} to {} %)", percent(index.part()), percent(interval.lower), percent(interval.upper))
}
