//! Sparse systems that are affine in a few coefficients, with structural damping (`i eta K` of a term with a loss factor), and their projection.

use linsys::{AffineSystem, Channel, DofMap, LinsysError, OperatingPoint, SecondOrder, Term};
use nalgebra::DMatrix;
use nalgebra_sparse::{CooMatrix, CscMatrix};

use crate::product::times;
use crate::{SparseError, SparseSecondOrder, State};

/// Term `theta (lambda^2 M + lambda C + K)`: a part of a structure that one coefficient scales.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseTerm {
    /// Name of the part.
    pub name: String,
    /// The family to which the work of its damping, and of a stiffness that is not symmetric, belongs.
    pub family: String,
    /// Matrices M, C and K, without internal states and structural damping. A matrix that the term does not have is one of full order without entries.
    pub matrices: SparseSecondOrder,
    /// Loss factor eta of the stiffness, >= 0: `K (1 + i eta)` above the real axis. 0 for most terms.
    pub loss: f64,
}

/// The sparse counterpart of [`linsys::AffineSystem`]: terms, and one friction channel per contact.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseAffineSystem {
    terms: Vec<SparseTerm>,
    channels: Vec<Channel>,
}

impl SparseAffineSystem {
    /// A system of these terms, at least one, and channels.
    ///
    /// # Errors
    /// No term, terms of different order, internal states or structural damping in a term, a loss factor that is negative or not finite, a channel that
    /// acts on or reads a degree of freedom that does not exist.
    pub fn new(terms: Vec<SparseTerm>, channels: Vec<Channel>) -> Result<Self, SparseError> {
        let order = terms.first().map(|term| term.matrices.order()).ok_or(SparseError::Empty)?;
        for term in &terms {
            let (found, states, name) = (term.matrices.order(), term.matrices.states.len(), term.name.clone());
            if found != order {
                return Err(LinsysError::TermOrder { term: name, found, expected: order }.into());
            }
            if states > 0 {
                return Err(LinsysError::TermStates { term: name, states }.into());
            }
            if term.matrices.h.is_some() || !(term.loss.is_finite() && term.loss >= 0.0) {
                return Err(SparseError::Loss { term: name, loss: term.loss });
            }
        }
        channels.iter().try_for_each(|channel| channel.check(order))?;
        Ok(Self { terms, channels })
    }

    /// Number n of free degrees of freedom.
    #[must_use]
    pub fn order(&self) -> usize {
        self.terms.first().map_or(0, |term| term.matrices.order())
    }

    /// The terms of the structure.
    #[must_use]
    pub fn terms(&self) -> &[SparseTerm] {
        &self.terms
    }

    /// True if a term has a loss factor above zero.
    #[must_use]
    pub fn is_structurally_damped(&self) -> bool {
        self.terms.iter().any(|term| term.loss > 0.0)
    }

    /// The friction channels.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The system over the free degrees of freedom. Channels keep the entries of their forces and readings at these.
    ///
    /// # Errors
    /// Another number of degrees of freedom, none that is free.
    pub fn on(&self, dofs: &DofMap) -> Result<Self, SparseError> {
        let (found, expected) = (dofs.total(), self.order());
        if found != expected {
            return Err(LinsysError::Count { what: "degrees of freedom", found, expected }.into());
        }
        let free = |matrix: &CscMatrix<f64>| {
            let mut kept = CooMatrix::new(dofs.free().len(), dofs.free().len());
            for (row, column, &value) in matrix.triplet_iter() {
                if let (Some(row), Some(column)) = (dofs.position(row), dofs.position(column)) {
                    kept.push(row, column, value);
                }
            }
            CscMatrix::from(&kept)
        };
        let term = |term: &SparseTerm| {
            let SparseSecondOrder { m, c, k, .. } = &term.matrices;
            let matrices = SparseSecondOrder::new(free(m), free(c), free(k))?;
            Ok(SparseTerm { matrices, ..term.clone() })
        };
        let entries = |entries: &[(usize, f64)]| {
            entries.iter().filter_map(|&(dof, value)| Some((dofs.position(dof)?, value))).collect()
        };
        let terms = self.terms.iter().map(term).collect::<Result<_, SparseError>>()?;
        Self::new(terms, self.channels.iter().map(|channel| channel.mapped(entries)).collect())
    }

