//! Lists without a header, and the labels beside them.

use formats::{Format, FormatsError, Kind, KnownBy, Options, Stored, Symmetry, Wanted, read, read_bytes};

use crate::{fixture, k, names};

#[test]
fn matrices_have_the_labels_of_the_file_beside_them() {
    let stiffness = read(&fixture("calculix/tiny.sti")).unwrap();
    assert_eq!(stiffness.format, Format::Coordinates);
    let stiffness = stiffness.only().unwrap();
    assert_eq!((stiffness.kind(), stiffness.stored()), (Some(Kind::Stiffness), Stored::Triangle));
    assert_eq!(stiffness.to_dense(), k());
    assert_eq!(formats::nalgebra::DMatrix::from(&stiffness.to_csc()), k());
    assert_eq!(names(stiffness.row_labels()), ["1.x", "1.z", "12.x", "12.10"]);
    assert_eq!(stiffness.asymmetry(), Some(0.0));
    let mass = read(&fixture("calculix/tiny.mas")).unwrap().only().unwrap();
    assert_eq!((mass.kind(), mass.rows(), mass.entries().len()), (Some(Kind::Mass), 4, 4));
}

#[test]
fn labels_are_optional_and_give_the_number_of_rows() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.sti", "1 1 2.0\n2 2 3.0\n");
    let path = folder.path().join("a.sti");
    let alone = read(&path).unwrap().only().unwrap();
    assert_eq!((alone.rows(), alone.row_labels()), (2, None));
    write("a.dof", "7.1\n7.2\n7.3\n");
    let cut = read(&path).unwrap_err().to_string();
    assert_eq!(cut, "line 2: the last row of the list is 2; allowed: 3, the number of its labels: the file may be cut");
    write("a.dof", "7.1\n7.2\n");
    assert_eq!(names(read(&path).unwrap().only().unwrap().row_labels()), ["7.x", "7.y"]);
    write("a.dof", "7.1\n");
    assert_eq!(read(&path).unwrap_err().to_string(), "line 2: row 2; allowed: 1 to 1");
    write("a.dof", "7.1\n7.1\n");
    let twice = read(&path).unwrap_err().to_string();
    assert!(twice.starts_with("the labels in a.dof: line 2: the name of a row is 7.1; allowed"), "{twice}");
    let dof = read(&folder.path().join("a.dof")).unwrap_err().to_string();
    assert!(dof.contains("list of rows"), "{dof}");
}

fn list(text: &str) -> formats::File {
    read_bytes(text.as_bytes(), None, Options::default()).unwrap()
}

fn said(symmetry: Symmetry) -> Wanted<'static> {
    Wanted { symmetry: Some(symmetry), ..Wanted::default() }
}

#[test]
fn a_list_with_entries_on_one_side_is_asked_about() {
    for (text, side, other) in [
        ("1 1 2.0\n1 2 -1.0\n2 2 2.0\n", Symmetry::Upper, Symmetry::Lower),
        ("1 1 2.0\n2 1 -1.0\n2 2 2.0\n", Symmetry::Lower, Symmetry::Upper),
    ] {
        let message = list(text).only().unwrap_err().to_string();
        assert!(
            message.contains(&format!("symmetry = \"whole\" to take them as they are, symmetry = \"{side}\"")),
            "{message}"
        );
        assert!(
            matches!(list(text).of_kind(Kind::Mass), Err(FormatsError::OneSided { side: Some(found), .. }) if found == side)
        );
        let mirrored = list(text).take(&said(side)).unwrap();
        assert_eq!((mirrored.stored(), mirrored.known_by()), (Stored::Triangle, KnownBy::Request));
        assert_eq!(mirrored.to_dense(), formats::nalgebra::dmatrix![2.0, -1.0; -1.0, 2.0]);
        let whole = list(text).take(&said(Symmetry::Whole)).unwrap();
        assert_eq!((whole.stored(), whole.entries().len(), whole.asymmetry()), (Stored::Whole, 3, Some(1.0)));
        let wrong = list(text).take(&said(other)).unwrap_err().to_string();
        assert!(wrong.starts_with(&format!("symmetry = \"{other}\" of the matrix")), "{wrong}");
        // What is said of all files counts where a file does not say so itself.
        let by_the_way = Wanted { otherwise: Some(side), ..Wanted::default() };
        assert_eq!(list(text).take(&by_the_way).unwrap().to_dense(), mirrored.to_dense());
    }
}

