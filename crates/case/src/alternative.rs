//! Other readings of a case, each compared with the readings of the case one at a time.

use friction::BristleDamping;
use osc_model::{Lateral, Preload};
use output::significant;
use study::ModeNaming;

use super::{Draws, Law};

/// Reading that differs from the reading of the case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Alternative {
    /// R1: another mass of every oscillator, kg.
    OscillatorMass(f64),
    /// R3: another friction in y.
    Lateral(Lateral),
    /// R4: other draws.
    Draws(Draws),
    /// R7: other names of modes.
    ModeNaming(ModeNaming),
    /// R8: another preload.
    Preload(Preload),
    /// R9: another sigma1 as a function of speed; `None` is 0.
    BristleDamping(Option<BristleDamping>),
    /// R9: another law in place of LuGre, which separates the effect of the bristles from the effect of the steady curve.
    InPlaceOfLuGre(Law),
}

impl Alternative {
    /// Name of the reading.
    pub fn reading(&self) -> &'static str {
        match self {
            Self::OscillatorMass(_) => "R1",
            Self::Lateral(_) => "R3",
            Self::Draws(_) => "R4",
            Self::ModeNaming(_) => "R7",
            Self::Preload(_) => "R8",
            Self::BristleDamping(_) | Self::InPlaceOfLuGre(_) => "R9",
        }
    }

    /// The choice in words.
    pub fn choice(&self) -> String {
        match self {
            Self::OscillatorMass(mass) => format!("oscillators of {} kg", significant(*mass, 4)),
            Self::Lateral(Lateral::None) => "no friction in y".into(),
            Self::Lateral(Lateral::Coupled { sign }) => format!("friction in y coupled, sign {:+}", sign.value()),
            Self::Lateral(Lateral::Vector) => "friction along the relative velocity".into(),
            Self::Draws(draws) => format!("draws {draws:?}").to_lowercase(),
            Self::ModeNaming(labels) => format!("labels {}", labels.word()),
            Self::Preload(Preload::PerContact(force)) => format!("{force} N per contact"),
            Self::Preload(Preload::Clamp(force)) => format!("{force} N shared by the contacts"),
            Self::Preload(Preload::Equilibrium(force)) => format!("{force} N on each, loads from equilibrium"),
            Self::InPlaceOfLuGre(law) => format!("{law} in place of lugre"),
            Self::BristleDamping(None) => "sigma1 = 0".into(),
            Self::BristleDamping(Some(BristleDamping::Constant)) => "sigma1 constant".into(),
            Self::BristleDamping(Some(BristleDamping::Decaying)) => "sigma1 decaying with speed".into(),
        }
    }
}
