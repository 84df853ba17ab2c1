//! Numbers, vectors and names as both routes write them.

use brakes::case::held::Held;
use cea::{Verdict, damping_ratio, frequency_hz};
use formats::Dof;
use nalgebra::DVector;
use num_complex::Complex;

use super::matrices::TakenFile;

/// 17 significant digits; null where there is no finite number.
pub(super) fn number(x: f64) -> String {
    if x.is_finite() { format!("{x:.16e}") } else { "null".to_owned() }
}

pub(super) fn list<T>(items: impl IntoIterator<Item = T>, item: impl Fn(T) -> String) -> String {
    items.into_iter().map(item).collect::<Vec<_>>().join(", ")
}

/// The members of a finite eigenvalue in JSON, as far as both routes have them, without braces.
pub(super) fn finite_json(l: Complex<f64>, [backward_error, condition, bound]: [f64; 3], verdict: Verdict) -> String {
    format!(
        "\"kind\": \"finite\", \"re\": {}, \"im\": {}, \"frequency_hz\": {}, \"damping_ratio\": {}, \
         \"backward_error\": {}, \"condition\": {}, \"bound\": {}, \"verdict\": \"{verdict}\"",
        number(l.re),
        number(l.im),
        number(frequency_hz(l)),
        number(damping_ratio(l)),
        number(backward_error),
        number(condition),
        number(bound)
    )
}

/// Right and left eigenvector as members of JSON, to follow other members.
pub(super) fn vectors_json(right: &DVector<Complex<f64>>, left: &DVector<Complex<f64>>) -> String {
    format!(", \"right\": [{}], \"left\": [{}]", vector_json(right), vector_json(left))
}

fn vector_json(v: &DVector<Complex<f64>>) -> String {
    list(v.iter(), |z| format!("[{}, {}]", number(z.re), number(z.im)))
}

/// A line of a table with both vectors.
pub(super) fn vector_rows(right: &DVector<Complex<f64>>, left: &DVector<Complex<f64>>) -> String {
    let row = |v: &DVector<Complex<f64>>| list(v.iter(), |z| format!("{:.16e}{:+.16e}i", z.re, z.im));
    format!("      right: {}\n      left:  {}\n", row(right), row(left))
}

/// The names of the entries of a vector, as a key of JSON.
pub(super) fn rows_json(labels: Option<&[Dof]>) -> String {
    labels.map_or_else(String::new, |labels| format!("  \"rows\": [{}],\n", list(labels, |dof| format!("\"{dof}\""))))
}

/// The heading of the table of eigenvalues.
pub(super) fn heading() -> String {
    format!(
        "{:>5} {:>24} {:>24} {:>14} {:>12} {:>9} {:>9}  {}\n",
        "no.", "Re lambda, rad/s", "Im lambda, rad/s", "f, Hz", "damping", "backward", "condition", "verdict"
    )
}

/// The line of an eigenvalue in that table, with its number, backward error, condition number and what is said of it.
pub(super) fn row(number: usize, l: Complex<f64>, backward_error: f64, condition: f64, verdict: &str) -> String {
    format!(
        "{number:>5} {:>24.16e} {:>24.16e} {:>14.6} {:>12.4e} {backward_error:>9.1e} {condition:>9.1e}  {verdict}\n",
        l.re,
        l.im,
        frequency_hz(l),
        damping_ratio(l)
    )
}

/// Lines below a table: how each file was taken, and which degrees of freedom were taken out.
pub(super) fn taken(files: &[TakenFile], held: &[String]) -> String {
    let line = |file: &TakenFile| {
        let TakenFile { kind, path, name, taken } = file;
        format!("{kind}: matrix \"{name}\" of {}, {taken}\n", path.display())
    };
    let held = if held.is_empty() { String::new() } else { format!("{}\n", Held(held)) };
    files.iter().map(line).collect::<String>() + &held
}

/// Keys of JSON: how each file was taken, and which degrees of freedom were taken out.
pub(super) fn taken_json(files: &[TakenFile], held: &[String]) -> String {
    let text = |text: &str| serde_json::Value::from(text).to_string();
    let files = list(files, |TakenFile { kind, path, name, taken }| {
        let path = text(&path.display().to_string());
        format!("\n    {{\"matrix\": \"{kind}\", \"file\": {path}, \"name\": {}, \"taken\": \"{taken}\"}}", text(name))
    });
    format!("  \"files\": [{files}\n  ],\n  \"held\": [{}],\n", list(held, |name| text(name)))
}
