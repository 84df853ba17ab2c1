//! Harwell-Boeing files and their successor Rutherford-Boeing: compressed columns in lines of a fixed format, as Ansys's `HBMAT`
//! and SciPy's `hb_write` write them (Duff, Grimes and Lewis, User's Guide for the Harwell-Boeing Sparse Matrix Collection, 1992).
//!
//! Four lines of header: a title; how many lines each part has; a type of three letters with rows, columns and entries; the formats of
//! Fortran. Types: R real, I integer, C complex (read where all imaginary parts are 0), P a pattern without values; S symmetric
//! (one triangle), U unsymmetric, H Hermitian, Z skew, R rectangular; A assembled, E by elements.

use crate::builder::{Builder, Found, Head, Stated};
use crate::limits::Limits;
use crate::lines::Lines;
use crate::numbers::{fortran, order, whole};
use crate::problem::Problem;
use crate::shortened::cut;

/// Most columns of a line; chosen: lines have 80, some a few more.
const MOST_ON_LINE: usize = 400;
/// Most numbers for which there is room before they are read, whatever a header promises. Chosen: room for more is made as
/// numbers come, so that a false header costs 8 MB at most.
const MADE_ROOM_FOR: usize = 1 << 20;

/// Type of the matrix, from the third line of a file.
struct Type {
    field: u8,
    symmetry: u8,
    assembled: bool,
}

impl Type {
    fn of(word: &str) -> Option<Self> {
        let upper = word.to_uppercase();
        let &[field, symmetry, kind] = upper.as_bytes() else { return None };
        let known = b"RCPIQ".contains(&field) && b"SUHZR".contains(&symmetry) && b"AE".contains(&kind);
        known.then_some(Self { field, symmetry, assembled: kind == b'A' })
    }
}

/// True if a file begins with a header of this format.
pub(crate) fn is_header(text: &str) -> bool {
    let mut lines = text.lines().skip(1);
    let wholes = |line: &str| line.split_ascii_whitespace().all(|word| word.parse::<u64>().is_ok());
    let (Some(counts), Some(kind), Some(formats)) = (lines.next(), lines.next(), lines.next()) else { return false };
    let mut words = kind.split_ascii_whitespace();
    let is_type = words.next().and_then(Type::of).is_some();
    let sizes: Vec<&str> = words.collect();
    !counts.trim().is_empty()
        && wholes(counts)
        && is_type
        && sizes.len() >= 3
        && wholes(&sizes.join(" "))
        && formats.trim_start().starts_with('(')
}

/// Reads the matrix.
pub(crate) fn parse(lines: &mut Lines<'_>, limits: &Limits) -> Result<Found, Problem> {
    let mut line =
        || -> Result<String, Problem> { Ok(lines.next()?.ok_or(Problem::End { what: "the header" })?.to_owned()) };
    line()?;
    let counts = line()?;
    let third = line()?;
    let fourth = line()?;
    let mut words = third.split_ascii_whitespace();
    let word = words.next().unwrap_or_default();
    let refused = |allowed| Problem::Keyword { what: "matrix type", found: cut(word), allowed };
    let kind = Type::of(word).ok_or_else(|| refused("RSA, RUA, RZA, RRA and their like"))?;
    match (kind.field, kind.assembled) {
        (b'P' | b'Q', _) => return Err(refused("real values, as RSA or RUA; this is a pattern without values")),
        (_, false) => return Err(refused("assembled matrices, as RSA or RUA; this is one by elements")),
        _ => {}
    }
    let mut number = |what| whole(what, words.next().unwrap_or_default());
    let rows = order("number of rows", number("number of rows")?, limits.order)?;
    let columns = order("number of columns", number("number of columns")?, limits.order)?;
    let entries = number("number of entries")?;
    if entries > limits.entries {
        return Err(Problem::Limit { what: "entries of a matrix", most: limits.entries as u64 });
    }
    let stated = match kind.symmetry {
        b'S' | b'H' => Stated::Symmetric,
        b'Z' => Stated::Skew,
        _ => Stated::General,
    };
    if stated != Stated::General && rows != columns {
        return Err(Problem::NotSquare { symmetry: "symmetric", rows, columns });
    }
    let formats = formats(&fourth)?;
    // A fifth line belongs to right hand sides.
    if counts.split_ascii_whitespace().nth(4).is_some_and(|lines| lines != "0") {
        line()?;
    }
    let offsets = indices(lines, (columns + 1, formats[0]), ("offset of a column", entries + 1))?;
    let growing = offsets.windows(2).all(|pair| pair[0] <= pair[1]);
    if !growing || offsets.first() != Some(&0) || offsets.last() != Some(&entries) {
        let found = format!("{} to {}", offsets.first().map_or(0, |at| at + 1), offsets.last().map_or(0, |at| at + 1));
        return Err(Problem::field("offsets of columns", found, format!("growing from 1 to {}", entries + 1)));
    }
    let places = indices(lines, (entries, formats[1]), ("row", rows))?;
    let mut builder = Builder::new(limits);
    let mut column = 0;
    let parts = if kind.field == b'C' { 2 } else { 1 };
    numbers(lines, (entries * parts, formats[2]), |at, text| {
        let value = formats[2].value(text)?;
        if at % parts == 1 {
            return builder.note_imaginary(value);
        }
        while offsets[column + 1] <= at / parts {
            column += 1;
        }
        builder.push(places[at / parts], column, value)
    })?;
    let mut found = Found::default();
    found.keep("matrix", builder.finish(stated, Head::unlabelled("matrix", None, (rows, columns))))?;
    Ok(found)
}

