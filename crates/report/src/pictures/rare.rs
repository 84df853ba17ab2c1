//! The figure of rare squeal: which inputs make the likeliest squealing brakes.

use figures::{Figure, IndexBar, IndexFigure, IndexPanel, index_bars};
use squeal::rare::{LikelySqueal, Rare};

use crate::Error;

/// Brakes that are drawn, the likeliest first; chosen: a page.
const MOST_BRAKES: usize = 4;
/// Most inputs of a panel, those with the largest parts first; chosen.
const MOST_INPUTS: usize = 10;

/// Bars of the parts that inputs have in the growth rate at the likeliest squealing brakes; `title` and `note` stand above and below. `None` where
/// no squeal was found.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn rare_figure(rare: &Rare, title: &str, note: &str) -> Result<Option<Figure>, Error> {
    let panels: Vec<IndexPanel> = rare.design_points.iter().take(MOST_BRAKES).map(|point| panel(rare, point)).collect();
    if panels.is_empty() {
        return Ok(None);
    }
    Ok(Some(index_bars(&IndexFigure {
        title: title.into(),
        first_bar: Some("part of an input in the variance of the growth rate there".into()),
        panels,
        note: note.into(),
    })?))
}

fn panel(rare: &Rare, point: &LikelySqueal) -> IndexPanel {
    let mut order: Vec<usize> = (0..rare.inputs.len()).collect();
    order.sort_by(|&a, &b| point.parts[b].total_cmp(&point.parts[a]));
    let bar = |at: usize| {
        let part = point.parts[at].clamp(0.0, 1.0);
        let input = format!("{} = {:.4}", rare.inputs[at].name, point.values[at]);
        IndexBar { input, first_order: [part; 3], total: None }
    };
    let title = format!(
        "{:.0} Hz, {:.2} deviations: {:.1e} to first order",
        point.omega / std::f64::consts::TAU,
        point.beta,
        point.first_order
    );
    IndexPanel { title, bars: order.into_iter().take(MOST_INPUTS).map(bar).collect() }
}
