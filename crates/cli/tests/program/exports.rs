//! What exports of other programs leave open or hide: triangles, held rows, several matrices in a file, rows without entries.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;

use crate::common::{refusal, squeal};

/// A generator of reproducible numbers: xorshift64 (Marsaglia, J. Stat. Softw. 8(14), 2003).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

type Entries = Vec<(usize, usize, f64)>;

/// As Abaqus writes a matrix: three directions a node.
fn abaqus(entries: &Entries) -> String {
    let dof = |at: usize| format!("{}, {}", 101 + at / 3, at % 3 + 1);
    entries.iter().map(|(i, j, value)| format!("{}, {}, {value:e}\n", dof(*i), dof(*j))).collect()
}

fn market(order: usize, entries: &Entries) -> String {
    let mut text = format!("%%MatrixMarket matrix coordinate real general\n{order} {order} {}\n", entries.len());
    for (i, j, value) in entries {
        writeln!(text, "{} {} {value:e}", i + 1, j + 1).unwrap();
    }
    text
}

fn written(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn eig(m: &Path, c: Option<&Path>, k: &Path, options: &[&str]) -> Output {
    let mut command = squeal();
    command.arg("eig").arg("--mass").arg(m).arg("--stiffness").arg(k).args(options);
    if let Some(c) = c {
        command.arg("--damping").arg(c);
    }
    command.output().unwrap()
}

fn json(m: &Path, c: Option<&Path>, k: &Path, options: &[&str]) -> Value {
    let output = eig(m, c, k, &[options, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Frequencies above the real axis, growing, rad/s.
fn frequencies(spectrum: &Value) -> Vec<f64> {
    let all = spectrum["eigenvalues"].as_array().unwrap().iter();
    let mut found: Vec<f64> = all.filter_map(|e| e["im"].as_f64()).filter(|im| *im > 1e-3).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// A chain of masses between two walls, friction in its first spring.
fn chain(random: &mut Random, order: usize) -> (Entries, Entries) {
    let springs: Vec<f64> = (0..=order).map(|_| 1e5 * (1.0 + random.unit())).collect();
    let (mut m, mut k) = (Vec::new(), Vec::new());
    for i in 0..order {
        m.push((i, i, 0.5 + random.unit()));
        k.push((i, i, springs[i] + springs[i + 1]));
        if i > 0 {
            let friction = if i == 1 { 0.3 * springs[i] } else { 0.0 };
            k.push((i, i - 1, -springs[i]));
            k.push((i - 1, i, -springs[i] + friction));
        }
    }
    (m, k)
}

#[test]
fn degrees_of_freedom_held_by_huge_entries_are_taken_out() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(0x1e36_1e36);
    for penalty in [1e15, 1e17, 1e20, 1e30, 1e36] {
        // The stiff springs are at random places, coupled to the rest as the elements couple them, with masses.
        let order = 9 + (random.unit() * 6.0) as usize;
        let (m, k) = chain(&mut random, order);
        let held: Vec<usize> = (0..order).filter(|_| random.unit() < 0.25).collect();
        let held = if held.is_empty() { vec![order / 2] } else { held };
        let stiff: Entries =
            k.iter().map(|&(i, j, v)| (i, j, if i == j && held.contains(&i) { v + penalty } else { v })).collect();
        let free: Vec<usize> = (0..order).filter(|at| !held.contains(at)).collect();
        let place = |at: usize| free.iter().position(|&other| other == at);
        let without = |all: &Entries| -> Entries {
            all.iter().filter_map(|&(i, j, v)| Some((place(i)?, place(j)?, v))).collect()
        };
        let file = |name: &str, text: String| written(folder.path(), name, &text);
        let reference = json(
            &file("m.mtx", market(free.len(), &without(&m))),
            None,
            &file("k.mtx", market(free.len(), &without(&k))),
            &[],
        );
        let expected = frequencies(&reference);
        for (mass, stiffness) in [
            (file("J_MASS1.mtx", abaqus(&m)), file("J_STIF1.mtx", abaqus(&stiff))),
            // Held rows without a mass, as Abaqus leaves them.
            (
                file("J0_MASS1.mtx", abaqus(&m.iter().filter(|e| !held.contains(&e.0)).copied().collect())),
                file("J_STIF1.mtx", abaqus(&stiff)),
            ),
            (file("M.mtx", market(order, &m)), file("K.mtx", market(order, &stiff))),
        ] {
            for options in [&[][..], &["--box=-2000:2000,0.5:2000"]] {
                let found = json(&mass, None, &stiffness, options);
                assert_eq!(
                    found["held"].as_array().unwrap().len(),
                    held.len(),
                    "{penalty:e} {held:?} {:?}",
                    found["held"]
                );
                let found = frequencies(&found);
                assert_eq!(found.len(), expected.len(), "{penalty:e} {options:?}");
                for (found, expected) in found.iter().zip(&expected) {
                    assert!((found - expected).abs() <= 1e-9 * expected, "{penalty:e} {found} {expected}");
                }
            }
        }
        let output = eig(&folder.path().join("J_MASS1.mtx"), None, &folder.path().join("J_STIF1.mtx"), &[]);
        let (out, err) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
        let named = format!("{}.{}", 101 + held[0] / 3, ["x", "y", "z"][held[0] % 3]);
        for text in [out, err] {
            assert!(text.contains(&format!("taken out: {} ({named}", held.len())), "{text}");
        }
    }
}

#[test]
fn stiff_entries_that_hold_nothing_stay() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, entries: Entries, order: usize| written(folder.path(), name, &market(order, &entries));
    let unit = |order: usize| (0..order).map(|at| (at, at, 1.0)).collect::<Entries>();
    // Modal stiffnesses beside a rigid motion, a stiff spring, rounding on a diagonal, and one in small units.
    for diagonal in [vec![1e-9, 1e5, 1e7, 1e9], vec![1e5, 2e5, 1e12], vec![1e-30, 4.0, 9.0], vec![1e-13, 1.0, 1e3]] {
        let order = diagonal.len();
        let k = diagonal.iter().enumerate().map(|(at, value)| (at, at, *value)).collect();
        let found = json(&file("M.mtx", unit(order), order), None, &file("K.mtx", k, order), &[]);
        assert_eq!(
            (found["eigenvalues"].as_array().unwrap().len(), found["held"].as_array().unwrap().len()),
            (2 * order, 0)
        );
    }
    // A stiff spring between two degrees of freedom holds neither.
    let tie = vec![(0, 0, 1e20), (0, 1, -1e20), (1, 0, -1e20), (1, 1, 1e20), (2, 2, 5e4)];
    let (m, k) = (file("M.mtx", unit(3), 3), file("K.mtx", tie, 3));
    for options in [&[][..], &["--box=-2000:2000,0:2000"]] {
        refusal(
            &eig(&m, None, &k, options),
            &["--stiffness", "K.mtx", "row 1 has an entry of 1.0e20 off the diagonal", "allowed: "],
        );
    }
}

#[test]
fn one_sided_damping_is_asked_about_and_taken_as_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(42);
    let (m, k) = chain(&mut random, 6);
    let (m, k) =
        (written(folder.path(), "J_MASS1.mtx", &abaqus(&m)), written(folder.path(), "J_STIF1.mtx", &abaqus(&k)));
    let one_sided =
        vec![(0, 0, 30.0), (1, 1, 30.0), (2, 2, 30.0), (0, 2, 400.0), (1, 3, -250.0), (4, 4, 30.0), (4, 5, 90.0)];
    let list = written(folder.path(), "J_DMPV1.mtx", &abaqus(&one_sided));
    refusal(
        &eig(&m, Some(&list), &k, &[]),
        &["--damping", "J_DMPV1.mtx", "--symmetry damping=whole", "damping=upper", "allowed: "],
    );
    let mirrored: Entries =
        one_sided.iter().copied().chain(one_sided.iter().filter(|e| e.0 != e.1).map(|e| (e.1, e.0, e.2))).collect();
    for (said, meant) in [("whole", &one_sided), ("upper", &mirrored)] {
        let reference = written(folder.path(), "C.mtx", &market(6, meant));
        // The rows of a file without names go by their order.
        let reference = json(&m, Some(&reference), &k, &[]);
        for option in [format!("--symmetry=damping={said}"), format!("--symmetry=mass=whole,damping={said}")] {
            let found = json(&m, Some(&list), &k, &[&option]);
            assert_eq!(found["eigenvalues"], reference["eigenvalues"], "{option}");
            let taken = found["files"][1]["taken"].as_str().unwrap();
            assert!(
                taken.ends_with("as asked")
                    && taken.starts_with(if said == "whole" { "whole" } else { "one triangle" }),
                "{taken}"
            );
        }
    }
    let whole = json(&m, Some(&list), &k, &["--symmetry", "whole"]);
    assert_eq!(whole["eigenvalues"], json(&m, Some(&list), &k, &["--symmetry", "damping=whole"])["eigenvalues"]);
    let whole = json(&m, Some(&list), &k, &["--symmetry", "damping=whole"]);
    assert_eq!(whole["files"][2]["taken"], "whole, as it has entries on both sides of the diagonal");
    assert_eq!(whole["files"][0]["taken"], "whole, as it has no entry off the diagonal");
    refusal(
        &eig(&m, Some(&list), &k, &["--symmetry", "damping=lower"]),
        &["J_DMPV1.mtx", "with entries above the diagonal"],
    );
    // What is said of all is not said against entries on both sides.
    refusal(&eig(&m, Some(&list), &k, &["--symmetry", "upper"]), &["J_STIF1.mtx", "with entries below the diagonal"]);
    refusal(
        &eig(&m, Some(&list), &k, &["--symmetry", "symmetric"]),
        &["--symmetry", "symmetric", "allowed: whole, upper, lower or triangle"],
    );
}

#[test]
fn a_matrix_of_several_is_found_by_a_usual_name_or_by_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let input = |names: [&str; 3]| {
        let one = |name: &str, value: f64| format!("*MATRIX INPUT, NAME={name}, TYPE=SYMMETRIC\n1,1, 1,1, {value}\n");
        one(names[0], 2.0) + &one(names[1], 0.25) + &one(names[2], 800.0)
    };
    let frequency = |spectrum: &Value| frequencies(spectrum)[0];
    let expected = (400.0_f64 - 0.0625 * 0.0625).sqrt();
    for (at, names) in [
        ["M", "C", "K"],
        ["m", "d", "k"],
        ["MGG", "BGG", "KGG"],
        ["MLL", "BLL", "KLL"],
        ["MXX", "BXX", "KJJZ"],
        ["mass", "damping", "stiffness"],
        ["M_red", "C_red", "K_red"],
        ["M1", "C1", "K1"],
    ]
    .into_iter()
    .enumerate()
    {
        let path = written(folder.path(), &format!("{at}.mtx"), &input(names));
        let found = json(&path, Some(&path), &path, &[]);
        assert!((frequency(&found) - expected).abs() < 1e-9, "{names:?}");
        assert_eq!([0, 1, 2].map(|at| found["files"][at]["name"].as_str().unwrap().to_owned()), names);
    }
    // Names that say nothing, or the same thing twice.
    for names in [["A", "B1x", "X"], ["MGG", "BGG", "X"], ["MGG", "KAA", "KGG"]] {
        let path = written(folder.path(), "odd.mtx", &input(names));
        let allowed = format!("allowed: {}", names.join(", "));
        refusal(&eig(&path, Some(&path), &path, &[]), &["odd.mtx", "no matrix", &allowed]);
        let named = |name: &str| PathBuf::from(format!("{}:{name}", path.display()));
        let found = json(&named(names[0]), Some(&named(&names[1].to_lowercase())), &named(names[2]), &[]);
        assert!((frequency(&found) - expected).abs() < 1e-9, "{names:?}");
        refusal(&eig(&named("Z"), None, &path, &[]), &["odd.mtx:Z", "no matrix \"Z\"", &allowed]);
    }
    // A colon in the name of a file, as in `C:brake.mtx`.
    let drive = written(folder.path(), "C:one.mtx", &input(["M", "C", "K"]));
    assert!((frequency(&json(&drive, Some(&drive), &drive, &[])) - expected).abs() < 1e-9);
    let member = PathBuf::from(format!("{}:K", drive.display()));
    assert!((frequency(&json(&drive, Some(&drive), &member, &[])) - expected).abs() < 1e-9);
    // Structural damping is no viscous damping.
    let structural = written(folder.path(), "J_DMPS1.mtx", "1,1, 1,1, 2.0\n");
    refusal(
        &eig(&drive, Some(&structural), &drive, &[]),
        &["J_DMPS1.mtx: no matrix \"damping\"", "structural damping"],
    );
    // The wrong one of a file that calls its matrix something else.
    let mass = written(folder.path(), "one.mtx", "*MATRIX INPUT, NAME=M, TYPE=SYMMETRIC\n1,1, 1,1, 2.0\n");
    refusal(
        &eig(&mass, None, &mass, &[]),
        &[
            "one.mtx: no matrix \"stiffness\" was read (the only one is \"M\", by its name another kind; FILE:M takes it",
            "allowed: M",
        ],
    );
    json(&mass, None, &PathBuf::from(format!("{}:M", mass.display())), &[]);
}

#[test]
fn a_list_is_as_large_as_the_matrix_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let mass = written(folder.path(), "Z_MASS1.mtx", "1 1 1.0\n2 2 1.0\n");
    let stiffness =
        written(folder.path(), "C_STIF1.mtx", "1 1 400\n2 2 900\n3 3 100\n1 3 -10\n3 1 -10\n2 3 5\n3 2 5\n");
    let found = json(&mass, None, &stiffness, &[]);
    // The last row follows the others: K is condensed on them.
    let (a, b, c) = (400.0 - 1.0, 900.0 - 0.25, 0.5_f64);
    let root = ((a - b) * (a - b) / 4.0 + c * c).sqrt();
    let expected = [((a + b) / 2.0 - root).sqrt(), ((a + b) / 2.0 + root).sqrt()];
    let found = frequencies(&found);
    assert!(
        found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-10),
        "{found:?} {expected:?}"
    );
    // A file with a size of its own is not made larger; the odd one of three is blamed.
    let small = written(folder.path(), "M.mtx", &market(2, &vec![(0, 0, 1.0), (1, 1, 1.0)]));
    let three = written(folder.path(), "C.mtx", &market(3, &vec![(2, 2, 1.0)]));
    refusal(
        &eig(&small, Some(&three), &stiffness, &[]),
        &["M.mtx: the mass matrix is 2 x 2; allowed: 3 x 3, like the damping matrix"],
    );
    // Internal nodes have negative numbers; the mass knows none of them here.
    let internal =
        written(folder.path(), "N_STIF1.mtx", "-1 -1 100\n1 1 400\n2 2 900\n1 -1 -10\n-1 1 -10\n2 -1 5\n-1 2 5\n");
    let found = frequencies(&json(&mass, None, &internal, &[]));
    assert!(
        found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-10),
        "{found:?} {expected:?}"
    );
}

