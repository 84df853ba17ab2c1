//! Parts of a lattice that a screening may change: its contacts, and its symmetries.

use linsys::SecondOrder;
use osc_model::Reversal;
use study::{Modifiable, Place, Scene, Symmetry, WholeContact};

use super::LatticeBrake;
use crate::case::Draws;

impl Modifiable for LatticeBrake {
    /// An oscillator in contact: its friction along the sliding and across it, and its contact spring.
    fn contacts(&self, scene: &Scene) -> Vec<WholeContact> {
        let (lattice, channels) = (self.lattice(scene), self.plan.brake(scene).system.channels());
        let oscillators = lattice.arrangement().in_contact();
        let whole = |(at, &number): (usize, &usize)| {
            let (reading, stiffness) = (&channels[at].reading, self.case.lattice.contact_stiffness[number]);
            let mut structure = SecondOrder::zeros(lattice.structural().order(), 0);
            for &(i, a) in reading {
                // The friction reads the force of the spring, k times its compression.
                reading.iter().for_each(|&(j, b)| structure.k[(i, j)] = a * b / stiffness);
            }
            let channels = (at..channels.len()).step_by(oscillators.len()).collect();
            WholeContact { number, name: (number + 1).to_string(), channels, structure: Some(structure) }
        };
        oscillators.iter().enumerate().map(whole).collect()
    }

    fn places(&self, _: usize) -> Result<Option<Vec<Place>>, study::Error> {
        Ok(None)
    }

    fn symmetries(&self, constraints: usize) -> Vec<Symmetry> {
        let grid = self.case.lattice.grid;
        let oscillators = grid.oscillators();
        let symmetry = |reversal: &Reversal| Symmetry {
            dofs: (0..3 * (oscillators + 1)).map(|dof| reversal.dof(grid, dof)).collect(),
            contacts: (0..oscillators).map(|contact| reversal.oscillator(grid, contact)).collect(),
        };
        self.symmetries[constraints].iter().map(symmetry).collect()
    }

    fn symmetry_of_member(&self, scene: &Scene, member: usize) -> usize {
        let reversal = self.members[scene.configuration][member];
        self.symmetries[scene.key.constraints].iter().position(|&other| other == reversal).unwrap_or(0)
    }

    fn members_are_equal(&self) -> bool {
        self.case.readings.draws == Draws::Shared || self.plan.scenes.iter().all(|scene| scene.members.len() == 1)
    }

    fn scalable_terms(&self, _: usize) -> Vec<String> {
        Vec::new()
    }
}
