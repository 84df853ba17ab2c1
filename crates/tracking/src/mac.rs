//! Modal assurance criterion (MAC), and matching two sets of modes by MAC.

use cea::Mode;
use linsys::real_times_complex;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use pathfinding::{kuhn_munkres::kuhn_munkres, matrix::Matrix};

/// Least MAC of a match that is clear whatever other modes there are. A match with a smaller MAC is still clear where it is at
/// least half of this and no other mode has more than 1 minus this. Chosen.
const LEAST_CLEAR_MAC: f64 = 0.8;
/// Largest amount by which the MAC of a rival is below the MAC of the assigned mode; chosen, as the other numbers of the rule: with less, a match that counts
/// as clear is more often wrong; with more, more modes have to be followed.
const RIVAL_MAC_MARGIN: f64 = 0.4;
/// Largest distance of a rival's eigenvalue from the old one, as a multiple of the assigned eigenvalue's distance; chosen likewise.
const RIVAL_DISTANCE_RATIO: f64 = 8.0;

/// `MAC_ij = |phi_i^H M psi_j|^2` of mass-normalised modes phi (`old`, rows) and psi (`new`, columns)
/// (Allemang and Brown, IMAC 1982, with the mass matrix as weight).
pub fn mac(old: &[Mode], new: &[Mode], mass: &DMatrix<f64>) -> DMatrix<f64> {
    mac_of_weighted(&weighted(old, mass), new)
}

/// Product M phi of each of `modes`.
pub(crate) fn weighted(modes: &[Mode], mass: &DMatrix<f64>) -> Vec<DVector<Complex<f64>>> {
    modes.iter().map(|mode| real_times_complex(mass, &mode.shape)).collect()
}

/// [`mac`] from the M phi of the old modes.
pub(crate) fn mac_of_weighted(weighted: &[DVector<Complex<f64>>], new: &[Mode]) -> DMatrix<f64> {
    DMatrix::from_fn(weighted.len(), new.len(), |i, j| weighted[i].dotc(&new[j].shape).norm_sqr())
}

/// Match of an old mode: what it became.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Match {
    /// Index of the new mode by optimal assignment; `None` where there are fewer new modes.
    pub to: Option<usize>,
    /// MAC with this mode, 0 without one.
    pub mac: f64,
    /// Other new modes that the old mode may be; empty for a clear match.
    pub rivals: Vec<usize>,
}

impl Match {
    pub fn is_clear(&self) -> bool {
        self.to.is_some() && self.rivals.is_empty()
    }

    /// True if the shapes are so much alike that the new mode is the old one though others may be missing among the new modes.
    pub fn is_same(&self) -> bool {
        self.mac >= LEAST_CLEAR_MAC
    }

    /// True if the shapes have less in common than those of one mode.
    pub fn is_other(&self) -> bool {
        self.mac < LEAST_CLEAR_MAC / 2.0
    }
}

/// Index of the one of `known` that each of `modes` clearly is, by the MAC of all of them together; `None` where that is in doubt. All modes are
/// mass-normalised, and `weighted` has M phi of each of `modes`.
#[must_use]
pub fn clear_matches(modes: &[Mode], weighted: &[DVector<Complex<f64>>], known: &[Mode]) -> Vec<Option<usize>> {
    let clear = |found: Match| found.to.filter(|_| found.is_clear());
    match_weighted(modes, weighted, known).into_iter().map(clear).collect()
}

/// Matches `old` modes to `new` ones by the assignment with the largest sum of MAC (Kuhn 1955, Munkres 1957).
///
/// A match is clear, by a rule, where its MAC is at least 0.4 and it has no rival. A rival is another new mode with a MAC above
/// 0.2 that is within 0.4 of the MAC of the match, or any MAC above 0.2 where the MAC of the match is below 0.8, and whose eigenvalue is
/// less than 8 times as far from the old eigenvalue as the eigenvalue of the match. docs/error-bounds.md, section 14, says how often the rule
/// was checked.
pub(crate) fn match_modes(old: &[Mode], new: &[Mode], mass: &DMatrix<f64>) -> Vec<Match> {
    match_weighted(old, &weighted(old, mass), new)
}

