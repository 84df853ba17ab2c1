//! Folder of results of a command: its manifest, whether it is given back after an error, and words on where it is.

use std::path::Path;

use output::printable;
use serde_json::{Value, json};
use squeal::folder::RunFolder;
use squeal::results::Source;
use squeal::study::Plan;

use crate::Error;

/// Writes `manifest.json` into a folder: the program, the case and the study, threads and seconds, and what the command adds, whose keys are
/// none of these. Files that the case names are not in it.
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

/// The answer with its folder. Of a question that has no answer however often it is asked, the folder is given back where it holds nothing but `kept`, the file of what was
/// found on the way, and this file with it; after any other error both stay, to go on from.
///
/// # Errors
/// The error of a question without an answer.
pub(super) fn or_given_back<T>(
    found: Result<T, impl Into<squeal::Error>>,
    folder: Option<RunFolder>,
    kept: &str,
) -> Result<(T, Option<RunFolder>), Error> {
    match found {
        Ok(found) => Ok((found, folder)),
        Err(error) => {
            let error = error.into();
            if let Some(folder) = folder.filter(|_| is_final(&error)) {
                folder.give_back(kept);
            }
            Err(error.into())
        }
    }
}

/// True of an error that the same command ends with whenever it is given: all but those of work that was cancelled, and of files.
fn is_final(error: &squeal::Error) -> bool {
    use squeal::Error::{FolderLost, Output, Read};
    !(error.is_cancelled() || matches!(error, Output(_) | Read { .. } | FolderLost { .. }))
}

/// Words on where the results are, to end a line with; empty where there is no folder.
pub(super) fn place(dir: Option<&Path>) -> String {
    dir.map_or_else(String::new, |dir| format!("; results in {}", printable(&dir.display().to_string())))
}
