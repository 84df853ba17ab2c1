//! Certificates of eigenvalues: backward error, condition number, bound, verdict.

use std::collections::HashSet;

use linsys::SecondOrder;
use nalgebra::DVector;
use num_complex::Complex;

use super::blur::blur;
use super::clusters::{Cluster, ClusterKind, MOST_EXPANSIONS, enclose, enclose_alone};
use super::expansion::Alone;
use super::groups::{Group, enclose_groups, nearly_defective_pairs};
use super::measure::{Measure, ROUNDING_ONLY, State};
use super::scaled::data_noise;
use super::solve::{GeneralSpectrum, extend};
use super::vectors::Factor;
use super::verdict_by_bound::{decide, gap};
use crate::{CertifiedError, Counters, JudgedEigenvalue, Verdict};

/// Finite eigenvalue and what is known about its error.
#[derive(Debug, Clone, PartialEq)]
pub struct CertifiedEigenvalue {
    /// The eigenvalue, rad/s, improved where it could be.
    pub lambda: Complex<f64>,
    /// Backward error `|Q(lambda) phi| / ((|lambda|^2 |M| + |lambda| |C| + |K|) |phi|)`, Frobenius norms, of the matrices as given
    /// (Tisseur, Linear Algebra Appl. 309, 2000).
    pub backward_error: f64,
    /// Condition number `(|lambda|^2 |M| + |lambda| |C| + |K|) |psi| |phi| / (|lambda| |psi^H Q'(lambda) phi|)` (Tisseur): relative
    /// change of lambda per relative change of the matrices. Infinite for lambda = 0; for a semisimple multiple eigenvalue the condition
    /// number of its null space.
    pub condition: f64,
    /// Error bound, rad/s, that |lambda - exact| does not exceed, for the matrices as given and for any that differ from them by a rounding
    /// error: certified up to rounding, docs/error-bounds.md, sections 3 and 7. Infinite where nothing encloses lambda.
    pub bound: f64,
    /// Verdict: whether the motion grows.
    pub verdict: Verdict,
    /// Right eigenvector phi, length n (+ s internal states), unit 2-norm.
    pub right: DVector<Complex<f64>>,
    /// Left eigenvector psi, `psi^H Q(lambda) = 0`, of the length and norm of phi.
    pub left: DVector<Complex<f64>>,
}

/// The certificates of a spectrum, and which of its eigenvalues belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Certified {
    /// Certified eigenvalues, one for each finite eigenvalue, in the order of the spectrum.
    pub eigenvalues: Vec<CertifiedEigenvalue>,
    /// Multiple eigenvalues, defective and nearly defective groups; of conjugate groups both are listed.
    pub clusters: Vec<Cluster>,
}

/// Backward errors, condition numbers and verdicts of all finite eigenvalues of `spectrum`.
///
/// Costs one factorisation of Q(lambda) for each conjugate pair, a second one with residuals in double-double where
/// the backward error is more than rounding, |Re lambda| is within its bound, or the system has internal states, and two
/// for each group that is tried for an eigenvalue whose first-order bound does not hold.
///
/// # Errors
/// [`CertifiedError::NoEigenvector`] where `spectrum` has a number that is no eigenvalue of this system.
pub fn certify(
    system: &SecondOrder,
    spectrum: &GeneralSpectrum,
    counters: &mut Counters,
) -> Result<Certified, CertifiedError> {
    let extended = extend(system);
    let problem = Measure::new(&extended);
    let sigmas: Vec<_> = spectrum.eigenvalues.iter().map(|l| l / problem.scaled.gamma).collect();
    let conjugates = conjugates(&sigmas);
    let zeros = if spectrum.zeros > 0 { problem.zeros(&extended.k) } else { Vec::new() };
    let mut next_zero = zeros.iter().cycle();

    let mut found: Vec<State> = Vec::with_capacity(sigmas.len());
    for (i, &sigma) in sigmas.iter().enumerate() {
        let state = match (conjugates[i], sigma == Complex::default()) {
            (Some(first), _) => found[first].conjugate(),
            (None, true) => {
                next_zero.next().cloned().ok_or(CertifiedError::NoEigenvector { lambda: sigma, residual: 1.0 })?
            }
            (None, false) => look(&problem, system, &sigmas, i, counters)?,
        };
        found.push(state);
    }
    let (discs, mut groups) = enclose_groups(&problem, &mut found, &conjugates);
    groups.extend(nearly_defective_pairs(&found, &conjugates, &groups));
    for i in 0..found.len() {
        match conjugates[i] {
            Some(first) => found[i] = found[first].conjugate(),
            None => {
                let sigmas: Vec<_> = found.iter().map(|s| s.sigma).collect();
                found[i] = decide(&problem, found[i].clone(), gap(&sigmas, i), discs[i]);
            }
        }
    }
    if spectrum.zeros > 1 {
        let members = (0..sigmas.len()).filter(|&i| sigmas[i] == Complex::default()).collect();
        // As many null vectors of K as zero eigenvalues, or chains.
        let complete = zeros.len() == spectrum.zeros;
        groups.push((members, if complete { ClusterKind::Semisimple } else { ClusterKind::Defective }));
    }
    Ok(in_given_units(&problem, found, groups))
}

