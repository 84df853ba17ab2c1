//! Numbers of unstable modes between the boundary curves.
//!
//! Along the lower left edge the number is known: from a spectrum and the onsets on that edge. From there it changes by one at
//! each curve, up where a rising curve is crossed from left to right: its unstable side is on the right.

use std::collections::{BTreeMap, VecDeque};

use serde::Serialize;

/// Number of rows and of columns of cells; chosen: a cell is two thirds of a millimetre in print.
pub const CELLS: usize = 240;
/// Least depth of a region that is listed, in cells from its edge; chosen: the boundaries of narrower ones nearly touch.
const LEAST_DEPTH: usize = 2;

/// An area with the same number of unstable modes all over.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Region {
    /// Number of unstable modes.
    pub unstable: usize,
    /// Fraction of the whole area.
    pub share: f64,
    /// Point well inside, as fractions of the two ranges.
    pub at: [f64; 2],
}

/// Run of cells of a row with one number of unstable modes.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Run {
    /// Ends, as fractions of the range.
    pub x: [f64; 2],
    /// Index of the row, from below.
    pub row: usize,
    /// Number of unstable modes.
    pub unstable: usize,
}

/// Middle of a cell, as a fraction of the range.
fn middle(cell: usize) -> f64 {
    (cell as f64 + 0.5) / CELLS as f64
}

