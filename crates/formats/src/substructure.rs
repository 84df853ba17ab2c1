//! Abaqus's substructures as linear user elements: `*USER ELEMENT, NODES=n, LINEAR[, UNSYMM]`, then `*MATRIX, TYPE=STIFFNESS` and
//! `*MATRIX, TYPE=MASS`, as `*SUBSTRUCTURE MATRIX OUTPUT, OUTPUT FILE=USER DEFINED` writes them, in CalculiX too.
//!
//! The nodes stand in comments after `** ELEMENT NODES`. The first line after the keyword gives the directions of the first node of the
//! element; each further line, `position, direction, direction, ...`, gives the directions of the node at that position, from 1. Directions hold for all nodes
//! from there to the next position. Rows are ordered by node, and within a node by direction as listed. A symmetric matrix is its upper
//! triangle by columns, each column from the top to the diagonal; an unsymmetric one all its columns (the order in which Abaqus's
//! results file has them). A column begins a new line and wraps after a few numbers; where lines end is not relied on.

use crate::Dof;
use crate::builder::{Builder, Found, Head, Stated};
use crate::limits::Limits;
use crate::lines::Lines;
use crate::matrix::{Kind, Matrix};
use crate::numbers::{fortran, whole};
use crate::problem::Problem;
use crate::shortened::cut;

/// Reads the matrices of the one element of the file: stiffness, mass and viscous damping; matrices of other types are left out by name.
pub(crate) fn parse(lines: &mut Lines<'_>, limits: &Limits) -> Result<Found, Problem> {
    let mut found = Found::default();
    let (mut element, mut current) = (None::<Element>, None::<Packed>);
    while let Some(line) = lines.next()?.map(str::trim) {
        if line.is_empty() {
            continue;
        }
        if let Some(comment) = line.strip_prefix("**") {
            if let (Some(element), None) = (&mut element, &current) {
                element.read_comment(comment);
            }
            continue;
        }
        let Some(keyword) = line.strip_prefix('*') else {
            match (&mut current, &mut element) {
                (Some(packed), _) => packed.push_line(line, limits)?,
                (None, Some(element)) => element.read_directions(line)?,
                (None, None) => return Err(Problem::field("the first line", line, "*USER ELEMENT")),
            }
            continue;
        };
        let upper = keyword.to_uppercase();
        let mut words = upper.split(',').map(str::trim);
        match (words.next().unwrap_or_default(), &element) {
            ("USER ELEMENT", None) => {
                let unsymmetric = words.any(|word| word.starts_with("UNSYM"));
                element = Some(Element { unsymmetric, nodes: None, directions: Vec::new() });
            }
            ("USER ELEMENT", Some(_)) => {
                return Err(Problem::field("the number of elements", "2 or more", "1; an assembly is not done here"));
            }
            ("MATRIX", Some(element)) => {
                if let Some(packed) = current.take() {
                    packed.keep(element, limits, &mut found)?;
                }
                let (name, kind) = kind(words.find_map(|word| word.strip_prefix("TYPE")));
                current = Some(Packed { name, kind, values: Vec::new() });
            }
            ("MATRIX", None) => return Err(Problem::field("*MATRIX", "first", "*USER ELEMENT before it")),
            (found, _) => {
                let allowed = "*USER ELEMENT, *MATRIX";
                return Err(Problem::Keyword { what: "keyword", found: cut(found), allowed });
            }
        }
    }
    let (Some(packed), Some(element)) = (current, element) else {
        return Err(Problem::End { what: "the element, before its first matrix" });
    };
    lines.check_end()?;
    packed.keep(&element, limits, &mut found)?;
    Ok(found)
}

/// Name of a matrix and its role K, M or C, by the rest of its parameter `TYPE=...`; no role for a type that is not read.
fn kind(parameter: Option<&str>) -> (String, Option<Kind>) {
    let kind = match parameter.unwrap_or_default().trim_start_matches(['=', ' ']) {
        "STIFFNESS" => Kind::Stiffness,
        "MASS" => Kind::Mass,
        "VISCOUS DAMPING" | "DAMPING" => Kind::Damping,
        "" => return ("matrix without a type".to_owned(), None),
        other => return (cut(&other.to_lowercase()), None),
    };
    (kind.to_string(), Some(kind))
}

/// Nodes and directions of the element.
struct Element {
    /// True if the element has the parameter `UNSYMM`; its matrices may be symmetric nonetheless.
    unsymmetric: bool,
    /// Numbers of the nodes in the order of the element; `None` before the comment that announces them.
    nodes: Option<Vec<i64>>,
    /// Positions in `nodes`, ascending, each with the directions of the nodes from it on, up to the next position.
    directions: Vec<(usize, Vec<u32>)>,
}

impl Element {
    /// Takes nodes from a comment after the one that announces them. A comment with anything but whole numbers is passed over.
    fn read_comment(&mut self, comment: &str) {
        match &mut self.nodes {
            None if comment.trim().eq_ignore_ascii_case("ELEMENT NODES") => self.nodes = Some(Vec::new()),
            None => {}
            Some(nodes) => {
                let fields = comment.split(',').map(str::trim).filter(|field| !field.is_empty());
                if let Ok(more) = fields.map(str::parse).collect::<Result<Vec<i64>, _>>() {
                    nodes.extend(more);
                }
            }
        }
    }

