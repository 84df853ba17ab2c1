//! Identity that tells a case from another: its parts written out field by field, with matrices in other files as they were read.

use std::sync::Arc;

use friction::BristleDamping;
use nalgebra_sparse::CscMatrix;
use osc_model::{
    ContactArrangement, Dof, Lateral, LatticeBody, LatticeParameters, Lean, PlateParameters, Preload, Sign,
};
use sparse::{SparseSecondOrder, SparseTerm};
use study::identity::{Identity, Written};
use study::identity::{channel, naming};

use super::choices::Law;
use super::finite_elements::{OwnSpeed, Patch, PatchContact, ReductionGoal, Spread, SpreadParameters};
use super::matrices::{BodyDofs, GainExpressions, LagExpressions};
use super::relaxing::Branch;
use super::types::{ConstraintSet, LatticeReadings};
use super::{
    Correlation, Draws, Expression, FiniteElementCase, FixedDofs, FrictionDistributions, LatticeCase, MatricesCase,
    Parameter, SpeedRange, TableFunction,
};

impl LatticeCase {
    /// Identifies the case: its name, and a digest of each part that results depend on. Seed, number of samples, threshold and names of
    /// modes belong to a study.
    pub fn identity(&self) -> String {
        let Self { header, laws, lattice, readings, panels, constraints, speeds, friction, correlation, .. } = self;
        Identity::named(&header.name)
            .part("laws", |to| to.list(laws, |to, law| to.text(law.name())))
            .part("lattice", |to| of_lattice(to, lattice))
            .part("readings", |to| of_readings(to, readings))
            .part("arrangements", |to| to.list(panels, panel))
            .part("constraints", |to| {
                to.list(constraints, |to, ConstraintSet { name, fixed }| {
                    to.text(name);
                    to.list(fixed, lattice_dof);
                });
            })
            .part("speeds", |to| to.list(speeds, speed))
            .part("friction", |to| of_friction(to, friction))
            .part("correlation", |to| to.option(correlation.as_ref(), of_correlation))
            .into_line()
    }
}

impl MatricesCase {
    /// Identifies the case: its name, and a digest of each part that results depend on, matrices in other files among them. Seed, number
    /// of samples and threshold are those of a study.
    pub fn identity(&self) -> String {
        let Self {
            header,
            parameters,
            tables,
            correlation,
            dofs,
            system,
            coefficients,
            gains,
            branches,
            bodies,
            constraints,
            ..
        } = self;
        with_tables(Identity::named(&header.name), tables)
            .part("parameters", |to| to.list(parameters, parameter))
            .part("dofs", |to| to.list(dofs, |to, dof| to.text(dof)))
            .part("terms", |to| {
                to.list(system.terms(), |to, term| {
                    to.text(&term.name);
                    to.text(&term.family);
                    let matrices = term.matrices();
                    for matrix in [&matrices.m, &matrices.c, &matrices.k] {
                        to.count(matrix.nrows());
                        to.list(matrix.as_slice(), |to, &entry| to.number(entry));
                    }
                });
                to.list(coefficients, expression);
                // Only where there are any, so that other studies stay as they were.
                branches.iter().for_each(|branch| of_branch(to, branch));
            })
            .part("contacts", |to| {
                to.list(system.channels(), channel);
                to.list(gains, gain);
            })
            .part("bodies", |to| {
                to.list(bodies, |to, BodyDofs { name, dofs }| {
                    to.text(name);
                    to.list(dofs, |to, &dof| to.count(dof));
                });
            })
            .part("constraints", |to| to.list(constraints, fixed_dofs))
            .part("correlation", |to| to.option(correlation.as_ref(), of_correlation))
            .into_line()
    }
}

