//! Local sensitivity: the change of a mode with a number.

use cea::{CeaError, Eigentriple, Expansion, Perturbation, Rates, frequency_hz};
use linsys::{ChannelGain, OperatingPoint, SecondOrder};
use num_complex::Complex;
use osc_model::Brake;
use serde::Serialize;
use study::Units;

use crate::Error;

/// Most contacts whose friction is listed one by one; chosen: more are the pairs of nodes of a mesh, whose families are listed.
pub(super) const MOST_CONTACTS: usize = 100;

/// Kind of number that is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum InfluenceKind {
    /// A named parameter of the brake, with all that depends on it.
    Parameter,
    /// The mass, damping or stiffness of a term, as a factor of it.
    Term,
    /// The friction of one contact alone.
    Contact,
    /// The friction of all contacts of one family, as a factor of it.
    Family,
}

impl std::fmt::Display for InfluenceKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Parameter => "parameter",
            Self::Term => "term",
            Self::Contact => "contact",
            Self::Family => "family",
        })
    }
}

/// Derivatives of one mode by one number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Influence {
    /// Kind of the number.
    pub kind: InfluenceKind,
    /// Name of the number.
    pub name: String,
    /// Unit of the number.
    pub unit: String,
    /// Value of the number.
    pub value: f64,
    /// Derivative d growth / d value, 1/s per unit.
    pub growth: f64,
    /// Derivative d frequency / d value, Hz per unit.
    pub frequency_hz: f64,
    /// Change of the growth, 1/s, as the value grows by one per cent; `None` of a value that is 0, which has no per cent.
    pub growth_per_percent: Option<f64>,
    /// Change of the frequency, Hz, as the value grows by one per cent; `None` of a value that is 0.
    pub frequency_hz_per_percent: Option<f64>,
    /// Largest change of the value over which the derivative of the growth holds to a tenth, by the second derivative; infinite where
    /// that is 0.
    pub growth_holds_to: f64,
    /// Largest change of the value over which the derivative of the frequency holds to a tenth; infinite where the second derivative is 0.
    pub frequency_holds_to: f64,
}

impl Influence {
    pub(super) fn new(kind: InfluenceKind, name: &str, unit: &str, value: f64, rates: &Rates) -> Self {
        // Adding 0 takes the sign off a 0.
        let (growth, frequency) = (rates.first.re + 0.0, frequency_hz(rates.first) + 0.0);
        let per_percent = |rate: f64| (value != 0.0).then_some(0.01 * value * rate + 0.0);
        Self {
            kind,
            name: name.into(),
            unit: unit.into(),
            value,
            growth,
            frequency_hz: frequency,
            growth_per_percent: per_percent(growth),
            frequency_hz_per_percent: per_percent(frequency),
            growth_holds_to: rates.growth_holds_to(),
            frequency_holds_to: rates.frequency_holds_to(),
        }
    }

    /// Unit of the derivative of the growth, for people: `1/s per Ns/m`.
    #[must_use]
    pub fn per_unit(&self) -> String {
        if self.unit == "1" { "1/s".to_owned() } else { format!("1/s per {}", self.unit) }
    }

    /// True if the first order of the growth holds for a change by one per cent.
    #[must_use]
    pub fn holds_for_a_percent(&self) -> bool {
        self.growth_holds_to >= 0.01 * self.value.abs()
    }
}

/// The influences of the terms of a brake at an operating point: of the mass, the damping and the stiffness of each as a factor.
pub(super) fn of_terms(
    brake: &Brake,
    at: &OperatingPoint,
    triple: &Eigentriple,
    expansion: &Expansion<'_>,
) -> Result<Vec<Influence>, Error> {
    let (mut found, zero) = (Vec::new(), SecondOrder::zeros(brake.system.order(), 0));
    for (term, &coefficient) in brake.system.terms().iter().zip(&at.coefficients) {
        let SecondOrder { m, c, k, .. } = term.matrices();
        let parts = [
            ("mass", SecondOrder { m: m * coefficient, ..zero.clone() }),
            ("damping", SecondOrder { c: c * coefficient, ..zero.clone() }),
            ("stiffness", SecondOrder { k: k * coefficient, ..zero.clone() }),
        ];
        for (what, part) in parts.into_iter().filter(|(_, part)| *part != zero) {
            let rates = expansion.rates(&Perturbation::linear(triple, &part))?;
            let name = format!("{} of {}", what, term.name);
            found.push(Influence::new(InfluenceKind::Term, &name, "times", 1.0, &rates));
        }
    }
    Ok(found)
}

