//! Files that are written, read again: by pyuff and meshio where Python has them, and against files of other programs.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;
use std::process::Command;

use formats::num_complex::Complex;
use formats::{Cell, CellKind, Dof, Mesh, MeshField, ModeShape, Node, write_fields_vtu, write_unv, write_vtu};

/// A cube with one cell of each kind, and two modes on it.
fn example() -> (Mesh, Vec<ModeShape>) {
    let corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)];
    let nodes: Vec<Node> = (0_i64..)
        .zip(corners)
        .map(|(n, (x, y, z))| Node { label: 10 * n + 3, position: [f64::from(x) / 3.0, f64::from(y), -f64::from(z)] })
        .collect();
    let cell = |kind, nodes: &[usize]| Cell { kind, nodes: nodes.to_vec() };
    let cells = vec![
        cell(CellKind::Hexahedron, &[0, 1, 2, 3, 4, 5, 6, 7]),
        cell(CellKind::Tetrahedron, &[0, 1, 2, 5]),
        cell(CellKind::Quadrilateral, &[0, 1, 2, 3]),
        cell(CellKind::Triangle, &[4, 5, 6]),
        cell(CellKind::Line, &[0, 6]),
        cell(CellKind::Vertex, &[7]),
    ];
    let mesh = Mesh { nodes, cells };
    let labels: Vec<Dof> =
        mesh.nodes.iter().flat_map(|n| [1, 3, 5].map(|direction| Dof { node: n.label, direction })).collect();
    let phi = |k: f64| (0..labels.len()).map(|i| Complex::new((k * i as f64).cos(), -0.25 * i as f64 / k)).collect();
    let shape = |name: &str, lambda, k| {
        let phi: Vec<_> = phi(k);
        ModeShape::new(name, lambda, &mesh, &labels, &phi).unwrap()
    };
    let modes = vec![
        shape("mode 1", Complex::new(-12.5, 6283.0), 1.3),
        shape("a < b & \"c\"", Complex::new(3.0, 12566.0), 0.7),
    ];
    (mesh, modes)
}

/// Runs a script where Python has the module it needs; else says so and counts as passed.
fn python(module: &str, script: &str, arguments: &[&Path]) {
    let has = |module: &str| {
        Command::new("python3").args(["-c", &format!("import {module}")]).output().is_ok_and(|o| o.status.success())
    };
    if !has(module) {
        println!("SKIPPED: python3 has no module {module}; install it with pip to run this round trip");
        return;
    }
    let output = Command::new("python3").arg("-c").arg(script).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    print!("{}", String::from_utf8_lossy(&output.stdout));
}

/// Fields have a number or a vector for each node; others are refused.
#[test]
fn fields_are_written_with_all_digits() {
    let (mesh, _) = example();
    let count = mesh.nodes.len();
    let third: Vec<f64> = (0..count).map(|at| at as f64 / 3.0).collect();
    let named = |name: &str, values: Vec<Vec<f64>>| MeshField { name: name.into(), values };
    let field = |values| named("a < b", values);
    let mut text = Vec::new();
    let vectors = vec![third.clone(), vec![0.0; count], vec![-1.0; count]];
    let fields = [field(vec![third.clone()]), named("vectors", vectors)];
    write_fields_vtu(&mut text, &mesh, &fields).unwrap();
    let text = String::from_utf8(text).unwrap();
    let array = |head: &str| {
        let (_, after) = text.split_once(head).unwrap();
        let (rows, _) = after.split_once("</DataArray>").unwrap();
        let words = rows.lines().skip(1).flat_map(|line| line.split(' ').map(|word| word.parse::<f64>().unwrap()));
        words.collect::<Vec<f64>>()
    };
    assert_eq!(array("Name=\"a &lt; b\" format"), third);
    let vectors = array("Name=\"vectors\" NumberOfComponents=\"3\"");
    assert_eq!(vectors, third.iter().flat_map(|&x| [x, 0.0, -1.0]).collect::<Vec<_>>());
    for wrong in [vec![third[1..].to_vec()], vec![third.clone(); 2], vec![vec![f64::NAN; count]], vec![]] {
        let error = write_fields_vtu(&mut Vec::new(), &mesh, &[field(wrong)]).unwrap_err().to_string();
        assert!(error.contains("the field \"a < b\"; allowed: one or three lists"), "{error}");
    }
    for twice in ["a < b", "node"] {
        let fields = [named("a < b", vec![third.clone()]), named(twice, vec![third.clone()])];
        let error = write_fields_vtu(&mut Vec::new(), &mesh, &fields).unwrap_err().to_string();
        assert!(error.contains(twice) && error.contains("a name for each"), "{error}");
    }
}

