use super::evaluate::Value;
use super::{Expr, Function};
use crate::scalar::Real;
use num_rational::BigRational;

/// A number with its first and second derivatives in some variables: what an expression evaluates to, exact but for
/// rounding, without forming the derivatives as expressions. Without the second ones where they are not asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Jet<T = f64> {
    pub value: T,
    /// `[variables]`; empty for a constant.
    pub gradient: Vec<T>,
    /// `[variables × variables]`, both triangles; empty for a constant.
    pub hessian: Vec<T>,
}

/// The numbers that have derivatives: doubles, and pairs of them.
pub trait Differentiable: Value + Real + From<f64> {}

impl<T: Value + Real + From<f64>> Differentiable for T {}

impl<T: Differentiable> Jet<T> {
    /// `expr`, its gradient and its Hessian at the point `at`; NaN where it has none.
    pub fn evaluate(expr: &Expr, at: &[T]) -> Jet<T> {
        Jet::of_order(expr, at, at.len() * at.len())
    }

    /// The gradient of `expr` alone.
    pub fn gradient(expr: &Expr, at: &[T]) -> Vec<T> {
        Jet::of_order(expr, at, 0).gradient
    }

    /// The variables themselves, with both derivatives.
    pub fn variables(at: &[T]) -> Vec<Jet<T>> {
        Jet::variables_of_order(at, at.len() * at.len())
    }

    /// `second` entries of the Hessian, all or none.
    fn variables_of_order(at: &[T], second: usize) -> Vec<Jet<T>> {
        let variable = |i: usize| {
            let mut gradient = vec![T::from(0.0); at.len()];
            gradient[i] = T::from(1.0);
            Jet { value: at[i].clone(), gradient, hessian: vec![T::from(0.0); second] }
        };
        (0..at.len()).map(variable).collect()
    }

    /// A number that no variable changes.
    pub fn number(value: T) -> Jet<T> {
        Jet { value, gradient: Vec::new(), hessian: Vec::new() }
    }

    pub fn sum(self, other: &Jet<T>) -> Jet<T> {
        self.plus(other.clone())
    }

    pub fn product(self, other: &Jet<T>) -> Jet<T> {
        self.times(other.clone())
    }

    fn of_order(expr: &Expr, at: &[T], second: usize) -> Jet<T> {
        Jet::of_variables(expr, &Jet::variables_of_order(at, second), at.len(), second)
    }

    /// `expr` of these jets, which have `n` variables; NaN where it has no value.
    fn of_variables(expr: &Expr, at: &[Jet<T>], n: usize, second: usize) -> Jet<T> {
        let nan = || T::from(f64::NAN);
        let nothing = || Jet { value: nan(), gradient: vec![nan(); n], hessian: vec![nan(); second] };
        let mut jet = expr.value(at).unwrap_or_else(nothing);
        jet.gradient.resize(n, T::from(0.0));
        jet.hessian.resize(second, T::from(0.0));
        jet
    }

    /// `f(self)` with `f′` and `f″` at the value.
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
    /// The value where the variables are these jets, in `n` variables of their own; NaN where it has none.
    pub fn jet<T: Differentiable>(&self, at: &[Jet<T>], n: usize) -> Jet<T> {
        Jet::of_variables(self, at, n, n * n)
    }
}

impl<T: Differentiable> Value for Jet<T> {
    fn from_rational(c: &BigRational) -> Option<Jet<T>> {
        T::from_rational(c).map(Jet::number)
    }

    fn plus(self, other: Jet<T>) -> Jet<T> {
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
        // A factor of zero stays zero where the power below it is infinite.
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
            Function::Abs => (number(x.rounded().signum()), number(0.0)),
            Function::Step => (number(0.0), number(0.0)),
        };
        Some(self.chain(value, &first, &second))
    }
}
