//! The friction of one contact in a system, or what relaxes in one direction of it.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::ChannelGain;
use crate::{LinsysError, SecondOrder};

/// The direction b of the friction force of one contact and the reading r of its normal force, both sparse.
///
/// Friction adds `b (mu r^T + lambda s(lambda) b^T)` to the dynamic stiffness, which stands on the left of the equations of motion: the
/// force on the brake is `-b (mu r^T u + s b^T u')`, in N. With a positive mu and a normal force `r^T u` that grows it acts against b; a negative
/// slope s, Ns/m, feeds a motion along b.
///
/// A part of the structure that relaxes, such as one direction of a viscoelastic shim, is a channel without a reading too: its internal state is all of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The name of the contact, or of what relaxes.
    pub name: String,
    /// The family to which the work of its forces belongs.
    pub family: String,
    /// b: degrees of freedom, from 0, with coefficients; of one that is there twice the coefficients add up.
    pub force: Vec<(usize, f64)>,
    /// r, N/m: degrees of freedom, from 0, with coefficients.
    pub reading: Vec<(usize, f64)>,
    /// True of a contact, false of a part of the structure that relaxes.
    pub is_contact: bool,
}

impl Channel {
    /// The friction of a contact with these directions.
    pub fn new(
        name: impl Into<String>,
        family: impl Into<String>,
        force: Vec<(usize, f64)>,
        reading: Vec<(usize, f64)>,
    ) -> Self {
        Self { name: name.into(), family: family.into(), force, reading, is_contact: true }
    }

    /// A part of the structure that relaxes in the direction b: with the lag of rate a, drive 1 and force k it adds `k lambda / (lambda + a) b b^T`, a spring k
    /// in series with a dashpot k / a.
    pub fn relaxing(name: impl Into<String>, family: impl Into<String>, direction: Vec<(usize, f64)>) -> Self {
        Self { is_contact: false, ..Self::new(name, family, direction, Vec::new()) }
    }

    /// The channel whose sides have the entries that a function makes of the entries of the sides of this channel.
    #[must_use]
    pub fn mapped(&self, entries: impl Fn(&[(usize, f64)]) -> Vec<(usize, f64)>) -> Self {
        Self {
            name: self.name.clone(),
            family: self.family.clone(),
            force: entries(&self.force),
            reading: entries(&self.reading),
            is_contact: self.is_contact,
        }
    }

    /// Checks that every degree of freedom is one of `order` and every coefficient is finite.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self, order: usize) -> Result<(), LinsysError> {
        for &(dof, value) in self.force.iter().chain(&self.reading) {
            if dof >= order {
                return Err(LinsysError::UnknownDof { dof, total: order });
            }
            if !value.is_finite() {
                return Err(LinsysError::ChannelGain { channel: self.name.clone() });
            }
        }
        Ok(())
    }

    /// The channel on the columns of a real n x k matrix V: `V^T b` and `r^T V`.
    #[must_use]
    pub fn projected(&self, basis: &DMatrix<f64>) -> Self {
        let onto = |side: &[(usize, f64)]| {
            let coordinate = |column: usize| side.iter().map(|&(dof, value)| value * basis[(dof, column)]).sum();
            (0..basis.ncols()).map(|column| (column, coordinate(column))).collect()
        };
        self.mapped(onto)
    }

    /// Adds `-b (mu r^T + lambda s(lambda) b^T) phi`.
    pub(super) fn add_force(
        &self,
        gain: &ChannelGain,
        lambda: Complex<f64>,
        phi: &DVector<Complex<f64>>,
        out: &mut DVector<Complex<f64>>,
    ) {
        let along = |side: &[(usize, f64)]| side.iter().map(|&(dof, value)| phi[dof] * value).sum::<Complex<f64>>();
        let force = along(&self.reading) * gain.mu + along(&self.force) * (lambda * gain.complex_slope(lambda));
        self.force.iter().for_each(|&(dof, b)| out[dof] -= force * b);
    }

    /// True of the sides of a channel of a reduced brake: with every entry, in order.
    pub(super) fn is_dense(&self, order: usize) -> bool {
        [&self.force, &self.reading].into_iter().all(|side| side.iter().map(|&(dof, _)| dof).eq(0..order))
    }

    /// Adds the forces of this channel that follow displacements and velocities.
    pub(super) fn add_instant(&self, gain: &ChannelGain, out: &mut SecondOrder) {
        let rows = out.order();
        let add = |matrix: &mut DMatrix<f64>, factor: f64, across: &[(usize, f64)]| {
            for &(column, r) in across {
                let column = &mut matrix.as_mut_slice()[column * rows..(column + 1) * rows];
                self.force.iter().for_each(|&(row, b)| column[row] += factor * (b * r));
            }
        };
        if gain.mu != 0.0 {
            add(&mut out.k, gain.mu, &self.reading);
        }
        if gain.slope != 0.0 {
            add(&mut out.c, gain.slope, &self.force);
        }
    }

    /// Adds the lag of this channel, if any, as the internal state `state`.
    pub(super) fn add_lag(&self, gain: &ChannelGain, state: usize, out: &mut SecondOrder) {
        let Some(lag) = gain.lag else { return };
        out.internal.decay[state] = lag.decay;
        for &(dof, b) in &self.force {
            // The state is driven by the sliding velocity -b^T u'.
            out.internal.drive[(state, dof)] -= b * lag.drive;
            out.internal.force[(dof, state)] += b * lag.force;
        }
    }
}
