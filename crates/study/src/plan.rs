//! What a study goes through: the configurations of a brake, and the scenes in which each sample is evaluated.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use cea::Threshold;
use linsys::OperatingPoint;
use num_complex::Complex;
use osc_model::Brake;
use serde::{Deserialize, Serialize};

use super::{Contradiction, ModeLabel};

/// What tells scenes apart; indices into the lists of [`SceneLabels`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct SceneKey {
    /// Constraint set.
    pub constraints: usize,
    /// Friction law.
    pub law: usize,
    /// Speed range; `None` where nothing depends on speed, one scene then stands for all ranges.
    pub speed: Option<usize>,
    /// Number in contact.
    pub panel: usize,
}

/// One scene: it stands for all arrangements of its symmetry class.
#[non_exhaustive]
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Where it belongs.
    pub key: SceneKey,
    /// Arrangements it stands for, as places in the panel's list; the first is the one computed.
    pub members: Vec<usize>,
    /// Place of its configuration in [`Plan::configurations`].
    pub configuration: usize,
    /// Whether net work is computed.
    pub wants_work: bool,
}

/// A brake in one configuration of contacts and constraints, with the operating point by which its modes get names.
#[derive(Debug, Clone)]
pub struct Configuration {
    /// The brake, shared by all copies of the plan.
    pub brake: Arc<Brake>,
    /// Where its modes are named: median parameters, of a baseline law where there are several.
    pub naming_point: OperatingPoint,
    /// Place in [`Plan::origins`] of the configuration from which its names come by continuation.
    pub origin: usize,
    /// Its contacts, for people.
    pub contacts: String,
}

/// Where names of modes come from: a brake and an operating point at which modes are called by frequency rank.
#[derive(Debug, Clone)]
pub struct Origin {
    /// The brake; of the degrees of freedom of every configuration that is named after it.
    pub brake: Arc<Brake>,
    /// Its operating point.
    pub naming_point: OperatingPoint,
}

/// A friction law as reports call it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LawLabel {
    /// In tables.
    pub name: String,
    /// In headings.
    pub title: String,
}

/// A range of sliding speed as reports call it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpeedLabel {
    /// In tables.
    pub name: String,
    /// In legends, with its limits.
    pub description: String,
}

/// All arrangements with one number in contact.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PanelLabel {
    /// How many contacts are closed; 0 for a brake that has none, whose friction is in its terms.
    pub in_contact: usize,
    /// Each arrangement in words.
    pub arrangements: Vec<String>,
}

/// What the indices of a [`SceneKey`] are called.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SceneLabels {
    /// Constraint sets; at least one.
    pub constraints: Vec<String>,
    /// Friction laws; at least one.
    pub laws: Vec<LawLabel>,
    /// The law that others are compared with, if there is one.
    pub baseline_law: Option<usize>,
    /// Speed ranges; none where no scene has one.
    pub speeds: Vec<SpeedLabel>,
    /// Numbers in contact; at least one.
    pub panels: Vec<PanelLabel>,
    /// Where modes have the frequency ranks that tracked modes are named by, for axes: "at median parameters".
    pub named_at: String,
    /// The degrees of freedom, held ones too; those without a name are called by their number, from 1.
    pub dofs: Vec<String>,
}

impl SceneLabels {
    /// What a speed is called in tables; "all" where a scene stands for all ranges.
    pub fn speed(&self, speed: Option<usize>) -> &str {
        speed.map_or("all", |range| &self.speeds[range].name)
    }

    /// What a degree of freedom is called.
    pub fn dof(&self, index: usize) -> String {
        self.dofs.get(index).cloned().unwrap_or_else(|| (index + 1).to_string())
    }

    /// Constraints, law and speed of a scene or panel, as tables have them in their first columns.
    pub fn key_columns(&self, key: SceneKey) -> [String; 3] {
        let (constraints, law) = (&self.constraints[key.constraints], &self.laws[key.law].name);
        [constraints.clone(), law.clone(), self.speed(key.speed).to_owned()]
    }

    /// What stands in all of [`SceneLabels::MODE_COLUMNS`] but the last for a scene, by the first of its arrangements.
    pub fn scene_columns(&self, scene: &Scene) -> Vec<String> {
        let PanelLabel { in_contact, arrangements } = &self.panels[scene.key.panel];
        let mut columns = self.key_columns(scene.key).to_vec();
        columns.extend([in_contact.to_string(), arrangements[scene.members[0]].clone()]);
        columns
    }

