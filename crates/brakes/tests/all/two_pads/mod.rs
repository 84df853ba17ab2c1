//! A brake of two pads whose faces do not match the disc's, which turns: as a case file alone, against SciPy.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use brakes::case::{CaseFile, FiniteElementCase};
use elements::nalgebra::DVector;
use elements::{Body, Kind, Material, Mesh, Rows};
use linsys::OperatingPoint;
use num_complex::Complex;
use sparse::nalgebra_sparse::CscMatrix;
use sparse::{Options, Rectangle, eigenpairs_in};

mod equilibrium;
mod faults;
mod openings;

fn parse(path: &Path, text: String) -> Result<FiniteElementCase, String> {
    match CaseFile::parse(path, text).map_err(|error| error.to_string())? {
        CaseFile::FiniteElements(case) => Ok(*case),
        _ => Err("another kind".into()),
    }
}

/// A folder with the small brake of `contact`: its deck, and matrices that `elements` makes of it; and what numpy makes of contact and rotation.
struct Folder {
    folder: tempfile::TempDir,
    /// M and K of the structure.
    matrices: [CscMatrix<f64>; 2],
    /// Rows of products with the probe.
    products: BTreeMap<String, Vec<(usize, f64)>>,
}

impl Folder {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut nodes: Vec<(i64, [f64; 3])> = Vec::new();
        let mut solids: Vec<(i64, Kind, Vec<i64>)> = Vec::new();
        let mut bodies: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        let mut products: BTreeMap<String, Vec<(usize, f64)>> = BTreeMap::new();
        let (mut deck, mut body, mut last) = ("*NODE\n".to_owned(), String::new(), String::new());
        for line in include_str!("../../../../contact/tests/two_pads/two_pads.txt").lines() {
            let words: Vec<&str> = line.split(' ').collect();
            let real = |at: usize| words[at].parse::<f64>().unwrap();
            match words[0] {
                "node" => {
                    nodes.push((words[1].parse().unwrap(), [real(2), real(3), real(4)]));
                    writeln!(deck, "{}", words[1..].join(", ")).unwrap();
                }
                "element" => {
                    if body != words[2] {
                        body = words[2].to_owned();
                        writeln!(deck, "*ELEMENT, TYPE=C3D20R, ELSET={body}").unwrap();
                    }
                    bodies.entry(body.clone()).or_default().push(solids.len());
                    let own: Vec<i64> = words[3..].iter().map(|word| word.parse().unwrap()).collect();
                    let numbers: Vec<String> = own.iter().map(i64::to_string).collect();
                    writeln!(deck, "{}, {},\n{}", words[1], numbers[..10].join(", "), numbers[10..].join(", "))
                        .unwrap();
                    solids.push((words[1].parse().unwrap(), Kind::Hexahedron20, own));
                }
                "area" => {}
                "matrix" => last = words[1].to_owned(),
                row => products.entry(last.clone()).or_default().push((row.parse().unwrap(), real(1))),
            }
        }
        for (name, z, x) in [("OUTER", 11.0, 2), ("INNER", -35.0, 2), ("TOP", 0.0, 2)] {
            writeln!(deck, "*NSET, NSET={name}").unwrap();
            nodes.iter().filter(|(_, p)| p[x] == z).for_each(|(label, _)| writeln!(deck, "{label}").unwrap());
        }
        let rim = nodes.iter().filter(|(_, p)| p[0].hypot(p[1]) < 81.0);
        writeln!(deck, "*NSET, NSET=HUB").unwrap();
        rim.for_each(|(label, _)| writeln!(deck, "{label}").unwrap());
        // The face of the inner pad at the disc is S2 of its elements, that of the outer one S1.
        writeln!(deck, "*SURFACE, NAME=LINING\nOUT, S1\n*SURFACE, NAME=UNION, COMBINE=UNION\nLINING").unwrap();
        std::fs::write(folder.path().join("brake.inp"), deck).unwrap();
        let mesh = Mesh::new(nodes, solids).unwrap();
        let rows = Rows::all(&mesh);
        let body = Body::new(&mesh, mesh.all(), &rows).unwrap();
        let material = Material::new(1.0e5, 0.3).unwrap();
        let matrices = [body.mass(7.2e-9).unwrap(), body.stiffness(&material).unwrap()];
        for (name, matrix) in ["mass.mtx", "stiffness.mtx"].iter().zip(&matrices) {
            let mut text = String::new();
            for (i, j, value) in matrix.triplet_iter() {
                let named = |row: usize| format!("{}, {}", mesh.labels()[row / 3], row % 3 + 1);
                writeln!(text, "{}, {}, {value:e}", named(i), named(j)).unwrap();
            }
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        Self { folder, matrices, products }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("brake.toml")
    }

