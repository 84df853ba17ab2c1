//! Bounds and verdicts against problems whose eigenvalues are known exactly.
//!
//! `cargo test --release -p brake-squeal-cea --test all exact:: -- --include-ignored --nocapture` prints how many of each kind were tried and
//! what came out.

#![allow(clippy::unwrap_used, clippy::panic)]

mod problems;

use cea::{BatchSolver, CertifiedError, EigenSolver, Verdict, Workspace, certified, stability_census, verdict};
use linsys::SecondOrder;
use nalgebra::{DMatrix, dmatrix};
use num_complex::Complex;

use problems::{Blocks, Count, Numbers, Problem, chain_taken_apart, chain_with_states, frank, reflected, unimodular};

/// Nothing where the iteration does not converge: an error, and no verdict.
fn certify(system: &SecondOrder) -> Option<Vec<(Complex<f64>, f64, Verdict)>> {
    let mut counters = certified::Counters::default();
    let spectrum = match certified::solve(system, &mut counters) {
        Err(CertifiedError::NoConvergence { .. }) => return None,
        solved => solved.unwrap(),
    };
    let certified = certified::certify(system, &spectrum, &mut counters).unwrap();
    Some(certified.eigenvalues.iter().map(|e| (e.lambda, e.bound, e.verdict)).collect())
}

fn judge(problems: impl Iterator<Item = Problem>) -> Count {
    let mut count = Count::default();
    for problem in problems {
        match certify(&problem.system) {
            Some(found) => count.enter(&problem.eigenvalues, &found),
            None => count.refused += 1,
        }
    }
    count
}

/// Blocks of length one: `n` different eigenvalues, or as many equal ones as a draw says.
fn without_chains(n: usize, multiple: bool, numbers: &mut Numbers) -> Blocks {
    let mut blocks = Blocks::new();
    while blocks.len() < n {
        let eigenvalue = numbers.integer(-3, 40);
        let times = if multiple { numbers.integer(1, 4) as usize } else { 1 };
        if eigenvalue != 0 && blocks.iter().all(|b| b.0 != eigenvalue) {
            blocks.extend([(eigenvalue, 1)].repeat(times.min(n - blocks.len())));
        }
    }
    blocks
}

/// A chain of length `m`, with other eigenvalues, and now and then a second chain of the same one, up to order 14.
fn with_chain(m: usize, numbers: &mut Numbers) -> Blocks {
    let rest = numbers.integer(0, (14 - m as i128).min(5)) as usize;
    let eigenvalue = numbers.integer(1, 9);
    let mut blocks = without_chains(rest, false, numbers);
    blocks.retain(|b| b.0 != eigenvalue);
    blocks.push((eigenvalue, m));
    if numbers.integer(0, 3) == 0 {
        let second = numbers.integer(1, 3).min(14 - blocks.iter().map(|b| b.1 as i128).sum::<i128>());
        if second > 0 {
            blocks.push((eigenvalue, second as usize));
        }
    }
    blocks
}

/// A power of two from 2^-24 to 2.
fn damping(numbers: &mut Numbers) -> f64 {
    2_f64.powi(numbers.integer(-24, 1) as i32)
}

/// How many elementary matrices a similarity is made of, in units of the order: entries of a few digits, or of up to sixteen.
const MILD: i128 = 4;
const HARSH: i128 = 12;

fn without_chain_problems(of: usize, multiple: bool, most_steps: i128) -> impl Iterator<Item = Problem> {
    let mut numbers = Numbers(if multiple { 1 } else { 2 });
    (0..of).filter_map(move |_| {
        let n = numbers.integer(2, 14) as usize;
        let blocks = without_chains(n, multiple, &mut numbers);
        let c = damping(&mut numbers);
        let steps = numbers.integer(n as i128, most_steps * n as i128) as usize;
        unimodular(&blocks, c, steps, &mut numbers)
    })
}

fn chain_problems(m: usize, of: usize, most_steps: i128) -> impl Iterator<Item = Problem> {
    let mut numbers = Numbers(100 + m as u64);
    (0..of).filter_map(move |_| {
        let blocks = with_chain(m, &mut numbers);
        let n: usize = blocks.iter().map(|b| b.1).sum();
        let c = damping(&mut numbers);
        let steps = numbers.integer(n as i128, most_steps * n as i128) as usize;
        unimodular(&blocks, c, steps, &mut numbers)
    })
}

