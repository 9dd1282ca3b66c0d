//! What every layer of springfit needs: errors, files, ranges, kinds of numbers, symbolic expressions.

#![forbid(unsafe_code)]

pub mod error;
pub mod file;
mod named;
pub mod range;
pub mod scalar;
pub mod symbolic;
