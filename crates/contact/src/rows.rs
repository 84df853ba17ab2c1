//! Contact points over the degrees of freedom of a model: rows of gap and slip, matrices, and friction channels.
//!
//! With `u_rel = u_slave - u_master`, the normal n into the slave and the sliding t of the master under it, a point adds, all on the left
//! of `M u'' + C u' + K u = 0`:
//!
//! ```text
//! K += k g g^T                                g = (n on the slave, -n on the master):   N = N0 - k g^T u
//! K += mu k s g^T                             s = (t on the slave, -t on the master):   friction mu N pulls the slave along t
//! C += (mu N0 / v) a a^T                      a = (n x t, ...): friction keeps the direction of the sliding, which moves across
//! C += N0 mu'(v) s s^T                        the slope of the law
//! ```

use elements::{Mesh, Rows};
use linsys::Channel;
use nalgebra::Vector3;
use nalgebra_sparse::{CooMatrix, CscMatrix};

use crate::{ContactError, ContactPoint, Interface};

/// A row over degrees of freedom: their numbers from 0, ascending, with coefficients.
pub type Row = Vec<(usize, f64)>;

impl ContactPoint {
    /// The row that makes `v . u_rel` of the displacements of a model. Nodes that the model holds have no entry.
    #[must_use]
    pub fn row(&self, rows: &Rows, direction: &Vector3<f64>) -> Row {
        let mut row: Row = Vec::with_capacity(3 * (self.slave.len() + self.master.len()));
        for (node, weight) in self.relative() {
            for x in 0..3 {
                if let Some(dof) = rows.row(node, x).filter(|_| direction[x] != 0.0) {
                    row.push((dof, weight * direction[x]));
                }
            }
        }
        row.sort_unstable_by_key(|(dof, _)| *dof);
        // A node that both sides have, as where a body touches itself.
        row.dedup_by(|next, kept| {
            let is_same = next.0 == kept.0;
            if is_same {
                kept.1 += next.1;
            }
            is_same
        });
        row
    }

    /// Row g of the gap, which opens by `g^T u`.
    #[must_use]
    pub fn gap_row(&self, rows: &Rows) -> Row {
        self.row(rows, &self.normal)
    }

    /// Row s of the slip: the slave moves by `s^T u` along the sliding, against the master.
    #[must_use]
    pub fn slip_row(&self, rows: &Rows) -> Row {
        self.row(rows, &self.sliding)
    }

    /// Row a of the motion across the sliding: the slave moves by `a^T u` along `n x t`, against the master.
    #[must_use]
    pub fn across_row(&self, rows: &Rows) -> Row {
        self.row(rows, &self.across())
    }
}

impl Interface {
    /// Stiffness `sum k g g^T` of the springs of the points, N/m each.
    ///
    /// # Errors
    /// Not a stiffness of each point.
    pub fn normal_stiffness(&self, rows: &Rows, stiffness: &[f64]) -> Result<CscMatrix<f64>, ContactError> {
        Ok(symmetric(&self.sum(rows, stiffness, |point| [point.gap_row(rows), point.gap_row(rows)])?))
    }

    /// Stiffness `sum k s g^T` that friction adds to K for mu = 1.
    ///
    /// # Errors
    /// Not a stiffness of each point.
    pub fn friction_stiffness(&self, rows: &Rows, stiffness: &[f64]) -> Result<CscMatrix<f64>, ContactError> {
        self.sum(rows, stiffness, |point| [point.slip_row(rows), point.gap_row(rows)])
    }

    /// Damping `sum (N0 / v) a a^T`, `(N0 / v) (I - n n^T - t t^T)` on u_rel, that friction across the sliding adds to C for mu = 1. Normal
    /// forces are given, speeds are the sliding speeds of the points.
    ///
    /// # Errors
    /// Not a force of each point.
    pub fn lateral_damping(&self, rows: &Rows, forces: &[f64]) -> Result<CscMatrix<f64>, ContactError> {
        self.counted("normal forces", forces.len())?;
        let by_speed: Vec<f64> = forces.iter().zip(self.points()).map(|(force, point)| force / point.speed).collect();
        Ok(symmetric(&self.sum(rows, &by_speed, |point| [point.across_row(rows), point.across_row(rows)])?))
    }

    /// Damping `sum N0 s s^T` that the slope of a law adds to C for mu'(v) = 1.
    ///
    /// # Errors
    /// Not a force of each point.
    pub fn slope_damping(&self, rows: &Rows, forces: &[f64]) -> Result<CscMatrix<f64>, ContactError> {
        Ok(symmetric(&self.sum(rows, forces, |point| [point.slip_row(rows), point.slip_row(rows)])?))
    }

    /// Friction along the sliding, a channel for each point with b = s and r = k g, named by the node of the slave and the number of the point.
    ///
    /// # Errors
    /// Not a stiffness of each point.
    pub fn channels(
        &self,
        mesh: &Mesh,
        rows: &Rows,
        stiffness: &[f64],
        family: &str,
    ) -> Result<Vec<Channel>, ContactError> {
        self.counted("stiffnesses", stiffness.len())?;
        let channel = |(at, (point, k)): (usize, (&ContactPoint, &f64))| {
            let reading = point.gap_row(rows).into_iter().map(|(dof, value)| (dof, k * value)).collect();
            Channel::new(self.name(mesh, at), family, point.slip_row(rows), reading)
        };
        Ok(self.points().iter().zip(stiffness).enumerate().map(channel).collect())
    }

    /// Friction across the sliding, a channel for each point with b = a that reads nothing: its gain is `mu N0 / v`.
    #[must_use]
    pub fn across_channels(&self, mesh: &Mesh, rows: &Rows, family: &str) -> Vec<Channel> {
        let channel = |(at, point): (usize, &ContactPoint)| {
            let name = format!("{} across", self.name(mesh, at));
            Channel::new(name, family, point.across_row(rows), Vec::new())
        };
        self.points().iter().enumerate().map(channel).collect()
    }

    /// Name of a point: the node of the slave next to it, and its number among all points from 1.
    #[must_use]
    pub fn name(&self, mesh: &Mesh, point: usize) -> String {
        let node = self.points().get(point).map_or(0, |point| mesh.labels()[point.node()]);
        format!("{node}#{}", point + 1)
    }

    /// `sum factor b c^T`.
    fn sum(
        &self,
        rows: &Rows,
        factors: &[f64],
        of: impl Fn(&ContactPoint) -> [Row; 2],
    ) -> Result<CscMatrix<f64>, ContactError> {
        self.counted("numbers of points", factors.len())?;
        let mut sum = CooMatrix::new(rows.order(), rows.order());
        for (point, factor) in self.points().iter().zip(factors) {
            let [left, right] = of(point);
            for &(row, a) in &left {
                right.iter().for_each(|&(column, b)| sum.push(row, column, factor * (a * b)));
            }
        }
        Ok((&sum).into())
    }
}

/// `(A + A^T) / 2`: a matrix that is symmetric but for the order of its sums, exactly so.
fn symmetric(a: &CscMatrix<f64>) -> CscMatrix<f64> {
    (a + a.transpose()) * 0.5
}
