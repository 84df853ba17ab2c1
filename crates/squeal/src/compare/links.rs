//! Which mode of one study is which of another.

use cea::Mode;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::folder::SetModes;

/// Least fraction of the degrees of freedom of either study that both must have for their shapes to be compared; chosen: with
/// less in common, modes are linked by their frequencies.
const COMMON_DOFS: f64 = 0.5;
/// Least MAC of a link by shapes; chosen: with less, modes of other shapes are linked; with more, modes are left without a link.
const LEAST_MAC: f64 = 0.6;
/// Least amount by which that MAC is above the next one; chosen: modes next to a coalescence are alike, so that a larger margin would leave them without links.
const MAC_MARGIN: f64 = 0.1;
/// Largest distance of two frequencies that are linked, relative; chosen: with less, modes are left without a link; with more, other modes are linked.
const FREQUENCY_DISTANCE: f64 = 0.05;

/// Ground on which two modes are linked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LinkedBy {
    /// Shapes: each has the largest MAC of all with the other, at least 0.6, and 0.1 more than with the next.
    Shape {
        /// MAC of the two shapes over the degrees of freedom that both studies have, unweighted, because no folder has the masses.
        mac: f64,
    },
    /// Names: divergence, and modes without a name, are the same thing in both.
    Name,
    /// Frequencies, each the nearest of the other and within 5 %, because the studies have not their degrees of freedom in common.
    Frequency,
}

impl LinkedBy {
    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shape { .. } => "shape",
            Self::Name => "name",
            Self::Frequency => "frequency",
        }
    }
}

/// A mode of the first study and one of the second.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Names in the first study and in the second; one of them `None` where it is linked to no mode.
    pub modes: [Option<String>; 2],
    /// Frequencies, Hz, where the modes have names.
    pub hz: [Option<f64>; 2],
    /// Ground of the link; `None` of a mode without one.
    pub by: Option<LinkedBy>,
}

/// The modes of two studies, linked: modes of the first study in their order, then the modes of the second that are left.
pub(super) fn links(first: Option<&SetModes>, second: Option<&SetModes>) -> Vec<Link> {
    let none = SetModes::default();
    let (first, second) = (first.unwrap_or(&none), second.unwrap_or(&none));
    let found = by_shape(first, second).unwrap_or_else(|| by_frequency(first, second));
    let mode = |of: &SetModes, at: usize| (of.names[at].clone(), cea::frequency_hz(of.modes[at].lambda));
    let mut links = Vec::new();
    for (at, link) in found.iter().enumerate() {
        let (name, hz) = mode(first, at);
        let to = link.map(|(to, _)| mode(second, to)).unzip();
        links.push(Link { modes: [Some(name), to.0], hz: [Some(hz), to.1], by: link.map(|(_, by)| by) });
    }
    let is_left = |at: &usize| !found.iter().flatten().any(|(to, _)| to == at);
    for at in (0..second.modes.len()).filter(is_left) {
        let (name, hz) = mode(second, at);
        links.push(Link { modes: [None, Some(name)], hz: [None, Some(hz)], by: None });
    }
    for name in ["unnamed", "divergence"] {
        let both = Some(name.to_owned());
        links.push(Link { modes: [both.clone(), both], hz: [None, None], by: Some(LinkedBy::Name) });
    }
    links
}

/// Links by shapes over the degrees of freedom that both have; `None` where these are too few.
fn by_shape(first: &SetModes, second: &SetModes) -> Option<Vec<Option<(usize, LinkedBy)>>> {
    let place: std::collections::HashMap<&str, usize> =
        second.dofs.iter().enumerate().map(|(at, dof)| (dof.as_str(), at)).collect();
    let common: Vec<(usize, usize)> =
        first.dofs.iter().enumerate().filter_map(|(at, dof)| Some((at, *place.get(dof.as_str())?))).collect();
    let least = COMMON_DOFS * first.dofs.len().max(second.dofs.len()) as f64;
    if common.is_empty() || (common.len() as f64) < least {
        return None;
    }
    let over_common = |modes: &[Mode], of: &dyn Fn(&(usize, usize)) -> usize| -> Vec<Mode> {
        let shape = |mode: &Mode| {
            let shape: DVector<Complex<f64>> =
                common.iter().map(|pair| mode.shape[of(pair)]).collect::<Vec<_>>().into();
            let norm = shape.norm();
            if norm > 0.0 { shape.unscale(norm) } else { shape }
        };
        modes.iter().map(|mode| Mode { lambda: mode.lambda, shape: shape(mode) }).collect()
    };
    let (a, b) = (over_common(&first.modes, &|pair| pair.0), over_common(&second.modes, &|pair| pair.1));
    let mac = DMatrix::from_fn(a.len(), b.len(), |i, j| a[i].shape.dotc(&b[j].shape).norm_sqr());
    let link = |i: usize| {
        let j = clear_best(mac.row(i).iter().copied())?;
        let is_mutual = clear_best(mac.column(j).iter().copied()) == Some(i);
        is_mutual.then(|| (j, LinkedBy::Shape { mac: mac[(i, j)] }))
    };
    Some((0..a.len()).map(link).collect())
}

