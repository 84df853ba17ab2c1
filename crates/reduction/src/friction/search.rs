//! The growing modes of one sample: known by discs or by guesses, and then refined.

use linsys::ChannelGain;
use num_complex::Complex;
use sparse::Rectangle;

use super::anchor::{Anchor, Pulls, shared};
use super::coarse::Coarse;
use super::count::Lanes;
use super::coupling::{Coupled, Scratch};
use super::discs::{Around, Discs, LEAST};
use super::ports::Ports;
use super::refinement::{Approached, Refinement, Sample, Start};
use super::shapes::Found;
use crate::Ways;
use crate::rows::{Rows, combined};

/// From how many known samples, the nearest first, discs are tried; chosen.
const MOST_TRIES: usize = 3;
/// Relative distance up to which two eigenvalues with last digits are one; chosen.
const SAME: f64 = 1e-8;

/// How like a mode is to those at a known point.
#[derive(Debug, Clone, PartialEq)]
pub struct Likeness {
    /// Which of the [`FrictionModes::known_points`](super::FrictionModes::known_points).
    pub point: usize,
    /// The modal assurance criterion (MAC) with each of the modes there, with the mass matrix as weight: to first order in what friction
    /// adds.
    pub mac: Vec<f64>,
}

/// Why a sample is left to another way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Open {
    NoAnchor,
    NotClear,
    NotConverged,
    NotCounted,
}

/// Working memory.
pub(super) struct Memory {
    pub discs: Discs,
    pub refinement: Refinement,
    /// For guesses and counts.
    pub single: Scratch<f32>,
    pub small: Rows<f32>,
    /// A at the coarse points.
    pub coarse: Vec<Rows<f32>>,
    /// For counts.
    pub lanes: Lanes,
    /// The anchors, from the one that is nearest to the last sample.
    pub nearest: Vec<usize>,
    pub weights: Vec<Complex<f64>>,
    /// Corrections so far.
    pub corrections: u64,
}

impl Memory {
    pub fn new(ports: &Ports, coarse: &Coarse) -> Self {
        let p = ports.near();
        Self {
            discs: Discs::new(ports),
            refinement: Refinement::new(ports),
            single: Scratch::new(ports),
            small: Rows::zeros(p, p),
            coarse: coarse.table.points.iter().map(|_| Rows::zeros(p, p)).collect(),
            lanes: Lanes::new(p, coarse.table.points.len()),
            nearest: Vec::new(),
            weights: Vec::new(),
            corrections: 0,
        }
    }
}

/// What is searched.
pub(super) struct Search<'a> {
    pub ports: &'a Ports,
    pub coarse: &'a Coarse,
    /// What A is made of in the coordinates of the structure, and what friction adds to it.
    pub own: &'a Coupled<f64>,
    pub added: &'a Coupled<f32>,
    pub anchors: &'a [Anchor],
    pub rectangle: &'a Rectangle,
    pub ways: Ways,
}

/// Which way led to the modes of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    Discs,
    Guesses,
}

impl Search<'_> {
    /// All modes in the rectangle with `Re lambda >= -part |lambda|`.
    pub fn growing(&self, gains: &[ChannelGain], part: f64, memory: &mut Memory) -> Result<(Vec<Found>, Way), Open> {
        let pulls = Pulls::of(self.ports, gains);
        let distances = self.anchors.iter().map(|anchor| anchor.distance(self.ports, &pulls)).zip(0..);
        let mut distances: Vec<(f64, usize)> = distances.collect();
        distances.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_wanted = |lambda: Complex<f64>, beyond: f64| {
            lambda.re >= -part * lambda.norm_sqr().sqrt() - beyond
                && self.rectangle.contains_to_the_right(lambda, beyond)
        };
        memory.nearest.clear();
        memory.nearest.extend(distances.iter().map(|(_, at)| *at));
        if let Some(gain) = shared(gains).filter(|_| self.ways.discs) {
            let expanded = distances.iter().map(|(_, at)| *at).filter(|&at| self.anchors[at].expansion.is_some());
            for at in expanded.take(MOST_TRIES) {
                if let Ok(found) = self.by_discs(at, gain, gains, &is_wanted, memory) {
                    return Ok((found, Way::Discs));
                }
            }
        }
        if !self.ways.guesses {
            return Err(Open::NotClear);
        }
        let &(_, nearest) = distances.first().ok_or(Open::NoAnchor)?;
        Ok((self.by_guesses(&self.anchors[nearest], gains, &is_wanted, memory)?, Way::Guesses))
    }

    /// Modes that are wanted, by discs around those of an anchor; all ports have one gain.
    fn by_discs(
        &self,
        at: usize,
        gain: &ChannelGain,
        gains: &[ChannelGain],
        is_wanted: &dyn Fn(Complex<f64>, f64) -> bool,
        memory: &mut Memory,
    ) -> Result<Vec<Found>, Open> {
        let Anchor { expansion: Some(expansion), vectors, own, .. } = &self.anchors[at] else {
            return Err(Open::NotClear);
        };
        let around = Around { expansion, own, table: &self.coarse.table };
        let unions = memory.discs.wanted(around, gain, is_wanted).ok_or(Open::NotClear)?;
        let mut found = Vec::new();
        for union in unions {
            for &mode in &union {
                let vector = memory.discs.vectors.of(mode);
                let start = Start { guess: memory.discs.centers[mode], vector: combined(&vector, vectors) };
                let near = self.approached(gains, start, memory)?;
                let mut lambda = near.lambda;
                // The one mode of a disc needs no last digits where it clearly is not wanted.
                if union.len() > 1 || is_wanted(lambda, LEAST * lambda.norm()) {
                    let mode = self.refined(gains, near, expansion.drift[mode].0, memory)?;
                    lambda = mode.lambda;
                    found.push(mode);
                }
                if !memory.discs.hold(&union, lambda) {
                    // Not the mode that the disc has.
                    return Err(Open::NotConverged);
                }
            }
        }
        all_of(found, is_wanted)
    }

    /// A mode in single precision.
    pub fn approached(&self, gains: &[ChannelGain], start: Start, memory: &mut Memory) -> Result<Approached, Open> {
        memory.refinement.approached(&self.sample(gains), start).ok_or(Open::NotConverged)
    }

    /// The mode that was approached last with its last digits.
    pub fn refined(
        &self,
        gains: &[ChannelGain],
        mode: Approached,
        drift: Complex<f32>,
        memory: &mut Memory,
    ) -> Result<Found, Open> {
        let (found, rounds) = memory.refinement.refined(&self.sample(gains), mode, drift);
        memory.corrections += rounds;
        found.ok_or(Open::NotConverged)
    }

    fn sample<'a>(&'a self, gains: &'a [ChannelGain]) -> Sample<'a> {
        let Self { ports, own, added, .. } = self;
        Sample { ports, own, added, gains }
    }
}

/// The modes found that are wanted; none of them may have been found twice.
pub(super) fn all_of(mut found: Vec<Found>, is_wanted: &dyn Fn(Complex<f64>, f64) -> bool) -> Result<Vec<Found>, Open> {
    let lambda = |found: &Found| found.lambda;
    let is_other = |(a, b): (&Found, &Found)| (lambda(a) - lambda(b)).norm() > SAME * lambda(a).norm();
    if !(1..found.len()).all(|next| found[..next].iter().all(|before| is_other((before, &found[next])))) {
        return Err(Open::NotConverged);
    }
    found.retain(|found| is_wanted(lambda(found), 0.0));
    Ok(found)
}
