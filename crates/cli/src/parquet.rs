//! `--parquet`: the long tables of samples as Parquet beside their CSV, with a type for each column.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

use output::{OutputError, unguarded};
use parquet::basic::{LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use squeal::study::SceneLabels;

/// Tables that are written, where there are any: those with a row for each sample or more.
const TABLES: [&str; 3] = ["samples", "unstable_modes", "every_mode"];
/// Rows of a row group, which are in memory together; chosen, some 10 MB.
const ROWS_OF_A_GROUP: usize = 1 << 16;

/// Names of all files that [`write_parquet`] may write.
pub fn files() -> impl Iterator<Item = String> {
    TABLES.iter().map(|name| format!("{name}.parquet"))
}

/// Writes `NAME.parquet` beside each of `samples.csv`, `unstable_modes.csv` and `every_mode.csv` that a folder has: the same columns, rows and cells, an
/// empty cell as null. Columns of the scene and names of modes are texts, `sample` and `open` whole numbers of 64 bits, all others doubles.
///
/// # Errors
/// [`OutputError::Write`].
pub fn write_parquet(dir: &Path) -> Result<(), OutputError> {
    for name in TABLES {
        let (table, path) = (dir.join(format!("{name}.csv")), dir.join(format!("{name}.parquet")));
        if table.exists() {
            convert(&table, &path).map_err(|error| OutputError::Write { path, source: io::Error::other(error) })?;
        }
    }
    Ok(())
}

/// Kind of the cells of a column.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Text,
    Whole,
    Number,
}

impl Kind {
    /// Kind of a column of one of [`TABLES`].
    fn of(column: &str) -> Self {
        match column {
            "sample" | "open" => Self::Whole,
            "mode" | "unstable" | "may_be" => Self::Text,
            _ if SceneLabels::SCENE_COLUMNS.contains(&column) => Self::Text,
            _ => Self::Number,
        }
    }

    /// Column of this kind in a schema.
    fn column(self, name: &str) -> ParquetResult<Arc<Type>> {
        let (physical, logical) = match self {
            Self::Text => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
            Self::Whole => (PhysicalType::INT64, None),
            Self::Number => (PhysicalType::DOUBLE, None),
        };
        let column = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
        Ok(Arc::new(column.with_logical_type(logical).build()?))
    }

    /// Writes the cells of a row group.
    fn write<'c>(
        self,
        column: &mut SerializedColumnWriter<'_>,
        cells: impl Iterator<Item = &'c str>,
    ) -> ParquetResult<()> {
        match self {
            Self::Text => write_cells::<ByteArrayType>(column, cells, |cell| Ok(ByteArray::from(unguarded(cell)))),
            Self::Whole => write_cells::<Int64Type>(column, cells, |cell| cell.parse().map_err(external)),
            Self::Number => write_cells::<DoubleType>(column, cells, |cell| cell.parse().map_err(external)),
        }
    }
}

/// Writes cells of a CSV file by what each of them says; empty ones are null.
fn write_cells<'c, T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    cells: impl Iterator<Item = &'c str>,
    value: impl Fn(&str) -> ParquetResult<T::T>,
) -> ParquetResult<()> {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    for cell in cells {
        levels.push(i16::from(!cell.is_empty()));
        if !cell.is_empty() {
            values.push(value(cell)?);
        }
    }
    column.typed::<T>().write_batch(&values, Some(&levels), None)?;
    Ok(())
}

/// Writes a table as Parquet, a row group at a time.
fn convert(from: &Path, to: &Path) -> ParquetResult<()> {
    let mut table = csv::Reader::from_path(from).map_err(external)?;
    let names = table.headers().map_err(external)?.clone();
    let columns = names.iter().map(|name| Kind::of(name).column(unguarded(name))).collect::<ParquetResult<_>>()?;
    let schema = Type::group_type_builder("schema").with_fields(columns).build()?;
    let mut file = SerializedFileWriter::new(File::create(to)?, Arc::new(schema), Arc::default())?;
    let mut records = table.records();
    loop {
        let rows = records.by_ref().take(ROWS_OF_A_GROUP).collect::<Result<Vec<_>, _>>().map_err(external)?;
        if rows.is_empty() {
            break;
        }
        let mut group = file.next_row_group()?;
        for (place, name) in names.iter().enumerate() {
            if let Some(mut column) = group.next_column()? {
                Kind::of(name).write(&mut column, rows.iter().map(|row| &row[place]))?;
                column.close()?;
            }
        }
        group.close()?;
    }
    file.close()?;
    Ok(())
}

/// Error of a table, or of one of its cells, as one of Parquet.
fn external(error: impl std::error::Error + Send + Sync + 'static) -> ParquetError {
    ParquetError::External(Box::new(error))
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};

    use super::*;

    #[test]
    fn a_long_table_has_all_its_rows_in_groups() {
        let dir = tempfile::tempdir().unwrap();
        let rows = ROWS_OF_A_GROUP as u64 + 3;
        let table = |value: u64| vec![value.to_string(), format!("{}", value as f64 / 7.0)];
        output::Table::new("samples", ["sample", "growth"], (0..rows).map(table)).write(dir.path()).unwrap();
        write_parquet(dir.path()).unwrap();
        let file = SerializedFileReader::new(File::open(dir.path().join("samples.parquet")).unwrap()).unwrap();
        assert_eq!(file.num_row_groups(), 2);
        let read = |row: ParquetResult<parquet::record::Row>| row.unwrap().into_columns();
        for (value, row) in (0..rows).zip(file.get_row_iter(None).unwrap().map(read)) {
            assert_eq!(row[0].1, parquet::record::Field::Long(value as i64));
            assert_eq!(row[1].1, parquet::record::Field::Double(value as f64 / 7.0));
        }
        assert_eq!(file.metadata().file_metadata().num_rows(), rows as i64);
    }
}
