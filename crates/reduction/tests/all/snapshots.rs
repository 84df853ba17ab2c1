//! A basis of modes at a few points: its columns follow the modes and not the contacts, and it serves for frictions and arrangements in between.

use cea::{EigenSolver as _, QrSolver, Workspace};
use linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint};
use nalgebra::DMatrix;
use num_complex::Complex;
use reduction::{NearModes, ReductionError, Snapshots, compared};
use sparse::nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{Rectangle, SparseAffineSystem, SparseSecondOrder, SparseTerm};

/// The patches of the contact, which open one by one.
const PATCHES: usize = 3;
/// Singular values, of vectors of unit length, down to which directions are in a basis.
const FLOOR: f64 = 1e-7;
const BAND: Rectangle = Rectangle { re: [-0.6, 3.0], im: [2.0, 16.0] };

/// Two taut strings beside each other, cut into n pieces, that move along and across their contact: a pad on a disc, whatever n is. The first term is
/// the strings, the others are the springs of a third of the contact each; friction acts in n pairs.
fn strings(n: usize) -> SparseAffineSystem {
    let h = 1.0 / n as f64;
    let dof = |body: usize, node: usize, direction: usize| 2 * (body * n + node) + direction;
    let order = 4 * n;
    let zeros = || DMatrix::<f64>::zeros(order, order);
    let (mut m, mut k) = (zeros(), zeros());
    // Tension along and across, and what holds each body, per length.
    for (body, tension, held) in [(0, [3.0, 2.0], 9.0), (1, [1.3, 0.9], 14.0)] {
        for (direction, tension) in tension.into_iter().enumerate() {
            for node in 0..n {
                let at = dof(body, node, direction);
                m[(at, at)] += h;
                k[(at, at)] += held * h;
                if node + 1 < n {
                    let next = dof(body, node + 1, direction);
                    let stiffness = tension / h;
                    k[(at, at)] += stiffness;
                    k[(next, next)] += stiffness;
                    k[(at, next)] -= stiffness;
                    k[(next, at)] -= stiffness;
                }
            }
        }
        // What couples both directions, without which friction would drive nothing.
        for node in 0..n {
            let (along, across) = (dof(body, node, 0), dof(body, node, 1));
            k[(along, across)] += 2.5 * h;
            k[(across, along)] += 2.5 * h;
        }
    }
    let c = &m * 0.02 + &k * 5e-4;
    let stiffness = 60.0 * h;
    let patch = |node: usize| node * PATCHES / n;
    let spring = |of: usize| {
        let mut k = zeros();
        for node in (0..n).filter(|&node| patch(node) == of) {
            let (a, b) = (dof(0, node, 1), dof(1, node, 1));
            k[(a, a)] += stiffness;
            k[(b, b)] += stiffness;
            k[(a, b)] -= stiffness;
            k[(b, a)] -= stiffness;
        }
        k
    };
    let sparse = |matrix: &DMatrix<f64>| CscMatrix::from(&CooMatrix::from(matrix));
    let term = |name: String, [m, c, k]: [&DMatrix<f64>; 3]| SparseTerm {
        matrices: SparseSecondOrder::new(sparse(m), sparse(c), sparse(k)).unwrap(),
        loss: 0.0,
        family: name.clone(),
        name,
    };
    let mut terms = vec![term("strings".into(), [&m, &c, &k])];
    terms.extend((0..PATCHES).map(|of| term(format!("patch {of}"), [&zeros(), &zeros(), &spring(of)])));
    let channel = |node: usize| {
        let (along, across) = ([dof(0, node, 0), dof(1, node, 0)], [dof(0, node, 1), dof(1, node, 1)]);
        let force = vec![(along[0], 1.0), (along[1], -1.0)];
        Channel::new(format!("{node}"), "friction", force, vec![(across[0], stiffness), (across[1], -stiffness)])
    };
    SparseAffineSystem::new(terms, (0..n).map(channel).collect()).unwrap()
}

/// A point with one coefficient of friction in all closed patches.
fn at(n: usize, mu: f64, open: Option<usize>) -> OperatingPoint {
    let is_closed = |patch: usize| Some(patch) != open;
    let gain = |node: usize| match is_closed(node * PATCHES / n) {
        true => ChannelGain { mu: 4.0 * mu, slope: -0.02 / n as f64, ..ChannelGain::default() },
        false => ChannelGain::default(),
    };
    let closed = (0..PATCHES).map(|patch| f64::from(is_closed(patch)));
    OperatingPoint { coefficients: [1.0].into_iter().chain(closed).collect(), channels: (0..n).map(gain).collect() }
}

/// The eigenvalues in the band, and to its right.
fn eigenvalues(system: &linsys::SecondOrder) -> Vec<Complex<f64>> {
    let all = QrSolver.eigenvalues(system, &mut Workspace::default()).unwrap().eigenvalues;
    all.into_iter().filter(|lambda| BAND.contains_to_the_right(*lambda, 0.0)).collect()
}

/// The whole system as a dense one.
fn dense(system: &SparseAffineSystem) -> AffineSystem {
    system.project(&DMatrix::identity(system.order(), system.order())).unwrap()
}

/// Points of the basis: the ends of what is drawn with all patches closed, and one with each patch open.
fn taken(n: usize) -> Vec<OperatingPoint> {
    let opened = [0.2, 0.7, 0.45].into_iter().enumerate().map(|(patch, mu)| at(n, mu, Some(patch)));
    [0.1, 0.45, 0.8].into_iter().map(|mu| at(n, mu, None)).chain(opened).collect()
}

