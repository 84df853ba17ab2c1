//! Reductions of a plate of 240 degrees of freedom, with the answers of dense solvers as the truth.

use cea::{EigenSolver, QrSolver, Workspace, backward_error};
use linsys::{AffineSystem, Channel, ChannelGain, Lag, OperatingPoint, Term};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use reduction::{Combinations, Reduced, Route, Snapshots, Within, error_within, within};
use sparse::nalgebra_sparse::{CooMatrix, CscMatrix};
use sparse::{Rectangle, SparseAffineSystem, SparseSecondOrder, SparseTerm};

const ROWS: usize = 12;
const COLUMNS: usize = 10;
const N: usize = 2 * ROWS * COLUMNS;

fn dof(row: usize, column: usize, direction: usize) -> usize {
    2 * (row * COLUMNS + column) + direction
}

/// `sum x_e y_e^T` times a factor.
fn add(matrix: &mut CooMatrix<f64>, left: &[(usize, f64)], right: &[(usize, f64)], factor: f64) {
    for &(row, a) in left {
        right.iter().for_each(|&(column, b)| matrix.push(row, column, factor * a * b));
    }
}

/// A grid of masses with springs along and across it, held at one edge; a mass that turns with the grid (gyroscopic), friction on
/// some nodes (circulatory), dampers on others, and one friction channel.
fn plate() -> SparseAffineSystem {
    let mut parts = [(); 5].map(|()| CooMatrix::new(N, N));
    let [mass, stiffness, damping, gyroscopic, circulatory] = &mut parts;
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            for direction in 0..2 {
                let here = dof(row, column, direction);
                mass.push(here, here, 1.0 + 0.1 * ((3 * row + 5 * column + direction) % 7) as f64);
                stiffness.push(here, here, if row == 0 { 900.0 } else { 3.0 });
                let spring = 400.0 + 150.0 * direction as f64;
                for next in [(row + 1, column), (row, column + 1)].into_iter().filter(|n| n.0 < ROWS && n.1 < COLUMNS) {
                    let along = [(here, 1.0), (dof(next.0, next.1, direction), -1.0)];
                    add(stiffness, &along, &along, spring);
                    add(damping, &along, &along, 2e-3 * spring * ((row + 2 * column) % 3) as f64);
                }
            }
            let [x, y] = [dof(row, column, 0), dof(row, column, 1)];
            add(stiffness, &[(x, 1.0), (y, 0.4)], &[(x, 1.0), (y, 0.4)], 60.0);
            gyroscopic.push(x, y, 0.2);
            gyroscopic.push(y, x, -0.2);
            if row > 7 && column < 5 {
                circulatory.push(x, y, 25.0);
                circulatory.push(y, x, -25.0);
            }
        }
    }
    let [mass, stiffness, damping, gyroscopic, circulatory] = parts.each_ref().map(CscMatrix::from);
    let zero = || CscMatrix::zeros(N, N);
    let term = |name: &str, m, c, k| {
        let matrices = SparseSecondOrder::new(m, c, k).unwrap();
        SparseTerm { name: name.into(), family: name.into(), matrices, loss: 0.0 }
    };
    let terms = vec![
        term("structure", mass, zero(), stiffness),
        term("damping", zero(), damping, zero()),
        term("gyroscopic", zero(), gyroscopic, zero()),
        term("circulatory", zero(), zero(), circulatory),
    ];
    let force = vec![(dof(11, 9, 0), 1.0), (dof(10, 9, 0), -0.5)];
    let channel = Channel::new("pad", "friction", force, vec![(dof(11, 9, 1), -200.0), (dof(10, 8, 1), 90.0)]);
    SparseAffineSystem::new(terms, vec![channel]).unwrap()
}

fn dense(system: &SparseAffineSystem) -> AffineSystem {
    let terms = system.terms().iter().map(|term| {
        let SparseSecondOrder { m, c, k, .. } = &term.matrices;
        let [m, c, k] = [m, c, k].map(DMatrix::from);
        Term::new(&term.name, &term.family, linsys::SecondOrder::new(m, c, k).unwrap()).unwrap()
    });
    AffineSystem::new(terms.collect(), system.channels().to_vec()).unwrap()
}

