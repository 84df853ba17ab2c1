//! Any text is either an expression with a finite value or an error of one line.
#![no_main]

use case::Expression;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let parameters = ["w", "mu_s", "mu_k", "alpha", "v", "e"].map(String::from);
    let values = [-2.0, 0.5, 0.3, 1.5, 0.0, 3.0];
    let message = match Expression::parse(text, &parameters) {
        Ok(expression) => {
            let value = expression.value(&values);
            assert!(value.as_ref().map_or(true, |value| value.is_finite()));
            value.err().map(|error| error.to_string())
        }
        Err(error) => Some(error.to_string()),
    };
    if let Some(message) = message {
        assert!(!message.contains('\n') && message.len() < 1500, "{message}");
        assert!(!message.contains("the parser understands"), "{message}");
    }
});
