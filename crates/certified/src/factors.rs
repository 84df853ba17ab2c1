//! A strongly damped problem as two eigenproblems, one of its slow and one of its fast eigenvalues, in double-double precision.
//!
//! Let r directions be strongly damped: then r eigenvalues are fast. Number the coordinates so that these are the first r, q_s; the others are q_w, and M_s, C_w
//! the columns of both. A slow motion has no velocity of its own in q_s but `q_s' = S z` with the state `z = (q_s, q_w, q_w')`. With
//! `q_s'' = S z'` the equation of motion gives
//!
//! ```text
//! (q_s', q_w'') = -B^-1 [K, C_w + M_s S_2] z,     B = [C_s + M_s S_1, M_w + M_s S_3],     S = [S_1, S_2, S_3]
//! ```
//!
//! where the parts of S act on q_s', q_w' and q_w''. The first r rows are S again. All of them, with q_w' between, are a
//! matrix G, z' = G z, which has the 2 n - r slow eigenvalues. F, the first r rows of `-B^-1 M_s`, has the reciprocals of the
//! fast ones. With r = n
//!
//! ```text
//! lambda^2 M + lambda C + K = (lambda M + B) (lambda - S),     B = M S + C,     G = S = -B^-1 K,
//! ```
//!
//! and the fixed-point iteration for S is Bernoulli's (Higham and Kim, IMA J. Numer. Anal. 20, 2000). A step takes an error e
//! of S to `F e G`, so
//!
//! ```text
//! |S_i+1 - S| <= 2 q |S_i+1 - S_i|     with  q = |F| |G| < 1/4,
//! ```
//!
//! and the G that is computed from S + e is wrong by `B^-1 M_s e G`. With the change of the last step in the place of e, twice `|B^-1 M_s|` times it is the relative
//! error of G, and of F by as much more as `|B^-1 M_s|` is larger than |F|. q is of the size of a slow eigenvalue over a fast one, 1e-10 where damping
//! outweighs mass and stiffness 1e5 times. After some steps in double precision two in double-double are enough then; up to six are made where q is larger, and where
//! these leave more than [`LARGEST_ERROR`](super::standard::LARGEST_ERROR), as above q = 0.15, the problem is left to the next route.

use linsys::reciprocal;
use nalgebra::DMatrix;
use num_complex::Complex;

use super::dd::Dd;
use super::lane::Lane;
use super::planar::{Planar, reveal_rank};
use super::scaled::{Scaled, power_of_two};
use super::standard::{Quotients, of_matrix, quotients};
use super::structure::Structure;

/// Largest q with which the iteration is known to converge.
const LARGEST_CONTRACTION: f64 = 0.25;
/// A step in double precision that does not contract ends the iteration where its relative error is no more than this; with a larger error its contraction says
/// nothing. Chosen.
const LARGEST_DOUBT: f64 = 0.1;
/// Most steps in double precision, each of which multiplies the error by q. Chosen: at the largest q of 1/4 six leave 2e-4 of it.
const STEPS_IN_DOUBLE: usize = 6;
/// Most steps in double-double; chosen: one doubles the digits of a double where q is small, and more are for splits that are not wide.
const MOST_EXTENDED_STEPS: usize = 6;
/// Ratio of two rates of damping that splits slow from fast wherever it occurs. Where several are as wide the last one splits, so that no strongly damped direction is
/// among the slow.
const WIDE_GAP: f64 = 1e5;

