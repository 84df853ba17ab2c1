//! Any bytes are either matrices whose entries are within them, or an error of one line. The seeds choose the format:
//! `cargo fuzz run matrices fuzz/seeds/op4`.
#![no_main]

use formats::{Limits, Options, read_bytes};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let limits = Limits { bytes: 1 << 20, entries: 1 << 16, order: 1 << 16 };
    match read_bytes(bytes, None, Options { limits, ..Options::default() }) {
        Ok(file) => {
            assert!(!file.matrices.is_empty());
            for matrix in &file.matrices {
                let (rows, columns) = (matrix.rows(), matrix.columns());
                assert!((1..=limits.order).contains(&rows) && (1..=limits.order).contains(&columns));
                assert!(matrix.row_labels().is_none_or(|labels| labels.len() == rows));
                assert!(matrix.column_labels().is_none_or(|labels| labels.len() == columns));
                let entries = matrix.entries();
                assert!(entries.iter().all(|e| (e.row as usize) < rows && (e.column as usize) < columns));
                assert!(entries.iter().all(|e| e.value.is_finite()));
                assert!(entries.windows(2).all(|w| (w[0].column, w[0].row) < (w[1].column, w[1].row)));
            }
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.contains('\n') && message.len() < 1500, "{message}");
        }
    }
});
