//! The capability of a brake that can be modified: contacts as wholes, places where something can be attached, symmetries.

use linsys::{Channel, SecondOrder};

use crate::{Error, Plan, Scene};

/// A relabelling of degrees of freedom and contacts that maps a brake onto itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symmetry {
    /// What each degree of freedom, held ones too, becomes.
    pub dofs: Vec<usize>,
    /// What each contact becomes, by [`WholeContact::number`].
    pub contacts: Vec<usize>,
}

/// A contact with all that is there because of it.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeContact {
    /// Its number, from 0, the same in all configurations.
    pub number: usize,
    /// What it is called.
    pub name: String,
    /// Its channels, as places in the system of a configuration.
    pub channels: Vec<usize>,
    /// Its damping and stiffness over the free degrees of freedom of the configuration; `None` where they are not known apart from
    /// the rest, so that only its friction can be taken away.
    pub structure: Option<SecondOrder>,
}

/// Where a mass, springs and dashpots to ground can be attached to a brake.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// What it is called: a body, a degree of freedom, a set of nodes.
    pub name: String,
    /// The directions in which it moves; a mass acts in all of them, a spring or dashpot in one.
    pub directions: Vec<Direction>,
}

/// One direction of a [`Place`].
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// What it is called.
    pub name: String,
    /// The degree of freedom that it is, by its number with held ones counted; `None` where it is a combination of several, which
    /// cannot be held by taking out a row.
    pub dof: Option<usize>,
    /// Vectors p over all degrees of freedom: attaching a matrix entry of size s adds `s sum p p^T`.
    pub parts: Vec<Vec<(usize, f64)>>,
    /// The mass, kg, and the stiffness, N/m, of its own, to which the size of what is attached is in proportion.
    pub own: OwnSize,
}

/// What a direction has of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnSize {
    /// kg.
    pub mass: f64,
    /// N/m.
    pub stiffness: f64,
}

/// What can be changed in a brake beside holding degrees of freedom and taking out the channels of its plan.
pub trait Modifiable: Sync {
    /// The closed contacts of a scene, each of which can be taken out as a whole.
    fn contacts(&self, scene: &Scene) -> Vec<WholeContact>;

    /// Where something can be attached to the brake with a set of constraints; `None` where its degrees of freedom are such places.
    ///
    /// # Errors
    /// Medians that have no operating point.
    fn places(&self, constraints: usize) -> Result<Option<Vec<Place>>, Error>;

    /// The symmetries of the brake with a set of constraints, all contacts closed, the identity first; its plan has with each
    /// arrangement all those that these make of it. Without any the list is empty.
    fn symmetries(&self, constraints: usize) -> Vec<Symmetry>;

    /// Which of these maps the configuration of a scene onto one of its [`Scene::members`], by its place there.
    fn symmetry_of_member(&self, scene: &Scene, member: usize) -> usize;
}

/// The contacts of a brake that is known by its plan alone: each channel is one, of which only the friction can be taken away, the
/// degrees of freedom are the places, and there are no symmetries.
pub struct ModifiablePlan<'a>(pub &'a Plan);

impl Modifiable for ModifiablePlan<'_> {
    fn contacts(&self, scene: &Scene) -> Vec<WholeContact> {
        let channels = self.0.brake(scene).system.channels().iter().enumerate();
        let whole = |(at, channel): (usize, &Channel)| WholeContact {
            number: at,
            name: channel.name.clone(),
            channels: vec![at],
            structure: None,
        };
        channels.map(whole).collect()
    }

    fn places(&self, _constraints: usize) -> Result<Option<Vec<Place>>, Error> {
        Ok(None)
    }

    fn symmetries(&self, _constraints: usize) -> Vec<Symmetry> {
        Vec::new()
    }

    fn symmetry_of_member(&self, _scene: &Scene, _member: usize) -> usize {
        0
    }
}
