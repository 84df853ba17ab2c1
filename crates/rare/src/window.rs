//! Windows: failure that begins and ends again within less than a step of a line.
//!
//! Steps of one deviation pass over it, and where the margin is flat outside (two modes that meet and part again) nothing tells that it is there.
//! Where one place of it is known it moves from line to line without a jump: it is followed, place by place, to the line that is asked for.

use crate::limit_state::Asked;
use crate::line_intervals::{OF_WINDOW, Place, STEP, crossing};
use crate::vector::{along, dot};

/// Distances beyond an onset at which the end of a window is looked for, in standard deviations; chosen: farther apart outwards, down to the precision of onsets.
const BEYOND: [f64; 8] = [1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 0.6, STEP];
/// Precision of the end of a window, as a fraction of the distance beyond the onset at which failure was seen; chosen.
const OF_WIDTH: f64 = 0.1;
/// Distance between the places that are looked at about a window, in widths; chosen: at least one of them is inside.
const SPACING: f64 = 0.5;
/// Number of these places on either side; chosen: a window that lies farther from where it is expected is lost.
const ON_A_SIDE: i32 = 6;
/// Fraction of the way across that the first move goes, and the smallest that one may go; chosen: a window that moves by three widths in the smallest is
/// lost.
const MOVES: (f64, f64) = (0.5, 1.0 / 128.0);

/// Cosine of two directions below which the window of one is not followed to lines in the other; chosen: there its lines count for it.
const LEAST_COSINE: f64 = 0.3;

/// A window on a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Window {
    /// Place of its middle along the line, in standard deviations.
    pub middle: f64,
    /// Width of it.
    pub width: f64,
}

/// Places about a window with their margins.
pub(crate) struct Seen {
    pub places: Vec<Place>,
    /// The first and the last of those next to each other that fail.
    failing: [usize; 2],
}

impl Window {
    /// The window that begins at a place of a line; `None` where failure does not end within a step.
    ///
    /// # Errors
    /// Those of the limit state.
    pub fn from<A: Asked>(of: &A, line: &dyn Fn(f64) -> Vec<f64>, onset: f64) -> Result<Option<Self>, A::Error> {
        let worst = of.worst_of_all(&BEYOND.map(|distance| line(onset + distance)))?;
        let margins = || BEYOND.into_iter().zip(worst.iter().map(|mode| mode.margin));
        let Some(inside) = margins().find(|place| place.1 > 0.0) else { return Ok(None) };
        let Some(outside) = margins().find(|place| place.0 > inside.0 && place.1 <= 0.0) else { return Ok(None) };
        let mut margin = |t: f64| Ok::<f64, A::Error>(of.worst(&line(onset + t))?.margin);
        let width = crossing(&mut margin, inside, outside, OF_WIDTH * inside.0)?;
        Ok(Some(Self { middle: onset + 0.5 * width, width }))
    }

    /// Places about the window with their margins on another line, about where it is expected; `None` where nothing fails there.
    ///
    /// # Errors
    /// Those of the limit state.
    pub fn on<A: Asked>(
        &self,
        of: &A,
        line: &dyn Fn(f64) -> Vec<f64>,
        expected: f64,
    ) -> Result<Option<Seen>, A::Error> {
        let about = |place: i32| expected + SPACING * self.width * f64::from(place);
        let at: Vec<f64> = (-ON_A_SIDE..=ON_A_SIDE).map(about).collect();
        let points: Vec<Vec<f64>> = at.iter().map(|t| line(*t)).collect();
        let margins = of.worst_of_all(&points)?.into_iter().map(|mode| mode.margin);
        Ok(Seen::new(at.into_iter().zip(margins).collect(), expected))
    }

    /// Places about the window with their margins on the line at `across` in a direction, to which it is followed from its design point, given with its own
    /// direction; `None` where it is lost, and where the two directions have a cosine below [`LEAST_COSINE`].
    ///
    /// # Errors
    /// Those of the limit state.
    pub fn at<A: Asked>(
        mut self,
        of: &A,
        [point, towards]: [&[f64]; 2],
        [across, direction]: [&[f64]; 2],
    ) -> Result<Option<Seen>, A::Error> {
        let cosine = dot(towards, direction);
        if cosine < LEAST_COSINE {
            return Ok(None);
        }
        self.width /= cosine;
        self.middle = dot(point, direction) + 0.5 * self.width;
        let foot = along(point, -dot(point, direction), direction);
        let way = along(across, -1.0, &foot);
        let (mut part, mut step, mut drift) = (0.0, MOVES.0, 0.0);
        while step >= MOVES.1 {
            let next = (part + step).min(1.0);
            let foot = along(&foot, next, &way);
            let Some(seen) = self.on(of, &|t| along(&foot, t, direction), self.middle + drift * (next - part))? else {
                step *= 0.5;
                continue;
            };
            if next >= 1.0 {
                return Ok(Some(seen));
            }
            let there = seen.window();
            drift = (there.middle - self.middle) / (next - part);
            (self, part) = (there, next);
        }
        Ok(None)
    }
}

impl Seen {
    fn new(places: Vec<Place>, expected: f64) -> Option<Self> {
        let fails = |place: &usize| places[*place].1 > 0.0;
        let distance = |place: &usize| (places[*place].0 - expected).abs();
        let nearest = (0..places.len()).filter(fails).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let first = (0..=nearest).rev().take_while(fails).last()?;
        let last = (nearest..places.len()).take_while(fails).last()?;
        Some(Self { places, failing: [first, last] })
    }

    /// The window, by the places that fail.
    pub fn window(&self) -> Window {
        let [first, last] = self.failing.map(|place| self.places[place].0);
        let spacing = self.places[1].0 - self.places[0].0;
        Window { middle: 0.5 * (first + last), width: (last - first + spacing).min(STEP) }
    }

    /// Where it begins on its line; `None` where that is before all places.
    ///
    /// # Errors
    /// Those of the margin.
    pub fn onset<E>(&self, margin: &mut impl FnMut(f64) -> Result<f64, E>) -> Result<Option<f64>, E> {
        let [first, _] = self.failing;
        let Some(before) = first.checked_sub(1).map(|before| self.places[before]) else { return Ok(None) };
        crossing(margin, before, self.places[first], OF_WINDOW * self.window().width).map(Some)
    }
}
