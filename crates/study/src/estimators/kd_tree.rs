//! The cells of a surrogate: a k-d tree over mu, Re H and Im H / Re H, with the complex slope H of [`ChannelGain::complex_slope`] at one frequency.

use linsys::ChannelGain;

use super::response_surface::ResponseSurface;

/// Number of corners of a cell.
pub(super) const CORNERS: usize = 8;

/// A set of unstable modes; bit i stands for the name with index i in [`super::Surrogate::names`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct ModeSet {
    /// Names of modes whose name is certain.
    pub sure: u64,
    /// Names in `sure`, and the candidate names of the other modes.
    pub perhaps: u64,
}

impl ModeSet {
    pub fn or(self, more: Self) -> Self {
        Self { sure: self.sure | more.sure, perhaps: self.perhaps | more.perhaps }
    }
}

/// The prediction of a surrogate for a gain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Prediction {
    /// Names of the unstable modes.
    pub unstable: ModeSet,
    /// True if the prediction may be wrong: by the error of a response surface, a slope outside of its range, a mode that could not be followed, or an open
    /// name.
    pub is_uncertain: bool,
}

#[derive(Debug, Clone)]
pub(super) enum Cell {
    /// The cells below and above `middle` in a direction.
    Halved {
        direction: usize,
        middle: f64,
        halves: [usize; 2],
    },
    Leaf(Leaf),
    /// A cell without points.
    Empty,
}

/// A cell that is not halved. Corner k of eight is on the upper side in direction d where bit d of k is set.
#[derive(Debug, Clone)]
pub(super) struct Leaf {
    /// Coordinates of the middle of the cell.
    pub middle: [f64; 3],
    /// Modes that are unstable in the whole cell.
    pub unstable: CornerNames,
    /// Modes that may cross the threshold.
    pub crossing: Vec<CrossingMode>,
    /// True if a mode could not be followed between corners.
    pub is_uncertain: bool,
}

/// A mode that may cross the threshold in a cell.
#[derive(Debug, Clone)]
pub(super) struct CrossingMode {
    pub surface: ResponseSurface,
    pub names: CornerNames,
}

impl CrossingMode {
    /// Prediction for the mode under a gain, two flags: true if it is beyond the threshold; true if this or its name is uncertain.
    pub fn predict(&self, gain: &ChannelGain) -> [bool; 2] {
        let (margin, is_outside) = self.surface.margin(gain);
        self.judge(margin, is_outside)
    }

    /// Prediction as by [`CrossingMode::predict`], from the results of the response surface.
    pub fn judge(&self, margin: f64, is_outside: bool) -> [bool; 2] {
        let grows = margin > 0.0;
        [grows, margin.abs() < self.surface.uncertainty() || is_outside || grows && self.names.is_uncertain]
    }
}

/// Names of modes near each corner of a cell.
#[derive(Debug, Clone)]
pub(super) struct CornerNames {
    pub at: [ModeSet; CORNERS],
    /// True if the names differ between corners, or no corner gives a name.
    pub is_uncertain: bool,
}

impl CornerNames {
    pub fn new(at: [ModeSet; CORNERS]) -> Self {
        Self { is_uncertain: at.iter().any(|&names| names != at[0]), at }
    }
}

/// The prediction of the tree `cells`, whose root is the first cell, for a gain with these coordinates.
pub(super) fn predict(cells: &[Cell], gain: &ChannelGain, coordinates: [f64; 3]) -> Prediction {
    let mut at = 0;
    loop {
        match &cells[at] {
            Cell::Halved { direction, middle, halves } => at = halves[usize::from(coordinates[*direction] >= *middle)],
            Cell::Leaf(leaf) => return leaf.predict(gain, &coordinates),
            Cell::Empty => return Prediction { unstable: ModeSet::default(), is_uncertain: true },
        }
    }
}

impl Leaf {
    fn predict(&self, gain: &ChannelGain, coordinates: &[f64; 3]) -> Prediction {
        let nearest_corner = (0..3).map(|d| usize::from(coordinates[d] >= self.middle[d]) << d).sum::<usize>();
        let mut prediction = Prediction {
            unstable: self.unstable.at[nearest_corner],
            is_uncertain: self.is_uncertain || self.unstable.is_uncertain,
        };
        for mode in &self.crossing {
            let [grows, is_uncertain] = mode.predict(gain);
            prediction.is_uncertain |= is_uncertain;
            if grows {
                prediction.unstable = prediction.unstable.or(mode.names.at[nearest_corner]);
            }
        }
        prediction
    }
}
