//! An expression or a condition: prints as it was read, and has the same values and derivatives in every form.

use springfit_foundation::symbolic::{Expr, Polynomial, Program, Scope, parse_rational, variables_of};

const NAMES: [&str; 3] = ["x", "y", "z"];
const POINTS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [0.3, -1.7, 2.5], [1.0, 1.0, -1.0], [1e9, -1e-9, 0.5]];
/// Derivatives of larger expressions take long.
const LARGEST: usize = 300;

pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    variables_of(text);
    let _ = parse_rational(text);
    let scope = Scope::new(&NAMES);
    if let Ok(condition) = scope.predicate(text) {
        for at in POINTS {
            let _ = condition.holds(&at);
        }
        assert!(scope.expression(text).is_err(), "both a condition and a number");
    }
    let Ok(expression) = scope.expression(text) else { return };
    prints_as_it_was_read(&scope, &expression);
    has_one_value(&expression);
    if parts(&expression) <= LARGEST {
        has_one_derivative(&expression);
    }
}

fn prints_as_it_was_read(scope: &Scope, expression: &Expr) {
    let printed = expression.text(&NAMES);
    match scope.expression(&printed) {
        Ok(again) => assert_eq!(&again, expression, "{printed}"),
        // A print may be longer than what may be read.
        Err(error) => assert!(error.problem().contains("at most"), "{error}: {printed}"),
    }
}

fn has_one_value(expression: &Expr) {
    let program = Program::of(expression);
    for at in POINTS {
        let (value, quick) = (expression.evaluate(&at), program.evaluate(&at));
        assert!(value.to_bits() == quick.to_bits() || value.is_nan() && quick.is_nan(), "{value} {quick}");
    }
}

fn has_one_derivative(expression: &Expr) {
    let program = Program::of(expression);
    let derivatives: Vec<Expr> = (0..3).map(|k| expression.derivative(k)).collect();
    for at in POINTS {
        for derivative in &derivatives {
            let _ = derivative.evaluate(&at);
        }
        program.jet(&at, 3);
    }
    // An expansion may take a second: one direction is enough.
    let k = parts(expression) % 3;
    if let (Some(polynomial), Some(derivative)) =
        (Polynomial::expand(expression, 3), Polynomial::expand(&derivatives[k], 3))
    {
        assert_eq!(derivative, polynomial.derivative(k));
    }
}

fn parts(expression: &Expr) -> usize {
    1 + match expression {
        Expr::Number(_) | Expr::Variable(_) => 0,
        Expr::Sum(inner) | Expr::Product(inner) => inner.iter().map(parts).sum(),
        Expr::Power(inner, _) | Expr::Call(_, inner) => parts(inner),
    }
}
