//! The last digits of a mode: `(lambda - A(lambda)) d = 0` in double precision, corrected by factors in single precision.
//!
//! A is only ever applied to one vector, so that of T alone is needed in double precision. It is factored at a guess, and next to it the
//! straight line of the tables stands for them:
//!
//! ```text
//! A(lambda) d = Lambda d - V^H B c,    T(lambda) c = (D_mu R Y + D_s B^T Y) d
//! ```
//!
//! Each round takes what is missing, `r = (lambda - A(lambda)) d`, solves for c by one step of refinement, and gains what single precision
//! has of digits: with the left vector y, `-y^H r / y^H d` of lambda, and the rest of d by the factors of `lambda - A`.

use linsys::ChannelGain;
use nalgebra::DVector;
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::anchor::Anchor;
use super::coupling::{self, Coupled, Gains, Scratch};
use super::eigenvalue;
use super::elimination::Elimination;
use super::ports::Ports;
use super::real::{Real, cast};
use super::rows::Rows;
use super::secant::{Missed, secant};

/// Size of what may be missing, relative to that of `lambda d`; chosen, below all residuals that are asked for.
const CONVERGED: f64 = 1e-11;
const MOST_ROUNDS: u64 = 12;
/// Distance from the number, relative to it, up to which what is smooth is a straight line; chosen: it changes by some thousandths over the
/// band, and what is then missing of it is below 1e-8 of that.
const STRAIGHT: f64 = 1e-3;

/// An eigenvalue with its shape in the coordinates of the system.
pub(super) type Pair = (Complex<f64>, DVector<Complex<f64>>);

/// Factors of `number - A` in the coordinates of an anchor.
pub(super) struct Factors<'a> {
    pub number: Complex<f64>,
    pub matrix: &'a Rows<f32>,
    pub elimination: &'a Elimination<f32>,
}

/// Working memory.
pub(super) struct Refinement {
    scratch: Scratch,
    slopes: [Rows; 2],
    /// Vectors of the near modes, in both precisions, and of the ports.
    near: Rows,
    single: Rows<f32>,
    port: Rows,
    /// Products with vectors: two sides, and four matrices of the ports.
    sides: [Vec<Complex<f64>>; 2],
    smooth: [Vec<Complex<f64>>; 4],
    force: Vec<Complex<f64>>,
    turned: Vec<Complex<f32>>,
}

impl Refinement {
    pub fn new(ports: &Ports) -> Self {
        let (p, m) = (ports.near(), ports.count());
        Self {
            scratch: Scratch::new(ports),
            slopes: [Rows::zeros(m, m), Rows::zeros(m, m)],
            near: Rows::zeros(1, p),
            single: Rows::zeros(1, p),
            port: Rows::zeros(1, m),
            sides: Default::default(),
            smooth: Default::default(),
            force: Vec::new(),
            turned: Vec::new(),
        }
    }

