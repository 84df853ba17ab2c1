//! Assembly of a whole matrix from entries in the order of a file: repeats added, a triangle mirrored.

use std::collections::HashMap;

use crate::Dof;
use crate::entry::Entry;
use crate::limits::Limits;
use crate::matrix::{Kind, Matrix};
use crate::problem::Problem;
use crate::symmetry::{Doubt, KnownBy, Pairs, Sides, Stored, is_symmetric, mirrored};

/// The symmetry of the entries that a file lists, as it states it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stated {
    /// No symmetry: every entry is listed.
    General,
    /// A symmetric matrix as one triangle, either.
    Symmetric,
    /// A skew-symmetric matrix as one triangle.
    Skew,
    /// A symmetric matrix as one triangle or whole.
    SymmetricOrWhole,
    /// A symmetric matrix, by a default that a writer may not have thought of.
    SymmetricByDefault,
    /// The upper triangle, as CalculiX writes it, unless there are entries below the diagonal.
    Upper,
    /// No statement, in a list of entries, as programs write triangles too.
    Nothing,
    /// No statement, in an array or its like.
    Array,
    /// A symmetric matrix, in an array or its like.
    SymmetricArray,
}

/// Entries of a matrix in the order of the file.
pub(crate) struct Builder {
    entries: Vec<Entry>,
    most: usize,
    /// The largest imaginary part, of complex numbers.
    largest_imaginary: f64,
}

/// Name, kind, size and labels of a matrix: all but its entries.
pub(crate) struct Head {
    pub name: String,
    pub kind: Option<Kind>,
    pub rows: usize,
    pub columns: usize,
    pub row_labels: Option<Vec<Dof>>,
    pub column_labels: Option<Vec<Dof>>,
}

impl Head {
    pub fn unlabelled(name: impl Into<String>, kind: Option<Kind>, (rows, columns): (usize, usize)) -> Self {
        Self { name: name.into(), kind, rows, columns, row_labels: None, column_labels: None }
    }
}

impl Builder {
    pub fn new(limits: &Limits) -> Self {
        Self { entries: Vec::new(), most: limits.entries, largest_imaginary: 0.0 }
    }

    /// Makes room for `entries` entries, of which the file has shown that they are there.
    pub fn reserve(&mut self, entries: usize) {
        self.entries.reserve(entries.min(self.most));
    }

    /// Adds an entry; indices from 0, checked by the caller against a size within [`Limits::order`].
    pub fn push(&mut self, row: usize, column: usize, value: f64) -> Result<(), Problem> {
        if !value.is_finite() {
            return Err(Problem::Value { found: value.to_string(), allowed: "a finite number" });
        }
        if self.entries.len() >= self.most {
            return Err(limit(self.most));
        }
        self.entries.push(Entry { row: row as u32, column: column as u32, value });
        Ok(())
    }

    /// Notes the imaginary part of an entry, of which only the largest is kept: a matrix is real where all of them are 0.
    pub fn note_imaginary(&mut self, value: f64) -> Result<(), Problem> {
        if !value.is_finite() {
            return Err(Problem::Value { found: value.to_string(), allowed: "a finite number" });
        }
        self.largest_imaginary = self.largest_imaginary.max(value.abs());
        Ok(())
    }

    /// The matrix: whole, or as it is listed where nothing tells whether that is a triangle.
    pub fn finish(self, stated: Stated, head: Head) -> Result<Matrix, Problem> {
        let Self { mut entries, most, largest_imaginary } = self;
        if largest_imaginary > 0.0 {
            return Err(Problem::Complex { largest: largest_imaginary });
        }
        add_repeats(&mut entries)?;
        let (stored, known_by, doubt) = expand(&mut entries, stated, &head)?;
        // What is not mirrored yet may be so later.
        let needed = if stored == Stored::OneSide { 2 * entries.len() } else { entries.len() };
        if needed > most {
            return Err(limit(most));
        }
        entries.shrink_to_fit();
        let Head { name, kind, rows, columns, row_labels, column_labels } = head;
        let (numbered, ended, beside_structural) = (false, true, false);
        Ok(Matrix {
            name,
            kind,
            stored,
            known_by,
            doubt,
            ended,
            beside_structural,
            numbered,
            rows,
            columns,
            entries,
            row_labels,
            column_labels,
        })
    }
}