    fn parse(&self, text: String) -> Result<FiniteElementCase, String> {
        parse(&self.path(), text)
    }

    /// A matrix of the fixture times the probe.
    fn product(&self, name: &str, rows: usize) -> DVector<f64> {
        let mut product = DVector::zeros(rows);
        self.products[name].iter().for_each(|&(row, value)| product[row] = value);
        product
    }
}

/// A case with both contacts, in mm, t and s.
const CASE: &str = r#"
[study]
name = "Two pads"
laws = ["amontons-coulomb"]
samples = 10
seed = 1
[brake]
kind = "finite-elements"
mesh = "brake.inp"
[[terms]]
name = "structure"
mass = "mass.mtx"
stiffness = "stiffness.mtx"
symmetry = "whole"
[[rotation]]
name = "disc"
elements = "DISC"
density = 7.2e-9
axis = [0.0, 0.0, 3.0]
speed = "Omega"
[[springs]]
name = "hub x"
nodes = "HUB"
direction = [1.0, 0.0, 0.0]
stiffness = 1e5
[[contact]]
name = "outer"
slave = "LINING"
master = "TOP"
reach = 0.5
sliding = { axis = [0.0, 0.0, 1.0] }
stiffness = { per_area = 110.0 }
load = { pressure = 1.0 }
[[contact]]
name = "inner"
slave = "IN"
master = "DISC"
reach = 0.5
sliding = { axis = [0.0, 0.0, 1.0] }
stiffness = { per_area = 110.0 }
load = { pressure = 1.0 }
[all_contacts]
speed = "Omega"
load_factor = "p"
[friction.mu]
distribution = "constant"
value = 0.45
[parameters.Omega]
distribution = "constant"
value = 5.0
[parameters.p]
distribution = "uniform"
from = 1.0
to = 3.0
[reduction]
frequencies = [1000.0, 8000.0]
growth = [-500.0, 4000.0]
"#;

#[test]
fn a_case_file_is_the_matrices_of_numpy() {
    let folder = Folder::new();
    let case = folder.parse(CASE.into()).unwrap();
    let contact = case.contact.as_ref().unwrap();
    assert_eq!(contact.patches.iter().map(|patch| patch.name.as_str()).collect::<Vec<_>>(), ["outer", "inner"]);
    assert_eq!(case.system.channels().len(), 2 * 2 * 6 * 9);
    let system = case.system.assemble(&brakes::at_medians(&case).unwrap()).unwrap();
    let order = system.order();
    let probe = DVector::from_fn(order, |i, _| (1.0 + 0.37 * i as f64).sin());
    let [mass, stiffness] = &folder.matrices;
    let of = |name: &str| folder.product(name, order);
    let close = |found: DVector<f64>, expected: DVector<f64>, what: &str| {
        let distance = (&found - &expected).amax() / expected.amax();
        println!("{what}: {distance:.1e}");
        assert!(distance < 1e-10, "{what}: {distance:e}");
    };
    close(&system.m * &probe, mass * &probe, "M");
    // The spring of the hub: shared by its nodes, in x.
    let hub = &case.node_sets["HUB"];
    let mut held = DVector::zeros(order);
    for (row, dof) in case.dofs.iter().enumerate() {
        if dof.direction == 1 && hub.contains(&dof.node) {
            held[row] = 1e5 / hub.len() as f64 * probe[row];
        }
    }
    let expected = stiffness * &probe + held + of("normal") + of("friction") * 0.45 - of("centripetal") * 25.0;
    close(&system.k * &probe, expected, "K");
    // Twice the pressure of 1 by the median of p, as numpy has it; 2 Omega G.
    close(&system.c * &probe, of("lateral") * 0.45 + of("gyroscopic") * 10.0, "C");
}

