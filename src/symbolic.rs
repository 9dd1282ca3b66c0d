//! Expressions of text, and exact rational functions.

#[doc(inline)]
pub use springfit_foundation::symbolic::{Expr, Fraction, Polynomial};
