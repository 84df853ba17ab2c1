//! The scenes of a finite element brake.

use std::f64::consts::TAU;

use linsys::{AffineSystem, SecondOrder, Term};
use osc_model::{Body, Brake, Sectors};
use reduction::Reduced;
use study::{Configuration, Origin, Plan, SceneLabels, Units};

use super::points::{ConstantTerm, all_patches, constant_terms, naming_point, none_presses, own_channels, speeds_of};
use crate::Error;
use crate::case::{FiniteElementCase, PatchContact};
use crate::labels::friction_labels;

/// Most arrangements that a sentence names; chosen.
const MOST_NAMED: usize = 5;

/// The plan, and the closed patches of each of its configurations.
///
/// `origins` has the reduced brake of each set of constraints with all patches closed, `configurations` the reduced brake of each configuration.
pub(super) fn plan(
    case: &FiniteElementCase,
    origins: &[&Reduced],
    configurations: &[&Reduced],
) -> Result<(Plan, Vec<Vec<usize>>), Error> {
    let mut plan = case.header.plan(case.identity());
    plan.band = Some(case.reduction.frequencies.map(|hz| TAU * hz));
    plan.least_growth = Some(case.reduction.growth[0]);
    if let Some(contact) = &case.contact {
        plan.labels = labels(contact, case.header.units);
    }
    let mut closed = Vec::new();
    for (set, constraints) in origins.iter().zip(&case.constraints) {
        let all = all_patches(case);
        let whole = (brake(case, set, &all)?, naming_point(case, &all)?);
        match &case.contact {
            None => {
                plan.add_constraint_set(&constraints.name, whole.0, whole.1);
                closed.push(Vec::new());
            }
            Some(contact) => {
                plan.labels.constraints.push(constraints.name.clone());
                plan.origins.push(Origin { brake: whole.0.into(), naming_point: whole.1 });
                add_scenes(case, configurations, contact, &mut plan, &mut closed)?;
            }
        }
    }
    plan.doubts.extend(nothing_rubs(case, &plan, &closed)?);
    Ok((plan, closed))
}

/// Sentence on configurations in which no contact point is closed at the medians.
fn nothing_rubs(case: &FiniteElementCase, plan: &Plan, closed: &[Vec<usize>]) -> Result<Option<String>, Error> {
    let mut open = Vec::new();
    for (configuration, closed) in plan.configurations.iter().zip(closed) {
        if none_presses(case, closed)? {
            open.push(format!("{} ({})", configuration.contacts, plan.labels.constraints[configuration.origin]));
        }
    }
    Ok((!open.is_empty()).then(|| {
        let (number, all) = (open.len(), plan.configurations.len());
        open.truncate(MOST_NAMED);
        format!(
            "NOTHING RUBS at the medians in {number} of {all} arrangements of contacts: none of their points is closed ({}). Look at the signs of [[forces]].",
            open.join(", ")
        )
    }))
}

/// Adds the configurations and scenes of a set of constraints with a contact.
fn add_scenes(
    case: &FiniteElementCase,
    configurations: &[&Reduced],
    contact: &PatchContact,
    plan: &mut Plan,
    closed: &mut Vec<Vec<usize>>,
) -> Result<(), Error> {
    let constraints = plan.origins.len() - 1;
    for (panel, (_, arrangements)) in contact.panels.iter().enumerate() {
        for (at, arrangement) in arrangements.iter().enumerate() {
            let in_contact = arrangement.in_contact().to_vec();
            let configuration = Configuration {
                brake: brake(case, configurations[plan.configurations.len()], &in_contact)?.into(),
                naming_point: naming_point(case, &in_contact)?,
                origin: constraints,
                contacts: arrangement.to_string(),
            };
            let wants_work = in_contact.len() == contact.patches.len();
            let speeds = |law: usize| speeds_of(contact, contact.laws[law]);
            plan.add_configuration(configuration, panel, &[at], wants_work, speeds);
            closed.push(in_contact);
        }
    }
    Ok(())
}

/// The reduced brake with the patches `closed` in contact. Its constant parts, the holders, and the closed patches unless their stiffness is drawn, are
/// summed in one term; open patches have neither a term nor channels.
///
/// A reduced coordinate moves the whole brake, so that there is one body. The friction of each patch is a force family of its own.
fn brake(case: &FiniteElementCase, on: &Reduced, closed: &[usize]) -> Result<Brake, Error> {
    let (reduced, own) = (on.system(), case.coefficients.len());
    let mut terms = reduced.terms()[..own].to_vec();
    let patches = case.contact.as_ref().map_or(0, |contact| contact.patches.len());
    let holders = own..reduced.terms().len() - patches;
    let contact = || closed.iter().map(|patch| holders.end + patch);
    let sum = |name, family, terms: &mut dyn Iterator<Item = usize>| {
        let mut sum = SecondOrder::zeros(reduced.order(), 0);
        for matrices in terms.map(|term| reduced.terms()[term].matrices()) {
            sum.c += &matrices.c;
            sum.k += &matrices.k;
        }
        Term::new(name, family, sum)
    };
    for term in constant_terms(case) {
        terms.push(match term {
            ConstantTerm::Holders => sum("holders", "holders", &mut holders.clone()),
            ConstantTerm::Contact => sum("contact", "contact", &mut contact()),
            ConstantTerm::HoldersAndContact => {
                sum("holders and contact", "holders", &mut holders.clone().chain(contact()))
            }
        }?);
    }
    let channels = own_channels(case, closed).map(|channel| reduced.channels()[channel].clone()).collect();
    let system = AffineSystem::new(terms, channels)?;
    let (order, channels) = (system.order(), system.channels().len());
    Ok(Brake {
        dofs: linsys::DofMap::all(order),
        bodies: vec![Body { name: "brake".into(), dofs: (0..order).collect() }],
        sectors: Sectors::whole(order, channels),
        system,
    })
}

fn labels(contact: &PatchContact, units: Units) -> SceneLabels {
    SceneLabels {
        named_at: "with all patches in contact, Amontons-Coulomb, median parameters".into(),
        ..friction_labels(&contact.laws, &contact.speeds, &contact.panels, units)
    }
}
