//! Coordinates that the bases of two arrangements have in common, in which the modes of one become those of the other.
//!
//! They hold the modes of both in the followed band, and those on the way.

use nalgebra::DMatrix;
use sparse::reduction::path_directions;

use super::points::{all_patches, naming_point, of_brake};
use super::{FiniteElementBrake, Part};
use crate::Error;
use crate::study::Bridge;

/// Part of a column of a basis below which it is in the other one.
const COMMON: f64 = 1e-10;

/// The bridge from the naming point of a configuration's set of constraints to its own; `None` where both have one basis.
pub(super) fn bridge(brake: &FiniteElementBrake, configuration: usize) -> Result<Option<Bridge>, Error> {
    let own = brake.of_configurations[configuration];
    let set = brake.parts[own].set;
    let origin = brake.of_origins[set];
    if origin == own {
        return Ok(None);
    }
    let [origin_part, own_part]: [&Part; 2] = [&brake.parts[origin], &brake.parts[own]];
    let [from, to] = [&origin_part.within.basis, &own_part.within.basis];
    let all = all_patches(&brake.case);
    let system = |closed: &[usize], on: &DMatrix<f64>| {
        let at = of_brake(&brake.case, closed, &naming_point(&brake.case, closed)?);
        Ok::<_, Error>(brake.sets[set].reduced.assemble(&at)?.projected(on)?)
    };
    let both = union(from, to);
    let ends = [system(&all, &both)?, system(&brake.closed[configuration], &both)?];
    // Modes are followed on no more columns than hold them: both bases are made for the friction of all draws.
    let few = match brake.plan.followed_band() {
        Some(band) => path_directions(&ends[0], &ends[1], band)?,
        None => DMatrix::identity(both.ncols(), both.ncols()),
    };
    let onto = few.transpose() * both.transpose();
    Ok(Some(Bridge {
        from: ends[0].projected(&few)?,
        to: ends[1].projected(&few)?,
        origin: &onto * from,
        own: &onto * to,
    }))
}

/// Orthonormal columns that span those of both, themselves orthonormal.
fn union(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut columns: Vec<_> = a.column_iter().map(|column| column.into_owned()).collect();
    for column in b.column_iter() {
        let mut rest = column.into_owned();
        for _ in 0..2 {
            for known in &columns {
                let along = known.dot(&rest);
                rest.axpy(-along, known, 1.0);
            }
        }
        let size = rest.norm();
        if size > COMMON {
            columns.push(rest / size);
        }
    }
    DMatrix::from_columns(&columns)
}
