//! One direction of a load, or its size.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use crate::symbolic::{Expr, Polynomial};

/// One direction of a load: constant, or a function of the position.
#[derive(Debug, Clone, PartialEq)]
pub enum Component {
    /// The load has this value everywhere.
    Constant(f64),
    /// A function of the coordinates x, y (, z) in m.
    Varying(Expr),
}

impl Component {
    /// The value at the position x, `[dimension]`, m.
    pub fn at(&self, x: &[f64]) -> f64 {
        match self {
            Component::Constant(value) => *value,
            Component::Varying(expression) => expression.evaluate(x),
        }
    }

    /// The degree of the polynomial, or the degree by which another function is integrated.
    pub(super) fn degree(&self) -> usize {
        match self {
            Component::Constant(_) => 0,
            Component::Varying(expression) => {
                Polynomial::expand(expression, 3).map_or(SMOOTH, |polynomial| polynomial.degree() as usize)
            }
        }
    }
}

/// The polynomial degree with which a load that is not a polynomial is integrated.
// The five points along a direction of such a rule integrate a sine that turns by 1 rad across the cell to 4e-13, and
// by half a wave to 4e-8.
const SMOOTH: usize = 8;
