//! A case file with values in the place of what is drawn: one brake, as a case that runs.

use std::path::Path;

use toml::{Table, Value};

use super::CaseError;
use super::check::syntax;
use super::set::edited;
use crate::input::{LARGEST_CASE, read_text};

/// The text of a case file, edited by what is `set` in it, in which each input has its value, by its name, as a constant: of `[parameters]`, of `[friction]`, and the speed `v` in
/// the range of a name. Files that it names by their places relative to it are named by where they are. `None` where an input has no field of
/// its own, as one with a draw for each contact.
///
/// # Errors
/// A file that cannot be read.
pub fn with_constants(
    (path, set): (&Path, &[String]),
    values: &[(String, f64)],
    range: Option<&str>,
) -> Result<Option<String>, CaseError> {
    let text = read_text(path, LARGEST_CASE).map_err(|source| CaseError::Read { path: path.to_owned(), source })?;
    let text = edited(path, &text, set)?;
    let mut case: Table = toml::from_str(&text).map_err(|error| syntax(path, &text, &error))?;
    for (name, value) in values {
        let field = match holder(&case, name) {
            Some(holder) => case.get_mut(holder).and_then(|table| table.get_mut(name)).and_then(Value::as_table_mut),
            None => None,
        };
        match field {
            Some(field) => {
                field.retain(|key, _| key == "unit");
                field.insert("distribution".into(), "constant".into());
                field.insert("value".into(), (*value).into());
            }
            None if name == "v" => {
                let ranges = case.get_mut("speeds").and_then(Value::as_array_mut).map(|ranges| ranges.iter_mut());
                let is_chosen =
                    |each: &Table| range.is_none_or(|range| each.get("name").and_then(Value::as_str) == Some(range));
                let mut tables = ranges.into_iter().flatten().filter_map(Value::as_table_mut);
                let Some(chosen) = tables.find(|each| is_chosen(each)) else { return Ok(None) };
                chosen.insert("from".into(), (*value).into());
                chosen.insert("to".into(), (*value).into());
            }
            None => return Ok(None),
        }
    }
    // Constants have no correlation.
    case.remove("correlation");
    if let Ok(folder) = path.parent().unwrap_or(Path::new("")).canonicalize() {
        case.iter_mut().for_each(|(_, value)| name_where_they_are(value, &folder));
    }
    Ok(toml::to_string(&case).ok())
}

/// The table of a case that has a distribution of this name.
fn holder(case: &Table, name: &str) -> Option<&'static str> {
    let has = |table: &&str| case.get(*table).and_then(|table| table.get(name)).is_some_and(Value::is_table);
    ["parameters", "friction"].into_iter().find(has)
}

/// Names the files in a value by where they are.
fn name_where_they_are(value: &mut Value, folder: &Path) {
    match value {
        Value::String(text) if folder.join(&text).is_file() => {
            if let Some(place) = folder.join(&text).to_str() {
                *text = place.into();
            }
        }
        Value::Array(all) => all.iter_mut().for_each(|value| name_where_they_are(value, folder)),
        Value::Table(all) => all.iter_mut().for_each(|(_, value)| name_where_they_are(value, folder)),
        _ => {}
    }
}
