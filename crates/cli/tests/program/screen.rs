//! `squeal screen`: its files, its words, and what it refuses.

use serde_json::Value;

use crate::common::{SMALL, answer, asked, assert_same, hoffmann, refusal, results};
use crate::tables::columns;

#[test]
fn tables_figure_and_page_are_the_same_bytes_with_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let dir = |threads: &str| folder.path().join(threads);
    // The third run finds the checkpoint of the first and evaluates nothing anew.
    for threads in ["1", "2", "1"] {
        answer("screen", &case, &["--draws", "2", "--threads", threads, "--out", dir(threads).to_str().unwrap()]);
    }
    let first = results(&dir("1"));
    let files = [
        "checkpoint.json",
        "report.html",
        "screen.csv",
        "screen.pdf",
        "screen.png",
        "screen.svg",
        "screen_differences.csv",
        "study.txt",
    ];
    assert_eq!(first.keys().collect::<Vec<_>>(), files);
    assert_same(&first, &results(&dir("2")));
    roxmltree::Document::parse(&String::from_utf8(first["screen.svg"].clone()).unwrap()).unwrap();
    // The brake as it is, the case's other set, and of each kind the best pair, the best symmetric one and the best single change.
    let rows = columns(&dir("1").join("screen.csv"), &["kind", "count", "samples", "drop", "drop_lower", "drop_upper"]);
    let confirmed: Vec<&Vec<String>> = rows.iter().filter(|row| !row[2].is_empty()).collect();
    assert!(confirmed.iter().all(|row| row[2] == "40"), "{confirmed:?}");
    for kind in ["constraint", "mass", "spring", "dashpot", "contact"] {
        let counts: Vec<&str> = confirmed.iter().filter(|row| row[0] == kind).map(|row| row[1].as_str()).collect();
        let (last, pairs) = counts.split_last().unwrap();
        assert!(
            *last == "1" && (1..=2).contains(&pairs.len()) && pairs.iter().all(|count| *count == "2"),
            "{kind} {counts:?}"
        );
    }
    for row in &confirmed[1..] {
        let [drop, lower, upper] = [3, 4, 5].map(|at| row[at].parse::<f64>().unwrap());
        assert!(lower <= drop && drop <= upper, "{row:?}");
    }
}

#[test]
fn each_criterion_has_its_files_and_says_of_what_its_drop_is_with_few_draws_too() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    for (criterion, words) in [
        ("occurrence", "drop: unstable modes fewer in one analysis"),
        ("probability", "drop: percentage points fewer analyses with anything unstable"),
        (
            "growth-quantile",
            "limits of a quantile are not known from fewer than 72 draws, or where some failed: inf\ndrop: 1/s less growth",
        ),
    ] {
        let dir = folder.path().join(criterion);
        let options = ["--criterion", criterion, "--kinds", "contact,dashpot", "--draws", "2", "--out"];
        let text = answer("screen", &case, &[&options[..], &[dir.to_str().unwrap()]].concat());
        assert!(text.contains(words), "{text}");
        let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
        assert!(page.contains(words.split("drop: ").last().unwrap()), "{criterion}");
        let limits = columns(&dir.join("screen.csv"), &["growth_quantile", "growth_quantile_upper"]);
        assert!(limits[0][0].parse::<f64>().unwrap() > 0.0 && limits[0][1] == "inf", "{limits:?}");
    }
}

#[test]
fn sizes_have_no_unit_where_nobody_says_what_turns_and_the_counts_of_sets_are_told_apart() {
    let words = answer("screen", &hoffmann(), &["--kinds", "spring", "--samples", "20"]);
    assert!(
        !words.contains("N/m") && words.contains("sizes without a unit are in those of the case's matrices"),
        "{words}"
    );
    assert!(words.contains("for each of 3 sets of changes, of 6 combinations"), "{words}");
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let words = answer("screen", &case, &["--kinds", "spring", "--up-to", "1", "--draws", "2"]);
    assert!(words.contains(" N/m") && !words.contains("without a unit"), "{words}");
}

#[test]
fn json_has_what_the_words_say() {
    let options = ["--kinds", "constraint,contact", "--up-to", "1", "--samples", "200"];
    let words = answer("screen", &hoffmann(), &options);
    assert!(words.contains("take out contact") && words.contains("belt"), "{words}");
    let json: Value =
        serde_json::from_str(&answer("screen", &hoffmann(), &[&options[..], &["--json"]].concat())).unwrap();
    let sets = json["sets"].as_array().unwrap();
    let of = |kind: &str| sets.iter().find(|set| set["kind"] == kind).unwrap();
    // Held or without friction the oscillator is stable: all there is drops.
    for kind in ["constraint", "contact"] {
        assert_eq!(of(kind)["confirmed"]["unstable"]["value"], 0.0);
        assert_eq!(of(kind)["confirmed"]["drop"]["value"], sets[0]["confirmed"]["unstable"]["value"]);
    }
    assert_eq!(json["counts"]["samples"], 200);
}