    /// The eigenvalue next to the number of some factors and its shape, from mode `at` of an anchor, and the number of rounds; `None` where
    /// they do not converge.
    pub fn refined(
        &mut self,
        ports: &Ports,
        own: &Coupled<f64>,
        gains: &[ChannelGain],
        anchor: &Anchor,
        factors: Factors<'_>,
        at: usize,
    ) -> (Option<Pair>, u64) {
        let Factors { number, matrix, elimination } = factors;
        let gains = Gains::of(gains);
        let mut x = vec![Complex::default(); ports.near()];
        x[at] = Complex::new(1.0, 0.0);
        eigenvalue::right(matrix, elimination, &mut x);
        let y = eigenvalue::left(matrix, &x, elimination);
        let along = inner(&y, &x);
        coupling::factor_at(&ports.fine, number, gains, &mut self.scratch, &mut self.slopes);

        let [vectors, inverse] = &anchor.vectors;
        let mut d: Vec<Complex<f64>> = self.turn(vectors, &x).iter().map(|&entry| cast(entry)).collect();
        let (mut lambda, mut before): (_, Option<Missed>) = (number, None);
        let mut forces = vec![Complex::default(); ports.count()];
        for round in 1..=MOST_ROUNDS {
            self.solve_forces(own, lambda, lambda - number, gains, &d, &mut forces);
            self.port.set_row(&forces);
            Arch::new().dispatch(Times { matrix: &ports.force_rows, vector: &self.port, out: &mut self.force });
            let missing = |((lambda_i, d), force): ((&Complex<f64>, &Complex<f64>), &Complex<f64>)| {
                (lambda - lambda_i) * d + force
            };
            let missing: Vec<Complex<f64>> = ports.lambdas.iter().zip(&d).zip(&self.force).map(missing).collect();
            let size = norm_squared(&missing).sqrt();
            if size <= CONVERGED * lambda.norm() * norm_squared(&d).sqrt() {
                return (Some((lambda, coupling::shape(ports, lambda, &d, &forces))), round);
            }
            if size.is_nan() || (lambda - number).norm() > STRAIGHT * number.norm() {
                return (None, round);
            }
            let missing: Vec<Complex<f32>> = missing.iter().map(|&entry| cast(entry)).collect();
            let mut rest = self.turn(inverse, &missing).to_vec();
            let miss = -inner(&y, &rest) / along;
            rest.iter_mut().zip(&x).for_each(|(rest, x)| *rest += x * miss);
            elimination.solve(matrix, &mut rest);
            // The factors are next to singular along x, of which no more is wanted.
            let part = inner(&x, &rest);
            rest.iter_mut().zip(&x).for_each(|(rest, x)| *rest -= x * part);
            self.turn(vectors, &rest).iter().zip(&mut d).for_each(|(&rest, d)| *d -= cast::<f32, f64>(rest));
            let here = (lambda, cast(miss));
            lambda = secant(before, here);
            before = Some(here);
        }
        (None, MOST_ROUNDS)
    }

    /// A matrix of an anchor times a vector.
    fn turn(&mut self, matrix: &Rows<f32>, vector: &[Complex<f32>]) -> &[Complex<f32>] {
        self.single.set_row(vector);
        Arch::new().dispatch(Times { matrix, vector: &self.single, out: &mut self.turned });
        &self.turned
    }

    /// The forces c of amplitudes d at a number that is `apart` from that of the factors, by one step of refinement from other forces.
    fn solve_forces(
        &mut self,
        own: &Coupled<f64>,
        lambda: Complex<f64>,
        apart: Complex<f64>,
        gains: Gains<'_>,
        d: &[Complex<f64>],
        forces: &mut [Complex<f64>],
    ) {
        let Self { scratch, slopes, near, port, sides, smooth, .. } = self;
        scratch.pull(gains, lambda);
        near.set_row(d);
        port.set_row(forces);
        for (side, out) in own.sides.iter().zip(sides.iter_mut()) {
            Arch::new().dispatch(Times { matrix: side, vector: near, out });
        }
        for (matrix, out) in scratch.smooth.iter().chain(&*slopes).zip(smooth.iter_mut()) {
            Arch::new().dispatch(Times { matrix, vector: port, out });
        }
        let [reading, velocity, reading_slope, velocity_slope] = smooth;
        let missing = |(port, &(mu, slope)): (usize, &(f64, Complex<f64>))| {
            let of_reading = sides[0][port] - reading[port] - reading_slope[port] * apart;
            let of_velocity = sides[1][port] - velocity[port] - velocity_slope[port] * apart;
            of_reading * mu + of_velocity * slope - forces[port]
        };
        let mut missing: Vec<Complex<f64>> = scratch.pulls.iter().enumerate().map(missing).collect();
        scratch.factors.solve(&scratch.square, &mut missing);
        forces.iter_mut().zip(missing).for_each(|(force, missing)| *force += missing);
    }
}

/// `a^H b`.
fn inner(a: &[Complex<f32>], b: &[Complex<f32>]) -> Complex<f32> {
    a.iter().zip(b).map(|(a, b)| a.conj() * b).sum()
}

fn norm_squared(vector: &[Complex<f64>]) -> f64 {
    vector.iter().map(Complex::norm_sqr).sum()
}

struct Times<'a, T> {
    matrix: &'a Rows<T>,
    vector: &'a Rows<T>,
    out: &'a mut Vec<Complex<T>>,
}

impl<T: Real> WithSimd for Times<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.matrix.times(simd, self.vector, self.out);
    }
}
