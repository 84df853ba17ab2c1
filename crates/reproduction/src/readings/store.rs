//! Store of rows, so that none is run twice.

use std::path::{Path, PathBuf};

use brakes::case::LatticeCase;
use output::{make_folder, write};

use super::row::Row;
use super::run::{Stage, run_together};
use crate::Error;

/// Version of the rows: it changes when rows of an older program are no longer right.
const FORMAT: u32 = 3;

/// The rows that a folder holds, one file for each group of combinations that were run together.
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// The rows in `out`.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn new(out: &Path) -> Result<Self, Error> {
        let folder = out.join("rows");
        make_folder(&folder)?;
        Ok(Self { folder })
    }

    fn path(&self, cases: &[LatticeCase]) -> PathBuf {
        let of_case = |case: &LatticeCase| format!("{} {} {}", case.identity(), case.header.seed, case.header.samples);
        let cases: Vec<String> = cases.iter().map(of_case).collect();
        let key = format!("{} {FORMAT} {}", cases.join(" "), env!("CARGO_PKG_VERSION"));
        self.folder.join(format!("{}.json", &squeal::fingerprint(&key)[..16]))
    }

    /// The row of each of `cases`, if they have been run. A file that is damaged is run again.
    pub fn known(&self, cases: &[LatticeCase]) -> Option<Vec<Row>> {
        let rows: Vec<Row> = serde_json::from_slice(&std::fs::read(self.path(cases)).ok()?).ok()?;
        (rows.len() == cases.len()).then_some(rows)
    }

    /// The row of each of `cases`; runs them together if they have not been run, and keeps the rows.
    ///
    /// # Errors
    /// A file that cannot be written. A study that fails is a row that says why.
    pub fn rows(&self, cases: Vec<LatticeCase>, stage: Stage) -> Result<Vec<Row>, Error> {
        if let Some(rows) = self.known(&cases) {
            return Ok(rows);
        }
        let path = self.path(&cases);
        let rows = run_together(cases, stage);
        write(&path, &serde_json::to_vec(&rows).unwrap_or_default())?;
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_run_once_and_damaged_ones_again() {
        let mut case =
            LatticeCase::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/two-by-two.toml")).unwrap();
        case.header.samples = 8;
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path()).unwrap();
        let cases = vec![case.clone()];
        assert_eq!(store.known(&cases), None);
        let rows = store.rows(cases.clone(), Stage::Coarse).unwrap();
        let [row] = &rows[..] else { panic!("{} rows", rows.len()) };
        assert_eq!((row.samples, row.refused.as_deref(), row.cards.len()), (8, None, 15));
        assert_eq!(Store::new(folder.path()).unwrap().known(&cases), Some(rows.clone()));

        let mut other = case.clone();
        other.header.samples = 9;
        assert_eq!(store.known(&[other]), None);
        assert_eq!(store.known(&[case.clone(), case]), None);
        let path = store.path(&cases);
        let text = std::fs::read(&path).unwrap();
        std::fs::write(&path, &text[..text.len() / 2]).unwrap();
        assert_eq!(store.known(&cases), None);
        assert_eq!(store.rows(cases, Stage::Coarse).unwrap()[0].cards, rows[0].cards);
    }
}
