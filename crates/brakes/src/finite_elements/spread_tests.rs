//! Parameters over patches and over faces, in the brakes that they make.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use montecarlo::stream;
use nalgebra_sparse::CscMatrix;
use sparse::SparseSecondOrder;

use super::FiniteElementSample;
use super::points::{all_patches, of_brake, scene_point};
use super::samples::{draw, law_and_speed, median};
use crate::case::{CaseFile, FiniteElementCase, Law};

fn parse(folder: &str, text: &str) -> Result<FiniteElementCase, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(folder).join("changed.toml");
    match CaseFile::parse(&path, text.into()).map_err(|error| error.to_string())? {
        CaseFile::FiniteElements(case) => Ok(*case),
        other => panic!("{other:?}"),
    }
}

fn shipped(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    std::fs::read_to_string(folder.join(name).join(format!("{name}.toml"))).unwrap()
}

/// The disc and pad with a factor of the stiffness and of the friction of its nine patches, each a log-normal parameter with these further fields.
fn disc_pad(over: &str) -> String {
    let text =
        shipped("disc-pad").replace("load = 468.0", "stiffness_factor = \"kc\"\nfriction_factor = \"f\"\nload = 468.0");
    let log_normal =
        |name: &str| format!("\n[parameters.{name}]\ndistribution = \"log-normal\"\nmedian = 1.5\nsigma = 0.3\n{over}");
    text + &log_normal("kc") + &log_normal("f")
}

/// The two pads, held by their loads or in equilibrium, with such factors.
fn two_pads(over: &str, given: bool) -> String {
    let mut text = shipped("two-pads")
        .replace("[all_contacts]\n", "[all_contacts]\nstiffness_factor = \"kc\"\nfriction_factor = \"f\"\n");
    if given {
        text = text.replace("load = \"equilibrium\"", "load = { pressure = 1.0 }");
        let (before, rest) = text.split_once("[[forces]]").unwrap();
        let (_, contacts) = rest.split_once("[[contact]]").unwrap();
        text = format!("{before}[[contact]]{contacts}");
        let (before, rest) = text.split_once("[parameters.pressure]").unwrap();
        let (_, after) = rest.split_once("[parameters.Omega]").unwrap();
        text = format!("{before}[parameters.Omega]{after}");
    }
    let log_normal = |name: &str| {
        format!("\n[parameters.{name}]\ndistribution = \"log-normal\"\nmedian = 1.1\nsigma = 0.2\n{over}\n")
    };
    text + &log_normal("kc") + &log_normal("f")
}

/// The whole brake of a sample with all patches closed, under its first law.
fn system(case: &FiniteElementCase, sample: &FiniteElementSample) -> SparseSecondOrder {
    let (closed, contact) = (all_patches(case), case.contact.as_ref().unwrap());
    let range = (!contact.speeds.is_empty()).then_some(0);
    let friction = law_and_speed(case, Some((Law::AmontonsCoulomb, range)), sample);
    let point = scene_point(case, &closed, friction, sample).unwrap();
    case.system.assemble(&of_brake(case, &closed, &point)).unwrap()
}

/// The largest difference of two systems, relative to the largest entries.
fn difference(a: &SparseSecondOrder, b: &SparseSecondOrder) -> f64 {
    let size = |values: &[f64]| values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let off = |a: &CscMatrix<f64>, b: &CscMatrix<f64>| size((a - b).values()) / size(b.values()).max(f64::MIN_POSITIVE);
    off(&a.k, &b.k).max(off(&a.c, &b.c))
}

/// The sample with the parameters whose names begin so at a value.
fn with(case: &FiniteElementCase, mut sample: FiniteElementSample, prefix: &str, value: f64) -> FiniteElementSample {
    let mut count = 0;
    for (parameter, own) in case.parameters.iter().zip(&mut sample.values) {
        if parameter.name.starts_with(prefix) {
            *own = value;
            count += 1;
        }
    }
    assert!(count > 0, "{prefix}");
    sample
}