/// A case of finite elements with one term of these files and more lines of it.
fn case(folder: &Path, kind: &str, term: &str, rest: &str) -> PathBuf {
    let text = format!(
        "[study]\nname = \"exports\"\nsamples = 2\nseed = 1\n[brake]\nkind = \"{kind}\"\n[[terms]]\nname = \"all\"\n{term}\n{rest}"
    );
    written(folder, "case.toml", &text)
}

const REDUCTION: &str = "[reduction]\nfrequencies = [1.0, 1000.0]\ngrowth = [-900.0, 900.0]\n";

fn cea(case: &Path) -> Output {
    squeal().arg("cea").arg(case).arg("--json").output().unwrap()
}

fn modes(case: &Path) -> Vec<f64> {
    let output = cea(case);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let scene: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut found: Vec<f64> =
        scene["modes"].as_array().unwrap().iter().map(|mode| mode["im"].as_f64().unwrap()).collect();
    found.sort_by(f64::total_cmp);
    found
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance * b), "{found:?} {expected:?}");
}

#[test]
fn cases_take_out_or_refuse_what_is_held() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(0xca5e);
    let (m, k) = chain(&mut random, 9);
    let held = [3, 7];
    let mut stiff = k.clone();
    stiff.iter_mut().filter(|(i, j, _)| i == j && held.contains(i)).for_each(|entry| entry.2 = 1e36);
    let free = |all: &Entries| -> Entries {
        let place = |at: usize| (!held.contains(&at)).then(|| at - held.iter().filter(|held| **held < at).count());
        all.iter().filter_map(|&(i, j, v)| Some((place(i)?, place(j)?, v))).collect()
    };
    let (small_m, small_k) = (
        written(folder.path(), "m.mtx", &market(7, &free(&m))),
        written(folder.path(), "k.mtx", &market(7, &free(&k))),
    );
    let expected = frequencies(&json(&small_m, None, &small_k, &[]));
    // The huge entries are in the stiffness of the structure, or in a term of their own.
    written(folder.path(), "J_MASS1.mtx", &abaqus(&m));
    written(folder.path(), "J_STIF1.mtx", &abaqus(&stiff));
    written(folder.path(), "S_STIF1.mtx", &abaqus(&k));
    written(folder.path(), "P.mtx", &abaqus(&held.iter().map(|&at| (at, at, 1e20)).collect()));
    let files = "mass = \"J_MASS1.mtx\"\nstiffness = \"J_STIF1.mtx\"";
    let apart =
        "mass = \"J_MASS1.mtx\"\nstiffness = \"S_STIF1.mtx\"\n[[terms]]\nname = \"walls\"\nstiffness = \"P.mtx\"";
    for term in [files, apart] {
        let case = case(folder.path(), "finite-elements", term, REDUCTION);
        assert_close(&modes(&case), &expected, 1e-8);
        let said = String::from_utf8(cea(&case).stderr).unwrap();
        assert!(
            said.contains("case.toml: degrees of freedom held") && said.contains("taken out: 2 (102.x, 103.y)"),
            "{said}"
        );
    }
    let rows = |all: &Entries| {
        let mut rows = vec![vec![0.0; 9]; 9];
        all.iter().for_each(|&(i, j, v)| rows[i][j] = v);
        format!("{rows:?}")
    };
    let given = format!("mass = {}\nstiffness = {}", rows(&m), rows(&stiff).replace("e36", ".0e36"));
    let refused = cea(&case(folder.path(), "matrices", &given, ""));
    refusal(
        &refused,
        &[
            "case.toml: terms = 4, 8 held by huge entries on the diagonal",
            "allowed: held degrees of freedom among those fixed",
        ],
    );
    let fixed = "[[constraints]]\nname = \"held\"\nfixed = [\"4\", \"8\"]\n";
    assert_close(&modes(&case(folder.path(), "matrices", &given, fixed)), &expected, 1e-8);
}

