//! The parameters of a lattice by the names that its case file has for them.

use cycle::ContactSystem;
use linsys::SecondOrder;
use osc_model::{Lateral, LatticeModel, LatticeParameters, Preload, PreparedLattice};
use study::{NamedParameter, Scene};

use super::{FrictionDraw, LatticeBrake, LatticeSample, sliding_under};
use crate::Error;
use crate::case::{LatticeReadings, Law};
use crate::friction_parameters::{FRICTION, FrictionParameter, FrictionUse};

/// Values of a scene that its parameters can change.
#[derive(Debug, Clone)]
struct Values {
    /// Friction, alike in all contacts.
    draw: FrictionDraw,
    /// Sliding speed, m/s.
    speed: f64,
    readings: LatticeReadings,
    lattice: LatticeParameters,
}

/// A parameter of speed, load or structure.
struct LatticeParameter {
    name: &'static str,
    unit: &'static str,
    /// Reads the parameter, in its unit; `None` where it has several values, as a stiffness that is not the same of all springs.
    get: fn(&Values) -> Option<f64>,
    /// Gives the parameter a value, in its unit.
    set: fn(&mut Values, f64),
    /// True if the systems under a law depend on the parameter.
    matters: fn(Law, &LatticeReadings) -> bool,
    /// True if M, C or K of the lattice depend on the parameter, so that the lattice has to be assembled anew.
    is_structural: bool,
}

