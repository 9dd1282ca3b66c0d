//! Expressions of what springs measure, as code.

use super::Value;
use crate::symbolic::{Expr, Function};

/// The value of an expression whose variables have the values `at`; `any` is any value of the function.
pub fn value(expression: &Expr, at: &[Value], any: &Value) -> Value {
    match expression {
        Expr::Number(_) => any.like(expression.evaluate(&[])),
        Expr::Variable(variable) => at[*variable].clone(),
        Expr::Sum(terms) => terms.iter().fold(any.like(0.0), |sum, term| sum + &value(term, at, any)),
        Expr::Product(factors) => factors.iter().fold(any.like(1.0), |product, f| product * &value(f, at, any)),
        Expr::Power(base, exponent) => value(base, at, any).power(Expr::Number(exponent.clone()).evaluate(&[])),
        Expr::Call(Function::Step, argument) => {
            let argument = value(argument, at, any);
            // The step is one at zero, so that zero must not exceed the argument.
            any.like(0.0).select(&argument, &any.like(0.0), &any.like(1.0))
        }
        Expr::Call(function, argument) => value(argument, at, any).call(*function),
    }
}
