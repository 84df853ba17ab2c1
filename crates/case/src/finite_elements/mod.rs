//! A brake from the export of a finite element program: sparse matrices with names of their rows, a mesh with node sets, and
//! contact in patches that are in or out of contact: between matching nodes, or between faces that need not match.

mod balance;
mod contact;
mod contacts;
mod draft;
mod entries;
mod faces;
mod facing;
mod missing;
mod names_on_mesh;
mod nodes;
mod read;
mod schema;
mod side;
mod spread;
mod structure;
mod surface_contact;
mod surface_loads;
mod surface_schema;
mod surfaces;
mod terms;
mod turning;
mod units;

pub use balance::{Acting, ContactBalance, ContactState};
pub use draft::DraftFiles;
pub use missing::MissingRows;
pub use names_on_mesh::NamesOnMesh;
pub use side::Side;
pub use spread::{Spread, SpreadParameter, SpreadParameters};
pub use surface_loads::EQUILIBRIUM;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use formats::{Dof, Mesh};
use friction::BristleDamping;
use linsys::ChannelGain;
use osc_model::ContactArrangement;
use sparse::SparseAffineSystem;

use super::relaxing::gains_of;
use super::{
    Branch, CaseError, CaseHeader, Correlation, Draws, Expression, FixedDofs, FrictionDistributions, Law, Parameter,
    SpeedRange, TableFunction, TakenMatrix,
};

/// A checked study of a finite element brake.
#[derive(Debug, Clone)]
pub struct FiniteElementCase {
    /// Header of the case: its file, and what it says of its study.
    pub header: CaseHeader,
    /// The drawn parameters of coefficients, in the order of their names; then the parameters of [`PatchContact::spread`].
    pub parameters: Vec<Parameter>,
    /// Functions that are given by points, in the order of their names; each is called by an expression.
    pub tables: Vec<Arc<TableFunction>>,
    /// The mesh, where the case names one.
    pub mesh: Option<Mesh>,
    /// The node sets of the mesh.
    pub node_sets: BTreeMap<String, Vec<i64>>,
    /// Agreement between the nodes of the mesh and the rows of the matrices, where the case names a mesh.
    pub names: Option<NamesOnMesh>,
    /// Nodes of holders, contact and constraints that lack rows.
    pub missing_rows: Vec<MissingRows>,
    /// Evidence in the mesh that the pad and the disc are on their sides of the contact, where there is one.
    pub sides: Option<[Side; 2]>,
    /// Names of the rows of the matrices; a matrix without labels has the numbers of its rows as nodes, and direction 0.
    pub dofs: Vec<Dof>,
    /// Files of matrices, and how each was taken.
    pub files: Vec<TakenMatrix>,
    /// Degrees of freedom that the matrices hold by huge entries; they have no row.
    pub held: Vec<Dof>,
    /// Displacements that `*BOUNDARY` of the mesh holds; they need not lack a row.
    pub held_in_mesh: BTreeSet<Dof>,
    /// The terms of the file, then its springs, then two of each body that turns, then the holders as one term, where there are any, then one term
    /// for each patch; patch by patch one channel for each pair in contact, along the sliding, then one for each across it, where friction
    /// acts there, then one for what opening adds to the spring of each, where loads are in equilibrium, and what its own parameters add, where it has
    /// some; behind the channels of all patches one for each direction of each of the branches.
    pub system: SparseAffineSystem,
    /// The coefficients of the terms of the file, of springs and of what turns.
    pub coefficients: Vec<Expression>,
    /// Branches of viscoelastic springs, of which each has a channel for each of its directions.
    pub branches: Vec<Branch>,
    /// The contact, where there is one.
    pub contact: Option<PatchContact>,
    /// Correlation of what is drawn: of the friction parameters of each contact that has a draw of its own, one after the other, then of
    /// [`Self::parameters`]; `None` where all is independent.
    pub correlation: Option<Correlation>,
    /// Sets of constraints, in the order of the file; at least one.
    pub constraints: Vec<FixedDofs>,
    /// Goal of the reduction: the modes that the reduced brake shall hold, and how well.
    pub reduction: ReductionGoal,
}

/// Contact in patches, each of pairs: of nodes, or of points between faces.
#[derive(Debug, Clone)]
pub struct PatchContact {
    /// The patches.
    pub patches: Vec<Patch>,
    /// Arrangements of patches in contact, by their number, in the order of the file.
    pub panels: Vec<(usize, Vec<ContactArrangement>)>,
    /// Friction laws, in the order of the file.
    pub laws: Vec<Law>,
    /// Distributions of the friction parameters.
    pub friction: FrictionDistributions,
    /// Ranges of sliding speed; none where nothing depends on speed, or where [`Self::own_speed`] says it.
    pub speeds: Vec<SpeedRange>,
    /// Draws of the friction parameters: one for all patches or one for each.
    pub draws: Draws,
    /// LuGre's sigma1 as a function of speed; `None` sets sigma1 to 0.
    pub bristle_damping: Option<BristleDamping>,
    /// True if friction acts across the sliding too: a dashpot `mu N0 / v` in each pair.
    pub is_lateral: bool,
    /// Factor of the stiffness of all pairs, where it depends on parameters.
    pub stiffness_factor: Option<Expression>,
    /// Factor of the friction of all pairs, where it depends on parameters.
    pub friction_factor: Option<Expression>,
    /// Further factors of friction, of each contact by its number: the field and the factor; `None` where the contact gives none.
    pub own_friction_factors: Vec<Option<(String, Expression)>>,
    /// Parameters that have a value for each patch or pair, in the order of their names; they occur in both factors alone.
    pub spread: SpreadParameters,
    /// True if a pair has a channel for its spring.
    pub has_spring_channels: bool,
    /// Factor of the load of all pairs, where it depends on parameters.
    pub load_factor: Option<Expression>,
    /// By which power of that the stiffness of all pairs grows: `1 - 1/m` of faces whose pressure is `c g^m` and given, else 0.
    pub load_exponent: f64,
    /// True if the stiffness of any pair grows with its pressure, `p = c g^m` with m > 1.
    pub has_power_law: bool,
    /// The speed, where the parameters say it and no range of speeds.
    pub own_speed: Option<OwnSpeed>,
    /// Equilibrium from which the loads of all pairs follow; `None` where they are given.
    pub balance: Option<Arc<ContactBalance>>,
    /// True if pairs are points between faces, of which there are many more than of nodes.
    pub is_of_faces: bool,
}

