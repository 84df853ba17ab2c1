//! Nastran's DMIG and OUTPUT4.

use formats::nalgebra::dmatrix;
use formats::{Doubt, Format, FormatsError, Kind, Options, Stored, Symmetry, Wanted, read, read_bytes};

use crate::{d, fixture, k, names};

#[test]
fn a_punch_file_has_mass_damping_and_stiffness() {
    let file = read(&fixture("nastran_dmig/dmig.pch")).unwrap();
    assert_eq!(file.format, Format::Dmig);
    let listed: Vec<_> = file.matrices.iter().map(|m| (m.name(), m.kind(), m.rows(), m.columns())).collect();
    let expected = [
        ("KAAX", Some(Kind::Stiffness), 15, 15),
        ("MAAX", Some(Kind::Mass), 15, 15),
        ("BAAX", Some(Kind::Damping), 4, 4),
        ("VAX", None, 15, 1),
        ("RVA", None, 4, 2),
        ("MUG1T", None, 15, 90),
    ];
    assert_eq!(listed, expected);
    let stiffness = file.matrix("KAAX").unwrap();
    assert_eq!((stiffness.stored(), names(stiffness.row_labels())[2].as_str()), (Stored::Triangle, "105.x"));
    let dense = stiffness.to_dense();
    assert_eq!((dense[(0, 0)], dense[(0, 1)], dense[(1, 0)], dense[(3, 2)]), (155.6, -155.6, -155.6, -3002.7));
    assert_eq!(stiffness.asymmetry(), Some(0.0));
    // The damping has four degrees of freedom only; among those of the stiffness it has the right places.
    let damping = file.of_kind(Kind::Damping).unwrap().on(stiffness.row_labels().unwrap()).unwrap();
    assert_eq!((damping.rows(), damping.to_dense()[(1, 0)]), (15, -10.0));
    assert_eq!(file.matrix("RVA").unwrap().column_labels(), None);
}

#[test]
fn complex_matrices_are_left_out_with_their_names() {
    let file = read(&fixture("nastran_dmig/dmig.bdf")).unwrap();
    assert_eq!(file.matrices.iter().map(formats::Matrix::name).collect::<Vec<_>>(), ["REALS", "REAL"]);
    assert_eq!(file.matrix("REALS").unwrap().to_dense(), dmatrix![1.0, 0.5, 0.25; 0.5, 2.0, 0.75; 0.25, 0.75, 3.0]);
    assert_eq!(file.matrix("REAL").unwrap().to_dense(), dmatrix![1.0, 0.5, 0.25; 0.0, 2.0, 0.75; 0.0, 0.0, 3.0]);
    let message = file.matrix("IMAGS").unwrap_err().to_string();
    assert!(message.contains("complex") && message.contains("allowed: REALS, REAL"), "{message}");
}

#[test]
fn short_and_free_fields_are_read() {
    let file = read(&fixture("nastran_dmig/short_and_free.bdf")).unwrap();
    let k = file.matrix("KAAX").unwrap();
    assert_eq!(names(k.row_labels()), ["1.x", "1.y", "2.0"]);
    assert_eq!(k.to_dense(), dmatrix![3000.0, -1500.0, 2.5e-10; -1500.0, 4000.0, 0.0; 2.5e-10, 0.0, 7.0]);
    let unsymmetric = file.matrix("UNSYM").unwrap();
    assert_eq!(names(unsymmetric.row_labels()), ["1.x", "1.y", "2.z"]);
    assert_eq!(unsymmetric.to_dense(), dmatrix![0.0, 0.0, 0.0; 5.0, 0.0, 0.0; -6.0, 0.0, 0.0]);
    let rectangular = file.matrix("RECT").unwrap();
    assert_eq!(
        (rectangular.to_dense(), names(rectangular.row_labels())),
        (dmatrix![0.0, 8.0], vec!["11.z".to_owned()])
    );
}

