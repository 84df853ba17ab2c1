//! Coordinates that the bases of two arrangements have in common, in which the modes of one arrangement become the modes of the other.

use cea::{CeaError, Mode, NewtonStep};
use linsys::{AffineSystem, ChannelGain, OperatingPoint, SecondOrder, real_times_complex};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use reduction::{ContactPath, OnContactPath, shape_directions};
use study::Bridge;
use tracking::{Eigenpair, OwnedPath};

use super::points::{all_patches, naming_point, of_brake};
use super::{FiniteElementBrake, Part};
use crate::Error;
use crate::case::FiniteElementCase;

/// The bridge from the naming point of a configuration's set of constraints to its own; `None` where both have one basis.
///
/// The coordinates of the bridge hold the modes at both ends, and no more: both bases are made for the friction of all draws, and have several times as
/// many columns. The path between the two ends is then one in fewer coordinates, on which every mode is followed. In the 276 scenes of
/// cases/disc-pad with seven and more patches in contact, 5,846 modes, six have other names than by whole spectra in small steps: in one
/// configuration two modes are told apart that were in doubt.
pub(super) fn bridge(
    brake: &FiniteElementBrake,
    configuration: usize,
    [origin_modes, own_modes]: [&[Mode]; 2],
) -> Result<Option<Bridge>, Error> {
    let own = brake.of_configurations[configuration];
    let set = brake.parts[own].set;
    let origin = brake.of_origins[set];
    if origin == own {
        return Ok(None);
    }
    let [origin_part, own_part]: [&Part; 2] = [&brake.parts[origin], &brake.parts[own]];
    let [from, to] = [&origin_part.within.basis, &own_part.within.basis];
    let in_set =
        |basis, modes: &[Mode]| -> Vec<_> { modes.iter().map(|mode| real_times_complex(basis, &mode.shape)).collect() };
    let common = shape_directions(&[in_set(from, origin_modes), in_set(to, own_modes)].concat())?;
    let onto: DMatrix<f64> = common.transpose();
    let start = brake.naming_systems[set].projected(&common)?;
    let (reduced, end_point) = (&brake.sets[set].reduced, own_point(&brake.case, &brake.closed[configuration])?);
    let change = reduced.assemble(&change(&brake.case, &end_point)?)?;
    let changed = |from: &DMatrix<f64>, change: &DMatrix<f64>| match change.iter().all(|&entry| entry == 0.0) {
        true => from.clone(),
        false => from + &onto * (change * &common),
    };
    let [m, c, k] = [changed(&start.m, &change.m), changed(&start.c, &change.c), changed(&start.k, &change.k)];
    // Internal states of the law in closed contacts, and of what relaxes.
    let states = reduced.assemble(&end_point)?.projected(&common)?.internal;
    let end = SecondOrder::with_internal(m, c, k, states)?;
    let highest = origin_modes.iter().chain(own_modes).map(|mode| mode.lambda.im).fold(0.0, f64::max);
    let path = ContactPath::new([&start, &end], highest)?;
    let own_path = |path| Box::new(OpeningPath { path, start: start.clone() }) as Box<dyn OwnedPath>;
    Ok(Some(Bridge {
        path: path.map(own_path),
        from: start.clone(),
        to: end,
        origin: &onto * from,
        own: &onto * to,
        between: to.transpose() * from,
    }))
}

/// A brake that holds all arrangements, with all patches closed, at the point where modes are named.
pub(super) fn naming_system(case: &FiniteElementCase, brake: &AffineSystem) -> Result<SecondOrder, Error> {
    Ok(brake.assemble(&own_point(case, &all_patches(case))?)?)
}

/// The naming point of the configuration with the patches `closed` in contact, as an operating point of the whole brake.
fn own_point(case: &FiniteElementCase, closed: &[usize]) -> Result<OperatingPoint, Error> {
    Ok(of_brake(case, closed, &naming_point(case, closed)?))
}

/// Change of the operating point from the naming point of a set of constraints to the naming point `to` of a configuration. The matrices of a system are
/// linear in it; its internal states are not, and are left out.
fn change(case: &FiniteElementCase, to: &OperatingPoint) -> Result<OperatingPoint, Error> {
    let from = own_point(case, &all_patches(case))?;
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

/// The path of a bridge: contacts open, all else stays.
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
