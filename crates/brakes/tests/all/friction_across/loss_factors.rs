//! Loss factors: random small brakes against the complex stiffness assembled by hand.

use brakes::Bases;
use montecarlo::Experiment as _;
use squeal::screen::{Attached, Change, ChangeSet, Modified};
use squeal::sweep::{Over, sweep};

use super::viscoelastic_springs::farthest;
use super::*;

/// All eigenvalues with Im > 0 of `M x'' + C x' + (K + i H) x` with the internal states of a system.
fn with_loss(system: &SecondOrder, h: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let (n, s) = (system.order(), system.states());
    let inverse = system.m.clone().try_inverse().unwrap();
    let unit = 1000.0;
    let complex = |a: DMatrix<f64>| a.map(Complex::from);
    let mut state = DMatrix::zeros(2 * n + s, 2 * n + s);
    state.view_mut((0, n), (n, n)).fill_diagonal(Complex::from(unit));
    let stiffness = (&inverse * &system.k).zip_map(&(&inverse * h), |k, h| Complex::new(-k, -h) / unit);
    state.view_mut((n, 0), (n, n)).copy_from(&stiffness);
    state.view_mut((n, n), (n, n)).copy_from(&complex(-(&inverse * &system.c)));
    state.view_mut((n, 2 * n), (n, s)).copy_from(&complex(&inverse * &system.internal.force / unit));
    state.view_mut((2 * n, n), (s, n)).copy_from(&complex(&system.internal.drive * unit));
    (0..s).for_each(|at| state[(2 * n + at, 2 * n + at)] = Complex::from(-system.internal.decay[at]));
    let all = nalgebra::Schur::new(state).eigenvalues().unwrap();
    all.iter().copied().filter(|lambda| lambda.im > 1e-6).collect()
}

/// A random brake whose structure has a loss factor, or what else `damping` says.
fn text(random: &Random, damping: &str) -> String {
    let name = "name = \"structure\"\n";
    assert!(random.text.contains(name));
    random.text.replace(name, &format!("{name}{damping}\n"))
}

/// Under all laws, with all patches closed and with one open: the reduced brakes on both routes have the modes of the complex stiffness, far from where
/// dashpots have its loss, and verdicts are those of these modes.
#[test]
fn random_brakes_with_a_loss_factor_are_those_of_the_complex_stiffness() {
    let eta = 0.01;
    let [mut modes, mut growing, mut of_dashpots] = [0.0_f64; 3];
    for at in 0..2 {
        let folder = tempfile::tempdir().unwrap();
        let random = Random::new(&mut stream(43, at));
        random.structure.write(folder.path());
        let of =
            |damping: &str| FiniteElementBrake::new(case(folder.path(), text(&random, damping)).unwrap(), &()).unwrap();
        let [brake, plain] = [&format!("loss_factor = {eta}"), ""].map(of);
        let [low, high] = brake.plan.band.unwrap();
        let middle = (low * high).sqrt() / TAU;
        let dashpots = of(&format!("loss_factor = {{ value = {eta}, at_hz = {middle:e} }}"));
        for scene in &brake.plan.scenes {
            for number in 0..2 {
                let sample = brake.draw(&mut stream(1, number)).unwrap();
                let whole = viscoelastic_springs::dense(&plain, scene, &sample);
                let structure = plain.sets[0].system.terms().iter().position(|term| term.name == "structure").unwrap();
                let point = brake.operating_point(scene, &sample).unwrap();
                let full = brake.full_point(scene, &point);
                let own = DMatrix::from(&plain.sets[0].system.terms()[structure].matrices.k);
                let expected = with_loss(&whole, &(own * (eta * full.coefficients[structure])));
                let is_wanted = |l: &&Complex<f64>| l.re > -149.0 && l.im > low && l.im < high && l.re < 0.5 * l.im;
                let wanted: Vec<_> = expected.iter().filter(is_wanted).collect();
                // The system with dashpots is farther off than the modes.
                let error = brake.relative_error(scene);
                assert!(error > 2e-5 && error < 0.2, "{error}");
                let reduced = &brake.part(scene).reduced;
                for found in [reduced.modes_by_spectrum(&full).unwrap(), reduced.modes(&full).unwrap()] {
                    let off = farthest(wanted.iter().copied(), &found.lambdas);
                    assert!(off <= 1e-6, "{at} {:?}: missing {off:e}", scene.key);
                    let off = farthest(found.lambdas.iter().filter(is_wanted), &expected);
                    assert!(off <= 1e-6, "{at} {:?}: invented {off:e}", scene.key);
                    modes += found.lambdas.len() as f64;
                }
                let found = brake.band_modes(scene, std::slice::from_ref(&point)).remove(0).unwrap();
                let found: Vec<Complex<f64>> = found.iter().map(|mode| mode.lambda).collect();
                let of = |all: &[Complex<f64>]| all.iter().filter(is_wanted).filter(|l| l.re > 1e-2).count();
                assert_eq!(of(&found), of(&expected), "{at} {:?}", scene.key);
                growing += of(&expected) as f64;
                let by_dashpots = dashpots.part(scene).reduced.modes(&full).unwrap().lambdas;
                of_dashpots = of_dashpots.max(farthest(wanted.iter().copied(), &by_dashpots));
            }
        }
        // Names are those of the system with dashpots.
        let study = Study::new(&brake, &BatchSolver).unwrap();
        let named = |scene: usize| study.references()[scene].names.iter().filter(|names| names.len() == 1).count();
        assert!((0..brake.plan.scenes.len()).all(|scene| 2 * named(scene) > study.references()[scene].modes.len()));
    }
    println!("{modes} modes, {growing} growing; dashpots at the middle of the band are off by {of_dashpots:e}");
    assert!(modes > 200.0 && growing > 5.0 && of_dashpots > 5e-3, "{modes} {growing} {of_dashpots}");
}

