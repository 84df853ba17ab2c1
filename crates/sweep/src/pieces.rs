//! A sweep over one parameter piece by piece between openings, where contact points open or close.
//!
//! On each piece systems are smooth, and branches, onsets and coalescences are found as on a range without openings. Across an opening modes are known
//! again by shape and, where that leaves a doubt, by continuation from the system just before to the one just beyond. An eigenvalue that is the same on
//! both sides makes one branch of two; one that jumps, as a spring of constant stiffness does when it comes off, begins a branch of the same name.
//! Eigenvalues that nothing joins are an ambiguity. Names go from the piece with the medians outward.

use cea::{Mode, Workspace};
use study::UncertainBrake;
use tracking::{Ambiguity, Branches, Path, PathEnd, PathStart, TrackingError, follow_branch, identify};

use super::change::Along;
use super::family::{DIFFERENCE, Family, Line, Part, SHORTEST_STEP};
use super::joint::{Edge, Joint, Links};
use super::names::{Names, names_at};
use super::openings::{OpeningAt, TOGETHER};
use super::parameter::SweptParameter;
use super::part_sweep::{Entry, PartSweep, STEPS_OF_PART, of_part};
use super::results::Sweep;
use crate::Error;

/// Piece of the range, or of the way from there to the median of the parameter.
struct Piece {
    /// Values of the parameter at its ends.
    between: [f64; 2],
    /// True of a piece of the range, false of one on the way to the median.
    is_in_range: bool,
    /// Index of the opening at its upper end; `None` where it ends without one, at an end of the range or at the median.
    opening: Option<usize>,
}

/// Results on a piece.
struct OnPiece {
    /// `None` of a piece that is not in the range.
    sweep: Option<Sweep>,
    edges: [Edge; 2],
    /// Names of the eigenvalues at its ends.
    names: [Vec<Names>; 2],
}

/// The sweep over the pieces between openings.
///
/// # Errors
/// Those of the brake and of the solver.
pub(super) fn piecewise<B: UncertainBrake>(family: &Family<'_, B>, openings: &[OpeningAt]) -> Result<Sweep, Error> {
    let parameter = &family.parameters[0];
    let pieces = pieces(parameter, openings);
    let share = |piece: &Piece| {
        let [from, to] = piece.between.map(|value| parameter.part(value));
        (to - from).min(1.0)
    };
    let families: Vec<_> = pieces.iter().map(|piece| family.piece(piece.between, share(piece))).collect();
    let parts: Vec<Part<'_, B>> = families.iter().map(Family::whole).collect();
    let brake = Pieces { pieces: &pieces, parts: &parts };
    let distance = |at: &usize| {
        let [from, to] = pieces[*at].between;
        (from - parameter.median).max(parameter.median - to)
    };
    let first = (0..pieces.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    family.progress.begin(pieces.len() as u64 * STEPS_OF_PART, 0);
    let found = brake.all(first);
    family.progress.end();
    brake.joined(family, openings, found?)
}

/// The pieces of the range and of the way from there to the median, ascending: each ends at an opening, at an end of the range or at the median.
fn pieces(parameter: &SweptParameter, openings: &[OpeningAt]) -> Vec<Piece> {
    let (start, end) = (parameter.from.min(parameter.median), parameter.to.max(parameter.median));
    let least = TOGETHER * (parameter.to - parameter.from);
    let value = |place: f64| parameter.at(place);
    let mut cuts: Vec<([f64; 2], Option<usize>)> =
        openings.iter().enumerate().map(|(at, opening)| (opening.between.map(value), Some(at))).collect();
    for seam in [parameter.from, parameter.to] {
        let is_near = |(between, _): &([f64; 2], _)| between[0] - least <= seam && seam <= between[1] + least;
        if start < seam && seam < end && !cuts.iter().any(is_near) {
            cuts.push(([seam; 2], None));
        }
    }
    cuts.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let mut pieces: Vec<Piece> = Vec::new();
    let mut begin = start;
    for (between, opening) in cuts.into_iter().chain([([end; 2], None)]) {
        if between[0] - begin > least {
            let middle = 0.5 * (begin + between[0]);
            let is_in_range = (parameter.from..=parameter.to).contains(&middle);
            pieces.push(Piece { between: [begin, between[0]], is_in_range, opening });
        }
        begin = between[1];
    }
    pieces
}

/// The pieces with the brake on them.
struct Pieces<'a, B: UncertainBrake> {
    pieces: &'a [Piece],
    parts: &'a [Part<'a, B>],
}

