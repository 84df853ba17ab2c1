//! The lattice of a case with its friction laws and distributions.

mod contacts;
mod draw;
mod drawn_inputs;
mod modifiable;
mod parameters;
mod sobol;

use contacts::contact_system;
pub use draw::{FrictionDraw, LatticeSample};
pub(crate) use sobol::{DrawnFriction, OF_CONTACT};

use cycle::ContactSystem;
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::StreamRng;
use osc_model::{
    Axis, ContactArrangement, ContactPoint, Dof, Grid, Lateral, LatticeBody, LatticeModel, PreparedLattice, Reversal,
    Sliding,
};
use output::significant;
use serde_json::{Map, Value, json};
use study::{
    Configuration, Cost, DrawnContacts, DrawnInputs, Modifiable, Moves, NamedParameter, Origin, Parametrised, Plan,
    Scene, SceneKey, SceneLabels, SlidingContacts, UncertainBrake,
};

use crate::any::{listed, values_in_words};
use crate::case::{Draws, FrictionDistributions, LatticeCase, LatticeReadings, Law};
use crate::labels::friction_labels;
use crate::{CaseBrake, Error};

/// Speed at which a law that does not depend on speed is evaluated, m/s; any value gives the same result.
const ANY_SPEED: f64 = 1.0;

/// The lattice of a case in all its configurations.
#[derive(Debug)]
pub struct LatticeBrake {
    /// The case.
    pub case: LatticeCase,
    /// The scenes of the case.
    pub plan: Plan,
    /// The lattice of each configuration of the plan.
    lattices: Vec<PreparedLattice>,
    /// The symmetries of each set of constraints: of the brake or, with a draw for each contact, of its distribution, and of the list of arrangements.
    symmetries: Vec<Vec<Reversal>>,
    /// Reversals of each configuration, one for each member of its symmetry class: each maps the arrangement of the configuration onto that of the member.
    members: Vec<Vec<Reversal>>,
}

impl LatticeBrake {
    /// Least cost of the study of a case, counted before any scene of it is made: a symmetry class has four arrangements at
    /// most.
    pub fn least_cost(case: &LatticeCase) -> Cost {
        let arrangements: usize = case.panels.iter().map(|(_, arrangements)| arrangements.len()).sum();
        let configurations = case.constraints.len() * arrangements.div_ceil(Reversal::ALL.len());
        let by_configuration: usize = case.laws.iter().map(|&law| speeds_of(case, law).len()).sum();
        Cost::new(
            3 * case.lattice.grid.oscillators() + 3,
            configurations,
            configurations * by_configuration,
            case.header.samples,
        )
    }

    /// Lays out the scenes of a case.
    ///
    /// Arrangements of one symmetry class share a scene: with one draw for all contacts their eigenvalues are equal, with a draw
    /// for each the distributions of these are. With one draw for all a scene is solved by sectors. A law that does not depend on
    /// speed has one scene for all speed ranges.
    ///
    /// # Errors
    /// Refusals of the model; [`study::Error::Median`] where median parameters have no operating point. What it takes is not asked here:
    /// see [`LatticeBrake::least_cost`].
    pub fn new(case: LatticeCase) -> Result<Self, Error> {
        Self::laid_out(case, false)
    }

