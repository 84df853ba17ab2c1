//! Modifiable parts of a finite element brake: its patches, and the node sets to which something can be attached.

use formats::Dof;
use nalgebra::{DMatrix, DVector};
use study::{Direction, Moves, OwnSize, Place, Scene, WholeContact};

use super::FiniteElementBrake;
use super::points::{all_patches, naming_point, of_brake};
use crate::Error;

/// The closed patches of a scene, each with the friction of its pairs of nodes, along the sliding and across it, and with their springs.
pub(super) fn contacts(brake: &FiniteElementBrake, scene: &Scene) -> Vec<WholeContact> {
    let Some(contact) = &brake.case.contact else { return Vec::new() };
    let terms = brake.part(scene).reduced.system().terms();
    let (first, mut channel) = (terms.len() - contact.patches.len(), 0);
    let whole = |&number: &usize| {
        let patch = &contact.patches[number];
        let channels = (channel..channel + patch.channels.len()).collect();
        channel += patch.channels.len();
        // A stiffness that is drawn is not the same in every sample.
        let structure = (!contact.has_drawn_stiffness()).then(|| terms[first + number].matrices().clone());
        WholeContact { number, name: patch.name.clone(), channels, structure }
    };
    brake.closed(scene).iter().map(whole).collect()
}

/// The node sets of the mesh in x, y and z, as far as they are free; what is attached is shared equally by the nodes. Sets with
/// contact nodes of the disc are left out, because the disc turns.
///
/// A direction's own mass and stiffness are what the reduced brake without friction has there: `1 / (p^T A^-1 p)` with the mean motion p of the nodes and M
/// or K for A; for K it is the static stiffness. NaN where the matrix is singular.
///
/// # Errors
/// [`Error::SeveralBases`] where configurations have different bases.
pub(super) fn places(brake: &FiniteElementBrake, constraints: usize) -> Result<Vec<Place>, Error> {
    let (case, set, part) = (&brake.case, &brake.sets[constraints], brake.of_origins[constraints]);
    let is_other =
        |scene: &Scene| scene.key.constraints == constraints && brake.of_configurations[scene.configuration] != part;
    if brake.plan.scenes.iter().any(is_other) {
        return Err(Error::SeveralBases { study: brake.plan.source() });
    }
    let reduced = &brake.parts[part].reduced;
    let all = all_patches(case);
    let at = of_brake(case, &all, &naming_point(case, &all)?);
    let structure = reduced.system().structure(&at.coefficients)?;
    let (mass, stiffness) = (structure.m.lu(), structure.k.lu());
    let disc: Vec<i64> =
        case.contact.iter().flat_map(|c| &c.patches).flat_map(|p| &p.pairs).map(|pair| pair[1]).collect();
    let own = |matrix: &nalgebra::LU<f64, nalgebra::Dyn, nalgebra::Dyn>, p: &DVector<f64>| {
        matrix.solve(p).map_or(f64::NAN, |x| 1.0 / p.dot(&x))
    };
    let direction = |name: &str, nodes: &[i64], direction: u32| {
        let is_meant = |dof: &Dof| dof.direction == direction && nodes.binary_search(&dof.node).is_ok();
        let rows = (0..case.dofs.len()).filter(|&row| is_meant(&case.dofs[row]));
        let rows: Vec<usize> = rows.filter_map(|row| set.dofs.position(row)).collect();
        let of_rows = set.basis.select_rows(&rows) * &brake.parts[part].within.basis;
        let letter = Dof { node: 0, direction }.to_string().split_off(2);
        (!rows.is_empty()).then(|| {
            let mean = of_rows.row_mean().transpose();
            Direction {
                name: format!("{name}.{letter}"),
                dof: None,
                parts: parts(&of_rows),
                own: OwnSize { mass: own(&mass, &mean), stiffness: own(&stiffness, &mean) },
                moves: Moves::Along,
            }
        })
    };
    let place = |(name, nodes): (&String, &Vec<i64>)| {
        let mut nodes = nodes.clone();
        nodes.sort_unstable();
        let directions: Vec<Direction> = (1..=3).filter_map(|axis| direction(name, &nodes, axis)).collect();
        let turns = disc.iter().any(|node| nodes.binary_search(node).is_ok());
        (!turns && !directions.is_empty()).then(|| Place { name: name.clone(), directions })
    };
    Ok(case.node_sets.iter().filter_map(place).collect())
}

/// The rows of the basis, each divided by the root of their number: what is attached is shared by as many nodes.
fn parts(of_rows: &DMatrix<f64>) -> Vec<Vec<(usize, f64)>> {
    let share = 1.0 / (of_rows.nrows() as f64).sqrt();
    of_rows.row_iter().map(|row| row.iter().map(|value| value * share).enumerate().collect()).collect()
}
