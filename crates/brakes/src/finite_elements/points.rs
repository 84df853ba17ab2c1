//! Samples and operating points of a finite element brake.

use std::sync::Arc;

use friction::Tangent;
use linsys::{ChannelGain, DofMap, Lag, OperatingPoint};
use montecarlo::StreamRng;
use nalgebra_sparse::CscMatrix;
use sparse::SparseSecondOrder;

use super::FiniteElementSample;
use crate::Error;
use crate::LatticeSample;
use crate::case::{
    Acting, CaseError, ContactBalance, ContactState, Draws, EQUILIBRIUM, Expression, FiniteElementCase, LOAD_FACTOR,
    Law, OWN_SPEED, Patch, PatchContact, STIFFNESS_FACTOR,
};
use crate::lattice::FrictionDraw;

/// Speed at which a law that does not depend on speed is evaluated, m/s; any value gives the same result.
const ANY_SPEED: f64 = 1.0;

/// A law with the index of its range of speed, where it has one; `None` without a contact.
pub(super) type State = Option<(Law, Option<usize>)>;

/// The law of a state, with the sliding speed of a sample, m/s.
pub(super) fn law_and_speed(
    case: &FiniteElementCase,
    state: State,
    sample: &FiniteElementSample,
) -> Option<(Law, f64)> {
    let (contact, (law, range)) = case.contact.as_ref().zip(state)?;
    Some((law, speed(contact, range, sample)))
}

/// Draws a sample: the parameters, then friction and speed.
pub(super) fn draw(case: &FiniteElementCase, rng: &mut StreamRng) -> Result<FiniteElementSample, Error> {
    let values = case.parameters.iter().map(|parameter| parameter.distribution.draw(rng)).collect::<Result<_, _>>()?;
    let of_contact = |contact: &PatchContact| {
        let count = if contact.draws == Draws::Shared { 1 } else { contact.patches.len() };
        LatticeSample::draw_for(&contact.friction, None, count, rng)
    };
    Ok(correlated(case, FiniteElementSample { values, contacts: case.contact.as_ref().map(of_contact).transpose()? }))
}

/// A sample from independent draws: of the contacts, and of the parameters of coefficients with those that all patches share.
pub(super) fn correlated(case: &FiniteElementCase, sample: FiniteElementSample) -> FiniteElementSample {
    let Some(correlation) = &case.correlation else { return sample };
    let FiniteElementSample { values, contacts } = sample;
    match (&case.contact, contacts) {
        (Some(contact), Some(contacts)) if contact.draws == Draws::Each => {
            let contacts = Some(contacts.correlated(&contact.friction, Some(correlation)));
            FiniteElementSample { values, contacts }
        }
        (contact, contacts) => {
            let of_friction = contact.iter().flat_map(|contact| contact.friction.of_draw());
            let distributions: Vec<_> =
                of_friction.chain(case.parameters.iter().map(|own| &own.distribution)).collect();
            let mut all: Vec<f64> = contacts.iter().flat_map(|contacts| contacts.contact(0).values()).collect();
            let friction = all.len();
            all.extend(values);
            correlation.apply(&distributions, &mut [&mut all]);
            let contacts = contacts.map(|contacts| match all.first_chunk() {
                Some(draw) => LatticeSample::shared(FrictionDraw::from_values(*draw), contacts.speed_quantile),
                None => contacts,
            });
            FiniteElementSample { values: all.split_off(friction), contacts }
        }
    }
}

/// The sample with the medians of all distributions.
pub(super) fn median(case: &FiniteElementCase) -> FiniteElementSample {
    FiniteElementSample {
        values: case.parameters.iter().map(|parameter| parameter.distribution.median()).collect(),
        contacts: case.contact.as_ref().map(|contact| LatticeSample::median_of(&contact.friction)),
    }
}

/// The sliding speed of a sample in a range of speeds, m/s.
fn speed(contact: &PatchContact, range: Option<usize>, sample: &FiniteElementSample) -> f64 {
    let quantile = sample.contacts.as_ref().map_or(0.5, |contacts| contacts.speed_quantile);
    range.map_or(ANY_SPEED, |range| contact.speeds[range].quantile(quantile))
}

/// The operating point of a configuration with some patches closed, under a law at a speed: the coefficients of the case's terms, then
/// one for all that is constant in it, and the gains of closed patches.
pub(super) fn scene_point(
    case: &FiniteElementCase,
    closed: &[usize],
    friction: Option<(Law, f64)>,
    sample: &FiniteElementSample,
) -> Result<OperatingPoint, Error> {
    scaled_point(case, closed, friction, sample, UNSCALED)
}

