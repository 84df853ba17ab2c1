//! Two blocks with meshes that do not match, pressed on each other: patch test, convergence, cost and what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lint does not recognise outside test functions.

use contact::{
    Balance, Condensed, ContactError, Integration, Interface, OppositeFaces, Pairing, Side, Sliding, Stiffness,
    Uniqueness,
};
use elements::{Axis, Body, FaceId, Kind, Material, Mesh, Rows};
use nalgebra::{DMatrix, DVector, Vector3};
use nalgebra_sparse::CscMatrix;
use proptest::prelude::*;

use crate::making::{Making, faces};

/// A block of 1 x 1 x 0.4 on a larger one of 1 x 1 x 0.5 or beyond it: faces at z = 0 of both, as slave and master.
fn two_blocks(upper: (Kind, [usize; 3]), lower: (Kind, [usize; 3])) -> (Mesh, Vec<FaceId>, Vec<FaceId>) {
    let mut making = Making::default();
    making.block(upper.0, upper.1, [[0.0, 0.0, 0.0], [1.0, 1.0, 0.4]], |p| p);
    let of_upper = making.elements.len();
    making.block(lower.0, lower.1, [[0.0, 0.0, -0.5], [1.0, 1.0, 0.0]], |p| p);
    let mesh = making.mesh();
    let on = faces(&mesh, |p| p.z.abs() < 1e-12);
    let (slave, master) = on.into_iter().partition(|id: &FaceId| id.element < of_upper);
    (mesh, slave, master)
}

fn along_x(integration: Integration) -> Pairing {
    Pairing { integration, ..Pairing::new(Sliding::Along([1.0, 0.0, 0.0]), 0.01) }
}

/// The upper block is pressed down by a pressure of 1 on a lower one on the ground; both are free to spread. Returns the pressure at each
/// contact point and the largest displacement along x that is not that of the uniform stress.
fn pressed(
    upper: (Kind, [usize; 3]),
    lower: (Kind, [usize; 3]),
    integration: Integration,
) -> (Interface, Vec<f64>, f64) {
    let (mesh, slave, master) = two_blocks(upper, lower);
    let interface = Interface::new(&mesh, &slave, &master, &along_x(integration)).unwrap();
    // Planes of symmetry at x = 0 and y = 0, and the ground.
    let is_held = |place: usize, x: usize| {
        let p = mesh.positions()[place];
        p[x].abs() < 1e-12 && x < 2 || x == 2 && p.z < -0.5 + 1e-12
    };
    let mut order = 0;
    let mut of = std::collections::HashMap::new();
    for place in 0..mesh.labels().len() {
        for x in (0..3).filter(|&x| !is_held(place, x)) {
            of.insert((mesh.labels()[place], x), order);
            order += 1;
        }
    }
    let rows = Rows::new(&mesh, order, |label, x| of.get(&(label, x)).copied()).unwrap();
    let (young, poisson) = (100.0, 0.3);
    let material = Material::new(young, poisson).unwrap();
    let stiffness = Body::new(&mesh, mesh.all(), &rows).unwrap().stiffness(&material).unwrap();
    let mut load = DMatrix::zeros(order, 1);
    for id in faces(&mesh, |p| p.z > 0.4 - 1e-12) {
        let face = mesh.face(id).unwrap();
        for (own, weight) in face.kind.rule() {
            let at = face.at(own);
            for (&node, n) in face.nodes.iter().zip(at.shape.values()) {
                load[(rows.row(node, 2).unwrap(), 0)] -= n * weight * at.area.norm();
            }
        }
    }
    let points = interface.points();
    let of_points = interface.tangents(&Stiffness::PerArea(1e3), &vec![0.0; points.len()]).unwrap();
    let gaps: Vec<_> = points.iter().map(|point| point.gap_row(&rows)).collect();
    let slips: Vec<_> = points.iter().map(|point| point.slip_row(&rows)).collect();
    let condensed = Condensed::new(&stiffness, &gaps, &slips, &of_points, &load).unwrap();
    let nothing = vec![0.0; points.len()];
    let balance = Balance { gaps: nothing.clone(), mu: nothing, loads: vec![1.0] };
    let found = condensed.equilibrium(&balance).unwrap();
    assert_eq!(found.uniqueness, Uniqueness::Definite);
    let total: f64 = found.forces.iter().sum();
    assert!((total - 1.0).abs() < 1e-10, "{total}");
    // The displacements under these forces: K u = f + sum N g, with the points' springs so that nothing floats.
    let closed = interface.normal_stiffness(&rows, &of_points).unwrap();
    let mut right = DVector::from_column_slice(load.as_slice());
    for ((row, force), (gap, k)) in gaps.iter().zip(&found.forces).zip(found.gaps.iter().zip(&of_points)) {
        row.iter().for_each(|&(dof, value)| right[dof] += value * (force + k * gap));
    }
    let u = DMatrix::from(&(stiffness + closed)).lu().solve(&right).unwrap();
    let spread = |p: &Vector3<f64>| poisson / young * p.x;
    let places = (0..mesh.labels().len()).filter_map(|place| Some((place, rows.row(place, 0)?)));
    let off = places.map(|(place, row)| (u[row] - spread(&mesh.positions()[place])).abs()).fold(0.0, f64::max);
    let pressures = found.forces.iter().zip(interface.points()).map(|(force, point)| force / point.area).collect();
    (interface, pressures, off / (poisson / young))
}

