//! The residual of a harmonic balance and its Jacobian.
//!
//! The unknowns are the Fourier series of the *outputs* of each contact i, with tau = omega t: its gap `k_i c_i^T u`, N, which is the change of the
//! normal force and so grows as the contact closes, and its slip `b_i^T u`, m; and, if it has a bristle, that of z_i, the deviation of the bristle's state
//! from steady sliding, z_i0. The series `a_0 + sum_k (a_k cos k tau + b_k sin k tau)` has the amplitudes `a_k - i b_k`, written with a hat below. The
//! *forces* F of a contact are its excess, which acts along `-c_i`, and its friction, which acts along `b_i` ([`ContactForces`]). They follow from the
//! outputs and their derivatives at equal time steps of a period, the samples. The residuals of an output q and of a bristle are, with Q the dynamic
//! stiffness of the structure,
//!
//! ```text
//! r_q = q_hat - H(i k omega) F_hat,       H = [k_i c_i^T; b_i^T] Q^-1 [-c_i, b_i]
//! r_z = f(w, z_0 + z) - omega dz/dtau,    w = v - omega d(b^T u)/dtau
//! ```
//!
//! each divided by a scale: gaps, slips and states by `scales`, omega by `omega_scale`, rates of states by both. Rows and columns of the Jacobian are in the
//! order of the series: the gaps of all contacts, their slips, the bristles, each with its terms `a_0, a_1, b_1, a_2, ...`; omega has the last column. Forces
//! are in the order of the outputs: the excesses of all contacts, then their frictions.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::{Balance, Equations};
use crate::Error;
use crate::system::ContactForces;

/// Transfer functions from the forces of contacts to their gaps and slips, for each harmonic from 0.
struct Transfer {
    /// H(i k omega), outputs by forces, with the outputs in their scales.
    h: Vec<DMatrix<Complex<f64>>>,
    /// Derivative of each H by omega, if it is wanted.
    by_omega: Vec<DMatrix<Complex<f64>>>,
}

