//! Rare squeal against quadrature, plain samples and the onsets of sweeps, and brakes of which it cannot be asked.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use brakes::case::{CaseFile, ChosenSpeed, LatticeCase, MatricesCase, SceneChoice};
use brakes::{LatticeBrake, MatricesBrake, Purpose};
use cea::BatchSolver;
use linsys::{AffineSystem, OperatingPoint, SecondOrder, Term};
use montecarlo::{Distribution, Experiment as _, Progress, stream};
use osc_model::{Brake, ContactArrangement, LatticeParameters};
use squeal::questions::Error;
use squeal::rare::{Options, Rare, rare};
use squeal::study::{Drawn, IndependentBrake, Scratch, Study, UncertainBrake};
use squeal::sweep::{Over, sweep};

/// Hoffmann's oscillator with a normal coefficient of friction and a log-normal dashpot; `pairs` of them, side by side.
fn hoffmann(deviation: f64, pairs: usize, correlation: f64) -> MatricesBrake {
    let dofs: Vec<String> = (0..2 * pairs).map(|i| format!("d{i}")).collect();
    let mut text = format!(
        "[study]\nname = \"Hoffmann\"\nsamples = 100\nseed = 1\n[brake]\nkind = \"matrices\"\ndofs = {dofs:?}\n"
    );
    for i in 1..=pairs {
        text += &format!(
            "[parameters.mu{i}]\ndistribution = \"normal\"\nmean = 0.5\ndeviation = {deviation}\nat_least = -20.0\n\
             [parameters.c{i}]\ndistribution = \"log-normal\"\nmedian = 0.3\nsigma = 0.4\n"
        );
    }
    let n = 2 * pairs;
    let matrix = |of: &dyn Fn(usize, usize) -> f64| {
        let row = |i: usize| format!("{:?}", (0..n).map(|j| of(i, j)).collect::<Vec<f64>>());
        format!("[{}]", (0..n).map(row).collect::<Vec<_>>().join(", "))
    };
    // The second pair is stiffer, so that no eigenvalue is one of the first.
    let stiffness = |i: usize, j: usize| match (i / 2 == j / 2, i == j) {
        (true, true) => 2.0 * (1.0 + (i / 2) as f64),
        (true, false) => 1.0 + (i / 2) as f64,
        _ => 0.0,
    };
    let mass = matrix(&|i, j| f64::from(i == j));
    text += &format!("[[terms]]\nname = \"springs\"\nmass = {mass}\nstiffness = {}\n", matrix(&stiffness));
    for i in 1..=pairs {
        // K scaled by s has the same critical friction with dashpots scaled by the root of s.
        let root = (i as f64).sqrt();
        let dashpots = matrix(&|a, b| if a == b && a / 2 == i - 1 { root } else { 0.0 });
        text += &format!("[[terms]]\nname = \"dashpots {i}\"\ncoefficient = \"c{i}\"\ndamping = {dashpots}\n");
        let of = |dof: usize, value: f64| format!("{{ d{dof} = {value:?} }}");
        let (force, reading) = (of(2 * i - 2, -1.0), of(2 * i - 1, i as f64 * 4.0 / 3.0));
        text += &format!("[[contacts]]\nname = \"belt {i}\"\nforce = {force}\nreading = {reading}\nmu = \"mu{i}\"\n");
    }
    if correlation != 0.0 {
        text += &format!(
            "[correlation]\nparameters = [\"mu1\", \"c1\"]\nmatrix = [[1.0, {correlation}], [{correlation}, 1.0]]\n"
        );
    }
    MatricesBrake::new(MatricesCase::parse(Path::new("hoffmann.toml"), text).unwrap()).unwrap()
}

