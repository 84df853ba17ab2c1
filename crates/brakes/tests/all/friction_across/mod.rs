//! Friction across the sliding of finite element brakes: closed forms, and random small brakes assembled a second time by hand.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use brakes::FiniteElementBrake;
use brakes::case::{CaseFile, FiniteElementCase};
use cea::{BatchSolver, EigenSolver, QrSolver, Workspace};
use linsys::SecondOrder;
use montecarlo::rand::{Rng, RngExt};
use montecarlo::stream;
use nalgebra::{Complex, DMatrix, DVector, Matrix3, Vector3};
use squeal::results::Results;
use squeal::study::{ModeSource, Scene, Study, UncertainBrake};

mod loss_factors;
mod viscoelastic_springs;

/// Nodes 1, 2, ... with three degrees of freedom each: pairs (pad, disc) at one place, then nodes of the structure between.
struct Structure {
    places: Vec<Vector3<f64>>,
    pairs: usize,
    mass: DMatrix<f64>,
    stiffness: DMatrix<f64>,
}

impl Structure {
    fn write(&self, folder: &Path) {
        let mut deck = String::from("*NODE\n");
        for (node, place) in self.places.iter().enumerate() {
            writeln!(deck, "{}, {:e}, {:e}, {:e}", node + 1, place.x, place.y, place.z).unwrap();
        }
        let list = |of: &mut dyn Iterator<Item = usize>| of.map(|node| format!("{}\n", node + 1)).collect::<String>();
        for (name, side) in [("PAD", 0), ("DISC", 1)] {
            write!(deck, "*NSET, NSET={name}\n{}", list(&mut (0..self.pairs).map(|pair| 2 * pair + side))).unwrap();
        }
        // The first pair is a patch, and all others are one.
        write!(deck, "*NSET, NSET=FIRST\n1\n*NSET, NSET=OTHERS\n{}", list(&mut (1..self.pairs).map(|pair| 2 * pair)))
            .unwrap();
        let order = 3 * self.places.len();
        let upper = |matrix: &DMatrix<f64>| {
            let entries = (0..order).flat_map(|j| (0..=j).map(move |i| (i, j))).filter(|&at| matrix[at] != 0.0);
            entries.map(|(i, j)| format!("{} {} {:e}\n", i + 1, j + 1, matrix[(i, j)])).collect::<String>()
        };
        let rows = (0..order).map(|row| format!("{}.{}\n", row / 3 + 1, row % 3 + 1)).collect::<String>();
        for (name, text) in [
            ("brake.inp", deck),
            ("brake.mas", upper(&self.mass)),
            ("brake.sti", upper(&self.stiffness)),
            ("brake.dof", rows),
        ] {
            std::fs::write(folder.join(name), text).unwrap();
        }
    }
}

fn case(folder: &Path, text: String) -> Result<FiniteElementCase, String> {
    match CaseFile::parse(&folder.join("brake.toml"), text).map_err(|error| error.to_string())? {
        CaseFile::FiniteElements(case) => Ok(*case),
        other => panic!("{other:?}"),
    }
}

/// All eigenvalues with Im >= 0 of M, C and K.
fn spectrum([m, c, k]: [&DMatrix<f64>; 3]) -> Vec<Complex<f64>> {
    let system = SecondOrder::new(m.clone(), c.clone(), k.clone()).unwrap();
    let all = QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap().eigenvalues;
    all.into_iter().filter(|lambda| lambda.im >= 0.0).collect()
}

/// M, C and K of the whole brake.
fn whole(brake: &FiniteElementBrake, scene: &Scene, sample: &brakes::FiniteElementSample) -> [DMatrix<f64>; 3] {
    let at = brake.full_point(scene, &brake.operating_point(scene, sample).unwrap());
    let system = brake.sets[0].system.assemble(&at).unwrap();
    [&system.m, &system.c, &system.k].map(DMatrix::from)
}

