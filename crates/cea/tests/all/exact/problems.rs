//! Problems whose eigenvalues are known exactly: `L (lambda^2 + c lambda + A)` with an integer A of chosen Jordan form.

use std::f64::consts::TAU;
use std::fmt;

use cea::Verdict;
use linsys::{Internal, SecondOrder};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

/// Numbers that look random and are the same in every run (splitmix64; Steele, Lea, Flood, OOPSLA 2014).
pub struct Numbers(pub u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An integer from `from` to `to`, both included.
    pub fn integer(&mut self, from: i128, to: i128) -> i128 {
        from + i128::from(self.next()) % (to - from + 1)
    }
}

/// The Jordan form of a K: for each block its eigenvalue and its length.
pub type Blocks = Vec<(i128, usize)>;

/// M, C and K, with what is true of them.
pub struct Problem {
    pub system: SecondOrder,
    /// Every eigenvalue as often as it occurs, correctly rounded but for a few units in the last place.
    pub eigenvalues: Vec<Complex<f64>>,
}

/// Square matrices as rows.
type Integers = Vec<Vec<i128>>;

fn jordan_form(blocks: &Blocks) -> Integers {
    let n = blocks.iter().map(|b| b.1).sum();
    let mut matrix = vec![vec![0; n]; n];
    let mut at = 0;
    for &(eigenvalue, length) in blocks {
        for i in at..at + length {
            matrix[i][i] = eigenvalue;
            if i + 1 < at + length {
                matrix[i][i + 1] = 1;
            }
        }
        at += length;
    }
    matrix
}

/// The roots of `lambda^2 + c lambda + k` without cancellation.
fn roots(c: f64, k: f64) -> [Complex<f64>; 2] {
    let discriminant = c * c / 4.0 - k;
    if discriminant < 0.0 {
        return [1.0, -1.0].map(|sign| Complex::new(-c / 2.0, sign * (-discriminant).sqrt()));
    }
    let large = -c / 2.0 - discriminant.sqrt();
    [large, if large == 0.0 { 0.0 } else { k / large }].map(Complex::from)
}

fn problem(blocks: &Blocks, m: DMatrix<f64>, c: f64, k: DMatrix<f64>) -> Problem {
    let damping = &m * c;
    let system = SecondOrder::new(m, damping, k).unwrap();
    let each = |&(k, length): &(i128, usize)| roots(c, k as f64).repeat(length);
    Problem { system, eigenvalues: blocks.iter().flat_map(each).collect() }
}

/// Two rows and a factor.
fn elementary(n: usize, numbers: &mut Numbers) -> (usize, usize, i128) {
    let mut row = || numbers.integer(0, n as i128 - 1) as usize;
    (row(), row(), numbers.integer(-2, 2))
}

/// Row i plus `factor` rows j, another one.
fn add_row(matrix: &mut Integers, i: usize, j: usize, factor: i128) {
    if i != j {
        let other = matrix[j].clone();
        matrix[i].iter_mut().zip(other).for_each(|(x, y)| *x += factor * y);
    }
}

/// M = L, C = c L and K = `L P J P^-1` of the given Jordan form, with P a product of `steps` elementary unimodular matrices and L the
/// identity or another one of n: integers throughout, so all three are exact. Nothing where an entry exceeds 2^53.
pub fn unimodular(blocks: &Blocks, c: f64, steps: usize, numbers: &mut Numbers) -> Option<Problem> {
    let mut k = jordan_form(blocks);
    let n = k.len();
    for _ in 0..steps {
        let (i, j, factor) = elementary(n, numbers);
        // Row i plus `factor` rows j, and the inverse from the right.
        add_row(&mut k, i, j, factor);
        for row in k.iter_mut().filter(|_| i != j) {
            row[j] -= factor * row[i];
        }
    }
    let mut m: Integers = (0..n).map(|i| (0..n).map(|j| i128::from(i == j)).collect()).collect();
    for _ in 0..if numbers.integer(0, 1) == 0 { 0 } else { n } {
        let (i, j, factor) = elementary(n, numbers);
        add_row(&mut m, i, j, factor);
        add_row(&mut k, i, j, factor);
    }
    let exact = m.iter().chain(&k).flatten().all(|x| x.unsigned_abs() <= 1 << 53);
    let double = |a: &Integers| DMatrix::from_fn(n, n, |i, j| a[i][j] as f64);
    exact.then(|| problem(blocks, double(&m), c, double(&k)))
}

