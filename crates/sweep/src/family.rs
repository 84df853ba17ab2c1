//! The systems of a brake along a straight line in the space of its swept parameters.

use std::sync::Arc;

use cea::{CountedSpectrum, Counters, EigenSolver, Threshold, Verdict, WholeSpectra, grows_too_fast};
use linsys::SecondOrder;
use montecarlo::Progress;
use num_complex::Complex;
use osc_model::{Sector, Sectors};
use serde::Serialize;
use study::{ModeSource, Parametrised, Reference, Scene, Study, UncertainBrake, WholeEigenvalue};
use tracking::{Ambiguity, KeptSpectra, RootLocus, SystemAt, SystemChange};

use super::change::{Band, Change};
use super::parameter::{Over, SweptParameter, swept};
use crate::Error;

/// Half of the step of the central differences that derivatives by a parameter are computed by, as a fraction of its range; chosen: the error of the
/// differences, of the order of its square, is then about their rounding, machine epsilon over it.
pub(super) const DIFFERENCE: f64 = 1e-5;
/// Shortest step, as a fraction of the range; chosen: derivatives by differences tell branches apart down to there.
pub(super) const SHORTEST_STEP: f64 = 1e-9;
/// Shortest step of the root locus, as a fraction of the range; chosen: narrower events are found by other means.
pub(super) const SHORTEST_LOCUS_STEP: f64 = 1e-6;
/// Places between the ends, as fractions of the ranges, at which it is checked whether the sectors contain all of the system; chosen, as nothing repeats
/// there.
const PROBES: [f64; 2] = [0.3137, 0.7291];
/// Fraction of the squared norm of a matrix that may be outside of all sectors: rounding.
const COUPLING: f64 = 1e-12;

/// Numbers of spectra, vectors and eigenvalues that a sweep computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Evaluations {
    /// Number of spectra of a whole system.
    pub spectra: u64,
    /// Number of left and right eigenvectors.
    pub eigenvectors: u64,
    /// Number of single eigenvalues found from a neighbouring one, without a spectrum.
    pub continued: u64,
    /// Number of single eigenvalues of the full model, of a brake that is reduced.
    #[serde(skip_serializing_if = "is_zero")]
    pub whole: u64,
}

impl Evaluations {
    /// Numbers of spectra and vectors from counters.
    pub(super) fn of(counters: Counters) -> Self {
        Self { spectra: counters.eigenvalue_solves, eigenvectors: counters.eigenvectors, ..Self::default() }
    }
}

impl std::ops::AddAssign for Evaluations {
    fn add_assign(&mut self, Self { spectra, eigenvectors, continued, whole }: Self) {
        self.spectra += spectra;
        self.eigenvectors += eigenvectors;
        self.continued += continued;
        self.whole += whole;
    }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// Parametrised system: a scene of a brake with some of its parameters swept.
pub(super) struct Family<'a, B: UncertainBrake> {
    pub study: &'a Study<'a, B>,
    of: &'a dyn Parametrised,
    /// Index of the scene in the plan.
    pub scene: usize,
    pub solver: WholeSpectra<'a>,
    pub progress: &'a dyn Progress,
    pub parameters: Vec<SweptParameter>,
    /// Length of the range of the family, as a fraction of the range that is asked for: 1, or less for a piece between openings.
    pub share: f64,
}

/// Part of a family whose modes do not couple with others: a sector, or all of it.
pub(super) struct Part<'a, B: UncertainBrake> {
    pub family: &'a Family<'a, B>,
    sector: Option<&'a Sector>,
    /// Reference modes of the part at the medians.
    pub reference: &'a Reference,
}

/// A straight line: at `t` the swept parameters are at the fractions `start + t direction` of their ranges.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub start: Vec<f64>,
    pub direction: Vec<f64>,
    /// Least and largest `t` at which the brake may be asked for its systems.
    pub bounds: [f64; 2],
    /// Half of the step in `t` of the central differences that derivatives are computed by.
    pub difference: f64,
}

