//! Abaqus's `MATRIX INPUT` and substructures.

use formats::{Doubt, Format, FormatsError, Kind, Options, Stored, Symmetry, Wanted, read, read_bytes};

use crate::{fixture, names};

#[test]
fn internal_nodes_keep_their_mass() {
    let file = read(&fixture("abaqus_matrix_input/model_MASS1.mtx")).unwrap();
    assert_eq!(file.format, Format::AbaqusMatrixInput);
    assert!(matches!(file.clone().only(), Err(FormatsError::OneSided { side: Some(Symmetry::Lower), .. })));
    let lower = Wanted { symmetry: Some(Symmetry::Lower), ..Wanted::default() };
    let mass = file.take(&lower).unwrap();
    // Two nodes with six directions and an internal one with two.
    assert_eq!((mass.rows(), mass.kind(), mass.stored()), (14, Some(Kind::Mass), Stored::Triangle));
    let labels = names(mass.row_labels());
    assert_eq!(labels[..3], ["-1.x", "-1.y", "1.x"]);
    let dense = mass.to_dense();
    let at = |a: &str, b: &str| {
        let place = |name: &str| labels.iter().position(|label| label == name).unwrap();
        dense[(place(a), place(b))]
    };
    assert_eq!(at("-1.x", "-1.x"), 6.187500000000051);
    assert_eq!((at("1.x", "-1.x"), at("-1.x", "1.x")), (11.62500000000011, 11.62500000000011));
    assert_eq!(at("2.rx", "1.rx"), 1.500000000000007e-02);
    // A beam of 3 m, 0.25 m2 and 100 kg/m3: moved along x as a whole, 75 kg, with the internal node's share.
    let along_x: f64 = ["1.x", "2.x"].iter().flat_map(|a| ["1.x", "2.x"].map(|b| at(a, b))).sum();
    assert!((along_x - 75.0).abs() < 1e-9, "{along_x}");
    let stiffness = read(&fixture("abaqus_matrix_input/model_STIF1.mtx")).unwrap().take(&lower).unwrap();
    assert_eq!((stiffness.kind(), stiffness.row_labels()), (Some(Kind::Stiffness), mass.row_labels()));
}

#[test]
fn a_keyword_names_shape_and_factor() {
    let text = "** two matrices\n*MATRIX INPUT, NAME=K1, TYPE=UNSYMMETRIC\n1,1, 1,1, 2.0\n1,1, 1,2, 3.0\n\
                *Matrix Input, name=M1, scale factor=2.\n1,1, 1,1, 1.0\n1,2, 1,1, 0.5\n1,1, 1,2, 0.5\n";
    let file = read_bytes(text.as_bytes(), None, Options::default()).unwrap();
    let k = file.matrix("K1").unwrap();
    assert_eq!((k.stored(), k.entries().len()), (Stored::Whole, 2));
    let m = file.matrix("M1").unwrap();
    assert_eq!((m.stored(), m.to_dense()[(0, 1)], m.to_dense()[(1, 0)]), (Stored::Whole, 1.0, 1.0));
    let missing = file.matrix("C1").unwrap_err().to_string();
    assert_eq!(missing, "no matrix \"C1\"; allowed: K1, M1");
    let same = read_bytes(text.replace("M1", "K1").as_bytes(), None, Options::default()).unwrap();
    assert_eq!(
        same.matrix("K1").unwrap_err().to_string(),
        "no matrix \"K1\" was read (several have this name); allowed: K1, K1"
    );
    let unequal = text.replace("1,1, 1,2, 0.5", "1,1, 1,2, 0.25");
    let message = read_bytes(unequal.as_bytes(), None, Options::default()).unwrap_err().to_string();
    assert!(message.contains("\"M1\" gives both (1.y, 1.x) and its mirror image"), "{message}");
    // Without TYPE it is symmetric for Abaqus; who wrote friction may not have known.
    for (text, is_open) in [
        ("*MATRIX INPUT, NAME=KF\n1,1, 1,3, 400.0\n2,1, 1,3, -400.0\n", true),
        ("*MATRIX INPUT, NAME=KF\n1,1, 1,1, 400.0\n", false),
        ("*MATRIX INPUT, NAME=KF, TYPE=SYMMETRIC\n1,1, 1,3, 400.0\n2,1, 1,3, -400.0\n", false),
        ("*MATRIX INPUT, NAME=KF, TYPE=UNSYMMETRIC\n1,1, 1,3, 400.0\n2,1, 1,3, -400.0\n", false),
    ] {
        let matrix = read_bytes(text.as_bytes(), None, Options::default()).unwrap().only();
        assert_eq!(matches!(matrix, Err(FormatsError::OneSided { .. })), is_open, "{text}");
    }
    // A number called k beside the matrix K.
    let two = "*MATRIX INPUT, NAME=k, TYPE=SYMMETRIC\n1,1, 1,1, 5.0\n*MATRIX INPUT, NAME=K, TYPE=SYMMETRIC\n1,1, 1,1, 5.0\n1,2, 1,2, 6.0\n";
    let file = read_bytes(two.as_bytes(), None, Options::default()).unwrap();
    assert_eq!(file.of_kind(Kind::Stiffness).unwrap().name(), "K");
    assert_eq!((file.matrix("k").unwrap().rows(), file.matrix("K").unwrap().rows()), (1, 2));
    let elsewhere = read_bytes(b"*MATRIX INPUT, NAME=K, INPUT=other.mtx\n1,1,1,1,1.0\n", None, Options::default());
    assert!(elsewhere.unwrap_err().to_string().contains("parameter \"INPUT=other.mtx\" is not supported"));
}

