//! Tables: one type that files, pages, programs and other languages read.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use crate::{OutputError, csv_bytes, unguarded, write, write_row};

/// A table of results: one observation a row. Cells are text, numbers in the fewest digits that give them back; an empty cell is nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Name of the table: the name of its file without `.csv`.
    pub name: String,
    /// Names of the columns, with units.
    pub columns: Vec<String>,
    /// Rows, each with a cell for each column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table of these rows.
    pub fn new<C: Into<String>>(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = C>,
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Self {
        let columns = columns.into_iter().map(Into::into).collect();
        Self { name: name.into(), columns, rows: rows.into_iter().collect() }
    }

    /// The table of a CSV file, named after it, with the cells that were written; `None` where there is no such file.
    ///
    /// # Errors
    /// A file that cannot be read, or is no table.
    pub fn read(path: &Path) -> Result<Option<Self>, csv::Error> {
        let mut reader = match csv::Reader::from_path(path) {
            Err(error) => match error.kind() {
                csv::ErrorKind::Io(source) if source.kind() == io::ErrorKind::NotFound => return Ok(None),
                _ => return Err(error),
            },
            Ok(reader) => reader,
        };
        let cells = |record: &csv::StringRecord| record.iter().map(|cell| unguarded(cell).to_owned()).collect();
        let columns = cells(reader.headers()?);
        let rows = reader.records().map(|record| Ok(cells(&record?))).collect::<Result<_, csv::Error>>()?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Some(Self { name, columns, rows }))
    }

    /// The table as CSV, in which no text is taken for a formula.
    ///
    /// # Errors
    /// A table that cannot be encoded.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        csv_bytes(&self.columns, &self.rows)
    }

    /// Writes the table to its file in a folder.
    ///
    /// # Errors
    /// [`OutputError::Write`].
    pub fn write(&self, dir: &Path) -> Result<(), OutputError> {
        let path = dir.join(format!("{}.csv", self.name));
        let bytes = self.csv().map_err(|error| OutputError::Write { path: path.clone(), source: error.into() })?;
        write(&path, &bytes)
    }

    /// The cells of a column by its name; `None` where there is no such column.
    pub fn column<'t>(&'t self, name: &str) -> Option<impl Iterator<Item = &'t str> + use<'t>> {
        let at = self.columns.iter().position(|column| column == name)?;
        Some(self.rows.iter().map(move |row| row[at].as_str()))
    }

    /// The rows as JSON objects: a cell that is a finite number is one, an empty cell is null.
    #[must_use]
    pub fn json(&self) -> Value {
        let cell = |cell: &String| match cell.parse::<f64>() {
            _ if cell.is_empty() => Value::Null,
            Ok(number) if number.is_finite() => serde_json::from_str(cell).unwrap_or_else(|_| number.into()),
            _ => Value::String(cell.clone()),
        };
        let row = |row: &Vec<String>| {
            let cells = self.columns.iter().cloned().zip(row.iter().map(cell));
            Value::Object(cells.collect::<Map<_, _>>())
        };
        self.rows.iter().map(row).collect()
    }

    /// The table in Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | ").replace('\n', " "));
        let rule = vec!["---".to_owned(); self.columns.len()];
        line(&self.columns) + &line(&rule) + &self.rows.iter().map(|row| line(row)).collect::<String>()
    }
}

/// A table whose rows are written as they come, so that it need not fit into memory. What a process that is killed leaves is not whole: it belongs
/// into a folder that is published when all is done.
#[derive(Debug)]
pub struct LongTable {
    path: PathBuf,
    writer: csv::Writer<File>,
}

impl LongTable {
    /// A table of this name in a folder, without rows.
    ///
    /// # Errors
    /// [`OutputError::Write`].
    pub fn create(dir: &Path, name: &str, columns: &[&str]) -> Result<Self, OutputError> {
        let path = dir.join(format!("{name}.csv"));
        let file = File::create(&path).map_err(|source| OutputError::Write { path: path.clone(), source })?;
        let mut table = Self { path, writer: csv::Writer::from_writer(file) };
        table.write([columns])?;
        Ok(table)
    }

    /// Writes rows at the end.
    ///
    /// # Errors
    /// [`OutputError::Write`].
    pub fn write<R: IntoIterator<Item: AsRef<[u8]>>>(
        &mut self,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<(), OutputError> {
        let written = rows.into_iter().try_for_each(|row| write_row(&mut self.writer, row));
        written.map_err(|error| OutputError::Write { path: self.path.clone(), source: error.into() })
    }

    /// Writes what is still in memory.
    ///
    /// # Errors
    /// [`OutputError::Write`].
    pub fn finish(mut self) -> Result<(), OutputError> {
        self.writer.flush().map_err(|source| OutputError::Write { path: self.path, source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_back_from_its_file_and_says_the_same_in_every_form() {
        let rows = [["a, b", "1.5", ""], ["-z", "-2e-300", "NaN"]].map(|row| row.map(str::to_owned).to_vec());
        let table = Table::new("modes", ["mode", "hertz", "open"], rows);
        let dir = std::env::temp_dir().join(format!("table-{}", std::process::id()));
        std::fs::create_dir_all(&dir).unwrap();
        table.write(&dir).unwrap();
        assert_eq!(Table::read(&dir.join("modes.csv")).unwrap(), Some(table.clone()));
        assert_eq!(Table::read(&dir.join("others.csv")).unwrap(), None);
        std::fs::remove_dir_all(&dir).unwrap();
        let expected = serde_json::json!([
            { "mode": "a, b", "hertz": 1.5, "open": null },
            { "mode": "-z", "hertz": -2e-300, "open": "NaN" },
        ]);
        assert_eq!(table.json(), expected);
        assert!(table.markdown().starts_with("| mode | hertz | open |\n| --- | --- | --- |\n| a, b | 1.5 |  |\n"));
        assert_eq!(table.column("hertz").unwrap().collect::<Vec<_>>(), ["1.5", "-2e-300"]);
        assert!(table.column("Hz").is_none());

        // Written row by row it has the same bytes.
        let dir = std::env::temp_dir().join(format!("long-table-{}", std::process::id()));
        std::fs::create_dir_all(&dir).unwrap();
        let mut long = LongTable::create(&dir, "modes", &["mode", "hertz", "open"]).unwrap();
        table.rows.iter().for_each(|row| long.write([row]).unwrap());
        long.finish().unwrap();
        assert_eq!(std::fs::read(dir.join("modes.csv")).unwrap(), table.csv().unwrap());
        std::fs::remove_dir_all(&dir).unwrap();
    }
}
