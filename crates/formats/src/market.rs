//! Matrix Market files (`.mtx`), the exchange format of NIST: <https://math.nist.gov/MatrixMarket/formats.html>.
//!
//! The reader takes the formats `coordinate` and `array`; the fields `real`, `integer` and `unsigned-integer`, and `complex` where all imaginary parts
//! are 0; the symmetries `general`, `symmetric` and `skew-symmetric`, and `hermitian` of a complex file. The field `pattern` is refused.
//! Repeated entries of a coordinate file are added up, as in finite element assembly. A symmetric file lists the lower
//! triangle with the diagonal, a skew-symmetric file the lower triangle without it. Comments and blank lines may stand
//! anywhere, also before the banner; keywords may be in any case, exponents may have the D of Fortran.

use crate::builder::{Builder, Head, Stated};
use crate::detect::is_banner;
use crate::error::FormatsError;
use crate::limits::{Limits, Options};
use crate::lines::Lines;
use crate::matrix::Matrix;
use crate::numbers::{index, order, value, whole};
use crate::problem::Problem;
use crate::shortened::cut;

/// Kind of the numbers of a file: the word *field* of its banner.
#[derive(Clone, Copy, PartialEq)]
enum Field {
    Real,
    Integer,
    Unsigned,
    Complex,
}

/// The banner: what the first line of a file declares.
struct Banner {
    /// True for the format `coordinate`, false for `array`.
    coordinate: bool,
    field: Field,
    symmetry: Stated,
}

/// The matrix in a Matrix Market file whose contents are at hand, compressed by gzip or not.
///
/// ```
/// let text = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2.0\n2 1 -1.0\n2 2 2.0\n";
/// let k = formats::read_market(text.as_bytes(), formats::Options::default())?;
/// assert_eq!(k.to_dense(), nalgebra::dmatrix![2.0, -1.0; -1.0, 2.0]);
/// # Ok::<(), formats::FormatsError>(())
/// ```
///
/// # Errors
/// [`FormatsError::At`] with the number of the line and the problem; also where the bytes are a matrix of another format.
pub fn read_market(bytes: &[u8], options: Options<'_>) -> Result<Matrix, FormatsError> {
    let limits = options.limits.bounded();
    let contents = crate::source::Contents::new(bytes, bytes.len() as u64, &limits, options.progress)?;
    let mut lines = Lines::new(contents.whole());
    parse(&mut lines, &limits).map_err(|problem| lines.located(problem))
}

/// The matrix of the lines of a file.
///
/// # Errors
/// What is wrong in the line last read.
pub(crate) fn parse(lines: &mut Lines<'_>, limits: &Limits) -> Result<Matrix, Problem> {
    let banner = loop {
        let first = lines.next()?.ok_or(Problem::Empty)?.trim();
        let is_comment = first.starts_with('%') && !is_banner(first);
        if !first.is_empty() && !is_comment {
            break read_banner(first)?;
        }
    };
    let size = lines.next_but("%")?.ok_or(Problem::NoSize)?;
    let (rows, columns, entries) = read_size(size, &banner, limits.order)?;
    let mut builder = Builder::new(limits);
    let mut place = first_place(banner.symmetry);
    for found in 0..entries {
        let line = lines.next_but("%")?.ok_or(Problem::Truncated { found, expected: entries })?;
        let mut fields = line.split_ascii_whitespace();
        let is_complex = banner.field == Field::Complex;
        let (i, j) = if banner.coordinate {
            let count = line.split_ascii_whitespace().count();
            let allowed = if is_complex { "row, column, real part, imaginary part" } else { "row, column, value" };
            let what = || Problem::Fields { what: "an entry", found: count, allowed };
            if count != if is_complex { 4 } else { 3 } {
                return Err(what());
            }
            let row = index("row", fields.next().ok_or_else(what)?, rows)?;
            (row, index("column", fields.next().ok_or_else(what)?, columns)?)
        } else {
            place
        };
        let (field, imaginary) = match ([(); 3].map(|()| fields.next()), is_complex) {
            ([Some(real), None, _], false) => (real, None),
            ([Some(real), Some(imaginary), None], true) => (real, Some(imaginary)),
            _ => {
                let found = line.split_ascii_whitespace().count();
                let allowed = if is_complex { "two values a line, real and imaginary" } else { "one value a line" };
                return Err(Problem::Fields { what: "an entry", found, allowed });
            }
        };
        let number = match banner.field {
            Field::Real | Field::Complex => value(field)?,
            Field::Integer => integer::<i64>(field).map(|number| number as f64)?,
            Field::Unsigned => integer::<u64>(field).map(|number| number as f64)?,
        };
        if let Some(imaginary) = imaginary {
            builder.note_imaginary(value(imaginary)?)?;
        }
        check_triangle(i, j, banner.symmetry)?;
        // A zero that a coordinate file lists is part of the pattern; an array lists all its zeros.
        if banner.coordinate || number != 0.0 {
            builder.push(i, j, number)?;
        }
        if !banner.coordinate {
            place = next_place(place, rows, banner.symmetry);
        }
    }
    if lines.next_but("%")?.is_some() {
        return Err(Problem::TooMany { expected: entries });
    }
    let matrix = builder.finish(banner.symmetry, Head::unlabelled("matrix", None, (rows, columns)))?;
    // A file with a count of entries shows that none is missing, but not that its last number is whole.
    Ok(Matrix { ended: lines.check_end().is_ok(), ..matrix })
}

