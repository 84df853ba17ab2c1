//! All eigenvalues in a rectangle, compared with those of the certified dense solver.

use cea::certified::{certify, solve};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use proptest::prelude::*;
use sparse::nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{Eigenpair, Found, Options, Rectangle, SparseError, SparseSecondOrder, State, eigenpairs_in};

/// Numbers that look random and are the same in every run.
struct Numbers(u64);

impl Numbers {
    /// From -1 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1u64 << 30) as f64 - 1.0
    }
}

/// A disc as a ring of masses on springs that also hold it, with friction forces that follow a neighbour's normal motion.
struct Ring {
    masses: usize,
    gyroscopic: f64,
    friction: f64,
    massless: usize,
    states: usize,
    disorder: f64,
}

const RING: Ring = Ring { masses: 40, gyroscopic: 0.0, friction: 0.0, massless: 0, states: 0, disorder: 0.1 };

impl Ring {
    /// Two degrees of freedom per mass.
    fn build(&self) -> (SparseSecondOrder, SecondOrder) {
        let n = 2 * self.masses;
        let mut numbers = Numbers(7);
        let (mut m, mut c, mut k) = (CooMatrix::new(n, n), CooMatrix::new(n, n), CooMatrix::new(n, n));
        for mass in 0..self.masses {
            let [here, next] = [2 * mass, 2 * ((mass + 1) % self.masses)];
            for axis in 0..2 {
                let (a, b) = (here + axis, next + axis);
                if mass >= self.massless {
                    m.push(a, a, 1.0 + self.disorder * numbers.next());
                }
                let spring = 1e4 * (1.0 + self.disorder * numbers.next());
                for (row, column, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    k.push(row, column, sign * spring);
                    c.push(row, column, sign * spring * 1e-5);
                }
                k.push(a, a, 3e3 + 1e3 * axis as f64);
            }
            c.push(here, here + 1, self.gyroscopic);
            c.push(here + 1, here, -self.gyroscopic);
            k.push(here, here + 1, self.friction * 2e3);
            k.push(here + 1, here, -self.friction * 2e3);
        }
        let mut sparse = SparseSecondOrder::new(CscMatrix::from(&m), CscMatrix::from(&c), CscMatrix::from(&k)).unwrap();
        let mut internal = Internal::zeros(n, self.states);
        for state in 0..self.states {
            let (decay, drive, force) =
                (40.0 + 10.0 * state as f64, vec![(2 * state, 3.0), (2 * state + 3, -1.0)], vec![(2 * state, -900.0)]);
            internal.decay[state] = decay;
            drive.iter().for_each(|&(dof, value)| internal.drive[(state, dof)] = value);
            force.iter().for_each(|&(dof, value)| internal.force[(dof, state)] = value);
            sparse.states.push(State { decay, drive, force });
        }
        let dense = |matrix: &CscMatrix<f64>| DMatrix::from(matrix);
        let dense = SecondOrder::with_internal(dense(&sparse.m), dense(&sparse.c), dense(&sparse.k), internal).unwrap();
        (sparse, dense)
    }
}

fn find(system: &SparseSecondOrder, rectangle: Rectangle) -> Found {
    eigenpairs_in(system, &rectangle, &Options::default(), &mut |_| ()).unwrap()
}

