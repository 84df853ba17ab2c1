//! Friction by quantile functions: which coordinate of the unit cube each parameter takes, and which parameters a law has.

use montecarlo::Distribution;
use study::Input;

use super::{FrictionDraw, LatticeSample};
use crate::case::{Correlation, Draws, FrictionDistributions, Law};

/// Law of a scene, and the distributions from which its friction is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawnFriction<'a> {
    /// The law of a scene.
    pub law: Law,
    /// Distributions of the friction parameters.
    pub from: &'a FrictionDistributions,
    /// Correlation of these parameters; `None` where they are independent.
    pub correlation: Option<&'a Correlation>,
    /// Draws: shared by all contacts, or one for each.
    pub draws: Draws,
    /// True if friction acts across the sliding with a coefficient of its own.
    pub has_lateral_mu: bool,
    /// True if LuGre's bristles have damping.
    pub has_bristle_damping: bool,
}

/// Coordinates of the unit cube that [`FrictionDistributions::DRAWN`] have in the first contact. The most influential parameters have the first coordinates, in
/// which a Sobol' sequence is distributed best.
const COORDINATES: [u32; FrictionDistributions::DRAWN.len()] = [0, 3, 2, 0, 4, 5, 6, 7, 8];
/// Coordinate of the speed.
const SPEED: u32 = 1;
/// Number of coordinates of a contact: one more than the largest of [`COORDINATES`]. The second and later contacts do not use the coordinate of the speed.
pub(crate) const OF_CONTACT: u32 = {
    let (mut largest, mut at) = (SPEED, 0);
    while at < COORDINATES.len() {
        if COORDINATES[at] > largest {
            largest = COORDINATES[at];
        }
        at += 1;
    }
    largest + 1
};

/// Flags of [`FrictionDistributions::DRAWN`]: true where a law has the parameter. Amontons-Coulomb friction has one coefficient in all directions.
fn of_law(law: Law) -> [bool; FrictionDistributions::DRAWN.len()] {
    let (coulomb, stribeck) = (law == Law::AmontonsCoulomb, matches!(law, Law::Stribeck | Law::LuGre));
    let (falling, bristles) = (law == Law::VelocityDependent, law == Law::LuGre);
    [coulomb, !coulomb, !coulomb, !coulomb, falling, stribeck, bristles, bristles, stribeck]
}

impl DrawnFriction<'_> {
    /// The sample with draws for `contacts` contacts (1 if all have the same) at a point of the unit cube, whose coordinates `uniform` gives. Parameters that
    /// the law does not have are at their medians.
    pub fn sample(&self, contacts: usize, uniform: &dyn Fn(u32) -> f64) -> LatticeSample {
        let of_contact = |contact: u32| {
            let mut values = self.from.of_draw().map(Distribution::median);
            let places = values.iter_mut().zip(self.from.of_draw()).zip(COORDINATES).zip(of_law(self.law));
            for (((value, distribution), coordinate), is_of_law) in places {
                if is_of_law {
                    *value = distribution.quantile(uniform(OF_CONTACT * contact + coordinate));
                }
            }
            FrictionDraw::from_values(values)
        };
        let draws = (0..contacts as u32).map(of_contact).collect();
        LatticeSample::of_contacts(draws, uniform(SPEED)).correlated(self.from, self.correlation)
    }

    /// The inputs of a scene with these contacts closed, from 0; the speed last, where `speed` says that it is drawn.
    pub fn inputs(&self, closed: &[usize], speed: bool) -> Vec<Input> {
        let mut inputs = Vec::new();
        for (contact, place) in self.drawn(closed) {
            let name = FrictionDistributions::DRAWN[place];
            inputs.push(Input {
                name: if self.draws == Draws::Each { format!("{name}@{}", contact + 1) } else { name.into() },
                unit: FrictionDistributions::UNITS[place].into(),
                coordinate: OF_CONTACT * contact as u32 + COORDINATES[place],
                is_correlated: self
                    .correlation
                    .is_some_and(|of| of.holds(contact * FrictionDistributions::DRAWN.len() + place)),
                has_atoms: self.from.of_draw()[place].has_atoms(),
                jumps: self.from.of_draw()[place].jumps(),
            });
        }
        if speed {
            let (name, unit) = ("v".into(), "m/s".into());
            inputs.push(Input { name, unit, coordinate: SPEED, is_correlated: false, has_atoms: false, jumps: false });
        }
        inputs
    }

    /// The values of [`DrawnFriction::inputs`] but the speed.
    pub fn values(&self, closed: &[usize], sample: &LatticeSample) -> Vec<f64> {
        self.drawn(closed).into_iter().map(|(contact, place)| sample.contact(contact).values()[place]).collect()
    }

    /// Contacts with a draw of their own, each with the index of a parameter that is drawn there and matters.
    fn drawn(&self, closed: &[usize]) -> Vec<(usize, usize)> {
        let contacts = if self.draws == Draws::Each { closed } else { &[0] };
        let from = self.from.of_draw();
        let matters = |place: &usize| {
            let is_used = match FrictionDistributions::DRAWN[*place] {
                "lateral_mu" => self.has_lateral_mu,
                "sigma1" => self.has_bristle_damping,
                _ => true,
            };
            is_used && of_law(self.law)[*place] && !matches!(from[*place], Distribution::Constant { .. })
        };
        let places: Vec<usize> = (0..from.len()).filter(matters).collect();
        contacts.iter().flat_map(|&contact| places.iter().map(move |&place| (contact, place))).collect()
    }
}
