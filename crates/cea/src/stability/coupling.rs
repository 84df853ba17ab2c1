//! Coupling of the vibrations of a system with each other, told from the decay of internal states.

use linsys::SecondOrder;
use nalgebra::DMatrix;

use crate::StandardForm;

/// The state matrix `A` of a [`StandardForm`] with its internal states eliminated, in numbers.
///
/// With the states z of A last, -a their diagonal, `A12` and `A21` what couples them with the rest, `A11`, an eigenvalue is one of
///
/// ```text
/// A11 - A12 (lambda + a)^-1 A21  =  [ 0  I ; -K  -C + F (lambda + a)^-1 E ]
/// ```
///
/// In it a state of decay a acts as a dashpot of 1 / a. Eigenvalues that meet in one vector are coupled by no more than its
/// norm, however large a is; a perturbation e of A changes it by at most `e (1 + |A12| / |lambda + a|) (1 + |A21| / |lambda + a|)`.
pub(super) struct Coupling {
    gamma: f64,
    /// Bounds, in units of gamma: of the damping with the states at rest, `|C - F E / a|`; of `|F / a|`; of `|E / a|`.
    numbers: Option<[f64; 3]>,
}

impl Coupling {
    pub(super) fn new(system: &SecondOrder) -> Self {
        let Ok(StandardForm { state, gamma, state_weights }) = StandardForm::new(system) else {
            return Self { gamma: f64::NAN, numbers: None };
        };
        let s = state_weights.len();
        let n = (state.nrows() - s) / 2;
        let decays: Vec<f64> = (2 * n..2 * n + s).map(|k| -state[(k, k)]).collect();
        let by_decay = |k: usize, x: f64| if decays[k] > 0.0 { x / decays[k] } else { f64::INFINITY };
        let forces = DMatrix::from_fn(n, s, |i, k| by_decay(k, state[(n + i, 2 * n + k)]));
        let drives = DMatrix::from_fn(s, n, |k, j| by_decay(k, state[(2 * n + k, n + j)]));
        let drive = state.view((2 * n, n), (s, n));
        let at_rest = state.view((n, n), (n, n)) + &forces * drive;
        let numbers = [at_rest, forces, drives].each_ref().map(norm_bound);
        let [_, force, drive] = numbers;
        // A state that is slower than it is coupled is a part of the vibrations.
        Self { gamma, numbers: (force <= 1.0 && drive <= 1.0).then_some(numbers) }
    }

    /// Coupling for eigenvalues near the imaginary axis at this distance from zero, rad/s: the factor by which the perturbation of the vibrations may exceed
    /// the perturbation of the whole, and a bound of the norm of what couples the vibrations, rad/s. `None` where states are too slow.
    pub(super) fn at(&self, frequency: f64) -> Option<(f64, f64)> {
        let [damping, force, drive] = self.numbers?;
        // The stiffness block has norm 1 at most. At i w a dashpot of 1 / a differs by w / a of itself from its value at rest.
        let size = self.gamma * (1.0 + damping) + frequency * force * drive;
        Some(((1.0 + force) * (1.0 + drive), size))
    }
}

/// A bound of the largest singular value: the root of the largest sums of a column and of a row.
fn norm_bound(a: &DMatrix<f64>) -> f64 {
    let columns = a.column_iter().map(|column| column.lp_norm(1)).fold(0.0, f64::max);
    let rows = a.row_iter().map(|row| row.lp_norm(1)).fold(0.0, f64::max);
    (columns * rows).sqrt()
}
