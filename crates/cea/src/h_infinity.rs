//! A bound of the H-infinity norm of a stable system, certified up to rounding: the size of a change below which no eigenvalue
//! can cross the imaginary axis (docs/error-bounds.md, section 12).

use certified::francis;
use linsys::SecondOrder;
use nalgebra::DMatrix;
use num_complex::Complex;

use crate::dense::{MOST_QR_STEPS, MassRoot};

use crate::{CeaError, StandardForm, Workspace};

/// The ratio of the next bound tried to the largest gain found so far; chosen: a larger ratio needs fewer attempts, and makes the
/// bound less tight by as much.
const ABOVE_SEEN: f64 = 1.01;
/// Safety factor on the bound that passed, for rounding errors in the gains and in the eigenvalues of the Hamiltonian matrix;
/// chosen: these errors are known to be of first order in epsilon, their constant is not.
const ROUNDING_RESERVE: f64 = 1.01;
/// An eigenvalue no farther from the axis than this fraction of the matrix norm counts as on the axis: the square root of epsilon, sqrt(2.2e-16) = 1.5e-8,
/// by which a rounding error moves a double eigenvalue.
const ON_AXIS: f64 = 1.5e-8;
/// Most bounds tried; chosen: the search converges quadratically and takes two or three.
const MOST_BOUNDS: usize = 12;

/// The channels of a change Delta, any complex m x p matrix, of a system:
/// `Q(lambda) = Q_0(lambda) + force Delta (position + lambda velocity)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Channels {
    /// Directions of the forces that the change applies, n x m.
    pub force: DMatrix<f64>,
    /// The displacements that the change depends on, p x n.
    pub position: DMatrix<f64>,
    /// The velocities that the change depends on, p x n.
    pub velocity: DMatrix<f64>,
}

impl Channels {
    fn fit(&self, order: usize) -> bool {
        let readings = self.position.nrows();
        self.force.nrows() == order
            && self.position.shape() == (readings, order)
            && self.velocity.shape() == (readings, order)
    }
}

/// A bound of an H-infinity norm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormBound {
    /// Bound g of the norm.
    pub bound: f64,
    /// Margins: how far from the axis eigenvalues were while the bound was sought.
    pub margins: AxisMargins,
}

/// Margins: distances of the eigenvalues of Hamiltonian matrices from the imaginary axis, as fractions of the norms of the matrices. One nearer
/// than 1.5e-8, the allowance for rounding, counts as on it: the gap between the two numbers shows what that is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisMargins {
    /// Number of matrices.
    pub matrices: u64,
    /// The farthest of the eigenvalues that count as on the axis; 0 without any.
    pub on_axis: f64,
    /// The nearest of the others; infinite without any.
    pub off_axis: f64,
}

impl Default for AxisMargins {
    fn default() -> Self {
        Self { matrices: 0, on_axis: 0.0, off_axis: f64::INFINITY }
    }
}

impl AxisMargins {
    fn of(eigenvalues: &[Complex<f64>], norm: f64) -> Self {
        let parts = eigenvalues.iter().map(|lambda| lambda.re.abs() / norm);
        Self {
            matrices: 1,
            on_axis: parts.clone().filter(|part| *part <= ON_AXIS).fold(0.0, f64::max),
            off_axis: parts.filter(|part| *part > ON_AXIS).fold(f64::INFINITY, f64::min),
        }
    }

    /// The margins of these matrices and of the matrices of `other` together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            matrices: self.matrices + other.matrices,
            on_axis: self.on_axis.max(other.on_axis),
            off_axis: self.off_axis.min(other.off_axis),
        }
    }
}

/// Reason why [`h_infinity_norm_bound`] gives no bound.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoNormBound {
    /// The system itself may be unstable: an eigenvalue lies nearer to the axis than a rounding error may move it, or right of it.
    #[error("the system itself is not surely stable: its rightmost eigenvalue has Re lambda = {rightmost:e} 1/s")]
    NotSurelyStable {
        /// The largest real part, rad/s.
        rightmost: f64,
    },
    /// The gain is zero at every eigenfrequency: the readings do not respond to the forces.
    #[error("the channels have no gain at any eigenfrequency")]
    NoGain,
    /// The gain overflows, or Q is singular to rounding on the axis.
    #[error("the gain is not finite next to an eigenfrequency")]
    GainNotFinite,
    /// The QR iteration on the state matrix or on the Hamiltonian did not converge.
    #[error("the QR iteration did not converge")]
    NoConvergence,
    /// The gain exceeds every bound tried.
    #[error("none of {tried} bounds was found to be above the gain")]
    BoundsExhausted {
        /// Number of bounds tried.
        tried: usize,
    },
}

