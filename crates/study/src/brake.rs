//! The seam: what a study needs of a brake whose numbers are uncertain.

use cea::Mode;
use linsys::{Channel, OperatingPoint, SecondOrder};
use montecarlo::{Distribution, StreamRng};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use serde::Serialize;
use tracking::OwnedPath;

use super::{Contradiction, Plan, Scene};
use crate::Error;

/// A parameter of a brake that has a name, by which a sweep varies it.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedParameter {
    /// Its name, as the case file has it.
    pub name: String,
    /// Its unit, for people.
    pub unit: String,
    /// Its value where it is not varied.
    pub median: f64,
}

/// A number that is drawn for a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// Its name, as the case file has it; with the number of its contact where each has a draw of its own.
    pub name: String,
    /// Its unit, for people.
    pub unit: String,
    /// The coordinate of [`UncertainBrake::quantile_sample`] that it is a function of.
    pub coordinate: u32,
    /// Whether it depends on another input.
    pub is_correlated: bool,
}

/// The residual of a mode in the system that a brake is a reduction of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeResidual {
    /// Relative to `|lambda|^2 |M| + |lambda| |C| + |K|`.
    pub value: f64,
    /// Whether it is above the one that was asked for.
    pub is_above: bool,
}

/// What draws of a reduced brake are in the whole one: the modes in the band, whether they grow or not.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct FullChecks {
    /// Draws of a scene whose whole brake was solved.
    pub samples: u64,
    /// Its modes.
    pub modes: u64,
    /// Those of them that the reduced brake does not have.
    pub missing: u64,
    /// Modes that only the reduced brake has.
    pub invented: u64,
    /// Modes that surely grow in the whole brake and do not count in the reduced one, or count there and do not grow.
    pub other_verdicts: u64,
    /// Modes of the reduced brake with a residual above the one asked for.
    pub residuals_above: u64,
    /// Draws in which a mode of the whole brake grows next to the band, where it does not count.
    pub growing_beside: u64,
    /// The lowest and the highest frequency of these, Hz.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside_hz: Option<[f64; 2]>,
    /// Draws in which a real eigenvalue of the whole brake grows: divergence, which no sample of a reduced brake shows.
    pub diverging: u64,
    /// The largest of these, 1/s.
    pub divergence: f64,
    /// Draws in which the search for these did not come to an end.
    pub divergence_open: u64,
    /// The largest distance of an eigenvalue from that of the reduced brake, relative to its size.
    pub largest_distance: f64,
    /// How often the reduction was trained on because such draws did not agree.
    pub trained_on: u64,
}

impl FullChecks {
    /// Whether the reduced brake has other modes or verdicts than the whole one.
    pub fn has_other_modes(&self) -> bool {
        self.missing + self.invented + self.other_verdicts > 0
    }

    /// Draws beside others.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            modes: self.modes + other.modes,
            missing: self.missing + other.missing,
            invented: self.invented + other.invented,
            other_verdicts: self.other_verdicts + other.other_verdicts,
            residuals_above: self.residuals_above + other.residuals_above,
            growing_beside: self.growing_beside + other.growing_beside,
            diverging: self.diverging + other.diverging,
            divergence: self.divergence.max(other.divergence),
            divergence_open: self.divergence_open + other.divergence_open,
            beside_hz: self.beside_hz.into_iter().chain(other.beside_hz).reduce(wider),
            largest_distance: self.largest_distance.max(other.largest_distance),
            trained_on: self.trained_on.max(other.trained_on),
        }
    }
}

/// A range that holds two.
pub fn wider([low, high]: [f64; 2], [other_low, other_high]: [f64; 2]) -> [f64; 2] {
    [low.min(other_low), high.max(other_high)]
}

/// A mode at a point where a brake knows its modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownMode {
    /// Which of the known points of a scene, from 0: [`UncertainBrake::known_point`].
    pub point: usize,
    /// Which of the modes there, from 0.
    pub mode: usize,
    /// Its eigenvalue, rad/s.
    pub lambda: Complex<f64>,
}

