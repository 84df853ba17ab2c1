//! The characteristic polynomial against determinants of the whole system, and between instruction sets.

use pulp::Scalar;

use super::super::tests::{GAIN, chain, error, feedback, noise, point, resolvent, whole};
use super::*;
use crate::Gain;

/// Points near the eigenvalues of a structure, with and without each kind of gain.
fn points() -> Vec<Point> {
    let of_row = |(i, row): (usize, nalgebra::DVector<f64>)| {
        let gain = Gain { mu: row[2], slope: 0.02 * row[3], lag: 0.0, decay: 0.0 };
        let gain = match i % 3 {
            0 => Gain { slope: 0.0, ..gain },
            1 => gain,
            _ => Gain { lag: 0.3 * row[4], decay: 2.0 + row[5], ..gain },
        };
        point(&gain, Complex::new(0.3 * row[0], 1.0 + row[1]))
    };
    let rows = noise(19, 6, 3).row_iter().map(|row| row.transpose()).collect::<Vec<_>>();
    rows.into_iter().enumerate().map(of_row).collect()
}

fn bits(values: &[Complex<f64>]) -> Vec<[u64; 2]> {
    values.iter().map(|value| [value.re.to_bits(), value.im.to_bits()]).collect()
}

fn values(resolvent: &Resolvent, points: &[Point]) -> Vec<Complex<f64>> {
    let mut out = vec![Complex::from(f64::NAN); 3];
    characteristic(resolvent, points, &mut Workspace::default(), &mut out);
    out
}

fn on<S: Simd>(simd: S, resolvent: &Resolvent, points: &[Point]) -> Vec<Complex<f64>> {
    let mut out = Vec::new();
    simd.vectorize(ResponsesInLanes {
        resolvent,
        points,
        scratch: &mut Vec::new(),
        results: &mut ResponseOutput::Values(&mut out),
    });
    out
}

#[test]
fn the_polynomial_is_the_determinant_of_the_whole_system() {
    let gains = [
        Gain::default(),
        Gain { mu: -1.3, ..Gain::default() },
        Gain { slope: 70.0, ..Gain::default() },
        Gain { lag: 0.0, ..GAIN },
        GAIN,
    ];
    for n in [1, 4, 7] {
        let structure = chain(n, n as u64);
        for ports in 0..=4 {
            for gain in &gains {
                let error = error(&structure, &feedback(n, ports, 9), gain);
                assert!(error < 1e-10, "{n} degrees of freedom, {ports} ports, {gain:?}: {error:e}");
            }
        }
    }
}

#[test]
fn next_to_an_eigenvalue_of_the_structure_digits_are_lost_and_the_value_is_not() {
    // With two or more ports, large terms next to a pole cancel in the determinant.
    for ports in [1, 2, 3] {
        let (structure, feedback) = (chain(4, 1), feedback(4, ports, 1));
        let resolvent = resolvent(&structure, &feedback).unwrap();
        let gain = Gain { lag: 0.3, decay: 2.0, ..GAIN };
        let of_whole = Gain { lag: 0.3 * resolvent.unit, decay: 2.0 * resolvent.unit, ..gain };
        let whole = whole(&structure, &feedback, &of_whole);
        let size = structure.m.determinant() * resolvent.unit.powi(8);
        for &pole in &resolvent.poles {
            for distance in [1e-3, 1e-5, 1e-7, 1e-9, 0.0] {
                let sigma = pole + Complex::new(distance, 0.0);
                let found = values(&resolvent, &[point(&gain, sigma)])[0];
                let expected = whole.dynamic_stiffness(sigma * resolvent.unit).determinant() / size;
                let error = (found - expected).norm() / expected.norm();
                // A point nearer than that is evaluated at that distance.
                let nearest = AT_POLE.sqrt();
                let moved = if distance < nearest { 1e3 * nearest } else { 0.0 };
                let lost = if ports > 1 { 5e-17 / distance.max(nearest) } else { 0.0 };
                let bound = 1e-12 + moved + lost;
                assert!(error < bound, "{ports} ports, {distance:e} from {pole}: {error:e}");
            }
        }
    }
}

#[test]
fn a_value_depends_neither_on_its_lane_nor_on_its_neighbours() {
    for ports in [1, 2, 3] {
        let resolvent = resolvent(&chain(5, 2), &feedback(5, ports, 2)).unwrap();
        let mut points = points();
        let alone: Vec<_> = points.iter().flat_map(|point| values(&resolvent, std::slice::from_ref(point))).collect();
        assert_eq!(bits(&values(&resolvent, &points)), bits(&alone));
        points.rotate_left(5);
        points[0].mu = f64::NAN;
        points[7].sigma.im = f64::INFINITY;
        let found = values(&resolvent, &points);
        for (k, found) in found.into_iter().enumerate() {
            match k {
                0 | 7 => assert!(!found.is_finite(), "{found}"),
                _ => assert_eq!(bits(&[found]), bits(&alone[(k + 5) % 19..][..1]), "point {k}"),
            }
        }
        assert!(values(&resolvent, &[]).is_empty());
    }
}

#[test]
fn instruction_sets_with_fused_multiply_add_agree_to_the_bit_and_the_others_nearly() {
    let (resolvent, points) = (resolvent(&chain(6, 3), &feedback(6, 3, 3)).unwrap(), points());
    let best = values(&resolvent, &points);
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(avx2) = pulp::x86::V3::try_new() {
            assert_eq!(bits(&on(avx2, &resolvent, &points)), bits(&best));
        }
        if let Some(avx512) = pulp::x86::V4::try_new() {
            assert_eq!(bits(&on(avx512, &resolvent, &points)), bits(&best));
        }
    }
    for (best, portable) in best.iter().zip(on(Scalar, &resolvent, &points)) {
        assert!((best - portable).norm() < 1e-12 * best.norm(), "{best} {portable}");
    }
}

#[test]
fn next_to_a_pole_values_err_by_less_than_the_reserve() {
    // The strength of the feedback and the distance from the pole: the stronger the coupling, the more cancels.
    for (strength, distances) in
        [(0.1, [1e-11, 1e-12, 1e-14, 0.0]), (1.0, [1e-11, 1e-12, 1e-14, 0.0]), (10.0, [1e-11, 1e-12, 1e-14, 0.0])]
    {
        let mut worst = 0.0_f64;
        let gain = Gain { mu: strength * GAIN.mu, slope: strength * GAIN.slope, ..Gain::default() };
        for (ports, seed) in [2, 3, 4].into_iter().flat_map(|ports| (1..200).map(move |seed| (ports, seed))) {
            let (structure, feedback) = (chain(6, seed), feedback(6, ports, seed));
            let (resolvent, whole) = (resolvent(&structure, &feedback).unwrap(), whole(&structure, &feedback, &gain));
            let size = structure.m.determinant() * resolvent.unit.powi(12);
            for (pole, distance) in resolvent.poles.iter().flat_map(|pole| distances.iter().map(move |d| (pole, d))) {
                let sigma = pole + distance;
                let found = values(&resolvent, &[point(&gain, sigma)])[0];
                let expected = whole.dynamic_stiffness(sigma * resolvent.unit).determinant() / size;
                worst = worst.max((found - expected).norm() / expected.norm());
            }
        }
        println!("{strength}: {worst:.1e}");
        assert!(worst > 1e-6 && worst < 0.2, "{strength}: {worst:e}");
    }
}
