//! The growing modes of samples that differ in friction alone: found without following every mode, and counted.
//!
//! Friction acts in m ports, and all that it does to a structure is seen there. The structure is taken apart once into its modes
//! ([`ports`]); of a sample there remains an eigenvalue problem of the modes in and near the band, in which all others are eliminated
//! ([`coupling`]). Its eigenvalues are known for a few draws ([`anchor`]). Where all ports have one gain, that problem is a polynomial around
//! these ([`expansion`]), and discs tell which modes may grow ([`discs`]); elsewhere modes are guessed, and corrected and counted
//! ([`guessed`]). A sample that both leave open goes the way of [`Reduced::modes_among`]. Modes that grow get their last digits
//! ([`refinement`]).

mod anchor;
mod change;
mod coarse;
mod count;
mod coupling;
mod discs;
mod expansion;
mod guessed;
mod own;
mod pair;
mod path;
mod ports;
mod refinement;
mod residuals;
mod search;
mod secant;
mod shapes;
mod table;
mod vectors;

use linsys::{ChannelGain, OperatingPoint};
use num_complex::Complex;

pub use self::path::{FrictionPath, OnFrictionPath};
pub use self::search::Likeness;

use self::anchor::Anchor;
use self::coarse::Coarse;
use self::coupling::Coupled;
use self::ports::Ports;
use self::residuals::{OfSample, Residuals};
use self::search::{Memory, Search, Way};
use self::shapes::Found;
use self::table::GROWING;
use super::{Reduced, ReducedModes, Route};
use crate::ReductionError;
use cea::certified::lanes::cast;

/// Most points at which modes are known; chosen: on cases/disc-pad samples take some 6 percent more time with 32, and no less with 96, which take
/// as much more memory.
const MOST_ANCHORS: usize = 64;

/// With how many known points, the nearest first, a mode is compared; chosen.
const MOST_LIKENESSES: usize = 8;

/// The amplitudes in a mode of those of the structure in and near the band, and the known points that are nearest to its sample.
#[derive(Debug, Clone)]
pub struct Amplitudes {
    values: Vec<Complex<f32>>,
    nearest: Vec<usize>,
}

/// A reduced brake whose structure stays and whose friction differs from sample to sample.
#[derive(Debug, Clone)]
pub struct FrictionModes {
    coefficients: Vec<f64>,
    channels: Vec<usize>,
    ports: Ports,
    coarse: Coarse,
    /// What A is made of in the coordinates of the structure.
    own: Coupled<f64>,
    /// What friction adds to it, in single precision.
    added: Coupled<f32>,
    anchors: Vec<Anchor>,
    residuals: Residuals,
}

/// Working memory for one sample after another.
pub struct FrictionSearch<'a> {
    modes: &'a FrictionModes,
    memory: Memory,
    gains: Vec<ChannelGain>,
}

impl FrictionModes {
    /// For operating points with the coefficients of `points`, which are known samples, and friction in some of the channels. `None` where
    /// the points have different coefficients, or where what the structure does beyond the band is not smooth in it.
    ///
    /// # Errors
    /// A point of another system, a reduced mass matrix that is singular.
    pub fn new(
        reduced: &Reduced,
        points: &[OperatingPoint],
        channels: &[usize],
    ) -> Result<Option<Self>, ReductionError> {
        let system = reduced.system();
        points.iter().try_for_each(|point| system.check(point))?;
        let Some(first) = points.first() else { return Ok(None) };
        if channels.is_empty() || points.iter().any(|point| point.coefficients != first.coefficients) {
            return Ok(None);
        }
        let structure = system.structure(&first.coefficients)?;
        let gains = |point: &OperatingPoint| channels.iter().map(|&channel| point.channels[channel]).collect();
        let known: Vec<Vec<ChannelGain>> = points.iter().map(gains).collect();
        let band = reduced.rectangle().im;
        let Some((ports, samples)) = Ports::new(&structure, system, channels, band)? else { return Ok(None) };
        let own = Coupled::of_structure(&ports);
        let Some(coarse) = Coarse::new(&ports, &own, &samples, &known, band)? else { return Ok(None) };
        let anchors = anchor::spread(&ports, known, MOST_ANCHORS)
            .into_iter()
            .map(|gains| Anchor::new(&ports, &own, &coarse, gains));
        let anchors = anchors.filter_map(Result::transpose).collect::<Result<_, _>>()?;
        let residuals = Residuals::new(reduced.form(), &first.coefficients, structure, system);
        let coefficients = first.coefficients.clone();
        let added = own.added();
        Ok(Some(Self { coefficients, channels: channels.to_vec(), ports, coarse, own, added, anchors, residuals }))
    }