/// Every eigenvalue that the dense solver has inside is found, as often, and no other; every pair is one of the dense system.
fn agrees(sparse: &SparseSecondOrder, dense: &SecondOrder, rectangle: Rectangle) -> Found {
    let mut counters = cea::certified::Counters::default();
    let spectrum = solve(dense, &mut counters).unwrap();
    let certified = certify(dense, &spectrum, &mut counters).unwrap();
    let found = find(sparse, rectangle);
    let expected: Vec<_> = certified.eigenvalues.iter().filter(|e| rectangle.contains(e.lambda, 0.0)).collect();
    let clear = expected.iter().filter(|e| rectangle.border_distance(e.lambda) > 1e-6 * e.lambda.norm()).count();
    assert!(found.pairs.len() >= clear && found.pairs.len() <= expected.len() + (expected.len() - clear));
    let mut is_free = vec![true; certified.eigenvalues.len()];
    for pair in &found.pairs {
        let distance = |i: &usize| (certified.eigenvalues[*i].lambda - pair.lambda).norm();
        let free = (0..is_free.len()).filter(|&i| is_free[i]);
        let nearest = free.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
        is_free[nearest] = false;
        let reference = &certified.eigenvalues[nearest];
        let allowed = 1e-9 * pair.lambda.norm() + reference.bound;
        assert!(distance(&nearest) <= allowed, "{} for {}: {:e}", pair.lambda, reference.lambda, distance(&nearest));
        is_pair_of(dense, pair);
    }
    found
}

fn is_pair_of(dense: &SecondOrder, pair: &Eigenpair) {
    assert!(cea::backward_error(dense, pair.lambda, &pair.right) < 1e-11);
    let left: DVector<Complex<f64>> = pair.left.conjugate();
    assert!(cea::backward_error(&dense.transposed(), pair.lambda, &left) < 1e-9, "left of {}", pair.lambda);
    assert!((pair.right.norm() - 1.0).abs() < 1e-12 && (pair.left.norm() - 1.0).abs() < 1e-12);
    let own = cea::backward_error(dense, pair.lambda, &pair.right);
    assert!((own - pair.backward_error).abs() <= 1e-15 + 0.1 * own);
}

const WIDE: Rectangle = Rectangle { re: [-60.0, 40.0], im: [-1.0, 150.0] };

#[test]
fn a_symmetric_ring_with_double_eigenvalues() {
    let (sparse, dense) = Ring { disorder: 0.0, ..RING }.build();
    let found = agrees(&sparse, &dense, WIDE);
    let doubles = found.pairs.windows(2).filter(|w| (w[0].lambda - w[1].lambda).norm() < 1e-9 * w[0].lambda.norm());
    assert!(doubles.count() > 10);
    assert!(found.pairs.iter().all(|pair| pair.condition < 1e6));
}

#[test]
fn gyroscopic_frictional_singular_mass_and_states() {
    let rings = [
        Ring { gyroscopic: 4.0, ..RING },
        Ring { friction: 0.8, ..RING },
        Ring { massless: 9, friction: 0.3, ..RING },
        Ring { states: 5, friction: 0.5, gyroscopic: 1.0, ..RING },
    ];
    for ring in rings {
        let (sparse, dense) = ring.build();
        agrees(&sparse, &dense, WIDE);
        agrees(&sparse, &dense, Rectangle { re: [-3.0, 20.0], im: [80.0, 120.0] });
    }
}

#[test]
fn many_discs_find_what_one_does_and_the_lower_half_is_the_upper_one() {
    let (sparse, _) = Ring { friction: 0.4, ..RING }.build();
    let one = eigenpairs_in(&sparse, &WIDE, &Options { columns: 160, ..Options::default() }, &mut |_| ()).unwrap();
    let many = eigenpairs_in(&sparse, &WIDE, &Options { columns: 30, ..Options::default() }, &mut |_| ()).unwrap();
    assert!(many.discs.len() > 3 * one.discs.len());
    assert_eq!(one.pairs.len(), many.pairs.len());
    for (a, b) in one.pairs.iter().zip(&many.pairs) {
        assert!((a.lambda - b.lambda).norm() <= 1e-10 * a.lambda.norm());
    }
    let [upper, lower] = [[50.0, 150.0], [-150.0, -50.0]].map(|im| find(&sparse, Rectangle { im, ..WIDE }));
    assert_eq!(upper.pairs.len(), lower.pairs.len());
    for (a, b) in upper.pairs.iter().zip(&lower.pairs) {
        assert_eq!(a.lambda, b.lambda.conj());
    }
    assert_eq!(find(&sparse, WIDE), find(&sparse, WIDE));
}

