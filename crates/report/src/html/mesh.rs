//! The surface of a mesh, so that modes on it can be seen to move.

use serde_json::{Value, json};

use super::packed::{packed, packed_places};

/// Nodes of a surface that a page shows, at most; chosen: their positions and faces are a megabyte then, and a browser that draws without a
/// graphics card was seen to take a third of a second for each picture.
const MOST_NODES: usize = 40_000;

/// The surface of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSurface {
    /// Labels of the nodes on the surface.
    pub labels: Vec<i64>,
    /// Positions of these nodes at rest: x, y and z.
    pub positions: Vec<[f64; 3]>,
    /// Faces: four nodes around each, as indices into `labels` and `positions`; a triangle has its last node twice, a line three times, a
    /// point four times.
    pub faces: Vec<[usize; 4]>,
    /// Number of faces, the first ones, that bound a solid: seen from outside, their nodes go around against the clock.
    pub of_solids: usize,
}

impl MeshSurface {
    /// Reason why the surface cannot be shown, where that is so.
    pub(super) fn too_large(&self) -> Option<String> {
        (self.labels.len() > MOST_NODES).then(|| {
            format!(
                "The surface of the mesh has {} nodes, more than the {MOST_NODES} that a page can move. The files shapes-SET.vtu of \
                 squeal run have modes on the mesh, for ParaView.",
                self.labels.len()
            )
        })
    }

    /// The surface: positions of nodes from the middle, as parts of `half`, the half of its largest side.
    pub(super) fn json(&self) -> Value {
        let end = |axis: usize, of: fn(f64, f64) -> f64, start: f64| {
            self.positions.iter().map(|position| position[axis]).fold(start, of)
        };
        let ends = [0, 1, 2].map(|axis| [end(axis, f64::min, f64::INFINITY), end(axis, f64::max, f64::NEG_INFINITY)]);
        let middle = ends.map(|[least, most]| 0.5 * least + 0.5 * most);
        let half = ends.iter().map(|[least, most]| 0.5 * most - 0.5 * least).fold(f64::MIN_POSITIVE, f64::max);
        let from_middle = self.positions.iter().flat_map(|at| [0, 1, 2].map(|axis| at[axis] - middle[axis]));
        json!({
            "nodes": self.labels,
            "middle": middle,
            "half": half,
            "at": packed(from_middle, half),
            "faces": packed_places(self.faces.iter().flatten().copied()),
            "of_solids": self.of_solids,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rectangles side by side, each 0.1 long in x and 0.05 in y.
    fn plate() -> MeshSurface {
        MeshSurface {
            labels: vec![11, 12, 13, 21, 22, 23],
            positions: (0..6).map(|i| [0.1 * f64::from(i % 3), 0.05 * f64::from(i / 3), 3.0]).collect(),
            faces: vec![[0, 1, 4, 3], [1, 2, 5, 4]],
            of_solids: 0,
        }
    }

    #[test]
    fn places_are_stored_from_the_middle() {
        let shown = plate().json();
        assert_eq!(shown["nodes"], json!([11, 12, 13, 21, 22, 23]));
        let number = |value: &Value| value.as_f64().unwrap();
        let found = [&shown["middle"][0], &shown["middle"][1], &shown["middle"][2], &shown["half"]].map(number);
        assert!(found.iter().zip([0.1, 0.025, 3.0, 0.1]).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        let from_middle = (0..6).flat_map(|i| [f64::from(i % 3) - 1.0, 0.5 * f64::from(i / 3) - 0.25, 0.0]);
        assert_eq!(shown["at"], json!(packed(from_middle, 1.0)));
        assert_eq!(shown["faces"], json!(packed_places([0, 1, 4, 3, 1, 2, 5, 4])));
    }

    #[test]
    fn a_surface_that_is_too_large_says_where_its_modes_are() {
        assert_eq!(plate().too_large(), None);
        let why = MeshSurface { labels: vec![1; MOST_NODES + 1], ..plate() }.too_large().unwrap();
        assert!(why.contains("40001 nodes") && why.contains("shapes-SET.vtu"), "{why}");
    }
}
