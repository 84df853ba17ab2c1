//! The samples that a study has kept, as tables: what was drawn and what grew, and which input makes squeal vary.

use std::path::Path;

use montecarlo::Summary;
use num_complex::Complex;
use output::Table;
use study::{
    DrawnInputs, KeptMode, KeptSample, KeptSamples, ModeLabel, Plan, Scene, SceneLabels, StudyTally, UncertainBrake,
};

use super::report::influence_table;
use super::{drawn_again, influence_of_kept};
use crate::Error;
use crate::every_mode::{mode_columns, mode_row};

/// Writes `samples.csv`, `unstable_modes.csv` and `influence.csv` of a study that has kept its samples, see [`StudyTally::kept`]; of another one nothing.
/// Nothing is evaluated for them.
///
/// A row of `samples.csv` is one sample in one scene: its index, the largest growth rate, 1/s, 0 where nothing is unstable and empty where
/// the evaluation failed; the unstable modes as `name:growth`, with `;` between, of open names all candidates as in `1|2`; `open`, 1 where nothing surely
/// is unstable and a verdict is open; `may_be`, the modes whose verdict is open; and the values of what is drawn, empty where the scene does not depend
/// on it; an input that is called as one of the columns before has `NAME (drawn)`. A sample whose draw failed has no row.
///
/// # Errors
/// [`Error::Output`].
pub fn write_kept_samples<B: UncertainBrake>(
    brake: &B,
    summary: &Summary<StudyTally>,
    dir: &Path,
) -> Result<(), Error> {
    let Some(kept) = &summary.tally.kept else { return Ok(()) };
    let plan = brake.plan();
    let found = influence_of_kept(brake, summary.samples, kept);
    let known = plan.scenes.iter().zip(&found).filter_map(|(scene, influence)| Some((scene, influence.as_ref()?)));
    influence_table(plan, known).write(dir)?;
    unstable_modes(plan, kept).write(dir)?;

    let of = brake.drawn_inputs();
    let names =
        |of: &dyn DrawnInputs<B::Sample>, scene: &Scene| of.inputs(scene).into_iter().map(|input| input.name).collect();
    let inputs: Vec<Vec<String>> =
        plan.scenes.iter().map(|scene| of.map_or_else(Vec::new, |of| names(of, scene))).collect();
    let mut columns: Vec<&str> = Vec::new();
    for name in inputs.iter().flatten() {
        if !columns.contains(&name.as_str()) {
            columns.push(name);
        }
    }
    let drawn = drawn_again(brake, summary.samples);
    let of_scene = |((scene, kept), own): ((&Scene, &KeptSamples), &Vec<String>)| {
        let places: Vec<Option<usize>> = columns.iter().map(|name| own.iter().position(|it| it == name)).collect();
        let row = |(sample, index): (&Option<B::Sample>, u64)| {
            let sample = sample.as_ref()?;
            let values = of.map_or_else(Vec::new, |of| of.input_values(scene, sample));
            let mut row = plan.labels.scene_columns(scene);
            row.push(index.to_string());
            row.extend(in_words(kept, index));
            row.extend(places.iter().map(|place| place.map_or(String::new(), |place| values[place].to_string())));
            Some(row)
        };
        drawn.iter().zip(0..).filter_map(row).collect::<Vec<_>>()
    };
    let own = [SceneLabels::SCENE_COLUMNS, &["sample", "growth", "unstable", "open", "may_be"]].concat();
    // Columns are asked for by name.
    let drawn_column = |name: &&str| match own.contains(name) {
        true => format!("{name} (drawn)"),
        false => (*name).to_owned(),
    };
    let header: Vec<String> = own.iter().map(|&name| name.to_owned()).chain(columns.iter().map(drawn_column)).collect();
    let rows = plan.scenes.iter().zip(kept).zip(&inputs).flat_map(of_scene);
    Ok(Table::new("samples", header, rows).write(dir)?)
}

/// The table `unstable_modes`: a row for each unstable mode of each kept sample, whose cells are numbers alone.
fn unstable_modes(plan: &Plan, kept: &[KeptSamples]) -> Table {
    let of_scene = |(scene, kept): (&Scene, &KeptSamples)| -> Vec<Vec<String>> {
        let place = plan.labels.scene_columns(scene);
        let row = |sample: &KeptSample, mode: &KeptMode| {
            mode_row(&place, sample.index, &mode.names, Complex::new(mode.growth, mode.omega))
        };
        kept.unstable
            .iter()
            .flat_map(|sample| sample.modes.iter().map(|mode| row(sample, mode)).collect::<Vec<_>>())
            .collect()
    };
    Table::new("unstable_modes", mode_columns(), plan.scenes.iter().zip(kept).flat_map(of_scene))
}

/// The largest growth rate and the unstable modes of a sample, whether it is open that anything is, and what may be.
fn in_words(kept: &KeptSamples, index: u64) -> [String; 4] {
    let Some(KeptSample { growth, modes, may_be, .. }) = kept.sample(index) else {
        let [growth, open] = if kept.has_failed(index) { ["", ""] } else { ["0", "0"] };
        return [growth, "", open, ""].map(str::to_owned);
    };
    let join = |modes: Vec<String>| modes.join(";");
    let unstable = modes.iter().map(|mode| format!("{}:{}", ModeLabel::candidates(&mode.names), mode.growth)).collect();
    let open = u8::from(kept.is_open(index)).to_string();
    [growth.to_string(), join(unstable), open, join(may_be.iter().map(|names| ModeLabel::candidates(names)).collect())]
}
