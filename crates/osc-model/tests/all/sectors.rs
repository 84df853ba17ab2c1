//! Sectors against the whole lattice: equal spectra, and shapes that solve the whole system.

#![allow(clippy::unwrap_used)]

use crate::common::{contact, coulomb, eigenvalues, lugre, model, set_distance, shared, table_1, uniform};
use cea::{EigenSolver, Mode, QrSolver, Workspace, backward_error};
use friction::Tangent;
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use osc_model::{
    ContactArrangement, Grid, Lateral, LatticeModel, OscModelError, Preload, PreparedLattice, Reversal, Sector,
    Sectors, Sign, Sliding,
};
use proptest::prelude::*;

const CONSTRAINTS: [&str; 3] = ["", "x1 x3 x7 x9", "x1 x3 x4 x6 x7 x9"];
const LATERALS: [Lateral; 4] =
    [Lateral::None, Lateral::Coupled { sign: Sign::Plus }, Lateral::Coupled { sign: Sign::Minus }, Lateral::Vector];

fn tangents() -> [Tangent; 3] {
    [coulomb(0.5), Tangent { slope: -0.05, ..coulomb(0.45) }, lugre(0.4)]
}

/// One arrangement of each class that has more than one sector.
fn arrangements(model: &LatticeModel) -> Vec<ContactArrangement> {
    let all: Vec<_> = [9, 8, 7, 6].into_iter().flat_map(|k| ContactArrangement::all(9, k).unwrap()).collect();
    let classes = model.symmetry_classes(&model.symmetries(), &all).unwrap();
    let representatives = classes.into_iter().map(|class| all[class.representative].clone());
    representatives.filter(|arrangement| model.sectors(arrangement).unwrap().iter().len() > 1).collect()
}

fn parts(sectors: &Sectors, lattice: &PreparedLattice, sliding: &Sliding) -> Vec<SecondOrder> {
    let mut parts = vec![SecondOrder::zeros(1, 0); sectors.iter().len()];
    let at = lattice.operating_point(sliding).unwrap();
    sectors.assemble_into(&lattice.brake().system, &at, &mut SecondOrder::zeros(1, 0), &mut parts).unwrap();
    parts
}

/// The basis of a sector as a dense matrix.
fn basis(sector: &Sector) -> DMatrix<f64> {
    let unit = |i: usize| DVector::from_fn(sector.order(), |j, _| Complex::from(f64::from(u8::from(i == j))));
    DMatrix::from_columns(&(0..sector.order()).map(|i| sector.expand(&unit(i)).map(|u| u.re)).collect::<Vec<_>>())
}

fn orders(sectors: &Sectors) -> Vec<usize> {
    sectors.iter().map(Sector::order).collect()
}

/// Adds the eigenvalues -a of bristles that act on no degree of freedom, which the whole has and no sector.
fn with_idle_bristles(mut together: Vec<Complex<f64>>, whole: &SecondOrder) -> Vec<Complex<f64>> {
    assert!(together.len() <= whole.dimension());
    if let Some(&decay) = whole.internal.decay.iter().next() {
        together.resize(whole.dimension(), Complex::from(-decay));
    }
    together
}

#[test]
fn nine_in_contact_fall_into_15_6_6_and_3() {
    let sectors =
        |lateral, constraints| orders(&model(lateral, constraints).sectors(&ContactArrangement::full(9)).unwrap());
    assert_eq!(sectors(Lateral::Vector, CONSTRAINTS[0]), [15, 6, 6, 3]);
    // Constraining x of the corners takes one of their four combinations from each sector, constraining x4 and x6 one of their
    // two. Where the first row moves against the last, only these x couple the corners with 2 and 8.
    assert_eq!(sectors(Lateral::Vector, CONSTRAINTS[1]), [14, 5, 2, 3, 2]);
    assert_eq!(sectors(Lateral::Vector, CONSTRAINTS[2]), [13, 4, 2, 3, 2]);
    // Without friction across the sliding yp is not coupled with other degrees of freedom.
    assert_eq!(sectors(Lateral::None, CONSTRAINTS[0]), [14, 1, 6, 6, 3]);
    let lonely = ContactArrangement::new(9, &[0, 1, 2, 3, 4, 6, 8]).unwrap();
    assert_eq!(orders(&model(Lateral::None, "x1").sectors(&lonely).unwrap()), [28, 1]);
}