fn limit(most: usize) -> Problem {
    Problem::Limit { what: "entries of a matrix", most: most as u64 }
}

/// Sorts by column and row and adds what is repeated, in the order of the file.
fn add_repeats(entries: &mut Vec<Entry>) -> Result<(), Problem> {
    entries.sort_by_key(Entry::key);
    entries.dedup_by(|later, earlier| {
        let same = later.key() == earlier.key();
        if same {
            earlier.value += later.value;
        }
        same
    });
    match entries.iter().find(|entry| !entry.value.is_finite()) {
        None => Ok(()),
        Some(entry) => {
            let found = format!("{:e}, the sum at ({}, {})", entry.value, entry.row + 1, entry.column + 1);
            Err(Problem::Value { found, allowed: "a finite number" })
        }
    }
}

/// Mirrors what the file says is a triangle. What it says nothing of is left as it is: a matrix with entries and mirror images of them is whole, and of
/// one without any nobody but its owner knows.
fn expand(entries: &mut Vec<Entry>, stated: Stated, head: &Head) -> Result<(Stored, KnownBy, Option<Doubt>), Problem> {
    let square = head.rows == head.columns;
    let sides = Sides::of(entries);
    // One whose sides differ in value is no symmetric matrix. Of a list each entry else needs its mirror image; an array lists all there are, so that
    // it is whole also where entries without one are on both sides.
    let by_contents = |is_list: bool| {
        let is_whole = match sides {
            Sides { above: false, below: false } => true,
            Sides { above: true, below: true } => {
                let pairs = Pairs::of(entries);
                pairs.unsymmetric || pairs.first_alone.is_none() || !is_list && pairs.alone.only().is_none()
            }
            _ => false,
        };
        let stored = if is_whole || !square { Stored::Whole } else { Stored::OneSide };
        Ok((stored, KnownBy::Contents, None))
    };
    match stated {
        Stated::General => {
            let doubt = if square { Doubt::of_whole(entries, head.rows, sides) } else { None };
            return Ok((Stored::Whole, KnownBy::File, doubt));
        }
        Stated::Array => return by_contents(false),
        // An array lists both sides; one whose sides differ is not what the file calls it.
        Stated::SymmetricArray => {
            let (stored, known_by, _) = by_contents(false)?;
            let doubt = stored == Stored::Whole && !is_symmetric(entries);
            return Ok((stored, known_by, doubt.then_some(Doubt::NotSymmetric)));
        }
        Stated::Nothing => return by_contents(true),
        Stated::Upper if sides.below => return by_contents(true),
        Stated::Symmetric | Stated::Skew | Stated::SymmetricOrWhole | Stated::SymmetricByDefault | Stated::Upper => {}
    }
    let images = mirrored(entries);
    let pairs = Pairs::of(entries);
    let both = |allowed| {
        let (row, column) = pairs.first.unwrap_or_default();
        let (row, column) = (place(head.row_labels.as_deref(), row), place(head.column_labels.as_deref(), column));
        Problem::BothTriangles { matrix: head.name.clone(), row, column, pairs: pairs.given_twice / 2, allowed }
    };
    // An entry and its mirror image are both counted, so that these two compare like with like.
    let is_whole = pairs.given_twice == images.len() && !pairs.unequal;
    match stated {
        Stated::SymmetricByDefault if images.is_empty() => return Ok((Stored::Whole, KnownBy::Contents, None)),
        Stated::SymmetricByDefault if pairs.given_twice == 0 => return Ok((Stored::OneSide, KnownBy::Contents, None)),
        Stated::SymmetricByDefault if is_whole => return Ok((Stored::Whole, KnownBy::Contents, None)),
        _ if pairs.given_twice == 0 => {}
        Stated::SymmetricOrWhole if is_whole => return Ok((Stored::Whole, KnownBy::File, None)),
        Stated::SymmetricOrWhole | Stated::SymmetricByDefault => {
            return Err(both("one triangle of a symmetric matrix, or both with equal values"));
        }
        _ => return Err(both("one triangle of a symmetric matrix, upper or lower")),
    }
    let sign = if stated == Stated::Skew { -1.0 } else { 1.0 };
    entries.extend(images.into_iter().map(|entry| Entry { value: sign * entry.value, ..entry }));
    entries.sort_by_key(Entry::key);
    Ok((if stated == Stated::Skew { Stored::SkewTriangle } else { Stored::Triangle }, KnownBy::File, None))
}

