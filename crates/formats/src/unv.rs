//! Universal files (`.unv`, `.uff`) of SDRC, which programs for test and analysis read: units (dataset 164), nodes (2411), trace
//! lines along the edges of cells (82) and complex mode shapes (55).
//!
//! Layouts: Structural Dynamics Research Laboratory, University of Cincinnati, <https://www.ceas3.uc.edu/sdrluff/>.

use std::collections::BTreeSet;
use std::io::{self, Write};

use num_complex::Complex;

use crate::FormatsError;
use crate::mesh::{Mesh, ModeShape, check};

/// Most nodes of a trace line, by the description of dataset 82.
const LONGEST_TRACE: usize = 250;
/// Magnitudes below are written as 0: a third digit of the exponent would fill the 13 characters and join two numbers.
const SMALLEST: f64 = 1e-99;

/// Writes a mesh and modes on it as datasets 164, 2411, 82 and one 55 a mode.
///
/// Numbers of shapes have 6 digits, as dataset 55 is defined; scale each to a largest displacement of 1 to see them well. A mode is
/// written as a complex eigenvalue of first order (analysis type 3): displacements, with lambda in 1/s beside them, so that the
/// frequency is `Im lambda / 2 pi`. Units are SI.
///
/// # Errors
/// [`FormatsError::Shape`] for what cannot be written, such as a node whose number is not 1 to 2147483647, and
/// [`FormatsError::Write`].
pub fn write_unv(out: &mut dyn Write, mesh: &Mesh, shapes: &[ModeShape]) -> Result<(), FormatsError> {
    check(mesh, shapes)?;
    if let Some(node) = mesh.nodes.iter().find(|node| i32::try_from(node.label).is_err() || node.label < 1) {
        let (found, allowed) = (node.label.to_string(), "1 to 2147483647".to_owned());
        return Err(FormatsError::Shape { what: "the number of a node is", found, allowed });
    }
    let largest = shapes.iter().flat_map(|shape| shape.displacements.iter().flatten().chain([&shape.lambda]));
    if let Some(z) = largest.into_iter().find(|z| z.re.abs() >= 1.0 / SMALLEST || z.im.abs() >= 1.0 / SMALLEST) {
        let (what, allowed) = ("a number of a shape is", format!("below {:e}", 1.0 / SMALLEST));
        return Err(FormatsError::Shape { what, found: z.to_string(), allowed });
    }
    write_all(out, mesh, shapes).map_err(FormatsError::Write)
}

fn write_all(out: &mut dyn Write, mesh: &Mesh, shapes: &[ModeShape]) -> io::Result<()> {
    begin(out, 164)?;
    writeln!(out, "{:10}{:>20}{:10}", 1, "SI: Meter (newton)", 2)?;
    let unit = fortran(1.0, 25, 17);
    writeln!(out, "{unit}{unit}{unit}\n{}", fortran(273.15, 25, 17))?;
    end(out)?;
    begin(out, 2411)?;
    for node in &mesh.nodes {
        let [x, y, z] = node.position.map(|x| fortran(x, 25, 16));
        writeln!(out, "{:10}{:10}{:10}{:10}\n{x}{y}{z}", node.label, 1, 1, 11)?;
    }
    end(out)?;
    for (number, trace) in traces(mesh).iter().enumerate() {
        begin(out, 82)?;
        writeln!(out, "{:10}{:10}{:10}\nedges", number + 1, trace.len(), 8)?;
        for line in trace.chunks(8) {
            writeln!(out, "{}", line.iter().map(|label| format!("{label:10}")).collect::<String>())?;
        }
        end(out)?;
    }
    for (number, shape) in shapes.iter().enumerate() {
        begin(out, 55)?;
        let hertz = shape.lambda.im / std::f64::consts::TAU;
        let name: String = shape.name.chars().take(80).collect();
        let name = if name.trim().is_empty() { "NONE" } else { &name };
        writeln!(out, "{name}\nNONE\nNONE\nNONE\nMODE {} FREQUENCY {hertz:.6E} HZ", number + 1)?;
        // Structural, complex eigenvalue of first order, 3 translations, displacement, complex, 3 values a node.
        writeln!(out, "{:10}{:10}{:10}{:10}{:10}{:10}", 1, 3, 2, 8, 5, 3)?;
        // Two whole numbers (load case, mode) and six real ones (lambda, modal A, modal B; the last two unknown).
        writeln!(out, "{:10}{:10}{:10}{:10}", 2, 6, 1, number + 1)?;
        writeln!(out, "{}", numbers(&[shape.lambda, Complex::default(), Complex::default()]))?;
        for (node, displacement) in mesh.nodes.iter().zip(&shape.displacements) {
            writeln!(out, "{:10}\n{}", node.label, numbers(displacement))?;
        }
        end(out)?;
    }
    Ok(())
}

fn begin(out: &mut dyn Write, number: u32) -> io::Result<()> {
    writeln!(out, "{:6}\n{number:6}", -1)
}

fn end(out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{:6}", -1)
}

fn numbers(values: &[Complex<f64>]) -> String {
    values.iter().flat_map(|z| [z.re, z.im]).map(|x| fortran(x, 13, 5)).collect()
}

/// A number as Fortran's `1PEw.d` prints it.
fn fortran(x: f64, width: usize, digits: usize) -> String {
    let x = if x.abs() < SMALLEST { 0.0 } else { x };
    let text = format!("{x:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, exponent) = exponent.strip_prefix('-').map_or(('+', exponent), |exponent| ('-', exponent));
    format!("{:>width$}", format!("{mantissa}E{sign}{exponent:0>2}"))
}

/// Every edge once, as labels to draw to, with 0 before a label to move to.
fn traces(mesh: &Mesh) -> Vec<Vec<i64>> {
    let edges: BTreeSet<(i64, i64)> = mesh
        .cells
        .iter()
        .flat_map(|cell| {
            let label = |at: usize| mesh.nodes[cell.nodes[at]].label;
            cell.kind.edges().iter().map(move |&(a, b)| (label(a).min(label(b)), label(a).max(label(b))))
        })
        .collect();
    let mut traces: Vec<Vec<i64>> = Vec::new();
    for (a, b) in edges {
        match traces.last_mut() {
            Some(trace) if trace.len() + 3 <= LONGEST_TRACE => {
                if trace.last() != Some(&a) {
                    trace.extend([0, a]);
                }
                trace.push(b);
            }
            _ => traces.push(vec![a, b]),
        }
    }
    traces
}
