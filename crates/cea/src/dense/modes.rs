//! Modes among the eigenvalues, and the two ways of numbering them by frequency.

use std::iter::repeat_n;

use certified::CertifiedError;
use linsys::{SecondOrder, real_times_complex};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::{CeaError, Spectrum, StandardForm, Workspace, rank_order, real_count, right_vector};

/// Largest distance of a real eigenvalue that is attributed to an internal state without its vector from minus the decay rate of that state, as a fraction of
/// the rate; chosen, for systems that have as many real eigenvalues as states.
const LARGEST_SHIFT_OF_DECAY: f64 = 0.5;
/// Largest |Im lambda| / |lambda| of a multiple real eigenvalue that rounding has split into complex ones. Chosen: rounding
/// splits a defective pair by 1.5e-8 and a triple by 6e-6, and an oscillating mode with a smaller ratio has a damping ratio
/// within 5e-9 of critical.
const LARGEST_SPREAD_OF_REAL: f64 = 1e-4;

/// A spectrum sorted into modes of the structure and internal states.
///
/// The eigenvalues of internal states are neither numbered nor counted. They are recognised by their eigenvectors, because the
/// eigenvalues of an overdamped mode are real too.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// Oscillating modes: the eigenvalue with Im lambda > 0 of each pair, ascending in frequency as [`rank_order`] has it, rad/s.
    pub oscillatory: Vec<Complex<f64>>,
    /// Real eigenvalues of the structure, ascending: overdamped modes (two each), or divergence where positive. Two that rounding has made
    /// a pair, as [`real_count`] says, are among them.
    pub real: Vec<f64>,
    /// Eigenvalues of internal states; one or both of a complex pair.
    pub internal: Vec<Complex<f64>>,
}

impl Modes {
    /// Sorts the spectrum of `system`.
    ///
    /// Eigenvectors are computed only where the real eigenvalues are not as many as the internal states and near their decay
    /// rates, and then of eigenvalues with |Im lambda| <= |Re lambda|.
    ///
    /// # Errors
    /// Those of [`right_vector`].
    pub fn classify(system: &SecondOrder, spectrum: &Spectrum, work: &mut Workspace) -> Result<Self, CeaError> {
        let mut modes = Self::sorted(system, spectrum, work)?;
        modes.oscillatory = rank_order(&modes.oscillatory).into_iter().map(|at| modes.oscillatory[at]).collect();
        modes.real.sort_by(f64::total_cmp);
        Ok(modes)
    }

    /// [`Modes::classify`], with the oscillating modes in the order of the spectrum.
    fn sorted(system: &SecondOrder, spectrum: &Spectrum, work: &mut Workspace) -> Result<Self, CeaError> {
        let mut modes = Self { oscillatory: Vec::new(), real: Vec::new(), internal: Vec::new() };
        let one_of_each = || spectrum.eigenvalues.iter().copied().filter(|l| l.im >= 0.0);
        if system.states() == 0 {
            one_of_each().for_each(|lambda| modes.enter(lambda));
            return Ok(modes);
        }
        // Equal internal states make a multiple real eigenvalue, which rounding may split into complex pairs.
        let (near_real, far): (Vec<_>, Vec<_>) =
            spectrum.eigenvalues.iter().partition(|l| l.im.abs() <= LARGEST_SPREAD_OF_REAL * l.norm());
        if near_real.len() == system.states() && all_near_decay(&near_real, system) {
            let oscillatory = far.into_iter().filter(|l| l.im > 0.0).collect();
            return Ok(Self { oscillatory, real: Vec::new(), internal: near_real });
        }
        let form = StandardForm::new(system)?;
        for lambda in one_of_each() {
            match !is_oscillation(lambda) && is_internal(system, &form, lambda, work)? {
                true => modes.internal.push(lambda),
                false => modes.enter(lambda),
            }
        }
        Ok(modes)
    }

    /// Enters an eigenvalue of the structure with Im lambda >= 0; two real ones that rounding has made a pair are real.
    fn enter(&mut self, lambda: Complex<f64>) {
        match real_count(lambda) {
            0 => self.oscillatory.push(lambda),
            count => self.real.extend(repeat_n(lambda.re, count)),
        }
    }