/// Patches that all have one value are the brake with one value, at the medians and away from them.
#[test]
fn equal_patches_are_one_patch() {
    let over = "over = \"patches\"\n";
    for (folder, [one, each]) in [
        ("disc-pad", [disc_pad(""), disc_pad(over)]),
        ("two-pads", [two_pads("", true), two_pads(over, true)]),
        ("two-pads", [two_pads("", false), two_pads(over, false)]),
    ] {
        let [one, each] = [one, each].map(|text| parse(folder, &text).unwrap());
        assert_eq!(each.parameters.len() - one.parameters.len(), 2 * all_patches(&one).len() - 2);
        let at_medians = difference(&system(&each, &median(&each)), &system(&one, &median(&one)));
        let [mut of_one, mut of_each] = [median(&one), median(&each)];
        for (name, value) in [("kc", 0.7), ("f", 1.2)] {
            of_one = with(&one, of_one, name, value);
            of_each = with(&each, of_each, &format!("{name}@"), value);
        }
        let off = difference(&system(&each, &of_each), &system(&one, &of_one));
        println!("{folder}: {at_medians:.1e} at the medians, {off:.1e} elsewhere");
        assert!(at_medians < 1e-16 && off < 1e-12, "{folder}: {at_medians:e} {off:e}");
    }
}

/// A stiffness and a friction that one patch alone has change its forces alone: the systems differ by its own term and channels.
#[test]
fn a_patch_has_its_own_stiffness_and_friction() {
    let case = parse("disc-pad", &disc_pad("over = \"patches\"\n")).unwrap();
    let closed = all_patches(&case);
    let changed = with(&case, with(&case, median(&case), "kc@5", 3.0), "f@5", 0.9);
    let friction = law_and_speed(&case, Some((Law::AmontonsCoulomb, Some(0))), &changed);
    let mut expected = of_brake(&case, &closed, &scene_point(&case, &closed, friction, &median(&case)).unwrap());
    // The median of both is 1.5: twice the stiffness, read by friction of 0.6 times as much.
    let contact = case.contact.as_ref().unwrap();
    let first = case.system.terms().len() - closed.len();
    expected.coefficients[first + 4] *= 2.0;
    for (at, channel) in contact.patches[4].channels.clone().enumerate() {
        let gain = &mut expected.channels[channel];
        (gain.mu, gain.slope) = if at < 3 { (gain.mu * 1.2, gain.slope * 0.6) } else { (gain.mu, gain.slope * 0.6) };
    }
    let off = difference(&system(&case, &changed), &case.system.assemble(&expected).unwrap());
    assert!(off < 1e-12, "{off:e}");
}

/// A friction that a contact has of its own is that of its patch: the same brake as with a factor over patches, of which one is changed.
#[test]
fn a_contact_has_its_own_friction() {
    for given in [true, false] {
        let over = parse("two-pads", &two_pads("over = \"patches\"\n", given)).unwrap();
        let own = two_pads("", given).replace("friction_factor = \"f\"\n", "");
        let own = own.replace("name = \"outer\"\nslave", "name = \"outer\"\nfriction_factor = \"f\"\nslave");
        let own = own.replace("name = \"inner\"\nslave", "name = \"inner\"\nfriction_factor = 1.1\nslave");
        let own = parse("two-pads", &own).unwrap();
        let of_one = system(&over, &with(&over, median(&over), "f@1", 0.8));
        let of_own = system(&own, &with(&own, median(&own), "f", 0.8));
        let [off, moved] = [&of_own, &system(&own, &median(&own))].map(|other| difference(other, &of_one));
        println!("{off:.1e} where medians are {moved:.1e} away");
        assert!(off < 1e-12 && moved > 1e-3, "{off:e} {moved:e}");
    }
    let negative = two_pads("", true).replace("name = \"inner\"\n", "name = \"inner\"\nfriction_factor = \"f - 2\"\n");
    let error = parse("two-pads", &negative).unwrap_err();
    assert!(error.contains("contact \"inner\".friction_factor") && error.ends_with("allowed: > 0"), "{error}");
}

