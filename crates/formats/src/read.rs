//! Reading a file of any format.

use std::io::Read;
use std::path::Path;

use crate::bytes::{Bytes, Endian};
use crate::detect::{Format, detect};
use crate::dmig::Found;
use crate::error::{FormatsError, Place};
use crate::limits::{Limits, Options};
use crate::lines::Lines;
use crate::matrix::{Kind, Matrix};
use crate::problem::Problem;
use crate::source::{Contents, open};
use crate::{Dof, abaqus, coordinates, dmig, market, mat, numpy, op4, substructure};

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct File {
    /// Its format.
    pub format: Format,
    /// The real matrices, in the order of the file.
    pub matrices: Vec<Matrix>,
    /// Names of what else is in it, each with the reason why it was left out.
    pub left_out: Vec<(String, String)>,
}

impl File {
    /// The matrix of this name.
    ///
    /// # Errors
    /// [`FormatsError::NoSuchMatrix`], with the reason where it was left out or where several have the name.
    pub fn matrix(&self, name: &str) -> Result<&Matrix, FormatsError> {
        let left_out = self.left_out.iter().find(|(left_out, _)| left_out == name);
        let refused =
            |reason| FormatsError::NoSuchMatrix { name: crate::shortened::cut(name), reason, allowed: self.names() };
        let mut all = self.matrices.iter().filter(|matrix| matrix.name == name);
        match (all.next(), all.next()) {
            (Some(matrix), None) => Ok(matrix),
            (Some(_), Some(_)) => Err(refused(Some("several have this name".to_owned()))),
            _ => Err(refused(left_out.map(|(_, reason)| reason.clone()))),
        }
    }

    /// The matrix of this kind.
    ///
    /// # Errors
    /// [`FormatsError::NoSuchMatrix`] where there is none or more than one.
    pub fn of_kind(&self, kind: Kind) -> Result<&Matrix, FormatsError> {
        let mut all = self.matrices.iter().filter(|matrix| matrix.kind == Some(kind));
        match (all.next(), all.next()) {
            (Some(matrix), None) => Ok(matrix),
            (one, _) => Err(FormatsError::NoSuchMatrix {
                name: format!("{kind:?}").to_lowercase(),
                reason: one.map(|_| "there are several".to_owned()),
                allowed: self.names(),
            }),
        }
    }

    /// The only matrix.
    ///
    /// # Errors
    /// [`FormatsError::Several`] where there are more.
    pub fn only(self) -> Result<Matrix, FormatsError> {
        let names = self.names();
        let mut all = self.matrices.into_iter();
        match (all.next(), all.next()) {
            (Some(matrix), None) => Ok(matrix),
            (Some(_), Some(_)) => Err(FormatsError::Several { names }),
            _ => Err(FormatsError::NoMatrix { left_out: self.left_out }),
        }
    }

    fn names(&self) -> Vec<String> {
        self.matrices.iter().map(|matrix| matrix.name.clone()).collect()
    }
}

/// Reads all matrices of a file, whatever its format and however it is called; compressed by gzip or not.
///
/// Beside a list of CalculiX (`brake.sti`, `brake.mas`) the file of its labels (`brake.dof` or `brake.dof.gz`) is read too,
/// where there is one.
///
/// # Errors
/// A file that cannot be read, is not a regular one, of no known format, at fault at a place, or without a matrix.
pub fn read(path: &Path) -> Result<File, FormatsError> {
    read_with(path, Options::default())
}

/// [`read`] with limits, an assumption on symmetry, or progress.
///
/// # Errors
/// As [`read`].
pub fn read_with(path: &Path, options: Options<'_>) -> Result<File, FormatsError> {
    let (file, size) = open(path)?;
    let (limits, unstated) = (options.limits.bounded(), options.unstated);
    let contents = Contents::new(file, size, &limits, options.progress)?;
    let format = detect(&contents.head)?;
    let labels = if format.0 == Format::Coordinates { labels_beside(path, &limits)? } else { None };
    let named = kind_by_name(path);
    parse(contents, format, Options { limits, unstated, progress: None }, named, labels)
}

/// Reads all matrices of contents in memory, as [`read_with`]; of a list without a header `labels` are the names of the rows.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], labels: Option<Vec<Dof>>, options: Options<'_>) -> Result<File, FormatsError> {
    let Options { limits, unstated, progress } = options;
    let limits = limits.bounded();
    let contents = Contents::new(bytes, bytes.len() as u64, &limits, progress)?;
    let format = detect(&contents.head)?;
    parse(contents, format, Options { limits, unstated, progress: None }, None, labels)
}

/// Reads the names of rows, one `node.direction` a line, as CalculiX writes them (`.dof`).
///
/// # Errors
/// As [`read`].
pub fn read_labels(path: &Path, limits: &Limits) -> Result<Vec<Dof>, FormatsError> {
    let ((file, size), limits) = (open(path)?, limits.bounded());
    let mut lines = Lines::new(Contents::new(file, size, &limits, None)?.whole());
    coordinates::parse_labels(&mut lines, &limits).map_err(|problem| lines.located(problem))
}

