//! `squeal eig --box`: the eigenvalues in a rectangle, from files of any format.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;

use crate::common::{refusal, squeal};

/// Masses in a row on springs and dashpots, as Matrix Market files: M, C, K.
fn chain(folder: &Path, masses: usize) -> [PathBuf; 3] {
    let file = |name: &str, diagonal: f64, beside: f64| {
        let mut text =
            format!("%%MatrixMarket matrix coordinate real symmetric\n{masses} {masses} {}\n", 2 * masses - 1);
        for i in 1..=masses {
            writeln!(text, "{i} {i} {diagonal}").unwrap();
            if i > 1 {
                writeln!(text, "{i} {} {beside}", i - 1).unwrap();
            }
        }
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    [file("M.mtx", 1.0, 0.0), file("C.mtx", 0.02, -0.01), file("K.mtx", 2e4, -1e4)]
}

fn eig([mass, damping, stiffness]: &[PathBuf; 3], options: &[&str]) -> Output {
    let mut command = squeal();
    command.arg("eig").arg("--mass").arg(mass).arg("--damping").arg(damping).arg("--stiffness").arg(stiffness);
    command.args(options).output().unwrap()
}

fn json(matrices: &[PathBuf; 3], options: &[&str]) -> Value {
    let output = eig(matrices, &[options, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Real and imaginary parts.
fn lambdas(spectrum: &Value) -> Vec<[f64; 2]> {
    let all = spectrum["eigenvalues"].as_array().unwrap().iter();
    all.map(|e| [&e["re"], &e["im"]].map(|part| part.as_f64().unwrap())).collect()
}

#[test]
fn a_rectangle_holds_what_the_whole_spectrum_has_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let matrices = chain(folder.path(), 60);
    let inside = json(&matrices, &["--box=-1:0,50:150"]);
    let (found, mut expected) = (lambdas(&inside), lambdas(&json(&matrices, &[])));
    expected.retain(|[_, im]| (50.0..=150.0).contains(im));
    assert_eq!(found.len(), expected.len());
    assert!(found.len() > 10);
    for (found, expected) in found.iter().zip(&expected) {
        assert!((0..2).all(|part| (found[part] - expected[part]).abs() < 1e-9), "{found:?} {expected:?}");
    }
    assert_eq!(inside["route"], "certified");
    assert!(
        inside["eigenvalues"].as_array().unwrap().iter().all(|e| e["verdict"] == "stable" && e["on_border"] == false)
    );
    let coverage = &inside["coverage"];
    assert_eq!(coverage["im"], serde_json::json!([50.0, 150.0]));
    assert_eq!(coverage["count"]["by"], "argument-principle");
    assert!(coverage["count"]["circles"][0]["eigenvalues"].as_u64() >= Some(found.len() as u64));
}

#[test]
fn a_large_system_is_searched_and_every_disc_counted() {
    let (folder, masses) = (tempfile::tempdir().unwrap(), 320);
    let found = json(&chain(folder.path(), masses), &["--box=-1:0,50:60"]);
    // Damping that is a millionth of the stiffness.
    let frequency = |j: usize| {
        let k = 4e4 * (std::f64::consts::PI * j as f64 / (2.0 * (masses + 1) as f64)).sin().powi(2);
        (k - (0.5e-6 * k).powi(2)).sqrt()
    };
    let expected: Vec<f64> = (1..=masses).map(frequency).filter(|im| (50.0..60.0).contains(im)).collect();
    let lambdas = lambdas(&found);
    assert!(lambdas.len() == expected.len() && lambdas.len() > 5);
    assert!(lambdas.iter().zip(&expected).all(|([_, im], expected)| (im - expected).abs() < 1e-9 * expected));
    let coverage = &found["coverage"];
    assert_eq!((&found["route"], &coverage["count"]["by"]), (&"sparse".into(), &"argument-principle".into()));
    assert_eq!(coverage["count"]["circles"].as_array().map(Vec::len), coverage["discs"].as_array().map(Vec::len));
    assert!(coverage["discs"][0]["eigenvalues"].as_u64() >= Some(lambdas.len() as u64));
    assert!(coverage["solves"].as_u64().unwrap() > 0);
}

#[test]
fn the_rightmost_come_first_and_vectors_are_added() {
    let folder = tempfile::tempdir().unwrap();
    let matrices = chain(folder.path(), 20);
    let all = lambdas(&json(&matrices, &["--box", "-1:0,0:250"]));
    let few = json(&matrices, &["--box", "-1:0,0:250", "--rightmost", "3", "--vectors"]);
    // Dampers beside springs: the slowest modes are damped least.
    assert_eq!(lambdas(&few), all[..3]);
    assert_eq!(few["eigenvalues"][0]["left"].as_array().unwrap().len(), 20);
    // Counts are of all that is there, however many are listed.
    let text = String::from_utf8(eig(&matrices, &["--box=-1:0,0:250", "--rightmost", "3"]).stdout).unwrap();
    let counted =
        "20 eigenvalues in the rectangle: 0 unstable, 20 stable, 0 marginal, 0 undecided; the 3 rightmost are listed\n";
    assert!(text.contains(counted) && !text.contains("\n   4"), "{text}");
}

#[test]
fn the_table_says_what_covers_the_rectangle_and_marks_its_border() {
    let folder = tempfile::tempdir().unwrap();
    let matrices = chain(folder.path(), 20);
    let first = lambdas(&json(&matrices, &["--box=-1:0,0:250"]))[0];
    let output = eig(&matrices, &[&format!("--box=-1:0,{}:250", first[1])]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains(
            "20 eigenvalues in the rectangle: 0 unstable, 20 stable, 0 marginal, 0 undecided\ncounted again by the argument principle"
        ),
        "{text}"
    );
    assert_eq!(text.matches("stable, on the border\n").count(), 1, "{text}");
    let empty = eig(&matrices, &["--box=1:2,0:250"]);
    assert!(String::from_utf8(empty.stdout).unwrap().contains("\n0 eigenvalues in the rectangle"));
}

#[test]
fn files_of_other_programs_with_names_of_their_rows() {
    let fixture =
        |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("../formats/tests/fixtures/calculix").join(name);
    let mut command = squeal();
    command.arg("eig").arg("--mass").arg(fixture("tiny.mas")).arg("--stiffness").arg(fixture("tiny.sti"));
    let dense = command.args(["--json", "--vectors"]).output().unwrap();
    let dense: Value = serde_json::from_slice(&dense.stdout).unwrap();
    let sparse = command.arg("--box=-1:1,1:100").output().unwrap();
    let sparse: Value = serde_json::from_slice(&sparse.stdout).unwrap();
    assert!(dense["rows"].as_array().is_some_and(|rows| !rows.is_empty()) && dense["rows"] == sparse["rows"]);
    let expected: Vec<_> = lambdas(&dense).into_iter().filter(|[_, im]| (1.0..=100.0).contains(im)).collect();
    let found = lambdas(&sparse);
    assert!(!found.is_empty() && found.len() == expected.len(), "{found:?} {expected:?}");
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found[1] / expected[1] - 1.0).abs() < 1e-8, "{found:?} {expected:?}");
    }
    // A rectangle without end, and a diagonal mass: nothing is searched beyond the spectrum, some 4.7 rad/s.
    let mut command = squeal();
    command.arg("eig").arg("--mass").arg(fixture("tiny.mas")).arg("--stiffness").arg(fixture("tiny.sti"));
    let wide = command.args(["--json", "--box=-1:1,1:1e7"]).output().unwrap();
    let wide: Value = serde_json::from_slice(&wide.stdout).unwrap();
    assert_eq!(lambdas(&wide).len(), expected.len());
    let swapped =
        squeal().arg("eig").arg("--mass").arg(fixture("tiny.sti")).arg("--stiffness").arg(fixture("tiny.mas")).output();
    refusal(&swapped.unwrap(), &["--mass = ", "tiny.sti", "allowed: a mass matrix", "one of stiffness"]);
}

