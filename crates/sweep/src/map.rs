//! The stability map over two parameters.

use std::collections::BTreeMap;

use cea::{CountedSpectrum, EigenSolver, Workspace};
use montecarlo::Progress;
use rayon::prelude::*;
use study::{Study, UncertainBrake};

use super::boundary::BoundaryCurve;
use super::family::{Evaluations, Family, Part};
use super::line_map::{LinesOfPart, MapLines, lines, opens_along};
use super::parameter::{Over, SweptParameter};
use super::part_map::{PartMap, of_part};
use super::regions::{CELLS, Region, Run, places_apart, regions, runs, shares};
use crate::Error;

/// Numbers of intervals of the grid of lines on which boundary curves are looked for, one after the other until no spectrum contradicts
/// what is found; chosen: a curve that meets no line is not found.
const GRIDS: [usize; 4] = [8, 16, 32, 64];
/// Most eigenvalues of a brake with which all grids and checks are tried; of a larger one the first two grids, and a check in each region
/// alone; chosen.
const SMALL: usize = 160;
/// Number of cells of the figure between two checks; chosen.
const BETWEEN_CHECKS: usize = 10;

/// A stability map.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct StabilityMap {
    /// Parameters of the map, x and y.
    pub parameters: [SweptParameter; 2],
    /// Curves of the boundary.
    pub curves: Vec<BoundaryCurve>,
    /// Regions, the largest first.
    pub regions: Vec<Region>,
    /// Numbers of unstable modes along rows of cells, from below.
    pub rows: Vec<Run>,
    /// Number of intervals of the grid of lines: a closed curve between two neighbouring lines of both directions is not found.
    pub grid: usize,
    /// Number of steps on lines of the grid in which a mode comes so near the threshold that it is not known whether it crosses.
    pub unresolved: usize,
    /// Lines on which the map rests where contact points open and close in it, or growing modes enter the band or leave it, so that no boundary is
    /// followed; `None` else.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lines: Option<MapLines>,
    /// True if divergence was looked for; of a reduced brake it is not.
    pub counts_divergence: bool,
    /// Number of places at which a spectrum has the number of unstable modes that the curves say.
    pub checks: usize,
    /// Largest distance of the boundary from the boundary of the full model, as a fraction of the ranges, at the ends
    /// and in the middle of each curve; `None` for a brake that is not reduced.
    pub from_whole: Option<f64>,
    /// Numbers of spectra, vectors and eigenvalues computed.
    pub evaluations: Evaluations,
    /// Number of spectra on a grid with one in each cell of the figure, of all sectors.
    pub fine_grid: u64,
}

impl StabilityMap {
    /// Words for what shares of the map are shares of, where an axis is logarithmic: not of the values of the parameter there.
    #[must_use]
    pub fn share_in_words(&self) -> Option<String> {
        let logarithmic = self.parameters.iter().filter(|parameter| parameter.is_logarithmic);
        let names: Vec<&str> = logarithmic.map(|parameter| parameter.name.as_str()).collect();
        (!names.is_empty()).then(|| {
            let of = names.join(" and ");
            format!("shares are of the area as drawn, whose axis of {of} is logarithmic: a decade counts as much as any other")
        })
    }

    /// Fraction of the map that has each number of unstable modes, narrow regions too, and number of its regions that are listed.
    #[must_use]
    pub fn shares(&self) -> BTreeMap<usize, (f64, usize)> {
        let listed = |unstable: usize| self.regions.iter().filter(|region| region.unstable == unstable).count();
        shares(&self.rows).into_iter().map(|(unstable, share)| (unstable, (share, listed(unstable)))).collect()
    }

    /// Fraction of the map that is in regions too narrow to be listed, which no spectrum checks.
    #[must_use]
    pub fn narrow_share(&self) -> f64 {
        let cells = (CELLS * CELLS) as f64;
        let listed: f64 = self.regions.iter().map(|region| (region.share * cells).round()).sum();
        (cells - listed) / cells
    }
}

