//! Prints what a file holds: `cargo run -p brake-squeal-formats --example list -- brake.sti`.

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for path in std::env::args().skip(1) {
        let last = std::cell::Cell::new(0);
        let progress = Box::new(|read: u64, total: u64| last.set(100 * read / total.max(1)));
        let options = formats::Options { progress: Some(progress), ..formats::Options::default() };
        let file = formats::read_with(Path::new(&path), options).map_err(|e| format!("{path}: {e}"))?;
        println!("{path}: {:?}", file.format);
        for matrix in &file.matrices {
            let (rows, columns, entries) = (matrix.rows(), matrix.columns(), matrix.entries().len());
            println!(
                "  {}: {rows} x {columns}, {entries} entries, {:?}, {:?}",
                matrix.name(),
                matrix.kind(),
                matrix.stored()
            );
            if let Some([first, .., last]) = matrix.row_labels() {
                println!("    rows {first} to {last}");
            }
        }
        for (name, reason) in &file.left_out {
            println!("  {name} left out: {reason}");
        }
    }
    Ok(())
}
