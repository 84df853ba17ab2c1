//! The folder of a study is continued by the same study alone, whatever kind of brake it is.

#![allow(clippy::unwrap_used)] // Test code, which the lints do not recognise outside test functions.

use std::path::Path;

use brakes::case::{CaseFile, FiniteElementCase, LatticeCase, MatricesCase};
use cea::Threshold;
use linsys::{AffineSystem, Channel, ChannelGain, OperatingPoint, SecondOrder, Term};
use montecarlo::{Distribution, StreamRng};
use nalgebra::dmatrix;
use osc_model::{Body, Brake};
use squeal::screen::{ChangeKind, Confirmation, ScreenOptions, confirm, rank};
use squeal::study::{Plan, Scene, UncertainBrake};
use squeal::{Error, RunOptions, run_study, run_study_with};

/// A mass that slides in x and is pressed in z.
#[derive(Clone)]
struct SlidingMass {
    plan: Plan,
    mu: Distribution,
    /// Of the falling coefficient, Ns/m.
    slope: f64,
    /// Error of the reduction that it is taken for.
    error: f64,
}

fn at(mu: f64, slope: f64) -> OperatingPoint {
    OperatingPoint { coefficients: vec![1.0], channels: vec![ChannelGain { mu, slope, lag: None }] }
}

const MU: Distribution = Distribution::Uniform { from: 0.5, to: 1.1 };

impl SlidingMass {
    fn new(mu: Distribution, slope: f64, stiffness: f64) -> Self {
        let k = dmatrix![2.0, 1.0; 1.0, stiffness];
        let structure = SecondOrder::new(dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![0.05, 0.0; 0.0, 0.05], k).unwrap();
        let pad = Channel::new("pad", "friction", vec![(0, 1.0)], vec![(1, -4.0 / 3.0)]);
        let system = AffineSystem::new(vec![Term::new("mass", "dashpots", structure).unwrap()], vec![pad]).unwrap();
        let naming_point = at(mu.median(), slope);
        Self { plan: Plan::single("sliding mass", Brake::new(system), naming_point, 64, 3), mu, slope, error: 0.0 }
    }

    fn right() -> Self {
        Self::new(MU, -0.01, 2.0)
    }
}

impl UncertainBrake for SlidingMass {
    type Sample = f64;

    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn draw(&self, rng: &mut StreamRng) -> Result<f64, squeal::study::Error> {
        Ok(self.mu.draw(rng)?)
    }

    fn median(&self) -> f64 {
        self.mu.median()
    }

    fn operating_point(&self, _: &Scene, mu: &f64) -> Result<OperatingPoint, squeal::study::Error> {
        Ok(at(*mu, self.slope))
    }

    fn error_of_reduction(&self, _: &Scene) -> f64 {
        self.error
    }
}

/// What a refusal says, in one line.
fn refused<T: std::fmt::Debug>(found: Result<T, impl Into<Error>>) -> String {
    let error = found.map_err(Into::into).unwrap_err();
    assert!(matches!(error, Error::OtherStudy { .. }), "{error}");
    let line = error.to_string();
    assert!(!line.contains('\n') && line.contains("allowed: a new or empty folder"), "{line}");
    line
}

