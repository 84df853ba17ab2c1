//! Forces of each family in a mode, and their work.

use std::f64::consts::PI;

use linsys::{SecondOrder, real_times_complex};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::WorkError;

/// A group of forces whose work is computed separately: friction, dashpots, gyroscopic forces.
#[derive(Debug, Clone, Copy)]
pub struct ForceFamily<'a> {
    /// Name of the family in results and errors.
    pub name: &'a str,
    /// C, K and internal states of the forces, with the signs of `M u'' + C u' + K u = F z`; M is not read.
    ///
    /// Forces that do no net work in any mode, such as forces of an elastic, symmetric K, should be left out: their work on
    /// single bodies only moves energy between the bodies.
    pub system: &'a SecondOrder,
}

/// The forces of one family in a mode.
#[derive(Debug, Clone, PartialEq)]
pub struct FamilyForces<'a> {
    /// Name of the family in results and errors.
    pub name: &'a str,
    /// f, N per unit of phi, one for each degree of freedom.
    pub forces: DVector<Complex<f64>>,
}

/// Work of one family in one mode.
#[derive(Debug, Clone, PartialEq)]
pub struct FamilyWork {
    /// Name of the family.
    pub name: String,
    /// Work of the family on each body.
    pub bodies: Vec<f64>,
}

/// Work per cycle in one mode, per `phi^H M phi`: J/(kg m^2) = 1/s^2. Positive work feeds the mode.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeWork {
    /// Work of each family, in the order given.
    pub families: Vec<FamilyWork>,
    /// Net work of all families over all degrees of freedom, also over degrees of freedom that belong to no body.
    pub total: f64,
    /// `2 pi Re(lambda) Im(lambda)`, the value of `total` where all forces left out are elastic with a symmetric K.
    pub expected_total: f64,
    /// Sum of the magnitudes of the work over families and degrees of freedom, which rounding errors are relative to.
    pub magnitude: f64,
}

impl ModeWork {
    /// Net work of all families on each body.
    #[must_use]
    pub fn net(&self) -> Vec<f64> {
        let mut families = self.families.iter();
        let mut net = families.next().map(|first| first.bodies.clone()).unwrap_or_default();
        for family in families {
            for (sum, work) in net.iter_mut().zip(&family.bodies) {
                *sum += work;
            }
        }
        net
    }

    /// `|total - expected_total|` over the larger of [`ModeWork::magnitude`] and `|expected_total|`.
    ///
    /// The residual is at rounding level where (lambda, phi) is an eigenpair and the elastic forces are symmetric, and 0 where no force
    /// does work.
    #[must_use]
    pub fn identity_residual(&self) -> f64 {
        let scale = self.magnitude.max(self.expected_total.abs());
        if scale == 0.0 { 0.0 } else { (self.total - self.expected_total).abs() / scale }
    }
}

