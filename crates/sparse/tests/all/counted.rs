//! Rectangles of systems whose eigenvalues are known: free bodies, equal parts, defective pairs, singular masses, any units.
//!
//! A system is made of small parts whose eigenvalues are written down, put on a diagonal and mixed by orthogonal matrices, so that
//! nothing of its structure shows in the entries and rounding moves every eigenvalue a little. All are then in a rectangle as often as
//! they occur, by the certified route and by the search.

use std::ops::Range;

use cea::Verdict;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sparse::nalgebra_sparse::CscMatrix;
use sparse::{Count, Found, Options, Rectangle, SparseError, SparseSecondOrder, eigenpairs_in};

type Matrix = DMatrix<f64>;

/// A part: M, C, K and its finite eigenvalues.
struct Part {
    m: Matrix,
    c: Matrix,
    k: Matrix,
    lambdas: Vec<Complex<f64>>,
}

/// Both zeros of `m x^2 + c x + k`, or the one that there is.
fn roots(m: f64, c: f64, k: Complex<f64>) -> Vec<Complex<f64>> {
    if m == 0.0 {
        return if c == 0.0 { Vec::new() } else { vec![-k / c] };
    }
    let root = (Complex::from(c * c) - 4.0 * m * k).sqrt();
    let larger = if root.re * c >= 0.0 { -c - root } else { -c + root };
    if larger.norm() == 0.0 {
        return vec![Complex::default(); 2];
    }
    vec![larger / (2.0 * m), 2.0 * k / larger]
}

fn one(value: f64) -> Matrix {
    Matrix::from_element(1, 1, value)
}

/// A mass on a spring and a damper.
fn oscillator(m: f64, c: f64, k: f64) -> Part {
    Part { m: one(m), c: one(c), k: one(k), lambdas: roots(m, c, k.into()) }
}

/// A chain of equal masses, held at no end: the damping is `ratio` times the stiffness, so that the rigid motion has none.
fn free_chain(masses: usize, k: f64, ratio: f64) -> Part {
    let mut laplacian = Matrix::zeros(masses, masses);
    for i in 1..masses {
        for (row, column, value) in [(i, i, 1.0), (i - 1, i - 1, 1.0), (i, i - 1, -1.0), (i - 1, i, -1.0)] {
            laplacian[(row, column)] += value;
        }
    }
    let mode = |j: usize| {
        let k = k * (2.0 * (std::f64::consts::PI * j as f64 / (2.0 * masses as f64)).sin()).powi(2);
        roots(1.0, ratio * k, k.into())
    };
    let lambdas = (0..masses).flat_map(mode).collect();
    Part { m: Matrix::identity(masses, masses), c: &laplacian * (k * ratio), k: laplacian * k, lambdas }
}

/// Follower forces: `lambda^2 + c lambda + k +- i a = 0`, flutter where a is large.
fn follower(c: f64, k: f64, a: f64) -> Part {
    let k_matrix = Matrix::from_row_slice(2, 2, &[k, a, -a, k]);
    let lambdas = [a, -a].into_iter().flat_map(|a| roots(1.0, c, Complex::new(k, a))).collect();
    Part { m: Matrix::identity(2, 2), c: Matrix::identity(2, 2) * c, k: k_matrix, lambdas }
}

/// A gyroscope on springs k and l: `lambda^4 + (k + l + g^2) lambda^2 + k l = 0`.
fn gyroscope(g: f64, k: f64, l: f64) -> Part {
    let squares = roots(1.0, k + l + g * g, (k * l).into());
    let lambdas = squares.into_iter().flat_map(|square| [square.sqrt(), -square.sqrt()]).collect();
    let c = Matrix::from_row_slice(2, 2, &[0.0, g, -g, 0.0]);
    Part { m: Matrix::identity(2, 2), c, k: Matrix::from_diagonal(&vec![k, l].into()), lambdas }
}

