//! Time per spectrum: the batched solver and the scalar one, 30 and 60 degrees of freedom, with and without
//! internal states.

use std::hint::black_box;

use cea::{BatchSolver, EigenSolver, QrSolver, Workspace};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use linsys::SecondOrder;

/// A chain with a coupling that takes the symmetry out of K, alternating so that it does not add up along the chain.
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
    for (n, s) in [(10, 0), (30, 0), (30, 9), (60, 0)] {
        let systems: Vec<_> = (0..64).map(|i| chain(n, s, 3e5 * f64::from(i))).collect();
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

criterion_group!(benches, spectra);
criterion_main!(benches);
