//! Normal forces that are given: a total, or a pressure at each node.

use std::collections::{HashMap, HashSet};

use elements::Mesh;

use crate::sliding::value;
use crate::{ContactError, Interface};

impl Interface {
    /// The normal force of each point of a total that presses with the same pressure everywhere, N.
    ///
    /// # Errors
    /// A total that is not > 0.
    pub fn uniform(&self, total: f64) -> Result<Vec<f64>, ContactError> {
        if !(total.is_finite() && total > 0.0) {
            return Err(value("the load of a contact", total, "a finite force > 0"));
        }
        let pressure = total / self.area();
        Ok(self.points().iter().map(|point| pressure * point.area).collect())
    }

    /// The normal force of each point of pressures at the nodes of the slave, by their numbers, between which the shape functions tell:
    /// `N = A sum_a N_a p_a`, 0 where quadratic shape functions make it less.
    ///
    /// # Errors
    /// A node of the slave without a pressure or with two, a pressure of another node, one below 0 or not finite, none above 0.
    pub fn of_pressures(&self, mesh: &Mesh, pressures: &[(i64, f64)]) -> Result<Vec<f64>, ContactError> {
        let mut of_node = HashMap::with_capacity(pressures.len());
        let own: HashSet<usize> = self.points().iter().flat_map(|point| &point.slave).map(|(node, _)| *node).collect();
        for &(node, pressure) in pressures {
            if !(pressure.is_finite() && pressure >= 0.0) {
                return Err(value("a pressure", pressure, "a finite number >= 0"));
            }
            let place = mesh.place(node).filter(|place| own.contains(place));
            if of_node.insert(place.ok_or(ContactError::UnknownNode { node })?, pressure).is_some() {
                return Err(ContactError::PressedTwice { node });
            }
        }
        let mut forces = Vec::with_capacity(self.points().len());
        for point in self.points() {
            let mut pressure = 0.0;
            for (node, weight) in &point.slave {
                let missing = || ContactError::NoPressure { node: mesh.labels()[*node] };
                pressure += weight * of_node.get(node).ok_or_else(missing)?;
            }
            forces.push(point.area * pressure.max(0.0));
        }
        let total: f64 = forces.iter().sum();
        if total > 0.0 { Ok(forces) } else { Err(value("the sum of the pressures", total, "above 0")) }
    }
}
