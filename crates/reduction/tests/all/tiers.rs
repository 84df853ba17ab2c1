//! Each way to the growing modes of a sample, forced: on a chain, on a small disc with a pad, and on a ring whose modes are double, it finds those
//! that whole spectra of the same samples have, and answers for some samples at least. Written against what a user calls, so that another
//! reduction is judged by the same.

use linsys::{Channel, ChannelGain, Lag, OperatingPoint};
use nalgebra::DMatrix;
use num_complex::Complex;
use reduction::{Combinations, Doubt, Losses, Reduced, Route, RouteCounts};
use sparse::nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{Options, Rectangle, SparseAffineSystem, SparseSecondOrder, SparseTerm, eigenpairs_in};

const SAMPLES: usize = 200;
/// Draws at which modes are known, of other numbers than those of samples.
const KNOWN: std::ops::Range<usize> = 1000..1024;

/// A brake whose samples differ in friction alone.
struct Brake {
    system: SparseAffineSystem,
    rectangle: Rectangle,
    /// The largest coefficient of friction that is drawn, and the limits of its slope.
    mu: f64,
    slopes: [f64; 2],
}

fn brake(
    [m, c, k]: [DMatrix<f64>; 3],
    channels: Vec<Channel>,
    rectangle: Rectangle,
    friction: (f64, [f64; 2]),
) -> Brake {
    let [m, c, k] = [m, c, k].map(|matrix| CscMatrix::from(&CooMatrix::from(&matrix)));
    let matrices = SparseSecondOrder::new(m, c, k).unwrap();
    let terms = vec![SparseTerm { name: "structure".into(), family: "structure".into(), matrices, loss: 0.0 }];
    Brake { system: SparseAffineSystem::new(terms, channels).unwrap(), rectangle, mu: friction.0, slopes: friction.1 }
}

/// Adds a spring between two degrees of freedom, or from one to the ground.
fn spring(k: &mut DMatrix<f64>, a: usize, b: Option<usize>, stiffness: f64) {
    k[(a, a)] += stiffness;
    if let Some(b) = b {
        k[(b, b)] += stiffness;
        k[(a, b)] -= stiffness;
        k[(b, a)] -= stiffness;
    }
}

/// A chain of forty masses that are all different, with friction in three places.
fn chain() -> Brake {
    const N: usize = 40;
    let mut k = DMatrix::zeros(N, N);
    let stiffness = |i: usize| 3.0 + (i * i % 7) as f64;
    (0..N).for_each(|i| spring(&mut k, i, (i + 1 < N).then_some(i + 1), stiffness(i + 1)));
    spring(&mut k, 0, None, stiffness(0));
    let m = DMatrix::from_fn(N, N, |i, j| if i == j { 1.0 + (i % 3) as f64 * 0.2 } else { 0.0 });
    let c = &k * 0.004 + &m * 0.01;
    let channel = |at: usize| {
        Channel::new(format!("{at}"), "friction", vec![(at, 1.0), (at + 1, -0.7)], vec![(at + 2, 2.0), (at, -0.5)])
    };
    let rectangle = Rectangle { re: [-0.4, 2.0], im: [1.9, 3.2] };
    brake([m, c, k], [1, 5, 10].map(channel).into(), rectangle, (0.45, [-0.3, -0.1]))
}

