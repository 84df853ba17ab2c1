//! What several tests begin with.

use std::path::Path;

use brakes::case::LatticeCase;

/// A case of `cases/` with some of its text replaced.
pub fn case(name: &str, changes: &[(&str, &str)]) -> LatticeCase {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name);
    let mut text = std::fs::read_to_string(&path).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "the case has no {from:?}");
        text = text.replacen(from, to, 1);
    }
    LatticeCase::parse(&path, text).unwrap()
}
