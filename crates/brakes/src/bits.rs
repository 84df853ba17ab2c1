//! Pieces of a reduction as bytes, to the last bit of every number.

use std::collections::BTreeMap;

use linsys::{ChannelGain, Lag, OperatingPoint};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use reduction::{CoarseBasis, CoarseStates, SnapshotMode, Within};
use study::{DivergenceCounts, FullChecks};

/// A value that can be written as bytes and read again, numbers little-endian.
pub(crate) trait Bits: Sized {
    /// Adds the value to bytes.
    fn put(&self, to: &mut Vec<u8>);

    /// Takes a value from the beginning of bytes; `None` where they hold no value.
    fn take(from: &mut &[u8]) -> Option<Self>;

    /// The value as bytes.
    fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.put(&mut bytes);
        bytes
    }

    /// The value that `bytes` hold; `None` if they hold none, or more than one.
    fn whole(mut bytes: &[u8]) -> Option<Self> {
        let value = Self::take(&mut bytes)?;
        bytes.is_empty().then_some(value)
    }
}

/// Adds the values of `list` to bytes, after their number.
pub(crate) fn put_list<T: Bits>(list: &[T], to: &mut Vec<u8>) {
    list.len().put(to);
    list.iter().for_each(|value| value.put(to));
}

impl Bits for u64 {
    fn put(&self, to: &mut Vec<u8>) {
        to.extend(self.to_le_bytes());
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        let (first, rest) = from.split_first_chunk()?;
        *from = rest;
        Some(Self::from_le_bytes(*first))
    }
}

impl Bits for usize {
    fn put(&self, to: &mut Vec<u8>) {
        (*self as u64).put(to);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        u64::take(from)?.try_into().ok()
    }
}

impl Bits for bool {
    fn put(&self, to: &mut Vec<u8>) {
        u64::from(*self).put(to);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        match u64::take(from)? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

impl Bits for f64 {
    fn put(&self, to: &mut Vec<u8>) {
        self.to_bits().put(to);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        u64::take(from).map(Self::from_bits)
    }
}

impl Bits for Complex<f64> {
    fn put(&self, to: &mut Vec<u8>) {
        [self.re, self.im].put(to);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        <[f64; 2]>::take(from).map(|[re, im]| Self { re, im })
    }
}

impl Bits for String {
    fn put(&self, to: &mut Vec<u8>) {
        self.as_bytes().to_vec().put(to);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        Self::from_utf8(Vec::take(from)?).ok()
    }
}

impl Bits for u8 {
    fn put(&self, to: &mut Vec<u8>) {
        to.push(*self);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        let (&first, rest) = from.split_first()?;
        *from = rest;
        Some(first)
    }
}

impl<T: Bits> Bits for [T; 2] {
    fn put(&self, to: &mut Vec<u8>) {
        self.iter().for_each(|value| value.put(to));
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        Some([T::take(from)?, T::take(from)?])
    }
}

impl<A: Bits, B: Bits> Bits for (A, B) {
    fn put(&self, to: &mut Vec<u8>) {
        self.0.put(to);
        self.1.put(to);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        Some((A::take(from)?, B::take(from)?))
    }
}

impl<T: Bits> Bits for Option<T> {
    fn put(&self, to: &mut Vec<u8>) {
        self.is_some().put(to);
        self.iter().for_each(|value| value.put(to));
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        if bool::take(from)? { T::take(from).map(Some) } else { Some(None) }
    }
}

impl<T: Bits> Bits for Vec<T> {
    fn put(&self, to: &mut Vec<u8>) {
        put_list(self, to);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        // Every value has a byte at least: what is damaged asks for no memory.
        let count = usize::take(from).filter(|count| *count <= from.len())?;
        (0..count).map(|_| T::take(from)).collect()
    }
}

impl<K: Bits + Ord, V: Bits> Bits for BTreeMap<K, V> {
    fn put(&self, to: &mut Vec<u8>) {
        self.len().put(to);
        for (key, value) in self {
            key.put(to);
            value.put(to);
        }
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        Vec::take(from).map(|pairs: Vec<(K, V)>| pairs.into_iter().collect())
    }
}

impl Bits for DVector<Complex<f64>> {
    fn put(&self, to: &mut Vec<u8>) {
        put_list(self.as_slice(), to);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        Vec::take(from).map(Self::from_vec)
    }
}

impl Bits for DMatrix<f64> {
    fn put(&self, to: &mut Vec<u8>) {
        [self.nrows(), self.ncols()].put(to);
        put_list(self.as_slice(), to);
    }

    fn take(from: &mut &[u8]) -> Option<Self> {
        let ([rows, columns], entries) = (<[usize; 2]>::take(from)?, Vec::take(from)?);
        (rows.checked_mul(columns) == Some(entries.len())).then(|| Self::from_vec(rows, columns, entries))
    }
}

/// A struct as its fields, all of them: one that is forgotten does not compile.
macro_rules! bits {
    ($name:ty { $($field:ident),* }) => {
        impl $crate::bits::Bits for $name {
            fn put(&self, to: &mut Vec<u8>) {
                let Self { $($field),* } = self;
                $($crate::bits::Bits::put($field, to);)*
            }

            fn take(from: &mut &[u8]) -> Option<Self> {
                $(let $field = $crate::bits::Bits::take(from)?;)*
                Some(Self { $($field),* })
            }
        }
    };
}
pub(crate) use bits;

bits!(OperatingPoint { coefficients, channels });
bits!(ChannelGain { mu, slope, lag });
bits!(Lag { decay, drive, force });
bits!(Within { basis, solved, missed, distance });
bits!(SnapshotMode { lambda, right, left, condition });
bits!(CoarseBasis { basis, states, error, residual });
bits!(CoarseStates { channels, directions });
bits!(DivergenceCounts { draws, diverging, beyond, open, fastest });
bits!(FullChecks {
    samples,
    failed,
    modes,
    missing,
    invented,
    other_verdicts,
    residuals_above,
    growing_beside,
    beside_hz,
    divergence,
    largest_distance,
    trained_on
});
