//! The shapes of modes in the coordinates of the reduced system.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use crate::dense;
use crate::rows::{Rows, add_rows};
use crate::split;
use cea::certified::lanes::{Ops, Precision, cast, splat};

/// An eigenvalue with its shape in the coordinates of the system.
pub(super) type Pair = (Complex<f64>, DVector<Complex<f64>>);

/// A mode that was found, by what its shape is made of.
#[derive(Debug, Clone)]
pub(super) struct Found {
    /// rad/s.
    pub lambda: Complex<f64>,
    /// Of the near modes.
    pub amplitudes: Vec<Complex<f64>>,
    /// Of the ports.
    pub forces: Vec<Complex<f64>>,
}

/// What the shapes of k degrees of freedom are made of: the right vectors of the structure, of which most come in conjugate pairs, by their real
/// and imaginary parts.
#[derive(Debug, Clone)]
pub(super) struct Shapes<T = f64> {
    /// k.
    pub order: usize,
    /// The parts as rows, each with room for whole registers.
    parts: Vec<T>,
    stride: usize,
    /// Where the near modes and the others have theirs.
    near: Vec<Place>,
    others: Vec<(Complex<f64>, Place)>,
    /// `(V^H B)^T` of the others, by ports.
    others_force: Rows<T>,
}

/// The row of the real part of a vector; the imaginary part is the next, times this. The vector of a real eigenvalue has none.
#[derive(Debug, Clone, Copy)]
struct Place {
    row: usize,
    sign: Option<f64>,
}

impl Shapes {
    /// With the eigenvalues, rad/s, and right vectors of the structure, k x 2 k, `V^H B` of all, and which are near and which are not.
    pub fn new(
        lambdas: &[Complex<f64>],
        right: &DMatrix<Complex<f64>>,
        driven: &DMatrix<Complex<f64>>,
        [near, others]: [&[usize]; 2],
    ) -> Self {
        let order = right.nrows();
        let stride = order.next_multiple_of(f64::WIDEST);
        let (mut parts, mut places): (Vec<f64>, Vec<Place>) = (Vec::new(), Vec::new());
        let push = |parts: &mut Vec<f64>, column: usize, part: fn(&Complex<f64>) -> f64| {
            let row = parts.len() / stride;
            parts.extend(right.column(column).iter().map(part));
            parts.resize((row + 1) * stride, 0.0);
            row
        };
        while places.len() < lambdas.len() {
            let at = places.len();
            let row = push(&mut parts, at, |entry| entry.re);
            if lambdas[at].im == 0.0 {
                places.push(Place { row, sign: None });
                continue;
            }
            push(&mut parts, at, |entry| entry.im);
            places.push(Place { row, sign: Some(1.0) });
            let is_conjugate = |next: usize| {
                lambdas[next] == lambdas[at].conj()
                    && right.column(at).iter().eq(right.column(next).map(|b| b.conj()).iter())
            };
            if at + 1 < lambdas.len() && is_conjugate(at + 1) {
                places.push(Place { row, sign: Some(-1.0) });
            }
        }
        Self {
            order,
            parts,
            stride,
            near: near.iter().map(|&at| places[at]).collect(),
            others: others.iter().map(|&at| (lambdas[at], places[at])).collect(),
            others_force: Rows::from_fn(driven.ncols(), others.len(), |port, at| driven[(others[at], port)]),
        }
    }

    /// The shapes of some modes, split: [`Shapes::shape`] of each, by one product of matrices.
    pub fn shapes(&self, modes: &[&Found]) -> DMatrix<f64> {
        let mut factors = split::zeros(self.parts.len() / self.stride.max(1), modes.len());
        for (at, Found { lambda, amplitudes, forces }) in modes.iter().enumerate() {
            split::set(&mut factors, at, self.factors(*lambda, amplitudes, forces).into_iter());
        }
        dense::product_of_columns(&self.parts, [self.order, self.stride], &factors)
    }

    /// The same in single precision.
    pub fn single(&self) -> Shapes<f32> {
        let stride = self.order.next_multiple_of(f32::WIDEST);
        let mut parts = Vec::with_capacity(self.parts.len() / self.stride.max(1) * stride);
        for row in self.parts.chunks_exact(self.stride.max(1)) {
            parts.extend(row[..self.order].iter().map(|&entry| entry as f32));
            parts.resize(parts.len().next_multiple_of(stride), 0.0);
        }
        Shapes {
            order: self.order,
            parts,
            stride,
            near: self.near.clone(),
            others: self.others.clone(),
            others_force: self.others_force.single(),
        }
    }
}

impl<T: Precision> Shapes<T> {
    /// The shape `Y d - F B c` of amplitudes d of the near modes and forces c.
    pub fn shape(&self, lambda: Complex<f64>, d: &[Complex<T>], forces: &[Complex<T>]) -> DVector<Complex<f64>> {
        let factors = self.factors(lambda, d, forces);
        let mut shape = Rows::zeros(1, self.order);
        Arch::new().dispatch(Sum { factors: &factors, parts: &self.parts, stride: self.stride, out: &mut shape });
        DVector::from_fn(self.order, |at, _| cast(shape.at(0, at)))
    }

    /// What the parts are multiplied by in a shape.
    fn factors(&self, lambda: Complex<f64>, d: &[Complex<T>], forces: &[Complex<T>]) -> Vec<Complex<T>> {
        let mut driven = Rows::zeros(1, self.others.len());
        add_rows(0, forces, &self.others_force, &mut driven);
        let mut factors = vec![Complex::default(); self.parts.len() / self.stride.max(1)];
        let mut add = |Place { row, sign }: Place, amplitude: Complex<T>| {
            factors[row] += amplitude;
            if let Some(sign) = sign {
                factors[row + 1] += Complex::new(-amplitude.im, amplitude.re) * T::of(sign);
            }
        };
        self.near.iter().zip(d).for_each(|(&place, &amplitude)| add(place, amplitude));
        for (at, &(other, place)) in self.others.iter().enumerate() {
            add(place, -driven.at(0, at) * cast::<f64, T>((lambda - other).inv()));
        }
        factors
    }
}

/// The sum of complex multiples of real rows.
struct Sum<'a, T> {
    factors: &'a [Complex<T>],
    parts: &'a [T],
    stride: usize,
    out: &'a mut Rows<T>,
}

impl<T: Precision> WithSimd for Sum<'_, T> {
    type Output = ();

    /// Sums stay in registers, two of each part side by side.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { factors, parts, stride, out } = self;
        let (o, parts, stride) = (Ops::of(simd), T::registers::<S>(parts), stride / T::width::<S>());
        let [re, im] = out.registers_mut(simd);
        for (first, (re, im)) in re.chunks_mut(2).zip(im.chunks_mut(2)).enumerate() {
            let mut sums = [[o.splat(T::default()); 2]; 2];
            for (row, factor) in factors.iter().enumerate() {
                let [by_re, by_im] = splat(o, *factor);
                let of_row = &parts[row * stride + 2 * first..][..re.len()];
                for (part, sum) in of_row.iter().zip(&mut sums) {
                    sum[0] = o.fma(by_re, *part, sum[0]);
                    sum[1] = o.fma(by_im, *part, sum[1]);
                }
            }
            re.iter_mut().zip(im).zip(sums).for_each(|((re, im), sum)| [*re, *im] = sum);
        }
    }
}
