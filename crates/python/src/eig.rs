//! Eigenvalues of `lambda^2 M + lambda C + K`, and the health of its matrices.

use brakes::case::held::{HeldRows, Tied};
use cea::certified::{ClusterKind, Counters, Verdict, certify, solve};
use cea::{BatchSolver, CeaError, EigenSolver, Workspace};
use formats::{Entry, Kind};
use linsys::SecondOrder;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use numpy::ndarray::{Array2, Array3, Axis};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2, PyReadonlyArray3, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use sparse::health::MatrixHealth;
use sparse::{Count, Rectangle, SparseSecondOrder, eigenpairs_in};
use squeal::memory;
use squeal_cli::{Error, largest_order, search_options};

use crate::away::{Ends, away};
use crate::errors::argument;
use crate::matrices::{Columns, dense, sparse};

/// Most degrees of freedom of a system all of whose eigenvalues are certified; chosen: it takes some minutes.
const LARGEST_ORDER: usize = 1000;
/// Number of systems of a stack that a thread takes together; chosen.
const TOGETHER: usize = 32;
/// Steps of what is told of the progress of a search.
const PERCENT: f64 = 100.0;

fn verdict(of: Verdict) -> i8 {
    match of {
        Verdict::Stable => 0,
        Verdict::Unstable => 1,
        Verdict::Marginal { .. } => 2,
        Verdict::Undecided { .. } => 3,
    }
}

/// Knowledge of one eigenvalue.
struct Known<'v> {
    lambda: Complex<f64>,
    /// Bound, backward error, condition number.
    errors: [f64; 3],
    verdict: Verdict,
    on_border: bool,
    right: &'v DVector<Complex<f64>>,
    left: &'v DVector<Complex<f64>>,
}

fn as_dict<'py>(py: Python<'py>, order: usize, known: &[Known<'_>]) -> PyResult<Bound<'py, PyDict>> {
    let of = PyDict::new(py);
    let vectors = |of: &dyn Fn(&Known<'_>, usize) -> Complex<f64>| -> Bound<'py, PyArray2<Complex<f64>>> {
        DMatrix::from_fn(order, known.len(), |row, column| of(&known[column], row)).to_pyarray(py)
    };
    let errors = |at: usize| known.iter().map(|e| e.errors[at]).collect::<Vec<_>>().into_pyarray(py);
    of.set_item("eigenvalues", known.iter().map(|e| e.lambda).collect::<Vec<_>>().into_pyarray(py))?;
    of.set_item("bounds", errors(0))?;
    of.set_item("backward_errors", errors(1))?;
    of.set_item("conditions", errors(2))?;
    of.set_item("verdicts", known.iter().map(|e| verdict(e.verdict)).collect::<Vec<_>>().into_pyarray(py))?;
    of.set_item("on_border", known.iter().map(|e| e.on_border).collect::<Vec<_>>().into_pyarray(py))?;
    of.set_item("right", vectors(&|e, row| e.right[row]))?;
    of.set_item("left", vectors(&|e, row| e.left[row]))?;
    Ok(of)
}

/// All eigenvalues, each with a bound, by dense matrices.
#[pyfunction]
pub(crate) fn eig<'py>(
    py: Python<'py>,
    m: PyReadonlyArray2<'py, f64>,
    c: PyReadonlyArray2<'py, f64>,
    k: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let [m, c, k] = [&m, &c, &k].map(dense);
    let order = m.nrows();
    if order > LARGEST_ORDER {
        let allowed = format!("at most {LARGEST_ORDER} degrees of freedom without `box` or `band_hz`");
        return Err(argument(py, "M", &format!("a matrix of order {order}"), &allowed));
    }
    let (spectrum, certified) = away(py, Ends::LeftBehind, None, move |_| {
        let (system, mut counters) = (SecondOrder::new(m, c, k)?, Counters::default());
        let spectrum = solve(&system, &mut counters).map_err(CeaError::from)?;
        let certified = certify(&system, &spectrum, &mut counters).map_err(CeaError::from)?;
        Ok((spectrum, certified))
    })?;
    let known: Vec<Known<'_>> = certified
        .eigenvalues
        .iter()
        .map(|e| Known {
            lambda: e.lambda,
            errors: [e.bound, e.backward_error, e.condition],
            verdict: e.verdict,
            on_border: false,
            right: &e.right,
            left: &e.left,
        })
        .collect();
    let of = as_dict(py, order, &known)?;
    of.set_item("infinite", spectrum.infinite)?;
    of.set_item("zeros", spectrum.zeros)?;
    of.set_item("route", spectrum.route.to_string())?;
    let clusters = certified.clusters.iter().map(|cluster| {
        let kind = match cluster.kind {
            ClusterKind::Semisimple => "semisimple",
            ClusterKind::Defective => "defective",
            ClusterKind::NearlyDefective => "nearly-defective",
        };
        (kind, cluster.members.clone(), cluster.mean, cluster.spread)
    });
    of.set_item("clusters", clusters.collect::<Vec<_>>())?;
    Ok(of)
}

/// Rows, from 0, that are held by entries huge against all others: the others have no digits left beside them.
#[pyfunction]
pub(crate) fn held<'py>(py: Python<'py>, m: Columns<'py>, c: Columns<'py>, k: Columns<'py>) -> PyResult<Vec<usize>> {
    let mut held = HeldRows::new(m.0);
    for (name, kind, columns) in [("M", Kind::Mass, &m), ("C", Kind::Damping, &c), ("K", Kind::Stiffness, &k)] {
        let matrix = sparse(py, name, columns)?;
        let entry =
            |(row, column, &value): (usize, usize, &f64)| Entry { row: row as u32, column: column as u32, value };
        let tied = |tied: Tied| argument(py, name, "a matrix with a huge entry", &tied.to_string());
        py.detach(|| held.add(kind, matrix.triplet_iter().map(entry))).map_err(tied)?;
    }
    Ok(held.rows())
}