fn point([damping, speed, friction]: [f64; 3]) -> OperatingPoint {
    let lag = Some(Lag { decay: 40.0, drive: 3.0, force: -0.5 });
    let gain = ChannelGain { mu: 0.4 * friction, slope: 0.1 * damping, lag };
    OperatingPoint { coefficients: vec![1.0, damping, speed, friction], channels: vec![gain] }
}

/// Damping, speed and friction over their ranges, by an additive sequence that covers the cube evenly.
fn draws(count: usize) -> Vec<OperatingPoint> {
    let part = |at: usize, step: f64| (0.5 + at as f64 * step).fract();
    (1..=count).map(|at| point([0.6 + 0.8 * part(at, 0.819_17), part(at, 0.671_04), part(at, 0.549_7)])).collect()
}

/// Residual that modes shall not exceed.
const TOLERANCE: f64 = 1e-8;
const RECTANGLE: Rectangle = Rectangle { re: [-0.6, 2.0], im: [0.5, 12.0] };

/// The truth: all eigenvalues of the full system in the rectangle by the dense solver.
fn truth(dense: &AffineSystem, at: &OperatingPoint) -> Vec<Complex<f64>> {
    let spectrum = QrSolver.eigenvalues(&dense.assemble(at).unwrap(), &mut Workspace::default()).unwrap();
    spectrum.eigenvalues.into_iter().filter(|&lambda| RECTANGLE.contains(lambda, 0.0)).collect()
}

fn distance(of: Complex<f64>, from: &[Complex<f64>]) -> f64 {
    from.iter().map(|other| (other - of).norm() / of.norm()).fold(f64::INFINITY, f64::min)
}

/// A basis of modes at some points, in a rectangle, with its singular values.
fn basis(system: &SparseAffineSystem, points: &[OperatingPoint], rectangle: Rectangle) -> (DMatrix<f64>, Vec<f64>) {
    let mut snapshots = Snapshots::new(system, rectangle, sparse::Options::default());
    points.iter().for_each(|at| snapshots.add(&snapshots.at(at).unwrap()).unwrap());
    snapshots.basis(1e-7, 200).unwrap()
}

/// A system on the orthonormal columns of a basis.
fn on(system: &SparseAffineSystem, basis: &DMatrix<f64>, rectangle: Rectangle) -> Reduced {
    let (projected, combinations) = (system.project(basis).unwrap(), Combinations::new(system, basis));
    let all = DMatrix::identity(basis.ncols(), basis.ncols());
    Reduced::within((&basis.clone().into(), &projected, &combinations), None, &all, rectangle, TOLERANCE).unwrap()
}

/// A system on a basis of its modes at some points.
fn of_points(system: &SparseAffineSystem, points: &[OperatingPoint]) -> Reduced {
    on(system, &basis(system, points, RECTANGLE).0, RECTANGLE)
}

#[test]
fn a_reduction_finds_the_modes_of_the_full_system_with_the_residual_that_it_says() {
    let system = plate();
    let large = dense(&system);
    let reduced = of_points(&system, &draws(12));
    assert!(reduced.basis().ncols() < N / 2);
    for at in &draws(32)[24..] {
        let (modes, expected) = (reduced.modes(at).unwrap(), truth(&large, at));
        assert_eq!(modes.lambdas.len(), expected.len());
        let full = large.assemble(at).unwrap();
        for (lambda, (y, &residual)) in modes.lambdas.iter().zip(modes.shapes.column_iter().zip(&modes.residuals)) {
            assert!(distance(*lambda, &expected) < 1e-6);
            let direct = backward_error(&full, *lambda, &reduced.lift(&y.into_owned()));
            assert!(residual >= direct && residual < 3.0 * direct + 1e-15, "{direct:e} {residual:e}");
            assert!(residual < 1e-6, "{residual:e}");
        }
    }
}

#[test]
fn modes_from_coarse_ones_are_those_of_the_whole_spectrum() {
    let system = plate();
    let reduced = of_points(&system, &draws(12)).with_coarse(&draws(24)).unwrap();
    assert!(reduced.coarse_columns().is_some_and(|columns| columns < reduced.basis().ncols()));
    for at in &draws(36)[24..] {
        let (found, all) = (reduced.modes(at).unwrap(), reduced.modes_by_spectrum(at).unwrap());
        assert_eq!(found.lambdas.len(), all.lambdas.len());
        for (one, other) in found.lambdas.iter().zip(&all.lambdas) {
            assert!((one - other).norm() < 1e-8 * one.norm(), "{one} {other}");
        }
        assert_eq!((found.route, all.route), (Route::Coarse, Route::Spectrum(None)));
    }
}

