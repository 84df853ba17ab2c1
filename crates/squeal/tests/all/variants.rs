//! Variants of a brake, side by side: their effects are what closed forms and the brake's own sets of constraints say.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use std::path::{Path, PathBuf};

use brakes::case::{CaseFile, LatticeCase, Variant};
use brakes::{AnyBrake, LatticeBrake, Purpose, make};
use squeal::screen::{ChangeKind, Confirmation, Criterion, Joined, Screen, ScreenOptions, confirm, rank};
use squeal::study::UncertainBrake;

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name)
}

fn brake(case: CaseFile) -> AnyBrake {
    make(case, Purpose::Screen, &()).unwrap()
}

fn screened<B: UncertainBrake>(brake: &B, variants: &[(&str, &B)], kinds: &[ChangeKind], samples: u64) -> Screen {
    let mut options = ScreenOptions::default();
    (options.kinds, options.up_to, options.variants) = (kinds.to_vec(), 1, variants.len());
    let joined = Joined::new(brake, variants, 0).unwrap();
    let how = Confirmation::new(samples).with_threads(Some(2));
    confirm(&joined, rank(&joined, &options, &()).unwrap(), &options, &how).unwrap()
}

/// The variants of `cases/hoffmann.toml` that a file has.
fn variants_of_hoffmann(text: &str) -> Result<Vec<(String, AnyBrake)>, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("variants.toml");
    std::fs::write(&path, text).unwrap();
    let read = Variant::read_all(&path, &case("hoffmann.toml"), &["study.samples=10".into()]);
    let read = read.map_err(|error| error.to_string().replace(&folder.path().display().to_string(), ""))?;
    Ok(read.into_iter().map(|Variant { name, case }| (name, brake(case))).collect())
}

/// Hoffmann's oscillator flutters from `D = 1 + (k / 2)^2 + c^2 (2 + k / 2)` with a spring k along the belt, and from `D = 1 + 2 (f c)^2` with dashpots of f
/// times their size, D being 4 / 3 mu; mu is uniform from 0.5 to 1.1.
#[test]
fn variants_of_hoffmanns_oscillator_do_what_closed_forms_say() {
    let variants = variants_of_hoffmann(
        r#"
        [[variants]]
        name = "as-it-is"
        set = ["study.seed=5"]
        [[variants]]
        name = "spring"
        set = ["terms.abutment={ stiffness = [[0.8, 0.0], [0.0, 0.0]] }"]
        [[variants]]
        name = "shim"
        set = ["terms.dashpots.coefficient=8"]
        [[variants]]
        name = "lot"
        set = ["terms.dashpots.coefficient=f", "parameters.f={ distribution = 'uniform', from = 7.999, to = 8.001 }"]
        [[variants]]
        name = "less-friction"
        set = ["mu={ distribution = 'uniform', from = 0.3, to = 0.9 }"]
        "#,
    );
    let variants = variants.unwrap();
    let unchanged = brake(CaseFile::read(&case("hoffmann.toml")).unwrap());
    let named: Vec<(&str, &AnyBrake)> = variants.iter().map(|(name, brake)| (name.as_str(), brake)).collect();
    let screen = screened(&unchanged, &named, &[ChangeKind::Spring], 4000);
    let c = 0.05_f64;
    let occurrence = |d: f64, most: f64| ((most - d * 0.75) / 0.6).clamp(0.0, 1.0);
    let now = 1.0 + 2.0 * c * c;
    for (name, left) in [
        ("as-it-is", occurrence(now, 1.1)),
        ("spring", occurrence(1.0 + 0.16 + c * c * 2.4, 1.1)),
        ("shim", occurrence(1.0 + 2.0 * 64.0 * c * c, 1.1)),
        ("lot", occurrence(1.0 + 2.0 * 64.0 * c * c, 1.1)),
        ("less-friction", occurrence(now, 0.9)),
    ] {
        let set = screen.sets.iter().find(|set| set.is_variant() && set.places == name).unwrap();
        let confirmed = set.confirmed.as_ref().unwrap();
        let drop = occurrence(now, 1.1) - left;
        let slack = (confirmed.drop.upper - confirmed.drop.lower) + 1e-3;
        assert!((confirmed.drop.value - drop).abs() < slack, "{name}: {:?} {drop}", confirmed.drop);
        assert!((confirmed.unstable.value - left).abs() < 0.04, "{name}: {confirmed:?} {left}");
        // Drawn alike, so that what differs is told from little; but where another parameter is drawn first.
        let width = confirmed.drop.upper - confirmed.drop.lower;
        assert_eq!(width < 0.034, name != "lot", "{name}: {width}");
    }
    assert_eq!(screen.sets.iter().filter(|set| set.kind == Some(ChangeKind::Spring)).count(), 2);
    // The largest effect first, among themselves and with all others.
    let drops = screen.sets.iter().filter(|set| set.is_variant());
    let drops: Vec<f64> =
        drops.map(|set| Criterion::Occurrence.drop(set.confirmed.as_ref().unwrap()).value.abs()).collect();
    assert!(drops.is_sorted_by(|a, b| a >= b), "{drops:?}");
    let text = screen.text();
    let (_, together) = text.split_once("together, the largest effect first").unwrap();
    let place = |words: &str| together.find(words).unwrap();
    assert!(
        place("variant less-friction") < place("variant spring") && place("variant spring") < place("variant as-it-is")
    );
    // The two springs do the same, by the symmetry of the oscillator.
    let first = ["spring x", "spring y"].into_iter().filter_map(|words| together.find(words)).min().unwrap();
    assert!(first < place("variant as-it-is"), "{text}");
}

