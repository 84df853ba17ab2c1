//! How fast modes grow, at which frequency and damping ratio: in tables and in words, against the closed form.

use std::collections::{BTreeMap, BTreeSet};

use montecarlo::{Confidence, Proportion};
use output::Table;

use crate::common::{SMALL, hoffmann, run};

/// The numbers of a table by column, row by row.
fn numbers(table: &Table, columns: &[&str]) -> Vec<Vec<f64>> {
    let of = |name: &str| -> Vec<f64> { table.column(name).unwrap().map(|cell| cell.parse().unwrap()).collect() };
    let columns: Vec<Vec<f64>> = columns.iter().map(|name| of(name)).collect();
    (0..table.rows.len()).map(|row| columns.iter().map(|column| column[row]).collect()).collect()
}

#[test]
fn unstable_modes_are_those_of_the_closed_form() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("study");
    run(&hoffmann(), &out, &["--samples", "400", "--keep-samples"]);
    let read = |name: &str| Table::read(&out.join(name)).unwrap().unwrap();
    let drawn: BTreeMap<u64, f64> =
        numbers(&read("samples.csv"), &["sample", "mu"]).into_iter().map(|row| (row[0] as u64, row[1])).collect();
    let rows =
        numbers(&read("unstable_modes.csv"), &["sample", "mode", "frequency_hz", "growth_rate", "damping_ratio"]);
    let mut growths = Vec::new();
    for row in &rows {
        let [sample, mode, hz, growth, damping] = row[..] else { unreachable!("five columns") };
        // s^2 + c s + 2 = i sqrt(k3 mu - 1), or minus that.
        let (s, square) = (num(growth, std::f64::consts::TAU * hz), (4.0 / 3.0 * drawn[&(sample as u64)] - 1.0).sqrt());
        let residual = s.times(s).plus(num(0.05 * s.0, 0.05 * s.1)).plus(num(2.0, 0.0));
        assert!(residual.0.abs() < 1e-12 && (residual.1.abs() - square).abs() < 1e-12, "{row:?} {residual:?}");
        assert!(mode == 2.0 && growth > 0.0 && (damping + growth / growth.hypot(s.1)).abs() < 1e-15, "{row:?}");
        growths.push(growth);
    }
    let onset = (1.0 + 2.0 * 0.05 * 0.05) * 0.75;
    assert_eq!(rows.len(), drawn.values().filter(|mu| **mu > onset).count());
    growths.sort_by(f64::total_cmp);
    let found =
        numbers(&read("growth.csv"), &["unstable", "least_growth_rate", "median_growth_rate", "largest_growth_rate"]);
    let [unstable, least, median, largest] = found[0][..] else { unreachable!("four columns") };
    let exact = (growths[(growths.len() - 1) / 2] + growths[growths.len() / 2]) / 2.0;
    assert_eq!((unstable, least, largest), (growths.len() as f64, growths[0], growths[growths.len() - 1]));
    assert!((median / exact - 1.0).abs() < 1e-3, "{median} {exact}");
    let summary = std::fs::read_to_string(out.join("summary.md")).unwrap();
    for words in ["growing by up to", "| 0.25 | red | 2 |", "Worst"] {
        assert!(summary.contains(words), "{words:?} is missing from {summary}");
    }
    // One panel: nothing is said of panels.
    assert!(!summary.contains("panel"), "{summary}");
}

/// A complex number.
#[derive(Debug, Clone, Copy)]
struct Num(f64, f64);

fn num(re: f64, im: f64) -> Num {
    Num(re, im)
}

impl Num {
    fn times(self, by: Self) -> Self {
        Self(self.0 * by.0 - self.1 * by.1, self.0 * by.1 + self.1 * by.0)
    }

    fn plus(self, more: Self) -> Self {
        Self(self.0 + more.0, self.1 + more.1)
    }
}

#[test]
fn a_study_of_many_panels_has_the_strength_of_each_law_and_still_speaks_of_panels() {
    let dir = tempfile::tempdir().unwrap();
    let (case, out) = (dir.path().join("brake.toml"), dir.path().join("study"));
    std::fs::write(&case, SMALL).unwrap();
    run(&case, &out, &["--keep-samples"]);
    let growth = Table::read(&out.join("growth.csv")).unwrap().unwrap();
    let unstable = Table::read(&out.join("unstable_modes.csv")).unwrap().unwrap();
    let column =
        |table: &Table, name: &str| -> Vec<String> { table.column(name).unwrap().map(str::to_owned).collect() };
    let key = |table: &Table| -> Vec<(String, String, String)> {
        let [sets, laws, modes] = ["constraints", "law", "mode"].map(|name| column(table, name));
        sets.into_iter().zip(laws).zip(modes).map(|((set, law), mode)| (set, law, mode)).collect()
    };
    let mut largest: BTreeMap<(String, String, String), (u64, f64)> = BTreeMap::new();
    for (key, growth) in key(&unstable).into_iter().zip(column(&unstable, "growth_rate")) {
        let entry = largest.entry(key).or_default();
        *entry = (entry.0 + 1, entry.1.max(growth.parse().unwrap()));
    }
    let rows = key(&growth)
        .into_iter()
        .zip(column(&growth, "unstable").into_iter().zip(column(&growth, "largest_growth_rate")));
    let found: BTreeMap<_, _> = rows
        .map(|(key, (count, growth))| (key, (count.parse::<u64>().unwrap(), growth.parse::<f64>().unwrap())))
        .collect();
    largest.retain(|(.., mode), _| !mode.contains(['|', '?']));
    assert!(found.len() > 6);
    assert_eq!(found, largest);
    assert!(std::fs::read_to_string(out.join("summary.md")).unwrap().contains("panel"));
}

