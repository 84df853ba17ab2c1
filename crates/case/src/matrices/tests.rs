use std::path::Path;

use cea::{EigenSolver, QrSolver, Workspace};
use nalgebra::{DMatrix, dmatrix};
use rand::{RngExt, SeedableRng};

use super::*;
use crate::CaseFile;

const PAD: &str = r#"
[study]
name = "pad"
samples = 10
seed = 1
[brake]
kind = "matrices"
dofs = ["x", "y"]
[parameters.mu]
unit = "1"
distribution = "uniform"
from = 0.2
to = 0.6
[parameters.w]
distribution = "constant"
value = 2
[[terms]]
name = "structure"
mass = [[1, 0], [0, 1.5]]
stiffness = [[4.0, 1.0], [1.0, 9.0]]
[[terms]]
name = "spin"
family = "gyroscopic"
coefficient = "3*w"
damping = [[0.0, 1.0], [-1.0, 0.0]]
[[contacts]]
name = "pad"
force = { x = 1.0 }
reading = { y = -5.0 }
mu = "mu"
slope = -0.1
[[bodies]]
name = "mass"
dofs = "x-y"
[[constraints]]
name = "none"
fixed = []
[[constraints]]
name = "y"
fixed = "y"
"#;

fn parse(text: &str) -> Result<MatricesCase, CaseError> {
    match CaseFile::parse(Path::new("/nowhere/pad.toml"), text.to_owned())? {
        CaseFile::Matrices(case) => Ok(*case),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_brake_is_what_its_file_says() {
    let case = parse(PAD).unwrap();
    assert_eq!((case.header.name.as_str(), case.header.samples, case.header.seed), ("pad", 10, 1));
    assert_eq!(case.dofs, ["x", "y"]);
    let names: Vec<&str> = case.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    assert_eq!((names, case.parameters[0].unit.as_str()), (vec!["mu", "w"], "1"));
    assert_eq!(case.medians(), [0.4, 2.0]);
    assert_eq!(case.system.families(), ["friction", "structure", "gyroscopic"]);
    assert_eq!(case.bodies, [BodyDofs { name: "mass".into(), dofs: vec![0, 1] }]);
    assert_eq!(case.constraints[1], FixedDofs { name: "y".into(), fixed: vec![1], dashpots: vec![] });
    let at = case.operating_point(&[0.5, 2.0]).unwrap();
    let system = case.system.assemble(&at).unwrap();
    assert_eq!(system.m, dmatrix![1.0, 0.0; 0.0, 1.5]);
    assert_eq!(system.c, dmatrix![-0.1, 6.0; -6.0, 0.0]);
    assert_eq!(system.k, dmatrix![4.0, -1.5; 1.0, 9.0]);
    let drawn = case.draw(&mut StreamRng::seed_from_u64(1)).unwrap();
    assert!((0.2..0.6).contains(&drawn[0]) && drawn[1] == 2.0);
}

#[test]
fn a_constraint_leaves_degrees_of_freedom_out() {
    let case = parse(PAD).unwrap();
    let free = case.brake(&case.constraints[0]).unwrap();
    assert_eq!((&free.system, free.dofs.free()), (&case.system, &[0, 1][..]));
    let held = case.brake(&case.constraints[1]).unwrap();
    assert_eq!(held.dofs.free(), [0]);
    assert_eq!(held.bodies[0].dofs, [0]);
    let system = held.system.assemble(&case.operating_point(&case.medians()).unwrap()).unwrap();
    assert_eq!((system.m, system.c, system.k), (dmatrix![1.0], dmatrix![-0.1], dmatrix![4.0]));
    let only_x = PAD.replace("\"x-y\"", "\"x\"\n[[bodies]]\nname = \"rest\"\ndofs = \"y\"");
    let case = parse(&only_x).unwrap();
    let bodies = case.brake(&case.constraints[1]).unwrap().bodies;
    assert_eq!((bodies.len(), bodies[0].dofs.len(), bodies[1].dofs.len()), (2, 1, 0));
}

#[test]
fn what_is_left_out_has_its_default() {
    let text = "[study]\nname = \"n\"\nsamples = 1\nseed = 0\n[brake]\nkind = \"matrices\"\n[[terms]]\nname = \"all\"\n\
                mass = [[2.0]]\nstiffness = [[1.0]]\n";
    let case = parse(text).unwrap();
    assert_eq!(case.dofs, ["1"]);
    assert_eq!(case.bodies, [BodyDofs { name: "brake".into(), dofs: vec![0] }]);
    assert_eq!(case.constraints, [FixedDofs { name: "none".into(), fixed: vec![], dashpots: vec![] }]);
    assert_eq!(case.operating_point(&[]).unwrap().coefficients, [1.0]);
    assert_eq!(case.system.terms()[0].family, "all");
}

#[test]
fn a_study_is_told_by_what_is_computed_from() {
    let identity = |text: &str| parse(text).unwrap().identity();
    assert_eq!(identity(PAD), identity(&PAD.replace("seed = 1", "seed = 2\n")));
    for (from, to) in [("3*w", "3*w "), ("9.0]]", "9.5]]"), ("to = 0.6", "to = 0.7"), ("\"x-y\"", "[\"y\", \"x\"]")] {
        assert_ne!(identity(PAD), identity(&PAD.replace(from, to)), "{from}");
    }
}

#[test]
fn names_that_move_what_is_read_are_refused() {
    for c in ['\u{202a}', '\u{202e}', '\u{2066}', '\u{2069}', '\u{2028}', '\u{2029}', '\u{7}'] {
        for name in [format!("{c}spin"), format!("sp{c}in"), format!("spin{c}")] {
            let escaped: String = name.chars().map(|c| format!("\\u{:04x}", u32::from(c))).collect();
            let refused = parse(&PAD.replace("\"spin\"", &format!("\"{escaped}\""))).unwrap_err().to_string();
            assert!(refused.contains("marks of direction") && !refused.contains(c), "{refused}");
        }
    }
}

#[test]
fn a_whole_number_beyond_64_bits_is_named() {
    for number in ["99999999999999999999999", "-99999999999999999999999"] {
        let refused = parse(&PAD.replace("to = 0.6", &format!("to = {number}"))).unwrap_err().to_string();
        assert!(refused.contains(&format!("the whole number {number} is too large")), "{refused}");
    }
}

#[test]
fn faults_are_named_in_one_line() {
    for (from, to, expected) in [
        (
            "\"3*w\"",
            "\"3*w^^2\"",
            "terms \"spin\".coefficient = \"3*w^^2\", column 5: unexpected \"^\"; allowed: a number",
        ),
        ("\"3*w\"", "\"3*v\"", "column 3: unknown name \"v\"; allowed: the parameters mu, w; the functions sin"),
        ("\"3*w\"", "\"1/(w - 2)\"", "coefficient = \"1/(w - 2)\" = inf at w = 2; allowed: a finite number"),
        ("\"3*w\"", "true", "line 24: coefficient = true: expected a number or an expression in quotes"),
        ("\"3*w\"", "nan", "terms \"spin\".coefficient = NaN; allowed: a finite number"),
        ("\"3*w\"", "2.0", "parameters.w = used nowhere; allowed: parameters that occur in"),
        ("slope = -0.1", "slope = \"ln(mu - 1)\"", "contacts \"pad\".slope = \"ln(mu - 1)\" = NaN at mu = 0.4"),
        (
            "kind = \"matrices\"",
            "kind = \"beam\"",
            "unknown name `beam`, expected one of `lattice`, `matrices`, `finite-elements`",
        ),
        ("kind = \"matrices\"", "", "brake.kind = missing; allowed: \"lattice\", \"matrices\" or \"finite-elements\""),
        ("kind = \"matrices\"", "kind = \"lattice\"", "unknown field `bodies`"),
        ("samples = 10", "samples = 0", "study.samples = 0; allowed: 1 to"),
        ("seed = 1", "seed = 1\nlaws = []", "unknown field `laws`"),
        ("[\"x\", \"y\"]", "[\"x\"]", "brake.dofs = a list of 1; allowed: 2, one for each row"),
        ("[\"x\", \"y\"]", "[\"x\", \"x\"]", "brake.dofs = x; allowed: each once"),
        ("[\"x\", \"y\"]", "[\"x-1\", \"y\"]", "brake.dofs = \"x-1\"; allowed: letters, digits and _"),
        ("[parameters.w]", "[parameters.pi]", "parameters = \"pi\"; allowed: a letter or _"),
        ("[parameters.w]", "[parameters.\"2w\"]", "parameters = \"2w\"; allowed: a letter or _"),
        ("to = 0.6", "to = 0.1", "parameters.mu.to = 0.1; allowed: at least from = 0.2"),
        ("to = 0.6", "upto = 0.6", "unknown field `upto`"),
        ("unit = \"1\"", "units = \"1\"", "unknown field `units`"),
        ("[[terms]]\nname = \"spin\"", "[[terms]]\nname = \"structure\"", "terms.name = structure; allowed: each once"),
        ("name = \"spin\"", "name = \"\"", "terms.name = \"\"; allowed: 1 to 60 characters"),
        ("family = \"gyroscopic\"", "family = \"a\\nb\"", "terms \"spin\".family = \"a\\nb\"; allowed: 1 to 60"),
        ("family = \"gyroscopic\"", "color = \"red\"", "unknown field `color`"),
        ("mass = [[1, 0], [0, 1.5]]\n", "", "terms = no mass; allowed: a mass in one term or more"),
        ("damping = [[0.0, 1.0], [-1.0, 0.0]]", "", "terms \"spin\" = no matrix; allowed: mass, damping or stiffness"),
        (
            "damping = [[0.0, 1.0], [-1.0, 0.0]]",
            "damping = [[1.0]]",
            "damping = a matrix 1 x 1; allowed: 2 x 2, as the",
        ),
        ("[0, 1.5]]", "[0, 1.5], [0, 0]]", "terms \"structure\".mass = a matrix 3 x 2; allowed: a square matrix"),
        ("[0, 1.5]]", "[0]]", "terms \"structure\".mass = row 2 with 1 numbers; allowed: 2, as in row 1"),
        (
            "[0, 1.5]]",
            "[0, 0]]",
            "terms \"structure\".mass = not symmetric positive definite in row \"y\"; allowed: masses",
        ),
        (
            "[[1, 0], [0, 1.5]]",
            "[[1, 0.2], [0.1, 1.5]]",
            "terms \"structure\".mass = not symmetric positive definite in row \"y\"",
        ),
        (
            "damping = [[0.0, 1.0]",
            "mass = [[-1, 0], [0, 0]]\ndamping = [[0.0, 1.0]",
            "terms \"structure\".mass, terms \"spin\".mass = not symmetric positive definite in row \"x\"",
        ),
        ("[0, 1.5]]", "[0, inf]]", "terms \"structure\".mass = inf; allowed: a finite number"),
        ("mass = [[1, 0], [0, 1.5]]", "mass = []", "terms \"structure\".mass = no entries; allowed: rows of numbers"),
        ("mass = [[1, 0], [0, 1.5]]", "mass = 1.0", "expected rows of numbers, as [[1.0, 0.0], [0.0, 1.0]]"),
        (
            "mass = [[1, 0], [0, 1.5]]",
            "mass = \"M.mtx\"",
            "terms \"structure\".mass = \"M.mtx\": cannot be read: No such",
        ),
        (
            "force = { x = 1.0 }",
            "force = { z = 1.0 }",
            "contacts \"pad\".force.z = \"z\"; allowed: the degrees of freedom x, y",
        ),
        ("force = { x = 1.0 }", "force = {}", "contacts \"pad\".force = {}; allowed: one degree of freedom or more"),
        (
            "force = { x = 1.0 }",
            "force = { x = 0.0, y = -0.0 }",
            "contacts \"pad\".force = 0 throughout; allowed: a number",
        ),
        ("reading = { y = -5.0 }", "reading = { y = 0 }", "contacts \"pad\".reading = 0 throughout; allowed: a number"),
        (
            "reading = { y = -5.0 }",
            "reading = { y = nan }",
            "contacts \"pad\".reading.y = NaN; allowed: a finite number",
        ),
        ("reading = { y = -5.0 }", "", "contacts \"pad\".reading = {}; allowed: the normal force that mu multiplies"),
        ("mu = \"mu\"\n", "", "contacts \"pad\".mu = missing; allowed: an expression, or no reading"),
        (
            "mu = \"mu\"\nslope = -0.1\n",
            "",
            "contacts \"pad\" = neither mu nor slope nor lag; allowed: one of them, or",
        ),
        ("slope = -0.1", "lag = { decay = 5.0, drive = 1.0 }", "missing field `force`"),
        ("slope = -0.1", "lag = { decay = 5.0, drive = 1.0, force = 1.0, mass = 1.0 }", "unknown field `mass`"),
        (
            "slope = -0.1",
            "lag = { decay = 5.0, drive = \"2*mu*\", force = 1.0 }",
            "contacts \"pad\".lag.drive = \"2*mu*\", column 6: ",
        ),
        (
            "slope = -0.1",
            "lag = { decay = \"mu - w\", drive = 1.0, force = 1.0 }",
            "contacts \"pad\".lag.decay = -1.6; allowed: a rate > 0, in 1/s",
        ),
        (
            "slope = -0.1",
            "lag = { decay = 5.0, drive = 1.0, force = \"1/(w - 2)\" }",
            "contacts \"pad\".lag.force = \"1/(w - 2)\" = inf at w = 2; allowed: a finite number",
        ),
        ("\"x-y\"", "\"x\"", "bodies = \"y\" in none; allowed: each degree of freedom in one body"),
        (
            "\"x-y\"",
            "\"y-x\"",
            "bodies \"mass\".dofs = \"y-x\"; allowed: the degrees of freedom x, y, a range \"first-last\"",
        ),
        ("\"x-y\"", "[\"x-y\", \"y\"]", "bodies \"mass\".dofs = \"y\"; allowed: each once"),
        ("\"x-y\"", "[]", "bodies \"mass\".dofs = []; allowed: one degree of freedom or more"),
        (
            "\"x-y\"\n",
            "\"x-y\"\n[[bodies]]\nname = \"b\"\ndofs = \"x\"\n",
            "bodies \"b\".dofs = \"x\", which is in \"mass\" too",
        ),
        (
            "fixed = \"y\"",
            "fixed = \"x-y\"",
            "constraints \"y\".fixed = all; allowed: at most all degrees of freedom but one",
        ),
        ("fixed = []", "fixed = [\"q\"]", "constraints \"none\".fixed = \"q\"; allowed: the degrees of freedom x, y"),
        ("name = \"y\"", "name = \"a/b\"", "constraints.name = \"a/b\"; allowed: 1 to 60 letters, digits, - and _"),
    ] {
        assert!(PAD.contains(from), "{from}");
        let message = parse(&PAD.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(message.starts_with("/nowhere/pad.toml: ") && !message.contains('\n'), "{message}");
        assert!(message.contains(expected), "{message}\nlacks\n{expected}");
    }
}

#[test]
fn a_contact_with_a_lag_has_the_eigenvalues_of_its_states() {
    // LuGre friction about steady sliding: a = sigma0 v / g, b = v g' / g, g = 0.3 + 0.2 e^(-v^2).
    let lag = r#"
[contacts.lag]
decay = "sigma0*v/(0.3 + 0.2*exp(-v^2))"
drive = "-0.4*v^2*exp(-v^2)/(0.3 + 0.2*exp(-v^2))"
force = "2*sigma0"
"#;
    let drawn = r#"
[parameters.sigma0]
distribution = "constant"
value = 5
[parameters.v]
distribution = "uniform"
from = 0.5
to = 1.5
[parameters.w]
"#;
    let text = PAD.replace("slope = -0.1\n", lag).replace("[parameters.w]", drawn);
    let case = parse(&text).unwrap();
    let at = case.operating_point(&case.medians()).unwrap();
    let system = case.brake(&case.constraints[0]).unwrap().system.assemble(&at).unwrap();
    let mut found = QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap().eigenvalues;

    // By hand, with the states x, y, x', y' and z: x' drives z, which holds x back.
    let e = (-1.0_f64).exp();
    let g = 0.3 + 0.2 * e;
    let (a, b, force) = (5.0 / g, -0.4 * e / g, 10.0);
    let by_hand = dmatrix![
        0.0, 0.0, 1.0, 0.0, 0.0;
        0.0, 0.0, 0.0, 1.0, 0.0;
        -4.0, -1.0 + 0.4 * 5.0, 0.0, -6.0, -force;
        -1.0 / 1.5, -9.0 / 1.5, 6.0 / 1.5, 0.0, 0.0;
        0.0, 0.0, b, 0.0, -a
    ];
    for expected in by_hand.complex_eigenvalues().iter() {
        let distance = |at: usize| (found[at] - expected).norm();
        let nearest = (0..found.len()).min_by(|&i, &j| distance(i).total_cmp(&distance(j))).unwrap();
        assert!(distance(nearest) < 1e-12 * a, "{expected} {found:?}");
        found.swap_remove(nearest);
    }
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn matrices_may_stand_in_files_beside_the_case() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pad.toml");
    let banner = "%%MatrixMarket matrix coordinate real symmetric\n";
    std::fs::write(folder.path().join("M.mtx"), format!("{banner}2 2 2\n1 1 1\n2 2 3\n")).unwrap();
    std::fs::write(folder.path().join("bad.mtx"), format!("{banner}2 2 2\n1 1 x\n")).unwrap();
    let text = |file: &str| PAD.replace("[[1, 0], [0, 1.5]]", &format!("{file:?}"));
    let read = |file: &str| {
        std::fs::write(&path, text(file)).unwrap();
        CaseFile::read(&path)
    };
    let CaseFile::Matrices(case) = read("M.mtx").unwrap() else { panic!("a lattice") };
    assert_eq!(case.system.terms()[0].matrices().m, dmatrix![1.0, 0.0; 0.0, 3.0]);
    let message = read("bad.mtx").unwrap_err().to_string();
    assert!(
        message.contains("terms \"structure\".mass = \"bad.mtx\": line 3: value \"x\" is not a number"),
        "{message}"
    );
}

/// Internal nodes of Abaqus have negative numbers: a dash is then no range.
#[test]
fn names_of_rows_may_begin_with_a_dash() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pad.toml");
    let diagonal = |[a, b]: [f64; 2]| format!("-5,1, -5,1, {a}\n7,1, 7,1, {b}\n");
    std::fs::write(folder.path().join("M.mtx"), diagonal([1.0, 1.5])).unwrap();
    std::fs::write(folder.path().join("K.mtx"), diagonal([4.0, 9.0]) + "-5,1, 7,1, 1.0\n7,1, -5,1, 1.0\n").unwrap();
    let text = PAD
        .replace("dofs = [\"x\", \"y\"]\n", "")
        .replace("[[1, 0], [0, 1.5]]", "\"M.mtx\"")
        .replace("[[4.0, 1.0], [1.0, 9.0]]", "\"K.mtx\"")
        .replace("{ x = 1.0 }", "{ \"-5.x\" = 1.0 }")
        .replace("{ y = -5.0 }", "{ \"7.x\" = -5.0 }");
    for (body, fixed) in [("-5.x-7.x", "-5.x"), (" -5.x - 7.x", " -5.x "), ("-5.x-7.x", "7.x")] {
        let text =
            text.replace("\"x-y\"", &format!("{body:?}")).replace("fixed = \"y\"", &format!("fixed = {fixed:?}"));
        let case = match CaseFile::parse(&path, text) {
            Ok(CaseFile::Matrices(case)) => case,
            other => panic!("{other:?}"),
        };
        assert_eq!(
            (case.bodies[0].dofs.as_slice(), case.constraints[1].fixed.as_slice()),
            (&[0, 1][..], &[usize::from(fixed == "7.x")][..])
        );
    }
}

#[test]
fn a_lattice_needs_not_say_so() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
    assert!(matches!(CaseFile::read(&path), Ok(CaseFile::Lattice(_))));
    let text = std::fs::read_to_string(&path).unwrap();
    let said = format!("[brake]\nkind = \"lattice\"\n{text}");
    assert!(matches!(CaseFile::parse(&path, said), Ok(CaseFile::Lattice(_))));
}

/// Distributions with a value that has a probability of its own, and some without.
const WITH_ATOMS: [&str; 4] = [
    "distribution = \"discrete\"\nvalues = [0.2, 0.6]",
    "distribution = \"discrete\"\nvalues = [0.2, 0.6]\nweights = [999, 1]",
    "distribution = \"uniform\"\nfrom = 0.3\nto = 0.3",
    "distribution = \"log-uniform\"\nfrom = 0.3\nto = 0.3",
];
const SMOOTH: [&str; 3] = [
    "distribution = \"empirical\"\nvalues = [0.2, 0.4, 0.5, 0.6]",
    "distribution = \"triangular\"\nfrom = 0.2\nmode = 0.2\nto = 0.6",
    "distribution = \"normal\"\nmean = 0.4\ndeviation = 0.1\nat_least = 0.1\nat_most = 0.5",
];

/// A correlated parameter keeps its distribution; one whose values have probabilities of their own would give others another one.
#[test]
fn values_with_a_probability_of_their_own_are_not_correlated_and_are_drawn_alone() {
    const UNIFORM: &str = "distribution = \"uniform\"\nfrom = 0.2\nto = 0.6";
    let with = |distribution: &str| {
        PAD.replace(UNIFORM, distribution).replace("\"constant\"\nvalue = 2", "\"uniform\"\nfrom = 1\nto = 2")
    };
    let correlated =
        |text: &str| format!("{text}[correlation]\nparameters = [\"mu\", \"w\"]\nmatrix = [[1.0, 0.5], [0.5, 1.0]]\n");
    for distribution in WITH_ATOMS {
        let text = with(distribution);
        match parse(&correlated(&text)) {
            Err(error) => {
                let error = error.to_string();
                let is_named = error.contains("correlation.parameters = \"mu\", wh");
                assert!(is_named && error.contains("; allowed: parameters none of whose values"), "{error}");
            }
            Ok(_) => panic!("{distribution}"),
        }
        assert!(parse(&text).is_ok(), "{distribution}");
    }
    let repeated = "distribution = \"empirical\"\nvalues = [0.2, 0.4, 0.6, 0.4, 0.4]";
    assert!(parse(&with(repeated)).is_ok());
    let error = parse(&correlated(&with(repeated))).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.contains("\"mu\", whose value 0.4 is there 3 times"), "{error}");
    for distribution in SMOOTH {
        assert!(parse(&correlated(&with(distribution))).is_ok(), "{distribution}");
    }
}