/// A mass on springs beside a belt that slides in a direction of the plane, pressed on it by a stiff spring.
fn mass_on_a_belt(
    folder: &Path,
    [m, k, k_n]: [f64; 3],
    [mu, load, from, to]: [f64; 4],
    more: &str,
) -> Result<FiniteElementCase, String> {
    let mass = DMatrix::from_diagonal_element(6, 6, m);
    let stiffness = DMatrix::from_diagonal(&DVector::from_row_slice(&[k, 1.7 * k, 2.9 * k, k, k, k]));
    Structure { places: vec![Vector3::zeros(); 2], pairs: 1, mass, stiffness }.write(folder);
    let text = format!(
        "[study]\nname = \"Belt\"\nlaws = [\"amontons-coulomb\", \"velocity-dependent\"]\nsamples = 1\nseed = 1\n\
         [brake]\nkind = \"finite-elements\"\nmesh = \"brake.inp\"\n\
         [[terms]]\nname = \"structure\"\nmass = \"brake.mas\"\nstiffness = \"brake.sti\"\n\
         [contact]\npad = \"PAD\"\ndisc = \"DISC\"\ntolerance = 1e-6\nnormal = [0.0, 0.0, 1.0]\n\
         sliding = [1.0, 0.0, 0.0]\nstiffness = {k_n:e}\nload = {load:e}\npatches = [\"FIRST\"]\nin_contact = [1]\n{more}\n\
         [[constraints]]\nname = \"none\"\nfixed = [\"2\"]\n\
         [[speeds]]\nname = \"all\"\nfrom = {from:e}\nto = {to:e}\n\
         [friction]\nmu = {{ distribution = \"constant\", value = {mu:e} }}\n\
         mu_s = {{ distribution = \"constant\", value = {:e} }}\nmu_k = {{ distribution = \"constant\", value = {mu:e} }}\n\
         alpha = {{ distribution = \"constant\", value = 1.3 }}\n\
         [reduction]\nfrequencies = [1.0, 1000.0]\ngrowth = [-1e4, 1e4]\ntraining = 2\n",
        1.4 * mu
    );
    case(folder, text)
}

#[test]
fn a_mass_on_a_belt_is_damped_across_the_sliding_and_fed_along_it() {
    let folder = tempfile::tempdir().unwrap();
    let (m, k, k_n, mu, load) = (0.8, 3e4, 2e6, 0.35, 25.0);
    for speed in [0.05, 0.4, 7.0] {
        let of = |more: &str| mass_on_a_belt(folder.path(), [m, k, k_n], [mu, load, speed, speed], more).unwrap();
        for (more, is_lateral) in [("", true), ("lateral = \"vector\"", true), ("lateral = \"none\"", false)] {
            let brake = FiniteElementBrake::new(of(more), &()).unwrap();
            assert_eq!(brake.plan.scenes.len(), 2);
            for (scene, falls) in brake.plan.scenes.iter().zip([false, true]) {
                // mu = mu_k + (mu_s - mu_k) e^(-alpha v).
                let (here, slope) = match falls {
                    false => (mu, 0.0),
                    true => (mu * (1.0 + 0.4 * (-1.3 * speed).exp()), -1.3 * 0.4 * mu * (-1.3 * speed).exp()),
                };
                let lateral = if is_lateral { here * load / speed } else { 0.0 };
                // Along, across and normal: lambda^2 m + lambda c + k = 0. Friction couples the first to the last, not back.
                let mut expected = Vec::new();
                for (c, k) in [(load * slope, k), (lateral, 1.7 * k), (0.0, 2.9 * k + k_n)] {
                    let root = Complex::new(c * c - 4.0 * m * k, 0.0).sqrt();
                    expected.extend([(-root - c) / (2.0 * m), (root - c) / (2.0 * m)]);
                }
                let [m_of, c_of, k_of] = whole(&brake, scene, &brake.median());
                let found = spectrum([&m_of, &c_of, &k_of]);
                let expected: Vec<_> = expected.into_iter().filter(|lambda| lambda.im >= 0.0).collect();
                assert_eq!(found.len(), expected.len(), "{speed} {more} {found:?} {expected:?}");
                for lambda in &expected {
                    let nearest = found.iter().map(|l| (l - lambda).norm()).fold(f64::INFINITY, f64::min);
                    assert!(nearest < 1e-9 * lambda.norm(), "{speed} {more}: {lambda} {found:?}");
                }
                // The reduced brake has the same modes; without lateral friction no force of the contact moves the mass across.
                if !is_lateral {
                    continue;
                }
                let reduced = brake.system(scene, &brake.median()).unwrap();
                let modes = spectrum([&reduced.m, &reduced.c, &reduced.k]);
                for lambda in expected.iter().filter(|lambda| lambda.im > 1.0) {
                    let nearest = modes.iter().map(|l| (l - lambda).norm()).fold(f64::INFINITY, f64::min);
                    assert!(nearest < 1e-6 * lambda.norm(), "{speed} {more}: {lambda} {modes:?}");
                }
            }
        }
    }
}

