//! Studies side by side: by how much each mode is unstable more or less often in one than in another.
//!
//! A study is the folder of a finished run. What has the same names of constraints, law, speed and contacts is compared; modes are linked by
//! their shapes (`links.rs`). How sure a difference is depends on what the folders hold: with kept samples it is taken sample by sample, so
//! that what the draws have in common cancels; without them the same seed still makes both depend on each other, in a way that nobody
//! counted, and the limits allow for any.

mod folder;
mod kept;
mod links;
mod text;

use std::path::{Path, PathBuf};

use montecarlo::{
    Confidence, Difference, Interval, PairedTrials, Proportion, dependent_difference, independent_difference,
};
use output::Table;

use crate::Error;
use folder::{Occurrences, SceneNames, StudyFolder};
use kept::{Kept, Question};
use links::{Link, LinkedBy, links};

/// Pairing of the samples from which the interval of a difference was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pairing {
    /// Sample by sample, of kept samples of the same seed.
    Paired,
    /// Of samples of different seeds, which are independent.
    Independent,
    /// Of the same seed without kept samples: for any dependence of the two.
    AnyDependence,
}

impl Pairing {
    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Paired => "paired",
            Self::Independent => "independent",
            Self::AnyDependence => "any dependence",
        }
    }
}

/// A mode, or anything at all, in two studies.
#[derive(Debug, Clone)]
pub struct Compared {
    /// Constraints, law, speed, number in contact and arrangement.
    pub scene: SceneNames,
    /// Link of the mode of the first study to the mode of the second; `None` for anything that is unstable, whichever mode it is.
    pub link: Option<Link>,
    /// Occurrence in the first study, and in the second; `None` where the mode is linked to no mode there.
    pub occurrences: [Option<Proportion>; 2],
    /// Difference, the second less the first; `None` of a mode without a link.
    pub difference: Option<(Difference, Pairing)>,
}

/// A study against the first one.
#[derive(Debug)]
pub struct Against {
    /// Folder of the study.
    pub path: PathBuf,
    /// Words on what both are: samples, seeds, which draws agree, scenes that only one has.
    pub notes: Vec<String>,
    /// Rows of the comparison: a mode each, and anything at all.
    pub rows: Vec<Compared>,
}

/// Studies against the first of them.
#[derive(Debug)]
pub struct ComparedStudies {
    /// Folder of the first study.
    pub first: PathBuf,
    /// Each other study against it.
    pub others: Vec<Against>,
    /// Identities of the studies, in a line.
    pub identity: String,
}

/// Comparison of the studies in `folders` with the first of them.
///
/// # Errors
/// [`Error::NotComparable`] for a folder that holds no finished study, another threshold or band than the first one, or no scene with the
/// same names.
pub fn compare(folders: &[PathBuf]) -> Result<ComparedStudies, Error> {
    let studies = folders.iter().map(|path| StudyFolder::read(path)).collect::<Result<Vec<_>, _>>()?;
    let Some((first, others)) = studies.split_first().filter(|(_, others)| !others.is_empty()) else {
        let (value, allowed) = (folders.len().to_string(), "two folders or more".into());
        return Err(Error::Argument { argument: "studies", value, allowed });
    };
    let identities: Vec<&str> = studies.iter().map(|study| study.identity.as_str()).collect();
    let others = others.iter().map(|other| against(first, other)).collect::<Result<_, _>>()?;
    Ok(ComparedStudies { first: first.path.clone(), others, identity: format!("compared: {}", identities.join("; ")) })
}

/// Refuses studies that count different things.
fn check_comparable(first: &StudyFolder, other: &StudyFolder) -> Result<(), Error> {
    for (what, of_first, of_other) in
        [("threshold", &first.threshold, &other.threshold), ("band", &first.band, &other.band)]
    {
        if of_first != of_other {
            let words = |of: &Option<String>| of.clone().unwrap_or_else(|| "none".into());
            let found =
                format!("its {what} is {}, that of {} is {}", words(of_other), first.path.display(), words(of_first));
            return Err(other.not_comparable(found));
        }
    }
    Ok(())
}