/// A bound g of the H-infinity norm of the channels, the largest gain over all frequencies; or the reason why there is no bound.
/// While `|Delta| < 1 / g` in the 2-norm, also where Delta is a function of lambda, no eigenvalue has `Re lambda >= 0`. The bound
/// is certified up to rounding errors, for which it has a reserve of one per cent.
///
/// With `T(lambda) = (position + lambda velocity) Q_0(lambda)^-1 force`, `det Q = det Q_0 det(I + Delta T)`, which does
/// not vanish where `|Delta| |T| < 1` (small gain: Zames, IEEE Trans. Autom. Control 11, 1966). T has no pole in
/// `Re lambda >= 0` and vanishes at infinity, so |T| is largest on the axis. |T| stays below g on the axis if and only if the
/// Hamiltonian matrix of the standard form, `[A, B B^T / g; -C^T C / g, -A^T]`, has no eigenvalue on the axis (Boyd,
/// Balakrishnan, Kabamba, Math. Control Signals Systems 2, 1989). Where the matrix has eigenvalues there, |T| in the middle
/// between neighbouring ones gives the next bound to try (Bruinsma, Steinbuch, Systems & Control Letters 14, 1990). The bound g
/// is about 2 per cent above the largest |T| at most.
///
/// # Errors
/// [`CeaError::MassNotPositiveDefinite`], and [`CeaError::Channels`] for internal states in the system or channels of another
/// order.
pub fn h_infinity_norm_bound(
    system: &SecondOrder,
    channels: &Channels,
    work: &mut Workspace,
) -> Result<Result<NormBound, NoNormBound>, CeaError> {
    if system.states() > 0 || !channels.fit(system.order()) {
        return Err(CeaError::Channels { order: system.order(), states: system.states() });
    }
    let StandardForm { state, gamma, .. } = StandardForm::new(system)?;
    let near = ON_AXIS * state.norm();
    work.counters.eigenvalue_solves += 1;
    let Some(poles) = francis::eigenvalues(state.clone(), MOST_QR_STEPS) else {
        return Ok(Err(NoNormBound::NoConvergence));
    };
    // Written so that a NaN is refused too.
    if !poles.iter().all(|pole| pole.re < -near) {
        let rightmost = poles.iter().map(|pole| pole.re * gamma).fold(f64::NEG_INFINITY, f64::max);
        return Ok(Err(NoNormBound::NotSurelyStable { rightmost }));
    }
    let gain = |sigma: f64, work: &mut Workspace| gain_at(system, channels, sigma * gamma, work);

    // A lightly damped system has its peaks next to its eigenfrequencies.
    let mut seen = gain(0.0, work);
    for pole in poles.iter().filter(|pole| pole.im > 0.0) {
        seen = seen.max(gain(pole.im, work));
    }
    let hamiltonian = Hamiltonian::new(&state, gamma, &MassRoot::new(&system.m)?, channels)?;
    let mut margins = AxisMargins::default();
    for _ in 0..MOST_BOUNDS {
        if !(seen > 0.0 && seen.is_finite()) {
            return Ok(Err(if seen == 0.0 { NoNormBound::NoGain } else { NoNormBound::GainNotFinite }));
        }
        let bound = ABOVE_SEEN * seen;
        let matrix = hamiltonian.at(bound);
        let norm = matrix.norm();
        work.counters.eigenvalue_solves += 1;
        let Some(found) = francis::eigenvalues(matrix, MOST_QR_STEPS) else {
            return Ok(Err(NoNormBound::NoConvergence));
        };
        margins = margins.and(AxisMargins::of(&found, norm));
        let mut crossings: Vec<f64> =
            found.iter().filter(|l| l.re.abs() <= ON_AXIS * norm && l.im >= 0.0).map(|l| l.im).collect();
        if crossings.is_empty() {
            return Ok(Ok(NormBound { bound: ROUNDING_RESERVE * bound, margins }));
        }
        crossings.sort_unstable_by(f64::total_cmp);
        // Crossings that rounding has merged have no middle to look at; `bound` makes the next bound higher in any case.
        seen = crossings.windows(2).map(|pair| gain(0.5 * (pair[0] + pair[1]), work)).fold(bound, f64::max);
    }
    Ok(Err(NoNormBound::BoundsExhausted { tried: MOST_BOUNDS }))
}

