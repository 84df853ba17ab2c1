//! Every reader against files whose matrices are known.

#![allow(clippy::unwrap_used, clippy::panic)]

mod readers {
    pub mod abaqus;
    pub mod calculix;
    pub mod faults;
    pub mod harwell_boeing;
    pub mod market;
    pub mod matlab;
    pub mod mutations;
    pub mod nastran;
    pub mod numpy;
    pub mod storages;
}

use std::path::PathBuf;

use formats::nalgebra::{DMatrix, dmatrix};

/// A file of the fixtures.
fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)
}

/// S of `make.py`.
fn s() -> DMatrix<f64> {
    dmatrix![
        4.0, 0.5, 0.0, 0.0, 0.0;
        -1.0, 0.0, 0.0, 0.0, 0.0;
        0.0, 0.0, 3.0, 0.0, 0.0;
        0.0, 0.0, 0.0, 0.0, -2.5;
        0.0, 0.0, 0.0, 7.0, 0.0
    ]
}

/// D of `make.py`.
fn d() -> DMatrix<f64> {
    dmatrix![1.5, 0.0, -2.0; 0.0, 3.0, 4.0]
}

/// K of `make.py`.
fn k() -> DMatrix<f64> {
    dmatrix![
        4.0, -1.0, 0.0, 0.5;
        -1.0, 5.0, -2.0, 0.0;
        0.0, -2.0, 6.0, -3.0;
        0.5, 0.0, -3.0, 7.0
    ]
}

fn names(dofs: Option<&[formats::Dof]>) -> Vec<String> {
    dofs.unwrap_or_default().iter().map(ToString::to_string).collect()
}

/// Every text among the fixtures with each of the ends of lines that there are, and with a byte order mark.
#[test]
fn ends_of_lines_and_a_byte_order_mark_change_nothing() {
    let folders =
        std::fs::read_dir(fixture("")).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir());
    let mut seen = 0;
    for path in folders.flat_map(|folder| std::fs::read_dir(folder).unwrap()).map(|entry| entry.unwrap().path()) {
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let text = text.replace("\r\n", "\n");
        let of = |text: &str| formats::read_bytes(text.as_bytes(), None, formats::Options::default());
        let Ok(plain) = of(&text) else { continue };
        seen += 1;
        for changed in [text.replace('\n', "\r\n"), text.replace('\n', "\r"), format!("\u{feff}{text}")] {
            let found = of(&changed).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert!(found == plain, "{}", path.display());
        }
    }
    assert!(seen >= 12, "{seen}");
}
