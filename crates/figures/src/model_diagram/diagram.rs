//! Data of a drawing of the model.

/// Data of a drawing of a lattice.
#[derive(Debug, Clone, Default)]
pub struct ModelDiagram {
    /// Title above everything; may be empty.
    pub title: String,
    /// Rows of the lattice.
    pub rows: usize,
    /// Columns of the lattice.
    pub columns: usize,
    /// Contact of each oscillator with the plate, by rows.
    pub in_contact: Vec<bool>,
    /// Angle between the inclined springs and the plane of the plate, degrees.
    pub theta_degrees: f64,
    /// Angle of the inclined springs in the plane of the plate, from the x axis, degrees.
    pub phi_degrees: f64,
    /// The inclined springs lean in the direction of sliding.
    pub leans_with_sliding: bool,
}