/// `|T(i omega)|` in the 2-norm; infinite where Q is singular.
fn gain_at(system: &SecondOrder, channels: &Channels, omega: f64, work: &mut Workspace) -> f64 {
    let lambda = Complex::new(0.0, omega);
    work.counters.factorisations += 1;
    let Some(response) = system.dynamic_stiffness(lambda).lu().solve(&channels.force.map(Complex::from)) else {
        return f64::INFINITY;
    };
    let reading = channels.position.zip_map(&channels.velocity, |p, v| p + lambda * v);
    let transfer = reading * response;
    let square = transfer.adjoint() * &transfer;
    square.symmetric_eigenvalues().max().max(0.0).sqrt()
}

/// The blocks of the Hamiltonian matrix at g = 1: A, B B^T and C^T C.
struct Hamiltonian<'a> {
    state: &'a DMatrix<f64>,
    into: DMatrix<f64>,
    out_of: DMatrix<f64>,
}

impl<'a> Hamiltonian<'a> {
    /// Transforms the channels to the standard form, whose states are y and `y' / gamma`, with time in units of 1 / gamma.
    fn new(state: &'a DMatrix<f64>, gamma: f64, root: &MassRoot, channels: &Channels) -> Result<Self, CeaError> {
        let n = state.nrows() / 2;
        let force = root.force(&channels.force)? / (gamma * gamma);
        let mut reading = root.reading(&channels.position)?.resize_horizontally(2 * n, 0.0);
        reading.columns_mut(n, n).copy_from(&(root.reading(&channels.velocity)? * gamma));
        let mut into = DMatrix::zeros(2 * n, 2 * n);
        into.view_mut((n, n), (n, n)).copy_from(&(&force * force.transpose()));
        Ok(Self { state, into, out_of: reading.transpose() * reading })
    }

