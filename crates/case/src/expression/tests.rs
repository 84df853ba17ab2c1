use approx::assert_relative_eq;
use proptest::prelude::*;

use super::*;

fn names() -> Vec<String> {
    ["w", "mu_s", "mu_k", "alpha", "v", "e", "E", "w1", "log"].map(String::from).to_vec()
}

const VALUES: [f64; 9] = [-3.0, 0.5, 0.3, 2.0, 0.7, 11.0, 13.0, 17.0, 19.0];

fn value(text: &str) -> f64 {
    Expression::parse(text, &names()).unwrap().value(&VALUES).unwrap()
}

fn fault(text: &str) -> String {
    let message = Expression::parse(text, &names()).unwrap_err().to_string();
    assert!(!message.contains('\n') && message.len() < 600, "{message}");
    message
}

#[test]
fn reads_as_in_a_textbook() {
    let decay = 0.3 + 0.2 * (-1.4f64).exp();
    for (text, expected) in [
        ("2", 2.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("1e-3*w", -3e-3),
        ("1E+2", 100.0),
        ("1e300", 1e300),
        ("1e-300", 1e-300),
        ("0.1", 0.1),
        ("w^2", 9.0),
        ("-w^2", -9.0),
        ("(-w)^2", 9.0),
        ("-w1^2", -289.0),
        ("3 - -2", 5.0),
        ("2^-1", 0.5),
        ("2*-3", -6.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("-(2 + 3)*4", -20.0),
        ("2*(-w)", 6.0),
        ("1/w - 1", -1.0 / 3.0 - 1.0),
        ("12/2*3", 18.0),
        ("12/2/3", 2.0),
        ("12*2/3", 8.0),
        ("1 - 2 + 3 - 4", -2.0),
        ("2 + 3*4^2", 50.0),
        ("e*E*log", 11.0 * 13.0 * 19.0),
        ("mu_k + (mu_s - mu_k)*exp(-alpha*v)", decay),
        ("sin(pi/2)^2", 1.0),
        ("-sin(pi/2)*2", -2.0),
        ("sqrt(abs(w) + 1) + ln(exp(1)) + tanh(0) + tan(0) + cos(0)", 4.0),
        ("((((w))))", -3.0),
        (" w\t*\n2 ", -6.0),
        ("-(-(-w))", 3.0),
        ("(2^3)^2", 64.0),
        ("2^(3^2)", 512.0),
    ] {
        assert_relative_eq!(value(text), expected, max_relative = 1e-15);
    }
}

#[test]
fn says_what_is_wrong_and_where() {
    let deep = |n: usize| "(".repeat(n) + "w" + &")".repeat(n);
    for (text, column, part) in [
        ("", 1, "nothing"),
        ("  ", 3, "nothing"),
        ("w^^2", 3, "unexpected \"^\"; allowed: a number, a parameter"),
        ("w +", 4, "unexpected end"),
        ("+w", 1, "unexpected \"+\""),
        ("w w", 3, "allowed: + - * / ^"),
        ("2w", 1, "\"2w\" is no number"),
        ("1.2.3", 1, "\"1.2.3\" is no number"),
        ("1e", 1, "\"1e\" is no number"),
        ("1e5.3", 1, "is no number"),
        (".", 1, "is no number"),
        ("3*1e999", 3, "too large"),
        ("w(2)", 2, "unexpected \"(\""),
        ("(w)(w)", 4, "unexpected \"(\""),
        ("2(w)", 2, "unexpected \"(\""),
        ("v*x", 3, "unknown name \"x\"; allowed: the parameters w, mu_s"),
        ("log10(w)", 1, "unknown name \"log10\""),
        ("sinh(w)", 1, "the functions sin cos tan exp ln sqrt abs tanh; pi"),
        ("PI", 1, "unknown name"),
        ("sin w", 5, "the function sin without an argument"),
        ("sin", 4, "sin(w)"),
        ("sin()", 5, "unexpected \")\""),
        ("()", 2, "unexpected \")\""),
        ("(w", 1, "never closed"),
        ("2*(w+(1)", 3, "never closed"),
        ("w)", 2, "closes nothing"),
        ("{w}", 1, "unexpected \"{\""),
        ("w{", 2, "unexpected \"{\""),
        ("atan2(w, 2)", 1, "unknown name"),
        ("sin(w, 2)", 6, "unexpected \",\""),
        ("2*-w", 3, "else in parentheses"),
        ("w--v", 3, "a second sign"),
        ("--w", 2, "a second sign"),
        ("2*-3^2", 5, "two readings"),
        ("w^v^2", 4, "two readings"),
        ("w^(1)^2", 6, "two readings"),
        ("w^sin(v)^2", 9, "two readings"),
        ("2π", 2, "unexpected \"π\""),
        ("ω^2", 1, "unexpected \"ω\""),
        ("w²", 2, "unexpected \"²\""),
        ("w\u{0}", 2, "unexpected"),
        ("w ; v", 3, "unexpected"),
        ("w == 2", 3, "unexpected"),
        ("w && v", 3, "unexpected"),
        (&deep(33), 33, "more than 32 parentheses"),
    ] {
        let message = fault(text);
        assert!(message.contains(&format!("column {column}: ")) && message.contains(part), "{message}");
    }
    assert_eq!(value(&deep(32)), -3.0);
    assert!(fault(&"(".repeat(100_000)).contains("too long; allowed: 1000 characters at most"));
    assert!(fault(&"w+".repeat(100_000)).contains("too long"));
    assert!(fault(&"ω".repeat(999)).contains("column 1"));
    let nothing = Expression::parse("w", &[]).unwrap_err().to_string();
    assert!(nothing.contains("no parameter is declared"), "{nothing}");
}

#[test]
fn the_longest_expressions_are_evaluated() {
    let sum = vec!["w"; 500].join("+");
    assert_relative_eq!(value(&sum), -1500.0);
    let product = vec!["v"; 500].join("*");
    assert_relative_eq!(value(&product), 0.7f64.powi(500), max_relative = 1e-12);
    assert!(value(&("tanh(".repeat(32) + "v" + &")".repeat(32))) > 0.0);
}

#[test]
fn a_result_that_is_not_finite_is_named_with_its_values() {
    let at = |text: &str, values: &[f64]| {
        let names: Vec<String> = ["w", "v"].map(String::from).to_vec();
        Expression::parse(text, &names).unwrap().value(values).unwrap_err().to_string()
    };
    assert_eq!(at("v/w", &[0.0, 2.0]), "\"v/w\" = inf at v = 2, w = 0; allowed: a finite number");
    assert_eq!(at("ln(w)", &[-1.0, 2.0]), "\"ln(w)\" = NaN at w = -1; allowed: a finite number");
    assert_eq!(at("1/0", &[]), "\"1/0\" = inf; allowed: a finite number");
    assert!(at("w + v", &[1.0]).contains("NaN at v = NaN, w = 1"));
}

#[test]
fn the_parameters_of_an_expression_are_those_that_occur_in_it() {
    let of = |text: &str| Expression::parse(text, &names()).unwrap().parameters().collect::<Vec<_>>();
    assert_eq!((of("w^2"), of("sqrt(2)")), (vec![0], vec![]));
}

#[test]
fn names_of_parameters() {
    for name in ["w", "_", "w1", "mu_s", "e", "E", "PI", "log", "Omega"] {
        assert!(is_parameter_name(name), "{name}");
    }
    for name in ["", "1w", "ω", "a b", "a-b", "sin", "pi", "exp", "{w}", "w\u{301}"] {
        assert!(!is_parameter_name(name), "{name}");
    }
}

proptest! {
    #[test]
    fn no_text_makes_it_panic(text in ".{0,60}") {
        let _ = Expression::parse(&text, &names()).map(|expression| expression.value(&VALUES));
    }

    #[test]
    fn no_almost_expression_makes_it_panic(text in "([wv2.]|sin\\(|exp\\(|[-+*/^()]|1e-3|\\{| |mu_k|pi){0,40}") {
        if let Ok(expression) = Expression::parse(&text, &names()) {
            let _ = expression.value(&VALUES);
        }
    }

    #[test]
    fn what_the_check_lets_pass_the_parser_reads(
        text in "(\\(|sin\\(|)(-|)(w|v|2|0\\.5|1e-3|pi)\\)?([-+*/^](w|v|3|mu_k|-2)){0,4}\\)?([-+*/](w|1)){0,2}\\)?"
    ) {
        if let Err(error) = Expression::parse(&text, &names()) {
            prop_assert!(!matches!(error, ExpressionError::Parser { .. }), "{error}");
        }
    }
}

/// Random expressions with their values by the rules of a textbook, from the inside out.
struct Textbook {
    state: u64,
    /// Tables that are called too.
    tables: Vec<Arc<TableFunction>>,
    /// Largest argument of a function so far: rounding of a large one is all of its sine.
    largest: f64,
}

impl Textbook {
    /// A whole number below `end`, by the multiplier of Knuth's MMIX.
    fn below(&mut self, end: usize) -> usize {
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 33) as usize % end
    }

    fn primary(&mut self, depth: usize) -> (String, f64) {
        match self.below(if depth == 0 { 2 } else { 4 + self.tables.len() }) {
            0 => {
                let number = (1 + self.below(39)) as f64 / 10.0;
                (number.to_string(), number)
            }
            1 => {
                let at = 1 + self.below(4);
                (names()[at].clone(), VALUES[at])
            }
            2 => {
                let (text, value) = self.sum(depth - 1);
                (format!("({text})"), value)
            }
            table @ 4.. => {
                let table = Arc::clone(&self.tables[table - 4]);
                let (text, value) = self.sum(depth - 1);
                (format!("{}({text})", table.name()), interpolated(&table, value))
            }
            _ => {
                let functions = [
                    ("sin", f64::sin as fn(f64) -> f64),
                    ("cos", f64::cos),
                    ("tanh", f64::tanh),
                    ("abs", f64::abs),
                    ("exp", f64::exp),
                ];
                let (name, apply) = functions[self.below(5)];
                let (text, value) = self.sum(depth - 1);
                self.largest = self.largest.max(value.abs());
                (format!("{name}({text})"), apply(value))
            }
        }
    }

    fn product(&mut self, depth: usize) -> (String, f64) {
        let (mut text, mut value) = (String::new(), 1.0);
        for at in 0..1 + self.below(3) {
            let (of_base, base) = self.primary(depth);
            let (factor, number) = if self.below(10) < 3 { (of_base + "^2", base.powi(2)) } else { (of_base, base) };
            match at > 0 && self.below(10) < 3 {
                true => (text, value) = (text + "/" + &factor, value / number),
                false => (text, value) = (if at == 0 { factor } else { text + "*" + factor.as_str() }, value * number),
            }
        }
        (text, value)
    }

    fn sum(&mut self, depth: usize) -> (String, f64) {
        let (mut text, mut value) = self.product(depth);
        if self.below(10) < 1 {
            (text, value) = (format!("-{text}"), -value);
        }
        for _ in 0..self.below(4) {
            let (term, number) = self.product(depth);
            match self.below(10) < 4 {
                true => (text, value) = (text + " - " + &term, value - number),
                false => (text, value) = (text + " + " + &term, value + number),
            }
        }
        (text, value)
    }
}

/// A function has all of its argument, whatever numbers stand next to each other in it.
#[test]
fn random_expressions_have_the_values_of_a_textbook() {
    for (text, expected) in [
        ("exp(0.2 + mu_s^2 + 0.3)", 0.75_f64.exp()),
        ("sqrt(1 + mu_s^2 + 2)", 3.25_f64.sqrt()),
        ("2-exp(0.5*(mu_s-0.2)*0.1)", 2.0 - 0.015_f64.exp()),
        ("exp(1+mu_s*2+3)", 5.0_f64.exp()),
    ] {
        assert_relative_eq!(value(text), expected, max_relative = 1e-14);
    }
    let (mut textbook, mut compared) = (Textbook { state: 5, tables: Vec::new(), largest: 0.0 }, 0);
    while compared < 5_000 {
        textbook.largest = 0.0;
        let (text, expected) = textbook.sum(3);
        // Long ones are refused, and large numbers cancel.
        if text.len() > 150 || textbook.largest > 30.0 || !(1e-3..1e3).contains(&expected.abs()) {
            continue;
        }
        let found = value(&text);
        assert!((found - expected).abs() <= 1e-6 * (1.0 + expected.abs()), "{text}: {found}, {expected}");
        compared += 1;
    }
}

/// The value of a table on the chord of the interval that has the argument; NaN beyond its ends.
fn interpolated(table: &TableFunction, x: f64) -> f64 {
    let points: Vec<[f64; 2]> = table.points().collect();
    let chord = |[a, b]: [[f64; 2]; 2]| (a[1] * (b[0] - x) + b[1] * (x - a[0])) / (b[0] - a[0]);
    let mut intervals = points.windows(2).map(|pair| [pair[0], pair[1]]);
    intervals.find(|[a, b]| a[0] <= x && x <= b[0]).map_or(f64::NAN, chord)
}

fn table(name: &str, points: &[[f64; 2]]) -> Arc<TableFunction> {
    let of = |place: usize| points.iter().map(|point| point[place]).collect();
    Arc::new(TableFunction::new(name.into(), of(0), of(1)))
}

/// A table of random points that begins at an argument.
fn random_table(name: &'static str) -> impl Strategy<Value = Arc<TableFunction>> {
    (-6.0..0.0, prop::collection::vec((1e-3..4.0, -3.0..3.0), 2..8)).prop_map(move |(first, steps)| {
        let mut at: f64 = first;
        let points = steps.into_iter().map(|(step, value)| {
            at += step;
            [at, value]
        });
        table(name, &points.collect::<Vec<_>>())
    })
}

proptest! {
    /// Calls of tables, within functions and each other, have the values of a linear interpolation, and none beyond the ends.
    #[test]
    fn tables_are_linear_between_points(f in random_table("f"), g in random_table("g"), state: u64) {
        let tables = vec![f, g];
        let mut textbook = Textbook { state, tables: tables.clone(), largest: 0.0 };
        for _ in 0..20 {
            textbook.largest = 0.0;
            let (text, expected) = textbook.sum(4);
            if text.len() > 400 || textbook.largest > 30.0 || expected.abs() > 1e3 {
                continue;
            }
            let found = Expression::with_tables(&text, &names(), &tables).unwrap().value(&VALUES);
            match found {
                Ok(found) => prop_assert!((found - expected).abs() <= 1e-6 * (1.0 + expected.abs()), "{text}: {found}, {expected}"),
                Err(error) => prop_assert!(expected.is_nan(), "{text}: {error}, {expected}"),
            }
        }
    }

    /// Every point of a table is met to the last bit, and what is just beyond the ends has no value.
    #[test]
    fn points_are_met(f in random_table("f")) {
        for [at, value] in f.points() {
            prop_assert_eq!(f.value(at), Some(value));
        }
        let [first, last] = f.ends();
        for beyond in [first.next_down(), last.next_up(), f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            prop_assert_eq!(f.value(beyond), None);
        }
    }
}

#[test]
fn tables_are_called_by_name_with_one_argument() {
    let tables = [table("E", &[[20.0, 1.0], [100.0, 0.5]]), table("T", &[[0.0, 20.0], [2.0, 100.0]])];
    let names: Vec<String> = ["w", "mu"].map(String::from).to_vec();
    let read = |text: &str| Expression::with_tables(text, &names, &tables);
    let value = |text: &str, w: f64| read(text).unwrap().value(&[w, 3.0]).map_err(|error| error.to_string());
    for (text, w, expected) in [
        ("E(60)", 0.0, 0.75),
        ("mu*E( T (w) )^2 - 1", 1.0, 3.0 * 0.5625 - 1.0),
        ("-E(T(w))^2", 1.0, -0.5625),
        ("E(-(-60))", 0.0, 0.75),
        ("2^E(T(E(20)))", 0.0, 2.0_f64.powf(0.75)),
        ("E(w)*E(w)", 100.0, 0.25),
    ] {
        assert_relative_eq!(value(text, w).unwrap(), expected, max_relative = 1e-15);
    }
    let beyond = "\"E(T(w)+1)\": E(101) at w = 2; allowed: an argument from 20 to 100, between the ends of the table";
    assert_eq!(value("E(T(w)+1)", 2.0).unwrap_err(), beyond);
    assert!(value("E(0)", 2.0).unwrap_err().starts_with("\"E(0)\": E(0); allowed"));
    assert!(value("E(1/w)", 0.0).unwrap_err().contains("E(inf) at w = 0"));
    assert_eq!(read("E(T(w)) + mu").unwrap().parameters().collect::<Vec<_>>(), [1, 0]);
    let fault = |text: &str| read(text).unwrap_err().to_string();
    for (text, column, part) in [
        ("E", 2, "the table E without an argument; allowed: parentheses, as in E(w)"),
        ("E + 1", 3, "the table E without an argument"),
        ("E()", 3, "unexpected \")\""),
        ("E(w, mu)", 4, "unexpected \",\""),
        (
            "1 + E(T(x))",
            9,
            "unknown name \"x\"; allowed: the parameters w, mu; the functions sin cos tan exp ln sqrt abs tanh; pi; the tables E, T",
        ),
        ("E(T(w)", 2, "never closed"),
        ("E(2*-w)", 5, "a second sign"),
    ] {
        let message = fault(text);
        assert!(message.contains(&format!("column {column}: ")) && message.contains(part), "{message}");
    }
    let other = [table("E", &[[20.0, 1.0], [100.0, 0.25]])];
    let [one, two] = [&tables[..1], &other[..]].map(|tables| Expression::with_tables("E(w)", &names, tables).unwrap());
    assert_ne!(one, two);
}
