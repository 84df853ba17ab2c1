//! The tables `[tables.NAME]` of a case file: functions in expressions that are given by points.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use serde::Deserialize;

use super::check::Check;
use super::{CaseError, TableFunction, is_parameter_name};

/// Table `[tables.NAME]`: points here, or in a file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointsTable {
    at: Option<Vec<f64>>,
    value: Option<Vec<f64>>,
    file: Option<PathBuf>,
}

impl Check<'_> {
    /// The tables of a case, by their names, which no parameter has.
    pub fn tables<'n>(
        &self,
        given: BTreeMap<String, PointsTable>,
        parameters: impl Iterator<Item = &'n String> + Clone,
    ) -> Result<Vec<Arc<TableFunction>>, CaseError> {
        let table = |(name, given): (String, PointsTable)| {
            if !is_parameter_name(&name) {
                let allowed = "a letter or _, then letters, digits and _, no function and not pi";
                return Err(self.value("tables", format!("{name:?}"), allowed));
            }
            if parameters.clone().any(|parameter| *parameter == name) {
                return Err(self.value("tables", format!("{name:?}"), "a name that no parameter has"));
            }
            self.table(name, given).map(Arc::new)
        };
        given.into_iter().map(table).collect()
    }

    /// A function through points, two or more, whose arguments increase.
    fn table(&self, name: String, given: PointsTable) -> Result<TableFunction, CaseError> {
        let field = format!("tables.{name}");
        let PointsTable { at, value, file } = given;
        // Where a fault is: in a field, or in the file.
        let place = |key: &str, found: String| match &file {
            None => (format!("{field}.{key}"), found),
            Some(file) => (format!("{field}.file"), format!("{}: {found}", file.display())),
        };
        let refused = |key: &str, found: String, allowed: &str| {
            let (field, found) = place(key, found);
            self.value(&field, found, allowed)
        };
        let (at, value) = match (&file, at, value) {
            (Some(file), None, None) => {
                let [at, value] = self.two_columns(&format!("{field}.file"), file)?;
                (at, value)
            }
            (None, Some(at), Some(value)) => (at, value),
            (Some(_), ..) => {
                return Err(refused("file", "given".into(), "the points here, at and value, or in a file, not both"));
            }
            (None, at, _) => {
                let missing = if at.is_none() { "at" } else { "value" };
                return Err(refused(missing, "missing".into(), "at and value, lists of numbers, or file"));
            }
        };
        if at.len() < 2 {
            return Err(refused("at", format!("a list of {}", at.len()), "two points or more"));
        }
        if value.len() != at.len() {
            let allowed = format!("a list of {}, one for each of at", at.len());
            return Err(refused("value", format!("a list of {}", value.len()), &allowed));
        }
        for (key, list) in [("at", &at), ("value", &value)] {
            if let Some(number) = list.iter().find(|number| !number.is_finite()) {
                return Err(refused(key, number.to_string(), "finite numbers"));
            }
        }
        if let Some(pair) = at.windows(2).find(|pair| pair[1] <= pair[0]) {
            return Err(refused(
                "at",
                format!("{} after {}", pair[1], pair[0]),
                "numbers that increase from point to point",
            ));
        }
        Ok(TableFunction::new(name, at, value))
    }
}

#[cfg(test)]
mod tests {
    use crate::MatricesCase;

    /// A mass on a spring whose stiffness follows a table over a temperature.
    fn case(path: &std::path::Path, table: &str) -> Result<MatricesCase, String> {
        let text = format!(
            r#"
            study = {{ name = "mass on a belt", samples = 10, seed = 1 }}
            brake = {{ kind = "matrices", dofs = ["x"] }}
            parameters.T = {{ distribution = "uniform", from = 20.0, to = 300.0 }}
            {table}
            terms = [{{ name = "mass", mass = [[1.0]] }}, {{ name = "spring", coefficient = "modulus(T)", stiffness = [[2.0]] }}]
            "#
        );
        MatricesCase::parse(path, text).map_err(|error| error.to_string())
    }

