//! Newton's method on a balance.

use nalgebra::{DMatrix, DVector};

use super::{Balance, BalancedCycle, Equations};
use crate::factor::Factor;
use crate::{Error, NearMode, SystemAt};

/// Corrections after which Newton's method has failed; chosen.
const MOST_CORRECTIONS: usize = 15;

/// Residual of the balance at which it is solved, relative to the scales of its unknowns; chosen.
const SOLVED: f64 = 1e-11;

/// A linear condition on the unknowns of a balance, with the amplitude, the parameter or the arc as what is given.
#[derive(Debug, Clone)]
pub(crate) struct Condition {
    pub row: DVector<f64>,
    pub value: f64,
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
        system.go_on()?;
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
        // Beyond the end of a table there is no system, and one side says the derivative.
        let by_parameter = match (shifted(step), shifted(-step)) {
            (Ok(more), Ok(less)) => (more - less) / 2e-6,
            (Ok(more), Err(_)) => (more - shifted(0.0)?) / 1e-6,
            (Err(_), Ok(less)) => (shifted(0.0)? - less) / 1e-6,
            (Err(error), Err(_)) => return Err(error),
        };
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
        let Some(step) = Factor::new(matrix).and_then(|factor| factor.solve(&right)) else {
            return Err(failed.into());
        };
        unknowns += step;
        if unknowns[size] <= 0.0 {
            return Err(failed.into());
        }
    }
    Err(Error::NoConvergence { method: "harmonic balance", residual: last }.into())
}
