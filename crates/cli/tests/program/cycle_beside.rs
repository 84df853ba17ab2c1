//! Sentences of `squeal cycle` beside its cycles: whether a mode starts or stops growing at an onset, and that a brake diverges too.

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

/// Beside an oscillator that flutters for mu > 0.37, a mass on a spring 1e6 (0.3 - mu): its real eigenvalue is known in closed form.
#[test]
fn a_brake_that_diverges_beside_its_cycles_is_told_as_that() {
    let dir = tempfile::tempdir().unwrap();
    let case = |mu: f64| {
        let path = dir.path().join(format!("brake-{mu}.toml"));
        let text = format!(
            "[study]\nname = \"m\"\nsamples = 10\nseed = 1\n\n[brake]\nkind = \"matrices\"\ndofs = [\"q1\", \"q2\", \"q3\"]\n\n\
             [parameters.mu]\ndistribution = \"constant\"\nvalue = {mu}\n\n[[terms]]\nname = \"s\"\nsymmetry = \"whole\"\n\
             mass = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n\
             damping = [[50.0, 0.0, 0.0], [0.0, 70.0, 0.0], [0.0, 0.0, 3000.0]]\n\
             stiffness = [[2.2e7, -5e6, 0.0], [-5e6, 2.6e7, 0.0], [0.0, 0.0, 0.0]]\n\n\
             [[terms]]\nname = \"d\"\ncoefficient = \"0.42-mu\"\nsymmetry = \"whole\"\n\
             stiffness = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1e6]]\n\n\
             [[contacts]]\nname = \"c\"\nforce = {{ q1 = 1.0 }}\nreading = {{ q2 = 1.6e7 }}\nmu = \"mu\"\nload = 100.0\nspeed = 0.5\nstiffness = 2e7\n"
        );
        std::fs::write(&path, text).unwrap();
        path
    };
    let growth = |mu: f64| -1500.0 + (1500.0_f64.powi(2) - 1e6 * (0.42 - mu)).sqrt();
    for (mu, diverges) in [(0.4, false), (0.45, true)] {
        let said = answer("cycle", &case(mu), &[]);
        assert_eq!(said.contains("DIVERGES"), diverges, "{said}");
        let growth = format!("a real eigenvalue grows by {} 1/s", output::significant(growth(mu), 6));
        assert_eq!(said.contains(&growth), diverges, "{growth}: {said}");
    }
    let said = answer("cycle", &case(0.4), &["--over", "mu=0.3:0.44"]);
    assert!(said.contains("the brake DIVERGES too") && said.contains("it starts to diverge at 0.42"), "{said}");
    assert!(!answer("cycle", &case(0.4), &["--over", "mu=0.3:0.4"]).contains("DIVERGES"));
}
