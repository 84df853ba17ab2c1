//! Degrees of freedom that a program holds by an entry huge against all others on the diagonal: 1e36 for a boundary condition, 1e15
//! to 1e20 for a stiff spring to ground.
//!
//! Such a row is what is left of a boundary condition. With it an eigenvalue problem has no digits left for the other rows: the error of an
//! eigenvalue is the rounding of the largest entry. Without it the other eigenvalues move by the ratio of the other entries to it, which is nothing.

use std::fmt;

use formats::{Entry, Kind};

/// Least ratio of a huge row to the largest of all other rows. Chosen: without the huge row the others change by 1e-8 at most (measured: 6e-10 at
/// 2.5e8), and with it the bounds on their errors are larger.
const GAP: f64 = 1e8;
/// Least entry of a huge row that is held whatever its mass; chosen: no part is so stiff in any unit, programs write 1e36.
const MARK: f64 = 1e30;
/// Largest negative damping of a row that is held, as a fraction of `sqrt(m k)`; chosen: its own vibration, far beyond any that is looked for, would grow by
/// less per cycle.
const UNDAMPED: f64 = 1e-8;
/// Largest ratio of the mass of a stiff row that is held to the heaviest row that is not huge; chosen: rows of masses and of moments of inertia differ by less,
/// and a row that is scaled as a whole has a mass as huge as its stiffness.
const HEAVY: f64 = 1e4;
/// Least ratio to the largest of all other rows of a stiff tie that is refused; chosen: four digits of the others are left beside it.
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

/// Rows of a brake that are held, of which the entries of M, C and K say.
#[derive(Debug, Clone)]
pub struct HeldRows {
    /// Diagonals of M, C and K.
    diagonals: [Vec<f64>; 3],
    /// True of rows whose diagonal is huge in M, C or K, and that nothing is tied to.
    huge: [Vec<bool>; 3],
}

impl HeldRows {
    /// Rows of a brake of `order` degrees of freedom, none of which is held so far.
    pub fn new(order: usize) -> Self {
        Self { diagonals: std::array::from_fn(|_| vec![0.0; order]), huge: std::array::from_fn(|_| vec![false; order]) }
    }

    /// Adds M, C or K, all of it, by its entries (row, column, value), each entry at most once.
    ///
    /// # Errors
    /// [`Tied`].
    pub fn add(&mut self, kind: Kind, entries: impl Iterator<Item = Entry> + Clone) -> Result<(), Tied> {
        let at = match kind {
            Kind::Mass => 0,
            Kind::Damping => 1,
            Kind::Stiffness => 2,
        };
        let order = self.diagonals[at].len();
        for Entry { row, value, .. } in entries.clone().filter(|entry| entry.row == entry.column) {
            self.diagonals[at][row as usize] += value;
        }
        self.huge[at] = huge_rows(order, entries)?;
        Ok(())
    }

    /// Rows that are held, from 0 and ascending: by a huge stiffness, or by an entry of 1e30 or more in any of the matrices. What is huge in its mass too is a row in
    /// another unit, which vibrates like others; and negative mass, damping or stiffness holds nothing: it makes a brake diverge.
    pub fn rows(&self) -> Vec<usize> {
        let [mass, damping, stiffness] = &self.diagonals;
        let is_huge = |row: usize| self.huge.iter().any(|huge| huge[row]);
        let order = mass.len();
        let heaviest = (0..order).filter(|&row| !is_huge(row)).map(|row| mass[row]).fold(0.0, f64::max);
        let is_held = |row: usize| {
            let is_marked = self.huge.iter().zip(&self.diagonals).any(|(huge, of)| huge[row] && of[row] >= MARK);
            let is_stiff = self.huge[2][row] && mass[row] <= HEAVY * heaviest;
            let is_damped = damping[row] >= -UNDAMPED * (mass[row] * stiffness[row]).max(0.0).sqrt();
            let is_passive = mass[row] >= 0.0 && is_damped && stiffness[row] >= 0.0;
            is_passive && (is_marked || is_stiff)
        };
        (0..order).filter(|&row| is_held(row)).collect()
    }
}

