//! The scorecard: each claim of the paper beside what the model shows.

use serde::Serialize;

use squeal::results::Estimate;

/// Verdict on a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Holds {
    /// The claim holds, beyond the sampling error.
    #[serde(rename = "yes")]
    Yes,
    /// The claim does not hold.
    #[serde(rename = "no")]
    No,
    /// The samples do not tell.
    #[serde(rename = "not determined")]
    NotDetermined,
}

impl From<bool> for Holds {
    fn from(holds: bool) -> Self {
        if holds { Self::Yes } else { Self::No }
    }
}

impl Holds {
    /// Sign in a table: "yes", "no" or "?".
    pub fn sign(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::No => "no",
            Self::NotDetermined => "?",
        }
    }
}

/// A row of the scorecard.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// Name of the claim: C1, C2, ...
    pub id: &'static str,
    /// Statement of the paper.
    pub statement: String,
    /// The paper's value.
    pub paper: String,
    /// Our value: the number that decides.
    pub ours: Option<f64>,
    /// Limits of `ours`, where it is an estimate: with 95 % the limits of all estimates of the claim hold together.
    pub interval: Option<[f64; 2]>,
    /// Verdict on the claim.
    pub holds: Holds,
    /// Frequency rank, from 1, of the mode that the claim is about: where modes have their names, or in each sample where they are
    /// named by rank.
    pub mode: Option<usize>,
    /// Explanation of `ours`, and the numbers behind it.
    pub detail: String,
}

impl Claim {
    pub(crate) fn new(id: &'static str, statement: &str, paper: impl Into<String>) -> Self {
        Self {
            id,
            statement: statement.into(),
            paper: paper.into(),
            ours: None,
            interval: None,
            holds: Holds::NotDetermined,
            mode: None,
            detail: String::new(),
        }
    }

    pub(crate) fn ours(mut self, estimate: Estimate, holds: Holds, detail: String) -> Self {
        self.ours = Some(estimate.value);
        let is_finite = estimate.lower.is_finite() && estimate.upper.is_finite();
        self.interval = is_finite.then_some([estimate.lower, estimate.upper]);
        (self.holds, self.detail) = (holds, detail);
        self
    }

    pub(crate) fn exactly(mut self, value: f64, holds: Holds, detail: String) -> Self {
        (self.ours, self.holds, self.detail) = (Some(value), holds, detail);
        self
    }

    /// A claim about something that was not found in any sample.
    pub(crate) fn none(mut self, detail: &str) -> Self {
        (self.holds, self.detail) = (Holds::No, detail.into());
        self
    }

    pub(crate) fn undetermined(mut self, detail: &str) -> Self {
        self.detail = detail.into();
        self
    }

    /// The claim, about the mode of this frequency rank.
    pub(crate) fn about(mut self, rank: usize) -> Self {
        self.mode = Some(rank);
        self
    }
}

/// The scorecard as a JSON list for machines.
pub fn claims_json(claims: &[Claim]) -> String {
    // Plain numbers and strings: there is nothing that could fail to serialise.
    serde_json::to_string_pretty(claims).unwrap_or_default() + "\n"
}

/// The scorecard as a table for people.
pub fn claims_markdown(claims: &[Claim]) -> String {
    let mut text =
        String::from("| id | claim | paper | ours | 95 % limits | holds |\n| --- | --- | --- | --- | --- | --- |\n");
    for claim in claims {
        let ours = claim.ours.map_or("-".into(), number);
        let interval = claim.interval.map_or("-".into(), |[a, b]| format!("{} to {}", number(a), number(b)));
        let holds = match claim.holds {
            Holds::Yes => "yes",
            Holds::No => "**no**",
            Holds::NotDetermined => "not determined",
        };
        let Claim { id, statement, paper, .. } = claim;
        text += &format!("| {id} | {statement} | {paper} | {ours} | {interval} | {holds} |\n");
    }
    text += "\nWhat \"ours\" is, and the numbers behind it:\n\n";
    for claim in claims {
        text += &format!("- {}: {}\n", claim.id, claim.detail);
    }
    text
}

fn number(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if value.abs() >= 100.0 {
        format!("{value:.1}")
    } else if value.abs() >= 1e-3 {
        format!("{value:.4}")
    } else {
        format!("{value:.2e}")
    }
}
