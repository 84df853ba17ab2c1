//! Stiffness of a contact: by area, in all, or growing with the pressure.

use crate::sliding::value;
use crate::{ContactError, Interface};

/// Stiffness of a contact along its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stiffness {
    /// Pressure by overlap, N/m^3: the same everywhere.
    PerArea(f64),
    /// Force by overlap of all points together, N/m, shared by their areas.
    InAll(f64),
    /// Pressure `p = c g^m` by the overlap g of rough faces, m about 2 to 3.3: stiffer where the pressure is higher.
    Power {
        /// Factor c, a pressure by the m-th power of a length.
        c: f64,
        /// Exponent m, >= 1.
        m: f64,
    },
}

impl Stiffness {
    /// Checks the numbers of the stiffness.
    ///
    /// # Errors
    /// One that is not finite and > 0, an exponent below 1.
    pub fn check(&self) -> Result<(), ContactError> {
        let positive = |what, x: f64| {
            if x.is_finite() && x > 0.0 { Ok(()) } else { Err(value(what, x, "a finite number > 0")) }
        };
        match *self {
            Self::PerArea(c) => positive("the stiffness of a contact by area", c),
            Self::InAll(k) => positive("the stiffness of a contact", k),
            Self::Power { c, m } => {
                positive("c of a contact's p = c g^m", c)?;
                let is_allowed = m.is_finite() && m >= 1.0;
                if is_allowed { Ok(()) } else { Err(value("m of a contact's p = c g^m", m, "a finite number >= 1")) }
            }
        }
    }

    /// The force of a point at an overlap, N, 0 without overlap, and its derivative towards more overlap, N/m; the point has this `area`, and all points
    /// together `whole`.
    pub(crate) fn force(&self, area: f64, whole: f64, overlap: f64) -> (f64, f64) {
        let overlap = overlap.max(0.0);
        match *self {
            Self::PerArea(c) => (c * area * overlap, c * area),
            Self::InAll(k) => (k * area / whole * overlap, k * area / whole),
            Self::Power { c, m } => (c * area * overlap.powf(m), m * c * area * overlap.powf(m - 1.0)),
        }
    }
}

impl Interface {
    /// The tangent stiffness of each point under its normal force, N/m: `dp/dg = m c^(1/m) p^(1 - 1/m)` times its area of the power law, which
    /// is 0 where nothing presses and m > 1; of the others it does not depend on the force.
    ///
    /// # Errors
    /// Numbers of the law that are not allowed, not a force of each point, a force below 0.
    pub fn tangents(&self, stiffness: &Stiffness, forces: &[f64]) -> Result<Vec<f64>, ContactError> {
        stiffness.check()?;
        self.counted("normal forces", forces.len())?;
        if let Some(&force) = forces.iter().find(|force| !(force.is_finite() && **force >= 0.0)) {
            return Err(value("a normal force", force, "a finite number >= 0"));
        }
        let whole = self.area();
        let tangent = |(point, &force): (&crate::ContactPoint, &f64)| match *stiffness {
            Stiffness::PerArea(c) => c * point.area,
            Stiffness::InAll(k) => k * point.area / whole,
            Stiffness::Power { c, m } => {
                let pressure = force / point.area;
                m * c.powf(1.0 / m) * pressure.powf(1.0 - 1.0 / m) * point.area
            }
        };
        Ok(self.points().iter().zip(forces).map(tangent).collect())
    }

    pub(crate) fn counted(&self, what: &'static str, found: usize) -> Result<(), ContactError> {
        let expected = self.points().len();
        if found == expected { Ok(()) } else { Err(ContactError::Count { what, found, expected }) }
    }
}
