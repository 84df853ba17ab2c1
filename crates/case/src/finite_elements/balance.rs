//! Static equilibrium of the contacts of a case, solved anew where what it depends on differs.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use contact::{Balance, Condensed, ContactError, Equilibrium, Row, Stiffness, Uniqueness};
use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::CscMatrix;
use study::identity::Written;

use crate::Expression;

/// Most condensed structures that are kept for what asks for the same again, such as other scenes of a sample; chosen: each takes some megabytes.
const STRUCTURES: usize = 8;
/// Most states of equilibrium that are kept likewise; chosen: they are smaller.
const STATES: usize = 64;
/// Largest force that is rounding, as a fraction of the loads; chosen: an equilibrium has some twelve digits, and its smallest forces that count are far
/// larger.
const ROUNDING: f64 = 1e-10;

/// Contact points, loads and springs of contacts in static equilibrium.
#[derive(Debug)]
pub struct ContactBalance {
    /// Entries (degree of freedom, factor) of `g^T` of each point, contact by contact: its gap is `g^T u`.
    pub(super) gaps: Vec<Row>,
    /// Row of the slip of each point.
    pub(super) slips: Vec<Row>,
    /// Area of each point, m^2.
    pub(super) areas: Vec<f64>,
    /// Nominal stiffness k_0 of each point, N/m, by which its friction channel turns the gap into a normal force; of a power law the tangent stiffness at the mean pressure of the medians.
    pub(super) springs: Vec<f64>,
    /// Law `p = c g^m` of all points; `None` where their stiffness is constant.
    pub(super) law: Option<Stiffness>,
    /// Loads over all rows, a column for each of `[[forces]]`, N.
    pub(super) loads: DMatrix<f64>,
    /// Name and factor of each load.
    pub(super) factors: Vec<(String, Expression)>,
    /// Terms of the case that have a stiffness, by their indices.
    pub(super) stiff: Vec<usize>,
    /// Stiffness of each point at the medians over that which its channel reads, without the case's stiffness factor: 0 of an open one.
    pub(super) at_medians: Vec<f64>,
    pub(super) structures: Recent<Condensed>,
    pub(super) states: Recent<ContactState>,
}

/// Numbers on which an equilibrium depends.
#[derive(Debug)]
pub struct Acting<'a> {
    /// Coefficients of the terms of the case, without the coefficients of holders and contacts.
    pub coefficients: &'a [f64],
    /// Factor of each load.
    pub loads: &'a [f64],
    /// Coefficient of friction of each point.
    pub mu: &'a [f64],
    /// Factor of the stiffness of each point: 0 of one that is out of contact.
    pub stiffness: &'a [f64],
}

/// State of all points in equilibrium; 0 where a point is open or out of contact.
#[derive(Debug)]
pub struct ContactState {
    /// Normal force of each point, N.
    pub forces: Vec<f64>,
    /// Gap of each point, m, negative of one that presses; 0 of one that is out of contact.
    pub gaps: Vec<f64>,
    /// Stiffness of each point over that which its channel reads.
    pub stiffness: Vec<f64>,
    /// Number of points that neither press nor are open by more than rounding: which of them are closed, and what they add to the brake, rounding says. Where a
    /// parameter moves a point over its opening there is one such point; at the medians of a case there should be no such point.
    pub undetermined: usize,
    /// Uniqueness of the state, and how it is known.
    pub uniqueness: Uniqueness,
}

impl ContactBalance {
    /// Loads over all rows, N, a column for each of `[[forces]]`, without its factor.
    pub fn loads(&self) -> &DMatrix<f64> {
        &self.loads
    }

    /// Loads of the case, each with the field of its factor.
    pub fn factors(&self) -> impl Iterator<Item = (String, &Expression)> {
        self.factors.iter().map(|(name, factor)| (format!("forces {name:?}.coefficient"), factor))
    }

    /// Stiffness of a point at the medians over that which its channel reads, without the case's stiffness factor.
    pub fn at_medians(&self, point: usize) -> f64 {
        self.at_medians[point]
    }

    /// Writes what an equilibrium is solved from, beside loads and their factors.
    pub(crate) fn identify(&self, to: &mut Written) {
        let Self {
            gaps,
            slips,
            areas,
            springs,
            law,
            stiff,
            at_medians,
            loads: _,
            factors: _,
            structures: _,
            states: _,
        } = self;
        for row in gaps.iter().chain(slips) {
            to.list(row, |to, &(dof, value)| {
                to.count(dof);
                to.number(value);
            });
        }
        for numbers in [areas, springs, at_medians] {
            to.list(numbers, |to, &number| to.number(number));
        }
        to.list(stiff, |to, &term| to.count(term));
        to.text(&format!("{law:?}"));
    }

