//! Memory does not grow with the number of samples.

/// The most memory that a run held, kB: what the system wrote down for it when its results were written. Its last words wait in a pipe that is full, so that it
/// is still there to be asked.
#[cfg(target_os = "linux")]
fn peak(samples: u64) -> u64 {
    use std::io::{Read, Write};

    use crate::common::{hoffmann, squeal};

    let folder = tempfile::tempdir().unwrap();
    let results = folder.path().join("out");
    let (mut words, mut full) = std::io::pipe().unwrap();
    let mut child = squeal()
        .arg("run")
        .arg(hoffmann())
        .arg("--out")
        .arg(&results)
        .args(["--threads", "1", "--samples", &samples.to_string()])
        .stdout(full.try_clone().unwrap())
        .spawn()
        .unwrap();
    // More than a pipe holds: it waits until it is read.
    let filling = std::thread::spawn(move || full.write_all(&[b' '; 1 << 20]));
    while !results.join("manifest.json").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended without results");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    let peak = line.trim().trim_end_matches(" kB").parse().unwrap();
    words.read_to_end(&mut Vec::new()).unwrap();
    filling.join().unwrap().unwrap();
    assert!(child.wait().unwrap().success());
    peak
}

/// A draw has at least 48 bytes, with those that its place in memory takes, and an outcome 100 more: 120,000 of them, kept, would be 17,000 kB. By some thousand two runs of the
/// same study differ, with the pages of the program that the machine has at hand. With 60 samples fewer modes are ever unstable, and the figures smaller, than with 600.
#[cfg(target_os = "linux")]
#[test]
fn peak_memory_is_that_of_few_samples() {
    let [few, many] = [600, 120_000].map(peak);
    println!("{few} kB for 600 samples, {many} kB for 120,000");
    assert!(few > 1_000 && many < few + 12_000, "{few} kB for 600 samples, {many} kB for 120,000");
}
