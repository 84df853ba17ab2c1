//! A reduction of the disc brake of 4,669 degrees of freedom, over speed, damping and friction.
//!
//! Its matrices are not part of this repository: M, D1, DG, DR, D4, K1, KR, KGEO of BrakeSqueal 0.1 as Matrix Market files,
//! gzipped, in the folder that the environment variable names. docs/large-problems.md has what this prints.

use std::error::Error;
use std::f64::consts::PI;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use cpu_time::ThreadTime;
use flate2::read::GzDecoder;
use linsys::OperatingPoint;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use reduction::{Options, Reduced, Reduction, ResidualTally, Stage, Wanted};
use sparse::nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{Rectangle, SparseAffineSystem, SparseSecondOrder, SparseTerm};

const FOLDER: &str = "SQUEAL_DISK_BRAKE4669";
const RECTANGLE: Rectangle = Rectangle { re: [-50.0, 1000.0], im: [-50.0, 42_000.0] };

fn read(folder: &Path, name: &str) -> Result<CscMatrix<f64>, Box<dyn Error>> {
    let file = File::open(folder.join(format!("{name}.mtx.gz")))?;
    let mut lines = BufReader::new(GzDecoder::new(file)).lines();
    let header = lines.next().ok_or("an empty file")??;
    let mirrored = if header.contains("skew") { -1.0 } else { f64::from(u8::from(header.contains(" symmetric"))) };
    let mut matrix: Option<CooMatrix<f64>> = None;
    for line in lines {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        match (&mut matrix, &words[..]) {
            (_, [first, ..]) if first.starts_with('%') => {}
            (None, [rows, columns, _]) => matrix = Some(CooMatrix::new(rows.parse()?, columns.parse()?)),
            (Some(matrix), [row, column, value]) => {
                let (row, column, value) =
                    (row.parse::<usize>()? - 1, column.parse::<usize>()? - 1, value.parse::<f64>()?);
                matrix.push(row, column, value);
                if row != column && mirrored != 0.0 {
                    matrix.push(column, row, mirrored * value);
                }
            }
            _ => return Err(format!("a line of {name} that is no entry: {line}").into()),
        }
    }
    Ok(CscMatrix::from(&matrix.ok_or("no size")?))
}

fn brake(folder: &Path) -> Result<SparseAffineSystem, Box<dyn Error>> {
    let zero = || CscMatrix::zeros(4669, 4669);
    let term = |name: &str, m, c, k| -> Result<SparseTerm, Box<dyn Error>> {
        Ok(SparseTerm { name: name.into(), family: name.into(), matrices: SparseSecondOrder::new(m, c, k)? })
    };
    let of = |name: &str| read(folder, name);
    let terms = vec![
        term("structure", of("M")?, zero(), of("K1")?)?,
        term("friction damping", zero(), of("D1")?, zero())?,
        term("gyroscopic", zero(), of("DG")?, zero())?,
        term("friction damping over speed", zero(), of("DR")?, zero())?,
        term("material damping", zero(), of("D4")?, zero())?,
        term("circulatory", zero(), zero(), of("KR")?)?,
        term("geometric", zero(), zero(), of("KGEO")?)?,
    ];
    Ok(SparseAffineSystem::new(terms, Vec::new())?)
}

/// C = f (D1 + DR (1/w - 1)) + DG w + d D4 / (2 pi 1600), K = K1 + f KR + KGEO (w^2 - 1), with factors f on what friction makes
/// and d on the material's damping, both 1 in the published brake.
fn point(w: f64, damping: f64, friction: f64) -> OperatingPoint {
    let coefficients =
        vec![1.0, friction, w, friction * (1.0 / w - 1.0), damping / (2.0 * PI * 1600.0), friction, w * w - 1.0];
    OperatingPoint { coefficients, channels: Vec::new() }
}

/// Speeds from 2 pi to 8 pi, and both factors from 1 - `spread` to 1 + `spread`.
fn draws(seed: u64, count: usize, spread: f64) -> Vec<OperatingPoint> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut factor = |spread: f64| 1.0 + spread * (2.0 * rng.random::<f64>() - 1.0);
    (0..count).map(|_| point(5.0 * PI * factor(0.6), factor(spread), factor(spread))).collect()
}

