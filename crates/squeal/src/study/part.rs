//! What one sector of a block of samples says: verdicts on its modes, shapes and names of those that are unstable.

use cea::{
    CeaError, EigenSolver, Gain, Growing, Line, Links, Mode, Modes, Pilots, Secular, Spectrum, Verdict, Way, Workspace,
    identify_all, verdict,
};
use linsys::SecondOrder;
use num_complex::Complex;

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
    pub pilots: &'a Pilots,
    /// The gain of the reference.
    pub reference: Gain,
}

impl Solver<'_> {
    /// Names the unstable modes of `systems`, this sector of some samples. What is not `known` of the modes of a system is
    /// solved for.
    pub fn solve(&self, systems: &[SecondOrder], known: &[Known], memory: &mut Memory) -> Vec<Result<Part, CeaError>> {
        let is_unknown = known.iter().all(Option::is_none);
        // Friction does not reach every sector: where it does not, all samples are one.
        if let ([first, others @ ..], true) = (systems, is_unknown)
            && !others.is_empty()
            && others.iter().all(|other| other == first)
        {
            let part = self.solve(std::slice::from_ref(first), &[None], memory).remove(0);
            return vec![part; systems.len()];
        }
        let Memory { spectra, work, spent } = memory;
        let judged: Vec<Result<Judged, CeaError>> = timed(&mut spent.spectra, || {
            if !is_unknown {
                let judge = |(system, known): (&SecondOrder, &Known)| match known {
                    Some((_, known)) => Ok(Judged::known(known)),
                    None => Judged::new(system, &self.spectra.eigenvalues(system, work)?, work),
                };
                return systems.iter().zip(known).map(judge).collect();
            }
            self.spectra.eigenvalues_of_all(systems, work, spectra);
            let judge = |(system, spectrum): (&SecondOrder, &Result<Spectrum, CeaError>)| {
                Judged::new(system, spectrum.as_ref().map_err(CeaError::clone)?, work)
            };
            systems.iter().zip(&*spectra).map(judge).collect()
        });

        let lambdas: Vec<Vec<Complex<f64>>> =
            judged.iter().map(|judged| judged.as_ref().map(Judged::lambdas).unwrap_or_default()).collect();
        let gains: Vec<Option<Gain>> = known.iter().map(|known| known.as_ref().map(|(gain, _)| *gain)).collect();
        let named = self.named(systems, &gains, &lambdas, memory);
        judged.into_iter().zip(named).map(|(judged, named)| Ok(judged?.with_names(named?))).collect()
    }

    /// The modes of each system at some of its eigenvalues, with their names; cheaper where the gain is known.
    pub fn named(
        &self,
        systems: &[SecondOrder],
        gains: &[Option<Gain>],
        lambdas: &[Vec<Complex<f64>>],
        memory: &mut Memory,
    ) -> Vec<Result<Named, CeaError>> {
        let Memory { work, spent, .. } = memory;
        let shaped = timed(&mut spent.shapes, || self.shapes(systems, gains, lambdas, work));
        let to = (&self.reference.system, &self.reference.modes[..]);
        let each = systems.iter().zip(&shaped).zip(gains);
        let ways = each.map(|((system, modes), gain)| Way {
            from: (system, modes.as_deref().unwrap_or_default()),
            to,
            line: gain.zip(self.equation).map(|(from, Equation { secular, reference, .. })| Line {
                secular,
                from,
                to: reference,
            }),
        });
        let ways: Vec<Way<'_>> = ways.collect();
        let links = timed(&mut spent.names, || identify_all(self.spectra, &ways, work));
        let named = |(modes, links): (Result<Vec<Mode>, CeaError>, Result<Links, CeaError>)| {
            Ok(modes?.into_iter().zip(links?).map(|(mode, link)| (mode, self.reference.names_of(link))).collect())
        };
        shaped.into_iter().zip(links).map(named).collect()
    }

    fn shapes(
        &self,
        systems: &[SecondOrder],
        gains: &[Option<Gain>],
        lambdas: &[Vec<Complex<f64>>],
        work: &mut Workspace,
    ) -> Vec<Result<Vec<Mode>, CeaError>> {
        let asked = systems.iter().zip(lambdas).zip(gains);
        let known: Vec<_> =
            asked.clone().filter_map(|((system, lambdas), gain)| Some((system, (*gain)?, &lambdas[..]))).collect();
        let found = self.equation.map(|equation| equation.secular.modes(&known, work)).unwrap_or_default();
        let mut found = found.into_iter();
        let mut shaped: Vec<Option<Result<Vec<Mode>, CeaError>>> =
            gains.iter().map(|gain| gain.and_then(|_| found.next().flatten()).map(Ok)).collect();
        let left = shaped.iter().zip(asked).filter(|(shaped, _)| shaped.is_none());
        let left: Vec<_> = left.map(|(_, ((system, lambdas), _))| (system, &lambdas[..])).collect();
        let mut found = Mode::of_all(&left, work).into_iter();
        shaped.iter_mut().filter(|shaped| shaped.is_none()).for_each(|shaped| *shaped = found.next());
        shaped.into_iter().flatten().collect()
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
