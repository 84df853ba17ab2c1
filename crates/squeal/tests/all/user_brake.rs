//! A brake of a user's own type goes through the whole study, and work is told apart by the families that it names.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use std::path::Path;

use brakes::LatticeBrake;
use cea::BatchSolver;
use linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
use montecarlo::Distribution;
use montecarlo::{Experiment as _, StreamRng, stream};
use nalgebra::{DMatrix, dmatrix};
use osc_model::{Body, Brake};
use squeal::run_study;
use squeal::study::{Plan, Scene, Study, UncertainBrake};

/// The cells of a table under some of its columns, row by row.
fn columns(table: &Path, names: &[&str]) -> Vec<Vec<String>> {
    let mut table = csv::Reader::from_path(table).unwrap();
    let header = table.headers().unwrap().clone();
    let places: Vec<usize> = names.iter().map(|name| header.iter().position(|other| other == *name).unwrap()).collect();
    table.records().map(|row| places.iter().map(|&at| row.as_ref().unwrap()[at].to_owned()).collect()).collect()
}

/// A mass that slides along x and is pressed in z, after Hoffmann: friction couples its two modes.
struct SlidingMass {
    plan: Plan,
    mu: Distribution,
}

/// Of the dashpot in x and of that in z.
const DAMPING: f64 = 0.05;
/// Coefficient of friction at which the mass begins to flutter.
const ONSET: f64 = 0.75 * (1.0 + 2.0 * DAMPING * DAMPING);
const SAMPLES: u64 = 64;

impl SlidingMass {
    fn new() -> Self {
        let mass = DMatrix::identity(2, 2);
        let structure = SecondOrder::new(mass.clone(), DAMPING * mass, dmatrix![2.0, 1.0; 1.0, 2.0]).unwrap();
        let pad = Channel::new("pad", "friction", vec![(0, 1.0)], vec![(1, -4.0 / 3.0)]);
        let system = AffineSystem::new(vec![Term::new("mass", "dashpots", structure).unwrap()], vec![pad]).unwrap();
        let body = |name: &str, dof| Body { name: name.into(), dofs: vec![dof] };
        let brake = Brake { bodies: vec![body("x", 0), body("z", 1)], ..Brake::new(system) };
        // The median lies beyond the coalescence at 0.75, from below which no unstable mode would have a sure name.
        let mu = Distribution::Uniform { from: 0.6, to: 1.0 };
        Self { plan: Plan::single("sliding mass", brake, at(mu.median()), SAMPLES, 3), mu }
    }
}

fn at(mu: f64) -> OperatingPoint {
    OperatingPoint { coefficients: vec![1.0], channels: vec![ChannelGain::proportional(mu)] }
}

impl UncertainBrake for SlidingMass {
    type Sample = f64;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<f64, squeal::study::Error> {
        Ok(self.mu.draw(rng)?)
    }

    fn median(&self) -> f64 {
        self.mu.median()
    }

    fn operating_point(&self, _: &Scene, mu: &f64) -> Result<OperatingPoint, squeal::study::Error> {
        Ok(at(*mu))
    }
}

