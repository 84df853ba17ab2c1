//! The modes in and near the band under friction, all others eliminated: `(lambda - A(lambda)) d = 0`.
//!
//! The friction forces c of m ports are `c = (D_mu R + D_s B^T) x` with `x = -Q_0^-1 B c`, diagonal matrices of the gains mu and
//! `lambda s(lambda)`. With `Q_0^-1 = Y (lambda - Lambda)^-1 V^H + F` and the amplitudes `d = (lambda - Lambda)^-1 V^H B c`,
//!
//! ```text
//! A = Lambda - V^H B T^-1 (D_mu R Y + D_s B^T Y),    T = I + D_mu R F B + D_s B^T F B,    x = -Y d - F B c
//! ```

use linsys::ChannelGain;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::ports::Ports;
use super::table::Table;
use crate::elimination::Elimination;
use crate::rows::{Rows, product};
use cea::certified::lanes::{Precision, cast};

/// What A is made of, in coordinates d' of the near modes: `d = S d'`.
#[derive(Debug, Clone)]
pub(super) struct Coupled<T> {
    /// `-S^-1 V^H B` by rows.
    pub force: Vec<Complex<T>>,
    /// `R Y S` and `B^T Y S`.
    pub sides: [Rows<T>; 2],
    /// `S^-1 Lambda S`.
    pub structure: Rows<T>,
}

impl Coupled<f64> {
    /// In the coordinates of the structure.
    pub fn of_structure(ports: &Ports) -> Self {
        let identity = DMatrix::identity(ports.near(), ports.near());
        Self::new(ports, &identity, &identity)
    }

    /// With S, p x p, and its inverse.
    pub fn new(ports: &Ports, vectors: &DMatrix<Complex<f64>>, inverse: &DMatrix<Complex<f64>>) -> Self {
        let p = ports.near();
        let force = inverse * &ports.force;
        let structure = inverse * DMatrix::from_diagonal(&DVector::from_vec(ports.lambdas.clone())) * vectors;
        Self {
            force: (0..p).flat_map(|i| force.row(i).iter().map(|force| -force).collect::<Vec<_>>()).collect(),
            sides: ports.sides.each_ref().map(|side| Rows::of(&(side * vectors))),
            structure: Rows::of(&structure),
        }
    }

    /// What friction adds to A, in single precision.
    pub fn added(&self) -> Coupled<f32> {
        let mut added = self.single();
        added.structure.clear();
        added
    }

    /// The same in single precision.
    pub fn single(&self) -> Coupled<f32> {
        Coupled {
            force: self.force.iter().map(|&force| cast(force)).collect(),
            sides: self.sides.each_ref().map(Rows::single),
            structure: self.structure.single(),
        }
    }
}

/// The gains of all ports, or a place on the straight line from the system with some gains to that with others.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gains<'a> {
    pub from: &'a [ChannelGain],
    pub to: Option<(f64, &'a [ChannelGain])>,
}

impl<'a> Gains<'a> {
    pub fn of(gains: &'a [ChannelGain]) -> Self {
        Self { from: gains, to: None }
    }

    /// The gains mu and `lambda s(lambda)` of a port.
    pub fn at(&self, port: usize, lambda: Complex<f64>) -> Pull {
        let (mu, slope) = pull(&self.from[port], lambda);
        let Some((t, to)) = self.to else { return (mu, slope) };
        let (other_mu, other_slope) = pull(&to[port], lambda);
        (mu * (1.0 - t) + other_mu * t, slope * (1.0 - t) + other_slope * t)
    }

    /// What is made of the gains of each port: once where those of the next one are the same, as of one patch.
    pub fn each<V: Copy>(&self, of: impl Fn(usize) -> V) -> Vec<V> {
        let mut each: Vec<V> = Vec::with_capacity(self.from.len());
        for port in 0..self.from.len() {
            let known = each.last().filter(|_| self.is_equal(port - 1, port));
            each.push(known.copied().unwrap_or_else(|| of(port)));
        }
        each
    }

    fn is_equal(&self, a: usize, b: usize) -> bool {
        self.from[a] == self.from[b] && self.to.is_none_or(|(_, to)| to[a] == to[b])
    }
}

/// Working memory.
#[derive(Debug, Default)]
pub(super) struct Scratch<T = f64> {
    weights: Vec<Complex<f64>>,
    /// The gains mu and `lambda s(lambda)` of the last matrix A.
    pub pulls: Vec<Pull<T>>,
    /// `R F B` and `B^T F B` of it, unless it is at a point of a table.
    pub smooth: [Rows<T>; 2],
    /// T of it, factored.
    pub square: Rows<T>,
    pub factors: Elimination<T>,
    /// `T^-1 (D_mu R Y + D_s B^T Y)` of it, m x p.
    pub solved: Rows<T>,
    /// For `lambda - A`.
    pub elimination: Elimination<T>,
}