/// The eigenvalues that are neither zero nor infinite, complex ones in exact conjugate pairs; none where slow and fast ones are not
/// far enough apart, what is to be inverted is too nearly singular or the iteration fails.
pub(super) fn eigenvalues(s: &Scaled, structure: &Structure) -> Option<Vec<Complex<f64>>> {
    let turned = Turned::new(s, structure.infinite.is_empty());
    let (n, r) = (s.order(), turned.strong);
    let before = turned.in_double().split()?;
    let mut before = Planar::from_fn(r, 2 * n - r, |i, j| Dd::from(before.get(i, j)));
    let (mut slow, mut fast, mut errors) = (before.clone(), before.clone(), [f64::INFINITY; 2]);
    for _ in 0..MOST_EXTENDED_STEPS {
        let Quotients { of: [rates, masses], error } = turned.step(&before);
        // -G and -F.
        slow = Planar::from_fn(2 * n - r, 2 * n - r, |i, j| match i {
            _ if i < r => rates.get(i, j),
            _ if i < n => Dd::from(if j == i + n - r { -1.0 } else { 0.0 }),
            _ => rates.get(i + r - n, j),
        });
        fast = masses.block(0..r, 0..r);
        let contraction = slow.norm() * fast.norm();
        if contraction.is_nan() || contraction > LARGEST_CONTRACTION {
            return None;
        }
        let change = Planar::<f64>::from_fn(r, 2 * n - r, |i, j| (rates.get(i, j) - before.get(i, j)).value());
        let of_steps = 2.0 * masses.norm() * change.norm();
        errors = [1.0, masses.norm() / fast.norm()].map(|factor| (error + of_steps) * factor);
        if of_steps <= error {
            break;
        }
        before = rates.block(0..r, 0..2 * n - r);
    }
    let mut found = nonzero(slow, &structure.zero, errors[0])?;
    found.extend(nonzero(fast, &structure.infinite, errors[1])?.into_iter().map(reciprocal));
    Some(found.into_iter().map(|sigma| -sigma).collect())
}

/// The eigenvalues of a matrix with this relative error that are not zero; the null spaces of the zero eigenvalues are taken off first, with these
/// dimensions.
fn nonzero(mut matrix: Planar<Dd>, widths: &[usize], error: f64) -> Option<Vec<Complex<f64>>> {
    let whole = matrix.norm();
    for &width in widths {
        // The split goes by rounding and the widths by exact arithmetic: both need not agree.
        let (size, rest) = (matrix.rows(), matrix.rows().checked_sub(width)?);
        if rest == 0 {
            return Some(Vec::new());
        }
        // V^T A V, V with the null space in its last columns: these vanish, and what is in the rows below does not count.
        let (mut left, mut turn) = (matrix.transpose(), Planar::from(&DMatrix::identity(size, size)));
        reveal_rank(&mut left, &mut turn, rest);
        let right = left.block(0..rest, 0..size).transpose();
        matrix = Planar::from_fn(rest, rest, |_, _| Dd::default());
        matrix.add_product(&turn.block(0..rest, 0..size), &right);
    }
    // Of a norm of 0 every digit is lost: the error is infinite or NaN, and refused.
    let norm = matrix.norm();
    of_matrix(matrix, error * whole / norm)
}

/// M, C and K with the strongly damped directions in their first columns.
struct Turned<T> {
    strong: usize,
    m: Planar<T>,
    c: Planar<T>,
    k: Planar<T>,
}

impl Turned<Dd> {
    /// The problem with its strongly damped directions first. Where M is singular, all directions count as such: infinite eigenvalues have to be zeros of F.
    fn new(s: &Scaled, mass_is_regular: bool) -> Self {
        let n = s.order();
        let [mut m, mut c, mut k] = [&s.m, &s.c, &s.k].map(Planar::<Dd>::from);
        let mut strong = n;
        if mass_is_regular {
            let Quotients { of: [rates], .. } = quotients([&c], &m);
            let mut rates = rates.transpose();
            strong = before_the_widest_gap(&rates);
            if strong < n {
                let others = [&m, &c, &k];
                let mut others = Planar::from_fn(n, 3 * n, |i, j| others[j / n].get(j % n, i));
                reveal_rank(&mut rates, &mut others, strong);
                [m, c, k] = [0, 1, 2].map(|p| others.block(0..n, p * n..(p + 1) * n).transpose());
            }
        }
        // In units in which the columns of B are of one size.
        let size = |j: usize| {
            let column = if j < strong { c.rounded(j) } else { m.rounded(j) };
            Dd::from(power_of_two(1.0 / column.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()))))
        };
        let sizes: Vec<Dd> = (0..n).map(size).collect();
        let [m, c, k] = [m, c, k].map(|a| Planar::from_fn(n, n, |i, j| a.get(i, j) * sizes[j]));
        Self { strong, m, c, k }
    }

    fn in_double(&self) -> Turned<f64> {
        let [m, c, k] = [&self.m, &self.c, &self.k].map(rounded);
        Turned { strong: self.strong, m, c, k }
    }
}

