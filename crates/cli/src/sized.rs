//! Brakes of cases whose studies fit into memory; what takes long or much is announced, what takes more than there is refused.

use brakes::case::{FiniteElementCase, LatticeCase, MatricesCase};
use brakes::{FiniteElementBrake, LatticeBrake, MatricesBrake};
use output::{bytes_in_words, in_words};
use squeal::study::{Cost, Plan};

use super::options::MemoryArgs;
use crate::Error;
use crate::terminal::note;

/// From how many seconds of preparation on it is announced; chosen.
const ANNOUNCED: f64 = 5.0;

/// The brake of a case. Its size is counted before any scene of it is made, and again after.
pub(super) fn lattice(case: LatticeCase, memory: MemoryArgs) -> Result<LatticeBrake, Error> {
    LatticeBrake::least_cost(&case).check(&case.path.display().to_string(), memory.budget())?;
    let brake = LatticeBrake::new(case)?;
    announced(&brake.plan, memory)?;
    Ok(brake)
}

/// The brake of a case that is given by its matrices.
pub(super) fn matrices(case: MatricesCase, memory: MemoryArgs) -> Result<MatricesBrake, Error> {
    let brake = MatricesBrake::new(case)?;
    announced(&brake.plan, memory)?;
    Ok(brake)
}

/// Says which nodes of the contact of a finite element case count as held, and what its bases take, before any is made.
pub(super) fn bases(case: &FiniteElementCase, memory: MemoryArgs) -> Result<(), Error> {
    for missing in case.missing_rows.iter().filter(|missing| missing.field.starts_with("contact.")) {
        note(&missing.to_string());
    }
    let cost = FiniteElementBrake::expected_cost(case);
    cost.check(&case.path.display().to_string(), memory.budget())?;
    if cost.seconds > ANNOUNCED {
        let (time, memory) = (in_words(cost.seconds), bytes_in_words(cost.bytes));
        note(&format!("bases for {} degrees of freedom: roughly {time} of processor time, {memory}", cost.order));
    }
    Ok(())
}

/// Says what a study takes, where its preparation takes more than some seconds, and refuses what takes more memory than there is.
pub(super) fn announced(plan: &Plan, memory: MemoryArgs) -> Result<Cost, Error> {
    let cost = Cost::of(plan);
    cost.check(&plan.source(), memory.budget())?;
    if cost.seconds > ANNOUNCED {
        let (scenes, order, time) = (cost.scenes, cost.order, in_words(cost.seconds));
        let memory = bytes_in_words(cost.bytes);
        note(&format!("{scenes} scenes of {order} degrees of freedom: roughly {time} to prepare them, {memory}"));
    }
    Ok(cost)
}
