//! Energy balance of a mode: the forces that feed and drain it, and where its energy is.

use std::f64::consts::TAU;

use cea::Mode;
use linsys::{OperatingPoint, SecondOrder};
use osc_model::Brake;
use serde::Serialize;
use study::mode_work;
use work::{ForceFamily, StructurePart, family_work, mode_energy};

use super::influence::MOST_CONTACTS;
use crate::Error;

/// Contribution of a force to the growth of a mode.
///
/// The growth is `Re lambda = sum W / (2 pi Im lambda)` over all forces that are not elastic, W their work per cycle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contribution {
    /// Name of the family, contact or term.
    pub name: String,
    /// Work W per cycle and modal mass, 1/s^2; positive feeds the mode.
    pub work: f64,
    /// Contribution to the growth, 1/s.
    pub growth: f64,
}

/// A term of a structure in a mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TermShare {
    /// Name of the term.
    pub name: String,
    /// Fraction of the kinetic energy in the term.
    pub kinetic: f64,
    /// Fraction of the strain energy in the term, by its relaxed stiffness.
    pub strain: f64,
    /// Contribution to the growth of its damping, and of a stiffness that is not symmetric, 1/s.
    pub growth: f64,
}

/// A body in a mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BodyShare {
    /// Name of the body.
    pub name: String,
    /// Fraction of the kinetic energy in the body.
    pub kinetic: f64,
    /// Fraction of the strain energy in the body; a spring between two bodies is shared by what each end does.
    pub strain: f64,
    /// Contribution to the growth of each family of forces on the body, 1/s, in the order of [`Balance::families`].
    pub growth: Vec<f64>,
}

/// The energy balance of a mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Balance {
    /// Contributions of the families of forces.
    pub families: Vec<Contribution>,
    /// Contributions of the friction of each contact; empty where there are more than a hundred.
    pub contacts: Vec<Contribution>,
    /// Shares of the terms of the structure.
    pub terms: Vec<TermShare>,
    /// Shares of the bodies.
    pub bodies: Vec<BodyShare>,
    /// Departure of the sum of the families from the growth, relative to the sum of their magnitudes: rounding.
    pub identity_residual: f64,
}

impl Balance {
    /// The balance of a mode of a brake at an operating point.
    ///
    /// # Errors
    /// An operating point of another brake; errors of [`family_work`] and [`mode_energy`].
    pub fn new(brake: &Brake, at: &OperatingPoint, mode: &Mode) -> Result<Self, Error> {
        let work = mode_work(brake, at, mode)?;
        let cycle = TAU * mode.lambda.im;
        let contribution = |name: &str, work: f64| Contribution { name: name.into(), work, growth: work / cycle };
        let system = &brake.system;
        let mass = system.mass(&at.coefficients)?;
        // The work of one force alone, over all degrees of freedom.
        let alone = |name: &str, force: &SecondOrder| -> Result<f64, Error> {
            let none: [&[usize]; 0] = [];
            Ok(family_work(&mass, &[ForceFamily { name, system: force }], mode.lambda, &mode.shape, &none)?.total)
        };
        let mut buffer = SecondOrder::zeros(system.order(), 0);

        let mut families = Vec::with_capacity(work.families.len());
        for family in &work.families {
            system.family_into(&family.name, at, &mut buffer)?;
            families.push(contribution(&family.name, alone(&family.name, &buffer)?));
        }
        let mut contacts = Vec::new();
        if system.contacts().count() <= MOST_CONTACTS {
            for (place, channel) in system.channels().iter().enumerate().filter(|(_, channel)| channel.is_contact) {
                system.channel_into(place, at, &mut buffer)?;
                contacts.push(contribution(&channel.name, alone(&channel.name, &buffer)?));
            }
        }

        let scaled = |(term, &theta): (&linsys::Term, &f64)| {
            let SecondOrder { m, c, k, internal } = term.matrices();
            SecondOrder { m: m * theta, c: c * theta, k: k * theta, internal: internal.clone() }
        };
        let mut parts: Vec<SecondOrder> = system.terms().iter().zip(&at.coefficients).map(scaled).collect();
        let named: Vec<StructurePart<'_>> = system
            .terms()
            .iter()
            .zip(&parts)
            .map(|(term, system)| StructurePart { name: &term.name, system })
            .collect();
        let energy = mode_energy(&named, mode.lambda, &mode.shape, &brake.bodies)?;
        let share = |part: f64, whole: f64| if whole == 0.0 { 0.0 } else { part / whole };
        let mut terms = Vec::with_capacity(parts.len());
        for ((term, part), (_, of_term)) in system.terms().iter().zip(&mut parts).zip(&energy.parts) {
            if term.is_elastic() {
                part.k.fill(0.0);
            }
            let mut work = alone(&term.name, part)?;
            let relaxing = system.channels().iter().enumerate();
            for (place, channel) in relaxing.filter(|(_, channel)| !channel.is_contact && channel.name == term.name) {
                system.channel_into(place, at, &mut buffer)?;
                work += alone(&channel.name, &buffer)?;
            }
            terms.push(TermShare {
                name: term.name.clone(),
                kinetic: share(of_term.kinetic, energy.total.kinetic),
                strain: share(of_term.strain, energy.total.strain),
                growth: work / cycle,
            });
        }
        let body = |(place, body): (usize, &osc_model::Body)| BodyShare {
            name: body.name.clone(),
            kinetic: share(energy.bodies[place].kinetic, energy.total.kinetic),
            strain: share(energy.bodies[place].strain, energy.total.strain),
            growth: work.families.iter().map(|family| family.bodies[place] / cycle).collect(),
        };
        let bodies = brake.bodies.iter().enumerate().map(body).collect();
        Ok(Self { families, contacts, terms, bodies, identity_residual: work.identity_residual() })
    }
}
