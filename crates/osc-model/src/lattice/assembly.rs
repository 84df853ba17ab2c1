//! M, C and K of the lattice without friction, over all degrees of freedom.

use linsys::SecondOrder;
use nalgebra::{DMatrix, Vector3};

use super::{Axis, ContactArrangement, LatticeParameters};

/// Index of a degree of freedom; the plate is the body after the last oscillator.
pub(crate) fn dof(body: usize, axis: Axis) -> usize {
    3 * body + axis as usize
}

/// The unconstrained structure; `p` must have passed [`LatticeParameters::check`].
pub(crate) fn assemble(p: &LatticeParameters, arrangement: &ContactArrangement) -> SecondOrder {
    let (rows, columns, plate) = (p.grid.rows(), p.grid.columns(), p.grid.oscillators());
    let mut s = SecondOrder::zeros(3 * (plate + 1), 0);

    for row in 0..rows {
        let bodies = |place: usize| dof(row * columns + place, Axis::X);
        let part = row * (columns + 1)..(row + 1) * (columns + 1);
        add_chain(&mut s.k, &p.x_stiffness[part.clone()], bodies);
        add_chain(&mut s.c, &p.x_damping[part], bodies);
    }
    for column in 0..columns {
        let bodies = |place: usize| dof(place * columns + column, Axis::Y);
        let part = column * (rows + 1)..(column + 1) * (rows + 1);
        add_chain(&mut s.k, &p.y_stiffness[part.clone()], bodies);
        add_chain(&mut s.c, &p.y_damping[part], bodies);
    }

    let direction =
        Vector3::new(p.lean.sign() * p.theta.cos() * p.phi.cos(), p.theta.cos() * p.phi.sin(), p.theta.sin());
    for body in 0..plate {
        s.c[(dof(body, Axis::Z), dof(body, Axis::Z))] += p.z_damping[body];
        let mut block = s.k.fixed_view_mut::<3, 3>(3 * body, 3 * body);
        block += p.inclined_stiffness[body] * direction * direction.transpose();
        for axis in Axis::ALL {
            s.m[(dof(body, axis), dof(body, axis))] = p.oscillator_mass[body];
        }
    }
    for axis in Axis::ALL {
        let i = dof(plate, axis);
        s.m[(i, i)] = p.plate.mass;
        s.c[(i, i)] += p.plate.damping[axis as usize];
        s.k[(i, i)] += p.plate.stiffness[axis as usize];
    }
    for &body in arrangement.in_contact() {
        add_spring(&mut s.k, dof(body, Axis::Z), dof(plate, Axis::Z), p.contact_stiffness[body]);
    }
    s
}

/// Adds a chain from wall to wall; `values` has one entry more than there are bodies.
fn add_chain(matrix: &mut DMatrix<f64>, values: &[f64], body: impl Fn(usize) -> usize) {
    let last = values.len() - 1;
    for (place, &value) in values.iter().enumerate() {
        if place > 0 && place < last {
            add_spring(matrix, body(place - 1), body(place), value);
        } else {
            let only = body(place.saturating_sub(1));
            matrix[(only, only)] += value;
        }
    }
}

fn add_spring(matrix: &mut DMatrix<f64>, i: usize, j: usize, value: f64) {
    matrix[(i, i)] += value;
    matrix[(j, j)] += value;
    matrix[(i, j)] -= value;
    matrix[(j, i)] -= value;
}
