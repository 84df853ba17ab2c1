//! Matrix Market files that can be read, and the one-line messages for files that cannot.

use formats::nalgebra::{DMatrix, dmatrix};
use formats::{FormatsError, Limits, Options, Place, Stored, read_market};

use crate::{fixture, k};

/// The largest order of these tests, as a program with full matrices would set it.
fn options() -> Options<'static> {
    Options { limits: Limits { order: 4096, ..Limits::default() }, ..Options::default() }
}

fn read(text: &str) -> Result<DMatrix<f64>, FormatsError> {
    read_market(text.as_bytes(), options()).map(|matrix| matrix.to_dense())
}

fn problem(text: &str) -> (usize, String) {
    match read(text) {
        Err(FormatsError::At { place: Place::Line(line), problem }) => (line, problem.to_string()),
        other => panic!("{other:?} for {text:?}"),
    }
}

const REAL: &str = "%%MatrixMarket matrix coordinate real general\n";

#[test]
fn reads_every_supported_kind() {
    let general = "%%MatrixMarket MATRIX Coordinate Real General\r\n% a comment\r\n\r\n2 3 4\r\n1 1 1.5e0\r\n\
                   2 3 -2D-1\r\n% another\r\n1 1 0.5\r\n1 2 +7\r\n\r\n";
    assert_eq!(read(general).unwrap(), dmatrix![2.0, 7.0, 0.0; 0.0, 0.0, -0.2]);
    let symmetric = "%%MatrixMarket matrix coordinate integer symmetric\n2 2 2\n1 1 3\n2 1 -4";
    assert_eq!(read(symmetric).unwrap(), dmatrix![3.0, -4.0; -4.0, 0.0]);
    let skew = "%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 5\n";
    assert_eq!(read(skew).unwrap(), dmatrix![0.0, -5.0; 5.0, 0.0]);
    let array = "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n";
    assert_eq!(read(array).unwrap(), dmatrix![1.0, 3.0; 2.0, 4.0]);
    let array = "%%MatrixMarket matrix array real symmetric\n2 2\n1\n2\n3\n";
    assert_eq!(read(array).unwrap(), dmatrix![1.0, 2.0; 2.0, 3.0]);
    let array = "%%MatrixMarket matrix array integer skew-symmetric\n3 3\n1\n2\n3\n";
    assert_eq!(read(array).unwrap(), dmatrix![0.0, -1.0, -2.0; 1.0, 0.0, -3.0; 2.0, 3.0, 0.0]);
    assert_eq!(read(&format!("{REAL}2 2 0\n")).unwrap(), DMatrix::zeros(2, 2));
}

/// A file that was cut inside its last number has as many entries as it says: that its last line has no end is said.
#[test]
fn a_last_line_without_an_end_is_said() {
    for (text, last) in [("2 2 2\n1 1 1.5\n2 2 2.25\n", "2.25\n"), ("2 2 1\n2 1 -125e-2\n", "125e-2\n")] {
        let whole = format!("{REAL}{text}");
        let doubts = |text: &str| read_market(text.as_bytes(), options()).unwrap().doubts();
        assert_eq!(doubts(&whole), []);
        // Whatever of the last number is left is a number, or refused.
        for cut in 1..last.len() {
            let text = &whole[..whole.len() - cut];
            if read(text).is_ok() {
                assert_eq!(doubts(text), [formats::Doubt::NoEnd], "{text}");
            }
        }
    }
}

