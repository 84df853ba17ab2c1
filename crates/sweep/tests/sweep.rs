//! Sweeps against closed forms and against themselves.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Mutex;

use brakes::MatricesBrake;
use brakes::case::{CaseFile, Law, MatricesCase};
use cea::{EigenSolver, QrSolver, Workspace};
use montecarlo::{Distribution, Progress};
use study::{Parametrised, Study, UncertainBrake};
use sweep::{BoundaryCurve, CurveEnd, Over, StabilityMap, Sweep, stability_map, sweep};

#[path = "../../squeal/tests/common/cases.rs"]
mod cases;
#[path = "sweep/kinds.rs"]
mod kinds;
#[path = "sweep/openings.rs"]
mod openings;
#[path = "sweep/tables.rs"]
mod tables;
#[path = "sweep/thresholds.rs"]
mod thresholds;

use cases::{cases, paper};

fn over(name: &str, from: f64, to: f64) -> Over {
    Over { name: name.into(), from, to }
}

fn matrices(path: &Path) -> MatricesCase {
    let CaseFile::Matrices(case) = CaseFile::read(path).unwrap() else { unreachable!("{path:?} has matrices") };
    *case
}

/// A case with matrices from a text.
fn written(text: &str) -> MatricesCase {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).unwrap();
    matrices(&path)
}

fn swept<B: UncertainBrake>(brake: &B, asked: &Over) -> Sweep {
    sweep(&Study::new(brake, &QrSolver).unwrap(), 0, asked, &QrSolver, &()).unwrap()
}

fn mapped<B: UncertainBrake>(brake: &B, asked: &[Over; 2]) -> StabilityMap {
    stability_map(&Study::new(brake, &QrSolver).unwrap(), 0, asked, &QrSolver, &()).unwrap()
}

/// Hoffmann's oscillator with its equal dashpots c as a second parameter, and friction as an expression in p.
fn hoffmann(friction: &str) -> MatricesCase {
    hoffmann_with(friction, 0.05, "")
}

/// Case with other dashpots, and with further tables.
fn hoffmann_with(friction: &str, c: f64, further: &str) -> MatricesCase {
    let text = std::fs::read_to_string(cases("hoffmann.toml")).unwrap();
    let text = text
        .replace("[parameters.mu]", "[parameters.c]\ndistribution = \"constant\"\nvalue = C\n[parameters.p]")
        .replace("value = C", &format!("value = {c:?}"))
        .replace("name = \"dashpots\"", "name = \"dashpots\"\ncoefficient = \"c\"")
        .replace("[[0.05, 0.0], [0.0, 0.05]]", "[[1.0, 0.0], [0.0, 1.0]]")
        .replace("mu = \"mu\"", &format!("mu = \"{friction}\""));
    written(&(text + further))
}

#[test]
fn hoffmanns_onset_and_coalescence_are_those_of_the_closed_form() {
    let found = swept(&MatricesBrake::new(matrices(&cases("hoffmann.toml"))).unwrap(), &over("mu", 0.0, 1.0));
    assert_eq!((found.onsets.len(), found.coalescences.len(), found.unstable_at_start), (1, 1, 0));
    let onset = &found.onsets[0];
    assert!((onset.at / (0.75 * (1.0 + 2.0 * 0.05 * 0.05)) - 1.0).abs() < 1e-12, "{onset:?}");
    assert!(onset.error < 1e-12 && onset.starts && onset.mode == "2", "{onset:?}");
    assert!((onset.omega - 2f64.sqrt()).abs() < 1e-10, "{onset:?}");
    let met = &found.coalescences[0];
    assert!((met.at - 0.75).abs() < 1e-10 && met.distance < 1e-10, "{met:?}");
    assert!((met.growth + 0.025).abs() < 1e-10, "{met:?}");
    // Before the coalescence both names are open.
    assert_eq!(found.branches.iter().filter(|branch| branch.mode == "1|2").count(), 4, "{:?}", found.ambiguities);
    // Beside the places at which modes are counted it halves its steps at the coalescence alone.
    assert!(found.evaluations.spectra <= 1_150 && found.fine_grid > 1_000_000, "{:?}", found.evaluations);
}

#[test]
fn sweeping_down_finds_the_onsets_of_sweeping_up() {
    let (up, down) = (hoffmann("p"), hoffmann("1.5-p"));
    let found = [up, down].map(|case| swept(&MatricesBrake::new(case).unwrap(), &over("p", 0.3, 1.2)).onsets.remove(0));
    assert!((found[0].at + found[1].at - 1.5).abs() < 1e-12, "{found:?}");
    assert!(found[0].starts && !found[1].starts, "{found:?}");
}

