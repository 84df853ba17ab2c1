//! Samples that fail are counted and listed, and are no data.

use crate::common::{SMALL, replaced, run};

#[test]
fn failed_samples_are_listed_and_missing_from_every_count() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("brake.toml"), folder.path().join("out"));
    // Where the inclined springs lean with the sliding, very much friction lifts an oscillator off in static equilibrium.
    let text = replaced(SMALL, "per_contact = 600.0", "equilibrium = 600.0");
    let text = replaced(&text, "lean = \"against\"", "lean = \"along\"");
    let text = replaced(&text, "mean = 0.60, deviation = 0.2", "mean = 4.0, deviation = 2.0");
    std::fs::write(&case, text).unwrap();
    let said = run(&case, &out, &[]);

    let mut failures = csv::Reader::from_path(out.join("failures.csv")).unwrap();
    let failures: Vec<csv::StringRecord> = failures.records().map(Result::unwrap).collect();
    assert!(failures.iter().all(|row| row[2].contains("lifts off")), "{failures:?}");
    let manifest: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("manifest.json")).unwrap()).unwrap();
    assert_eq!(manifest["failures"], failures.len());
    assert!(said.contains(&format!("{} failures", failures.len())), "{said}");

    let mut panels = csv::Reader::from_path(out.join("panels.csv")).unwrap();
    let (mut partly, mut solved) = (0, 0);
    for panel in panels.records().map(Result::unwrap) {
        let [constraints, law, speed] = [&panel[0], &panel[1], &panel[2]];
        let arrangements: u64 = panel[4].parse().unwrap();
        let of_panel: u64 = panel[5].parse().unwrap();
        // One line per scene, which stands for all arrangements of its class.
        let scene = format!("{constraints}, {law}, ");
        let speed = if speed == "all" { "all speeds" } else { speed };
        let in_contact = |row: &csv::StringRecord| {
            row[1].split("contact ").nth(1).unwrap().split(", ").next().unwrap().split([',', '+', '-', ' ']).count()
        };
        let failed = failures.iter().filter(|row| {
            row[1].starts_with(&scene) && row[1].ends_with(speed) && in_contact(row).to_string() == panel[3]
        });
        let failed = failed.count() as u64;
        assert!(of_panel <= 40 * arrangements && of_panel + failed <= 40 * arrangements, "{panel:?}");
        assert_eq!(of_panel == 40 * arrangements, failed == 0, "{panel:?}");
        partly += u64::from(failed > 0 && of_panel > 0);
        solved += of_panel;
    }
    assert!(partly > 0 && solved > 0, "some samples fail and some do not");
}
