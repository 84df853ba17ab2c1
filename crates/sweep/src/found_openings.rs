//! Openings of contact points in the results of a sweep, for people and for machines.

use output::Table;

use super::words::{count, hertz};
use super::{ChangeOf, Jump, LineChange, MapLines, Opening, StabilityMap, Sweep, SweptParameter};

/// The openings, with the largest jump of a branch at each.
pub(super) fn opening_table(sweep: &Sweep) -> Table {
    let row = |found: &Opening| {
        let [before, beyond] = found.unresolved;
        let counts = [found.continuous, found.jumping, before, beyond].map(|count| count.to_string());
        let jump = |of: &dyn Fn(&Jump) -> String| found.largest.as_ref().map_or(String::new(), of);
        let mut row =
            vec![found.at.to_string(), found.width.to_string(), found.opens.join(" "), found.closes.join(" ")];
        row.extend(counts);
        row.push(jump(&|jump| jump.mode.clone()));
        row.extend([0, 1].map(|end| jump(&|jump| hertz(jump.omega[end]).to_string())));
        row.extend([0, 1].map(|end| jump(&|jump| jump.growth[end].to_string())));
        row
    };
    let name = sweep.parameter.name.as_str();
    let header = [
        name,
        "width",
        "opens",
        "closes",
        "continuous",
        "jumping",
        "open_before",
        "open_beyond",
        "largest_jump",
        "frequency_hz",
        "frequency_hz_beyond",
        "growth",
        "growth_beyond",
    ];
    Table::new("openings", header, sweep.openings.iter().map(row))
}

/// Openings in words; nothing of a brake whose contact points do not open.
pub(super) fn opening_text(sweep: &Sweep) -> String {
    let (Some(steps), SweptParameter { name, .. }) = (sweep.opening_steps, &sweep.parameter) else {
        return String::new();
    };
    let mut text = format!("\n{} of contact points", count(sweep.openings.len(), "opening", "openings"));
    if !sweep.openings.is_empty() {
        let heads = ["opens", "closes", "smooth", "jump", "mode", "largest jump, Hz", "of the growth, 1/s"];
        let [opens, closes, smooth, jump, mode, hz, growth] = heads;
        text +=
            &format!(", between which branches are smooth:\n\n{name:>22}  {:>8}  {opens:>6}  {closes:>6}  ", "width");
        text += &format!("{smooth:>6}  {jump:>6}  {mode:>8}  {hz:>16}  {growth:>18}\n");
    }
    if sweep.openings.is_empty() {
        text += "\n";
    }
    for found in &sweep.openings {
        let Opening { at, width, continuous, jumping, .. } = found;
        let (opens, closes) = (found.opens.len(), found.closes.len());
        let (mode, by_hz, by_growth) = found.largest.as_ref().map_or(("-", "-".into(), "-".into()), |jump| {
            let [by_omega, by_growth] = [jump.omega, jump.growth].map(|[before, beyond]| beyond - before);
            (jump.mode.as_str(), format!("{:.4}", hertz(by_omega)), format!("{by_growth:.4}"))
        });
        text += &format!("{at:>22}  {width:>8.1e}  {opens:>6}  {closes:>6}  {continuous:>6}  {jumping:>6}  ");
        text += &format!("{mode:>8}  {by_hz:>16}  {by_growth:>18}");
        let [before, beyond] = found.unresolved;
        if before + beyond > 0 {
            text += &format!("  {before} before and {beyond} beyond are not joined");
        }
        text += "\n";
    }
    let jumps: usize = sweep.openings.iter().map(|opening| opening.jumping).sum();
    if jumps > 0 {
        text += &format!(
            "{} of branches: the stiffness of a point is there up to its opening and not beyond\n",
            count(jumps, "jump", "jumps")
        );
    }
    text + &format!("points that open and close again within {} are not seen\n", sweep.parameter.step_in_words(steps))
}

/// The changes of the number of unstable modes on the lines of a map.
pub(super) fn change_table([x, y]: [&str; 2], lines: &MapLines) -> Table {
    let change = |change: &LineChange| {
        let numbers =
            [change.at[0], change.at[1], change.by as f64, hertz(change.omega)].map(|number| number.to_string());
        let at = match change.of {
            None => "opening",
            Some(ChangeOf::Band) => "end-of-band",
            Some(_) => "onset",
        };
        numbers.into_iter().chain([at.into()]).collect()
    };
    let header = [x, y, "unstable_modes", "frequency_hz", "at"];
    Table::new("changes", header, lines.changes.iter().map(change))
}

/// Words for the lines of a map; nothing of one whose boundary is followed.
pub(super) fn lines_text(map: &StabilityMap) -> String {
    let [x, y] = map.parameters.each_ref().map(|parameter| parameter.name.as_str());
    let Some(MapLines { along, lines, openings, changes }) = &map.lines else { return String::new() };
    let (name, across) = if *along == 0 { (x, y) } else { (y, x) };
    let jumps = changes.iter().filter(|change| change.of.is_none()).count();
    let at_ends = changes.iter().filter(|change| change.of == Some(ChangeOf::Band)).count();
    let changed = count(changes.len(), "change", "changes");
    let mut text = format!("{changed} of the number of unstable modes on {lines} lines along {name}\n");
    if *openings > 0 {
        text += &format!(
            "contact points open or close at {openings} places of them; {jumps} of the changes are jumps there\n"
        );
    }
    if at_ends > 0 {
        let modes = if at_ends == 1 {
            "a growing mode enters the band or leaves it"
        } else {
            "growing modes enter the band or leave it"
        };
        text += &format!("at {at_ends} of the changes {modes}\n");
    }
    text + &format!(
        "so the boundary is not followed: along {name} it is exact on each line, over {across} it is within 1/{} of the range\n\n",
        2 * (lines - 1),
    )
}
