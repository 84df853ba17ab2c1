//! What a check says, line by line.

use serde_json::{Value, json};

/// What a line begins with that a user should act on.
const WARNING: &str = "WARNING: ";

/// Lines of a check, each with the name of what it is about; one without a name belongs to that before it.
#[derive(Debug, Default)]
pub(super) struct Lines(Vec<(String, String)>);

impl Lines {
    /// Adds a line.
    pub fn add(&mut self, name: &str, value: impl Into<String>) {
        self.0.push((name.into(), value.into()));
    }

    /// Adds the lines of another part.
    pub fn extend(&mut self, others: Self) {
        self.0.extend(others.0);
    }

    /// These lines and others after them.
    pub fn and(mut self, others: Self) -> Self {
        self.extend(others);
        self
    }

    /// The lines, for people.
    pub fn text(&self) -> String {
        self.0.iter().map(|(name, value)| format!("  {name:<13} {value}\n")).collect()
    }

    /// The warnings among them.
    pub fn warnings(&self) -> Vec<&str> {
        self.0.iter().filter_map(|(_, value)| value.strip_prefix(WARNING)).collect()
    }

    /// The lines as a list of objects, for machines.
    pub fn json(&self) -> Value {
        self.0.iter().map(|(name, value)| json!({ "name": name, "value": value })).collect()
    }
}
