//! Large brakes against their references. The data are not part of this repository: the tests are ignored, and the environment
//! variables name their folders. docs/large-problems.md has what they print.
//!
//! - `SQUEAL_DISK_BRAKE4669`: M, D1, DG, DR, D4, K1, KR, KGEO of BrakeSqueal 0.1 as Matrix Market files, gzipped, and the reference
//!   eigenvalues `box_eigs_bs_w2pi.csv` and `box_eigs_bs_w4pi.csv`.
//! - `SQUEAL_REFINED`: M, C and K of a refined brake as `M.npz`, `C.npz` and `K.npz`; it is searched and counted from 0.5 to 8 kHz.
//! - `SQUEAL_CCX_BRAKE`: a disc and a pad of CalculiX, `brake.sti.gz`, `brake.mas.gz`, `brake.dof.gz`, its mesh `brake.inp`, the
//!   contact `brake.pairs.csv`, the held nodes `brake.back.csv`, and the references `box_mu0.0.csv`, 0.3 and 0.5.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::HashMap;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use cea::{EigenSolver as _, QrSolver, Workspace};
use cpu_time::ThreadTime;
use formats::Dof;
use linsys::OperatingPoint;
use num_complex::Complex;
use reduction::{Snapshots, compared};
use sparse::nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{Count, Options, Rectangle, SparseAffineSystem, SparseSecondOrder, SparseTerm, eigenpairs_in};

fn folder(variable: &str) -> PathBuf {
    std::env::var(variable).unwrap_or_else(|_| panic!("{variable} names no folder")).into()
}

fn read(path: &Path) -> formats::Matrix {
    formats::read(path).and_then(formats::File::only).unwrap()
}

/// The fields of a CSV file below its header.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.trim().to_owned()).collect()).collect()
}

/// The eigenvalues in the rectangle against those of a file; prints the largest distance and residual.
fn compare(name: &str, system: &SparseSecondOrder, rectangle: &Rectangle, references: &Path) {
    let timed = |counted: usize| {
        let start = ThreadTime::now();
        let found = eigenpairs_in(system, rectangle, &Options { counted, ..Options::default() }, &mut |_| ()).unwrap();
        (found, start.elapsed().as_secs_f64())
    };
    let (_, seconds) = timed(0);
    let (found, with_count) = timed(usize::MAX);
    let Count::Argument { points, .. } = found.count else { panic!("{name}: {:?}", found.count) };
    let mut left: Vec<_> = found.pairs.iter().filter(|pair| pair.lambda.im > 0.0).collect();
    let references = rows(references);
    assert_eq!(left.len(), references.len(), "{name}");
    let (mut distance, mut residual, mut condition) = (0.0_f64, 0.0_f64, 0.0_f64);
    for row in &references {
        let reference = Complex::new(row[0].parse().unwrap(), row[1].parse().unwrap());
        let from = |lambda: Complex<f64>| (lambda - reference).norm() / reference.norm();
        let nearest = (0..left.len()).min_by(|&a, &b| from(left[a].lambda).total_cmp(&from(left[b].lambda))).unwrap();
        let pair = left.swap_remove(nearest);
        distance = distance.max(from(pair.lambda));
        residual = residual.max(pair.backward_error);
        condition = condition.max(pair.condition);
    }
    println!(
        "{name}: {} eigenvalues, largest distance {distance:.1e}, backward error {residual:.1e}, condition {condition:.1e}; \
         {} discs, {} solutions, {seconds:.2} s; {points} points of the count, {:.2} s",
        references.len(),
        found.discs.len(),
        found.counters.solves,
        with_count - seconds
    );
    assert!(distance < 1e-8, "{name}");
}

#[test]
#[ignore = "needs the matrices of disk_brake4669"]
fn disk_brake4669() {
    let folder = folder("SQUEAL_DISK_BRAKE4669");
    let of = |name: &str| read(&folder.join(format!("{name}.mtx.gz"))).to_csc();
    let [m, d1, dg, dr, d4] = ["M", "D1", "DG", "DR", "D4"].map(of);
    let [k1, kr, kgeo] = ["K1", "KR", "KGEO"].map(of);
    let rectangle = Rectangle { re: [-50.0, 1000.0], im: [-50.0, 42_000.0] };
    for turns in [2, 4] {
        let w = f64::from(turns) * PI;
        let c = &d1 + &dg * w + &dr * (1.0 / w - 1.0) + &d4 * (1.0 / (2.0 * PI * 1600.0));
        let k = &k1 + &kr + &kgeo * (w * w - 1.0);
        let system = SparseSecondOrder::new(m.clone(), c, k).unwrap();
        let references = folder.join(format!("box_eigs_bs_w{turns}pi.csv"));
        compare(&format!("disk_brake4669, w = {turns} pi"), &system, &rectangle, &references);
    }
}

