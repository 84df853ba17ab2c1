//! Cycles with known answers, by integration and shooting.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

mod common;

use std::sync::Arc;

use common::{Curve, FAST, hoffmann, hoffmann_mode, hoffmann_under, mass_on_belt, mass_on_belts, part};
use cycle::{
    Bristled, ContactFriction, ContactState, ContactSystem, Cycle, Measures, Motion, Part, Settings, Shares,
    SlidingContact, Smoothed, follow, harmonics, history, measure, state_after, states,
};
use friction::{
    BristleDamping, BristleMotion, FrictionLaw, FrictionSeries, LuGre, LuGreParameters, Stribeck, StribeckParameters,
    Tangent, VelocityDependent, VelocityDependentParameters,
};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, dmatrix, dvector};
use num_complex::Complex;

const TIGHT: f64 = 1e-12;

/// The shape of a single mass.
const ONE: [Complex<f64>; 1] = [Complex::new(1.0, 0.0)];

fn motion(system: &ContactSystem, start: Vec<f64>, omega: f64, shape: &[Complex<f64>], tolerance: f64) -> Motion {
    follow(system, start, omega, shape, &Settings { tolerance, ..Settings::default() }).unwrap()
}

fn cycle(system: &ContactSystem, start: Vec<f64>, omega: f64, shape: &[Complex<f64>], tolerance: f64) -> Cycle {
    match motion(system, start, omega, shape, tolerance) {
        Motion::Cycle(cycle) => cycle,
        other => panic!("{other:?}"),
    }
}

fn of_hoffmann(mu: f64, load: f64) -> (ContactSystem, Cycle, Measures) {
    let system = hoffmann(mu, load);
    let (lambda, shape) = hoffmann_mode(mu);
    let start = system.state_of_mode(lambda, &shape, 1.1 * system.grazing(&shape));
    let cycle = cycle(&system, start, lambda.im, &shape, TIGHT);
    let measures = measure(&system, &cycle, TIGHT).unwrap();
    (system, cycle, measures)
}

#[test]
fn hoffmanns_oscillator_lifts_off_as_two_matched_linear_phases_do() {
    // mu, period, time open, largest y: two phases of exponentials, matched.
    let known = [
        (0.76, 4.448966455, 0.486631, 0.792378),
        (0.80, 4.485144715, 0.968634, 0.911365),
        (0.90, 4.560150545, 1.435545, 1.096984),
        (1.00, 4.620386802, 1.703075, 1.237861),
        (1.10, 4.670813590, 1.895878, 1.357805),
    ];
    for (mu, period, open, largest) in known {
        let (system, cycle, measures) = of_hoffmann(mu, 1.0);
        assert!((cycle.period - period).abs() < 1e-8, "{mu}: {}", cycle.period);
        assert!((measures.contacts[0].open * cycle.period - open).abs() < 1e-6, "{mu}: {:?}", measures.contacts);
        let loads = history(&system, &states(&system, &cycle, 4096, TIGHT).unwrap());
        let normal = loads.iter().map(|contacts| contacts[0].normal_force).fold(0.0, f64::max);
        assert!(((normal - 1.0) * 0.75 - largest).abs() < 2e-6, "{mu}: {normal}");
        let multiplier = cycle.largest_multiplier();
        assert!((0.889..0.8955).contains(&multiplier), "{mu}: {multiplier}");
        assert!(measures.imbalance() < 1e-10, "{mu}: {}", measures.imbalance());
        // Friction feeds what dashpots take, and a contact that opens takes nothing.
        let power = |name: &str| measures.powers.iter().find(|(family, _)| family == name).unwrap().1;
        assert!(
            power("friction") > 0.0 && power("dashpots") < 0.0 && power("opening").abs() < 1e-10 * power("friction")
        );
    }
}

#[test]
fn harmonics_hold_the_mean_square_of_the_velocity_and_add_up_to_the_motion() {
    let (system, cycle, measures) = of_hoffmann(1.1, 1.0);
    let all = [0, 1];
    let states = states(&system, &cycle, 1024, TIGHT).unwrap();
    let found = harmonics(&cycle, 2, &states, (&all, measures.rms_of(&all)));
    assert!((found.omega * cycle.period / std::f64::consts::TAU - 1.0).abs() < 1e-15);
    let orders = 1..=found.velocity.len();
    // Parseval, of both together and of each.
    for (dofs, most) in [(&all[..], 1e-8), (&all[..1], 1e-6), (&all[1..], 1e-6)] {
        let sum: f64 = orders.clone().map(|harmonic| found.rms_of(harmonic, dofs).powi(2)).sum();
        let missing = 1.0 - sum / measures.rms_of(dofs).powi(2);
        assert!((-1e-10..most).contains(&missing), "{dofs:?}: {missing}");
    }
    // The motion a while after the start, integrated by itself, displacements before velocities.
    for part in [0.0, 0.37, 0.81] {
        let x = state_after(&system, cycle.start.clone(), part * cycle.period, found.omega, TIGHT).unwrap();
        let turn = |harmonic: usize| Complex::cis(std::f64::consts::TAU * harmonic as f64 * part);
        for (dof, size) in [(0, measures.peak[0]), (1, measures.peak[1])] {
            let waves = |of: &dyn Fn(usize) -> Complex<f64>| orders.clone().map(|k| (of(k) * turn(k)).re).sum::<f64>();
            let displacement = found.mean[dof] + waves(&|k| found.displacement(k)[dof]);
            assert_eq!(found.displacement(0)[dof], found.mean[dof].into());
            assert!((displacement - x[dof]).abs() < 1e-4 * size, "{part}, {dof}: {displacement} {}", x[dof]);
            let velocity = waves(&|k| found.velocity[k - 1][dof]);
            assert!((velocity - x[2 + dof]).abs() < 1e-3 * size, "{part}, {dof}: {velocity} {}", x[2 + dof]);
        }
    }
}