/// Bounds and verdicts of single eigenvalues of one system, found by whatever route.
pub struct SingleCertifier<'a> {
    system: &'a SecondOrder,
    problem: Measure,
}

impl<'a> SingleCertifier<'a> {
    /// A certifier of the eigenvalues of this system.
    #[must_use]
    pub fn new(system: &'a SecondOrder) -> Self {
        Self { system, problem: Measure::new(&extend(system)) }
    }

    /// Bound and verdict of the `i`-th of all eigenvalues; it may be improved.
    ///
    /// # Errors
    /// [`CertifiedError::NoEigenvector`] where it is no eigenvalue of this system.
    pub fn certify(
        &self,
        eigenvalues: &[Complex<f64>],
        i: usize,
        counters: &mut Counters,
    ) -> Result<JudgedEigenvalue, CertifiedError> {
        let (problem, lambda) = (&self.problem, eigenvalues[i]);
        if lambda == Complex::default() {
            let verdict = Verdict::Undecided { bound: f64::INFINITY };
            return Ok(JudgedEigenvalue { lambda, bound: f64::INFINITY, verdict });
        }
        let gamma = problem.scaled.gamma;
        let mut sigmas: Vec<_> = eigenvalues.iter().map(|l| l / gamma).collect();
        let state = look(problem, self.system, &sigmas, i, counters)?;
        sigmas[i] = state.sigma;
        // Of the others nothing is known.
        let blurs: Vec<_> = (0..sigmas.len()).map(|j| if i == j { state.blur } else { 0.0 }).collect();
        let group = || enclose(&problem.scaled, &sigmas, &blurs, i, &state, &mut HashSet::new());
        let disc = if state.is_simple { None } else { state.alone.disc().or_else(|| Some(group()?.disc)) };
        let decided = decide(problem, state, gap(&sigmas, i), disc);
        Ok(JudgedEigenvalue { lambda: decided.sigma * gamma, bound: decided.bound * gamma, verdict: decided.verdict })
    }
}

/// The vectors of eigenvalue `i` and what they say of it.
fn look(
    problem: &Measure,
    system: &SecondOrder,
    sigmas: &[Complex<f64>],
    i: usize,
    counters: &mut Counters,
) -> Result<State, CertifiedError> {
    let (state, factor) = first_look(problem, system, sigmas, i, counters)?;
    let gap = gap(sigmas, i);
    let is_simple = problem.is_simple(&state, &factor, gap);
    let blur = if is_simple { 0.0 } else { blur(&problem.scaled, &factor, &state) };
    let state = State { is_simple, blur, ..state };
    let alone = if is_simple { Alone::Open } else { enclose_alone(&factor, &state, gap) };
    let hidden =
        if alone == Alone::Crowded { hidden(&factor, data_noise(&problem.scaled, state.sigma.norm())) } else { 1 };
    Ok(State { alone, hidden, ..state })
}

