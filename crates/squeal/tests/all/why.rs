//! Why modes grow: against differences, closed forms and identities.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use std::f64::consts::TAU;

use brakes::case::{CaseFile, LatticeCase, Law, MatricesCase};
use brakes::{LatticeBrake, MatricesBrake};
use cea::{EigenSolver, Eigentriple, QrSolver, Workspace};
use linsys::{OperatingPoint, SecondOrder};
use num_complex::Complex;
use squeal::run_study;
use squeal::study::{Parametrised, UncertainBrake};
use squeal::why::{Explainer, Influence, InfluenceKind, Why};

use crate::cases::{cases, paper};

/// Hoffmann's oscillator with another median of mu.
fn hoffmann(mu: f64) -> MatricesCase {
    let text = std::fs::read_to_string(cases("hoffmann.toml")).unwrap();
    of_matrices(
        &text.replace("from = 0.5", &format!("from = {}", mu - 0.1)).replace("to = 1.1", &format!("to = {}", mu + 0.1)),
    )
}

fn of_matrices(text: &str) -> MatricesCase {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).unwrap();
    let CaseFile::Matrices(case) = CaseFile::read(&path).unwrap() else { unreachable!("it has matrices") };
    *case
}

/// Hoffmann's oscillator with parameters of one's own, a table each, its coefficient of friction and a slope.
fn hoffmann_with(parameters: &str, mu: &str, slope: &str) -> MatricesBrake {
    let text = std::fs::read_to_string(cases("hoffmann.toml")).unwrap();
    let (before, rest) = text.split_once("[parameters.mu]").unwrap();
    let (_, after) = rest.split_once("[[terms]]").unwrap();
    let after = after.replace("mu = \"mu\"", &format!("mu = \"{mu}\"\nslope = \"{slope}\""));
    let before = before.replace("samples = 10000", "samples = 4");
    MatricesBrake::new(of_matrices(&format!("{before}{parameters}\n[[terms]]{after}"))).unwrap()
}

/// The table and the reasons in words that a run of a brake writes.
fn reasons_of<B: UncertainBrake>(brake: &B) -> (output::Table, String) {
    let folder = tempfile::tempdir().unwrap();
    run_study(brake, folder.path(), Some(1), &mut |_, _, _| Ok(())).unwrap();
    let summary = std::fs::read_to_string(folder.path().join("summary.md")).unwrap();
    let (_, words) = summary.split_once("\n## Why\n").unwrap();
    (output::Table::read(&folder.path().join("sensitivities.csv")).unwrap().unwrap(), words.to_owned())
}

/// A parameter about 0 has no per cent and is the strongest handle: its derivative by a unit is told, and no cell is -0.
#[test]
fn a_parameter_that_is_0_changes_a_mode_by_its_unit() {
    let normal = |name: &str, unit: &str| {
        format!(
            "[parameters.{name}]\nunit = \"{unit}\"\ndistribution = \"normal\"\nmean = 0.0\ndeviation = 0.02\nat_least = -inf\n"
        )
    };
    // d lambda / d (slope), and by the coefficient of friction as in the closed form.
    for (parameter, unit, mu, slope) in
        [("s", "Ns/m", "0.8", "s"), ("d", "1", "0.8 + d", "0"), ("both", "1", "0.8 + both", "both")]
    {
        let brake = hoffmann_with(&normal(parameter, unit), mu, slope);
        let (table, words) = reasons_of(&brake);
        let scene = &brake.plan().scenes[0];
        let [why] = &whys(&brake)[..] else { panic!("{words}") };
        let influence = why.influences.iter().find(|influence| influence.name == parameter).unwrap();
        assert_eq!((influence.value, influence.growth_per_percent), (0.0, None));
        check(influence, why.lambda, |value| brake.system_with(scene, &[(0, value)]).unwrap());
        let per = if unit == "1" { String::new() } else { format!(" per {unit}") };
        let sign = if influence.growth > 0.0 { "+" } else { "" };
        let told = format!("{parameter}, which is 0, by {sign}{} 1/s{per}\n", output::significant(influence.growth, 3));
        assert!(words.contains(&told) && !words.contains("no named parameter"), "{words}: {told}");
        let cells = |name: &str| table.column(name).unwrap().map(str::to_owned).collect::<Vec<String>>();
        let row = cells("parameter").iter().position(|name| name == parameter).unwrap();
        assert_eq!((cells("value")[row].as_str(), cells("growth_per_percent")[row].as_str()), ("0", ""));
        for name in ["value", "d_growth", "d_frequency_hz", "growth_per_percent", "frequency_hz_per_percent"] {
            assert!(!cells(name).contains(&"-0".to_owned()), "{name}");
        }
    }
}