#[test]
fn friction_that_drives_the_sliding_is_said() {
    let notes = |text: &str| parse(text).unwrap().header.notes;
    assert_eq!(notes(PAD), [""; 0]);
    // Of every draw, and of some alone.
    let of_all = notes(&PAD.replace("mu = \"mu\"", "mu = \"-mu\""));
    assert!(of_all.len() == 1 && of_all[0].contains("contacts \"pad\".mu is -0.4 at the medians"), "{of_all:?}");
    let of_some = notes(&PAD.replace("mu = \"mu\"", "mu = \"mu - 0.3\""));
    assert!(of_some.len() == 1 && of_some[0].contains("at mu = 0.20"), "{of_some:?}");
}

#[test]
fn loads_speeds_and_springs_of_contacts_are_positive() {
    for key in ["load", "speed", "stiffness"] {
        let with = |value: &str| parse(&PAD.replace("slope = -0.1", &format!("slope = -0.1\n{key} = {value}")));
        assert!(with("1.0").is_ok());
        for value in ["0.0", "-1.0", "\"mu - 1\""] {
            let error = with(value).unwrap_err().to_string();
            assert!(error.contains(&format!("contacts \"pad\".{key} = ")) && error.contains("a number > 0"), "{error}");
        }
    }
}

/// Notes of a case that ask whether it means what it says.
fn questions(case: &CaseFile) -> Vec<&String> {
    case.header().notes.iter().filter(|note| note.ends_with('?')).collect()
}