/// A rational similarity of the Jordan form by two reflections, each entry rounded once to a double: the exact eigenvalues are
/// those of a problem that rounds to the given one.
pub fn reflected(blocks: &Blocks, c: f64, numbers: &mut Numbers) -> Problem {
    reflected_in(blocks, c, numbers).0
}

/// [`reflected`], with the reflections' product, whose columns are the chains.
fn reflected_in(blocks: &Blocks, c: f64, numbers: &mut Numbers) -> (Problem, DMatrix<f64>) {
    let mut k = jordan_form(blocks);
    let (n, mut denominator) = (k.len(), 1);
    let mut basis = DMatrix::identity(n, n);
    let product = |a: &Integers, b: &Integers| -> Integers {
        let entry = |i: usize, j: usize| (0..n).map(|l| a[i][l] * b[l][j]).sum();
        (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
    };
    for _ in 0..2 {
        let v: Vec<i128> = (0..n).map(|_| Some(numbers.integer(-9, 9)).filter(|&x| x != 0).unwrap_or(1)).collect();
        let square: i128 = v.iter().map(|x| x * x).sum();
        // v^T v I - 2 v v^T.
        let entry = |i: usize, j: usize| square * i128::from(i == j) - 2 * v[i] * v[j];
        let h: Integers = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        k = product(&product(&h, &k), &h);
        denominator *= square * square;
        basis = DMatrix::from_fn(n, n, |i, j| h[i][j] as f64 / square as f64) * basis;
    }
    assert!(k.iter().flatten().all(|x| x.unsigned_abs() <= 1 << 53) && denominator <= 1 << 53);
    let k = DMatrix::from_fn(n, n, |i, j| k[i][j] as f64 / denominator as f64);
    (problem(blocks, DMatrix::identity(n, n), c, k), basis)
}

/// A chain of `m` with an internal state for each of some `decays`, which reads the end of the chain that nothing drives and acts on
/// the end that drives nothing, at rest as a dashpot of `dashpot`: the states close no loop, and the eigenvalues are those of the
/// chain and the decays.
pub fn chain_with_states(m: usize, c: f64, decays: &[f64], dashpot: f64, numbers: &mut Numbers) -> Problem {
    let (mut problem, basis) = reflected_in(&vec![(4, m)], c, numbers);
    let gain = |k: usize| (dashpot * decays[k]).sqrt();
    problem.system.internal = Internal {
        decay: DVector::from_row_slice(decays),
        drive: DMatrix::from_fn(decays.len(), m, |k, j| gain(k) * basis[(j, m - 1)]),
        force: DMatrix::from_fn(m, decays.len(), |i, k| gain(k) * basis[(i, 0)]),
    };
    problem.eigenvalues.extend(decays.iter().map(|&decay| Complex::from(-decay)));
    problem
}

/// A chain of `m` that a `perturbation` from its one end to the other takes apart, `k = 4 + perturbation^(1/m)` with all roots, with an
/// internal state for each of some `decays` that reads it all and acts on nothing, or is read by nothing and acts on it all.
pub fn chain_taken_apart(m: usize, perturbation: f64, c: f64, decays: &[f64], numbers: &mut Numbers) -> Problem {
    let (mut problem, basis) = reflected_in(&vec![(4, m)], c, numbers);
    problem.system.k += basis.column(m - 1) * basis.column(0).transpose() * perturbation;
    let (drive, force) = if numbers.integer(0, 1) == 0 { (1.0, 0.0) } else { (0.0, 1.0) };
    problem.system.internal = Internal {
        decay: DVector::from_row_slice(decays),
        drive: DMatrix::from_element(decays.len(), m, drive),
        force: DMatrix::from_element(m, decays.len(), force),
    };
    let root = |j: usize| Complex::from_polar(perturbation.powf(1.0 / m as f64), j as f64 * TAU / m as f64);
    let of_root = |j: usize| {
        let half = (Complex::from(c * c / 4.0 - 4.0) - root(j)).sqrt();
        [half - c / 2.0, -half - c / 2.0]
    };
    problem.eigenvalues = (0..m).flat_map(of_root).chain(decays.iter().map(|&decay| Complex::from(-decay))).collect();
    problem
}

/// Frank's matrix: `n + 1 - max(i, j)` above the diagonal and one below it, determinant 1, all eigenvalues real, positive and
/// the smallest so ill conditioned that none of their digits are determined (Frank, SIAM J. 6, 1958).
pub fn frank(n: usize, c: f64) -> SecondOrder {
    let k = DMatrix::from_fn(n, n, |i, j| if i > j + 1 { 0.0 } else { (n - i.max(j)) as f64 });
    SecondOrder::new(DMatrix::identity(n, n), DMatrix::identity(n, n) * c, k).unwrap()
}

/// What came out, over many problems.
#[derive(Debug, Default, Clone, Copy)]
pub struct Count {
    pub problems: usize,
    /// Of which no eigenvalues were found.
    pub refused: usize,
    pub eigenvalues: usize,
    pub decided: usize,
    pub unbounded: usize,
    /// Decided with the sign that the exact eigenvalue does not have.
    pub wrong: usize,
    /// Farther from the exact eigenvalue than the bound.
    pub beyond: usize,
    /// Largest error / bound.
    pub worst: f64,
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { problems, refused, eigenvalues, decided, unbounded, wrong, beyond, worst } = self;
        write!(f, "{problems} | {refused} | {eigenvalues} | {decided} | {unbounded} | {wrong} | {beyond} | {worst:.2}")
    }
}

