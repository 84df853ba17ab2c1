//! From the fields of a case file with a finite element brake to a checked case.

use std::path::Path;

use formats::{Limits, read_deck};
use montecarlo::Distribution;
use nalgebra_sparse::CscMatrix;
use sparse::{SparseAffineSystem, SparseTerm};

use super::contact::Patches;
use super::faces::Solids;
use super::missing::{MissingRows, NamesOnMesh};
use super::nodes::Model;
use super::schema::{ConstraintsTable, ContactTable, FiniteElementsFile, FrictionTable, LateralEntry, ReductionTable};
use super::surface_contact::{SurfaceContact, Surfaces};
use super::surface_loads::balanced;
use super::surface_schema::{ContactEntry, FacesTable};
use super::terms::{Terms, holders_term, read_terms, terms_with_coefficients};
use super::turning::{rotation_terms, spring_term};
use super::{
    FiniteElementCase, LOAD_FACTOR, OWN_SPEED, OwnSpeed, Patch, PatchContact, ReductionGoal, STIFFNESS_FACTOR,
};
use crate::case::arrangements::arrangements_by_number;
use crate::case::check::{Check, field, syntax};
use crate::case::correlation::Correlated;
use crate::case::matrices::formulas::Formulas;
use crate::case::matrices::read::parameter;
use crate::case::matrices::schema::Formula;
use crate::case::schema::BristleDampingEntry;
use crate::case::validate::{distributions, friction_parameters, speed_ranges};
use crate::case::{CaseError, Draws, Expression, FixedDofs, FrictionDistributions, Law, schema};

/// Most samples that are solved with the whole brake too; chosen: hours.
const MOST_FULL_CHECKS: u64 = 10_000;
/// By what the mass holds bodies that nothing else does, pads without their contact, while the stress of a turning body is found: a spring of 1 Hz,
/// (rad/s)^2; chosen, far below what a disc gives way with.
const SOFT: f64 = std::f64::consts::TAU * std::f64::consts::TAU;
/// Most training points of a reduction; chosen: each costs one evaluation for each basis.
const MOST_TRAINING: usize = 10_000;

