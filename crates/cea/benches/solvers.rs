//! Times of whole spectra by the batched and by the scalar solver, of one eigenvector, and of the certificates of a spectrum,
//! for 10, 30 and 60 degrees of freedom, with and without internal states.

use std::hint::black_box;

use cea::{BatchSolver, EigenSolver, QrSolver, Workspace, certified, right_vector};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use linsys::SecondOrder;

/// Degrees of freedom and internal states.
const SHAPES: [(usize, usize); 4] = [(10, 0), (30, 0), (30, 9), (60, 0)];

/// A chain with an unsymmetric coupling in K, which alternates in sign so that it does not add up along the chain.
fn chain(n: usize, s: usize, coupling: f64) -> SecondOrder {
    let mut system = SecondOrder::zeros(n, s);
    for i in 0..n {
        system.m[(i, i)] = 0.39;
        system.k[(i, i)] = 4.9e7 + 1e6 * i as f64;
        system.c[(i, i)] = 360.0;
        if i + 1 < n {
            let coupling = if i % 2 == 0 { coupling } else { -coupling };
            system.k[(i, i + 1)] = -1.05e7 + coupling;
            system.k[(i + 1, i)] = -1.05e7 - coupling;
        }
    }
    for k in 0..s {
        system.internal.decay[k] = 2e4;
        system.internal.drive[(k, k)] = -0.3;
        system.internal.force[(k, k)] = 6e7;
    }
    system
}

fn spectra(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("spectrum");
    group.sample_size(20);
    for (n, s) in SHAPES {
        let systems: Vec<_> = (0..16).map(|i| chain(n, s, 1e6 * f64::from(i))).collect();
        group.throughput(Throughput::Elements(systems.len() as u64));
        let mut work = Workspace::default();
        let mut out = Vec::new();
        group.bench_function(BenchmarkId::new("batch", format!("{n}+{s}")), |bencher| {
            bencher.iter(|| BatchSolver.eigenvalues_of_all(black_box(&systems), &mut work, &mut out));
        });
        group.bench_function(BenchmarkId::new("scalar", format!("{n}+{s}")), |bencher| {
            bencher.iter(|| QrSolver.eigenvalues_of_all(black_box(&systems), &mut work, &mut out));
        });
    }
    group.finish();
}

fn one_vector(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("right vector");
    for (n, s) in SHAPES {
        let system = chain(n, s, 3e6);
        let mut work = Workspace::default();
        let Ok(spectrum) = QrSolver.eigenvalues(&system, &mut work) else { continue };
        let Some(lambda) = spectrum.oscillatory().next() else { continue };
        group.bench_function(format!("{n}+{s}"), |bencher| {
            bencher.iter(|| right_vector(black_box(&system), lambda, &mut work));
        });
    }
    group.finish();
}

fn certificates(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("certificates");
    group.sample_size(10);
    for (n, s) in SHAPES {
        let system = chain(n, s, 3e6);
        let mut counters = certified::Counters::default();
        let Ok(spectrum) = certified::solve(&system, &mut counters) else { continue };
        group.bench_function(format!("{n}+{s}"), |bencher| {
            bencher.iter(|| certified::certify(black_box(&system), &spectrum, &mut counters));
        });
    }
    group.finish();
}

criterion_group!(benches, spectra, one_vector, certificates);
criterion_main!(benches);