#[test]
fn a_users_own_brake_runs_from_draws_to_tables() {
    let brake = SlidingMass::new();
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("study");
    let manifest = run_study(&brake, &dir, None, &mut |_, _, _| Ok(())).unwrap();
    assert_eq!(manifest.failures, 0);

    let draws = (0..SAMPLES).map(|index| brake.draw(&mut stream(brake.plan.seed, index)).unwrap());
    let unstable = draws.filter(|&mu| mu > ONSET).count().to_string();
    let occurrence = columns(&dir.join("occurrence.csv"), &["in_contact", "arrangement", "samples", "unstable"]);
    let counts = |unstable: &str| ["1", "pad", &SAMPLES.to_string(), unstable].map(str::to_owned);
    assert!(unstable.parse::<u64>().is_ok_and(|count| count > 10 && count < SAMPLES - 10), "{unstable}");
    let fluttering: Vec<_> = occurrence.iter().filter(|row| row[3] != "0").collect();
    assert_eq!(fluttering, [&counts(&unstable)]);
    assert!(columns(&dir.join("failures.csv"), &["sample"]).is_empty());
    // It has no `parametrised()`, which is not to say that nothing changes the mode.
    let summary = std::fs::read_to_string(dir.join("summary.md")).unwrap();
    assert!(summary.contains(" 1/s: the brake names no parameters\n"), "{summary}");

    let mode = &columns(&dir.join("net_work.csv"), &["mode"])[0][0];
    let row = |family: &str, body: &str| [mode, family, body, &unstable].map(str::to_owned).to_vec();
    let families = columns(&dir.join("family_work.csv"), &["mode", "family", "body", "samples"]);
    let expected = [("friction", "x"), ("friction", "z"), ("dashpots", "x"), ("dashpots", "z")];
    assert_eq!(families, expected.map(|(family, body)| row(family, body)));
    let medians = columns(&dir.join("family_work.csv"), &["median"]);
    let medians: Vec<f64> = medians.iter().map(|row| row[0].parse().unwrap()).collect();
    // Friction acts on x alone, and feeds it.
    assert!(medians[0] > 0.0 && medians[1] == 0.0 && medians[2] < 0.0 && medians[3] < 0.0, "{medians:?}");
}

/// The same brake with all forces in one family.
fn in_one_family(brake: &Brake) -> Brake {
    let system = &brake.system;
    let term = |term: &Term| Term::new(&term.name, "all", term.matrices().clone()).unwrap();
    let channel = |channel: &Channel| Channel { family: "all".into(), ..channel.clone() };
    let terms = system.terms().iter().map(term).collect();
    let system = AffineSystem::new(terms, system.channels().iter().map(channel).collect()).unwrap();
    Brake { system, ..brake.clone() }
}

/// Compares the net work of two families with the work of one that has all forces, in single samples of every scene; both
/// are the same brake. Says how many modes there were.
fn compare<B: UncertainBrake>(apart: &B, together: &B, names: [&str; 2]) -> usize {
    let [apart, together] = [apart, together].map(|brake| Study::new(brake, &BatchSolver).unwrap());
    let mut modes = 0;
    for index in 0..20 {
        let sample = apart.draw(&mut stream(5, index)).unwrap();
        for scene in 0..apart.scenes() {
            let [apart, together] = [&apart, &together]
                .map(|study| study.evaluate(scene, &sample, &mut Default::default()).unwrap().unstable);
            assert_eq!(apart.len(), together.len());
            for (apart, together) in apart.iter().zip(&together) {
                assert_eq!((apart.rank, &apart.names), (together.rank, &together.names));
                let (Some(apart), Some(together)) = (&apart.work, &together.work) else { continue };
                assert!(apart.families.iter().map(|family| family.name.as_str()).eq(names));
                assert_eq!(together.families.len(), 1);
                let all = &together.families[0].bodies;
                let tolerance = 1e-12 * apart.magnitude;
                assert_eq!(apart.net().len(), all.len());
                for (body, (net, all)) in apart.net().iter().zip(all).enumerate() {
                    let sum = apart.families[0].bodies[body] + apart.families[1].bodies[body];
                    assert!((sum - all).abs() <= tolerance && (net - all).abs() <= tolerance, "{sum} {net} {all}");
                }
                // Every degree of freedom belongs to one body.
                assert!((apart.net().iter().sum::<f64>() - apart.total).abs() <= tolerance);
                modes += 1;
            }
        }
    }
    modes
}

#[test]
fn the_work_of_two_families_sums_to_the_net_work() {
    let (apart, mut together) = (SlidingMass::new(), SlidingMass::new());
    together.plan.configurations[0].brake = in_one_family(&together.plan.configurations[0].brake).into();
    let modes = compare(&apart, &together, ["friction", "dashpots"]);
    assert!(modes > 5, "{modes}");

    // Sectors, and bristles that follow friction into its family.
    let [apart, mut together] =
        [(); 2].map(|()| LatticeBrake::new(crate::common::case("two-by-two.toml", &[])).unwrap());
    for configuration in &mut together.plan.configurations {
        configuration.brake = in_one_family(&configuration.brake).into();
    }
    let modes = compare(&apart, &together, ["friction", "damping"]);
    assert!(modes > 50, "{modes}");
}
