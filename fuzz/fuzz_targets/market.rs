//! Any bytes are either a matrix of finite numbers of the size they announce or an error of one line.
#![no_main]

use formats::{Limits, Options, read_market};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let limits = Limits { bytes: 1 << 20, entries: 1 << 20, order: 4096 };
    match read_market(bytes, Options { limits, ..Options::default() }) {
        Ok(matrix) => {
            assert!((1..=limits.order).contains(&matrix.rows()));
            assert!((1..=limits.order).contains(&matrix.columns()));
            assert!(matrix.entries().iter().all(|entry| entry.value.is_finite()));
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.contains('\n') && message.len() < 600, "{message}");
        }
    }
});
