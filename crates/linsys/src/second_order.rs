//! A second-order system as matrices, its dynamic stiffness Q(lambda) and the derivative Q'(lambda).

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::{LinsysError, Matrix, real_times_complex};

/// Fewest states, each on all degrees of freedom, that are summed as a product of matrices. Chosen: a reduced brake has some
/// dozens.
const MANY_STATES: usize = 8;

/// `M u'' + C u' + K u = F z`, `z' = -a z + E u'`.
///
/// The fields are public so that a model can refill a system in place for each sample, without allocation;
/// [`SecondOrder::check`] tells whether their contents are a system.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrder {
    /// Mass matrix M, n x n.
    pub m: DMatrix<f64>,
    /// Damping matrix C, n x n.
    pub c: DMatrix<f64>,
    /// Stiffness matrix K, n x n.
    pub k: DMatrix<f64>,
    /// The first-order states, none for most systems (s = 0).
    pub internal: Internal,
}

/// First-order states driven by velocities: `z' = -a z + E u'`, with the force `F z` on the right-hand side.
#[derive(Debug, Clone, PartialEq)]
pub struct Internal {
    /// Decay rates a, 1/s, length s.
    pub decay: DVector<f64>,
    /// Drive matrix E, s x n.
    pub drive: DMatrix<f64>,
    /// Force matrix F, n x s.
    pub force: DMatrix<f64>,
}

impl Internal {
    /// `states` internal states on `order` degrees of freedom, all zero.
    #[must_use]
    pub fn zeros(order: usize, states: usize) -> Self {
        Self {
            decay: DVector::zeros(states),
            drive: DMatrix::zeros(states, order),
            force: DMatrix::zeros(order, states),
        }
    }
}

impl SecondOrder {
    /// A system without internal states.
    ///
    /// # Errors
    /// No degrees of freedom, shapes that differ, an entry that is not finite.
    pub fn new(m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> Result<Self, LinsysError> {
        let internal = Internal::zeros(m.nrows(), 0);
        Self::with_internal(m, c, k, internal)
    }

    /// A system with internal states.
    ///
    /// # Errors
    /// As [`SecondOrder::new`].
    pub fn with_internal(
        m: DMatrix<f64>,
        c: DMatrix<f64>,
        k: DMatrix<f64>,
        internal: Internal,
    ) -> Result<Self, LinsysError> {
        let system = Self { m, c, k, internal };
        system.check()?;
        Ok(system)
    }

    /// A system with all matrices zero, to be filled.
    #[must_use]
    pub fn zeros(order: usize, states: usize) -> Self {
        let zero = || DMatrix::zeros(order, order);
        Self { m: zero(), c: zero(), k: zero(), internal: Internal::zeros(order, states) }
    }

    /// The system of `Q(lambda)^T`, whose right vectors are the complex conjugate left vectors of this one.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let Internal { decay, drive, force } = &self.internal;
        Self {
            m: self.m.transpose(),
            c: self.c.transpose(),
            k: self.k.transpose(),
            internal: Internal { decay: decay.clone(), drive: force.transpose(), force: drive.transpose() },
        }
    }

    /// `V^T Q(lambda) V`: the system on the columns of a real n x k matrix V, k degrees of freedom.
    ///
    /// # Errors
    /// Another number of rows than degrees of freedom, entries that are not finite.
    pub fn projected(&self, basis: &DMatrix<f64>) -> Result<Self, LinsysError> {
        let (found, expected) = (basis.nrows(), self.order());
        if found != expected {
            return Err(LinsysError::Count { what: "rows of the basis", found, expected });
        }
        let transposed = basis.transpose();
        let onto = |matrix: &DMatrix<f64>| &transposed * (matrix * basis);
        let Internal { decay, drive, force } = &self.internal;
        let internal = Internal { decay: decay.clone(), drive: drive * basis, force: &transposed * force };
        Self::with_internal(onto(&self.m), onto(&self.c), onto(&self.k), internal)
    }

    /// n, the number of degrees of freedom.
    #[must_use]
    pub fn order(&self) -> usize {
        self.m.nrows()
    }

    /// s, the number of internal states.
    #[must_use]
    pub fn states(&self) -> usize {
        self.internal.decay.len()
    }

    /// 2 n + s, the number of eigenvalues where M is regular.
    #[must_use]
    pub fn dimension(&self) -> usize {
        2 * self.order() + self.states()
    }

