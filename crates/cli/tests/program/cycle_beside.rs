//! What `squeal cycle` says beside its cycles: whether a mode starts or stops growing at an onset.

use super::common::answer;
use super::more_than_modes::oscillators;

/// An oscillator that grows on an island of mu alone: at one of its onsets the mode starts to grow, at the other one it stops.
#[test]
fn an_onset_at_which_a_mode_stops_growing_is_told_as_that() {
    let dir = tempfile::tempdir().unwrap();
    let (case, out) = (dir.path().join("brake.toml"), dir.path().join("cycles"));
    let parameters = "[parameters.mu]\ndistribution = \"constant\"\nvalue = 0.1\n";
    let text = oscillators(
        parameters,
        &[(1.0, "0.45*exp(-((mu-0.5)/0.2)^2)")],
        "load = 100.0\nspeed = 0.5\nstiffness = 2e7\n",
    );
    std::fs::write(&case, text).unwrap();
    let said = answer("cycle", &case, &["--over", "mu=0.38:0.62", "--out", out.to_str().unwrap()]);
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    let (_, list) = page.split_once("<ul class=\"lead\">\n").unwrap();
    let list = list.split("</ul>").next().unwrap();
    for (onset, does) in [("0.4067", "starts to grow"), ("0.5932", "stops growing")] {
        assert!(list.contains(&format!(" {does} at mu = {onset}")), "{list}");
        let line = said.lines().find(|line| line.contains(&format!("onset at mu = {onset}"))).unwrap();
        assert!(line.ends_with(&format!("where it {does}")), "{line}");
    }
}