/// The numbers that the scripts compare with, one a line: labels and positions, then lambda and displacements of each mode.
fn expected(mesh: &Mesh, modes: &[ModeShape]) -> String {
    let mut text = String::new();
    for node in &mesh.nodes {
        let [x, y, z] = node.position;
        text += &format!("{} {x:e} {y:e} {z:e}\n", node.label);
    }
    for mode in modes {
        text += &format!("{:e} {:e}\n", mode.lambda.re, mode.lambda.im);
        for u in mode.displacements.iter().flatten() {
            text += &format!("{:e} {:e}\n", u.re, u.im);
        }
    }
    text
}

#[test]
fn pyuff_reads_what_is_written() {
    let (mesh, modes) = example();
    let folder = tempfile::tempdir().unwrap();
    let (unv, numbers) = (folder.path().join("modes.unv"), folder.path().join("numbers"));
    write_unv(&mut std::fs::File::create(&unv).unwrap(), &mesh, &modes).unwrap();
    std::fs::write(&numbers, expected(&mesh, &modes)).unwrap();
    let script = r#"
import sys, numpy as np, pyuff
sets = pyuff.UFF(sys.argv[1]).read_sets()
lines = [[float(x) for x in line.split()] for line in open(sys.argv[2])]
kinds = [s['type'] for s in sets]
assert kinds == [164, 2411, 82, 55, 55], kinds
assert sets[0]['units_code'] == 1 and sets[0]['length'] == 1.0 and sets[0]['temp_offset'] == 273.15, sets[0]
nodes = sets[1]
for i in range(8):
    found = [nodes['node_nums'][i], nodes['x'][i], nodes['y'][i], nodes['z'][i]]
    assert found == lines[i], (found, lines[i])
trace = [int(n) for n in sets[2]['nodes']]
assert len(trace) == sets[2]['n_nodes']
# 12 edges of the cube, 3 diagonals of the tetrahedron, one of the triangle, one of the line.
pairs = {tuple(sorted(p)) for p in zip(trace, trace[1:]) if 0 not in p}
assert len(pairs) == 17, pairs
at = 8
for mode, s in enumerate(sets[3:]):
    assert (s['analysis_type'], s['data_ch'], s['spec_data_type'], s['mode_n']) == (3, 2, 8, mode + 1)
    assert abs(s['eig'] - complex(*lines[at])) <= 1e-5 * abs(s['eig']), s['eig']
    at += 1
    for i in range(8):
        for r in ('r1', 'r2', 'r3'):
            wanted = complex(*lines[at])
            assert abs(s[r][i] - wanted) <= 1e-5 * abs(wanted), (s[r][i], wanted)
            at += 1
assert at == len(lines)
print('pyuff', pyuff.__version__, 'agrees')
"#;
    python("pyuff", script, &[&unv, &numbers]);
}

#[test]
fn meshio_reads_what_is_written() {
    let (mesh, modes) = example();
    let folder = tempfile::tempdir().unwrap();
    let (vtu, numbers) = (folder.path().join("modes.vtu"), folder.path().join("numbers"));
    write_vtu(&mut std::fs::File::create(&vtu).unwrap(), &mesh, &modes).unwrap();
    std::fs::write(&numbers, expected(&mesh, &modes)).unwrap();
    let script = r#"
import sys, numpy as np, meshio
m = meshio.read(sys.argv[1])
lines = [[float(x) for x in line.split()] for line in open(sys.argv[2])]
assert [[n, *p] for n, p in zip(m.point_data['node'], m.points.tolist())] == lines[:8]
cells = [(c.type, c.data.tolist()) for c in m.cells]
assert cells == [('hexahedron', [[0, 1, 2, 3, 4, 5, 6, 7]]), ('tetra', [[0, 1, 2, 5]]), ('quad', [[0, 1, 2, 3]]),
                 ('triangle', [[4, 5, 6]]), ('line', [[0, 6]]), ('vertex', [[7]])], cells
at = 8
for name in ('mode 1', 'a < b & "c"'):
    at += 1
    wanted = np.array(lines[at:at + 24])
    at += 24
    assert (m.point_data[name + ' real'].ravel() == wanted[:, 0]).all()
    assert (m.point_data[name + ' imaginary'].ravel() == wanted[:, 1]).all()
    assert np.allclose(m.point_data[name + ' amplitude'].ravel(), np.hypot(wanted[:, 0], wanted[:, 1]), rtol=1e-15)
assert at == len(lines)
print('meshio', meshio.__version__, 'agrees')
"#;
    python("meshio", script, &[&vtu, &numbers]);
}

