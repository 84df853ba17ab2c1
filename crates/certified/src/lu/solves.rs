//! Solves with the factors, from both sides.

use std::ops::Range;

use num_complex::Complex;
use pulp::Arch;

use super::{Lu, Vector, subtract_complex, subtract_real};

impl Lu {
    /// x := A^-1 x.
    pub fn solve(&self, x: &mut Vector) {
        for (k, &pivot) in self.swaps.iter().enumerate() {
            x.swap_rows(k, pivot);
        }
        self.in_parts(x, Self::substitute_forth_and_back);
    }

    /// x := A^-H x.
    pub fn solve_adjoint(&self, x: &mut Vector) {
        self.in_parts(x, Self::substitute_adjoint);
        for (k, &pivot) in self.swaps.iter().enumerate().rev() {
            x.swap_rows(k, pivot);
        }
    }

    /// Changes x by its real and its imaginary part.
    fn in_parts(&self, x: &mut Vector, change: impl Fn(&Self, [&mut [f64]; 2])) {
        let (mut re, mut im): (Vec<f64>, Vec<f64>) = x.iter().map(|z| (z.re, z.im)).unzip();
        change(self, [&mut re, &mut im]);
        x.iter_mut().zip(re.into_iter().zip(im)).for_each(|(z, (re, im))| *z = Complex::new(re, im));
    }

    fn substitute_forth_and_back(&self, [re, im]: [&mut [f64]; 2]) {
        let n = re.len();
        Arch::new().dispatch(|| {
            for k in 0..n {
                let head = [re[k], im[k]];
                self.subtract_column(k, k + 1..n, head, [&mut re[k + 1..], &mut im[k + 1..]]);
            }
            for k in (0..n).rev() {
                let head = Complex::new(re[k], im[k]) / self.pivot(k);
                (re[k], im[k]) = (head.re, head.im);
                self.subtract_column(k, 0..k, [re[k], im[k]], [&mut re[..k], &mut im[..k]]);
            }
        });
    }

    fn substitute_adjoint(&self, [re, im]: [&mut [f64]; 2]) {
        let n = re.len();
        // The vectors of real eigenvalues.
        let all_real = self.is_real && im.iter().all(|&x| x == 0.0);
        Arch::new().dispatch(|| {
            for k in 0..n {
                let sum = self.adjoint_product(self.column(k, 0..k), [&re[..k], &im[..k]], all_real);
                let head = (Complex::new(re[k], im[k]) - sum) / self.pivot(k).conj();
                (re[k], im[k]) = (head.re, head.im);
            }
            for k in (0..n).rev() {
                let sum = self.adjoint_product(self.column(k, k + 1..n), [&re[k + 1..], &im[k + 1..]], all_real);
                (re[k], im[k]) = (re[k] - sum.re, im[k] - sum.im);
            }
        });
    }

    #[inline(always)]
    fn adjoint_product(&self, l: [&[f64]; 2], [re, im]: [&[f64]; 2], all_real: bool) -> Complex<f64> {
        match (self.is_real, all_real) {
            (true, true) => Complex::from(real_product(l[0], re)),
            (true, false) => Complex::new(real_product(l[0], re), real_product(l[0], im)),
            _ => adjoint_product(l, [re, im]),
        }
    }

    /// x -= `rows` of column k times `head`.
    #[inline(always)]
    fn subtract_column(&self, k: usize, rows: Range<usize>, head: [f64; 2], [re, im]: [&mut [f64]; 2]) {
        let l = self.column(k, rows);
        if self.is_real {
            subtract_real(re, l[0], head[0]);
            // The vectors of real eigenvalues.
            if head[1] != 0.0 {
                subtract_real(im, l[0], head[1]);
            }
        } else {
            subtract_complex([re, im], l, head);
        }
    }

    fn pivot(&self, k: usize) -> Complex<f64> {
        let [re, im] = &self.parts;
        Complex::new(re[(k, k)], im[(k, k)])
    }

    /// The real and the imaginary parts of `rows` of column k.
    fn column(&self, k: usize, rows: Range<usize>) -> [&[f64]; 2] {
        let start = k * self.order();
        [0, 1].map(|part| &self.parts[part].as_slice()[start + rows.start..start + rows.end])
    }
}

/// Sums that an inner product has side by side, of the entries whose positions differ by multiples of this number: the same on
/// all processors.
const SUMS: usize = 8;

/// The sum of the conjugate entries of l times those of x.
#[inline(always)]
fn adjoint_product([l_re, l_im]: [&[f64]; 2], [re, im]: [&[f64]; 2]) -> Complex<f64> {
    let mut sums = [[0.0; SUMS]; 2];
    let mut add = |k: usize, l_re: f64, l_im: f64, re: f64, im: f64| {
        sums[0][k] += l_re * re + l_im * im;
        sums[1][k] += l_re * im - l_im * re;
    };
    let [(l_re, l_re_rest), (l_im, l_im_rest), (re, re_rest), (im, im_rest)] =
        [l_re, l_im, re, im].map(<[f64]>::as_chunks::<SUMS>);
    for (((l_re, l_im), re), im) in l_re.iter().zip(l_im).zip(re).zip(im) {
        (0..SUMS).for_each(|k| add(k, l_re[k], l_im[k], re[k], im[k]));
    }
    for (k, &l_re) in l_re_rest.iter().enumerate() {
        add(k, l_re, l_im_rest[k], re_rest[k], im_rest[k]);
    }
    Complex::new(sums[0].iter().sum(), sums[1].iter().sum())
}

/// The sum of the products of real entries.
#[inline(always)]
pub(crate) fn real_product(l: &[f64], x: &[f64]) -> f64 {
    let mut sums = [0.0; SUMS];
    let [(l, l_rest), (x, x_rest)] = [l, x].map(<[f64]>::as_chunks::<SUMS>);
    for (l, x) in l.iter().zip(x) {
        (0..SUMS).for_each(|k| sums[k] += l[k] * x[k]);
    }
    l_rest.iter().zip(x_rest).zip(&mut sums).for_each(|((l, x), sum)| *sum += l * x);
    sums.iter().sum()
}
