//! Sliding states: refilling in place, the parts of a system, preloads, contacts of vanishing load, and refused states.

#![allow(clippy::unwrap_used)]

use crate::common::{contact, coulomb, eigenvalues, held, lugre, model, set_distance, shared, table_1};
use friction::{BristleDamping, FrictionLaw, LuGre, LuGreParameters, Stribeck, StribeckParameters, Tangent};
use linsys::SecondOrder;
use osc_model::{
    ContactArrangement, ContactPoint, Lateral, LatticeModel, LatticeParameters, Preload, PreparedLattice, Sign, Sliding,
};

#[test]
fn a_used_buffer_gives_what_a_fresh_one_gives() {
    let lattice = model(Lateral::Vector, "x5").prepare(&ContactArrangement::full(9)).unwrap();
    let mut mixed = shared(lugre(0.3), 9);
    mixed.contacts[4].tangent = coulomb(0.4);
    let states = [shared(lugre(0.7), 9), shared(coulomb(0.6), 9), mixed, shared(lugre(0.2), 9)];
    let mut buffer = SecondOrder::zeros(1, 3);
    for (state, bristles) in states.iter().zip([9, 0, 8, 9]) {
        lattice.brake().system.assemble_into(&lattice.operating_point(state).unwrap(), &mut buffer).unwrap();
        assert_eq!(buffer, lattice.linearised(state).unwrap());
        assert_eq!(buffer.states(), bristles);
        buffer.check().unwrap();
    }
}

#[test]
fn structure_and_friction_make_the_whole() {
    let arrangement = ContactArrangement::from_numbers(9, &[1, 2, 4, 5, 8]).unwrap();
    let lattice = model(Lateral::Coupled { sign: Sign::Minus }, "x1 z4").prepare(&arrangement).unwrap();
    let sliding = shared(lugre(0.3), 5);
    let friction = friction(&lattice, &sliding);
    let (whole, structure) = (lattice.linearised(&sliding).unwrap(), lattice.structural());
    assert_eq!(structure.k, structure.k.transpose());
    assert_eq!(whole.m, structure.m);
    assert!((whole.c - &structure.c - &friction.c).amax() < 1e-12 * structure.c.amax());
    assert!((whole.k - &structure.k - &friction.k).amax() < 1e-12 * structure.k.amax());
    assert_eq!(whole.internal, friction.internal);
    assert_eq!(friction.m.amax(), 0.0);
}

fn friction(lattice: &PreparedLattice, sliding: &Sliding) -> SecondOrder {
    let mut friction = SecondOrder::zeros(1, 0);
    lattice.brake().system.friction_into(&lattice.operating_point(sliding).unwrap(), &mut friction).unwrap();
    friction
}

/// From the equations of one contact, written out by hand: friction drags oscillator 5 and the plate in x and y.
#[test]
fn a_contact_enters_the_matrices_as_its_equations_say() {
    let arrangement = ContactArrangement::from_numbers(9, &[5]).unwrap();
    let (x, y, z, xp, yp, zp, k_z) = (12, 13, 14, 27, 28, 29, 3.47e7);
    let sliding = shared(lugre(0.3), 1);
    let point = sliding.contacts[0];
    let (n, v, bristle) = (point.normal_load, sliding.speed, point.tangent.internal.unwrap());
    let of = |lateral| friction(&model(lateral, "").prepare(&arrangement).unwrap(), &sliding);
    for (lateral, sign) in
        [(Lateral::None, 0.0), (Lateral::Coupled { sign: Sign::Minus }, -1.0), (Lateral::Vector, 0.0)]
    {
        let friction = of(lateral);
        let mut k = nalgebra::DMatrix::zeros(30, 30);
        let mut c = nalgebra::DMatrix::zeros(30, 30);
        for (row, force) in [(x, 1.0), (xp, -1.0)] {
            for (column, reading) in [(z, 1.0), (zp, -1.0)] {
                k[(row, column)] = force * reading * point.tangent.mu * k_z;
            }
            for (column, reading) in [(x, 1.0), (xp, -1.0)] {
                c[(row, column)] = force * reading * n * point.tangent.slope;
            }
        }
        for (row, force) in [(y, 1.0), (yp, -1.0)] {
            for (column, reading) in [(z, 1.0), (zp, -1.0)] {
                k[(row, column)] = force * reading * sign * point.lateral_mu * k_z;
            }
            for (column, reading) in [(y, 1.0), (yp, -1.0)].into_iter().filter(|_| lateral == Lateral::Vector) {
                c[(row, column)] = force * reading * point.lateral_mu * n / v;
            }
        }
        assert!((k - &friction.k).amax() < 1e-14 * friction.k.amax());
        assert!((c - &friction.c).amax() < 1e-14 * friction.c.amax());
        // The relative velocity is v + x_p' - x_i'; friction drags the oscillator along with the plate.
        let internal = &friction.internal;
        assert_eq!((internal.drive[(0, x)], internal.drive[(0, xp)]), (-bristle.drive, bristle.drive));
        assert_eq!((internal.force[(x, 0)], internal.force[(xp, 0)]), (n * bristle.force, -n * bristle.force));
    }
}

