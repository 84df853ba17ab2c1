//! Energy of a mode, by parts and bodies of a structure.

use linsys::{SecondOrder, real_times_complex};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::WorkError;

/// A part of a structure whose energy is told apart: a term, a spring, a mass.
#[derive(Debug, Clone, Copy)]
pub struct StructurePart<'a> {
    /// Name of the part in results and errors.
    pub name: &'a str,
    /// System of the part: its M and the symmetric part of its K are read, C and internal states are not.
    pub system: &'a SecondOrder,
}

/// Kinetic and strain energy of a part or a body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Strain energy.
    pub strain: f64,
}

impl std::ops::AddAssign for Energy {
    fn add_assign(&mut self, Self { kinetic, strain }: Self) {
        self.kinetic += kinetic;
        self.strain += strain;
    }
}

/// Mean energy over one period of a mode at frozen amplitude, per `phi^H M phi`: J/(kg m^2) = 1/s^2.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeEnergy {
    /// Energy of all parts: kinetic `|lambda|^2 / 4`, strain `phi^H K phi / (4 phi^H M phi)`.
    pub total: Energy,
    /// Energy of each part, with its name, in the order given; the sum is the total.
    pub parts: Vec<(String, Energy)>,
    /// Energy of each body, `Re(conj(u_j) (A u)_j)` summed over its degrees of freedom: a spring between two bodies is shared by them, as each of its two
    /// forces acts on one of them. The sum is the total where each degree of freedom belongs to one body.
    pub bodies: Vec<Energy>,
}

/// Mean energies of a mode (lambda, phi) of a structure that is the sum of `parts`; `bodies` as in [`family_work`](crate::family_work).
///
/// In `u(t) = Re(phi e^{lambda t})` the velocity is `Re(lambda phi e^{lambda t})`, so that over one period at frozen amplitude
/// the mean kinetic energy is `|lambda|^2 phi^H M phi / 4` and the mean strain energy `phi^H K phi / 4`.
///
/// ```
/// use linsys::SecondOrder;
/// use nalgebra::{dmatrix, dvector};
/// use num_complex::Complex;
/// use work::{StructurePart, mode_energy};
///
/// // 2 kg on two springs of 10 and 40 N/m, undamped: as much kinetic as strain energy, a fifth of it in the soft spring.
/// let spring = |m: f64, k: f64| SecondOrder::new(dmatrix![m], dmatrix![0.0], dmatrix![k]);
/// let (soft, stiff) = (spring(2.0, 10.0)?, spring(0.0, 40.0)?);
/// let parts = [StructurePart { name: "soft", system: &soft }, StructurePart { name: "stiff", system: &stiff }];
/// let energy = mode_energy(&parts, Complex::new(0.0, 5.0), &dvector![Complex::new(0.3, 0.4)], &[vec![0]])?;
/// assert!((energy.total.kinetic - energy.total.strain).abs() < 1e-12);
/// assert!((energy.parts[0].1.strain / energy.total.strain - 0.2).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// No part, sizes that do not fit, a modal mass that is not positive.
pub fn mode_energy(
    parts: &[StructurePart<'_>],
    lambda: Complex<f64>,
    phi: &DVector<Complex<f64>>,
    bodies: &[impl AsRef<[usize]>],
) -> Result<ModeEnergy, WorkError> {
    if parts.is_empty() {
        return Err(WorkError::NoPart);
    }
    // Quadratic forms first, energies when the modal mass is known.
    let mut on_each_dof = vec![Energy::default(); phi.len()];
    let mut of_parts = Vec::with_capacity(parts.len());
    for StructurePart { name, system } in parts {
        let part = || (*name).to_owned();
        system.check().map_err(|source| WorkError::Part { part: part(), source })?;
        if system.order() != phi.len() {
            return Err(WorkError::PartOrder { part: part(), found: system.order(), expected: phi.len() });
        }
        let mut of_part = Energy::default();
        for ((sum, kinetic), strain) in on_each_dof.iter_mut().zip(on_dofs(&system.m, phi)).zip(on_dofs(&system.k, phi))
        {
            *sum += Energy { kinetic, strain };
            of_part += Energy { kinetic, strain };
        }
        of_parts.push((part(), of_part));
    }
    let mut total = Energy::default();
    on_each_dof.iter().for_each(|form| total += *form);
    let modal_mass = total.kinetic;
    if !(modal_mass > 0.0 && modal_mass.is_finite()) {
        return Err(WorkError::ModalMass { value: modal_mass });
    }
    let energy = |form: Energy| Energy {
        kinetic: 0.25 * lambda.norm_sqr() * form.kinetic / modal_mass,
        strain: 0.25 * form.strain / modal_mass,
    };
    let of_body = |(body, dofs): (usize, &[usize])| {
        let mut sum = Energy::default();
        for &dof in dofs {
            sum += *on_each_dof.get(dof).ok_or(WorkError::UnknownDof { body, dof, order: phi.len() })?;
        }
        Ok(energy(sum))
    };
    Ok(ModeEnergy {
        total: energy(total),
        parts: of_parts.into_iter().map(|(name, form)| (name, energy(form))).collect(),
        bodies: bodies.iter().map(AsRef::as_ref).enumerate().map(of_body).collect::<Result<_, WorkError>>()?,
    })
}

/// `Re(conj(u_j) (A_s u)_j)` with the symmetric part of A.
fn on_dofs(a: &DMatrix<f64>, u: &DVector<Complex<f64>>) -> Vec<f64> {
    let symmetric = (a + a.transpose()) * 0.5;
    u.iter().zip(&real_times_complex(&symmetric, u)).map(|(u, f)| (u.conj() * f).re).collect()
}
