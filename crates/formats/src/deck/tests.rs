use std::collections::BTreeSet;

use super::*;
use crate::mesh::CellKind;

fn deck(text: &str) -> Result<Deck, String> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    read_deck(file.path(), &Limits::default()).map_err(|error| error.to_string())
}

const BRICK: &str = "** a brick\n*HEADING\nanything, 1\n*Node, nset=All\n 1, 0, 0, 0\n2,1.,0,0\n3,1,1D0,0\n4,0,1\n5,0,0,1\n\
                     6,1,0,1\n7,1,1,1\n8,0,1,1\n*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1,2,3,4,\n5,6,7,8\n*NSET,NSET=Bottom,GENERATE\n\
                     1,4,1\n*nset, nset=two\nBOTTOM, 7\n7\n*ELEMENT, TYPE=MASS\n9, 1\n*STEP\n*FREQUENCY\n10\n";

#[test]
fn nodes_elements_and_sets_are_read_and_the_rest_is_passed_over() {
    let found = deck(BRICK).unwrap();
    assert_eq!(found.mesh.nodes.len(), 8);
    assert_eq!(found.mesh.nodes[2].position, [1.0, 1.0, 0.0]);
    assert_eq!(found.mesh.cells, [Cell { kind: CellKind::Hexahedron, nodes: (0..8).collect() }]);
    assert_eq!(found.sets["BOTTOM"], [1, 2, 3, 4]);
    assert_eq!(found.sets["TWO"], [1, 2, 3, 4, 7]);
    assert_eq!(found.sets["ALL"].len(), 8);
}

