//! Conditions on variables, such as `z < 1e-9 && x > 0`.

use super::Expr;

#[derive(Debug, Clone, PartialEq)]
pub enum Predicate {
    Compare(Comparison, Expr, Expr),
    And(Box<Predicate>, Box<Predicate>),
    Or(Box<Predicate>, Box<Predicate>),
    Not(Box<Predicate>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
}

impl Predicate {
    /// Whether the condition holds at `at`, one entry per variable.
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
