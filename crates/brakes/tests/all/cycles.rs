//! The motion after the onset, of lattices and of matrices: against numbers integrated elsewhere, and what is refused.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use brakes::case::{CaseFile, ChosenSpeed, LatticeCase, MatricesCase, SceneChoice};
use brakes::{AnyBrake, LatticeBrake, MatricesBrake, Purpose};
use cea::{Mode, QrSolver, Workspace};
use cycle::{BranchEnd, Motion, Settings, follow, harmonics, measure, state_after, states};
use montecarlo::Progress;
use num_complex::Complex;
use squeal::cycles::{CycleOptions, Start, branches, cycles};
use study::{Moves, Study, UncertainBrake};
use sweep::Over;

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name)
}

/// The lattice of the paper with all in contact under a law at a speed.
fn lattice(law: &str, speed: f64) -> AnyBrake {
    let choice = SceneChoice { law: Some(law.into()), speed: ChosenSpeed::Fixed(speed), ..SceneChoice::default() };
    let case = CaseFile::read(&case("paper.toml")).unwrap().only(&choice).unwrap();
    brakes::make(case, Purpose::Analysis, &()).unwrap()
}

fn shape_of(brake: &AnyBrake, lambda: Complex<f64>) -> Vec<Complex<f64>> {
    let system = brake.system(&brake.plan().scenes[0], &brake.median()).unwrap();
    let mode = Mode::at(&system, &[lambda], &mut Workspace::default()).unwrap().swap_remove(0);
    mode.shape.iter().copied().collect()
}

/// A growing mode at mu = 0.5, by two other programs.
const LAMBDA: Complex<f64> = Complex::new(285.01232, 11602.08548);

#[test]
fn a_small_motion_of_the_lattice_grows_as_its_eigenvalue_says() {
    let brake = lattice("amontons-coulomb", 3.2);
    let system = brake.sliding_contacts().unwrap().contact_system(&brake.plan().scenes[0], &[], 0.01).unwrap();
    let shape = shape_of(&brake, LAMBDA);
    let start = system.state_of_mode(LAMBDA, &shape, 1e-3 * system.grazing(&shape));
    let time = 10.0 * std::f64::consts::TAU / LAMBDA.im;
    let end = state_after(&system, start, time, LAMBDA.im, 1e-12).unwrap();
    let factor = (LAMBDA * time).exp() * 1e-3 * system.grazing(&shape);
    let size = shape.iter().map(|phi| (phi * factor).norm()).fold(0.0, f64::max);
    for (dof, phi) in shape.iter().enumerate() {
        assert!((end[dof] - (phi * factor).re).abs() < 6e-8 * size, "{dof}: {} {}", end[dof], (phi * factor).re);
    }
}

#[test]
fn the_tangent_of_every_law_is_the_system_of_the_analysis() {
    for law in ["amontons-coulomb", "velocity-dependent", "lugre"] {
        let brake = lattice(law, 0.7);
        let scene = &brake.plan().scenes[0];
        let system = brake.sliding_contacts().unwrap().contact_system(scene, &[], 0.01).unwrap();
        let of_cea = brake.system(scene, &brake.median()).unwrap();
        let deviation = system.check_tangent(&of_cea, LAMBDA.im).unwrap();
        assert!(deviation < 1e-14, "{law}: {deviation}");
        // With another value of a parameter too.
        let parameters = brake.parametrised().unwrap();
        let place = parameters.parameters(scene).iter().position(|p| p.name == "contact_stiffness").unwrap();
        let values = [(place, 3e7)];
        let changed = brake.sliding_contacts().unwrap().contact_system(scene, &values, 0.01).unwrap();
        assert!(changed.check_tangent(&of_cea, LAMBDA.im).is_err(), "{law}");
        changed.check_tangent(&parameters.system_with(scene, &values).unwrap(), LAMBDA.im).unwrap();
    }
}

