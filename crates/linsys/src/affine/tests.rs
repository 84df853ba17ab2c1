use super::*;
use nalgebra::dmatrix;
use num_complex::Complex;

fn brake() -> AffineSystem {
    let structure =
        SecondOrder::new(dmatrix![2.0, 0.0; 0.0, 3.0], dmatrix![0.1, 0.0; 0.0, 0.2], dmatrix![40.0, -9.0; -9.0, 70.0]);
    let zero = || DMatrix::zeros(2, 2);
    let gyroscopic = SecondOrder::new(zero(), dmatrix![0.0, 1.0; -1.0, 0.0], zero());
    let follower = SecondOrder::new(zero(), zero(), dmatrix![0.0, 5.0; -5.0, 0.0]);
    let terms = vec![
        Term::new("structure", "damping", structure.unwrap()).unwrap(),
        Term::new("gyroscopic", "gyroscopic", gyroscopic.unwrap()).unwrap(),
        Term::new("follower", "follower", follower.unwrap()).unwrap(),
    ];
    let channel = |name: &str, force, reading| Channel::new(name, "friction", force, reading);
    let channels = vec![
        channel("first", vec![(0, 1.0)], vec![(1, 7.0)]),
        channel("second", vec![(0, -1.0), (1, 1.0)], vec![(0, 2.0), (1, -3.0)]),
    ];
    AffineSystem::new(terms, channels).unwrap()
}

fn point() -> OperatingPoint {
    let lag = Some(Lag { decay: 30.0, drive: -0.2, force: 11.0 });
    OperatingPoint {
        coefficients: vec![1.0, 0.7, -0.4],
        channels: vec![ChannelGain { mu: 0.3, slope: -0.5, lag }, ChannelGain { mu: 0.6, slope: 0.8, lag: None }],
    }
}

#[test]
fn the_system_is_the_formula_at_any_lambda() {
    let (brake, at, lambda) = (brake(), point(), Complex::new(0.3, 2.1));
    let mut expected = DMatrix::<Complex<f64>>::zeros(2, 2);
    for (term, &theta) in brake.terms().iter().zip(&at.coefficients) {
        expected += term.matrices().dynamic_stiffness(lambda) * Complex::from(theta);
    }
    let (force, reading) = (brake.force_matrix(), brake.reading_matrix());
    for (i, gain) in at.channels.iter().enumerate() {
        let b = force.column(i).map(Complex::from);
        let r = reading.row(i).map(Complex::from);
        expected += &b * (r * Complex::from(gain.mu) + b.transpose() * (lambda * gain.complex_slope(lambda)));
    }
    let system = brake.assemble(&at).unwrap();
    assert_eq!(system.states(), 1);
    assert!((system.dynamic_stiffness(lambda) - &expected).norm() < 1e-13);
    // The same force given in two halves is the same channel.
    let mut channels = brake.channels().to_vec();
    channels[0].force = vec![(0, 0.25), (0, 0.75)];
    let halves = AffineSystem::new(brake.terms().to_vec(), channels).unwrap().assemble(&at).unwrap();
    assert!((halves.dynamic_stiffness(lambda) - expected).norm() < 1e-13);
}

#[test]
fn families_leave_out_what_is_elastic_and_make_up_the_rest() {
    let (brake, at) = (brake(), point());
    assert_eq!(brake.families(), ["friction", "damping", "gyroscopic", "follower"]);
    let whole = brake.assemble(&at).unwrap();
    let (mut c, mut k) = (DMatrix::zeros(2, 2), brake.terms()[0].matrices().k.clone());
    let mut part = SecondOrder::zeros(1, 0);
    for family in brake.families() {
        brake.family_into(family, &at, &mut part).unwrap();
        assert_eq!(part.m.amax(), 0.0);
        assert_eq!(part.states(), usize::from(family == "friction"));
        c += &part.c;
        k += &part.k;
    }
    assert!((c - whole.c).amax() < 1e-14 && (k - whole.k).amax() < 1e-13);
}