    /// The system at an operating point. The lag of a channel becomes an internal state.
    ///
    /// # Errors
    /// Not one finite coefficient for each term and one finite gain for each channel.
    pub fn assemble(&self, at: &OperatingPoint) -> Result<SparseSecondOrder, SparseError> {
        let channels = self.channels.iter().map(|channel| channel.name.as_str());
        at.check(self.terms.iter().map(|term| term.name.as_str()), channels)?;
        let n = self.order();
        let (mut m, mut c, mut k) = (CooMatrix::new(n, n), CooMatrix::new(n, n), CooMatrix::new(n, n));
        for (term, &theta) in self.terms.iter().zip(&at.coefficients) {
            add_scaled(&mut m, &term.matrices.m, theta);
            add_scaled(&mut c, &term.matrices.c, theta);
            add_scaled(&mut k, &term.matrices.k, theta);
        }
        let mut h = self.is_structurally_damped().then(|| CooMatrix::new(n, n));
        if let Some(h) = &mut h {
            let damped = self.terms.iter().zip(&at.coefficients).filter(|(term, _)| term.loss > 0.0);
            damped.for_each(|(term, &theta)| add_scaled(h, &term.matrices.k, theta * term.loss));
        }
        let mut states = Vec::new();
        for (channel, gain) in self.channels.iter().zip(&at.channels) {
            for &(row, b) in &channel.force {
                channel.reading.iter().for_each(|&(column, r)| k.push(row, column, gain.mu * (b * r)));
                channel.force.iter().for_each(|&(column, other)| c.push(row, column, gain.slope * (b * other)));
            }
            if let Some(lag) = gain.lag {
                // The state is driven by the sliding velocity -b^T u'.
                let scaled = |factor: f64| channel.force.iter().map(|&(dof, b)| (dof, b * factor)).collect();
                states.push(State { decay: lag.decay, drive: scaled(-lag.drive), force: scaled(lag.force) });
            }
        }
        Ok(SparseSecondOrder { m: (&m).into(), c: (&c).into(), k: (&k).into(), h: h.as_ref().map(Into::into), states })
    }

    /// Projection `V^T Q(lambda) V` term by term and channel by channel: the same form, dense, over the columns of the real n x k matrix V, which should be
    /// orthonormal (not checked). A reduced brake is a brake. Loss factors are left out, as the projection is real.
    ///
    /// Both sides have one basis, because a channel `b (mu r^T + lambda s b^T)` stays one only then. A matrix that is exactly
    /// symmetric stays so.
    ///
    /// # Errors
    /// A basis of another number of rows, a projected matrix that is not finite.
    pub fn project(&self, basis: &DMatrix<f64>) -> Result<AffineSystem, SparseError> {
        let (found, expected) = (basis.nrows(), self.order());
        if found != expected {
            return Err(LinsysError::Count { what: "rows of the basis", found, expected }.into());
        }
        let terms = self.terms.iter().map(|term| {
            let SparseSecondOrder { m, c, k, .. } = &term.matrices;
            let reduced = SecondOrder::new(projected(m, basis), projected(c, basis), projected(k, basis))?;
            Term::new(&term.name, &term.family, reduced)
        });
        let terms = terms.collect::<Result<Vec<_>, _>>()?;
        Ok(AffineSystem::new(terms, self.channels.iter().map(|channel| channel.projected(basis)).collect())?)
    }
}

/// `V^T A V`, exactly symmetric where A is. Rows of A that are zero, as nearly all rows of a contact are, take no part.
fn projected(matrix: &CscMatrix<f64>, basis: &DMatrix<f64>) -> DMatrix<f64> {
    let mut is_used = vec![false; matrix.nrows()];
    matrix.triplet_iter().for_each(|(row, _, _)| is_used[row] = true);
    let rows: Vec<usize> = (0..is_used.len()).filter(|&row| is_used[row]).collect();
    let image = times(matrix, basis);
    // nalgebra's `tr_mul` is not blocked; this product is.
    let reduced = match rows.len() == matrix.nrows() {
        true => basis.transpose() * image,
        false => basis.select_rows(&rows).transpose() * image.select_rows(&rows),
    };
    if *matrix == matrix.transpose() { (&reduced + reduced.transpose()) * 0.5 } else { reduced }
}

