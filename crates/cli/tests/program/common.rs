//! A small case, the program, and what every refusal must look like.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Two oscillators, three laws, two constraint sets: a few milliseconds per sample.
pub const SMALL: &str = r#"
[study]
name = "two oscillators"
laws = ["amontons-coulomb", "velocity-dependent", "lugre"]
samples = 40
seed = 7

[lattice]
rows = 1
columns = 2
oscillator_mass = 0.39
x_stiffness = { wall = 2.45e7, inner = 1.05e7 }
y_stiffness = 3.05e7
x_damping = 18.0
y_damping = 18.0
z_damping = 18.0
inclined_stiffness = 3.10e7
theta = 60.0
phi = 60.0
contact_stiffness = 3.47e7

[lattice.plate]
mass = 9.05
stiffness = [4.87e8, 4.87e8, 4.25e8]
damping = [155.0, 155.0, 155.0]

[contact]
in_contact = [2, 1]

[[constraints]]
name = "none"
fixed = []

[[constraints]]
name = "first"
fixed = ["x1"]

[[speeds]]
name = "low"
from = 0.1
to = 1.0

[[speeds]]
name = "high"
from = 1.0
to = 10.0

[readings]
lean = "against"
lateral = "coupled"
draws = "shared"
labels = "tracked"
preload = { per_contact = 600.0 }
bristle_damping = "constant"

[friction]
mu = { distribution = "normal", mean = 0.60, deviation = 0.2, at_least = 0.02 }
mu_s = { distribution = "normal", mean = 0.65, deviation = 0.06, at_least = 0.02 }
mu_k = { distribution = "normal", mean = 0.55, deviation = 0.06, at_least = 0.02 }
alpha = { distribution = "log-normal", median = 1.5, sigma = 0.25 }
v_s = { distribution = "log-normal", median = 0.6, sigma = 0.25 }
sigma0 = { distribution = "log-normal", median = 1e5, sigma = 0.2 }
sigma1 = { distribution = "log-normal", median = 10.0, sigma = 0.2 }
sigma2 = { distribution = "constant", value = 0.0 }
"#;

/// `text` with one part replaced, which must be there.
pub fn replaced(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "the case has no {from:?}");
    text.replacen(from, to, 1)
}

/// The program, not yet started.
pub fn squeal() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_squeal"));
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Hoffmann's oscillator on a belt.
pub fn hoffmann() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/hoffmann.toml")
}

/// What a command says of a case.
pub fn asked(command: &str, case: &Path, options: &[&str]) -> Output {
    squeal().arg(command).arg(case).args(options).output().unwrap()
}

/// What a command answers that succeeds without a note.
pub fn answer(command: &str, case: &Path, options: &[&str]) -> String {
    let output = asked(command, case, options);
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Runs the study of `case` in `dir` to its end.
pub fn run(case: &Path, dir: &Path, options: &[&str]) -> String {
    let output = squeal().arg("run").arg(case).arg("--out").arg(dir).args(options).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{stderr}");
    String::from_utf8(output.stdout).unwrap()
}

/// The one line of a refusal: exit code 2, nothing on standard output, and every word of `expected` in the line.
pub fn refusal(output: &Output, expected: &[&str]) -> String {
    let stderr = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(output.stdout.is_empty(), "standard output of a refusal");
    assert_eq!(stderr.lines().count(), 1, "one line: {stderr}");
    assert!(stderr.starts_with("error: ") && stderr.ends_with('\n'), "{stderr}");
    for part in expected {
        assert!(stderr.contains(part), "{part:?} is missing from: {stderr}");
    }
    stderr
}

/// Every file of a folder by name, without what differs between two runs by right: the manifest has the times, the lock the
/// process.
pub fn results(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(dir).unwrap().map(|entry| entry.unwrap());
    let named = files.map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap()));
    let kept: BTreeMap<_, _> = named.filter(|(name, _)| name != "manifest.json" && name != "run.lock").collect();
    assert!(!kept.keys().any(|name| name.ends_with(".partial")), "half-written: {:?}", kept.keys());
    kept
}

/// The columns and the rows of a table.
pub fn csv_of(bytes: &[u8]) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_reader(bytes);
    let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
    let header = cells(reader.headers().unwrap());
    (header, reader.records().map(|record| cells(&record.unwrap())).collect())
}

/// Asserts that two folders hold the same files with the same bytes.
pub fn assert_same(a: &BTreeMap<String, Vec<u8>>, b: &BTreeMap<String, Vec<u8>>) {
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (name, bytes) in a {
        assert!(*bytes == b[name], "{name} differs");
    }
}
