//! Laws checked against differences, limits, each other and a time integration of the bristle equation.

#![allow(clippy::unwrap_used)]

use friction::{
    AmontonsCoulomb, BristleDamping, FrictionError, FrictionLaw, LuGre, LuGreParameters, Stribeck, StribeckParameters,
    VelocityDependent, VelocityDependentParameters,
};
use num_complex::Complex;
use proptest::prelude::*;

fn lugre_parameters() -> impl Strategy<Value = LuGreParameters> {
    (0.05..0.7, 0.0..0.5, 0.1..2.0, 4.0..6.0, 0.0..20.0, 0.0..0.05, any::<bool>()).prop_map(
        |(mu_k, gap, v_s, log_sigma0, sigma1, sigma2, constant): (f64, f64, f64, f64, f64, f64, bool)| {
            LuGreParameters {
                mu_s: mu_k + gap,
                mu_k,
                v_s,
                sigma0: 10f64.powf(log_sigma0),
                sigma1,
                sigma2,
                bristle_damping: if constant { BristleDamping::Constant } else { BristleDamping::Decaying },
            }
        },
    )
}

fn stribeck_of(p: &LuGreParameters) -> Stribeck {
    Stribeck::new(StribeckParameters { mu_s: p.mu_s, mu_k: p.mu_k, v_s: p.v_s, sigma2: p.sigma2 }).unwrap()
}

/// Fourth-order central difference of the steady coefficient over speed.
fn steady_slope(law: &dyn FrictionLaw, v: f64) -> f64 {
    let h = 1e-3 * v;
    let mu = |v: f64| law.steady(v).unwrap().mu();
    (8.0 * (mu(v + h) - mu(v - h)) - (mu(v + 2.0 * h) - mu(v - 2.0 * h))) / (12.0 * h)
}

proptest! {
    #[test]
    fn lugre_slides_on_the_stribeck_curve(p in lugre_parameters(), v in 0.01..10.0) {
        prop_assert_eq!(LuGre::new(p).unwrap().steady(v), stribeck_of(&p).steady(v));
    }

    #[test]
    fn slow_motion_sees_the_slope_of_the_curve(p in lugre_parameters(), v in 0.01..10.0, angle in 0.0..std::f64::consts::TAU) {
        let lugre = LuGre::new(p).unwrap().tangent_at(v).unwrap();
        let curve = stribeck_of(&p).tangent_at(v).unwrap();
        let state = lugre.internal.unwrap();
        let scale = p.sigma2 + p.sigma1 + state.drive.abs() * p.sigma0 / state.decay;
        for ratio in [1e-3, 1e-6, 1e-9] {
            let h = lugre.complex_slope(Complex::from_polar(ratio * state.decay, angle));
            // h(lambda) - h(0) = b lambda (sigma1 a - sigma0) / (a (lambda + a)): linear in |lambda| / a.
            let bound = 2.0 * ratio * state.drive.abs() * (p.sigma1 + p.sigma0 / state.decay) + 1e-13 * scale;
            prop_assert!((h - curve.slope).norm() <= bound, "ratio {ratio}: {h} against {}", curve.slope);
        }
    }

    #[test]
    fn complex_slope_is_the_formula_by_sigmas(p in lugre_parameters(), v in 0.01..10.0, re in -1e3..1e3, im in 10.0..5e4) {
        prop_assume!(p.bristle_damping == BristleDamping::Constant);
        let lambda = Complex::new(re, im);
        let tangent = LuGre::new(p).unwrap().tangent_at(v).unwrap();
        let e = (-(v / p.v_s).powi(2)).exp();
        let g = p.mu_k + (p.mu_s - p.mu_k) * e;
        let (a, b) = (p.sigma0 * v / g, v / g * (p.mu_k - p.mu_s) * e * 2.0 * v / p.v_s.powi(2));
        let expected = p.sigma2 + (p.sigma0 + p.sigma1 * lambda) * b / (lambda + a);
        // The two forms of h lose digits where sigma0 and sigma1 a cancel.
        let size = p.sigma2 + b.abs() * (p.sigma1 + (p.sigma0 + p.sigma1 * a) / (lambda + a).norm());
        prop_assert!((tangent.complex_slope(lambda) - expected).norm() <= 1e-13 * size);
    }

    #[test]
    fn growing_motion_sees_a_slope_in_the_disc(p in lugre_parameters(), v in 0.01..10.0, size in -3.0..9.0, angle in -90.0..90.0_f64) {
        let tangent = LuGre::new(p).unwrap().tangent_at(v).unwrap();
        let [a, b] = [tangent.slope, tangent.complex_slope(Complex::from(0.0)).re];
        let (centre, radius) = (0.5 * (a + b), 0.5 * (a - b).abs());
        let at = |angle: f64| (tangent.complex_slope(Complex::from_polar(10f64.powf(size), angle.to_radians())) - centre).norm();
        let rounding = 1e-14 * (a.abs() + b.abs());
        prop_assert!(at(angle) <= radius + rounding);
        // The imaginary axis is mapped to the boundary of the disc.
        prop_assert!((at(90.0) - radius).abs() <= rounding);
    }

    #[test]
    fn slopes_are_derivatives(p in lugre_parameters(), alpha in 0.1..5.0, v in 0.05..10.0) {
        let laws: [Box<dyn FrictionLaw>; 4] = [
            Box::new(AmontonsCoulomb::new(p.mu_s).unwrap()),
            Box::new(VelocityDependent::new(VelocityDependentParameters { mu_s: p.mu_s, mu_k: p.mu_k, alpha }).unwrap()),
            Box::new(stribeck_of(&p)),
            Box::new(LuGre::new(p).unwrap()),
        ];
        for law in laws {
            let quasi_static = law.tangent_at(v).unwrap().complex_slope(Complex::from(0.0));
            let difference = steady_slope(law.as_ref(), v);
            let rounding = 1e-12 * law.steady(v).unwrap().mu() / v;
            // The error of the difference grows with (v / v_s)^4 and (alpha v)^4; at large values both slopes vanish.
            prop_assert!((quasi_static - difference).norm() <= 1e-7 * (p.mu_s / v) + rounding);
        }
    }

    #[test]
    fn coefficients_fall_between_static_and_kinetic(p in lugre_parameters(), alpha in 0.0..5.0, v in 0.01..10.0, dv in 0.0..5.0) {
        let p = LuGreParameters { sigma2: 0.0, ..p };
        let laws: [Box<dyn FrictionLaw>; 2] = [
            Box::new(VelocityDependent::new(VelocityDependentParameters { mu_s: p.mu_s, mu_k: p.mu_k, alpha }).unwrap()),
            Box::new(stribeck_of(&p)),
        ];
        for law in laws {
            let (slow, fast) = (law.steady(v).unwrap().mu(), law.steady(v + dv).unwrap().mu());
            prop_assert!(p.mu_s >= slow && slow >= fast && fast >= p.mu_k);
            prop_assert!(law.tangent_at(v).unwrap().slope <= 0.0);
        }
    }
}