/// The same brake with one thing changed, and what a refusal says of it.
fn others() -> Vec<(SlidingMass, &'static str)> {
    let mut all = vec![
        // The median is the same, so that nothing of the plan tells them apart.
        (SlidingMass::new(Distribution::Uniform { from: 0.79, to: 0.81 }, -0.01, 2.0), "other draws"),
        (
            SlidingMass::new(Distribution::Uniform { from: 0.5, to: 1.1001 }, -0.01, 2.0),
            "other equations and other draws",
        ),
        (
            SlidingMass::new(
                Distribution::Normal { mean: 0.8, deviation: 0.1, at_least: 0.0, at_most: None },
                -0.01,
                2.0,
            ),
            "other draws",
        ),
        (SlidingMass::new(MU, -0.02, 2.0), "other equations and other draws"),
        (SlidingMass::new(MU, -0.01, 2.1), "other equations"),
        (SlidingMass { error: 1e-3, ..SlidingMass::right() }, "other errors"),
    ];
    let mut with = |change: &dyn Fn(&mut Plan), said| {
        let mut brake = SlidingMass::right();
        change(&mut brake.plan);
        all.push((brake, said));
    };
    with(&|plan| plan.threshold = Threshold::new(0.05, 0.0).unwrap(), "growth_above 0, not growth_above 0.05");
    with(
        &|plan| plan.threshold = Threshold::new(0.0, -0.01).unwrap(),
        "damping_ratio_below 0, not damping_ratio_below -0.01",
    );
    with(&|plan| plan.seed = 4, "seed 3, not seed 4");
    with(&|plan| plan.name = "another".into(), "the study \"sliding mass\", not \"another\"");
    with(&|plan| plan.identity = "revision 2".into(), "other identity");
    with(&|plan| plan.band = Some([0.1, 10.0]), "other modes");
    with(&|plan| plan.scenes[0].wants_work = false, "other scenes");
    with(
        &|plan| {
            let body = |name: &str, dof| Body { name: name.into(), dofs: vec![dof] };
            std::sync::Arc::make_mut(&mut plan.configurations[0].brake).bodies = vec![body("x", 0), body("z", 1)];
        },
        "other equations",
    );
    let mut law = SlidingMass::right();
    let mut second = law.plan.scenes[0].clone();
    law.plan.labels.laws.push(law.plan.labels.laws[0].clone());
    second.key.law = 1;
    law.plan.scenes.push(second);
    all.push((law, "other scenes and other draws"));
    all
}

#[test]
fn a_folder_of_another_study_of_an_own_type_is_refused_by_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("study");
    let run = |brake: &SlidingMass| run_study(brake, &dir, None, &mut |_, _, _| Ok(()));
    let right = SlidingMass::right();
    run(&right).unwrap();
    let before = std::fs::read(dir.join("occurrence.csv")).unwrap();
    for (mut other, said) in others() {
        for samples in [64, 128] {
            other.plan.samples = samples;
            let line = refused(run(&other));
            assert!(line.contains(&format!("{said}; allowed")), "{said}: {line}");
        }
    }
    let options = RunOptions::default().keeping_samples(true);
    let line = refused(run_study_with(&right, &dir, options, &mut |_, _, _| Ok::<(), Error>(())));
    assert!(line.contains("no samples"), "{line}");
    assert_eq!(std::fs::read(dir.join("occurrence.csv")).unwrap(), before);
    let mut more = right;
    more.plan.samples = 128;
    run(&more).unwrap();
}

#[test]
fn a_folder_of_an_older_version_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("study");
    let run = || run_study(&SlidingMass::right(), &dir, None, &mut |_, _, _| Ok(()));
    run().unwrap();
    let marker = dir.join("study.txt");
    let own = std::fs::read_to_string(&marker).unwrap();
    for (line, said) in [
        ("\"sliding mass\" 1a7ba1d33d0f5a2e seed 3 format 6\n".to_owned(), "another version of this program"),
        (own.replace("version=2", "version=1"), "another version of this program"),
        (own.replace(" format=", " format=9"), "which this version of the program"),
        (String::new(), "holds ; allowed"),
    ] {
        std::fs::write(&marker, &line).unwrap();
        assert!(refused(run()).contains(said), "{line}");
    }
    std::fs::write(&marker, own).unwrap();
    run().unwrap();
}

