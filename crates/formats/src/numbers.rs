//! Numbers in text.

use crate::problem::Problem;
use crate::shortened::cut;

/// A finite number, with the E of C or the D of Fortran.
pub(crate) fn value(field: &str) -> Result<f64, Problem> {
    let bad = |allowed| Problem::Value { found: cut(field), allowed };
    let value: f64 = match field.parse() {
        Ok(value) => value,
        Err(_) => field.replace(['D', 'd'], "e").parse().map_err(|_| bad("a number"))?,
    };
    if value.is_finite() { Ok(value) } else { Err(bad("a finite number")) }
}

/// [`value`], also as Fortran and Nastran write it without a letter: `2.5-10`, and `1.234567-105` for three digits.
pub(crate) fn fortran(field: &str) -> Result<f64, Problem> {
    let sign = field.bytes().enumerate().skip(1).rfind(|(_, b)| matches!(b, b'+' | b'-')).map(|(at, _)| at);
    match sign {
        Some(at) if field.as_bytes()[at - 1].is_ascii_digit() || field.as_bytes()[at - 1] == b'.' => {
            value(&format!("{}e{}", &field[..at], &field[at..]))
                .map_err(|_| Problem::Value { found: cut(field), allowed: "a number" })
        }
        _ => value(field),
    }
}

/// A whole number that is not negative.
pub(crate) fn whole(what: &'static str, field: &str) -> Result<usize, Problem> {
    field.parse().map_err(|_| Problem::NotWhole { what, found: cut(field) })
}

/// A whole number with a sign.
pub(crate) fn signed(what: &'static str, field: &str) -> Result<i64, Problem> {
    field.parse().map_err(|_| Problem::NotWhole { what, found: cut(field) })
}

/// An index from 1 in the file, from 0 here.
pub(crate) fn index(what: &'static str, field: &str, largest: usize) -> Result<usize, Problem> {
    match whole(what, field)? {
        found if (1..=largest).contains(&found) => Ok(found - 1),
        found => Err(Problem::Index { what, found, largest }),
    }
}

/// A number of rows or columns.
pub(crate) fn order(what: &'static str, found: usize, largest: usize) -> Result<usize, Problem> {
    if (1..=largest).contains(&found) { Ok(found) } else { Err(Problem::Size { what, found, largest }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_to_write_a_number() {
        for (text, number) in
            [("1.5", 1.5), ("-2D-1", -0.2), ("1.000000000D+00", 1.0), ("2.5-10", 2.5e-10), ("-3.+3", -3e3), (".5", 0.5)]
        {
            assert_eq!(fortran(text), Ok(number), "{text}");
        }
        assert_eq!(fortran("-.12345-105"), Ok(-0.12345e-105));
        for text in ["", "-", "+-1", "1-", "x", "nan", "inf", "1e999", "1+400", "1 2"] {
            assert!(fortran(text).is_err(), "{text}");
        }
        assert!(value("2.5-10").is_err());
    }
}
