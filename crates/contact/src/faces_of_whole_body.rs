//! Faces of a body that look at the other side of a contact.

use std::collections::{BTreeMap, BTreeSet};

use elements::{Face, FaceId, Mesh};
use nalgebra::Vector3;

use crate::pairing::Search;
use crate::sliding::faces;
use crate::{ContactError, Pairing, Side};

/// Least cosine of the angle between the normals of two neighbours of which one goes on where the other ends; chosen: 5 degrees.
const FLAT: f64 = 0.9962;
/// Least cosine of the angle between the normals of a face that goes on and the first of its neighbours, one after another, that looks at the other side; chosen: 20
/// degrees, so that what bends away is another face of the body.
const BENT: f64 = 0.94;

/// Faces of a body that look at the other side.
#[derive(Debug, Clone, PartialEq)]
pub struct OppositeFaces {
    /// The faces.
    pub faces: Vec<FaceId>,
    /// Area of faces that go on where these end, flat with them, and look at nothing: what of a pad hangs over the edge of a disc by whole faces.
    pub beyond: f64,
}

impl OppositeFaces {
    /// Faces of `slave` of which any part faces a face of `master` within reach. Where a whole body is named as the slave, these are the outer faces of it that are
    /// meant.
    ///
    /// # Errors
    /// A setting that is not allowed, a side without faces, a face without area. The sliding is not looked at.
    pub fn new(mesh: &Mesh, slave: &[FaceId], master: &[FaceId], pairing: &Pairing) -> Result<Self, ContactError> {
        pairing.check()?;
        let (slave, master) = (faces(mesh, slave, Side::Slave)?, faces(mesh, master, Side::Master)?);
        let mut search = Search::new(mesh, Side::Master, &master, pairing);
        let mut looks = |face: &Face| {
            search.segments(face).into_iter().any(|(own, _)| {
                let at = face.at(own);
                let found = search.opposite(&at.position, &at.area.normalize(), 0);
                matches!(found, Ok(Some(_)) | Err(ContactError::OnEachOther { .. }))
            })
        };
        let looking: Vec<bool> = slave.iter().map(&mut looks).collect();
        let faces = slave.iter().zip(&looking).filter(|(_, looks)| **looks).map(|(face, _)| face.id).collect();
        Ok(Self { faces, beyond: beyond(&slave, &looking) })
    }
}

/// Area of the faces that look at nothing and go on where others end, one after another from those that look at something.
fn beyond(faces: &[Face], looking: &[bool]) -> f64 {
    let normals: Vec<Vector3<f64>> = faces.iter().map(|face| face.area().normalize()).collect();
    let edges = |face: &Face| -> Vec<[usize; 2]> {
        let corners = &face.nodes[..face.kind.corners()];
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]).collect()
    };
    let mut beside: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    for (at, face) in faces.iter().enumerate() {
        edges(face).into_iter().for_each(|edge| beside.entry(edge).or_default().push(at));
    }
    // Faces to go on from, each with the first of its neighbours.
    let mut open: Vec<[usize; 2]> = (0..faces.len()).filter(|&at| looking[at]).map(|at| [at, at]).collect();
    let mut found = BTreeSet::new();
    while let Some([at, first]) = open.pop() {
        for other in edges(&faces[at]).iter().flat_map(|edge| &beside[edge]).copied() {
            let goes_on = normals[other].dot(&normals[at]) > FLAT && normals[other].dot(&normals[first]) > BENT;
            if !looking[other] && goes_on && found.insert(other) {
                open.push([other, first]);
            }
        }
    }
    found.into_iter().map(|at| faces[at].area().norm()).sum()
}