impl<T: Precision> Scratch<T> {
    pub fn new(ports: &Ports) -> Self {
        let (p, m) = (ports.near(), ports.count());
        let square = || Rows::zeros(m, m);
        Self { smooth: [square(), square()], square: square(), solved: Rows::zeros(m, p), ..Self::default() }
    }
}

/// A at a point of a table.
pub(super) fn at_point<T: Precision>(
    own: &Coupled<T>,
    table: &Table<T>,
    point: usize,
    gains: Gains<'_>,
    scratch: &mut Scratch<T>,
    out: &mut Rows<T>,
) {
    with(own, table.points[point], &table.values[point], gains, scratch, out);
}

/// A at a number where `R F B` and `B^T F B` are known.
pub(super) fn with<T: Precision>(
    own: &Coupled<T>,
    lambda: Complex<f64>,
    [reading, velocity]: &[Rows<T>; 2],
    gains: Gains<'_>,
    scratch: &mut Scratch<T>,
    out: &mut Rows<T>,
) {
    scratch.pull(gains, lambda);
    let Scratch { pulls, square, factors, solved, .. } = scratch;
    Arch::new().dispatch(Couple { own, reading, velocity, pulls, square, factors, solved, out });
}

/// A at a number near the band.
pub(super) fn at<T: Precision>(
    own: &Coupled<T>,
    table: &Table<T>,
    lambda: Complex<f64>,
    gains: Gains<'_>,
    scratch: &mut Scratch<T>,
    out: &mut Rows<T>,
) {
    scratch.pull(gains, lambda);
    scratch.read(table, lambda);
    let Scratch { pulls, smooth: [reading, velocity], square, factors, solved, .. } = scratch;
    Arch::new().dispatch(Couple { own, reading, velocity, pulls, square, factors, solved, out });
}

/// A under a gain of all ports at a number near the band, times a vector.
pub(super) fn times<T: Precision>(
    own: &Coupled<T>,
    table: &Table<T>,
    lambda: Complex<f64>,
    gain: &ChannelGain,
    vector: &[Complex<T>],
    scratch: &mut Scratch<T>,
) -> Vec<Complex<T>> {
    let (mu, slope) = pull(gain, lambda);
    scratch.pulls.clear();
    scratch.pulls.resize(own.sides[0].rows(), (T::of(mu), cast(slope)));
    scratch.read(table, lambda);
    let Scratch { pulls, smooth: [reading, velocity], square, factors, .. } = scratch;
    Arch::new().dispatch(FactorSquare { reading, velocity, pulls, square, factors });
    let [of_reading, of_velocity] = own.sides.each_ref().map(|side| product(side, vector));
    let pulled = of_reading.into_iter().zip(of_velocity).zip(pulls);
    let mut forces: Vec<_> = pulled.map(|((r, v), (mu, slope))| r * *mu + v * *slope).collect();
    factors.solve(square, &mut forces);
    let of_force = |row: &[Complex<T>]| row.iter().zip(&forces).map(|(a, b)| a * b).sum::<Complex<T>>();
    let added = own.force.chunks_exact(forces.len()).map(of_force);
    product(&own.structure, vector).into_iter().zip(added).map(|(own, added)| own + added).collect()
}

/// `R F B` and `B^T F B` at a number near the band, and T, factored, to `scratch`; their derivatives over lambda to `slopes`.
pub(super) fn factor_at(
    table: &Table,
    lambda: Complex<f64>,
    gains: Gains<'_>,
    scratch: &mut Scratch,
    slopes: &mut [Rows; 2],
) {
    scratch.pull(gains, lambda);
    scratch.read(table, lambda);
    let Scratch { weights, pulls, smooth: [reading, velocity], square, factors, .. } = scratch;
    table.slope_weights_at(lambda, weights);
    for (part, slope) in slopes.iter_mut().enumerate() {
        combine_part(weights, &table.values, part, slope);
    }
    Arch::new().dispatch(FactorSquare { reading, velocity, pulls, square, factors });
}

/// What `R F B` and `B^T F B` at a number near the band differ by from those at the first point of a table, and their derivatives over
/// lambda; `weights` are overwritten.
pub(super) fn differences_at(
    table: &Table<f32>,
    lambda: Complex<f64>,
    weights: &mut Vec<Complex<f64>>,
    values: &mut [Rows<f32>; 2],
    slopes: &mut [Rows<f32>; 2],
) {
    table.weights_at(lambda, weights);
    let of_values: Vec<Complex<f32>> = weights.iter().map(|&weight| cast(weight)).collect();
    table.slope_weights_at(lambda, weights);
    let of_slopes: Vec<Complex<f32>> = weights.iter().map(|&weight| cast(weight)).collect();
    for (part, (value, slope)) in values.iter_mut().zip(slopes).enumerate() {
        let parts = table.values.iter().map(|pair| &pair[part]);
        Arch::new().dispatch(CombineBoth { factors: [&of_values, &of_slopes], parts, outs: [value, slope] });
    }
}

