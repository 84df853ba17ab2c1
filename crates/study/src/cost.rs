//! Cost of a study, roughly, before anything of it is computed.

use linsys::AffineSystem;

use super::Plan;
use crate::{Error, memory};

/// Memory of a study from its preparation to its report, within a factor of two or so, and processor time until its first sample, within
/// a factor of five or so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Degrees of freedom, the most of any configuration.
    pub order: usize,
    /// Internal states of what relaxes, the most of any configuration.
    pub relaxing: usize,
    /// Scenes.
    pub scenes: usize,
    /// Memory, bytes.
    pub bytes: f64,
    /// Memory of complete solutions of the brake and of the bases of its sets of constraints, whatever is studied, bytes; it is in `bytes` too.
    pub bytes_of_whole: f64,
    /// Processor time of reference modes and anchors, s.
    pub seconds: f64,
}

/// Memory of a scene, bytes for each entry of a matrix of the order of the brake: its system and modes at the medians, whole and by
/// sectors, and its counts. This constant and the three below are fitted to the peak memory of `squeal run` (GNU time) on two
/// threads for lattices of 2 x 2 to 12 x 12 with and without symmetry, two scenes each, 8 to 1,000 samples, 21 to 592 MB, and for
/// `cases/paper.toml` with its 675 scenes.
const BYTES_BY_SCENE: f64 = 220.0;
/// Memory of a configuration, bytes for each entry of a matrix: its terms. Fitted with [`BYTES_BY_SCENE`].
const BYTES_BY_CONFIGURATION: f64 = 130.0;
/// Memory of a thread, bytes for each entry of a matrix: the computations of the report. Fitted with [`BYTES_BY_SCENE`].
const BYTES_BY_THREAD: f64 = 900.0;
/// Memory of each of the samples that a thread solves together, bytes for each entry of a matrix: systems, spectra and continuations.
/// Fitted with [`BYTES_BY_SCENE`].
const BYTES_BY_SAMPLE: f64 = 65.0;
/// Memory of a thread, bytes for each entry that states of what relaxes add to a matrix of a spectrum, a quarter of `(2 n + s)^2 - (2 n)^2`: spectra, and
/// how states act and are driven. Measured together with the next constant, with terms of full rank and one or two branches, 50 to 150 degrees of freedom,
/// on two threads: 115 to 224 with 8 samples together, 250 with 30.
const BYTES_BY_THREAD_OF_STATES: f64 = 100.0;
/// Memory of each of the samples that a thread solves together, likewise.
const BYTES_BY_SAMPLE_OF_STATES: f64 = 5.0;
/// Memory of the program in any case, bytes. Measured.
const BYTES_ALWAYS: f64 = 2.6e7;
/// Processor time for each scene, s, by the cube of the order. Measured with the same lattices and case on an AMD EPYC (Zen 4): 4e-8, 6e-7
/// and 9e-8.
const SECONDS_BY_SCENE: f64 = 2e-7;

/// Columns over all degrees of freedom that the basis of a set of constraints has, and those that making one takes beside it: directions of the modes that it is
/// made of, twice while some are added, and these modes. Measured with cases/disc-pad and its refinements, 255 to 305 and 680 to 730 directions; with 108,459
/// degrees of freedom and one solution at a time 6.4 GB were taken while the second of two bases was made.
const COLUMNS_OF_SET: usize = 300;
const COLUMNS_IN_THE_MAKING: usize = 1700;
/// Memory of a basis within the basis of a set, bytes by the square of its columns: its terms, residuals and anchors. With solutions measured with
/// cases/disc-pad and its refinement, 20 bases: 360 MB for 2,349 degrees of freedom (93 to 111 columns) and 1.6 GB for 14,985 (117 to 157).
const BYTES_BY_BASIS: f64 = 900.0;
/// Processor time for each basis, s, by the cube of its columns. Measured with the same: 10 and 30 s.
const SECONDS_BY_BASIS: f64 = 6e-7;
/// Fraction of the memory there is that complete solutions which are under way together may take; chosen: the bases take the rest.
const PART_OF_SOLUTIONS: f64 = 0.6;

/// Degrees of freedom of the refined disc and pad by which a complete solution is scaled, of 2,349 to 205,227.
const LARGE: f64 = 47_376.0;
/// Memory of a complete solution of it, bytes, and the power of the degrees of freedom by which it grows. Measured: 0.37, 1.38, 3.67 and 8.04 GB for 14,985,
/// 47,376, 108,459 and 205,227 degrees of freedom (docs/large-problems.md).
const BYTES_OF_LARGE: f64 = 1.4e9;
const POWER_OF_BYTES: f64 = 1.2;
/// Processor time of a complete solution of it, s, and the power by which it grows. Measured for the same: 2.1, 8.1, 30 and 78 s.
const SECONDS_OF_LARGE: f64 = 9.0;
const POWER_OF_SECONDS: f64 = 1.5;

