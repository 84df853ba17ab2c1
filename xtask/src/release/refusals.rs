//! `docs/refusals.md`, and the same text for `squeal explain`: every line with which the program refuses something, from the errors of the
//! crates themselves. Beside it stands a copy of `docs/case-files.md`, from which the command takes what a field is.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use syn::{Attribute, Expr, Fields, Item, ItemEnum, Lit, LitStr, Meta, Variant};

use super::made::Made;
use crate::error::TaskError;

/// Crates whose errors no user of the program meets.
const NOT_FOR_USERS: [&str; 2] = ["reproduction", "validation"];

/// What stands before the list.
const HEAD: &str = "# Every refusal

What `squeal` refuses, or fails with, is one line on standard error. It names the file, the field, the value and what is allowed, and the exit
code is 2. Exit code 1 means that results are written, but are not to be trusted: `summary.md` begins with the reason.

This page has all of these lines. `{words}` stand for what is different each time. Search it for words of a line that are no names and no numbers;
a line that begins with a file and a field is explained best by the field, in [case-files.md](case-files.md). Where one line has another one at
its end, after a colon, both are here. `squeal explain \"LINE\"` prints what this page says of a line and what the other says of its field;
`squeal explain study.samples` the latter alone.

*Made by `cargo xtask refusals` from the errors of the crates; a test compares it with them.*
";

/// The page of the documentation, and copies within the crate of the program, whose archive has nothing from outside of its folder: of this page
/// and of that on case files.
///
/// # Errors
/// A source file that cannot be read, or is not Rust.
pub(super) fn pages(root: &Path) -> Result<[Made; 3], TaskError> {
    let text = text(root)?;
    let fields = std::fs::read_to_string(root.join("docs/case-files.md")).map_err(TaskError::Start)?;
    let pages = [
        ("docs/refusals.md", text.clone()),
        ("crates/cli/src/refusals.md", text),
        ("crates/cli/src/case-files.md", fields),
    ];
    Ok(pages.map(|(file, text)| Made { path: root.join(file), text, task: "refusals" }))
}

fn text(root: &Path) -> Result<String, TaskError> {
    let mut text = HEAD.to_owned();
    let mut crates = folders(&root.join("crates"))?;
    crates.retain(|dir| !NOT_FOR_USERS.iter().any(|name| dir.ends_with(name)));
    for dir in crates {
        let mut sections = String::new();
        for file in sources(&dir.join("src"))? {
            let source = std::fs::read_to_string(&file).map_err(TaskError::Start)?;
            let parsed = syn::parse_file(&source).map_err(|error| not_rust(&file, &error))?;
            for item in parsed.items {
                if let Item::Enum(item) = item {
                    sections += &of_enum(&item);
                }
            }
        }
        if !sections.is_empty() {
            let name = dir.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            let _ = write!(text, "\n## {name}\n{sections}");
        }
    }
    Ok(text)
}

fn not_rust(file: &Path, error: &syn::Error) -> TaskError {
    TaskError::Release(format!("{}: cannot be parsed: {error}", file.display()))
}

fn folders(dir: &Path) -> Result<Vec<PathBuf>, TaskError> {
    let entries = std::fs::read_dir(dir).and_then(Iterator::collect::<Result<Vec<_>, _>>).map_err(TaskError::Start)?;
    let mut all: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    all.sort();
    Ok(all)
}

