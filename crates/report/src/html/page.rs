//! The document: its parts put together.

use std::path::Path;

use output::write;
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::text::{base64, escaped, filled, json_in_script};
use crate::Error;

/// The script: one function, so that no name of it is global.
const SCRIPT: &str = concat!(
    "'use strict';\n(() => {\n",
    include_str!("common.js"),
    include_str!("tables.js"),
    include_str!("occurrence.js"),
    include_str!("bodies.js"),
    include_str!("view.js"),
    include_str!("lines.js"),
    include_str!("surface.js"),
    include_str!("shapes.js"),
    include_str!("start.js"),
    "})();\n"
);
const STYLE: &str = include_str!("style.css");

/// Contents that make one page differ from another. All but the title and the data are HTML.
pub(super) struct Page {
    pub title: String,
    pub answer: String,
    pub figures: String,
    pub facts: String,
    pub data: Value,
}

impl Page {
    /// The document.
    pub fn html(&self) -> String {
        let hash = |text: &str| format!("'sha256-{}'", base64(&Sha256::digest(text.as_bytes())));
        let values = [
            ("style-hash", hash(STYLE)),
            ("script-hash", hash(SCRIPT)),
            ("title", escaped(&self.title)),
            ("style", STYLE.to_owned()),
            ("answer", self.answer.clone()),
            ("figures", self.figures.clone()),
            ("facts", self.facts.clone()),
            ("data", json_in_script(&self.data)),
            ("script", SCRIPT.to_owned()),
        ];
        filled(include_str!("page.html"), &values.each_ref().map(|(name, value)| (*name, value.as_str())))
    }

    /// Writes the document.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        Ok(write(path, self.html().as_bytes())?)
    }
}