/// A basis of modes at three speeds of the disc holds those at speeds in between: none missing, none invented, each verdict the same.
#[test]
#[ignore = "needs the matrices of disk_brake4669"]
fn a_basis_of_disk_brake4669_holds_the_speeds_between_its_points() {
    let folder = folder("SQUEAL_DISK_BRAKE4669");
    let of = |name: &str| read(&folder.join(format!("{name}.mtx.gz"))).to_csc();
    let [m, d1, dg, dr, d4] = ["M", "D1", "DG", "DR", "D4"].map(of);
    let [k1, kr, kgeo] = ["K1", "KR", "KGEO"].map(of);
    let zero = || &m * 0.0;
    let term = |name: &str, [m, c, k]: [CscMatrix<f64>; 3]| SparseTerm {
        name: name.into(),
        family: name.into(),
        matrices: SparseSecondOrder::new(m, c, k).unwrap(),
        loss: 0.0,
    };
    let terms = vec![
        term("structure", [m.clone(), &d1 + &d4 * (1.0 / (2.0 * PI * 1600.0)), &k1 + &kr - &kgeo]),
        term("gyroscopic", [zero(), dg, zero()]),
        term("friction", [zero(), dr, zero()]),
        term("centrifugal", [zero(), zero(), kgeo.clone()]),
    ];
    let system = SparseAffineSystem::new(terms, Vec::new()).unwrap();
    let at = |turns: f64| {
        let w = turns * PI;
        OperatingPoint { coefficients: vec![1.0, w, 1.0 / w - 1.0, w * w], channels: Vec::new() }
    };
    let band = Rectangle { re: [-50.0, 1000.0], im: [100.0, 42_000.0] };
    let mut snapshots = Snapshots::new(&system, band, sparse::Options::default());
    for turns in [2.0, 3.0, 4.0] {
        let found = snapshots.at(&at(turns)).unwrap();
        snapshots.add(&found).unwrap();
    }
    let (basis, _) = snapshots.basis(1e-5, 600).unwrap();
    let reduced = system.project(&basis).unwrap();
    let (mut growing, mut largest, mut modes) = (0, 0.0_f64, 0);
    for turns in [2.0, 2.3, 2.7, 3.4, 3.8, 4.0] {
        let whole =
            eigenpairs_in(&system.assemble(&at(turns)).unwrap(), &band, &Options::default(), &mut |_| ()).unwrap();
        let whole: Vec<_> = whole.pairs.into_iter().map(|pair| pair.lambda).collect();
        let all = QrSolver.eigenvalues(&reduced.assemble(&at(turns)).unwrap(), &mut Workspace::default()).unwrap();
        let own: Vec<_> = all.eigenvalues.into_iter().filter(|&l| band.contains_to_the_right(l, 0.0)).collect();
        let found = compared(&whole, &own);
        assert!(found.missed.is_empty() && found.left.is_empty(), "{turns}: {found:?}");
        let grows = |lambda: Complex<f64>| lambda.re > 0.0;
        assert!(found.pairs.iter().all(|[of_whole, own]| grows(*of_whole) == grows(*own)), "{turns}");
        (growing, modes) = (growing + whole.iter().filter(|l| grows(**l)).count(), modes + whole.len());
        largest = largest.max(found.distance);
    }
    println!("{} columns; {modes} modes at six speeds, {growing} of them growing, within {largest:.1e}", basis.ncols());
    assert!(growing > 0 && largest < 1e-6, "{growing} growing, {largest:e}");
}

/// Places of the nodes of an input deck.
fn places(deck: &Path) -> HashMap<i64, [f64; 3]> {
    let text = std::fs::read_to_string(deck).unwrap();
    let (mut found, mut is_node) = (HashMap::new(), false);
    for line in text.lines() {
        if line.starts_with('*') {
            let keyword = line.split(',').next().unwrap().trim();
            is_node = keyword.eq_ignore_ascii_case("*node");
        } else if is_node {
            let fields: Vec<&str> = line.split(',').map(str::trim).collect();
            let place = [1, 2, 3].map(|i| fields[i].parse().unwrap());
            found.insert(fields[0].parse().unwrap(), place);
        }
    }
    found
}

