//! Perturbation of Q by a parameter, as an eigenvalue sees it.

use linsys::SecondOrder;
use nalgebra::DVector;
use num_complex::Complex;

use super::Eigentriple;

/// Derivative `Q_p = d Q / d p` by a parameter p at an eigenvalue, through its vectors x and y. The derivatives by several parameters that change
/// together are added.
#[derive(Debug, Clone, PartialEq)]
pub struct Perturbation {
    /// `Q_p x`.
    pub(super) on_right: DVector<Complex<f64>>,
    /// `Q_p^H y`.
    pub(super) on_left: DVector<Complex<f64>>,
    /// `y^H (d Q_p / d lambda) x`.
    pub(super) by_lambda: Complex<f64>,
    /// `y^H Q_pp x`.
    pub(super) by_itself: Complex<f64>,
}

impl Perturbation {
    /// A parameter that Q does not depend on.
    #[must_use]
    pub fn none(triple: &Eigentriple) -> Self {
        let zero = || DVector::zeros(triple.right.len());
        Self { on_right: zero(), on_left: zero(), by_lambda: Complex::default(), by_itself: Complex::default() }
    }

    /// A parameter that Q is linear in: `Q = Q_0 + p Q_1(lambda)` with the dynamic stiffness Q_1 of `part`, of the same order.
    #[must_use]
    pub fn linear(triple: &Eigentriple, part: &SecondOrder) -> Self {
        let mut by = Self::none(triple);
        let n = part.order();
        for (at, ((&m, &c), &k)) in part.m.iter().zip(&part.c).zip(&part.k).enumerate() {
            by.add_entry(triple, (at % n, at / n), [m, c, k], [0.0; 3]);
        }
        (0..part.states()).for_each(|state| by.add_state(triple, part, state, [1.0, 0.0]));
        by
    }

    /// A parameter of any kind, by central differences of three systems of one shape: at p - h, p and p + h, with h the `half_step` in units of p.
    /// Eigenvalues are not differenced, only the entries of the matrices, which are smooth where eigenvalues are not.
    #[must_use]
    pub fn between(triple: &Eigentriple, [below, at, above]: [&SecondOrder; 3], half_step: f64) -> Self {
        let mut by = Self::none(triple);
        let (n, once, twice) = (at.order(), 0.5 / half_step, 1.0 / (half_step * half_step));
        let matrices = |system: &SecondOrder, i: usize| [system.m[i], system.c[i], system.k[i]];
        for i in 0..n * n {
            let (low, middle, high) = (matrices(below, i), matrices(at, i), matrices(above, i));
            if low != high || low != middle {
                let first = std::array::from_fn(|j| once * (high[j] - low[j]));
                let second = std::array::from_fn(|j| twice * ((high[j] - middle[j]) - (middle[j] - low[j])));
                by.add_entry(triple, (i % n, i / n), first, second);
            }
        }
        for state in 0..at.states() {
            by.add_state(triple, above, state, [once, twice]);
            by.add_state(triple, below, state, [-once, twice]);
            by.add_state(triple, at, state, [0.0, -2.0 * twice]);
        }
        by
    }

    /// A parameter that Q is linear in through one product: `Q = Q_0 + p g(lambda) b r^T`, with g and its derivative at lambda. b and r
    /// are sparse: degrees of freedom, from 0, with coefficients.
    #[must_use]
    pub fn product(
        triple: &Eigentriple,
        [gain, gain_slope]: [Complex<f64>; 2],
        b: &[(usize, f64)],
        r: &[(usize, f64)],
    ) -> Self {
        let mut by = Self::none(triple);
        let read: Complex<f64> = r.iter().map(|&(dof, c)| triple.right[dof] * c).sum();
        let acted: Complex<f64> = b.iter().map(|&(dof, c)| triple.left[dof] * c).sum();
        b.iter().for_each(|&(dof, c)| by.on_right[dof] += gain * read * c);
        r.iter().for_each(|&(dof, c)| by.on_left[dof] += gain.conj() * acted * c);
        by.by_lambda = gain_slope * acted.conj() * read;
        by
    }

    /// Rate `d lambda / d p`, rad/s per unit of p; as [`Eigentriple::rate`], without a matrix.
    #[must_use]
    pub fn rate(&self, triple: &Eigentriple) -> Complex<f64> {
        -triple.left.dotc(&self.on_right) / triple.slope
    }

    /// Adds derivatives of one entry of M, C and K.
    fn add_entry(&mut self, triple: &Eigentriple, (i, j): (usize, usize), first: [f64; 3], second: [f64; 3]) {
        if first == [0.0; 3] && second == [0.0; 3] {
            return;
        }
        let (lambda, x, y) = (triple.lambda, triple.right[j], triple.left[i]);
        let of = |[m, c, k]: [f64; 3]| lambda * lambda * m + lambda * c + k;
        let change = of(first);
        self.on_right[i] += change * x;
        self.on_left[j] += change.conj() * y;
        self.by_lambda += y.conj() * x * (lambda * (2.0 * first[0]) + first[1]);
        self.by_itself += y.conj() * x * of(second);
    }

    /// Adds `-lambda / (lambda + a) F E` of an internal state with weights in the first and in the second derivative.
    fn add_state(&mut self, triple: &Eigentriple, system: &SecondOrder, state: usize, [first, second]: [f64; 2]) {
        let (lambda, decay) = (triple.lambda, system.internal.decay[state]);
        let (drive, force) = (system.internal.drive.row(state), system.internal.force.column(state));
        let gain = -lambda / (lambda + decay);
        let gain_slope = -decay / ((lambda + decay) * (lambda + decay));
        let read: Complex<f64> = drive.iter().zip(&triple.right).map(|(e, x)| x * *e).sum();
        let acted: Complex<f64> = force.iter().zip(&triple.left).map(|(f, y)| y * *f).sum();
        for (sum, &f) in self.on_right.iter_mut().zip(force.iter()) {
            *sum += gain * read * (first * f);
        }
        for (sum, &e) in self.on_left.iter_mut().zip(drive.iter()) {
            *sum += gain.conj() * acted * (first * e);
        }
        self.by_lambda += gain_slope * acted.conj() * read * first;
        self.by_itself += gain * acted.conj() * read * second;
    }
}

impl std::ops::AddAssign for Perturbation {
    fn add_assign(&mut self, other: Self) {
        self.on_right += other.on_right;
        self.on_left += other.on_left;
        self.by_lambda += other.by_lambda;
        self.by_itself += other.by_itself;
    }
}
