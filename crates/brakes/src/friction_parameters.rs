//! The parameters of friction laws by the names that case files have for them.

use super::FrictionDraw;
use crate::case::Law;

/// Properties of a brake that decide on which parameters of friction its systems depend.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrictionUse {
    pub law: Law,
    /// True if friction acts across the sliding with a coefficient of its own.
    pub has_lateral_mu: bool,
    /// True if LuGre bristles have damping.
    pub has_bristle_damping: bool,
}

/// Parameter of friction: name, unit, and how it is read from a draw and set in it.
#[derive(Debug)]
pub(super) struct FrictionParameter {
    pub name: &'static str,
    pub unit: &'static str,
    pub get: fn(&FrictionDraw) -> f64,
    pub set: fn(&mut FrictionDraw, f64),
    /// True if the systems of such a brake depend on the parameter.
    pub matters: fn(&FrictionUse) -> bool,
}

macro_rules! parameter {
    ($name:ident, $unit:literal, $matters:expr) => {
        FrictionParameter {
            name: stringify!($name),
            unit: $unit,
            get: |draw| draw.$name,
            set: |draw, value| draw.$name = value,
            matters: $matters,
        }
    };
}

/// Every parameter of friction.
pub(super) const FRICTION: &[FrictionParameter] = &[
    FrictionParameter {
        name: "mu",
        unit: "1",
        get: |draw| draw.mu,
        set: |draw, value| (draw.mu, draw.lateral_mu) = (value, value),
        matters: |of| of.law == Law::AmontonsCoulomb || of.has_lateral_mu,
    },
    parameter!(mu_s, "1", |of| of.law != Law::AmontonsCoulomb),
    parameter!(mu_k, "1", |of| of.law != Law::AmontonsCoulomb),
    parameter!(alpha, "s/m", |of| of.law == Law::VelocityDependent),
    parameter!(v_s, "m/s", |of| matches!(of.law, Law::Stribeck | Law::LuGre)),
    parameter!(sigma0, "1/m", |of| of.law == Law::LuGre),
    parameter!(sigma1, "s/m", |of| of.law == Law::LuGre && of.has_bristle_damping),
    parameter!(sigma2, "s/m", |of| matches!(of.law, Law::Stribeck | Law::LuGre)),
];
