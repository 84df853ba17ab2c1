//! OP4 as text.

use super::{Open, short_header};
use crate::builder::Found;
use crate::limits::Limits;
use crate::lines::Lines;
use crate::numbers::{fortran, signed};
use crate::problem::Problem;
use crate::shortened::cut;

/// Width of the field of a whole number, characters.
const WHOLE: usize = 8;

/// Layout of printed real numbers: how many on a line, and the characters of each.
#[derive(Clone, Copy)]
struct Print {
    per_line: usize,
    width: usize,
}

/// True for a line that is the header of a matrix.
pub(crate) fn is_header(line: &str) -> bool {
    line.is_ascii() && line.len() > 5 * WHOLE && wholes::<4>(line).is_ok() && print(&line[5 * WHOLE..]).is_some()
}

/// Reads all matrices.
pub(crate) fn parse(lines: &mut Lines<'_>, limits: &Limits) -> Result<Found, Problem> {
    let mut found = Found::default();
    while let Some(line) = lines.next()? {
        if line.trim().is_empty() {
            continue;
        }
        let header = || Problem::field("the header of a matrix", line, "columns, rows, form, type, name, print format");
        if !line.is_ascii() || line.len() <= 5 * WHOLE {
            return Err(header());
        }
        let print = print(&line[5 * WHOLE..]).ok_or_else(header)?;
        let mut open = Open::new(wholes(line)?, line[4 * WHOLE..5 * WHOLE].trim().to_owned(), limits)?;
        loop {
            let line = lines.next()?.ok_or(Problem::End { what: "a matrix" })?;
            let [column, row, words] = wholes(line)?;
            let words = usize::try_from(words).map_err(|_| Problem::field("words of a column", words, "0 or more"))?;
            if !open.column(column)? {
                // The column beyond the last has one number without a meaning.
                lines.next()?.ok_or(Problem::End { what: "the last column" })?;
                break;
            }
            if row != 0 {
                dense(lines, &mut open, row, words, print)?;
                continue;
            }
            let mut left = words;
            while left > 0 {
                let line = lines.next()?.ok_or(Problem::End { what: "a string" })?;
                let (length, row) = if open.bigmat {
                    let [length, row] = wholes(line)?;
                    (length, row)
                } else {
                    short_header(signed("the header of a string", line.trim())?)
                };
                let taken = usize::try_from(length).unwrap_or(0).saturating_add(usize::from(open.bigmat));
                let count = open.numbers_of(length)?;
                left = left
                    .checked_sub(taken)
                    .ok_or_else(|| Problem::field("words of a string", taken, left.to_string()))?;
                stretch(lines, &mut open, row, count, print)?;
            }
        }
        open.finish(&mut found)?;
    }
    Ok(found)
}

/// Reads the numbers of a string, which is what OP4 calls consecutive rows of a sparse column.
fn stretch(lines: &mut Lines<'_>, open: &mut Open, row: i64, count: usize, print: Print) -> Result<(), Problem> {
    let row = open.stretch(row, count)?;
    let mut at = 0;
    while at < count {
        let line = lines.next()?.ok_or(Problem::Truncated { found: at, expected: count })?;
        at += numbers(line, open, (row, at), count - at, print)?;
    }
    Ok(())
}

/// Reads the numbers of a dense column, whose header counts them. Files count the numbers themselves, the manual counts their words, two for each
/// number in double precision: then the header of the next column comes after half as many.
fn dense(lines: &mut Lines<'_>, open: &mut Open, row: i64, given: usize, print: Print) -> Result<(), Problem> {
    let first = open.stretch(row, 0)?;
    let mut at = 0;
    while at < given {
        let line = lines.next()?.ok_or(Problem::Truncated { found: at, expected: given })?;
        if !line.contains('.') {
            lines.push_back();
            break;
        }
        at += numbers(line, open, (first, at), given - at, print)?;
        open.stretch(row, at)?;
    }
    if at == given || at * open.words == given {
        Ok(())
    } else {
        Err(Problem::Truncated { found: at, expected: given })
    }
}

/// Reads the numbers of a line, at most `most`. Their number.
fn numbers(
    line: &str,
    open: &mut Open,
    (row, at): (usize, usize),
    most: usize,
    print: Print,
) -> Result<usize, Problem> {
    if !line.is_ascii() {
        return Err(Problem::field("a line of numbers", line, "ASCII"));
    }
    let line = line.trim_end();
    let count = line.len().div_ceil(print.width).clamp(1, print.per_line.min(most));
    for place in 0..count {
        let start = place * print.width;
        let field = line.get(start..line.len().min(start + print.width)).unwrap_or_default();
        open.put(row, at + place, fortran(field.trim())?)?;
    }
    Ok(count)
}

/// The first whole numbers of a line.
fn wholes<const N: usize>(line: &str) -> Result<[i64; N], Problem> {
    let mut numbers = [0; N];
    for (at, number) in numbers.iter_mut().enumerate() {
        let end = line.len().min((at + 1) * WHOLE);
        let field = line.get(at * WHOLE..end).unwrap_or_default().trim();
        *number = field
            .parse()
            .map_err(|_| Problem::NotWhole { what: "a whole number of 8 characters in", found: cut(line) })?;
    }
    Ok(numbers)
}

/// Layout of a Fortran format: `1P,3E23.16` is 3 numbers of 23 characters.
fn print(format: &str) -> Option<Print> {
    let format = format.trim().to_uppercase();
    let format = format.trim_start_matches(['(', '1', 'P', ',']).trim_end_matches(')');
    let (per_line, rest) = format.split_once(['E', 'D'])?;
    let (width, digits) = rest.split_once('.')?;
    digits.parse::<u8>().ok()?;
    let print = Print { per_line: per_line.parse().ok()?, width: width.parse().ok()? };
    // A line has 80 characters by the manual; some programs write a few more.
    (print.per_line > 0 && (8..=40).contains(&print.width) && print.per_line <= 20).then_some(print)
}
