//! Fields of a case file set from outside, as by `--set mu=0.3`.

use std::collections::BTreeSet;
use std::path::Path;

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Key, Table, TableLike, Value};

use super::CaseError;
use super::check::Check;

/// Tables whose entries are distributions, which their names alone are enough for.
const DRAWN: [&str; 2] = ["parameters", "friction"];

/// The distribution that draws nothing.
const CONSTANT: &str = "constant";

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
    let drawn = names_of(&document, |distribution| distribution != CONSTANT);
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
    let constant = names_of(&document, |distribution| distribution == CONSTANT);
    uncorrelate(document.as_table_mut(), &drawn.intersection(&constant).cloned().collect());
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

/// Tables and names of parameters whose kind of distribution is so.
fn names_of(document: &Table, is: impl Fn(&str) -> bool) -> BTreeSet<(&'static str, String)> {
    let of_table = |table: &'static str| {
        let entries = document.get(table).and_then(Item::as_table_like);
        let entries = entries.into_iter().flat_map(|entries| entries.iter());
        let so = entries.filter(|(_, item)| item.get("distribution").and_then(Item::as_str).is_some_and(&is));
        so.map(move |(name, _)| (table, name.to_owned()))
    };
    DRAWN.into_iter().flat_map(of_table).collect()
}