    /// Number of modes: oscillating ones, and one for each two real eigenvalues.
    #[must_use]
    pub fn count(&self) -> usize {
        self.oscillatory.len() + self.overdamped()
    }

    /// Number of overdamped modes; each has two real eigenvalues.
    #[must_use]
    pub fn overdamped(&self) -> usize {
        self.real.len() / 2
    }

    /// Frequency rank of `oscillatory[index]`, from 1. An overdamped mode keeps its place, at zero frequency.
    #[must_use]
    pub fn rank(&self, index: usize) -> usize {
        self.overdamped() + index + 1
    }
}

/// Frequency ranks, from 1, of the oscillating modes of uncoupled systems in the system that they make up together: for each of the systems the ranks of
/// its modes, in its order. The rank is [`Modes::rank`] of the system together, by [`rank_order`]. Of equal eigenvalues the modes of the system with fewer
/// modes rank first, else the modes of the first system, so that not the last bit decides.
#[must_use]
pub fn ranks_together(systems: &[&Modes]) -> Vec<Vec<usize>> {
    let overdamped = systems.iter().map(|modes| modes.real.len()).sum::<usize>() / 2;
    let mut ranks: Vec<Vec<usize>> = systems.iter().map(|modes| vec![0; modes.oscillatory.len()]).collect();
    let places = |(system, modes): (usize, &&Modes)| (0..modes.oscillatory.len()).map(move |index| (system, index));
    let mut by_size: Vec<usize> = (0..systems.len()).collect();
    by_size.sort_by_key(|&system| systems[system].oscillatory.len());
    let all: Vec<(usize, usize)> = by_size.into_iter().flat_map(|system| places((system, &systems[system]))).collect();
    let lambdas: Vec<Complex<f64>> = all.iter().map(|&(system, index)| systems[system].oscillatory[index]).collect();
    for (place, at) in rank_order(&lambdas).into_iter().enumerate() {
        let (system, index) = all[at];
        ranks[system][index] = overdamped + place + 1;
    }
    ranks
}

/// The two numbers of a mode among all 2 n eigenvalues ordered by |Im lambda|: 2 r - 1 and 2 r for rank r.
///
/// "Mode 29" of a system with 30 degrees of freedom may be rank 29 or, in this numbering, rank 15.
#[must_use]
pub fn pair_numbers(rank: usize) -> (usize, usize) {
    (2 * rank - 1, 2 * rank)
}

fn all_near_decay(near_real: &[Complex<f64>], system: &SecondOrder) -> bool {
    let mut decay: Vec<f64> = system.internal.decay.iter().map(|a| -a).collect();
    decay.sort_by(f64::total_cmp);
    let mut real: Vec<f64> = near_real.iter().map(|l| l.re).collect();
    real.sort_by(f64::total_cmp);
    real.iter().zip(&decay).all(|(l, a)| (l - a).abs() <= LARGEST_SHIFT_OF_DECAY * a.abs())
}

/// True if the motion goes through several periods before it has decayed or grown by much: a mode, whatever its vector, because a
/// growing oscillation must not be passed over as the motion of an internal state.
fn is_oscillation(lambda: Complex<f64>) -> bool {
    lambda.im.abs() > lambda.re.abs()
}

/// True if the internal states make up more than half of the squared norm of the scaled state vector.
fn is_internal(
    system: &SecondOrder,
    form: &StandardForm,
    lambda: Complex<f64>,
    work: &mut Workspace,
) -> Result<bool, CeaError> {
    let decay = &system.internal.decay;
    let phi = match right_vector(system, lambda, work) {
        Ok(phi) => phi,
        // A state that is not coupled to the structure has no structural vector, and its eigenvalue is -a exactly.
        Err(CeaError::Certified(CertifiedError::NoEigenvector { .. }))
            if decay.iter().any(|a| (lambda + a).norm() <= 1e-6 * a) =>
        {
            return Ok(true);
        }
        Err(error) => return Err(error),
    };
    let drive = real_times_complex(&system.internal.drive, &phi);
    let internal: f64 = (0..system.states())
        .map(|s| (lambda * drive[s] / (lambda + decay[s]) / form.state_weights[s]).norm_sqr())
        .sum();
    let kinetic = mass_norm_squared(&system.m, &phi);
    Ok(internal > kinetic * (1.0 + (lambda / form.gamma).norm_sqr()))
}