#[test]
fn a_folder_of_another_screening_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let options = ["--kinds", "contact", "--samples", "20", "--out", out.to_str().unwrap()];
    answer("screen", &hoffmann(), &options);
    let before = results(&out);
    refusal(&asked("screen", &hoffmann(), &[&options[..], &["--up-to", "1"]].concat()), &["screen", "allowed: a new"]);
    assert_same(&before, &results(&out));
}

#[test]
fn screenings_that_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    for (options, expected) in [
        (
            &["--kinds", "glue"][..],
            &["--kinds = glue", "allowed: constraint, mass, spring, dashpot, contact, scale"][..],
        ),
        (&["--constraints", "third"], &["--constraints = third", "none, first"]),
        (&["--up-to", "0"], &["--up-to = 0", "1 to 20"]),
        (&["--up-to", "-1"], &["-1", "a whole number"]),
        (&["--draws", "0"], &["--draws = 0", "1 to 10000"]),
        (&["--samples", "1"], &["--samples = 1", "2 or more"]),
        (&["--mass", "0"], &["--mass = 0", "a number > 0, kg"]),
        (&["--spring", "nan"], &["--spring = NaN", "a number > 0, N/m"]),
        (&["--dashpot=-1"], &["--dashpot = -1", "a number > 0, Ns/m"]),
        (&["--factor", "1"], &["--factor = 1", "a number > 1"]),
        (&["--variants", "none.toml"], &["none.toml", "cannot be read"]),
        (&["--dashpot", "much"], &["much", "allowed: a number"]),
        (&["--threads", "0"], &["--threads = 0", "1 to 1024"]),
    ] {
        let line = refusal(&asked("screen", &case, options), expected);
        println!("{}", line.trim_end());
    }
    refusal(&asked("screen", &folder.path().join("none.toml"), &[]), &["none.toml"]);
}

/// A hold leaves the dashpots of loss factors as they were: that is said where a screening holds something, and nowhere else.
#[test]
fn a_hold_beside_loss_factors_is_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("brake.toml");
    let text = std::fs::read_to_string(hoffmann()).unwrap();
    let lossy = text.replacen("[[terms]]\n", "[[terms]]\nloss_factor = 0.02\n", 1);
    assert_ne!(text, lossy);
    // What dashpots leave of loss factors is on the other stream.
    let printed = |command: &str, options: &[&str]| {
        let output = asked(command, &case, options);
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    for (text, kinds, is_doubted) in [
        (&lossy, "constraint", true),
        (&lossy, "mass,constraint", true),
        (&lossy, "mass,dashpot", false),
        (&text, "constraint", false),
    ] {
        std::fs::write(&case, text).unwrap();
        let options = ["--kinds", kinds, "--samples", "20", "--draws", "2"];
        let said = printed("screen", &options);
        assert_eq!(
            said.contains("WARNING: loss factors are dashpots of the brake without what a change holds"),
            is_doubted,
            "{kinds}: {said}"
        );
        let json: Value = serde_json::from_str(&printed("screen", &[&options[..], &["--json"]].concat())).unwrap();
        assert_eq!(json["warnings"].as_array().unwrap().len(), usize::from(is_doubted), "{kinds}");
    }
    std::fs::write(&case, &lossy).unwrap();
    assert!(!printed("cea", &[]).contains("WARNING"));
}

/// Exact occurrences stand in the file of the variants.
#[test]
fn variants_are_ranked_with_what_a_search_makes() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("out");
    let variants = hoffmann().with_file_name("hoffmann-variants.toml");
    let options = ["--variants", variants.to_str().unwrap(), "--kinds", "spring", "--samples", "2000", "--out"];
    let words = answer("screen", &hoffmann(), &[&options[..], &[dir.to_str().unwrap()]].concat());
    let together = words.split_once("together, the largest effect first").unwrap().1;
    let places = ["variant shim", "variant lining", "variant abutment", "spring x"].map(|name| together.find(name));
    assert!(places.is_sorted() && places[0].is_some(), "{words}");
    let rows = columns(&dir.join("screen.csv"), &["kind", "places", "unstable_modes_lower", "unstable_modes_upper"]);
    for (name, exact) in [("abutment", 0.375_833), ("shim", 0.183_333), ("lining", 0.243_75)] {
        let row = rows.iter().find(|row| row[0] == "variant" && row[1] == name).unwrap();
        let [lower, upper] = [&row[2], &row[3]].map(|number| number.parse::<f64>().unwrap());
        assert!(lower < exact && exact < upper && upper - lower < 0.05, "{row:?}");
    }
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(page.contains("Variant <strong>shim</strong>") && page.contains("together, the largest effect first"));
}
