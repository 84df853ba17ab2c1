//! Brakes of a user's own type that forget or contradict something are refused when a study is made, each by its fault.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.
#![allow(clippy::type_complexity)] // Tables of faults, each a function in the place of the right one.

use std::path::Path;
use std::sync::Arc;

use brakes::case::CaseFile;
use brakes::{LatticeBrake, MatricesBrake};
use cea::{BatchSolver, CeaError, EigenSolver, QrSolver, Spectrum, Workspace};
use linsys::{AffineSystem, Channel, ChannelGain, DofMap, OperatingPoint, SecondOrder, Term};
use montecarlo::{Distribution, StreamRng};
use nalgebra::dmatrix;
use num_complex::Complex;
use osc_model::{Body, Brake};
use squeal::results::Results;
use squeal::study::{
    Contradiction, DrawnInputs, Input, LawLabel, NamedParameter, Parametrised, Plan, Scene, SingleParameter, Study,
    UncertainBrake, check,
};

/// What is drawn: a coefficient of friction, a stiffness and a dashpot.
type Sample = [f64; 3];
/// Names and units of these.
const DRAWN: [(&str, &str); 3] = [("mu", "1"), ("k", "N/m"), ("c", "Ns/m")];

/// What the brake does wrong, where it does: each a function in the place of the right one.
#[derive(Clone)]
struct Faults {
    median: fn(&Sample) -> Sample,
    inputs: fn(Vec<Input>) -> Vec<Input>,
    input_values: fn(&Sample) -> Vec<f64>,
    draws_inputs: bool,
    quantile_sample: fn(&[Distribution; 3], &dyn Fn(u32) -> f64) -> Sample,
    parameters: fn(Vec<NamedParameter>) -> Vec<NamedParameter>,
    with: fn(&Sample, &[(usize, f64)]) -> Sample,
    is_single: bool,
    with_parameter: fn(&Sample, f64) -> Sample,
}

fn right_with(median: &Sample, values: &[(usize, f64)]) -> Sample {
    let mut sample = *median;
    values.iter().for_each(|&(place, value)| sample[place] = value);
    sample
}

impl Faults {
    fn none() -> Self {
        Self {
            median: |median| *median,
            inputs: |inputs| inputs,
            input_values: |sample| sample.to_vec(),
            draws_inputs: true,
            quantile_sample: |drawn, u| [0, 1, 2].map(|d| drawn[d as usize].quantile(u(d))),
            parameters: |parameters| parameters,
            with: right_with,
            is_single: false,
            with_parameter: |median, mu| [mu, median[1], median[2]],
        }
    }
}

/// A mass that slides in x and is pressed in z, under two laws: the second has a falling coefficient.
struct Slider {
    plan: Plan,
    drawn: [Distribution; 3],
    faults: Faults,
}

fn at(law: usize, &[mu, k, c]: &Sample) -> OperatingPoint {
    let friction = ChannelGain { mu: mu * k, slope: -0.01 * law as f64, lag: None };
    OperatingPoint { coefficients: vec![1.0, k, c], channels: vec![friction] }
}

impl Slider {
    fn new(drawn: [Distribution; 3]) -> Self {
        let (zero, one) = (dmatrix![0.0, 0.0; 0.0, 0.0], dmatrix![1.0, 0.0; 0.0, 1.0]);
        let term = |name: &str, m, c, k| Term::new(name, name, SecondOrder::new(m, c, k).unwrap()).unwrap();
        let terms = vec![
            term("mass and springs", one.clone(), zero.clone(), dmatrix![2.0, 1.0; 1.0, 1.0]),
            term("contact", zero.clone(), zero.clone(), dmatrix![0.0, 0.0; 0.0, 1.0]),
            term("dashpots", zero.clone(), one, zero),
        ];
        let pad = Channel::new("pad", "friction", vec![(0, 1.0)], vec![(1, -1.0)]);
        let bodies = ["x", "z"].into_iter().zip(0..).map(|(name, dof)| Body { name: name.into(), dofs: vec![dof] });
        let brake = Brake { bodies: bodies.collect(), ..Brake::new(AffineSystem::new(terms, vec![pad]).unwrap()) };
        let median = [0, 1, 2].map(|d: usize| drawn[d].median());
        let mut plan = Plan::single("slider", brake, at(0, &median), 200, 1);
        let law = |name: &str| LawLabel { name: name.into(), title: name.into() };
        plan.labels.laws = vec![law("constant"), law("falling")];
        let mut second = plan.scenes[0].clone();
        second.key.law = 1;
        plan.scenes.push(second);
        Self { plan, drawn, faults: Faults::none() }
    }

