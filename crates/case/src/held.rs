//! Degrees of freedom that a program holds by an entry huge against all others on the diagonal: 1e36 for a boundary condition, 1e15
//! to 1e20 for a stiff spring to ground.
//!
//! Such a row is what is left of a boundary condition. In it an eigenvalue problem has no digits left for the rest: the error of an
//! eigenvalue is that of rounding the largest entry. Without it the others move by their size against it, which is nothing.

use std::fmt;

use formats::Entry;

/// Ratio to the largest of all other rows from which on a row is huge. Chosen: without it the others change by 1e-8 at most (measured: 6e-10 at
/// 2.5e8), and with it the bounds on their errors are larger.
const GAP: f64 = 1e8;
/// Ratio to the largest of all other rows from which on a stiff tie is refused; chosen: four digits of the others are left beside it.
const TIED: f64 = 1e12;
/// Least entry that may be huge, in the units of the file. Chosen: no stiffness of a part comes near it in SI or mm-t-s, and no mass;
/// it keeps a row of rounding errors from making all others huge.
const LEAST: f64 = 1e14;

/// Rows that are huge and tied to others, so that they are not held but cannot be computed with either.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tied {
    /// Number of the first of these rows, from 1.
    pub row: usize,
    /// Largest entry of that row off the diagonal, absolute, in the unit of the file.
    pub entry: f64,
    /// Largest entry of all rows that are not huge, absolute, in the unit of the file.
    pub others: f64,
}

impl fmt::Display for Tied {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { row, entry, others } = self;
        write!(
            f,
            "row {row} has an entry of {entry:.1e} off the diagonal too, and no other row above {others:.1e}: no digits are left of \
             these; allowed: ties and stiff springs between degrees of freedom below {TIED:.0e} times the others"
        )
    }
}

/// Rows that are held, from 0 and ascending, of a square matrix by its entries (row, column, value), each entry at most once.
///
/// # Errors
/// [`Tied`].
pub fn held_rows(order: usize, entries: impl Iterator<Item = Entry> + Clone) -> Result<Vec<usize>, Tied> {
    let (mut largest, mut is_negative) = (vec![[0.0_f64; 2]; order], vec![false; order]);
    for Entry { row, column, value } in entries.clone() {
        let (row, column, size) = (row as usize, column as usize, value.abs());
        is_negative[row] |= row == column && value < 0.0;
        for at in [row, column] {
            let which = usize::from(row != column);
            largest[at][which] = largest[at][which].max(size);
        }
    }
    let of_row = |row: &[f64; 2]| row[0].max(row[1]);
    let mut sizes: Vec<f64> = largest.iter().map(of_row).filter(|size| *size > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    let gap = sizes.windows(2).find(|pair| pair[1] >= LEAST && pair[1] >= GAP * pair[0]);
    let Some(&[others, from]) = gap else { return Ok(Vec::new()) };
    let huge = || largest.iter().enumerate().filter(|(_, row)| of_row(row) >= from);
    let is_tied = |[diagonal, beside]: &[f64; 2]| *beside > diagonal / GAP;
    match huge().find(|(_, row)| is_tied(row) && of_row(row) >= TIED * others) {
        Some((row, [_, entry])) => Err(Tied { row: row + 1, entry: *entry, others }),
        // A negative spring holds nothing: it makes a brake diverge.
        None => {
            let mut held: Vec<bool> = largest.iter().map(|row| of_row(row) >= from && !is_tied(row)).collect();
            held.iter_mut().zip(is_negative).for_each(|(held, is_negative)| *held &= !is_negative);
            // What is soft beside a huge row hangs on it all the same: without it its own stiffness would change.
            for Entry { row, column, value } in entries {
                for (at, other) in [(row as usize, column as usize), (column as usize, row as usize)] {
                    let change = value * (value / largest[at][0]);
                    if held[at] && of_row(&largest[other]) < from && change > largest[other][0] / GAP {
                        held[at] = false;
                    }
                }
            }
            Ok((0..order).filter(|&row| held[row]).collect())
        }
    }
}

/// Sentence on degrees of freedom that were taken out, by their names.
pub struct Held<'a>(pub &'a [String]);

impl fmt::Display for Held<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// Most names that are printed; chosen.
        const MOST_NAMES: usize = 10;
        let mut names: Vec<&str> = self.0.iter().take(MOST_NAMES).map(String::as_str).collect();
        if self.0.len() > MOST_NAMES {
            names.push("...");
        }
        write!(
            f,
            "degrees of freedom held by an entry on the diagonal that is huge against all others, and taken out: {} ({})",
            self.0.len(),
            names.join(", ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without the second row the first one would have k_11 in place of k_11 - k_12 k_21 / k_22: at most 1e-8 more.
    #[test]
    fn a_row_that_a_soft_one_hangs_on_is_not_held() {
        for soft in [1e-2, 1.0, 1e4] {
            for huge in [1e14, 1e20, 1e36] {
                for part in [1e-12, 1e-10, 1e-7, 1e-2, 0.5] {
                    let beside = f64::sqrt(part * soft * huge);
                    let entry = |row, column, value| Entry { row, column, value };
                    let all = [entry(0, 0, soft), entry(0, 1, beside), entry(1, 0, beside), entry(1, 1, huge)];
                    let Ok(found) = held_rows(2, all.into_iter()) else { continue };
                    assert!(found.is_empty() || part <= 1.01e-8, "{soft:e} {huge:e} {part}: {found:?}");
                }
            }
            let alone =
                [[0, 0], [1, 1]].map(|[row, column]| Entry { row, column, value: if row == 0 { soft } else { 1e36 } });
            assert_eq!(held_rows(2, alone.into_iter()), Ok(vec![1]));
        }
    }

    #[test]
    fn a_negative_spring_holds_nothing_however_huge_it_is() {
        let diagonal = |values: &[f64]| {
            let entry = |(at, &value): (usize, &f64)| Entry { row: at as u32, column: at as u32, value };
            held_rows(values.len(), values.iter().enumerate().map(entry)).ok()
        };
        for huge in [1e20, 1e30, 1e36] {
            assert_eq!(diagonal(&[1e4, huge, 2e4, -huge]), Some(vec![1]));
            assert_eq!(diagonal(&[1e4, -huge]), Some(vec![]));
        }
    }
}
