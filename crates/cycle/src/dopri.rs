//! Dormand and Prince's Runge-Kutta method of order 5 with steps that end where a contact opens or closes.
//!
//! J. R. Dormand, P. J. Prince, A family of embedded Runge-Kutta formulae, J. Comp. Appl. Math. 6 (1980) 19-26.

use crate::Error;

const A: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// Differences of the weights of orders 5 and 4.
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Halvings of the step in which a switch lies; more than a step has bits.
const MOST_HALVINGS: usize = 60;

/// Equations x' = f(x), with functions of x that change their sign where f has a kink or something is to be seen.
pub(crate) trait Flow {
    /// x'.
    fn rate(&self, x: &[f64], out: &mut [f64]);

    /// Functions whose changes of sign end a step; the same number of them at each call.
    fn switches(&self, x: &[f64], out: &mut Vec<f64>);

    /// Scale of each of the first entries of x, of which the error is kept small; the others come along.
    fn scales(&self) -> &[f64];

    /// Refuses to go on where work is to end.
    fn go_on(&self) -> Result<(), Error>;
}

/// A motion at a time, and the way on from there.
pub(crate) struct Integrator<'a, F> {
    pub flow: &'a F,
    /// Allowed error of a step, relative to the scales.
    tolerance: f64,
    pub time: f64,
    pub x: Vec<f64>,
    /// f at the stages; the first is that of x.
    stages: [Vec<f64>; 7],
    next: Vec<f64>,
    inner: Vec<f64>,
    step: f64,
    /// Sides of the switches.
    pub sides: Vec<bool>,
    values: Vec<f64>,
    before: Vec<f64>,
}

impl<'a, F: Flow> Integrator<'a, F> {
    /// The motion from a state at time 0.
    pub fn new(flow: &'a F, x: Vec<f64>, tolerance: f64, first_step: f64) -> Self {
        let zero = || vec![0.0; x.len()];
        let mut stages = std::array::from_fn(|_| zero());
        flow.rate(&x, &mut stages[0]);
        let mut values = Vec::new();
        flow.switches(&x, &mut values);
        let sides = values.iter().map(|value| *value > 0.0).collect();
        let (next, inner, before) = (zero(), zero(), values.clone());
        Self { flow, tolerance, time: 0.0, x, stages, next, inner, step: first_step, sides, values, before }
    }

    /// Goes one step, which ends at `until` at the latest or at the first switch. Returns the switch.
    ///
    /// # Errors
    /// Numbers that are not finite, steps that vanish, work that is to end.
    pub fn step(&mut self, until: f64) -> Result<Option<usize>, Error> {
        self.flow.go_on()?;
        let failed = |time, reason| Error::Motion { time, reason };
        loop {
            let rest = until - self.time;
            let is_last = self.step >= rest;
            let step = if is_last { rest } else { self.step };
            if self.time + 1e-3 * step == self.time && !is_last {
                return Err(failed(self.time, "its steps of time vanish"));
            }
            let error = self.attempt(step);
            if !error.is_finite() {
                self.step = 0.1 * step;
                if self.step < 1e-30 {
                    return Err(failed(self.time, "its numbers are not finite"));
                }
                continue;
            }
            let growth = (0.9 * error.max(1e-12).powf(-0.2)).clamp(0.2, 5.0);
            if error > 1.0 {
                self.step = step * growth;
                continue;
            }
            let (taken, switch) = self.first_switch(step);
            if !(is_last && growth > 1.0) {
                self.step = step * growth;
            }
            self.time = if is_last && taken == step { until } else { self.time + taken };
            std::mem::swap(&mut self.x, &mut self.next);
            self.stages.swap(0, 6);
            std::mem::swap(&mut self.before, &mut self.values);
            return Ok(switch);
        }
    }

    /// Tries a step: its end is in `next`, f there in the last stage. Returns its error, allowed up to 1.
    fn attempt(&mut self, step: f64) -> f64 {
        for (stage, weights) in A.iter().enumerate() {
            let target = if stage + 1 == A.len() { &mut self.next } else { &mut self.inner };
            target.copy_from_slice(&self.x);
            for (weight, rates) in weights.iter().zip(&self.stages).filter(|(weight, _)| **weight != 0.0) {
                let weight = step * weight;
                target.iter_mut().zip(rates).for_each(|(x, rate)| *x += weight * rate);
            }
            let (_, out) = self.stages.split_at_mut(stage + 1);
            self.flow.rate(target, &mut out[0]);
        }
        let scales = self.flow.scales();
        let mut sum = 0.0;
        for (at, scale) in scales.iter().enumerate() {
            let error: f64 = ERROR.iter().zip(&self.stages).map(|(weight, rates)| weight * rates[at]).sum();
            let allowed = self.tolerance * scale.max(self.x[at].abs()).max(self.next[at].abs());
            sum += (step * error / allowed).powi(2);
        }
        (sum / scales.len().max(1) as f64).sqrt()
    }

    /// Shortens the step tried last to the first change of a switch in it. Returns its length and the switch.
    fn first_switch(&mut self, step: f64) -> (f64, Option<usize>) {
        self.flow.switches(&self.next, &mut self.values);
        let has_changed = |values: &[f64], sides: &[bool], at: usize| (values[at] > 0.0) != sides[at];
        let changed: Vec<usize> =
            (0..self.sides.len()).filter(|&at| has_changed(&self.values, &self.sides, at)).collect();
        if changed.is_empty() {
            return (step, None);
        }
        // The part of the step before which nothing has changed, and that at whose end something has: regula falsi on the first change,
        // which a halving replaces where it does not close in.
        let (mut low, mut high, mut taken) = (0.0, step, step);
        let (mut at_low, mut at_high) = (self.before.clone(), self.values.clone());
        for halving in 0..MOST_HALVINGS {
            let root = |at: &usize| {
                let (from, to) = (at_low[*at], at_high[*at]);
                if from == to { 0.5 } else { (from / (from - to)).clamp(0.0, 1.0) }
            };
            let first =
                changed.iter().filter(|&&at| has_changed(&at_high, &self.sides, at)).map(root).fold(1.0, f64::min);
            if high - low <= 4.0 * f64::EPSILON * step.max(self.time) {
                break;
            }
            let part = if halving % 3 == 2 { 0.5 } else { first.clamp(1e-9, 1.0 - 1e-9) };
            let mid = low + part * (high - low);
            self.attempt(mid);
            self.flow.switches(&self.next, &mut self.values);
            taken = mid;
            if changed.iter().any(|&at| has_changed(&self.values, &self.sides, at)) {
                (high, at_high) = (mid, self.values.clone());
            } else {
                (low, at_low) = (mid, self.values.clone());
            }
        }
        if taken != high {
            self.attempt(high);
            self.flow.switches(&self.next, &mut self.values);
        }
        let mut ended = None;
        for at in changed {
            if has_changed(&self.values, &self.sides, at) {
                self.sides[at] = !self.sides[at];
                ended = Some(at);
            }
        }
        (high, ended)
    }
}