/// A mass on a belt whose springs have a loss factor: `m s^2 + k (1 + i eta) = 0` along the belt, and with the stiffness of the contact across it.
#[test]
fn a_mass_with_a_loss_factor_is_the_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    let (m, k, k_n, eta) = (0.8, 3e4, 2e6, 0.2);
    let mut case = mass_on_a_belt(folder.path(), [m, k, k_n], [0.35, 25.0, 0.4, 0.4], "lateral = \"none\"").unwrap();
    let mut terms = case.system.terms().to_vec();
    terms[0].loss = eta;
    case.system = sparse::SparseAffineSystem::new(terms, case.system.channels().to_vec()).unwrap();
    let brake = FiniteElementBrake::new(case, &()).unwrap();
    let scene = &brake.plan.scenes[0];
    let at = brake.full_point(scene, &brake.operating_point(scene, &brake.median()).unwrap());
    let modes = brake.part(scene).reduced.modes(&at).unwrap();
    let expected = [k, 1.7 * k, 2.9 * k].map(|own| {
        let contact = if own == 2.9 * k { k_n } else { 0.0 };
        (Complex::new(-(own + contact), -eta * own) / m).sqrt() * -1.0
    });
    let off = farthest(&modes.lambdas, &expected).max(farthest(&expected, &modes.lambdas));
    assert!(off < 1e-9, "{off:e} {:?} {expected:?}", modes.lambdas);
    let judged = brake.judged(scene, &at, &modes).unwrap();
    assert!(judged.iter().all(|mode| !mode.is_on_axis && mode.lambda.re < 0.0));
}

/// The system of a random brake with dashpots in the place of its loss factors, with the complex stiffness in their place: all eigenvalues with Im > 0.
/// `without` is the brake without loss factors, `changed` what was made of the system with dashpots.
fn with_loss_in_place_of_dashpots(
    (brake, without): (&FiniteElementBrake, &FiniteElementBrake),
    (scene, at): (&Scene, &linsys::OperatingPoint),
    (eta, changed): (f64, &SecondOrder),
) -> Vec<Complex<f64>> {
    let full = brake.full_point(scene, at);
    let system = &without.sets[scene.key.constraints].system;
    let structure = system.terms().iter().position(|term| term.name == "structure").unwrap();
    let plain = system.project(&brake.part(scene).reduced.basis()).unwrap();
    let dashpots = brake.plan.brake(scene).system.assemble(at).unwrap().c - plain.assemble(&full).unwrap().c;
    let h = &plain.terms()[structure].matrices().k * (eta * full.coefficients[structure]);
    let c = &changed.c - dashpots;
    with_loss(&SecondOrder { c, ..changed.clone() }, &h)
}

