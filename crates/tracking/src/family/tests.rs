//! Against closed forms: a flutter oscillator with two degrees of freedom, and modes that cross without coalescing.

use super::*;
use crate::branch::{BranchPoint, Branches, follow_branch};
use crate::locus::Ambiguity;
use crate::onset_search::Onset;
use nalgebra::{DMatrix, dmatrix};
use num_complex::Complex;

/// Stiffness of the oscillator of Hoffmann, Fischer, Allgaier, Gaul, Eur. J. Mech. A/Solids 21, 2002: two degrees of freedom of equal mass that friction
/// couples, with damping in proportion to the mass.
const K: [[f64; 2]; 2] = [[11.0, -5.0], [-5.0, 6.0]];
/// Stiffness of its contact, by which friction enters K.
const CONTACT: f64 = 8.0;

fn hoffmann(damping: f64) -> impl FnMut(f64) -> Result<SecondOrder, TrackingError> {
    move |mu| {
        let k = dmatrix![K[0][0], K[0][1] + mu * CONTACT; K[1][0], K[1][1]];
        Ok(SecondOrder::new(DMatrix::identity(2, 2), DMatrix::identity(2, 2) * damping, k)?)
    }
}

/// `lambda^2 + c lambda = -a +- sqrt(b(mu))` with b linear in mu: where lambda = i omega, omega^2 = a and b = -c^2 a.
fn flutter(damping: f64) -> (f64, f64) {
    let a = 0.5 * (K[0][0] + K[1][1]);
    let half = 0.5 * (K[0][0] - K[1][1]);
    // b = half^2 + (k12 + mu k) k21.
    let coupling = (-damping * damping * a - half * half) / K[1][0];
    ((coupling - K[0][1]) / CONTACT, a.sqrt())
}

#[test]
fn the_flutter_oscillator_begins_to_flutter_where_its_closed_form_says() {
    for damping in [1e-3, 0.05, 0.3] {
        let found = onsets(hoffmann(damping), 0.0, 1.5).unwrap();
        let (mu, omega) = flutter(damping);
        assert!(found.unresolved.is_empty() && found.onsets.len() == 1, "{found:?}");
        let Onset { at, error, omega: frequency, destabilises } = found.onsets[0];
        assert!((at - mu).abs() <= error + 1e-13 && error < 1e-8, "{at} {mu} {error:e}");
        assert!((frequency - omega).abs() < 1e-6 && destabilises);
    }
}

/// Two modes with frequencies 2 -+ p and damping that does not let them coalesce; the first is driven between p = -0.5 and 0.5.
fn crossing(p: f64) -> Result<SecondOrder, TrackingError> {
    let c = dmatrix![p * p - 0.25, 0.0; 0.0, 0.6];
    let k = dmatrix![(2.0 - p) * (2.0 - p), 0.0; 0.0, (2.0 + p) * (2.0 + p)];
    Ok(SecondOrder::new(DMatrix::identity(2, 2), c, k)?)
}

#[test]
fn a_crossing_without_coalescence_has_onsets_and_unbroken_branches() {
    let found = onsets(crossing, -1.0, 1.0).unwrap().onsets;
    assert_eq!(found.len(), 2);
    for (onset, (at, destabilises)) in found.iter().zip([(-0.5, true), (0.5, false)]) {
        assert!((onset.at - at).abs() < 1e-10 && (onset.omega - (2.0 - at)).abs() < 1e-9, "{onset:?}");
        assert_eq!(onset.destabilises, destabilises);
    }
    let locus = branches(crossing, -1.0, 1.0).unwrap();
    assert_eq!((locus.branches.len(), locus.ambiguities.len()), (2, 0));
    for branch in &locus.branches {
        let of = |damping: f64, k: f64| Complex::new(-0.5 * damping, (k * k - (0.5 * damping).powi(2)).sqrt());
        let (start, first) = branch.points[0];
        assert_eq!(start, -1.0);
        let is_driven = (first.lambda - of(0.75, 3.0)).norm() < 1e-9;
        for &(p, BranchPoint { lambda, .. }) in &branch.points {
            let expected = if is_driven { of(p * p - 0.25, 2.0 - p) } else { of(0.6, 2.0 + p) };
            assert!((lambda - expected).norm() < 1e-9, "{p}: {lambda} {expected}");
        }
        assert_eq!(branch.points.last().unwrap().0, 1.0);
    }
}

#[test]
fn through_a_coalescence_branches_end_and_others_begin() {
    // Damping in proportion to the mass: the two coalesce exactly, below the onset.
    let coalescence = (0.5 * (K[0][0] - K[1][1])).powi(2) / (-K[1][0] * CONTACT) - K[0][1] / CONTACT;
    let locus = branches(hoffmann(0.05), 0.0, 1.5).unwrap();
    assert_eq!(locus.branches.len(), 4, "{:?}", locus.ambiguities);
    let Ambiguity { from, to, before, after } = &locus.ambiguities[0];
    assert!(locus.ambiguities.len() == 1 && *from <= coalescence && coalescence <= *to);
    assert_eq!((&before[..], &after[..]), (&[0, 1][..], &[2, 3][..]));
}

#[test]
fn a_branch_is_followed_to_one_end_and_past_a_coalescence_to_both() {
    let follow = |family: &mut dyn Branches<Error = TrackingError>, index: usize, [a, b]: [f64; 2]| {
        follow_branch(family, a, index, b, 1e-9).unwrap().into_iter().collect::<Vec<_>>()
    };
    // The two change their order by frequency.
    let mut family = KeptSpectra::new(with_change(crossing, -1.0, 1.0), &QrSolver);
    for ends in [[-1.0, 1.0], [1.0, -1.0]] {
        assert_eq!([0, 1].map(|index| follow(&mut family, index, ends)), [[1], [0]]);
    }
    let mut family = KeptSpectra::new(with_change(hoffmann(0.05), 0.0, 1.5), &QrSolver);
    assert_eq!(follow(&mut family, 0, [0.0, 0.5]), [0]);
    for ends in [[0.0, 1.5], [1.5, 0.0]] {
        assert_eq!(follow(&mut family, 0, ends), [0, 1]);
    }
}

#[test]
fn what_is_no_interval_or_has_no_modes_is_refused() {
    for (from, to) in [(1.0, 0.0), (0.0, 0.0), (0.0, f64::INFINITY), (f64::NAN, 1.0)] {
        assert!(matches!(onsets(hoffmann(0.1), from, to), Err(TrackingError::Interval { .. })));
        assert!(matches!(branches(hoffmann(0.1), from, to), Err(TrackingError::Interval { .. })));
    }
    let overdamped = |p: f64| -> Result<SecondOrder, TrackingError> {
        Ok(SecondOrder::new(dmatrix![1.0], dmatrix![4.0 * p], dmatrix![1.0])?)
    };
    assert!(matches!(onsets(overdamped, 0.1, 1.0), Err(TrackingError::ModeCount { found: 0, expected: 1, .. })));
    let failing = |_: f64| Err::<SecondOrder, Box<dyn std::error::Error>>("no system".into());
    assert_eq!(onsets(failing, 0.0, 1.0).unwrap_err().to_string(), "no system");
}
