//! Viscoelastic springs: closed forms, and random small brakes whose state matrix is assembled by hand with a dashpot in series with the spring of each branch.

use super::*;

use brakes::FiniteElementSample;
use squeal::study::{Modifiable, Parametrised};
use squeal::sweep::{Over, sweep};

/// A spring in a direction of the motion w, with branches (stiffness, rate) beside its own.
struct Maxwell {
    w: DVector<f64>,
    branches: Vec<[f64; 2]>,
}

/// All eigenvalues with Im > 0 of a brake with such springs: the branch pulls with `k (w^T u - y)`, and `y' = rate (w^T u - y)`, y the displacement of its dashpot.
fn with_branches(system: &SecondOrder, springs: &[Maxwell]) -> Vec<Complex<f64>> {
    let (n, bristles) = (system.order(), system.states());
    let branches: Vec<(&DVector<f64>, [f64; 2])> =
        springs.iter().flat_map(|spring| spring.branches.iter().map(|&branch| (&spring.w, branch))).collect();
    let inverse = system.m.clone().try_inverse().unwrap();
    // u, u' in this unit of time, the bristles, and y.
    let unit = 100.0;
    let size = 2 * n + bristles + branches.len();
    let mut state = DMatrix::zeros(size, size);
    let mut stiffness = system.k.clone();
    for (w, [k, _]) in &branches {
        stiffness.ger(*k, w, w, 1.0);
    }
    state.view_mut((0, n), (n, n)).fill_diagonal(unit);
    state.view_mut((n, 0), (n, n)).copy_from(&(-&inverse * stiffness / unit));
    state.view_mut((n, n), (n, n)).copy_from(&(-&inverse * &system.c));
    state.view_mut((n, 2 * n), (n, bristles)).copy_from(&(&inverse * &system.internal.force / unit));
    state.view_mut((2 * n, n), (bristles, n)).copy_from(&(&system.internal.drive * unit));
    for at in 0..bristles {
        state[(2 * n + at, 2 * n + at)] = -system.internal.decay[at];
    }
    for (at, (w, [k, rate])) in branches.iter().enumerate() {
        let y = 2 * n + bristles + at;
        state.view_mut((n, y), (n, 1)).copy_from(&(&inverse * *w * (k / unit)));
        state.view_mut((y, 0), (1, n)).copy_from(&(w.transpose() * *rate));
        state[(y, y)] = -rate;
    }
    state.complex_eigenvalues().iter().copied().filter(|lambda| lambda.im > 1e-6).collect()
}

/// The whole brake at an operating point as dense matrices.
pub(super) fn dense(brake: &FiniteElementBrake, scene: &Scene, sample: &FiniteElementSample) -> SecondOrder {
    let at = brake.full_point(scene, &brake.operating_point(scene, sample).unwrap());
    let system = brake.sets[0].system.assemble(&at).unwrap();
    let [m, c, k] = [&system.m, &system.c, &system.k].map(DMatrix::from);
    let mut internal = linsys::Internal::zeros(m.nrows(), system.states.len());
    for (at, state) in system.states.iter().enumerate() {
        internal.decay[at] = state.decay;
        state.drive.iter().for_each(|&(dof, value)| internal.drive[(at, dof)] += value);
        state.force.iter().for_each(|&(dof, value)| internal.force[(dof, at)] += value);
    }
    SecondOrder::with_internal(m, c, k, internal).unwrap()
}

/// The eigenvalues with Im > 0 of a dense brake.
fn oscillating(system: &SecondOrder) -> Vec<Complex<f64>> {
    let all = QrSolver.eigenvalues(system, &mut Workspace::default()).unwrap().eigenvalues;
    all.into_iter().filter(|lambda| lambda.im > 1e-6).collect()
}

/// The largest distance of some eigenvalues from the nearest of others, relative to their size.
pub(super) fn farthest<'a>(found: impl IntoIterator<Item = &'a Complex<f64>>, others: &[Complex<f64>]) -> f64 {
    let distance = |l: &Complex<f64>| others.iter().map(|o| (o - l).norm() / l.norm()).fold(f64::INFINITY, f64::min);
    found.into_iter().map(distance).fold(0.0, f64::max)
}

/// A shim between the pad and the last node, and a mount of each node of the disc.
const STIFFNESS: [f64; 2] = [8e4, 5e4];