/// `P = int phi(z) P(mu > mu_c(c(z)) | z) dz`, `mu_c = (1 + 2 c^2) / k3`, by the rule of trapezia.
fn by_quadrature(deviation: f64, correlation: f64) -> f64 {
    let step = 1e-3;
    let term = |i: i32| {
        let z = step * f64::from(i);
        let critical = (1.0 + 2.0 * (0.3 * (0.4 * z).exp()).powi(2)) * 0.75;
        let beyond = ((critical - 0.5) / deviation - correlation * z) / (1.0 - correlation * correlation).sqrt();
        (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt() * ::rare::tail(beyond)
    };
    (-9_000..=9_000).map(term).sum::<f64>() * step
}

fn found<B: UncertainBrake>(brake: &B, options: &Options) -> Result<Rare, Error> {
    let study = Study::new(brake, &BatchSolver)?;
    rare(&study, 0, options, &BatchSolver, None, &())
}

/// Standard errors by which the mean over some seeds is from the exact probability.
fn apart<B: UncertainBrake>(brake: &B, exact: f64) -> f64 {
    let seeds = 8;
    let of_seed = |seed| found(brake, &Options { seed, budget: 4_000, ..Options::default() }).unwrap().probability;
    let all: Vec<_> = (1..=seeds).map(of_seed).collect();
    let sum: f64 = all.iter().map(|probability| probability.value - exact).sum();
    let error = all.iter().map(|probability| probability.standard_error.powi(2)).sum::<f64>().sqrt();
    println!("{exact:e} {} {:?}", sum / error, all.iter().map(|p| p.value / exact).collect::<Vec<_>>());
    (sum / error).abs()
}

fn holds(found: &Rare, exact: f64) -> bool {
    (found.probability.lower..=found.probability.upper).contains(&exact)
}

/// Deviations of mu for which the probability is about 1e-2, 1e-5 and 1e-9.
const DEVIATIONS: [f64; 3] = [0.16, 0.076, 0.049];

#[test]
fn hoffmanns_oscillator_squeals_as_rarely_as_the_quadrature_says() {
    for deviation in DEVIATIONS {
        let exact = by_quadrature(deviation, 0.0);
        let brake = hoffmann(deviation, 1, 0.0);
        assert!(apart(&brake, exact) < 3.0);
        let found = found(&brake, &Options::default()).unwrap();
        assert!(found.is_reached && found.spectra < 2_400, "{} {:?}", found.spectra, found.probability);
        // The likeliest squealing brake is on the closed form of the onset, and there is one.
        let [brake] = &found.design_points[..] else { panic_with(&found) };
        let place = |name: &str| found.inputs.iter().position(|input| input.name == name).unwrap();
        let (mu, c) = (brake.values[place("mu1")], brake.values[place("c1")]);
        assert!((mu - (1.0 + 2.0 * c * c) * 0.75).abs() < 1e-4, "{mu} {c}");
        // No bound: two inputs.
        assert_eq!(found.bound, None);
    }
}

#[allow(clippy::panic)]
fn panic_with(found: &Rare) -> ! {
    panic!("{found:?}")
}

#[test]
fn two_oscillators_squeal_where_either_does_and_each_mode_has_its_part() {
    let each = by_quadrature(DEVIATIONS[1], 0.0);
    let exact = 1.0 - (1.0 - each) * (1.0 - each);
    let options = Options { relative: 0.05, budget: 20_000, ..Options::default() };
    let found = found(&hoffmann(DEVIATIONS[1], 2, 0.0), &options).unwrap();
    assert_eq!(found.design_points.len(), 2, "{found:?}");
    assert!(holds(&found, exact), "{exact:e} {:?}", found.probability);
    // Which of the two that meet in a pair grows has no answer, so that each may have all of the pair.
    let held = found.modes.iter().filter(|mode| (0.8..1.3).contains(&(mode.open / each)));
    assert!(
        held.count() == 4 || found.modes.iter().any(|mode| mode.probability.value > 0.5 * each),
        "{:?}",
        found.modes
    );
}

#[test]
fn correlated_inputs_squeal_as_the_quadrature_with_their_copula_says() {
    for correlation in [-0.6, 0.5] {
        let exact = by_quadrature(DEVIATIONS[1], correlation);
        assert!(apart(&hoffmann(DEVIATIONS[1], 1, correlation), exact) < 3.0);
    }
}

fn paper() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml")
}

/// The paper's lattice under one law, with one set of constraints and all oscillators in contact.
fn lattice(law: &str, constraints: &str, change: impl FnOnce(&mut LatticeCase)) -> LatticeBrake {
    let (law, constraints) = (Some(law.to_owned()), Some(constraints.to_owned()));
    let choice = SceneChoice { law, contact: None, constraints, speed: ChosenSpeed::Range(None) };
    let CaseFile::Lattice(mut case) = CaseFile::read(&paper()).unwrap().only(&choice).unwrap() else { unreachable!() };
    change(&mut case);
    LatticeBrake::new(*case).unwrap()
}

