//! The smaller systems, called *sectors*, into which a symmetric brake divides exactly.
//!
//! Where a symmetry maps structure, constraints, contacts and operating point onto themselves, every matrix commutes with the
//! symmetry. Each of its operations multiplies the shapes of a sector by 1 or -1, and shapes of two sectors, which differ in one
//! of these signs, are not coupled. The shapes of a sector are combinations of the degrees of freedom that the symmetry exchanges,
//! with coefficients of one size: `e_i`, `(e_i +- e_j) / sqrt 2`, `(e_i +- e_j +- e_k +- e_l) / 2`. Channels and their internal
//! states combine in the same way. With Q the orthonormal basis of a sector and U the basis of its states, the sector is the system
//!
//! ```text
//! Q^T M Q,  Q^T C Q,  Q^T K Q,  U^T E Q,  Q^T F U,  a of one state of each combination
//! ```
//!
//! (Fässler and Stiefel, Group Theoretical Methods and Their Applications, 1992, chapter 2). The eigenvalues of all sectors
//! together are the eigenvalues of the whole system, except the eigenvalues -a of states that act on no degree of freedom.

mod changed;

use linsys::{AffineSystem, ChannelGain, Internal, OperatingPoint, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::OscModelError;
use crate::coupling::first_coupled;

/// Largest relative difference of two normal loads that count as equal, because the loads of a static equilibrium are symmetric
/// only up to rounding. Chosen, far above rounding errors and far below differences between given loads.
const LARGEST_LOAD_DIFFERENCE: f64 = 1e-9;

/// The sectors of a brake. A brake without symmetry, in which all degrees of freedom are coupled, has one sector.
#[derive(Debug, Clone, PartialEq)]
pub struct Sectors {
    sectors: Vec<Sector>,
    /// First channel that must have the same friction, for each channel.
    like: Vec<usize>,
}

/// A sector: orthonormal bases of its shapes and of its channels.
#[derive(Debug, Clone, PartialEq)]
pub struct Sector {
    /// Basis of the shapes, over the free degrees of freedom.
    pub(crate) shapes: Vec<Combination>,
    /// Basis of the channels, over the channels of the brake.
    pub(crate) channels: Vec<Combination>,
    /// Number of free degrees of freedom of the brake.
    pub(crate) order: usize,
    /// Number of channels of the brake.
    pub(crate) channel_count: usize,
}

/// A basis vector: entries `+size` or `-size` at the indices of `signs`, which ascend, the first of them positive.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Combination {
    pub signs: Vec<(usize, f64)>,
    pub size: f64,
}

impl Combination {
    fn unit(place: usize) -> Self {
        Self { signs: vec![(place, 1.0)], size: 1.0 }
    }
}

impl Sectors {
    /// The full model as its only sector, for all operating points.
    pub fn whole(order: usize, channels: usize) -> Self {
        let sector = Sector {
            shapes: (0..order).map(Combination::unit).collect(),
            channels: (0..channels).map(Combination::unit).collect(),
            order,
            channel_count: channels,
        };
        Self { sectors: vec![sector], like: (0..channels).collect() }
    }

    /// Sectors by a symmetry; `like` gives for each channel the first channel that must have the same friction.
    pub(crate) fn new(sectors: Vec<Sector>, like: Vec<usize>) -> Self {
        Self { sectors, like }
    }

    /// Divides each sector into parts that none of the `whole` systems couples.
    ///
    /// # Errors
    /// A system of another order.
    pub(crate) fn uncoupled(mut self, whole: &[SecondOrder]) -> Result<Self, OscModelError> {
        let parts = self.sectors.iter().map(|sector| sector.coupled(whole)).collect::<Result<Vec<_>, _>>()?;
        self.sectors = parts.into_iter().flatten().collect();
        Ok(self)
    }

