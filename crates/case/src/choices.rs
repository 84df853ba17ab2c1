//! Choices of a case by name: its friction laws, and whether its contacts share a draw.

use serde::{Deserialize, Serialize};

/// A friction law by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// Constant coefficient.
    AmontonsCoulomb,
    /// Coefficient that falls exponentially with speed.
    VelocityDependent,
    /// Bristles: one internal state per contact.
    #[serde(rename = "lugre")]
    LuGre,
    /// The steady curve of LuGre without bristles.
    Stribeck,
}

impl Law {
    /// Laws, all of them, in the order of the variants.
    pub const ALL: [Self; 4] = [Self::AmontonsCoulomb, Self::VelocityDependent, Self::LuGre, Self::Stribeck];

    /// Name of the law in a case file.
    pub fn name(self) -> &'static str {
        match self {
            Self::AmontonsCoulomb => "amontons-coulomb",
            Self::VelocityDependent => "velocity-dependent",
            Self::LuGre => "lugre",
            Self::Stribeck => "stribeck",
        }
    }

    /// Name of the law in a heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::AmontonsCoulomb => "Amontons-Coulomb",
            Self::VelocityDependent => "Velocity-dependent",
            Self::LuGre => "LuGre",
            Self::Stribeck => "Stribeck",
        }
    }
}

impl std::fmt::Display for Law {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// Draws of the friction parameters of a sample: shared by all contacts, or one for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Draws {
    /// A draw shared by all contacts, so that the lattice keeps its symmetry.
    Shared,
    /// A draw for each oscillator.
    Each,
}
