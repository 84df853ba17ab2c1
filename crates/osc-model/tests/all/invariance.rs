//! Properties of every lattice: eigenvalues do not depend on numbering and units, symmetric systems do not flutter.

#![allow(clippy::unwrap_used)]

use crate::common::{set_distance, spectrum, uniform};
use friction::{BristleDamping, FrictionLaw, LuGre, LuGreParameters, Tangent};
use osc_model::{
    Axis, ContactArrangement, ContactPoint, Dof, Grid, Lateral, LatticeBody, LatticeModel, LatticeParameters, Reversal,
    Sign, Sliding,
};
use proptest::prelude::*;

/// A lattice, an arrangement and a sliding state without symmetry.
#[derive(Debug, Clone)]
struct Case {
    parameters: LatticeParameters,
    lateral: Lateral,
    constraints: Vec<Dof>,
    in_contact: Vec<usize>,
    speed: f64,
    laws: Vec<LuGreParameters>,
    loads: Vec<f64>,
}

impl Case {
    fn spectrum(&self) -> Vec<num_complex::Complex<f64>> {
        let contacts = self.laws.iter().zip(&self.loads).map(|(&law, &normal_load)| ContactPoint {
            tangent: LuGre::new(law).unwrap().tangent_at(self.speed).unwrap(),
            lateral_mu: 0.8 * law.mu_k,
            normal_load,
        });
        let sliding = Sliding { speed: self.speed, contacts: contacts.collect() };
        let model = LatticeModel::new(self.parameters.clone(), self.lateral, &self.constraints).unwrap();
        spectrum(
            &model,
            &ContactArrangement::new(model.parameters().grid.oscillators(), &self.in_contact).unwrap(),
            &sliding,
        )
    }
}

fn perturbed(values: Vec<f64>) -> impl Strategy<Value = Vec<f64>> {
    let count = values.len();
    prop::collection::vec(0.5..2.0, count).prop_map(move |f| values.iter().zip(&f).map(|(v, f)| v * f).collect())
}

fn lattice() -> impl Strategy<Value = LatticeParameters> {
    (1_usize..=3, 1_usize..=3).prop_flat_map(|(rows, columns)| {
        let p = uniform(Grid::new(rows, columns).unwrap());
        (
            perturbed(p.x_stiffness.clone()),
            perturbed(p.y_stiffness.clone()),
            perturbed(p.x_damping.clone()),
            perturbed(p.z_damping.clone()),
            perturbed(p.inclined_stiffness.clone()),
            perturbed(p.contact_stiffness.clone()),
            perturbed(p.oscillator_mass.clone()),
        )
            .prop_map(
                move |(x_stiffness, y_stiffness, x_damping, z_damping, inclined, contact_stiffness, mass)| {
                    LatticeParameters {
                        x_stiffness,
                        y_stiffness,
                        x_damping,
                        z_damping,
                        inclined_stiffness: inclined,
                        contact_stiffness,
                        oscillator_mass: mass,
                        ..p.clone()
                    }
                },
            )
    })
}

fn law() -> impl Strategy<Value = LuGreParameters> {
    (0.2..0.6, 0.0..0.3, 0.3..1.0, 5e4..2e5, 0.0..20.0, 0.0..0.01).prop_map(
        |(mu_k, gap, v_s, sigma0, sigma1, sigma2)| LuGreParameters {
            mu_s: mu_k + gap,
            mu_k,
            v_s,
            sigma0,
            sigma1,
            sigma2,
            bristle_damping: BristleDamping::Constant,
        },
    )
}

fn case() -> impl Strategy<Value = Case> {
    lattice().prop_flat_map(|parameters| {
        let n = parameters.grid.oscillators();
        let lateral = prop_oneof![
            Just(Lateral::None),
            Just(Lateral::Coupled { sign: Sign::Plus }),
            Just(Lateral::Coupled { sign: Sign::Minus }),
            Just(Lateral::Vector)
        ];
        let some = prop::sample::subsequence((0..n).collect::<Vec<_>>(), 1..=n);
        let laws = prop::collection::vec(law(), n);
        let loads = prop::collection::vec(100.0..1000.0, n);
        (lateral, some, 0..n, 0.1..5.0, laws, loads).prop_map(move |(lateral, in_contact, held, speed, laws, loads)| {
            Case {
                parameters: parameters.clone(),
                lateral,
                constraints: vec![Dof { axis: Axis::X, body: LatticeBody::Oscillator(held) }],
                laws: laws[..in_contact.len()].to_vec(),
                loads: loads[..in_contact.len()].to_vec(),
                in_contact,
                speed,
            }
        })
    })
}