#[test]
fn contacts_are_open_and_stuck_at_as_many_steps_as_their_shares_say() {
    let steps = 1000;
    for (system, cycle, measures) in [of_hoffmann(1.1, 1.0), stick_slip(1e-3)] {
        let moments = history(&system, &states(&system, &cycle, steps, 1e-9).unwrap());
        let shares = measures.contacts[0];
        for (state, share) in [(ContactState::Open, shares.open), (ContactState::Stuck, shares.stuck)] {
            let counted = moments.iter().filter(|contacts| contacts[0].state == state).count();
            assert!(
                (counted as f64 / steps as f64 - share).abs() <= 2.0 / steps as f64,
                "{state:?}: {counted} {share}"
            );
        }
        for moment in moments.iter().map(|contacts| contacts[0]) {
            assert_eq!(moment.state == ContactState::Open, moment.normal_force == 0.0, "{moment:?}");
        }
    }
}

#[test]
fn an_amplitude_is_proportional_to_the_load_and_a_frequency_is_not() {
    let (_, one, of_one) = of_hoffmann(0.9, 1.0);
    for load in [1e-3, 0.37, 250.0] {
        let (_, other, of_other) = of_hoffmann(0.9, load);
        assert!((other.period / one.period - 1.0).abs() < 1e-12, "{load}: {}", other.period / one.period - 1.0);
        let ratio = of_other.peak[1] / of_one.peak[1] / load;
        assert!((ratio - 1.0).abs() < 1e-12, "{load}: {}", ratio - 1.0);
    }
}

#[test]
fn a_stable_motion_comes_to_rest() {
    let system = hoffmann(0.5, 1.0);
    let shape = [Complex::new(1.0, 0.0), Complex::new(-1.0, 0.0)];
    let found = motion(&system, vec![0.1, -0.1, 0.0, 0.0], 1.0, &shape, 1e-9);
    assert_eq!(found, Motion::Rest);
}

#[test]
fn a_motion_that_nothing_stops_is_unbounded() {
    // Friction that falls with a slope for ever feeds more than the dashpot takes.
    let system = mass_on_belt(FAST, 0.01, Arc::new(Curve(|w| (0.5 - 0.1 * (w - FAST), -0.1))));
    assert_eq!(motion(&system, vec![1e-3, 0.0], 1.0, &ONE, 1e-9), Motion::Unbounded);
}

#[test]
fn a_motion_without_swings_comes_to_rest_or_grows_without_bounds() {
    // A dashpot of 5 lets the mass creep back; a spring of -1 lets it go.
    for (damping, stiffness, expected) in [(5.0, 1.0, Motion::Rest), (0.1, -1.0, Motion::Unbounded)] {
        let mass = part("mass", dmatrix![1.0], dmatrix![damping], dmatrix![stiffness]);
        let belt = mass_on_belt(1.0, 0.0, Arc::new(Curve(|_| (0.5, 0.0)))).contacts()[0].clone();
        let system = ContactSystem::new(vec![mass], vec![belt]).unwrap();
        assert_eq!(motion(&system, vec![0.1, 0.0], 1.0, &ONE, 1e-9), expected);
    }
}

#[test]
fn springs_that_the_stiffness_does_not_hold_are_refused_by_name() {
    let of = |stiffness: f64| {
        let of_hoffmann = hoffmann(0.8, 1.0);
        // The same reading k c, so that the tangent is the same.
        let normal = vec![(1, 4.0 / 3.0 / stiffness)];
        let belt = SlidingContact { stiffness, normal, ..of_hoffmann.contacts()[0].clone() };
        let structure = Part { family: "structure".into(), matrices: of_hoffmann.structure().clone() };
        ContactSystem::new(vec![structure], vec![belt]).unwrap().check_tangent(&of_hoffmann.tangent(), 1.4)
    };
    // Without the spring [2 1; 1 2 - 16 / 9 / k] remains, definite for k > 32 / 27.
    for stiffness in [1.186, 4.0 / 3.0, 10.0] {
        assert!(of(stiffness).unwrap() < 1e-14);
    }
    for stiffness in [0.133, 1.185] {
        let error = of(stiffness).unwrap_err().to_string();
        assert!(error.starts_with(&format!("contact \"belt\": stiffness = {stiffness}; allowed: ")), "{error}");
    }
}

