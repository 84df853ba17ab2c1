//! A file that is made by a task, and must be as the task makes it.

use std::path::PathBuf;

use squeal::output::write;

use crate::error::TaskError;

/// Text of a file of the project that a task makes.
pub(super) struct Made {
    pub path: PathBuf,
    pub text: String,
    /// Task that makes it.
    pub task: &'static str,
}

impl Made {
    /// Writes the file.
    pub fn write(&self) -> Result<(), TaskError> {
        Ok(write(&self.path, self.text.as_bytes())?)
    }

    /// The complaint about a file that is another one by now.
    pub fn fault(&self) -> Option<String> {
        let there = std::fs::read_to_string(&self.path).unwrap_or_default();
        let task = self.task;
        (there != self.text).then(|| format!("{}: not as made; `cargo xtask {task}` makes it", self.path.display()))
    }
}

#[cfg(test)]
mod tests {
    use crate::release::refusals;

    #[test]
    fn the_page_of_refusals_is_that_of_the_errors() {
        let pages = refusals::pages(&crate::root()).unwrap();
        assert_eq!(pages.each_ref().map(|page| page.fault()), [None, None, None]);
        let [page, _, _] = pages;
        // A message with fields, one with arguments, one with a function of a field.
        for message in [
            "**`{path}: {field} = {value}; allowed: {allowed}`**",
            "**`no matrix {name}{reason}; allowed: {allowed}`**",
            "**`{option} = {value}; allowed: {allowed}`**",
        ] {
            assert!(page.text.contains(message), "{message}");
        }
    }
}
