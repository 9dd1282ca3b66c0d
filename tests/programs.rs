//! Programs have the values and derivatives of the expressions that they are made from.

use springfit_foundation::scalar::{DoubleDouble, Real};
use springfit_foundation::symbolic::{Expr, Program, Scope};

const TEXTS: [&str; 7] = [
    "1/3",
    "x - y/7 + x*y*3 - 2",
    "exp(x*y)/(1 + x^2) - ln(y)^3 + sqrt(x)",
    "ramp(x - 1)*abs(y - x)^(5/2) + atan(x)/sin(y)",
    "((((x + 1)*y + 2)*x + 3)*y + 4)^(-3)",
    "x*x*(x*y + y)^(1/3) - exp(x - 1/7*y) + step(x - 1/2)",
    "asin(x/4)*acos(y/5) + cos(tan(x/3)) + (x + y)^(-7/2)",
];

#[test]
fn a_program_has_the_values_of_its_expression() {
    let scope = Scope::new(&["x", "y"]);
    for text in TEXTS {
        let expr = scope.expression(text).unwrap();
        let program = Program::of(&expr);
        for at in [[0.3, 1.7], [1.2, 0.4], [2.0, 3.0]] {
            assert_eq!(program.evaluate(&at).to_bits(), expr.evaluate(&at).to_bits(), "{text}");
        }
    }
    // Longer than the room.
    let deep = (0..80).fold("x".to_string(), |text, i| format!("(y + {i}*{text})"));
    let expr = scope.expression(&deep).unwrap();
    assert_eq!(Program::of(&expr).evaluate(&[1e-9, 0.5]), expr.evaluate(&[1e-9, 0.5]));
    assert!(Program::of(&Expr::integer(0)).is_zero() && !Program::of(&Expr::Variable(0)).is_zero());
}

/// The derivatives of the expression are expressions, which are evaluated in pairs of doubles.
#[test]
fn a_program_has_the_derivatives_of_its_expression() {
    let variables = ["x", "y", "u", "v", "w"];
    let scope = Scope::new(&variables);
    // The last one has more variables than are differentiated at once, and a constant after them.
    for text in TEXTS.into_iter().chain(["x*y*u + sin(x*w)*v^2 + w*exp(-u*v)/y"]) {
        let expr = scope.expression(text).unwrap();
        let program = Program::of(&expr);
        for at in [[0.3, 1.7, 0.9, -0.4, 0.5], [1.2, 0.4, -0.3, 1.1, 2.0]] {
            let point = at.map(DoubleDouble::from);
            let (value, gradient) = program.gradient(&at);
            let (jet, twice) = (program.jet(&at, 4), program.jet(&point, 5));
            assert_eq!(
                (value.to_bits(), jet.value.to_bits()),
                (expr.evaluate(&at).to_bits(), value.to_bits()),
                "{text}"
            );
            let near = |found: f64, precise: DoubleDouble, exact: &Expr| {
                let exact = exact.value(&point).unwrap();
                let size = 1.0 + exact.rounded().abs();
                assert!((found - exact.rounded()).abs() < 1e-13 * size, "{text}: {found:e} {exact:?}");
                assert!((precise - &exact).rounded().abs() < 1e-28 * size, "{text}: {precise:?} {exact:?}");
            };
            for i in 0..4 {
                let derivative = expr.derivative(i);
                near(gradient[i], twice.gradient[i], &derivative);
                assert_eq!(jet.gradient[i].to_bits(), gradient[i].to_bits(), "{text}");
                for j in 0..4 {
                    near(jet.hessian[4 * i + j], twice.hessian[5 * i + j], &derivative.derivative(j));
                    assert_eq!(jet.hessian[4 * i + j].to_bits(), jet.hessian[4 * j + i].to_bits(), "{text}");
                }
            }
        }
    }
    // A constant has no derivatives, however steep its function is there: the square root of the last variable, which is zero.
    let steep = Program::of(&scope.expression("sqrt(w)*(x - 1)^4 + x^2*exp(y*ln(2 + w))").unwrap());
    let jet = steep.jet(&[3.0, 2.0, 0.0, 0.0, 0.0], 2);
    assert!(jet.hessian.iter().chain(&jet.gradient).all(|slope| slope.is_finite()), "{jet:?}");
    assert!((jet.hessian[0] - 8.0).abs() < 1e-13, "{jet:?}");
    let huge = Program::of(&scope.expression("x^(-2147483648)").unwrap()).jet(&[2.0, 0.0, 0.0, 0.0, 0.0], 1);
    assert_eq!((huge.gradient[0], huge.hessian[0]), (0.0, 0.0));
    // A square root has no slope at zero, but the other variables have theirs.
    let (_, gradient) = Program::of(&scope.expression("sqrt(x) + 3*y").unwrap()).gradient(&[0.0, 1.0, 0.0, 0.0, 0.0]);
    assert_eq!(gradient[..3], [f64::INFINITY, 3.0, 0.0]);
}