#[test]
fn what_a_boundary_holds_is_read_and_what_it_says_otherwise_passed_over() {
    let held = |lines: &str| {
        let found = deck(&BRICK.replace("*STEP", &format!("*BOUNDARY, OP=NEW\n{lines}\n*STEP"))).unwrap().held;
        found.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(held("two, 1, 3"), "1.x 1.y 1.z 2.x 2.y 2.z 3.x 3.y 3.z 4.x 4.y 4.z 7.x 7.y 7.z");
    assert_eq!(held("7, 2\n8, 3, 6, 0.\n1, encastre\n 2 , ZSYMM"), "1.x 1.y 1.z 2.z 7.y 8.z");
    assert_eq!(held("99, 1, 3\nnone, 1\n5, 4, 6\n6, 3, 1\n6\n6, 1.5\n6, TYPELESS\n,"), "");
    // In a step too, where CalculiX has it before *FREQUENCY.
    assert_eq!(deck(&format!("{BRICK}*BOUNDARY\n1, 3")).unwrap().held.len(), 1);
}

#[test]
fn quadratic_elements_have_the_surface_of_their_corners() {
    // Two bricks, one on the other. The nodes within edges, 101 to 132, are all at one place: only their number counts here.
    let mut text = "*NODE\n".to_owned();
    for layer in 0..3 {
        for (corner, [x, y]) in [[0, 0], [1, 0], [1, 1], [0, 1]].iter().enumerate() {
            text += &format!("{}, {x}, {y}, {layer}\n", 4 * layer + corner + 1);
        }
    }
    text += &(101..=132).map(|label| format!("{label}, 5, 5, 5\n")).collect::<String>();
    let within = |labels: std::ops::Range<i32>| labels.map(|label| format!(", {label}")).collect::<String>();
    text += "*ELEMENT, TYPE=C3D20R\n";
    text += &format!("1, 1,2,3,4,5,6,7,8{},\n{}\n", within(101..106), &within(106..113)[2..]);
    text += &format!("2, 5,6,7,8,9,10,11,12{},\n{}\n", within(105..110), &within(126..133)[2..]);
    let surface = crate::Surface::new(&deck(&text).unwrap().mesh);
    assert_eq!((surface.faces.len(), surface.nodes), (10, (0..12).collect()));
    let ten = format!("*ELEMENT, TYPE=C3D10\n3, 1,2,4,5{}\n", within(101..107));
    let text = format!("{}{ten}", &text[..text.find("*ELEMENT").unwrap()]);
    let surface = crate::Surface::new(&deck(&text).unwrap().mesh);
    assert_eq!((surface.faces.len(), surface.nodes), (4, vec![0, 1, 3, 4]));
}

#[test]
fn ranges_and_sets_of_any_size_take_no_more_than_the_nodes() {
    let nodes = "*NODE\n1, 0\n9223372036854775807, 1\n-9223372036854775808, 2\n";
    let range = "*NSET, NSET=R, GENERATE\n-9223372036854775808, 9223372036854775807, 3\n";
    assert_eq!(deck(&format!("{nodes}{range}")).unwrap().sets["R"], [i64::MIN, 1, i64::MAX]);
    // Each line would double the set.
    let again = "*NSET, NSET=A\nA, A\n".repeat(60);
    assert_eq!(deck(&format!("{nodes}*NSET, NSET=A\n1\n{again}")).unwrap().sets["A"], [1]);
}

#[test]
fn faults_are_named_with_their_line() {
    for (text, expected) in [
        ("1, 2\n", "line 1: line \"1, 2\" is not supported; allowed: a keyword such as *NODE"),
        ("*NODE\n1, 0, 0, 0\n1, 0, 0, 0\n", "line 3"),
        ("*NODE\n1, x, 0, 0\n", "line 2"),
        ("*NODE\n1, 0\n*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n", "line 4"),
        ("*NODE\n1, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1\n*STEP\n", "line 5"),
        ("*NODE\n1, 0\n*NSET, NSET=A\nB\n", "line 4"),
        ("*NODE\n1, 0\n*NSET, NSET=A, GENERATE\n1, 2, 0\n", "line 4"),
        ("*NODE\n1, 0, 0, 0, 0, 0, 0, 0\n", "line 2"),
        ("*NODE\n1, <x>\n", "line 2"),
        ("*NODE, NSET=<x>\n1, 0\n", "line 1"),
        (
            "*NODE, SYSTEM=S\n1, 0\n",
            "line 1: keyword \"*NODE, SYSTEM=S\" is not supported; allowed: SYSTEM=R or SYSTEM=C",
        ),
        ("*NODE, FILE=a\n1, 0\n", "line 1"),
        ("*NODE,\nSYSTEM=Q\n1, 0\n", "line 2"),
        ("*SYSTEM\n1, 0, 0\n*NODE, SYSTEM=C\n1, 0\n", "line 3"),
        ("*SYSTEM\n1, 0, 0, 1, 0, 0\n*NODE\n1, 0\n", "line 3"),
        ("*SYSTEM\n0, 0, 0, 1, 0, 0\n2, 0, 0\n*NODE\n1, 0\n", "line 4"),
        ("*NODE\n1, 0\n*ELEMENT, TYPE=MASS\n1, 1\n1, 1\n", "line 5"),
        ("*NODE\n1, 0\n*ELEMENT, TYPE=MASS\n1, 1, 1\n", "line 4"),
        ("*NODE\n1, 0\n*ELEMENT, ELSET=E\n1, 1\n", "line 3"),
        ("*NODE\n1, 0\n*NSET, NSET=A, INSTANCE=P-1\n1\n", "line 3"),
        ("*NODE\n1, 0\n*NSET, NSET=A\nP-1.B\n", "line 4: node set is P-1.B; allowed: a set that is defined above"),
        ("*NODE\n1, 0\n*NSET, NSET=A, ELSET=E\n", "line 3: element set is E; allowed: a set that is defined above"),
        ("*NODE\n1, 0\n*ELSET, ELSET=E\n7\n*NSET, NSET=A, ELSET=E\n", "line 5: element is 7"),
        ("*NODE\n1, 0\n*ELSET, ELSET=E\nF\n*NSET, NSET=A, ELSET=E\n", "line 5: element set is F"),
        (
            "*NODE\n1, 0\n*ELEMENT, TYPE=CONN3D2, ELSET=E\n5, , 1\n*NSET, NSET=A, ELSET=E\n",
            "line 5: element is 5 of type CONN3D2; allowed: elements of types whose nodes are known here",
        ),
        ("*NODE\n1, 0\n*NSET, NSET=12\n1\n", "line 3"),
        ("*NODE\n1, 0\n*INCLUDE\n", "line 3"),
        ("*NODE\n1, 0\n*INCLUDE, INPUT=none.inp\n", "in none.inp, which it includes: cannot be read"),
        ("*NODE\n1, 0\n*PART, NAME=P\n", "line 3"),
        ("*STEP\n", "line 1"),
    ] {
        let found = deck(text).unwrap_err();
        assert!(found.starts_with(expected), "{text:?}: {found}");
    }
}

/// Numbers that look random, the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }

    /// -1 to 1.
    fn number(&mut self) -> f64 {
        self.below(2_000_001) as f64 / 1e6 - 1.0
    }

    fn vector(&mut self) -> [f64; 3] {
        [0; 3].map(|_: i32| self.number())
    }
}

