//! Brakes of cases whose studies fit into memory; what takes long or much is announced, what takes more than there is refused.

use brakes::case::CaseFile;
use brakes::{AnyBrake, Purpose};
use output::{bytes_in_words, in_words};
use squeal::study::{Cost, UncertainBrake as _};
use squeal::workers;

use super::options::MachineArgs;
use crate::Error;
use crate::bar::Bar;
use crate::terminal::note;

/// Time of preparation, s, above which it is announced; chosen.
const ANNOUNCED: f64 = 5.0;

/// The brake of a case, made for a purpose on some worker threads. Its size is counted before anything of it is made, and again after.
pub(super) fn brake(
    case: CaseFile,
    purpose: Purpose<'_>,
    MachineArgs { memory, threads }: MachineArgs,
) -> Result<AnyBrake, Error> {
    if let Some(cost) = brakes::cost_of_making(&case) {
        cost.check(&case.header().source(), memory.budget())?;
        if cost.seconds > ANNOUNCED && matches!(case, CaseFile::FiniteElements(_)) {
            let (time, memory) = (in_words(cost.seconds), bytes_in_words(cost.bytes));
            note(&format!("bases for {} degrees of freedom: roughly {time} of processor time, {memory}", cost.order));
        }
    }
    let brake = workers(threads)?.install(|| brakes::make(case, purpose, &Bar::of("reductions")))?;
    if brake.mode_source().is_none() {
        let cost = Cost::of(brake.plan());
        cost.check(&brake.plan().source(), memory.budget())?;
        if cost.seconds > ANNOUNCED {
            let (scenes, order, time) = (cost.scenes, cost.order, in_words(cost.seconds));
            let memory = bytes_in_words(cost.bytes);
            note(&format!("{scenes} scenes of {order} degrees of freedom: roughly {time} to prepare them, {memory}"));
        }
    }
    Ok(brake)
}