#[test]
fn friction_across_the_sliding_needs_a_speed_or_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let without_speeds = |more: &str| {
        let text = mass_on_a_belt(folder.path(), [1.0, 1e4, 1e6], [0.4, 10.0, 1.0, 1.0], "").unwrap().header.text;
        let text = text.replace("in_contact = [1]", &format!("in_contact = [1]\n{more}"));
        let speeds = text.find("[[speeds]]").unwrap();
        let text = format!("{}{}", &text[..speeds], &text[text.find("[friction]").unwrap()..]);
        case(folder.path(), text.replace(", \"velocity-dependent\"", ""))
    };
    // Cases that say nothing of either were made before there was friction across the sliding.
    assert!(!without_speeds("").unwrap().contact.unwrap().is_lateral);
    let refused = without_speeds("lateral = \"vector\"").unwrap_err();
    assert!(
        refused.contains("speeds = missing; allowed: ") && refused.contains("contact.lateral = \"none\""),
        "{refused}"
    );
    assert!(!refused.contains('\n'));
    assert!(without_speeds("lateral = \"none\"").is_ok());
    let refused = without_speeds("lateral = \"sideways\"").unwrap_err();
    assert!(refused.contains("sideways") && refused.contains("vector"), "{refused}");
}

/// A random brake and what its case file says of it.
struct Random {
    structure: Structure,
    normal: Vector3<f64>,
    /// The velocity of the disc at each pair, in the plane, at a speed of 1.
    velocities: Vec<Vector3<f64>>,
    sliding: String,
    contact_stiffness: f64,
    load: f64,
    speed: f64,
    text: String,
}

fn random_direction(rng: &mut impl Rng) -> Vector3<f64> {
    loop {
        let v = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        if (0.1..1.0).contains(&v.norm()) {
            return v.normalize();
        }
    }
}

