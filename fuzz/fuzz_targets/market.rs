//! Any bytes are either a matrix of finite numbers of the size they announce or an error of one line.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    match linsys::read_market(bytes) {
        Ok(matrix) => {
            assert!((1..=linsys::LARGEST_ORDER).contains(&matrix.nrows()));
            assert!((1..=linsys::LARGEST_ORDER).contains(&matrix.ncols()));
            assert!(matrix.iter().all(|x| x.is_finite()));
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.contains('\n') && message.len() < 600, "{message}");
        }
    }
});
