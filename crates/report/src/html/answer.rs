//! The answer in words: which modes squeal, how sure that is, what helps and by how much.

use squeal::results::Estimate;
use squeal::results::findings::{Change, ModeRange, OpenCounts, SetFindings, drop_in_words, place, warnings};
use squeal::results::hertz;
use squeal::results::{Results, set_letter};
use squeal::study::ModeLabel;

use super::text::{capitalised, escaped};
use crate::Error;

/// The answer of a study, as HTML.
pub(super) fn answer(results: &Results) -> Result<String, Error> {
    let sets = results.plan().labels.constraints.len();
    let findings = (0..sets).map(|set| SetFindings::new(results, set)).collect::<Result<Vec<_>, squeal::Error>>()?;
    let doubt = |doubt: String| format!("<p class=\"doubt\">Warning: {}</p>\n", escaped(&doubt));
    let mut text: String = results.doubts().into_iter().map(doubt).collect();
    text += "<h3>Which modes squeal</h3>\n<ul class=\"lead\">\n";
    for warning in warnings(results) {
        text += &format!("<li><strong>{}.</strong></li>\n", escaped(&warning));
    }
    for (set, found) in findings.iter().enumerate() {
        text += &format!("<li>{}</li>\n", squealing(results, set, found));
    }
    text += "</ul>\n<p>\u{201c}Most\u{201d} is more than half of the draws, and surely so: the lower limit is.</p>\n";
    if !results.plan().threshold.is_axis() {
        text += &format!("<p>A mode counts with {}.</p>\n", results.plan().threshold);
    }
    text += &helps(results);
    text += &how_sure(results, &findings);
    text += "<h3>Every mode that is ever unstable</h3>\n";
    for (set, found) in findings.iter().enumerate() {
        text += &modes_table(results, set, found);
    }
    Ok(text)
}

/// One sentence on a set of constraints.
fn squealing(results: &Results, set: usize, found: &SetFindings<'_>) -> String {
    let list = |wanted: &dyn Fn(&ModeRange<'_>) -> bool, range_in_words: &dyn Fn(&ModeRange<'_>) -> String| {
        let of = found.unstable.iter().filter(|(_, range)| wanted(range));
        let words =
            of.map(|(name, range)| format!("{}, {}", mode_in_words(results, set, *name), range_in_words(range)));
        words.collect::<Vec<_>>().join("; ")
    };
    let everywhere =
        list(&|range| range.is_likely_everywhere(), &|range| format!("{} or more", with_limits(&range.least.0)));
    let somewhere = list(&|range| range.is_likely_somewhere(), &|range| {
        format!("up to {} with {}", with_limits(&range.most.0), escaped(&place(results, range.most.1)))
    });
    let words = match (everywhere.as_str(), somewhere.as_str()) {
        ("", "") if found.unstable.is_empty() && results.has_band_modes => {
            "in no panel was any mode unstable".to_owned()
        }
        ("", "") if found.unstable.is_empty() => {
            "in no panel was any mode unstable, nor was there divergence".to_owned()
        }
        ("", "") => "in no panel does any mode squeal in most of the draws, for sure".to_owned(),
        ("", some) => format!("no mode squeals in most of the draws in every panel, but in some panels do {some}"),
        (all, "") => format!("in every panel most of the draws squeal with {all}"),
        (all, some) => {
            format!("in every panel most of the draws squeal with {all}. In some panels they do with {some}")
        }
    };
    // What is unstable without a mode's name stands before what modes with names do.
    let words = match found.anything_in_words(with_limits) {
        Some(anything) => format!("{anything}. {}", capitalised(&words)),
        None => words,
    };
    format!("<strong>{}</strong>: {words}.", set_in_words(results, set))
}