#[test]
fn entries_on_both_sides_are_a_whole_matrix_and_none_is_any() {
    let unsymmetric = "1 1 2.0\n1 2 -1.0\n2 1 5.0\n2 2 2.0\n";
    // Friction without a mirror image of any entry.
    let friction = "1 1 30\n1 3 400\n4 3 -400\n4 4 30\n3 3 30\n2 2 30\n";
    let whole = list(unsymmetric).only().unwrap();
    assert_eq!((whole.stored(), whole.known_by()), (Stored::Whole, KnownBy::Contents));
    assert!(matches!(list(friction).only(), Err(FormatsError::OneSided { side: None, .. })));
    for text in [unsymmetric, friction] {
        let whole = list(text).take(&said(Symmetry::Whole)).unwrap();
        assert_eq!((whole.entries().len(), whole.doubts()), (text.lines().count(), Vec::new()));
        assert!(
            list(text).take(&said(Symmetry::Upper)).unwrap_err().to_string().contains("entries below the diagonal")
        );
    }
    let diagonal = "1 1 2.0\n2 2 3.0\n1 2 0.0\n";
    for symmetry in [None, Some(Symmetry::Whole), Some(Symmetry::Upper), Some(Symmetry::Lower)] {
        let matrix = list(diagonal).take(&Wanted { symmetry, ..Wanted::default() }).unwrap();
        assert_eq!(matrix.to_dense(), formats::nalgebra::dmatrix![2.0, 0.0; 0.0, 3.0]);
    }
}

#[test]
fn calculix_writes_the_upper_triangle() {
    let file = || read(&fixture("calculix/tiny.sti")).unwrap();
    let stiffness = file().only().unwrap();
    assert_eq!(
        (stiffness.known_by(), stiffness.taken().as_str()),
        (KnownBy::File, "one triangle, mirrored, as the file says")
    );
    let otherwise = Wanted { otherwise: Some(Symmetry::Whole), ..Wanted::default() };
    assert_eq!(file().take(&otherwise).unwrap().to_dense(), k());
    let contradicted = file().take(&said(Symmetry::Whole)).unwrap_err().to_string();
    assert!(contradicted.contains("which is a triangle of a symmetric matrix, as the file says"), "{contradicted}");
    // The same list under another name says nothing.
    let folder = tempfile::tempdir().unwrap();
    let (upper, lower) = (folder.path().join("K.mtx"), folder.path().join("K.sti"));
    std::fs::copy(fixture("calculix/tiny.sti"), &upper).unwrap();
    assert!(matches!(read(&upper).unwrap().only(), Err(FormatsError::OneSided { .. })));
    std::fs::write(&lower, "1 1 2.0\n2 1 -1.0\n2 2 2.0\n").unwrap();
    assert!(matches!(read(&lower).unwrap().only(), Err(FormatsError::OneSided { .. })));
}

#[test]
fn rows_with_negative_numbers_are_internal_nodes() {
    let mass = list("-2 -2 0.5\n-1 -1 0.25\n1 1 1.0\n2 2 2.0\n").only().unwrap();
    let stiffness = list("-2 -2 4\n1 -2 -1\n-2 1 -1\n1 1 3\n3 3 7\n2 2 5\n").only().unwrap();
    assert_eq!(names(mass.row_labels()), ["-2.0", "-1.0", "1.0", "2.0"]);
    let (mut m, mut k) = (mass, stiffness);
    // A mass without internal nodes, and with a massless last row.
    let mut plain = list("1 1 9\n2 2 9\n").only().unwrap();
    formats::on_common_rows(&mut [&mut m, &mut plain, &mut k]).unwrap();
    assert_eq!(names(k.row_labels()), ["-2.0", "-1.0", "1.0", "2.0", "3.0"]);
    assert_eq!((m.to_dense().diagonal().sum(), plain.to_dense()[(2, 2)], k.to_dense()[(2, 0)]), (3.75, 9.0, -1.0));
    assert_eq!((m.rows(), plain.rows(), k.to_dense()[(4, 4)]), (5, 5, 7.0));
    assert!(read_bytes(b"0 1 1.0\n", None, Options::default()).is_err());
}

#[test]
fn the_size_of_lists_is_that_of_the_largest() {
    let (mut mass, mut stiffness) = (list("1 1 1\n2 2 2\n").only().unwrap(), list("1 1 1\n3 3 2\n").only().unwrap());
    formats::on_common_rows(&mut [&mut mass, &mut stiffness]).unwrap();
    assert_eq!((mass.rows(), mass.columns(), stiffness.rows()), (3, 3, 3));
    let market = b"%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1 1.0\n";
    let mut fixed = read_bytes(market, None, Options::default()).unwrap().only().unwrap();
    formats::on_common_rows(&mut [&mut fixed, &mut stiffness]).unwrap();
    assert_eq!((fixed.rows(), stiffness.rows()), (2, 3));
}

