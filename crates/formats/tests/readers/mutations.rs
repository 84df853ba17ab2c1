//! No file, however cut or flipped, makes a reader panic, takes more than it holds, or gives a matrix that contradicts itself.

use std::path::{Path, PathBuf};

use formats::{File, Limits, Options, read_bytes};

use crate::fixture;

/// Every file of the fixtures that has a matrix.
fn all(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(all(&path));
        } else if !path.to_string_lossy().contains("/unv/") && formats::read(&path).is_ok() {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// A generator of reproducible numbers: xorshift64 (Marsaglia, J. Stat. Softw. 8(14), 2003).
struct Random(u64);

impl Random {
    fn below(&mut self, most: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % most as u64) as usize
    }
}

fn check(file: &File) {
    for matrix in &file.matrices {
        for entry in matrix.entries() {
            assert!((entry.row as usize) < matrix.rows() && (entry.column as usize) < matrix.columns());
            assert!(entry.value.is_finite());
        }
        assert!(matrix.entries().windows(2).all(|w| (w[0].column, w[0].row) < (w[1].column, w[1].row)));
        assert!(matrix.row_labels().is_none_or(|labels| labels.len() == matrix.rows()));
        assert!(matrix.column_labels().is_none_or(|labels| labels.len() == matrix.columns()));
        assert_eq!(matrix.to_csc().nnz(), matrix.entries().len());
    }
}

fn try_reading(bytes: &[u8], what: &str) -> bool {
    let limits = Limits { bytes: 1 << 20, entries: 100_000, order: 100_000 };
    match read_bytes(bytes, None, Options { limits, ..Options::default() }) {
        Ok(file) => {
            check(&file);
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.contains('\n') && message.len() < 700, "{what}: {message:?}");
            false
        }
    }
}

#[test]
fn no_damage_makes_a_reader_panic() {
    let files = all(&fixture(""));
    assert!(files.len() >= 23, "{files:?}");
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for path in files {
        let bytes = std::fs::read(&path).unwrap();
        let name = path.display().to_string();
        let cases = if bytes.len() > 20_000 { 30 } else { 300 };
        for case in 0..cases {
            let cut = random.below(bytes.len());
            try_reading(&bytes[..cut], &format!("{name} cut at {cut}"));
            let mut flipped = bytes.clone();
            for _ in 0..=case % 4 {
                let at = random.below(flipped.len().min(if case % 2 == 0 { usize::MAX } else { 400 }));
                flipped[at] = match case % 3 {
                    0 => flipped[at] ^ (1 << random.below(8)),
                    1 => b"0123456789-+.,*$% \n"[random.below(19)],
                    _ => random.below(256) as u8,
                };
            }
            try_reading(&flipped, &format!("{name}, case {case}"));
        }
    }
}

#[test]
fn text_cut_in_the_middle_of_a_list_that_has_a_length_is_refused() {
    let op4 = ["nastran_op4/mat_b_dn.op4", "nastran_op4/mat_b_s1.op4", "nastran_op4/long_words.op4"];
    for name in op4.into_iter().chain(["matlab/v5.mat", "matlab/v7.mat", "numpy/csr.npz"]) {
        let bytes = std::fs::read(fixture(name)).unwrap();
        assert!(try_reading(&bytes, name));
        assert!(!try_reading(&bytes[..bytes.len() - 12], name), "{name}");
    }
    // Lists without a length are refused where the last line has no end: its number may have lost digits.
    for name in ["calculix/tiny.sti", "abaqus_matrix_input/model_STIF1.mtx", "abaqus_substructure/symmetric_inner.mtx"]
    {
        let bytes = std::fs::read(fixture(name)).unwrap();
        let message = read_bytes(&bytes[..bytes.len() - 2], None, Options::default()).unwrap_err().to_string();
        assert!(message.ends_with("the file ends within a line; a whole file ends with a line end"), "{message}");
    }
}