/// The eigenvalues in a rectangle, by sparse matrices: re from, re to, im from, im to, rad/s.
#[pyfunction]
pub(crate) fn eig_in_box<'py>(
    py: Python<'py>,
    m: Columns<'py>,
    c: Columns<'py>,
    k: Columns<'py>,
    borders: [f64; 4],
    is_counted: bool,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let [re0, re1, im0, im1] = borders;
    let rectangle = Rectangle { re: [re0, re1], im: [im0, im1] };
    let (order, most) = (m.0, largest_order(memory::of_machine()));
    if order > most {
        let allowed = format!("at most {most} degrees of freedom, by the memory there is");
        return Err(argument(py, "M", &format!("a matrix of order {order}"), &allowed));
    }
    let (m, c, k) = (sparse(py, "M", &m)?, sparse(py, "C", &c)?, sparse(py, "K", &k)?);
    let found = away(py, Ends::LeftBehind, progress.as_ref(), move |watch| {
        use squeal_cli::bar::Stages;
        let system = SparseSecondOrder::new(m, c, k)?;
        let (told, mut before) = (watch.stage("% of the rectangle"), 0);
        told.begin(PERCENT as u64, 0);
        let options = search_options(is_counted, memory::of_machine());
        Ok(eigenpairs_in(&system, &rectangle, &options, &mut |progress| {
            let covered = (progress.covered * PERCENT) as u64;
            told.advance(covered.saturating_sub(before));
            before = covered.max(before);
        })?)
    })?;
    let known: Vec<Known<'_>> = found
        .pairs
        .iter()
        .map(|e| Known {
            lambda: e.lambda,
            errors: [e.bound, e.backward_error, e.condition],
            verdict: e.verdict,
            on_border: e.on_border,
            right: &e.right,
            left: &e.left,
        })
        .collect();
    let of = as_dict(py, order, &known)?;
    of.set_item("route", if found.is_certified { "certified" } else { "sparse" })?;
    let discs = found.discs.iter().map(|disc| (disc.centre, disc.radius, disc.eigenvalues));
    of.set_item("discs", discs.collect::<Vec<_>>())?;
    of.set_item(
        "counted",
        match found.count {
            Count::Argument { .. } => "argument-principle",
            Count::SecondBlock => "second-block",
            Count::Unclear => "not",
        },
    )?;
    of.set_item("factorisations", found.counters.factorisations)?;
    of.set_item("solves", found.counters.solves)?;
    Ok(of)
}

