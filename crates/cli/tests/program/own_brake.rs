//! A kind of brake that no case file knows, a beam on a belt under two friction laws, goes through every command of the program. Its
//! numbers are those of matrices assembled anew with NumPy and SciPy.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use brakes::CaseBrake;
use cea::BatchSolver;
use friction::{
    BristleDamping, FrictionLaw, LuGre, LuGreParameters, Tangent, VelocityDependent, VelocityDependentParameters,
};
use linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
use montecarlo::Distribution;
use nalgebra::DMatrix;
use osc_model::{Body, Brake, ContactPoint};
use serde_json::Value;
use squeal::results::Results;
use squeal::run_study;
use squeal::study::{Drawn, IndependentBrake, Scene, Study};
use squeal::sweep::Over;
use squeal_cli::{
    CaseArgs, CeaArgs, CheckArgs, DrawnSceneArgs, InfluenceArgs, MachineArgs, RareArgs, RunArgs, SceneArgs, ScreenArgs,
    SweepArgs,
};

/// Elements of the beam, which is 0.4 m long, 30 mm wide and 10 mm high, and its length for each.
const ELEMENTS: usize = 10;
const LENGTH: f64 = 0.04;
/// Nodes with a pad.
const PADS: [usize; 3] = [2, 5, 7];
/// Sliding speed, m/s, and the load of a pad, N.
const SPEED: f64 = 1.0;
const LOAD: f64 = 800.0;

/// The free degree of freedom of the deflection or the rotation of a node; both ends are held in deflection.
fn dof(node: usize, is_rotation: bool) -> Option<usize> {
    let last = 2 * ELEMENTS;
    match 2 * node + usize::from(is_rotation) {
        0 => None,
        at if at == last => None,
        at => Some(if at < last { at - 1 } else { at - 2 }),
    }
}

/// The matrices of an Euler-Bernoulli beam: mass and stiffness.
fn beam() -> [DMatrix<f64>; 2] {
    let l = LENGTH;
    let (bending, mass) = (2.1e11 * 0.03 * 0.01_f64.powi(3) / 12.0, 7850.0 * 0.03 * 0.01);
    let stiffness = [
        [12.0, 6.0 * l, -12.0, 6.0 * l],
        [6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l],
        [-12.0, -6.0 * l, 12.0, -6.0 * l],
        [6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l],
    ];
    let inertia = [
        [156.0, 22.0 * l, 54.0, -13.0 * l],
        [22.0 * l, 4.0 * l * l, 13.0 * l, -3.0 * l * l],
        [54.0, 13.0 * l, 156.0, -22.0 * l],
        [-13.0 * l, -3.0 * l * l, -22.0 * l, 4.0 * l * l],
    ];
    let [mut m, mut k] = [(); 2].map(|()| DMatrix::zeros(2 * ELEMENTS, 2 * ELEMENTS));
    for element in 0..ELEMENTS {
        let dofs = [(element, false), (element, true), (element + 1, false), (element + 1, true)];
        let dofs = dofs.map(|(node, is_rotation)| dof(node, is_rotation));
        for (i, row) in dofs.iter().enumerate().filter_map(|(i, row)| Some((i, (*row)?))) {
            for (j, column) in dofs.iter().enumerate().filter_map(|(j, column)| Some((j, (*column)?))) {
                k[(row, column)] += stiffness[i][j] * bending / l.powi(3);
                m[(row, column)] += inertia[i][j] * mass * l / 420.0;
            }
        }
    }
    [m, k]
}

/// The brake: friction at half the height of the beam turns its sections by the force that presses on them.
fn brake() -> Brake {
    let [m, k] = beam();
    let zero = DMatrix::zeros(m.nrows(), m.nrows());
    let mut contact = zero.clone();
    let mut channels = Vec::new();
    for (node, number) in PADS.into_iter().zip(1..) {
        let (deflection, rotation) = (dof(node, false).unwrap(), dof(node, true).unwrap());
        contact[(deflection, deflection)] = 1.0;
        channels.push(Channel::new(
            format!("pad{number}"),
            "friction",
            vec![(rotation, 0.02)],
            vec![(deflection, 1.0)],
        ));
    }
    let term = |name: &str, m, c, k| Term::new(name, name, SecondOrder::new(m, c, k).unwrap()).unwrap();
    let terms = vec![
        term("beam", m, zero.clone(), k.clone()),
        term("material damping", zero.clone(), k, zero.clone()),
        term("contact springs", zero.clone(), zero, contact),
    ];
    let half = |from: usize, to: usize| (from..=to).flat_map(|node| [dof(node, false), dof(node, true)]).flatten();
    let body = |name: &str, from, to| Body { name: name.into(), dofs: half(from, to).collect() };
    let bodies = vec![body("left", 0, 5), body("right", 6, ELEMENTS)];
    Brake { bodies, ..Brake::new(AffineSystem::new(terms, channels).unwrap()) }
}