/// A lattice, whose scenes stand for several arrangements each.
#[test]
fn a_variant_whose_constraints_are_a_set_of_the_case_has_its_numbers() {
    let of = |fixed: &[&str]| {
        let mut case = LatticeCase::read(&case("two-by-two.toml")).unwrap();
        case.header.samples = 60;
        let wanted = if fixed.is_empty() { "none" } else { "first-row" };
        let is_held = !fixed.is_empty();
        if is_held {
            case.constraints.retain(|set| set.name == wanted);
        }
        LatticeBrake::new(case).unwrap()
    };
    let (unchanged, held) = (of(&[]), of(&["x1", "x2"]));
    let screen = screened(&unchanged, &[("held", &held)], &[ChangeKind::Constraint], 60);
    let set = |name: &str| screen.sets.iter().find(|set| set.places == name).unwrap().confirmed.clone();
    assert!(set("held").is_some_and(|found| found.drop.value > 0.0));
    assert_eq!(set("held"), set("first-row"));
    // What is changed beside a variant is changed as without it.
    let single = |screen: &Screen| {
        let set = screen.sets.iter().find(|set| set.kind == Some(ChangeKind::Constraint)).unwrap();
        (set.places.clone(), set.prediction, set.confirmed.clone())
    };
    assert_eq!(single(&screen), single(&screened(&unchanged, &[], &[ChangeKind::Constraint], 60)));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let refused = |text: &str| match variants_of_hoffmann(text) {
        Err(error) => error,
        Ok(variants) => {
            let unchanged = brake(CaseFile::read(&case("hoffmann.toml")).unwrap());
            let named: Vec<(&str, &AnyBrake)> = variants.iter().map(|(name, brake)| (name.as_str(), brake)).collect();
            match Joined::new(&unchanged, &named, 0) {
                Err(error) => error.to_string(),
                Ok(_) => panic!("not refused: {text}"),
            }
        }
    };
    let other = case("two-by-two.toml").display().to_string();
    for (text, wanted) in [
        ("", "/variants.toml: line 1: missing field `variants`"),
        ("variants = []", "/variants.toml: variants = []; allowed: one table or more"),
        ("[[variants]]\nname = \"a\"", "allowed: with a field case, set, or both"),
        ("[[variants]]\nname = \"a b\"\nset = [\"mu=1\"]", "variants.name = \"a b\"; allowed: 1 to 60 letters"),
        ("[[variants]]\nname = \"a\"\nset = [\"nu=1\"]", "variant \"a\": "),
        ("[[variants]]\nname = \"a\"\nset = [\"nu=1\"]", "set = nu=1; allowed: mu"),
        ("[[variants]]\nname = \"a\"\nsets = [\"mu=1\"]", "unknown field `sets`"),
        ("[[variants]]\nname = \"a\"\ncase = \"none.toml\"", "none.toml: cannot be read"),
        (
            "[[variants]]\nname = \"a\"\nset = [\"mu=1\"]\n[[variants]]\nname = \"a\"\nset = [\"mu=2\"]",
            "variants.name = a; allowed: each once",
        ),
        (
            "[[variants]]\nname = \"none\"\nset = [\"mu=1\"]",
            "variant \"none\": name = none; allowed: a name of its own",
        ),
        (
            "[[variants]]\nname = \"a\"\nset = [\"squeal.growth_above=1\"]",
            "variant \"a\": threshold of squeal = a growth rate above 1 1/s; allowed: that of the case, a growth rate above 0",
        ),
        (&format!("[[variants]]\nname = \"a\"\ncase = {other:?}"), "variant \"a\": laws = "),
        (
            "[[variants]]\nname = \"a\"\nset = ['constraints.b={ fixed = [\"x\"] }', 'constraints.c={ fixed = [\"y\"] }']",
            "variant \"a\": sets of constraints = b, c; allowed: that of the case, none",
        ),
    ] {
        assert!(refused(text).contains(wanted), "{text}: {}", refused(text));
    }
}

/// Numbers of two sets are subtracted over all analyses of a draw.
#[test]
fn a_variant_with_another_number_of_arrangements_is_refused() {
    let mut other = LatticeCase::read(&case("two-by-two.toml")).unwrap();
    other.panels.truncate(1);
    let (unchanged, other) = (
        LatticeBrake::new(LatticeCase::read(&case("two-by-two.toml")).unwrap()).unwrap(),
        LatticeBrake::new(other).unwrap(),
    );
    let refused = Joined::new(&unchanged, &[("fewer", &other)], 0).err().map(|error| error.to_string());
    assert!(refused.is_some_and(|line| line.contains("variant \"fewer\": arrangements, laws and ranges of speed = ")));
}