    /// Checks that shapes agree and every entry is finite.
    ///
    /// # Errors
    /// The first shape or entry that is wrong.
    pub fn check(&self) -> Result<(), LinsysError> {
        let (n, s) = (self.order(), self.states());
        if n == 0 {
            return Err(LinsysError::Empty);
        }
        let parts = [
            (Matrix::Mass, &self.m, n, n),
            (Matrix::Damping, &self.c, n, n),
            (Matrix::Stiffness, &self.k, n, n),
            (Matrix::Drive, &self.internal.drive, s, n),
            (Matrix::Force, &self.internal.force, n, s),
        ];
        for (name, matrix, rows, columns) in parts {
            if matrix.shape() != (rows, columns) {
                return Err(LinsysError::Shape {
                    matrix: name,
                    rows: matrix.nrows(),
                    columns: matrix.ncols(),
                    expected_rows: rows,
                    expected_columns: columns,
                });
            }
            // Without a way out of the loop the compiler takes several entries at a time.
            let is_finite = matrix.as_slice().iter().fold(true, |all, x| all & x.is_finite());
            if let Some(at) = (!is_finite).then(|| matrix.iter().position(|x| !x.is_finite())).flatten() {
                let (row, column) = (at % rows, at / rows);
                return Err(not_finite(name, row, column, matrix[(row, column)]));
            }
        }
        match self.internal.decay.iter().position(|x| !x.is_finite()) {
            Some(row) => Err(not_finite(Matrix::Decay, row, 0, self.internal.decay[row])),
            None => Ok(()),
        }
    }

    /// `Q(lambda) = lambda^2 M + lambda C + K - lambda F diag(1 / (lambda + a)) E`, n x n.
    ///
    /// `lambda` is an eigenvalue exactly where Q is singular, unless it equals `-a` of a state, where Q is not finite.
    #[must_use]
    pub fn dynamic_stiffness(&self, lambda: Complex<f64>) -> DMatrix<Complex<f64>> {
        let n = self.order();
        let square = lambda * lambda;
        let entries = self.m.as_slice().iter().zip(self.c.as_slice()).zip(self.k.as_slice());
        let mut q = DMatrix::from_iterator(n, n, entries.map(|((&m, &c), &k)| square * m + lambda * c + k));
        self.subtract_states(&mut q, |decay| lambda / (lambda + decay));
        q
    }

    /// `Q'(lambda) = 2 lambda M + C - F diag(a / (lambda + a)^2) E`, n x n.
    #[must_use]
    pub fn dynamic_stiffness_derivative(&self, lambda: Complex<f64>) -> DMatrix<Complex<f64>> {
        let n = self.order();
        let entries = self.m.as_slice().iter().zip(self.c.as_slice());
        let mut q = DMatrix::from_iterator(n, n, entries.map(|(&m, &c)| lambda * (2.0 * m) + c));
        self.subtract_states(&mut q, |decay| decay / ((lambda + decay) * (lambda + decay)));
        q
    }

    /// `Q'(lambda) x`, without the matrix.
    #[must_use]
    pub fn derivative_times(&self, lambda: Complex<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let mut image = real_times_complex(&self.m, x) * (lambda * 2.0) + real_times_complex(&self.c, x);
        for (state, &decay) in self.internal.decay.iter().enumerate() {
            let reading: Complex<f64> = self.internal.drive.row(state).iter().zip(x).map(|(e, x)| x * e).sum();
            let gain = decay / ((lambda + decay) * (lambda + decay)) * reading;
            image.iter_mut().zip(&self.internal.force.column(state)).for_each(|(sum, f)| *sum -= gain * f);
        }
        image
    }

    /// `Q''(lambda) = 2 M + 2 F diag(a / (lambda + a)^3) E`, n x n.
    #[must_use]
    pub fn dynamic_stiffness_second_derivative(&self, lambda: Complex<f64>) -> DMatrix<Complex<f64>> {
        let mut q = self.m.map(|m| Complex::from(2.0 * m));
        self.subtract_states(&mut q, |decay| -2.0 * decay / (lambda + decay).powi(3));
        q
    }

    /// `q -= F diag(gain(a)) E`.
    fn subtract_states(&self, q: &mut DMatrix<Complex<f64>>, gain: impl Fn(f64) -> Complex<f64>) {
        let (n, Internal { decay, drive, force }) = (self.order(), &self.internal);
        if decay.len() >= MANY_STATES && drive.iter().all(|&drive| drive != 0.0) {
            let gains = decay.map(gain);
            let product = |part: fn(&Complex<f64>) -> f64| {
                force * DMatrix::from_fn(decay.len(), n, |state, j| part(&gains[state]) * drive[(state, j)])
            };
            let (re, im) = (product(|gain| gain.re), product(|gain| gain.im));
            q.zip_zip_apply(&re, &im, |q, re, im| *q -= Complex::new(re, im));
            return;
        }
        for (state, force) in force.as_slice().chunks_exact(n.max(1)).enumerate() {
            let gain = gain(decay[state]);
            for (column, &drive) in q.as_mut_slice().chunks_exact_mut(n.max(1)).zip(&drive.row(state)) {
                if drive != 0.0 {
                    column.iter_mut().zip(force).for_each(|(q, force)| *q -= gain * (force * drive));
                }
            }
        }
    }
}

