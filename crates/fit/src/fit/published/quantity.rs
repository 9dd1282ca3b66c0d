//! The numbers with which formulas compute: `f64`, or the values of code that is being written.

use std::ops::{Add, Div, Mul, Sub};

/// A number of a formula.
pub trait Quantity:
    Clone
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// The cube root of a positive number.
    fn cube_root(self) -> Self;

    /// The number, or zero if it is negative.
    fn positive_part(self) -> Self;
}

impl Quantity for f64 {
    fn cube_root(self) -> f64 {
        self.cbrt()
    }

    fn positive_part(self) -> f64 {
        self.max(0.0)
    }
}