impl Turned<f64> {
    /// -S to the digits of a double; none where a step does not contract, or none is left of it.
    fn split(&self) -> Option<Planar<f64>> {
        let (n, r) = (self.m.rows(), self.strong);
        let (mut split, mut left) = (Planar::from_fn(r, 2 * n - r, |_, _| 0.0), 1.0);
        for _ in 0..STEPS_IN_DOUBLE {
            let Quotients { of: [rates, masses], error } = self.step(&split);
            split = rates.block(0..r, 0..2 * n - r);
            // |G| is no less than the norm of the rates.
            let contraction = rates.norm() * masses.block(0..r, 0..r).norm();
            if error <= LARGEST_DOUBT && contraction > 1.0 {
                return None;
            }
            left *= contraction;
            if left <= f64::EPSILON {
                break;
            }
        }
        (!split.norm().is_nan()).then_some(split)
    }
}

impl<T: Lane> Turned<T> {
    /// `B^-1 [K, C_w + M_s S_2]` and `B^-1 M_s` from `-S`.
    fn step(&self, minus_s: &Planar<T>) -> Quotients<T, 2> {
        let (n, r) = (self.m.rows(), self.strong);
        let states = 2 * n - r;
        let m_s = self.m.block(0..n, 0..r);
        let mut carried = Planar::from_fn(n, states, |_, _| T::default());
        carried.add_product(&m_s, minus_s);
        let b = Planar::from_fn(n, n, |i, j| match j < r {
            true => self.c.get(i, j) - carried.get(i, j),
            false => self.m.get(i, j) - carried.get(i, j + n - r),
        });
        let forces = Planar::from_fn(n, states, |i, j| match j < n {
            true => self.k.get(i, j),
            false => self.c.get(i, j + r - n) - carried.get(i, j + r - n),
        });
        quotients([&forces, &m_s], &b)
    }
}

/// The number of directions, one or more, before the widest gap in the rates `(M^-1 C)^T` of damping, in units of gamma; what is
/// slower than gamma is no damping that outweighs mass and stiffness. All of them where M is singular to rounding.
fn before_the_widest_gap(rates: &Planar<Dd>) -> usize {
    let n = rates.rows();
    let found = reveal_rank(&mut rounded(rates), &mut Planar::from_fn(n, 0, |_, _| 0.0), n);
    let rate = |k: usize| found.get(k).map_or(1.0, |rate| rate.max(1.0));
    let gap = |r: usize| rate(r - 1) / rate(r);
    let wide = (1..=n).rev().find(|&r| gap(r) >= WIDE_GAP);
    wide.or_else(|| (1..=n).max_by(|&a, &b| gap(a).total_cmp(&gap(b)))).unwrap_or(n)
}

