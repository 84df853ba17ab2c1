//! Harmonic balance of the contacts: periodic motions as Fourier series of what the contacts see.
//!
//! M. Krack, J. Gross, Harmonic Balance for Nonlinear Vibration Problems, Springer 2019; S. Coudeyras, J.-J. Sinou, S. Nacivet, A new treatment
//! for predicting the self-excited vibrations of nonlinear systems with frictional interfaces, J. Sound Vib. 319 (2009) 1175-1199.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::contact::along;
use crate::measure::states;
use crate::motion::{amplitude, distance};
use crate::shooting::shoot;
use crate::system::ContactForces;
use crate::{ContactSystem, Cycle, Error, NearMode, SystemAt};

/// Corrections after which Newton's method has failed; chosen.
const MOST_CORRECTIONS: usize = 15;

/// Most harmonics and samples; chosen: more take long and say nothing, as the forces of contacts have kinks.
const MOST_HARMONICS: usize = 100;
const MOST_SAMPLES: usize = 16_384;

/// Residual of the balance at which it is solved, relative to the scales of its unknowns; chosen.
const SOLVED: f64 = 1e-11;

/// Differences of a balance and the motion in time that it approximates, at most: of the start relative to its size, of the period; chosen.
const OWN_START: f64 = 0.3;
const OWN_PERIOD: f64 = 0.05;

/// Fourier series of a number of harmonics, with the forces of contacts evaluated at equal steps of a period (alternating frequency and time).
///
/// A series of an output y is `y = a_0 + sum_k (a_k cos k tau + b_k sin k tau)`, stored as `a_0, a_1, b_1, a_2, ...`.
#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    harmonics: usize,
    /// Values at the samples of each term of a series, and the way back.
    evaluate: DMatrix<f64>,
    project: DMatrix<f64>,
}

/// A periodic motion as a balance knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct BalancedCycle {
    /// Series of the outputs, each divided by its scale, one after the other: the gaps of all contacts, then their slips, then bristles.
    pub series: DVector<f64>,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// The parameter.
    pub parameter: f64,
    /// Residual of the balance, relative to the scales.
    pub residual: f64,
}

/// A linear condition on the unknowns of a balance, with the amplitude, the parameter or the arc as what is given.
#[derive(Debug, Clone)]
pub(crate) struct Condition {
    pub row: DVector<f64>,
    pub value: f64,
}

/// Transfer from the forces of contacts to what they see, by harmonic, and its derivative by the angular frequency.
struct Transfer {
    h: Vec<DMatrix<Complex<f64>>>,
    by_omega: Vec<DMatrix<Complex<f64>>>,
}

/// The equations of a balance for one system.
pub(crate) struct Equations<'a> {
    balance: &'a Balance,
    system: &'a ContactSystem,
    /// Scales of the outputs.
    scales: Vec<f64>,
    omega_scale: f64,
    /// Shape of the mode in the outputs, which fixes phase and amplitude.
    shape: Vec<Complex<f64>>,
}

impl Balance {
    /// Series with `harmonics` above the mean, and forces at `samples` equal steps.
    ///
    /// # Errors
    /// No harmonic or more than 100; fewer samples than a series has terms, or more than 16,384.
    pub fn new(harmonics: usize, samples: usize) -> Result<Self, Error> {
        let terms = harmonics.saturating_mul(2).saturating_add(1);
        if harmonics == 0 || harmonics > MOST_HARMONICS {
            let allowed = format!("1 to {MOST_HARMONICS}");
            return Err(Error::Setting { field: "harmonics", value: harmonics as f64, allowed });
        }
        if samples > MOST_SAMPLES {
            let allowed = format!("at most {MOST_SAMPLES}");
            return Err(Error::Setting { field: "samples of a period", value: samples as f64, allowed });
        }
        if samples < terms {
            let allowed = format!("{terms} or more, two for each of {harmonics} harmonics and one for the mean");
            return Err(Error::Setting { field: "samples of a period", value: samples as f64, allowed });
        }
        let term = |sample: usize, term: usize| {
            let angle = std::f64::consts::TAU * ((sample * term.div_ceil(2)) % samples) as f64 / samples as f64;
            if term > 0 && term.is_multiple_of(2) { angle.sin() } else { angle.cos() }
        };
        let evaluate = DMatrix::from_fn(samples, terms, term);
        let weight = |term: usize| if term == 0 { 1.0 } else { 2.0 } / samples as f64;
        let project = DMatrix::from_fn(terms, samples, |row, sample| weight(row) * evaluate[(sample, row)]);
        Ok(Self { harmonics, evaluate, project })
    }