#[test]
fn cases_say_how_a_one_sided_file_is_stored() {
    let folder = tempfile::tempdir().unwrap();
    let (m, k) = chain(&mut Random(9), 6);
    written(folder.path(), "J_MASS1.mtx", &abaqus(&m));
    written(folder.path(), "J_STIF1.mtx", &abaqus(&k));
    let one_sided =
        vec![(0, 0, 3.0), (1, 1, 3.0), (2, 2, 3.0), (0, 2, 40.0), (1, 3, -25.0), (3, 3, 3.0), (4, 4, 3.0), (5, 5, 3.0)];
    let list = written(folder.path(), "C.mtx", &abaqus(&one_sided));
    let unnamed = written(folder.path(), "unnamed.mtx", &market(6, &one_sided));
    let path = |name: &str| folder.path().join(name);
    let term = |file: &str, more: &str| {
        let files = format!("mass = \"J_MASS1.mtx\"\ndamping = \"{file}\"\nstiffness = \"J_STIF1.mtx\"\n{more}");
        case(folder.path(), "finite-elements", &files, REDUCTION)
    };
    let refused = cea(&term("C.mtx", ""));
    refusal(
        &refused,
        &[
            "case.toml: terms \"all\".damping = \"C.mtx\"",
            "above the diagonal only",
            "allowed: symmetry = \"whole\" to",
            "symmetry = \"upper\" to",
        ],
    );
    for said in ["whole", "upper"] {
        let spectrum =
            json(&path("J_MASS1.mtx"), Some(&list), &path("J_STIF1.mtx"), &[&format!("--symmetry=damping={said}")]);
        let expected = frequencies(&spectrum);
        assert_close(&modes(&term("C.mtx", &format!("symmetry = {{ damping = \"{said}\" }}"))), &expected, 1e-8);
        if said == "whole" {
            assert_close(&modes(&term("C.mtx", "symmetry = \"whole\"")), &expected, 1e-8);
            // A matrix without names of its rows goes by those of the others; the word of its file counts, with a line about it.
            let case = term("unnamed.mtx", "");
            assert_close(&modes(&case), &expected, 1e-8);
            let line = String::from_utf8(cea(&case).stderr).unwrap();
            assert!(
                line.contains("terms \"all\".damping = \"unnamed.mtx\": it is taken as whole, as the file says"),
                "{line}"
            );
            assert!(eig(&path("J_MASS1.mtx"), Some(&unnamed), &path("J_STIF1.mtx"), &[]).stderr.len() > 50);
        }
    }
    refusal(
        &cea(&term("C.mtx", "symmetry = \"upper\"")),
        &["stiffness = \"J_STIF1.mtx\"", "with entries below the diagonal"],
    );
    refusal(
        &cea(&term("C.mtx", "symmetry = \"full\"")),
        &["symmetry", "expected \"whole\", \"upper\", \"lower\" or \"triangle\""],
    );
    // Names of rows that differ leave a matrix without names nowhere to go.
    written(folder.path(), "J_MASS1.mtx", &abaqus(&m[..5].to_vec()));
    refusal(
        &cea(&term("unnamed.mtx", "symmetry = { damping = \"whole\" }")),
        &["terms \"all\".damping = a matrix without names of its rows", "allowed: "],
    );
}

