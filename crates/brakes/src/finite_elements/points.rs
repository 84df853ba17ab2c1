//! Operating points of the scenes of a finite element brake, and of the whole of it.

use linsys::{Channel, ChannelGain, DofMap, OperatingPoint};
use sparse::SparseSecondOrder;

use super::FiniteElementSample;
use super::samples::{law_and_speed, load_factor, median};
use super::sliding::{Scales, UNSCALED, sliding, stiffness_factor};
use crate::Error;
use crate::case::{CaseError, FiniteElementCase, Law, Patch, PatchContact};

/// The operating point of the configuration with the patches `closed` in contact, under a law at a speed: the coefficients of the case's terms, then
/// one for all that is constant in it, and the gains of closed patches, then the gains of what relaxes.
pub(super) fn scene_point(
    case: &FiniteElementCase,
    closed: &[usize],
    friction: Option<(Law, f64)>,
    sample: &FiniteElementSample,
) -> Result<OperatingPoint, Error> {
    scaled_point(case, closed, friction, sample, UNSCALED)
}

/// The operating point of a configuration as [`scene_point`], with the loads multiplied. An equilibrium is found with the multiplied stiffness of the patches,
/// but the coefficients are not multiplied: only in a point of the whole brake, by [`of_brake`], has each patch a coefficient of its own.
pub(super) fn scaled_point(
    case: &FiniteElementCase,
    closed: &[usize],
    friction: Option<(Law, f64)>,
    sample: &FiniteElementSample,
    scales: Scales<'_>,
) -> Result<OperatingPoint, Error> {
    let (coefficients, factor) = coefficients(case, sample, scales)?;
    let mut gains = match sliding((case, closed), friction, sample, scales)? {
        Some(scene) => scene.gains(&coefficients, factor)?,
        None => Vec::new(),
    };
    gains.extend(case.gains_of_branches(&sample.values, &coefficients)?);
    Ok(OperatingPoint { coefficients, channels: gains })
}

/// Flags of the points of closed patches at an operating point as by [`scaled_point`], patch by patch: true of those that press. Empty where loads are
/// given.
pub(super) fn closed_points(
    case: &FiniteElementCase,
    closed: &[usize],
    friction: Option<(Law, f64)>,
    sample: &FiniteElementSample,
    scales: Scales<'_>,
) -> Result<Vec<bool>, Error> {
    let (coefficients, factor) = coefficients(case, sample, scales)?;
    let scene = sliding((case, closed), friction, sample, scales)?;
    scene.map_or_else(|| Ok(Vec::new()), |scene| scene.pressing(&coefficients, factor))
}

/// Coefficients of the terms at a sample, as an operating point of a scene has them, and the factor of the stiffness of all pairs.
pub(super) fn coefficients(
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

/// Indices of the ranges of speed in which a law is studied. There is one `None` alone where it has no range: Amontons-Coulomb friction does not depend on
/// speed, unless it acts across the sliding, and parameters of the case may give the speed.
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
    let (friction, median) = naming(case);
    scene_point(case, closed, friction, &median).map_err(no_median(case))
}

/// True where loads follow from an equilibrium and, at the point at which modes are named, no point of the closed patches presses.
pub(super) fn none_presses(case: &FiniteElementCase, closed: &[usize]) -> Result<bool, Error> {
    let (friction, median) = naming(case);
    let presses = closed_points(case, closed, friction, &median, UNSCALED).map_err(no_median(case))?;
    Ok(!presses.is_empty() && !presses.contains(&true))
}

/// Law with its speed, and the sample, with which modes are named.
fn naming(case: &FiniteElementCase) -> (Option<(Law, f64)>, FiniteElementSample) {
    let law = case.contact.as_ref().map_or(Law::AmontonsCoulomb, PatchContact::naming_law);
    let median = median(case);
    let range = case.contact.as_ref().and_then(|contact| speeds_of(contact, law).first().copied().flatten());
    (law_and_speed(case, Some((law, range)), &median), median)
}

/// The operating point of the whole brake from the operating point `at` of a configuration: holders have the coefficient 1, closed patches the drawn
/// factor of their stiffness, open patches 0.
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
    for (channel, gain) in own_channels(case, closed).zip(&at.channels) {
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
    // The loads of an equilibrium have the factor already.
    let factor = if contact.balance.is_some() { 1.0 } else { load_factor(case, contact, &median(case))? };
    let of_patch = |patch: &Patch| patch.shares.iter().map(|share| patch.load * share * factor).collect();
    Ok(contact.patches.iter().map(of_patch).collect())
}

/// The whole brake at the medians with all patches closed and without friction, which leaves what relaxes, on the rows that a set of constraints leaves free.
///
/// # Errors
/// [`study::Error::Median`] where the medians have no operating point; matrices that make no system.
pub fn frictionless(case: &FiniteElementCase, fixed: &[usize]) -> Result<(DofMap, SparseSecondOrder), Error> {
    let mut at = at_medians(case)?;
    without_friction(case.system.channels(), &mut at);
    let dofs = DofMap::new(case.dofs.len(), fixed)?;
    let system = case.system.on(&dofs)?.assemble(&at)?;
    Ok((dofs, system))
}

/// Indices of all patches, from 0; none without a contact.
pub(super) fn all_patches(case: &FiniteElementCase) -> Vec<usize> {
    (0..case.contact.as_ref().map_or(0, |contact| contact.patches.len())).collect()
}

/// Takes the friction of all contacts out of an operating point of `channels`; what relaxes stays.
pub(super) fn without_friction(channels: &[Channel], at: &mut OperatingPoint) {
    let contacts = channels.iter().zip(&mut at.channels).filter(|(channel, _)| channel.is_contact);
    contacts.for_each(|(_, gain)| *gain = ChannelGain::default());
}

/// Channels of the configuration with the patches `closed` in contact, by their indices in the system: channels of the patches, then of what relaxes.
pub(super) fn own_channels<'a>(case: &'a FiniteElementCase, closed: &'a [usize]) -> impl Iterator<Item = usize> + 'a {
    closed.iter().flat_map(|&patch| channels_of(case, patch)).chain(case.channels_of_branches())
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