    /// The sectors; the first has the sign 1 under every operation of the symmetry.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Sector> {
        self.sectors.iter()
    }

    /// Writes the system of each sector at an operating point to one of `out`; `whole` is scratch memory for the system of the
    /// full model. Nothing is allocated if all systems already have their orders and states.
    ///
    /// # Errors
    /// An operating point of another system, one that breaks the symmetry, and, with several sectors, one in which a channel without an internal state
    /// comes before one that has one.
    pub fn assemble_into<'a>(
        &self,
        system: &AffineSystem,
        at: &OperatingPoint,
        whole: &mut SecondOrder,
        out: impl IntoIterator<Item = &'a mut SecondOrder>,
    ) -> Result<(), OscModelError> {
        system.assemble_into(at, whole)?;
        self.check(system, &at.channels)?;
        self.sectors.iter().zip(out).try_for_each(|(sector, out)| sector.reduce(whole, out))
    }

    /// Checks that channels that the symmetry exchanges have the same friction.
    fn check(&self, system: &AffineSystem, gains: &[ChannelGain]) -> Result<(), OscModelError> {
        for (i, (gain, &first)) in gains.iter().zip(&self.like).enumerate() {
            if !is_alike(gain, &gains[first]) {
                let [first, second] = [first, i].map(|at| system.channels()[at].name.clone());
                return Err(OscModelError::UnequalContacts { first, second });
            }
        }
        // `Sector::reduce` takes the states of a system as those of its first channels.
        let states = gains.iter().filter(|gain| gain.lag.is_some()).count();
        if self.sectors.len() > 1 && gains[..states].iter().any(|gain| gain.lag.is_none()) {
            let (order, channels) = (system.order(), gains.len());
            return Err(OscModelError::OtherSystem { order, states, expected: order, channels });
        }
        Ok(())
    }
}

/// Combinations of the coupled part whose smallest index is `first`.
fn of_part(all: &[Combination], firsts: &[usize], first: usize) -> Vec<Combination> {
    all.iter().zip(firsts).filter(|(_, other)| **other == first).map(|(combination, _)| combination.clone()).collect()
}

/// True if two gains are equal up to rounding errors of their loads.
fn is_alike(gain: &ChannelGain, other: &ChannelGain) -> bool {
    let is_near = |a: f64, b: f64| (a - b).abs() <= LARGEST_LOAD_DIFFERENCE * b.abs();
    let lags = match (gain.lag, other.lag) {
        (None, None) => true,
        (Some(a), Some(b)) => a.decay == b.decay && a.drive == b.drive && is_near(a.force, b.force),
        _ => false,
    };
    gain.mu == other.mu && is_near(gain.slope, other.slope) && lags
}

impl Sector {
    /// The parts of this sector that none of the `whole` systems couples. A channel that acts on no shape is in no part.
    fn coupled(&self, whole: &[SecondOrder]) -> Result<Vec<Self>, OscModelError> {
        let mut systems = vec![SecondOrder::zeros(1, 0); whole.len()];
        whole.iter().zip(&mut systems).try_for_each(|(whole, part)| self.reduce(whole, part))?;
        let first = first_coupled(&systems);
        let (of_shapes, of_channels) = first.split_at(self.order());
        let part = |first: usize| Self {
            shapes: of_part(&self.shapes, of_shapes, first),
            channels: of_part(&self.channels, of_channels, first),
            ..*self
        };
        Ok((0..self.order()).filter(|&i| of_shapes[i] == i).map(part).collect())
    }

    /// Number of shapes.
    pub fn order(&self) -> usize {
        self.shapes.len()
    }

