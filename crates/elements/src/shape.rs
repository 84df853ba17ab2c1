//! Shape functions of solid elements and their derivatives.

use crate::kind::{Kind, MOST_NODES};

/// Values `N_a` and derivatives `dN_a/d(r, s, t)` of the shape functions of an element at a point, one for each node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    nodes: usize,
    values: [f64; MOST_NODES],
    derivatives: [[f64; 3]; MOST_NODES],
}

impl Kind {
    /// Shape functions and their derivatives at own coordinates.
    ///
    /// ```
    /// use elements::Kind;
    /// let shape = Kind::Hexahedron20.shape([0.2, -0.3, 0.9]);
    /// assert!((shape.values().iter().sum::<f64>() - 1.0).abs() < 1e-14);
    /// ```
    #[must_use]
    pub fn shape(self, own: [f64; 3]) -> Shape {
        let mut shape = Shape { nodes: self.nodes(), values: [0.0; MOST_NODES], derivatives: [[0.0; 3]; MOST_NODES] };
        match self.corners() {
            4 => shape.tetrahedron(self, own),
            6 => shape.wedge(self, own),
            _ => shape.hexahedron(self, own),
        }
        shape
    }
}

impl Shape {
    /// Shape functions `N_a`, one of each node.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values[..self.nodes]
    }

    /// Derivatives `dN_a/dr`, `dN_a/ds` and `dN_a/dt` of each node.
    #[must_use]
    pub fn derivatives(&self) -> &[[f64; 3]] {
        &self.derivatives[..self.nodes]
    }

    fn set(&mut self, node: usize, value: f64, derivative: [f64; 3]) {
        self.values[node] = value;
        self.derivatives[node] = derivative;
    }

    /// Shape functions of a tetrahedron in barycentric coordinates L: corners `L (2 L - 1)`, edges `4 L_a L_b`; linear ones L.
    fn tetrahedron(&mut self, kind: Kind, [r, s, t]: [f64; 3]) {
        let of = [1.0 - r - s - t, r, s, t];
        let slope = [[-1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for corner in 0..4 {
            let (l, d) = (of[corner], slope[corner]);
            match kind.is_quadratic() {
                true => self.set(corner, l * (2.0 * l - 1.0), d.map(|d| (4.0 * l - 1.0) * d)),
                false => self.set(corner, l, d),
            }
        }
        if kind.is_quadratic() {
            for (node, &[a, b]) in (4..).zip(kind.edges()) {
                let derivative = [0, 1, 2].map(|x| 4.0 * (of[a] * slope[b][x] + of[b] * slope[a][x]));
                self.set(node, 4.0 * of[a] * of[b], derivative);
            }
        }
    }

    /// Triangle by line. The 15 nodes are those of the serendipity family: corners `L (1 + e t) (2 L - 2 + e t) / 2` at t = e, edges of the
    /// triangles `2 L_a L_b (1 + e t)`, edges along t `L (1 - t^2)`.
    fn wedge(&mut self, kind: Kind, [r, s, t]: [f64; 3]) {
        let of = [1.0 - r - s, r, s];
        let slope = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
        for corner in 0..6 {
            let (l, d, e) = (of[corner % 3], slope[corner % 3], if corner < 3 { -1.0 } else { 1.0 });
            let rise = 1.0 + e * t;
            if kind.is_quadratic() {
                let by_l = 0.5 * rise * (4.0 * l - 2.0 + e * t);
                let by_t = 0.5 * l * e * (2.0 * l - 1.0 + 2.0 * e * t);
                self.set(corner, 0.5 * l * rise * (2.0 * l - 2.0 + e * t), [by_l * d[0], by_l * d[1], by_t]);
            } else {
                self.set(corner, 0.5 * l * rise, [0.5 * rise * d[0], 0.5 * rise * d[1], 0.5 * l * e]);
            }
        }
        if !kind.is_quadratic() {
            return;
        }
        for (node, &[a, b]) in (6..).zip(kind.edges()) {
            if a % 3 == b % 3 {
                let (l, d) = (of[a], slope[a]);
                let bow = 1.0 - t * t;
                self.set(node, l * bow, [d[0] * bow, d[1] * bow, -2.0 * l * t]);
            } else {
                let e = if a < 3 { -1.0 } else { 1.0 };
                let (a, b, rise) = (a % 3, b % 3, 1.0 + e * t);
                let along = [0, 1].map(|x| 2.0 * rise * (of[a] * slope[b][x] + of[b] * slope[a][x]));
                self.set(node, 2.0 * of[a] * of[b] * rise, [along[0], along[1], 2.0 * of[a] * of[b] * e]);
            }
        }
    }

    /// Products of lines; the 20 nodes are those of the serendipity family.
    fn hexahedron(&mut self, kind: Kind, own: [f64; 3]) {
        // A node is at -1, 0 or 1 in each direction.
        for (node, place) in kind.places().into_iter().enumerate() {
            let factor =
                [0, 1, 2].map(|x| if place[x] == 0.0 { 1.0 - own[x] * own[x] } else { 1.0 + place[x] * own[x] });
            let slope = [0, 1, 2].map(|x| if place[x] == 0.0 { -2.0 * own[x] } else { place[x] });
            let product = factor[0] * factor[1] * factor[2];
            let by =
                [slope[0] * factor[1] * factor[2], factor[0] * slope[1] * factor[2], factor[0] * factor[1] * slope[2]];
            if !kind.is_quadratic() {
                self.set(node, product / 8.0, by.map(|by| by / 8.0));
            } else if node >= 8 {
                self.set(node, product / 4.0, by.map(|by| by / 4.0));
            } else {
                let corner = (0..3).map(|x| place[x] * own[x]).sum::<f64>() - 2.0;
                let derivative = [0, 1, 2].map(|x| (by[x] * corner + product * place[x]) / 8.0);
                self.set(node, product * corner / 8.0, derivative);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A point inside of an element of this kind from three numbers of 0 to 1.
    fn inside(kind: Kind, [a, b, c]: [f64; 3]) -> [f64; 3] {
        match kind.corners() {
            4 => [a * (1.0 - b), b * (1.0 - c) * (1.0 - a), c * (1.0 - a) * (1.0 - b)],
            6 => [a * (1.0 - b), b * (1.0 - a), 2.0 * c - 1.0],
            _ => [a, b, c].map(|x| 2.0 * x - 1.0),
        }
    }

    #[test]
    fn each_is_one_at_its_node_and_zero_at_the_others() {
        for kind in Kind::ALL {
            for (at, place) in kind.places().into_iter().enumerate() {
                for (node, value) in kind.shape(place).values().iter().enumerate() {
                    let expected = if node == at { 1.0 } else { 0.0 };
                    assert!((value - expected).abs() < 1e-15, "{kind:?}, {node} at {at}: {value}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn they_add_up_to_one_and_derivatives_are_those_of_values(unit in prop::array::uniform3(0.01..0.99)) {
            const STEP: f64 = 1e-5;
            for kind in Kind::ALL {
                let own = inside(kind, unit);
                let shape = kind.shape(own);
                prop_assert!((shape.values().iter().sum::<f64>() - 1.0).abs() < 1e-14);
                for axis in 0..3 {
                    let total: f64 = shape.derivatives().iter().map(|d| d[axis]).sum();
                    prop_assert!(total.abs() < 1e-13);
                    let moved = |by: f64| {
                        let mut own = own;
                        own[axis] += by;
                        kind.shape(own)
                    };
                    let (before, after) = (moved(-STEP), moved(STEP));
                    for node in 0..kind.nodes() {
                        let difference = (after.values()[node] - before.values()[node]) / (2.0 * STEP);
                        let derivative = shape.derivatives()[node][axis];
                        prop_assert!((difference - derivative).abs() < 1e-8, "{:?} {}", kind, node);
                    }
                }
            }
        }

        /// Linear functions by all kinds, those of second degree by quadratic ones.
        #[test]
        fn polynomials_are_kept(unit in prop::array::uniform3(0.01..0.99), c in prop::array::uniform10(-2.0..2.0)) {
            for kind in Kind::ALL {
                let linear = |[r, s, t]: [f64; 3]| c[0] + c[1] * r + c[2] * s + c[3] * t;
                let quadratic = |[r, s, t]: [f64; 3]| {
                    c[4] * r * r + c[5] * s * s + c[6] * t * t + c[7] * r * s + c[8] * s * t + c[9] * t * r
                };
                let f = |p: [f64; 3]| -> f64 { linear(p) + if kind.is_quadratic() { quadratic(p) } else { 0.0 } };
                let own = inside(kind, unit);
                let shape = kind.shape(own);
                let sum: f64 = shape.values().iter().zip(kind.places()).map(|(n, place)| n * f(place)).sum::<f64>();
                prop_assert!((sum - f(own)).abs() < 1e-12, "{:?}: {} {}", kind, sum, f(own));
            }
        }
    }
}
