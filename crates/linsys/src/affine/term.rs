//! A term of a structure.

use std::ops::Range;

use nalgebra::DVector;
use num_complex::Complex;

use crate::{LinsysError, SecondOrder, real_times_complex};

/// `theta (lambda^2 M + lambda C + K)`: a part of a structure that one coefficient scales.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Name of the part.
    pub name: String,
    /// The family to which the work of its damping, and of a stiffness that is not symmetric, belongs.
    pub family: String,
    matrices: SecondOrder,
    is_elastic: bool,
    /// Flags of M, C, K, true if the matrix has an entry that is not zero.
    is_there: [bool; 3],
}

impl Term {
    /// A term with these matrices, which have no internal states.
    ///
    /// # Errors
    /// Those of [`SecondOrder::check`]; internal states.
    pub fn new(name: impl Into<String>, family: impl Into<String>, matrices: SecondOrder) -> Result<Self, LinsysError> {
        matrices.check()?;
        let (name, family, states) = (name.into(), family.into(), matrices.states());
        if states > 0 {
            return Err(LinsysError::TermStates { term: name, states });
        }
        let is_elastic = matrices.k == matrices.k.transpose();
        let is_there = [&matrices.m, &matrices.c, &matrices.k].map(|matrix| matrix.iter().any(|&entry| entry != 0.0));
        Ok(Self { name, family, matrices, is_elastic, is_there })
    }

    /// Matrices M, C and K of the term.
    pub fn matrices(&self) -> &SecondOrder {
        &self.matrices
    }

    /// Adds `coefficient` times the `entries`, numbered column by column, of M, C and K, as far as these are not zero.
    pub(super) fn add(&self, coefficient: f64, entries: Range<usize>, out: &mut SecondOrder) {
        let SecondOrder { m, c, k, .. } = &self.matrices;
        let parts = [(&mut out.m, m), (&mut out.c, c), (&mut out.k, k)];
        for ((sum, matrix), _) in parts.into_iter().zip(self.is_there).filter(|(_, is_there)| *is_there) {
            let (sum, matrix) = (&mut sum.as_mut_slice()[entries.clone()], &matrix.as_slice()[entries.clone()]);
            sum.iter_mut().zip(matrix).for_each(|(sum, value)| *sum += coefficient * value);
        }
    }

    /// Adds `-coefficient (lambda C + K) phi`, of K only what is not elastic.
    pub(super) fn add_forces(
        &self,
        coefficient: f64,
        lambda: Complex<f64>,
        phi: &DVector<Complex<f64>>,
        out: &mut DVector<Complex<f64>>,
    ) {
        let SecondOrder { c, k, .. } = &self.matrices;
        let [_, has_damping, has_stiffness] = self.is_there;
        if has_damping {
            out.axpy(-lambda * coefficient, &real_times_complex(c, phi), Complex::from(1.0));
        }
        if has_stiffness && !self.is_elastic {
            out.axpy(Complex::from(-coefficient), &real_times_complex(k, phi), Complex::from(1.0));
        }
    }

    /// n, the number of degrees of freedom.
    pub fn order(&self) -> usize {
        self.matrices.order()
    }

    /// True if K is symmetric, so that its forces do no net work in a mode.
    pub fn is_elastic(&self) -> bool {
        self.is_elastic
    }
}
