//! The contacts between faces of a case: patches of their points, with springs and friction.

use std::collections::BTreeSet;

use contact::{ContactError, Row};
use linsys::Channel;
use nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{SparseSecondOrder, SparseTerm};

use super::balance::ContactBalance;
use super::contact::Patches;
use super::entries::SlidingEntry;
use super::faces::Solids;
use super::side::Side;
use super::surface_contact::SurfaceContact;
use super::surface_loads::{Balanced, given_forces};
use super::surface_schema::FacesTable;
use super::{PairPlace, Patch};
use crate::CaseError;
use crate::check::field;

/// Contacts between faces, all of a case.
pub(super) struct Surfaces {
    pub patches: Patches,
    /// The mean of the speeds of all points by their areas, at 1 rad/s, or 1 of a direction.
    pub mean_speed: f64,
    /// Equilibrium from which the loads follow; `None` where they are given.
    pub balance: Option<ContactBalance>,
}

impl Surfaces {
    /// The patches of all contacts, with the forces that are given or in equilibrium, which `balanced` finds. At the medians given forces have this factor of the
    /// `load`.
    pub fn new(
        solids: &Solids<'_>,
        (tables, load): (&[FacesTable], f64),
        [is_lateral, has_springs]: [bool; 2],
        balanced: &dyn Fn(&[SurfaceContact<'_>]) -> Result<Balanced, CaseError>,
    ) -> Result<Self, CaseError> {
        let check = solids.model.check;
        check.names("contact.name", tables.iter().map(|table| &table.name))?;
        let contacts =
            tables.iter().map(|table| SurfaceContact::new(solids, table)).collect::<Result<Vec<_>, CaseError>>()?;
        if contacts.is_empty() {
            return Err(check.value("contact", "[]", "one table or more"));
        }
        for (at, contact) in contacts.iter().enumerate() {
            refuse_again(solids, contact, &contacts[..at])?;
        }
        let count = tables.iter().filter(|table| table.is_in_equilibrium()).count();
        if count != 0 && count != contacts.len() {
            return Err(check.value("contact.load", "\"equilibrium\" in some", "\"equilibrium\" in all or in none"));
        }
        let (forces, balance): (Vec<Vec<f64>>, _) = match count {
            0 => (contacts.iter().map(|contact| given_forces(solids, contact)).collect::<Result<_, _>>()?, None),
            _ => {
                let Balanced { forces, note, balance } = balanced(&contacts)?;
                check.note(note);
                (forces, Some(balance))
            }
        };
        let mean_speed = mean_speed(&contacts);
        let count = |faces: &dyn Fn(&SurfaceContact<'_>) -> usize| Side::Faces(contacts.iter().map(faces).sum());
        let sides = [count(&|contact| contact.slave.len()), count(&|contact| contact.master.len())];
        let missing = contacts.iter().map(|contact| contact.missing(solids)).collect::<Result<Vec<_>, _>>()?.concat();
        let mut out = Patches { patches: Vec::new(), terms: Vec::new(), channels: Vec::new(), sides, missing };
        let mut first = 0;
        for (number, (contact, forces)) in contacts.iter().zip(&forces).enumerate() {
            let (names, of) = contact.patches(solids)?;
            let of_contact = check.contact::<ContactError>(&contact.field());
            let stiffness = contact.interface.tangents(&contact.law, forces).map_err(&of_contact)?;
            report_gaps(solids, contact);
            report_pressure(solids, contact, forces.iter().sum::<f64>() * if balance.is_some() { 1.0 } else { load });
            for (at, name) in names.iter().enumerate() {
                let mut own: Vec<usize> = (0..of.len()).filter(|&point| of[point] == at).collect();
                let is_pressed = own.iter().any(|&point| forces[point] > 0.0);
                let patches = field("contact", &contact.table.name, "patches");
                match (is_pressed, &balance) {
                    (false, None) => {
                        let found = format!("{name:?}, of whose points none is closed");
                        return Err(check.value(&patches, found, "patches that are pressed on"));
                    }
                    // Another arrangement, or another draw, may hold it down.
                    (false, Some(_)) => {
                        check.note(format!(
                            "{patches} {name:?}: none of its points is closed at the medians with all patches"
                        ));
                    }
                    (true, None) => own.retain(|&point| forces[point] > 0.0),
                    (true, Some(_)) => {}
                }
                let balance = balance.as_ref().map(|balance| (balance, first));
                let made = Made {
                    solids,
                    contact,
                    number,
                    forces,
                    stiffness: &stiffness,
                    is_lateral,
                    has_springs,
                    mean_speed,
                    balance,
                };
                made.patch(name, &own, &mut out)?;
            }
            first += of.len();
        }
        check.names("contact.patches", out.patches.iter().map(|patch| &patch.name))?;
        Ok(Self { patches: out, mean_speed, balance })
    }
}

/// Refuses a contact of faces that another one has too: stiffness, load and friction would count twice.
fn refuse_again(
    solids: &Solids<'_>,
    contact: &SurfaceContact<'_>,
    others: &[SurfaceContact<'_>],
) -> Result<(), CaseError> {
    let faces =
        |of: &SurfaceContact<'_>| of.interface.points().iter().map(|point| point.slave_face).collect::<BTreeSet<_>>();
    let own = faces(contact);
    for other in others {
        let Some(id) = faces(other).intersection(&own).next().copied() else { continue };
        let check = solids.model.check;
        let key = field("contact", &contact.table.name, "slave");
        let element = solids.mesh.element(id.element).map_err(check.contact(&key))?.label;
        let found = format!("a face of the contact {:?} too, S{} of element {element}", other.table.name, id.number);
        return Err(check.value(&key, found, "faces that are the slave of one contact"));
    }
    Ok(())
}

/// The mean speed of points about axes by their areas; 1 where all slide along directions.
fn mean_speed(contacts: &[SurfaceContact<'_>]) -> f64 {
    let turning = contacts.iter().filter(|contact| matches!(contact.table.sliding, SlidingEntry::About(_)));
    let points: Vec<_> = turning.flat_map(|contact| contact.interface.points()).collect();
    let area: f64 = points.iter().map(|point| point.area).sum();
    let sum: f64 = points.iter().map(|point| point.area * point.speed).sum();
    if area > 0.0 { sum / area } else { 1.0 }
}

/// Says where the meshes of a contact are farthest apart and overlap most, where that is more than rounding.
fn report_gaps(solids: &Solids<'_>, contact: &SurfaceContact<'_>) {
    /// Largest gap of which nothing is said, as a fraction of the reach; chosen.
    const SMALL: f64 = 1e-6;
    let points = contact.interface.points();
    let largest = points.iter().max_by(|a, b| a.gap.abs().total_cmp(&b.gap.abs()));
    if let Some(point) = largest.filter(|point| point.gap.abs() > SMALL * contact.table.reach) {
        let what = if point.gap > 0.0 { "are apart" } else { "overlap" };
        let node = solids.mesh.labels()[point.node()];
        let size = point.gap.abs();
        let text = format!("{}: the faces {what} by up to {size:.3e}, at node {node}; as if they met", contact.field());
        solids.model.check.note(text);
    }
}

/// Asks for the units of a load whose mean pressure no brake has.
fn report_pressure(solids: &Solids<'_>, contact: &SurfaceContact<'_>, force: f64) {
    /// Plausible mean pressures, Pa; chosen: pads are pressed on with 0.1 to 10 MPa, and a load in kN in the place of N is a thousandth of that.
    const PLAUSIBLE: [f64; 2] = [1e4, 1e8];
    let units = solids.model.check.units;
    let pressure = force / contact.interface.area();
    let in_pascal = pressure / units.length().powi(2);
    if force > 0.0 && !(PLAUSIBLE[0]..=PLAUSIBLE[1]).contains(&in_pascal) {
        let unit = units.of("Pa");
        let text = format!("{}: its mean pressure is {pressure:.1e} {unit}; is the load in N?", contact.field());
        solids.model.check.note(text);
    }
}

/// Parts of which the patches of a contact are made.
struct Made<'a> {
    solids: &'a Solids<'a>,
    contact: &'a SurfaceContact<'a>,
    /// The number of the contact, from 0.
    number: usize,
    forces: &'a [f64],
    stiffness: &'a [f64],
    is_lateral: bool,
    /// True if the springs of the points differ by parameters.
    has_springs: bool,
    mean_speed: f64,
    /// The equilibrium, and the number of the contact's first point in it.
    balance: Option<(&'a ContactBalance, usize)>,
}

impl Made<'_> {
    /// Adds a patch of these points: its springs as a term, friction in each of them along the sliding and then across it, and in equilibrium what
    /// opening and closing adds to each spring, or else what parameters of each point add to it, where some do. In equilibrium the term has the springs that
    /// are closed at the medians.
    fn patch(&self, name: &str, own: &[usize], out: &mut Patches) -> Result<(), CaseError> {
        let Self { solids, contact, number, forces, stiffness, is_lateral, has_springs, mean_speed, balance } = self;
        let (mesh, rows) = (&solids.mesh, &solids.rows);
        let first = out.channels.len();
        let mut k = CooMatrix::new(rows.order(), rows.order());
        let (mut along, mut across, mut opening) = (Vec::new(), Vec::new(), Vec::new());
        let (mut pairs, mut speeds, mut points, mut places) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut springs = Vec::new();
        for &at in own {
            let point = &contact.interface.points()[at];
            let gap: Row = point.gap_row(rows);
            // The spring at the medians, and the one that is read.
            let (closed, read) = balance.map_or((stiffness[at], stiffness[at]), |(balance, first)| {
                points.push(first + at);
                (balance.at_medians(first + at) * balance.springs[first + at], balance.springs[first + at])
            });
            for &(i, a) in &gap {
                gap.iter().for_each(|&(j, b)| k.push(i, j, closed * (a * b)));
            }
            springs.push(read);
            let reading: Row = gap.iter().map(|&(dof, value)| (dof, read * value)).collect();
            let named = format!("{}/{}", contact.table.name, contact.interface.name(mesh, at));
            if balance.is_some() || *has_springs {
                let what = if balance.is_some() { "opening" } else { "spring" };
                opening.push(Channel::new(format!("{named} {what}"), "contact", gap, reading.clone()));
            }
            along.push(Channel::new(&named, format!("friction {name}"), point.slip_row(rows), reading));
            if *is_lateral {
                let family = format!("lateral friction {name}");
                across.push(Channel::new(format!("{named} across"), family, point.across_row(rows), Vec::new()));
            }
            let of_master = point.master.iter().max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(node, _)| *node);
            pairs.push([point.node(), of_master].map(|node| mesh.labels()[node]));
            places.push(PairPlace {
                position: point.position.into(),
                normal: point.normal.into(),
                sliding: point.sliding.into(),
                gap: point.gap,
            });
            let turns = matches!(contact.table.sliding, SlidingEntry::About(_));
            speeds.push(if turns { point.speed / mean_speed } else { 1.0 });
        }
        let k = CscMatrix::from(&k);
        let zero = || CscMatrix::zeros(rows.order(), rows.order());
        let symmetric = (&k + k.transpose()) * 0.5;
        let matrices =
            SparseSecondOrder::new(zero(), zero(), symmetric).map_err(solids.model.check.sparse("contact"))?;
        out.terms.push(SparseTerm { name: name.into(), family: "contact".into(), matrices, loss: 0.0 });
        out.channels.extend(along);
        out.channels.extend(across);
        out.channels.extend(opening);
        let load = own.iter().map(|&at| forces[at]).sum::<f64>() / own.len() as f64;
        // One that the medians lift off has no load to share, and is in equilibrium: its forces are found anew wherever it holds down.
        let shares = own.iter().map(|&at| if load > 0.0 { forces[at] / load } else { 0.0 }).collect();
        let channels = first..out.channels.len();
        let areas = own.iter().map(|&at| contact.interface.points()[at].area).collect();
        let name = name.into();
        let contact = *number;
        out.patches.push(Patch {
            name,
            pairs,
            speeds,
            channels,
            springs,
            load,
            shares,
            points,
            places,
            areas,
            contact,
        });
        Ok(())
    }
}
