//! Harmonic balance of the contacts: periodic motions as Fourier series of what the contacts see.
//!
//! M. Krack, J. Gross, Harmonic Balance for Nonlinear Vibration Problems, Springer 2019; S. Coudeyras, J.-J. Sinou, S. Nacivet, A new treatment
//! for predicting the self-excited vibrations of nonlinear systems with frictional interfaces, J. Sound Vib. 319 (2009) 1175-1199.

mod equations;
mod residual;
mod solve;

use nalgebra::{DMatrix, DVector, DVectorView};
use num_complex::Complex;
use serde::{Deserialize, Serialize};

pub(crate) use self::equations::Equations;
pub(crate) use self::solve::{Condition, solve};
use crate::measure::states;
use crate::shooting::shoot;
use crate::{ContactSystem, Cycle, Error, NearMode};

/// Most harmonics and samples; chosen: more take long and say nothing, as the forces of contacts have kinks.
const MOST_HARMONICS: usize = 100;
const MOST_SAMPLES: usize = 16_384;

/// Differences of a balance and the motion in time that it approximates, at most: of the series relative to its size, of the period; chosen: of few harmonics
/// a balance is some per cent off.
const OWN_SERIES: f64 = 0.3;
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
    /// Means of the products of samples with 1, cos tau, sin tau, cos 2 tau, ... up to twice the harmonics.
    means: DMatrix<f64>,
}

/// A periodic motion as a balance knows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BalancedCycle {
    /// Series of the outputs, each divided by its scale, one after the other: the gaps of all contacts, then their slips, then bristles.
    #[serde(with = "numbers")]
    pub series: DVector<f64>,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// The parameter.
    pub parameter: f64,
    /// Residual of the balance, relative to the scales.
    pub residual: f64,
}
/// A vector as its numbers.
mod numbers {
    use nalgebra::DVector;
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(of: &DVector<f64>, to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(of.as_slice())
    }

    pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<DVector<f64>, D::Error> {
        Vec::deserialize(from).map(DVector::from_vec)
    }
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
        let means = DMatrix::from_fn(2 * terms - 1, samples, |row, sample| term(sample, row) / samples as f64);
        Ok(Self { harmonics, evaluate, project, means })
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

    /// Turns series by a phase, as a shift in time does: `(a - i b) e^(-i k phase)`.
    fn turn(&self, series: &mut DVector<f64>, phase: f64) {
        for own in series.as_mut_slice().chunks_mut(self.terms()) {
            for k in 1..=self.harmonics {
                let (sin, cos) = (k as f64 * phase).sin_cos();
                let (a, b) = (own[2 * k - 1], own[2 * k]);
                own[2 * k - 1] = a * cos - b * sin;
                own[2 * k] = b * cos + a * sin;
            }
        }
    }

    /// Series of the products of a function of time with the terms of a series, one a column, by the means of the function: a product of two of these
    /// is a sum of others.
    fn products(&self, means: DVectorView<'_, f64>) -> DMatrix<f64> {
        let cos = |k: usize| means[(2 * k).saturating_sub(1)];
        let sin = |k: usize| if k == 0 { 0.0 } else { means[2 * k] };
        DMatrix::from_fn(self.terms(), self.terms(), |row, column| {
            let (k, l) = (row.div_ceil(2), column.div_ceil(2));
            let sign = if k < l { -1.0 } else { 1.0 };
            let (sum, difference) = (k + l, k.abs_diff(l));
            // A sine has an even number, but for 0.
            let twice = match (row > 0 && row.is_multiple_of(2), column > 0 && column.is_multiple_of(2)) {
                (false, false) => cos(difference) + cos(sum),
                (true, true) => cos(difference) - cos(sum),
                (true, false) => sin(sum) + sign * sin(difference),
                (false, true) => sin(sum) - sign * sin(difference),
            };
            if row == 0 { 0.5 * twice } else { twice }
        })
    }
}

impl Balance {
    /// The balanced cycle nearest to one found in time, of the same system. Its own first harmonic fixes its phase.
    ///
    /// # Errors
    /// [`Error::NoConvergence`], also where it goes away to another motion; a motion that cannot be followed.
    pub fn near(&self, system: &ContactSystem, cycle: &Cycle, tolerance: f64) -> Result<BalancedCycle, Error> {
        let samples = self.evaluate.nrows();
        let mut shape = vec![Complex::default(); system.order()];
        for (sample, x) in states(system, cycle, samples, tolerance)?.iter().enumerate() {
            let turn = Complex::cis(-std::f64::consts::TAU * sample as f64 / samples as f64) * 2.0 / samples as f64;
            shape.iter_mut().zip(x).for_each(|(phi, u)| *phi += turn * u);
        }
        let (omega, shape) = (std::f64::consts::TAU / cycle.period, &shape[..]);
        let equations = Equations::new(self, system, omega, shape);
        let in_time = equations.of_cycle(cycle, 1.0, tolerance)?;
        let guess = equations.unknowns(&in_time, 1.0);
        let mut row = DVector::zeros(guess.len());
        row[guess.len() - 1] = 1.0;
        let same = |_: f64| Ok::<_, Error>(system.clone());
        let balanced = solve(self, &same, (omega, shape), guess, &Condition { row, value: 1.0 }, 1.0)?.0;
        self.own(&balanced, &in_time, "the balance of a motion")?;
        Ok(balanced)
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
        let (equations, scales) = (Equations::new(self, system, omega, shape), system.scales(omega));
        let period = std::f64::consts::TAU / cycle.omega;
        let refined = shoot(system, equations.state(cycle)?, period, &scales, tolerance)?;
        let in_time = equations.of_cycle(&refined, cycle.parameter, tolerance)?;
        self.own(cycle, &in_time, "shooting to the motion of a balance")?;
        Ok(refined)
    }

    /// Refuses a balance that is not that of a motion in time: the one rule for both ways between them.
    ///
    /// # Errors
    /// [`Error::NoConvergence`] of the `method`, with the larger difference.
    fn own(&self, balanced: &BalancedCycle, in_time: &BalancedCycle, method: &'static str) -> Result<(), Error> {
        let first = |of: &BalancedCycle| -> Vec<Complex<f64>> {
            of.series.as_slice().chunks(self.terms()).map(|own| Complex::new(own[1], -own[2])).collect()
        };
        let between: Complex<f64> = first(in_time).iter().zip(first(balanced)).map(|(a, b)| a * b.conj()).sum();
        let mut series = in_time.series.clone();
        self.turn(&mut series, between.arg());
        let moved = (series - &balanced.series).norm() / balanced.series.norm();
        let changed = (balanced.omega / in_time.omega - 1.0).abs();
        if moved < OWN_SERIES && changed < OWN_PERIOD {
            return Ok(());
        }
        Err(Error::NoConvergence { method, residual: moved.max(changed) })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn products_of_terms_are_those_at_the_samples() {
        for (harmonics, samples) in [(1, 3), (4, 9), (4, 64)] {
            let balance = Balance::new(harmonics, samples).unwrap();
            let values = DVector::from_fn(samples, |at, _| ((at * at + 3) % 7) as f64 - 1.5);
            let at_samples = &balance.project * DMatrix::from_diagonal(&values) * &balance.evaluate;
            let found = balance.products((&balance.means * values).column(0));
            assert!((found - at_samples).amax() < 1e-14, "{harmonics} {samples}");
        }
    }
}