/// True of each row of a square matrix whose diagonal is huge and that nothing is tied to.
fn huge_rows(order: usize, entries: impl Iterator<Item = Entry> + Clone) -> Result<Vec<bool>, Tied> {
    let mut largest = vec![[0.0_f64; 2]; order];
    for Entry { row, column, value } in entries.clone() {
        let (row, column, size) = (row as usize, column as usize, value.abs());
        for at in [row, column] {
            let which = usize::from(row != column);
            largest[at][which] = largest[at][which].max(size);
        }
    }
    let of_row = |row: &[f64; 2]| row[0].max(row[1]);
    let mut sizes: Vec<f64> = largest.iter().map(of_row).filter(|size| *size > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    // Against the next smaller row, or against the softest quarter of all: rows of many sizes may leave no gap.
    let soft = sizes.get(sizes.len().saturating_sub(1) / 4).copied().unwrap_or(0.0);
    let is_huge = |at: usize| {
        let below = if at > 0 { sizes[at - 1] } else { f64::INFINITY };
        sizes[at] >= LEAST && (sizes[at] >= GAP * below || (at > 0 && sizes[at] >= GAP * soft))
    };
    let Some(first) = (0..sizes.len()).find(|&at| is_huge(at)) else { return Ok(vec![false; order]) };
    let [others, from] = [sizes[first - 1], sizes[first]];
    let huge = || largest.iter().enumerate().filter(|(_, row)| of_row(row) >= from);
    let is_tied = |[diagonal, beside]: &[f64; 2]| *beside > diagonal / GAP;
    if let Some((row, [_, entry])) = huge().find(|(_, row)| is_tied(row) && of_row(row) >= TIED * others) {
        return Err(Tied { row: row + 1, entry: *entry, others });
    }
    let mut held: Vec<bool> = largest.iter().map(|row| of_row(row) >= from && !is_tied(row)).collect();
    // What is soft beside a huge row hangs on it all the same: without it its own stiffness would change.
    for Entry { row, column, value } in entries {
        for (at, other) in [(row as usize, column as usize), (column as usize, row as usize)] {
            let change = value * (value / largest[at][0]);
            if held[at] && of_row(&largest[other]) < from && change > largest[other][0] / GAP {
                held[at] = false;
            }
        }
    }
    Ok(held)
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

    fn diagonal(values: &[f64]) -> Vec<Entry> {
        let entry = |(at, &value): (usize, &f64)| Entry { row: at as u32, column: at as u32, value };
        values.iter().enumerate().map(entry).collect()
    }

    fn held(matrices: [&[Entry]; 3]) -> Result<Vec<usize>, Tied> {
        let order = matrices.iter().flat_map(|of| of.iter()).map(|entry| entry.row as usize + 1).max().unwrap();
        let mut rows = HeldRows::new(order);
        for (kind, of) in [Kind::Mass, Kind::Damping, Kind::Stiffness].into_iter().zip(matrices) {
            rows.add(kind, of.iter().copied())?;
        }
        Ok(rows.rows())
    }

    /// Without the second row the first one would have k_11 in place of k_11 - k_12 k_21 / k_22: at most 1e-8 more.
    #[test]
    fn a_row_that_a_soft_one_hangs_on_is_not_held() {
        for soft in [1e-2, 1.0, 1e4] {
            for huge in [1e14, 1e20, 1e36] {
                for part in [1e-12, 1e-10, 1e-7, 1e-2, 0.5] {
                    let beside = f64::sqrt(part * soft * huge);
                    let entry = |row, column, value| Entry { row, column, value };
                    let all = [entry(0, 0, soft), entry(0, 1, beside), entry(1, 0, beside), entry(1, 1, huge)];
                    let Ok(found) = held([&[], &[], &all]) else { continue };
                    assert!(found.is_empty() || part <= 1.01e-8, "{soft:e} {huge:e} {part}: {found:?}");
                }
            }
            assert_eq!(held([&[], &[], &diagonal(&[soft, 1e36])]), Ok(vec![1]));
        }
    }

    #[test]
    fn a_negative_spring_holds_nothing_however_huge_it_is() {
        for huge in [1e20, 1e30, 1e36] {
            assert_eq!(held([&[], &[], &diagonal(&[1e4, huge, 2e4, -huge])]), Ok(vec![1]));
            assert_eq!(held([&[], &[], &diagonal(&[1e4, -huge])]), Ok(vec![]));
            // Nor does a stiff row with a dashpot that feeds it.
            assert_eq!(held([&[], &diagonal(&[0.0, -1.0]), &diagonal(&[1e4, huge])]), Ok(vec![]));
        }
    }

    /// A row in another unit, all of it multiplied, vibrates as before.
    #[test]
    fn a_row_that_is_scaled_as_a_whole_is_not_held() {
        for factor in [1e9, 1e12, 1e15, 1e18, 1e25] {
            let all = [&[1.0, 0.5, factor][..], &[0.1, 0.0, 0.3 * factor], &[1e4, 3e4, 2e4 * factor]].map(diagonal);
            assert_eq!(held(all.each_ref().map(Vec::as_slice)), Ok(vec![]), "{factor:e}");
        }
        // A boundary condition in matrices that are all marked is one.
        let all = [&[1.0, 0.5, 1e36][..], &[0.1, 0.0, 0.0], &[1e4, 3e4, 1e36]].map(diagonal);
        assert_eq!(held(all.each_ref().map(Vec::as_slice)), Ok(vec![2]));
    }

    /// Stiff springs to ground of all sizes, so that no row is 1e8 times the next smaller one.
    #[test]
    fn rows_of_many_sizes_are_held_from_a_hundred_million_times_the_soft_ones_on() {
        for step in [1e2, 1e4, 1e6, 9e7] {
            let penalties: Vec<f64> = (1..).map(|at| 1e8 * f64::powi(step, at)).take_while(|k| *k < 1e37).collect();
            let values = [vec![2e8; 3 * penalties.len() + 1], penalties.clone()].concat();
            let found = held([&diagonal(&vec![1.0; values.len()]), &[], &diagonal(&values)]).unwrap();
            let expected = (0..values.len()).filter(|&at| values[at] >= 2e16).collect::<Vec<_>>();
            assert_eq!(found, expected, "{step:e}");
        }
    }
}
