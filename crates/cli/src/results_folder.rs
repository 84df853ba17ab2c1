//! Words that commands which leave results in a folder have in common: where these come from, and where they are.

use std::path::Path;

use output::printable;
use serde_json::{Value, json};
use squeal::folder::RunFolder;
use squeal::results::Source;
use squeal::study::Plan;

use crate::Error;

/// Writes `manifest.json` into a folder: the program, the case and the study, threads and seconds, and what the command adds: enough
/// to make its results again.
///
/// # Errors
/// A file that cannot be written.
pub(super) fn write_manifest(
    folder: &RunFolder,
    plan: &Plan,
    threads: Option<usize>,
    seconds: f64,
    own: Value,
) -> Result<(), Error> {
    let mut manifest = json!(Source::of(plan));
    manifest["threads"] = json!(threads);
    manifest["seconds"] = json!(seconds);
    if let (Value::Object(all), Value::Object(own)) = (&mut manifest, own) {
        all.extend(own);
    }
    Ok(folder.write("manifest.json", format!("{manifest:#}\n").as_bytes())?)
}

/// Words on where the results are, to end a line with; empty where there is no folder.
pub(super) fn place(dir: Option<&Path>) -> String {
    dir.map_or_else(String::new, |dir| format!("; results in {}", printable(&dir.display().to_string())))
}
