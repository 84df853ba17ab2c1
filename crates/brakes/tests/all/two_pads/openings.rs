//! Sweeps in which contact points open and close, by equilibrium.

use std::f64::consts::TAU;

use num_complex::Complex;
use sparse::{Options, Rectangle, eigenpairs_in};
use squeal::study::Study;
use squeal::sweep::{Found, Over, Sweep, sweep};

use super::Folder;
use super::equilibrium::{constant, forces, pressed_off_the_middle_in};

/// The eigenvalues of the branches at a value of the parameter.
fn on_branches(found: &Sweep, at: f64) -> Vec<Complex<f64>> {
    let of = |branch: &squeal::sweep::NamedBranch| {
        let step = branch.points.windows(2).position(|step| step[0].0 <= at && at <= step[1].0)?;
        let [from, to] = [branch.points[step].0, branch.points[step + 1].0];
        Some(branch.between(step, (at - from) / (to - from)).1)
    };
    found.branches.iter().filter_map(of).collect()
}

/// Over friction: at each opening the normal force of the point that opens or closes vanishes, and on both sides of openings, ten values
/// of each, branches have the modes of the whole brake, which is solved anew there by a sparse solver.
#[test]
#[ignore = "minutes"]
fn branches_between_openings_are_those_of_the_whole_brake() {
    let folder = Folder::new();
    let text = pressed_off_the_middle_in(&folder)
        .replace("frequencies = [1000.0, 8000.0]", "frequencies = [1500.0, 3500.0]\ntraining = 3");
    let case = |mu: f64| {
        let mut case = folder.parse(text.clone()).unwrap();
        case.contact.as_mut().unwrap().friction.mu = constant(mu);
        case
    };
    let over = Over { name: "mu".into(), from: 0.3, to: 0.6 };
    let brake =
        brakes::FiniteElementBrake::for_sweep(folder.parse(text.clone()).unwrap(), std::slice::from_ref(&over), &())
            .unwrap();
    let study = Study::new(&brake, &cea::QrSolver).unwrap();
    let found = sweep(&study, 0, &over, &cea::QrSolver, &()).unwrap();
    println!("{}", Found::Branches(found.clone().into()).text());
    assert!(!found.openings.is_empty());
    let changed = |opening: &squeal::sweep::Opening| [opening.opens.clone(), opening.closes.clone()].concat();
    for opening in &found.openings {
        let (below, above) = (forces(&case(opening.at - 1e-7)), forces(&case(opening.at + 1e-7)));
        let largest = below.iter().fold(0.0_f64, |largest, force| largest.max(*force));
        let is_other: Vec<usize> = (0..below.len()).filter(|&at| (below[at] > 0.0) != (above[at] > 0.0)).collect();
        assert_eq!(is_other.len(), changed(opening).len(), "{opening:?}");
        assert!(is_other.iter().all(|&at| below[at].max(above[at]) < 1e-5 * largest), "{opening:?}");
        assert!(opening.unresolved == [0; 2] && opening.jumping > 0, "{opening:?}");
    }
    let rectangle = Rectangle { re: [-500.0, 4e3], im: [TAU * 1.6e3, TAU * 3.4e3] };
    let ends: Vec<f64> =
        [0.3].into_iter().chain(found.openings.iter().map(|opening| opening.at)).chain([0.6]).collect();
    let widest = (1..ends.len() - 1).max_by(|&a, &b| {
        let least = |at: usize| (ends[at] - ends[at - 1]).min(ends[at + 1] - ends[at]);
        least(a).total_cmp(&least(b))
    });
    let at = widest.unwrap();
    for step in 0..10 {
        let part = (f64::from(step) + 0.5) / 10.0;
        for mu in [ends[at] - part * (ends[at] - ends[at - 1]), ends[at] + part * (ends[at + 1] - ends[at])] {
            let case = case(mu);
            let system = case.system.assemble(&brakes::at_medians(&case).unwrap()).unwrap();
            let whole = eigenpairs_in(&system, &rectangle, &Options::default(), &mut |_| ()).unwrap();
            let branches = on_branches(&found, mu);
            assert!(!whole.pairs.is_empty());
            for pair in whole.pairs {
                let distance = |lambda: &Complex<f64>| (lambda - pair.lambda).norm() / pair.lambda.norm();
                let nearest = branches.iter().map(distance).fold(f64::INFINITY, f64::min);
                println!("{mu:.6} {:.3}: {nearest:.1e}", pair.lambda);
                assert!(nearest < 1e-5, "{mu} {}: {nearest:e}", pair.lambda);
            }
        }
    }
}
