//! Every onset, a Hopf point: the mu at which an eigenvalue crosses the imaginary axis, whichever way.
//!
//! The support is halved until in each step every branch that could reach the axis either keeps its distance or crosses
//! it once. What a branch does between two spectra is judged by its tangents: on an arc of parabola Re lambda leaves the
//! chord by |s_b - s_a| h / 8, and four times this is allowed for. All spectra then have to agree with the onsets
//! found.

use super::branches::SMALLEST_STEP;
use super::{EstimatorError, OneParameterFamily};

/// Steps that the support is divided into before any halving; chosen.
const FIRST_STEPS: usize = 16;
/// A branch is watched if it could reach the axis moving this many times faster than it does at either end; chosen.
const RATE_MARGIN: f64 = 2.0;
/// Most steps of the root search; chosen.
const MOST_STEPS: usize = 60;

/// Where an eigenvalue crosses the imaginary axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Onset {
    /// The coefficient.
    pub mu: f64,
    /// Bound of its error.
    pub error: f64,
    /// Im lambda, rad/s.
    pub omega: f64,
    /// Whether the mode becomes unstable with growing mu.
    pub destabilises: bool,
}

/// What was found on an interval of mu.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Onsets {
    /// Ascending.
    pub onsets: Vec<Onset>,
    /// Steps at the smallest length in which a branch touches the axis so closely that it was not decided.
    pub unresolved: Vec<(f64, f64)>,
}

/// A watched branch over a step: its mode at both ends.
type Watched = (usize, usize);

enum Step {
    Quiet,
    Once(Vec<Watched>),
    Unclear,
}

