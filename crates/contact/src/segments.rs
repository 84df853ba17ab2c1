//! A face of the slave cut along the edges of the master's faces.

use elements::{Face, FaceKind, FacePoint};
use nalgebra::Vector2;

use crate::grid::Grid;
use crate::project::project;

/// Fraction of the area of a face up to which a piece of it is dropped; chosen, above rounding.
const NO_PIECE: f64 = 1e-13;

type Polygon = Vec<Vector2<f64>>;

/// Length of a side of a piece, in own coordinates, up to which its direction is rounding; chosen.
const NO_SIDE: f64 = 1e-9;

/// Fraction of the area of a face up to which what the master leaves uncovered, or covers twice, is rounding; chosen: above that of sums of areas, and below any
/// slit that counts.
const ROUNDED: f64 = 1e-6;

/// Points and weights on a face of the slave, in its own coordinates: seven on each triangle of each piece that a face of the master cuts out of it, and as
/// many of each piece that no face of the master covers, in a slit or beyond an edge. Where faces of the master lie one behind the other, what is cut out by one is not
/// cut out again: which of them is opposite is asked of each point.
pub(crate) fn segments(face: &Face, master: &[Face], grid: &Grid, largest_cosine: f64) -> Vec<FacePoint> {
    let outwards = face.area().normalize();
    let domain: Polygon = face.kind.places()[..face.kind.corners()].iter().map(|place| Vector2::from(*place)).collect();
    let whole = area(&domain);
    let least = NO_PIECE * whole;
    let sum = |pieces: &[Polygon]| pieces.iter().map(|piece| area(piece)).sum::<f64>();
    let looks = |place: &usize| master[*place].area().normalize().dot(&outwards) <= largest_cosine;
    let near = grid.near_face(face).into_iter().filter(looks).filter_map(|place| outline(face, &master[place]));
    let of_domain = |outline: Polygon| (clip(outline.clone(), &domain), outline);
    let cut = near.map(of_domain).filter(|(piece, _)| area(piece) > least);
    let (mut pieces, outlines): (Vec<Polygon>, Vec<Polygon>) = cut.unzip();
    let mut left = vec![domain.clone()];
    for outline in &outlines {
        left = without(left, outline, least);
    }
    let uncovered = sum(&left);
    if sum(&pieces) + uncovered > (1.0 + ROUNDED) * whole {
        (pieces, left) = (Vec::new(), vec![domain]);
        for outline in &outlines {
            let cut = left.iter().map(|of| clip(outline.clone(), of)).filter(|piece| area(piece) > least);
            pieces.extend(cut);
            left = without(left, outline, least);
        }
    }
    if uncovered > ROUNDED * whole {
        pieces.extend(left);
    }
    let mut points = Vec::new();
    pieces.iter().for_each(|piece| triangles(piece, &mut points));
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
    let has_direction = |(from, to): &(&Vector2<f64>, &Vector2<f64>)| (*to - *from).norm() > NO_SIDE;
    sides.filter(has_direction).fold(polygon, |polygon, (from, to)| left_of(&polygon, *from, *to))
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

/// Pieces that an outline leaves of convex polygons: convex ones, larger than `least`. The triangles between the middle of the outline and its sides are taken away one
/// after another, and what is left beyond each side of a triangle is a piece.
fn without(mut polygons: Vec<Polygon>, outline: &[Vector2<f64>], least: f64) -> Vec<Polygon> {
    let middle = outline.iter().sum::<Vector2<f64>>() / outline.len() as f64;
    for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        let sides = [(middle, *a), (*a, *b), (*b, middle)];
        // Of an outline that bends inwards a side may see its middle from outside.
        if area(&[middle, *a, *b]) <= 0.0 {
            continue;
        }
        let mut left = Vec::new();
        for polygon in polygons {
            if area(&sides.iter().fold(polygon.clone(), |inside, (from, to)| left_of(&inside, *from, *to))) <= least {
                left.push(polygon);
                continue;
            }
            let mut inside = polygon;
            for (from, to) in sides {
                let outside = left_of(&inside, to, from);
                inside = left_of(&inside, from, to);
                if area(&outside) > least {
                    left.push(outside);
                }
            }
        }
        polygons = left;
    }
    polygons
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
            let left = outlines.iter().fold(vec![square.clone()], |left, outline| without(left, outline, 1e-12));
            left.iter().map(|piece| area(piece)).sum()
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

    #[test]
    fn what_is_cut_out_by_two_layers_is_cut_out_once() {
        let at = |x: f64, y: f64| Vector2::new(x, y);
        let domain = vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        for step in 0..200 {
            let (sin, cos) = (0.031 * f64::from(step)).sin_cos();
            let turned = |x: f64, y: f64| at(x * cos - y * sin, x * sin + y * cos);
            let rectangle = |[a, c]: [f64; 2], [b, d]: [f64; 2]| -> Polygon {
                vec![turned(a, b), turned(c, b), turned(c, d), turned(a, d)]
            };
            let layer = |from: [f64; 2], size: [f64; 2], count: [usize; 2]| -> Vec<Polygon> {
                let side = |axis: usize, i: usize| [0, 1].map(|end| from[axis] + (i + end) as f64 * size[axis]);
                (0..count[0] * count[1]).map(|i| rectangle(side(0, i % count[0]), side(1, i / count[0]))).collect()
            };
            let first = layer([-3.0, -0.7], [1.0, 1.0], [4, 2]);
            let outlines = [first, layer([-2.9, -0.6], [1.9, 0.45], [2, 4])].concat();
            let (mut pieces, mut left) = (Vec::new(), vec![domain.clone()]);
            for outline in &outlines {
                pieces.extend(left.iter().map(|of| clip(outline.clone(), of)));
                left = without(left, outline, 1e-13);
            }
            let common = area(&clip(rectangle([-3.0, 1.0], [-0.7, 1.3]), &domain));
            let [cut, left] = [&pieces, &left].map(|of| of.iter().map(|piece| area(piece)).sum::<f64>());
            assert!((cut - common).abs() < 1e-10 && (cut + left - 4.0).abs() < 1e-10, "{step}: {cut} of {common}");
        }
    }
}