/// A state that is as stiff as the springs around it, and that itself may grow.
#[test]
fn modes_that_a_stiff_internal_state_moves_are_those_of_the_whole_spectrum() {
    let system = plate();
    let stiff = |mut at: OperatingPoint| {
        at.channels[0].lag = Some(Lag { decay: 6.0, drive: 40.0, force: -25.0 });
        at
    };
    let training: Vec<_> = draws(12).into_iter().map(stiff).collect();
    let reduced = of_points(&system, &training).with_coarse(&training).unwrap();
    for at in training {
        let (followed, all) = (reduced.modes(&at).unwrap(), reduced.modes_by_spectrum(&at).unwrap());
        assert_eq!(followed.lambdas.len(), all.lambdas.len(), "{:?} {all:?}", followed.lambdas);
        for (one, other) in followed.lambdas.iter().zip(&all.lambdas) {
            assert!((one - other).norm() < 1e-8 * one.norm(), "{one} {other}");
        }
    }
}

/// Residuals of any pairs on any basis: bounds that are not far above.
#[test]
fn residuals_on_any_basis_are_bounds() {
    let n = 3_000;
    let tridiagonal = |diagonal: f64, beside: f64| {
        let mut coo = CooMatrix::new(n, n);
        for i in 0..n {
            coo.push(i, i, diagonal + 0.1 * (i % 7) as f64);
            if i > 0 {
                coo.push(i, i - 1, beside);
                coo.push(i - 1, i, beside);
            }
        }
        CscMatrix::from(&coo)
    };
    let matrices =
        SparseSecondOrder::new(tridiagonal(1.0, 0.1), tridiagonal(0.02, 0.0), tridiagonal(2.0, -0.9)).unwrap();
    let term = SparseTerm { name: "chain".into(), family: "chain".into(), matrices, loss: 0.0 };
    let friction = Channel::new("friction", "friction", vec![(10, 1.0), (11, -1.0)], vec![(20, 3.0), (21, -3.0)]);
    let system = SparseAffineSystem::new(vec![term], vec![friction]).unwrap();
    let wave = |i: usize, j: usize| ((j + 1) as f64 * 0.37 * i as f64 + j as f64).sin();
    let basis = DMatrix::from_fn(n, 5, wave).qr().q();
    let at = OperatingPoint {
        coefficients: vec![1.3],
        channels: vec![ChannelGain { mu: 0.4, slope: -0.1, ..ChannelGain::default() }],
    };
    let reduced = on(&system, &basis, RECTANGLE);
    let full = system.assemble(&at).unwrap();
    for (turn, lambda) in
        [Complex::new(0.1, 1.2), Complex::new(-0.2, 3.0), Complex::new(0.0, 0.7)].into_iter().enumerate()
    {
        let y = DVector::from_fn(5, |i, _| Complex::new(((i + turn) % 3) as f64 - 0.6, (i % 2) as f64));
        let x = reduced.lift(&y);
        let times = |a: &CscMatrix<f64>| (a * x.map(|z| z.re)).zip_map(&(a * x.map(|z| z.im)), Complex::new);
        let image = times(&full.m) * (lambda * lambda) + times(&full.c) * lambda + times(&full.k);
        let norm = |a: &CscMatrix<f64>| a.values().iter().map(|value| value * value).sum::<f64>().sqrt();
        let size = lambda.norm_sqr() * norm(&full.m) + lambda.norm() * norm(&full.c) + norm(&full.k);
        let (direct, found) = (image.norm() / (size * x.norm()), reduced.residual(&at, lambda, &y).unwrap());
        assert!(found >= direct && found < 3.0 * direct, "{found:e} {direct:e}");
    }
}

