//! The NLEVP and BrakeSqueal problems of `fixtures/hard` against their references of 25 digits (see its README).

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cea::Verdict;
use cea::certified::{Certified, CertifiedError, ClusterKind, Counters, GeneralSpectrum, Route, certify, solve};
use formats::{Options, read_market};
use linsys::SecondOrder;
use num_complex::Complex;

/// Targets: backward error, and forward error in units of condition x epsilon.
const LARGEST_BACKWARD_ERROR: f64 = 1e-14;
const LARGEST_FORWARD_ERROR: f64 = 100.0;

struct Solved {
    name: String,
    reference: Reference,
    spectrum: GeneralSpectrum,
    certified: Certified,
}

#[derive(Default)]
struct Reference {
    /// Number of exactly zero eigenvalues.
    finite: Vec<Complex<f64>>,
    zeros: usize,
    infinite: usize,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/hard")
}

fn system(case: &Path) -> SecondOrder {
    let read = |name: &str| {
        let text = std::fs::read(case.join(name)).unwrap();
        read_market(&text, Options::default()).unwrap().to_dense()
    };
    SecondOrder::new(read("M.mtx"), read("C.mtx"), read("K.mtx")).unwrap()
}

fn reference(case: &Path) -> Option<Reference> {
    let text = std::fs::read_to_string(case.join("eigs.csv")).ok()?;
    let mut reference = Reference::default();
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        match fields[0] {
            "infinite" => reference.infinite += 1,
            kind => {
                reference.zeros += usize::from(kind == "zero");
                reference.finite.push(Complex::new(fields[1].parse().unwrap(), fields[2].parse().unwrap()));
            }
        }
    }
    Some(reference)
}

/// Every regular case, solved once for all tests.
fn solved() -> &'static [Solved] {
    static SOLVED: OnceLock<Vec<Solved>> = OnceLock::new();
    SOLVED.get_or_init(|| {
        let mut cases: Vec<_> = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()).collect();
        cases.sort();
        let solve_one = |case: PathBuf| {
            let name = case.file_name().unwrap().to_string_lossy().into_owned();
            let reference = reference(&case)?;
            let (system, mut counters) = (system(&case), Counters::default());
            let spectrum = solve(&system, &mut counters).unwrap_or_else(|error| panic!("{name}: {error}"));
            let certified =
                certify(&system, &spectrum, &mut counters).unwrap_or_else(|error| panic!("{name}: {error}"));
            Some(Solved { name, reference, spectrum, certified })
        };
        let cases = cases.into_iter().filter(|case| case.is_dir());
        let solved: Vec<_> = cases.filter_map(solve_one).collect();
        assert_eq!(solved.len(), 19, "every case with a reference");
        solved
    })
}

fn case(name: &str) -> &'static Solved {
    solved().iter().find(|s| s.name == name).unwrap()
}

impl Solved {
    /// Position in the reference of each computed eigenvalue: nearest pairs first.
    fn pairing(&self) -> Vec<usize> {
        let found = &self.certified.eigenvalues;
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, e) in found.iter().enumerate() {
            for (j, r) in self.reference.finite.iter().enumerate() {
                pairs.push(((e.lambda - r).norm(), i, j));
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut partner, mut taken) = (vec![usize::MAX; found.len()], vec![false; found.len()]);
        for (_, i, j) in pairs {
            if partner[i] == usize::MAX && !taken[j] {
                (partner[i], taken[j]) = (j, true);
            }
        }
        partner
    }

    fn count(&self, wanted: impl Fn(Verdict) -> bool) -> usize {
        self.certified.eigenvalues.iter().filter(|e| wanted(e.verdict)).count()
    }

    fn marginal(&self) -> usize {
        self.count(|v| matches!(v, Verdict::Marginal { .. }))
    }
}

#[test]
fn infinite_and_zero_eigenvalues_are_counted_exactly() {
    for s in solved() {
        let counts = (s.spectrum.eigenvalues.len(), s.spectrum.zeros, s.spectrum.infinite);
        assert_eq!(counts, (s.reference.finite.len(), s.reference.zeros, s.reference.infinite), "{}", s.name);
        let zeros = s.certified.eigenvalues.iter().filter(|e| e.lambda == Complex::default());
        assert!(zeros.clone().all(|e| e.verdict == Verdict::Marginal { tolerance: 0.0 }), "{}", s.name);
        assert_eq!(zeros.count(), s.spectrum.zeros, "{}", s.name);
    }
}

