//! Automatic differentiation: the value of an expression with its gradient and Hessian.

use super::evaluate::Value;
use super::{Expr, Function};
use crate::scalar::Real;
use num_rational::BigRational;

/// A number with its first and second derivatives in some variables. Evaluating an expression in jets gives its
/// derivatives, exact up to rounding, without forming them as expressions. Second derivatives are computed only where
/// they are asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Jet<T = f64> {
    /// The value.
    pub value: T,
    /// The gradient, `[variables]`; empty for a constant.
    pub gradient: Vec<T>,
    /// The Hessian, `[variables × variables]`, both triangles; empty for a constant.
    pub hessian: Vec<T>,
}

/// The numbers of which derivatives can be computed: `f64` and [`DoubleDouble`](crate::scalar::DoubleDouble).
pub trait Differentiable: Value + Real + From<f64> {}

impl<T: Value + Real + From<f64>> Differentiable for T {}

impl<T: Differentiable> Jet<T> {
    /// The value, gradient and Hessian of `expr` at the point `at`; NaN where it has no value.
    pub fn evaluate(expr: &Expr, at: &[T]) -> Jet<T> {
        Jet::of_order(expr, at, at.len() * at.len())
    }

    /// The value and the gradient of `expr` at the point `at`, without the Hessian.
    pub fn gradient(expr: &Expr, at: &[T]) -> Vec<T> {
        Jet::of_order(expr, at, 0).gradient
    }

    /// The variables themselves as jets, with both derivatives.
    pub fn variables(at: &[T]) -> Vec<Jet<T>> {
        Jet::variables_of_order(at, at.len() * at.len())
    }

    /// The variables as jets whose Hessians have `second` entries: all or none.
    fn variables_of_order(at: &[T], second: usize) -> Vec<Jet<T>> {
        let variable = |i: usize| {
            let mut gradient = vec![T::from(0.0); at.len()];
            gradient[i] = T::from(1.0);
            Jet { value: at[i].clone(), gradient, hessian: vec![T::from(0.0); second] }
        };
        (0..at.len()).map(variable).collect()
    }

    /// A constant.
    pub fn number(value: T) -> Jet<T> {
        Jet { value, gradient: Vec::new(), hessian: Vec::new() }
    }

    /// `self + other`.
    pub fn sum(self, other: &Jet<T>) -> Jet<T> {
        self.plus(other.clone())
    }

    /// `self · other`.
    pub fn product(self, other: &Jet<T>) -> Jet<T> {
        self.times(other.clone())
    }

    fn of_order(expr: &Expr, at: &[T], second: usize) -> Jet<T> {
        Jet::of_variables(expr, &Jet::variables_of_order(at, second), at.len(), second)
    }

    /// The value of `expr` at these jets in `n` variables; NaN where it has no value.
    fn of_variables(expr: &Expr, at: &[Jet<T>], n: usize, second: usize) -> Jet<T> {
        let nan = || T::from(f64::NAN);
        let nothing = || Jet { value: nan(), gradient: vec![nan(); n], hessian: vec![nan(); second] };
        let mut jet = expr.value(at).unwrap_or_else(nothing);
        jet.gradient.resize(n, T::from(0.0));
        jet.hessian.resize(second, T::from(0.0));
        jet
    }

    /// The chain rule for `f(self)`, with `f`, `f′` and `f″` at the value.
    fn chain(self, value: T, first: &T, second: &T) -> Jet<T> {
        let n = self.gradient.len();
        let mut jet = Jet { value, ..self };
        for (k, entry) in jet.hessian.iter_mut().enumerate() {
            let bend = second.clone() * &jet.gradient[k / n] * &jet.gradient[k % n];
            *entry = first.clone() * entry + &bend;
        }
        jet.gradient.iter_mut().for_each(|g| *g = g.clone() * first);
        jet
    }
}

impl Expr {
    /// The value where the variables of the expression are the jets `at`, which depend on `n` variables of their own;
    /// NaN where it has no value.
    pub fn jet<T: Differentiable>(&self, at: &[Jet<T>], n: usize) -> Jet<T> {
        Jet::of_variables(self, at, n, n * n)
    }
}

