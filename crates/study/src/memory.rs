//! Memory that a computation may take: the budget given, or what the machine has.

use std::path::Path;

use output::bytes_in_words;

use crate::Error;

/// Memory assumed where nothing tells what the machine has (other systems than Linux), bytes; chosen: that of a small machine.
const FALLBACK: u64 = 4_000_000_000;

/// Size of memory in bytes, from the text of an option.
///
/// # Errors
/// The values allowed, in words.
pub fn size(text: &str) -> Result<u64, String> {
    let allowed = || "allowed: a number of bytes > 0, or of k, M, G or T of them, as 512M or 8G".to_owned();
    let number = text.trim_end_matches(['k', 'K', 'M', 'G', 'T']);
    let unit = match &text[number.len()..] {
        "" => 1.0,
        "k" | "K" => 1e3,
        "M" => 1e6,
        "G" => 1e9,
        "T" => 1e12,
        _ => return Err(allowed()),
    };
    let bytes = number.parse::<f64>().map_err(|_| allowed())? * unit;
    // Beyond 1e18 bytes a number is a slip.
    if (1.0..=1e18).contains(&bytes) { Ok(bytes as u64) } else { Err(allowed()) }
}

/// Memory left on this machine, bytes: on Linux the least of what `/proc/meminfo` calls available and the limits of the control groups of
/// this process; elsewhere 4 GB.
#[must_use]
pub fn of_machine() -> u64 {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let groups = read("/proc/self/cgroup");
    let limits = groups.lines().flat_map(limit_files).filter_map(|path| read(&path).trim().parse().ok());
    available(&read("/proc/meminfo")).into_iter().chain(limits).min().unwrap_or(FALLBACK)
}

/// Memory available by `MemAvailable` of `/proc/meminfo`, bytes.
fn available(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    Some(1024 * line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
}

/// Files with the limits of a line of `/proc/self/cgroup`, of the group and of those above it: `memory.max` of version 2, which says
/// "max" for none, or `memory.limit_in_bytes` of version 1.
fn limit_files(line: &str) -> Vec<String> {
    let mut parts = line.splitn(3, ':').skip(1);
    let (folder, file) = match parts.next() {
        Some("") => ("/sys/fs/cgroup", "memory.max"),
        Some(controllers) if controllers.split(',').any(|name| name == "memory") => {
            ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
        }
        _ => return Vec::new(),
    };
    let group = Path::new(parts.next().unwrap_or("/"));
    group
        .ancestors()
        .map(|group| format!("{folder}{}/{file}", group.display().to_string().trim_end_matches('/')))
        .collect()
}

/// Refuses a computation that takes more than `budget` bytes of memory; `fits` gives, in words, a smaller one that would not.
///
/// # Errors
/// [`Error::TooLarge`].
pub fn check(what: &str, bytes: f64, budget: u64, fits: impl FnOnce() -> String) -> Result<(), Error> {
    if bytes <= budget as f64 {
        return Ok(());
    }
    Err(Error::TooLarge {
        what: what.to_owned(),
        needed: bytes_in_words(bytes),
        budget: match budget as f64 / 1e6 {
            megabytes if megabytes < 10.0 => format!("{megabytes:.1} MB"),
            _ => bytes_in_words(budget as f64),
        },
        fits: fits(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_with_their_units_or_refused() {
        let read = ["1", "1500k", "512M", "8G", "1.5T"].map(size);
        assert_eq!(read, [1, 1_500_000, 512_000_000, 8_000_000_000, 1_500_000_000_000].map(Ok));
        for wrong in ["", "G", "0", "-1G", "8GG", "8 G", "8Gb", "nan", "inf", "1e300", "0.1"] {
            assert!(size(wrong).unwrap_err().starts_with("allowed: "), "{wrong}");
        }
    }

    #[test]
    fn what_is_available_is_read_from_the_system() {
        let meminfo = "MemTotal:       24683520 kB\nMemFree:         1024 kB\nMemAvailable:    2048 kB\n";
        assert_eq!((available(meminfo), available("MemTotal: 5 kB\n")), (Some(2_097_152), None));
        assert_eq!(
            limit_files("0::/user/one"),
            ["/user/one", "/user", ""].map(|group| format!("/sys/fs/cgroup{group}/memory.max"))
        );
        assert_eq!(limit_files("4:cpu,memory:/"), ["/sys/fs/cgroup/memory/memory.limit_in_bytes"]);
        assert!(limit_files("5:cpu:/").is_empty() && limit_files("").is_empty());
        assert!(of_machine() > 0);
    }
}
