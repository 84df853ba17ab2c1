//! A common phase for the shapes of all laws, so that a mode which is the same looks the same.

use num_complex::Complex64;

use super::data::{BodyInMode, LawMode};

/// Factors that bring the eigenvectors of all laws to one phase and scale. The first one gets the phase at which its real
/// part is largest, with the sign that makes its largest component positive; each other the phase at which it is most like
/// the first. The component of largest modulus of each has modulus 1.
pub(super) fn factors(laws: &[LawMode]) -> Vec<Complex64> {
    let Some(first) = laws.first().map(|law| components(&law.bodies)) else { return Vec::new() };
    let square: Complex64 = first.iter().map(|u| u * u).sum();
    let turned = unit(square.sqrt().conj());
    let largest = first.iter().fold(Complex64::ZERO, |a, &b| if b.norm() > a.norm() { b } else { a });
    let turned = if (largest * turned).re < 0.0 { -turned } else { turned };
    let factor = |law: &LawMode| {
        let own = components(&law.bodies);
        let size = own.iter().map(|u| u.norm()).fold(0.0, f64::max);
        let likeness: Complex64 = first.iter().zip(&own).map(|(a, b)| (a * turned).conj() * b).sum();
        if size > 0.0 { unit(likeness.conj()) / size } else { Complex64::ZERO }
    };
    laws.iter().map(factor).collect()
}

fn components(bodies: &[BodyInMode]) -> Vec<Complex64> {
    bodies.iter().flat_map(|body| body.displacement).collect()
}

/// A number of modulus 1 with the same phase; 1 for 0.
fn unit(z: Complex64) -> Complex64 {
    if z.norm() > 0.0 { z / z.norm() } else { Complex64::ONE }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(turned: Complex64) -> LawMode {
        let shape = [Complex64::new(0.5, 0.1), Complex64::new(0.0, -0.9), Complex64::new(-1.0, 0.2)];
        let bodies = vec![BodyInMode { displacement: shape.map(|u| u * turned), ..BodyInMode::default() }];
        LawMode { bodies, ..LawMode::default() }
    }

    #[test]
    fn one_shape_in_any_phase_and_scale_looks_the_same() {
        let laws = [law(Complex64::ONE), law(Complex64::from_polar(3.0, 2.1)), law(Complex64::from_polar(0.1, -0.7))];
        let shapes: Vec<Vec<Complex64>> = laws
            .iter()
            .zip(factors(&laws))
            .map(|(law, factor)| components(&law.bodies).into_iter().map(|u| u * factor).collect())
            .collect();
        for shape in &shapes[1..] {
            assert!(shape.iter().zip(&shapes[0]).all(|(a, b)| (a - b).norm() < 1e-12), "{shape:?}");
        }
        let real: f64 = shapes[0].iter().map(|u| u.re * u.re).sum();
        let turned =
            |angle: f64| -> f64 { shapes[0].iter().map(|u| (u * Complex64::from_polar(1.0, angle)).re.powi(2)).sum() };
        assert!((0..60).all(|k| turned(0.1 * f64::from(k)) <= real + 1e-12));
        assert!(shapes[0][2].re > 0.0);
    }

    #[test]
    fn a_shape_of_zeros_stays_one() {
        let nothing = LawMode { bodies: vec![BodyInMode::default()], ..LawMode::default() };
        assert_eq!(factors(&[nothing]), [Complex64::ZERO]);
    }
}