/// The first harmonic of the coefficient under the speed `v + amplitude cos(omega t)`, by integrating the nonlinear bristle
/// equation with RK4: a reference that does not use the tangent.
fn harmonic_response(p: &LuGreParameters, v: f64, omega: f64, amplitude: f64) -> Complex<f64> {
    let curve = |v: f64| p.mu_k + (p.mu_s - p.mu_k) * (-(v / p.v_s).powi(2)).exp();
    let speed = |t: f64| v + amplitude * (omega * t).cos();
    let rate = |t: f64, z: f64| speed(t) - p.sigma0 * speed(t).abs() * z / curve(speed(t));
    let sigma1 = |v: f64| match p.bristle_damping {
        BristleDamping::Constant => p.sigma1,
        BristleDamping::Decaying => p.sigma1 * (-(v / p.v_s).powi(2)).exp(),
    };
    let (steps, settle) = (4000, 12);
    let h = std::f64::consts::TAU / omega / f64::from(steps);
    let (mut z, mut harmonic) = (curve(v) / p.sigma0, Complex::from(0.0));
    for step in 0..(settle + 1) * steps {
        let t = f64::from(step) * h;
        if step >= settle * steps {
            let mu = p.sigma0 * z + sigma1(speed(t)) * rate(t, z) + p.sigma2 * speed(t);
            harmonic += mu * Complex::from_polar(2.0 / f64::from(steps), -omega * t);
        }
        let k1 = rate(t, z);
        let k2 = rate(t + 0.5 * h, z + 0.5 * h * k1);
        let k3 = rate(t + 0.5 * h, z + 0.5 * h * k2);
        let k4 = rate(t + h, z + h * k3);
        z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    harmonic / amplitude
}

#[test]
fn complex_slope_is_what_time_integration_shows() {
    for (bristle_damping, sigma1, v) in [
        (BristleDamping::Constant, 10.0, 0.3),
        (BristleDamping::Decaying, 10.0, 0.5),
        (BristleDamping::Constant, 0.0, 0.15),
    ] {
        let p =
            LuGreParameters { mu_s: 0.55, mu_k: 0.45, v_s: 0.6, sigma0: 1e5, sigma1, sigma2: 0.004, bristle_damping };
        let omega = 1.1e4;
        let h = LuGre::new(p).unwrap().tangent_at(v).unwrap().complex_slope(Complex::new(0.0, omega));
        let measured = harmonic_response(&p, v, omega, 1e-4 * v);
        assert!((measured - h).norm() < 1e-7 * h.norm(), "{measured} against {h}");
    }
}

#[test]
fn refuses_bad_parameters_by_name() {
    let good = LuGreParameters {
        mu_s: 0.55,
        mu_k: 0.45,
        v_s: 0.6,
        sigma0: 1e5,
        sigma1: 10.0,
        sigma2: 0.0,
        bristle_damping: BristleDamping::Constant,
    };
    let message = |p: LuGreParameters| LuGre::new(p).unwrap_err().to_string();
    assert_eq!(message(LuGreParameters { mu_s: 0.4, ..good }), "mu_s = 0.4; allowed: >= mu_k = 0.45");
    assert_eq!(message(LuGreParameters { mu_k: 0.0, ..good }), "mu_k = 0; allowed: finite and > 0");
    assert_eq!(message(LuGreParameters { v_s: -1.0, ..good }), "v_s = -1; allowed: finite and > 0");
    assert_eq!(message(LuGreParameters { sigma0: f64::NAN, ..good }), "sigma0 = NaN; allowed: finite and > 0");
    assert_eq!(message(LuGreParameters { sigma1: -0.1, ..good }), "sigma1 = -0.1; allowed: finite and >= 0");
    assert_eq!(message(LuGreParameters { sigma2: f64::INFINITY, ..good }), "sigma2 = inf; allowed: finite and >= 0");
    assert_eq!(AmontonsCoulomb::new(-0.3).unwrap_err().to_string(), "mu = -0.3; allowed: finite and >= 0");
    let falling = VelocityDependentParameters { mu_s: 0.3, mu_k: 0.4, alpha: 1.0 };
    assert_eq!(VelocityDependent::new(falling), Err(FrictionError::StaticBelowKinetic { mu_s: 0.3, mu_k: 0.4 }));
    for v in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let message = LuGre::new(good).unwrap().steady(v).unwrap_err().to_string();
        assert!(message.starts_with("speed = ") && message.ends_with("; allowed: finite and > 0"), "{message}");
    }
}