/// Rough faces: where the pressure is the same everywhere, `k_t = m c^(1/m) p^(1 - 1/m)` follows it, and so does what friction reads.
#[test]
fn pressure_stiffens_rough_faces() {
    let folder = Folder::new();
    let rough = CASE.replace("stiffness = { per_area = 110.0 }", "stiffness = { c = 6e3, m = 2.5 }");
    let at = |text: &str, p: &str| {
        let text = text.replace("from = 1.0\nto = 3.0", &format!("from = {p}\nto = {p}"));
        let text = text.replace("distribution = \"uniform\"\nfrom = ", "distribution = \"constant\"\nvalue = ");
        let case = folder.parse(text.replace(&format!("to = {p}\n"), "")).unwrap();
        case.system.assemble(&brakes::at_medians(&case).unwrap()).unwrap()
    };
    for p in ["1.0", "2.0"] {
        let pressure: f64 = p.parse().unwrap();
        let per_area = 2.5 * 6e3_f64.powf(0.4) * pressure.powf(0.6);
        let even = CASE.replace("per_area = 110.0", &format!("per_area = {per_area:e}"));
        let (found, expected) = (at(&rough, p), at(&even, p));
        let largest = expected.k.values().iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let difference = &found.k - &expected.k;
        assert!(difference.values().iter().all(|value| value.abs() < 1e-13 * largest), "{p}");
        let damping = &found.c - &expected.c;
        assert!(damping.values().iter().all(|value| value.abs() < 1e-13), "{p}");
    }
    let mixed = rough.replacen("m = 2.5", "m = 2.0", 1);
    let error = folder.parse(mixed).unwrap_err();
    assert!(error.contains("all_contacts.load_factor = given; allowed: contacts of one law"), "{error}");
}

/// Pressed by fluid on both backs, held along and across the sliding by springs, and along the axis by the contact alone.
fn in_equilibrium() -> String {
    let springs: String = [("out", "OUTER"), ("in", "INNER")]
        .iter()
        .flat_map(|(pad, set)| {
            [("x", "[1.0, 0.0, 0.0]"), ("y", "[0.0, 1.0, 0.0]")].map(|(x, direction)| {
                format!(
                    "[[springs]]\nname = \"{pad} {x}\"\nnodes = \"{set}\"\ndirection = {direction}\nstiffness = 6e4\n"
                )
            })
        })
        .collect();
    let forces: String = [("OUTER", 1.5), ("INNER", 1.2)]
        .iter()
        .map(|(set, p)| format!("[[forces]]\nname = \"{set}\"\nfaces = \"{set}\"\npressure = {p}\n"))
        .collect();
    let held = "[[springs]]\nname = \"hub y\"\nnodes = \"HUB\"\ndirection = [0.0, 1.0, 0.0]\nstiffness = 1e5\n[[springs]]\n\
                name = \"hub z\"\nnodes = \"HUB\"\ndirection = [0.0, 0.0, 1.0]\nstiffness = 1e5\n";
    CASE.replace("load = { pressure = 1.0 }", "load = \"equilibrium\"")
        .replace("[all_contacts]", &format!("{springs}{forces}{held}[all_contacts]"))
}

