//! Gains at which the near modes are known, and guesses of them at others.

use linsys::{ChannelGain, real_times_complex};
use nalgebra::DMatrix;
use num_complex::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::coarse::Coarse;
use super::coupling::{Coupled, Gains, Pull, pull};
use super::expansion::Expansion;
use super::own::Own;
use super::pair::moved;
use super::ports::Ports;
use crate::ReductionError;
use crate::dense;
use crate::rows::{Rows, product};
use cea::certified::lanes::cast;

/// Largest condition number, in Frobenius norms, of the vectors of an anchor; chosen: those of cases/disc-pad have 40 to 60, and some tens of
/// thousands next to a coalescence, from where guesses are no use.
const LARGEST_CONDITION: f64 = 1e3;

/// Gains at which the near modes are known.
#[derive(Debug, Clone)]
pub(super) struct Anchor {
    gains: Vec<ChannelGain>,
    /// Of these gains in the middle of the band.
    pulls: Pulls,
    /// The eigenvalues under them, rad/s.
    lambdas: Vec<Complex<f64>>,
    /// `phi_i^H M phi_j` of the shapes of these modes.
    products: Rows<f32>,
    /// What A is made of with the vectors of these modes as coordinates, in which it is nearly diagonal.
    pub own: Coupled<f32>,
    /// These vectors S as rows, p x p.
    pub vectors: Rows<f32>,
    /// `S^-1`.
    inverse: Rows<f32>,
    /// A around these gains, where all ports have the same and A has no poles near.
    pub expansion: Option<Expansion>,
    /// For each of them the weights of the points for guesses at its frequency.
    weights: Vec<Vec<Complex<f32>>>,
}

/// A guess of an eigenvalue.
#[derive(Debug, Clone, Copy)]
pub(super) struct Guess {
    /// rad/s.
    pub lambda: Complex<f64>,
    /// By how much each other mode moves it, summed, rad/s.
    pub moved: f64,
}

impl Anchor {
    /// The near modes under some gains, from those of the structure; `None` where their vectors do not tell them apart.
    ///
    /// # Errors
    /// Eigenvalues that do not converge.
    pub fn new(
        ports: &Ports,
        structure: &Coupled<f64>,
        coarse: &Coarse,
        gains: Vec<ChannelGain>,
    ) -> Result<Option<Self>, ReductionError> {
        let mut a = Own::new(ports, structure, Gains::of(&gains));
        let (mut lambdas, mut vectors) = a.eigen(ports.middle)?;
        let (p, mut shapes) = (ports.near(), Vec::with_capacity(ports.near()));
        for (lambda, mut vector) in lambdas.iter_mut().zip(vectors.column_iter_mut()) {
            let vector = vector.as_mut_slice();
            let Some(own) = a.next_to(*lambda, vector) else { return Ok(None) };
            *lambda = own;
            shapes.push(ports.shapes.shape(own, vector, &a.forces(vector)));
        }
        let Ok(inverse) = dense::solve(&vectors, &DMatrix::identity(p, p)) else { return Ok(None) };
        if inverse.norm() * vectors.norm() > LARGEST_CONDITION {
            return Ok(None);
        }
        let weights = lambdas.iter().map(|lambda| coarse.weights_near(*lambda)).collect();
        let pulls = Pulls::of(ports, &gains);
        let weighted: Vec<_> = shapes.iter().map(|shape| real_times_complex(&ports.mass, shape)).collect();
        let products = Rows::from_fn(p, p, |i, j| cast(shapes[i].dotc(&weighted[j])));
        let expand = |gain| Expansion::new(ports, gain, lambdas.clone(), &vectors, &inverse);
        let expansion = shared(&gains).and_then(expand);
        let own = Coupled::new(ports, &vectors, &inverse).single();
        let (vectors, inverse) = (Rows::of(&vectors.transpose()).single(), Rows::of(&inverse).single());
        Ok(Some(Self { gains, pulls, lambdas, products, own, vectors, inverse, weights, expansion }))
    }

    /// These gains, and the eigenvalues under them.
    pub fn known(&self) -> (&[ChannelGain], &[Complex<f64>]) {
        (&self.gains, &self.lambdas)
    }

    /// The modal assurance criterion (MAC), with M as weight, of a mode, given the amplitudes of the near modes, with each of the modes under
    /// these gains.
    pub fn mac(&self, amplitudes: &[Complex<f32>]) -> Vec<f64> {
        let vector: Vec<Complex<f32>> = product(&self.inverse, amplitudes);
        let seen: Vec<Complex<f32>> = product(&self.products, &vector);
        let own: Complex<f32> = vector.iter().zip(&seen).map(|(v, seen)| v.conj() * seen).sum();
        let of = |(i, seen): (usize, &Complex<f32>)| f64::from(seen.norm_sqr() / (own.re * self.products.at(i, i).re));
        seen.iter().enumerate().map(of).collect()
    }