    /// The first columns of tables with a row for each mode in each arrangement.
    pub const MODE_COLUMNS: [&str; 6] = ["constraints", "law", "speed", "in_contact", "arrangement", "mode"];

    /// What stands in [`SceneLabels::MODE_COLUMNS`]; `arrangement` is a place in the list of the panel.
    pub fn mode_columns(&self, key: SceneKey, arrangement: usize, mode: ModeLabel) -> Vec<String> {
        let PanelLabel { in_contact, arrangements } = &self.panels[key.panel];
        let mut columns = self.key_columns(key).to_vec();
        columns.extend([in_contact.to_string(), arrangements[arrangement].clone(), mode.to_string()]);
        columns
    }
}

/// How modes are named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeNaming {
    /// By shape: the frequency rank of the mode it continues, all in contact at median parameters.
    Tracked,
    /// By frequency rank in its own sample, 1 to n.
    Rank,
    /// By place among all 2 n eigenvalues in its own sample: rank r is named 2 r - 1.
    Pair,
    /// By frequency rank in its own sample from the highest frequency down.
    RankDown,
    /// By place among all 2 n eigenvalues in its own sample from the highest frequency down.
    PairDown,
}

impl ModeNaming {
    /// Its word in a case file.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Tracked => "tracked",
            Self::Rank => "rank",
            Self::Pair => "pair",
            Self::RankDown => "rank-down",
            Self::PairDown => "pair-down",
        }
    }

    /// The name of the mode of a frequency rank, of a brake with so many modes.
    #[must_use]
    pub fn name(self, rank: ModeLabel, modes: usize) -> ModeLabel {
        let counted = |rank: usize| match self {
            Self::Pair | Self::PairDown => (2 * rank).saturating_sub(1),
            Self::Tracked | Self::Rank | Self::RankDown => rank,
        };
        if rank.is_mode() { ModeLabel::of_rank(counted(self.turned(rank.number().into(), modes))) } else { rank }
    }

    /// The frequency rank of the mode that has a name or, among all 2 n eigenvalues, either of its two numbers; 0 where there is no
    /// such mode.
    #[must_use]
    pub fn rank(self, name: ModeLabel, modes: usize) -> usize {
        let number = usize::from(name.number());
        let counted = match self {
            Self::Pair | Self::PairDown => number.div_ceil(2),
            Self::Tracked | Self::Rank | Self::RankDown => number,
        };
        self.turned(counted, modes)
    }

    /// A rank counted from the end that names are counted from, or the other way round.
    fn turned(self, rank: usize, modes: usize) -> usize {
        match self {
            Self::Tracked | Self::Rank | Self::Pair => rank,
            Self::RankDown | Self::PairDown => (modes + 1).saturating_sub(rank),
        }
    }
}

/// How a mode that is named by its shape is known again in another configuration and in a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeIdentity {
    /// By continuation from one system to the other, through every change of its shape.
    #[default]
    Continuation,
    /// By a modal assurance criterion of more than one half with its shape at the origin of names.
    Mac,
}

/// The file that a study was read from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StudySource {
    /// Where it is.
    pub path: PathBuf,
    /// What stands in it.
    pub text: String,
}

/// How much lower and higher than the band of a study the modes are that may come into it, as a factor; chosen: friction and
/// open contacts move a mode by less.
const BAND_MARGIN: f64 = 1.2;

/// All scenes of a study. It is made by its methods; [`check`](crate::check) sees to it that what is changed afterwards fits.
#[non_exhaustive]
#[derive(Debug, Clone)]
pub struct Plan {
    /// The case file, where there is one.
    pub source_file: Option<StudySource>,
    /// What the study is called.
    pub name: String,
    /// Text that tells it from others beside what a study compares anyway before it continues a folder: equations, naming points, scenes,
    /// threshold, seed, and the operating points of the first draws.
    pub identity: String,
    /// Samples per scene, >= 1.
    pub samples: u64,
    /// Seed of the random streams.
    pub seed: u64,
    /// How modes are named in reports.
    pub mode_labels: ModeNaming,
    /// How a tracked mode is known again.
    pub mode_identity: ModeIdentity,
    /// The frequencies of modes that are studied, rad/s: of a reduced brake those that it holds. `None` studies all. What does not
    /// oscillate is studied whatever they are.
    pub band: Option<[f64; 2]>,
    /// From where on a growing mode counts as unstable; the axis: every mode that grows.
    pub threshold: Threshold,
    /// Whether the naming point of each configuration is the operating point of the medians in one of its scenes, which a study checks
    /// where it is so. [`Plan::add_constraint_set`] says that it is.
    pub is_named_at_medians: bool,
    /// What scenes are called.
    pub labels: SceneLabels,
    /// Where names of modes come from.
    pub origins: Vec<Origin>,
    /// The configurations of the brake.
    pub configurations: Vec<Configuration>,
    /// The scenes, in the order in which they are evaluated.
    pub scenes: Vec<Scene>,
}