/// The operating point of a configuration as [`scene_point`], with loads multiplied, and in equilibrium with that of patches whose stiffness is
/// multiplied; that itself is not, which [`of_brake`] takes apart.
pub(super) fn scaled_point(
    case: &FiniteElementCase,
    closed: &[usize],
    friction: Option<(Law, f64)>,
    sample: &FiniteElementSample,
    scales: Scales<'_>,
) -> Result<OperatingPoint, Error> {
    let (coefficients, factor) = coefficients(case, sample, scales)?;
    let gains = match sliding((case, closed), friction, sample, scales)? {
        Some(scene) => scene.gains(&coefficients, factor)?,
        None => Vec::new(),
    };
    Ok(OperatingPoint { coefficients, channels: gains })
}

/// Flags of the points of closed patches at an operating point as by [`scaled_point`], patch by patch: true of those that press. None where
/// loads are given.
pub(super) fn closed_points(
    case: &FiniteElementCase,
    closed: &[usize],
    friction: Option<(Law, f64)>,
    sample: &FiniteElementSample,
    scales: Scales<'_>,
) -> Result<Vec<bool>, Error> {
    let (coefficients, factor) = coefficients(case, sample, scales)?;
    let Some(scene) = sliding((case, closed), friction, sample, scales)? else { return Ok(Vec::new()) };
    let Loaded { state, .. } = scene.loaded(&coefficients, factor)?;
    let Some((_, state)) = state else { return Ok(Vec::new()) };
    let points = closed.iter().flat_map(|&patch| &scene.contact.patches[patch].points);
    Ok(points.map(|&point| state.forces[point] > 0.0).collect())
}

/// Coefficients of the terms at a sample, as an operating point of a scene has them, and the factor of the stiffness of all pairs.
fn coefficients(
    case: &FiniteElementCase,
    sample: &FiniteElementSample,
    scales: Scales<'_>,
) -> Result<(Vec<f64>, f64), Error> {
    let named = |name: &str, source| CaseError::Expression {
        path: case.header.path.clone(),
        field: format!("terms {name:?}.coefficient"),
        source: Box::new(source),
    };
    let terms = case.system.terms().iter().zip(&case.coefficients);
    let coefficients =
        terms.map(|(term, coefficient)| coefficient.value(&sample.values).map_err(|source| named(&term.name, source)));
    let mut coefficients = coefficients.collect::<Result<Vec<_>, _>>()?;
    let factor = stiffness_factor(case, sample, scales)?;
    coefficients.extend(constant_terms(case).map(|term| match term {
        ConstantTerm::Contact => factor,
        ConstantTerm::Holders | ConstantTerm::HoldersAndContact => 1.0,
    }));
    Ok((coefficients, factor))
}

/// The contacts of a configuration that slide; `None` without a contact.
fn sliding<'a>(
    (case, closed): (&'a FiniteElementCase, &'a [usize]),
    friction: Option<(Law, f64)>,
    sample: &'a FiniteElementSample,
    scales: Scales<'a>,
) -> Result<Option<Sliding<'a>>, Error> {
    let Some((contact, (law, speed))) = case.contact.as_ref().zip(friction) else { return Ok(None) };
    let speed = own_speed(case, sample)?.unwrap_or(speed);
    Ok(Some(Sliding { case, contact, closed, law, speed, sample, scales }))
}

/// Factors of the load of all pairs and of the stiffness of each patch, beside those of a sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scales<'a> {
    pub load: f64,
    /// One of each patch; without any they are 1.
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
struct Sliding<'a> {
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
    /// Factor of all loads.
    load_factor: f64,
    /// Equilibrium of the points, where loads follow from one.
    state: Option<(&'a ContactBalance, Arc<ContactState>)>,
}