fn whys<B: UncertainBrake>(brake: &B) -> Vec<Why> {
    let mut work = Workspace::default();
    let explainer = Explainer::new(brake, &brake.plan().scenes[0], &mut work).unwrap();
    let modes = explainer.asked_for(&mut work).unwrap();
    let before = work.counters;
    let whys = explainer.why(&modes, &mut work).unwrap();
    // One spectrum, and three factorisations for each mode.
    assert_eq!((before.eigenvalue_solves, work.counters.eigenvalue_solves), (1, 1));
    assert_eq!(work.counters.factorisations - before.factorisations, 3 * modes.len() as u64);
    whys
}

/// The eigenvalue of a system next to another.
fn next_to(system: &SecondOrder, lambda: Complex<f64>) -> Complex<f64> {
    let mut work = Workspace::default();
    let all = QrSolver.eigenvalues(system, &mut work).unwrap().eigenvalues;
    let nearest = all.into_iter().min_by(|a, b| (a - lambda).norm().total_cmp(&(b - lambda).norm())).unwrap();
    Eigentriple::new(system, nearest, &mut work).unwrap().refined(system)
}

/// Checks an influence against the central difference of eigenvalues over a hundredth of the change to which it holds.
fn check(influence: &Influence, lambda: Complex<f64>, mut system: impl FnMut(f64) -> SecondOrder) {
    let size = if influence.value == 0.0 { 1.0 } else { influence.value.abs() };
    let reach = influence.growth_holds_to.min(influence.frequency_holds_to);
    let step = (0.01 * reach).clamp(1e-6 * size, 1e-3 * size);
    let mut at = |by: f64| next_to(&system(influence.value + by), lambda);
    let difference = match influence.value == 0.0 {
        false => (at(step) - at(-step)) / (2.0 * step),
        // What is 0 may not be negative.
        true => (4.0 * at(step) - 3.0 * at(0.0) - at(2.0 * step)) / (2.0 * step),
    };
    let rate = Complex::new(influence.growth, TAU * influence.frequency_hz);
    // Rounding of the eigenvalues, and of the differences the third order.
    let allowed = 1e-4 * rate.norm() + 1e-11 * lambda.norm() / step;
    assert!((rate - difference).norm() <= allowed, "{influence:?}: {difference}");
}

