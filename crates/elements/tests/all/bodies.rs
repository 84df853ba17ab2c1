//! Matrices of bodies of all kinds of elements against what is known of any body.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use elements::nalgebra::{DVector, Vector3};
use elements::nalgebra_sparse::CscMatrix;
use elements::{Axis, Body, ElementsError, Kind, Material, Mesh, Rows};
use proptest::prelude::*;

/// One distorted element, whose middles lie between its corners.
fn one(kind: Kind, bend: f64) -> Mesh {
    let at = |[r, s, t]: [f64; 3]| [2.0 * r + bend * s, 1.5 * s + bend * t, t + bend * r];
    let nodes: Vec<(i64, [f64; 3])> = (1..).zip(kind.places()).map(|(label, place)| (label, at(place))).collect();
    let labels = nodes.iter().map(|(label, _)| *label).collect();
    Mesh::new(nodes, vec![(1, kind, labels)]).unwrap()
}

/// A field of displacements at the nodes.
fn field(mesh: &Mesh, f: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> DVector<f64> {
    DVector::from_iterator(3 * mesh.labels().len(), mesh.positions().iter().flat_map(|p| <[f64; 3]>::from(f(p))))
}

fn form(a: &CscMatrix<f64>, x: &DVector<f64>, y: &DVector<f64>) -> f64 {
    x.dot(&(a * y))
}

proptest! {
    #[test]
    fn rigid_motions_have_the_mass_and_cost_nothing(v in prop::array::uniform3(-1.0..1.0), bend in -0.3..0.3_f64) {
        for kind in Kind::ALL {
            let mesh = one(kind, bend);
            let rows = Rows::all(&mesh);
            let body = Body::new(&mesh, mesh.all(), &rows).unwrap();
            let (density, v) = (3.0, Vector3::from(v));
            let mass = body.mass(density).unwrap();
            let moved = field(&mesh, |_| v);
            let expected = density * body.volume().unwrap() * v.norm_squared();
            prop_assert!((form(&mass, &moved, &moved) - expected).abs() < 1e-12 * (1.0 + expected), "{:?}", kind);
            let stiffness = body.stiffness(&Material::new(7.0, 0.3).unwrap()).unwrap();
            for still in [moved.clone(), field(&mesh, |p| v.cross(p))] {
                prop_assert!((&stiffness * &still).norm() < 1e-11, "{:?}", kind);
            }
            // Turned about an axis, a body that does not change its displacements along has no transport of them.
            let transport = body.transport(density, &Axis::new([0.0, 0.0, 1.0], [0.0; 3]).unwrap()).unwrap();
            prop_assert!((&transport.centripetal * &moved).norm() < 1e-11);
            prop_assert_eq!(&transport.gyroscopic + transport.gyroscopic.transpose(), transport.gyroscopic.clone() * 0.0);
        }
    }

    /// The energy of a uniform strain is that of the volume.
    #[test]
    fn uniform_strain_has_its_energy(e in prop::array::uniform9(-1.0..1.0), bend in -0.3..0.3_f64) {
        let (young, poisson): (f64, f64) = (5.0, 0.25);
        for kind in Kind::ALL {
            let mesh = one(kind, bend);
            let rows = Rows::all(&mesh);
            let body = Body::new(&mesh, mesh.all(), &rows).unwrap();
            let gradient = nalgebra_matrix(e);
            let strain = (gradient + gradient.transpose()) * 0.5;
            let strained = field(&mesh, |p| gradient * p);
            let material = Material::new(young, poisson).unwrap();
            let shear = young / 2.0 / (1.0 + poisson);
            let lambda = young * poisson / (1.0 + poisson) / (1.0 - 2.0 * poisson);
            let density = lambda * strain.trace().powi(2) + 2.0 * shear * strain.norm_squared();
            let found = form(&body.stiffness(&material).unwrap(), &strained, &strained);
            let expected = density * body.volume().unwrap();
            prop_assert!((found - expected).abs() < 1e-11 * (1.0 + expected), "{:?}: {} {}", kind, found, expected);

            // Under that stress a small rotation v stores `tr(grad v sigma grad v^T)` by volume.
            let stress = strain * (2.0 * shear) + elements::nalgebra::Matrix3::identity() * (lambda * strain.trace());
            let displacements: Vec<Vector3<f64>> = mesh.positions().iter().map(|p| gradient * p).collect();
            let of_stress = body.stress_stiffness(&material, &displacements).unwrap();
            let spin = Vector3::new(0.3, -0.2, 0.9);
            let grad = spin.cross_matrix();
            let turned = field(&mesh, |p| spin.cross(p));
            let expected = (grad * stress * grad.transpose()).trace() * body.volume().unwrap();
            prop_assert!((form(&of_stress, &turned, &turned) - expected).abs() < 1e-11 * (1.0 + expected.abs()));
        }
    }
}

fn nalgebra_matrix(e: [f64; 9]) -> elements::nalgebra::Matrix3<f64> {
    elements::nalgebra::Matrix3::from_row_slice(&e)
}

#[test]
fn numbers_that_are_none_are_refused() {
    let mesh = one(Kind::Wedge15, 0.1);
    let rows = Rows::all(&mesh);
    let body = Body::new(&mesh, mesh.all(), &rows).unwrap();
    assert!(matches!(body.mass(0.0), Err(ElementsError::Material { .. })));
    assert!(matches!(body.mass(f64::NAN), Err(ElementsError::Material { .. })));
    assert!(matches!(Material::new(1.0, 0.5), Err(ElementsError::Material { .. })));
    assert!(matches!(Material::new(-1.0, 0.3), Err(ElementsError::Material { .. })));
    assert!(matches!(Axis::new([0.0; 3], [0.0; 3]), Err(ElementsError::Axis { .. })));
    let material = Material::new(1.0, 0.3).unwrap();
    let error = body.stress_stiffness(&material, &[]).unwrap_err();
    assert_eq!(error, ElementsError::Displacements { found: 0, expected: 15 });
    assert!(matches!(Body::new(&mesh, Vec::new(), &rows), Err(ElementsError::Empty { .. })));
    let twice = Body::new(&mesh, vec![0, 0], &rows).unwrap_err();
    assert_eq!(twice.to_string(), "element 1 is there twice; each number must be there once");
    assert!(matches!(Body::new(&mesh, vec![1], &rows), Err(ElementsError::NoElement { place: 1, total: 1 })));
}
