//! Some combinations, run together.

use std::time::Instant;

use squeal::Error;
use squeal::brakes::LatticeBrake;
use squeal::case::LatticeCase;
use squeal::montecarlo::{self, Sampling, Summary};
use squeal::report::{Judgement, Results, claims_judged};
use squeal::study::{ModeNaming, Study, StudyOptions, StudyTally, TwiceNamedTally, UncertainBrake as _};

use super::family::Family;
use super::row::{Card, Row};

/// How much is asked of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Few draws, judged by the values alone, on one thread.
    Coarse,
    /// Some more of the same.
    Second,
    /// All draws, judged by the limits too, on all cores.
    Full,
}

/// A row for each case. What several of them have in common is computed once.
pub fn run_together(cases: Vec<LatticeCase>, stage: Stage) -> Vec<Row> {
    let mut rows: Vec<Option<Row>> = cases.iter().map(|_| None).collect();
    let mut families: Vec<(Family, Vec<usize>)> = Vec::new();
    for (at, case) in cases.iter().enumerate() {
        match LatticeBrake::new(case.clone()) {
            Ok(brake) => join(&mut families, brake, at),
            Err(error) => rows[at] = Some(Row::refused(case.samples, &error)),
        }
    }
    for (family, places) in families {
        for (at, row) in places.into_iter().zip(of_family(family, stage)) {
            rows[at] = Some(row);
        }
    }
    rows.into_iter().flatten().collect()
}

/// Puts a brake in the first family that it is of, or in one of its own.
fn join(families: &mut Vec<(Family, Vec<usize>)>, brake: LatticeBrake, at: usize) {
    let mut brake = Box::new(brake);
    for (family, places) in families.iter_mut() {
        match family.add(brake) {
            Ok(()) => return places.push(at),
            Err(other) => brake = other,
        }
    }
    families.push((Family::new(*brake), vec![at]));
}

/// A row for each member. A family that cannot be studied is taken apart: one member may be the reason.
fn of_family(family: Family, stage: Stage) -> Vec<Row> {
    match rows(&family, stage) {
        Ok(rows) => rows,
        Err(error) if family.members().len() == 1 => vec![Row::refused(family.plan().samples, &error)],
        Err(_) => family.into_brakes().flat_map(|brake| of_family(Family::new(brake), stage)).collect(),
    }
}

fn rows(family: &Family, stage: Stage) -> Result<Vec<Row>, Error> {
    let (start, plan) = (Instant::now(), family.plan());
    let options = StudyOptions { certificates: stage == Stage::Full, likeness_too: true };
    let study = Study::with_options(family, &squeal::cea::BatchSolver, options)?;
    let threads = (stage != Stage::Full).then_some(1);
    let sampling = Sampling { block: 16, threads, ..Sampling::new(plan.seed, plan.samples) };
    let Summary { seed, first, samples, failures, tally } =
        montecarlo::run(&study, &sampling, || TwiceNamedTally::empty(plan))?;
    let summary = |tally: StudyTally| Summary { seed, first, samples, failures: failures.clone(), tally };
    let references = study.references_by_likeness().unwrap_or_default();
    let tracked = Results::new(&study, summary(tally.by_plan));
    let alike = Results::with_references(&study, &references, summary(tally.by_likeness));

    let mut rows = Vec::new();
    for (brake, laws) in family.members() {
        let (tracked, alike) = (tracked.of_laws(laws), alike.of_laws(laws));
        let card = |naming: &str, results: &Results<'_>| -> Result<Card, Error> {
            let by_value = claims_judged(results, brake, Judgement::ByValues)?;
            let by_limits = match stage {
                Stage::Coarse | Stage::Second => None,
                Stage::Full => Some(claims_judged(results, brake, Judgement::ByLimits)?),
            };
            Ok(Card::new(naming, &by_value, by_limits.as_deref()))
        };
        let cards = vec![
            card("tracked", &tracked)?,
            card("MAC", &alike)?,
            card("rank", &tracked.labelled(ModeNaming::Rank))?,
            card("pair", &tracked.labelled(ModeNaming::Pair))?,
        ];
        let of_member = plan.scenes.iter().zip(failures.by_scene()).filter(|(scene, _)| laws.contains(&scene.key.law));
        let failed = failures.draws() + of_member.map(|(_, failed)| failed).sum::<u64>();
        rows.push(Row { samples, failures: failed, seconds: 0.0, refused: None, cards });
    }
    let seconds = start.elapsed().as_secs_f64() / rows.len() as f64;
    rows.iter_mut().for_each(|row| row.seconds = seconds);
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readings::product::{AXES, Combination, product, read_tables};
    use squeal::study::ModeIdentity;

    /// Cases of the paper with eight and nine in contact, as the combinations that hold these answers say.
    fn cases(is_meant: impl Fn(&Combination) -> bool) -> Vec<LatticeCase> {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/paper.toml");
        let tables = read_tables(&path).unwrap();
        let case = |combination: &Combination| {
            let mut case = combination.case(&path, &tables).unwrap();
            case.samples = 6;
            case.panels.retain(|(number, _)| *number >= 8);
            case
        };
        product().iter().filter(|combination| is_meant(combination)).map(case).collect()
    }

    fn only(axes: &[&str]) -> impl Fn(&Combination) -> bool {
        let places: Vec<usize> =
            (0..AXES.len()).filter(|&i| axes.iter().any(|name| AXES[i].name.starts_with(name))).collect();
        move |combination| (0..AXES.len()).all(|i| combination.0[i] == 0 || places.contains(&i))
    }

    #[test]
    fn what_is_run_together_has_the_claims_that_it_has_alone() {
        for axes in [&["R8", "R9"][..], &["R8", "R4"]] {
            let cases = cases(only(axes));
            let together = run_together(cases.clone(), Stage::Coarse);
            assert_eq!(together.len(), cases.len());
            let mut distinct = Vec::new();
            for (case, row) in cases.into_iter().zip(&together) {
                let alone = run_together(vec![case], Stage::Coarse).remove(0);
                assert!(row.refused.is_none() && row.cards.len() == 4, "{row:?}");
                assert_eq!((&alone.cards, alone.failures), (&row.cards, row.failures));
                if !distinct.contains(&row.cards) {
                    distinct.push(row.cards.clone());
                }
            }
            // The answers tell the combinations apart, so that rows that were mixed up would have been seen.
            assert!(distinct.len() > together.len() / 2, "{} of {}", distinct.len(), together.len());
        }
    }

    #[test]
    fn names_by_likeness_are_those_of_a_study_that_knows_modes_by_them() {
        let mut case = cases(only(&[])).remove(0);
        let both = run_together(vec![case.clone()], Stage::Coarse).remove(0);
        case.readings.identity = ModeIdentity::Mac;
        let by_likeness = run_together(vec![case], Stage::Coarse).remove(0);
        assert_eq!(both.cards[1].claims, by_likeness.cards[0].claims);
        assert_ne!(both.cards[0].claims, by_likeness.cards[0].claims);
    }

    #[test]
    fn certificates_change_no_verdict() {
        let cases = cases(only(&[]));
        let [with, without] = [Stage::Full, Stage::Coarse].map(|stage| run_together(cases.clone(), stage).remove(0));
        for (with, without) in with.cards.iter().zip(&without.cards) {
            for (with, without) in with.claims.iter().zip(&without.claims) {
                assert_eq!((with.value, &with.by_value, with.mode), (without.value, &without.by_value, without.mode));
            }
        }
    }
}