    /// The same, where arrangements share a scene only if all their eigenvalues are equal, draw by draw: for what is asked of all arrangements of a draw together.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_equal_draws(case: LatticeCase) -> Result<Self, Error> {
        let is_apart = case.readings.draws == Draws::Each;
        Self::laid_out(case, is_apart)
    }

    fn laid_out(case: LatticeCase, is_apart: bool) -> Result<Self, Error> {
        let mut plan = case.header.plan(case.identity());
        (plan.mode_labels, plan.mode_identity) = (case.readings.labels, case.readings.identity);
        plan.labels = labels(&case);
        let mut brake = Self { case, plan, lattices: Vec::new(), symmetries: Vec::new(), members: Vec::new() };
        for constraints in 0..brake.case.constraints.len() {
            brake.lay_out(constraints, is_apart)?;
        }
        Ok(brake)
    }

    /// Adds the configurations and scenes of a constraint set, with arrangements apart or in classes.
    fn lay_out(&mut self, constraints: usize, is_apart: bool) -> Result<(), Error> {
        let case = &self.case;
        let fixed = &case.constraints[constraints].fixed;
        let model = LatticeModel::new(case.lattice.clone(), case.readings.lateral, fixed)?;
        let full = prepared(case, &model, &ContactArrangement::full(case.lattice.grid.oscillators()))?;
        let named_at = naming_point(case, &full)?;
        self.plan.origins.push(Origin { brake: full.brake().clone().into(), naming_point: named_at });
        let symmetries = symmetries(case, &model);
        let alike = if is_apart { &[Reversal::None] } else { &symmetries[..] };
        for (panel, (_, arrangements)) in case.panels.iter().enumerate() {
            for class in model.symmetry_classes(alike, arrangements)? {
                let arrangement = &arrangements[class.representative];
                let members: Vec<usize> = class.members.iter().map(|member| member.arrangement).collect();
                let wants_work = arrangement.in_contact().len() == arrangement.oscillators();
                let lattice = prepared(case, &model, arrangement)?;
                let configuration = Configuration {
                    brake: lattice.brake().clone().into(),
                    naming_point: naming_point(case, &lattice)?,
                    origin: constraints,
                    contacts: arrangement.to_string(),
                };
                let speeds = |law: usize| speeds_of(case, case.laws[law]);
                self.plan.add_configuration(configuration, panel, &members, wants_work, speeds);
                self.lattices.push(lattice);
                self.members.push(class.members.iter().map(|member| member.reversal).collect());
            }
        }
        self.symmetries.push(symmetries);
        Ok(())
    }

    /// The lattice of a scene.
    pub fn lattice(&self, scene: &Scene) -> &PreparedLattice {
        &self.lattices[scene.configuration]
    }

    /// The friction law of a scene.
    pub fn law(&self, key: SceneKey) -> Law {
        self.case.laws[key.law]
    }

    /// The speed of a sample in a scene, m/s.
    pub fn speed(&self, key: SceneKey, sample: &LatticeSample) -> f64 {
        key.speed.map_or(ANY_SPEED, |range| self.case.speeds[range].quantile(sample.speed_quantile))
    }

    /// Law of a scene, and the distributions from which its friction is drawn.
    fn drawn(&self, scene: &Scene) -> DrawnFriction<'_> {
        let LatticeCase { readings, friction, correlation, .. } = &self.case;
        DrawnFriction {
            law: self.law(scene.key),
            from: friction,
            correlation: correlation.as_ref(),
            draws: readings.draws,
            has_lateral_mu: readings.lateral != Lateral::None,
            has_bristle_damping: readings.bristle_damping.is_some(),
        }
    }

    /// The sample of the medians with another coefficient of Amontons-Coulomb friction in all contacts.
    pub fn with_mu(&self, mu: f64) -> LatticeSample {
        let median = self.median();
        let draw = FrictionDraw { mu, lateral_mu: mu, ..*median.contact(0) };
        LatticeSample::shared(draw, median.speed_quantile)
    }

    fn speed_is_drawn(&self, scene: &Scene) -> bool {
        scene.key.speed.is_some_and(|range| self.case.speeds[range].to > self.case.speeds[range].from)
    }

    /// The sliding state of `sample` in `scene`.
    ///
    /// # Errors
    /// Those of the law; no static equilibrium.
    pub fn sliding(&self, scene: &Scene, sample: &LatticeSample) -> Result<Sliding, Error> {
        sliding(&self.case, self.lattice(scene), self.law(scene.key), self.speed(scene.key, sample), sample)
    }
}

impl UncertainBrake for LatticeBrake {
    type Sample = LatticeSample;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<LatticeSample, study::Error> {
        Ok(LatticeSample::draw(&self.case, rng)?)
    }

    fn median(&self) -> LatticeSample {
        LatticeSample::median(&self.case)
    }

    fn operating_point(&self, scene: &Scene, sample: &LatticeSample) -> Result<OperatingPoint, study::Error> {
        Ok(self.lattice(scene).operating_point(&self.sliding(scene, sample)?)?)
    }

    fn drawn_inputs(&self) -> Option<&dyn DrawnInputs<LatticeSample>> {
        Some(self)
    }

    fn parametrised(&self) -> Option<&dyn Parametrised> {
        Some(self)
    }

    fn modifiable(&self) -> Option<&dyn Modifiable> {
        Some(self)
    }

    fn sliding_contacts(&self) -> Option<&dyn SlidingContacts> {
        Some(self)
    }

