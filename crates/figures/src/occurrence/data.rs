//! What the figure of occurrences shows.

/// Box plots over arrangements: a row for each mode, a panel for each number in contact, a block of panels for each
/// friction law.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceFigure {
    /// Above everything; may be empty.
    pub title: String,
    /// Name of the set of constraints, for the table.
    pub constraints: String,
    /// What the names of the modes mean, below the panels.
    pub mode_note: String,
    /// The modes that the boxes refer to, in the order of the rows. One that is neither unstable nor open anywhere has no row.
    pub modes: Vec<OccurrenceMode>,
    /// Ranges of speed, from above to below within the row of a mode. All are in the legend.
    pub series: Vec<OccurrenceSeries>,
    /// Values to compare with.
    pub marks: Vec<OccurrenceMark>,
    /// One per friction law.
    pub laws: Vec<OccurrenceLaw>,
}

/// A mode.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceMode {
    /// What it is called on the axis.
    pub label: String,
    /// Its frequency where it has its name, Hz.
    pub frequency_hz: f64,
}

/// A range of speed.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceSeries {
    /// In the table.
    pub name: String,
    /// In the legend.
    pub description: String,
}

/// A value from elsewhere: a dashed line.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceMark {
    /// Where, in percent.
    pub percent: f64,
    /// In the legend.
    pub text: String,
    /// The panels that it is drawn in: the index of a law and that of a panel.
    pub panels: Vec<[usize; 2]>,
}

/// The panels of one friction law.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceLaw {
    /// In the table.
    pub name: String,
    /// Above the panels; may be empty.
    pub title: String,
    /// One per number in contact.
    pub panels: Vec<OccurrencePanel>,
}

/// One number in contact.
#[derive(Debug, Clone, Default)]
pub struct OccurrencePanel {
    /// For example "(a) nine in contact".
    pub title: String,
    /// How many are in contact, for the table.
    pub in_contact: usize,
    /// The arrangements.
    pub arrangements: Vec<OccurrenceArrangement>,
    /// At most one per mode and series; a mode without one has no data.
    pub boxes: Vec<OccurrenceBox>,
}

/// One arrangement of contacts.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceArrangement {
    /// Its name in the table; empty that of a brake without contacts.
    pub name: String,
    /// Number of the system that was solved for it: the same for arrangements that are each other's mirror image.
    pub system: usize,
}

/// One mode under one series.
#[derive(Debug, Clone, Default)]
pub struct OccurrenceBox {
    /// Index into [`OccurrenceFigure::modes`].
    pub mode: usize,
    /// Index into [`OccurrenceFigure::series`].
    pub series: usize,
    /// One per arrangement.
    pub values: Vec<Occurrence>,
}

/// How often a mode is unstable in one arrangement, in percent of the samples.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Occurrence {
    /// Samples solved. Without any there is no value: the arrangement is left out, and a box of such alone is a cross.
    pub samples: u64,
    /// The part in which it surely is unstable.
    pub percent: f64,
    /// The part in which an unstable mode is this one or another: its name is open.
    pub open: f64,
    /// Lower limit of the 95 % interval.
    pub lower: f64,
    /// Upper limit, open names counted as unstable.
    pub upper: f64,
}

impl OccurrencePanel {
    /// Whether there are contacts to arrange: without, nothing is said of their arrangements.
    pub(super) fn has_arrangements(&self) -> bool {
        self.arrangements.iter().any(|arrangement| !arrangement.name.is_empty())
    }

    /// How many of its arrangements are different systems.
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

    /// Whether it is unstable, or may be, in any sample.
    pub(super) fn is_ever_unstable(&self) -> bool {
        self.solved().any(|value| value.percent > 0.0 || value.open > 0.0)
    }
}

impl OccurrenceFigure {
    /// Every box.
    pub(super) fn boxes(&self) -> impl Iterator<Item = &OccurrenceBox> {
        self.laws.iter().flat_map(|law| &law.panels).flat_map(|panel| &panel.boxes)
    }

    /// The modes that are ever unstable.
    pub(super) fn unstable_modes(&self) -> Vec<usize> {
        let is_unstable = |&mode: &usize| self.boxes().any(|b| b.mode == mode && b.is_ever_unstable());
        (0..self.modes.len()).filter(is_unstable).collect()
    }
}
