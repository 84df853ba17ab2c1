//! The characteristic function at many numbers at once, one in each lane of vector registers: on a line around the band, and at guesses.
//!
//! A is nearly diagonal in the coordinates of an anchor, so that elimination takes the pivots as they come, at a guess that of its own mode
//! last. Where that loses digits the modes are not counted, and the sample goes another way.

use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::real::{Real, cast};
use super::rows::Rows;
use super::table::Table;

/// Numbers at once: as many as the widest register has.
pub(super) const AT_ONCE: usize = f32::WIDEST;

/// Numbers, and how A is read off there.
#[derive(Debug, Clone)]
struct Numbers {
    /// lambda, rad/s.
    exact: Vec<Complex<f64>>,
    /// The same as a row.
    row: Rows<f32>,
    /// The weights of the points of the table, with a minus, by rows.
    weights: Rows<f32>,
}

impl Numbers {
    fn new<T>(exact: Vec<Complex<f64>>, table: &Table<T>) -> Self {
        let mut weights = Rows::zeros(table.points.len(), AT_ONCE);
        let mut here = Vec::new();
        for (lane, &number) in exact.iter().enumerate() {
            table.weights_at(number, &mut here);
            here.iter().enumerate().for_each(|(n, &weight)| weights.set(n, lane, cast(-weight)));
        }
        let row = Rows::from_fn(1, exact.len(), |_, lane| cast(exact[lane]));
        Self { exact, row, weights }
    }
}

/// A line around the band.
#[derive(Debug, Clone)]
pub(super) struct Around(Numbers);

impl Around {
    /// Both sides of a band of frequencies, rad/s, at a distance.
    pub fn new<T>([low, high]: [f64; 2], distance: f64, table: &Table<T>) -> Self {
        let side = AT_ONCE / 2;
        let number = |point: usize| {
            let part = (point % side) as f64 / (side - 1) as f64;
            Complex::new(if point < side { -distance } else { distance }, low + (high - low) * part)
        };
        Self(Numbers::new((0..AT_ONCE).map(number).collect(), table))
    }
}

/// Working memory.
pub(super) struct Lanes {
    /// The entries of p x p matrices, by rows.
    matrix: Rows<f32>,
    divisors: Rows<f32>,
    ratios: Rows<f32>,
}

impl Lanes {
    pub fn new(p: usize) -> Self {
        let [matrix, divisors, ratios] = [p * p, p, 1].map(|rows| Rows::zeros(rows, AT_ONCE));
        Self { matrix, divisors, ratios }
    }

    /// `det(lambda - A(lambda)) / prod_j (lambda - z_j)` on a line, from A at the points of its table.
    pub fn around<'a>(
        &'a mut self,
        line: &Around,
        values: &[Rows<f32>],
        zeros: &[Complex<f64>],
    ) -> impl Iterator<Item = Complex<f32>> + 'a {
        let Around(numbers) = line;
        for (lane, number) in numbers.exact.iter().enumerate() {
            zeros.iter().enumerate().for_each(|(c, zero)| self.divisors.set(c, lane, cast(number - zero)));
        }
        self.ratios(numbers, values, zeros.len(), &[]);
        (0..AT_ONCE).map(|lane| self.ratios.at(0, lane))
    }

    /// The same at some of the z_j, no more than [`AT_ONCE`], each without its own factor.
    pub fn lacking<'a, T>(
        &'a mut self,
        table: &Table<T>,
        values: &[Rows<f32>],
        zeros: &[Complex<f64>],
        of: &'a [usize],
    ) -> impl Iterator<Item = (usize, Complex<f32>)> + 'a {
        let numbers = Numbers::new(of.iter().map(|&own| zeros[own]).collect(), table);
        let last = zeros.len() - 1;
        self.divisors.clear();
        for (lane, &own) in of.iter().enumerate() {
            for (c, zero) in zeros.iter().enumerate() {
                let to = if c == own {
                    last
                } else if c == last {
                    own
                } else {
                    c
                };
                let divisor = if c == own { Complex::from(1.0) } else { cast(zeros[own] - zero) };
                self.divisors.set(to, lane, divisor);
            }
        }
        self.ratios(&numbers, values, zeros.len(), of);
        of.iter().enumerate().map(|(lane, &own)| (own, self.ratios.at(0, lane)))
    }

    fn ratios(&mut self, numbers: &Numbers, values: &[Rows<f32>], order: usize, last: &[usize]) {
        let Self { matrix, divisors, ratios } = self;
        Arch::new().dispatch(Build { numbers, values, order, matrix });
        for (lane, &own) in last.iter().enumerate() {
            for other in 0..order {
                matrix.swap([own * order + other, (order - 1) * order + other], lane);
            }
            for other in 0..order {
                matrix.swap([other * order + own, other * order + order - 1], lane);
            }
        }
        Arch::new().dispatch(Eliminate { order, matrix, divisors, ratios });
    }
}

