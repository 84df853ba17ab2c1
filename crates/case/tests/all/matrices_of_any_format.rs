//! A brake of kind "matrices" is the same whatever format its matrices are in.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use std::fmt::Write;
use std::path::Path;

use case::{CaseFile, MatricesCase};
use nalgebra::{DMatrix, dmatrix};
use study::Moves;

/// A folder with a matrix in every format that is written here in a few lines; the names of the files.
fn written(folder: &Path, name: &str, matrix: &DMatrix<f64>) -> Vec<String> {
    let n = matrix.nrows();
    let entries = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&at| matrix[at] != 0.0);
    let lines = |line: &dyn Fn(usize, usize, f64) -> String| {
        entries().map(|(i, j)| line(i, j, matrix[(i, j)]) + "\n").collect::<String>()
    };
    let market = format!("%%MatrixMarket matrix coordinate real general\n{n} {n} {}\n", entries().count());
    let plain = lines(&|i, j, x| format!("{} {} {x:e}", i + 1, j + 1));
    // Columns one after the other.
    let numbers: Vec<u8> = matrix.iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    let header = format!("{:<117}\n", format!("{{'descr': '<f8', 'fortran_order': True, 'shape': ({n}, {n}), }}"));
    npy.extend((header.len() as u16).to_le_bytes());
    npy.extend(header.bytes().chain(numbers.iter().copied()));
    let mut mat: Vec<u8> = [0, n as i32, n as i32, 0, 2].into_iter().flat_map(i32::to_le_bytes).collect();
    mat.extend(b"A\0".iter().chain(&numbers));
    let of_set = if name == "M" { "MAAX" } else { "KAAX" };
    let mut dmig = format!("DMIG,{of_set},0,{},2,0,,,{n}\n", if matrix == &matrix.transpose() { 6 } else { 1 });
    for (i, j) in entries().filter(|(i, j)| i >= j || matrix != &matrix.transpose()) {
        writeln!(dmig, "DMIG,{of_set},{},1,,{},1,{:e}", j + 1, i + 1, matrix[(i, j)]).unwrap();
    }
    let files: [(&str, Vec<u8>); 6] = [
        ("mtx", (market + &plain).into_bytes()),
        ("npy", npy),
        ("mat", mat),
        ("sti", plain.into_bytes()),
        ("inp", lines(&|i, j, x| format!("{}, 1, {}, 1, {x:e}", i + 1, j + 1)).into_bytes()),
        ("pch", dmig.into_bytes()),
    ];
    let file = |(ending, bytes): (&str, Vec<u8>)| {
        let file = format!("{name}.{ending}");
        std::fs::write(folder.join(&file), bytes).unwrap();
        file
    };
    files.into_iter().map(file).collect()
}

