//! The outputs of a sample of which indices are computed.

use std::collections::BTreeSet;

use study::ModeLabel;

use super::evaluated::Evaluated;

/// Kind of number that is computed of a mode, or of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum OutputKind {
    /// Growth rate, 1/s; 0 where it is not unstable.
    Growth,
    /// Instability: 1 where it is unstable, else 0.
    Instability,
}

impl OutputKind {
    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Growth => "growth",
            Self::Instability => "instability",
        }
    }
}

/// An output of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Output {
    /// Mode of the output; `None` for the one that grows most, whichever it is.
    pub mode: Option<ModeLabel>,
    /// Kind of the output.
    pub kind: OutputKind,
}

impl Output {
    /// The outputs of a scene: of any mode, then of each mode that is unstable in a sample.
    pub(super) fn all(samples: &[Evaluated]) -> Vec<Self> {
        let modes: BTreeSet<ModeLabel> = samples.iter().flat_map(|sample| &sample.modes).map(|mode| mode.0).collect();
        let of = |mode| [OutputKind::Growth, OutputKind::Instability].map(|kind| Self { mode, kind });
        [None].into_iter().chain(modes.into_iter().map(Some)).flat_map(of).collect()
    }

    /// Values of the output in the samples.
    pub(super) fn of_all(&self, samples: &[Evaluated]) -> Vec<f64> {
        samples.iter().map(|sample| self.of(sample)).collect()
    }

    fn of(&self, sample: &Evaluated) -> f64 {
        let growth = match self.mode {
            None => sample.growth,
            Some(mode) => sample.modes.iter().filter(|named| named.0 == mode).map(|named| named.1).fold(0.0, f64::max),
        };
        match self.kind {
            OutputKind::Growth => growth,
            OutputKind::Instability => f64::from(growth > 0.0),
        }
    }
}
