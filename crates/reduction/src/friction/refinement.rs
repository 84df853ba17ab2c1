//! The last digits of a mode: `(lambda - A(lambda)) d = 0` in double precision, corrected by factors in single precision.
//!
//! A mode is found in single precision first. In double precision A is only ever applied to one vector: what is smooth in it is read off the
//! tables at the eigenvalue of single precision, and next to that the straight line of the tables stands for it:
//!
//! ```text
//! A(lambda) d = Lambda d - V^H B c,    T(lambda) c = (D_mu R Y + D_s B^T Y) d
//! ```
//!
//! Each round takes what is missing, `r = (lambda - A(lambda)) d`, solves for c by one step of refinement with factors of T in single precision,
//! and gains what single precision has of digits: with the left vector y, `-y^H r / y^H d` of lambda, and the rest of d by the factors of
//! `lambda - A`.

use linsys::ChannelGain;
use num_complex::Complex;
use pulp::Arch;

use super::coupling::{self, Coupled, Gains, Pull, Scratch};
use super::ports::Ports;
use super::secant::{Missed, secant};
use super::shapes::Found;
use super::table::Differences;
use crate::eigenvalue;
use crate::rows::{Rows, Times, product};
use cea::certified::lanes::cast;

/// Size of what may be missing, relative to that of `lambda d`; chosen, below all residuals that are asked for.
const CONVERGED: f64 = 1e-11;
const MOST_ROUNDS: u64 = 12;
/// Most numbers at which A is factored for a mode, and the distance of the last from its eigenvalue, relative to it; chosen.
const MOST_NUMBERS: usize = 3;
const NEAR: f64 = 1e-4;
/// Where A is factored, relative to a guess: at an eigenvalue itself single precision may leave nothing of a pivot; chosen.
const BESIDE: f64 = 1e-6;
/// Steps of inverse iteration at each of these numbers; chosen.
const STEPS: usize = 2;
/// Distance from the number, relative to it, up to which what is smooth is a straight line; chosen: it changes by some thousandths over the
/// band, and what is then missing of it is below 1e-8 of that.
const STRAIGHT: f64 = 1e-3;

/// A mode in single precision, with factors of A at a number next to it in working memory.
#[derive(Debug, Clone)]
pub(super) struct Approached {
    /// rad/s.
    pub lambda: Complex<f64>,
    number: Complex<f64>,
    /// Amplitudes of the near modes.
    vector: Vec<Complex<f32>>,
}

/// A sample.
pub(super) struct Sample<'a> {
    pub ports: &'a Ports,
    /// What A is made of in the coordinates of the structure, and what friction adds to it.
    pub own: &'a Coupled<f64>,
    pub added: &'a Coupled<f32>,
    pub gains: &'a [ChannelGain],
}

/// What is known of a mode.
pub(super) struct Start {
    /// Its eigenvalue, rad/s.
    pub guess: Complex<f64>,
    /// A vector of the near modes that has a part of its own.
    pub vector: Vec<Complex<f32>>,
}

/// Working memory.
pub(super) struct Refinement {
    single: Scratch<f32>,
    matrix: Rows<f32>,
    weights: Vec<Complex<f64>>,
    /// `R F B` and `B^T F B`, in both precisions, what they differ by from those at the first point of the table, and their derivatives.
    smooth: [Rows; 2],
    single_smooth: [Rows<f32>; 2],
    apart: [Rows<f32>; 2],
    slopes: [Rows<f32>; 2],
    /// Vectors of the near modes, in both precisions, and of the ports.
    near: Rows,
    port: Rows,
    single_port: Rows<f32>,
    /// Products with vectors: two sides, and four matrices of the ports.
    sides: [Vec<Complex<f64>>; 2],
    of_smooth: [Vec<Complex<f64>>; 2],
    of_slopes: [Vec<Complex<f32>>; 2],
    force: Vec<Complex<f64>>,
}

impl Refinement {
    pub fn new(ports: &Ports) -> Self {
        let (p, m) = (ports.near(), ports.count());
        Self {
            single: Scratch::new(ports),
            matrix: Rows::zeros(p, p),
            weights: Vec::new(),
            smooth: [Rows::zeros(m, m), Rows::zeros(m, m)],
            single_smooth: [Rows::zeros(m, m), Rows::zeros(m, m)],
            apart: [Rows::zeros(m, m), Rows::zeros(m, m)],
            slopes: [Rows::zeros(m, m), Rows::zeros(m, m)],
            near: Rows::zeros(1, p),
            port: Rows::zeros(1, m),
            sides: Default::default(),
            of_smooth: Default::default(),
            of_slopes: Default::default(),
            single_port: Rows::zeros(1, m),
            force: Vec::new(),
        }
    }

