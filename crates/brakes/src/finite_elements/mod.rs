//! A finite element brake of a case, reduced, with its friction laws and distributions.

mod bridge;
mod divergence;
mod drawn_inputs;
mod full_checks;
mod layout;
mod mode_source;
mod on_axis;
mod outer_faces;
mod parameters;
mod places;
mod points;
mod reduce;
mod reduced_set;
mod rungs;
mod samples;
mod set_basis;
mod settled;
mod sliding;
mod sliding_contacts;
#[cfg(test)]
mod spread_tests;
mod swept;
mod together;
mod training;
mod whole;
mod whole_modes;

pub use points::{at_medians, frictionless, loads_at_medians};
pub use reduce::Bases;
pub use reduced_set::{Part, ReducedSet};
pub use rungs::Rung;
pub use sliding_contacts::check_motion;

use formats::Dof;
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::{Progress, StreamRng};
use num_complex::Complex;
use reduction::ReductionError;
use study::{
    Cost, DrawnContacts, DrawnInputs, FullChecks, ModeSource, Modifiable, NamedParameter, OuterFaces, Parametrised,
    Place, Plan, Scene, SlidingContacts, Symmetry, UncertainBrake, WholeContact, unknown_errors,
};
use sweep::Over;

use self::parameters::SceneOf;
use self::reduce::Trained;
use super::LatticeSample;
use crate::case::{CaseError, FiniteElementCase, Law};
use crate::prepared::Pieces;
use crate::{CaseBrake, Error, Prepared, Purpose};