/// The random brake with both springs, which relax or do not: the parameters are the same.
fn text(random: &Random, relaxes: bool) -> String {
    let nodes = random.structure.places.len();
    let branches = |of: &str| if relaxes { format!("viscoelastic = [{of}]\n") } else { String::new() };
    let [shim, mount] = STIFFNESS;
    let springs = format!(
        "[[springs]]\nname = \"shim\"\nnodes = \"PAD\"\nto = [\"{nodes}\"]\ndirection = [1.0, -2.0, 2.0]\nstiffness = {shim:e}\n\
         coefficient = \"c + 0*g + 0*a\"\n{}\
         [[springs]]\nname = \"mount\"\nnodes = \"DISC\"\ndirection = [0.0, 3.0, 4.0]\nstiffness = {mount:e}\ndamping = 4.0\n{}\
         [parameters.a]\nunit = \"1/s\"\ndistribution = \"log-uniform\"\nfrom = 20.0\nto = 2000.0\n\
         [parameters.c]\ndistribution = \"uniform\"\nfrom = 0.7\nto = 1.4\n\
         [parameters.g]\ndistribution = \"uniform\"\nfrom = 0.2\nto = 1.5\n",
        branches("{ ratio = \"g\", rate = \"a\" }, { ratio = \"g/2\", rate = \"3*a\" }"),
        branches("{ ratio = 0.8, rate = 300.0 }"),
    );
    random.text.replace("[contact]", &format!("{springs}[contact]"))
}

/// Springs by hand at values of a, c and g.
fn springs(random: &Random, [a, c, g]: [f64; 3]) -> Vec<Maxwell> {
    let Structure { places, pairs, .. } = &random.structure;
    let order = 3 * places.len();
    let mut w = DVector::zeros(order);
    for (d, by) in [1.0, -2.0, 2.0].map(|x| x / 3.0).into_iter().enumerate() {
        (0..*pairs).for_each(|pair| w[6 * pair + d] += by / *pairs as f64);
        w[order - 3 + d] -= by;
    }
    let shim = Maxwell { w, branches: vec![[g * c * STIFFNESS[0], a], [g / 2.0 * c * STIFFNESS[0], 3.0 * a]] };
    let mount = |pair: usize| {
        let mut w = DVector::zeros(order);
        (w[6 * pair + 4], w[6 * pair + 5]) = (0.6, 0.8);
        Maxwell { w, branches: vec![[0.8 * STIFFNESS[1] / *pairs as f64, 300.0]] }
    };
    std::iter::once(shim).chain((0..*pairs).map(mount)).collect()
}

/// Brakes of both kinds from one random structure.
fn both(random: &Random, folder: &Path) -> [FiniteElementBrake; 2] {
    random.structure.write(folder);
    [true, false].map(|relaxes| FiniteElementBrake::new(case(folder, text(random, relaxes)).unwrap(), &()).unwrap())
}

/// Under all laws, with all patches closed and with one open: the whole brake, its reduced ones on both routes, and the modes that grow.
#[test]
fn random_brakes_with_viscoelastic_springs_are_those_assembled_by_hand() {
    let [mut modes, mut growing, mut moved, mut largest] = [0.0_f64; 4];
    for at in 0..2 {
        let folder = tempfile::tempdir().unwrap();
        let random = Random::new(&mut stream(41, at));
        let [brake, plain] = both(&random, folder.path());
        for scene in &brake.plan.scenes {
            for number in 0..2 {
                let sample = brake.draw(&mut stream(1, number)).unwrap();
                let [a, c, g] = sample.values[..] else { panic!("{:?}", sample.values) };
                let structure = dense(&plain, scene, &sample);
                let expected = with_branches(&structure, &springs(&random, [a, c, g]));
                let whole = oscillating(&dense(&brake, scene, &sample));
                assert_eq!(whole.len(), expected.len(), "{at} {:?}", scene.key);
                let off = farthest(&whole, &expected).max(farthest(&expected, &whole));
                assert!(off < 1e-8, "{at} {:?}: {off:e}", scene.key);
                let [low, high] = brake.plan.band.unwrap();
                let is_wanted = |l: &&Complex<f64>| l.re > -149.0 && l.im > low && l.im < high && l.re < 0.5 * l.im;
                let point = brake.operating_point(scene, &sample).unwrap();
                let full = brake.full_point(scene, &point);
                let error = brake.relative_error(scene);
                let wanted: Vec<_> = expected.iter().filter(is_wanted).collect();
                let reduced = &brake.part(scene).reduced;
                for found in [reduced.modes_by_spectrum(&full).unwrap(), reduced.modes(&full).unwrap()] {
                    let off = farthest(wanted.iter().copied(), &found.lambdas);
                    assert!(off <= error, "{at} {:?}: missing {off:e} {error:e}", scene.key);
                    let off = farthest(found.lambdas.iter().filter(is_wanted), &expected);
                    assert!(off <= error, "{at} {:?}: invented {off:e} {error:e}", scene.key);
                    largest = largest.max(off);
                    modes += found.lambdas.len() as f64;
                }
                let grows = |l: &&Complex<f64>| l.re > 1e-2;
                let found = brake.band_modes(scene, std::slice::from_ref(&point)).remove(0).unwrap();
                let found: Vec<Complex<f64>> = found.iter().map(|mode| mode.lambda).collect();
                let of = |all: &[Complex<f64>]| all.iter().filter(is_wanted).filter(grows).count();
                assert_eq!(of(&found), of(&expected), "{at} {:?}", scene.key);
                growing += of(&expected) as f64;
                moved = moved.max(farthest(wanted.iter().copied(), &oscillating(&structure)));
            }
        }
        // What opens is a contact, never a part that relaxes.
        let states = brake.case.channels_of_branches();
        assert_eq!(states.len(), 2 + random.structure.pairs);
        for scene in &brake.plan.scenes {
            let all = brake.plan.brake(scene).system.channels();
            let contacts: Vec<usize> = brake.contacts(scene).into_iter().flat_map(|contact| contact.channels).collect();
            assert!(contacts.iter().all(|&at| all[at].is_contact));
            assert_eq!(all.len(), contacts.len() + states.len());
        }
        // Names go from the origin to all arrangements, on paths that have the states at both ends.
        let study = Study::new(&brake, &BatchSolver).unwrap();
        let named = |scene: usize| study.references()[scene].names.iter().filter(|names| names.len() == 1).count();
        assert!((0..brake.plan.scenes.len()).all(|scene| 2 * named(scene) > study.references()[scene].modes.len()));
    }
    println!("{modes} modes, {growing} growing, off by {largest:e}; the branches move modes by {moved:e}");
    assert!(modes > 200.0 && growing > 5.0 && moved > 1e-2, "{modes} {growing} {moved}");
}

