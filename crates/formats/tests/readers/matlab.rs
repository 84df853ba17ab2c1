//! MATLAB's files of versions 4, 5 and 7.

use formats::{Format, read};

use crate::{d, fixture, s};

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
