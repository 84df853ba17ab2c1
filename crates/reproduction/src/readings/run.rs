//! Runs of combinations, several together.

use std::time::Instant;

use brakes::LatticeBrake;
use brakes::case::LatticeCase;
use squeal::montecarlo::{self, Sampling, Summary};
use squeal::results::Results;
use squeal::study::{ModeIdentity, ModeNaming, Study, StudyOptions, StudyTally, TwiceNamedTally, UncertainBrake as _};

use super::family::Family;
use super::product::COUNTINGS;
use super::row::{BY_MAC, BY_RANK, Card, Row, TRACKED};
use crate::{Error, Judgement, Subject, claims_judged};

/// Extent of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Few draws, judged by the values alone, on one thread.
    Coarse,
    /// More draws, judged by the values alone too, on one thread.
    Second,
    /// The full number of draws, judged by the limits too, on all cores.
    Full,
}

/// A row for each case. What several of them have in common is computed once.
pub fn run_together(cases: Vec<LatticeCase>, stage: Stage) -> Vec<Row> {
    let mut rows: Vec<Option<Row>> = cases.iter().map(|_| None).collect();
    let mut families: Vec<(Family, Vec<usize>)> = Vec::new();
    for (at, case) in cases.iter().enumerate() {
        match LatticeBrake::new(case.clone()) {
            Ok(brake) => join(&mut families, brake, at),
            Err(error) => rows[at] = Some(Row::refused(case.header.samples, &error.into())),
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
    let mut options = StudyOptions::default();
    options.certificates = stage == Stage::Full;
    options.likeness_too = plan.mode_identity == ModeIdentity::Continuation;
    let study = Study::with_options(family, &squeal::cea::BatchSolver, options, &())?;
    let threads = (stage != Stage::Full).then_some(1);
    let sampling = Sampling { block: 16, threads, ..Sampling::new(plan.seed, plan.samples) };
    let Summary { seed, first, samples, failures, tally } =
        montecarlo::run(&study, &sampling, || TwiceNamedTally::empty(plan))?;
    let summary = |tally: StudyTally| Summary { seed, first, samples, failures: failures.clone(), tally };
    let references = study.references_by_likeness().unwrap_or_default();
    let by_plan = Results::new(&study, summary(tally.by_plan));
    let by_likeness = match plan.mode_identity {
        ModeIdentity::Continuation => {
            Some(Results::with_references(&study, references.into(), summary(tally.by_likeness)))
        }
        ModeIdentity::Mac => None,
    };

    let mut rows = Vec::new();
    for (brake, laws) in family.members() {
        let by_plan = by_plan.of_laws(laws);
        let by_rank = by_plan.labelled(ModeNaming::Rank);
        let named = match &by_likeness {
            Some(by_likeness) => vec![(TRACKED, by_plan), (BY_MAC, by_likeness.of_laws(laws)), (BY_RANK, by_rank)],
            None => vec![(BY_MAC, by_plan), (BY_RANK, by_rank)],
        };
        let mut cards = Vec::new();
        for subject in std::iter::once(Subject::Found).chain(COUNTINGS.map(Subject::Numbered)) {
            for (naming, results) in &named {
                let claims = |judgement| claims_judged(results, brake, judgement, subject);
                let by_value = claims(Judgement::ByValues)?;
                let by_limits = match stage {
                    Stage::Coarse | Stage::Second => None,
                    Stage::Full => Some(claims(Judgement::ByLimits)?),
                };
                cards.push(Card::new(naming, subject, &by_value, by_limits.as_deref()));
            }
        }
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

    /// Cases of the paper with the numbers `in_contact`: all answers to `questions`, the case's own to the others.
    fn cases(questions: &[&str], in_contact: [usize; 2]) -> Vec<LatticeCase> {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml");
        let tables = read_tables(&path).unwrap();
        let is_asked = |i: usize| questions.iter().any(|name| AXES[i].name.starts_with(name));
        let is_meant = |combination: &&Combination| (0..AXES.len()).all(|i| combination.0[i] == 0 || is_asked(i));
        let case = |combination: &Combination| {
            let mut case = combination.case(&path, &tables).unwrap();
            case.header.samples = 6;
            case.panels.retain(|(number, _)| in_contact.contains(number));
            case
        };
        product().iter().filter(is_meant).map(case).collect()
    }

    #[test]
    fn what_is_run_together_has_the_claims_that_it_has_alone() {
        for identity in [ModeIdentity::Continuation, ModeIdentity::Mac] {
            let mut cases = cases(&["R8", "R9"], [9, 8]);
            cases.iter_mut().for_each(|case| case.readings.identity = identity);
            assert_eq!(cases.len(), 9);
            let together = run_together(cases.clone(), Stage::Coarse);
            let mut distinct = Vec::new();
            for (case, row) in cases.into_iter().zip(&together) {
                let alone = run_together(vec![case], Stage::Coarse).remove(0);
                assert_eq!(row.refused, None);
                assert_eq!((&alone.cards, alone.failures), (&row.cards, row.failures));
                if !distinct.contains(&row.cards) {
                    distinct.push(row.cards.clone());
                }
            }
            // Rows that were mixed up would have been seen.
            assert!(distinct.len() > 6, "{}", distinct.len());
        }
    }

    #[test]
    fn names_by_likeness_are_those_of_a_study_that_knows_modes_by_them() {
        let mut case = cases(&[], [9, 6]).remove(0);
        let claims = |row: &Row, naming: &str| -> Vec<_> {
            row.cards.iter().find(|card| card.naming == naming).unwrap().claims.clone()
        };
        let both = run_together(vec![case.clone()], Stage::Coarse).remove(0);
        case.readings.identity = ModeIdentity::Mac;
        let by_likeness = run_together(vec![case], Stage::Coarse).remove(0);
        assert_eq!((both.cards.len(), by_likeness.cards.len()), (15, 10));
        assert_eq!(claims(&both, BY_MAC), claims(&by_likeness, BY_MAC));
        assert_ne!(claims(&both, TRACKED), claims(&both, BY_MAC));
    }

    #[test]
    fn certificates_change_no_verdict() {
        let cases = cases(&[], [9, 8]);
        let [with, without] = [Stage::Full, Stage::Coarse].map(|stage| run_together(cases.clone(), stage).remove(0));
        for (with, without) in with.cards.iter().zip(&without.cards) {
            for (with, without) in with.claims.iter().zip(&without.claims) {
                assert_eq!((with.value, &with.by_value, with.mode), (without.value, &without.by_value, without.mode));
                assert!(!with.holds.is_empty() && without.holds.is_empty());
            }
        }
    }
}