#[test]
fn every_keyword_that_changes_the_model_is_refused_and_every_other_passed_over() {
    let refused = [
        "PART",
        "END PART",
        "INSTANCE",
        "ASSEMBLY",
        "NGEN",
        "NFILL",
        "NCOPY",
        "NMAP",
        "ELGEN",
        "ELCOPY",
        "TRANSFORM",
        "ADJUST",
        "IMPERFECTION",
        "IMPORT",
        "IMPORT NSET",
        "SYMMETRIC MODEL GENERATION",
        "REFINE MESH",
        "RESTART, READ",
        "NOD",
        "ELEM",
        "TRANSF",
        "NODES",
        "NODE2",
        "MOVE NODES",
        "FOO",
    ];
    for keyword in refused {
        for text in
            [format!("*NODE\n1, 0\n*{keyword}\n1, 2\n"), format!("*NODE\n1, 0\n* {}, X=1\n", keyword.to_lowercase())]
        {
            let found = deck(&text).unwrap_err();
            assert!(found.starts_with("line 3: keyword \"*") && found.contains("; allowed: "), "{keyword}: {found}");
        }
    }
    let known =
        include_str!("harmless.txt").lines().chain(["RESTART, WRITE", "SOLID SEC", "BOUND", "STEP", "END STEP"]);
    for keyword in known {
        let text = format!("*NODE\n1, 2, 3, 4\n*{keyword}, X=1,\nY=2\n1, 2, 3\na, b\n*NSET, NSET=A\n1\n");
        assert_eq!(deck(&text).unwrap_or_else(|e| panic!("{keyword}: {e}")).sets["A"], [1]);
    }
    assert!(deck("*NODE\n1, 0\n*STEP\n*OF SOME OTHER PROGRAM\n1\n*END STEP\n").is_ok());
    assert!(deck("*NODE\n1, 0\n*STEP\n*END STEP\n*OF SOME OTHER PROGRAM\n").is_err());
}

#[test]
fn a_node_is_where_it_is_in_whatever_system_it_is_given() {
    let mut random = Random(1);
    for _ in 0..200 {
        let place = random.vector();
        let [x, y, z] = place;
        let turns = 360.0 * (random.below(5) as f64 - 2.0);
        let angle = y.atan2(x).to_degrees() + turns;
        let (a, b, c) = (random.vector(), random.vector(), random.vector());
        // The local coordinates by solving with the axes, the third first: z along (b - a) x (c - a).
        let m = |p: [f64; 3]| nalgebra::Vector3::from(p);
        let (u, v) = (m(b) - m(a), m(c) - m(a));
        if u.cross(&v).norm() < 0.05 || u.xy().norm() < 0.05 {
            continue;
        }
        let axes = nalgebra::Matrix3::from_columns(&[
            u.normalize(),
            u.cross(&v).cross(&u).normalize(),
            u.cross(&v).normalize(),
        ]);
        let local = axes.lu().solve(&(m(place) - m(a))).unwrap();
        let turned = f64::atan2(u[1], u[0]);
        let about_z = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), -turned) * (m(place) - m(a));
        let moved = m(place) - m(a);
        let line = |p: [f64; 3]| format!("{:e}, {:e}, {:e}", p[0], p[1], p[2]);
        let triple = |p: nalgebra::Vector3<f64>| line(p.into());
        let texts = [
            format!("*NODE\n1, {}\n", line(place)),
            format!("*NODE, SYSTEM=R\n1, {}\n", line(place)),
            format!("*NODE, NSET=A,\n system = c\n1, {:e}, {angle:e}, {z:e}\n", x.hypot(y)),
            format!("*SYSTEM\n{}, {}\n{}\n*NODE\n1, {}\n", line(a), line(b), line(c), triple(local)),
            format!("*SYSTEM\n{}, {},\n{},\n*NODE,system=R\n1, {}\n", line(a), line(b), line(c), triple(local)),
            format!("*SYSTEM\n{}, {}\n*NODE\n1, {}\n", line(a), line(b), triple(about_z)),
            format!("*SYSTEM\n{}\n*NODE\n1, {}\n", line(a), triple(moved)),
            format!("*SYSTEM\n{}, {}\n*SYSTEM\n*NODE\n1, {}\n", line(a), line(b), line(place)),
        ];
        for text in texts {
            let found = deck(&text).unwrap().mesh.nodes[0].position;
            let is_near = found.iter().zip(place).all(|(a, b)| (a - b).abs() < 1e-11);
            assert!(is_near, "{text}: {found:?}, not {place:?}");
        }
    }
}

