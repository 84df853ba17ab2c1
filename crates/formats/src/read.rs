//! Reading a file of any format.

use std::io::Read;
use std::path::Path;

use crate::builder::{Found, Head, Stated};
use crate::bytes::{Bytes, Endian};
use crate::detect::{Format, detect};
use crate::error::{FormatsError, Place};
use crate::limits::{Limits, Options};
use crate::lines::Lines;
use crate::matrix::{Kind, Matrix};
use crate::names::{is_structural, kind_of};
use crate::problem::Problem;
use crate::source::{Contents, open};
use crate::symmetry::{Stored, Symmetry};
use crate::{Dof, abaqus_matrices, coordinates, dmig, harwell_boeing, market, mat, numpy, op4, substructure};

/// Contents of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct File {
    /// Format of the file.
    pub format: Format,
    /// The real matrices, in the order of the file.
    pub matrices: Vec<Matrix>,
    /// Names of what else is in the file, each with the reason why it was left out.
    pub left_out: Vec<(String, String)>,
}

/// Choice of a matrix of a file, and what is known of its symmetry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wanted<'a> {
    /// Name of the matrix in the file, in any case where that is unique.
    pub name: Option<&'a str>,
    /// Role of the matrix, M, C or K, where the file holds several and no name is given.
    pub kind: Option<Kind>,
    /// Storage of the matrix in the file.
    pub symmetry: Option<Symmetry>,
    /// Storage of the matrix in the file, unless the file says it itself.
    pub otherwise: Option<Symmetry>,
}

impl File {
    /// The matrix that is meant: the matrix of the name; without a name the only matrix of the file, or the only matrix whose name is usual for
    /// that kind.
    ///
    /// # Errors
    /// [`FormatsError::NoSuchMatrix`], with the reason where it was left out or where several are meant;
    /// [`FormatsError::Several`]; as [`Matrix::with_symmetry`].
    pub fn take(self, wanted: &Wanted<'_>) -> Result<Matrix, FormatsError> {
        let at = self.place(wanted)?;
        let others = self.matrices.iter().enumerate().filter(|(other, _)| *other != at).map(|(_, matrix)| &matrix.name);
        let has_structural = others.chain(self.left_out.iter().map(|(name, _)| name)).any(|name| is_structural(name));
        let mut matrices = self.matrices;
        let mut taken = matrices.swap_remove(at).with_symmetry(wanted.symmetry, wanted.otherwise)?;
        // What dissipates is a matter of the stiffness: a mass or a damping beside it is complete.
        taken.beside_structural = has_structural && wanted.kind == Some(Kind::Stiffness);
        Ok(taken)
    }

    /// The matrix of this name, as [`File::take`] has it where nothing is said of its symmetry.
    ///
    /// # Errors
    /// As [`File::take`].
    pub fn matrix(&self, name: &str) -> Result<&Matrix, FormatsError> {
        self.decided(&Wanted { name: Some(name), ..Wanted::default() })
    }

    /// The matrix of this kind, as [`File::take`] has it where nothing is said of its symmetry.
    ///
    /// # Errors
    /// As [`File::take`].
    pub fn of_kind(&self, kind: Kind) -> Result<&Matrix, FormatsError> {
        self.decided(&Wanted { kind: Some(kind), ..Wanted::default() })
    }

    fn decided(&self, wanted: &Wanted<'_>) -> Result<&Matrix, FormatsError> {
        let matrix = &self.matrices[self.place(wanted)?];
        if matrix.stored == Stored::OneSide { Err(matrix.one_sided()) } else { Ok(matrix) }
    }

    /// The only matrix, by what the file says of its symmetry.
    ///
    /// # Errors
    /// As [`File::take`].
    pub fn only(self) -> Result<Matrix, FormatsError> {
        self.take(&Wanted::default())
    }

