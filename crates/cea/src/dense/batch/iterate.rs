//! The QR iteration of a batch; each lane has its own deflations, shifts and end.

use certified::lanes::Ops;
use pulp::{Simd, bytemuck};

use super::layout::Layout;
use super::reflector::Reflectors;
use super::shifts::{ShiftPair, shift_pair};
use super::sweep::{Block, SweepInput, sweep};

/// Most sweeps without a deflation before a lane is given up; chosen: most matrices take 2 to 4.
pub(super) const MOST_SWEEPS: u32 = 60;
/// Number of sweeps without a deflation after which one sweep takes exceptional shifts, in case the ordinary shifts form a
/// cycle: LAPACK's `kexsh`.
const SWEEPS_TO_EXCEPTIONAL_SHIFT: u32 = 10;
/// Least order of a block whose shifts come from its trailing 4 x 4 part; chosen: the shifts of a 4 x 4 block would be its
/// exact eigenvalues, and the bulge would consist of rounding errors.
const LEAST_WIDE_BLOCK: usize = 6;
/// Cycle of shifts: of each eight sweeps without a deflation, the first six take the shifts of the 4 x 4 part, the last two the shifts of the 2 x 2
/// part; chosen.
const SHIFT_CYCLE: (u32, u32) = (8, 6);

/// The progress of one lane.
#[derive(Debug, Clone, Copy)]
struct LaneProgress {
    /// Rows `0..open` still hold undeflated blocks.
    open: usize,
    /// Sweeps of the lowest block since the last deflation.
    sweeps: u32,
    failed: bool,
}

/// The matrix of one lane.
struct Lane<'a> {
    entries: &'a [f64],
    layout: Layout,
    lanes: usize,
    lane: usize,
}

impl Lane<'_> {
    fn at(&self, i: usize, j: usize) -> f64 {
        self.entries[self.layout.at(i, j) * self.lanes + self.lane]
    }

    /// First row of the unreduced block that ends in row `bottom`.
    fn top_of(&self, bottom: usize) -> usize {
        (1..=bottom).rev().find(|&i| self.at(i, i - 1) == 0.0).unwrap_or(0)
    }

    /// Deflates blocks of one or two rows at the end of the matrix; returns the last block of three rows or more.
    fn deflate(&self, progress: &mut LaneProgress, splits: [usize; 2]) -> Option<(usize, usize)> {
        let [mut top, above] = splits;
        let mut above = Some(above);
        while progress.open - top < 3 {
            progress.open = top;
            progress.sweeps = 0;
            if top == 0 {
                return None;
            }
            top = above.take().unwrap_or_else(|| self.top_of(progress.open - 1));
        }
        Some((top, progress.open - 1))
    }

    /// The next block of three rows or more above row `top`.
    fn next_above(&self, mut top: usize) -> Option<(usize, usize)> {
        while top > 0 {
            let bottom = top - 1;
            top = self.top_of(bottom);
            if bottom - top >= 2 {
                return Some((top, bottom));
            }
        }
        None
    }
}

/// Sets negligible subdiagonal entries to zero and returns, per lane, the two lowest rows below `open` where the
/// matrix splits.
///
/// An entry is compared with its four neighbours on the diagonal and the subdiagonal. The diagonal alone, as in EISPACK's hqr,
/// is too strict for a lightly damped system, whose diagonal entries nearly vanish.
#[inline(always)]
fn split<S: Simd>(o: Ops<S>, a: &mut [S::f64s], layout: Layout, rows: usize, open: S::f64s) -> [S::f64s; 2] {
    let epsilon = o.splat(f64::EPSILON);
    let zero = o.splat(0.0);
    let (mut lowest, mut above) = (zero, zero);
    let mut before = zero;
    let mut diagonal = o.abs(a[layout.at(0, 0)]);
    for i in 1..rows {
        let entry = a[layout.at(i, i - 1)];
        let size = o.abs(entry);
        let next = o.abs(a[layout.at(i, i)]);
        let after = o.abs(a[layout.at(i + 1, i)]);
        let around = o.add(o.add(diagonal, next), o.add(before, after));
        let small = o.le(size, o.mul(epsilon, around));
        a[layout.at(i, i - 1)] = o.select(small, zero, entry);
        let row = o.splat(i as f64);
        let splits = o.and(small, o.lt(row, open));
        above = o.select(splits, lowest, above);
        lowest = o.select(splits, row, lowest);
        before = o.select(small, zero, size);
        diagonal = next;
    }
    [lowest, above]
}

/// The blocks that the lanes sweep next, with the trailing entries from which their shifts follow.
struct SweepRequests<V> {
    tops: [V; 2],
    bottoms: [V; 2],
    corners: [[[V; 4]; 4]; 2],
    wide: [V; 2],
    /// Size of the exceptional shift of the last block; zero for an ordinary shift.
    exceptional: V,
}

