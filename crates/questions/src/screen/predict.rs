//! Prediction of the effect of changes, by a few draws in a few scenes: changes are ranked by it.

use std::sync::Arc;

use cea::{BatchSolver, CeaError, EigenSolver, Spectrum, Verdict, Workspace, real_count, verdicts_beyond};
use cycle::ContactSystem;
use linsys::{OperatingPoint, SecondOrder};
use montecarlo::{Progress, not_exceeded, stream};
use num_complex::Complex;
use rayon::prelude::*;
use serde::Serialize;
use study::{Configuration, ModifiablePlan, Plan, Scene, SceneKey, Symmetry, UncertainBrake, WholeContact};

use super::change::{Change, ChangedBrake};
use super::confirm::QUANTILE;
use super::modified::{inverse, modifiable_of};
use crate::Error;
use crate::cycles::{Following, UntilStopped, drawn_contacts_of, growth_outside, loudest, motions};

/// Number of arrangements of a panel that are analysed; chosen: the prediction only ranks.
const ARRANGEMENTS_PER_PANEL: usize = 2;
/// Number of times that as many draws as are wanted are drawn, before there are as many with operating points; chosen: with half of them, two do.
const MOST_ROUNDS: u64 = 8;

/// Prediction for a brake with some changes: means over the analyses of a few draws.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Prediction {
    /// Number of unstable modes and divergences in one analysis.
    pub unstable: f64,
    /// Sum of their growth rates, 1/s.
    pub growth: f64,
    /// Fraction of the analyses with any of them.
    pub squealing: f64,
    /// Quantile at 95 %, over the draws, of the largest growth rate in any analysis of a draw, 1/s; 0 where nothing grows.
    pub growth_quantile: f64,
    /// Quantile at 95 %, over the draws, of the loudness of the loudest motion in any analysis of a draw, m/s, infinite where a motion cannot be
    /// followed; `None` where it is not asked for.
    pub loudness_quantile: Option<f64>,
}

/// What a probe says of a brake with some changes: means over the draws, and the largest growth rate and loudness of each, 1/s and m/s.
struct Answer {
    unstable: f64,
    growth: f64,
    squealing: f64,
    fastest: Vec<f64>,
    loudest: Vec<f64>,
}

/// Draws, and their operating points scene by scene.
type Solvable<S> = (Vec<S>, Vec<Vec<OperatingPoint>>);

/// Draws that have an operating point in each of these scenes. Draws that have none are passed over: the prediction ranks changes,
/// and what fails is counted where changes are confirmed.
fn solvable<B: UncertainBrake>(brake: &B, scenes: &[&Scene], draws: u64) -> Result<Solvable<B::Sample>, study::Error> {
    let (mut samples, mut points, mut failed) = (Vec::new(), vec![Vec::new(); scenes.len()], None);
    for round in 0..MOST_ROUNDS {
        // Streams from the other end than the streams of the samples of a study.
        let indices = (round * draws..(round + 1) * draws).map(|draw| u64::MAX - draw);
        let drawn = indices.map(|index| brake.draw(&mut stream(brake.plan().seed, index)));
        let drawn: Vec<B::Sample> =
            drawn.filter_map(|sample| sample.map_err(|error| failed = Some(error)).ok()).collect();
        let refs: Vec<&B::Sample> = drawn.iter().collect();
        let mut found: Vec<_> = scenes.iter().map(|scene| brake.operating_points(scene, &refs).into_iter()).collect();
        for sample in drawn {
            // One of each scene, so that all go on.
            let own: Vec<_> = found.iter_mut().filter_map(Iterator::next).collect();
            match own.into_iter().collect::<Result<Vec<_>, _>>() {
                Ok(own) if (samples.len() as u64) < draws => {
                    samples.push(sample);
                    points.iter_mut().zip(own).for_each(|(of_scene, point)| of_scene.push(point));
                }
                Ok(_) => {}
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        if samples.len() as u64 == draws {
            return Ok((samples, points));
        }
    }
    failed.map_or(Ok((samples, points)), Err)
}

/// Analyses of a brake, a few, on which sets of changes are compared.
pub(super) struct Probes<'a> {
    plan: &'a Plan,
    probes: Vec<Probe<'a>>,
    /// Number of draws of each probe.
    pub draws: u64,
    /// Settings by which motions are followed, where loudness is asked for.
    following: Option<UntilStopped>,
}

/// Probe: one arrangement of a scene, with the operating points of all draws.
struct Probe<'a> {
    configuration: &'a Configuration,
    contacts: Vec<WholeContact>,
    /// Symmetry that maps changes of the arrangement to changes of the configuration that is computed.
    symmetry: Option<Symmetry>,
    points: Vec<OperatingPoint>,
    /// Equations of motion of all draws, without changes, where loudness is asked for; `None` for a draw whose contacts have no equations of motion.
    motions: Vec<Option<ContactSystem>>,
    /// Error of the eigenvalues, relative, where the brake is reduced.
    error: f64,
    /// Fraction of all analyses of the plan that the probe stands for.
    weight: f64,
}

