//! The modes of each set of constraints where they have their names: frequencies, shapes, and links to the modes of another set.

use cea::Mode;
use num_complex::Complex;
use output::Table;
use study::{ModeLabel, Reference, SetLinks, origin_of_set};

use super::Results;

/// Least MAC of two modes that are listed as alike; chosen: below, a shape has little of the other.
const LEAST_LISTED_MAC: f64 = 0.1;

impl Results {
    /// The modes of a set of constraints at its origin with their names, ascending in frequency.
    pub fn modes_of_set(&self, constraints: usize) -> Vec<(ModeLabel, &Mode)> {
        let Some(origin) = origin_of_set(self.plan(), constraints) else { return Vec::new() };
        let modes = &self.origins()[origin].modes;
        self.places_of_set(constraints).into_iter().map(|(name, at)| (name, &modes[at])).collect()
    }

    /// Names of the modes of a set of constraints at its origin, ascending in frequency, each with its place in the list of that origin.
    fn places_of_set(&self, constraints: usize) -> Vec<(ModeLabel, usize)> {
        let Some(origin) = origin_of_set(self.plan(), constraints) else { return Vec::new() };
        let Reference { names, modes, .. } = &self.origins()[origin];
        let name = |at: usize| {
            // Equal modes share their names: each takes one of them, it does not matter which.
            let before = names[..at].iter().filter(|other| **other == names[at]).count();
            let name = names[at].get(before).or(names[at].first())?;
            Some((self.name(constraints, *name), at))
        };
        (0..modes.len()).filter_map(name).collect()
    }

    /// The frequency of a mode of a set of constraints where it has its name, Hz.
    pub fn frequency(&self, constraints: usize, name: ModeLabel) -> Option<f64> {
        let modes = self.modes_of_set(constraints);
        modes.iter().find(|(other, _)| *other == name).map(|(_, mode)| cea::frequency_hz(mode.lambda))
    }

    /// Label of a mode where modes of several sets of constraints can meet: with the letter of its set, `B16`; its number
    /// alone where there is one set.
    pub fn mode_label(&self, constraints: usize, name: ModeLabel) -> String {
        if self.plan().labels.constraints.len() == 1 || !name.is_mode() {
            return name.to_string();
        }
        format!("{}{name}", set_letter(constraints))
    }
}

/// The letter of a set of constraints: A is the first one, AA follows Z.
pub fn set_letter(constraints: usize) -> String {
    let last = char::from(b'A' + (constraints % 26) as u8);
    match constraints / 26 {
        0 => last.to_string(),
        before => set_letter(before - 1) + &last.to_string(),
    }
}

/// The table `shapes-SET` of each set of constraints, and `modes`.
pub(super) fn modes(results: &Results) -> Vec<Table> {
    let (plan, mut rows, mut tables) = (results.plan(), Vec::new(), Vec::new());
    for (constraints, set) in plan.labels.constraints.iter().enumerate() {
        let Some(origin) = origin_of_set(plan, constraints) else { continue };
        let shapes_of_set = format!("shapes-{set}");
        let shape_file = format!("{shapes_of_set}.csv");
        let free = plan.origins[origin].brake.dofs.free();
        let mut shapes = Vec::new();
        for (name, at) in results.places_of_set(constraints) {
            let mode = &results.origins()[origin].modes[at];
            let label = results.mode_label(constraints, name);
            let damping_ratio = -mode.lambda.re / mode.lambda.norm();
            let numbers = [cea::frequency_hz(mode.lambda), mode.lambda.re, damping_ratio].map(|x| x.to_string());
            rows.push(
                [set.clone(), name.to_string(), label].into_iter().chain(numbers).chain([shape_file.clone()]).collect(),
            );
            let own = || free.iter().zip(mode.shape.iter()).map(|(&dof, &u)| (plan.labels.dof(dof), u)).collect();
            let whole = results.whole_shapes.as_ref().map(|of_sets| of_sets[constraints][at].clone());
            let rows =
                |(dof, u): (String, Complex<f64>)| vec![name.to_string(), dof, u.re.to_string(), u.im.to_string()];
            shapes.extend(whole.unwrap_or_else(own).into_iter().map(rows));
        }
        tables.push(Table::new(shapes_of_set, ["mode", "dof", "re", "im"], shapes));
    }
    let header = ["constraints", "mode", "label", "frequency_hz", "growth_rate", "damping_ratio", "shape_file"];
    tables.push(Table::new("modes", header, rows));
    tables
}

/// The table `links`: links of the modes of a set of constraints to the modes of a set that holds more.
pub(super) fn links_table(results: &Results, links: &[SetLinks]) -> Table {
    let (names, mut rows) = (&results.plan().labels.constraints, Vec::new());
    for link in links {
        let (from, to) = (results.modes_of_set(link.from), results.modes_of_set(link.to));
        for (i, (from_name, from_mode)) in from.iter().enumerate() {
            for (j, (to_name, to_mode)) in to.iter().enumerate() {
                let continuation = match (link.becomes[i].contains(&Some(j)), link.becomes[i].len()) {
                    (false, _) => "no",
                    (true, 1) => "yes",
                    (true, _) => "open",
                };
                if continuation == "no" && link.mac[(i, j)] < LEAST_LISTED_MAC {
                    continue;
                }
                rows.push(vec![
                    names[link.from].clone(),
                    results.mode_label(link.from, *from_name),
                    cea::frequency_hz(from_mode.lambda).to_string(),
                    names[link.to].clone(),
                    results.mode_label(link.to, *to_name),
                    cea::frequency_hz(to_mode.lambda).to_string(),
                    link.mac[(i, j)].min(1.0).to_string(),
                    continuation.into(),
                ]);
            }
        }
    }
    let header =
        ["from_constraints", "from_mode", "from_hz", "to_constraints", "to_mode", "to_hz", "mac", "continuation"];
    Table::new("links", header, rows)
}

#[cfg(test)]
mod tests {
    use super::set_letter;

    #[test]
    fn letters_go_on_after_z() {
        assert_eq!([0, 1, 25, 26, 27, 702].map(set_letter), ["A", "B", "Z", "AA", "AB", "AAA"]);
    }
}
