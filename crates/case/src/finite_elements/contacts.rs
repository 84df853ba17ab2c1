//! The contact of a case, whatever it is between: its patches, and what they share.

use std::sync::Arc;

use montecarlo::Distribution;
use sparse::SparseTerm;

use super::contact::Patches;
use super::entries::LateralEntry;
use super::faces::Solids;
use super::nodes::Model;
use super::schema::{ContactEntry, ContactTable, FrictionTable};
use super::structure::Structure;
use super::surface_contact::SurfaceContact;
use super::surface_loads::{Pressing, balanced};
use super::surface_schema::{AllContactsTable, FacesTable, ForceTable};
use super::surfaces::Surfaces;
use super::{
    ContactBalance, FRICTION_FACTOR, LOAD_FACTOR, OWN_SPEED, OwnSpeed, Patch, PatchContact, STIFFNESS_FACTOR,
    SpreadParameters,
};
use crate::arrangements::arrangements_by_number;
use crate::check::{Check, field};
use crate::expression::formulas::{Formula, Formulas};
use crate::lattice::{distributions, note_speeds, speed_ranges};
use crate::schema::BristleDampingEntry;
use crate::{CaseError, Draws, Expression, FrictionDistributions, Law, schema};

/// Ratios of the stiffness of a contact to that of the bodies at its nodes, as sums over the diagonal there, of which nothing is said. Chosen: a lining presses with
/// about a hundredth, penalties with a hundred times; numbers per area in other units are off by 1e9.
const PLAUSIBLE: [f64; 2] = [1e-6, 1e4];

/// The tables of a case about contacts.
pub(super) struct GivenContacts {
    pub contact: Option<ContactEntry>,
    pub all: Option<AllContactsTable>,
    pub forces: Vec<ForceTable>,
    pub laws: Vec<Law>,
    pub speeds: Vec<schema::SpeedsTable>,
    pub friction: Option<FrictionTable>,
}

/// The contact of a case with its terms and channels; `None` for a case without contact.
///
/// # Errors
/// Tables that nothing uses, and what is wrong in the tables of the contact.
pub(super) fn read_contact(
    model: &Model<'_>,
    formulas: &mut Formulas<'_>,
    structure: &Structure<'_>,
    given: GivenContacts,
) -> Result<Option<(PatchContact, Patches)>, CaseError> {
    let check = model.check;
    let GivenContacts { contact, all, forces, laws, speeds, friction } = given;
    let unused = |allowed: &str, given: &[(&str, bool)]| match given.iter().find(|(_, is_given)| *is_given) {
        Some((field, _)) => Err(check.value(field, "given", allowed)),
        None => Ok(()),
    };
    if !matches!(contact, Some(ContactEntry::OfFaces(_))) {
        let allowed = "cases with contacts between faces, [[contact]]";
        unused(allowed, &[("all_contacts", all.is_some()), ("forces", !forces.is_empty())])?;
    }
    let (mut patches, shared) = match contact {
        None => {
            // A law that is named and used by nothing says nothing wrong; its parameters would be drawn for nothing.
            let allowed = "cases with a contact: nothing else has friction by a law";
            unused(allowed, &[("friction", friction.is_some()), ("speeds", !speeds.is_empty())])?;
            return Ok(None);
        }
        Some(ContactEntry::OfNodes(table)) => of_nodes(model, formulas, *table, speeds.is_empty())?,
        Some(ContactEntry::OfFaces(tables)) => {
            let mu = friction.as_ref().map_or(0.0, |friction| friction.mu.median());
            let given = (tables.as_slice(), all.unwrap_or_default(), forces.as_slice());
            of_faces(model, formulas, given, structure, (speeds.is_empty(), mu))?
        }
    };
    let friction = friction.ok_or_else(|| check.value("friction", "missing", "a table, as there is a contact"))?;
    report_stiffness(structure, &patches)?;
    let own = std::mem::take(&mut patches.patches);
    Ok(Some((patch_contact(check, shared, own, (laws, speeds, friction))?, patches)))
}

