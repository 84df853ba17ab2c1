//! A block that is pressed beside its middle, so that it tilts and parts from what is below: against CalculiX's own static contact.
//!
//! `calculix/*.txt` are what CalculiX prints of `calculix/press.py`: surface to surface, linear pressure over overlap. It integrates over
//! triangles in the plane between both faces, so that equal numbers are not to be expected from points of Gauss.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use std::collections::HashMap;

use contact::{Balance, Condensed, Integration, Interface, Pairing, Sliding, Stiffness};
use elements::{Body, FaceId, Kind, Material, Rows};
use nalgebra::{DMatrix, DVector, Vector3};

use crate::making::{Making, faces};

/// The displacements along z at the top, and how many contact points of how many are closed.
fn pressed(
    upper: [usize; 3],
    lower: [usize; 3],
    slope: f64,
    integration: Integration,
) -> (Vec<(Vector3<f64>, f64)>, [usize; 2]) {
    let mut making = Making::default();
    making.block(Kind::Hexahedron20, upper, [[0.0, 0.0, 0.0], [1.0, 1.0, 0.4]], |p| p);
    let of_upper = making.elements.len();
    let first_lower = making.nodes.len();
    making.block(Kind::Hexahedron20, lower, [[0.0, 0.0, -0.5], [1.0, 1.0, 0.0]], |p| p);
    let mesh = making.mesh();
    let on = faces(&mesh, |p| p.z.abs() < 1e-12);
    let (slave, master): (Vec<FaceId>, Vec<FaceId>) = on.into_iter().partition(|id| id.element < of_upper);
    let pairing = Pairing { integration, ..Pairing::new(Sliding::Along([1.0, 0.0, 0.0]), 0.01) };
    let interface = Interface::new(&mesh, &slave, &master, &pairing).unwrap();
    // The ground, and what keeps the upper block from sliding and turning about z.
    let is_held = |place: usize, x: usize| {
        let p = mesh.positions()[place];
        let is_corner = place < first_lower && p.z == 0.0 && p.x == 0.0;
        p.z < -0.5 + 1e-12 || is_corner && (p.y == 0.0 && x < 2 || p.y == 1.0 && x == 0)
    };
    let mut of = HashMap::new();
    for place in 0..mesh.labels().len() {
        for x in (0..3).filter(|&x| !is_held(place, x)) {
            of.insert((mesh.labels()[place], x), of.len());
        }
    }
    let order = of.len();
    let rows = Rows::new(&mesh, order, |label, x| of.get(&(label, x)).copied()).unwrap();
    let material = Material::new(100.0, 0.3).unwrap();
    let structure = Body::new(&mesh, mesh.all(), &rows).unwrap().stiffness(&material).unwrap();
    let mut load = DMatrix::zeros(order, 1);
    for id in faces(&mesh, |p| p.z > 0.4 - 1e-12 && p.x > 0.75 - 1e-12) {
        let face = mesh.face(id).unwrap();
        for (own, weight) in face.kind.rule() {
            let at = face.at(own);
            for (&node, n) in face.nodes.iter().zip(at.shape.values()) {
                load[(rows.row(node, 2).unwrap(), 0)] -= 0.001 * n * weight * at.area.norm();
            }
        }
    }
    let points = interface.points();
    let nothing = vec![0.0; points.len()];
    let k = interface.tangents(&Stiffness::PerArea(slope), &nothing).unwrap();
    let gaps: Vec<_> = points.iter().map(|point| point.gap_row(&rows)).collect();
    let slips: Vec<_> = points.iter().map(|point| point.slip_row(&rows)).collect();
    let condensed = Condensed::new(&structure, &gaps, &slips, &k, &load).unwrap();
    let found = condensed.equilibrium(&Balance { gaps: nothing.clone(), mu: nothing, loads: vec![1.0] }).unwrap();
    assert!((found.forces.iter().sum::<f64>() / 0.00025 - 1.0).abs() < 1e-10);
    // K u = f + sum N g, with the springs of all points on both sides so that nothing floats.
    let mut right = DVector::from_column_slice(load.as_slice());
    for ((row, force), (gap, k)) in gaps.iter().zip(&found.forces).zip(found.gaps.iter().zip(&k)) {
        row.iter().for_each(|&(dof, value)| right[dof] += value * (force + k * gap));
    }
    let u = DMatrix::from(&(structure + interface.normal_stiffness(&rows, &k).unwrap())).lu().solve(&right).unwrap();
    let top = (0..mesh.labels().len()).filter(|&place| mesh.positions()[place].z > 0.4 - 1e-12);
    let displacements = top.map(|place| (mesh.positions()[place], u[rows.row(place, 2).unwrap()])).collect();
    (displacements, [found.closed().iter().filter(|closed| **closed).count(), points.len()])
}

#[test]
fn a_block_that_parts_is_that_of_calculix() {
    let tilt = include_str!("../calculix/tilt.txt");
    let fine = include_str!("../calculix/fine.txt");
    let stiff = include_str!("../calculix/stiff.txt");
    for (name, text, upper, lower, slope, tolerance) in [
        ("coarse", tilt, [4, 2, 1], [3, 3, 1], 50.0, [6e-2, 5e-3]),
        ("fine", fine, [8, 3, 2], [6, 4, 2], 50.0, [1e-3, 1e-4]),
        ("stiff", stiff, [8, 3, 2], [6, 4, 2], 500.0, [3e-3, 3e-4]),
    ] {
        // Thousands of pieces take half a minute: 4.0e-5 and 1.3e-4 of the finer ones.
        let of_pieces = (name == "coarse").then_some(Integration::Segments);
        for integration in [Integration::GaussPoints].into_iter().chain(of_pieces) {
            let (found, [closed, all]) = pressed(upper, lower, slope, integration);
            assert!(closed < all, "it parts");
            let (mut worst, mut largest, mut nodes) = (0.0_f64, 0.0_f64, 0);
            for line in text.lines().filter(|line| !line.starts_with('#')) {
                let n: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
                let place = Vector3::new(n[0], n[1], n[2]);
                let own = found.iter().find(|(at, _)| (at - place).norm() < 1e-6).unwrap().1;
                worst = worst.max((own - n[5]).abs());
                largest = largest.max(n[5].abs());
                nodes += 1;
            }
            println!("{name}, {integration:?}: {closed} of {all} closed, {nodes} nodes off by {:.1e}", worst / largest);
            let tolerance = tolerance[usize::from(integration == Integration::Segments)];
            assert!(worst < tolerance * largest, "{name}: {worst:e} of {largest:e}");
        }
    }
}