impl<B: UncertainBrake> Pieces<'_, B> {
    /// The results on all pieces, from the one with the medians outward, with the links across the end of each but the last.
    fn all(&self, first: usize) -> Result<(Vec<OnPiece>, Vec<Links>), Error> {
        let middle = self.on(first, &Entry::Medians)?;
        let (upward, downward) = rayon::join(|| self.upward(first, &middle), || self.downward(first, &middle));
        let ((above, above_links), (mut below, mut links)) = (upward?, downward?);
        below.reverse();
        links.reverse();
        below.push(middle);
        below.extend(above);
        links.extend(above_links);
        Ok((below, links))
    }

    /// The results on the pieces above the one with the medians, ascending, each with the links from the piece before it.
    fn upward(&self, first: usize, middle: &OnPiece) -> Result<(Vec<OnPiece>, Vec<Links>), Error> {
        let (mut found, mut all): (Vec<OnPiece>, Vec<Links>) = Default::default();
        for at in first + 1..self.pieces.len() {
            let before = found.last().unwrap_or(middle);
            let edge = self.edge(at, 0.0)?;
            let links = self.links(at - 1, [&before.edges[1], &edge])?;
            let mut names = vec![Names::new(); edge.lambdas.len()];
            for (own, to) in before.names[1].iter().zip(&links) {
                to.iter().for_each(|&to| names[to].extend(own));
            }
            let next = self.on(at, &Entry::End(0.0, &sorted(names)))?;
            found.push(next);
            all.push(links);
        }
        Ok((found, all))
    }

    /// The results on the pieces below the one with the medians, descending, each with the links to the piece beyond it.
    fn downward(&self, first: usize, middle: &OnPiece) -> Result<(Vec<OnPiece>, Vec<Links>), Error> {
        let (mut found, mut all): (Vec<OnPiece>, Vec<Links>) = Default::default();
        for at in (0..first).rev() {
            let beyond = found.last().unwrap_or(middle);
            let links = self.links(at, [&self.edge(at, 1.0)?, &beyond.edges[0]])?;
            let of = |to: &Vec<usize>| to.iter().flat_map(|&to| beyond.names[0][to].clone()).collect();
            let names = sorted(links.iter().map(of).collect());
            let next = self.on(at, &Entry::End(1.0, &names))?;
            found.push(next);
            all.push(links);
        }
        Ok((found, all))
    }

    /// The brake at an end of a piece, 0 for its lower and 1 for its upper one.
    fn edge(&self, at: usize, end: f64) -> Result<Edge, Error> {
        let part = &self.parts[at];
        let system = |at: f64| part.system(&[at]);
        let place = Along::new(&system, &part.family.solver, part.threshold(), part.band()).place(end)?;
        let lambdas = self.spectra(at).lambdas(end)?.to_vec();
        Ok(Edge { system: system(end)?, lambdas, place })
    }

    /// The spectra along a piece, at fractions of its length.
    fn spectra(&self, at: usize) -> tracking::KeptSpectra<'_, super::family::MakeSystem<'_>> {
        let line = Line { start: vec![0.0], direction: vec![1.0], bounds: [0.0, 1.0], difference: DIFFERENCE };
        self.parts[at].along(line)
    }

    /// The eigenvalues that each one at the end of a piece may become at the beginning of the next piece. Without an opening between the two the system is
    /// the same, and so is each eigenvalue.
    fn links(&self, at: usize, [before, beyond]: [&Edge; 2]) -> Result<Links, Error> {
        if self.pieces[at].opening.is_none() {
            return Ok((0..before.lambdas.len()).map(|index| vec![index]).collect());
        }
        let mut work = Workspace::default();
        let mut modes = |edge: &Edge| Mode::at(&edge.system, &edge.lambdas, &mut work);
        let [from, to] = [modes(before)?, modes(beyond)?];
        let end = PathEnd { system: &beyond.system, modes: &to };
        let path = Path { start: PathStart::System(&before.system), start_modes: &from, end };
        Ok(identify(&self.parts[at].family.solver, path, &mut work)?)
    }

    /// The results on a piece.
    fn on(&self, at: usize, entry: &Entry<'_>) -> Result<OnPiece, Error> {
        let (part, piece) = (&self.parts[at], &self.pieces[at]);
        let edges = [self.edge(at, 0.0)?, self.edge(at, 1.0)?];
        let (sweep, of_branches, mut spectra) = if piece.is_in_range {
            let PartSweep { sweep, names, spectra } = of_part(part, &part.family.parameters[0], entry)?;
            (Some(sweep), names, spectra)
        } else {
            (None, Vec::new(), self.spectra(at))
        };
        let (start, at_start) = match entry {
            Entry::Medians => {
                let median = part.medians()[0];
                (median, names_at(&mut spectra, part.reference, median, median)?)
            }
            Entry::End(end, names) => (*end, names.to_vec()),
        };
        let mut names = edges.each_ref().map(|edge| vec![Names::new(); edge.lambdas.len()]);
        for (end, names) in [0.0, 1.0].into_iter().zip(&mut names) {
            for (index, own) in at_start.iter().enumerate().filter(|(_, own)| !own.is_empty()) {
                // A mode that cannot be told from others all the way has no name there.
                match follow_branch(&mut spectra, start, index, end, SHORTEST_STEP) {
                    Ok(there) => there.into_iter().for_each(|to| names[to].extend(own)),
                    Err(Error::Study(study::Error::Tracking(TrackingError::Unresolved { .. }))) => {}
                    Err(error) => return Err(error),
                }
            }
        }
        let mut names = names.map(sorted);
        if let Some(sweep) = &sweep {
            for (end, (edge, names)) in edges.iter().zip(&mut names).enumerate() {
                for (branch, own) in sweep.branches.iter().zip(&of_branches) {
                    if let Some(index) = index_at(branch, piece.between[end], edge) {
                        names[index].clone_from(own);
                    }
                }
            }
        }
        if sweep.is_none() {
            part.family.progress.advance(STEPS_OF_PART);
        }
        Ok(OnPiece { sweep, edges, names })
    }

    /// The sweeps of all pieces in the range as one, with the openings between them.
    fn joined(
        &self,
        family: &Family<'_, B>,
        openings: &[OpeningAt],
        (found, links): (Vec<OnPiece>, Vec<Links>),
    ) -> Result<Sweep, Error> {
        let (parameter, points) = (&family.parameters[0], family.contact_points());
        let mut total = Sweep::empty(parameter.clone(), family.study.plan().threshold);
        let mut steps = usize::MAX;
        // The piece before, and the branch that each of its eigenvalues at its end belongs to.
        let mut before: Option<(usize, Vec<Option<usize>>)> = None;
        for at in 0..found.len() {
            let Some(mut sweep) = found[at].sweep.clone() else { continue };
            let [first_edge, last_edge] = &found[at].edges;
            let mut continued = vec![None; first_edge.lambdas.len()];
            let mut across = None;
            // Between two pieces in the range there is an opening.
            if let Some((last, alive)) = &before
                && let Some(opened) = self.pieces[*last].opening.map(|at| &openings[at])
            {
                let joint = Joint {
                    parts: [&self.parts[*last], &self.parts[at]],
                    edges: [&found[*last].edges[1], first_edge],
                    names: &found[*last].names[1],
                    links: &links[*last],
                };
                let (opening, doubt) = joint.crossed(opened, &points, &mut total)?;
                for (index, to) in joint.continuous() {
                    continued[to] = alive[index];
                }
                total.compare(opening.at, sweep.unstable_at_start);
                across = Some((opened, opening, doubt, alive.clone()));
                (sweep.unstable_at_start, sweep.diverging_at_start) = (0, 0);
            }
            // The branches of the piece among all.
            let mut places = Vec::with_capacity(sweep.branches.len());
            let mut at_start = vec![None; first_edge.lambdas.len()];
            for branch in std::mem::take(&mut sweep.branches) {
                let begins = index_at_start(&branch, self.pieces[at].between[0], first_edge);
                let place = begins.and_then(|index| continued[index]).unwrap_or(total.branches.len());
                if let Some(index) = begins {
                    at_start[index] = Some(place);
                }
                places.push(place);
                match total.branches.get_mut(place) {
                    Some(known) => known.points.extend(branch.points),
                    None => total.branches.push(branch),
                }
            }
            for ambiguity in std::mem::take(&mut sweep.ambiguities) {
                let of = |branches: Vec<usize>| branches.into_iter().map(|branch| places[branch]).collect();
                total.ambiguities.push(Ambiguity {
                    before: of(ambiguity.before),
                    after: of(ambiguity.after),
                    ..ambiguity
                });
            }
            if let Some((opened, mut opening, [from, to], alive)) = across {
                let of = |indices: &[usize], places: &[Option<usize>]| -> Vec<usize> {
                    indices.iter().filter_map(|&index| places[index]).collect()
                };
                let (ended, begun) = (of(&from, &alive), of(&to, &at_start));
                opening.unresolved = [ended.len(), begun.len()];
                if !(ended.is_empty() && begun.is_empty()) {
                    let [from, to] = opened.between.map(|place| parameter.at(place));
                    total.ambiguities.push(Ambiguity { from, to, before: ended, after: begun });
                }
                total.openings.push(opening);
            }
            sweep.shortest_step *= self.parts[at].family.share;
            steps = steps.min(sweep.steps);
            total.unstable_at_end = 0;
            total = total.joined(sweep);
            let mut alive = vec![None; last_edge.lambdas.len()];
            for (place, branch) in total.branches.iter().enumerate() {
                if let Some(index) = index_at(branch, self.pieces[at].between[1], last_edge) {
                    alive[index] = Some(place);
                }
            }
            before = Some((at, alive));
        }
        total.steps = steps;
        Ok(total)
    }
}

/// Index of the eigenvalue of a branch at an end of a piece among the eigenvalues that are followed there; `None` where it is not one of them.
fn index_at(branch: &super::NamedBranch, value: f64, edge: &Edge) -> Option<usize> {
    let ends = [branch.points.first(), branch.points.last()];
    let (_, point) = ends.into_iter().flatten().find(|(at, _)| *at == value)?;
    edge.lambdas.iter().position(|lambda| *lambda == point.lambda)
}

/// As [`index_at`], where the branch begins.
fn index_at_start(branch: &super::NamedBranch, value: f64, edge: &Edge) -> Option<usize> {
    branch.points.first().filter(|(at, _)| *at == value).and_then(|_| index_at(branch, value, edge))
}

fn sorted(mut all: Vec<Names>) -> Vec<Names> {
    for names in &mut all {
        names.sort_unstable();
        names.dedup();
    }
    all
}
