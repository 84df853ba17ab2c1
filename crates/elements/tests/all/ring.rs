//! A thin ring that turns, against the closed form of its inextensional modes: Huang and Soedel (1987), from Bryan (1890) on.
//!
//! With `g = n (n^2 - 1) / (n^2 + 1)` and the frequency `w0` at rest both travelling waves of n diameters have, seen from axes that stand still,
//! `w = sqrt(w0^2 + g^2 Omega^2) +- g Omega`: they split by `2 g Omega`, and their product does not depend on the speed. The square has
//! parts of `- Omega^2 P` and of the stress, which cancel up to this.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use std::f64::consts::TAU;

use elements::nalgebra::{DMatrix, DVector};
use elements::nalgebra_sparse::CscMatrix;
use elements::{Axis, Body, Kind, Material, Mesh, Rows};
use num_complex::Complex;
use sparse::{Options, Problem, Rectangle, SparseSecondOrder, eigenpairs_in};

const RADIUS: f64 = 0.1;
const SIDE: f64 = 0.003;
const YOUNG: f64 = 2.1e11;
const DENSITY: f64 = 7800.0;
const AROUND: usize = 80;

/// A ring of quadratic hexahedra with a square section, about z.
fn ring() -> Mesh {
    let steps = 2 * AROUND;
    let (mut nodes, mut elements) = (Vec::new(), Vec::new());
    // Half steps: around, outwards, upwards; nodes with at most one odd number.
    let label = |i: usize, j: usize, k: usize| (1 + ((i % steps) * 3 + j) * 3 + k) as i64;
    for (i, j, k) in (0..steps * 9).map(|at| (at / 9, at / 3 % 3, at % 3)) {
        if i % 2 + j % 2 + k % 2 < 2 {
            let (angle, r) = (i as f64 / steps as f64 * TAU, RADIUS + SIDE * (j as f64 / 2.0 - 0.5));
            nodes.push((label(i, j, k), [r * angle.cos(), r * angle.sin(), SIDE * k as f64 / 2.0]));
        }
    }
    for element in 0..AROUND {
        // Own coordinates: outwards, around, upwards.
        let places = Kind::Hexahedron20.places();
        let node = |place: &[f64; 3]| {
            let [j, i, k] = place.map(|x| (x + 1.0) as usize);
            label(2 * element + i, j, k)
        };
        elements.push((1 + element as i64, Kind::Hexahedron20, places.iter().map(node).collect()));
    }
    Mesh::new(nodes, elements).unwrap()
}

/// M, G, P, K of the ring and its stiffness of stress at 1 rad/s.
struct Ring {
    m: CscMatrix<f64>,
    g: CscMatrix<f64>,
    p: CscMatrix<f64>,
    k: CscMatrix<f64>,
    stress: CscMatrix<f64>,
}

impl Ring {
    fn new() -> Self {
        let mesh = ring();
        let rows = Rows::all(&mesh);
        let body = Body::new(&mesh, mesh.all(), &rows).unwrap();
        let axis = Axis::new([0.0, 0.0, 2.0], [0.0; 3]).unwrap();
        let material = Material::new(YOUNG, 0.3).unwrap();
        let (m, k) = (body.mass(DENSITY).unwrap(), body.stiffness(&material).unwrap());
        let transport = body.transport(DENSITY, &axis).unwrap();
        assert!(transport.departure < 1e-3, "{}", transport.departure);
        let load = body.centrifugal_load(DENSITY, &axis).unwrap();
        // Nothing holds the ring: what is added to K is 4e-6 of what the ring's breathing has.
        let none = CscMatrix::zeros(rows.order(), rows.order());
        let system = SparseSecondOrder::new(m.clone(), none, k.clone()).unwrap();
        let load = DMatrix::from_column_slice(load.len(), 1, load.as_slice());
        let found = Problem::new(&system).unwrap().solve(Complex::from(100.0), &load).unwrap();
        let still = body.displacements(&DVector::from_iterator(load.len(), found.iter().map(|z| z.re)));
        // Closed form: u = rho Omega^2 R^3 / E.
        let radial = still.iter().zip(mesh.positions()).map(|(u, p)| u.dot(&p.xy().normalize().push(0.0)));
        let mean = radial.sum::<f64>() / still.len() as f64;
        let expected = DENSITY * RADIUS.powi(3) / YOUNG;
        assert!((mean / expected - 1.0).abs() < 1e-3, "{mean:e} {expected:e}");
        let stress = body.stress_stiffness(&material, &still).unwrap();
        Self { m, g: transport.gyroscopic, p: transport.centripetal, k, stress }
    }

    /// Frequencies of all modes in a range at a speed, rad/s, ascending.
    fn frequencies(&self, omega: f64, range: [f64; 2], with_stress: bool) -> Vec<f64> {
        let stress = if with_stress { omega * omega } else { 0.0 };
        let c = &self.g * (2.0 * omega);
        let k = &self.k + &(&self.p * -(omega * omega)) + &self.stress * stress;
        let system = SparseSecondOrder::new(self.m.clone(), c, k).unwrap();
        let rectangle = Rectangle { re: [-20.0, 20.0], im: range };
        let found = eigenpairs_in(&system, &rectangle, &Options::default(), &mut |_| ()).unwrap();
        let mut frequencies: Vec<f64> = found.pairs.iter().map(|pair| pair.lambda.im).collect();
        assert!(found.pairs.iter().all(|pair| pair.lambda.re.abs() < 1e-3 * omega.max(1.0)));
        frequencies.sort_by(f64::total_cmp);
        frequencies
    }
}

fn of_ring(n: f64) -> (f64, f64) {
    let bending = YOUNG * SIDE * SIDE / 12.0 / (DENSITY * RADIUS.powi(4));
    ((bending * (n * (n * n - 1.0)).powi(2) / (n * n + 1.0)).sqrt(), n * (n * n - 1.0) / (n * n + 1.0))
}

#[test]
fn travelling_waves_split_as_the_closed_form_says() {
    let ring = Ring::new();
    for n in [2.0, 3.0] {
        let (at_rest, g) = of_ring(n);
        // Out of its plane the ring has two modes below: in the plane they are the upper two of n diameters.
        let range = [0.994 * at_rest, 1.01 * at_rest];
        let still = ring.frequencies(0.0, range, true);
        println!("n = {n}: closed form {at_rest:.3} rad/s, found {still:?}");
        assert_eq!(still.len(), 2);
        assert!((still[0] / at_rest - 1.0).abs() < 3e-3 && (still[1] - still[0]) < 1e-3 * at_rest);
        // Slow: the split.
        let slow = ring.frequencies(5.0, range, true);
        let split = slow[1] - slow[0];
        println!("n = {n}: split {split:.6}, closed form {:.6}", 2.0 * g * 5.0);
        assert!((split / (2.0 * g * 5.0) - 1.0).abs() < 2e-3, "{split}");
        // Fast, where the square of the speed counts as much as the stiffness of the ring.
        let fast = 0.3 * at_rest;
        let mean = (still[0] * still[0] + (g * fast).powi(2)).sqrt();
        for (sign, with_stress) in [(-1.0, true), (1.0, true), (1.0, false)] {
            let expected = mean + sign * g * fast;
            let found = ring.frequencies(fast, [0.97 * expected, 1.03 * expected], with_stress);
            println!("n = {n}, {fast:.1} rad/s, stress {with_stress}: {found:?}, closed form {expected:.3}");
            let agrees = found.iter().any(|found| (found / expected - 1.0).abs() < 4e-3);
            assert_eq!(agrees, with_stress, "{sign}: {found:?} {expected}");
        }
    }
}
