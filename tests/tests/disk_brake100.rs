//! The components of disk_brake100 in `cases/` are the published problem.

use std::path::{Path, PathBuf};

use nalgebra::DMatrix;
use squeal::case::{CaseFile, MatricesCase};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn case(name: &str) -> MatricesCase {
    match CaseFile::read(&root().join("cases").join(name)).unwrap() {
        CaseFile::Matrices(case) => *case,
        CaseFile::Lattice(case) => panic!("{case:?}"),
    }
}

fn published(matrix: &str) -> DMatrix<f64> {
    let path = root().join("tests/fixtures/hard/disk_brake100_w4pi").join(matrix);
    linsys::read_market(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn components_make_the_published_matrices() {
    let case = case("disk-brake100.toml");
    let values: Vec<f64> = case
        .parameters
        .iter()
        .map(|parameter| match parameter.name.as_str() {
            "w" => 4.0 * std::f64::consts::PI,
            "friction" => 1.0,
            other => panic!("{other}"),
        })
        .collect();
    let system = case.system.assemble(&case.operating_point(&values).unwrap()).unwrap();
    for (ours, file) in [(&system.m, "M.mtx"), (&system.c, "C.mtx"), (&system.k, "K.mtx")] {
        let theirs = published(file);
        let rounding = 2.0 * f64::EPSILON * theirs.amax();
        assert!((ours - &theirs).amax() <= rounding, "{file}: {:e}", (ours - &theirs).amax());
    }
    assert_eq!(case.system.families(), ["structure", "dashpots", "gyroscopic", "friction"]);
    assert_eq!(case.bodies.iter().map(|body| body.dofs.len()).sum::<usize>(), 100);
}
