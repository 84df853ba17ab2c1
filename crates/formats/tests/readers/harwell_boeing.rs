//! Harwell-Boeing files; those of the tests of every storage are made there.

use formats::{Format, Options, read, read_bytes};

use crate::{fixture, s};

#[test]
fn what_scipy_writes_is_read() {
    let file = read(&fixture("harwell_boeing/unsymmetric.rua")).unwrap();
    assert_eq!((file.format, file.only().unwrap().to_dense()), (Format::HarwellBoeing, s()));
}

#[test]
fn faults_are_named() {
    let text = std::fs::read_to_string(fixture("harwell_boeing/unsymmetric.rua")).unwrap();
    for (from, to, part) in [
        ("-2.5000000000000000E+00\n", "", "2 fields where a line of numbers is expected"),
        (" 1 3 4 5 6 7", " 1 3 4 5 6 8", "offset of a column 8; allowed: 1 to 7"),
        (" 1 3 4 5 6 7", " 1 3 4 6 5 7", "offsets of columns is 1 to 7; allowed: growing from 1 to 7"),
        (" 1 2 1 3 5 4", " 1 2 1 3 6 4", "row 6; allowed: 1 to 5"),
        (" 1 2 1 3 5 4", " 1 2 1 3 5", "5 fields where a line of numbers is expected"),
        ("(3E25.16)", "(3X25.16)", "the formats of numbers"),
        ("7.0000000000000000E+00", "7.00000000000000x0E+00", "is not a number"),
        ("RUA", "RSA", "gives both"),
    ] {
        assert!(text.contains(from), "{from:?}");
        let message = read_bytes(text.replace(from, to).as_bytes(), None, Options::default()).unwrap_err().to_string();
        assert!(message.contains(part) && !message.contains('\n'), "{message:?} lacks {part:?}");
    }
}
