//! Small deviations from a motion: the variational equation, over the pieces of the motion.

use nalgebra::{DMatrix, DVector};

use crate::Error;
use crate::moments::{FITTED, LEADING, fit, moment};
use crate::path::Path;
use crate::size::{amplitude, largest};

/// Terms of a series of deviations, at most; chosen.
const MOST_TERMS: usize = 60;

/// Part of the largest deviation that the last terms of a series may have; chosen, far below what a multiplier is known to.
const LAST_TERMS: f64 = 1e-11;

/// Part of the largest deviation above which terms that cancel each other cost too many digits; chosen.
const CANCELLING: f64 = 1e4;

/// Part of the largest deviation by which slopes of friction that are fitted may change one over a part of a piece; chosen, as what a piece may be wrong by.
const FIT: f64 = 1e-10;

/// Number of terms after which their size is looked at again, which costs as much as a term; chosen.
const LOOKED_AT: usize = 4;

/// Parts of a piece over which deviations have a series, at most; more, and numbers are not finite.
const MOST_PARTS: usize = 1 << 16;

/// Changes of the slopes of friction over a part of a piece, as powers of time from 0 on.
struct Slopes {
    contact: usize,
    /// Powers of the slopes of friction by gap, velocity and bristle, and of the rate of the bristle by velocity and itself.
    powers: [[f64; FITTED + 1]; 5],
}