#[test]
fn every_derivative_of_a_lattice_is_the_limit_of_differences() {
    for law in Law::ALL {
        let brake = paper(law);
        let scene = &brake.plan.scenes[0];
        let parameters = brake.parameters(scene);
        let model = brake.plan.brake(scene);
        let at = brake.operating_point(scene, &brake.median()).unwrap();
        let explained = whys(&brake);
        assert!(!explained.is_empty());
        for why in &explained {
            assert!(why.is_simple && why.blur < 1e-8, "{law}: {}", why.lambda);
            assert_eq!(why.not_varied, Vec::<String>::new());
            for influence in &why.influences {
                check(influence, why.lambda, |value| match influence.kind {
                    InfluenceKind::Parameter => {
                        let place = parameters.iter().position(|parameter| parameter.name == influence.name).unwrap();
                        brake.system_with(scene, &[(place, value)]).unwrap()
                    }
                    InfluenceKind::Term => {
                        let mut system = model.system.assemble(&at).unwrap();
                        let SecondOrder { m, c, k, .. } = model.system.terms()[0].matrices();
                        match influence.name.as_str() {
                            "mass of structure" => system.m += m * (value - 1.0),
                            "damping of structure" => system.c += c * (value - 1.0),
                            "stiffness of structure" => system.k += k * (value - 1.0),
                            other => panic!("{other}"),
                        }
                        system
                    }
                    InfluenceKind::Contact => {
                        let mut at: OperatingPoint = at.clone();
                        let (what, contact) = influence.name.split_once(" of contact ").unwrap();
                        let place = model.system.channels().iter().position(|channel| channel.name == contact).unwrap();
                        let gain = &mut at.channels[place];
                        match what {
                            "mu" => gain.mu = value,
                            "slope" => gain.slope = value,
                            "lag" => gain.lag.as_mut().unwrap().force = value,
                            other => panic!("{other}"),
                        }
                        model.system.assemble(&at).unwrap()
                    }
                    InfluenceKind::Family => panic!("nine contacts are listed one by one"),
                });
            }
            let kinds = |kind| why.influences.iter().filter(|influence| influence.kind == kind).count();
            let of_contact = if law == Law::LuGre { 3 } else { 2 };
            assert_eq!((kinds(InfluenceKind::Term), kinds(InfluenceKind::Contact)), (3, 9 * of_contact));
            assert_eq!(kinds(InfluenceKind::Parameter), parameters.len());
            assert!(parameters.iter().filter(|p| p.name.starts_with("contact_stiffness.")).count() == 9);
        }
    }
}

#[test]
fn a_balance_is_complete() {
    for law in Law::ALL {
        for why in whys(&paper(law)) {
            let (growth, balance) = (why.lambda.re, &why.balance);
            let size: f64 = balance.families.iter().map(|family| family.growth.abs()).sum();
            let families: f64 = balance.families.iter().map(|family| family.growth).sum();
            let contacts: f64 = balance.contacts.iter().map(|contact| contact.growth).sum();
            let terms: f64 = balance.terms.iter().map(|term| term.growth).sum();
            let bodies: f64 = balance.bodies.iter().flat_map(|body| &body.growth).sum();
            for sum in [families, contacts + terms, bodies] {
                assert!((sum - growth).abs() < 1e-9 * size, "{law}: {sum} {growth}");
            }
            let friction = balance.families.iter().find(|family| family.name == "friction").unwrap();
            assert!((contacts - friction.growth).abs() < 1e-9 * size);
            let sum = |of: &dyn Fn(&squeal::why::BodyShare) -> f64| balance.bodies.iter().map(of).sum::<f64>();
            assert!((sum(&|body| body.kinetic) - 1.0).abs() < 1e-12 && (sum(&|body| body.strain) - 1.0).abs() < 1e-10);
            let parts: f64 = why.structure_modes.iter().map(|mode| mode.part).sum();
            assert!((parts - 1.0).abs() < 1e-12 && why.structure_modes.len() == 30);
            assert!(why.structure_modes.windows(2).all(|pair| pair[0].part >= pair[1].part));
        }
    }
}

#[test]
fn hoffmanns_oscillator_has_its_closed_form() {
    // lambda^2 + c lambda + 2 = i sqrt(D - 1) with D = mu k3 for the growing mode.
    let (mu, k3, c) = (0.8, 4.0 / 3.0, 0.05);
    let found = whys(&MatricesBrake::new(hoffmann(mu)).unwrap());
    let [why] = &found[..] else { panic!("{found:?}") };
    let root = Complex::new(0.0, (mu * k3 - 1.0).sqrt());
    let lambda = 0.5 * (-c + (c * c - 4.0 * (2.0 - root)).sqrt());
    let (lambda, root) = if lambda.im > 0.0 { (lambda, root) } else { (lambda.conj(), root.conj()) };
    assert!((why.lambda - lambda).norm() < 1e-12);
    let expected = -0.5 * k3 / root / (2.0 * lambda + c);
    let by_mu = why.influences.iter().find(|influence| influence.kind == InfluenceKind::Parameter).unwrap();
    let rate = Complex::new(by_mu.growth, TAU * by_mu.frequency_hz);
    assert!((rate - expected).norm() < 1e-10 * expected.norm(), "{rate} {expected}");
    // The growing mode is half of each of the two modes without friction, sqrt 1 and sqrt 3 rad/s: x / y is imaginary.
    for mode in &why.structure_modes {
        assert!((mode.part - 0.5).abs() < 1e-10, "{mode:?}");
        let square = (TAU * mode.frequency_hz).powi(2);
        assert!((square - if mode.number == 1 { 1.0 } else { 3.0 }).abs() < 1e-12);
    }
    // Equal dashpots c take c / 2.
    let dashpots = why.balance.terms.iter().find(|term| term.name == "dashpots").unwrap();
    assert!((dashpots.growth + 0.5 * c).abs() < 1e-12, "{dashpots:?}");
    assert_eq!(why.structure_modes.len(), 2);
}

