//! The next kink of a motion: where a contact opens or closes, sticks or begins to slide, its sliding velocity passes 0, or the motion a plane.

use nalgebra::DMatrix;

use crate::moments::{MOMENTS, moment};
use crate::path::Path;
use crate::series::{root, value_and_slope};

impl Path<'_> {
    /// The first kink up to a part of the unit, by what is seen at its moments, and the part at which it is; without one, the given part.
    pub fn first_kink(&self, reach: f64, values: &DMatrix<f64>) -> (f64, Option<usize>) {
        // Least and greatest value of each row, and how far it goes between two moments at most.
        let ranges: Vec<[f64; 3]> =
            (0..values.nrows()).map(|row| range(self.seen[(row, 0)], values.row(row).iter().copied())).collect();
        let is_near = |kink: &usize| {
            let ((row, offset), side) = (self.kinks[*kink], self.sides[*kink]);
            let [least, greatest, step] = ranges[row];
            // Others are too far away for a change, or for a dip between two moments.
            if side { least + offset <= step } else { greatest + offset >= -step }
        };
        let changes = (0..self.kinks.len()).filter(|kink| self.is_active(*kink)).filter(is_near);
        let changes = changes.filter_map(|kink| Some((self.first_change(kink, reach, values)?, kink)));
        let mut changes: Vec<([f64; 2], usize)> = changes.collect();
        changes.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        let mut first = (reach, None);
        for (between, kink) in changes {
            if between[0] >= first.0 {
                break;
            }
            let part = self.change(kink, between);
            first = if part < first.0 { (part, Some(kink)) } else { first };
        }
        first
    }

    /// The value of a kink at a part of the unit, positive on the side where the motion is, and its derivative by the part.
    fn kink_at(&self, kink: usize, part: f64) -> [f64; 2] {
        let (row, offset) = self.kinks[kink];
        let [value, slope] = value_and_slope((0..=self.degree).rev().map(|k| self.seen[(row, k)]), part);
        if self.sides[kink] { [value + offset, slope] } else { [-(value + offset), -slope] }
    }

    /// Two parts of the unit, before and after the first change of a kink. A change and its reverse between two moments are seen by the dip
    /// that they make.
    fn first_change(&self, kink: usize, reach: f64, values: &DMatrix<f64>) -> Option<[f64; 2]> {
        let (row, offset) = self.kinks[kink];
        let sign = if self.sides[kink] { 1.0 } else { -1.0 };
        let is_changed = |value: f64| if self.sides[kink] { value <= 0.0 } else { value < 0.0 };
        let mut before = [[f64::NAN; 2]; 2];
        let mut now = [0.0, sign * (self.seen[(row, 0)] + offset)];
        for at in 0..MOMENTS {
            before = [before[1], now];
            now = [reach * moment(at), sign * (values[(row, at)] + offset)];
            if is_changed(now[1]) {
                return Some([before[1][0], now[0]]);
            }
            let [[from, high], [middle, lowest]] = before;
            if !(lowest <= high && lowest <= now[1]) {
                continue;
            }
            // The parabola through all three, and how far it goes down.
            let slopes = [(lowest - high) / (middle - from), (now[1] - lowest) / (now[0] - middle)];
            let curvature = (slopes[1] - slopes[0]) / (now[0] - from);
            let slope = slopes[0] + curvature * (middle - from);
            let is_deep = lowest - slope * slope / (4.0 * curvature) < 0.1 * (high.max(now[1]) - lowest);
            if !is_deep {
                continue;
            }
            let (mut low, mut high) = (from, now[0]);
            for _ in 0..40 {
                let thirds = [low + (high - low) / 3.0, high - (high - low) / 3.0];
                let [one, two] = thirds.map(|part| self.kink_at(kink, part)[0]);
                if one < two { high = thirds[1] } else { low = thirds[0] }
            }
            if is_changed(self.kink_at(kink, low)[0]) {
                return Some([from, low]);
            }
        }
        None
    }

    /// The part of the unit at which a kink changes, between one before and one after it.
    fn change(&self, kink: usize, between: [f64; 2]) -> f64 {
        root(|part| self.kink_at(kink, part), between, 2.0 * f64::EPSILON)
    }
}

/// Least and greatest of a number and those that follow it, and the largest difference of two neighbours.
fn range(first: f64, others: impl Iterator<Item = f64>) -> [f64; 3] {
    let (mut range, mut before) = ([first, first, 0.0_f64], first);
    for value in others {
        range = [range[0].min(value), range[1].max(value), range[2].max((value - before).abs())];
        before = value;
    }
    range
}
