//! Combinations that differ in friction alone, as one brake: what they have in common is computed once.
//!
//! The preload (R8) and the bristle damping (R9) change the operating points of some laws and nothing else: neither the structure
//! nor the point at which modes are named. So combinations that differ in these answers share their reference modes and
//! secular equations, and each law that has the same operating points in several of them is solved once.

use brakes::case::{LatticeCase, LatticeReadings, Law};
use brakes::{LatticeBrake, LatticeSample};
use squeal::linsys::OperatingPoint;
use squeal::montecarlo::StreamRng;
use squeal::osc_model::{Lateral, Preload};
use squeal::study::{Configuration, Plan, Scene, UncertainBrake};

/// Several brakes in one: the plan of the first, and every law of the others that is another one.
pub struct Family {
    plan: Plan,
    /// Brakes, each with the indices of its laws among the laws of the plan.
    members: Vec<(LatticeBrake, Vec<usize>)>,
    /// Laws of the plan, each as the index of a member and the index among the laws of that member.
    laws: Vec<(usize, usize)>,
}

impl Family {
    /// A family of one.
    pub fn new(first: LatticeBrake) -> Self {
        let laws = first.case.laws.len();
        let own = (0..laws).map(|law| (0, law)).collect();
        Self { plan: first.plan.clone(), members: vec![(first, (0..laws).collect())], laws: own }
    }

    /// Adds a brake; gives it back where its configurations are not those of the family, or the law that its others are compared
    /// with is another one.
    pub fn add(&mut self, brake: Box<LatticeBrake>) -> Result<(), Box<LatticeBrake>> {
        let baseline = brake.plan.labels.baseline_law;
        let has_baseline = baseline.is_none_or(|law| self.law_like(&brake, law) == Some(law));
        if !has_baseline || !self.has_configurations_of(&brake) {
            return Err(brake);
        }
        let (member, mut places) = (self.members.len(), Vec::new());
        let known: Vec<Option<usize>> = (0..brake.case.laws.len()).map(|law| self.law_like(&brake, law)).collect();
        for (law, known) in known.into_iter().enumerate() {
            let place = known.unwrap_or(self.laws.len());
            if place == self.laws.len() {
                self.laws.push((member, law));
                self.plan.labels.laws.push(brake.plan.labels.laws[law].clone());
                let of_law = brake.plan.scenes.iter().filter(|scene| scene.key.law == law);
                let moved = of_law.map(|scene| with_law(scene, place));
                self.plan.scenes.extend(moved);
            }
            places.push(place);
        }
        self.members.push((*brake, places));
        Ok(())
    }

    /// The brakes, each with the indices of its laws among the laws of the plan.
    pub fn members(&self) -> &[(LatticeBrake, Vec<usize>)] {
        &self.members
    }

    /// The brakes alone.
    pub fn into_brakes(self) -> impl Iterator<Item = LatticeBrake> {
        self.members.into_iter().map(|(brake, _)| brake)
    }

    /// Index of the law of the plan that acts as a law of a brake does.
    fn law_like(&self, brake: &LatticeBrake, law: usize) -> Option<usize> {
        let of_law = brake.case.laws[law];
        self.laws.iter().position(|&(member, known)| {
            let LatticeCase { laws, readings, .. } = &self.members[member].0.case;
            laws[known] == of_law && acts_alike(of_law, readings, &brake.case.readings)
        })
    }

    fn has_configurations_of(&self, brake: &LatticeBrake) -> bool {
        let (mine, other) = (&self.members[0].0, brake);
        let same = |a: &Configuration, b: &Configuration| {
            a.naming_point == b.naming_point && a.origin == b.origin && a.contacts == b.contacts
        };
        let (ours, theirs) = (&mine.plan.configurations, &other.plan.configurations);
        mine.case.lattice == other.case.lattice
            && mine.case.readings.lateral == other.case.readings.lateral
            && mine.case.readings.draws == other.case.readings.draws
            && mine.case.constraints == other.case.constraints
            && mine.case.friction == other.case.friction
            && (mine.plan.seed, mine.plan.samples) == (other.plan.seed, other.plan.samples)
            && ours.len() == theirs.len()
            && ours.iter().zip(theirs).all(|(a, b)| same(a, b))
    }
}

/// True if a law has the same operating points under two readings that differ in the preload and the bristle damping alone, or lacks an operating
/// point under both: only LuGre has bristles, and Amontons-Coulomb friction, without a slope over the speed, does not see
/// the loads that are given. Loads of an equilibrium count, because the equilibrium may not exist.
fn acts_alike(law: Law, a: &LatticeReadings, b: &LatticeReadings) -> bool {
    let is_given = |readings: &LatticeReadings| !matches!(readings.preload, Preload::Equilibrium(_));
    let sees_no_load = law == Law::AmontonsCoulomb && a.lateral != Lateral::Vector && is_given(a) && is_given(b);
    let same_bristles = law != Law::LuGre || a.bristle_damping == b.bristle_damping;
    same_bristles && (a.preload == b.preload || sees_no_load)
}

/// The scene of another law.
fn with_law(scene: &Scene, law: usize) -> Scene {
    let mut moved = scene.clone();
    moved.key.law = law;
    moved
}

impl UncertainBrake for Family {
    type Sample = LatticeSample;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<LatticeSample, squeal::study::Error> {
        self.members[0].0.draw(rng)
    }

    fn median(&self) -> LatticeSample {
        self.members[0].0.median()
    }

    fn operating_point(&self, scene: &Scene, sample: &LatticeSample) -> Result<OperatingPoint, squeal::study::Error> {
        let (member, law) = self.laws[scene.key.law];
        self.members[member].0.operating_point(&with_law(scene, law), sample)
    }
}
