//! Candidates of a screening: single changes of a brake, and groups of them that its symmetries make.

use std::collections::BTreeSet;

use nalgebra::DMatrix;
use output::significant;
use serde::{Deserialize, Serialize};
use study::{
    Direction, Modifiable, ModifiablePlan, Moves, OwnSize, Place, Plan, Symmetry, UncertainBrake, Units, origin_of_set,
};

use super::change::{Attached, Change, Scaled};
use super::modified::modifiable_of;
use crate::Error;

/// Kind of changes. Sets are of one kind: whether a constraint or a dashpot costs more is not for a program to say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChangeKind {
    /// A degree of freedom is held.
    Constraint,
    /// One mass is added to a place, in all its directions: a body that is a point mass, another degree of freedom, a set of nodes.
    Mass,
    /// A spring to ground is added.
    Spring,
    /// A dashpot to ground is added.
    Dashpot,
    /// A contact is taken out.
    Contact,
    /// A part is scaled: the stiffness, the damping, the mass of a term, or all of it.
    Scale,
    /// A variant of the brake, which is another one: nothing that a search could make.
    Variant,
}

impl ChangeKind {
    /// Kinds of changes that a search makes, all of them.
    pub const ALL: [Self; 6] = [Self::Constraint, Self::Mass, Self::Spring, Self::Dashpot, Self::Contact, Self::Scale];

    /// Kinds in the order in which they are shown: variants first.
    pub fn shown() -> impl Iterator<Item = Self> {
        [Self::Variant].into_iter().chain(Self::ALL)
    }

    /// Name in tables and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constraint => "constraint",
            Self::Mass => "mass",
            Self::Spring => "spring",
            Self::Dashpot => "dashpot",
            Self::Contact => "contact",
            Self::Scale => "scale",
            Self::Variant => "variant",
        }
    }

    /// Unit of the size of a change at a place that moves so; empty where it has none, or the brake does not say which.
    pub fn unit(self, moves: Moves, units: Units) -> &'static str {
        match (self, moves) {
            (Self::Mass, Moves::Along) => units.of("kg"),
            (Self::Mass, Moves::Turns) => units.of("kgm^2"),
            (Self::Spring, Moves::Along) => units.of("N/m"),
            (Self::Spring, Moves::Turns) => units.of("Nm/rad"),
            (Self::Dashpot, Moves::Along) => units.of("Ns/m"),
            (Self::Dashpot, Moves::Turns) => units.of("Nms/rad"),
            (Self::Scale, _) => "times",
            (Self::Mass | Self::Spring | Self::Dashpot, Moves::Unknown)
            | (Self::Constraint | Self::Contact | Self::Variant, _) => "",
        }
    }

    /// Words for the action, for people.
    pub fn action(self) -> &'static str {
        match self {
            Self::Constraint => "hold",
            Self::Mass => "add a mass to",
            Self::Spring => "add a spring to ground to",
            Self::Dashpot => "add a dashpot to ground to",
            Self::Contact => "take out contact",
            Self::Scale => "scale",
            Self::Variant => "variant",
        }
    }
}

/// Sizes of masses, springs and dashpots, and the factor by which parts are scaled.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sizes {
    /// Mass, kg, or in the units of a case that does not say how its degrees of freedom move; `None`: [`Sizes::PART`] times the place's own mass, which is the
    /// least mass over its directions.
    pub mass: Option<f64>,
    /// Stiffness of a spring, N/m; `None`: [`Sizes::PART`] times the direction's own stiffness.
    pub spring: Option<f64>,
    /// Damping of a dashpot, Ns/m; `None`: `2 zeta sqrt(k m)`, zeta = [`Sizes::DAMPING_RATIO`], with the direction's own stiffness k and mass m,
    /// as if it were uncoupled.
    pub dashpot: Option<f64>,
    /// Factor by which parts are scaled, > 1, up and down; `None`: [`Sizes::FACTOR`].
    pub factor: Option<f64>,
}

impl Sizes {
    /// Fraction of a place's own mass and stiffness that is added; chosen: small enough to be built, large enough to be seen.
    pub const PART: f64 = 0.05;
    /// Damping ratio zeta, 1, that a dashpot of `2 zeta sqrt(k m)` adds to a direction as if it were uncoupled; chosen.
    pub const DAMPING_RATIO: f64 = 0.01;

    /// Factor by which parts are scaled; chosen: as far as a lining of another lot may be off.
    pub const FACTOR: f64 = 1.1;

