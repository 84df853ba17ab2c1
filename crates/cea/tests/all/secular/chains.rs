//! Chains with feedback, and their modes by QR.

use cea::{Anchors, EigenSolver, Feedback, Gain, Growing, LeftOpen, QrSolver, Secular, Spectrum, Workspace};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Anchors of a structure.
pub const ANCHORS: usize = 16;

/// A structure with feedback.
#[derive(Debug, Clone)]
pub struct Brake {
    pub structure: SecondOrder,
    pub feedback: Feedback,
}

/// A chain between two walls, masses and springs near 1, with dashpots and damping in proportion to the mass.
pub fn brake(damping: impl Strategy<Value = f64>, dashpots: f64) -> impl Strategy<Value = Brake> {
    let parts = |n: usize, ports: usize| {
        let links = || prop::collection::vec(0.5..2.0, n + 1);
        (links(), links(), links(), prop::collection::vec(-1.0..1.0, 2 * n * ports), Just((n, ports)))
    };
    let sizes = (4..9usize, 1..4usize).prop_flat_map(move |(n, ports)| parts(n, ports));
    (sizes, damping).prop_map(move |((masses, springs, links, feedback, (n, ports)), damping)| {
        let tridiagonal = |link: &[f64]| {
            DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => link[i] + link[i + 1],
                1 => -link[i.max(j)],
                _ => 0.0,
            })
        };
        let m = DMatrix::from_diagonal(&DVector::from_column_slice(&masses[..n]));
        let c = damping * &m + dashpots * tridiagonal(&links);
        let (force, reading) = feedback.split_at(n * ports);
        let feedback = Feedback {
            force: DMatrix::from_column_slice(n, ports, force),
            reading: DMatrix::from_column_slice(ports, n, reading),
        };
        Brake { structure: SecondOrder::new(m, c, tridiagonal(&springs)).unwrap(), feedback }
    })
}

impl Brake {
    /// The system with feedback.
    pub fn whole(&self, gain: &Gain) -> SecondOrder {
        let (Feedback { force, reading }, mut system) = (&self.feedback, self.structure.clone());
        system.k += gain.mu * force * reading;
        system.c += gain.slope * force * force.transpose();
        if gain.lag != 0.0 {
            let decay = DVector::from_element(force.ncols(), gain.decay);
            system.internal = Internal { decay, drive: -gain.lag * force.transpose(), force: force.clone() };
        }
        system
    }

    fn spectrum(&self, gain: &Gain) -> Spectrum {
        QrSolver.eigenvalues(&self.whole(gain), &mut Workspace::default()).unwrap()
    }

    /// The modes by QR, ascending in frequency, without the pairs into which rounding splits equal internal eigenvalues.
    pub fn modes(&self, gain: &Gain) -> Vec<Complex<f64>> {
        self.spectrum(gain).oscillatory().filter(|l| l.im > 1e-2 * l.norm()).collect()
    }

    pub fn growth(&self, gain: &Gain) -> f64 {
        self.spectrum(gain).eigenvalues.iter().map(|l| l.re).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The smallest proportional gain up to 10, of either sign, at which an eigenvalue has a real part above `growth`.
    pub fn critical(&self, growth: f64) -> Option<f64> {
        let at = |mu: f64| Gain { mu, ..Gain::default() };
        let grows = |mu: f64| self.growth(&at(mu)) > growth;
        let upper = (1..1000).map(|i| 0.01 * f64::from(i)).flat_map(|p| [p, -p]).find(|&p| grows(p))?;
        Some(bisect(upper - 0.01 * upper.signum(), upper, grows))
    }

    pub fn secular(&self) -> Secular {
        Secular::new(&self.structure, &self.feedback, &mut Workspace::default()).unwrap().unwrap()
    }

    pub fn anchors(&self, secular: &Secular, gains: &[Gain]) -> Anchors {
        let states: Vec<_> = gains.iter().map(|gain| (*gain, self.spectrum(gain))).collect();
        secular.anchors(&states, &mut Workspace::default())
    }
}

/// The growing modes with each gain, without frequencies to keep apart from.
pub fn growing(secular: &Secular, anchors: &Anchors, gains: &[Gain]) -> Vec<Result<Growing, LeftOpen>> {
    let gains: Vec<(Gain, &[f64])> = gains.iter().map(|&gain| (gain, &[][..])).collect();
    secular.growing(anchors, &gains, &mut Workspace::default())
}

/// The number nearest to `lower` at which a condition holds, by bisection to rounding.
pub fn bisect(mut lower: f64, mut upper: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (lower + upper);
        *(if holds(middle) { &mut upper } else { &mut lower }) = middle;
    }
    upper
}

/// Gains about the first instability of a structure, each from three numbers for mu, slope and decay.
pub fn gains(brake: &Brake, critical: f64, units: &[[f64; 3]], has_lag: bool) -> Vec<Gain> {
    let size = brake.feedback.force.norm_squared();
    let gain = |&[mu, slope, decay]: &[f64; 3]| {
        let (slope, decay) = (0.02 * slope / size, 3.0 * 10f64.powf(decay));
        let gain = Gain { mu: critical * (1.0 + 0.5 * mu), ..Gain::default() };
        if has_lag { Gain { lag: slope * decay, decay, ..gain } } else { Gain { slope, ..gain } }
    };
    units.iter().map(gain).collect()
}

/// A runner with a fixed seed.
pub fn runner(cases: u32) -> TestRunner {
    let config = Config { failure_persistence: None, ..Config::with_cases(cases) };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}