    /// Takes a line of directions: the first is of position 1, any other begins with its position.
    fn read_directions(&mut self, line: &str) -> Result<(), Problem> {
        let fields = line.split(',').map(str::trim).filter(|field| !field.is_empty());
        let mut numbers = fields.map(|field| whole("direction", field)).collect::<Result<Vec<_>, _>>()?.into_iter();
        let from = if self.directions.is_empty() { 1 } else { numbers.next().unwrap_or_default() };
        let before = self.directions.last().map(|last| last.0 + 1);
        if from == 0 || before.is_some_and(|before| from <= before) {
            return Err(Problem::field("position of a node", from, "growing from 1 on"));
        }
        let direction = |n: usize| u32::try_from(n).map_err(|_| Problem::field("direction", n, "1 to 4294967295"));
        self.directions.push((from - 1, numbers.map(direction).collect::<Result<_, _>>()?));
        Ok(())
    }

    /// Number of rows that a matrix must have: as many as the first matrix of the element has, else as there are labels; `None` where neither
    /// is known.
    fn rows(&self, before: &[Matrix]) -> Option<usize> {
        before.first().map(Matrix::rows).or_else(|| self.labels().map(|labels| labels.len()))
    }

    /// Name of each row; `None` where nodes or directions are not given, where a name comes twice, or where there are too many.
    fn labels(&self) -> Option<Vec<Dof>> {
        /// Most labels that are worth having; chosen: a full matrix of as many rows has 2^32 entries.
        const MOST_LABELS: usize = 1 << 16;
        let mut labels = Vec::new();
        let mut lists = self.directions.iter().peekable();
        let mut directions: &[u32] = &[];
        for (at, &node) in self.nodes.as_ref()?.iter().enumerate() {
            while let Some((_, list)) = lists.next_if(|(from, _)| *from <= at) {
                directions = list;
            }
            labels.extend(directions.iter().map(|&direction| Dof { node, direction }));
            if labels.len() > MOST_LABELS {
                return None;
            }
        }
        let different: std::collections::HashSet<_> = labels.iter().collect();
        (!labels.is_empty() && different.len() == labels.len()).then_some(labels)
    }
}

/// Matrix while it is read: its numbers in the order of the file. Their count, known at the end, says the number of rows.
struct Packed {
    name: String,
    /// Role K, M or C; `None` for a type that is not read.
    kind: Option<Kind>,
    /// Upper triangle or all entries, by columns.
    values: Vec<f64>,
}

impl Packed {
    /// Takes the numbers of a line.
    fn push_line(&mut self, line: &str, limits: &Limits) -> Result<(), Problem> {
        if self.kind.is_none() {
            return Ok(());
        }
        // A line may end with a comma.
        for field in line.strip_suffix(',').unwrap_or(line).split(',') {
            if self.values.len() >= limits.entries {
                return Err(Problem::Limit { what: "entries of a matrix", most: limits.entries as u64 });
            }
            self.values.push(fortran(field.trim())?);
        }
        Ok(())
    }

    /// Keeps the matrix, or its name where it is of a type that is not read.
    fn keep(self, element: &Element, limits: &Limits, found: &mut Found) -> Result<(), Problem> {
        if self.kind.is_none() {
            found.leave_out(&self.name, "a type that is not read; read are STIFFNESS, MASS and VISCOUS DAMPING");
            return Ok(());
        }
        let expected = element.rows(&found.matrices);
        found.matrices.push(self.finish(element, expected, limits)?);
        Ok(())
    }

    /// The matrix; `expected` is the number n of rows, where nodes or another matrix of the element tell it.
    ///
    /// Abaqus writes a symmetric matrix of an unsymmetric element as a triangle too, so that the count of numbers decides: `n (n + 1) / 2` or
    /// `n n`. Where n is not known a count can be both, as 36 (8 rows of a triangle, 6 of a whole matrix) and 1225 are; the matrix of an
    /// unsymmetric element is then taken as whole.
    fn finish(self, element: &Element, expected: Option<usize>, limits: &Limits) -> Result<Matrix, Problem> {
        let count = self.values.len();
        let (whole, triangle) = (count.isqrt(), ((8 * count + 1).isqrt() - 1) / 2);
        let fits = |order: usize| order > 0 && expected.is_none_or(|expected| expected == order);
        let is_whole = element.unsymmetric && whole * whole == count && fits(whole);
        let order = if is_whole { whole } else { triangle };
        if !is_whole && (triangle * (triangle + 1) / 2 != count || !fits(triangle)) {
            let rows = expected.map_or(String::new(), |rows| format!(", n = {rows}"));
            let allowed = format!("n (n + 1) / 2{}{rows}", if element.unsymmetric { " or n n" } else { "" });
            return Err(Problem::field("the number of entries of a matrix", count, allowed));
        }
        crate::numbers::order("number of rows", order, limits.order)?;
        let mut builder = Builder::new(limits);
        let places = (0..order).flat_map(|j| (0..if is_whole { order } else { j + 1 }).map(move |i| (i, j)));
        for ((i, j), &value) in places.zip(&self.values).filter(|(_, value)| **value != 0.0) {
            builder.push(i, j, value)?;
        }
        let labels = element.labels().filter(|labels| labels.len() == order);
        let head = Head::unlabelled(self.name, self.kind, (order, order));
        let symmetry = if is_whole { Stated::General } else { Stated::Symmetric };
        builder.finish(symmetry, Head { row_labels: labels.clone(), column_labels: labels, ..head })
    }
}