    fn at(&self, bound: f64) -> DMatrix<f64> {
        let order = self.state.nrows();
        // The similarity diag(I, w I) gives the two off-diagonal blocks the same norm.
        let weight = (self.out_of.norm() / self.into.norm()).sqrt();
        DMatrix::from_fn(2 * order, 2 * order, |i, j| match (i < order, j < order) {
            (true, true) => self.state[(i, j)],
            (true, false) => self.into[(i, j - order)] * (weight / bound),
            (false, true) => -self.out_of[(i - order, j)] / (weight * bound),
            (false, false) => -self.state[(j - order, i - order)],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EigenSolver, QrSolver};
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    fn bound(system: &SecondOrder, channels: &Channels) -> Result<f64, NoNormBound> {
        h_infinity_norm_bound(system, channels, &mut Workspace::default()).unwrap().map(|found| found.bound)
    }

    #[test]
    fn an_oscillator_has_its_textbook_resonance() {
        // 1 / (k - m w^2 + i c w) peaks at 1 / (c sqrt(k / m - (c / 2 m)^2)); i w / (..) at 1 / c.
        let (m, k): (f64, f64) = (0.39, 2.45e7);
        for c in [0.02, 18.1, 181.0, 3000.0_f64] {
            let system = SecondOrder::new(dmatrix![m], dmatrix![c], dmatrix![k]).unwrap();
            let damped = (k / m - (c / (2.0 * m)).powi(2)).sqrt();
            for (position, velocity, peak) in [(1.0, 0.0, 1.0 / (c * damped)), (0.0, 1.0, 1.0 / c)] {
                let channels =
                    Channels { force: dmatrix![1.0], position: dmatrix![position], velocity: dmatrix![velocity] };
                let ratio = bound(&system, &channels).unwrap() / peak;
                assert!((1.0..1.03).contains(&ratio), "c = {c}: {ratio}");
            }
        }
    }

    #[test]
    fn what_is_not_surely_stable_has_no_bound() {
        let channels = Channels { force: dmatrix![1.0], position: dmatrix![1.0], velocity: dmatrix![0.0] };
        for (c, k) in [(0.0, 1.0), (-0.1, 1.0), (1e-12, 1.0), (1.0, 0.0), (1.0, -1.0)] {
            let system = SecondOrder::new(dmatrix![1.0], dmatrix![c], dmatrix![k]).unwrap();
            let refused = bound(&system, &channels);
            assert!(matches!(refused, Err(NoNormBound::NotSurelyStable { .. })), "c = {c}, k = {k}: {refused:?}");
        }
        let damped = SecondOrder::new(dmatrix![1.0], dmatrix![1.0], dmatrix![1.0]).unwrap();
        let blind = Channels { position: dmatrix![0.0], ..channels };
        assert_eq!(bound(&damped, &blind), Err(NoNormBound::NoGain));
    }

    #[test]
    fn channels_must_fit() {
        let system = SecondOrder::new(dmatrix![1.0], dmatrix![1.0], dmatrix![1.0]).unwrap();
        let channels = Channels { force: dmatrix![1.0], position: dmatrix![1.0, 1.0], velocity: dmatrix![0.0] };
        let refused = h_infinity_norm_bound(&system, &channels, &mut Workspace::default());
        assert_eq!(refused, Err(CeaError::Channels { order: 1, states: 0 }));
    }

    /// A chain of four with different masses, springs and dashpots.
    fn chain(masses: &[f64], springs: &[f64], damping: f64) -> SecondOrder {
        let k = DMatrix::from_fn(4, 4, |i, j| match i.abs_diff(j) {
            0 => springs[i] + springs[i + 1],
            1 => -springs[i.max(j)],
            _ => 0.0,
        });
        let m = DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(masses));
        SecondOrder::new(m, damping * &k, k).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn nothing_within_the_bound_is_unstable_and_something_beyond_it_is(
            masses in prop::collection::vec(0.5..2.0, 4),
            springs in prop::collection::vec(0.5..2.0, 5),
            damping in 0.001..0.1,
            force in prop::collection::vec(-1.0..1.0, 8),
            readings in prop::collection::vec(-1.0..1.0, 16),
            changes in prop::collection::vec(-1.0..1.0, 40),
        ) {
            let system = chain(&masses, &springs, damping);
            let channels = Channels {
                force: DMatrix::from_vec(4, 2, force),
                position: DMatrix::from_column_slice(2, 4, &readings[..8]),
                velocity: DMatrix::from_column_slice(2, 4, &readings[8..]),
            };
            let gain = bound(&system, &channels).unwrap();
            let most = |c: DMatrix<f64>, k: DMatrix<f64>| {
                let changed = SecondOrder::new(system.m.clone(), c, k).unwrap();
                let spectrum = QrSolver.eigenvalues(&changed, &mut Workspace::default()).unwrap();
                spectrum.eigenvalues.iter().map(|l| l.re).fold(f64::NEG_INFINITY, f64::max)
            };
            for change in changes.chunks(4) {
                let delta = DMatrix::from_column_slice(2, 2, change);
                let delta = &delta * (0.999 / (gain * delta.singular_values().max()));
                let into = &channels.force * delta;
                let re = most(&system.c + &into * &channels.velocity, &system.k + &into * &channels.position);
                prop_assert!(re < 0.0, "{re:e}");
            }
            // The bound is within three per cent of the largest gain on the axis.
            let mut work = Workspace::default();
            let grid = (0..20_000).map(|i| 3.0 * f64::from(i) / 2e4);
            // A lightly damped resonance is narrower than the grid and gets a finer one.
            let poles = QrSolver.eigenvalues(&system, &mut work).unwrap().eigenvalues;
            let fine = poles.iter().flat_map(|pole| (-60..=60).map(|i| pole.im + 0.05 * f64::from(i) * pole.re));
            let peak = grid.chain(fine).map(|omega| gain_at(&system, &channels, omega, &mut work)).fold(0.0, f64::max);
            prop_assert!(peak < gain && gain < 1.03 * peak, "{gain} {peak}");
        }
    }

    #[test]
    fn a_full_mass_matrix_gives_the_bound_of_its_diagonal_twin() {
        let (sin, cos) = 0.7_f64.sin_cos();
        let turn = dmatrix![cos, -sin; sin, cos];
        let (m, c, k) = (dmatrix![2.0, 0.0; 0.0, 5.0], dmatrix![0.3, 0.1; 0.0, 0.2], dmatrix![40.0, -9.0; 3.0, 70.0]);
        let there = |a: &DMatrix<f64>| &turn * a * turn.transpose();
        let plain = Channels { force: dmatrix![1.0; 0.4], position: dmatrix![0.2, 1.0], velocity: dmatrix![0.1, 0.3] };
        let turned = Channels {
            force: &turn * &plain.force,
            position: &plain.position * turn.transpose(),
            velocity: &plain.velocity * turn.transpose(),
        };
        let a = bound(&SecondOrder::new(m.clone(), c.clone(), k.clone()).unwrap(), &plain).unwrap();
        let b = bound(&SecondOrder::new(there(&m), there(&c), there(&k)).unwrap(), &turned).unwrap();
        assert!((a - b).abs() < 1e-9 * a, "{a} {b}");
    }
}