#[test]
fn masses_that_no_contact_can_be_held_with_are_refused() {
    let (zero, one) = (|| DMatrix::zeros(2, 2), || DMatrix::identity(2, 2));
    let belt = hoffmann(0.8, 1.0).contacts()[0].clone();
    for (mass, reason) in [
        (dmatrix![1.0, 0.1; 0.0, 1.0], "the mass matrix is not symmetric"),
        (dmatrix![1.0, 0.0; 0.0, -1.0], "the mass matrix is not positive definite"),
        (dmatrix![1.0, 0.0; 0.0, 0.0], "the mass matrix has no inverse"),
    ] {
        let error = ContactSystem::new(vec![part("structure", mass, zero(), one())], vec![belt.clone()]).unwrap_err();
        assert_eq!(error.to_string(), reason);
    }
}

/// Rayleigh's equation, whose velocity is van der Pol's x: y'' - (y' - y'^3 / 3) + k y = 0 under the belt's v = 10, with k = 1.
fn van_der_pol() -> ContactSystem {
    let curve = Curve(|w| (1.0 + (10.0 - w) - (10.0 - w).powi(3) / 3.0, -1.0 + (10.0 - w).powi(2)));
    mass_on_belt(10.0, 0.0, Arc::new(curve))
}

#[test]
fn a_motion_that_does_not_repeat_is_measured_once_it_has_settled() {
    // Two masses that know nothing of each other, each of which comes to its cycle; their periods have no common multiple.
    let belt = van_der_pol().contacts()[0].clone();
    let alone = [1.0, 2.0].map(|stiffness| {
        let mass = part("mass", dmatrix![1.0], dmatrix![0.0], dmatrix![stiffness]);
        let system = ContactSystem::new(vec![mass], vec![belt.clone()]).unwrap();
        let found = cycle(&system, vec![2.0, 0.0], stiffness.sqrt(), &ONE, TIGHT);
        measure(&system, &found, TIGHT).unwrap()
    });
    let masses = part("masses", DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![1.0, 0.0; 0.0, 2.0]);
    let other = SlidingContact { sliding: vec![(1, 1.0)], ..belt.clone() };
    let system = ContactSystem::new(vec![masses], vec![belt, other]).unwrap();
    let settings = Settings { settled: Some(0.01), ..Settings::default() };
    let shape = [Complex::from(1.0), Complex::from(0.0)];
    let Motion::NotPeriodic { time, may_settle, stretches } =
        follow(&system, vec![0.1, 0.1, 0.0, 0.0], 1.0, &shape, &settings).unwrap()
    else {
        panic!("the periods of the masses have no common multiple")
    };
    assert_eq!((stretches.len(), may_settle), (4, false));
    let periods = time / std::f64::consts::TAU;
    assert!((80.0..500.0).contains(&periods), "{periods}");
    let together = Measures::together(&stretches);
    for (dof, alone) in alone.iter().enumerate() {
        let [found, expected] = [together.rms_velocity[dof], alone.rms_velocity[0]];
        assert!((found / expected - 1.0).abs() < 0.005, "{dof}: {found} {expected}");
        assert!((together.peak[dof] / alone.peak[0] - 1.0).abs() < 1e-5, "{dof}: {:?} {:?}", together.peak, alone.peak);
    }
    let energy: f64 = alone.iter().map(|alone| alone.kinetic_energy).sum();
    assert!((together.kinetic_energy / energy - 1.0).abs() < 0.01);
}

/// Van der Pol's oscillator whose friction is so weak, eps, has a cycle of amplitude 2 to eps^2 and the multiplier exp(-2 pi eps), both by the averaged amplitude `a' = eps a (1 - a^2 / 4) / 2`,
/// which also says how far a motion has come after 1,000 periods.
#[test]
fn slow_motions_come_to_their_cycle_or_are_said_not_to_have_settled() {
    let belt = van_der_pol().contacts()[0].clone();
    let mut fates = [0, 0];
    let from_rest = [0.02, 0.01, 0.005, 0.003, 0.0025, 0.002, 0.0015, 0.001, 0.0003].map(|eps| (eps, 0.05));
    // These are within reach of shooting only in the last of 1,000 periods.
    for (eps, start) in from_rest.into_iter().chain([(2e-4, 1.78), (1.5e-4, 1.8)]) {
        let mass = part("mass", dmatrix![1.0], dmatrix![0.0], dmatrix![1.0]);
        let system = ContactSystem::new(vec![mass], vec![SlidingContact { load: eps, ..belt.clone() }]).unwrap();
        // a^2 = 4 / (1 + (4 / a_0^2 - 1) exp(-eps t)).
        let end = (4.0_f64 / (1.0 + (4.0_f64 / (start * start) - 1.0) * (-eps * 1000.0 * std::f64::consts::TAU).exp()))
            .sqrt();
        match motion(&system, vec![start, 0.0], 1.0, &ONE, 1e-9) {
            Motion::Cycle(found) => {
                assert!(end > 1.88, "{eps}: {end}");
                let expected = (-std::f64::consts::TAU * eps).exp();
                assert!((found.largest_multiplier() - expected).abs() < eps * eps + 3e-6, "{eps}: {found:?}");
                assert!((found.period - std::f64::consts::TAU).abs() < eps * eps + 3e-6, "{eps}: {found:?}");
                fates[0] += 1;
            }
            Motion::NotPeriodic { may_settle, .. } => {
                assert!(may_settle && end < 1.95, "{eps}: {end}");
                fates[1] += 1;
            }
            other => panic!("{eps}: {other:?}"),
        }
    }
    assert!(fates[0] >= 7 && fates[1] >= 2, "{fates:?}");
}

