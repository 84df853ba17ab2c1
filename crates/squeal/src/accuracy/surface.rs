//! Which modes are unstable, from their critical coefficients instead of a spectrum: a guess in nanoseconds.
//!
//! In each row of [`FrictionPoints`] the complex slope H is held and mu alone changes. The spectra at some mu show which
//! named modes change between stable and unstable; Newton's method finds where. Away from such a point the axis is crossed
//! where, to first order,
//!
//! ```text
//! 0 = Re(lambda_mu (mu - mu_c) + lambda_H (H - H_c)),    lambda_mu = -psi^H K_1 phi / psi^H Q' phi,
//!                                                        lambda_H = -lambda psi^H C_1 phi / psi^H Q' phi
//! ```
//!
//! with C_1 the damping matrix of a unit slope. Where two rows have the same changes of a mode, its critical mu is
//! interpolated between them to third order. Where they have not, the mode changes along the slope as well: the points
//! where it does so are found for each mu, and those around a sample speak for it. All this is a guess, whose error
//! [`controlled`](super::controlled) measures.

use std::collections::{BTreeMap, BTreeSet};

use cea::{BatchSolver, EigenSolver, Workspace};
use friction::Tangent;
use linsys::SecondOrder;
use num_complex::Complex;

use super::AccuracyError;
use super::draws::FrictionPoints;
use super::row::{Column, Row};
use crate::study::Study;

/// Coefficients per row at which spectra are computed.
const COLUMNS: usize = 11;
/// Halvings of a step in which a name ends without a crossing.
const HALVINGS: usize = 4;

/// Where a mode crosses the axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    pub mu: f64,
    /// i Im lambda, rad/s.
    pub axis: Complex<f64>,
    /// H.
    pub slope: Complex<f64>,
    /// Re lambda_mu; 0 where a name ends without a crossing.
    pub by_mu: f64,
    /// lambda_H.
    pub by_slope: Complex<f64>,
}

impl Crossing {
    /// Re lambda by the expansion about this crossing.
    fn growth(&self, tangent: &Tangent) -> f64 {
        let slope = tangent.complex_slope(self.axis) - self.slope;
        self.by_mu * (tangent.mu - self.mu) + (self.by_slope * slope).re
    }

    /// d mu_c / d H: `mu_c` moves by the real part of its product with a change of the slope.
    fn tilt(&self) -> Complex<f64> {
        if self.by_mu == 0.0 { Complex::default() } else { -self.by_slope / self.by_mu }
    }

    /// The critical coefficient at the slope of `tangent`.
    fn critical(&self, tangent: &Tangent) -> f64 {
        self.mu + (self.tilt() * (tangent.complex_slope(self.axis) - self.slope)).re
    }
}

/// A mode in one row: whether it is unstable at the smallest mu, and where this changes, ascending.
#[derive(Debug, Clone, Default)]
struct Line {
    starts_unstable: bool,
    changes: Vec<Crossing>,
}

impl Line {
    fn is_unstable(&self, mu: f64) -> bool {
        self.starts_unstable ^ (self.changes.iter().filter(|change| change.mu < mu).count() % 2 == 1)
    }

    fn is_like(&self, other: &Self) -> bool {
        self.starts_unstable == other.starts_unstable && self.changes.len() == other.changes.len()
    }
}

/// The guess of one scene.
#[derive(Debug, Clone)]
pub struct Surface {
    names: Vec<u16>,
    /// By row and name.
    rows: Vec<Vec<Line>>,
    /// By step between rows and name: changes along the slope, with the part of the step.
    between: Vec<Vec<Vec<(f64, Crossing)>>>,
    /// By name: i times its frequency at the axis, and Re H of each row there, ascending.
    slopes: Vec<(Complex<f64>, Vec<f64>)>,
    /// Distance of two columns.
    step: f64,
}