impl Sliding<'_> {
    /// The gains of the closed patches, with the factor of the stiffness of all of them. Of a patch with a scale those are of its pairs without it.
    fn gains(&self, coefficients: &[f64], factor: f64) -> Result<Vec<ChannelGain>, Error> {
        let Loaded { tangents, load_factor, state } = self.loaded(coefficients, factor)?;
        let mut gains = Vec::new();
        for (&number, tangents) in self.closed.iter().zip(&tangents) {
            let patch = &self.contact.patches[number];
            // The load of each pair, and what its spring is of the one that its channel reads.
            let pairs: Vec<[f64; 2]> = match &state {
                None => patch.shares.iter().map(|share| [patch.load * share * load_factor, factor]).collect(),
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
            if let Some((balance, _)) = state {
                let opening = |(&point, [_, spring]): (&usize, &[f64; 2])| ChannelGain {
                    mu: spring - factor * balance.at_medians(point),
                    ..ChannelGain::default()
                };
                gains.extend(patch.points.iter().zip(&pairs).map(opening));
            }
        }
        Ok(gains)
    }

    /// Friction and loads of the closed patches.
    fn loaded(&self, coefficients: &[f64], factor: f64) -> Result<Loaded<'_>, Error> {
        let tangents = self.closed.iter().map(|&patch| self.tangents(patch)).collect::<Result<Vec<_>, Error>>()?;
        let load_factor = load_factor(self.case, self.contact, self.sample)? * self.scales.load;
        let balance = self.contact.balance.as_deref();
        let state = balance.map(|balance| self.state(balance, &tangents, coefficients, factor, load_factor));
        let state = balance.zip(state.transpose()?);
        Ok(Loaded { tangents, load_factor, state })
    }

    /// The speed of each pair of a patch, and the tangent of the law there.
    fn tangents(&self, patch: usize) -> Result<Vec<(f64, Tangent)>, Error> {
        let Some(contacts) = &self.sample.contacts else { return Ok(Vec::new()) };
        let pairs = &self.contact.patches[patch];
        let mut tangents: Vec<(f64, Tangent)> = Vec::with_capacity(pairs.speeds.len());
        for own in pairs.speeds.iter().map(|part| part * self.speed) {
            // Pairs of one speed have one tangent.
            let known = tangents.last().filter(|(of, _)| *of == own).map(|(_, tangent)| *tangent);
            let found = || contacts.contact(patch).tangent(self.law, own, self.contact.bristle_damping);
            tangents.push((own, known.map_or_else(found, Ok)?));
        }
        Ok(tangents)
    }

    /// The equilibrium of the closed patches, whose loads are multiplied.
    fn state(
        &self,
        balance: &ContactBalance,
        tangents: &[Vec<(f64, Tangent)>],
        coefficients: &[f64],
        factor: f64,
        load_factor: f64,
    ) -> Result<Arc<ContactState>, Error> {
        let Self { case, contact, closed, .. } = *self;
        let (mut mu, mut stiffness) = (vec![0.0; balance.points()], vec![0.0; balance.points()]);
        for (&number, tangents) in closed.iter().zip(tangents) {
            for (&point, (_, tangent)) in contact.patches[number].points.iter().zip(tangents) {
                (mu[point], stiffness[point]) = (tangent.mu, factor * self.scales.of_patch(number));
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

/// A term of the reduced brake of a scene that stands for terms whose coefficients do not differ between scenes with the same closed patches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ConstantTerm {
    Holders,
    /// The term of all closed patches, whose stiffness is drawn.
    Contact,
    HoldersAndContact,
}

/// Constant terms of a reduced brake, in their order after the terms of the case file.
pub(super) fn constant_terms(case: &FiniteElementCase) -> impl Iterator<Item = ConstantTerm> + use<> {
    let patches = case.contact.as_ref().map_or(0, |contact| contact.patches.len());
    let has_holders = case.system.terms().len() > case.coefficients.len() + patches;
    let is_drawn = case.contact.as_ref().is_some_and(PatchContact::has_drawn_stiffness);
    let terms = match (is_drawn, has_holders || patches > 0) {
        (true, _) => [has_holders.then_some(ConstantTerm::Holders), Some(ConstantTerm::Contact)],
        (false, true) => [Some(ConstantTerm::HoldersAndContact), None],
        (false, false) => [None, None],
    };
    terms.into_iter().flatten()
}

/// Factor of the stiffness of all pairs in a sample; 1 where the case gives none.
fn stiffness_factor(
    case: &FiniteElementCase,
    sample: &FiniteElementSample,
    scales: Scales<'_>,
) -> Result<f64, CaseError> {
    let Some(contact) = &case.contact else { return Ok(1.0) };
    let own = positive(case, contact.stiffness_factor.as_ref(), STIFFNESS_FACTOR, sample)?.unwrap_or(1.0);
    // Rough faces are stiffer the more they are pressed on each other.
    Ok(own * (load_factor(case, contact, sample)? * scales.load).powf(contact.load_exponent))
}

/// Factor of the load of all pairs in a sample.
fn load_factor(
    case: &FiniteElementCase,
    contact: &PatchContact,
    sample: &FiniteElementSample,
) -> Result<f64, CaseError> {
    Ok(positive(case, contact.load_factor.as_ref(), LOAD_FACTOR, sample)?.unwrap_or(1.0))
}

/// The sliding speed as the parameters of a sample say it, m/s; `None` where a range does.
fn own_speed(case: &FiniteElementCase, sample: &FiniteElementSample) -> Result<Option<f64>, CaseError> {
    let contact = case.contact.as_ref().filter(|contact| contact.speeds.is_empty());
    let Some(own) = contact.and_then(|contact| contact.own_speed.as_ref()) else { return Ok(None) };
    Ok(positive(case, Some(&own.speed), OWN_SPEED, sample)?.map(|speed| speed * own.factor))
}

/// The value of an expression of the contact, which must be > 0.
fn positive(
    case: &FiniteElementCase,
    expression: Option<&Expression>,
    field: &str,
    sample: &FiniteElementSample,
) -> Result<Option<f64>, CaseError> {
    let Some(expression) = expression else { return Ok(None) };
    let (path, field) = (case.header.path.clone(), field.to_owned());
    match expression.value(&sample.values) {
        Ok(value) if value > 0.0 => Ok(Some(value)),
        Ok(value) => Err(CaseError::Value { path, field, value: value.to_string(), allowed: "> 0".into() }),
        Err(source) => Err(CaseError::Expression { path, field, source: Box::new(source) }),
    }
}

/// The ranges of speed in which a law is studied: Amontons-Coulomb friction does not depend on speed, unless it acts across the sliding. None
/// where the parameters say the speed.
pub(super) fn speeds_of(contact: &PatchContact, law: Law) -> Vec<Option<usize>> {
    let has_ranges = depends_on_speed(contact, law) && !contact.speeds.is_empty();
    if has_ranges { (0..contact.speeds.len()).map(Some).collect() } else { vec![None] }
}

/// True if the systems of a law depend on the speed, and with it on the load.
pub(super) fn depends_on_speed(contact: &PatchContact, law: Law) -> bool {
    law != Law::AmontonsCoulomb || contact.is_lateral
}

/// The point at which modes are named: friction by [`PatchContact::naming_law`] at median parameters, and the median of the first range of speed.
pub(super) fn naming_point(case: &FiniteElementCase, closed: &[usize]) -> Result<OperatingPoint, Error> {
    let law = case.contact.as_ref().map_or(Law::AmontonsCoulomb, PatchContact::naming_law);
    let median = median(case);
    let range = case.contact.as_ref().and_then(|contact| speeds_of(contact, law).first().copied().flatten());
    let friction = law_and_speed(case, Some((law, range)), &median);
    scene_point(case, closed, friction, &median).map_err(no_median(case))
}

/// The operating point of the whole brake from that of a configuration: holders count once, closed patches as their stiffness
/// is drawn, open ones not.
pub(super) fn of_brake(case: &FiniteElementCase, closed: &[usize], at: &OperatingPoint) -> OperatingPoint {
    let patches = case.contact.as_ref().map_or(0, |contact| contact.patches.len());
    let own = case.coefficients.len();
    let holders = case.system.terms().len() - own - patches;
    let mut coefficients = at.coefficients[..own].to_vec();
    coefficients.extend(std::iter::repeat_n(1.0, holders));
    let factor = constant_terms(case)
        .position(|term| term == ConstantTerm::Contact)
        .map_or(1.0, |term| at.coefficients[own + term]);
    coefficients.extend((0..patches).map(|patch| if closed.contains(&patch) { factor } else { 0.0 }));
    let mut channels = vec![ChannelGain::default(); case.system.channels().len()];
    for (channel, gain) in closed_channels(case, closed).zip(&at.channels) {
        channels[channel] = *gain;
    }
    OperatingPoint { coefficients, channels }
}

/// The operating point of the whole brake at the medians with all patches closed, under the law by which modes are named.
///
/// # Errors
/// [`study::Error::Median`] where the medians have no operating point.
pub fn at_medians(case: &FiniteElementCase) -> Result<OperatingPoint, Error> {
    let all = all_patches(case);
    Ok(of_brake(case, &all, &naming_point(case, &all)?))
}

/// The normal load of each pair of each patch at the medians with all patches closed, N; none without a contact.
///
/// # Errors
/// A factor of the load that is not > 0 there.
pub fn loads_at_medians(case: &FiniteElementCase) -> Result<Vec<Vec<f64>>, Error> {
    let Some(contact) = &case.contact else { return Ok(Vec::new()) };
    // That of an equilibrium is in it.
    let factor = if contact.balance.is_some() { 1.0 } else { load_factor(case, contact, &median(case))? };
    let of_patch = |patch: &Patch| patch.shares.iter().map(|share| patch.load * share * factor).collect();
    Ok(contact.patches.iter().map(of_patch).collect())
}

/// The whole brake at the medians with all patches closed and without friction, on the rows that a set of constraints leaves free.
///
/// # Errors
/// [`study::Error::Median`] where the medians have no operating point; matrices that make no system.
pub fn frictionless(case: &FiniteElementCase, fixed: &[usize]) -> Result<(DofMap, SparseSecondOrder), Error> {
    let mut at = at_medians(case)?;
    at.channels.fill(ChannelGain::default());
    let dofs = DofMap::new(case.dofs.len(), fixed)?;
    let system = case.system.on(&dofs)?.assemble(&at)?;
    Ok((dofs, system))
}

/// Indices of all patches, from 0; none without a contact.
pub(super) fn all_patches(case: &FiniteElementCase) -> Vec<usize> {
    (0..case.contact.as_ref().map_or(0, |contact| contact.patches.len())).collect()
}

/// Channels of closed patches, by their indices in the system.
pub(super) fn closed_channels<'a>(
    case: &'a FiniteElementCase,
    closed: &'a [usize],
) -> impl Iterator<Item = usize> + 'a {
    closed.iter().flat_map(|&patch| channels_of(case, patch))
}

