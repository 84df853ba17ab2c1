//! The stability map over two parameters.

use std::collections::BTreeMap;

use cea::{EigenSolver, Workspace};
use montecarlo::Progress;
use num_complex::Complex;
use rayon::prelude::*;

use super::boundary::BoundaryCurve;
use super::divergence::sign;
use super::family::{Evaluations, Family, Part};
use super::parameter::{Over, SweptParameter};
use super::part_map::{GRID, of_part};
use super::regions::{CELLS, Region, Run, regions, runs};
use crate::Error;
use crate::study::{Study, UncertainBrake};

/// A stability map.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityMap {
    /// The two parameters.
    pub parameters: [SweptParameter; 2],
    /// The boundary.
    pub curves: Vec<BoundaryCurve>,
    /// Regions, the largest first.
    pub regions: Vec<Region>,
    /// The number of unstable modes along rows of cells, from below.
    pub rows: Vec<Run>,
    /// Intervals of the grid of lines: a closed curve between two neighbouring lines of both directions is not found.
    pub grid: usize,
    /// Steps on lines of the grid in which a mode comes so near the axis that it is not known whether it crosses.
    pub unresolved: usize,
    /// Regions in which a spectrum has another number of unstable modes than the curves say: a curve is missing there.
    pub contradicted: Vec<Region>,
    /// The largest distance of the boundary from that of the brake that this one is a reduction of, as a part of the ranges, at the ends
    /// and in the middle of each curve; `None` of a brake that is not reduced.
    pub from_whole: Option<f64>,
    /// What was computed.
    pub evaluations: Evaluations,
    /// Spectra on a grid with one in each cell of the figure, of all sectors.
    pub fine_grid: u64,
}

impl StabilityMap {
    /// By number of unstable modes: the part of the map that has so many, and in how many regions.
    #[must_use]
    pub fn shares(&self) -> BTreeMap<usize, (f64, usize)> {
        let mut shares = BTreeMap::new();
        for region in &self.regions {
            let (share, regions): &mut (f64, usize) = shares.entry(region.unstable).or_default();
            *share += region.share;
            *regions += 1;
        }
        shares
    }
}

/// The stability map of a scene of a study over two parameters: of modes that oscillate, and of divergence where frequencies from zero
/// are studied.
///
/// # Errors
/// Parameters or ranges that the scene does not have, a value that the brake refuses, and those of [`tracking::find_onsets`].
pub fn stability_map<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &[Over; 2],
    solver: &dyn EigenSolver,
    progress: &dyn Progress,
) -> Result<StabilityMap, Error> {
    let family = Family::new(study, scene, over, solver)?;
    let parts = family.parts()?;
    // A step for each line of the grid, and one for following the curves.
    progress.begin((parts.len() * (2 * (GRID + 1) + 1)) as u64, 0);
    let of_part = |part: &Part<'_, B>| of_part(part, progress);
    let found = parts.par_iter().map(of_part).collect::<Result<Vec<_>, Error>>();
    progress.end();
    let found = found.map_err(|source| {
        let at = format!("sweep over {} and {}", over[0], over[1]);
        Error::Sweep { at, source: Box::new(source) }
    })?;
    let (mut curves, mut lines) = (Vec::new(), Vec::new());
    let (mut evaluations, mut unresolved, mut edges) = (Evaluations::default(), 0, Vec::new());
    let mut from_whole: Option<f64> = None;
    for part in found {
        for (curve, line) in part.curves {
            curves.push(curve);
            lines.push(line);
        }
        edges.push(part.on_left);
        unresolved += part.unresolved;
        from_whole = from_whole.into_iter().chain(part.from_whole).reduce(f64::max);
        evaluations += part.evaluations;
    }
    let on_left = |y: f64| -> i64 {
        let of_edge = |(start, onsets): &(i64, Vec<(f64, i64)>)| {
            start + onsets.iter().filter(|(at, _)| *at < y).map(|(_, change)| change).sum::<i64>()
        };
        edges.iter().map(of_edge).sum()
    };
    let rows = runs(&lines, &on_left);
    let regions = regions(&rows);
    let counts = regions.par_iter().map(|region| unstable(&parts, &region.at));
    let counts = counts.collect::<Result<Vec<_>, Error>>()?;
    evaluations.spectra += (parts.len() * regions.len()) as u64;
    let differs = |(region, count): (&Region, usize)| (region.unstable != count).then_some(*region);
    Ok(StabilityMap {
        contradicted: regions.iter().zip(counts).filter_map(differs).collect(),
        parameters: [family.parameters[0].clone(), family.parameters[1].clone()],
        curves,
        regions,
        rows,
        grid: GRID,
        unresolved,
        from_whole,
        evaluations,
        fine_grid: (CELLS * CELLS * parts.len()) as u64,
    })
}

/// The number of unstable modes by spectra, of real eigenvalues beyond the threshold too where K is regular.
fn unstable<B: UncertainBrake>(parts: &[Part<'_, B>], at: &[f64; 2]) -> Result<usize, Error> {
    let of_part = |part: &Part<'_, B>| {
        let system = part.system(at)?;
        let spectrum = part.family.solver.eigenvalues(&system, &mut Workspace::default())?;
        let flutter = spectrum
            .oscillatory()
            .filter(|&lambda| part.threshold().margin(lambda) >= 0.0 && part.is_studied(lambda.im))
            .count();
        let counts_real = part.is_studied(0.0) && sign(&system, part.real_onset()).is_some();
        let is_diverging =
            |lambda: &&Complex<f64>| counts_real && lambda.im == 0.0 && part.threshold().margin(**lambda) > 0.0;
        Ok(flutter + spectrum.eigenvalues.iter().filter(is_diverging).count())
    };
    parts.iter().map(of_part).sum()
}