#[test]
fn hoffmanns_boundary_over_friction_and_damping_is_the_parabola() {
    let brake = MatricesBrake::new(hoffmann("p")).unwrap();
    let map = mapped(&brake, &[over("p", 0.5, 1.1), over("c", 0.01, 0.2)]);
    assert_eq!((map.curves.len(), map.unresolved), (1, 0));
    let curve = &map.curves[0];
    assert_eq!((curve.ends, curve.mode.as_str()), ([CurveEnd::Edge; 2], "2"));
    assert!(curve.points.len() > 30);
    for point in &curve.points {
        let [mu, c] = point.at;
        assert!((mu - 0.75 * (1.0 + 2.0 * c * c)).abs() < 1e-12, "{point:?}");
    }
    // Between the ends of c the curve goes from 0.75015 to 0.81.
    let area = (1.1 - 0.75 - 1.5 * (0.2f64.powi(3) - 0.01f64.powi(3)) / (3.0 * 0.19)) / 0.6;
    let unstable = map.regions.iter().find(|region| region.unstable == 1).unwrap();
    assert!((unstable.share - area).abs() < 2e-3, "{unstable:?} {area}");
}

/// One mass whose dashpot is negative inside of a circle about (0.5, 0.4).
fn circle(radius: f64) -> MatricesCase {
    written(&format!(
        "[study]\nname = \"circle\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\ndofs = [\"x\"]\n\
         [parameters.p]\ndistribution = \"uniform\"\nfrom = 0.0\nto = 1.0\n\
         [parameters.q]\ndistribution = \"uniform\"\nfrom = 0.0\nto = 1.0\n\
         [[terms]]\nname = \"mass\"\nmass = [[1.0]]\nstiffness = [[100.0]]\n\
         [[terms]]\nname = \"dashpot\"\ncoefficient = \"(p-0.5)^2+(q-0.4)^2-{:?}\"\ndamping = [[1.0]]\n\
         [[bodies]]\nname = \"mass\"\ndofs = [\"x\"]\n",
        radius * radius
    ))
}

#[test]
fn a_closed_boundary_is_found_and_followed_to_its_beginning() {
    let radius = 0.21;
    let map = mapped(&MatricesBrake::new(circle(radius)).unwrap(), &[over("p", 0.0, 1.0), over("q", 0.0, 1.0)]);
    assert_eq!(map.curves.len(), 1);
    assert_eq!(map.curves[0].ends, [CurveEnd::Closed; 2]);
    for point in &map.curves[0].points {
        assert!(((point.at[0] - 0.5).hypot(point.at[1] - 0.4) - radius).abs() < 1e-12, "{point:?}");
    }
    let inside = map.regions.iter().find(|region| region.unstable == 1).unwrap();
    assert!((inside.share - PI * radius * radius).abs() < 1e-3, "{inside:?}");
}

/// What is told while work lasts.
#[derive(Default)]
struct News(Mutex<Vec<String>>);

impl Progress for News {
    fn begin(&self, _: u64, _: u64) {}
    fn advance(&self, _: u64) {}
    fn end(&self) {}
    fn tell(&self, news: &str) {
        self.0.lock().unwrap().push(news.to_owned());
    }
}

#[test]
fn a_closed_boundary_between_all_lines_is_found_by_a_check_inside_or_beyond_the_stated_limit() {
    // The lines are 1/8 apart: the centre is at 0.44 of both ranges, between those at 0.375 and 0.5. Checks are 1/24 apart.
    for (radius, from, found) in [(0.03, 0.06, (1, 16)), (0.003, 0.08, (0, 8))] {
        let brake = MatricesBrake::new(circle(radius)).unwrap();
        let (asked, news) = ([over("p", from, from + 1.0), over("q", from - 0.1, from + 0.9)], News::default());
        let study = Study::new(&brake, &QrSolver).unwrap();
        let map = stability_map(&study, 0, &asked, &QrSolver, &news).unwrap();
        assert_eq!((map.curves.len(), map.grid), found);
        let news = news.0.into_inner().unwrap();
        assert_eq!(news.len(), usize::from(map.grid > 8), "{news:?}");
        let is_said = |news: &String| {
            news.contains("1 unstable modes and the map 0: a curve is missing")
                && news.contains("from 8 intervals to 16")
        };
        assert!(news.iter().all(is_said), "{news:?}");
    }
}