impl Equations<'_> {
    /// The transfer functions at an angular frequency, rad/s, with or without their derivatives.
    fn transfer(&self, omega: f64, wants_derivatives: bool) -> Result<Transfer, Error> {
        let (n, contacts) = (self.system.order(), self.system.contacts());
        let structure = self.system.structure();
        let mut input = DMatrix::<Complex<f64>>::zeros(n, 2 * contacts.len());
        let mut output = DMatrix::<Complex<f64>>::zeros(2 * contacts.len(), n);
        for (at, contact) in contacts.iter().enumerate() {
            for &(dof, c) in &contact.normal {
                input[(dof, at)] -= Complex::from(c);
                output[(at, dof)] += Complex::from(contact.stiffness * c / self.scales[at]);
            }
            for &(dof, b) in &contact.sliding {
                input[(dof, contacts.len() + at)] += Complex::from(b);
                output[(contacts.len() + at, dof)] += Complex::from(b / self.scales[contacts.len() + at]);
            }
        }
        let (mut h, mut by_omega) = (Vec::new(), Vec::new());
        for k in 0..=self.balance.harmonics {
            let lambda = Complex::new(0.0, k as f64 * omega);
            let lu = structure.dynamic_stiffness(lambda).lu();
            let singular = Error::Structure("the structure resonates without damping at a harmonic of the motion");
            let response = lu.solve(&input).ok_or_else(|| singular.clone())?;
            if wants_derivatives {
                // d(Q^-1)/d omega = -Q^-1 (i k Q') Q^-1
                let slope = structure.dynamic_stiffness_derivative(lambda) * Complex::new(0.0, k as f64) * &response;
                by_omega.push(-(&output * lu.solve(&slope).ok_or(singular)?));
            }
            h.push(&output * response);
        }
        Ok(Transfer { h, by_omega })
    }

    /// The forces of each contact at the samples of a period.
    pub(super) fn forces(&self, series: &DVector<f64>, omega: f64) -> Vec<Vec<ContactForces>> {
        let (terms, contacts) = (self.balance.terms(), self.system.contacts().len());
        let of = |output: usize| series.rows(output * terms, terms) * self.scales[output];
        let derivative = self.balance.derivative();
        let mut bristle = 2 * contacts;
        (0..contacts)
            .map(|contact| {
                let gap = &self.balance.evaluate * of(contact);
                let slip_rate = &self.balance.evaluate * (&derivative * of(contacts + contact)) * omega;
                let state = self.system.bristle(contact).map(|_| {
                    bristle += 1;
                    &self.balance.evaluate * of(bristle - 1)
                });
                let [load, speed] = [self.system.contacts()[contact].load, self.system.contacts()[contact].speed];
                let at = |sample: usize| {
                    let state = state.as_ref().map_or(0.0, |state| state[sample]);
                    self.system.forces(
                        contact,
                        (load + gap[sample] > 0.0, crate::contact::Sliding::Smooth),
                        [gap[sample], speed - slip_rate[sample], state],
                    )
                };
                (0..gap.len()).map(at).collect()
            })
            .collect()
    }

    /// The residual of the balance and its Jacobian by the series and omega, all in their scales. The Jacobian has no column if it is not wanted.
    pub fn residual(
        &self,
        series: &DVector<f64>,
        omega: f64,
        wants_jacobian: bool,
    ) -> Result<(DVector<f64>, DMatrix<f64>), Error> {
        let (terms, size) = (self.balance.terms(), self.size());
        let contacts = self.system.contacts().len();
        let Balance { project, means, .. } = self.balance;
        let transfer = self.transfer(omega, wants_jacobian)?;
        let derivative = self.balance.derivative();
        let forces = self.forces(series, omega);
        let mut residual = DMatrix::from_column_slice(size, 1, series.as_slice());
        let mut jacobian = DMatrix::zeros(size, if wants_jacobian { size + 1 } else { 0 });
        // Subtracts H times the amplitudes of force number `input` from the rows of all outputs, for each column of `force`, which is a series.
        let subtract = |h: &[DMatrix<Complex<f64>>],
                        input: usize,
                        force: &DMatrix<f64>,
                        mut to: nalgebra::DMatrixViewMut<'_, f64>| {
            if force.iter().all(|force| *force == 0.0) {
                return;
            }
            for output in 0..2 * contacts {
                let h: Vec<Complex<f64>> = h.iter().map(|h| h[(output, input)]).collect();
                for (column, force) in force.column_iter().enumerate() {
                    let mut rows = to.view_mut((output * terms, column), (terms, 1));
                    rows[0] -= h[0].re * force[0];
                    for (k, h) in h.iter().enumerate().skip(1) {
                        let (a, b) = (force[2 * k - 1], force[2 * k]);
                        rows[2 * k - 1] -= h.re * a + h.im * b;
                        rows[2 * k] -= h.re * b - h.im * a;
                    }
                }
            }
        };
        if wants_jacobian {
            jacobian.view_mut((0, 0), (2 * contacts * terms, 2 * contacts * terms)).fill_with_identity();
        }
        let mut bristle = 2 * contacts;
        for (contact, forces) in forces.iter().enumerate() {
            let series_of = |value: fn(&ContactForces) -> f64| {
                let values = DMatrix::from_iterator(forces.len(), 1, forces.iter().map(value));
                project * values
            };
            // Derivative of the series of a force by that of an output, given the derivative of the force by the output at each sample.
            let product = |value: fn(&ContactForces) -> f64| {
                let values = DVector::from_iterator(forces.len(), forces.iter().map(value));
                if values.iter().all(|value| *value == 0.0) {
                    return DMatrix::zeros(terms, terms);
                }
                self.balance.products((means * values).column(0))
            };
            // The contact's slip is this one of the outputs, and its friction this one of the forces; its gap and its excess are number `contact`.
            let slip = contacts + contact;
            let slip_series = series.rows(slip * terms, terms) * self.scales[slip];
            let (excess, friction) = (series_of(|f| f.excess), series_of(|f| f.friction));
            subtract(&transfer.h, contact, &excess, residual.view_mut((0, 0), (size, 1)));
            subtract(&transfer.h, slip, &friction, residual.view_mut((0, 0), (size, 1)));
            let state = self.system.bristle(contact).map(|_| {
                bristle += 1;
                bristle - 1
            });
            let rate_scale = state.map_or(1.0, |state| 1.0 / (self.scales[state] * self.omega_scale));
            if let Some(state) = state {
                let own = series.rows(state * terms, terms) * self.scales[state];
                let rate = series_of(|f| f.rate).column(0) - &derivative * own * omega;
                residual.rows_mut(state * terms, terms).copy_from(&(rate * rate_scale));
            }
            if !wants_jacobian {
                continue;
            }
            let by_gap = (product(|f| f.excess_by_gap), product(|f| f.friction_by_gap));
            let by_velocity = product(|f| f.friction_by_velocity);
            let columns = |at: usize| (0, at * terms);
            let scale = self.scales[contact];
            subtract(&transfer.h, contact, &(by_gap.0 * scale), jacobian.view_mut(columns(contact), (size, terms)));
            subtract(&transfer.h, slip, &(by_gap.1 * scale), jacobian.view_mut(columns(contact), (size, terms)));
            let by_slip = -(&by_velocity * &derivative) * (omega * self.scales[slip]);
            subtract(&transfer.h, slip, &by_slip, jacobian.view_mut(columns(slip), (size, terms)));
            // By omega: through the transfer functions, and through w.
            let last = (0, size);
            subtract(&transfer.by_omega, contact, &(excess * self.omega_scale), jacobian.view_mut(last, (size, 1)));
            subtract(&transfer.by_omega, slip, &(friction * self.omega_scale), jacobian.view_mut(last, (size, 1)));
            let slip_slope = &derivative * &slip_series;
            let by_omega =
                DMatrix::from_column_slice(terms, 1, (-(&by_velocity * &slip_slope) * self.omega_scale).as_slice());
            subtract(&transfer.h, slip, &by_omega, jacobian.view_mut(last, (size, 1)));
            if let Some(state) = state {
                let by_state = product(|f| f.friction_by_state) * self.scales[state];
                subtract(&transfer.h, slip, &by_state, jacobian.view_mut(columns(state), (size, terms)));
                let rate_by_velocity = product(|f| f.rate_by_velocity);
                let mut rows = jacobian.rows_mut(state * terms, terms);
                let of_slip = -(&rate_by_velocity * &derivative) * (omega * self.scales[slip] * rate_scale);
                rows.columns_mut(slip * terms, terms).copy_from(&of_slip);
                let own = (product(|f| f.rate_by_state) - &derivative * omega) * (self.scales[state] * rate_scale);
                rows.columns_mut(state * terms, terms).copy_from(&own);
                let own = series.rows(state * terms, terms) * self.scales[state];
                let by_omega = -(&rate_by_velocity * slip_slope + &derivative * own) * (self.omega_scale * rate_scale);
                rows.column_mut(size).copy_from(&by_omega);
            }
        }
        Ok((residual.column(0).into_owned(), jacobian))
    }
}