#[test]
fn rectangles_and_options_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let matrices = chain(folder.path(), 3);
    let form = "allowed: RE0:RE1,IM0:IM1 in rad/s";
    for wrong in ["", "1", "1:2", "1:2,3", "1:2,3:4,5:6", "a:2,3:4", "1:2;3:4", "1e13:2e13,0:1"] {
        refusal(&eig(&matrices, &[&format!("--box={wrong}")]), &["--box", form]);
    }
    for (wrong, part) in [
        ("2:1,3:4", "Re lambda from 2 to 1"),
        ("1:2,4:4", "Im lambda from 4 to 4"),
        ("nan:2,3:4", "Re lambda from NaN to 2"),
        ("1:2,3:inf", "Im lambda from 3 to inf"),
    ] {
        refusal(&eig(&matrices, &[&format!("--box={wrong}")]), &["--box", part, form]);
    }
    refusal(&eig(&matrices, &["--rightmost", "3"]), &["--box"]);
    refusal(&eig(&matrices, &["--box=0:1,0:1", "--rightmost", "0"]), &["--rightmost"]);
}

#[test]
fn matrices_that_no_rectangle_can_be_searched_for() {
    let folder = tempfile::tempdir().unwrap();
    let [_, c, k] = chain(folder.path(), 3);
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, format!("%%MatrixMarket matrix coordinate real general\n{text}")).unwrap();
        path
    };
    let options = ["--box=-1:1,0:100"];
    let other = write("other.mtx", "4 4 1\n1 1 1.0\n");
    refusal(&eig(&[k.clone(), c.clone(), other], &options), &["other.mtx", "stiffness", "4 x 4; allowed: 3 x 3"]);
    let zero = write("zero.mtx", "3 3 0\n");
    refusal(&eig(&[zero.clone(), zero.clone(), zero], &options), &["singular", "for every lambda"]);
    let large = write("large.mtx", "1000000 1000000 1\n1 1 1.0\n");
    refusal(&eig(&[large.clone(), c.clone(), k.clone()], &options), &["large.mtx", "1000000 x 1000000", "at most"]);
    let text = folder.path().join("text");
    std::fs::write(&text, "nothing of the kind\n").unwrap();
    refusal(&eig(&[text, c.clone(), k.clone()], &options), &["text: ", "none of the formats read here"]);
    let banner = folder.path().join("banner.mtx");
    std::fs::write(&banner, "%MatrixMarket matrix coordinate real general\n3 3 1\n1 1 1.0\n").unwrap();
    refusal(&eig(&[banner, c.clone(), k.clone()], &options), &["banner.mtx: line 1"]);
    refusal(&eig(&[folder.path().to_owned(), c, k], &options), &["it is a directory"]);
}

/// A search that lists an eigenvalue many times says that copies may stand in the place of others; of two copies it says nothing, nor where all is
/// certified.
#[test]
fn many_copies_of_an_eigenvalue_are_said() {
    let folder = tempfile::tempdir().unwrap();
    for (order, copies, is_said) in [(320, 20, true), (320, 2, false), (120, 20, false)] {
        let banner = format!("%%MatrixMarket matrix coordinate real symmetric\n{order} {order} {order}\n");
        let stiffness = |i: usize| if i <= copies { 1e4 } else { 1e5 + 10.0 * (i * i) as f64 };
        let of = |value: &dyn Fn(usize) -> f64| {
            (1..=order).fold(banner.clone(), |text, i| text + &format!("{i} {i} {}\n", value(i)))
        };
        let paths = [("M.mtx", of(&|_| 1.0)), ("K.mtx", of(&stiffness))].map(|(name, text)| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        });
        let [mass, stiffness] = paths.each_ref().map(|path| path.to_str().unwrap());
        let arguments = ["eig", "--mass", mass, "--stiffness", stiffness, "--box=-1:1,50:150"];
        let output = squeal().args(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        assert_eq!(said.contains("occurs some 20 times"), is_said, "{order} {copies}: {said}");
    }
}