/// Square `phi^H M phi` of the mass norm, real for symmetric M.
#[must_use]
pub fn mass_norm_squared(mass: &DMatrix<f64>, phi: &DVector<Complex<f64>>) -> f64 {
    phi.dotc(&real_times_complex(mass, phi)).re
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EigenSolver, QrSolver};
    use linsys::Internal;
    use nalgebra::{dmatrix, dvector};

    fn classify(system: &SecondOrder) -> Modes {
        let mut work = Workspace::default();
        let spectrum = QrSolver.eigenvalues(system, &mut work).unwrap();
        Modes::classify(system, &spectrum, &mut work).unwrap()
    }

    #[test]
    fn an_overdamped_mode_keeps_its_place_in_the_count() {
        let system =
            SecondOrder::new(dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![9.0, 0.0; 0.0, 0.1], dmatrix![4.0, 0.0; 0.0, 1.0])
                .unwrap();
        let modes = classify(&system);
        assert_eq!((modes.oscillatory.len(), modes.real.len(), modes.count()), (1, 2, 2));
        assert_eq!(modes.rank(0), 2);
        assert_eq!(pair_numbers(modes.rank(0)), (3, 4));
    }

    #[test]
    fn uncoupled_systems_rank_as_the_one_that_they_are() {
        let i = |im| Complex::new(-0.1, im);
        let modes = |oscillatory: &[f64], real: &[f64]| Modes {
            oscillatory: oscillatory.iter().map(|&im| i(im)).collect(),
            real: real.to_vec(),
            internal: Vec::new(),
        };
        // Of the three real eigenvalues, each of another system, two count as one overdamped mode.
        let systems = [modes(&[2.0, 5.0], &[-1.0]), modes(&[], &[-3.0]), modes(&[1.0, 2.0, 7.0], &[-4.0])];
        assert_eq!(ranks_together(&systems.each_ref()), [vec![3, 5], vec![], vec![2, 4, 6]]);
        // Nor does it hang on rounding which of two equal frequencies is the lower one.
        for rounding in [-4e-16, 0.0, 4e-16] {
            let nearly = [modes(&[2.0 * (1.0 + rounding), 5.0], &[]), modes(&[1.0, 2.0], &[])];
            assert_eq!(ranks_together(&nearly.each_ref()), [vec![2, 4], vec![1, 3]]);
            let small_last = [modes(&[1.0, 2.0 * (1.0 + rounding)], &[]), modes(&[2.0], &[])];
            assert_eq!(ranks_together(&small_last.each_ref()), [vec![1, 3], vec![2]]);
        }
        let one = modes(&[1.0, 2.0, 2.0, 5.0, 7.0], &[-4.0, -3.0, -1.0]);
        assert_eq!(ranks_together(&[&one])[0], [0, 1, 2, 3, 4].map(|index| one.rank(index)));
    }

    #[test]
    fn a_bristle_is_told_from_an_overdamped_mode_though_both_are_real() {
        // The overdamped mode has -0.47 and -8.53, the internal state about -6, right between them.
        let internal = Internal { decay: dvector![6.0], drive: dmatrix![0.2, 0.1], force: dmatrix![-0.1; 0.05] };
        let system = SecondOrder::with_internal(
            dmatrix![1.0, 0.0; 0.0, 1.0],
            dmatrix![9.0, 0.0; 0.0, 0.1],
            dmatrix![4.0, 0.0; 0.0, 1.0],
            internal,
        )
        .unwrap();
        let modes = classify(&system);
        assert_eq!((modes.oscillatory.len(), modes.real.len(), modes.internal.len()), (1, 2, 1));
        assert!((modes.internal[0].re + 6.0).abs() < 0.1);
    }

    #[test]
    fn a_state_that_is_coupled_to_nothing_is_internal() {
        let internal = Internal { decay: dvector![6.0], drive: dmatrix![0.2], force: dmatrix![0.0] };
        let system = SecondOrder::with_internal(dmatrix![1.0], dmatrix![9.0], dmatrix![4.0], internal).unwrap();
        let modes = classify(&system);
        assert_eq!((modes.count(), modes.internal.len()), (1, 1));
    }
}