    /// Words, for people, for the sizes in proportion of those of `kinds` whose size is not given; empty where no size is in proportion.
    pub fn in_proportion(&self, kinds: &[ChangeKind]) -> String {
        let has = |kind: ChangeKind, given: Option<f64>| kinds.contains(&kind) && given.is_none();
        let mut said = Vec::new();
        let parts = match [has(ChangeKind::Mass, self.mass), has(ChangeKind::Spring, self.spring)] {
            [true, true] => "a mass or spring",
            [true, false] => "a mass",
            [false, true] => "a spring",
            [false, false] => "",
        };
        if !parts.is_empty() {
            said.push(format!("{parts} is {} % of its place's own", 100.0 * Self::PART));
        }
        if has(ChangeKind::Dashpot, self.dashpot) {
            let percent = 100.0 * Self::DAMPING_RATIO;
            said.push(format!("a dashpot adds {percent} % of critical damping to its direction left to itself"));
        }
        if has(ChangeKind::Scale, self.factor) {
            said.push(format!("a part is scaled by {} and by 1 over it", Self::FACTOR));
        }
        said.join(", ")
    }

    fn spring(&self, own: OwnSize) -> f64 {
        self.spring.unwrap_or(Self::PART * own.stiffness)
    }

    fn dashpot(&self, own: OwnSize) -> f64 {
        self.dashpot.unwrap_or(2.0 * Self::DAMPING_RATIO * (own.stiffness * own.mass).max(0.0).sqrt())
    }

    /// The mass for a place, kg. Its directions may have own masses that differ; the least counts, as one mass acts in all of them.
    fn mass(&self, place: &Place) -> f64 {
        let own = place.directions.iter().map(|direction| direction.own.mass).fold(f64::INFINITY, f64::min);
        self.mass.unwrap_or(Self::PART * own)
    }
}

/// A change at one place.
#[derive(Debug, Clone, PartialEq)]
pub struct SingleChange {
    /// Name of what is changed: for a mass the place (a body, a degree of freedom, a set of nodes), for a spring, a dashpot or a constraint the
    /// direction of the place, else the contact.
    pub name: String,
    /// Change at the place.
    pub change: Change,
    /// Kind of the motion of the place.
    pub moves: Moves,
}

impl SingleChange {
    /// Size of the change, in the unit of its kind; `None` of one that has no size.
    pub fn size(&self) -> Option<f64> {
        match self.change {
            Change::Attach { size, .. } | Change::Scale { factor: size, .. } => Some(size),
            Change::Hold { .. } | Change::TakeOut { .. } => None,
        }
    }
}

/// Candidates of one kind: everything that could be changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidates {
    /// Kind of the changes.
    pub kind: ChangeKind,
    /// Single changes, each at one place.
    pub singles: Vec<SingleChange>,
    /// Images of the single changes: `images[symmetry][single]` is the index in `singles` of the image of `single`; without symmetries the
    /// identity alone. A symmetry under which the image of some single change is not in `singles` is left out, as it has no index. Changes are
    /// compared to the last bit, sizes included, and sizes in proportion can differ by rounding between a place and its image; what such a
    /// symmetry would have made one is then analysed apart.
    images: Vec<Vec<usize>>,
    /// Groups of single changes that can be made at once, as ascending indices into `singles`: each by itself, each with its image under one
    /// symmetry, and each with its images under all of them.
    pub groups: Vec<Vec<usize>>,
}

impl Candidates {
    /// Candidates for changes of a brake under a set of constraints, kind by kind; `constraints` is an index in
    /// [`SceneLabels::constraints`](study::SceneLabels::constraints) of [`Plan::labels`].
    ///
    /// # Errors
    /// Those of [`Modifiable::places`].
    pub fn all<B: UncertainBrake>(
        brake: &B,
        constraints: usize,
        kinds: &[ChangeKind],
        sizes: &Sizes,
    ) -> Result<Vec<Self>, Error> {
        let by_plan = ModifiablePlan(brake.plan());
        let modifiable = modifiable_of(brake, &by_plan)?;
        let given = modifiable.places(constraints)?;
        let places = match given {
            Some(places) => places,
            None => degrees_of_freedom(brake.plan(), constraints)?,
        };
        let of_kind = |&kind: &ChangeKind| {
            let singles = match kind {
                ChangeKind::Contact => contacts(brake.plan(), modifiable, constraints),
                ChangeKind::Scale => scaled(brake.plan(), modifiable, constraints, sizes),
                _ => places.iter().flat_map(|place| attached(kind, place, sizes)).collect(),
            };
            Self::new(kind, singles, &modifiable.symmetries(constraints))
        };
        Ok(kinds.iter().map(of_kind).collect())
    }

