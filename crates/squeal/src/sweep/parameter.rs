//! Which parameters are swept, and from where to where.

use crate::Error;
use crate::study::{NamedParameter, Scene, UncertainBrake};

/// A sweep that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Over {
    /// Name of the parameter.
    pub name: String,
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

impl std::fmt::Display for Over {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}:{}", self.name, self.from, self.to)
    }
}

/// A parameter that is swept.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SweptParameter {
    /// Its place among the parameters of the scene.
    #[serde(skip)]
    pub place: usize,
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Its median, where modes have their names.
    pub median: f64,
}

impl SweptParameter {
    /// Its name with its unit, for axes.
    pub fn label(&self) -> String {
        match self.unit.as_str() {
            "" | "1" => self.name.clone(),
            unit => format!("{} ({unit})", self.name),
        }
    }

    /// Its value at a part of the range, 0 to 1; the ends exactly.
    pub(super) fn at(&self, part: f64) -> f64 {
        if part == 1.0 { self.to } else { self.from + part * (self.to - self.from) }
    }
}

/// The parameters of a scene that are asked for.
///
/// # Errors
/// A parameter that the scene does not have or that is named twice, and a range that does not go from a number to a larger one.
pub(super) fn swept<B: UncertainBrake>(brake: &B, scene: &Scene, over: &[Over]) -> Result<Vec<SweptParameter>, Error> {
    let parameters = brake.parameters(scene);
    let refused = |value: String, allowed: String| Error::Option { option: "--over", value, allowed };
    let mut found: Vec<SweptParameter> = Vec::with_capacity(over.len());
    for asked in over {
        let Some(place) = parameters.iter().position(|parameter| parameter.name == asked.name) else {
            let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
            let allowed = if names.is_empty() { "nothing, it has no parameters".into() } else { names.join(", ") };
            return Err(refused(asked.name.clone(), format!("in {}: {allowed}", brake.plan().describe(scene))));
        };
        if found.iter().any(|earlier| earlier.place == place) {
            return Err(refused(asked.to_string(), "two different parameters".into()));
        }
        if !(asked.from < asked.to && (asked.to - asked.from).is_finite()) {
            return Err(refused(asked.to_string(), "NAME=FROM:TO with numbers FROM < TO".into()));
        }
        let NamedParameter { name, unit, median } = parameters[place].clone();
        found.push(SweptParameter { place, name, unit, from: asked.from, to: asked.to, median });
    }
    Ok(found)
}