/// A file of Matrix Market that lost its first line, of every size: its line of sizes is no entry.
#[test]
fn a_line_of_sizes_is_no_entry() {
    for order in 2..12 {
        let entries: Vec<String> = (1..=order).map(|i| format!("{i} {i} {i}.5\n")).collect();
        let headless = format!("{order} {order} {order}\n{}", entries.concat());
        let message = read_bytes(headless.as_bytes(), None, Options::default()).unwrap_err().to_string();
        assert!(message.contains("the first line") && message.contains("MatrixMarket"), "{message}");
        // So is one whose banner stands below other comments: it is read as what it says it is.
        let commented = format!("% exported\n%\n%%MatrixMarket matrix coordinate real general\n{headless}");
        let found = list(&commented).only().unwrap();
        assert_eq!((found.rows(), found.entries().len()), (order, order));
        // With a decimal point it is an entry, twice in the list here; so is one of another number.
        for first in [format!("{order} {order} {order}.0\n"), format!("{order} {order} {}\n", order + 1)] {
            let found = list(&(first + &entries.concat())).only().unwrap();
            assert_eq!(found.rows(), order);
        }
    }
}

/// Three lines of three whole numbers are a list, or the rows of a matrix of order 3.
#[test]
fn rows_of_whole_numbers_are_no_list() {
    for (a, b, c) in [(1, 3, 1), (2, 2, 2), (3, 1, 2)] {
        let symmetric = format!("7 {a} {b}\n{a} 8 {c}\n{b} {c} 9\n");
        let message = read_bytes(symmetric.as_bytes(), None, Options::default()).unwrap_err().to_string();
        assert!(message.contains("rows of a matrix") && message.contains("Matrix Market"), "{message}");
        // One that is no symmetric matrix is a list, and so is one with another line or with a decimal point.
        let list_of = |text: &str| {
            assert_eq!(list(text).take(&said(Symmetry::Whole)).unwrap().entries().len(), text.lines().count(), "{text}")
        };
        list_of(&symmetric.replace(" 9", " 9.0"));
        list_of(&format!("{symmetric}10 10 1\n"));
        list_of("1 1 2\n2 2 3\n3 3 4\n");
    }
}

/// Exports that number their nodes differently: a matrix without a row of the others is refused, one that shares some has what it has alone.
#[test]
fn a_matrix_that_has_no_row_of_the_others_is_refused() {
    let on = |nodes: [i64; 2]| {
        let [a, b] = nodes;
        let text = format!("{a},1, {a},1, 5.0\n{b},1, {b},1, 6.0\n");
        read_bytes(text.as_bytes(), None, Options::default()).unwrap().only().unwrap()
    };
    let (mut mass, mut damping, mut stiffness) = (on([10, 20]), on([10, 20]), on([0, 1]));
    let (at, error) = formats::on_common_rows(&mut [&mut mass, &mut damping, &mut stiffness]).unwrap_err();
    let message = error.to_string();
    assert!(
        at == 2 && message.contains("2 rows, as 0.x") && message.contains("none of them is in any other"),
        "{at} {message}"
    );
    let mut stiffness = on([20, 30]);
    formats::on_common_rows(&mut [&mut mass, &mut damping, &mut stiffness]).unwrap();
    assert_eq!((mass.rows(), stiffness.rows()), (3, 3));
}

#[test]
fn matrices_of_one_model_are_put_on_common_labels() {
    let stiffness = read(&fixture("calculix/tiny.sti")).unwrap().only().unwrap();
    let abaqus = b"12,1, 12,1, 5.0\n12,2, 12,2, 6.0\n";
    let mass = read_bytes(abaqus, None, Options::default()).unwrap().only().unwrap();
    let labels = formats::common_labels([&stiffness, &mass]).unwrap();
    assert_eq!(names(Some(&labels)), ["1.x", "1.z", "12.x", "12.y", "12.10"]);
    let (k, m) = (stiffness.on(&labels).unwrap().to_dense(), mass.on(&labels).unwrap().to_dense());
    assert_eq!((k[(2, 4)], k[(4, 2)], k[(3, 3)], m[(2, 2)], m[(3, 3)]), (-3.0, -3.0, 0.0, 5.0, 6.0));
    let message = mass.on(&labels[..3]).unwrap_err().to_string();
    assert_eq!(message, "the matrix \"matrix\" has the degree of freedom 12.y, which the given list lacks");
}
