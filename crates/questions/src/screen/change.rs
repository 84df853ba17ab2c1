//! Changes of a brake, and the brake with them.

use cycle::{ContactSystem, Part, SlidingContact};
use linsys::{AffineSystem, Channel, DofMap, OperatingPoint, SecondOrder, Term};
use nalgebra::DMatrix;
use osc_model::{Body, Brake, Sectors};
use serde::Serialize;
use study::{Symmetry, WholeContact};

use crate::Error;

/// Name of the term that holds the attachments to a brake, less the springs and dashpots of contacts that are taken out.
const TERM: &str = "changes";

/// Kind of an attachment to a brake.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Serialize)]
pub enum Attached {
    /// A mass, kg.
    Mass,
    /// A spring to ground, N/m.
    Spring,
    /// A dashpot to ground, Ns/m.
    Dashpot,
}

/// Matrices of a part that are scaled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scaled {
    /// Its stiffness: as by another modulus.
    Stiffness,
    /// Its damping.
    Damping,
    /// Its mass: as by another density.
    Mass,
    /// All of them: as by another thickness of what is loaded in its plane.
    Whole,
}

impl Scaled {
    /// What can be scaled, all of it.
    pub const ALL: [Self; 4] = [Self::Stiffness, Self::Damping, Self::Mass, Self::Whole];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Damping => "damping",
            Self::Mass => "mass",
            Self::Whole => "all",
        }
    }

    /// These of the matrices of a term, the others 0.
    fn of(self, SecondOrder { m, c, k, .. }: &SecondOrder) -> SecondOrder {
        let mut part = SecondOrder::zeros(m.nrows(), 0);
        if matches!(self, Self::Mass | Self::Whole) {
            part.m.copy_from(m);
        }
        if matches!(self, Self::Damping | Self::Whole) {
            part.c.copy_from(c);
        }
        if matches!(self, Self::Stiffness | Self::Whole) {
            part.k.copy_from(k);
        }
        part
    }

    /// True if a term has any of these matrices, of which [`Scaled::Whole`] takes two or more.
    pub(super) fn is_in(self, SecondOrder { m, c, k, .. }: &SecondOrder) -> bool {
        let [m, c, k] = [m, c, k].map(|matrix| matrix.iter().any(|&entry| entry != 0.0));
        match self {
            Self::Stiffness => k,
            Self::Damping => c,
            Self::Mass => m,
            Self::Whole => usize::from(m) + usize::from(c) + usize::from(k) > 1,
        }
    }
}

/// Change of a brake. Degrees of freedom have their numbers, from 0, with held ones counted.
#[derive(Debug, Clone, PartialEq, PartialOrd, Serialize)]
pub enum Change {
    /// A degree of freedom is held: its row and column leave the matrices.
    Hold {
        /// Number of the degree of freedom.
        dof: usize,
    },
    /// An attachment: `size sum p p^T` is added to M, K or C.
    Attach {
        /// Kind of the attachment: M, K or C.
        what: Attached,
        /// Size of the attachment, kg, N/m or Ns/m.
        size: f64,
        /// Vectors p, as (degree of freedom, value) entries.
        along: Vec<Vec<(usize, f64)>>,
    },
    /// A term is scaled: `(factor - 1)` times its own coefficient times some of its matrices is added. What contacts read of its forces stays.
    Scale {
        /// Name of the term.
        term: String,
        /// Matrices that are scaled.
        what: Scaled,
        /// Factor, > 0.
        factor: f64,
    },
    /// A contact is taken out where it is closed: its friction and, as far as they are known, its spring and dashpot. The loads of
    /// the others stay as they are.
    TakeOut {
        /// Number of the contact.
        contact: usize,
    },
}

impl Change {
    /// Image of the change under a symmetry.
    pub fn image(&self, symmetry: &Symmetry) -> Self {
        match self {
            Self::Hold { dof } => Self::Hold { dof: symmetry.dofs[*dof] },
            Self::TakeOut { contact } => Self::TakeOut { contact: symmetry.contacts[*contact] },
            // A symmetry maps each term onto itself.
            Self::Scale { .. } => self.clone(),
            Self::Attach { what, size, along } => {
                let image = |vector: &Vec<(usize, f64)>| {
                    let mut image: Vec<(usize, f64)> =
                        vector.iter().map(|&(dof, value)| (symmetry.dofs[dof], value)).collect();
                    image.sort_by_key(|&(dof, _)| dof);
                    image
                };
                let mut along: Vec<_> = along.iter().map(image).collect();
                along.sort_by_key(|vector| vector.first().map(|&(dof, _)| dof));
                Self::Attach { what: *what, size: *size, along }
            }
        }
    }
}

