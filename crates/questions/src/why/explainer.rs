//! A scene prepared for the question why its modes grow.

use cea::{
    EQUAL_BUT_FOR_ROUNDING, EigenSolver, Eigentriple, Expansion, Mode, QrSolver, RealModes, Separation, Spectrum,
    Verdict, Workspace, damping_ratio, verdicts_beyond,
};
use linsys::{Internal, OperatingPoint, SecondOrder};
use num_complex::Complex;
use osc_model::Brake;
use serde::Serialize;
use study::{Scene, UncertainBrake};

use super::balance::Balance;
use super::influence::{Influence, InfluenceKind, between, of_friction, of_terms, rank};
use crate::Error;

/// Half of the step of the central differences that derivatives of matrices by a parameter are computed by, relative to its value: its square is the error of
/// the first derivative, and machine epsilon over its square the error of the second.
const DIFFERENCE: f64 = 1e-4;

/// A mode of the structure without damping and friction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StructureMode {
    /// Number of the structure mode, from 1, ascending in frequency.
    pub number: usize,
    /// Frequency, Hz; negative where the structure would fall away from its rest.
    pub frequency_hz: f64,
    /// Participation in the mode.
    pub part: f64,
}

/// Reasons of the growth of one mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Why {
    /// Eigenvalue lambda, rad/s.
    #[serde(skip)]
    pub lambda: Complex<f64>,
    /// Relative condition number of the eigenvalue.
    pub condition: f64,
    /// Distance to the next eigenvalue, rad/s.
    pub nearest: f64,
    /// Fraction of each derivative that may be rounding.
    pub blur: f64,
    /// The mode has derivatives: its eigenvalue is simple as far as can be told.
    pub is_simple: bool,
    /// Influences on the mode, the one that changes the growth by most per cent first, those of values that are 0 last; empty where the eigenvalue is not simple.
    pub influences: Vec<Influence>,
    /// The brake names its parameters; of one that does not, contacts and terms alone are listed.
    pub names_parameters: bool,
    /// Parameters that cannot be varied at their medians.
    pub not_varied: Vec<String>,
    /// Energy balance: the forces that feed and drain the mode, and where its energy is.
    pub balance: Balance,
    /// Modes of the structure in the mode, the largest part first; empty where the structure has no such modes.
    pub structure_modes: Vec<StructureMode>,
    /// Reason why the structure has no such modes.
    pub no_structure_modes: Option<String>,
}

/// A scene of a brake at its medians.
pub struct Explainer<'a, B: UncertainBrake> {
    brake: &'a B,
    scene: &'a Scene,
    at: OperatingPoint,
    system: SecondOrder,
    spectrum: Spectrum,
    structure: Result<RealModes, cea::NoRealModes>,
}

impl<'a, B: UncertainBrake> Explainer<'a, B> {
    /// Solves the scene at its medians; one spectrum.
    ///
    /// # Errors
    /// Those of the brake and of the solver.
    pub fn new(brake: &'a B, scene: &'a Scene, work: &mut Workspace) -> Result<Self, Error> {
        let at = brake.operating_point(scene, &brake.median())?;
        let system = &brake.plan().brake(scene).system;
        let structure = system.structure(&at.coefficients)?;
        let system = system.assemble(&at)?;
        let spectrum = QrSolver.eigenvalues(&system, work)?;
        Ok(Self { brake, scene, at, system, spectrum, structure: RealModes::new(&structure.m, &structure.k) })
    }

