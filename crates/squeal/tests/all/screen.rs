//! Screening: what changes do is what closed forms and the lattice itself say.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use std::path::{Path, PathBuf};

use brakes::case::{LatticeCase, MatricesCase};
use brakes::{LatticeBrake, MatricesBrake, lattice, sliding};
use num_complex::Complex;
use squeal::cea::{EigenSolver, QrSolver, Workspace};
use squeal::cycles::{CycleOptions, cycles};
use squeal::linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
use squeal::montecarlo::{Experiment as _, StreamRng, stream};
use squeal::osc_model::{Brake, ContactArrangement};
use squeal::results::Results;
use squeal::screen::{
    Attached, Candidates, Change, ChangeKind, ChangeSet, Confirmation, Criterion, Modified, Screen, ScreenOptions,
    ScreenedSet, Sizes, confirm, rank,
};
use squeal::study::{Configuration, LawLabel, Origin, PanelLabel, Plan, Scene, SpeedLabel, Study, UncertainBrake};

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name)
}

fn options(kinds: &[ChangeKind], up_to: usize) -> ScreenOptions {
    let sizes = Sizes { mass: Some(1.0), spring: Some(0.8), dashpot: Some(1.0), factor: Some(1.25) };
    let mut options = ScreenOptions::default();
    (options.kinds, options.sizes, options.up_to) = (kinds.to_vec(), sizes, up_to);
    (options.draws, options.confirmed) = (400, 2);
    options
}

fn screened<B: UncertainBrake>(brake: &B, options: &ScreenOptions, samples: u64) -> Screen {
    let how = Confirmation::new(samples).with_threads(Some(2));
    confirm(brake, rank(brake, options, &()).unwrap(), options, &how).unwrap()
}

fn found<'a>(screen: &'a Screen, kind: ChangeKind, places: &str) -> &'a ScreenedSet {
    let all = || screen.sets.iter().map(|set| set.places.as_str()).collect::<Vec<_>>();
    let found = screen.sets.iter().find(|set| set.kind == Some(kind) && set.places == places);
    found.unwrap_or_else(|| panic!("{places}: {:?}", all()))
}