    fn new(kind: ChangeKind, singles: Vec<SingleChange>, symmetries: &[Symmetry]) -> Self {
        let place = |change: &Change| singles.iter().position(|single| single.change == *change);
        let image = |symmetry: &Symmetry| singles.iter().map(|single| place(&single.change.image(symmetry))).collect();
        let mut images: Vec<Vec<usize>> = symmetries.iter().filter_map(image).collect();
        if images.is_empty() {
            images.push((0..singles.len()).collect());
        }
        let mut groups: Vec<Vec<usize>> = (0..singles.len()).map(|single| vec![single]).collect();
        let mut larger = BTreeSet::new();
        for single in 0..singles.len() {
            let by_one = images.iter().map(|image| BTreeSet::from([single, image[single]]));
            let by_all = images.iter().map(|image| image[single]).collect();
            larger.extend(by_one.chain([by_all]).filter(|group: &BTreeSet<usize>| group.len() > 1));
        }
        groups.extend(larger.into_iter().map(|group| group.into_iter().collect::<Vec<_>>()));
        Self { kind, singles, images, groups }
    }

    /// Images of a set of single changes under all symmetries, each once, as ascending indices, in lexicographic order. All have the same effect over all arrangements,
    /// but not in single ones.
    pub fn images_of(&self, of: &[usize]) -> Vec<Vec<usize>> {
        let image = |image: &Vec<usize>| of.iter().map(|&single| image[single]).collect::<BTreeSet<usize>>();
        let all: BTreeSet<BTreeSet<usize>> = self.images.iter().map(image).collect();
        all.into_iter().map(|image| image.into_iter().collect()).collect()
    }

    /// The first of the [images](Self::images_of) of a set of single changes, which stands for all of them.
    pub fn representative(&self, of: &[usize]) -> Vec<usize> {
        self.images_of(of).into_iter().next().unwrap_or_else(|| of.to_vec())
    }

    /// True if every symmetry maps the set `of` onto itself; false where the identity is the only symmetry.
    pub fn is_symmetric(&self, of: &[usize]) -> bool {
        let is_same = |image: &Vec<usize>| of.iter().all(|&single| of.contains(&image[single]));
        self.images.len() > 1 && self.images.iter().all(is_same)
    }

    /// True if some single changes can be made at once: no two of them scale the same part.
    pub fn are_compatible(&self, of: &[usize]) -> bool {
        let term = |&single: &usize| match &self.singles[single].change {
            Change::Scale { term, .. } => Some(term),
            _ => None,
        };
        let mut terms: Vec<&String> = of.iter().filter_map(term).collect();
        let scaled = terms.len();
        terms.sort_unstable();
        terms.dedup();
        terms.len() == scaled
    }

    /// The changes of the single changes with the indices `of`, in this order.
    pub fn changes(&self, of: &[usize]) -> Vec<Change> {
        of.iter().map(|&single| self.singles[single].change.clone()).collect()
    }

    /// Name of the single changes with the indices `of` together.
    pub fn name(&self, of: &[usize]) -> String {
        of.iter().map(|&single| self.singles[single].name.as_str()).collect::<Vec<_>>().join(" ")
    }