#[test]
fn a_constant_pressure_passes_through_meshes_that_do_not_match() {
    use Kind::{Hexahedron8, Hexahedron20, Tetrahedron4, Tetrahedron10, Wedge6, Wedge15};
    for (upper, lower) in [
        ((Hexahedron8, [3, 2, 1]), (Hexahedron8, [2, 5, 2])),
        ((Hexahedron20, [2, 1, 1]), (Hexahedron20, [3, 2, 1])),
        ((Hexahedron20, [2, 2, 1]), (Hexahedron8, [3, 3, 1])),
        ((Wedge6, [3, 2, 1]), (Hexahedron20, [2, 2, 1])),
        ((Wedge15, [2, 1, 1]), (Tetrahedron10, [1, 2, 1])),
        ((Tetrahedron4, [2, 3, 1]), (Wedge15, [1, 2, 1])),
        ((Tetrahedron10, [1, 1, 1]), (Tetrahedron4, [3, 2, 1])),
    ] {
        let (interface, pressures, off) = pressed(upper, lower, Integration::Segments);
        assert!((interface.area() - 1.0).abs() < 1e-13);
        let worst = pressures.iter().map(|p| (p - 1.0).abs()).fold(0.0, f64::max);
        println!(
            "{:?} on {:?}: {} points, pressure off by {worst:.1e}, u by {off:.1e}",
            upper.0,
            lower.0,
            pressures.len()
        );
        assert!(worst < 1e-12 && off < 1e-12, "{worst:e} {off:e}");
    }
}

/// Points of Gauss alone do not pass it exactly, but ever better.
#[test]
fn points_of_gauss_converge() {
    let error = |n: usize| {
        let (_, pressures, _) = pressed(
            (Kind::Hexahedron8, [2 * n, 2 * n, 1]),
            (Kind::Hexahedron8, [3 * n, n, 1]),
            Integration::GaussPoints,
        );
        // In the mean: at single points it oscillates.
        (pressures.iter().map(|p| (p - 1.0).powi(2)).sum::<f64>() / pressures.len() as f64).sqrt()
    };
    let errors = [error(1), error(2), error(3)];
    println!("{errors:?}");
    assert!(errors[0] < 0.01 && errors[2] < 0.6 * errors[0]);
}

/// What the master gets of a pressure that varies over the face goes to what it should as meshes are refined.
#[test]
fn forces_on_the_master_converge() {
    let pressure = |p: &Vector3<f64>| (2.0 * p.x).sin() + p.y * p.y;
    let tested = |p: &Vector3<f64>| (1.5 * p.y + p.x).cos();
    let of = |n: usize, integration| {
        let (mesh, slave, master) =
            two_blocks((Kind::Hexahedron8, [3 * n, 2 * n, 1]), (Kind::Hexahedron8, [2 * n, 5 * n, 1]));
        let interface = Interface::new(&mesh, &slave, &master, &along_x(integration)).unwrap();
        let on_master = |point: &contact::ContactPoint| {
            let v: f64 = point.master.iter().map(|&(node, n)| n * tested(&mesh.positions()[node])).sum();
            point.area * pressure(&point.position) * v
        };
        interface.points().iter().map(on_master).sum::<f64>()
    };
    // By a fine sum.
    let fine = 400;
    let centre = |i: usize| (i as f64 + 0.5) / fine as f64;
    let at = |i: usize| Vector3::new(centre(i % fine), centre(i / fine), 0.0);
    let exact = (0..fine * fine).map(|i| pressure(&at(i)) * tested(&at(i))).sum::<f64>() / (fine * fine) as f64;
    for integration in [Integration::GaussPoints, Integration::Segments] {
        let errors = [1, 2, 4].map(|n| (of(n, integration) - exact).abs());
        println!("{integration:?}: {errors:?}");
        assert!(errors[2] < errors[0] / 8.0 && errors[2] < 1e-3, "{errors:?}");
    }
}