/// What each set of constraints changes, the one with the largest least drop first.
fn helps(results: &Results) -> String {
    let sets = results.plan().labels.constraints.len();
    let mut changes: Vec<(usize, Change<'_>)> =
        (1..sets).filter_map(|set| Some((set, Change::new(results, set)?))).collect();
    if changes.is_empty() {
        return "<h3>What helps</h3>\n<p>The study has one set of constraints, and so nothing that it could compare.</p>\n".into();
    }
    changes.sort_by(|a, b| b.1.least.1.value.total_cmp(&a.1.least.1.value));
    let mut text = format!(
        "<h3>What helps</h3>\n<p>Unstable modes in one analysis, compared with {} on the same samples, from the panel with the \
         smallest effect to that with the largest:</p>\n<ul>\n",
        set_in_words(results, 0)
    );
    for (set, Change { panels, fewer, more, least, most }) in changes {
        let unsure = panels - fewer - more;
        let change = |(panel, d): (_, Estimate)| {
            format!("<b>{}</b> with {}", escaped(&drop_in_words(&d)), escaped(&place(results, panel)))
        };
        text += &format!(
            "<li><strong>{}</strong>: fewer in {fewer} of {panels} panels, more in {more}, no sure difference in {unsure}; from {} \
             to {}.</li>\n",
            set_in_words(results, set),
            change(least),
            change(most)
        );
    }
    text + "</ul>\n"
}

fn how_sure(results: &Results, findings: &[SetFindings<'_>]) -> String {
    let OpenCounts { unstable_modes, ambiguous_modes, divergent, undecided, marginal, failures } =
        OpenCounts::new(results);
    let quiet: usize = findings.iter().map(|found| found.stable.len()).sum();
    let upper = findings.iter().map(|found| found.stable_upper).fold(0.0, f64::max);
    let mut text = format!(
        "<h3>How sure that is</h3>\n<p>Nobody knows friction exactly, so the analysis was repeated with {} random draws of it for each \
         arrangement of contacts, friction law and speed range. The share of the draws in which a mode is unstable is its \
         <dfn>occurrence</dfn>. Each occurrence has limits in parentheses: if the whole study were repeated with other draws, about 95 \
         of 100 such limits would enclose the true share. A <dfn>panel</dfn> is one friction law with one number of contacts and one \
         speed range; its occurrence is the median over its arrangements.</p>\n<ul>\n",
        results.summary.samples
    );
    if quiet > 0 {
        text += &format!(
            "<li>Modes that were unstable in no draw: {quiet}. Each of them is unstable in at most {:.2}\u{a0}% of the draws of an \
             arrangement (95\u{a0}%).</li>\n",
            100.0 * upper
        );
    }
    let divergence = results.divergence_in_words().map(|words| escaped(&words));
    let divergence = divergence
        .unwrap_or_else(|| format!("{divergent} real eigenvalues grow: divergence, instability without oscillation."));
    text += &format!(
        "<li>Of {unstable_modes} unstable modes found, {ambiguous_modes} have a name that is open, where two modes met, or none. They widen the \
         limits upwards.</li>\n<li>{divergence}</li>\n<li>{undecided} \
         verdicts are undecided and count as stable. {marginal} eigenvalues lie on the imaginary axis and neither grow nor decay. \
         {failures} draws or evaluations failed; they may be unstable, and widen the limits upwards.</li>\n<li>Unstable means that a small vibration grows. How loud it gets is not computed.</li>\n</ul>\n"
    );
    text
}

fn modes_table(results: &Results, set: usize, found: &SetFindings<'_>) -> String {
    let caption = set_in_words(results, set);
    if found.unstable.is_empty() {
        return format!("<p>{caption}: none.</p>\n");
    }
    let mut text = format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Unstable modes of {caption}\"><table \
         class=\"sortable\"><caption>{caption}</caption>\n<thead><tr><th scope=\"col\">Mode</th><th scope=\"col\">Hz</th><th \
         scope=\"col\">Least of a panel</th><th scope=\"col\">Largest of a panel</th><th scope=\"col\">where</th><th \
         scope=\"col\">Largest of an arrangement</th></tr></thead>\n<tbody>\n"
    );
    let cell = |e: &Estimate| format!("<td class=\"number\" data-value=\"{}\">{}</td>", e.value, with_limits(e));
    for (name, range) in &found.unstable {
        let frequency = results.frequency(set, *name);
        let place = if range.most.0.value > 0.0 { place(results, range.most.1) } else { "-".into() };
        text += &format!(
            "<tr><th scope=\"row\">{}</th><td class=\"number\" data-value=\"{}\">{}</td>{}{}<td>{}</td>{}</tr>\n",
            results.mode_label(set, *name),
            frequency.unwrap_or(0.0),
            frequency.map_or("-".into(), hertz),
            cell(&range.least.0),
            cell(&range.most.0),
            escaped(&place),
            cell(&range.largest)
        );
    }
    text + "</tbody></table></div>\n"
}

fn mode_in_words(results: &Results, set: usize, name: ModeLabel) -> String {
    if !name.is_mode() {
        return results.in_words(set, name);
    }
    let label = format!("mode {}", results.mode_label(set, name));
    results.frequency(set, name).map_or(label.clone(), |f| format!("{label} ({} Hz)", hertz(f)))
}

fn set_in_words(results: &Results, set: usize) -> String {
    let sets = &results.plan().labels.constraints;
    match sets.len() {
        1 => format!("Constraints \u{201c}{}\u{201d}", escaped(&sets[set])),
        _ => format!("Set {}, \u{201c}{}\u{201d}", set_letter(set), escaped(&sets[set])),
    }
}

/// A part of the samples in percent.
fn percent(part: f64) -> String {
    format!("{:.1}\u{a0}%", 100.0 * part)
}

fn with_limits(e: &Estimate) -> String {
    format!("{} ({:.1} to {:.1})", percent(e.value), 100.0 * e.lower, 100.0 * e.upper)
}
