//! `squeal cycle`: its files, its words, and what it refuses.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::common::{answer, asked, assert_same, csv_of, hoffmann, refusal, results};

#[test]
fn a_cycle_is_said_in_words_numbers_and_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let words = answer("cycle", &hoffmann(), &["--out", out.to_str().unwrap()]);
    assert!(words.contains("cycle, mass") && words.contains("0.2230"), "{words}");
    let first = results(&out);
    let pictures =
        ["cycle_contacts", "cycle_spectrum"].map(|stem| ["pdf", "png", "svg"].map(|end| format!("{stem}.{end}")));
    let tables = ["cycle_contacts.csv", "cycle_spectrum.csv", "cycles.csv", "report.html", "study.txt"];
    let expected: BTreeSet<String> = pictures.into_iter().flatten().chain(tables.map(str::to_owned)).collect();
    assert_eq!(first.keys().cloned().collect::<BTreeSet<_>>(), expected);
    answer("cycle", &hoffmann(), &["--out", out.to_str().unwrap()]);
    assert_same(&first, &results(&out));
    let json: Value = serde_json::from_str(&answer("cycle", &hoffmann(), &["--json"])).unwrap();
    let row = &json["rows"][0];
    assert!((1.0 / row["cycle_hz"].as_f64().unwrap() - 4.485144715).abs() < 1e-7, "{row}");
    assert_eq!((row["from_mode"].as_f64(), row["kind"].as_str()), (Some(2.0), Some("cycle")));
    assert!((row["open belt"].as_f64().unwrap() * 4.485144715 - 0.968634).abs() < 1e-5);
    let friction = row["power_w friction"].as_f64().unwrap();
    assert!(friction > 0.0 && (row["power_w dashpots"].as_f64().unwrap() / friction + 1.0).abs() < 1e-8, "{row}");
    // Harmonics hold what the motion has, all together and by body (Parseval).
    let (header, harmonics) = csv_of(&first["cycle_spectrum.csv"]);
    for column in ["loudness_m_per_s", "rms_velocity_m_per_s mass"] {
        let place = header.iter().position(|name| name == column).unwrap();
        let sum: f64 = harmonics.iter().map(|row| row[place].parse::<f64>().unwrap().powi(2)).sum();
        let missing = 1.0 - sum / row[column].as_f64().unwrap().powi(2);
        let part_above: f64 = harmonics.last().unwrap()[4].parse().unwrap();
        assert!((0.0..1e-8).contains(&missing) && (missing - part_above).abs() < 1e-12, "{column}: {missing}");
    }
    // Another question does not overwrite the folder.
    refusal(&asked("cycle", &hoffmann(), &["--harmonics", "5", "--out", out.to_str().unwrap()]), &["allowed: a new"]);
}

