//! Draft of a case: what files say of a brake, as a commented case file in which the rest is to be filled in.

use std::path::Path;

use formats::FormatsError;

use crate::CaseError;

/// A case file of which files say what they can: `squeal check` takes it as it is, without contact and friction. A line that begins with `#` and no
/// blank is commented out; it waits to be filled in where a `?` stands before its own comment.
#[derive(Debug, Clone)]
pub struct Draft {
    /// Text of the case file.
    pub text: String,
    /// Facts found in the files, for the screen: a label and words each.
    pub found: Vec<(&'static str, String)>,
}

impl Draft {
    /// Number of lines with something to be filled in.
    #[must_use]
    pub fn waiting(&self) -> usize {
        waiting(&self.text)
    }
}

/// Number of lines of a draft that wait to be filled in. No text of a draft in quotes has a `#`.
pub(crate) fn waiting(text: &str) -> usize {
    let fields = text.lines().filter_map(|line| line.strip_prefix('#')).filter(|line| !line.starts_with(' '));
    fields.filter(|line| line.split('#').next().is_some_and(|field| field.contains('?'))).count()
}

/// True if the case was refused because nothing says whether a one-sided matrix is a triangle of a symmetric one or a whole unsymmetric one.
pub(crate) fn is_one_sided(error: &CaseError) -> bool {
    matches!(error, CaseError::Matrix { source, .. } if matches!(**source, FormatsError::OneSided { .. }))
}

/// The line of a damping, nothing without one.
pub(crate) fn damping_line(damping: Option<&Path>, case: &Path) -> String {
    damping.map_or_else(String::new, |file| format!("damping = {}\n", quoted(&named(file, case))))
}

/// The line of one-sided matrices that are taken as triangles, nothing for others.
pub(crate) fn symmetry_line(is_triangle: bool) -> &'static str {
    match is_triangle {
        true => {
            "symmetry = \"triangle\"               # no entry has its mirror image: a triangle of symmetric matrices, as Abaqus writes them; \"whole\" if \
             friction is in them\n"
        }
        false => "",
    }
}

/// A text as TOML has it.
pub(crate) fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// The path of a file from the folder in which the case file `case` is, or from the root where it is not in that folder.
pub(crate) fn named(file: &Path, case: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (file, folder) = (absolute(file), absolute(case));
    let folder = folder.parent().unwrap_or(Path::new(""));
    file.strip_prefix(folder).unwrap_or(&file).display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_from_the_folder_of_the_case() {
        assert_eq!(named(Path::new("a/b/m.inp"), Path::new("a/c.toml")), Path::new("b/m.inp").display().to_string());
        assert!(Path::new(&named(Path::new("m.inp"), Path::new("a/c.toml"))).is_absolute());
        assert_eq!(quoted("C:\\a\"b"), "'C:\\a\"b'");
    }
}
