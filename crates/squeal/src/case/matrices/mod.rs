//! A brake given by its matrices: terms with coefficients that are expressions in named, drawn parameters, and friction
//! channels.

mod brake;
mod contacts;
mod dofs;
mod formulas;
mod read;
mod schema;
mod terms;

use std::path::PathBuf;

use linsys::{AffineSystem, ChannelGain, OperatingPoint};
use montecarlo::{Distribution, MonteCarloError, StreamRng};

use super::check::field;
use super::{CaseError, Expression};

/// A checked study of a brake given by its matrices.
#[derive(Debug, Clone)]
pub struct MatricesCase {
    /// The case file.
    pub path: PathBuf,
    /// The text of the case file.
    pub text: String,
    /// Name of the study.
    pub name: String,
    /// Samples per scene, >= 1.
    pub samples: u64,
    /// Seed of the random streams.
    pub seed: u64,
    /// Half width to which every occurrence is also estimated, if asked for.
    pub half_width: Option<f64>,
    /// The drawn parameters, in the order of their names; each occurs in an expression.
    pub parameters: Vec<Parameter>,
    /// Names of the degrees of freedom, in the order of rows and columns.
    pub dofs: Vec<String>,
    /// Terms and channels over all degrees of freedom.
    pub system: AffineSystem,
    /// The coefficient of each term.
    pub coefficients: Vec<Expression>,
    /// The gain of each channel.
    pub gains: Vec<GainExpressions>,
    /// Groups of degrees of freedom; each degree of freedom is in one.
    pub bodies: Vec<BodyDofs>,
    /// Sets of constraints, in the order of the file; at least one.
    pub constraints: Vec<FixedDofs>,
}

/// A drawn parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name in expressions.
    pub name: String,
    /// Unit, for information only.
    pub unit: String,
    /// Distribution from which the parameter is drawn.
    pub distribution: Distribution,
}

/// The gain of one friction channel.
#[derive(Debug, Clone, PartialEq)]
pub struct GainExpressions {
    /// The coefficient of friction.
    pub mu: Expression,
    /// Normal load times the slope of the coefficient over the sliding velocity, Ns/m.
    pub slope: Expression,
}

/// A body as a group of degrees of freedom.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BodyDofs {
    /// Name of the body.
    pub name: String,
    /// Indices of the degrees of freedom, from 0.
    pub dofs: Vec<usize>,
}

/// A set of constraints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FixedDofs {
    /// Name of the set.
    pub name: String,
    /// Indices of the constrained degrees of freedom, from 0.
    pub fixed: Vec<usize>,
}

impl MatricesCase {
    /// One value of each parameter.
    ///
    /// # Errors
    /// As [`Distribution::draw`].
    pub fn draw(&self, rng: &mut StreamRng) -> Result<Vec<f64>, MonteCarloError> {
        self.parameters.iter().map(|parameter| parameter.distribution.draw(rng)).collect()
    }

    /// The medians of the parameters.
    pub fn medians(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.distribution.median()).collect()
    }

    /// The coefficients and gains at these values of the parameters.
    ///
    /// # Errors
    /// An expression whose value is not a finite number, named by its field.
    pub fn operating_point(&self, values: &[f64]) -> Result<OperatingPoint, CaseError> {
        let evaluated = |expression: &Expression, field: &dyn Fn() -> String| {
            let named =
                |source| CaseError::Expression { path: self.path.clone(), field: field(), source: Box::new(source) };
            expression.value(values).map_err(named)
        };
        let terms = self.system.terms().iter().zip(&self.coefficients);
        let coefficients =
            terms.map(|(term, coefficient)| evaluated(coefficient, &|| field("terms", &term.name, "coefficient")));
        let channels = self.system.channels().iter().zip(&self.gains).map(|(channel, gain)| {
            let mu = evaluated(&gain.mu, &|| field("contacts", &channel.name, "mu"))?;
            let slope = evaluated(&gain.slope, &|| field("contacts", &channel.name, "slope"))?;
            Ok(ChannelGain { slope, ..ChannelGain::proportional(mu) })
        });
        Ok(OperatingPoint {
            coefficients: coefficients.collect::<Result<_, CaseError>>()?,
            channels: channels.collect::<Result<_, CaseError>>()?,
        })
    }

    /// Identifies the study up to its seed and number of samples: its name, and a hash of all data that results depend on,
    /// including matrices in other files.
    pub fn identity(&self) -> String {
        let Self { parameters, dofs, system, coefficients, gains, bodies, constraints, .. } = self;
        let content =
            format!("{parameters:?} {dofs:?} {system:?} {coefficients:?} {gains:?} {bodies:?} {constraints:?}");
        format!("\"{}\" {}", self.name, &crate::fingerprint(&content)[..16])
    }
}

#[cfg(test)]
mod tests;
