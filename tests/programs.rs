//! Programs have the values of the expressions that they are made from.

use springfit_foundation::symbolic::{Expr, Program, Scope};

#[test]
fn a_program_has_the_values_of_its_expression() {
    let scope = Scope::new(&["x", "y"]);
    let texts = [
        "1/3",
        "x - y/7 + x*y*3 - 2",
        "exp(x*y)/(1 + x^2) - ln(y)^3 + sqrt(x)",
        "ramp(x - 1)*abs(y - x)^(5/2) + atan(x)/sin(y)",
        "((((x + 1)*y + 2)*x + 3)*y + 4)^(-3)",
    ];
    for text in texts {
        let expr = scope.expression(text).unwrap();
        let program = Program::of(&expr);
        for at in [[0.3, 1.7], [1.2, 0.4], [2.0, 3.0]] {
            assert_eq!(program.evaluate(&at).to_bits(), expr.evaluate(&at).to_bits(), "{text}");
        }
    }
    // Deeper than the room.
    let deep = (0..40).fold("x".to_string(), |text, i| format!("(y + {i}*{text})"));
    let expr = scope.expression(&deep).unwrap();
    assert_eq!(Program::of(&expr).evaluate(&[1e-9, 0.5]), expr.evaluate(&[1e-9, 0.5]));
    assert!(Program::of(&Expr::integer(0)).is_zero() && !Program::of(&Expr::Variable(0)).is_zero());
}
