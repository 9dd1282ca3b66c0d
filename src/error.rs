//! The error of every function that depends on input: its kind, file, line, key and problem.

#[doc(inline)]
pub use springfit_foundation::error::{ErrorKind, Result};

/// What is wrong with an input, as one line for people.
///
/// ```
/// let error = springfit::element::Element::load("hex9").unwrap_err();
/// assert!(error.to_string().contains("hex9"));
/// ```
#[doc(inline)]
pub use springfit_foundation::error::Error;