/// Holders, contact springs and, times mu, friction, on the rows of the brake.
fn contact(folder: &Path, labels: &[Dof]) -> [CscMatrix<f64>; 2] {
    let row: HashMap<Dof, usize> = labels.iter().copied().zip(0..).collect();
    let at = |node: i64, direction: u32| row.get(&Dof { node, direction }).copied();
    let mut springs = CooMatrix::new(labels.len(), labels.len());
    let mut friction = CooMatrix::new(labels.len(), labels.len());
    let back = rows(&folder.join("brake.back.csv"));
    for node in &back {
        for (direction, stiffness) in [(1, 4e6), (2, 4e6), (3, 2e6)] {
            if let Some(i) = at(node[0].parse().unwrap(), direction) {
                springs.push(i, i, stiffness * 24.0 / back.len() as f64);
            }
        }
    }
    let (pairs, places) = (rows(&folder.join("brake.pairs.csv")), places(&folder.join("brake.inp")));
    let stiffness = 4e8 * 6.0 / pairs.len() as f64;
    for pair in &pairs {
        let [pad, disc]: [i64; 2] = [0, 1].map(|i| pair[i].parse().unwrap());
        let (pad_z, disc_z) = (at(pad, 3).unwrap(), at(disc, 3).unwrap());
        for (i, j, sign) in [(pad_z, pad_z, 1.0), (disc_z, disc_z, 1.0), (pad_z, disc_z, -1.0), (disc_z, pad_z, -1.0)] {
            springs.push(i, j, sign * stiffness);
        }
        let [x, y, _] = places[&pad];
        let radius = x.hypot(y);
        for (direction, along) in [(1, -y / radius), (2, x / radius)] {
            let (pad_row, disc_row) = (at(pad, direction).unwrap(), at(disc, direction).unwrap());
            for (i, j, sign) in
                [(pad_row, disc_z, -1.0), (pad_row, pad_z, 1.0), (disc_row, disc_z, 1.0), (disc_row, pad_z, -1.0)]
            {
                friction.push(i, j, sign * stiffness * along);
            }
        }
    }
    [springs, friction].map(|matrix| CscMatrix::from(&matrix))
}

#[test]
#[ignore = "needs the files of the disc and pad of CalculiX"]
fn ccx_brake() {
    let folder = folder("SQUEAL_CCX_BRAKE");
    let [m, k] = ["brake.mas.gz", "brake.sti.gz"].map(|name| read(&folder.join(name)));
    let [springs, friction] = contact(&folder, k.row_labels().unwrap());
    let (m, k) = (m.to_csc(), k.to_csc());
    let c = &k * 2e-7 + &m * 5.0;
    let rectangle = Rectangle { re: [-500.0, 1000.0], im: [800.0 * 2.0 * PI, 10_500.0 * 2.0 * PI] };
    for mu in [0.0, 0.3, 0.5] {
        let system = SparseSecondOrder::new(m.clone(), c.clone(), &k + &springs + &friction * mu).unwrap();
        compare(&format!("ccx_brake, mu = {mu:.1}"), &system, &rectangle, &folder.join(format!("box_mu{mu:.1}.csv")));
    }
}

#[test]
#[ignore = "needs the matrices of a refined brake"]
fn refined() {
    let folder = folder("SQUEAL_REFINED");
    let [m, c, k] = ["M", "C", "K"].map(|name| read(&folder.join(format!("{name}.npz"))).to_csc());
    let system = SparseSecondOrder::new(m, c, k).unwrap();
    let rectangle = Rectangle { re: [-1000.0, 2000.0], im: [500.0 * 2.0 * PI, 8000.0 * 2.0 * PI] };
    for counted in [0, usize::MAX] {
        let start = ThreadTime::now();
        let found =
            eigenpairs_in(&system, &rectangle, &Options { counted, ..Options::default() }, &mut |_| ()).unwrap();
        let (seconds, order) = (start.elapsed().as_secs_f64(), system.order());
        println!(
            "{order} degrees of freedom, {} pairs, {} discs, {:?}: {seconds:.2} s",
            found.pairs.len(),
            found.discs.len(),
            found.count
        );
    }
}