#[test]
fn a_substructure_has_its_nodes_and_both_matrices() {
    let symmetric = read(&fixture("abaqus_substructure/symmetric_inner.mtx")).unwrap();
    let whole = read(&fixture("abaqus_substructure/unsymmetric_inner.mtx")).unwrap();
    // The mass is symmetric, and a triangle in both.
    for (file, stored) in [(&symmetric, Stored::Triangle), (&whole, Stored::Whole)] {
        assert_eq!(file.format, Format::AbaqusSubstructure);
        let (k, m) = (file.of_kind(Kind::Stiffness).unwrap(), file.of_kind(Kind::Mass).unwrap());
        assert_eq!((k.rows(), m.rows(), k.stored(), file.matrices.len()), (36, 36, stored, 2));
        let labels = names(k.row_labels());
        assert_eq!((labels[0].as_str(), labels[7].as_str(), labels[35].as_str()), ("2.x", "3.y", "7.rz"));
    }
    // The same part, written twice: equal to the rounding of the reduction.
    for (a, b) in symmetric.matrices.iter().zip(&whole.matrices) {
        let (a, b) = (a.to_dense(), b.to_dense());
        assert!((&a - &b).amax() <= 1e-14 * a.amax());
    }
    let k = symmetric.matrices[0].to_dense();
    assert_eq!(
        (k[(0, 0)], k[(1, 0)], k[(4, 2)], k[(2, 4)]),
        (291719.31783334, -5.9826575466965e-12, 158260.68254926, 158260.68254926)
    );
}

#[test]
fn a_substructure_of_another_kind_is_read_or_refused() {
    let element = |rest: &str| {
        let text = format!("**\n** GENERATION OF SUBSTRUCTURE\n*USER ELEMENT,NODES=          3,LINEAR{rest}");
        read_bytes(text.as_bytes(), None, Options::default())
    };
    // As CalculiX writes it: a node for each direction.
    let calculix = "\n** ELEMENT NODES\n**         4,         4,         9,\n         1\n         2,         2\n         3,         3\n\
                    *MATRIX,TYPE=STIFFNESS\n 1.0,\n 2.0, 3.0,\n 4.0, 5.0, 6.0,\n";
    let k = element(calculix).unwrap().only().unwrap();
    assert_eq!(names(k.row_labels()), ["4.x", "4.y", "9.z"]);
    assert_eq!(k.to_dense(), formats::nalgebra::dmatrix![1.0, 2.0, 4.0; 2.0, 3.0, 5.0; 4.0, 5.0, 6.0]);
    let unsymmetric = element(", UNSYMM\n1\n*MATRIX,TYPE=MASS\n1.0,2.0\n3.0,4.0\n").unwrap().only().unwrap();
    assert_eq!(unsymmetric.to_dense(), formats::nalgebra::dmatrix![1.0, 3.0; 2.0, 4.0]);
    assert_eq!(unsymmetric.row_labels(), None);
    let other =
        element("\n1\n*MATRIX,TYPE=STRUCTURAL DAMPING\n1.0\n*MATRIX,TYPE=MASS\n2.0\n*MATRIX,TYPE=LOAD\n1.0,7.0\n")
            .unwrap();
    assert_eq!((other.matrices.len(), other.left_out.len()), (1, 2));
    assert!(other.left_out[0].0 == "structural damping" && other.left_out[1].0 == "load", "{:?}", other.left_out);
    // Beside a stiffness that is said, as is one that is read.
    let beside = |rest: &str| {
        let wanted = Wanted { kind: Some(Kind::Stiffness), ..Wanted::default() };
        element(rest).unwrap().take(&wanted).unwrap().doubts()
    };
    let structural = "\n1\n*MATRIX,TYPE=STIFFNESS\n2.0\n*MATRIX,TYPE=STRUCTURAL DAMPING\n1.0\n";
    assert_eq!(beside(structural), [Doubt::BesideStructural]);
    assert_eq!(beside("\n1\n*MATRIX,TYPE=STIFFNESS\n2.0\n*MATRIX,TYPE=MASS\n1.0\n"), []);
    assert!(
        element("\n1\n*MATRIX,TYPE=LOAD\n1.0\n")
            .unwrap_err()
            .to_string()
            .contains("no matrix that can be read (load: ")
    );
    for (rest, part) in [
        ("\n1\n*MATRIX,TYPE=STIFFNESS\n1.0,\n2.0\n", "entries of a matrix is 2; allowed: n (n + 1) / 2"),
        (",UNSYMM\n1\n*MATRIX,TYPE=STIFFNESS\n1.0,\n2.0\n", "entries of a matrix is 2; allowed: n (n + 1) / 2 or n n"),
        ("\n1\n*MATRIX,TYPE=STIFFNESS\n", "entries of a matrix is 0"),
        ("\n1\n", "before its first matrix"),
        (
            "\n1\n*MATRIX,TYPE=MASS\n1.0\n*MATRIX,TYPE=STIFFNESS\n1.0\n2.0,1.0\n",
            "entries of a matrix is 3; allowed: n (n + 1) / 2, n = 1",
        ),
        ("\n1\n*MATRIX,TYPE=MASS\n1.0\n*USER ELEMENT,NODES=1,LINEAR\n", "number of elements"),
        ("\n1\n*MATRIX,TYPE=MASS\n1.0\n*STEP\n", "keyword \"STEP\""),
    ] {
        let message = element(rest).unwrap_err().to_string();
        assert!(message.contains(part), "{message:?} lacks {part:?}");
    }
}