#[test]
fn a_large_face_costs_what_it_has() {
    let of = |n: usize| {
        let (mesh, slave, master) = two_blocks((Kind::Hexahedron8, [n, n, 1]), (Kind::Hexahedron8, [n + 3, n + 1, 1]));
        let pairing = Pairing { reach: 0.01 / n as f64, ..along_x(Integration::GaussPoints) };
        let interface = Interface::new(&mesh, &slave, &master, &pairing).unwrap();
        interface.projections() as f64 / interface.points().len() as f64
    };
    let (small, large) = (of(8), of(32));
    println!("projections by point: {small} and {large}");
    // As many again for the corners of its face.
    assert!(large < 16.0 && large < 1.2 * small);
}

#[test]
fn gaps_and_normals_of_curved_faces() {
    // A quarter of a tube around z in another one, with unlike cells: their facets leave slits and overlaps.
    let turned = |[r, angle, z]: [f64; 3]| [r * angle.cos(), r * angle.sin(), z];
    let mut making = Making::default();
    let quarter = std::f64::consts::FRAC_PI_2;
    making.block(Kind::Hexahedron8, [1, 7, 2], [[2.0, 0.1 * quarter, 0.0], [2.3, 0.9 * quarter, 1.0]], turned);
    let outer = making.elements.len();
    making.block(Kind::Hexahedron20, [1, 10, 3], [[1.5, 0.0, -0.2], [2.0, quarter, 1.2]], turned);
    let mesh = making.mesh();
    let on = faces(&mesh, |p| (p.xy().norm() - 2.0).abs() < 1e-2);
    let (slave, master): (Vec<_>, Vec<_>) = on.into_iter().partition(|id| id.element < outer);
    assert_eq!((slave.len(), master.len()), (14, 30));
    let axis = Axis::new([0.0, 0.0, 1.0], [0.0; 3]).unwrap();
    let pairing = Pairing::new(Sliding::About { axis, speed: -3.0 }, 0.05);
    let interface = Interface::new(&mesh, &slave, &master, &pairing).unwrap();
    for point in interface.points() {
        let outwards = point.position.xy().normalize().push(0.0);
        assert!(point.normal.dot(&outwards) > 0.999 && point.gap.abs() < 0.02, "{point:?}");
        let along = Vector3::new(outwards.y, -outwards.x, 0.0);
        assert!(point.sliding.dot(&along) > 0.999);
        assert!((point.speed / (3.0 * point.position.xy().norm()) - 1.0).abs() < 1e-3);
        assert!(point.sliding.dot(&point.normal).abs() < 1e-14 && (point.sliding.norm() - 1.0).abs() < 1e-14);
    }
}

#[test]
fn pressures_of_nodes_are_between_them_what_shape_functions_say() {
    let (mesh, slave, master) = two_blocks((Kind::Hexahedron20, [2, 2, 1]), (Kind::Hexahedron20, [3, 1, 1]));
    let interface = Interface::new(&mesh, &slave, &master, &along_x(Integration::GaussPoints)).unwrap();
    let nodes: std::collections::BTreeSet<usize> = slave.iter().flat_map(|id| mesh.face(*id).unwrap().nodes).collect();
    let given: Vec<(i64, f64)> =
        nodes.iter().map(|&node| (mesh.labels()[node], 1.0 + mesh.positions()[node].x)).collect();
    let forces = interface.of_pressures(&mesh, &given).unwrap();
    assert!((forces.iter().sum::<f64>() - 1.5).abs() < 1e-13);
    for (force, point) in forces.iter().zip(interface.points()) {
        assert!((force / point.area - 1.0 - point.position.x).abs() < 1e-12);
    }
    let label = given[3].0;
    let error = interface.of_pressures(&mesh, &given[..3]).unwrap_err();
    assert!(matches!(error, ContactError::NoPressure { .. }), "{error}");
    let mut other = given.clone();
    other.push((999, 1.0));
    assert_eq!(interface.of_pressures(&mesh, &other), Err(ContactError::UnknownNode { node: 999 }));
    other[3] = (label, -1.0);
    assert!(matches!(interface.of_pressures(&mesh, &other), Err(ContactError::Value { .. })));
    assert!(interface.uniform(0.0).is_err());
    assert!((interface.uniform(7.0).unwrap().iter().sum::<f64>() - 7.0).abs() < 1e-13);
}

