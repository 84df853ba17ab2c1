//! Two sides of a contact whose meshes do not match, and the points between them.

use elements::{Face, FaceId, FacePoint, FaceShape, Mesh};
use nalgebra::Vector3;

use crate::grid::Grid;
use crate::point::ContactPoint;
use crate::project::{Projection, project};
use crate::segments::segments;
use crate::sliding::{Sliding, faces, value};
use crate::{ContactError, Side};

/// Weights up to this absolute value are rounding of a shape function, or of a component of a normal, that is zero.
const NO_WEIGHT: f64 = 1e-14;
/// Distance of two projections of a point, as a fraction of the reach, up to which they are one place; chosen, above rounding.
const SAME: f64 = 1e-6;
/// Width of the border of a face, as a fraction of it, on which a point may be opposite to the next face as well; chosen, far above [`SAME`].
const BORDER: f64 = 1e-3;

/// Rule by which the slave's faces are integrated over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Integration {
    /// Points of Gauss of each face of the slave, each on whatever face of the master is opposite: 2 x 2 of a linear, 3 x 3 of a quadratic
    /// quadrilateral, 3 and 7 of a triangle. What the master gets of a constant pressure is exact but for what its shape functions bend
    /// within a face of the slave. A face with a corner beside the master is cut as for [`Integration::Segments`].
    #[default]
    GaussPoints,
    /// Points of pieces: each face of the slave is cut along the edges of the master's, and each piece has seven points of its own. A constant
    /// pressure passes exactly between flat faces with straight edges. Ten times as many points.
    Segments,
}

/// Pairing: the settings by which points between two sides are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pairing {
    /// Velocity of the master under the slave.
    pub sliding: Sliding,
    /// Largest distance or overlap at a point.
    pub reach: f64,
    /// Rule of integration.
    pub integration: Integration,
    /// Largest cosine of the angle between the normals to the outside of both sides; -1 where they look at each other exactly.
    pub largest_cosine: f64,
    /// Largest distance of a point outside of the master's faces, in their own coordinates (2 across a quadrilateral): meshes of a curved face
    /// leave slits between their facets.
    pub slit: f64,
    /// True where points of the slave that have no face of the master opposite at any distance carry nothing, as those of a pad over the edge of a disc or over its
    /// holes; false where they are refused.
    pub overhang: bool,
}

impl Pairing {
    /// A pairing with points of Gauss, normals that look at each other within 60 degrees, slits of a hundredth of a face, and no overhang.
    #[must_use]
    pub fn new(sliding: Sliding, reach: f64) -> Self {
        Self {
            sliding,
            reach,
            integration: Integration::GaussPoints,
            largest_cosine: -0.5,
            slit: 0.02,
            overhang: false,
        }
    }

    pub(crate) fn check(&self) -> Result<(), ContactError> {
        if !(self.reach.is_finite() && self.reach > 0.0) {
            return Err(value("the reach of a contact", self.reach, "a finite distance > 0"));
        }
        if !(self.largest_cosine > -1.0 && self.largest_cosine < 0.0) {
            return Err(value("the largest cosine of normals", self.largest_cosine, "above -1 and below 0"));
        }
        if !(self.slit >= 0.0 && self.slit < 1.0) {
            return Err(value("the slit between faces", self.slit, "0 or more, below 1"));
        }
        Ok(())
    }
}

/// Interface: the contact points between a slave and a master, face by face of the slave.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    points: Vec<ContactPoint>,
    overhang: f64,
    projections: usize,
}