fn tangent(law: usize, mu: f64) -> Result<Tangent, friction::FrictionError> {
    match law {
        0 => VelocityDependent::new(VelocityDependentParameters { mu_s: 1.3 * mu, mu_k: mu, alpha: 1.5 })?
            .tangent_at(SPEED),
        _ => LuGre::new(LuGreParameters {
            mu_s: 1.3 * mu,
            mu_k: mu,
            v_s: 0.7,
            sigma0: 2e4,
            sigma1: 1.0,
            sigma2: 0.01,
            bristle_damping: BristleDamping::Constant,
        })?
        .tangent_at(SPEED),
    }
}

fn at(law: usize, values: &[f64]) -> Result<OperatingPoint, squeal::study::Error> {
    let [mu, stiffness, damping] = [values[0], values[1], values[2]];
    let contact = ContactPoint { tangent: tangent(law, mu)?, lateral_mu: 0.0, normal_load: LOAD };
    // Friction reads a deflection, and the force is the stiffness times that.
    let gain = contact.gain();
    let gain = ChannelGain { mu: gain.mu * stiffness, ..gain };
    Ok(OperatingPoint { coefficients: vec![1.0, damping, stiffness], channels: vec![gain; PADS.len()] })
}

/// Names and titles of the laws.
const LAWS: [(&str, &str); 2] = [("vd", "velocity dependent"), ("lugre", "LuGre")];

/// The beam under some of the laws, with what is drawn: all that a user writes beside the equations.
fn on_a_belt(laws: &'static [usize]) -> impl CaseBrake<Sample = Vec<f64>> {
    let drawn = vec![
        Drawn::new("mu", "1", Distribution::Uniform { from: 0.1, to: 0.9 }),
        Drawn::new("kc", "N/m", Distribution::LogUniform { from: 2e5, to: 3e6 }),
        Drawn::new("beta", "s", Distribution::LogNormal { median: 2e-6, sigma: 0.5, at_least: None, at_most: None }),
    ];
    let of_laws: Vec<_> = laws.iter().map(|&law| LAWS[law]).collect();
    let at = |scene: &Scene, values: &[f64]| at(laws[scene.key.law], values);
    IndependentBrake::new("beam on a belt", brake(), drawn, at)
        .unwrap()
        .with_laws(&of_laws)
        .unwrap()
        .with_samples(400, 1)
}

