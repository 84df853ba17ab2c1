//! A mode at a place on its way, from a guess of its eigenvalue: by the secular equation on lines of gains, by singular
//! vectors of Q between systems.

use cea::{Line, Mode, NewtonStep, Workspace, mass_norm_squared, singular_vectors};
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::track::Way;

/// A correction of the eigenvalue after which another would not be felt, relatively.
const SETTLED: f64 = 5e-5;
/// Corrections of a guess at most.
const MOST_CORRECTIONS: usize = 4;
/// How far aside of the predicted eigenvalue Q is factorised, relatively: on an eigenvalue there is no y but rounding.
const ASIDE: f64 = 1e-7;

/// A place on a way, by the part of it gone, and an eigenvalue there, rad/s.
pub(super) type Place<'a> = (Way<'a>, f64, Complex<f64>);

/// A mode and how its eigenvalue moves along the way.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub mode: Mode,
    pub rate: Complex<f64>,
}

/// Next to an eigenvalue: the next guess of it, how it moves along the way and, where that is known, its shape.
struct Corrected {
    lambda: Complex<f64>,
    rate: Complex<f64>,
    shape: Option<DVector<Complex<f64>>>,
}

/// The mode next to a guess of its eigenvalue at a part of a way; `None` where there is none.
pub(super) fn points(at: &[Place<'_>], work: &mut Workspace) -> Vec<Option<Point>> {
    let mut at = at.to_vec();
    let mut found: Vec<Option<Corrected>> = at.iter().map(|_| None).collect();
    let mut open: Vec<usize> = (0..at.len()).collect();
    for _ in 0..MOST_CORRECTIONS {
        let asked: Vec<_> = open.iter().map(|&i| at[i]).collect();
        let mut corrected = corrected(&asked, work).into_iter();
        open.retain(|&i| {
            let Some(point) = corrected.next().flatten() else { return false };
            let correction = (point.lambda - at[i].2).norm();
            at[i].2 = point.lambda;
            let is_settled = correction <= SETTLED * point.lambda.norm();
            if is_settled {
                found[i] = Some(point);
            }
            !is_settled
        });
        if open.is_empty() {
            break;
        }
    }
    let is_shapeless = |i: &usize| found[*i].as_ref().is_some_and(|point| point.shape.is_none());
    let shapeless: Vec<usize> = (0..at.len()).filter(is_shapeless).collect();
    let on_lines: Vec<_> = shapeless.iter().filter_map(|&i| Some((at[i].0.line()?, at[i].1, at[i].2))).collect();
    for (i, shape) in shapeless.into_iter().zip(Line::shapes(&on_lines, work)) {
        found[i].iter_mut().for_each(|point| point.shape = shape.clone());
    }
    let point = |(found, (way, ..)): (Option<Corrected>, Place<'_>)| {
        let Corrected { lambda, rate, shape } = found?;
        let mut shape = shape?;
        shape.unscale_mut(mass_norm_squared(way.inertia(), &shape).abs().sqrt());
        Some(Point { mode: Mode { lambda, shape }, rate })
    };
    found.into_iter().zip(at).map(point).collect()
}

/// One step of Newton's method at each guess.
fn corrected(at: &[Place<'_>], work: &mut Workspace) -> Vec<Option<Corrected>> {
    let mut found = Vec::with_capacity(at.len());
    let kind = |way: &Way<'_>| (way.line().is_some(), way.to.0.order());
    for group in at.chunk_by(|a, b| kind(&a.0) == kind(&b.0)) {
        let on_lines: Vec<_> = group.iter().filter_map(|&(way, t, guess)| Some((way.line()?, t, guess))).collect();
        if on_lines.is_empty() {
            found.extend(by_vectors(group, work));
        } else {
            found.extend(Line::correct(&on_lines, work).into_iter().map(|NewtonStep { lambda, rate }| {
                (lambda.is_finite() && rate.is_finite()).then_some(Corrected { lambda, rate, shape: None })
            }));
        }
    }
    found
}

/// One step at guesses on ways of one order, by singular vectors.
fn by_vectors(group: &[Place<'_>], work: &mut Workspace) -> Vec<Option<Corrected>> {
    let systems: Vec<SecondOrder> = group.iter().map(|(way, t, _)| way.system(*t)).collect();
    let guesses: Vec<_> = group.iter().map(|(.., guess)| guess * (1.0 + ASIDE)).collect();
    let stiffness: Vec<_> =
        systems.iter().zip(&guesses).map(|(system, &lambda)| system.dynamic_stiffness(lambda)).collect();
    let vectors = singular_vectors(&stiffness, work);
    let step = |(i, vector): (usize, Option<DVector<Complex<f64>>>)| {
        newton(group[i].0.systems()?, &systems[i], guesses[i], &stiffness[i], vector?)
    };
    vectors.into_iter().enumerate().map(step).collect()
}

/// One step next to an eigenvalue whose right singular vector at `lambda` is x.
fn newton(
    ends: [&SecondOrder; 2],
    system: &SecondOrder,
    lambda: Complex<f64>,
    stiffness: &DMatrix<Complex<f64>>,
    x: DVector<Complex<f64>>,
) -> Option<Corrected> {
    let mut y = stiffness * &x;
    let size = y.norm();
    y.unscale_mut(size);
    let slope = y.dotc(&(system.dynamic_stiffness_derivative(lambda) * &x));
    let rate = -y.dotc(&change(ends, lambda, &x)) / slope;
    let lambda = lambda - size / slope;
    (lambda.is_finite() && rate.is_finite()).then_some(Corrected { lambda, rate, shape: Some(x) })
}

/// `d Q(lambda) / d t x = (Q_to(lambda) - Q_from(lambda)) x` on a way between two systems.
fn change([from, to]: [&SecondOrder; 2], lambda: Complex<f64>, x: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    let mut change = DVector::zeros(x.len());
    let matrices =
        [(&from.m, &to.m, lambda * lambda), (&from.c, &to.c, lambda), (&from.k, &to.k, Complex::new(1.0, 0.0))];
    for (a, b, factor) in matrices {
        let columns = a.as_slice().chunks_exact(x.len()).zip(b.as_slice().chunks_exact(x.len()));
        for ((a, b), x) in columns.zip(x) {
            // Few columns change.
            if a != b {
                let factor = factor * x;
                change.iter_mut().zip(a.iter().zip(b)).for_each(|(change, (a, b))| *change += factor * (b - a));
            }
        }
    }
    for (end, sign) in [(&from.internal, 1.0), (&to.internal, -1.0)] {
        for (s, &decay) in end.decay.iter().enumerate() {
            let reading: Complex<f64> = end.drive.row(s).iter().zip(x).map(|(drive, x)| x * drive).sum();
            let gain = sign * lambda / (lambda + decay) * reading;
            change.iter_mut().zip(&end.force.column(s)).for_each(|(change, force)| *change += gain * force);
        }
    }
    change
}