impl FiniteElementCase {
    /// Checks the text of a case file; `path` is for messages, and files are read relative to its folder.
    ///
    /// # Errors
    /// The first fault, in one line that names the file, the field, the value and what is allowed.
    pub fn parse(path: &Path, text: String) -> Result<Self, CaseError> {
        let file: FiniteElementsFile = toml::from_str(&text).map_err(|error| syntax(path, &text, &error))?;
        let check = Check::new(path);
        let FiniteElementsFile {
            study,
            brake,
            parameters,
            terms,
            holders,
            contact,
            all_contacts,
            forces,
            rotation,
            springs,
            constraints,
            speeds,
            friction,
            reduction,
            accuracy,
            squeal,
            correlation,
        } = file;
        let mut header = check.header(text, (study.name, study.samples, study.seed), accuracy, squeal)?;
        let parameters = parameters
            .into_iter()
            .map(|(name, given)| parameter(&check, name, given))
            .collect::<Result<Vec<_>, _>>()?;
        let deck = brake.mesh.map(|file| {
            let path = path.parent().unwrap_or(Path::new("")).join(&file);
            read_deck(&path, &Limits::default()).map_err(|source| check.matrix("brake.mesh", &file, source))
        });
        let deck = deck.transpose()?;
        let Terms { parts, dofs, files, held } = read_terms(&check, terms)?;
        let model = Model::new(&check, deck, dofs);
        let mut formulas = Formulas::new(&check, &parameters);
        let (mut terms, mut coefficients) = terms_with_coefficients(&check, &mut formulas, parts, model.dofs.len())?;
        let names = NamesOnMesh::new(&model)?;
        let (mut missing_rows, mut sides) = (Vec::new(), None);
        check.names("springs.name", springs.iter().map(|table| &table.name))?;
        for table in &springs {
            let (term, coefficient) = spring_term(&model, &mut formulas, table, &mut missing_rows)?;
            terms.push(term);
            coefficients.push(coefficient);
        }
        let holders = holders_term(&model, &holders, &mut missing_rows)?;
        let medians: Vec<f64> = parameters.iter().map(|parameter| parameter.distribution.median()).collect();
        check.names("rotation.name", rotation.iter().map(|table| &table.name))?;
        if !rotation.is_empty() {
            let solids = Solids::new(&model, "rotation")?;
            let structure = at_medians(&check, &terms, &coefficients, holders.as_ref(), &medians, SOFT)?;
            for table in &rotation {
                for (term, coefficient) in rotation_terms(&solids, &mut formulas, table, &structure)? {
                    terms.push(term);
                    coefficients.push(coefficient);
                }
            }
        }
        let mut channels = Vec::new();
        let unused = |contact: &str, given: &[(&str, bool)]| match given.iter().find(|(_, is_given)| *is_given) {
            Some((field, _)) => Err(check.value(field, "given", contact)),
            None => Ok(()),
        };
        let of_faces = "cases with contacts between faces, [[contact]]";
        let contact = match contact {
            None => {
                // A law that is named and used by nothing says nothing wrong; its parameters would be drawn for nothing.
                let allowed = "cases with a contact: nothing else has friction by a law";
                unused(allowed, &[("friction", friction.is_some()), ("speeds", !speeds.is_empty())])?;
                unused(of_faces, &[("all_contacts", all_contacts.is_some()), ("forces", !forces.is_empty())])?;
                None
            }
            Some(ContactEntry::OfNodes(mut table)) => {
                unused(of_faces, &[("all_contacts", all_contacts.is_some()), ("forces", !forces.is_empty())])?;
                let factor = table.stiffness_factor.take();
                let factor =
                    factor.map(|factor| formulas.expression(STIFFNESS_FACTOR, Some(factor), 1.0)).transpose()?;
                let is_lateral = lateral(&check, "contact", table.lateral, speeds.is_empty());
                if !is_lateral {
                    table.lateral = Some(LateralEntry::None);
                }
                let of_contact = Patches::new(&model, &table)?;
                let ContactTable { in_contact, arrangements, draws, bristle_damping, .. } = *table;
                let shared = Shared {
                    arranged: schema::ContactTable { in_contact, arrangements },
                    draws,
                    bristle_damping,
                    is_lateral,
                    stiffness_factor: factor,
                    load_factor: None,
                    load_exponent: 0.0,
                    own_speed: None,
                    is_of_faces: false,
                };
                Some((of_contact, shared))
            }
            Some(ContactEntry::OfFaces(tables)) => {
                let mut all = all_contacts.unwrap_or_default();
                let mut taken = |field: &str, given: Option<Formula>| {
                    given.map(|given| formulas.expression(field, Some(given), 1.0)).transpose()
                };
                let stiffness_factor = taken(STIFFNESS_FACTOR, all.stiffness_factor.take())?;
                let load_factor = taken(LOAD_FACTOR, all.load_factor.take())?;
                let speed = taken(OWN_SPEED, all.speed.take())?;
                if speed.is_some() && !speeds.is_empty() {
                    return Err(check.value(
                        "speeds",
                        "given",
                        "cases without all_contacts.speed, which says the speed",
                    ));
                }
                let no_speed = speeds.is_empty() && speed.is_none();
                let is_lateral = lateral(&check, "all_contacts", all.lateral, no_speed);
                if !tables.iter().any(FacesTable::is_in_equilibrium) {
                    unused("contacts in equilibrium, load = \"equilibrium\"", &[("forces", !forces.is_empty())])?;
                }
                let solids = Solids::new(&model, "[[contact]]")?;
                let mu = friction.as_ref().map_or(0.0, |friction| friction.mu.median());
                let in_equilibrium = |contacts: &[SurfaceContact<'_>]| {
                    let structure = at_medians(&check, &terms, &coefficients, holders.as_ref(), &medians, 0.0)?;
                    balanced(&solids, contacts, &structure, &forces, mu)
                };
                let Surfaces { patches, mean_speed } = Surfaces::new(&solids, &tables, is_lateral, &in_equilibrium)?;
                let in_contact = match (all.in_contact.is_empty(), all.arrangements.is_empty()) {
                    (true, true) => vec![patches.patches.len()],
                    _ => all.in_contact,
                };
                let shared = Shared {
                    arranged: schema::ContactTable { in_contact, arrangements: all.arrangements },
                    draws: all.draws.unwrap_or(Draws::Shared),
                    bristle_damping: all.bristle_damping.unwrap_or(BristleDampingEntry::Constant),
                    is_lateral,
                    stiffness_factor,
                    load_exponent: load_exponent(&check, &tables, load_factor.is_some())?,
                    load_factor,
                    own_speed: speed.map(|speed| OwnSpeed { speed, factor: mean_speed }),
                    is_of_faces: true,
                };
                Some((patches, shared))
            }
        };
        terms.extend(holders);
        let contact = match contact {
            None => None,
            Some((of_contact, shared)) => {
                sides = Some(of_contact.sides);
                missing_rows.extend(of_contact.missing);
                terms.extend(of_contact.terms);
                channels = of_contact.channels;
                let friction =
                    friction.ok_or_else(|| check.value("friction", "missing", "a table, as there is a contact"))?;
                let given = (study.laws, speeds, friction);
                Some(patch_contact(&check, shared, of_contact.patches, given)?)
            }
        };
        formulas.all_used()?;
        let correlation = match &contact {
            None if correlation.is_some() => {
                return Err(check.value(
                    "correlation",
                    "given",
                    "cases with a contact: friction parameters are correlated",
                ));
            }
            None => None,
            Some(contact) => {
                let places = draw_places(&model, contact)?;
                let of = Correlated { parameters: friction_parameters(&contact.friction), contacts: &places };
                check.correlation(correlation, &of)?
            }
        };
        let constraints = constraint_sets(&model, constraints, &mut missing_rows)?;
        let system = SparseAffineSystem::new(terms, channels).map_err(check.sparse("terms"))?;
        for missing in missing_rows.iter().filter(|missing| missing.field.starts_with("contact.")) {
            check.note(missing.to_string());
        }
        header.notes = check.notes();
        Ok(Self {
            header,
            correlation,
            parameters,
            system,
            coefficients,
            contact,
            constraints,
            reduction: goal(&check, &reduction)?,
            names,
            missing_rows,
            sides,
            dofs: model.dofs,
            files,
            held,
            node_sets: model.sets,
            mesh: model.mesh,
        })
    }
}