#[test]
fn where_two_modes_are_one_there_are_no_derivatives_and_that_is_said() {
    // D = 1: both modes are one, and damped.
    let found = whys_without_counts(&MatricesBrake::new(hoffmann(0.75)).unwrap());
    assert!(!found.is_simple && found.influences.is_empty() && found.blur > 1e-3, "{found:?}");
    // A little beside, derivatives are there but hold for less than one per cent.
    let beside = whys_without_counts(&MatricesBrake::new(hoffmann(0.75 * (1.0 + 1e-4))).unwrap());
    let by_mu = beside.influences.iter().find(|influence| influence.kind == InfluenceKind::Parameter).unwrap();
    assert!(beside.is_simple && !by_mu.holds_for_a_percent(), "{by_mu:?}");
    assert!((by_mu.growth_holds_to / (0.4 * 1e-4 * 0.75) - 1.0).abs() < 0.05, "{by_mu:?}");
}

fn whys_without_counts<B: UncertainBrake>(brake: &B) -> Why {
    let mut work = Workspace::default();
    let explainer = Explainer::new(brake, &brake.plan().scenes[0], &mut work).unwrap();
    let modes = explainer.asked_for(&mut work).unwrap();
    explainer.why(&modes[..1], &mut work).unwrap().remove(0)
}

#[test]
fn a_run_writes_the_derivatives_of_its_scenes() {
    let mut case = LatticeCase::read(&cases("two-by-two.toml")).unwrap();
    case.header.samples = 8;
    let (brake, folder) = (LatticeBrake::new(case).unwrap(), tempfile::tempdir().unwrap());
    run_study(&brake, folder.path(), Some(1), &mut |_, _, _| Ok(())).unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let table = read("sensitivities.csv");
    let scene = &brake.plan.scenes[0];
    assert!(scene.wants_work);
    let mut work = Workspace::default();
    let explainer = Explainer::new(&brake, scene, &mut work).unwrap();
    let modes = explainer.asked_for(&mut work).unwrap();
    for why in explainer.why(&modes, &mut work).unwrap() {
        for influence in &why.influences {
            let Influence { kind, name, unit, value, growth, .. } = influence;
            let expected = format!(",{kind},{name},{unit},{value},{growth},");
            assert!(table.contains(&expected), "{expected}");
        }
    }
    let summary = read("summary.md");
    let fastest = summary.lines().filter(|line| line.starts_with("- none, ") && line.contains(" grow")).count();
    assert!(summary.contains("\n## Why\n") && fastest > 0, "{summary}");
    assert!(!table.contains(",failed,"), "{table}");
}

/// A parameter that is at the only value that is allowed has no derivative: it is told as that, beside parameters that have one and alone.
#[test]
fn a_parameter_that_cannot_be_varied_is_told_as_such() {
    let constant = |name: &str, value: f64| {
        format!("[parameters.{name}]\nunit = \"1\"\ndistribution = \"constant\"\nvalue = {value}\n\n")
    };
    let held = "not varied, at an end of what is allowed: p";
    for (more, mu, words) in [("", "0.8", held.to_owned()), ("m", "m", format!(" 1/s, {held}"))] {
        let more = if more.is_empty() { String::new() } else { constant(more, 0.8) };
        let brake = hoffmann_with(&(constant("p", 1.0) + &more), &format!("{mu} + sqrt(0 - (p-1)^2)"), "0");
        let (table, told) = reasons_of(&brake);
        assert!(told.contains(&(words + "\n")) && !told.contains("no named parameter"), "{told}");
        let cells = |name: &str| table.column(name).unwrap().map(str::to_owned).collect::<Vec<String>>();
        let row = cells("kind").iter().position(|kind| kind == "not varied").unwrap();
        assert_eq!((cells("parameter")[row].as_str(), cells("d_growth")[row].as_str()), ("p", ""));
    }
}