#[test]
fn van_der_pols_oscillator_has_its_amplitude_and_period() {
    let system = van_der_pol();
    let found = cycle(&system, vec![0.1, 0.0], 1.0, &ONE, TIGHT);
    assert!((found.period - 6.663286859).abs() < 1e-8, "{}", found.period);
    let slips = history(&system, &states(&system, &found, 8192, TIGHT).unwrap());
    let amplitude = slips.iter().map(|contacts| (contacts[0].sliding_velocity - 10.0).abs()).fold(0.0, f64::max);
    assert!((amplitude - 2.008619861).abs() < 1e-6, "{amplitude}");
}

#[test]
fn a_cubic_friction_curve_has_the_amplitudes_integrated_elsewhere() {
    // mu_s 0.4, mu_m 0.25, v_m 0.5, damping 2 x 0.05, without stick: the belt is 1 % and 5 % slower than where small motion begins to grow.
    const K1: f64 = 1.5 * 0.15 / 0.5;
    const K3: f64 = 0.5 * 0.15 / 0.125;
    let curve = |w: f64| (0.4 - K1 * w + K3 * w.powi(3), -K1 + 3.0 * K3 * w * w);
    let onset = 0.5 * (1.0_f64 - 4.0 * 0.05 * 0.5 / (3.0 * 0.15)).sqrt();
    for (part, integrated, averaged) in [(0.99, 0.124757, 0.124410), (0.95, 0.278952, 0.275379)] {
        let speed = part * onset;
        assert!((2.0 * (onset * onset - speed * speed).sqrt() - averaged).abs() < 1e-6);
        let system = mass_on_belt(speed, 0.1, Arc::new(Curve(curve)));
        let found = cycle(&system, vec![0.8 * averaged, 0.0], 1.0, &ONE, 1e-11);
        let extremes = {
            let measures = measure(&system, &found, 1e-11).unwrap();
            // Half of the way from peak to peak: from the cycle, whose mean is not 0.
            let states = (0..2000).map(|i| {
                state_after(&system, found.start.clone(), found.period * f64::from(i) / 2000.0, 1.0, 1e-9).unwrap()[0]
            });
            let all: Vec<f64> = states.collect();
            let least = all.iter().copied().fold(f64::INFINITY, f64::min);
            let greatest = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert!((measures.peak[0] - greatest.max(-least)).abs() < 1e-6);
            0.5 * (greatest - least)
        };
        assert!((extremes - integrated).abs() < 2e-6, "{part}: {extremes}");
    }
}

/// Coefficient 1 at rest and 0.6 in sliding at a belt of 0.3, undamped: `D = 0.4`, amplitude 0.5, period 7.095261538.
fn stick_slip(stick_speed: f64) -> (ContactSystem, Cycle, Measures) {
    let law =
        VelocityDependent::new(VelocityDependentParameters { mu_s: 1.0, mu_k: 0.6, alpha: 1.0 / (30.0 * stick_speed) })
            .unwrap();
    let system = mass_on_belt(0.3, 0.0, Arc::new(Smoothed { law, stick_speed }));
    let found = cycle(&system, vec![0.45, 0.0], 1.0, &ONE, 1e-9);
    let measures = measure(&system, &found, 1e-9).unwrap();
    (system, found, measures)
}

/// Friction of 0.3 with 0.3 more at rest, which falls with the speed, at a belt of 0.2. The two phases: SciPy's DOP853 from the release to where the mass is as fast as the belt,
/// and the belt's way back to the release.
#[test]
fn a_cycle_of_stick_and_slip_is_that_of_its_two_phases() {
    let law = VelocityDependent::new(VelocityDependentParameters { mu_s: 0.6, mu_k: 0.3, alpha: 2.0 }).unwrap();
    // Belts share the load: which of them holds how much of a mass that sticks to all of them is open, and says nothing of how long it sticks.
    let shared = [vec![1.0], vec![0.5, 0.5], vec![0.1, 0.6, 0.3]];
    for (stick_speed, loads) in [2e-3, 0.1].into_iter().flat_map(|speed| shared.iter().map(move |loads| (speed, loads)))
    {
        let system = mass_on_belts(loads, 0.2, 0.02, Arc::new(Smoothed { law, stick_speed }));
        let found = cycle(&system, vec![0.45, 0.0], 1.0, &ONE, 1e-11);
        let measures = measure(&system, &found, 1e-11).unwrap();
        // A stuck mass creeps by a part of 1e-9.
        assert!((found.period - 7.376242207939).abs() < 1e-8, "{}", found.period);
        let is_right = |shares: &Shares| (shares.stuck - 0.327819709338).abs() < 1e-8;
        assert!(measures.contacts.iter().all(is_right), "{measures:?}");
        assert!((measures.peak[0] - 0.4313198632).abs() < 1e-8, "{measures:?}");
        // Friction works on the stuck mass too.
        assert!(measures.imbalance() < 1e-9, "{measures:?}");
        // Whatever it was before, it sticks.
        assert!(found.largest_multiplier() < 1e-8, "{found:?}");
    }
}

