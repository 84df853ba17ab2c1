//! A contact between faces that need not match: its points, and the patch of each.

use std::collections::BTreeSet;

use contact::{ContactError, Integration, Interface, OppositeFaces, Pairing, Sliding, Stiffness};
use elements::{Axis, FaceId};

use super::entries::{Nodes, SlidingEntry};
use super::faces::Solids;
use super::missing::MissingRows;
use super::surface_schema::{FacesTable, IntegrationEntry, StiffnessEntry};
use crate::CaseError;
use crate::check::field;

/// The directions x, y and z.
const TRANSLATIONS: [u32; 3] = [1, 2, 3];

/// Largest angle between the sliding and the face of which nothing is said, degrees; chosen: faces of coarse meshes are that much off.
const STEEP: f64 = 10.0;

/// A contact of the case with its points.
pub(super) struct SurfaceContact<'t> {
    pub table: &'t FacesTable,
    pub interface: Interface,
    pub law: Stiffness,
    pub slave: Vec<FaceId>,
    pub master: Vec<FaceId>,
}

impl<'t> SurfaceContact<'t> {
    /// Finds the points of a contact.
    pub fn new(solids: &Solids<'_>, table: &'t FacesTable) -> Result<Self, CaseError> {
        let check = solids.model.check;
        check.plain_name("contact.name", &table.name)?;
        let key = |key: &str| field("contact", &table.name, key);
        let sliding = match table.sliding {
            SlidingEntry::Direction(direction) => {
                let size = nalgebra::Vector3::from(direction).norm();
                if !(size.is_finite() && size > 0.0) {
                    let allowed = "a direction of three finite numbers, not all 0";
                    return Err(check.value(&key("sliding"), format!("{direction:?}"), allowed));
                }
                Sliding::Along(direction.map(|x| x / size))
            }
            SlidingEntry::About(about) => {
                let axis = Axis::new(about.axis, about.through);
                Sliding::About { axis: axis.map_err(check.contact(&key("sliding")))?, speed: 1.0 }
            }
        };
        let integration = match table.integration {
            IntegrationEntry::GaussPoints => Integration::GaussPoints,
            IntegrationEntry::Segments => Integration::Segments,
        };
        let law = match table.stiffness {
            StiffnessEntry::PerArea(table) => Stiffness::PerArea(table.per_area),
            StiffnessEntry::InAll(table) => Stiffness::InAll(table.in_all),
            StiffnessEntry::Power(table) => Stiffness::Power { c: table.c, m: table.m },
        };
        law.check().map_err(check.contact::<ContactError>(&key("stiffness")))?;
        let pairing = Pairing { integration, overhang: table.overhang, ..Pairing::new(sliding, table.reach) };
        let (mut slave, master) =
            (solids.faces(&key("slave"), &table.slave)?, solids.faces(&key("master"), &table.master)?);
        let of_contact = check.contact::<ContactError>(&format!("contact {:?}", table.name));
        // Area over the edge of the master.
        let mut hanging = 0.0;
        if solids.are_bodies(&table.slave) {
            let opposite = OppositeFaces::new(&solids.mesh, &slave, &master, &pairing).map_err(&of_contact)?;
            if !opposite.faces.is_empty() {
                (slave, hanging) = (opposite.faces, opposite.beyond);
            }
        }
        let interface = Interface::new(&solids.mesh, &slave, &master, &pairing).map_err(&of_contact)?;
        hanging += interface.overhang();
        if hanging > 0.0 {
            let share = hanging / (hanging + interface.area());
            check.note(format!(
                "contact {:?}: {:.1} % of the slave's area has no master opposite and carries nothing",
                table.name,
                100.0 * share
            ));
        }
        let steepest = interface.points().iter().map(|point| {
            let velocity = sliding.velocity(&point.position);
            (velocity.dot(&point.normal).abs() / velocity.norm()).min(1.0).asin().to_degrees()
        });
        let steepest = steepest.fold(0.0, f64::max);
        if steepest > STEEP {
            check.note(format!(
                "{}: the disc would move out of its face by up to {steepest:.0} degrees; what lies in the face is the sliding",
                key("sliding")
            ));
        }
        // Of a whole body the faces that are met.
        let master: BTreeSet<FaceId> = interface.points().iter().map(|point| point.master_face).collect();
        let master = master.into_iter().collect();
        Ok(Self { table, interface, law, slave, master })
    }

    /// The table as messages name it.
    pub fn field(&self) -> String {
        format!("contact {:?}", self.table.name)
    }

    /// Names of the patches, and the patch of each point by its index among them.
    pub fn patches(&self, solids: &Solids<'_>) -> Result<(Vec<String>, Vec<usize>), CaseError> {
        let (check, key) = (solids.model.check, field("contact", &self.table.name, "patches"));
        if self.table.patches.is_empty() {
            return Ok((vec![self.table.name.clone()], vec![0; self.interface.points().len()]));
        }
        let mut sets = Vec::new();
        for name in &self.table.patches {
            check.plain_name(&key, name)?;
            let faces = Nodes::One(name.clone());
            let nodes = match solids.model.set(name) {
                Some(nodes) => nodes.clone(),
                None => solids.nodes_of(&solids.faces(&key, &faces)?),
            };
            sets.push((name.clone(), nodes.iter().filter_map(|&node| solids.mesh.place(node)).collect()));
        }
        let of = self.interface.patches(&solids.mesh, &sets).map_err(check.contact::<ContactError>(&key))?;
        for (at, name) in self.table.patches.iter().enumerate() {
            if !of.contains(&at) {
                return Err(check.value(&key, format!("{name:?}"), "sets with points of the slave's faces"));
            }
        }
        Ok((self.table.patches.clone(), of))
    }

    /// Nodes of its faces that lack rows.
    pub fn missing(&self, solids: &Solids<'_>) -> Result<Vec<MissingRows>, CaseError> {
        let of = |(key, faces): (&str, &Vec<FaceId>)| {
            let key = format!("contact.{key} of {:?}", self.table.name);
            solids.model.missing_rows(&key, &solids.nodes_of(faces), &TRANSLATIONS).transpose()
        };
        [("slave", &self.slave), ("master", &self.master)].into_iter().filter_map(of).collect()
    }
}