fn rounded_chain_problems(m: usize, of: usize, c: Option<f64>) -> impl Iterator<Item = Problem> {
    let mut numbers = Numbers(200 + m as u64);
    (0..of).map(move |_| {
        let c = c.unwrap_or_else(|| damping(&mut numbers));
        reflected(&vec![(4, m)], c, &mut numbers)
    })
}

fn check(name: &str, count: Count) -> Count {
    println!("| {name} | {count} |");
    assert_eq!((count.wrong, count.beyond), (0, 0), "{name}: {count:?}");
    assert!(count.refused * 100 <= count.problems, "{name}: {count:?}");
    count
}

/// All kinds, `of` draws each, with floors for what must be decided or bounded where the similarity is mild.
fn check_all(of: usize) {
    println!(
        "| problems | solved | refused | eigenvalues | decided | without a bound | wrong | beyond | error / bound |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    for multiple in [false, true] {
        let name = if multiple { "multiple, semisimple" } else { "distinct" };
        let mild = check(name, judge(without_chain_problems(of, multiple, MILD)));
        assert!(mild.decided * 100 >= mild.eigenvalues * 99, "{name}: {mild:?}");
        check(&format!("{name}, harsh"), judge(without_chain_problems(of, multiple, HARSH)));
    }
    for m in 2..=8 {
        let mild = check(&format!("chain of {m}"), judge(chain_problems(m, of, MILD)));
        assert!(m > 3 || mild.unbounded * 10 <= mild.eigenvalues, "chain of {m}: {mild:?}");
        check(&format!("chain of {m}, harsh"), judge(chain_problems(m, of, HARSH)));
        let rounded = check(&format!("rounded chain of {m}"), judge(rounded_chain_problems(m, of, None)));
        assert!(rounded.unbounded * 100 <= rounded.eigenvalues, "rounded chain of {m}: {rounded:?}");
    }
}

#[test]
fn no_sign_is_wrong_and_no_bound_exceeded() {
    check_all(20);
}

#[test]
#[ignore = "twenty-five thousand problems"]
fn no_sign_is_wrong_and_no_bound_exceeded_in_thousands() {
    check_all(1_000);
}

/// Re lambda = -2^-19 for each eigenvalue of a chain.
const BESIDE_THE_AXIS: f64 = 1.0 / 262_144.0;

/// Chains beside the axis, Im lambda = 2, as a study judges them: the eigenvalues of the batch solver, each with its verdict, and
/// the census.
fn check_the_study(name: &str, problems: Vec<Problem>) {
    let systems: Vec<_> = problems.into_iter().map(|p| p.system).collect();
    let (mut work, mut spectra) = (Workspace::default(), Vec::new());
    BatchSolver.eigenvalues_of_all(&systems, &mut work, &mut spectra);
    let (mut damped, mut open, mut by_sign) = (0, 0, 0);
    for (system, spectrum) in systems.iter().zip(spectra) {
        let spectrum = spectrum.unwrap();
        for lambda in spectrum.oscillatory().filter(|lambda| lambda.im > lambda.re.abs()) {
            by_sign += usize::from(lambda.re > 1e-6 * spectrum.scale);
            match verdict(system, lambda, &spectrum, &mut work).unwrap() {
                Verdict::Stable => damped += 1,
                Verdict::Unstable => panic!("{lambda} is called unstable, {name}"),
                Verdict::Marginal { .. } | Verdict::Undecided { .. } => open += 1,
            }
        }
        let census = stability_census(system, &mut work).unwrap();
        assert!(!census.is_unstable(), "{census:?}, {name}");
    }
    println!("{name}: {damped} damped, {open} open; a bare sign beyond 1e-6 would call {by_sign} unstable");
}

#[test]
fn what_a_study_says_of_eigenvalues_that_meet_is_never_unstable() {
    for m in 2..=4 {
        check_the_study(&format!("index {m}"), rounded_chain_problems(m, 200, Some(BESIDE_THE_AXIS)).collect());
    }
}

