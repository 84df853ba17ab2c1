//! Static equilibrium of small structures against all their states, closed forms and what must be in balance.

#![allow(clippy::unwrap_used)] // Test code, which the lint does not recognise outside test functions.

use contact::{Balance, Condensed, ContactError, Row, Stiffness, Uniqueness};
use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::CscMatrix;
use proptest::prelude::*;

/// A structure with contacts to ground: stiffness, rows of gap and slip, k and h of each, load.
#[derive(Debug, Clone)]
struct Structure {
    k: DMatrix<f64>,
    gaps: Vec<Row>,
    slips: Vec<Row>,
    stiffness: Vec<f64>,
    open: Vec<f64>,
    load: DVector<f64>,
}

impl Structure {
    fn condensed(&self) -> Result<Condensed, ContactError> {
        let load = DMatrix::from_column_slice(self.load.len(), 1, self.load.as_slice());
        Condensed::new(&CscMatrix::from(&self.k), &self.gaps, &self.slips, &self.stiffness, &load)
    }

    fn balance(&self, mu: f64) -> Balance {
        Balance { gaps: self.open.clone(), mu: vec![mu; self.open.len()], loads: vec![1.0] }
    }

    /// Forces of each of all 2^n states that is in balance, each state solved as a whole.
    fn states(&self, mu: f64) -> Vec<Vec<f64>> {
        let n = self.open.len();
        let dense = |row: &Row| {
            let mut all: DVector<f64> = DVector::zeros(self.load.len());
            row.iter().for_each(|&(dof, value)| all[dof] += value);
            all
        };
        let mut found = Vec::new();
        for set in 0..1_u32 << n {
            let is_closed = |at: usize| set >> at & 1 == 1;
            let (mut k, mut f) = (self.k.clone(), self.load.clone());
            for at in (0..n).filter(|&at| is_closed(at)) {
                // N = - k (h + g^T u) along g + mu s.
                let (g, along) = (dense(&self.gaps[at]), dense(&self.gaps[at]) + dense(&self.slips[at]) * mu);
                k += &along * g.transpose() * self.stiffness[at];
                f -= along * (self.stiffness[at] * self.open[at]);
            }
            let Some(u) = k.lu().solve(&f) else { continue };
            let gap = |at: usize| self.open[at] + dense(&self.gaps[at]).dot(&u);
            if (0..n).all(|at| if is_closed(at) { gap(at) <= 0.0 } else { gap(at) >= 0.0 }) {
                let force = |at: usize| if is_closed(at) { -self.stiffness[at] * gap(at) } else { 0.0 };
                found.push((0..n).map(force).collect());
            }
        }
        found
    }
}

/// A chain of masses in x and y with springs between neighbours and to ground, leaning so that x and y couple, over contacts along y.
fn chain(n: usize, numbers: &[f64]) -> Structure {
    let number = |at: usize| numbers[at % numbers.len()];
    let mut k: DMatrix<f64> = DMatrix::zeros(2 * n, 2 * n);
    let mut spring = |a: usize, b: Option<usize>, direction: [f64; 2], stiffness: f64| {
        let mut row: DVector<f64> = DVector::zeros(2 * n);
        for x in 0..2 {
            row[2 * a + x] += direction[x];
            if let Some(b) = b {
                row[2 * b + x] -= direction[x];
            }
        }
        k += &row * row.transpose() * stiffness;
    };
    for a in 0..n {
        spring(a, None, [1.0, 0.3 * number(a)], 2.0 + number(a + 1));
        spring(a, None, [0.2 * number(a + 2), 1.0], 1.5 + number(a + 3));
        if a + 1 < n {
            spring(a, Some(a + 1), [1.0, 0.5], 3.0);
            spring(a, Some(a + 1), [-0.4, 1.0], 4.0 + number(a + 4));
        }
    }
    let load = DVector::from_fn(2 * n, |i, _| if i % 2 == 1 { 2.0 * number(i + 5) - 0.5 } else { number(i + 6) });
    Structure {
        k,
        gaps: (0..n).map(|a| vec![(2 * a + 1, 1.0)]).collect(),
        slips: (0..n).map(|a| vec![(2 * a, 1.0)]).collect(),
        stiffness: (0..n).map(|a| 20.0 + 10.0 * number(a + 7)).collect(),
        open: (0..n).map(|a| 0.1 * number(a + 8)).collect(),
        load,
    }
}

