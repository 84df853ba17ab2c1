//! `squeal eig`: the certified spectrum of any second-order system from Matrix Market files.

use std::io::Write;
use std::path::{Path, PathBuf};

use cea::certified::{Certified, CertifiedEigenvalue, ClusterKind, GeneralSpectrum, certify, solve};
use cea::{Workspace, damping_ratio, frequency_hz};
use linsys::SecondOrder;
use montecarlo::{Bar, Progress};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::Error;
use crate::input::{LARGEST_MATRIX, parse_matrix, read};
use crate::output::{bytes_in_words, in_words, note};

/// Most degrees of freedom; chosen, so that the longest problem takes less than an hour.
const LARGEST_ORDER: usize = 1000;
/// Processor time, s, by the cube of the degrees of freedom. Measured on an AMD EPYC (Zen 4) with random full matrices: 0.55 s for
/// n = 200, and 0.82 s for n = 120 where the damping is 1e9 times the stiffness and double-double arithmetic does it.
const SECONDS: f64 = 1e-7;
const SECONDS_EXTENDED: f64 = 5e-7;
/// Memory, bytes, by the square of the degrees of freedom. Measured with the same: 13 MB for n = 200.
const BYTES: f64 = 200.0;
/// From how many seconds on a problem is announced; chosen.
const ANNOUNCED: f64 = 1.0;

/// Eigenvalues of lambda^2 M + lambda C + K, each with its backward error, condition number and verdict.
///
/// The matrices may be singular, unsymmetric and in any units. Infinite eigenvalues (of a singular M) are listed but
/// never count as unstable. A verdict "marginal" means that Re lambda is zero to within what rounding the matrices to
/// doubles may move it by; "undecided" that its sign could not be settled. A bound is certified up to rounding and holds for
/// every problem that rounds to the given matrices; JSON has null where there is none, as for eigenvalues without a digit.
#[derive(Debug, Clone, clap::Args)]
pub struct EigArgs {
    /// M, a Matrix Market file (real or integer; coordinate or array)
    #[arg(long, value_name = "M.mtx")]
    pub mass: PathBuf,
    /// C, likewise; zero where it is left out
    #[arg(long, value_name = "C.mtx")]
    pub damping: Option<PathBuf>,
    /// K, likewise
    #[arg(long, value_name = "K.mtx")]
    pub stiffness: PathBuf,
    /// Add the right and left eigenvectors, unit 2-norm
    #[arg(long)]
    pub vectors: bool,
    /// Write JSON, numbers to 17 digits, in place of a table
    #[arg(long)]
    pub json: bool,
}

impl EigArgs {
    /// Reads the matrices, solves, certifies and writes to `out`, in one piece.
    ///
    /// # Errors
    /// A file that is no matrix, shapes that differ, a singular pencil, no convergence, or a failure to write.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let system = read_system(self)?;
        let mut work = Workspace::default();
        let progress = Bar::of("steps (eigenvalues, bounds)");
        let seconds = announce(system.order());
        if seconds > ANNOUNCED {
            progress.begin(2, 0);
        }
        let spectrum = solve(&system, &mut work)?;
        progress.advance(1);
        let certified = certify(&system, &spectrum, &mut work)?;
        progress.end();
        let text = if self.json {
            json(&spectrum, &certified, self.vectors)
        } else {
            table(&spectrum, &certified, self.vectors)
        };
        out.write_all(text.as_bytes()).map_err(Error::StandardOutput)
    }
}

/// Says beforehand how long a problem of many degrees of freedom takes, and how much memory. Seconds, roughly.
pub(super) fn announce(order: usize) -> f64 {
    let n = order as f64;
    let seconds = SECONDS * n.powi(3);
    if seconds > ANNOUNCED {
        let (time, most) = (in_words(seconds), in_words(SECONDS_EXTENDED * n.powi(3)));
        let memory = bytes_in_words(BYTES * n * n);
        note(&format!(
            "{order} degrees of freedom: roughly {time}, {most} where a double has too few digits; {memory}"
        ));
    }
    seconds
}

fn read_system(args: &EigArgs) -> Result<SecondOrder, Error> {
    let m = read_matrix(&args.mass)?;
    let order = m.nrows();
    if order > LARGEST_ORDER {
        let (path, rows, columns) = (args.mass.clone(), order, m.ncols());
        return Err(Error::MatrixTooLarge { path, name: "mass", rows, columns, most: LARGEST_ORDER });
    }
    let m = of_order(order, &args.mass, "mass", m, "a square matrix")?;
    let c = match &args.damping {
        Some(path) => of_order(order, path, "damping", read_matrix(path)?, "like the mass matrix")?,
        None => DMatrix::zeros(order, order),
    };
    let k = of_order(order, &args.stiffness, "stiffness", read_matrix(&args.stiffness)?, "like the mass matrix")?;
    SecondOrder::new(m, c, k).map_err(|e| Error::Cea(e.into()))
}

