//! A structure seen through the ports where friction acts, its modes in and near the band apart from all others.
//!
//! ```text
//! Q_0(lambda)^-1 = Y (lambda - Lambda)^-1 V^H + F(lambda)
//! ```
//!
//! with the p eigenvalues Lambda of the structure that have Im > 0 and are in or near the band, and all others in F, which is smooth there:
//! what friction needs of it is read off [tables](super::table).

use linsys::{AffineSystem, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;

use super::shapes::Shapes;
use super::table::{ASIDE, Differences, Region, Samples, Table};
use crate::ReductionError;
use crate::rows::{Rows, add_rows};
use crate::state_modes::StateModes;

/// Between these multiples of the highest frequency of the band the near modes end, at the largest gap; chosen: what is beyond is smooth in
/// the band.
const NEAR: [f64; 2] = [1.1, 1.3];
/// Relative errors of the tables, which take the fewest points that these need; chosen, on cases/disc-pad: for what is followed from one
/// friction to another, where eigenvalues err by some 1e-6 and paths ask for 1e-5; and for last digits, below the residuals that are
/// asked for.
const PATH_ERROR: f64 = 3e-7;
const FINE_ERROR: f64 = 1e-10;

/// The structure through its ports.
#[derive(Debug, Clone)]
pub(super) struct Ports {
    /// Lambda, rad/s.
    pub lambdas: Vec<Complex<f64>>,
    /// `V^H B`, p x m.
    pub force: DMatrix<Complex<f64>>,
    /// The same by rows.
    pub force_rows: Rows,
    /// `R Y` and `B^T Y`, m x p.
    pub sides: [DMatrix<Complex<f64>>; 2],
    /// `R F B` and `B^T F B` for paths.
    pub path: Table<f32>,
    /// The same for the last digits.
    pub fine: Table,
    /// The same with what its points differ by.
    pub differences: Differences,
    /// What a unit of the gains mu and `lambda s(lambda)` of each port moves the near modes by at most, rad/s.
    pub moved: [Vec<f64>; 2],
    /// The sums of their squares.
    pub moved_by_all: [f64; 2],
    /// Where the near modes end, rad/s.
    pub end: f64,
    /// i omega in the middle of the band.
    pub middle: Complex<f64>,
    /// M, k x k.
    pub mass: DMatrix<f64>,
    /// What shapes are made of.
    pub shapes: Shapes,
    /// The same for paths.
    pub path_shapes: Shapes<f32>,
}

impl Ports {
    /// The structure of a system through some of its channels, for a band of frequencies, rad/s, and samples of what is smooth in it; `None`
    /// where no small tables hold that.
    ///
    /// # Errors
    /// A mass matrix that is singular, a table that cannot be made.
    pub fn new(
        structure: &SecondOrder,
        system: &AffineSystem,
        channels: &[usize],
        band: [f64; 2],
    ) -> Result<Option<(Self, Samples)>, ReductionError> {
        let order = structure.order();
        let gamma = band[1];
        let StateModes { lambdas, y: right, lower, .. } = StateModes::new(structure, gamma)?;
        let wide = |a: DMatrix<f64>| a.map(Complex::from);
        let force = wide(system.force_matrix().select_columns(channels));
        let reading = wide(system.reading_matrix().select_rows(channels));
        let end = end_of_near(&lambdas, band[1]);
        let is_near = |at: &usize| lambdas[*at].im > 0.0 && lambdas[*at].im <= end;
        let (mut near, others): (Vec<usize>, Vec<usize>) = (0..2 * order).partition(is_near);
        near.sort_by(|&a, &b| cea::by_frequency(&lambdas[a], &lambdas[b]));

        let driven = lower * &force / Complex::from(gamma);
        let read = [&reading * &right, force.transpose() * &right];
        let count = channels.len();
        let others_driven = Rows::of(&driven.select_rows(&others));
        let smooth = |lambda: Complex<f64>| {
            let part = |side: &DMatrix<Complex<f64>>| {
                let mut part = Rows::zeros(count, count);
                for port in 0..count {
                    let factors = others.iter().map(|&at| side[(port, at)] / (lambda - lambdas[at]));
                    add_rows(port, &factors.collect::<Vec<_>>(), &others_driven, &mut part);
                }
                part
            };
            [part(&read[0]), part(&read[1])]
        };
        let samples = Samples::new(band, ASIDE, smooth);
        let itself = |_: Complex<f64>, f: &[Rows; 2]| f.to_vec();
        let Some([path, fine]) = samples.tables(Region::Growing, [PATH_ERROR, FINE_ERROR], &itself)? else {
            return Ok(None);
        };
        let shapes = Shapes::new(&lambdas, &right, &driven, [&near, &others]);
        let force = driven.select_rows(&near);
        let sides = read.map(|side| side.select_columns(&near));
        let moved = sides.each_ref().map(|side| -> Vec<f64> {
            (0..count).map(|port| force.column(port).norm() * side.row(port).norm()).collect()
        });
        let ports = Self {
            lambdas: near.iter().map(|&at| lambdas[at]).collect(),
            moved_by_all: moved.each_ref().map(|moved| moved.iter().map(|moved| moved.powi(2)).sum()),
            moved,
            end,
            middle: Complex::new(0.0, 0.5 * (band[0] + band[1])),
            force_rows: Rows::of(&force),
            force,
            sides,
            path: path.single(),
            differences: fine.differences(),
            fine,
            mass: structure.m.clone(),
            path_shapes: shapes.single(),
            shapes,
        };
        Ok(Some((ports, samples)))
    }

    /// p, the number of modes in and near the band.
    pub fn near(&self) -> usize {
        self.lambdas.len()
    }

    /// m, the number of ports.
    pub fn count(&self) -> usize {
        self.force.ncols()
    }
}

/// The frequency in the middle of the largest gap, by ratio, between the frequencies of modes at the end of a band.
fn end_of_near(lambdas: &[Complex<f64>], highest: f64) -> f64 {
    let [from, to] = NEAR.map(|part| part * highest);
    let mut inside: Vec<f64> = lambdas.iter().map(|lambda| lambda.im).filter(|im| (from..to).contains(im)).collect();
    inside.extend([from, to]);
    inside.sort_by(f64::total_cmp);
    let widest = inside.windows(2).max_by(|a, b| (a[1] / a[0]).total_cmp(&(b[1] / b[0])));
    widest.map_or(to, |gap| (gap[0] * gap[1]).sqrt())
}
