//! `every_mode.csv`: every mode of every sample, stable ones too, as a long table.

use std::f64::consts::TAU;
use std::path::Path;

use montecarlo::{Progress, stream};
use num_complex::Complex;
use output::LongTable;
use rayon::prelude::*;
use study::{ModeLabel, SampledMode, SceneLabels, Scratch, Study, UncertainBrake};

use crate::Error;
use crate::real_system::check_real;

/// Number of samples that are solved together; chosen, so that batched solvers are filled.
const BLOCK: u64 = 32;
/// Number of blocks whose rows are in memory at once, for each thread; chosen: with fewer, threads wait for each other more often; with more, more memory is
/// taken.
const BLOCKS_PER_THREAD: usize = 4;

/// Name of the table of every mode, for refusals: it needs whole spectra of real systems.
pub const EVERY_MODE: &str = "every mode of every sample";

/// Columns of a table of the modes of samples.
pub(crate) fn mode_columns() -> Vec<&'static str> {
    [SceneLabels::SCENE_COLUMNS, &["sample", "mode", "frequency_hz", "growth_rate", "damping_ratio"]].concat()
}

/// Row of a mode of a sample, by the cells of its scene.
pub(crate) fn mode_row(scene: &[String], sample: u64, names: &[ModeLabel], lambda: Complex<f64>) -> Vec<String> {
    let numbers = [lambda.im / TAU, lambda.re, -lambda.re / lambda.norm()].map(|number| number.to_string());
    scene.iter().cloned().chain([sample.to_string(), ModeLabel::candidates(names)]).chain(numbers).collect()
}

/// Writes `every_mode.csv` of the first `samples` samples of a study into `dir`: a row for each mode of each sample in each scene, those that are stable
/// too, with its names, frequency, growth rate and damping ratio. Each sample is drawn again and takes a whole spectrum in each scene. A sample
/// that fails has no row.
///
/// # Errors
/// A table that cannot be written; work that is cancelled.
pub fn write_every_mode<B: UncertainBrake>(
    study: &Study<'_, B>,
    samples: u64,
    dir: &Path,
    progress: &dyn Progress,
) -> Result<(), Error> {
    check_real(study.brake(), EVERY_MODE)?;
    let plan = study.plan();
    let mut table = LongTable::create(dir, "every_mode", &mode_columns())?;
    progress.begin(plan.scenes.len() as u64 * samples, 0);
    let blocks: Vec<u64> = (0..samples.div_ceil(BLOCK)).collect();
    for (scene, of_scene) in plan.scenes.iter().enumerate() {
        let place = plan.labels.scene_columns(of_scene);
        let of_block = |&block: &u64| -> Result<Vec<Vec<String>>, Error> {
            progress.go_on()?;
            let indices = block * BLOCK..((block + 1) * BLOCK).min(samples);
            let draw = |index: u64| Some((index, study.brake().draw(&mut stream(plan.seed, index)).ok()?));
            let drawn: Vec<(u64, B::Sample)> = indices.clone().filter_map(draw).collect();
            let all: Vec<&B::Sample> = drawn.iter().map(|(_, sample)| sample).collect();
            let modes = study.every_mode(scene, &all, &mut Scratch::default());
            progress.advance(indices.end - indices.start);
            let of_sample = |((index, _), modes): (&(u64, B::Sample), Result<Vec<SampledMode>, _>)| {
                let row = |SampledMode { names, lambda }: SampledMode| mode_row(&place, *index, &names, lambda);
                modes.into_iter().flatten().map(row).collect::<Vec<_>>()
            };
            Ok(drawn.iter().zip(modes).flat_map(of_sample).collect())
        };
        for some in blocks.chunks(BLOCKS_PER_THREAD * rayon::current_num_threads()) {
            let rows = some.par_iter().map(of_block).collect::<Result<Vec<_>, Error>>()?;
            table.write(rows.into_iter().flatten())?;
        }
    }
    progress.end();
    Ok(table.finish()?)
}
