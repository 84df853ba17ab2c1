//! Rotations and reflections of rows and columns of [`Planar`](super::planar::Planar) matrices in vector registers.
//!
//! Columns lie in memory as registers take them. Of a row a register takes the entries of several columns, gathered one
//! by one; a sequence of rotations or reflections goes through the rows once and keeps in registers what the next one
//! needs.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::lane::{BLOCK_ROWS, Block, Lane, MOST_LANES, Reflection, Rotation};
use crate::lanes::Ops;

pub(super) struct RotateColumns<'a, T> {
    pub(super) columns: [&'a mut [f64]; 2],
    pub(super) plane: usize,
    pub(super) rows: Range<usize>,
    pub(super) by: Rotation<T>,
}

impl<T: Lane> WithSimd for RotateColumns<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns: [left, right], plane, rows, by } = self;
        let o = Ops::new(simd);
        let (c, s) = (T::splat(o, by.0), T::splat(o, by.1));
        let mut at = rows.start;
        while at < rows.end {
            let part = (at, rows.end.min(at + S::F64_LANES));
            let (x, y) = (T::load(o, left, plane, part), T::load(o, right, plane, part));
            T::store(o, left, plane, part, T::minus_times(o, T::times(o, c, x), s, y));
            T::store(o, right, plane, part, T::plus_times(o, T::times(o, c, y), s, x));
            at = part.1;
        }
    }
}

/// A [`Reflection`] in all lanes.
struct ReflectionInLanes<V> {
    u: [V; 2],
    scaled: [V; 3],
}

#[inline(always)]
fn splat<T: Lane, S: Simd>(o: Ops<S>, (u, scaled): Reflection<T>) -> ReflectionInLanes<T::In<S::f64s>> {
    ReflectionInLanes {
        u: [T::splat(o, u[0]), T::splat(o, u[1])],
        scaled: [T::splat(o, scaled[0]), T::splat(o, scaled[1]), T::splat(o, scaled[2])],
    }
}

/// `x - beta (w . x) w` of three entries in each lane.
#[inline(always)]
fn reflect<T: Lane, S: Simd>(
    o: Ops<S>,
    by: &ReflectionInLanes<T::In<S::f64s>>,
    [x, y, z]: [T::In<S::f64s>; 3],
) -> [T::In<S::f64s>; 3] {
    let sum = T::plus_times(o, T::plus_times(o, x, by.u[0], y), by.u[1], z);
    [
        T::minus_times(o, x, sum, by.scaled[0]),
        T::minus_times(o, y, sum, by.scaled[1]),
        T::minus_times(o, z, sum, by.scaled[2]),
    ]
}

pub(super) struct ReflectColumns<'a, T> {
    pub(super) columns: [&'a mut [f64]; 3],
    pub(super) plane: usize,
    pub(super) rows: Range<usize>,
    pub(super) by: Reflection<T>,
}

impl<T: Lane> WithSimd for ReflectColumns<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns: [first, second, third], plane, rows, by } = self;
        let o = Ops::new(simd);
        let by = splat(o, by);
        let mut at = rows.start;
        while at < rows.end {
            let part = (at, rows.end.min(at + S::F64_LANES));
            let three =
                [T::load(o, first, plane, part), T::load(o, second, plane, part), T::load(o, third, plane, part)];
            let [x, y, z] = reflect::<T, S>(o, &by, three);
            T::store(o, first, plane, part, x);
            T::store(o, second, plane, part, y);
            T::store(o, third, plane, part, z);
            at = part.1;
        }
    }
}

/// A matrix and those of its columns whose rows are transformed.
pub(super) struct Rows<'a> {
    pub(super) data: &'a mut [f64],
    pub(super) plane: usize,
    pub(super) columns: Range<usize>,
}

impl Rows<'_> {
    /// The first columns that are left, as many as a register has lanes, taken away from the others.
    #[inline(always)]
    fn next_tile<T: Lane, S: Simd>(&mut self) -> Tile {
        let (first, lanes) = (self.columns.start, S::F64_LANES.min(self.columns.len()));
        self.columns.start += lanes;
        Tile { at: first * T::PLANES * self.plane, lanes }
    }

    #[inline(always)]
    fn fill<T: Lane>(&self, tile: Tile, rows: Range<usize>, block: &mut Block) {
        for lane in 0..tile.lanes {
            for (plane, entries) in block[..T::PLANES].iter_mut().enumerate() {
                let column = tile.at + (lane * T::PLANES + plane) * self.plane;
                for (row, &x) in entries.iter_mut().zip(&self.data[column + rows.start..column + rows.end]) {
                    row[lane] = x;
                }
            }
        }
    }

    #[inline(always)]
    fn empty<T: Lane>(&mut self, tile: Tile, rows: Range<usize>, block: &Block) {
        for lane in 0..tile.lanes {
            for (plane, entries) in block[..T::PLANES].iter().enumerate() {
                let column = tile.at + (lane * T::PLANES + plane) * self.plane;
                for (row, x) in entries.iter().zip(&mut self.data[column + rows.start..column + rows.end]) {
                    *x = row[lane];
                }
            }
        }
    }

    #[inline(always)]
    fn row<T: Lane, S: Simd>(&self, o: Ops<S>, tile: Tile, row: usize) -> T::In<S::f64s> {
        let mut block = EMPTY;
        self.fill::<T>(tile, row..row + 1, &mut block);
        T::from_block(o, &block, 0)
    }

    #[inline(always)]
    fn set_row<T: Lane, S: Simd>(&mut self, o: Ops<S>, tile: Tile, row: usize, x: T::In<S::f64s>) {
        let mut block = EMPTY;
        T::to_block(o, &mut block, 0, x);
        self.empty::<T>(tile, row..row + 1, &block);
    }
}

