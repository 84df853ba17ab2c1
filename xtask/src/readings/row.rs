//! One combination of readings, run: what is kept of it, and where.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};
use squeal::Error;
use squeal::brakes::LatticeBrake;
use squeal::case::LatticeCase;
use squeal::output::{make_folder, write};
use squeal::report::{Claim, Judgement, Results, claims, claims_judged};
use squeal::study::{ModeIdentity, ModeNaming, Study};

use crate::error::TaskError;

/// Changes when rows of an older program are no longer right.
const FORMAT: u32 = 1;

/// A study of one combination, with a scorecard for each way of naming its modes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Draws.
    pub samples: u64,
    /// Draws or evaluations that failed.
    pub failures: u64,
    /// How long it took.
    pub seconds: f64,
    /// Why there is no scorecard, if there is none.
    pub refused: Option<String>,
    /// The scorecards.
    pub cards: Vec<Card>,
}

/// The scorecard under one way of naming modes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Card {
    /// How modes are named.
    pub naming: String,
    /// One for each claim.
    pub claims: Vec<Cell>,
}

/// One claim.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// C1, C2, ...
    pub id: String,
    /// "yes", "no" or "?", by simultaneous 95 % limits.
    pub holds: String,
    /// The same by the values.
    pub by_value: String,
    /// The number that decides.
    pub value: Option<f64>,
    /// Its limits.
    pub limits: Option<[f64; 2]>,
    /// Frequency rank of the mode that it is about.
    pub mode: Option<usize>,
}

impl Card {
    fn new(naming: &str, by_limits: &[Claim], by_value: &[Claim]) -> Self {
        let cell = |(claim, by_value): (&Claim, &Claim)| Cell {
            id: claim.id.into(),
            holds: claim.holds.sign().into(),
            by_value: by_value.holds.sign().into(),
            value: claim.ours,
            limits: claim.interval,
            mode: claim.mode,
        };
        Self { naming: naming.into(), claims: by_limits.iter().zip(by_value).map(cell).collect() }
    }

    /// Claims with this verdict by the limits.
    pub fn count(&self, verdict: &str) -> usize {
        self.claims.iter().filter(|cell| cell.holds == verdict).count()
    }

    /// Claims that hold by the values, without C12, which is the number of draws.
    pub fn held_by_value(&self) -> usize {
        self.claims.iter().filter(|cell| cell.id != "C12" && cell.by_value == "yes").count()
    }

    /// Frequency rank of the mode that a claim is about.
    pub fn mode(&self, id: &str) -> Option<usize> {
        self.claims.iter().find(|cell| cell.id == id)?.mode
    }
}

/// The rows that a folder holds, one file each.
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// The rows in `out`.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn new(out: &Path) -> Result<Self, TaskError> {
        let folder = out.join("rows");
        make_folder(&folder)?;
        Ok(Self { folder })
    }

    fn path(&self, case: &LatticeCase) -> PathBuf {
        let key = format!("{} {} {} {FORMAT} {}", case.identity(), case.seed, case.samples, env!("CARGO_PKG_VERSION"));
        self.folder.join(format!("{}.json", &squeal::fingerprint(&key)[..16]))
    }

    /// The row of a case, if it has been run. A file that is damaged is run again.
    pub fn known(&self, case: &LatticeCase) -> Option<Row> {
        serde_json::from_slice(&std::fs::read(self.path(case)).ok()?).ok()
    }

    /// The row of a case; runs it if it has not been run, and keeps the row.
    ///
    /// # Errors
    /// A file that cannot be written. A study that fails is a row that says why.
    pub fn row(&self, case: LatticeCase) -> Result<Row, TaskError> {
        if let Some(row) = self.known(&case) {
            return Ok(row);
        }
        let (path, samples, start) = (self.path(&case), case.samples, Instant::now());
        let mut row = run(case).unwrap_or_else(|error| Row {
            samples,
            failures: 0,
            seconds: 0.0,
            refused: Some(error.to_string()),
            cards: Vec::new(),
        });
        row.seconds = start.elapsed().as_secs_f64();
        let text = serde_json::to_string_pretty(&row).unwrap_or_default();
        write(&path, text.as_bytes())?;
        Ok(row)
    }
}

/// Runs the study of a case in memory.
fn run(case: LatticeCase) -> Result<Row, Error> {
    let brake = LatticeBrake::new(case)?;
    let study = Study::new(&brake, &squeal::cea::BatchSolver)?;
    let results = Results::sampled(&study)?;
    let card = |naming: &str, results: &Results<'_>| -> Result<Card, Error> {
        let by_value = claims_judged(results, &brake, Judgement::ByValues)?;
        Ok(Card::new(naming, &claims(results, &brake)?, &by_value))
    };
    let mut cards = vec![card("tracked", &results)?];
    // Ranks do not depend on how tracked modes are known again.
    if brake.case.readings.identity == ModeIdentity::Continuation {
        cards.push(card("rank", &results.labelled(ModeNaming::Rank))?);
        cards.push(card("pair", &results.labelled(ModeNaming::Pair))?);
    }
    let (samples, failures) = (results.summary.samples, results.summary.failures.total());
    Ok(Row { samples, failures, seconds: 0.0, refused: None, cards })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_run_once_and_a_damaged_one_again() {
        let mut case =
            LatticeCase::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/two-by-two.toml")).unwrap();
        case.samples = 8;
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path()).unwrap();
        assert_eq!(store.known(&case), None);
        let row = store.row(case.clone()).unwrap();
        assert_eq!((row.samples, row.refused.as_deref(), row.cards.len()), (8, None, 3));
        assert_eq!(Store::new(folder.path()).unwrap().known(&case), Some(row));

        let other = LatticeCase { samples: 9, ..case.clone() };
        assert_eq!(store.known(&other), None);
        let path = store.path(&case);
        let text = std::fs::read(&path).unwrap();
        std::fs::write(&path, &text[..text.len() / 2]).unwrap();
        assert_eq!(store.known(&case), None);
        assert_eq!(store.row(case).unwrap().samples, 8);
    }
}