#[test]
fn forces_of_families_are_those_of_their_matrices() {
    let (brake, at, lambda) = (brake(), point(), Complex::new(0.3, 2.1));
    let phi = DVector::from_vec(vec![Complex::new(0.7, -0.2), Complex::new(-0.4, 1.1)]);
    let forces = brake.family_forces(&at, lambda, &phi).unwrap();
    let mut part = SecondOrder::zeros(1, 0);
    for (family, force) in brake.families().iter().zip(forces) {
        brake.family_into(family, &at, &mut part).unwrap();
        let expected = -(part.dynamic_stiffness(lambda) * &phi);
        assert!((&force - &expected).norm() < 1e-14 * (1.0 + expected.norm()), "{family}");
    }
    let short = brake.family_forces(&at, lambda, &DVector::zeros(1));
    assert_eq!(short, Err(LinsysError::Count { what: "entries of a shape", found: 1, expected: 2 }));
}

#[test]
fn channels_one_by_one_make_up_friction() {
    let (brake, at, lambda) = (brake(), point(), Complex::new(0.3, 2.1));
    let (mut one, mut all) = (SecondOrder::zeros(1, 0), SecondOrder::zeros(1, 0));
    let mut sum = DMatrix::zeros(2, 2);
    for channel in 0..2 {
        brake.channel_into(channel, &at, &mut one).unwrap();
        assert_eq!(one.states(), usize::from(channel == 0));
        sum += one.dynamic_stiffness(lambda);
    }
    brake.friction_into(&at, &mut all).unwrap();
    assert!((sum - all.dynamic_stiffness(lambda)).norm() < 1e-13);
    let none = brake.channel_into(2, &at, &mut one);
    assert_eq!(none, Err(LinsysError::NoChannel { channel: 2, total: 2 }));
}

#[test]
fn a_used_buffer_gives_what_a_fresh_one_gives() {
    let (brake, mut other) = (brake(), point());
    other.channels[0].lag = None;
    let mut buffer = SecondOrder::zeros(5, 3);
    for at in [&point(), &other, &point()] {
        brake.assemble_into(at, &mut buffer).unwrap();
        assert_eq!(buffer, brake.assemble(at).unwrap());
    }
}

#[test]
fn says_what_is_wrong() {
    let brake = brake();
    let message = |change: &dyn Fn(&mut OperatingPoint)| {
        let mut at = point();
        change(&mut at);
        brake.assemble(&at).unwrap_err().to_string()
    };
    assert_eq!(message(&|at| at.coefficients.truncate(1)), "1 term coefficients; expected 3");
    assert_eq!(message(&|at| at.channels.clear()), "0 channel gains; expected 2");
    let not_finite = message(&|at| at.coefficients[1] = f64::NAN);
    assert_eq!(not_finite, "the coefficient of the term \"gyroscopic\" is NaN; it must be finite");
    let not_finite = message(&|at| at.channels[1].mu = f64::INFINITY);
    assert_eq!(not_finite, "the channel \"second\" has a number that is not finite");
    let outside = Channel::new("pad", "friction", vec![(2, 1.0)], Vec::new());
    let refused = AffineSystem::new(brake.terms().to_vec(), vec![outside]);
    assert_eq!(refused, Err(LinsysError::UnknownDof { dof: 2, total: 2 }));
    assert_eq!(AffineSystem::new(Vec::new(), Vec::new()), Err(LinsysError::Empty));
}

#[test]
fn what_is_held_leaves_every_term_and_channel() {
    let (brake, at, lambda) = (brake(), point(), Complex::new(0.3, 2.1));
    let whole = brake.assemble(&at).unwrap().dynamic_stiffness(lambda);
    for held in [0, 1] {
        let dofs = crate::DofMap::new(2, &[held]).unwrap();
        let part = brake.on(&dofs).unwrap().assemble(&at).unwrap().dynamic_stiffness(lambda);
        assert_eq!((part.nrows(), part.ncols()), (1, 1));
        assert!((part[(0, 0)] - whole[(1 - held, 1 - held)]).norm() < 1e-13);
    }
    let expected = LinsysError::Count { what: "degrees of freedom", found: 3, expected: 2 };
    assert_eq!(brake.on(&crate::DofMap::all(3)), Err(expected));
}
