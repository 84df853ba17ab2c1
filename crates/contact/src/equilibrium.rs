//! Static equilibrium: states and forces of the contact points.
//!
//! `0 <= N, 0 <= gap opened, N gap = 0` with friction mu N in the balance is a linear complementarity problem in the opening of each point's spring,
//! `N = k (opened - gap)`. Scaled by roots of k it reads
//!
//! ```text
//! w = q + M z,   w = k^(-1/2) N,   z = k^(1/2) opened,   M = (I + B')^-1 (I - A'),   q = -(I + B')^-1 (I - A') h' - (I + B')^-1 a'
//! ```
//!
//! with A' = k^(1/2) A k^(1/2), B' = k^(1/2) B mu k^(1/2), h' and a' of the gaps and the loads. Without friction M is symmetric and not
//! indefinite, so that forces are unique; with friction it need not be.

use nalgebra::{DMatrix, DVector};

use crate::complementarity::{Complementary, Unsolved, active_set, all_solutions, lemke};
use crate::sliding::value;
use crate::uniqueness::{Uniqueness, has_none, is_monotone, uniqueness};
use crate::{Condensed, ContactError};

/// A pivot of `I + B'` below this part of the largest locks; chosen.
const LOCKED: f64 = 1e-12;

/// Balance of forces that is asked for: gaps before the loads, friction and how much of each load acts.
#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    /// The gap of each point before the loads, negative where meshes overlap; 0 where that is no matter.
    pub gaps: Vec<f64>,
    /// The coefficient of friction of each point, of the sign of the sliding.
    pub mu: Vec<f64>,
    /// Factors of the loads, one of each.
    pub loads: Vec<f64>,
}

/// Static equilibrium of all contact points.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Normal force N of each point, N: 0 where it is open.
    pub forces: Vec<f64>,
    /// The gap of each point: 0 or more where it is open, `- N / k` where it is closed.
    pub gaps: Vec<f64>,
    /// Uniqueness of these forces, and how it is known.
    pub uniqueness: Uniqueness,
}

impl Equilibrium {
    /// Flags of the points, one of each: true where it is closed, that is, presses with a force.
    #[must_use]
    pub fn closed(&self) -> Vec<bool> {
        self.forces.iter().map(|force| *force > 0.0).collect()
    }
}

impl Condensed {
    /// The equilibrium of springs that press and do not pull, each with the stiffness that it was condensed with.
    ///
    /// # Errors
    /// Lists of other lengths, numbers that are not finite; no equilibrium, which is proven without friction, and where all states can be
    /// enumerated; friction that locks; a search that did not end.
    pub fn equilibrium(&self, balance: &Balance) -> Result<Equilibrium, ContactError> {
        let (q, m) = self.problem(balance)?;
        let found = match active_set(&q, &m).map_or_else(|| lemke(&q, &m), Ok) {
            Ok(found) => found,
            Err(unsolved) => otherwise(&q, &m, unsolved)?,
        };
        let root = self.stiffness.map(f64::sqrt);
        let forces = root.component_mul(&found.w);
        let gaps = found.z.component_div(&root) - forces.component_div(&self.stiffness);
        Ok(Equilibrium {
            forces: forces.as_slice().to_vec(),
            gaps: gaps.as_slice().to_vec(),
            uniqueness: uniqueness(&q, &m),
        })
    }

    /// Vector q and matrix M of the complementarity problem of a balance.
    fn problem(&self, balance: &Balance) -> Result<(DVector<f64>, DMatrix<f64>), ContactError> {
        self.check(balance)?;
        let n = self.points();
        let root = self.stiffness.map(f64::sqrt);
        let scaled = |a: &DMatrix<f64>, mu: Option<&[f64]>| {
            DMatrix::from_fn(n, n, |i, j| root[i] * a[(i, j)] * root[j] * mu.map_or(1.0, |mu| mu[j]))
        };
        let free = DMatrix::identity(n, n) - scaled(&self.normal, None);
        let held = &free * root.component_mul(&DVector::from_column_slice(&balance.gaps))
            + root.component_mul(&(&self.loads * DVector::from_column_slice(&balance.loads)));
        if balance.mu.iter().all(|mu| *mu == 0.0) {
            // Symmetric exactly.
            return Ok((-held, (&free + free.transpose()) * 0.5));
        }
        let locking = DMatrix::identity(n, n) + scaled(&self.friction, Some(&balance.mu));
        let factors = locking.clone().lu();
        let u = factors.u();
        let pivots = u.diagonal().map(f64::abs);
        if pivots.min() <= LOCKED * pivots.max() {
            return Err(ContactError::Locks);
        }
        let (q, m) = (factors.solve(&-held), factors.solve(&free));
        q.zip(m).ok_or(ContactError::Locks)
    }

    pub(crate) fn check(&self, balance: &Balance) -> Result<(), ContactError> {
        let lists = [
            ("gaps", &balance.gaps, self.points()),
            ("coefficients of friction", &balance.mu, self.points()),
            ("factors of loads", &balance.loads, self.load_cases()),
        ];
        for (what, list, expected) in lists {
            if list.len() != expected {
                return Err(ContactError::Count { what, found: list.len(), expected });
            }
            if let Some(&x) = list.iter().find(|x| !x.is_finite()) {
                return Err(value("a number of a balance", x, "finite numbers"));
            }
        }
        Ok(())
    }
}

/// The solution, or the reason why there is none, where Lemke's method found nothing.
fn otherwise(q: &DVector<f64>, m: &DMatrix<f64>, unsolved: Unsolved) -> Result<Complementary, ContactError> {
    if unsolved == Unsolved::Ray && is_monotone(m) {
        let reason = "the loads pull the bodies off what holds them, or push one that nothing holds";
        return Err(ContactError::NoEquilibrium { reason });
    }
    match has_none(q, m) {
        Some(true) => {
            Err(ContactError::NoEquilibrium { reason: "of all states of open and closed contacts none is in balance" })
        }
        Some(false) => all_solutions(q, m).into_iter().next().ok_or(ContactError::Locks),
        None if unsolved == Unsolved::Ray => {
            let reason = "the search for one ends in a ray; with friction this is no proof that there is none";
            Err(ContactError::NoEquilibrium { reason })
        }
        None => Err(ContactError::NotSolved { unknowns: q.len() }),
    }
}
