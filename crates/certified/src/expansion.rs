//! A group of eigenvalues, and a disc that holds as many of every problem that rounds to the given matrices.
//!
//! X and Y are unit vectors of the q smallest singular values of Q(mu). The bordered matrix is regular where Q is not,
//!
//! ```text
//! [ Q(mu + d)  Y ]^-1    [ E(d)   W(d) ]
//! [   X^H      0 ]     = [ V(d)   S(d) ],       det Q(mu + d) = 0  just where  det S(d) = 0,
//! ```
//!
//! and S is an analytic function of q x q, whatever the Jordan structure of the group (a Grushin problem; Sjöstrand and
//! Zworski, Ann. Inst. Fourier 57, 2007). With `Q(mu + d) = Q(mu) + d Q' + d^2 M` its Taylor series follows from the series of W,
//!
//! ```text
//! W_k = -E (Q' W_{k-1} + M W_{k-2}),     S_k = -V (Q' W_{k-1} + M W_{k-2}),
//! ```
//!
//! one solve for each term, and the norms of E Q' and E M bound the terms that are left out. A perturbation P of Q changes
//! S by `V P (I + E P)^-1 W`. Where on a circle one term of det S outweighs the others and both of these, no eigenvalue of
//! any perturbed problem is on the circle, and as many are inside as the number of that term says ([`block_rouche`],
//! [`pellet`]). docs/error-bounds.md, section 7.

use nalgebra::DMatrix;
use num_complex::Complex;

use super::enclosures::{block_rouche, pellet};
use super::scaled::{Scaled, UNIT_ROUNDOFF, data_noise};
use super::vectors::{Factor, SURELY_SHOWN, by_norms, shown_norm};
use crate::lu::{LEAST_PIVOT, Lu, Vector};

/// Number of terms of the series beyond the one that is to outweigh the others; chosen: each costs a solve, and what is left out shrinks with each.
const TERMS_BEYOND: usize = 4;
/// Ratio of the radii that are tried; chosen: with a smaller one more are tried, with a larger one the radius found is farther above the least.
const RADIUS_STEP: f64 = 1.25;
/// Largest group with chains, and most vectors of one; chosen: the cost of det S grows with the square of their product.
pub(super) const LARGEST_CHAINED: usize = 12;

/// A disc of the scaled plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Disc {
    pub(super) centre: Complex<f64>,
    pub(super) radius: f64,
}

/// Outcome of the attempt to enclose an eigenvalue by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Alone {
    /// An eigenvalue that is alone in this disc.
    Enclosed(Disc),
    /// An eigenvalue that is not enclosed yet, or not by these vectors.
    Open,
    /// An eigenvalue that cannot be enclosed alone: rounding hides more directions than its own.
    Crowded,
}

impl Alone {
    pub(super) fn disc(self) -> Option<Disc> {
        match self {
            Self::Enclosed(disc) => Some(disc),
            _ => None,
        }
    }
}

/// `E b` and `V b` of b.
type Inverse<'a> = dyn Fn(Vector) -> (Vector, Vector) + 'a;

/// The columns of W_0 and S_0, the rows of V, adjoint, and `|Q W_0 + Y S_0|`, which is zero but for rounding.
struct First {
    terms: Vec<Vector>,
    series: Vec<Vector>,
    rows: Vec<Vector>,
    residual: f64,
}

/// The series of S around the mean of a group, and what bounds the rest.
pub(super) struct Expansion<'a> {
    problem: &'a Scaled,
    centre: Complex<f64>,
    /// Eigenvalues of the group.
    count: usize,
    /// Orthonormal right and left vectors, q each.
    pub(super) right: Vec<Vector>,
    pub(super) left: Vec<Vector>,
    inverse: Box<Inverse<'a>>,
    /// S_0, S_1, ..., S_K.
    series: Vec<DMatrix<Complex<f64>>>,
    /// |W_0|, ..., |W_K|.
    sizes: Vec<f64>,
    /// Norms of V Q', V M and V.
    outer: [f64; 3],
    /// Residual that the solve for S_0 left of its equation.
    residual: f64,
}