/// A brake with changes.
#[derive(Debug, Clone)]
pub(super) struct ChangedBrake {
    pub brake: Brake,
    /// Indices of its channels among the channels of the brake without changes.
    channels: Vec<usize>,
    /// Degrees of freedom that stay free, among the degrees of freedom of the brake without changes.
    kept: DofMap,
    has_term: bool,
    /// Indices of the terms that are scaled, and by how much more than 1: each a term of its own after the others.
    scaled: Vec<(usize, f64)>,
}

impl ChangedBrake {
    /// A brake with these changes; `contacts` are the contacts of the brake.
    ///
    /// # Errors
    /// No degree of freedom left free, or one that the brake does not have.
    pub fn new(brake: &Brake, contacts: &[WholeContact], changes: &[Change]) -> Result<Self, Error> {
        let order = brake.system.order();
        let (mut held, mut added, mut out) = (Vec::new(), SecondOrder::zeros(order, 0), Vec::new());
        let (mut scaled, mut terms_of_scaled) = (Vec::new(), Vec::new());
        for change in changes {
            match change {
                Change::Hold { dof } => held.extend(brake.dofs.position(*dof)),
                Change::Attach { what, size, along } => {
                    let matrix = match what {
                        Attached::Mass => &mut added.m,
                        Attached::Spring => &mut added.k,
                        Attached::Dashpot => &mut added.c,
                    };
                    along.iter().for_each(|vector| attach(matrix, &brake.dofs, *size, vector));
                }
                Change::Scale { term, what, factor } => {
                    if let Some(at) = brake.system.terms().iter().position(|other| other.name == *term) {
                        let Term { name, family, .. } = &brake.system.terms()[at];
                        let part = what.of(brake.system.terms()[at].matrices());
                        terms_of_scaled.push(Term::new(format!("{name} x {factor}"), family, part)?);
                        scaled.push((at, factor - 1.0));
                    }
                }
                Change::TakeOut { contact } => {
                    if let Some(contact) = contacts.iter().find(|other| other.number == *contact) {
                        out.extend(&contact.channels);
                        if let Some(structure) = &contact.structure {
                            added.c -= &structure.c;
                            added.k -= &structure.k;
                        }
                    }
                }
            }
        }
        let channels: Vec<usize> = (0..brake.system.channels().len()).filter(|at| !out.contains(at)).collect();
        let kept = DofMap::new(order, &held)?;
        let (mut terms, has_term) = (brake.system.terms().to_vec(), added != SecondOrder::zeros(order, 0));
        if has_term {
            terms.push(Term::new(TERM, TERM, added.clone())?);
        }
        let in_them = terms_of_scaled.iter().map(Term::matrices);
        let sectors_of = sectors(brake, &kept, &channels, [&added].into_iter().chain(in_them));
        terms.extend(terms_of_scaled.clone());
        let of_channels = channels.iter().map(|&at| brake.system.channels()[at].clone()).collect();
        let system = AffineSystem::new(terms, of_channels)?.on(&kept)?;
        let free = |body: &Body| body.dofs.iter().filter_map(|&dof| kept.position(dof)).collect();
        let bodies = brake.bodies.iter().map(|body| Body { name: body.name.clone(), dofs: free(body) }).collect();
        let total = brake.dofs.total();
        let stays = |dof: usize| brake.dofs.position(dof).is_some_and(|at| kept.position(at).is_some());
        let dofs = DofMap::new(total, &(0..total).filter(|&dof| !stays(dof)).collect::<Vec<_>>())?;
        Ok(Self { brake: Brake { system, dofs, bodies, sectors: sectors_of }, channels, kept, has_term, scaled })
    }

    /// True if nothing is changed.
    pub fn is_unchanged(&self) -> bool {
        let all_channels = self.channels.iter().enumerate().all(|(at, channel)| at == *channel);
        all_channels && !self.has_term && self.scaled.is_empty() && self.kept.free().len() == self.kept.total()
    }

