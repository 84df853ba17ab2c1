//! Periodic motions by shooting, and their Floquet multipliers from the variational equation.

use nalgebra::{DMatrix, DVector, Schur};
use num_complex::Complex;

use crate::dopri::{Flow, Integrator};
use crate::{ContactSystem, Error};

/// Corrections after which a shooting has failed; chosen.
const MOST_CORRECTIONS: usize = 12;

/// Multipliers up to this far beyond the unit circle count as on it; chosen, far above the error of a monodromy matrix.
const ON_THE_CIRCLE: f64 = 1e-5;

/// A periodic motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// State of motion at its begin.
    pub start: Vec<f64>,
    /// Period, s.
    pub period: f64,
    /// Difference of the states at begin and end, relative to the motion's scales and size.
    pub residual: f64,
    /// Floquet multipliers, by magnitude, largest first, without the one of a shift in time.
    pub multipliers: Vec<Complex<f64>>,
}

impl Cycle {
    /// Frequency, Hz.
    #[must_use]
    pub fn frequency_hz(&self) -> f64 {
        1.0 / self.period
    }

    /// The largest multiplier's magnitude: what a small deviation becomes in a period.
    #[must_use]
    pub fn largest_multiplier(&self) -> f64 {
        self.multipliers.first().map_or(0.0, |multiplier| multiplier.norm())
    }

    /// True if neighbouring motions do not leave it: no multiplier is larger than 1 + 1e-5. A cycle whose neighbours neither come nor go counts
    /// as stable.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.largest_multiplier() <= 1.0 + ON_THE_CIRCLE
    }
}

/// A motion with the derivative of its state by the state at its begin, column by column after the state.
struct Variation<'a> {
    system: &'a ContactSystem,
    scales: &'a [f64],
}

impl Flow for Variation<'_> {
    fn rate(&self, x: &[f64], out: &mut [f64]) {
        let d = self.system.dimension();
        let (x, columns) = x.split_at(d);
        let (rate, rates) = out.split_at_mut(d);
        self.system.rate(x, rate);
        // Rows that only say that velocities are rates of displacements are copied.
        let (n, jacobian) = (self.system.order(), self.system.jacobian(x));
        let below = jacobian.rows(n, d - n);
        let columns = nalgebra::DMatrixView::from_slice(columns, d, d);
        let mut rates = nalgebra::DMatrixViewMut::from_slice(rates, d, d);
        rates.rows_mut(0, n).copy_from(&columns.rows(n, n));
        rates.rows_mut(n, d - n).gemm(1.0, &below, &columns, 0.0);
    }

    fn switches(&self, x: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.system.contacts().iter().map(|contact| contact.load + contact.approach(x)));
    }

    fn scales(&self) -> &[f64] {
        self.scales
    }

    fn go_on(&self) -> Result<(), Error> {
        self.system.go_on()
    }
}

/// State after a period, and its derivative by the state at the begin.
fn monodromy(
    system: &ContactSystem,
    start: &[f64],
    period: f64,
    scales: &[f64],
    tolerance: f64,
) -> Result<(Vec<f64>, DMatrix<f64>), Error> {
    let d = system.dimension();
    let mut x = start.to_vec();
    x.extend_from_slice(DMatrix::<f64>::identity(d, d).as_slice());
    let flow = Variation { system, scales };
    let mut motion = Integrator::new(&flow, x, tolerance, 0.01 * period);
    while motion.time < period {
        motion.step(period)?;
    }
    let matrix = DMatrix::from_column_slice(d, d, &motion.x[d..]);
    motion.x.truncate(d);
    Ok((motion.x, matrix))
}

/// The periodic motion near a state and a period, by Newton's method on `x(T; x_0) = x_0` with `x_0` moved across the motion, and its
/// multipliers.
///
/// # Errors
/// [`Error::NoConvergence`]; a motion that cannot be followed.
pub fn shoot(
    system: &ContactSystem,
    start: Vec<f64>,
    period: f64,
    scales: &[f64],
    tolerance: f64,
) -> Result<Cycle, Error> {
    let d = system.dimension();
    let (mut x, mut period, mut best) = (start, period, f64::INFINITY);
    let mut rate = vec![0.0; d];
    let wanted = (1e3 * tolerance).min(1e-6);
    for _ in 0..MOST_CORRECTIONS {
        let (end, matrix) = monodromy(system, &x, period, scales, tolerance)?;
        let size = x.iter().zip(scales).map(|(x, scale)| (x / scale).abs()).fold(f64::MIN_POSITIVE, f64::max);
        let difference = DVector::from_fn(d, |i, _| (end[i] - x[i]) / scales[i]);
        let residual = difference.amax() / size;
        let scaled = DMatrix::from_fn(d, d, |i, j| matrix[(i, j)] * scales[j] / scales[i]);
        let is_done = residual < 10.0 * tolerance || (residual < wanted && residual > 0.1 * best);
        if is_done {
            let multipliers = multipliers(scaled)?;
            return Ok(Cycle { start: x, period, residual, multipliers });
        }
        best = best.min(residual);
        let mut bordered = DMatrix::zeros(d + 1, d + 1);
        bordered.view_mut((0, 0), (d, d)).copy_from(&(scaled - DMatrix::identity(d, d)));
        system.rate(&end, &mut rate);
        (0..d).for_each(|i| bordered[(i, d)] = rate[i] * period / scales[i]);
        system.rate(&x, &mut rate);
        (0..d).for_each(|i| bordered[(d, i)] = rate[i] * period / scales[i]);
        let right = DVector::from_fn(d + 1, |i, _| if i < d { -difference[i] } else { 0.0 });
        let Some(step) = bordered.lu().solve(&right).filter(|step| step.iter().all(|x| x.is_finite())) else { break };
        // Far from a solution a full step leaves the motion.
        let factor = (0.5 * size / step.rows(0, d).amax()).min(0.2 / step[d].abs()).min(1.0);
        x.iter_mut().zip(scales).zip(&step).for_each(|((x, scale), step)| *x += factor * scale * step);
        period *= 1.0 + factor * step[d];
    }
    Err(Error::NoConvergence { method: "shooting", residual: best })
}

/// Floquet multipliers of a monodromy matrix, without the one nearest 1.
fn multipliers(matrix: DMatrix<f64>) -> Result<Vec<Complex<f64>>, Error> {
    let failed = Error::NoConvergence { method: "the spectrum of the monodromy matrix", residual: f64::NAN };
    let schur = Schur::try_new(matrix, f64::EPSILON, 100_000).ok_or(failed)?;
    let mut all: Vec<Complex<f64>> = schur.complex_eigenvalues().iter().copied().collect();
    all.sort_by(|a, b| (a - 1.0).norm().total_cmp(&(b - 1.0).norm()));
    all.remove(0);
    all.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    Ok(all)
}
