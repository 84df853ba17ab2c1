//! Problems of NLEVP and others, from files: M.mtx, C.mtx, K.mtx and eigs.csv with the eigenvalues to 25 digits (Betcke,
//! Higham, Mehrmann, Schröder and Tisseur, ACM Trans. Math. Softw. 39, 2013).

use std::path::{Path, PathBuf};

use cea::certified;
use formats::{Options, read_market};
use linsys::SecondOrder;
use num_complex::Complex;

use crate::ValidationError;
use crate::judge::GENERAL;
use crate::library_baselines::judge_libraries;
use crate::problem::{ReferenceProblem, RouteOutcome};
use crate::refine::RefinedEigenvalue;
use crate::routes::nearest_pairs;

/// Solves and judges every problem in the folders of `folder`, by name.
///
/// # Errors
/// A file that cannot be read.
pub fn judge_folder(folder: &Path) -> Result<Vec<RouteOutcome>, ValidationError> {
    let entries =
        std::fs::read_dir(folder).map_err(|source| ValidationError::Read { path: folder.to_owned(), source })?;
    let mut cases: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|p| p.is_dir()).collect();
    cases.sort();
    let mut results = Vec::new();
    for case in &cases {
        results.extend(judge(case)?);
    }
    Ok(results)
}

fn judge(folder: &Path) -> Result<Vec<RouteOutcome>, ValidationError> {
    let case = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let matrix = |name: &str| {
        let path = folder.join(name);
        let text = std::fs::read(&path).map_err(|source| ValidationError::Read { path: path.clone(), source })?;
        let matrix = read_market(&text, Options::default());
        let matrix = matrix.map_err(|source| ValidationError::Matrix { path, source: Box::new(source) })?;
        Ok::<_, ValidationError>(matrix.to_dense())
    };
    let system = SecondOrder::new(matrix("M.mtx")?, matrix("C.mtx")?, matrix("K.mtx")?).map_err(cea::CeaError::from)?;
    let mut counters = certified::Counters::default();
    let solved = certified::solve(&system, &mut counters).and_then(|spectrum| {
        certified::certify(&system, &spectrum, &mut counters).map(|certified| (spectrum, certified))
    });
    let (spectrum, certified) = match solved {
        Ok(solved) => solved,
        Err(error) => return Ok(vec![RouteOutcome::Refused { case, route: GENERAL, reason: error.to_string() }]),
    };
    let (wanted, infinite) = reference(&folder.join("eigs.csv"))?;
    let found: Vec<_> = certified.eigenvalues.iter().map(|c| (c.lambda, c.verdict)).collect();
    let lambdas: Vec<_> = found.iter().map(|f| f.0).collect();
    let condition = |at: Option<usize>| at.map_or(f64::NAN, |at| certified.eigenvalues[at].condition);
    let refined =
        |(&lambda, at): (&Complex<f64>, Option<usize>)| RefinedEigenvalue { lambda, condition: condition(at) };
    let reference = wanted.iter().zip(nearest_pairs(&wanted, &lambdas)).map(refined).collect();
    let case = ReferenceProblem { name: case, system, reference };
    let mut judged = case.compare(GENERAL, &found);
    // The backward error of the certificate, which uses its own vector and not the best one.
    judged.max_backward_error = certified.eigenvalues.iter().map(|c| c.backward_error).fold(0.0, f64::max);
    if infinite != spectrum.infinite || wanted.len() != found.len() {
        judged.max_error = f64::INFINITY;
    }
    let mut results = vec![RouteOutcome::Judged(judged)];
    results.extend(judge_libraries(&case));
    Ok(results)
}

/// The finite eigenvalues and the number of infinite ones.
fn reference(path: &Path) -> Result<(Vec<Complex<f64>>, usize), ValidationError> {
    let bad = |what: String| ValidationError::Read { path: path.to_owned(), source: std::io::Error::other(what) };
    let text =
        std::fs::read_to_string(path).map_err(|source| ValidationError::Read { path: path.to_owned(), source })?;
    let (mut finite, mut infinite) = (Vec::new(), 0);
    for line in text.lines().skip(1) {
        let mut fields = line.split(',');
        if fields.next() == Some("infinite") {
            infinite += 1;
            continue;
        }
        let mut number = || fields.next().and_then(|x| x.parse().ok()).ok_or_else(|| bad(format!("{line}: no number")));
        finite.push(Complex::new(number()?, number()?));
    }
    Ok((finite, infinite))
}