/// Two equal oscillators of which one drives the other: a double eigenvalue with one vector.
fn defective(c: f64, k: f64, coupling: f64) -> Part {
    let k_matrix = Matrix::from_row_slice(2, 2, &[k, coupling, 0.0, k]);
    let lambdas = roots(1.0, c, k.into()).into_iter().flat_map(|lambda| [lambda; 2]).collect();
    Part { m: Matrix::identity(2, 2), c: Matrix::identity(2, 2) * c, k: k_matrix, lambdas }
}

/// What a system is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Free,
    FreeDamped,
    Torsion,
    EqualFlutter,
    EqualOverdamped,
    EqualDiverging,
    Gyroscopic,
    Defective,
    Massless,
    FirstOrder,
    Mixture,
}

const KINDS: [Kind; 11] = [
    Kind::Free,
    Kind::FreeDamped,
    Kind::Torsion,
    Kind::EqualFlutter,
    Kind::EqualOverdamped,
    Kind::EqualDiverging,
    Kind::Gyroscopic,
    Kind::Defective,
    Kind::Massless,
    Kind::FirstOrder,
    Kind::Mixture,
];

struct Random(ChaCha8Rng);

impl Random {
    fn value(&mut self, range: Range<f64>) -> f64 {
        self.0.random_range(range)
    }

    fn count(&mut self, range: Range<usize>) -> usize {
        self.0.random_range(range)
    }

    /// From 0.3 to 30, as many below as above 3.
    fn size(&mut self) -> f64 {
        10f64.powf(self.value(-0.5..1.5))
    }

    /// One of a kind; those that the same numbers make are equal.
    fn part(&mut self, kind: Kind) -> Part {
        let (a, b, c) = (self.size(), self.size(), self.size());
        let masses = self.count(1..7);
        match kind {
            Kind::Free => free_chain(masses, a * a, 0.0),
            Kind::FreeDamped => free_chain(masses, a * a, 0.02 / a),
            // A disc of a shaft on a bearing that only damps, and one that a spring holds too.
            Kind::Torsion => oscillator(1.0, 0.3 * a, 0.0),
            Kind::EqualFlutter => follower(0.02 * a, b * b, 0.1 * b * b + 0.1 * a * c),
            Kind::EqualOverdamped => oscillator(1.0, 3.0 * a, a * a),
            Kind::EqualDiverging => oscillator(1.0, 0.1 * a, -b * b),
            Kind::Gyroscopic => gyroscope(a, b * b, c * c),
            Kind::Defective => defective(0.01 * a * self.count(0..2) as f64, b * b, b * b * 0.3),
            Kind::Massless => oscillator(0.0, a * self.count(0..2) as f64, b),
            Kind::FirstOrder => oscillator(0.0, a, b),
            Kind::Mixture => {
                let kind = KINDS[self.count(0..KINDS.len() - 1)];
                self.part(kind)
            }
        }
    }
}

/// A system of parts, and its finite eigenvalues.
struct System {
    sparse: SparseSecondOrder,
    lambdas: Vec<Complex<f64>>,
}