impl Plan {
    /// The plan of a brake with one configuration and one scene, whose modes are named at an operating point, and whose
    /// net work is computed. `samples` and `seed` may be changed afterwards.
    pub fn single(name: &str, brake: Brake, naming_point: OperatingPoint, samples: u64, seed: u64) -> Self {
        let mut plan = Self::without_scenes(name, name.to_owned(), samples, seed);
        plan.add_constraint_set("none", brake, naming_point);
        plan
    }

    /// A plan to which [`Plan::add_constraint_set`] adds the scenes; `identity` as in [`Plan::identity`].
    pub fn without_scenes(name: &str, identity: String, samples: u64, seed: u64) -> Self {
        Self {
            source_file: None,
            name: name.into(),
            identity,
            samples,
            seed,
            mode_labels: ModeNaming::Tracked,
            mode_identity: ModeIdentity::Continuation,
            band: None,
            threshold: Threshold::AXIS,
            is_named_at_medians: false,
            labels: SceneLabels::default(),
            origins: Vec::new(),
            configurations: Vec::new(),
            scenes: Vec::new(),
        }
    }

    /// Adds a scene: a brake under a set of constraints, whose modes are named at an operating point of its own, that of the medians.
    pub fn add_constraint_set(&mut self, name: &str, brake: Brake, naming_point: OperatingPoint) {
        let contacts: Vec<&str> = brake.system.channels().iter().map(|channel| channel.name.as_str()).collect();
        let contacts = contacts.join(" ");
        if self.scenes.is_empty() {
            let in_contact = brake.system.channels().len();
            self.labels.laws = vec![LawLabel { name: "given".into(), title: String::new() }];
            self.labels.panels = vec![PanelLabel { in_contact, arrangements: vec![contacts.clone()] }];
            self.labels.named_at = "at median parameters".into();
        }
        let (constraints, first) =
            (self.labels.constraints.len(), self.scenes.first().map(|scene| scene.key.constraints));
        let (origin, configuration) = (self.origins.len(), self.configurations.len());
        self.labels.constraints.push(name.into());
        let brake = Arc::new(brake);
        self.origins.push(Origin { brake: Arc::clone(&brake), naming_point: naming_point.clone() });
        self.configurations.push(Configuration { brake, naming_point, origin, contacts });
        // As many as the first set has: one for each law and range of speed.
        let keys = self.scenes.iter().filter(|scene| Some(scene.key.constraints) == first).map(|scene| scene.key);
        let mut keys: Vec<SceneKey> = keys.collect();
        if keys.is_empty() {
            keys.push(SceneKey::default());
        }
        for key in keys {
            let key = SceneKey { constraints, ..key };
            self.scenes.push(Scene { key, members: vec![0], configuration, wants_work: true });
        }
        self.is_named_at_medians = true;
    }

    /// The plan with friction laws by name and title, in whose order [`SceneKey::law`] counts them: every scene is there once for each.
    ///
    /// # Errors
    /// [`Contradiction::Empty`] without laws, [`Contradiction::NameTwice`].
    pub fn with_laws(mut self, laws: &[(&str, &str)]) -> Result<Self, Contradiction> {
        names_once("law", laws.iter().map(|(name, _)| *name))?;
        self.labels.laws =
            laws.iter().map(|(name, title)| LawLabel { name: (*name).into(), title: (*title).into() }).collect();
        self.each_scene(laws.len(), |key, law| key.law = law);
        Ok(self)
    }

    /// The plan with ranges of sliding speed by name and description, in whose order [`SceneKey::speed`] counts them: every scene is
    /// there once for each.
    ///
    /// # Errors
    /// [`Contradiction::Empty`] without ranges, [`Contradiction::NameTwice`].
    pub fn with_speeds(mut self, speeds: &[(&str, &str)]) -> Result<Self, Contradiction> {
        names_once("range of speed", speeds.iter().map(|(name, _)| *name))?;
        let label = |(name, description): &(&str, &str)| SpeedLabel {
            name: (*name).into(),
            description: (*description).into(),
        };
        self.labels.speeds = speeds.iter().map(label).collect();
        self.each_scene(speeds.len(), |key, speed| key.speed = Some(speed));
        Ok(self)
    }