/// Rings of masses with a few dashpots or gyroscopic couplings, of which nothing is drawn, and a band in the middle of their spectrum: parts of complex modes are directions of
/// a basis that are like modes below and above the band, and could be one in it. A list of a reduced brake is that of the whole one, or said to be none, and then
/// the exit code is 1; that of the whole brake is always one.
#[test]
fn a_reduced_brake_has_no_modes_that_the_whole_one_does_not_have() {
    let folder = tempfile::tempdir().unwrap();
    let (order, mut random, mut open, mut open_drawn) = (90, Random(0x5eed_5eed), 0, 0);
    for system in 0..12 {
        let (mut m, mut c, mut k) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..order {
            let (next, spring) = ((i + 1) % order, 1e5 * (1.0 + 0.02 * random.unit()));
            m.push((i, i, 1.0 + 0.02 * random.unit()));
            c.push((i, i, 5.0));
            k.extend([(i, i, spring + 3e3), (next, next, spring), (i, next, -spring), (next, i, -spring)]);
        }
        for _ in 0..3 {
            let (at, size) = ((random.unit() * 88.0) as usize, 10f64.powf(3.0 * random.unit() - 1.0));
            match system % 2 {
                0 => c.push((at, at, size)),
                _ => c.extend([(at, at + 1, size), (at + 1, at, -size), (at, at, 0.01 * size)]),
            }
        }
        let place = |name: &str, text: &str| written(folder.path(), name, text);
        let dense = [&m, &c, &k].map(|entries| market(order, entries));
        let [dm, dc, dk] = ["m.mtx", "c.mtx", "k.mtx"]
            .iter()
            .zip(&dense)
            .map(|(name, text)| place(name, text))
            .collect::<Vec<_>>()
            .try_into()
            .unwrap();
        let all = frequencies(&json(&dm, Some(&dc), &dk, &[]));
        let is_apart = |at: &usize| all[*at] > 1.01 * all[at - 1];
        let (low, high) = ((20..30).find(is_apart).unwrap(), (34..60).find(is_apart).unwrap());
        let between = |at: usize| 0.5 * (all[at] + all[at - 1]) / std::f64::consts::TAU;
        for (name, entries) in [("J_MASS1.mtx", &m), ("J_DAMP1.mtx", &c), ("J_STIF1.mtx", &k)] {
            place(name, &abaqus(entries));
        }
        let files =
            "mass = \"J_MASS1.mtx\"\ndamping = \"J_DAMP1.mtx\"\nstiffness = \"J_STIF1.mtx\"\nsymmetry = \"whole\"";
        let band =
            format!("[reduction]\nfrequencies = [{:?}, {:?}]\ngrowth = [-500.0, 500.0]\n", between(low), between(high));
        let case = case(folder.path(), "finite-elements", files, &band);
        assert_close(&modes(&case), &all[low..high], 1e-9);
        let output = squeal().arg("cea").arg(&case).args(["--json", "--modes"]).output().unwrap();
        let scene: Value = serde_json::from_slice(&output.stdout).unwrap();
        let of_reduced = scene["modes"].as_array().unwrap();
        if of_reduced.iter().all(|mode| mode["verdict"] == "undecided") {
            // No script takes for an answer what is printed.
            let out = folder.path().join(format!("out{system}"));
            let unchecked = ["--set", "reduction.full_checks=0"];
            let run = squeal().arg("run").arg(&case).args(unchecked).arg("--out").arg(out).output().unwrap();
            let check = squeal().arg("check").arg(&case).args(unchecked).output().unwrap();
            // With a factor of all that is drawn, for a command that asks what matters.
            let drawn = std::fs::read_to_string(&case)
                .unwrap()
                .replace("name = \"all\"", "name = \"all\"\ncoefficient = \"x\"");
            let drawn = format!("{drawn}[parameters.x]\ndistribution = \"uniform\"\nfrom = 0.9\nto = 1.1\n");
            let drawn = written(folder.path(), "drawn.toml", &drawn);
            let influence = squeal().arg("influence").arg(&drawn).args(unchecked).output().unwrap();
            let mut answers = vec![output, run, check];
            // Of other draws a basis may have been made that has no such modes.
            if String::from_utf8_lossy(&influence.stdout).contains("so that nothing is known of its errors") {
                answers.push(influence);
                open_drawn += 1;
            } else {
                assert_eq!(influence.status.code(), Some(0));
            }
            for output in answers {
                let said = String::from_utf8(output.stderr).unwrap();
                assert_eq!(output.status.code(), Some(1), "{said}");
                assert!(said.contains("does not have the modes of the whole one"), "{said}");
                assert!(!output.stdout.is_empty());
            }
            open += 1;
            continue;
        }
        let mut found: Vec<f64> = of_reduced.iter().map(|mode| mode["im"].as_f64().unwrap()).collect();
        found.sort_by(f64::total_cmp);
        assert_close(&found, &all[low..high], 1e-5);
    }
    assert!((1..=3).contains(&open) && open_drawn > 0, "{open} of 12 are open, of draws {open_drawn}");
}

