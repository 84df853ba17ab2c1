//! Rules of integration: points with weights on lines, triangles, squares and solids.

use crate::kind::Kind;

/// A point of a rule on a solid with its weight. The weights of a rule add up to the volume in own coordinates.
pub type SolidPoint = ([f64; 3], f64);
/// A point of a rule on a face with its weight. The weights of a rule add up to the area in own coordinates.
pub type FacePoint = ([f64; 2], f64);

/// Points and weights of Gauss and Legendre on -1 to 1: 2 points are exact to degree 3, 3 to degree 5.
pub(crate) fn line(points: usize) -> Vec<(f64, f64)> {
    match points {
        0 | 1 => vec![(0.0, 2.0)],
        2 => {
            let at = 1.0 / 3.0_f64.sqrt();
            vec![(-at, 1.0), (at, 1.0)]
        }
        _ => {
            let at = 0.6_f64.sqrt();
            vec![(-at, 5.0 / 9.0), (0.0, 8.0 / 9.0), (at, 5.0 / 9.0)]
        }
    }
}

/// Three points in a triangle `r, s >= 0, r + s <= 1`, exact to degree 2.
pub(crate) fn triangle3() -> Vec<FacePoint> {
    let (a, b) = (1.0 / 6.0, 2.0 / 3.0);
    [[a, a], [b, a], [a, b]].map(|own| (own, 1.0 / 6.0)).to_vec()
}

/// Seven points in a triangle, exact to degree 5 (Radon 1948; Stroud's T2 5-1).
pub(crate) fn triangle7() -> Vec<FacePoint> {
    let root = 15.0_f64.sqrt();
    let third = 1.0 / 3.0;
    let mut points = vec![([third, third], 9.0 / 80.0)];
    for sign in [-1.0, 1.0] {
        let (a, weight) = ((6.0 + sign * root) / 21.0, (155.0 + sign * root) / 2400.0);
        let b = 1.0 - 2.0 * a;
        points.extend([[a, a], [b, a], [a, b]].map(|own| (own, weight)));
    }
    points
}

/// n x n points of Gauss on a square of side 2.
pub(crate) fn square(points: usize) -> Vec<FacePoint> {
    let line = line(points);
    line.iter().flat_map(|&(r, u)| line.iter().map(move |&(s, v)| ([r, s], u * v))).collect()
}

/// Four points in a tetrahedron, exact to degree 2.
fn tetrahedron4() -> Vec<SolidPoint> {
    let (a, b) = ((5.0 - 5.0_f64.sqrt()) / 20.0, (5.0 + 3.0 * 5.0_f64.sqrt()) / 20.0);
    [[a, a, a], [b, a, a], [a, b, a], [a, a, b]].map(|own| (own, 1.0 / 24.0)).to_vec()
}

/// Fifteen points in a tetrahedron, exact to degree 5 (Stroud's T3 5-1).
fn tetrahedron15() -> Vec<SolidPoint> {
    let root = 15.0_f64.sqrt();
    let mut points = vec![([0.25; 3], 16.0 / 135.0 / 6.0)];
    for sign in [-1.0, 1.0] {
        let (a, weight) = ((7.0 + sign * root) / 34.0, (2665.0 - sign * 14.0 * root) / 37800.0 / 6.0);
        let b = 1.0 - 3.0 * a;
        points.extend([[a, a, a], [b, a, a], [a, b, a], [a, a, b]].map(|own| (own, weight)));
    }
    let (a, b, weight) = ((10.0 - 2.0 * root) / 40.0, (10.0 + 2.0 * root) / 40.0, 20.0 / 378.0 / 6.0);
    points.extend([[a, a, b], [a, b, a], [b, a, a], [b, b, a], [b, a, b], [a, b, b]].map(|own| (own, weight)));
    points
}

impl Kind {
    /// Points and weights that integrate the product of two shape functions exactly where the element is not distorted: 4 and 15 points
    /// of a tetrahedron, 3 x 2 and 7 x 3 of a wedge, 2 x 2 x 2 and 3 x 3 x 3 of a hexahedron.
    #[must_use]
    pub fn rule(self) -> Vec<SolidPoint> {
        let along = line(if self.is_quadratic() { 3 } else { 2 });
        let prism = |face: Vec<FacePoint>| -> Vec<SolidPoint> {
            let at = |([r, s], u): FacePoint| along.iter().map(move |&(t, v)| ([r, s, t], u * v)).collect::<Vec<_>>();
            face.into_iter().flat_map(at).collect()
        };
        match self {
            Self::Tetrahedron4 => tetrahedron4(),
            Self::Tetrahedron10 => tetrahedron15(),
            Self::Wedge6 => prism(triangle3()),
            Self::Wedge15 => prism(triangle7()),
            Self::Hexahedron8 => prism(square(2)),
            Self::Hexahedron20 => prism(square(3)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: u32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// The integral of `x^n` over -1 to 1.
    fn of_line(n: u32) -> f64 {
        if n.is_multiple_of(2) { 2.0 / f64::from(n + 1) } else { 0.0 }
    }

    /// The integral of `r^a s^b t^c` over an element.
    fn exact(kind: Kind, [a, b, c]: [u32; 3]) -> f64 {
        match kind.corners() {
            4 => factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3),
            6 => factorial(a) * factorial(b) / factorial(a + b + 2) * of_line(c),
            _ => of_line(a) * of_line(b) * of_line(c),
        }
    }

    #[test]
    fn monomials_are_integrated_exactly() {
        for kind in Kind::ALL {
            let degree = if kind.is_quadratic() { 5 } else { 2 };
            for powers in (0..6_u32.pow(3)).map(|i| [i % 6, i / 6 % 6, i / 36]) {
                let [a, b, c] = powers;
                let is_exact = match kind.corners() {
                    4 => a + b + c <= degree,
                    6 => a + b <= degree && c <= degree.max(3),
                    _ => a.max(b).max(c) <= degree.max(3),
                };
                if !is_exact {
                    continue;
                }
                let power = |x: f64, n: u32| x.powi(n as i32);
                let terms = kind.rule().into_iter().map(|([r, s, t], w)| w * power(r, a) * power(s, b) * power(t, c));
                let sum: f64 = terms.sum();
                assert!((sum - exact(kind, powers)).abs() < 2e-15, "{kind:?} {powers:?}: {sum}");
            }
        }
    }
}