fn against(first: &StudyFolder, other: &StudyFolder) -> Result<Against, Error> {
    check_comparable(first, other)?;
    let is_of_both = |scene: &SceneNames| first.scenes.contains_key(scene) && other.scenes.contains_key(scene);
    let mut rows = Vec::new();
    for (scene, of_first) in &first.scenes {
        let Some(of_other) = other.scenes.get(scene) else { continue };
        let kept = first.kept.get(scene).zip(other.kept.get(scene)).filter(|_| first.seed == other.seed);
        let compared = Scene { studies: [first, other], scene, occurrences: [of_first, of_other], kept };
        rows.extend(compared.anything());
        let set = &scene[0];
        rows.extend(
            links(first.modes.get(set), other.modes.get(set)).into_iter().filter_map(|link| compared.mode(link)),
        );
    }
    if rows.is_empty() {
        let names = |study: &StudyFolder| study.scenes.keys().next().map_or_else(String::new, |scene| scene.join(", "));
        let found =
            format!("it has no scene of {}: here {}, there {}", first.path.display(), names(other), names(first));
        return Err(other.not_comparable(found));
    }
    let mut notes = vec![draws_in_words(first, other)];
    for (study, counterpart) in [(first, other), (other, first)] {
        let alone = study.scenes.keys().filter(|scene| !is_of_both(scene)).count();
        if alone > 0 {
            let (path, there) = (study.path.display(), counterpart.path.display());
            notes.push(format!(
                "{alone} of {} scenes of {path} are not in {there}, and not compared",
                study.scenes.len()
            ));
        }
    }
    for study in [first, other].into_iter().filter(|study| !study.tells_open) {
        notes.push(format!(
            "{} was made by an earlier program, whose samples do not tell which verdicts are open: they count as stable in `any`",
            study.path.display()
        ));
    }
    if first.program != other.program {
        notes.push(format!("they were made by different programs: {} and {}", first.program, other.program));
    }
    Ok(Against { path: other.path.clone(), notes, rows })
}

/// Words on how far two studies have the same draws.
fn draws_in_words(first: &StudyFolder, other: &StudyFolder) -> String {
    let counts = if first.samples == other.samples {
        format!("{} samples each", first.samples)
    } else {
        format!("{} and {} samples", first.samples, other.samples)
    };
    if first.seed != other.seed {
        return format!("{counts}, seeds {} and {}: independent draws", first.seed, other.seed);
    }
    if first.kept.is_empty() || other.kept.is_empty() {
        return format!(
            "{counts}, seed {}; no samples were kept, so that the limits are wide: --keep-samples makes them those of pairs",
            first.seed
        );
    }
    let [same, others] = first.draws_in_common(other);
    let listed = |names: &[String]| if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
    format!("{counts}, seed {}, in pairs; drawn alike: {}; not alike: {}", first.seed, listed(&same), listed(&others))
}

