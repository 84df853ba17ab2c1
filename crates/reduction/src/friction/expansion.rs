//! A around known gains that all ports have alike, as a polynomial of the gains and of lambda.
//!
//! With one mu and one `p = lambda s(lambda)` for all ports, `A(lambda; mu, p)` is analytic in three numbers. In the coordinates of the
//! vectors at the known gains its column of mode j is, around the eigenvalue lambda_j,
//!
//! ```text
//! A e_j = lambda_j e_j + sum_k c_k a_jk,    c = (dmu, dp, dlambda, dmu^2, dmu dp, dp^2)
//! ```
//!
//! With `w = T^-1 (mu R Y + p B^T Y) x_j` and `T = I + mu G + p H`, the a_jk are `-S^-1 V^H B` times
//!
//! ```text
//! w_mu = T^-1 (R Y x_j - G w),    w_p = T^-1 (B^T Y x_j - H w),    w_lambda = -T^-1 (mu G' + p H') w,
//! w_mumu = -T^-1 G w_mu,    w_mup = -T^-1 (G w_p + H w_mu),    w_pp = -T^-1 H w_p
//! ```
//!
//! These are the first terms of the Neumann series of `T^-1`, in which each is the one before times `-T^-1 (dmu G + dp H)`.

use linsys::ChannelGain;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::coupling::{self, Gains, Scratch, pull};
use super::ports::Ports;
use crate::rows::Rows;
use cea::certified::lanes::cast;

/// The numbers c_k.
pub(super) const TERMS: usize = 6;
/// Largest ratio of two terms of the series; chosen: what is left out is then up to four times the term of the second order.
const LARGEST_RATIO: f32 = 0.8;
/// Part of the term of dlambda that may be missed, beside that ratio; chosen: what is smooth changes by some thousandths over the band.
const BENT: f32 = 0.1;
/// Largest change of a column with its lambda, as the sum over its entries; chosen: with more, A has poles near.
const LARGEST_DRIFT: f32 = 0.7;
/// Relative step of derivatives of p.
const STEP: f64 = 1e-6;

/// The polynomial around some gains.
#[derive(Debug, Clone)]
pub(super) struct Expansion {
    /// lambda_j, rad/s.
    pub lambdas: Vec<Complex<f64>>,
    /// How much each column changes with its lambda: its own entry, and the sum over the sizes of all.
    pub drift: Vec<(Complex<f32>, f32)>,
    /// a_jk, as row `k p + j`.
    pub terms: Rows<f32>,
    /// The sums over the sizes of their entries.
    sizes: Vec<f32>,
    /// The known gain of all ports.
    pub gain: ChannelGain,
    /// lambda_j and p there, as two rows.
    known: Rows<f32>,
}

/// The numbers c_k of all columns, each times a number.
#[derive(Debug)]
pub(super) struct Factors {
    /// Of column j, as entry `k p + j` of a row.
    pub values: Rows<f32>,
    /// What each column may be wrong by, as the sum over its entries, times the size of its number: rad/s.
    pub missed: Vec<f32>,
}

impl Factors {
    pub fn new(p: usize) -> Self {
        Self { values: Rows::zeros(1, TERMS * p), missed: vec![0.0; p] }
    }
}

impl Expansion {
    /// Around a gain of all ports with the eigenvalues and vectors of its modes, and the inverse of these; `None` where A has poles near.
    pub fn new(
        ports: &Ports,
        gain: &ChannelGain,
        lambdas: Vec<Complex<f64>>,
        vectors: &DMatrix<Complex<f64>>,
        inverse: &DMatrix<Complex<f64>>,
    ) -> Option<Self> {
        let (p, m) = (ports.near(), ports.count());
        let gains = vec![*gain; m];
        let (mut scratch, mut slopes) = (Scratch::new(ports), [Rows::zeros(m, m), Rows::zeros(m, m)]);
        let force = -(inverse * &ports.force);
        let (mut terms, mut sizes) = (Rows::zeros(TERMS * p, p), vec![0.0; TERMS * p]);
        let (mut known, mut drift) = (Rows::zeros(2, p), Vec::with_capacity(p));
        let dense = |rows: &Rows| DMatrix::from_fn(m, m, |i, j| rows.at(i, j));
        for (mode, &lambda) in lambdas.iter().enumerate() {
            coupling::factor_at(&ports.fine, lambda, Gains::of(&gains), &mut scratch, &mut slopes);
            let solved = |mut side: DVector<Complex<f64>>| {
                scratch.factors.solve(&scratch.square, side.as_mut_slice());
                side
            };
            let [g, h] = scratch.smooth.each_ref().map(dense);
            let [g_slope, h_slope] = slopes.each_ref().map(dense);
            let [reading, velocity] = ports.sides.each_ref().map(|side| side * vectors.column(mode));
            let (mu, slope) = pull(gain, lambda);
            let mu = Complex::from(mu);
            let w = solved(&reading * mu + &velocity * slope);
            let by_mu = solved(&reading - &g * &w);
            let by_slope = solved(&velocity - &h * &w);
            let by_lambda = solved(-(g_slope * mu + h_slope * slope) * &w);
            let second = [-(&g * &by_mu), -(&g * &by_slope) - &h * &by_mu, -(&h * &by_slope)].map(solved);
            for (k, w) in [by_mu, by_slope, by_lambda].iter().chain(&second).enumerate() {
                let (column, row) = (&force * w, k * p + mode);
                column.iter().enumerate().for_each(|(i, &entry)| terms.set(row, i, cast(entry)));
                sizes[row] = column.iter().map(|entry| entry.norm() as f32).sum();
            }
            known.set(0, mode, cast(lambda));
            known.set(1, mode, cast(slope));
            let step = lambda * STEP;
            let of_slope: Complex<f32> = cast((pull(gain, lambda + step).1 - slope) / step);
            let [by_slope, by_lambda] = [p + mode, 2 * p + mode];
            let own = terms.at(by_lambda, mode) + terms.at(by_slope, mode) * of_slope;
            drift.push((own, sizes[by_lambda] + sizes[by_slope] * of_slope.norm()));
        }
        let is_sound = drift.iter().all(|(_, whole)| *whole <= LARGEST_DRIFT);
        is_sound.then_some(Self { lambdas, drift, terms, sizes, gain: *gain, known })
    }

