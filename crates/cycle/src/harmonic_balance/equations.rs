//! The unknowns of a balance: between series, modes, motions in time and states.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::{Balance, BalancedCycle};
use crate::contact::along;
use crate::measure::states;
use crate::system::ContactForces;
use crate::{ContactSystem, Cycle, Error};

/// The equations of a balance for one system.
pub(crate) struct Equations<'a> {
    pub(super) balance: &'a Balance,
    pub(super) system: &'a ContactSystem,
    /// Scales of the outputs.
    pub(super) scales: Vec<f64>,
    pub(super) omega_scale: f64,
    /// Shape of the mode in the outputs, which fixes phase and amplitude.
    shape: Vec<Complex<f64>>,
}

impl<'a> Equations<'a> {
    /// The equations of a system for motions near a mode.
    pub fn new(balance: &'a Balance, system: &'a ContactSystem, omega: f64, shape: &[Complex<f64>]) -> Self {
        let length = system.scales(omega)[0];
        let contacts = system.contacts();
        let gaps = contacts.iter().map(|contact| contact.load.abs());
        let bristles = (0..contacts.len()).filter(|&at| system.bristle(at).is_some());
        let bristles = bristles.map(|at| system.steady_bristle(at).abs().max(f64::MIN_POSITIVE));
        let scales: Vec<f64> = gaps.chain(contacts.iter().map(|_| length)).chain(bristles).collect();
        let seen = |entries: &[(usize, f64)], factor: f64| -> Complex<f64> {
            entries.iter().map(|&(dof, value)| shape[dof] * (value * factor)).sum()
        };
        let of_gaps = contacts.iter().map(|contact| seen(&contact.normal, contact.stiffness));
        let seen: Vec<_> = of_gaps.chain(contacts.iter().map(|contact| seen(&contact.sliding, 1.0))).collect();
        let shape = seen.iter().zip(&scales).map(|(seen, scale)| seen / scale).collect();
        Self { balance, system, scales, omega_scale: omega, shape }
    }

    pub(super) fn size(&self) -> usize {
        self.scales.len() * self.balance.terms()
    }

    /// Unknowns of the balance, of which the last two are the frequency and the parameter in their scales.
    pub fn unknowns(&self, cycle: &BalancedCycle, parameter_scale: f64) -> DVector<f64> {
        let size = self.size();
        DVector::from_fn(size + 2, |i, _| match i.checked_sub(size) {
            None => cycle.series[i],
            Some(0) => cycle.omega / self.omega_scale,
            Some(_) => cycle.parameter / parameter_scale,
        })
    }

    /// The cycle of unknowns.
    pub fn cycle(&self, unknowns: &DVector<f64>, parameter_scale: f64, residual: f64) -> BalancedCycle {
        let size = self.size();
        BalancedCycle {
            series: unknowns.rows(0, size).into_owned(),
            omega: unknowns[size] * self.omega_scale,
            parameter: unknowns[size + 1] * parameter_scale,
            residual,
        }
    }

    /// Row whose product with the unknowns is the imaginary part of the amplitude in the mode (`quarter`), or its real part.
    pub fn amplitude_row(&self, quarter: bool) -> DVector<f64> {
        let (terms, mut row) = (self.balance.terms(), DVector::zeros(self.size() + 2));
        let norm: f64 = self.shape.iter().map(|eta| eta.norm_sqr()).sum();
        for (at, eta) in self.shape.iter().enumerate() {
            // conj(eta) (a - i b)
            let (by_a, by_b) = if quarter { (-eta.im, -eta.re) } else { (eta.re, -eta.im) };
            row[at * terms + 1] = by_a / norm;
            row[at * terms + 2] = by_b / norm;
        }
        row
    }