#[test]
fn preloads_add_up() {
    let lattice = model(Lateral::None, "").prepare(&ContactArrangement::full(9)).unwrap();
    let contacts = vec![contact(coulomb(0.5)); 9];
    assert_eq!(lattice.normal_loads(Preload::PerContact(600.0), &contacts).unwrap(), [600.0; 9]);
    assert_eq!(lattice.normal_loads(Preload::Clamp(5400.0), &contacts).unwrap(), [600.0; 9]);

    let six = lattice_of(&[1, 2, 3, 4, 5, 6]);
    assert_eq!(six.normal_loads(Preload::Clamp(5400.0), &contacts[3..]).unwrap(), [900.0; 6]);
    let message = |preload: Preload| lattice.normal_loads(preload, &contacts).unwrap_err().to_string();
    for bad in [Preload::PerContact(-1.0), Preload::Clamp(-1.0), Preload::Equilibrium(-1.0)] {
        assert_eq!(message(bad), "preload = -1; allowed: finite and > 0, from 1e-100 to 1e100");
    }
}

fn lattice_of(numbers: &[usize]) -> PreparedLattice {
    model(Lateral::None, "").prepare(&ContactArrangement::from_numbers(9, numbers).unwrap()).unwrap()
}

#[test]
fn names_what_it_refuses_in_a_sliding_state() {
    let lattice = lattice_of(&[2, 5, 7]);
    let message = |sliding: Sliding| lattice.linearised(&sliding).unwrap_err().to_string();
    assert_eq!(message(shared(coulomb(0.5), 2)), "the sliding state has 2 contacts; the arrangement has 3");
    assert_eq!(
        message(Sliding { speed: 0.0, ..shared(coulomb(0.5), 3) }),
        "speed = 0; allowed: finite and > 0, from 1e-100 to 1e100"
    );
    let changed = |change: &dyn Fn(&mut ContactPoint)| {
        let mut sliding = shared(coulomb(0.5), 3);
        change(&mut sliding.contacts[1]);
        message(sliding)
    };
    assert_eq!(
        changed(&|p| p.normal_load = -5.0),
        "normal_load of oscillator 5 = -5; allowed: finite and >= 0, at most 1e100"
    );
    assert_eq!(
        changed(&|p| p.tangent.mu = f64::NAN),
        "tangent.mu of oscillator 5 = NaN; allowed: finite and >= 0, at most 1e100"
    );
    assert_eq!(
        changed(&|p| p.tangent.slope = f64::INFINITY),
        "tangent.slope of oscillator 5 = inf; allowed: finite, at most 1e100 in size"
    );
    assert_eq!(
        changed(&|p| p.lateral_mu = -0.1),
        "lateral_mu of oscillator 5 = -0.1; allowed: finite and >= 0, at most 1e100"
    );
}

