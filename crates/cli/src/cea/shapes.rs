//! Shapes and work of modes, and eigenvalues, as JSON.

use num_complex::Complex;
use serde_json::{Value, json};
use work::ModeWork;

/// The shape of a mode over all degrees of freedom, and its work.
pub(super) type ShapeAndWork = (Vec<Complex<f64>>, ModeWork);

pub(super) fn pairs_of_numbers(lambdas: &[Complex<f64>]) -> Vec<[f64; 2]> {
    lambdas.iter().map(|lambda| [lambda.re, lambda.im]).collect()
}

/// Adds shape and work to a mode.
pub(super) fn add_shape(mode: &mut Value, shape: &[Complex<f64>], energy: &ModeWork) {
    mode["shape"] = shape.iter().map(|u| json!([u.re, u.im])).collect();
    for family in &energy.families {
        mode[format!("{}_work", family.name)] = json!(family.bodies);
    }
    mode["net_work"] = json!(energy.net());
}