impl Random {
    fn new(rng: &mut impl Rng) -> Self {
        let pairs = rng.random_range(2..5_usize);
        let nodes = 2 * pairs + rng.random_range(1..4_usize);
        let normal = random_direction(rng);
        let in_plane = normal.cross(&random_direction(rng)).normalize();
        let across = normal.cross(&in_plane);
        let mut places = Vec::new();
        for pair in 0..pairs {
            let place = in_plane * (0.1 + 0.02 * pair as f64) + across * rng.random_range(-0.05..0.05);
            places.extend([place, place]);
        }
        places.resize_with(nodes, || random_direction(rng) * 0.3);
        // Masses, a spring in each direction to ground and springs in random directions between random nodes.
        let order = 3 * nodes;
        let masses: Vec<f64> = (0..nodes).map(|_| rng.random_range(0.5..2.0)).collect();
        let mass = DMatrix::from_fn(order, order, |i, j| if i == j { masses[i / 3] } else { 0.0 });
        let mut stiffness = DMatrix::from_fn(order, order, |i, j| if i == j { 2e4 } else { 0.0 });
        for _ in 0..5 * nodes {
            let [a, b] = [rng.random_range(0..nodes), rng.random_range(0..nodes)];
            let (direction, k) = (random_direction(rng), rng.random_range(1e4..3e5));
            let mut along = DVector::<f64>::zeros(order);
            for d in 0..3 {
                along[3 * a + d] += direction[d];
                along[3 * b + d] -= direction[d];
            }
            stiffness.ger(k, &along, &along, 1.0);
        }
        let stiffness = (&stiffness + stiffness.transpose()) * 0.5;
        let pads: Vec<Vector3<f64>> = (0..pairs).map(|pair| places[2 * pair]).collect();
        let list = |v: Vector3<f64>| format!("[{:e}, {:e}, {:e}]", v.x, v.y, v.z);
        let (sliding, velocities): (String, Vec<Vector3<f64>>) = if rng.random_bool(0.3) {
            // A direction, partly out of the plane.
            let direction = in_plane + normal * 0.4 + across * rng.random_range(-1.0..1.0);
            let flat = direction - normal * normal.dot(&direction);
            (list(direction), vec![flat.normalize(); pairs])
        } else {
            let axis = (normal + random_direction(rng) * 0.2) * 3.0;
            let through = random_direction(rng) * 0.02;
            let of = |place: &Vector3<f64>| {
                let velocity = axis.normalize().cross(&(place - through));
                velocity - normal * normal.dot(&velocity)
            };
            let all: Vec<Vector3<f64>> = pads.iter().map(of).collect();
            let mean = all.iter().map(Vector3::norm).sum::<f64>() / pairs as f64;
            (
                format!("{{ axis = {}, through = {} }}", list(axis), list(through)),
                all.into_iter().map(|velocity| velocity / mean).collect(),
            )
        };
        let mut out = Self {
            structure: Structure { places, pairs, mass, stiffness },
            normal,
            velocities,
            sliding,
            contact_stiffness: rng.random_range(1e5..1e6),
            load: rng.random_range(20.0..400.0),
            speed: 10f64.powf(rng.random_range(-1.5..1.0)),
            text: String::new(),
        };
        out.text = format!(
            "[study]\nname = \"Random\"\nlaws = [\"amontons-coulomb\", \"velocity-dependent\", \"lugre\"]\nsamples = 10\nseed = 1\n\
             [brake]\nkind = \"finite-elements\"\nmesh = \"brake.inp\"\n\
             [[terms]]\nname = \"structure\"\nmass = \"brake.mas\"\nstiffness = \"brake.sti\"\n\
             rayleigh = {{ mass = 1.5, stiffness = 2e-5 }}\n\
             [contact]\npad = \"PAD\"\ndisc = \"DISC\"\ntolerance = 1e-6\nnormal = {}\nsliding = {}\n\
             stiffness = {:e}\nload = {:e}\npatches = [\"FIRST\", \"OTHERS\"]\nin_contact = [2, 1]\n\
             [[speeds]]\nname = \"all\"\nfrom = {:e}\nto = {:e}\n\
             [friction]\nmu = {{ distribution = \"normal\", mean = 0.5, deviation = 0.15, at_least = 0.02 }}\n\
             mu_s = {{ distribution = \"normal\", mean = 0.55, deviation = 0.06, at_least = 0.02 }}\n\
             mu_k = {{ distribution = \"normal\", mean = 0.45, deviation = 0.06, at_least = 0.02 }}\n\
             alpha = {{ distribution = \"log-normal\", median = 1.5, sigma = 0.25 }}\n\
             v_s = {{ distribution = \"log-normal\", median = 0.6, sigma = 0.25 }}\n\
             sigma0 = {{ distribution = \"log-normal\", median = 1e4, sigma = 0.2 }}\n\
             sigma1 = {{ distribution = \"constant\", value = 1.0 }}\nsigma2 = {{ distribution = \"constant\", value = 0.0 }}\n\
             [reduction]\nfrequencies = [15.0, 120.0]\ngrowth = [-150.0, 400.0]\nfull_checks = 4\n",
            list(normal),
            out.sliding,
            out.contact_stiffness * pairs as f64,
            out.load,
            out.speed,
            3.0 * out.speed,
        );
        out
    }