fn rounded(a: &Planar<Dd>) -> Planar<f64> {
    Planar::from_fn(a.rows(), a.columns(), |i, j| a.get(i, j).value())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pencil::{Pencil, companion};
    use linsys::SecondOrder;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    fn scaled(m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> Scaled {
        Scaled::new(&SecondOrder::new(m, c, k).unwrap())
    }

    #[test]
    fn what_has_no_gap_between_slow_and_fast_is_left_to_others() {
        let regular = Structure { infinite: vec![], zero: vec![] };
        let split =
            |c: DMatrix<f64>| eigenvalues(&scaled(DMatrix::identity(2, 2), c, dmatrix![2.0, 1.0; 1.0, 3.0]), &regular);
        assert_eq!(split(DMatrix::identity(2, 2) * 1e8).unwrap().len(), 4);
        assert_eq!(split(dmatrix![1e8, 0.0; 0.0, 1.0]).unwrap().len(), 4);
        assert_eq!(split(dmatrix![1e8, 0.0; 0.0, 0.0]).unwrap().len(), 4);
        // Damping as strong as the vibrations, and no damping.
        assert_eq!(split(DMatrix::identity(2, 2)), None);
        assert_eq!(split(DMatrix::zeros(2, 2)), None);
    }

    #[test]
    fn a_problem_of_which_all_digits_are_lost_is_left_to_others() {
        // Found at random: an eigenvalue of the fast part underflowed, and one of the eight was missing.
        let m =
            dmatrix![1.0, 0.0, 1.0, 1.0; -1e6, 0.0, 1.532057157452906, 0.0; 0.0, 1e-30, 1e12, 0.0; 1.0, 0.0, 1.0, -1.0];
        let c = dmatrix![-1e6, -1.0, 1.0, 0.0; 0.0, -1e6, -1.0, 1.0; 0.0, 1.0, 1.0, 0.0; -1.0, 0.0, 0.1, 1e-12];
        let k = dmatrix![1e-12, -1.0, 0.0, -1.0; 0.1, 0.0, 1.0, 0.0; 1.0, 0.0, 0.0, 1.0; 1.0, 1.0, -1.2204545919075453, 0.0];
        let system = SecondOrder::new(m, c, k).unwrap();
        let found = crate::solve(&system, &mut crate::Counters::default()).unwrap();
        assert_eq!(found.eigenvalues.len() + found.infinite, 8);
    }

    /// Checks that each of the eigenvalues of QZ, which inverts nothing and splits nothing, is found, and no others.
    fn compare_with_qz(problem: &Scaled, structure: &Structure) -> Result<(), TestCaseError> {
        let found = eigenvalues(problem, structure);
        // A motion that neither springs nor dashpots hold back has no digits to spare.
        prop_assume!(found.is_some());
        let mut found = found.unwrap_or_default();
        let pencil = Pencil::<Dd>::new(&companion(problem));
        let pencil = pencil.without_infinite(&structure.infinite).without_zero(&structure.zero);
        let expected = pencil.eigenvalues(false).unwrap();
        prop_assert_eq!(found.len(), expected.len());
        for e in &expected {
            let distance = |l: &Complex<f64>| (l - e).norm();
            let (at, nearest) = found.iter().map(distance).enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
            // Of 22,000 problems one had an eigenvalue that was 4e-14 away, all others less than 1e-14.
            prop_assert!(nearest < 1e-13 * e.norm(), "{} {}", nearest / e.norm(), e);
            found.swap_remove(at);
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig { max_global_rejects: 5, ..ProptestConfig::with_cases(96) })]

        /// Damping of all directions, or of some of them, so strong that fast and slow eigenvalues are eight to twenty-six powers of ten apart:
        /// dashpots from some degrees of freedom to the ground, and from combinations of all.
        #[test]
        fn strongly_damped_problems_have_the_eigenvalues_of_qz(
            entries in prop::collection::vec(-1.0..1.0f64, 3 * 49),
            strong in 1..=7usize,
            to_the_ground: bool,
            exponent in 6..14i32,
        ) {
            let part = |k: usize| DMatrix::from_column_slice(7, 7, &entries[49 * k..49 * (k + 1)]);
            let definite = |k: usize| part(k) * part(k).transpose() + DMatrix::identity(7, 7) * 0.3;
            // Of any sign and without symmetry, so that some are complex and some grow.
            let stiffness = part(2) + DMatrix::identity(7, 7) * 0.3;
            let mut dashpots = definite(1) + part(0) - part(0).transpose();
            if to_the_ground {
                dashpots.columns_mut(strong, 7 - strong).fill(0.0);
                dashpots.rows_mut(strong, 7 - strong).fill(0.0);
            } else if strong < 7 {
                let part = definite(1);
                dashpots = part.columns(0, strong) * part.columns(0, strong).transpose();
            }
            let damping = dashpots * 10f64.powi(exponent) + part(1) * 0.1;
            compare_with_qz(&scaled(definite(0), damping, stiffness), &Structure { infinite: vec![], zero: vec![] })?;
        }

        /// Damping of all directions, some without mass and some, others or the same, without stiffness.
        #[test]
        fn strong_damping_without_mass_or_stiffness_has_the_eigenvalues_of_qz(
            entries in prop::collection::vec(-1.0..1.0f64, 3 * 49),
            massless in 0..4usize,
            free in 0..4usize,
            exponent in 6..14i32,
        ) {
            let part = |k: usize| DMatrix::from_column_slice(7, 7, &entries[49 * k..49 * (k + 1)]);
            let definite = |k: usize| part(k) * part(k).transpose() + DMatrix::identity(7, 7) * 0.3;
            let (mut mass, mut stiffness) = (definite(0), part(2) + DMatrix::identity(7, 7) * 0.3);
            mass.rows_mut(0, massless).fill(0.0);
            mass.columns_mut(0, massless).fill(0.0);
            stiffness.columns_mut(2, free).fill(0.0);
            stiffness.rows_mut(3, free).fill(0.0);
            let damping = (definite(1) + part(0) - part(0).transpose()) * 10f64.powi(exponent);
            let system = SecondOrder::new(mass, damping, stiffness).unwrap();
            compare_with_qz(&Scaled::new(&system), &Structure::of(&system).unwrap())?;
        }
    }
}