    /// Begins a search.
    #[must_use]
    pub fn search(&self) -> FrictionSearch<'_> {
        FrictionSearch { modes: self, memory: Memory::new(&self.ports, &self.coarse), gains: Vec::new() }
    }

    /// The points at which modes are known, by the friction of the channels, with their eigenvalues, rad/s.
    pub fn known_points(&self) -> impl ExactSizeIterator<Item = (&[ChannelGain], &[Complex<f64>])> {
        self.anchors.iter().map(Anchor::known)
    }

    /// How like a mode is to those at some known points, the nearest first: to first order in what friction adds.
    pub fn likenesses(&self, Amplitudes { values, nearest }: &Amplitudes) -> impl Iterator<Item = Likeness> {
        nearest.iter().map(|&point| Likeness { point, mac: self.anchors[point].mac(values) })
    }

    /// Whether a point differs from the known ones in the friction of the channels alone.
    fn is_of(&self, point: &OperatingPoint) -> bool {
        let is_open = |(channel, gain): (usize, &ChannelGain)| {
            *gain == ChannelGain::default() || self.channels.contains(&channel)
        };
        point.coefficients == self.coefficients && point.channels.iter().enumerate().all(is_open)
    }
}

impl FrictionSearch<'_> {
    /// The modes of each of some points in the rectangle of the brake with `Re lambda >= -part |lambda|` that are wanted, with their residuals,
    /// and what [`FrictionModes::likenesses`] needs of each, where it is known. The brake is the one that the modes were made of; a point of
    /// another structure goes the way of [`Reduced::modes_among`] as a whole. Points whose friction is nearly the same take less time one
    /// after another.
    ///
    /// # Errors
    /// As [`Reduced::modes`], of each point.
    pub fn modes(
        &mut self,
        reduced: &Reduced,
        points: &[OperatingPoint],
        part: f64,
        is_wanted: &dyn Fn(Complex<f64>) -> bool,
    ) -> Vec<Result<(ReducedModes, Vec<Amplitudes>), ReductionError>> {
        let FrictionModes { residuals, ports, .. } = self.modes;
        let (mut samples, mut amplitudes) = (Vec::new(), Vec::new());
        let mut is_found = Vec::with_capacity(points.len());
        for point in points {
            let found = self.found(reduced, point, part, is_wanted);
            is_found.push(found.is_some());
            if let Some(sample) = found {
                amplitudes.push(sample.found.iter().map(|mode| self.amplitudes(mode)).collect());
                samples.push(sample);
            }
        }
        let judged = residuals.judged(reduced, &ports.shapes, &samples);
        let open: Vec<_> = points.iter().zip(&is_found).filter(|(_, is_found)| !**is_found).collect();
        let open: Vec<OperatingPoint> = open.into_iter().map(|(point, _)| point.clone()).collect();
        let mut left = reduced.modes_of_all(&open, is_wanted).into_iter().map(|found| Ok((found?, Vec::new())));
        let mut found = judged.into_iter().zip(amplitudes).map(Ok);
        is_found.into_iter().filter_map(|is_found| if is_found { found.next() } else { left.next() }).collect()
    }

    /// The modes of a sample, in the order in which they are judged; `None` where the search leaves it open.
    fn found(
        &mut self,
        reduced: &Reduced,
        point: &OperatingPoint,
        part: f64,
        is_wanted: &dyn Fn(Complex<f64>) -> bool,
    ) -> Option<OfSample> {
        let ways = reduced.ways();
        if !(ways.discs || ways.guesses) || !self.modes.is_of(point) {
            return None;
        }
        let FrictionModes { channels, ports, coarse, own, added, anchors, .. } = self.modes;
        self.gains.clear();
        self.gains.extend(channels.iter().map(|&channel| point.channels[channel]));
        let search = Search { ports, coarse, own, added, anchors, rectangle: reduced.rectangle(), ways };
        let before = self.memory.corrections;
        let (mut found, way) = search.growing(&self.gains, part, &mut self.memory).ok()?;
        found.retain(|found| is_wanted(found.lambda));
        // What grows faster is not held by the tables.
        if found.iter().any(|mode| mode.lambda.re > GROWING * reduced.rectangle().im[1]) {
            return None;
        }
        found.sort_by(|a, b| cea::by_frequency(&a.lambda, &b.lambda));
        let point = OperatingPoint { coefficients: vec![1.0], channels: point.channels.clone() };
        let corrections = self.memory.corrections - before;
        let route = match way {
            Way::Discs => Route::Discs { corrections },
            Way::Guesses => Route::Guesses { corrections },
        };
        Some(OfSample { point, found, route })
    }

    /// The amplitudes of a mode of the last sample.
    fn amplitudes(&self, mode: &Found) -> Amplitudes {
        let nearest = self.memory.nearest.iter().take(MOST_LIKENESSES).copied().collect();
        Amplitudes { values: mode.amplitudes.iter().map(|&amplitude| cast(amplitude)).collect(), nearest }
    }
}

#[cfg(test)]
mod tests;