/// Shapes of two reductions of one brake are told at the same rows of it, so that modes are linked by them.
#[test]
fn modes_of_two_reductions_are_compared_by_their_shapes_in_the_whole_brake() {
    let folder = tempfile::tempdir().unwrap();
    let (m, k) = chain(&mut Random(0x51a9e5), 40);
    written(folder.path(), "J_MASS1.mtx", &abaqus(&m));
    written(folder.path(), "J_STIF1.mtx", &abaqus(&k));
    // All of them grow.
    let c: Entries = (0..40).map(|i| (i, i, -2.0)).collect();
    written(folder.path(), "J_DAMP1.mtx", &abaqus(&c));
    let files = "mass = \"J_MASS1.mtx\"\ndamping = \"J_DAMP1.mtx\"\nstiffness = \"J_STIF1.mtx\"\nsymmetry = \"whole\"";
    let case = case(folder.path(), "finite-elements", files, REDUCTION);
    let run = |set: &str, out: &str| {
        let out = folder.path().join(out);
        let output = squeal()
            .arg("run")
            .arg(&case)
            .args(["--no-cache", "--keep-samples", "--every-mode", "--set", set, "--out"])
            .arg(&out)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        out
    };
    let (first, other) = (run("reduction.training=1", "first"), run("reduction.training=3", "other"));
    let output = squeal().arg("compare").args([&first, &other]).arg("--json").output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let links = found.to_string();
    assert!(links.contains("\"shape\""), "{links}");
    let shapes: Vec<String> = std::fs::read_dir(&first)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.file_name().unwrap().to_string_lossy().starts_with("shapes-"))
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect();
    // All of them grow, so that both tables have the same modes.
    every_unstable_mode_is_among_all(&first, true);
    let out = folder.path().join("lattice");
    let lattice = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
    let more = ["--samples", "6", "--keep-samples", "--every-mode", "--out"];
    let output = squeal().arg("run").arg(lattice).args(more).arg(&out).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    every_unstable_mode_is_among_all(&out, false);
    let is_named = |row: &str| row.split(',').nth(1).unwrap().contains('.');
    assert!(!shapes.is_empty() && shapes.iter().all(|text| text.lines().skip(1).all(is_named)), "{shapes:?}");
}