    /// Index in `matrices` of the matrix that is meant.
    fn place(&self, wanted: &Wanted<'_>) -> Result<usize, FormatsError> {
        let refused = |name: &str, reason: Option<&str>| FormatsError::NoSuchMatrix {
            name: crate::shortened::cut(name),
            reason: reason.map(str::to_owned),
            allowed: self.names(),
        };
        let left_out = |is: &dyn Fn(&str) -> bool| self.left_out.iter().find(|(name, _)| is(name));
        let those = |is: &dyn Fn(&Matrix) -> bool| -> Vec<usize> {
            self.matrices.iter().enumerate().filter(|(_, matrix)| is(matrix)).map(|(at, _)| at).collect()
        };
        if let Some(name) = wanted.name {
            let exact = those(&|matrix| matrix.name == name);
            let any_case = || those(&|matrix| matrix.name.eq_ignore_ascii_case(name));
            let found = if exact.is_empty() { any_case() } else { exact };
            let gone = left_out(&|other| other.eq_ignore_ascii_case(name)).map(|(_, reason)| reason.as_str());
            return match found.as_slice() {
                [at] => Ok(*at),
                [] => Err(refused(name, gone)),
                _ => Err(refused(name, Some("several have this name"))),
            };
        }
        if let Some(kind) = wanted.kind {
            let found = those(&|matrix| matrix.kind == Some(kind));
            let gone = left_out(&|other| kind_of(other) == Some(kind));
            let found = self.sizeable(found);
            match (found.as_slice(), gone) {
                ([at], None) => return Ok(*at),
                // Another one could be meant, and this one may be a part of it.
                (_, Some((name, reason))) => return Err(refused(name, Some(reason))),
                ([], None) => {}
                _ => return Err(refused(&kind.to_string(), Some("several have a name of this kind; say which"))),
            }
        }
        match (self.matrices.len(), wanted.kind) {
            (1, Some(kind)) if is_structural(&self.matrices[0].name) => {
                let reason = format!(
                    "the only one is {:?}, which is no viscous damping and no stiffness",
                    self.matrices[0].name
                );
                Err(refused(&kind.to_string(), Some(&reason)))
            }
            (1, Some(kind)) if self.names_another(kind) => {
                let name = &self.matrices[0].name;
                let reason =
                    format!("the only one is {name:?}, by its name another kind; FILE:{name} takes it nevertheless");
                Err(refused(&kind.to_string(), Some(&reason)))
            }
            (1, _) => Ok(0),
            (0, _) => Err(FormatsError::NoMatrix { left_out: self.left_out.clone() }),
            (_, Some(kind)) => Err(refused(&kind.to_string(), None)),
            (_, None) => Err(FormatsError::Several { names: self.names() }),
        }
    }

    /// True if the only matrix has a name of its own that is usual for another kind. A file may be called after its kind and used
    /// as another nevertheless: a mass as the stiffness of what turns.
    fn names_another(&self, kind: Kind) -> bool {
        self.matrices.first().and_then(|matrix| Some((matrix, kind_of(&matrix.name)?))).is_some_and(
            |(matrix, other)| {
                let is_by_file = matches!(self.format, Format::Coordinates | Format::AbaqusMatrixInput);
                other != kind && !(is_by_file && matrix.name == other.to_string())
            },
        )
    }

    /// The indices of `places` whose matrix may be a matrix of a model: square and larger than 1 x 1, as numbers `k` and `m` among
    /// variables of MATLAB are not. All of `places` where no matrix may be one.
    fn sizeable(&self, places: Vec<usize>) -> Vec<usize> {
        let is_sizeable =
            |at: &&usize| self.matrices[**at].rows > 1 && self.matrices[**at].rows == self.matrices[**at].columns;
        let sizeable: Vec<usize> = places.iter().filter(is_sizeable).copied().collect();
        if places.len() > 1 && !sizeable.is_empty() { sizeable } else { places }
    }

    fn names(&self) -> Vec<String> {
        self.matrices.iter().map(|matrix| matrix.name.clone()).collect()
    }
}

/// The file and the name of a matrix in it that `FILE:NAME` means. A file that exists as it is written has no name beside it.
#[must_use]
pub fn split_name(given: &Path) -> (&Path, Option<&str>) {
    if given.is_file() {
        return (given, None);
    }
    let Some(text) = given.to_str() else { return (given, None) };
    let colons = text.rmatch_indices(':').map(|(at, _)| (Path::new(&text[..at]), &text[at + 1..]));
    // The last colon that follows a file: drives of Windows and names of files may have some too.
    match colons.filter(|(_, name)| !name.is_empty()).find(|(file, _)| file.is_file()) {
        Some((file, name)) => (file, Some(name)),
        None => (given, None),
    }
}