impl FiniteElementCase {
    /// Identifies the case: its name, and a digest of each part that results depend on, matrices in other files among them. Seed, number
    /// of samples and threshold are those of a study.
    pub fn identity(&self) -> String {
        let Self {
            header,
            parameters,
            tables,
            dofs,
            system,
            coefficients,
            branches,
            contact,
            correlation,
            constraints,
            reduction,
            ..
        } = self;
        with_tables(Identity::named(&header.name), tables)
            .part("parameters", |to| to.list(parameters, parameter))
            .part("dofs", |to| {
                to.list(dofs, |to, dof| {
                    to.text(&dof.node.to_string());
                    to.count(dof.direction as usize);
                });
            })
            .part("terms", |to| {
                to.list(system.terms(), of_term);
                to.list(coefficients, expression);
                branches.iter().for_each(|branch| of_branch(to, branch));
            })
            .part("contact", |to| {
                to.list(system.channels(), channel);
                to.option(contact.as_ref(), of_contact);
            })
            .part("constraints", |to| to.list(constraints, fixed_dofs))
            .part("reduction", |to| of_reduction(to, reduction))
            .part("correlation", |to| to.option(correlation.as_ref(), of_correlation))
            .into_line()
    }

    /// Identifies what a reduced brake is made of: the case, as [`FiniteElementCase::identity`] does, with what else its bases and their checks
    /// depend on. Number of samples, half width, what was measured, units and the text of the file change none of it.
    pub fn prepared_identity(&self) -> String {
        let Self { header, contact, .. } = self;
        Identity::read(&header.name, &self.identity())
            .part("equilibrium", |to| {
                let balance = contact.as_ref().and_then(|contact| contact.balance.as_deref());
                to.option(balance, |to, balance| balance.identify(to));
            })
            .given("growth_above", header.threshold.growth_above())
            .given("damping_ratio_below", header.threshold.damping_ratio_below())
            .given("seed", header.seed)
            .into_line()
    }

    /// Identifies the brake of the case whichever of its scenes are chosen, and whatever is drawn of it.
    pub fn brake_identity(&self) -> String {
        let Self { header, parameters, tables, system, coefficients, branches, contact, reduction, .. } = self;
        with_tables(Identity::named(&header.name), tables)
            .part("parameters", |to| to.list(parameters, parameter))
            .part("terms", |to| {
                to.list(system.terms(), of_term);
                to.list(coefficients, expression);
                branches.iter().for_each(|branch| of_branch(to, branch));
            })
            .part("contact", |to| {
                to.list(system.channels(), channel);
                to.option(contact.as_ref(), |to, contact| {
                    of_friction(to, &contact.friction);
                    of_spread(to, &contact.spread);
                });
            })
            .part("reduction", |to| of_reduction(to, reduction))
            .into_line()
    }
}

/// The identity with the points of tables, where there are some, so that other studies stay as they were.
fn with_tables(identity: Identity, tables: &[Arc<TableFunction>]) -> Identity {
    if tables.is_empty() {
        return identity;
    }
    identity.part("tables", |to| {
        to.list(tables, |to, table| {
            to.text(table.name());
            to.list(table.points(), |to, point| point.into_iter().for_each(|number| to.number(number)));
        });
    })
}

fn of_lattice(to: &mut Written, lattice: &LatticeParameters) {
    let LatticeParameters {
        grid,
        x_stiffness,
        y_stiffness,
        x_damping,
        y_damping,
        z_damping,
        inclined_stiffness,
        theta,
        phi,
        lean,
        contact_stiffness,
        oscillator_mass,
        plate: PlateParameters { mass, stiffness, damping },
    } = lattice;
    to.count(grid.rows());
    to.count(grid.columns());
    for list in [
        x_stiffness,
        y_stiffness,
        x_damping,
        y_damping,
        z_damping,
        inclined_stiffness,
        contact_stiffness,
        oscillator_mass,
    ] {
        numbers(to, list);
    }
    to.number(*theta);
    to.number(*phi);
    to.count(match lean {
        Lean::Against => 0,
        Lean::Along => 1,
    });
    to.number(*mass);
    numbers(to, stiffness);
    numbers(to, damping);
}

fn numbers(to: &mut Written, list: &[f64]) {
    to.list(list, |to, &number| to.number(number));
}