/// Most digits behind a point; chosen: numbers have no more.
const MOST_DECIMALS: i32 = 99;

/// Layout of numbers in Fortran.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Format {
    /// Numbers on a line, and characters of each.
    per_line: usize,
    width: usize,
    /// Digits behind the point of a number that is written without one.
    decimals: i32,
    /// Power of ten by which a number without an exponent is written too large.
    scale: i32,
}

impl Format {
    /// The number of a field.
    fn value(self, field: &str) -> Result<f64, Problem> {
        let text = field.to_uppercase().replace('D', "E");
        let sign = text.char_indices().skip(1).find(|(_, letter)| matches!(letter, '+' | '-')).map(|(at, _)| at);
        let (mantissa, exponent) = match (text.split_once('E'), sign) {
            (Some((mantissa, exponent)), _) => (mantissa, Some(exponent)),
            (None, Some(at)) => (&text[..at], Some(&text[at..])),
            (None, None) => (text.as_str(), None),
        };
        let decimals = if mantissa.contains('.') { 0 } else { self.decimals };
        let shift = decimals + if exponent.is_none() { self.scale } else { 0 };
        let exponent = exponent.map_or(Some(0), |exponent| exponent.trim_start_matches('+').parse::<i32>().ok());
        match (shift, exponent) {
            (0, _) | (_, None) => fortran(field),
            (_, Some(exponent)) => fortran(&format!("{mantissa}E{}", exponent.saturating_sub(shift))),
        }
    }
}

/// The formats of offsets, rows and values.
fn formats(line: &str) -> Result<[Format; 3], Problem> {
    let bad = || Problem::field("the formats of numbers", cut(line), "those of Fortran, as (10I8) (10I8) (4E20.12)");
    let mut all = line.split('(').skip(1).map(|format| format.split(')').next().and_then(format_of));
    let mut next = || all.next().flatten().ok_or_else(bad);
    Ok([next()?, next()?, next()?])
}

/// Layout of a Fortran format: `16I5`, `1P,3D25.16`, `1P4E20.12E3` and their like.
fn format_of(text: &str) -> Option<Format> {
    let text = text.to_uppercase().replace(' ', "");
    let (scale, text) = match text.split_once('P') {
        Some((scale, rest)) => (scale.parse().ok()?, rest.trim_start_matches(',').to_owned()),
        None => (0, text),
    };
    let letter = text.find(['I', 'E', 'D', 'F', 'G'])?;
    let count = if letter == 0 { 1 } else { text[..letter].parse().ok()? };
    let mut parts = text[letter + 1..].split('.');
    let width = parts.next()?.parse().ok()?;
    let decimals = match parts.next() {
        Some(digits) => digits.split('E').next()?.parse().ok().filter(|digits| (0..=MOST_DECIMALS).contains(digits))?,
        None => 0,
    };
    let is_whole = text[letter..].starts_with('I');
    let (decimals, scale) = if is_whole { (0, 0) } else { (decimals, scale) };
    (count > 0 && width > 0 && count * width <= MOST_ON_LINE).then_some(Format {
        per_line: count,
        width,
        decimals,
        scale,
    })
}

