//! Whether a file lists the whole of a matrix, or one triangle of a symmetric matrix, whose other triangle is made by mirroring it.

use std::fmt;

use crate::entry::Entry;

/// Storage of a matrix in a file. [`Matrix::entries`](crate::Matrix::entries) has the entries of the whole matrix whatever the storage, but for `OneSide`:
/// then it has the entries of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    /// Every entry of the matrix.
    Whole,
    /// A triangle of a symmetric matrix; the reader has mirrored it.
    Triangle,
    /// The lower triangle of a skew-symmetric matrix; the reader has mirrored it with the other sign.
    SkewTriangle,
    /// Entries on one side of the diagonal, or on both of which none has a mirror image, or of which some have an equal one: nothing says whether they are
    /// a triangle of a symmetric matrix, perhaps with its rows in another order or with an entry given twice, or an unsymmetric matrix (such as friction
    /// forces); nothing has been mirrored. [`Matrix::with_symmetry`](crate::Matrix::with_symmetry) decides.
    OneSide,
}

/// Source of what is known of the storage of a matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KnownBy {
    /// The file: its format, or a word in it.
    File,
    /// The entries of the matrix.
    Contents,
    /// The caller, who reads it.
    Request,
}

/// Storage of a matrix in a file, as the caller knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// Every entry: what is not listed is zero.
    Whole,
    /// The upper triangle of a symmetric matrix, to be mirrored.
    Upper,
    /// The lower triangle of a symmetric matrix, to be mirrored.
    Lower,
    /// Each entry of a symmetric matrix or its mirror image, to be mirrored: a triangle with its rows in any order.
    Triangle,
}

impl Symmetry {
    /// Names of the four, each with its value.
    pub const NAMES: [(&'static str, Self); 4] =
        [("whole", Self::Whole), ("upper", Self::Upper), ("lower", Self::Lower), ("triangle", Self::Triangle)];

    /// The symmetry of a name; `None` of another word.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.into_iter().find(|(own, _)| *own == name).map(|(_, symmetry)| symmetry)
    }
}

impl fmt::Display for Symmetry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Whole => "whole",
            Self::Upper => "upper",
            Self::Lower => "lower",
            Self::Triangle => "triangle",
        })
    }
}

/// Oddity in how a matrix was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doubt {
    /// The file says that it lists the whole matrix, but entries off the diagonal are on this side of it alone, and the diagonal has an
    /// entry in each of their rows and columns: probably a triangle that was written under the wrong word.
    Triangle(Symmetry),
    /// The file says that it lists the whole matrix, whose entries off the diagonal have equal mirror images, but for some that have none, all on
    /// one side of it: perhaps a triangle in which some entries are given twice.
    PartlyMirrored,
    /// The last line has no end: a file that was cut inside its last number looks like that.
    NoEnd,
    /// The file says that the matrix is symmetric, and its two sides differ.
    NotSymmetric,
    /// The matrix is a stiffness, and the file has a structural damping matrix too.
    BesideStructural,
}

impl Doubt {
    /// True if a word on the symmetry of the matrix settles it.
    #[must_use]
    pub fn is_of_symmetry(self) -> bool {
        matches!(self, Self::Triangle(_) | Self::PartlyMirrored | Self::NotSymmetric)
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Triangle(side) => {
                let place = if *side == Symmetry::Upper { "above" } else { "below" };
                write!(
                    f,
                    "it is taken as whole, as the file says, and has entries {place} the diagonal only; if it is a triangle of a \
                     symmetric matrix, say symmetry = \"{side}\", else \"whole\""
                )
            }
            Self::PartlyMirrored => f.write_str(
                "it is taken as whole, as the file says, and is symmetric but for entries on one side of the diagonal that have no mirror image; if \
                 that is meant, as of friction, say symmetry = \"whole\"",
            ),
            Self::NoEnd => {
                f.write_str("its last line has no end, as of a file that was cut inside its last number; a whole file ends with a line end")
            }
            Self::NotSymmetric => f.write_str(
                "the file says that it is symmetric, and its entries above and below the diagonal differ; it is taken as it is listed; if \
                 that is meant, as of friction, say symmetry = \"whole\"",
            ),
            Self::BesideStructural => f.write_str(
                "the file has structural damping too, which is NOT read: a loss_factor of the stiffness, or viscous damping, stands for it",
            ),
        }
    }
}

/// Sides of the diagonal on which there are entries that are not zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Sides {
    pub above: bool,
    pub below: bool,
}

impl Sides {
    pub fn of(entries: &[Entry]) -> Self {
        let mut listed = entries.iter().filter(|entry| entry.value != 0.0);
        let (mut above, mut below) = (false, false);
        while let (false, Some(entry)) = (above && below, listed.next()) {
            above |= entry.row < entry.column;
            below |= entry.row > entry.column;
        }
        Self { above, below }
    }

    /// The only side, where there is but one.
    pub fn only(self) -> Option<Symmetry> {
        match (self.above, self.below) {
            (true, false) => Some(Symmetry::Upper),
            (false, true) => Some(Symmetry::Lower),
            _ => None,
        }
    }
}