impl<'a> Probes<'a> {
    /// Probes: two arrangements of each panel of a set of constraints, with the same draws, which are not draws of the study.
    ///
    /// # Errors
    /// No draws with an operating point in all scenes; where motions are to be followed, a brake that does not give its contacts.
    pub fn new<B: UncertainBrake>(
        brake: &'a B,
        constraints: usize,
        draws: u64,
        following: Option<UntilStopped>,
    ) -> Result<Self, Error> {
        let plan = brake.plan();
        let by_plan = ModifiablePlan(plan);
        let modifiable = modifiable_of(brake, &by_plan)?;
        let symmetries = modifiable.symmetries(constraints);
        let mut panels: Vec<(SceneKey, Vec<(&Scene, usize)>)> = Vec::new();
        for scene in plan.scenes.iter().filter(|scene| scene.key.constraints == constraints) {
            let members = (0..scene.members.len()).map(|at| (scene, at));
            match panels.iter_mut().find(|(key, _)| *key == scene.key) {
                Some((_, list)) => list.extend(members),
                None => panels.push((scene.key, members.collect())),
            }
        }
        let mut taken: Vec<(&Scene, usize, f64)> = Vec::new();
        for (key, members) in &mut panels {
            members.sort_by_key(|(scene, at)| scene.members[*at]);
            let count = members.len().min(ARRANGEMENTS_PER_PANEL);
            let weight = (plan.speeds_of(*key) * members.len()) as f64 / count as f64;
            taken.extend(
                (0..count).map(|nth| members[nth * members.len() / count]).map(|(scene, at)| (scene, at, weight)),
            );
        }
        let scenes: Vec<&Scene> = taken.iter().map(|(scene, ..)| *scene).collect();
        let (samples, points) = solvable(brake, &scenes, draws)?;
        let mut probes = Vec::new();
        for ((scene, at, weight), points) in taken.into_iter().zip(points) {
            let motions = match &following {
                Some((Following { stick, .. }, _)) => {
                    let contacts = drawn_contacts_of(brake)?;
                    samples.iter().map(|sample| contacts.contact_system_of(scene, sample, *stick).ok()).collect()
                }
                None => Vec::new(),
            };
            probes.push(Probe {
                configuration: plan.configuration(scene),
                contacts: modifiable.contacts(scene),
                symmetry: symmetries.get(modifiable.symmetry_of_member(scene, at)).map(inverse),
                points,
                motions,
                error: brake.error_of_reduction(scene),
                weight,
            });
        }
        let all: f64 = probes.iter().map(|probe| probe.weight).sum();
        probes.iter_mut().for_each(|probe| probe.weight /= all);
        Ok(Self { plan, probes, draws, following })
    }

    /// Number of analyses that one set of changes takes.
    pub fn analyses(&self) -> u64 {
        self.draws * self.probes.len() as u64
    }

    /// The prediction of each of some sets of changes, given by its images as for [`Probes::prediction`]; progress advances by one for each.
    pub fn predictions(&self, sets: &[Vec<Vec<Change>>], progress: &dyn Progress) -> Vec<Result<Prediction, Error>> {
        let of_set = |images: &Vec<Vec<Change>>| {
            progress.go_on()?;
            let found = self.prediction(images);
            progress.advance(1);
            found
        };
        sets.par_iter().map(of_set).collect()
    }

