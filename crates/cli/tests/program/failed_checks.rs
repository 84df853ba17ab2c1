//! A reduced brake that failed its checks against the whole one: every command that rests on samples of it says so first, and for machines too.

use std::path::Path;

use brakes::case::CaseFile;
use brakes::{AnyBrake, CaseBrake, Purpose};
use cea::Mode;
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::StreamRng;
use nalgebra::{Complex, DVector};
use serde_json::Value;
use squeal::study::{
    AnySample, BandMode, Bridge, CoarsePath, DrawnInputs, Error, FullChecks, ModeSource, Modifiable, Parametrised,
    Plan, Scene, UncertainBrake, WholeEigenvalue, is_untrusted,
};
use squeal_cli::{CaseArgs, DrawnSceneArgs, InfluenceArgs, MachineArgs, RareArgs, RunArgs, ScreenArgs};

/// Six oscillators, two of which flutter from a friction of some 0.35 on.
fn brake(folder: &Path, purpose: Purpose<'_>) -> AnyBrake {
    let dof = |at: usize| format!("{}, {}", 101 + at / 3, at % 3 + 1);
    let place = |name: &str, entries: Vec<(usize, usize, f64)>| {
        let lines = entries.iter().map(|(i, j, value)| format!("{}, {}, {value:e}\n", dof(*i), dof(*j)));
        std::fs::write(folder.join(name), lines.collect::<String>()).unwrap();
    };
    let diagonal = |of: &dyn Fn(usize) -> f64| (0..6).map(|i| (i, i, of(i))).collect::<Vec<_>>();
    place("m.mtx", diagonal(&|_| 1.0));
    place("c.mtx", diagonal(&|_| 2.0));
    let beside = (0..5).flat_map(|i| [(i, i + 1, -100.0), (i + 1, i, -100.0)]);
    place("k.mtx", diagonal(&|i| 1e5 * (1.0 + 0.06 * i as f64)).into_iter().chain(beside).collect());
    place("f.mtx", diagonal(&|_| 0.0).into_iter().chain([(0, 1, 1e4), (1, 0, -1e4)]).collect());
    let text = "[study]\nname = \"six\"\nsamples = 100\nseed = 1\n[brake]\nkind = \"finite-elements\"\n\
        [parameters.mu]\ndistribution = \"normal\"\nmean = 0.25\ndeviation = 0.04\n\
        [[terms]]\nname = \"all\"\nmass = \"m.mtx\"\ndamping = \"c.mtx\"\nstiffness = \"k.mtx\"\nsymmetry = \"whole\"\n\
        [[terms]]\nname = \"friction\"\ncoefficient = \"mu\"\nstiffness = \"f.mtx\"\nsymmetry = \"whole\"\n\
        [reduction]\nfrequencies = [20.0, 100.0]\ngrowth = [-200.0, 200.0]\nfull_checks = 2\n";
    brakes::make(CaseFile::parse(&folder.join("six.toml"), text.into()).unwrap(), purpose, &()).unwrap()
}

/// A brake with other results of its checks.
struct Checked {
    inner: AnyBrake,
    checks: FullChecks,
}

impl Checked {
    fn source(&self) -> &dyn ModeSource {
        self.inner.mode_source().unwrap()
    }
}

impl CaseBrake for Checked {}

impl UncertainBrake for Checked {
    type Sample = AnySample;

    fn plan(&self) -> &Plan {
        self.inner.plan()
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<AnySample, Error> {
        self.inner.draw(rng)
    }

    fn median(&self) -> AnySample {
        self.inner.median()
    }

    fn operating_point(&self, scene: &Scene, sample: &AnySample) -> Result<OperatingPoint, Error> {
        self.inner.operating_point(scene, sample)
    }

    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<AnySample>> {
        self.inner.drawn_inputs()
    }

    fn parametrised(&self) -> Option<&dyn Parametrised> {
        self.inner.parametrised()
    }

    fn modifiable(&self) -> Option<&dyn Modifiable> {
        self.inner.modifiable()
    }

    fn mode_source(&self) -> Option<&dyn ModeSource> {
        Some(self)
    }
}

impl ModeSource for Checked {
    fn band_modes(&self, scene: &Scene, at: &[OperatingPoint]) -> Vec<Result<Vec<BandMode>, Error>> {
        self.source().band_modes(scene, at)
    }

    fn has_dashpots_for_losses(&self, scene: &Scene) -> bool {
        self.source().has_dashpots_for_losses(scene)
    }

    fn band_modes_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<Vec<BandMode>, Error> {
        self.source().band_modes_with(scene, values)
    }

    fn band_modes_of_changed(
        &self,
        scene: &Scene,
        at: &OperatingPoint,
        changed: &SecondOrder,
    ) -> Result<Vec<BandMode>, Error> {
        self.source().band_modes_of_changed(scene, at, changed)
    }

