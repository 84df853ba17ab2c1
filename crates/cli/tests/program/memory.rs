//! Memory does not grow with the number of samples.

/// The most memory that a run held, kB: what the system wrote down for it until shortly before its end.
#[cfg(target_os = "linux")]
fn peak(samples: u64) -> u64 {
    use crate::common::{SMALL, replaced, squeal};

    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    let text = replaced(SMALL, r#"["amontons-coulomb", "velocity-dependent", "lugre"]"#, r#"["amontons-coulomb"]"#);
    std::fs::write(&case, replaced(&text, "in_contact = [2, 1]", "in_contact = [2]")).unwrap();
    let mut child = squeal()
        .arg("run")
        .arg(&case)
        .arg("--out")
        .arg(folder.path().join("out"))
        .args(["--threads", "1", "--samples", &samples.to_string()])
        .spawn()
        .unwrap();
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        peak = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok()).unwrap_or(peak);
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success());
    peak
}

/// A draw has at least 112 bytes and an outcome 100 more: 24,000 of them, kept, would be 5,000 kB. With 60 samples fewer modes are
/// ever unstable, and the figures smaller, than with 600.
#[cfg(target_os = "linux")]
#[test]
fn peak_memory_is_that_of_few_samples() {
    // What is read just before the end of a short run may be too little on a busy machine, never too much.
    let (few, many) = ((0..3).map(|_| peak(600)).max().unwrap(), peak(24_000));
    println!("{few} kB for 600 samples, {many} kB for 24,000");
    assert!(few > 1_000 && many < few + 3_000, "{few} kB for 600 samples, {many} kB for 24,000");
}