    /// The square of how far gains are.
    pub fn distance(&self, ports: &Ports, to: &Pulls) -> f64 {
        to.distance(ports, &self.pulls)
    }

    /// The eigenvalues of A, given at the points for guesses in the coordinates of this anchor: its diagonal, and to second order what
    /// couples it. Two modes that are near each other are taken as the pair that they make. `rows` is overwritten.
    pub fn guesses(&self, values: &[Rows<f32>], rows: &mut Rows<f32>) -> Vec<Guess> {
        Arch::new().dispatch(OwnRows { weights: &self.weights, values, out: rows });
        let entry = |row: usize, column: usize| cast::<f32, f64>(rows.at(row, column));
        let own = |i: usize| Guess { lambda: entry(i, i), moved: 0.0 };
        let mut guesses: Vec<Guess> = (0..self.weights.len()).map(own).collect();
        for i in 0..guesses.len() {
            for j in 0..i {
                let by_other = moved((entry(i, i) - entry(j, j)) * 0.5, entry(i, j) * entry(j, i));
                let size = by_other.norm_sqr().sqrt();
                guesses[i].lambda += by_other;
                guesses[j].lambda -= by_other;
                guesses[i].moved += size;
                guesses[j].moved += size;
            }
        }
        guesses
    }
}

/// The pulls of gains in the middle of the band.
#[derive(Debug, Clone)]
pub(super) enum Pulls {
    /// Those of a gain that all ports have.
    Shared(Pull),
    Each(Vec<Pull>),
}

impl Pulls {
    pub fn of(ports: &Ports, gains: &[ChannelGain]) -> Self {
        let pull = |gain: &ChannelGain| pull(gain, ports.middle);
        shared(gains).map_or_else(|| Self::Each(gains.iter().map(pull).collect()), |gain| Self::Shared(pull(gain)))
    }

    /// The square of how far these are from others: the changes, each times what it moves the near modes by at most, rad/s.
    fn distance(&self, ports: &Ports, to: &Self) -> f64 {
        let apart = |(mu, slope): Pull, (to_mu, to_slope): Pull| [(mu - to_mu).powi(2), (slope - to_slope).norm_sqr()];
        if let (Self::Shared(pull), Self::Shared(to)) = (self, to) {
            let [of_friction, of_slope] = apart(*pull, *to);
            return of_friction * ports.moved_by_all[0] + of_slope * ports.moved_by_all[1];
        }
        let moved = ports.moved[0].iter().zip(&ports.moved[1]).enumerate();
        let of_port = |(port, (by_friction, by_slope)): (usize, (&f64, &f64))| {
            let [of_friction, of_slope] = apart(self.at(port), to.at(port));
            of_friction * by_friction.powi(2) + of_slope * by_slope.powi(2)
        };
        moved.map(of_port).sum()
    }

    fn at(&self, port: usize) -> Pull {
        match self {
            Self::Shared(pull) => *pull,
            Self::Each(pulls) => pulls[port],
        }
    }
}

/// The gain that all ports have, where they have one.
pub(super) fn shared(gains: &[ChannelGain]) -> Option<&ChannelGain> {
    let (first, others) = gains.split_first()?;
    others.iter().all(|gain| gain == first).then_some(first)
}

/// The first of some gains and others, each as far as can be from all before it.
pub(super) fn spread(ports: &Ports, known: Vec<Vec<ChannelGain>>, most: usize) -> Vec<Vec<ChannelGain>> {
    let pulls: Vec<Pulls> = known.iter().map(|gains| Pulls::of(ports, gains)).collect();
    let mut nearest = vec![f64::INFINITY; known.len()];
    let (mut chosen, mut next) = (Vec::new(), 0);
    while chosen.len() < most.min(known.len()) {
        chosen.push(known[next].clone());
        for (nearest, of) in nearest.iter_mut().zip(&pulls) {
            *nearest = nearest.min(of.distance(ports, &pulls[next]));
        }
        next = (0..known.len()).max_by(|&a, &b| nearest[a].total_cmp(&nearest[b])).unwrap_or(0);
    }
    chosen
}

/// The rows of A, each at a frequency of its own.
struct OwnRows<'a> {
    /// For each row those of the points.
    weights: &'a [Vec<Complex<f32>>],
    values: &'a [Rows<f32>],
    out: &'a mut Rows<f32>,
}

impl WithSimd for OwnRows<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.out.clear();
        for (row, weights) in self.weights.iter().enumerate() {
            for (&weight, a) in weights.iter().zip(self.values) {
                self.out.add_row(simd, row, weight, a, row);
            }
        }
    }
}
