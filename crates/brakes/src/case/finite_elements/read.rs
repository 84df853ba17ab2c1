//! From the fields of a case file with a finite element brake to a checked case.

use std::path::Path;

use formats::{Limits, read_deck};
use montecarlo::Distribution;
use sparse::SparseAffineSystem;

use super::contact::Patches;
use super::missing::{MissingRows, NamesOnMesh};
use super::nodes::Model;
use super::schema::{ConstraintsTable, ContactTable, FiniteElementsFile, FrictionTable, LateralEntry, ReductionTable};
use super::terms::{Terms, holders_term, read_terms, terms_with_coefficients};
use super::{FiniteElementCase, Patch, PatchContact, ReductionGoal, STIFFNESS_FACTOR};
use crate::case::arrangements::arrangements_by_number;
use crate::case::check::{Check, field, syntax};
use crate::case::correlation::Correlated;
use crate::case::matrices::formulas::Formulas;
use crate::case::matrices::read::parameter;
use crate::case::validate::{distributions, friction_parameters, speed_ranges};
use crate::case::{CaseError, Draws, FixedDofs, FrictionDistributions, Law, schema};

/// Most samples that are solved with the whole brake too; chosen: hours.
const MOST_FULL_CHECKS: u64 = 10_000;
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
            mut contact,
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
        let (mut terms, coefficients) = terms_with_coefficients(&check, &mut formulas, parts, model.dofs.len())?;
        let factor = contact.as_mut().and_then(|table| table.stiffness_factor.take());
        let factor = factor.map(|factor| formulas.expression(STIFFNESS_FACTOR, Some(factor), 1.0)).transpose()?;
        formulas.all_used()?;
        let names = NamesOnMesh::new(&model)?;
        let (mut missing_rows, mut sides) = (Vec::new(), None);
        terms.extend(holders_term(&model, &holders, &mut missing_rows)?);
        let mut channels = Vec::new();
        let contact = match contact {
            None => {
                // A law that is named and used by nothing says nothing wrong; its parameters would be drawn for nothing.
                let unused = [("friction", friction.is_some()), ("speeds", !speeds.is_empty())];
                if let Some((field, _)) = unused.into_iter().find(|(_, is_given)| *is_given) {
                    return Err(check.value(
                        field,
                        "given",
                        "cases with a contact: nothing else has friction by a law",
                    ));
                }
                None
            }
            Some(mut table) => {
                if table.lateral.is_none() && speeds.is_empty() {
                    // Friction across the sliding depends on a speed, and nobody says which.
                    check.note(
                        "no [[speeds]], so no friction across the sliding: its damping is left out (contact.lateral)"
                            .into(),
                    );
                    table.lateral = Some(LateralEntry::None);
                }
                let of_contact = Patches::new(&model, &table)?;
                sides = Some(of_contact.sides);
                missing_rows.extend(of_contact.missing);
                terms.extend(of_contact.terms);
                channels = of_contact.channels;
                let friction =
                    friction.ok_or_else(|| check.value("friction", "missing", "a table, as there is a contact"))?;
                let given = (study.laws, speeds, friction);
                let contact = patch_contact(&check, table, of_contact.patches, given)?;
                Some(PatchContact { stiffness_factor: factor, ..contact })
            }
        };
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

fn patch_contact(
    check: &Check<'_>,
    table: ContactTable,
    patches: Vec<super::Patch>,
    (laws, speeds, friction): (Vec<Law>, Vec<schema::SpeedsTable>, FrictionTable),
) -> Result<PatchContact, CaseError> {
    if laws.is_empty() {
        return Err(check.value("study.laws", "[]", "one law or more"));
    }
    check.no_repeats("study.laws", laws.iter().map(ToString::to_string))?;
    let ContactTable { in_contact, arrangements, draws, bristle_damping, lateral, .. } = table;
    let is_lateral = lateral != Some(LateralEntry::None);
    let depends_on_speed = is_lateral || laws.iter().any(|&law| law != Law::AmontonsCoulomb);
    if is_lateral && speeds.is_empty() {
        let allowed = "a range of speed or more, on which friction across the sliding depends; or contact.lateral = \"none\" without it";
        return Err(check.value("speeds", "missing", allowed));
    }
    let of_patches = schema::ContactTable { in_contact, arrangements };
    Ok(PatchContact {
        panels: arrangements_by_number(check, &of_patches, patches.len())?,
        patches,
        friction: distributions(check, of_laws(check, &laws, friction)?)?,
        laws,
        speeds: if depends_on_speed || !speeds.is_empty() { speed_ranges(check, speeds)? } else { Vec::new() },
        draws,
        bristle_damping: bristle_damping.into(),
        is_lateral,
        stiffness_factor: None,
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
