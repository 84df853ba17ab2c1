//! Friction condensed onto its contacts: the growing modes of a structure with friction, without its spectrum.
//!
//! Friction acts on a structure through m *ports*, the friction channels of `linsys`, all with the same gain. It changes the dynamic stiffness
//! `Q_0(lambda) = lambda^2 M + lambda C + K` of the structure by a matrix of rank m at most:
//!
//! ```text
//! Q(lambda) = Q_0(lambda) + B (p R + lambda v(lambda) B^T),   p = mu,  v(lambda) = slope + lag / (lambda + decay)
//! ```
//!
//! with the matrices B and R of a [`Feedback`] and the numbers of a [`Gain`]. The eigenvalues of the structure with friction are the zeros of the
//! determinant of an m x m matrix, the secular equation
//!
//! ```text
//! det(I + p G(lambda) + lambda v(lambda) H(lambda)) = 0,   G = R Q_0^-1 B,  H = B^T Q_0^-1 B
//! ```
//!
//! (Golub, SIAM Review 15, 1973, for m = 1; the matrix determinant lemma for any m). One evaluation of it costs a small part of a
//! spectrum. Eigenvalues are guessed from the spectra of *anchors*, gains whose spectra are known, and corrected one by one. From the
//! corrections follow bounds of the errors of all guesses at once, by Smith's theorem (`enclosure.rs`). Damped modes stay guesses, each in a disc
//! that lies left of the imaginary axis and does not reach the frequency of any growing mode; only the growing modes are found to the last digits.

mod anchors;
mod enclosure;
mod gain;
mod gain_path;
mod reasons;
mod resolvent;
mod response;
mod search;
#[cfg(test)]
mod tests;

use linsys::{Internal, SecondOrder};
use nalgebra::DVector;
use num_complex::Complex;

use crate::{CeaError, Spectrum, Workspace};
pub use anchors::Anchors;
use enclosure::Wanted;
pub use gain::Gain;
pub use gain_path::{GainPath, NewtonStep};
pub use reasons::{LeftOpen, NoSecular};
pub use resolvent::Feedback;
use resolvent::Resolvent;

/// Largest ratio of the squared number of ports to the number of degrees of freedom for which the secular equation is used;
/// measured: with 30 degrees of freedom, thirteen ports (extrapolated from nine) cost as much as a spectrum.
const MOST_SQUARED_PORTS: usize = 6;
/// The point i in units of [`Resolvent::unit`], the geometric mean of |lambda| over the modes of the structure: v(lambda) of two gains is compared
/// there, to find the nearest anchor.
const MIDDLE_FREQUENCY: Complex<f64> = Complex::new(0.0, 1.0);

/// The secular equation of a structure with feedback, ready for many gains.
///
/// ```
/// use cea::{EigenSolver, Feedback, Gain, QrSolver, Secular, Workspace};
/// use linsys::SecondOrder;
/// use nalgebra::{DMatrix, dmatrix};
///
/// // Two masses on springs. The force on the first falls with the displacement of the second, as friction does.
/// let (m, c) = (DMatrix::identity(2, 2), dmatrix![0.02, 0.0; 0.0, 0.03]);
/// let structure = SecondOrder::new(m, c, dmatrix![10.0, 0.6; 0.6, 12.0])?;
/// let feedback = Feedback { force: dmatrix![1.0; 0.0], reading: dmatrix![0.0, -1.0] };
/// let gain = |mu| Gain { mu, ..Gain::default() };
///
/// let mut work = Workspace::default();
/// let secular = Secular::new(&structure, &feedback, &mut work)??;
/// let mut anchors = Vec::new();
/// for p in [0.0, 1.0, 2.0, 3.0] {
///     let mut system = structure.clone();
///     system.k[(0, 1)] -= p;
///     anchors.push((gain(p), QrSolver.eigenvalues(&system, &mut work)?));
/// }
/// let anchors = secular.anchors(&anchors, &mut work);
/// let found = secular.growing(&anchors, &[(gain(1.5), &[]), (gain(3.5), &[])], &mut work);
/// let growing = found.iter().flatten().map(|found| found.frequencies().count());
/// assert_eq!(growing.collect::<Vec<_>>(), [0, 1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Secular {
    structure: SecondOrder,
    feedback: Feedback,
    resolvent: Resolvent,
}

/// All modes of one system: the growing modes to rounding accuracy, the damped modes with error bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct Growing {
    /// Eigenvalues, one with Im > 0 per mode, ascending in frequency, rad/s: exact to rounding for a growing mode, a guess for a
    /// damped mode. The number of modes with a lower frequency than a growing mode is certain.
    pub modes: Vec<Complex<f64>>,
    /// Error bound of each eigenvalue, rad/s; 0 for growing modes and for modes that the feedback does not move, which err by rounding only.
    pub radii: Vec<f64>,
}

