//! A reduced system solved completely at one operating point, from where those at other points are found.

use linsys::{AffineSystem, ChannelGain, OperatingPoint, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;
use sparse::Rectangle;

use super::directions::{Directions, values};
use super::far::Far;
use super::full::{largest, outside};
use super::response::{Modes, Responses};
use super::state_modes::StateModes;
use super::watch::Watch;
use super::{dense, split};
use crate::ReductionError;

/// All eigenvalues of a reduced system at an operating point, with right and left vectors, and the terms of the system in the
/// vectors of the modes in and near the rectangle.
///
/// From those of [`StateModes`] comes `-Q(lambda)^-1 = sum_j y_j v_j^H / (gamma (lambda_j - lambda))`.
#[derive(Debug, Clone)]
pub(super) struct Anchor {
    /// Where the anchor is.
    pub point: OperatingPoint,
    /// gamma, rad/s.
    pub gamma: f64,
    /// The modes that are not near.
    pub far: Far,
    /// Whether any of them may come near.
    pub watch: Watch,
    /// The modes in and near the rectangle.
    pub near: Near,
    directions: Directions,
}

/// A p x p matrix between near modes.
type Square = DMatrix<Complex<f64>>;

/// The vectors of the near modes, and the terms between them.
#[derive(Debug, Clone)]
pub(super) struct Near {
    /// Right vectors y, split, k x 2 p.
    pub right: DMatrix<f64>,
    /// v^H, real parts above imaginary ones, 2 p x k.
    pub left: DMatrix<f64>,
    /// i omega in the middle of the band, for which internal states are slopes.
    middle: Complex<f64>,
    /// `W^H A Z` at the anchor, where `W^H B Z` is the identity: its eigenvalues, and what internal states are more than springs and dashpots.
    here: Square,
    /// What each term adds per unit of its coefficient; no matrix B where its M is zero.
    terms: Vec<(Square, Option<Square>)>,
    /// What each channel adds to `W^H A Z` per unit of mu, and per unit of its slope.
    channels: Vec<[Square; 2]>,
    /// What the other modes do.
    responses: Responses,
    /// Frobenius norms of what terms add to `W^H A Z`.
    of_terms: Vec<f64>,
    /// Those of what channels add.
    of_channels: Vec<[f64; 2]>,
}

/// How many margins from the rectangle modes are near; chosen, so that those that come in from a little beyond the margin are among them.
/// One that comes from farther is for `watch.rs`.
const NEAR: f64 = 2.0;

impl Anchor {
    /// Solves the system at a point; modes within twice the `margin` in which modes are followed are near.
    pub fn new(
        system: &AffineSystem,
        point: &OperatingPoint,
        rectangle: &Rectangle,
        margin: f64,
        directions: &Directions,
    ) -> Result<Self, ReductionError> {
        let (gamma, middle) = (largest(rectangle), middle(rectangle));
        let state_modes = StateModes::new(&without_states(system, values(point, middle).as_slice(), middle)?, gamma)?;
        let all = &state_modes.lambdas;

        let near_one = |lambda: Complex<f64>| outside(rectangle, lambda) <= NEAR * margin;
        let listed: Vec<usize> = (0..all.len()).filter(|&j| all[j].im >= 0.0).collect();
        let near: Vec<usize> = (0..all.len()).filter(|&j| near_one(all[j])).collect();
        let far = Far::new(&selected(&state_modes, &listed), gamma, near_one);
        let others: Vec<usize> = listed.iter().copied().filter(|&j| !near_one(all[j])).collect();
        let watch = Watch::new(system, &selected(&state_modes, &others), gamma, middle);
        let changes = directions.changes();
        let changes =
            changes.iter().map(|change| without_states(system, change, middle)).collect::<Result<Vec<_>, _>>()?;
        let others: Vec<usize> = (0..all.len()).filter(|&j| !near_one(all[j])).collect();
        let modes = selected(&state_modes, &near);
        let responses = Responses::new(&changes, &modes, &selected(&state_modes, &others), gamma);
        let near = Near::new(system, point, rectangle, &modes, responses);
        Ok(Self { point: point.clone(), gamma, far, watch, near, directions: directions.clone() })
    }

    /// The near modes at a point, to second order in what changes where `is_second`.
    pub fn modes(&self, point: &OperatingPoint, is_second: bool) -> Result<NearModes, ReductionError> {
        let along = is_second.then(|| self.directions.between([&self.point, point])).flatten();
        self.near.modes([&self.point, point], along.as_deref())
    }

    /// How far a point is: the changes of the coefficients, each times what it moves the near modes by, rad/s.
    pub fn distance(&self, point: &OperatingPoint) -> f64 {
        let terms = self.near.of_terms.iter().zip(self.point.coefficients.iter().zip(&point.coefficients));
        let terms = terms.map(|(moved, (here, there))| (here - there) * moved);
        let channels = self.near.of_channels.iter().zip(self.point.channels.iter().zip(&point.channels));
        let slope_at = |gain: &ChannelGain| gain.complex_slope(self.near.middle);
        let channels = channels.flat_map(|([friction, slope], (here, there))| {
            [(here.mu - there.mu) * friction, (slope_at(here) - slope_at(there)).norm() * slope]
        });
        terms.chain(channels).map(|part| part * part).sum::<f64>().sqrt()
    }
}

/// Some of the modes.
fn selected(all: &StateModes, wanted: &[usize]) -> Modes {
    Modes {
        lambdas: wanted.iter().map(|&j| all.lambdas[j]).collect(),
        y: all.y.select_columns(wanted),
        velocity: all.velocity.select_columns(wanted),
        lower: all.lower.select_rows(wanted),
    }
}

/// i omega in the middle of the band.
pub(super) fn middle(rectangle: &Rectangle) -> Complex<f64> {
    let [from, to] = rectangle.im;
    Complex::new(0.0, 0.5 * (from + to))
}

/// The system of the coefficients and gains in the order of [`values`], with a spring and a dashpot in place of each internal state, as it is
/// at `at = i omega`: `at s b b^T = (Re s at - omega Im s) b b^T`. What it is at other frequencies is left to the corrections.
fn without_states(system: &AffineSystem, values: &[f64], at: Complex<f64>) -> Result<SecondOrder, ReductionError> {
    let (coefficients, gains) = values.split_at(system.terms().len());
    let channels = gains.chunks_exact(3).map(|gain| ChannelGain { mu: gain[0], slope: gain[1], lag: None });
    let mut out =
        system.assemble(&OperatingPoint { coefficients: coefficients.to_vec(), channels: channels.collect() })?;
    for (b, gain) in system.force_matrix().column_iter().zip(gains.chunks_exact(3)).filter(|(_, gain)| gain[2] != 0.0) {
        out.k.ger(-at.im * gain[2], &b, &b, 1.0);
    }
    Ok(out)
}

impl Near {
    fn new(
        system: &AffineSystem,
        point: &OperatingPoint,
        rectangle: &Rectangle,
        modes: &Modes,
        responses: Responses,
    ) -> Self {
        let (gamma, middle) = (largest(rectangle), middle(rectangle));
        let Modes { lambdas, y, velocity, lower } = modes;
        let wide = |a: &DMatrix<f64>| a.map(Complex::from);
        let (inverse, minus) = (Complex::from(-1.0 / gamma), Complex::from(-1.0));
        let is_zero = |a: &DMatrix<f64>| a.iter().all(|&x| x == 0.0);
        let terms = system.terms().iter().map(|term| {
            let SecondOrder { m, c, k, .. } = term.matrices();
            let a = lower * (wide(k) * y * inverse + wide(c) * velocity * minus);
            (a, (!is_zero(m)).then(|| lower * (wide(m) * velocity)))
        });
        let (force, reading) = (wide(&system.force_matrix()), wide(&system.reading_matrix()));
        let channels = (0..force.ncols()).map(|at| {
            let (b, r) = (force.columns(at, 1), reading.rows(at, 1));
            let left = lower * b;
            [&left * (r * y) * inverse, &left * (b.transpose() * velocity) * minus]
        });
        let (terms, channels): (Vec<_>, Vec<[Square; 2]>) = (terms.collect(), channels.collect());
        // The modes are those with springs and dashpots; see `without_states`.
        let mut here = Square::from_diagonal(&lambdas.clone().into());
        for (at, [_, slope]) in channels.iter().enumerate() {
            let of_states = point.channels[at].complex_slope(middle).im;
            if of_states != 0.0 {
                let b = force.columns(at, 1);
                let spring = lower * b * (b.transpose() * y) * inverse * Complex::from(-middle.im * of_states);
                here += slope * Complex::new(0.0, of_states) - spring;
            }
        }
        Self {
            right: split::from_columns(y),
            left: split::stacked(lower),
            middle,
            here,
            of_terms: terms.iter().map(|(a, _): &(Square, _)| a.norm()).collect(),
            of_channels: channels.iter().map(|[friction, slope]| [friction.norm(), slope.norm()]).collect(),
            terms,
            channels,
            responses,
        }
    }

    /// The modes of `W^H A Z c = lambda W^H B Z c` at a point, from the anchor's: the near modes where the others do not take part, and internal states
    /// are the complex slopes that they are in the middle of the band. With how far a point is `along` each direction the others take part to
    /// second order.
    fn modes(&self, [from, to]: [&OperatingPoint; 2], along: Option<&[f64]>) -> Result<NearModes, ReductionError> {
        let size = self.here.nrows();
        let (mut a, mut b) = (self.here.clone(), None);
        let add = |sum: &mut Square, part: &Square, factor: Complex<f64>| {
            sum.zip_apply(part, |sum, value| *sum += value * factor);
        };
        let terms = self.terms.iter().zip(from.coefficients.iter().zip(&to.coefficients));
        for ((stiffness, mass), (from, to)) in terms.filter(|(_, (from, to))| from != to) {
            add(&mut a, stiffness, (to - from).into());
            if let Some(mass) = mass {
                let b = b.get_or_insert_with(|| DMatrix::identity(size, size));
                add(b, mass, (to - from).into());
            }
        }
        for ([friction, slope], (from, to)) in self.channels.iter().zip(from.channels.iter().zip(&to.channels)) {
            let slopes = to.complex_slope(self.middle) - from.complex_slope(self.middle);
            for (part, factor) in [(friction, (to.mu - from.mu).into()), (slope, slopes)] {
                if factor != Complex::default() {
                    add(&mut a, part, factor);
                }
            }
        }
        let wide = |value: Complex<f32>| Complex::new(f64::from(value.re), f64::from(value.im));
        let second = along.and_then(|along| self.responses.between(along)).map(|second| second.map(wide));
        if let Some(second) = &second {
            a += second;
        }
        let (lambdas, x) = match &b {
            Some(b) => dense::eigen_complex(&dense::solve(b, &a)?)?,
            None => dense::eigen_complex(&a)?,
        };
        let images = b.map_or_else(|| x.clone(), |b| dense::product(&b, &x));
        let left = dense::solve(&images, &DMatrix::identity(size, size))?;
        let moved = second.map_or(vec![f64::INFINITY; lambdas.len()], |second| {
            let images = dense::product(&second, &x);
            left.row_iter().zip(images.column_iter()).map(|(left, image)| (left * image)[0].norm()).collect()
        });
        let (mut vectors, mut covectors) = (self.right.clone(), self.left.clone());
        for (sum, response) in [
            (&mut vectors, along.and_then(|along| self.responses.shapes(along))),
            (&mut covectors, along.and_then(|along| self.responses.left(along))),
        ] {
            response.iter().for_each(|response| sum.zip_apply(response, |sum, value| *sum += f64::from(value)));
        }
        let [re, im] = [x.map(|x| x.re), x.map(|x| x.im)];
        let [left_re, left_im] = [left.map(|x| x.re), left.map(|x| x.im)];
        Ok(NearModes {
            lambdas,
            moved,
            right: dense::product(&vectors, &blocks([&re, &im], [&-&im, &re])),
            left: dense::product(&blocks([&left_re, &-&left_im], [&left_im, &left_re]), &covectors),
        })
    }
}

/// The near modes at a point, in the terms of [`Near`].
#[derive(Debug)]
pub(super) struct NearModes {
    /// Their eigenvalues, p.
    pub lambdas: Vec<Complex<f64>>,
    /// What of each eigenvalue is of second order, rad/s; infinite where that is not known.
    pub moved: Vec<f64>,
    /// Right vectors, split, k x 2 p.
    pub right: DMatrix<f64>,
    /// v^H, real parts above imaginary ones, 2 p x k.
    pub left: DMatrix<f64>,
}

fn blocks(upper: [&DMatrix<f64>; 2], lower: [&DMatrix<f64>; 2]) -> DMatrix<f64> {
    let p = upper[0].nrows();
    let mut out = DMatrix::zeros(2 * p, 2 * p);
    for (row, part) in [upper, lower].into_iter().enumerate() {
        for (column, block) in part.into_iter().enumerate() {
            out.view_mut((row * p, column * p), (p, p)).copy_from(block);
        }
    }
    out
}