/// Columns that fit in the lanes of a register: where the first starts, and how many they are.
#[derive(Clone, Copy)]
struct Tile {
    at: usize,
    lanes: usize,
}

const EMPTY: Block = [[[0.0; MOST_LANES]; BLOCK_ROWS]; 2];

pub(super) struct RotateRows<'a, T> {
    pub(super) matrix: Rows<'a>,
    pub(super) bottom: usize,
    pub(super) by: &'a [Rotation<T>],
}

impl<T: Lane> WithSimd for RotateRows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { mut matrix, bottom, by } = self;
        let (o, mut block) = (Ops::new(simd), EMPTY);
        while !matrix.columns.is_empty() {
            let tile = matrix.next_tile::<T, S>();
            let (mut below, mut end) = (matrix.row::<T, S>(o, tile, bottom), bottom);
            for by in by.chunks(BLOCK_ROWS) {
                // The rows above each rotation's lower row; what they give belongs one row further down.
                let start = end - by.len();
                matrix.fill::<T>(tile, start..end, &mut block);
                for (k, &(c, s)) in by.iter().enumerate() {
                    let (c, s) = (T::splat(o, c), T::splat(o, s));
                    let above = T::from_block(o, &block, by.len() - 1 - k);
                    let done = T::minus_times(o, T::times(o, c, below), s, above);
                    T::to_block(o, &mut block, by.len() - 1 - k, done);
                    below = T::plus_times(o, T::times(o, c, above), s, below);
                }
                matrix.empty::<T>(tile, start + 1..end + 1, &block);
                end = start;
            }
            matrix.set_row::<T, S>(o, tile, end, below);
        }
    }
}

pub(super) struct ReflectRows<'a, T> {
    pub(super) matrix: Rows<'a>,
    pub(super) top: usize,
    pub(super) by: &'a [Reflection<T>],
}

impl<T: Lane> WithSimd for ReflectRows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { mut matrix, top, by } = self;
        let o = Ops::new(simd);
        while !matrix.columns.is_empty() {
            // Each reflection of one strip waits for the one before, and those of the other fill the time.
            let mut strips = [Strip::next::<T, S>(o, &mut matrix, top), Strip::next::<T, S>(o, &mut matrix, top)];
            let mut start = top;
            for by in by.chunks(BLOCK_ROWS) {
                // The third row of each reflection; what it is done with lies two rows further up.
                let end = start + by.len();
                for strip in &mut strips {
                    matrix.fill::<T>(strip.tile, start + 2..end + 2, &mut strip.block);
                }
                for (k, &by) in by.iter().enumerate() {
                    let by = splat(o, by);
                    for strip in &mut strips {
                        let z = T::from_block(o, &strip.block, k);
                        let [done, next, last] = reflect::<T, S>(o, &by, [strip.x, strip.y, z]);
                        T::to_block(o, &mut strip.block, k, done);
                        (strip.x, strip.y) = (next, last);
                    }
                }
                for strip in &strips {
                    matrix.empty::<T>(strip.tile, start..end, &strip.block);
                }
                start = end;
            }
            for strip in &strips {
                matrix.set_row::<T, S>(o, strip.tile, start, strip.x);
                matrix.set_row::<T, S>(o, strip.tile, start + 1, strip.y);
            }
        }
    }
}

/// A register's columns while reflections go through their rows.
struct Strip<V> {
    tile: Tile,
    block: Block,
    /// The first two rows of the next reflection.
    x: V,
    y: V,
}

impl<V> Strip<V> {
    #[inline(always)]
    fn next<T: Lane<In<S::f64s> = V>, S: Simd>(o: Ops<S>, matrix: &mut Rows, top: usize) -> Self {
        let tile = matrix.next_tile::<T, S>();
        let (x, y) = (matrix.row::<T, S>(o, tile, top), matrix.row::<T, S>(o, tile, top + 1));
        Self { tile, block: EMPTY, x, y }
    }
}
