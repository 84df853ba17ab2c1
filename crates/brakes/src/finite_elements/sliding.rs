//! Friction and loads of the contacts that slide in a scene of a finite element brake.

use std::sync::Arc;

use cycle::ContactFriction;
use friction::{InternalTangent, Tangent};
use linsys::{ChannelGain, Lag};
use nalgebra_sparse::CscMatrix;

use super::FiniteElementSample;
use super::samples::{load_factor, own_speed, positive, positive_at_pairs};
use crate::Error;
use crate::case::{
    Acting, CaseError, ContactBalance, ContactState, EQUILIBRIUM, Expression, FRICTION_FACTOR, FiniteElementCase, Law,
    PatchContact, STIFFNESS_FACTOR,
};

/// The contacts of a configuration that slide; `None` without a contact.
pub(super) fn sliding<'a>(
    (case, closed): (&'a FiniteElementCase, &'a [usize]),
    friction: Option<(Law, f64)>,
    sample: &'a FiniteElementSample,
    scales: Scales<'a>,
) -> Result<Option<Sliding<'a>>, Error> {
    let Some((contact, (law, speed))) = case.contact.as_ref().zip(friction) else { return Ok(None) };
    let speed = own_speed(case, sample)?.unwrap_or(speed);
    Ok(Some(Sliding { case, contact, closed, law, speed, sample, scales }))
}

/// Factors of the load of all pairs and of the stiffness of each patch, which multiply the factors of a sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scales<'a> {
    pub load: f64,
    /// Factor for each patch; all are 1 where the list is empty.
    pub stiffness: &'a [f64],
}

/// Factors that change nothing.
pub(super) const UNSCALED: Scales<'static> = Scales { load: 1.0, stiffness: &[] };

impl Scales<'_> {
    fn of_patch(&self, patch: usize) -> f64 {
        self.stiffness.get(patch).copied().unwrap_or(1.0)
    }
}

/// Contacts that slide: some patches closed, under a law at a speed.
pub(super) struct Sliding<'a> {
    case: &'a FiniteElementCase,
    contact: &'a PatchContact,
    closed: &'a [usize],
    law: Law,
    speed: f64,
    sample: &'a FiniteElementSample,
    scales: Scales<'a>,
}

/// Friction and loads of closed patches.
struct Loaded<'a> {
    /// The speed of each pair of each patch, and the tangent of the law there.
    tangents: Vec<Vec<(f64, Tangent)>>,
    /// The stiffness of each pair of each patch over that which all have at the medians of what differs between them.
    springs: Vec<Vec<f64>>,
    /// Factor of all loads.
    load_factor: f64,
    /// Equilibrium of the points, where loads follow from one.
    state: Option<(&'a ContactBalance, Arc<ContactState>)>,
}

/// A pair that slides, beyond its tangent.
pub(super) struct PairInMotion {
    /// Normal force in steady sliding, N; of a point that is open there, minus its stiffness times its gap.
    pub load: f64,
    /// Stiffness of its spring, N/m.
    pub stiffness: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Friction law, whose coefficient is to be multiplied by the factor beside it.
    pub friction: (Arc<dyn ContactFriction>, f64),
}

