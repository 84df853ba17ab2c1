//! Branches of cycles over a parameter, from an onset or from a cycle, by pseudo-arclength through folds.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use serde::{Deserialize, Serialize};

use crate::factor::Factor;
use crate::harmonic_balance::{Condition, Equations, solve};
use crate::{Balance, BalancedCycle, ContactSystem, Error};

/// A system that is a function of a parameter.
pub type SystemAt<'a, E> = &'a dyn Fn(f64) -> Result<ContactSystem, E>;

/// The mode near which motions are: angular frequency, rad/s, and shape.
pub type NearMode<'a> = (f64, &'a [Complex<f64>]);

/// Limits of a branch, and of its steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Least and greatest value of the parameter.
    pub range: [f64; 2],
    /// Longest step along the branch, in amplitudes at which the first contact opens or sticks and widths of the range.
    pub longest_step: f64,
    /// Points after which a branch ends.
    pub most_points: usize,
}

/// A point of a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BranchPoint {
    /// The balanced cycle.
    pub cycle: BalancedCycle,
    /// Amplitude of the first harmonic in the mode, in that at which the first contact opens or sticks in it.
    pub amplitude: f64,
    /// True if the parameter turns between the point before and this one.
    pub is_fold: bool,
}

/// Why a branch ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum BranchEnd {
    /// End of the range of the parameter.
    Range,
    /// Steady sliding, to which the branch comes down.
    Sliding,
    /// Largest number of points; the branch goes on.
    MostPoints,
    /// Failure to follow the branch any further, though it may go on: the reason, in words.
    Lost(String),
}

impl std::fmt::Display for BranchEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Range => f.write_str("end of the range"),
            Self::Sliding => f.write_str("steady sliding"),
            Self::MostPoints => f.write_str("not reached: as many points as a branch may have"),
            Self::Lost(reason) => write!(f, "not reached: {reason}"),
        }
    }
}

/// Part along the parameter of a unit tangent up to which a branch stands upright, where it turns nowhere; chosen, far above rounding.
const UPRIGHT: f64 = 1e-8;

/// Steps shorter than this part of the longest are given up; chosen.
const SHORTEST: f64 = 1e-4;

/// Distances along the parameter, as parts of the longest step, at which a branch is looked for beyond a corner, and the largest distance of a point that is found so from the
/// last one before it, as such a part; chosen, from where steps are given up.
const BEYOND: [f64; 5] = [1e-4, 4e-4, 1.6e-3, 6.4e-3, 2.56e-2];
const NOT_FAR: f64 = 0.1;

/// Largest distance from the guess of a step to the point that is found from it, as a part of the step; chosen: a point farther away is one of another branch, of
/// steady sliding for example, which all amplitudes are solutions next to.
const FARTHEST: f64 = 1.0;

/// Part of the amplitude of the first kink with which a branch starts at an onset; chosen, where forces of a constant coefficient are linear.
const START: f64 = 0.5;

/// Amplitude, as a part of that of the first kink, below which a branch has ended in steady sliding; chosen.
const END: f64 = 1e-3;

/// Reason why a branch is lost where the shortest step too leads to another.
const ANOTHER_BRANCH: &str = "the next cycle is farther away than the shortest step, and belongs to another branch";

impl Balance {
    /// The branch that starts at an onset, and why it ends. The onset is a parameter with the angular frequency and shape of a mode on the
    /// imaginary axis. A branch over a constant coefficient of friction stands upright there until a contact opens.
    ///
    /// # Errors
    /// [`Error::NoConvergence`] where its first point is not found; what the system refuses.
    pub fn branch_from_onset<E: From<Error> + std::fmt::Display>(
        &self,
        system_at: SystemAt<'_, E>,
        mode: NearMode<'_>,
        onset: f64,
        reach: &Reach,
    ) -> Result<(Vec<BranchPoint>, BranchEnd), E> {
        let system = system_at(onset)?;
        let equations = Equations::new(self, &system, mode.0, mode.1);
        let width = reach.range[1] - reach.range[0];
        let amplitude = START * system.first_kink(mode.0, mode.1);
        let guess = equations.unknowns(&equations.of_mode(amplitude, mode.0, onset), width);
        let condition = Condition { row: equations.amplitude_row(false), value: amplitude };
        self.branch(system_at, mode, guess, &condition, reach)
    }

