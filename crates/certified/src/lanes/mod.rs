//! Arithmetic on vector registers, in single and double precision: the one layer between pulp and all that computes by hand.
//!
//! Mostly a lane holds one sample, matrix or point (`cea`: batches, null vectors, secular equations; `reduction`: counts); rows of
//! complex matrices with their parts apart (`reduction::rows`) take the same operations, with neighbours in the lanes. What stays apart:
//!
//! - `certified::lane` computes with these operations, but a number may be two registers there (double-double).
//! - `sparse`'s `solver::lanes`: blocks of faer have real and imaginary parts by turns, and a coefficient that is read from memory
//!   once is a factor of both; products there are rounded once on every machine.
//! - `linsys::real_times_complex` and [`crate::lu`] have no instruction of their own: plain loops that are compiled for
//!   each instruction set, with the same bits on all.

mod complex;
mod ops;
mod precision;

use pulp::{Arch, Simd, WithSimd};

pub use complex::{ComplexLanes, conj_fma, fma, fnma, neg, scale, splat, square, times};
pub use ops::{Ops, registers};
pub use precision::{Precision, cast};

/// Most systems that are solved together: the numbers of the widest registers (AVX-512).
pub const WIDEST_LANES: usize = 8;

/// Number of `systems` that are solved on registers of eight lanes (AVX-512); the rest, four or fewer, are solved on four lanes
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
