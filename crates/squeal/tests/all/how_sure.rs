//! Influence of inputs against closed forms, correlated inputs, and Sobol' points as a sampling plan.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

mod kept_samples;

use std::path::Path;

use brakes::case::{CaseError, LatticeCase, MatricesCase};
use brakes::{LatticeBrake, LatticeSample, MatricesBrake};
use cea::BatchSolver;
use montecarlo::stream;
use squeal::estimators::{Estimator, scene_occurrences};
use squeal::influence::{Influence, OutputKind, influence};
use squeal::questions::Error;
use squeal::study::{DrawnInputs, ModeLabel, Study, UncertainBrake as _};

/// A mass of 1 kg on a spring and a dashpot d, with friction that falls with speed, worth a dashpot -s: growth (s - d) / 2.
const BELT: &str = r#"
[study]
name = "mass on a belt"
samples = 4000
seed = 5

[brake]
kind = "matrices"

[parameters.d]
distribution = "uniform"
from = 0.0
to = 1.0

[parameters.s]
distribution = "uniform"
from = 0.0
to = 1.5

[parameters.k]
distribution = "uniform"
from = 9e3
to = 1.1e4

[[terms]]
name = "mass"
mass = [[1.0]]

[[terms]]
name = "spring"
coefficient = "k"
stiffness = [[1.0]]

[[terms]]
name = "dashpot"
coefficient = "d - s"
damping = [[1.0]]
"#;

fn belt(more: &str) -> Result<MatricesBrake, CaseError> {
    let case = MatricesCase::parse(Path::new("belt.toml"), format!("{BELT}\n{more}"))?;
    Ok(MatricesBrake::new(case).unwrap())
}

/// Draws of which all or half have a number that is none: the first are refused with the reason, of the second it is told, and no mean is NaN.
#[test]
fn draws_that_fail_are_told_with_their_reason_and_have_no_mean_where_all_do() {
    for (sum, fails) in [("sqrt(0 - (k - 1e4)^2)", "all"), ("sqrt(k - 1e4)", "half"), ("sqrt(0)", "none")] {
        let text = BELT.replace("\"d - s\"", &format!("\"d - s + {sum}\""));
        let brake = MatricesBrake::new(MatricesCase::parse(Path::new("belt.toml"), text).unwrap()).unwrap();
        let study = Study::new(&brake, &BatchSolver).unwrap();
        let found = influence(&study, 0, 400, None, &());
        if fails == "all" {
            let error = found.unwrap_err();
            assert!(
                matches!(&error, Error::EachFailed { what: "draws", count: 400, reason, .. } if !reason.is_empty())
            );
            let design = influence(&study, 0, 400, Some(100), &()).unwrap_err();
            assert!(matches!(design, Error::EachFailed { .. }), "{design}");
            continue;
        }
        let found = found.unwrap();
        assert_eq!(found.failures > 0, fails == "half");
        assert_eq!(found.first_failure.is_some(), fails == "half");
        assert!(found.outputs.iter().all(|output| output.mean.is_finite() && output.deviation.is_finite()));
        assert_eq!(found.text(brake.plan()).contains("; the first: "), fails == "half");
    }
}

/// First-order and total indices of d and s for an output of (d, s), by sums over a grid of middles.
fn by_quadrature(output: impl Fn(f64, f64) -> f64) -> [[f64; 2]; 2] {
    let steps = 1_500;
    let middle = |at: usize, to: f64| to * (at as f64 + 0.5) / steps as f64;
    let value = |i: usize, j: usize| output(middle(i, 1.0), middle(j, 1.5));
    let count = steps as f64;
    let (mut of_d, mut of_s, mut squares) = (vec![0.0; steps], vec![0.0; steps], 0.0);
    for (i, of_d) in of_d.iter_mut().enumerate() {
        for (j, of_s) in of_s.iter_mut().enumerate() {
            let y = value(i, j);
            *of_d += y / count;
            *of_s += y / count;
            squares += y * y / count / count;
        }
    }
    let mean = of_d.iter().sum::<f64>() / count;
    let variance = squares - mean * mean;
    let first = [of_d, of_s].map(|of| (of.iter().map(|y| y * y).sum::<f64>() / count - mean * mean) / variance);
    // Of two inputs that matter what one does not explain alone the other does, alone or with it.
    [[first[0], 1.0 - first[1]], [first[1], 1.0 - first[0]]]
}

