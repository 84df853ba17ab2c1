//! The capability of a brake whose parameters have names: for sweeps, and for how growth changes with each of them.

use linsys::SecondOrder;

use crate::{Error, Scene};

/// A parameter of a brake that has a name, by which a sweep varies it.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedParameter {
    /// Name of the parameter, as the case file has it.
    pub name: String,
    /// Unit of the parameter, for people.
    pub unit: String,
    /// Value of the parameter where it is not varied.
    pub median: f64,
}

/// Systems as functions of parameters that have names.
pub trait Parametrised: Sync {
    /// Parameters that [`Parametrised::system_with`] gives values to: all on which the systems of a scene depend.
    fn parameters(&self, scene: &Scene) -> Vec<NamedParameter>;

    /// The system of a scene in which some of its [`Parametrised::parameters`], by their indices, have `values`, and all others
    /// their medians.
    ///
    /// # Errors
    /// A value that is not allowed; as [`UncertainBrake::operating_point`](crate::UncertainBrake::operating_point).
    fn system_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, Error>;

    /// The systems of a scene at several sets of values as of [`Parametrised::system_with`], in their order. A brake that makes several at once
    /// for less overrides it.
    fn systems_with(&self, scene: &Scene, values: &[Vec<(usize, f64)>]) -> Vec<Result<SecondOrder, Error>> {
        values.iter().map(|values| self.system_with(scene, values)).collect()
    }

    /// Contact points that open and close as parameters change, by their names; empty where systems are smooth in all parameters.
    fn contact_points(&self, scene: &Scene) -> Vec<String>;

    /// Flags of [`Parametrised::contact_points`], true of those that are closed, at values as of [`Parametrised::system_with`]. Where all flags
    /// are the same systems are smooth functions of the parameters; where one changes, at an *opening*, they kink or jump.
    ///
    /// # Errors
    /// As [`Parametrised::system_with`].
    fn closed_points(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<Vec<bool>, Error>;
}