/// Asks for the units of the patch that is softest or stiffest beside the bodies at its nodes, where that is not plausible.
fn report_stiffness(structure: &Structure<'_>, patches: &Patches) -> Result<(), CaseError> {
    let of_bodies = structure.diagonal_at_medians()?;
    let ratio = |term: &SparseTerm| {
        let diagonal = term.matrices.k.diagonal_as_csc();
        let at_nodes = diagonal.triplet_iter().filter(|(_, _, spring)| **spring != 0.0);
        let [springs, bodies] =
            at_nodes.fold([0.0; 2], |[springs, bodies], (row, _, spring)| [springs + spring, bodies + of_bodies[row]]);
        springs / bodies
    };
    // A patch without closed springs, or on rows that nothing makes stiff, has no ratio.
    let ratios =
        patches.terms.iter().map(|term| (term, ratio(term))).filter(|(_, ratio)| ratio.is_normal() && *ratio > 0.0);
    let far = |(_, ratio): &(&SparseTerm, f64)| (ratio / (PLAUSIBLE[0] * PLAUSIBLE[1]).sqrt()).ln().abs();
    let Some((term, ratio)) = ratios.max_by(|a, b| far(a).total_cmp(&far(b))) else { return Ok(()) };
    if !(PLAUSIBLE[0]..=PLAUSIBLE[1]).contains(&ratio) {
        structure.check.note(format!(
            "the springs of patch {:?} are {ratio:.1e} times as stiff as the bodies at their nodes; is the stiffness of the contact in the units of the matrices?",
            term.name
        ));
    }
    Ok(())
}

/// A contact between nodes at the same places.
fn of_nodes(
    model: &Model<'_>,
    formulas: &mut Formulas<'_>,
    mut table: ContactTable,
    no_speed: bool,
) -> Result<(Patches, Shared), CaseError> {
    let Factors { stiffness_factor, friction_factor, has_spring_channels } =
        Factors::new(formulas, [table.stiffness_factor.take(), table.friction_factor.take()])?;
    let is_lateral = lateral(model.check, "contact", table.lateral, no_speed);
    if !is_lateral {
        table.lateral = Some(LateralEntry::None);
    }
    let patches = Patches::new(model, &table, has_spring_channels)?;
    let ContactTable { in_contact, arrangements, draws, bristle_damping, .. } = table;
    let shared = Shared {
        arranged: schema::ContactTable { in_contact, arrangements },
        draws,
        bristle_damping,
        is_lateral,
        stiffness_factor,
        friction_factor,
        own_friction_factors: vec![None],
        has_spring_channels,
        load_factor: None,
        load_exponent: 0.0,
        has_power_law: false,
        own_speed: None,
        balance: None,
        is_of_faces: false,
    };
    Ok((patches, shared))
}