fn agree(structure: &Structure, mu: f64) -> Result<Uniqueness, TestCaseError> {
    let found = structure.condensed().unwrap().equilibrium(&structure.balance(mu)).unwrap();
    let states = structure.states(mu);
    prop_assert!(!states.is_empty());
    let distance = |state: &Vec<f64>| state.iter().zip(&found.forces).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    prop_assert!(states.iter().any(|state| distance(state) < 1e-11), "{:?} {:?}", states, found);
    match found.uniqueness {
        Uniqueness::Several(count) => prop_assert_eq!(states.len(), count),
        Uniqueness::NotDecided => (),
        _ => prop_assert_eq!(states.len(), 1),
    }
    Ok(found.uniqueness)
}

proptest! {
    /// Other springs and points taken out are those of a structure that was condensed with them.
    #[test]
    fn other_springs_are_those_of_a_structure_that_has_them(
        numbers in prop::collection::vec(-1.0..1.0_f64, 31),
        factors in prop::collection::vec(prop_oneof![Just(0.0), 0.1..10.0_f64], 4),
    ) {
        let whole = chain(4, &numbers);
        let changed: Vec<f64> = whole.stiffness.iter().zip(&factors).map(|(k, factor)| k * factor).collect();
        let kept: Vec<usize> = (0..4).filter(|&at| changed[at] > 0.0).collect();
        prop_assume!(!kept.is_empty());
        let part = |rows: &[Row]| kept.iter().map(|&at| rows[at].clone()).collect::<Vec<_>>();
        let of = |numbers: &[f64]| kept.iter().map(|&at| numbers[at]).collect::<Vec<_>>();
        let alone = Structure {
            gaps: part(&whole.gaps),
            slips: part(&whole.slips),
            stiffness: of(&changed),
            open: of(&whole.open),
            ..whole.clone()
        };
        let found = whole.condensed().unwrap().with_stiffness(&changed).unwrap();
        prop_assert_eq!(found.points(), kept.len());
        let [found, expected] = [found, alone.condensed().unwrap()].map(|of| of.equilibrium(&alone.balance(0.3)).unwrap());
        for (a, b) in found.forces.iter().zip(&expected.forces) {
            prop_assert!((a - b).abs() < 1e-11, "{:?} {:?}", found, expected);
        }
    }

    #[test]
    fn all_states_of_three_contacts(numbers in prop::collection::vec(-1.0..1.0_f64, 17), mu in -1.5..1.5_f64) {
        agree(&chain(3, &numbers), mu)?;
    }

    #[test]
    fn all_states_of_a_chain(n in 1..8_usize, numbers in prop::collection::vec(-1.0..1.0_f64, 31), mu in 0.0..0.8_f64) {
        agree(&chain(n, &numbers), mu)?;
        prop_assert_eq!(agree(&chain(n, &numbers), 0.0)?, Uniqueness::Definite);
    }
}

#[test]
fn all_1024_states_of_ten_contacts() {
    let numbers: Vec<f64> = (0..31).map(|i| (1.7 * f64::from(i) + 0.3).sin()).collect();
    for mu in [0.0, 0.4, 0.9] {
        let structure = chain(10, &numbers);
        println!("mu = {mu}: {:?}", agree(&structure, mu).unwrap());
        let closed = structure.condensed().unwrap().equilibrium(&structure.balance(mu)).unwrap().closed();
        assert!(closed.contains(&true) && closed.contains(&false));
    }
}