/// The case with every list in the order of new labels.
fn relabelled(case: &Case, reversal: Reversal) -> Case {
    let grid = case.parameters.grid;
    let (rows, columns) = (grid.rows(), grid.columns());
    let label = |i: usize| reversal.oscillator(grid, i);
    let turn_rows = matches!(reversal, Reversal::Rows | Reversal::Both);
    let turn_columns = matches!(reversal, Reversal::Columns | Reversal::Both);
    let each = |values: &[f64]| (0..values.len()).map(|i| values[label(i)]).collect::<Vec<_>>();
    let chains = |values: &[f64], length: usize, turn_chains: bool, turn_along: bool| -> Vec<f64> {
        let count = values.len() / length;
        let place = |at: usize, of: usize, turn: bool| if turn { of - 1 - at } else { at };
        (0..values.len())
            .map(|i| values[place(i / length, count, turn_chains) * length + place(i % length, length, turn_along)])
            .collect()
    };
    let p = &case.parameters;
    let mut contacts: Vec<(usize, LuGreParameters, f64)> =
        (0..case.in_contact.len()).map(|c| (label(case.in_contact[c]), case.laws[c], case.loads[c])).collect();
    contacts.sort_by_key(|contact| contact.0);
    Case {
        parameters: LatticeParameters {
            x_stiffness: chains(&p.x_stiffness, columns + 1, turn_rows, turn_columns),
            x_damping: chains(&p.x_damping, columns + 1, turn_rows, turn_columns),
            y_stiffness: chains(&p.y_stiffness, rows + 1, turn_columns, turn_rows),
            y_damping: chains(&p.y_damping, rows + 1, turn_columns, turn_rows),
            z_damping: each(&p.z_damping),
            inclined_stiffness: each(&p.inclined_stiffness),
            contact_stiffness: each(&p.contact_stiffness),
            oscillator_mass: each(&p.oscillator_mass),
            ..p.clone()
        },
        constraints: case
            .constraints
            .iter()
            .map(|dof| Dof {
                body: if let LatticeBody::Oscillator(i) = dof.body {
                    LatticeBody::Oscillator(label(i))
                } else {
                    dof.body
                },
                ..*dof
            })
            .collect(),
        in_contact: contacts.iter().map(|c| c.0).collect(),
        laws: contacts.iter().map(|c| c.1).collect(),
        loads: contacts.iter().map(|c| c.2).collect(),
        ..case.clone()
    }
}

/// The same lattice in units of `mass` kg, `length` m and `time` s.
fn in_units(case: &Case, mass: f64, length: f64, time: f64) -> Case {
    let scaled = |values: &[f64], unit: f64| values.iter().map(|v| v / unit).collect::<Vec<_>>();
    let (stiffness, damping, speed) = (mass / time.powi(2), mass / time, length / time);
    let p = &case.parameters;
    let mut plate = p.plate;
    plate.mass /= mass;
    plate.stiffness = plate.stiffness.map(|k| k / stiffness);
    plate.damping = plate.damping.map(|c| c / damping);
    let laws = case.laws.iter().map(|law| LuGreParameters {
        v_s: law.v_s / speed,
        sigma0: law.sigma0 * length,
        sigma1: law.sigma1 * speed,
        sigma2: law.sigma2 * speed,
        ..*law
    });
    Case {
        parameters: LatticeParameters {
            x_stiffness: scaled(&p.x_stiffness, stiffness),
            y_stiffness: scaled(&p.y_stiffness, stiffness),
            inclined_stiffness: scaled(&p.inclined_stiffness, stiffness),
            contact_stiffness: scaled(&p.contact_stiffness, stiffness),
            x_damping: scaled(&p.x_damping, damping),
            y_damping: scaled(&p.y_damping, damping),
            z_damping: scaled(&p.z_damping, damping),
            oscillator_mass: scaled(&p.oscillator_mass, mass),
            plate,
            ..p.clone()
        },
        speed: case.speed / speed,
        laws: laws.collect(),
        loads: scaled(&case.loads, mass * length / time.powi(2)),
        ..case.clone()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn labels_do_not_matter(case in case(), which in 0_usize..4) {
        let distance = set_distance(&case.spectrum(), &relabelled(&case, Reversal::ALL[which]).spectrum());
        prop_assert!(distance < 1e-9, "{distance:e}");
    }

    #[test]
    fn units_do_not_matter(case in case()) {
        let si = case.spectrum();
        let tonnes_and_millimetres = in_units(&case, 1e3, 1e-3, 1.0).spectrum();
        let distance = set_distance(&si, &tonnes_and_millimetres);
        prop_assert!(distance < 1e-9, "tonne, millimetre, second: {distance:e}");
        let milliseconds: Vec<_> = in_units(&case, 1.0, 1e-3, 1e-3).spectrum().iter().map(|l| l * 1e3).collect();
        let distance = set_distance(&si, &milliseconds);
        prop_assert!(distance < 1e-9, "kilogram, millimetre, millisecond: {distance:e}");
    }

    #[test]
    fn symmetric_lattice_does_not_flutter(case in case(), slope in 0.0..0.02) {
        let n = case.in_contact.len();
        let tangent = Tangent { mu: 0.0, slope, internal: None };
        let contact = ContactPoint { tangent, lateral_mu: 0.0, normal_load: 600.0 };
        let model = LatticeModel::new(case.parameters.clone(), case.lateral, &case.constraints).unwrap();
        let arrangement = ContactArrangement::new(model.parameters().grid.oscillators(), &case.in_contact).unwrap();
        let sliding = Sliding { speed: case.speed, contacts: vec![contact; n] };
        for lambda in spectrum(&model, &arrangement, &sliding) {
            prop_assert!(lambda.re < 0.0, "{lambda}");
        }
    }
}