    /// Puts several scenes in the place of each, which differ in one entry of their keys; of scenes that do already the first stays.
    fn each_scene(&mut self, count: usize, set: impl Fn(&mut SceneKey, usize)) {
        let mut scenes: Vec<Scene> = Vec::new();
        for mut scene in std::mem::take(&mut self.scenes) {
            set(&mut scene.key, 0);
            let is_known = |known: &Scene| known.key == scene.key && known.configuration == scene.configuration;
            if scenes.iter().any(is_known) {
                continue;
            }
            for at in 0..count {
                set(&mut scene.key, at);
                scenes.push(scene.clone());
            }
        }
        self.scenes = scenes;
    }

    /// Adds a configuration of the set of constraints that its origin belongs to, and its scenes: one for each law and each of the
    /// ranges of speed that the law tells apart. It stands for these `members` of the arrangements of a panel.
    pub fn add_configuration(
        &mut self,
        configuration: Configuration,
        panel: usize,
        members: &[usize],
        wants_work: bool,
        speeds: impl Fn(usize) -> Vec<Option<usize>>,
    ) {
        let (constraints, place) = (configuration.origin, self.configurations.len());
        for law in 0..self.labels.laws.len() {
            for speed in speeds(law) {
                let key = SceneKey { constraints, law, speed, panel };
                self.scenes.push(Scene { key, members: members.to_vec(), configuration: place, wants_work });
            }
        }
        self.configurations.push(configuration);
    }

    /// Where the study comes from, for messages: its file or its name.
    pub fn source(&self) -> String {
        self.source_file.as_ref().map_or_else(|| self.name.clone(), |file| file.path.display().to_string())
    }

    /// A scene in words: constraints, law, contacts and speed.
    pub fn describe(&self, scene: &Scene) -> String {
        let SceneKey { constraints, law, speed, .. } = scene.key;
        let speed = speed.map_or("all speeds", |range| &self.labels.speeds[range].name);
        let contacts = match self.configuration(scene).contacts.as_str() {
            "" => String::new(),
            contacts => format!("contact {contacts}, "),
        };
        format!("{}, {}, {contacts}{speed}", self.labels.constraints[constraints], self.labels.laws[law].name)
    }

    /// Whether a mode with this eigenvalue, or a real eigenvalue, is studied.
    pub fn is_studied(&self, lambda: Complex<f64>) -> bool {
        lambda.im == 0.0 || self.band.is_none_or(|[from, to]| (from..=to).contains(&lambda.im))
    }

    /// Whether the reference modes have one with this eigenvalue: those that are studied, and neighbours that may become one.
    pub fn is_followed(&self, lambda: Complex<f64>) -> bool {
        self.followed_band().is_none_or(|[from, to]| (from..=to).contains(&lambda.im))
    }

    /// Least and largest Im lambda of modes that are followed, rad/s; `None` where all are.
    pub fn followed_band(&self) -> Option<[f64; 2]> {
        self.band.map(|[from, to]| [from / BAND_MARGIN, to * BAND_MARGIN])
    }

    /// The configuration of a scene.
    pub fn configuration(&self, scene: &Scene) -> &Configuration {
        &self.configurations[scene.configuration]
    }

    /// The brake of a scene.
    pub fn brake(&self, scene: &Scene) -> &Brake {
        &self.configuration(scene).brake
    }

    /// How many ranges of speed a scene stands for: all where nothing in it depends on speed.
    pub fn speeds_of(&self, key: SceneKey) -> usize {
        if key.speed.is_some() { 1 } else { self.labels.speeds.len().max(1) }
    }

    /// Complex eigenvalue analyses that one sample stands for: every arrangement, law, constraint set and speed range.
    pub fn analyses_per_sample(&self) -> u64 {
        let SceneLabels { constraints, laws, speeds, panels, .. } = &self.labels;
        let arrangements: usize = panels.iter().map(|panel| panel.arrangements.len()).sum();
        (constraints.len() * laws.len() * speeds.len().max(1) * arrangements) as u64
    }
}

fn names_once<'a>(what: &'static str, names: impl Iterator<Item = &'a str>) -> Result<(), Contradiction> {
    let mut known = BTreeSet::new();
    for name in names {
        if !known.insert(name) {
            return Err(Contradiction::NameTwice { what, name: name.into() });
        }
    }
    if known.is_empty() { Err(Contradiction::Empty { what }) } else { Ok(()) }
}
