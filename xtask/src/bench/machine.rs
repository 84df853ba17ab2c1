//! The machine, and the peak of one core: the rate of fused multiply-adds on registers.

use std::hint::black_box;
use std::time::Instant;

use pulp::{Arch, Simd, WithSimd};
use serde::Serialize;

/// Number of independent sums; chosen: more than latency times throughput of current cores, and fewer than their registers.
const INDEPENDENT_SUMS: usize = 12;
/// Number of additions to each sum in one repetition; chosen, a millisecond or less.
const ADDITIONS_PER_SUM: usize = 100_000;
/// Number of repetitions, of which the fastest is reported; chosen.
const PEAK_REPEATS: usize = 50;

/// The machine on which the bench ran.
#[derive(Debug, Clone, Serialize)]
pub struct Machine {
    /// Name of the processor.
    pub processor: String,
    /// Number of cores that this process may use.
    pub cores: usize,
    /// Number of lanes of the vector registers that BatchSolver uses.
    pub lanes: usize,
    /// Multiplications and additions of doubles per nanosecond, one thread.
    pub peak_gflops: f64,
}

impl Machine {
    /// Machine on which this process runs; measures its peak.
    pub fn this() -> Self {
        let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let name = info
            .lines()
            .find_map(|line| line.strip_prefix("model name"))
            .map(|name| name.trim_matches([' ', '\t', ':']));
        let (lanes, peak_gflops) = (0..PEAK_REPEATS)
            .map(|_| Arch::new().dispatch(MultiplyAdds))
            .fold((0, 0.0), |best, one| if one.1 > best.1 { one } else { best });
        Self {
            processor: name.unwrap_or(std::env::consts::ARCH).to_owned(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            lanes,
            peak_gflops,
        }
    }
}

/// Fused multiply-adds on numbers that stay in registers.
struct MultiplyAdds;

impl WithSimd for MultiplyAdds {
    /// Lanes, and operations per nanosecond.
    type Output = (usize, f64);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> (usize, f64) {
        let (x, y) = (simd.splat_f64s(black_box(0.999)), simd.splat_f64s(black_box(1e-3)));
        let mut sums = [y; INDEPENDENT_SUMS];
        let start = Instant::now();
        for _ in 0..ADDITIONS_PER_SUM {
            for sum in &mut sums {
                *sum = simd.mul_add_e_f64s(*sum, x, y);
            }
        }
        let elapsed = start.elapsed();
        black_box(&sums);
        (S::F64_LANES, (2 * INDEPENDENT_SUMS * ADDITIONS_PER_SUM * S::F64_LANES) as f64 / elapsed.as_nanos() as f64)
    }
}
