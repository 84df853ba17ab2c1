//! The kernels on plain matrices, against known eigenvalues or another solver.

use nalgebra::{DMatrix, DVector, linalg::Schur};
use num_complex::Complex;
use pulp::Scalar;

use super::*;

/// Runs the kernels on matrices of one size.
struct OnMatrices<'a>(&'a [DMatrix<f64>]);

impl WithSimd for OnMatrices<'_> {
    type Output = Vec<Option<Vec<Complex<f64>>>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let (o, lanes) = (Ops::new(simd), S::F64_LANES);
        let layout = Layout::new(self.0[0].nrows());
        let mut found = Vec::new();
        for matrices in self.0.chunks(lanes) {
            let mut a = vec![o.splat(0.0); layout.len()];
            let entries: &mut [f64] = bytemuck::cast_slice_mut(&mut a);
            for (lane, matrix) in matrices.iter().enumerate() {
                for (at, &x) in matrix.iter().enumerate() {
                    let (i, j) = (at % layout.order, at / layout.order);
                    entries[layout.at(i, j) * lanes + lane] = x;
                }
            }
            let mut vectors = vec![o.splat(0.0); hessenberg::scratch_len(layout)];
            hessenberg::reduce(o, &mut a, layout, &mut vectors);
            let failed = iterate::iterate(o, &mut a, layout);
            let entries: &[f64] = bytemuck::cast_slice(&a);
            for (lane, failed) in failed.into_iter().enumerate().take(matrices.len()) {
                let at = |i, j| entries[layout.at(i, j) * lanes + lane];
                found.push((!failed).then(|| diagonal::eigenvalues(layout.order, at)));
            }
        }
        found
    }
}

fn eigenvalues(matrix: &DMatrix<f64>) -> Vec<Complex<f64>> {
    Arch::new().dispatch(OnMatrices(std::slice::from_ref(matrix))).remove(0).unwrap()
}

/// Largest distance in a matching of two sets, where each eigenvalue takes the nearest one left; correct if the sets nearly agree.
fn distance(found: &[Complex<f64>], expected: &[Complex<f64>]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let mut left = expected.to_vec();
    let mut worst: f64 = 0.0;
    for x in found {
        let (at, near) = left.iter().map(|y| (x - y).norm()).enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        worst = worst.max(near);
        left.swap_remove(at);
    }
    worst
}

/// Pseudo-random numbers in [-1, 1).
fn noise(rows: usize, columns: usize, seed: u64) -> DMatrix<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    DMatrix::from_fn(rows, columns, |_, _| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    })
}

fn real(values: impl IntoIterator<Item = f64>) -> Vec<Complex<f64>> {
    values.into_iter().map(Complex::from).collect()
}

#[test]
fn agrees_with_nalgebra_on_random_matrices_of_every_small_size() {
    for n in (1..30).chain([60, 69, 101]) {
        let matrix = noise(n, n, n as u64);
        let schur = Schur::try_new(matrix.clone(), f64::EPSILON, 10_000).unwrap();
        let error = distance(&eigenvalues(&matrix), schur.complex_eigenvalues().as_slice());
        assert!(error < 1e-12 * matrix.norm(), "n = {n}: {error:e}");
    }
}

#[test]
fn companion_matrices_give_back_the_roots() {
    // (x - 1)(x - 2) .. (x - 8), and x^n = 1, on which QR without exceptional shifts makes no progress.
    let mut coefficients = vec![1.0];
    for root in 1..=8 {
        let mut next = vec![0.0; coefficients.len() + 1];
        for (k, c) in coefficients.iter().enumerate() {
            next[k + 1] += c;
            next[k] -= f64::from(root) * c;
        }
        coefficients = next;
    }
    let companion = |low: &[f64]| {
        let n = low.len();
        DMatrix::from_fn(n, n, |i, j| if j + 1 == n { -low[i] } else { f64::from(u8::from(i == j + 1)) })
    };
    let found = eigenvalues(&companion(&coefficients[..8]));
    assert!(distance(&found, &real((1..=8).map(f64::from))) < 1e-6, "{found:?}");

    for n in [3, 4, 5, 8, 17, 30] {
        let mut low = vec![0.0; n];
        low[0] = -1.0;
        let roots: Vec<_> =
            (0..n).map(|k| Complex::from_polar(1.0, std::f64::consts::TAU * k as f64 / n as f64)).collect();
        assert!(distance(&eigenvalues(&companion(&low)), &roots) < 1e-13, "n = {n}");
    }
}

#[test]
fn triangular_matrices_have_their_diagonal() {
    for n in [1, 2, 3, 9, 24] {
        // The off-diagonal entries are small: a random triangular matrix has ill-conditioned eigenvalues.
        let upper = noise(n, n, 5).upper_triangle().map_with_location(|i, j, x| if i == j { x } else { 0.1 * x });
        let diagonal = real(upper.diagonal().iter().copied());
        assert_eq!(distance(&eigenvalues(&upper), &diagonal), 0.0);
        assert!(distance(&eigenvalues(&upper.transpose()), &diagonal) < 1e-12, "n = {n}");
    }
    assert!(eigenvalues(&DMatrix::zeros(7, 7)).iter().all(|x| x.norm() == 0.0));
}

