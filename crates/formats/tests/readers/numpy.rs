//! NumPy's arrays and SciPy's sparse matrices.

use formats::{Format, read};

use crate::{d, fixture, k, s};

#[test]
fn the_sparse_forms_of_scipy_hold_the_same_matrix() {
    for name in ["csr", "csc", "coo", "dia", "dia_by_columns", "complex", "pydata_coo", "pydata_rows", "pydata_columns"]
    {
        let file = read(&fixture(&format!("numpy/{name}.npz"))).unwrap();
        assert_eq!(file.format, Format::Npz);
        let matrix = file.only().unwrap();
        assert_eq!((matrix.to_dense(), matrix.entries().len()), (s(), 6), "{name}");
    }
    let block = formats::nalgebra::dmatrix![1.0, 2.0; 0.0, 1.0];
    assert_eq!(read(&fixture("numpy/bsr.npz")).unwrap().only().unwrap().to_dense(), s().kronecker(&block));
}

#[test]
fn full_arrays_are_read_in_either_order() {
    for name in ["dense", "big_endian"] {
        assert_eq!(read(&fixture(&format!("numpy/{name}.npy"))).unwrap().only().unwrap().to_dense(), d(), "{name}");
    }
    let file = read(&fixture("numpy/several.npz")).unwrap();
    assert_eq!((file.matrix("D").unwrap().to_dense(), file.matrix("K").unwrap().to_dense()), (d(), k()));
    assert_eq!(file.left_out.len(), 2);
    let message = file.only().unwrap_err().to_string();
    assert_eq!(message, "the file holds 2 matrices; say which: D, K");
}
