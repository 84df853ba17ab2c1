//! Small brakes of every make: how names and the normal are compared with the mesh.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use std::collections::BTreeSet;
use std::fmt::Write;

use nalgebra::{Rotation3, Vector3};

use case::{CaseFile, FiniteElementCase, MissingRows, Side};

/// Numbers that look random, the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }

    fn angle(&mut self) -> f64 {
        self.below(6_283) as f64 / 1e3
    }
}

/// Elements of a brake.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mesh {
    Bricks,
    Prisms,
    Tetrahedra,
    /// Bricks that touch at some nodes of their faces.
    Some,
    /// Plates in the plane of the contact.
    Plates,
    None,
}

const MESHES: [Mesh; 6] = [Mesh::Bricks, Mesh::Prisms, Mesh::Tetrahedra, Mesh::Some, Mesh::Plates, Mesh::None];

/// A pad of 2 x 1 cubes on a disc of 3 x 2, turned somehow.
struct Brake {
    mesh: Mesh,
    turned: Rotation3<f64>,
    normal: Vector3<f64>,
    exchanged: bool,
    /// Nodes whose rows the matrices do not have.
    without: BTreeSet<i64>,
    friction: &'static str,
    contact: bool,
}

/// Numbers of the nodes of the contact: of the pad, patch by patch, and of the disc below them.
const PAD: [i64; 6] = [201, 211, 202, 212, 203, 213];
const DISC: [i64; 6] = [101, 111, 102, 112, 103, 113];

impl Brake {
    fn new(mesh: Mesh, random: &mut Random) -> Self {
        let turned = Rotation3::from_euler_angles(random.angle(), random.angle(), random.angle());
        let normal = turned * Vector3::z();
        let friction = "[friction]\nmu = { distribution = \"constant\", value = 0.4 }\n";
        Self { mesh, turned, normal, exchanged: false, without: BTreeSet::new(), friction, contact: true }
    }

    /// Number and place of each node: 0 to 99 of the bottom of the disc, from 100 on of its top, 200 of the pad, 300 of its top.
    fn nodes() -> Vec<(i64, Vector3<f64>)> {
        let mut nodes = Vec::new();
        for (from, columns, rows, z) in [(0, 4, 3, 0.0), (100, 4, 3, 0.1), (200, 4, 2, 0.1), (300, 4, 2, 0.15)] {
            for j in 0..rows {
                // The pad has no nodes in its first column.
                let first = if from < 200 { 0 } else { 1 };
                nodes.extend((first..columns).map(|i| (from + 10 * j + i, Vector3::new(i as f64, j as f64, z))));
            }
        }
        nodes
    }

