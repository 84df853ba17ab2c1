//! Bounds and verdicts against problems whose eigenvalues are known exactly.
//!
//! `cargo test --release -p cea --test exact -- --include-ignored --nocapture` prints how many of each kind were tried and
//! what came out.

#![allow(clippy::unwrap_used, clippy::panic)]

mod problems;

use cea::{BatchSolver, CeaError, EigenSolver, Verdict, Workspace, certified, stability_census, verdict};
use linsys::SecondOrder;
use nalgebra::{DMatrix, dmatrix};
use num_complex::Complex;

use problems::{Blocks, Count, Numbers, Problem, frank, reflected, unimodular};

/// Nothing where the iteration does not converge: an error, and no verdict.
fn certify(system: &SecondOrder) -> Option<Vec<(Complex<f64>, f64, Verdict)>> {
    let mut work = Workspace::default();
    let spectrum = match certified::solve(system, &mut work) {
        Err(CeaError::NoConvergence { .. }) => return None,
        solved => solved.unwrap(),
    };
    let certified = certified::certify(system, &spectrum, &mut work).unwrap();
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

/// Chains beside the axis, Re lambda = -2^-19 and Im lambda = 2, as a study judges them: the eigenvalues of the batch solver, each
/// with its verdict, and the census.
fn check_the_study(m: usize, of: usize) {
    let problems: Vec<_> = rounded_chain_problems(m, of, Some(2_f64.powi(-18))).collect();
    let systems: Vec<_> = problems.iter().map(|p| p.system.clone()).collect();
    let (mut work, mut spectra) = (Workspace::default(), Vec::new());
    BatchSolver.eigenvalues_of_all(&systems, &mut work, &mut spectra);
    let (mut damped, mut open, mut by_sign) = (0, 0, 0);
    for (system, spectrum) in systems.iter().zip(spectra) {
        let spectrum = spectrum.unwrap();
        for lambda in spectrum.oscillatory() {
            by_sign += usize::from(lambda.re > 1e-6 * spectrum.scale);
            match verdict(system, lambda, &spectrum, &mut work).unwrap() {
                Verdict::Stable => damped += 1,
                Verdict::Unstable => panic!("{lambda} is called unstable, index {m}"),
                Verdict::Marginal { .. } | Verdict::Undecided { .. } => open += 1,
            }
        }
        let census = stability_census(system, &mut work).unwrap();
        assert!(!census.is_unstable(), "{census:?}, index {m}");
    }
    println!("index {m}: {damped} damped, {open} open; a bare sign beyond 1e-6 would call {by_sign} unstable");
}

#[test]
fn what_a_study_says_of_eigenvalues_that_meet_is_never_unstable() {
    for m in 2..=4 {
        check_the_study(m, 200);
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