impl Path<'_> {
    /// Carries deviations from the motion, one a column, from the begin to the end of the piece.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn carry(&self, deviations: &mut DMatrix<f64>) -> Result<(), Error> {
        if let Some((row, [before, after])) = &self.jump {
            // A deviation comes to the jump at another time.
            let along_jump: f64 = self.system.reads.row(*row).iter().zip(before).map(|(read, rate)| read * rate).sum();
            let times = self.system.reads.row(*row) * &*deviations / along_jump;
            let jump =
                DVector::from_iterator(before.len(), after.iter().zip(before).map(|(after, before)| after - before));
            *deviations += jump * times;
        }
        let mut parts = 1;
        while parts <= MOST_PARTS {
            let border = |at: usize| at as f64 / parts as f64;
            let all = (0..parts).map(|part| [border(part), border(part + 1)]);
            let carried = all.into_iter().try_fold(deviations.clone(), |now, part| self.carry_over(&now, part));
            if let Some(carried) = carried {
                *deviations = carried;
                return Ok(());
            }
            parts *= 2;
        }
        Err(Error::Motion { time: self.time, reason: "its numbers are not finite" })
    }

    /// Deviations at the end of a part of the piece; `None` where it is too long.
    fn carry_over(&self, deviations: &DMatrix<f64>, [from, to]: [f64; 2]) -> Option<DMatrix<f64>> {
        let (system, below) = (self.system, &self.below);
        let (d, n, contacts) = (system.dimension(), system.order(), system.contacts().len());
        let slopes = self.slopes([from, to])?;
        let size = |of: &DMatrix<f64>| {
            of.column_iter().fold(0.0, |size, column| largest(size, amplitude(column.as_slice(), self.scales)))
        };
        let most = size(deviations);
        let (mut sum, mut term) = (deviations.clone(), deviations.clone());
        // What contacts see of the terms, a reading a column.
        let mut seen: Vec<DMatrix<f64>> = Vec::new();
        for k in 0..MOST_TERMS {
            let mut next = DMatrix::zeros(d, term.ncols());
            next.rows_mut(0, n).copy_from(&term.rows(n, n));
            next.rows_mut(n, d - n).gemm(1.0, below, &term, 0.0);
            if !slopes.is_empty() {
                seen.push((&system.reads * &term).transpose());
                let mut friction = DMatrix::zeros(term.ncols(), contacts);
                let mut rates = DMatrix::zeros(term.ncols(), d - 2 * n);
                for Slopes { contact, powers } in &slopes {
                    let bristle = system.bristle(*contact).map(|place| place - 2 * n);
                    for (power, of_term) in (0..=FITTED).zip(seen.iter().rev()) {
                        let [gap, slip] = [*contact, contacts + contact].map(|reading| of_term.column(reading));
                        let mut to = friction.column_mut(*contact);
                        to.axpy(powers[0][power], &gap, 1.0);
                        to.axpy(powers[1][power], &slip, 1.0);
                        let Some(bristle) = bristle else { continue };
                        let state = of_term.column(2 * contacts + bristle);
                        to.axpy(powers[2][power], &state, 1.0);
                        let mut to = rates.column_mut(bristle);
                        to.axpy(powers[3][power], &slip, 1.0);
                        to.axpy(powers[4][power], &state, 1.0);
                    }
                }
                next.rows_mut(n, n).gemm(1.0, &system.sliding, &friction.transpose(), 1.0);
                let mut of_bristles = next.rows_mut(2 * n, d - 2 * n);
                of_bristles += rates.transpose();
            }
            for mut column in next.column_iter_mut() {
                self.hold(&mut column.as_mut_slice()[n..2 * n], |_, _| ());
            }
            next *= (to - from) * self.duration() / (k + 1) as f64;
            sum += &next;
            let before = std::mem::replace(&mut term, next);
            if k % LOOKED_AT != 0 {
                continue;
            }
            let last = largest(size(&before), size(&term));
            if last.is_nan() || last > CANCELLING * most {
                return None;
            }
            if last <= LAST_TERMS * most && (slopes.is_empty() || k > FITTED) {
                return Some(sum);
            }
        }
        None
    }

    /// Changes of the slopes of contacts from those at the begin of the piece, over a part of it, of contacts that have some; `None` where the part is too
    /// long for a fit.
    fn slopes(&self, [from, to]: [f64; 2]) -> Option<Vec<Slopes>> {
        let system = self.system;
        if self.is_linear() {
            return Some(Vec::new());
        }
        let mut x = vec![0.0; system.dimension()];
        let mut found: Vec<Vec<[f64; 5]>> = vec![Vec::with_capacity(FITTED + 1); system.contacts().len()];
        for at in 0..=FITTED {
            let moment = if at == 0 { 0.0 } else { moment(2 * at - 1) };
            self.at_part(from + (to - from) * moment, &mut x);
            for (contact, changes) in found.iter_mut().enumerate() {
                let (now, begin) =
                    (system.forces_in_phase(contact, &x, self.phase(contact)).slopes(), self.forces[contact].slopes());
                // What differs by rounding alone does not.
                let change = |slope: usize| {
                    let (now, begin) = (now[slope], begin[slope]);
                    if (now - begin).abs() <= 1e-13 * now.abs().max(begin.abs()) { 0.0 } else { now - begin }
                };
                changes.push(std::array::from_fn(change));
            }
        }
        let fitted = |(contact, changes): (usize, Vec<[f64; 5]>)| {
            let powers: [[f64; FITTED + 1]; 5] = std::array::from_fn(|slope| {
                let first = changes[0][slope];
                let others = fit(&std::array::from_fn(|at| changes[at + 1][slope] - first));
                std::array::from_fn(|power| if power == 0 { first } else { others[power - 1] })
            });
            Slopes { contact, powers }
        };
        let changed =
            found.into_iter().enumerate().filter(|(_, changes)| changes.iter().flatten().any(|change| *change != 0.0));
        let slopes: Vec<Slopes> = changed.map(fitted).collect();
        let duration = (to - from) * self.duration();
        slopes.iter().all(|slopes| duration * self.rate_of_error(slopes) <= FIT).then_some(slopes)
    }

    /// Change of a deviation of one scale in the time 1 s, in scales, by the last power of fitted slopes.
    fn rate_of_error(&self, Slopes { contact, powers }: &Slopes) -> f64 {
        let (system, contacts) = (self.system, self.system.contacts().len());
        let seen = |row: usize| -> f64 {
            system.reads.row(row).iter().zip(self.scales).map(|(read, scale)| (read * scale).abs()).sum()
        };
        let [gap, slip] = [*contact, contacts + contact].map(seen);
        let state = system.bristle(*contact).map_or(0.0, |place| self.scales[place]);
        let last = |slope: usize| powers[slope][FITTED].abs() / LEADING;
        let [friction, rate] = [*contact, contacts + contact].map(|row| self.weights[row]);
        friction * (last(0) * gap + last(1) * slip + last(2) * state) + rate * (last(3) * slip + last(4) * state)
    }
}
