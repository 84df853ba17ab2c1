//! How A changes with the gains and with lambda, as seen by a right and a left vector.
//!
//! With `S = D_mu R Y + D_s B^T Y` and `g = T^-1 S x`, where `A = Lambda - V^H B T^-1 S`,
//!
//! ```text
//! dA x = -V^H B T^-1 (dS x - dT g),    dS = dD_mu R Y + dD_s B^T Y,
//! dT = dD_mu R F B + dD_s B^T F B + D_mu R dF B + D_s B^T dF B
//! ```

use num_complex::Complex;

use super::coupling::{Coupled, Gains, Pull, Scratch, combine_part};
use super::table::Table;
use crate::rows::{Rows, product};
use cea::certified::lanes::{Precision, cast};

/// Change of lambda, relative to it, over which slopes of friction are differentiated; chosen: rates then have six digits.
const STEP: f64 = 1e-6;

/// A right and a left vector, and A as [`super::coupling::at`] left it.
pub(super) struct Seen<'a, T> {
    own: &'a Coupled<T>,
    scratch: &'a Scratch<T>,
    y: &'a [Complex<T>],
    /// g, by ports.
    pub forces: Vec<Complex<T>>,
    /// `R Y x - R F B g` and `B^T Y x - B^T F B g`, by ports.
    along: [Vec<Complex<T>>; 2],
}

impl<'a, T: Precision> Seen<'a, T> {
    pub fn new(own: &'a Coupled<T>, scratch: &'a Scratch<T>, [y, x]: [&'a [Complex<T>]; 2]) -> Self {
        let forces = product(&scratch.solved, x);
        let along = [0, 1].map(|part| {
            let (of_amplitudes, of_forces) = (product(&own.sides[part], x), product(&scratch.smooth[part], &forces));
            of_amplitudes.into_iter().zip(of_forces).map(|(d, c)| d - c).collect()
        });
        Self { own, scratch, y, forces, along }
    }

    /// `y^H dA x` for changes of the gains mu and `lambda s(lambda)` of all ports.
    pub fn by_gains(&self, change: impl Fn(usize) -> Pull<T>) -> Complex<T> {
        self.of(|port| self.driven(port, change(port)))
    }

    /// `y^H (dA / d lambda) x` at the lambda of A.
    pub fn by_lambda(&self, table: &Table<T>, lambda: Complex<f64>, gains: Gains<'_>) -> Complex<T> {
        let m = self.forces.len();
        let (mut weights, mut smooth) = (Vec::new(), [Rows::zeros(m, m), Rows::zeros(m, m)]);
        table.slope_weights_at(lambda, &mut weights);
        let weights: Vec<Complex<T>> = weights.into_iter().map(cast).collect();
        for (part, smooth) in smooth.iter_mut().enumerate() {
            combine_part(&weights, &table.values, part, smooth);
        }
        let [reading, velocity] = smooth.map(|smooth| product(&smooth, &self.forces));
        let step = lambda * Complex::new(0.0, STEP);
        let by_lambda = gains.each(|port| (gains.at(port, lambda + step).1 - gains.at(port, lambda).1) / step);
        self.of(|port| {
            let (mu, slope) = self.scratch.pulls[port];
            let by_gains = self.driven(port, (T::default(), cast(by_lambda[port])));
            by_gains - reading[port] * mu - velocity[port] * slope
        })
    }

    /// `dS x - dT g` in a port whose gains change.
    fn driven(&self, port: usize, (mu, slope): Pull<T>) -> Complex<T> {
        self.along[0][port] * mu + self.along[1][port] * slope
    }

    /// `-y^H V^H B T^-1` times what each port has.
    fn of(&self, ports: impl Fn(usize) -> Complex<T>) -> Complex<T> {
        let mut changed: Vec<Complex<T>> = (0..self.forces.len()).map(ports).collect();
        self.scratch.factors.solve(&self.scratch.square, &mut changed);
        let row = |force: &[Complex<T>]| -> Complex<T> {
            force.iter().zip(&changed).map(|(force, changed)| force * changed).sum()
        };
        self.y.iter().zip(self.own.force.chunks_exact(changed.len())).map(|(y, force)| y.conj() * row(force)).sum()
    }
}
