//! Kinds of numbers in which elements are integrated and springs fitted.

#[doc(inline)]
pub use springfit_foundation::scalar::{DoubleDouble, Dual, Real, Scalar};
