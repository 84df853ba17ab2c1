//! Onsets and boundaries of thresholds against the closed forms of Hoffmann's oscillator, whose eigenvalues are those of
//! `lambda^2 + c lambda + 2 +- i b = 0` with `b^2 = mu / 0.75 - 1`. So `mu = 0.75 (1 + (2 g + c)^2 (2 + g^2 + g c))` at the growth rate g,
//! where the frequency is `omega^2 = 2 + g^2 + g c`.

use brakes::MatricesBrake;
use brakes::case::MatricesCase;
use cea::Threshold;
use sweep::CurveEnd;

use super::{cases, hoffmann, mapped, over, swept};

fn beyond(mut case: MatricesCase, threshold: Threshold) -> MatricesBrake {
    case.header.threshold = threshold;
    MatricesBrake::new(case).unwrap()
}

/// The growth rate at the threshold for dashpots c: `g = t omega` at the damping ratio -r, `t = r / (1 - r^2)^1/2`.
fn growth(threshold: &Threshold, c: f64) -> f64 {
    let r = -threshold.damping_ratio_below();
    let t = r / (1.0 - r * r).sqrt();
    let omega = (t * c + (t * t * c * c + 8.0 * (1.0 - t * t)).sqrt()) / (2.0 * (1.0 - t * t));
    threshold.growth_above().max(t * omega)
}

fn friction(g: f64, c: f64) -> f64 {
    0.75 * (1.0 + (2.0 * g + c).powi(2) * (2.0 + g * g + g * c))
}

#[test]
fn an_onset_is_where_the_mode_reaches_the_threshold() {
    for (growth_above, ratio) in [(0.03, 0.0), (0.0, -0.02), (0.01, -0.02), (0.03, -0.02)] {
        let threshold = Threshold::new(growth_above, ratio).unwrap();
        let found = swept(&beyond(hoffmann("p"), threshold), &over("p", 0.0, 1.0));
        let [onset] = &found.onsets[..] else { panic!("{:?}", found.onsets) };
        let g = growth(&threshold, 0.05);
        assert!((onset.at - friction(g, 0.05)).abs() < 1e-12 && onset.error < 1e-12, "{onset:?}");
        assert!((onset.omega.powi(2) - (2.0 + g * g + g * 0.05)).abs() < 1e-10, "{onset:?}");
        assert!(onset.starts && onset.mode == "2" && found.unstable_at_start == 0, "{onset:?}");
        let later = swept(&beyond(hoffmann("p"), threshold), &over("p", onset.at + 0.01, 1.0));
        assert!(later.onsets.is_empty() && later.unstable_at_start == 1, "{later:?}");
    }
}

#[test]
fn a_boundary_is_the_curve_on_which_the_mode_is_at_the_threshold() {
    for (growth_above, ratio) in [(0.02, 0.0), (0.0, -0.015)] {
        let threshold = Threshold::new(growth_above, ratio).unwrap();
        let map = mapped(&beyond(hoffmann("p"), threshold), &[over("p", 0.5, 1.1), over("c", 0.01, 0.2)]);
        assert_eq!((map.curves.len(), map.unresolved), (1, 0));
        assert_eq!((map.curves[0].ends, map.curves[0].mode.as_str()), ([CurveEnd::Edge; 2], "2"));
        for point in &map.curves[0].points {
            let [mu, c] = point.at;
            assert!((mu - friction(growth(&threshold, c), c)).abs() < 1e-11, "{point:?}");
        }
        assert_eq!(map.regions.iter().map(|region| region.unstable).max(), Some(1));
    }
}

/// Friction the other way round: `lambda^2 + c lambda + 2 + s - (1 + 4 mu / 3)^1/2` has the zero g at a known friction.
#[test]
fn divergence_counts_from_the_growth_rate_on() {
    let text = std::fs::read_to_string(cases("hoffmann.toml")).unwrap();
    let text = text.replace("{ y = 1.3333333333333333 }", "{ y = -1.3333333333333333 }").replace(
        "[[contacts]]",
        "[parameters.s]\ndistribution = \"uniform\"\nfrom = 0.0\nto = 0.4\n\
         [[terms]]\nname = \"spring\"\ncoefficient = \"s\"\nstiffness = [[1.0, 0.0], [0.0, 1.0]]\n[[contacts]]",
    );
    let case = || MatricesCase::parse(&cases("hoffmann.toml"), text.clone()).unwrap();
    let onset = |g: f64, s: f64| 0.75 * ((2.0 + s + g * g + 0.05 * g).powi(2) - 1.0);
    let brake = beyond(case(), Threshold::new(0.3, -0.001).unwrap());
    let found = swept(&brake, &over("mu", 0.5, 4.0));
    let [only] = &found.onsets[..] else { panic!("{:?}", found.onsets) };
    assert!((only.at - onset(0.3, 0.2)).abs() < 1e-12 && only.error < 1e-12, "{only:?}");
    assert_eq!((only.mode.as_str(), only.omega, only.starts), ("divergence", 0.0, true));
    let map = mapped(&brake, &[over("mu", 1.0, 4.0), over("s", 0.0, 0.4)]);
    assert_eq!(map.curves.len(), 1);
    for point in &map.curves[0].points {
        assert!((point.at[0] - onset(0.3, point.at[1])).abs() < 1e-11 && point.omega == 0.0, "{point:?}");
    }
}
