//! The figure of influence: of the scene, and of the modes that are unstable most often.

use figures::{Figure, IndexBar, IndexFigure, IndexPanel, index_bars};
use squeal::influence::{Influence, InputInfluence, OutputInfluence, OutputKind};

use crate::Error;

/// Modes that are drawn, those that are unstable in most draws first; chosen: a page.
const MOST_MODES: usize = 4;
/// Most inputs of a panel, those with the largest indices first; chosen.
const MOST_INPUTS: usize = 10;

/// Bars of the indices with their intervals; `title` and `note` stand above and below. `None` where no output varies enough.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn influence_figure(influence: &Influence, title: &str, note: &str) -> Result<Option<Figure>, Error> {
    let mut modes: Vec<&OutputInfluence> = influence.outputs.iter().filter(|o| o.output.mode.is_some()).collect();
    modes.sort_by_key(|output| std::cmp::Reverse(output.nonzero));
    let growths = modes.into_iter().filter(|output| output.output.kind == OutputKind::Growth).take(MOST_MODES);
    let of_scene = influence.outputs.iter().filter(|output| output.output.mode.is_none());
    let drawn = of_scene.chain(growths).filter(|output| !output.inputs.is_empty());
    let panels: Vec<IndexPanel> = drawn.map(|output| panel(influence, output)).collect();
    if panels.is_empty() {
        return Ok(None);
    }
    Ok(Some(index_bars(&IndexFigure { title: title.into(), panels, note: note.into(), ..IndexFigure::default() })?))
}

fn panel(influence: &Influence, output: &OutputInfluence) -> IndexPanel {
    let whose = output.output.mode.map_or("any mode".to_owned(), |mode| format!("mode {mode}"));
    let title = match output.output.kind {
        OutputKind::Growth => format!("growth of {whose}"),
        OutputKind::Instability => format!("whether {whose} is unstable"),
    };
    let limits = |index: montecarlo::SobolIndex| {
        let interval = index.interval(Influence::CONFIDENCE);
        [index.part(), interval.lower, interval.upper]
    };
    let mut ranked = output.ranked();
    ranked.sort_by(|(_, a), (_, b)| {
        let size = |input: &InputInfluence| input.total.unwrap_or(input.first_order).value;
        size(b).total_cmp(&size(a))
    });
    let bar = |(at, input): (usize, &InputInfluence)| IndexBar {
        input: influence.inputs[at].name.clone(),
        first_order: limits(input.first_order),
        total: input.total.map(limits),
    };
    IndexPanel { title, bars: ranked.into_iter().take(MOST_INPUTS).map(bar).collect() }
}
