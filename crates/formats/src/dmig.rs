//! Nastran's `DMIG` entries, in a bulk data or punch file: short, long and free fields.
//!
//! A header `DMIG NAME 0 form type ...` comes before the columns `DMIG NAME GJ CJ - G C value ...`, whose `G, C` are grid point and
//! component of the row. Forms: 1 square, 2 and 9 rectangular (a column of 9 is a number, not a grid point), 6 symmetric, of
//! which either triangle is given. Every row and column has entries; they are ordered by grid point and component. Complex matrices
//! whose imaginary parts are not all 0 are left out; other entries of bulk data are passed over.

use std::collections::HashMap;

use crate::Dof;
use crate::builder::{Builder, Found, Head, LabelSet, Stated};
use crate::limits::Limits;
use crate::lines::Lines;
use crate::numbers::{fortran, index, signed, whole};
use crate::problem::Problem;
use crate::shortened::cut;

/// Most fields of one entry; chosen: a column of a full matrix of 250,000 rows.
const MOST_FIELDS: usize = 1 << 20;

/// Reads all matrices.
pub(crate) fn parse(lines: &mut Lines<'_>, limits: &Limits) -> Result<Found, Problem> {
    let mut all = All { limits: *limits, list: Vec::new(), index: HashMap::new() };
    let mut entry: Option<Vec<String>> = None;
    while let Some(line) = lines.next()? {
        let line = line.split('$').next().unwrap_or_default().trim_end();
        if line.is_empty() {
            continue;
        }
        let (keyword, wide, fields) = split(line)?;
        if is_continuation(&keyword) {
            if let Some(entry) = &mut entry {
                if entry.len() > MOST_FIELDS {
                    return Err(Problem::Limit { what: "fields of one entry", most: MOST_FIELDS as u64 });
                }
                entry.extend(fields);
            }
            continue;
        }
        if let Some(entry) = entry.take() {
            all.take(&entry)?;
        }
        let name = if wide { keyword.strip_suffix('*').unwrap_or(&keyword) } else { &keyword };
        if name == "ENDDATA" {
            break;
        }
        entry = (name == "DMIG").then_some(fields);
    }
    if entry.is_some() {
        lines.check_end()?;
    }
    if let Some(entry) = entry {
        all.take(&entry)?;
    }
    all.finish()
}

/// True for what stands in the first field of a line that continues the one before.
fn is_continuation(keyword: &str) -> bool {
    keyword.is_empty() || keyword.starts_with('+') || keyword.starts_with('*')
}

/// Keyword, whether the fields are long, and the fields of a line: 8 short or 4 long ones.
///
/// # Errors
/// Free fields beyond those and the mark of a continuation: they would be lost.
fn split(line: &str) -> Result<(String, bool, Vec<String>), Problem> {
    let free = line.contains(',');
    let first: String =
        if free { line.split(',').next().unwrap_or_default().to_owned() } else { line.chars().take(8).collect() };
    let keyword = first.trim().to_uppercase();
    let wide = keyword.ends_with('*') || (keyword.starts_with('*') && !keyword.is_empty());
    let (count, width) = if wide { (4, 16) } else { (8, 8) };
    let is_mark = |at: usize, field: &str| {
        field.is_empty() || (at == 0 && !field.starts_with(|c: char| c.is_ascii_digit() || "-.".contains(c)))
    };
    let is_entry = keyword.trim_end_matches('*') == "DMIG" || is_continuation(&keyword);
    let mut beyond = line.split(',').skip(1 + count).map(str::trim).enumerate();
    if let Some((_, field)) = beyond.find(|(at, field)| is_entry && !is_mark(*at, field)) {
        let allowed = format!("{count} fields in a line, and a continuation line for more");
        return Err(Problem::field("a field of a line", field, allowed));
    }
    let mut fields: Vec<String> = if free {
        line.split(',').skip(1).take(count).map(|field| field.trim().to_owned()).collect()
    } else {
        let rest: Vec<char> = line.chars().skip(8).take(count * width).collect();
        rest.chunks(width).map(|field| field.iter().collect::<String>().trim().to_owned()).collect()
    };
    fields.resize(count, String::new());
    // A long continuation may be marked, as in `*ABC`.
    let keyword = if keyword.starts_with('*') { "*".to_owned() } else { keyword };
    Ok((keyword, wide, fields))
}