/// Reads one matrix of the file that `FILE` or `FILE:NAME` means; a name there comes before the name of `wanted`.
///
/// # Errors
/// As [`read_with`] and [`File::take`].
pub fn read_one(given: &Path, wanted: &Wanted<'_>, options: Options<'_>) -> Result<Matrix, FormatsError> {
    let (file, name) = split_name(given);
    read_with(file, options)?.take(&Wanted { name: name.or(wanted.name), ..*wanted })
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

/// [`read`] with limits or progress.
///
/// # Errors
/// As [`read`].
pub fn read_with(path: &Path, options: Options<'_>) -> Result<File, FormatsError> {
    let (file, size) = open(path)?;
    let limits = options.limits.bounded();
    let contents = Contents::new(file, size, &limits, options.progress)?;
    let format = detect(&contents.head)?;
    let labels = if format.0 == Format::Coordinates { labels_beside(path, &limits)? } else { None };
    parse(contents, format, &limits, by_name(path), labels)
}

/// Reads all matrices of contents in memory, as [`read_with`]; of a list without a header `labels` are the names of the rows.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], labels: Option<Vec<Dof>>, options: Options<'_>) -> Result<File, FormatsError> {
    let Options { limits, progress } = options;
    let limits = limits.bounded();
    let contents = Contents::new(bytes, bytes.len() as u64, &limits, progress)?;
    let format = detect(&contents.head)?;
    parse(contents, format, &limits, ByName::default(), labels)
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

/// Facts in the name of a file.
#[derive(Default)]
struct ByName {
    kind: Option<Kind>,
    /// The file is one of CalculiX's, which hold the upper triangle.
    calculix: bool,
    /// The matrix is Abaqus's structural damping.
    structural: bool,
}

/// Facts that CalculiX and Abaqus put in the name of a file alone: `.sti`, `.mas`; `_STIF1.mtx`, `_MASS1.mtx`, `_DMPV1.mtx`, and for
/// structural damping `_DMPS1.mtx`.
fn by_name(path: &Path) -> ByName {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
    let name = name.strip_suffix(".GZ").unwrap_or(&name);
    let Some((stem, extension)) = name.rsplit_once('.') else { return ByName::default() };
    let last = stem.rsplit_once('_').map_or("", |(_, last)| last.trim_end_matches(|c: char| c.is_ascii_digit()));
    let kind = match (extension, last) {
        ("STI", _) | (_, "STIF") => Some(Kind::Stiffness),
        ("MAS", _) | (_, "MASS") => Some(Kind::Mass),
        (_, "DMPV") => Some(Kind::Damping),
        _ => None,
    };
    ByName { kind, calculix: matches!(extension, "STI" | "MAS"), structural: last == "DMPS" }
}

fn parse(
    contents: Contents<'_>,
    (format, endian): (Format, Endian),
    limits: &Limits,
    ByName { kind, calculix, structural }: ByName,
    labels: Option<Vec<Dof>>,
) -> Result<File, FormatsError> {
    let name = match kind {
        Some(kind) => kind.to_string(),
        None if structural => "structural damping".to_owned(),
        None => "matrix".to_owned(),
    };
    let listed = if calculix { Stated::Upper } else { Stated::Nothing };
    let Found { mut matrices, left_out } = match format {
        Format::MatrixMarket => in_text(contents, |lines| market::parse(lines, limits).map(Found::from))?,
        Format::Coordinates => in_text(contents, |lines| {
            coordinates::parse(lines, limits, (listed, &name, kind), labels).map(Found::from)
        })?,
        Format::AbaqusMatrixInput => in_text(contents, |lines| {
            Ok(Found { matrices: abaqus_matrices::parse(lines, limits, (&name, kind))?, left_out: Vec::new() })
        })?,
        Format::AbaqusSubstructure => in_text(contents, |lines| substructure::parse(lines, limits))?,
        Format::HarwellBoeing => in_text(contents, |lines| harwell_boeing::parse(lines, limits))?,
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
    for matrix in &mut matrices {
        matrix.kind = matrix.kind.or_else(|| kind_of(&matrix.name));
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
    let mut found = Found::default();
    if let Some(reason) = header.reason() {
        found.leave_out("matrix", reason);
        return Ok(found);
    }
    let (builder, size) = header.fill(bytes, limits)?;
    if bytes.first()?.is_some() {
        return Err(Problem::field("bytes after the array", "some", "none"));
    }
    found.keep("matrix", builder.finish(Stated::Array, Head::unlabelled("matrix", None, size)))?;
    Ok(found)
}