/// Hoffmann's oscillator of two rotations, by the names of its rows: contacts have a figure, velocities without loudness none.
#[test]
fn a_cycle_of_rotations_alone_is_drawn_by_its_contacts() {
    let folder = tempfile::tempdir().unwrap();
    let mut case = std::fs::read_to_string(hoffmann()).unwrap();
    for (from, to) in [
        ("dofs = [\"x\", \"y\"]  ", "# "),
        ("mass = [[1.0, 0.0], [0.0, 1.0]]", "mass = \"h.mas\""),
        ("stiffness = [[2.0, 1.0], [1.0, 2.0]]", "stiffness = \"h.sti\""),
        ("damping = [[0.05, 0.0], [0.0, 0.05]]", "damping = \"d.sti\""),
        ("{ x =", "{ \"1.rx\" ="),
        ("{ y =", "{ \"1.ry\" ="),
        ("dofs = [\"x\", \"y\"]", "dofs = [\"1.rx\", \"1.ry\"]"),
    ] {
        assert!(case.contains(from), "{from}");
        case = case.replacen(from, to, 1);
    }
    for (name, text) in [
        ("h.dof", "1.4\n1.5\n"),
        ("d.dof", "1.4\n1.5\n"),
        ("h.mas", "1 1 1.0\n2 2 1.0\n"),
        ("h.sti", "1 1 2.0\n1 2 1.0\n2 2 2.0\n"),
        ("d.sti", "1 1 0.05\n2 2 0.05\n"),
        ("case.toml", &case),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let out = folder.path().join("out");
    answer("cycle", &folder.path().join("case.toml"), &["--out", out.to_str().unwrap()]);
    let files = results(&out);
    assert!(files.contains_key("cycle_contacts.svg") && !files.contains_key("cycle_spectrum.svg"));
    let page = String::from_utf8(files["report.html"].clone()).unwrap();
    assert!(page.contains("Cycle from mode 2") && page.contains("Its loudness is 0.0000 m/s"));
}

#[test]
fn branches_go_from_the_onset_to_the_end_of_the_range() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let words = answer("cycle", &hoffmann(), &["--over", "mu=0.5:1.1", "--out", out.to_str().unwrap()]);
    assert!(words.contains("onset at mu = 0.753750") && words.contains("\nend: end of the range\n"), "{words}");
    let rows = String::from_utf8(results(&out)["cycle_branches.csv"].clone()).unwrap();
    let last: Vec<&str> = rows.lines().last().unwrap().split(',').collect();
    assert!((last[3].parse::<f64>().unwrap() - 1.1).abs() < 1e-12, "{last:?}");
    assert!((1.0 / last[5].parse::<f64>().unwrap() - 4.670813590).abs() < 1e-7, "{last:?}");
}

#[test]
fn what_has_no_motion_is_refused_in_a_line() {
    for (options, expected) in [
        (&["--stick", "0"][..], &["--stick = 0", "allowed: above 0 and below 1"][..]),
        (&["--harmonics", "0"], &["--harmonics = 0", "allowed: 1 to 100"]),
        (&["--harmonics", "9", "--time-samples", "18"], &["--time-samples = 18", "allowed: 19 or more"]),
        (&["--from", "1"], &["--from = 1", "allowed: noise, or the rank of an unstable mode: 2"]),
        (&["--over", "mu=0.1:0.5"], &["no mode oscillates and grows"]),
        (
            &["--over", "mu=0.8:1.1"],
            &["--over = mu=0.8:1.1", "an onset in it; modes that grow at its begin already: 1"],
        ),
        (&["--over", "nu=0.1:0.5"], &["--over = nu", "allowed: "]),
    ] {
        refusal(&asked("cycle", &hoffmann(), options), expected);
    }
    let disc = hoffmann().with_file_name("wobbling-disc.toml");
    refusal(&asked("cycle", &disc, &[]), &["no contact that could open, slide or stick"]);
    let pad = hoffmann().with_file_name("disc-pad").join("disc-pad.toml");
    // Nothing is reduced before that.
    let across = ["disc-pad.toml", "contact.lateral = \"vector\"; allowed: \"none\""];
    refusal(&asked("cycle", &pad, &[]), &across);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for (command, options) in [("run", ["--cycles", "3"]), ("screen", ["--criterion", "loudness"])] {
        let options = [&options[..], &["--out", out.to_str().unwrap()]].concat();
        refusal(&asked(command, &pad, &options), &across);
        assert!(!out.exists());
    }
    let out = out.to_str().unwrap();
    refusal(&asked("run", &hoffmann(), &["--cycles", "0", "--out", out]), &["--cycles", "allowed: 1 to"]);
    refusal(&asked("run", &hoffmann(), &["--cycles", "3", "--shard", "1/2", "--out", out]), &["--cycles", "--shard"]);
}

#[test]
fn the_page_and_the_summary_have_the_motions_of_draws() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study");
    let said = answer("run", &hoffmann(), &["--samples", "40", "--cycles", "2", "--out", out.to_str().unwrap()]);
    let line = said.lines().find(|line| line.contains("a cycle in 2 of 2")).unwrap();
    for file in ["report.html", "summary.md"] {
        let text = std::fs::read_to_string(out.join(file)).unwrap();
        assert!(text.contains("The motions that unstable modes grow into") && text.contains(line), "{file}");
        assert!(!text.contains("not computed"), "{file}");
    }
}
