//! Modes that are followed from one set of constraints to another.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use brakes::MatricesBrake;
use brakes::case::MatricesCase;
use study::{Study, UncertainBrake, set_links};

/// Three masses on springs to ground, coupled a little; the second set holds b, the third a too, the fourth c.
const CHAIN: &str = r#"
    study = { name = "chain", samples = 1, seed = 1 }
    brake = { kind = "matrices", dofs = ["a", "b", "c"] }
    [[terms]]
    name = "chain"
    mass = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    damping = [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.03]]
    stiffness = [[1.0, -0.1, 0.0], [-0.1, 4.0, -0.1], [0.0, -0.1, 9.0]]
    [[constraints]]
    name = "none"
    fixed = []
    [[constraints]]
    name = "b"
    fixed = ["b"]
    [[constraints]]
    name = "a-b"
    fixed = ["a", "b"]
    [[constraints]]
    name = "c"
    fixed = ["c"]
"#;

#[test]
fn a_mode_is_followed_to_its_name_under_more_constraints() {
    let text = CHAIN.to_owned();
    let brake = MatricesBrake::new(MatricesCase::parse("chain.toml".as_ref(), text).unwrap()).unwrap();
    let solver = cea::QrSolver;
    let study = Study::new(&brake, &solver).unwrap();
    let links = set_links(brake.plan(), study.origin_references(), &solver).unwrap();
    // Sets of which none holds all that the other does have no links.
    let found: Vec<_> = links.iter().map(|link| ((link.from, link.to), link.becomes.clone())).collect();
    let [first, second, third] = [vec![Some(0)], vec![Some(1)], vec![None]];
    assert_eq!(
        found,
        [
            ((0, 1), vec![first.clone(), third.clone(), second.clone()]),
            ((0, 2), vec![third.clone(), third.clone(), first.clone()]),
            ((0, 3), vec![first.clone(), second.clone(), third.clone()]),
            ((1, 2), vec![third, first]),
        ]
    );
    // Rank 3 of the first set and rank 2 of the second are one shape, but for the coupling.
    assert!(links[0].mac[(2, 1)] > 0.99 && links[0].mac[(1, 1)] < 0.01, "{}", links[0].mac);
}
