//! Forces of each family in a mode, and their work.

use std::f64::consts::PI;

use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::WorkError;

/// Work per cycle in one mode, per `phi^H M phi`: J/(kg m^2) = 1/s^2. Positive work feeds the mode.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeWork {
    /// Work of friction on each body.
    pub friction: Vec<f64>,
    /// Work of the dashpots on each body.
    pub damping: Vec<f64>,
    /// Net work over all degrees of freedom, whether they belong to a body or not.
    pub total: f64,
    /// `2 pi Re(lambda) Im(lambda)`, what `total` is where the elastic forces are symmetric.
    pub expected_total: f64,
    /// Sum of the magnitudes of all work, over families and degrees of freedom: what rounding errors are relative to.
    pub magnitude: f64,
}

impl ModeWork {
    /// Net work, friction and damping together, on each body.
    pub fn net(&self) -> Vec<f64> {
        self.friction.iter().zip(&self.damping).map(|(friction, damping)| friction + damping).collect()
    }

    /// `|total - expected_total|` over the larger of [`ModeWork::magnitude`] and `|expected_total|`.
    ///
    /// At rounding level where (lambda, phi) is an eigenpair and the elastic forces are symmetric; 0 where nothing
    /// does any work.
    pub fn identity_residual(&self) -> f64 {
        let scale = self.magnitude.max(self.expected_total.abs());
        if scale == 0.0 { 0.0 } else { (self.total - self.expected_total).abs() / scale }
    }
}

/// Work of friction and of damping in the mode (lambda, phi), summed over the degrees of freedom of each body.
///
/// `structure` is the system without friction: its M normalises, its C holds the dashpots. `friction` is the friction
/// part alone: C, K and internal states, its M not read. The system that has the mode is the sum of the two; `phi` has
/// its n mechanical components. Each entry of `bodies` lists the degrees of freedom of one body, from 0.
///
/// ```
/// use linsys::SecondOrder;
/// use nalgebra::{dmatrix, dvector};
/// use num_complex::Complex;
///
/// // 2 kg on a spring; a dashpot of 3 Ns/m against friction whose slope is worth -7 Ns/m.
/// let structure = SecondOrder::new(dmatrix![2.0], dmatrix![3.0], dmatrix![50.0])?;
/// let friction = SecondOrder::new(dmatrix![0.0], dmatrix![-7.0], dmatrix![0.0])?;
/// let lambda = Complex::new(1.0, 24_f64.sqrt()); // 2 lambda^2 - 4 lambda + 50 = 0
/// let work = work::mode_work(&structure, &friction, lambda, &dvector![Complex::new(0.0, 0.1)], &[vec![0]])?;
/// assert!(work.friction[0] > 0.0 && work.damping[0] < 0.0);
/// assert!((work.net()[0] - work.expected_total).abs() < 1e-12 * work.expected_total);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Sizes that do not fit, a modal mass that is not positive, or an eigenvalue equal to minus a decay rate.
pub fn mode_work(
    structure: &SecondOrder,
    friction: &SecondOrder,
    lambda: Complex<f64>,
    phi: &DVector<Complex<f64>>,
    bodies: &[impl AsRef<[usize]>],
) -> Result<ModeWork, WorkError> {
    let order = structure.order();
    for (part, found) in [("mode shape", phi.len()), ("friction part", friction.order())] {
        if found != order {
            return Err(WorkError::Order { part, found, expected: order });
        }
    }
    let modal_mass = phi.dotc(&times(&structure.m, phi)).re;
    if !(modal_mass > 0.0 && modal_mass.is_finite()) {
        return Err(WorkError::ModalMass { value: modal_mass });
    }

    let on_each_dof = |force: DVector<Complex<f64>>| -> Vec<f64> {
        phi.iter().zip(&force).map(|(u, f)| PI * (u.conj() * f).im / modal_mass).collect()
    };
    let by_friction = on_each_dof(friction_force(friction, lambda, phi)?);
    let by_damping = on_each_dof(times(&structure.c, phi) * -lambda);
    let of_bodies = |work: &[f64]| -> Result<Vec<f64>, WorkError> {
        bodies.iter().enumerate().map(|(body, dofs)| sum_over(work, body, dofs.as_ref())).collect()
    };
    let both = || by_friction.iter().chain(&by_damping);
    Ok(ModeWork {
        friction: of_bodies(&by_friction)?,
        damping: of_bodies(&by_damping)?,
        total: both().sum(),
        expected_total: 2.0 * PI * lambda.re * lambda.im,
        magnitude: both().map(|work| work.abs()).sum(),
    })
}

/// `-(lambda C + K) phi + F z`, `z = lambda E phi / (lambda + a)`.
fn friction_force(
    friction: &SecondOrder,
    lambda: Complex<f64>,
    phi: &DVector<Complex<f64>>,
) -> Result<DVector<Complex<f64>>, WorkError> {
    let mut force = times(&friction.c, phi) * -lambda - times(&friction.k, phi);
    let mut states = times(&friction.internal.drive, phi);
    for (state, (z, decay)) in states.iter_mut().zip(&friction.internal.decay).enumerate() {
        let shifted = lambda + decay;
        if shifted.norm() == 0.0 {
            return Err(WorkError::InternalPole { lambda, state });
        }
        *z *= lambda / shifted;
    }
    force += times(&friction.internal.force, &states);
    Ok(force)
}

fn sum_over(work: &[f64], body: usize, dofs: &[usize]) -> Result<f64, WorkError> {
    dofs.iter().map(|&dof| work.get(dof).ok_or(WorkError::UnknownDof { body, dof, order: work.len() })).sum()
}

/// A real matrix times a complex vector.
fn times(a: &DMatrix<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    let mut product = DVector::zeros(a.nrows());
    for (column, &value) in a.column_iter().zip(x) {
        for (slot, &entry) in product.iter_mut().zip(column.iter()) {
            *slot += value * entry;
        }
    }
    product
}