fn not_finite(matrix: Matrix, row: usize, column: usize, value: f64) -> LinsysError {
    LinsysError::NotFinite { matrix, row: row + 1, column: column + 1, value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn internal_state_acts_as_its_complex_slope() {
        // m u'' + k u = f z, z' = -a z + e u'  =>  lambda^2 m + k - f e lambda / (lambda + a) = 0.
        let internal = Internal { decay: dvector![3.0], drive: dmatrix![2.0], force: dmatrix![-5.0] };
        let system = SecondOrder::with_internal(dmatrix![1.5], dmatrix![0.0], dmatrix![7.0], internal).unwrap();
        let lambda = Complex::new(0.3, 1.1);
        let expected = lambda * lambda * 1.5 + 7.0 + lambda * 10.0 / (lambda + 3.0);
        assert!((system.dynamic_stiffness(lambda)[(0, 0)] - expected).norm() < 1e-14);
        assert_eq!(system.dimension(), 3);
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let internal = Internal { decay: dvector![3.0], drive: dmatrix![2.0, 0.0], force: dmatrix![-5.0; 1.0] };
        let (m, c, k) = (dmatrix![1.5, 0.1; 0.1, 2.0], dmatrix![0.2, 0.0; 0.3, 0.1], dmatrix![7.0, -1.0; 2.0, 9.0]);
        let system = SecondOrder::with_internal(m, c, k, internal).unwrap();
        let (lambda, step) = (Complex::new(-0.3, 1.1), 1e-5);
        let ahead = system.dynamic_stiffness(lambda + step);
        let behind = system.dynamic_stiffness(lambda - step);
        let difference = (ahead - behind) / Complex::from(2.0 * step);
        assert!((difference - system.dynamic_stiffness_derivative(lambda)).norm() < 1e-8);
        let [ahead, behind] = [step, -step].map(|step| system.dynamic_stiffness_derivative(lambda + step));
        let difference = (ahead - behind) / Complex::from(2.0 * step);
        assert!((difference - system.dynamic_stiffness_second_derivative(lambda)).norm() < 1e-8);
    }

    #[test]
    fn many_states_act_as_each_of_them_does() {
        let (n, s) = (6, MANY_STATES + 3);
        let wave = |i: usize, j: usize| ((5 * i + 3 * j * j + i * j) % 13) as f64 - 6.5;
        let matrix = |seed: usize| DMatrix::from_fn(n, n, |i, j| wave(i + seed, j));
        let internal = |states: std::ops::Range<usize>| Internal {
            decay: DVector::from_fn(states.len(), |i, _| 1.0 + 0.3 * (states.start + i) as f64),
            drive: DMatrix::from_fn(states.len(), n, |i, j| wave(states.start + i, j)),
            force: DMatrix::from_fn(n, states.len(), |i, j| wave(i, states.start + j + 2)),
        };
        let with = |states| SecondOrder::with_internal(matrix(0), matrix(1), matrix(2), internal(states)).unwrap();
        let (all, few, lambda) = (with(0..s), with(0..0), Complex::new(-0.4, 1.7));
        let added = |of: fn(&SecondOrder, Complex<f64>) -> DMatrix<Complex<f64>>| {
            let each = (0..s).map(|state| of(&with(state..state + 1), lambda) - of(&few, lambda));
            let expected = each.fold(of(&few, lambda), |sum, one| sum + one);
            (of(&all, lambda) - &expected).norm() / expected.norm()
        };
        assert!(added(SecondOrder::dynamic_stiffness) < 1e-14);
        assert!(added(SecondOrder::dynamic_stiffness_derivative) < 1e-14);
        let x = DVector::from_fn(n, |i, _| Complex::new(wave(i, 1), wave(1, i)));
        let expected = all.dynamic_stiffness_derivative(lambda) * &x;
        assert!((all.derivative_times(lambda, &x) - &expected).norm() < 1e-14 * expected.norm());
    }

    #[test]
    fn says_what_is_wrong() {
        let one = || dmatrix![1.0];
        let error = SecondOrder::new(one(), dmatrix![1.0, 2.0], one()).unwrap_err();
        assert_eq!(error.to_string(), "the damping matrix is 1 x 2; expected 1 x 1");
        let error = SecondOrder::new(one(), one(), dmatrix![f64::NAN]).unwrap_err();
        assert!(error.to_string().contains("stiffness matrix has NaN in row 1, column 1"));
        assert_eq!(SecondOrder::new(DMatrix::zeros(0, 0), one(), one()), Err(LinsysError::Empty));
    }
}
