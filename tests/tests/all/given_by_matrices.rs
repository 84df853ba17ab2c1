//! The brakes in `cases/` that are given by their matrices are what their comments say: Hoffmann's onset of flutter, the
//! mechanics of the wobbling disc, the published matrices of disk_brake100.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use approx::assert_relative_eq;
use brakes::case::{CaseFile, MatricesCase};
use cea::certified;
use linsys::SecondOrder;
use nalgebra::{DMatrix, Matrix2, Vector2, Vector3, dmatrix};

fn case(name: &str) -> MatricesCase {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases").join(name);
    match CaseFile::read(&path).unwrap() {
        CaseFile::Matrices(case) => *case,
        other => panic!("{other:?}"),
    }
}

fn system(case: &MatricesCase, value: impl Fn(&str) -> f64) -> SecondOrder {
    let values: Vec<f64> = case.parameters.iter().map(|parameter| value(&parameter.name)).collect();
    case.system.assemble(&case.operating_point(&values).unwrap()).unwrap()
}

#[test]
fn hoffmanns_oscillator_flutters_from_its_closed_form_onset() {
    let case = case("hoffmann.toml");
    let growth = |mu: f64| {
        let system = system(&case, |_| mu);
        let spectrum = certified::solve(&system, &mut certified::Counters::default()).unwrap();
        spectrum.eigenvalues.iter().map(|lambda| lambda.re).fold(f64::MIN, f64::max)
    };
    let onset = (1.0 + 2.0 * 0.05 * 0.05) * 0.75;
    assert!(growth(onset - 1e-6) < 0.0 && growth(onset + 1e-6) > 0.0);
    let k = system(&case, |_| 0.6).k;
    assert_relative_eq!(k, dmatrix![2.0, 1.0 - 0.6 * 4.0 / 3.0; 1.0, 2.0], epsilon = 1e-15);
    // The springs of the comment.
    let (k1, k2, k3) = (2.0 / 3.0 * (2.0 - 3f64.sqrt()), 2.0 / 3.0 * (2.0 + 3f64.sqrt()), 4.0 / 3.0);
    let along = |angle: f64| Vector2::new(angle.to_radians().cos(), angle.to_radians().sin());
    let springs = k1 * along(150.0) * along(150.0).transpose() + k2 * along(30.0) * along(30.0).transpose();
    assert_relative_eq!(springs + Matrix2::new(0.0, 0.0, 0.0, k3), Matrix2::new(2.0, 1.0, 1.0, 2.0), epsilon = 1e-15);
}

const H: f64 = 0.02;
const R: f64 = 0.13;
const SPRING: f64 = 6e6;
const DASHPOT: f64 = 5.0;
const JOINT_SPRING: f64 = 1.88e7;
const JOINT_DASHPOT: f64 = 0.1;
const INERTIA: f64 = 0.16;
const POLAR_INERTIA: f64 = 0.32;

/// Moments about x and y of both pads on the disc, without any linearisation. The disc has turned by q1 about x and by q2
/// about its own y axis.
fn moments(mu: f64, omega: f64, preload: f64, q: Vector2<f64>, rate: Vector2<f64>) -> Vector2<f64> {
    let axis = |q: Vector2<f64>| Vector3::new(q.y.sin(), -q.x.sin() * q.y.cos(), q.x.cos() * q.y.cos());
    let height = |q: Vector2<f64>, side: f64| (side * H / 2.0 - axis(q).x * R) / axis(q).z;
    let about_y = Vector3::new(0.0, q.x.cos(), q.x.sin());
    let spin = omega * axis(q) + rate.x * Vector3::x() + rate.y * about_y;
    let mut sum = Vector3::zeros();
    for side in [1.0, -1.0] {
        const STEP: f64 = 1e-6;
        let z = height(q, side);
        let z_rate = (height(q + STEP * rate, side) - height(q - STEP * rate, side)) / (2.0 * STEP);
        let at = Vector3::new(R, 0.0, z);
        let sliding = (spin.cross(&at) - z_rate * Vector3::z()).normalize();
        let pressed = preload + side * (SPRING * (z - side * H / 2.0) + DASHPOT * z_rate);
        let normal_force = pressed / (axis(q).z + side * mu * sliding.z);
        let force = -side * normal_force * axis(q) - mu * normal_force * sliding;
        sum += at.cross(&force);
    }
    sum.xy()
}

#[test]
fn the_wobbling_disc_is_the_linearisation_of_its_mechanics() {
    let case = case("wobbling-disc.toml");
    for (mu, omega, preload) in [(0.6, 10.0, 3000.0), (0.3, 80.0, 5000.0)] {
        let system = system(&case, |name| match name {
            "mu" => mu,
            "Omega" => omega,
            "N0" => preload,
            other => panic!("{other}"),
        });
        let zero = Vector2::zeros();
        let slope = |at: &dyn Fn(f64) -> Vector2<f64>, step: f64| (at(step) - at(-step)) / (2.0 * step);
        assert_relative_eq!(moments(mu, omega, preload, zero, zero), zero, epsilon = 1e-9);
        let gyroscopic = POLAR_INERTIA * omega * Matrix2::new(0.0, 1.0, -1.0, 0.0);
        for dof in 0..2 {
            let unit = Vector2::ith(dof, 1.0);
            let by_tilt = slope(&|step| moments(mu, omega, preload, step * unit, zero), 1e-5);
            let by_rate = slope(&|step| moments(mu, omega, preload, zero, step * unit), 1e-3);
            let k = JOINT_SPRING * unit - by_tilt;
            let c = JOINT_DASHPOT * unit + gyroscopic * unit - by_rate;
            for row in 0..2 {
                assert_relative_eq!(system.k[(row, dof)], k[row], max_relative = 1e-6, epsilon = 1e-4);
                assert_relative_eq!(system.c[(row, dof)], c[row], max_relative = 1e-6, epsilon = 1e-9);
            }
            assert_relative_eq!(system.m[(dof, dof)], INERTIA);
        }
    }
}

fn published(matrix: &str) -> DMatrix<f64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/hard/disk_brake100_w4pi").join(matrix);
    formats::read(&path).unwrap().only().unwrap().to_dense()
}

#[test]
fn the_components_of_disk_brake100_make_the_published_matrices() {
    let case = case("disk-brake100.toml");
    let system = system(&case, |name| match name {
        "w" => 4.0 * std::f64::consts::PI,
        "friction" => 1.0,
        other => panic!("{other}"),
    });
    for (ours, file) in [(&system.m, "M.mtx"), (&system.c, "C.mtx"), (&system.k, "K.mtx")] {
        let theirs = published(file);
        let rounding = 2.0 * f64::EPSILON * theirs.amax();
        assert!((ours - &theirs).amax() <= rounding, "{file}: {:e}", (ours - &theirs).amax());
    }
    assert_eq!(case.system.families(), ["structure", "dashpots", "gyroscopic", "friction"]);
    assert_eq!(case.bodies.iter().map(|body| body.dofs.len()).sum::<usize>(), 100);
}
