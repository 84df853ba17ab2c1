//! Draft of a case of plain matrices.

use std::path::{Path, PathBuf};

use super::MatricesCase;
use crate::CaseError;
use crate::draft::{Draft, damping_line, is_one_sided, named, quoted, symmetry_line};

/// Most degrees of freedom that are listed; chosen: a line or two.
const MOST_DOFS: usize = 12;

impl Draft {
    /// The draft of a case file `case`, which need not exist, from the files of mass and stiffness and, if given, of damping, each as `FILE` or
    /// `FILE:NAME`.
    ///
    /// # Errors
    /// Matrices that cannot be read, or do not belong together.
    pub fn of_matrices(
        case: &Path,
        mass_and_stiffness: &[PathBuf; 2],
        damping: Option<&Path>,
    ) -> Result<Self, CaseError> {
        // A draft is written and then parsed, which reads its matrices: the case tells the names of the degrees of freedom.
        let drafted = |is_triangle: bool, dofs: &[String]| {
            let draft = text(case, mass_and_stiffness, damping, is_triangle, dofs);
            Ok((MatricesCase::parse(case, draft.clone())?, draft))
        };
        // A one-sided matrix is refused unless it is said to be a triangle.
        let (is_triangle, (first, _)) = match drafted(false, &[]) {
            Err(error) if is_one_sided(&error) => (true, drafted(true, &[])?),
            other => (false, other?),
        };
        // Once more with the names that were found; parsed again as a check, for which the matrices are read a second or third time.
        let (_, text) = drafted(is_triangle, &first.dofs)?;
        let triangle = if is_triangle { ", taken as a triangle: look at `symmetry`" } else { "" };
        let found = vec![
            ("matrices", format!("{} degrees of freedom{triangle}", first.dofs.len())),
            ("contact", "no matrix says where parts rub; to be filled in".to_owned()),
        ];
        Ok(Self { text, found })
    }
}

/// The text of the draft; `dofs` are the names of the degrees of freedom, of which the first are listed.
fn text(
    case: &Path,
    mass_and_stiffness: &[PathBuf; 2],
    damping: Option<&Path>,
    is_triangle: bool,
    dofs: &[String],
) -> String {
    let [mass, stiffness] = mass_and_stiffness.each_ref().map(|file| quoted(&named(file, case)));
    let study = case.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let listed: Vec<String> = dofs.iter().take(MOST_DOFS).map(|name| output::printable(name)).collect();
    let more = dofs.len().saturating_sub(MOST_DOFS);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!(
        r#"# Draft by `squeal new`: what the matrices say stands here, and `squeal check` takes it as it is.
#
# What they cannot know is commented out, without a blank after the #: remove the # and put a value in place of each ?.
# docs/case-files.md, "Brakes given by their matrices", explains every field.

[study]
name = {study}
samples = 1000                         # draws of what is uncertain
seed = 1

[brake]
kind = "matrices"
# Degrees of freedom: {listed}{more}

[[terms]]
name = "structure"
mass = {mass}
stiffness = {stiffness}
{damping}{symmetry}#loss_factor = ?                       # of this stiffness, where it is symmetric; dashpots go into a damping matrix

# What is uncertain; one table each. Its name may stand in every expression in quotes.
#[parameters.mu]
#distribution = "uniform"
#from = ?
#to = ?

# Where parts rub: friction is mu times the normal force.
#[[contacts]]
#name = "pad"
#force = {{ "?" = 1.0 }}                 # the degree of freedom along the sliding that friction pushes
#reading = {{ "?" = ? }}                 # the normal force by a displacement: the spring of the contact, at its normal degree of freedom
#mu = "mu"

# Where a solver put friction into its stiffness, for one coefficient of friction or for two: docs/case-files.md, "Friction in a stiffness".
"#,
        study = quoted(&study),
        listed = listed.join(", "),
        damping = damping_line(damping, case),
        symmetry = symmetry_line(is_triangle),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const HARD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fixtures/hard/bicycle_v4");

    fn draft(files: [&str; 3]) -> (PathBuf, Draft) {
        let [mass, damping, stiffness] = files.map(|name| Path::new(HARD).join(name));
        let case = Path::new(HARD).join("own brake.toml");
        let draft = Draft::of_matrices(&case, &[mass, stiffness], Some(&damping)).unwrap();
        (case, draft)
    }

    #[test]
    fn matrices_give_a_case_that_is_accepted_as_it_is_and_filled_in() {
        let (path, Draft { text, found }) = draft(["M.mtx", "C.mtx", "K.mtx"]);
        let as_it_is = MatricesCase::parse(&path, text.clone()).unwrap();
        assert_eq!((as_it_is.dofs.len(), as_it_is.gains.len()), (2, 0));
        assert!(found[0].1.starts_with("2 degrees of freedom"), "{found:?}");
        assert!(text.contains("# Degrees of freedom: 1, 2\n"), "{text}");
        let filled = text
            .replace("#loss_factor", "#-loss_factor")
            .replace("\n#[", "\n[")
            .replace("#distribution", "distribution")
            .replace("#from = ?", "from = 0.2")
            .replace("#to = ?", "to = 0.6")
            .replace("#name", "name")
            .replace("#force = { \"?\"", "force = { \"1\"")
            .replace("#reading = { \"?\" = ?", "reading = { \"2\" = 3.0")
            .replace("#mu", "mu");
        let filled = MatricesCase::parse(&path, filled).unwrap();
        assert_eq!((filled.gains.len(), filled.parameters.len()), (1, 1));
    }

    #[test]
    fn a_triangle_is_taken_as_one_and_said() {
        let dir = tempfile::tempdir().unwrap();
        let file = |name: &str, lines: &str| {
            let path = dir.path().join(name);
            std::fs::write(&path, lines).unwrap();
            path
        };
        let mass = file("M.mtx", "1 1 2.0\n2 2 2.0\n");
        let stiffness = file("K.mtx", "1 1 5.0\n1 2 -1.0\n2 2 4.0\n");
        let Draft { text, found } =
            Draft::of_matrices(&dir.path().join("brake.toml"), &[mass, stiffness], None).unwrap();
        assert!(text.contains("\nsymmetry = \"triangle\"") && text.contains("\nmass = \"M.mtx\"\n"), "{text}");
        assert!(found[0].1.contains("look at `symmetry`"), "{found:?}");
    }
}