#[test]
fn points_of_a_boundary_are_onsets_of_sweeps_over_one_parameter() {
    let case = matrices(&cases("wobbling-disc.toml"));
    let brake = MatricesBrake::new(case.clone()).unwrap();
    let map = mapped(&brake, &[over("mu", 0.1, 0.9), over("Omega", 5.0, 100.0)]);
    assert_eq!(map.curves.len(), 1);
    let points = &map.curves[0].points;
    for point in points.iter().skip(1).step_by(points.len() / 5) {
        let mut case = case.clone();
        let omega = case.parameters.iter_mut().find(|parameter| parameter.name == "Omega").unwrap();
        omega.distribution = Distribution::Constant { value: point.at[1] };
        let onsets = swept(&MatricesBrake::new(case).unwrap(), &over("mu", 0.1, 0.9)).onsets;
        assert_eq!(onsets.len(), 1);
        // The onset is good to 1e-11 by its own bound, and so is the point.
        assert!((onsets[0].at - point.at[0]).abs() < 1e-9, "{point:?} {onsets:?}");
        assert!((onsets[0].omega - point.omega).abs() < 1e-6 * point.omega);
    }
}

#[test]
fn the_papers_onsets_are_those_of_docs_readings() {
    let brake = paper(Law::AmontonsCoulomb);
    let found = swept(&brake, &over("mu", 0.0, 1.3));
    let listed: Vec<(String, f64)> =
        found.onsets.iter().map(|onset| (onset.mode.clone(), (onset.at * 1000.0).ceil() / 1000.0)).collect();
    let modes = ["16", "20", "22", "13", "19", "1", "23"];
    let values = [0.324, 0.337, 0.461, 0.547, 0.610, 0.708, 0.782];
    let expected: Vec<(String, f64)> = modes.map(str::to_owned).into_iter().zip(values).collect();
    assert_eq!(listed, expected);
    assert!(found.onsets.iter().all(|onset| onset.starts && onset.error < 1e-11));
    // Spectra count one more mode past each, at a distance that is a thousandth of what the table prints of it.
    let scene = &brake.plan.scenes[0];
    let unstable = |mu: f64| {
        let system = brake.system_with(scene, &[(0, mu)]).unwrap();
        let spectrum = QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap();
        spectrum.oscillatory().filter(|lambda| lambda.re > 0.0).count()
    };
    for (before, onset) in found.onsets.iter().enumerate() {
        assert_eq!([unstable(onset.at - 1e-10), unstable(onset.at + 1e-10)], [before, before + 1], "{onset:?}");
    }
    // Of five sectors.
    assert!(found.evaluations.spectra <= 5 * 1025 + 600, "{:?}", found.evaluations);
}

#[test]
fn a_map_of_the_paper_contradicts_no_spectrum() {
    let brake = paper(Law::VelocityDependent);
    let map = mapped(&brake, &[over("mu_k", 0.2, 0.5), over("v", 0.1, 10.0)]);
    assert!(map.parameters[1].is_logarithmic && !map.parameters[0].is_logarithmic);
    let words = map.share_in_words().unwrap();
    assert!(words.contains("whose axis of v is logarithmic"), "{words}");
    assert!(sweep::Found::Map(Box::new(map.clone())).text().contains(&words));
    assert!(map.checks > 100 && map.unresolved == 0);
    assert!(map.curves.iter().all(|curve| curve.ends == [CurveEnd::Edge; 2]));
    assert!(map.regions.len() > 8 && map.evaluations.spectra <= 12_000, "{:?}", map.evaluations);
}

#[test]
fn medians_give_the_median_system_and_laws_have_their_own_parameters() {
    for law in Law::ALL {
        let brake = paper(law);
        let scene = &brake.plan.scenes[0];
        let parameters = brake.parameters(scene);
        let median = brake.system(scene, &brake.median()).unwrap();
        for (place, parameter) in parameters.iter().enumerate() {
            let found = brake.system_with(scene, &[(place, parameter.median)]).unwrap();
            assert!((&found.k - &median.k).norm() <= 1e-14 * median.k.norm(), "{law} {parameter:?}");
            assert!((&found.c - &median.c).norm() <= 1e-14 * median.c.norm(), "{law} {parameter:?}");
            let other = brake.system_with(scene, &[(place, 0.9 * parameter.median)]);
            let differs = match other {
                Ok(other) => other != median,
                Err(study::Error::Friction(_)) => parameter.name == "mu_s" || parameter.median == 0.0,
                Err(_) => false,
            };
            assert!(differs || parameter.median == 0.0, "{law} {parameter:?}");
        }
        let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        assert_eq!(names.contains(&"mu"), law == Law::AmontonsCoulomb, "{law}: {names:?}");
        assert_eq!(names.contains(&"v"), law != Law::AmontonsCoulomb, "{law}: {names:?}");
        assert_eq!(names.contains(&"sigma0"), law == Law::LuGre, "{law}: {names:?}");
        assert!(!names.contains(&"x_stiffness"), "its springs differ: {names:?}");
    }
}

