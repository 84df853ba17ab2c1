//! The estimators of an occurrence against each other.

use std::path::Path;

use cea::QrSolver;
use montecarlo::Study as _;
use squeal::accuracy::{Family, exact};
use squeal::case::{Case, Law};
use squeal::study::{Plan, Sample, Study};

/// The paper's lattice with a few arrangements and Coulomb friction.
fn plan(arrangements: &str, constraints: &str) -> Plan {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/paper.toml"));
    let text = std::fs::read_to_string(path).unwrap();
    let text = text
        .replace("laws = [\"amontons-coulomb\", \"velocity-dependent\", \"lugre\"]", "laws = [\"amontons-coulomb\"]")
        .replace("in_contact = [9, 8, 7, 6]", &format!("arrangements = {arrangements}"));
    let from = text.find("[[constraints]]").unwrap();
    let to = text.find("[[speeds]]").unwrap();
    let text = format!("{}[[constraints]]\nname = \"set\"\nfixed = {constraints}\n{}", &text[..from], &text[to..]);
    let plan = Plan::new(Case::parse(path, text).unwrap()).unwrap();
    assert_eq!(plan.case.laws, [Law::AmontonsCoulomb]);
    plan
}

#[test]
fn every_sample_has_the_modes_that_the_exact_integral_gives_it() {
    let plan = plan("[[1,2,3,4,5,6,7,8,9],[1,2,3,4,5,6,7,8],[1,3,4,5,6,8]]", "[]");
    let study = Study::new(&plan, &QrSolver).unwrap();
    let mut scratch = Default::default();
    for (at, scene) in plan.scenes.iter().enumerate() {
        let t = std::time::Instant::now();
        let mut family = Family::new(&plan, scene, &QrSolver).unwrap();
        let exact = exact(&plan, scene, &study.references()[at], &mut family).unwrap();
        println!("{:?} {:?} {:?}", t.elapsed(), exact.counters, exact.occurrences);
        println!("{:e} {} {}", exact.error, exact.any, exact.expected_modes);
        for p in &exact.pieces {
            println!("{p:?}");
        }
        for c in &exact.crossings.crossings {
            println!("{c:?}");
        }
        let n = 300;
        for i in 0..n {
            let sample = Sample::draw(&plan.case, &mut montecarlo::stream(7, i));
            let outcome = study.evaluate(at, &sample, &mut scratch).unwrap();
            let mu = sample.contact(0).mu;
            let piece = exact.pieces.iter().find(|p| p.from <= mu && mu < p.to).unwrap();
            let names: Vec<_> = outcome.unstable.iter().map(|m| m.names.clone()).collect();
            if names != piece.unstable {
                println!("{mu} {names:?} {:?}", piece.unstable);
            }
        }
    }
}
