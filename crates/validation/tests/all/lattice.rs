//! Onsets, derivatives, expansions and the lattice at its extremes against refined eigenvalues.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use crate::paper_brake::{SOME, brake, exact_of};
use brakes::LatticeBrake;
use brakes::case::{LatticeCase, Law};
use cea::{EigenSolver, QrSolver, Workspace};
use linsys::SecondOrder;
use num_complex::Complex;
use squeal::estimators::OneParameterFamily;
use squeal::study::{ModeLabel, Study};
use squeal::tracking::Branches;
use validation::{RouteOutcome, TaylorOrder, expand, extremes, perturbation, refine, refine_all};

#[test]
fn the_real_part_changes_its_sign_at_a_critical_coefficient() {
    let brake = brake(SOME, "amontons-coulomb", &[]);
    let study = Study::new(&brake, &QrSolver).unwrap();
    for scene in 0..brake.plan.scenes.len() {
        let exact = exact_of(&study, scene);
        assert!(exact.onsets.onsets.len() >= 4 && exact.onsets.unresolved.is_empty());
        let family = OneParameterFamily::new(&brake, &brake.plan.scenes[scene], &QrSolver).unwrap();
        for crossing in &exact.onsets.onsets {
            assert!(crossing.error < 1e-11);
            let real = |mu: f64| {
                let system = family.system(mu);
                let guess = Complex::new(0.0, crossing.omega);
                let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap();
                let nearest = spectrum.oscillatory().min_by(|a, b| (a - guess).norm().total_cmp(&(b - guess).norm()));
                refine(&system, nearest.unwrap()).unwrap().lambda.re
            };
            let (below, above) = (real(crossing.at - 2e-11), real(crossing.at + 2e-11));
            assert!(below * above < 0.0 && (above > 0.0) == crossing.destabilises, "{below} {above}");
        }
    }
}

#[test]
fn derivatives_are_the_limits_of_differences() {
    let brake = brake("[[1,3,4,5,6,8]]", "amontons-coulomb", &[]);
    let mut family = OneParameterFamily::new(&brake, &brake.plan.scenes[0], &QrSolver).unwrap();
    let (mu, h) = (0.4, 1e-4);
    // Modes keep their order by frequency over so small a step.
    let at = |family: &mut OneParameterFamily<'_>, mu: f64| {
        let (lambdas, system): (_, SecondOrder) = (family.lambdas(mu).unwrap().to_vec(), family.system(mu));
        refine_all(&system, &lambdas).unwrap()
    };
    let (all_below, all_above) = (at(&mut family, mu - h), at(&mut family, mu + h));
    let all = at(&mut family, mu);
    for (i, middle) in all.iter().enumerate() {
        if all.iter().enumerate().any(|(j, m)| j != i && (m.lambda - middle.lambda).norm() < 1e-6) {
            continue; // x and y of the plate, exactly double
        }
        let (below, middle, above) = (all_below[i].lambda, middle.lambda, all_above[i].lambda);
        let expansion = expand(&mut family, mu, middle).unwrap();
        let slope = family.refined(mu, middle).unwrap().rate;
        let first = (above - below) / (2.0 * h);
        let second = (above - 2.0 * middle + below) / (h * h);
        assert!((expansion.first - slope).norm() < 1e-7 * (1.0 + slope.norm()));
        assert!((expansion.first - first).norm() < 1e-4 * (1.0 + first.norm()), "{first} {expansion:?}");
        assert!((expansion.second - second).norm() < 1e-2 * (10.0 + second.norm()), "{second} {expansion:?}");
    }
}

#[test]
fn perturbation_is_exact_where_the_uncertainty_is_small_and_only_there() {
    // With friction in y coupled a mode becomes unstable near mu = 0.4345.
    let coupled = ("lateral = \"none\"", "lateral = \"coupled\"");
    let narrow = [
        coupled,
        (
            "mu = { distribution = \"normal\", mean = 0.50, deviation = 0.10",
            "mu = { distribution = \"normal\", mean = 0.4345, deviation = 0.0002",
        ),
    ];
    let error = |edits: &[(&str, &str)], order| {
        let brake = brake("[[1,3,4,5,6,8]]", "amontons-coulomb", edits);
        let study = Study::new(&brake, &QrSolver).unwrap();
        let exact = exact_of(&study, 0).integral.occurrences;
        let mut family = OneParameterFamily::new(&brake, &brake.plan.scenes[0], &QrSolver).unwrap();
        let found = perturbation(&study.references()[0], &mut family, order).unwrap().occurrences;
        let names = exact.keys().chain(found.keys());
        let of = |all: &std::collections::BTreeMap<ModeLabel, squeal::estimators::OccurrenceBounds>,
                  name: &ModeLabel| { all.get(name).map_or(0.0, |o| o.lower) };
        names.map(|name| (of(&exact, name) - of(&found, name)).abs()).fold(0.0, f64::max)
    };
    let (first, second) = (error(&narrow, TaylorOrder::First), error(&narrow, TaylorOrder::Second));
    assert!(second < 1e-4 && second < first && first < 0.01, "{first} {second}");
    assert!(error(&[coupled], TaylorOrder::First) > 0.01);
}

#[test]
fn the_lattice_at_its_extremes_is_solved_to_its_targets() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/paper.toml"));
    let mut case = LatticeCase::read(path).unwrap();
    case.laws = vec![Law::AmontonsCoulomb, Law::LuGre];
    let brake = LatticeBrake::new(case).unwrap();
    let scene = |law| brake.plan.scenes.iter().find(|scene| brake.law(scene.key) == law).unwrap();
    for case in extremes(&brake, scene(Law::AmontonsCoulomb), scene(Law::LuGre)).unwrap() {
        // With strong dashpots nine of thirty modes are overdamped and have two real eigenvalues each.
        let modes = case.system.order() + if case.name.starts_with("lateral") { 9 } else { 0 };
        assert_eq!(case.reference.len(), modes, "{}", case.name);
        for result in case.judge().iter().filter(|r| ["QrSolver + verdict", "general + certify"].contains(&r.route())) {
            let RouteOutcome::Judged(judged) = result else { panic!("{result:?}") };
            assert!(judged.max_error_in_condition_epsilon <= 100.0, "{judged:?}");
            assert!(judged.max_backward_error <= 1e-14, "{judged:?}");
            assert_eq!((judged.wrong_signs, judged.false_instabilities), (0, 0), "{judged:?}");
        }
    }
}