/// Number of directions in which Q is as good as zero, 2 where it is not clear. Small pivots tell, but a single long chain has small pivots
/// too: vectors bear them out, as many as groups are tried one after the other.
fn hidden(factor: &Factor, noise: f64) -> usize {
    let pivots = factor.pivots_up_to(noise);
    if pivots > 2 && factor.hides(pivots.min(MOST_EXPANSIONS + 2), noise) { pivots } else { 2 }
}

fn first_look<'a>(
    problem: &'a Measure,
    system: &SecondOrder,
    sigmas: &[Complex<f64>],
    i: usize,
    counters: &mut Counters,
) -> Result<(State, Factor<'a>), CertifiedError> {
    counters.factorisations += 1;
    counters.eigenvectors += 2;
    // The norms of matrices extended by internal states hide what is wrong in their small entries.
    let threshold = if system.states() > 0 { 0.0 } else { ROUNDING_ONLY };
    problem.first_look(sigmas[i], gap(sigmas, i), threshold)
}

/// The eigenvalues of `spectrum`; an eigenvalue whose backward error is more than rounding is improved.
///
/// # Errors
/// As [`certify`].
pub fn improved(
    system: &SecondOrder,
    spectrum: &GeneralSpectrum,
    counters: &mut Counters,
) -> Result<Vec<Complex<f64>>, CertifiedError> {
    let problem = Measure::new(&extend(system));
    let gamma = problem.scaled.gamma;
    let sigmas: Vec<_> = spectrum.eigenvalues.iter().map(|l| l / gamma).collect();
    let conjugates = conjugates(&sigmas);
    let mut better = Vec::with_capacity(sigmas.len());
    for (i, &sigma) in sigmas.iter().enumerate() {
        better.push(match conjugates[i] {
            Some(first) => Complex::conj(&better[first]),
            None if sigma == Complex::default() => sigma,
            None => first_look(&problem, system, &sigmas, i, counters)?.0.sigma,
        });
    }
    Ok(better.into_iter().map(|sigma| sigma * gamma).collect())
}

/// Conjugates: for each eigenvalue the index of the earlier one that it is the conjugate of, if any.
fn conjugates(sigmas: &[Complex<f64>]) -> Vec<Option<usize>> {
    let mut taken = vec![false; sigmas.len()];
    let mut partners = vec![None; sigmas.len()];
    for (i, s) in sigmas.iter().enumerate() {
        // In the order of `sort` a conjugate stands among the eigenvalues of equal |Im|.
        let earlier = (0..i).rev().take_while(|&j| sigmas[j].im.abs() == s.im.abs());
        let partner = earlier.filter(|&j| s.im != 0.0 && sigmas[j] == s.conj() && !taken[j]).last();
        if let Some(j) = partner {
            (taken[i], taken[j], partners[i]) = (true, true, Some(j));
        }
    }
    partners
}

