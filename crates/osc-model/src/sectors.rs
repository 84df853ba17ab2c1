//! The smaller systems that a symmetric lattice falls apart into, exactly.
//!
//! Where a [`Reversal`] carries springs, constraints, arrangement and sliding state into themselves, every matrix commutes
//! with it. Shapes that each such reversal either keeps or turns round, all of one *sector* by the same signs, then never
//! meet those of another sector. They are combinations of the degrees of freedom that the reversals carry into each
//! other, with coefficients of one size: `e_i`, `(e_i +- e_j) / sqrt 2`, `(e_i +- e_j +- e_k +- e_l) / 2`. Bristles
//! combine as their contacts do. With Q the orthonormal basis of a sector and U that of its bristles the sector is
//!
//! ```text
//! Q^T M Q,  Q^T C Q,  Q^T K Q,  U^T E Q,  Q^T F U,  a of one bristle of each combination
//! ```
//!
//! (Fässler and Stiefel, Group Theoretical Methods and Their Applications, 1992, chapter 2). Of these, what no spring,
//! dashpot or friction couples, whichever contacts are closed, is a sector of its own: the plate across the sliding, where
//! there is no friction.
//! The eigenvalues of all sectors together are those of the whole, but for the -a of bristles that act on nothing.

use friction::{InternalTangent, Tangent};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::coupling::first_coupled;
use crate::{
    BrakeModel, ContactArrangement, ContactPoint, FrictionChannels, LatticeModel, Linearise, OscModelError,
    PreparedLattice, Reversal, Sliding,
};

/// Normal loads of a static equilibrium keep the symmetry up to rounding errors; this much, relatively, passes for them.
const LOAD_ROUNDING: f64 = 1e-9;

/// The sectors of one arrangement: one, the whole lattice, where nothing carries it into itself and all is coupled.
#[derive(Debug, Clone, PartialEq)]
pub struct Sectors {
    sectors: Vec<Sector>,
    /// For each contact, in the order of the arrangement, the first that it must be like.
    like: Vec<usize>,
    oscillators: Vec<usize>,
}

/// One sector: an orthonormal basis of some shapes of the lattice and of its bristles.
#[derive(Debug, Clone, PartialEq)]
pub struct Sector {
    /// Over the free degrees of freedom.
    shapes: Vec<Combination>,
    /// Over the contacts.
    bristles: Vec<Combination>,
    order: usize,
    contacts: usize,
}

/// One vector of a basis: at some places, ascending, coefficients of one size with signs, the first of them positive.
#[derive(Debug, Clone, PartialEq)]
struct Combination {
    signs: Vec<(usize, f64)>,
    size: f64,
}

/// A reversal and the sign that it gives the shapes of a sector.
type Parity = (Reversal, f64);

impl LatticeModel {
    /// The sectors of an arrangement, for sliding states that are alike in all contacts.
    ///
    /// Nothing is split that the other contacts couple when they close, or that is alike then: a mode is of one sector all
    /// the way from every oscillator in contact to this arrangement.
    ///
    /// # Errors
    /// An arrangement of a lattice of another size.
    pub fn sectors(&self, arrangement: &ContactArrangement) -> Result<Sectors, OscModelError> {
        let all = ContactArrangement::full(arrangement.oscillators());
        let (lattice, closed) = (self.prepare(arrangement)?, self.prepare(&all)?);
        let symmetries = self.symmetries();
        let mut group = symmetries.clone();
        group.retain(|&reversal| self.carries(reversal, arrangement, arrangement));
        let mut sectors = self.split(arrangement, &group);
        let bristle = InternalTangent { decay: 1.0, drive: 1.0, force: 1.0 };
        let mut ties = vec![any_friction(&lattice, Some(bristle))?, any_friction(&closed, None)?];
        ties.extend(symmetries.into_iter().map(|reversal| self.tie(reversal)));
        ties.push(closed.structural().clone());
        let coupled = |sector: &Sector| sector.coupled(&ties);
        let parts = sectors.sectors.iter().map(coupled).collect::<Result<Vec<_>, _>>()?;
        sectors.sectors = parts.into_iter().flatten().collect();
        Ok(sectors)
    }

    /// The whole lattice as its only sector, for any sliding states.
    ///
    /// # Errors
    /// An arrangement of a lattice of another size.
    pub fn one_sector(&self, arrangement: &ContactArrangement) -> Result<Sectors, OscModelError> {
        self.check_size(arrangement)?;
        Ok(self.split(arrangement, &[Reversal::None]))
    }