    /// Number of contact points.
    pub fn points(&self) -> usize {
        self.springs.len()
    }

    /// The equilibrium at these numbers; `structure` is asked for the stiffness K of the structure at the coefficients where it is not known.
    ///
    /// # Errors
    /// Errors of [`Condensed`]: bodies that nothing holds, no equilibrium, friction that locks.
    pub fn state(
        &self,
        acting: &Acting<'_>,
        structure: &dyn Fn() -> CscMatrix<f64>,
    ) -> Result<Arc<ContactState>, ContactError> {
        let of_structure: Vec<f64> = self.stiff.iter().map(|&term| acting.coefficients[term]).collect();
        let key = [&of_structure, acting.loads, acting.mu, acting.stiffness].concat();
        self.states.get(STATES, key, || {
            let condense = || Condensed::new(&structure(), &self.gaps, &self.slips, &self.springs, &self.loads);
            let condensed = self.structures.get(STRUCTURES, of_structure.clone(), condense)?;
            let springs: Vec<f64> = self.springs.iter().zip(acting.stiffness).map(|(k, factor)| k * factor).collect();
            let kept: Vec<usize> = (0..self.points()).filter(|&at| springs[at] > 0.0).collect();
            let balance = Balance {
                gaps: vec![0.0; kept.len()],
                mu: kept.iter().map(|&at| acting.mu[at]).collect(),
                loads: acting.loads.to_vec(),
            };
            let condensed = condensed.with_stiffness(&springs)?;
            let found = match &self.law {
                // c (f g)^m is a law of an area that is f^m as large.
                Some(law @ Stiffness::Power { m, .. }) => {
                    let areas = kept.iter().map(|&at| self.areas[at] * acting.stiffness[at].powf(*m));
                    condensed.equilibrium_of_law(&balance, law, &areas.collect::<Vec<_>>())?
                }
                _ => condensed.equilibrium(&balance)?,
            };
            let undetermined = self.undetermined(&kept, &springs, &found, acting.loads);
            let (mut forces, mut gaps) = (vec![0.0; self.points()], vec![0.0; self.points()]);
            kept.iter().zip(found.forces).for_each(|(&at, force)| forces[at] = force);
            kept.iter().zip(found.gaps).for_each(|(&at, gap)| gaps[at] = gap);
            let stiffness = (0..self.points()).map(|at| self.stiffness(at, forces[at], acting.stiffness[at])).collect();
            Ok(ContactState { forces, gaps, stiffness, undetermined, uniqueness: found.uniqueness })
        })
    }

    /// Number of points that neither press nor are open by more than rounding of the loads; 0 without loads.
    fn undetermined(&self, kept: &[usize], springs: &[f64], found: &Equilibrium, factors: &[f64]) -> usize {
        let acting = &self.loads * DVector::from_column_slice(factors);
        let least = ROUNDING * acting.iter().map(|force| force.abs()).sum::<f64>();
        let points = kept.iter().zip(&found.gaps).zip(&found.forces);
        points.filter(|((at, gap), force)| springs[**at] * **gap < least && **force < least).count()
    }

    /// Tangent stiffness of a point under a force over that which its channel reads.
    fn stiffness(&self, point: usize, force: f64, factor: f64) -> f64 {
        match self.law {
            _ if force <= 0.0 => 0.0,
            Some(Stiffness::Power { c, m }) => {
                let pressure = force / self.areas[point];
                let by_area = m * c.powf(1.0 / m) * pressure.powf(1.0 - 1.0 / m);
                factor * by_area * self.areas[point] / self.springs[point]
            }
            _ => factor,
        }
    }
}

/// The results that were made last, each with the numbers that it was made for: first in, first out, whether asked for again or not.
#[derive(Debug)]
pub(super) struct Recent<T>(Mutex<VecDeque<(Vec<f64>, Arc<T>)>>);

impl<T> Default for Recent<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Recent<T> {
    /// The result for the numbers `key`, made if it is not among the `most` that are kept.
    fn get(
        &self,
        most: usize,
        key: Vec<f64>,
        make: impl FnOnce() -> Result<T, ContactError>,
    ) -> Result<Arc<T>, ContactError> {
        // What another thread kept before it panicked is right all the same.
        let locked = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, found)) = locked().iter().find(|(of, _)| *of == key) {
            return Ok(Arc::clone(found));
        }
        let found = Arc::new(make()?);
        let mut known = locked();
        known.push_back((key, Arc::clone(&found)));
        if known.len() > most {
            known.pop_front();
        }
        Ok(found)
    }
}
