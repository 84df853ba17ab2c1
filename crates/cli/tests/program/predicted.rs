//! Whether the memory that `squeal check` predicts is what `squeal run` takes, by processes and GNU time: a measurement, ignored by default.

use std::path::Path;
use std::process::{Command, Output};

use super::common::replaced;

/// GNU time, which says the largest resident memory of a process.
const GNU_TIME: &str = "/usr/bin/time";
/// Largest lattice with sets of constraints, whose modes are linked: some minutes.
const MOST_WITH_SETS: usize = 10;
/// Bytes of a megabyte.
const MEGA: f64 = 1e6;

fn squeal_measured(arguments: &[&str]) -> (Output, f64) {
    let output = Command::new(GNU_TIME).args(["-f", "%M"]).arg(env!("CARGO_BIN_EXE_squeal")).args(arguments).output();
    let output = output.unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let kilobytes: f64 = said.lines().last().unwrap().parse().unwrap();
    (output, 1024.0 * kilobytes / MEGA)
}

/// The megabytes that a check predicts.
fn predicted(output: &Output) -> f64 {
    let text = String::from_utf8_lossy(&output.stdout);
    let words = text.lines().find_map(|line| line.trim().strip_prefix("memory")).unwrap().trim();
    match words.trim_start_matches("roughly ").split_once(' ').unwrap() {
        (number, "MB") => number.parse().unwrap(),
        (number, _) => 1000.0 * number.parse::<f64>().unwrap(),
    }
}

/// A lattice of so many rows and columns, with all in contact, and the two sets of constraints of the case or none.
fn lattice(size: usize, is_symmetric: bool, has_sets: bool) -> String {
    let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
    let text = std::fs::read_to_string(base).unwrap();
    let without_sets = || {
        let (first, others) = text.split_once("[[constraints]]").unwrap();
        format!("{first}[[speeds]]{}", others.split_once("[[speeds]]").unwrap().1)
    };
    let text = if has_sets { text.clone() } else { without_sets() };
    let text = replaced(&text, "rows = 2", &format!("rows = {size}"));
    let text = replaced(&text, "columns = 2", &format!("columns = {size}"));
    let text = replaced(&text, "in_contact = [4, 3]", &format!("in_contact = [{}]", size * size));
    let text = replaced(&text, "samples = 200", "samples = 8");
    if is_symmetric {
        return text;
    }
    let masses: Vec<String> = (0..size * size).map(|i| format!("{:.3}", 0.5 + 0.001 * i as f64)).collect();
    replaced(&text, "oscillator_mass = 0.5 ", &format!("oscillator_mass = [{}] ", masses.join(", ")))
}

/// Matrices of some order, of which all is random, and a viscoelastic term of full rank with two branches: three times as many states as without.
fn viscoelastic(order: usize) -> String {
    let mut number = 1_u64;
    let mut random = || {
        number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (number >> 40) as f64 / (1_u64 << 24) as f64 - 0.5
    };
    let mut definite = |scale: f64| {
        let root: Vec<Vec<f64>> = (0..order).map(|_| (0..order).map(|_| random()).collect()).collect();
        let entry = |i: usize, j: usize| {
            let product: f64 = root[i].iter().zip(&root[j]).map(|(a, b)| a * b).sum();
            scale * (product / order as f64 + if i == j { 0.2 } else { 0.0 })
        };
        let rows: Vec<Vec<f64>> = (0..order).map(|i| (0..order).map(|j| entry(i, j)).collect()).collect();
        format!("{rows:?}")
    };
    let diagonal = |value: f64| {
        let row = |i: usize| (0..order).map(|j| if i == j { value } else { 0.0 }).collect::<Vec<f64>>();
        format!("{:?}", (0..order).map(row).collect::<Vec<_>>())
    };
    format!(
        "[study]\nname = \"Shims\"\nsamples = 8\nseed = 1\n[brake]\nkind = \"matrices\"\n\
         [parameters.g]\ndistribution = \"uniform\"\nfrom = 0.2\nto = 0.4\n\
         [[terms]]\nname = \"structure\"\nmass = {}\ndamping = {}\nstiffness = {}\n\
         [[terms]]\nname = \"shim\"\nstiffness = {}\n\
         viscoelastic = [{{ ratio = \"g\", rate = 300.0 }}, {{ ratio = \"g\", rate = 3000.0 }}]\n",
        diagonal(1.0),
        diagonal(5.0),
        definite(1e6),
        definite(3e5)
    )
}

/// The memory that a check of a case predicts over what a run takes, MB.
fn compared(folder: &Path, name: &str, text: String) -> f64 {
    let case = folder.join(format!("{name}.toml"));
    std::fs::write(&case, text).unwrap();
    let (case, out) = (case.to_str().unwrap(), folder.join(name));
    let (checked, of_check) = squeal_measured(&["check", case]);
    let (_, of_run) = squeal_measured(&["run", case, "--out", out.to_str().unwrap()]);
    let predicted = predicted(&checked);
    println!("{name}: {predicted} MB predicted, check {of_check:.0}, run {of_run:.0}");
    of_run / predicted
}

#[test]
#[ignore = "a measurement of some minutes"]
fn the_memory_of_lattices_is_predicted_within_a_factor_of_two() {
    if !Path::new(GNU_TIME).exists() {
        println!("skipped: there is no {GNU_TIME} here");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for size in [2, 4, 6, 8, 10, 12] {
        for (is_symmetric, has_sets) in [(true, false), (false, false), (true, true)] {
            if has_sets && size > MOST_WITH_SETS {
                continue;
            }
            let name = format!("{size}-symmetric-{is_symmetric}-sets-{has_sets}");
            let part = compared(folder.path(), &name, lattice(size, is_symmetric, has_sets));
            assert!((0.5..=2.0).contains(&part), "{name}: {part}");
        }
    }
}

#[test]
#[ignore = "a measurement of a quarter of an hour"]
fn the_memory_of_viscoelastic_terms_is_predicted_within_a_factor_of_two() {
    if !Path::new(GNU_TIME).exists() {
        println!("skipped: there is no {GNU_TIME} here");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for order in [50, 150] {
        let part = compared(folder.path(), &format!("order-{order}"), viscoelastic(order));
        assert!((0.5..=2.0).contains(&part), "{order}: {part}");
    }
}
