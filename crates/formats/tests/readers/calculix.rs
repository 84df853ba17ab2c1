//! Lists without a header, and the labels beside them.

use formats::{Format, FormatsError, Kind, Options, Problem, Stored, Unstated, read, read_bytes};

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

fn list(text: &str, unstated: Unstated) -> Result<formats::Matrix, FormatsError> {
    read_bytes(text.as_bytes(), None, Options { unstated, ..Options::default() })?.only()
}

#[test]
fn the_contents_tell_a_triangle_from_a_whole_matrix() {
    let upper = "1 1 2.0\n1 2 -1.0\n2 2 2.0\n";
    let unsymmetric = "1 1 2.0\n1 2 -1.0\n2 1 5.0\n2 2 2.0\n";
    let triangle = list(upper, Unstated::ByContents).unwrap();
    assert_eq!((triangle.stored(), triangle.entries().len()), (Stored::Triangle, 4));
    let whole = list(unsymmetric, Unstated::ByContents).unwrap();
    assert_eq!((whole.stored(), whole.entries().len()), (Stored::Whole, 4));
    assert_eq!(whole.asymmetry(), Some(6.0));
    assert_eq!(list(upper, Unstated::Whole).unwrap().entries().len(), 3);
    match list(unsymmetric, Unstated::Triangle) {
        Err(FormatsError::At { problem, .. }) => assert!(matches!(*problem, Problem::BothTriangles { pairs: 1, .. })),
        other => panic!("{other:?}"),
    }
    // One pair of four is given twice: neither a triangle nor a whole matrix.
    let between = "1 1 1\n1 2 1\n2 1 1\n1 3 1\n2 3 1\n3 4 1\n4 4 1\n";
    let message = list(between, Unstated::ByContents).unwrap_err().to_string();
    assert!(message.contains("(2, 1) and its mirror image, 1 such pairs"), "{message}");
    assert_eq!(list(between, Unstated::Whole).unwrap().entries().len(), 7);
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