/// Places where the number of unstable modes changes along a row, each with the change.
fn crossings(curves: &[Vec<[f64; 2]>], y: f64) -> Vec<(f64, i64)> {
    let mut found = Vec::new();
    for step in curves.iter().flat_map(|points| points.windows(2)) {
        let [[x0, y0], [x1, y1]] = [step[0], step[1]];
        if (y0 <= y) != (y1 <= y) {
            let x = x0 + (x1 - x0) * (y - y0) / (y1 - y0);
            found.push((x, if y1 > y0 { 1 } else { -1 }));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

/// Runs of all rows; `on_left` gives the number of unstable modes at each y of the left edge.
pub(super) fn runs(curves: &[Vec<[f64; 2]>], on_left: &dyn Fn(f64) -> i64) -> Vec<Run> {
    let mut runs = Vec::new();
    for row in 0..CELLS {
        let y = middle(row);
        let (mut from, mut count) = (0.0, on_left(y));
        for (x, change) in crossings(curves, y).into_iter().chain([(1.0, 0)]) {
            if x > from {
                runs.push(Run { x: [from, x], row, unstable: count.max(0) as usize });
            }
            (from, count) = (x, count + change);
        }
    }
    runs
}

/// The number of unstable modes of each cell, row by row from below.
fn cells(runs: &[Run]) -> Vec<usize> {
    let mut cells = vec![0; CELLS * CELLS];
    for run in runs {
        let columns = (0..CELLS).filter(|&column| run.x[0] <= middle(column) && middle(column) < run.x[1]);
        columns.for_each(|column| cells[run.row * CELLS + column] = run.unstable);
    }
    cells
}

/// Fraction of the cells that has each number of unstable modes.
pub(super) fn shares(runs: &[Run]) -> BTreeMap<usize, f64> {
    let mut counts = BTreeMap::<usize, usize>::new();
    cells(runs).into_iter().for_each(|unstable| *counts.entry(unstable).or_default() += 1);
    counts.into_iter().map(|(unstable, count)| (unstable, count as f64 / (CELLS * CELLS) as f64)).collect()
}

/// Equally spaced places, one in each `spacing` cells of a row and of a column, that are not next to another number of unstable modes.
pub(super) fn places_apart(runs: &[Run], spacing: usize) -> Vec<Region> {
    let numbers = cells(runs);
    let depth = depths(&numbers);
    let on_grid = |place: usize| place % spacing == spacing / 2;
    let is_apart = |cell: &usize| on_grid(cell % CELLS) && on_grid(cell / CELLS) && depth[*cell] >= LEAST_DEPTH;
    let place = |cell: usize| {
        let at = [middle(cell % CELLS), middle(cell / CELLS)];
        Region { unstable: numbers[cell], share: 1.0 / numbers.len() as f64, at }
    };
    (0..numbers.len()).filter(is_apart).map(place).collect()
}

/// The regions, the largest first, without regions that are nowhere [`LEAST_DEPTH`] cells deep.
pub(super) fn regions(runs: &[Run]) -> Vec<Region> {
    let numbers = cells(runs);
    let depth = depths(&numbers);
    let mut seen = vec![false; numbers.len()];
    let mut found = Vec::new();
    for first in 0..numbers.len() {
        if seen[first] {
            continue;
        }
        let (mut size, mut deepest, mut open) = (0, first, VecDeque::from([first]));
        seen[first] = true;
        while let Some(cell) = open.pop_front() {
            size += 1;
            if depth[cell] > depth[deepest] {
                deepest = cell;
            }
            for next in neighbours(cell) {
                if !seen[next] && numbers[next] == numbers[first] {
                    seen[next] = true;
                    open.push_back(next);
                }
            }
        }
        if depth[deepest] >= LEAST_DEPTH {
            let at = [middle(deepest % CELLS), middle(deepest / CELLS)];
            found.push(Region { unstable: numbers[first], share: size as f64 / numbers.len() as f64, at });
        }
    }
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found
}

/// Distance of each cell from one with another number or from outside, in cells.
fn depths(cells: &[usize]) -> Vec<usize> {
    let at_edge = |cell: usize| {
        let (row, column) = (cell / CELLS, cell % CELLS);
        [row, column].iter().any(|&place| place == 0 || place == CELLS - 1)
            || neighbours(cell).any(|next| cells[next] != cells[cell])
    };
    let mut depth = vec![usize::MAX; cells.len()];
    let mut open: VecDeque<usize> = (0..cells.len()).filter(|&cell| at_edge(cell)).collect();
    open.iter().for_each(|&cell| depth[cell] = 0);
    while let Some(cell) = open.pop_front() {
        for next in neighbours(cell) {
            if depth[next] == usize::MAX {
                depth[next] = depth[cell] + 1;
                open.push_back(next);
            }
        }
    }
    depth
}

/// The cells beside a cell.
fn neighbours(cell: usize) -> impl Iterator<Item = usize> {
    let (row, column) = (cell / CELLS, cell % CELLS);
    let left = (column > 0).then(|| cell - 1);
    let right = (column + 1 < CELLS).then(|| cell + 1);
    let below = (row > 0).then(|| cell - CELLS);
    let above = (row + 1 < CELLS).then(|| cell + CELLS);
    [left, right, below, above].into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_curve_has_one_more_inside() {
        // Clockwise, so that the inside is on the right.
        let square = vec![[0.2, 0.3], [0.2, 0.7], [0.8, 0.7], [0.8, 0.3], [0.2, 0.3]];
        let found = regions(&runs(&[square], &|_| 1));
        assert_eq!(found.iter().map(|region| region.unstable).collect::<Vec<_>>(), [1, 2]);
        assert!((found[1].share - 0.24).abs() < 0.01, "{found:?}");
        assert_eq!(shares(&runs(&[vec![[0.2, 0.3], [0.2, 0.7], [0.8, 0.7], [0.8, 0.3], [0.2, 0.3]]], &|_| 1)).len(), 2);
        assert!(found[1].at[0] > 0.3 && found[1].at[0] < 0.7 && (found[1].at[1] - 0.5).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn what_is_too_narrow_for_a_region_has_its_share() {
        // A strip of three cells, from below to above, with one more.
        let strip = [vec![[0.5, 0.0], [0.5, 1.0]], vec![[0.5125, 1.0], [0.5125, 0.0]]];
        let of_strip = runs(&strip, &|_| 0);
        assert_eq!(regions(&of_strip).iter().map(|region| region.unstable).collect::<Vec<_>>(), [0, 0]);
        let found = shares(&of_strip);
        assert_eq!((found.len(), found.values().sum::<f64>()), (2, 1.0));
        assert!((found[&1] - 0.0125).abs() < 1e-12, "{found:?}");
    }
}