/// Complex numbers in the lanes of two registers.
type Wide<S> = [<f32 as Real>::Register<S>; 2];

/// `lambda - A(lambda)`.
struct Build<'a> {
    numbers: &'a Numbers,
    values: &'a [Rows<f32>],
    order: usize,
    matrix: &'a mut Rows<f32>,
}

impl WithSimd for Build<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { numbers, values, order, matrix } = self;
        let [row_re, row_im] = numbers.row.registers(simd);
        let [weights_re, weights_im] = numbers.weights.registers(simd);
        let [out_re, out_im] = matrix.registers_mut(simd);
        let parts = AT_ONCE / S::F32_LANES;
        for row in 0..order {
            for column in 0..order {
                let start = (row * order + column) * parts;
                for part in 0..parts {
                    let zero = simd.splat_f32s(0.0);
                    let mut entry = if row == column { [row_re[part], row_im[part]] } else { [zero, zero] };
                    let weights =
                        weights_re[part..].iter().step_by(parts).zip(weights_im[part..].iter().step_by(parts));
                    for (value, (&re, &im)) in values.iter().zip(weights) {
                        let value = value.at(row, column);
                        let value = [simd.splat_f32s(value.re), simd.splat_f32s(value.im)];
                        entry = add_product(simd, value, [re, im], entry);
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
        let Self { order, matrix, divisors, ratios } = self;
        let [re, im] = matrix.registers_mut(simd);
        let [divisors_re, divisors_im] = divisors.registers(simd);
        let [ratios_re, ratios_im] = ratios.registers_mut(simd);
        let parts = AT_ONCE / S::F32_LANES;
        for part in 0..parts {
            let mut ratio = [simd.splat_f32s(1.0), simd.splat_f32s(0.0)];
            for c in 0..order {
                let place = (c * order + c) * parts + part;
                let pivot = [re[place], im[place]];
                // Factor by factor, so that no product of many large numbers overflows.
                let expected = inverse(simd, [divisors_re[c * parts + part], divisors_im[c * parts + part]]);
                ratio = product(simd, ratio, product(simd, pivot, expected));
                let inverse = inverse(simd, pivot);
                for row in c + 1..order {
                    let start = row * order * parts;
                    let (above_re, below_re) = re.split_at_mut(start);
                    let (above_im, below_im) = im.split_at_mut(start);
                    let first = c * parts + part;
                    let factor = product(simd, [below_re[first], below_im[first]], inverse);
                    let above = (c * order + c + 1) * parts + part..(c + 1) * order * parts;
                    let below = first + parts..order * parts;
                    let above = above_re[above.clone()].iter().zip(&above_im[above]).step_by(parts);
                    let below = below_re[below.clone()].iter_mut().zip(&mut below_im[below]).step_by(parts);
                    for ((above_re, above_im), (re, im)) in above.zip(below) {
                        [*re, *im] = take_product(simd, factor, [*above_re, *above_im], [*re, *im]);
                    }
                }
            }
            [ratios_re[part], ratios_im[part]] = ratio;
        }
    }
}

/// `a b + c`.
#[inline(always)]
fn add_product<S: Simd>(simd: S, a: Wide<S>, b: Wide<S>, c: Wide<S>) -> Wide<S> {
    [
        simd.negate_mul_add_e_f32s(a[1], b[1], simd.mul_add_e_f32s(a[0], b[0], c[0])),
        simd.mul_add_e_f32s(a[1], b[0], simd.mul_add_e_f32s(a[0], b[1], c[1])),
    ]
}

/// `c - a b`.
#[inline(always)]
fn take_product<S: Simd>(simd: S, a: Wide<S>, b: Wide<S>, c: Wide<S>) -> Wide<S> {
    [
        simd.mul_add_e_f32s(a[1], b[1], simd.negate_mul_add_e_f32s(a[0], b[0], c[0])),
        simd.negate_mul_add_e_f32s(a[1], b[0], simd.negate_mul_add_e_f32s(a[0], b[1], c[1])),
    ]
}

#[inline(always)]
fn product<S: Simd>(simd: S, a: Wide<S>, b: Wide<S>) -> Wide<S> {
    add_product(simd, a, b, [simd.splat_f32s(0.0); 2])
}

#[inline(always)]
fn inverse<S: Simd>(simd: S, a: Wide<S>) -> Wide<S> {
    let size = simd.mul_add_e_f32s(a[1], a[1], simd.mul_f32s(a[0], a[0]));
    [simd.div_f32s(a[0], size), simd.div_f32s(simd.neg_f32s(a[1]), size)]
}
