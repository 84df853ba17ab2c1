//! A reduced system solved completely at one operating point, from where those at other points are found.

use linsys::{AffineSystem, ChannelGain, OperatingPoint, SecondOrder};
use nalgebra::DMatrix;
use num_complex::Complex;

use super::far::Far;
use super::full::{largest, outside};
use super::state_modes::StateModes;
use super::watch::{Vectors, Watch};
use super::{dense, split};
use crate::{Rectangle, SparseError};

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
    /// What of `W^H A Z` and `W^H B Z` does not depend on the point.
    constant: [Square; 2],
    /// What each term adds per unit of its coefficient; no matrix B where its M is zero.
    terms: Vec<(Square, Option<Square>)>,
    /// What each channel adds to `W^H A Z` per unit of mu, and per unit of its slope.
    channels: Vec<[Square; 2]>,
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
    ) -> Result<Self, SparseError> {
        let gamma = largest(rectangle);
        let StateModes { lambdas: all, y, velocity, upper, lower } =
            StateModes::new(&without_states(system, point, middle(rectangle))?, gamma)?;

        let near_one = |lambda: Complex<f64>| outside(rectangle, lambda) <= NEAR * margin;
        let listed: Vec<usize> = (0..all.len()).filter(|&j| all[j].im >= 0.0).collect();
        let near: Vec<usize> = (0..all.len()).filter(|&j| near_one(all[j])).collect();
        let lambdas: Vec<_> = listed.iter().map(|&j| all[j]).collect();
        let far = Far::new(&lambdas, [&lower.select_rows(&listed), &y.select_columns(&listed)], gamma, near_one);
        let others: Vec<usize> = listed.iter().copied().filter(|&j| !near_one(all[j])).collect();
        let vectors = Vectors {
            y: y.select_columns(&others),
            velocity: velocity.select_columns(&others),
            lower: lower.select_rows(&others),
        };
        let watch = Watch::new(system, others.iter().map(|&j| all[j]).collect(), &vectors, gamma, middle(rectangle));
        let near = Near::new(
            system,
            rectangle,
            &NearVectors {
                y: y.select_columns(&near),
                velocity: velocity.select_columns(&near),
                upper: upper.select_rows(&near),
                lower: lower.select_rows(&near),
            },
        );
        Ok(Self { point: point.clone(), gamma, far, watch, near })
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

/// i omega in the middle of the band.
fn middle(rectangle: &Rectangle) -> Complex<f64> {
    let [from, to] = rectangle.im;
    Complex::new(0.0, 0.5 * (from + to))
}

/// The system at a point with a spring and a dashpot in place of each internal state, as it is at `at = i omega`:
/// `at s b b^T = (Re s at - omega Im s) b b^T`. What it is at other frequencies is left to the corrections.
fn without_states(system: &AffineSystem, point: &OperatingPoint, at: Complex<f64>) -> Result<SecondOrder, SparseError> {
    let slopes: Vec<_> = point.channels.iter().map(|gain| gain.complex_slope(at)).collect();
    let channels =
        point.channels.iter().zip(&slopes).map(|(gain, s)| ChannelGain { lag: None, slope: s.re, ..*gain }).collect();
    let mut out = system.assemble(&OperatingPoint { coefficients: point.coefficients.clone(), channels })?;
    for (b, s) in system.force_matrix().column_iter().zip(slopes).filter(|(_, s)| s.im != 0.0) {
        out.k.ger(-at.im * s.im, &b, &b, 1.0);
    }
    Ok(out)
}

/// Parts of the vectors of the near modes: right `[y; velocity]`, left `[upper, lower]` as rows.
struct NearVectors {
    y: DMatrix<Complex<f64>>,
    velocity: DMatrix<Complex<f64>>,
    upper: DMatrix<Complex<f64>>,
    lower: DMatrix<Complex<f64>>,
}

impl Near {
    fn new(system: &AffineSystem, rectangle: &Rectangle, vectors: &NearVectors) -> Self {
        let gamma = largest(rectangle);
        let NearVectors { y, velocity, upper, lower } = vectors;
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
        Self {
            right: split::from_columns(y),
            left: stacked(lower),
            middle: middle(rectangle),
            constant: [upper * velocity * Complex::from(gamma), upper * y],
            of_terms: terms.iter().map(|(a, _): &(Square, _)| a.norm()).collect(),
            of_channels: channels.iter().map(|[friction, slope]| [friction.norm(), slope.norm()]).collect(),
            terms,
            channels,
        }
    }

    /// The modes of `W^H A Z c = lambda W^H B Z c` at a point: the near modes where the others do not take part, and internal states
    /// are the complex slopes that they are in the middle of the band.
    pub fn modes(&self, point: &OperatingPoint) -> Result<NearModes, SparseError> {
        let [mut a, mut b] = self.constant.clone();
        let add = |sum: &mut Square, part: &Square, factor: Complex<f64>| {
            sum.zip_apply(part, |sum, value| *sum += value * factor);
        };
        for ((stiffness, mass), &theta) in
            self.terms.iter().zip(&point.coefficients).filter(|(_, theta)| **theta != 0.0)
        {
            add(&mut a, stiffness, theta.into());
            if let Some(mass) = mass {
                add(&mut b, mass, theta.into());
            }
        }
        for ([friction, slope], gain) in self.channels.iter().zip(&point.channels) {
            for (part, factor) in [(friction, gain.mu.into()), (slope, gain.complex_slope(self.middle))] {
                if factor != Complex::default() {
                    add(&mut a, part, factor);
                }
            }
        }
        let (lambdas, x) = dense::eigen_complex(&dense::solve(&b, &a)?)?;
        let left = dense::solve(&dense::product(&b, &x), &DMatrix::identity(x.nrows(), x.ncols()))?;
        let [re, im] = [x.map(|x| x.re), x.map(|x| x.im)];
        let [left_re, left_im] = [left.map(|x| x.re), left.map(|x| x.im)];
        Ok(NearModes {
            lambdas,
            right: dense::product(&self.right, &blocks([&re, &im], [&-&im, &re])),
            left: dense::product(&blocks([&left_re, &-&left_im], [&left_im, &left_re]), &self.left),
        })
    }
}

/// The near modes at a point, in the terms of [`Near`].
#[derive(Debug)]
pub(super) struct NearModes {
    /// Their eigenvalues, p.
    pub lambdas: Vec<Complex<f64>>,
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

/// Real parts above imaginary ones.
fn stacked(rows: &DMatrix<Complex<f64>>) -> DMatrix<f64> {
    let (count, columns) = rows.shape();
    DMatrix::from_fn(2 * count, columns, |i, j| if i < count { rows[(i, j)].re } else { rows[(i - count, j)].im })
}