    /// The prediction of one set of changes, given by its images under the symmetries of the brake. The arrangements of the probes are not symmetric, so that images differ in
    /// them: the draws have one after the other, and means are over all that they have.
    pub fn prediction(&self, images: &[Vec<Change>]) -> Result<Prediction, Error> {
        let (mut sum, mut work) = (Prediction::default(), Workspace::default());
        let mut fastest = vec![0.0; self.draws as usize];
        let mut loudest = fastest.clone();
        for (number, probe) in self.probes.iter().enumerate() {
            let found = probe.answer((images, number), (self.plan, self.following.as_ref()), &mut work)?;
            sum.unstable += probe.weight * found.unstable;
            sum.growth += probe.weight * found.growth;
            sum.squealing += probe.weight * found.squealing;
            fastest.iter_mut().zip(&found.fastest).for_each(|(all, of_probe)| *all = of_probe.max(*all));
            loudest.iter_mut().zip(&found.loudest).for_each(|(all, of_probe)| *all = of_probe.max(*all));
        }
        fastest.sort_by(f64::total_cmp);
        loudest.sort_by(f64::total_cmp);
        let loudness_quantile = self.following.as_ref().map(|_| not_exceeded(&loudest, QUANTILE)).transpose()?;
        Ok(Prediction { growth_quantile: not_exceeded(&fastest, QUANTILE)?, loudness_quantile, ..sum })
    }
}