    /// The last digits of the mode that was approached last, and the number of rounds; `None` where they do not converge. `drift` is
    /// `y^H (dA / d lambda) x` of its left and right vector with `y^H x = 1`, roughly.
    pub fn refined(&mut self, sample: &Sample<'_>, mode: Approached, drift: Complex<f32>) -> (Option<Found>, u64) {
        let (ports, Approached { mut lambda, number, vector: x }) = (sample.ports, mode);
        let y = eigenvalue::left(&self.matrix, &x, &self.single.elimination);
        let along = inner(&y, &x);
        let slope = (Complex::from(1.0) - drift).inv();
        for ((smooth, first), apart) in self.smooth.iter_mut().zip(&ports.differences.first).zip(&self.apart) {
            smooth.set_apart(first, apart);
        }

        let mut d: Vec<Complex<f64>> = x.iter().map(|&entry| cast(entry)).collect();
        let mut before: Option<Missed> = None;
        let mut forces: Vec<Complex<f64>> = product(&self.single.solved, &x).into_iter().map(cast).collect();
        for round in 1..=MOST_ROUNDS {
            self.solve_forces(sample, lambda, lambda - number, &d, &mut forces);
            self.port.set_row(&forces);
            Arch::new().dispatch(Times { matrix: &ports.force_rows, vector: &self.port, out: &mut self.force });
            let missing = |((lambda_i, d), force): ((&Complex<f64>, &Complex<f64>), &Complex<f64>)| {
                (lambda - lambda_i) * d + force
            };
            let missing: Vec<Complex<f64>> = ports.lambdas.iter().zip(&d).zip(&self.force).map(missing).collect();
            let size = norm_squared(&missing).sqrt();
            if size <= CONVERGED * lambda.norm() * norm_squared(&d).sqrt() {
                return (Some(Found { lambda, amplitudes: d, forces }), round);
            }
            if size.is_nan() || (lambda - number).norm() > STRAIGHT * number.norm() {
                return (None, round);
            }
            let mut rest: Vec<Complex<f32>> = missing.iter().map(|&entry| cast(entry)).collect();
            let miss = -inner(&y, &rest) / along;
            let step = miss * slope;
            rest.iter_mut().zip(&x).for_each(|(rest, x)| *rest += x * miss);
            self.single.elimination.solve(&self.matrix, &mut rest);
            // The factors are next to singular along x, of which no more is wanted.
            let part = inner(&x, &rest);
            rest.iter_mut().zip(&x).for_each(|(rest, x)| *rest -= x * part);
            rest.iter().zip(&mut d).for_each(|(&rest, d)| *d -= cast::<f32, f64>(rest));
            let here = (lambda, cast(step));
            lambda = secant(before, here);
            before = Some(here);
        }
        (None, MOST_ROUNDS)
    }

    /// The mode next to a guess in single precision; `None` where it does not converge.
    pub fn approached(&mut self, sample: &Sample<'_>, Start { mut guess, mut vector }: Start) -> Option<Approached> {
        let Self { single, matrix, weights, single_smooth, apart, slopes, .. } = self;
        let (ports, gains) = (sample.ports, Gains::of(sample.gains));
        let Differences { single_first, table, .. } = &ports.differences;
        for _ in 0..MOST_NUMBERS {
            let number = guess * (1.0 + BESIDE);
            coupling::differences_at(table, number, weights, apart, slopes);
            for ((smooth, first), apart) in single_smooth.iter_mut().zip(single_first).zip(&*apart) {
                smooth.set_total(first, apart);
            }
            coupling::with(sample.added, number, single_smooth, gains, single, matrix);
            matrix.negate();
            eigenvalue::factor_with(matrix, |i| cast(number - ports.lambdas[i]), &mut single.elimination, ports.near());
            let apart: Complex<f64> = cast(eigenvalue::apart(matrix, &mut vector, STEPS, &single.elimination));
            guess = number + apart;
            if apart.norm() <= NEAR * number.norm() {
                return Some(Approached { lambda: guess, number, vector });
            }
            if !guess.is_finite() {
                break;
            }
        }
        None
    }

    /// The forces c of amplitudes d at a number that is `apart` from that of the factors, by one step of refinement from other forces.
    fn solve_forces(
        &mut self,
        sample: &Sample<'_>,
        lambda: Complex<f64>,
        apart: Complex<f64>,
        d: &[Complex<f64>],
        forces: &mut [Complex<f64>],
    ) {
        let Self { single, smooth, slopes, near, port, single_port, sides, of_smooth, of_slopes, .. } = self;
        let pulls: Vec<Pull> = coupling::pulls(Gains::of(sample.gains), lambda);
        near.set_row(d);
        port.set_row(forces);
        (0..forces.len()).for_each(|at| single_port.set(0, at, cast(forces[at])));
        for (matrix, out) in sample.own.sides.iter().zip(sides.iter_mut()) {
            Arch::new().dispatch(Times { matrix, vector: near, out });
        }
        for (matrix, out) in smooth.iter().zip(of_smooth.iter_mut()) {
            Arch::new().dispatch(Times { matrix, vector: port, out });
        }
        for (matrix, out) in slopes.iter().zip(of_slopes.iter_mut()) {
            Arch::new().dispatch(Times { matrix, vector: single_port, out });
        }
        let [reading, velocity] = of_smooth;
        let [reading_slope, velocity_slope] = of_slopes;
        let missing = |(port, &(mu, slope)): (usize, &(f64, Complex<f64>))| {
            let of_reading = sides[0][port] - reading[port] - cast::<f32, f64>(reading_slope[port]) * apart;
            let of_velocity = sides[1][port] - velocity[port] - cast::<f32, f64>(velocity_slope[port]) * apart;
            of_reading * mu + of_velocity * slope - forces[port]
        };
        let mut missing: Vec<Complex<f32>> = pulls.iter().enumerate().map(|pull| cast(missing(pull))).collect();
        single.factors.solve(&single.square, &mut missing);
        forces.iter_mut().zip(missing).for_each(|(force, missing)| *force += cast::<f32, f64>(missing));
    }
}

/// `a^H b`.
fn inner(a: &[Complex<f32>], b: &[Complex<f32>]) -> Complex<f32> {
    a.iter().zip(b).map(|(a, b)| a.conj() * b).sum()
}

fn norm_squared(vector: &[Complex<f64>]) -> f64 {
    vector.iter().map(Complex::norm_sqr).sum()
}
