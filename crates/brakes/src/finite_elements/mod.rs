//! A finite element brake of a case, reduced, with its friction laws and distributions.

mod bridge;
mod divergence;
mod full_checks;
mod layout;
mod parameters;
mod places;
mod points;
mod reduce;
mod samples;
mod set_basis;
mod sliding;
mod swept;
mod training;
mod whole;

pub use points::{at_medians, frictionless, loads_at_medians};
pub use reduce::{BESIDE, Bases, Part, ReducedSet, Rung};

use std::sync::PoisonError;

use cea::Mode;
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::{Distribution, Progress, StreamRng};
use nalgebra::DVectorView;
use num_complex::Complex;
use reduction::{ReducedModes, ReductionError, RouteCounts};
use study::{
    BandMode, Bridge, CoarsePath, Cost, DrawnInputs, FullChecks, Input, ModeResidual, ModeSource, Modifiable,
    NamedParameter, Parametrised, Place, Plan, Scene, SingleParameter, Symmetry, UncertainBrake, WholeContact,
    WholeEigenvalue,
};
use sweep::Over;

use self::parameters::SceneOf;
use self::reduce::Trained;
use super::LatticeSample;
use super::lattice::{DrawnFriction, OF_CONTACT};
use crate::case::{CaseError, Draws, FiniteElementCase, Law, Parameter};
use crate::prepared::Pieces;
use crate::{CaseBrake, Error, Prepared, Purpose};

/// Factor of the relative error that is assumed of an eigenvalue. It multiplies the sum of two distances, each the largest that was measured,
/// relative: of eigenvalues on the basis of a part from those on the basis of its set, and of these from those of the whole brake. Chosen;
/// how far off samples really are is told by those that are solved with the whole brake.
const ALLOWANCE: f64 = 100.0;
/// Least assumed error of an eigenvalue, relative to |lambda|: three times the largest distance in 130 samples of cases/disc-pad that were
/// solved with the whole brake.
const LEAST_ERROR: f64 = 1e-5;
/// Factor of the largest residual at draws of which a basis of modes was not made, up to which the distance that was measured there is taken to tell the
/// error of a mode; chosen.
const BEYOND_HELD_OUT: f64 = 10.0;
/// Columns that a basis is expected to have before it is made. Measured with cases/disc-pad (100) and its refinement to 75 pairs (150).
const EXPECTED_COLUMNS: usize = 130;

/// Finite element brake of a case, reduced: a dense brake for each configuration in place of the mesh.
///
/// Each set of constraints has one basis, in which the modes of all its arrangements of closed patches can be written. Each part, some
/// configurations that are studied together, has a smaller basis, whose columns are combinations of those of its set.
#[derive(Debug)]
pub struct FiniteElementBrake {
    /// The case.
    pub case: FiniteElementCase,
    /// The scenes of the case.
    pub plan: Plan,
    /// The brake with each set of constraints.
    pub sets: Vec<ReducedSet>,
    /// The brake on its smaller bases.
    pub parts: Vec<Part>,
    /// The system of each set of constraints at the point where its modes are named.
    naming_systems: Vec<SecondOrder>,
    /// The part of each set of constraints with all patches closed.
    of_origins: Vec<usize>,
    /// The part of each configuration of the plan.
    of_configurations: Vec<usize>,
    /// The closed patches of each configuration of the plan, from 0; none without a contact.
    closed: Vec<Vec<usize>>,
    /// Draws against the whole brake, where it was checked.
    full_checks: Option<FullChecks>,
}

/// Sample: a draw of all that is uncertain.
#[derive(Debug, Clone, PartialEq)]
pub struct FiniteElementSample {
    /// The parameters of coefficients.
    pub values: Vec<f64>,
    /// Friction and speed; `None` without a contact.
    pub contacts: Option<LatticeSample>,
}

/// Divergence of a finite element brake at an operating point: what grows faster than it oscillates, beyond the threshold.
#[derive(Debug, Clone, PartialEq)]
pub struct Diverging {
    /// Eigenvalues of the whole brake that do, Im >= 0, 1/s, up to 2 pi times the highest frequency of the band in size, by ascending growth. `None`
    /// where a search does not tell, or the reduced brake alone has any there.
    pub whole: Option<Vec<Complex<f64>>>,
    /// True if the reduced brake has any beyond that size: so has the whole one, at growth rates that are not known.
    pub beyond: bool,
}

impl Diverging {
    /// Whether anything diverges; `None` where that could not be told.
    #[must_use]
    pub fn any(&self) -> Option<bool> {
        if self.beyond { Some(true) } else { self.whole.as_ref().map(|whole| !whole.is_empty()) }
    }
}

