//! Labels of laws, ranges of speed and arrangements in tables and figures.

use osc_model::ContactArrangement;
use study::{LawLabel, PanelLabel, SceneLabels, SpeedLabel, Units};

use crate::case::{Law, SpeedRange};

/// Labels of laws, ranges of speed and arrangements; labels of constraints, degrees of freedom and the naming point are left empty.
pub(super) fn friction_labels(
    laws: &[Law],
    speeds: &[SpeedRange],
    panels: &[(usize, Vec<ContactArrangement>)],
    units: Units,
) -> SceneLabels {
    let speed = |range: &SpeedRange| SpeedLabel {
        name: range.name.clone(),
        description: format!("{} speed, {} to {} {}", range.name, range.from, range.to, units.of("m/s")),
    };
    let panel = |(number, list): &(usize, Vec<ContactArrangement>)| PanelLabel {
        in_contact: *number,
        arrangements: list.iter().map(ToString::to_string).collect(),
    };
    SceneLabels {
        laws: laws.iter().map(|law| LawLabel { name: law.name().into(), title: law.title().into() }).collect(),
        baseline_law: laws.iter().position(|&law| law == Law::AmontonsCoulomb),
        speeds: speeds.iter().map(speed).collect(),
        panels: panels.iter().map(panel).collect(),
        ..SceneLabels::default()
    }
}
