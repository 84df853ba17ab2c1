//! M, C and K from files of any format, on one numbering of degrees of freedom.

use std::path::{Path, PathBuf};

use brakes::case::held::{Held, HeldRows};
use brakes::case::input::check_size;
use formats::{
    Dof, FormatsError, Kind, Limits, Matrix, Options, on_common_rows, own_rows_in_words, read_with, split_name,
};

use super::EigArgs;
use super::symmetry::wanted;
use crate::Error;
use crate::terminal::note;

/// Limits of the matrices that are read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    /// Most bytes of a file, and of its contents after decompression.
    pub(super) bytes: u64,
    /// Most degrees of freedom.
    pub(super) order: usize,
    /// Last words of the error that refuses more degrees of freedom, with a comma before them: what the user can do instead.
    pub(super) beyond: &'static str,
}

/// M, C and K, n x n, with the same degree of freedom in the same row of each. Those that an entry huge against all others constrains
/// ([`brakes::case::held`]) are taken out.
pub(super) struct Matrices {
    pub(super) mass: Matrix,
    pub(super) damping: Option<Matrix>,
    pub(super) stiffness: Matrix,
    /// Files that were read, and how the entries of each were understood.
    pub(super) files: Vec<TakenFile>,
    /// Names of the degrees of freedom that were taken out; their numbers from 1, if no file has names.
    pub(super) held: Vec<String>,
}

/// File that was read, and how its entries were understood.
pub(super) struct TakenFile {
    pub(super) kind: Kind,
    /// Path of the file, as the user gave it.
    pub(super) path: PathBuf,
    /// Name of the matrix in the file.
    pub(super) name: String,
    /// Whether the entries are the whole matrix or a triangle that was mirrored, and what says so; then which rows the file alone has. In words.
    pub(super) taken: String,
}

impl Matrices {
    /// Reads the files that `args` names.
    ///
    /// # Errors
    /// A file that is no matrix, a matrix of another kind, shapes or rows that do not belong together, sizes above `sizes`, entries that may be one
    /// triangle of a symmetric matrix or all of an unsymmetric one.
    pub(super) fn read(args: &EigArgs, sizes: Sizes) -> Result<Self, Error> {
        let mut all = vec![Given::read(args, Kind::Mass, &args.mass, sizes)?];
        if let Some(path) = &args.damping {
            all.push(Given::read(args, Kind::Damping, path, sizes)?);
        }
        all.push(Given::read(args, Kind::Stiffness, &args.stiffness, sizes)?);
        let mut files: Vec<_> = all.iter().map(Given::taken).collect();
        let own = own_rows_in_words(&all.iter().map(|given| &given.matrix).collect::<Vec<_>>());
        for (file, own) in files.iter_mut().zip(own) {
            file.taken.extend(own.map(|own| format!("; {own}")));
        }
        let mut matrices: Vec<_> = all.iter_mut().map(|given| &mut given.matrix).collect();
        on_common_rows(&mut matrices)
            .map_err(|(at, source)| Error::Matrix { path: all[at].path.to_owned(), source: Box::new(source) })?;
        check_sizes(&all, sizes)?;
        let held = take_out_held(&mut all)?;
        let mut matrices = all.into_iter().map(|given| given.matrix);
        let (first, second, third) = (matrices.next(), matrices.next(), matrices.next());
        match (first, second, third) {
            (Some(mass), Some(damping), Some(stiffness)) => {
                Ok(Self { mass, damping: Some(damping), stiffness, files, held })
            }
            (Some(mass), Some(stiffness), None) => Ok(Self { mass, damping: None, stiffness, files, held }),
            // Mass and stiffness are always read.
            _ => Err(Error::Sparse(sparse::SparseError::Empty)),
        }
    }

    /// n, the number of degrees of freedom.
    pub(super) fn order(&self) -> usize {
        self.mass.rows()
    }

    /// The names of the degrees of freedom, row by row; `None` if no file has names.
    pub(super) fn labels(&self) -> Option<&[Dof]> {
        let all = [Some(&self.mass), self.damping.as_ref(), Some(&self.stiffness)];
        all.into_iter().flatten().find_map(Matrix::row_labels)
    }
}

/// A matrix that was read, with the option (`--mass`, `--damping` or `--stiffness`) and the path by which the user gave it.
struct Given<'a> {
    kind: Kind,
    path: &'a Path,
    matrix: Matrix,
}

impl<'a> Given<'a> {
    /// The matrix of a file that `kind`, or a name after the path (FILE:NAME), asks for. What the reader was unsure of is printed as notes.
    fn read(args: &EigArgs, kind: Kind, path: &'a Path, sizes: Sizes) -> Result<Self, Error> {
        let refused = |source: FormatsError| Error::Matrix { path: path.to_owned(), source: Box::new(source) };
        let (file, name) = split_name(path);
        check_size(file, sizes.bytes).map_err(|source| Error::Read { path: path.to_owned(), source })?;
        let limits = Limits { bytes: sizes.bytes, ..Limits::default() };
        let options = Options { limits, ..Options::default() };
        let wanted = formats::Wanted { name, ..wanted(&args.symmetry, kind) };
        let matrix = read_with(file, options).and_then(|file| file.take(&wanted)).map_err(|source| match source {
            FormatsError::OneSided { side, .. } => one_sided(path, kind, side),
            FormatsError::PartlyMirrored { alone, paired, .. } => partly_mirrored(path, kind, &alone, &paired),
            source => refused(source),
        })?;
        if let (Some(other), None) = (matrix.kind().filter(|&other| other != kind), name) {
            let allowed = format!(
                "a {kind} matrix; by its name or contents it is one of {other} (FILE:{} takes it nevertheless)",
                matrix.name()
            );
            return Err(Error::Option { option: option(kind), value: path.display().to_string(), allowed });
        }
        let given = Self { kind, path, matrix };
        for doubt in given.matrix.doubts() {
            let option = if doubt.is_of_symmetry() { format!(" (--symmetry {kind}=...)") } else { String::new() };
            note(&format!("{}: {doubt}{option}", path.display()));
        }
        Ok(given)
    }