#[test]
fn an_eigenvalue_on_the_border_is_flagged() {
    let one = CscMatrix::identity(3);
    let k = CscMatrix::from(&DMatrix::from_diagonal(&DVector::from_vec(vec![4.0, 9.0, 100.0])));
    let system = SparseSecondOrder::new(one, CscMatrix::zeros(3, 3), k).unwrap();
    let found = find(&system, Rectangle { re: [-1.0, 1.0], im: [1.0, 3.0] });
    let seen: Vec<_> = found.pairs.iter().map(|pair| (pair.lambda.im.round(), pair.on_border)).collect();
    assert_eq!(seen, [(2.0, false), (3.0, true)]);
}

#[test]
fn a_nearly_defective_pair_is_found_twice() {
    let one = CscMatrix::identity(2);
    for coupling in [0.0, 1e-6] {
        let k = CscMatrix::from(&DMatrix::from_row_slice(2, 2, &[25.0, 1.0, coupling, 25.0]));
        let system = SparseSecondOrder::new(one.clone(), CscMatrix::zeros(2, 2), k).unwrap();
        let found = find(&system, Rectangle { re: [-1.0, 1.0], im: [4.0, 6.0] });
        assert_eq!(found.pairs.len(), 2);
        assert!(found.pairs.iter().all(|p| (p.lambda - Complex::new(0.0, 5.0)).norm() < 1e-3 && p.condition > 100.0));
    }
}

#[test]
fn what_cannot_be_searched_is_refused() {
    let (sparse, _) = RING.build();
    let search = |system: &SparseSecondOrder, re, im, options: &Options| {
        eigenpairs_in(system, &Rectangle { re, im }, options, &mut |_| ())
    };
    let all = Options::default();
    for (re, im) in [([1.0, 1.0], [0.0, 1.0]), ([0.0, f64::NAN], [0.0, 1.0]), ([0.0, 1.0], [2.0, 1.0])] {
        assert!(matches!(search(&sparse, re, im, &all), Err(SparseError::Rectangle { .. })));
    }
    let few = Options { shifts: 1, columns: 20, ..all };
    assert!(matches!(search(&sparse, WIDE.re, WIDE.im, &few), Err(SparseError::RectangleTooLarge { .. })));
    let zero = || CscMatrix::from(&DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0]));
    let singular = SparseSecondOrder::new(zero(), zero(), zero()).unwrap();
    assert!(search(&singular, [-1.0, 1.0], [1.0, 2.0], &all).is_err());
    let empty = SparseSecondOrder::new(CscMatrix::zeros(2, 2), CscMatrix::zeros(2, 2), CscMatrix::zeros(2, 2)).unwrap();
    assert!(search(&empty, [-1.0, 1.0], [1.0, 2.0], &all).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]
    #[test]
    fn any_rectangle_of_any_ring(
        gyroscopic in 0.0..5.0_f64,
        friction in 0.0..1.0_f64,
        states in 0..4_usize,
        low in 20.0..140.0_f64,
        height in 5.0..120.0_f64,
        width in 0.5..60.0_f64,
    ) {
        let (sparse, dense) = Ring { masses: 20, gyroscopic, friction, states, ..RING }.build();
        agrees(&sparse, &dense, Rectangle { re: [-width, 0.7 * width], im: [low, low + height] });
    }
}

/// All eigenvalues of `lambda^2 M + lambda C + K + i H`, from a dense companion matrix.
fn with_structural_damping(dense: &SecondOrder, h: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let n = dense.order();
    let inverse = dense.m.clone().try_inverse().unwrap();
    let mut companion = DMatrix::zeros(2 * n, 2 * n);
    companion.view_mut((0, n), (n, n)).fill_with_identity();
    let stiffness = (&inverse * &dense.k).zip_map(&(&inverse * h), |k, h| Complex::new(-k, -h));
    companion.view_mut((n, 0), (n, n)).copy_from(&stiffness);
    companion.view_mut((n, n), (n, n)).copy_from(&(&inverse * &dense.c * -1.0).map(Complex::from));
    nalgebra::Schur::new(companion).eigenvalues().unwrap().iter().copied().collect()
}

