//! The shipped finite element brake: its modes against SciPy's, unreduced and reduced.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use brakes::FiniteElementBrake;
use brakes::case::{CaseFile, FiniteElementCase};
use nalgebra::Complex;
use squeal::study::{BandMode, DrawnInputs, ModeSource, Modifiable, Parametrised, Study, UncertainBrake};
use squeal::sweep::{Over, stability_map, sweep};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad")
}

/// The case with all patches in contact, one set of constraints, mu = 0.5 at its median, and modes up to 10 kHz.
fn nine_in_contact() -> FiniteElementCase {
    nine_with("vector")
}

/// The same with `contact.lateral`.
fn nine_with(lateral: &str) -> FiniteElementCase {
    let text = std::fs::read_to_string(folder().join("disc-pad.toml")).unwrap();
    let text = text.replace("load = 468.0", &format!("lateral = \"{lateral}\"\nload = 468.0"));
    let text = text.replace("in_contact = [9, 8]", "in_contact = [9]").replace("[500.0, 8000.0]", "[500.0, 10000.0]");
    let text = text.replace("residual = 1e-8", "residual = 1e-8\ntraining = 3").replace(", \"lugre\"]", "]");
    let held = text.find("[[constraints]]\nname = \"ends").unwrap();
    let text = format!("{}{}", &text[..held], &text[text.find("[[speeds]]").unwrap()..]);
    match CaseFile::parse(&folder().join("nine.toml"), text).unwrap() {
        CaseFile::FiniteElements(case) => *case,
        other => panic!("{other:?}"),
    }
}

/// The case with all patches in contact and without the first and the last, under two laws, without friction across the sliding: with it some
/// modes lose their names when patches open.
fn two_arrangements() -> FiniteElementCase {
    let text = std::fs::read_to_string(folder().join("disc-pad.toml")).unwrap();
    let contact = text.lines().find(|line| line.starts_with("in_contact")).unwrap();
    let text = text.replace(contact, "arrangements = [[1, 2, 3, 4, 5, 6, 7, 8, 9], [2, 3, 4, 5, 6, 7, 8]]");
    let full_checks = text.lines().find(|line| line.starts_with("full_checks")).unwrap();
    let text = text.replace(full_checks, "training = 16\nfull_checks = 4");
    let text = text.replace("load = 468.0", "lateral = \"none\"\nload = 468.0");
    let laws = text.lines().find(|line| line.starts_with("laws")).unwrap();
    let text = text.replace(laws, "laws = [\"amontons-coulomb\", \"lugre\"]");
    let held = text.find("[[constraints]]\nname = \"ends").unwrap();
    let text = format!("{}{}", &text[..held], &text[text.find("[[speeds]]").unwrap()..]);
    match CaseFile::parse(&folder().join("two.toml"), text).unwrap() {
        CaseFile::FiniteElements(case) => *case,
        other => panic!("{other:?}"),
    }
}

/// The eigenvalues of reference.csv, rad/s; its condition numbers are at most 2e5.
fn reference() -> Vec<Complex<f64>> {
    let text = std::fs::read_to_string(folder().join("reference.csv")).unwrap();
    let number = |field: Option<&str>| field.unwrap().parse::<f64>().unwrap();
    text.lines()
        .skip(1)
        .map(|line| {
            let mut fields = line.split(',');
            Complex::new(number(fields.next()), number(fields.next()))
        })
        .collect()
}

fn assert_equal_sets(found: &[Complex<f64>], tolerance: f64) {
    let reference = reference();
    assert_eq!(found.len(), reference.len(), "{found:?}");
    for expected in &reference {
        let nearest = found.iter().map(|l| (l - expected).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest <= tolerance * expected.norm(), "{expected}: {nearest:e}");
    }
}

