//! Measured numbers in a file beside the case: values of a distribution, points of a table.

use std::path::Path;

use formats::plain_text;
use montecarlo::Distribution;

use super::CaseError;
use super::check::Check;
use crate::input::{LARGEST_CASE, read_text};

impl Check<'_> {
    /// A distribution whose numbers are allowed; measured values that stand in a file are read.
    pub fn distribution(&self, field: &str, given: Distribution) -> Result<Distribution, CaseError> {
        if let Distribution::Empirical { values, file, column } = &given {
            if let (Some(file), false) = (file, values.is_empty()) {
                let allowed = "the values here or in a file, not both";
                return Err(self.value(&format!("{field}.file"), file.display(), allowed));
            }
            if let (None, Some(column)) = (file, column) {
                return Err(self.value(&format!("{field}.column"), format!("{column:?}"), "only beside `file`"));
            }
        }
        let distribution = given
            .with_file(|file, column| self.of_sheet(&format!("{field}.file"), file, |sheet| sheet.column(column)))?;
        let fault = |fault: montecarlo::DistributionFault| {
            self.value(&format!("{field}.{}", fault.key), fault.value, &fault.allowed)
        };
        distribution.check().map_err(fault)?;
        Ok(distribution)
    }

    /// The numbers of a file of two columns.
    pub fn two_columns(&self, field: &str, file: &Path) -> Result<[Vec<f64>; 2], CaseError> {
        self.of_sheet(field, file, |sheet| sheet.two_columns())
    }

    /// Numbers of a file, relative to the folder of the case, as they are read of its sheet.
    fn of_sheet<T>(
        &self,
        field: &str,
        file: &Path,
        read: impl FnOnce(&Sheet<'_>) -> Result<T, Fault>,
    ) -> Result<T, CaseError> {
        let path = self.path.parent().unwrap_or(Path::new("")).join(file);
        let refused = |found: &str, allowed: &str| self.value(field, format!("{}: {found}", file.display()), allowed);
        let text =
            read_text(&path, LARGEST_CASE).map_err(|error| refused(&error.to_string(), "a file that can be read"))?;
        read(&Sheet::new(&plain_text(&text))).map_err(|(found, allowed)| refused(&found, &allowed))
    }
}

/// Fault of a file: what was found, and what is allowed.
type Fault = (String, String);

/// A table with `,`, `;` or tabs between its cells.
struct Sheet<'a> {
    text: &'a str,
    delimiter: char,
    /// The cells of the first line.
    heads: Vec<String>,
}

impl<'a> Sheet<'a> {
    fn new(text: &'a str) -> Self {
        let first = text.lines().next().unwrap_or_default();
        let delimiter = [';', '\t', ','].into_iter().find(|&delimiter| first.contains(delimiter)).unwrap_or(',');
        Self { text, delimiter, heads: cells(first, delimiter) }
    }

    /// The numbers of a column.
    fn column(&self, column: Option<&str>) -> Result<Vec<f64>, Fault> {
        let heads = &self.heads;
        let at = match column {
            None if heads.len() > 1 => {
                return Err((
                    format!("{} columns", heads.len()),
                    "one column, or `column` with the heading of one".into(),
                ));
            }
            None => 0,
            Some(name) if heads.iter().filter(|head| *head == name).count() > 1 => {
                return Err((format!("several columns {name:?}"), "a heading that one column has".into()));
            }
            Some(name) => heads
                .iter()
                .position(|head| head == name)
                .ok_or_else(|| (format!("no column {name:?}"), format!("one of {}", heads.join(", "))))?,
        };
        // The first cell is a heading where it was asked for by its name, be it a number, and where it is no number.
        let has_heads = column.is_some() || heads.get(at).is_none_or(|head| head.parse::<f64>().is_err());
        self.numbers([at], has_heads).map(|[numbers]| numbers)
    }

    /// The numbers of both columns. The first line has headings where neither cell of it is a number.
    fn two_columns(&self) -> Result<[Vec<f64>; 2], Fault> {
        match &self.heads[..] {
            [first, second] => {
                let has_heads = [first, second].into_iter().all(|head| head.parse::<f64>().is_err());
                self.numbers([0, 1], has_heads)
            }
            heads => Err((format!("{} columns", heads.len()), "two columns: at and value of each point".into())),
        }
    }

    /// The numbers of these columns, by their indices.
    fn numbers<const N: usize>(&self, columns: [usize; N], has_heads: bool) -> Result<[Vec<f64>; N], Fault> {
        let mut values = [const { Vec::new() }; N];
        for (number, line) in self.text.lines().enumerate().skip(usize::from(has_heads)) {
            if line.trim().is_empty() {
                continue;
            }
            let cells = cells(line, self.delimiter);
            // A decimal comma makes two cells of one.
            if cells.len() != self.heads.len() {
                let found = format!("line {}: {} cells", number + 1, cells.len());
                return Err((found, format!("{}, as in the first line", self.heads.len())));
            }
            for (at, values) in columns.into_iter().zip(&mut values) {
                let cell = &cells[at];
                match cell.parse::<f64>() {
                    Ok(value) if value.is_finite() => values.push(value),
                    _ => {
                        let found = format!("line {}: {cell:?}", number + 1);
                        return Err((found, "a finite number, with a decimal point".into()));
                    }
                }
            }
        }
        Ok(values)
    }
}