/// The lattice of four oscillators about another friction, its modes named by one of both identities.
fn two_by_two(mu: f64, identity: &str) -> LatticeCase {
    let text = std::fs::read_to_string(cases("two-by-two.toml")).unwrap();
    let drawn = format!("from = {}, to = {}", 0.9 * mu, 1.1 * mu);
    let text = text.replace("from = 0.3, to = 0.7", &drawn).replace("mean = 0.45", "mean = 0.55");
    let text = text.replace("[readings]\n", &format!("[readings]\nidentity = \"{identity}\"\n"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text.replace("samples = 200", "samples = 4")).unwrap();
    LatticeCase::read(&path).unwrap()
}

/// Whatever names its modes have, one, several or none: by likeness, strong friction makes modes of which none at the origin is the like.
#[test]
fn every_growing_mode_has_its_reasons_and_the_fastest_is_the_fastest_of_all() {
    let (mut unnamed, mut silent) = (0, 0);
    for (mu, identity) in
        [(0.05, "mac"), (0.1, "mac"), (0.2, "mac"), (0.6, "mac"), (0.2, "continuation"), (0.6, "continuation")]
    {
        let (brake, folder) = (LatticeBrake::new(two_by_two(mu, identity)).unwrap(), tempfile::tempdir().unwrap());
        run_study(&brake, folder.path(), Some(1), &mut |_, _, _| Ok(())).unwrap();
        let table = output::Table::read(&folder.path().join("sensitivities.csv")).unwrap().unwrap();
        let column = |name: &str| table.column(name).unwrap().map(str::to_owned).collect::<Vec<_>>();
        let (growths, hertz) = (column("growth_rate"), column("frequency_hz"));
        let keys = ["constraints", "law", "speed", "in_contact", "arrangement"].map(column);
        unnamed += column("mode").iter().filter(|mode| *mode == "?").count();
        let summary = std::fs::read_to_string(folder.path().join("summary.md")).unwrap();
        for scene in brake.plan.scenes.iter().filter(|scene| scene.wants_work) {
            let system = brake.system(scene, &brake.median()).unwrap();
            let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap();
            let mut growing: Vec<Complex<f64>> =
                spectrum.eigenvalues.into_iter().filter(|of| of.im > 0.0 && of.re > 1e-9 * of.norm()).collect();
            let labels = &brake.plan.labels;
            let key = labels.mode_columns(scene.key, scene.members[0], squeal::study::ModeLabel::new(0));
            let is_of_scene = |row: &usize| keys.iter().zip(&key).all(|(column, of)| column[*row] == *of);
            let rows: Vec<Complex<f64>> = (0..growths.len())
                .filter(is_of_scene)
                .map(|row| Complex::new(growths[row].parse().unwrap(), TAU * hertz[row].parse::<f64>().unwrap()))
                .collect();
            for lambda in &growing {
                assert!(
                    rows.iter().any(|row| (row - lambda).norm() < 1e-9 * lambda.norm()),
                    "{mu} {identity}: {lambda}"
                );
            }
            growing.sort_by(|a, b| a.re.total_cmp(&b.re));
            let said = format!("- {}: ", brake.plan.describe(scene));
            let line = summary.lines().find(|line| line.starts_with(&said)).unwrap();
            let Some(fastest) = growing.last() else {
                silent += 1;
                assert!(line.ends_with("no oscillating mode surely grows at its medians"), "{line}");
                continue;
            };
            let hz = output::hertz(cea::frequency_hz(*fastest));
            let expected = format!(" at {hz} Hz, growth {} 1/s: ", output::significant(fastest.re, 4));
            assert!(line.contains(&expected), "{mu} {identity}: {line}: {expected}");
        }
    }
    assert!(unnamed > 0 && silent > 0, "{unnamed} {silent}");
}