#[test]
fn faults_of_dmig_are_named() {
    let header = "DMIG    K       0       6       2       0\n";
    let column = "DMIG    K       1       1               1       2       1.0\n";
    let mirrored = "DMIG    K       1       2               1       1       1.0\n";
    for (text, part) in [
        (format!("{header}{column}{mirrored}"), "the matrix \"K\" gives both (1.y, 1.x) and its mirror image"),
        (column.to_owned(), "the first entry of a DMIG is a column of K; allowed: its header"),
        (format!("{header}{header}"), "a second one of K"),
        (header.replace('6', "3"), "form of a DMIG \"3\" is not supported"),
        (header.replace('2', "7"), "type of a DMIG \"7\" is not supported"),
        (format!("{header}{}", column.replace("2 ", "9 ")), "component is 9"),
        (format!("{header}{}", column.replace("1.0", "x")), "\"X\" is not a number"),
        // What stands beyond the fields of a line, and the mark of its continuation, would be lost.
        (format!("{header}DMIG,K,1,1,,1,1,5.0,,,2,1,5.0\n"), "a field of a line is 2; allowed: 8 fields in a line"),
        (format!("{header}DMIG,K,1,1,,1,1,5.0,,7\n"), "a field of a line is 7"),
        (format!("{header}DMIG*,K,1,1,,1,1,5.0\n"), "allowed: 4 fields in a line"),
        (format!("{header}{}", column.replace("1.0", "1.0     2.0")), "imaginary part"),
        (header.to_owned(), "no matrix that can be read (K: no entries)"),
        ("DMIG    K       0       9       2       0\n".to_owned(), "not a whole number"),
    ] {
        let message = read_bytes(text.as_bytes(), None, Options::default()).unwrap_err().to_string();
        assert!(message.to_lowercase().contains(&part.to_lowercase()), "{message:?} lacks {part:?}");
    }
}

#[test]
fn the_four_ways_to_write_op4_hold_the_same_matrices() {
    let files: Vec<_> = ["mat_t_dn", "mat_t_s1", "mat_b_dn", "mat_b_s1"]
        .iter()
        .map(|name| read(&fixture(&format!("nastran_op4/{name}.op4"))).unwrap())
        .collect();
    assert_eq!(files.iter().map(|f| f.format).collect::<Vec<_>>()[1..3], [Format::Op4Text, Format::Op4Binary]);
    for file in &files {
        let listed: Vec<_> = file.matrices.iter().map(|m| (m.name(), m.rows(), m.columns())).collect();
        let expected =
            [("EYE10", 10, 10), ("LOW", 5, 7), ("NULL", 3, 3), ("RND1RD", 4, 4), ("RND1RS", 4, 4), ("STRINGS", 30, 20)];
        let mut sorted = listed.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, expected);
        let mut left_out: Vec<_> = file.left_out.iter().map(|(name, _)| name.as_str()).collect();
        left_out.sort_unstable();
        assert_eq!(left_out, ["EYE5CD", "RND1CD", "RND1CS"]);
        let low = file.matrix("LOW").unwrap().to_dense();
        assert_eq!(
            (low[(0, 0)], low[(1, 0)], low[(4, 3)], low.column(4).sum(), low[(4, 6)]),
            (0.0, 1.0, 4.0, 0.0, 7.0)
        );
        let random = file.matrix("RND1RD").unwrap().to_dense();
        assert_eq!((random[(0, 0)], random[(3, 3)]), (0.624_322_312_926_892_7, 0.089_266_183_576_313_55));
        let single = file.matrix("RND1RS").unwrap().to_dense();
        assert!((single[(1, 0)] - 1.626_923_680_305_481e-2).abs() < 1e-9);
        let strings = file.matrix("STRINGS").unwrap().to_dense();
        assert_eq!((strings[(2, 0)], strings[(5, 0)], strings[(28, 19)], strings[(2, 19)]), (1.0, 0.0, 20.0, 0.0));
        assert_eq!(file.matrix("NULL").unwrap().entries().len(), 0);
    }
}