/// A rigid pad of length L over a bed of springs: it moves down by y, turns by theta about the middle of its face, and moves by x along it. A
/// holder at the height h keeps it from moving along; else only the bed holds it. The load P presses at the place e.
fn pad(points: usize, length: f64, height: f64, load: f64, place: f64) -> Structure {
    let at = |i: usize| length * ((i as f64 + 0.5) / points as f64 - 0.5);
    // Dofs: y upwards, theta (which lifts the end at +x), x. The holder sees x - h theta.
    let holder = DVector::from_column_slice(&[0.0, -height, 1.0]);
    Structure {
        k: &holder * holder.transpose() * 1e7,
        gaps: (0..points).map(|i| vec![(0, 1.0), (1, at(i))]).collect(),
        slips: vec![vec![(2, 1.0)]; points],
        stiffness: vec![1e6 / points as f64; points],
        open: vec![0.0; points],
        load: DVector::from_column_slice(&[-load, -load * place, 0.0]),
    }
}

#[test]
fn a_tilting_pad_has_the_pressure_of_the_closed_form() {
    let (length, load) = (2.0, 500.0);
    // Friction mu P pulls at the face along +x, and the holder at the height h pushes back: a moment mu P h about the face, so that the
    // pressure is that of a load at e + mu h: more at the end that the disc leaves last where the holder is above.
    for (mu, height, place) in [(0.0, 0.3, 0.1), (0.4, 0.3, 0.0), (0.4, 0.5, -0.1), (-0.6, 0.2, 0.1)] {
        let points = 400;
        let pad = pad(points, length, height, load, place);
        let found = pad.condensed().unwrap().equilibrium(&pad.balance(mu)).unwrap();
        assert!((found.forces.iter().sum::<f64>() / load - 1.0).abs() < 1e-10);
        let at = |i: usize| length * ((i as f64 + 0.5) / points as f64 - 0.5);
        let effective = place - mu * height;
        let inertia: f64 = (0..points).map(|i| at(i).powi(2)).sum();
        for (i, force) in found.forces.iter().enumerate() {
            // All closed: N = P / n + P e x / sum x^2, exactly.
            let expected = load / points as f64 + load * effective * at(i) / inertia;
            assert!((force - expected).abs() < 1e-11 * load, "{mu}: {force} {expected}");
        }
        println!("mu {mu}, h {height}, e {place}: {}", found.uniqueness);
    }
    // Beyond a sixth of the length it lifts off; it then touches along 3 (L / 2 - e).
    for (mu, height, place) in [(0.0, 0.3, 0.5), (0.5, 0.8, -0.2), (0.7, 0.4, 0.9)] {
        let effective: f64 = place - mu * height;
        let points = 400;
        let pad = pad(points, length, height, load, place);
        let found = pad.condensed().unwrap().equilibrium(&pad.balance(mu)).unwrap();
        let touching = found.closed().iter().filter(|closed| **closed).count() as f64 / points as f64 * length;
        let expected = (3.0 * (length / 2.0 - effective.abs())).min(length);
        assert!((touching - expected).abs() < 1.5 * length / points as f64, "{touching} {expected}");
        let largest = found.forces.iter().fold(0.0_f64, |largest, force| largest.max(*force));
        let pressure = 2.0 * load / expected * length / points as f64;
        if expected < length {
            assert!((largest / pressure - 1.0).abs() < 5e-3, "{largest} {pressure}");
        }
        let moment: f64 = found.forces.iter().enumerate().map(|(i, force)| force * (i as f64 + 0.5)).sum();
        let place_of_force = length * (moment / load / points as f64 - 0.5);
        assert!((place_of_force - effective).abs() < 1e-10, "{place_of_force} {effective}");
    }
}

#[test]
fn what_has_no_equilibrium_is_refused() {
    // Pulled off.
    let mut pulled = pad(5, 1.0, 0.1, 1.0, 0.0);
    pulled.load *= -1.0;
    let error = pulled.condensed().unwrap().equilibrium(&pulled.balance(0.2)).unwrap_err();
    assert!(matches!(error, ContactError::NoEquilibrium { .. }), "{error}");
    // Pressed beside its face: it tips over.
    let tipping = pad(5, 1.0, 0.1, 1.0, 0.7);
    for mu in [0.0, 0.2] {
        let error = tipping.condensed().unwrap().equilibrium(&tipping.balance(mu)).unwrap_err();
        assert!(matches!(error, ContactError::NoEquilibrium { .. }), "{error}");
    }
    // Nothing keeps it from moving along.
    let mut loose = pad(5, 1.0, 0.1, 1.0, 0.0);
    loose.k *= 0.0;
    let error = loose.condensed().unwrap_err();
    assert!(matches!(error, ContactError::NothingHolds { .. }), "{error}");
    let pad = pad(3, 1.0, 0.1, 1.0, 0.0);
    let condensed = pad.condensed().unwrap();
    let short = Balance { mu: vec![0.1], ..pad.balance(0.0) };
    assert!(matches!(condensed.equilibrium(&short), Err(ContactError::Count { found: 1, expected: 3, .. })));
    let none = Balance { loads: vec![f64::NAN], ..pad.balance(0.0) };
    assert!(matches!(condensed.equilibrium(&none), Err(ContactError::Value { .. })));
}