/// A ring of nodes that move along and across it, held by springs, with a pad of some masses on a part of it, or with friction against a
/// massless counterpart all around.
fn ring(nodes: usize, pad: usize) -> Brake {
    let [along, across] = [|node: usize| 2 * node, |node: usize| 2 * node + 1];
    let order = 2 * (nodes + pad);
    let (mut m, mut k) = (DMatrix::zeros(order, order), DMatrix::zeros(order, order));
    for node in 0..nodes {
        let next = (node + 1) % nodes;
        for direction in [along, across] {
            m[(direction(node), direction(node))] = 1.0;
        }
        spring(&mut k, along(node), Some(along(next)), 6.0);
        spring(&mut k, across(node), Some(across(next)), 4.0);
        spring(&mut k, along(node), None, 1.0);
        spring(&mut k, across(node), None, 1.5);
    }
    for of_pad in nodes..nodes + pad {
        let mass = 0.7 + 0.1 * (of_pad - nodes) as f64;
        (m[(along(of_pad), along(of_pad))], m[(across(of_pad), across(of_pad))]) = (mass, mass);
        spring(&mut k, along(of_pad), None, 2.0);
        spring(&mut k, across(of_pad), None, 0.8);
        let next = Some(of_pad + 1).filter(|next| *next < nodes + pad);
        spring(&mut k, along(of_pad), next.map(along), if next.is_some() { 5.0 } else { 0.0 });
        spring(&mut k, across(of_pad), next.map(across), if next.is_some() { 5.0 } else { 0.0 });
    }
    let contact = 3.0;
    let channel = |at: usize| {
        let (force, reading) = match pad {
            0 => (vec![(along(at), 1.0)], vec![(across(at), -contact)]),
            _ => {
                let own = nodes + at;
                (vec![(along(at), 1.0), (along(own), -1.0)], vec![(across(at), contact), (across(own), -contact)])
            }
        };
        Channel::new(format!("{at}"), "friction", force, reading)
    };
    let count = if pad == 0 { nodes } else { pad };
    for at in 0..count {
        spring(&mut k, across(at), (pad > 0).then(|| across(nodes + at)), contact);
        // A slope of the contact couples both directions, without which friction would drive nothing.
        let tilt = 0.4;
        (k[(along(at), across(at))], k[(across(at), along(at))]) = (tilt, tilt);
    }
    let c = &k * 0.004 + &m * 0.02;
    let rectangle = Rectangle { re: [-0.5, 2.0], im: [if pad == 0 { 2.0 } else { 1.0 }, 2.6] };
    brake([m, c, k], (0..count).map(channel).collect(), rectangle, (0.9, [-0.02, 0.01]))
}

/// Friction of sample `at`: alike in all channels or in each its own, with internal states in one sample of three.
fn point(brake: &Brake, at: usize, is_alike: bool) -> OperatingPoint {
    let part = |seed: usize| ((at * 7919 + seed * 104_729) as f64 * 0.618_033_988_75).fract();
    let [from, to] = brake.slopes;
    let gain = |channel: usize| {
        let seed = if is_alike { 0 } else { 5 * channel };
        let lag = Lag { decay: 2.0 + 3.0 * part(seed + 2), drive: 0.3 + part(seed + 3), force: -0.4 };
        ChannelGain {
            mu: brake.mu * part(seed),
            slope: from + (to - from) * part(seed + 1),
            lag: at.is_multiple_of(3).then_some(lag),
        }
    };
    OperatingPoint { coefficients: vec![1.0], channels: (0..brake.system.channels().len()).map(gain).collect() }
}

/// The growing modes of all samples, and how many samples each route answered.
struct Reduction<'a> {
    brake: &'a Brake,
    reduced: Reduced,
    points: Vec<OperatingPoint>,
}

impl<'a> Reduction<'a> {
    fn new(brake: &'a Brake, is_alike: bool) -> Self {
        let order = brake.system.order();
        let known: Vec<_> = KNOWN.map(|at| point(brake, at, is_alike)).collect();
        let all = DMatrix::identity(order, order);
        let (projected, combinations) = (brake.system.project(&all).unwrap(), Combinations::new(&brake.system, &all));
        let reduced =
            Reduced::within((&all.clone().into(), &projected, &combinations), None, &all, brake.rectangle, 1e-8)
                .unwrap();
        let reduced = reduced.with_coarse(&known).unwrap();
        let points = (0..SAMPLES).map(|at| point(brake, at, is_alike)).collect();
        Self { brake, reduced, points }
    }

