//! Brakes of which the modes one by one do not tell what squeals: modes that alternate from draw to draw, and modes whose names are always open.

use std::fmt::Write as _;

use output::Table;

use super::common::run;

/// Case of oscillators of two degrees of freedom without coupling to each other: of each the factor of its stiffness, and its friction.
pub(super) fn oscillators(parameters: &str, of_each: &[(f64, &str)], more: &str) -> String {
    let size = 2 * of_each.len();
    let matrix = |entry: &dyn Fn(usize, usize) -> f64| {
        let row = |i: usize| {
            let of = |j: usize| if i / 2 == j / 2 { entry(i, j) } else { 0.0 };
            format!("[{}]", (0..size).map(|j| format!("{:?}", of(j))).collect::<Vec<_>>().join(", "))
        };
        format!("[{}]", (0..size).map(row).collect::<Vec<_>>().join(", "))
    };
    let stiffness = |i: usize, j: usize| {
        let of = if i == j { [2.2e7, 2.6e7][i % 2] } else { -5e6 };
        of * of_each[i / 2].0
    };
    let damping = |i: usize, j: usize| if i == j { [50.0, 70.0][i % 2] * of_each[i / 2].0.sqrt() } else { 0.0 };
    let dofs: Vec<String> = (1..=size).map(|at| format!("\"q{at}\"")).collect();
    let mut text = format!(
        "[study]\nname = \"m\"\nsamples = 400\nseed = 1\n\n[brake]\nkind = \"matrices\"\ndofs = [{}]\n\n{parameters}\n\
         [[terms]]\nname = \"s\"\nmass = {}\ndamping = {}\nstiffness = {}\nsymmetry = \"whole\"\n",
        dofs.join(", "),
        matrix(&|i, j| f64::from(u8::from(i == j))),
        matrix(&damping),
        matrix(&stiffness)
    );
    for (at, (factor, mu)) in of_each.iter().enumerate() {
        let _ = write!(
            text,
            "\n[[contacts]]\nname = \"c{at}\"\nforce = {{ q{} = 1.0 }}\nreading = {{ q{} = {:?} }}\nmu = \"{mu}\"\n",
            2 * at + 1,
            2 * at + 2,
            1.6e7 * factor
        );
    }
    text + more
}

/// Two oscillators, of which one squeals for x < 0 and the other one for x > 0: each in half of the draws, some in all of them, which is what a reader asks.
#[test]
fn a_brake_that_squeals_in_every_draw_is_told_as_that_whichever_mode_does() {
    let x = "[parameters.x]\ndistribution = \"uniform\"\nfrom = -1.0\nto = 1.0\n";
    // Anything in all draws, and in half of them by either of two modes that squeal together, which single modes tell.
    for (friction, anything, light) in
        [(["0.37-0.3*x", "0.37+0.3*x"], Some("1.0000"), "red"), (["0.37+0.3*x", "0.37+0.3*x"], None, "amber")]
    {
        let dir = tempfile::tempdir().unwrap();
        let (case, out) = (dir.path().join("brake.toml"), dir.path().join("study"));
        std::fs::write(&case, oscillators(x, &[(1.0, friction[0]), (9.0, friction[1])], "")).unwrap();
        let text = run(&case, &out, &["--keep-samples"]);
        let panels = Table::read(&out.join("panels.csv")).unwrap().unwrap();
        let unstable: u64 = panels.column("any_unstable").unwrap().next().unwrap().parse().unwrap();
        assert_eq!(unstable == 400, anything.is_some(), "{unstable}");
        let line = text.lines().find(|line| line.starts_with("anything: unstable in "));
        assert_eq!(line.map(|line| line.split(' ').nth(3).unwrap()), anything, "{text}");
        for page in ["summary.md", "report.html"] {
            let page = std::fs::read_to_string(out.join(page)).unwrap().replace('\u{a0}', " ");
            assert_eq!(
                page.contains("is unstable in 100.0 % (99.0 to 100.0) of the samples"),
                anything.is_some(),
                "{page}"
            );
        }
        let summary = std::fs::read_to_string(out.join("summary.md")).unwrap();
        let row = summary.lines().find(|line| line.starts_with("| anything |")).unwrap();
        assert_eq!(row.split(" | ").nth(1), Some(light), "{row}");
    }
}