impl<'a> Expansion<'a> {
    /// Around `centre`, for `count` eigenvalues. `None` where the vectors overflow, where too many of them have chains, as they do
    /// where there are more eigenvalues than vectors, and where rounding hides one direction more: |E| is too large for any disc then.
    pub(super) fn new(problem: &'a Scaled, centre: Complex<f64>, count: usize) -> Option<Self> {
        let n = problem.order();
        let factor = Factor::for_several(problem, centre);
        let (mut right, mut left) = factor.null_pairs((count + 1).min(n))?;
        let size = problem.norms.size(centre.norm());
        let singular: Vec<f64> = right.iter().map(|x| factor.residual(x).norm()).collect();
        let jump = |q: usize| singular.get(q).unwrap_or(&size) / singular[q - 1].max(UNIT_ROUNDOFF * size);
        let corank = (1..=count.min(n)).max_by(|&a, &b| jump(a).total_cmp(&jump(b)))?;
        if corank < count && count > LARGEST_CHAINED {
            return None;
        }
        // |E| is the reciprocal of the next singular value at least, which these vectors bound from above.
        let next = singular.iter().take(corank + 1).map(|s| s * s).sum::<f64>().sqrt();
        if corank < n && next <= 2.0 * data_noise(problem, centre.norm()) {
            return None;
        }
        right.truncate(corank);
        left.truncate(corank);
        let bordered = Bordered::new(problem, centre, &right, &left);
        let (terms, series) = bordered.unit_columns();
        let residual = bordered.residual(problem, centre, &terms, &series, &left);
        let first = First { terms, series, rows: bordered.unit_rows(), residual };
        let inverse = Box::new(move |b| bordered.solve(b));
        Some(Self::from_first((problem, centre), count, (right, left), first, inverse))
    }

    /// Around one eigenvalue with its unit vectors, by the factorisation that these were found with.
    pub(super) fn alone(factor: &'a Factor<'a>, x: &'a Vector, y: &'a Vector) -> Self {
        let (problem, centre) = (factor.problem, factor.sigma);
        let e = |b: Vector| factor.deflated_solve(x, y, b);
        let w = x - e(factor.residual(x));
        let image = factor.residual(&w);
        let s = -y.dotc(&image);
        let residual = (image + y * s).norm();
        let v = y - factor.deflated_solve_adjoint(x, y, problem.adjoint_times(centre, y));
        let first = First { terms: vec![w], series: vec![Vector::from_element(1, s)], rows: vec![v.clone()], residual };
        let inverse = move |b: Vector| {
            let lower = Vector::from_element(1, v.dotc(&b));
            (factor.deflated_solve(x, y, b), lower)
        };
        Self::from_first((problem, centre), 1, (vec![x.clone()], vec![y.clone()]), first, Box::new(inverse))
    }