fn add_scaled(sum: &mut CooMatrix<f64>, matrix: &CscMatrix<f64>, factor: f64) {
    matrix.triplet_iter().for_each(|(row, column, &value)| sum.push(row, column, factor * value));
}

#[cfg(test)]
mod tests {
    use super::*;
    use linsys::{ChannelGain, Lag};
    use nalgebra::dmatrix;
    use num_complex::Complex;

    fn sparse(matrix: &DMatrix<f64>) -> CscMatrix<f64> {
        CscMatrix::from(matrix)
    }

    /// Two terms and a channel with every kind of gain, sparse and dense.
    fn brake() -> (SparseAffineSystem, AffineSystem, OperatingPoint) {
        let zero = || DMatrix::zeros(3, 3);
        let spring = dmatrix![40.0, -9.0, 0.0; -9.0, 70.0, 1.0; 0.0, 1.0, 90.0];
        let structure = [DMatrix::from_diagonal_element(3, 3, 2.0), DMatrix::identity(3, 3) * 0.1, spring];
        let gyroscopic = [zero(), dmatrix![0.0, 1.0, 0.0; -1.0, 0.0, 2.0; 0.0, -2.0, 0.0], zero()];
        let parts = [("structure", structure), ("gyroscopic", gyroscopic)];
        let channel = Channel::new("pad", "friction", vec![(0, 1.0), (2, -0.5)], vec![(1, -5.0)]);
        let of = |(name, [m, c, k]): &(&str, [DMatrix<f64>; 3])| {
            let matrices = SparseSecondOrder::new(sparse(m), sparse(c), sparse(k)).unwrap();
            SparseTerm { name: (*name).into(), family: (*name).into(), matrices, loss: 0.0 }
        };
        let large = SparseAffineSystem::new(parts.iter().map(of).collect(), vec![channel.clone()]).unwrap();
        let terms = parts
            .into_iter()
            .map(|(name, [m, c, k])| Term::new(name, name, SecondOrder::new(m, c, k).unwrap()).unwrap());
        let dense = AffineSystem::new(terms.collect(), vec![channel]).unwrap();
        let lag = Some(Lag { decay: 3.0, drive: 2.0, force: -1.5 });
        let gain = ChannelGain { mu: 0.4, slope: 0.7, lag };
        (large, dense, OperatingPoint { coefficients: vec![1.5, -2.0], channels: vec![gain] })
    }

    #[test]
    fn a_sparse_system_is_the_dense_one() {
        let (large, dense, at) = brake();
        let (sparse, expected) = (large.assemble(&at).unwrap(), dense.assemble(&at).unwrap());
        assert_eq!(DMatrix::from(&sparse.m), expected.m);
        assert!((DMatrix::from(&sparse.c) - &expected.c).norm() < 1e-14);
        assert!((DMatrix::from(&sparse.k) - &expected.k).norm() < 1e-13);
        let state = &sparse.states[0];
        assert_eq!(state.decay, expected.internal.decay[0]);
        state.drive.iter().for_each(|&(dof, value)| assert_eq!(expected.internal.drive[(0, dof)], value));
        state.force.iter().for_each(|&(dof, value)| assert_eq!(expected.internal.force[(dof, 0)], value));
    }

    #[test]
    fn projection_and_assembly_commute() {
        let (large, dense, at) = brake();
        let basis = dmatrix![0.6, 0.0; 0.8, 0.0; 0.0, 1.0];
        let lambda = Complex::new(-0.3, 4.0);
        let reduced = large.project(&basis).unwrap();
        let wide = basis.map(Complex::from);
        let expected = wide.tr_mul(&(dense.assemble(&at).unwrap().dynamic_stiffness(lambda) * &wide));
        assert!((reduced.assemble(&at).unwrap().dynamic_stiffness(lambda) - expected).norm() < 1e-12);
        assert!(reduced.terms()[0].is_elastic());
    }

    #[test]
    fn points_and_bases_of_other_systems_are_refused() {
        let (large, _, mut at) = brake();
        assert!(large.project(&DMatrix::zeros(4, 2)).is_err());
        at.channels.clear();
        assert!(large.assemble(&at).is_err());
    }
}