    fn drawn_contacts(&self) -> Option<&dyn DrawnContacts<LatticeSample>> {
        Some(self)
    }
}

impl SlidingContacts for LatticeBrake {
    fn contact_system(
        &self,
        scene: &Scene,
        values: &[(usize, f64)],
        stick: f64,
    ) -> Result<ContactSystem, study::Error> {
        Ok(parameters::contact_system(self, scene, values, stick)?)
    }
}

impl DrawnContacts<LatticeSample> for LatticeBrake {
    fn contact_system_of(
        &self,
        scene: &Scene,
        sample: &LatticeSample,
        stick: f64,
    ) -> Result<ContactSystem, study::Error> {
        // Where no speed matters to a tangent, a motion sticks at its own: in the first of the ranges.
        let speed = self.case.speeds[scene.key.speed.unwrap_or(0)].quantile(sample.speed_quantile);
        let (readings, stiffness) = (&self.case.readings, &self.case.lattice.contact_stiffness);
        Ok(contact_system(self.lattice(scene), self.law(scene.key), (readings, stiffness), (speed, sample), stick)?)
    }
}

impl Parametrised for LatticeBrake {
    fn parameters(&self, scene: &Scene) -> Vec<NamedParameter> {
        parameters::named(self, scene)
    }

    fn system_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, study::Error> {
        Ok(parameters::system(self, scene, values)?)
    }

    fn contact_points(&self, _: &Scene) -> Vec<String> {
        Vec::new()
    }

    fn closed_points(&self, _: &Scene, _: &[(usize, f64)]) -> Result<Vec<bool>, study::Error> {
        Ok(Vec::new())
    }
}

/// The sliding state of a sample: the tangent of a law at a speed, and the normal load, in each contact of a lattice.
///
/// # Errors
/// Those of the law; no static equilibrium.
pub fn sliding(
    case: &LatticeCase,
    lattice: &PreparedLattice,
    law: Law,
    speed: f64,
    sample: &LatticeSample,
) -> Result<Sliding, Error> {
    sliding_under(&case.readings, lattice, law, speed, sample)
}

/// [`sliding`] under readings that need not be a case's.
fn sliding_under(
    readings: &LatticeReadings,
    lattice: &PreparedLattice,
    law: Law,
    speed: f64,
    sample: &LatticeSample,
) -> Result<Sliding, Error> {
    let point = |draw: &FrictionDraw| -> Result<ContactPoint, Error> {
        let tangent = draw.tangent(law, speed, readings.bristle_damping)?;
        Ok(ContactPoint { tangent, lateral_mu: draw.lateral(law), normal_load: 0.0 })
    };
    let in_contact = lattice.arrangement().in_contact();
    let mut contacts = match sample.shared_draw() {
        Some(draw) => vec![point(draw)?; in_contact.len()],
        None => in_contact.iter().map(|&i| point(sample.contact(i))).collect::<Result<_, Error>>()?,
    };
    let loads = lattice.normal_loads(readings.preload, &contacts)?;
    for (contact, load) in contacts.iter_mut().zip(loads) {
        contact.normal_load = load;
    }
    Ok(Sliding { speed, contacts })
}

/// The lattice of one constraint set of a case in an arrangement, not split into sectors.
///
/// # Errors
/// Those of the model.
pub fn lattice(
    case: &LatticeCase,
    constraints: usize,
    arrangement: &ContactArrangement,
) -> Result<PreparedLattice, Error> {
    let fixed = &case.constraints[constraints].fixed;
    Ok(LatticeModel::new(case.lattice.clone(), case.readings.lateral, fixed)?.prepare(arrangement)?)
}

/// A lattice, split into sectors where the draws keep the symmetry.
fn prepared(
    case: &LatticeCase,
    model: &LatticeModel,
    arrangement: &ContactArrangement,
) -> Result<PreparedLattice, Error> {
    let mut lattice = model.prepare(arrangement)?;
    if case.readings.draws == Draws::Shared {
        lattice.split(model.sectors(arrangement)?);
    }
    Ok(lattice)
}