/// The sum of multiples of matrices.
pub(super) fn combine<T: Precision>(factors: &[Complex<T>], parts: &[Rows<T>], out: &mut Rows<T>) {
    Arch::new().dispatch(Combine { factors, parts: parts.iter(), out });
}

/// The sum of multiples of the first or the second matrix of each pair.
pub(super) fn combine_part<T: Precision>(
    factors: &[Complex<T>],
    pairs: &[[Rows<T>; 2]],
    part: usize,
    out: &mut Rows<T>,
) {
    Arch::new().dispatch(Combine { factors, parts: pairs.iter().map(|pair| &pair[part]), out });
}

/// The gains mu and `lambda s(lambda)` of a port.
pub(super) type Pull<T = f64> = (T, Complex<T>);

/// Those of all ports at a number.
pub(super) fn pulls<T: Precision>(gains: Gains<'_>, lambda: Complex<f64>) -> Vec<Pull<T>> {
    gains.each(|port| {
        let (mu, slope) = gains.at(port, lambda);
        (T::of(mu), cast(slope))
    })
}

/// Those of a gain at a number.
pub(super) fn pull(gain: &ChannelGain, lambda: Complex<f64>) -> Pull {
    (gain.mu, lambda * gain.complex_slope(lambda))
}

impl<T: Precision> Scratch<T> {
    /// Sets the gains.
    pub fn pull(&mut self, gains: Gains<'_>, lambda: Complex<f64>) {
        self.pulls = pulls(gains, lambda);
    }

    /// Sets `R F B` and `B^T F B`.
    fn read(&mut self, table: &Table<T>, lambda: Complex<f64>) {
        table.weights_at(lambda, &mut self.weights);
        let weights: Vec<Complex<T>> = self.weights.iter().map(|&weight| cast(weight)).collect();
        for (part, smooth) in self.smooth.iter_mut().enumerate() {
            combine_part(&weights, &table.values, part, smooth);
        }
    }
}

/// T, factored.
struct FactorSquare<'a, T> {
    reading: &'a Rows<T>,
    velocity: &'a Rows<T>,
    pulls: &'a [Pull<T>],
    square: &'a mut Rows<T>,
    factors: &'a mut Elimination<T>,
}

impl<T: Precision> WithSimd for FactorSquare<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { reading, velocity, pulls, square, factors } = self;
        square.clear();
        for (port, &(mu, slope)) in pulls.iter().enumerate() {
            square.set(port, port, Complex::from(T::of(1.0)));
            square.add_row(simd, port, mu.into(), reading, port);
            if slope != Complex::default() {
                square.add_row(simd, port, slope, velocity, port);
            }
        }
        factors.factor(simd, square, pulls.len());
    }
}

struct Couple<'a, T> {
    own: &'a Coupled<T>,
    reading: &'a Rows<T>,
    velocity: &'a Rows<T>,
    pulls: &'a [Pull<T>],
    square: &'a mut Rows<T>,
    factors: &'a mut Elimination<T>,
    solved: &'a mut Rows<T>,
    out: &'a mut Rows<T>,
}

impl<T: Precision> WithSimd for Couple<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { own, reading, velocity, pulls, square, factors, solved, out } = self;
        FactorSquare { reading, velocity, pulls, square, factors }.with_simd(simd);
        solved.clear();
        for (port, &(mu, slope)) in pulls.iter().enumerate() {
            solved.add_row(simd, port, mu.into(), &own.sides[0], port);
            if slope != Complex::default() {
                solved.add_row(simd, port, slope, &own.sides[1], port);
            }
        }
        factors.solve_rows(simd, square, solved);
        out.clone_from(&own.structure);
        for (row, force) in own.force.chunks_exact(pulls.len()).enumerate() {
            out.add_rows(simd, row, force, solved);
        }
    }
}

struct Combine<'a, T, P> {
    factors: &'a [Complex<T>],
    parts: P,
    out: &'a mut Rows<T>,
}

impl<'a, T: Precision, P: Iterator<Item = &'a Rows<T>> + Clone> WithSimd for Combine<'a, T, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.out.set_sum(simd, self.factors, self.parts);
    }
}

struct CombineBoth<'a, T, P> {
    factors: [&'a [Complex<T>]; 2],
    parts: P,
    outs: [&'a mut Rows<T>; 2],
}

impl<'a, T: Precision, P: Iterator<Item = &'a Rows<T>> + Clone> WithSimd for CombineBoth<'a, T, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        Rows::set_sums(self.outs, simd, self.factors, self.parts);
    }
}
