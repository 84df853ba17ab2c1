//! Options that several commands share.

use brakes::case::CaseHeader;
use squeal::memory;

use crate::Error;

/// Largest number of worker threads that may be asked for; chosen, more than any machine has cores for.
const MOST_THREADS: usize = 1024;

/// The value of an option that is a whole number.
///
/// # Errors
/// A text that is refused, with what is allowed.
pub fn whole_number(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("allowed: a whole number, 0 to {}", u64::MAX))
}

/// The value of an option that is a number of samples.
///
/// # Errors
/// As [`whole_number`], of numbers that a study cannot have.
pub fn samples(text: &str) -> Result<u64, String> {
    let most = CaseHeader::MOST_SAMPLES;
    let number = text.parse().ok().filter(|samples| (1..=most).contains(samples));
    number.ok_or_else(|| format!("allowed: 1 to {most}"))
}

/// The value of an option that is a number of threads.
///
/// # Errors
/// A text that is refused, with what is allowed.
pub fn threads(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| format!("allowed: 1 to {MOST_THREADS}"))
}

/// The value of an option that is a number.
///
/// # Errors
/// A text that is refused, with what is allowed.
pub fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "allowed: a number".to_owned())
}

/// Memory that a command may take.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct MemoryArgs {
    /// Memory that may be taken, as 512M or 8G; what takes more is refused [default: what the machine has]
    #[arg(long, value_name = "SIZE", allow_negative_numbers = true, value_parser = memory::size)]
    pub memory: Option<u64>,
}

impl MemoryArgs {
    /// Bytes.
    #[must_use]
    pub fn budget(self) -> u64 {
        self.memory.unwrap_or_else(memory::of_machine)
    }
}

/// Threads and memory that a command may take.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct MachineArgs {
    /// Worker threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = threads)]
    pub threads: Option<usize>,
    /// Memory that may be taken
    #[command(flatten)]
    pub memory: MemoryArgs,
}

impl From<MemoryArgs> for MachineArgs {
    fn from(memory: MemoryArgs) -> Self {
        Self { threads: None, memory }
    }
}

/// Refuses a number of threads that is out of range.
pub(super) fn check_threads(threads: Option<usize>) -> Result<(), Error> {
    match threads.filter(|threads| !(1..=MOST_THREADS).contains(threads)) {
        Some(threads) => {
            let (value, allowed) = (threads.to_string(), format!("1 to {MOST_THREADS}"));
            Err(Error::Option { option: "--threads", value, allowed })
        }
        None => Ok(()),
    }
}

/// Puts the options of the command line in place of a case's own samples and seed.
///
/// # Errors
/// Samples or threads out of range.
pub fn override_run(
    own: &mut CaseHeader,
    samples: Option<u64>,
    seed: Option<u64>,
    threads: Option<usize>,
) -> Result<(), Error> {
    let refused = |option, value: String, most: u64| Error::Option { option, value, allowed: format!("1 to {most}") };
    if let Some(samples) = samples.filter(|samples| !(1..=CaseHeader::MOST_SAMPLES).contains(samples)) {
        return Err(refused("--samples", samples.to_string(), CaseHeader::MOST_SAMPLES));
    }
    check_threads(threads)?;
    own.samples = samples.unwrap_or(own.samples);
    own.seed = seed.unwrap_or(own.seed);
    Ok(())
}