    /// Writes the part of a symmetric system in this sector to `out`. That the system has the symmetry is not checked. Nothing is allocated if `out`
    /// already has the order and number of states.
    ///
    /// # Errors
    /// A system with another number of degrees of freedom; a system in which a symmetry exchanges a channel with states and a channel
    /// without states.
    pub fn reduce(&self, whole: &SecondOrder, out: &mut SecondOrder) -> Result<(), OscModelError> {
        let is_whole = self.order() == self.order;
        // The states of a system are those of its first channels.
        let has_state = |combination: &&Combination| combination.signs[0].0 < whole.states();
        let states: Vec<&Combination> = self.channels.iter().filter(has_state).collect();
        let is_torn = states.iter().any(|combination| combination.signs.iter().any(|&(at, _)| at >= whole.states()));
        if whole.order() != self.order || !is_whole && is_torn {
            let (order, states) = (whole.order(), whole.states());
            return Err(OscModelError::OtherSystem {
                order,
                states,
                expected: self.order,
                channels: self.channel_count,
            });
        }
        let count = if is_whole { whole.states() } else { states.len() };
        if out.order() != self.order() {
            *out = SecondOrder::zeros(self.order(), count);
        } else if out.states() != count {
            out.internal = Internal::zeros(self.order(), count);
        }
        if is_whole {
            out.m.copy_from(&whole.m);
            out.c.copy_from(&whole.c);
            out.k.copy_from(&whole.k);
            out.internal.decay.copy_from(&whole.internal.decay);
            out.internal.drive.copy_from(&whole.internal.drive);
            out.internal.force.copy_from(&whole.internal.force);
            return Ok(());
        }
        let shapes: Vec<&Combination> = self.shapes.iter().collect();
        let parts = [
            (&whole.m, &shapes, &shapes, &mut out.m),
            (&whole.c, &shapes, &shapes, &mut out.c),
            (&whole.k, &shapes, &shapes, &mut out.k),
            (&whole.internal.drive, &states, &shapes, &mut out.internal.drive),
            (&whole.internal.force, &shapes, &states, &mut out.internal.force),
        ];
        for (whole, rows, columns, out) in parts {
            reduce(whole, rows, columns, out);
        }
        for (decay, state) in out.internal.decay.iter_mut().zip(states) {
            *decay = whole.internal.decay[state.signs[0].0];
        }
        Ok(())
    }

    /// [`Sector::reduce`] to a new system.
    ///
    /// # Errors
    /// As [`Sector::reduce`].
    pub fn reduced(&self, whole: &SecondOrder) -> Result<SecondOrder, OscModelError> {
        let mut part = SecondOrder::zeros(self.order(), 0);
        self.reduce(whole, &mut part)?;
        Ok(part)
    }

    /// The directions of forces, n x m, and readings, m x n, of the channels in this sector, for equal channels.
    pub fn channels(&self, system: &AffineSystem) -> [DMatrix<f64>; 2] {
        let (shapes, channels): (Vec<_>, Vec<_>) = (self.shapes.iter().collect(), self.channels.iter().collect());
        let mut force = DMatrix::zeros(shapes.len(), channels.len());
        let mut reading = DMatrix::zeros(channels.len(), shapes.len());
        reduce(&system.force_matrix(), &shapes, &channels, &mut force);
        reduce(&system.reading_matrix(), &channels, &shapes, &mut reading);
        [force, reading]
    }

    /// `Q phi`: a shape of this sector over the free degrees of freedom of the brake.
    pub fn expand(&self, shape: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let mut whole = DVector::zeros(self.order);
        for (&amplitude, combination) in shape.iter().zip(&self.shapes) {
            for &(place, sign) in &combination.signs {
                whole[place] = amplitude * (sign * combination.size);
            }
        }
        whole
    }

    /// `Q^T phi`: the part in this sector of a shape over the free degrees of freedom of the brake.
    pub fn project(&self, whole: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let part = |Combination { signs, size }: &Combination| {
            signs.iter().filter_map(|&(place, sign)| Some(whole.get(place)? * sign)).sum::<Complex<f64>>() * *size
        };
        DVector::from_iterator(self.order(), self.shapes.iter().map(part))
    }
}

/// `R^T A C` of a matrix A that commutes with the symmetry. `A C` is then a combination of the vectors of R, whose first indices
/// all differ, so that the coefficient of each vector follows from one row of A.
fn reduce(whole: &DMatrix<f64>, rows: &[&Combination], columns: &[&Combination], out: &mut DMatrix<f64>) {
    for (column, mut out) in columns.iter().zip(out.column_iter_mut()) {
        for (row, out) in rows.iter().zip(out.iter_mut()) {
            let place = row.signs[0].0;
            let sum: f64 = column.signs.iter().map(|&(j, sign)| whole[(place, j)] * sign).sum();
            *out = sum * (column.size / row.size);
        }
    }
}