#[test]
fn big_endian_bigmat_and_long_words_are_read() {
    for name in ["big_endian", "bigmat"] {
        let file = read(&fixture(&format!("nastran_op4/{name}.op4"))).unwrap();
        assert_eq!(file.matrix("KGG").unwrap().to_dense(), k(), "{name}");
        assert_eq!(file.of_kind(Kind::Stiffness).unwrap().name(), "KGG");
        assert_eq!(file.matrix("D").unwrap().to_dense(), d(), "{name}");
    }
    // Words of 8 bytes: pyYeti 1.4.7 reads the same from this file. The type of DAMPING is that of single precision.
    let file = read(&fixture("nastran_op4/long_words.op4")).unwrap();
    assert_eq!((file.format, file.matrix("KGG").unwrap().to_dense()), (Format::Op4Binary, k()));
    assert_eq!([file.matrix("DAMPING").unwrap().to_dense(), file.matrix("D").unwrap().to_dense()], [d(), d()]);
    let text = "       3      -2       2       2D       1P,2E23.16\n       1       0       4\n       3       1\n 1.5000000000000000E+00\n\
                \x20      2       0       4\n       3       2\n 3.0000000000000000D+00\n       3       0       6\n       5       1\n\
                -2.0000000000000000E+00 4.0000000000000000E+00\n       4       1       1\n 1.0000000000000000E+00\n";
    let file = read_bytes(text.as_bytes(), None, Options::default()).unwrap();
    assert_eq!((file.format, file.only().unwrap().to_dense()), (Format::Op4Text, d()));
    // The length of a column in words, as the manual has it, and not in numbers.
    let words = "       1       3       2       2V       1P,2E23.16\n       1       1       6\n 1.5000000000000000E+00 \
                 2.5000000000000000E+00\n 3.5000000000000000E+00\n       2       1       1\n 1.0000000000000000E+00\n";
    let read_words = |text: &str| read_bytes(text.as_bytes(), None, Options::default());
    assert_eq!(read_words(words).unwrap().only().unwrap().to_dense(), dmatrix![1.5; 2.5; 3.5]);
    assert_eq!(read_words(&words.replace("6\n 1", "3\n 1")).unwrap().only().unwrap().entries().len(), 3);
    let short = read_words(&words.replace("6\n 1", "4\n 1")).unwrap_err().to_string();
    assert!(short.contains("ends after 3 of 4 entries"), "{short}");
    // A symmetric matrix of which only a triangle is there.
    let triangle = "       2       2       6       2K       1P,2E23.16\n       1       1       2\n 1.5000000000000000E+00 \
                    2.5000000000000000E+00\n       3       1       1\n 1.0000000000000000E+00\n";
    let message = read_bytes(triangle.as_bytes(), None, Options::default()).unwrap().only().unwrap_err().to_string();
    assert!(message.starts_with("the matrix \"K\" has entries below the diagonal only"), "{message}");
}

/// A dense text file of OP4 with one matrix K, given by its columns.
fn op4_text(form: usize, columns: &[[f64; 3]]) -> String {
    let mut text = format!("{:8}{:8}{form:8}{:8}{:<8}1P,3E23.16\n", columns.len(), 3, 2, "K");
    for (at, column) in columns.iter().enumerate() {
        text += &format!("{:8}{:8}{:8}\n", at + 1, 1, 3);
        column.iter().for_each(|value| text += &format!("{:>23}", format!("{value:.16E}")));
        text += "\n";
    }
    text + &format!("{:8}{:8}{:8}\n{:>23}\n", columns.len() + 1, 1, 1, "1.0000000000000000E+00")
}

#[test]
fn an_op4_matrix_that_is_called_symmetric_and_is_not_is_in_doubt() {
    let dir = tempfile::tempdir().unwrap();
    let read = |form: usize, friction: f64| {
        let path = dir.path().join("k.op4");
        let columns = [[4.0, -1.0, 0.5], [-1.0 + friction, 5.0, 0.0], [0.5, 0.0, 6.0]];
        std::fs::write(&path, op4_text(form, &columns)).unwrap();
        read(&path).unwrap()
    };
    let whole = Wanted { symmetry: Some(Symmetry::Whole), ..Wanted::default() };
    // Rounding is no friction, and a square matrix need not be symmetric.
    for (form, friction) in [(6, 0.0), (6, 1e-12), (1, 0.3)] {
        assert_eq!(read(form, friction).only().unwrap().doubts(), [], "{form}, {friction}");
    }
    for friction in [0.3, -1e-3] {
        let found = read(6, friction).only().unwrap();
        assert_eq!(found.doubts(), [Doubt::NotSymmetric], "{friction}");
        let dense = found.to_dense();
        assert_eq!((dense[(0, 1)], dense[(1, 0)]), (-1.0 + friction, -1.0));
        assert_eq!(found.with_symmetry(Some(Symmetry::Whole), None).unwrap().doubts(), []);
    }
    // Friction that takes an entry away leaves what may be a triangle with entries given twice.
    assert!(matches!(read(6, 1.0).only(), Err(FormatsError::PartlyMirrored { .. })));
    assert_eq!(read(6, 1.0).take(&whole).unwrap().to_dense()[(0, 1)], 0.0);
}
