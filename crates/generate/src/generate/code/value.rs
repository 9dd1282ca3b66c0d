//! Values of the function that is being written, as numbers with which the kernels compute.

use super::body::Body;
use super::index::Index;
use super::node::{Call, Node};
use crate::fit::published::Quantity;
use crate::scalar::Scalar;
use crate::symbolic::Function;
use num_traits::{One, Zero};
use std::ops::{Add, Div, Mul, Sub};

/// A value of a function that is being written. A kernel that computes with values writes its operations into the
/// function; a comparison becomes a guard and counts as true.
#[derive(Debug, Clone)]
pub struct Value {
    body: Body,
    number: usize,
}

impl Body {
    fn value(&self, node: Node) -> Value {
        Value::new(self, self.make(node))
    }

    /// A number.
    pub fn number(&self, number: f64) -> Value {
        self.value(Node::of_number(number))
    }

    /// A parameter that is a number.
    pub fn parameter(&self, name: &str) -> Value {
        self.value(Node::Parameter(self.add_parameter(name)))
    }

    /// An entry of an array.
    pub fn entry(&self, array: usize, at: impl Into<Index>) -> Value {
        self.value(self.read(array, at.into()))
    }

    /// 1 if two indices are equal, otherwise 0.
    pub fn equal(&self, a: &Index, b: &Index) -> Value {
        match (a == b, a.number(), b.number()) {
            (true, _, _) => self.number(1.0),
            (false, Some(_), Some(_)) => self.number(0.0),
            (false, ..) => self.value(Node::Equal(a.clone(), b.clone())),
        }
    }

    /// Writes an entry of an array.
    pub fn store(&self, array: usize, at: impl Into<Index>, value: &Value) {
        self.write(array, at.into(), value.number);
    }

    /// Ends the function unless `greater > than`.
    pub fn guard(&self, greater: &Value, than: &Value) {
        self.require(greater.number, than.number);
    }
}

impl Value {
    fn new(body: &Body, number: usize) -> Value {
        Value { body: body.clone(), number }
    }

    /// Its number in the function.
    pub fn number_in_body(&self) -> usize {
        self.number
    }

    /// The number, if the value is one.
    pub fn as_number(&self) -> Option<f64> {
        self.node().number()
    }

    fn node(&self) -> Node {
        self.body.node(self.number)
    }

    fn of(&self, node: Node) -> Value {
        self.body.value(node)
    }

    fn other(&self, number: usize) -> Value {
        Value::new(&self.body, number)
    }

    /// A number of the same function.
    pub fn like(&self, number: f64) -> Value {
        self.body.number(number)
    }

    /// `−self`.
    pub fn negated(&self) -> Value {
        match self.node() {
            // Signs are moved outwards and cancel there: equal values become one node only if they are written alike.
            Node::Negate(a) => self.other(a),
            Node::Subtract(a, b) => self.of(Node::Subtract(b, a)),
            Node::Number(bits) => self.like(-f64::from_bits(bits)),
            _ => self.of(Node::Negate(self.number)),
        }
    }

    /// The square root.
    pub fn root(&self) -> Value {
        match self.as_number() {
            Some(number) => self.like(number.sqrt()),
            None => self.of(Node::Root(self.number)),
        }
    }

    /// `self` to a constant exponent.
    pub fn power(&self, exponent: f64) -> Value {
        // Products are exact to their rounding and cheap up to some multiplications; a power is a call of a library.
        let whole = exponent.fract() == 0.0 && exponent.abs() <= 64.0;
        if exponent < 0.0 {
            return self.like(1.0) / &self.power(-exponent);
        }
        if exponent == 0.5 {
            return self.root();
        }
        if !whole {
            return self.of(Node::Power(self.number, exponent.to_bits()));
        }
        // Repeated squaring needs as many products as the exponent has bits, at most twice.
        let (mut result, mut square, mut left) = (self.like(1.0), self.clone(), exponent as u32);
        while left > 0 {
            if left % 2 == 1 {
                result = result * &square;
            }
            left /= 2;
            if left > 0 {
                square = square.clone() * &square;
            }
        }
        result
    }

    /// A function of the value.
    pub fn call(&self, function: Function) -> Value {
        self.of(Node::Call(Call(function), self.number))
    }

    /// `yes` if `self > other`, otherwise `no`.
    pub fn select(&self, other: &Value, yes: &Value, no: &Value) -> Value {
        match (self.as_number(), other.as_number()) {
            (Some(a), Some(b)) => if a > b { yes } else { no }.clone(),
            // Equal operations are one node, so that equal numbers of nodes are equal values.
            _ if yes.number == no.number => yes.clone(),
            _ => self.of(Node::Select([self.number, other.number, yes.number, no.number])),
        }
    }
}

impl Add<&Value> for Value {
    type Output = Value;

    fn add(self, other: &Value) -> Value {
        match (self.node(), other.node()) {
            (Node::Number(a), Node::Number(b)) => self.like(f64::from_bits(a) + f64::from_bits(b)),
            (Node::Number(0), _) => other.clone(),
            (_, Node::Number(0)) => self,
            (_, Node::Negate(b)) => {
                let b = self.other(b);
                self - &b
            }
            (Node::Negate(a), _) => other.clone() - &self.other(a),
            // The sum has no order: `a + b` and `b + a` become one node.
            _ => self.of(Node::Add(self.number.min(other.number), self.number.max(other.number))),
        }
    }
}

impl Sub<&Value> for Value {
    type Output = Value;