#[test]
fn what_is_wrong_is_said() {
    let system = plate();
    let basis = DMatrix::identity(N, 3);
    let reduced = on(&system, &basis, RECTANGLE);
    let (combinations, all) = (Combinations::new(&system, &basis), DMatrix::identity(3, 3));
    let found =
        Reduced::within((&basis.into(), reduced.system(), &combinations), None, &all, RECTANGLE, 0.0).unwrap_err();
    assert_eq!(found.to_string(), "the tolerance of a reduction is 0; it must be above 0 and below 1");
    let found = reduced.residual(&draws(1)[0], Complex::new(0.0, 1.0), &DVector::zeros(2)).unwrap_err();
    assert_eq!(found.to_string(), "2 entries of the shape; expected 3");
    assert!(reduced.modes(&OperatingPoint::default()).is_err());
    // Without coarse modes the spectrum is taken.
    assert_eq!(reduced.modes(&draws(1)[0]).unwrap().route, Route::Spectrum(None));
}

/// The plate with a spring in its contact, which a coefficient closes or opens.
fn plate_with_a_spring() -> SparseAffineSystem {
    let plate = plate();
    let mut spring = CooMatrix::new(N, N);
    let reading = &plate.channels()[0].reading;
    add(&mut spring, reading, reading, 2e-3);
    let zero = || CscMatrix::zeros(N, N);
    let matrices = SparseSecondOrder::new(zero(), zero(), CscMatrix::from(&spring)).unwrap();
    let mut terms = plate.terms().to_vec();
    terms.push(SparseTerm { name: "spring".into(), family: "spring".into(), matrices, loss: 0.0 });
    SparseAffineSystem::new(terms, plate.channels().to_vec()).unwrap()
}

/// The plate at one speed: only friction and the spring of the contact differ.
fn contact(spring: f64, mu: f64, slope: f64, lag: f64) -> OperatingPoint {
    let lag = (lag != 0.0).then_some(Lag { decay: 40.0, drive: 3.0, force: lag });
    OperatingPoint { coefficients: vec![1.0, 1.0, 0.5, 0.5, spring], channels: vec![ChannelGain { mu, slope, lag }] }
}

/// A basis of modes of the plate, the plate on it, and how many of its first columns have all modes roughly.
fn of_modes(system: &SparseAffineSystem, points: &[OperatingPoint]) -> (DMatrix<f64>, AffineSystem, usize) {
    let (basis, values) = basis(system, points, RECTANGLE);
    let reduced = system.project(&basis).unwrap();
    (basis, reduced, values.iter().filter(|&&value| value > 1e-2).count())
}

/// Friction and internal states in a contact that is open or closed.
fn drawn(at: usize) -> OperatingPoint {
    let lag = if at.is_multiple_of(3) { -1.0 } else { 0.0 };
    contact((at % 2) as f64, 0.1 * (at % 7) as f64, -0.2 * (at % 5) as f64, lag)
}

/// `cargo test -p brake-squeal-reduction --test all reduction:: -- --ignored`
#[test]
#[ignore = "a minute"]
fn a_smaller_basis_within_holds_the_eigenvalues_of_one_arrangement() {
    let system = plate_with_a_spring();
    let large = dense(&system);
    let (basis, reduced, leading) = of_modes(&system, &(0..8).map(drawn).collect::<Vec<_>>());
    let open: Vec<OperatingPoint> = (0..12).map(|at| drawn(2 * at)).collect();
    let mut columns = Vec::new();
    for error in [1e-4, 1e-6, 1e-8] {
        let found = within((&reduced, leading), (RECTANGLE, &open), error).unwrap();
        assert!(found.missed.is_empty() && found.distance <= error, "{found:?}");
        let Within { basis: small, .. } = &found;
        assert!((small.tr_mul(small) - DMatrix::identity(small.ncols(), small.ncols())).amax() < 1e-12);
        let combinations = Combinations::new(&system, &basis);
        let of = (&basis.clone().into(), &reduced, &combinations);
        let small = Reduced::within(of, None, small, RECTANGLE, TOLERANCE).unwrap();
        // At the points and at others, against all eigenvalues of the plate.
        for at in (0..18).map(|at| drawn(2 * at)) {
            let (modes, expected) = (small.modes_by_spectrum(&at).unwrap(), truth(&large, &at));
            assert_eq!(modes.lambdas.len(), expected.len());
            let largest = modes.lambdas.iter().map(|&lambda| distance(lambda, &expected)).fold(0.0, f64::max);
            assert!(largest < 10.0 * error, "{largest:e} {error:e}");
        }
        columns.push(small.basis().ncols());
    }
    assert!(columns.is_sorted() && columns[0] < columns[2] && columns[2] < basis.ncols(), "{columns:?}");
}

