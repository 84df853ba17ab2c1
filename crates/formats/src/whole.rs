//! A matrix made whole: mirrored where its file lists one triangle of it.

use crate::FormatsError;
use crate::builder::place;
use crate::entry::Entry;
use crate::matrix::Matrix;
use crate::symmetry::{KnownBy, Pairs, Sides, Stored, Symmetry, mirrored};

impl Matrix {
    /// Description of how the entries of the file were taken: `one triangle, mirrored, as the file says`.
    #[must_use]
    pub fn taken(&self) -> String {
        let by = match self.known_by {
            KnownBy::File => ", as the file says",
            KnownBy::Request => ", as asked",
            KnownBy::Contents if self.rows != self.columns => "",
            KnownBy::Contents if self.entries.iter().any(|entry| entry.row != entry.column && entry.value != 0.0) => {
                ", as it has entries on both sides of the diagonal"
            }
            KnownBy::Contents => ", as it has no entry off the diagonal",
        };
        match self.stored {
            Stored::Whole => format!("whole{by}"),
            Stored::Triangle => format!("one triangle, mirrored{by}"),
            Stored::SkewTriangle => format!("one triangle, mirrored with the other sign{by}"),
            Stored::OneSide if Pairs::of(&self.entries).given_twice > 0 => {
                "not decided: some entries have a mirror image".to_owned()
            }
            Stored::OneSide => "not decided: no entry has a mirror image".to_owned(),
        }
    }

    /// The whole matrix, mirrored where its file lists one triangle. The first of these that says something decides whether it does: `asked`,
    /// the file itself, `otherwise`, the entries.
    ///
    /// # Errors
    /// [`FormatsError::OneSided`] and [`FormatsError::PartlyMirrored`] where nothing tells a triangle from an unsymmetric matrix;
    /// [`FormatsError::Symmetry`] where what is asked for contradicts the file or the entries.
    pub fn with_symmetry(self, asked: Option<Symmetry>, otherwise: Option<Symmetry>) -> Result<Self, FormatsError> {
        let refused = |asked: Symmetry, found: &str| FormatsError::Symmetry {
            matrix: crate::shortened::cut(&self.name),
            asked,
            found: found.to_owned(),
        };
        let is_triangle = matches!(self.stored, Stored::Triangle | Stored::SkewTriangle);
        let said = match (asked, is_triangle) {
            (Some(Symmetry::Whole), true) => {
                return Err(refused(Symmetry::Whole, "a triangle of a symmetric matrix, as the file says"));
            }
            (_, true) => return Ok(self),
            _ if self.known_by == KnownBy::File && self.doubt.is_none() => asked,
            _ => asked.or(otherwise),
        };
        let side = match said {
            None if self.stored == Stored::OneSide => return Err(self.one_sided()),
            None => return Ok(self),
            Some(Symmetry::Whole) => {
                return Ok(Self { stored: Stored::Whole, known_by: KnownBy::Request, doubt: None, ..self });
            }
            Some(side) => side,
        };
        if self.rows != self.columns {
            return Err(refused(side, &format!("{} x {}", self.rows, self.columns)));
        }
        let sides = Sides::of(&self.entries);
        match (side, sides) {
            (_, Sides { above: false, below: false }) => return Ok(self),
            (Symmetry::Upper, Sides { below: true, .. }) => {
                return Err(refused(side, "with entries below the diagonal"));
            }
            (Symmetry::Lower, Sides { above: true, .. }) => {
                return Err(refused(side, "with entries above the diagonal"));
            }
            (Symmetry::Triangle, _) if Pairs::of(&self.entries).given_twice > 0 => {
                return Err(refused(side, "with entries and their mirror images"));
            }
            _ => {}
        }
        let mut entries: Vec<Entry> =
            self.entries.iter().filter(|entry| entry.row == entry.column || entry.value != 0.0).copied().collect();
        entries.extend(mirrored(&entries));
        entries.sort_by_key(Entry::key);
        Ok(Self { entries, stored: Stored::Triangle, known_by: KnownBy::Request, doubt: None, ..self })
    }

    /// The refusal of entries without mirror images, a triangle or not, where nothing decides.
    pub(crate) fn one_sided(&self) -> FormatsError {
        let matrix = crate::shortened::cut(&self.name);
        let pairs = Pairs::of(&self.entries);
        let named =
            |(row, column)| format!("({}, {})", place(self.row_labels(), row), place(self.column_labels(), column));
        match (pairs.first_alone, pairs.first) {
            (Some(alone), Some(paired)) => {
                FormatsError::PartlyMirrored { matrix, alone: named(alone), paired: named(paired) }
            }
            _ => FormatsError::OneSided { matrix, side: Sides::of(&self.entries).only() },
        }
    }
}
