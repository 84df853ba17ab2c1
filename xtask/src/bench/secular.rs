//! The route of a study for most of its samples: the growing modes alone, by the secular equation.

use cea::{Anchors, BatchSolver, EigenSolver, Feedback, Gain, Secular, Workspace};
use squeal::Error;
use squeal::osc_model::{PreparedLattice, Sliding};
use squeal::study::common_gain;
use validation::Spectra;

/// Name of the route.
pub const SECULAR_ROUTE_NAME: &str = "secular equation, growing modes";

/// Secular equation of a lattice, with its anchors and the gains of its draws.
pub struct SecularRoute {
    secular: Secular,
    anchors: Anchors,
    gains: Vec<Gain>,
}

impl SecularRoute {
    /// The route for a lattice; `None` for a structure that has no secular equation, and for draws whose channels differ.
    ///
    /// # Errors
    /// Those of the model and of the solver.
    pub fn new(lattice: &PreparedLattice, anchors: &[Sliding], draws: &[Sliding]) -> Result<Option<Self>, Error> {
        let mut work = Workspace::default();
        let gain = |state: &Sliding| -> Result<Option<Gain>, Error> {
            Ok(common_gain(&lattice.operating_point(state)?.channels))
        };
        let Some(gains) = draws.iter().map(gain).collect::<Result<Option<Vec<Gain>>, Error>>()? else {
            return Ok(None);
        };
        let system = &lattice.brake().system;
        let feedback = Feedback { force: system.force_matrix(), reading: system.reading_matrix() };
        let Ok(secular) = Secular::new(lattice.structural(), &feedback, &mut work)? else { return Ok(None) };
        let mut known = Vec::with_capacity(anchors.len());
        for state in anchors {
            if let Some(gain) = gain(state)? {
                known.push((gain, BatchSolver.eigenvalues(&lattice.linearised(state)?, &mut work)?));
            }
        }
        Ok(Some(Self { anchors: secular.anchors(&known, &mut work), secular, gains }))
    }

    /// The eigenvalues of growing modes with Im > 0 of each draw.
    pub fn solve(&self) -> Spectra {
        let gains: Vec<(Gain, &[f64])> = self.gains.iter().map(|&gain| (gain, &[][..])).collect();
        let found = self.secular.growing(&self.anchors, &gains, &mut Workspace::default()).into_iter();
        found.map(|found| Some(found.ok()?.modes.into_iter().filter(|mode| mode.re > 0.0).collect())).collect()
    }
}
