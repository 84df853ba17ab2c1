//! `squeal compare`: differences of studies, against closed forms and counts of the kept samples.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Output;

use output::Table;

use crate::common::{SMALL, hoffmann, refusal, run, squeal};

fn compare(folders: &[&Path], options: &[&str]) -> Output {
    squeal().arg("compare").args(folders).args(options).output().unwrap()
}

/// The rows of a comparison.
fn rows(folders: &[&Path]) -> Vec<BTreeMap<String, serde_json::Value>> {
    let output = compare(folders, &["--json"]);
    assert!(output.status.success(), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The samples of a folder in which a mode is unstable, by scene and name; open names as they stand.
fn unstable(folder: &Path) -> BTreeMap<(String, String), BTreeSet<u64>> {
    let table = Table::read(&folder.join("samples.csv")).unwrap().unwrap();
    let mut found: BTreeMap<_, BTreeSet<u64>> = BTreeMap::new();
    for row in &table.rows {
        let (scene, sample) = (row[..5].join(" "), row[5].parse().unwrap());
        for mode in row[7].split(';').filter(|mode| !mode.is_empty()) {
            let (name, _) = mode.split_once(':').unwrap();
            found.entry((scene.clone(), name.to_owned())).or_default().insert(sample);
        }
    }
    found
}

#[test]
fn damping_takes_from_the_occurrence_what_the_closed_form_says() {
    let dir = tempfile::tempdir().unwrap();
    let study = |name: &str, damping: &str, more: &[&str]| -> PathBuf {
        let out = dir.path().join(name);
        let set = format!("terms.dashpots.damping=[[{damping}, 0.0], [0.0, {damping}]]");
        run(&hoffmann(), &out, &[&["--samples", "4000", "--set", &set], more].concat());
        out
    };
    let (as_is, damped) = (study("as-is", "0.05", &["--keep-samples"]), study("damped", "0.1", &["--keep-samples"]));
    // The onset is (1 + 2 c^2) / k3, of mu from 0.5 to 1.1.
    let difference = -2.0 * (0.1_f64.powi(2) - 0.05_f64.powi(2)) / (4.0 / 3.0) / 0.6;
    let width_of = |folders: &[&Path], interval: &str, modes: &[&str]| -> f64 {
        let rows = rows(folders);
        let found: Vec<&str> = rows.iter().map(|row| row["mode"].as_str().map_or("", |name| name)).collect();
        assert!(rows.iter().all(|row| row["interval"] == interval), "{rows:?}");
        assert_eq!(rows.len(), modes.len(), "{found:?}");
        let mut width = 0.0;
        for row in &rows {
            let [lower, upper] = ["lower", "upper"].map(|key| row[key].as_f64().unwrap());
            assert!(lower < difference && difference < upper, "{row:?} {difference}");
            width = upper - lower;
        }
        width
    };
    let paired = width_of(&[&as_is, &damped], "paired", &["any", "2"]);
    let (others, plain) = (study("others", "0.1", &["--seed", "2"]), study("plain", "0.1", &[]));
    let independent = width_of(&[&as_is, &others], "independent", &["any", "2"]);
    let dependent = width_of(&[&as_is, &plain], "any dependence", &["any", "2"]);
    assert!(paired < independent / 4.0 && independent < dependent, "{paired} {independent} {dependent}");
    let said = String::from_utf8(compare(&[&as_is, &damped], &[]).stdout).unwrap();
    for word in [
        "in pairs; drawn alike: mu; not alike: nothing",
        "less often",
        "mode 2 (0.2255 Hz) -> 2 (0.2254 Hz), MAC 1.000",
    ] {
        assert!(said.contains(word), "{said}");
    }
}

#[test]
fn pairs_are_counted_sample_by_sample_and_a_study_does_not_differ_from_itself() {
    let dir = tempfile::tempdir().unwrap();
    let case = dir.path().join("brake.toml");
    std::fs::write(&case, SMALL).unwrap();
    let of = |name: &str| dir.path().join(name);
    run(&case, &of("one"), &["--keep-samples"]);
    // A stiffer contact, and fewer samples: those that both have are compared.
    run(&case, &of("two"), &["--keep-samples", "--samples", "30", "--set", "lattice.contact_stiffness=3.7e7"]);
    let itself = rows(&[&of("one"), &of("one")]);
    assert!(itself.iter().filter(|row| row["linked_by"] == "shape").count() > 4);
    for row in &itself {
        assert_eq!(row["difference"], 0.0, "{row:?}");
        assert!(row["linked_by"] != "shape" || (row["mac"].as_f64().unwrap() - 1.0).abs() < 1e-12, "{row:?}");
    }
    let (one, two) = (unstable(&of("one")), unstable(&of("two")));
    let (mut differ, none) = (0, BTreeSet::new());
    for row in rows(&[&of("one"), &of("two")]).iter().filter(|row| row["linked_by"] == "shape") {
        // Of arrangements that are each other's images, as without constraints, the first has the samples.
        if row["arrangement"] == 2 && row["constraints"] == "none" {
            assert_eq!(row["interval"], "any dependence", "{row:?}");
            continue;
        }
        assert_eq!((row["interval"].as_str(), row["samples"].as_u64()), (Some("paired"), Some(30)), "{row:?}");
        let text = |key: &str| match &row[key] {
            serde_json::Value::String(text) => text.clone(),
            serde_json::Value::Null => String::new(),
            number => number.to_string().trim_end_matches(".0").to_owned(),
        };
        let scene = ["constraints", "law", "speed", "in_contact", "arrangement"].map(text).join(" ");
        let is_open = |(of, name): &(String, String)| *of == scene && name.contains(['|', '?']);
        if one.keys().chain(two.keys()).any(is_open) {
            continue;
        }
        let hits = |of: &BTreeMap<_, BTreeSet<u64>>, mode: &str| -> BTreeSet<u64> {
            of.get(&(scene.clone(), text(mode))).unwrap_or(&none).iter().copied().filter(|&at| at < 30).collect()
        };
        let (before, after) = (hits(&one, "against_mode"), hits(&two, "mode"));
        let (lost, gained) = (before.difference(&after).count() as f64, after.difference(&before).count() as f64);
        assert!((row["difference"].as_f64().unwrap() - (gained - lost) / 30.0).abs() < 1e-12, "{row:?}");
        let (p, q) = ((gained + 1.0) / 32.0, (lost + 1.0) / 32.0);
        let lower = p - q - 1.959_963_984_540_054 * ((p + q - (p - q).powi(2)) / 32.0).sqrt();
        assert!((row["lower"].as_f64().unwrap() - lower).abs() < 1e-12, "{row:?} {lower}");
        differ += usize::from(lost + gained > 0.0);
    }
    assert!(differ > 0, "nothing differs");
    let out = of("compared");
    let output = compare(&[&of("one"), &of("two")], &["--out", out.to_str().unwrap()]);
    assert!(
        output.status.success()
            && ["compare.csv", "summary.md", "report.html"].iter().all(|name| out.join(name).is_file())
    );
    refusal(&compare(&[&of("one"), &of("one")], &["--out", out.to_str().unwrap()]), &["compared"]);
}

/// Random samples in which nothing is unstable get an open verdict: the limits of anything hold what it would be if all of them were stable, or all unstable.
#[test]
fn open_verdicts_of_kept_samples_widen_what_is_said_of_anything() {
    let dir = tempfile::tempdir().unwrap();
    let [one, two] = ["0.05", "0.1"].map(|damping| {
        let (out, set) =
            (dir.path().join(damping), format!("terms.dashpots.damping=[[{damping}, 0.0], [0.0, {damping}]]"));
        run(&hoffmann(), &out, &["--samples", "200", "--keep-samples", "--set", &set]);
        out
    });
    let any = || rows(&[&one, &two]).into_iter().find(|row| row["mode"] == "any").unwrap();
    let number = |row: &BTreeMap<String, serde_json::Value>, key: &str| row[key].as_f64().unwrap();
    let sure = any();
    let path = two.join("samples.csv");
    let table = Table::read(&path).unwrap().unwrap();
    let [unstable, open] = ["unstable", "open"].map(|name| table.columns.iter().position(|it| it == name).unwrap());
    assert!(table.rows.iter().all(|row| row[open] == "0"));
    let mut marked = 0;
    let rows_with_open = table.rows.iter().enumerate().map(|(at, row)| {
        let mut row = row.clone();
        if row[unstable].is_empty() && at.wrapping_mul(2_654_435_761) % 7 < 3 {
            row[open] = "1".into();
            marked += 1;
        }
        row
    });
    let rows_with_open: Vec<_> = rows_with_open.collect();
    Table::new("samples", table.columns.iter().map(String::as_str).collect::<Vec<_>>(), rows_with_open)
        .write(&two)
        .unwrap();
    let found = any();
    let most = number(&sure, "difference") + f64::from(marked) / 200.0;
    assert!(marked > 20, "{marked}");
    assert!(number(&found, "lower") <= number(&sure, "lower") + 1e-12, "{found:?} {sure:?}");
    assert!(number(&found, "upper") > most, "{found:?} {most}");
    // Samples of an earlier program do not tell: that is named.
    let text = std::fs::read_to_string(&path).unwrap();
    let cut = |line: &str| {
        line.split(',').enumerate().filter(|(at, _)| *at != open).map(|(_, cell)| cell).collect::<Vec<_>>().join(",")
    };
    std::fs::write(&path, text.lines().map(|line| cut(line) + "\n").collect::<String>()).unwrap();
    let said = String::from_utf8(compare(&[&one, &two], &[]).stdout).unwrap();
    assert!(said.contains("do not tell which verdicts are open"), "{said}");
}

#[test]
fn what_counts_otherwise_is_refused_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let study = |name: &str, options: &[&str]| {
        let out = dir.path().join(name);
        run(&hoffmann(), &out, &[&["--samples", "20"], options].concat());
        out
    };
    let plain = study("plain", &[]);
    let above = study("above", &["--set", "squeal.growth_above=0.01"]);
    refusal(
        &compare(&[&plain, &above], &[]),
        &["above: its threshold is", "growth rate", "plain is none", "one threshold"],
    );
    let elsewhere = study("elsewhere", &["--set", "contacts.belt.name=tape"]);
    refusal(&compare(&[&plain, &elsewhere], &[]), &["elsewhere: it has no scene of", "tape"]);
    let empty = dir.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    refusal(&compare(&[&plain, &empty], &[]), &["empty: no manifest.json"]);
    std::fs::write(plain.join("modes.csv"), "constraints,mode\nnone,1\n").unwrap();
    refusal(&compare(&[&plain, &above], &[]), &["plain: its modes.csv is damaged"]);
    refusal(&compare(&[&above], &[]), &["2 values required"]);
}