#[test]
fn indices_of_a_mass_on_a_belt_are_those_of_quadrature() {
    let brake = belt("").unwrap();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let found = influence(&study, 0, 4_000, Some(4_000), &()).unwrap();
    assert_eq!(found.inputs.iter().map(|input| input.name.as_str()).collect::<Vec<_>>(), ["d", "k", "s"]);
    assert_eq!((found.failures, found.open, found.evaluations), (0, 0, 4_000 + 4_000 * 5));
    let growth = by_quadrature(|d, s| 0.5 * (s - d).max(0.0));
    let squeals = by_quadrature(|d, s| f64::from(s > d));
    let mut seen = 0;
    for output in &found.outputs {
        let expected = match output.output.kind {
            OutputKind::Growth => growth,
            OutputKind::Instability => squeals,
        };
        let expected = [expected[0], [0.0; 2], expected[1]];
        for (input, expected) in output.inputs.iter().zip(expected) {
            for (index, expected) in [(input.first_order, expected[0]), (input.total.unwrap(), expected[1])] {
                let error = (index.value - expected).abs();
                assert!(
                    error <= 4.0 * index.standard_error + 1e-3 && error < 0.06,
                    "{:?} {index:?} {expected}",
                    output.output
                );
                seen += 1;
            }
        }
    }
    // Growth and instability, of any mode and of the only one, which are the same.
    assert_eq!((seen, found.outputs.len()), (24, 4));
    assert_eq!(found.outputs[0].inputs, found.outputs[2].inputs);
    let text = found.text(&brake.plan);
    assert!(text.contains("s explains ") && text.contains("growth of any mode"), "{text}");
}

#[test]
fn the_draws_are_those_of_the_study_whatever_the_threads() {
    let brake = LatticeBrake::new(crate::common::case("two-by-two.toml", &[])).unwrap();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let scene = brake.plan.scenes.len() - 1;
    let on = |threads: usize| -> Influence {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| influence(&study, scene, 300, None, &())).unwrap()
    };
    let one = on(1);
    assert_eq!(one, on(3));
    let mut unstable = 0;
    let mut scratch = Default::default();
    for index in 0..300 {
        let sample = brake.draw(&mut stream(brake.plan.seed, index)).unwrap();
        let outcome = montecarlo::Experiment::evaluate(&study, scene, &sample, &mut scratch).unwrap();
        unstable += u64::from(!outcome.unstable.is_empty());
    }
    assert_eq!(one.outputs[0].nonzero, unstable);
    let names: Vec<&str> = one.inputs.iter().map(|input| input.name.as_str()).collect();
    assert!(names.contains(&"mu_k") && names.contains(&"v") && !names.contains(&"mu"), "{names:?}");
}

/// Rank correlation of two parameters over some draws.
fn rank_correlation(draws: &[[f64; 2]]) -> f64 {
    let ranks = |of: usize| {
        let mut order: Vec<usize> = (0..draws.len()).collect();
        order.sort_by(|&a, &b| draws[a][of].total_cmp(&draws[b][of]));
        let mut ranks = vec![0.0; draws.len()];
        order.into_iter().enumerate().for_each(|(rank, at)| ranks[at] = (rank as f64 + 0.5) / draws.len() as f64 - 0.5);
        ranks
    };
    let (a, b) = (ranks(0), ranks(1));
    12.0 * a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() / draws.len() as f64
}

fn expected_rank_correlation(rho: f64) -> f64 {
    6.0 / std::f64::consts::PI * (rho / 2.0).asin()
}

#[test]
fn parameters_of_matrices_are_drawn_together() {
    let matrix =
        |rho: f64| format!("[correlation]\nparameters = [\"s\", \"d\"]\nmatrix = [[1.0, {rho:?}], [{rho:?}, 1.0]]");
    let (plain, none, strong) = (belt("").unwrap(), belt(&matrix(0.0)).unwrap(), belt(&matrix(0.8)).unwrap());
    let draws = |brake: &MatricesBrake| -> Vec<Vec<f64>> {
        (0..4_000).map(|index| brake.draw(&mut stream(5, index)).unwrap()).collect()
    };
    let (of_plain, of_strong) = (draws(&plain), draws(&strong));
    assert_eq!((&of_plain, &plain.plan.identity), (&draws(&none), &none.plan.identity));
    assert_ne!(plain.plan.identity, strong.plan.identity);
    // Parameters are d, k, s; s comes first in the matrix and keeps its draws.
    let pairs: Vec<[f64; 2]> = of_strong.iter().map(|values| [values[0], values[2]]).collect();
    assert!((rank_correlation(&pairs) - expected_rank_correlation(0.8)).abs() < 0.03);
    assert!(of_plain.iter().zip(&of_strong).all(|(a, b)| a[1..] == b[1..]));

    // Samples by quantiles have the same dependence.
    let quantiles = |index: u32| {
        let mut rng = stream(8, u64::from(index));
        let uniform: [f64; 3] = std::array::from_fn(|_| montecarlo::rand::RngExt::random(&mut rng));
        let at = strong.quantile_sample(&strong.plan.scenes[0], &|d| uniform[d as usize]);
        [at[0], at[2]]
    };
    let pairs: Vec<[f64; 2]> = (0..4_000).map(quantiles).collect();
    assert!((rank_correlation(&pairs) - expected_rank_correlation(0.8)).abs() < 0.03);

    // First order is still Var E[Y | X] / Var Y: each explains less of growth, and total indices are refused.
    let study = Study::new(&strong, &BatchSolver).unwrap();
    let refused = influence(&study, 0, 1_000, Some(1_000), &());
    assert!(matches!(refused, Err(Error::Argument { argument: "total", .. })));
    let found = influence(&study, 0, 2_000, None, &()).unwrap();
    assert!(found.text(&strong.plan).contains("d, s are correlated"));
}

