//! Where the time of a study goes: some of its samples in all scenes, on one thread.
//!
//! A block is evaluated as the study does it, and then once more stage by stage and sector by sector through the public
//! function of each stage, without the samples that are certified stable; what the study takes beyond their sum is the
//! last row. It is negative where the study saves itself a part of a stage.

use std::time::Duration;

use cea::{BatchSolver, CeaError, EigenSolver, Mode, Modes, Spectrum, Verdict, Way, Workspace, identify_all, verdict};
use cpu_time::ThreadTime;
use num_complex::Complex;
use serde::Serialize;
use squeal::linsys::SecondOrder;
use squeal::montecarlo::{Runs, Study as _, Tally as _, stream};
use squeal::osc_model::{Linearise, Sector};
use squeal::study::{Plan, Reference, Sample, Scene, Scratch, Study, Tally};
use squeal::work::mode_work;

use super::error::BenchError;

/// Samples evaluated together, as in a run.
const BLOCK: u64 = 128;

/// One stage of a study.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// What is done.
    pub stage: &'static str,
    /// Processor time per sample solved, in all its sectors, microseconds.
    pub us: f64,
    /// Part of the whole time.
    pub share: f64,
}

#[derive(Default)]
struct Spent {
    solved: u64,
    drawing: Duration,
    evaluation: Duration,
    tally: Duration,
    assembly: Duration,
    spectra: Duration,
    verdicts: Duration,
    vectors: Duration,
    names: Duration,
    net_work: Duration,
}

fn timed<T>(into: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = ThreadTime::now();
    let result = work();
    *into += start.elapsed();
    result
}

/// The stages of the first block of the study.
///
/// # Errors
/// Those of the study.
pub fn stages(plan: &Plan) -> Result<Vec<Stage>, BenchError> {
    let study = Study::new(plan, &BatchSolver)?;
    let mut spent = Spent::default();
    evaluate(&study, &mut spent)?;
    let solved = spent.solved as f64;
    let whole = (spent.drawing + spent.evaluation + spent.tally).as_secs_f64();
    let stages = [
        ("drawing", spent.drawing),
        ("assembly", spent.assembly),
        ("spectra of the samples", spent.spectra),
        ("classification and verdicts", spent.verdicts),
        ("eigenvectors of unstable modes", spent.vectors),
        ("names, continuations included", spent.names),
        ("net work", spent.net_work),
        ("tally", spent.tally),
    ];
    let row = |(stage, seconds): (_, f64)| Stage { stage, us: 1e6 * seconds / solved, share: seconds / whole };
    let rest = whole - stages.iter().map(|(_, spent)| spent.as_secs_f64()).sum::<f64>();
    Ok(stages.into_iter().map(|(stage, spent)| (stage, spent.as_secs_f64())).chain([("rest", rest)]).map(row).collect())
}

/// One block in all scenes, as the study does it, and each scene once more by stages.
fn evaluate(study: &Study<'_>, spent: &mut Spent) -> Result<(), BenchError> {
    let seed = study.plan().case.seed;
    let draw = || -> Result<Vec<Sample>, squeal::Error> {
        (0..BLOCK).map(|index| study.draw(&mut stream(seed, index))).collect()
    };
    let samples = timed(&mut spent.drawing, draw)?;
    let borrowed: Vec<&Sample> = samples.iter().collect();
    let (mut scratch, mut replay) = (Scratch::default(), Replay::default());
    let mut out = Vec::new();
    let mut results: Vec<Vec<_>> = samples.iter().map(|_| Vec::new()).collect();
    for scene in 0..study.scenes() {
        timed(&mut spent.evaluation, || study.evaluate_block(scene, &borrowed, &mut scratch, &mut out));
        for (of_sample, result) in results.iter_mut().zip(out.drain(..)) {
            of_sample.push(result);
        }
        replay.scene(study, scene, &borrowed, spent)?;
    }
    let mut tally = Tally::empty(study.plan());
    timed(&mut spent.tally, || {
        for ((index, sample), results) in (0..).zip(&samples).zip(&results) {
            tally.record(&Runs { index, sample, results });
        }
    });
    Ok(())
}

/// The stages of one block in one scene.
#[derive(Default)]
struct Replay {
    /// Of each sector, those of the samples.
    systems: Vec<Vec<SecondOrder>>,
    spectra: Vec<Result<Spectrum, CeaError>>,
    work: Workspace,
}

