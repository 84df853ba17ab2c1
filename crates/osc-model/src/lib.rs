//! Brakes as affine systems with friction channels, and a lattice of friction oscillators that makes one.
//!
//! Studies, certificates and figures work on a [`Brake`]: terms, channels, bodies and symmetry. [`LatticeModel`] is one of the
//! models that make a brake.
//!
//! | module | what it holds |
//! | --- | --- |
//! | `brake` | [`Brake`] and [`Body`]: an affine system with constraints, bodies and symmetry |
//! | `sectors` | [`Sectors`]: the smaller systems into which a symmetric brake divides |
//! | `coupling` | which degrees of freedom and internal states are coupled |
//! | `lattice` | [`LatticeModel`], the lattice before an arrangement is chosen |
//! | `lattice::{parameters, readings, dof}` | parameters, readings of open points, names of degrees of freedom |
//! | `lattice::assembly` | matrices of the lattice without friction |
//! | `lattice::{arrangement, symmetry, sectors}` | which oscillators are in contact, which arrangements are alike |
//! | `lattice::operating_point` | [`PreparedLattice`]: one arrangement as a [`Brake`], and the operating point of a [`Sliding`] state |
//! | `lattice::preload` | normal loads, given or from static equilibrium |
//!
//! **The lattice.**
//! Rows x columns of masses stand for the pad. Chains of springs and dashpots join them in x along the rows and in y
//! along the columns, inclined springs hold them to a foundation, and contact springs press them on a plate that slides
//! in +x: the brake disc. The degrees of freedom are `u = [x1 y1 z1 x2 ... xp yp zp]`, metres; oscillators are numbered
//! by rows; raising the plate (+z) compresses the contacts.
//!
//! ```text
//! M u'' + C u' + K u = F z,   z' = -a z + E u'      (z: bristles of LuGre contacts)
//! ```
//!
//! The steps: [`LatticeParameters`] -> [`LatticeModel`] -> [`LatticeModel::prepare`] once per
//! [`ContactArrangement`] -> [`PreparedLattice::operating_point`] once per sample.
//!
//! ```
//! use friction::{AmontonsCoulomb, FrictionLaw};
//! use osc_model::{
//!     ContactArrangement, ContactPoint, Grid, LatticeModel, LatticeParameters, Lateral, Lean, PlateParameters,
//!     Sliding,
//! };
//!
//! let grid = Grid::new(1, 1)?;
//! let parameters = LatticeParameters {
//!     grid,
//!     x_stiffness: grid.x_chains(2.5e7, 1.0e7),
//!     y_stiffness: grid.y_chains(3.0e7, 3.0e7),
//!     x_damping: vec![0.0; grid.x_springs()],
//!     y_damping: vec![0.0; grid.y_springs()],
//!     z_damping: vec![0.0],
//!     inclined_stiffness: vec![3.0e7],
//!     theta: 60_f64.to_radians(),
//!     phi: 60_f64.to_radians(),
//!     lean: Lean::Against,
//!     contact_stiffness: vec![3.5e7],
//!     oscillator_mass: vec![0.4],
//!     plate: PlateParameters { mass: 9.0, stiffness: [5.0e8; 3], damping: [0.0; 3] },
//! };
//! let model = LatticeModel::new(parameters, Lateral::None, &["yp".parse()?])?;
//! let lattice = model.prepare(&ContactArrangement::full(1))?;
//!
//! let tangent = AmontonsCoulomb::new(0.5)?.tangent_at(1.0)?;
//! let contact = ContactPoint { tangent, lateral_mu: 0.0, normal_load: 600.0 };
//! let system = lattice.linearised(&Sliding { speed: 1.0, contacts: vec![contact] })?;
//! assert_eq!(system.order(), 5); // six degrees of freedom, yp constrained
//! assert_eq!(system.k[(0, 2)] - system.k[(2, 0)], 0.5 * 3.5e7); // friction makes K unsymmetric
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod brake;
mod coupling;
mod error;
mod lattice;
mod sectors;

pub use brake::{Body, Brake};
pub use error::{Allowed, OscModelError};
pub use lattice::{
    Axis, ContactArrangement, ContactPoint, Dof, Grid, Lateral, LatticeBody, LatticeModel, LatticeParameters, Lean,
    Member, PlateParameters, Preload, PreparedLattice, Reversal, Sign, Sliding, SymmetryClass,
};
pub use sectors::{Sector, Sectors};

/// The README's example, compiled and run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