#[test]
fn multiple_eigenvalues_stay_multiple_where_they_are_well_conditioned() {
    // H D H with H = I - 2 h h^T exactly orthogonal up to rounding, D with multiplicities 5, 4 and 1.
    let h = DVector::from_element(10, 1.0 / 10f64.sqrt());
    let reflection = DMatrix::identity(10, 10) - 2.0 * &h * h.transpose();
    let values = [1.0, 1.0, 1.0, 1.0, 1.0, -3.0, -3.0, -3.0, -3.0, 7.0];
    let matrix = &reflection * DMatrix::from_diagonal(&DVector::from_row_slice(&values)) * &reflection;
    assert!(distance(&eigenvalues(&matrix), &real(values)) < 1e-13);

    // Four equal 3 x 3 blocks on the diagonal.
    let block = noise(3, 3, 11);
    let copies = DMatrix::from_fn(12, 12, |i, j| if i / 3 == j / 3 { block[(i % 3, j % 3)] } else { 0.0 });
    let one = eigenvalues(&block);
    assert!(distance(&eigenvalues(&copies), &one.repeat(4)) < 1e-13);
}

#[test]
fn defective_eigenvalues_move_no_more_than_theory_allows() {
    // A Jordan block of size k moves by (rounding)^(1/k).
    for k in 2..=5 {
        let turn = noise(k, k, 3).qr().q();
        let jordan = DMatrix::from_fn(k, k, |i, j| if i == j { 2.0 } else { f64::from(u8::from(j == i + 1)) });
        let found = eigenvalues(&(&turn * jordan * turn.transpose()));
        let error = distance(&found, &vec![Complex::from(2.0); k]);
        assert!(error < 2.0 * (16.0 * f64::EPSILON).powf(1.0 / k as f64), "k = {k}: {error:e}");
    }
}

#[test]
fn a_graded_matrix_keeps_normwise_accuracy() {
    let scale = |i: usize| 10f64.powi(-(i as i32));
    let matrix = noise(12, 12, 8).map_with_location(|i, j, x| x * scale(i) * scale(j));
    let schur = Schur::try_new(matrix.clone(), f64::EPSILON, 10_000).unwrap();
    let error = distance(&eigenvalues(&matrix), schur.complex_eigenvalues().as_slice());
    assert!(error < 1e-14 * matrix.norm(), "{error:e}");
}

#[test]
fn a_lane_that_never_converges_is_reported_and_disturbs_nobody() {
    let mut matrices: Vec<_> = (0..11).map(|seed| noise(9, 9, seed)).collect();
    let alone: Vec<_> = matrices.iter().map(eigenvalues).collect();
    matrices[4][(8, 0)] = f64::NAN;
    let found = Arch::new().dispatch(OnMatrices(&matrices));
    for (k, (found, alone)) in found.iter().zip(&alone).enumerate() {
        assert_eq!(found.as_ref(), (k != 4).then_some(alone), "sample {k}");
    }
}

#[test]
fn instruction_sets_with_fused_multiply_add_agree_to_the_bit_and_the_others_nearly() {
    let matrices: Vec<_> = (0..8).map(|seed| noise(31, 31, seed)).collect();
    let best = Arch::new().dispatch(OnMatrices(&matrices));
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        assert_eq!(Simd::vectorize(avx2, OnMatrices(&matrices)), best);
    }
    for (best, portable) in best.iter().zip(Simd::vectorize(Scalar, OnMatrices(&matrices))) {
        assert!(distance(best.as_ref().unwrap(), &portable.unwrap()) < 1e-12);
    }
}

#[test]
fn sums_of_eigenvalues_and_of_their_squares_are_traces() {
    for n in [3, 4, 6, 7, 12, 40] {
        let of_kind = |kind: u64, seed: u64| {
            let a = noise(n, n, 6 * seed + kind);
            match kind {
                0 => &a + a.transpose(),
                1 => &a - a.transpose(),
                2 => a.map(|x| (2.0 * x).round()),
                3 => a.map(|x| if x > 0.6 { x } else { 0.0 }),
                4 => a.qr().q(),
                _ => a.map(|x| (3.0 * x).exp() * x.signum()),
            }
        };
        for kind in 0..6 {
            let matrices: Vec<_> = (0..16).map(|seed| of_kind(kind, seed)).collect();
            for (matrix, found) in matrices.iter().zip(Arch::new().dispatch(OnMatrices(&matrices))) {
                let (size, found) = (matrix.norm(), found.unwrap());
                let first: Complex<f64> = found.iter().sum();
                let second: Complex<f64> = found.iter().map(|x| x * x).sum();
                assert!((first - matrix.trace()).norm() < 1e-13 * size, "n = {n}, kind {kind}");
                assert!((second - (matrix * matrix).trace()).norm() < 1e-13 * size * size, "n = {n}, kind {kind}");
            }
        }
    }
}