#[test]
fn modes_of_the_whole_and_of_the_reduced_brake_are_those_of_scipy() {
    let brake = FiniteElementBrake::new(nine_in_contact(), &()).unwrap();
    let scene = &brake.plan.scenes[0];
    let at = brake.operating_point(scene, &brake.median()).unwrap();
    let (set, full) = (&brake.sets[0], brake.full_point(scene, &at));
    let rectangle = sparse::Rectangle { re: [-500.0, 1000.0], im: [500.0 * TAU, 10_000.0 * TAU] };
    let whole = set.system.assemble(&full).unwrap();
    let found = sparse::eigenpairs_in(&whole, &rectangle, &sparse::Options::default(), &mut |_| {}).unwrap();
    assert_equal_sets(&found.pairs.iter().map(|pair| pair.lambda).collect::<Vec<_>>(), 1e-11);
    assert!(found.pairs.iter().all(|pair| pair.backward_error < 1e-14));

    let modes = brake.part(scene).reduced.modes(&full).unwrap();
    assert_equal_sets(&modes.lambdas, 1e-6);
    assert!(modes.largest_residual() <= 10.0 * set.held_out_residual);
    // Friction alone can make it unstable: one mode of nine.
    assert_eq!(modes.lambdas.iter().filter(|lambda| lambda.re > 0.0).count(), 1);

    // Its parameters: friction, on whose speed and load the resistance across the sliding depends, and the stiffness of each patch.
    let [median, same] = [brake.system(scene, &brake.median()), brake.system_with(scene, &[])].map(Result::unwrap);
    assert!(
        (&median.k - &same.k).norm() <= 1e-12 * median.k.norm()
            && (&median.c - &same.c).norm() <= 1e-12 * median.c.norm()
    );
    let names: Vec<String> = brake.parameters(scene).into_iter().map(|parameter| parameter.name).collect();
    assert_eq!(
        (&names[..4], names.len()),
        (&["mu", "v", "load", "contact_stiffness.PATCH1"].map(String::from)[..], 12)
    );

    // Why the unstable mode grows: derivatives of the reduced brake are limits of differences.
    let mut work = cea::Workspace::default();
    let unstable = *modes.lambdas.iter().find(|lambda| lambda.re > 0.0).unwrap();
    let explainer = squeal::why::Explainer::new(&brake, scene, &mut work).unwrap();
    let why = explainer.why(&[unstable], &mut work).unwrap().remove(0);
    for place in [0, 1, 2, 3, 7] {
        let by = why.influences.iter().find(|influence| influence.name == names[place]).unwrap();
        let step = 1e-4 * by.value;
        let at = |value: f64| {
            let system = brake.system_with(scene, &[(place, value)]).unwrap();
            let all = cea::EigenSolver::eigenvalues(&cea::QrSolver, &system, &mut cea::Workspace::default()).unwrap();
            let distance = |l: &Complex<f64>| (l - unstable).norm();
            all.eigenvalues.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
        };
        let difference = (at(by.value + step) - at(by.value - step)) / (2.0 * step);
        let rate = Complex::new(by.growth, TAU * by.frequency_hz);
        assert!((rate - difference).norm() < 1e-4 * rate.norm() + 1e-9 * unstable.norm() / step, "{by:?} {difference}");
    }
    let sum: f64 = why.balance.families.iter().map(|family| family.growth).sum();
    assert!((sum - unstable.re).abs() < 1e-6 * unstable.re, "{sum} {unstable}");
}

#[test]
fn each_arrangement_has_a_basis_of_its_own_and_the_modes_of_the_whole_brake_under_their_names() {
    let brake = FiniteElementBrake::checked(two_arrangements(), &()).unwrap();
    assert_eq!((brake.sets.len(), brake.parts.len()), (1, 2));
    for part in &brake.parts {
        assert!(part.within.basis.ncols() < brake.sets[0].basis.ncols());
    }
    // Without two patches the brake has other modes, but the structure's are as many, and nearly all still look like themselves; the first twelve are those
    // of the band and next to it, others combinations that the basis has beyond.
    let study = Study::new(&brake, &cea::BatchSolver).unwrap();
    let open = |scene: usize| study.references()[scene].names.iter().take(12).filter(|names| names.len() != 1).count();
    for scene in 0..brake.plan.scenes.len() {
        let reference = &study.references()[scene];
        assert!(reference.modes.len() >= 12 && open(scene) <= 2, "{:?}", reference.names);
    }
    let found = brake.full_checks().unwrap();
    assert!(found.samples == 4 && found.modes >= 32, "{found:?}");
    assert_eq!((found.missing, found.invented, found.other_verdicts), (0, 0, 0), "{found:?}");
    assert!(found.largest_distance < 1e-5, "{found:?}");

    // What is attached needs one basis for all.
    let refused = brake.places(0).unwrap_err();
    let study::Error::Brake(refused) = refused else { panic!("{refused}") };
    assert!(matches!(refused.downcast_ref(), Some(brakes::Error::SeveralBases { .. })));
}