impl Probe<'_> {
    /// The answer for a set of changes by its `images`, of which the draws have one after the other, from that with the number `first` on.
    fn answer(
        &self,
        (images, first): (&[Vec<Change>], usize),
        (plan, following): (&Plan, Option<&UntilStopped>),
        work: &mut Workspace,
    ) -> Result<Answer, Error> {
        let changed = |image: &Vec<Change>| {
            let changes: Vec<Change> = match &self.symmetry {
                Some(symmetry) => image.iter().map(|change| change.image(symmetry)).collect(),
                None => image.clone(),
            };
            ChangedBrake::new(&self.configuration.brake, &self.contacts, &changes)
        };
        let in_turn = images.iter().cycle().skip(first).take(images.len().min(self.points.len()));
        let changed = in_turn.map(changed).collect::<Result<Vec<_>, _>>()?;
        let changed: Vec<&ChangedBrake> = changed.iter().cycle().take(self.points.len()).collect();
        let (mut whole, mut sectors) = (SecondOrder::zeros(1, 0), Vec::new());
        for (at, (point, changed)) in self.points.iter().zip(&changed).enumerate() {
            let brake = &changed.brake;
            let mut systems = vec![SecondOrder::zeros(1, 0); brake.sectors.iter().count()];
            let point = changed.point(point.clone());
            brake.sectors.assemble_into(&brake.system, &point, &mut whole, systems.iter_mut())?;
            sectors.extend(systems.into_iter().enumerate().map(|(sector, system)| (sector, at, system)));
        }
        // Systems of one shape are solved together.
        let shape =
            |(sector, _, system): &(usize, usize, SecondOrder)| (*sector, system.order(), system.internal.decay.len());
        sectors.sort_by_key(shape);
        let (mut unstable, mut growth, mut fastest) = (0, 0.0, vec![0.0; self.points.len()]);
        let mut growing_of_draws: Vec<Vec<Complex<f64>>> = vec![Vec::new(); self.points.len()];
        let mut grows_outside = vec![false; self.points.len()];
        for alike in sectors.chunk_by(|a, b| shape(a) == shape(b)) {
            let systems: Vec<SecondOrder> = alike.iter().map(|(.., system)| system.clone()).collect();
            let mut spectra: Vec<Result<Spectrum, CeaError>> = Vec::new();
            BatchSolver.eigenvalues_of_all(&systems, work, &mut spectra);
            for ((_, at, system), spectrum) in alike.iter().zip(spectra) {
                let spectrum = spectrum?;
                grows_outside[*at] |=
                    plan.band.is_some() && growth_outside(plan, self.error, &spectrum.eigenvalues).is_some();
                // A sign alone says nothing near the axis.
                let may_count = |lambda: &Complex<f64>| {
                    lambda.im >= 0.0 && plan.threshold.margin(*lambda) > 0.0 && plan.is_studied(*lambda)
                };
                let growing: Vec<Complex<f64>> = spectrum.eigenvalues.iter().copied().filter(may_count).collect();
                let verdicts = verdicts_beyond(&plan.threshold, system, &growing, &spectrum, work)?;
                for (lambda, _) in growing.iter().zip(verdicts).filter(|(_, verdict)| *verdict == Verdict::Unstable) {
                    let count = real_count(*lambda).max(1);
                    unstable += count;
                    growth += count as f64 * lambda.re;
                    fastest[*at] = lambda.re.max(fastest[*at]);
                    growing_of_draws[*at].push(*lambda);
                }
            }
        }
        let (draws, squealing) = (self.points.len() as f64, fastest.iter().filter(|&&growth| growth > 0.0).count());
        let [unstable, squealing] = [unstable, squealing].map(|count| count as f64 / draws);
        let loudest = match following {
            Some(following) => self.loudest(&changed, (&growing_of_draws, &grows_outside), plan, following)?,
            None => vec![0.0; self.points.len()],
        };
        Ok(Answer { unstable, growth: growth / draws, squealing, fastest, loudest })
    }

    /// Loudness of the loudest motion of each draw, from its growing eigenvalues, m/s; one that grows outside the band of a reduced brake too is not followed.
    fn loudest(
        &self,
        changed: &[&ChangedBrake],
        (growing_of_draws, grows_outside): (&[Vec<Complex<f64>>], &[bool]),
        plan: &Plan,
        (following, stop): &UntilStopped,
    ) -> Result<Vec<f64>, Error> {
        let of_draw = |(at, growing): (usize, &Vec<Complex<f64>>)| -> Result<f64, Error> {
            if growing.is_empty() {
                return Ok(0.0);
            }
            // What diverges has no mode to be followed from.
            let unchanged = self.motions[at].as_ref();
            let unchanged = unchanged.filter(|_| !grows_outside[at] && growing.iter().all(|lambda| lambda.im != 0.0));
            let Some(unchanged) = unchanged else { return Ok(f64::INFINITY) };
            let changed = changed[at];
            let point = changed.point(self.points[at].clone());
            let system = changed.motion((&self.configuration.brake, unchanged), &point).map_err(Error::from);
            let system = system.map(|system| system.until(Arc::clone(stop)));
            let of_cea = changed.brake.system.assemble(&point)?;
            Ok(loudest(&motions(system, &of_cea, growing, (plan, &changed.brake), following)?))
        };
        growing_of_draws.par_iter().enumerate().map(of_draw).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use brakes::case::CaseFile;
    use brakes::{AnyBrake, Purpose};

    use super::*;
    use crate::screen::candidates::{Candidates, ChangeKind, Sizes};

    /// The paper's lattice with one contact of nine: in the two arrangements of a panel, whose contacts are 1 and 5, holding one corner is another thing than holding another. What is
    /// predicted of the set is the mean over them, whichever of them it is asked by.
    #[test]
    fn a_prediction_is_the_mean_over_the_images_of_a_set() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml");
        let text = std::fs::read_to_string(&path).unwrap();
        let begin = text.find("\nin_contact = ").unwrap() + 1;
        let end = begin + text[begin..].find('\n').unwrap();
        let text = format!("{}in_contact = [1]{}", &text[..begin], &text[end..]);
        let brake: AnyBrake = brakes::make(CaseFile::parse(&path, text).unwrap(), Purpose::Screen, &()).unwrap();
        let all = Candidates::all(&brake, 0, &[ChangeKind::Constraint], &Sizes::default()).unwrap().remove(0);
        let single = |name: &str| all.singles.iter().position(|single| single.name == name).unwrap();
        let corners = ["x1", "x3", "x7", "x9"].map(|name| vec![single(name)]);
        for corner in &corners {
            assert_eq!((all.images_of(corner), all.representative(corner)), (corners.to_vec(), corners[0].clone()));
        }
        let probes = Probes::new(&brake, 0, 64, None).unwrap();
        let of = |images: &[Vec<usize>]| {
            let images: Vec<Vec<Change>> = images.iter().map(|image| all.changes(image)).collect();
            probes.prediction(&images).unwrap()
        };
        let alone = corners.each_ref().map(|corner| of(std::slice::from_ref(corner)).growth);
        let mean = alone.iter().sum::<f64>() / 4.0;
        let together = of(&corners).growth;
        println!("{alone:?} {mean} {together}");
        let off = |value: f64| (value / mean - 1.0).abs();
        assert!(off(alone[0]) > 0.1 && off(together) < 0.25 * off(alone[0]), "{alone:?}, {mean}: {together}");
    }
}
