use std::path::{Path, PathBuf};

use formats::Dof;
use linsys::{ChannelGain, OperatingPoint};

use super::FiniteElementCase;
use crate::CaseFile;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad")
}

fn text() -> String {
    std::fs::read_to_string(folder().join("disc-pad.toml")).unwrap()
}

fn parse(text: String) -> Result<FiniteElementCase, String> {
    match CaseFile::parse(&folder().join("changed.toml"), text).map_err(|error| error.to_string())? {
        CaseFile::FiniteElements(case) => Ok(*case),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_shipped_case_is_the_brake_that_its_readme_describes() {
    let case = parse(text()).unwrap();
    let contact = case.contact.as_ref().unwrap();
    assert_eq!((case.dofs.len(), contact.patches.len(), case.system.channels().len()), (2349, 9, 54));
    assert!(contact.patches.iter().all(|patch| patch.pairs.len() == 3 && patch.load == 156.0));
    // Patches 1 to 3 at 100 mm, 4 to 6 at 119 mm and 7 to 9 at 138 mm.
    for (at, patch) in contact.patches.iter().enumerate() {
        let expected = [100.0, 119.0, 138.0][at / 3] / 119.0;
        assert!(patch.speeds.iter().all(|speed| (speed - expected).abs() < 1e-7), "{:?}", patch.speeds);
    }
    assert_eq!(contact.panels.iter().map(|(n, all)| (*n, all.len())).collect::<Vec<_>>(), [(9, 1), (8, 9)]);
    // Nine nodes at each end of the backplate.
    assert_eq!(case.constraints[1].fixed.len(), 18);
    assert!(case.constraints[1].fixed.iter().all(|&row| case.dofs[row].direction == 3));
}

#[test]
fn friction_of_a_pair_is_the_matrix_of_the_textbook() {
    // Force mu N t on the pad's node and -mu N t on the disc's, N = k (d_z - p_z), t = (-y, x) / r of that place.
    let case = parse(text()).unwrap();
    let patch = &case.contact.as_ref().unwrap().patches[4];
    let [pad, disc] = patch.pairs[1];
    let point = |mu: f64| {
        let mut channels = vec![ChannelGain::default(); case.system.channels().len()];
        channels[patch.channels.start + 1] = ChannelGain::proportional(mu);
        let mut coefficients = vec![0.0; case.system.terms().len()];
        coefficients[2 + 4] = 1.0;
        OperatingPoint { coefficients, channels }
    };
    let k = nalgebra::DMatrix::from(&case.system.assemble(&point(0.3)).unwrap().k);
    let row = |node: i64, direction: u32| case.dofs.iter().position(|dof| *dof == Dof { node, direction }).unwrap();
    let mesh = case.mesh.as_ref().unwrap();
    let [x, y, _] = mesh.nodes.iter().find(|node| node.label == pad).unwrap().position;
    let (r, stiffness) = (x.hypot(y), 4.05e8 / 27.0);
    for (direction, t) in [(1, -y / r), (2, x / r)] {
        for (node, sign) in [(pad, 1.0), (disc, -1.0)] {
            let found = [k[(row(node, direction), row(disc, 3))], k[(row(node, direction), row(pad, 3))]];
            let expected = [-sign * 0.3 * stiffness * t, sign * 0.3 * stiffness * t];
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {expected:?}");
        }
    }
    assert_eq!(k[(row(pad, 3), row(disc, 3))], -stiffness);
}

#[test]
fn what_only_other_laws_depend_on_may_be_left_out() {
    let (before, rest) = text().split_once("[friction]").map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    let mu = rest.lines().find(|line| line.starts_with("mu =")).unwrap();
    let laws = before.lines().find(|line| line.starts_with("laws =")).unwrap();
    let before = before.replace(laws, "laws = [\"amontons-coulomb\"]");
    let before = &before[..before.find("[[speeds]]").unwrap()];
    let after = &rest[rest.find("[reduction]").unwrap()..];
    let written = format!("{before}[friction]\n{mu}\n{after}");
    let across = written.replace("load = 468.0", "load = 468.0\nlateral = \"vector\"");
    let refused = parse(across).unwrap_err();
    assert!(refused.contains("speeds = missing; allowed: a range of speed"), "{refused}");
    // Without a speed nothing is said of friction across the sliding, and there is none.
    let contact = parse(written).unwrap().contact.unwrap();
    assert!(!contact.is_lateral);
    assert_eq!(contact.friction.mu, parse(text()).unwrap().contact.unwrap().friction.mu);
}

#[test]
fn faults_are_one_line_with_file_field_value_and_what_is_allowed() {
    let faults = [
        (
            "nodes = \"PADBACK\"",
            "nodes = \"PADBAK\"",
            "holders \"caliper\".nodes = \"PADBAK\"; allowed: the number of a node",
        ),
        ("tolerance = 1e-6", "tolerance = -1.0", "contact.tolerance = -1; allowed: a distance, > 0"),
        ("disc = \"DISCFACE\"", "disc = \"PADBACK\"", "contact.pad = node"),
        (
            "disc = \"DISCFACE\"",
            "disc = [\"DISCFACE\", \"PADFACE\"]",
            "at itself, in contact.disc too; allowed: one node of the disc next to each",
        ),
        (
            "normal = [0.0, 0.0, 1.0]",
            "normal = [0.0, 0.0, 0.0]",
            "contact.normal = [0.0, 0.0, 0.0]; allowed: a direction",
        ),
        (
            "normal = [0.0, 0.0, 1.0]",
            "normal = [0.0, 0.0, -1.0]",
            "contact.normal = [0.000, 0.000, -1.000], which by 16 of the 16 faces of the pad at the contact does not point into it; \
             allowed: a direction from the disc into the pad, about [0.000, 0.000, 1.000]",
        ),
        ("\"PATCH8\", \"PATCH9\"]", "\"PATCH8\"]", "contact.patches = node"),
        ("\"PATCH8\", \"PATCH9\"]", "\"PATCH8\", \"PADFACE\"]", "contact.patches = node"),
        ("fixed = [\"BACKENDS.z\"]", "fixed = [\"BACKENDS.w\"]", "\"BACKENDS.w\"; allowed: SET, SET.z, 1042 or 1042.z"),
        (
            "fixed = [\"BACKENDS.z\"]",
            "fixed = [\"DISCINNER.z\"]",
            "allowed: a degree of freedom that the matrices have",
        ),
        ("mesh = \"disc-pad.inp\"", "mesh = \"disc-pad.sti.gz\"", "brake.mesh"),
        (
            "stiffness = \"disc-pad.sti.gz\"",
            "stiffness = \"none.sti.gz\"",
            "terms \"structure\".stiffness = \"none.sti.gz\": cannot be read",
        ),
        ("mass = \"disc-pad.mas.gz\"", "", "terms = no mass; allowed: a mass in one term or more"),
        (
            "frequencies = [500.0, 8000.0]",
            "frequencies = [8000.0, 500.0]",
            "reduction.frequencies = [8000.0, 500.0]; allowed",
        ),
        ("growth = [-500.0, 3000.0]", "growth = [10.0, 3000.0]", "reduction.growth"),
        ("residual = 1e-8", "residual = 1.0", "reduction.residual = 1; allowed: 1e-12 to 1e-3"),
        ("in_contact = [9, 8]", "in_contact = [10]", "contact.in_contact = 10; allowed: 1 to 9"),
        (
            "alpha = { distribution",
            "# alpha = { distribution",
            "friction.alpha = missing; allowed: a distribution, as velocity-dependent friction has it",
        ),
        ("load = 468.0", "load = nan", "contact.load = NaN; allowed: a force in N, > 0"),
        ("load = 468.0", "load = 468.0\nlateral = \"coupled\"", "lateral"),
        (
            "sliding = { axis = [0.0, 0.0, 1.0] }",
            "sliding = { axis = [0.0, 0.0, 1.0], through = [0.119, 0.0, 0.0] }",
            "contact.sliding",
        ),
    ];
    for (given, changed, expected) in faults {
        let text = text();
        assert!(text.contains(given), "{given}");
        let found = parse(text.replace(given, changed)).unwrap_err();
        assert!(found.contains(expected) && !found.contains('\n'), "{changed}: {found}");
    }
}

/// Two nodes of the disc at one place, whichever has the lower number.
#[test]
fn a_node_of_the_pad_at_two_nodes_of_the_disc_is_refused() {
    let case = parse(text()).unwrap();
    let mesh = std::fs::read_to_string(folder().join("disc-pad.inp")).unwrap();
    let nodes = &case.mesh.as_ref().unwrap().nodes;
    for (pair, label) in [(0, 0), (1, 99_999)] {
        let [pad, disc] = case.contact.as_ref().unwrap().patches[3].pairs[pair];
        let [x, y, z] = nodes.iter().find(|node| node.label == disc).unwrap().position;
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("twin.inp"), format!("{mesh}*NODE, NSET=TWIN\n{label}, {x:?}, {y:?}, {z:?}\n"))
            .unwrap();
        let twin = dir.path().join("twin.inp").display().to_string();
        let text = text()
            .replace("\"disc-pad.inp\"", &format!("{twin:?}"))
            .replace("\"DISCFACE\"", "[\"DISCFACE\", \"TWIN\"]");
        let found = parse(text).unwrap_err();
        let (first, second) = (disc.min(label), disc.max(label));
        let expected = format!(
            "contact.pad = node {pad} at nodes {first} and {second} of contact.disc, which are as near; allowed"
        );
        assert!(found.contains(&expected), "{found}");
    }
}

/// Nothing slides along the normal of its contact, however long the vectors are and wherever it points: what is quoted is what was written.
#[test]
fn a_sliding_along_the_normal_is_refused_as_it_was_written() {
    for normal in [[0.0, 0.0, 1.0], [0.01, 0.02, 0.97], [0.3, -0.1, 2.7]] {
        for length in [1.0, -0.1, 3.0, 1e-9] {
            let sliding = normal.map(|x| length * x);
            let text = text()
                .replace("normal = [0.0, 0.0, 1.0]", &format!("normal = {normal:?}"))
                .replace("sliding = { axis = [0.0, 0.0, 1.0] }", &format!("sliding = {sliding:?}"));
            let found = parse(text).unwrap_err();
            let expected = format!(
                "contact.sliding = {sliding:?}; allowed: a direction across contact.normal = {normal:?} at node "
            );
            assert!(found.contains(&expected) && !found.contains('\n'), "{found}");
        }
    }
    let across = text().replace("sliding = { axis = [0.0, 0.0, 1.0] }", "sliding = [1.0, 0.0, 0.2]");
    assert!(parse(across).is_ok());
    let about = text().replace("sliding = { axis = [0.0, 0.0, 1.0] }", "sliding = { axis = [0.0, 0.0, 0.0] }");
    assert!(parse(about).unwrap_err().contains("contact.sliding.axis = [0.0, 0.0, 0.0]; allowed"));
}

/// Identities of what is prepared differ where something changes the reduced brake, and are the same where nothing can: samples, accuracy, what was measured, comments.
#[test]
fn all_that_bases_depend_on_is_in_the_identity_of_what_is_prepared() {
    let own = parse(text()).unwrap();
    let of = |from: &str, to: &str| {
        let text = text();
        assert!(text.contains(from), "{from}");
        parse(text.replacen(from, to, 1)).unwrap_or_else(|error| panic!("{to}: {error}"))
    };
    for (from, to) in [
        ("samples = 100", "samples = 7"),
        ("[brake]", "[accuracy]\nhalf_width = 0.01\n\n[brake]"),
        ("[brake]", "[measured]\nfrequencies = [2000.0]\ntolerance = 9.0\n\n[brake]"),
        ("# m between the two nodes", "# metres between both nodes"),
    ] {
        let case = of(from, to);
        assert_eq!(case.prepared_identity(), own.prepared_identity(), "{to}");
        assert_eq!(case.brake_identity(), own.brake_identity(), "{to}");
    }
    for (from, to, is_same_brake) in [
        ("seed = 1", "seed = 2", true),
        ("\"velocity-dependent\", ", "", true),
        ("in_contact = [9, 8]", "in_contact = [9]", true),
        ("fixed = [\"BACKENDS.z\"]", "fixed = [\"BACKENDS.x\"]", true),
        ("from = 0.1 ", "from = 0.2 ", true),
        ("[brake]", "[squeal]\ngrowth_above = 10.0\n\n[brake]", true),
        ("load = 468.0", "load = 469.0", true),
        ("load = 468.0", "lateral = \"none\"\nload = 468.0", false),
        ("load = 468.0", "draws = \"each\"\nload = 468.0", true),
        ("stiffness = 4.05e8", "stiffness = 4.06e8", false),
        ("rayleigh = { mass = 100.0", "rayleigh = { mass = 101.0", false),
        ("stiffness = [1.08e8", "stiffness = [1.09e8", false),
        ("axis = [0.0, 0.0, 1.0]", "axis = [0.0, 0.0, -1.0]", false),
        ("mean = 0.50", "mean = 0.51", false),
        (
            "sigma0 = { distribution = \"log-normal\", median = 1e5",
            "sigma0 = { distribution = \"log-normal\", median = 2e5",
            false,
        ),
        ("[500.0, 8000.0]", "[500.0, 7000.0]", false),
        ("[-500.0, 3000.0]", "[-400.0, 3000.0]", false),
        ("residual = 1e-8", "residual = 1e-7", false),
        ("residual = 1e-8", "residual = 1e-8\ntraining = 9", false),
        ("full_checks = 100", "full_checks = 99", false),
        ("full_checks = 100", "full_checks = 100\nfull_verdicts = 0", false),
        ("name = \"Disc and pad\"", "name = \"Another\"", false),
    ] {
        let case = of(from, to);
        assert_ne!(case.prepared_identity(), own.prepared_identity(), "{to}");
        assert_eq!(case.brake_identity() == own.brake_identity(), is_same_brake, "{to}");
    }
}

/// Numbers in the place or the unit of others are asked for, and those of the shipped case are not.
#[test]
fn numbers_that_no_brake_has_are_asked_for() {
    let asked = |from: &str, to: &str| {
        let text = text();
        assert!(text.contains(from), "{from}");
        let notes = parse(text.replacen(from, to, 1)).unwrap().header.notes;
        notes.into_iter().filter(|note| note.contains("; is ")).collect::<Vec<_>>()
    };
    assert_eq!(asked("seed = 1", "seed = 1"), [""; 0]);
    for (from, to, words) in [
        ("mass = 100.0, stiffness = 1.25e-6", "mass = 1.25e-6, stiffness = 100.0", "by rayleigh the damping ratio is"),
        ("to = 1.0\n", "to = 1000.0\n", "sliding at up to 1000 m/s"),
        ("median = 1.5,", "median = 1500.0,", "so that friction is mu_k alone"),
        ("stiffness = 4.05e8", "stiffness = 0.405", "times as stiff as the bodies"),
    ] {
        let notes = asked(from, to);
        assert!(matches!(notes.as_slice(), [note] if note.contains(words)), "{to}: {notes:?}");
    }
}