/// Eigenvalues, a row for each system, the number of systems without them, and the first complaint.
type Stack<'py> = (Bound<'py, PyArray2<Complex<f64>>>, u64, Option<String>);

/// The eigenvalues of a stack of systems on all cores, a row for each; NaN where one has none. The first complaint beside them.
#[pyfunction]
pub(crate) fn eigvals<'py>(
    py: Python<'py>,
    m: PyReadonlyArray3<'py, f64>,
    c: PyReadonlyArray3<'py, f64>,
    k: PyReadonlyArray3<'py, f64>,
    threads: Option<usize>,
) -> PyResult<Stack<'py>> {
    let [m, c, k] = [&m, &c, &k].map(|array| array.as_array().to_owned());
    let (values, failed, first) = away(py, Ends::LeftBehind, None, move |_| stack(&m, &c, &k, threads))?;
    Ok((values.into_pyarray(py), failed, first))
}

/// Eigenvalues of a stack, the number of systems without them, and the first complaint.
type OfStack = (Array2<Complex<f64>>, u64, Option<String>);

fn stack(m: &Array3<f64>, c: &Array3<f64>, k: &Array3<f64>, threads: Option<usize>) -> Result<OfStack, Error> {
    let (count, order) = (m.shape()[0], m.shape()[1]);
    let matrix = |of: &Array3<f64>, at: usize| {
        let of = of.index_axis(Axis(0), at);
        DMatrix::from_fn(order, order, |row, column| of[(row, column)])
    };
    let systems = (0..count)
        .map(|at| SecondOrder::new(matrix(m, at), matrix(c, at), matrix(k, at)))
        .collect::<Result<Vec<_>, _>>()?;
    let of_some = |systems: &[SecondOrder]| {
        let mut spectra = Vec::with_capacity(systems.len());
        BatchSolver.eigenvalues_of_all(systems, &mut Workspace::default(), &mut spectra);
        spectra
    };
    let spectra: Vec<_> =
        squeal::workers(threads)?.install(|| systems.par_chunks(TOGETHER).flat_map_iter(of_some).collect());
    let nan = Complex::new(f64::NAN, f64::NAN);
    let (mut values, mut failed, mut first) = (Array2::from_elem((count, 2 * order), nan), 0, None);
    for (mut row, spectrum) in values.rows_mut().into_iter().zip(spectra) {
        match spectrum {
            Ok(spectrum) => row.iter_mut().zip(spectrum.eigenvalues).for_each(|(to, from)| *to = from),
            Err(error) => {
                failed += 1;
                first.get_or_insert(error.to_string());
            }
        }
    }
    Ok((values, failed, first))
}

/// Health of M, C and K, a dict each.
#[pyfunction]
pub(crate) fn check<'py>(
    py: Python<'py>,
    m: Columns<'py>,
    c: Columns<'py>,
    k: Columns<'py>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let all = [sparse(py, "M", &m)?, sparse(py, "C", &c)?, sparse(py, "K", &k)?];
    let found: Vec<MatrixHealth> =
        away(py, Ends::LeftBehind, None, move |_| all.iter().map(|matrix| Ok(MatrixHealth::of(matrix)?)).collect())?;
    let as_dict = |health: &MatrixHealth| {
        let of = PyDict::new(py);
        of.set_item("entries", health.entries)?;
        of.set_item("asymmetry", health.asymmetry)?;
        of.set_item(
            "empty_rows",
            health.empty_rows.iter().map(|&row| row as i64).collect::<Vec<_>>().into_pyarray(py),
        )?;
        of.set_item("signs", health.signs.map(|signs| (signs.negative, signs.null, signs.positive)))?;
        of.set_item("smallest", health.smallest)?;
        let moved: Vec<i64> = health.null_rows.iter().map(|(row, _)| *row as i64).collect();
        let moved: Bound<'py, PyArray1<i64>> = moved.into_pyarray(py);
        of.set_item("null_rows", moved)?;
        Ok(of)
    };
    found.iter().map(as_dict).collect()
}