impl Surface {
    /// Finds the changes of a scene in every row, and between rows that differ.
    ///
    /// # Errors
    /// What the model, a law and the solver refuse.
    pub fn new(study: &Study<'_>, scene: usize, points: &FrictionPoints) -> Result<Self, AccuracyError> {
        let mut work = Workspace::default();
        let [from, to] = points.range;
        let mus: Vec<f64> = (0..COLUMNS).map(|i| from + (to - from) * i as f64 / (COLUMNS - 1) as f64).collect();
        let mut systems = Vec::with_capacity(points.rows.len());
        let mut columns = Vec::with_capacity(points.rows.len());
        let mut lines = Vec::with_capacity(points.rows.len());
        for sample in &points.rows {
            let mut row = Row::new(study, scene, sample)?;
            let found = spectra(&mut row, study, scene, &mus, &mut work)?;
            lines.push(row_lines(&mut row, study, scene, &mus, &found, &mut work)?);
            systems.push(row);
            columns.push(found);
        }
        let names: BTreeSet<u16> = lines.iter().flat_map(|row| row.keys().copied()).collect();
        let names: Vec<u16> = names.into_iter().collect();
        let line = |row: &BTreeMap<u16, Line>, name| row.get(name).cloned().unwrap_or_default();
        let rows: Vec<Vec<Line>> = lines.iter().map(|row| names.iter().map(|name| line(row, name)).collect()).collect();

        let mut between = Vec::with_capacity(rows.len());
        for k in 1..rows.len() {
            let of_name = |(place, &name): (usize, &u16)| {
                if rows[k - 1][place].is_like(&rows[k][place]) {
                    return Vec::new();
                }
                let ends = [&columns[k - 1][..], &columns[k][..]];
                along_slope(&mut systems[k - 1..=k], ends, &mus, name)
            };
            between.push(names.iter().enumerate().map(of_name).collect());
        }
        let slopes_of = |place: usize| {
            let on_axis = || {
                rows.iter().flat_map(|row: &Vec<Line>| &row[place].changes).chain(
                    between.iter().flat_map(|step: &Vec<Vec<(f64, Crossing)>>| step[place].iter().map(|(_, c)| c)),
                )
            };
            let axis = on_axis().map(|c| c.axis).sum::<Complex<f64>>() / on_axis().count().max(1) as f64;
            let mut slopes: Vec<f64> = systems.iter().map(|row| row.tangent.complex_slope(axis).re).collect();
            slopes.sort_by(f64::total_cmp);
            (axis, slopes)
        };
        let slopes = (0..names.len()).map(slopes_of).collect();
        Ok(Self { names, rows, between, slopes, step: mus[1] - mus[0] })
    }

    /// The modes that are unstable in some row, ascending.
    pub fn names(&self) -> &[u16] {
        &self.names
    }