    /// C and K with friction mu(v) in the pairs of closed patches, (mu, mu') from the speed of each.
    fn assembled(&self, closed: &[usize], speed: f64, law: impl Fn(f64) -> (f64, f64)) -> [DMatrix<f64>; 3] {
        let Structure { mass, stiffness, pairs, .. } = &self.structure;
        let (mut c, mut k) = (mass * 1.5 + stiffness * 2e-5, stiffness.clone());
        for (pair, velocity) in self.velocities.iter().enumerate() {
            let patch = usize::from(pair > 0);
            if !closed.contains(&patch) {
                continue;
            }
            let load = self.load / if patch == 0 { 1.0 } else { (pairs - 1) as f64 };
            let (t, v, n) = (velocity.normalize(), velocity.norm() * speed, self.normal);
            let (mu, slope) = law(v);
            // On u_rel = u_pad - u_disc.
            let across = Matrix3::identity() - n * n.transpose() - t * t.transpose();
            let damping = across * (mu * load / v) + t * t.transpose() * (load * slope);
            let spring = n * n.transpose() + t * n.transpose() * mu;
            for (i, by_i) in [(6 * pair, 1.0), (6 * pair + 3, -1.0)] {
                for (j, by_j) in [(6 * pair, 1.0), (6 * pair + 3, -1.0)] {
                    for row in 0..3 {
                        for column in 0..3 {
                            c[(i + row, j + column)] += by_i * by_j * damping[(row, column)];
                            k[(i + row, j + column)] += by_i * by_j * self.contact_stiffness * spring[(row, column)];
                        }
                    }
                }
            }
        }
        [mass.clone(), c, k]
    }
}

/// Compares random brakes with what is assembled by hand, and the growing modes of their reduced brakes with those of whole spectra.
fn compared(brakes: std::ops::Range<u64>, samples: u64) -> [usize; 3] {
    let [mut matrices, mut modes, mut growing] = [0; 3];
    for at in brakes {
        let folder = tempfile::tempdir().unwrap();
        let random = Random::new(&mut stream(39, at));
        random.structure.write(folder.path());
        let brake = FiniteElementBrake::new(case(folder.path(), random.text.clone()).unwrap(), &()).unwrap();
        for scene in &brake.plan.scenes {
            let drawn: Vec<_> = (0..samples).map(|n| brake.draw(&mut stream(1, n)).unwrap()).collect();
            let points: Vec<_> = drawn.iter().map(|sample| brake.operating_point(scene, sample).unwrap()).collect();
            let all_found = brake.band_modes(scene, &points);
            for ((sample, point), found) in drawn.iter().zip(&points).zip(all_found) {
                let contacts = sample.contacts.as_ref().unwrap();
                let (draw, speed) = (contacts.contact(0), random.speed * 3f64.powf(contacts.speed_quantile));
                let own = whole(&brake, scene, sample);
                let by_law = match scene.key.law {
                    0 => Some(random.assembled(brake.closed(scene), speed, |_| (draw.mu, 0.0))),
                    1 => Some(random.assembled(brake.closed(scene), speed, |v| {
                        let fall = (draw.mu_s - draw.mu_k) * (-draw.alpha * v).exp();
                        (draw.mu_k + fall, -draw.alpha * fall)
                    })),
                    _ => None,
                };
                if let Some(expected) = &by_law {
                    for (own, expected) in own.iter().zip(expected) {
                        assert!((own - expected).norm() < 1e-11 * expected.norm(), "{at} {:?} {speed}", scene.key);
                        matrices += 1;
                    }
                }
                // Bristles are states of the whole brake.
                let expected: Vec<Complex<f64>> = match &by_law {
                    Some([m, c, k]) => spectrum([m, c, k]),
                    None => {
                        let system = brake.sets[0].system.assemble(&brake.full_point(scene, point)).unwrap();
                        let rectangle = sparse::Rectangle { re: [-1.0, 400.0], im: [90.0, 800.0] };
                        let found =
                            sparse::eigenpairs_in(&system, &rectangle, &sparse::Options::default(), &mut |_| {})
                                .unwrap();
                        found.pairs.into_iter().map(|pair| pair.lambda).collect()
                    }
                };
                let [low, high] = brake.plan.band.unwrap();
                let inside = |lambda: &&Complex<f64>| lambda.re > 1e-2 && lambda.im > low && lambda.im < high;
                let wanted: Vec<_> = expected.iter().filter(inside).collect();
                let found = found.unwrap();
                let found: Vec<_> = found.iter().map(|mode| &mode.lambda).filter(inside).collect();
                assert_eq!(found.len(), wanted.len(), "{at} {:?} {found:?} {wanted:?}", scene.key);
                for lambda in wanted {
                    let nearest = found.iter().map(|l| (*l - lambda).norm()).fold(f64::INFINITY, f64::min);
                    assert!(nearest < 1e-6 * lambda.norm(), "{at} {:?} {lambda} {found:?}", scene.key);
                    growing += 1;
                }
                // And all modes of the reduced brake in the rectangle, where that has them.
                let reduced = brake.part(scene).reduced.modes_by_spectrum(&brake.full_point(scene, point)).unwrap();
                for lambda in &reduced.lambdas {
                    if by_law.is_some() {
                        let nearest = expected.iter().map(|l| (l - lambda).norm()).fold(f64::INFINITY, f64::min);
                        assert!(nearest < 1e-5 * lambda.norm(), "{at} {:?} {lambda} {nearest}", scene.key);
                        modes += 1;
                    }
                }
            }
        }
    }
    [matrices, modes, growing]
}