/// With dashpots c_x and c_y and a spring k in x, `(s^2 + c_x s + 2 + k) (s^2 + c_y s + 2) = 1 - D` at `D = mu k_3`. On the axis
/// - without the spring `s^2 = -2` and `D = 1 + 2 c_x c_y`;
/// - with equal dashpots `u (u + k) = 1 - D` with `u = s^2 + c s + 2`, so that `D = 1 + k^2 / 4 + c^2 (2 + k / 2)`;
/// - with masses 1 + m in both directions `D = 1 + 2 c^2 / (1 + m)`;
/// - with dashpots of f times their size `D = 1 + 2 (f c)^2`;
/// - with springs of f times their stiffness `(s^2 + c s + 2 f)^2 = f (f - D)`, as what friction reads stays, and `D = f + 2 c^2`;
/// - where the mass goes with them `D = f + 2 c^2 / f`.
///
/// The case's comments derive the first for equal dashpots.
#[test]
fn hoffmanns_oscillator_does_with_changes_what_closed_forms_say() {
    let path = case("hoffmann.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let brake = MatricesBrake::new(MatricesCase::parse(&path, text).unwrap()).unwrap();
    let screen = screened(&brake, &options(&ChangeKind::ALL, 2), 4000);
    let occurrence = |d: f64| ((1.1 - d * 0.75) / 0.6).clamp(0.0, 1.0);
    let c = 0.05_f64;
    let now = occurrence(1.0 + 2.0 * c * c);
    for (kind, places, d) in [
        (ChangeKind::Dashpot, "x", 1.0 + 2.0 * (c + 1.0) * c),
        (ChangeKind::Dashpot, "y", 1.0 + 2.0 * (c + 1.0) * c),
        (ChangeKind::Dashpot, "x y", 1.0 + 2.0 * (c + 1.0).powi(2)),
        (ChangeKind::Spring, "x", 1.0 + 0.16 + c * c * 2.4),
        (ChangeKind::Spring, "y", 1.0 + 0.16 + c * c * 2.4),
        (ChangeKind::Mass, "mass", 1.0 + c * c),
        (ChangeKind::Constraint, "x", f64::INFINITY),
        (ChangeKind::Constraint, "y", f64::INFINITY),
        (ChangeKind::Contact, "belt", f64::INFINITY),
        (ChangeKind::Scale, "springs.stiffness x 1.25", 1.25 + 2.0 * c * c),
        (ChangeKind::Scale, "springs.all x 1.25", 1.25 + 2.0 * c * c / 1.25),
        (ChangeKind::Scale, "springs.all x 1.25 dashpots.damping x 1.25", 1.25 + 2.0 * 1.25 * c * c),
    ] {
        let (set, left) = (found(&screen, kind, places), occurrence(d));
        let confirmed = set.confirmed.as_ref().unwrap();
        let drop = confirmed.drop;
        // Five times the 95 % interval, or some samples next to the onset where none may be between the two.
        let slack = 2.0 * (drop.upper - drop.lower) + 2e-3;
        assert!((drop.value - (now - left)).abs() < slack, "{kind:?} {places}: {drop:?} {}", now - left);
        assert!((confirmed.unstable.value - left).abs() < 0.04, "{kind:?} {places}: {confirmed:?} {left}");
        assert_eq!(confirmed.unstable.value, confirmed.squealing.value);
        let predicted = set.predicted_drop(&screen.unchanged, Criterion::Occurrence).unwrap();
        assert!((predicted - (now - left)).abs() < 0.1, "{kind:?} {places}: {predicted} {}", now - left);
    }
    // A part is scaled once.
    assert!(screen.sets.iter().all(|set| set.places.matches("springs").count() < 2));
    let all: Vec<String> = screen.tables()[1].rows.iter().map(|row| format!("{} less {}", row[0], row[1])).collect();
    assert_eq!(all.iter().collect::<std::collections::BTreeSet<_>>().len(), all.len(), "each pair of changes once");
    // Two degrees of freedom cannot both be held.
    assert!(
        screen.failed.iter().any(|(places, why)| places == "x y" && why.contains("constrained")),
        "{:?}",
        screen.failed
    );
    assert!(screen.difference(&screen.sets[0], found(&screen, ChangeKind::Constraint, "x")).unwrap().lower > 0.5);
}

/// At a coefficient mu = 1.07, below which 95 % of the draws lie, the growth of `(s^2 + c_x s + 2 + k) (s^2 + c_y s + 2) = 1 - D`.
#[test]
fn the_growth_that_95_percent_of_the_draws_do_not_exceed_is_that_of_the_quantile_of_friction() {
    let path = case("hoffmann.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let brake = MatricesBrake::new(MatricesCase::parse(&path, text).unwrap()).unwrap();
    let mut options = options(&[ChangeKind::Dashpot, ChangeKind::Spring, ChangeKind::Contact], 2);
    options.criterion = Criterion::GrowthQuantile;
    let screen = screened(&brake, &options, 4000);
    let matrix = |entries: [f64; 4]| nalgebra::DMatrix::from_row_slice(2, 2, &entries);
    let growth = |[c_x, c_y, k]: [f64; 3]| {
        let d = 1.07 / 0.75;
        let k = matrix([2.0 + k, 1.0, 1.0 - d, 2.0]);
        let system = SecondOrder::new(matrix([1.0, 0.0, 0.0, 1.0]), matrix([c_x, 0.0, 0.0, c_y]), k).unwrap();
        let found = QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap();
        found.eigenvalues.iter().map(|lambda| lambda.re).fold(0.0, f64::max)
    };
    let c = 0.05;
    let unchanged = growth([c, c, 0.0]);
    let agrees = |set: &ScreenedSet, growth: f64| {
        let confirmed = set.confirmed.as_ref().unwrap();
        let (left, drop) = (confirmed.growth_quantile, confirmed.growth_quantile_drop);
        // 0.05 of the draws give or take 0.0085 are beyond it.
        assert!((left.value - growth).abs() < 0.02 * unchanged, "{}: {left:?} {growth}", set.places);
        assert!(left.lower <= growth * (1.0 + 1e-3) && left.upper >= growth * (1.0 - 1e-3), "{left:?} {growth}");
        assert!(drop.lower <= unchanged - growth + 1e-9 && drop.upper >= unchanged - growth - 1e-9, "{drop:?}");
        let predicted = set.prediction.unwrap().growth_quantile;
        assert!((predicted - growth).abs() < 0.1 * unchanged, "{}: {predicted} {growth}", set.places);
    };
    agrees(&screen.sets[0], unchanged);
    for (kind, places, growth) in [
        (ChangeKind::Dashpot, "x", growth([c + 1.0, c, 0.0])),
        (ChangeKind::Dashpot, "y", growth([c, c + 1.0, 0.0])),
        (ChangeKind::Dashpot, "x y", growth([c + 1.0, c + 1.0, 0.0])),
        (ChangeKind::Spring, "x", growth([c, c, 0.8])),
        (ChangeKind::Contact, "belt", 0.0),
    ] {
        agrees(found(&screen, kind, places), growth);
    }
}

/// Of each change the motion of the changed case at the two draws between which 95 % of 80 lie: more friction is louder.
#[test]
fn the_loudness_that_95_percent_of_the_draws_do_not_exceed_is_that_of_the_changed_case() {
    const SAMPLES: u64 = 80;
    let path = case("hoffmann.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let brake = MatricesBrake::new(MatricesCase::parse(&path, text.clone()).unwrap()).unwrap();
    let mut options = options(&[ChangeKind::Dashpot, ChangeKind::Spring, ChangeKind::Contact], 1);
    (options.draws, options.criterion) = (10, Criterion::Loudness);
    let screen = screened(&brake, &options, SAMPLES);
    let mut mu: Vec<f64> = (0..SAMPLES).map(|at| brake.draw(&mut stream(brake.plan.seed, at)).unwrap()[0]).collect();
    mu.sort_by(f64::total_cmp);
    let loudness = |mu: f64, given: &str, changed: &str| {
        let frozen = format!("distribution = \"constant\"\nvalue = {mu:?}\n");
        let text = text.replace("distribution = \"uniform\"\nfrom = 0.5\nto = 1.1\n", &frozen).replace(given, changed);
        let brake = MatricesBrake::new(MatricesCase::parse(&path, text).unwrap()).unwrap();
        let found = cycles(&brake, &brake.plan.scenes[0], &CycleOptions::default(), None, &()).unwrap();
        found.motions[0].measures.as_ref().unwrap().rms_of(&[0, 1])
    };
    // Ranks from 0 of which the quantile is a mean.
    let (position, rank) = (0.95 * (SAMPLES - 1) as f64, 75);
    let part = position - rank as f64;
    assert!((0.0..1.0).contains(&part));
    let mut left_of = Vec::new();
    for (set, given, changed) in [
        (&screen.sets[0], "", ""),
        (found(&screen, ChangeKind::Dashpot, "x"), "[[0.05, 0.0]", "[[1.05, 0.0]"),
        (found(&screen, ChangeKind::Dashpot, "y"), "[0.0, 0.05]]", "[0.0, 1.05]]"),
        (found(&screen, ChangeKind::Spring, "x"), "stiffness = [[2.0,", "stiffness = [[2.8,"),
    ] {
        assert!(given.is_empty() || text.contains(given), "{given}");
        let expected =
            (1.0 - part) * loudness(mu[rank], given, changed) + part * loudness(mu[rank + 1], given, changed);
        let confirmed = set.confirmed.as_ref().unwrap();
        let left = confirmed.loudness_quantile.unwrap();
        assert!((left.value - expected).abs() < 1e-3 * expected, "{}: {left:?} {expected}", set.places);
        assert!(left.lower <= expected && expected <= left.upper && left.upper.is_finite(), "{left:?}");
        assert_eq!(confirmed.not_followed, Some(0));
        left_of.push(expected);
    }
    let drop = found(&screen, ChangeKind::Spring, "x").confirmed.as_ref().unwrap().loudness_quantile_drop.unwrap();
    assert!((drop.value - (left_of[0] - left_of[3])).abs() < 1e-3 * left_of[0], "{drop:?} {left_of:?}");
    // Without its contact the oscillator is silent.
    let contact = found(&screen, ChangeKind::Contact, "belt");
    assert_eq!(contact.confirmed.as_ref().unwrap().loudness_quantile.unwrap().value, 0.0);
    assert_eq!(contact.prediction.unwrap().loudness_quantile, Some(0.0));
    // The same dashpot damps in one direction and destabilises in the other; the first is ranked before.
    let rank_of =
        |places: &str| screen.sets.iter().position(|set| set.kind == Some(ChangeKind::Dashpot) && set.places == places);
    assert!(rank_of("x") < rank_of("y") && left_of[1] < left_of[0] && left_of[0] < left_of[2], "{left_of:?}");
    // Nothing is followed that is not asked for.
    options.criterion = Criterion::GrowthQuantile;
    let other = screened(&brake, &options, 10);
    assert!(other.sets.iter().filter_map(|set| set.confirmed.as_ref()).all(|of| of.loudness_quantile.is_none()));
}

#[test]
fn a_brake_that_gives_no_contacts_is_not_ranked_by_loudness() {
    let own = Row::new();
    let mut options = options(&[ChangeKind::Contact], 1);
    options.criterion = Criterion::Loudness;
    let Err(error) = rank(&own, &options, &()) else { panic!("not refused") };
    assert_eq!(
        error.to_string(),
        "the motion after the onset needs drawn_contacts of the brake, which its type does not give"
    );
}

#[test]
fn changes_of_a_lattice_have_the_motion_whose_tangent_is_their_analysis() {
    let brake = two_by_two();
    let of_place = |change| ChangeSet { name: format!("{change:?}"), of: 0, changes: vec![change] };
    let sets: Vec<ChangeSet> = [
        Change::Hold { dof: 3 },
        Change::TakeOut { contact: 1 },
        Change::Attach { what: Attached::Mass, size: 0.3, along: vec![vec![(0, 1.0)]] },
        Change::Attach { what: Attached::Dashpot, size: 30.0, along: vec![vec![(2, 1.0), (5, -1.0)]] },
    ]
    .into_iter()
    .map(of_place)
    .collect();
    let modified = Modified::new(&brake, &sets).unwrap();
    let contacts = modified.drawn_contacts().unwrap();
    for scene in &modified.plan().scenes {
        for at in 0..3 {
            let sample = modified.draw(&mut stream(1, at)).unwrap();
            let system = contacts.contact_system_of(scene, &sample, 0.01).unwrap();
            let of_cea = modified.system(scene, &sample).unwrap();
            let deviation = system.check_tangent(&of_cea, 1e4).unwrap();
            assert!(deviation < 1e-13, "{}: {deviation}", modified.plan().describe(scene));
        }
    }
}

#[test]
fn singles_are_ranked_by_the_criterion() {
    let brake = two_by_two();
    let mut orders = Vec::new();
    // Loudness, which takes long on a lattice, is asked of a smaller brake.
    for criterion in [Criterion::Occurrence, Criterion::Probability, Criterion::GrowthQuantile] {
        let mut options = options(&ChangeKind::ALL, 1);
        (options.draws, options.criterion) = (8, criterion);
        let ranking = rank(&brake, &options, &()).unwrap();
        for of_kind in &ranking.kinds {
            let values: Vec<f64> =
                of_kind.singles.iter().map(|ranked| criterion.predicted(&ranked.prediction)).collect();
            assert!(values.is_sorted(), "{criterion:?}: {values:?}");
        }
        let singles = ranking.kinds.iter().flat_map(|of_kind| &of_kind.singles);
        orders.push(singles.map(|ranked| ranked.singles.clone()).collect::<Vec<_>>());
    }
    assert!(orders[0] != orders[2], "{orders:?}");
    let few = screened(&brake, &options(&[ChangeKind::Contact], 1), 10);
    let growth = few.as_it_is().unwrap().growth_quantile;
    assert!(growth.value > 0.0 && growth.upper.is_infinite(), "no limit of ten samples: {growth:?}");
}

fn two_by_two() -> LatticeBrake {
    let mut case = LatticeCase::read(&case("two-by-two.toml")).unwrap();
    case.header.samples = 40;
    LatticeBrake::new(case).unwrap()
}

/// The 2 x 2 pad under Amontons-Coulomb friction with these lines of its case.
fn two_by_two_with(lines: &[(&str, &str)]) -> LatticeCase {
    let path = case("two-by-two.toml");
    let mut text = std::fs::read_to_string(&path).unwrap();
    for (from, to) in [&[("laws = [\"amontons-coulomb\", \"lugre\"]", "laws = [\"amontons-coulomb\"]")], lines].concat()
    {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    LatticeCase::parse(&path, text).unwrap()
}

#[test]
fn a_change_is_judged_at_its_own_place_where_the_arrangements_have_no_symmetry() {
    let mut left = Vec::new();
    for oscillator in 1..=4 {
        let arrangement = format!("arrangements = [[{oscillator}]]");
        let brake = LatticeBrake::new(two_by_two_with(&[("in_contact = [4, 3]", &arrangement)])).unwrap();
        let mut options = options(&[ChangeKind::Dashpot], 1);
        (options.sizes, options.draws) = (Sizes::default(), 40);
        let ranking = rank(&brake, &options, &()).unwrap();
        let best = &ranking.kinds[0].singles[0];
        assert_eq!(ranking.kinds[0].candidates.name(&best.singles), format!("z{oscillator}"));
        left.push(best.prediction.unstable);
    }
    assert!(left.iter().all(|of| (of - left[0]).abs() < 1e-12), "{left:?}");
}

#[test]
fn the_fastest_mode_of_a_draw_is_sought_in_all_arrangements() {
    // A mass that is off by a billionth leaves no symmetry, and the same draws.
    let lines = [("in_contact = [4, 3]", "in_contact = [1]"), ("draws = \"shared\"", "draws = \"each\"")];
    let whole = two_by_two_with(&lines);
    let off = ("oscillator_mass = 0.5 ", "oscillator_mass = [0.5, 0.5000000005, 0.5, 0.5] ");
    let without = two_by_two_with(&[lines[0], lines[1], off]);
    let mut options = options(&[ChangeKind::Dashpot], 1);
    (options.draws, options.criterion, options.confirmed) = (4, Criterion::GrowthQuantile, 0);
    let shared = LatticeBrake::new(whole.clone()).unwrap();
    assert!(
        rank(&shared, &options, &()).is_err_and(|error| error.to_string().contains("a scene for each arrangement"))
    );
    let [alike, apart] =
        [LatticeBrake::of_equal_draws(whole).unwrap(), LatticeBrake::new(without).unwrap()].map(|brake| {
            let screen = screened(&brake, &options, 200);
            screen.as_it_is().unwrap().growth_quantile
        });
    assert!((alike.value - apart.value).abs() < 1e-5 * apart.value, "{alike:?} {apart:?}");
}

#[test]
fn a_constraint_of_the_screening_is_a_constraint_of_the_case() {
    // The case's own set is laid out by the lattice, with its smaller symmetry; the screening divides the scenes of the brake as it is.
    let brake = two_by_two();
    let mut options = options(&[ChangeKind::Constraint], 2);
    (options.draws, options.confirmed) = (3, 8);
    let screen = screened(&brake, &options, 40);
    let own = &screen.sets[1];
    assert_eq!((own.places.as_str(), own.count), ("first-row", 2));
    let hold = |dofs: &[usize]| ChangeSet {
        name: "first row".into(),
        of: 0,
        changes: dofs.iter().map(|&dof| Change::Hold { dof }).collect(),
    };
    let none = ChangeSet { name: "none".into(), of: 1, changes: Vec::new() };
    let modified = Modified::new(&brake, &[hold(&[0, 3]), none]).unwrap();
    let solver = squeal::cea::BatchSolver;
    let study = squeal::study::Study::new(&modified, &solver).unwrap();
    let mut scratch = squeal::study::Scratch::default();
    let (mut counts, mut unstable) = ([Vec::new(), Vec::new()], 0);
    for index in 0..20 {
        let sample = study.draw(&mut stream(7, index)).unwrap();
        let mut sums = [0, 0];
        for (at, scene) in study.plan().scenes.iter().enumerate() {
            let modes = study.evaluate(at, &sample, &mut scratch).unwrap().unstable.len() * scene.members.len();
            sums[scene.key.constraints] += modes;
            unstable += modes;
        }
        (0..2).for_each(|set| counts[set].push(sums[set]));
    }
    assert_eq!(counts[0], counts[1]);
    assert!(unstable > 100, "{unstable}");
}

/// The system of each member of each scene with some changes, as the study of the modified brake computes it at its medians.
fn systems(brake: &LatticeBrake, changes: Vec<Change>) -> Vec<(String, SecondOrder)> {
    let set = ChangeSet { name: "changed".into(), of: 0, changes };
    let modified = Modified::new(brake, &[set]).unwrap();
    let plan = modified.plan();
    let mut all = Vec::new();
    for scene in &plan.scenes {
        let system = modified.system(scene, &modified.median()).unwrap();
        let panel = &plan.labels.panels[scene.key.panel];
        for &member in &scene.members {
            let [_, law, speed] = plan.labels.key_columns(scene.key);
            all.push((format!("{law} {speed} {}", panel.arrangements[member]), system.clone()));
        }
    }
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

fn spectrum(system: &SecondOrder) -> Vec<(f64, f64)> {
    let found = QrSolver.eigenvalues(system, &mut Workspace::default()).unwrap();
    let mut all: Vec<(f64, f64)> = found.eigenvalues.iter().map(|lambda| (lambda.im, lambda.re)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    all
}

/// Each eigenvalue of one list is one of the other, to a part of the largest.
fn assert_equal(a: &[(f64, f64)], b: &[(f64, f64)], what: &str) {
    assert_eq!(a.len(), b.len(), "{what}");
    let mut left = b.to_vec();
    for &(im, re) in a {
        let distance = |other: &(f64, f64)| (im - other.0).hypot(re - other.1);
        let nearest = (0..left.len()).min_by(|&i, &j| distance(&left[i]).total_cmp(&distance(&left[j]))).unwrap();
        assert!(distance(&left[nearest]) < 1e-7 * 1e5, "{what}: {re} {im} {:?}", left[nearest]);
        left.swap_remove(nearest);
    }
}

/// What the lattice itself makes of an arrangement at the medians, under the laws of the case.
fn directly(brake: &LatticeBrake, case: &LatticeCase, arrangement: &[usize], law: usize) -> SecondOrder {
    let arrangement = ContactArrangement::from_numbers(4, arrangement).unwrap();
    let lattice = lattice(case, 0, &arrangement).unwrap();
    let speed = case.speeds[0].quantile(0.5);
    let state = sliding(case, &lattice, case.laws[law], speed, &brake.median()).unwrap();
    lattice.linearised(&state).unwrap()
}

#[test]
fn members_of_a_scene_have_the_changes_of_their_own_arrangement() {
    let brake = two_by_two();
    let mut heavier = brake.case.clone();
    heavier.lattice.oscillator_mass[0] += 0.05;
    let along = (0..3).map(|dof| vec![(dof, 1.0)]).collect();
    let mass = Change::Attach { what: Attached::Mass, size: 0.05, along };
    let found = systems(&brake, vec![mass]);
    assert_eq!(found.len(), 10);
    for (name, system) in &found {
        let contacts: Vec<usize> = name.split(' ').skip(2).map(|number| number.parse().unwrap()).collect();
        let law = usize::from(name.starts_with("lugre"));
        assert_equal(&spectrum(system), &spectrum(&directly(&brake, &heavier, &contacts, law)), name);
    }
    // Without contact 1 every arrangement is the one without it.
    for (name, system) in &systems(&brake, vec![Change::TakeOut { contact: 0 }]) {
        let contacts = name.split(' ').skip(2).map(|number| number.parse().unwrap()).filter(|&number| number != 1);
        let law = usize::from(name.starts_with("lugre"));
        let direct = directly(&brake, &brake.case, &contacts.collect::<Vec<_>>(), law);
        assert_equal(&spectrum(system), &spectrum(&direct), name);
    }
}

#[test]
fn symmetric_changes_keep_sectors_and_others_do_not() {
    let brake = two_by_two();
    for (dofs, keeps) in [(vec![0, 3, 6, 9], true), (vec![0], false)] {
        let changes = dofs.iter().map(|&dof| Change::Hold { dof }).collect();
        let modified = Modified::new(&brake, &[ChangeSet { name: "held".into(), of: 0, changes }]).unwrap();
        let plan = modified.plan();
        let scene = plan.scenes.iter().find(|scene| plan.configuration(scene).contacts == "1 2 3 4").unwrap();
        let sectors = &plan.brake(scene).sectors;
        assert_eq!(sectors.iter().len() > 1, keeps, "{dofs:?}");
        let whole = modified.system(scene, &modified.median()).unwrap();
        let parts = sectors.iter().flat_map(|sector| spectrum(&sector.reduced(&whole).unwrap())).collect::<Vec<_>>();
        assert_equal(&parts, &spectrum(&whole), "sectors");
    }
}

/// Three masses in a row, each with a contact that is closed in two of three arrangements; its friction depends on all that a scene is.
struct Row {
    plan: Plan,
}

const ARRANGEMENTS: [[&str; 2]; 3] = [["a", "b"], ["a", "c"], ["b", "c"]];

/// The row with some of its contacts closed.
fn row(contacts: &[&str]) -> Brake {
    let stiffness = nalgebra::dmatrix![2.0, -1.0, 0.0; -1.0, 3.0, -1.0; 0.0, -1.0, 2.0];
    let structure = SecondOrder::new(nalgebra::DMatrix::identity(3, 3), 0.01 * &stiffness, stiffness).unwrap();
    let channel = |name: &&str| {
        let at = ["a", "b", "c"].iter().position(|other| other == name).unwrap();
        Channel::new(*name, "friction", vec![(at, 1.0)], vec![((at + 1) % 3, -1.0)])
    };
    let terms = vec![Term::new("row", "springs", structure).unwrap()];
    Brake::new(AffineSystem::new(terms, contacts.iter().map(channel).collect()).unwrap())
}

/// The operating point of some contacts of the row in a scene.
fn of_scene(contacts: &[&str], scene: &Scene, mu: f64) -> OperatingPoint {
    let (law, speed) = (scene.key.law as f64, scene.key.speed.unwrap() as f64);
    let gain = |name: &&str| {
        let of_contact = f64::from(name.as_bytes()[0] - b'a') + 10.0 * scene.members[0] as f64;
        ChannelGain::proportional(mu + 100.0 * law + 1e3 * speed + of_contact)
    };
    OperatingPoint { coefficients: vec![1.0], channels: contacts.iter().map(gain).collect() }
}

impl Row {
    fn new() -> Self {
        let mut plan = Plan::without_scenes("row", "row".into(), 1, 1);
        let arrangements = ARRANGEMENTS.map(|contacts| contacts.join(" ")).to_vec();
        plan.labels.constraints = vec!["none".into()];
        plan.labels.laws = ["one", "two"].map(|name| LawLabel { name: name.into(), title: String::new() }).to_vec();
        plan.labels.speeds =
            ["slow", "fast"].map(|name| SpeedLabel { name: name.into(), description: String::new() }).to_vec();
        plan.labels.panels = vec![PanelLabel { in_contact: 2, arrangements: arrangements.clone() }];
        for (member, contacts) in ARRANGEMENTS.iter().enumerate() {
            let brake = std::sync::Arc::new(row(contacts));
            let channels = vec![ChannelGain::proportional(0.5); 2];
            let naming_point = OperatingPoint { coefficients: vec![1.0], channels };
            plan.origins.push(Origin { brake: brake.clone(), naming_point: naming_point.clone() });
            let contacts = arrangements[member].clone();
            let configuration = Configuration { brake, naming_point, origin: 0, contacts };
            plan.add_configuration(configuration, 0, &[member], false, |_| vec![Some(0), Some(1)]);
        }
        Self { plan }
    }
}

impl UncertainBrake for Row {
    type Sample = f64;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, _: &mut StreamRng) -> Result<f64, squeal::study::Error> {
        Ok(0.5)
    }

    fn median(&self) -> f64 {
        0.5
    }

    fn operating_point(&self, scene: &Scene, mu: &f64) -> Result<OperatingPoint, squeal::study::Error> {
        Ok(of_scene(&ARRANGEMENTS[scene.members[0]], scene, *mu))
    }
}

#[test]
fn a_contact_of_an_own_brake_is_taken_out_by_its_name_in_every_scene() {
    let brake = Row::new();
    let candidates = Candidates::all(&brake, 0, &[ChangeKind::Contact], &Sizes::default()).unwrap().remove(0);
    assert_eq!(candidates.singles.len(), 3);
    for at in 0..3 {
        let name = candidates.name(&[at]);
        let set = ChangeSet { name: name.clone(), of: 0, changes: candidates.changes(&[at]) };
        let modified = Modified::new(&brake, &[set]).unwrap();
        assert_eq!(modified.plan().scenes.len(), 12);
        for scene in &modified.plan().scenes {
            let left = ARRANGEMENTS[scene.members[0]].into_iter().filter(|other| *other != name);
            let left: Vec<&str> = left.collect();
            let expected = row(&left).system.assemble(&of_scene(&left, scene, 0.7)).unwrap();
            assert_eq!(modified.system(scene, &0.7).unwrap(), expected, "{name} of {left:?}, {:?}", scene.key);
        }
    }
}

/// Hoffmann's oscillator as a reduction of something, whose eigenvalues are off by this part of themselves.
struct Reduced {
    inner: MatricesBrake,
    error: f64,
}

impl UncertainBrake for Reduced {
    type Sample = Vec<f64>;

    fn plan(&self) -> &Plan {
        self.inner.plan()
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<Vec<f64>, squeal::study::Error> {
        self.inner.draw(rng)
    }

    fn median(&self) -> Vec<f64> {
        self.inner.median()
    }

    fn operating_point(&self, scene: &Scene, sample: &Vec<f64>) -> Result<OperatingPoint, squeal::study::Error> {
        self.inner.operating_point(scene, sample)
    }

    fn error_of_reduction(&self, _: &Scene) -> f64 {
        self.error
    }
}

/// `s^2 + c s + 2 = +- sqrt(1 - D)`: a mode is open where its growth is within the error of the reduction, with changes too.
#[test]
fn verdicts_within_the_error_of_a_reduction_are_open_in_a_screen() {
    const SAMPLES: u64 = 400;
    let path = case("hoffmann.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let brake = || MatricesBrake::new(MatricesCase::parse(&path, text.clone()).unwrap()).unwrap();
    let error = 0.016;
    let reduced = Reduced { inner: brake(), error };
    let mut options = options(&[ChangeKind::Dashpot], 1);
    options.sizes.dashpot = Some(1e-9);
    let screen = screened(&reduced, &options, SAMPLES);
    let exact = screened(&brake(), &options, SAMPLES);
    let c = 0.05;
    let is_open = |mu: f64, sign: f64| {
        let right = Complex::from(1.0 - mu * 4.0 / 3.0).sqrt() * sign;
        let s = (Complex::from(c * c - 8.0) + right * 4.0).sqrt();
        let s = (if s.im > 0.0 { s } else { -s } - c) / 2.0;
        s.re.abs() <= error * s.norm()
    };
    let drawn = (0..SAMPLES).map(|at| reduced.draw(&mut stream(reduced.plan().seed, at)).unwrap()[0]);
    let open: u64 = drawn.map(|mu| [1.0, -1.0].into_iter().filter(|&sign| is_open(mu, sign)).count() as u64).sum();
    assert!(open > 5, "{open}");
    for set in &screen.sets {
        let confirmed = set.confirmed.as_ref().unwrap();
        assert_eq!(confirmed.undecided, open, "{}", set.places);
    }
    let counted = |screen: &Screen| screen.sets[0].confirmed.as_ref().unwrap().unstable;
    let (with, without) = (counted(&screen), counted(&exact));
    assert_eq!(exact.sets[0].confirmed.as_ref().unwrap().undecided, 0);
    assert!(with.value < without.value && without.value <= with.upper, "{with:?} {without:?}");
    // What is open is either in the limits of a drop too, so that it tells nothing of a dashpot as small as this one.
    let drops = |screen: &Screen| screen.sets[1].confirmed.as_ref().map(|of| [of.drop, of.squealing_drop]).unwrap();
    for (drop, exact) in drops(&screen).into_iter().zip(drops(&exact)) {
        let open = open as f64 / SAMPLES as f64;
        assert!(
            drop.lower <= -open && drop.upper >= open && exact.upper - exact.lower < open,
            "{drop:?} {exact:?} {open}"
        );
    }

    // Where verdicts are open, what makes them so and what lowers it are said.
    let results = Results::sampled(&Study::new(&reduced, &QrSolver).unwrap()).unwrap();
    let text = results.text().unwrap();
    assert!(text.contains("to within 1.6 % of themselves"), "{text}");
    assert!(text.contains("a larger reduction.training lowers it"), "{text}");
}