#[test]
fn a_brake_of_ones_own_goes_through_every_command() {
    let dir = tempfile::tempdir().unwrap();
    let case = CaseArgs { case: "a beam".into(), ..CaseArgs::default() };
    let machine = MachineArgs::default();
    let memory = machine.memory;
    let folder = |name: &str| Some(dir.path().join(name));
    for (laws, lambda, onset, occurrence) in [
        (&[0_usize][..], [0.249_768_841, 2_028.555_704_466], 0.389_936_904_961, 0.5806),
        (&[1], [0.685_639_323, 2_028.631_153_584], 0.308_915_760_143, 0.6940),
    ] {
        let (brake, name) = (on_a_belt(laws), LAWS[laws[0]].0);
        let scene = SceneArgs::default();
        let cea = CeaArgs { case: case.clone(), scene: scene.clone(), modes: true, why: true, json: true, memory };
        let found: Value = serde_json::from_str(&cea.analysis(&brake).unwrap()).unwrap();
        assert_eq!(found["scene"]["law"], name);
        let grows = found["modes"].as_array().unwrap().iter().find(|mode| mode["verdict"] == "unstable").unwrap();
        for (key, expected) in ["re", "im"].into_iter().zip(lambda) {
            assert!((grows[key].as_f64().unwrap() - expected).abs() < 1e-8, "{grows}");
        }
        let influences = grows["why"]["influences"].as_array().unwrap();
        assert!(influences.iter().any(|influence| influence["name"] == "kc"));

        let over = vec![Over { name: "mu".into(), from: 0.05, to: 1.2 }];
        let out = folder(&format!("sweep-{name}"));
        let sweep =
            SweepArgs { case: case.clone(), over, scene: scene.clone(), out, growth: None, json: true, machine };
        let found: Value = serde_json::from_str(&sweep.sweep(&brake).unwrap()).unwrap();
        let at = found["onsets"][0]["at"].as_f64().unwrap();
        assert!((at - onset).abs() < 1e-9, "{at} {onset}");

        // 100,000 draws of another program have the occurrence.
        let study = Study::new(&brake, &BatchSolver).unwrap();
        let results = Results::sampled(&study).unwrap();
        let [first] = results.panels() else { unreachable!("one panel") };
        let found = results.any_occurrence(first)[0].estimate();
        assert!((found.value - occurrence).abs() < 0.06 && found.lower < found.value, "{found:?} {occurrence}");
    }

    let both = on_a_belt(&[0, 1]);
    let run = RunArgs {
        case: case.clone(),
        out: dir.path().join("run"),
        samples: None,
        seed: None,
        half_width: Some(0.05),
        until_half_width: None,
        keep_samples: true,
        cycles: None,
        every_mode: false,
        parquet: false,
        shard: None,
        from: 0,
        json: false,
        machine,
    };
    let mut said = Vec::new();
    run.run_brake(&both, Some(0.05), &mut said).unwrap();
    let said = String::from_utf8(said).unwrap();
    assert!(said.contains("800 CEAs") && said.contains("0 failures"), "{said}");
    for file in ["occurrence.csv", "influence.csv", "estimates.csv", "samples.csv", "report.html"] {
        assert!(dir.path().join("run").join(file).is_file(), "{file}");
    }
    let screen =
        ScreenArgs { case: case.clone(), up_to: Some(1), out: folder("screen"), machine, ..ScreenArgs::default() };
    assert!(screen.screen(&both, &[]).unwrap().contains("pad"));
    let drawn = DrawnSceneArgs { case: case.clone(), ..DrawnSceneArgs::default() };
    let influence = InfluenceArgs { drawn: drawn.clone(), samples: None, total: Some(100), out: None, json: false };
    let said = influence.influence(&both).unwrap();
    assert!(["mu", "kc", "beta"].iter().all(|name| said.contains(name)), "{said}");
    let rare = RareArgs { drawn, relative: 0.2, budget: 1_000, directions: 8, out: folder("rare"), json: false };
    // More than half of the draws squeal.
    let refused = rare.rare(&both).unwrap_err().to_string();
    assert!(refused.contains("is unstable with all inputs at their medians"), "{refused}");
    let check = CheckArgs { case, samples: None, shards: Some(4), out: None, json: false, memory };
    let said = check.check(&both).unwrap();
    assert!(said.contains("pad1 (friction)") && said.contains("vd, lugre") && said.contains("4: each"), "{said}");
}

/// The folder of a study is not continued by another distribution about the same median.
#[test]
fn another_distribution_is_another_study() {
    let dir = tempfile::tempdir().unwrap();
    let drawn = |from, to| vec![Drawn::new("c", "1", Distribution::Uniform { from, to })];
    let of = |value| DMatrix::from_element(1, 1, value);
    let brake = |from, to| {
        let term = Term::new("mass", "mass", SecondOrder::new(of(1.0), of(0.0), of(1.0)).unwrap()).unwrap();
        let dashpot = Term::new("dashpot", "dashpot", SecondOrder::new(of(0.0), of(1.0), of(0.0)).unwrap()).unwrap();
        let brake = Brake::new(AffineSystem::new(vec![term, dashpot], Vec::new()).unwrap());
        let at = |_: &Scene, c: &[f64]| Ok(OperatingPoint { coefficients: vec![1.0, c[0]], channels: Vec::new() });
        IndependentBrake::new("mass", brake, drawn(from, to), at).unwrap().with_samples(64, 1)
    };
    let run = |from, to| run_study(&brake(from, to), dir.path(), None, &mut |_, _, _| Ok(()));
    run(-0.1, 0.1).unwrap();
    let refused = run(-0.2, 0.2).unwrap_err().to_string();
    assert!(refused.contains("other parameters") && refused.contains("allowed: a new or empty folder"), "{refused}");
}
