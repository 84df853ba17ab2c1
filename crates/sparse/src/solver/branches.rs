//! Parts of an elimination: branches of the tree of its groups, which do not change each other, and the rest, which all of them change.

use std::collections::BinaryHeap;

/// Fewest rows of a matrix that is cut into branches; chosen: factors of a smaller one take less time than threads take to begin.
const FEWEST_ROWS: usize = 6_000;
/// Largest branch, as a fraction of all operations; chosen: with a larger one threads wait for each other, with a smaller one more is left to the last part, which
/// has one thread.
const LARGEST: f64 = 0.1;
/// Smallest branch, as a fraction of all operations; chosen: a smaller one is not worth a part of its own.
const SMALLEST: f64 = 2e-3;

/// Rows that are eliminated together, and the rows that they change.
pub(super) struct Group {
    pub(super) from: usize,
    pub(super) to: usize,
    /// Rows that they change, ascending, all after `to`.
    pub(super) below: Vec<usize>,
    /// The group that comes next: of the first row below.
    pub(super) next: Option<usize>,
}

impl Group {
    pub(super) fn width(&self) -> usize {
        self.to - self.from
    }
}

/// Part of an elimination: groups, and the rows that they have and change. A row of a part is counted among its own rows, which come first, and those of its
/// border.
pub(super) struct Part {
    pub(super) groups: Vec<PartGroup>,
    /// Position in the elimination order of each own row, ascending.
    pub(super) rows: Vec<usize>,
    /// Row of the last part for each row of the border.
    pub(super) border: Vec<usize>,
}

/// Group of a part.
pub(super) struct PartGroup {
    /// Index of the group.
    pub(super) group: usize,
    /// First row, as a row of the part.
    pub(super) from: usize,
    /// Rows that it changes, as rows of the part.
    pub(super) below: Vec<usize>,
}

/// The branches of groups, each of which comes before the group that is next, and last the part with all other groups; that part alone for a small matrix.
pub(super) fn parts(groups: &[Group]) -> Vec<Part> {
    let branch_of = branches(groups);
    let count = branch_of.iter().flatten().max().map_or(0, |last| last + 1);
    let branch_of = &branch_of;
    let members = |branch: Option<usize>| (0..groups.len()).filter(move |&s| branch_of[s] == branch);
    let rows = |branch| -> Vec<usize> { members(branch).flat_map(|s| groups[s].from..groups[s].to).collect() };
    let of_last = rows(None);
    let part = |branch: Option<usize>| {
        let own = rows(branch);
        // Positions of the border, which the last of its groups changes.
        let beyond: Vec<usize> = match (branch, members(branch).next_back()) {
            (Some(_), Some(root)) => groups[root].below.clone(),
            _ => Vec::new(),
        };
        let place = |row: &usize| own.binary_search(row).unwrap_or_else(|_| own.len() + place_in(&beyond, *row));
        let group = |s: usize| {
            let Group { from, below, .. } = &groups[s];
            PartGroup { group: s, from: place(from), below: below.iter().map(&place).collect() }
        };
        let groups = members(branch).map(group).collect();
        let border = beyond.iter().map(|&row| place_in(&of_last, row)).collect();
        Part { groups, rows: own, border }
    };
    (0..count).map(Some).chain([None]).map(part).collect()
}

/// Place of a row among ascending ones, which have it.
fn place_in(rows: &[usize], row: usize) -> usize {
    rows.partition_point(|&other| other < row)
}

/// The branch of each group; `None` for the groups of the last part.
fn branches(groups: &[Group]) -> Vec<Option<usize>> {
    let mut branch_of = vec![None; groups.len()];
    if groups.last().is_none_or(|last| last.to < FEWEST_ROWS) {
        return branch_of;
    }
    // Operations of each group with all that come before it in the tree, roughly.
    let mut operations: Vec<f64> = Vec::with_capacity(groups.len());
    operations.extend(groups.iter().map(|group| (group.width() * (group.width() + group.below.len()).pow(2)) as f64));
    let mut before = vec![Vec::new(); groups.len()];
    for (s, next) in groups.iter().enumerate().filter_map(|(s, group)| Some((s, group.next?))) {
        operations[next] += operations[s];
        before[next].push(s);
    }
    let ends = || (0..groups.len()).filter(|&s| groups[s].next.is_none());
    let all: f64 = ends().map(|s| operations[s]).sum();
    let ranked = |s: usize| (operations[s].to_bits(), s);
    let mut open: BinaryHeap<(u64, usize)> = ends().map(ranked).collect();
    while let Some(&(_, s)) = open.peek()
        && operations[s] > LARGEST * all
    {
        open.pop();
        open.extend(before[s].iter().filter(|&&s| operations[s] > SMALLEST * all).map(|&s| ranked(s)));
    }
    let mut roots: Vec<usize> = open.into_iter().map(|(_, s)| s).filter(|&s| operations[s] > SMALLEST * all).collect();
    if roots.len() < 2 {
        return branch_of;
    }
    roots.sort_unstable();
    roots.iter().enumerate().for_each(|(branch, &root)| branch_of[root] = Some(branch));
    for s in (0..groups.len()).rev() {
        if branch_of[s].is_none() {
            branch_of[s] = groups[s].next.and_then(|next| branch_of[next]);
        }
    }
    branch_of
}
