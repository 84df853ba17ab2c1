//! `squeal cea` on the golden cases that a case file can say, and what it answers to options that do not fit.

use std::path::Path;

use serde_json::Value;

use crate::common::{SMALL, asked, hoffmann, refusal, squeal};

const DIRECTIONS: [&str; 3] = ["x", "y", "z"];

/// A case file for a golden case, or `None` where contacts differ: a case at median parameters has them alike.
fn case_file(golden: &Value) -> Option<String> {
    let list = |key: &str| golden[key].as_array().unwrap();
    let text = |key: &str| golden[key].as_str().unwrap();
    let number = |key: &str| golden[key].as_f64().unwrap();
    let (params, mu_y) = (&list("params")[0], &list("mu_y")[0]);
    let alike = list("params").iter().all(|p| p == params) && list("mu_y").iter().all(|mu| mu == mu_y);
    let lateral = match (text("lateral"), golden["lateral_sign"].as_i64()) {
        ("coupled", Some(-1)) => "coupled-minus",
        (lateral, _) => lateral,
    };
    let is_coulomb = text("law") == "amontons-coulomb";
    if !alike || (is_coulomb && lateral != "none" && params["mu"] != *mu_y) {
        return None;
    }
    let dof = |i: &Value| {
        let i = i.as_u64().unwrap() as usize;
        let body = if i / 3 == 9 { "p".into() } else { (i / 3 + 1).to_string() };
        format!("\"{}{body}\"", DIRECTIONS[i % 3])
    };
    let fixed: Vec<String> = list("constrained").iter().map(dof).collect();
    let contact: Vec<u64> = list("contact").iter().map(|i| i.as_u64().unwrap() + 1).collect();
    let parameter = |key: &str, otherwise: f64| params[key].as_f64().unwrap_or(otherwise);
    let friction = [
        ("mu", if is_coulomb { parameter("mu", 0.0) } else { mu_y.as_f64().unwrap() }),
        ("mu_s", parameter("mu_s", 1.0)),
        ("mu_k", parameter("mu_k", 1.0)),
        ("alpha", parameter("alpha", 1.0)),
        ("v_s", parameter("v_s", 1.0)),
        ("sigma0", parameter("sigma0", 1e5)),
        ("sigma1", parameter("sigma1", 1.0)),
        ("sigma2", parameter("sigma2", 0.0)),
    ];
    let friction = friction.map(|(key, value)| format!("{key} = {{ distribution = \"constant\", value = {value:?} }}"));
    let paper = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml");
    let paper = std::fs::read_to_string(paper).unwrap();
    let lattice = paper.split("\n[").filter(|table| table.starts_with("lattice")).map(|table| format!("[{table}\n"));
    let mass = format!("oscillator_mass = {:?} #", number("oscillator_mass"));
    let lattice = lattice.collect::<String>().replace("oscillator_mass = 0.39 ", &mass);
    Some(format!(
        "[study]\nname = \"golden\"\nlaws = [\"{law}\"]\nsamples = 1\nseed = 0\n{lattice}\n\
         [contact]\narrangements = [{contact:?}]\n\
         [[constraints]]\nname = \"golden\"\nfixed = [{fixed}]\n\
         [[speeds]]\nname = \"golden\"\nfrom = {speed:?}\nto = {speed:?}\n\
         [readings]\nlean = \"{lean}\"\nlateral = \"{lateral}\"\ndraws = \"shared\"\nlabels = \"rank\"\n\
         preload = {{ per_contact = {preload:?} }}\nbristle_damping = \"constant\"\n\
         [friction]\n{friction}\n",
        law = text("law"),
        fixed = fixed.join(", "),
        speed = number("speed"),
        lean = if golden["lean"].as_i64() == Some(-1) { "against" } else { "along" },
        preload = number("preload"),
        friction = friction.join("\n"),
    ))
}