/// The lines of the first dataset of this number.
fn dataset<'a>(text: &'a str, number: &str) -> Vec<&'a str> {
    let lines: Vec<&str> = text.lines().collect();
    let at = lines.windows(2).position(|w| w[0].trim() == "-1" && w[1].trim() == number).unwrap();
    lines[at + 2..].iter().take_while(|line| line.trim() != "-1").copied().collect()
}

#[test]
fn lines_are_laid_out_as_in_files_of_other_programs() {
    let fixture = |name: &str| {
        let path = format!("{}/tests/fixtures/unv/{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(path).unwrap()
    };
    // The nodes of I-deas come out with their own columns, and one digit more.
    let housing = fixture("heat_engine_housing.uff");
    let theirs = dataset(&housing, "2411");
    let nodes: Vec<Node> = theirs
        .chunks(2)
        .map(|pair| {
            let mut x = pair[1].split_whitespace().map(|x| x.parse().unwrap());
            let label = pair[0].split_whitespace().next().unwrap().parse().unwrap();
            Node { label, position: std::array::from_fn(|_| x.next().unwrap()) }
        })
        .collect();
    let mesh = Mesh { nodes, cells: Vec::new() };
    let mut out = Vec::new();
    write_unv(&mut out, &mesh, &[]).unwrap();
    let text = String::from_utf8(out).unwrap();
    let ours = dataset(&text, "2411");
    assert_eq!(ours.len(), theirs.len());
    for (a, b) in ours.iter().zip(&theirs) {
        assert_eq!(a.len(), b.len(), "{a:?} {b:?}");
        let numbers = |line: &str| line.split_whitespace().map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>();
        assert!(a.len() == 40 || numbers(a) == numbers(b), "{a:?} {b:?}");
    }
    // Fields of dataset 55 end in the same columns as in the file of pyuff.
    let (mesh, modes) = example();
    let mut out = Vec::new();
    write_unv(&mut out, &mesh, &modes).unwrap();
    let text = String::from_utf8(out).unwrap();
    let (ours, translation) = (dataset(&text, "55"), fixture("uff55_translation.uff"));
    let theirs = dataset(&translation, "55");
    assert_eq!((ours[5].len(), ours[6].len(), ours[8].len()), (theirs[5].len(), theirs[6].len(), theirs[8].len()));
    assert_eq!((ours[7].len(), ours[9].len()), (6 * 13, 6 * 13));
    assert_eq!(ours[7].trim(), "-1.25000E+01  6.28300E+03  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00");
}

#[test]
fn what_cannot_be_written_is_refused() {
    let (mesh, modes) = example();
    let message = |mesh: &Mesh, modes: &[ModeShape]| {
        let unv = write_unv(&mut Vec::new(), mesh, modes).map_err(|e| e.to_string());
        (unv, write_vtu(&mut Vec::new(), mesh, modes).map_err(|e| e.to_string()))
    };
    assert_eq!(message(&mesh, &modes), (Ok(()), Ok(())));
    let mut short = modes.clone();
    short[0].displacements.pop();
    assert_eq!(
        message(&mesh, &short).1,
        Err("the number of displacements is 7; allowed: 8, one for each node".to_owned())
    );
    let mut infinite = modes.clone();
    infinite[1].lambda.re = f64::NAN;
    assert!(message(&mesh, &infinite).0.unwrap_err().contains("finite"));
    let twice = [modes[0].clone(), modes[0].clone()];
    assert!(message(&mesh, &twice).0.is_ok() && message(&mesh, &twice).1.unwrap_err().contains("two shapes"));
    let mut beyond = mesh.clone();
    beyond.cells[0].nodes[0] = 8;
    assert_eq!(message(&beyond, &[]).0, Err("a cell has node 8; allowed: 0 to 7".to_owned()));
    let mut internal = mesh.clone();
    internal.nodes[0].label = -1;
    assert!(message(&internal, &[]).0.unwrap_err().contains("1 to 2147483647") && message(&internal, &[]).1.is_ok());
    assert!(message(&Mesh::default(), &[]).0.unwrap_err().contains("no nodes"));
    assert!(ModeShape::new("x", Complex::default(), &mesh, &[], &[Complex::default()]).is_err());
}
