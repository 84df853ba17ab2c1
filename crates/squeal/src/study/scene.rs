//! The scenes of a case, each with what does not change from sample to sample.

use linsys::SecondOrder;
use osc_model::{
    BrakeModel, ContactArrangement, ContactPoint, Lateral, LatticeModel, Linearise, Member, OscModelError,
    PreparedLattice, Reversal, Sectors, Sliding, SymmetryClass,
};

use super::Sample;
use crate::Error;
use crate::case::{Case, Draws, Law};

/// Speed at which laws without any speed in them are evaluated, m/s; it does not matter.
const ANY_SPEED: f64 = 1.0;

/// What tells scenes apart; indices into the lists of the [`Case`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SceneKey {
    /// Constraint set.
    pub constraints: usize,
    /// Friction law.
    pub law: Law,
    /// Speed range; `None` where nothing depends on speed, one scene then stands for all ranges.
    pub speed: Option<usize>,
    /// Number in contact.
    pub panel: usize,
}

/// One scene: it stands for all arrangements of its symmetry class.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Where it belongs.
    pub key: SceneKey,
    /// Arrangements it stands for, as places in the panel's list; the first is the one computed.
    pub members: Vec<usize>,
    /// Place of its lattice in [`Plan::lattices`].
    pub lattice: usize,
    /// Whether net work is computed: with every oscillator in contact.
    pub wants_work: bool,
}

/// All scenes of a case.
#[derive(Debug)]
pub struct Plan {
    /// The case.
    pub case: Case,
    /// The unconstrained or constrained model of each constraint set.
    pub models: Vec<LatticeModel>,
    /// One per constraint set and arrangement class: (constraint set, lattice).
    pub lattices: Vec<(usize, PreparedLattice)>,
    /// The sectors of each lattice, in which its samples are solved.
    pub sectors: Vec<Sectors>,
    /// The scenes, ordered by constraints, panel, class, law, speed.
    pub scenes: Vec<Scene>,
}

impl Plan {
    /// Lays out the scenes of a case.
    ///
    /// Where the draws keep the symmetry, arrangements of one symmetry class share a scene, solved by sectors; a law without speed in it
    /// has one scene for all speed ranges.
    ///
    /// # Errors
    /// What the model refuses.
    pub fn new(case: Case) -> Result<Self, Error> {
        let mut plan = Self { models: Vec::new(), lattices: Vec::new(), sectors: Vec::new(), scenes: Vec::new(), case };
        for (constraints, set) in plan.case.constraints.iter().enumerate() {
            let model = LatticeModel::new(plan.case.lattice.clone(), plan.case.readings.lateral, &set.fixed)?;
            for (panel, (_, arrangements)) in plan.case.panels.iter().enumerate() {
                for class in classes(&plan.case, &model, arrangements)? {
                    let arrangement = &arrangements[class.representative];
                    let members: Vec<usize> = class.members.iter().map(|member| member.arrangement).collect();
                    let wants_work = arrangement.in_contact().len() == arrangement.oscillators();
                    for &law in &plan.case.laws {
                        for speed in speeds_of(&plan.case, law) {
                            let key = SceneKey { constraints, law, speed, panel };
                            let lattice = plan.lattices.len();
                            plan.scenes.push(Scene { key, members: members.clone(), lattice, wants_work });
                        }
                    }
                    plan.lattices.push((constraints, model.prepare(arrangement)?));
                    plan.sectors.push(sectors(&plan.case, &model, arrangement)?);
                }
            }
            plan.models.push(model);
        }
        Ok(plan)
    }

    /// The lattice of a scene.
    pub fn lattice(&self, scene: &Scene) -> &PreparedLattice {
        &self.lattices[scene.lattice].1
    }

    /// Complex eigenvalue analyses that one sample stands for: every arrangement, law and speed range.
    pub fn analyses_per_sample(&self) -> u64 {
        let arrangements: usize = self.case.panels.iter().map(|(_, list)| list.len()).sum();
        let sets = self.case.constraints.len() * self.case.laws.len() * self.case.speeds.len();
        (sets * arrangements) as u64
    }

    /// The speed of a sample in a scene, m/s.
    pub fn speed(&self, key: SceneKey, sample: &Sample) -> f64 {
        key.speed.map_or(ANY_SPEED, |range| self.case.speeds[range].quantile(sample.speed_quantile))
    }

    /// The sliding state of `sample` in `scene`.
    ///
    /// # Errors
    /// A draw that a law refuses; no static equilibrium.
    pub fn sliding(&self, scene: &Scene, sample: &Sample) -> Result<Sliding, Error> {
        sliding(&self.case, self.lattice(scene), scene.key.law, self.speed(scene.key, sample), sample, |_| 1.0)
    }

    /// Linearises the system of `sample` in `scene` into `out`.
    ///
    /// # Errors
    /// As [`Plan::sliding`].
    pub fn linearise(&self, scene: &Scene, sample: &Sample, out: &mut SecondOrder) -> Result<(), Error> {
        Ok(self.lattice(scene).linearise(&self.sliding(scene, sample)?, out)?)
    }
}

/// A law at a speed in each contact of a lattice, with `factor` on the contact of an oscillator.
///
/// # Errors
/// A draw that the law refuses; no static equilibrium.
pub fn sliding(
    case: &Case,
    lattice: &PreparedLattice,
    law: Law,
    speed: f64,
    sample: &Sample,
    factor: impl Fn(usize) -> f64,
) -> Result<Sliding, Error> {
    let point = |&oscillator: &usize| {
        let draw = sample.contact(oscillator);
        Ok(ContactPoint {
            tangent: draw.tangent(law, speed, case.readings.bristle_damping)?,
            lateral_mu: draw.lateral(law),
            normal_load: 0.0,
            stiffness_factor: factor(oscillator),
        })
    };
    let mut contacts =
        lattice.arrangement().in_contact().iter().map(point).collect::<Result<Vec<ContactPoint>, Error>>()?;
    let loads = lattice.normal_loads(case.readings.preload, &contacts)?;
    for (contact, load) in contacts.iter_mut().zip(loads) {
        contact.normal_load = load;
    }
    Ok(Sliding { speed, contacts })
}

fn classes(
    case: &Case,
    model: &LatticeModel,
    arrangements: &[ContactArrangement],
) -> Result<Vec<SymmetryClass>, Error> {
    Ok(match case.readings.draws {
        Draws::Shared => model.symmetry_classes(arrangements)?,
        Draws::Each => (0..arrangements.len())
            .map(|arrangement| SymmetryClass {
                representative: arrangement,
                members: vec![Member { arrangement, reversal: Reversal::None }],
            })
            .collect(),
    })
}

/// What the samples of an arrangement, or its modes at median parameters, are solved in.
pub(super) fn sectors(
    case: &Case,
    model: &LatticeModel,
    arrangement: &ContactArrangement,
) -> Result<Sectors, OscModelError> {
    match case.readings.draws {
        Draws::Shared => model.sectors(arrangement),
        Draws::Each => model.one_sector(arrangement),
    }
}

fn speeds_of(case: &Case, law: Law) -> Vec<Option<usize>> {
    // Amontons-Coulomb friction has no speed in it, unless friction across the sliding is a dashpot mu N0 / v.
    if law == Law::AmontonsCoulomb && case.readings.lateral != Lateral::Vector {
        vec![None]
    } else {
        (0..case.speeds.len()).map(Some).collect()
    }
}
