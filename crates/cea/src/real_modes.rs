//! The real modes of an undamped structure, and how much of each is in a complex mode.

use linsys::real_times_complex;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use num_complex::Complex;

/// Largest eigenvalue of M or K that is 0 but for rounding, relative to the largest of all and per degree of freedom; chosen: some roundings.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Largest difference of an entry of M from its mirror image, relative to the largest entry, with which M is symmetric but for rounding, also the rounding
/// of a reduction; chosen.
const SYMMETRIC: f64 = 1e-9;

/// Reason why a structure has no complete set of real modes.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoRealModes {
    /// M has this entry and another one across the diagonal.
    #[error("the mass matrix is not symmetric (row {row}, column {column}), as that of a structure is")]
    Unsymmetric {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
    },
    /// M has a negative eigenvalue.
    #[error("the mass matrix has the negative eigenvalue {value:.3e}")]
    NegativeMass {
        /// Negative eigenvalue of M, kg.
        value: f64,
    },
    /// M is zero.
    #[error("the mass matrix is zero")]
    NoMass,
    /// A motion has neither mass nor stiffness, so that a whole line of shapes belongs to each mode.
    #[error("a motion of the structure without mass has no stiffness either")]
    Loose,
}

/// The modes of `K phi = omega^2 M phi`, real and mass-normalised.
#[derive(Debug, Clone, PartialEq)]
pub struct RealModes {
    /// Squares omega^2 of the angular frequencies, rad^2/s^2, ascending; negative where the structure would fall away from its rest.
    pub omega_squared: Vec<f64>,
    /// Shapes phi_j, n x r, in the same order, `phi_i^T M phi_j = delta_ij`; r is the rank of M.
    pub shapes: DMatrix<f64>,
    mass: DMatrix<f64>,
}

impl RealModes {
    /// The modes of a structure with mass M and the symmetric part of K, both n x n.
    ///
    /// Where M is singular, what has no mass follows the rest without delay: the modes are the modes of K condensed on the range of M,
    /// which is exact, and their number is the rank of M.
    ///
    /// ```
    /// use cea::RealModes;
    /// use nalgebra::dmatrix;
    /// // Two masses of 1 kg, each on a spring of 3 N/m, with one of 1 N/m between them: 3 and 5 rad^2/s^2.
    /// let modes = RealModes::new(&dmatrix![1.0, 0.0; 0.0, 1.0], &dmatrix![4.0, -1.0; -1.0, 4.0])?;
    /// assert!((modes.omega_squared[0] - 3.0).abs() < 1e-12 && (modes.omega_squared[1] - 5.0).abs() < 1e-12);
    /// # Ok::<(), cea::NoRealModes>(())
    /// ```
    ///
    /// # Errors
    /// An M that is not symmetric positive semidefinite or is 0; a motion with neither mass nor stiffness.
    pub fn new(m: &DMatrix<f64>, k: &DMatrix<f64>) -> Result<Self, NoRealModes> {
        let (n, largest) = (m.nrows(), m.amax());
        for column in 0..n {
            let differs = |&row: &usize| (m[(row, column)] - m[(column, row)]).abs() > SYMMETRIC * largest;
            if let Some(row) = (0..column).find(differs) {
                return Err(NoRealModes::Unsymmetric { row: row + 1, column: column + 1 });
            }
        }
        let SymmetricEigen { eigenvectors, eigenvalues } = m.clone().symmetric_eigen();
        let least = ROUNDING * n as f64 * eigenvalues.amax();
        if eigenvalues.amax() == 0.0 {
            return Err(NoRealModes::NoMass);
        }
        if eigenvalues.min() < -least {
            return Err(NoRealModes::NegativeMass { value: eigenvalues.min() });
        }
        let chosen =
            |with_mass: bool| -> Vec<usize> { (0..n).filter(|&i| (eigenvalues[i] > least) == with_mass).collect() };
        let (heavy, massless) = (chosen(true), eigenvectors.select_columns(&chosen(false)));
        let mut heavy_shapes = eigenvectors.select_columns(&heavy);
        for (mut column, &i) in heavy_shapes.column_iter_mut().zip(&heavy) {
            column /= eigenvalues[i].sqrt();
        }
        let stiffness = (k + k.transpose()) * 0.5;
        let basis = condensed(&stiffness, heavy_shapes, &massless)?;
        let projected = basis.tr_mul(&(&stiffness * &basis));
        let SymmetricEigen { eigenvectors, eigenvalues } =
            ((&projected + projected.transpose()) * 0.5).symmetric_eigen();
        let mut order: Vec<usize> = (0..eigenvalues.len()).collect();
        order.sort_by(|&i, &j| eigenvalues[i].total_cmp(&eigenvalues[j]));
        Ok(Self {
            omega_squared: order.iter().map(|&i| eigenvalues[i]).collect(),
            shapes: basis * eigenvectors.select_columns(&order),
            mass: m.clone(),
        })
    }