/// Channels of a patch, by their indices in the system.
pub(super) fn channels_of(case: &FiniteElementCase, patch: usize) -> std::ops::Range<usize> {
    let patches = case.contact.as_ref().map_or(&[][..], |contact| &contact.patches);
    patches.get(patch).map_or(0..0, |patch| patch.channels.clone())
}

/// The error of a case whose medians have no operating point.
fn no_median(case: &FiniteElementCase) -> impl Fn(Error) -> Error + '_ {
    |source| {
        let study = case.header.path.display().to_string();
        study::Error::Median { study, source: Box::new(source.into()) }.into()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]

    use std::path::Path;

    use montecarlo::stream;

    use super::draw;
    use crate::case::{CaseFile, FiniteElementCase};

    fn case(given: &str) -> Result<FiniteElementCase, String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad");
        let text = std::fs::read_to_string(folder.join("disc-pad.toml")).unwrap();
        let text = text.replace("load = 468.0", "stiffness_factor = \"kc\"\nload = 468.0");
        let kc = "[parameters.kc]\ndistribution = \"log-normal\"\nmedian = 1.0\nsigma = 0.2\n";
        match CaseFile::parse(&folder.join("changed.toml"), format!("{text}\n{kc}{given}"))
            .map_err(|e| e.to_string())?
        {
            CaseFile::FiniteElements(case) => Ok(*case),
            other => panic!("{other:?}"),
        }
    }

    /// Friction and stiffness of the contact: their normal scores have the correlation that is asked for, each the distribution that it has alone,
    /// and what is not correlated keeps its draws.
    #[test]
    fn parameters_of_coefficients_are_correlated_with_friction() {
        let table = "[correlation]\nparameters = [\"mu\", \"kc\"]\nmatrix = [[1.0, -0.7], [-0.7, 1.0]]\n";
        let (alone, together) = (case("").unwrap(), case(table).unwrap());
        let (mut products, mut squares, count) = (0.0, 0.0, 4000);
        for at in 0..count {
            let [free, tied] = [&alone, &together].map(|case| draw(case, &mut stream(3, at)).unwrap());
            let friction = |sample: &crate::FiniteElementSample| *sample.contacts.as_ref().unwrap().contact(0);
            // mu is normal with 0.5 and 0.1, ln kc with 0 and 0.2.
            let score = (friction(&tied).mu - 0.5) / 0.1;
            products += score * tied.values[0].ln() / 0.2;
            squares += (tied.values[0].ln() / 0.2).powi(2);
            assert_eq!(friction(&free).mu, friction(&tied).mu);
            assert_eq!(friction(&free).alpha, friction(&tied).alpha);
        }
        let [correlation, variance] = [products, squares].map(|sum| sum / count as f64);
        println!("{correlation} {variance}");
        assert!((correlation + 0.7).abs() < 0.05 && (variance - 1.0).abs() < 0.08);
        // With a draw of friction for each patch there is no one mu on which kc could depend.
        let each = "draws = \"each\"\npatches = [";
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/disc-pad");
        let text = std::fs::read_to_string(folder.join("disc-pad.toml")).unwrap().replace("patches = [", each);
        let error = CaseFile::parse(&folder.join("changed.toml"), format!("{text}\n{table}")).unwrap_err().to_string();
        assert!(error.contains("correlation.parameters = \"kc\"; allowed: what is drawn: mu, "), "{error}");
    }
}
