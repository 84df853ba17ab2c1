//! Which mode of one study is which of another.

use std::cmp::Ordering;

use cea::Mode;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::folder::SetModes;

/// Least fraction of the degrees of freedom of either study that both must have for their shapes to be compared; chosen: with
/// less in common, modes are linked by their frequencies.
const COMMON_DOFS: f64 = 0.5;
/// Least MAC of a link by shapes; chosen: with less, modes of other shapes are linked; with more, modes are left without a link.
const LEAST_MAC: f64 = 0.6;
/// Least amount by which that MAC is above the next one for it to decide alone; chosen: shapes that differ by less, as next to a coalescence, are alike.
const MAC_MARGIN: f64 = 0.1;
/// Largest distance of the eigenvalues of two modes with alike shapes, as a fraction of that to the next one; chosen: past a coalescence one of the two grows and the
/// other decays, which tells them apart unless the pair has moved by more than that.
const NEARER: f64 = 0.5;
/// Largest distance of two frequencies that are linked, relative; chosen: with less, modes are left without a link; with more, other modes are linked.
const FREQUENCY_DISTANCE: f64 = 0.05;

/// Ground on which two modes are linked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LinkedBy {
    /// Shapes: each has the largest MAC of all with the other, at least 0.6; of those that have within 0.1 of it, the nearest eigenvalue.
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
    let to_second = |i: usize| clear_best(&a[i], i, mac.row(i).iter().copied(), &b);
    let to_first = |j: usize| clear_best(&b[j], j, mac.column(j).iter().copied(), &a);
    let link = |i: usize| {
        let j = to_second(i).filter(|&j| to_first(j) == Some(i))?;
        Some((j, LinkedBy::Shape { mac: mac[(i, j)] }))
    };
    Some((0..a.len()).map(link).collect())
}

/// Place, among modes of the other study, of the mode that the mode `of` at place `at` is, by its MACs with them: the one with the largest, or of several with alike
/// ones that with the nearest eigenvalue; `None` where neither is clear.
fn clear_best(of: &Mode, at: usize, macs: impl Iterator<Item = f64>, others: &[Mode]) -> Option<usize> {
    let macs: Vec<f64> = macs.collect();
    let largest = macs.iter().copied().fold(0.0, f64::max);
    let mut alike: Vec<usize> =
        (0..macs.len()).filter(|&j| largest >= LEAST_MAC && largest - macs[j] < MAC_MARGIN).collect();
    alike.sort_by(|&i, &j| nearer(of, at, (others, i), (others, j)));
    let distance = |j: &usize| (others[*j].lambda - of.lambda).norm();
    match alike[..] {
        [] => None,
        [only] => Some(only),
        [nearest, next, ..] => (distance(&nearest) <= NEARER * distance(&next)).then_some(nearest),
    }
}

/// Order of two modes by the distance of their eigenvalues from that of `of`; of modes with the same eigenvalue by their places.
fn nearer(of: &Mode, at: usize, one: (&[Mode], usize), other: (&[Mode], usize)) -> Ordering {
    let distance = |(modes, j): (&[Mode], usize)| (modes[j].lambda - of.lambda).norm();
    distance(one).total_cmp(&distance(other)).then(one.1.abs_diff(at).cmp(&other.1.abs_diff(at)))
}

fn by_frequency(first: &SetModes, second: &SetModes) -> Vec<Option<(usize, LinkedBy)>> {
    let (a, b) = (&first.modes, &second.modes);
    let apart = |one: &Mode, other: &Mode| (cea::frequency_hz(one.lambda) - cea::frequency_hz(other.lambda)).abs();
    let nearest = |of: &Mode, at: usize, among: &[Mode]| {
        let order = |&i: &usize, &j: &usize| {
            apart(of, &among[i]).total_cmp(&apart(of, &among[j])).then(nearer(of, at, (among, i), (among, j)))
        };
        (0..among.len()).min_by(order)
    };
    let link = |at: usize| {
        let to = nearest(&a[at], at, b)?;
        let larger = cea::frequency_hz(a[at].lambda).max(cea::frequency_hz(b[to].lambda));
        let is_near = apart(&a[at], &b[to]) <= FREQUENCY_DISTANCE * larger;
        (is_near && nearest(&b[to], to, a) == Some(at)).then_some((to, LinkedBy::Frequency))
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

    fn numbered(modes: Vec<Mode>, dofs: usize) -> SetModes {
        let names = (1..=modes.len()).map(|number| number.to_string()).collect();
        SetModes { names, modes, dofs: (0..dofs).map(|dof| format!("d{dof}")).collect() }
    }

    fn mode(lambda: [f64; 2], shape: &[f64]) -> Mode {
        let shape: Vec<Complex<f64>> = shape.iter().map(|&u| Complex::from(u)).collect();
        Mode { lambda: Complex::new(lambda[0], lambda[1]), shape: shape.into() }
    }

    /// Modes of any kind, among them pairs next to a coalescence, of which shapes and eigenvalues are nearly or exactly the same, and modes of equal frequency.
    #[test]
    fn a_study_is_linked_to_itself_mode_by_mode() {
        let mut seed = 0x5eed_u64;
        let mut random = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for apart in [0.0, 1e-12, 1e-6, 1e-2, 0.1, 0.3] {
            for dofs in [0, 1, 2, 4, 7] {
                let mut modes = Vec::new();
                for _ in 0..3 {
                    let (growth, omega) = (random(), 100.0 + 100.0 * random());
                    let shape: Vec<f64> = (0..dofs).map(|_| random()).collect();
                    let beside: Vec<f64> = shape.iter().map(|u| u + apart * random()).collect();
                    modes.push(mode([growth, omega], &shape));
                    modes.push(mode([growth - apart, omega], &beside));
                }
                let set = numbered(modes, dofs);
                let found = linked(&set, &set);
                assert_eq!(found.len(), 6, "{apart}, {dofs}: {found:?}");
                assert!(found.iter().all(|(a, b, by)| a == b && !by.is_empty()), "{apart}, {dofs}: {found:?}");
            }
        }
    }

    #[test]
    fn of_alike_shapes_the_eigenvalue_decides_unless_it_has_moved_too_far() {
        let pair = |omega: f64, growths: [f64; 2]| {
            let shapes = [[1.0, 0.9], [1.0, 1.1]];
            numbered((0..2).map(|at| mode([growths[at], omega], &shapes[at])).collect(), 2)
        };
        let first = pair(100.0, [3.0, -3.0]);
        let text = |a: &str, b: &str, by| (a.to_owned(), b.to_owned(), by);
        // The growing mode is the growing one, in whichever order they stand.
        assert_eq!(linked(&first, &pair(101.0, [-2.0, 2.0])), [text("1", "2", "shape"), text("2", "1", "shape")]);
        let far = linked(&first, &pair(120.0, [-2.0, 2.0]));
        assert!(far.iter().all(|(_, _, by)| by.is_empty()), "{far:?}");
    }
}