/// Every row of `unstable_modes.csv` has one of `every_mode.csv` with the same names, whose numbers are the same up to the solvers' rounding; the others
/// do not grow.
fn every_unstable_mode_is_among_all(folder: &Path, do_all_grow: bool) {
    let rows = |name: &str| -> Vec<(String, [f64; 2])> {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        let row = |line: &str| {
            let mut cells = line.rsplitn(4, ',');
            let _damping_ratio = cells.next().unwrap();
            let [growth, hz] = [(); 2].map(|()| cells.next().unwrap().parse().unwrap());
            (cells.next().unwrap().to_owned(), [hz, growth])
        };
        text.lines().skip(1).map(row).collect()
    };
    let (mut all, unstable) = (rows("every_mode.csv"), rows("unstable_modes.csv"));
    assert!(unstable.len() > 3 && (all.len() > unstable.len() || do_all_grow), "{} {}", all.len(), unstable.len());
    for (key, [hz, growth]) in unstable {
        let is_it = |(other, [of_hz, of_growth]): &(String, [f64; 2])| {
            *other == key && (of_hz - hz).abs() <= 1e-7 * hz && (of_growth - growth).abs() <= 1e-7 * hz
        };
        let at = all.iter().position(is_it).unwrap_or_else(|| panic!("{key} {hz} {growth}"));
        all.swap_remove(at);
    }
    assert!(all.iter().all(|(_, [_, growth])| *growth <= 0.0), "{all:?}");
}