/// A matrix, refused if it is not `order` x `order`.
fn of_order(
    order: usize,
    path: &Path,
    name: &'static str,
    matrix: DMatrix<f64>,
    reason: &'static str,
) -> Result<DMatrix<f64>, Error> {
    if matrix.shape() == (order, order) {
        return Ok(matrix);
    }
    let (rows, columns) = matrix.shape();
    Err(Error::MatrixShape { path: path.to_owned(), name, rows, columns, order, reason })
}

fn read_matrix(path: &Path) -> Result<DMatrix<f64>, Error> {
    let bytes = read(path, LARGEST_MATRIX).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    let matrix = parse_matrix(&bytes).map_err(|source| Error::Matrix { path: path.to_owned(), source })?;
    Ok(matrix.to_dense())
}

fn kind(kind: ClusterKind) -> &'static str {
    match kind {
        ClusterKind::Semisimple => "semisimple",
        ClusterKind::Defective => "defective",
        ClusterKind::NearlyDefective => "nearly-defective",
    }
}

/// 17 significant digits; null where there is no finite number.
fn number(x: f64) -> String {
    if x.is_finite() { format!("{x:.16e}") } else { "null".to_owned() }
}

fn list<T>(items: impl IntoIterator<Item = T>, item: impl Fn(T) -> String) -> String {
    items.into_iter().map(item).collect::<Vec<_>>().join(", ")
}

fn vector_json(v: &DVector<Complex<f64>>) -> String {
    list(v.iter(), |z| format!("[{}, {}]", number(z.re), number(z.im)))
}

fn finite_json(e: &CertifiedEigenvalue, vectors: bool) -> String {
    let l = e.lambda;
    let mut text = format!(
        "    {{\"kind\": \"finite\", \"re\": {}, \"im\": {}, \"frequency_hz\": {}, \"damping_ratio\": {}, \
         \"backward_error\": {}, \"condition\": {}, \"bound\": {}, \"verdict\": \"{}\"",
        number(l.re),
        number(l.im),
        number(frequency_hz(l)),
        number(damping_ratio(l)),
        number(e.backward_error),
        number(e.condition),
        number(e.bound),
        e.verdict
    );
    if vectors {
        text += &format!(", \"right\": [{}], \"left\": [{}]", vector_json(&e.right), vector_json(&e.left));
    }
    text + "}"
}

fn json(spectrum: &GeneralSpectrum, certified: &Certified, vectors: bool) -> String {
    // A constraint or a massless joint grows nothing: infinite eigenvalues are no threat to stability.
    let infinite = "    {\"kind\": \"infinite\", \"re\": null, \"im\": null, \"frequency_hz\": null, \
                    \"damping_ratio\": null, \"backward_error\": 0, \"condition\": null, \"bound\": null, \
                    \"verdict\": \"stable\"}";
    let eigenvalues = certified.eigenvalues.iter().map(|e| finite_json(e, vectors));
    let eigenvalues: Vec<_> = eigenvalues.chain((0..spectrum.infinite).map(|_| infinite.to_owned())).collect();
    let clusters = list(&certified.clusters, |c| {
        format!(
            "\n    {{\"kind\": \"{}\", \"members\": [{}], \"mean_re\": {}, \"mean_im\": {}, \"spread\": {}}}",
            kind(c.kind),
            list(&c.members, usize::to_string),
            number(c.mean.re),
            number(c.mean.im),
            number(c.spread)
        )
    });
    format!(
        "{{\n  \"route\": \"{}\",\n  \"eigenvalues\": [\n{}\n  ],\n  \"clusters\": [{clusters}]\n}}\n",
        spectrum.route,
        eigenvalues.join(",\n")
    )
}