/// Refined twice, the strings have four times as many pairs and degrees of freedom, and no more columns.
#[test]
fn columns_follow_modes_and_hold_every_friction_and_arrangement_between_the_points() {
    let mut columns = Vec::new();
    for n in [15, 30, 60] {
        let system = strings(n);
        let mut snapshots = Snapshots::new(&system, BAND, sparse::Options::default());
        for point in taken(n) {
            let modes = snapshots.at(&point).unwrap();
            snapshots.add(&modes).unwrap();
        }
        let (basis, _) = snapshots.basis(FLOOR, 300).unwrap();
        assert!((basis.tr_mul(&basis) - DMatrix::identity(basis.ncols(), basis.ncols())).amax() < 1e-12);
        let (reduced, whole) = (system.project(&basis).unwrap(), dense(&system));
        let (mut growing, mut modes) = (0, 0);
        for draw in 0..12 {
            let mu = 0.1 + 0.7 * (0.618 * f64::from(draw)).fract();
            let point = at(n, mu, [None, Some(0), Some(1), Some(2)][draw as usize % 4]);
            let expected = eigenvalues(&whole.assemble(&point).unwrap());
            let found = compared(&expected, &eigenvalues(&reduced.assemble(&point).unwrap()));
            assert!(found.missed.is_empty() && found.left.is_empty(), "{n} {point:?}: {found:?}");
            assert!(found.distance < 1e-6, "{n} {draw}: {}", found.distance);
            growing += expected.iter().filter(|lambda| lambda.re > 0.0).count();
            modes += expected.len();
        }
        assert!(growing > 0 && modes > 60, "{growing} of {modes}");
        columns.push(basis.ncols());
    }
    let most = 13 * columns[0] / 10;
    assert!(columns.iter().all(|&count| count <= most), "{columns:?}");
}

/// What is foreseen of a draw whose modes are not in a basis is what eigenvalues on it are off by.
#[test]
fn errors_are_foreseen_from_what_a_basis_misses() {
    let n = 30;
    let system = strings(n);
    let (mut snapshots, whole) = (Snapshots::new(&system, BAND, sparse::Options::default()), dense(&system));
    for (count, point) in taken(n).into_iter().enumerate() {
        let modes = snapshots.at(&point).unwrap();
        snapshots.add(&modes).unwrap();
        let (basis, _) = snapshots.basis(FLOOR, 300).unwrap();
        let error = modes.error(&basis).unwrap();
        assert!(error < 1e-9, "{count}: {error:e}");
        let reduced = system.project(&basis).unwrap();
        for (mu, open) in [(0.3, None), (0.6, Some(1)), (0.5, Some(2))] {
            let held_out = at(n, mu, open);
            let foreseen = snapshots.at(&held_out).unwrap().error(&basis).unwrap();
            let expected = eigenvalues(&whole.assemble(&held_out).unwrap());
            let found = compared(&expected, &eigenvalues(&reduced.assemble(&held_out).unwrap()));
            if foreseen < 1e-4 {
                assert!(found.missed.is_empty() && found.left.is_empty(), "{found:?}");
                assert!(found.distance < 3.0 * foreseen + 1e-9, "{count} {mu}: {:e}, {foreseen:e}", found.distance);
            }
        }
    }
}

#[test]
fn a_basis_without_points_or_modes_is_refused() {
    let system = strings(15);
    let none = Snapshots::new(&system, BAND, sparse::Options::default()).basis(FLOOR, 300);
    assert!(matches!(none, Err(ReductionError::NoModes)), "{none:?}");
    let mut beyond = Snapshots::new(&system, Rectangle { im: [1e-3, 2e-3], ..BAND }, sparse::Options::default());
    let modes = beyond.at(&taken(15)[0]).unwrap();
    beyond.add(&modes).unwrap();
    let none = beyond.basis(FLOOR, 300);
    assert!(modes.lambdas().is_empty() && matches!(none, Err(ReductionError::NoModes)), "{none:?}");
}

/// Modes at one point, led to others by corrections of each, make a basis that holds all modes there, and at points in between: with open patches modes at the one point alone do not.
#[test]
fn modes_led_to_other_points_hold_the_modes_there() {
    for n in [15, 30, 60] {
        let system = strings(n);
        let mut snapshots = Snapshots::new(&system, BAND, sparse::Options::default());
        let median = at(n, 0.45, None);
        let around = snapshots.modes_around(&median, &sparse::Options::default()).unwrap();
        let near = NearModes::new(&system, &BAND, &around, 1).unwrap();
        snapshots.add(&snapshots.known(&median, around)).unwrap();
        let (of_one, _) = snapshots.basis(FLOOR, 200).unwrap();
        for point in taken(n) {
            let led = near.at(&point).unwrap();
            assert!(led.len() >= snapshots.at(&point).unwrap().lambdas().len(), "{n}: a mode is missing");
            snapshots.add(&snapshots.known(&point, led)).unwrap();
        }
        let (basis, _) = snapshots.basis(FLOOR, 200).unwrap();
        let opened = (0..PATCHES).flat_map(|patch| [0.2, 0.45, 0.7].map(|mu| at(n, mu, Some(patch))));
        for point in opened.chain([0.1, 0.3, 0.8].map(|mu| at(n, mu, None))) {
            let found = snapshots.at(&point).unwrap();
            let [before, error] = [&of_one, &basis].map(|basis| found.error(basis).unwrap());
            assert!(error < 1e-8, "{n}: {error:e}");
            assert!(before > 1e-4 || point.coefficients == median.coefficients, "{n}: {before:e}");
        }
        assert!(matches!(NearModes::new(&system, &BAND, &[], 1), Err(ReductionError::NoModes)));
    }
}
