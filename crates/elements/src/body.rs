//! Parts of a mesh, and how what is integrated over their elements becomes a matrix of the model.

use std::collections::HashSet;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use nalgebra_sparse::{CooMatrix, CscMatrix};

use crate::points::Point;
use crate::{ElementsError, Mesh, Rows};

/// Body: a list of elements of a mesh, with the degrees of freedom of their nodes in a model.
#[derive(Debug, Clone)]
pub struct Body<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) elements: Vec<usize>,
    pub(crate) rows: &'a Rows,
}

impl<'a> Body<'a> {
    /// The body of the elements with these indices in the mesh.
    ///
    /// # Errors
    /// No elements, an index without one or given twice, an element that is inverted or has no volume.
    pub fn new(mesh: &'a Mesh, elements: Vec<usize>, rows: &'a Rows) -> Result<Self, ElementsError> {
        if elements.is_empty() {
            return Err(ElementsError::Empty { what: "elements" });
        }
        elements.iter().try_for_each(|&place| mesh.points(place).map(drop))?;
        let mut seen = HashSet::new();
        if let Some(&twice) = elements.iter().find(|place| !seen.insert(**place)) {
            return Err(ElementsError::Twice { what: "element", label: mesh.elements()[twice].label });
        }
        Ok(Self { mesh, elements, rows })
    }

    /// Volume of the body, in cubic units of length.
    ///
    /// # Errors
    /// None, as it was checked.
    pub fn volume(&self) -> Result<f64, ElementsError> {
        self.elements.iter().map(|&place| self.mesh.volume(place)).sum()
    }

    /// `sum_points w f_ab I_3`: a number for each pair of nodes of an element, alike in x, y and z. The function is told the
    /// index of the element.
    pub(crate) fn scalar(&self, f: impl Fn(usize, &Point, &mut DMatrix<f64>)) -> Result<CscMatrix<f64>, ElementsError> {
        let mut sum = CooMatrix::new(self.rows.order(), self.rows.order());
        for &place in &self.elements {
            let nodes = &self.mesh.element(place)?.nodes;
            let mut matrix = DMatrix::zeros(nodes.len(), nodes.len());
            self.mesh.points(place)?.iter().for_each(|point| f(place, point, &mut matrix));
            for (a, &row) in nodes.iter().enumerate() {
                for (b, &column) in nodes.iter().enumerate() {
                    for x in 0..3 {
                        if let (Some(row), Some(column)) = (self.rows.row(row, x), self.rows.row(column, x)) {
                            sum.push(row, column, matrix[(a, b)]);
                        }
                    }
                }
            }
        }
        Ok((&sum).into())
    }

    /// `sum_points f_ab`: a 3 x 3 matrix for each pair of nodes of an element.
    pub(crate) fn blocks(
        &self,
        f: impl Fn(&Point, usize, usize) -> Matrix3<f64>,
    ) -> Result<CscMatrix<f64>, ElementsError> {
        let mut sum = CooMatrix::new(self.rows.order(), self.rows.order());
        for &place in &self.elements {
            let nodes = &self.mesh.element(place)?.nodes;
            let points = self.mesh.points(place)?;
            for (a, &row) in nodes.iter().enumerate() {
                for (b, &column) in nodes.iter().enumerate() {
                    let block: Matrix3<f64> = points.iter().map(|point| f(point, a, b)).sum();
                    for (x, y) in (0..9).map(|i| (i / 3, i % 3)) {
                        if let (Some(row), Some(column)) = (self.rows.row(row, x), self.rows.row(column, y)) {
                            sum.push(row, column, block[(x, y)]);
                        }
                    }
                }
            }
        }
        Ok((&sum).into())
    }

    /// `sum_points w N_a f`: the forces of a load by volume.
    pub(crate) fn load(&self, f: impl Fn(&Point) -> Vector3<f64>) -> Result<DVector<f64>, ElementsError> {
        let mut sum = DVector::zeros(self.rows.order());
        for &place in &self.elements {
            let nodes = &self.mesh.element(place)?.nodes;
            for point in self.mesh.points(place)? {
                let force = f(&point) * point.weight;
                for (&node, &n) in nodes.iter().zip(point.shape.values()) {
                    (0..3)
                        .filter_map(|x| Some((x, self.rows.row(node, x)?)))
                        .for_each(|(x, row)| sum[row] += n * force[x]);
                }
            }
        }
        Ok(sum)
    }
}

/// A number of a material that must be finite and > 0.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, ElementsError> {
    let is_allowed = value.is_finite() && value > 0.0;
    if is_allowed { Ok(value) } else { Err(ElementsError::Material { what, value, allowed: "a finite number > 0" }) }
}

/// `(A + A^T) / 2`: a matrix that is symmetric but for the order of its sums, exactly so.
pub(crate) fn symmetric(a: &CscMatrix<f64>) -> CscMatrix<f64> {
    (a + a.transpose()) * 0.5
}