impl<V: bytemuck::Pod> SweepRequests<V> {
    fn of_no_lane(zero: V, never: V, none: V) -> Self {
        Self { tops: [never; 2], bottoms: [none; 2], corners: [[[zero; 4]; 4]; 2], wide: [zero; 2], exceptional: zero }
    }

    fn add(&mut self, slot: usize, (top, bottom): (usize, usize), view: &Lane<'_>, sweeps: u32) {
        let lane = view.lane;
        floats(&mut self.tops[slot])[lane] = top as f64;
        floats(&mut self.bottoms[slot])[lane] = bottom as f64;
        let wide = bottom - top + 1 >= LEAST_WIDE_BLOCK && sweeps % SHIFT_CYCLE.0 < SHIFT_CYCLE.1;
        floats(&mut self.wide[slot])[lane] = f64::from(u8::from(wide));
        let from = if wide { 0 } else { 2 };
        for i in from..4 {
            for j in i.max(from + 1) - 1..4 {
                floats(&mut self.corners[slot][i][j])[lane] = view.at(bottom + i - 3, bottom + j - 3);
            }
        }
        if slot == 0 && sweeps.is_multiple_of(SWEEPS_TO_EXCEPTIONAL_SHIFT) {
            let size = view.at(bottom, bottom - 1).abs() + view.at(bottom - 1, bottom - 2).abs();
            floats(&mut self.exceptional)[lane] = size;
        }
    }
}

fn floats<V: bytemuck::Pod>(register: &mut V) -> &mut [f64] {
    bytemuck::cast_slice_mut(std::slice::from_mut(register))
}

/// Brings Hessenberg matrices to quasi-triangular form, as far as eigenvalues need it; returns whether each lane failed.
#[inline(always)]
pub(super) fn iterate<S: Simd>(o: Ops<S>, a: &mut [S::f64s], layout: Layout) -> Vec<bool> {
    let lanes = S::F64_LANES;
    let n = layout.order;
    let (zero, never, none) = (o.splat(0.0), o.splat(f64::MAX), o.splat(-1.0));
    let mut progress = vec![LaneProgress { open: n, sweeps: 0, failed: false }; lanes];
    // The last window of a sweep may extend past the last row.
    let mut tops = vec![false; n + super::layout::REFLECTORS_PER_WINDOW];
    let mut open = o.splat(n as f64);
    let mut reflectors = Reflectors::identities(zero);
    loop {
        let rows = progress.iter().map(|lane| lane.open).max().unwrap_or(0);
        if rows == 0 {
            break;
        }
        let [mut lowest, mut above] = split(o, a, layout, rows, open);
        let (lowest, above) = (floats(&mut lowest), floats(&mut above));

        let mut requests = SweepRequests::of_no_lane(zero, never, none);
        let (mut first, mut last) = (usize::MAX, 0);
        tops.fill(false);
        for (lane, progress) in progress.iter_mut().enumerate().filter(|(_, progress)| progress.open > 0) {
            let view = Lane { entries: bytemuck::cast_slice(a), layout, lanes, lane };
            let Some(block) = view.deflate(progress, [lowest[lane] as usize, above[lane] as usize]) else {
                continue;
            };
            progress.sweeps += 1;
            if progress.sweeps > MOST_SWEEPS {
                (progress.open, progress.failed) = (0, true);
                continue;
            }
            last = last.max(block.1);
            for (slot, block) in [Some(block), view.next_above(block.0)].into_iter().flatten().enumerate() {
                requests.add(slot, block, &view, progress.sweeps);
                tops[block.0] = true;
                first = first.min(block.0);
            }
        }
        for (lane, progress) in progress.iter().enumerate() {
            floats(&mut open)[lane] = progress.open as f64;
        }
        if first == usize::MAX {
            continue;
        }
        let mut blocks = [block(o, &requests, 0), block(o, &requests, 1)];
        let size = requests.exceptional;
        let exceptional = o.lt(zero, size);
        let ShiftPair { mean, square } = &mut blocks[0].shifts;
        *mean = o.select(exceptional, o.fma(o.splat(0.75), size, requests.corners[0][3][3]), *mean);
        *square = o.select(exceptional, o.mul(o.splat(-0.4375), o.mul(size, size)), *square);

        sweep(o, a, layout, &SweepInput { first, last, blocks, tops: &tops }, &mut reflectors);
    }
    progress.iter().map(|lane| lane.failed).collect()
}

#[inline(always)]
fn block<S: Simd>(o: Ops<S>, requests: &SweepRequests<S::f64s>, slot: usize) -> Block<S::f64s> {
    let wide = o.lt(o.splat(0.0), requests.wide[slot]);
    Block {
        top: requests.tops[slot],
        bottom: requests.bottoms[slot],
        shifts: shift_pair(o, &requests.corners[slot], wide),
    }
}
