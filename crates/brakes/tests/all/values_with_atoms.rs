//! A parameter with a value that has a probability of its own is studied like any other.

use brakes::MatricesBrake;
use brakes::case::MatricesCase;
use cea::QrSolver;
use study::Study;

#[test]
fn values_with_a_probability_of_their_own_are_studied_alone() {
    for distribution in [
        r#""discrete", values = [6.0, 30.0]"#,
        r#""discrete", values = [6.0, 30.0], weights = [999, 1]"#,
        r#""uniform", from = 6.0, to = 6.0"#,
        r#""log-uniform", from = 6.0, to = 6.0"#,
    ] {
        let text = format!(
            r#"
            study = {{ name = "mass on a belt", samples = 10, seed = 1 }}
            brake = {{ kind = "matrices", dofs = ["x"] }}
            parameters.d = {{ unit = "Ns/m", distribution = {distribution} }}
            terms = [
                {{ name = "mass and spring", mass = [[1.0]], stiffness = [[1e4]] }},
                {{ name = "dashpot", coefficient = "d", damping = [[1.0]] }},
            ]
            contacts = [{{ name = "belt", force = {{ x = 1.0 }}, slope = -12.0 }}]
            "#
        );
        let brake = MatricesBrake::new(MatricesCase::parse("belt.toml".as_ref(), text).unwrap()).unwrap();
        let made = Study::new(&brake, &QrSolver);
        assert!(made.is_ok(), "{distribution}: {:?}", made.err().map(|error| error.to_string()));
    }
}