impl PatchContact {
    /// The law under which modes are named: Amontons-Coulomb friction where it is studied, else the first law of the file.
    pub fn naming_law(&self) -> Law {
        match self.laws[..] {
            [first, ..] if !self.laws.contains(&Law::AmontonsCoulomb) => first,
            _ => Law::AmontonsCoulomb,
        }
    }

    /// True if the stiffness of the pairs is not the same in every sample.
    pub fn has_drawn_stiffness(&self) -> bool {
        self.stiffness_factor.is_some() || (self.load_factor.is_some() && self.load_exponent != 0.0)
    }
}

/// The sliding speed of a case as its parameters say it.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnSpeed {
    /// Speed, rad/s about an axis, m/s along a direction.
    pub speed: Expression,
    /// Factor of the speed for the mean of all pairs: their mean radius, m, or 1.
    pub factor: f64,
}

/// The field of [`PatchContact::load_factor`].
pub const LOAD_FACTOR: &str = "all_contacts.load_factor";

/// The field of [`PatchContact::own_speed`].
pub const OWN_SPEED: &str = "all_contacts.speed";

/// The field of [`PatchContact::friction_factor`].
pub const FRICTION_FACTOR: &str = "contact.friction_factor";

/// The field of [`PatchContact::stiffness_factor`].
pub const STIFFNESS_FACTOR: &str = "contact.stiffness_factor";

/// A patch of the contact, which is closed or open as a whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Name of the patch: the name of its set of nodes or faces; the name of its contact between faces where the contact names no sets.
    pub name: String,
    /// Pairs of nodes (pad, disc); of a point between faces the nodes next to it.
    pub pairs: Vec<[i64; 2]>,
    /// Ratio of the sliding speed of each pair to the sliding speed of a scene: 1 where sliding is a direction, the pair's radius over the
    /// mean radius of all pairs of the contact where the disc turns about its normal; of points between faces that turn about an axis, the speed at
    /// 1 rad/s over the mean of all such points by their areas.
    pub speeds: Vec<f64>,
    /// Indices of its channels in the system: of friction along the sliding of each pair, then across it, then of its spring, where that is not the
    /// same in every sample: in equilibrium, or with parameters of its own.
    pub channels: Range<usize>,
    /// Stiffness of the spring of each pair that its channel reads, N/m.
    pub springs: Vec<f64>,
    /// Mean normal load of its pairs while it is closed, N; of an equilibrium that at the medians.
    pub load: f64,
    /// Ratios of the load of each pair to that mean: 1 where they share it equally.
    pub shares: Vec<f64>,
    /// Places of the pairs, with the directions of their normals and of the sliding.
    pub places: Vec<PairPlace>,
    /// Number of each pair in [`PatchContact::balance`]; none where loads are given.
    pub points: Vec<usize>,
    /// Area of each point between faces; none of pairs of nodes.
    pub areas: Vec<f64>,
    /// Number of its contact, from 0.
    pub contact: usize,
}

/// Place of a pair and its directions, of length 1, in global axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairPlace {
    /// Position on the pad.
    pub position: [f64; 3],
    /// Normal n, from the disc into the pad.
    pub normal: [f64; 3],
    /// Direction of sliding t, in which the disc slides under the pad.
    pub sliding: [f64; 3],
    /// Distance of the meshes along n, negative where they overlap.
    pub gap: f64,
}

/// Goal of a reduction: the modes that the reduced brake shall hold, and how well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReductionGoal {
    /// Lowest and highest frequency of the modes that are studied, Hz.
    pub frequencies: [f64; 2],
    /// Lowest and highest growth rate of the modes that it shall hold, 1/s.
    pub growth: [f64; 2],
    /// Largest residual of a mode.
    pub residual: f64,
    /// Draws at which the residuals are brought below it.
    pub training: usize,
    /// Samples that are solved with the whole brake too.
    pub full_checks: u64,
    /// Most open verdicts of a sample that the whole brake settles; where more are open they stay so.
    pub full_verdicts: usize,
}

impl FiniteElementCase {
    /// Gains of the channels of all branches, at values of the parameters and the coefficients of the terms there.
    ///
    /// # Errors
    /// An expression without a value; a ratio below 0, a rate that is not above it.
    pub fn gains_of_branches(&self, values: &[f64], coefficients: &[f64]) -> Result<Vec<ChannelGain>, CaseError> {
        gains_of(&self.header.path, &self.branches, values, coefficients)
    }

    /// Channels of all branches, by their indices in the system: behind the channels of all patches.
    pub fn channels_of_branches(&self) -> Range<usize> {
        let all = self.system.channels().len();
        all - self.branches.iter().map(|branch| branch.directions).sum::<usize>()..all
    }

    /// Name of a row of the matrices: `1042.z`, or its number.
    pub fn dof_name(&self, row: usize) -> String {
        self.dofs.get(row).map_or_else(String::new, |dof| match dof.direction {
            0 => dof.node.to_string(),
            _ => dof.to_string(),
        })
    }
}

#[cfg(test)]
mod tests;