/// Fewer and fewer columns of a basis of modes: what eigenvalues are off by at draws is told by an estimate that needs no whole spectrum of it.
#[test]
fn errors_on_a_smaller_basis_are_estimated() {
    let system = plate_with_a_spring();
    let (_, reduced, leading) = of_modes(&system, &(0..6).map(drawn).collect::<Vec<_>>());
    let further = [drawn(8), drawn(10)];
    let mut estimates = Vec::new();
    for columns in [leading + 10, leading + 20, leading + 30] {
        let small = DMatrix::identity(reduced.order(), columns.min(reduced.order()));
        let estimate = error_within((&reduced, &small), (RECTANGLE, &further)).unwrap();
        let on_small = reduced.projected(&small).unwrap();
        let of_point = |at: &OperatingPoint| {
            let expected = truth(&reduced, at);
            truth(&on_small, at).into_iter().map(|lambda| distance(lambda, &expected)).fold(0.0, f64::max)
        };
        let largest = further.iter().map(of_point).fold(0.0, f64::max);
        assert!(
            estimate > 0.2 * largest && estimate < 5.0 * largest + 1e-12,
            "{columns}: {estimate:e} for {largest:e}"
        );
        estimates.push(estimate);
    }
    assert!(estimates[2] < estimates[0] && estimates[0] > 1e-9, "{estimates:?}");
}

/// First columns so few that modes are missing or far away: the smaller basis has all modes of the larger one all the same.
#[test]
fn a_poor_start_hides_no_mode_from_a_smaller_basis() {
    let system = plate_with_a_spring();
    let (basis, reduced, leading) = of_modes(&system, &(0..8).map(drawn).collect::<Vec<_>>());
    let points: Vec<OperatingPoint> = (0..6).map(drawn).collect();
    let combinations = Combinations::new(&system, &basis);
    let mut smaller = 0;
    for leading in [1, leading / 4, leading / 2, leading, basis.ncols()] {
        let found = within((&reduced, leading), (RECTANGLE, &points), 1e-6).unwrap();
        let of = (&basis.clone().into(), &reduced, &combinations);
        let small = Reduced::within(of, None, &found.basis, RECTANGLE, TOLERANCE).unwrap();
        let has_all = |at| small.modes_by_spectrum(at).unwrap().lambdas.len() == truth(&reduced, at).len();
        assert!(points.iter().all(has_all), "{leading}");
        smaller += usize::from(found.basis.ncols() < basis.ncols());
    }
    assert!(smaller >= 3, "{smaller}");
    // An error that nothing reaches is reached by all of the larger basis.
    let all = within((&reduced, leading), (RECTANGLE, &points), 0.0).unwrap();
    assert_eq!((all.basis.ncols(), all.distance), (basis.ncols(), 0.0));
    let none = within((&reduced, leading), (RECTANGLE, &[]), 1e-6);
    assert_eq!(none.unwrap_err().to_string(), reduction::ReductionError::NoModes.to_string());
}

/// Residuals on any basis within a larger one by combinations that are known for that: bounds, whatever is left out.
#[test]
fn residuals_on_a_basis_within_are_bounds() {
    let system = plate_with_a_spring();
    let (basis, reduced, _) = of_modes(&system, &(0..8).map(drawn).collect::<Vec<_>>());
    let combinations = Combinations::new(&system, &basis);
    for columns in [5, basis.ncols() / 2, basis.ncols()] {
        let first = DMatrix::identity(basis.ncols(), columns);
        let of = (&basis.clone().into(), &reduced, &combinations);
        let small = Reduced::within(of, None, &first, RECTANGLE, TOLERANCE).unwrap();
        let at = drawn(3);
        let full = dense(&system).assemble(&at).unwrap();
        for number in 0..6 {
            let lambda = Complex::new(-0.1, 1.0 + 2.0 * f64::from(number));
            let y = DVector::from_fn(columns, |i, _| Complex::from_polar(1.0, (i * i + 3) as f64 * lambda.im));
            let direct = backward_error(&full, lambda, &small.lift(&y));
            let found = small.residual(&at, lambda, &y).unwrap();
            assert!(found >= direct && found < 3.0 * direct, "{found:e} {direct:e}");
        }
    }
}