impl Sliding<'_> {
    /// The pairs of the closed patches in motion, patch by patch, with the factor of the stiffness of all of them. A pair sticks where it slides with less than
    /// `stick` of its steady speed.
    pub fn in_motion(&self, coefficients: &[f64], factor: f64, stick: f64) -> Result<Vec<Vec<PairInMotion>>, Error> {
        let Loaded { tangents, springs, load_factor, state } = self.loaded(coefficients, factor)?;
        let Some(contacts) = &self.sample.contacts else { return Ok(Vec::new()) };
        if state.as_ref().is_some_and(|(_, state)| state.undetermined > 0) {
            return Err(Error::Motion {
                what: "a contact point that neither presses nor is open",
                allowed: "loads at which each point does the one or the other",
            });
        }
        let in_motion = |number: usize, tangents: &[(f64, Tangent)], springs: &[f64]| {
            let patch = &self.contact.patches[number];
            let factors = self.friction_factors(number)?;
            let pair = |at: usize| {
                let stiffness = factor * springs[at] * self.scales.of_patch(number) * patch.springs[at];
                let load = match &state {
                    None => patch.load * patch.shares[at] * load_factor,
                    Some((_, state)) => match patch.points[at] {
                        point if state.forces[point] > 0.0 => state.forces[point],
                        point => -stiffness * state.gaps[point],
                    },
                };
                let (speed, draw) = (tangents[at].0, contacts.contact(number));
                let law = draw.in_motion(self.law, stick * speed, self.contact.bristle_damping);
                Ok(PairInMotion { load, stiffness, speed, friction: (law.map_err(study::Error::from)?, factors[at]) })
            };
            (0..patch.pairs.len()).map(pair).collect()
        };
        let patches = self.closed.iter().zip(&tangents).zip(&springs);
        patches.map(|((&number, tangents), springs)| in_motion(number, tangents, springs)).collect()
    }

    /// The gains of the closed patches, with the factor of the stiffness of all of them. The gains of a patch with a scale are the gains of its pairs without
    /// the scale.
    pub fn gains(&self, coefficients: &[f64], factor: f64) -> Result<Vec<ChannelGain>, Error> {
        let Loaded { tangents, springs, load_factor, state } = self.loaded(coefficients, factor)?;
        let mut gains = Vec::new();
        for ((&number, tangents), springs) in self.closed.iter().zip(&tangents).zip(&springs) {
            let patch = &self.contact.patches[number];
            // The load of each pair, and what its spring is of the one that its channel reads.
            let pairs: Vec<[f64; 2]> = match &state {
                None => {
                    let pairs = patch.shares.iter().zip(springs);
                    pairs.map(|(share, own)| [patch.load * share * load_factor, factor * own]).collect()
                }
                Some((_, state)) => {
                    let scale = self.scales.of_patch(number);
                    patch.points.iter().map(|&point| [state.forces[point], state.stiffness[point] / scale]).collect()
                }
            };
            let loaded = || tangents.iter().zip(&pairs);
            gains.extend(loaded().map(|((_, tangent), [load, spring])| along(tangent, *load, *spring)));
            if self.contact.is_lateral {
                gains.extend(loaded().map(|((speed, tangent), [load, _])| across(tangent, *load, *speed)));
            }
            if self.contact.has_spring_channels {
                // The stiffness of a spring beyond what the term of its patch has of it.
                let in_patch =
                    |pair: usize| state.as_ref().map_or(1.0, |(balance, _)| balance.at_medians(patch.points[pair]));
                let beyond = |(pair, [_, spring]): (usize, &[f64; 2])| ChannelGain {
                    mu: spring - factor * in_patch(pair),
                    ..ChannelGain::default()
                };
                gains.extend(pairs.iter().enumerate().map(beyond));
            }
        }
        Ok(gains)
    }

    /// Flags of the points of the closed patches, patch by patch: true of those that press. Empty where loads are given.
    pub fn pressing(&self, coefficients: &[f64], factor: f64) -> Result<Vec<bool>, Error> {
        let Some((_, state)) = self.loaded(coefficients, factor)?.state else { return Ok(Vec::new()) };
        let points = self.closed.iter().flat_map(|&patch| &self.contact.patches[patch].points);
        Ok(points.map(|&point| state.forces[point] > 0.0).collect())
    }

    /// Friction and loads of the closed patches.
    fn loaded(&self, coefficients: &[f64], factor: f64) -> Result<Loaded<'_>, Error> {
        let tangents = self.closed.iter().map(|&patch| self.tangents(patch)).collect::<Result<Vec<_>, Error>>()?;
        let springs = self.closed.iter().map(|&patch| self.springs(patch)).collect::<Result<Vec<_>, Error>>()?;
        let load_factor = load_factor(self.case, self.contact, self.sample)? * self.scales.load;
        let balance = self.contact.balance.as_deref();
        let state = balance.map(|balance| self.state(balance, &tangents, &springs, coefficients, factor, load_factor));
        let state = balance.zip(state.transpose()?);
        Ok(Loaded { tangents, springs, load_factor, state })
    }

    /// The stiffness of each pair of a patch over that which all have at the medians of what differs between them.
    fn springs(&self, patch: usize) -> Result<Vec<f64>, Error> {
        let Self { case, contact, sample, .. } = *self;
        let own = contact.stiffness_factor.as_ref();
        let of_all = positive(case, own, STIFFNESS_FACTOR, sample)?.unwrap_or(1.0);
        let at_pairs = positive_at_pairs(case, (contact, patch), own, STIFFNESS_FACTOR, sample)?;
        Ok(at_pairs.into_iter().map(|value| value / of_all).collect())
    }

    /// The speed of each pair of a patch, and the tangent of the law there, with the factor of its friction.
    fn tangents(&self, patch: usize) -> Result<Vec<(f64, Tangent)>, Error> {
        let Some(contacts) = &self.sample.contacts else { return Ok(Vec::new()) };
        let pairs = &self.contact.patches[patch];
        let factors = self.friction_factors(patch)?;
        let mut tangents: Vec<(f64, Tangent)> = Vec::with_capacity(pairs.speeds.len());
        for own in pairs.speeds.iter().map(|part| part * self.speed) {
            // Pairs of one speed have one tangent.
            let known = tangents.last().filter(|(of, _)| *of == own).map(|(_, tangent)| *tangent);
            let found = || contacts.contact(patch).tangent(self.law, own, self.contact.bristle_damping);
            tangents.push((own, known.map_or_else(found, Ok)?));
        }
        tangents.iter_mut().zip(factors).for_each(|((_, tangent), factor)| *tangent = times(tangent, factor));
        Ok(tangents)
    }

    /// The factor of the friction of each pair of a patch.
    fn friction_factors(&self, patch: usize) -> Result<Vec<f64>, CaseError> {
        let of = |factor: Option<&Expression>, field: &str| {
            positive_at_pairs(self.case, (self.contact, patch), factor, field, self.sample)
        };
        let of_all = of(self.contact.friction_factor.as_ref(), FRICTION_FACTOR)?;
        let Some((field, own)) = &self.contact.own_friction_factors[self.contact.patches[patch].contact] else {
            return Ok(of_all);
        };
        Ok(of_all.into_iter().zip(of(Some(own), field)?).map(|(of_all, own)| of_all * own).collect())
    }

    /// The equilibrium of the closed patches, whose loads are multiplied.
    fn state(
        &self,
        balance: &ContactBalance,
        tangents: &[Vec<(f64, Tangent)>],
        springs: &[Vec<f64>],
        coefficients: &[f64],
        factor: f64,
        load_factor: f64,
    ) -> Result<Arc<ContactState>, Error> {
        let Self { case, contact, closed, .. } = *self;
        let (mut mu, mut stiffness) = (vec![0.0; balance.points()], vec![0.0; balance.points()]);
        for ((&number, tangents), springs) in closed.iter().zip(tangents).zip(springs) {
            for ((&point, (_, tangent)), spring) in contact.patches[number].points.iter().zip(tangents).zip(springs) {
                (mu[point], stiffness[point]) = (tangent.mu, factor * spring * self.scales.of_patch(number));
            }
        }
        let path = || case.header.path.clone();
        let of_load = |(field, expression): (String, &Expression)| match expression.value(&self.sample.values) {
            Ok(value) => Ok(load_factor * value),
            Err(source) => Err(CaseError::Expression { path: path(), field, source: Box::new(source) }),
        };
        let loads = balance.factors().map(of_load).collect::<Result<Vec<_>, _>>()?;
        let own = case.coefficients.len();
        let structure = || {
            let holders = own..case.system.terms().len() - contact.patches.len();
            let factors = coefficients[..own].iter().copied().chain(holders.map(|_| 1.0));
            let parts = case.system.terms().iter().zip(factors).map(|(term, theta)| &term.matrices.k * theta);
            parts.reduce(|sum, part| sum + part).unwrap_or_else(|| CscMatrix::zeros(case.dofs.len(), case.dofs.len()))
        };
        let acting = Acting { coefficients, loads: &loads, mu: &mu, stiffness: &stiffness };
        let failed = |source| CaseError::Contact { path: path(), field: EQUILIBRIUM.into(), source: Box::new(source) };
        Ok(balance.state(&acting, &structure).map_err(failed)?)
    }
}