/// Names go from one arrangement to another along a bridge; under a law with internal states both its ends have those of their closed patches. No basis
/// contains what grows faster than it oscillates, or is damped more than the case wants.
#[test]
fn the_end_of_a_bridge_has_the_modes_of_its_arrangement_under_a_law_with_states() {
    let text = two_arrangements().header.text.replace("laws = [\"amontons-coulomb\", \"lugre\"]", "laws = [\"lugre\"]");
    let CaseFile::FiniteElements(case) = CaseFile::parse(&folder().join("lugre.toml"), text).unwrap() else { panic!() };
    let brake = FiniteElementBrake::new(*case, &()).unwrap();
    let study = Study::new(&brake, &cea::BatchSolver).unwrap();
    let modes = |configuration: usize| &study.references()[configuration].modes[..];
    let bridge = brake.bridge(1, [modes(0), modes(1)]).unwrap().unwrap();
    for (system, configuration) in [(&bridge.start, 0), (&bridge.end, 1)] {
        assert!(system.states() > 0);
        let found =
            cea::EigenSolver::eigenvalues(&cea::QrSolver, system, &mut cea::Workspace::default()).unwrap().eigenvalues;
        let held: Vec<_> = modes(configuration)
            .iter()
            .filter(|mode| mode.lambda.re > -500.0 && mode.lambda.re < mode.lambda.im)
            .collect();
        assert!(held.len() > 10, "{configuration}: {}", held.len());
        for mode in held {
            let distance = found.iter().map(|lambda| (lambda - mode.lambda).norm()).fold(f64::INFINITY, f64::min);
            // A bridge holds right vectors alone, whose errors eigenvalues there see to first order.
            assert!(distance < 5e-6 * mode.lambda.norm(), "{configuration}: {} {distance:e}", mode.lambda);
        }
    }
}

/// The case with all patches in contact and modes around 6 kHz alone.
fn around_six_kilohertz() -> FiniteElementCase {
    let mut case = nine_in_contact();
    case.reduction.frequencies = [5700.0, 6500.0];
    case
}