impl FiniteElementBrake {
    /// Reduces the brake, each arrangement on a basis of its own, and lays out its scenes: what a study is fastest with.
    ///
    /// # Errors
    /// Refusals of the reduction; [`study::Error::Median`] where the medians of the parameters have no operating point.
    pub fn new(case: FiniteElementCase, progress: &dyn Progress) -> Result<Self, Error> {
        Self::on(case, Bases::OfEach, progress)
    }

    /// Reduces the brake for a purpose, of pieces that are read where they are kept.
    ///
    /// # Errors
    /// As [`FiniteElementBrake::new`] and [`FiniteElementBrake::for_sweep`]; a file of another prepared brake.
    pub fn prepared(
        case: FiniteElementCase,
        purpose: Purpose<'_>,
        prepared: &Prepared,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let pieces = prepared.of(&case)?;
        match purpose {
            Purpose::Study => Self::checked_of((case, &pieces), progress),
            Purpose::Analysis => Self::with_points((case, &pieces), Bases::OfEach, (&[], &[]), progress),
            Purpose::Screen => Self::with_points((case, &pieces), Bases::OfEachSet, (&[], &[]), progress),
            Purpose::Sweep(over) => {
                let swept = swept::points(&case, over)?;
                Self::with_points((case, &pieces), Bases::OfEach, (&swept, &[]), progress)
            }
        }
    }

    /// Finds the modes of samples by whole spectra alone, without coarse modes.
    pub fn use_spectra_alone(&mut self) {
        for part in &mut self.parts {
            part.reduced = part.reduced.clone().without_coarse();
        }
    }

    /// Number of samples that each way has found so far, in all scenes.
    #[must_use]
    pub fn routes(&self) -> RouteCounts {
        // What a panic of another thread left is a count all the same.
        self.parts.iter().map(|part| *part.routes.lock().unwrap_or_else(PoisonError::into_inner)).sum()
    }

    /// Reduces the brake as [`FiniteElementBrake::new`] does, but for its first scene so that the basis holds the modes over ranges of
    /// parameters that a sweep goes through, which may be wider than what is drawn.
    ///
    /// # Errors
    /// As [`FiniteElementBrake::new`]; a parameter or a range that the scene does not have, or for which it has no operating point.
    pub fn for_sweep(case: FiniteElementCase, over: &[Over], progress: &dyn Progress) -> Result<Self, Error> {
        Self::prepared(case, Purpose::Sweep(over), &Prepared::default(), progress)
    }

    /// Reduces the brake and lays out its scenes. Only with [`Bases::OfEachSet`] are there [`Modifiable::places`].
    ///
    /// # Errors
    /// As [`FiniteElementBrake::new`].
    pub fn on(case: FiniteElementCase, bases: Bases, progress: &dyn Progress) -> Result<Self, Error> {
        let nowhere = Prepared::default();
        let pieces = nowhere.of(&case)?;
        Self::with_points((case, &pieces), bases, (&[], &[]), progress)
    }

