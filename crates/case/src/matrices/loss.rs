//! Loss factors of terms: complex stiffness, as dashpots that have it in every mode.

use std::f64::consts::TAU;

use cea::RealModes;
use linsys::{SecondOrder, Term};
use nalgebra::{DMatrix, Schur};
use num_complex::Complex;

use super::FixedDofs;
use super::elsewhere::{Places, on, sum};
use crate::CaseError;
use crate::check::{Check, field};

/// Largest difference of an entry of a symmetric matrix from its mirror image, as a fraction of the largest entry; chosen.
const SYMMETRIC: f64 = 1e-10;
/// Least damping ratio to which an error of the damping is compared: a mode with less has no loss. Chosen: above rounding of eigenvalues.
const NO_LOSS: f64 = 1e-7;
/// Most degrees of freedom with which dashpots are compared with the complex stiffness, by all eigenvalues of both; chosen: seconds.
const MOST_COMPARED: usize = 150;

/// Adds to terms with a loss factor eta dashpots in the place of the complex stiffness `K_t (1 + i eta)`, which holds for `Im lambda > 0` and is no
/// real system: with the modes of the structure at the medians, `phi_i^T M phi_j = delta_ij`,
///
/// ```text
/// C_t = eta M Phi D Phi^T M,   D_ij = phi_i^T K_t phi_j / sqrt(omega_i omega_j)
/// ```
///
/// so that each mode loses what it would. What that is not is said: how far all eigenvalues are from those of the complex stiffness, without
/// friction and with each set of constraints, and what modes lose at other places, as the dashpots stay those of the medians.
///
/// # Errors
/// A loss factor that is negative or not finite, of a term whose stiffness is not symmetric, of a structure that has no real modes.
pub(super) fn add_losses(
    check: &Check<'_>,
    terms: &mut [Term],
    places: &Places,
    losses: &[Option<f64>],
    constraints: &[FixedDofs],
) -> Result<(), CaseError> {
    if losses.iter().all(Option::is_none) {
        return Ok(());
    }
    let order = terms.first().map_or(0, Term::order);
    let coefficients = &places.at_medians[..];
    let (m, k) = (sum(order, |of| &of.m, terms, coefficients), sum(order, |of| &of.k, terms, coefficients));
    let given = sum(order, |of| &of.c, terms, coefficients);
    let modes = RealModes::new(&m, &k);
    let mut dashpots = vec![None; terms.len()];
    for ((term, loss), dashpot) in terms.iter_mut().zip(losses).zip(&mut dashpots) {
        let Some(loss) = *loss else { continue };
        let key = field("terms", &term.name, "loss_factor");
        check.loss_factor(&key, loss)?;
        let SecondOrder { m: own_m, c, k: own, internal } = term.matrices().clone();
        if (&own - own.transpose()).amax() > SYMMETRIC * own.amax() {
            return Err(check.value(&key, loss, "terms of a symmetric stiffness: another one is no spring"));
        }
        let modes = modes.as_ref().map_err(|why| {
            let allowed = format!("brakes with real modes at the medians, and here {why}");
            check.value(&key, loss, &allowed)
        })?;
        let damping = modes.equivalent_dashpots(&own) * loss;
        let matrices = SecondOrder { m: own_m, c: c + &damping, k: own, internal };
        *dashpot = Some(damping);
        *term = Term::new(term.name.clone(), term.family.clone(), matrices).map_err(check.system(&key))?;
    }
    let factors: Vec<f64> = coefficients.iter().zip(losses).map(|(theta, loss)| theta * loss.unwrap_or(0.0)).collect();
    let (c, lost) = (sum(order, |of| &of.c, terms, coefficients), sum(order, |of| &of.k, terms, &factors));
    for set in constraints {
        let free: Vec<usize> = (0..order).filter(|row| !set.fixed.contains(row)).collect();
        let on = |a: &DMatrix<f64>| on(&free, a);
        let real = || eigenvalues(&on(&m), &on(&c), &on(&k).map(Complex::from));
        let lossy = || eigenvalues(&on(&m), &on(&given), &on(&k).zip_map(&on(&lost), Complex::new));
        let words = match free.len() <= MOST_COMPARED {
            false => format!("how near they are is not looked at beyond {MOST_COMPARED} degrees of freedom"),
            true => {
                let here = real().zip(lossy()).map_or(
                    "how near they are is not known, as M is singular or eigenvalues were not found".into(),
                    distances,
                );
                here + &places.elsewhere_in_words((terms, losses), &dashpots, &free)
            }
        };
        check.note(format!(
            "loss factors are dashpots that have them in each mode of the structure at the medians; without friction, constraints {:?}: {words}",
            set.name
        ));
    }
    Ok(())
}