#[test]
fn lines_and_plain_samples_agree_where_plain_samples_suffice() {
    // Five inputs: alpha, mu_s, mu_k and the speed matter.
    let brake = lattice("velocity-dependent", "corners-4-6", |_| {});
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let samples = 4_000;
    let drawn: Vec<_> = (0..samples).map(|index| brake.draw(&mut stream(7, index)).unwrap()).collect();
    let all: Vec<_> = drawn.iter().collect();
    let mut outcomes = Vec::new();
    study.evaluate_block(0, &all, &mut Scratch::default(), &mut outcomes);
    let unstable = outcomes.iter().filter(|outcome| outcome.as_ref().unwrap().is_unstable()).count();
    let plain = unstable as f64 / samples as f64;
    let error = (plain * (1.0 - plain) / samples as f64).sqrt();
    let found =
        rare(&study, 0, &Options { budget: 6_000, relative: 0.05, ..Options::default() }, &BatchSolver, None, &());
    let found = found.unwrap();
    let apart = (found.probability.value - plain).abs() / error.hypot(found.probability.standard_error);
    println!("plain {plain} +- {error}, lines {:?}, {} spectra", found.probability, found.spectra);
    assert!((0.01..0.1).contains(&plain) && apart < 3.0, "{plain} {error} {:?}", found.probability);
    // One mode has it all.
    assert!((found.modes[0].probability.value / found.probability.value - 1.0).abs() < 1e-6, "{:?}", found.modes);
}

#[test]
fn one_input_has_the_probability_beyond_the_onset_of_a_sweep_and_a_certified_bound() {
    let mu = Distribution::Normal { mean: 0.15, deviation: 0.03, at_least: 0.0, at_most: None };
    let brake = lattice("amontons-coulomb", "none", |case| case.friction.mu = mu);
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let over = Over { name: "mu".into(), from: 0.1, to: 0.35 };
    let onset = sweep(&study, 0, &over, &BatchSolver, &()).unwrap().onsets[0].at;
    let found = rare(&study, 0, &Options::default(), &BatchSolver, None, &()).unwrap();
    let exact = ::rare::tail((onset - 0.15) / 0.03);
    assert!(holds(&found, exact) && (found.probability.value / exact - 1.0).abs() < 5e-3, "{exact:e} {found:?}");
    assert!((found.design_points[0].values[0] - onset).abs() < 1e-4);
    let bound = found.bound.unwrap();
    // Not far above: the certificate knows nothing of the law of friction.
    assert!(bound.probability > exact && bound.probability < 100.0 * exact, "{bound:?} {exact:e}");
    assert!(bound.stable.last().unwrap()[1] < onset);
}

/// The paper's lattice with nine in contact and Amontons-Coulomb friction, whose contact springs and inclined springs, all of one kind by one
/// log-normal factor of 5 %, and dashpots, 20 %, are drawn beside mu.
fn drawn_structure(mean: f64) -> impl UncertainBrake {
    let brake = lattice("amontons-coulomb", "none", |_| {});
    let case = &brake.case;
    let all = ContactArrangement::full(9);
    let with = |change: &dyn Fn(&mut LatticeParameters)| {
        let mut case = case.clone();
        change(&mut case.lattice);
        brakes::lattice(&case, 0, &all).unwrap()
    };
    let plain = with(&|_| {});
    let whole = plain.structural();
    let minus = |a: &SecondOrder, b: &SecondOrder| SecondOrder::new(&a.m - &b.m, &a.c - &b.c, &a.k - &b.k).unwrap();
    // The matrices are linear in each of them: twice minus once is once.
    let double = |values: &mut Vec<f64>| values.iter_mut().for_each(|value| *value *= 2.0);
    let contact = minus(with(&|of| double(&mut of.contact_stiffness)).structural(), whole);
    let inclined = minus(with(&|of| double(&mut of.inclined_stiffness)).structural(), whole);
    let dashpots = |of: &mut LatticeParameters| {
        [&mut of.x_damping, &mut of.y_damping, &mut of.z_damping].into_iter().for_each(double);
    };
    let dashpots = minus(with(&dashpots).structural(), whole);
    let rest = minus(&minus(&minus(whole, &contact), &inclined), &dashpots);
    let terms = [("rest", rest), ("contact", contact), ("inclined", inclined), ("dashpots", dashpots)];
    let terms = terms.into_iter().map(|(name, of)| Term::new(name, name, of).unwrap()).collect();
    let channels = plain.brake().system.channels().to_vec();
    let system = AffineSystem::new(terms, channels).unwrap();
    let factor = |name: &str, sigma: f64| {
        Drawn::new(name, "1", Distribution::LogNormal { median: 1.0, sigma, at_least: None, at_most: None })
    };
    let mu = Distribution::Normal { mean, deviation: 0.03, at_least: f64::NEG_INFINITY, at_most: None };
    let drawn = vec![Drawn::new("mu", "1", mu), factor("k_z", 0.05), factor("k_a", 0.05), factor("c", 0.2)];
    let channels = system.channels().len();
    IndependentBrake::new("lattice", Brake::new(system), drawn, move |_, values| {
        let &[mu, contact, inclined, dashpots] = values else { unreachable!() };
        // Friction reads the force of the contact spring.
        let gain = linsys::ChannelGain { mu: mu * contact, slope: 0.0, lag: None };
        Ok(OperatingPoint { coefficients: vec![1.0, contact, inclined, dashpots], channels: vec![gain; channels] })
    })
    .unwrap()
}