    /// The series continued from its first terms.
    fn from_first(
        (problem, centre): (&'a Scaled, Complex<f64>),
        count: usize,
        (right, left): (Vec<Vector>, Vec<Vector>),
        First { mut terms, mut series, rows, residual }: First,
        inverse: Box<Inverse<'a>>,
    ) -> Self {
        let (n, corank) = (problem.order(), right.len());
        let mut sizes = vec![norm(&terms)];
        let mut series_of = vec![columns(&mut series)];
        let mut before = vec![Vector::zeros(n); corank];
        for _ in 0..if corank == count { 2 } else { count + TERMS_BEYOND } {
            let image = |(w, v): (&Vector, &Vector)| {
                -(problem.mass_times(&(w * (centre * 2.0) + v)) + problem.damping_times(w))
            };
            let images: Vec<_> = terms.iter().zip(&before).map(image).collect();
            before = terms;
            (terms, series) = images.into_iter().map(&inverse).unzip();
            sizes.push(norm(&terms));
            series_of.push(columns(&mut series));
        }
        let outer = [
            norm(&rows.iter().map(|v| problem.derivative_adjoint_times(centre, v)).collect::<Vec<_>>()),
            norm(&rows.iter().map(|v| problem.mass_adjoint_times(v)).collect::<Vec<_>>()),
            norm(&rows),
        ];
        Self { problem, centre, count, right, left, inverse, series: series_of, sizes, outer, residual }
    }

    /// True if there are as many vectors as eigenvalues.
    pub(super) fn is_semisimple(&self) -> bool {
        self.right.len() == self.count
    }

    /// The smallest disc found with a radius between `least` and `most` that holds `count` eigenvalues of every problem within
    /// rounding of this one.
    pub(super) fn disc(&self, least: f64, most: f64) -> Option<Disc> {
        // Without a solve where no norms would do.
        self.disc_by([0.0; 3], least, most)?;
        let e = |g| (self.inverse)(g).0;
        let e_slope = |g: Vector| e(self.problem.derivative_times(self.centre, &g));
        let e_mass = |g: Vector| e(self.problem.mass_times(&g));
        by_norms(self.problem.order(), [&e_slope, &e_mass, &e], |inner| self.disc_by(inner, least, most))
    }

    /// True if |E| alone, as one vector shows it, leaves no disc.
    pub(super) fn is_crowded(&self) -> bool {
        let e = |g| (self.inverse)(g).0;
        let noise = data_noise(self.problem, self.centre.norm());
        SURELY_SHOWN * shown_norm(self.problem.order(), 1, &e) * noise >= 0.5
    }

    /// The smallest disc that is found with these norms of E Q', E M and E, with a radius between `least` and `most`.
    fn disc_by(&self, inner: [f64; 3], least: f64, most: f64) -> Option<Disc> {
        let mut radius = least.max(UNIT_ROUNDOFF * self.centre.norm().max(UNIT_ROUNDOFF));
        while radius <= most {
            // Beyond this the series is not known to converge.
            let contraction = (inner[0] + inner[1] * radius) * radius;
            if contraction > 0.5 {
                return None;
            }
            if let Some(error) = self.error(radius, contraction, inner[2])
                && if self.is_semisimple() {
                    block_rouche(&self.series, radius, error)
                } else {
                    pellet(&self.series, self.count, radius, error)
                }
            {
                return Some(Disc { centre: self.centre, radius });
            }
            radius *= RADIUS_STEP;
        }
        None
    }

    /// Error bound: how much S of a perturbed problem may differ from the polynomial on the circle; none where E P may reach 1.
    fn error(&self, radius: f64, contraction: f64, e: f64) -> Option<f64> {
        let [v_slope, v_mass, v] = self.outer;
        let last = self.sizes.len() - 1;
        let term = |k: usize| self.sizes[k] * radius.powi(k as i32);
        let (w_last, w_before) = (term(last), term(last - 1));
        // |W_k| r^k <= contraction x the larger of the two before it.
        let rest = 2.0 * contraction / (1.0 - contraction) * w_last.max(w_before);
        let (slope, mass) = (v_slope * radius, v_mass * radius * radius);
        let omitted = slope * (w_last + rest) + mass * (w_before + w_last + rest);
        let w: f64 = (0..=last).map(term).sum::<f64>() + rest;
        let e = e / (1.0 - contraction);
        let v = v + (slope + mass) * e;
        let noise = data_noise(self.problem, self.centre.norm() + radius) + self.residual;
        (e * noise < 0.5).then(|| omitted + v * w * noise / (1.0 - e * noise))
    }
}

fn norm(vectors: &[Vector]) -> f64 {
    vectors.iter().map(|v| v.norm_squared()).sum::<f64>().sqrt()
}

fn columns(vectors: &mut [Vector]) -> DMatrix<Complex<f64>> {
    DMatrix::from_columns(vectors)
}

/// `[Q, w Y; w X^H, 0]`, factored; w is of the size of Q.
struct Bordered {
    lu: Lu,
    weight: f64,
    order: usize,
    corank: usize,
}

impl Bordered {
    fn new(s: &Scaled, centre: Complex<f64>, right: &[Vector], left: &[Vector]) -> Self {
        let (order, corank, weight) = (s.order(), right.len(), s.norms.size(centre.norm()));
        let mut matrix = DMatrix::zeros(order + corank, order + corank);
        matrix.view_mut((0, 0), (order, order)).copy_from(&s.polynomial(centre));
        for (k, (x, y)) in right.iter().zip(left).enumerate() {
            matrix.view_mut((0, order + k), (order, 1)).copy_from(&y.scale(weight));
            matrix.view_mut((order + k, 0), (1, order)).copy_from(&x.adjoint().scale(weight));
        }
        Self { lu: Lu::new(&matrix, LEAST_PIVOT), weight, order, corank }
    }

    fn split(&self, solution: Vector) -> (Vector, Vector) {
        let lower = solution.rows(self.order, self.corank).scale(self.weight);
        (solution.rows(0, self.order).into_owned(), lower)
    }

    /// `E b` and `V b`.
    fn solve(&self, b: Vector) -> (Vector, Vector) {
        let mut b = b.insert_rows(self.order, self.corank, Complex::default());
        self.lu.solve(&mut b);
        self.split(b)
    }

    /// The columns of W_0 and of S_0.
    fn unit_columns(&self) -> (Vec<Vector>, Vec<Vector>) {
        let column = |k: usize| {
            let mut b = self.unit(k);
            self.lu.solve(&mut b);
            self.split(b)
        };
        (0..self.corank).map(column).unzip()
    }

    /// The rows of V, adjoint.
    fn unit_rows(&self) -> Vec<Vector> {
        let row = |k: usize| {
            let mut b = self.unit(k);
            self.lu.solve_adjoint(&mut b);
            self.split(b).0
        };
        (0..self.corank).map(row).collect()
    }

    fn unit(&self, k: usize) -> Vector {
        let mut b = Vector::zeros(self.order + self.corank);
        b[self.order + k] = Complex::from(self.weight);
        b
    }

    /// `|Q W_0 + Y S_0|`, which is zero but for rounding.
    fn residual(&self, s: &Scaled, centre: Complex<f64>, w: &[Vector], series: &[Vector], left: &[Vector]) -> f64 {
        let one = |(w, s_0): (&Vector, &Vector)| {
            let image = left.iter().zip(s_0.iter()).fold(s.times(centre, w), |sum, (y, &a)| sum + y * a);
            image.norm_squared()
        };
        w.iter().zip(series).map(one).sum::<f64>().sqrt()
    }
}
