//! The capability of a brake that can be modified: contacts as wholes, places where something can be attached, symmetries.

use linsys::SecondOrder;
use serde::{Deserialize, Serialize};

use crate::{Error, Plan, Scene, origin_of_set};

/// A relabelling of degrees of freedom and contacts that maps a brake onto itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symmetry {
    /// Map of the degrees of freedom, held ones too: degree of freedom i becomes `dofs[i]`.
    pub dofs: Vec<usize>,
    /// Map of the contacts, by [`WholeContact::number`]: contact i becomes `contacts[i]`.
    pub contacts: Vec<usize>,
}

/// A contact with all that is there because of it.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeContact {
    /// Number of the contact, from 0, the same in all configurations.
    pub number: usize,
    /// Name of the contact.
    pub name: String,
    /// Indices of its channels in the system of a configuration.
    pub channels: Vec<usize>,
    /// Damping and stiffness of the contact over the free degrees of freedom of the configuration; `None` where they are not known apart
    /// from the rest, so that only its friction can be taken away.
    pub structure: Option<SecondOrder>,
}

/// Attachment point: where a mass, springs and dashpots to ground can be attached to a brake.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Name of the place: a body, a degree of freedom, a set of nodes.
    pub name: String,
    /// Directions in which the place moves; a mass acts in all of them, a spring or dashpot in one.
    pub directions: Vec<Direction>,
}

/// Direction in which a [`Place`] moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// Name of the direction.
    pub name: String,
    /// Number of the degree of freedom in this direction, held ones counted; `None` where the direction is a combination of several, which
    /// cannot be held by taking out a row.
    pub dof: Option<usize>,
    /// Vectors p over all degrees of freedom, as (index, value) entries: attaching a matrix entry of size s adds `s sum p p^T`.
    pub parts: Vec<Vec<(usize, f64)>>,
    /// Own mass and stiffness of the direction, to which the size of an attachment is in proportion.
    pub own: OwnSize,
    /// Kind of the motion, on which the units of attachments depend.
    pub moves: Moves,
}

/// Kind of the motion of a degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Moves {
    /// A displacement along a line.
    Along,
    /// A rotation.
    Turns,
    /// A translation, a rotation or an amplitude of something else: whoever made the brake does not say.
    #[default]
    Unknown,
}

/// Own mass and stiffness of a [`Direction`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnSize {
    /// Mass, kg; of a rotation the moment of inertia, kg m^2.
    pub mass: f64,
    /// Stiffness, N/m; of a rotation Nm/rad.
    pub stiffness: f64,
}

/// Changes that can be made to a brake beside holding degrees of freedom and taking out the channels of its plan.
pub trait Modifiable: Sync {
    /// The closed contacts of a scene, each of which can be taken out as a whole.
    fn contacts(&self, scene: &Scene) -> Vec<WholeContact>;

    /// Attachment points of the brake with a set of constraints; `None` where its degrees of freedom are such places.
    ///
    /// # Errors
    /// Medians that have no operating point.
    fn places(&self, constraints: usize) -> Result<Option<Vec<Place>>, Error>;

    /// Names of the terms of the brake that are parts of it, whose stiffness, damping and mass can be scaled; none of a reduced brake, whose basis need not
    /// contain the modes of the scaled brake.
    fn scalable_terms(&self, constraints: usize) -> Vec<String>;

    /// The symmetries of the brake with a set of constraints, all contacts closed, the identity first; with each arrangement the plan has
    /// all others that the symmetries make of it. Without any the list is empty.
    fn symmetries(&self, constraints: usize) -> Vec<Symmetry>;

    /// Index, in [`Modifiable::symmetries`], of the symmetry that maps the configuration of a scene onto the arrangement of one of its
    /// [`Scene::members`]; `member` is an index there.
    fn symmetry_of_member(&self, scene: &Scene, member: usize) -> usize;

    /// True if with each draw all members of a scene have the same eigenvalues, and not only with all draws together the same distribution of them.
    fn members_are_equal(&self) -> bool;
}

/// Modifiable parts of a brake that is known by its plan alone: the channels of one name are one contact, in whichever configurations they
/// are, of which only the friction can be taken away; the degrees of freedom are the places, several terms are parts, and there are no symmetries.
pub struct ModifiablePlan<'a>(pub &'a Plan);

impl Modifiable for ModifiablePlan<'_> {
    fn contacts(&self, scene: &Scene) -> Vec<WholeContact> {
        let configurations = &self.0.configurations;
        let mut names: Vec<&str> = Vec::new();
        for channel in configurations.iter().flat_map(|configuration| configuration.brake.system.contacts()) {
            if !names.contains(&channel.name.as_str()) {
                names.push(&channel.name);
            }
        }
        let channels = self.0.brake(scene).system.channels();
        let whole = |(number, name): (usize, &str)| {
            let channels: Vec<usize> =
                (0..channels.len()).filter(|&at| channels[at].is_contact && channels[at].name == name).collect();
            (!channels.is_empty()).then(|| WholeContact { number, name: name.into(), channels, structure: None })
        };
        names.into_iter().enumerate().filter_map(whole).collect()
    }

    fn places(&self, _constraints: usize) -> Result<Option<Vec<Place>>, Error> {
        Ok(None)
    }

    fn scalable_terms(&self, constraints: usize) -> Vec<String> {
        let origin = origin_of_set(self.0, constraints);
        let Some(system) = origin.map(|origin| &self.0.origins[origin].brake.system) else { return Vec::new() };
        let terms = system.terms();
        // A term alone is the brake and no part of it; what relaxes is not in the matrices of its term.
        let relaxes = |name: &str| system.channels().iter().any(|channel| !channel.is_contact && channel.name == name);
        let parts = terms.iter().filter(|term| terms.len() > 1 && !relaxes(&term.name));
        parts.map(|term| term.name.clone()).collect()
    }

    fn symmetries(&self, _constraints: usize) -> Vec<Symmetry> {
        Vec::new()
    }

    fn symmetry_of_member(&self, _scene: &Scene, _member: usize) -> usize {
        0
    }

    fn members_are_equal(&self) -> bool {
        self.0.scenes.iter().all(|scene| scene.members.len() == 1)
    }
}