#[test]
fn the_lattice_with_a_drawn_structure_is_as_rare_as_another_program_measured() {
    // By a prototype with other lines and another eigenvalue solver: 0.0114 +- 0.0003, 3.55e-4 +- 4.6 % and 1.85e-6 +- 5.9 %.
    for (mean, value, error) in [(0.2, 0.0114, 0.026), (0.15, 3.55e-4, 0.046), (0.1, 1.85e-6, 0.059)] {
        let found =
            found(&drawn_structure(mean), &Options { budget: 4_000, relative: 0.08, ..Options::default() }).unwrap();
        println!(
            "{mean}: {value:e} {:?} {} spectra, first order {:e}",
            found.probability, found.spectra, found.design_points[0].first_order
        );
        let own = found.probability.standard_error / found.probability.value;
        let apart = (found.probability.value / value - 1.0).abs() / f64::hypot(error, own);
        assert!(apart < 3.0 && found.is_reached, "{mean}: {apart} {:?}", found.probability);
    }
}

#[test]
fn results_do_not_depend_on_the_threads() {
    let brake = hoffmann(DEVIATIONS[1], 2, 0.0);
    let on = |threads| squeal::workers(Some(threads)).unwrap().install(|| found(&brake, &Options::default()).unwrap());
    assert_eq!(on(1), on(2));
}

/// Whoever counts the spectra that are solved, and has enough after some.
struct Solved {
    most: u64,
    kept: AtomicU64,
    solved: AtomicU64,
}

impl Progress for Solved {
    fn begin(&self, _: u64, done: u64) {
        self.kept.store(done, Ordering::Relaxed);
    }
    fn advance(&self, spectra: u64) {
        self.solved.fetch_add(spectra, Ordering::Relaxed);
    }
    fn end(&self) {}
    fn is_cancelled(&self) -> bool {
        self.solved.load(Ordering::Relaxed) >= self.most
    }
}

/// The answer with answers at points kept in a file, until so many spectra are solved; with it the number that was kept before, and that was solved.
fn asked<B: UncertainBrake>(brake: &B, kept: &Path, most: u64) -> (Result<Rare, Error>, u64, u64) {
    let study = Study::new(brake, &BatchSolver).unwrap();
    let progress = Solved { most, kept: AtomicU64::new(0), solved: AtomicU64::new(0) };
    let options = Options { budget: 1_000, ..Options::default() };
    let found = rare(&study, 0, &options, &BatchSolver, Some(kept), &progress);
    (found, progress.kept.into_inner(), progress.solved.into_inner())
}

#[test]
fn a_run_that_was_stopped_anywhere_goes_on_to_the_same_answer_and_solves_for_the_rest() {
    let several = hoffmann(DEVIATIONS[1], 2, 0.0);
    let mu = Distribution::Normal { mean: 0.15, deviation: 0.03, at_least: 0.0, at_most: None };
    let one = lattice("amontons-coulomb", "none", |case| case.friction.mu = mu);
    stopped_anywhere(&several, &[0, 1, 300, 900, 1_400]);
    stopped_anywhere(&one, &[40, 700]);
}

