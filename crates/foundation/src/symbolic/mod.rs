//! Expressions in named variables: parsed from text, differentiated, evaluated, and expanded into polynomials.
//!
//! Shape functions, spring measures, energies and conditions on coordinates are such expressions. Constants are exact
//! rationals: `1/3` is one third until a floating-point value is asked for.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

mod differentiate;
mod evaluate;
mod expand;
mod fraction;
mod jet;
mod lex;
mod parse;
mod powers;
mod precise;
mod predicate;
mod print;
mod program;

pub use evaluate::Differentiable;
pub use fraction::{Fraction, Polynomial};
pub use jet::Jet;
pub use lex::variables_of;
pub use parse::{Scope, parse_rational};
pub use predicate::Predicate;
pub use program::{Compiled, Program};

use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// A real function of real variables. Variables are known by their index.
#[derive(Debug, Clone, PartialEq)]
pub enum Expr {
    /// A rational constant.
    Number(BigRational),
    /// The variable with this index.
    Variable(usize),
    /// The sum of the terms.
    Sum(Vec<Expr>),
    /// The product of the factors.
    Product(Vec<Expr>),
    /// A base to a constant rational exponent.
    Power(Box<Expr>, BigRational),
    /// A function of one argument.
    Call(Function, Box<Expr>),
}

/// The functions that an expression may call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// `e^x`.
    Exp,
    /// The natural logarithm.
    Ln,
    /// The sine of an angle in radians.
    Sin,
    /// The cosine of an angle in radians.
    Cos,
    /// The tangent of an angle in radians.
    Tan,
    /// The inverse sine, in radians.
    Asin,
    /// The inverse cosine, in radians.
    Acos,
    /// The inverse tangent, in radians.
    Atan,
    /// The absolute value.
    Abs,
    /// The unit step: 1 for x ≥ 0, 0 below.
    Step,
}

crate::named!(Function {
    "exp" => Exp, "ln" => Ln, "sin" => Sin, "cos" => Cos, "tan" => Tan, "asin" => Asin, "acos" => Acos, "atan" => Atan,
    "abs" => Abs, "step" => Step,
});

/// A power of a number with a larger exponent stays unevaluated, so that no text can ask for gigabytes of digits.
const LARGEST_FOLDED_EXPONENT: i64 = 256;

impl Expr {
    /// The number `value`.
    pub fn integer(value: i64) -> Expr {
        Expr::Number(BigRational::from_integer(value.into()))
    }

    /// `Σ terms`. Sums in it are flattened and constants are added.
    pub fn sum(terms: impl IntoIterator<Item = Expr>) -> Expr {
        let flat = terms.into_iter().flat_map(|term| match term {
            Expr::Sum(inner) => inner,
            other => vec![other],
        });
        let (constants, mut rest): (Vec<Expr>, Vec<Expr>) = flat.partition(|term| term.as_number().is_some());
        let constant: BigRational = constants.iter().filter_map(Expr::as_number).sum();
        if !constant.is_zero() {
            rest.insert(0, Expr::Number(constant));
        }
        match rest.len() {
            0 => Expr::integer(0),
            1 => rest.remove(0),
            _ => Expr::Sum(rest),
        }
    }

    /// `Π factors`. Products in it are flattened and constants are multiplied; zero if a factor is zero.
    pub fn product(factors: impl IntoIterator<Item = Expr>) -> Expr {
        let flat = factors.into_iter().flat_map(|factor| match factor {
            Expr::Product(inner) => inner,
            other => vec![other],
        });
        let (constants, mut rest): (Vec<Expr>, Vec<Expr>) = flat.partition(|factor| factor.as_number().is_some());
        let constant: BigRational = constants.iter().filter_map(Expr::as_number).product();
        if constant.is_zero() {
            return Expr::integer(0);
        }
        if !constant.is_one() {
            rest.insert(0, Expr::Number(constant));
        }
        match rest.len() {
            0 => Expr::integer(1),
            1 => rest.remove(0),
            _ => Expr::Product(rest),
        }
    }

    /// `base ^ exponent`, with a constant exponent.
    pub fn power(base: Expr, exponent: BigRational) -> Expr {
        if exponent.is_zero() {
            return Expr::integer(1);
        }
        if exponent.is_one() {
            return base;
        }
        if let (Expr::Number(c), true) = (&base, exponent.is_integer())
            && let Some(n) = exponent.to_i64().filter(|n| n.abs() <= LARGEST_FOLDED_EXPONENT)
            && !(c.is_zero() && n < 0)
        {
            return Expr::Number(num_traits::Pow::pow(c.clone(), n as i32));
        }
        Expr::Power(Box::new(base), exponent)
    }

    /// `−self`.
    pub fn negated(self) -> Expr {
        Expr::product([Expr::integer(-1), self])
    }

    /// `function(argument)`.
    pub fn call(function: Function, argument: Expr) -> Expr {
        Expr::Call(function, Box::new(argument))
    }

    /// The number, if the expression is a constant.
    pub fn as_number(&self) -> Option<&BigRational> {
        if let Expr::Number(c) = self { Some(c) } else { None }
    }

    /// Whether the variable occurs in the expression.
    pub fn uses(&self, variable: usize) -> bool {
        match self {
            Expr::Number(_) => false,
            Expr::Variable(v) => *v == variable,
            Expr::Sum(inner) | Expr::Product(inner) => inner.iter().any(|e| e.uses(variable)),
            Expr::Power(inner, _) | Expr::Call(_, inner) => inner.uses(variable),
        }
    }

    /// How many numbers, variables and operations the expression consists of.
    pub fn parts(&self) -> usize {
        1 + match self {
            Expr::Number(_) | Expr::Variable(_) => 0,
            Expr::Sum(inner) | Expr::Product(inner) => inner.iter().map(Expr::parts).sum(),
            Expr::Power(inner, _) | Expr::Call(_, inner) => inner.parts(),
        }
    }

    /// The number of bits of the constant that was folded last: the expression itself, or the first operand of a sum or
    /// product.
    fn largest_constant(&self) -> u64 {
        match self {
            Expr::Number(c) => c.numer().bits().max(c.denom().bits()),
            Expr::Sum(inner) | Expr::Product(inner) => inner[0].largest_constant(),
            _ => 0,
        }
    }

    /// Whether the expression prints with a leading minus sign.
    fn is_negative(&self) -> bool {
        match self {
            Expr::Number(c) => c.is_negative(),
            Expr::Product(factors) => factors[0].is_negative(),
            _ => false,
        }
    }
}
