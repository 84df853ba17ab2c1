//! Results that are kept of one combination of readings.

use serde::{Deserialize, Serialize};

use crate::{Claim, Error, Subject};

/// Way of naming modes: by continuation.
pub const TRACKED: &str = "tracked";
/// Way of naming modes: by MAC.
pub const BY_MAC: &str = "MAC";

/// Way of naming modes: by their frequency rank in each sample.
pub const BY_RANK: &str = "rank";

/// A study of one combination, with a scorecard for each way of naming its modes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Number of draws.
    pub samples: u64,
    /// Number of draws or evaluations that failed.
    pub failures: u64,
    /// Time of the study, s, as its part of the combinations that were run together.
    pub seconds: f64,
    /// Reason why the row has no scorecard; `None` if it has scorecards.
    pub refused: Option<String>,
    /// The scorecards.
    pub cards: Vec<Card>,
}

/// The scorecard under one way of naming modes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Card {
    /// Way of naming modes.
    pub naming: String,
    /// Way of counting modes where the paper's numbers say which ones C4 to C6, C8 and C10 are about; `None` where the claims do.
    pub counting: Option<String>,
    /// Cells, one for each claim.
    pub claims: Vec<Cell>,
}

/// A claim with its verdicts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the claim: C1, C2, ...
    pub id: String,
    /// Verdict by simultaneous 95 % limits: "yes", "no" or "?"; empty where they were not asked for.
    pub holds: String,
    /// Verdict by the values: "yes", "no" or "?".
    pub by_value: String,
    /// The number that decides.
    pub value: Option<f64>,
    /// Limits of the value.
    pub limits: Option<[f64; 2]>,
    /// Frequency rank of the mode that the claim is about.
    pub mode: Option<usize>,
}

impl Cell {
    fn holds_by_value(&self) -> bool {
        self.id != "C12" && self.by_value == "yes"
    }
}

impl Row {
    /// Number of claims, without C12, that hold by the values, each under some way of naming modes.
    pub fn held_by_value(&self) -> usize {
        let claims = self.cards.first().map_or(0, |card| card.claims.len());
        (0..claims).filter(|&place| self.cards.iter().any(|card| card.claims[place].holds_by_value())).count()
    }

    /// The row of a study that the model refuses.
    pub fn refused(samples: u64, why: &Error) -> Self {
        Self { samples, failures: 0, seconds: 0.0, refused: Some(why.to_string()), cards: Vec::new() }
    }
}

impl Card {
    /// The claims as they are judged by their values, and by their limits if these were asked for.
    pub fn new(naming: &str, subject: Subject, by_value: &[Claim], by_limits: Option<&[Claim]>) -> Self {
        let cell = |(at, by_value): (usize, &Claim)| {
            let by_limits = by_limits.map(|claims| &claims[at]);
            Cell {
                id: by_value.id.into(),
                holds: by_limits.map_or(String::new(), |claim| claim.holds.sign().into()),
                by_value: by_value.holds.sign().into(),
                value: by_value.ours,
                limits: by_limits.and_then(|claim| claim.interval),
                mode: by_value.mode,
            }
        };
        let counting = match subject {
            Subject::Found => None,
            Subject::Numbered(counting) => Some(counting.word().into()),
        };
        Self { naming: naming.into(), counting, claims: by_value.iter().enumerate().map(cell).collect() }
    }

    /// Number of claims with this verdict by the limits.
    pub fn count(&self, verdict: &str) -> usize {
        self.claims.iter().filter(|cell| cell.holds == verdict).count()
    }

    /// Number of claims that hold by the values, without C12, which is the number of draws.
    pub fn held_by_value(&self) -> usize {
        self.claims.iter().filter(|cell| cell.holds_by_value()).count()
    }

    /// True if the claims `ids` all hold by the values.
    pub fn holds_by_value(&self, ids: &[&str]) -> bool {
        let holds = |id: &&str| self.claims.iter().any(|cell| cell.id == *id && cell.by_value == "yes");
        ids.iter().all(holds)
    }

    /// Frequency rank of the mode that a claim is about.
    pub fn mode(&self, id: &str) -> Option<usize> {
        self.claims.iter().find(|cell| cell.id == id)?.mode
    }
}