impl Interface {
    /// The points between faces of a slave and of a master.
    ///
    /// # Errors
    /// A setting that is not allowed, a side without faces, a face without area, faces that do not meet, a master that is smaller than the
    /// slave without [`Pairing::overhang`], normals that contradict each other, an axis through the slave, no sliding along a face.
    pub fn new(mesh: &Mesh, slave: &[FaceId], master: &[FaceId], pairing: &Pairing) -> Result<Self, ContactError> {
        pairing.check()?;
        let (slave, master) = (faces(mesh, slave, Side::Slave)?, faces(mesh, master, Side::Master)?);
        pairing.sliding.check(mesh, &slave)?;
        let mut own = Search::new(mesh, Side::Slave, &slave, pairing);
        for face in &slave {
            let (at, node) = (face.at(middle(face)), mesh.labels()[face.nodes[0]]);
            // Seen from within, a face is opposite to itself, and to others that look the same way.
            if let Err(error @ ContactError::OnEachOther { .. }) =
                own.opposite(&at.position, &-at.area.normalize(), node)
            {
                return Err(error);
            }
        }
        let mut search = Search::new(mesh, Side::Master, &master, pairing);
        let mut points: Vec<ContactPoint> = Vec::new();
        // Points without a face opposite, with what each has of the area.
        let mut beside = Vec::new();
        for face in &slave {
            let rule = match pairing.integration {
                Integration::GaussPoints if search.is_over_corners(face) => face.kind.rule(),
                _ => search.segments(face),
            };
            for (own, weight) in rule {
                let at = face.at(own);
                let node = mesh.labels()[face.nodes[largest(&at.shape)]];
                let outwards = at.area.normalize();
                let Some((opposite, found)) = search.opposite(&at.position, &outwards, node)? else {
                    beside.push((node, at.position, outwards, weight * at.area.norm()));
                    continue;
                };
                let normal = snapped(&found.normal);
                let (sliding, speed) = pairing.sliding.on(&at.position, &normal, node)?;
                points.push(ContactPoint {
                    position: at.position,
                    normal,
                    sliding,
                    speed,
                    gap: found.gap,
                    area: weight * at.area.norm(),
                    slave_face: face.id,
                    master_face: opposite.id,
                    slave: weights(face, &at.shape),
                    master: weights(opposite, &found.at.shape),
                });
            }
        }
        let mut overhang = 0.0;
        if pairing.overhang && !points.is_empty() {
            beside.retain(|(_, position, outwards, area)| {
                let hangs = search.distance(position, outwards, pairing.largest_cosine).is_infinite();
                overhang += if hangs { *area } else { 0.0 };
                !hangs
            });
        }
        let Some(&(node, position, outwards, _)) = beside.first() else {
            return Ok(Self { points, overhang, projections: search.projections });
        };
        let aside: f64 = beside.iter().map(|(.., area)| area).sum();
        // Where no face is within reach of any point, one that looks elsewhere says how far off it is, too.
        let largest_cosine = if points.is_empty() { f64::INFINITY } else { pairing.largest_cosine };
        let (distance, reach) = (search.distance(&position, &outwards, largest_cosine), pairing.reach);
        let share = aside / (aside + points.iter().map(|point| point.area).sum::<f64>());
        Err(match points.is_empty() || distance.is_finite() {
            true => ContactError::Apart { node, distance, reach },
            false => ContactError::MasterSmaller { node, share },
        })
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[ContactPoint] {
        &self.points
    }

    /// The area, as the points add up to it.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.points.iter().map(|point| point.area).sum()
    }

    /// The area of the slave that overhangs the master and carries nothing ([`Pairing::overhang`]), as the points without a face opposite add up to it.
    #[must_use]
    pub fn overhang(&self) -> f64 {
        self.overhang
    }

    /// Number of projections of a point on a face: what the search costs.
    #[must_use]
    pub fn projections(&self) -> usize {
        self.projections
    }
}

/// A normal along an axis up to rounding, exactly along it: rows have a third of the entries then.
fn snapped(normal: &Vector3<f64>) -> Vector3<f64> {
    normal.map(|x| if x.abs() < NO_WEIGHT { 0.0 } else { x }).normalize()
}

/// Nodes of a face with their shape functions.
fn weights(face: &Face, shape: &FaceShape) -> Vec<(usize, f64)> {
    let all = face.nodes.iter().copied().zip(shape.values().iter().copied());
    all.filter(|(_, weight)| weight.abs() > NO_WEIGHT).collect()
}

/// True if own coordinates are within a face, and not next to its border.
fn is_within(face: &Face, own: [f64; 2]) -> bool {
    let middle = middle(face);
    face.kind.outside([0, 1].map(|x| middle[x] + (1.0 + BORDER) * (own[x] - middle[x]))) == 0.0
}

/// The middle of a face, in own coordinates.
fn middle(face: &Face) -> [f64; 2] {
    let places = face.kind.places();
    [0, 1].map(|x| places.iter().map(|place| place[x]).sum::<f64>() / places.len() as f64)
}