/// The tangent of a law whose friction force is multiplied.
fn times(tangent: &Tangent, factor: f64) -> Tangent {
    let internal = tangent.internal.map(|state| InternalTangent { force: factor * state.force, ..state });
    Tangent { mu: factor * tangent.mu, slope: factor * tangent.slope, internal }
}

/// Friction along the sliding of a pair under a load. A channel reads the normal force of its spring, whose stiffness is multiplied.
fn along(tangent: &Tangent, load: f64, factor: f64) -> ChannelGain {
    let lag = tangent.internal.map(|state| Lag { decay: state.decay, drive: state.drive, force: load * state.force });
    ChannelGain { mu: factor * tangent.mu, slope: load * tangent.slope, lag }
}

/// Friction across the sliding of a pair: mu N0 has the direction of the sliding, so that a small velocity v_y across it turns it by
/// `v_y / v`, a dashpot `mu N0 / v`. A bristle leans along the sliding alone: across it friction is that of steady sliding.
fn across(tangent: &Tangent, load: f64, speed: f64) -> ChannelGain {
    ChannelGain { slope: tangent.mu * load / speed, ..ChannelGain::default() }
}

/// Factor of the stiffness of all pairs in a sample; 1 where the case does not give the factor.
pub(super) fn stiffness_factor(
    case: &FiniteElementCase,
    sample: &FiniteElementSample,
    scales: Scales<'_>,
) -> Result<f64, CaseError> {
    let Some(contact) = &case.contact else { return Ok(1.0) };
    let own = positive(case, contact.stiffness_factor.as_ref(), STIFFNESS_FACTOR, sample)?.unwrap_or(1.0);
    // Rough faces are stiffer the more they are pressed on each other.
    Ok(own * (load_factor(case, contact, sample)? * scales.load).powf(contact.load_exponent))
}