/// An upper block that is tilted about one of its edges: its far part is beyond the reach, and over the master all the same.
#[test]
fn a_gap_beyond_the_reach_is_not_a_master_that_is_too_small() {
    for (slope, reach) in [(0.02, 0.01), (0.1, 0.01), (0.3, 0.2)] {
        let mut making = Making::default();
        let tilted = |[x, y, z]: [f64; 3]| [x, y, z + slope * x];
        making.block(Kind::Hexahedron8, [4, 4, 1], [[0.0, 0.0, 0.0], [1.0, 1.0, 0.4]], tilted);
        let of_upper = making.elements.len();
        making.block(Kind::Hexahedron8, [3, 3, 1], [[0.0, 0.0, -0.5], [1.0, 1.0, 0.0]], |p| p);
        let mesh = making.mesh();
        let slave = faces(&mesh, |p| (p.z - slope * p.x).abs() < 1e-12);
        let master = faces(&mesh, |p| p.z.abs() < 1e-12);
        let [slave, master] = [(slave, true), (master, false)].map(|(faces, is_upper)| {
            faces.into_iter().filter(|id| (id.element < of_upper) == is_upper).collect::<Vec<FaceId>>()
        });
        let of = |master: &[FaceId], reach: f64| {
            let pairing = Pairing { reach, ..along_x(Integration::GaussPoints) };
            Interface::new(&mesh, &slave, master, &pairing)
        };
        assert!(of(&master, 1.1 * slope).is_ok());
        let Err(ContactError::Apart { distance, .. }) = of(&master, reach) else { panic!("{slope}") };
        assert!(distance > reach && distance < slope, "{slope}: {distance}");
        let beside = of(&master[..6], 1.1 * slope).unwrap_err();
        assert!(matches!(beside, ContactError::MasterSmaller { .. }), "{beside}");
    }
}

