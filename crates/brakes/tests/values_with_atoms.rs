//! Parameters with a value that has a probability of its own: not correlated, and studied alone.

#![allow(clippy::unwrap_used, clippy::panic)] // Test code, which the lints do not recognise outside test functions.

use brakes::MatricesBrake;
use brakes::case::{CaseError, MatricesCase};
use cea::QrSolver;
use study::Study;

const PAD: &str = r#"
[study]
name = "pad"
samples = 10
seed = 1
[brake]
kind = "matrices"
dofs = ["x", "y"]
[parameters.mu]
unit = "1"
distribution = "uniform"
from = 0.2
to = 0.6
[parameters.w]
distribution = "constant"
value = 2
[[terms]]
name = "structure"
mass = [[1, 0], [0, 1.5]]
stiffness = [[4.0, 1.0], [1.0, 9.0]]
[[terms]]
name = "spin"
family = "gyroscopic"
coefficient = "3*w"
damping = [[0.0, 1.0], [-1.0, 0.0]]
[[contacts]]
name = "pad"
force = { x = 1.0 }
reading = { y = -5.0 }
mu = "mu"
slope = -0.1
[[bodies]]
name = "mass"
dofs = "x-y"
[[constraints]]
name = "none"
fixed = []
[[constraints]]
name = "y"
fixed = "y"
"#;

fn parse(text: &str) -> Result<MatricesCase, CaseError> {
    MatricesCase::parse("pad.toml".as_ref(), text.to_owned())
}

/// Distributions with a value that has a probability of its own, and some without.
const WITH_ATOMS: [&str; 4] = [
    "distribution = \"discrete\"\nvalues = [0.2, 0.6]",
    "distribution = \"discrete\"\nvalues = [0.2, 0.6]\nweights = [999, 1]",
    "distribution = \"uniform\"\nfrom = 0.3\nto = 0.3",
    "distribution = \"log-uniform\"\nfrom = 0.3\nto = 0.3",
];
const SMOOTH: [&str; 3] = [
    "distribution = \"empirical\"\nvalues = [0.2, 0.4, 0.5, 0.6]",
    "distribution = \"triangular\"\nfrom = 0.2\nmode = 0.2\nto = 0.6",
    "distribution = \"normal\"\nmean = 0.4\ndeviation = 0.1\nat_least = 0.1\nat_most = 0.5",
];

/// A correlated parameter keeps its distribution; one whose values have probabilities of their own would give others another one.
#[test]
fn values_with_a_probability_of_their_own_are_not_correlated_and_are_drawn_alone() {
    const UNIFORM: &str = "distribution = \"uniform\"\nfrom = 0.2\nto = 0.6";
    let with = |distribution: &str| {
        PAD.replace(UNIFORM, distribution).replace("\"constant\"\nvalue = 2", "\"uniform\"\nfrom = 1\nto = 2")
    };
    let correlated =
        |text: &str| format!("{text}[correlation]\nparameters = [\"mu\", \"w\"]\nmatrix = [[1.0, 0.5], [0.5, 1.0]]\n");
    for distribution in WITH_ATOMS {
        let text = with(distribution);
        match parse(&correlated(&text)) {
            Err(error) => {
                let error = error.to_string();
                assert!(
                    error.contains("correlation.parameters = \"mu\"; allowed: parameters none of whose values"),
                    "{error}"
                );
            }
            Ok(_) => panic!("{distribution}"),
        }
        // Alone each is a study.
        let brake = MatricesBrake::new(parse(&text).unwrap()).unwrap();
        let made = Study::new(&brake, &QrSolver);
        assert!(made.is_ok(), "{distribution}: {:?}", made.err().map(|error| error.to_string()));
    }
    for distribution in SMOOTH {
        assert!(parse(&correlated(&with(distribution))).is_ok(), "{distribution}");
    }
}