    /// Sizes, with their units, of the single changes with the indices `of` that have a size, in this order; one size where all are equal.
    pub fn sizes(&self, of: &[usize], units: Units) -> Vec<(f64, &'static str)> {
        let singles = of.iter().map(|&single| &self.singles[single]);
        let size = |single: &SingleChange| Some((single.size()?, self.kind.unit(single.moves, units)));
        let mut sizes: Vec<(f64, &'static str)> = singles.filter_map(size).collect();
        if sizes.windows(2).all(|two| two[0] == two[1]) {
            sizes.truncate(1);
        }
        sizes
    }
}

/// Changes of a kind at a place: a mass in all its directions, a spring, dashpot or constraint in each of them.
fn attached(kind: ChangeKind, place: &Place, sizes: &Sizes) -> Vec<SingleChange> {
    let single = |name: &str, moves: Moves, what: Attached, size: f64, along: Vec<Vec<(usize, f64)>>| {
        // A direction without mass or stiffness of its own gets nothing in proportion to it.
        let change = Change::Attach { what, size, along };
        (size.is_finite() && size > 0.0).then(|| SingleChange { name: name.into(), change, moves })
    };
    match kind {
        ChangeKind::Mass => {
            let along = place.directions.iter().flat_map(|direction| direction.parts.clone()).collect();
            single(&place.name, moves_of(place), Attached::Mass, sizes.mass(place), along).into_iter().collect()
        }
        ChangeKind::Contact | ChangeKind::Scale | ChangeKind::Variant => Vec::new(),
        _ => {
            let of_direction = |direction: &Direction| {
                let &Direction { ref name, dof, ref parts, own, moves } = direction;
                match kind {
                    ChangeKind::Spring => single(name, moves, Attached::Spring, sizes.spring(own), parts.clone()),
                    ChangeKind::Dashpot => single(name, moves, Attached::Dashpot, sizes.dashpot(own), parts.clone()),
                    _ => dof.map(|dof| SingleChange { name: name.clone(), change: Change::Hold { dof }, moves }),
                }
            };
            place.directions.iter().filter_map(of_direction).collect()
        }
    }
}

/// Kind of the motion of a place: the kind of its directions, where all have the same.
fn moves_of(place: &Place) -> Moves {
    let mut moves = place.directions.iter().map(|direction| direction.moves);
    let first = moves.next().unwrap_or_default();
    if moves.all(|other| other == first) { first } else { Moves::Unknown }
}

/// Changes that take out one contact: a change for each contact that is closed in any scene of a set of constraints, ascending by number.
fn contacts(plan: &Plan, modifiable: &dyn Modifiable, constraints: usize) -> Vec<SingleChange> {
    let mut found: Vec<(usize, String)> = Vec::new();
    for scene in plan.scenes.iter().filter(|scene| scene.key.constraints == constraints) {
        for contact in modifiable.contacts(scene) {
            if found.iter().all(|(number, _)| *number != contact.number) {
                found.push((contact.number, contact.name));
            }
        }
    }
    found.sort();
    let single = |(contact, name)| SingleChange { name, change: Change::TakeOut { contact }, moves: Moves::Unknown };
    found.into_iter().map(single).collect()
}

/// Changes that scale parts of a brake, up and down.
fn scaled(plan: &Plan, modifiable: &dyn Modifiable, constraints: usize, sizes: &Sizes) -> Vec<SingleChange> {
    let Some(origin) = origin_of_set(plan, constraints) else { return Vec::new() };
    let (terms, names) = (plan.origins[origin].brake.system.terms(), modifiable.scalable_terms(constraints));
    let factor = sizes.factor.unwrap_or(Sizes::FACTOR);
    let mut singles = Vec::new();
    for term in terms.iter().filter(|term| names.contains(&term.name)) {
        for what in Scaled::ALL.into_iter().filter(|what| what.is_in(term.matrices())) {
            for factor in [factor, 1.0 / factor] {
                let change = Change::Scale { term: term.name.clone(), what, factor };
                let name = format!("{}.{} x {}", term.name, what.name(), significant(factor, 4));
                singles.push(SingleChange { name, change, moves: Moves::Unknown });
            }
        }
    }
    singles
}

/// Free degrees of freedom as places: each body that is a point mass is one, with its directions, each other degree of freedom
/// one by itself. Own masses and stiffnesses are the diagonals of M and K of the origin of the set of constraints, without friction, where
/// its modes are named.
fn degrees_of_freedom(plan: &Plan, constraints: usize) -> Result<Vec<Place>, Error> {
    let Some(origin) = origin_of_set(plan, constraints) else { return Ok(Vec::new()) };
    let origin = &plan.origins[origin];
    let structure = origin.brake.system.structure(&origin.naming_point.coefficients)?;
    let free = origin.brake.dofs.free();
    let direction_of = |at: usize| Direction {
        name: plan.labels.dof(free[at]),
        dof: Some(free[at]),
        parts: vec![vec![(free[at], 1.0)]],
        own: OwnSize { mass: structure.m[(at, at)], stiffness: structure.k[(at, at)] },
        moves: plan.labels.moves(free[at]),
    };
    let mut places: Vec<(usize, Place)> = Vec::new();
    let mut is_taken = vec![false; free.len()];
    for body in &origin.brake.bodies {
        if is_point_mass(&structure.m, &body.dofs) && body.dofs.iter().all(|&at| !is_taken[at]) {
            body.dofs.iter().for_each(|&at| is_taken[at] = true);
            let directions = body.dofs.iter().map(|&at| direction_of(at)).collect();
            places.push((body.dofs[0], Place { name: body.name.clone(), directions }));
        }
    }
    for at in (0..free.len()).filter(|&at| !is_taken[at]) {
        let direction = direction_of(at);
        places.push((at, Place { name: direction.name.clone(), directions: vec![direction] }));
    }
    places.sort_by_key(|(first, _)| *first);
    Ok(places.into_iter().map(|(_, place)| place).collect())
}

/// True if a body has one mass in up to three directions, and none in common with other degrees of freedom.
fn is_point_mass(mass: &DMatrix<f64>, dofs: &[usize]) -> bool {
    let Some(&first) = dofs.first() else { return false };
    let own = mass[(first, first)];
    let is_alone = |&at: &usize| (0..mass.nrows()).all(|i| mass[(i, at)] == if i == at { own } else { 0.0 });
    dofs.len() <= 3 && own > 0.0 && dofs.iter().all(is_alone)
}