/// The node of a face with the largest shape function.
fn largest(shape: &FaceShape) -> usize {
    let values = shape.values().iter().enumerate();
    values.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(node, _)| node)
}

/// The faces of a side, searched for what is opposite to a point.
pub(crate) struct Search<'a> {
    mesh: &'a Mesh,
    side: Side,
    grid: Grid,
    faces: &'a [Face],
    pairing: &'a Pairing,
    projections: usize,
}

impl<'a> Search<'a> {
    pub(crate) fn new(mesh: &'a Mesh, side: Side, faces: &'a [Face], pairing: &'a Pairing) -> Self {
        Self { mesh, side, grid: Grid::new(faces, pairing.reach), faces, pairing, projections: 0 }
    }

    /// Points and weights on a face that is cut along the edges of the master's.
    pub(crate) fn segments(&self, face: &Face) -> Vec<FacePoint> {
        segments(face, self.faces, &self.grid, self.pairing.largest_cosine)
    }

    /// The face opposite to a point, whose own face looks `outwards`: among the faces within reach the face that the point is over, and of two
    /// such faces the nearer one. Two faces that lie on each other are refused, as the first one is no more opposite than the second.
    pub(crate) fn opposite(
        &mut self,
        at: &Vector3<f64>,
        outwards: &Vector3<f64>,
        node: i64,
    ) -> Result<Option<(&'a Face, Projection)>, ContactError> {
        let mut best: Option<(&Face, Projection)> = None;
        // The least cosine of a face that is over the point and looks elsewhere.
        let mut contradicting: Option<f64> = None;
        for place in self.grid.near(at) {
            let face = &self.faces[place];
            self.projections += 1;
            let Some(found) = project(face, at) else { continue };
            if found.outside > self.pairing.slit || found.gap.abs() > self.pairing.reach {
                continue;
            }
            let cosine = found.normal.dot(outwards);
            if cosine > self.pairing.largest_cosine {
                // Beside the edge of a whole body is its rim, which looks aside.
                if self.pairing.overhang && cosine < -self.pairing.largest_cosine {
                    continue;
                }
                contradicting = Some(contradicting.map_or(cosine, |least| least.min(cosine)));
                continue;
            }
            // On the edge of two faces a point is within neither.
            let on_each_other = |(known, other): &(&Face, Projection)| {
                let apart = (other.at.position - found.at.position).norm();
                apart <= SAME * self.pairing.reach && is_within(known, other.own) && is_within(face, found.own)
            };
            if let Some((known, _)) = best.as_ref().filter(|best| on_each_other(best)) {
                let [first, second] = [known, face].map(|face| self.mesh.elements()[face.id.element].label);
                return Err(ContactError::OnEachOther { side: self.side, node, first, second });
            }
            let rank = |found: &Projection| (found.outside.max(1e-9), found.gap.abs());
            let is_better = best.as_ref().is_none_or(|(_, known)| rank(&found) < rank(known));
            if is_better {
                best = Some((face, found));
            }
        }
        match (best, contradicting) {
            (None, Some(cosine)) => Err(ContactError::Normals { node, cosine, allowed: self.pairing.largest_cosine }),
            (best, _) => Ok(best),
        }
    }

    /// True if each corner of a face has a face of the master opposite, so that it does not hang over the edge of the master.
    fn is_over_corners(&mut self, face: &Face) -> bool {
        face.kind.places()[..face.kind.corners()].iter().all(|place| {
            let at = face.at(*place);
            matches!(self.opposite(&at.position, &at.area.normalize(), 0), Ok(Some(_)))
        })
    }

    /// Distance from a point to the nearest face that it is over, within reach or not, of those whose normals have at most this cosine with its
    /// own; infinite where the point is over no such face.
    fn distance(&self, at: &Vector3<f64>, outwards: &Vector3<f64>, largest_cosine: f64) -> f64 {
        let is_over =
            |found: &Projection| found.outside <= self.pairing.slit && found.normal.dot(outwards) <= largest_cosine;
        let found = self.faces.iter().filter_map(|face| project(face, at).filter(is_over));
        found.map(|found| found.gap.abs()).fold(f64::INFINITY, f64::min)
    }
}
