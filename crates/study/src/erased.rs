//! A brake whose type of samples is not known, for a program that works on brakes of every kind.

use std::any::Any;

use cycle::ContactSystem;
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::StreamRng;

use crate::{
    DrawnContacts, DrawnInputs, Error, Input, ModeSource, Modifiable, OuterFaces, Parametrised, Plan, Scene,
    SingleParameter, SlidingContacts, UncertainBrake,
};

/// A sample of a brake of any type.
pub struct AnySample(Box<dyn Any + Send + Sync>);

/// A brake whose samples are [`AnySample`]s, so that brakes of different types are one as `dyn UncertainBrake<Sample = AnySample>`.
#[derive(Debug, Clone)]
pub struct Erased<B>(pub B);

impl<B: UncertainBrake<Sample: 'static>> Erased<B> {
    /// The sample as the brake knows it; `None` for one of another brake.
    fn own<'s>(&self, sample: &'s AnySample) -> Option<&'s B::Sample> {
        sample.0.downcast_ref()
    }
}

fn any<S: Send + Sync + 'static>(sample: S) -> AnySample {
    AnySample(Box::new(sample))
}

impl<B: UncertainBrake<Sample: 'static>> UncertainBrake for Erased<B> {
    type Sample = AnySample;

    fn plan(&self) -> &Plan {
        self.0.plan()
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<AnySample, Error> {
        self.0.draw(rng).map(any)
    }

    fn median(&self) -> AnySample {
        any(self.0.median())
    }

    fn operating_point(&self, scene: &Scene, sample: &AnySample) -> Result<OperatingPoint, Error> {
        self.0.operating_point(scene, self.own(sample).ok_or(Error::OtherSample)?)
    }

    fn operating_points(&self, scene: &Scene, samples: &[&AnySample]) -> Vec<Result<OperatingPoint, Error>> {
        match samples.iter().map(|sample| self.own(sample)).collect::<Option<Vec<_>>>() {
            Some(own) => self.0.operating_points(scene, &own),
            None => samples.iter().map(|_| Err(Error::OtherSample)).collect(),
        }
    }

    fn system(&self, scene: &Scene, sample: &AnySample) -> Result<SecondOrder, Error> {
        self.0.system(scene, self.own(sample).ok_or(Error::OtherSample)?)
    }

    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<AnySample>> {
        self.0.drawn_inputs().map(|_| self as _)
    }

    fn parametrised(&self) -> Option<&dyn Parametrised> {
        self.0.parametrised()
    }

    fn modifiable(&self) -> Option<&dyn Modifiable> {
        self.0.modifiable()
    }

    fn mode_source(&self) -> Option<&dyn ModeSource> {
        self.0.mode_source()
    }

    fn error_of_reduction(&self, scene: &Scene) -> f64 {
        self.0.error_of_reduction(scene)
    }

    fn sliding_contacts(&self) -> Option<&dyn SlidingContacts> {
        self.0.sliding_contacts()
    }

    fn outer_faces(&self) -> Option<&dyn OuterFaces> {
        self.0.outer_faces()
    }

    fn drawn_contacts(&self) -> Option<&dyn DrawnContacts<AnySample>> {
        self.0.drawn_contacts().map(|_| self as _)
    }
}

/// Contacts of the inner brake. [`UncertainBrake::drawn_contacts`] hands this out only where the inner brake has some.
impl<B: UncertainBrake<Sample: 'static>> DrawnContacts<AnySample> for Erased<B> {
    fn contact_system_of(&self, scene: &Scene, sample: &AnySample, stick: f64) -> Result<ContactSystem, Error> {
        match (self.0.drawn_contacts(), self.own(sample)) {
            (Some(contacts), Some(sample)) => contacts.contact_system_of(scene, sample, stick),
            _ => Err(Error::OtherSample),
        }
    }
}

/// Inputs of the inner brake. [`UncertainBrake::drawn_inputs`] hands this out only where the inner brake has some.
impl<B: UncertainBrake<Sample: 'static>> DrawnInputs<AnySample> for Erased<B> {
    fn inputs(&self, scene: &Scene) -> Vec<Input> {
        self.0.drawn_inputs().map_or_else(Vec::new, |drawn| drawn.inputs(scene))
    }

    fn input_values(&self, scene: &Scene, sample: &AnySample) -> Vec<f64> {
        match (self.0.drawn_inputs(), self.own(sample)) {
            (Some(drawn), Some(sample)) => drawn.input_values(scene, sample),
            // A sample of another brake has no values here.
            _ => vec![f64::NAN; self.inputs(scene).len()],
        }
    }

    fn quantile_sample(&self, scene: &Scene, uniform: &dyn Fn(u32) -> f64) -> AnySample {
        match self.0.drawn_inputs() {
            Some(drawn) => any(drawn.quantile_sample(scene, uniform)),
            None => any(self.0.median()),
        }
    }

    fn single_parameter(&self, scene: &Scene) -> Option<SingleParameter<'_, AnySample>> {
        let single = self.0.drawn_inputs()?.single_parameter(scene)?;
        Some(SingleParameter::new(single.distribution, move |value| any(single.sample(value))))
    }
}