    /// Modes that the plan studies and that surely are unstable, ascending in frequency: beyond the threshold of the plan by more than rounding; for a brake that
    /// finds its modes itself the modes that the brake says are unstable, as in a study.
    ///
    /// # Errors
    /// Errors of the brake and of [`verdicts_beyond`].
    pub fn unstable(&self, work: &mut Workspace) -> Result<Vec<Complex<f64>>, Error> {
        let (modes, plan) = (self.oscillating(), self.brake.plan());
        if let Some(source) = self.brake.mode_source() {
            let mut found = source.band_modes(self.scene, std::slice::from_ref(&self.at)).remove(0)?;
            found.retain(|of| plan.is_studied(of.lambda) && of.verdict(&plan.threshold) == Verdict::Unstable);
            let unstable: Vec<_> = found.iter().filter_map(|mode| self.counterpart(mode.lambda)).collect();
            return Ok(modes.into_iter().filter(|mode| unstable.contains(mode)).collect());
        }
        let verdicts = verdicts_beyond(&plan.threshold, &self.system, &modes, &self.spectrum, work)?;
        let unstable = modes.into_iter().zip(verdicts).filter(|(_, of)| *of == Verdict::Unstable);
        Ok(unstable.map(|(mode, _)| mode).filter(|mode| plan.is_studied(*mode)).collect())
    }

    /// The eigenvalue of the system of this scene that stands for the eigenvalue `lambda` of the brake, rad/s: itself, or, where dashpots stand in the system
    /// for loss factors, the nearest within the error of the system; `None` where no eigenvalue is so near.
    pub fn counterpart(&self, lambda: Complex<f64>) -> Option<Complex<f64>> {
        let error = self.brake.error_of_reduction(self.scene).max(EQUAL_BUT_FOR_ROUNDING);
        let distance = |own: &Complex<f64>| (own - lambda).norm();
        let nearest = self.spectrum.oscillatory().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.filter(|own| distance(own) <= error * lambda.norm())
    }

    /// Oscillating modes, ascending in frequency.
    #[must_use]
    pub fn oscillating(&self) -> Vec<Complex<f64>> {
        self.spectrum.oscillatory().collect()
    }

    /// The modes of [`unstable`](Self::unstable); where there are none the least damped one.
    ///
    /// # Errors
    /// As there.
    pub fn asked_for(&self, work: &mut Workspace) -> Result<Vec<Complex<f64>>, Error> {
        let unstable = self.unstable(work)?;
        Ok(if unstable.is_empty() { least_damped(self.oscillating()).into_iter().collect() } else { unstable })
    }

    /// Reasons of the growth of modes of the scene, given by their eigenvalues `lambdas`.
    ///
    /// Three factorisations of Q for each mode and two systems for each parameter, but no further spectrum.
    ///
    /// # Errors
    /// A number that is no eigenvalue; errors of the brake.
    pub fn why(&self, lambdas: &[Complex<f64>], work: &mut Workspace) -> Result<Vec<Why>, Error> {
        let triples = lambdas.iter().map(|&lambda| Eigentriple::new(&self.system, lambda, work));
        let triples = triples.collect::<Result<Vec<_>, _>>()?;
        let mut found = Vec::with_capacity(triples.len());
        for triple in &triples {
            found.push(self.without_influences(triple)?);
        }
        let mut expansions = Vec::new();
        for (mode, triple) in triples.iter().enumerate() {
            if !found[mode].is_simple {
                continue;
            }
            let expansion = Expansion::new(&self.system, triple, work)?;
            let (model, units) = (self.model(), self.brake.plan().units);
            found[mode].influences = of_terms(model, &self.at, triple, &expansion)?;
            found[mode].influences.extend(of_friction(model, &self.at, triple, &expansion, units)?);
            expansions.push((mode, triple, expansion));
        }
        self.vary(|parameter, systems, half_step| {
            for (mode, triple, expansion) in &expansions {
                let Some(systems) = systems else {
                    found[*mode].not_varied.push(parameter.name.clone());
                    continue;
                };
                let rates = between(triple, expansion, systems, half_step)?;
                let (kind, value) = (InfluenceKind::Parameter, parameter.median);
                let influence = Influence::new(kind, &parameter.name, &parameter.unit, value, &rates);
                found[*mode].influences.push(influence);
            }
            Ok(())
        })?;
        found.iter_mut().for_each(|why| rank(&mut why.influences));
        Ok(found)
    }