impl Doubt {
    /// The doubt about entries, without repeats, that a file calls all of a square matrix.
    pub(crate) fn of_whole(entries: &[Entry], order: usize, sides: Sides) -> Option<Self> {
        let Some(side) = sides.only() else {
            let pairs = Pairs::of(entries);
            let is_partly = pairs.given_twice > 0 && !pairs.unsymmetric && pairs.alone.only().is_some();
            return is_partly.then_some(Self::PartlyMirrored);
        };
        let mut on_diagonal = vec![false; order];
        let listed = || entries.iter().filter(|entry| entry.value != 0.0);
        listed().filter(|entry| entry.row == entry.column).for_each(|entry| on_diagonal[entry.row as usize] = true);
        let mut beside = listed().filter(|entry| entry.row != entry.column);
        let is_like_one = beside.all(|entry| on_diagonal[entry.row as usize] && on_diagonal[entry.column as usize]);
        is_like_one.then_some(Self::Triangle(side))
    }
}

/// The mirror images of what is off the diagonal, sorted.
pub(crate) fn mirrored(entries: &[Entry]) -> Vec<Entry> {
    let mut images: Vec<Entry> =
        entries.iter().filter(|entry| entry.row != entry.column).map(|entry| entry.mirrored()).collect();
    images.sort_by_key(Entry::key);
    images
}

/// Largest difference of an entry and its mirror image, as a part of the largest entry off the diagonal, of a matrix that is symmetric but for rounding; chosen.
const ROUNDING: f64 = 1e-9;

/// Largest `|a_ij - a_ji|` of sorted entries of a square matrix.
pub(crate) fn asymmetry(entries: &[Entry]) -> f64 {
    let mut mirrored: Vec<Entry> = entries.iter().map(|entry| entry.mirrored()).collect();
    mirrored.sort_by_key(Entry::key);
    let (mut ours, mut theirs) = (entries.iter().peekable(), mirrored.iter().peekable());
    let mut largest = 0.0_f64;
    loop {
        let difference = match (ours.peek(), theirs.peek()) {
            (None, None) => return largest,
            (Some(a), Some(b)) if a.key() == b.key() => {
                let difference = a.value - b.value;
                ours.next();
                theirs.next();
                difference
            }
            (Some(a), b) if b.is_none_or(|b| a.key() < b.key()) => ours.next().map_or(0.0, |a| a.value),
            _ => theirs.next().map_or(0.0, |b| b.value),
        };
        largest = largest.max(difference.abs());
    }
}

/// True if sorted entries of a square matrix are symmetric but for rounding.
pub(crate) fn is_symmetric(entries: &[Entry]) -> bool {
    let beside = entries.iter().filter(|entry| entry.row != entry.column);
    asymmetry(entries) <= ROUNDING * beside.map(|entry| entry.value.abs()).fold(0.0, f64::max)
}

/// Entries off the diagonal whose mirror images are in the list too, and those whose are not.
#[derive(Default)]
pub(crate) struct Pairs {
    /// Number of entries with an image; an entry and its image are both counted.
    pub given_twice: usize,
    /// Row and column, from 0, of the first entry with an image.
    pub first: Option<(u32, u32)>,
    /// An entry differs from its image.
    pub unequal: bool,
    /// An entry differs from its image by more than rounding, so that the matrix is not symmetric whatever a file may leave out.
    pub unsymmetric: bool,
    /// Sides on which entries larger than rounding have no image.
    pub alone: Sides,
    /// Row and column, from 0, of the first of these.
    pub first_alone: Option<(u32, u32)>,
}

impl Pairs {
    /// The pairs of sorted entries. In columns from the left to the right, the images of the entries of a row come in the order of that column's rows.
    pub fn of(entries: &[Entry]) -> Self {
        let order = entries.iter().map(|entry| entry.row.max(entry.column) as usize + 1).max().unwrap_or(0);
        let mut next = vec![0_usize; order + 1];
        entries.iter().for_each(|entry| next[entry.column as usize + 1] += 1);
        (0..order).for_each(|column| next[column + 1] += next[column]);
        let ends = next[1..].to_vec();
        let beside = || entries.iter().filter(|entry| entry.row != entry.column);
        let rounding = ROUNDING * beside().map(|entry| entry.value.abs()).fold(0.0, f64::max);
        let mut found = Self::default();
        for entry in beside() {
            let (at, end) = (&mut next[entry.row as usize], ends[entry.row as usize]);
            while *at < end && entries[*at].row < entry.column {
                *at += 1;
            }
            match entries[*at..end].first().filter(|image| image.row == entry.column) {
                Some(image) => {
                    found.given_twice += 1;
                    found.first.get_or_insert((entry.row, entry.column));
                    found.unequal |= image.value != entry.value;
                    found.unsymmetric |= (image.value - entry.value).abs() > rounding;
                }
                None if entry.value.abs() > rounding => {
                    found.alone.above |= entry.row < entry.column;
                    found.alone.below |= entry.row > entry.column;
                    found.first_alone.get_or_insert((entry.row, entry.column));
                }
                None => {}
            }
        }
        found
    }
}