    fn coarse(&self, scene: &Scene, at: [&OperatingPoint; 2]) -> Result<Option<CoarsePath<'_>>, Error> {
        self.source().coarse(scene, at)
    }

    fn bridge(&self, configuration: usize, modes: [&[Mode]; 2]) -> Result<Option<Bridge>, Error> {
        self.source().bridge(configuration, modes)
    }

    fn relative_error(&self, scene: &Scene) -> f64 {
        self.source().relative_error(scene)
    }

    fn unknown_error(&self, scene: &Scene) -> Option<&'static str> {
        self.source().unknown_error(scene)
    }

    fn whole_eigenvalue(
        &self,
        scene: &Scene,
        values: &[(usize, f64)],
        near: Complex<f64>,
    ) -> Result<WholeEigenvalue, Error> {
        self.source().whole_eigenvalue(scene, values, near)
    }

    fn eigenvalue_at_origin(&self, constraints: usize, lambda: Complex<f64>) -> Complex<f64> {
        self.source().eigenvalue_at_origin(constraints, lambda)
    }

    fn whole_shape(&self, constraints: usize, shape: &DVector<Complex<f64>>) -> Vec<(String, Complex<f64>)> {
        self.source().whole_shape(constraints, shape)
    }

    fn routes(&self) -> Vec<(&'static str, u64)> {
        self.source().routes()
    }

    fn full_checks(&self) -> Option<&FullChecks> {
        Some(&self.checks)
    }
}

/// Answers of the commands on a brake with these results of its checks: words and JSON of influence, rare, screen and run.
fn said(folder: &Path, checks: &FullChecks) -> Vec<(&'static str, String, Value)> {
    let of = |purpose| Checked { inner: brake(folder, purpose), checks: checks.clone() };
    let (study, screened) = (of(Purpose::Study), of(Purpose::Screen));
    assert_eq!([&study, &screened].map(is_untrusted), [checks.has_other_modes(); 2]);
    let (case, machine) = (CaseArgs { case: "six".into(), ..CaseArgs::default() }, MachineArgs::default());
    let drawn = DrawnSceneArgs { case: case.clone(), ..DrawnSceneArgs::default() };
    let words = [false, true].map(|json| {
        let influence = InfluenceArgs { drawn: drawn.clone(), samples: None, total: None, out: None, json };
        let drawn = drawn.clone();
        let rare = RareArgs { drawn, relative: 0.3, budget: 1_000, directions: 4, out: None, json };
        let screen = ScreenArgs {
            case: case.clone(),
            kinds: Some(vec!["scale".into()]),
            up_to: Some(1),
            json,
            machine,
            ..ScreenArgs::default()
        };
        let run = RunArgs {
            case: case.clone(),
            out: folder.join(format!("run-{}{}{}{json}", checks.missing, checks.invented, checks.other_verdicts)),
            samples: None,
            seed: None,
            half_width: None,
            until_half_width: None,
            keep_samples: false,
            cycles: None,
            every_mode: false,
            parquet: false,
            shard: None,
            from: 0,
            json,
            machine,
        };
        let mut text = Vec::new();
        let ended = run.run_brake(&study, None, &mut text);
        assert_eq!(ended.is_err(), checks.has_other_modes(), "{ended:?}");
        let run = String::from_utf8(text).unwrap();
        [influence.influence(&study).unwrap(), rare.rare(&study).unwrap(), screen.screen(&screened, &[]).unwrap(), run]
    });
    let [words, json] = words;
    let names = ["influence", "rare", "screen", "run"];
    names
        .into_iter()
        .zip(words)
        .zip(json.map(|text| serde_json::from_str(&text).unwrap()))
        .map(|((name, words), json)| (name, words, json))
        .collect()
}

#[test]
fn checks_that_failed_are_told_by_every_command_that_samples() {
    let folder = tempfile::tempdir().unwrap();
    for (missing, invented, other_verdicts) in [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)] {
        let checks = FullChecks { samples: 2, modes: 12, missing, invented, other_verdicts, ..FullChecks::default() };
        for (command, words, json) in said(folder.path(), &checks) {
            let is_failed = |text: &str| text.contains("The reduced brake FAILED its check: of 12 modes");
            assert_eq!(is_failed(&words), checks.has_other_modes(), "{command}: {words}");
            let key = if command == "run" { "doubts" } else { "warnings" };
            let told = json[key].as_array().unwrap().iter().any(|doubt| is_failed(doubt.as_str().unwrap()));
            assert_eq!(told, checks.has_other_modes(), "{command}: {json}");
            // Before any number.
            let first = words.lines().find(|line| line.starts_with("WARNING: "));
            assert!(!checks.has_other_modes() || first.is_some_and(is_failed), "{command}: {words}");
        }
    }
}