#[test]
fn missing_coordinates_are_zero_where_they_are_missing() {
    let found = deck("*NODE\n1, , 5.\n2, 1.,, 3.\n3\n4,,,\n").unwrap().mesh.nodes;
    let positions: Vec<[f64; 3]> = found.iter().map(|node| node.position).collect();
    assert_eq!(positions, [[0.0, 5.0, 0.0], [1.0, 0.0, 3.0], [0.0; 3], [0.0; 3]]);
}

#[test]
fn sets_of_any_make_have_the_members_that_they_should() {
    /// Members by name in capitals.
    type Sets = BTreeMap<String, BTreeSet<i64>>;
    for seed in 0..200 {
        let mut random = Random(seed);
        let nodes = 10 + random.below(30) as i64;
        let mut text = "*NODE\n".to_owned() + &(1..=nodes).map(|n| format!("{n}, {n}., 0, 0\n")).collect::<String>();
        let (mut node_sets, mut element_sets) = (Sets::new(), Sets::new());
        let mut elements: BTreeMap<i64, Vec<i64>> = BTreeMap::new();
        let cased = |random: &mut Random, name: &str| match random.below(3) {
            0 => name.to_owned(),
            1 => name.to_lowercase(),
            _ => format!(" {} {} ", &name[..1], &name[1..]),
        };
        for _ in 0..20 {
            let name = ["AB", "BC", "CD", "DE"][random.below(4) as usize];
            let written = cased(&mut random, name);
            let of_elements = random.below(2) == 0;
            let (sets, word, most) = match of_elements {
                true => (&mut element_sets, "ELSET", 100),
                false => (&mut node_sets, "NSET", nodes as u64),
            };
            let members: BTreeSet<i64> = match random.below(5) {
                0 => {
                    // Elements of two or three nodes in lines that go on.
                    let corners = 2 + random.below(2) as usize;
                    let of_type = ["T3D2", "B32"][corners - 2];
                    text += &format!("*ELEMENT, TYPE={of_type}, ELSET={written}\n");
                    let mut own = BTreeSet::new();
                    for _ in 0..3 {
                        let element = 1 + random.below(100) as i64;
                        if elements.contains_key(&element) {
                            continue;
                        }
                        let of: Vec<i64> = (0..corners).map(|_| 1 + random.below(nodes as u64) as i64).collect();
                        text += &format!(
                            "{element}, {},\n  {}\n",
                            of[0],
                            of[1..].iter().map(i64::to_string).collect::<Vec<_>>().join(", ")
                        );
                        elements.insert(element, of);
                        own.insert(element);
                    }
                    if !own.is_empty() {
                        element_sets.entry(name.to_owned()).or_default().extend(own);
                    }
                    continue;
                }
                1 => {
                    let (first, step) = (1 + random.below(most) as i64, 1 + random.below(4) as i64);
                    let last = first + random.below(most) as i64;
                    text += &format!("*{word}, {word}={written}, GENERATE\n{first}, {last}, {step}\n");
                    let all: BTreeSet<i64> = (first..=last).step_by(step as usize).collect();
                    match of_elements {
                        true => all.into_iter().filter(|element| elements.contains_key(element)).collect(),
                        false => all.into_iter().filter(|node| (1..=nodes).contains(node)).collect(),
                    }
                }
                2 if !sets.is_empty() => {
                    let others: Vec<String> = sets.keys().cloned().collect();
                    let other = &others[random.below(others.len() as u64) as usize];
                    text += &format!("*{word}, UNSORTED,\n{word}={written}\n{},\n", cased(&mut random, other));
                    sets[other].clone()
                }
                3 if !element_sets.is_empty() => {
                    let others: Vec<String> = element_sets.keys().cloned().collect();
                    let other = &others[random.below(others.len() as u64) as usize];
                    text += &format!("*NSET, NSET={written}, ELSET={}\n", cased(&mut random, other));
                    let own = element_sets[other].iter().flat_map(|element| elements[element].clone());
                    node_sets.entry(name.to_owned()).or_default().extend(own);
                    continue;
                }
                _ if of_elements => elements.keys().copied().filter(|element| element % 3 == 0).collect(),
                _ => (0..5).map(|_| 1 + random.below(nodes as u64) as i64).collect(),
            };
            if !text.ends_with('\n') || members.is_empty() {
                continue;
            }
            // Once more as a list, which changes nothing where it was a range or a set.
            let list = members.iter().map(i64::to_string).collect::<Vec<_>>().join(", ");
            text += &format!("*{word}, {word}={written}\n{list}\n");
            let sets = if of_elements { &mut element_sets } else { &mut node_sets };
            sets.entry(name.to_owned()).or_default().extend(members);
        }
        let found = deck(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let expected: BTreeMap<String, Vec<i64>> =
            node_sets.into_iter().map(|(name, all)| (name, all.into_iter().collect())).collect();
        let found: BTreeMap<String, Vec<i64>> = found.sets.into_iter().filter(|(_, all)| !all.is_empty()).collect();
        assert_eq!(found, expected, "{text}");
    }
}

#[test]
fn names_in_quotes_keep_their_case_and_commas() {
    let text = "*NODE, NSET=\"Pad, left\"\n1, 0\n*NSET, NSET=pad\n\"Pad, left\"\n*NSET, NSET=\"pad\"\nPAD\n";
    assert_eq!(deck(text).unwrap().sets.keys().collect::<Vec<_>>(), ["PAD", "Pad, left", "pad"]);
}

#[test]
fn included_files_stand_in_the_place_of_the_line_that_includes_them() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let read = || read_deck(&folder.path().join("a.inp"), &Limits::default()).map_err(|error| error.to_string());
    write(
        "a.inp",
        "*NODE, NSET=N\n1, 0\n*INCLUDE, INPUT=\"b b.inp\"\n3, 2\n*ELEMENT, TYPE=T3D2, INPUT=c.txt, ELSET=E\n*NSET, NSET=A, ELSET=E\n",
    );
    write("b b.inp", "2, 1\n");
    write("c.txt", "** elements\n1, 1, 3\n");
    let found = read().unwrap();
    assert_eq!((&found.sets["N"][..], &found.sets["A"][..]), (&[1, 2, 3][..], &[1, 3][..]));
    write("c.txt", "1, 1, 4\n");
    assert_eq!(
        read().unwrap_err(),
        "in c.txt, which it includes: line 1: node is 4; allowed: a node that is defined above"
    );
    write("c.txt", "*INCLUDE, INPUT=c.txt\n");
    assert!(read().unwrap_err().contains("10 deep at most"));
}