impl Cost {
    /// The cost of `samples` samples, on all cores, of scenes and configurations of an order.
    pub fn new(order: usize, configurations: usize, scenes: usize, samples: u64) -> Self {
        let (size, configurations, count) = (order as f64, configurations as f64, scenes as f64);
        let by_thread = BYTES_BY_THREAD + BYTES_BY_SAMPLE * samples_together(samples) as f64;
        let entry = BYTES_BY_SCENE * count + BYTES_BY_CONFIGURATION * configurations + by_thread * threads();
        let seconds = SECONDS_BY_SCENE * count * size.powi(3);
        Self { order, relaxing: 0, scenes, bytes: BYTES_ALWAYS + entry * size * size, bytes_of_whole: 0.0, seconds }
    }

    /// The cost of a plan.
    pub fn of(plan: &Plan) -> Self {
        let systems = || plan.configurations.iter().map(|configuration| &configuration.brake.system);
        let order = systems().map(AffineSystem::order).max().unwrap_or(0);
        let relaxing = systems().map(|system| system.channels().len() - system.contacts().count()).max().unwrap_or(0);
        Self::new(order, plan.configurations.len(), plan.scenes.len(), plan.samples).with_states(relaxing, plan.samples)
    }

    /// The cost with internal states of what relaxes: a spectrum then has `2 n + s` eigenvalues.
    fn with_states(self, relaxing: usize, samples: u64) -> Self {
        let (size, half) = (self.order as f64, 0.5 * relaxing as f64);
        let by_thread = BYTES_BY_THREAD_OF_STATES + BYTES_BY_SAMPLE_OF_STATES * samples_together(samples) as f64;
        let more = (size + half).powi(2) - size * size;
        let seconds = SECONDS_BY_SCENE * self.scenes as f64 * ((size + half).powi(3) - size.powi(3));
        Self { relaxing, bytes: self.bytes + by_thread * threads() * more, seconds: self.seconds + seconds, ..self }
    }

    /// The cost of a reduction of a brake of `order` degrees of freedom: of the bases of `sets` sets of constraints, and within them of bases of `columns` columns
    /// each.
    pub fn of_bases(order: usize, sets: usize, columns: &[usize]) -> Self {
        let in_the_making = if sets == 0 { 0 } else { COLUMNS_IN_THE_MAKING };
        let bytes_of_whole = (8 * order * (in_the_making + COLUMNS_OF_SET * sets)) as f64;
        let bytes_of = |&columns: &usize| BYTES_BY_BASIS * (columns as f64).powi(2);
        let seconds = |&columns: &usize| SECONDS_BY_BASIS * (columns as f64).powi(3);
        let bytes = bytes_of_whole + columns.iter().map(bytes_of).sum::<f64>();
        Self { order, relaxing: 0, scenes: 0, bytes, bytes_of_whole, seconds: columns.iter().map(seconds).sum() }
    }

    /// The cost with `count` complete solutions of the whole brake beside it: its modes in a band, as many at a time as a `budget` of bytes allows.
    #[must_use]
    pub fn with_solutions(self, count: usize, budget: u64) -> Self {
        let together = solutions_together(self.order, budget).min(count) as f64;
        let seconds = SECONDS_OF_LARGE * (self.order as f64 / LARGE).powf(POWER_OF_SECONDS);
        let more = together * bytes_of_solution(self.order);
        let (bytes, bytes_of_whole) = (self.bytes + more, self.bytes_of_whole + more);
        Self { bytes, bytes_of_whole, seconds: self.seconds + count as f64 * seconds, ..self }
    }

    /// The time on all cores of what they share, s.
    #[must_use]
    pub fn seconds_on_all_cores(&self) -> f64 {
        self.seconds / threads()
    }

