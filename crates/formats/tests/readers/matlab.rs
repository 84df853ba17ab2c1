//! MATLAB's files of versions 4, 5 and 7.

use formats::{Format, Kind, read};

use crate::{d, fixture, k, s};

#[test]
fn versions_4_5_and_7_hold_the_same_arrays() {
    for (name, format) in [("v4", Format::MatlabV4), ("v5", Format::MatlabV5), ("v7", Format::MatlabV5)] {
        let file = read(&fixture(&format!("matlab/{name}.mat"))).unwrap();
        assert_eq!(file.format, format);
        assert_eq!(file.matrix("S").unwrap().to_dense(), s(), "{name}");
        assert_eq!(file.matrix("D").unwrap().to_dense(), d(), "{name}");
        let reason = |name: &str| file.left_out.iter().find(|(n, _)| n == name).map(|(_, reason)| reason.as_str());
        assert_eq!(reason("note"), Some("text"));
        assert!(reason("z").unwrap().starts_with("complex"));
        if name != "v4" {
            assert_eq!(file.matrix("counts").unwrap().to_dense(), formats::nalgebra::dmatrix![1.0, 2.0; 3.0, 4.0]);
            assert_eq!((reason("parts"), reason("cube")), (Some("a cell array"), Some("not of two dimensions")));
        }
    }
}

#[test]
fn a_file_of_matlab_itself_is_read() {
    // Size, entries and sum of absolute values as scipy.io.loadmat gives them.
    let matrix = read(&fixture("matlab/BDLL00.mat")).unwrap().only().unwrap();
    assert_eq!((matrix.name(), matrix.rows(), matrix.columns(), matrix.entries().len()), ("BDLL", 4669, 4669, 5683));
    let sum: f64 = matrix.entries().iter().map(|entry| entry.value.abs()).sum();
    assert!((sum - 578.785_892_545_749_9).abs() < 1e-9, "{sum}");
    assert_eq!(matrix.asymmetry(), Some(0.0));
}

#[test]
fn members_of_structures_have_names_with_points() {
    for name in ["structures", "structures_compressed"] {
        let file = read(&fixture(&format!("matlab/{name}.mat"))).unwrap();
        let listed: Vec<_> = file.matrices.iter().map(|m| (m.name(), m.kind())).collect();
        let (mass, damping, stiffness) = (Some(Kind::Mass), Some(Kind::Damping), Some(Kind::Stiffness));
        let expected = [
            ("s.K", stiffness),
            ("s.M", mass),
            ("s.of.C", damping),
            ("part(1).K", stiffness),
            ("part(1).M", mass),
            ("part(2).K", stiffness),
            ("part(2).M", mass),
            ("Ms", None),
        ];
        assert_eq!(listed, expected, "{name}");
        assert_eq!(file.matrix("s.K").unwrap().to_dense(), k());
        assert_eq!(file.matrix("S.k").unwrap().to_dense(), k());
        assert_eq!(file.matrix("s.of.C").unwrap().to_dense(), k() * 0.5);
        assert_eq!(file.matrix("part(2).M").unwrap().to_dense(), formats::nalgebra::DMatrix::identity(2, 2) * 4.0);
        assert_eq!(file.matrix("Ms").unwrap().to_dense(), s());
        assert_eq!(file.of_kind(Kind::Damping).unwrap().name(), "s.of.C");
        let several = file.of_kind(Kind::Stiffness).unwrap_err().to_string();
        assert!(several.starts_with("no matrix \"stiffness\" was read (several have a name of this kind"), "{several}");
        let complex = file.matrix("Kz").unwrap_err().to_string();
        assert!(
            complex.contains("imaginary parts up to 1.4e-1; those of a stiffness are structural damping"),
            "{complex}"
        );
        let left_out: Vec<_> = file.left_out.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(left_out, ["s.title", "Kz"]);
    }
    let file = read(&fixture("matlab/v4_complex.mat")).unwrap();
    assert_eq!((file.matrix("K").unwrap().to_dense(), file.matrix("S").unwrap().to_dense()), (k(), s()));
}
