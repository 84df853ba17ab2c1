//! Onsets of coefficients that follow tables, beside and at the kinks of these, against closed forms.

use brakes::MatricesBrake;
use sweep::{CurveEnd, Sweep};

use super::{hoffmann_with, mapped, over, swept};

/// Place of the kink.
const KINK: f64 = 0.6;

/// Sweep of Hoffmann's oscillator over p from 0 to 1, with friction that is `at_kink` at the kink and has these slopes before and beyond it, and
/// dashpots c. It flutters from `mu = 0.75 (1 + 2 c^2)`.
fn of_kink(at_kink: f64, [before, beyond]: [f64; 2], c: f64) -> Sweep {
    let (first, last) = (at_kink - before * KINK, at_kink + beyond * (1.0 - KINK));
    let table = format!("[tables.friction]\nat = [0.0, {KINK:?}, 1.0]\nvalue = [{first:?}, {at_kink:?}, {last:?}]\n");
    swept(&MatricesBrake::new(hoffmann_with("friction(p)", c, &table)).unwrap(), &over("p", 0.0, 1.0))
}

/// One onset at a distance from the kink, before it or beyond, where friction rises and where it falls, by slopes of any ratio: within the error that is
/// printed, which is small.
#[test]
fn onsets_beside_kinks_are_those_of_the_closed_form() {
    let mut worst: f64 = 0.0;
    for c in [0.05, 0.0] {
        let onset_at = 0.75 * (1.0 + 2.0 * c * c);
        for slopes in [[0.5, 0.5], [0.2, 1.0], [1.0, 0.02], [0.001, 1.0], [0.0, 0.3], [-0.3, -0.02], [-0.002, -1.0]] {
            for distance in [-1e-2, -3e-4, -7e-6, -1e-7, -1e-10, 0.0, 1e-10, 1e-7, 7e-6, 3e-4, 1e-2] {
                let own: f64 = slopes[usize::from(distance > 0.0)];
                if own == 0.0 {
                    continue;
                }
                let found = of_kink(onset_at - own * distance, slopes, c);
                let [onset] = &found.onsets[..] else { unreachable!("{slopes:?} {distance}: {:?}", found.onsets) };
                let off = (onset.at - KINK - distance).abs();
                println!("c {c}, slopes {slopes:?}, {distance:e}: off by {off:.1e}, error {:.1e}", onset.error);
                worst = worst.max(off / onset.error);
                assert_eq!(onset.starts, own > 0.0);
                // Undamped, next to a flat piece, the distance of two eigenvalues tells little of where they meet.
                assert!(
                    onset.error < if c > 0.0 { 1e-9 } else { 1e-6 },
                    "c {c}, slopes {slopes:?}, {distance:e}: {onset:?}"
                );
            }
        }
    }
    assert!(worst <= 1.0, "{worst}");
}

/// Friction that rises over the onset and falls again behind it at once: both onsets of a tent, however near they are to its top, as long as a step of the sweep
/// lies between.
#[test]
fn a_tent_has_two_onsets() {
    for half in [0.1, 0.002] {
        let onset_at = 0.75 * (1.0 + 2.0 * 0.05 * 0.05);
        let found = of_kink(onset_at + 0.5 * half, [0.5, -0.5], 0.05);
        let [starts, stops] = &found.onsets[..] else { unreachable!("{:?}", found.onsets) };
        for (onset, expected) in [(starts, KINK - half), (stops, KINK + half)] {
            assert!(
                (onset.at - expected).abs() <= onset.error.max(1e-12) && onset.error < 1e-9,
                "{onset:?} {expected}"
            );
        }
    }
}

/// The boundary over two parameters beside a kink: at each of its points friction is that of the onset. It is followed up to the kink from both sides, and said to be lost there.
#[test]
fn a_boundary_is_followed_to_a_kink_from_both_sides() {
    let table = "[tables.friction]\nat = [0.0, 0.5, 1.0]\nvalue = [0.7, 0.76, 0.9]\n";
    let brake = MatricesBrake::new(hoffmann_with("friction(p)", 0.05, table)).unwrap();
    let map = mapped(&brake, &[over("p", 0.0, 1.0), over("c", 0.01, 0.2)]);
    assert_eq!(map.unresolved, 0);
    let mut found: Vec<f64> = Vec::new();
    for curve in &map.curves {
        let ends = [curve.points.first().unwrap(), curve.points.last().unwrap()];
        for (point, end) in ends.into_iter().zip(curve.ends) {
            assert!(
                end == CurveEnd::Edge || (end == CurveEnd::Lost && (point.at[0] - 0.5).abs() < 2e-3),
                "{end:?} {point:?}"
            );
        }
        for point in &curve.points {
            let [p, c] = point.at;
            let friction = if p < 0.5 { 0.7 + 0.12 * p } else { 0.76 + 0.28 * (p - 0.5) };
            assert!((friction - 0.75 * (1.0 + 2.0 * c * c)).abs() < 1e-11, "{point:?}");
            found.push(p);
        }
    }
    found.sort_by(f64::total_cmp);
    let gap = found.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    // From c = 0.01, where friction is 0.75015, to c = 0.2, where it is 0.81.
    let ends = [found[0] - 0.05015 / 0.12, found[found.len() - 1] - (0.5 + 0.05 / 0.28)];
    assert!(gap < 0.03 && ends.iter().all(|off| off.abs() < 1e-9), "{gap} {ends:?}");
}

/// The coalescence of the damped oscillator, at mu = 0.75: where it is found next to a kink, it is there by the error that is estimated.
#[test]
fn coalescences_beside_kinks_are_where_they_are_said_to_be() {
    let mut found_of_all = 0;
    for slopes in [[0.5, 0.5], [0.2, 1.0], [1.0, 0.02]] {
        for distance in [-1e-2, -3e-4, -7e-6, -1e-7, 0.0, 1e-7, 7e-6, 3e-4, 1e-2] {
            let own: f64 = slopes[usize::from(distance > 0.0)];
            let found = of_kink(0.75 - own * distance, slopes, 0.05);
            for met in &found.coalescences {
                let off = (met.at - KINK - distance).hypot(met.distance);
                println!("slopes {slopes:?}, {distance:e}: off by {off:.1e}, error {:.1e}", met.error);
                assert!(off <= met.error.max(1e-9), "slopes {slopes:?}, {distance:e}: {off:e} {met:?}");
            }
            found_of_all += found.coalescences.len();
        }
    }
    assert!(found_of_all >= 9, "{found_of_all}");
}