/// Of one to twelve equal parts and others, up to `order` degrees of freedom, mixed by rotations and scaled.
fn system(kind: Kind, order: usize, random: &mut Random) -> System {
    let seed = random.0.clone();
    let mut parts: Vec<Part> = (0..random.count(1..13)).map(|_| Random(seed.clone()).part(kind)).collect();
    // The same numbers once more, so that what follows is another part.
    random.part(kind);
    let others = random.count(0..3);
    let size = |parts: &[Part]| parts.iter().map(|part| part.m.nrows()).sum::<usize>();
    for at in 0.. {
        let other = match (kind, others) {
            (Kind::FirstOrder, _) => random.part(kind),
            (_, 0) => random.part(kind),
            (_, 1) => oscillator(1.0, 0.0, random.size().powi(2)),
            _ => oscillator(random.size(), 0.1 * random.size(), random.size().powi(2)),
        };
        if size(&parts) + other.m.nrows() > order || at > order {
            break;
        }
        parts.push(other);
    }
    let n = size(&parts);
    let (mut m, mut c, mut k, mut lambdas) =
        (Matrix::zeros(n, n), Matrix::zeros(n, n), Matrix::zeros(n, n), Vec::new());
    let mut at = 0;
    for part in parts {
        let own = part.m.nrows();
        for (whole, part) in [(&mut m, &part.m), (&mut c, &part.c), (&mut k, &part.k)] {
            whole.view_mut((at, at), (own, own)).copy_from(part);
        }
        lambdas.extend(part.lambdas);
        at += own;
    }
    let rotation = |random: &mut Random| {
        let mut q = Matrix::identity(n, n);
        for _ in 0..3 {
            let v = DVector::from_fn(n, |_, _| random.value(-1.0..1.0)).normalize();
            q -= (&q * &v) * (2.0 * v.transpose());
        }
        q
    };
    let how = random.count(0..4);
    if how > 0 {
        let right = rotation(random);
        // A congruence keeps what is symmetric so; an equivalence does not.
        let left = if how > 1 { right.transpose() } else { rotation(random) };
        for matrix in [&mut m, &mut c, &mut k] {
            *matrix = &left * &*matrix * &right;
            if how > 1 && kind == Kind::Free {
                *matrix = (&*matrix + matrix.transpose()) * 0.5;
            }
        }
    }
    match random.count(0..4) {
        0 => {
            let unit = 10f64.powi(random.count(0..25) as i32 - 12);
            [&mut m, &mut c, &mut k].into_iter().for_each(|matrix| *matrix *= unit);
        }
        1 => {
            // Another unit of time.
            let unit = 10f64.powi(random.count(0..7) as i32 - 3);
            k *= unit * unit;
            c *= unit;
            lambdas.iter_mut().for_each(|lambda| *lambda *= unit);
        }
        2 => {
            // Rows and columns of units of their own: the scaling is exact.
            let mut scale =
                || Matrix::from_diagonal(&DVector::from_fn(n, |_, _| 2f64.powi(random.count(0..40) as i32 - 20)));
            let (left, right) = (scale(), scale());
            for matrix in [&mut m, &mut c, &mut k] {
                *matrix = &left * &*matrix * &right;
            }
        }
        _ => {}
    }
    let [m, c, k] = [&m, &c, &k].map(CscMatrix::from);
    System { sparse: SparseSecondOrder::new(m, c, k).unwrap(), lambdas }
}

/// A rectangle of some kind, by what is in the system.
fn rectangle(lambdas: &[Complex<f64>], random: &mut Random) -> Rectangle {
    let largest = lambdas.iter().map(|lambda| lambda.norm()).fold(1e-3, f64::max);
    let some = if lambdas.is_empty() { Complex::new(1.0, 1.0) } else { lambdas[random.count(0..lambdas.len())] };
    let most = 1.1 * largest;
    let (re, im) = match random.count(0..9) {
        0 => ([-most, most], [0.0, most]),
        1 => ([-most, most], [-most, 0.0]),
        2 => ([-0.3 * most, 0.2 * most], [-0.4 * most, 0.5 * most]),
        3 => ([some.re, some.re + 0.5 * most], [some.im - 0.3 * most, some.im]),
        4 => ([0.0, most], [-most, most]),
        5 => {
            let half = 1e-3 * some.norm().max(1e-3 * largest);
            ([some.re - half, some.re + half], [some.im - half, some.im + half])
        }
        6 => ([-1e3 * most, 1e3 * most], [-1e3 * most, 1e3 * most]),
        7 => ([-most, -1e-3 * most], [1e-3 * most, 0.6 * most]),
        _ => ([-0.1 * most, 0.1 * most], [0.2 * most, 0.9 * most]),
    };
    Rectangle { re, im }
}

/// How often rounding of the system here exceeds that of its entries alone, which the bounds are for: every entry is a sum of some
/// products.
const ROUNDED: f64 = 32.0;