/// A mode that a brake finds itself.
#[derive(Debug, Clone, PartialEq)]
pub struct BandMode {
    /// The eigenvalue, rad/s.
    pub lambda: Complex<f64>,
    /// The shape over the free degrees of freedom of the configuration.
    pub shape: DVector<Complex<f64>>,
    /// What the eigenvalue is good to, rad/s: a mode nearer than that to the threshold of the plan is undecided.
    pub bound: f64,
    /// The residual in the system that the brake is a reduction of; `None` of a brake that is none.
    pub residual: Option<ModeResidual>,
    /// The mode at a known point near by that it clearly looks like; `None` where there is none.
    pub like: Option<KnownMode>,
}

/// An eigenvalue of the brake that another one is a reduction of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WholeEigenvalue {
    /// rad/s.
    pub lambda: Complex<f64>,
    /// Its error to first order, rad/s: its condition number times its backward error.
    pub bound: f64,
}

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

/// A larger brake of which an origin and a configuration are reductions, in coordinates that they have in common: there the modes of
/// the origin are followed to those of the configuration.
#[derive(Debug)]
pub struct Bridge {
    /// The larger brake at the operating point of the origin.
    pub from: SecondOrder,
    /// The larger brake at the naming point of the configuration.
    pub to: SecondOrder,
    /// The path between these, where the brake evaluates it in a cheaper way than by matrices.
    pub path: Option<Box<dyn OwnedPath>>,
    /// The coordinates of the origin in terms of those in common, as columns.
    pub origin: DMatrix<f64>,
    /// Those of the configuration.
    pub own: DMatrix<f64>,
    /// The coordinates of the origin in terms of those of the configuration: the nearest that these have.
    pub between: DMatrix<f64>,
}

/// A brake with everything that is uncertain in it.
///
/// The equations are data, in the [`Plan`]; this trait is what a brake computes: draws, and the numbers that a draw puts
/// into the equations. Spectra, certificates, names of modes, net work, estimators, tables and figures follow from these
/// alone. The methods with a default are for estimators that need fewer samples.
pub trait UncertainBrake: Sync {
    /// One draw of all that is uncertain; every scene uses the same.
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

    /// The system of a sample in a scene of the plan.
    ///
    /// # Errors
    /// As [`UncertainBrake::operating_point`].
    fn system(&self, scene: &Scene, sample: &Self::Sample) -> Result<SecondOrder, Error> {
        Ok(self.plan().brake(scene).system.assemble(&self.operating_point(scene, sample)?)?)
    }

    /// The sample at a point of the unit cube, by the quantile functions of the parameters: `uniform(d)` in (0, 1) is its
    /// coordinate d, the most important parameters first. `None` where a sample is no such function.
    fn quantile_sample(&self, _scene: &Scene, _uniform: &dyn Fn(u32) -> f64) -> Option<Self::Sample> {
        None
    }

    /// What is drawn and matters in a scene. Constants are not listed.
    fn inputs(&self, _scene: &Scene) -> Vec<Input> {
        Vec::new()
    }

    /// The value that each of the [`UncertainBrake::inputs`] has in a sample.
    fn input_values(&self, _scene: &Scene, _sample: &Self::Sample) -> Vec<f64> {
        Vec::new()
    }

    /// The eigenvalue next to `near` of the brake that this one is a reduction of, with parameters at some values, as
    /// [`UncertainBrake::system_with`] takes them; `None` of a brake that is none.
    ///
    /// # Errors
    /// Values without an operating point, an eigenvalue that cannot be found.
    fn whole_eigenvalue(
        &self,
        _scene: &Scene,
        _values: &[(usize, f64)],
        _near: Complex<f64>,
    ) -> Result<Option<WholeEigenvalue>, Error> {
        Ok(None)
    }

    /// Within which part of its size an eigenvalue of a scene is taken to be that of the brake that this one is a reduction of: a rule, not
    /// a bound; 0 of a brake that is none.
    fn relative_error(&self, _scene: &Scene) -> f64 {
        0.0
    }