#[test]
fn structural_damping_is_a_complex_stiffness_above_the_real_axis() {
    // Of springs along the ring alone, of all, and of double eigenvalues; the last one of entries that lie in rows of different units.
    let rings = [
        (Ring { friction: 0.8, ..RING }, 0.3),
        (Ring { friction: 0.4, gyroscopic: 1.0, ..RING }, 0.02),
        (Ring { disorder: 0.0, ..RING }, 0.1),
    ];
    let part = Rectangle { re: [-30.0, 40.0], im: [60.0, 130.0] };
    for (ring, eta) in rings {
        let (sparse, dense) = ring.build();
        let h = DMatrix::from_fn(dense.order(), dense.order(), |i, j| {
            if i % 2 == 0 && j % 2 == 0 { eta * dense.k[(i, j)] } else { 0.0 }
        });
        let damped = sparse.with_structural_damping(CscMatrix::from(&h)).unwrap();
        let uneven = |row: usize| if row.is_multiple_of(2) { 1.0 } else { 1e5 };
        let in_other_units = {
            let scaled = |a: &CscMatrix<f64>| {
                let mut a = a.clone();
                a.triplet_iter_mut().for_each(|(row, column, value)| *value *= uneven(row) * uneven(column));
                a
            };
            let SparseSecondOrder { m, c, k, h, .. } = &damped;
            let [m, c, k] = [m, c, k].map(scaled);
            SparseSecondOrder::new(m, c, k).unwrap().with_structural_damping(scaled(h.as_ref().unwrap())).unwrap()
        };
        let mut expected = with_structural_damping(&dense, &h);
        expected.retain(|lambda| part.contains(*lambda, 0.0));
        assert!(expected.len() > 20);
        for system in [&damped, &in_other_units] {
            let found = find(system, part);
            assert_eq!(found.pairs.len(), expected.len(), "{eta}");
            let mut left = expected.clone();
            for pair in &found.pairs {
                let distance = |at: &usize| (left[*at] - pair.lambda).norm();
                let nearest = (0..left.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
                assert!(distance(&nearest) < 1e-8 * pair.lambda.norm(), "{eta}: {}", pair.lambda);
                left.swap_remove(nearest);
                assert!(pair.backward_error < 1e-11);
            }
        }
        let below = Rectangle { im: [0.0, 130.0], ..part };
        let refused = eigenpairs_in(&damped, &below, &Options::default(), &mut |_| ());
        assert_eq!(refused, Err(SparseError::StructuralDamping { from: 0.0 }));
        // Small systems are not certified by real matrices.
        let certified = Options { certified: 1000, counted: 1000, ..Options::default() };
        let found = eigenpairs_in(&damped, &part, &certified, &mut |_| ()).unwrap();
        assert_eq!((found.pairs.len(), found.is_certified), (expected.len(), false));
    }
    // A loss factor of all stiffness turns the square of each frequency: lambda^2 = -omega^2 (1 + i eta).
    let k = CscMatrix::from(&DMatrix::from_diagonal(&DVector::from_vec(vec![4.0, 9.0, 100.0])));
    let system = SparseSecondOrder::new(CscMatrix::identity(3), CscMatrix::zeros(3, 3), k.clone()).unwrap();
    let found =
        find(&system.with_structural_damping(&k * 0.2).unwrap(), Rectangle { re: [-5.0, 1.0], im: [1.0, 11.0] });
    for (pair, omega) in found.pairs.iter().zip([2.0, 3.0, 10.0]) {
        assert!((pair.lambda - Complex::new(-1.0, -0.2).sqrt() * Complex::from(-omega)).norm() < 1e-12 * omega);
    }
}

/// Rectangles far larger than the spectrum: the bounds that limit the search contain every eigenvalue, and all are found.
#[test]
fn bounds_of_the_spectrum_hold_all_eigenvalues() {
    let everywhere = Rectangle { re: [-1e6, 1e6], im: [-1e6, 1e6] };
    let rings = [
        Ring { gyroscopic: 4.0, ..RING },
        Ring { friction: 0.8, ..RING },
        Ring { friction: 0.5, gyroscopic: 1.0, ..RING },
        Ring { states: 2, friction: 0.3, masses: 10, ..RING },
    ];
    for ring in rings {
        let (sparse, dense) = ring.build();
        let found = agrees(&sparse, &dense, everywhere);
        let reach = found.reach.unwrap();
        assert_eq!(found.pairs.len(), 4 * ring.masses + ring.states);
        assert!(
            found.pairs.iter().all(|pair| pair.lambda.norm() <= reach.modulus && pair.lambda.re.abs() <= reach.real)
        );
        assert!(reach.real < 0.8 * reach.modulus || ring.states > 0, "{reach:?}");
    }
    // Without damping and friction all are on the axis, and so is what is searched.
    let (mut sparse, _) = RING.build();
    sparse.c = CscMatrix::zeros(2 * RING.masses, 2 * RING.masses);
    let found = find(&sparse, everywhere);
    let reach = found.reach.unwrap();
    assert!(reach.real < 1e-6 * reach.modulus && found.pairs.len() == 4 * RING.masses, "{reach:?}");
    assert!(found.discs.len() <= 3, "{} discs", found.discs.len());
    // What is too much is known before anything is searched.
    let little = Options { bytes: 150_000, ..Options::default() };
    let refused = eigenpairs_in(&sparse, &everywhere, &little, &mut |_| panic!("a search"));
    let Err(SparseError::WholeSpectrum { eigenvalues: 160, most }) = refused else { panic!("{refused:?}") };
    assert_eq!(most, 2 * (150_000 / (64 * 80)));
}

/// A rectangle far larger than the spectrum: nothing is searched where no eigenvalue can be.
#[test]
fn a_rectangle_without_end_holds_the_whole_spectrum() {
    let n = 30;
    let (mut m, mut c, mut k) = (CooMatrix::new(n, n), CooMatrix::new(n, n), CooMatrix::new(n, n));
    for i in 0..n {
        m.push(i, i, 0.5 + (i % 3) as f64);
        k.push(i, i, 4.0);
        c.push(i, i, 0.01);
        if i + 1 < n {
            [(i, i + 1), (i + 1, i)].iter().for_each(|&(a, b)| k.push(a, b, -1.5));
            m.push(i, i + 1, 0.1);
            m.push(i + 1, i, 0.1);
        }
    }
    let system = SparseSecondOrder::new((&m).into(), (&c).into(), (&k).into()).unwrap();
    for end in [1e1, 1e4, 1e7, 1e12] {
        let everywhere = Rectangle { re: [-end, end], im: [-end, end] };
        let found = eigenpairs_in(&system, &everywhere, &Options::default(), &mut |_| {}).unwrap();
        assert_eq!(found.pairs.len(), 2 * n, "{end}");
        let largest = found.pairs.iter().map(|pair| pair.lambda.norm()).fold(0.0, f64::max);
        let reach = found.reach.unwrap().modulus;
        assert!(largest <= reach && reach < 3.0 * largest, "{largest} {reach}");
    }
    // The same where M is diagonal, as lumped masses are.
    let lumped = SparseSecondOrder::new(CscMatrix::identity(n), system.c.clone(), system.k.clone()).unwrap();
    let everywhere = Rectangle { re: [-1e9, 1e9], im: [-1e9, 1e9] };
    let found = eigenpairs_in(&lumped, &everywhere, &Options::default(), &mut |_| {}).unwrap();
    assert!(
        found.pairs.len() == 2 * n && found.reach.unwrap().modulus < 10.0,
        "{} {:?}",
        found.pairs.len(),
        found.reach
    );
    let beyond = Rectangle { re: [-1.0, 1.0], im: [1e3, 1e9] };
    let found = eigenpairs_in(&system, &beyond, &Options::default(), &mut |_| {}).unwrap();
    assert_eq!((found.pairs.len(), found.discs.len(), found.counters.factorisations), (0, 0, 0));
}

/// A truss of so many cells a side that nothing holds: masses of any size at nodes beside their places, springs along edges and diagonals,
/// entries as a file has them.
fn free_truss(cells: usize, stiffness: f64, digits: usize, seed: u64) -> SparseSecondOrder {
    let (side, mut numbers) = (cells + 1, Numbers(seed));
    let places: Vec<[f64; 3]> = (0..side.pow(3))
        .map(|at| [at % side, at / side % side, at / side / side].map(|x| x as f64 + 0.2 * numbers.next()))
        .collect();
    let n = 3 * places.len();
    let (mut m, mut k) = (CooMatrix::new(n, n), DMatrix::zeros(n, n));
    for (a, from) in places.iter().enumerate() {
        let mass = 1.0 + 0.3 * numbers.next();
        (0..3).for_each(|axis| m.push(3 * a + axis, 3 * a + axis, mass));
        for (b, to) in places.iter().enumerate().skip(a + 1) {
            let along = [0, 1, 2].map(|axis| to[axis] - from[axis]);
            let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length < 1.7 {
                let spring = stiffness * (1.0 + 0.3 * numbers.next());
                for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                    let entry = spring * along[i] * along[j] / (length * length);
                    for (row, column, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                        k[(3 * row + i, 3 * column + j)] += sign * entry;
                    }
                }
            }
        }
    }
    let written = |entry: f64| format!("{entry:.digits$e}").parse::<f64>().unwrap();
    let mut rounded = CooMatrix::new(n, n);
    for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).filter(|&(i, j)| k[(i, j)] != 0.0) {
        rounded.push(i, j, written(k[(i, j)]));
        if i != j {
            rounded.push(j, i, written(k[(i, j)]));
        }
    }
    SparseSecondOrder::new(CscMatrix::from(&m), CscMatrix::zeros(n, n), CscMatrix::from(&rounded)).unwrap()
}