    /// A system that couples what a reversal exchanges.
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

    /// Sectors by a group of reversals, the identity first, that carry the arrangement into itself.
    fn split(&self, arrangement: &ContactArrangement, group: &[Reversal]) -> Sectors {
        let (grid, dofs, contacts) = (self.parameters().grid, self.dof_map(), arrangement.in_contact());
        // Each exists: the group leaves constraints and contacts as they are.
        let dof = |reversal: Reversal, i: usize| dofs.position(reversal.dof(grid, dofs.free()[i])).unwrap_or(i);
        let contact =
            |reversal: Reversal, i: usize| contacts.binary_search(&reversal.oscillator(grid, contacts[i])).unwrap_or(i);
        let sector = |parities: Vec<Parity>| Sector {
            shapes: combinations(dofs.free().len(), &parities, dof),
            bristles: combinations(contacts.len(), &parities, contact),
            order: dofs.free().len(),
            contacts: contacts.len(),
        };
        let first = |i: usize| group.iter().map(|&reversal| contact(reversal, i)).min().unwrap_or(i);
        Sectors {
            sectors: characters(group).into_iter().map(sector).collect(),
            like: (0..contacts.len()).map(first).collect(),
            oscillators: contacts.to_vec(),
        }
    }
}

/// Friction with everything in it that any law has, and these bristles.
fn any_friction(lattice: &PreparedLattice, internal: Option<InternalTangent>) -> Result<SecondOrder, OscModelError> {
    let tangent = Tangent { mu: 1.0, slope: 1.0, internal };
    let contact = ContactPoint { tangent, lateral_mu: 1.0, normal_load: 1.0, stiffness_factor: 1.0 };
    let contacts = vec![contact; lattice.arrangement().in_contact().len()];
    let mut friction = SecondOrder::zeros(lattice.structural().order(), 0);
    lattice.linearise_friction(&Sliding { speed: 1.0, contacts }, &mut friction)?;
    Ok(friction)
}

/// The ways in which shapes can keep or change their sign under a group of reversals.
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

/// An orthonormal basis of the vectors over `count` places that change as `parities` say, in the order of first places.
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
        // A place that a reversal leaves where it is has no part in a sector in which that reversal changes signs.
        let is_kept = signs.iter().all(|&(place, sum)| place >= first && sum != 0.0);
        signs.iter_mut().for_each(|(_, sign)| *sign = sign.signum());
        signs.sort_unstable_by_key(|&(place, _)| place);
        is_kept.then(|| Combination { size: 1.0 / (signs.len() as f64).sqrt(), signs })
    };
    (0..count).filter_map(of).collect()
}

impl Sectors {
    /// The sectors, the one that keeps all signs first.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Sector> {
        self.sectors.iter()
    }

    /// Writes the linearised system of each sector to one of `out`; `whole` is memory for that of the whole lattice.
    /// Nothing is allocated if all have their orders and states already.
    ///
    /// # Errors
    /// Those of [`Linearise::linearise`], contacts that break the symmetry, a lattice of another size.
    pub fn linearise<'a>(
        &self,
        lattice: &PreparedLattice,
        sliding: &Sliding,
        whole: &mut SecondOrder,
        out: impl IntoIterator<Item = &'a mut SecondOrder>,
    ) -> Result<(), OscModelError> {
        lattice.linearise(sliding, whole)?;
        self.check(&sliding.contacts)?;
        self.sectors.iter().zip(out).try_for_each(|(sector, out)| sector.reduce(whole, out))
    }

    /// Contacts that the symmetry carries into each other are alike.
    fn check(&self, contacts: &[ContactPoint]) -> Result<(), OscModelError> {
        for (i, (point, &first)) in contacts.iter().zip(&self.like).enumerate() {
            let other = &contacts[first];
            let loads = (point.normal_load - other.normal_load).abs() <= LOAD_ROUNDING * other.normal_load;
            if !loads || *point != (ContactPoint { normal_load: point.normal_load, ..*other }) {
                let [first, second] = [first, i].map(|i| self.oscillators[i] + 1);
                return Err(OscModelError::UnequalContacts { first, second });
            }
        }
        Ok(())
    }
}

