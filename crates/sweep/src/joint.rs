//! Two pieces of a sweep with the opening between them: what each branch does there.

use linsys::SecondOrder;
use num_complex::Complex;
use study::{ModeLabel, UncertainBrake};

use super::change::{ChangeOf, Place};
use super::divergence::DIVERGENCE;
use super::family::Part;
use super::names::Names;
use super::opening::{Jump, Opening};
use super::openings::OpeningAt;
use super::results::Sweep;
use super::sweep_onset::SweepOnset;
use crate::Error;

/// Largest change of an eigenvalue at an opening, relative to |lambda|, that does not count as a change; chosen: above rounding of the eigenvalue and the width
/// of the opening.
const CONTINUOUS: f64 = 1e-9;

/// End of a piece: the brake just before or just beyond an opening.
pub(super) struct Edge {
    pub system: SecondOrder,
    /// Eigenvalues that are followed, rad/s.
    pub lambdas: Vec<Complex<f64>>,
    /// All eigenvalues, counted.
    pub place: Place,
}

/// Indices of the eigenvalues beyond an opening that each one before it may have become.
pub(super) type Links = Vec<Vec<usize>>;

/// Two pieces with the opening between them.
pub(super) struct Joint<'a, B: UncertainBrake> {
    pub parts: [&'a Part<'a, B>; 2],
    /// The end of the first piece and the beginning of the second.
    pub edges: [&'a Edge; 2],
    /// Names of the eigenvalues before.
    pub names: &'a [Names],
    pub links: &'a Links,
}

