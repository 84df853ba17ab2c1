//! Data of the figure of occurrences.

/// Box plots over arrangements: a row for each mode, a panel for each number in contact, a block of panels for each
/// friction law.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceFigure {
    /// Title above everything; may be empty.
    pub title: String,
    /// Name of the set of constraints, for the table.
    pub constraints: String,
    /// Note on what the names of the modes mean, below the panels.
    pub mode_note: String,
    /// The modes that the boxes refer to, in the order of the rows. One that is neither unstable nor open anywhere has no row.
    pub modes: Vec<OccurrenceMode>,
    /// Ranges of speed, from above to below within the row of a mode. All are in the legend.
    pub series: Vec<OccurrenceSeries>,
    /// Values to compare with.
    pub marks: Vec<OccurrenceMark>,
    /// Blocks of panels, one per friction law.
    pub laws: Vec<OccurrenceLaw>,
}

/// A mode.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceMode {
    /// Name on the axis.
    pub label: String,
    /// Frequency of the mode where it has its name, Hz.
    pub frequency_hz: f64,
}

/// A range of speed.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceSeries {
    /// Name in the table.
    pub name: String,
    /// Text in the legend.
    pub description: String,
}

/// A value from elsewhere: a dashed line.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceMark {
    /// The value, in percent.
    pub percent: f64,
    /// Text in the legend.
    pub text: String,
    /// Panels that the line is drawn in: the index of a law and the index of a panel.
    pub panels: Vec<[usize; 2]>,
}

/// The panels of one friction law.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceLaw {
    /// Name in the table.
    pub name: String,
    /// Title above the panels; may be empty.
    pub title: String,
    /// Panels, one per number in contact.
    pub panels: Vec<OccurrencePanel>,
}

/// A panel: one number in contact.
#[derive(Debug, Clone, Default)]
pub struct OccurrencePanel {
    /// Title, for example "(a) nine in contact".
    pub title: String,
    /// Number of closed contacts, for the table.
    pub in_contact: usize,
    /// The arrangements.
    pub arrangements: Vec<OccurrenceArrangement>,
    /// Boxes, at most one per mode and series; a mode without one has no data.
    pub boxes: Vec<OccurrenceBox>,
}

/// An arrangement of contacts.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceArrangement {
    /// Name in the table; empty for a brake without contacts.
    pub name: String,
    /// Number of the system that was solved for the arrangement: the same for arrangements that are each other's mirror image.
    pub system: usize,
}

/// A mode under one series.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceBox {
    /// Index into [`OccurrenceFigure::modes`].
    pub mode: usize,
    /// Index into [`OccurrenceFigure::series`].
    pub series: usize,
    /// Occurrences, one per arrangement.
    pub values: Vec<Occurrence>,
}

/// Occurrence of an unstable mode in one arrangement, in percent of the samples.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Occurrence {
    /// Samples solved. Without any there is no value: the arrangement is left out, and a box of such alone is a cross.
    pub samples: u64,
    /// Part of the samples in which the mode surely is unstable.
    pub percent: f64,
    /// Part of the samples in which an unstable mode is this one or another: its name is open.
    pub open: f64,
    /// Lower limit of the 95 % interval.
    pub lower: f64,
    /// Upper limit, open names counted as unstable.
    pub upper: f64,
}

impl OccurrencePanel {
    /// Number of different systems among the arrangements.
    pub(super) fn systems(&self) -> usize {
        let mut systems: Vec<usize> = self.arrangements.iter().map(|arrangement| arrangement.system).collect();
        systems.sort_unstable();
        systems.dedup();
        systems.len()
    }
}

impl OccurrenceBox {
    /// The values of the arrangements in which samples were solved.
    pub(super) fn solved(&self) -> impl Iterator<Item = &Occurrence> {
        self.values.iter().filter(|value| value.samples > 0)
    }

    /// True if the mode is unstable, or may be, in any sample.
    pub(super) fn is_ever_unstable(&self) -> bool {
        self.solved().any(|value| value.percent > 0.0 || value.open > 0.0)
    }
}

impl OccurrenceFigure {
    /// The boxes of all laws and panels.
    pub(super) fn boxes(&self) -> impl Iterator<Item = &OccurrenceBox> {
        self.laws.iter().flat_map(|law| &law.panels).flat_map(|panel| &panel.boxes)
    }

    /// True if there are several arrangements of contacts, in a panel or one in each of several: of a single one nothing is said.
    pub(super) fn has_arrangements(&self) -> bool {
        let mut named = self.laws.iter().flat_map(|law| law.panels.iter().enumerate()).flat_map(|(number, panel)| {
            panel.arrangements.iter().filter(|it| !it.name.is_empty()).map(move |it| (number, &it.name))
        });
        named.next().is_some_and(|first| named.any(|other| other != first))
    }

    /// The modes that are ever unstable.
    pub(super) fn unstable_modes(&self) -> Vec<usize> {
        let is_unstable = |&mode: &usize| self.boxes().any(|b| b.mode == mode && b.is_ever_unstable());
        (0..self.modes.len()).filter(is_unstable).collect()
    }
}