#[test]
fn a_coefficient_of_friction_that_no_material_has_is_asked_about() {
    let path = Path::new("/nowhere/pad.toml");
    let two_by_two =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/two-by-two.toml")).unwrap();
    for (scale, is_asked) in [(1.0, false), (2.0, false), (6.0, true), (100.0, true), (1e6, true)] {
        // Medians 0.4 and 0.5, by a parameter, by a number, and in a product with what may be a part of the reading.
        let drawn = PAD.replace("from = 0.2\nto = 0.6", &format!("from = {:?}\nto = {:?}", 0.2 * scale, 0.6 * scale));
        let drawn = drawn.replace("mu = \"mu\"", "mu = \" mu \"");
        let number =
            PAD.replace("[parameters.mu]\nunit = \"1\"\ndistribution = \"uniform\"\nfrom = 0.2\nto = 0.6\n", "");
        let number = number.replace("mu = \"mu\"", &format!("mu = {:?}", 0.5 * scale));
        let friction = ["mu = {", "mu_s = {", "mu_k = {"].map(|key| {
            let median = match key {
                "mu_s = {" => 0.55,
                _ => 0.5,
            } * scale;
            let line = two_by_two.lines().find(|line| line.starts_with(key)).unwrap();
            two_by_two.replace(line, &format!("{key} distribution = \"constant\", value = {median:?} }}"))
        });
        for (text, field) in [
            (&drawn, "contacts \"pad\".mu"),
            (&number, "contacts \"pad\".mu"),
            (&friction[0], "friction.mu"),
            (&friction[1], "friction.mu_s"),
        ] {
            let case = CaseFile::parse(path, text.clone()).unwrap();
            let asked = questions(&case);
            assert_eq!(asked.len(), usize::from(is_asked), "{scale} {field}: {asked:?}");
            let expected = format!("{field} = ");
            assert!(
                asked.iter().all(|note| note.contains(&expected) && note.ends_with("rarely above 2; a percentage?")),
                "{asked:?}"
            );
        }
        let product = drawn.replace("mu = \" mu \"", "mu = \"mu*w\"");
        assert!(questions(&CaseFile::parse(path, product).unwrap()).is_empty());
    }
}

