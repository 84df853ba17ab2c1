//! `squeal eig`: eigenvalues of any second-order system from matrices in files, all of them or those of a rectangle.

mod dense;
mod matrices;
mod rectangle;
mod symmetry;
mod text;

use std::io::Write;
use std::path::PathBuf;

use sparse::Rectangle;

use super::options::MemoryArgs;
use crate::Error;
pub(super) use dense::announce;
pub use rectangle::{largest_order, search_options};
pub use symmetry::SaidSymmetry;

/// Eigenvalues of lambda^2 M + lambda C + K, each with its backward error, condition number and verdict.
///
/// The files may be of any format that is read here: Matrix Market, CalculiX .sti and .mas, Abaqus MATRIX INPUT or USER
/// ELEMENT, Nastran DMIG or OP4, Harwell-Boeing, MATLAB .mat, NumPy .npy or .npz, each also compressed by gzip. Of a file with several
/// matrices the one is taken whose name is usual for M, C or K; FILE:NAME says which. Rows that the files name are brought
/// together. Degrees of freedom held by entries huge against all others are named and taken out. A list with entries on one side of the
/// diagonal, of which the file does not say whether it is a triangle, is refused: say --symmetry (docs/formats.md).
///
/// Without --box all eigenvalues are found, by dense matrices. The matrices may be singular, unsymmetric and in any units.
/// Infinite eigenvalues (of a singular M) are listed but never count as unstable. A verdict "marginal" means that Re lambda
/// is zero to within what rounding the matrices to doubles may move it by; "undecided" that its sign could not be settled. A
/// bound is certified up to rounding and holds for every problem that rounds to the given matrices; JSON has null where there
/// is none, as for eigenvalues without a digit.
///
/// With --box the eigenvalues in a rectangle are listed, of more than 300 degrees of freedom by sparse matrices, for thousands of
/// them, and bounds are then to first order. Up to 10,000 degrees of freedom, and above with --count, they are counted a second time in
/// another way; docs/large-problems.md says how, and with what limits.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: squeal eig --mass M.mtx --damping C.mtx --stiffness K.mtx")]
pub struct EigArgs {
    /// M, a file of any format named above
    #[arg(long, value_name = "M.mtx")]
    pub mass: PathBuf,
    /// C, likewise; zero where it is left out
    #[arg(long, value_name = "C.mtx")]
    pub damping: Option<PathBuf>,
    /// K, likewise
    #[arg(long, value_name = "K.mtx")]
    pub stiffness: PathBuf,
    /// How files store matrices that do not say so: whole, or the upper, the lower or either triangle to be mirrored; of one as damping=whole
    #[arg(long, value_name = "[MATRIX=]whole|upper|lower|triangle", value_delimiter = ',', value_parser = symmetry::parse)]
    pub symmetry: Vec<SaidSymmetry>,
    /// Only the eigenvalues with RE0 <= Re lambda <= RE1 and IM0 <= Im lambda <= IM1, rad/s
    #[arg(long = "box", value_name = "RE0:RE1,IM0:IM1", value_parser = rectangle::parse, allow_hyphen_values = true)]
    pub rectangle: Option<Rectangle>,
    /// Only the K of them with the largest Re lambda, that first
    #[arg(long, value_name = "K", requires = "rectangle", value_parser = clap::value_parser!(u32).range(1..))]
    pub rightmost: Option<u32>,
    /// Count what is in the rectangle again, however long it takes
    #[arg(long, requires = "rectangle")]
    pub count: bool,
    /// Memory that may be taken with --box
    #[command(flatten)]
    pub memory: MemoryArgs,
    /// Add the right and left eigenvectors, unit 2-norm
    #[arg(long)]
    pub vectors: bool,
    /// Write JSON, numbers to 17 digits, in place of a table
    #[arg(long)]
    pub json: bool,
}

impl EigArgs {
    /// Reads the matrices, solves and writes to `out`, in one piece.
    ///
    /// # Errors
    /// A file that is no matrix, shapes that differ, a singular pencil, no convergence, a rectangle with too much in it, or a
    /// failure to write.
    pub fn run(&self, out: &mut dyn Write) -> Result<(), Error> {
        let text = match &self.rectangle {
            Some(rectangle) => rectangle::spectrum(self, rectangle)?,
            None => dense::spectrum(self)?,
        };
        out.write_all(text.as_bytes()).map_err(Error::StandardOutput)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn args(folder: &Path, m: &str, c: Option<&str>, k: &str) -> EigArgs {
        let write = |name: &str, text: &str| {
            let path = folder.join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let damping = c.map(|c| write("C.mtx", c));
        EigArgs {
            mass: write("M.mtx", m),
            damping,
            stiffness: write("K.mtx", k),
            symmetry: Vec::new(),
            rectangle: None,
            rightmost: None,
            count: false,
            memory: MemoryArgs::default(),
            vectors: true,
            json: true,
        }
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
            (error(&one, None, "solid\n"), "K.mtx: \"solid\": none of the formats read here"),
            (error(&zero, None, &zero), "singular"),
        ];
        for (message, part) in cases {
            assert!(message.contains(part) && !message.contains('\n'), "{message}");
        }
        let missing = EigArgs { mass: folder.path().join("none"), ..args(folder.path(), &one, None, &one) };
        assert!(missing.run(&mut Vec::new()).unwrap_err().to_string().contains("none: cannot be read"));
    }
}