/// What the patches of a case share, whatever its contact is between.
struct Shared {
    arranged: schema::ContactTable,
    draws: Draws,
    bristle_damping: BristleDampingEntry,
    is_lateral: bool,
    stiffness_factor: Option<Expression>,
    load_factor: Option<Expression>,
    load_exponent: f64,
    own_speed: Option<OwnSpeed>,
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
    if is_drawn && first != 0.0 && tables.iter().any(FacesTable::is_in_equilibrium) {
        let allowed = "contacts in equilibrium of a constant stiffness, or loads that are given: which points are open depends on it here";
        return Err(check.value(LOAD_FACTOR, "given", allowed));
    }
    Ok(first)
}

/// Whether friction acts across the sliding too. It depends on a speed; where nobody says which there is none, and a line that says so.
fn lateral(check: &Check<'_>, table: &str, given: Option<LateralEntry>, no_speed: bool) -> bool {
    if given.is_none() && no_speed {
        check.note(format!(
            "no [[speeds]], so no friction across the sliding: its damping is left out ({table}.lateral)"
        ));
        return false;
    }
    given != Some(LateralEntry::None)
}

/// The stiffness of the structure at the medians of the parameters, with holders and without contacts, and a multiple of its mass.
fn at_medians(
    check: &Check<'_>,
    terms: &[SparseTerm],
    coefficients: &[Expression],
    holders: Option<&SparseTerm>,
    medians: &[f64],
    of_mass: f64,
) -> Result<CscMatrix<f64>, CaseError> {
    let order = terms.first().map_or(0, |term| term.matrices.order());
    let mut sum = holders.map_or_else(|| CscMatrix::zeros(order, order), |term| term.matrices.k.clone());
    for (term, coefficient) in terms.iter().zip(coefficients) {
        let named = |source| CaseError::Expression {
            path: check.path.to_owned(),
            field: field("terms", &term.name, "coefficient"),
            source: Box::new(source),
        };
        let theta = coefficient.value(medians).map_err(named)?;
        sum = sum + &term.matrices.k * theta + &term.matrices.m * (theta * of_mass);
    }
    Ok(sum)
}