#[test]
fn random_brakes_are_those_assembled_by_hand() {
    let [matrices, modes, growing] = compared(0..4, 4);
    println!("{matrices} matrices, {modes} modes, {growing} growing modes");
    assert!(matrices > 100 && modes > 200 && growing > 20, "{matrices} {modes} {growing}");
}

/// BRAKES of these, 200 without it, with 12 samples of each scene: `cargo test -p brake-squeal-brakes --test all friction_across:: -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn many_random_brakes_are_those_assembled_by_hand() {
    let brakes = std::env::var("BRAKES").ok().and_then(|text| text.parse().ok()).unwrap_or(200);
    let [matrices, modes, growing] = compared(0..brakes, 12);
    println!(
        "{brakes} brakes: {matrices} matrices, {modes} modes, {growing} growing modes, none missing and none invented"
    );
}

/// Random brakes whose springs to ground are weaker and weaker, and below zero: some diverge, some are free to move.
#[test]
fn divergence_of_the_whole_brake_is_found_whatever_the_band() {
    let [mut found_in, mut free, mut quiet] = [0; 3];
    for at in 0..10 {
        let folder = tempfile::tempdir().unwrap();
        let mut random = Random::new(&mut stream(41, at));
        let weaker = [0.0, 1e4, 2e4, 2.5e4, 1e5][(at % 5) as usize];
        let order = random.structure.stiffness.nrows();
        random.structure.stiffness -= DMatrix::identity(order, order) * weaker;
        random.structure.write(folder.path());
        let brake = FiniteElementBrake::checked(case(folder.path(), random.text.clone()).unwrap(), &()).unwrap();
        let mut has_any = false;
        for scene in brake.plan.scenes.iter().filter(|scene| scene.key.law < 2) {
            for n in 0..4 {
                let sample = brake.draw(&mut stream(1, n)).unwrap();
                let matrices = whole(&brake, scene, &sample);
                let mut expected: Vec<f64> = spectrum(matrices.each_ref())
                    .into_iter()
                    .filter(|l| l.im == 0.0 && l.re > 1e-3)
                    .map(|l| l.re)
                    .collect();
                expected.sort_by(f64::total_cmp);
                let point = brake.full_point(scene, &brake.operating_point(scene, &sample).unwrap());
                let reduced = brake.part(scene).reduced.system().assemble(&point).unwrap();
                let reduced = QrSolver.eigenvalues(&reduced, &mut Workspace::default()).unwrap();
                let found = brake.diverging(scene, &point, &reduced, 1).unwrap();
                let Some(found) = found.whole else {
                    assert_eq!(weaker, 2e4, "only a body that is free to move may leave it open");
                    continue;
                };
                assert_eq!(found.len(), expected.len(), "{at} {weaker} {:?} {found:?} {expected:?}", scene.key);
                for (found, expected) in found.iter().zip(&expected) {
                    assert!(
                        (found.re - expected).abs() < 1e-8 * expected && found.im == 0.0,
                        "{at} {found} {expected}"
                    );
                }
                has_any |= !expected.is_empty();
                found_in += usize::from(!expected.is_empty());
                free += usize::from(weaker == 2e4);
                quiet += usize::from(expected.is_empty());
            }
        }
        let checks = brake.full_checks().unwrap();
        let all = checks.divergence_where(|_| true);
        assert_eq!((all.draws, all.diverging > 0), (checks.samples, has_any), "{at} {checks:?}");
        let study = Study::new(&brake, &BatchSolver).unwrap();
        let results = Results::sampled(&study).unwrap();
        let said = results.doubts().join(" ");
        assert_eq!(said.contains("DIVERGENCE, instability without oscillation"), has_any, "{at} {said}");
        let is_open = all.open > 0;
        let share = format!("in {:.4} (95 %: ", all.diverging as f64 / all.draws as f64);
        assert!(!has_any || said.contains(&share) && said.contains("velocity-dependent "), "{said}");
        let tables = results.tables(&[], &[]).unwrap();
        let table = tables.iter().find(|table| table.name == "divergence").unwrap();
        let sum = |rows: &[Vec<String>]| rows.iter().map(|row| row[5].parse::<u64>().unwrap()).sum::<u64>();
        let laws = results.plan().labels.laws.len();
        let (of_laws, of_panels) = table.rows[1..].split_at(laws);
        assert_eq!([sum(&table.rows[..1]), sum(of_laws), sum(of_panels)], [all.diverging; 3], "{table:?}");
        assert!(results.divergence_in_words().unwrap().contains("not in the samples") || has_any || is_open);
        assert!(!is_open || said.contains("could not be told"), "{said}");
    }
    assert!(found_in >= 10 && free >= 8 && quiet >= 10, "{found_in} {free} {quiet}");
}