    fn elements(&self) -> String {
        let (mut text, mut element) = (String::new(), 0);
        let mut add = |kind: &str, nodes: &[i64]| {
            element += 1;
            let list = nodes.iter().map(i64::to_string).collect::<Vec<_>>().join(", ");
            writeln!(text, "*ELEMENT, TYPE={kind}\n{element}, {list}").unwrap();
        };
        let cubes = [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)].map(|(i, j)| i + 10 * j);
        for base in cubes.into_iter().chain([201, 202]) {
            let [a, b, c, d] = [base, base + 1, base + 11, base + 10];
            let up = |node: i64| node + 100;
            match self.mesh {
                Mesh::Bricks | Mesh::Some => add("C3D8R", &[a, b, c, d, up(a), up(b), up(c), up(d)]),
                Mesh::Prisms => {
                    add("C3D6", &[a, b, c, up(a), up(b), up(c)]);
                    add("C3D6", &[a, c, d, up(a), up(c), up(d)]);
                }
                Mesh::Tetrahedra => {
                    for [p, q] in [[b, c], [c, d]] {
                        add("C3D4", &[a, p, q, up(q)]);
                        add("C3D4", &[a, p, up(q), up(p)]);
                        add("C3D4", &[a, up(p), up(q), up(a)]);
                    }
                }
                Mesh::Plates => {
                    let at = if base < 200 { 100 } else { 0 };
                    add("S4R", &[a + at, b + at, c + at, d + at]);
                }
                Mesh::None => {}
            }
        }
        text
    }

    fn read(&self) -> Result<FiniteElementCase, String> {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        let (mut deck, mut dofs, mut mass) = ("*NODE\n".to_owned(), String::new(), String::new());
        let mut row = 0;
        for (node, place) in Self::nodes() {
            let place = self.turned * place;
            writeln!(deck, "{node}, {:e}, {:e}, {:e}", place[0], place[1], place[2]).unwrap();
            for direction in 1..=3 {
                if !self.without.contains(&node) {
                    row += 1;
                    writeln!(dofs, "{node}.{direction}").unwrap();
                    writeln!(mass, "{row} {row} 1.0").unwrap();
                }
            }
        }
        // A node that the mesh does not have.
        writeln!(dofs, "999.1").unwrap();
        writeln!(mass, "{} {} 1.0", row + 1, row + 1).unwrap();
        let list = |nodes: &[i64]| nodes.iter().map(i64::to_string).collect::<Vec<_>>().join(", ");
        deck += &self.elements();
        let touching = |nodes: &[i64]| match self.mesh {
            // At corners of each brick that no edge joins.
            Mesh::Some => vec![nodes[0], nodes[3], nodes[4]],
            _ => nodes.to_vec(),
        };
        let (pad, disc) = (touching(&PAD), touching(&DISC));
        let first = pad.len() / 3;
        for (name, nodes) in [
            ("PADFACE", &pad[..]),
            ("DISCFACE", &disc),
            ("P1", &pad[..first]),
            ("P2", &pad[first..]),
            ("D1", &disc[..first]),
            ("D2", &disc[first..]),
            ("BACK", &[301, 302, 303]),
        ] {
            deck += &format!("*NSET, NSET={name}\n{}\n", list(nodes));
        }
        write("b.inp", &deck);
        write("b.dof", &dofs);
        write("b.mas", &mass);
        write("b.sti", &mass);
        let vector = |v: Vector3<f64>| format!("[{:?}, {:?}, {:?}]", v[0], v[1], v[2]);
        let (pad, disc, patches) = match self.exchanged {
            false => ("PadFace", "discface", "[\"P1\", \"P2\"]"),
            true => ("discface", "PadFace", "[\"D1\", \"D2\"]"),
        };
        let contact = format!(
            "[contact]\npad = \"{pad}\"\ndisc = \"{disc}\"\ntolerance = 1e-6\nnormal = {}\nsliding = {}\nstiffness = 1e6\nload = 10.0\n\
             patches = {patches}\nin_contact = [2]\nlateral = \"none\"\n",
            vector(self.normal),
            vector(self.turned * Vector3::new(1.0, 0.3, 0.2))
        );
        let laws = if self.contact { "laws = [\"amontons-coulomb\"]\n" } else { "" };
        let text = format!(
            "[study]\nname = \"made up\"\n{laws}samples = 1\nseed = 1\n[brake]\nkind = \"finite-elements\"\nmesh = \"b.inp\"\n\
             [[terms]]\nname = \"structure\"\nmass = \"b.mas\"\nstiffness = \"b.sti\"\n\
             [[holders]]\nname = \"back\"\nnodes = \"BACK\"\nstiffness = [1.0, 0.0, 1.0]\n\
             [[constraints]]\nname = \"rim\"\nfixed = [\"999.x\", \"BACK.y\"]\n{}{}\
             [reduction]\nfrequencies = [1.0, 2.0]\ngrowth = [-1.0, 1.0]\n",
            if self.contact { &contact } else { "" },
            self.friction
        );
        match CaseFile::parse(&folder.path().join("b.toml"), text).map_err(|error| error.to_string())? {
            CaseFile::FiniteElements(case) => Ok(*case),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_normal_to_the_wrong_side_is_refused_whatever_the_elements_are() {
    let mut random = Random(1);
    for at in 0..60 {
        let mesh = MESHES[at % MESHES.len()];
        let mut brake = Brake::new(mesh, &mut random);
        let right = brake.normal;
        let sides = brake.read().unwrap_or_else(|error| panic!("{mesh:?}: {error}")).sides.unwrap();
        let expected = match mesh {
            Mesh::Bricks => [Side::Faces(2); 2],
            Mesh::Prisms | Mesh::Tetrahedra => [Side::Faces(4); 2],
            // Of the disc five bricks meet the contact, most of them beside it.
            Mesh::Some => [Side::Elements(2), Side::Unknown],
            Mesh::Plates | Mesh::None => [Side::Unknown; 2],
        };
        assert_eq!(sides, expected, "{mesh:?}");
        let is_told = expected[0] != Side::Unknown;
        // Tilted by 45 degrees it still points into the pad.
        brake.normal = right + brake.turned * Vector3::new(random.angle().cos(), 0.0, 0.0);
        assert!(brake.read().is_ok(), "{mesh:?}");
        brake.normal = -right * 3.0;
        let found = brake.read();
        assert_eq!(found.is_err(), is_told, "{mesh:?}");
        if let Err(error) = found {
            let near = format!("{:.3}", right[0] + 0.0);
            assert!(error.contains("contact.normal = [") && error.contains(&near) && !error.contains('\n'), "{error}");
        }
        brake.normal = brake.turned * Vector3::new(-0.9, -0.8, -0.02);
        assert_eq!(brake.read().is_err(), matches!(mesh, Mesh::Bricks | Mesh::Prisms | Mesh::Tetrahedra), "{mesh:?}");
        (brake.normal, brake.exchanged) = (right, true);
        assert_eq!(brake.read().is_err(), is_told, "{mesh:?}");
        brake.normal = -right;
        assert!(brake.read().is_ok(), "{mesh:?}");
    }
}

#[test]
fn nodes_without_rows_are_counted_and_bodies_without_rows_refused() {
    let mut random = Random(2);
    let all: Vec<i64> = Brake::nodes().iter().map(|(node, _)| *node).collect();
    let body =
        |from: i64, to: i64| all.iter().copied().filter(|node| (from..to).contains(node)).collect::<BTreeSet<i64>>();
    let refused: [(BTreeSet<i64>, &str); 6] = [
        (
            all.iter().copied().collect(),
            "brake.mesh = a mesh of 36 nodes from 0 to 313, and no row of the matrices has a name of it",
        ),
        (body(200, 400), "holders \"back\".nodes = 3 nodes from 301 to 303, of which the matrices have no row"),
        (
            body(200, 300),
            "contact.pad = 6 nodes from 201 to 213, of which the matrices have no row; allowed: nodes with rows in the matrices, as 0.x",
        ),
        (body(0, 200), "contact.disc = 6 nodes from 101 to 113, of which the matrices have no row"),
        (PAD[..2].iter().copied().collect(), "contact.patches \"P1\" = 2 nodes from 201 to 211, of which"),
        (DISC[2..].iter().copied().collect(), "contact.patches \"P2\" = 4 nodes from 102 to 113, of which"),
    ];
    for (without, expected) in refused {
        let mut brake = Brake::new(Mesh::Bricks, &mut random);
        brake.without = without;
        let found = brake.read().unwrap_err();
        assert!(found.contains(expected) && !found.contains('\n'), "{found}");
    }
    let mut accepted = 0;
    for _ in 0..60 {
        let mut brake = Brake::new(Mesh::Bricks, &mut random);
        brake.without = all.iter().copied().filter(|_| random.below(5) == 0).collect();
        let count = |nodes: &[i64]| nodes.iter().filter(|node| brake.without.contains(node)).count();
        let is_left =
            [&PAD[..2], &PAD[2..], &DISC[..2], &DISC[2..], &[301, 302, 303]].iter().all(|all| count(all) < all.len());
        let found = brake.read();
        assert_eq!(found.is_ok(), is_left);
        let Ok(case) = found else { continue };
        accepted += 1;
        let expected = [
            ("holders \"back\".nodes", 3, count(&[301, 302, 303])),
            ("contact.pad", 6, count(&PAD)),
            ("contact.disc", 6, count(&DISC)),
            ("constraints \"rim\".fixed \"BACK.y\"", 3, count(&[301, 302, 303])),
        ];
        let expected: Vec<MissingRows> = expected
            .into_iter()
            .filter(|(.., without)| *without > 0)
            .map(|(field, nodes, without)| MissingRows { field: field.into(), nodes, without, partly: 0 })
            .collect();
        assert_eq!(case.missing_rows, expected);
        let names = case.names.unwrap();
        assert_eq!((names.nodes, names.with_rows, names.not_on_mesh), (36, 36 - brake.without.len(), 1));
        assert!(names.bodies_without.is_empty());
    }
    assert!(accepted > 10, "{accepted}");
}

#[test]
fn a_body_without_rows_that_no_field_names_is_told() {
    let mut brake = Brake::new(Mesh::Bricks, &mut Random(3));
    brake.contact = false;
    brake.friction = "";
    brake.without = (1..200).collect();
    assert_eq!(brake.read().unwrap().names.unwrap().bodies_without, Vec::<i64>::new());
    brake.without.insert(0);
    assert_eq!(brake.read().unwrap().names.unwrap().bodies_without, [0]);
}

#[test]
fn what_nothing_uses_is_refused() {
    let mut brake = Brake::new(Mesh::Bricks, &mut Random(4));
    brake.contact = false;
    assert!(brake.read().unwrap_err().contains("friction = given; allowed: cases with a contact"));
    brake.friction = "[[speeds]]\nname = \"slow\"\nfrom = 1.0\nto = 2.0\n";
    assert!(brake.read().unwrap_err().contains("speeds = given; allowed: cases with a contact"));
}
