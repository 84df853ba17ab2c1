//! Points that the bases of a finite element brake are trained on, and where its modes are wanted.

use std::f64::consts::TAU;

use linsys::OperatingPoint;
use montecarlo::stream;
use osc_model::ContactArrangement;
use sparse::Rectangle;

use super::points::{at_medians, of_brake, scene_point, speeds_of};
use super::samples::{State, draw, law_and_speed};
use crate::Error;
use crate::case::{FiniteElementCase, Law, ReductionGoal};

/// The growth up to which the whole brake is searched whatever a case asks for, as a part of the highest frequency of its band; chosen: so fast
/// does hardly any brake squeal, and where nothing is there a search costs little.
const SEARCHED: f64 = 0.25;
/// Draws of a stream after which none of them is taken to have an operating point; chosen.
const MOST_DRAWS: usize = 20;
/// The first stream of draws that the basis of a set is made of, far from those of samples, of full checks and of training points.
const FIRST_STREAM: u64 = u64::MAX / 4;
/// Parts of 1 by which scenes and speeds of these draws advance: the golden ratio, by which any thirteen in a row
/// are in all tenths of the scenes, and the root of 2.
const STEPS: [f64; 2] = [0.618_033_988_749_895, 0.414_213_562_373_095];
/// Largest number of times that bases are made anew because draws do not agree with the whole brake; chosen.
pub(super) const MOST_ROUNDS: u64 = 2;

/// Distance, relative to |lambda|, of a mode from the border of where modes are wanted up to which it may be inside in one system and
/// outside in the other; chosen: up to that distance eigenvalues of both are one mode ([`reduction::compared`]).
pub(super) const AT_BORDER: f64 = 1e-3;

/// Closed patches, from 0.
pub(super) type Closed = Vec<usize>;

/// The arrangements of a case, in the order of its configurations; one without patches where it has no contact.
pub(super) fn arrangements(case: &FiniteElementCase) -> Vec<Closed> {
    let Some(contact) = &case.contact else { return vec![Vec::new()] };
    let of_panel = |(_, arrangements): &(usize, Vec<ContactArrangement>)| {
        arrangements.iter().map(|arrangement| arrangement.in_contact().to_vec()).collect::<Vec<_>>()
    };
    contact.panels.iter().flat_map(of_panel).collect()
}

/// Rectangle, rad/s, in which and to the right of which the modes of a case are wanted: how fast a mode grows is no reason to leave it out. Its
/// largest growth is that up to which the whole brake is searched at least.
pub(super) fn rectangle(case: &FiniteElementCase) -> Rectangle {
    let ReductionGoal { frequencies, growth: [lowest, highest], .. } = case.reduction;
    let im = frequencies.map(|hz| TAU * hz);
    Rectangle { re: [lowest, highest.max(SEARCHED * im[1])], im }
}

/// The points that a sweep goes through, where there are some. Otherwise draws, each in one arrangement, law and range of speed after
/// another: `count`, or one for each of these where they are more. Speeds are spread over their range from end to end, as friction across the
/// sliding grows without bound towards low ones.
pub(super) fn training(
    case: &FiniteElementCase,
    arrangements: &[Closed],
    count: u64,
    swept: &[OperatingPoint],
) -> Result<Vec<OperatingPoint>, Error> {
    if !swept.is_empty() {
        return Ok(swept.to_vec());
    }
    let scenes = scenes(case, arrangements);
    let count = count.max(scenes.len() as u64);
    let point = |(index, scene): (u64, &(&Closed, State))| {
        // Streams from the other end than those of the samples.
        drawn_at(case, *scene, u64::MAX - index, spread(index / scenes.len() as u64))
    };
    (0..count).zip(scenes.iter().cycle()).map(point).collect()
}

/// A point of the whole brake with some patches closed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawn {
    pub closed: Closed,
    pub at: OperatingPoint,
}

/// Draws by their number from 0, spread over all scenes and over their ranges of speed; or the points that a sweep goes through, from end to end.
pub(super) fn draws(case: &FiniteElementCase, swept: &[OperatingPoint], count: usize) -> Result<Vec<Drawn>, Error> {
    let arrangements = arrangements(case);
    let scenes = scenes(case, &arrangements);
    let draw = |number: usize| match swept {
        [] => {
            let (closed, state) = scenes[place(number, scenes.len())];
            let at = drawn_at(case, (closed, state), FIRST_STREAM + number as u64, advanced(number, STEPS[1]))?;
            Ok(Drawn { closed: closed.clone(), at })
        }
        _ => Ok(Drawn { closed: arrangements[0].clone(), at: swept[place(number, swept.len())].clone() }),
    };
    (0..count).map(draw).collect()
}

/// Part of 1 that a draw of some number has come to by steps.
fn advanced(number: usize, step: f64) -> f64 {
    (number as f64 * step).fract()
}

/// Index among some of what a draw of some number belongs to.
fn place(number: usize, of: usize) -> usize {
    (advanced(number, STEPS[0]) * of as f64) as usize
}

/// Arrangements, each under each law and range of speed.
fn scenes<'a>(case: &FiniteElementCase, arrangements: &'a [Closed]) -> Vec<(&'a Closed, State)> {
    let states: Vec<State> = match &case.contact {
        None => vec![None],
        Some(contact) => {
            let of_law = |&law: &Law| speeds_of(contact, law).into_iter().map(move |range| Some((law, range)));
            contact.laws.iter().flat_map(of_law).collect()
        }
    };
    arrangements.iter().flat_map(|closed| states.iter().map(move |&state| (closed, state))).collect()
}

/// The first draw of a random stream that has an operating point in a scene, at a quantile of its range of speed: one without, as where no equilibrium of
/// contacts is, has no modes to hold, and fails as a sample. Where none of some draws has one it is the point at which modes are named.
fn drawn_at(
    case: &FiniteElementCase,
    (closed, state): (&Closed, State),
    number: u64,
    speed: f64,
) -> Result<OperatingPoint, Error> {
    let mut rng = stream(case.header.seed, number);
    for _ in 0..MOST_DRAWS {
        let mut sample = draw(case, &mut rng)?;
        if let Some(contacts) = &mut sample.contacts {
            contacts.speed_quantile = speed;
        }
        let friction = law_and_speed(case, state, &sample);
        if let Ok(point) = scene_point(case, closed, friction, &sample) {
            return Ok(of_brake(case, closed, &point));
        }
    }
    at_medians(case)
}

/// Numbers from 0 to 1: both ends, then the middle, quarters and so on, by the radical inverse (van der Corput).
fn spread(at: u64) -> f64 {
    match at {
        0 | 1 => at as f64,
        _ => (at - 1).reverse_bits() as f64 / 2f64.powi(64),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::{place, spread};

    #[test]
    fn numbers_are_spread_from_end_to_end() {
        assert_eq!((0..8).map(spread).collect::<Vec<_>>(), [0.0, 1.0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375]);
    }

    #[test]
    fn draws_in_a_row_reach_every_arrangement() {
        for (scenes, draws) in [(2, 3), (10, 13), (30, 55), (60, 89)] {
            for first in 0..200 {
                let reached: BTreeSet<usize> = (first..first + draws).map(|number| place(number, scenes)).collect();
                assert_eq!(reached.len(), scenes, "{draws} draws from {first}");
            }
        }
    }
}