impl<B: UncertainBrake> Joint<'_, B> {
    /// Sure links: from one eigenvalue before to one beyond, each of which is in no other link.
    fn sure(&self) -> impl Iterator<Item = (usize, usize)> {
        let reached = |to: usize| self.links.iter().flatten().filter(|other| **other == to).count();
        self.links.iter().enumerate().filter_map(move |(index, to)| match to[..] {
            [to] if reached(to) == 1 => Some((index, to)),
            _ => None,
        })
    }

    fn lambdas(&self, (index, to): (usize, usize)) -> [Complex<f64>; 2] {
        [self.edges[0].lambdas[index], self.edges[1].lambdas[to]]
    }

    /// Sure links of eigenvalues that do not jump.
    pub fn continuous(&self) -> impl Iterator<Item = (usize, usize)> {
        self.sure().filter(|link| {
            let [from, to] = self.lambdas(*link);
            (to - from).norm() <= CONTINUOUS * to.norm()
        })
    }

    /// What the branches do at the opening, with the indices of the eigenvalues before and beyond that no sure link has. Changes of the number of
    /// unstable modes are entered as onsets.
    pub fn crossed(
        &self,
        opening: &OpeningAt,
        points: &[String],
        sweep: &mut Sweep,
    ) -> Result<(Opening, [Vec<usize>; 2]), Error> {
        let [a, b] = opening.between.map(|place| sweep.parameter.at(place));
        let (at, width) = (0.5 * (a + b), b - a);
        let part = self.parts[0];
        let is_studied = |lambda: Complex<f64>| part.is_studied(lambda.im);
        let mut jumps: Vec<Jump> = Vec::new();
        let smooth: Vec<(usize, usize)> = self.continuous().collect();
        let studied = |link: &(usize, usize)| self.lambdas(*link).into_iter().any(is_studied);
        let sides = self.edges.map(|edge| edge.place.sides());
        let grows = |end: usize, lambda: Complex<f64>| {
            let distance = |of: &&(Complex<f64>, Option<bool>)| (of.0 - lambda).norm();
            let nearest = sides[end].iter().min_by(|x, y| distance(x).total_cmp(&distance(y)));
            nearest.is_some_and(|(_, side)| *side == Some(true))
        };
        for link in self.sure() {
            let [from, to] = self.lambdas(link);
            let mode = ModeLabel::candidates(&self.names[link.0]);
            if studied(&link) && !smooth.contains(&link) {
                jumps.push(Jump { mode: mode.clone(), omega: [from.im, to.im], growth: [from.re, to.re] });
            }
            let grown = [grows(0, from), grows(1, to)];
            let [was, is] = [grown[0] && is_studied(from), grown[1] && is_studied(to)];
            if was != is {
                let whole = [(0, [1.0], from), (1, [0.0], to)].map(|(end, at, near)| {
                    match self.parts[end].whole_eigenvalue(&at, near) {
                        Err(Error::Study(study::Error::WholeEigenvalue(_) | study::Error::Cea(_))) => Ok(Some(false)),
                        found => found.map(|found| {
                            let counts = |lambda| part.threshold().margin(lambda) > 0.0 && is_studied(lambda);
                            found.map(|found| counts(found.lambda) == if end == 0 { was } else { is })
                        }),
                    }
                });
                let [first, second] = whole;
                let (first, second) = (first?, second?);
                sweep.evaluations.whole += u64::from(first.is_some()) + u64::from(second.is_some());
                sweep.onsets.push(SweepOnset {
                    at,
                    error: width,
                    omega: from.im,
                    growth: from.re,
                    starts: is,
                    of: if grown == [true; 2] { ChangeOf::Band } else { ChangeOf::Flutter },
                    mode,
                    unstable: 0,
                    moved: None,
                    is_reduced: [first, second].contains(&Some(false)),
                    jump: Some([from.re, to.re]),
                });
            }
        }
        let open = self.open();
        let growing = [0, 1].map(|end| {
            let lambda = |index: &usize| self.edges[end].lambdas[*index];
            open[end]
                .iter()
                .filter(|index| is_studied(lambda(index)) && grows(end, lambda(index)))
                .map(lambda)
                .collect::<Vec<_>>()
        });
        // Of modes that are not joined it is known how many grow on either side, and not which.
        let starts = growing[1].len() > growing[0].len();
        let (more, fewer) = if starts { (1, 0) } else { (0, 1) };
        let mut mode: Names = open[0].iter().flat_map(|&index| self.names[index].clone()).collect();
        mode.sort_unstable();
        mode.dedup();
        for lambda in growing[more].iter().skip(growing[fewer].len()) {
            let distance = |index: &&usize| (self.edges[fewer].lambdas[**index] - lambda).norm();
            let nearest = open[fewer].iter().min_by(|x, y| distance(x).total_cmp(&distance(y)));
            let jump = nearest.map(|&index| {
                let other = self.edges[fewer].lambdas[index].re;
                if starts { [other, lambda.re] } else { [lambda.re, other] }
            });
            sweep.onsets.push(SweepOnset {
                at,
                error: width,
                omega: lambda.im,
                growth: jump.map_or(lambda.re, |[before, _]| before),
                starts,
                of: ChangeOf::Flutter,
                mode: ModeLabel::candidates(&mode),
                unstable: 0,
                moved: None,
                is_reduced: part.relative_error() > 0.0,
                jump,
            });
        }
        let [divergence, more_divergence] = [0, 1].map(|end| {
            let [_, diverging] = self.parts[end].counted(&self.edges[end].place.counted);
            diverging as i64
        });
        let diverging = more_divergence - divergence;
        for _ in 0..diverging.unsigned_abs() {
            sweep.onsets.push(SweepOnset {
                at,
                error: width,
                omega: 0.0,
                growth: part.threshold().growth_above(),
                starts: diverging > 0,
                of: ChangeOf::Divergence,
                mode: DIVERGENCE.to_owned(),
                unstable: 0,
                moved: None,
                is_reduced: false,
                jump: None,
            });
        }
        let named = |indices: &[usize]| indices.iter().map(|&point| points[point].clone()).collect();
        let opening = Opening {
            at,
            width,
            opens: named(&opening.opens),
            closes: named(&opening.closes),
            continuous: smooth.iter().filter(|link| studied(link)).count(),
            jumping: jumps.len(),
            largest: jumps.into_iter().max_by(|x, y| x.size().total_cmp(&y.size())),
            unresolved: [0; 2],
        };
        Ok((opening, open))
    }

    /// Indices of the eigenvalues before and beyond that no sure link has.
    fn open(&self) -> [Vec<usize>; 2] {
        let (from, to): (Vec<usize>, Vec<usize>) = self.sure().unzip();
        [(0, from), (1, to)]
            .map(|(end, joined)| (0..self.edges[end].lambdas.len()).filter(|index| !joined.contains(index)).collect())
    }
}
