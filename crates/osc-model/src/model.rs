//! The seam that every brake model implements: structure once per contact arrangement, linearisation once per sample.

use linsys::SecondOrder;

use crate::ContactArrangement;

/// A brake whose contacts can be open or closed.
pub trait BrakeModel {
    /// What changes from sample to sample: the state of sliding.
    type Sliding;
    /// What the model refuses.
    type Error: std::error::Error;
    /// The model with one arrangement of contacts.
    type Prepared: Linearise<Sliding = Self::Sliding, Error = Self::Error>;

    /// Assembles all that does not change from sample to sample.
    ///
    /// # Errors
    /// An arrangement that the model does not have.
    fn prepare(&self, arrangement: &ContactArrangement) -> Result<Self::Prepared, Self::Error>;
}

/// A model with its contacts fixed, to be linearised about many states of sliding.
pub trait Linearise {
    /// What changes from sample to sample.
    type Sliding;
    /// What the linearisation refuses.
    type Error: std::error::Error;

    /// The part without friction: M, the dashpots C, and the elastic K with every contact spring; no internal states.
    fn structural(&self) -> &SecondOrder;

    /// Writes the friction part alone to `out`: m = 0, and k without any elastic contribution.
    ///
    /// # Errors
    /// A state of sliding that is malformed; `out` is then unspecified.
    fn linearise_friction(&self, sliding: &Self::Sliding, out: &mut SecondOrder) -> Result<(), Self::Error>;

    /// Writes the linearised system to `out`. Nothing is allocated if `out` already has its order and states.
    ///
    /// # Errors
    /// A state of sliding that is malformed; `out` is then unspecified.
    fn linearise(&self, sliding: &Self::Sliding, out: &mut SecondOrder) -> Result<(), Self::Error>;

    /// The linearised system in memory of its own.
    ///
    /// # Errors
    /// As [`Linearise::linearise`].
    fn linearised(&self, sliding: &Self::Sliding) -> Result<SecondOrder, Self::Error> {
        let mut out = SecondOrder::zeros(self.structural().order(), 0);
        self.linearise(sliding, &mut out)?;
        Ok(out)
    }
}