/// A scene of two studies.
struct Scene<'a> {
    studies: [&'a StudyFolder; 2],
    scene: &'a SceneNames,
    occurrences: [&'a Occurrences; 2],
    kept: Option<(&'a Kept, &'a Kept)>,
}

impl Scene<'_> {
    /// Anything that is unstable, where samples were kept or the scene is a panel by itself.
    fn anything(&self) -> Option<Compared> {
        if let Some(pairs) = self.pairs(Question::Anything, Question::Anything) {
            return Some(self.paired(None, &pairs));
        }
        let [first, second] = self.occurrences.map(|of| of.any);
        let difference = Some(self.counted(&first?, &second?));
        Some(Compared { scene: self.scene.clone(), link: None, occurrences: [first, second], difference })
    }

    /// Difference of two occurrences whose samples were not kept.
    fn counted(&self, first: &Proportion, second: &Proportion) -> (Difference, Pairing) {
        match self.studies[0].seed == self.studies[1].seed {
            true => (dependent_difference(first, second, Confidence::P95), Pairing::AnyDependence),
            false => (independent_difference(first, second, Confidence::P95), Pairing::Independent),
        }
    }

    /// A mode: where its samples were kept, and give the counts of the study, in pairs.
    fn mode(&self, link: Link) -> Option<Compared> {
        let counted = |at: usize| Some(self.occurrences[at].of(link.modes[at].as_ref()?, self.studies[at].samples));
        let found = [counted(0), counted(1)];
        if found.iter().flatten().all(|of| of.hits() + of.ambiguous() == 0) {
            return None;
        }
        if let [Some(first), Some(second)] = &link.modes {
            let is_kept = self.is_kept(0, first, found[0]) && self.is_kept(1, second, found[1]);
            if let Some(pairs) = self.pairs(Question::Mode(first), Question::Mode(second)).filter(|_| is_kept) {
                return Some(self.paired(Some(link), &pairs));
            }
        }
        let [first, second] = &found;
        let difference = first.as_ref().zip(second.as_ref()).map(|(first, second)| self.counted(first, second));
        Some(Compared { scene: self.scene.clone(), link: Some(link), occurrences: found, difference })
    }

    fn paired(&self, link: Option<Link>, pairs: &PairedTrials) -> Compared {
        let occurrences = pairs.proportions().map(Some);
        let difference = Some((pairs.difference(Confidence::P95), Pairing::Paired));
        Compared { scene: self.scene.clone(), link, occurrences, difference }
    }

    /// Answers of the samples that both studies have, in pairs.
    fn pairs(&self, first: Question<'_>, second: Question<'_>) -> Option<PairedTrials> {
        let (of_first, of_second) = self.kept?;
        let mut pairs = PairedTrials::default();
        for index in 0..self.studies[0].samples.min(self.studies[1].samples) {
            pairs.record(of_first.trial(index, first), of_second.trial(index, second));
        }
        Some(pairs)
    }

    /// True if the kept samples of a study give what its table of occurrences counts.
    fn is_kept(&self, at: usize, name: &str, counted: Option<Proportion>) -> bool {
        let kept = self.kept.map(|(first, second)| [first, second][at]);
        kept.is_some_and(|kept| Some(kept.proportion(self.studies[at].samples, name)) == counted)
    }
}

impl ComparedStudies {
    /// The table `compare`: a row for each mode of a scene in each study but the first, and for anything that is unstable there.
    #[must_use]
    pub fn table(&self) -> Table {
        let header = [
            &["study", "against", "constraints", "law", "speed", "in_contact", "arrangement"][..],
            &["mode", "against_mode", "frequency_hz", "against_frequency_hz", "linked_by", "mac"],
            &[
                "occurrence",
                "against_occurrence",
                "difference",
                "lower",
                "upper",
                "interval",
                "samples",
                "against_samples",
            ],
        ];
        let rows = self.others.iter().flat_map(|other| other.rows.iter().map(|row| self.row(other, row)));
        Table::new("compare", header.concat(), rows)
    }

    fn row(&self, other: &Against, row: &Compared) -> Vec<String> {
        let number = |of: Option<f64>| of.map_or_else(String::new, |number| number.to_string());
        let [first, second] = &row.occurrences;
        let value = |of: &Option<Proportion>| number(of.and_then(|of| of.estimate()).map(|part| part.lower));
        let trials = |of: &Option<Proportion>| of.map_or_else(String::new, |of| of.trials().to_string());
        let [name, against, hz, against_hz, by, mac] = match &row.link {
            None => ["any".into(), "any".into(), String::new(), String::new(), String::new(), String::new()],
            Some(Link { modes: [first, second], hz: [first_hz, second_hz], by }) => [
                second.clone().unwrap_or_default(),
                first.clone().unwrap_or_default(),
                number(*second_hz),
                number(*first_hz),
                by.map_or("nothing", LinkedBy::name).to_owned(),
                match by {
                    Some(LinkedBy::Shape { mac }) => mac.to_string(),
                    _ => String::new(),
                },
            ],
        };
        let [difference, lower, upper, how] = match row.difference {
            Some((Difference { value, interval: Interval { lower, upper } }, how)) => {
                [number(value), lower.to_string(), upper.to_string(), how.name().to_owned()]
            }
            None => Default::default(),
        };
        let path = |path: &Path| path.display().to_string();
        let mut cells = vec![path(&other.path), path(&self.first)];
        cells.extend(row.scene.iter().cloned());
        cells.extend([name, against, hz, against_hz, by, mac, value(second), value(first)]);
        cells.extend([difference, lower, upper, how, trials(second), trials(first)]);
        cells
    }
}
