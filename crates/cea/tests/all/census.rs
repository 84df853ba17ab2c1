//! The census of a system: the growing modes, and no undecided ones away from an onset.

#![allow(clippy::unwrap_used)]

use cea::{
    CountedSpectrum, EigenSolver, QrSolver, StabilityCensus, Threshold, Verdict, Workspace, stability_census, verdict,
};
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, dmatrix, dvector};

/// Hoffmann, Fischer, Allgaier, Gaul (Mechanics Research Communications 29, 2002): a mass on two inclined springs and a
/// contact spring, whose normal force times mu pushes it along the belt. Undamped unless `damping` says otherwise.
struct Hoffmann {
    mu: f64,
    damping: DMatrix<f64>,
}

impl Hoffmann {
    const CONTACT: f64 = 4.0 / 3.0;

    /// The stiffness of the springs without friction: 2/3 at 150 degrees, 1 at 30 degrees, 4/3 at the contact.
    fn stiffness() -> DMatrix<f64> {
        let spring = |k: f64, degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            k * dmatrix![cos * cos, sin * cos; sin * cos, sin * sin]
        };
        spring(2.0 / 3.0, 150.0) + spring(1.0, 30.0) + dmatrix![0.0, 0.0; 0.0, Self::CONTACT]
    }

    /// The mu at which the two frequencies meet: `(k11 - k22)^2 + 4 (k12 - mu k3) k21 = 0`.
    fn onset() -> f64 {
        let k = Self::stiffness();
        ((k[(0, 0)] - k[(1, 1)]).powi(2) / (4.0 * k[(1, 0)]) + k[(0, 1)]) / Self::CONTACT
    }

    fn system(&self) -> SecondOrder {
        let mut k = Self::stiffness();
        k[(0, 1)] -= self.mu * Self::CONTACT;
        SecondOrder::new(DMatrix::identity(2, 2), self.damping.clone(), k).unwrap()
    }

    fn census(&self) -> StabilityCensus {
        stability_census(&self.system(), &mut Workspace::default()).unwrap()
    }
}

/// mu from 0 to 1 in even steps that miss the onset.
fn coefficients(count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| (f64::from(i) + 0.5) / f64::from(count))
}

#[test]
fn no_undamped_oscillator_stays_open() {
    let onset = Hoffmann::onset();
    let (mut neutral, mut unstable) = (0, 0);
    for mu in coefficients(2_000) {
        let census = Hoffmann { mu, damping: DMatrix::zeros(2, 2) }.census();
        assert!(census.undecided.is_empty() && census.divergent.is_empty(), "mu = {mu}: {census:?}");
        if mu < onset {
            assert_eq!((census.marginal.len(), census.growing.len(), census.is_certified), (2, 0, true), "mu = {mu}");
            neutral += 1;
        } else {
            assert_eq!((census.damped, census.growing.len(), census.is_certified), (1, 1, false), "mu = {mu}");
            assert!(census.growing[0].bound < census.growing[0].lambda.re);
            unstable += 1;
        }
    }
    assert!(neutral > 300 && unstable > 300, "{neutral} neutral, {unstable} unstable");
}

#[test]
fn only_the_onset_itself_is_doubtful() {
    let onset = Hoffmann::onset();
    // Nearer, 32 roundings of the matrices reach from one side to the other.
    for exponent in 1..=12 {
        let distance = 10_f64.powi(-exponent);
        let at = |mu| Hoffmann { mu, damping: DMatrix::zeros(2, 2) }.census();
        let (below, above) = (at(onset * (1.0 - distance)), at(onset * (1.0 + distance)));
        println!("{distance:e}: {below:?} {above:?}");
        assert!(!below.is_unstable() && !below.is_open());
        assert!(above.is_unstable());
    }
    // At the onset the pair is defective to rounding: marginal, and never called unstable.
    let there = Hoffmann { mu: onset, damping: DMatrix::zeros(2, 2) }.census();
    assert!(!there.is_unstable(), "{there:?}");
}

#[test]
fn no_damped_oscillator_stays_open() {
    let dampings = [dmatrix![0.02, 0.0; 0.0, 0.02], dmatrix![0.02, 0.0; 0.0, 0.0], dmatrix![0.0, 0.0; 0.0, 1e-6]];
    for damping in dampings {
        let (mut certified, mut unstable) = (0, 0);
        for mu in coefficients(2_000) {
            let census = Hoffmann { mu, damping: damping.clone() }.census();
            // Where the weak dashpot hardly moves a mode its damping is that of rounding, and marginal by the rule of all studies.
            let is_on_axis = census.marginal.iter().all(|judged| judged.lambda.re.abs() < 5e-12);
            assert!(census.undecided.is_empty() && is_on_axis, "mu = {mu}: {census:?}");
            certified += u32::from(census.is_certified);
            unstable += u32::from(census.is_unstable());
        }
        println!("{unstable} unstable, {certified} certified");
        assert!(certified <= 4 && (200..1_800).contains(&unstable), "{damping}: {unstable}, {certified}");
    }
}

#[test]
fn certificates_are_asked_for_only_where_the_fast_verdict_is_undecided() {
    for (damping, asked) in [(0.0, true), (0.02, false)] {
        let system = Hoffmann { mu: 0.1, damping: DMatrix::identity(2, 2) * damping }.system();
        let mut work = Workspace::default();
        let spectrum = QrSolver.eigenvalues(&system, &mut work).unwrap();
        let open = spectrum
            .oscillatory()
            .filter(|&lambda| {
                let verdict = verdict(&system, lambda, &spectrum, &mut work).unwrap();
                !matches!(verdict, Verdict::Stable | Verdict::Unstable)
            })
            .count();
        assert_eq!(open > 0, asked);

        let mut work = Workspace::default();
        let census = stability_census(&system, &mut work).unwrap();
        assert_eq!((census.is_certified, work.counters.eigenvalue_solves), (asked, 1 + u64::from(asked)));
        // Clearly damped modes cost no vectors.
        assert_eq!(work.counters.eigenvectors > 0, asked);
    }
}

