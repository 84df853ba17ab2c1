//! Shifts of the QR iteration: two eigenvalues of the trailing 4 x 4 block.
//!
//! The two eigenvalues nearest to the last diagonal entry are the zeros of a quadratic factor of the block's characteristic
//! polynomial. Bairstow's iteration (Newton's method for the factor) finds it in a few vector operations, from the polynomial of
//! the trailing 2 x 2 block. Against the customary shifts, the eigenvalues of the 2 x 2 block, this saves a fifth of the sweeps
//! (60 x 60, friction lattice). Shifts decide how fast the iteration converges, not the limit: a poor factor only costs time.

use certified::lanes::Ops;
use pulp::Simd;

/// Newton steps for the factor; measured: the third saves 2 % of the sweeps, the fourth half a per cent.
const NEWTON_STEPS: usize = 4;

/// Two shifts `mean +- sqrt(square)`: one form for complex and real pairs.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShiftPair<V> {
    pub mean: V,
    pub square: V,
}

/// The pair for each lane from its trailing block `g`, rows by columns. Lanes outside the mask `four` have only the trailing
/// 2 x 2 part of `g` and take its eigenvalues.
#[inline(always)]
pub(super) fn shift_pair<S: Simd>(o: Ops<S>, g: &[[S::f64s; 4]; 4], four: S::m64s) -> ShiftPair<S::f64s> {
    // In the variable mu = lambda - corner, because near convergence the wanted roots are then small and keep their digits.
    let corner = g[3][3];
    let (a, b, c) = (o.sub(g[0][0], corner), o.sub(g[1][1], corner), o.sub(g[2][2], corner));
    let (e1, e2, e3) = (g[1][0], g[2][1], g[3][2]);

    // Characteristic polynomials of the trailing blocks, each from the smaller ones (Hessenberg determinants):
    // mu^2 + u mu + v, then mu^3 + q2 mu^2 + q1 mu + q0, then mu^4 + c3 mu^3 + c2 mu^2 + c1 mu + c0.
    let (u2, v2) = (o.neg(c), o.neg(o.mul(e3, g[2][3])));
    let q2 = o.sub(u2, b);
    let q1 = o.fnma(g[1][2], e2, o.fnma(b, u2, v2));
    let q0 = o.fnma(o.mul(g[1][3], e2), e3, o.neg(o.mul(b, v2)));
    let (f1, f2) = (o.mul(g[0][1], e1), o.mul(g[0][2], o.mul(e1, e2)));
    let c3 = o.sub(q2, a);
    let c2 = o.sub(o.fnma(a, q2, q1), f1);
    let c1 = o.sub(o.fnma(f1, u2, o.fnma(a, q1, q0)), f2);
    let c0 = o.fnma(o.mul(g[0][3], e1), o.mul(e2, e3), o.fnma(f1, v2, o.neg(o.mul(a, q0))));

    let (mut u, mut v) = (u2, v2);
    for _ in 0..NEWTON_STEPS {
        // Quotient mu^2 + b1 mu + b0 and remainder r1 mu + r0 of the division by the factor; d1, d0 the
        // remainder of the quotient by it again, which gives the derivatives.
        let b1 = o.sub(c3, u);
        let b0 = o.sub(o.fnma(u, b1, c2), v);
        let r1 = o.fnma(v, b1, o.fnma(u, b0, c1));
        let r0 = o.fnma(v, b0, c0);
        let (d1, d0) = (o.sub(b1, u), o.sub(b0, v));
        let e = o.fnma(u, d1, d0);
        let vd = o.mul(v, d1);
        let inverse = o.div(o.splat(1.0), o.fma(e, d0, o.mul(vd, d1)));
        u = o.fma(o.fnma(r0, d1, o.mul(r1, d0)), inverse, u);
        v = o.fma(o.fma(e, r0, o.mul(vd, r1)), inverse, v);
    }

    // Newton's method may diverge or divide by zero: only roots of the size of the block are accepted.
    let diagonal = o.max(o.abs(a), o.max(o.abs(b), o.abs(c)));
    let below = o.max(o.abs(e1), o.max(o.abs(e2), o.abs(e3)));
    let most = o.mul(o.splat(8.0), o.max(diagonal, below));
    let good = o.and(o.le(o.abs(u), most), o.le(o.abs(v), o.mul(most, most)));
    let good = o.and(four, good);
    let (u, v) = (o.select(good, u, u2), o.select(good, v, v2));
    let half = o.mul(o.splat(-0.5), u);
    ShiftPair { mean: o.add(half, corner), square: o.sub(o.mul(half, half), v) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::Scalar;

    #[test]
    fn the_pair_is_an_exact_factor_of_the_block() {
        // Companion matrix of (x^2 - 0.2 x + 1)(x^2 - 10 x + 30), Hessenberg; the corner is nearer to the first factor.
        let product = [30.0, -16.0, 33.0, -10.2];
        let mut g = [[0.0; 4]; 4];
        for (i, row) in g.iter_mut().enumerate() {
            if i > 0 {
                row[i - 1] = 1.0;
            }
            row[3] = -product[i];
        }
        let pair = shift_pair(Ops::new(Scalar), &g, true);
        let factors = [(0.1, 0.01 - 1.0), (5.0, 25.0 - 30.0)];
        let error = |(mean, square): (f64, f64)| (pair.mean - mean).abs() + (pair.square - square).abs();
        assert!(factors.into_iter().map(error).fold(f64::MAX, f64::min) < 1e-6, "{pair:?}");
    }

    #[test]
    fn a_small_block_takes_the_eigenvalues_of_its_corner() {
        let mut g = [[f64::NAN; 4]; 4];
        (g[2][2], g[2][3], g[3][2], g[3][3]) = (1.0, -4.0, 1.0, 1.0);
        let pair = shift_pair(Ops::new(Scalar), &g, false);
        assert_eq!((pair.mean, pair.square), (1.0, -4.0));
    }
}