    fn terms(&self) -> usize {
        2 * self.harmonics + 1
    }

    /// Derivative by tau of a series, or of the columns of a matrix that acts on one: `(a, b)` becomes `k (b, -a)`.
    fn derivative(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.terms(), self.terms());
        for k in 1..=self.harmonics {
            matrix[(2 * k - 1, 2 * k)] = k as f64;
            matrix[(2 * k, 2 * k - 1)] = -(k as f64);
        }
        matrix
    }
}

impl<'a> Equations<'a> {
    /// The equations of a system for motions near a mode.
    pub fn new(balance: &'a Balance, system: &'a ContactSystem, omega: f64, shape: &[Complex<f64>]) -> Self {
        let length = system.scales(omega)[0];
        let contacts = system.contacts();
        let gaps = contacts.iter().map(|contact| contact.load);
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

    fn size(&self) -> usize {
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
            let forces = self.system.forces(contact, 0.0, self.system.contacts()[contact].speed, 0.0);
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
                values[(sample, at)] = contact.approach(x);
                values[(sample, contacts.len() + at)] = along(&contact.sliding, x);
            }
            for (state, place) in (2 * contacts.len()..self.scales.len()).enumerate() {
                values[(sample, place)] = x[2 * self.system.order() + state];
            }
        }
        let mut series = &self.balance.project * values;
        series.column_iter_mut().zip(&self.scales).for_each(|(mut column, scale)| column /= *scale);
        // Shift in time: the amplitude in the mode becomes real.
        let flat = DVector::from_column_slice(series.as_slice());
        let part = |quarter| self.amplitude_row(quarter).rows(0, flat.len()).dot(&flat);
        let phase = Complex::new(part(false), part(true)).arg();
        for k in 1..=self.balance.harmonics {
            let (sin, cos) = (k as f64 * phase).sin_cos();
            for mut column in series.column_iter_mut() {
                let (a, b) = (column[2 * k - 1], column[2 * k]);
                // (a - i b) e^(-i k phase)
                column[2 * k - 1] = a * cos - b * sin;
                column[2 * k] = b * cos + a * sin;
            }
        }
        let omega = std::f64::consts::TAU / cycle.period;
        Ok(BalancedCycle {
            series: DVector::from_column_slice(series.as_slice()),
            omega,
            parameter,
            residual: f64::INFINITY,
        })
    }

    fn transfer(&self, omega: f64) -> Result<Transfer, Error> {
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
            let turned = structure.dynamic_stiffness_derivative(lambda) * Complex::new(0.0, k as f64) * &response;
            let change = lu.solve(&turned).ok_or(singular)?;
            h.push(&output * response);
            by_omega.push(-(&output * change));
        }
        Ok(Transfer { h, by_omega })
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

    /// Forces of each contact over the samples.
    fn forces(&self, series: &DVector<f64>, omega: f64) -> Vec<Vec<ContactForces>> {
        let (terms, contacts) = (self.balance.terms(), self.system.contacts().len());
        let of = |output: usize| series.rows(output * terms, terms) * self.scales[output];
        let derivative = self.balance.derivative();
        let mut bristle = 2 * contacts;
        (0..contacts)
            .map(|contact| {
                let gap = &self.balance.evaluate * of(contact);
                let slip = &self.balance.evaluate * (&derivative * of(contacts + contact)) * omega;
                let state = self.system.bristle(contact).map(|_| {
                    bristle += 1;
                    &self.balance.evaluate * of(bristle - 1)
                });
                let speed = self.system.contacts()[contact].speed;
                let at = |sample: usize| {
                    let state = state.as_ref().map_or(0.0, |state| state[sample]);
                    self.system.forces(contact, gap[sample], speed - slip[sample], state)
                };
                (0..gap.len()).map(at).collect()
            })
            .collect()
    }

    /// Residual of the balance and, where wanted, its derivatives by the series and the angular frequency in its scale.
    pub fn residual(
        &self,
        series: &DVector<f64>,
        omega: f64,
        wants_jacobian: bool,
    ) -> Result<(DVector<f64>, DMatrix<f64>), Error> {
        let (terms, size) = (self.balance.terms(), self.size());
        let contacts = self.system.contacts().len();
        let Balance { evaluate, project, harmonics } = self.balance;
        let transfer = self.transfer(omega)?;
        let derivative = self.balance.derivative();
        let forces = self.forces(series, omega);
        let mut residual = DMatrix::from_column_slice(size, 1, series.as_slice());
        let mut jacobian = DMatrix::zeros(size, if wants_jacobian { size + 1 } else { 0 });
        // Product of a transfer with a series of a force, for each output and all columns of `force`, is taken from `to`.
        let subtract = |h: &[DMatrix<Complex<f64>>],
                        input: usize,
                        force: &DMatrix<f64>,
                        mut to: nalgebra::DMatrixViewMut<'_, f64>| {
            for output in 0..2 * contacts {
                for column in 0..force.ncols() {
                    let (rows, place) = (force.column(column), output * terms);
                    to[(place, column)] -= h[0][(output, input)].re * rows[0];
                    for k in 1..=*harmonics {
                        let (h, a, b) = (h[k][(output, input)], rows[2 * k - 1], rows[2 * k]);
                        to[(place + 2 * k - 1, column)] -= h.re * a + h.im * b;
                        to[(place + 2 * k, column)] -= h.re * b - h.im * a;
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
            let product = |value: fn(&ContactForces) -> f64| {
                let mut weighted = evaluate.clone();
                weighted.row_iter_mut().zip(forces).for_each(|(mut row, forces)| row *= value(forces));
                project * weighted
            };
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
            let all = size;
            let columns = |at: usize| (0, at * terms);
            let scale = self.scales[contact];
            subtract(&transfer.h, contact, &(by_gap.0 * scale), jacobian.view_mut(columns(contact), (all, terms)));
            subtract(&transfer.h, slip, &(by_gap.1 * scale), jacobian.view_mut(columns(contact), (all, terms)));
            let by_slip = -(&by_velocity * &derivative) * (omega * self.scales[slip]);
            subtract(&transfer.h, slip, &by_slip, jacobian.view_mut(columns(slip), (all, terms)));
            // By the frequency: through the transfer, and through the velocity of the slip.
            let last = (0, size);
            subtract(&transfer.by_omega, contact, &(excess * self.omega_scale), jacobian.view_mut(last, (all, 1)));
            subtract(&transfer.by_omega, slip, &(friction * self.omega_scale), jacobian.view_mut(last, (all, 1)));
            let turned = &derivative * &slip_series;
            let by_omega =
                DMatrix::from_column_slice(terms, 1, (-(&by_velocity * &turned) * self.omega_scale).as_slice());
            subtract(&transfer.h, slip, &by_omega, jacobian.view_mut(last, (all, 1)));
            if let Some(state) = state {
                let by_state = product(|f| f.friction_by_state) * self.scales[state];
                subtract(&transfer.h, slip, &by_state, jacobian.view_mut(columns(state), (all, terms)));
                let by_rate = product(|f| f.rate_by_velocity);
                let mut rows = jacobian.rows_mut(state * terms, terms);
                let of_slip = -(&by_rate * &derivative) * (omega * self.scales[slip] * rate_scale);
                rows.columns_mut(slip * terms, terms).copy_from(&of_slip);
                let own = (product(|f| f.rate_by_state) - &derivative * omega) * (self.scales[state] * rate_scale);
                rows.columns_mut(state * terms, terms).copy_from(&own);
                let own = series.rows(state * terms, terms) * self.scales[state];
                let by_omega = -(&by_rate * turned + &derivative * own) * (self.omega_scale * rate_scale);
                rows.column_mut(size).copy_from(&by_omega);
            }
        }
        Ok((residual.column(0).into_owned(), jacobian))
    }
}

/// Solves the balance of a system that is a function of a parameter, near `guess`, with its phase fixed and one more `condition`.
///
/// # Errors
/// [`Error::NoConvergence`]; what the system refuses.
pub(crate) fn solve<E: From<Error>>(
    balance: &Balance,
    system_at: SystemAt<'_, E>,
    mode: NearMode<'_>,
    guess: DVector<f64>,
    condition: &Condition,
    parameter_scale: f64,
) -> Result<(BalancedCycle, DMatrix<f64>, usize), E> {
    let (omega_scale, shape) = mode;
    let mut unknowns = guess;
    let mut last = f64::INFINITY;
    for correction in 0..MOST_CORRECTIONS {
        let size = unknowns.len() - 2;
        let (omega, parameter) = (unknowns[size] * omega_scale, unknowns[size + 1] * parameter_scale);
        let system = system_at(parameter)?;
        let equations = Equations::new(balance, &system, omega_scale, shape);
        let series = unknowns.rows(0, size).into_owned();
        let (residual, jacobian) = equations.residual(&series, omega, true)?;
        let step = 1e-6 * parameter_scale;
        // The parameter may move scales too, and so the phase.
        let shifted = |by: f64| -> Result<DVector<f64>, E> {
            let system = system_at(parameter + by)?;
            let equations = Equations::new(balance, &system, omega_scale, shape);
            Ok(equations.residual(&series, omega, false)?.0.push(equations.amplitude_row(true).dot(&unknowns)))
        };
        let by_parameter = (shifted(step)? - shifted(-step)?) / 2e-6;
        let mut matrix = DMatrix::zeros(size + 2, size + 2);
        matrix.view_mut((0, 0), (size, size + 1)).copy_from(&jacobian);
        let phase = equations.amplitude_row(true);
        matrix.row_mut(size).copy_from(&phase.transpose());
        matrix.view_mut((0, size + 1), (size + 1, 1)).copy_from(&by_parameter);
        matrix.row_mut(size + 1).copy_from(&condition.row.transpose());
        let mut right = DVector::zeros(size + 2);
        right.rows_mut(0, size).copy_from(&-&residual);
        right[size] = -phase.dot(&unknowns);
        right[size + 1] = condition.value - condition.row.dot(&unknowns);
        let found = right.amax();
        if found < SOLVED || (found < 1e3 * SOLVED && found > 0.3 * last) {
            return Ok((equations.cycle(&unknowns, parameter_scale, found), matrix, correction));
        }
        last = found;
        let failed = Error::NoConvergence { method: "harmonic balance", residual: found };
        let lu = matrix.lu();
        let Some(step) = lu.solve(&right).filter(|step| step.iter().all(|x| x.is_finite())) else {
            return Err(failed.into());
        };
        unknowns += step;
        if unknowns[size] <= 0.0 {
            return Err(failed.into());
        }
    }
    Err(Error::NoConvergence { method: "harmonic balance", residual: last }.into())
}

impl Balance {
    /// The balanced cycle nearest to one found in time, of the same system. Its own first harmonic fixes its phase.
    ///
    /// # Errors
    /// [`Error::NoConvergence`]; a motion that cannot be followed.
    pub fn near(&self, system: &ContactSystem, cycle: &Cycle, tolerance: f64) -> Result<BalancedCycle, Error> {
        let samples = self.evaluate.nrows();
        let mut shape = vec![Complex::default(); system.order()];
        for (sample, x) in states(system, cycle, samples, tolerance)?.iter().enumerate() {
            let turn = Complex::cis(-std::f64::consts::TAU * sample as f64 / samples as f64) * 2.0 / samples as f64;
            shape.iter_mut().zip(x).for_each(|(phi, u)| *phi += turn * u);
        }
        let (omega, shape) = (std::f64::consts::TAU / cycle.period, &shape[..]);
        let equations = Equations::new(self, system, omega, shape);
        let guess = equations.unknowns(&equations.of_cycle(cycle, 1.0, tolerance)?, 1.0);
        let mut row = DVector::zeros(guess.len());
        row[guess.len() - 1] = 1.0;
        let same = |_: f64| Ok::<_, Error>(system.clone());
        Ok(solve(self, &same, (omega, shape), guess, &Condition { row, value: 1.0 }, 1.0)?.0)
    }

    /// The motion in time that a balanced cycle is an approximation of, with its Floquet multipliers.
    ///
    /// # Errors
    /// [`Error::NoConvergence`], also where shooting goes away to another motion; a motion that cannot be followed.
    pub fn refined(
        &self,
        system: &ContactSystem,
        cycle: &BalancedCycle,
        (omega, shape): NearMode<'_>,
        tolerance: f64,
    ) -> Result<Cycle, Error> {
        let (start, scales) = (Equations::new(self, system, omega, shape).state(cycle)?, system.scales(omega));
        let period = std::f64::consts::TAU / cycle.omega;
        let refined = shoot(system, start.clone(), period, &scales, tolerance)?;
        let moved = distance(&refined.start, &start, &scales) / amplitude(&start, &scales);
        let changed = (refined.period / period - 1.0).abs();
        if moved < OWN_START && changed < OWN_PERIOD {
            return Ok(refined);
        }
        Err(Error::NoConvergence { method: "shooting to the motion of a balance", residual: moved.max(changed) })
    }
}
