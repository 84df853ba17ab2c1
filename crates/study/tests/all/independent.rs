//! A brake of independent parameters: where its modes have their names, whatever its scenes and distributions are.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
use montecarlo::Distribution;
use nalgebra::dmatrix;
use osc_model::Brake;
use study::{Contradiction, Drawn, Error, IndependentBrake, Plan, Scene, UncertainBrake, check};

const LAWS: [(&str, &str); 2] = [("constant", "Constant"), ("falling", "Falling")];
const SPEEDS: [(&str, &str); 2] = [("slow", "below 1 m/s"), ("fast", "above")];

/// Two masses on a belt; the stiffness of the second spring is another in each set of constraints.
fn brake(stiffness: f64) -> Brake {
    let k = dmatrix![2.0, 1.0; 1.0, 2.0 + stiffness];
    let structure = SecondOrder::new(dmatrix![1.0, 0.0; 0.0, 1.0], 0.05 * &k, k).unwrap();
    let belt = Channel::new("belt", "friction", vec![(0, 1.0)], vec![(1, -1.0)]);
    Brake::new(AffineSystem::new(vec![Term::new("masses", "springs", structure).unwrap()], vec![belt]).unwrap())
}

/// Friction that tells every scene from the others. Before ranges of speed are given a scene has none.
fn at(scene: &Scene, values: &[f64]) -> Result<OperatingPoint, Error> {
    let speed = scene.key.speed.map_or(7, |range| range) as f64;
    let mu = values[0] * (1.0 + scene.key.law as f64 + 10.0 * speed + 100.0 * scene.key.constraints as f64);
    Ok(OperatingPoint { coefficients: vec![1.0], channels: vec![ChannelGain::proportional(mu)] })
}

type Made = IndependentBrake<fn(&Scene, &[f64]) -> Result<OperatingPoint, Error>>;

/// A brake with two sets of constraints and one coefficient of friction.
fn made(mu: Distribution) -> Made {
    let mut plan = Plan::without_scenes("belt", "belt".into(), 1, 1);
    for (set, name) in ["soft", "stiff"].into_iter().enumerate() {
        let mut scene = Scene::default();
        scene.key.constraints = set;
        plan.add_constraint_set(name, brake(set as f64), at(&scene, &[mu.median()]).unwrap());
    }
    IndependentBrake::with_plan(plan, vec![Drawn::new("mu", "1", mu)], at as fn(&Scene, &[f64]) -> _).unwrap()
}

#[test]
fn modes_are_named_in_the_first_scene_of_each_configuration_whatever_laws_and_speeds_there_are() {
    let mu = || Distribution::Uniform { from: 0.2, to: 0.6 };
    type Change = fn(Made) -> Result<Made, Error>;
    let (with_laws, with_speeds): (Change, Change) =
        (|brake| brake.with_laws(&LAWS), |brake| brake.with_speeds(&SPEEDS));
    for changes in [&[][..], &[with_laws], &[with_speeds], &[with_laws, with_speeds], &[with_speeds, with_laws]] {
        let brake = changes.iter().try_fold(made(mu()), |brake, change| change(brake)).unwrap();
        check(&brake).unwrap();
        let plan = brake.plan();
        assert_eq!(plan.scenes.len(), 2 << changes.len());
        for (place, configuration) in plan.configurations.iter().enumerate() {
            let first = plan.scenes.iter().find(|scene| scene.configuration == place).unwrap();
            let expected = at(first, &[0.4]).unwrap();
            assert_eq!((configuration.origin, &configuration.naming_point), (place, &expected));
            assert_eq!(plan.origins[place].naming_point, expected);
        }
    }
    assert!(matches!(made(mu()).with_laws(&[]), Err(Error::Contradiction(Contradiction::Empty { .. }))));
}

#[test]
fn a_bound_moves_the_median_of_what_is_drawn_and_the_names_with_it() {
    for at_least in [f64::NEG_INFINITY, 0.0, 0.02, 0.3, 0.45, 0.5] {
        for at_most in [None, Some(0.6), Some(9.0)] {
            let mu = Distribution::Normal { mean: 0.5, deviation: 0.1, at_least, at_most };
            let brake = made(mu.clone());
            check(&brake).unwrap();
            let share = mu.cumulative(brake.median()[0]);
            assert!((share - 0.5).abs() < 1e-5, "{mu:?}: {share}");
        }
    }
}