/// The case with nine patches in contact at a speed and a coefficient of friction, with or without friction across the sliding: frequencies, Hz,
/// and growth rates of the modes that grow.
fn growing(mu: f64, speed: f64, lateral: &str) -> Vec<(f64, f64)> {
    let text = nine_with(lateral).header.text;
    let text =
        text.replace("from = 0.1 ", &format!("from = {speed:e} ")).replace("to = 1.0", &format!("to = {speed:e}"));
    let text = text.replace("mean = 0.50", &format!("mean = {mu}"));
    let CaseFile::FiniteElements(case) = CaseFile::parse(&folder().join("growing.toml"), text).unwrap() else {
        panic!()
    };
    let brake = FiniteElementBrake::new(*case, &()).unwrap();
    let scene = &brake.plan.scenes[0];
    let at = brake.full_point(scene, &brake.operating_point(scene, &brake.median()).unwrap());
    let rectangle = sparse::Rectangle { re: [1.0, 1000.0], im: [500.0 * TAU, 8000.0 * TAU] };
    let whole = brake.sets[0].system.assemble(&at).unwrap();
    let found = sparse::eigenpairs_in(&whole, &rectangle, &sparse::Options::default(), &mut |_| {}).unwrap();
    let modes = brake.part(scene).reduced.modes(&at).unwrap();
    let grown: Vec<_> = modes.lambdas.iter().filter(|lambda| lambda.re > 1.0).collect();
    assert_eq!(grown.len(), found.pairs.len(), "{grown:?}");
    let mut all: Vec<_> = found.pairs.iter().map(|pair| (pair.lambda.im / TAU, pair.lambda.re)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    for ((f, growth), lambda) in all.iter().zip(grown) {
        assert!((Complex::new(*growth, TAU * f) - lambda).norm() < 1e-6 * lambda.norm());
    }
    all
}

/// Modes that grow at a coefficient of friction and a speed, without or with friction across the sliding.
type Grown<'a> = (f64, f64, &'a str, &'a [(f64, f64)]);

/// Numbers of the script in the case's README.
#[test]
fn friction_across_the_sliding_silences_the_lower_mode_as_in_scipy() {
    grow_as_in_scipy(&[
        (0.6, 0.1, "none", &[(2744.4, 223.4), (6030.6, 707.6)]),
        (0.6, 0.1, "vector", &[(6065.0, 690.6)]),
    ]);
}

/// `cargo test -p brake-squeal-brakes --test all finite_elements:: -- --ignored`
#[test]
#[ignore = "a minute"]
fn friction_across_the_sliding_is_that_of_scipy_at_higher_speeds() {
    grow_as_in_scipy(&[
        (0.6, 1.0, "vector", &[(6044.4, 641.0)]),
        (0.6, 10.0, "vector", &[(2750.7, 67.4), (6031.3, 695.1)]),
    ]);
}

fn grow_as_in_scipy(all: &[Grown<'_>]) {
    for &(mu, speed, lateral, expected) in all {
        let found = growing(mu, speed, lateral);
        assert_eq!(found.len(), expected.len(), "{speed} {lateral}: {found:?}");
        for ((f, growth), (expected_f, expected_growth)) in found.iter().zip(expected) {
            assert!((f - expected_f).abs() <= 0.051 && (growth - expected_growth).abs() <= 0.051, "{found:?}");
        }
    }
}

fn over(name: &str, from: f64, to: f64) -> Over {
    Over { name: name.into(), from, to }
}

#[test]
fn onsets_of_a_sweep_are_those_of_the_whole_brake() {
    let range = over("mu", 0.2, 0.6);
    let brake = FiniteElementBrake::for_sweep(around_six_kilohertz(), std::slice::from_ref(&range), &()).unwrap();
    let study = Study::new(&brake, &cea::QrSolver).unwrap();
    let found = sweep(&study, 0, &range, &cea::QrSolver, &()).unwrap();
    assert!(found.unstable_at_start == 0 && found.onsets.len() == 1, "{found:?}");
    let onset = &found.onsets[0];
    assert!(onset.starts && onset.error < 1e-8 && onset.moved.unwrap().abs() < 1e-4, "{onset:?}");
    assert!(found.evaluations.whole >= 2);
    // The whole brake, solved by another route, has a growing mode there on one side only, and near.
    let scene = &brake.plan.scenes[0];
    let growing = |mu: f64| {
        // All that Amontons-Coulomb friction does, along the sliding and across it, is proportional to mu.
        let mut at = brake.operating_point(scene, &brake.median()).unwrap();
        let by = mu / 0.5;
        at.channels.iter_mut().for_each(|gain| (gain.mu, gain.slope) = (by * gain.mu, by * gain.slope));
        let whole = brake.sets[0].system.assemble(&brake.full_point(scene, &at)).unwrap();
        let rectangle = sparse::Rectangle { re: [-1e-2, 1e-2], im: [0.999 * onset.omega, 1.001 * onset.omega] };
        let found = sparse::eigenpairs_in(&whole, &rectangle, &sparse::Options::default(), &mut |_| {}).unwrap();
        assert_eq!(found.pairs.len(), 1);
        found.pairs[0].lambda.re > 0.0
    };
    assert!(growing(onset.at + 1e-8) && !growing(onset.at - 1e-8));
    // Modes outside of the band are none of the brake's.
    let band = brake.plan.followed_band().unwrap();
    for branch in &found.branches {
        assert!(branch.points.iter().all(|(_, point)| (band[0]..=band[1]).contains(&point.lambda.im)));
    }
}

#[test]
fn the_boundary_of_a_map_is_that_of_the_whole_brake() {
    let both = [over("mu", 0.3, 0.5), over("contact_stiffness.PATCH5", 0.9, 1.1)];
    let brake = FiniteElementBrake::for_sweep(around_six_kilohertz(), &both, &()).unwrap();
    let study = Study::new(&brake, &cea::QrSolver).unwrap();
    let map = stability_map(&study, 0, &both, &cea::QrSolver, &()).unwrap();
    assert!(map.curves.len() == 1 && map.checks > 0, "{map:?}");
    assert!(map.from_whole.unwrap() < 1e-4, "{:?}", map.from_whole);
}

#[test]
fn a_sweep_over_what_the_scene_does_not_have_is_refused_before_anything_is_reduced() {
    for (range, allowed) in
        [(over("nu", 0.0, 1.0), "mu, v, load, contact_stiffness.PATCH1"), (over("mu", 1.0, 0.0), "FROM < TO")]
    {
        let error = FiniteElementBrake::for_sweep(around_six_kilohertz(), &[range], &()).unwrap_err().to_string();
        assert!(error.starts_with("over = ") && error.contains(allowed), "{error}");
    }
}

#[test]
fn a_drawn_contact_stiffness_is_that_of_all_patches_and_the_basis_holds_it() {
    let draw = "[parameters.wear]\nunit = \"1\"\ndistribution = \"uniform\"\nfrom = 0.5\nto = 1.5\n\n[contact]";
    let with = |field: &str| {
        let text = two_arrangements().header.text.replace("[contact]", draw);
        let text = text.replace("tolerance =", &format!("stiffness_factor = {field}\ntolerance ="));
        CaseFile::parse(&folder().join("worn.toml"), text.replace("[500.0, 8000.0]", "[5700.0, 6500.0]"))
    };
    let Ok(CaseFile::FiniteElements(case)) = with("\"20 * wear - 19\"") else { panic!() };
    // Half of the draws have no stiffness, which are counted; the median has the one that is given.
    let brake = FiniteElementBrake::checked(*case, &()).unwrap();
    let found = brake.full_checks().unwrap();
    assert!((1..4).contains(&found.failed), "{found:?}");
    let mut sample = brake.median();
    sample.values[0] = 0.5;
    let error = brake.system(&brake.plan.scenes[0], &sample).unwrap_err().to_string();
    assert!(error.contains("contact.stiffness_factor = -"), "{error}");

    let Ok(CaseFile::FiniteElements(case)) = with("\"wear\"") else { panic!() };
    let brake = FiniteElementBrake::checked(*case, &()).unwrap();
    for scene in &brake.plan.scenes {
        let names: Vec<String> = brake.parameters(scene).into_iter().map(|parameter| parameter.name).collect();
        let place = |name: &str| names.iter().position(|known| known == name).unwrap();
        let mut sample = brake.median();
        sample.values[0] = 1.25;
        let drawn = brake.system(scene, &sample).unwrap();
        let patches = names.iter().enumerate().filter(|(_, name)| name.starts_with("contact_stiffness"));
        let each: Vec<(usize, f64)> = patches.map(|(place, _)| (place, 1.25)).collect();
        for values in [each, vec![(place("wear"), 1.25)]] {
            let same = brake.system_with(scene, &values).unwrap();
            assert!((&drawn.k - &same.k).norm() <= 1e-12 * drawn.k.norm());
        }
    }
    let found = brake.full_checks().unwrap();
    assert!(found.samples == 4 && found.modes >= 1, "{found:?}");
    assert_eq!((found.missing, found.invented, found.other_verdicts), (0, 0, 0), "{found:?}");

    let Err(error) = with("\"were\"") else { panic!() };
    assert!(error.to_string().contains("contact.stiffness_factor") && error.to_string().contains("were"), "{error}");
}

#[test]
fn a_mode_that_grows_faster_than_the_case_says_is_found_and_counts_all_the_same() {
    for growth in [[-500.0, 300.0], [-20.0, 1.0]] {
        let mut case = nine_with("none");
        case.reduction.frequencies = [5700.0, 6500.0];
        case.reduction.growth = growth;
        let brake = FiniteElementBrake::new(case, &()).unwrap();
        let (scene, mut growing_modes) = (&brake.plan.scenes[0], 0);
        for mu in [0.3, 0.5, 0.8, 1.2] {
            let at = brake.operating_point(scene, &brake.single_parameter(scene).unwrap().sample(mu)).unwrap();
            let full = brake.full_point(scene, &at);
            let rectangle = sparse::Rectangle { re: [0.0, 20_000.0], im: [5700.0 * TAU, 6500.0 * TAU] };
            let whole = brake.sets[0].system.assemble(&full).unwrap();
            let whole = sparse::eigenpairs_in(&whole, &rectangle, &sparse::Options::default(), &mut |_| {}).unwrap();
            let growing = |lambda: &Complex<f64>| lambda.re > 0.0;
            let found = brake.band_modes(scene, std::slice::from_ref(&at)).remove(0).unwrap();
            let found: Vec<_> = found.iter().filter(|mode| growing(&mode.lambda)).collect();
            let listed = brake.part(scene).reduced.modes(&full).unwrap().lambdas;
            assert_eq!(found.len(), whole.pairs.len(), "{growth:?} {mu}: {found:?}");
            assert_eq!(listed.iter().filter(|lambda| growing(lambda)).count(), whole.pairs.len(), "{growth:?} {mu}");
            for (pair, mode) in whole.pairs.iter().zip(&found) {
                // Of friction that is not drawn the residual says what a mode is worth.
                let (distance, is_above) = ((mode.lambda - pair.lambda).norm(), mode.residual.unwrap().is_above);
                assert!(!is_above || mu != 0.5, "{growth:?} {mu}: {mode:?}");
                let most = if is_above { 1e-2 * pair.lambda.norm() } else { mode.bound };
                assert!(distance < most, "{growth:?} {mu}: {distance:e} {mode:?}");
            }
            growing_modes += whole.pairs.len();
        }
        assert!(growing_modes >= 2, "{growth:?}: {growing_modes}");
    }
}

#[test]
fn a_verdict_that_the_error_of_the_reduction_leaves_open_is_that_of_the_whole_brake() {
    let mut case = nine_with("none");
    case.reduction.frequencies = [5700.0, 6500.0];
    let mut brake = FiniteElementBrake::new(case, &()).unwrap();
    let scene = brake.plan.scenes[0].clone();
    let point = |brake: &FiniteElementBrake, mu: f64| {
        brake.operating_point(&scene, &brake.single_parameter(&scene).unwrap().sample(mu)).unwrap()
    };
    // The onset of the reduced brake, where its mode is on the axis.
    let grows = |mu: f64| {
        let at = brake.full_point(&scene, &point(&brake, mu));
        brake.part(&scene).reduced.modes(&at).unwrap().lambdas.iter().any(|lambda| lambda.re > 0.0)
    };
    let [mut below, mut above] = [0.2, 0.6];
    assert!(!grows(below) && grows(above));
    while above - below > 1e-12 {
        let middle = f64::midpoint(below, above);
        if grows(middle) { above = middle } else { below = middle }
    }
    let is_open = |mode: &&BandMode| mode.lambda.re.abs() <= mode.bound;
    let mut verdicts = Vec::new();
    for part in [-1e-5, -1e-6, 0.0, 1e-6, 1e-5] {
        let at = point(&brake, below * (1.0 + part));
        brake.case.reduction.full_verdicts = 0;
        let open = brake.band_modes(&scene, std::slice::from_ref(&at)).remove(0).unwrap();
        let open: Vec<&BandMode> = open.iter().filter(is_open).collect();
        assert_eq!(open.len(), 1, "{part}");
        brake.case.reduction.full_verdicts = 1;
        let settled = brake.band_modes(&scene, std::slice::from_ref(&at)).remove(0).unwrap();
        let near = |lambda: Complex<f64>| (lambda - open[0].lambda).norm() <= open[0].bound;
        let settled = settled.iter().find(|mode| near(mode.lambda)).unwrap();
        let whole = brake.sets[0].system.assemble(&brake.full_point(&scene, &at)).unwrap();
        let rectangle =
            sparse::Rectangle { re: [-20.0, 20.0], im: [-1.0, 1.0].map(|side| open[0].lambda.im + 20.0 * side) };
        let whole = sparse::eigenpairs_in(&whole, &rectangle, &sparse::Options::default(), &mut |_| {}).unwrap().pairs;
        assert_eq!(whole.len(), 1, "{part}");
        let distance = (settled.lambda - whole[0].lambda).norm();
        assert!(
            settled.bound < 1e-3 * open[0].bound && distance <= settled.bound + whole[0].bound,
            "{part}: {settled:?}"
        );
        // The reduced brake may be so near to the whole one that the onset of one is that of the other, up to the error of the latter.
        let is_at_onset = whole[0].lambda.re.abs() <= settled.bound + whole[0].bound;
        assert!(!is_open(&settled) || part == 0.0 && is_at_onset, "{part}: {settled:?}");
        verdicts.push(settled.lambda.re > 0.0);
    }
    assert!(!verdicts[0] && verdicts[4] && verdicts.is_sorted(), "{verdicts:?}");
    assert!(brake.routes().coarse > 0 && ModeSource::routes(&brake).contains(&("settled", 5)));
}

#[test]
fn a_band_without_modes_is_refused_by_its_name() {
    let text = two_arrangements().header.text.replace("[500.0, 8000.0]", "[600.0, 700.0]");
    let CaseFile::FiniteElements(case) = CaseFile::parse(&folder().join("quiet.toml"), text).unwrap() else { panic!() };
    let error = FiniteElementBrake::new(*case, &()).unwrap_err().to_string();
    assert!(
        error.contains("quiet.toml: reduction.frequencies = [600.0, 700.0]; allowed: a band with a mode"),
        "{error}"
    );
}

/// A spring that few draws have: none of those that a basis is made of may be among them.
///
/// `cargo test -p brake-squeal-brakes --test all finite_elements:: -- --ignored`
#[test]
#[ignore = "two minutes"]
fn a_reduction_that_draws_do_not_confirm_is_trained_on_whatever_the_number_of_samples() {
    let rare = "[[springs]]\nname = \"shim\"\nnodes = \"PADBACK\"\ndirection = [1.0, 0.0, 0.0]\nstiffness = 1e9\n\
                coefficient = \"is_there\"\n\
                [parameters.is_there]\ndistribution = \"discrete\"\nvalues = [0.0, 1.0]\nweights = [30, 1]\n";
    let poor = |full_checks: u64| {
        let text = two_arrangements()
            .header
            .text
            .replace("training = 16\nfull_checks = 4", &format!("training = 1\nfull_checks = {full_checks}"));
        let text = text.replace("[500.0, 8000.0]", "[5700.0, 8000.0]").replace("seed = 1\n", "seed = 2\n");
        match CaseFile::parse(&folder().join("poor.toml"), format!("{text}\n{rare}")).unwrap() {
            CaseFile::FiniteElements(case) => *case,
            other => panic!("{other:?}"),
        }
    };
    let unchecked = FiniteElementBrake::checked(poor(0), &()).unwrap();
    assert!(unchecked.full_checks().is_none());
    let brake = FiniteElementBrake::checked(poor(24), &()).unwrap();
    let found = brake.full_checks().unwrap();
    assert!(found.trained_on > 0 && found.missing + found.invented + found.other_verdicts == 0, "{found:?}");
    // Single pairs of nodes diverge under LuGre friction, which no training mends.
    assert!(found.divergence_where(|_| true).diverging > 0, "{found:?}");
    let columns = |brake: &FiniteElementBrake| brake.parts.iter().map(|part| part.within.basis.ncols()).sum::<usize>();
    assert!(columns(&brake) > columns(&unchecked));
    // Again, and with another number of samples: the same to the last bit.
    let mut seven = poor(24);
    seven.header.samples = 7;
    let again = FiniteElementBrake::checked(seven, &()).unwrap();
    for (one, other) in brake.parts.iter().zip(&again.parts) {
        assert!(one.within.basis == other.within.basis);
    }
}
