//! A brake given by its matrices: terms with coefficients that are expressions in named, drawn parameters, and friction
//! channels.

mod brake;
mod contacts;
mod dofs;
mod draft;
mod elsewhere;
mod loss;
mod motion;
mod read;
mod relaxing;
mod schema;
mod terms;

use std::sync::Arc;

use linsys::{AffineSystem, ChannelGain, Lag, OperatingPoint};
use montecarlo::{Distribution, MonteCarloError, StreamRng};
use nalgebra::DMatrix;
use study::Moves;

use super::check::{Check, field};
use super::parameter::Parameter;
use super::relaxing::{Branch, gains_of};
use super::{CaseError, CaseHeader, Correlation, Expression, TableFunction, TakenMatrix};

/// A checked study of a brake given by its matrices.
#[derive(Debug, Clone)]
pub struct MatricesCase {
    /// Header of the case: its file, and what it says of its study.
    pub header: CaseHeader,
    /// The drawn parameters, in the order of their names; each occurs in an expression.
    pub parameters: Vec<Parameter>,
    /// Functions that are given by points, in the order of their names; each is called by an expression.
    pub tables: Vec<Arc<TableFunction>>,
    /// Correlation of the parameters; `None` where they are independent.
    pub correlation: Option<Correlation>,
    /// Names of the degrees of freedom, in the order of rows and columns.
    pub dofs: Vec<String>,
    /// Kinds of their motions, as far as the files of the matrices say them.
    pub moves: Vec<Moves>,
    /// Terms and channels over all degrees of freedom: channels of contacts, then channels of branches. The dashpots of loss factors are not in it, as
    /// each set of constraints has its own.
    pub system: AffineSystem,
    /// How each matrix was taken.
    pub taken: Vec<TakenMatrix>,
    /// The coefficient of each term.
    pub coefficients: Vec<Expression>,
    /// The gain of the channel of each contact.
    pub gains: Vec<GainExpressions>,
    /// Branches of viscoelastic terms, of which each has a channel for each of its directions.
    pub branches: Vec<Branch>,
    /// Groups of degrees of freedom; each degree of freedom is in one.
    pub bodies: Vec<BodyDofs>,
    /// Sets of constraints, in the order of the file; at least one.
    pub constraints: Vec<FixedDofs>,
}

/// The gain of one friction channel.
#[derive(Debug, Clone, PartialEq)]
pub struct GainExpressions {
    /// The coefficient of friction.
    pub mu: Expression,
    /// Normal load times the slope of the coefficient over the sliding velocity, Ns/m.
    pub slope: Expression,
    /// An internal first-order state, such as the bristle of a LuGre contact.
    pub lag: Option<LagExpressions>,
    /// Normal load N0, N, in steady sliding; `None` where the case does not say, and nothing but the motion after the onset needs it.
    pub load: Option<Expression>,
    /// Speed of steady sliding, m/s, as the load.
    pub speed: Option<Expression>,
    /// Stiffness of the contact spring, N/m, as the load.
    pub stiffness: Option<Expression>,
}

/// An internal state `z' = -decay z + drive v` under the sliding velocity v, adding the force `force z` to friction; see
/// [`Lag`].
#[derive(Debug, Clone, PartialEq)]
pub struct LagExpressions {
    /// Decay rate, 1/s; its values must be > 0.
    pub decay: Expression,
    /// Drive: rate of the state per sliding velocity, in units of the state per m.
    pub drive: Expression,
    /// The normal load times what the state contributes to the coefficient, N per unit of the state.
    pub force: Expression,
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
#[derive(Debug, Clone, PartialEq)]
pub struct FixedDofs {
    /// Name of the set.
    pub name: String,
    /// Indices of the constrained degrees of freedom, from 0.
    pub fixed: Vec<usize>,
    /// Dashpots in the place of the loss factor of each term, at a coefficient of 1 and on the rows that the set leaves free; empty where no term of given
    /// matrices has one.
    pub dashpots: Vec<Option<DMatrix<f64>>>,
}

impl MatricesCase {
    /// Draw of the parameters: one value of each, in their order.
    ///
    /// # Errors
    /// As [`Distribution::draw`].
    pub fn draw(&self, rng: &mut StreamRng) -> Result<Vec<f64>, MonteCarloError> {
        let values = self.parameters.iter().map(|parameter| parameter.distribution.draw(rng));
        Ok(self.correlated(values.collect::<Result<_, _>>()?))
    }

    /// Correlated values of the parameters, one of each, from independent ones.
    pub fn correlated(&self, mut values: Vec<f64>) -> Vec<f64> {
        if let Some(correlation) = &self.correlation {
            let distributions: Vec<&Distribution> = self.parameters.iter().map(|p| &p.distribution).collect();
            correlation.apply(&distributions, &mut values);
        }
        values
    }

    /// The medians of the parameters.
    pub fn medians(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.distribution.median()).collect()
    }

    /// The coefficients and gains at these values of the parameters.
    ///
    /// # Errors
    /// An expression whose value is not a finite number, or a state that does not decay, named by its field.
    pub fn operating_point(&self, values: &[f64]) -> Result<OperatingPoint, CaseError> {
        let check = Check::new(&self.header.path);
        // Called for each draw: a name is made where there is an error alone.
        let evaluated = |expression: &Expression, field: &dyn Fn() -> String| {
            expression.value(values).map_err(|source| check.expression(&field())(source))
        };
        let terms = self.system.terms().iter().zip(&self.coefficients);
        let coefficients =
            terms.map(|(term, coefficient)| evaluated(coefficient, &|| field("terms", &term.name, "coefficient")));
        let coefficients = coefficients.collect::<Result<Vec<f64>, CaseError>>()?;
        let contacts = self.system.channels().iter().zip(&self.gains).map(|(channel, gain)| {
            let of_contact =
                |expression: &Expression, key: &str| evaluated(expression, &|| field("contacts", &channel.name, key));
            let lag = |LagExpressions { decay, drive, force }: &LagExpressions| {
                let decay = of_contact(decay, "lag.decay")?;
                if decay <= 0.0 {
                    // Such a state would grow without bound, and no mode would show it.
                    let (field, allowed) = (field("contacts", &channel.name, "lag.decay"), "a rate > 0, in 1/s");
                    return Err(check.value(&field, decay, allowed));
                }
                Ok(Lag { decay, drive: of_contact(drive, "lag.drive")?, force: of_contact(force, "lag.force")? })
            };
            Ok(ChannelGain {
                mu: of_contact(&gain.mu, "mu")?,
                slope: of_contact(&gain.slope, "slope")?,
                lag: gain.lag.as_ref().map(lag).transpose()?,
            })
        });
        let mut channels = contacts.collect::<Result<Vec<_>, CaseError>>()?;
        channels.extend(gains_of(&self.header.path, &self.branches, values, &coefficients)?);
        Ok(OperatingPoint { coefficients, channels })
    }
}

#[cfg(test)]
mod tests;