    fn right() -> Self {
        Self::new([
            Distribution::Uniform { from: 0.1, to: 1.3 },
            Distribution::LogUniform { from: 0.5, to: 2.0 },
            Distribution::Uniform { from: 0.01, to: 0.03 },
        ])
    }

    /// A brake in which friction alone is drawn.
    fn of_friction() -> Self {
        let constant = |value| Distribution::Constant { value };
        let mut slider = Self::new([Distribution::Uniform { from: 0.1, to: 1.3 }, constant(1.0), constant(0.02)]);
        slider.faults.is_single = true;
        slider.faults.inputs = |mut inputs| {
            inputs.truncate(1);
            inputs
        };
        slider.faults.input_values = |sample| vec![sample[0]];
        slider
    }
}

impl UncertainBrake for Slider {
    type Sample = Sample;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<Sample, squeal::study::Error> {
        Ok([self.drawn[0].draw(rng)?, self.drawn[1].draw(rng)?, self.drawn[2].draw(rng)?])
    }

    fn median(&self) -> Sample {
        (self.faults.median)(&[0, 1, 2].map(|d: usize| self.drawn[d].median()))
    }

    fn operating_point(&self, scene: &Scene, sample: &Sample) -> Result<OperatingPoint, squeal::study::Error> {
        Ok(at(scene.key.law, sample))
    }

    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<Sample>> {
        self.faults.draws_inputs.then_some(self as _)
    }

    fn parametrised(&self) -> Option<&dyn Parametrised> {
        Some(self)
    }
}

impl DrawnInputs<Sample> for Slider {
    fn quantile_sample(&self, _: &Scene, uniform: &dyn Fn(u32) -> f64) -> Sample {
        (self.faults.quantile_sample)(&self.drawn, uniform)
    }

    fn inputs(&self, _: &Scene) -> Vec<Input> {
        let input = |((name, unit), coordinate): (&(&str, &str), u32)| Input {
            name: (*name).into(),
            unit: (*unit).into(),
            coordinate,
            is_correlated: false,
            has_atoms: false,
            jumps: false,
        };
        (self.faults.inputs)(DRAWN.iter().zip(0..).map(input).collect())
    }

    fn input_values(&self, _: &Scene, sample: &Sample) -> Vec<f64> {
        (self.faults.input_values)(sample)
    }

    fn single_parameter(&self, _: &Scene) -> Option<SingleParameter<'_, Sample>> {
        let with = |value| (self.faults.with_parameter)(&self.median(), value);
        self.faults.is_single.then(|| SingleParameter::new(&self.drawn[0], with))
    }
}

impl Parametrised for Slider {
    fn parameters(&self, _: &Scene) -> Vec<NamedParameter> {
        let named = |((name, unit), median): (&(&str, &str), f64)| NamedParameter {
            name: (*name).into(),
            unit: (*unit).into(),
            median,
        };
        let median = [0, 1, 2].map(|d: usize| self.drawn[d].median());
        (self.faults.parameters)(DRAWN.iter().zip(median).map(named).collect())
    }

    fn system_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, squeal::study::Error> {
        self.system(scene, &(self.faults.with)(&self.median(), values))
    }

    fn contact_points(&self, _: &Scene) -> Vec<String> {
        Vec::new()
    }

    fn closed_points(&self, _: &Scene, _: &[(usize, f64)]) -> Result<Vec<bool>, study::Error> {
        Ok(Vec::new())
    }
}