#[test]
fn pressures_of_a_file_and_springs_between_sets() {
    let folder = Folder::new();
    let with_file = CASE.replacen("load = { pressure = 1.0 }", "load = { pressures = \"p.csv\" }", 1);
    // A pressure that grows along y, at the nodes of the outer lining.
    let case = folder.parse(CASE.into()).unwrap();
    let mesh = case.mesh.as_ref().unwrap();
    let on_face = |label: i64| (1001..2001).contains(&label);
    let lines: String = mesh
        .nodes
        .iter()
        .filter(|node| on_face(node.label) && node.position[2] == 0.0)
        .map(|node| format!("{}, {:e}\n", node.label, node.position[1]))
        .collect();
    std::fs::write(folder.folder.path().join("p.csv"), format!("node, pressure\n{lines}")).unwrap();
    let case = folder.parse(with_file.clone()).unwrap();
    let patch = &case.contact.as_ref().unwrap().patches[0];
    let total: f64 = patch.shares.iter().map(|share| share * patch.load).sum();
    let area = 2.2674787254376315e+03 + 2.8016067404148216e+03;
    assert!(total / area > 106.0 && total / area < 147.0, "{}", total / area);
    // Two steps of a report, one after the other.
    std::fs::write(folder.folder.path().join("p.csv"), format!("{lines}{lines}")).unwrap();
    let error = folder.parse(with_file.clone()).unwrap_err();
    assert!(error.contains("has a pressure twice: a file may hold several steps"), "{error}");
    std::fs::write(folder.folder.path().join("p.csv"), "3, 1.0\n").unwrap();
    let error = folder.parse(with_file).unwrap_err();
    assert!(error.contains("there is a pressure of node 3, which the slave lacks"), "{error}");

    // A column of fluid on the back: the mean by area of a motion that is linear along y is that at the middle of the area.
    let fluid = "[[springs]]\nname = \"fluid\"\nnodes = \"OUTER\"\nacts = \"area\"\ndirection = [0.0, 0.0, 1.0]\nstiffness = 1e3\n\
                 [all_contacts]";
    let with_fluid = folder.parse(CASE.replace("[all_contacts]", fluid)).unwrap();
    let k = |case: &FiniteElementCase| case.system.assemble(&brakes::at_medians(case).unwrap()).unwrap().k;
    let added = k(&with_fluid) - k(&folder.parse(CASE.into()).unwrap());
    let along_y = DVector::from_iterator(
        added.nrows(),
        mesh.nodes.iter().flat_map(|node| [0.0, 0.0, if node.label > 1000 { node.position[1] } else { 0.0 }]),
    );
    // A sector of 106 to 147 mm and 56 degrees about y: quadratic edges depart from its arcs by a few 1e-5.
    let (half, cubes, squares) =
        (28.0_f64.to_radians(), 147.0_f64.powi(3) - 106.0_f64.powi(3), 147.0_f64.powi(2) - 106.0_f64.powi(2));
    let middle = 2.0 / 3.0 * cubes / squares * half.sin() / half;
    let mean = (along_y.dot(&(&added * &along_y)) / 1e3).sqrt();
    assert!((mean / middle - 1.0).abs() < 1e-3, "{mean} {middle}");
    // One motion alone: rank one.
    let force = &added * &along_y;
    let other = &added * &force;
    assert!((other.normalize() - force.normalize()).amax() < 1e-6);

    // A shim between the backs: K of the means, and its dashpot.
    let shim = "[[springs]]\nname = \"shim\"\nnodes = \"OUTER\"\nto = \"INNER\"\ndirection = [0.0, 3.0, 4.0]\nstiffness = 50.0\n\
                damping = 0.5\ncoefficient = \"2*p\"\n[all_contacts]";
    let with_shim = folder.parse(CASE.replace("[all_contacts]", shim)).unwrap();
    let of = |case: &FiniteElementCase| case.system.assemble(&brakes::at_medians(case).unwrap()).unwrap();
    let (before, after) = (of(&folder.parse(CASE.into()).unwrap()), of(&with_shim));
    let moved = DVector::from_iterator(
        after.order(),
        with_shim.dofs.iter().map(|dof| if (1001..2001).contains(&dof.node) && dof.direction == 3 { 1.0 } else { 0.0 }),
    );
    let added = |after: &CscMatrix<f64>, before: &CscMatrix<f64>| moved.dot(&((after - before) * &moved));
    assert!((added(&after.k, &before.k) - 4.0 * 50.0 * 0.64).abs() < 1e-6);
    assert!((added(&after.c, &before.c) - 4.0 * 0.5 * 0.64).abs() < 1e-9);
}