/// Random brakes with negative damping and weak springs to ground: pairs below the band that grow faster than they oscillate, which are neither modes of
/// it nor on the real axis.
#[test]
fn pairs_that_grow_faster_than_they_oscillate_diverge_whatever_the_band() {
    let mut pairs = 0;
    for at in 0..8 {
        let folder = tempfile::tempdir().unwrap();
        let mut random = Random::new(&mut stream(43, at));
        let order = random.structure.stiffness.nrows();
        random.structure.stiffness -= DMatrix::identity(order, order) * 1.85e4;
        random.structure.write(folder.path());
        let text = random.text.replace("rayleigh = { mass = 1.5", "rayleigh = { mass = -60.0");
        let brake = FiniteElementBrake::checked(case(folder.path(), text).unwrap(), &()).unwrap();
        let scene = &brake.plan.scenes[0];
        for n in 0..4 {
            let sample = brake.draw(&mut stream(1, n)).unwrap();
            let all = spectrum(whole(&brake, scene, &sample).each_ref());
            let expected = divergence_in(&all, 1.0);
            pairs += all.iter().filter(|l| l.re > l.im && l.re > 1.0 && l.im > 1.0).count();
            let point = brake.full_point(scene, &brake.operating_point(scene, &sample).unwrap());
            let reduced = brake.part(scene).reduced.system().assemble(&point).unwrap();
            let reduced = QrSolver.eigenvalues(&reduced, &mut Workspace::default()).unwrap();
            let found = brake.diverging(scene, &point, &reduced, 1).unwrap();
            assert!(!found.beyond);
            assert_same(&found.whole.unwrap(), &expected);
        }
    }
    assert!(pairs >= 10, "{pairs}");
}

/// What of a spectrum grows faster than it oscillates, and faster than `least`, by ascending growth.
fn divergence_in(all: &[Complex<f64>], least: f64) -> Vec<Complex<f64>> {
    let mut fast: Vec<Complex<f64>> = all.iter().copied().filter(|l| l.re > l.im && l.re > least).collect();
    fast.sort_by(|a, b| a.re.total_cmp(&b.re));
    fast
}

fn assert_same(found: &[Complex<f64>], expected: &[Complex<f64>]) {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).norm() < 1e-7 * expected.norm(), "{found} {expected}");
    }
}

