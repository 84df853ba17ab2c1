//! Errors of reading and writing files, and places in a file.

use std::fmt;

use crate::problem::Problem;
use crate::shortened::cut;
use crate::symmetry::Symmetry;

/// Reason why a file gave no matrix, or why a mode shape could not be written. Every message is one line and does not name the file
/// that was asked for: the caller knows it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatsError {
    /// The file cannot be opened or read.
    #[error("cannot be read: {0}")]
    Open(#[source] std::io::Error),
    /// The output cannot be written.
    #[error("cannot be written: {0}")]
    Write(#[source] std::io::Error),
    /// A directory, a pipe or a device.
    #[error("it is {found}; allowed: a regular file")]
    NotRegular {
        /// "a directory" or "no regular file".
        found: &'static str,
    },
    /// The contents of no known format.
    #[error("{found}: none of the formats read here; allowed: {FORMATS}")]
    Unknown {
        /// The beginning of the file, shortened.
        found: String,
    },
    /// A known format that is not read.
    #[error("{what} is not read here; {advice}")]
    Refused {
        /// Description of the file.
        what: &'static str,
        /// Advice on what to do about it.
        advice: &'static str,
    },
    /// A fault at a place of a file.
    #[error("{place}: {problem}")]
    At {
        /// Place of the fault.
        place: Place,
        /// Fault at this place.
        problem: Box<Problem>,
    },
    /// The file of labels beside a matrix is at fault.
    #[error("the labels in {file}: {source}")]
    Labels {
        /// Name of the file of labels, without its folder.
        file: String,
        /// Fault of the file of labels.
        #[source]
        source: Box<FormatsError>,
    },
    /// A file that a deck includes is at fault.
    #[error("in {file}, which it includes: {source}")]
    Included {
        /// The file, as the deck names it, shortened.
        file: String,
        /// Fault of the included file.
        #[source]
        source: Box<FormatsError>,
    },
    /// The file is whole but holds no matrix of real numbers.
    #[error("the file holds no matrix that can be read{}", what_else(.left_out))]
    NoMatrix {
        /// Contents that are no such matrix: names, each with the reason why it was left out.
        left_out: Vec<(String, String)>,
    },
    /// A matrix by a name that the file does not hold, or holds but cannot give.
    #[error("no matrix {name:?}{}; allowed: {}", because(.reason), listed(.allowed))]
    NoSuchMatrix {
        /// The name asked for.
        name: String,
        /// Reason why the matrix was left out, where it is in the file.
        reason: Option<String>,
        /// The names of the matrices that were read.
        allowed: Vec<String>,
    },
    /// A single matrix was asked for where the file holds several.
    #[error("the file holds {} matrices; say which: {}", .names.len(), listed(.names))]
    Several {
        /// Names of these matrices.
        names: Vec<String>,
    },
    /// Entries on one side of the diagonal, of which nothing says what they are.
    #[error(
        "the matrix \"{matrix}\" {}, and nothing says whether these are a triangle of a symmetric matrix or all of an \
         unsymmetric one, such as friction; allowed: {}", what_is_there(*.side), ways_to_say(*.side)
    )]
    OneSided {
        /// The matrix.
        matrix: String,
        /// The side that has entries; `None` where they are on both, but none has a mirror image.
        side: Option<Symmetry>,
    },
    /// Entries of which some have an equal mirror image and others have none, of which nothing says what they are.
    #[error(
        "the matrix \"{matrix}\" has an entry at {alone} without a mirror image and an equal pair at {paired}, and nothing says whether these are a triangle of \
         a symmetric matrix that gives some entries twice, or all of an unsymmetric one, such as friction; allowed: symmetry = \"whole\" to take them as they \
         are, or a file that lists either one triangle or both"
    )]
    PartlyMirrored {
        /// The matrix.
        matrix: String,
        /// Row and column of the first entry without a mirror image: labels, or numbers from 1.
        alone: String,
        /// Row and column of the first entry with one.
        paired: String,
    },
    /// A word on the symmetry of a matrix that its file or its entries contradict.
    #[error("symmetry = \"{asked}\" of the matrix \"{matrix}\", which is {found}; allowed: {}", others(*.asked))]
    Symmetry {
        /// The matrix.
        matrix: String,
        /// Symmetry that was stated.
        asked: Symmetry,
        /// Description of the matrix that contradicts it.
        found: String,
    },
    /// A degree of freedom of a matrix that the list it is to be ordered by does not have.
    #[error("the matrix \"{matrix}\" has the degree of freedom {dof}, which the given list lacks")]
    UnknownDof {
        /// The matrix.
        matrix: String,
        /// The label.
        dof: String,
    },
    /// A matrix without labels where labels are needed.
    #[error("the rows or columns of the matrix \"{matrix}\" have no labels")]
    Unlabelled {
        /// The matrix.
        matrix: String,
    },
    /// A matrix of a model with rows of which no other one has any.
    #[error(
        "the matrix \"{matrix}\" has {rows} rows, as {row}, and none of them is in any other matrix; allowed: matrices of one model, whose rows have the \
         same names"
    )]
    Apart {
        /// The matrix.
        matrix: String,
        /// Number of its rows.
        rows: usize,
        /// The first of them.
        row: String,
    },
    /// A mesh or mode shape that cannot be written.
    #[error("{what} {found}; allowed: {allowed}")]
    Shape {
        /// Subject of the fault.
        what: &'static str,
        /// Description of what was found.
        found: String,
        /// Description of what is allowed.
        allowed: String,
    },
}