/// The symmetries of a lattice that its study has too: they make of each arrangement another one of the case, and of the contacts of a draw those of another
/// draw that is as likely, which correlations of single contacts may not.
fn symmetries(case: &LatticeCase, model: &LatticeModel) -> Vec<Reversal> {
    let (grid, of_contact) = (case.lattice.grid, FrictionDistributions::DRAWN.len());
    let correlation = case.correlation.as_ref().filter(|_| case.readings.draws == Draws::Each);
    let keeps_draws = |reversal: Reversal| {
        let to = |value: usize| reversal.oscillator(grid, value / of_contact) * of_contact + value % of_contact;
        correlation.is_none_or(|correlation| correlation.is_kept_by(to))
    };
    let mut symmetries = model.symmetries();
    symmetries.retain(|&reversal| {
        keeps_draws(reversal) && case.panels.iter().all(|(_, arrangements)| model.keeps_all(reversal, arrangements))
    });
    symmetries
}

/// The operating point at which the modes of a lattice are named: Amontons-Coulomb friction at median parameters.
fn naming_point(case: &LatticeCase, lattice: &PreparedLattice) -> Result<OperatingPoint, Error> {
    let (speed, median) = (case.speeds[0].quantile(0.5), LatticeSample::median(case));
    let state = sliding(case, lattice, Law::AmontonsCoulomb, speed, &median);
    let point = state.and_then(|state| Ok(lattice.operating_point(&state)?));
    point.map_err(|source| {
        let study = case.header.path.display().to_string();
        study::Error::Median { study, source: Box::new(source.into()) }.into()
    })
}

fn speeds_of(case: &LatticeCase, law: Law) -> Vec<Option<usize>> {
    // Amontons-Coulomb friction does not depend on speed, unless friction across the sliding is a dashpot mu N0 / v.
    if law == Law::AmontonsCoulomb && case.readings.lateral != Lateral::Vector {
        vec![None]
    } else {
        (0..case.speeds.len()).map(Some).collect()
    }
}

fn labels(case: &LatticeCase) -> SceneLabels {
    let dofs = dof_names(case.lattice.grid.oscillators());
    SceneLabels {
        constraints: case.constraints.iter().map(|set| set.name.clone()).collect(),
        named_at: "with all in contact, Amontons-Coulomb, median parameters".into(),
        moves: vec![Moves::Along; dofs.len()],
        dofs,
        ..friction_labels(&case.laws, &case.speeds, &case.panels, case.header.units)
    }
}

/// `x1` to `zp`.
fn dof_names(oscillators: usize) -> Vec<String> {
    let bodies = (0..oscillators).map(LatticeBody::Oscillator).chain([LatticeBody::Plate]);
    bodies.flat_map(|body| Axis::ALL.map(|axis| Dof { axis, body }.to_string())).collect()
}

impl CaseBrake for LatticeBrake {
    fn grid(&self) -> Option<Grid> {
        Some(self.case.lattice.grid)
    }

    fn contents(&self) -> Vec<(&'static str, String)> {
        let (case, grid) = (&self.case, self.case.lattice.grid);
        let arrangements = case.panels.iter().map(|(n, list)| format!("{} with {n} in contact", list.len()));
        let speeds = case.speeds.iter().map(|s| format!("{} ({} to {} m/s)", s.name, s.from, s.to));
        vec![
            ("lattice", format!("{} x {} oscillators and the plate", grid.rows(), grid.columns())),
            ("laws", listed(case.laws.iter().map(ToString::to_string).collect())),
            ("arrangements", listed(arrangements.collect())),
            ("speeds", listed(speeds.collect())),
            ("constraints", listed(self.plan.labels.constraints.clone())),
        ]
    }

    fn medians_in_words(&self) -> String {
        let scene = &self.plan.scenes[0];
        let (law, contacts) = (self.law(scene.key), self.lattice(scene).arrangement());
        let speed = self.case.speeds[scene.key.speed.unwrap_or(0)].quantile(0.5);
        let values = values_in_words(&Parametrised::parameters(self, scene));
        format!("{law} friction at {} m/s, in contact: {contacts}; {values}", significant(speed, 4))
    }

    fn scene_json(&self) -> Value {
        let scene = &self.plan.scenes[0];
        let contacts = self.lattice(scene).arrangement().in_contact();
        let given = Parametrised::parameters(self, scene).into_iter();
        let parameters: Map<String, Value> = given.map(|p| (p.name, json!(p.median))).collect();
        json!({
            "law": self.law(scene.key).name(),
            "contact": contacts.iter().map(|i| i + 1).collect::<Vec<_>>(),
            "speed": self.case.speeds[scene.key.speed.unwrap_or(0)].quantile(0.5),
            "parameters": parameters,
        })
    }
}
