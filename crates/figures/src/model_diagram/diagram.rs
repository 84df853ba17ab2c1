//! What a drawing of the model shows.

/// What the drawing shows of a lattice.
#[derive(Debug, Clone, Default)]
pub struct ModelDiagram {
    /// Above everything; may be empty.
    pub title: String,
    /// Rows of the lattice.
    pub rows: usize,
    /// Columns of the lattice.
    pub columns: usize,
    /// By rows: whether the oscillator touches the plate.
    pub in_contact: Vec<bool>,
    /// Angle between the inclined springs and the plane of the plate, degrees.
    pub theta_degrees: f64,
    /// Angle of the inclined springs in that plane, from the x axis, degrees.
    pub phi_degrees: f64,
    /// Whether the inclined springs lean in the direction of sliding.
    pub leans_with_sliding: bool,
}