    fn model(&self) -> &'a Brake {
        self.brake.plan().brake(self.scene)
    }

    /// Answer for one mode without the influences.
    fn without_influences(&self, triple: &Eigentriple) -> Result<Why, Error> {
        let separation = triple.separation(&self.spectrum.eigenvalues);
        let Separation { nearest, blur } = separation;
        let mode = Mode::normalised(&self.system.m, triple.lambda, triple.right.clone());
        let structure_modes = self.structure.as_ref().map_or(Vec::new(), |modes| {
            let parts = modes.participation(&mode.shape).into_iter().zip(&modes.omega_squared).enumerate();
            let mut list: Vec<StructureMode> = parts
                .map(|(place, (part, square))| {
                    let frequency_hz = square.abs().sqrt().copysign(*square) / std::f64::consts::TAU;
                    StructureMode { number: place + 1, frequency_hz, part }
                })
                .collect();
            list.sort_by(|a, b| b.part.total_cmp(&a.part));
            list
        });
        Ok(Why {
            lambda: triple.lambda,
            condition: triple.condition(),
            nearest,
            blur,
            is_simple: separation.is_simple(),
            influences: Vec::new(),
            names_parameters: self.brake.parametrised().is_some(),
            not_varied: Vec::new(),
            balance: Balance::new(self.model(), &self.at, &mode)?,
            structure_modes,
            no_structure_modes: self.structure.as_ref().err().map(ToString::to_string),
        })
    }

    /// Calls `each` with every parameter of the scene and the systems below, at and above its median; without them where the brake
    /// refuses both sides.
    fn vary(
        &self,
        mut each: impl FnMut(&study::NamedParameter, Option<[&SecondOrder; 3]>, f64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let Some(of) = self.brake.parametrised() else { return Ok(()) };
        let at = of.system_with(self.scene, &[])?;
        for (place, parameter) in of.parameters(self.scene).iter().enumerate() {
            let half_step = DIFFERENCE * if parameter.median == 0.0 { 1.0 } else { parameter.median.abs() };
            let system = |by: f64| of.system_with(self.scene, &[(place, parameter.median + by)]);
            // Where one side is refused, such as negative values, the systems go on smoothly from the other side.
            let beyond = |near: &SecondOrder, sign: f64| {
                Ok::<_, study::Error>(extrapolated(&at, near, &system(2.0 * sign * half_step)?))
            };
            let sides = match (system(-half_step), system(half_step)) {
                (Ok(below), Ok(above)) => Ok((below, above)),
                (Err(_), Ok(above)) => beyond(&above, 1.0).map(|below| (below, above)),
                (Ok(below), Err(_)) => beyond(&below, -1.0).map(|above| (below, above)),
                (Err(refused), Err(_)) => Err(refused),
            };
            match sides {
                Ok((below, above)) => each(parameter, Some([&below, &at, &above]), half_step)?,
                Err(_) => each(parameter, None, half_step)?,
            }
        }
        Ok(())
    }
}

/// The least damped of `modes`; `None` without modes.
#[must_use]
pub fn least_damped(modes: Vec<Complex<f64>>) -> Option<Complex<f64>> {
    modes.into_iter().min_by(|a, b| damping_ratio(*a).total_cmp(&damping_ratio(*b)))
}

/// The system at -h from the systems at 0, h and 2 h: each entry on its parabola, `3 a - 3 b + c`.
fn extrapolated(at: &SecondOrder, near: &SecondOrder, far: &SecondOrder) -> SecondOrder {
    let parabola = |a: &mut f64, b: f64, c: f64| *a += 2.0 * (*a - b) + (c - b);
    let mut beyond = at.clone();
    let Internal { decay, drive, force } = &mut beyond.internal;
    decay.zip_zip_apply(&near.internal.decay, &far.internal.decay, parabola);
    let [near, far] = [near, far].map(|s| [&s.m, &s.c, &s.k, &s.internal.drive, &s.internal.force]);
    let matrices = [&mut beyond.m, &mut beyond.c, &mut beyond.k, drive, force];
    for ((matrix, near), far) in matrices.into_iter().zip(near).zip(far) {
        matrix.zip_zip_apply(near, far, parabola);
    }
    beyond
}