/// Eigenvalues of `lambda^2 M + lambda C + K` with Im lambda > 0; `None` where M is singular or they are not found.
fn eigenvalues(m: &DMatrix<f64>, c: &DMatrix<f64>, k: &DMatrix<Complex<f64>>) -> Option<Vec<Complex<f64>>> {
    let n = m.nrows();
    let inverse = m.clone().try_inverse()?.map(Complex::from);
    let (k, c) = (&inverse * k, &inverse * c.map(Complex::from));
    // In units of the highest frequencies: else rounding of their squares is in all entries of the companion, those of 1 among them.
    let unit = k.camax().sqrt();
    if !(unit.is_finite() && unit > 0.0) {
        return None;
    }
    let mut companion = DMatrix::zeros(2 * n, 2 * n);
    companion.view_mut((0, n), (n, n)).fill_with_identity();
    companion.view_mut((n, 0), (n, n)).copy_from(&(k / Complex::from(-unit * unit)));
    companion.view_mut((n, n), (n, n)).copy_from(&(c / Complex::from(-unit)));
    // Of equal eigenvalues the iteration may stall at the last bits.
    let schur = [1.0, 64.0, 4096.0]
        .into_iter()
        .find_map(|times| Schur::try_new(companion.clone(), times * f64::EPSILON, 200 * n));
    let all = schur?.eigenvalues()?;
    Some(all.iter().map(|lambda| lambda * unit).filter(|lambda| lambda.im > 0.0).collect())
}