#[test]
fn a_defective_pair_is_marginal_damped_or_growing_as_its_damping_says() {
    // lambda^2 + 2 d lambda + 1 = 0 twice with one vector: Re lambda = -d.
    let pair = |d: f64| {
        let c = DMatrix::identity(2, 2) * (2.0 * d);
        let system = SecondOrder::new(DMatrix::identity(2, 2), c, dmatrix![1.0, 1.0; 0.0, 1.0]).unwrap();
        stability_census(&system, &mut Workspace::default()).unwrap()
    };
    let neutral = pair(0.0);
    assert_eq!((neutral.marginal.len(), neutral.is_certified), (2, true));
    assert_eq!(pair(1e-3).damped, 2);
    assert_eq!(pair(-1e-3).growing.len(), 2);
}

#[test]
fn divergence_is_told_from_flutter_and_singular_mass_is_no_obstacle() {
    let census = |system: &SecondOrder| stability_census(system, &mut Workspace::default()).unwrap();
    // A spring that is negative: lambda = -1 +- sqrt(2), real.
    let buckled = census(&SecondOrder::new(dmatrix![1.0], dmatrix![2.0], dmatrix![-1.0]).unwrap());
    assert_eq!((buckled.divergent.len(), buckled.growing.len(), buckled.damped), (1, 0, 1));
    assert!((buckled.divergent[0].lambda.re - (2_f64.sqrt() - 1.0)).abs() < 1e-15);
    assert!(!buckled.is_certified);

    // A free body: lambda = 0 twice.
    let free = census(&SecondOrder::new(dmatrix![1.0], dmatrix![0.0], dmatrix![0.0]).unwrap());
    assert_eq!((free.marginal.len(), free.is_unstable(), free.is_open()), (2, false, false));

    let massless = dmatrix![1.0, 0.0; 0.0, 0.0];
    let joint = SecondOrder::new(massless, dmatrix![0.2, 0.0; 0.0, 0.0], dmatrix![2.0, -2.0; -2.0, 4.0]).unwrap();
    let joint = census(&joint);
    assert_eq!((joint.damped, joint.is_certified), (1, true));
}

#[test]
fn internal_states_feed_or_drain_a_mode() {
    // (lambda^2 + 4)(lambda + 3) = +-0.1 lambda: the state acts as a dashpot of either sign.
    for (force, grows) in [(0.1, true), (-0.1, false)] {
        let internal = Internal { decay: dvector![3.0], drive: dmatrix![1.0], force: dmatrix![force] };
        let system = SecondOrder::with_internal(dmatrix![1.0], dmatrix![0.0], dmatrix![4.0], internal).unwrap();
        let census = stability_census(&system, &mut Workspace::default()).unwrap();
        assert_eq!((census.is_unstable(), census.damped, census.is_certified), (grows, 2 - usize::from(grows), false));
    }
}

/// Random chains without damping, gyroscopic ones, with dashpots down to rounding of either sign, free or held: what the census says is on the axis, grows
/// and diverges is what studies, sweeps and maps count.
#[test]
fn the_census_and_counted_spectra_have_one_rule() {
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut marginal, mut growing, mut damped) = (0, 0, 0);
    for at in 0..400 {
        let n = 1 + (6.0 * random()) as usize;
        let springs: Vec<f64> = (0..=n).map(|_| 10f64.powf(4.0 * random())).collect();
        let held = if at % 5 == 0 { 0.0 } else { springs[n] };
        let k = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => {
                springs[i] * f64::from(i + 1 < n) + springs[i.max(1) - 1] * f64::from(i > 0) + held * f64::from(i == 0)
            }
            1 => -springs[i.min(j)],
            _ => 0.0,
        });
        let m = DMatrix::from_diagonal(&nalgebra::DVector::from_fn(n, |_, _| 0.5 + random()));
        let gyroscopic = DMatrix::from_fn(n, n, |i, j| if at % 3 == 1 { 2.0 * (j as f64 - i as f64) } else { 0.0 });
        let size = [0.0, 1e-15, 1e-13, 1e-11, 1e-8, 1e-2][at % 6] * springs[0].sqrt();
        let c = gyroscopic + &m * (if random() < 0.3 { -size } else { size });
        let system = SecondOrder::new(m, c, k).unwrap();
        let mut work = Workspace::default();
        let spectrum = QrSolver.eigenvalues(&system, &mut work).unwrap();
        let counted = CountedSpectrum::new(&Threshold::AXIS, &system, &spectrum, &mut work).unwrap();
        let census = stability_census(&system, &mut work).unwrap();
        if counted.open > 0 || census.is_open() {
            continue;
        }
        assert_eq!(census.growing.len() + census.divergent.len(), counted.unstable(), "{at} {census:?} {counted:?}");
        // A double zero is two real eigenvalues to one solver and a pair to another.
        let oscillates = |lambda: &&num_complex::Complex<f64>| lambda.norm() > 1e-4 * spectrum.scale;
        let of_census: Vec<_> = census.marginal.iter().map(|judged| judged.lambda).collect();
        assert_eq!(
            of_census.iter().filter(oscillates).count(),
            counted.marginal.iter().filter(oscillates).count(),
            "{at} {census:?} {counted:?}"
        );
        marginal += counted.marginal.len();
        growing += counted.unstable();
        damped += census.damped;
    }
    assert!(marginal > 300 && growing > 50 && damped > 100, "{marginal} {growing} {damped}");
}
