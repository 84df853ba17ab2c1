//! A face of the slave cut along the edges of the master's faces.

use elements::{Face, FaceKind, FacePoint};
use nalgebra::Vector2;

use crate::grid::Grid;
use crate::project::project;

/// Fraction of the area of a face up to which a piece of it is dropped; chosen, above rounding.
const NO_PIECE: f64 = 1e-13;

type Polygon = Vec<Vector2<f64>>;

/// Points and weights on a face of the slave, in its own coordinates: seven on each triangle of each piece that a face of the master cuts out of it. Where
/// the master leaves something uncovered it has the points of the whole face instead.
pub(crate) fn segments(face: &Face, master: &[Face], grid: &Grid, largest_cosine: f64) -> Vec<FacePoint> {
    let outwards = face.area().normalize();
    let domain: Polygon = face.kind.places()[..face.kind.corners()].iter().map(|place| Vector2::from(*place)).collect();
    let whole = area(&domain);
    let (mut points, mut covered) = (Vec::new(), 0.0);
    for place in grid.near_face(face) {
        let opposite = &master[place];
        if opposite.area().normalize().dot(&outwards) > largest_cosine {
            continue;
        }
        let Some(outline) = outline(face, opposite) else { continue };
        let piece = clip(outline, &domain);
        let size = area(&piece);
        if size > NO_PIECE * whole {
            covered += size;
            triangles(&piece, &mut points);
        }
    }
    // Uncovered parts are refused where the points of the face are projected. Chosen: above the rounding of sums of areas, and below any slit that counts.
    const COVERED: f64 = 1e-6;
    if covered < (1.0 - COVERED) * whole { face.kind.rule() } else { points }
}

/// The border of a face of the master in own coordinates of the slave's, against the clock.
fn outline(face: &Face, opposite: &Face) -> Option<Polygon> {
    let corners = opposite.kind.corners();
    let middles = opposite.positions.len() > corners;
    let mut around = Vec::new();
    for corner in 0..corners {
        around.push(opposite.positions[corner]);
        around.extend(middles.then(|| opposite.positions[corners + corner]));
    }
    let own = |position| project(face, position).map(|found| Vector2::from(found.own));
    let mut polygon = around.iter().map(own).collect::<Option<Polygon>>()?;
    if area(&polygon) < 0.0 {
        polygon.reverse();
    }
    Some(polygon)
}

fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

fn area(polygon: &[Vector2<f64>]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    0.5 * polygon.iter().zip(next).map(|(a, b)| cross(*a, *b)).sum::<f64>()
}

/// Intersection of a polygon with a convex one (Sutherland and Hodgman).
fn clip(mut polygon: Polygon, within: &[Vector2<f64>]) -> Polygon {
    for (from, to) in within.iter().zip(within.iter().cycle().skip(1)) {
        let side = |p: &Vector2<f64>| cross(to - from, p - from);
        let mut kept = Vec::new();
        for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
            let (before, after) = (side(a), side(b));
            if before >= 0.0 {
                kept.push(*a);
            }
            if (before >= 0.0) != (after >= 0.0) {
                kept.push(a + (b - a) * (before / (before - after)));
            }
        }
        polygon = kept;
    }
    polygon
}

/// Adds seven points for each triangle between the middle of a polygon and its sides.
fn triangles(polygon: &[Vector2<f64>], points: &mut Vec<FacePoint>) {
    let middle = polygon.iter().sum::<Vector2<f64>>() / polygon.len() as f64;
    for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (u, v) = (a - middle, b - middle);
        let twice = cross(u, v);
        if twice.abs() > NO_PIECE {
            for ([r, s], weight) in FaceKind::Triangle6.rule() {
                points.push(((middle + u * r + v * s).into(), weight * twice));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_a_square_have_its_area() {
        let at = |x: f64, y: f64| Vector2::new(x, y);
        let square = vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        let large = vec![at(-3.0, -3.0), at(0.3, -3.0), at(-0.4, 4.0), at(-3.0, 3.0)];
        let other = vec![at(0.3, -3.0), at(5.0, -3.0), at(5.0, 4.0), at(-0.4, 4.0)];
        let pieces = [clip(large, &square), clip(other, &square)];
        assert!((pieces.iter().map(|piece| area(piece)).sum::<f64>() - 4.0).abs() < 1e-14);
        let mut points = Vec::new();
        pieces.iter().for_each(|piece| triangles(piece, &mut points));
        let integral: f64 = points.iter().map(|([r, s], w)| w * r * r * s * s).sum();
        assert!((integral - 4.0 / 9.0).abs() < 1e-14);
        assert!(clip(vec![at(2.0, 2.0), at(3.0, 2.0), at(3.0, 3.0)], &square).is_empty());
    }
}