/// The fault that a study of a brake is refused for; `None` where it is made.
fn fault<B: UncertainBrake>(brake: &B) -> Option<Contradiction> {
    match (check(brake), Study::new(brake, &BatchSolver).map(drop)) {
        (Ok(()), Ok(())) => None,
        (Err(study::Error::Contradiction(a)), Err(study::Error::Contradiction(b))) => {
            // Numbers may be none, which is equal to nothing.
            assert_eq!(a.to_string(), b.to_string());
            assert!(!a.to_string().contains('\n'));
            Some(a)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_right_brake_is_studied() {
    for brake in [Slider::right(), Slider::of_friction()] {
        assert_eq!(fault(&brake), None);
    }
    // What is not given at all is no contradiction.
    let faults: [fn(&mut Faults); 4] = [
        |faults| {
            faults.inputs = |_| Vec::new();
            faults.input_values = |_| Vec::new();
        },
        |faults| faults.draws_inputs = false,
        |faults| faults.parameters = |_| Vec::new(),
        |faults| faults.is_single = false,
    ];
    for forget in faults {
        let mut brake = Slider::right();
        forget(&mut brake.faults);
        assert_eq!(fault(&brake), None);
    }
}

#[test]
fn what_a_brake_forgets_or_contradicts_is_refused_by_name() {
    type Expected = fn(&Contradiction) -> bool;
    use Contradiction as C;
    let faults: [(&str, fn(&mut Faults), Expected); 19] = [
        (
            "no values of inputs",
            |f| f.input_values = |_| Vec::new(),
            |c| matches!(c, C::InputValues { inputs: 3, values: 0, .. }),
        ),
        ("too few values", |f| f.input_values = |s| s[..1].to_vec(), |c| matches!(c, C::InputValues { values: 1, .. })),
        (
            "too many values",
            |f| f.input_values = |s| [&s[..], &[1.0]].concat(),
            |c| matches!(c, C::InputValues { values: 4, .. }),
        ),
        ("no inputs", |f| f.inputs = |_| Vec::new(), |c| matches!(c, C::InputValues { inputs: 0, .. })),
        (
            "an input of another coordinate",
            |f| {
                f.inputs = |mut inputs| {
                    inputs[1].coordinate = 7;
                    inputs
                }
            },
            |c| matches!(c, C::IdleCoordinate { coordinate: 7, .. }),
        ),
        (
            "values in another order",
            |f| f.input_values = |s| vec![s[1], s[0], s[2]],
            |c| matches!(c, C::IdleCoordinate { .. } | C::SharedCoordinate { .. } | C::Differ { .. }),
        ),
        (
            "an input that depends on another in secret",
            |f| {
                f.quantile_sample =
                    |d, u| [d[0].quantile(u(0)), d[1].quantile((u(1) + u(0)) / 2.0), d[2].quantile(u(2))]
            },
            |c| matches!(c, C::SharedCoordinate { .. }),
        ),
        (
            "quantiles of another distribution",
            |f| f.quantile_sample = |d, u| [0.9 * d[0].quantile(u(0)), d[1].quantile(u(1)), d[2].quantile(u(2))],
            |c| matches!(c, C::Differ { .. }),
        ),
        ("another median of friction", |f| f.median = |m| [0.3 * m[0], m[1], m[2]], |c| matches!(c, C::Medians { .. })),
        (
            "another median of the structure",
            |f| f.median = |m| [m[0], m[1], 3.0 * m[2]],
            |c| matches!(c, C::Medians { .. }),
        ),
        ("values not used", |f| f.with = |m, _| *m, |c| matches!(c, C::Differ { .. })),
        (
            "values not used, nothing drawn by quantiles",
            |f| {
                f.with = |m, _| *m;
                f.draws_inputs = false;
            },
            |c| matches!(c, C::IdleParameter { .. }),
        ),
        (
            "one value not used, nothing drawn by quantiles",
            |f| {
                f.with = |m, v| right_with(m, &v.iter().copied().filter(|v| v.0 != 2).collect::<Vec<_>>());
                f.draws_inputs = false;
            },
            |c| matches!(c, C::IdleParameter { parameter, .. } if parameter == "c"),
        ),
        (
            "the first value alone",
            |f| f.with = |m, v| right_with(m, &v[..v.len().min(1)]),
            |c| matches!(c, C::LostValues { .. }),
        ),
        (
            "the last value alone",
            |f| f.with = |m, v| right_with(m, &v[v.len().saturating_sub(1)..]),
            |c| matches!(c, C::LostValues { .. }),
        ),
        (
            "places exchanged",
            |f| f.with = |m, v| right_with(m, &v.iter().map(|&(p, x)| (2 - p, x)).collect::<Vec<_>>()),
            |c| matches!(c, C::Differ { .. }),
        ),
        (
            "another system without values",
            |f| f.with = |m, v| if v.is_empty() { [0.0, m[1], m[2]] } else { right_with(m, v) },
            |c| matches!(c, C::Differ { .. }),
        ),
        (
            "another median of a parameter",
            |f| {
                f.parameters = |mut parameters| {
                    parameters[1].median *= 1.01;
                    parameters
                }
            },
            |c| matches!(c, C::Differ { .. }),
        ),
        ("one parameter, where three are drawn", |f| f.is_single = true, |c| matches!(c, C::NotSingle { .. })),
    ];
    for (name, spoil, is_expected) in faults {
        let mut brake = Slider::right();
        spoil(&mut brake.faults);
        let found = fault(&brake);
        assert!(found.as_ref().is_some_and(is_expected), "{name}: {found:?}");
    }
}

#[test]
fn the_one_parameter_of_a_scene_is_the_one() {
    use Contradiction as C;
    let mut constant = Slider::of_friction();
    constant.faults.with_parameter = |median, _| *median;
    assert!(matches!(fault(&constant), Some(C::NotSingle { .. })));
    let mut other = Slider::of_friction();
    other.faults.with_parameter = |median, mu| [1.1 * mu, median[1], median[2]];
    assert!(matches!(fault(&other), Some(C::Differ { .. })));
    // Nothing says that more is drawn but the draws.
    let mut secret = Slider::right();
    secret.faults = Faults { inputs: |_| Vec::new(), input_values: |_| Vec::new(), is_single: true, ..secret.faults };
    assert!(matches!(fault(&secret), Some(C::NotSingle { .. })));
    let mut steep = Slider::of_friction();
    steep.drawn[0] = Distribution::LogNormal { median: 0.7, sigma: 2.0, at_least: None, at_most: None };
    steep.faults = Faults { inputs: |_| Vec::new(), input_values: |_| Vec::new(), ..steep.faults };
    assert_eq!(fault(&steep), None);
}

#[test]
fn a_plan_with_places_that_are_not_there_is_refused() {
    use Contradiction as C;
    type Expected = fn(&Contradiction) -> bool;
    let faults: [(&str, fn(&mut Plan), Expected); 21] = [
        ("no scenes", |p| p.scenes.clear(), |c| matches!(c, C::Empty { .. })),
        ("no configurations", |p| p.configurations.clear(), |c| matches!(c, C::Empty { .. })),
        (
            "configuration",
            |p| p.scenes[1].configuration = 3,
            |c| matches!(c, C::Index { what: "configuration", index: 3, count: 1, .. }),
        ),
        ("origin", |p| p.configurations[0].origin = 1, |c| matches!(c, C::Index { what: "origin", .. })),
        (
            "constraint set",
            |p| p.scenes[0].key.constraints = 1,
            |c| matches!(c, C::Index { what: "constraint set", .. }),
        ),
        ("law without label", |p| drop(p.labels.laws.pop()), |c| matches!(c, C::Index { what: "law", .. })),
        (
            "speed without label",
            |p| p.scenes[0].key.speed = Some(0),
            |c| matches!(c, C::Index { what: "speed range", .. }),
        ),
        ("panel without label", |p| p.scenes[1].key.panel = 1, |c| matches!(c, C::Index { what: "panel", .. })),
        ("baseline law", |p| p.labels.baseline_law = Some(2), |c| matches!(c, C::Index { what: "baseline law", .. })),
        ("member", |p| p.scenes[0].members = vec![7], |c| matches!(c, C::Index { what: "member", index: 7, .. })),
        ("no members", |p| p.scenes[1].members.clear(), |c| matches!(c, C::NoMembers { scene: 1 })),
        (
            "a member twice",
            |p| p.scenes[1].members = vec![0, 0],
            |c| matches!(c, C::SceneTwice { first: 1, second: 1, .. }),
        ),
        (
            "a scene twice",
            |p| p.scenes.push(p.scenes[0].clone()),
            |c| matches!(c, C::SceneTwice { first: 0, second: 2, .. }),
        ),
        ("no labels", |p| p.labels = Default::default(), |c| matches!(c, C::Index { .. })),
        (
            "a body's degree of freedom",
            |p| Arc::make_mut(&mut p.configurations[0].brake).bodies[1].dofs = vec![99],
            |c| matches!(c, C::BodyDof { dof: 99, order: 2, .. }),
        ),
        (
            "a body's degree of freedom of an origin",
            |p| Arc::make_mut(&mut p.origins[0].brake).bodies[0].dofs.push(2),
            |c| matches!(c, C::BodyDof { dof: 2, .. }),
        ),
        (
            "a body's degree of freedom twice",
            |p| Arc::make_mut(&mut p.configurations[0].brake).bodies[0].dofs = vec![0, 0],
            |c| matches!(c, C::BodyDofTwice { dof: 0, .. }),
        ),
        (
            "degrees of freedom of another brake",
            |p| Arc::make_mut(&mut p.configurations[0].brake).dofs = DofMap::all(3),
            |c| matches!(c, C::Order { found: 3, order: 2, .. }),
        ),
        (
            "sectors of another brake",
            |p| Arc::make_mut(&mut p.configurations[0].brake).sectors = osc_model::Sectors::whole(5, 1),
            |c| matches!(c, C::Order { found: 5, .. }),
        ),
        ("a band backwards", |p| p.band = Some([2.0, 1.0]), |c| matches!(c, C::Band { .. })),
        (
            "a naming point of its own",
            |p| p.configurations[0].naming_point.coefficients[2] = 0.5,
            |c| matches!(c, C::Medians { configuration: 0, .. }),
        ),
    ];
    for (name, spoil, is_expected) in faults {
        let mut brake = Slider::right();
        spoil(&mut brake.plan);
        let found = fault(&brake);
        assert!(found.as_ref().is_some_and(is_expected), "{name}: {found:?}");
    }
    // A scene for every speed beside one of a range.
    let mut brake = Slider::right();
    let label = squeal::study::SpeedLabel { name: "slow".into(), description: "slow".into() };
    brake.plan.labels.speeds = vec![label];
    let mut of_range = brake.plan.scenes[0].clone();
    of_range.key.speed = Some(0);
    brake.plan.scenes.push(of_range);
    assert!(matches!(fault(&brake), Some(C::SceneTwice { first: 0, second: 2, member: 0 })));
}

/// Loses eigenvalues of every system of a certain kind.
struct Losing(fn(&mut Vec<Complex<f64>>));

impl EigenSolver for Losing {
    fn eigenvalues(&self, system: &SecondOrder, work: &mut Workspace) -> Result<Spectrum, CeaError> {
        let mut spectrum = QrSolver.eigenvalues(system, work)?;
        (self.0)(&mut spectrum.eigenvalues);
        Ok(spectrum)
    }
}

#[test]
fn a_solver_that_loses_eigenvalues_is_an_error() {
    let brake = Slider::right();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let right = Results::sampled(&study).unwrap();
    let unstable = right.summary.tally.scenes[0].any_unstable;
    assert!(20 < unstable && unstable < 180, "{unstable}");
    let losses: [fn(&mut Vec<Complex<f64>>); 3] =
        [Vec::clear, |all| all.truncate(all.len() - 2), |all| all.truncate(all.len() - 1)];
    for loss in losses {
        let error = Study::new(&brake, &Losing(loss)).map(drop).unwrap_err();
        assert!(error.to_string().contains("eigenvalues of a system that has 4"), "{error}");
    }
    // The medians keep all modes, and samples lose those that grow: these are failures, and none of them is stable.
    let solver = Losing(|all| all.retain(|lambda| lambda.re <= 0.0));
    match Study::new(&brake, &solver) {
        Err(error) => assert!(error.to_string().contains("eigenvalues of a system that has 4"), "{error}"),
        Ok(study) => {
            let found = Results::sampled(&study).unwrap();
            assert_eq!(found.summary.failures.by_scene()[0], unstable);
        }
    }
}

#[test]
fn brakes_of_case_files_contradict_nothing() {
    for name in ["hoffmann.toml", "wobbling-disc.toml", "disk-brake100.toml"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name);
        let CaseFile::Matrices(case) = CaseFile::read(&path).unwrap() else { panic!("{name}") };
        let mut brake = MatricesBrake::new(*case).unwrap();
        check(&brake).unwrap();
        // As one of a user's own type.
        brake.plan.source_file = None;
        check(&brake).unwrap();
    }
    let each = [("draws = \"shared\"", "draws = \"each\"")];
    for changes in [&[][..], &each] {
        let mut brake = LatticeBrake::new(crate::common::case("two-by-two.toml", changes)).unwrap();
        check(&brake).unwrap();
        brake.plan.source_file = None;
        check(&brake).unwrap();
    }
}