#[test]
fn nor_is_it_with_internal_states_however_fast() {
    for m in 2..=4 {
        for decay in [3.0, 10.0, 100.0, 1e3, 1e5] {
            let mut numbers = Numbers(300 + m as u64);
            let problem = |i: usize| {
                let dashpot = [0.1, 1.0, 10.0][i % 3];
                chain_with_states(m, BESIDE_THE_AXIS, &[decay, 1.5 * decay], dashpot, &mut numbers)
            };
            check_the_study(&format!("index {m}, states {decay} times"), (0..60).map(problem).collect());
        }
    }
}

/// Chains taken apart by a little, so that eigenvalues grow or not by a little, beside fast states: no decided sign is wrong, and
/// nearly all are decided by the sign alone where they are farther apart.
#[test]
fn signs_beside_fast_states_are_right() {
    let mut numbers = Numbers(400);
    for m in 2..=4 {
        for exponent in 2..=13 {
            let (perturbation, mut work) = (10_f64.powi(-exponent), Workspace::default());
            let (mut decided, mut all) = (0, 0);
            for i in 0..24 {
                let decays = [[10.0, 30.0], [90.0, 40.0], [1e3, 2e3], [1e5, 1e4]][i % 4];
                let c = 2_f64.powi(numbers.integer(-24, -2) as i32);
                let Problem { system, eigenvalues } = chain_taken_apart(m, perturbation, c, &decays, &mut numbers);
                // What rounding K does to an eigenvalue, of first order; where that is all its distance from the others, no sign is known.
                let rounding = 1e-14 / perturbation.powf((m as f64 - 1.0) / m as f64);
                let spectrum = BatchSolver.eigenvalues(&system, &mut work).unwrap();
                for lambda in spectrum.oscillatory().filter(|lambda| lambda.im > lambda.re.abs()) {
                    let nearest =
                        |a: &&Complex<f64>, b: &&Complex<f64>| (*a - lambda).norm().total_cmp(&(*b - lambda).norm());
                    let exact = eigenvalues.iter().min_by(nearest).unwrap();
                    let found = verdict(&system, lambda, &spectrum, &mut work).unwrap();
                    let (stable, unstable) = (found == Verdict::Stable, found == Verdict::Unstable);
                    let is_known = exact.re.abs() > rounding.min(perturbation.powf(1.0 / m as f64));
                    let is_wrong = is_known && (stable && exact.re > 0.0 || unstable && exact.re < 0.0);
                    assert!(!is_wrong, "{m}, {perturbation:e}, {c:e}, {decays:?}: {lambda} for {exact}, {found:?}");
                    (decided, all) = (decided + usize::from(stable || unstable), all + 1);
                }
            }
            println!(
                "{m} apart by {perturbation:e}^(1/{m}): {decided} of {all} decided, {} bounds",
                work.counters.factorisations
            );
        }
    }
}

/// K has the double eigenvalue 4 with one vector, in integers; Re lambda = -2^-21, and the pair comes out 3e-6 apart.
#[test]
fn a_defective_pair_of_integers_does_not_pass_as_semisimple() {
    let k = dmatrix![-7792.0, 4372.0, 2040.0; -2614.0, 1470.0, 684.0; -24221.0, 13583.0, 6342.0];
    let c = DMatrix::identity(3, 3) * 2_f64.powi(-20);
    let found = certify(&SecondOrder::new(DMatrix::identity(3, 3), c, k).unwrap()).unwrap();
    let exact = Complex::new(-(2_f64.powi(-21)), 2.0);
    let pair: Vec<_> = found.iter().filter(|(lambda, ..)| (lambda - exact).norm() < 1e-4).collect();
    assert_eq!(pair.len(), 2);
    for (lambda, bound, verdict) in pair {
        assert!((lambda - exact).norm() <= *bound && *bound < 1e-4, "{lambda}: {bound:e}");
        assert!(matches!(verdict, Verdict::Marginal { .. } | Verdict::Undecided { .. }), "{verdict}");
    }
}

#[test]
fn an_eigenvalue_without_digits_is_never_called_unstable() {
    for n in 12..=24 {
        let found = certify(&frank(n, 0.5)).unwrap();
        let decided = found.iter().filter(|f| f.2 == Verdict::Stable).count();
        println!("Frank {n}: {decided} of {} stable", found.len());
        assert!(found.iter().all(|f| f.2 != Verdict::Unstable), "order {n}");
    }
}