/// A master that covers a part of the slave: with an overhang the points over it are those of the same slave without it, to the last bit, and the rest of the
/// area is told. Where nothing meets, and where a gap is beyond the reach, an overhang is no excuse.
#[test]
fn what_hangs_over_the_edge_of_the_master_carries_nothing() {
    for integration in [Integration::GaussPoints, Integration::Segments] {
        for kind in [Kind::Hexahedron8, Kind::Hexahedron20] {
            let (mesh, slave, master) = two_blocks((kind, [4, 3, 1]), (kind, [3, 3, 1]));
            let pairing = along_x(integration);
            let [plain, hanging] = [false, true].map(|overhang| Pairing { overhang, ..pairing });
            let whole = Interface::new(&mesh, &slave, &master, &plain).unwrap();
            assert_eq!(Interface::new(&mesh, &slave, &master, &hanging), Ok(whole.clone()));
            // Two of three rows of the master: x or y below 2/3.
            let centre = |id: &FaceId| mesh.face(*id).unwrap().positions.iter().sum::<Vector3<f64>>();
            let count = |id: &FaceId| mesh.face(*id).unwrap().positions.len() as f64;
            let part: Vec<FaceId> = master.iter().copied().filter(|id| centre(id).y / count(id) < 0.6).collect();
            assert_eq!(part.len(), 6);
            let refused = Interface::new(&mesh, &slave, &part, &plain).unwrap_err();
            assert!(matches!(refused, ContactError::MasterSmaller { .. }), "{refused}");
            let found = Interface::new(&mesh, &slave, &part, &hanging).unwrap();
            assert!((found.area() - 2.0 / 3.0).abs() < 1e-12 && (found.overhang() - 1.0 / 3.0).abs() < 1e-12);
            let covered: Vec<_> = whole.points().iter().filter(|point| part.contains(&point.master_face)).collect();
            assert_eq!(found.points().iter().collect::<Vec<_>>(), covered);
            let near = Pairing { reach: 1e-3, ..hanging };
            let bottom = faces(&mesh, |p| p.z < -0.5 + 1e-12);
            assert!(matches!(Interface::new(&mesh, &slave, &bottom, &near), Err(ContactError::Apart { .. })));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A pad that is turned and moved over the edges of a disc carries on the area that both have in common, whatever the meshes, the rule of integration and what
    /// lies behind the face of the disc are, as in a ventilated one; the rest hangs over, and without an overhang it is refused.
    #[test]
    fn a_pad_carries_where_it_is_over_the_disc(
        (turn, x, y) in (0.0..1.5_f64, -0.6..0.6_f64, -0.6..0.6_f64),
        (upper, lower) in ([1..5_usize, 1..5], [1..5_usize, 1..5]),
        (is_quadratic, is_cut, has_second, is_whole) in any::<(bool, bool, bool, bool)>(),
    ) {
        let kind = if is_quadratic { Kind::Hexahedron20 } else { Kind::Hexahedron8 };
        let (sin, cos) = turn.sin_cos();
        let placed = |[a, b, z]: [f64; 3]| {
            let (a, b) = (a - 0.5, b - 0.5);
            [0.5 + x + cos * a - sin * b, 0.5 + y + sin * a + cos * b, z]
        };
        let mut making = Making::default();
        making.block(kind, [upper[0], upper[1], 1], [[0.0, 0.0, 0.0], [1.0, 1.0, 0.4]], placed);
        let of_upper = making.elements.len();
        making.block(kind, [lower[0], lower[1], 1], [[0.0, 0.0, -0.02], [1.0, 1.0, 0.0]], |p| p);
        if has_second {
            making.block(kind, [lower[1], lower[0], 1], [[0.1, 0.1, -0.5], [0.9, 0.9, -0.05]], |p| p);
        }
        let mesh = making.mesh();
        let on = faces(&mesh, |p| p.z.abs() < 1e-12 || (p.z + 0.05).abs() < 1e-12);
        let (slave, mut master): (Vec<_>, Vec<_>) = on.into_iter().partition(|id: &FaceId| id.element < of_upper);
        if is_whole {
            let of_disc: Vec<usize> = mesh.all().into_iter().filter(|&element| element >= of_upper).collect();
            master = mesh.outer_faces(&of_disc).unwrap();
        }
        // By counting.
        let fine = 300;
        let middle = |i: usize| (i as f64 + 0.5) / fine as f64;
        let is_over = |i: usize| {
            let [x, y, _] = placed([middle(i % fine), middle(i / fine), 0.0]);
            (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y)
        };
        let common = (0..fine * fine).filter(|&i| is_over(i)).count() as f64 / (fine * fine) as f64;
        let integration = if is_cut { Integration::Segments } else { Integration::GaussPoints };
        let pairing = along_x(integration);
        let found = Interface::new(&mesh, &slave, &master, &Pairing { overhang: true, ..pairing }).unwrap();
        // What is within a slit of the edge carries, too.
        let slit = 4.0 * 0.5 * pairing.slit / lower[0].min(lower[1]) as f64;
        prop_assert!(found.area() > common - 3e-3 && found.area() < common + 3e-3 + slit, "{} {common}", found.area());
        prop_assert!((found.area() + found.overhang() - 1.0).abs() < 1e-5, "{} and {}", found.area(), found.overhang());
        if common < 1.0 - 3e-3 - slit {
            let refused = Interface::new(&mesh, &slave, &master, &pairing).unwrap_err();
            let is_by_rim = is_whole && matches!(refused, ContactError::Normals { .. });
            prop_assert!(is_by_rim || matches!(refused, ContactError::MasterSmaller { .. }), "{}", refused);
        }
    }
}

#[test]
fn what_is_no_contact_is_refused_by_name() {
    let (mesh, slave, master) = two_blocks((Kind::Hexahedron8, [2, 2, 1]), (Kind::Hexahedron8, [3, 3, 1]));
    let pairing = along_x(Integration::GaussPoints);
    let of = |slave: &[FaceId], master: &[FaceId], pairing: &Pairing| Interface::new(&mesh, slave, master, pairing);
    assert!(of(&slave, &master, &pairing).is_ok());
    assert_eq!(of(&[], &master, &pairing), Err(ContactError::NoFaces { side: Side::Slave }));
    assert_eq!(of(&slave, &[], &pairing), Err(ContactError::NoFaces { side: Side::Master }));
    // Part of the master.
    let error = of(&slave, &master[..6], &pairing).unwrap_err();
    let ContactError::MasterSmaller { share, .. } = error else { panic!("{error}") };
    assert!((share - 1.0 / 3.0).abs() < 0.02, "{share}");
    // The bottom of the lower block: it is far, and looks away.
    let bottom = faces(&mesh, |p| p.z < -0.5 + 1e-12);
    let error = of(&slave, &bottom, &pairing).unwrap_err();
    assert!(matches!(error, ContactError::Apart { .. }), "{error}");
    let error = of(&slave, &bottom, &Pairing { reach: 1.0, ..pairing }).unwrap_err();
    assert!(matches!(error, ContactError::Normals { .. }), "{error}");
    // Of all outer faces of the upper block those that look at it.
    let outer = mesh.outer_faces(&[0, 1, 2, 3]).unwrap();
    let mut facing = OppositeFaces::new(&mesh, &outer, &master, &pairing).unwrap();
    facing.faces.sort();
    assert_eq!(facing, OppositeFaces { faces: slave.clone(), beyond: 0.0 });
    // Over the first third of the lower block along y, of which each of the upper faces has a half: the others go on flat with them.
    let mut facing = OppositeFaces::new(&mesh, &outer, &master[..3], &pairing).unwrap();
    facing.faces.sort();
    let first = |id: &FaceId| mesh.face(*id).unwrap().positions.iter().all(|p| p.y < 0.5 + 1e-12);
    assert_eq!(facing.faces, slave.iter().copied().filter(first).collect::<Vec<_>>());
    assert!((facing.beyond - 0.5).abs() < 1e-12, "{}", facing.beyond);
    // Itself.
    let error = of(&slave, &slave, &pairing).unwrap_err();
    assert!(matches!(error, ContactError::Normals { cosine, .. } if (cosine - 1.0).abs() < 1e-12), "{error}");
    let upwards = Pairing { sliding: Sliding::Along([0.0, 0.0, 2.0]), ..pairing };
    assert!(matches!(of(&slave, &master, &upwards), Err(ContactError::NoSliding { .. })));
    let axis = Axis::new([0.0, 0.0, 1.0], [0.4, 0.3, 7.0]).unwrap();
    let through = Pairing { sliding: Sliding::About { axis, speed: 1.0 }, ..pairing };
    let error = of(&slave, &master, &through).unwrap_err();
    assert!(matches!(error, ContactError::AxisThroughSlave { element: 1, .. }), "{error}");
    let axis = Axis::new([0.0, 0.0, 1.0], [-1.0, 0.3, 0.0]).unwrap();
    assert!(of(&slave, &master, &Pairing { sliding: Sliding::About { axis, speed: 1.0 }, ..pairing }).is_ok());
    for bad in [
        Pairing { reach: 0.0, ..pairing },
        Pairing { largest_cosine: 0.5, ..pairing },
        Pairing { slit: f64::NAN, ..pairing },
        Pairing { sliding: Sliding::Along([0.0; 3]), ..pairing },
        Pairing { sliding: Sliding::About { axis, speed: 0.0 }, ..pairing },
    ] {
        assert!(matches!(of(&slave, &master, &bad), Err(ContactError::Value { .. })), "{bad:?}");
    }
    // A face without area.
    let flat = vec![(1, [0.0; 3]), (2, [1.0, 0.0, 0.0]), (3, [2.0, 0.0, 0.0]), (4, [0.0, 0.0, 1.0])];
    let flat = Mesh::new(flat, vec![(5, Kind::Tetrahedron4, vec![1, 2, 3, 4])]).unwrap();
    let face = [FaceId { element: 0, number: 1 }];
    let error = Interface::new(&flat, &face, &face, &pairing).unwrap_err();
    assert_eq!(error, ContactError::NoArea { side: Side::Slave, element: 5, face: 1 });
}

/// Elements of a mirrored copy that kept their order of nodes: their faces look inwards, and friction would act the other way.
#[test]
fn faces_of_inverted_elements_are_refused() {
    for kind in Kind::ALL {
        let mut making = Making::default();
        making.block(kind, [2, 2, 1], [[0.0, 0.0, 0.0], [1.0, 1.0, 0.4]], |p| p);
        let of_upper = making.elements.len();
        making.block(kind, [3, 3, 1], [[0.0, 0.0, -0.5], [1.0, 1.0, 0.0]], |p| p);
        for mirrored in [0..0, 0..of_upper, of_upper..making.elements.len(), 0..making.elements.len()] {
            // The same solids at their mirror image in x = 0.
            let at = |element: usize| if mirrored.contains(&element) { -1.0 } else { 1.0 };
            let nodes = making.nodes.iter().map(|&(label, [x, y, z])| {
                let owner = making.elements.iter().position(|(.., nodes)| nodes.contains(&label)).unwrap();
                (label, [at(owner) * (x - 0.5), y, z])
            });
            let mesh = Mesh::new(nodes.collect(), making.elements.clone()).unwrap();
            let on = faces(&mesh, |p| p.z.abs() < 1e-12);
            let (slave, master): (Vec<_>, Vec<_>) = on.into_iter().partition(|id: &FaceId| id.element < of_upper);
            let found = Interface::new(&mesh, &slave, &master, &along_x(Integration::GaussPoints));
            match found {
                Ok(found) => {
                    assert!(mirrored.is_empty() && (found.area() - 1.0).abs() < 1e-12, "{kind:?} {mirrored:?}")
                }
                Err(error) => {
                    let is_inverted = matches!(error, ContactError::Mesh(elements::ElementsError::Inverted { .. }));
                    assert!(is_inverted && !mirrored.is_empty(), "{kind:?} {mirrored:?} {error}");
                }
            }
        }
    }
}

/// Which of two faces at one place is in contact would follow from the order of their elements; two of the slave would be pressed twice.
#[test]
fn faces_of_one_side_that_lie_on_each_other_are_refused() {
    for cells in [[3, 3, 1], [2, 3, 1], [5, 4, 1]] {
        let mut making = Making::default();
        making.block(Kind::Hexahedron8, [2, 2, 1], [[0.0, 0.0, 0.0], [1.0, 1.0, 0.4]], |p| p);
        making.block(Kind::Hexahedron8, [3, 3, 1], [[0.0, 0.0, -0.5], [1.0, 1.0, 0.0]], |p| p);
        making.block(Kind::Hexahedron8, cells, [[0.0, 0.0, -0.3], [1.0, 1.0, 0.0]], |p| p);
        let mesh = making.mesh();
        let on = faces(&mesh, |p| p.z.abs() < 1e-12);
        let (slave, master): (Vec<_>, Vec<_>) = on.into_iter().partition(|id: &FaceId| id.element < 4);
        for integration in [Integration::GaussPoints, Integration::Segments] {
            let error = Interface::new(&mesh, &slave, &master, &along_x(integration)).unwrap_err();
            assert!(matches!(error, ContactError::OnEachOther { side: Side::Master, .. }), "{cells:?} {error}");
            // The lower blocks as the slave.
            let error = Interface::new(&mesh, &master, &slave, &along_x(integration)).unwrap_err();
            assert!(matches!(error, ContactError::OnEachOther { side: Side::Slave, .. }), "{cells:?} {error}");
        }
    }
}

#[test]
fn patches_are_told_by_shared_and_by_parted_nodes() {
    let (mesh, slave, master) = two_blocks((Kind::Hexahedron8, [4, 1, 1]), (Kind::Hexahedron8, [3, 1, 1]));
    let interface = Interface::new(&mesh, &slave, &master, &along_x(Integration::GaussPoints)).unwrap();
    let nodes = |is_there: &dyn Fn(f64) -> bool| -> Vec<usize> {
        (0..mesh.labels().len()).filter(|&node| is_there(mesh.positions()[node].x)).collect()
    };
    let named = |left: Vec<usize>, right: Vec<usize>| [("LEFT".to_owned(), left), ("RIGHT".to_owned(), right)];
    for patches in
        [named(nodes(&|x| x < 0.51), nodes(&|x| x > 0.49)), named(nodes(&|x| x < 0.49), nodes(&|x| x > 0.74))]
    {
        let of = interface.patches(&mesh, &patches).unwrap();
        for (point, patch) in interface.points().iter().zip(of) {
            assert_eq!(patch, usize::from(point.position.x > 0.5), "{:?}", point.position);
        }
    }
    let left = nodes(&|x| x < 0.3);
    let error = interface.patches(&mesh, &named(left.clone(), Vec::new())).unwrap_err();
    assert!(matches!(error, ContactError::NoPatch { .. }), "{error}");
    let error = interface.patches(&mesh, &named(left.clone(), left)).unwrap_err();
    assert!(matches!(error, ContactError::TwoPatches { .. }), "{error}");
}

/// A sum of products as the matrices make it.
#[test]
fn dashpots_across_are_the_plane_less_the_sliding() {
    let (mesh, slave, master) = two_blocks((Kind::Wedge15, [1, 1, 1]), (Kind::Tetrahedron10, [1, 1, 1]));
    let pairing = Pairing { sliding: Sliding::Along([3.0, 4.0, 0.0]), ..along_x(Integration::GaussPoints) };
    let interface = Interface::new(&mesh, &slave, &master, &pairing).unwrap();
    let rows = Rows::all(&mesh);
    let forces = interface.uniform(10.0).unwrap();
    let damping: CscMatrix<f64> = interface.lateral_damping(&rows, &forces).unwrap();
    // The upper block moves with v: the dissipation is N0 / v times the square of what is across.
    for v in [[1.0, 0.0, 0.0], [0.3, 0.4, 0.0], [0.0, 0.0, 1.0], [0.2, -0.5, 0.4]] {
        let v = Vector3::from(v);
        let u = mesh.positions().iter().enumerate().flat_map(|(place, p)| {
            let is_upper =
                p.z > 1e-9 || p.z > -1e-9 && slave.iter().any(|id| mesh.elements()[id.element].nodes.contains(&place));
            <[f64; 3]>::from(if is_upper { v } else { Vector3::zeros() })
        });
        let u = DVector::from_iterator(rows.order(), u);
        let (n, t) = (Vector3::z(), Vector3::new(0.6, 0.8, 0.0));
        let expected = 10.0 / 5.0 * (v.norm_squared() - v.dot(&n).powi(2) - v.dot(&t).powi(2));
        assert!((u.dot(&(&damping * &u)) - expected).abs() < 1e-12, "{v:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever the meshes: points have the area, shape functions add up to one on both sides, forces and their moments are in balance.
    #[test]
    fn points_of_any_two_meshes(
        kinds in prop::array::uniform2(0..6_usize),
        cells in prop::array::uniform4(1..4_usize),
        by_pieces in any::<bool>(),
        motion in prop::array::uniform6(-1.0..1.0_f64),
        sliding in prop::array::uniform2(0.1..1.0_f64),
    ) {
        let [upper, lower] = kinds.map(|kind| Kind::ALL[kind]);
        let (mesh, slave, master) = two_blocks((upper, [cells[0], cells[1], 1]), (lower, [cells[2], cells[3], 1]));
        let integration = if by_pieces { Integration::Segments } else { Integration::GaussPoints };
        let velocity = Sliding::Along([sliding[0], sliding[1], 0.3]);
        let pairing = Pairing { sliding: velocity, ..along_x(integration) };
        let interface = Interface::new(&mesh, &slave, &master, &pairing).unwrap();
        prop_assert!((interface.area() - 1.0).abs() < 1e-12);
        let rows = Rows::all(&mesh);
        // A rigid motion of both.
        let (shift, spin) = (Vector3::new(motion[0], motion[1], motion[2]), Vector3::new(motion[3], motion[4], motion[5]));
        let moved = mesh.positions().iter().flat_map(|p| <[f64; 3]>::from(shift + spin.cross(p)));
        let moved = DVector::from_iterator(rows.order(), moved);
        for point in interface.points() {
            for side in [&point.slave, &point.master] {
                prop_assert!((side.iter().map(|(_, n)| n).sum::<f64>() - 1.0).abs() < 1e-12);
                let at: Vector3<f64> = side.iter().map(|&(node, n)| mesh.positions()[node] * n).sum();
                prop_assert!((at - point.position).norm() < 1e-12);
            }
            prop_assert_eq!(point.normal, Vector3::z());
            prop_assert!((point.speed - sliding[0].hypot(sliding[1])).abs() < 1e-14);
            for row in [point.gap_row(&rows), point.slip_row(&rows), point.across_row(&rows)] {
                prop_assert!(row.iter().map(|&(dof, value)| value * moved[dof]).sum::<f64>().abs() < 1e-12);
                prop_assert!(row.windows(2).all(|pair| pair[0].0 < pair[1].0));
            }
        }
    }
}