#[test]
fn the_lattice_has_the_cycle_that_another_program_integrated() {
    // Another program, steps of equal length: 1,537.49 Hz, rms x1' 0.3409 and x4' 0.2064 m/s, 0.932 J.
    let brake = lattice("amontons-coulomb", 3.2);
    let system = brake.sliding_contacts().unwrap().contact_system(&brake.plan().scenes[0], &[], 0.01).unwrap();
    let shape = shape_of(&brake, LAMBDA);
    // Not every motion comes to it: some stay modulated, near 1,501 Hz.
    let scales = system.scales(LAMBDA.im);
    let settings = Settings { tolerance: 1e-9, ..Settings::default() };
    let found = (0..4_u64).find_map(|trial| {
        let mut state = 13_345 + 1_000 * trial;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        let start = scales.iter().map(|scale| 0.3 * scale * noise()).collect();
        match follow(&system, start, LAMBDA.im, &shape, &settings).unwrap() {
            Motion::Cycle(cycle) => Some(cycle),
            _ => None,
        }
    });
    let cycle = found.unwrap();
    let measures = measure(&system, &cycle, 1e-11).unwrap();
    assert!((cycle.frequency_hz() - 1537.49).abs() < 0.02, "{}", cycle.frequency_hz());
    let rms = |oscillators: [usize; 2]| oscillators.map(|of| measures.rms_velocity[3 * (of - 1)]);
    assert!(rms([1, 3]).iter().chain(&rms([7, 9])).any(|x| (x - 0.3409).abs() < 1e-3), "{measures:?}");
    assert!(rms([4, 6]).iter().any(|x| (x - 0.2064).abs() < 1e-3), "{measures:?}");
    assert!((measures.kinetic_energy - 0.932).abs() < 1e-3, "{}", measures.kinetic_energy);
    assert!(measures.imbalance() < 1e-8, "{}", measures.imbalance());
    let open = measures.contacts.iter().map(|shares| shares.open).fold(0.0, f64::max);
    assert!(measures.contacts.iter().all(|shares| shares.stuck == 0.0) && (open - 0.584).abs() < 1e-3, "{measures:?}");
    // Its harmonics have the velocities of all, and of the four oscillators above, by Parseval.
    let all: Vec<usize> = (0..system.order()).collect();
    let states = states(&system, &cycle, 1024, 1e-11).unwrap();
    let found = harmonics(&cycle, all.len(), &states, (&all, measures.rms_of(&all)));
    for (dofs, most) in [(&all[..], 1e-8), (&[0, 9], 1e-5), (&[18, 24], 1e-5)] {
        let sum: f64 = (1..=found.velocity.len()).map(|harmonic| found.rms_of(harmonic, dofs).powi(2)).sum();
        let missing = 1.0 - sum / measures.rms_of(dofs).powi(2);
        assert!((-1e-9..most).contains(&missing), "{dofs:?}: {missing} beyond {} harmonics", found.velocity.len());
    }
}

#[test]
fn friction_across_the_sliding_is_refused() {
    let text =
        std::fs::read_to_string(case("paper.toml")).unwrap().replace("lateral = \"none\"", "lateral = \"vector\"");
    let brake = LatticeBrake::new(LatticeCase::parse(&case("paper.toml"), text).unwrap()).unwrap();
    let error = cycles(&brake, &brake.plan.scenes[0], &CycleOptions::default(), None, &()).unwrap_err().to_string();
    assert_eq!(
        error,
        "friction across the sliding has no motion here, only a tangent; allowed: readings.lateral = \"none\""
    );
}

fn hoffmann(change: impl Fn(String) -> String) -> MatricesBrake {
    let text = change(std::fs::read_to_string(case("hoffmann.toml")).unwrap());
    MatricesBrake::new(MatricesCase::parse(&case("hoffmann.toml"), text).unwrap()).unwrap()
}

/// The motions of Hoffmann's oscillator with a line of its contact changed.
fn answer(change: impl Fn(String) -> String, options: &CycleOptions) -> Result<squeal::cycles::Cycles, String> {
    let brake = hoffmann(change);
    cycles(&brake, &brake.plan.scenes[0], options, None, &()).map_err(|error| error.to_string())
}

#[test]
fn a_case_of_matrices_has_the_cycle_of_its_equations() {
    let found = answer(|text| text, &CycleOptions::default()).unwrap();
    let [motion] = &found.motions[..] else { panic!() };
    let Motion::Cycle(cycle) = &motion.motion else { panic!() };
    assert!((cycle.period - 4.485144715).abs() < 1e-7, "{}", cycle.period);
    assert!((motion.balanced_hz.unwrap() * cycle.period - 1.0).abs() < 1e-5);
    let noise = answer(|text| text, &CycleOptions { from: Start::Noise, ..CycleOptions::default() }).unwrap();
    let Motion::Cycle(of_noise) = &noise.motions[0].motion else { panic!() };
    assert!((of_noise.period / cycle.period - 1.0).abs() < 1e-8);
}

/// Hoffmann's oscillator with both degrees of freedom called rotations: no loudness, and the harmonics that it has as a mass.
#[test]
fn a_cycle_of_rotations_alone_has_its_harmonics() {
    let mut brake = hoffmann(|text| text);
    let found =
        |brake: &MatricesBrake| cycles(brake, &brake.plan.scenes[0], &CycleOptions::default(), None, &()).unwrap();
    let column = |table: &output::Table, name: &str| table.column(name).unwrap().map(str::to_owned).collect::<Vec<_>>();
    let of_mass = found(&brake).spectrum_table();
    brake.plan.labels.moves = vec![Moves::Turns; 2];
    let cycles = found(&brake);
    let of_turns = cycles.spectrum_table();
    for name in ["frequency_hz", "rms_velocity_m_per_s mass"] {
        assert_eq!(column(&of_turns, name), column(&of_mass, name));
    }
    let lines = column(&of_mass, "harmonic").len();
    assert_eq!(column(&of_turns, "loudness_m_per_s"), vec!["0"; lines]);
    assert_eq!(column(&of_turns, "part_above"), vec![""; lines]);
    assert!(lines > 3);
    assert_eq!(column(&cycles.table(), "loudness_m_per_s"), ["0"]);
}