/// Place of the largest MAC, where it is enough for a link.
fn clear_best(mac: impl Iterator<Item = f64>) -> Option<usize> {
    let (mut best, mut next) = ((None, 0.0), 0.0);
    for (at, mac) in mac.enumerate() {
        if mac > best.1 {
            (best, next) = ((Some(at), mac), best.1);
        } else if mac > next {
            next = mac;
        }
    }
    best.0.filter(|_| best.1 >= LEAST_MAC && best.1 - next >= MAC_MARGIN)
}

fn by_frequency(first: &SetModes, second: &SetModes) -> Vec<Option<(usize, LinkedBy)>> {
    let hz = |of: &SetModes| -> Vec<f64> { of.modes.iter().map(|mode| cea::frequency_hz(mode.lambda)).collect() };
    let (a, b) = (hz(first), hz(second));
    let nearest = |to: f64, among: &[f64]| {
        (0..among.len()).min_by(|&i, &j| (among[i] - to).abs().total_cmp(&(among[j] - to).abs()))
    };
    let link = |at: usize| {
        let to = nearest(a[at], &b)?;
        let is_near = (b[to] - a[at]).abs() <= FREQUENCY_DISTANCE * a[at].max(b[to]);
        (is_near && nearest(b[to], &a) == Some(at)).then_some((to, LinkedBy::Frequency))
    };
    (0..a.len()).map(link).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(dofs: &[&str], modes: &[(&str, f64, &[f64])]) -> SetModes {
        let mode = |&(_, hz, shape): &(&str, f64, &[f64])| Mode {
            lambda: Complex::new(0.0, std::f64::consts::TAU * hz),
            shape: shape.iter().map(|&u| Complex::from(u)).collect::<Vec<_>>().into(),
        };
        SetModes {
            names: modes.iter().map(|(name, ..)| (*name).to_owned()).collect(),
            modes: modes.iter().map(mode).collect(),
            dofs: dofs.iter().map(|&dof| dof.to_owned()).collect(),
        }
    }

    fn linked(first: &SetModes, second: &SetModes) -> Vec<(String, String, &'static str)> {
        let name = |of: &Option<String>| of.clone().unwrap_or_default();
        let found = links(Some(first), Some(second));
        let modes = found.iter().filter(|link| link.hz != [None, None]);
        modes.map(|Link { modes: [a, b], by, .. }| (name(a), name(b), by.map_or("", LinkedBy::name))).collect()
    }

    #[test]
    fn modes_are_linked_by_shape_whatever_their_order_and_by_frequency_without_common_places() {
        let first = set(&["x", "y", "z"], &[("1", 100.0, &[1.0, 0.1, 0.0]), ("2", 110.0, &[-0.1, 1.0, 0.0])]);
        let crossed = set(&["z", "y", "x"], &[("1", 101.0, &[0.0, 1.0, -0.1]), ("2", 112.0, &[0.0, 0.1, 1.0])]);
        let text = |a: &str, b: &str, by| (a.to_owned(), b.to_owned(), by);
        assert_eq!(linked(&first, &crossed), [text("1", "2", "shape"), text("2", "1", "shape")]);
        let elsewhere = set(&["a"], &[("1", 101.0, &[1.0]), ("2", 150.0, &[1.0])]);
        let expected = [text("1", "1", "frequency"), text("2", "", ""), text("", "2", "")];
        assert_eq!(linked(&first, &elsewhere), expected);
        // A shape between two is linked to neither.
        let between = set(&["x", "y", "z"], &[("1", 105.0, &[1.0, 1.0, 0.0])]);
        assert!(linked(&first, &between).iter().all(|(_, _, by)| by.is_empty()));
    }
}