    /// Reduces the brake; the points are `swept` ones, at which the modes of the first configuration shall be held in the place of draws, and further ones that
    /// are `trained` on.
    fn with_points(
        (case, pieces): (FiniteElementCase, &Pieces<'_>),
        bases: Bases,
        points: (&[OperatingPoint], &[Trained]),
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let reduce::AllBases { sets, parts, of_origins, of_configurations } =
            reduce::all_bases((&case, pieces), bases, points, progress).map_err(named_band(&case))?;
        let part = |at: usize| &parts[at].reduced;
        let of_origins_parts: Vec<_> = of_origins.iter().map(|&at| part(at)).collect();
        let of_configurations_parts: Vec<_> = of_configurations.iter().map(|&at| part(at)).collect();
        let (plan, closed) = layout::plan(&case, &of_origins_parts, &of_configurations_parts)?;
        let naming_systems =
            sets.iter().map(|set| bridge::naming_system(&case, &set.reduced)).collect::<Result<_, Error>>()?;
        Ok(Self { case, plan, sets, parts, naming_systems, of_origins, of_configurations, closed, full_checks: None })
    }

    /// Memory and processor time of the bases of a case, roughly, before any of them is made.
    pub fn expected_cost(case: &FiniteElementCase) -> Cost {
        let arrangements =
            case.contact.as_ref().map_or(1, |contact| contact.panels.iter().map(|(_, all)| all.len()).sum());
        let columns = vec![EXPECTED_COLUMNS; arrangements];
        let solutions = case.constraints.len() * set_basis::SOLUTIONS;
        Cost::of_bases(case.dofs.len(), &columns.repeat(case.constraints.len())).with_solutions(solutions)
    }

    /// Memory and processor time of its bases and of the draws that a study solves with the whole brake, roughly.
    pub fn cost_of_bases(&self) -> Cost {
        let columns: Vec<usize> = self.parts.iter().map(|part| part.within.basis.ncols()).collect();
        let solutions = self.case.constraints.len() * set_basis::SOLUTIONS + self.case.reduction.full_checks as usize;
        Cost::of_bases(self.case.dofs.len(), &columns).with_solutions(solutions)
    }

    /// The part of the reduction that a scene is on.
    pub fn part(&self, scene: &Scene) -> &Part {
        &self.parts[self.of_configurations[scene.configuration]]
    }

    /// The part of a set of constraints in which its modes have their names: with all patches closed.
    pub fn origin(&self, constraints: usize) -> &Part {
        &self.parts[self.of_origins[constraints]]
    }

    /// Cost against error of a set of constraints with all patches closed: what fewer columns of its basis hold.
    ///
    /// # Errors
    /// A draw without an operating point.
    pub fn rungs(&self, constraints: usize) -> Result<Vec<Rung>, Error> {
        reduce::rungs_of(&self.case, &self.sets[constraints], self.origin(constraints))
    }

    /// True if the distance of the modes of a part from those of its set was measured, on a basis that holds them.
    fn is_known(&self, part: &Part) -> bool {
        part.within.is_reached || part.within.basis.ncols() == self.sets[part.set].basis.ncols()
    }

    /// The closed patches of a scene, from 0.
    pub fn closed(&self, scene: &Scene) -> &[usize] {
        &self.closed[scene.configuration]
    }

    /// The operating point of the whole brake, reduced or not, from that of a scene.
    pub fn full_point(&self, scene: &Scene, at: &OperatingPoint) -> OperatingPoint {
        points::of_brake(&self.case, self.closed(scene), at)
    }

    /// Law of a scene, and the distributions from which its friction is drawn; `None` without a contact.
    fn drawn(&self, scene: &Scene) -> Option<DrawnFriction<'_>> {
        let contact = self.case.contact.as_ref()?;
        Some(DrawnFriction {
            law: contact.laws[scene.key.law],
            from: &contact.friction,
            correlation: self.case.correlation.as_ref(),
            draws: contact.draws,
            has_lateral_mu: false,
            has_bristle_damping: contact.bristle_damping.is_some(),
        })
    }

    /// Number of contacts that have a draw of their own.
    fn drawn_contacts(&self) -> usize {
        let contact = self.case.contact.as_ref().filter(|contact| contact.draws == Draws::Each);
        contact.map_or(1, |contact| contact.patches.len())
    }

    /// The coordinate of the first parameter of coefficients, after those of friction.
    fn first_parameter(&self) -> u32 {
        OF_CONTACT * self.drawn_contacts() as u32
    }

    /// Number of friction parameters, which are before those of coefficients in a correlation.
    fn friction_parameters(&self) -> usize {
        self.case.contact.as_ref().map_or(0, |contact| contact.friction.of_draw().len())
    }

    fn speed_is_drawn(&self, scene: &Scene) -> bool {
        let range = self.case.contact.as_ref().zip(scene.key.speed).map(|(contact, range)| &contact.speeds[range]);
        range.is_some_and(|range| range.to > range.from)
    }

    /// Parameters of coefficients that are not constant, with their indices.
    fn varying(&self) -> impl Iterator<Item = (usize, &Parameter)> {
        let varies =
            |(_, parameter): &(usize, &Parameter)| !matches!(parameter.distribution, Distribution::Constant { .. });
        self.case.parameters.iter().enumerate().filter(varies)
    }

    fn law_and_speed(&self, scene: &Scene, sample: &FiniteElementSample) -> Option<(Law, f64)> {
        samples::law_and_speed(&self.case, self.scene_of(scene).state, sample)
    }

    fn scene_of(&self, scene: &Scene) -> SceneOf<'_> {
        let state = self.case.contact.as_ref().map(|contact| (contact.laws[scene.key.law], scene.key.speed));
        SceneOf { case: &self.case, closed: self.closed(scene), state }
    }
}

/// The error of a band without a mode names the band.
fn named_band(case: &FiniteElementCase) -> impl Fn(Error) -> Error + '_ {
    |error| match error {
        Error::Reduction(ReductionError::NoModes) => CaseError::Value {
            path: case.header.path.clone(),
            field: "reduction.frequencies".into(),
            value: format!("{:?}", case.reduction.frequencies),
            allowed: format!(
                "a band with a mode of the brake, which has none there with a growth above {} 1/s",
                case.reduction.growth[0]
            ),
        }
        .into(),
        error => error,
    }
}