#[test]
fn backward_and_forward_errors_meet_their_targets() {
    for s in solved() {
        for (e, j) in s.certified.eigenvalues.iter().zip(s.pairing()) {
            let exact = s.reference.finite[j];
            let error = (e.lambda - exact).norm();
            assert!(e.backward_error <= LARGEST_BACKWARD_ERROR, "{}: {:e} at {exact}", s.name, e.backward_error);
            if exact != Complex::default() {
                let allowed = LARGEST_FORWARD_ERROR * e.condition * f64::EPSILON;
                assert!(error <= allowed * exact.norm(), "{}: {error:e} at {exact}", s.name);
                let bound = e.bound + f64::EPSILON * exact.norm();
                assert!(error <= bound, "{}: error {error:e} beyond its bound {bound:e} at {exact}", s.name);
            }
        }
    }
}

#[test]
fn no_decided_verdict_has_the_wrong_sign() {
    for s in solved() {
        for (e, j) in s.certified.eigenvalues.iter().zip(s.pairing()) {
            let exact = s.reference.finite[j];
            let right = match e.verdict {
                Verdict::Stable => exact.re < 0.0,
                Verdict::Unstable => exact.re > 0.0,
                Verdict::Marginal { tolerance } => exact.re.abs() <= tolerance,
                Verdict::Undecided { bound } => bound > 0.0,
            };
            assert!(right, "{}: {:?} at {exact}", s.name, e.verdict);
        }
    }
}

#[test]
fn neutral_eigenvalues_are_marginal_and_none_of_them_unstable() {
    let beam = case("damped_beam200");
    assert_eq!(beam.marginal(), 200);
    assert_eq!(beam.count(|v| v == Verdict::Stable), 200);
    let wire = case("wiresaw1_100");
    assert_eq!(wire.marginal(), 200);
    // The brake has squealing modes, and each is decided.
    let brake = case("db4669_modal100_w4pi");
    let exact = brake.reference.finite.iter().filter(|l| l.re > 0.0).count();
    assert_eq!(brake.count(|v| v == Verdict::Unstable), exact);
    assert_eq!(exact, 10);
}

#[test]
fn nothing_is_left_undecided_but_what_rounding_made() {
    // Two eigenvalues of `intersection` exist by the rounding of its data: condition numbers above 1e30.
    for s in solved() {
        let undecided = s.count(|v| matches!(v, Verdict::Undecided { .. }));
        assert_eq!(undecided, if s.name == "intersection" { 2 } else { 0 }, "{}", s.name);
    }
}

#[test]
fn the_route_follows_the_matrices() {
    let routes = [
        ("hospital", Route::Standard),
        ("damped_beam200", Route::Standard),
        ("disk_brake100_w4pi", Route::Qz),
        ("mobile_manipulator", Route::DeflatedQz),
        ("spring_dashpot10", Route::DeflatedQz),
        ("omnicam1", Route::ExtendedStandard),
        ("intersection", Route::ExtendedStandard),
    ];
    for (name, route) in routes {
        assert_eq!(case(name).spectrum.route, route, "{name}");
    }
}

#[test]
fn multiple_eigenvalues_are_told_from_defective_ones() {
    // sleeper100: pairs of equal eigenvalues with two vectors each. qep2: 1 three times, with two vectors.
    let doublets = &case("sleeper100").certified.clusters;
    assert_eq!(doublets.len(), 98);
    assert!(doublets.iter().all(|c| c.members.len() == 2 && c.kind == ClusterKind::Semisimple));
    let triple = &case("qep2").certified.clusters;
    assert_eq!(triple.len(), 1);
    assert_eq!((triple[0].members.len(), triple[0].kind), (3, ClusterKind::Defective));
    assert!((triple[0].mean - 1.0).norm() < 1e-14, "the mean is well conditioned: {}", triple[0].mean);
}

#[test]
fn a_singular_pencil_is_an_error() {
    let refused = solve(&system(&folder().join("qep5")), &mut Counters::default());
    assert_eq!(refused, Err(CertifiedError::SingularPencil { exactly: true }));
}