/// A table of a summary: the words before it, and its cells.
fn tables_under<'a>(summary: &'a str, heading: &str) -> Vec<(&'a str, Vec<Vec<&'a str>>)> {
    let (_, section) = summary.split_once(&format!("## {heading}\n")).unwrap();
    let section = section.split("\n## ").next().unwrap();
    let mut tables: Vec<(&str, Vec<Vec<&str>>)> = Vec::new();
    for line in section.lines().filter(|line| !line.is_empty()) {
        match line.strip_prefix("| ") {
            Some(row) => tables.last_mut().unwrap().1.push(row.trim_end_matches(" |").split(" | ").collect()),
            None => tables.push((line, Vec::new())),
        }
    }
    tables.retain(|(_, rows)| !rows.is_empty());
    tables
}

/// What a summary says of frequencies holds for every draw in which something is unstable: the frequency of a mode lies among its own, no green
/// band has any, and a band is red where in one arrangement most of the draws surely have a mode there, whichever.
#[test]
fn frequencies_and_lights_are_those_of_the_unstable_draws() {
    let dir = tempfile::tempdir().unwrap();
    let (case, out) = (dir.path().join("brake.toml"), dir.path().join("study"));
    std::fs::write(&case, SMALL).unwrap();
    run(&case, &out, &["--keep-samples"]);
    let read = |name: &str| Table::read(&out.join(name)).unwrap().unwrap();
    let text = |table: &Table, name: &str| -> Vec<String> { table.column(name).unwrap().map(str::to_owned).collect() };
    let drawn = read("unstable_modes.csv");
    let unstable: Vec<(String, String, f64)> = text(&drawn, "constraints")
        .into_iter()
        .zip(text(&drawn, "mode"))
        .zip(text(&drawn, "frequency_hz"))
        .map(|((set, mode), hz)| (set, mode, hz.parse().unwrap()))
        .collect();
    // The samples of each scene with a mode in a third octave.
    let mut in_bands: BTreeMap<(String, String, i64), BTreeSet<String>> = BTreeMap::new();
    let scene_of = |row: usize| {
        ["law", "speed", "in_contact", "arrangement"].map(|column| text(&drawn, column)[row].clone()).join(", ")
    };
    for (row, ((set, _, hz), sample)) in unstable.iter().zip(text(&drawn, "sample")).enumerate() {
        let number = (10.0 * hz.log10()).round() as i64;
        in_bands.entry((set.clone(), scene_of(row), number)).or_default().insert(sample);
    }
    let summary = std::fs::read_to_string(out.join("summary.md")).unwrap();
    let set_of = |caption: &str| caption.split(['\u{201c}', '\u{201d}']).nth(1).unwrap().to_owned();
    let number = |label: &str| label.trim_start_matches(char::is_alphabetic).to_owned();
    let mut modes = 0;
    for (caption, rows) in tables_under(&summary, "Every mode that is ever unstable") {
        let set = set_of(caption);
        for row in rows.iter().skip(2).filter(|row| row[1] != "-") {
            let own = unstable.iter().filter(|(of, mode, _)| *of == set && *mode == number(row[0])).map(|(.., hz)| *hz);
            let own: Vec<f64> = own.collect();
            let (hz, digits) = (row[1].parse::<f64>().unwrap(), row[1].split('.').nth(1).map_or(0, str::len));
            let rounding = 0.5 * 10_f64.powi(-(digits as i32));
            let [least, most] =
                [own.iter().fold(f64::INFINITY, |a, b| a.min(*b)), own.iter().fold(0.0, |a, b| b.max(a))];
            assert!(own.is_empty() || (least - rounding..=most + rounding).contains(&hz), "{row:?} {least} {most}");
            modes += usize::from(!own.is_empty());
        }
    }
    assert!(modes > 2, "{summary}");
    let mut reds = 0;
    for (caption, rows) in tables_under(&summary, "In which bands") {
        let set = set_of(caption);
        for row in rows.iter().skip(2).filter(|row| row[0] != "anything") {
            let middle = (10.0 * row[0].parse::<f64>().unwrap().log10()).round();
            let is_here = |hz: f64| (10.0 * hz.log10()).round() == middle;
            let has_any = unstable.iter().any(|(of, _, hz)| *of == set && is_here(*hz));
            let here = in_bands.iter().filter(|((of, _, number), _)| *of == set && *number == middle as i64);
            let most = here.map(|(_, samples)| samples.len() as u64).max().unwrap_or(0);
            let lower = Proportion::of_counts(most, 0, 40).interval(Confidence::P95).lower;
            let is_red = lower > 0.5;
            assert_eq!(row[1] == "red", is_red, "{set}: {row:?} {most}");
            let percent = 100.0 * most as f64 / 40.0;
            assert!(most == 0 && row[3] == "-" || row[3] == format!("{percent:.1}\u{a0}%"), "{set}: {row:?} {most}");
            assert!(row[1] != "green" || !has_any, "{set}: {row:?}");
            reds += usize::from(is_red);
        }
    }
    assert!(reds > 0, "{summary}");
}
