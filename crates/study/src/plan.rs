//! Plan of a study: the configurations of a brake, and the scenes in which each sample is evaluated.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use cea::Threshold;
use linsys::OperatingPoint;
use num_complex::Complex;
use osc_model::Brake;

use super::{
    Contradiction, LawLabel, Measured, ModeIdentity, ModeNaming, PanelLabel, Scene, SceneKey, SceneLabels, SpeedLabel,
    Units,
};

/// A brake in one configuration of contacts and constraints, with the operating point by which its modes get names.
#[derive(Debug, Clone)]
pub struct Configuration {
    /// The brake, shared by all copies of the plan.
    pub brake: Arc<Brake>,
    /// Operating point at which its modes are named: median parameters, of a baseline law where there are several laws.
    pub naming_point: OperatingPoint,
    /// Index in [`Plan::origins`] of the origin from which its names come by continuation.
    pub origin: usize,
    /// Contacts of the configuration in words, for people.
    pub contacts: String,
}

/// Origin of names: a brake and an operating point at which modes are called by frequency rank.
#[derive(Debug, Clone)]
pub struct Origin {
    /// Brake of the origin. Every configuration that is named after it has the same degrees of freedom, but where a brake that finds its modes
    /// itself has a [`Bridge`](crate::Bridge) between them.
    pub brake: Arc<Brake>,
    /// Operating point of the brake.
    pub naming_point: OperatingPoint,
}

/// The file that a study was read from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StudySource {
    /// Path of the file.
    pub path: PathBuf,
    /// Text of the file, with what was set.
    pub text: String,
    /// Fields that were set from outside, each as `NAME=VALUE`.
    pub set: Vec<String>,
}

/// Guard factor: reference modes are kept in `[f_min / 1.2, 1.2 f_max]` of the band of a study, since they may come into it; chosen:
/// friction and open contacts move a mode by less.
const BAND_MARGIN: f64 = 1.2;

/// Plan of a study: its configurations and all its scenes. It is made by its methods; [`check`](crate::check) sees to it that what is
/// changed afterwards fits.
#[non_exhaustive]
#[derive(Debug, Clone)]
pub struct Plan {
    /// The case file, where there is one.
    pub source_file: Option<StudySource>,
    /// Commit of the program that runs the study, for manifest and pages; no number depends on it.
    pub commit: Option<&'static str>,
    /// Name of the study.
    pub name: String,
    /// Text that tells the study from others. Compared anyway before a study continues a folder: equations, naming points, scenes,
    /// threshold, seed, and the operating points of the first draws.
    pub identity: String,
    /// Samples per scene, >= 1.
    pub samples: u64,
    /// Seed of the random streams.
    pub seed: u64,
    /// Naming of modes in reports.
    pub mode_labels: ModeNaming,
    /// Rule by which a tracked mode is known again.
    pub mode_identity: ModeIdentity,
    /// Band of the frequencies studied, rad/s: of a reduced brake the frequencies that it is made for. `None` studies all. A real eigenvalue is studied
    /// whatever the band.
    pub band: Option<[f64; 2]>,
    /// Least Re lambda, 1/s, of the modes that a reduced brake surely has in the band: these are numbered first. `None` numbers by frequency alone.
    pub least_growth: Option<f64>,
    /// Instability threshold of a mode. Default: the imaginary axis, every mode that grows.
    pub threshold: Threshold,
    /// Naming points are the operating points of the medians, for each configuration in one of its scenes; a study checks it where this is
    /// set. [`Plan::add_constraint_set`] sets it.
    pub is_named_at_medians: bool,
    /// Units in which numbers are printed. No number depends on them but the numbers of the motion after the onset, which are in SI.
    pub units: Units,
    /// Squeal that was measured, with which results are compared, if there is any; no sample depends on it.
    pub measured: Option<Measured>,
    /// Sentences that a brake says against its own results, which stand before all others; no number depends on them.
    pub doubts: Vec<String>,
    /// Sentence against results in which a change holds a degree of freedom, where a brake has one; no number depends on it.
    pub doubt_of_holds: Option<String>,
    /// Labels for the keys of the scenes.
    pub labels: SceneLabels,
    /// Origins of the names of modes.
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
            commit: None,
            name: name.into(),
            identity,
            samples,
            seed,
            mode_labels: ModeNaming::Tracked,
            mode_identity: ModeIdentity::Continuation,
            band: None,
            least_growth: None,
            threshold: Threshold::AXIS,
            is_named_at_medians: false,
            units: Units::Si,
            measured: None,
            doubts: Vec::new(),
            doubt_of_holds: None,
            labels: SceneLabels::default(),
            origins: Vec::new(),
            configurations: Vec::new(),
            scenes: Vec::new(),
        }
    }

    /// Adds a scene: a brake under a set of constraints, whose modes are named at an operating point of its own, at the medians.
    pub fn add_constraint_set(&mut self, name: &str, brake: Brake, naming_point: OperatingPoint) {
        let contacts: Vec<&str> = brake.system.contacts().map(|channel| channel.name.as_str()).collect();
        let contacts = contacts.join(" ");
        if self.scenes.is_empty() {
            let in_contact = brake.system.contacts().count();
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

    /// Replaces each scene by `count` ones that `set` tells apart by one entry of their keys; of scenes that differ in that entry alone
    /// already the first stays.
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
    /// ranges of speed that the law tells apart. The scenes stand for the arrangements `members` of a panel.
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

    /// Source of the study, for messages: its file or its name.
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

    /// True if a mode with eigenvalue `lambda`, rad/s, or a real eigenvalue, is studied.
    pub fn is_studied(&self, lambda: Complex<f64>) -> bool {
        lambda.im == 0.0 || self.band.is_none_or(|[from, to]| (from..=to).contains(&lambda.im))
    }

    /// True if the reference modes include one with eigenvalue `lambda`, rad/s: those that are studied, and neighbours that may become one.
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

    /// Number of speed ranges that a scene stands for: all where nothing in it depends on speed.
    pub fn speeds_of(&self, key: SceneKey) -> usize {
        if key.speed.is_some() { 1 } else { self.labels.speeds.len().max(1) }
    }

    /// Number of complex eigenvalue analyses that one sample stands for: every arrangement, law, constraint set and speed range.
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
