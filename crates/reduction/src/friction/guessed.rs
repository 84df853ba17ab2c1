//! The growing modes of a sample by guesses: from an anchor, corrected one by one, and counted. For gains that differ from port to port, and
//! where discs do not become clear.

use cea::certified::enclosures::{smith_radius, symmetric_rouche};
use linsys::ChannelGain;
use num_complex::Complex;

use super::anchor::Anchor;
use super::coarse::Coarse;
use super::count::Lacking;
use super::coupling::{self, Gains, combine};
use super::refinement::Start;
use super::search::{Memory, Open, Search, all_of};
use super::secant::{Missed, secant};
use super::shapes::Found;
use crate::eigenvalue;
use cea::certified::lanes::cast;

/// What corrected guesses err by at most, relative to |lambda|; chosen: on cases/disc-pad they err by some millionths, a few by 1e-4.
const COARSE_ERROR: f64 = 5e-4;
/// Relative size of the last correction of a guess; chosen, below that error and above that of single precision.
const GUESSED: f64 = 1e-4;
const MOST_CORRECTIONS: usize = 20;
/// Rounds of corrections of guesses that are wanted only if they are wrong; chosen.
const MOST_SEARCHES: usize = 6;
/// Largest part of [`symmetric_rouche`] for the characteristic function and the polynomial with the zeros found, on a line around the band;
/// chosen: half of what the theorem asks for, as the line is looked at in a few points.
const LARGEST_DEVIATION: f64 = 0.5;

impl Search<'_> {
    /// Modes that are wanted, by guesses from an anchor.
    pub fn by_guesses(
        &self,
        anchor: &Anchor,
        gains: &[ChannelGain],
        is_wanted: &dyn Fn(Complex<f64>, f64) -> bool,
        memory: &mut Memory,
    ) -> Result<Vec<Found>, Open> {
        let Memory { coarse, single, small, .. } = memory;
        for (point, a) in coarse.iter_mut().enumerate() {
            coupling::at_point(&anchor.own, &self.coarse.table, point, Gains::of(gains), single, a);
        }
        let guesses = anchor.guesses(coarse, small);
        // As far as a guess was moved it may be wrong.
        let may_be = |lambda: Complex<f64>, moved: f64| is_wanted(lambda, moved + COARSE_ERROR * lambda.norm());
        let likely: Vec<usize> = (0..guesses.len()).filter(|&i| may_be(guesses[i].lambda, guesses[i].moved)).collect();
        let mut zeros: Vec<Complex<f64>> = guesses.iter().map(|guess| guess.lambda).collect();
        self.correct(&mut zeros, &likely, memory)?;
        let mut wanted = self.wanted(&mut zeros, &may_be, memory)?;
        wanted.retain(|&i| may_be(zeros[i], 0.0));
        let mut finished = |i: usize| {
            let vector = (0..self.ports.near()).map(|row| anchor.vectors.at(i, row)).collect();
            let mode = self.approached(gains, Start { guess: zeros[i], vector }, memory)?;
            let mode = self.refined(gains, mode, Complex::default(), memory)?;
            // Another one is not the mode that was counted.
            let is_same = |mode: &Found| (mode.lambda - zeros[i]).norm() <= COARSE_ERROR * zeros[i].norm();
            Some(mode).filter(is_same).ok_or(Open::NotConverged)
        };
        all_of(wanted.into_iter().map(&mut finished).collect::<Result<_, Open>>()?, is_wanted)
    }

    /// `det(lambda - A(lambda)) / prod_j (lambda - z_j)` at one of the z_j without its factor.
    fn lacking(&self, at: usize, zeros: &[Complex<f64>], memory: &mut Memory) -> Complex<f64> {
        let lambda = zeros[at];
        self.factor_coarse(lambda, memory);
        // Factor by factor, so that no product of many large numbers overflows.
        let factors = memory.single.elimination.pivots.iter().zip(zeros).enumerate();
        let factor = |(j, (&pivot, zero)): (usize, (&Complex<f32>, &Complex<f64>))| {
            let pivot: Complex<f64> = cast(pivot);
            if at == j { pivot } else { pivot / (lambda - zero) }
        };
        factors.map(factor).product()
    }

    /// Factors of `lambda - A` by the coarse points, in `memory.small`.
    fn factor_coarse(&self, lambda: Complex<f64>, memory: &mut Memory) {
        let Memory { single, coarse, small, weights, .. } = memory;
        self.coarse.table.weights_at(lambda, weights);
        let weights: Vec<Complex<f32>> = weights.iter().map(|&weight| cast(-weight)).collect();
        combine(&weights, coarse, small);
        eigenvalue::factor(small, cast(lambda), &mut single.elimination, self.ports.near());
    }

    /// Which of the guesses are wanted, where all are told apart and counted. All zeros are in discs around the guesses, and as many in
    /// overlapping ones as these are ([`smith_radius`]). Where a disc leaves it open, the guess is corrected by what it lacks, all of these at once, which converges quadratically.
    fn wanted(
        &self,
        zeros: &mut [Complex<f64>],
        may_be: &dyn Fn(Complex<f64>, f64) -> bool,
        memory: &mut Memory,
    ) -> Result<Vec<usize>, Open> {
        for _ in 0..MOST_SEARCHES {
            let Memory { coarse, lanes, .. } = memory;
            let Coarse { table, around, .. } = self.coarse;
            let Lacking { at_zeros, around } = lanes.lacking(table, coarse, zeros, around);
            let (mut wanted, mut is_settled) = (Vec::new(), true);
            for (i, lacking) in at_zeros.into_iter().enumerate() {
                let size = lacking.norm();
                if !size.is_finite() {
                    return Err(Open::NotConverged);
                }
                if !may_be(zeros[i], smith_radius(zeros.len(), size)) {
                    continue;
                }
                if size <= GUESSED * zeros[i].norm() {
                    wanted.push(i);
                } else {
                    zeros[i] -= lacking;
                    is_settled = false;
                }
            }
            if is_settled {
                // As many zeros as guesses in the band: none is missing, and none is there twice.
                let is_counted = around.iter().all(|ratio| symmetric_rouche(*ratio, LARGEST_DEVIATION));
                return if is_counted { Ok(wanted) } else { Err(Open::NotCounted) };
            }
        }
        Err(Open::NotConverged)
    }

    /// Corrects some of the guesses: by what the polynomial with all of them as zeros lacks there (Weierstrass), then by the secant
    /// method, so that the errors of others do not slow it down.
    fn correct(&self, zeros: &mut [Complex<f64>], wanted: &[usize], memory: &mut Memory) -> Result<(), Open> {
        let mut open: Vec<(usize, Option<Missed>)> = wanted.iter().map(|&i| (i, None)).collect();
        for _ in 0..MOST_CORRECTIONS {
            if open.is_empty() {
                return Ok(());
            }
            let lacking = open.iter().map(|&(i, _)| self.lacking(i, zeros, memory));
            let lacking: Vec<Complex<f64>> = lacking.collect();
            memory.corrections += lacking.len() as u64;
            let mut next = Vec::with_capacity(open.len());
            for ((i, before), lacking) in open.into_iter().zip(lacking) {
                let (here, miss) = (zeros[i], -lacking);
                zeros[i] = secant(before, (here, miss));
                let step = (zeros[i] - here).norm();
                if !step.is_finite() {
                    return Err(Open::NotConverged);
                }
                if step > GUESSED * here.norm() {
                    next.push((i, Some((here, miss))));
                }
            }
            open = next;
        }
        Err(Open::NotConverged)
    }
}
