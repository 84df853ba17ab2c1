//! What one sector of a block of samples says: verdicts on its modes, shapes and names of those that are unstable.

use cea::{
    Anchors, CeaError, EigenSolver, Gain, GainPath, Growing, Mode, Modes, Secular, Spectrum, Verdict, Workspace,
    verdict,
};
use linsys::SecondOrder;
use num_complex::Complex;
use tracking::{Links, Path, PathEnd, PathStart, identify_all};

use super::Reference;
use super::memory::{Memory, timed};

/// The modes of one sector of one sample.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// All of them; those that damp may be guesses in the right order.
    pub modes: Modes,
    /// The unstable ones, ascending in frequency.
    pub unstable: Vec<Unstable>,
    /// Modes whose verdict the error bound leaves open.
    pub undecided: u32,
}

/// An unstable mode of a sector.
#[derive(Debug, Clone)]
pub(super) struct Unstable {
    /// Its place among the oscillating modes of the sector.
    pub index: usize,
    /// Itself, its shape in the basis of the sector.
    pub mode: Mode,
    /// Names it may have as a tracked mode.
    pub names: Vec<u16>,
}

/// The growing modes of a sector of a sample, as its secular equation finds them.
pub(super) type Known = Option<(Gain, Growing)>;

/// Modes with what they may be called.
type Named = Vec<(Mode, Vec<u16>)>;

/// How one sector of a scene is solved.
pub(super) struct Solver<'a> {
    pub spectra: &'a dyn EigenSolver,
    /// What its modes are named after.
    pub reference: &'a Reference,
    /// `None` where spectra are the better way.
    pub equation: Option<Equation<'a>>,
}

/// The secular equation of a sector of a scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Equation<'a> {
    pub secular: &'a Secular,
    pub anchors: &'a Anchors,
    /// The gain of the reference.
    pub reference: Gain,
}