/// Two equal oscillators, of which every unstable mode is "1|2". Where it is unstable no table of modes by name tells, and nothing says that it is where the modes are
/// at the medians; a measured frequency is open where some mode of its third octave squeals, and missed far from all that does.
#[test]
fn a_mode_whose_names_are_always_open_is_nowhere_for_sure() {
    let dir = tempfile::tempdir().unwrap();
    let parameters = "[parameters.mu]\ndistribution = \"normal\"\nmean = 0.36\ndeviation = 0.02\nat_least = 0.0\n";
    let (case, out) = (dir.path().join("brake.toml"), dir.path().join("study"));
    let measured = "\n[measured]\nfrequencies = [758.0, 775.0, 3000.0]\ntolerance = 8.0\n";
    std::fs::write(&case, oscillators(parameters, &[(1.0, "mu"), (1.0, "mu")], measured)).unwrap();
    let text = run(&case, &out, &["--keep-samples"]);
    let drawn = Table::read(&out.join("unstable_modes.csv")).unwrap().unwrap();
    assert!(drawn.column("mode").unwrap().all(|mode| mode == "1|2") && drawn.column("mode").unwrap().count() > 100);
    let table = Table::read(&out.join("measured.csv")).unwrap().unwrap();
    let of = |column: &str| -> Vec<String> { table.column(column).unwrap().map(str::to_owned).collect() };
    assert_eq!(of("found"), ["open", "open", "missed", "not placed", "not placed"], "{text}");
    assert!(of("frequency_hz").iter().all(String::is_empty), "{text}");
    for mode in ["1", "2"] {
        let line = text.lines().find(|line| line.starts_with(&format!("mode {mode} at "))).unwrap();
        assert!(line.contains(" Hz at the medians, where unstable not known: unstable in "), "{line}");
    }
    let summary = std::fs::read_to_string(out.join("summary.md")).unwrap();
    let (_, every) = summary.split_once("## Every mode that is ever unstable").unwrap();
    let rows: Vec<Vec<&str>> = every
        .lines()
        .filter(|line| line.starts_with("| 1 |") || line.starts_with("| 2 |"))
        .map(|line| line.split(" | ").collect())
        .collect();
    assert!(rows.len() >= 2 && rows.iter().take(2).all(|row| row[1] == "-" && row[2] != "-"), "{rows:?}");
}

/// Two equal oscillators that squeal in every draw under the names "1|2", and one with a name that squeals in some: of the two nothing is known by name, so that they may grow faster.
#[test]
fn the_fastest_of_the_modes_with_sure_names_is_not_called_the_fastest_of_all() {
    let x = "[parameters.x]\ndistribution = \"uniform\"\nfrom = -1.0\nto = 1.0\n";
    for (pair, among) in [("0.5", " of the modes whose names are sure"), ("0.1", "")] {
        let dir = tempfile::tempdir().unwrap();
        let (case, out) = (dir.path().join("brake.toml"), dir.path().join("study"));
        let of_each = [(1.0, pair), (1.0, pair), (9.0, "0.27-0.2*x")];
        std::fs::write(&case, oscillators(x, &of_each, "")).unwrap();
        run(&case, &out, &[]);
        let summary = std::fs::read_to_string(out.join("summary.md")).unwrap();
        assert!(summary.contains(&format!("The fastest growing{among} is mode ")), "{summary}");
        assert_eq!(summary.contains("may grow faster."), !among.is_empty(), "{summary}");
    }
}

/// Two equal oscillators that squeal, each of whose modes is asked why, under its own rank.
#[test]
fn equal_modes_have_reasons_under_their_own_ranks() {
    let dir = tempfile::tempdir().unwrap();
    let case = dir.path().join("brake.toml");
    let parameters = "[parameters.mu]\ndistribution = \"constant\"\nvalue = 0.45\n";
    std::fs::write(&case, oscillators(parameters, &[(1.0, "mu"), (1.0, "mu")], "")).unwrap();
    let said = super::common::answer("cea", &case, &["--why"]);
    let of = |line: &str| line.strip_prefix("Why mode ").map(|rest| rest.split(' ').next().unwrap().to_owned());
    let mut ranks: Vec<String> = said.lines().filter_map(of).collect();
    assert_eq!(ranks.len(), 2, "{said}");
    ranks.dedup();
    assert_eq!(ranks.len(), 2, "{said}");
}