fn patch_contact(
    check: &Check<'_>,
    shared: Shared,
    patches: Vec<super::Patch>,
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
    Ok(PatchContact {
        panels: arrangements_by_number(check, &shared.arranged, patches.len())?,
        patches,
        friction: distributions(check, of_laws(check, &laws, friction)?)?,
        laws,
        speeds: if needs_ranges || !speeds.is_empty() { speed_ranges(check, speeds)? } else { Vec::new() },
        draws: shared.draws,
        bristle_damping: shared.bristle_damping.into(),
        is_lateral,
        stiffness_factor: shared.stiffness_factor,
        load_factor: shared.load_factor,
        load_exponent: shared.load_exponent,
        own_speed,
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

/// Where the contacts are that have a draw each: the middles of the patches on the pad, or one place for all.
fn draw_places(model: &Model<'_>, contact: &PatchContact) -> Result<Vec<[f64; 3]>, CaseError> {
    let middle = |patch: &Patch| {
        let nodes = patch.pairs.iter().map(|[pad, _]| model.position("contact.patches", *pad));
        let nodes = nodes.collect::<Result<Vec<_>, _>>()?;
        Ok(std::array::from_fn(|d| nodes.iter().map(|node| node[d]).sum::<f64>() / nodes.len() as f64))
    };
    match contact.draws {
        Draws::Shared => Ok(vec![[0.0; 3]]),
        Draws::Each => contact.patches.iter().map(middle).collect(),
    }
}

fn constraint_sets(
    model: &Model<'_>,
    given: Vec<ConstraintsTable>,
    missing: &mut Vec<MissingRows>,
) -> Result<Vec<FixedDofs>, CaseError> {
    let check = model.check;
    if given.is_empty() {
        return Ok(vec![FixedDofs { name: "none".into(), fixed: Vec::new() }]);
    }
    check.no_repeats("constraints.name", given.iter().map(|set| set.name.clone()))?;
    let mut set = |ConstraintsTable { name, fixed }: ConstraintsTable| {
        check.plain_name("constraints.name", &name)?;
        let field = field("constraints", &name, "fixed");
        let (fixed, held) = model.rows(&field, &fixed)?;
        missing.extend(held);
        match fixed.len() == model.dofs.len() {
            true => Err(check.value(&field, "all", "at most all degrees of freedom but one")),
            false => Ok(FixedDofs { name, fixed }),
        }
    };
    given.into_iter().map(&mut set).collect()
}

fn goal(check: &Check<'_>, table: &ReductionTable) -> Result<ReductionGoal, CaseError> {
    let ReductionTable { frequencies, growth, residual, training, full_checks } = *table;
    let is_range = |[from, to]: [f64; 2]| from.is_finite() && to.is_finite() && from < to;
    if !(is_range(frequencies) && frequencies[0] > 0.0) {
        let allowed = "[lowest, highest] in Hz, 0 < lowest < highest";
        return Err(check.value("reduction.frequencies", format!("{frequencies:?}"), allowed));
    }
    if !(is_range(growth) && growth[0] < 0.0 && growth[1] > 0.0) {
        let allowed = "[lowest, highest] in 1/s, lowest < 0 < highest";
        return Err(check.value("reduction.growth", format!("{growth:?}"), allowed));
    }
    if !(1e-12..=1e-3).contains(&residual) {
        return Err(check.value("reduction.residual", residual, "1e-12 to 1e-3"));
    }
    if !(1..=MOST_TRAINING).contains(&training) {
        return Err(check.value("reduction.training", training, &format!("1 to {MOST_TRAINING}")));
    }
    if full_checks > MOST_FULL_CHECKS {
        return Err(check.value("reduction.full_checks", full_checks, &format!("0 to {MOST_FULL_CHECKS}")));
    }
    Ok(ReductionGoal { frequencies, growth, residual, training, full_checks })
}
