//! Documents: an answer in words, said once and shown as Markdown or HTML.

/// A part of a document. Words between `**` are strong in every form.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A reason why what follows may be wrong.
    Warning(String),
    /// A heading.
    Heading(String),
    /// A paragraph.
    Paragraph(String),
    /// A list of sentences.
    List(Vec<String>),
    /// A table.
    Table(Cells),
}

/// A table in a document, made to be read: numbers are rounded, and know what they are sorted by.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// Caption of the table.
    pub caption: String,
    /// Headings of the columns.
    pub columns: Vec<String>,
    /// Rows, each with a cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table that is made to be read.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Text of the cell.
    pub text: String,
    /// Number behind the text, where there is one.
    pub value: Option<f64>,
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self { text, value: None }
    }
}

impl Block {
    /// The block in Markdown, with an empty line before it.
    #[must_use]
    pub fn markdown(&self) -> String {
        let line = |text: &str| text.replace('\n', " ");
        match self {
            Self::Warning(text) => format!("\n**WARNING: {}**\n", line(text)),
            Self::Heading(text) => format!("\n## {}\n", line(text)),
            Self::Paragraph(text) => format!("\n{}\n", line(text)),
            Self::List(items) => items.iter().fold("\n".to_owned(), |all, item| all + &format!("- {}\n", line(item))),
            Self::Table(Cells { caption, columns, rows }) => {
                let row = |cells: Vec<&str>| format!("| {} |\n", line(&cells.join(" | ")));
                let head = row(columns.iter().map(String::as_str).collect()) + &row(vec!["---"; columns.len()]);
                let rows = rows.iter().map(|cells| row(cells.iter().map(|cell| cell.text.as_str()).collect()));
                format!("\n{}:\n\n{head}{}", line(caption), rows.collect::<String>())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_is_a_paragraph_of_its_own_in_markdown() {
        let cell = Cell { text: "0.25".into(), value: Some(0.25) };
        let rows = vec![vec!["7".to_owned().into(), cell]];
        let table = Cells { caption: "Modes".into(), columns: vec!["mode".into(), "share".into()], rows };
        for (block, text) in [
            (Block::Warning("two\nlines".into()), "\n**WARNING: two lines**\n"),
            (Block::Heading("Answer".into()), "\n## Answer\n"),
            (Block::List(vec!["**a**: b".into(), "c".into()]), "\n- **a**: b\n- c\n"),
            (Block::Table(table), "\nModes:\n\n| mode | share |\n| --- | --- |\n| 7 | 0.25 |\n"),
        ] {
            assert_eq!(block.markdown(), text);
        }
    }
}
