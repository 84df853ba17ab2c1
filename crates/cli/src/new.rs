//! `squeal new`: a commented case from a mesh and the matrices beside it, or from matrices alone.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use brakes::case::{Draft, DraftFiles};
use output::{printable, write};

use crate::Error;

/// Write a case file from a mesh and its sets, or from matrices alone: what they say stands in it, what they cannot know is commented out, to be
/// filled in.
///
/// Matrices are those beside the mesh under the names that CalculiX (model.mas, model.sti) and Abaqus (model_MASS1.mtx, model_STIF1.mtx) give
/// them, or those of the options. `squeal check` takes the case as it is: the bodies without contact and friction. Without a mesh the case is one
/// of plain matrices, which `squeal cea` takes as it is too.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: squeal new brake.toml --from model.inp; squeal check brake.toml; squeal new own.toml --mass M.mtx --damping C.mtx --stiffness K.mtx; squeal cea own.toml"
)]
pub struct NewArgs {
    /// The case file to write; it must not exist
    pub case: PathBuf,
    /// An input deck of Abaqus or CalculiX with nodes, elements and sets
    #[arg(long, value_name = "MESH")]
    pub from: Option<PathBuf>,
    /// File with the mass, FILE or FILE:NAME; with a mesh, instead of the one beside it
    #[arg(long, value_name = "FILE", requires = "stiffness")]
    pub mass: Option<PathBuf>,
    /// File with the stiffness
    #[arg(long, value_name = "FILE", requires = "mass")]
    pub stiffness: Option<PathBuf>,
    /// File with the damping, if there is one
    #[arg(long, value_name = "FILE", requires = "mass")]
    pub damping: Option<PathBuf>,
}

impl NewArgs {
    /// Runs the command; `out` gets what was found and what is left.
    ///
    /// # Errors
    /// A case file that exists, a mesh or matrices that cannot be read or do not belong together.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let name = self.case.display().to_string();
        if self.case.symlink_metadata().is_ok() {
            let allowed = "the name of a file that does not exist".to_owned();
            return Err(Error::Option { option: "CASE", value: name, allowed });
        }
        let draft = match (&self.from, self.mass.clone().zip(self.stiffness.clone())) {
            (None, None) => {
                let allowed = "a mesh, or --mass and --stiffness".to_owned();
                return Err(Error::Option { option: "--from", value: "missing".into(), allowed });
            }
            (None, Some(files)) => Draft::of_matrices(&self.case, &files.into(), self.damping.as_deref())?,
            (Some(mesh), given) => {
                // A mesh that cannot be read says so before matrices are looked for.
                File::open(mesh).map_err(|source| Error::Read { path: mesh.clone(), source })?;
                Draft::new(&self.case, &self.files(mesh, given)?)?
            }
        };
        let mut lines = format!("{}: written\n\n", printable(&name));
        for (what, words) in &draft.found {
            lines += &format!("  {what:<12}  {}\n", printable(words));
        }
        let waiting = draft.waiting();
        lines += &format!(
            "\nLines with a # at their beginning and no blank after it wait for you; {waiting} have a ? to be filled in.\n"
        );
        write(&self.case, draft.text.as_bytes())?;
        out.write_all(lines.as_bytes()).map_err(Error::StandardOutput)
    }

    /// The files that were given, or those beside the mesh.
    fn files(&self, mesh: &Path, given: Option<(PathBuf, PathBuf)>) -> Result<DraftFiles, Error> {
        if let Some(files) = given {
            return Ok(DraftFiles {
                mesh: mesh.to_owned(),
                mass_and_stiffness: files.into(),
                damping: self.damping.clone(),
            });
        }
        DraftFiles::beside(mesh).ok_or_else(|| Error::Option {
            option: "--from",
            value: format!("{}, with no matrices beside it", mesh.display()),
            allowed: "a mesh with those of CalculiX (NAME.mas, NAME.sti) or Abaqus (NAME_MASS1.mtx, NAME_STIF1.mtx) beside it, or --mass and \
                      --stiffness"
                .into(),
        })
    }
}