    #[test]
    fn a_coefficient_follows_a_table_and_the_identity_has_its_points() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("brake.toml");
        let table =
            |value: &str| format!("tables.modulus = {{ at = [20.0, 100.0, 400.0], value = [1.0, {value}, 0.5] }}");
        let here = case(&path, &table("0.9")).unwrap();
        let at = |case: &MatricesCase, t: f64| case.operating_point(&[t]).map(|point| point.coefficients[1]);
        assert_eq!([20.0, 100.0, 250.0].map(|t| at(&here, t).unwrap()), [1.0, 0.9, 0.7]);
        // A sample of it fails.
        let error = at(&here, 401.0).unwrap_err().to_string();
        let said = "terms \"spring\".coefficient = \"modulus(T)\": modulus(401) at T = 401; allowed: an argument from 20 to 400, between the ends of the table";
        assert!(error.ends_with(said), "{error}");
        assert_ne!(here.identity(), case(&path, &table("0.91")).unwrap().identity());
        let of_file = |text: &str| {
            std::fs::write(dir.path().join("modulus.csv"), text).unwrap();
            case(&path, "tables.modulus.file = \"modulus.csv\"")
        };
        let read = of_file("T,E\n20,1\n100,0.9\n400,0.5\n").unwrap();
        assert_eq!(read.identity(), here.identity());
        assert_eq!(read.tables, here.tables);
        assert_ne!(of_file("T,E\n20,1\n100,0.9\n400,0.51\n").unwrap().identity(), here.identity());
        for (text, said) in [
            ("20,1\n", "modulus.csv: a list of 1; allowed: two points or more"),
            ("20,1\n20,2\n", "modulus.csv: 20 after 20; allowed: numbers that increase from point to point"),
            ("20,1\n30,nan\n", "modulus.csv: line 2: \"nan\"; allowed: a finite number, with a decimal point"),
            ("20,1,2\n30,1,2\n", "modulus.csv: 3 columns; allowed: two columns: at and value of each point"),
        ] {
            let error = of_file(text).unwrap_err();
            assert!(error.contains("brake.toml: tables.modulus.file = ") && error.ends_with(said), "{error}");
        }
    }

    #[test]
    fn what_is_no_table_is_refused_in_one_line() {
        let points = "at = [20.0, 300.0], value = [1.0, 0.9]";
        let modulus = format!("tables.modulus = {{ {points} }}\n");
        for (table, said) in [
            (
                "tables.modulus = { at = [20.0], value = [1.0] }",
                "tables.modulus.at = a list of 1; allowed: two points or more",
            ),
            (
                "tables.modulus = { at = [20.0, 300.0], value = [1.0] }",
                "tables.modulus.value = a list of 1; allowed: a list of 2, one for each of at",
            ),
            (
                "tables.modulus = { at = [20.0, 20.0], value = [1.0, 2.0] }",
                "tables.modulus.at = 20 after 20; allowed: numbers that increase from point to point",
            ),
            (
                "tables.modulus = { at = [20.0, inf], value = [1.0, 2.0] }",
                "tables.modulus.at = inf; allowed: finite numbers",
            ),
            (
                "tables.modulus = { at = [20.0, 30.0], value = [1.0, nan] }",
                "tables.modulus.value = NaN; allowed: finite numbers",
            ),
            (
                "tables.modulus = { at = [20.0, 30.0] }",
                "tables.modulus.value = missing; allowed: at and value, lists of numbers, or file",
            ),
            (
                "tables.modulus = { at = [20.0, 30.0], file = \"a.csv\" }",
                "tables.modulus.file = a.csv: given; allowed: the points here, at and value, or in a file, not both",
            ),
            ("tables.modulus = { file = \"none.csv\" }", "(os error 2); allowed: a file that can be read"),
            (&format!("tables.T = {{ {points} }}"), "tables = \"T\"; allowed: a name that no parameter has"),
            (
                &format!("tables.tanh = {{ {points} }}"),
                "tables = \"tanh\"; allowed: a letter or _, then letters, digits and _, no function and not pi",
            ),
            (
                &format!("tables.pi = {{ {points} }}"),
                "tables = \"pi\"; allowed: a letter or _, then letters, digits and _, no function and not pi",
            ),
            (
                &format!("{modulus}tables.friction = {{ {points} }}"),
                "tables.friction = used nowhere; allowed: tables that an expression of this file calls, as friction(w)",
            ),
            (
                "tables.modulus = { at = [20.0, 150.0], value = [1.0, 0.9] }",
                "modulus(160) at T = 160; allowed: an argument from 20 to 150, between the ends of the table",
            ),
        ] {
            let error = case(std::path::Path::new("brake.toml"), table).unwrap_err();
            assert!(error.starts_with("brake.toml: t") && error.ends_with(said) && !error.contains('\n'), "{error}");
        }
    }
}