fn header() {
    println!("columns points factorisations missed above largest_residual spectra ms");
}

fn print(stage: &Stage) {
    let Stage { columns, points, factorisations, missed, above, largest_residual, spectra, .. } = stage;
    let ms = stage.seconds * 1e3;
    println!("{columns} {points} {factorisations} {missed} {above} {largest_residual:.1e} {spectra} {ms:.2}");
}

/// Builds, prints the stages, and runs `samples` draws; the reduction with its tally.
fn study(
    name: &str,
    system: &SparseAffineSystem,
    spread: f64,
    samples: usize,
    options: &Options,
) -> Result<Reduction, Box<dyn Error>> {
    let points: Vec<_> = [2.0, 4.0, 6.0, 8.0].map(|w| point(w * PI, 1.0, 1.0)).into();
    let training = draws(1, 100, spread);
    let start = ThreadTime::now();
    let mut reduction =
        Reduction::build(system, &Wanted { rectangle: RECTANGLE, points: &points, training: &training }, options)?;
    reduction.reduced = reduction.reduced.with_coarse(&training)?;
    let (report, reduced) = (&reduction.report, &reduction.reduced);
    println!("{name}: built in {:.1} s, {} full problems", start.elapsed().as_secs_f64(), report.full_problems);
    header();
    report.stages.iter().for_each(print);
    report.missed.iter().for_each(|missed| println!("missed {} at training point {}", missed.lambda, missed.training));
    println!(
        "reached: {}, rank of residuals {}, {:?} coarse columns",
        report.is_reached,
        reduced.residual_rank(),
        reduced.coarse_columns()
    );
    let mut tally = ResidualTally::new(options.tolerance);
    let start = ThreadTime::now();
    for (at, sample) in (0..).zip(&draws(2, samples, spread)) {
        tally.record(at, &reduced.modes(sample)?);
    }
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{samples} samples: {seconds:.1} s of one core, {:.2} ms each; {} modes, {} above {:.0e}, largest {:?}, {} by spectrum",
        seconds * 1e3 / samples as f64,
        tally.modes,
        tally.above,
        options.tolerance,
        tally.largest,
        tally.spectra
    );
    Ok(reduction)
}

/// The largest distance of eigenvalues from coarse ones from those of whole spectra, and how many samples differ in number.
fn compare(reduced: &Reduced, samples: &[OperatingPoint]) -> Result<(f64, usize), Box<dyn Error>> {
    let (mut largest, mut differing) = (0.0_f64, 0);
    for sample in samples {
        let (found, all) = (reduced.modes(sample)?, reduced.modes_by_spectrum(sample)?);
        differing += usize::from(found.lambdas.len() != all.lambdas.len());
        for lambda in &found.lambdas {
            let nearest = all.lambdas.iter().map(|other| (other - lambda).norm()).fold(f64::INFINITY, f64::min);
            largest = largest.max(nearest / lambda.norm());
        }
    }
    Ok((largest, differing))
}

#[test]
#[ignore = "needs the matrices of disk_brake4669 and minutes"]
fn the_disc_brake_over_speed_damping_and_friction() -> Result<(), Box<dyn Error>> {
    let Ok(folder) = std::env::var(FOLDER) else { return Err(format!("{FOLDER} names no folder").into()) };
    let system = brake(Path::new(&folder))?;
    let samples = std::env::var("SAMPLES").map_or(Ok(10_000), |text| text.parse())?;
    for (name, spread, tolerance) in [("speed alone", 0.0, 1e-8), ("speed, damping, friction", 0.2, 1e-8)] {
        let options = Options { tolerance, ..Options::default() };
        let reduction = study(name, &system, spread, samples, &options)?;
        let (distance, differing) = compare(&reduction.reduced, &draws(3, 200, spread))?;
        println!("200 whole spectra: largest relative distance {distance:.1e}, {differing} of another number of modes");
        assert!(reduction.report.is_reached);
        assert_eq!(differing, 0);
        assert!(distance < 1e-6);
    }
    Ok(())
}