#[test]
fn a_mode_is_found_however_much_faster_than_the_rectangle_it_grows() {
    let (system, large) = (plate(), dense(&plate()));
    // Friction up to twelve times that of the other tests.
    let strong = |at: &OperatingPoint, by: f64| {
        let mut at = at.clone();
        at.coefficients[3] *= by;
        at
    };
    for (limit, by) in [(0.01, 4.0), (0.05, 12.0)] {
        let points: Vec<OperatingPoint> = draws(12).iter().map(|at| strong(at, by)).collect();
        let fast = Rectangle { re: [-0.6, 20.0], ..RECTANGLE };
        let reduced = on(&system, &basis(&system, &points, fast).0, Rectangle { re: [-0.6, limit], ..RECTANGLE });
        let mut fastest = 0.0_f64;
        for at in draws(20)[12..].iter().map(|at| strong(at, by)) {
            let spectrum = QrSolver.eigenvalues(&large.assemble(&at).unwrap(), &mut Workspace::default()).unwrap();
            let is_wanted = |l: &Complex<f64>| l.re >= 0.0 && (0.5..=12.0).contains(&l.im);
            let expected: Vec<Complex<f64>> = spectrum.eigenvalues.into_iter().filter(is_wanted).collect();
            let found: Vec<Complex<f64>> = reduced.modes(&at).unwrap().lambdas.into_iter().filter(is_wanted).collect();
            assert_eq!(found.len(), expected.len(), "{limit} {by}: {found:?} {expected:?}");
            assert!(found.iter().all(|lambda| distance(*lambda, &expected) < 1e-4), "{limit} {by}");
            fastest = expected.iter().map(|lambda| lambda.re).fold(fastest, f64::max);
        }
        assert!(fastest > 2.0 * limit, "{limit} {by}: {fastest}");
    }
}

#[test]
fn an_eigenvalue_is_found_from_a_poor_neighbour_where_stiff_parts_hide_its_residual() {
    let system = plate();
    // Constraints by penalty make all residuals small, relative to the matrices: from 1e3 to 1e9 times the springs.
    for (draw, at) in draws(6).into_iter().enumerate() {
        let mut at = at;
        at.channels[0].lag = None;
        let SparseSecondOrder { m, c, k, .. } = system.assemble(&at).unwrap();
        let mut penalty = CooMatrix::new(N, N);
        for row in 1..4 {
            let pair = [(dof(row, 2, 0), 1.0), (dof(row + 6, 7, 0), -1.0)];
            add(&mut penalty, &pair, &pair, 10_f64.powi(4 + i32::try_from(draw).unwrap()) * 400.0);
        }
        let k = &k + &CscMatrix::from(&penalty);
        let dense = linsys::SecondOrder::new(DMatrix::from(&m), DMatrix::from(&c), DMatrix::from(&k)).unwrap();
        let problem = sparse::Problem::new(&SparseSecondOrder::new(m, c, k).unwrap()).unwrap();
        let mut work = Workspace::default();
        let all = QrSolver.eigenvalues(&dense, &mut work).unwrap().eigenvalues;
        let wanted: Vec<Complex<f64>> = all.iter().copied().filter(|l| (0.5..8.0).contains(&l.im)).collect();
        let shapes = cea::right_vectors(&dense, &wanted, &mut work).unwrap();
        for (number, (&lambda, shape)) in wanted.iter().zip(&shapes).enumerate() {
            let apart = |other: &&Complex<f64>| (**other - lambda).norm() > 1e-9 * lambda.norm();
            let gap = all.iter().filter(apart).map(|other| (other - lambda).norm()).fold(f64::INFINITY, f64::min);
            let start = lambda + Complex::from_polar(0.1 * gap, number as f64);
            let noise = |i: usize| Complex::new((17.0 * i as f64 + number as f64).sin(), (5.0 * i as f64).cos());
            let shape = shape.normalize() + DVector::from_fn(N, |i, _| noise(i) * 1e-3);
            let found = problem.eigenpair_near(start, &shape, 1e-13).unwrap();
            assert!((found.lambda - lambda).norm() < 1e-3 * gap + 1e-7 * lambda.norm(), "{draw}: {lambda} {found:?}");
            assert!(found.backward_error < 1e-14, "{draw}: {lambda} {:e}", found.backward_error);
        }
    }
}