/// The Rust files below a folder, in the order of their paths; none where there is no such folder.
fn sources(dir: &Path) -> Result<Vec<PathBuf>, TaskError> {
    if !dir.is_dir() {
        return Ok(Vec::new());
    }
    let mut all = Vec::new();
    for entry in std::fs::read_dir(dir).map_err(TaskError::Start)? {
        let path = entry.map_err(TaskError::Start)?.path();
        if path.is_dir() {
            all.extend(sources(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            all.push(path);
        }
    }
    all.sort();
    Ok(all)
}

/// Entries for the variants of an enum that have a message of their own.
fn of_enum(item: &ItemEnum) -> String {
    item.variants.iter().filter_map(of_variant).collect()
}

fn of_variant(variant: &Variant) -> Option<String> {
    let message = variant.attrs.iter().find_map(|attribute| message(attribute, &variant.fields))?;
    // Words in back quotes stand between two of them.
    let [open, close] = if message.contains('`') { ["`` ", " ``"] } else { ["`", "`"] };
    let mut text = format!("\n**{open}{message}{close}**\n\n{}\n", documentation(&variant.attrs));
    if let Fields::Named(fields) = &variant.fields {
        let mut is_first = true;
        for field in &fields.named {
            let (Some(name), about) = (&field.ident, documentation(&field.attrs)) else { continue };
            if message.contains(&format!("{{{name}}}")) && !about.is_empty() {
                text += if is_first { "\n" } else { "" };
                is_first = false;
                let _ = writeln!(text, "- `{{{name}}}`: {}", lower(&about));
            }
        }
    }
    Some(text)
}

/// The message of `#[error("...")]`, with the names of fields in the place of what is put in; `None` of another attribute, and of
/// `transparent`.
fn message(attribute: &Attribute, fields: &Fields) -> Option<String> {
    if !attribute.path().is_ident("error") {
        return None;
    }
    let (text, arguments) = attribute.parse_args_with(text_and_arguments).ok()?;
    let known: Vec<String> = fields.iter().filter_map(|field| field.ident.as_ref()).map(ToString::to_string).collect();
    let mut arguments = split(&arguments).into_iter().map(|argument| name_of(argument, &known));
    let (mut message, mut rest) = (String::new(), text.as_str());
    while let Some((before, after)) = rest.split_once('{') {
        let (inner, after) = after.split_once('}')?;
        let name = inner.split(':').next().unwrap_or_default();
        // Without a name it is the next argument, or a field that has none.
        let name = match name.is_empty() || name.parse::<usize>().is_ok() {
            true => arguments.next().unwrap_or_else(|| "reason".into()),
            false => name.to_owned(),
        };
        let _ = write!(message, "{before}{{{name}}}");
        rest = after;
    }
    Some(message + rest)
}

/// Text of a message, and what stands after it.
fn text_and_arguments(input: syn::parse::ParseStream<'_>) -> syn::Result<(String, String)> {
    let text: LitStr = input.parse()?;
    let arguments = input.to_string();
    input.step(|cursor| {
        let mut rest = *cursor;
        while let Some((_, next)) = rest.token_tree() {
            rest = next;
        }
        Ok(((), rest))
    })?;
    Ok((text.value(), arguments))
}

/// Arguments between the commas that stand in no parentheses.
fn split(arguments: &str) -> Vec<&str> {
    let (mut all, mut depth, mut from) = (Vec::new(), 0_i32, 0);
    for (at, c) in arguments.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            ',' if depth == 0 => {
                all.push(&arguments[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    all.push(&arguments[from..]);
    all.into_iter().map(str::trim).filter(|argument| !argument.is_empty()).collect()
}

/// Name of an argument: that of the field that is in it, else its last word.
fn name_of(argument: &str, fields: &[String]) -> String {
    let words = || argument.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
    let field = words().find(|word| fields.iter().any(|field| field == word));
    field.or(words().next_back()).unwrap_or("reason").to_lowercase()
}

/// The documentation of an item in one line.
fn documentation(attributes: &[Attribute]) -> String {
    let line = |attribute: &Attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(literal) => match &literal.lit {
                Lit::Str(text) => Some(text.value().trim().to_owned()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    };
    without_links(&attributes.iter().filter_map(line).collect::<Vec<_>>().join(" "))
}

/// The text with the names of items in the place of links to them, which lead nowhere outside of Rust's documentation.
fn without_links(text: &str) -> String {
    let (mut plain, mut rest) = (String::new(), text);
    while let Some((before, after)) = rest.split_once("[`") {
        let Some((name, after)) = after.split_once("`]") else { break };
        let _ = write!(plain, "{before}`{name}`");
        rest = match after.strip_prefix('(') {
            Some(target) => target.split_once(')').map_or("", |(_, after)| after),
            None => after,
        };
    }
    plain + rest
}

/// A sentence as the end of one.
fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}