fn stopped_anywhere<B: UncertainBrake>(brake: &B, stops: &[u64]) {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let (whole, _, of_whole) = asked(brake, &file("whole"), u64::MAX);
    let whole = whole.unwrap();
    assert_eq!(whole.spectra, of_whole);
    assert!(stops.iter().all(|stop| *stop < of_whole), "{of_whole}");
    let on = |threads| squeal::workers(Some(threads)).unwrap();
    for (threads, stop) in [1, 2].into_iter().cycle().zip(stops) {
        let kept = file(&stop.to_string());
        let (stopped, _, before) = on(threads).install(|| asked(brake, &kept, *stop));
        assert!(stopped.is_err_and(|error| error.is_cancelled()) && before >= *stop);
        let (found, known, after) = on(3 - threads).install(|| asked(brake, &kept, u64::MAX));
        assert_eq!(found.unwrap(), whole, "after {stop}");
        // Some points are asked for twice.
        assert!(known <= before && known > before / 2 || before == 0, "{known} of {before} are known");
        assert!(before + after <= of_whole, "{before} and {after} of {of_whole}");
        // All is known now.
        let (again, _, none) = asked(brake, &kept, u64::MAX);
        assert!(again.unwrap() == whole && none == 0);
    }
    // Stopped again and again.
    let kept = file("often");
    let mut times = 0;
    while asked(brake, &kept, of_whole / 5).0.is_err() {
        times += 1;
    }
    assert!((3..=5).contains(&times), "{times}");
    assert_eq!(asked(brake, &kept, 1).0.unwrap(), whole);
}