#[test]
fn half_of_the_classes_fall_apart() {
    let all: Vec<_> = [9, 8, 7, 6].into_iter().flat_map(|k| ContactArrangement::all(9, k).unwrap()).collect();
    let (model, mut with) = (model(Lateral::Vector, ""), [0; 5]);
    for class in model.symmetry_classes(&model.symmetries(), &all).unwrap() {
        let sectors = model.sectors(&all[class.representative]).unwrap().iter().len();
        // Of the four reversals, those that change an arrangement give its class, the others its sectors.
        assert_eq!(class.members.len() * sectors, 4);
        with[sectors] += 1;
    }
    assert_eq!(with, [0, 23, 16, 0, 6]);
}

#[test]
fn a_basis_is_orthonormal_and_all_together_are_complete() {
    for constraints in CONSTRAINTS {
        let model = model(Lateral::None, constraints);
        for arrangement in arrangements(&model) {
            let sectors = model.sectors(&arrangement).unwrap();
            let all: Vec<_> = sectors
                .iter()
                .flat_map(|s| basis(s).column_iter().map(|c| c.into_owned()).collect::<Vec<_>>())
                .collect();
            let q = DMatrix::from_columns(&all);
            let n = model.dof_map().free().len();
            assert_eq!(q.shape(), (n, n));
            assert!((q.transpose() * &q - DMatrix::identity(n, n)).amax() < 1e-15, "{arrangement}");
        }
    }
}

#[test]
fn a_sector_is_the_projection_of_the_whole() {
    for constraints in CONSTRAINTS {
        let model = model(Lateral::Vector, constraints);
        for arrangement in arrangements(&model) {
            let lattice = model.prepare(&arrangement).unwrap();
            let sectors = model.sectors(&arrangement).unwrap();
            let sliding = shared(lugre(0.4), arrangement.in_contact().len());
            let whole = lattice.linearised(&sliding).unwrap();
            for (sector, part) in sectors.iter().zip(parts(&sectors, &lattice, &sliding)) {
                let q = basis(sector);
                for (whole, part) in [(&whole.m, &part.m), (&whole.c, &part.c), (&whole.k, &part.k)] {
                    assert!((q.transpose() * whole * &q - part).amax() <= 1e-14 * whole.amax());
                    // The matrices do not couple the sector to the others.
                    assert!((whole * &q - &q * part).amax() <= 1e-14 * whole.amax());
                }
                let force = &whole.internal.force * &whole.internal.drive;
                let of_sector = &part.internal.force * &part.internal.drive;
                assert!((q.transpose() * &force * &q - of_sector).amax() <= 1e-14 * force.amax());
            }
        }
    }
}

#[test]
fn every_oscillator_in_contact_joins_no_sectors_of_an_arrangement() {
    for (lateral, constraints) in LATERALS.into_iter().flat_map(|l| CONSTRAINTS.map(|c| (l, c))) {
        let model = model(lateral, constraints);
        let full = model.prepare(&ContactArrangement::full(9)).unwrap();
        for tangent in tangents().into_iter().filter(|tangent| tangent.internal.is_none()) {
            let whole = full.linearised(&shared(tangent, 9)).unwrap();
            for (arrangement, sector) in arrangements(&model).iter().flat_map(|a| {
                let sectors: Vec<_> = model.sectors(a).unwrap().iter().cloned().collect();
                sectors.into_iter().map(move |sector| (a.clone(), sector))
            }) {
                let (q, mut part) = (basis(&sector), SecondOrder::zeros(1, 0));
                sector.reduce(&whole, &mut part).unwrap();
                for (whole, part) in [(&whole.c, &part.c), (&whole.k, &part.k)] {
                    assert!((whole * &q - &q * part).amax() <= 1e-14 * whole.amax(), "{constraints}: {arrangement}");
                }
            }
        }
    }
}