/// Work of each family of forces in the mode (lambda, phi), summed over the degrees of freedom of each body.
///
/// `mass` is M of the system that has the mode, n x n, which normalises the work. The system's C, K and internal states
/// are the sum of the C, K and internal states of all `families` and of an elastic K that is left out. `phi` has the n mechanical components of
/// the mode. Each entry of `bodies` lists the degrees of freedom of one body, from 0.
///
/// ```
/// use linsys::SecondOrder;
/// use nalgebra::{dmatrix, dvector};
/// use num_complex::Complex;
/// use work::{ForceFamily, family_work};
///
/// // 2 kg on a spring of 50 N/m, with a dashpot of 3 Ns/m and friction whose slope acts as -7 Ns/m.
/// let of_dashpot = |c: f64| SecondOrder::new(dmatrix![0.0], dmatrix![c], dmatrix![0.0]);
/// let (friction, dashpot) = (of_dashpot(-7.0)?, of_dashpot(3.0)?);
/// let families = [ForceFamily { name: "friction", system: &friction }, ForceFamily { name: "dashpots", system: &dashpot }];
///
/// let lambda = Complex::new(1.0, 24_f64.sqrt()); // 2 lambda^2 - 4 lambda + 50 = 0
/// let work = family_work(&dmatrix![2.0], &families, lambda, &dvector![Complex::new(0.0, 0.1)], &[vec![0]])?;
/// assert!(work.families[0].bodies[0] > 0.0 && work.families[1].bodies[0] < 0.0);
/// assert!((work.net()[0] - work.expected_total).abs() < 1e-12 * work.expected_total);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// No family, sizes that do not fit, a degree of freedom of a body that does not exist, a modal mass that is not positive, or an eigenvalue equal to minus
/// a decay rate.
pub fn family_work(
    mass: &DMatrix<f64>,
    families: &[ForceFamily<'_>],
    lambda: Complex<f64>,
    phi: &DVector<Complex<f64>>,
    bodies: &[impl AsRef<[usize]>],
) -> Result<ModeWork, WorkError> {
    check(mass, families, phi)?;
    let forces =
        families.iter().map(|family| Ok(FamilyForces { name: family.name, forces: force(family, lambda, phi)? }));
    work_of_forces(mass, &forces.collect::<Result<Vec<_>, WorkError>>()?, lambda, phi, bodies)
}

/// Net work as by [`family_work`], from the forces f of each family in the mode, one for each degree of freedom, where these are known
/// without matrices.
///
/// ```
/// use nalgebra::{dmatrix, dvector};
/// use num_complex::Complex;
/// use work::{FamilyForces, work_of_forces};
///
/// // The example of `family_work`: the force of a dashpot of c is -lambda c phi.
/// let (lambda, phi) = (Complex::new(1.0, 24_f64.sqrt()), dvector![Complex::new(0.0, 0.1)]);
/// let of_dashpot = |name, c: f64| FamilyForces { name, forces: &phi * (-lambda * c) };
/// let forces = [of_dashpot("friction", -7.0), of_dashpot("dashpots", 3.0)];
/// let work = work_of_forces(&dmatrix![2.0], &forces, lambda, &phi, &[vec![0]])?;
/// assert!((work.net()[0] - work.expected_total).abs() < 1e-12 * work.expected_total);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// No family, sizes that do not fit, a degree of freedom of a body that does not exist, a modal mass that is not positive, or a force that is not finite.
pub fn work_of_forces(
    mass: &DMatrix<f64>,
    families: &[FamilyForces<'_>],
    lambda: Complex<f64>,
    phi: &DVector<Complex<f64>>,
    bodies: &[impl AsRef<[usize]>],
) -> Result<ModeWork, WorkError> {
    check_mode(mass, phi)?;
    if families.is_empty() {
        return Err(WorkError::NoFamily);
    }
    let modal_mass = phi.dotc(&real_times_complex(mass, phi)).re;
    if !(modal_mass > 0.0 && modal_mass.is_finite()) {
        return Err(WorkError::ModalMass { value: modal_mass });
    }

    let mut found = ModeWork {
        families: Vec::with_capacity(families.len()),
        total: 0.0,
        expected_total: 2.0 * PI * lambda.re * lambda.im,
        magnitude: 0.0,
    };
    for FamilyForces { name, forces } in families {
        if forces.len() != phi.len() {
            let (found, expected) = (forces.len(), phi.len());
            return Err(WorkError::FamilyOrder { family: name.to_string(), found, expected });
        }
        let on_each_dof: Vec<f64> = phi.iter().zip(forces).map(|(u, f)| PI * (u.conj() * f).im / modal_mass).collect();
        if on_each_dof.iter().any(|work| !work.is_finite()) {
            return Err(WorkError::Forces { family: name.to_string(), lambda });
        }
        for work in &on_each_dof {
            found.total += work;
            found.magnitude += work.abs();
        }
        let of_bodies = bodies.iter().enumerate().map(|(body, dofs)| sum_over(&on_each_dof, body, dofs.as_ref()));
        found.families.push(FamilyWork { name: name.to_string(), bodies: of_bodies.collect::<Result<_, _>>()? });
    }
    Ok(found)
}

/// Checks that a shape fits its mass matrix.
fn check_mode(mass: &DMatrix<f64>, phi: &DVector<Complex<f64>>) -> Result<(), WorkError> {
    let (rows, columns) = mass.shape();
    if rows != columns {
        return Err(WorkError::MassShape { rows, columns });
    }
    if phi.len() != rows {
        return Err(WorkError::ShapeOrder { found: phi.len(), expected: rows });
    }
    Ok(())
}

/// Checks that the matrices of all families fit the mode.
fn check(mass: &DMatrix<f64>, families: &[ForceFamily<'_>], phi: &DVector<Complex<f64>>) -> Result<(), WorkError> {
    check_mode(mass, phi)?;
    for ForceFamily { name, system } in families {
        let family = || name.to_string();
        system.check().map_err(|source| WorkError::Family { family: family(), source })?;
        let (found, expected) = (system.order(), phi.len());
        if found != expected {
            return Err(WorkError::FamilyOrder { family: family(), found, expected });
        }
    }
    Ok(())
}

/// `-(lambda C + K) phi + F z`, `z = lambda E phi / (lambda + a)`.
fn force(
    ForceFamily { name, system }: &ForceFamily<'_>,
    lambda: Complex<f64>,
    phi: &DVector<Complex<f64>>,
) -> Result<DVector<Complex<f64>>, WorkError> {
    let mut force = real_times_complex(&system.c, phi) * -lambda - real_times_complex(&system.k, phi);
    let mut states = real_times_complex(&system.internal.drive, phi);
    for (state, (z, decay)) in states.iter_mut().zip(&system.internal.decay).enumerate() {
        let shifted = lambda + decay;
        if shifted.norm() == 0.0 {
            return Err(WorkError::InternalPole { family: name.to_string(), lambda, state });
        }
        *z *= lambda / shifted;
    }
    force += real_times_complex(&system.internal.force, &states);
    Ok(force)
}

fn sum_over(work: &[f64], body: usize, dofs: &[usize]) -> Result<f64, WorkError> {
    dofs.iter().map(|&dof| work.get(dof).ok_or(WorkError::UnknownDof { body, dof, order: work.len() })).sum()
}
