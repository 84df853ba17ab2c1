//! Sweeps of a brake whose contact points open and close at values that are known, against spectra by another eigensolver.

use linsys::SecondOrder;
use montecarlo::StreamRng;
use nalgebra::DMatrix;
use num_complex::Complex;
use study::{NamedParameter, Plan, Scene};

use super::*;

/// State of a contact point over p.
#[derive(Clone, Copy)]
struct Point {
    /// Value of p at which it opens or closes.
    at: f64,
    /// True if it is closed below.
    below: bool,
    /// True if its stiffness goes to zero where it opens.
    fades: bool,
}

impl Point {
    fn is_closed(self, p: f64) -> bool {
        (p < self.at) == self.below
    }

    /// Stiffness of the point, N/m.
    fn stiffness(self, p: f64) -> f64 {
        match (self.is_closed(p), self.fades) {
            (false, _) => 0.0,
            (true, false) => 0.6,
            (true, true) => 1.5 * (p - self.at).abs(),
        }
    }
}

const POINTS: [Point; 4] = [
    Point { at: 0.31, below: true, fades: false },
    Point { at: 0.47, below: true, fades: true },
    Point { at: 0.62, below: true, fades: false },
    Point { at: 0.8, below: false, fades: false },
];

/// Chain of five masses of which four have a contact point, with friction p that couples two neighbours.
struct Chain(MatricesBrake);

impl Chain {
    fn new() -> Self {
        let mut text = String::from(
            "[study]\nname = \"chain\"\nsamples = 1\nseed = 1\n[brake]\nkind = \"matrices\"\n\
             dofs = [\"a\", \"b\", \"c\", \"d\", \"e\"]\n[parameters.p]\ndistribution = \"uniform\"\nfrom = 0.0\nto = 1.0\n",
        );
        for (at, point) in POINTS.iter().enumerate() {
            text += &format!("[parameters.s{at}]\ndistribution = \"constant\"\nvalue = {}\n", point.stiffness(0.5));
        }
        let rows = |of: &dyn Fn(usize, usize) -> f64| {
            let row = |i: usize| format!("{:?}", (0..5).map(|j| of(i, j)).collect::<Vec<_>>());
            (0..5).map(row).collect::<Vec<_>>().join(", ")
        };
        let ground = [4.0, 4.6, 6.5, 8.7, 11.9];
        let chain = |i: usize, j: usize| match i.abs_diff(j) {
            0 => ground[i],
            1 => -0.25,
            _ => 0.0,
        };
        let identity = |scale: f64| move |i: usize, j: usize| if i == j { scale } else { 0.0 };
        text += &format!(
            "[[terms]]\nname = \"chain\"\nmass = [{}]\ndamping = [{}]\nstiffness = [{}]\n",
            rows(&identity(1.0)),
            rows(&identity(0.02)),
            rows(&chain)
        );
        let couples = |i: usize, j: usize| match (i, j) {
            (0, 1) => 1.0,
            (1, 0) => -1.0,
            _ => 0.0,
        };
        text += &format!(
            "[[terms]]\nname = \"friction\"\ncoefficient = \"p\"\nsymmetry = \"whole\"\nstiffness = [{}]\n",
            rows(&couples)
        );
        for at in 0..POINTS.len() {
            let spring = move |i: usize, j: usize| if (i, j) == (at, at) { 1.0 } else { 0.0 };
            text += &format!(
                "[[terms]]\nname = \"contact {at}\"\ncoefficient = \"s{at}\"\nstiffness = [{}]\n",
                rows(&spring)
            );
        }
        Self(MatricesBrake::new(written(&text)).unwrap())
    }

    fn system(&self, p: f64) -> SecondOrder {
        self.system_with(&self.plan().scenes[0], &[(0, p)]).unwrap()
    }
}

impl UncertainBrake for Chain {
    type Sample = <MatricesBrake as UncertainBrake>::Sample;

    fn plan(&self) -> &Plan {
        self.0.plan()
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<Self::Sample, study::Error> {
        self.0.draw(rng)
    }

    fn median(&self) -> Self::Sample {
        self.0.median()
    }

    fn operating_point(&self, scene: &Scene, sample: &Self::Sample) -> Result<linsys::OperatingPoint, study::Error> {
        self.0.operating_point(scene, sample)
    }

    fn parametrised(&self) -> Option<&dyn Parametrised> {
        Some(self)
    }
}

impl Parametrised for Chain {
    fn parameters(&self, _: &Scene) -> Vec<NamedParameter> {
        let of = |name: &str, median: f64| NamedParameter { name: name.into(), unit: "1".into(), median };
        vec![of("p", 0.5), of("damping", 1.0)]
    }