#[test]
fn names_what_it_refuses_in_a_lattice() {
    let refused = |change: &dyn Fn(&mut LatticeParameters)| {
        let mut p = table_1();
        change(&mut p);
        LatticeModel::new(p, Lateral::None, &[]).unwrap_err().to_string()
    };
    assert_eq!(
        refused(&|p| p.contact_stiffness[2] = 0.0),
        "contact_stiffness[3] = 0; allowed: finite and > 0, from 1e-100 to 1e100"
    );
    assert_eq!(
        refused(&|p| p.oscillator_mass[8] = -0.39),
        "oscillator_mass[9] = -0.39; allowed: finite and > 0, from 1e-100 to 1e100"
    );
    assert_eq!(refused(&|p| p.x_stiffness[0] = -1.0), "x_stiffness[1] = -1; allowed: finite and >= 0, at most 1e100");
    assert_eq!(
        refused(&|p| p.y_damping[11] = f64::NAN),
        "y_damping[12] = NaN; allowed: finite and >= 0, at most 1e100"
    );
    assert_eq!(refused(&|p| p.theta = f64::INFINITY), "theta = inf; allowed: finite, at most 1e100 in size");
    assert_eq!(refused(&|p| p.plate.mass = 0.0), "plate.mass = 0; allowed: finite and > 0, from 1e-100 to 1e100");
    assert_eq!(
        refused(&|p| p.plate.damping[1] = -1.0),
        "plate.damping[2] = -1; allowed: finite and >= 0, at most 1e100"
    );
    assert_eq!(refused(&|p| p.z_damping.truncate(8)), "z_damping has 8 entries; the lattice of 3 x 3 needs 9");

    let constrained = |names: &str| LatticeModel::new(table_1(), Lateral::None, &held(names)).unwrap_err().to_string();
    assert_eq!(constrained("x1 x10"), "x10 is not there; allowed: oscillators 1 to 9, and p");
    assert_eq!(constrained("x1 yp x1"), "x1 is constrained twice; allowed: each once");
    let other = model(Lateral::None, "").prepare(&ContactArrangement::full(4)).unwrap_err().to_string();
    assert_eq!(other, "the contact arrangement is for 4 oscillators, the lattice has 9");
}

/// `h(lambda) - h(0)` is of order |lambda| / a: with bristles a hundred times stiffer, the spectra are a hundred times closer.
#[test]
fn stiff_bristles_follow_the_stribeck_curve() {
    let curve = StribeckParameters { mu_s: 0.55, mu_k: 0.45, v_s: 0.6, sigma2: 0.004 };
    let lattice = model(Lateral::None, "x1 x3").prepare(&ContactArrangement::full(9)).unwrap();
    // A different load on each contact keeps the modes apart.
    let spectrum = |tangent: Tangent| -> Vec<_> {
        let mut sliding = shared(tangent, 9);
        for (i, point) in sliding.contacts.iter_mut().enumerate() {
            point.normal_load += 20.0 * i as f64;
        }
        eigenvalues(&lattice.linearised(&sliding).unwrap()).into_iter().filter(|l| l.im > 0.0).collect()
    };
    let stribeck = spectrum(Stribeck::new(curve).unwrap().tangent_at(0.4).unwrap());
    let with_bristles = |sigma0: f64| {
        let StribeckParameters { mu_s, mu_k, v_s, sigma2 } = curve;
        let bristle_damping = BristleDamping::Constant;
        let parameters = LuGreParameters { mu_s, mu_k, v_s, sigma0, sigma1: 0.0, sigma2, bristle_damping };
        let distance = set_distance(&stribeck, &spectrum(LuGre::new(parameters).unwrap().tangent_at(0.4).unwrap()));
        println!("sigma0 {sigma0:e}: {distance:e}");
        distance
    };
    let (soft, stiff) = (with_bristles(1e7), with_bristles(1e9));
    assert!(soft < 1e-3 && stiff > 1e-9, "{soft:e}, {stiff:e}");
    assert!((soft / stiff / 100.0 - 1.0).abs() < 0.05, "{soft:e}, {stiff:e}");
}