/// First (row, column) of an array, from 0: the first entry of the first column that it lists.
fn first_place(symmetry: Stated) -> (usize, usize) {
    (usize::from(symmetry == Stated::Skew), 0)
}

/// The (row, column) after `(i, j)` in an array, which goes down its columns.
fn next_place((i, j): (usize, usize), rows: usize, symmetry: Stated) -> (usize, usize) {
    match symmetry {
        _ if i + 1 < rows => (i + 1, j),
        Stated::Symmetric => (j + 1, j + 1),
        Stated::Skew => (j + 2, j + 1),
        _ => (0, j + 1),
    }
}

/// The banner in a line.
///
/// # Errors
/// The word that is not among those allowed; of a line without `%%MatrixMarket` whether it looks like a file of Abaqus, whose lines are keywords or lists of
/// numbers.
fn read_banner(line: &str) -> Result<Banner, Problem> {
    let lower = line.to_lowercase();
    let mut words = lower.split_ascii_whitespace();
    if words.next() != Some("%%matrixmarket") {
        let numbers = line.split([',', ' ', '\t', ';']).filter(|f| !f.is_empty());
        let abaqus = numbers.clone().count() >= 2 && numbers.clone().all(|f| f.parse::<f64>().is_ok());
        let found = cut(line);
        let keyword = line.starts_with('*');
        return Err(if abaqus || keyword { Problem::Abaqus { found } } else { Problem::Banner { found } });
    }
    // The place of the next word in the list `allowed`, which the message shows as it is.
    let mut keyword = |what: &'static str, allowed: &'static str| {
        let found = cut(words.next().unwrap_or_default());
        match allowed.split(", ").position(|word| word == found) {
            Some(at) => Ok(at),
            None => Err(Problem::Keyword { what, found, allowed }),
        }
    };
    keyword("object", "matrix")?;
    let coordinate = keyword("format", "coordinate, array")? == 0;
    let field = match keyword("field", "real, integer, unsigned-integer, complex")? {
        0 => Field::Real,
        1 => Field::Integer,
        2 => Field::Unsigned,
        _ => Field::Complex,
    };
    // A Hermitian matrix whose imaginary parts are 0 is symmetric.
    let symmetries = match field {
        Field::Complex => "general, symmetric, skew-symmetric, hermitian",
        _ => "general, symmetric, skew-symmetric",
    };
    let symmetry = match keyword("symmetry", symmetries)? {
        0 => Stated::General,
        2 => Stated::Skew,
        _ => Stated::Symmetric,
    };
    if words.next().is_some() {
        return Err(Problem::Banner { found: cut(line) });
    }
    Ok(Banner { coordinate, field, symmetry })
}

fn name(symmetry: Stated) -> &'static str {
    match symmetry {
        Stated::Symmetric => "symmetric",
        Stated::Skew => "skew-symmetric",
        _ => "general",
    }
}

fn read_size(line: &str, banner: &Banner, largest: usize) -> Result<(usize, usize, usize), Problem> {
    let fields: Vec<&str> = line.split_ascii_whitespace().collect();
    let (expected, allowed) = if banner.coordinate { (3, "rows, columns, entries") } else { (2, "rows, columns") };
    if fields.len() != expected {
        return Err(Problem::Fields { what: "the size", found: fields.len(), allowed });
    }
    let number = |what, field| order(what, whole(what, field)?, largest);
    let (rows, columns) = (number("number of rows", fields[0])?, number("number of columns", fields[1])?);
    if banner.symmetry != Stated::General && rows != columns {
        return Err(Problem::NotSquare { symmetry: name(banner.symmetry), rows, columns });
    }
    let entries = match (banner.coordinate, banner.symmetry) {
        (true, _) => whole("number of entries", fields[2])?,
        (false, Stated::Symmetric) => rows * (rows + 1) / 2,
        (false, Stated::Skew) => rows * (rows - 1) / 2,
        (false, _) => rows * columns,
    };
    Ok((rows, columns, entries))
}

fn integer<T: std::str::FromStr>(field: &str) -> Result<T, Problem> {
    field.parse().map_err(|_| Problem::Value { found: cut(field), allowed: "an integer, as the banner says" })
}

fn check_triangle(i: usize, j: usize, symmetry: Stated) -> Result<(), Problem> {
    let refuse = |allowed| Err(Problem::Triangle { symmetry: name(symmetry), row: i + 1, column: j + 1, allowed });
    match symmetry {
        Stated::Symmetric if i < j => refuse("entries on or below the diagonal"),
        Stated::Skew if i <= j => refuse("entries below the diagonal"),
        _ => Ok(()),
    }
}