    fn system_with(&self, scene: &Scene, values: &[(usize, f64)]) -> Result<SecondOrder, study::Error> {
        let [p, damping] = [0, 1].map(|place| values.iter().find(|(at, _)| *at == place).map(|(_, value)| *value));
        let (p, damping) = (p.unwrap_or(0.5), damping.unwrap_or(1.0));
        let all = self.0.parameters(scene);
        let place = |name: &str| all.iter().position(|parameter| parameter.name == name).unwrap();
        let springs = POINTS.iter().enumerate().map(|(at, point)| (place(&format!("s{at}")), point.stiffness(p)));
        let values: Vec<_> = [(place("p"), p)].into_iter().chain(springs).collect();
        let system = self.0.system_with(scene, &values)?;
        Ok(SecondOrder { c: system.c * damping, ..system })
    }

    fn contact_points(&self, _: &Scene) -> Vec<String> {
        (0..POINTS.len()).map(|at| format!("point {at}")).collect()
    }

    fn closed_points(&self, _: &Scene, values: &[(usize, f64)]) -> Result<Vec<bool>, study::Error> {
        let p = values.iter().find(|(at, _)| *at == 0).map_or(0.5, |(_, p)| *p);
        Ok(POINTS.iter().map(|point| point.is_closed(p)).collect())
    }
}

/// Eigenvalues with Im > 0, by the Schur decomposition of the companion matrix.
fn dense(system: &SecondOrder) -> Vec<Complex<f64>> {
    let n = system.order();
    let mut companion = DMatrix::zeros(2 * n, 2 * n);
    let inverse = system.m.clone().try_inverse().unwrap();
    companion.view_mut((0, n), (n, n)).fill_with_identity();
    companion.view_mut((n, 0), (n, n)).copy_from(&(-&inverse * &system.k));
    companion.view_mut((n, n), (n, n)).copy_from(&(-&inverse * &system.c));
    companion.complex_eigenvalues().iter().copied().filter(|lambda| lambda.im > 0.0).collect()
}

/// The eigenvalue of each branch at a value of p.
fn on_branches(found: &Sweep, p: f64) -> Vec<(String, Complex<f64>)> {
    let of = |branch: &sweep::NamedBranch| {
        let step = branch.points.windows(2).position(|step| step[0].0 <= p && p <= step[1].0)?;
        let [from, to] = [branch.points[step].0, branch.points[step + 1].0];
        Some((branch.mode.clone(), branch.between(step, (p - from) / (to - from)).1))
    };
    found.branches.iter().filter_map(of).collect()
}

/// Openings are found to the last bits; branches on both sides are those of spectra, go on through a point that fades, and end at one that
/// takes its stiffness with it; and the modes keep their names, whichever range is asked for.
#[test]
fn branches_are_smooth_between_openings_and_jump_there_as_spectra_do() {
    let chain = Chain::new();
    let whole = swept(&chain, &over("p", 0.0, 1.0));
    let names = |found: &Sweep, p: f64| {
        let mut all: Vec<String> = on_branches(found, p).into_iter().map(|(mode, _)| mode).collect();
        all.sort();
        all
    };
    for (from, to) in [(0.0, 1.0), (0.55, 0.95), (0.1, 0.4)] {
        let found = if from == 0.0 { whole.clone() } else { swept(&chain, &over("p", from, to)) };
        println!("{}", sweep::Found::Branches(found.clone().into()).text());
        let expected: Vec<(usize, &Point)> =
            POINTS.iter().enumerate().filter(|(_, point)| from < point.at && point.at < to).collect();
        assert_eq!(found.openings.len(), expected.len(), "{:?}", found.openings);
        assert!(found.unresolved.is_empty() && found.opening_steps.is_some());
        for (opening, (at, point)) in found.openings.iter().zip(expected) {
            assert!((opening.at - point.at).abs() < 1e-13 && opening.width < 1e-13, "{opening:?}");
            let changed = vec![format!("point {at}")];
            let [changes, none] =
                if point.below { [&opening.opens, &opening.closes] } else { [&opening.closes, &opening.opens] };
            assert_eq!((changes, none.len()), (&changed, 0));
            // At 0.31 the spring comes off next to a coalescence: which of two modes is which beyond is open, and said.
            assert_eq!(opening.unresolved, if point.at == 0.31 { [2; 2] } else { [0; 2] });
            assert_eq!(opening.continuous + opening.jumping + opening.unresolved[0], 5);
            assert_eq!(opening.jumping == 0, point.fades, "{opening:?}");
            let goes_on = |branch: &&sweep::NamedBranch| {
                branch.points[0].0 < point.at && point.at < branch.points.last().unwrap().0
            };
            assert_eq!(found.branches.iter().filter(goes_on).count(), opening.continuous);
            for step in 1..=10 {
                for p in [-1.0, 1.0].map(|side| point.at + side * 0.004 * f64::from(step)) {
                    let spectrum = dense(&chain.system(p));
                    let branches = on_branches(&found, p);
                    assert_eq!(branches.len(), spectrum.len(), "{p}");
                    for lambda in &spectrum {
                        let distance = |(_, of): &(String, Complex<f64>)| (of - lambda).norm();
                        let nearest = branches.iter().map(distance).fold(f64::INFINITY, f64::min);
                        // Between its points a branch is the cubic with their derivatives, which next to a coalescence is not exact.
                        assert!(nearest < 1e-3, "{p}: {lambda} is off by {nearest:e}");
                    }
                    let unstable = spectrum.iter().filter(|lambda| lambda.re > 0.0).count();
                    let before = found.onsets.iter().rfind(|onset| onset.at < p);
                    assert_eq!(before.map_or(found.unstable_at_start, |onset| onset.unstable), unstable, "{p}");
                    assert_eq!(names(&found, p), names(&whole, p), "{p}");
                }
            }
        }
        for branch in &found.branches {
            for (p, point) in &branch.points {
                let distance = |lambda: &Complex<f64>| (lambda - point.lambda).norm();
                let nearest = dense(&chain.system(*p)).iter().map(distance).fold(f64::INFINITY, f64::min);
                // Next to a coalescence rounding moves eigenvalues by its root.
                assert!(nearest < 1e-9, "{p}: {nearest:e}");
            }
        }
    }
}

/// A map over openings rests on lines and says so; each of its cells has the number of unstable modes of a spectrum, but next to a change over the
/// other parameter by half a line.
#[test]
fn maps_with_openings_count_as_spectra_do() {
    let chain = Chain::new();
    for swapped in [false, true] {
        let mut asked = [over("p", 0.0, 1.0), over("damping", 0.5, 8.0)];
        if swapped {
            asked.reverse();
        }
        let map = mapped(&chain, &asked);
        println!("{}", sweep::Found::Map(map.clone().into()).text());
        let lines = map.lines.as_ref().unwrap();
        assert_eq!((lines.along, lines.openings), (usize::from(swapped), 4 * lines.lines));
        // The flutter that the opening at 0.31 ends.
        let at_first = |change: &&sweep::LineChange| (change.at[usize::from(swapped)] - 0.31).abs() < 1e-13;
        assert!(lines.changes.iter().filter(at_first).all(|change| change.of.is_none() && change.by == -1));
        assert!(lines.changes.iter().any(|change| at_first(&change)));
        let scene = &chain.plan().scenes[0];
        let (mut wrong, mut count) = (0, 0);
        for run in map.rows.iter().filter(|run| run.row % 12 == 5) {
            let y = (run.row as f64 + 0.5) / 240.0;
            let x = 0.5 * (run.x[0] + run.x[1]);
            let parts = if swapped { [y, x] } else { [x, y] };
            let system = chain.system_with(scene, &[(0, parts[0]), (1, 0.5 + 7.5 * parts[1])]).unwrap();
            count += 1;
            wrong += usize::from(dense(&system).iter().filter(|lambda| lambda.re > 0.0).count() != run.unstable);
        }
        println!("{wrong} of {count}");
        assert!(wrong * 20 <= count, "{wrong} of {count}");
    }
}

/// Words, JSON and tables of a sweep over openings, by any number of threads, often enough that they come in another order.
#[test]
fn answers_over_openings_are_the_same_bytes_with_any_number_of_threads() {
    let chain = Chain::new();
    let told = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = sweep::Found::Branches(pool.install(|| swept(&chain, &over("p", 0.0, 1.0))).into());
        let tables = found.tables().into_iter().map(|table| String::from_utf8(table.csv().unwrap()).unwrap());
        format!("{}{}{}", found.text(), found.json(), tables.collect::<String>())
    };
    let one = told(1);
    for threads in [2, 8].repeat(10) {
        assert_eq!(told(threads), one, "{threads} threads");
    }
}

/// Over ranges in equal steps and in equal ratios: no point that is open for longer than is printed is passed over.
#[test]
fn the_width_that_is_printed_is_that_of_every_step() {
    for (from, to, said) in [(0.0, 1.0, "9.766e-4 of p"), (0.02, 1.0, "a factor of 1.003828 of p")] {
        let found = swept(&Chain::new(), &over("p", from, to));
        let parameter = found.parameter.clone();
        let text = sweep::Found::Branches(found.into()).text();
        assert!(text.contains(&format!("open and close again within {said} are not seen")), "{text}");
        let width = |step: u32| {
            let [a, b] = [step, step + 1].map(|end| parameter.at(f64::from(end) / 1024.0));
            if parameter.is_logarithmic { b / a } else { b - a }
        };
        let number: f64 = said.split_whitespace().find_map(|word| word.parse().ok()).unwrap();
        for step in 0..1024 {
            assert!((width(step) / number - 1.0).abs() < 1e-3, "{step}: {} for {number}", width(step));
        }
    }
}
