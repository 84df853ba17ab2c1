//! A disc and two pads whose faces do not match, against matrices that `two_pads/make.py` makes with numpy.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use std::collections::BTreeMap;

use contact::{Interface, Pairing, Sliding, Stiffness};
use elements::{Axis, Body, Kind, Mesh, Rows};
use nalgebra::DVector;
use nalgebra_sparse::CscMatrix;

const OMEGA: f64 = 5.0;

struct Fixture {
    mesh: Mesh,
    /// Places of the elements of each body, in their order.
    bodies: BTreeMap<String, Vec<usize>>,
    areas: BTreeMap<String, f64>,
    /// The largest entry of each matrix, and the rows of its product with the probe.
    matrices: BTreeMap<String, (f64, Vec<(usize, f64)>)>,
}

fn fixture() -> Fixture {
    let (mut nodes, mut elements) = (Vec::new(), Vec::new());
    let (mut bodies, mut areas): (BTreeMap<String, Vec<usize>>, BTreeMap<String, f64>) = Default::default();
    let mut matrices: BTreeMap<String, (f64, Vec<(usize, f64)>)> = BTreeMap::new();
    let mut last = String::new();
    for line in include_str!("../two_pads/two_pads.txt").lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let real = |at: usize| words[at].parse::<f64>().unwrap();
        match words[0] {
            "node" => nodes.push((words[1].parse().unwrap(), [real(2), real(3), real(4)])),
            "element" => {
                bodies.entry(words[2].to_owned()).or_default().push(elements.len());
                let own = words[3..].iter().map(|word| word.parse().unwrap()).collect();
                elements.push((words[1].parse().unwrap(), Kind::Hexahedron20, own));
            }
            "area" => drop(areas.insert(words[1].to_owned(), real(2))),
            "matrix" => {
                last = words[1].to_owned();
                matrices.insert(last.clone(), (real(2), Vec::new()));
            }
            row => matrices.get_mut(&last).unwrap().1.push((row.parse().unwrap(), real(1))),
        }
    }
    Fixture { mesh: Mesh::new(nodes, elements).unwrap(), bodies, areas, matrices }
}

impl Fixture {
    fn faces_at(&self, body: &str, z: f64) -> Vec<elements::FaceId> {
        let faces = self.mesh.outer_faces(&self.bodies[body]).unwrap();
        let lies = |id: &elements::FaceId| {
            let face = self.mesh.face(*id).unwrap();
            face.positions.iter().all(|p| p.z == z)
        };
        faces.into_iter().filter(lies).collect()
    }

    /// Both interfaces: the outer one at z = 0 and the inner one.
    fn interfaces(&self) -> Vec<(&'static str, Interface)> {
        let axis = Axis::new([0.0, 0.0, 1.0], [0.0; 3]).unwrap();
        let pairing = Pairing::new(Sliding::About { axis, speed: OMEGA }, 0.5);
        let of = |(pad, z)| {
            let (slave, master) = (self.faces_at(pad, z), self.faces_at("DISC", z));
            (pad, Interface::new(&self.mesh, &slave, &master, &pairing).unwrap())
        };
        [("OUT", 0.0), ("IN", -24.0)].map(of).into()
    }

    /// How far a matrix times the probe is from the expected one, relative to its largest entry.
    fn distance(&self, name: &str, matrix: &CscMatrix<f64>) -> f64 {
        let probe = DVector::from_fn(matrix.ncols(), |i, _| (1.0 + 0.37 * i as f64).sin());
        let mut found = matrix * &probe;
        let (scale, rows) = &self.matrices[name];
        rows.iter().for_each(|&(row, value)| found[row] -= value);
        found.amax() / scale
    }
}

