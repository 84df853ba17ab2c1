//! From the fields of a case file with a finite element brake to a checked case.

use std::path::Path;

use formats::{Limits, read_deck};
use sparse::SparseAffineSystem;

use super::contacts::{GivenContacts, read_contact};
use super::faces::Solids;
use super::missing::MissingRows;
use super::names_on_mesh::NamesOnMesh;
use super::nodes::Model;
use super::schema::{ConstraintsTable, FiniteElementsFile, ReductionTable};
use super::spread::SpreadOver;
use super::structure::Structure;
use super::surface_schema::RotationTable;
use super::terms::{Terms, holders_term, read_terms, terms_with_coefficients};
use super::turning::{Spring, rotation_terms, spring};
use super::units::{mean_density, possible_density};
use super::{FiniteElementCase, Patch, PatchContact, ReductionGoal, SpreadParameters};
use crate::check::{Check, field, syntax};
use crate::correlation::Correlated;
use crate::draft::waiting;
use crate::expression::formulas::Formulas;
use crate::feeding::note_feeding;
use crate::lattice::friction_parameters;
use crate::parameter::{Parameter, parameter};
use crate::relaxing::{Relaxing, gains_of};
use crate::{CaseError, Draws, FixedDofs};

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
        let mut check = Check::new(path);
        let FiniteElementsFile {
            study,
            brake,
            units,
            parameters,
            tables,
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
            measured,
            correlation,
        } = file;
        check.units = super::units::units(&check, units.as_ref())?;
        let check = check;
        let reduction = goal(&check, &reduction)?;
        let mut header = check.header(text, (study.name, study.samples, study.seed), accuracy, squeal, measured)?;
        let (mut own, mut spread) = (Vec::new(), Vec::new());
        for (name, mut given) in parameters {
            let over = given.over.take();
            let parameter = parameter(&check, name, given)?;
            match over {
                None => own.push(parameter),
                Some(over) => spread.push(SpreadOver::new(&check, parameter, over)?),
            }
        }
        let mut parameters = own;
        let deck = brake.mesh.map(|file| {
            let path = path.parent().unwrap_or(Path::new("")).join(&file);
            read_deck(&path, &Limits::default()).map_err(|source| check.matrix("brake.mesh", &file, source))
        });
        let deck = deck.transpose()?;
        let Terms { read, dofs, files, held } = read_terms(&check, terms)?;
        let model = Model::new(&check, deck, dofs);
        let local = spread.iter().map(|local| &local.parameter.name);
        let tables = check.tables(tables, parameters.iter().map(|own| &own.name).chain(local.clone()))?;
        let mut formulas = Formulas::new(&check, &parameters, &tables).with_local(local);
        let (terms, coefficients) =
            terms_with_coefficients(&check, &mut formulas, read, model.dofs.len(), reduction.frequencies)?;
        let all_parameters: Vec<&Parameter> =
            parameters.iter().chain(spread.iter().map(|local| &local.parameter)).collect();
        let lossy = terms.iter().zip(&coefficients).filter(|(term, _)| term.loss > 0.0);
        note_feeding(&check, &all_parameters, lossy.map(|(term, coefficient)| (term.name.as_str(), coefficient)));
        let names = NamesOnMesh::new(&model)?;
        let mut missing_rows = Vec::new();
        let holders = holders_term(&model, &holders, &mut missing_rows)?;
        let medians = parameters.iter().chain(spread.iter().map(|local| &local.parameter));
        let medians = medians.map(|parameter| parameter.distribution.median()).collect();
        let mut structure = Structure { check: &check, terms, coefficients, holders, medians };
        check.names("springs.name", springs.iter().map(|table| &table.name))?;
        let mut relaxing = Relaxing::default();
        for table in springs {
            let Spring { term, coefficient, directions } = spring(&model, &mut formulas, &table, &mut missing_rows)?;
            if !table.viscoelastic.is_empty() {
                let key = field("springs", &table.name, "viscoelastic");
                if directions.is_empty() {
                    return Err(check.value(&key, "given without a stiffness", "springs with a stiffness > 0"));
                }
                // What is told of a term is told of its branches too, by its name.
                if structure.terms.iter().any(|other| other.name == table.name) {
                    let allowed = "names that no term has, of springs that are viscoelastic";
                    return Err(check.value("springs.name", format!("{:?}", table.name), allowed));
                }
                let of = (structure.terms.len(), term.name.as_str(), term.family.as_str());
                relaxing.add(&mut formulas, &key, of, &directions, table.viscoelastic)?;
            }
            structure.add((term, coefficient));
        }
        let Relaxing { branches, channels: relaxing } = relaxing;
        if !branches.is_empty() {
            // A branch without a value at the medians is an error of the case, found before a study starts.
            gains_of(check.path, &branches, &structure.medians, &structure.coefficients_at_medians()?)?;
        }
        if units.is_some() {
            mean_density(&model, &structure, check.units)?;
            for RotationTable { name, density, .. } in &rotation {
                possible_density(&check, check.units, &field("rotation", name, "density"), "", *density)?;
            }
        }
        check.names("rotation.name", rotation.iter().map(|table| &table.name))?;
        if !rotation.is_empty() {
            let (solids, held) = (Solids::new(&model, "rotation")?, structure.at_medians(SOFT)?);
            for table in &rotation {
                let [gyroscopic, centrifugal] = rotation_terms(&solids, &mut formulas, table, &held)?;
                structure.add(gyroscopic);
                structure.add(centrifugal);
            }
        }
        let given = GivenContacts { contact, all: all_contacts, forces, laws: study.laws, speeds, friction };
        let (mut contact, of_contact) = read_contact(&model, &mut formulas, &structure, given)?.unzip();
        formulas.all_used()?;
        if let Some(contact) = &mut contact {
            contact.spread = SpreadParameters::new(&check, spread, &contact.patches, &mut parameters)?;
        }
        let Structure { mut terms, coefficients, holders, .. } = structure;
        terms.extend(holders);
        let (mut channels, mut sides) = (Vec::new(), None);
        if let Some(of_contact) = of_contact {
            sides = Some(of_contact.sides);
            missing_rows.extend(of_contact.missing);
            terms.extend(of_contact.terms);
            channels = of_contact.channels;
        }
        channels.extend(relaxing);
        let places = contact.as_ref().map(|contact| draw_places(&model, contact)).transpose()?;
        let of = Correlated {
            friction: contact.as_ref().map_or_else(Vec::new, |contact| friction_parameters(&contact.friction)),
            contacts: places.as_deref().unwrap_or(&[[0.0; 3]]),
            has_numbers: contact.as_ref().is_some_and(|contact| contact.draws == Draws::Each),
            others: parameters.iter().map(|own| (own.name.as_str(), &own.distribution)).collect(),
        };
        let correlation = check.correlation(correlation, &of)?;
        let constraints = constraint_sets(&model, constraints, &mut missing_rows)?;
        let system = SparseAffineSystem::new(terms, channels).map_err(check.sparse("terms"))?;
        for missing in missing_rows.iter().filter(|missing| missing.field.starts_with("contact.")) {
            check.note(missing.to_string());
        }
        if contact.is_none() {
            let waits = match waiting(&header.text) {
                0 => String::new(),
                lines => format!("; lines that wait for a number in place of ?: {lines}"),
            };
            check.note(format!(
                "no [[contact]] is given, and so no friction: nothing can squeal but by what the matrices have in them{waits}"
            ));
        }
        header.notes = check.notes();
        Ok(Self {
            header,
            correlation,
            parameters,
            tables,
            system,
            coefficients,
            branches,
            contact,
            constraints,
            reduction,
            names,
            missing_rows,
            sides,
            dofs: model.dofs,
            files,
            held,
            held_in_mesh: model.held,
            node_sets: model.sets,
            mesh: model.mesh,
        })
    }
}

/// Places of the contacts that have a draw each: the middles of the patches on the pad, or one place for all.
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
        return Ok(vec![FixedDofs { name: "none".into(), fixed: Vec::new(), dashpots: Vec::new() }]);
    }
    check.no_repeats("constraints.name", given.iter().map(|set| set.name.clone()))?;
    let mut set = |ConstraintsTable { name, fixed }: ConstraintsTable| {
        check.plain_name("constraints.name", &name)?;
        let field = field("constraints", &name, "fixed");
        let (fixed, held) = model.rows(&field, &fixed)?;
        missing.extend(held);
        match fixed.len() == model.dofs.len() {
            true => Err(check.value(&field, "all", "at most all degrees of freedom but one")),
            false => Ok(FixedDofs { name, fixed, dashpots: Vec::new() }),
        }
    };
    given.into_iter().map(&mut set).collect()
}

fn goal(check: &Check<'_>, table: &ReductionTable) -> Result<ReductionGoal, CaseError> {
    let ReductionTable { frequencies, growth, residual, training, full_checks, full_verdicts } = *table;
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
    Ok(ReductionGoal { frequencies, growth, residual, training, full_checks, full_verdicts })
}