/// The cells of a line.
fn cells(line: &str, delimiter: char) -> Vec<String> {
    line.split(delimiter).map(|cell| cell.trim().trim_matches('"').to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use montecarlo::Distribution;

    use super::{Fault, Sheet, plain_text};
    use crate::MatricesCase;

    #[test]
    fn measured_values_stand_in_a_file_beside_the_case_and_are_part_of_its_identity() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("brake.toml");
        let text = r#"
            study = { name = "mass on a belt", samples = 10, seed = 1 }
            brake = { kind = "matrices", dofs = ["x"] }
            parameters.d = { distribution = "empirical", file = "d.csv", column = "d" }
            terms = [{ name = "mass", mass = [[1.0]], stiffness = [[1.0]] }, { name = "dashpot", coefficient = "d", damping = [[1.0]] }]
        "#;
        let case = |measured: &str| {
            std::fs::write(dir.path().join("d.csv"), measured).unwrap();
            MatricesCase::parse(&path, text.into()).map_err(|error| error.to_string())
        };
        let found = case("t,d\n20,0.3\n100,0.1\n200,0.2\n").unwrap();
        let Distribution::Empirical { values, .. } = &found.parameters[0].distribution else {
            unreachable!("empirical")
        };
        assert_eq!(values, &[0.1, 0.2, 0.3]);
        assert_ne!(found.identity(), case("t,d\n20,0.3\n100,0.1\n200,0.25\n").unwrap().identity());
        for ending in ["\r\n", "\r"] {
            let same = "\u{feff}t,d\n20,0.3\n100,0.1\n200,0.2\n".replace('\n', ending);
            assert_eq!(case(&same).unwrap().identity(), found.identity(), "{ending:?}");
        }
        for (given, said) in [
            (
                "file = \"d.csv\", values = [1.0, 2.0]",
                "d.file = d.csv; allowed: the values here or in a file, not both",
            ),
            ("values = [1.0, 2.0], column = \"d\"", "d.column = \"d\"; allowed: only beside `file`"),
        ] {
            let text = text.replace("file = \"d.csv\", column = \"d\"", given);
            let error = MatricesCase::parse(&path, text).map_err(|error| error.to_string()).unwrap_err();
            assert!(error.ends_with(said), "{error}");
        }
        for (measured, said) in [
            ("t,c\n20,0.3\n", "d.csv: no column \"d\"; allowed: one of t, c"),
            ("d,d\n20,0.3\n", "d.csv: several columns \"d\"; allowed: a heading that one column has"),
            ("t,d\n20,high\n", "d.csv: line 2: \"high\"; allowed: a finite number, with a decimal point"),
            ("t,d\n20,0.3\n", "values = a list of 1; allowed: two different numbers or more"),
        ] {
            let error = case(measured).unwrap_err();
            assert!(error.contains("brake.toml: parameters.d.") && error.ends_with(said), "{error}");
        }
    }

    fn numbers(text: &str, column: Option<&str>) -> Result<Vec<f64>, Fault> {
        Sheet::new(&plain_text(text)).column(column)
    }

    #[test]
    fn a_column_is_found_by_its_heading_or_is_the_first() {
        assert_eq!(numbers("mu,k\n0.5,1e6\n0.4, 2e6\n\n", Some("k")), Ok(vec![1e6, 2e6]));
        assert_eq!(numbers("20,100\n0.5,0.6\n0.4,0.7\n", Some("100")), Ok(vec![0.6, 0.7]));
        assert_eq!(numbers("\u{feff}mu\n0.5\n", Some("mu")), Ok(vec![0.5]));
        assert_eq!(numbers("\u{feff}0.5\n0.4\n", None), Ok(vec![0.5, 0.4]));
        assert_eq!(numbers("0.5\r\n0.4\r\n", None), Ok(vec![0.5, 0.4]));
        assert_eq!(numbers("\"mu\";\"k\"\n0.5;1\n", Some("mu")), Ok(vec![0.5]));
        assert_eq!(numbers("mu\n0,5\n", None).unwrap_err().0, "line 2: 2 cells");
        assert_eq!(numbers("0,5\n0,4\n", None).unwrap_err().0, "2 columns");
        assert_eq!(numbers("mu;k\n0,5;1\n", Some("mu")).unwrap_err().0, "line 2: \"0,5\"");
        assert_eq!(numbers("mu,k\n0.5,1\n", Some("c")).unwrap_err(), ("no column \"c\"".into(), "one of mu, k".into()));
        assert_eq!(numbers("mu,k\n0.5\n", Some("k")).unwrap_err().0, "line 2: 1 cells");
        let two = |text: &str| Sheet::new(&plain_text(text)).two_columns();
        assert_eq!(two("T;E\n20;1.5\n100;1.25\n\n"), Ok([vec![20.0, 100.0], vec![1.5, 1.25]]));
        assert_eq!(two("\u{feff}20,1.5\n100,1.25"), Ok([vec![20.0, 100.0], vec![1.5, 1.25]]));
        assert_eq!(two("20,E\n100,1.25\n").unwrap_err().0, "line 1: \"E\"");
        assert_eq!(two("T,E\n20,1,5\n").unwrap_err().0, "line 2: 3 cells");
        assert_eq!(two("T\n20\n").unwrap_err().0, "1 columns");
        assert_eq!(two("T,E,nu\n20,1.5,0.3\n").unwrap_err().0, "3 columns");
    }
}