/// A matrix whose header was read.
struct Open {
    name: String,
    form: usize,
    complex: bool,
    /// Columns of form 9.
    columns: usize,
    rows_of: LabelSet,
    columns_of: LabelSet,
    builder: Builder,
}

struct All {
    limits: Limits,
    list: Vec<Open>,
    index: HashMap<String, usize>,
}

impl All {
    fn take(&mut self, fields: &[String]) -> Result<(), Problem> {
        let field = |at: usize| fields.get(at).map_or("", String::as_str);
        let name = field(0).to_uppercase();
        if name.is_empty() {
            return Err(Problem::field("the name of a DMIG", "blank", "a name"));
        }
        if field(1) == "0" {
            return self.header(name, field(2), field(3), field(7));
        }
        let number = self.index.get(&name).copied();
        let Some(open) = number.and_then(|number| self.list.get_mut(number)) else {
            return Err(Problem::field("the first entry of a DMIG", format!("a column of {name}"), "its header"));
        };
        let number = if open.form == 9 {
            index("column", field(1), open.columns)?
        } else {
            let set = if open.form == 2 { &mut open.columns_of } else { &mut open.rows_of };
            set.number(dof(field(1), field(2))?, &self.limits)?
        };
        for terms in fields.get(4..).unwrap_or_default().chunks(4) {
            let term = |at: usize| terms.get(at).map_or("", String::as_str);
            if terms.iter().all(String::is_empty) {
                continue;
            }
            let row = open.rows_of.number(dof(term(0), term(1))?, &self.limits)?;
            let value = fortran(term(2))?;
            match term(3) {
                "" => {}
                part if open.complex => open.builder.note_imaginary(fortran(part)?)?,
                "0" | "0." | "0.0" => {}
                part => return Err(Problem::field("the imaginary part of a real DMIG", part, "none")),
            }
            open.builder.push(row, number, value)?;
        }
        Ok(())
    }

    fn header(&mut self, name: String, form: &str, kind: &str, columns: &str) -> Result<(), Problem> {
        let form = whole("form of a DMIG", form)?;
        if !matches!(form, 1 | 2 | 6 | 9) {
            let allowed = "1 square, 2 or 9 rectangular, 6 symmetric";
            return Err(Problem::Keyword { what: "form of a DMIG", found: form.to_string(), allowed });
        }
        let complex = match kind {
            "1" | "2" => false,
            "3" | "4" => true,
            found => {
                let allowed = "1 or 2 real, 3 or 4 complex";
                return Err(Problem::Keyword { what: "type of a DMIG", found: cut(found), allowed });
            }
        };
        let columns = match (form, whole("number of columns", columns)) {
            (9, columns) => crate::numbers::order("number of columns", columns?, self.limits.order)?,
            _ => 0,
        };
        if self.index.contains_key(&name) {
            return Err(Problem::field("the header of a DMIG", format!("a second one of {name}"), "one"));
        }
        self.index.insert(name.clone(), self.list.len());
        let (rows_of, columns_of) = (LabelSet::default(), LabelSet::default());
        let builder = Builder::new(&self.limits);
        self.list.push(Open { name, form, complex, columns, rows_of, columns_of, builder });
        Ok(())
    }

    fn finish(self) -> Result<Found, Problem> {
        let mut found = Found::default();
        for mut open in self.list {
            if open.builder.len() == 0 {
                found.leave_out(&open.name, "no entries");
                continue;
            }
            let (rows, row_places) = open.rows_of.sorted();
            let (columns, count, column_places) = match open.form {
                9 => (None, open.columns, (0..open.columns as u32).collect()),
                2 => {
                    let (columns, places) = open.columns_of.sorted();
                    (Some(columns.clone()), columns.len(), places)
                }
                _ => (Some(rows.clone()), rows.len(), row_places.clone()),
            };
            open.builder.renumber(&row_places, &column_places);
            let symmetry = if open.form == 6 { Stated::Symmetric } else { Stated::General };
            let head = Head::unlabelled(open.name.clone(), None, (rows.len(), count));
            let head = Head { row_labels: Some(rows), column_labels: columns, ..head };
            found.keep(&open.name, open.builder.finish(symmetry, head))?;
        }
        Ok(found)
    }
}

fn dof(grid: &str, component: &str) -> Result<Dof, Problem> {
    let component = if component.is_empty() { 0 } else { whole("component", component)? };
    if component > 6 {
        return Err(Problem::field("component", component, "0 to 6"));
    }
    Ok(Dof { node: signed("grid point", grid)?, direction: component as u32 })
}
