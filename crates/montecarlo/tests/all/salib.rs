//! The indices of a design against SALib's, and those by ranks against the same formula in NumPy, on the same numbers.
//!
//! Skipped, with a line that says so, where Python has no SALib: `pip install SALib`.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use std::io::Write as _;
use std::process::{Command, Stdio};

use montecarlo::rand::RngExt;
use montecarlo::{PickFreeze, first_order_by_ranks, stream};

/// Reads x, A, B and A with an input of B, a line each, and prints S by ranks, S and T of the design.
const SCRIPT: &str = "
import sys
import numpy as np
from SALib.analyze import sobol
x, a, b, mixed = (np.array(line.split(), float) for line in sys.stdin)
y = a[np.argsort(x, kind='stable')]
ranks = (np.mean(y * np.roll(y, -1)) - y.mean() ** 2) / y.var()
mean = np.r_[a, b].mean()
a, b, mixed = a - mean, b - mean, mixed - mean
print(repr(float(ranks)), float(sobol.first_order(a, mixed, b)), float(sobol.total_order(a, mixed, b)))
";

#[test]
fn salib_and_numpy_say_the_same() {
    let has_salib = Command::new("python3").args(["-c", "import SALib, numpy"]).output();
    if !has_salib.is_ok_and(|output| output.status.success()) {
        println!("skipped: python3 with SALib and NumPy is not here");
        return;
    }
    let mut rng = stream(3, 0);
    let rows: Vec<[f64; 6]> = (0..500).map(|_| std::array::from_fn(|_| rng.random())).collect();
    let f = |u: f64, v: f64, w: f64| (6.0 * u).sin() + 3.0 * v * v + u * w + 10.0;
    let x: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    let a: Vec<f64> = rows.iter().map(|row| f(row[0], row[1], row[2])).collect();
    let b: Vec<f64> = rows.iter().map(|row| f(row[3], row[4], row[5])).collect();
    let mixed: Vec<f64> = rows.iter().map(|row| f(row[3], row[1], row[2])).collect();
    let design = PickFreeze { a: &a, b: &b, mixed: &mixed };
    let ours = [first_order_by_ranks(&x, &a).unwrap(), design.first_order().unwrap(), design.total().unwrap()];

    let line = |values: &[f64]| values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(" ");
    let numbers = [&x, &a, &b, &mixed].map(|values| line(values)).join("\n") + "\n";
    let mut python = Command::new("python3");
    let mut python = python.args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    python.stdin.take().unwrap().write_all(numbers.as_bytes()).unwrap();
    let output = python.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let theirs: Vec<f64> = text.split_whitespace().map(|word| word.parse().unwrap()).collect();
    println!("ours {ours:?}, theirs {theirs:?}");
    assert_eq!(theirs.len(), 3, "{text}");
    for (ours, theirs) in ours.iter().zip(theirs) {
        assert!((ours.value - theirs).abs() < 1e-11, "{ours:?} {theirs}");
    }
}
