//! Claims C11 and C12: natural frequencies and counts that the paper prints.

use brakes::case::Paper;
use linsys::SecondOrder;
use squeal::results::Results;

use super::scenes::{UNCONSTRAINED, full_contact};
use crate::claims::Claim;

/// Undamped frequencies in Hz without friction, every oscillator in contact: those of the oscillators and of the plate,
/// by where most of the kinetic energy is.
fn undamped(results: &Results) -> Option<(Vec<f64>, Vec<f64>)> {
    let (_, scene, _) = full_contact(results, UNCONSTRAINED).next()?;
    let brake = results.plan().brake(scene);
    let SecondOrder { m, k, .. } = brake.system.terms()[0].matrices();
    let root = m.map_diagonal(|mass| 1.0 / mass.sqrt());
    let symmetric = nalgebra::DMatrix::from_fn(k.nrows(), k.ncols(), |i, j| k[(i, j)] * root[i] * root[j]);
    let modes = symmetric.symmetric_eigen();
    let plate = &brake.bodies.last()?.dofs;
    let (mut of_oscillators, mut of_plate) = (Vec::new(), Vec::new());
    for (value, shape) in modes.eigenvalues.iter().zip(modes.eigenvectors.column_iter()) {
        let share: f64 = plate.iter().map(|&dof| shape[dof] * shape[dof]).sum();
        let frequency = value.max(0.0).sqrt() / std::f64::consts::TAU;
        if share > 0.5 { of_plate.push(frequency) } else { of_oscillators.push(frequency) }
    }
    of_oscillators.sort_by(f64::total_cmp);
    of_plate.sort_by(f64::total_cmp);
    Some((of_oscillators, of_plate))
}

/// C11: the natural frequencies.
pub(super) fn natural_frequencies(results: &Results, paper: &Paper) -> Claim {
    let ([a, b], [c, d]) = (paper.natural_frequencies_oscillators, paper.natural_frequencies_plate);
    let statement = "lowest and highest natural frequencies of the oscillators and of the plate";
    let claim = Claim::new("C11", statement, format!("{a} / {b} Hz and {c} / {d} Hz"));
    let Some((oscillators, plate)) = undamped(results) else { return claim.undetermined("no full contact") };
    let (Some(p), Some(q), Some(r), Some(s)) = (oscillators.first(), oscillators.last(), plate.first(), plate.last())
    else {
        return claim.undetermined("no modes of one of them");
    };
    let pairs = [(p, a), (q, b), (r, c), (s, d)];
    let worst = pairs.iter().map(|(ours, paper)| (*ours / paper - 1.0).abs()).fold(0.0, f64::max);
    let detail = format!(
        "largest relative difference; ours {p:.0} / {q:.0} Hz and {r:.0} / {s:.0} Hz, undamped and without friction, \
         from the stiffnesses and masses of the case; the highest over the lowest of the oscillators is {:.2}, in the paper \
         {:.2}, which a mass common to all leaves as it is",
        q / p,
        b / a
    );
    claim.exactly(worst, (worst <= paper.frequency_tolerance).into(), detail)
}

/// C12: the number of arrangements and of analyses.
pub(super) fn counted(results: &Results, paper: &Paper) -> Claim {
    let said =
        format!("{} arrangements of six, {} CEAs each", paper.arrangements_of_six, paper.analyses_per_arrangement);
    let panels = &results.plan().labels.panels;
    let six = panels.iter().find(|panel| panel.in_contact == 6).map_or(0, |panel| panel.arrangements.len());
    let samples = results.summary.samples;
    let holds = six == paper.arrangements_of_six && samples == paper.analyses_per_arrangement;
    let detail = format!("arrangements with six in contact; {samples} samples of each in every law and speed range");
    Claim::new("C12", "84 arrangements with six in contact, 1,000 CEAs each", said).exactly(
        six as f64,
        holds.into(),
        detail,
    )
}