/// The stability map of a scene of a study over two parameters: of modes that oscillate and, unless the brake is reduced, of divergence.
///
/// # Errors
/// Parameters or ranges that the scene does not have, a value that the brake refuses,
/// [`Error::MapContradicted`] where a spectrum contradicts the curves of the finest grid too, and errors of the solver.
pub fn stability_map<B: UncertainBrake>(
    study: &Study<'_, B>,
    scene: usize,
    over: &[Over; 2],
    solver: &dyn EigenSolver,
    progress: &dyn Progress,
) -> Result<StabilityMap, Error> {
    let family = Family::new(study, scene, over, solver, progress)?;
    let mut along = opens_along(&family)?;
    // Contact points that open keep no symmetry.
    let mut parts = if along.is_some() { vec![family.whole()] } else { family.parts()? };
    let in_words = |source: Error| source.in_sweep(study.plan(), || format!("sweep over {} and {}", over[0], over[1]));
    let middle = parts.iter().map(|part| part.system(&[0.5, 0.5])).collect::<Result<Vec<_>, Error>>()?;
    let is_small = middle.iter().all(|system| 2 * system.order() + system.states() <= SMALL);
    let mut evaluations = Evaluations::default();
    let mut grids = GRIDS.into_iter().skip(1).take(if is_small { GRIDS.len() } else { 1 });
    let mut grid = GRIDS[0];
    loop {
        let followed = match along {
            Some(_) => None,
            None => {
                // A step for each line of the grid, and one for following the curves.
                progress.begin((parts.len() * (2 * (grid + 1) + 1)) as u64, 0);
                let mapped = |part: &Part<'_, B>| of_part(part, grid, progress);
                let found = parts.par_iter().map(mapped).collect::<Result<Vec<_>, Error>>();
                progress.end();
                Some(found.map_err(in_words)?)
            }
        };
        let mut map = match followed {
            Some(found) if !found.iter().any(|part| part.meets_band) => drawn(&family, found, grid),
            followed => {
                // Where it runs along an end of the band the boundary is no curve of one mode at the threshold: lines serve from here on.
                for part in followed.into_iter().flatten() {
                    evaluations += part.evaluations;
                }
                if along.is_none() {
                    progress.tell("the boundary runs along an end of the band: lines are swept in place of curves");
                    (along, parts) = (Some(0), vec![family.whole()]);
                }
                progress.begin((2 * grid + 1) as u64, 0);
                let found = lines(&parts[0], along.unwrap_or(0), 2 * grid + 1, progress);
                progress.end();
                by_lines(&family, found.map_err(in_words)?, grid)
            }
        };
        let mut checks = map.regions.clone();
        if is_small {
            checks.extend(places_apart(&map.rows, BETWEEN_CHECKS));
        }
        let counts = checks.par_iter().map(|place| unstable(&parts, &place.at)).collect::<Result<Vec<_>, Error>>()?;
        map.checks = checks.len();
        map.evaluations.spectra += (parts.len() * checks.len()) as u64;
        map.evaluations += evaluations;
        evaluations = map.evaluations;
        let Some((place, found)) = checks.into_iter().zip(counts).find(|(place, count)| place.unstable != *count)
        else {
            return Ok(map);
        };
        let [x, y] = [0, 1].map(|axis| format!("{} = {}", over[axis].name, family.parameters[axis].at(place.at[axis])));
        let source = Error::MapContradicted { at: format!("{x}, {y}"), found, expected: place.unstable };
        let Some(finer) = grids.next() else { return Err(in_words(source)) };
        progress.tell(&format!(
            "at {x}, {y} a spectrum has {found} unstable modes and the map {}: a curve is missing, and lines are refined from {grid} intervals to \
             {finer}",
            place.unstable
        ));
        grid = finer;
    }
}

/// The map of lines, not checked yet.
fn by_lines<B: UncertainBrake>(family: &Family<'_, B>, found: LinesOfPart, grid: usize) -> StabilityMap {
    let LinesOfPart { lines, rows, unresolved, evaluations } = found;
    StabilityMap {
        parameters: [family.parameters[0].clone(), family.parameters[1].clone()],
        curves: Vec::new(),
        regions: regions(&rows),
        rows,
        grid,
        unresolved,
        lines: Some(lines),
        counts_divergence: family.counts_divergence(),
        checks: 0,
        from_whole: None,
        evaluations,
        fine_grid: (CELLS * CELLS) as u64,
    }
}

/// The map of all parts, not checked yet.
fn drawn<B: UncertainBrake>(family: &Family<'_, B>, found: Vec<PartMap>, grid: usize) -> StabilityMap {
    let parts = found.len();
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
    StabilityMap {
        parameters: [family.parameters[0].clone(), family.parameters[1].clone()],
        curves,
        regions: regions(&rows),
        rows,
        grid,
        unresolved,
        lines: None,
        counts_divergence: family.counts_divergence(),
        checks: 0,
        from_whole,
        evaluations,
        fine_grid: (CELLS * CELLS * parts) as u64,
    }
}

/// The number of unstable modes by spectra.
fn unstable<B: UncertainBrake>(parts: &[Part<'_, B>], at: &[f64; 2]) -> Result<usize, Error> {
    let of_part = |part: &Part<'_, B>| {
        let (system, mut work) = (part.system(at)?, Workspace::default());
        let spectrum = part.family.solver.eigenvalues(&system, &mut work)?;
        let counted = CountedSpectrum::new(&part.threshold(), &system, &spectrum, &mut work)?;
        Ok(part.counted(&counted).iter().sum::<usize>())
    };
    parts.iter().map(of_part).sum()
}