/// How far a found eigenvalue may be from the one that the system was made of, by its own bound; nothing encloses it where that is
/// infinite, and then the root of rounding is what moves a double one.
fn allowed(bound: f64, lambda: Complex<f64>, largest: f64) -> f64 {
    if bound.is_finite() { ROUNDED * bound } else { 1e-6 * lambda.norm().max(largest) }
}

/// Compares what was found with what there is.
fn compare(system: &System, rectangle: &Rectangle, found: &Found) -> Result<(), String> {
    let largest = system.lambdas.iter().map(|lambda| lambda.norm()).fold(0.0, f64::max);
    let mut is_free = vec![true; system.lambdas.len()];
    for pair in &found.pairs {
        let distance = |i: &usize| (system.lambdas[*i] - pair.lambda).norm();
        let nearest = (0..is_free.len()).filter(|&i| is_free[i]).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let nearest = nearest.ok_or_else(|| format!("{} too many", pair.lambda))?;
        is_free[nearest] = false;
        let exact = system.lambdas[nearest];
        let allowed = allowed(pair.bound, pair.lambda, largest);
        if distance(&nearest) > allowed {
            return Err(format!("{} for {exact}: off by {:e}, allowed {allowed:e}", pair.lambda, distance(&nearest)));
        }
        if rectangle.border_distance(exact) > allowed && !rectangle.contains(exact, 0.0) {
            return Err(format!("{exact} is outside"));
        }
        let is_wrong = match pair.verdict {
            Verdict::Stable => exact.re > allowed,
            Verdict::Unstable => exact.re < -allowed,
            Verdict::Marginal { .. } | Verdict::Undecided { .. } => exact.re.abs() > allowed + pair.bound,
        };
        if is_wrong {
            return Err(format!("{exact} is said to be {}", pair.verdict));
        }
    }
    let all = found.pairs.iter().map(|pair| allowed(pair.bound, pair.lambda, largest)).fold(1e-9 * largest, f64::max);
    for (i, &lambda) in system.lambdas.iter().enumerate().filter(|&(i, _)| is_free[i]) {
        if rectangle.contains(lambda, 0.0) && rectangle.border_distance(lambda) > all.min(1e-5 * largest) {
            return Err(format!("{lambda}, number {i}, is missing"));
        }
    }
    let values: Vec<_> = found.pairs.iter().map(|pair| pair.lambda).collect();
    let is_whole = rectangle.re.iter().chain(&rectangle.im).all(|border| border.abs() > 2.0 * largest + 1e-3)
        && rectangle.contains(Complex::default(), 0.0);
    if is_whole && values.len() != system.lambdas.len() {
        return Err(format!("{} of {} eigenvalues", values.len(), system.lambdas.len()));
    }
    Ok(())
}

/// What was found of some systems.
#[derive(Default)]
struct Looked {
    /// Lists that differ from what is known: silent errors.
    wrong: Vec<String>,
    /// Rectangles that were refused by name, those whose list its count contradicts among them.
    refused: Vec<String>,
}

/// Looks at systems number `numbers` of up to `order` degrees of freedom.
fn look(numbers: Range<u64>, order: usize, options: &Options) -> Looked {
    let mut looked = Looked::default();
    let (mut uncounted, mut contradicted) = (0, 0);
    for number in numbers.clone() {
        let mut random = Random(ChaCha8Rng::seed_from_u64(number));
        let kind = KINDS[number as usize % KINDS.len()];
        let order = random.count(1..order + 1);
        let system = system(kind, order, &mut random);
        let rectangle = rectangle(&system.lambdas, &mut random);
        let name = |text: String| format!("{number}, {kind:?}, n = {}, {rectangle:?}: {text}", system.sparse.order());
        match eigenpairs_in(&system.sparse, &rectangle, options, &mut |_| ()) {
            Ok(found) => {
                uncounted += usize::from(found.count == Count::Unclear);
                looked.wrong.extend(compare(&system, &rectangle, &found).err().map(name));
            }
            Err(error) => {
                // A list that its count contradicts, with wider blocks too.
                contradicted += usize::from(matches!(error, SparseError::CountsDiffer { .. }));
                looked.refused.push(name(error.to_string()));
            }
        }
    }
    let Looked { wrong, refused } = &looked;
    let count = numbers.end - numbers.start;
    println!(
        "{} of {count} wrong, {} refused by name, {contradicted} of them by their count; {uncounted} not counted again",
        wrong.len(),
        refused.len()
    );
    looked
}