/// Words on how far eigenvalues of the first kind are from their neighbours of the second.
fn distances((of_dashpots, exact): (Vec<Complex<f64>>, Vec<Complex<f64>>)) -> String {
    let nearest = |lambda: &Complex<f64>| {
        let found = of_dashpots.iter().min_by(|a, b| (*a - lambda).norm().total_cmp(&(*b - lambda).norm()));
        // What a mode without loss has for growth is rounding.
        let floor = NO_LOSS * lambda.norm();
        found.map(|found| {
            (*lambda, [(found.re - lambda.re).abs() / lambda.re.abs().max(floor), (found.im / lambda.im - 1.0).abs()])
        })
    };
    let pairs: Vec<_> = exact.iter().filter_map(nearest).collect();
    let worst = |of: usize| pairs.iter().max_by(|(_, a), (_, b)| a[of].total_cmp(&b[of]));
    match worst(0).zip(worst(1)) {
        None => "there are no modes".into(),
        Some(((lambda, [growth, _]), (_, [_, frequency]))) => format!(
            "Re lambda is off by up to {:.2e} of itself, at {:.1} Hz, frequencies by up to {frequency:.1e}",
            growth,
            lambda.im / TAU
        ),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use nalgebra::{DMatrix, dmatrix};
    use num_complex::Complex;

    use super::eigenvalues;
    use crate::{CaseFile, MatricesCase};

    fn case(terms: &str) -> Result<MatricesCase, String> {
        let head = "[study]\nname = \"losses\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\n";
        match CaseFile::parse(Path::new("loss.toml"), format!("{head}{terms}")).map_err(|error| error.to_string())? {
            CaseFile::Matrices(case) => Ok(*case),
            _ => Err("another kind".into()),
        }
    }

    fn matrices(case: &MatricesCase) -> [DMatrix<f64>; 3] {
        let system = case.system.assemble(&case.operating_point(&case.medians()).unwrap()).unwrap();
        [system.m, system.c, system.k]
    }

    /// `lambda^2 m + k (1 + i eta) = 0`, so `lambda = i omega sqrt(1 + i eta)`, on the upper half plane.
    #[test]
    fn one_degree_of_freedom_is_the_closed_form() {
        let (m, k, eta) = (2.0, 800.0, 0.2);
        let omega = 20.0;
        let exact = Complex::new(0.0, omega) * Complex::new(1.0, eta).sqrt();
        let found = eigenvalues(&dmatrix![m], &dmatrix![0.0], &dmatrix![Complex::new(k, eta * k)]).unwrap();
        assert!(found.len() == 1 && (found[0] - exact).norm() < 1e-12 * omega, "{found:?} {exact}");
        let case =
            case("[[terms]]\nname = \"shim\"\nmass = [[2.0]]\nstiffness = [[800.0]]\nloss_factor = 0.2\n").unwrap();
        let [_, c, _] = matrices(&case);
        assert!((c[(0, 0)] - eta * (k * m).sqrt()).abs() < 1e-12);
        // The dashpot's growth is - eta omega / 2; that of the complex stiffness departs from it by eta^2 / 8.
        let off = (-eta * omega / 2.0 / exact.re - 1.0).abs();
        let note = case.header.notes.iter().find(|note| note.contains("loss factors")).unwrap();
        assert!(note.contains(&format!("off by up to {off:.2e} of itself")), "{note} {off:e}");
    }

    /// Of one loss factor of all stiffness the departure is that of the closed form, however far apart frequencies are.
    #[test]
    fn a_chain_of_soft_and_stiff_springs_is_the_closed_form() {
        let (n, eta) = (24, 0.02_f64);
        let spring = |i: usize| 10f64.powf(4.0 + 7.0 * i as f64 / n as f64);
        let entry = |i: usize, j: usize| match i.abs_diff(j) {
            0 => spring(i) + spring(i + 1),
            1 => -spring(i.max(j)),
            _ => 0.0,
        };
        let row = |i: usize| format!("{:?}", (0..n).map(|j| entry(i, j)).collect::<Vec<_>>());
        let mass = |i: usize| format!("{:?}", (0..n).map(|j| if i == j { 0.01 } else { 0.0 }).collect::<Vec<_>>());
        let rows = |of: &dyn Fn(usize) -> String| (0..n).map(of).collect::<Vec<_>>().join(", ");
        let text = format!(
            "[[terms]]\nname = \"chain\"\nmass = [{}]\nstiffness = [{}]\nloss_factor = {eta}\n",
            rows(&mass),
            rows(&row)
        );
        let off = (-eta / 2.0 / (Complex::<f64>::i() * Complex::new(1.0, eta).sqrt()).re - 1.0).abs();
        let case = case(&text).unwrap();
        let note = case.header.notes.iter().find(|note| note.contains("loss factors")).unwrap();
        assert!(note.contains(&format!("off by up to {off:.2e} of itself")), "{note} {off:e}");
    }

    /// Where all stiffness has one loss factor each mode loses eta omega / 2 whatever its frequency, and a term of two coefficients takes its share.
    #[test]
    fn each_mode_has_the_loss_of_its_strain_energy() {
        let springs = "[[terms]]\nname = \"chain\"\nmass = [[1.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 2.0]]\n\
                       stiffness = [[9.0e3, -4.0e3, 0.0], [-4.0e3, 6.0e3, -2.0e3], [0.0, -2.0e3, 8.0e3]]\nloss_factor = 0.04\n";
        let whole = case(springs).unwrap();
        let [m, c, k] = matrices(&whole);
        let modes = cea::RealModes::new(&m, &k).unwrap();
        let modal = modes.shapes.tr_mul(&(&c * &modes.shapes));
        for (at, square) in modes.omega_squared.iter().enumerate() {
            let omega = square.sqrt();
            for other in 0..3 {
                let expected = if other == at { 0.04 * omega } else { 0.0 };
                assert!((modal[(at, other)] - expected).abs() < 1e-10 * omega, "{modal}");
            }
        }
        // Half of it lossy: by first order each mode loses by the part of its strain energy that is there.
        let lining = "[[terms]]\nname = \"lining\"\nstiffness = [[2.0e3, -2.0e3, 0.0], [-2.0e3, 2.0e3, 0.0], [0.0, 0.0, 0.0]]\n\
                      coefficient = 2\nloss_factor = 0.1\n";
        let part = case(&format!("{}{lining}", springs.replace("loss_factor = 0.04\n", ""))).unwrap();
        let [m, c, k] = matrices(&part);
        let modes = cea::RealModes::new(&m, &k).unwrap();
        let lossy = dmatrix![4.0e3, -4.0e3, 0.0; -4.0e3, 4.0e3, 0.0; 0.0, 0.0, 0.0];
        for (shape, square) in modes.shapes.column_iter().zip(&modes.omega_squared) {
            let expected = 0.1 * shape.dot(&(&lossy * shape)) / square.sqrt();
            assert!((shape.dot(&(&c * shape)) - expected).abs() < 1e-10 * square.sqrt());
        }
    }

    /// Rings of equal masses have equal frequencies, and a uniform mode that no spring between them strains.
    #[test]
    fn rings_of_equal_masses_are_compared() {
        for n in [3, 6, 20] {
            let neighbour = |i: usize, j: usize| (i + 1) % n == j || (j + 1) % n == i;
            let rows = |of: &dyn Fn(usize, usize) -> f64| {
                format!("{:?}", (0..n).map(|i| (0..n).map(|j| of(i, j)).collect::<Vec<_>>()).collect::<Vec<_>>())
            };
            let ground = rows(&|i, j| if i == j { 1e5 } else { 0.0 });
            let ring = rows(&|i, j| {
                if i == j {
                    8e4
                } else if neighbour(i, j) {
                    -4e4
                } else {
                    0.0
                }
            });
            let mass = rows(&|i, j| f64::from(u8::from(i == j)));
            let text = format!(
                "[[terms]]\nname = \"ground\"\nmass = {mass}\nstiffness = {ground}\n[[terms]]\nname = \"ring\"\nstiffness = {ring}\nloss_factor = 0.02\n"
            );
            let case = case(&text).unwrap();
            let note = case.header.notes.iter().find(|note| note.contains("loss factors")).unwrap();
            let off = note.split("off by up to ").nth(1).unwrap().split(' ').next().unwrap();
            assert!(off.parse::<f64>().unwrap() < 1e-3, "{n}: {note}");
        }
    }

    /// Dashpots of the median, of one mass on a lossy spring k that is drawn, lose eta k / (omega_0 m) where eta k / (omega m) is right: off by
    /// sqrt(k / k_0) - 1.
    #[test]
    fn what_draws_lose_is_told() {
        let drawn = "[parameters.k]\ndistribution = \"uniform\"\nfrom = 0.5\nto = 1.5\n";
        let spring = "[[terms]]\nname = \"mass\"\nmass = [[2.0]]\n[[terms]]\nname = \"shim\"\ncoefficient = \"k\"\nstiffness = [[800.0]]\nloss_factor = 0.1\n";
        let case = case(&format!("{drawn}{spring}")).unwrap();
        let note = case.header.notes.iter().find(|note| note.contains("loss factors")).unwrap();
        let off = (1.0 - 0.55_f64.sqrt()).max(1.45_f64.sqrt() - 1.0);
        assert!(note.contains(&format!("is off by up to {off:.1e} of itself (k = 0.5500)")), "{note} {off}");
    }

    #[test]
    fn faults_are_one_line() {
        for (terms, expected) in [
            (
                "mass = [[2.0]]\nstiffness = [[800.0]]\nloss_factor = -0.2\n",
                "terms \"shim\".loss_factor = -0.2; allowed: a finite number >= 0",
            ),
            (
                "mass = [[1.0, 0.0], [0.0, 1.0]]\nstiffness = [[2.0, 1.0], [0.5, 2.0]]\nloss_factor = 0.1\n",
                "terms \"shim\".loss_factor = 0.1; allowed: terms of a symmetric stiffness",
            ),
            (
                "mass = [[-1.0]]\nstiffness = [[2.0]]\nloss_factor = 0.1\n",
                "terms \"shim\".loss_factor = 0.1; allowed: brakes with real modes at the medians",
            ),
        ] {
            let error = case(&format!("[[terms]]\nname = \"shim\"\n{terms}")).unwrap_err();
            assert!(error.contains(expected) && !error.contains('\n'), "{error}");
        }
    }
}