/// Calls `take` with the index and text of each of `count` numbers, in lines of a format.
fn numbers(
    lines: &mut Lines<'_>,
    (count, Format { per_line, width, .. }): (usize, Format),
    mut take: impl FnMut(usize, &str) -> Result<(), Problem>,
) -> Result<(), Problem> {
    let mut at = 0;
    while at < count {
        let line = lines.next()?.ok_or(Problem::Truncated { found: at, expected: count })?;
        if !line.is_ascii() {
            return Err(Problem::field("a line of numbers", cut(line), "ASCII"));
        }
        let on_line = per_line.min(count - at);
        // SciPy writes narrower fields than its format says. Where blanks divide as many as there should be, they divide.
        let apart = line.split_ascii_whitespace().count() == on_line;
        let mut words = line.split_ascii_whitespace();
        for place in 0..on_line {
            let (from, to) = (place * width, (place * width + width).min(line.len()));
            let field = if apart { words.next() } else { line.get(from..to).map(str::trim) };
            let Some(field) = field.filter(|field| !field.is_empty()) else {
                let allowed = "as many numbers as its format says";
                return Err(Problem::Fields { what: "a line of numbers", found: place, allowed });
            };
            take(at + place, field)?;
        }
        at += on_line;
    }
    Ok(())
}

/// Numbers from 1 in the file, from 0 here.
fn indices(
    lines: &mut Lines<'_>,
    given: (usize, Format),
    (what, largest): (&'static str, usize),
) -> Result<Vec<usize>, Problem> {
    let mut all = Vec::with_capacity(given.0.min(MADE_ROOM_FOR));
    numbers(lines, given, |_, text| {
        all.push(crate::numbers::index(what, text, largest)?);
        Ok(())
    })?;
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_of_fortran_are_understood() {
        for (text, format) in [
            ("16I5", Some((16, 5, 0, 0))),
            ("1P,3D25.16", Some((3, 25, 16, 1))),
            ("1P4E20.12", Some((4, 20, 12, 1))),
            ("3(E26.18)", None),
            ("E25.16E3", Some((1, 25, 16, 0))),
            ("5 F 16.8", Some((5, 16, 8, 0))),
            ("-2P,4F12.4", Some((4, 12, 4, -2))),
            ("I8", Some((1, 8, 0, 0))),
        ] {
            let found =
                format_of(text).map(|Format { per_line, width, decimals, scale }| (per_line, width, decimals, scale));
            assert_eq!(found, format, "{text}");
        }
    }

    /// By the rules of Fortran 2018, 13.7.2.3.2 and 13.8.5: a point that is not there stands before the last digits, a scale factor counts where there is no
    /// exponent.
    #[test]
    fn numbers_are_read_as_fortran_reads_them() {
        for (format, text, expected) in [
            ("4F12.4", "40000", 4.0),
            ("4F12.4", "4.0000", 4.0),
            ("4F12.4", "-12345", -1.2345),
            ("2P,4F12.4", "400.0000", 4.0),
            ("2P,4F12.4", "40000", 0.04),
            ("1P,4E12.4", "4.0E+00", 4.0),
            ("1P,4E12.4", "4.0+1", 40.0),
            ("4E12.4", "40000D1", 40.0),
            ("4E12.4", "-1.5D-2", -0.015),
            ("4E12.4", "15-2", 1.5e-5),
        ] {
            let found = format_of(format).unwrap().value(text).unwrap();
            assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{format} {text}: {found}");
        }
        assert!(format_of("4F12.4").unwrap().value("x").is_err());
    }
}
