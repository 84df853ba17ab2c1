//! The figure of studies side by side.

use figures::{DropBar, DropGroup, DropsFigure, Figure, drops};
use squeal::compare::{Against, Compared, ComparedStudies};

use crate::Error;

/// Most bars of a study; chosen: a page. The table has all.
const MOST_BARS: usize = 24;

/// The difference of each mode's occurrence, the largest first, study by study; `None` where no mode is linked to one of the first study.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn compare_figure(found: &ComparedStudies) -> Result<Option<Figure>, Error> {
    let first = found.first.display();
    let bar = |row: &Compared| {
        let (difference, _) = row.difference?;
        Some(DropBar {
            name: format!("{}: {}", row.scene_in_words(), row.name_in_words()),
            value: difference.value?,
            limits: Some([difference.interval.lower, difference.interval.upper]),
            predicted: None,
        })
    };
    let group = |other: &Against| DropGroup {
        title: format!("{} against {first}", other.path.display()),
        bars: other.largest_first().into_iter().filter_map(bar).take(MOST_BARS).collect(),
    };
    let groups: Vec<DropGroup> = found.others.iter().map(group).filter(|group| !group.bars.is_empty()).collect();
    if groups.is_empty() {
        return Ok(None);
    }
    Ok(Some(drops(&DropsFigure {
        title: format!("Change of the occurrence of modes, against {first}"),
        x_label: "change of the occurrence: positive where it is more often unstable than in the first study".into(),
        groups,
        are_rises: true,
        most: None,
        note: "Whiskers are 95 % intervals, each by itself.".into(),
    })?))
}
