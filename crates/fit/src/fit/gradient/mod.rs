//! Spring constants in closed form as functions of node positions and moduli, with their derivatives of first and second order as products
//! with given vectors.
//!
//! A product with the Jacobian is the kernel of the fit on dual numbers. A product with its transpose has lines of its own, which cost a few
//! times the constants whatever the number of inputs; on dual numbers they give second derivatives.
//!
//! Theory: page *Gradients of spring constants* of the book.

mod batch;
mod closed;
mod content;
mod exact;
mod function;
mod inputs;
mod modal;
mod slopes;

pub use inputs::{CellFunction, CellNumbers, GradientFit, Inputs};