#[test]
fn says_in_one_line_what_is_wrong_and_what_is_allowed() {
    let body = |rest: &str| problem(&format!("{REAL}{rest}"));
    let cases = [
        (problem(""), 1, "empty"),
        (problem("\n \n"), 2, "empty"),
        (problem("hello\n1 1 1\n"), 1, "not a Matrix Market banner"),
        (problem("1,1, 2.5e+03\n1,2, 7\n"), 1, "Abaqus"),
        (problem("1  1  2.5e+03\n"), 1, "Abaqus"),
        (problem("** ABAQUS\n*MATRIX, TYPE=MASS\n"), 1, "Abaqus"),
        (problem("%%MatrixMarket vector coordinate real general\n"), 1, "allowed: matrix"),
        (
            problem("%%MatrixMarket matrix coordinate complex256 general\n"),
            1,
            "\"complex256\" is not supported; allowed: real",
        ),
        (problem("%%MatrixMarket matrix coordinate pattern general\n"), 1, "allowed: real, integer"),
        (problem("%%MatrixMarket matrix coordinate real hermitian\n"), 1, "allowed: general, symmetric"),
        (problem("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1.0\n"), 3, "real part, imaginary part"),
        (problem("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 0.5\n"), 3, "structural damping"),
        (problem("%%MatrixMarket matrix array complex general\n1 1\n1\n"), 3, "two values a line"),
        (problem("%%MatrixMarket matrix array complex general\n1 1\n1 0 0\n"), 3, "two values a line"),
        (problem("%%MatrixMarket matrix coordinate real\n"), 1, "symmetry"),
        (problem("%%MatrixMarket matrix coordinate real general extra\n"), 1, "not a Matrix Market banner"),
        (problem("%%MatrixMarket matrix array real general\n2 2 4\n"), 2, "rows, columns"),
        (problem("%%MatrixMarket matrix array real general\n1 2\n1 2\n"), 3, "one value a line"),
        (problem("%%MatrixMarket matrix array real symmetric\n2 3\n"), 2, "must be square"),
        (problem("%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 2 1\n"), 3, "on or below"),
        (problem("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n1 1 0\n"), 3, "below the diagonal"),
        (problem("%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5\n"), 3, "an integer"),
        (body(""), 1, "before the line with the size"),
        (body("2 2\n"), 2, "rows, columns, entries"),
        (body("0 0 0\n"), 2, "allowed: 1 to 4096"),
        (body("1000000000 1000000000 1\n"), 2, "allowed: 1 to 4096"),
        (body("99999999999999999999999 1 1\n"), 2, "whole number"),
        (body("-1 1 1\n"), 2, "whole number"),
        (body("1 1 18446744073709551615\n1 1 1\n"), 3, "ends after 1 of"),
        (body("2 2 2\n1 1 1.0\n"), 3, "ends after 1 of 2"),
        (body("2 2 1\n1 1 1.0\n2 2 1.0\n"), 4, "after the last of 1"),
        (body("2 2 1\n3 1 1.0\n"), 3, "row 3; allowed: 1 to 2"),
        (body("2 2 1\n1 0 1.0\n"), 3, "column 0; allowed: 1 to 2"),
        (body("2 2 1\n1 1\n"), 3, "row, column, value"),
        (body("2 2 1\n1 1 1.0 2.0\n"), 3, "4 fields"),
        (body("2 2 1\n1 1 abc\n"), 3, "\"abc\" is not a number"),
        (body("2 2 1\n1 1 NaN\n"), 3, "finite"),
        (body("2 2 1\n1 1 -inf\n"), 3, "finite"),
        (body("2 2 1\n1 1 1e999\n"), 3, "finite"),
        (body("1 1 2\n1 1 1.7e308\n1 1 1.7e308\n"), 4, "the sum at (1, 1)"),
    ];
    for ((line, message), at, part) in cases {
        assert_eq!(line, at, "{message}");
        assert!(message.contains(part) && !message.contains('\n'), "{message:?} lacks {part:?}");
    }
    let binary = read_market(b"%%MatrixMarket \x00\xfe\n", options()).unwrap_err();
    assert_eq!(binary.to_string(), "line 1: not a text file: a zero byte; allowed: text in UTF-8 or Latin-1");
    let long = problem(&"x".repeat(10_000)).1;
    assert!(long.len() < 300);
}

#[test]
fn a_compressed_file_is_read_as_it_is() {
    let file = formats::read(&fixture("market/symmetric.mtx.gz")).unwrap();
    assert_eq!(file.format, formats::Format::MatrixMarket);
    let matrix = file.only().unwrap();
    assert_eq!((matrix.to_dense(), matrix.stored()), (k(), Stored::Triangle));
    let bytes = std::fs::read(fixture("market/symmetric.mtx.gz")).unwrap();
    assert_eq!(read_market(&bytes, options()).unwrap().to_dense(), k());
    let half = read_market(&bytes[..bytes.len() / 2], options()).unwrap_err().to_string();
    assert!(half.contains("cannot be read") || half.contains("ends"), "{half}");
}

#[test]
fn what_is_written_is_read_again() {
    // Numbers of all magnitudes, with every bit.
    let matrix = DMatrix::from_fn(3, 4, |i, j| (1.0 + (i as f64).sqrt()) * 10_f64.powi(50 * (2 * j as i32 - 3)) / 3.0);
    let mut text = format!("{REAL}3 4 12\n");
    for j in 0..4 {
        for i in 0..3 {
            text += &format!("{} {} {:e}\n", i + 1, j + 1, matrix[(i, j)]);
        }
    }
    assert_eq!(read(&text).unwrap(), matrix);
}