    /// Refuses a study that takes more memory than there is, `budget` bytes; `study` is the case file or the name.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub fn check(&self, study: &str, budget: u64) -> Result<(), Error> {
        let Self { order, relaxing, scenes, bytes, bytes_of_whole, .. } = *self;
        let states =
            if relaxing > 0 { format!(" and {relaxing} internal states of what relaxes") } else { String::new() };
        let what = match scenes {
            0 => format!("{study}: bases for {order} degrees of freedom"),
            _ => format!("{study}: {scenes} scenes of {order} degrees of freedom{states}"),
        };
        let fixed = BYTES_ALWAYS + bytes_of_whole;
        let share = (budget as f64 - fixed).max(0.0) / (bytes - fixed);
        let fits = || match scenes {
            0 if share > 0.01 => format!("{:.0} % of its arrangements", (100.0 * share).floor()),
            0 => format!("a mesh with {:.0} degrees of freedom", order_of(PART_OF_SOLUTIONS * budget as f64).floor()),
            _ => format!(
                "{:.0} degrees of freedom with as many scenes, or fewer arrangements, laws, speed ranges or constraint sets",
                (order as f64 * share.sqrt()).floor()
            ),
        };
        memory::check(&what, bytes, budget, fits)
    }
}

/// Memory of a complete solution of a brake of an order, bytes, roughly.
fn bytes_of_solution(order: usize) -> f64 {
    BYTES_OF_LARGE * (order as f64 / LARGE).powf(POWER_OF_BYTES)
}

/// Order of a brake of which a complete solution takes `bytes` bytes, roughly.
fn order_of(bytes: f64) -> f64 {
    LARGE * (bytes / BYTES_OF_LARGE).powf(1.0 / POWER_OF_BYTES)
}

/// Number of complete solutions of a brake of an order that are under way together: one for each thread, and fewer where their memory is more than a part of a
/// `budget` of bytes. No result depends on it.
#[must_use]
pub fn solutions_together(order: usize, budget: u64) -> usize {
    let fitting = PART_OF_SOLUTIONS * budget as f64 / bytes_of_solution(order);
    fitting.min(threads()).max(1.0) as usize
}

/// Number of threads that a study has where nobody says another number.
fn threads() -> f64 {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get) as f64
}

/// Number of samples evaluated together as one block, on which no result depends: as many as fill the lanes of the solver again and again, but so few that
/// there are blocks for many threads, of which 2, 4 or 8 get equally many each.
pub fn samples_together(samples: u64) -> u64 {
    let blocks = samples.div_ceil(128).max(1).next_multiple_of(8);
    samples.div_ceil(blocks).max(8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_take_memory_and_time_and_none_take_nothing() {
        let plain = Cost::new(100, 1, 1, 8);
        assert_eq!(plain.with_states(0, 8), plain);
        let [some, more] = [100, 200].map(|states| plain.with_states(states, 8));
        assert!(more.bytes > some.bytes && some.bytes > plain.bytes);
        // As many states as eigenvalues without them: eight times the time of a spectrum.
        assert!((more.seconds / plain.seconds - 8.0).abs() < 1e-12);
        let refused = more.check("shim.toml", 1_000_000).unwrap_err().to_string();
        assert!(
            refused.contains("1 scenes of 100 degrees of freedom and 200 internal states of what relaxes"),
            "{refused}"
        );
    }

    #[test]
    fn as_many_solutions_are_under_way_as_fit_into_memory() {
        let of = |order, budget| solutions_together(order, budget);
        assert_eq!([of(100_000, 1), of(100_000, 8_000_000_000), of(1_000, u64::MAX)], [1, 1, threads() as usize]);
        let cost = |count, budget| Cost::of_bases(100_000, 1, &[100]).with_solutions(count, budget);
        let (none, one, more) = (cost(0, u64::MAX), cost(1, u64::MAX), cost(40, 8_000_000_000));
        assert!(none.bytes < one.bytes && one.bytes == more.bytes && one.seconds < more.seconds);
        let refused = |budget| {
            let cost = Cost::of_bases(100_000, 2, &[100; 20]).with_solutions(40, budget);
            cost.check("disc.toml", budget).unwrap_err().to_string()
        };
        // What fits does not take more than there is.
        let of_parts = 20.0 * BYTES_BY_BASIS * 100_f64.powi(2);
        let half = refused(
            (Cost::of_bases(100_000, 2, &[100; 20]).with_solutions(1, 1).bytes - 0.5 * (of_parts - BYTES_ALWAYS))
                as u64,
        );
        assert!(half.contains("50 % of its arrangements") || half.contains("49 % of its arrangements"), "{half}");
        let coarser = refused(1_000_000_000);
        let order: f64 = coarser.split("a mesh with ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!(bytes_of_solution(order as usize) < 1e9 && order > 20_000.0, "{coarser}");
    }

    #[test]
    fn threads_get_equally_many_blocks() {
        for (samples, expected) in [(1, 8), (100, 13), (1000, 125), (10_000, 125), (100_000, 128)] {
            assert_eq!(samples_together(samples), expected);
        }
        assert!((1..5000).all(|samples| (8..=128).contains(&samples_together(samples))));
    }
}
