//! Expressions in named variables: read from text, differentiated, evaluated, expanded into polynomials.
//!
//! Constants are exact rationals, so `1/3` is one third until a number is asked for.

mod differentiate;
mod evaluate;
mod expand;
mod fraction;
mod jet;
mod parse;
mod precise;
mod predicate;
mod print;
mod program;

pub use fraction::{Fraction, Polynomial};
pub use jet::{Differentiable, Jet};
pub use parse::{Scope, parse_rational, variables_of};
pub use predicate::Predicate;
pub use program::Program;

use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// A real function of real variables, which are known by their index.
#[derive(Debug, Clone, PartialEq)]
pub enum Expr {
    Number(BigRational),
    Variable(usize),
    Sum(Vec<Expr>),
    Product(Vec<Expr>),
    Power(Box<Expr>, BigRational),
    Call(Function, Box<Expr>),
}

/// The functions an expression may call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    Exp,
    Ln,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Abs,
    /// 1 from 0 on, 0 below.
    Step,
}

impl Function {
    pub const ALL: [(&'static str, Function); 10] = [
        ("exp", Function::Exp),
        ("ln", Function::Ln),
        ("sin", Function::Sin),
        ("cos", Function::Cos),
        ("tan", Function::Tan),
        ("asin", Function::Asin),
        ("acos", Function::Acos),
        ("atan", Function::Atan),
        ("abs", Function::Abs),
        ("step", Function::Step),
    ];

    pub fn name(self) -> &'static str {
        Function::ALL.iter().find(|(_, f)| *f == self).map_or("", |(name, _)| name)
    }
}

/// Beyond this exponent a power of a number stays unevaluated, so that no text can ask for gigabytes of digits.
const LARGEST_FOLDED_EXPONENT: i64 = 256;

impl Expr {
    pub fn integer(value: i64) -> Expr {
        Expr::Number(BigRational::from_integer(value.into()))
    }

    /// `Σ terms`, flattened, with the constants added up.
    pub fn sum(terms: impl IntoIterator<Item = Expr>) -> Expr {
        let mut constant = BigRational::zero();
        let mut rest = Vec::new();
        for term in terms {
            match term {
                Expr::Number(c) => constant += c,
                Expr::Sum(inner) => {
                    for t in inner {
                        if let Expr::Number(c) = t { constant += c } else { rest.push(t) }
                    }
                }
                other => rest.push(other),
            }
        }
        if !constant.is_zero() {
            rest.insert(0, Expr::Number(constant));
        }
        match rest.len() {
            0 => Expr::integer(0),
            1 => rest.remove(0),
            _ => Expr::Sum(rest),
        }
    }

    /// `Π factors`, flattened, with the constants multiplied; zero if a factor is.
    pub fn product(factors: impl IntoIterator<Item = Expr>) -> Expr {
        let mut constant = BigRational::one();
        let mut rest = Vec::new();
        for factor in factors {
            match factor {
                Expr::Number(c) => constant *= c,
                Expr::Product(inner) => {
                    for f in inner {
                        if let Expr::Number(c) = f { constant *= c } else { rest.push(f) }
                    }
                }
                other => rest.push(other),
            }
        }
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

    /// `base ^ exponent` with a constant exponent.
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

    pub fn negated(self) -> Expr {
        Expr::product([Expr::integer(-1), self])
    }

    pub fn call(function: Function, argument: Expr) -> Expr {
        Expr::Call(function, Box::new(argument))
    }

    /// The number, if the expression is one.
    pub fn as_number(&self) -> Option<&BigRational> {
        if let Expr::Number(c) = self { Some(c) } else { None }
    }

    /// Whether the variable occurs in it.
    pub fn uses(&self, variable: usize) -> bool {
        match self {
            Expr::Number(_) => false,
            Expr::Variable(v) => *v == variable,
            Expr::Sum(inner) | Expr::Product(inner) => inner.iter().any(|e| e.uses(variable)),
            Expr::Power(inner, _) | Expr::Call(_, inner) => inner.uses(variable),
        }
    }

    /// How many numbers, variables and operations it consists of.
    pub fn parts(&self) -> usize {
        1 + match self {
            Expr::Number(_) | Expr::Variable(_) => 0,
            Expr::Sum(inner) | Expr::Product(inner) => inner.iter().map(Expr::parts).sum(),
            Expr::Power(inner, _) | Expr::Call(_, inner) => inner.parts(),
        }
    }

    /// Bits of the constant that was last folded: the number itself, or the first of a sum or product.
    fn largest_constant(&self) -> u64 {
        match self {
            Expr::Number(c) => c.numer().bits().max(c.denom().bits()),
            Expr::Sum(inner) | Expr::Product(inner) => inner[0].largest_constant(),
            _ => 0,
        }
    }

    /// Whether it prints with a leading minus.
    fn is_negative(&self) -> bool {
        match self {
            Expr::Number(c) => c.is_negative(),
            Expr::Product(factors) => factors[0].is_negative(),
            _ => false,
        }
    }
}
