//! The table for guesses, and the line on which modes are counted: between the points of the table A is read off A at them.

use linsys::ChannelGain;
use num_complex::Complex;

use super::count::Around;
use super::coupling::{self, Coupled, Gains, Scratch};
use super::ports::Ports;
use super::table::{ASIDE, Region, Samples, Table};
use crate::ReductionError;
use crate::rows::Rows;
use cea::certified::lanes::cast;

/// Relative error of what friction adds to A; chosen: on cases/disc-pad guesses are then good to some millionths, and with 1e-4 one sample in
/// 250 is left to the whole spectrum.
const ERROR: f64 = 1e-5;
/// Known samples for which this is so; chosen: two of each law of a study with three.
const SEEN: usize = 6;

/// A table with few points, in single precision, and that line.
#[derive(Debug, Clone)]
pub(super) struct Coarse {
    pub table: Table<f32>,
    pub around: Around,
}

impl Coarse {
    /// For gains like those of some known samples; `None` where no small table holds what they add.
    ///
    /// # Errors
    /// A table that cannot be made.
    pub fn new(
        ports: &Ports,
        own: &Coupled<f64>,
        samples: &Samples,
        known: &[Vec<ChannelGain>],
        band: [f64; 2],
    ) -> Result<Option<Self>, ReductionError> {
        let by_friction = |lambda: Complex<f64>, f: &[Rows; 2]| {
            let (mut scratch, p) = (Scratch::new(ports), ports.near());
            let of_gains = |gains: &Vec<ChannelGain>| {
                let mut added = Rows::zeros(p, p);
                coupling::with(own, lambda, f, Gains::of(gains), &mut scratch, &mut added);
                (0..p).for_each(|i| added.set(i, i, added.at(i, i) - ports.lambdas[i]));
                added
            };
            known.iter().take(SEEN).map(of_gains).collect()
        };
        let Some([table]) = samples.tables(Region::Around, [ERROR], &by_friction)? else { return Ok(None) };
        Ok(Some(Self { around: Around { band, distance: ASIDE * band[1] }, table: table.single() }))
    }

    /// The weights of the points at the frequency of an eigenvalue, or at the end of the band next to it.
    pub fn weights_near(&self, lambda: Complex<f64>) -> Vec<Complex<f32>> {
        let mut weights = Vec::new();
        let [low, high] = self.around.band;
        self.table.weights_at(Complex::new(0.0, lambda.im.clamp(low, high)), &mut weights);
        weights.into_iter().map(cast).collect()
    }
}
