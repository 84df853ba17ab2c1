//! Fields of a case file set from outside, as by `--set mu=0.3`.

use std::path::Path;

use toml_edit::{ArrayOfTables, DocumentMut, InlineTable, Item, Key, Table, TableLike, Value};

use super::CaseError;
use super::check::Check;

/// Tables whose entries are distributions, which their names alone are enough for.
const DRAWN: [&str; 2] = ["parameters", "friction"];

/// Tables of a case whose fields are parameters that can be swept.
const OF_PARAMETERS: [&str; 3] = ["parameters", "friction", "lattice"];

/// Lists of tables that a case need not have, and to which one can be added.
const LISTS: [&str; 8] = ["bodies", "constraints", "contacts", "forces", "holders", "rotation", "speeds", "springs"];

/// The name of the parameter that a field holds, as `x_damping` of `lattice.x_damping`: what is set by its field is swept by it too. Any other
/// name stays.
#[must_use]
pub fn parameter_of(field: &str) -> &str {
    let inner = |table: &str| field.strip_prefix(table)?.strip_prefix('.');
    OF_PARAMETERS.into_iter().find_map(inner).unwrap_or(field)
}

/// The text of a case with fields set, each as `NAME=VALUE`, in their order; all else stays as it is written. A text that is no TOML stays,
/// for its reader to say where.
///
/// NAME is a parameter, or a field as a dotted key of TOML, in which a table of a list goes by its `name`. VALUE is one of TOML, or text
/// without quotes. A number in place of a distribution is the constant, and a distribution keeps the unit that it had. A table of a list as a
/// whole takes the place of the one with its name, or is added to the list.
///
/// # Errors
/// [`CaseError::Value`] for a name that the case does not have. Whether a value is allowed is for its reader to say.
pub(super) fn edited(path: &Path, text: &str, set: &[String]) -> Result<String, CaseError> {
    let Ok(mut document) = text.parse::<DocumentMut>() else { return Ok(text.to_owned()) };
    for setting in set {
        let refused = |allowed: String| Check::new(path).value("set", setting, &allowed);
        let (name, value) = setting.split_once('=').ok_or_else(|| refused("NAME=VALUE".into()))?;
        let name = name.trim();
        let keys = Key::parse(name).map_err(|_| refused(format!("a dotted key of TOML before =; {name:?} is none")))?;
        let value = match value.trim().parse::<Value>() {
            Ok(value) => value,
            // What begins as a list or a table is meant as one.
            Err(error) if value.trim().starts_with(['{', '[']) => {
                let reason = error.to_string();
                let reason = reason.lines().last().unwrap_or_default().to_owned();
                return Err(refused(format!("a value of TOML, which {} is not: {reason}", value.trim())));
            }
            Err(_) => Value::from(value.trim()),
        };
        put(document.as_table_mut(), &keys, value).map_err(refused)?;
    }
    Ok(document.to_string())
}

/// The fault of the parser in a text with fields set: at its line of the file, or of what was set where the file has no such line.
pub(super) fn placed(error: CaseError, text: &str, set: &[String]) -> CaseError {
    let CaseError::Syntax { path, line, message } = error else { return error };
    let with = |count: usize| edited(&path, text, &set[..count]).unwrap_or_default();
    let whole = with(set.len());
    let at_fault = whole.lines().nth(line - 1).unwrap_or_default();
    let before = whole.lines().take(line - 1).filter(|line| *line == at_fault).count();
    let place =
        |text: &str| text.lines().enumerate().filter(|(_, line)| *line == at_fault).map(|(at, _)| at + 1).nth(before);
    if let Some(line) = place(text) {
        return CaseError::Syntax { path, line, message };
    }
    match (1..=set.len()).find(|&count| place(&with(count)).is_some()) {
        Some(count) => CaseError::Setting { setting: set[count - 1].clone(), path, message },
        None => CaseError::Syntax { path, line, message },
    }
}

