//! The answer of a study as HTML.

use output::{Block, Cell, Cells};
use squeal::cycles::CyclesOfDraws;
use squeal::results::{LIGHT, Results};

use super::text::escaped;
use crate::Error;

/// The answer of a study, and the motions of its draws in words.
pub(super) fn answer(results: &Results, motions: Option<&CyclesOfDraws>) -> Result<String, Error> {
    let blocks = results.answer()?;
    // The first list is what a reader came for.
    let lead = blocks.iter().position(|block| matches!(block, Block::List(_)));
    let said: String = blocks.iter().enumerate().map(|(at, block)| html(block, Some(at) == lead)).collect();
    let motions = motions.map_or_else(String::new, |motions| {
        let (heading, text) = (CyclesOfDraws::HEADING, escaped(&motions.text(results.plan())));
        format!("<h3>{heading}</h3>\n<pre tabindex=\"0\" aria-label=\"{heading}\">{text}</pre>\n")
    });
    Ok(said + &motions)
}

/// A block of a document.
pub(super) fn html(block: &Block, is_lead: bool) -> String {
    match block {
        Block::Warning(text) => format!("<p class=\"doubt\">Warning: {}</p>\n", escaped(text)),
        Block::Heading(text) => format!("<h3>{}</h3>\n", escaped(text)),
        Block::Paragraph(text) => format!("<p>{}</p>\n", strong(text)),
        Block::List(items) => {
            let items: String = items.iter().map(|item| format!("<li>{}</li>\n", strong(item))).collect();
            format!("<ul{}>\n{items}</ul>\n", if is_lead { " class=\"lead\"" } else { "" })
        }
        Block::Table(cells) => table(cells),
    }
}

/// Text in which what stands between two `**` is strong.
fn strong(text: &str) -> String {
    let escaped = escaped(text);
    let parts: Vec<&str> = escaped.split("**").collect();
    // A last one that is alone means itself.
    let paired = parts.len() - usize::from(parts.len().is_multiple_of(2));
    let mut html = String::new();
    for (at, part) in parts.iter().enumerate() {
        match at {
            _ if at >= paired => html += &format!("**{part}"),
            _ if at % 2 == 1 => html += &format!("<strong>{part}</strong>"),
            _ => html += part,
        }
    }
    html
}

fn table(Cells { caption, columns, rows }: &Cells) -> String {
    let caption = escaped(caption);
    // Of numbers the head stands to the right, as they do.
    let is_of_numbers = |at: usize| rows.iter().any(|row| row.get(at).is_some_and(|cell| cell.value.is_some()));
    let head = |(at, column): (usize, &String)| match at > 0 && is_of_numbers(at) {
        true => format!("<th scope=\"col\" class=\"number\">{}</th>", escaped(column)),
        false => format!("<th scope=\"col\">{}</th>", escaped(column)),
    };
    let heads: String = columns.iter().enumerate().map(head).collect();
    let light = columns.iter().position(|column| column == LIGHT);
    let cell = |(at, cell): (usize, &Cell)| match cell.value {
        None if Some(at) == light => format!("<td class=\"light {0}\">{0}</td>", escaped(&cell.text)),
        // A number may stand above its limits, and no line ends within either.
        Some(value) => {
            let text = escaped(&cell.text).replace(' ', "\u{a0}").replace("\u{a0}(", " (");
            format!("<td class=\"number\" data-value=\"{value}\">{text}</td>")
        }
        // What stands for no number has the place of one.
        None if is_of_numbers(at) => format!("<td class=\"number\">{}</td>", escaped(&cell.text)),
        None => format!("<td>{}</td>", escaped(&cell.text)),
    };
    let row = |cells: &Vec<Cell>| {
        let first = cells.first().map_or_else(String::new, |cell| escaped(&cell.text));
        let others: String = cells.iter().enumerate().skip(1).map(cell).collect();
        format!("<tr><th scope=\"row\">{first}</th>{others}</tr>\n")
    };
    format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{caption}\"><table class=\"sortable\"><caption>{caption}</caption>\n\
         <thead><tr>{heads}</tr></thead>\n<tbody>\n{}</tbody></table></div>\n",
        rows.iter().map(row).collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    use super::strong;

    #[test]
    fn words_between_stars_are_strong_and_nothing_else_is_markup() {
        for (text, html) in [
            ("a **b** c", "a <strong>b</strong> c"),
            ("**<b>**: **x", "<strong>&lt;b&gt;</strong>: **x"),
            ("none", "none"),
            ("**", "**"),
        ] {
            assert_eq!(strong(text), html);
        }
    }
}