impl Growing {
    /// Frequencies of the growing modes, rad/s.
    pub fn frequencies(&self) -> impl Iterator<Item = f64> + '_ {
        self.modes.iter().filter(|mode| mode.re > 0.0).map(|mode| mode.im)
    }

    /// True if the error bounds leave open which modes lie below one of these frequencies, rad/s.
    #[must_use]
    pub fn leaves_order_open(&self, frequencies: &[f64]) -> bool {
        let mut bounds = self.modes.iter().zip(&self.radii);
        bounds.any(|(mode, radius)| frequencies.iter().any(|im| (mode.im - im).abs() < *radius))
    }
}

impl Secular {
    /// The secular equation of a structure with feedback, or the reason to compute spectra instead: too many ports, or a response that is not
    /// a sum over oscillating modes.
    ///
    /// # Errors
    /// Errors of the eigenvalues and vectors of the structure; [`CeaError::Channels`] for a feedback of another order than the structure.
    pub fn new(
        structure: &SecondOrder,
        feedback: &Feedback,
        work: &mut Workspace,
    ) -> Result<Result<Self, NoSecular>, CeaError> {
        let (ports, order) = (feedback.force.ncols(), structure.order());
        if ports.pow(2) > MOST_SQUARED_PORTS * order {
            return Ok(Err(NoSecular::ManyPorts { ports, order, most: (MOST_SQUARED_PORTS * order).isqrt() + 1 }));
        }
        let resolvent = Resolvent::new(structure, feedback, work)?;
        Ok(resolvent.map(|resolvent| Self { structure: structure.clone(), feedback: feedback.clone(), resolvent }))
    }

    /// The structure without feedback.
    #[must_use]
    pub fn structure(&self) -> &SecondOrder {
        &self.structure
    }

    /// Distance from the imaginary axis, rad/s, up to which rounding leaves open whether an eigenvalue grows: [`Secular::growing`] gives
    /// [`LeftOpen::NearAxis`] where an eigenvalue is no farther away. A caller that asks on which side of another line an eigenvalue lies, a threshold of
    /// the growth say, keeps the same distance from that line.
    #[must_use]
    pub fn least_distance(&self) -> f64 {
        search::LEAST_AXIS_DISTANCE * self.resolvent.unit
    }

    /// The structure with feedback of the given gain.
    #[must_use]
    pub fn system(&self, gain: &Gain) -> SecondOrder {
        let (mut system, Feedback { force, reading }) = (self.structure.clone(), &self.feedback);
        system.k += gain.mu * force * reading;
        system.c += gain.slope * force * force.transpose();
        if gain.lag != 0.0 {
            // `z' = -a z + E u'` with F z on the right-hand side: with E = -lag B^T and F = B, Q gains lambda lag / (lambda + a) B B^T.
            let decay = DVector::from_element(force.ncols(), gain.decay);
            system.internal = Internal { decay, drive: -gain.lag * force.transpose(), force: force.clone() };
        }
        system
    }

    /// Anchors from gains whose spectra are `known`. A gain with overdamped modes is left out; where all gains are left out, [`Secular::growing`] answers
    /// [`LeftOpen::NoAnchor`] for every gain.
    pub fn anchors(&self, known: &[(Gain, Spectrum)], work: &mut Workspace) -> Anchors {
        Anchors::new(&self.resolvent, known, work)
    }

    /// The modes with each of the gains, as [`Growing`] says; or the reason to compute a spectrum instead. With each gain come frequencies, rad/s:
    /// the answer is such that none of them lies within the error bound of a damped mode, so that it is certain which modes lie below them.
    ///
    /// The result for one gain does not depend on the other gains, to the last bit.
    pub fn growing(
        &self,
        anchors: &Anchors,
        gains: &[(Gain, &[f64])],
        work: &mut Workspace,
    ) -> Vec<Result<Growing, LeftOpen>> {
        let found = search::search(&self.resolvent, anchors, Wanted::Growing, gains, work);
        work.counters.secular_answers += found.iter().flatten().count() as u64;
        found
    }

    /// Eigenvalues, rad/s, with Im > 0 and a damping ratio `-Re lambda / |lambda|` below `damping_ratio`, with each of the gains; or the reason to compute
    /// a spectrum instead.
    pub fn near_axis(
        &self,
        anchors: &Anchors,
        gains: &[Gain],
        damping_ratio: f64,
        work: &mut Workspace,
    ) -> Vec<Result<Vec<Complex<f64>>, LeftOpen>> {
        let wanted = Wanted::Near(damping_ratio);
        let gains: Vec<(Gain, &[f64])> = gains.iter().map(|&gain| (gain, &[][..])).collect();
        let found = search::search(&self.resolvent, anchors, wanted, &gains, work).into_iter();
        let is_near = |lambda: &Complex<f64>| lambda.re > -damping_ratio * lambda.norm();
        found.map(|found| Ok(found?.modes.into_iter().filter(is_near).collect())).collect()
    }
}