#[test]
fn stick_slip_tends_to_coulombs_as_its_curve_narrows() {
    let (period, stuck) = (7.095261538, 2.0 * 0.4 / 0.3 / 7.095261538);
    let mut last = f64::INFINITY;
    for stick_speed in [1e-3, 4e-4, 1e-4] {
        let (_, found, measures) = stick_slip(stick_speed);
        let ratios = [found.period / period, measures.peak[0] / 0.5, measures.contacts[0].stuck / stuck];
        let error = ratios.into_iter().map(|ratio| (ratio - 1.0).abs()).fold(0.0, f64::max);
        assert!(error < last, "{stick_speed}: {ratios:?}");
        last = error;
    }
    assert!(last < 0.02, "{last}");
}

/// LuGre friction at a belt of 0.3 whose bristles are so stiff.
fn bristled(sigma0: f64) -> f64 {
    let law = LuGre::new(LuGreParameters {
        mu_s: 1.0,
        mu_k: 0.6,
        v_s: 3e-3,
        sigma0,
        // Else an undamped mass would swing on its bristles while it sticks.
        sigma1: sigma0.sqrt(),
        sigma2: 0.0,
        bristle_damping: BristleDamping::Decaying,
    });
    let system = mass_on_belt(0.3, 0.0, Arc::new(Bristled { law: law.unwrap(), stick_speed: 3e-3 }));
    cycle(&system, vec![0.45, 0.0, 0.0], 1.0, &ONE, 1e-9).period
}

#[test]
fn lugre_tends_to_coulomb_as_its_bristles_stiffen() {
    let periods = [3e3, 1e4, 3e4].map(bristled);
    let errors = periods.map(|period| (period / 7.095261538 - 1.0).abs());
    assert!(errors[1] < errors[0] && errors[2] < errors[1] && errors[2] < 2e-2, "{periods:?}");
}

#[test]
fn the_tangent_is_that_of_a_law_to_the_last_digits_and_no_other() {
    let law = LuGre::new(LuGreParameters {
        mu_s: 0.6,
        mu_k: 0.4,
        v_s: 0.5,
        sigma0: 50.0,
        sigma1: 0.3,
        sigma2: 0.02,
        bristle_damping: BristleDamping::Decaying,
    })
    .unwrap();
    let at = |damping: f64| mass_on_belt(0.7, damping, Arc::new(Bristled { law, stick_speed: 1e-3 }));
    // The channel of the linear system: b against the belt, load 1.
    let Tangent { slope, internal, .. } = law.tangent_at(0.7).unwrap();
    let state = internal.unwrap();
    let internal =
        Internal { decay: dvector![state.decay], drive: dmatrix![-state.drive], force: dmatrix![state.force] };
    let of_cea = SecondOrder::with_internal(dmatrix![1.0], dmatrix![0.1 + slope], dmatrix![1.0], internal).unwrap();
    assert!(at(0.1).check_tangent(&of_cea, 1.0).unwrap() < 1e-14);
    let error = at(0.1001).check_tangent(&of_cea, 1.0).unwrap_err().to_string();
    assert!(error.contains("tangent in steady sliding deviates"), "{error}");
}

#[test]
fn jacobians_are_limits_of_differences() {
    let law = LuGre::new(LuGreParameters {
        mu_s: 0.6,
        mu_k: 0.4,
        v_s: 0.5,
        sigma0: 50.0,
        sigma1: 0.3,
        sigma2: 0.02,
        bristle_damping: BristleDamping::Decaying,
    })
    .unwrap();
    let smoothed = Smooth(Smoothed { law: law_of_speed(), stick_speed: 0.1 });
    let systems = [
        (
            mass_on_belt(0.7, 0.1, Arc::new(Bristled { law, stick_speed: 1e-3 })),
            vec![vec![0.2, 0.3, 0.004], vec![0.1, 1.2, -0.003]],
        ),
        (
            mass_on_belt(0.7, 0.1, Arc::new(smoothed)),
            vec![vec![0.2, 0.3], vec![0.1, 0.66], vec![0.1, 0.75], vec![0.0, 1.3]],
        ),
        (hoffmann(0.8, 1.0), vec![vec![0.1, 0.4, -0.3, 0.2], vec![0.1, -1.4, -0.3, 0.2]]),
    ];
    for (system, states) in systems {
        for x in states {
            let (jacobian, d) = (system.jacobian(&x), x.len());
            let (mut ahead, mut behind) = (vec![0.0; d], vec![0.0; d]);
            for j in 0..d {
                let moved = |by: f64| (0..d).map(|i| if i == j { x[i] + by } else { x[i] }).collect::<Vec<_>>();
                system.rate(&moved(1e-6), &mut ahead);
                system.rate(&moved(-1e-6), &mut behind);
                for i in 0..d {
                    let difference = (ahead[i] - behind[i]) / 2e-6;
                    assert!((difference - jacobian[(i, j)]).abs() < 1e-7 * (1.0 + jacobian.amax()), "{x:?} {i} {j}");
                }
            }
        }
    }
}

