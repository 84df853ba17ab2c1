//! Viscoelastic terms: the directions in which the stiffness of each acts, each a channel of each of its branches.

use linsys::Term;
use nalgebra::{DMatrix, DVector};

use crate::CaseError;
use crate::check::{Check, field};
use crate::expression::formulas::Formulas;
use crate::relaxing::{BranchTable, Relaxing};

/// Largest rest of a matrix that is nothing but rounding, in roundings of its diagonal for each of its rows; chosen: with more, soft springs beside stiff ones
/// are taken for nothing; with less, rounding makes directions, which are as soft.
const ROUNDINGS: f64 = 4.0;
/// Largest asymmetry and largest indefinite rest of a matrix that is taken, as a fraction of its diagonal; chosen: files print ten digits at least.
const INDEFINITE: f64 = 1e-10;

/// The branches of terms, and a channel for each direction of each of them.
///
/// # Errors
/// A viscoelastic term whose stiffness is not symmetric positive semi-definite, loss factors in the same case; an expression that cannot be read.
pub(super) fn branches_of_terms(
    check: &Check<'_>,
    formulas: &mut Formulas<'_>,
    terms: &[Term],
    losses: &[Option<f64>],
    given: Vec<Vec<BranchTable>>,
) -> Result<Relaxing, CaseError> {
    if losses.iter().any(Option::is_some) && given.iter().any(|tables| !tables.is_empty()) {
        // The dashpots of a loss factor would be made for modes of the relaxed stiffness.
        let allowed = "loss_factor or viscoelastic in a case, not both";
        return Err(check.value("terms", "loss_factor beside viscoelastic", allowed));
    }
    let mut relaxing = Relaxing::default();
    for (at, (term, tables)) in terms.iter().zip(given).enumerate() {
        let key = field("terms", &term.name, "viscoelastic");
        if tables.is_empty() {
            continue;
        }
        let Some(directions) = directions(&term.matrices().k) else {
            let allowed = "a symmetric positive semi-definite stiffness, which springs have, and not all 0";
            return Err(check.value(&key, "given for another stiffness", allowed));
        };
        relaxing.add(formulas, &key, (at, &term.name, &term.family), &directions, tables)?;
    }
    Ok(relaxing)
}