impl Replay {
    fn scene(
        &mut self,
        study: &Study<'_>,
        at: usize,
        samples: &[&Sample],
        spent: &mut Spent,
    ) -> Result<(), BenchError> {
        let (plan, references) = (study.plan(), &study.sector_references()[at]);
        let scene = &plan.scenes[at];
        let (lattice, sectors) = (plan.lattice(scene), &plan.sectors[scene.lattice]);
        let certificate = &study.certificates()[scene.lattice];
        let mut open = Vec::with_capacity(samples.len());
        for &sample in samples {
            if !certificate.covers(&plan.sliding(scene, sample)?) {
                open.push(sample);
            }
        }
        spent.solved += open.len() as u64;
        self.systems.resize_with(references.len(), Vec::new);
        for of_sector in &mut self.systems {
            of_sector.resize_with(open.len(), || SecondOrder::zeros(1, 0));
        }
        let mut whole = SecondOrder::zeros(1, 0);
        let systems = &mut self.systems;
        timed(&mut spent.assembly, || {
            open.iter().enumerate().try_for_each(|(lane, sample)| -> Result<(), squeal::Error> {
                let of_lane = systems.iter_mut().map(|of_sector| &mut of_sector[lane]);
                Ok(sectors.linearise(lattice, &plan.sliding(scene, sample)?, &mut whole, of_lane)?)
            })
        })?;
        for (place, (sector, reference)) in sectors.iter().zip(references).enumerate() {
            let modes = self.sector(place, reference, spent)?;
            if scene.wants_work {
                timed(&mut spent.net_work, || {
                    let mut each = open.iter().zip(&modes);
                    each.try_for_each(|(sample, modes)| {
                        modes.iter().try_for_each(|mode| net_work(plan, scene, sector, sample, mode))
                    })
                })?;
            }
        }
        Ok(())
    }

    /// The unstable modes of one sector, named.
    fn sector(&mut self, place: usize, reference: &Reference, spent: &mut Spent) -> Result<Vec<Vec<Mode>>, BenchError> {
        let Self { systems, spectra, work } = self;
        let systems = &systems[place];
        timed(&mut spent.spectra, || BatchSolver.eigenvalues_of_all(systems, work, spectra));
        // A stage at a time for the whole block: reading the clock takes as long as some verdicts.
        let unstable: Vec<Vec<Complex<f64>>> = timed(&mut spent.verdicts, || {
            systems.iter().zip(&*spectra).map(|(system, found)| unstable(system, found, work)).collect::<Result<_, _>>()
        })?;
        let modes: Vec<Vec<Mode>> = timed(&mut spent.vectors, || {
            let of: Vec<_> = systems.iter().zip(&unstable).map(|(system, at)| (system, at.as_slice())).collect();
            Mode::of_all(&of, work).into_iter().collect::<Result<_, _>>()
        })?;
        let to = (&reference.system, &reference.modes[..]);
        timed(&mut spent.names, || {
            let each = systems.iter().zip(&modes);
            let ways: Vec<_> = each.map(|(system, modes)| Way { from: (system, modes), to, line: None }).collect();
            identify_all(&BatchSolver, &ways, work).into_iter().try_for_each(|links| links.map(drop))
        })?;
        Ok(modes)
    }
}

fn unstable(
    system: &SecondOrder,
    found: &Result<Spectrum, CeaError>,
    work: &mut Workspace,
) -> Result<Vec<Complex<f64>>, CeaError> {
    let spectrum = found.as_ref().map_err(Clone::clone)?;
    let mut unstable = Vec::new();
    for lambda in Modes::classify(system, spectrum, work)?.oscillatory {
        if verdict(system, lambda, spectrum.scale, work)? == Verdict::Unstable {
            unstable.push(lambda);
        }
    }
    Ok(unstable)
}

fn net_work(plan: &Plan, scene: &Scene, sector: &Sector, sample: &Sample, mode: &Mode) -> Result<(), squeal::Error> {
    let (lattice, shape) = (plan.lattice(scene), sector.expand(&mode.shape));
    let mut friction = SecondOrder::zeros(shape.len(), 0);
    lattice.linearise_friction(&plan.sliding(scene, sample)?, &mut friction)?;
    let work = mode_work(lattice.structural(), &friction, mode.lambda, &shape, lattice.bodies())?;
    std::hint::black_box(work.net());
    Ok(())
}