    /// Whether the mode of a place in [`Surface::names`] is unstable, as far as can be guessed.
    pub(super) fn is_unstable(&self, place: usize, tangent: &Tangent) -> bool {
        let (axis, slopes) = &self.slopes[place];
        let slope = tangent.complex_slope(*axis).re;
        let at = slopes.partition_point(|&s| s <= slope).clamp(1, slopes.len() - 1) - 1;
        let (low, high) = (slopes[at], slopes[at + 1]);
        let w = if high > low { ((slope - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        let (below, above) = (&self.rows[at][place], &self.rows[at + 1][place]);
        if below.is_like(above) {
            let critical = |(a, b): (&Crossing, &Crossing)| {
                let bend = 0.5 * w * (1.0 - w) * ((b.tilt() - a.tilt()) * (b.slope - a.slope)).re;
                (1.0 - w) * a.critical(tangent) + w * b.critical(tangent) + bend
            };
            let passed = below.changes.iter().zip(&above.changes).filter(|&pair| critical(pair) < tangent.mu).count();
            return below.starts_unstable ^ (passed % 2 == 1);
        }
        let mut growth = 0.0;
        let mut blend = |part: f64, crossing: &Crossing| {
            let across = (tangent.mu - crossing.mu) / self.step;
            if across.abs() <= 1.0 && crossing.by_mu != 0.0 {
                growth += crossing.growth(tangent) / (across.powi(2) + (w - part).powi(2) + 1e-9);
            }
        };
        self.between[at][place].iter().for_each(|(part, crossing)| blend(*part, crossing));
        below.changes.iter().for_each(|crossing| blend(0.0, crossing));
        above.changes.iter().for_each(|crossing| blend(1.0, crossing));
        if growth == 0.0 {
            return if w < 0.5 { below } else { above }.is_unstable(tangent.mu);
        }
        growth > 0.0
    }
}

/// Where, at each mu, the mode `name` changes on the way from one row to the next, as parts of that way.
fn along_slope(rows: &mut [Row], columns: [&[Column]; 2], mus: &[f64], name: u16) -> Vec<(f64, Crossing)> {
    let tangents = [rows[0].tangent, rows[1].tangent];
    let mut found = Vec::new();
    for (i, &mu) in mus.iter().enumerate() {
        let ends = columns.map(|column| column[i].unstable.get(&name).copied());
        let (from, lambda) = match ends {
            [Some(lambda), None] => (0, lambda),
            [None, Some(lambda)] => (1, lambda),
            _ => continue,
        };
        rows[from].at(mu);
        let other = columns[1 - from][i].nearest(lambda);
        if let Some((part, crossing)) = rows[from].along_slope(&tangents[1 - from], lambda, other) {
            found.push((if from == 0 { part } else { 1.0 - part }, Crossing { mu, ..crossing }));
        }
    }
    found
}

/// The spectra of a row, solved together.
fn spectra(
    row: &mut Row,
    study: &Study<'_>,
    scene: usize,
    mus: &[f64],
    work: &mut Workspace,
) -> Result<Vec<Column>, AccuracyError> {
    let systems: Vec<SecondOrder> = mus.iter().map(|&mu| row.at(mu).clone()).collect();
    let mut spectra = Vec::with_capacity(systems.len());
    BatchSolver.eigenvalues_of_all(&systems, work, &mut spectra);
    let column = |(system, spectrum): (&SecondOrder, Result<cea::Spectrum, cea::CeaError>)| {
        Column::new(study, scene, system, &spectrum?, work)
    };
    systems.iter().zip(spectra).map(column).collect()
}

/// The line of every mode that is unstable at some mu.
fn row_lines(
    row: &mut Row,
    study: &Study<'_>,
    scene: usize,
    mus: &[f64],
    columns: &[Column],
    work: &mut Workspace,
) -> Result<BTreeMap<u16, Line>, AccuracyError> {
    let mut lines: BTreeMap<u16, Line> = BTreeMap::new();
    for &name in columns[0].unstable.keys() {
        lines.entry(name).or_default().starts_unstable = true;
    }
    for i in 1..columns.len() {
        let ends = [(mus[i - 1], &columns[i - 1]), (mus[i], &columns[i])];
        for (from, to) in [(ends[0], ends[1]), (ends[1], ends[0])] {
            let ended = from.1.unstable.iter().filter(|(name, _)| !to.1.unstable.contains_key(name));
            for (&name, &lambda) in ended {
                let change = match row.along_mu((from.0, lambda), (to.0, to.1.nearest(lambda))) {
                    Some(crossing) => crossing,
                    None => name_end(row, study, scene, name, (from.0, lambda), to.0, work)?,
                };
                lines.entry(name).or_default().changes.push(change);
            }
        }
    }
    lines.values_mut().for_each(|line| line.changes.sort_by(|a, b| a.mu.total_cmp(&b.mu)));
    Ok(lines)
}

/// Where a mode passes its name to another without a crossing.
fn name_end(
    row: &mut Row,
    study: &Study<'_>,
    scene: usize,
    name: u16,
    (mut named, lambda): (f64, Complex<f64>),
    mut other: f64,
    work: &mut Workspace,
) -> Result<Crossing, AccuracyError> {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (named + other);
        let system = row.at(middle).clone();
        let spectrum = BatchSolver.eigenvalues(&system, work)?;
        if Column::new(study, scene, &system, &spectrum, work)?.unstable.contains_key(&name) {
            named = middle;
        } else {
            other = middle;
        }
    }
    let axis = Complex::new(0.0, lambda.im);
    let slope = row.tangent.complex_slope(axis);
    Ok(Crossing { mu: 0.5 * (named + other), axis, slope, by_mu: 0.0, by_slope: Complex::default() })
}