#[test]
fn contact_matrices_are_those_of_numpy() {
    let fixture = fixture();
    let rows = Rows::all(&fixture.mesh);
    let zero = || CscMatrix::zeros(rows.order(), rows.order());
    let mut sums: BTreeMap<&str, CscMatrix<f64>> =
        ["normal", "friction", "lateral", "along"].map(|name| (name, zero())).into();
    for (pad, interface) in fixture.interfaces() {
        let patches: Vec<(String, Vec<usize>)> = [1, 2]
            .map(|patch: usize| {
                let elements = &fixture.bodies[pad][3 * (patch - 1)..3 * patch];
                let nodes = elements.iter().flat_map(|&place| fixture.mesh.elements()[place].nodes.clone());
                (format!("{pad}{patch}"), nodes.collect())
            })
            .into();
        let of = interface.patches(&fixture.mesh, &patches).unwrap();
        for (at, (name, _)) in patches.iter().enumerate() {
            let own = interface.points().iter().zip(&of).filter(|(_, of)| **of == at);
            let area: f64 = own.map(|(point, _)| point.area).sum();
            assert!((area / fixture.areas[name] - 1.0).abs() < 1e-13, "{name}");
        }
        let forces = interface.uniform(2.0 * interface.area()).unwrap();
        let k = interface.tangents(&Stiffness::PerArea(110.0), &forces).unwrap();
        let found = [
            ("normal", interface.normal_stiffness(&rows, &k).unwrap()),
            ("friction", interface.friction_stiffness(&rows, &k).unwrap()),
            ("lateral", interface.lateral_damping(&rows, &forces).unwrap()),
            ("along", interface.slope_damping(&rows, &forces).unwrap()),
        ];
        for (name, matrix) in found {
            let sum = sums.get_mut(name).unwrap();
            *sum = &*sum + matrix;
        }
        // Channels are the same matrices.
        let mut of_channels = DVector::zeros(rows.order());
        let x = DVector::from_fn(rows.order(), |i, _| (2.0 - 0.11 * i as f64).cos());
        for channel in interface.channels(&fixture.mesh, &rows, &k, "friction").unwrap() {
            let reading: f64 = channel.reading.iter().map(|&(dof, r)| r * x[dof]).sum();
            channel.force.iter().for_each(|&(dof, b)| of_channels[dof] += b * reading);
        }
        let expected = interface.friction_stiffness(&rows, &k).unwrap() * &x;
        assert!((of_channels - &expected).amax() < 1e-12 * expected.amax());
    }
    for (name, matrix) in &sums {
        let distance = fixture.distance(name, matrix);
        println!("{name}: {distance:.1e} of the largest entry");
        assert!(distance < 1e-10, "{name}: {distance:e}");
    }
    assert!(sums["normal"] == sums["normal"].transpose());
    // Along an axis exactly: no entries in x and y.
    assert!(sums["normal"].triplet_iter().all(|(row, column, _)| row % 3 == 2 && column % 3 == 2));
}

#[test]
fn the_turning_disc_is_that_of_numpy() {
    let fixture = fixture();
    let rows = Rows::all(&fixture.mesh);
    let body = Body::new(&fixture.mesh, fixture.bodies["DISC"].clone(), &rows).unwrap();
    let transport = body.transport(7.2e-9, &Axis::new([0.0, 0.0, 1.0], [0.0; 3]).unwrap()).unwrap();
    for (name, matrix) in [("gyroscopic", &transport.gyroscopic), ("centripetal", &transport.centripetal)] {
        let distance = fixture.distance(name, matrix);
        println!("{name}: {distance:.1e} of the largest entry");
        assert!(distance < 1e-10, "{name}: {distance:e}");
    }
}

/// Rigid motions of all bodies together move nothing against each other, and forces between them are in balance with their moments.
#[test]
fn rigid_motions_cost_nothing() {
    let fixture = fixture();
    let rows = Rows::all(&fixture.mesh);
    for (pad, interface) in fixture.interfaces() {
        let forces = interface.uniform(1e3).unwrap();
        let k = interface.tangents(&Stiffness::Power { c: 1e4, m: 2.5 }, &forces).unwrap();
        let largest = k.iter().fold(0.0_f64, |largest, k| largest.max(*k));
        let matrices = [
            interface.normal_stiffness(&rows, &k).unwrap(),
            interface.friction_stiffness(&rows, &k).unwrap(),
            interface.lateral_damping(&rows, &forces).unwrap(),
        ];
        for motion in 0..6 {
            let moved = |p: &nalgebra::Vector3<f64>| match motion {
                0..3 => nalgebra::Vector3::ith(motion, 1.0),
                _ => nalgebra::Vector3::ith(motion - 3, 1.0 / 150.0).cross(p),
            };
            let u = fixture.mesh.positions().iter().flat_map(|p| <[f64; 3]>::from(moved(p)));
            let u = DVector::from_iterator(rows.order(), u);
            for matrix in &matrices {
                // The gap is zero here, so that both sides turn alike.
                assert!((matrix * &u).amax() < 1e-12 * largest, "{pad} {motion}");
                assert!((matrix.transpose() * &u).amax() < 1e-12 * largest, "{pad} {motion}");
            }
        }
    }
}