    fn taken(&self) -> TakenFile {
        let (name, taken) = (self.matrix.name().to_owned(), self.matrix.taken());
        TakenFile { kind: self.kind, path: self.path.to_owned(), name, taken }
    }
}

/// The option that gives a matrix.
fn option(kind: Kind) -> &'static str {
    match kind {
        Kind::Mass => "--mass",
        Kind::Damping => "--damping",
        Kind::Stiffness => "--stiffness",
    }
}

/// Error for a matrix of whose entries off the diagonal none has its mirror image: they may be one triangle of a symmetric matrix, or all of an
/// unsymmetric one. `side` is the triangle in which all of them are, if they are in one.
fn one_sided(path: &Path, kind: Kind, side: Option<formats::Symmetry>) -> Error {
    let (found, mirrored) = match side {
        Some(side) => ("on one side of the diagonal only", format!("{kind}={side} for a triangle to be mirrored")),
        None => ("without mirror images", format!("{kind}=triangle for a triangle to be mirrored")),
    };
    Error::Option {
        option: option(kind),
        value: path.display().to_string(),
        allowed: format!(
            "a matrix of which it is known whether it is a triangle: it has entries {found}, and the file does not say \
             whether it is symmetric; say --symmetry {kind}=whole for an unsymmetric matrix, such as friction, or {mirrored}"
        ),
    }
}

/// Error for a matrix with an entry at `alone` without a mirror image, and an equal pair at `paired`.
fn partly_mirrored(path: &Path, kind: Kind, alone: &str, paired: &str) -> Error {
    Error::Option {
        option: option(kind),
        value: path.display().to_string(),
        allowed: format!(
            "a matrix that lists either one triangle or both: it has an entry at {alone} without a mirror image and an equal pair at {paired}; say \
             --symmetry {kind}=whole for an unsymmetric matrix, such as friction"
        ),
    }
}

/// Refuses matrices that are too large, not square, or not of one order.
fn check_sizes(all: &[Given<'_>], sizes: Sizes) -> Result<(), Error> {
    let shape = |given: &Given<'_>| (given.matrix.rows(), given.matrix.columns());
    for given in all {
        let ((rows, columns), name, path) = (shape(given), word(given.kind), given.path.to_owned());
        if rows.max(columns) > sizes.order {
            return Err(Error::MatrixTooLarge { path, name, rows, columns, most: sizes.order, beyond: sizes.beyond });
        }
        if rows != columns {
            let reason = "a square matrix";
            return Err(Error::MatrixShape { path, name, rows, columns, order: rows, reason });
        }
    }
    // The order that most of the matrices have is taken for the right one; of two matrices that differ, the order of the mass matrix.
    let votes = |order: usize| all.iter().filter(|given| given.matrix.rows() == order).count();
    let orders: Vec<usize> = all.iter().map(|given| given.matrix.rows()).collect();
    let order = orders.iter().copied().max_by_key(|&order| (votes(order), orders[0] == order)).unwrap_or(0);
    match all.iter().find(|given| given.matrix.rows() != order) {
        None => Ok(()),
        Some(given) => {
            let ((rows, columns), name, path) = (shape(given), word(given.kind), given.path.to_owned());
            let like = all.iter().find(|given| given.matrix.rows() == order).map_or(Kind::Mass, |given| given.kind);
            let reason = match like {
                Kind::Mass => "like the mass matrix",
                Kind::Damping => "like the damping matrix",
                Kind::Stiffness => "like the stiffness matrix",
            };
            Err(Error::MatrixShape { path, name, rows, columns, order, reason })
        }
    }
}

/// The word for a matrix in an error.
fn word(kind: Kind) -> &'static str {
    match kind {
        Kind::Mass => "mass",
        Kind::Damping => "damping",
        Kind::Stiffness => "stiffness",
    }
}

/// Takes the degrees of freedom that an entry huge against all others constrains out of all matrices, prints a note that says so, and gives their names.
fn take_out_held(all: &mut [Given<'_>]) -> Result<Vec<String>, Error> {
    let order = all.first().map_or(0, |given| given.matrix.rows());
    let mut held = HeldRows::new(order);
    for given in all.iter() {
        held.add(given.kind, given.matrix.entries().iter().copied()).map_err(|tied| Error::Option {
            option: option(given.kind),
            value: given.path.display().to_string(),
            allowed: tied.to_string(),
        })?;
    }
    let held = std::collections::BTreeSet::from_iter(held.rows());
    if held.is_empty() {
        return Ok(Vec::new());
    }
    let labels = all.iter().find_map(|given| given.matrix.row_labels());
    let names: Vec<String> = held
        .iter()
        .map(|&row| labels.and_then(|labels| labels.get(row)).map_or_else(|| (row + 1).to_string(), Dof::to_string))
        .collect();
    if held.len() == order {
        return Err(Error::Option {
            option: "--stiffness",
            value: "all degrees of freedom held by huge entries".to_owned(),
            allowed: "one or more that are not".to_owned(),
        });
    }
    note(&Held(&names).to_string());
    for given in all.iter_mut() {
        given.matrix = given.matrix.without(&held);
    }
    Ok(names)
}
