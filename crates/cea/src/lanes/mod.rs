//! Vector registers as lanes: one sample, matrix or point in each, and no operation that mixes them.

mod complex;
mod ops;

use pulp::{Arch, Simd, WithSimd};

pub(crate) use complex::{ComplexLanes, complex, conj_fma, fma, scale, square};
pub(crate) use ops::{Ops, registers};

/// How many of some systems fill the wide registers of AVX-512 better than the narrow ones of AVX2: all but the last four or
/// fewer. An operation on the wide registers takes up to twice as long, whatever the number of lanes in use.
pub(crate) fn wide_part(systems: usize) -> usize {
    let left = systems % 8;
    if left <= 4 { systems - left } else { systems }
}

/// Runs a kernel on at most four lanes where there are such registers with the same bits, otherwise as usual.
pub(crate) fn narrow<K: WithSimd>(arch: Arch, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if let (Arch::V4(_), Some(avx2)) = (arch, pulp::x86::V3::try_new()) {
        return Simd::vectorize(avx2, kernel);
    }
    arch.dispatch(kernel)
}