/// Value of a series with these terms.
fn sum(terms: &[f64], at: f64) -> f64 {
    terms.iter().rev().fold(0.0, |sum, term| sum * at + term)
}

proptest! {
    /// Along a motion that is a polynomial of time, the terms add up to the law itself at each time.
    #[test]
    fn series_of_a_law_add_up_to_the_law(
        p in lugre_parameters(), alpha in 0.0..3.0, v in 0.3..5.0, moved in proptest::array::uniform4(-0.05..0.05), is_forwards: bool,
    ) {
        let sign = if is_forwards { 1.0 } else { -1.0 };
        let velocity = [sign * v, moved[0], moved[1], moved[2]];
        let lugre = LuGre::new(p).unwrap();
        let state = [sign * lugre.steady_bristle(v), 0.1 * moved[3] / p.sigma0, 0.1 * moved[0] / p.sigma0];
        let falling = VelocityDependent::new(VelocityDependentParameters { mu_s: p.mu_s, mu_k: p.mu_k, alpha }).unwrap();
        let stribeck = stribeck_of(&p);
        let of_speed = |law: &dyn FrictionLaw, w: f64| [sign * law.steady(w.abs()).unwrap().mu(), 0.0];
        let expected = |law: usize, w: f64, z: f64| match law {
            0 => of_speed(&falling, w),
            1 => of_speed(&stribeck, w),
            _ => {
                let motion = lugre.moving(w, z);
                [motion.mu, motion.rate]
            }
        };
        for (law, series) in [falling.series(), stribeck.series(), lugre.series()].into_iter().enumerate() {
            let mut series = series.unwrap();
            // What was asked before is forgotten.
            series.begin(!is_forwards);
            series.next(1.0, 1.0);
            series.begin(is_forwards);
            let term = |terms: &[f64], k: usize| terms.get(k).copied().unwrap_or(0.0);
            let terms: Vec<[f64; 2]> = (0..40).map(|k| series.next(term(&velocity, k), term(&state, k))).collect();
            for at in [0.0, 0.2, 0.5] {
                let expected = expected(law, sum(&velocity, at), sum(&state, at));
                let scale = [1.0 + p.sigma1 * v, v];
                for of in 0..2 {
                    let found = sum(&terms.iter().map(|term| term[of]).collect::<Vec<_>>(), at);
                    prop_assert!((found - expected[of]).abs() <= 1e-11 * scale[of], "{law} {of} {at}: {found} {expected:?}");
                }
            }
        }
    }
}