#[test]
fn solids_keep_their_nodes_and_surfaces_their_lines() {
    let text = BRICK.replace(
        "*NSET,NSET=Bottom",
        "*Surface, name=Top, type=element\nE, s2\n1,S1\n*SURFACE, TYPE=NODE, NAME=n\n7,\n \
        all\n*SURFACE, NAME=cut, COMBINE=UNION\nTOP, N\n*SURFACE INTERACTION, NAME=I\n1, 2\n*NSET,NSET=Bottom",
    );
    let found = deck(&text).unwrap();
    let nodes = (1..=8).collect();
    assert_eq!(found.solids, [Solid { label: 1, of_type: "C3D8".into(), nodes }]);
    assert_eq!(found.element_sets["E"], [1]);
    let line = |what: &str, face: &str| (what.to_owned(), face.to_owned());
    let top = SurfaceSet { lines: vec![line("E", "S2"), line("1", "S1")], ..SurfaceSet::default() };
    assert_eq!(found.surfaces["TOP"], top);
    let of_nodes = SurfaceSet { of_nodes: true, lines: vec![line("7", ""), line("ALL", "")], unread: Vec::new() };
    assert_eq!(found.surfaces["N"], of_nodes);
    assert_eq!(found.surfaces["CUT"].unread, ["COMBINE"]);
    assert_eq!(found.surfaces.len(), 3);
    assert_eq!(found.sets["BOTTOM"], [1, 2, 3, 4]);
}
