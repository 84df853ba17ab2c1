//! Coordinates that the bases of two arrangements have in common, in which the modes of one become those of the other.

use nalgebra::DMatrix;

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
    let both = union(from, to);
    let transposed = both.transpose();
    let all = all_patches(&brake.case);
    let system = |closed: &[usize]| {
        let at = of_brake(&brake.case, closed, &naming_point(&brake.case, closed)?);
        Ok::<_, Error>(brake.sets[set].reduced.assemble(&at)?.projected(&both)?)
    };
    Ok(Some(Bridge {
        from: system(&all)?,
        to: system(&brake.closed[configuration])?,
        origin: &transposed * from,
        own: &transposed * to,
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