    /// The cycle that a small motion in the mode would be with an amplitude.
    pub fn of_mode(&self, amplitude: f64, omega: f64, parameter: f64) -> BalancedCycle {
        let (terms, mut series) = (self.balance.terms(), DVector::zeros(self.size()));
        for (at, eta) in self.shape.iter().enumerate() {
            series[at * terms + 1] = amplitude * eta.re;
            series[at * terms + 2] = -amplitude * eta.im;
        }
        let contacts = self.system.contacts().len();
        let bristled = (0..contacts).filter(|&at| self.system.bristle(at).is_some());
        for (place, contact) in (2 * contacts..).zip(bristled) {
            let forces = self.system.forces_in(contact, &vec![0.0; self.system.dimension()]);
            let slip = self.shape[contacts + contact] * self.scales[contacts + contact];
            let lambda = Complex::new(0.0, omega);
            let z = -lambda * slip * forces.rate_by_velocity / (lambda - forces.rate_by_state) / self.scales[place];
            series[place * terms + 1] = amplitude * z.re;
            series[place * terms + 2] = -amplitude * z.im;
        }
        BalancedCycle { series, omega, parameter, residual: f64::INFINITY }
    }

    /// The cycle that a motion found in time is, with its phase in the mode.
    ///
    /// # Errors
    /// A motion that cannot be followed.
    pub fn of_cycle(&self, cycle: &Cycle, parameter: f64, tolerance: f64) -> Result<BalancedCycle, Error> {
        let samples = self.balance.evaluate.nrows();
        let states = states(self.system, cycle, samples, tolerance)?;
        let contacts = self.system.contacts();
        let mut values = DMatrix::zeros(samples, self.scales.len());
        for (sample, x) in states.iter().enumerate() {
            for (at, contact) in contacts.iter().enumerate() {
                values[(sample, at)] = contact.change_of_load(x);
                values[(sample, contacts.len() + at)] = along(&contact.sliding, x);
            }
            for (state, place) in (2 * contacts.len()..self.scales.len()).enumerate() {
                values[(sample, place)] = x[2 * self.system.order() + state];
            }
        }
        let mut series = &self.balance.project * values;
        series.column_iter_mut().zip(&self.scales).for_each(|(mut column, scale)| column /= *scale);
        let mut series = DVector::from_column_slice(series.as_slice());
        // The amplitude in the mode becomes real.
        let part = |quarter| self.amplitude_row(quarter).rows(0, series.len()).dot(&series);
        let phase = Complex::new(part(false), part(true)).arg();
        self.balance.turn(&mut series, phase);
        let omega = std::f64::consts::TAU / cycle.period;
        Ok(BalancedCycle { series, omega, parameter, residual: f64::INFINITY })
    }

    /// State of motion of a balanced cycle at the begin of its period.
    pub fn state(&self, cycle: &BalancedCycle) -> Result<Vec<f64>, Error> {
        let (n, contacts) = (self.system.order(), self.system.contacts());
        let terms = self.balance.terms();
        let forces = self.forces(&cycle.series, cycle.omega);
        let series_of = |forces: &[ContactForces], value: fn(&ContactForces) -> f64| {
            &self.balance.project * DVector::from_iterator(forces.len(), forces.iter().map(value))
        };
        let series: Vec<_> =
            forces.iter().map(|f| (series_of(f, |f| f.excess), series_of(f, |f| f.friction))).collect();
        let mut x = vec![0.0; self.system.dimension()];
        for k in 0..=self.balance.harmonics {
            let at = |series: &DVector<f64>| match k {
                0 => Complex::from(series[0]),
                k => Complex::new(series[2 * k - 1], -series[2 * k]),
            };
            let mut force = DVector::<Complex<f64>>::zeros(n);
            for (contact, (excess, friction)) in contacts.iter().zip(&series) {
                contact.normal.iter().for_each(|&(dof, c)| force[dof] -= at(excess) * c);
                contact.sliding.iter().for_each(|&(dof, b)| force[dof] += at(friction) * b);
            }
            let lambda = Complex::new(0.0, k as f64 * cycle.omega);
            let singular = Error::Structure("the structure resonates without damping at a harmonic of the motion");
            let u = self.system.structure().dynamic_stiffness(lambda).lu().solve(&force).ok_or(singular)?;
            for dof in 0..n {
                x[dof] += u[dof].re;
                x[n + dof] += (lambda * u[dof]).re;
            }
        }
        for (state, place) in (2 * contacts.len()..self.scales.len()).enumerate() {
            let own = cycle.series.rows(place * terms, terms);
            x[2 * n + state] =
                self.scales[place] * (own[0] + (1..=self.balance.harmonics).map(|k| own[2 * k - 1]).sum::<f64>());
        }
        Ok(x)
    }
}
