//! M, C and K from files of any format, on common rows.

use std::path::Path;

use formats::{Dof, FormatsError, Kind, Limits, Matrix, Options, common_labels, read_with};

use super::EigArgs;
use crate::Error;
use crate::input::check_size;

/// What may be read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    /// Most bytes of a file, and of its contents after decompression.
    pub(super) bytes: u64,
    /// Most degrees of freedom.
    pub(super) order: usize,
    /// What else is possible above that many degrees of freedom, to be added to the refusal.
    pub(super) beyond: &'static str,
}

/// M, C and K of one order, with the same rows.
pub(super) struct Matrices {
    pub(super) mass: Matrix,
    pub(super) damping: Option<Matrix>,
    pub(super) stiffness: Matrix,
}

impl Matrices {
    /// Reads the files that `args` names.
    ///
    /// # Errors
    /// A file that is no matrix, a matrix of another kind, shapes or rows that do not belong together, sizes above `sizes`.
    pub(super) fn read(args: &EigArgs, sizes: Sizes) -> Result<Self, Error> {
        let mut all = vec![Given::read("mass", Kind::Mass, &args.mass, sizes)?];
        if let Some(path) = &args.damping {
            all.push(Given::read("damping", Kind::Damping, path, sizes)?);
        }
        all.push(Given::read("stiffness", Kind::Stiffness, &args.stiffness, sizes)?);
        on_common_rows(&mut all)?;
        let order = all[0].matrix.rows();
        for (given, reason) in all.iter().zip(["a square matrix", "like the mass matrix", "like the mass matrix"]) {
            given.check(order, reason, sizes)?;
        }
        let mut matrices = all.into_iter().map(|given| given.matrix);
        let (first, second, third) = (matrices.next(), matrices.next(), matrices.next());
        match (first, second, third) {
            (Some(mass), Some(damping), Some(stiffness)) => Ok(Self { mass, damping: Some(damping), stiffness }),
            (Some(mass), Some(stiffness), None) => Ok(Self { mass, damping: None, stiffness }),
            // Mass and stiffness are always read.
            _ => Err(Error::Sparse(sparse::SparseError::Empty)),
        }
    }

    pub(super) fn order(&self) -> usize {
        self.mass.rows()
    }

    /// The names of the rows, where a file has them.
    pub(super) fn labels(&self) -> Option<&[Dof]> {
        let all = [Some(&self.mass), self.damping.as_ref(), Some(&self.stiffness)];
        all.into_iter().flatten().find_map(Matrix::row_labels)
    }
}

/// A matrix and the option that named it.
struct Given<'a> {
    name: &'static str,
    path: &'a Path,
    matrix: Matrix,
}

impl<'a> Given<'a> {
    /// The only matrix of a file, or the one of this kind.
    fn read(name: &'static str, kind: Kind, path: &'a Path, sizes: Sizes) -> Result<Self, Error> {
        let refused = |source: FormatsError| Error::Matrix { path: path.to_owned(), source: Box::new(source) };
        check_size(path, sizes.bytes).map_err(|source| Error::Read { path: path.to_owned(), source })?;
        let limits = Limits { bytes: sizes.bytes, ..Limits::default() };
        let file = read_with(path, Options { limits, ..Options::default() }).map_err(refused)?;
        let matrix =
            if file.matrices.len() > 1 { file.of_kind(kind).cloned() } else { file.only() }.map_err(refused)?;
        match matrix.kind() {
            Some(other) if other != kind => Err(Error::Option {
                option: match kind {
                    Kind::Mass => "--mass",
                    Kind::Damping => "--damping",
                    Kind::Stiffness => "--stiffness",
                },
                value: path.display().to_string(),
                allowed: format!("a {name} matrix; by its name or contents it is one of {}", in_words(other)),
            }),
            _ => Ok(Self { name, path, matrix }),
        }
    }

    /// Refuses a matrix that is not `order` x `order`, or too large.
    fn check(&self, order: usize, reason: &'static str, sizes: Sizes) -> Result<(), Error> {
        let (path, name, rows, columns) = (self.path.to_owned(), self.name, self.matrix.rows(), self.matrix.columns());
        if rows > sizes.order {
            return Err(Error::MatrixTooLarge { path, name, rows, columns, most: sizes.order, beyond: sizes.beyond });
        }
        if (rows, columns) != (order, order) {
            return Err(Error::MatrixShape { path, name, rows, columns, order, reason });
        }
        Ok(())
    }
}

fn in_words(kind: Kind) -> &'static str {
    match kind {
        Kind::Mass => "mass",
        Kind::Damping => "damping",
        Kind::Stiffness => "stiffness",
    }
}

/// Puts matrices whose files name their rows on the rows that any of them has. Where one has no names, the others must have
/// equal ones: nothing else says which of its rows is which.
fn on_common_rows(all: &mut [Given<'_>]) -> Result<(), Error> {
    let labelled: Vec<&Matrix> = all.iter().map(|given| &given.matrix).filter(|m| m.row_labels().is_some()).collect();
    let rows = |matrix: &&Matrix| (matrix.row_labels().map(<[_]>::to_vec), matrix.column_labels().map(<[_]>::to_vec));
    if labelled.windows(2).all(|pair| rows(&pair[0]) == rows(&pair[1])) {
        return Ok(());
    }
    let refused = |path: &Path, source| Error::Matrix { path: path.to_owned(), source: Box::new(source) };
    if let Some(other) = all.iter().find(|given| given.matrix.row_labels().is_none()) {
        return Err(refused(other.path, FormatsError::Unlabelled { matrix: other.matrix.name().to_owned() }));
    }
    let labels = common_labels(labelled).map_err(|source| refused(all[0].path, source))?;
    for given in all {
        given.matrix = given.matrix.on(&labels).map_err(|source| refused(given.path, source))?;
    }
    Ok(())
}