    fn sub(self, other: &Value) -> Value {
        match (self.node(), other.node()) {
            (Node::Number(a), Node::Number(b)) => self.like(f64::from_bits(a) - f64::from_bits(b)),
            (_, Node::Number(0)) => self,
            (Node::Number(0), _) => other.negated(),
            (_, Node::Negate(b)) => {
                let b = self.other(b);
                self + &b
            }
            _ if self.number == other.number => self.like(0.0),
            _ => self.of(Node::Subtract(self.number, other.number)),
        }
    }
}

impl Mul<&Value> for Value {
    type Output = Value;

    fn mul(self, other: &Value) -> Value {
        match (self.node(), other.node()) {
            (Node::Number(a), Node::Number(b)) => self.like(f64::from_bits(a) * f64::from_bits(b)),
            (Node::Number(a), _) => other.times(f64::from_bits(a)),
            (_, Node::Number(b)) => self.times(f64::from_bits(b)),
            (Node::Negate(a), Node::Negate(b)) => self.other(a) * &self.other(b),
            (Node::Negate(a), _) => (self.other(a) * other).negated(),
            (_, Node::Negate(b)) => (self.clone() * &self.other(b)).negated(),
            _ => self.of(Node::Multiply(self.number.min(other.number), self.number.max(other.number))),
        }
    }
}

impl Value {
    fn times(&self, factor: f64) -> Value {
        if factor == 0.0 {
            self.like(0.0)
        } else if factor == 1.0 {
            self.clone()
        } else if factor < 0.0 {
            self.times(-factor).negated()
        } else if let Node::Negate(a) = self.node() {
            self.other(a).times(factor).negated()
        } else {
            self.of(Node::Multiply(self.like(factor).number, self.number))
        }
    }
}

impl Div<&Value> for Value {
    type Output = Value;

    fn div(self, other: &Value) -> Value {
        match (self.node(), other.node()) {
            (Node::Number(a), Node::Number(b)) => self.like(f64::from_bits(a) / f64::from_bits(b)),
            (Node::Number(0), _) => self,
            (Node::Negate(a), _) => (self.other(a) / other).negated(),
            (_, Node::Number(bits)) if f64::from_bits(bits) == 1.0 => self,
            _ => self.of(Node::Divide(self.number, other.number)),
        }
    }
}

macro_rules! of_references {
    ($($trait:ident $function:ident),+) => {
        $(impl $trait<&Value> for &Value {
            type Output = Value;

            fn $function(self, other: &Value) -> Value {
                self.clone().$function(other)
            }
        })+
    };
}

of_references!(Add add, Sub sub, Mul mul, Div div);

macro_rules! of_values {
    ($($trait:ident $function:ident),+) => {
        $(impl $trait for Value {
            type Output = Value;

            fn $function(self, other: Value) -> Value {
                self.$function(&other)
            }
        }

        impl $trait<f64> for Value {
            type Output = Value;

            fn $function(self, other: f64) -> Value {
                let other = self.like(other);
                self.$function(&other)
            }
        })+
    };
}

of_values!(Add add, Sub sub, Mul mul, Div div);

impl Quantity for Value {
    fn cube_root(self) -> Value {
        self.power(1.0 / 3.0)
    }

    fn positive_part(self) -> Value {
        let zero = self.like(0.0);
        self.select(&zero, &self, &zero)
    }
}

/// An entry of a tabulation or a modulus: a number, or a value of the function.
#[derive(Debug, Clone)]
pub enum Constant {
    /// A number that is known when the function is written.
    Number(f64),
    /// A value.
    Value(Value),
}

impl Constant {
    /// Converts the constant to a value of the function of `any`.
    fn value(&self, any: &Value) -> Value {
        match self {
            Constant::Number(number) => any.like(*number),
            Constant::Value(value) => value.clone(),
        }
    }

    fn combined(self, other: Constant, numbers: fn(f64, f64) -> f64, values: fn(Value, &Value) -> Value) -> Constant {
        match (&self, &other) {
            (Constant::Number(a), Constant::Number(b)) => Constant::Number(numbers(*a, *b)),
            (Constant::Value(any), _) | (_, Constant::Value(any)) => {
                Constant::Value(values(self.value(any), &other.value(any)))
            }
        }
    }
}

impl Add for Constant {
    type Output = Constant;

    fn add(self, other: Constant) -> Constant {
        self.combined(other, |a, b| a + b, |a, b| a + b)
    }
}

impl Mul for Constant {
    type Output = Constant;

    fn mul(self, other: Constant) -> Constant {
        self.combined(other, |a, b| a * b, |a, b| a * b)
    }
}

impl Zero for Constant {
    fn zero() -> Constant {
        Constant::Number(0.0)
    }

    fn is_zero(&self) -> bool {
        matches!(self, Constant::Number(0.0))
    }
}

impl One for Constant {
    fn one() -> Constant {
        Constant::Number(1.0)
    }
}

impl Scalar for Value {
    type Constant = Constant;

    fn exact(value: f64) -> Constant {
        Constant::Number(value)
    }

    fn epsilon() -> f64 {
        f64::EPSILON / 2.0
    }

    fn constant(&self, c: &Constant) -> Value {
        c.value(self)
    }

    fn scaled(self, c: &Constant) -> Value {
        let factor = c.value(&self);
        self * &factor
    }

    fn plus_product(self, a: &Value, b: &Value) -> Value {
        self + &(a.clone() * b)
    }

    fn minus_product(self, a: &Value, b: &Value) -> Value {
        self - &(a.clone() * b)
    }

    fn exceeds(&self, other: &Value) -> bool {
        self.body.guard(self, other);
        true
    }
}