#[test]
fn a_checkpoint_of_another_screening_is_refused_by_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let mut options = ScreenOptions::default();
    options.kinds = vec![ChangeKind::Dashpot];
    options.sizes.dashpot = Some(0.1);
    (options.up_to, options.draws, options.confirmed) = (1, 4, 2);
    let screened = |brake: &SlidingMass, options: &ScreenOptions| {
        let checkpoint = Some(folder.path().join("checkpoint.json"));
        let how = Confirmation::new(40).with_threads(Some(1)).with_checkpoint(checkpoint);
        confirm(brake, rank(brake, options, &())?, options, &how).map(|_| ())
    };
    screened(&SlidingMass::right(), &options).unwrap();
    for (other, said) in others() {
        // Names and works of modes are no part of a screening.
        if !said.contains("modes") && !said.contains("scenes") {
            assert!(refused(screened(&other, &options)).contains(said.split(" and ").next().unwrap()), "{said}");
        }
    }
    let mut other = options.clone();
    other.sizes.dashpot = Some(0.2);
    let line = refused(screened(&SlidingMass::right(), &other));
    assert!(line.contains("other changes"), "{line}");
    screened(&SlidingMass::right(), &options).unwrap();
}

fn text(name: &str) -> (std::path::PathBuf, String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    (path, text)
}

/// What stands in the folders of users: a change of one of these lines refuses them, and needs another version of identities.
#[test]
fn identities_of_cases_are_frozen() {
    let lattice = crate::common::case("two-by-two.toml", &[]).identity();
    assert_eq!(
        lattice,
        "\"2 x 2 made-up pad\" version=2 laws:d05aef965ff8 lattice:2c8574e5375a readings:1bad4e2ee7b9 \
         arrangements:1cc7fd43a55c constraints:2dcc208ade80 speeds:789ffc4d10ef friction:5a4d0658d829 correlation:af5570f5a181"
    );
    for (name, identity) in [
        (
            "hoffmann.toml",
            "\"Hoffmann's two-degree-of-freedom oscillator\" version=2 parameters:f9a6b6dea8e3 dofs:b388103c3e98 \
             terms:a49e9e96f2bc contacts:f56a1bd5af89 bodies:8a4f53da98cd constraints:45325a08f117 correlation:af5570f5a181",
        ),
        (
            "wobbling-disc.toml",
            "\"wobbling disc\" version=2 parameters:8f3d087ead5f dofs:a3308680e687 terms:f8cc4d559bb5 \
             contacts:374708fff771 bodies:f89da66fae5a constraints:45325a08f117 correlation:af5570f5a181",
        ),
    ] {
        let CaseFile::Matrices(case) = CaseFile::read(&text(name).0).unwrap() else { panic!("{name}") };
        assert_eq!(case.identity(), identity);
    }
    let CaseFile::FiniteElements(case) = CaseFile::read(&text("disc-pad/disc-pad.toml").0).unwrap() else { panic!() };
    assert_eq!(
        case.identity(),
        "\"Disc and pad\" version=2 parameters:af5570f5a181 dofs:43fd596d285c terms:d9add5032716 contact:6cf8eeb34770 \
         constraints:75505db62254 reduction:f0bd3b184b26 correlation:af5570f5a181"
    );
}

/// The keys of the parts in which two identities differ.
fn differing(a: &str, b: &str) -> Vec<String> {
    let parts = |line: &str| line.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let (a, b) = (parts(a), parts(b));
    assert_eq!(a.len(), b.len());
    let key = |(a, _): (&String, &String)| a.split([':', '=']).next().unwrap().to_owned();
    a.iter().zip(&b).filter(|(a, b)| a != b).map(key).collect()
}