/// Puts a value into a document; the error says what is allowed.
fn put(document: &mut Table, keys: &[Key], value: Value) -> Result<(), String> {
    // A table that is in another one alone needs no name of that, as no field does.
    if let [first, _, ..] = keys
        && let Some(outer) = only_table_with(document, first.get())
    {
        return put(document, &[&[Key::new(outer)], keys].concat(), value);
    }
    if let ([list, name], Value::InlineTable(table)) = (keys, &value)
        && let Some(list) = list_of(document, list.get())
    {
        put_in_list(list, name.get(), table.clone());
        return Ok(());
    }
    let (table, key) = match keys {
        [name] => (parameters_with(document, name.get())?, name),
        [table, key] if !document.contains_key(table.get()) => {
            // Tables that a case need not have; what is no table of a case its reader refuses.
            let new = document.entry(table.get()).or_insert(Item::Table(Table::new()));
            (new.as_table_like_mut().ok_or("the name of a table")?, key)
        }
        [tables @ .., key] => (inner(document, tables)?, key),
        [] => return Err("NAME=VALUE".into()),
    };
    match table.get_mut(key.get()) {
        Some(item) if is_distribution(item) => distribution(item, value),
        Some(Item::Value(old)) => {
            let decor = old.decor().clone();
            *old = value;
            *old.decor_mut() = decor;
            Ok(())
        }
        Some(_) => Err(format!("a field of {}", key.get())),
        None => {
            table.insert(key.get(), Item::Value(value));
            Ok(())
        }
    }
}

/// The list of tables of this name, made where a case need not have it.
fn list_of<'a>(document: &'a mut Table, name: &str) -> Option<&'a mut ArrayOfTables> {
    if LISTS.contains(&name) && !document.contains_key(name) {
        document.insert(name, Item::ArrayOfTables(ArrayOfTables::new()));
    }
    document.get_mut(name)?.as_array_of_tables_mut()
}

/// Puts a table into a list, in the place of the one that has its name.
fn put_in_list(list: &mut ArrayOfTables, name: &str, table: InlineTable) {
    let mut new = table.into_table();
    new.insert("name", Item::Value(name.into()));
    let place = list.iter().position(|old| named(old) == Some(name));
    match place.and_then(|place| list.get_mut(place)) {
        Some(old) => {
            new.set_position(old.position());
            *old = new;
        }
        None => list.push(new),
    }
}

/// The name of a table of a list.
fn named(table: &Table) -> Option<&str> {
    table.get("name").and_then(Item::as_str)
}

/// The one table of a document that has a table of this name within it; `None` where the document has one of its own.
fn only_table_with(document: &Table, name: &str) -> Option<String> {
    let has_table = |(_, item): &(&str, &Item)| {
        item.as_table_like().and_then(|of| of.get(name)).is_some_and(|inner| inner.is_table_like())
    };
    let mut tables = document.iter().filter(has_table).map(|(table, _)| table.to_owned());
    tables.next().filter(|_| tables.next().is_none() && !document.contains_key(name))
}

fn is_distribution(item: &Item) -> bool {
    item.get("distribution").is_some()
}

/// The table of a document in which a parameter is drawn.
fn parameters_with<'a>(document: &'a mut Table, name: &str) -> Result<&'a mut dyn TableLike, String> {
    let drawn = |table: &'static str| {
        let entries = document.get(table).and_then(Item::as_table_like);
        entries.into_iter().flat_map(|entries| entries.iter()).filter(|(_, item)| is_distribution(item))
    };
    let names: Vec<(&str, &str)> =
        DRAWN.into_iter().flat_map(|table| drawn(table).map(move |(of, _)| (table, of))).collect();
    let allowed = || {
        let names: Vec<&str> = names.iter().map(|(_, name)| *name).collect();
        format!("{}, or a field as table.key", names.join(", "))
    };
    let mut tables = names.iter().filter(|(_, of)| *of == name).map(|(table, _)| *table);
    match (tables.next(), tables.next()) {
        (Some(table), None) => {
            document.get_mut(table).and_then(Item::as_table_like_mut).ok_or_else(|| "a parameter".into())
        }
        (Some(_), Some(_)) => {
            Err(format!("{}, of which there are two", DRAWN.map(|of| format!("{of}.{name}")).join(" or ")))
        }
        // A field that is in one table alone needs no name of that.
        (None, _) => {
            let has_field = |(_, item): &(&str, &Item)| item.as_table_like().is_some_and(|of| of.contains_key(name));
            let tables: Vec<String> = document.iter().filter(has_field).map(|(table, _)| table.to_owned()).collect();
            match &tables[..] {
                [] => Err(allowed()),
                [table] => document.get_mut(table).and_then(Item::as_table_like_mut).ok_or_else(|| "a field".into()),
                several => {
                    let keys: Vec<String> = several.iter().map(|table| format!("{table}.{name}")).collect();
                    Err(format!("{}, of which there are {}", keys.join(" or "), keys.len()))
                }
            }
        }
    }
}