/// Vectors b with `K = sum b b^T`, by a Cholesky factorisation with pivots, as entries that are not 0; none where K is not symmetric positive semi-definite,
/// or is 0.
fn directions(stiffness: &DMatrix<f64>) -> Option<Vec<Vec<(usize, f64)>>> {
    let n = stiffness.nrows();
    let scale: Vec<f64> = stiffness.diagonal().iter().map(|k| k.max(0.0).sqrt()).collect();
    let is_below =
        |left: &DMatrix<f64>, i: usize, j: usize, part: f64| left[(i, j)].abs() <= part * scale[i] * scale[j];
    let rounding = ROUNDINGS * n as f64 * f64::EPSILON;
    let skew = stiffness - stiffness.transpose();
    let entries = || (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    if entries().any(|(i, j)| !is_below(&skew, i, j, INDEFINITE)) {
        return None;
    }
    let mut left = stiffness.clone();
    let mut found = Vec::new();
    while let Some(pivot) = (0..n)
        .filter(|&i| left[(i, i)] > 0.0 && !is_below(&left, i, i, rounding))
        .max_by(|&i, &j| (left[(i, i)] / stiffness[(i, i)]).total_cmp(&(left[(j, j)] / stiffness[(j, j)])))
    {
        let root = left[(pivot, pivot)].sqrt();
        let entry = |i| Some(left[(i, pivot)] / root).filter(|value: &f64| value.abs() > rounding * scale[i]);
        let b = DVector::from_fn(n, |i, _| entry(i).unwrap_or(0.0));
        left.ger(-1.0, &b, &b, 1.0);
        found.push(b.iter().copied().enumerate().filter(|(_, value)| *value != 0.0).collect());
    }
    (!found.is_empty() && entries().all(|(i, j)| is_below(&left, i, j, INDEFINITE))).then_some(found)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use cea::{EigenSolver, QrSolver, Workspace};
    use montecarlo::rand::RngExt;
    use montecarlo::stream;
    use nalgebra::Complex;

    use super::*;
    use crate::MatricesCase;

    fn case(terms: &str) -> Result<MatricesCase, String> {
        let text = format!("[study]\nname = \"shim\"\nsamples = 10\nseed = 1\n[brake]\nkind = \"matrices\"\n{terms}");
        MatricesCase::parse(Path::new("shim.toml"), text).map_err(|error| error.to_string())
    }

    fn rows(matrix: &DMatrix<f64>) -> String {
        let rows = (0..matrix.nrows()).map(|i| format!("{:?}", matrix.row(i).iter().collect::<Vec<_>>()));
        format!("[{}]", rows.collect::<Vec<_>>().join(", "))
    }

    fn spectrum(case: &MatricesCase) -> Vec<Complex<f64>> {
        let at = case.operating_point(&case.medians()).unwrap();
        let system = case.system.assemble(&at).unwrap();
        QrSolver.eigenvalues(&system, &mut Workspace::default()).unwrap().eigenvalues
    }

    /// `m s^2 (s + a) + k (s + a + g s) = 0`, a cubic.
    #[test]
    fn a_mass_on_a_viscoelastic_spring_is_the_closed_form() {
        let (m, k, g, a) = (2.0, 800.0, 0.6, 15.0);
        let found = spectrum(
            &case(&format!(
                "[[terms]]\nname = \"shim\"\nmass = [[{m}]]\nstiffness = [[{k}]]\nviscoelastic = [{{ ratio = {g}, rate = {a:?} }}]\n"
            ))
            .unwrap(),
        );
        assert_eq!(found.len(), 3);
        for s in found {
            let residual = m * s * s * (s + a) + k * (s + a + g * s);
            assert!(residual.norm() < 1e-9 * k * (s + a).norm(), "{s} {residual}");
        }
    }

    /// Random structures with a viscoelastic term of a random rank and number of branches: det Q is zero at each eigenvalue, and there are as many
    /// eigenvalues as states.
    #[test]
    fn terms_of_any_rank_are_their_formula() {
        let rng = &mut stream(71, 0);
        for _ in 0..50 {
            let (n, rank, number) =
                (rng.random_range(2..6_usize), rng.random_range(1..4_usize), rng.random_range(1..3_usize));
            let mut random = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0));
            let (own, of_shim, damping) = (random(n, n), random(n, rank.min(n)), random(n, n));
            // Directions of which some are far stiffer than others.
            let scales = DMatrix::from_diagonal(&DVector::from_fn(n, |i, _| 10.0_f64.powi(2 * i as i32 % 7)));
            let own = &scales * (&own * own.transpose() + DMatrix::identity(n, n)) * &scales;
            let shim = &scales * &of_shim * of_shim.transpose() * &scales;
            let shim = (&shim + shim.transpose()) * 0.5;
            let mass = &scales * &scales;
            let damping = &scales * (&damping * damping.transpose() * 0.01) * &scales;
            let branches: Vec<[f64; 2]> =
                (0..number).map(|_| [rng.random_range(0.1..2.0), rng.random_range(0.1..10.0)]).collect();
            let listed: Vec<String> =
                branches.iter().map(|[ratio, rate]| format!("{{ ratio = {ratio:?}, rate = {rate:?} }}")).collect();
            let theta = rng.random_range(0.5..2.0);
            let case = case(&format!(
                "[[terms]]\nname = \"own\"\nmass = {}\nstiffness = {}\n[[terms]]\nname = \"dashpots\"\ndamping = {}\n\
                 [[terms]]\nname = \"shim\"\ncoefficient = {theta:?}\nstiffness = {}\nviscoelastic = [{}]\n",
                rows(&mass),
                rows(&((&own + own.transpose()) * 0.5)),
                rows(&((&damping + damping.transpose()) * 0.5)),
                rows(&shim),
                listed.join(", ")
            ))
            .unwrap();
            let found = spectrum(&case);
            assert_eq!(found.len(), 2 * n + number * rank.min(n));
            for s in found {
                let relaxed = branches.iter().map(|&[ratio, rate]| s * ratio / (s + rate)).sum::<Complex<f64>>() + 1.0;
                let q = DMatrix::from_fn(n, n, |i, j| {
                    let whole =
                        s * s * mass[(i, j)] + s * damping[(i, j)] + own[(i, j)] + relaxed * theta * shim[(i, j)];
                    whole / (scales[(i, i)] * scales[(j, j)])
                });
                let singular = q.singular_values();
                assert!(singular.min() < 1e-8 * singular.max(), "{s} {singular}");
            }
        }
    }

    #[test]
    fn faults_are_one_line_with_the_field() {
        let term = "[[terms]]\nname = \"shim\"\nmass = [[2.0, 0.0], [0.0, 1.0]]\n";
        for (rest, expected) in [
            (
                "stiffness = [[2.0, 1.0], [0.5, 2.0]]\nviscoelastic = [{ ratio = 0.1, rate = 3.0 }]",
                "terms \"shim\".viscoelastic = given for another stiffness; allowed: a symmetric positive semi-definite stiffness",
            ),
            (
                "stiffness = [[2.0, 3.0], [3.0, 2.0]]\nviscoelastic = [{ ratio = 0.1, rate = 3.0 }]",
                "terms \"shim\".viscoelastic = given for another stiffness",
            ),
            (
                "stiffness = [[2.0, 1.0], [1.0, 2.0]]\nviscoelastic = [{ ratio = 0.1, rate = 0.0 }]",
                "terms \"shim\".viscoelastic[1].rate = 0; allowed: a rate > 0, in 1/s",
            ),
            (
                "stiffness = [[2.0, 1.0], [1.0, 2.0]]\nviscoelastic = [{ ratio = -0.1, rate = 2.0 }]",
                "terms \"shim\".viscoelastic[1].ratio = -0.1; allowed: a number >= 0",
            ),
            (
                "stiffness = [[2.0, 1.0], [1.0, 2.0]]\nloss_factor = 0.1\nviscoelastic = [{ ratio = 0.1, rate = 2.0 }]",
                "terms = loss_factor beside viscoelastic; allowed: loss_factor or viscoelastic in a case, not both",
            ),
            (
                "stiffness = [[2.0, 1.0], [1.0, 2.0]]\nviscoelastic = [{ ratio = \"g\", rate = 2.0 }]",
                "terms \"shim\".viscoelastic[1].ratio",
            ),
        ] {
            let refused = case(&format!("{term}{rest}\n")).unwrap_err();
            assert!(refused.contains(expected) && !refused.contains('\n'), "{refused}");
        }
    }

    #[test]
    fn directions_are_springs_where_there_are_springs() {
        // Springs between neighbours of three masses and to ground, one far softer than the others: its direction stays, up to where doubles hold it.
        for soft in [1e-3, 1.0, 1e6] {
            for stiff in [1e-3, 1.0, 1e6].map(|of| of * soft * 1e4) {
                let row = [soft + stiff, -stiff, 0.0, -stiff, 2.0 * stiff, -stiff, 0.0, -stiff, stiff];
                let found = directions(&DMatrix::from_row_slice(3, 3, &row)).unwrap();
                assert_eq!(found.len(), 3, "{soft:e} {stiff:e}");
            }
        }
        let link = |k: f64| DMatrix::from_row_slice(2, 2, &[k, -k, -k, k]);
        assert!([1e-3, 1.0, 0.1 + 0.2, 1e9 / 3.0].iter().all(|k| directions(&link(*k)).unwrap().len() == 1));
        assert!(directions(&DMatrix::zeros(2, 2)).is_none());
    }
}