impl UncertainBrake for FiniteElementBrake {
    type Sample = FiniteElementSample;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<FiniteElementSample, study::Error> {
        Ok(samples::draw(&self.case, rng)?)
    }

    fn median(&self) -> FiniteElementSample {
        samples::median(&self.case)
    }

    fn operating_point(&self, scene: &Scene, sample: &FiniteElementSample) -> Result<OperatingPoint, study::Error> {
        Ok(points::scene_point(&self.case, self.closed(scene), self.law_and_speed(scene, sample), sample)?)
    }

    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<FiniteElementSample>> {
        Some(self)
    }

    fn parametrised(&self) -> Option<&dyn Parametrised> {
        Some(self)
    }

    fn modifiable(&self) -> Option<&dyn Modifiable> {
        Some(self)
    }

    fn mode_source(&self) -> Option<&dyn ModeSource> {
        Some(self)
    }
}

impl DrawnInputs<FiniteElementSample> for FiniteElementBrake {
    fn inputs(&self, scene: &Scene) -> Vec<Input> {
        let of_contact = self.drawn(scene).map(|drawn| drawn.inputs(self.closed(scene), self.speed_is_drawn(scene)));
        let mut inputs = of_contact.unwrap_or_default();
        for input in &mut inputs {
            input.unit = self.case.header.units.of(&input.unit).to_owned();
        }
        inputs.extend(self.varying().map(|(at, parameter)| Input {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            coordinate: self.first_parameter() + at as u32,
            is_correlated: self.case.correlation.as_ref().is_some_and(|of| of.holds(self.friction_parameters() + at)),
            has_atoms: parameter.distribution.has_atoms(),
        }));
        inputs
    }

    fn input_values(&self, scene: &Scene, sample: &FiniteElementSample) -> Vec<f64> {
        let mut values = match (self.drawn(scene), &sample.contacts) {
            (Some(drawn), Some(contacts)) => drawn.values(self.closed(scene), contacts),
            _ => Vec::new(),
        };
        let speed = self.law_and_speed(scene, sample).filter(|_| self.speed_is_drawn(scene));
        values.extend(speed.map(|(_, speed)| speed));
        values.extend(self.varying().map(|(at, _)| sample.values[at]));
        values
    }

    fn quantile_sample(&self, scene: &Scene, uniform: &dyn Fn(u32) -> f64) -> FiniteElementSample {
        let parameters = self.case.parameters.iter().zip(self.first_parameter()..);
        let sample = FiniteElementSample {
            values: parameters.map(|(p, coordinate)| p.distribution.quantile(uniform(coordinate))).collect(),
            contacts: self
                .drawn(scene)
                .map(|drawn| DrawnFriction { correlation: None, ..drawn }.sample(self.drawn_contacts(), uniform)),
        };
        samples::correlated(&self.case, sample)
    }

    /// Shared Amontons-Coulomb friction depends on mu alone where nothing else is drawn, none acts across the sliding and no point opens.
    fn single_parameter(&self, scene: &Scene) -> Option<SingleParameter<'_, FiniteElementSample>> {
        let contact = self.case.contact.as_ref()?;
        let is_single = !points::depends_on_speed(contact, contact.laws[scene.key.law])
            && contact.balance.is_none()
            && contact.draws == Draws::Shared
            && self.case.parameters.iter().all(|p| matches!(p.distribution, Distribution::Constant { .. }));
        let with = |mu: f64| {
            let median = self.median();
            let contacts = median.contacts.map(|sample| {
                let draw = super::FrictionDraw { mu, lateral_mu: mu, ..*sample.contact(0) };
                LatticeSample::shared(draw, sample.speed_quantile)
            });
            FiniteElementSample { contacts, ..median }
        };
        is_single.then(|| SingleParameter::new(&contact.friction.mu, with))
    }
}

impl Parametrised for FiniteElementBrake {
    fn parameters(&self, scene: &Scene) -> Vec<NamedParameter> {
        parameters::named(&self.scene_of(scene))
    }

    fn system_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, study::Error> {
        let at = parameters::point(&self.scene_of(scene), values)?;
        Ok(self.part(scene).reduced.system().assemble(&at)?)
    }

    fn contact_points(&self, scene: &Scene) -> Vec<String> {
        parameters::contact_points(&self.scene_of(scene))
    }