/// The table that `keys` lead to.
fn inner<'a>(table: &'a mut dyn TableLike, keys: &[Key]) -> Result<&'a mut dyn TableLike, String> {
    let Some((key, rest)) = keys.split_first() else { return Ok(table) };
    let known: Vec<String> = table.iter().filter(|(_, item)| !item.is_value()).map(|(key, _)| key.to_owned()).collect();
    match table.get_mut(key.get()) {
        Some(Item::ArrayOfTables(list)) => {
            let names: Vec<String> = list.iter().filter_map(named).map(str::to_owned).collect();
            let allowed = || format!("a table of {} by its name: {}", key.get(), names.join(", "));
            let (name, rest) = rest.split_first().ok_or_else(allowed)?;
            let found = list.iter_mut().find(|table| named(table) == Some(name.get()));
            inner(found.ok_or_else(allowed)?, rest)
        }
        Some(item) => match item.as_table_like_mut() {
            Some(table) => inner(table, rest),
            None => Err(format!("fields that the case has; {} is no table", key.get())),
        },
        None => Err(format!("a table that the case has: {}", known.join(", "))),
    }
}

/// Puts another distribution in the place of one.
fn distribution(item: &mut Item, value: Value) -> Result<(), String> {
    let new = match value {
        Value::InlineTable(table) => table,
        Value::Integer(_) | Value::Float(_) => {
            InlineTable::from_iter([("distribution", Value::from("constant")), ("value", value)])
        }
        _ => return Err("a number, or a distribution as { distribution = \"uniform\", from = 0.0, to = 1.0 }".into()),
    };
    let Some(table) = item.as_table_like_mut() else { return Err("a distribution".into()) };
    let others: Vec<String> = table.iter().map(|(key, _)| key.to_owned()).filter(|key| key != "unit").collect();
    for key in others {
        table.remove(&key);
    }
    for (key, value) in new {
        table.insert(&key, Item::Value(value));
    }
    table.fmt();
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{edited, parameter_of};
    use crate::CaseFile;

    const CASE: &str = r#"
# A brake.
[study]
samples = 10 # few

[parameters.mu]
unit = "1"
distribution = "uniform"
from = 0.5
to = 1.1

[parameters]
c = { distribution = "normal", mean = 2.0, deviation = 0.1, unit = "Ns/m" } # damping

[[terms]]
name = "pad spring"
coefficient = 1.0
"#;

    fn set(set: &[&str]) -> Result<String, String> {
        let set: Vec<String> = set.iter().map(|&setting| setting.to_owned()).collect();
        edited(Path::new("brake.toml"), CASE, &set).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_set_is_changed_and_all_else_stays() {
        for (setting, from, to) in [
            ("study.samples=20", "samples = 10 # few", "samples = 20 # few"),
            ("parameters.mu.to=1.3", "to = 1.1", "to = 1.3"),
            ("mu=0.3", "distribution = \"uniform\"\nfrom = 0.5\nto = 1.1", "distribution = \"constant\"\nvalue = 0.3"),
            (
                "c = 3",
                r#"{ distribution = "normal", mean = 2.0, deviation = 0.1, unit = "Ns/m" } #"#,
                r#"{ unit = "Ns/m", distribution = "constant", value = 3 } #"#,
            ),
            (
                r#"parameters.c={distribution="uniform", from=1, to=2, unit="kg/s"}"#,
                r#"{ distribution = "normal", mean = 2.0, deviation = 0.1, unit = "Ns/m" } #"#,
                r#"{ unit = "kg/s", distribution = "uniform", from = 1, to = 2 } #"#,
            ),
            (r#"terms."pad spring".coefficient=1.1 * c"#, "coefficient = 1.0", "coefficient = \"1.1 * c\""),
            (
                r#"terms."pad spring".family=springs"#,
                "coefficient = 1.0\n",
                "coefficient = 1.0\nfamily = \"springs\"\n",
            ),
            (
                r#"terms."pad shim"={ coefficient = 2.0, family = "shims" }"#,
                "coefficient = 1.0\n",
                "coefficient = 1.0\n\n[[terms]]\ncoefficient = 2.0\nfamily = \"shims\"\nname = \"pad shim\"\n",
            ),
            (
                "springs.shim = { stiffness = 1e6 }",
                "coefficient = 1.0\n",
                "coefficient = 1.0\n\n[[springs]]\nstiffness = 1e6\nname = \"shim\"\n",
            ),
            (
                r#"terms."pad spring"={ coefficient = 2.0 }"#,
                "name = \"pad spring\"\ncoefficient = 1.0\n",
                "coefficient = 2.0\nname = \"pad spring\"\n",
            ),
            ("accuracy.half_width=0.01", "coefficient = 1.0\n", "coefficient = 1.0\n\n[accuracy]\nhalf_width = 0.01\n"),
        ] {
            let found = set(&[setting]).unwrap();
            assert_eq!(found, CASE.replace(from, to), "{setting}");
            assert_ne!(found, CASE, "{setting}");
        }
        assert_eq!(set(&["mu=1", "parameters.mu.value=2"]).unwrap(), set(&["mu=2"]).unwrap());
        assert_eq!(set(&["mu.to=1.3"]).unwrap(), set(&["parameters.mu.to=1.3"]).unwrap());
    }

    #[test]
    fn a_field_that_is_swept_is_its_parameter() {
        for (field, parameter) in [
            ("lattice.x_damping", "x_damping"),
            ("lattice.plate.mass", "plate.mass"),
            ("friction.mu_k", "mu_k"),
            ("parameters.c", "c"),
            ("plate.mass", "plate.mass"),
            ("lattices.c", "lattices.c"),
            ("mu", "mu"),
        ] {
            assert_eq!(parameter_of(field), parameter);
        }
    }

    #[test]
    fn what_a_case_does_not_have_is_refused_with_what_it_has() {
        for (setting, allowed) in [
            ("mu", "NAME=VALUE"),
            ("=1", "a dotted key of TOML before =; \"\" is none"),
            ("muu=0.3", "mu, c, or a field as table.key"),
            ("mu=.5", "a number, or a distribution as"),
            ("parameters.nu.to=1", "a table that the case has: mu"),
            ("terms=1", "mu, c, or"),
            ("terms.springs.coefficient=2", "a table of terms by its name: pad spring"),
            ("study.samples.most=1", "samples is no table"),
            ("terms.shim={ stiffness = [[1.0, 0.0] [0.0, 0.0]] }", "a value of TOML, which { stiffness = "),
        ] {
            let refused = set(&[setting]).unwrap_err();
            assert!(refused.starts_with(&format!("brake.toml: set = {setting}; allowed: ")), "{refused}");
            assert!(refused.contains(allowed), "{refused}");
        }
    }

    #[test]
    fn a_fault_is_that_of_the_file_at_its_line_or_of_what_was_set() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("brake.toml");
        let case = "[study]\nname = \"n\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\n[parameters.k]\ndistribution = \"uniform\"\n\
                    from = 1.0\nto = 2.0\n[[terms]]\nname = \"all\"\nmass = [[1.0]]\nstiffness = [[1.0]]\ncoefficient = \"k\"\n";
        let refused = |text: &str, set: &[&str]| {
            std::fs::write(&path, text).unwrap();
            let set: Vec<String> = set.iter().map(|&setting| setting.to_owned()).collect();
            CaseFile::read_with(&path, &set).unwrap_err().to_string()
        };
        for setting in ["kk.from=0.3", "study.sample=5", "study.seed=-1", "terms.all.colour=red"] {
            for others in [&[][..], &["study.name=other", "accuracy.half_width=0.01"]] {
                let found = refused(case, &[others, &[setting], others].concat());
                assert!(found.contains(&format!("brake.toml: --set {setting}: ")), "{found}");
            }
        }
        // A line that moves because of what is set stays that of the file.
        let wrong = case.replace("stiffness = [[1.0]]", "stifness = [[1.0]]");
        for set in [&[][..], &["study.samples=5"], &["parameters.k.unit=N/m"], &["k=1.5"]] {
            assert!(refused(&wrong, set).contains("brake.toml: line 14: stifness"), "{set:?} {}", refused(&wrong, set));
        }
    }
}