impl Sector {
    /// The parts of this sector that nothing in the `whole` systems couples. Bristles that act on nothing have no part.
    fn coupled(&self, whole: &[SecondOrder]) -> Result<Vec<Self>, OscModelError> {
        let mut systems = vec![SecondOrder::zeros(1, 0); whole.len()];
        whole.iter().zip(&mut systems).try_for_each(|(whole, part)| self.reduce(whole, part))?;
        let first = first_coupled(&systems);
        let (shapes, bristles) = first.split_at(self.order());
        let of = |all: &[Combination], firsts: &[usize], first: usize| {
            all.iter().zip(firsts).filter(|(_, other)| **other == first).map(|(c, _)| c.clone()).collect()
        };
        let part = |first: usize| Self {
            shapes: of(&self.shapes, shapes, first),
            bristles: of(&self.bristles, bristles, first),
            ..*self
        };
        Ok((0..self.order()).filter(|&i| shapes[i] == i).map(part).collect())
    }

    /// Number of shapes.
    pub fn order(&self) -> usize {
        self.shapes.len()
    }

    /// Writes to `out` the part in this sector of a system that the symmetry leaves unchanged. Nothing is allocated if
    /// `out` already has its order and states.
    ///
    /// # Errors
    /// A system of another number of degrees of freedom, or with bristles in some contacts only.
    pub fn reduce(&self, whole: &SecondOrder, out: &mut SecondOrder) -> Result<(), OscModelError> {
        let is_whole = self.order() == self.order;
        if whole.order() != self.order || !is_whole && ![0, self.contacts].contains(&whole.states()) {
            let (order, states, contacts) = (whole.order(), whole.states(), self.contacts);
            return Err(OscModelError::OtherSystem { order, states, expected: self.order, contacts });
        }
        let states = if is_whole || whole.states() == 0 { whole.states() } else { self.bristles.len() };
        if out.order() != self.order() {
            *out = SecondOrder::zeros(self.order(), states);
        } else if out.states() != states {
            out.internal = Internal::zeros(self.order(), states);
        }
        let (shapes, bristles) = (&self.shapes, &self.bristles);
        let parts = [
            (&whole.m, shapes, shapes, &mut out.m),
            (&whole.c, shapes, shapes, &mut out.c),
            (&whole.k, shapes, shapes, &mut out.k),
            (&whole.internal.drive, bristles, shapes, &mut out.internal.drive),
            (&whole.internal.force, shapes, bristles, &mut out.internal.force),
        ];
        for (whole, rows, columns, out) in parts {
            if is_whole {
                out.copy_from(whole);
            } else {
                reduce(whole, rows, columns, out);
            }
        }
        for (state, decay) in out.internal.decay.iter_mut().enumerate() {
            *decay = whole.internal.decay[if is_whole { state } else { bristles[state].signs[0].0 }];
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

    /// The part in this sector of channels of friction that is alike in all contacts.
    pub fn channels(&self, whole: &FrictionChannels) -> FrictionChannels {
        let (shapes, contacts) = (&self.shapes, &self.bristles);
        let mut part = FrictionChannels {
            force: DMatrix::zeros(shapes.len(), contacts.len()),
            coupling: DMatrix::zeros(contacts.len(), shapes.len()),
        };
        reduce(&whole.force, shapes, contacts, &mut part.force);
        reduce(&whole.coupling, contacts, shapes, &mut part.coupling);
        part
    }

    /// `Q phi`: a shape of this sector over the free degrees of freedom of the lattice.
    pub fn expand(&self, shape: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let mut whole = DVector::zeros(self.order);
        for (&amplitude, combination) in shape.iter().zip(&self.shapes) {
            for &(place, sign) in &combination.signs {
                whole[place] = amplitude * (sign * combination.size);
            }
        }
        whole
    }

    /// `Q^T phi`: the part in this sector of a shape over the free degrees of freedom of the lattice.
    pub fn project(&self, whole: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let part = |Combination { signs, size }: &Combination| {
            signs.iter().filter_map(|&(place, sign)| Some(whole.get(place)? * sign)).sum::<Complex<f64>>() * *size
        };
        DVector::from_iterator(self.order(), self.shapes.iter().map(part))
    }
}

/// `R^T A C` of a matrix that commutes with the symmetry. `A C` is made of the vectors of R, each of which has
/// its first place for itself: one row of A each is enough.
fn reduce(whole: &DMatrix<f64>, rows: &[Combination], columns: &[Combination], out: &mut DMatrix<f64>) {
    for (column, mut out) in columns.iter().zip(out.column_iter_mut()) {
        for (row, out) in rows.iter().zip(out.iter_mut()) {
            let place = row.signs[0].0;
            let sum: f64 = column.signs.iter().map(|&(j, sign)| whole[(place, j)] * sign).sum();
            *out = sum * (column.size / row.size);
        }
    }
}