    /// The operating point of the brake with changes, from the operating point `at` of the brake without changes.
    pub fn point(&self, mut at: OperatingPoint) -> OperatingPoint {
        let scaled: Vec<f64> = self.scaled.iter().map(|&(term, more)| more * at.coefficients[term]).collect();
        if self.has_term {
            at.coefficients.push(1.0);
        }
        at.coefficients.extend(scaled);
        at.channels = self.channels.iter().filter_map(|&channel| at.channels.get(channel).copied()).collect();
        at
    }

    /// The equations of motion of the brake with changes at an operating point of its own, from the brake `of` without changes and its equations of motion
    /// `unchanged`. A contact keeps its load, speed, spring and law. A contact that is taken out does not open any more, and its spring stays where nothing
    /// says which spring is its own. A channel without a contact, which is what the spring of a contact has beyond the term of all contacts, is structure.
    ///
    /// # Errors
    /// A brake whose contacts are all taken out; a contact without a channel.
    pub fn motion(
        &self,
        (of, unchanged): (&Brake, &ContactSystem),
        at: &OperatingPoint,
    ) -> Result<ContactSystem, cycle::Error> {
        // Contacts have the order of their channels.
        let mut contacts = unchanged.contacts().iter().peekable();
        let next = |channel: &Channel| contacts.next_if(|of| of.name == channel.name && of.family == channel.family);
        let own: Vec<Option<&SlidingContact>> = of.system.channels().iter().map(next).collect();
        if contacts.next().is_some() {
            return Err(cycle::Error::Structure("a contact has no channel of the analysis"));
        }
        let free = |vector: &[(usize, f64)]| -> Vec<(usize, f64)> {
            vector.iter().filter_map(|&(dof, value)| Some((self.kept.position(dof)?, value))).collect()
        };
        let system = &self.brake.system;
        let mut parts = Part::of_terms(system, &at.coefficients);
        let mut springs = SecondOrder::zeros(system.order(), 0);
        let mut contacts = Vec::with_capacity(unchanged.contacts().len());
        for ((channel, gain), place) in system.channels().iter().zip(&at.channels).zip(&self.channels) {
            if let Some(of) = own[*place] {
                contacts.push(SlidingContact { sliding: free(&of.sliding), normal: free(&of.normal), ..of.clone() });
                continue;
            }
            for &(row, b) in &channel.force {
                channel.reading.iter().for_each(|&(column, r)| springs.k[(row, column)] += gain.mu * b * r);
                channel.force.iter().for_each(|&(column, other)| springs.c[(row, column)] += gain.slope * b * other);
            }
        }
        if springs != SecondOrder::zeros(system.order(), 0) {
            parts.push(Part { family: TERM.into(), matrices: springs });
        }
        ContactSystem::new(parts, contacts)
    }
}

/// Adds `size p p^T` at the free degrees of freedom.
fn attach(matrix: &mut DMatrix<f64>, dofs: &DofMap, size: f64, vector: &[(usize, f64)]) {
    let free = || vector.iter().filter_map(|&(dof, value)| Some((dofs.position(dof)?, value)));
    for (row, a) in free() {
        for (column, b) in free() {
            matrix[(row, column)] += size * a * b;
        }
    }
}

/// Sectors of the brake with changes, where these keep the symmetry, else one sector for the whole brake.
fn sectors<'a>(
    brake: &Brake,
    kept: &DofMap,
    channels: &[usize],
    mut added: impl Iterator<Item = &'a SecondOrder>,
) -> Sectors {
    let whole = || Sectors::whole(kept.free().len(), channels.len());
    let couples = |of: &SecondOrder| [&of.m, &of.c, &of.k].map(|a| brake.sectors.are_coupled_by(a)).contains(&true);
    if brake.sectors.iter().len() == 1 || added.any(couples) {
        return whole();
    }
    let dofs: Vec<Option<usize>> = (0..kept.total()).map(|dof| kept.position(dof)).collect();
    let place = |at| channels.iter().position(|&other| other == at);
    let channels: Vec<Option<usize>> = (0..brake.system.channels().len()).map(place).collect();
    brake.sectors.kept(&dofs, &channels).unwrap_or_else(whole)
}