#[test]
fn answers_that_are_torn_damaged_or_of_another_brake_are_solved_for() {
    let (brake, other) = (hoffmann(DEVIATIONS[1], 1, 0.0), hoffmann(DEVIATIONS[0], 1, 0.0));
    let folder = tempfile::tempdir().unwrap();
    let kept = folder.path().join("kept");
    let whole = asked(&brake, &kept, u64::MAX).0.unwrap();
    let bytes = std::fs::read(&kept).unwrap();
    let identity = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(1).unwrap().0 + 1;
    let last = bytes[..bytes.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap();
    for cut in
        [0, 10, identity - 1, identity, bytes.len() / 3, bytes.len() / 2, last, last + 1, last + 20, bytes.len() - 1]
    {
        std::fs::write(&kept, &bytes[..cut]).unwrap();
        let (found, known, solved) = asked(&brake, &kept, u64::MAX);
        assert_eq!(found.unwrap(), whole, "cut at {cut}");
        assert!((known > 0) == (cut > bytes.len() / 4) && (solved > 0 || cut >= last), "{known} and {solved} at {cut}");
        assert_eq!(asked(&brake, &kept, u64::MAX).2, 0, "what is torn is cut off before more is appended");
    }
    // A digit that is another one: all before it is known.
    let mut altered = bytes.clone();
    let digit = (bytes.len() / 2..bytes.len()).find(|at| bytes[*at].is_ascii_digit()).unwrap();
    altered[digit] = if altered[digit] == b'9' { b'8' } else { b'9' };
    std::fs::write(&kept, altered).unwrap();
    let (found, known, solved) = asked(&brake, &kept, u64::MAX);
    assert!(found.unwrap() == whole && known > 0 && solved > 0, "{known} {solved}");
    // Another brake begins the file anew.
    let of_other = asked(&other, &folder.path().join("other"), u64::MAX).0.unwrap();
    let (found, known, _) = asked(&other, &kept, u64::MAX);
    assert!(found.unwrap() == of_other && known == 0);
}

/// Measured coefficients that repeat, alone and beside a log-normal dashpot: the probability beyond the onset is that of their quantile function, which is flat at a
/// value that repeats.
#[test]
fn measured_values_that_repeat_are_as_rare_as_their_quantile_function_says() {
    // 300 values of a normal distribution in steps of 0.01, most of them several times, and one far above.
    let normal = Distribution::Normal { mean: 0.5, deviation: 0.05, at_least: 0.0, at_most: None };
    let mut values: Vec<f64> =
        (0..300).map(|at| (100.0 * normal.quantile((f64::from(at) + 0.5) / 300.0)).round() / 100.0).collect();
    values.push(0.96);
    let onset = |c: f64| (1.0 + 2.0 * c * c) / (4.0 / 3.0);
    // P(mu > x) of values at (i - 1) / (n - 1), linear between them.
    let beyond = |x: f64| {
        let above = values.partition_point(|value| *value <= x);
        if above == values.len() {
            return 0.0;
        }
        let (low, high) = (values[above - 1], values[above]);
        1.0 - ((above - 1) as f64 + (x - low) / (high - low)) / (values.len() - 1) as f64
    };
    let text = std::fs::read_to_string(paper().with_file_name("hoffmann.toml")).unwrap();
    let uniform = "distribution = \"uniform\"\nfrom = 0.5\nto = 1.1";
    let measured = format!("distribution = \"empirical\"\nvalues = {values:?}");
    let alone = text.replace(uniform, &measured);
    let drawn = "[parameters.c]\ndistribution = \"log-normal\"\nmedian = 0.3\nsigma = 0.2\n[[terms]]\nname = \"dashpots\"\ncoefficient = \"c\"\n";
    let both = alone
        .replace("[[terms]]\nname = \"dashpots\"\n", drawn)
        .replace("damping = [[0.05, 0.0], [0.0, 0.05]]", "damping = [[1.0, 0.0], [0.0, 1.0]]");
    assert!(alone != text && both.contains("coefficient") && both.contains("damping = [[1.0"));
    let step = 1e-3;
    let term = |i: i32| {
        let z = step * f64::from(i);
        (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt() * beyond(onset(0.3 * (0.2 * z).exp()))
    };
    let by_quadrature = (-9_000..=9_000).map(term).sum::<f64>() * step;
    for (text, exact) in [(alone, beyond(onset(0.05))), (both, by_quadrature)] {
        let brake = MatricesBrake::new(MatricesCase::parse(Path::new("measured.toml"), text).unwrap()).unwrap();
        let found = found(&brake, &Options::default()).unwrap();
        assert!(exact > 1e-4 && exact < 5e-3, "{exact}");
        assert!(
            holds(&found, exact) && (found.probability.value / exact - 1.0).abs() < 0.1,
            "{exact} {:?}",
            found.probability
        );
    }
}

#[test]
fn a_brake_of_which_it_cannot_be_asked_is_refused_in_one_line() {
    let refused = |brake: &MatricesBrake, said: &str| {
        let error = found(brake, &Options::default()).unwrap_err().to_string();
        assert!(error.contains(said) && !error.contains('\n'), "{error}");
    };
    let with = |from: &str, to: &str| {
        let text = std::fs::read_to_string(paper().with_file_name("hoffmann.toml")).unwrap();
        assert!(text.contains(from));
        let case = MatricesCase::parse(Path::new("hoffmann.toml"), text.replace(from, to)).unwrap();
        MatricesBrake::new(case).unwrap()
    };
    let uniform = "distribution = \"uniform\"\nfrom = 0.5\nto = 1.1";
    refused(&with("samples", "samples"), "is unstable with all inputs at their medians");
    refused(&with(uniform, "distribution = \"discrete\"\nvalues = [0.5, 0.6, 0.8]"), "the input \"mu\" is discrete");
    refused(&with(uniform, "distribution = \"constant\"\nvalue = 0.5"), "nothing is drawn");
    // One that never squeals has a bound by samples, and a certified one.
    let never = found(&with(uniform, "distribution = \"uniform\"\nfrom = 0.0\nto = 0.3"), &Options::default()).unwrap();
    assert!(never.probability.value == 0.0 && never.probability.upper < 0.003, "{never:?}");
    assert!(never.text(hoffmann(0.1, 1, 0.0).plan()).contains("no squeal was found"));
}

#[test]
#[ignore = "half a minute"]
fn a_reduced_brake_is_held_against_the_full_model_at_its_likeliest_squeal() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad/disc-pad.toml");
    let choice = SceneChoice { law: None, contact: None, constraints: None, speed: ChosenSpeed::Range(None) };
    let CaseFile::FiniteElements(mut case) = CaseFile::read(&path).unwrap().only(&choice).unwrap() else {
        unreachable!()
    };
    let mu = Distribution::Normal { mean: 0.3, deviation: 0.03, at_least: 0.0, at_most: None };
    case.contact.as_mut().unwrap().friction.mu = mu;
    let brake = brakes::make(CaseFile::FiniteElements(case), Purpose::Analysis, &()).unwrap();
    let options = Options { budget: 100, directions: 0, relative: 0.5, ..Options::default() };
    let found = found(&brake, &options).unwrap();
    let moved = found.design_points[0].moved.unwrap();
    println!("{moved:e} {:?}", found.probability);
    assert!(moved.abs() < 0.01 && found.widened > 1.0 && found.widened < 1.05, "{moved} {}", found.widened);
}
