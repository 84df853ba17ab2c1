//! Loss factors that feed vibration: loss factors of terms whose coefficient is below zero.

use std::iter;

use crate::check::{Check, field};
use crate::expression::Expression;
use crate::parameter::{Parameter, elsewhere};

/// Notes each of `lossy`, names and coefficients of terms with a loss factor, whose coefficient is below zero at the medians of the parameters, or where one of them
/// is at its 5 or 95 % quantile: `K_t (1 + i eta)` then takes damping from the brake. A place at which an expression has no value is passed over.
pub(crate) fn note_feeding<'a>(
    check: &Check<'_>,
    parameters: &[&Parameter],
    lossy: impl Iterator<Item = (&'a str, &'a Expression)>,
) {
    let medians = parameters.iter().map(|parameter| parameter.distribution.median()).collect();
    let places: Vec<(String, Vec<f64>)> =
        iter::once(("the medians".to_owned(), medians)).chain(elsewhere(parameters)).collect();
    for (name, coefficient) in lossy {
        let below_zero = |(place, values): &(String, Vec<f64>)| {
            let value = coefficient.value(values).ok().filter(|value| *value < 0.0)?;
            Some((place.clone(), value))
        };
        if let Some((place, value)) = places.iter().find_map(below_zero) {
            check.note(format!(
                "{}: the coefficient of the term is {value:.4} at {place}, where its loss factor feeds vibration in the place of damping it; what friction takes \
                 from a stiffness belongs into a term without one",
                field("terms", name, "loss_factor")
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]

    use std::path::Path;

    use crate::CaseFile;

    /// Friction in a stiffness, `1 - mu / at`, with mu normal: a loss factor is asked about where 95 % of mu reach beyond `at`, of given matrices and of meshes.
    #[test]
    fn a_loss_factor_that_friction_turns_round_is_asked_about() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad");
        let mesh = std::fs::read_to_string(folder.join("disc-pad.toml")).unwrap();
        let name = "name = \"structure\"\n";
        assert!(mesh.contains(name));
        for at in [0.1, 0.3, 0.5, 0.66, 0.67, 2.0] {
            for loss in [0.0, 0.04] {
                let of_term = format!("coefficient = \"1 - friction/{at:?}\"\nloss_factor = {loss}\n");
                let parameter = "[parameters.friction]\ndistribution = \"normal\"\nmean = 0.5\ndeviation = 0.1\n";
                let matrices = format!(
                    "[study]\nname = \"x\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\n{parameter}\
                     [[terms]]\nname = \"rest\"\nmass = [[1.0]]\nstiffness = [[1e6]]\n[[terms]]\nname = \"structure\"\nstiffness = [[1e5]]\n{of_term}"
                );
                let finite_elements = mesh.replace(name, &format!("{name}{of_term}")) + "\n" + parameter;
                let of_matrices = match CaseFile::parse(Path::new("x.toml"), matrices).unwrap() {
                    CaseFile::Matrices(case) => case.header.notes,
                    other => panic!("{other:?}"),
                };
                let of_mesh = match CaseFile::parse(&folder.join("x.toml"), finite_elements).unwrap() {
                    CaseFile::FiniteElements(case) => case.header.notes,
                    other => panic!("{other:?}"),
                };
                // The 95 % quantile of friction is 0.6645.
                let expected = at < 0.6645 && loss > 0.0;
                for notes in [of_matrices, of_mesh] {
                    let asked = notes.iter().filter(|note| note.contains("feeds vibration")).count();
                    assert_eq!(asked, usize::from(expected), "{at} {loss}: {notes:?}");
                }
            }
        }
    }
}
