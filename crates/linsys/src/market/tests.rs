//! Files that can be read, and the one-line messages for files that cannot.

use super::*;
use nalgebra::dmatrix;
use proptest::prelude::*;

fn read(text: &str) -> Result<DMatrix<f64>, LinsysError> {
    read_market(text.as_bytes())
}

fn problem(text: &str) -> (usize, String) {
    match read(text) {
        Err(LinsysError::Market { line, problem }) => (line, problem.to_string()),
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

#[test]
fn says_in_one_line_what_is_wrong_and_what_is_allowed() {
    let body = |rest: &str| problem(&format!("{REAL}{rest}"));
    let cases = [
        (problem(""), 1, "empty"),
        (problem("\n \n"), 3, "empty"),
        (problem("hello\n1 1 1\n"), 1, "not a Matrix Market banner"),
        (problem("1,1, 2.5e+03\n1,2, 7\n"), 1, "Abaqus"),
        (problem("1  1  2.5e+03\n"), 1, "Abaqus"),
        (problem("** ABAQUS\n*MATRIX, TYPE=MASS\n"), 1, "Abaqus"),
        (problem("%%MatrixMarket vector coordinate real general\n"), 1, "allowed: matrix"),
        (
            problem("%%MatrixMarket matrix coordinate complex general\n"),
            1,
            "\"complex\" is not supported; allowed: real",
        ),
        (problem("%%MatrixMarket matrix coordinate pattern general\n"), 1, "allowed: real, integer"),
        (problem("%%MatrixMarket matrix coordinate real hermitian\n"), 1, "allowed: general, symmetric"),
        (problem("%%MatrixMarket matrix coordinate real\n"), 1, "symmetry"),
        (problem("%%MatrixMarket matrix coordinate real general extra\n"), 1, "not a Matrix Market banner"),
        (problem("%%MatrixMarket matrix array real general\n2 2 4\n"), 2, "rows, columns"),
        (problem("%%MatrixMarket matrix array real general\n1 2\n1 2\n"), 3, "one value a line"),
        (problem("%%MatrixMarket matrix array real symmetric\n2 3\n"), 2, "must be square"),
        (problem("%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 2 1\n"), 3, "on or below"),
        (problem("%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n1 1 0\n"), 3, "below the diagonal"),
        (problem("%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5\n"), 3, "an integer"),
        (body(""), 2, "before the line with the size"),
        (body("2 2\n"), 2, "rows, columns, entries"),
        (body("0 0 0\n"), 2, "allowed: 1 to 4096"),
        (body("1000000000 1000000000 1\n"), 2, "allowed: 1 to 4096"),
        (body("99999999999999999999999 1 1\n"), 2, "whole number"),
        (body("-1 1 1\n"), 2, "whole number"),
        (body("1 1 18446744073709551615\n1 1 1\n"), 4, "ends after 1 of"),
        (body("2 2 2\n1 1 1.0\n"), 4, "ends after 1 of 2"),
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
    let binary = read_market(b"%%MatrixMarket \xff\xfe\n").unwrap_err();
    assert_eq!(binary.to_string(), "line 1: not a text file");
    let long = problem(&"x".repeat(10_000)).1;
    assert!(long.len() < 300);
}

proptest! {
    #[test]
    fn what_is_written_is_read_again(values in prop::collection::vec(prop::num::f64::NORMAL, 12)) {
        let matrix = DMatrix::from_vec(3, 4, values);
        let mut text = format!("{REAL}3 4 12\n");
        for j in 0..4 {
            for i in 0..3 {
                text += &format!("{} {} {:e}\n", i + 1, j + 1, matrix[(i, j)]);
            }
        }
        prop_assert_eq!(read(&text).unwrap(), matrix);
    }

    #[test]
    fn no_text_makes_it_panic(text in "[%MatrixMket corinaelgsymdu\n\r\t0-9.,eED+*-]{0,200}", tail in ".{0,40}") {
        let _ = read(&text);
        let _ = read(&format!("{REAL}{text}{tail}"));
    }
}