#[test]
fn the_modes_are_the_golden_ones() {
    let folder = tempfile::tempdir().unwrap();
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/lattice/golden.json");
    let golden: Vec<Value> = serde_json::from_str(&std::fs::read_to_string(fixture).unwrap()).unwrap();
    let (mut laws, mut worst) = (std::collections::BTreeSet::new(), 0.0_f64);
    for golden in &golden {
        let Some(text) = case_file(&golden["case"]) else { continue };
        laws.insert(golden["case"]["law"].as_str().unwrap());
        let case = folder.path().join("golden.toml");
        std::fs::write(&case, &text).unwrap();
        let output = squeal().arg("cea").arg(&case).arg("--json").output().unwrap();
        assert!(output.status.success(), "{}\n{text}", String::from_utf8_lossy(&output.stderr));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let number = |value: &Value| value.as_f64().unwrap();
        let mut modes: Vec<&Value> = found["modes"].as_array().unwrap().iter().collect();
        let expected = golden["eigenvalues_upper"].as_array().unwrap();
        assert_eq!(modes.len(), expected.len());
        for lambda in expected {
            let (re, im) = (number(&lambda[0]), number(&lambda[1]));
            let distance = |mode: &Value| (number(&mode["re"]) - re).hypot(number(&mode["im"]) - im) / re.hypot(im);
            let near = (0..modes.len()).min_by(|&i, &j| distance(modes[i]).total_cmp(&distance(modes[j]))).unwrap();
            let mode = modes.swap_remove(near);
            worst = worst.max(distance(mode));
            assert!((number(&mode["frequency_hz"]) / (im / std::f64::consts::TAU) - 1.0).abs() < 1e-9);
            assert!((number(&mode["damping_ratio"]) + re / re.hypot(im)).abs() < 1e-9);
        }
    }
    println!("largest relative distance {worst:.1e} over {laws:?}");
    assert!(worst < 1e-9, "{worst:e}");
    assert_eq!(laws.into_iter().collect::<Vec<_>>(), ["amontons-coulomb", "lugre", "velocity-dependent"]);
}

#[test]
fn options_that_do_not_fit_the_case() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    for (options, expected) in [
        (["--law", "coulomb"], ["--law = coulomb", "allowed: amontons-coulomb, velocity-dependent, lugre, stribeck"]),
        (["--constraints", "second"], ["--constraints = second", "allowed: \"none\", \"first\""]),
        (["--contact", "1,3"], ["--contact = 1,3", "1 to 2"]),
        (["--contact", "0"], ["--contact = 0", "1 to 2"]),
        (["--contact", "2,2"], ["--contact = 2,2", "each once"]),
        (["--speed", "-1"], ["--speed = -1", "m/s, > 0"]),
        (["--speed", "0"], ["--speed = 0", "m/s, > 0"]),
        (["--speed", "nan"], ["--speed = NaN", "m/s, > 0"]),
    ] {
        let line = refusal(&squeal().arg("cea").arg(&case).args(options).output().unwrap(), &expected);
        println!("{}", line.trim_end());
    }
}

#[test]
fn values_that_are_set_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let lattice = folder.path().join("brake.toml");
    std::fs::write(&lattice, SMALL).unwrap();
    for (case, set) in [(&lattice, "mu"), (&hoffmann(), "mu")] {
        let set = format!("{set}=0.4321");
        let said = |options: &[&str]| String::from_utf8(asked("cea", case, options).stdout).unwrap();
        let words = said(&["--set", &set]);
        assert!(words.lines().next().unwrap().contains("mu = 0.4321"), "{words}");
        let json: Value = serde_json::from_str(&said(&["--set", &set, "--json"])).unwrap();
        assert_eq!(json["scene"]["parameters"]["mu"].as_f64(), Some(0.4321), "{}", json["scene"]);
    }
}

#[test]
fn options_of_a_scene_are_heard_by_every_kind_of_brake() {
    let folder = tempfile::tempdir().unwrap();
    let lattice = folder.path().join("brake.toml");
    std::fs::write(&lattice, SMALL).unwrap();
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad/disc-pad.toml");
    // A narrow band, for which little is prepared.
    let narrow = ["--no-cache", "--set", "reduction.frequencies=[2600.0, 3200.0]", "--set", "reduction.training=3"];
    let mesh_options = ["--law", "lugre", "--contact", "2,5", "--constraints", "ends-of-backplate", "--speed", "0.5"];
    let lattice_options = ["--law", "lugre", "--contact", "2", "--speed", "0.5"];
    for (case, options, all) in [(&lattice, &lattice_options[..], &[][..]), (&mesh, &mesh_options, &narrow)] {
        let heading = |options: &[&str]| {
            let output = asked("cea", case, &[options, all].concat());
            assert!(output.status.success(), "{output:?}");
            String::from_utf8(output.stdout).unwrap().lines().next().unwrap().to_owned()
        };
        let (first, asked) = (heading(&[]), heading(options));
        println!("{first}\n{asked}");
        for value in options.chunks(2).map(|option| option[1].replace(',', " ")) {
            assert!(asked.contains(&value), "{value}: {asked}");
        }
        assert!(first.contains("; median parameters: ") && first.contains("mu = "), "{first}");
        assert!(!first.contains("lugre") && !first.contains("0.5 m/s"), "{first}");
    }
    // Nothing of them means anything where friction is given as matrices.
    for option in [["--law", "lugre"], ["--contact", "1"], ["--speed", "1"]] {
        refusal(&asked("cea", &hoffmann(), &option), &[option[0], "given by its matrices"]);
    }
}
