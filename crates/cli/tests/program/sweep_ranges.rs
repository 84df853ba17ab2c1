//! Ranges that the page of a sweep says, beside the closed form of brakes whose masses move apart from each other.

use std::fmt::Write as _;

use super::common::answer;

/// Case of masses without coupling, each on a spring 100 times a function of mu, and the damping 2.
fn masses(springs: &[&str]) -> String {
    let rows = |entries: &dyn Fn(usize) -> f64| {
        let row = |at: usize| {
            let all: Vec<String> = (0..springs.len())
                .map(|column| if column == at { format!("{:?}", entries(at)) } else { "0.0".into() })
                .collect();
            format!("[{}]", all.join(", "))
        };
        format!("[{}]", (0..springs.len()).map(row).collect::<Vec<_>>().join(", "))
    };
    let dofs: Vec<String> = (1..=springs.len()).map(|at| format!("\"q{at}\"")).collect();
    let mut text = format!(
        "[study]\nname = \"m\"\nsamples = 10\nseed = 1\n\n[brake]\nkind = \"matrices\"\ndofs = [{}]\n\n\
         [parameters.mu]\ndistribution = \"constant\"\nvalue = 0.1\n\n\
         [[terms]]\nname = \"s\"\nmass = {}\ndamping = {}\nsymmetry = \"whole\"\n",
        dofs.join(", "),
        rows(&|_| 1.0),
        rows(&|_| 2.0)
    );
    for (at, spring) in springs.iter().enumerate() {
        let stiffness = rows(&|other| if other == at { 100.0 } else { 0.0 });
        let _ = write!(
            text,
            "\n[[terms]]\nname = \"k{at}\"\ncoefficient = \"{spring}\"\nstiffness = {stiffness}\nsymmetry = \"whole\"\n"
        );
    }
    text
}

/// The sentences with which the page of a sweep of mu begins.
fn lead(case: &str) -> Vec<String> {
    let dir = tempfile::tempdir().unwrap();
    let (path, out) = (dir.path().join("brake.toml"), dir.path().join("sweep"));
    std::fs::write(&path, case).unwrap();
    answer("sweep", &path, &["--over", "mu=0.1:1.2", "--out", out.to_str().unwrap()]);
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    let (_, list) = page.split_once("<ul class=\"lead\">\n").unwrap();
    let list = list.split("</ul>").next().unwrap();
    list.lines().map(|line| line.trim_start_matches("<li>").trim_end_matches("</li>").to_owned()).collect()
}

/// A mass diverges exactly where its spring is negative, so that the numbers of real eigenvalues that grow are known everywhere.
#[test]
fn ranges_of_divergence_are_those_in_which_any_real_eigenvalue_grows() {
    for (springs, brake, diverging) in [
        (
            ["0.5-mu", "20*(mu-0.7)*(mu-0.9)", "4"],
            "from mu = 0.5 on",
            "from mu = 0.5 on, by 2 eigenvalues from mu = 0.7 to 0.9",
        ),
        (
            ["mu-0.5", "0.3-mu", "4"],
            "over the whole range",
            "over the whole range, by 2 eigenvalues from mu = 0.3 to 0.5",
        ),
        (["-1", "4+mu", "5"], "over the whole range", ""),
        (["mu-0.5", "0.8-mu", "4"], "up to mu = 0.5 and from mu = 0.8 on", "up to mu = 0.5 and from mu = 0.8 on"),
        (["mu-0.5", "mu-0.6", "4"], "up to mu = 0.6", "up to mu = 0.6, by 2 eigenvalues up to mu = 0.5"),
    ] {
        let said = lead(&masses(&springs));
        let has = |sentence: String| assert!(said.contains(&sentence), "{springs:?}: {sentence}: {said:#?}");
        has(format!("The brake is unstable {brake}."));
        let diverging = if diverging.is_empty() { "over the whole range" } else { diverging };
        has(format!("The brake by divergence (a real eigenvalue, no vibration) is unstable {diverging}."));
    }
}

/// Two equal oscillators, whose modes cannot be told apart, grow from one value of mu to another, and none does before or beyond.
#[test]
fn ranges_of_equal_modes_hold_for_both() {
    let mut case = String::from(
        "[study]\nname = \"m\"\nsamples = 10\nseed = 1\n\n[brake]\nkind = \"matrices\"\ndofs = [\"q1\", \"q2\", \"q3\", \"q4\"]\n\n\
         [parameters.mu]\ndistribution = \"constant\"\nvalue = 0.1\n\n[[terms]]\nname = \"s\"\nsymmetry = \"whole\"\n\
         mass = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]\n\
         damping = [[50.0, 0.0, 0.0, 0.0], [0.0, 70.0, 0.0, 0.0], [0.0, 0.0, 50.0, 0.0], [0.0, 0.0, 0.0, 70.0]]\n\
         stiffness = [[2.2e7, -5e6, 0.0, 0.0], [-5e6, 2.6e7, 0.0, 0.0], [0.0, 0.0, 2.2e7, -5e6], [0.0, 0.0, -5e6, 2.6e7]]\n",
    );
    for at in [1, 3] {
        let _ = write!(
            case,
            "\n[[contacts]]\nname = \"c{at}\"\nforce = {{ q{at} = 1.0 }}\nreading = {{ q{} = 1.6e7 }}\n\
             mu = \"0.45*exp(-((mu-0.5)/0.2)^2)\"\n",
            at + 1
        );
    }
    let said = lead(&case);
    assert!(said.contains(&"The brake is unstable from mu = 0.406791 to 0.593209.".to_owned()), "{said:#?}");
    let is_of_mode = |sentence: &&String| sentence.starts_with("Mode ");
    for sentence in said.iter().filter(is_of_mode) {
        assert!(sentence.contains("from mu = 0.406791 to 0.593209"), "{said:#?}");
    }
    assert!(said.iter().any(|sentence| sentence.starts_with("Mode ")), "{said:#?}");
    assert!(!said.iter().any(|sentence| sentence.contains("up to mu")), "{said:#?}");
}