fn of_readings(to: &mut Written, readings: &LatticeReadings) {
    let &LatticeReadings { lateral, draws, labels, identity, preload, bristle_damping } = readings;
    naming(to, labels, identity);
    match lateral {
        Lateral::None => to.count(0),
        Lateral::Coupled { sign: Sign::Plus } => to.count(1),
        Lateral::Coupled { sign: Sign::Minus } => to.count(2),
        Lateral::Vector => to.count(3),
    }
    of_draws(to, draws);
    let (kind, force) = match preload {
        Preload::PerContact(force) => (0, force),
        Preload::Clamp(force) => (1, force),
        Preload::Equilibrium(force) => (2, force),
    };
    to.count(kind);
    to.number(force);
    to.option(bristle_damping, of_bristle_damping);
}

fn of_draws(to: &mut Written, draws: Draws) {
    to.count(match draws {
        Draws::Shared => 0,
        Draws::Each => 1,
    });
}

fn of_bristle_damping(to: &mut Written, damping: BristleDamping) {
    to.count(match damping {
        BristleDamping::Constant => 0,
        BristleDamping::Decaying => 1,
    });
}

fn panel(to: &mut Written, (in_contact, arrangements): &(usize, Vec<ContactArrangement>)) {
    to.count(*in_contact);
    to.list(arrangements, |to, arrangement| {
        to.count(arrangement.oscillators());
        to.list(arrangement.in_contact(), |to, &contact| to.count(contact));
    });
}

fn lattice_dof(to: &mut Written, dof: &Dof) {
    to.text(&dof.axis.to_string());
    match dof.body {
        LatticeBody::Oscillator(oscillator) => to.option(Some(oscillator), Written::count),
        LatticeBody::Plate => to.option(None, Written::count),
    }
}

fn speed(to: &mut Written, SpeedRange { name, from, to: highest }: &SpeedRange) {
    to.text(name);
    to.number(*from);
    to.number(*highest);
}

fn of_friction(to: &mut Written, friction: &FrictionDistributions) {
    let FrictionDistributions { mu, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2 } = friction;
    [mu, mu_s, mu_k, alpha, v_s, sigma0, sigma1, sigma2].into_iter().for_each(|each| to.distribution(each));
}

fn of_correlation(to: &mut Written, correlation: &Correlation) {
    to.list(correlation.named(), |to, &place| to.count(place));
    to.list(correlation.factor(), |to, row| numbers(to, row));
}

fn parameter(to: &mut Written, Parameter { name, unit: _, distribution: drawn }: &Parameter) {
    to.text(name);
    to.distribution(drawn);
}

/// Identity of an expression: its text, with names of parameters that stand in the list of parameters.
fn expression(to: &mut Written, expression: &Expression) {
    to.text(expression.text());
}

/// Gain of a channel. Load, speed and spring of the contact are no part of it: no eigenvalue depends on them, and a motion names its own.
fn gain(to: &mut Written, GainExpressions { mu, slope, lag, .. }: &GainExpressions) {
    expression(to, mu);
    expression(to, slope);
    to.option(lag.as_ref(), |to, LagExpressions { decay, drive, force }| {
        [decay, drive, force].into_iter().for_each(|each| expression(to, each));
    });
}

fn fixed_dofs(to: &mut Written, FixedDofs { name, fixed, dashpots }: &FixedDofs) {
    to.text(name);
    to.list(fixed, |to, &dof| to.count(dof));
    // Only where there are any, as branches.
    dashpots.iter().flatten().for_each(|dashpot| to.list(dashpot.as_slice(), |to, &entry| to.number(entry)));
}

fn of_term(to: &mut Written, SparseTerm { name, family, matrices, loss }: &SparseTerm) {
    to.text(name);
    to.text(family);
    let SparseSecondOrder { m, c, k, h: _, states: _ } = matrices;
    [m, c, k].into_iter().for_each(|matrix| sparse_matrix(to, matrix));
    // Most terms have none, and their identity is as before there was any.
    if *loss > 0.0 {
        to.text("loss factor");
        to.number(*loss);
    }
}

