//! The figure of a screening.

use figures::{DropBar, DropGroup, DropsFigure, Figure, drops};
use squeal::screen::{ChangeKind, Form, Screen, ScreenedSet};

use crate::Error;

/// The drop of each confirmed set, kind by kind; `title` and `note` stand above and below. `None` where none was confirmed.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn screen_figure(screen: &Screen, title: &str, note: &str) -> Result<Option<Figure>, Error> {
    let Form { times, fewer, .. } = screen.criterion.form();
    let bar = |set: &ScreenedSet| {
        let drop = screen.criterion.drop(set.confirmed.as_ref()?);
        // A drop is not known where no motion could be followed.
        if !drop.value.is_finite() {
            return None;
        }
        let limits = Some([drop.lower, drop.upper].map(|limit| times * limit));
        let limits = limits.filter(|limits| limits.iter().all(|limit| limit.is_finite()));
        let predicted = set.predicted_drop(&screen.unchanged, screen.criterion).filter(|drop| drop.is_finite());
        Some(DropBar {
            name: set.name(),
            value: times * drop.value,
            limits,
            predicted: predicted.map(|drop| times * drop),
        })
    };
    let group = |title: &str, kind: Option<ChangeKind>| {
        let bars = screen.sets.iter().skip(1).filter(|set| set.kind == kind).filter_map(bar).collect();
        DropGroup { title: title.into(), bars }
    };
    let kinds = ChangeKind::shown().map(|kind| group(kind.action(), Some(kind)));
    let groups = [group("the case's sets of constraints", None)].into_iter().chain(kinds);
    let groups: Vec<DropGroup> = groups.filter(|group| !group.bars.is_empty()).collect();
    if groups.is_empty() {
        return Ok(None);
    }
    let figure = drops(&DropsFigure {
        title: title.into(),
        x_label: fewer.into(),
        groups,
        are_rises: false,
        most: screen.as_it_is().map(|now| times * screen.criterion.left(now).value).filter(|most| most.is_finite()),
        note: note.into(),
    })?;
    Ok(Some(figure))
}