#[test]
fn every_field_of_a_case_is_in_its_part() {
    let (path, lattice) = text("two-by-two.toml");
    let (disc_path, disc) = text("wobbling-disc.toml");
    let of_lattice = |text: String| LatticeCase::parse(&path, text).unwrap().identity();
    let of_disc = |text: String| MatricesCase::parse(&disc_path, text).unwrap().identity();
    for (from, to, parts) in [
        ("rows = 2\ncolumns = 2", "rows = 1\ncolumns = 4", vec!["lattice"]),
        ("oscillator_mass = 0.5", "oscillator_mass = 0.51", vec!["lattice"]),
        ("inner = 1.2e7", "inner = 1.3e7", vec!["lattice"]),
        ("wall = 2.5e7", "wall = 2.6e7", vec!["lattice"]),
        ("y_stiffness = 3.0e7", "y_stiffness = 3.1e7", vec!["lattice"]),
        ("x_damping = 150.0", "x_damping = 151.0", vec!["lattice"]),
        ("y_damping = 150.0", "y_damping = 151.0", vec!["lattice"]),
        ("z_damping = 150.0", "z_damping = 151.0", vec!["lattice"]),
        ("inclined_stiffness = 3.0e7", "inclined_stiffness = 3.1e7", vec!["lattice"]),
        ("theta = 60.0", "theta = 61.0", vec!["lattice"]),
        ("phi = 60.0", "phi = 61.0", vec!["lattice"]),
        ("contact_stiffness = 3.5e7", "contact_stiffness = 3.6e7", vec!["lattice"]),
        ("mass = 9.0", "mass = 9.1", vec!["lattice"]),
        ("[5.0e8, 5.0e8, 4.0e8]", "[5.0e8, 5.0e8, 4.1e8]", vec!["lattice"]),
        ("[1500.0, 1500.0, 1500.0]", "[1500.0, 1501.0, 1500.0]", vec!["lattice"]),
        ("lean = \"against\"", "lean = \"along\"", vec!["lattice"]),
        ("in_contact = [4, 3]", "in_contact = [3, 4]", vec!["arrangements"]),
        ("in_contact = [4, 3]", "in_contact = [4]", vec!["arrangements"]),
        ("[\"x1\", \"x2\"]", "[\"x1\", \"y2\"]", vec!["constraints"]),
        ("\"first-row\"", "\"row\"", vec!["constraints"]),
        ("from = 0.2 ", "from = 0.3 ", vec!["speeds"]),
        ("to = 2.0", "to = 2.1", vec!["speeds"]),
        ("lateral = \"none\"", "lateral = \"vector\"", vec!["readings"]),
        ("draws = \"shared\"", "draws = \"each\"", vec!["readings"]),
        ("labels = \"tracked\"", "labels = \"rank\"", vec!["readings"]),
        ("per_contact = 500.0", "per_contact = 501.0", vec!["readings"]),
        ("per_contact = 500.0", "clamp = 500.0", vec!["readings"]),
        ("bristle_damping = \"constant\"", "bristle_damping = \"decaying\"", vec!["readings"]),
        ("\"amontons-coulomb\", \"lugre\"", "\"lugre\", \"amontons-coulomb\"", vec!["laws"]),
        ("from = 0.3, to = 0.7", "from = 0.3, to = 0.71", vec!["friction"]),
        ("\"uniform\", from", "\"log-uniform\", from", vec!["friction"]),
        ("mean = 0.55", "mean = 0.56", vec!["friction"]),
        ("deviation = 0.05", "deviation = 0.06", vec!["friction"]),
        ("at_least = 0.02", "at_least = 0.03", vec!["friction"]),
        ("at_least = 0.02", "at_least = 0.02, at_most = 5.0", vec!["friction"]),
        ("median = 0.6", "median = 0.61", vec!["friction"]),
        ("sigma = 0.2", "sigma = 0.21", vec!["friction"]),
        ("value = 1.5", "value = 1.6", vec!["friction"]),
        ("2 x 2 made-up pad\"", "2 x 2 made-up disc\"", vec!["pad\""]),
        ("samples = 200", "samples = 300", vec![]),
        ("seed = 1", "seed = 2", vec![]),
        ("sigma2 = {", "# A comment.\nsigma2 = {", vec![]),
        (
            "[friction]",
            "[correlation]\nparameters = [\"mu_s\", \"mu_k\"]\nmatrix = [[1.0, 0.5], [0.5, 1.0]]\n\n[friction]",
            vec!["correlation"],
        ),
    ] {
        assert!(lattice.contains(from), "{from}");
        let changed = differing(&of_lattice(lattice.clone()), &of_lattice(lattice.replacen(from, to, 1)));
        assert_eq!(changed, parts, "{to}");
    }
    for (from, to, parts) in [
        ("[\"q1\", \"q2\"]", "[\"q1\", \"q3\"]", vec!["dofs"]),
        ("to = 0.7", "to = 0.71", vec!["parameters"]),
        ("\"log-normal\"", "\"log-normal\"\nat_most = 1e5", vec!["parameters"]),
        ("[[0.16, 0.0], [0.0, 0.16]]", "[[0.16, 0.0], [0.0, 0.17]]", vec!["terms"]),
        ("[[0.1, 0.0], [0.0, 0.1]]", "[[0.1, 0.001], [0.001, 0.1]]", vec!["terms"]),
        ("15600.0", "15600.000000000002", vec!["terms"]),
        ("\"mu*N0/Omega\"", "\"mu*N0/Omega*1\"", vec!["terms"]),
        ("family = \"gyroscopic\"", "family = \"spin\"", vec!["terms"]),
        ("[[terms]]", "[[bodies]]\nname = \"disc\"\ndofs = [\"q2\", \"q1\"]\n\n[[terms]]", vec!["bodies"]),
        ("[[terms]]", "[[constraints]]\nname = \"held\"\nfixed = [\"q2\"]\n\n[[terms]]", vec!["constraints"]),
        ("[[terms]]", "[squeal]\ngrowth_above = 1.0\n\n[[terms]]", vec![]),
        ("unit = \"rad/s\"", "unit = \"1/s\"", vec![]),
    ] {
        assert!(disc.contains(from), "{from}");
        assert_eq!(differing(&of_disc(disc.clone()), &of_disc(disc.replacen(from, to, 1))), parts, "{to}");
    }
}

