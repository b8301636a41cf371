//! Values against Rust's own arithmetic, and messages.

use std::f64::consts::{E, PI};

use super::*;

fn value(text: &str) -> f64 {
    let expression = Expression::parse(text, &["x", "y"]).unwrap_or_else(|error| panic!("{error}"));
    expression.eval(&[3.0, 0.5]).unwrap()
}

fn message(text: &str) -> String {
    match Expression::parse(text, &["x"]) {
        Ok(_) => panic!("{text} was accepted"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn arithmetic_follows_the_rules_of_mathematics() {
    let (x, y) = (3.0_f64, 0.5_f64);
    let cases = [
        ("1", 1.0),
        (" 1.5e2 + 1E-3 ", 150.001),
        (".5 + 2.", 2.5),
        ("8/4/2", 1.0),
        ("8-4-2", 2.0),
        ("2+3*4", 14.0),
        ("(2+3)*4", 20.0),
        ("-x^2", -9.0),
        ("2-x^2", -7.0),
        ("-sin(x)^2", -x.sin().powi(2)),
        ("2*-x^2", -18.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("--x", 3.0),
        ("2*e", 2.0 * E),
        ("0.8*sin(pi*x*y)", 0.8 * (PI * 1.5).sin()),
        ("-200*x/0.5", -1200.0),
        ("min(x, 1) + max(min(x, y), max(0.1, y^2))", 1.5),
        ("atan2(y, x)", y.atan2(x)),
        ("sign(0) + sign(-x) + abs(-x)", 2.0),
        ("floor(y) + ceil(y) + sqrt(4) + cbrt(8)", 5.0),
        ("exp(ln(x)) + log10(100)", 5.0),
    ];
    for (text, expected) in cases {
        let found = value(text);
        assert!(
            (found - expected).abs() <= 1e-15 * expected.abs().max(1.0),
            "{text}: {found}"
        );
    }
}

#[test]
fn every_function_has_its_value() {
    for (name, function) in functions::UNARY {
        let y = 0.5;
        assert_eq!(value(&format!("{name}(y)")), function(y), "{name}");
    }
}

#[test]
fn messages_name_the_place_and_what_is_allowed() {
    let cases: [(&str, &[&str]); 15] = [
        ("", &["ends", "a number, a name or '('"]),
        ("2*", &["ends", "a number"]),
        ("sin(x", &["ends", "')'"]),
        ("2x", &["'x' at column 2", "operator"]),
        ("x(2)", &["'(' at column 2", "operator"]),
        ("2 ** x", &["'*' at column 4", "a number"]),
        ("x)", &["')' at column 2"]),
        ("sin()", &["')' at column 5"]),
        ("max(x)", &["')' at column 6", "second argument"]),
        ("sin(x, 1)", &["',' at column 6"]),
        ("x + y", &["unknown name 'y'", "allowed: x, pi, e"]),
        ("foo(x)", &["unknown function 'foo'", "sin, cos"]),
        ("sin x", &["'sin' is a function", "sin(...)"]),
        ("1e999", &["1e999", "too large"]),
        ("é + 1", &["unknown name 'é'"]),
    ];
    for (text, fragments) in cases {
        let message = message(text);
        assert!(!message.contains('\n'));
        for fragment in fragments {
            assert!(message.contains(fragment), "{text}: {message}");
        }
    }
}

#[test]
fn length_and_depth_have_a_limit() {
    assert!(message(&"(".repeat(1000)).contains("100 levels"));
    assert!(message(&"-".repeat(1000)).contains("100 levels"));
    assert!(message(&"2^".repeat(900)).contains("100 levels"));
    assert!(message(&"x+".repeat(2000)).contains("2000 characters"));
    // Wide is not deep.
    assert_eq!(value(&["x"; 900].join("+")), 2700.0);
}

#[test]
fn a_value_that_is_not_finite_is_an_error_that_names_key_and_place() {
    let expression = Expression::parse_key("body.0.velocity.0", "1/x", &["x"]).unwrap();
    assert_eq!(expression.eval_at(&[2.0]), Ok(0.5));
    let message = expression.eval_at(&[0.0]).unwrap_err().to_string();
    assert_eq!(
        message,
        "body.0.velocity.0 = \"1/x\": the value is inf at x = 0.0; it must be finite there"
    );
    // Not a number is not hidden by min and max.
    let hidden = Expression::parse("max(min(sqrt(t), 1), 0)", &["t"]).unwrap();
    assert_eq!(hidden.eval_time(4.0), Ok(1.0));
    assert!(hidden.eval_time(-1.0).is_err());
    assert!(hidden.eval(&[]).is_err());
}

/// Random strings of tokens: whatever they are, no panic, and messages stay short.
#[test]
fn no_text_makes_the_parser_panic() {
    let tokens = [
        "x", "y", "pi", "1", "2.5", "1e", "1e-3", ".", "+", "-", "*", "/", "^", "(", ")", ",", "sin", "max",
        "sin(", "atan2(", " ", "é", "π", "\n", "{", "²",
    ];
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..20_000 {
        let count = random.usize(0..12);
        let text: String = (0..count)
            .map(|_| tokens[random.usize(0..tokens.len())])
            .collect();
        match Expression::parse(&text, &["x", "y"]) {
            Ok(expression) => drop(expression.eval(&[0.3, 0.7])),
            Err(error) => assert!(error.to_string().len() < 400 && !error.to_string().contains('\n')),
        }
    }
}