fn read(folder: &Path, mass: &str, stiffness: &str, more: &str) -> Result<MatricesCase, String> {
    let text = format!(
        "[study]\nname = \"any\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\n\
         [[terms]]\nname = \"structure\"\nsymmetry = \"whole\"\nmass = {mass}\nstiffness = {stiffness}\n{more}"
    );
    match CaseFile::parse(&folder.join("case.toml"), text).map_err(|error| error.to_string())? {
        CaseFile::Matrices(case) => Ok(*case),
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_format_gives_the_same_brake_in_every_mixture() {
    let folder = tempfile::tempdir().unwrap();
    let m = dmatrix![2.0, 0.0, 0.0; 0.0, 3.0, 0.0; 0.0, 0.0, 4.0];
    let symmetric = dmatrix![5.0, -1.0, 0.5; -1.0, 6.0, 0.0; 0.5, 0.0, 7.0];
    let unsymmetric = dmatrix![5.0, -1.0, 0.0; 3.0, 6.0, 0.25; 0.0, -2.0, 7.0];
    let masses = written(folder.path(), "M", &m);
    let quoted = |file: &str| format!("{file:?}");
    let rows = "[[2.0, 0, 0], [0, 3.0, 0], [0, 0, 4.0]]".to_owned();
    for (name, k) in [("S", symmetric), ("U", unsymmetric)] {
        for stiffness in written(folder.path(), name, &k) {
            for mass in masses.iter().map(|file| quoted(file)).chain([rows.clone()]) {
                let case = read(folder.path(), &mass, &quoted(&stiffness), "")
                    .unwrap_or_else(|e| panic!("{mass} {stiffness}: {e}"));
                let found = case.system.terms()[0].matrices();
                assert_eq!((&found.m, &found.k), (&m, &k), "{mass} {stiffness}");
                assert_eq!(
                    case.taken.iter().filter(|taken| taken.file.is_some()).count(),
                    1 + usize::from(mass != rows)
                );
            }
        }
    }
}

/// Rows in the case and an array in a file say as little of a triangle, and a word on it counts for both alike.
#[test]
fn rows_are_taken_as_a_file_is() {
    let folder = tempfile::tempdir().unwrap();
    let whole = dmatrix![5.0, -1.0, 0.5; -1.0, 6.0, 0.25; 0.5, 0.25, 7.0];
    let unsymmetric = dmatrix![5.0, -1.0, 0.0; 3.0, 6.0, 0.25; 0.0, -2.0, 7.0];
    let no_images = dmatrix![5.0, -1.0, 0.0; 0.0, 6.0, 0.0; 0.5, 0.25, 7.0];
    let upper = whole.upper_triangle();
    let lower = upper.transpose();
    let friction = dmatrix![0.0, 0.0, -3.0; 0.0, 0.0, 0.0; 0.0, 0.0, 0.0];
    let diagonal = DMatrix::from_diagonal(&whole.diagonal());
    let rows = |matrix: &DMatrix<f64>| {
        let row = |i: usize| format!("{:?}", matrix.row(i).iter().collect::<Vec<_>>());
        format!("[{}]", (0..3).map(row).collect::<Vec<_>>().join(", "))
    };
    let tail = |error: &str, name: &str| error.split(&format!("the matrix \"{name}\"")).nth(1).map(str::to_owned);
    let taken = |stiffness: &str, symmetry: &str| {
        let more = format!("[[terms]]\nname = \"more\"\nstiffness = {stiffness}\n{symmetry}\n");
        let mass = "[[2.0, 0, 0], [0, 3.0, 0], [0, 0, 4.0]]";
        let case = read(folder.path(), mass, mass, &more)?;
        Ok::<_, String>((case.system.terms()[1].matrices().k.clone(), case.taken.last().unwrap().taken.clone()))
    };
    let words = ["whole", "upper", "lower", "triangle"];
    let words = words.into_iter().flat_map(|word| {
        [format!("symmetry = {word:?}"), format!("symmetry = {{ stiffness = {word:?} }}")].map(|said| (word, said))
    });
    for (at, matrix) in [&whole, &unsymmetric, &no_images, &upper, &lower, &friction, &diagonal].into_iter().enumerate()
    {
        written(folder.path(), &format!("K{at}"), matrix);
        for (word, said) in words.clone().chain([("", String::new())]) {
            let from_file = taken(&format!("\"K{at}.npy\""), &said);
            let from_rows = taken(&rows(matrix), &said);
            let made_whole = matrix + matrix.transpose() - DMatrix::from_diagonal(&matrix.diagonal());
            match (&from_rows, &from_file) {
                (Ok((k, words)), Ok(of_file)) => {
                    assert_eq!((k, words), (&of_file.0, &of_file.1), "{matrix} {said}");
                    let is_mirrored = !matches!(word, "" | "whole") && matrix != &diagonal;
                    assert_eq!(k, if is_mirrored { &made_whole } else { matrix }, "{matrix} {said}");
                }
                (Err(refused), Err(of_file)) => {
                    assert!(refused.contains("case.toml: terms \"more\".stiffness: "), "{refused}");
                    assert_eq!(tail(refused, "stiffness").unwrap(), tail(of_file, "matrix").unwrap());
                }
                _ => panic!("{matrix} {said}: {from_rows:?} {from_file:?}"),
            }
        }
    }
    // What is told apart at all.
    assert!(taken(&rows(&upper), "").unwrap_err().contains("symmetry = \"whole\""));
    assert!(taken(&rows(&upper), "symmetry = \"lower\"").unwrap_err().contains("with entries above the diagonal"));
    assert!(taken(&rows(&whole), "symmetry = \"upper\"").unwrap_err().contains("with entries below the diagonal"));
    assert_eq!(taken(&rows(&lower), "symmetry = \"lower\"").unwrap().0, whole);
    for lacks in ["mass", "damping"] {
        let refused = taken(&rows(&whole), &format!("symmetry = {{ {lacks} = \"whole\" }}")).unwrap_err();
        let expected = format!("terms \"more\".symmetry = a word on its {lacks}, which it lacks; allowed: ");
        assert!(refused.contains(&expected), "{refused}");
    }
}

#[test]
fn named_rows_meet_by_their_names_and_give_names() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("M.inp", "7, 3, 7, 3, 2.0\n5, 1, 5, 1, 4.0\n");
    write("K.inp", "7, 3, 7, 3, 9.0\n");
    write("K.mtx", "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n");
    let case = read(folder.path(), "\"M.inp\"", "\"K.inp\"", "").unwrap();
    assert_eq!(case.dofs, ["5.x", "7.z"]);
    assert_eq!(case.moves, [Moves::Along; 2]);
    assert_eq!(case.system.terms()[0].matrices().k, dmatrix![0.0, 0.0; 0.0, 9.0]);
    write("turns.inp", "7, 6, 7, 6, 2.0\n5, 1, 5, 1, 4.0\n");
    assert_eq!(read(folder.path(), "\"turns.inp\"", "\"turns.inp\"", "").unwrap().moves, [Moves::Along, Moves::Turns]);
    let contact = "[[contacts]]\nname = \"c\"\nforce = { \"7.z\" = 1.0 }\nreading = { \"5.x\" = 2.0 }\nmu = 0.3\n";
    assert_eq!(read(folder.path(), "\"M.inp\"", "\"K.inp\"", contact).unwrap().gains.len(), 1);
    let term = |k: &str| format!("[[terms]]\nname = \"more\"\nstiffness = {k}\n");
    for k in ["\"K.mtx\"", "[[1.0, 2.0], [3.0, 4.0]]"] {
        let found = read(folder.path(), "\"M.inp\"", "\"K.inp\"", &term(k)).unwrap_err();
        let expected = "terms \"more\".stiffness = a matrix without names of its rows; allowed: names of its rows";
        assert!(found.contains(expected), "{found}");
    }
    let found = read(folder.path(), "\"none.npz\"", "\"K.inp\"", "").unwrap_err();
    assert!(found.contains("terms \"structure\".mass = \"none.npz\": cannot be read"), "{found}");
}