/// Friction of another law, whose series is not told.
#[derive(Debug)]
struct Untold(Arc<dyn ContactFriction>);

impl ContactFriction for Untold {
    fn at(&self, velocity: f64, state: f64) -> BristleMotion {
        self.0.at(velocity, state)
    }

    fn sliding(&self, speed: f64, is_forwards: bool) -> Option<BristleMotion> {
        self.0.sliding(speed, is_forwards)
    }

    fn steady_state(&self, speed: f64) -> Option<f64> {
        self.0.steady_state(speed)
    }

    fn stick_speed(&self) -> f64 {
        self.0.stick_speed()
    }
}

/// Motions whose contact closes, sticks and turns, under laws with a series and under the same laws by substitution.
#[test]
fn a_motion_by_the_series_of_its_law_is_that_by_substitution() {
    let stick_speed = 1e-3;
    let curve = StribeckParameters { mu_s: 1.2, mu_k: 0.7, v_s: 0.5, sigma2: 0.02 };
    let bristles = |bristle_damping| LuGreParameters {
        mu_s: 1.2,
        mu_k: 0.7,
        v_s: 0.5,
        sigma0: 40.0,
        sigma1: 0.3,
        sigma2: 0.02,
        bristle_damping,
    };
    let bristled = |damping| Bristled { law: LuGre::new(bristles(damping)).unwrap(), stick_speed };
    let laws: [Arc<dyn ContactFriction>; 4] = [
        Arc::new(Smoothed { law: law_of_speed(), stick_speed }),
        Arc::new(Smoothed { law: Stribeck::new(curve).unwrap(), stick_speed }),
        Arc::new(bristled(BristleDamping::Constant)),
        Arc::new(bristled(BristleDamping::Decaying)),
    ];
    for (law, friction) in laws.into_iter().enumerate() {
        let untold = || Arc::new(Untold(Arc::clone(&friction)));
        let pairs = [
            [hoffmann_under(friction.clone(), 1.0, 0.4), hoffmann_under(untold(), 1.0, 0.4)],
            [mass_on_belts(&[1.0, 0.6], 0.3, 0.02, friction.clone()), mass_on_belts(&[1.0, 0.6], 0.3, 0.02, untold())],
        ];
        for [by_series, by_substitution] in pairs {
            let start: Vec<f64> = (0..by_series.dimension()).map(|i| [1.3, -0.9, 0.2, 0.7, 0.0][i % 5]).collect();
            let after = |system| state_after(system, start.clone(), 12.0, 1.0, 1e-12).unwrap();
            let (found, expected) = (after(&by_series), after(&by_substitution));
            let difference = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(difference < 1e-8, "law {law}: {found:?} {expected:?}");
            assert!(found != start);
        }
    }
}

/// Friction whose series is that of another friction, or that says of itself that it is constant.
#[derive(Debug)]
struct Mistaken {
    law: Arc<dyn ContactFriction>,
    series: Option<Arc<dyn ContactFriction>>,
}

impl ContactFriction for Mistaken {
    fn at(&self, velocity: f64, state: f64) -> BristleMotion {
        self.law.at(velocity, state)
    }

    fn sliding(&self, speed: f64, is_forwards: bool) -> Option<BristleMotion> {
        self.law.sliding(speed, is_forwards)
    }

    fn steady_state(&self, speed: f64) -> Option<f64> {
        self.law.steady_state(speed)
    }

    fn stick_speed(&self) -> f64 {
        self.law.stick_speed()
    }

    fn is_constant(&self) -> bool {
        self.series.is_none()
    }

    fn series(&self) -> Option<Box<dyn FrictionSeries>> {
        self.series.as_ref()?.series()
    }
}