/// Springs and masses in each other's places, of structures whose frequencies are those of machines; not so structures without units.
#[test]
fn mass_and_stiffness_in_each_other_s_places_are_asked_about() {
    let rng = &mut montecarlo::stream(3, 0);
    for (lowest, is_asked) in [(1.0, true), (30.0, true), (1e3, true), (1e5, true), (0.1, false)] {
        for n in 1..6_usize {
            let random = DMatrix::<f64>::from_fn(n, n, |_, _| rng.random_range(-1.0..1.0));
            let spread = &random * random.transpose() + DMatrix::identity(n, n);
            let least = spread.symmetric_eigenvalues().min();
            let hertz = std::f64::consts::TAU * lowest;
            let (mass, stiffness) = (DMatrix::identity(n, n) * 0.7, spread * (1.01 * 0.7 * hertz * hertz / least));
            let rows = |of: &DMatrix<f64>| {
                format!("{:?}", of.row_iter().map(|row| row.iter().copied().collect::<Vec<_>>()).collect::<Vec<_>>())
            };
            let case = |mass: &DMatrix<f64>, stiffness: &DMatrix<f64>| {
                CaseFile::parse(Path::new("swap.toml"), format!(
                    "[study]\nname = \"swap\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\n[[terms]]\nname = \"m\"\nmass = {}\n\
                     [[terms]]\nname = \"k\"\nstiffness = {}\n", rows(mass), rows(stiffness)
                )).unwrap()
            };
            let (right, swapped) = (case(&mass, &stiffness), case(&stiffness, &mass));
            assert!(questions(&right).is_empty(), "{:?}", questions(&right));
            let asked = questions(&swapped);
            assert_eq!(asked.len(), usize::from(is_asked), "{lowest} Hz, n = {n}: {asked:?}");
            assert!(
                asked
                    .iter()
                    .all(|note| note.ends_with("below 0.03 Hz at the medians: are mass and stiffness swapped?"))
            );
        }
    }
}

#[test]
fn no_shipped_case_is_asked_about() {
    let mut read = 0;
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases")).unwrap() {
        let path = entry.unwrap().path();
        // A list of variants is no case.
        if path.extension().is_some_and(|of| of == "toml")
            && let Ok(case) = CaseFile::read(&path)
        {
            assert!(questions(&case).is_empty(), "{}: {:?}", path.display(), questions(&case));
            read += 1;
        }
    }
    assert!(read >= 4, "{read}");
}
