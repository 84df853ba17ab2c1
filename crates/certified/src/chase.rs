//! The bulge of Francis' QR iteration chased by vector registers.

use super::eliminate::{householder, rotation};
use super::lane::{Lane, Reflection};
use super::planar::Planar;
use crate::francis::{Chase, Place};

/// Number of reflections in a chunk; chosen: they share one pass over the columns to their right, so that registers gather these rows once.
const CHUNK: usize = 8;

impl<T: Lane> Chase<T> for Planar<T> {
    fn size(&self) -> usize {
        self.rows()
    }

    fn at(&self, i: usize, j: usize) -> T {
        self.get(i, j)
    }

    fn split(&mut self, k: usize) {
        self.set(k, k - 1, T::default());
    }

    /// Chases the bulge down the diagonal, in chunks of [`CHUNK`] reflections. A reflection of rows acts at once on the columns that its chunk
    /// still changes; on the columns to the right of these all reflections of the chunk act together, at its end.
    fn chase(&mut self, Place { first, start, last }: Place, mut v: [T; 3]) {
        let end = last + 1;
        for chunk in (start..last - 1).step_by(CHUNK) {
            let stop = (last - 1).min(chunk + CHUNK);
            let near = end.min(stop + 3);
            let mut reflections: Vec<Reflection<T>> = Vec::with_capacity(CHUNK);
            for k in chunk..stop {
                if k > start {
                    v = [self.get(k, k - 1), self.get(k + 1, k - 1), self.get(k + 2, k - 1)];
                }
                let reflection = householder(v);
                let left = if k > first { k - 1 } else { k };
                self.reflect_rows_downwards(k, left..near, &[reflection]);
                self.reflect_columns(k, first..end.min(k + 4), reflection);
                reflections.push(reflection);
                if k > first {
                    // Rounding errors, at the start of the bulge as well.
                    self.set(k + 1, k - 1, T::default());
                    self.set(k + 2, k - 1, T::default());
                }
            }
            self.reflect_rows_downwards(chunk, near..end, &reflections);
        }
        let k = last - 1;
        let (c, s) = rotation(self.get(k, k - 1), self.get(last, k - 1));
        self.rotate_rows_upwards(last, k - 1..end, &[(c, s)]);
        self.set(last, k - 1, T::default());
        self.rotate_columns(k, first..end, (c, -s));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::wave;
    use crate::francis;
    use crate::sort;
    use nalgebra::DMatrix;

    /// A matrix has the eigenvalues by registers that it has column by column: through several chunks, and with two small
    /// subdiagonal entries in the middle, between which a bulge starts.
    #[test]
    fn registers_chase_as_columns_do() {
        let n = 40;
        let entry = |i: usize, j: usize| match i {
            _ if i > j + 1 => 0.0,
            _ if i == j + 1 && (20..22).contains(&i) => 1e-9,
            _ => wave(i, j),
        };
        let h = DMatrix::from_fn(n, n, entry);
        let mut found = francis::of_hessenberg(Planar::<f64>::from(&h), 60).unwrap();
        let mut expected = francis::of_hessenberg(h, 60).unwrap();
        sort(&mut found);
        sort(&mut expected);
        assert!(found.iter().zip(&expected).all(|(f, e)| (f - e).norm() < 1e-12));
    }
}