impl Solver<'_> {
    /// Solves for the modes of `systems`, this sector of some samples, and names the unstable ones.
    pub fn solve(&self, systems: &[SecondOrder], memory: &mut Memory) -> Vec<Result<Part, CeaError>> {
        // Friction does not reach every sector: where it does not, all samples are one.
        if let [first, others @ ..] = systems
            && !others.is_empty()
            && others.iter().all(|other| other == first)
        {
            let part = self.solve(std::slice::from_ref(first), memory).remove(0);
            return vec![part; systems.len()];
        }
        let Memory { spectra, work, spent } = memory;
        let judged: Vec<Result<Judged, CeaError>> = timed(&mut spent.spectra, || {
            self.spectra.eigenvalues_of_all(systems, work, spectra);
            let judge = |(system, spectrum): (&SecondOrder, &Result<Spectrum, CeaError>)| {
                Judged::new(system, spectrum.as_ref().map_err(CeaError::clone)?, work)
            };
            systems.iter().zip(&*spectra).map(judge).collect()
        });
        let lambdas: Vec<Vec<Complex<f64>>> =
            judged.iter().map(|judged| judged.as_ref().map(Judged::lambdas).unwrap_or_default()).collect();
        let asked: Vec<_> = systems.iter().zip(lambdas.iter().map(Vec::as_slice)).collect();
        let shaped = timed(&mut spent.shapes, || Mode::of_all(&asked, work));
        let starts: Vec<PathStart<'_>> = systems.iter().map(PathStart::System).collect();
        let named = self.named(&starts, shaped, memory);
        judged.into_iter().zip(named).map(|(judged, named)| Ok(judged?.with_names(named?))).collect()
    }

    /// Names the unstable modes of this sector of some samples, of which its equation told all that is asked.
    pub fn known(&self, known: &[(Gain, Growing)], memory: &mut Memory) -> Vec<Result<Part, CeaError>> {
        let judged: Vec<Judged> = known.iter().map(|(_, growing)| Judged::known(growing)).collect();
        let lambdas: Vec<(Gain, Vec<Complex<f64>>)> =
            known.iter().zip(&judged).map(|((gain, _), judged)| (*gain, judged.lambdas())).collect();
        let named = self.named_at(&lambdas, memory);
        judged.into_iter().zip(named).map(|(judged, named)| Ok(judged.with_names(named?))).collect()
    }

    /// The modes with each of some gains at some eigenvalues, with their names; none without an equation.
    pub fn named_at(&self, of: &[(Gain, Vec<Complex<f64>>)], memory: &mut Memory) -> Vec<Result<Named, CeaError>> {
        let Some(Equation { secular, reference, .. }) = self.equation else { return Vec::new() };
        let Memory { work, spent, .. } = memory;
        let shaped = timed(&mut spent.shapes, || {
            let asked: Vec<_> = of.iter().map(|(gain, lambdas)| (*gain, &lambdas[..])).collect();
            let mut shaped = Vec::with_capacity(of.len());
            for (modes, (gain, lambdas)) in secular.modes(&asked, work).into_iter().zip(of) {
                shaped.push(match modes {
                    Some(modes) => Ok(modes),
                    None => Mode::at(&secular.system(gain), lambdas, work),
                });
            }
            shaped
        });
        let start = |&(from, _): &(Gain, _)| PathStart::Gain(GainPath { secular, from, to: reference });
        self.named(&of.iter().map(start).collect::<Vec<_>>(), shaped, memory)
    }

    fn named(
        &self,
        starts: &[PathStart<'_>],
        shaped: Vec<Result<Vec<Mode>, CeaError>>,
        memory: &mut Memory,
    ) -> Vec<Result<Named, CeaError>> {
        let Memory { work, spent, .. } = memory;
        let end = PathEnd { system: &self.reference.system, modes: &self.reference.modes };
        let modes = shaped.iter().map(|modes| modes.as_deref().unwrap_or_default());
        let paths: Vec<Path<'_>> =
            starts.iter().zip(modes).map(|(&start, start_modes)| Path { start, start_modes, end }).collect();
        let links = timed(&mut spent.names, || identify_all(self.spectra, &paths, work));
        let named = |(modes, links): (Result<Vec<Mode>, CeaError>, Result<Links, CeaError>)| {
            Ok(modes?.into_iter().zip(links?).map(|(mode, link)| (mode, self.reference.names_of(link))).collect())
        };
        shaped.into_iter().zip(links).map(named).collect()
    }
}

/// The modes of one system, with verdicts.
struct Judged {
    modes: Modes,
    /// Places of the unstable ones among the oscillating modes.
    unstable: Vec<usize>,
    undecided: u32,
}

impl Judged {
    fn known(Growing { modes, .. }: &Growing) -> Self {
        let unstable = modes.iter().enumerate().filter(|(_, lambda)| lambda.re > 0.0).map(|(index, _)| index).collect();
        let modes = Modes { oscillatory: modes.clone(), real: Vec::new(), internal: Vec::new() };
        Self { modes, unstable, undecided: 0 }
    }

    fn new(system: &SecondOrder, spectrum: &Spectrum, work: &mut Workspace) -> Result<Self, CeaError> {
        let modes = Modes::classify(system, spectrum, work)?;
        let (mut unstable, mut undecided) = (Vec::new(), 0);
        for (index, &lambda) in modes.oscillatory.iter().enumerate() {
            match verdict(system, lambda, spectrum.scale, work)? {
                Verdict::Unstable => unstable.push(index),
                Verdict::Marginal { .. } | Verdict::Undecided { .. } => undecided += 1,
                Verdict::Stable => {}
            }
        }
        Ok(Self { modes, unstable, undecided })
    }

    fn lambdas(&self) -> Vec<Complex<f64>> {
        self.unstable.iter().map(|&index| self.modes.oscillatory[index]).collect()
    }

    fn with_names(self, named: Named) -> Part {
        let mode = |(index, (mode, names))| Unstable { index, mode, names };
        let unstable = self.unstable.into_iter().zip(named).map(mode).collect();
        Part { modes: self.modes, unstable, undecided: self.undecided }
    }
}
