//! Static equilibrium: states and forces of the contact points.
//!
//! Each point has a spring of stiffness k that presses and does not pull. With the normal force N and the opening o, the distance by which
//! the spring is off, `N = k (o - gap)`: a closed point has `o = 0` and `N = - k gap`, an open one `N = 0` and `o = gap`. So
//! `0 <= N, 0 <= o, N o = 0`, which with friction mu N in the balance is a linear complementarity problem. [`Condensed`] has the balance,
//! `gap = h + a - A k h + A (N + k gap) + B mu N`, with gaps h before the loads and `a = G^T K_s^-1 f` of the loads f; in it `gap = o - N / k`
//! and `N + k gap = k o`. Scaled by the roots of k, diagonal matrices k and mu, it reads
//!
//! ```text
//! w = q + M z,   w = k^(-1/2) N,   z = k^(1/2) o,   M = (I + B')^-1 (I - A'),   q = -(I + B')^-1 ((I - A') h' + a')
//! A' = k^(1/2) A k^(1/2),   B' = k^(1/2) B mu k^(1/2),   h' = k^(1/2) h,   a' = k^(1/2) a
//! ```
//!
//! w and z, in N^(1/2) m^(1/2), and all matrices have a row for each point. Without friction M is symmetric and positive semi-definite, so
//! that forces are unique; with friction it need not be.

use nalgebra::{DMatrix, DVector};

use crate::complementarity::{Complementary, Unsolved, active_set, all_solutions, lemke};
use crate::sliding::value;
use crate::uniqueness::{Uniqueness, is_monotone, uniqueness};
use crate::{Condensed, ContactError};

/// Largest ratio of the smallest to the largest pivot of the LU decomposition of `I + B'` with which this is singular: friction locks (jams), as the balance
/// then does not determine N; chosen.
const LOCKED: f64 = 1e-12;

/// Balance of forces that is asked for: gaps before the loads, friction and how much of each load acts.
#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    /// Gap h of each point before the loads, in the model's unit of length, negative where meshes overlap; 0 if initial gaps are neglected.
    pub gaps: Vec<f64>,
    /// Coefficient of friction mu of each point, 1; negative where the master slides against the direction of the point's slip row.
    pub mu: Vec<f64>,
    /// Factor of each load case that the structure was condensed with, 1.
    pub loads: Vec<f64>,
}

/// Static equilibrium of all contact points.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Normal force N of each point, N: 0 where it is open.
    pub forces: Vec<f64>,
    /// Gap of each point, in the model's unit of length: 0 or more where it is open, `- N / k` where it is closed.
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

    /// Vector q and matrix M of the complementarity problem of a balance, by points. In the code `free` is `I - A'`, `held` `(I - A') h' + a'`, and
    /// `locking` `I + B'`.
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
            // B' = 0; M is made symmetric to the last bit.
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

    /// Checks that the lists of a balance have the right lengths and finite numbers.
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

/// The solution, or the reason why there is no solution, where Lemke's method found nothing. Of several solutions it is an arbitrary one,
/// the first of [`all_solutions`]; [`Equilibrium::uniqueness`] says that there are several.
fn otherwise(q: &DVector<f64>, m: &DMatrix<f64>, unsolved: Unsolved) -> Result<Complementary, ContactError> {
    if unsolved == Unsolved::Ray && is_monotone(m) {
        let reason = "the loads pull the bodies off what holds them, or push one that nothing holds";
        return Err(ContactError::NoEquilibrium { reason });
    }
    match all_solutions(q, m) {
        Ok(all) => all.into_iter().next().ok_or(ContactError::NoEquilibrium {
            reason: "of all states of open and closed contacts none is in balance",
        }),
        Err(_) if unsolved == Unsolved::Ray => {
            let reason = "the search for one ends in a ray; with friction this is no proof that there is none";
            Err(ContactError::NoEquilibrium { reason })
        }
        Err(_) => Err(ContactError::NotSolved { unknowns: q.len() }),
    }
}