/// The name of a row or column: its label, or its number from 1.
pub(crate) fn place(labels: Option<&[Dof]>, at: u32) -> String {
    labels.and_then(|all| all.get(at as usize)).map_or_else(|| (at + 1).to_string(), Dof::to_string)
}

/// Labels in the order in which they come, and their indices once they are sorted.
#[derive(Default)]
pub(crate) struct LabelSet {
    index: HashMap<Dof, u32>,
    list: Vec<Dof>,
}

impl LabelSet {
    /// The number of this label, a new one where it is new.
    pub fn number(&mut self, dof: Dof, limits: &Limits) -> Result<usize, Problem> {
        let next = self.list.len();
        let number = *self.index.entry(dof).or_insert(next as u32) as usize;
        if number == next {
            if next >= limits.order {
                return Err(Problem::Limit { what: "degrees of freedom", most: limits.order as u64 });
            }
            self.list.push(dof);
        }
        Ok(number)
    }

    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// The labels by node and direction, and the index of each number among them.
    pub fn sorted(self) -> (Vec<Dof>, Vec<u32>) {
        let mut order: Vec<u32> = (0..self.list.len() as u32).collect();
        order.sort_by_key(|&number| self.list[number as usize]);
        let mut places = vec![0; order.len()];
        for (place, &number) in (0_u32..).zip(&order) {
            places[number as usize] = place;
        }
        (order.iter().map(|&number| self.list[number as usize]).collect(), places)
    }
}

impl Builder {
    /// Gives every row and column another index.
    pub fn place(&mut self, place: impl Fn(u32) -> u32) {
        for entry in &mut self.entries {
            (entry.row, entry.column) = (place(entry.row), place(entry.column));
        }
    }

    /// Gives every row and column the index of its label.
    pub fn renumber(&mut self, rows: &[u32], columns: &[u32]) {
        for entry in &mut self.entries {
            (entry.row, entry.column) = (rows[entry.row as usize], columns[entry.column as usize]);
        }
    }

    /// Number of entries so far.
    pub fn len(&self) -> usize {
        self.entries.len()
    }
}

/// The matrices of a file, and what was left out with the reason.
#[derive(Default)]
pub(crate) struct Found {
    pub matrices: Vec<Matrix>,
    pub left_out: Vec<(String, String)>,
}

impl Found {
    /// Keeps a matrix, or the reason why it is no matrix of real numbers.
    pub fn keep(&mut self, name: &str, read: Result<Matrix, Problem>) -> Result<(), Problem> {
        match read {
            Ok(matrix) => self.matrices.push(matrix),
            Err(problem @ Problem::Complex { .. }) => self.leave_out(name, problem.to_string()),
            Err(problem) => return Err(problem),
        }
        Ok(())
    }

    pub fn leave_out(&mut self, name: &str, reason: impl Into<String>) {
        self.left_out.push((name.to_owned(), reason.into()));
    }
}

impl From<Matrix> for Found {
    fn from(matrix: Matrix) -> Self {
        Self { matrices: vec![matrix], left_out: Vec::new() }
    }
}