/// A mass on a belt whose spring along the sliding relaxes: `m s^2 (s + a) + (k + k_t) (s + a) + g k_t s = 0`. Without anything else that damps, modes are on the
/// axis where nothing relaxes.
#[test]
fn a_mass_on_a_viscoelastic_spring_is_the_closed_form_with_its_limits() {
    let folder = tempfile::tempdir().unwrap();
    let (m, k, k_t) = (0.8, 3e4, 2e4);
    let found = |stiffness: f64, branch: &str| {
        let more = format!(
            "lateral = \"none\"\n[[springs]]\nname = \"shim\"\nnodes = [\"1\"]\ndirection = [2.0, 0.0, 0.0]\nstiffness = {stiffness:e}\n{branch}"
        );
        let case = mass_on_a_belt(folder.path(), [m, k, 2e6], [0.35, 25.0, 0.4, 0.4], &more).unwrap();
        let brake = FiniteElementBrake::new(case, &()).unwrap();
        let scene = &brake.plan.scenes[0];
        let at = brake.full_point(scene, &brake.operating_point(scene, &brake.median()).unwrap());
        let modes = brake.part(scene).reduced.modes(&at).unwrap();
        let on_axis = brake.judged(scene, &at, &modes).unwrap().iter().filter(|mode| mode.is_on_axis).count();
        (modes.lambdas, on_axis)
    };
    for (g, a) in [(0.3, 5.0), (1.2, 150.0), (4.0, 300.0), (0.7, 4e4)] {
        let (modes, on_axis) = found(k_t, &format!("viscoelastic = [{{ ratio = {g:e}, rate = {a:e} }}]"));
        let residual =
            |s: Complex<f64>| (m * s * s * (s + a) + (k + k_t) * (s + a) + g * k_t * s) / ((k + k_t) * (s + a));
        let is_it = |s: &&Complex<f64>| residual(**s).norm() < 1e-9 && s.re < -1e-3;
        assert!(modes.iter().filter(is_it).count() == 1 && on_axis == 0, "{g} {a} {modes:?}");
    }
    let cases =
        [("ratio = 0.6, rate = 1e-6", 1.6 * k_t), ("ratio = 0.6, rate = 1e12", k_t), ("ratio = 0.0, rate = 9.0", k_t)];
    for (branch, stiffness) in cases {
        let (modes, on_axis) = found(k_t, &format!("viscoelastic = [{{ {branch} }}]"));
        let (limit, all_on_axis) = found(stiffness, "");
        assert!(modes.len() == limit.len() && all_on_axis == limit.len() && limit.len() > 1, "{limit:?}");
        assert!(farthest(&modes, &limit).max(farthest(&limit, &modes)) < 1e-7, "{branch}: {modes:?} {limit:?}");
        assert_eq!(on_axis, if branch.starts_with("ratio = 0.0") { limit.len() } else { 0 }, "{branch}");
    }
}

