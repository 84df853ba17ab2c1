//! Symmetry classes of arrangements.

#![allow(clippy::unwrap_used)]

use crate::common::{contact, coulomb, lugre, model, set_distance, shared, spectrum, table_1};
use nalgebra::DMatrix;
use osc_model::{ContactArrangement, ContactPoint, Lateral, LatticeModel, Reversal, Sign, Sliding};

fn nine_to_six() -> Vec<ContactArrangement> {
    [9, 8, 7, 6].into_iter().flat_map(|k| ContactArrangement::all(9, k).unwrap()).collect()
}

#[test]
fn arrangements_of_nine_to_six_fall_into_45_classes() {
    for constraints in ["", "x1 x3 x7 x9", "x1 x3 x4 x6 x7 x9"] {
        let model = model(Lateral::None, constraints);
        assert_eq!(model.symmetries(), Reversal::ALL);
        let counts = [9, 8, 7, 6].map(|k| {
            let all = ContactArrangement::all(9, k).unwrap();
            let classes = model.symmetry_classes(&model.symmetries(), &all).unwrap();
            assert_eq!(classes.iter().map(|class| class.members.len()).sum::<usize>(), all.len());
            classes.len()
        });
        assert_eq!(counts, [1, 4, 13, 27]);
        assert_eq!(model.symmetry_classes(&model.symmetries(), &nine_to_six()).unwrap().len(), 45);
    }
}

#[test]
fn a_class_has_one_spectrum() {
    let arrangements = nine_to_six();
    for (lateral, tangent) in [(Lateral::Coupled { sign: Sign::Plus }, coulomb(0.5)), (Lateral::Vector, lugre(0.4))] {
        let model = model(lateral, "x1 x3 x7 x9");
        for class in model.symmetry_classes(&model.symmetries(), &arrangements).unwrap() {
            let of = |place: usize| {
                let arrangement: &ContactArrangement = &arrangements[place];
                spectrum(&model, arrangement, &shared(tangent, arrangement.in_contact().len()))
            };
            let representative = of(class.representative);
            for member in &class.members[1..] {
                let distance = set_distance(&representative, &of(member.arrangement));
                assert!(distance < 1e-10, "{}: {distance:e}", arrangements[member.arrangement]);
            }
        }
    }
}

#[test]
fn the_reversal_of_a_member_carries_the_matrices() {
    let model = model(Lateral::Coupled { sign: Sign::Minus }, "");
    let arrangements = nine_to_six();
    let grid = model.parameters().grid;
    for class in model.symmetry_classes(&model.symmetries(), &arrangements).unwrap() {
        let of = |place: usize| {
            let arrangement = &arrangements[place];
            let lattice = model.prepare(arrangement).unwrap();
            lattice.linearised(&shared(lugre(0.4), arrangement.in_contact().len())).unwrap()
        };
        let (from, n) = (of(class.representative), 30);
        for member in &class.members {
            let to = of(member.arrangement);
            let carried =
                DMatrix::from_fn(n, n, |i, j| to.k[(member.reversal.dof(grid, i), member.reversal.dof(grid, j))]);
            assert!((carried - &from.k).amax() <= 1e-12 * from.k.amax());
        }
    }
}

/// So with independent draws of one distribution all members of a class have one distribution of eigenvalues.
#[test]
fn draws_of_single_contacts_that_move_with_the_labels_give_the_same_spectrum() {
    let model = model(Lateral::Coupled { sign: Sign::Minus }, "x1 x3 x7 x9");
    let (arrangements, grid) = (nine_to_six(), model.parameters().grid);
    let drawn = |oscillator: usize| {
        let part = 0.05 * oscillator as f64;
        ContactPoint { lateral_mu: 0.6 - part, normal_load: 500.0 + 400.0 * part, ..contact(lugre(0.2 + part)) }
    };
    for class in model.symmetry_classes(&model.symmetries(), &arrangements).unwrap() {
        let of = |place: usize, reversal: Reversal| {
            let arrangement = &arrangements[place];
            let contacts = arrangement.in_contact().iter().map(|&i| drawn(reversal.oscillator(grid, i))).collect();
            spectrum(&model, arrangement, &Sliding { speed: 0.7, contacts })
        };
        let representative = of(class.representative, Reversal::None);
        for member in &class.members[1..] {
            let distance = set_distance(&representative, &of(member.arrangement, member.reversal));
            assert!(distance < 1e-10, "{}: {distance:e}", arrangements[member.arrangement]);
            let unmoved = set_distance(&representative, &of(member.arrangement, Reversal::None));
            assert!(unmoved > 1e-6, "{}: {unmoved:e}", arrangements[member.arrangement]);
        }
    }
}

#[test]
fn what_breaks_the_symmetry_is_noticed() {
    let reversals = |change: &dyn Fn(&mut osc_model::LatticeParameters), constraints: &str| {
        let mut p = table_1();
        change(&mut p);
        LatticeModel::new(p, Lateral::None, &crate::common::held(constraints)).unwrap().symmetries()
    };
    assert_eq!(reversals(&|_| (), "x1"), [Reversal::None]);
    assert_eq!(reversals(&|_| (), "x1 x3"), [Reversal::None, Reversal::Columns]);
    assert_eq!(reversals(&|_| (), "x2 yp"), [Reversal::None, Reversal::Columns]);
    assert_eq!(reversals(&|p| p.contact_stiffness[5] *= 1.0 + 1e-15, ""), [Reversal::None, Reversal::Rows]);
    assert_eq!(reversals(&|p| p.x_damping[4] += 1.0, ""), [Reversal::None, Reversal::Rows]);
    assert_eq!(reversals(&|p| p.oscillator_mass[4] *= 2.0, ""), Reversal::ALL);
}
