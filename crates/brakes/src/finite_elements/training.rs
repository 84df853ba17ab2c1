//! Operating points that the bases of a finite element brake are made of, and the rectangle in which its modes are wanted.

use std::f64::consts::TAU;

use linsys::OperatingPoint;
use montecarlo::stream;
use osc_model::ContactArrangement;
use sparse::Rectangle;

use super::points::{at_medians, of_brake, scene_point, speeds_of};
use super::samples::{State, draw, law_and_speed};
use crate::Error;
use crate::case::{FiniteElementCase, Law, ReductionGoal};

/// Least upper border of Re lambda of the rectangle, as a fraction of its largest Im lambda; a case can ask for more. Chosen: hardly any brake
/// squeals with a mode that grows so fast, and a search costs little where it finds nothing.
const LEAST_GROWTH_SEARCHED: f64 = 0.25;
/// Most draws that are taken from a stream until one has an operating point; chosen: with fewer, the medians stand more often for a scene most of whose draws
/// have none; with more, a scene without any takes longer.
const MOST_DRAWS: usize = 20;
/// Number of the first stream of the draws that the basis of a set of constraints is made of. Samples have the streams from 0 up, full checks the streams
/// from `u64::MAX / 2` up, training points the streams from `u64::MAX` down.
const FIRST_STREAM: u64 = u64::MAX / 4;
/// Step by which the scene advances from one of these draws to the next, as a fraction of the number of scenes: (sqrt 5 - 1) / 2, the golden ratio,
/// by which any thirteen draws in a row reach all of ten scenes.
const SCENE_STEP: f64 = 0.618_033_988_749_895;
/// Step by which the quantile of the speed advances from one of these draws to the next, modulo 1: sqrt 2 - 1.
const SPEED_STEP: f64 = 0.414_213_562_373_095;
/// Largest number of times that bases are made anew because draws do not agree with the whole brake; chosen: each time takes about as long as the first, and
/// with fewer, larger errors are assumed of samples.
pub(super) const MOST_ROUNDS: u64 = 2;

/// Largest distance from the border of the wanted modes, relative to |lambda|, of a mode that may be inside in one system and outside in the
/// other; chosen: eigenvalues of two systems are one mode up to the same distance ([`reduction::compared`]).
pub(super) const AT_BORDER: f64 = 1e-3;

/// An arrangement: the patches that are in contact (closed), by their indices from 0.
pub(super) type Closed = Vec<usize>;

/// The arrangements of a case, in the order of its configurations; of a case without contact one, without patches.
pub(super) fn arrangements(case: &FiniteElementCase) -> Vec<Closed> {
    let Some(contact) = &case.contact else { return vec![Vec::new()] };
    let of_panel = |(_, arrangements): &(usize, Vec<ContactArrangement>)| {
        arrangements.iter().map(|arrangement| arrangement.in_contact().to_vec()).collect::<Vec<_>>()
    };
    contact.panels.iter().flat_map(of_panel).collect()
}

/// Rectangle of the wanted modes of a case, rad/s. Modes to the right of it are wanted too, as how fast a mode grows is no reason to leave it out, but
/// the whole brake is searched for certain in the rectangle alone.
pub(super) fn rectangle(case: &FiniteElementCase) -> Rectangle {
    let ReductionGoal { frequencies, growth: [lowest, highest], .. } = case.reduction;
    let im = frequencies.map(|hz| TAU * hz);
    Rectangle { re: [lowest, highest.max(LEAST_GROWTH_SEARCHED * im[1])], im }
}

/// Training points of the basis of one part, which holds the `arrangements`: the points of a sweep, if it is for a sweep. Otherwise draws, which go
/// through the scenes (each arrangement under each law in each range of speed) in turn: `count` of them, or one for each scene if there are more scenes.
/// Their speeds are spread over each range and reach both ends, as friction across the sliding grows without bound towards low speeds.
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
        // The last streams, as samples have the first ones.
        drawn_at(case, *scene, u64::MAX - index, spread(index / scenes.len() as u64))
    };
    (0..count).zip(scenes.iter().cycle()).map(point).collect()
}

/// An operating point of the whole brake, and the arrangement to which it belongs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawn {
    pub closed: Closed,
    pub at: OperatingPoint,
}

/// The first `count` draws for the basis of a set of constraints, which holds all arrangements: spread over all scenes and over their ranges of speed,
/// however many are taken. For a sweep they are points of the sweep, spread over all of it.
pub(super) fn draws(case: &FiniteElementCase, swept: &[OperatingPoint], count: usize) -> Result<Vec<Drawn>, Error> {
    let arrangements = arrangements(case);
    let scenes = scenes(case, &arrangements);
    let draw = |number: usize| match swept {
        [] => {
            let (closed, state) = scenes[place(number, scenes.len())];
            let at = drawn_at(case, (closed, state), FIRST_STREAM + number as u64, advanced(number, SPEED_STEP))?;
            Ok(Drawn { closed: closed.clone(), at })
        }
        _ => Ok(Drawn { closed: arrangements[0].clone(), at: swept[place(number, swept.len())].clone() }),
    };
    (0..count).map(draw).collect()
}

/// The fractional part of `number` steps.
fn advanced(number: usize, step: f64) -> f64 {
    (number as f64 * step).fract()
}

/// Index, of `count` scenes or points of a sweep, of the one to which draw `number` belongs.
fn place(number: usize, count: usize) -> usize {
    (advanced(number, SCENE_STEP) * count as f64) as usize
}

/// The scenes: each arrangement under each law in each range of speed.
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

/// Operating point of the whole brake in a scene, of the first draw of a random stream that has one; the speed is at a quantile of the scene's range.
/// A draw without an operating point, as where the contacts have no equilibrium, has no modes to hold, and fails as a sample. If none of [`MOST_DRAWS`]
/// draws has one, it is the point of the medians with all patches closed.
fn drawn_at(
    case: &FiniteElementCase,
    (closed, state): (&Closed, State),
    stream_number: u64,
    speed_quantile: f64,
) -> Result<OperatingPoint, Error> {
    let mut rng = stream(case.header.seed, stream_number);
    for _ in 0..MOST_DRAWS {
        let mut sample = draw(case, &mut rng)?;
        if let Some(contacts) = &mut sample.contacts {
            contacts.speed_quantile = speed_quantile;
        }
        let friction = law_and_speed(case, state, &sample);
        if let Ok(point) = scene_point(case, closed, friction, &sample) {
            return Ok(of_brake(case, closed, &point));
        }
    }
    at_medians(case)
}

/// Number `index` of a sequence in 0 to 1: both ends, then the middle, the quarters and so on, by the radical inverse (van der Corput).
fn spread(index: u64) -> f64 {
    match index {
        0 | 1 => index as f64,
        _ => (index - 1).reverse_bits() as f64 / 2f64.powi(64),
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