#[test]
fn ratio_and_rate_are_swept_and_explain_what_a_mode_does() {
    let folder = tempfile::tempdir().unwrap();
    let random = Random::new(&mut stream(41, 1));
    random.structure.write(folder.path());
    let plain = FiniteElementBrake::new(case(folder.path(), text(&random, false)).unwrap(), &()).unwrap();
    for (name, from, to) in [("g", 0.0, 2.0), ("a", 10.0, 3000.0)] {
        let range = Over { name: name.into(), from, to };
        let case = case(folder.path(), text(&random, true)).unwrap();
        let brake = FiniteElementBrake::for_sweep(case, std::slice::from_ref(&range), &()).unwrap();
        let study = Study::new(&brake, &QrSolver).unwrap();
        let found = sweep(&study, 0, &range, &QrSolver, &()).unwrap();
        let scene = &brake.plan.scenes[0];
        let place = brake.parameters(scene).iter().position(|parameter| parameter.name == name).unwrap();
        let structure = dense(&plain, scene, &plain.median());
        let mut points = 0;
        for (value, point) in found.branches.iter().flat_map(|branch| &branch.points) {
            let mut values = plain.median().values;
            values[if name == "a" { 0 } else { 2 }] = *value;
            let [a, c, g] = values[..] else { panic!() };
            let expected = with_branches(&structure, &springs(&random, [a, c, g]));
            let off = farthest([&point.lambda], &expected);
            assert!(off <= brake.relative_error(scene), "{name} {value}: {off:e}");
            points += 1;
        }
        assert!(points > 20, "{points}");
        // What a sample and a value by its name make is one system.
        let mut sample = brake.median();
        sample.values[if name == "a" { 0 } else { 2 }] = to;
        let [drawn, named] =
            [brake.system(scene, &sample), brake.system_with(scene, &[(place, to)])].map(Result::unwrap);
        assert!((&drawn.k - &named.k).norm() <= 1e-12 * drawn.k.norm());
        assert_eq!((&drawn.internal.decay, drawn.states()), (&named.internal.decay, 2 + random.structure.pairs));
        if name == "a" {
            continue;
        }
        // Both branches of the shim are in proportion to g; its work is of the family of the shim.
        let mut work = Workspace::default();
        let at = brake.full_point(scene, &brake.operating_point(scene, &brake.median()).unwrap());
        let modes = brake.part(scene).reduced.modes(&at).unwrap().lambdas;
        let explainer = squeal::why::Explainer::new(&brake, scene, &mut work).unwrap();
        for why in explainer.why(&modes, &mut work).unwrap() {
            let by = |name: &str| why.influences.iter().find(|influence| influence.name == name).unwrap();
            let [of_g, of_branches] = [by("g"), by("relaxation of shim")].map(|by| by.growth_per_percent.unwrap());
            assert!((of_g - of_branches).abs() < 1e-6 * of_g.abs() + 1e-9, "{of_g} {of_branches}");
            let of_family = |name: &str| why.balance.families.iter().find(|family| family.name == name).unwrap().growth;
            assert!(of_family("shim") <= 0.0 && of_family("mount") < 0.0);
            let growth: f64 = why.balance.families.iter().map(|family| family.growth).sum();
            assert!((growth - why.lambda.re).abs() < 1e-6 * why.lambda.norm(), "{growth} {}", why.lambda);
        }
    }
}

#[test]
fn faults_of_viscoelastic_springs_are_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let random = Random::new(&mut stream(41, 0));
    random.structure.write(folder.path());
    let good = text(&random, true);
    let rate = "{ ratio = 0.8, rate = 300.0 }";
    for (from, to, expected) in [
        (
            rate,
            "{ ratio = 0.8, rate = 0.0 }",
            "springs \"mount\".viscoelastic[1].rate = 0; allowed: a rate > 0, in 1/s",
        ),
        (
            rate,
            "{ ratio = -0.8, rate = 3.0 }",
            "springs \"mount\".viscoelastic[1].ratio = -0.8; allowed: a number >= 0",
        ),
        (rate, "{ ratio = \"h\", rate = 3.0 }", "springs \"mount\".viscoelastic[1].ratio"),
        ("rate = \"3*a\"", "rate = \"g - 9\"", "springs \"shim\".viscoelastic[2].rate = -8.15; allowed: a rate > 0"),
        (rate, "{ ratio = 0.8 }", "missing field `rate`"),
        (
            "stiffness = 5e4\n",
            "",
            "springs \"mount\".viscoelastic = given without a stiffness; allowed: springs with a stiffness > 0",
        ),
        ("name = \"mount\"", "name = \"structure\"", "springs.name = \"structure\"; allowed: names that no term has"),
    ] {
        assert!(good.contains(from), "{from}");
        let refused = case(folder.path(), good.replace(from, to)).unwrap_err();
        assert!(refused.contains(expected) && !refused.trim_end().contains('\n'), "{refused}");
    }
    // A loss factor of a term may stand beside what relaxes.
    assert!(case(folder.path(), good.replace("rayleigh = ", "loss_factor = 0.01\nrayleigh = ")).is_ok());
}
