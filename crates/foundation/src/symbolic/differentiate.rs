//! Exact derivatives of expressions.

use super::{Expr, Function};
use num_rational::BigRational;
use num_traits::One;

impl Expr {
    /// The exact derivative `∂self/∂variable`.
    pub fn derivative(&self, variable: usize) -> Expr {
        match self {
            Expr::Number(_) => Expr::integer(0),
            Expr::Variable(v) => Expr::integer((*v == variable) as i64),
            Expr::Sum(terms) => Expr::sum(terms.iter().map(|t| t.derivative(variable))),
            Expr::Product(factors) => Expr::sum((0..factors.len()).map(|i| {
                let others = factors.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, f)| f.clone());
                Expr::product(std::iter::once(factors[i].derivative(variable)).chain(others))
            })),
            Expr::Power(base, p) => {
                let inner = base.derivative(variable);
                let outer = Expr::power((**base).clone(), p - BigRational::one());
                Expr::product([Expr::Number(p.clone()), outer, inner])
            }
            Expr::Call(function, argument) => {
                let x = (**argument).clone();
                let inner = x.derivative(variable);
                let outer = match function {
                    Function::Exp => self.clone(),
                    Function::Ln => Expr::power(x, -BigRational::one()),
                    Function::Sin => Expr::call(Function::Cos, x),
                    Function::Cos => Expr::call(Function::Sin, x).negated(),
                    Function::Tan => {
                        Expr::sum([Expr::integer(1), Expr::power(self.clone(), BigRational::from_integer(2.into()))])
                    }
                    Function::Asin => root_of_complement(x),
                    Function::Acos => root_of_complement(x).negated(),
                    Function::Atan => Expr::power(
                        Expr::sum([Expr::integer(1), Expr::power(x, BigRational::from_integer(2.into()))]),
                        -BigRational::one(),
                    ),
                    Function::Step => Expr::integer(0),
                    Function::Abs => Expr::product([x.clone(), Expr::power(self.clone(), -BigRational::one())]),
                };
                Expr::product([outer, inner])
            }
        }
    }
}

impl Expr {
    /// An upper bound of the number of parts of a derivative before zeros are removed: the derivative of a product
    /// repeats all of its factors for each factor.
    pub fn most_parts_of_derivative(&self) -> usize {
        match self {
            Expr::Number(_) | Expr::Variable(_) => 1,
            Expr::Sum(inner) => 1 + inner.iter().map(Expr::most_parts_of_derivative).sum::<usize>(),
            Expr::Product(inner) => {
                1 + inner.len() * self.parts() + inner.iter().map(Expr::most_parts_of_derivative).sum::<usize>()
            }
            Expr::Power(inner, _) | Expr::Call(_, inner) => 8 + 2 * inner.parts() + inner.most_parts_of_derivative(),
        }
    }
}

/// `(1 − x²)^(−1/2)`.
fn root_of_complement(x: Expr) -> Expr {
    let square = Expr::power(x, BigRational::from_integer(2.into()));
    Expr::power(Expr::sum([Expr::integer(1), square.negated()]), BigRational::new((-1).into(), 2.into()))
}