impl<T: Differentiable> Value for Jet<T> {
    fn from_rational(c: &BigRational) -> Option<Jet<T>> {
        T::from_rational(c).map(Jet::number)
    }

    fn plus(self, other: Jet<T>) -> Jet<T> {
        // A constant has no lists, to which nothing could be added: the other one is kept.
        let (mut sum, other) = if self.gradient.is_empty() { (other, self) } else { (self, other) };
        sum.value = sum.value + &other.value;
        sum.gradient.iter_mut().zip(&other.gradient).for_each(|(a, b)| *a = a.clone() + b);
        sum.hessian.iter_mut().zip(&other.hessian).for_each(|(a, b)| *a = a.clone() + b);
        sum
    }

    fn times(self, other: Jet<T>) -> Jet<T> {
        let (a, b) = if self.gradient.is_empty() { (other, self) } else { (self, other) };
        if b.gradient.is_empty() {
            let value = a.value.clone() * &b.value;
            return a.chain(value, &b.value, &T::from(0.0));
        }
        let n = a.gradient.len();
        let mut hessian = vec![T::from(0.0); a.hessian.len()];
        for (k, entry) in hessian.iter_mut().enumerate() {
            let (i, j) = (k / n, k % n);
            let mixed = a.gradient[i].clone() * &b.gradient[j] + &(a.gradient[j].clone() * &b.gradient[i]);
            *entry = a.value.clone() * &b.hessian[k] + &(b.value.clone() * &a.hessian[k]) + &mixed;
        }
        let slope = |(da, db): (&T, &T)| a.value.clone() * db + &(b.value.clone() * da);
        let gradient = a.gradient.iter().zip(&b.gradient).map(slope).collect();
        Jet { value: a.value * &b.value, gradient, hessian }
    }

    fn to_power(self, exponent: &BigRational) -> Option<Jet<T>> {
        let (x, p) = (self.value.clone(), T::from_rational(exponent)?);
        let power = |shift: i64| x.clone().to_power(&(exponent - BigRational::from_integer(shift.into())));
        // A factor of zero stays zero even if the lower power is infinite.
        let times = |factor: T, power: T| if factor.rounded() == 0.0 { T::from(0.0) } else { factor * &power };
        let twice = p.clone() * &(p.clone() - &T::from(1.0));
        Some(self.chain(power(0)?, &times(p, power(1)?), &times(twice, power(2)?)))
    }

    fn apply(self, function: Function) -> Option<Jet<T>> {
        let x = self.value.clone();
        let of = |function| x.clone().apply(function);
        let number = |c: f64| T::from(c);
        let value = of(function)?;
        let (first, second) = match function {
            Function::Exp => (value.clone(), value.clone()),
            Function::Ln => (number(1.0) / &x, number(-1.0) / &(x.clone() * &x)),
            Function::Sin => (of(Function::Cos)?, value.negated()),
            Function::Cos => (of(Function::Sin)?.negated(), value.negated()),
            Function::Tan => {
                let first = number(1.0) + &(value.clone() * &value);
                (first.clone(), number(2.0) * &value * &first)
            }
            Function::Asin | Function::Acos => {
                let root = (number(1.0) - &(x.clone() * &x)).sqrt();
                let sign = number(if function == Function::Asin { 1.0 } else { -1.0 });
                let cube = root.clone() * &root * &root;
                (sign.clone() / &root, sign * &x / &cube)
            }
            Function::Atan => {
                let first = number(1.0) / &(number(1.0) + &(x.clone() * &x));
                (first.clone(), number(-2.0) * &x * &first * &first)
            }
            // At zero the absolute value has no derivative. The slope to the right of zero is taken.
            Function::Abs => (number(x.rounded().signum()), number(0.0)),
            Function::Step => (number(0.0), number(0.0)),
        };
        Some(self.chain(value, &first, &second))
    }
}