fn in_given_units(problem: &Measure, found: Vec<State>, groups: Vec<Group>) -> Certified {
    let s = &problem.scaled;
    let (right, left) = problem.weights();
    let unit = |v: DVector<Complex<f64>>| {
        let norm = v.norm();
        v.unscale(norm)
    };
    let certificate = |state: State| CertifiedEigenvalue {
        lambda: state.sigma * s.gamma,
        backward_error: state.backward_error,
        condition: state.condition,
        bound: state.bound * s.gamma,
        verdict: state.verdict,
        right: unit(state.x.component_mul(right)),
        left: unit(state.y.component_mul(left)),
    };
    let eigenvalues: Vec<_> = found.into_iter().map(certificate).collect();
    let lambdas: Vec<_> = eigenvalues.iter().map(|e| e.lambda).collect();
    let clusters = groups.into_iter().map(|(members, kind)| Cluster::of(members, &lambdas, kind)).collect();
    Certified { eigenvalues, clusters }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve;
    use nalgebra::{DMatrix, dmatrix};
    use proptest::prelude::*;

    fn certified(m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> Certified {
        let system = SecondOrder::new(m, c, k).unwrap();
        let mut counters = Counters::default();
        let spectrum = solve(&system, &mut counters).unwrap();
        certify(&system, &spectrum, &mut counters).unwrap()
    }

    fn all_marginal(c: &Certified) -> bool {
        c.eigenvalues.iter().all(|e| matches!(e.verdict, Verdict::Marginal { .. }))
    }

    #[test]
    fn condition_and_verdict_of_an_oscillator_by_hand() {
        // Q' = 2 lambda m + c; at lambda = -1 +- 7i with m = 1, c = 2, k = 50: |Q'| = 14.
        let found = certified(dmatrix![1.0], dmatrix![2.0], dmatrix![50.0]);
        for e in &found.eigenvalues {
            let l = e.lambda.norm();
            assert!((e.condition - (l * l + 2.0 * l + 50.0) / (l * 14.0)).abs() < 1e-12);
            assert!(e.verdict == Verdict::Stable && e.backward_error < 1e-15 && e.bound < 1e-14);
        }
    }

    #[test]
    fn weak_damping_is_told_from_none() {
        let chain = dmatrix![3.0, -1.0, 0.0; -1.0, 3.0, -1.0; 0.0, -1.0, 2.0];
        let none = certified(DMatrix::identity(3, 3), DMatrix::zeros(3, 3), chain.clone());
        assert!(all_marginal(&none));
        let weak = certified(DMatrix::identity(3, 3), &chain * 1e-13, chain.clone());
        assert!(weak.eigenvalues.iter().all(|e| e.verdict == Verdict::Stable));
        let negative = certified(DMatrix::identity(3, 3), &chain * -1e-13, chain);
        assert!(negative.eigenvalues.iter().all(|e| e.verdict == Verdict::Unstable));
    }

    #[test]
    fn a_gyroscope_and_a_doublet_are_neutral_and_semisimple() {
        let spin = dmatrix![0.0, 0.3; -0.3, 0.0];
        assert!(all_marginal(&certified(DMatrix::identity(2, 2), spin, dmatrix![2.0, 0.1; 0.1, 3.0])));
        // A square: the two middle modes of a ring of four equal masses coincide.
        let ring = dmatrix![2.7, -1.0, 0.0, -1.0; -1.0, 2.7, -1.0, 0.0; 0.0, -1.0, 2.7, -1.0; -1.0, 0.0, -1.0, 2.7];
        let found = certified(DMatrix::identity(4, 4), DMatrix::zeros(4, 4), ring);
        assert!(all_marginal(&found));
        assert_eq!(found.clusters.len(), 2);
        for cluster in &found.clusters {
            assert_eq!((cluster.members.len(), cluster.kind), (2, ClusterKind::Semisimple));
            assert!((cluster.mean.im.abs() - 2.7_f64.sqrt()).abs() < 1e-15 && cluster.spread < 1e-15);
        }
        assert!(found.eigenvalues.iter().all(|e| e.condition < 10.0 && e.backward_error < 1e-15));
    }

    #[test]
    fn the_onset_of_flutter_is_a_defective_pair_and_neither_stable_nor_unstable() {
        // K = [1 1; 0 1] has one vector: lambda = +-i twice, and a perturbation e moves it by sqrt(e) / 2.
        let found = certified(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![1.0, 1.0; 0.0, 1.0]);
        assert!(found.clusters.iter().all(|c| c.kind == ClusterKind::Defective && (c.mean.norm() - 1.0).abs() < 1e-14));
        assert!(all_marginal(&found));
        // Beyond it, at 1e-10, the pair is told apart and one of it grows at 5e-6.
        let found = certified(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![1.0, 1.0; -1e-10, 1.0]);
        assert!(found.clusters.iter().all(|c| c.kind == ClusterKind::NearlyDefective && c.spread < 1e-5));
        let rates: Vec<f64> =
            found.eigenvalues.iter().filter(|e| e.verdict == Verdict::Unstable).map(|e| e.lambda.re).collect();
        assert_eq!(rates.len(), 2);
        assert!(rates.iter().all(|re| (re - 5e-6).abs() < 1e-11));
    }

    #[test]
    fn rigid_bodies_are_marginal_exactly_or_to_rounding() {
        let exact = dmatrix![1.0, -1.0; -1.0, 1.0];
        let found = certified(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), exact);
        assert!(all_marginal(&found));
        let zeros = found.clusters.iter().find(|c| c.mean.norm() == 0.0).unwrap();
        assert_eq!((zeros.members.len(), zeros.kind), (2, ClusterKind::Defective));
        // Rounded, K has the eigenvalue -1e-16: divergence at a rate of 1e-8 that means nothing.
        let rounded = dmatrix![1.0, -1.0 - f64::EPSILON; -1.0, 1.0];
        let found = certified(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), rounded);
        assert!(all_marginal(&found) && found.eigenvalues.iter().any(|e| e.lambda.re > 1e-9));
    }

    #[test]
    fn a_rigid_body_but_for_rounding_is_within_its_bound() {
        // K = [1, -1 + d; -1 + d, 1] has the eigenvalues d and 2 - d: +-i sqrt(d) for a positive d.
        for d in [1.0, 3.0, 7.0, 100.0].map(|steps| steps * f64::EPSILON / 2.0) {
            let found =
                certified(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![1.0, -1.0 + d; -1.0 + d, 1.0]);
            let tiny: Vec<_> = found.eigenvalues.iter().filter(|e| e.lambda.norm() < 1e-3).collect();
            assert_eq!(tiny.len(), 2);
            for e in tiny {
                let exact = Complex::new(0.0, d.sqrt().copysign(e.lambda.im));
                assert!((e.lambda - exact).norm() <= e.bound && e.condition > 1e13, "{d:e}: {e:?}");
                assert!(matches!(e.verdict, Verdict::Marginal { .. }));
            }
        }
    }

    #[test]
    fn members_of_a_wide_group_keep_their_own_digits() {
        // Three slow eigenvalues, 1e-3 apart and known to less in the scaled problem: -k / c in a basis that mixes them.
        let axis = DVector::from_vec(vec![0.6, 0.48, 0.64]);
        let turn = DMatrix::identity(3, 3) - &axis * axis.transpose() * 2.0;
        let slow = [1.0, 1.001, 1.002];
        let k = &turn * DMatrix::from_diagonal(&DVector::from_vec(slow.to_vec())) * &turn;
        let c = 1e13;
        let found = certified(DMatrix::identity(3, 3), DMatrix::identity(3, 3) * c, k);
        for k in slow {
            // k / c to 26 digits, as c^2 is that much larger than k.
            let nearest = found.eigenvalues.iter().map(|e| (e.lambda + k / c).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-14 * k / c, "{k}: {nearest:e}");
        }
        assert!(found.eigenvalues.iter().all(|e| e.backward_error < 1e-14 && e.verdict != Verdict::Unstable));
    }

    #[test]
    fn vectors_satisfy_the_equation_in_the_given_units() {
        let (m, c, k) = (dmatrix![1e-9, 0.0; 0.0, 1e3], dmatrix![0.0, 2e-4; 1e-4, 3.0], dmatrix![5.0, 4.0; -4.0, 6e5]);
        let system = SecondOrder::new(m.clone(), c.clone(), k.clone()).unwrap();
        for e in certified(m, c, k).eigenvalues {
            let (q, l) = (system.dynamic_stiffness(e.lambda), e.lambda.norm());
            let size = l * l * system.m.norm() + l * system.c.norm() + system.k.norm();
            assert!((&q * &e.right).norm() < 1e-15 * size);
            assert!((e.left.adjoint() * &q).norm() < 1e-15 * size);
        }
    }

    /// Entries that break things: zeros, equal ones, and many orders of magnitude.
    fn entry() -> impl Strategy<Value = f64> {
        prop_oneof![4 => Just(0.0), 3 => Just(1.0), 1 => Just(-1.0), 1 => Just(0.1), 2 => -2.0..2.0f64,
            1 => prop_oneof![Just(1e12), Just(1e-12), Just(-1e6), Just(1e-30)]]
    }

    fn matrices() -> impl Strategy<Value = (DMatrix<f64>, DMatrix<f64>, DMatrix<f64>)> {
        let square = |n: usize| prop::collection::vec(entry(), n * n).prop_map(move |v| DMatrix::from_vec(n, n, v));
        (1..5usize).prop_flat_map(move |n| (square(n), square(n), square(n)))
    }

    /// Stiffness of bodies that are free, exactly or but for rounding.
    fn free_bodies() -> impl Strategy<Value = DMatrix<f64>> {
        let body = prop_oneof![
            prop_oneof![Just(0.0), Just(1e-18), Just(1e-17), Just(1.0)].prop_map(|k| dmatrix![k]),
            (prop_oneof![Just(0.0), Just(0.5), Just(-1.0)], prop_oneof![Just(1.0), Just(3.0)]).prop_map(
                |(steps, k)| {
                    let coupling = k * (steps * f64::EPSILON - 1.0);
                    dmatrix![k, coupling; coupling, k]
                }
            ),
        ];
        prop::collection::vec(body, 1..5).prop_map(|bodies| {
            let n = bodies.iter().map(DMatrix::nrows).sum();
            let (mut k, mut at) = (DMatrix::zeros(n, n), 0);
            for body in bodies {
                k.view_mut((at, at), body.shape()).copy_from(&body);
                at += body.nrows();
            }
            k
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]

        /// Groups of eigenvalues next to zero leave zeros of an exact count as they are.
        #[test]
        fn exact_zeros_stay_zero_beside_others_that_are_nearly(
            k in free_bodies(), damping in prop_oneof![Just(0.1), Just(1.0), Just(50.0)],
        ) {
            let n = k.nrows();
            let system = SecondOrder::new(DMatrix::identity(n, n), DMatrix::identity(n, n) * damping, k).unwrap();
            let mut counters = Counters::default();
            let spectrum = solve(&system, &mut counters).unwrap();
            let found = certify(&system, &spectrum, &mut counters).unwrap();
            let is_exact = |e: &&CertifiedEigenvalue| e.lambda == Complex::default() && e.bound == 0.0;
            let zeros: Vec<_> = found.eigenvalues.iter().filter(is_exact).collect();
            prop_assert_eq!(zeros.len(), spectrum.zeros);
            prop_assert!(zeros.iter().all(|e| e.verdict == Verdict::Marginal { tolerance: 0.0 }), "{:?}", zeros);
            prop_assert!(found.clusters.iter().all(|c| c.members.len() > 1 && c.mean.re.is_finite()), "{:?}", found.clusters);
        }

        #[test]
        fn whatever_the_matrices_all_eigenvalues_are_accounted_for((m, c, k) in matrices()) {
            let system = SecondOrder::new(m, c, k).unwrap();
            let mut counters = Counters::default();
            match solve(&system, &mut counters) {
                Err(error) => {
                    let honest = match error {
                        CertifiedError::SingularPencil { .. } | CertifiedError::NoConvergence { .. } => true,
                        // More orders of magnitude than double-double arithmetic has digits.
                        CertifiedError::Range { smallest, largest } => smallest < 1e-30 * largest,
                        _ => false,
                    };
                    prop_assert!(honest, "{}", error);
                }
                Ok(spectrum) => {
                    prop_assert_eq!(spectrum.eigenvalues.len() + spectrum.infinite, 2 * system.order());
                    prop_assert!(spectrum.eigenvalues.iter().all(|l| l.re.is_finite() && l.im.is_finite()));
                    let certified = certify(&system, &spectrum, &mut counters).unwrap();
                    let upper = certified.eigenvalues.iter().filter(|e| e.lambda.im > 0.0).count();
                    let lower = certified.eigenvalues.iter().filter(|e| e.lambda.im < 0.0).count();
                    prop_assert_eq!(upper, lower);
                }
            }
        }
    }
}
