//! The figure of a screening.

use figures::{DropBar, DropGroup, DropsFigure, Figure, drops};
use squeal::screen::{ChangeKind, Screen, ScreenedSet};

use crate::Error;

/// The drop of each confirmed set, kind by kind; `title` and `note` stand above and below.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn screen_figure(screen: &Screen, title: &str, note: &str) -> Result<Figure, Error> {
    let bar = |set: &ScreenedSet| {
        let drop = set.confirmed.as_ref()?.drop;
        let limits = [drop.lower, drop.upper];
        Some(DropBar { name: set.name(), value: drop.value, limits, predicted: set.predicted_drop(&screen.unchanged) })
    };
    let group = |title: &str, kind: Option<ChangeKind>| {
        let bars = screen.sets.iter().skip(1).filter(|set| set.kind == kind).filter_map(bar).collect();
        DropGroup { title: title.into(), bars }
    };
    let kinds = ChangeKind::ALL.into_iter().map(|kind| group(kind.action(), Some(kind)));
    let groups = [group("the case's sets of constraints", None)].into_iter().chain(kinds);
    Ok(drops(&DropsFigure {
        title: title.into(),
        x_label: "unstable modes fewer in one analysis".into(),
        groups: groups.filter(|group| !group.bars.is_empty()).collect(),
        most: screen.as_it_is().map(|now| now.unstable.value),
        note: note.into(),
    })?)
}