/// Contacts between faces.
fn of_faces(
    model: &Model<'_>,
    formulas: &mut Formulas<'_>,
    (tables, mut all, forces): (&[FacesTable], AllContactsTable, &[ForceTable]),
    structure: &Structure<'_>,
    (no_ranges, mu): (bool, f64),
) -> Result<(Patches, Shared), CaseError> {
    let check = model.check;
    let mut taken = |field: &str, given: Option<Formula>| {
        given.map(|given| formulas.expression(field, Some(given), 1.0)).transpose()
    };
    let load_factor = taken(LOAD_FACTOR, all.load_factor.take())?;
    let speed = taken(OWN_SPEED, all.speed.take())?;
    let Factors { stiffness_factor, friction_factor, has_spring_channels } =
        Factors::new(formulas, [all.stiffness_factor.take(), all.friction_factor.take()])?;
    if speed.is_some() && !no_ranges {
        return Err(check.value("speeds", "given", "cases without all_contacts.speed, which says the speed"));
    }
    let is_lateral = lateral(check, "all_contacts", all.lateral, no_ranges && speed.is_none());
    if !forces.is_empty() && !tables.iter().any(FacesTable::is_in_equilibrium) {
        return Err(check.value("forces", "given", "contacts in equilibrium, load = \"equilibrium\""));
    }
    let factor_of_force = |table: &ForceTable| {
        let key = field("forces", &table.name, "coefficient");
        let factor = formulas.expression(&key, table.coefficient.clone(), 1.0)?;
        Ok((structure.value(key, &factor)?, factor))
    };
    let at_medians = forces.iter().map(factor_of_force).collect::<Result<Vec<_>, CaseError>>()?;
    let mut own_factor = |table: &FacesTable| {
        let given = table.friction_factor.clone()?;
        let key = field("contact", &table.name, "friction_factor");
        Some(formulas.local_expression(&key, Some(given), 1.0).map(|factor| (key, factor)))
    };
    let own_friction_factors =
        tables.iter().map(|table| own_factor(table).transpose()).collect::<Result<Vec<_>, CaseError>>()?;
    let median = |field: &str, factor: Option<&Expression>| match factor {
        None => Ok(1.0),
        Some(factor) => match structure.value(field.to_owned(), factor)? {
            value if value > 0.0 => Ok(value),
            value => Err(check.value(field, value, "> 0")),
        },
    };
    let load = median(LOAD_FACTOR, load_factor.as_ref())?;
    let mu = mu * median(FRICTION_FACTOR, friction_factor.as_ref())?;
    let own_mu = |own: &Option<(String, Expression)>| match own {
        None => Ok(mu),
        Some((field, factor)) => Ok(mu * median(field, Some(factor))?),
    };
    let pressing = Pressing {
        forces,
        at_medians: at_medians.iter().map(|(value, _)| load * value).collect(),
        factors: at_medians.into_iter().map(|(_, factor)| factor).collect(),
        mu: own_friction_factors.iter().map(own_mu).collect::<Result<_, CaseError>>()?,
        stiffness: median(STIFFNESS_FACTOR, stiffness_factor.as_ref())?,
    };
    let solids = Solids::new(model, "[[contact]]")?;
    let in_equilibrium = |contacts: &[SurfaceContact<'_>]| balanced(&solids, contacts, structure, &pressing);
    let Surfaces { patches, mean_speed, balance } =
        Surfaces::new(&solids, (tables, load), [is_lateral, has_spring_channels], &in_equilibrium)?;
    let in_contact = match (all.in_contact.is_empty(), all.arrangements.is_empty()) {
        (true, true) => vec![patches.patches.len()],
        _ => all.in_contact,
    };
    let shared = Shared {
        arranged: schema::ContactTable { in_contact, arrangements: all.arrangements },
        draws: all.draws.unwrap_or(Draws::Shared),
        bristle_damping: all.bristle_damping.unwrap_or(BristleDampingEntry::Constant),
        is_lateral,
        has_spring_channels: has_spring_channels || balance.is_some(),
        stiffness_factor,
        friction_factor,
        own_friction_factors,
        load_exponent: match balance {
            None => load_exponent(check, tables, load_factor.is_some())?,
            Some(_) => 0.0,
        },
        has_power_law: tables.iter().any(|table| table.load_exponent() != 0.0),
        balance,
        load_factor,
        own_speed: speed.map(|speed| OwnSpeed { speed, factor: mean_speed }),
        is_of_faces: true,
    };
    Ok((patches, shared))
}

/// Factors of the stiffness and the friction of contacts, in which parameters over patches and faces may occur.
struct Factors {
    stiffness_factor: Option<Expression>,
    friction_factor: Option<Expression>,
    /// True if the stiffness differs between patches or pairs, which then have a channel for their springs.
    has_spring_channels: bool,
}

impl Factors {
    fn new(formulas: &mut Formulas<'_>, [stiffness, friction]: [Option<Formula>; 2]) -> Result<Self, CaseError> {
        let mut read = |field: &str, given: Option<Formula>| {
            given.map(|given| formulas.local_expression(field, Some(given), 1.0)).transpose()
        };
        let stiffness_factor = read(STIFFNESS_FACTOR, stiffness)?;
        let friction_factor = read(FRICTION_FACTOR, friction)?;
        let has_spring_channels = stiffness_factor.as_ref().is_some_and(|factor| formulas.is_local(factor));
        Ok(Self { stiffness_factor, friction_factor, has_spring_channels })
    }
}

/// Numbers that the patches of a case share, whatever its contact is between.
struct Shared {
    arranged: schema::ContactTable,
    draws: Draws,
    bristle_damping: BristleDampingEntry,
    is_lateral: bool,
    has_spring_channels: bool,
    stiffness_factor: Option<Expression>,
    friction_factor: Option<Expression>,
    own_friction_factors: Vec<Option<(String, Expression)>>,
    load_factor: Option<Expression>,
    load_exponent: f64,
    has_power_law: bool,
    own_speed: Option<OwnSpeed>,
    balance: Option<ContactBalance>,
    is_of_faces: bool,
}

/// By which power of the load factor the contacts' stiffness grows, `1 - 1/m` of all of them.
fn load_exponent(check: &Check<'_>, tables: &[FacesTable], is_drawn: bool) -> Result<f64, CaseError> {
    let mut exponents = tables.iter().map(FacesTable::load_exponent);
    let first = exponents.next().unwrap_or_default();
    if is_drawn && exponents.any(|other| other != first) {
        let allowed = "contacts of one law: { c, m } with the same m in all, or in none";
        return Err(check.value(LOAD_FACTOR, "given", allowed));
    }
    Ok(first)
}

/// True if friction acts across the sliding too. This friction depends on the speed; where the case gives no speed it is left out, and a note says so.
fn lateral(check: &Check<'_>, table: &str, given: Option<LateralEntry>, no_speed: bool) -> bool {
    if given.is_none() && no_speed {
        check.note(format!(
            "no [[speeds]], so no friction across the sliding: its damping is left out ({table}.lateral)"
        ));
        return false;
    }
    given != Some(LateralEntry::None)
}

fn patch_contact(
    check: &Check<'_>,
    shared: Shared,
    patches: Vec<Patch>,
    (laws, speeds, friction): (Vec<Law>, Vec<schema::SpeedsTable>, FrictionTable),
) -> Result<PatchContact, CaseError> {
    if laws.is_empty() {
        return Err(check.value("study.laws", "[]", "one law or more"));
    }
    check.no_repeats("study.laws", laws.iter().map(ToString::to_string))?;
    let Shared { is_lateral, own_speed, .. } = shared;
    let depends_on_speed = is_lateral || laws.iter().any(|&law| law != Law::AmontonsCoulomb);
    if is_lateral && speeds.is_empty() && own_speed.is_none() {
        let allowed = "a range of speed or more, on which friction across the sliding depends; or contact.lateral = \"none\" without it";
        return Err(check.value("speeds", "missing", allowed));
    }
    let needs_ranges = depends_on_speed && own_speed.is_none();
    let friction = distributions(check, of_laws(check, &laws, friction)?)?;
    let speeds = if needs_ranges || !speeds.is_empty() { speed_ranges(check, speeds)? } else { Vec::new() };
    note_speeds(check, &laws, &friction, &speeds);
    Ok(PatchContact {
        panels: arrangements_by_number(check, &shared.arranged, patches.len())?,
        patches,
        friction,
        laws,
        speeds,
        draws: shared.draws,
        bristle_damping: shared.bristle_damping.into(),
        is_lateral,
        has_spring_channels: shared.has_spring_channels,
        stiffness_factor: shared.stiffness_factor,
        friction_factor: shared.friction_factor,
        own_friction_factors: shared.own_friction_factors,
        spread: SpreadParameters::default(),
        load_factor: shared.load_factor,
        load_exponent: shared.load_exponent,
        has_power_law: shared.has_power_law,
        own_speed,
        balance: shared.balance.map(Arc::new),
        is_of_faces: shared.is_of_faces,
    })
}

/// The distributions of the parameters that some law has; one that none has does not matter, and is 1 where it is left out.
fn of_laws(check: &Check<'_>, laws: &[Law], given: FrictionTable) -> Result<FrictionDistributions, CaseError> {
    let FrictionTable { mu, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2 } = given;
    let take =
        |name: &str, given: Option<Distribution>, of: &[Law]| match (given, laws.iter().find(|law| of.contains(law))) {
            (Some(given), _) => Ok(given),
            (None, None) => Ok(Distribution::Constant { value: 1.0 }),
            (None, Some(law)) => {
                let allowed = format!("a distribution, as {law} friction has it");
                Err(check.value(&format!("friction.{name}"), "missing", &allowed))
            }
        };
    let (falling, stribeck) = ([Law::VelocityDependent, Law::Stribeck, Law::LuGre], [Law::Stribeck, Law::LuGre]);
    Ok(FrictionDistributions {
        mu,
        mu_s: take("mu_s", mu_s, &falling)?,
        mu_k: take("mu_k", mu_k, &falling)?,
        alpha: take("alpha", alpha, &[Law::VelocityDependent])?,
        v_s: take("v_s", v_s, &stribeck)?,
        sigma0: take("sigma0", sigma0, &[Law::LuGre])?,
        sigma1: take("sigma1", sigma1, &[Law::LuGre])?,
        sigma2: take("sigma2", sigma2, &stribeck)?,
    })
}