    fn closed_points(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<Vec<bool>, study::Error> {
        Ok(parameters::closed_points(&self.scene_of(scene), values)?)
    }
}

impl Modifiable for FiniteElementBrake {
    fn contacts(&self, scene: &Scene) -> Vec<WholeContact> {
        places::contacts(self, scene)
    }

    fn places(&self, constraints: usize) -> Result<Option<Vec<Place>>, study::Error> {
        Ok(places::places(self, constraints).map(Some)?)
    }

    fn symmetries(&self, _: usize) -> Vec<Symmetry> {
        Vec::new()
    }

    fn symmetry_of_member(&self, _: &Scene, _: usize) -> usize {
        0
    }
}

impl ModeSource for FiniteElementBrake {
    fn band_modes(&self, scene: &Scene, at: &[OperatingPoint]) -> Vec<Result<Vec<BandMode>, study::Error>> {
        let (part, threshold, error) = (self.part(scene), self.plan.threshold, self.relative_error(scene));
        let may_grow = |lambda: Complex<f64>, also: f64| threshold.margin(lambda) >= -(error + also) * lambda.norm();
        let enough = self.case.reduction.residual.max(BEYOND_HELD_OUT * self.sets[part.set].held_out_residual);
        let points: Vec<OperatingPoint> = at.iter().map(|at| self.full_point(scene, at)).collect();
        let found = part.reduced.modes_of_all(&points, &may_grow);
        let mut counts = RouteCounts::default();
        found.iter().flatten().for_each(|found| counts.record(found.route));
        let mut routes = part.routes.lock().unwrap_or_else(PoisonError::into_inner);
        *routes = *routes + counts;
        drop(routes);
        let modes = |found: ReducedModes| {
            let each = found.lambdas.iter().zip(found.shapes.column_iter()).zip(&found.residuals);
            let mode = |((&lambda, shape), &value): ((&Complex<f64>, DVectorView<'_, _>), &f64)| {
                // One that is no number is above too.
                let is_within = value <= enough;
                let residual = Some(ModeResidual { value, is_above: !is_within });
                BandMode { lambda, shape: shape.into_owned(), bound: error * lambda.norm(), residual }
            };
            each.map(mode).collect()
        };
        found.into_iter().map(|found| Ok(found.map(modes).map_err(Error::from)?)).collect()
    }

    fn coarse(&self, scene: &Scene, at: [&OperatingPoint; 2]) -> Result<Option<CoarsePath<'_>>, study::Error> {
        let of = |at| self.part(scene).reduced.coarse_at(&self.full_point(scene, at)).map_err(Error::from);
        let [from, to] = at.map(of);
        let Some(((from, basis), (to, _))) = from?.zip(to?) else { return Ok(None) };
        Ok(Some(CoarsePath { systems: [from, to], basis }))
    }

    fn bridge(&self, configuration: usize, modes: [&[Mode]; 2]) -> Result<Option<Bridge>, study::Error> {
        Ok(bridge::bridge(self, configuration, modes)?)
    }

    fn relative_error(&self, scene: &Scene) -> f64 {
        let part = self.part(scene);
        let set = &self.sets[part.set];
        let of_part = if self.is_known(part) { part.within.distance } else { 1.0 };
        (ALLOWANCE * (of_part + set.compared.distance.max(set.held_out))).max(LEAST_ERROR)
    }

    fn unknown_error(&self, scene: &Scene) -> Option<&'static str> {
        let part = self.part(scene);
        if self.sets[part.set].held_out >= 1.0 {
            Some("the reduced brake does not have the modes of the whole one at draws of which it was not made")
        } else if !self.is_known(part) {
            Some("the basis of the reduced brake does not hold its modes within reduction.residual")
        } else {
            None
        }
    }

    fn whole_eigenvalue(
        &self,
        scene: &Scene,
        values: &[(usize, f64)],
        near: Complex<f64>,
    ) -> Result<WholeEigenvalue, study::Error> {
        whole::eigenvalue(self.part(scene), &self.sets, &parameters::point(&self.scene_of(scene), values)?, near)
    }

    fn routes(&self) -> Vec<(&'static str, u64)> {
        let RouteCounts { coarse, spectra } = FiniteElementBrake::routes(self);
        vec![("coarse", coarse), ("spectra", spectra)]
    }

    fn full_checks(&self) -> Option<&FullChecks> {
        self.full_checks.as_ref()
    }
}

impl CaseBrake for FiniteElementBrake {
    fn finite_elements(&self) -> Option<&FiniteElementBrake> {
        Some(self)
    }

    fn medians_in_words(&self) -> String {
        format!("{}; median parameters", self.plan.describe(&self.plan.scenes[0]))
    }
}