    fn growing(&self, reduced: &Reduced) -> (Vec<Vec<Complex<f64>>>, RouteCounts) {
        let mut counts = RouteCounts::default();
        let found = reduced.modes_of_all(&self.points, &|lambda, also| lambda.re >= -also * lambda.norm());
        let of_sample = |found: Result<reduction::ReducedModes, _>| {
            let modes = found.unwrap();
            counts.record(modes.route);
            modes.lambdas
        };
        let found = found.into_iter().map(of_sample).collect();
        (found, counts)
    }

    /// Compares coarse modes, and spectra of many samples at once, with whole spectra of each: samples that coarse modes answered, and modes that grow
    /// in all.
    fn judged(&self) -> (u64, usize) {
        let of_one = |at: &OperatingPoint| self.reduced.modes_by_spectrum(at).unwrap().lambdas;
        let growing = |all: Vec<Complex<f64>>| all.into_iter().filter(|lambda| lambda.re >= 0.0).collect::<Vec<_>>();
        let expected: Vec<_> = self.points.iter().map(|at| growing(of_one(at))).collect();
        let (found, counts) = self.growing(&self.reduced.clone().without_coarse());
        assert_eq!(counts, RouteCounts { coarse: 0, spectra: SAMPLES as u64 });
        self.compare(&found, &expected, "spectra");
        let (found, counts) = self.growing(&self.reduced);
        self.compare(&found, &expected, "coarse modes");
        println!("{:?} columns of {}, {counts:?}", self.reduced.coarse_columns(), self.reduced.basis().ncols());
        (counts.coarse, expected.iter().map(Vec::len).sum())
    }

    /// The modes found are those expected, as sets.
    fn compare(&self, found: &[Vec<Complex<f64>>], expected: &[Vec<Complex<f64>>], way: &str) {
        let highest = self.brake.rectangle.im[1];
        for (at, (found, expected)) in found.iter().zip(expected).enumerate() {
            let mut left = expected.clone();
            for lambda in found {
                let nearest =
                    (0..left.len()).min_by(|&a, &b| (left[a] - lambda).norm().total_cmp(&(left[b] - lambda).norm()));
                let place = nearest.filter(|&place| (left[place] - lambda).norm() <= 1e-7 * highest);
                assert!(place.is_some(), "{way}, {at}: {lambda} of {expected:?}");
                left.swap_remove(place.unwrap());
            }
            assert!(left.is_empty(), "{way}, {at}: without {left:?} of {expected:?}");
        }
    }
}

/// Judges a brake with one friction in all channels and with one in each. Coarse modes answer most samples where there are some: modes of a ring whose
/// forty contacts have a friction each lie in all directions.
fn each_way_finds_growing_modes(brake: &Brake) {
    for is_alike in [true, false] {
        let (coarse, grown) = Reduction::new(brake, is_alike).judged();
        let is_spread = !is_alike && brake.system.channels().len() > 30;
        assert!(coarse > SAMPLES as u64 / 2 || is_spread, "{is_alike}: {coarse} samples");
        assert!(grown > 50, "{is_alike}: {grown} modes");
    }
}

#[test]
fn each_way_finds_the_growing_modes_of_a_chain() {
    each_way_finds_growing_modes(&chain());
}

#[test]
fn each_way_finds_the_growing_modes_of_a_disc_with_a_pad() {
    each_way_finds_growing_modes(&ring(40, 6));
}

/// A brake with loss factors in the place of its damping by stiffness.
fn lossy(mut brake: Brake, loss: f64) -> Brake {
    let mut terms = brake.system.terms().to_vec();
    let damping = terms[0].matrices.m.clone() * 0.01;
    terms[0].matrices.c = damping;
    terms[0].loss = loss;
    brake.system = SparseAffineSystem::new(terms, brake.system.channels().to_vec()).unwrap();
    brake
}

/// Draw `number` of a brake, whose stiffness differs too.
fn stiffened(brake: &Brake, number: usize) -> OperatingPoint {
    let mut at = point(brake, number, false);
    at.coefficients[0] = 0.9 + 0.2 * ((number * 31) as f64 * 0.618_033_988_75).fract();
    at
}