/// [`match_modes`] from the M phi of the old modes.
pub(crate) fn match_weighted(old: &[Mode], weighted: &[DVector<Complex<f64>>], new: &[Mode]) -> Vec<Match> {
    if old.is_empty() || new.is_empty() {
        return vec![Match { to: None, mac: 0.0, rivals: Vec::new() }; old.len()];
    }
    let mac = mac_of_weighted(weighted, new);
    let to = assign(&mac);
    (0..old.len())
        .map(|i| {
            let Some(best) = to[i] else {
                return Match { to: None, mac: 0.0, rivals: Vec::new() };
            };
            let likeness: Vec<f64> = mac.row(i).iter().copied().collect();
            let rivals = rivals(&likeness, best, |j| (new[j].lambda - old[i].lambda).norm());
            Match { to: Some(best), mac: likeness[best], rivals }
        })
        .collect()
}

/// The modes that a mode may be beside the best one, by its MAC with each and the distance of its eigenvalue from theirs.
fn rivals(mac: &[f64], best: usize, distance: impl Fn(usize) -> f64) -> Vec<usize> {
    let rivals = (0..mac.len()).filter(|&j| {
        let near = mac[j] > mac[best] - RIVAL_MAC_MARGIN || mac[best] < LEAST_CLEAR_MAC;
        j != best && near && mac[j] > 1.0 - LEAST_CLEAR_MAC && distance(j) < RIVAL_DISTANCE_RATIO * distance(best)
    });
    let mut rivals: Vec<_> = rivals.collect();
    if rivals.is_empty() && mac[best] < LEAST_CLEAR_MAC / 2.0 {
        // No mode has a similar shape: those with the nearest eigenvalues are rivals, at least the best one.
        rivals = (0..mac.len()).filter(|&j| j != best && distance(j) < 2.0 * distance(best)).collect();
        if rivals.is_empty() {
            rivals.push(best);
        }
    }
    rivals
}

fn assign(mac: &DMatrix<f64>) -> Vec<Option<usize>> {
    let (rows, columns) = mac.shape();
    let weight = |x: f64| (x * 1e12).round() as i64;
    if rows <= columns {
        let weights = Matrix::from_fn(rows, columns, |(i, j)| weight(mac[(i, j)]));
        kuhn_munkres(&weights).1.into_iter().map(Some).collect()
    } else {
        let weights = Matrix::from_fn(columns, rows, |(j, i)| weight(mac[(i, j)]));
        let mut to = vec![None; rows];
        for (j, i) in kuhn_munkres(&weights).1.into_iter().enumerate() {
            to[i] = Some(j);
        }
        to
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dvector;

    fn mode(im: f64, shape: [f64; 2]) -> Mode {
        let shape = dvector![shape[0], shape[1]].map(Complex::from);
        Mode { lambda: Complex::new(0.0, im), shape: shape.normalize() }
    }

    #[test]
    fn crossing_frequencies_do_not_swap_shapes() {
        let old = [mode(1.0, [1.0, 0.1]), mode(2.0, [0.1, -1.0])];
        let new = [mode(1.4, [0.0, 1.0]), mode(1.5, [1.0, 0.0])];
        let matches = match_modes(&old, &new, &DMatrix::identity(2, 2));
        assert_eq!(matches.iter().map(|m| m.to).collect::<Vec<_>>(), [Some(1), Some(0)]);
        assert!(matches.iter().all(Match::is_clear));
    }

    #[test]
    fn shapes_half_way_between_are_rivals() {
        let old = [mode(1.0, [1.0, 0.0])];
        let new = [mode(1.1, [1.0, 1.0]), mode(0.9, [1.0, -1.0])];
        let matched = &match_modes(&old, &new, &DMatrix::identity(2, 2))[0];
        assert!(!matched.is_clear());
    }

    #[test]
    fn a_mode_too_many_is_left_over() {
        let old = [mode(1.0, [1.0, 0.0]), mode(2.0, [0.0, 1.0])];
        let matches = match_modes(&old, &[mode(2.0, [0.0, 1.0])], &DMatrix::identity(2, 2));
        assert_eq!((matches[0].to, matches[1].to), (None, Some(0)));
    }
}
