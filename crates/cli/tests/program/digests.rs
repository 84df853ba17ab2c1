//! Digests of what a few small runs say and write, by class of processor: a change that moves code leaves them as they are, one that changes a
//! number shows here that it does. `cargo xtask same` shows which number, on more commands.

use std::collections::BTreeMap;
use std::path::Path;

use squeal::study::fingerprint;

use crate::common::{results, squeal};

/// Commands with a name each; OUT stands for a folder of its own.
const RUNS: [(&str, &str); 8] = [
    ("lattice", "run cases/two-by-two.toml --samples 40 --out OUT"),
    ("matrices", "run cases/hoffmann.toml --samples 100 --keep-samples --out OUT"),
    ("disc", "run cases/wobbling-disc.toml --samples 30 --half-width 0.05 --out OUT"),
    ("sweep", "sweep cases/two-by-two.toml --over mu=0:1.3 --out OUT"),
    ("screen", "screen cases/two-by-two.toml --kinds constraint --up-to 1 --samples 20 --out OUT"),
    ("influence", "influence cases/wobbling-disc.toml --samples 500 --out OUT"),
    ("cea", "cea cases/paper.toml --modes --why --json"),
    ("eig", "eig --mass cases/disk-brake100/M.mtx --stiffness cases/disk-brake100/K1.mtx --json"),
];
/// Variable of the environment with which the digests of this processor are written anew.
const UPDATE: &str = "UPDATE_DIGESTS";

/// Class of processors and libraries on which results are the same bytes: how many numbers are computed at once, with fused products or without, and
/// whose elementary functions are called.
fn class() -> String {
    #[cfg(target_arch = "x86_64")]
    let lanes = match (is_x86_feature_detected!("avx512f"), is_x86_feature_detected!("fma")) {
        (true, _) => "avx512",
        (false, true) => "fma",
        (false, false) => "baseline",
    };
    #[cfg(not(target_arch = "x86_64"))]
    let lanes = "baseline";
    let library = if cfg!(target_env = "gnu") { "gnu" } else { "other" };
    format!("{}-{lanes}-{}-{library}", std::env::consts::ARCH, std::env::consts::OS)
}

fn digest(arguments: &str, out: &Path) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let words = arguments.split(' ').map(|word| if word == "OUT" { out.as_os_str() } else { word.as_ref() });
    let output = squeal().current_dir(root).args(words).output().unwrap();
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    if !out.exists() {
        return fingerprint(&said);
    }
    // Pictures are there as text too, the page names the commit.
    let is_kept = |name: &str| ![".png", ".pdf"].iter().any(|picture| name.ends_with(picture)) && name != "report.html";
    let files = results(out).into_iter().filter(|(name, _)| is_kept(name));
    fingerprint(
        &files.map(|(name, bytes)| format!("{name}\n{}\n", String::from_utf8(bytes).unwrap())).collect::<String>(),
    )
}

#[test]
fn small_runs_have_the_digests_that_they_had() {
    let (folder, class) = (tempfile::tempdir().unwrap(), class());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/digests.txt");
    let text = std::fs::read_to_string(&path).unwrap();
    let known: BTreeMap<String, &str> =
        text.lines().filter_map(|line| line.rsplit_once(' ')).map(|(key, digest)| (key.to_owned(), digest)).collect();
    let of_run =
        |(name, arguments): &(&str, &str)| (format!("{class} {name}"), digest(arguments, &folder.path().join(name)));
    let found: BTreeMap<String, String> = RUNS.iter().map(of_run).collect();
    if std::env::var_os(UPDATE).is_some() {
        let mut all: BTreeMap<String, &str> = known.into_iter().filter(|(key, _)| !key.starts_with(&class)).collect();
        all.extend(found.iter().map(|(key, digest)| (key.clone(), digest.as_str())));
        let lines: String = all.into_iter().map(|(key, digest)| format!("{key} {digest}\n")).collect();
        std::fs::write(&path, lines).unwrap();
        return;
    }
    if !known.keys().any(|key| key.starts_with(&class)) {
        println!("skipped: {} has no digests of {class}; {UPDATE}=1 adds them", path.display());
        return;
    }
    let changed: Vec<&String> =
        found.iter().filter(|(key, digest)| known.get(*key) != Some(&digest.as_str())).map(|(key, _)| key).collect();
    assert!(
        changed.is_empty(),
        "other results than before: {changed:?}; where that is meant, {UPDATE}=1 cargo test -p brake-squeal-cli --test program digests, and say in the \
         commit which numbers changed and why"
    );
}