/// The labels beside a list of CalculiX, if there are any.
fn labels_beside(path: &Path, limits: &Limits) -> Result<Option<Vec<Dof>>, FormatsError> {
    let plain = path.with_extension("");
    let stem =
        if path.extension().is_some_and(|extension| extension == "gz") { plain.with_extension("") } else { plain };
    for ending in ["dof", "dof.gz"] {
        let beside = stem.with_extension(ending);
        if beside.is_file() {
            let file = beside.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let at_fault = |source| FormatsError::Labels { file, source: Box::new(source) };
            return read_labels(&beside, limits).map(Some).map_err(at_fault);
        }
    }
    Ok(None)
}

/// What CalculiX and Abaqus say in the name of a file alone: `.sti`, `.mas`; `_STIF1.mtx`, `_MASS1.mtx`, `_DMPV1.mtx`.
fn kind_by_name(path: &Path) -> Option<Kind> {
    let name = path.file_name()?.to_string_lossy().to_uppercase();
    let name = name.strip_suffix(".GZ").unwrap_or(&name);
    let (stem, extension) = name.rsplit_once('.')?;
    let last = stem.rsplit_once('_').map_or("", |(_, last)| last.trim_end_matches(|c: char| c.is_ascii_digit()));
    match (extension, last) {
        ("STI", _) | (_, "STIF") => Some(Kind::Stiffness),
        ("MAS", _) | (_, "MASS") => Some(Kind::Mass),
        (_, "DMPV") => Some(Kind::Damping),
        _ => None,
    }
}

fn parse(
    contents: Contents<'_>,
    (format, endian): (Format, Endian),
    options: Options<'_>,
    kind: Option<Kind>,
    labels: Option<Vec<Dof>>,
) -> Result<File, FormatsError> {
    let (limits, unstated) = (&options.limits, options.unstated);
    let name = match kind {
        Some(Kind::Mass) => "mass",
        Some(Kind::Damping) => "damping",
        Some(Kind::Stiffness) => "stiffness",
        None => "matrix",
    };
    let only = |matrix| (vec![matrix], Vec::new());
    let (matrices, left_out) = match format {
        Format::MatrixMarket => in_text(contents, |lines| market::parse(lines, limits).map(only))?,
        Format::Coordinates => {
            in_text(contents, |lines| coordinates::parse(lines, limits, unstated, (name, kind), labels).map(only))?
        }
        Format::AbaqusMatrixInput => {
            in_text(contents, |lines| Ok((abaqus::parse(lines, limits, unstated, (name, kind))?, Vec::new())))?
        }
        Format::AbaqusSubstructure => in_text(contents, |lines| Ok((substructure::parse(lines, limits)?, Vec::new())))?,
        Format::Dmig => in_text(contents, |lines| dmig::parse(lines, limits))?,
        Format::Op4Text => in_text(contents, |lines| op4::text::parse(lines, limits))?,
        Format::Op4Binary => in_bytes(contents, endian, |bytes| op4::binary::parse(bytes, limits))?,
        Format::MatlabV4 => in_bytes(contents, endian, |bytes| mat::v4::parse(bytes, limits))?,
        Format::MatlabV5 => in_bytes(contents, endian, |bytes| mat::v5::parse(bytes, limits))?,
        Format::Npy => in_bytes(contents, endian, |bytes| npy(bytes, limits))?,
        Format::Npz => {
            let mut bytes = Vec::new();
            contents.whole().read_to_end(&mut bytes).map_err(FormatsError::Open)?;
            numpy::npz::parse(bytes, limits)?
        }
    };
    if matrices.is_empty() {
        return Err(FormatsError::NoMatrix { left_out });
    }
    Ok(File { format, matrices, left_out })
}

fn in_text(
    contents: Contents<'_>,
    parse: impl FnOnce(&mut Lines<'_>) -> Result<Found, Problem>,
) -> Result<Found, FormatsError> {
    let mut lines = Lines::new(contents.whole());
    parse(&mut lines).map_err(|problem| lines.located(problem))
}

fn in_bytes(
    contents: Contents<'_>,
    endian: Endian,
    parse: impl FnOnce(&mut Bytes<'_>) -> Result<Found, Problem>,
) -> Result<Found, FormatsError> {
    let mut bytes = Bytes::new(Box::new(contents.whole()), endian);
    parse(&mut bytes)
        .map_err(|problem| FormatsError::At { place: Place::Byte(bytes.position), problem: Box::new(problem) })
}

fn npy(bytes: &mut Bytes<'_>, limits: &Limits) -> Result<Found, Problem> {
    let header = numpy::npy::header(bytes)?;
    if let Some(reason) = header.reason() {
        return Ok((Vec::new(), vec![("matrix".to_owned(), reason)]));
    }
    let (builder, size) = header.fill(bytes, limits)?;
    if bytes.first()?.is_some() {
        return Err(Problem::field("bytes after the array", "some", "none"));
    }
    let head = crate::builder::Head::unlabelled("matrix", None, size);
    Ok((vec![builder.finish(crate::builder::Symmetry::General, head)?], Vec::new()))
}