/// Number of complete solutions that take the time of the whole brake at one point: of the solutions that make its basis, of its modes, and of what diverges.
/// Measured with the refined disc and pad, 14,985 degrees of freedom: 15 s of processor time.
const SOLUTIONS_OF_POINT: usize = 8;
/// Columns that a basis is expected to have before it is made. Measured with cases/disc-pad (100) and its refinement to 75 pairs (150).
const EXPECTED_COLUMNS: usize = 130;
/// Complete solutions that the time of a draw of the whole brake is worth: of its modes in the band and beside it, and of what diverges. Measured with cases/disc-pad
/// and its refinement: 0.74 and 9.7 s of processor time, alone on two cores.
const SOLUTIONS_OF_CHECK: usize = 4;
/// Finite element brake of a case, reduced: a dense brake for each configuration in place of the mesh.
///
/// Each set of constraints has one basis, in which the modes of all its arrangements of closed patches can be written. Each part, some
/// configurations that are studied together, has a smaller basis, whose columns are combinations of the columns of the basis of its set.
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
    /// Eigenvalues of the whole brake that do, Im >= 0, 1/s, with a growth of up to 2 pi times the highest frequency of the band, by ascending growth. `None`
    /// where a search does not tell, or the reduced brake alone has any of these.
    pub whole: Option<Vec<Complex<f64>>>,
    /// True if the whole brake has any that grow faster; how many is not counted.
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
        let brake = Self::of_pieces((case, &pieces), purpose, progress)?;
        pieces.end_interim();
        Ok(brake)
    }

    fn of_pieces(
        (case, pieces): (FiniteElementCase, &Pieces<'_>),
        purpose: Purpose<'_>,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let mut brake = match purpose {
            // A study lists in its findings the scenes of whose errors nothing is known, and other questions ask for them: no doubt is added to its plan.
            Purpose::Study => return Self::checked_of((case, pieces), progress),
            Purpose::Analysis => Self::with_points((case, pieces), Bases::OfEach, (&[], &[]), progress),
            // Errors of the reduced brake are not asked for.
            Purpose::Point => {
                let swept = swept::points(&case, &[])?;
                return Self::with_points((case, pieces), Bases::OfEach, (&swept, &[]), progress);
            }
            Purpose::Screen => Self::with_points((case, pieces), Bases::OfEachSet, (&[], &[]), progress),
            Purpose::Sweep(over) => {
                let swept = swept::points(&case, over)?;
                Self::with_points((case, pieces), Bases::OfEach, (&swept, &[]), progress)
            }
        }?;
        let doubts = unknown_errors(&brake.plan, &brake);
        brake.plan.doubts.extend(doubts);
        Ok(brake)
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

    /// Reduces the brake; the points are `swept` ones, at which the modes of the first configuration shall lie in the bases, in the place of draws, and
    /// further ones that are `trained` on.
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

    /// Memory and processor time of the bases of a case for a purpose in a memory of `budget` bytes, roughly, before any of them is made.
    pub fn expected_cost(case: &FiniteElementCase, purpose: Purpose<'_>, budget: u64) -> Cost {
        if purpose == Purpose::Point {
            return Cost::of_bases(case.dofs.len(), 0, &[]).with_solutions(SOLUTIONS_OF_POINT, budget);
        }
        let arrangements =
            case.contact.as_ref().map_or(1, |contact| contact.panels.iter().map(|(_, all)| all.len()).sum());
        let columns = vec![EXPECTED_COLUMNS; arrangements];
        let solutions = case.constraints.len() * set_basis::SOLUTIONS;
        let sets = case.constraints.len();
        Cost::of_bases(case.dofs.len(), sets, &columns.repeat(sets)).with_solutions(solutions, budget)
    }

    /// Memory and processor time of its bases and of the draws that a study solves with the whole brake in a memory of `budget` bytes, roughly.
    pub fn cost_of_bases(&self, budget: u64) -> Cost {
        let columns: Vec<usize> = self.parts.iter().map(|part| part.within.basis.ncols()).collect();
        let checks = self.case.reduction.full_checks as usize;
        let solutions = self.case.constraints.len() * set_basis::SOLUTIONS + SOLUTIONS_OF_CHECK * checks;
        Cost::of_bases(self.case.dofs.len(), self.sets.len(), &columns).with_solutions(solutions, budget)
    }

    /// The part of the reduction that a scene is on.
    pub fn part(&self, scene: &Scene) -> &Part {
        &self.parts[self.of_configurations[scene.configuration]]
    }

    /// The part of a set of constraints in which its modes have their names: with all patches closed.
    pub fn origin(&self, constraints: usize) -> &Part {
        &self.parts[self.of_origins[constraints]]
    }

    /// Names of the free rows with a set of constraints.
    pub fn free_rows(&self, constraints: usize) -> Vec<Dof> {
        self.sets[constraints].dofs.free().iter().map(|&row| self.case.dofs[row]).collect()
    }

    /// Cost against error of a set of constraints with all patches closed: what fewer columns of its basis hold.
    ///
    /// # Errors
    /// A draw without an operating point.
    pub fn rungs(&self, constraints: usize) -> Result<Vec<Rung>, Error> {
        rungs::rungs_of(&self.case, &self.sets[constraints], self.origin(constraints))
    }

    /// The closed patches of a scene, from 0.
    pub fn closed(&self, scene: &Scene) -> &[usize] {
        &self.closed[scene.configuration]
    }

    /// The operating point of the whole brake, reduced or not, from the operating point `at` of a scene.
    pub fn full_point(&self, scene: &Scene, at: &OperatingPoint) -> OperatingPoint {
        points::of_brake(&self.case, self.closed(scene), at)
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
    |error| {
        match error {
        Error::Reduction(ReductionError::NoModes) => CaseError::Value {
            path: case.header.path.clone(),
            field: "reduction.frequencies".into(),
            value: format!("{:?}", case.reduction.frequencies),
            allowed: format!(
                "a band with a mode of the brake, which has none there with a growth above {} 1/s; mass and stiffness may be swapped, or their \
                 units not be those of the band",
                case.reduction.growth[0]
            ),
        }
        .into(),
        error => error,
    }
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

    fn sliding_contacts(&self) -> Option<&dyn SlidingContacts> {
        Some(self)
    }

    fn outer_faces(&self) -> Option<&dyn OuterFaces> {
        Some(self)
    }

    fn drawn_contacts(&self) -> Option<&dyn DrawnContacts<FiniteElementSample>> {
        Some(self)
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

    fn members_are_equal(&self) -> bool {
        true
    }

    fn scalable_terms(&self, _: usize) -> Vec<String> {
        Vec::new()
    }
}

impl CaseBrake for FiniteElementBrake {
    fn finite_elements(&self) -> Option<&FiniteElementBrake> {
        Some(self)
    }
}