/// A screen of a brake with loss factors: as it is it has the verdicts of its study, and with a mass, a spring or a contact less the modes of the complex
/// stiffness, from which those of dashpots are far away.
#[test]
fn changed_brakes_keep_their_loss_factors() {
    let eta = 0.05;
    let [mut modes, mut of_dashpots] = [0.0_f64; 2];
    for seed in 0..2 {
        let folder = tempfile::tempdir().unwrap();
        let random = Random::new(&mut stream(47, seed));
        random.structure.write(folder.path());
        let case = |damping: &str| case(folder.path(), text(&random, damping)).unwrap();
        let brake = FiniteElementBrake::on(case(&format!("loss_factor = {eta}")), Bases::OfEachSet, &()).unwrap();
        let without = FiniteElementBrake::on(case(""), Bases::OfEachSet, &()).unwrap();
        assert!(squeal::check_real(&brake, "this").is_err() && squeal::check_real(&without, "this").is_ok());
        let first = brake.system(&brake.plan.scenes[0], &brake.median()).unwrap();
        let attach = |what, size| vec![Change::Attach { what, size, along: vec![vec![(0, 1.0), (1, -0.5)]] }];
        let sets = [
            ("as it is", Vec::new()),
            ("mass", attach(Attached::Mass, 0.1 * first.m[(0, 0)])),
            ("spring", attach(Attached::Spring, 0.1 * first.k[(0, 0)])),
            ("a contact less", vec![Change::TakeOut { contact: 0 }]),
        ];
        let sets = sets.map(|(name, changes)| ChangeSet { name: name.into(), of: 0, changes });
        assert!(Modified::new(&without, &sets).unwrap().mode_source().is_none());
        let modified = Modified::new(&brake, &sets).unwrap();
        let source = modified.mode_source().unwrap();
        let [low, high] = brake.plan.band.unwrap();
        for scene in &modified.plan().scenes {
            let is_it = |own: &&Scene| {
                let (key, other) = (own.key, scene.key);
                own.members == scene.members && (key.law, key.panel, key.speed) == (other.law, other.panel, other.speed)
            };
            let own = brake.plan.scenes.iter().find(is_it).unwrap();
            let sample = brake.draw(&mut stream(1, 3)).unwrap();
            let [at, of_own] =
                [modified.operating_point(scene, &sample), brake.operating_point(own, &sample)].map(Result::unwrap);
            let changed = modified.plan().brake(scene).system.assemble(&at).unwrap();
            let expected = with_loss_in_place_of_dashpots((&brake, &without), (own, &of_own), (eta, &changed));
            let found = source.band_modes(scene, std::slice::from_ref(&at)).remove(0).unwrap();
            let found: Vec<Complex<f64>> = found.iter().map(|mode| mode.lambda).collect();
            // Those that surely are stable may be missing.
            let is_wanted =
                |l: &&Complex<f64>| l.re > 1e-2 && l.im > 1.001 * low && l.im < 0.999 * high && l.re < 0.5 * l.im;
            let off = farthest(expected.iter().filter(is_wanted), &found);
            assert!(off <= 1e-6, "{seed} {:?}: missing {off:e}", scene.key);
            let off = farthest(found.iter().filter(is_wanted), &expected);
            assert!(off <= 1e-6, "{seed} {:?}: invented {off:e}", scene.key);
            let by_dashpots = spectrum([&changed.m, &changed.c, &changed.k]);
            if changed.states() == 0 {
                of_dashpots = of_dashpots.max(farthest(expected.iter().filter(is_wanted), &by_dashpots));
            }
            modes += found.len() as f64;
        }
        let [of_brake, of_modified] = [
            Study::new(&brake, &BatchSolver)
                .map(|study| {
                    let sample = brake.draw(&mut stream(1, 5)).unwrap();
                    (0..brake.plan.scenes.len())
                        .map(|scene| study.evaluate(scene, &sample, &mut Default::default()).unwrap().instabilities())
                        .sum::<u32>()
                })
                .unwrap(),
            Study::new(&modified, &BatchSolver)
                .map(|study| {
                    let sample = modified.draw(&mut stream(1, 5)).unwrap();
                    let of_first =
                        modified.plan().scenes.iter().enumerate().filter(|(_, scene)| scene.key.constraints == 0);
                    of_first
                        .map(|(scene, _)| {
                            study.evaluate(scene, &sample, &mut Default::default()).unwrap().instabilities()
                        })
                        .sum()
                })
                .unwrap(),
        ];
        assert_eq!(of_brake, of_modified);
    }
    println!("{modes} modes; dashpots are off by {of_dashpots:e}");
    assert!(modes > 30.0 && of_dashpots > 1e-4, "{modes} {of_dashpots:e}");
}

