//! Brakes of cases whose studies fit into memory; what takes long or much is announced, what takes more than there is refused.

use std::io::Write;
use std::path::Path;

use brakes::case::CaseFile;
use brakes::{AnyBrake, Prepared, Purpose};
use output::{bytes_in_words, in_words};
use squeal::study::{Cost, UncertainBrake as _, is_untrusted};
use squeal::workers;

use super::options::{MachineArgs, MemoryArgs};
use super::prepared::{PreparedArgs, in_words as where_prepared};
use crate::Error;
use crate::bar::Bar;
use crate::terminal::note;

/// Longest time of preparation, s, that is not announced; chosen.
const ANNOUNCED: f64 = 5.0;

/// The brake of a case, made for a purpose within the threads and memory of `machine`, of pieces that are where the command looks for them, which it says.
pub(super) fn brake(
    case: CaseFile,
    purpose: Purpose<'_>,
    machine: MachineArgs,
    args: &PreparedArgs,
) -> Result<AnyBrake, Error> {
    let prepared = args.open(&case)?.within(machine.memory.budget());
    let brake = of_pieces(case, purpose, machine, &prepared)?;
    where_prepared(&prepared, args).iter().for_each(|line| note(line));
    // Before a long computation; a study says it in its answer too.
    brake.plan().doubts.iter().for_each(|doubt| note(&format!("WARNING: {doubt}")));
    Ok(brake)
}

/// Writes the answer of a command about a brake, and ends as [`trusted`] says.
pub(super) fn answer(out: &mut dyn Write, text: &str, brake: &AnyBrake, case: &Path) -> Result<(), Error> {
    out.write_all(text.as_bytes()).map_err(Error::StandardOutput)?;
    trusted(brake, case)
}

/// An error, with which the program ends after its answer, where a reduced brake has failed its checks, or nothing is known of its errors.
pub(super) fn trusted(brake: &AnyBrake, case: &Path) -> Result<(), Error> {
    if is_untrusted(brake) { Err(Error::NotTheWholeBrake { path: case.to_owned() }) } else { Ok(()) }
}

/// Memory and processor time of making a brake, roughly, where these are known before and the memory is there.
pub(super) fn fitting(case: &CaseFile, purpose: Purpose<'_>, memory: MemoryArgs) -> Result<Option<Cost>, Error> {
    let cost = brakes::cost_of_making(case, purpose, memory.budget());
    cost.iter().try_for_each(|cost| cost.check(&case.header().source(), memory.budget()))?;
    Ok(cost)
}

/// The brake of a case, of pieces that are read where they are kept. Its size is counted before anything of it is made, and again after.
pub(super) fn of_pieces(
    case: CaseFile,
    purpose: Purpose<'_>,
    MachineArgs { memory, threads }: MachineArgs,
    prepared: &Prepared,
) -> Result<AnyBrake, Error> {
    if let Some(cost) = fitting(&case, purpose, memory)? {
        let is_begun = || if let CaseFile::FiniteElements(case) = &case { prepared.is_begun(case) } else { true };
        if cost.seconds > ANNOUNCED && !is_begun() {
            let (time, memory) = (in_words(cost.seconds), bytes_in_words(cost.bytes));
            note(&format!("bases for {} degrees of freedom: roughly {time} of processor time, {memory}", cost.order));
        }
    }
    let brake = workers(threads)?.install(|| brakes::make_prepared(case, purpose, prepared, &Bar::of("reductions")))?;
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
