//! The characteristic function at many numbers at once, one in each lane of vector registers: on a line around the band, and at guesses.
//!
//! A is nearly diagonal in the coordinates of an anchor, so that elimination takes the pivots as they come, at a guess that of its own mode
//! last. Where that loses digits the modes are not counted, and the sample goes another way. One matrix in each lane and no pivoting: so this is
//! no [`Elimination`](crate::elimination::Elimination), whose lanes hold neighbours of one row.

use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::table::Table;
use crate::rows::Rows;
use cea::certified::lanes::{ComplexLanes, Ops, Precision, cast, fma, fnma, splat, times};

/// Numbers at once: as many as the widest register has.
const AT_ONCE: usize = f32::WIDEST;
/// Fewest points of the line; chosen. It takes the lanes that guesses leave.
const FEWEST_POINTS: usize = 8;

/// A line around the band: both sides of it, at a distance.
#[derive(Debug, Clone)]
pub(super) struct Around {
    /// Frequencies, rad/s.
    pub band: [f64; 2],
    /// rad/s.
    pub distance: f64,
}

impl Around {
    /// An even number of points of both sides.
    fn points(&self, count: usize) -> impl Iterator<Item = Complex<f64>> {
        let ([low, high], distance, side) = (self.band, self.distance, count / 2);
        let along = move |n: usize| low + (high - low) * n as f64 / (side - 1) as f64;
        (0..2 * side).map(move |n| Complex::new(if n < side { -distance } else { distance }, along(n % side)))
    }
}

/// `det(lambda - A(lambda)) / prod_j (lambda - z_j)`.
pub(super) struct Lacking {
    /// At each of the z_j, without its own factor.
    pub at_zeros: Vec<Complex<f64>>,
    /// On a line.
    pub around: Vec<Complex<f64>>,
}

/// A number at which the characteristic function is wanted: one of the zeros, or another.
#[derive(Debug, Clone, Copy)]
enum Number {
    Zero(usize),
    Other(Complex<f64>),
}

/// Working memory.
pub(super) struct Lanes {
    /// The entries of p x p matrices, by rows.
    matrix: Rows<f32>,
    /// What each pivot is divided by.
    divisors: Rows<f32>,
    /// The numbers as a row, and the weights of the points of a table there, with a minus, by rows.
    numbers: Rows<f32>,
    weights: Rows<f32>,
    ratios: Rows<f32>,
}

impl Lanes {
    /// For p zeros, and a table with this number of points.
    pub fn new(p: usize, points: usize) -> Self {
        let [matrix, divisors, numbers, weights, ratios] =
            [p * p, p, 1, points, 1].map(|rows| Rows::zeros(rows, AT_ONCE));
        Self { matrix, divisors, numbers, weights, ratios }
    }

    /// What is lacking at all zeros and on a line, from A at the points of a table.
    pub fn lacking<T>(
        &mut self,
        table: &Table<T>,
        values: &[Rows<f32>],
        zeros: &[Complex<f64>],
        line: &Around,
    ) -> Lacking {
        if zeros.is_empty() {
            return Lacking { at_zeros: Vec::new(), around: Vec::new() };
        }
        let lanes = (zeros.len() + FEWEST_POINTS).next_multiple_of(AT_ONCE);
        let points = line.points(lanes - zeros.len()).map(Number::Other);
        let numbers: Vec<Number> = (0..zeros.len()).map(Number::Zero).chain(points).collect();
        let mut found = Lacking { at_zeros: Vec::with_capacity(zeros.len()), around: Vec::with_capacity(lanes) };
        for numbers in numbers.chunks(AT_ONCE) {
            self.evaluate(table, values, zeros, numbers);
            for (lane, number) in numbers.iter().enumerate() {
                let ratio = cast(self.ratios.at(0, lane));
                match number {
                    Number::Zero(_) => found.at_zeros.push(ratio),
                    Number::Other(_) => found.around.push(ratio),
                }
            }
        }
        found
    }