/// A stiffness in other units than those of the matrices is asked for, one in theirs is not.
#[test]
fn a_stiffness_in_other_units_is_asked_for() {
    for factor in [1.0, 1e-9, 1e9] {
        let pads =
            two_pads("", true).replace("{ per_area = 150.0 }", &format!("{{ per_area = {:e} }}", 150.0 * factor));
        let pad = shipped("disc-pad").replace("stiffness = 4.05e8", &format!("stiffness = {:e}", 4.05e8 * factor));
        for (folder, text) in [("two-pads", pads), ("disc-pad", pad)] {
            let case = parse(folder, &text).unwrap();
            let asked = case.header.notes.iter().filter(|note| note.contains("times as stiff as")).count();
            assert_eq!(asked, usize::from(factor != 1.0), "{folder} {factor}: {:?}", case.header.notes);
        }
    }
}

/// Draws of patches are independent, each with the distribution that is given, and correlated where the case says so; what else is drawn by its name before
/// them stays.
#[test]
fn patches_are_drawn_independently_or_correlated() {
    let text = disc_pad("over = \"patches\"\n");
    let tied = "\n[correlation]\nparameters = [\"kc@1\", \"kc@2\"]\nmatrix = [[1.0, 0.8], [0.8, 1.0]]\n";
    for (case, expected) in [(text.clone(), 0.0), (text + tied, 0.8)] {
        let case = parse("disc-pad", &case).unwrap();
        let at = |name: &str| case.parameters.iter().position(|own| own.name == name).unwrap();
        let places = ["kc@1", "kc@2", "kc@3", "f@1"].map(at);
        let count = 4000;
        let scores: Vec<[f64; 4]> = (0..count)
            .map(|number| {
                let sample = draw(&case, &mut stream(5, number)).unwrap();
                places.map(|place| (sample.values[place] / 1.5).ln() / 0.3)
            })
            .collect();
        let product = |i: usize, j: usize| scores.iter().map(|of| of[i] * of[j]).sum::<f64>() / count as f64;
        println!("{:.3} {:.3} {:.3}", product(0, 1), product(0, 2), product(0, 3));
        // Deviations of a correlation of so many are 0.016, of a variance 0.022.
        assert!((product(0, 1) - expected).abs() < 0.06 && product(0, 2).abs() < 0.06 && product(0, 3).abs() < 0.06);
        assert!((0..4).all(|i| (product(i, i) - 1.0).abs() < 0.09));
    }
}

/// A field of a length without end is one number for each face: where both have the same, the brake with one parameter.
#[test]
fn a_field_of_infinite_length_is_one_parameter_for_each_face() {
    for given in [true, false] {
        let one = parse("two-pads", &two_pads("", given)).unwrap();
        let field = parse("two-pads", &two_pads("over = { kernel = \"exponential\", length = inf }", given)).unwrap();
        let names: Vec<&str> = field.parameters.iter().map(|own| own.name.as_str()).collect();
        assert!(names.ends_with(&["f.1.mode1", "f.2.mode1", "kc.1.mode1", "kc.2.mode1"]), "{names:?}");
        for (stiff, rubs) in [(0.0, 0.0), (1.3, -0.4), (-2.0, 0.7)] {
            let value = |score: f64| 1.1 * (0.2 * score).exp();
            let of_one = with(&one, with(&one, median(&one), "kc", value(stiff)), "f", value(rubs));
            let of_field = with(&field, with(&field, median(&field), "kc.", stiff), "f.", rubs);
            let off = difference(&system(&field, &of_field), &system(&one, &of_one));
            println!("{given} {stiff} {rubs}: {off:.1e}");
            assert!(off < 1e-12, "{off:e}");
        }
    }
}