fn sparse_matrix(to: &mut Written, matrix: &CscMatrix<f64>) {
    to.count(matrix.nrows());
    to.list(matrix.col_offsets(), |to, &offset| to.count(offset));
    to.list(matrix.row_indices(), |to, &row| to.count(row));
    numbers(to, matrix.values());
}

fn of_branch(to: &mut Written, Branch { term, ratio, rate, .. }: &Branch) {
    to.count(*term);
    expression(to, ratio);
    expression(to, rate);
}

fn of_contact(to: &mut Written, contact: &PatchContact) {
    let PatchContact {
        patches,
        panels,
        laws,
        friction,
        speeds,
        draws,
        bristle_damping,
        is_lateral,
        stiffness_factor,
        friction_factor,
        own_friction_factors,
        spread,
        has_spring_channels: _,
        load_factor,
        load_exponent,
        has_power_law: _,
        own_speed,
        balance,
        is_of_faces: _,
    } = contact;
    to.list(
        patches,
        |to,
         Patch {
             name,
             pairs,
             speeds,
             channels,
             load,
             shares,
             springs: _,
             points: _,
             places: _,
             areas: _,
             contact: _,
         }| {
            to.text(name);
            to.list(pairs, |to, pair| pair.iter().for_each(|node| to.text(&node.to_string())));
            numbers(to, speeds);
            to.count(channels.start);
            to.count(channels.end);
            to.number(*load);
            // What older versions did not know is written where there is some, so that their folders stay those of their cases.
            if shares.iter().any(|share| *share != 1.0) {
                numbers(to, shares);
            }
        },
    );
    to.count(usize::from(*is_lateral));
    to.list(panels, panel);
    to.list(laws, |to, law| to.text(law.name()));
    if contact.naming_law() != Law::AmontonsCoulomb {
        to.text("named by the first law");
    }
    of_friction(to, friction);
    to.list(speeds, speed);
    of_draws(to, *draws);
    to.option(*bristle_damping, of_bristle_damping);
    to.option(stiffness_factor.as_ref(), expression);
    if let Some(balance) = balance {
        to.list(balance.loads().as_slice(), |to, load| to.number(*load));
        to.list(&balance.factors().collect::<Vec<_>>(), |to, (field, factor)| {
            to.text(field);
            expression(to, factor);
        });
    }
    if friction_factor.is_some() {
        to.text("friction factor");
        to.option(friction_factor.as_ref(), expression);
    }
    for (number, (_, factor)) in
        own_friction_factors.iter().enumerate().filter_map(|(at, own)| Some((at, own.as_ref()?)))
    {
        to.text("friction factor of a contact");
        to.count(number);
        expression(to, factor);
    }
    of_spread(to, spread);
    if load_factor.is_some() || own_speed.is_some() {
        to.option(load_factor.as_ref(), expression);
        to.number(*load_exponent);
        to.option(own_speed.as_ref(), |to, OwnSpeed { speed, factor }| {
            expression(to, speed);
            to.number(*factor);
        });
    }
}

/// Identity of parameters that have a value for each patch or pair, where there are some.
fn of_spread(to: &mut Written, spread: &SpreadParameters) {
    for local in spread.all() {
        to.text(&local.name);
        to.distribution(&local.distribution);
        match &local.spread {
            Spread::Patches { first } => to.count(*first),
            Spread::Field { of_patches, identity } => {
                to.text(identity);
                to.list(of_patches, |to, field| {
                    to.count(field.coefficients.start);
                    to.count(field.coefficients.end);
                    numbers(to, field.shapes.as_slice());
                });
            }
        }
    }
}

fn of_reduction(to: &mut Written, reduction: &ReductionGoal) {
    let ReductionGoal { frequencies, growth, residual, training, full_checks, full_verdicts } = reduction;
    numbers(to, frequencies);
    numbers(to, growth);
    to.number(*residual);
    to.count(*training);
    // As counted in results: the checks of a folder are those of its samples.
    to.text(&full_checks.to_string());
    to.count(*full_verdicts);
}
