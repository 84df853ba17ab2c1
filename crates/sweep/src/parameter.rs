//! The parameters that are swept, with their ranges.

use study::NamedParameter;

use crate::Error;

/// Least ratio of the ends of a range of positive values at which steps are equal ratios; chosen.
const LOGARITHMIC: f64 = 30.0;

/// Parameter and range of a sweep that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Over {
    /// Name of the parameter.
    pub name: String,
    /// Lower end of the range.
    pub from: f64,
    /// Upper end of the range.
    pub to: f64,
}

impl std::fmt::Display for Over {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}:{}", self.name, self.from, self.to)
    }
}

/// Parameter that is swept.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SweptParameter {
    /// Index of the parameter among the parameters of the scene.
    #[serde(skip)]
    pub place: usize,
    /// Name of the parameter.
    pub name: String,
    /// Unit of the parameter.
    pub unit: String,
    /// Lower end of the range.
    pub from: f64,
    /// Upper end of the range.
    pub to: f64,
    /// Median of the parameter, where modes have their names.
    pub median: f64,
    /// True if equal fractions of the range are equal ratios of values, as from 0.1 to 10; else they are equal differences.
    pub is_logarithmic: bool,
}

impl SweptParameter {
    /// Name of the parameter with its unit, for axes.
    pub fn label(&self) -> String {
        match self.unit.as_str() {
            "" | "1" => self.name.clone(),
            unit => format!("{} ({unit})", self.name),
        }
    }

    /// Value at a fraction of the range; exactly the ends at 0 and 1. A fraction below 0 or above 1 gives a value outside of the range.
    pub fn at(&self, part: f64) -> f64 {
        match (self.is_logarithmic, part == 1.0) {
            (_, true) => self.to,
            (false, false) => self.from + part * (self.to - self.from),
            (true, false) => self.from * (self.to / self.from).powf(part),
        }
    }

    /// Fraction of the range at which the parameter has a value; below 0 or above 1 outside.
    pub fn part(&self, value: f64) -> f64 {
        match self.is_logarithmic {
            false => (value - self.from) / (self.to - self.from),
            true => (value / self.from).ln() / (self.to / self.from).ln(),
        }
    }

    /// Width of one of `steps` equal steps of the fraction, in words: a difference of values, or the ratio of two where the range is gone through in equal ratios.
    pub(super) fn step_in_words(&self, steps: usize) -> String {
        let Self { name, from, to, is_logarithmic, .. } = self;
        match is_logarithmic {
            true => format!("a factor of {:.6} of {name}", (to / from).powf(1.0 / steps as f64)),
            false => format!("{:.3e} of {name}", (to - from) / steps as f64),
        }
    }

    /// Slope d value / d fraction at a fraction of the range, in units of the parameter.
    pub(super) fn slope(&self, part: f64) -> f64 {
        match self.is_logarithmic {
            false => self.to - self.from,
            true => self.at(part) * (self.to / self.from).ln(),
        }
    }
}

/// The parameters that `over` asks for, among the `parameters` of a scene; `scene` is the scene in words, for messages.
///
/// # Errors
/// A parameter that the scene does not have or that is named twice, and a range that does not go from a number to a larger one.
pub fn swept(parameters: &[NamedParameter], scene: &str, over: &[Over]) -> Result<Vec<SweptParameter>, Error> {
    let refused = |value: String, allowed: String| Error::Argument { argument: "over", value, allowed };
    let mut found: Vec<SweptParameter> = Vec::with_capacity(over.len());
    for asked in over {
        let Some(place) = parameters.iter().position(|parameter| parameter.name == asked.name) else {
            let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
            let allowed = if names.is_empty() { "nothing, it has no parameters".into() } else { names.join(", ") };
            return Err(refused(asked.name.clone(), format!("in {scene}: {allowed}")));
        };
        if found.iter().any(|earlier| earlier.place == place) {
            return Err(refused(asked.to_string(), "two different parameters".into()));
        }
        if !(asked.from < asked.to && (asked.to - asked.from).is_finite()) {
            return Err(refused(asked.to_string(), "NAME=FROM:TO with numbers FROM < TO".into()));
        }
        let NamedParameter { name, unit, median } = parameters[place].clone();
        let (from, to) = (asked.from, asked.to);
        let is_logarithmic = from > 0.0 && median > 0.0 && to / from >= LOGARITHMIC;
        found.push(SweptParameter { place, name, unit, from, to, median, is_logarithmic });
    }
    Ok(found)
}