/// Function that makes the system at a place of a line.
pub(super) type MakeSystem<'a> = Box<dyn FnMut(f64) -> Result<SystemAt, Error> + 'a>;

impl<'a, B: UncertainBrake> Family<'a, B> {
    /// The scene of a study with the parameters `over` swept. Values at the corners of their ranges that the brake refuses are an error
    /// before anything else is computed.
    pub fn new(
        study: &'a Study<'a, B>,
        scene: usize,
        over: &[Over],
        solver: &'a dyn EigenSolver,
        progress: &'a dyn Progress,
    ) -> Result<Self, Error> {
        let (brake, at) = (study.brake(), &study.plan().scenes[scene]);
        let of = brake.parametrised().ok_or(Error::NotGiven { capability: "parametrised()", needed_by: "a sweep" })?;
        let parameters = swept(&of.parameters(at), &study.plan().describe(at), over)?;
        let family = Self { study, of, scene, solver: WholeSpectra(solver), progress, parameters, share: 1.0 };
        family.corners().iter().try_for_each(|corner| family.system(corner).map(drop))?;
        Ok(family)
    }

    /// The same family with another solver.
    pub fn with_solver<'b>(&self, solver: &'b dyn EigenSolver) -> Family<'b, B>
    where
        'a: 'b,
    {
        let Self { study, of, scene, progress, share, .. } = *self;
        Family { study, of, scene, solver: WholeSpectra(solver), progress, parameters: self.parameters.clone(), share }
    }

    /// The same family on a piece of the range of its one parameter, given by the values at its ends; `share` is its length as a fraction of the range.
    pub fn piece(&self, [from, to]: [f64; 2], share: f64) -> Self {
        let Self { study, of, scene, solver: WholeSpectra(solver), progress, .. } = *self;
        let parameters = vec![SweptParameter { from, to, ..self.parameters[0].clone() }];
        Self { study, of, scene, solver: WholeSpectra(solver), progress, parameters, share }
    }

    /// Names of the contact points that open and close.
    pub fn contact_points(&self) -> Vec<String> {
        self.of.contact_points(self.scene())
    }

    /// Flags of the contact points, true of those that are closed, at values of the swept parameters.
    pub fn closed_points(&self, values: &[f64]) -> Result<Vec<bool>, Error> {
        self.progress.go_on()?;
        self.of.closed_points(self.scene(), &self.placed(values)).map_err(|source| self.at_values(source, values))
    }

    /// Corners of the ranges: all combinations of their ends.
    fn corners(&self) -> Vec<Vec<f64>> {
        let ends = self.parameters.iter().map(|parameter| [parameter.from, parameter.to]);
        ends.fold(vec![Vec::new()], |corners, ends| {
            let with = |corner: &Vec<f64>, end: f64| [corner.as_slice(), &[end]].concat();
            corners.iter().flat_map(|corner| ends.map(|end| with(corner, end))).collect()
        })
    }

    /// The system at values of the swept parameters.
    pub fn system(&self, values: &[f64]) -> Result<SecondOrder, Error> {
        self.progress.go_on()?;
        self.of.system_with(self.scene(), &self.placed(values)).map_err(|source| self.at_values(source, values))
    }

    /// An error of the brake with the values of the swept parameters at which it happened.
    fn at_values(&self, source: study::Error, values: &[f64]) -> Error {
        let named = || self.parameters.iter().zip(values).map(|(p, value)| format!("{} = {value}", p.name));
        Error::from(source)
            .in_sweep(self.study.plan(), || format!("swept to {}", named().collect::<Vec<_>>().join(", ")))
    }

    /// True if divergence counts: of a reduced brake nothing is known that does not oscillate.
    pub fn counts_divergence(&self) -> bool {
        self.study.brake().mode_source().is_none()
    }

    /// Number of modes that are unstable for certain, and of those that may be, at a fraction of the range of the swept parameter, by a brake that has loss factors
    /// in the place of which its systems have dashpots; `None` of another one.
    pub fn unstable_with_losses(&self, at: f64) -> Result<Option<[usize; 2]>, Error> {
        let (plan, scene) = (self.study.plan(), self.scene());
        let Some(source) = self.study.brake().source_with_losses(scene) else { return Ok(None) };
        self.progress.go_on()?;
        let values = self.values(&[at]);
        let found = source.band_modes_with(scene, &self.placed(&values));
        let mut modes = found.map_err(|source| self.at_values(source, &values))?;
        modes.retain(|mode| plan.is_studied(mode.lambda));
        let count = |is: fn(Verdict) -> bool| modes.iter().filter(|mode| is(mode.verdict(&plan.threshold))).count();
        let unstable = count(|verdict| verdict == Verdict::Unstable);
        Ok(Some([unstable, unstable + count(|verdict| matches!(verdict, Verdict::Undecided { .. }))]))
    }

    fn scene(&self) -> &Scene {
        &self.study.plan().scenes[self.scene]
    }

    /// Values of the swept parameters with the indices of these among the parameters of the scene.
    fn placed(&self, values: &[f64]) -> Vec<(usize, f64)> {
        self.parameters.iter().map(|parameter| parameter.place).zip(values.iter().copied()).collect()
    }

    /// Values of the swept parameters at fractions of their ranges.
    fn values(&self, parts: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(parts).map(|(parameter, &part)| parameter.at(part)).collect()
    }

    /// Parts of the family: the sectors of the brake, if they contain all of its system at the corners of the ranges and at [`PROBES`], else the whole as
    /// one part.
    pub fn parts(&'a self) -> Result<Vec<Part<'a, B>>, Error> {
        let brake = self.study.plan().brake(self.scene());
        let middle = |part: f64| self.parameters.iter().map(|parameter| parameter.at(part)).collect();
        let mut hold = brake.sectors.iter().len() > 1;
        for values in self.corners().into_iter().chain(PROBES.map(middle)) {
            hold = hold && divides(&brake.sectors, &self.system(&values)?)?;
        }
        Ok(if hold {
            let references = &self.study.sector_references()[self.scene];
            let part = |(sector, reference)| Part { family: self, sector: Some(sector), reference };
            brake.sectors.iter().zip(references).map(part).collect()
        } else {
            vec![self.whole()]
        })
    }

    /// All of the family as one part.
    pub fn whole(&'a self) -> Part<'a, B> {
        Part { family: self, sector: None, reference: &self.study.references()[self.scene] }
    }
}

/// True if sectors contain all of a system. Their bases are orthonormal: the squared norms of the system in the sectors add up to that of the whole where
/// nothing couples the sectors.
fn divides(sectors: &Sectors, system: &SecondOrder) -> Result<bool, Error> {
    let squares = |system: &SecondOrder| [&system.m, &system.c, &system.k].map(|matrix| matrix.norm_squared());
    let (whole, mut parts) = (squares(system), [0.0; 3]);
    for sector in sectors.iter() {
        for (sum, square) in parts.iter_mut().zip(squares(&sector.reduced(system)?)) {
            *sum += square;
        }
    }
    Ok(whole.iter().zip(parts).all(|(whole, parts)| (whole - parts).abs() <= COUPLING * whole))
}

impl<'a, B: UncertainBrake> Part<'a, B> {
    /// The system at fractions of the ranges of the swept parameters.
    pub fn system(&self, parts: &[f64]) -> Result<SecondOrder, Error> {
        let whole = self.family.system(&self.family.values(parts))?;
        Ok(match self.sector {
            Some(sector) => sector.reduced(&whole)?,
            None => whole,
        })
    }

    /// The eigenvalue of the full model next to `near`, rad/s, at fractions of the ranges; `None` of a brake that is not reduced.
    pub fn whole_eigenvalue(&self, parts: &[f64], near: Complex<f64>) -> Result<Option<WholeEigenvalue>, Error> {
        let (family, values) = (self.family, self.family.values(parts));
        let found = |source: &dyn ModeSource| source.whole_eigenvalue(family.scene(), &family.placed(&values), near);
        Ok(family.study.brake().mode_source().map(found).transpose()?)
    }

    /// Relative error of an eigenvalue against the full model; 0 for a brake that is not reduced.
    pub fn relative_error(&self) -> f64 {
        self.family.study.brake().mode_source().map_or(0.0, |source| source.relative_error(self.family.scene()))
    }

    /// Instability threshold of a mode.
    pub fn threshold(&self) -> Threshold {
        self.family.study.plan().threshold
    }

    /// Frequencies of the modes that are studied, and of those that are followed; `None` where the plan has no band, and so all modes are studied.
    pub fn band(&self) -> Option<Band> {
        let plan = self.family.study.plan();
        let is_of_basis = !self.counts_divergence();
        Some(Band { studied: plan.band?, followed: plan.followed_band()?, is_of_basis })
    }

    /// True if modes of this frequency, rad/s, are studied.
    pub fn is_studied(&self, omega: f64) -> bool {
        self.family.study.plan().is_studied(Complex::new(0.0, omega))
    }

    /// True if divergence counts, as [`Family::counts_divergence`].
    pub fn counts_divergence(&self) -> bool {
        self.family.counts_divergence()
    }

    /// True if a change is of oscillating modes, or of divergence where divergence is studied.
    pub fn counts(&self, change: &Change) -> bool {
        change.of.oscillates() || self.counts_divergence()
    }

    /// Numbers of the unstable modes of a spectrum that are studied: pairs that flutter, and real eigenvalues that diverge. A pair of a reduced brake that grows
    /// faster than it oscillates is no mode.
    pub fn counted(&self, spectrum: &CountedSpectrum) -> [usize; 2] {
        let is_mode = |lambda: &&Complex<f64>| self.counts_divergence() || !grows_too_fast(**lambda);
        let flutter = spectrum.flutter.iter().filter(is_mode).filter(|lambda| self.is_studied(lambda.im)).count();
        [flutter, if self.counts_divergence() { spectrum.divergence.len() } else { 0 }]
    }

    /// The root locus with the branches of modes that are studied.
    pub fn studied(&self, locus: RootLocus) -> RootLocus {
        let plan = self.family.study.plan();
        let mut places = vec![None; locus.branches.len()];
        let mut branches = Vec::new();
        for (place, branch) in places.iter_mut().zip(locus.branches) {
            if branch.points.iter().any(|(_, point)| plan.is_studied(point.lambda)) {
                *place = Some(branches.len());
                branches.push(branch);
            }
        }
        let kept = |branches: Vec<usize>| branches.into_iter().filter_map(|branch| places[branch]).collect::<Vec<_>>();
        let ambiguities = locus.ambiguities.into_iter().map(|ambiguity| Ambiguity {
            before: kept(ambiguity.before),
            after: kept(ambiguity.after),
            ..ambiguity
        });
        let ambiguities = ambiguities.filter(|it| !(it.before.is_empty() && it.after.is_empty())).collect();
        RootLocus { branches, ambiguities }
    }

    /// Medians of the swept parameters, as fractions of the ranges.
    pub fn medians(&self) -> Vec<f64> {
        self.family.parameters.iter().map(|parameter| parameter.part(parameter.median)).collect()
    }

    /// The spectra along a line.
    pub fn along(&'a self, line: Line) -> KeptSpectra<'a, MakeSystem<'a>> {
        let make: MakeSystem<'a> = Box::new(move |t| {
            let at = |t: f64| {
                let parts = line.start.iter().zip(&line.direction).map(|(from, by)| from + t * by);
                self.system(&parts.collect::<Vec<_>>())
            };
            let (below, above) = ((t - line.difference).max(line.bounds[0]), (t + line.difference).min(line.bounds[1]));
            let change = SystemChange { below: at(below)?, above: at(above)?, distance: above - below };
            Ok(SystemAt { system: at(t)?, change: Arc::new(change) })
        });
        let spectra = KeptSpectra::new(make, &self.family.solver).with_overdamping();
        match self.band() {
            Some(band) => spectra.in_band(band.followed),
            None => spectra,
        }
    }
}