fn certified() -> Options {
    Options { certified: 300, ..Options::default() }
}

fn searched() -> Options {
    Options { counted: usize::MAX, ..Options::default() }
}

#[test]
fn every_eigenvalue_once_by_the_certified_route() {
    let Looked { wrong, refused } = look(0..330, 12, &certified());
    assert!(wrong.is_empty() && refused.is_empty(), "{wrong:#?}\n{refused:#?}");
}

#[test]
fn every_eigenvalue_once_by_the_search() {
    let Looked { wrong, refused } = look(1000..1220, 12, &searched());
    assert!(wrong.is_empty() && refused.is_empty(), "{wrong:#?}\n{refused:#?}");
}

/// Rectangles around an eigenvalue down to sizes that rounding does not resolve: it is in each of them, with what its bound does not tell from it.
#[test]
fn a_rectangle_of_any_size_holds_the_eigenvalue_in_its_middle() {
    let mut refused = 0;
    for number in 0..66 {
        let mut random = Random(ChaCha8Rng::seed_from_u64(number));
        let kind = KINDS[number as usize % KINDS.len()];
        let order = random.count(2..13);
        let system = system(kind, order, &mut random);
        if system.lambdas.is_empty() {
            continue;
        }
        let largest = system.lambdas.iter().map(|lambda| lambda.norm()).fold(0.0, f64::max);
        let middle = system.lambdas[random.count(0..system.lambdas.len())];
        let half = 10f64.powi(-2 - 2 * (number / 11) as i32) * middle.norm().max(1e-3 * largest).max(1e-3);
        let [re, im] = [middle.re, middle.im].map(|x| [x - half, x + half]);
        let rectangle = Rectangle { re, im };
        for options in [certified(), Options { shifts: 12, ..searched() }] {
            let found = match eigenpairs_in(&system.sparse, &rectangle, &options, &mut |_| ()) {
                Ok(found) => found,
                // Next to one that is defective, or that occurs many times, the search may see nothing.
                Err(error) => {
                    println!("{number}, {kind:?}, {half:e}: {error}");
                    refused += 1;
                    continue;
                }
            };
            compare(&system, &rectangle, &found).unwrap_or_else(|text| panic!("{number}, {kind:?}, {half:e}: {text}"));
            let is_it = |lambda: Complex<f64>, bound: f64| (middle - lambda).norm() <= allowed(bound, lambda, largest);
            assert!(
                found.pairs.iter().any(|pair| is_it(pair.lambda, pair.bound)),
                "{number}, {kind:?}, {half:e}: {middle}"
            );
        }
    }
    assert!(refused < 9, "{refused} of 132 are refused");
}

/// `SYSTEMS=1000 cargo test --release -p brake-squeal-sparse --test all counted:: -- --ignored --nocapture`
#[test]
#[ignore = "minutes"]
fn a_thousand_systems_by_both_routes() {
    let number = |name: &str, default: u64| std::env::var(name).map_or(default, |text| text.parse().unwrap());
    let (from, count, order) = (number("FROM", 5000), number("SYSTEMS", 1000), number("ORDER", 200) as usize);
    if number("DENSE", 1) > 0 {
        let Looked { wrong, refused } = look(from..from + count, order, &certified());
        assert!(wrong.is_empty() && refused.is_empty(), "{wrong:#?}\n{refused:#?}");
    }
    if number("SEARCH", 1) > 0 {
        // Of eigenvalues that occur dozens of times a search may not find all, and says so.
        let Looked { wrong, refused } = look(from..from + count, order, &searched());
        println!("{refused:#?}");
        assert!(wrong.is_empty() && refused.len() as u64 <= count / 10, "{wrong:#?}");
    }
}