#[test]
fn the_spectra_of_the_sectors_are_that_of_the_whole_and_their_shapes_solve_it() {
    let (mut worst, mut worst_shape, mut work) = (0.0_f64, 0.0_f64, Workspace::default());
    for (lateral, constraints) in LATERALS.into_iter().flat_map(|l| CONSTRAINTS.map(|c| (l, c))) {
        let model = model(lateral, constraints);
        for (arrangement, tangent) in
            arrangements(&model).iter().flat_map(|a| tangents().map(|tangent| (a.clone(), tangent)))
        {
            let lattice = model.prepare(&arrangement).unwrap();
            let sectors = model.sectors(&arrangement).unwrap();
            let sliding = shared(tangent, arrangement.in_contact().len());
            let whole = lattice.linearised(&sliding).unwrap();
            let mut together = Vec::new();
            for (sector, part) in sectors.iter().zip(parts(&sectors, &lattice, &sliding)) {
                let spectrum = QrSolver.eigenvalues(&part, &mut work).unwrap();
                let lambdas: Vec<_> = spectrum.oscillatory().collect();
                for mode in Mode::at(&part, &lambdas, &mut work).unwrap() {
                    let shape = sector.expand(&mode.shape);
                    worst_shape = worst_shape.max(backward_error(&whole, mode.lambda, &shape));
                    assert!((sector.project(&shape) - &mode.shape).norm() < 1e-14 * mode.shape.norm());
                }
                together.extend(spectrum.eigenvalues);
            }
            worst = worst.max(set_distance(&eigenvalues(&whole), &with_idle_bristles(together, &whole)));
        }
    }
    println!("spectra differ by {worst:.1e}, backward errors of shapes {worst_shape:.1e}");
    assert!(worst < 1e-10 && worst_shape < 1e-13, "{worst:e}, {worst_shape:e}");
}

#[test]
fn without_symmetry_the_whole_is_the_only_sector() {
    let model = model(Lateral::Vector, "");
    let lonely = ContactArrangement::new(9, &[0, 1, 2, 3, 4, 6, 8]).unwrap();
    let mut uneven = table_1();
    uneven.x_stiffness[0] *= 1.01;
    let uneven = LatticeModel::new(uneven, Lateral::Vector, &[]).unwrap();
    let full = ContactArrangement::full(9);
    let one = [
        (&model, &lonely, model.sectors(&lonely).unwrap()),
        (&uneven, &full, uneven.sectors(&full).unwrap()),
        (&model, &full, model.prepare(&full).unwrap().brake().sectors.clone()),
    ];
    for (model, arrangement, sectors) in one {
        let lattice = model.prepare(arrangement).unwrap();
        // Any contacts are allowed with one sector, also some with and some without bristles.
        let mut sliding = shared(lugre(0.4), arrangement.in_contact().len());
        sliding.contacts[1] = contact(coulomb(0.3));
        assert_eq!(parts(&sectors, &lattice, &sliding), [lattice.linearised(&sliding).unwrap()]);
    }
}

#[test]
fn what_breaks_the_symmetry_is_refused() {
    let model = model(Lateral::None, "");
    let arrangement = ContactArrangement::full(9);
    let (lattice, sectors) = (model.prepare(&arrangement).unwrap(), model.sectors(&arrangement).unwrap());
    let refused = |change: &dyn Fn(&mut Sliding)| {
        let mut sliding = shared(lugre(0.4), 9);
        change(&mut sliding);
        let mut parts = vec![SecondOrder::zeros(1, 0); 4];
        let at = lattice.operating_point(&sliding).unwrap();
        sectors.assemble_into(&lattice.brake().system, &at, &mut SecondOrder::zeros(1, 0), &mut parts)
    };
    assert_eq!(refused(&|_| ()), Ok(()));
    let corner = OscModelError::UnequalContacts { first: "1".into(), second: "9".into() };
    assert_eq!(refused(&|sliding| sliding.contacts[8].normal_load *= 1.001), Err(corner.clone()));
    assert_eq!(refused(&|sliding| sliding.contacts[8].tangent.mu += 0.001), Err(corner.clone()));
    assert_eq!(refused(&|sliding| sliding.contacts[8] = contact(coulomb(0.4))), Err(corner));
    // The contact in the middle is exchanged with no other.
    assert_eq!(refused(&|sliding| sliding.contacts[4].tangent.mu += 0.001), Ok(()));
    let bristles = refused(&|sliding| sliding.contacts[4] = contact(coulomb(0.4)));
    assert_eq!(bristles, Err(OscModelError::OtherSystem { order: 30, states: 8, expected: 30, channels: 9 }));
    let other = ContactArrangement::full(4);
    assert_eq!(model.sectors(&other), Err(OscModelError::OtherLattice { arrangement: 4, oscillators: 9 }));
}

