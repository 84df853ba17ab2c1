//! The parameters of a lattice by the names that its case file has for them.

use cycle::ContactSystem;
use linsys::SecondOrder;
use osc_model::{Lateral, LatticeModel, LatticeParameters, Preload, PreparedLattice};
use study::{NamedParameter, Scene};

use super::{FrictionDraw, LatticeBrake, LatticeSample, sliding_under};
use crate::Error;
use crate::case::{LatticeReadings, Law};
use crate::friction_parameters::{FRICTION, FrictionParameter, FrictionUse};

/// Values that the parameters of a scene can change.
#[derive(Debug, Clone)]
struct Values {
    draw: FrictionDraw,
    speed: f64,
    readings: LatticeReadings,
    lattice: LatticeParameters,
}

/// Parameter of speed, load or structure.
struct Parameter {
    name: &'static str,
    unit: &'static str,
    /// Value of the parameter, in its unit; `None` where it is not one number.
    get: fn(&Values) -> Option<f64>,
    set: fn(&mut Values, f64),
    /// True if the systems of a law depend on the parameter.
    matters: fn(Law, &LatticeReadings) -> bool,
    /// True if the lattice has to be assembled anew.
    is_structural: bool,
}

/// A parameter of a scene.
enum Choice {
    Friction(&'static FrictionParameter),
    Lattice(&'static Parameter),
    /// The stiffness of one contact, by the index of its oscillator.
    Contact(usize),
}

/// A value of every spring, dashpot or oscillator, where all have the same.
macro_rules! of_all {
    ($name:ident, $unit:literal) => {
        Parameter {
            name: stringify!($name),
            unit: $unit,
            get: |at| alike(&at.lattice.$name),
            set: |at, value| at.lattice.$name.fill(value),
            matters: |_, _| true,
            is_structural: true,
        }
    };
}

/// Every parameter but those of friction, which come first, and those of single contacts, which come last.
const LATTICE: &[Parameter] = &[
    Parameter {
        name: "v",
        unit: "m/s",
        get: |at| Some(at.speed),
        set: |at, value| at.speed = value,
        matters: speed_matters,
        is_structural: false,
    },
    Parameter {
        name: "preload",
        unit: "N",
        get: |at| Some(force(at.readings.preload)),
        set: |at, value| at.readings.preload = with_force(at.readings.preload, value),
        matters: speed_matters,
        is_structural: false,
    },
    Parameter {
        name: "damping",
        unit: "times every dashpot",
        get: |_| Some(1.0),
        set: |at, value| {
            let lattice = &mut at.lattice;
            let lists = [&mut lattice.x_damping, &mut lattice.y_damping, &mut lattice.z_damping];
            let dashpots = lists.into_iter().flatten().chain(&mut lattice.plate.damping);
            dashpots.for_each(|dashpot| *dashpot *= value);
        },
        matters: |_, _| true,
        is_structural: true,
    },
    of_all!(x_damping, "Ns/m"),
    of_all!(y_damping, "Ns/m"),
    of_all!(z_damping, "Ns/m"),
    of_all!(oscillator_mass, "kg"),
    of_all!(x_stiffness, "N/m"),
    of_all!(y_stiffness, "N/m"),
    of_all!(inclined_stiffness, "N/m"),
    of_all!(contact_stiffness, "N/m"),
    Parameter {
        name: "theta",
        unit: "degrees",
        get: |at| Some(at.lattice.theta.to_degrees()),
        set: |at, value| at.lattice.theta = value.to_radians(),
        matters: |_, _| true,
        is_structural: true,
    },
    Parameter {
        name: "phi",
        unit: "degrees",
        get: |at| Some(at.lattice.phi.to_degrees()),
        set: |at, value| at.lattice.phi = value.to_radians(),
        matters: |_, _| true,
        is_structural: true,
    },
    Parameter {
        name: "plate.mass",
        unit: "kg",
        get: |at| Some(at.lattice.plate.mass),
        set: |at, value| at.lattice.plate.mass = value,
        matters: |_, _| true,
        is_structural: true,
    },
];

/// Coulomb friction along the sliding knows neither speed nor load; across it under [`Lateral::Vector`] it is a dashpot mu N0 / v.
fn speed_matters(law: Law, readings: &LatticeReadings) -> bool {
    law != Law::AmontonsCoulomb || readings.lateral == Lateral::Vector
}

fn force(preload: Preload) -> f64 {
    let (Preload::PerContact(force) | Preload::Clamp(force) | Preload::Equilibrium(force)) = preload;
    force
}

fn with_force(preload: Preload, force: f64) -> Preload {
    match preload {
        Preload::PerContact(_) => Preload::PerContact(force),
        Preload::Clamp(_) => Preload::Clamp(force),
        Preload::Equilibrium(_) => Preload::Equilibrium(force),
    }
}

/// The value that all entries of a list have.
fn alike(list: &[f64]) -> Option<f64> {
    let first = *list.first()?;
    list.iter().all(|value| *value == first).then_some(first)
}

/// The medians of a scene.
fn medians(brake: &LatticeBrake, scene: &Scene) -> Values {
    let median = LatticeSample::median(&brake.case);
    Values {
        draw: *median.contact(0),
        speed: brake.speed(scene.key, &median),
        readings: brake.case.readings,
        lattice: brake.case.lattice.clone(),
    }
}

impl Choice {
    fn name(&self) -> String {
        match self {
            Self::Friction(parameter) => parameter.name.into(),
            Self::Lattice(parameter) => parameter.name.into(),
            Self::Contact(oscillator) => format!("contact_stiffness.{}", oscillator + 1),
        }
    }

    fn unit(&self) -> &'static str {
        match self {
            Self::Friction(parameter) => parameter.unit,
            Self::Lattice(parameter) => parameter.unit,
            Self::Contact(_) => "N/m",
        }
    }

    fn get(&self, at: &Values) -> Option<f64> {
        match self {
            Self::Friction(parameter) => Some((parameter.get)(&at.draw)),
            Self::Lattice(parameter) => (parameter.get)(at),
            Self::Contact(oscillator) => Some(at.lattice.contact_stiffness[*oscillator]),
        }
    }

    fn set(&self, at: &mut Values, value: f64) {
        match self {
            Self::Friction(parameter) => (parameter.set)(&mut at.draw, value),
            Self::Lattice(parameter) => (parameter.set)(at, value),
            Self::Contact(oscillator) => at.lattice.contact_stiffness[*oscillator] = value,
        }
    }

    fn is_structural(&self) -> bool {
        match self {
            Self::Friction(_) => false,
            Self::Lattice(parameter) => parameter.is_structural,
            Self::Contact(_) => true,
        }
    }
}

/// The parameters on which the systems of a scene depend, with their medians.
fn of_scene(brake: &LatticeBrake, scene: &Scene) -> Vec<(Choice, f64)> {
    let (law, at) = (brake.law(scene.key), medians(brake, scene));
    let of = FrictionUse {
        law,
        has_lateral_mu: at.readings.lateral != Lateral::None,
        has_bristle_damping: at.readings.bristle_damping.is_some(),
    };
    let friction = FRICTION.iter().filter(|parameter| (parameter.matters)(&of)).map(Choice::Friction);
    let lattice = LATTICE.iter().filter(|parameter| (parameter.matters)(law, &at.readings)).map(Choice::Lattice);
    let contacts =
        brake.lattice(scene).arrangement().in_contact().iter().map(|&oscillator| Choice::Contact(oscillator));
    let all = friction.chain(lattice).chain(contacts);
    all.filter_map(|choice| choice.get(&at).map(|median| (choice, median))).collect()
}

pub(super) fn named(brake: &LatticeBrake, scene: &Scene) -> Vec<NamedParameter> {
    let named =
        |(choice, median): (Choice, f64)| NamedParameter { name: choice.name(), unit: choice.unit().into(), median };
    of_scene(brake, scene).into_iter().map(named).collect()
}

/// The lattice of a scene in which some parameters have values; `None` where it is that of the medians.
type Changed = Option<PreparedLattice>;

/// Values of all parameters of a scene in which some have other values than their medians.
fn with_values(brake: &LatticeBrake, scene: &Scene, values: &[(usize, f64)]) -> Result<(Values, Changed), Error> {
    let (mut at, mut is_structural) = (medians(brake, scene), false);
    let parameters = of_scene(brake, scene);
    for &(place, value) in values {
        let (choice, _) = &parameters[place];
        choice.set(&mut at, value);
        is_structural |= choice.is_structural();
    }
    if !is_structural {
        return Ok((at, None));
    }
    let fixed = &brake.case.constraints[scene.key.constraints].fixed;
    let model = LatticeModel::new(at.lattice.clone(), at.readings.lateral, fixed)?;
    let lattice = model.prepare(brake.lattice(scene).arrangement())?;
    Ok((at, Some(lattice)))
}

pub(super) fn system(brake: &LatticeBrake, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, Error> {
    let (at, changed) = with_values(brake, scene, values)?;
    let lattice = changed.as_ref().unwrap_or_else(|| brake.lattice(scene));
    let sample = LatticeSample::shared(at.draw, 0.5);
    let state = sliding_under(&at.readings, lattice, brake.law(scene.key), at.speed, &sample)?;
    Ok(lattice.brake().system.assemble(&lattice.operating_point(&state)?)?)
}

/// The equations of motion of a lattice, with values of some parameters.
pub(super) fn contact_system(
    brake: &LatticeBrake,
    scene: &Scene,
    values: &[(usize, f64)],
    stick: f64,
) -> Result<ContactSystem, Error> {
    let (mut at, changed) = with_values(brake, scene, values)?;
    let lattice = changed.as_ref().unwrap_or_else(|| brake.lattice(scene));
    if scene.key.speed.is_none() {
        // A tangent that no speed matters to; a motion sticks at its own.
        at.speed = brake.case.speeds[0].quantile(0.5);
    }
    let sample = LatticeSample::shared(at.draw, 0.5);
    let (readings, stiffness) = (&at.readings, &at.lattice.contact_stiffness);
    super::contact_system(lattice, brake.law(scene.key), (readings, stiffness), (at.speed, &sample), stick)
}
