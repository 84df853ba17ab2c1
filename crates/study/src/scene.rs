//! Scenes of a study, and what reports call them.

use super::{ModeLabel, Moves};

/// Key that tells scenes apart: indices into the lists of [`SceneLabels`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct SceneKey {
    /// Index of the constraint set in [`SceneLabels::constraints`].
    pub constraints: usize,
    /// Index of the friction law in [`SceneLabels::laws`].
    pub law: usize,
    /// Index of the speed range in [`SceneLabels::speeds`]; `None` where nothing depends on speed, one scene then stands for all ranges.
    pub speed: Option<usize>,
    /// Index of the number in contact in [`SceneLabels::panels`].
    pub panel: usize,
}

/// Scene of a study: it stands for all arrangements of its symmetry class.
#[non_exhaustive]
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Key of the scene: constraint set, law, speed range and panel.
    pub key: SceneKey,
    /// Indices of the arrangements that the scene stands for, in the panel's list; the first is the one computed.
    pub members: Vec<usize>,
    /// Index of its configuration in [`Plan::configurations`](crate::Plan::configurations).
    pub configuration: usize,
    /// True if net work is computed in this scene.
    pub wants_work: bool,
}

/// A friction law as reports call it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LawLabel {
    /// Name in tables.
    pub name: String,
    /// Title in headings.
    pub title: String,
}

/// A range of sliding speed as reports call it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpeedLabel {
    /// Name in tables.
    pub name: String,
    /// Description in legends, with the limits of the range.
    pub description: String,
}

/// Panel as reports call it: all arrangements with one number in contact.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PanelLabel {
    /// Number of closed contacts; 0 for a brake without contacts, whose friction is in its terms.
    pub in_contact: usize,
    /// Arrangements in words, one text each.
    pub arrangements: Vec<String>,
}

/// Labels for the indices of a [`SceneKey`].
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SceneLabels {
    /// Names of the constraint sets; at least one.
    pub constraints: Vec<String>,
    /// Labels of the friction laws; at least one.
    pub laws: Vec<LawLabel>,
    /// Index of the law that others are compared with, if there is one.
    pub baseline_law: Option<usize>,
    /// Labels of the speed ranges; none where no scene has one.
    pub speeds: Vec<SpeedLabel>,
    /// Labels of the numbers in contact; at least one.
    pub panels: Vec<PanelLabel>,
    /// Words for the point where modes have the frequency ranks that tracked modes are named by, for axes: "at median parameters".
    pub named_at: String,
    /// Names of the degrees of freedom, held ones too; a degree of freedom without a name is called by its number, from 1.
    pub dofs: Vec<String>,
    /// Kinds of their motions, in the same order; [`Moves::Unknown`] where the kind is not known.
    pub moves: Vec<Moves>,
}

impl SceneLabels {
    /// Name of a speed range in tables; "all" where a scene stands for all ranges.
    pub fn speed(&self, speed: Option<usize>) -> &str {
        speed.map_or("all", |range| &self.speeds[range].name)
    }

    /// Name of the degree of freedom `index`, from 0; its number, from 1, where it has no name.
    pub fn dof(&self, index: usize) -> String {
        self.dofs.get(index).cloned().unwrap_or_else(|| (index + 1).to_string())
    }

    /// Kind of the motion of the degree of freedom `index`, from 0.
    pub fn moves(&self, index: usize) -> Moves {
        self.moves.get(index).copied().unwrap_or_default()
    }

    /// Constraints, law and speed of a scene or panel: the first columns of tables.
    pub fn key_columns(&self, key: SceneKey) -> [String; 3] {
        let (constraints, law) = (&self.constraints[key.constraints], &self.laws[key.law].name);
        [constraints.clone(), law.clone(), self.speed(key.speed).to_owned()]
    }

    /// Columns that say which scene: [`SceneLabels::MODE_COLUMNS`] but the mode.
    pub const SCENE_COLUMNS: &[&str] = match Self::MODE_COLUMNS.split_last() {
        Some((_, columns)) => columns,
        None => &[],
    };

    /// Values of [`SceneLabels::SCENE_COLUMNS`] for a scene, by the first of its arrangements.
    pub fn scene_columns(&self, scene: &Scene) -> Vec<String> {
        let PanelLabel { in_contact, arrangements } = &self.panels[scene.key.panel];
        let mut columns = self.key_columns(scene.key).to_vec();
        columns.extend([in_contact.to_string(), arrangements[scene.members[0]].clone()]);
        columns
    }

    /// The first columns of tables with a row for each mode in each arrangement.
    pub const MODE_COLUMNS: [&str; 6] = ["constraints", "law", "speed", "in_contact", "arrangement", "mode"];

    /// Values of [`SceneLabels::MODE_COLUMNS`]; `arrangement` is an index in the list of the panel.
    pub fn mode_columns(&self, key: SceneKey, arrangement: usize, mode: ModeLabel) -> Vec<String> {
        let PanelLabel { in_contact, arrangements } = &self.panels[key.panel];
        let mut columns = self.key_columns(key).to_vec();
        columns.extend([in_contact.to_string(), arrangements[arrangement].clone(), mode.to_string()]);
        columns
    }
}