#[test]
fn every_field_of_a_finite_element_case_is_in_its_part() {
    let (path, mesh) = text("disc-pad/disc-pad.toml");
    let of_mesh = |text: String| FiniteElementCase::parse(&path, text).unwrap().identity();
    let before = of_mesh(mesh.clone());
    for (from, to, parts) in [
        ("mass = 100.0", "mass = 101.0", vec!["terms"]),
        ("[1.08e8, 1.08e8, 2.16e7]", "[1.08e8, 1.08e8, 2.17e7]", vec!["terms"]),
        ("axis = [0.0, 0.0, 1.0]", "axis = [0.0, 0.0, -1.0]", vec!["contact"]),
        ("stiffness = 4.05e8", "stiffness = 4.06e8", vec!["terms", "contact"]),
        ("load = 468.0", "load = 469.0", vec!["contact"]),
        ("load = 468.0", "load = 468.0\nlateral = \"none\"", vec!["contact"]),
        ("in_contact = [9, 8]", "in_contact = [9]", vec!["contact"]),
        ("fixed = [\"BACKENDS.z\"]", "fixed = [\"BACKENDS.x\"]", vec!["constraints"]),
        ("from = 0.1 ", "from = 0.2 ", vec!["contact"]),
        ("mean = 0.50", "mean = 0.51", vec!["contact"]),
        ("\"amontons-coulomb\", \"velocity-dependent\"", "\"amontons-coulomb\"", vec!["contact"]),
        ("[500.0, 8000.0]", "[500.0, 8001.0]", vec!["reduction"]),
        ("[-500.0, 3000.0]", "[-501.0, 3000.0]", vec!["reduction"]),
        ("residual = 1e-8", "residual = 1e-7", vec!["reduction"]),
        ("full_checks = 100", "full_checks = 99", vec!["reduction"]),
        ("full_checks = 100", "full_checks = 100\nfull_verdicts = 0", vec!["reduction"]),
        ("seed = 1", "seed = 2", vec![]),
    ] {
        assert!(mesh.contains(from), "{from}");
        assert_eq!(differing(&before, &of_mesh(mesh.replacen(from, to, 1))), parts, "{to}");
    }
}