fn table(spectrum: &GeneralSpectrum, certified: &Certified, vectors: bool) -> String {
    let mut text = format!(
        "{:>5} {:>24} {:>24} {:>14} {:>12} {:>9} {:>9}  {}\n",
        "no.", "Re lambda, rad/s", "Im lambda, rad/s", "f, Hz", "damping", "backward", "condition", "verdict"
    );
    for (i, e) in certified.eigenvalues.iter().enumerate() {
        let l = e.lambda;
        text += &format!(
            "{:>5} {:>24.16e} {:>24.16e} {:>14.6} {:>12.4e} {:>9.1e} {:>9.1e}  {}\n",
            i + 1,
            l.re,
            l.im,
            frequency_hz(l),
            damping_ratio(l),
            e.backward_error,
            e.condition,
            e.verdict
        );
        if vectors {
            let row = |v: &DVector<Complex<f64>>| list(v.iter(), |z| format!("{:.16e}{:+.16e}i", z.re, z.im));
            text += &format!("      right: {}\n      left:  {}\n", row(&e.right), row(&e.left));
        }
    }
    let count = |name| certified.eigenvalues.iter().filter(|e| e.verdict.to_string() == name).count();
    text += &format!(
        "\n{} finite eigenvalues ({} exactly zero): {} unstable, {} stable, {} marginal, {} undecided; {} infinite; \
         route {}\n",
        certified.eigenvalues.len(),
        spectrum.zeros,
        count("unstable"),
        count("stable"),
        count("marginal"),
        count("undecided"),
        spectrum.infinite,
        spectrum.route
    );
    for c in &certified.clusters {
        let members = list(&c.members, |i| (i + 1).to_string());
        let mean = format!("{:.9e}{:+.9e}i", c.mean.re, c.mean.im);
        text += &format!("{} group: no. {members}; mean {mean}, spread {:.1e}\n", kind(c.kind), c.spread);
    }
    text += "damping = -Re lambda / |lambda|; bounds and verdicts: docs/error-bounds.md\n";
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(folder: &Path, m: &str, c: Option<&str>, k: &str) -> EigArgs {
        let write = |name: &str, text: &str| {
            let path = folder.join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let damping = c.map(|c| write("C.mtx", c));
        EigArgs { mass: write("M.mtx", m), damping, stiffness: write("K.mtx", k), vectors: true, json: true }
    }

    const HEAD: &str = "%%MatrixMarket matrix coordinate real general\n";

    #[test]
    fn json_holds_every_eigenvalue_with_its_verdict() {
        let folder = tempfile::tempdir().unwrap();
        // A mass on a spring, a massless joint and a free body: +-2i, two infinite, two zero.
        let m = format!("{HEAD}3 3 2\n1 1 1\n3 3 1\n");
        let k = format!("{HEAD}3 3 2\n1 1 4\n2 2 1\n");
        let mut out = Vec::new();
        args(folder.path(), &m, None, &k).run(&mut out).unwrap();
        let value: serde_json::Value = serde_json::from_slice(&out).unwrap();
        let all = value["eigenvalues"].as_array().unwrap();
        let kinds = |name: &str| all.iter().filter(|e| e["kind"] == name).count();
        assert_eq!((all.len(), kinds("finite"), kinds("infinite")), (6, 4, 2));
        let finite = || all.iter().filter(|e| e["kind"] == "finite");
        assert!(finite().all(|e| e["verdict"] == "marginal" && e["right"].as_array().unwrap().len() == 3));
        assert_eq!(finite().filter(|e| e["re"] == 0.0 && e["im"] == 0.0).count(), 2);
        assert!(finite().any(|e| (e["im"].as_f64().unwrap() - 2.0).abs() < 1e-15));
        assert_eq!(value["route"], "deflated-qz");
    }

    #[test]
    fn the_table_counts_verdicts_and_names_groups() {
        let folder = tempfile::tempdir().unwrap();
        let one = format!("{HEAD}2 2 2\n1 1 1\n2 2 1\n");
        let k = format!("{HEAD}2 2 3\n1 1 1\n1 2 1\n2 2 1\n");
        let mut out = Vec::new();
        EigArgs { json: false, ..args(folder.path(), &one, None, &k) }.run(&mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.contains("0 unstable, 0 stable, 4 marginal, 0 undecided; 0 infinite; route standard"), "{text}");
        assert_eq!(text.matches("defective group").count(), 2);
    }

    #[test]
    fn one_line_says_what_is_wrong() {
        let folder = tempfile::tempdir().unwrap();
        let one = format!("{HEAD}1 1 1\n1 1 1\n");
        let error = |m: &str, c: Option<&str>, k: &str| {
            args(folder.path(), m, c, k).run(&mut Vec::new()).unwrap_err().to_string()
        };
        let wide = format!("{HEAD}1 2 1\n1 1 1\n");
        let two = format!("{HEAD}2 2 1\n1 1 1\n");
        let zero = format!("{HEAD}1 1 0\n");
        let cases = [
            (error(&wide, None, &one), "M.mtx: the mass matrix is 1 x 2; allowed: 1 x 1, a square matrix"),
            (error(&one, Some(&two), &one), "C.mtx: the damping matrix is 2 x 2; allowed: 1 x 1"),
            (error(&one, None, "1, 1, 5.0\n"), "K.mtx: line 1: \"1, 1, 5.0\" looks like an Abaqus matrix"),
            (error(&zero, None, &zero), "singular"),
        ];
        for (message, part) in cases {
            assert!(message.contains(part) && !message.contains('\n'), "{message}");
        }
        let missing = EigArgs { mass: folder.path().join("none"), ..args(folder.path(), &one, None, &one) };
        assert!(missing.run(&mut Vec::new()).unwrap_err().to_string().contains("none: cannot be read"));
    }
}
