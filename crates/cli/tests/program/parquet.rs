//! Tables of samples as Parquet: cell for cell what their CSV says.

use std::path::Path;

use output::Table;
use parquet::basic::Type;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use crate::common::{SMALL, refusal, squeal};

/// Types and rows of a Parquet file, its cells as CSV has them.
fn read(path: &Path) -> (Vec<(String, Type)>, Vec<Vec<String>>) {
    let file = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
    let columns = file.metadata().file_metadata().schema_descr().columns().to_vec();
    let types = columns.iter().map(|column| (column.name().to_owned(), column.physical_type())).collect();
    let cell = |field: &Field| match field {
        Field::Null => String::new(),
        Field::Str(text) => text.clone(),
        Field::Long(number) => number.to_string(),
        Field::Double(number) => number.to_string(),
        other => unreachable!("{other:?}"),
    };
    let row = |row: Result<parquet::record::Row, _>| row.unwrap().get_column_iter().map(|(_, it)| cell(it)).collect();
    (types, file.get_row_iter(None).unwrap().map(row).collect())
}

/// The oscillator of Hoffmann, whose friction is called as a column of the scene.
fn hoffmann(folder: &Path) -> std::path::PathBuf {
    let text = include_str!("../../../../cases/hoffmann.toml");
    let text = text.replace("[parameters.mu]", "[parameters.speed]").replace("mu = \"mu\"", "mu = \"speed\"");
    let case = folder.join("hoffmann.toml");
    std::fs::write(&case, text).unwrap();
    case
}

#[test]
fn parquet_says_cell_for_cell_what_the_csv_says() {
    let dir = tempfile::tempdir().unwrap();
    let (case, out) = (hoffmann(dir.path()), dir.path().join("out"));
    let run = |samples: &str, options: &[&str]| {
        let mut command = squeal();
        command.arg("run").arg(&case).args(["--keep-samples", "--samples", samples, "--out"]).arg(&out).args(options);
        assert!(command.status().unwrap().success());
    };
    run("40", &["--every-mode", "--parquet"]);
    for (name, rows) in [("samples", 40), ("unstable_modes", 1), ("every_mode", 80)] {
        let table = Table::read(&out.join(format!("{name}.csv"))).unwrap().unwrap();
        let (columns, cells) = read(&out.join(format!("{name}.parquet")));
        assert!(cells.len() >= rows, "{name}");
        assert_eq!(cells, table.rows, "{name}");
        assert_eq!(
            columns.iter().map(|(column, _)| column).collect::<Vec<_>>(),
            table.columns.iter().collect::<Vec<_>>()
        );
        for (column, kind) in &columns {
            let expected = match column.as_str() {
                "sample" | "open" => Type::INT64,
                "growth" | "frequency_hz" | "growth_rate" | "damping_ratio" | "speed (drawn)" => Type::DOUBLE,
                _ => Type::BYTE_ARRAY,
            };
            assert_eq!(*kind, expected, "{name}: {column}");
        }
    }
    // The same samples again leave them, more samples do not: they would be of fewer than the tables beside them.
    let of_options = ["every_mode.csv", "every_mode.parquet", "samples.parquet", "unstable_modes.parquet"];
    run("40", &[]);
    assert!(of_options.iter().all(|name| out.join(name).exists()));
    run("60", &[]);
    assert!(!of_options.iter().any(|name| out.join(name).exists()) && out.join("samples.csv").exists());
}

#[test]
fn parquet_without_a_table_of_samples_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let mut command = squeal();
    command.arg("run").arg(hoffmann(dir.path())).args(["--samples", "5", "--parquet", "--out"]);
    let output = command.arg(dir.path().join("out")).output().unwrap();
    refusal(&output, &["--parquet = no table; allowed: with --keep-samples or --every-mode, whose tables it is of"]);
}

/// The apostrophe against spreadsheets is one of CSV files: names that begin as a formula are themselves in all else.
#[test]
fn names_that_begin_as_formulas_are_themselves_but_in_csv() {
    let dir = tempfile::tempdir().unwrap();
    let (case, out) = (dir.path().join("case.toml"), dir.path().join("out"));
    let names = ["-z", "-first"];
    let text = SMALL.replace("name = \"none\"", "name = \"-z\"").replace("name = \"first\"", "name = \"-first\"");
    std::fs::write(&case, text).unwrap();
    let mut command = squeal();
    command.arg("run").arg(&case).args(["--samples", "4", "--keep-samples", "--parquet", "--out"]).arg(&out);
    assert!(command.status().unwrap().success());
    let file = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    assert!(names.iter().all(|name| file("samples.csv").contains(&format!("'{name}"))), "{}", file("samples.csv"));
    let (columns, rows) = read(&out.join("samples.parquet"));
    let place = columns.iter().position(|(column, _)| column == "constraints").unwrap();
    assert!(rows.iter().all(|row| names.contains(&row[place].as_str())), "{:?}", rows[0]);
    let page = file("report.html");
    for name in names {
        assert!(page.contains(&format!("\"{name}\"")) && !page.contains(&format!("'{name}")), "{name}");
    }
}