/// Random brakes of which a node of the structure is pushed off its place weakly in one direction and strongly in another: up to the end of the
/// band in size no growth is told that the whole brake does not have, whatever the reduced one has.
#[test]
fn growth_rates_of_divergence_are_those_of_the_whole_brake() {
    let [mut has_any, mut has_beyond] = [0; 2];
    for at in 0..12 {
        let folder = tempfile::tempdir().unwrap();
        let mut random = Random::new(&mut stream(47, at));
        let last = random.structure.stiffness.nrows() - 1;
        random.structure.stiffness[(last, last)] -= 3e6 * 4_f64.powi((at % 4) as i32);
        random.structure.stiffness[(last - 1, last - 1)] -= 1e6;
        random.structure.write(folder.path());
        let text = random.text.replace("full_checks = 4", "full_checks = 0");
        let brake = FiniteElementBrake::new(case(folder.path(), text).unwrap(), &()).unwrap();
        let highest = TAU * brake.case.reduction.frequencies[1];
        // Without the internal states of LuGre friction, which the matrices do not have.
        for scene in brake.plan.scenes.iter().filter(|scene| scene.key.law < 2) {
            let sample = brake.draw(&mut stream(1, at)).unwrap();
            let all = divergence_in(&spectrum(whole(&brake, scene, &sample).each_ref()), 1.0);
            let (expected, beyond): (Vec<Complex<f64>>, Vec<_>) = all.into_iter().partition(|l| l.norm() <= highest);
            let point = brake.full_point(scene, &brake.operating_point(scene, &sample).unwrap());
            let reduced = brake.part(scene).reduced.system().assemble(&point).unwrap();
            let reduced = QrSolver.eigenvalues(&reduced, &mut Workspace::default()).unwrap();
            let found = brake.diverging(scene, &point, &reduced, 1).unwrap();
            assert!(!found.beyond || !beyond.is_empty(), "{at} {found:?} {beyond:?}");
            assert!(
                found.any() != Some(false) || beyond.is_empty() && expected.is_empty(),
                "{at} {found:?} {beyond:?}"
            );
            [has_any, has_beyond] =
                [has_any + usize::from(!expected.is_empty()), has_beyond + usize::from(found.beyond)];
            if let Some(found) = found.whole {
                assert_same(&found, &expected);
            }
        }
    }
    assert!(has_any >= 5, "{has_any} {has_beyond}");
}

#[test]
fn a_reduced_brake_that_is_not_checked_says_that_divergence_was_not_looked_for() {
    let folder = tempfile::tempdir().unwrap();
    let random = Random::new(&mut stream(41, 0));
    random.structure.write(folder.path());
    let text = random.text.replace("full_checks = 4", "full_checks = 0");
    let brake = FiniteElementBrake::checked(case(folder.path(), text).unwrap(), &()).unwrap();
    let study = Study::new(&brake, &BatchSolver).unwrap();
    let results = Results::sampled(&study).unwrap();
    assert!(results.doubts().iter().any(|doubt| doubt.starts_with("DIVERGENCE was not looked for")));
    let over = squeal::sweep::Over { name: "mu".into(), from: 0.1, to: 0.3 };
    let found = squeal::sweep::sweep(&study, 0, &over, &QrSolver, &()).unwrap();
    assert!(!found.counts_divergence);
    assert!(squeal::sweep::Found::Branches(Box::new(found)).text().contains("divergence was NOT looked for"));
}

/// Verdicts of a brake whose errors are not known are open for that reason, not because bounds are too large, and nothing is said of them for sure.
#[test]
fn verdicts_without_a_known_error_say_why_they_are_open() {
    let folder = tempfile::tempdir().unwrap();
    let random = Random::new(&mut stream(41, 0));
    random.structure.write(folder.path());
    let text = random.text.replace("full_checks = 4", "full_checks = 0");
    let mut brake = FiniteElementBrake::checked(case(folder.path(), text).unwrap(), &()).unwrap();
    let said = |brake: &FiniteElementBrake| {
        let study = Study::new(brake, &BatchSolver).unwrap();
        let results = Results::sampled(&study).unwrap();
        let warnings = squeal::results::findings::warnings(&results).join(" ");
        (warnings, format!("{:?}", results.answer().unwrap()))
    };
    let unknown = "at the medians or at draws of which it was not made, so that nothing is known of its errors";
    assert!(!said(&brake).0.contains(unknown));
    brake.sets[0].held_out = 1.0;
    let (warnings, page) = said(&brake);
    assert!(warnings.contains(unknown) && !warnings.contains("error bounds are larger"), "{warnings}");
    assert!(page.contains("was surely unstable") || page.contains("was any mode surely unstable"), "{page}");
}