/// The influences of friction: of the coefficient, the slope and the lag in each contact, or of each family as a factor where there are
/// too many contacts; and of what relaxes, as a factor of each term that does.
pub(super) fn of_friction(
    brake: &Brake,
    at: &OperatingPoint,
    triple: &Eigentriple,
    expansion: &Expansion<'_>,
    units: Units,
) -> Result<Vec<Influence>, Error> {
    let is_each = brake.system.contacts().count() <= MOST_CONTACTS;
    let pairs = brake.system.channels().iter().zip(&at.channels);
    let (each, together): (Vec<_>, Vec<_>) = pairs.partition(|(channel, _)| is_each && channel.is_contact);
    let mut found = Vec::new();
    for (channel, gain) in each {
        for GainPart { what, unit, value, gain, reads_force } in parts(gain, triple.lambda) {
            let reading = if reads_force { &channel.reading } else { &channel.force };
            if reading.is_empty() {
                continue;
            }
            let rates = expansion.rates(&Perturbation::product(triple, gain, &channel.force, reading))?;
            let name = format!("{what} of contact {}", channel.name);
            found.push(Influence::new(InfluenceKind::Contact, &name, units.of(unit), value, &rates));
        }
    }
    let mut wholes: Vec<(InfluenceKind, String, Perturbation)> = Vec::new();
    for (channel, gain) in together {
        let (kind, name) = match channel.is_contact {
            true => (InfluenceKind::Family, channel.family.clone()),
            false => (InfluenceKind::Term, format!("relaxation of {}", channel.name)),
        };
        for GainPart { value, gain, reads_force, .. } in parts(gain, triple.lambda) {
            let reading = if reads_force { &channel.reading } else { &channel.force };
            let part = Perturbation::product(triple, gain.map(|gain| gain * value), &channel.force, reading);
            match wholes.iter_mut().find(|(_, known, _)| *known == name) {
                Some((.., whole)) => *whole += part,
                None => wholes.push((kind, name.clone(), part)),
            }
        }
    }
    for (kind, name, whole) in wholes {
        found.push(Influence::new(kind, &name, "times", 1.0, &expansion.rates(&whole)?));
    }
    Ok(found)
}

/// Number of a channel: `value g(lambda) b r^T`, or `b b^T` in place of `b r^T`.
struct GainPart {
    what: &'static str,
    unit: &'static str,
    value: f64,
    /// Factors g and g'.
    gain: [Complex<f64>; 2],
    /// The number acts through the normal force that the channel reads.
    reads_force: bool,
}

fn parts(gain: &ChannelGain, lambda: Complex<f64>) -> Vec<GainPart> {
    let one = Complex::from(1.0);
    let (mu, slope) = ([one, Complex::default()], [lambda, one]);
    let mut parts = vec![
        GainPart { what: "mu", unit: "1", value: gain.mu, gain: mu, reads_force: true },
        GainPart { what: "slope", unit: "Ns/m", value: gain.slope, gain: slope, reads_force: false },
    ];
    if let Some(lag) = gain.lag {
        let shifted = lambda + lag.decay;
        let gain = [lambda * lag.drive / shifted, lag.drive * lag.decay / (shifted * shifted)];
        parts.push(GainPart { what: "lag", unit: "N", value: lag.force, gain, reads_force: false });
    }
    parts
}

/// Derivatives, first and second, of a mode by a number that is p - h, p and p + h in three systems.
pub(super) fn between(
    triple: &Eigentriple,
    expansion: &Expansion<'_>,
    systems: [&SecondOrder; 3],
    half_step: f64,
) -> Result<Rates, CeaError> {
    expansion.rates(&Perturbation::between(triple, systems, half_step))
}

/// Puts the influence that changes the growth by most per cent first; those of values that are 0 stand behind all others, parameters first, by their derivatives.
pub(super) fn rank(influences: &mut [Influence]) {
    let key = |of: &Influence| match of.growth_per_percent {
        Some(change) => (0, -change.abs()),
        None => (1 + u8::from(of.kind != InfluenceKind::Parameter), -of.growth.abs()),
    };
    influences.sort_by(|a, b| {
        let [(group, change), (other, by)] = [key(a), key(b)];
        group.cmp(&other).then(change.total_cmp(&by))
    });
}