#[test]
fn a_field_over_contacts_falls_with_their_distance() {
    let each = ("draws = \"shared\"", "draws = \"each\"");
    let lattice = |field: &str| {
        let table = format!("[correlation]\n{field}\n[lattice]\n");
        LatticeBrake::new(crate::common::case("two-by-two.toml", &[each, ("[lattice]\n", table.as_str())])).unwrap()
    };
    let plain = LatticeBrake::new(crate::common::case("two-by-two.toml", &[each])).unwrap();
    let none = lattice("field = { kernel = \"gaussian\", length = 0.0 }");
    let far = lattice("parameters = [\"mu_k\"]\nfield = { kernel = \"exponential\", length = 2.0 }");
    let draws = |brake: &LatticeBrake| -> Vec<_> {
        (0..4_000).map(|index| brake.draw(&mut stream(5, index)).unwrap()).collect()
    };
    let (of_plain, of_far) = (draws(&plain), draws(&far));
    assert_eq!((&of_plain, &plain.plan.identity), (&draws(&none), &none.plan.identity));
    // 1 and 2 are neighbours, 1 and 4 across the diagonal of the square.
    for (other, distance) in [(1, 1.0), (2, 1.0), (3, 2.0_f64.sqrt())] {
        let pairs: Vec<[f64; 2]> = of_far.iter().map(|of| [of.contact(0).mu_k, of.contact(other).mu_k]).collect();
        let expected = expected_rank_correlation((-distance / 2.0_f64).exp());
        assert!((rank_correlation(&pairs) - expected).abs() < 0.04, "{other}: {} {expected}", rank_correlation(&pairs));
        assert!(of_plain.iter().zip(&of_far).all(|(a, b)| a.contact(other).mu == b.contact(other).mu));
    }
    let names: Vec<String> = far.inputs(far.plan.scenes.last().unwrap()).into_iter().map(|input| input.name).collect();
    assert!(names.contains(&"mu_k@4".to_owned()), "{names:?}");
}

/// Friction parameters of single contacts: correlated as the matrix says, over the contacts as the field says, and with no other.
#[test]
fn friction_of_single_contacts_is_drawn_together() {
    let each = ("draws = \"shared\"", "draws = \"each\"");
    let lattice = |table: &str| {
        let table = format!("[correlation]\n{table}\n[lattice]\n");
        LatticeBrake::new(crate::common::case("two-by-two.toml", &[each, ("[lattice]\n", table.as_str())])).unwrap()
    };
    let plain = LatticeBrake::new(crate::common::case("two-by-two.toml", &[each])).unwrap();
    let matrix = "parameters = [\"mu_s@1\", \"mu_k@1\"]\nmatrix = [[1.0, 0.4], [0.4, 1.0]]\n";
    let alone = lattice(matrix);
    let over = lattice(&format!("{matrix}field = {{ kernel = \"exponential\", length = 2.0 }}"));
    let draws = |brake: &LatticeBrake| -> Vec<_> {
        (0..4_000).map(|index| brake.draw(&mut stream(5, index)).unwrap()).collect()
    };
    let of_plain = draws(&plain);
    let across = |distance: f64| (-distance / 2.0).exp();
    for (brake, of_field) in [(&alone, false), (&over, true)] {
        let found = draws(brake);
        let between = |a: (usize, bool), b: (usize, bool)| {
            let value = |of: &LatticeSample, (contact, is_static): (usize, bool)| {
                let draw = of.contact(contact);
                if is_static { draw.drawn_mu_s } else { draw.mu_k }
            };
            rank_correlation(&found.iter().map(|of| [value(of, a), value(of, b)]).collect::<Vec<_>>())
        };
        let field = |distance: f64| if of_field { across(distance) } else { 0.0 };
        for (a, b, rho) in [
            ((0, true), (0, false), 0.4),
            ((0, true), (1, false), 0.0),
            ((1, true), (1, false), 0.0),
            ((0, true), (1, true), field(1.0)),
            ((1, false), (2, false), field(2.0_f64.sqrt())),
        ] {
            let of = between(a, b);
            assert!((of - expected_rank_correlation(rho)).abs() < 0.05, "{of_field} {a:?} {b:?}: {of}, {rho}");
        }
        assert!(found.iter().zip(&of_plain).all(|(of, plain)| of.contact(3).mu == plain.contact(3).mu));
        let inputs = brake.plan.scenes.iter().flat_map(|scene| brake.inputs(scene));
        let inputs: Vec<_> = inputs.collect();
        let correlated = |name: &str| inputs.iter().find(|input| input.name == name).unwrap().is_correlated;
        assert_eq!((correlated("mu_k@1"), correlated("mu_s@2")), (true, of_field));
    }
    let refused = |table: &str| {
        let table = format!("[correlation]\n{table}\n[lattice]\n");
        let text =
            std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/two-by-two.toml")).unwrap();
        let text = text.replacen(each.0, each.1, 1).replacen("[lattice]\n", &table, 1);
        LatticeCase::parse(Path::new("lattice.toml"), text).unwrap_err().to_string()
    };
    // The smallest eigenvalue is that of NumPy's eigvalsh.
    let strong = matrix.replace("0.4", "0.6") + "field = { kernel = \"exponential\", length = 2.0 }";
    let message = refused(&strong);
    assert!(message.contains("correlation = a matrix and a field with the eigenvalue -7.121e-2 together"), "{message}");
    let message = refused(&matrix.replace("mu_k@1", "mu_k@5"));
    assert!(message.contains("\"mu_k@5\"") && message.contains("the number N of the contact, 1 to 4"), "{message}");
}

