//! The sectors of a lattice, by the [`Reversal`]s that map the lattice onto itself.
//!
//! Degrees of freedom that no spring, dashpot or friction couples with the others in any arrangement form one more sector, for
//! example yp of the plate without friction in y.

use linsys::{ChannelGain, Lag, OperatingPoint, SecondOrder};

use super::{ContactArrangement, Lateral, LatticeModel, PreparedLattice, Reversal};
use crate::sectors::{Combination, Sector};
use crate::{OscModelError, Sectors};

/// A reversal, and the sign by which it multiplies the shapes of a sector.
type Parity = (Reversal, f64);

impl LatticeModel {
    /// The sectors of an arrangement, for sliding states that are alike in all contacts.
    ///
    /// Degrees of freedom that are coupled, or exchanged by a symmetry, with all contacts closed stay in one sector: on the path
    /// from all oscillators in contact to this arrangement a mode then stays in one sector.
    ///
    /// # Errors
    /// An arrangement of a lattice of another size.
    pub fn sectors(&self, arrangement: &ContactArrangement) -> Result<Sectors, OscModelError> {
        let all = ContactArrangement::full(arrangement.oscillators());
        let (lattice, closed) = (self.prepare(arrangement)?, self.prepare(&all)?);
        let symmetries = self.symmetries();
        let mut group = symmetries.clone();
        group.retain(|&reversal| self.carries(reversal, arrangement, arrangement));
        let lag = Some(Lag { decay: 1.0, drive: 1.0, force: 1.0 });
        let mut ties = vec![any_friction(&lattice, lag)?, any_friction(&closed, None)?];
        ties.extend(symmetries.into_iter().map(|reversal| self.tie(reversal)));
        ties.push(closed.structural().clone());
        self.split(arrangement, &group).uncoupled(&ties)
    }

    /// A system that couples the degrees of freedom that a reversal exchanges.
    fn tie(&self, reversal: Reversal) -> SecondOrder {
        let (grid, dofs) = (self.parameters().grid, self.dof_map());
        let mut tie = SecondOrder::zeros(dofs.free().len(), 0);
        for (column, &i) in dofs.free().iter().enumerate() {
            if let Some(row) = dofs.position(reversal.dof(grid, i)) {
                tie.k[(row, column)] = 1.0;
            }
        }
        tie
    }

    /// Sectors by a group of reversals, the identity first, that map the arrangement onto itself.
    fn split(&self, arrangement: &ContactArrangement, group: &[Reversal]) -> Sectors {
        let (grid, dofs, contacts) = (self.parameters().grid, self.dof_map(), arrangement.in_contact());
        // All these indices exist, because the group maps constraints and contacts onto themselves.
        let dof = |reversal: Reversal, i: usize| dofs.position(reversal.dof(grid, dofs.free()[i])).unwrap_or(i);
        let contact =
            |reversal: Reversal, i: usize| contacts.binary_search(&reversal.oscillator(grid, contacts[i])).unwrap_or(i);
        // Channels across the sliding, if there are any, come after those along it, in the same order.
        let channel_count = if self.lateral() == Lateral::None { contacts.len() } else { 2 * contacts.len() };
        let channel = |reversal: Reversal, i: usize| {
            let (across, at) = (i / contacts.len(), i % contacts.len());
            across * contacts.len() + contact(reversal, at)
        };
        let sector = |parities: Vec<Parity>| Sector {
            shapes: combinations(dofs.free().len(), &parities, dof),
            channels: combinations(channel_count, &parities, channel),
            order: dofs.free().len(),
            channel_count,
        };
        let first = |i: usize| group.iter().map(|&reversal| channel(reversal, i)).min().unwrap_or(i);
        Sectors::new(characters(group).into_iter().map(sector).collect(), (0..channel_count).map(first).collect())
    }
}

/// The matrices of friction with a coefficient, a slope and this internal state in every channel, with an entry wherever any
/// friction law can have one.
fn any_friction(lattice: &PreparedLattice, lag: Option<Lag>) -> Result<SecondOrder, OscModelError> {
    let system = &lattice.brake().system;
    let channels = vec![ChannelGain { mu: 1.0, slope: 1.0, lag }; system.channels().len()];
    let mut friction = SecondOrder::zeros(system.order(), 0);
    system.friction_into(&OperatingPoint { coefficients: vec![1.0], channels }, &mut friction)?;
    Ok(friction)
}

/// The sign patterns that shapes can have under a group of reversals (its characters).
fn characters(group: &[Reversal]) -> Vec<Vec<Parity>> {
    let mut characters = Vec::new();
    for (rows, columns) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let sign = |reversal: Reversal| match reversal {
            Reversal::None => 1.0,
            Reversal::Rows => rows,
            Reversal::Columns => columns,
            Reversal::Both => rows * columns,
        };
        let character: Vec<Parity> = group.iter().map(|&reversal| (reversal, sign(reversal))).collect();
        if !characters.contains(&character) {
            characters.push(character);
        }
    }
    characters
}

/// An orthonormal basis, in the order of first indices, of the vectors with `count` entries that each reversal multiplies by its
/// sign in `parities`.
fn combinations(count: usize, parities: &[Parity], image: impl Fn(Reversal, usize) -> usize) -> Vec<Combination> {
    let of = |first: usize| {
        let mut signs: Vec<(usize, f64)> = Vec::with_capacity(parities.len());
        for &(reversal, sign) in parities {
            let place = image(reversal, first);
            match signs.iter_mut().find(|(other, _)| *other == place) {
                Some((_, sum)) => *sum += sign,
                None => signs.push((place, sign)),
            }
        }
        // An entry that a reversal maps onto itself is zero in every sector where that reversal has the sign -1.
        let is_kept = signs.iter().all(|&(place, sum)| place >= first && sum != 0.0);
        signs.iter_mut().for_each(|(_, sign)| *sign = sign.signum());
        signs.sort_unstable_by_key(|&(place, _)| place);
        is_kept.then(|| Combination { size: 1.0 / (signs.len() as f64).sqrt(), signs })
    };
    (0..count).filter_map(of).collect()
}
