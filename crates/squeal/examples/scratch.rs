//! scratch
use squeal::case::Case;
use squeal::study::*;
use std::time::Instant;
fn main() {
    let case = Case::read(std::path::Path::new("cases/paper.toml")).unwrap();
    let plan = squeal::study::Plan::new(case).unwrap();
    println!("scenes {} lattices {}", plan.scenes.len(), plan.lattices.len());
    let t = Instant::now();
    let study = Study::new(&plan, &cea::SchurSolver).unwrap();
    println!("references {:?}", t.elapsed());
    let mut open = std::collections::BTreeMap::new();
    for (r, s) in study.references().iter().zip(&plan.scenes) {
        for n in &r.names { if n.len() != 1 { *open.entry((s.key.constraints, n.clone())).or_insert(0) += 1; } }
    }
    println!("{open:?}");
    for (r, s) in study.references().iter().zip(&plan.scenes).filter(|(_, s)| s.key.panel == 0) {
        let u: Vec<_> = r.modes.iter().zip(&r.names).filter(|(m, _)| m.lambda.re > 0.0).map(|(m, n)| format!("{n:?} {:.1}{:+.1}Hz", m.lambda.re, m.lambda.im / 6.283185307)).collect();
        println!("{:?} {:?}", s.key, u);
    }
    let t = Instant::now();
    let n: u64 = std::env::args().nth(1).map(|x| x.parse().unwrap()).unwrap_or(16);
    let mut mp = montecarlo::Plan::new(2018, n);
    mp.threads = Some(2);
    let r = montecarlo::run(&study, &mp, || Tally::empty(&plan)).unwrap();
    println!("run {:?} failures {}", t.elapsed(), r.failures.total());
    for (s, t) in plan.scenes.iter().zip(&r.tally.scenes).filter(|(s, _)| s.key.panel == 0 || s.members.contains(&0)) {
        println!("{:?} unst {:.2} amb {} undec {} div {} tracked {:?}", s.key, t.unstable_modes as f64 / t.solved as f64, t.ambiguous_modes, t.undecided, t.divergent, t.tracked.iter().map(|(k, h)| (k, h.sure, h.open)).collect::<Vec<_>>());
    }
    let (u, a): (u64, u64) = r.tally.scenes.iter().fold((0, 0), |x, t| (x.0 + t.unstable_modes, x.1 + t.ambiguous_modes));
    println!("unstable {u} ambiguous {a}");
}
