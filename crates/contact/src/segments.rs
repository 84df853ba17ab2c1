//! A face of the slave cut along the edges of the master's faces.

use elements::{Face, FaceKind, FacePoint};
use nalgebra::Vector2;

use crate::grid::Grid;
use crate::project::project;

/// Fraction of the area of a face up to which a piece of it is dropped; chosen, above rounding.
const NO_PIECE: f64 = 1e-13;

type Polygon = Vec<Vector2<f64>>;

/// Fraction of the area of a face up to which what the master leaves uncovered is rounding; chosen: above that of sums of areas, and below any slit that
/// counts.
const UNCOVERED: f64 = 1e-6;

/// Points and weights on a face of the slave, in its own coordinates: seven on each triangle of each piece that a face of the master cuts out of it, and as
/// many of each piece that no face of the master covers, in a slit or beyond an edge.
pub(crate) fn segments(face: &Face, master: &[Face], grid: &Grid, largest_cosine: f64) -> Vec<FacePoint> {
    let outwards = face.area().normalize();
    let domain: Polygon = face.kind.places()[..face.kind.corners()].iter().map(|place| Vector2::from(*place)).collect();
    let whole = area(&domain);
    let (mut points, mut covered, mut outlines) = (Vec::new(), 0.0, Vec::new());
    for place in grid.near_face(face) {
        let opposite = &master[place];
        if opposite.area().normalize().dot(&outwards) > largest_cosine {
            continue;
        }
        let Some(outline) = outline(face, opposite) else { continue };
        let piece = clip(outline.clone(), &domain);
        let size = area(&piece);
        if size > NO_PIECE * whole {
            covered += size;
            triangles(&piece, &mut points);
            outlines.push(outline);
        }
    }
    if covered < (1.0 - UNCOVERED) * whole {
        without(domain, &outlines, NO_PIECE * whole).iter().for_each(|piece| triangles(piece, &mut points));
    }
    points
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
fn clip(polygon: Polygon, within: &[Vector2<f64>]) -> Polygon {
    let sides = within.iter().zip(within.iter().cycle().skip(1));
    sides.fold(polygon, |polygon, (from, to)| left_of(&polygon, *from, *to))
}

/// The part of a polygon on the left of a line, with the line.
fn left_of(polygon: &[Vector2<f64>], from: Vector2<f64>, to: Vector2<f64>) -> Polygon {
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
    kept
}

/// Convex pieces of a convex polygon that none of some outlines covers, larger than `least`. Of an outline the triangles between its middle and its sides are
/// taken away one after another; what is left beyond each side of a triangle is a piece.
fn without(polygon: Polygon, outlines: &[Polygon], least: f64) -> Vec<Polygon> {
    let mut left = vec![polygon];
    for outline in outlines {
        let middle = outline.iter().sum::<Vector2<f64>>() / outline.len() as f64;
        for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
            let triangle = [middle, *a, *b];
            // Of an outline that bends inwards a side may see its middle from outside.
            if area(&triangle) <= 0.0 {
                continue;
            }
            let mut beyond = Vec::new();
            for mut inside in left {
                for (from, to) in [(middle, *a), (*a, *b), (*b, middle)] {
                    let outside = left_of(&inside, to, from);
                    inside = left_of(&inside, from, to);
                    if area(&outside) > least {
                        beyond.push(outside);
                    }
                }
            }
            left = beyond;
        }
    }
    left
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

    #[test]
    fn what_outlines_leave_of_a_square_has_the_rest_of_its_area() {
        let at = |x: f64, y: f64| Vector2::new(x, y);
        let square = vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        // A window within, a corner cut off that overlaps it, and an outline that bends inwards.
        let window = vec![at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)];
        let corner = vec![at(0.0, 0.0), at(3.0, 0.0), at(3.0, 3.0), at(0.0, 3.0)];
        let arrow = vec![at(-3.0, -1.0), at(-0.7, -1.0), at(-0.9, 0.0), at(-0.7, 1.0), at(-3.0, 1.0)];
        let sum = |outlines: &[Polygon]| -> f64 {
            without(square.clone(), outlines, 1e-12).iter().map(|piece| area(piece)).sum()
        };
        for (outlines, left) in [
            (vec![], 4.0),
            (vec![window.clone()], 3.0),
            (vec![corner.clone()], 3.0),
            (vec![window.clone(), corner.clone()], 2.25),
            (vec![arrow], 4.0 - 0.4),
            (vec![square.clone(), window], 0.0),
        ] {
            assert!((sum(&outlines) - left).abs() < 1e-12, "{left}: {}", sum(&outlines));
        }
    }
}
