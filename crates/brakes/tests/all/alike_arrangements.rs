//! Arrangements that the symmetry of a lattice makes of each other are one scene only where the study has that symmetry too: its draws, and its list of
//! arrangements.

use std::collections::BTreeSet;
use std::path::Path;

use brakes::LatticeBrake;
use brakes::case::LatticeCase;
use study::{Modifiable as _, UncertainBrake as _};

const ALL_PAIRS: &str = "[[1, 2], [1, 3], [1, 4], [2, 3], [2, 4], [3, 4]]";

/// The 2 x 2 pad with a draw for each contact in these arrangements, under one law, with this correlation.
fn case(arrangements: &str, correlation: &str) -> LatticeCase {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml");
    let mut text = std::fs::read_to_string(&path).unwrap();
    for (from, to) in [
        ("laws = [\"amontons-coulomb\", \"lugre\"]", "laws = [\"amontons-coulomb\"]"),
        ("in_contact = [4, 3]", &format!("arrangements = {arrangements}")),
        ("draws = \"shared\"", "draws = \"each\""),
    ] {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    if !correlation.is_empty() {
        text += &format!("\n[correlation]\n{correlation}\n");
    }
    LatticeCase::parse(&path, text).unwrap()
}

/// Number of configurations without constraints.
fn configurations(brake: &LatticeBrake) -> usize {
    brake.plan().configurations.iter().filter(|configuration| configuration.origin == 0).count()
}

/// Number of configurations of all pairs of oscillators in contact.
fn scenes(correlation: &str) -> usize {
    configurations(&LatticeBrake::new(case(ALL_PAIRS, correlation)).unwrap())
}

#[test]
fn arrangements_are_alike_only_where_draws_are() {
    // The oscillators from 0 that those of 2 x 2 become where no rows are reversed, rows, columns and both.
    let reversals = [[0, 1, 2, 3], [2, 3, 0, 1], [1, 0, 3, 2], [3, 2, 1, 0]];
    let pairs: Vec<[usize; 2]> = (0..4).flat_map(|a| (a + 1..4).map(move |b| [a, b])).collect();
    let image = |pair: &[usize; 2], of: &[usize; 4]| pair.map(|at| of[at]).into_iter().collect::<BTreeSet<usize>>();
    let plain = scenes("");
    let orbits = |kept: &[[usize; 4]]| {
        let orbit = |pair| kept.iter().map(|of| image(pair, of)).collect::<BTreeSet<_>>();
        pairs.iter().map(orbit).collect::<BTreeSet<_>>().len()
    };
    assert_eq!((plain, orbits(&reversals)), (3, 3));
    for pair in &pairs {
        let [a, b] = pair.map(|at| at + 1);
        let matrix = "matrix = [[1.0, 0.7], [0.7, 1.0]]";
        let named = scenes(&format!("parameters = [\"mu@{a}\", \"mu@{b}\"]\n{matrix}"));
        let own: BTreeSet<usize> = pair.iter().copied().collect();
        let kept: Vec<[usize; 4]> = reversals.into_iter().filter(|of| image(pair, of) == own).collect();
        assert_eq!(named, orbits(&kept), "mu@{a} and mu@{b}");
        // Two parameters of two contacts: no reversal but one that exchanges nothing keeps them.
        let named = scenes(&format!("parameters = [\"mu@{a}\", \"mu_s@{b}\"]\n{matrix}"));
        assert_eq!(named, pairs.len(), "mu@{a} and mu_s@{b}");
    }
    // What holds in each contact alike, and a field over them, have the symmetry of the lattice.
    assert_eq!(scenes("field = { kernel = \"exponential\", length = 0.8 }"), plain);
    assert_eq!(scenes("parameters = [\"mu\", \"mu_s\"]\nmatrix = [[1.0, 0.7], [0.7, 1.0]]"), plain);
}

#[test]
fn a_list_that_lacks_an_image_has_not_the_symmetry() {
    // Scenes, and symmetries that remain: by rows and columns 1 becomes 3 and 2.
    for (arrangements, scenes, symmetries) in [
        ("[[1]]", 1, 1),
        ("[[1], [2]]", 1, 2),
        ("[[1], [4]]", 1, 2),
        ("[[1], [2], [3]]", 3, 1),
        ("[[1], [2], [3], [4]]", 1, 4),
        ("[[1, 2], [3]]", 2, 1),
        ("[[1, 2], [3], [4]]", 2, 2),
        ("[[1, 2], [3, 4], [1, 4], [2, 3]]", 2, 4),
    ] {
        let brake = LatticeBrake::new(case(arrangements, "")).unwrap();
        let found = (configurations(&brake), brake.symmetries(0).len());
        assert_eq!(found, (scenes, symmetries), "{arrangements}");
        // What is asked of all arrangements of a draw together needs the draws of each.
        let apart = LatticeBrake::of_equal_draws(case(arrangements, "")).unwrap();
        assert_eq!(configurations(&apart), arrangements.matches("[").count() - 1);
        assert_eq!((apart.members_are_equal(), apart.symmetries(0).len()), (true, symmetries));
        let is_alone = brake.plan().scenes.iter().all(|scene| scene.members.len() == 1);
        assert_eq!(brake.members_are_equal(), is_alone, "{arrangements}");
    }
}
