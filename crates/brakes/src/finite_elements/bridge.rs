//! Coordinates that the bases of two arrangements have in common, in which the modes of one arrangement become the modes of the other.

use cea::{CeaError, Mode, NewtonStep};
use linsys::{AffineSystem, ChannelGain, OperatingPoint, SecondOrder, real_times_complex};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use reduction::{ContactPath, OnContactPath, shape_directions};
use study::Bridge;
use tracking::{Eigenpair, OwnedPath};

use super::FiniteElementBrake;
use super::points::{all_patches, naming_point, of_brake};
use crate::Error;
use crate::case::FiniteElementCase;

/// The bridge from the origin of a configuration's set of constraints, all patches closed, to the naming point of the configuration; `None` where both are on the
/// same part.
///
/// The coordinates of the bridge hold the modes at both ends, and no more: both bases are made for the friction of all draws, and have several times as
/// many columns. The path between the two ends is then one in fewer coordinates, on which every mode is followed; without [`ContactPath`], of internal states or of
/// ends that differ in many directions, by the matrices of the bridge. Of 5,846 modes, those of the 276 scenes of cases/disc-pad with seven and more patches in contact,
/// whole spectra in small steps give all but six the same names: the six are of one configuration, in which two modes are told apart here that were in doubt there.
pub(super) fn bridge(
    brake: &FiniteElementBrake,
    configuration: usize,
    // An origin without modes has been refused.
    [origin_modes, modes]: [&[Mode]; 2],
) -> Result<Option<Bridge>, Error> {
    let part = brake.of_configurations[configuration];
    let set = brake.parts[part].set;
    let origin = brake.of_origins[set];
    if origin == part {
        return Ok(None);
    }
    let [origin_basis, basis] = [origin, part].map(|part| &brake.parts[part].within.basis);
    let in_set =
        |basis, modes: &[Mode]| -> Vec<_> { modes.iter().map(|mode| real_times_complex(basis, &mode.shape)).collect() };
    let common = shape_directions(&[in_set(origin_basis, origin_modes), in_set(basis, modes)].concat())?;
    let onto: DMatrix<f64> = common.transpose();
    let start = brake.naming_systems[set].projected(&common)?;
    let (reduced, end_point) =
        (&brake.sets[set].reduced, whole_naming_point(&brake.case, &brake.closed[configuration])?);
    // The change is added to the start, and the end not projected by itself: a matrix that does not change has the same bits at both ends, and the path no direction
    // of it.
    let change = reduced.assemble(&change_to(&brake.case, &end_point)?)?;
    let changed = |from: &DMatrix<f64>, change: &DMatrix<f64>| match change.iter().all(|&entry| entry == 0.0) {
        true => from.clone(),
        false => from + &onto * (change * &common),
    };
    let [m, c, k] = [changed(&start.m, &change.m), changed(&start.c, &change.c), changed(&start.k, &change.k)];
    // Internal states, of the law in closed contacts and of what relaxes, are in no change: they are those of the whole end.
    let states = reduced.assemble(&end_point)?.projected(&common)?.internal;
    let end = SecondOrder::with_internal(m, c, k, states)?;
    // Of all modes that are followed, those beside the band too.
    let highest = origin_modes.iter().chain(modes).map(|mode| mode.lambda.im).fold(0.0, f64::max);
    let path = ContactPath::new([&start, &end], highest)?;
    let opening = |path| Box::new(OpeningPath { path, start: start.clone() }) as Box<dyn OwnedPath>;
    Ok(Some(Bridge {
        path: path.map(opening),
        start: start.clone(),
        end,
        origin: &onto * origin_basis,
        configuration: &onto * basis,
        between: basis.transpose() * origin_basis,
    }))
}

/// The system of a set of constraints on its own basis, all patches closed, at the naming point.
pub(super) fn naming_system(case: &FiniteElementCase, brake: &AffineSystem) -> Result<SecondOrder, Error> {
    Ok(brake.assemble(&whole_naming_point(case, &all_patches(case))?)?)
}

/// The naming point with the patches `closed` in contact, as an operating point of the whole brake.
fn whole_naming_point(case: &FiniteElementCase, closed: &[usize]) -> Result<OperatingPoint, Error> {
    Ok(of_brake(case, closed, &naming_point(case, closed)?))
}

/// Change of the operating point from the naming point of a set of constraints, all patches closed, to the naming point `to` of a configuration. M, C and K are
/// linear in an operating point, so that the change is assembled like one; lags are not, and are left out.
fn change_to(case: &FiniteElementCase, to: &OperatingPoint) -> Result<OperatingPoint, Error> {
    let from = whole_naming_point(case, &all_patches(case))?;
    let gain = |(from, to): (&ChannelGain, &ChannelGain)| ChannelGain {
        mu: to.mu - from.mu,
        slope: to.slope - from.slope,
        lag: None,
    };
    Ok(OperatingPoint {
        coefficients: to.coefficients.iter().zip(&from.coefficients).map(|(to, from)| to - from).collect(),
        channels: from.channels.iter().zip(&to.channels).map(gain).collect(),
    })
}

/// The path of a bridge between two ends that differ in few directions: those of the contacts that open, and of what changes in others with them. It keeps its start
/// for steps that ask for a system.
#[derive(Debug)]
struct OpeningPath {
    path: ContactPath,
    start: SecondOrder,
}

impl OwnedPath for OpeningPath {
    fn correct(&self, t: f64, lambda: Complex<f64>) -> Option<(NewtonStep, DVector<Complex<f64>>)> {
        let OnContactPath { lambda, rate, shape } = self.path.next_to(t, lambda)?;
        Some((NewtonStep { lambda, rate }, shape))
    }

    fn characteristic(&self, at: &[(f64, Complex<f64>)]) -> Vec<Complex<f64>> {
        self.path.characteristic(at)
    }

    fn nearest(&self, t: f64, to: &[Complex<f64>], count: usize) -> Option<Vec<Eigenpair>> {
        Some(self.path.nearest(t, to, count)?.into_iter().map(|found| (found.lambda, found.shape)).collect())
    }

    fn system(&self) -> Result<SecondOrder, CeaError> {
        Ok(self.start.clone())
    }
}