#[test]
fn loss_factors_are_complex_stiffness_or_dashpots_at_a_frequency_and_stress_stiffens() {
    let folder = Folder::new();
    let of = |text: String| {
        let case = folder.parse(text).unwrap();
        case.system.assemble(&brakes::at_medians(&case).unwrap()).unwrap()
    };
    let before = of(CASE.into());
    let with_loss =
        CASE.replace("symmetry = \"whole\"", "symmetry = \"whole\"\nloss_factor = { value = 0.05, at_hz = 3000.0 }");
    // At 3 kHz i omega C is i eta K.
    let added = of(with_loss.clone()).c - &before.c - &folder.matrices[1] * (0.05 / (TAU * 3000.0));
    let largest = before.c.values().iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    assert!(added.values().iter().all(|value| value.abs() < 1e-12 * largest.max(1.0)));
    // Of the band, 1 to 8 kHz, dashpots lose less and more at the ends, which is said.
    let said = folder.parse(with_loss).unwrap().header.notes;
    let words = "= 0.05 is that of dashpots at 3000.0 Hz: at the ends of the band their loss factor is 0.333 and 2.667 times that";
    assert!(said.iter().any(|note| note.contains(words)), "{said:?}");
    // A number is a complex stiffness, of this term alone.
    let damped = of(CASE.replace("symmetry = \"whole\"", "symmetry = \"whole\"\nloss_factor = 0.05"));
    let off = damped.h.unwrap() - &folder.matrices[1] * 0.05;
    let largest = folder.matrices[1].values().iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    assert!(off.values().iter().all(|value| value.abs() < 1e-13 * largest));
    assert!(damped.c == before.c && before.h.is_none());

    // The rim is pulled outwards: around it the stress is about rho Omega^2 r^2, so that bending the disc out of its plane takes more.
    let held = "axis = [0.0, 0.0, 3.0]\nstress = { young = 1.0e5, poisson = 0.3 }";
    let stressed = of(CASE.replace("axis = [0.0, 0.0, 3.0]", held));
    let case = folder.parse(CASE.into()).unwrap();
    let mesh = case.mesh.as_ref().unwrap();
    let bent = DVector::from_iterator(
        before.order(),
        mesh.nodes.iter().flat_map(|node| {
            let [x, y, _] = node.position;
            [0.0, 0.0, if node.label < 1000 { (2.0 * y.atan2(x)).cos() } else { 0.0 }]
        }),
    );
    let work = bent.dot(&((&stressed.k - &before.k) * &bent));
    // `int sigma (w_,theta / r)^2` with sigma = rho Omega^2 r^2, and w_,theta^2 = 4 sin^2: 2 rho Omega^2 V, a ring's.
    let volume = std::f64::consts::PI * (150.0_f64.powi(2) - 80.0_f64.powi(2)) * 24.0;
    let ring = 2.0 * 7.2e-9 * 25.0 * volume;
    println!("{work:e}, as of a ring {ring:e}");
    assert!(work > 0.7 * ring && work < 1.3 * ring, "{work:e} {ring:e}");
}

/// The large brake of a folder, `brake.toml` in it, and `reference.txt` with lines `Re Im` of all eigenvalues from 1 to 8 kHz by SciPy.
#[test]
#[ignore = "needs a folder with a brake of 5,000 degrees of freedom, named by SQUEAL_TWO_PADS"]
fn a_large_brake_has_the_eigenvalues_of_scipy() {
    let folder = std::env::var("SQUEAL_TWO_PADS").unwrap();
    let path = Path::new(&folder).join("brake.toml");
    let case = parse(&path, std::fs::read_to_string(&path).unwrap()).unwrap();
    case.header.notes.iter().for_each(|note| println!("{note}"));
    let contact = case.contact.as_ref().unwrap();
    println!("{} channels in {} patches", case.system.channels().len(), contact.patches.len());
    let (_, still) = brakes::frictionless(&case, &[]).unwrap();
    println!("{} degrees of freedom", still.order());
    let at: OperatingPoint = brakes::at_medians(&case).unwrap();
    let system = case.system.assemble(&at).unwrap();
    let rectangle = Rectangle { re: [-500.0, 4000.0], im: [TAU * 1e3, TAU * 8e3] };
    let found = eigenpairs_in(&system, &rectangle, &Options::default(), &mut |_| ()).unwrap();
    let text = std::fs::read_to_string(Path::new(&folder).join("reference.txt")).unwrap();
    let expected = text.lines().map(|line| {
        let mut numbers = line.split_whitespace().map(|word| word.parse::<f64>().unwrap());
        Complex::new(numbers.next().unwrap(), numbers.next().unwrap())
    });
    for expected in expected {
        let nearest = found.pairs.iter().map(|pair| (pair.lambda - expected).norm()).fold(f64::INFINITY, f64::min);
        println!("{expected:.6}: off by {:.1e}", nearest / expected.norm());
        assert!(nearest < 1e-6 * expected.norm());
    }
}