    /// The ratios at some numbers, no more than lanes.
    fn evaluate<T>(&mut self, table: &Table<T>, values: &[Rows<f32>], zeros: &[Complex<f64>], at: &[Number]) {
        let (order, last) = (zeros.len(), zeros.len() - 1);
        let mut weights = Vec::with_capacity(table.points.len());
        for (lane, &number) in at.iter().enumerate() {
            let (lambda, own) = match number {
                Number::Zero(zero) => (zeros[zero], Some(zero)),
                Number::Other(lambda) => (lambda, None),
            };
            table.weights_at(lambda, &mut weights);
            weights.iter().enumerate().for_each(|(n, &weight)| self.weights.set(n, lane, cast(-weight)));
            self.numbers.set(0, lane, cast(lambda));
            zeros.iter().enumerate().for_each(|(c, zero)| self.divisors.set(c, lane, cast(lambda - zero)));
            if let Some(own) = own {
                let of_last = self.divisors.at(last, lane);
                self.divisors.set(own, lane, of_last);
                self.divisors.set(last, lane, Complex::from(1.0));
            }
        }
        let Self { matrix, divisors, numbers, weights, ratios } = self;
        Arch::new().dispatch(Build { numbers, weights, values, order, matrix });
        for (lane, &number) in at.iter().enumerate() {
            let Number::Zero(own) = number else { continue };
            (0..order).for_each(|other| matrix.swap([own * order + other, last * order + other], lane));
            (0..order).for_each(|other| matrix.swap([other * order + own, other * order + last], lane));
        }
        Arch::new().dispatch(Eliminate { order, matrix, divisors, ratios });
    }
}

/// `lambda - A(lambda)`.
struct Build<'a> {
    numbers: &'a Rows<f32>,
    weights: &'a Rows<f32>,
    values: &'a [Rows<f32>],
    order: usize,
    matrix: &'a mut Rows<f32>,
}

impl WithSimd for Build<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (o, Self { numbers, weights, values, order, matrix }) = (Ops::of(simd), self);
        let [row_re, row_im] = numbers.registers(simd);
        let [weights_re, weights_im] = weights.registers(simd);
        let [out_re, out_im] = matrix.registers_mut(simd);
        let parts = AT_ONCE / S::F32_LANES;
        for row in 0..order {
            for column in 0..order {
                let start = (row * order + column) * parts;
                for part in 0..parts {
                    let zero = o.splat(0.0);
                    let mut entry = if row == column { [row_re[part], row_im[part]] } else { [zero, zero] };
                    let weights =
                        weights_re[part..].iter().step_by(parts).zip(weights_im[part..].iter().step_by(parts));
                    for (value, (&re, &im)) in values.iter().zip(weights) {
                        entry = fma(o, splat(o, value.at(row, column)), [re, im], entry);
                    }
                    [out_re[start + part], out_im[start + part]] = entry;
                }
            }
        }
    }
}

/// The product of all pivots, each over its divisor.
struct Eliminate<'a> {
    order: usize,
    matrix: &'a mut Rows<f32>,
    divisors: &'a Rows<f32>,
    ratios: &'a mut Rows<f32>,
}

impl WithSimd for Eliminate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (o, Self { order, matrix, divisors, ratios }) = (Ops::of(simd), self);
        let [re, im] = matrix.registers_mut(simd);
        let [divisors_re, divisors_im] = divisors.registers(simd);
        let [ratios_re, ratios_im] = ratios.registers_mut(simd);
        let parts = AT_ONCE / S::F32_LANES;
        for part in 0..parts {
            let mut ratio = splat(o, Complex::from(1.0));
            for c in 0..order {
                let place = (c * order + c) * parts + part;
                let pivot = [re[place], im[place]];
                // Factor by factor, so that no product of many large numbers overflows.
                let expected = inverse(o, [divisors_re[c * parts + part], divisors_im[c * parts + part]]);
                ratio = times(o, ratio, times(o, pivot, expected));
                let inverse = inverse(o, pivot);
                for row in c + 1..order {
                    let start = row * order * parts;
                    let (above_re, below_re) = re.split_at_mut(start);
                    let (above_im, below_im) = im.split_at_mut(start);
                    let first = c * parts + part;
                    let factor = times(o, [below_re[first], below_im[first]], inverse);
                    let above = (c * order + c + 1) * parts + part..(c + 1) * order * parts;
                    let below = first + parts..order * parts;
                    let above = above_re[above.clone()].iter().zip(&above_im[above]).step_by(parts);
                    let below = below_re[below.clone()].iter_mut().zip(&mut below_im[below]).step_by(parts);
                    for ((above_re, above_im), (re, im)) in above.zip(below) {
                        [*re, *im] = fnma(o, factor, [*above_re, *above_im], [*re, *im]);
                    }
                }
            }
            [ratios_re[part], ratios_im[part]] = ratio;
        }
    }
}

/// `1 / a`.
#[inline(always)]
fn inverse<S: Simd>(o: Ops<S, f32>, a: ComplexLanes<S, f32>) -> ComplexLanes<S, f32> {
    let size = o.fma(a[1], a[1], o.mul(a[0], a[0]));
    [o.div(a[0], size), o.div(o.neg(a[1]), size)]
}