/// A parameter of a scene, of any kind.
enum SceneParameter {
    Friction(&'static FrictionParameter),
    Lattice(&'static LatticeParameter),
    /// The stiffness of one contact, by the index of its oscillator.
    Contact(usize),
}

/// The parameter that is one value of all springs, dashpots or oscillators, where they have the same: a field of [`LatticeParameters`], with its unit.
macro_rules! of_all {
    ($name:ident, $unit:literal) => {
        LatticeParameter {
            name: stringify!($name),
            unit: $unit,
            get: |at| alike(&at.lattice.$name),
            set: |at, value| at.lattice.$name.fill(value),
            matters: |_, _| true,
            is_structural: true,
        }
    };
}

/// Every parameter of speed, load and structure. In the list of a scene they follow the parameters of friction and precede the stiffnesses of single contacts.
const LATTICE: &[LatticeParameter] = &[
    LatticeParameter {
        name: "v",
        unit: "m/s",
        get: |at| Some(at.speed),
        set: |at, value| at.speed = value,
        matters: depends_on_sliding,
        is_structural: false,
    },
    LatticeParameter {
        name: "preload",
        unit: "N",
        get: |at| Some(force(at.readings.preload)),
        set: |at, value| at.readings.preload = with_force(at.readings.preload, value),
        matters: depends_on_sliding,
        is_structural: false,
    },
    LatticeParameter {
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
    LatticeParameter {
        name: "theta",
        unit: "degrees",
        get: |at| Some(at.lattice.theta.to_degrees()),
        set: |at, value| at.lattice.theta = value.to_radians(),
        matters: |_, _| true,
        is_structural: true,
    },
    LatticeParameter {
        name: "phi",
        unit: "degrees",
        get: |at| Some(at.lattice.phi.to_degrees()),
        set: |at, value| at.lattice.phi = value.to_radians(),
        matters: |_, _| true,
        is_structural: true,
    },
    LatticeParameter {
        name: "plate.mass",
        unit: "kg",
        get: |at| Some(at.lattice.plate.mass),
        set: |at, value| at.lattice.plate.mass = value,
        matters: |_, _| true,
        is_structural: true,
    },
];

/// True if the systems under a law depend on speed and load. Coulomb friction along the sliding depends on neither; across it, under [`Lateral::Vector`],
/// it is a dashpot mu N0 / v.
fn depends_on_sliding(law: Law, readings: &LatticeReadings) -> bool {
    law != Law::AmontonsCoulomb || readings.lateral == Lateral::Vector
}

/// The force of a preload, N, whatever it acts on.
fn force(preload: Preload) -> f64 {
    let (Preload::PerContact(force) | Preload::Clamp(force) | Preload::Equilibrium(force)) = preload;
    force
}

/// The preload of the same kind with another force, N.
fn with_force(preload: Preload, force: f64) -> Preload {
    match preload {
        Preload::PerContact(_) => Preload::PerContact(force),
        Preload::Clamp(_) => Preload::Clamp(force),
        Preload::Equilibrium(_) => Preload::Equilibrium(force),
    }
}

/// The value of all entries of a list; `None` if they differ or the list is empty.
fn alike(list: &[f64]) -> Option<f64> {
    let first = *list.first()?;
    list.iter().all(|value| *value == first).then_some(first)
}

/// The values of a scene at the medians of all distributions.
fn medians(brake: &LatticeBrake, scene: &Scene) -> Values {
    let median = LatticeSample::median(&brake.case);
    Values {
        draw: *median.contact(0),
        speed: brake.speed(scene.key, &median),
        readings: brake.case.readings,
        lattice: brake.case.lattice.clone(),
    }
}

impl SceneParameter {
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

/// The parameters on which the systems of a scene depend, with their medians. Indices of parameters below are places in this list, which [`named`] has, too.
fn of_scene(brake: &LatticeBrake, scene: &Scene) -> Vec<(SceneParameter, f64)> {
    let (law, at) = (brake.law(scene.key), medians(brake, scene));
    let of = FrictionUse {
        law,
        has_lateral_mu: at.readings.lateral != Lateral::None,
        has_bristle_damping: at.readings.bristle_damping.is_some(),
    };
    let friction = FRICTION.iter().filter(|parameter| (parameter.matters)(&of)).map(SceneParameter::Friction);
    let lattice =
        LATTICE.iter().filter(|parameter| (parameter.matters)(law, &at.readings)).map(SceneParameter::Lattice);
    let contacts =
        brake.lattice(scene).arrangement().in_contact().iter().map(|&oscillator| SceneParameter::Contact(oscillator));
    let all = friction.chain(lattice).chain(contacts);
    all.filter_map(|parameter| parameter.get(&at).map(|median| (parameter, median))).collect()
}

/// The parameters of a scene, in the order of [`of_scene`].
pub(super) fn named(brake: &LatticeBrake, scene: &Scene) -> Vec<NamedParameter> {
    let named = |(parameter, median): (SceneParameter, f64)| NamedParameter {
        name: parameter.name(),
        unit: parameter.unit().into(),
        median,
    };
    of_scene(brake, scene).into_iter().map(named).collect()
}

/// The lattice of a scene with changed parameters; `None` if none of them is structural, so that it is the lattice of the medians.
type Changed = Option<PreparedLattice>;

/// Values of a scene whose parameters have `values`, by their indices, and all others their medians; and the lattice with them.
fn with_values(brake: &LatticeBrake, scene: &Scene, values: &[(usize, f64)]) -> Result<(Values, Changed), Error> {
    let (mut at, mut is_structural) = (medians(brake, scene), false);
    let parameters = of_scene(brake, scene);
    for &(place, value) in values {
        let (parameter, _) = &parameters[place];
        parameter.set(&mut at, value);
        is_structural |= parameter.is_structural();
    }
    if !is_structural {
        return Ok((at, None));
    }
    let fixed = &brake.case.constraints[scene.key.constraints].fixed;
    let model = LatticeModel::new(at.lattice.clone(), at.readings.lateral, fixed)?;
    let lattice = model.prepare(brake.lattice(scene).arrangement())?;
    Ok((at, Some(lattice)))
}

/// The system of a scene whose parameters have `values`, by their indices, and all others their medians.
pub(super) fn system(brake: &LatticeBrake, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, Error> {
    let (at, changed) = with_values(brake, scene, values)?;
    let lattice = changed.as_ref().unwrap_or_else(|| brake.lattice(scene));
    // 0.5 is the quantile of the sample's speed, which is not used: the speed is given beside it.
    let sample = LatticeSample::shared(at.draw, 0.5);
    let state = sliding_under(&at.readings, lattice, brake.law(scene.key), at.speed, &sample)?;
    Ok(lattice.brake().system.assemble(&lattice.operating_point(&state)?)?)
}

/// The equations of motion of the lattice of a scene whose parameters have `values`, by their indices, and all others their medians. A contact sticks where
/// it slides with less than `stick` of its steady speed, 0 to 1.
pub(super) fn contact_system(
    brake: &LatticeBrake,
    scene: &Scene,
    values: &[(usize, f64)],
    stick: f64,
) -> Result<ContactSystem, Error> {
    let (mut at, changed) = with_values(brake, scene, values)?;
    let lattice = changed.as_ref().unwrap_or_else(|| brake.lattice(scene));
    if scene.key.speed.is_none() {
        // The tangent of the law depends on no speed, but the speed at which a contact sticks does: the median of the first range is taken.
        at.speed = brake.case.speeds[0].quantile(0.5);
    }
    // The quantile is not used here either.
    let sample = LatticeSample::shared(at.draw, 0.5);
    let (readings, stiffness) = (&at.readings, &at.lattice.contact_stiffness);
    super::contact_system(lattice, brake.law(scene.key), (readings, stiffness), (at.speed, &sample), stick)
}