    /// Dashpots, n x n, that have in every mode the loss of the imaginary stiffness `i K_t` above the real axis, where a part has K_t: of a loss factor
    /// eta take eta times it.
    ///
    /// ```text
    /// C = M Phi D Phi^T M,   D_ij = phi_i^T K_t phi_j / sqrt(omega_i omega_j)
    /// ```
    ///
    /// Modes that no stiffness resists have no dashpots.
    #[must_use]
    pub fn equivalent_dashpots(&self, part: &DMatrix<f64>) -> DMatrix<f64> {
        let largest = self.omega_squared.iter().fold(0.0_f64, |largest, square| largest.max(square.abs()));
        let mut shapes = self.shapes.clone();
        for (mut shape, &square) in shapes.column_iter_mut().zip(&self.omega_squared) {
            shape *= if square > STILL * largest { square.powf(-0.25) } else { 0.0 };
        }
        let momenta = &self.mass * &self.shapes;
        let dashpots = &momenta * shapes.tr_mul(&(part * &shapes)) * momenta.transpose();
        (&dashpots + dashpots.transpose()) * 0.5
    }

    /// Fractions `|phi_j^T M x|^2 / (x^H M x)` of each mode in a shape x of length n, in the order of the modes. They are not negative and their sum is 1,
    /// since the modes span all that has mass; NaN for a shape that moves no mass.
    #[must_use]
    pub fn participation(&self, x: &DVector<Complex<f64>>) -> Vec<f64> {
        let momentum = real_times_complex(&self.mass, x);
        let total = x.dotc(&momentum).re;
        real_times_complex(&self.shapes.transpose(), &momentum).iter().map(|part| part.norm_sqr() / total).collect()
    }
}

/// Largest square of the frequency of a motion that no stiffness resists, as a fraction of the largest of all; chosen: such a motion gets
/// no dashpots.
const STILL: f64 = 1e-12;

/// Shapes with the motions without mass that K gives them: `B - W (W^T K W)^-1 W^T K B`.
fn condensed(k: &DMatrix<f64>, b: DMatrix<f64>, w: &DMatrix<f64>) -> Result<DMatrix<f64>, NoRealModes> {
    if w.ncols() == 0 {
        return Ok(b);
    }
    let own = w.tr_mul(&(k * w));
    let eigenvalues = own.symmetric_eigenvalues().abs();
    if eigenvalues.min() <= ROUNDING * k.nrows() as f64 * k.norm() {
        return Err(NoRealModes::Loose);
    }
    let follows = own.lu().solve(&w.tr_mul(&(k * &b))).ok_or(NoRealModes::Loose)?;
    Ok(b - w * follows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn parts_of_a_shape_are_its_coefficients() {
        let (m, k) = (dmatrix![2.0, 0.5; 0.5, 3.0], dmatrix![40.0, -7.0; -7.0, 30.0]);
        let modes = RealModes::new(&m, &k).unwrap();
        let (a, b) = (Complex::new(0.6, 0.3), Complex::new(-0.1, 0.8));
        let x = modes.shapes.map(Complex::from) * dvector![a, b];
        let total = a.norm_sqr() + b.norm_sqr();
        let parts = modes.participation(&x);
        assert!((parts[0] - a.norm_sqr() / total).abs() < 1e-14 && (parts[1] - b.norm_sqr() / total).abs() < 1e-14);
        for j in 0..2 {
            let phi = modes.shapes.column(j);
            assert!((&k * phi - &m * phi * modes.omega_squared[j]).norm() < 1e-12 * k.norm());
        }
    }

    #[test]
    fn what_has_no_mass_follows_the_rest() {
        // 1 kg on 3 N/m and, over a joint without mass, on 2 + 2 N/m in a row: 3 + 1 N/m.
        let (m, k) = (dmatrix![1.0, 0.0; 0.0, 0.0], dmatrix![5.0, -2.0; -2.0, 4.0]);
        let modes = RealModes::new(&m, &k).unwrap();
        assert_eq!(modes.omega_squared.len(), 1);
        assert!((modes.omega_squared[0] - 4.0).abs() < 1e-14);
        assert!((modes.shapes[(1, 0)] / modes.shapes[(0, 0)] - 0.5).abs() < 1e-14);
        assert_eq!(modes.participation(&dvector![Complex::i(), Complex::from(0.3)]), [1.0]);
    }

    #[test]
    fn says_why_there_are_none() {
        let one = DMatrix::identity(2, 2);
        let none = |m: DMatrix<f64>, k: DMatrix<f64>| RealModes::new(&m, &k).unwrap_err();
        assert_eq!(none(dmatrix![1.0, 0.2; 0.0, 1.0], one.clone()), NoRealModes::Unsymmetric { row: 1, column: 2 });
        assert_eq!(none(dmatrix![1.0, 0.0; 0.0, -2.0], one.clone()), NoRealModes::NegativeMass { value: -2.0 });
        assert_eq!(none(DMatrix::zeros(2, 2), one), NoRealModes::NoMass);
        let half = dmatrix![1.0, 0.0; 0.0, 0.0];
        assert_eq!(none(half.clone(), half), NoRealModes::Loose);
    }
}
