//! Sets of nodes and elements.

use std::collections::{BTreeMap, HashMap};

use super::keyword::set_name;
use crate::mesh::Mesh;
use crate::numbers::signed;
use crate::problem::Problem;
use crate::shortened::cut;

/// A range of numbers with a step, as after `GENERATE`.
pub(super) struct Range {
    first: i64,
    last: i64,
    step: i64,
}

impl Range {
    /// # Errors
    /// Other fields than first, last and perhaps step.
    pub fn new<'a>(fields: impl Iterator<Item = &'a str>) -> Result<Self, Problem> {
        let numbers = fields.map(|field| signed("number of a range", field)).collect::<Result<Vec<_>, _>>()?;
        match numbers[..] {
            [first, last] => Ok(Self { first, last, step: 1 }),
            [first, last, step] if step > 0 => Ok(Self { first, last, step }),
            _ => {
                let allowed = "first, last and, if not 1, step > 0";
                Err(Problem::Fields { what: "a range", found: numbers.len(), allowed })
            }
        }
    }

    /// True if a number is one of the range.
    pub fn has(&self, number: i64) -> bool {
        let steps = (i128::from(number) - i128::from(self.first)) % i128::from(self.step);
        (self.first..=self.last).contains(&number) && steps == 0
    }
}

/// Adds members to a set. One with more members than there are things in all has some twice; they go, so that a set that is added to
/// itself again and again does not grow.
pub(super) fn add(set: &mut Vec<i64>, members: Vec<i64>, all: usize) {
    set.extend(members);
    if set.len() > all {
        set.sort_unstable();
        set.dedup();
    }
}

/// The elements of a deck with their nodes, and sets of them. Only sets of nodes that are made of them are looked at, so that a fault of
/// a set is one where it is used.
#[derive(Default)]
pub(super) struct Elements {
    /// Range in `nodes` of the nodes of each element, by its number: first, and one past the last. `Err` for an element of a type that is
    /// not known: index of the type's name in `unknown`.
    of: HashMap<i64, Result<(usize, usize), usize>>,
    /// Indices in the mesh of the nodes of all elements, in turn.
    nodes: Vec<usize>,
    /// Names of types of which it is not known how many nodes they have.
    unknown: Vec<String>,
    sets: BTreeMap<String, Vec<i64>>,
    /// Sets that were named before they were defined, each with one that was made of it.
    missing: BTreeMap<String, String>,
}

impl Elements {
    pub fn add(&mut self, element: i64, places: &[usize], set: Option<&str>) -> Result<(), Problem> {
        let from = self.nodes.len();
        self.nodes.extend(places);
        if let Some(Ok(_)) = self.of.insert(element, Ok((from, self.nodes.len()))) {
            return Err(Problem::field("element", element, "each number once"));
        }
        self.add_to(set, element);
        Ok(())
    }

    /// Adds an element of which nobody knows where its nodes end.
    pub fn add_unknown(&mut self, element: i64, of_type: &str, set: Option<&str>) {
        let known = self.unknown.iter().position(|name| name == of_type);
        let at = known.unwrap_or_else(|| {
            self.unknown.push(of_type.to_owned());
            self.unknown.len() - 1
        });
        self.of.entry(element).or_insert(Err(at));
        self.add_to(set, element);
    }

    fn add_to(&mut self, set: Option<&str>, element: i64) {
        if let Some(set) = set {
            match self.sets.get_mut(set) {
                Some(own) => own.push(element),
                None => {
                    self.sets.insert(set.to_owned(), vec![element]);
                }
            }
        }
    }

    /// Adds all elements of a range; numbers without an element are passed over.
    pub fn add_range(&mut self, set: &str, range: &Range) {
        let members: Vec<i64> = self.of.keys().copied().filter(|element| range.has(*element)).collect();
        add(self.sets.entry(set.to_owned()).or_default(), members, self.of.len());
    }

    /// Adds an element or the elements of a set.
    pub fn add_member(&mut self, set: &str, field: &str) -> Result<(), Problem> {
        let members = match field.parse::<i64>() {
            Ok(element) => vec![element],
            Err(_) => {
                let name = set_name(field)?;
                if let Some(missing) = self.missing.get(&name).cloned() {
                    self.missing.insert(set.to_owned(), missing);
                }
                let members = self.sets.get(&name).cloned();
                members.unwrap_or_else(|| {
                    self.missing.insert(set.to_owned(), name);
                    Vec::new()
                })
            }
        };
        let own = self.sets.entry(set.to_owned()).or_default();
        // Numbers without an element are refused where the set is used.
        let all = self.of.len().max(own.len() + 1);
        add(own, members, all);
        Ok(())
    }

    /// The sets, each ascending.
    pub fn into_sets(self) -> BTreeMap<String, Vec<i64>> {
        let mut sets = self.sets;
        for elements in sets.values_mut() {
            elements.sort_unstable();
            elements.dedup();
        }
        sets
    }

    /// Numbers of the nodes of a set of elements.
    ///
    /// # Errors
    /// A set, or an element in it, that is not defined above or of a type that is not known.
    pub fn nodes_of(&self, set: &str, mesh: &Mesh) -> Result<Vec<i64>, Problem> {
        let not_above = |name: &str| Problem::field("element set", cut(name), "a set that is defined above");
        let elements = self.sets.get(set).ok_or_else(|| not_above(set))?;
        if let Some(missing) = self.missing.get(set) {
            return Err(not_above(missing));
        }
        let mut places: Vec<usize> = Vec::new();
        for element in elements {
            match self.of.get(element) {
                Some(Ok((from, to))) => places.extend(&self.nodes[*from..*to]),
                Some(Err(of)) => {
                    let found = format!("{element} of type {}", self.unknown[*of]);
                    return Err(Problem::field("element", found, "elements of types whose nodes are known here"));
                }
                None => return Err(Problem::field("element", element, "an element that is defined above")),
            }
        }
        places.sort_unstable();
        places.dedup();
        Ok(places.into_iter().map(|place| mesh.nodes[place].label).collect())
    }
}
