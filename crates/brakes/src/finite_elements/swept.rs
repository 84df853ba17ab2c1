//! Points of a finite element brake over the ranges that a sweep goes through.

use linsys::OperatingPoint;
use sweep::{Over, SweptParameter, swept};

use super::parameters::{self, SceneOf};
use super::points::speeds_of;
use crate::Error;
use crate::case::FiniteElementCase;

/// Number of points along the parameter of a sweep over one; chosen: residuals are small at all of them, and on the way between.
const ALONG_ONE: usize = 17;
/// Number of points along each parameter of a sweep over two; chosen likewise.
const ALONG_EACH: usize = 6;

/// Points of a grid over the ranges in the first scene of a case. Each range is extended to the median, from which names are followed. Without a parameter
/// that is swept it is the point of the medians alone.
///
/// # Errors
/// A parameter that the scene does not have or that is named twice, a range that does not go up, values without an operating point.
pub(super) fn points(case: &FiniteElementCase, over: &[Over]) -> Result<Vec<OperatingPoint>, Error> {
    let contact = case.contact.as_ref();
    let closed = contact.map_or(Vec::new(), |contact| contact.panels[0].1[0].in_contact().to_vec());
    let state = contact.map(|contact| (contact.laws[0], speeds_of(contact, contact.laws[0])[0]));
    let scene = SceneOf { case, closed: &closed, state };
    let swept = swept(&parameters::named(&scene), "the first scene of this case", over)?;
    let along = if swept.len() == 1 { ALONG_ONE } else { ALONG_EACH };
    let values_of = |parameter: &SweptParameter| {
        let median = parameter.part(parameter.median);
        let (first, last) = (median.min(0.0), median.max(1.0));
        let value = |at: usize| parameter.at(first + (last - first) * at as f64 / (along - 1) as f64);
        (0..along).map(value).collect::<Vec<f64>>()
    };
    let mut grid: Vec<Vec<(usize, f64)>> = vec![Vec::new()];
    for parameter in &swept {
        let values = values_of(parameter);
        let with = |point: &Vec<(usize, f64)>, value: f64| [point.as_slice(), &[(parameter.place, value)]].concat();
        grid = grid.iter().flat_map(|point| values.iter().map(move |&value| with(point, value))).collect();
    }
    grid.iter().map(|values| parameters::point(&scene, values)).collect()
}
