//! What is no matrix file, or asks for too much: one line each, and no memory that the file does not pay for.

use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use formats::{Limits, Options, read, read_bytes};

use crate::fixture;

fn message(bytes: &[u8]) -> String {
    read_bytes(bytes, None, Options::default()).unwrap_err().to_string()
}

#[test]
fn what_is_no_regular_file_is_refused_before_it_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let error = |path: &Path| read(path).unwrap_err().to_string();
    assert_eq!(error(folder.path()), "it is a directory; allowed: a regular file");
    assert!(error(&folder.path().join("none")).starts_with("cannot be read: No such file"));
    let empty = folder.path().join("empty");
    std::fs::write(&empty, "").unwrap();
    assert!(error(&empty).starts_with("an empty file: none of the formats read here; allowed: Matrix Market,"));
    let pipe = folder.path().join("pipe");
    if std::process::Command::new("mkfifo").arg(&pipe).status().is_ok_and(|status| status.success()) {
        assert_eq!(error(&pipe), "it is no regular file; allowed: a regular file");
    }
}

#[test]
fn other_contents_are_named() {
    for (bytes, part) in [
        (&b"hello\n"[..], "\"hello\": none of the formats"),
        (
            b"\x89HDF\r\n\x1a\n....",
            "HDF5 (MATLAB 7.3) is not read here; save it with save('file.mat', 'K', 'M', '-v7')",
        ),
        (b"MATLAB 7.3 MAT-file, Platform: GLNXA64", "-v7"),
        (b"\0\x01\x02\x03", "a binary file: none"),
        (b"1 2 3 4\n", "\"1 2 3 4\": none"),
        (b"2.1\n2.2\n", "a list of rows"),
        (b"*HEADING\n", "\"*HEADING\": none"),
        (b"\x1f\x8b\x08\x00garbage", "cannot be read"),
        (b"PK\x03\x04garbage", "byte 0: cannot be read"),
        (b"\x93NUMPY\x01\x00\x10\x00{'descr': '<f8'}", "the header of an array"),
        (b"\x93NUMPY\x09\x00\x10\x00{'descr': '<f8'}", "version 1 to 3"),
        (b"1 1 1.0\n1 2 3.0 4.0\n", "line 2: 4 fields where an entry is expected"),
        (b"1 1 1.0\n0 2 3.0\n", "line 2: row 0 is out of range"),
        (b"1 1 1.0\n99999999999 2 3.0\n", "line 2: row 99999999999 is out of range; allowed: 1 to 16777216"),
        (b"1 1 1.0\n99999999999999999999999 2 3.0\n", "is not a whole number"),
        (b"1 1 1.0\n1 1 inf\n", "finite"),
        (b"1,1, 1,1, 1.0\n1,1, 1,x, 1.0\n", "line 2: direction \"x\" is not a whole number"),
        (b"1,1, 1,1, 1.0\n1,1, 1.0\n", "line 2: 3 fields"),
    ] {
        let found = message(bytes);
        assert!(found.contains(part) && !found.contains('\n'), "{found:?} lacks {part:?}");
    }
    let garbage = "x y z 1 2 3 garbage\n".repeat(100_000);
    assert!(message(garbage.as_bytes()).contains("none of the formats"));
    let late = format!("1 1 1.0\n{garbage}");
    assert!(message(late.as_bytes()).starts_with("line 2: 7 fields"));
    let endless = format!("1 1 1.0\n{}", "1".repeat(1_000_000));
    assert_eq!(message(endless.as_bytes()), "line 2: a line of more than 65536 bytes");
}

fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn a_declared_size_costs_nothing_and_limits_hold() {
    // A full array of 2^24 x 2^24 zeros, of which there are none.
    let array = b"%%MatrixMarket matrix array real general\n16777216 16777216\n0.0\n";
    assert!(message(array).ends_with("the file ends after 1 of 281474976710656 entries"), "{}", message(array));
    let coordinate = b"%%MatrixMarket matrix coordinate real general\n16777216 16777216 9999999999999\n1 1 1\n";
    assert!(message(coordinate).ends_with("ends after 1 of 9999999999999 entries"));
    let mut npy =
        b"\x93NUMPY\x01\x00\x46\x00{'descr': '<f8', 'fortran_order': False, 'shape': (9000000, 9000000)}".to_vec();
    npy.extend([b' '; 64]);
    assert!(message(&npy).ends_with("the file ends within an array"), "{}", message(&npy));
    // Ten megabytes of zeros in ten kilobytes, of which a megabyte is allowed.
    let bomb = compressed(
        &[b"%%MatrixMarket matrix array real general\n1000 2000\n".to_vec(), b"0.0\n".repeat(2_000_000)].concat(),
    );
    assert!(bomb.len() < 20_000);
    let with = |limits: Limits| read_bytes(&bomb, None, Options { limits, ..Options::default() });
    assert_eq!(with(Limits::default()).unwrap().only().unwrap().entries().len(), 0);
    let refused = with(Limits { bytes: 1 << 20, ..Limits::default() }).unwrap_err().to_string();
    assert!(refused.ends_with("cannot be read: more than 1048576 bytes of contents"), "{refused}");
    let twice = compressed(&compressed(b"1 1 1.0\n"));
    assert!(message(&twice).contains("compressed twice"));
    let text = b"1 1 1.0\n1 2 1.0\n2 2 1.0\n";
    let few = Limits { entries: 3, ..Limits::default() };
    let refused = read_bytes(text, None, Options { limits: few, ..Options::default() }).unwrap_err().to_string();
    assert_eq!(refused, "line 3: more than 3 entries of a matrix; the limit can be raised");
}

#[test]
fn progress_ends_with_the_size_of_the_file() {
    let path = fixture("abaqus_substructure/symmetric_inner.mtx");
    let size = std::fs::metadata(&path).unwrap().len();
    let mut seen = Vec::new();
    let progress = Box::new(|read, total| seen.push((read, total)));
    formats::read_with(&path, Options { progress: Some(progress), ..Options::default() }).unwrap();
    assert_eq!(seen.last(), Some(&(size, size)));
    assert!(seen.windows(2).all(|pair| pair[0].0 < pair[1].0));
}
