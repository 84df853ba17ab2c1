//! `squeal sweep`: its files, its words, and what it refuses.

use serde_json::Value;

use crate::common::{SMALL, answer, asked, assert_same, hoffmann, refusal, results};

#[test]
fn tables_and_figures_are_the_same_bytes_with_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let one = [
        "branches.csv",
        "coalescences.csv",
        "onsets.csv",
        "report.html",
        "study.txt",
        "sweep.pdf",
        "sweep.png",
        "sweep.svg",
    ];
    let two = ["boundary.csv", "regions.csv", "report.html", "study.txt", "sweep.pdf", "sweep.png", "sweep.svg"];
    for (options, files) in [
        (&["--over", "mu=0:1"][..], &one[..]),
        (&["--law", "velocity-dependent", "--over", "mu_k=0.1:0.6", "--over", "v=0.1:10"][..], &two[..]),
    ] {
        let dir = |threads: &str| folder.path().join(format!("{}-{threads}", files[0]));
        for threads in ["1", "2", "1"] {
            let out = dir(threads);
            answer("sweep", &case, &[options, &["--threads", threads, "--out", out.to_str().unwrap()]].concat());
            assert!(out.join("manifest.json").exists());
        }
        let first = results(&dir("1"));
        assert_eq!(first.keys().collect::<Vec<_>>(), files);
        assert_same(&first, &results(&dir("2")));
        let svg = String::from_utf8(first["sweep.svg"].clone()).unwrap();
        roxmltree::Document::parse(&svg).unwrap();
    }
}

#[test]
fn a_folder_of_another_sweep_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let place = out.to_str().unwrap();
    answer("sweep", &hoffmann(), &["--over", "mu=0:1", "--out", place]);
    let before = results(&out);
    refusal(
        &asked("sweep", &hoffmann(), &["--over", "mu=0:2", "--out", place]),
        &["mu=0:1", "mu=0:2", "allowed: a new"],
    );
    let lock = std::fs::File::open(out.join("run.lock")).unwrap();
    lock.try_lock().unwrap();
    refusal(
        &asked("sweep", &hoffmann(), &["--over", "mu=0:1", "--out", place]),
        &["another run", "allowed: another folder"],
    );
    assert_same(&before, &results(&out));
}

#[test]
fn json_has_what_the_words_say() {
    let words = answer("sweep", &hoffmann(), &["--over", "mu=0:1"]);
    assert!(words.contains("starts to grow") && words.contains("0.75375"), "{words}");
    let json: Value = serde_json::from_str(&answer("sweep", &hoffmann(), &["--over", "mu=0:1", "--json"])).unwrap();
    let onset = &json["onsets"][0];
    assert!((onset["at"].as_f64().unwrap() - 0.75375).abs() < 1e-12, "{onset}");
    assert_eq!((onset["mode"].as_str(), onset["starts"].as_bool()), (Some("2"), Some(true)));
    assert_eq!(json["parameter"]["median"].as_f64(), Some(0.8));
    let disc = hoffmann().with_file_name("wobbling-disc.toml");
    let both = ["--over", "mu=0.1:0.9", "--over", "Omega=5:100", "--json"];
    let json: Value = serde_json::from_str(&answer("sweep", &disc, &both)).unwrap();
    assert_eq!(json["boundary"].as_array().unwrap().len(), 1);
    assert!(json["checks"].as_u64().unwrap() > 100);
}

#[test]
fn sweeps_that_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let (lattice, matrices) = (case.as_path(), &*hoffmann());
    for (case, options, expected) in [
        (lattice, &["--over", "nu=0:1"][..], &["--over = nu", "mu, ", "contact_stiffness"][..]),
        (lattice, &["--over", "alpha=0:1"], &["--over = alpha", "amontons-coulomb", "allowed"]),
        (matrices, &["--over", "v=0:1"], &["--over = v", ": mu"]),
        (lattice, &["--over", "mu=1:0"], &["--over = mu=1:0", "FROM < TO"]),
        (lattice, &["--over", "mu=1:1"], &["--over = mu=1:1", "FROM < TO"]),
        (lattice, &["--over", "mu=0:nan"], &["mu=0:NaN", "FROM < TO"]),
        (lattice, &["--over", "mu=0:inf"], &["mu=0:inf", "FROM < TO"]),
        (lattice, &["--over", "mu=-1:1"], &["mu = -1", "allowed: finite and >= 0"]),
        (lattice, &["--over", "mu"], &["mu", "allowed: NAME=FROM:TO, as mu=0:1"]),
        (lattice, &["--over", "mu=a:b"], &["mu=a:b", "allowed: NAME=FROM:TO, as mu=0:1"]),
        (lattice, &["--over", "mu=0:1", "--over", "mu=0:2"], &["--over = mu=0:2", "two different parameters"]),
        (
            lattice,
            &["--over", "mu=0:1", "--over", "theta=1:2", "--over", "phi=1:2"],
            &["given 3 times", "once or twice"],
        ),
        (lattice, &["--law", "lugre", "--over", "mu_k=0.1:0.9"], &["mu_k = 0.9", "mu_s", "allowed: >= mu_k"]),
        (lattice, &["--law", "lugre", "--over", "v=0:1"], &["v = 0", "allowed: finite and > 0"]),
        (matrices, &["--law", "lugre", "--over", "mu=0:1"], &["--law", "cases with a lattice"]),
        (lattice, &["--over", "mu=0:1", "--threads", "0"], &["--threads = 0", "1 to 1024"]),
        (lattice, &["--over", "mu=0:1", "--out", "no", "--growth", "5:-1"], &["--growth", "5:-1", "allowed: FROM:TO"]),
        (lattice, &["--over", "mu=0:1", "--growth", "-1:5"], &["--out"]),
        (
            lattice,
            &["--over", "mu=0:1", "--over", "theta=1:2", "--out", "no", "--growth", "-1:5"],
            &["--growth = -1:5", "allowed: with one --over"],
        ),
        (lattice, &[], &["--over", "required"]),
    ] {
        let line = refusal(&asked("sweep", case, options), expected);
        println!("{}", line.trim_end());
    }
}
