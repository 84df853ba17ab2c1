//! The sectors of a brake that has been changed: something held, a contact taken out, a mass attached.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::{Combination, Sector, Sectors};

/// Largest entry, as a fraction of the largest of all, that couples two sectors by rounding alone; chosen, far above rounding.
const ROUNDING: f64 = 1e-12;

impl Sectors {
    /// The sectors without some degrees of freedom and channels: `dofs` and `channels` have the new, ascending index of each that
    /// stays. `None` where the symmetry exchanges one that stays with one that does not.
    pub fn kept(&self, dofs: &[Option<usize>], channels: &[Option<usize>]) -> Option<Self> {
        let mut sectors = Vec::with_capacity(self.sectors.len());
        for sector in &self.sectors {
            let (shapes, channels_of) = (kept(&sector.shapes, dofs)?, kept(&sector.channels, channels)?);
            if !shapes.is_empty() {
                let (order, channel_count) = (count(dofs), count(channels));
                sectors.push(Sector { shapes, channels: channels_of, order, channel_count });
            }
        }
        let like = self.like.iter().enumerate().filter(|(at, _)| channels[*at].is_some());
        Some(Self { sectors, like: like.map(|(_, &first)| channels[first]).collect::<Option<_>>()? })
    }

    /// True if a matrix over the free degrees of freedom couples the shapes of different sectors.
    pub fn are_coupled_by(&self, matrix: &DMatrix<f64>) -> bool {
        let largest = matrix.amax();
        let couples = |(at, sector): (usize, &Sector)| {
            (0..sector.order()).any(|shape| {
                let unit = DVector::from_fn(sector.order(), |i, _| Complex::from(if i == shape { 1.0 } else { 0.0 }));
                let image = linsys::real_times_complex(matrix, &sector.expand(&unit));
                let mut others = self.sectors.iter().enumerate().filter(|(other, _)| *other != at);
                others.any(|(_, other)| other.project(&image).camax() > ROUNDING * largest)
            })
        };
        self.sectors.iter().enumerate().any(couples)
    }
}

/// Number of places that stay.
fn count(places: &[Option<usize>]) -> usize {
    places.iter().flatten().count()
}

/// Combinations of what stays; `None` where what stays and what does not are in one combination.
fn kept(all: &[Combination], places: &[Option<usize>]) -> Option<Vec<Combination>> {
    let mut out = Vec::with_capacity(all.len());
    for combination in all {
        let signs: Vec<(usize, f64)> =
            combination.signs.iter().filter_map(|&(at, sign)| Some((places[at]?, sign))).collect();
        match signs.len() {
            0 => {}
            left if left == combination.signs.len() => out.push(Combination { signs, size: combination.size }),
            _ => return None,
        }
    }
    Some(out)
}