#[test]
fn friction_that_contradicts_itself_is_refused() {
    let falling = |mu_k, alpha| {
        let law = VelocityDependent::new(VelocityDependentParameters { mu_s: 0.6, mu_k, alpha }).unwrap();
        Arc::new(Smoothed { law, stick_speed: 1e-3 })
    };
    let bristled = |sigma1| {
        let parameters = LuGreParameters {
            mu_s: 0.6,
            mu_k: 0.4,
            v_s: 0.5,
            sigma0: 40.0,
            sigma1,
            sigma2: 0.02,
            bristle_damping: BristleDamping::Constant,
        };
        Arc::new(Bristled { law: LuGre::new(parameters).unwrap(), stick_speed: 1e-3 })
    };
    let said = |law: Arc<dyn ContactFriction>, series: Option<Arc<dyn ContactFriction>>| {
        let contact = SlidingContact {
            name: "belt".into(),
            family: "friction".into(),
            sliding: vec![(0, 1.0)],
            normal: Vec::new(),
            stiffness: 0.0,
            load: 1.0,
            speed: 0.7,
            friction: Arc::new(Mistaken { law, series }),
        };
        let mass = part("springs", dmatrix![1.0], dmatrix![0.0], dmatrix![1.0]);
        ContactSystem::new(vec![mass], vec![contact]).map_err(|error| error.to_string()).err()
    };
    let constant = || common::coulomb(0.5, 1e-3);
    assert_eq!(said(falling(0.4, 2.0), Some(falling(0.4, 2.0))), None);
    assert_eq!(said(bristled(0.3), Some(bristled(0.3))), None);
    assert_eq!(said(constant(), None), None);
    // Another level, the same coefficient with another slope, another damping of bristles, bristles for none, and a coefficient that is not constant.
    let level = 0.6 + 0.2 * (-1.4_f64).exp_m1();
    let steep = 0.6 - (level - 0.6) / (-2.8_f64).exp_m1();
    for (law, series, field) in [
        (
            falling(0.4, 2.0) as Arc<dyn ContactFriction>,
            Some(falling(0.3, 2.0) as Arc<dyn ContactFriction>),
            "coefficient by its series",
        ),
        (falling(0.4, 2.0), Some(falling(steep, 4.0)), "coefficient by its series"),
        (bristled(0.3), Some(bristled(0.2)), "coefficient by its series"),
        (bristled(0.3), Some(falling(0.4, 2.0)), "coefficient by its series"),
        (falling(0.4, 2.0), None, "slope of constant friction"),
    ] {
        let said = said(law, series).unwrap_or_default();
        assert!(said.contains("belt") && said.contains(field), "{said}");
    }
}

/// Friction with another coefficient forwards than backwards.
#[derive(Debug)]
struct Lopsided {
    forwards: f64,
    backwards: f64,
}

impl ContactFriction for Lopsided {
    fn at(&self, velocity: f64, _: f64) -> BristleMotion {
        self.sliding(velocity.abs(), velocity > 0.0).unwrap()
    }

    fn sliding(&self, _: f64, is_forwards: bool) -> Option<BristleMotion> {
        let mu = if is_forwards { self.forwards } else { -self.backwards };
        Some(BristleMotion { mu, ..BristleMotion::default() })
    }

    fn steady_state(&self, _: f64) -> Option<f64> {
        None
    }

    fn stick_speed(&self) -> f64 {
        1e-6
    }
}

/// A mass that moves with its belt, drawn by its spring from steady sliding at u = mu forwards: it is held up to what either way allows.
#[test]
fn a_contact_is_held_by_the_friction_of_the_way_that_it_would_slide() {
    for (forwards, backwards) in [(0.5, 0.3), (0.3, 0.5), (0.4, 0.4)] {
        let system = mass_on_belt(0.1, 0.0, Arc::new(Lopsided { forwards, backwards }));
        for tenths in -9..=9 {
            let force = 0.1 * f64::from(tenths) + 0.05;
            // The spring is at rest without friction at -mu.
            let mut rate = [0.0; 2];
            system.rate(&[force - forwards, 0.1], &mut rate);
            let expected = force.clamp(-backwards, forwards) - force;
            assert!((rate[1] - expected).abs() < 1e-6, "{forwards} {backwards} {force}: {rate:?}");
        }
    }
}

/// However long a contact sticks, it is at rest: its creep does not add up to sliding.
#[test]
fn a_contact_that_sticks_for_long_sticks_to_its_end() {
    for speed in [1e-2, 1e-4] {
        let system = mass_on_belt(speed, 0.0, common::coulomb(0.5, 1e-3 * speed));
        // Drawn along from the middle until the spring needs 0.4 of the 0.5.
        let x = state_after(&system, vec![-0.5, speed], 0.4 / speed, 1.0, 1e-10).unwrap();
        let mut rate = [0.0; 2];
        system.rate(&x, &mut rate);
        assert!((x[0] + 0.1).abs() < 1e-6 && (x[1] / speed - 1.0).abs() < 1e-7, "{x:?}");
        assert!(rate[1].abs() < 1e-6, "{speed}: {rate:?}");
    }
}

/// Friction that stays smooth where the sliding turns.
#[derive(Debug)]
struct Smooth(Smoothed<VelocityDependent>);

impl ContactFriction for Smooth {
    fn at(&self, velocity: f64, state: f64) -> BristleMotion {
        self.0.at(velocity, state)
    }

    fn steady_state(&self, speed: f64) -> Option<f64> {
        self.0.steady_state(speed)
    }

