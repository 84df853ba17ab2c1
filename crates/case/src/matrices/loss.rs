//! Loss factors of terms: complex stiffness, as dashpots that have it in every mode.

use std::f64::consts::TAU;

use cea::RealModes;
use linsys::Term;
use nalgebra::{DMatrix, Schur};
use num_complex::Complex;

use super::FixedDofs;
use super::elsewhere::{Places, damping, on, sum, with_stiffness};
use crate::CaseError;
use crate::check::{Check, field};

/// Largest difference of an entry of a symmetric matrix from its mirror image, as a fraction of the largest entry; chosen: a stiffness with a larger
/// difference is refused a loss factor.
const SYMMETRIC: f64 = 1e-10;
/// Least damping ratio to which an error of the damping is compared: a mode with less has no loss. Chosen: above rounding of eigenvalues.
const NO_LOSS: f64 = 1e-7;
/// Most degrees of freedom with which dashpots are compared with the complex stiffness, by all eigenvalues of both; chosen: seconds.
const MOST_COMPARED: usize = 150;
/// Largest eigenvalue of a motion without stiffness, as a fraction of the lowest frequency of those that have it; chosen: far above its rounding.
const FAR_BELOW: f64 = 0.1;

/// Gives each set of constraints dashpots for the terms with a loss factor eta, on the rows that it leaves free: in the place of the complex stiffness
/// `K_t (1 + i eta)`, which holds for `Im lambda > 0` and is no real system. With the modes of that structure at the medians, `phi_i^T M phi_j = delta_ij`,
///
/// ```text
/// C_t = eta M Phi D Phi^T M,   D_ij = phi_i^T K_t phi_j / sqrt(omega_i omega_j)
/// ```
///
/// so that each mode loses what it would lose with the complex stiffness. Notes of the case say where this falls short: how far all eigenvalues are from
/// the eigenvalues with the complex stiffness, without friction and with each set of constraints, and what modes lose away from the medians, where the
/// dashpots stay as they are.
///
/// # Errors
/// A loss factor that is negative or not finite, of a term whose stiffness is not symmetric, of a structure that has no real modes.
pub(super) fn add_dashpots(
    check: &Check<'_>,
    constraints: &mut [FixedDofs],
    places: &Places,
    terms: &[Term],
    losses: &[Option<f64>],
) -> Result<(), CaseError> {
    let order = terms.first().map_or(0, Term::order);
    let key = |term: &Term| field("terms", &term.name, "loss_factor");
    let lossy = || terms.iter().zip(losses).filter_map(|(term, loss)| Some((term, (*loss)?)));
    for (term, loss) in lossy() {
        check.loss_factor(&key(term), loss)?;
        let own = &term.matrices().k;
        if (own - own.transpose()).amax() > SYMMETRIC * own.amax() {
            return Err(check.value(&key(term), loss, "terms of a symmetric stiffness: another one is no spring"));
        }
    }
    let coefficients = &places.at_medians[..];
    let (m, k) = (sum(order, |of| &of.m, terms, coefficients), sum(order, |of| &of.k, terms, coefficients));
    let given = sum(order, |of| &of.c, terms, coefficients);
    let factors: Vec<f64> = coefficients.iter().zip(losses).map(|(theta, loss)| theta * loss.unwrap_or(0.0)).collect();
    let lost = sum(order, |of| &of.k, terms, &factors);
    for set in constraints {
        let free: Vec<usize> = (0..order).filter(|row| !set.fixed.contains(row)).collect();
        let [m, given, k, lost] = [&m, &given, &k, &lost].map(|a| on(&free, a));
        let modes = match (RealModes::new(&m, &k), lossy().next()) {
            (Ok(modes), _) => modes,
            (Err(why), Some((term, loss))) => {
                let allowed = format!("brakes with real modes at the medians; with constraints {:?} {why}", set.name);
                return Err(check.value(&key(term), loss, &allowed));
            }
            (Err(_), None) => continue,
        };
        let dashpots: Vec<Option<DMatrix<f64>>> = terms
            .iter()
            .zip(losses)
            .map(|(term, loss)| Some(modes.equivalent_dashpots(&on(&free, &term.matrices().k)) * (*loss)?))
            .collect();
        let words = match free.len() <= MOST_COMPARED {
            false => format!("how near they are is not looked at beyond {MOST_COMPARED} degrees of freedom"),
            true => {
                let c = &given + damping(free.len(), &dashpots, coefficients);
                let real = || eigenvalues(&m, &c, &k.map(Complex::from));
                let lossy = || eigenvalues(&m, &given, &k.zip_map(&lost, Complex::new));
                let here = real().zip(lossy()).map_or(
                    "how near they are is not known, as M is singular or eigenvalues were not found".into(),
                    |pair| distances(pair, lowest(&modes), free.len()),
                );
                here + &places.elsewhere_in_words((terms, losses), &dashpots, &free)
            }
        };
        check.note(format!(
            "loss factors are dashpots that have them in each mode at the medians of the structure that a set of constraints leaves free; \
             without friction, constraints {:?}: {words}",
            set.name
        ));
        set.dashpots = dashpots;
    }
    Ok(())
}