/// Takes parameters out of the correlation, their values for contacts and patches (`mu@1`) too: names, rows and columns. Of a field nothing is left without a
/// friction parameter that it is named for, and of the table nothing without a name.
fn uncorrelate(document: &mut Table, constant: &BTreeSet<(&'static str, String)>) {
    let own_name = |name: &str| name.split_once('@').map_or(name, |(own, _)| own).to_owned();
    let friction: BTreeSet<String> = names_of(document, |_| true)
        .into_iter()
        .filter(|(table, _)| *table == "friction")
        .map(|(_, name)| name)
        .collect();
    let Some(table) = document.get_mut("correlation").and_then(Item::as_table_like_mut) else { return };
    let Some(names) = table.get_mut("parameters").and_then(Item::as_array_mut) else { return };
    let all: Vec<Option<String>> = names.iter().map(|name| name.as_str().map(own_name)).collect();
    let is_constant = |name: &Option<String>| constant.iter().any(|(_, of)| Some(of) == name.as_ref());
    let gone: Vec<usize> = (0..all.len()).filter(|&at| is_constant(&all[at])).collect();
    if gone.is_empty() {
        return;
    }
    let take_out = |of: &mut Array| {
        gone.iter().rev().for_each(|&at| drop(of.remove(at)));
    };
    // Another number of rows its reader refuses.
    let has_all = |of: &Array| of.len() == all.len();
    take_out(names);
    if let Some(matrix) = table.get_mut("matrix").and_then(Item::as_array_mut).filter(|of| has_all(of)) {
        take_out(matrix);
        matrix.iter_mut().filter_map(Value::as_array_mut).filter(|row| has_all(row)).for_each(take_out);
    }
    let left: Vec<&String> =
        all.iter().enumerate().filter(|(at, _)| !gone.contains(at)).filter_map(|(_, of)| of.as_ref()).collect();
    if !left.iter().any(|name| friction.contains(*name)) {
        table.remove("field");
    }
    if left.is_empty() || !(table.contains_key("matrix") || table.contains_key("field")) {
        document.remove("correlation");
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
            InlineTable::from_iter([("distribution", Value::from(CONSTANT)), ("value", value)])
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
    use crate::{CaseFile, Correlation};

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
        // A fault in a line that moves because of what is set is said at the line of the file.
        let wrong = case.replace("stiffness = [[1.0]]", "stifness = [[1.0]]");
        for set in [&[][..], &["study.samples=5"], &["parameters.k.unit=N/m"], &["k=1.5"]] {
            assert!(refused(&wrong, set).contains("brake.toml: line 14: stifness"), "{set:?} {}", refused(&wrong, set));
        }
    }

    const NAMES: [&str; 3] = ["a", "b", "c"];
    const SCORES: [[f64; 3]; 3] = [[1.0, -0.6, 0.3], [-0.6, 1.0, 0.2], [0.3, 0.2, 1.0]];

    fn of_text(text: &str, set: &[String]) -> Result<CaseFile, String> {
        let path = Path::new("brake.toml");
        edited(path, text, set).and_then(|text| CaseFile::parse(path, text)).map_err(|error| error.to_string())
    }

    fn correlation(text: &str, set: &[String]) -> Option<Correlation> {
        match of_text(text, set).unwrap_or_else(|error| panic!("{set:?}: {error}")) {
            CaseFile::Matrices(case) => case.correlation,
            CaseFile::Lattice(case) => case.correlation,
            CaseFile::FiniteElements(case) => case.correlation,
        }
    }

    /// A matrix of correlations over some of three parameters; `constant` are constants in the file.
    fn three(correlated: &[usize], constant: &[usize]) -> String {
        let parameter = |(at, name): (usize, &&str)| match constant.contains(&at) {
            true => format!("[parameters.{name}]\ndistribution = \"constant\"\nvalue = 0.2\n"),
            false => format!("[parameters.{name}]\ndistribution = \"uniform\"\nfrom = 0.1\nto = 0.3\n"),
        };
        let parameters: String = NAMES.iter().enumerate().map(parameter).collect();
        let names: Vec<&str> = correlated.iter().map(|&at| NAMES[at]).collect();
        let rows: Vec<Vec<f64>> =
            correlated.iter().map(|&i| correlated.iter().map(|&j| SCORES[i][j]).collect()).collect();
        let table = match names.is_empty() {
            true => String::new(),
            false => format!("[correlation]\nparameters = {names:?} # of scores\nmatrix = {rows:?}\n"),
        };
        format!(
            "[study]\nname = \"n\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\n{parameters}{table}\
             [[terms]]\nname = \"all\"\nmass = [[1.0]]\nstiffness = [[1.0]]\ncoefficient = \"a + b + c\"\n"
        )
    }

    /// Every part of what a matrix correlates set to constants, in any order of its names: what is left is correlated as the rest of the matrix says.
    #[test]
    fn what_is_set_to_a_constant_leaves_a_matrix_of_correlations() {
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
            for which in 0..8_u32 {
                let (gone, left): (Vec<usize>, Vec<usize>) = order.iter().partition(|&&at| which >> at & 1 == 1);
                for form in ["NAME=0.2", "parameters.NAME={ distribution = \"constant\", value = 0.2 }"] {
                    let set: Vec<String> = gone.iter().map(|&at| form.replace("NAME", NAMES[at])).collect();
                    let found = correlation(&three(&order, &[]), &set);
                    assert_eq!(found, correlation(&three(&left, &gone), &[]), "{order:?} {set:?}");
                    assert_eq!(found.is_some(), left.len() > 1, "{order:?} {set:?}");
                }
                // In a file it is a contradiction.
                assert_eq!(of_text(&three(&order, &gone), &[]).is_err(), !gone.is_empty());
            }
        }
        // What is set to another distribution stays.
        let set = ["a={ distribution = \"uniform\", from = 1.0, to = 2.0 }".to_owned()];
        assert_eq!(correlation(&three(&[0, 1, 2], &[]), &set), correlation(&three(&[0, 1, 2], &[]), &[]));
        // A fault of the matrix is still one.
        let short = three(&[0, 1, 2], &[]).replace("matrix = [[1.0, -0.6, 0.3], ", "matrix = [");
        assert!(of_text(&short, &["a=0.2".to_owned()]).unwrap_err().contains("correlation.matrix"));
    }

    /// Fields over contacts leave a correlation likewise, for named parameters, for all, and for single values of contacts.
    #[test]
    fn what_is_set_to_a_constant_leaves_a_field() {
        let text =
            std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/two-by-two.toml")).unwrap();
        let case = |table: &str| {
            let text = text.replace("draws = \"shared\"", "draws = \"each\"");
            match table.is_empty() {
                true => text,
                false => text.replacen("[lattice]\n", &format!("[correlation]\n{table}\n[lattice]\n"), 1),
            }
        };
        let field = "field = { kernel = \"exponential\", length = 1.5 }";
        let named = |names: &str| format!("parameters = {names}\n{field}");
        let both = "parameters = [\"mu_s\", \"mu_k\"]\nmatrix = [[1.0, 0.5], [0.5, 1.0]]";
        let values = "parameters = [\"mu_s@1\", \"mu_k@1\", \"mu_k@3\"]\nmatrix = [[1.0, 0.5, 0.2], [0.5, 1.0, 0.0], [0.2, 0.0, 1.0]]";
        for (whole, set, left) in [
            (named("[\"mu_s\", \"mu_k\"]"), &["mu_s=0.6"][..], named("[\"mu_k\"]")),
            (named("[\"mu_s\", \"mu_k\"]"), &["mu_s=0.6", "mu_k=0.4"], String::new()),
            (named("[\"mu_s\"]"), &["friction.mu_s=0.6"], String::new()),
            (format!("{both}\n{field}"), &["mu_s=0.6"], format!("parameters = [\"mu_k\"]\nmatrix = [[1.0]]\n{field}")),
            (both.to_owned(), &["mu_k=0.4"], "parameters = [\"mu_s\"]\nmatrix = [[1.0]]".to_owned()),
            (both.to_owned(), &["mu_k=0.4", "mu_s=0.6"], String::new()),
            (
                values.to_owned(),
                &["mu_s=0.6"],
                "parameters = [\"mu_k@1\", \"mu_k@3\"]\nmatrix = [[1.0, 0.0], [0.0, 1.0]]".to_owned(),
            ),
            (values.to_owned(), &["mu_k=0.4"], "parameters = [\"mu_s@1\"]\nmatrix = [[1.0]]".to_owned()),
            (
                format!("{values}\n{field}"),
                &["mu_k=0.4"],
                format!("parameters = [\"mu_s@1\"]\nmatrix = [[1.0]]\n{field}"),
            ),
            (format!("{values}\n{field}"), &["mu_k=0.4", "mu_s=0.6"], String::new()),
            // One that no correlation names.
            (named("[\"mu_s\"]"), &["mu=0.4"], named("[\"mu_s\"]")),
        ] {
            let set: Vec<String> = set.iter().map(|&set| set.to_owned()).collect();
            assert_eq!(correlation(&case(&whole), &set), correlation(&case(&left), &[]), "{whole} {set:?}");
        }
        // All that is drawn: no name to be taken out, and none left at the end.
        let of_all =
            |set: &[&str]| correlation(&case(field), &set.iter().map(|name| format!("{name}=0.4")).collect::<Vec<_>>());
        let (all, one) = (of_all(&[]).unwrap(), of_all(&["v_s"]).unwrap());
        assert!(one.named().len() + 1 == all.named().len(), "{all:?} {one:?}");
        assert_eq!(of_all(&["mu", "mu_s", "mu_k", "alpha", "v_s", "sigma0", "sigma1", "sigma2"]), None);
    }
}
