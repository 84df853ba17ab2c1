//! The capabilities of a brake whose contacts are known beyond their tangents, at values of its parameters and of its samples: for the motion
//! after the onset.

use cycle::ContactSystem;

use crate::{Error, Scene};

/// Contacts that may open, slide and stick.
pub trait SlidingContacts: Sync {
    /// The equations of motion of a scene in which some of the brake's [`Parametrised`](crate::Parametrised) parameters, by their indices, have `values`,
    /// and all others their medians. A contact counts as sticking where it slides more slowly than the fraction `stick`, above 0 and below 1, of its speed
    /// of steady sliding.
    ///
    /// # Errors
    /// A contact whose load, speed, spring or law is not known; as [`UncertainBrake::operating_point`](crate::UncertainBrake::operating_point).
    fn contact_system(&self, scene: &Scene, values: &[(usize, f64)], stick: f64) -> Result<ContactSystem, Error>;
}

/// Contacts that may open, slide and stick, of samples.
pub trait DrawnContacts<S>: Sync {
    /// The equations of motion of a sample in a scene; `stick` as in [`SlidingContacts::contact_system`], which has the same equations for the medians.
    ///
    /// # Errors
    /// As [`SlidingContacts::contact_system`].
    fn contact_system_of(&self, scene: &Scene, sample: &S, stick: f64) -> Result<ContactSystem, Error>;
}