    /// The distribution of the one parameter that the operating points of a scene are a function of; `None` where there
    /// are more, or none.
    fn single_parameter(&self, _scene: &Scene) -> Option<&Distribution> {
        None
    }

    /// The sample in which that parameter has a value and all others their medians; `None` of a brake that has no such parameter.
    fn with_parameter(&self, _scene: &Scene, _value: f64) -> Option<Self::Sample> {
        None
    }

    /// What the modes of a configuration, by its place in the plan, have in common with those of its origin, where the degrees of
    /// freedom of both are not the same; `modes` are those of the origin and its own. Asked of a brake with one sector that finds its modes
    /// itself.
    ///
    /// # Errors
    /// Medians that have no operating point.
    fn bridge(&self, _configuration: usize, _modes: [&[Mode]; 2]) -> Result<Option<Bridge>, Error> {
        Ok(None)
    }

    /// Whether the brake finds the modes of a sample itself: those in the band of the plan, which it must have.
    fn has_band_modes(&self) -> bool {
        false
    }

    /// The modes of some samples of a scene in the band of the plan, of a brake that finds them itself; those that are surely stable may be
    /// missing. Such a brake has one sector.
    ///
    /// # Errors
    /// Of a sample: an operating point of another scene, a system that is not supported.
    fn band_modes(&self, _scene: &Scene, at: &[OperatingPoint]) -> Vec<Result<Vec<BandMode>, Error>> {
        at.iter().map(|_| Ok(Vec::new())).collect()
    }

    /// The path between two operating points of a scene, of a brake that evaluates it in a cheaper way than by matrices. Such a brake has one
    /// sector.
    fn path(&self, _scene: &Scene, _from: &OperatingPoint, _to: &OperatingPoint) -> Option<Box<dyn OwnedPath + '_>> {
        None
    }

    /// A point at which the brake knows the modes of a scene, from which samples near by may have their names.
    fn known_point(&self, _scene: &Scene, _point: usize) -> Option<OperatingPoint> {
        None
    }

    /// What draws against the brake that this one is a reduction of have shown; `None` of one that was not checked.
    fn full_checks(&self) -> Option<FullChecks> {
        None
    }

    /// The symmetries of the brake with a set of constraints, all contacts closed, the identity first; its plan has with each
    /// arrangement all those that these make of it. Without any the list is empty.
    fn symmetries(&self, _constraints: usize) -> Vec<Symmetry> {
        Vec::new()
    }

    /// Which of these maps the configuration of a scene onto one of its [`Scene::members`], by its place there.
    fn symmetry_of_member(&self, _scene: &Scene, _member: usize) -> usize {
        0
    }

    /// The closed contacts of a scene, each of which can be taken out as a whole.
    fn contacts(&self, scene: &Scene) -> Vec<WholeContact> {
        let channels = self.plan().brake(scene).system.channels().iter().enumerate();
        let whole = |(at, channel): (usize, &Channel)| WholeContact {
            number: at,
            name: channel.name.clone(),
            channels: vec![at],
            structure: None,
        };
        channels.map(whole).collect()
    }

    /// Where something can be attached to the brake with a set of constraints; `None` of a brake whose degrees of freedom are
    /// such places.
    ///
    /// # Errors
    /// Medians that have no operating point.
    fn places(&self, _constraints: usize) -> Result<Option<Vec<Place>>, Error> {
        Ok(None)
    }

    /// The parameters that [`UncertainBrake::system_with`] gives values to: all on which the systems of a scene depend.
    fn parameters(&self, _scene: &Scene) -> Vec<NamedParameter> {
        Vec::new()
    }

    /// The system of a scene in which some of its [`UncertainBrake::parameters`], by their places, have values, and all others
    /// their medians.
    ///
    /// # Errors
    /// A value that is not allowed; as [`UncertainBrake::operating_point`]; any value, of a brake that has no parameters.
    fn system_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, Error> {
        if values.is_empty() {
            return self.system(scene, &self.median());
        }
        let (method, needed_by) = ("system_with()", "parameters(), with a value of one of them,");
        Err(Contradiction::NotGiven { scene: self.plan().describe(scene), method, needed_by }.into())
    }
}
