//! The seam between a study and a brake whose numbers are uncertain.

use linsys::{OperatingPoint, SecondOrder};
use montecarlo::StreamRng;

use crate::{
    DrawnContacts, DrawnInputs, Error, ModeSource, Modifiable, OuterFaces, Parametrised, Plan, Scene, SlidingContacts,
};

/// A brake with all its uncertain numbers.
///
/// The equations are data, in the [`Plan`]; this trait is what a brake computes: draws, and the numbers that a draw puts into the
/// equations. Spectra, certificates, names of modes, net work, plain sampling, tables and figures follow from these alone. Each further
/// ability of a brake is a capability, a trait of its own; a computation that needs one that is `None` says so by its name.
///
/// A brake whose draws are independent numbers is an [`IndependentBrake`](crate::IndependentBrake), which has
/// [`DrawnInputs`] and [`Parametrised`] too, from its distributions and one function.
pub trait UncertainBrake: Sync {
    /// Draw of all that is uncertain; every scene uses the same.
    type Sample: Send + Sync;

    /// The configurations and scenes of the study.
    fn plan(&self) -> &Plan;

    /// Draws a sample from its own stream.
    ///
    /// # Errors
    /// A draw that is not possible; it is counted, listed and missing from every scene.
    fn draw(&self, rng: &mut StreamRng) -> Result<Self::Sample, Error>;

    /// The sample with the medians of all distributions, from which modes have their names.
    fn median(&self) -> Self::Sample;

    /// The operating point of a sample in a scene of the plan.
    ///
    /// # Errors
    /// A sample that has no operating point there; it is counted and listed.
    fn operating_point(&self, scene: &Scene, sample: &Self::Sample) -> Result<OperatingPoint, Error>;

    /// The operating points of samples of a block, in their order; none may depend on the other samples. A brake that makes several at once
    /// for less overrides it.
    fn operating_points(&self, scene: &Scene, samples: &[&Self::Sample]) -> Vec<Result<OperatingPoint, Error>> {
        samples.iter().map(|sample| self.operating_point(scene, sample)).collect()
    }

    /// The system of a sample in a scene of the plan.
    ///
    /// # Errors
    /// As [`UncertainBrake::operating_point`].
    fn system(&self, scene: &Scene, sample: &Self::Sample) -> Result<SecondOrder, Error> {
        Ok(self.plan().brake(scene).system.assemble(&self.operating_point(scene, sample)?)?)
    }

    /// Drawn inputs, by name and by quantiles: for influence, kept samples and estimators that need fewer samples.
    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<Self::Sample>> {
        None
    }

    /// Parameters by name: for sweeps and for why a mode grows.
    fn parametrised(&self) -> Option<&dyn Parametrised> {
        None
    }

    /// Contacts, places and symmetries of the brake: for screens, which otherwise go by the plan
    /// ([`ModifiablePlan`](crate::ModifiablePlan)).
    fn modifiable(&self) -> Option<&dyn Modifiable> {
        None
    }

    /// Source of the modes, of a brake that finds them itself.
    fn mode_source(&self) -> Option<&dyn ModeSource> {
        None
    }

    /// Relative error of the eigenvalues of a scene against the full model that the brake is a reduction of: a rule, not a bound; 0 for a brake that is not
    /// reduced. A mode whose distance from the threshold is within this error is undecided.
    fn error_of_reduction(&self, scene: &Scene) -> f64 {
        self.mode_source().map_or(0.0, |source| source.relative_error(scene))
    }

    /// Source of the modes of a scene whose system has dashpots where the brake has loss factors ([`ModeSource::has_dashpots_for_losses`]); `None` where the
    /// system is the brake, or a reduction of it.
    fn source_with_losses(&self, scene: &Scene) -> Option<&dyn ModeSource> {
        self.mode_source().filter(|source| source.has_dashpots_for_losses(scene))
    }

    /// Contacts beyond their tangents: for the motion after the onset.
    fn sliding_contacts(&self) -> Option<&dyn SlidingContacts> {
        None
    }

    /// Faces to the air: for the sound of a motion.
    fn outer_faces(&self) -> Option<&dyn OuterFaces> {
        None
    }

    /// Contacts of samples beyond their tangents: for the motions of draws.
    fn drawn_contacts(&self) -> Option<&dyn DrawnContacts<Self::Sample>> {
        None
    }
}

/// Implements [`UncertainBrake`] for pointers to a brake, `dyn UncertainBrake` among them.
macro_rules! forwarded {
    ($($pointer:ty),*) => { $(
        impl<B: UncertainBrake + ?Sized> UncertainBrake for $pointer {
            type Sample = B::Sample;

            fn plan(&self) -> &Plan {
                (**self).plan()
            }

            fn draw(&self, rng: &mut StreamRng) -> Result<B::Sample, Error> {
                (**self).draw(rng)
            }

            fn median(&self) -> B::Sample {
                (**self).median()
            }

            fn operating_point(&self, scene: &Scene, sample: &B::Sample) -> Result<OperatingPoint, Error> {
                (**self).operating_point(scene, sample)
            }

            fn operating_points(&self, scene: &Scene, samples: &[&B::Sample]) -> Vec<Result<OperatingPoint, Error>> {
                (**self).operating_points(scene, samples)
            }

            fn system(&self, scene: &Scene, sample: &B::Sample) -> Result<SecondOrder, Error> {
                (**self).system(scene, sample)
            }

            fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<B::Sample>> {
                (**self).drawn_inputs()
            }

            fn parametrised(&self) -> Option<&dyn Parametrised> {
                (**self).parametrised()
            }

            fn modifiable(&self) -> Option<&dyn Modifiable> {
                (**self).modifiable()
            }

            fn mode_source(&self) -> Option<&dyn ModeSource> {
                (**self).mode_source()
            }

            fn error_of_reduction(&self, scene: &Scene) -> f64 {
                (**self).error_of_reduction(scene)
            }

            fn source_with_losses(&self, scene: &Scene) -> Option<&dyn ModeSource> {
                (**self).source_with_losses(scene)
            }

            fn sliding_contacts(&self) -> Option<&dyn SlidingContacts> {
                (**self).sliding_contacts()
            }

            fn outer_faces(&self) -> Option<&dyn OuterFaces> {
                (**self).outer_faces()
            }

            fn drawn_contacts(&self) -> Option<&dyn DrawnContacts<B::Sample>> {
                (**self).drawn_contacts()
            }
        }
    )* };
}
forwarded!(&B, Box<B>);