#[test]
fn correlations_that_make_no_sense_are_refused_in_one_line() {
    for (table, words) in [
        ("parameters = [\"s\", \"d\"]\nmatrix = [[1.0, 1.0], [1.0, 1.0]]", ["correlation.matrix", "eigenvalue"]),
        ("parameters = [\"s\", \"q\"]\nmatrix = [[1.0, 0.0], [0.0, 1.0]]", ["\"q\"", "d, k, s"]),
        ("parameters = [\"s\", \"d\"]\nmatrix = [[1.0, 0.1], [0.2, 1.0]]", ["row 1, column 2", "both sides"]),
        ("parameters = [\"s\", \"d\"]\nmatrix = [[1.0, 0.1]]", ["rows of 2", "2 rows of 2"]),
        ("parameters = [\"s\", \"s\"]\nmatrix = [[1.0, 0.1], [0.1, 1.0]]", ["s", "each once"]),
        ("field = { kernel = \"gaussian\", length = 1.0 }", ["correlation.field", "each"]),
        ("parameters = [\"s\", \"d\"]", ["correlation", "a matrix over parameters"]),
    ] {
        let message = belt(&format!("[correlation]\n{table}")).unwrap_err().to_string();
        assert!(!message.contains('\n') && words.iter().all(|word| message.contains(word)), "{table}: {message}");
    }
    let three = "parameters = [\"d\", \"k\", \"s\"]\nmatrix = [[1.0, 0.9, 0.9], [0.9, 1.0, -0.9], [0.9, -0.9, 1.0]]";
    let message = belt(&format!("[correlation]\n{three}")).unwrap_err().to_string();
    // Eigenvalues 1.9, 1.9 and -0.8, by the sum of the matrix with signs (1, -1, -1).
    assert!(message.contains("-8.000e-1"), "{message}");
    let each = [("draws = \"shared\"", "draws = \"each\"")];
    let mut text =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/two-by-two.toml")).unwrap();
    text = text.replacen(each[0].0, each[0].1, 1);
    let with = |field: &str| text.replacen("[lattice]\n", &format!("[correlation]\nfield = {field}\n[lattice]\n"), 1);
    for (field, words) in [
        ("{ kernel = \"gaussian\", length = 1e6 }", ["correlation.field", "shorter length"]),
        ("{ kernel = \"gaussian\", length = -1.0 }", ["correlation.field.length", "-1"]),
    ] {
        let message = LatticeCase::parse(Path::new("lattice.toml"), with(field)).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}

#[test]
fn sobol_points_are_taken_where_they_are_cheaper() {
    let brake = belt("").unwrap();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let found = scene_occurrences(&study, 0, 0.003, None).unwrap();
    assert_eq!(found.estimator, Estimator::ScrambledSobol);
    let occurrence = found.modes[&ModeLabel::new(1)];
    assert!(occurrence.limits.contains(2.0 / 3.0) && found.half_width <= 0.003, "{occurrence:?}");
    assert!(3 * found.evaluations < found.plain_evaluations, "{} {}", found.evaluations, found.plain_evaluations);
}