/// Lowest angular frequency of the modes that have stiffness, rad/s; infinite where none has.
fn lowest(modes: &RealModes) -> f64 {
    with_stiffness(modes).map(|(_, square)| square.sqrt()).fold(f64::INFINITY, f64::min)
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

/// Words on how far eigenvalues of the first kind are from their neighbours of the second, of a structure with so many modes, the lowest of which has
/// this frequency. Modes that do not swing have no loss to speak of and are left out: without stiffness, with a negative one, overdamped.
fn distances((of_dashpots, exact): (Vec<Complex<f64>>, Vec<Complex<f64>>), lowest: f64, modes: usize) -> String {
    let nearest = |lambda: &Complex<f64>| {
        let found = of_dashpots.iter().min_by(|a, b| (*a - lambda).norm().total_cmp(&(*b - lambda).norm()));
        // What a mode without loss has for growth is rounding.
        let floor = NO_LOSS * lambda.norm();
        found.map(|found| {
            (*lambda, [(found.re - lambda.re).abs() / lambda.re.abs().max(floor), (found.im / lambda.im - 1.0).abs()])
        })
    };
    let swings = |lambda: &&Complex<f64>| lambda.im > lambda.re.abs() && lambda.norm() > FAR_BELOW * lowest;
    let swinging: Vec<_> = exact.iter().filter(swings).collect();
    let left_out = match modes.saturating_sub(swinging.len()) {
        0 => String::new(),
        1 => "; 1 mode that does not swing is left out".to_owned(),
        several => format!("; {several} modes that do not swing are left out"),
    };
    let pairs: Vec<_> = swinging.into_iter().filter_map(nearest).collect();
    let worst = |of: usize| pairs.iter().max_by(|(_, a), (_, b)| a[of].total_cmp(&b[of]));
    match worst(0).zip(worst(1)) {
        None => format!("there are no modes to compare{left_out}"),
        Some(((lambda, [growth, _]), (_, [_, frequency]))) => format!(
            "Re lambda is off by up to {:.2e} of itself, at {:.1} Hz, frequencies by up to {frequency:.1e}{left_out}",
            growth,
            lambda.im / TAU
        ),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use cea::RealModes;
    use montecarlo::rand::RngExt;
    use montecarlo::stream;
    use nalgebra::{DMatrix, DVector, dmatrix, dvector};
    use num_complex::Complex;

    use super::{eigenvalues, on};
    use crate::{CaseFile, MatricesCase};

    fn case(terms: &str) -> Result<MatricesCase, String> {
        let head = "[study]\nname = \"losses\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\n";
        match CaseFile::parse(Path::new("loss.toml"), format!("{head}{terms}")).map_err(|error| error.to_string())? {
            CaseFile::Matrices(case) => Ok(*case),
            _ => Err("another kind".into()),
        }
    }

    fn matrices(case: &MatricesCase) -> [DMatrix<f64>; 3] {
        matrices_of(case, 0)
    }

    fn matrices_of(case: &MatricesCase, set: usize) -> [DMatrix<f64>; 3] {
        let brake = case.brake(&case.constraints[set]).unwrap();
        let system = brake.system.assemble(&case.operating_point(&case.medians()).unwrap()).unwrap();
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
        // The growth rate with the dashpot is - eta omega / 2; the growth rate with the complex stiffness departs from it by eta^2 / 8.
        let off = (-eta * omega / 2.0 / exact.re - 1.0).abs();
        let note = case.header.notes.iter().find(|note| note.contains("loss factors")).unwrap();
        assert!(note.contains(&format!("off by up to {off:.2e} of itself")), "{note} {off:e}");
    }

    /// With one loss factor of all stiffness the departure is the one of the closed form, however far apart frequencies are.
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

    fn rows(matrix: &DMatrix<f64>) -> String {
        format!("{:?}", matrix.row_iter().map(|row| row.iter().copied().collect::<Vec<_>>()).collect::<Vec<_>>())
    }

    fn note_of<'a>(case: &'a MatricesCase, set: &str) -> &'a str {
        let name = format!("constraints {set:?}: ");
        case.header.notes.iter().find_map(|note| note.split_once(&name)).unwrap().1
    }

    fn number_after(note: &str, words: &str) -> f64 {
        note.split_once(words).unwrap().1.split([' ', ';']).next().unwrap().parse().unwrap()
    }

    /// The eigenvalues `lambda^2 = - eig(M^-1 (K + i H))` above the real axis.
    fn of_complex_stiffness(m: &DMatrix<f64>, k: &DMatrix<f64>, h: &DMatrix<f64>) -> Vec<Complex<f64>> {
        let whole = m.clone().try_inverse().unwrap().map(Complex::from) * k.zip_map(h, Complex::new);
        let squares = nalgebra::Schur::new(whole).eigenvalues().unwrap();
        squares.iter().map(|square| (-square).sqrt()).map(|of| if of.im < 0.0 { -of } else { of }).collect()
    }

    fn of_dashpots(case: &MatricesCase, set: usize) -> Vec<Complex<f64>> {
        let [m, c, k] = matrices_of(case, set);
        eigenvalues(&m, &c, &k.map(Complex::from)).unwrap()
    }

    fn spring_between(n: usize, i: usize, j: usize, k: f64) -> DMatrix<f64> {
        let mut of = DMatrix::zeros(n, n);
        (of[(i, i)], of[(j, j)]) = (k, k);
        (of[(i, j)], of[(j, i)]) = (-k, -k);
        of
    }

    /// Free chains with cross springs, some lossy, each held in two ways: with each set the eigenvalues are those of the complex stiffness of what it
    /// leaves free, to second order in eta, where dashpots of the whole with rows cut out are wrong by first order.
    #[test]
    fn each_set_of_constraints_has_the_dashpots_of_what_it_leaves_free() {
        let rng = &mut stream(11, 0);
        let mut cut = 0.0_f64;
        for _ in 0..40 {
            let n = rng.random_range(4..8_usize);
            let eta = rng.random_range(0.01..0.03);
            let mass = DMatrix::from_diagonal(&DVector::from_fn(n, |_, _| rng.random_range(0.1..2.0)));
            let mut springs = |every: usize| {
                let ends = (0..n - 1).map(|i| (i, i + 1)).chain((0..n - 2).step_by(every).map(|i| (i, i + 2)));
                ends.fold(DMatrix::zeros(n, n), |sum, (i, j)| sum + spring_between(n, i, j, rng.random_range(1e3..1e4)))
            };
            let (lossy, stiff) = (springs(1), springs(2));
            let held = [vec![0], vec![rng.random_range(1..n / 2), n - 1]];
            let sets: Vec<String> = held
                .iter()
                .map(|held| {
                    format!(
                        "[[constraints]]\nname = \"set-{}\"\nfixed = {:?}\n",
                        held.len(),
                        held.iter().map(|dof| (dof + 1).to_string()).collect::<Vec<_>>()
                    )
                })
                .collect();
            let case = case(&format!(
                "[[terms]]\nname = \"rest\"\nmass = {}\nstiffness = {}\n[[terms]]\nname = \"lossy\"\nstiffness = {}\nloss_factor = {eta:?}\n{}",
                rows(&mass),
                rows(&stiff),
                rows(&lossy),
                sets.concat()
            ))
            .unwrap();
            let whole = RealModes::new(&mass, &(&stiff + &lossy)).unwrap().equivalent_dashpots(&lossy) * eta;
            for (set, held) in held.iter().enumerate() {
                let free: Vec<usize> = (0..n).filter(|dof| !held.contains(dof)).collect();
                let [m, k, h] = [&mass, &(&stiff + &lossy), &(&lossy * eta)].map(|a| on(&free, a));
                let exact = of_complex_stiffness(&m, &k, &h);
                let off = |found: &[Complex<f64>]| {
                    let nearest = |exact: &Complex<f64>| {
                        found.iter().map(|of| (of - exact).norm()).fold(f64::INFINITY, f64::min) / exact.norm()
                    };
                    exact.iter().map(nearest).fold(0.0, f64::max)
                };
                let found = off(&of_dashpots(&case, set));
                assert!(found < 0.5 * eta * eta, "{held:?}, eta {eta}: {found:e}");
                cut = cut.max(off(&eigenvalues(&m, &on(&free, &whole), &k.map(Complex::from)).unwrap()) / eta);
                // What is said is of the set.
                let said = number_after(note_of(&case, &format!("set-{}", held.len())), "off by up to ");
                assert!(said < 2.0 * eta, "{said}");
            }
        }
        assert!(cut > 0.1, "the structures show nothing: {cut}");
    }

    /// Hoffmann's two degrees of freedom on a base that one set holds, and a softer one holds from further away: verdict and growth with each.
    #[test]
    fn friction_on_a_held_base_has_the_verdict_of_the_complex_stiffness() {
        let (eta, mu, ratio) = (0.2, 0.762, 4.0 / 3.0);
        let k = dmatrix![2.0, 1.0; 1.0, 2.0];
        // x, y, a base, and a ground behind it.
        let mut all = DMatrix::zeros(6, 6);
        for (at, scale) in [(0, 1.0), (2, 8.0)] {
            for (rows, columns, sign) in [(at, at, 1.0), (at, at + 2, -1.0), (at + 2, at, -1.0), (at + 2, at + 2, 1.0)]
            {
                let mut of = all.view_mut((rows, columns), (2, 2));
                of += &k * (sign * scale);
            }
        }
        let mass = DMatrix::from_diagonal(&dvector![1.0, 1.0, 0.05, 0.05, 0.05, 0.05]);
        let text = format!(
            "[[terms]]\nname = \"m\"\nmass = {}\n[[terms]]\nname = \"springs\"\nstiffness = {}\nloss_factor = {eta}\n\
             [[contacts]]\nname = \"belt\"\nforce = {{ \"1\" = -1.0 }}\nreading = {{ \"2\" = {ratio:?} }}\nmu = {mu}\n\
             [[constraints]]\nname = \"base\"\nfixed = [\"3\", \"4\", \"5\", \"6\"]\n[[constraints]]\nname = \"ground\"\nfixed = [\"5\", \"6\"]\n",
            rows(&mass),
            rows(&all)
        );
        let case = case(&text).unwrap();
        let mut friction = DMatrix::zeros(6, 6);
        friction[(0, 1)] = -mu * ratio;
        let growth = |of: &[Complex<f64>]| of.iter().map(|of| of.re).fold(f64::NEG_INFINITY, f64::max);
        for (set, free) in [&[0, 1][..], &[0, 1, 2, 3]].into_iter().enumerate() {
            let [m, with_friction, h] = [&mass, &(&all + &friction), &(&all * eta)].map(|a| on(free, a));
            let exact = growth(&of_complex_stiffness(&m, &with_friction, &h));
            let found = growth(&of_dashpots(&case, set));
            let modes = RealModes::new(&m, &on(free, &all)).unwrap();
            let own = modes.equivalent_dashpots(&on(free, &all)) * eta;
            let expected = growth(&eigenvalues(&m, &own, &with_friction.map(Complex::from)).unwrap());
            assert!(
                (found - expected).abs() < 1e-9 && (found > 0.0) == (exact > 0.0),
                "{set}: {found} {expected} {exact}"
            );
        }
        let exact = growth(&of_complex_stiffness(&on(&[0, 1], &mass), &on(&[0, 1], &(&all + friction)), &(&k * eta)));
        assert!((exact + 0.0148).abs() < 1e-4, "{exact}");
    }

    /// A free chain has a rigid motion, and one with a negative spring a motion that falls away: neither has a loss to be compared.
    #[test]
    fn motions_without_stiffness_and_those_that_fall_away_are_left_out_of_what_is_said() {
        for (n, k, eta) in [(2, 1e6, 0.1), (3, 1e6, 0.1), (5, 2.0, 0.03), (12, 1e9, 0.2)] {
            let chain = (0..n - 1).fold(DMatrix::zeros(n, n), |sum, i| sum + spring_between(n, i, i + 1, k));
            let term = format!(
                "[[terms]]\nname = \"chain\"\nmass = {}\nstiffness = {}\nloss_factor = {eta}\n",
                rows(&DMatrix::identity(n, n)),
                rows(&chain)
            );
            let free = case(&term).unwrap();
            // As of any structure with one loss factor throughout.
            let off = (-eta / 2.0 / (Complex::<f64>::i() * Complex::new(1.0, eta).sqrt()).re - 1.0).abs();
            let note = note_of(&free, "none");
            assert!(note.contains(&format!("off by up to {off:.2e} of itself")), "{note} {off:e}");
            assert!(note.ends_with("; 1 mode that does not swing is left out"), "{note}");
            let mut ground = DMatrix::zeros(n, n);
            ground[(0, 0)] = -0.2 * k;
            let falling =
                case(&format!("{term}[[terms]]\nname = \"ground\"\nstiffness = {}\n", rows(&ground))).unwrap();
            let note = note_of(&falling, "none");
            assert!(note.ends_with("; 1 mode that does not swing is left out"), "{note}");
            assert!(number_after(note, "off by up to ") < 0.5, "{note}");
            assert!(number_after(note, "frequencies by up to ") < 0.1, "{note}");
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
