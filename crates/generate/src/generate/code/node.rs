//! The operations of which values consist.

use super::index::Index;
use crate::symbolic::Function;
use std::hash::{Hash, Hasher};

/// A function that is called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Call(pub Function);

impl Hash for Call {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.name().hash(state);
    }
}

/// One operation. Its operands are values, by their numbers.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Node {
    /// A number, by its bits.
    Number(u64),
    /// A parameter of the function, by its place.
    Parameter(usize),
    /// An entry of an array; after each write to the array, its entries are other values.
    Entry { array: usize, at: Index, writes: usize },
    /// 1 if two indices are equal, otherwise 0.
    Equal(Index, Index),
    /// `a + b`.
    Add(usize, usize),
    /// `a − b`.
    Subtract(usize, usize),
    /// `a b`.
    Multiply(usize, usize),
    /// `a/b`.
    Divide(usize, usize),
    /// `−a`.
    Negate(usize),
    /// The square root.
    Root(usize),
    /// A base to a constant exponent, given by its bits, for bases above zero.
    Power(usize, u64),
    /// A function of one argument.
    Call(Call, usize),
    /// The third value if the first is greater than the second, otherwise the fourth.
    Select([usize; 4]),
}

impl Node {
    /// A number.
    pub fn of_number(number: f64) -> Node {
        // Minus zero would be another value than zero.
        Node::Number((number + 0.0).to_bits())
    }

    /// The number, if the node is one.
    pub fn number(&self) -> Option<f64> {
        if let Node::Number(bits) = self { Some(f64::from_bits(*bits)) } else { None }
    }

    /// The values on which it depends.
    pub fn operands(&self) -> Vec<usize> {
        match self {
            Node::Number(_) | Node::Parameter(_) | Node::Entry { .. } | Node::Equal(..) => Vec::new(),
            Node::Add(a, b) | Node::Subtract(a, b) | Node::Multiply(a, b) | Node::Divide(a, b) => vec![*a, *b],
            Node::Negate(a) | Node::Root(a) | Node::Power(a, _) | Node::Call(_, a) => vec![*a],
            Node::Select(all) => all.to_vec(),
        }
    }
}