/// The six motions of a free body are twelve zeros, which assembly and rounding scatter about zero: their sign is never read.
#[test]
fn rigid_motions_are_neither_stable_nor_unstable() {
    let mut found_any = 0;
    for (seed, stiffness, digits) in [(1, 1.0, 15), (2, 1e9, 15), (3, 1e9, 16), (4, 1e-6, 15), (5, 1e12, 16)] {
        let system = free_truss(4, stiffness, digits, seed);
        let scale = stiffness.sqrt();
        // What rounding leaves of zero: the root of its size.
        let scattered = 1e-6 * scale;
        for (re, im) in [([-0.01, 0.01], [-0.01, 0.01]), ([0.0, 0.01], [0.0, 1e-8]), ([-0.01, 0.0], [0.0, 0.01])] {
            let rectangle = Rectangle { re: re.map(|x| x * scale), im: im.map(|x| x * scale) };
            let found = find(&system, rectangle);
            let zeros: Vec<&Eigenpair> = found.pairs.iter().filter(|pair| pair.lambda.norm() < scattered).collect();
            found_any += zeros.len();
            for pair in &zeros {
                let is_open = !matches!(pair.verdict, cea::Verdict::Stable | cea::Verdict::Unstable);
                assert!(is_open, "{seed} {rectangle:?} {} {:?} {:e}", pair.lambda, pair.verdict, pair.bound);
            }
            if im[0] < 0.0 {
                assert_eq!(zeros.len(), 12, "{seed}");
            }
        }
    }
    assert!(found_any > 100, "{found_any}");
}