    /// A branch from the solution of a first condition on, in the direction in which its value grows.
    fn branch<E: From<Error> + std::fmt::Display>(
        &self,
        system_at: SystemAt<'_, E>,
        mode: NearMode<'_>,
        guess: DVector<f64>,
        first: &Condition,
        reach: &Reach,
    ) -> Result<(Vec<BranchPoint>, BranchEnd), E> {
        let [low, high] = reach.range;
        let width = high - low;
        if !(width > 0.0 && width.is_finite()) {
            let allowed = format!("above {low}");
            return Err(Error::Setting { field: "end of the range", value: high, allowed }.into());
        }
        // The parameter may move the scales of the series and the first kink.
        let amplitude_of = |cycle: &BalancedCycle| -> Result<f64, E> {
            let system = system_at(cycle.parameter)?;
            let row = Equations::new(self, &system, mode.0, mode.1).amplitude_row(false);
            let size = cycle.series.len();
            Ok(row.rows(0, size).dot(&cycle.series) / system.first_kink(mode.0, mode.1))
        };
        let unknowns = |cycle: &BalancedCycle| {
            let mut x = DVector::zeros(cycle.series.len() + 2);
            x.rows_mut(0, cycle.series.len()).copy_from(&cycle.series);
            x[cycle.series.len()] = cycle.omega / mode.0;
            x[cycle.series.len() + 1] = cycle.parameter / width;
            x
        };
        let (cycle, bordered, _) = solve(self, system_at, mode, guess, first, width)?;
        let mut x = unknowns(&cycle);
        let last = x.len() - 1;
        let mut points = vec![BranchPoint { amplitude: amplitude_of(&cycle)?, cycle, is_fold: false }];
        let unit = |at: usize| DVector::from_fn(last + 1, |i, _| if i == at { 1.0 } else { 0.0 });
        let no_tangent = || Error::NoConvergence { method: "the tangent of a branch", residual: f64::NAN };
        let tangent_of = |bordered: DMatrix<f64>| Some(Factor::new(bordered)?.solve(&unit(last))?.normalize());
        let mut tangent = tangent_of(bordered).ok_or_else(no_tangent)?;
        // The way along the parameter so far: none while the branch stands upright.
        let mut direction = if tangent[last].abs() > UPRIGHT { tangent[last] } else { 0.0 };
        // The amplitude of the first kink is the length by which the series are measured.
        let longest = reach.longest_step * points[0].cycle.series.norm() / points[0].amplitude;
        let mut step = 0.1 * longest;
        // At an end of the range a rounding error beyond it is none.
        let within = |at: f64| system_at(at.clamp(low, high));
        // Number of steps over a corner since the last along a tangent: each goes farther.
        let mut over = 0;
        while points.len() < reach.most_points {
            let guess = &x + &tangent * step;
            let condition = Condition { value: tangent.dot(&guess), row: tangent.clone() };
            let found = solve(self, system_at, mode, guess.clone(), &condition, width);
            let is_next = |cycle: &BalancedCycle| (unknowns(cycle) - &guess).norm() <= FARTHEST * step;
            let (cycle, bordered, corrections) = match found {
                Ok(found) if is_next(&found.0) => {
                    over = 0;
                    found
                }
                other => {
                    step *= 0.25;
                    if step >= SHORTEST * longest {
                        continue;
                    }
                    let lost = || {
                        let reason = other.err().map_or_else(|| ANOTHER_BRANCH.to_owned(), |error| error.to_string());
                        BranchEnd::Lost(reason)
                    };
                    if direction == 0.0 {
                        return Ok((points, lost()));
                    }
                    // Where the system has a kink over the parameter the branch has a corner, which no tangent leads around: it goes on along the parameter.
                    let (way, end) = (direction.signum(), if direction > 0.0 { high } else { low } / width);
                    let beyond = BEYOND.iter().skip(over).find_map(|part| {
                        let at = way * (way * x[last] + part * longest).min(way * end);
                        let condition = Condition { row: unit(last) * way, value: way * at };
                        let mut guess = x.clone();
                        guess[last] = at;
                        let found = solve(self, &within, mode, guess, &condition, width).ok()?;
                        let is_near = (unknowns(&found.0) - &x).norm() <= NOT_FAR * longest;
                        is_near.then_some((found, at == end))
                    });
                    match beyond {
                        None => return Ok((points, lost())),
                        Some(((cycle, ..), true)) => {
                            points.push(BranchPoint { amplitude: amplitude_of(&cycle)?, cycle, is_fold: false });
                            return Ok((points, BranchEnd::Range));
                        }
                        Some((found, false)) => {
                            (step, over) = (0.1 * longest, over + 1);
                            found
                        }
                    }
                }
            };
            let next = unknowns(&cycle);
            let Some(new_tangent) = tangent_of(bordered) else {
                return Ok((points, BranchEnd::Lost(no_tangent().to_string())));
            };
            let along = new_tangent[last];
            // From where it stands upright it may go back and turn before the next point.
            let before = if direction == 0.0 { next[last] - x[last] } else { direction };
            let is_fold = along.abs().min(before.abs()) > UPRIGHT && along * before < 0.0;
            if along.abs() > UPRIGHT {
                direction = along;
            }
            let amplitude = amplitude_of(&cycle)?;
            if amplitude < END {
                return Ok((points, BranchEnd::Sliding));
            }
            if !(low..=high).contains(&cycle.parameter) {
                // The last point is the one at the end of the range.
                let end = if cycle.parameter > high { high } else { low };
                let part = (end / width - x[last]) / (next[last] - x[last]);
                let guess = &x + (&next - &x) * part;
                let condition = Condition { row: unit(last), value: end / width };
                return match solve(self, &within, mode, guess, &condition, width) {
                    Ok((cycle, ..)) => {
                        points.push(BranchPoint { amplitude: amplitude_of(&cycle)?, cycle, is_fold });
                        Ok((points, BranchEnd::Range))
                    }
                    Err(error) => Ok((points, BranchEnd::Lost(error.to_string()))),
                };
            }
            points.push(BranchPoint { cycle, amplitude, is_fold });
            (x, tangent) = (next, new_tangent);
            step = (step
                * if corrections <= 3 {
                    1.5
                } else if corrections <= 6 {
                    1.0
                } else {
                    0.5
                })
            .min(longest);
        }
        Ok((points, BranchEnd::MostPoints))
    }
}