/// Branches of a sweep are followed with dashpots in the place of loss factors. Wherever the brake itself has other unstable modes than its onsets say, the sweep
/// says so: its number of unstable modes is that of the complex stiffness at each place where it counts.
#[test]
fn a_sweep_of_a_brake_with_loss_factors_counts_with_them() {
    let (eta, mut said, mut unstable) = (0.1, 0, 0);
    for seed in 0..3 {
        let folder = tempfile::tempdir().unwrap();
        let random = Random::new(&mut stream(47, seed));
        random.structure.write(folder.path());
        let range = Over { name: "mu".into(), from: 0.1, to: 4.0 };
        let of = |damping: &str| {
            let case = case(folder.path(), text(&random, damping)).unwrap();
            FiniteElementBrake::for_sweep(case, std::slice::from_ref(&range), &()).unwrap()
        };
        let [brake, without] = [&format!("loss_factor = {eta}"), ""].map(of);
        let study = Study::new(&brake, &QrSolver).unwrap();
        let found = sweep(&study, 0, &range, &QrSolver, &()).unwrap();
        let steps = found.loss_steps.unwrap();
        let scene = &brake.plan.scenes[0];
        let [low, high] = brake.plan.band.unwrap();
        for step in 0..=steps {
            let mu = range.from + (range.to - range.from) * step as f64 / steps as f64;
            let mut at = brake.operating_point(scene, &brake.median()).unwrap();
            // All that friction without a slope does is proportional to mu.
            at.channels.iter_mut().for_each(|gain| (gain.mu, gain.slope) = (gain.mu * mu / 0.5, gain.slope * mu / 0.5));
            let system = brake.plan.brake(scene).system.assemble(&at).unwrap();
            let all = with_loss_in_place_of_dashpots((&brake, &without), (scene, &at), (eta, &system));
            let is_studied = |l: &&Complex<f64>| l.im > low && l.im < high && l.re < 0.5 * l.im;
            let near =
                |l: &&Complex<f64>| l.re.abs() < 1e-2 || (l.im - low).abs().min((l.im - high).abs()) < 1e-3 * l.im;
            if all.iter().any(|l| near(&l)) {
                continue;
            }
            let expected = all.iter().filter(is_studied).filter(|l| l.re > 0.0).count() as i64;
            let onsets: i64 =
                found.onsets.iter().filter(|onset| onset.at <= mu).map(|onset| if onset.starts { 1 } else { -1 }).sum();
            let corrections = found.miscounts.iter().filter(|miscount| miscount.at <= mu);
            let corrected: i64 = corrections.map(|miscount| miscount.by_spectrum as i64 - miscount.by_onsets).sum();
            assert_eq!(found.unstable_at_start as i64 + onsets + corrected, expected, "{seed}: mu = {mu}");
            unstable += expected;
        }
        said += found.miscounts.len();
    }
    println!("{said} places where onsets of dashpots miscount, {unstable} unstable modes");
    assert!(unstable > 20, "{unstable}");
}
