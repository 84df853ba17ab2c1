//! Friction along a motion that is a power series of time: its coefficient is a series too, which follows from that of the motion term by term.
//!
//! A. Jorba, M. Zou, A software package for the numerical integration of ODEs by means of high-order Taylor methods, Experiment. Math. 14 (2005)
//! 99-117, proposition 2.1.

/// Terms of the friction of a law, one after the other, by those of a motion that does not turn.
pub trait FrictionSeries {
    /// Begins another motion, which slides forwards, or backwards.
    fn begin(&mut self, is_forwards: bool);

    /// The next term of the coefficient mu, which has the sign of the sliding velocity, and of the rate of the state, by the terms of the sliding velocity and of
    /// the state of the same power of time. Of a law without a state the rate is 0.
    fn next(&mut self, velocity: f64, state: f64) -> [f64; 2];
}

/// The last term of the product of two series with the same number of terms.
#[must_use]
pub fn product_term(a: &[f64], b: &[f64]) -> f64 {
    // Four sums beside each other, which registers of any width add up to the same bits.
    let (fours, first) = (a.chunks_exact(4), b.len() % 4);
    let rest: f64 = fours.remainder().iter().zip(b[..first].iter().rev()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; 4];
    for (a, b) in fours.zip(b.rchunks_exact(4)) {
        (0..4).for_each(|at| sums[at] += a[at] * b[3 - at]);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// The exponent of a curve over the speed v: `-alpha v`, or `-(v / v_s)^2`.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Exponent {
    /// alpha, s/m.
    Linear(f64),
    /// v_s, m/s.
    Square(f64),
}

/// Terms of `level + height e^exponent + viscous v` over a speed v that is a series.
#[derive(Debug, Clone)]
pub(crate) struct CurveSeries {
    level: f64,
    height: f64,
    exponent: Exponent,
    viscous: f64,
    sign: f64,
    /// Terms of the speed.
    pub(crate) speed: Vec<f64>,
    /// Terms of the derivative of the exponent by time.
    slope: Vec<f64>,
    /// Terms of the exponential.
    pub(crate) exponential: Vec<f64>,
}

impl CurveSeries {
    pub fn new([level, height, viscous]: [f64; 3], exponent: Exponent) -> Self {
        let none = Vec::new;
        Self { level, height, exponent, viscous, sign: 1.0, speed: none(), slope: none(), exponential: none() }
    }

    /// The next term of `level + height e^exponent`, by that of the sliding velocity.
    pub fn falling(&mut self, velocity: f64) -> f64 {
        let k = self.speed.len();
        self.speed.push(self.sign * velocity);
        let exponent = match self.exponent {
            Exponent::Linear(alpha) => -alpha * self.speed[k],
            Exponent::Square(v_s) => -product_term(&self.speed, &self.speed) / (v_s * v_s),
        };
        if k == 0 {
            self.exponential.push(exponent.exp());
        } else {
            // y' = exponent' y.
            self.slope.push(k as f64 * exponent);
            self.exponential.push(product_term(&self.slope, &self.exponential) / k as f64);
        }
        let level = if k == 0 { self.level } else { 0.0 };
        level + self.height * self.exponential[k]
    }
}

impl FrictionSeries for CurveSeries {
    fn begin(&mut self, is_forwards: bool) {
        self.sign = if is_forwards { 1.0 } else { -1.0 };
        [&mut self.speed, &mut self.slope, &mut self.exponential].into_iter().for_each(Vec::clear);
    }

    fn next(&mut self, velocity: f64, _: f64) -> [f64; 2] {
        [self.sign * self.falling(velocity) + self.viscous * velocity, 0.0]
    }
}
