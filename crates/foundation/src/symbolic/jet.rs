use super::evaluate::Value;
use super::{Expr, Function};
use num_rational::BigRational;
use num_traits::ToPrimitive;

/// A number with its first and second derivatives in some variables: what an expression evaluates to, exact but for
/// rounding, without forming the derivatives as expressions. Without the second ones where they are not asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Jet {
    pub value: f64,
    /// `[variables]`; empty for a constant.
    pub gradient: Vec<f64>,
    /// `[variables × variables]`, both triangles; empty for a constant.
    pub hessian: Vec<f64>,
}

impl Jet {
    /// `expr`, its gradient and its Hessian at the point `at`; NaN where it has none.
    pub fn evaluate(expr: &Expr, at: &[f64]) -> Jet {
        Jet::of_order(expr, at, at.len() * at.len())
    }

    /// The gradient of `expr` alone.
    pub fn gradient(expr: &Expr, at: &[f64]) -> Vec<f64> {
        Jet::of_order(expr, at, 0).gradient
    }

    /// The variables themselves, with both derivatives.
    pub fn variables(at: &[f64]) -> Vec<Jet> {
        Jet::variables_of_order(at, at.len() * at.len())
    }

    /// `second` entries of the Hessian, all or none.
    fn variables_of_order(at: &[f64], second: usize) -> Vec<Jet> {
        let variable = |i: usize| {
            let mut gradient = vec![0.0; at.len()];
            gradient[i] = 1.0;
            Jet { value: at[i], gradient, hessian: vec![0.0; second] }
        };
        (0..at.len()).map(variable).collect()
    }

    /// A number that no variable changes.
    pub fn number(value: f64) -> Jet {
        Jet { value, gradient: Vec::new(), hessian: Vec::new() }
    }

    pub fn sum(self, other: &Jet) -> Jet {
        self.plus(other.clone())
    }

    pub fn product(self, other: &Jet) -> Jet {
        self.times(other.clone())
    }

    fn of_order(expr: &Expr, at: &[f64], second: usize) -> Jet {
        Jet::of_variables(expr, &Jet::variables_of_order(at, second), at.len(), second)
    }

    /// `expr` of these jets, which have `n` variables; NaN where it has no value.
    fn of_variables(expr: &Expr, at: &[Jet], n: usize, second: usize) -> Jet {
        let nothing = || Jet { value: f64::NAN, gradient: vec![f64::NAN; n], hessian: vec![f64::NAN; second] };
        let mut jet = expr.value(at).unwrap_or_else(nothing);
        jet.gradient.resize(n, 0.0);
        jet.hessian.resize(second, 0.0);
        jet
    }

    /// `f(self)` with `f′` and `f″` at the value.
    fn chain(self, value: f64, first: f64, second: f64) -> Jet {
        let n = self.gradient.len();
        let mut jet = Jet { value, ..self };
        for (k, entry) in jet.hessian.iter_mut().enumerate() {
            *entry = first * *entry + second * jet.gradient[k / n] * jet.gradient[k % n];
        }
        jet.gradient.iter_mut().for_each(|g| *g *= first);
        jet
    }
}

impl Expr {
    /// The value where the variables are these jets, in `n` variables of their own; NaN where it has none.
    pub fn jet(&self, at: &[Jet], n: usize) -> Jet {
        Jet::of_variables(self, at, n, n * n)
    }
}

impl Value for Jet {
    fn from_rational(c: &BigRational) -> Option<Jet> {
        c.to_f64().map(Jet::number)
    }

    fn plus(self, other: Jet) -> Jet {
        let (mut sum, other) = if self.gradient.is_empty() { (other, self) } else { (self, other) };
        sum.value += other.value;
        sum.gradient.iter_mut().zip(&other.gradient).for_each(|(a, b)| *a += b);
        sum.hessian.iter_mut().zip(&other.hessian).for_each(|(a, b)| *a += b);
        sum
    }

    fn times(self, other: Jet) -> Jet {
        let (a, b) = if self.gradient.is_empty() { (other, self) } else { (self, other) };
        if b.gradient.is_empty() {
            let value = a.value * b.value;
            return a.chain(value, b.value, 0.0);
        }
        let n = a.gradient.len();
        let mut hessian = vec![0.0; a.hessian.len()];
        for (k, entry) in hessian.iter_mut().enumerate() {
            let (i, j) = (k / n, k % n);
            let mixed = a.gradient[i] * b.gradient[j] + a.gradient[j] * b.gradient[i];
            *entry = a.value * b.hessian[k] + b.value * a.hessian[k] + mixed;
        }
        let gradient = a.gradient.iter().zip(&b.gradient).map(|(da, db)| a.value * db + b.value * da).collect();
        Jet { value: a.value * b.value, gradient, hessian }
    }

    fn to_power(self, exponent: &BigRational) -> Option<Jet> {
        let x = self.value;
        let p = exponent.to_f64()?;
        let power = |shift: i64| x.to_power(&(exponent - BigRational::from_integer(shift.into())));
        // A factor of zero stays zero where the power below it is infinite.
        let times = |factor: f64, power: f64| if factor == 0.0 { 0.0 } else { factor * power };
        Some(self.chain(power(0)?, times(p, power(1)?), times(p * (p - 1.0), power(2)?)))
    }

    fn apply(self, function: Function) -> Option<Jet> {
        let x = self.value;
        let (value, first, second) = match function {
            Function::Exp => (x.exp(), x.exp(), x.exp()),
            Function::Ln => (x.ln(), 1.0 / x, -1.0 / (x * x)),
            Function::Sin => (x.sin(), x.cos(), -x.sin()),
            Function::Cos => (x.cos(), -x.sin(), -x.cos()),
            Function::Tan => {
                let t = x.tan();
                (t, 1.0 + t * t, 2.0 * t * (1.0 + t * t))
            }
            Function::Asin | Function::Acos => {
                let root = (1.0 - x * x).sqrt();
                let sign = if function == Function::Asin { 1.0 } else { -1.0 };
                let value = if function == Function::Asin { x.asin() } else { x.acos() };
                (value, sign / root, sign * x / (root * root * root))
            }
            Function::Atan => {
                let first = 1.0 / (1.0 + x * x);
                (x.atan(), first, -2.0 * x * first * first)
            }
            Function::Abs => (x.abs(), x.signum(), 0.0),
            Function::Step => (f64::from(u8::from(x >= 0.0)), 0.0, 0.0),
        };
        Some(self.chain(value, first, second))
    }
}
