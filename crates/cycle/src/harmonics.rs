//! Harmonics of a cycle: its Fourier series in time, and how strong each of them is.

use num_complex::Complex;

use crate::Cycle;

/// Steps of a period for each harmonic, at least; chosen: what is folded back into the last one comes from three times its frequency.
const STEPS_OF_HARMONIC: usize = 4;

/// Part of the mean square of the velocity that the harmonics leave out, at most; chosen, above the error of an integrated motion.
const LEFT_OUT: f64 = 1e-8;

/// The Fourier series of a cycle, `u(t) = u_0 + Re sum_k u_k exp(i k omega t)`, from its start on.
#[derive(Debug, Clone, PartialEq)]
pub struct Harmonics {
    /// Angular frequency of the cycle, rad/s.
    pub omega: f64,
    /// Mean displacement of each degree of freedom from steady sliding, `u_0`, m.
    pub mean: Vec<f64>,
    /// Amplitude of the velocity of each degree of freedom, `i k omega u_k`, m/s; by harmonic, from the first on.
    pub velocity: Vec<Vec<Complex<f64>>>,
}

impl Harmonics {
    /// Frequency of a harmonic, Hz; that of harmonic 1 is the cycle's.
    #[must_use]
    pub fn frequency_hz(&self, harmonic: usize) -> f64 {
        harmonic as f64 * self.omega / std::f64::consts::TAU
    }

    /// Root mean square of the velocity of the given degrees of freedom together in a harmonic, 1 for the first, m/s.
    #[must_use]
    pub fn rms_of(&self, harmonic: usize, dofs: &[usize]) -> f64 {
        let velocity = &self.velocity[harmonic - 1];
        // The sum of none is -0.
        (0.0 + dofs.iter().map(|&dof| 0.5 * velocity[dof].norm_sqr()).sum::<f64>()).sqrt()
    }

    /// Amplitude of the displacement of each degree of freedom in a harmonic, `u_k`, m; in harmonic 0 the mean.
    #[must_use]
    pub fn displacement(&self, harmonic: usize) -> Vec<Complex<f64>> {
        match harmonic.checked_sub(1) {
            None => self.mean.iter().map(|&mean| mean.into()).collect(),
            Some(at) => {
                let rate = Complex::new(0.0, harmonic as f64 * self.omega);
                self.velocity[at].iter().map(|velocity| velocity / rate).collect()
            }
        }
    }
}

/// Harmonics of a cycle of `order` degrees of freedom, from its states at equal steps of the period: as many as hold all but 1e-8 of the mean square of the
/// velocities of the given degrees of freedom, `rms` squared, or a quarter of the steps.
#[must_use]
pub fn harmonics(cycle: &Cycle, order: usize, states: &[Vec<f64>], (dofs, rms): (&[usize], f64)) -> Harmonics {
    let (n, steps) = (order, states.len());
    let mean_of = |dof: usize| states.iter().map(|x| x[dof]).sum::<f64>() / steps as f64;
    let mut found = Harmonics {
        omega: std::f64::consts::TAU / cycle.period,
        mean: (0..n).map(mean_of).collect(),
        velocity: vec![],
    };
    let mut held = 0.0;
    while STEPS_OF_HARMONIC * found.velocity.len() < steps && held < (1.0 - LEFT_OUT) * rms * rms {
        let harmonic = found.velocity.len() + 1;
        let mut velocity = vec![Complex::default(); n];
        for (step, x) in states.iter().enumerate() {
            // The turn of whole periods is none: no angle grows.
            let angle = std::f64::consts::TAU * ((harmonic * step) % steps) as f64 / steps as f64;
            let turn = Complex::cis(-angle) * (2.0 / steps as f64);
            velocity.iter_mut().zip(&x[n..2 * n]).for_each(|(sum, v)| *sum += turn * v);
        }
        found.velocity.push(velocity);
        held += found.rms_of(harmonic, dofs).powi(2);
    }
    found
}