/// At every point of a field the stiffness has the median and the quantiles of its distribution, however few modes are kept; points that are near each other
/// are correlated as the kernel says, and faces not at all.
#[test]
fn points_of_a_field_have_the_distribution_that_is_given() {
    let over = "over = { kernel = \"gaussian\", length = 40.0, share = 0.9 }";
    let case = parse("two-pads", &two_pads(over, true)).unwrap();
    let contact = case.contact.as_ref().unwrap();
    let note = case.header.notes.iter().find(|note| note.contains("parameters.kc")).unwrap();
    println!("{note}");
    assert!(note.contains("a field over the face of outer, of ") && note.contains(" of its variance at "), "{note}");
    let factor = contact.stiffness_factor.as_ref().unwrap();
    let count = 2000;
    let draws: Vec<[Vec<f64>; 2]> = (0..count)
        .map(|number| {
            let sample = draw(&case, &mut stream(7, number)).unwrap();
            let score = |value: f64| (value / 1.1).ln() / 0.2;
            [0, 1]
                .map(|patch| contact.at_pairs(factor, &sample.values, patch).unwrap().into_iter().map(score).collect())
        })
        .collect();
    let product = |a: (usize, usize), b: (usize, usize)| {
        draws.iter().map(|of| of[a.0][a.1] * of[b.0][b.1]).sum::<f64>() / count as f64
    };
    let places = &contact.patches[0].places;
    for pair in (0..places.len()).step_by(7) {
        let below = draws.iter().filter(|of| of[0][pair] < -1.0).count() as f64 / count as f64;
        let low = draws.iter().filter(|of| of[0][pair] < 0.0).count() as f64 / count as f64;
        assert!((low - 0.5).abs() < 0.05 && (below - 0.1587).abs() < 0.04, "{pair}: {low} {below}");
        assert!((product((0, pair), (0, pair)) - 1.0).abs() < 0.13 && product((0, pair), (1, 0)).abs() < 0.09);
        let apart: f64 = (0..3).map(|d| (places[0].position[d] - places[pair].position[d]).powi(2)).sum();
        let expected = (-apart / 1600.0).exp();
        // A tenth of the variance is left out, which makes up to about as much of a correlation.
        assert!((product((0, 0), (0, pair)) - expected).abs() < 0.25, "{pair}: {expected}");
    }
}

#[test]
fn faults_of_parameters_over_patches_and_faces_are_one_line() {
    let field = |of: &str| format!("over = {{ kernel = \"exponential\", {of} }}");
    for (folder, text, said) in [
        (
            "two-pads",
            two_pads(&field("length = -3.0"), true),
            "parameters.f.over.length = -3; allowed: a distance, > 0",
        ),
        (
            "two-pads",
            two_pads(&field("length = nan"), true),
            "parameters.f.over.length = NaN; allowed: a distance, > 0",
        ),
        (
            "two-pads",
            two_pads(&field("length = 5.0, share = 1.5"), true),
            "parameters.f.over.share = 1.5; allowed: a share of the variance, > 0 and <= 1",
        ),
        (
            "two-pads",
            two_pads(&field("length = 5.0, share = 0.0"), true),
            "parameters.f.over.share = 0; allowed: a share",
        ),
        ("two-pads", two_pads(&field("width = 5.0"), true), "expected \"patches\", or { kernel = "),
        ("two-pads", two_pads("over = \"points\"", true), "expected \"patches\", or { kernel = "),
        (
            "disc-pad",
            disc_pad(&field("length = 5.0")),
            "parameters.f.over = a field; allowed: \"patches\" of a contact between nodes, which have no area",
        ),
        (
            "two-pads",
            two_pads("over = \"patches\"", true).replace("coefficient = \"shim\"", "coefficient = \"shim*kc\""),
            "springs \"shim outer\".coefficient = \"shim*kc\"; allowed: parameters of which the brake has one value",
        ),
        (
            "two-pads",
            two_pads("over = \"patches\"", true).replacen("median = 1.1\nsigma = 0.2", "value = 1.1", 1).replacen(
                "\"log-normal\"",
                "\"constant\"",
                1,
            ),
            "parameters.kc.over = given; allowed: parameters that are drawn",
        ),
        (
            "two-pads",
            two_pads("over = \"patches\"", true).replace("friction_factor = \"f\"\n", ""),
            "parameters.f = used nowhere",
        ),
        (
            "hoffmann",
            std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/hoffmann.toml"))
                .unwrap()
                .replacen("distribution =", "over = \"patches\"\ndistribution =", 1),
            "over = given; allowed: finite elements, whose contacts have patches and faces",
        ),
    ] {
        let error = parse(folder, &text).unwrap_err();
        assert!(error.contains(said) && !error.contains('\n') && error.contains("changed.toml"), "{said}: {error}");
    }
}