impl Count {
    /// Enters eigenvalues, their bounds and verdicts.
    pub fn enter(&mut self, exact: &[Complex<f64>], found: &[(Complex<f64>, f64, Verdict)]) {
        self.problems += 1;
        self.eigenvalues += found.len();
        for (&(lambda, bound, verdict), exact) in found.iter().zip(partners(exact, found)) {
            let error = (lambda - exact).norm();
            // The exact one is rounded itself.
            let allowed = bound + 4.0 * f64::EPSILON * exact.norm();
            self.unbounded += usize::from(bound.is_infinite());
            self.beyond += usize::from(error > allowed);
            self.worst = self.worst.max(if bound.is_finite() { error / allowed } else { 0.0 });
            let (stable, unstable) = (verdict == Verdict::Stable, verdict == Verdict::Unstable);
            self.decided += usize::from(stable || unstable);
            let marginal = matches!(verdict, Verdict::Marginal { tolerance } if exact.re.abs() > tolerance);
            self.wrong += usize::from(stable && exact.re >= 0.0 || unstable && exact.re <= 0.0 || marginal);
        }
    }
}

/// The exact eigenvalue of each that was found: one each, nearest pairs first.
fn partners(exact: &[Complex<f64>], found: &[(Complex<f64>, f64, Verdict)]) -> Vec<Complex<f64>> {
    assert_eq!(exact.len(), found.len());
    let distance = |&(i, j): &(usize, usize)| (found[i].0 - exact[j]).norm();
    let mut pairs: Vec<_> = (0..found.len()).flat_map(|i| (0..exact.len()).map(move |j| (i, j))).collect();
    pairs.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    let (mut partner, mut taken) = (vec![None; found.len()], vec![false; exact.len()]);
    for (i, j) in pairs {
        if partner[i].is_none() && !taken[j] {
            (partner[i], taken[j]) = (Some(exact[j]), true);
        }
    }
    partner.into_iter().map(Option::unwrap).collect()
}