#[test]
fn what_a_motion_needs_and_a_case_lacks_is_said_in_a_line() {
    let without = |field: &'static str| {
        move |text: String| text.lines().filter(|line| !line.starts_with(field)).collect::<Vec<_>>().join("\n")
    };
    for field in ["load =", "speed =", "stiffness = 1.33"] {
        let error = answer(without(field), &CycleOptions::default()).unwrap_err();
        let name = field.split(' ').next().unwrap();
        assert!(error.contains(&format!("contacts \"belt\".{name}")) && error.contains("missing; allowed:"), "{error}");
    }
    let with = |from: &'static str, to: &'static str| move |text: String| text.replace(from, to);
    let sloped = answer(with("load = 1.0 ", "slope = -0.1\nload = 1.0 "), &CycleOptions::default()).unwrap_err();
    assert!(
        sloped.contains("contacts \"belt\".slope = -0.1; allowed: mu alone: a slope or lag is the tangent"),
        "{sloped}"
    );
    let lagging = "lag = { decay = 2.0, drive = 0.1, force = 3.0 }\nload = 1.0 ";
    let lagging = answer(with("load = 1.0 ", lagging), &CycleOptions::default()).unwrap_err();
    assert!(lagging.contains("contacts \"belt\".lag.force = 3; allowed: mu alone"), "{lagging}");
    let pulled = answer(with("mu = \"mu\"", "mu = \"-mu\""), &CycleOptions::default()).unwrap_err();
    assert!(pulled.contains("hoffmann.toml") && pulled.contains("contacts \"belt\".mu = -0.8; allowed: "), "{pulled}");
    // K without so stiff a spring would have a negative stiffness.
    let soft =
        answer(with("stiffness = 1.3333333333333333 ", "stiffness = 0.13 "), &CycleOptions::default()).unwrap_err();
    assert!(soft.contains("contact \"belt\": stiffness = 0.13; allowed: "), "{soft}");
    let stable = answer(with("to = 1.1", "to = 0.7"), &CycleOptions::default()).unwrap_err();
    assert!(stable.contains("no mode oscillates and grows"), "{stable}");
    for (options, expected) in [
        (CycleOptions { stick: 0.0, ..CycleOptions::default() }, "stick = 0; allowed: above 0 and below 1"),
        (CycleOptions { samples: 18, ..CycleOptions::default() }, "samples of a period = 18; allowed: 19 or more"),
        (CycleOptions { harmonics: 0, ..CycleOptions::default() }, "harmonics = 0; allowed: 1 to 100"),
        (
            CycleOptions { from: Start::Mode(1), ..CycleOptions::default() },
            "from = 1; allowed: noise, or the rank of an unstable mode: 2",
        ),
    ] {
        let error = answer(|text| text, &options).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
}

/// Progress as work tells it.
#[derive(Default)]
struct Counts {
    total: AtomicU64,
    done: AtomicU64,
}

impl Progress for Counts {
    fn begin(&self, total: u64, done: u64) {
        self.total.store(total, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
    }
    fn advance(&self, evaluations: u64) {
        self.done.fetch_add(evaluations, Ordering::Relaxed);
    }
    fn end(&self) {}
}

#[test]
fn periods_are_told_as_they_pass_and_all_of_them_are_at_the_end() {
    let (brake, counts) = (hoffmann(|text| text), Counts::default());
    cycles(&brake, &brake.plan.scenes[0], &CycleOptions::default(), None, &counts).unwrap();
    assert_eq!([&counts.total, &counts.done].map(|count| count.load(Ordering::Relaxed)), [1000, 1000]);
}

#[test]
fn a_branch_does_not_end_where_a_long_step_leads_to_steady_sliding() {
    let text = r#"
        study = { name = "two masses", samples = 10, seed = 1 }
        brake = { kind = "matrices", dofs = ["x", "y"] }
        parameters.mu = { distribution = "uniform", from = 0.3, to = 1.1 }
        terms = [{ name = "body", mass = [[0.6, 0], [0, 1.4]], damping = [[0.1, 0], [0, 0.1]], stiffness = [[1.7, -0.2], [-0.2, 4.4]] }]
        contacts = [{ name = "pad", force = { x = -1.0 }, reading = { y = -1.3 }, mu = "mu", load = 1.4, speed = 5.0, stiffness = 0.8 }]
    "#;
    let brake = MatricesBrake::new(MatricesCase::parse("two.toml".as_ref(), text.into()).unwrap()).unwrap();
    let study = Study::new(&brake, &QrSolver).unwrap();
    // A range is as long as one in its steps: of 0.22 and 0.24 one step led from an amplitude of 2 to 0.
    for from in [0.1, 0.2, 0.22, 0.24, 0.25] {
        for to in [1.1, 1.5] {
            let over = Over { name: "mu".into(), from, to };
            let found = branches(&study, 0, &over, &CycleOptions::default(), None, [&(), &()]).unwrap();
            let [branch] = &found.branches[..] else { panic!("{from} to {to}: {}", found.text()) };
            assert_eq!(branch.end, BranchEnd::Range, "{from} to {to}");
        }
    }
}
