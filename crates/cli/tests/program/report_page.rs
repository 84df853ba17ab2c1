//! `report.html`: what its data are, whatever a study is called. What a browser makes of it is tested in `tests/browser`.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::common::{SMALL, answer, csv_of, hoffmann, replaced, results, run, squeal};

/// The JSON element of a page: all between its tag and the first end of a script after it, as a browser has it.
fn data(page: &str) -> Value {
    let start = "<script type=\"application/json\" id=\"data\">";
    let (_, rest) = page.split_once(start).unwrap();
    let (json, _) = rest.split_once("</script").unwrap();
    serde_json::from_str(json).unwrap()
}

fn strings(list: &Value) -> Vec<String> {
    list.as_array().unwrap().iter().map(|cell| cell.as_str().unwrap().to_owned()).collect()
}

/// The rows of a table of a page, as its script lists them.
fn rows(table: &Value) -> Vec<Vec<String>> {
    if let Some(rows) = table["rows"].as_array() {
        return rows.iter().map(strings).collect();
    }
    let mut rows = Vec::new();
    for group in table["groups"].as_array().unwrap() {
        let (inner, outer) = (strings(&group["inner"]), strings(&group["outer"]));
        for (i, place) in group["places"].as_array().unwrap().iter().enumerate() {
            let own = strings(&table["values"][place.as_u64().unwrap() as usize]);
            let names = vec![inner[i % inner.len()].clone(), outer[i / inner.len()].clone()];
            rows.push([strings(&group["key"]), names, own].concat());
        }
    }
    rows
}

