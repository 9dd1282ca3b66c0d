//! Conditions on variables, such as `z < 1e-9 && x > 0`, by which nodes of a mesh are selected.

use super::Expr;

/// A condition that holds or does not hold at a point.
#[derive(Debug, Clone, PartialEq)]
pub enum Predicate {
    /// A comparison of two expressions.
    Compare(Comparison, Expr, Expr),
    /// Both conditions hold.
    And(Box<Predicate>, Box<Predicate>),
    /// At least one condition holds.
    Or(Box<Predicate>, Box<Predicate>),
    /// The condition does not hold.
    Not(Box<Predicate>),
}

/// The comparison of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    LessOrEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterOrEqual,
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
}

impl Predicate {
    /// Whether the condition holds at the point `at`, which has one entry per variable.
    pub fn holds(&self, at: &[f64]) -> bool {
        match self {
            Predicate::Compare(comparison, left, right) => {
                let (l, r) = (left.evaluate(at), right.evaluate(at));
                match comparison {
                    Comparison::Less => l < r,
                    Comparison::LessOrEqual => l <= r,
                    Comparison::Greater => l > r,
                    Comparison::GreaterOrEqual => l >= r,
                    Comparison::Equal => l == r,
                    Comparison::NotEqual => l != r,
                }
            }
            Predicate::And(a, b) => a.holds(at) && b.holds(at),
            Predicate::Or(a, b) => a.holds(at) || b.holds(at),
            Predicate::Not(a) => !a.holds(at),
        }
    }
}
