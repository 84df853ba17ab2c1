//! Arithmetic on vector registers: each lane holds one sample, matrix or point, and no operation mixes lanes.

mod complex;
mod ops;

use pulp::{Arch, Simd, WithSimd};

pub use complex::{ComplexLanes, complex, conj_fma, fma, scale, square};
pub use ops::{Ops, registers};

/// Most systems that are solved together: the numbers of the widest registers (AVX-512).
pub const WIDEST_LANES: usize = 8;

/// How many of `systems` are solved on registers of eight lanes (AVX-512); the rest, four or fewer, are solved on four lanes
/// (AVX2). An operation on eight lanes takes up to twice as long, whatever the number of lanes in use.
pub fn wide_part(systems: usize) -> usize {
    let left = systems % WIDEST_LANES;
    if left <= 4 { systems - left } else { systems }
}

/// Runs a kernel on four lanes where the machine has AVX-512, with the same results to the last bit; elsewhere on the usual
/// registers.
pub fn narrow<K: WithSimd>(arch: Arch, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if let (Arch::V4(_), Some(avx2)) = (arch, pulp::x86::V3::try_new()) {
        return Simd::vectorize(avx2, kernel);
    }
    arch.dispatch(kernel)
}