/// The formats, in messages.
const FORMATS: &str = "Matrix Market, CalculiX .sti or .mas, Abaqus MATRIX INPUT or USER ELEMENT, Nastran DMIG or OP4, \
                       Harwell-Boeing, MATLAB .mat to v7, NumPy .npy or .npz, each also as .gz";

/// A line from 1, or a byte from 0, of the contents after decompression.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// A line of a text file, from 1.
    Line(usize),
    /// A byte of a binary file, from 0.
    Byte(u64),
    /// A byte of a member of an archive.
    Member {
        /// Name of the member.
        name: String,
        /// Byte in the member, from 0.
        byte: u64,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Member { name, byte } => write!(f, "member {:?}, byte {byte}", cut(name)),
        }
    }
}

fn listed(names: &[String]) -> String {
    /// Most names that a message lists; chosen.
    const MOST_NAMES: usize = 10;
    let mut list: Vec<_> = names.iter().take(MOST_NAMES).map(|name| cut(name)).collect();
    if names.len() > MOST_NAMES {
        list.push("...".to_owned());
    }
    list.join(", ")
}

fn what_else(left_out: &[(String, String)]) -> String {
    /// Most matrices left out that a message explains; chosen.
    const MOST_REASONS: usize = 3;
    let mut each: Vec<_> =
        left_out.iter().take(MOST_REASONS).map(|(name, why)| format!("{}: {why}", cut(name))).collect();
    if left_out.len() > MOST_REASONS {
        each.push("...".to_owned());
    }
    if each.is_empty() { String::new() } else { format!(" ({})", each.join("; ")) }
}

fn what_is_there(side: Option<Symmetry>) -> &'static str {
    match side {
        Some(Symmetry::Upper) => "has entries above the diagonal only",
        Some(_) => "has entries below the diagonal only",
        None => "has entries without mirror images",
    }
}

fn ways_to_say(side: Option<Symmetry>) -> String {
    let triangle = match side {
        Some(side) => format!("symmetry = \"{side}\" to mirror them"),
        None => "symmetry = \"triangle\" to mirror them".to_owned(),
    };
    format!("symmetry = \"whole\" to take them as they are, {triangle}")
}

fn others(asked: Symmetry) -> String {
    let others = Symmetry::NAMES.into_iter().filter(|(_, other)| *other != asked);
    others.map(|(name, _)| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

fn because(reason: &Option<String>) -> String {
    reason.as_ref().map_or_else(String::new, |reason| format!(" was read ({reason})"))
}