    fn stick_speed(&self) -> f64 {
        self.0.stick_speed()
    }
}

fn law_of_speed() -> VelocityDependent {
    VelocityDependent::new(VelocityDependentParameters { mu_s: 0.6, mu_k: 0.4, alpha: 2.0 }).unwrap()
}

/// A mass on a spring of 1 that meets a spring of 4 after a gap of 1: half a round without it and, from u = 1 on, part of one with it about u = 0.8.
#[test]
fn a_contact_that_is_open_in_steady_sliding_closes_where_its_gap_does() {
    let stop = |load: f64, normal: Vec<(usize, f64)>| SlidingContact {
        name: "stop".into(),
        family: "friction".into(),
        sliding: vec![(1, 1.0)],
        normal,
        stiffness: 4.0,
        load,
        speed: FAST,
        friction: common::coulomb(0.5, 1e-3),
    };
    let zero = || dmatrix![0.0, 0.0; 0.0, 0.0];
    let masses = || part("springs", dmatrix![1.0, 0.0; 0.0, 1.0], zero(), dmatrix![1.0, 0.0; 0.0, 1.0]);
    let system = ContactSystem::new(vec![masses()], vec![stop(-4.0, vec![(0, 1.0)])]).unwrap();
    // At rest it is not there: neither its spring nor its friction.
    let tangent = system.tangent();
    assert_eq!((&tangent.k, &tangent.c), (&masses().matrices.k, &zero()));
    assert!(system.check_tangent(&masses().matrices, 1.0).unwrap() == 0.0);
    let (w, speed) = (5.0_f64.sqrt(), 3.0_f64.sqrt());
    let pressed = 2.0 * (speed / w).atan2(0.2) / w;
    let period = 2.0 * (0.5_f64).asin() + pressed + std::f64::consts::PI;
    let end = state_after(&system, vec![0.0, 0.0, 2.0, 0.0], period, 1.0, 1e-12).unwrap();
    assert!(end[0].abs() < 1e-9 && (end[2] - 2.0).abs() < 1e-9, "{end:?}");
    // Until it presses nothing pulls the other mass.
    let open = state_after(&system, vec![0.0, 0.0, 2.0, 0.0], 0.5_f64.asin(), 1.0, 1e-12).unwrap();
    assert!(open[1].abs() < 1e-9 && open[3].abs() < 1e-9, "{open:?}");
    // (m D^2 + 1) v = 2 (u - 1), with u - 1 = -0.2 + 0.2 cos w t + (speed / w) sin w t.
    let at = |t: f64| {
        let part = |t: f64| 2.0 * (-0.2 + (0.2 * (w * t).cos() + speed / w * (w * t).sin()) / (1.0 - 5.0));
        let rate = 2.0 * (speed / w * w) / (1.0 - 5.0);
        part(t) - part(0.0) * t.cos() - rate * t.sin()
    };
    let middle = 0.5 * pressed;
    let end = state_after(&system, vec![0.0, 0.0, 2.0, 0.0], 0.5_f64.asin() + middle, 1.0, 1e-12).unwrap();
    assert!((end[1] - at(middle)).abs() < 1e-8 && end[1] > 0.0, "{} {}", end[1], at(middle));
    for (load, normal) in [(0.0, vec![(0, 1.0)]), (-1.0, Vec::new())] {
        let error = ContactSystem::new(vec![masses()], vec![stop(load, normal)]).unwrap_err().to_string();
        assert!(error.contains("contact \"stop\": load = "), "{error}");
    }
}

#[test]
fn a_contact_that_opens_for_a_hundredth_of_a_swing_is_seen() {
    // A mass on springs of 1 and, until it opens at u = -1, another 1: u'' = -2 u, and u'' = 1 - u while it is open.
    let stop = SlidingContact {
        name: "stop".into(),
        family: "friction".into(),
        sliding: Vec::new(),
        normal: vec![(0, 1.0)],
        stiffness: 1.0,
        load: 1.0,
        speed: FAST,
        friction: common::coulomb(0.5, 1e-3),
    };
    let mass = part("springs", dmatrix![1.0], dmatrix![0.0], dmatrix![2.0]);
    let system = ContactSystem::new(vec![mass], vec![stop]).unwrap();
    let w = 2.0_f64.sqrt();
    for beyond in [1e-3, 1e-4, 1e-5] {
        let speed = w * (1.0 + beyond);
        let until = (w / speed).asin() / w;
        let open = 2.0 * (0.5 * speed * (w * until).cos()).atan();
        assert!(open < 0.1);
        for part in [0.0, 0.3, 0.7] {
            // Back at u = 0 after it was open, from several places on the way there.
            let start = vec![-speed / w * (w * part * until).sin(), -speed * (w * part * until).cos()];
            let end = state_after(&system, start, (2.0 - part) * until + open, w, TIGHT).unwrap();
            assert!(end[0].abs() < 1e-10 && (end[1] - speed).abs() < 1e-10, "{beyond} {part}: {end:?}");
        }
    }
}