/// Real and imaginary part of the numbers of a shape: base 64 of whole numbers of 16 bits, 32767 for the largest modulus.
fn parts(text: &str) -> Vec<[f64; 2]> {
    let digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let (mut bits, mut count, mut bytes) = (0_u32, 0, Vec::new());
    for c in text.chars().filter(|&c| c != '=') {
        (bits, count) = (bits << 6 | digits.find(c).unwrap() as u32, count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    let number = |pair: &[u8]| f64::from(i16::from_le_bytes([pair[0], pair[1]])) / 32767.0;
    bytes.chunks_exact(4).map(|four| [number(&four[..2]), number(&four[2..])]).collect()
}

/// Runs a case and gives its files.
fn files_of(text: &str, options: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let (case, dir) = (folder.path().join("brake.toml"), folder.path().join("out"));
    std::fs::write(&case, text).unwrap();
    run(&case, &dir, options);
    results(&dir)
}

/// Asserts that every table of a page is that of the file beside it; returns their names.
fn assert_tables_are_files(data: &Value, files: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    let mut names = Vec::new();
    for table in data["tables"].as_array().unwrap() {
        let name = table["name"].as_str().unwrap();
        names.push(name.to_owned());
        if name != "occurrence_by_panel.csv" {
            let (header, expected) = csv_of(&files[name]);
            assert_eq!(strings(&table["header"]), header, "{name}");
            assert!(rows(table) == expected, "{name}");
        }
    }
    names
}

#[test]
fn the_page_has_the_numbers_of_the_tables() {
    let files = files_of(SMALL, &["--half-width", "0.02"]);
    let page = String::from_utf8(files["report.html"].clone()).unwrap();
    // Script and style are some 30 kB, the rest grows with the tables.
    assert!(page.len() < 300_000, "{} bytes", page.len());
    let data = data(&page);
    let names = assert_tables_are_files(&data, &files);
    for name in
        ["occurrence.csv", "modes.csv", "panels.csv", "differences.csv", "links.csv", "net_work.csv", "estimates.csv"]
    {
        assert!(names.iter().any(|other| other == name), "{name} is not in {names:?}");
    }

    // Two arrangements of one oscillator in contact: the median is in the middle.
    let (_, occurrence) = csv_of(&files["occurrence.csv"]);
    let (_, modes) = csv_of(&files["modes.csv"]);
    for row in rows(&data["tables"][0]) {
        let mode = modes.iter().find(|mode| mode[0] == row[0] && mode[2] == row[4]).unwrap();
        let same = |other: &&Vec<String>| other[..4] == row[..4] && other[5] == mode[1];
        let values: Vec<f64> = occurrence.iter().filter(same).map(|other| other[9].parse().unwrap()).collect();
        let median = values.iter().sum::<f64>() / values.len() as f64;
        assert!(values.len() <= 2 && (row[7].parse::<f64>().unwrap() - median).abs() < 1e-12, "{row:?}: {values:?}");
    }

    // Shapes are those of the files, but for their scale.
    let (_, shape) = csv_of(&files["shapes-first.csv"]);
    let shown = data["moving"]["shapes"].as_array().unwrap().iter().find(|shape| shape["name"] == "Mode B1").unwrap();
    let shown = parts(shown["parts"].as_str().unwrap());
    assert_eq!(shown[0], [0.0, 0.0], "x1 is held");
    let of_file: Vec<[f64; 2]> = shape
        .iter()
        .filter(|row| row[0] == "1")
        .map(|row| [row[2].parse().unwrap(), row[3].parse().unwrap()])
        .collect();
    let largest = of_file.iter().map(|u| u[0].hypot(u[1])).fold(0.0, f64::max);
    assert_eq!(of_file.len(), shown.len() - 1);
    for (u, [re, im]) in of_file.iter().zip(&shown[1..]) {
        assert!((u[0] / largest - re).abs() < 1e-4 && (u[1] / largest - im).abs() < 1e-4);
    }
    // The answer and the facts are in the document itself.
    for part in
        ["<h3>Which modes squeal</h3>", "<h3>What helps</h3>", "<dt>Seed</dt><dd>7</dd>", "sigma2 = {", "lang=\"en\""]
    {
        assert!(page.contains(part), "{part} is missing");
    }
}

#[test]
fn a_hostile_name_stays_a_name() {
    let plain = files_of(SMALL, &["--samples", "4"]);
    let hostile = r#"name = "</title></script><script>alert(1)</script><!-- {{data}} & 'x' \"on=\"""#;
    let files = files_of(&replaced(SMALL, r#"name = "two oscillators""#, hostile), &["--samples", "4"]);
    let [plain, page] = [&plain, &files].map(|files| String::from_utf8(files["report.html"].clone()).unwrap());
    let tags = |page: &str, tag: &str| page.matches(tag).count();
    for tag in ["<script", "</script", "<title", "</title", "<!--", "<h1"] {
        assert_eq!(tags(&page, tag), tags(&plain, tag), "{tag}");
    }
    assert_eq!(tags(&page, "id=\"data\""), 1, "the name was filled in as a template");
    assert!(page.contains("<title>&lt;/title&gt;&lt;/script&gt;&lt;script&gt;alert(1)"), "the name is missing");
    assert_tables_are_files(&data(&page), &files);
}

#[test]
fn a_page_asks_for_nothing() {
    let files = files_of(SMALL, &["--samples", "4"]);
    let page = String::from_utf8(files["report.html"].clone()).unwrap();
    assert!(page.contains("content=\"default-src 'none'; style-src 'sha256-"), "no content security policy");
    for forbidden in [" src=", "@import", "url(", "<link", "<iframe", "fetch(", "https://"] {
        assert!(!page.contains(forbidden), "{forbidden}");
    }
}

#[test]
fn degrees_of_freedom_without_a_place_move_beside_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let (case, dir) = (hoffmann(), folder.path().join("out"));
    run(&case, &dir, &["--samples", "50"]);
    let data = data(&String::from_utf8(results(&dir)["report.html"].clone()).unwrap());
    let geometry = &data["moving"]["geometry"];
    assert_eq!(geometry["is_spatial"], false);
    let dofs: Vec<&Value> = geometry["points"].as_array().unwrap().iter().map(|point| &point["dofs"][2]).collect();
    assert_eq!(dofs, [0, 1]);
}

#[test]
fn a_sweep_has_a_page_with_its_tables() {
    let folder = tempfile::tempdir().unwrap();
    let case = hoffmann();
    let pages = ["1", "2"].map(|threads| {
        let dir = folder.path().join(threads);
        let output = squeal()
            .arg("sweep")
            .arg(&case)
            .args(["--over", "mu=0:1", "--threads", threads, "--out"])
            .arg(&dir)
            .output();
        assert!(output.unwrap().status.success());
        let files = results(&dir);
        let page = String::from_utf8(files["report.html"].clone()).unwrap();
        let names = assert_tables_are_files(&data(&page), &files);
        assert!(names.contains(&"onsets.csv".to_owned()), "{names:?}");
        let of_onset: Vec<Value> = data(&page)["moving"]["shapes"].as_array().unwrap().clone();
        assert_eq!(of_onset.len(), 1);
        assert_eq!(of_onset[0]["note"], "starts to grow at mu = 0.75375");
        assert_eq!(page.matches("<svg").count(), 1);
        page
    });
    assert!(pages[0] == pages[1], "the page depends on the number of threads");
}

#[test]
fn a_cycle_has_a_page_on_which_it_moves_as_its_contact_does() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    answer("cycle", &hoffmann(), &["--out", out.to_str().unwrap()]);
    let files = results(&out);
    let page = String::from_utf8(files["report.html"].clone()).unwrap();
    let of_page = data(&page);
    assert_eq!(assert_tables_are_files(&of_page, &files), ["cycles.csv", "cycle_spectrum.csv", "cycle_contacts.csv"]);
    assert_eq!(page.matches("<svg").count(), 2);
    assert!(page.contains("becomes a cycle at 0.2230 Hz, 1.1 % below the mode: a contact is open for up to 21.6 %"));
    let shapes = of_page["moving"]["shapes"].as_array().unwrap();
    assert_eq!(shapes.len(), 1);
    let shape = &shapes[0];
    assert_eq!(shape["name"], "Cycle from mode 2");
    let orders: Vec<f64> = shape["orders"].as_array().unwrap().iter().map(|order| order.as_f64().unwrap()).collect();
    assert!(orders.len() > 2 && orders[..2] == [0.0, 1.0], "{orders:?}");
    let (_, contacts) = csv_of(&files["cycle_contacts.csv"]);
    // No point of the drawing is the contact.
    assert_eq!(shape["open"], json!({}));
    // The contact is a spring along the second degree of freedom: where it is closed, its force is that of the picture.
    let waves = parts(shape["parts"].as_str().unwrap());
    let y = |part: f64| -> f64 {
        let wave = |(order, two): (&f64, &[[f64; 2]])| {
            let angle = std::f64::consts::TAU * order * part;
            two[1][0] * angle.cos() - two[1][1] * angle.sin()
        };
        orders.iter().zip(waves.chunks_exact(2)).map(wave).sum()
    };
    let forces: Vec<[f64; 2]> = contacts.iter().map(|row| [2, 3].map(|at| row[at].parse().unwrap())).collect();
    let [at, largest] = *forces.iter().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    let scale = (largest - 1.0) / y(at);
    assert!(scale > 0.0);
    for [part, force] in forces {
        let drawn = (1.0 + scale * y(part)).max(0.0);
        assert!((drawn - force).abs() < 5e-3 * largest, "{part}: {drawn} {force}");
    }
    // Over a parameter the last cycle of each branch moves.
    let out = folder.path().join("over");
    answer("cycle", &hoffmann(), &["--over", "mu=0.5:1.1", "--out", out.to_str().unwrap()]);
    let files = results(&out);
    let page = String::from_utf8(files["report.html"].clone()).unwrap();
    let of_page = data(&page);
    assert_eq!(assert_tables_are_files(&of_page, &files), ["cycle_branches.csv"]);
    let note = of_page["moving"]["shapes"][0]["note"].as_str().unwrap();
    assert!(note.starts_with("stable, at mu = 1.1, loudness 1.5249 m/s; its mean and first"), "{note}");
    assert!(page.contains("Mode 2 starts to grow at mu = 0.75375 with 0.2251 Hz."), "{page}");
}