#[test]
fn loads_of_a_static_equilibrium_keep_the_symmetry() {
    let model = model(Lateral::Coupled { sign: Sign::Plus }, "");
    for arrangement in arrangements(&model) {
        let (lattice, sectors) = (model.prepare(&arrangement).unwrap(), model.sectors(&arrangement).unwrap());
        let mut sliding = shared(lugre(0.4), arrangement.in_contact().len());
        let loads = lattice.normal_loads(Preload::Equilibrium(600.0), &sliding.contacts).unwrap();
        assert!(loads.iter().any(|load| (load - loads[0]).abs() > 1.0));
        sliding.contacts.iter_mut().zip(loads).for_each(|(contact, load)| contact.normal_load = load);
        let together: Vec<_> = parts(&sectors, &lattice, &sliding).iter().flat_map(eigenvalues).collect();
        assert!(set_distance(&eigenvalues(&lattice.linearised(&sliding).unwrap()), &together) < 1e-10);
    }
}

/// A lattice of any size with an arrangement and constraints that some reversals map onto themselves.
fn symmetric() -> impl Strategy<Value = (LatticeModel, ContactArrangement)> {
    let group = prop::sample::select(vec![
        vec![Reversal::Rows],
        vec![Reversal::Columns],
        vec![Reversal::Both],
        Reversal::ALL.to_vec(),
    ]);
    let grid = (1_usize..=4, 1_usize..=4);
    (grid, group, prop::sample::select(LATERALS.to_vec())).prop_flat_map(|((rows, columns), group, lateral)| {
        let grid = Grid::new(rows, columns).unwrap();
        let n = grid.oscillators();
        (prop::collection::vec(any::<bool>(), n), prop::collection::vec(prop::bool::weighted(0.2), 3 * n), 0.5..2.0)
            .prop_map(move |(contacts, held, stiffer)| {
                let is_in = |i: usize| contacts[i] || group.iter().any(|g| contacts[g.oscillator(grid, i)]);
                let is_held = |i: usize| held[i] || group.iter().any(|g| held[g.dof(grid, i)]);
                let names: Vec<_> =
                    (0..3 * n).filter(|&i| is_held(i)).map(|i| osc_model::Dof::at(i, n).unwrap()).collect();
                let mut parameters = uniform(grid);
                parameters.contact_stiffness.iter_mut().for_each(|k| *k *= stiffer);
                let in_contact: Vec<usize> = (0..n).filter(|&i| is_in(i)).collect();
                (
                    LatticeModel::new(parameters, lateral, &names).unwrap(),
                    ContactArrangement::new(n, &in_contact).unwrap(),
                )
            })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_symmetric_lattice_is_the_sum_of_its_sectors((model, arrangement) in symmetric(), speed in 0.1..3.0) {
        let (lattice, sectors) = (model.prepare(&arrangement).unwrap(), model.sectors(&arrangement).unwrap());
        for tangent in [coulomb(0.4), lugre(speed)] {
            let sliding = shared(tangent, arrangement.in_contact().len());
            let whole = lattice.linearised(&sliding).unwrap();
            let parts = parts(&sectors, &lattice, &sliding);
            prop_assert_eq!(parts.iter().map(SecondOrder::order).sum::<usize>(), model.dof_map().free().len());
            let together = with_idle_bristles(parts.iter().flat_map(eigenvalues).collect(), &whole);
            let distance = set_distance(&eigenvalues(&whole), &together);
            prop_assert!(distance < 1e-10, "{}", distance);
        }
    }
}