impl OneParameterFamily<'_> {
    /// Every onset between two coefficients.
    ///
    /// # Errors
    /// Those of [`OneParameterFamily::lambdas`]; [`EstimatorError::Unresolved`], [`EstimatorError::Inconsistent`].
    pub fn onsets(&mut self, from: f64, to: f64) -> Result<Onsets, EstimatorError> {
        let mut found = Onsets::default();
        let at = |i: usize| from + (to - from) * i as f64 / FIRST_STEPS as f64;
        for i in 0..FIRST_STEPS {
            self.search(at(i), at(i + 1), &mut found)?;
        }
        found.onsets.sort_by(|a, b| a.mu.total_cmp(&b.mu));
        self.check(from, to, &found)?;
        Ok(found)
    }

    fn search(&mut self, a: f64, b: f64, found: &mut Onsets) -> Result<(), EstimatorError> {
        match self.judge(a, b)? {
            Step::Quiet => Ok(()),
            Step::Once(branches) => {
                for (f, j) in branches {
                    found.onsets.push(self.root((a, f), (b, j))?);
                }
                Ok(())
            }
            Step::Unclear if b - a <= SMALLEST_STEP => {
                found.unresolved.push((a, b));
                Ok(())
            }
            Step::Unclear => {
                let middle = 0.5 * (a + b);
                self.search(a, middle, found)?;
                self.search(middle, b, found)
            }
        }
    }

    fn judge(&mut self, a: f64, b: f64) -> Result<Step, EstimatorError> {
        let h = b - a;
        let mut crossing = Vec::new();
        let (here, there) = (self.watched(a, h)?, self.watched(b, h)?);
        let mut linked = Vec::with_capacity(here.len());
        for f in here {
            let link = self.link(a, f, b)?;
            if !link.is_clear {
                return Ok(Step::Unclear);
            }
            linked.push((f, link.to));
        }
        for j in there {
            if !linked.iter().any(|&(_, to)| to == j) {
                let link = self.link(b, j, a)?;
                if !link.is_clear {
                    return Ok(Step::Unclear);
                }
                linked.push((link.to, j));
            }
        }
        for (f, j) in linked {
            let ((start, s), (end, t)) = (self.point(a, f)?, self.point(b, j)?);
            let chord = (end.re - start.re) / h;
            if start.re * end.re < 0.0 {
                let is_straight = |slope: f64| (slope - chord).abs() < 0.5 * chord.abs();
                if !(is_straight(s.re) && is_straight(t.re)) {
                    return Ok(Step::Unclear);
                }
                crossing.push((f, j));
            } else if start.re.abs().min(end.re.abs()) <= 0.5 * (t.re - s.re).abs() * h {
                return Ok(Step::Unclear);
            }
        }
        Ok(if crossing.is_empty() { Step::Quiet } else { Step::Once(crossing) })
    }

    /// Modes at `mu` that could reach the axis within a step of length `h`, or are past it.
    fn watched(&mut self, mu: f64, h: f64) -> Result<Vec<usize>, EstimatorError> {
        let mut watched = Vec::new();
        for i in 0..self.spectrum(mu)?.lambdas.len() {
            let (lambda, slope) = self.point(mu, i)?;
            if lambda.re + RATE_MARGIN * slope.norm() * h >= 0.0 {
                watched.push(i);
            }
        }
        Ok(watched)
    }

    /// The one onset of a branch between two ends, by Newton's method kept within the bracket.
    fn root(&mut self, (a, f): (f64, usize), (b, j): (f64, usize)) -> Result<Onset, EstimatorError> {
        let ((first, slope), (last, _)) = (self.point(a, f)?, self.point(b, j)?);
        let destabilises = first.re < 0.0;
        let (mut low, mut high) = (a, b);
        let (mut mu, mut guess) = (a, first);
        let mut rate = slope;
        let mut left = f64::INFINITY;
        // The chord's root to begin with.
        let start = a + (b - a) * first.re / (first.re - last.re);
        guess += rate * (start - mu);
        mu = mu.max(start);
        for _ in 0..MOST_STEPS {
            let spectrum = self.spectrum(mu)?;
            let nearest = |x: &&num_complex::Complex<f64>, y: &&num_complex::Complex<f64>| {
                (*x - guess).norm().total_cmp(&(*y - guess).norm())
            };
            let Some(&lambda) = spectrum.lambdas.iter().min_by(nearest) else { break };
            let at = self.derivative(mu, lambda)?;
            rate = at.slope;
            if (at.lambda.re < 0.0) == destabilises {
                low = mu;
            } else {
                high = mu;
            }
            let step = -at.lambda.re / rate.re;
            let error = at.bound / rate.re.abs();
            left = step.abs();
            if left <= error.max(2.0 * f64::EPSILON * mu) {
                return Ok(Onset { mu, error: error + left, omega: at.lambda.im, destabilises });
            }
            let next = if mu + step > low && mu + step < high { mu + step } else { 0.5 * (low + high) };
            guess = at.lambda + rate * (next - mu);
            mu = next;
        }
        Err(EstimatorError::NoConvergence { what: "an onset", left, steps: MOST_STEPS })
    }

    /// Every spectrum computed has as many unstable modes as the onsets below it leave.
    fn check(&mut self, from: f64, to: f64, found: &Onsets) -> Result<(), EstimatorError> {
        let unstable = |lambdas: &[num_complex::Complex<f64>]| lambdas.iter().filter(|l| l.re > 0.0).count();
        let start = unstable(&self.spectrum(from)?.lambdas) as i64;
        let is_open = |mu: f64| {
            found.unresolved.iter().any(|&(a, b)| (a..=b).contains(&mu))
                || found.onsets.iter().any(|c| (mu - c.mu).abs() <= c.error + SMALLEST_STEP)
        };
        for mu in self.between(from, to) {
            let change = |c: &Onset| if c.destabilises { 1 } else { -1 };
            let expected = start + found.onsets.iter().filter(|c| c.mu < mu).map(change).sum::<i64>();
            let found = unstable(&self.spectrum(mu)?.lambdas);
            if found as i64 != expected && !is_open(mu) {
                return Err(EstimatorError::Inconsistent { mu, found, expected });
            }
        }
        Ok(())
    }
}
