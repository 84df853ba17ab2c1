//! Unstructured grids of VTK (`.vtu`), which ParaView and meshio read: text, with every digit.

use std::fmt::Write as _;
use std::io::{self, Write};

use num_complex::Complex;

use crate::FormatsError;
use crate::mesh::MeshField;
use crate::mesh::{CellKind, Mesh, ModeShape, check};

impl CellKind {
    /// Number of the cell type in VTK.
    fn vtk(self) -> u8 {
        match self {
            Self::Vertex => 1,
            Self::Line => 3,
            Self::Triangle => 5,
            Self::Quadrilateral => 9,
            Self::Tetrahedron => 10,
            Self::Hexahedron => 12,
        }
    }
}

/// Writes a mesh and modes on it. Each mode has three vectors at the points: `NAME real`, `NAME imaginary`, and `NAME amplitude`,
/// the moduli of the three components. The displacement at phase p is `real cos p - imaginary sin p`. The array `node` has the
/// numbers of the nodes; the field data `lambda` have real and imaginary part of each eigenvalue, 1/s.
///
/// # Errors
/// [`FormatsError::Shape`] for what cannot be written, such as two modes of one name, and [`FormatsError::Write`].
pub fn write_vtu(out: &mut dyn Write, mesh: &Mesh, shapes: &[ModeShape]) -> Result<(), FormatsError> {
    check(mesh, shapes)?;
    let mut names = std::collections::HashSet::new();
    if let Some(shape) = shapes.iter().find(|shape| !names.insert(&shape.name)) {
        let (what, allowed) = ("two shapes have the name", "a name for each".to_owned());
        return Err(FormatsError::Shape { what, found: crate::shortened::cut(&shape.name), allowed });
    }
    let of_shapes = |out: &mut dyn Write| shapes.iter().try_for_each(|shape| write_shape(out, shape));
    write_all(out, mesh, shapes, &of_shapes).map_err(FormatsError::Write)
}

/// Writes a mesh with numbers and vectors at its nodes, and the array `node` with their numbers.
///
/// # Errors
/// [`FormatsError::Shape`] for what cannot be written, such as not a number for each node, and [`FormatsError::Write`].
pub fn write_fields_vtu(out: &mut dyn Write, mesh: &Mesh, fields: &[MeshField]) -> Result<(), FormatsError> {
    check(mesh, &[])?;
    fields.iter().try_for_each(|field| field.check(mesh))?;
    let mut names = std::collections::HashSet::from([NODE]);
    if let Some(field) = fields.iter().find(|field| !names.insert(field.name.as_str())) {
        let (what, allowed) =
            ("two fields, or a field and the numbers of the nodes, have the name", "a name for each".to_owned());
        return Err(FormatsError::Shape { what, found: crate::shortened::cut(&field.name), allowed });
    }
    let of_field = |out: &mut dyn Write, MeshField { name, values }: &MeshField| match values.as_slice() {
        [x] => array(out, "Float64", name, "", x.iter().map(|&x| reals([x]))),
        [x, y, z] => {
            let rows = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| reals([x, y, z]));
            array(out, "Float64", name, VECTOR, rows)
        }
        // `MeshField::check` has refused them.
        _ => Ok(()),
    };
    let of_fields = |out: &mut dyn Write| fields.iter().try_for_each(|field| of_field(out, field));
    write_all(out, mesh, &[], &of_fields).map_err(FormatsError::Write)
}

/// Writes the three vectors of a mode.
fn write_shape(out: &mut dyn Write, shape: &ModeShape) -> io::Result<()> {
    let mut part = |what: &str, of: fn(Complex<f64>) -> f64| {
        let rows = shape.displacements.iter().map(|u| reals(u.map(of)));
        array(out, "Float64", &format!("{} {what}", shape.name), VECTOR, rows)
    };
    part("real", |z| z.re)?;
    part("imaginary", |z| z.im)?;
    part("amplitude", |z| z.norm())
}

fn write_all(
    out: &mut dyn Write,
    mesh: &Mesh,
    shapes: &[ModeShape],
    point_data: &dyn Fn(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let (points, cells) = (mesh.nodes.len(), mesh.cells.len());
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>"
    )?;
    if !shapes.is_empty() {
        writeln!(out, "<FieldData>")?;
        let shape = format!("NumberOfTuples=\"{}\" NumberOfComponents=\"2\"", shapes.len());
        array(out, "Float64", "lambda", &shape, shapes.iter().map(|shape| reals([shape.lambda.re, shape.lambda.im])))?;
        writeln!(out, "</FieldData>")?;
    }
    writeln!(out, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<PointData>")?;
    array(out, "Int64", NODE, "", mesh.nodes.iter().map(|node| node.label.to_string()))?;
    point_data(out)?;
    writeln!(out, "</PointData>\n<Points>")?;
    array(out, "Float64", "Points", VECTOR, mesh.nodes.iter().map(|node| reals(node.position)))?;
    writeln!(out, "</Points>\n<Cells>")?;
    let list = |nodes: &Vec<usize>| nodes.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    array(out, "Int64", "connectivity", "", mesh.cells.iter().map(|cell| list(&cell.nodes)))?;
    let mut offset = 0;
    let offsets = mesh.cells.iter().map(|cell| {
        offset += cell.nodes.len();
        offset.to_string()
    });
    array(out, "Int64", "offsets", "", offsets)?;
    array(out, "UInt8", "types", "", mesh.cells.iter().map(|cell| cell.kind.vtk().to_string()))?;
    writeln!(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}

/// Name of the array of the numbers of the nodes.
const NODE: &str = "node";
/// Attribute of an array of vectors.
const VECTOR: &str = "NumberOfComponents=\"3\"";

fn array(
    out: &mut dyn Write,
    kind: &str,
    name: &str,
    shape: &str,
    rows: impl Iterator<Item = String>,
) -> io::Result<()> {
    let name = name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    let gap = if shape.is_empty() { "" } else { " " };
    writeln!(out, "<DataArray type=\"{kind}\" Name=\"{name}\"{gap}{shape} format=\"ascii\">")?;
    for row in rows {
        writeln!(out, "{row}")?;
    }
    writeln!(out, "</DataArray>")
}

/// Numbers that read back to the same bits.
fn reals<const N: usize>(values: [f64; N]) -> String {
    let mut text = String::new();
    for (at, value) in values.into_iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(text, "{}{value:e}", if at == 0 { "" } else { " " });
    }
    text
}