/// Friction the other way round: det K = 4 - 1 - 4 mu / 3 vanishes at 2.25, where a real eigenvalue becomes positive.
#[test]
fn a_divergence_is_an_onset_at_zero_hertz() {
    let text = std::fs::read_to_string(cases("hoffmann.toml")).unwrap();
    let turned = text.replace("{ y = 1.3333333333333333 }", "{ y = -1.3333333333333333 }");
    assert_ne!(text, turned);
    let brake =
        |text: &str| MatricesBrake::new(MatricesCase::parse(&cases("hoffmann.toml"), text.into()).unwrap()).unwrap();
    let found = swept(&brake(&turned), &over("mu", 0.5, 3.0));
    let [onset] = &found.onsets[..] else { panic!("{:?}", found.onsets) };
    assert!((onset.at - 2.25).abs() <= onset.error && onset.error < 1e-13, "{onset:?}");
    assert_eq!((onset.mode.as_str(), onset.omega, onset.starts), ("divergence", 0.0, true));
    assert_eq!((found.diverging_at_start, onset.unstable), (0, 1));
    let beyond = swept(&brake(&turned), &over("mu", 2.5, 3.0));
    assert!(beyond.diverging_at_start == 1 && beyond.unstable_at_start == 1 && beyond.onsets.is_empty());
    // With friction that falls it ends.
    let text = turned.replace("mu = \"mu\"", "mu = \"3 - mu\"");
    let found = swept(&brake(&text), &over("mu", 0.0, 2.0));
    assert!(found.diverging_at_start == 1 && found.onsets.len() == 1);
    assert!((found.onsets[0].at - 0.75).abs() <= found.onsets[0].error && !found.onsets[0].starts);
}

/// With a spring s in both directions and friction the other way round `det K = (2 + s)^2 - (1 + 4 mu / 3)`; before the mass diverges it
/// flutters where `-(1 + 4 mu / 3) > (2 + s) c^2`.
#[test]
fn the_boundary_of_divergence_in_a_map_is_the_curve_on_which_det_k_vanishes() {
    let text = std::fs::read_to_string(cases("hoffmann.toml")).unwrap();
    for damping in [0.05, 0.4] {
        let text = text
            .replace("{ y = 1.3333333333333333 }", "{ y = -1.3333333333333333 }")
            .replace("[[0.05, 0.0], [0.0, 0.05]]", &format!("[[{damping}, 0.0], [0.0, {damping}]]"))
            .replace(
                "[[contacts]]",
                "[parameters.s]\ndistribution = \"uniform\"\nfrom = 0.0\nto = 0.4\n\
                 [[terms]]\nname = \"spring\"\ncoefficient = \"s\"\nstiffness = [[1.0, 0.0], [0.0, 1.0]]\n[[contacts]]",
            );
        let brake = MatricesBrake::new(MatricesCase::parse(&cases("hoffmann.toml"), text).unwrap()).unwrap();
        let map = mapped(&brake, &[over("mu", -4.0, 4.0), over("s", 0.0, 0.4)]);
        // Steps next to mu = -3/4, where both frequencies meet, may stay open.
        assert_eq!(map.curves.len(), 2);
        let diverging = |curve: &&BoundaryCurve| curve.mode == "divergence";
        let (divergence, flutter): (Vec<_>, Vec<_>) = map.curves.iter().partition(diverging);
        assert_eq!((divergence.len(), divergence[0].ends), (1, [CurveEnd::Edge; 2]));
        for point in &divergence[0].points {
            let [mu, s] = point.at;
            assert!(((2.0 + s).powi(2) - (1.0 + 4.0 * mu / 3.0)).abs() < 1e-11 && point.omega == 0.0, "{point:?}");
        }
        for point in &flutter[0].points {
            let [mu, s] = point.at;
            assert!((mu + 0.75 * (1.0 + (2.0 + s) * damping * damping)).abs() < 1e-11, "{point:?}");
        }
        // On the right of the curve of divergence, between mu = 2.25 and 3.57, one mode is unstable; on the left of that of flutter too.
        let mut shares: Vec<f64> = map.regions.iter().filter(|it| it.unstable == 1).map(|it| it.share).collect();
        shares.sort_by(f64::total_cmp);
        let diverges = (4.0 - 0.75 * ((2.4f64.powi(3) - 8.0) / (3.0 * 0.4) - 1.0)) / 8.0;
        let flutters = (4.0 - 0.75 * (1.0 + 2.2 * damping * damping)) / 8.0;
        assert!((shares[0] - diverges).abs() < 2e-3 && (shares[1] - flutters).abs() < 2e-3, "{shares:?}");
    }
}