/// The reduction of a brake with loss factors on all its columns, with the largest distance of dashpots from them.
fn reduced_with_losses(brake: &Brake) -> (Reduced, f64) {
    let order = brake.system.order();
    let all = DMatrix::identity(order, order);
    let (projected, combinations) = (brake.system.project(&all).unwrap(), Combinations::new(&brake.system, &all));
    let losses = Losses::new(&brake.system, &projected, &stiffened(brake, KNOWN.start)).unwrap().unwrap();
    let with_dashpots = losses.with_dashpots(&projected).unwrap();
    let of = (&all.clone().into(), &with_dashpots, &combinations);
    let reduced = Reduced::within(of, Some(&losses), &all, brake.rectangle, 1e-8).unwrap();
    let known: Vec<_> = KNOWN.map(|number| stiffened(brake, number)).collect();
    let distance = reduced.distance_of_losses(&known).unwrap();
    (reduced.with_coarse(&known).unwrap().with_distance_of_losses(distance), distance)
}

/// The eigenvalues of the whole brake in its rectangle at a point.
fn of_whole(brake: &Brake, at: &OperatingPoint) -> Vec<Complex<f64>> {
    let whole = brake.system.assemble(at).unwrap();
    let found = eigenpairs_in(&whole, &brake.rectangle, &Options::default(), &mut |_| ()).unwrap();
    found.pairs.iter().map(|pair| pair.lambda).collect()
}

/// Growing modes with loss factors are those of the whole complex stiffness, of which dashpots alone are farther off.
#[test]
fn each_way_finds_the_growing_modes_with_loss_factors() {
    for brake in [lossy(chain(), 0.02), lossy(ring(40, 6), 0.01)] {
        let (reduced, distance) = reduced_with_losses(&brake);
        assert!(distance > 1e-6 && distance < 5e-3, "{distance}");
        let points: Vec<_> = (0..30).map(|number| stiffened(&brake, number)).collect();
        let grows = |lambda: &Complex<f64>| lambda.re >= 0.0;
        let expected = points.iter().map(|at| of_whole(&brake, at).into_iter().filter(grows).collect::<Vec<_>>());
        let expected: Vec<_> = expected.collect();
        assert!(expected.iter().map(Vec::len).sum::<usize>() > 10);
        let judged = Reduction { brake: &brake, reduced: reduced.clone(), points };
        for (way, reduced) in [("coarse", &reduced), ("spectra", &reduced.clone().without_coarse())] {
            let (found, counts) = judged.growing(reduced);
            judged.compare(&found, &expected, way);
            assert!(way == "spectra" || counts.coarse > 15, "{counts:?}");
        }
    }
}

/// Modes whose dashpots are no guess of them, as with a loss factor of 0.9, are those of the whole complex spectrum.
#[test]
fn modes_that_no_guess_leads_to_are_found_from_all_eigenvalues() {
    let mut brake = lossy(chain(), 0.9);
    brake.rectangle.re = [-2.0, 2.0];
    let (reduced, _) = reduced_with_losses(&brake);
    let points: Vec<_> = (0..6).map(|number| stiffened(&brake, number)).collect();
    let found: Vec<_> = points.iter().map(|at| reduced.modes(at).unwrap()).collect();
    assert!(found.iter().all(|modes| modes.route == Route::Spectrum(Some(Doubt::Loss))));
    assert!(found.iter().all(|modes| modes.largest_residual() < 1e-11));
    let expected: Vec<_> = points.iter().map(|at| of_whole(&brake, at)).collect();
    assert!(expected.iter().all(|modes| modes.len() > 5));
    let found: Vec<_> = found.into_iter().map(|modes| modes.lambdas).collect();
    Reduction { brake: &brake, reduced, points }.compare(&found, &expected, "all eigenvalues");
}

/// `cargo test -p brake-squeal-reduction --test all tiers:: -- --ignored`
#[test]
#[ignore = "a minute"]
fn each_way_finds_the_growing_modes_of_a_ring_with_double_ones() {
    each_way_finds_growing_modes(&ring(40, 0));
}