    /// The numbers c_k of all columns under a gain, at numbers that are the first row of `at` and with p there as the second, each times an
    /// entry of `of`.
    #[inline(always)]
    pub fn factors(&self, mu: f64, at: &Rows<f32>, [of_re, of_im]: [&[f32]; 2], out: &mut Factors) {
        let p = self.lambdas.len();
        let [[l_re, l_im], [s_re, s_im]] = [0, 1].map(|row| self.known.row(row).map(|part| &part[..p]));
        let [[at_re, at_im], [pull_re, pull_im]] = [0, 1].map(|row| at.row(row).map(|part| &part[..p]));
        let (of_re, of_im) = (&of_re[..p], &of_im[..p]);
        let sizes: [&[f32]; TERMS] = std::array::from_fn(|k| &self.sizes[k * p..(k + 1) * p]);
        let [re, im] = out.values.row_mut(0);
        let [re0, re1, re2, re3, re4, re5] = parts(re, p);
        let [im0, im1, im2, im3, im4, im5] = parts(im, p);
        let missed = &mut out.missed[..p];
        let mu = (mu - self.gain.mu) as f32;
        for i in 0..p {
            let (v_re, v_im) = (of_re[i], of_im[i]);
            let (l_re, l_im) = (at_re[i] - l_re[i], at_im[i] - l_im[i]);
            let (s_re, s_im) = (pull_re[i] - s_re[i], pull_im[i] - s_im[i]);
            let (sv_re, sv_im) = (s_re * v_re - s_im * v_im, s_re * v_im + s_im * v_re);
            (re0[i], im0[i]) = (mu * v_re, mu * v_im);
            (re1[i], im1[i]) = (sv_re, sv_im);
            (re2[i], im2[i]) = (l_re * v_re - l_im * v_im, l_re * v_im + l_im * v_re);
            (re3[i], im3[i]) = (mu * mu * v_re, mu * mu * v_im);
            (re4[i], im4[i]) = (mu * sv_re, mu * sv_im);
            (re5[i], im5[i]) = (s_re * sv_re - s_im * sv_im, s_re * sv_im + s_im * sv_re);
            let (mu, slope, lambda) =
                (mu.abs(), (s_re * s_re + s_im * s_im).sqrt(), (l_re * l_re + l_im * l_im).sqrt());
            let first = mu * sizes[0][i] + slope * sizes[1][i];
            let second = mu * mu * sizes[3][i] + mu * slope * sizes[4][i] + slope * slope * sizes[5][i];
            let ratio = second / (first + f32::MIN_POSITIVE);
            let beyond = second * ratio / (1.0 - ratio) + lambda * sizes[2][i] * (ratio + BENT);
            let beyond = if ratio <= LARGEST_RATIO { beyond } else { f32::INFINITY };
            missed[i] = if v_re == 0.0 && v_im == 0.0 { 0.0 } else { beyond * (v_re * v_re + v_im * v_im).sqrt() };
        }
    }
}

/// The first numbers as slices of `p` each.
#[inline(always)]
fn parts(mut of: &mut [f32], p: usize) -> [&mut [f32]; TERMS] {
    std::array::from_fn(|_| {
        let (part, rest) = std::mem::take(&mut of).split_at_mut(p);
        of = rest;
        part
    })
}