#[test]
fn several_equilibria_are_counted() {
    // Painleve's rod: a leaning spring presses a mass harder the more friction pulls it.
    let direction = DVector::from_column_slice(&[1.0, 0.7]);
    let structure = Structure {
        k: &direction * direction.transpose() * 50.0 + DMatrix::identity(2, 2),
        gaps: vec![vec![(1, 1.0)]],
        slips: vec![vec![(0, 1.0)]],
        stiffness: vec![1e3],
        open: vec![0.01],
        load: DVector::from_column_slice(&[0.0, 0.1]),
    };
    for (mu, count) in [(0.0, 1), (0.5, 1), (3.0, 2)] {
        let states = structure.states(mu);
        assert_eq!(states.len(), count, "{mu}: {states:?}");
        let found = structure.condensed().unwrap().equilibrium(&structure.balance(mu)).unwrap();
        let expected = if count == 1 { Uniqueness::Definite } else { Uniqueness::Several(2) };
        assert_eq!(found.uniqueness, expected, "{mu}");
    }
}

#[test]
fn a_law_between_pressure_and_overlap_is_met() {
    // One point: P = A c g^m.
    let one = Structure {
        k: DMatrix::from_element(1, 1, 0.0),
        gaps: vec![vec![(0, 1.0)]],
        slips: vec![vec![(0, 0.0)]],
        stiffness: vec![1e3],
        open: vec![0.25],
        load: DVector::from_column_slice(&[-40.0]),
    };
    let condensed = one.condensed().unwrap();
    for m in [1.0, 2.0, 3.3] {
        let law = Stiffness::Power { c: 7.0, m };
        let found = condensed.equilibrium_of_law(&one.balance(0.0), &law, &[0.5]).unwrap();
        let expected = -(40.0 / 3.5_f64).powf(1.0 / m);
        assert!((found.gaps[0] / expected - 1.0).abs() < 1e-12, "{m}: {found:?}");
        assert!((found.forces[0] / 40.0 - 1.0).abs() < 1e-11);
    }
    // A rigid pad under a law: forces and moments are in balance, each force is that of its overlap, whatever springs it was condensed with.
    let (points, load, place) = (40, 500.0, 0.3);
    let law = Stiffness::Power { c: 2e7, m: 2.0 };
    let mut before: Option<Vec<f64>> = None;
    for stiffness in [1e4, 1e6] {
        let mut pad = pad(points, 2.0, 0.3, load, place);
        pad.stiffness = vec![stiffness; points];
        let areas = vec![0.02; points];
        let found = pad.condensed().unwrap().equilibrium_of_law(&pad.balance(0.4), &law, &areas).unwrap();
        assert!((found.forces.iter().sum::<f64>() / load - 1.0).abs() < 1e-10);
        let moment: f64 = found.forces.iter().enumerate().map(|(i, f)| f * 2.0 * ((i as f64 + 0.5) / 40.0 - 0.5)).sum();
        assert!((moment / load - (place - 0.4 * 0.3)).abs() < 1e-10);
        for (force, gap) in found.forces.iter().zip(&found.gaps) {
            assert!((force - 2e7 * 0.02 * gap.min(0.0).powi(2)).abs() < 1e-9 * load);
        }
        if let Some(before) = before.replace(found.forces.clone()) {
            assert!(before.iter().zip(&found.forces).all(|(a, b)| (a - b).abs() < 1e-9 * load));
        }
    }
}
